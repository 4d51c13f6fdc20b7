#define _GNU_SOURCE /* sincos */

#include "closed_form.h"

#include <math.h>

const struct four_bar FOUR_BAR = {.crank = 0.10, .coupler = 0.25, .rocker = 0.30, .base = 0.40};

void four_bar_solve(const struct four_bar *lengths, double angle, double velocity,
                    double acceleration, double out[OUTPUTS])
{
    const double b = lengths->coupler, c = lengths->rocker;
    double sine, cosine;
    sincos(angle, &sine, &cosine);

    /* Crank pin A: position, velocity, acceleration. */
    const double ax = lengths->crank * cosine, ay = lengths->crank * sine;
    const double avx = -ay * velocity, avy = ax * velocity;
    const double aax = -ay * acceleration - ax * velocity * velocity;
    const double aay = ax * acceleration - ay * velocity * velocity;

    /* Pin B where the circles about A and about the rocker's pivot meet: the coupler as a vector
     * is f d + g n, with d from A to the pivot and n the same turned to the left. */
    const double dx = lengths->base - ax, dy = -ay;
    const double inverse = 1.0 / (dx * dx + dy * dy);
    const double f = 0.5 * (1.0 + (b * b - c * c) * inverse);
    const double g = sqrt(b * b * inverse - f * f);
    const double bx = f * dx - g * dy, by = f * dy + g * dx;
    const double cx = bx - dx, cy = by - dy;

    /* B moves alike on both bodies: A' + w1 n(b) = w2 n(c). Multiplied by c and by b, where
     * n(c).c = n(b).b = 0 and n(c).b = c x b = -n(b).c. */
    const double cross = 1.0 / (cx * by - cy * bx);
    const double w1 = (avx * cx + avy * cy) * cross;
    const double w2 = (avx * bx + avy * by) * cross;
    /* Likewise for the accelerations, with the centripetal ones on the left. */
    const double rx = aax - w1 * w1 * bx + w2 * w2 * cx;
    const double ry = aay - w1 * w1 * by + w2 * w2 * cy;

    out[0] = 0.0, out[1] = 0.0, out[2] = angle;
    out[3] = 0.0, out[4] = 0.0, out[5] = velocity;
    out[6] = 0.0, out[7] = 0.0, out[8] = acceleration;

    out[9] = ax, out[10] = ay, out[11] = atan2(by, bx);
    out[12] = avx, out[13] = avy, out[14] = w1;
    out[15] = aax, out[16] = aay, out[17] = (rx * cx + ry * cy) * cross;

    out[18] = lengths->base, out[19] = 0.0, out[20] = atan2(cy, cx);
    out[21] = 0.0, out[22] = 0.0, out[23] = w2;
    out[24] = 0.0, out[25] = 0.0, out[26] = (rx * bx + ry * by) * cross;
}
