/* Closed forms of two mechanisms of three moving bodies. */

#ifndef CLOSED_FORM_H
#define CLOSED_FORM_H

enum { BODIES = 3, PER_BODY = 9, OUTPUTS = BODIES * PER_BODY };

/* Lengths of a four-bar between the pins [m]. */
struct four_bar {
    double crank, coupler, rocker, base;
};

/* The lengths of mechanisms/four_bar.toml. */
extern const struct four_bar FOUR_BAR;

/* Computes pose, velocity and acceleration of crank, coupler and rocker for the crank's angle [rad]
 * and its rates: for each body x y phi vx vy omega ax ay alpha. The coupler's far pin is to the
 * left of the line from its near pin to the rocker's pivot: the open loop. */
void four_bar_solve(const struct four_bar *lengths, double angle, double velocity,
                    double acceleration, double out[OUTPUTS]);

/* Mass [kg], inertia about the centre of mass [kg m2], and the centre on the body's own axes [m]. */
struct masses {
    double mass, inertia, x, y;
};

/* Masses of crank, coupler and rocker. */
extern const struct masses FOUR_BAR_MASSES[BODIES];

/* Effort, power, inertia and bias of the crank's driver; the forces of the pins O2 on the crank, A
 * on the coupler, B and O4 on the rocker, x and y of each; kinetic and potential energy. */
enum { FORCES = 14 };

/* Computes the motion as four_bar_solve does, and the forces under gravity along -y. */
void four_bar_forces(const struct four_bar *lengths, const struct masses masses[BODIES],
                     double angle, double velocity, double acceleration, double out[OUTPUTS],
                     double forces[FORCES]);

/* The acceleration of the crank that nothing drives, under gravity along -y. */
double four_bar_acceleration(const struct four_bar *lengths, const struct masses masses[BODIES],
                             double angle, double velocity);

/* The acceleration of a pendulum of 1 m with its mass at the end, at an angle from the level. */
double pendulum_acceleration(double angle);

/* Lengths of a slider-crank [m]: crank and rod between the pins, and the height of the slider's
 * pin above the crank's pivot. */
struct slider_crank {
    double crank, rod, offset;
};

/* The lengths of mechanisms/slider_crank.toml. */
extern const struct slider_crank SLIDER_CRANK;

/* Computes the same for crank, connecting rod and slider. The origin of the rod is halfway between
 * its pins. The slider is to the right of the crank. */
void slider_crank_solve(const struct slider_crank *lengths, double angle, double velocity,
                        double acceleration, double out[OUTPUTS]);

#endif
