/* The four-bar of mechanisms/four_bar.toml in closed form. */

#ifndef FOUR_BAR_H
#define FOUR_BAR_H

/* Lengths between the pins [m]. */
struct four_bar {
    double crank, coupler, rocker, base;
};

/* The lengths of mechanisms/four_bar.toml. */
#define FOUR_BAR ((struct four_bar){0.10, 0.25, 0.30, 0.40})

enum { BODIES = 3, PER_BODY = 9, OUTPUTS = BODIES * PER_BODY };

/* Pose, velocity and acceleration of crank, coupler and rocker for the crank's angle [rad] and its
 * rates: for each body x y phi vx vy omega ax ay alpha. The loop is closed as an open one, with the
 * coupler's far pin to the left of the line from its near pin to the rocker's pivot. */
void four_bar_solve(const struct four_bar *lengths, double angle, double velocity,
                    double acceleration, double out[OUTPUTS]);

#endif
