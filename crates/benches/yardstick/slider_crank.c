#define _GNU_SOURCE /* sincos */

#include "closed_form.h"

#include <math.h>

const struct slider_crank SLIDER_CRANK = {.crank = 0.05, .rod = 0.15, .offset = 0.01};

void slider_crank_solve(const struct slider_crank *lengths, double angle, double velocity,
                        double acceleration, double out[OUTPUTS])
{
    const double rod = lengths->rod, offset = lengths->offset;
    double sine, cosine;
    sincos(angle, &sine, &cosine);

    /* Crank pin A: position, velocity, acceleration. */
    const double ax = lengths->crank * cosine, ay = lengths->crank * sine;
    const double avx = -ay * velocity, avy = ax * velocity;
    const double aax = -ay * acceleration - ax * velocity * velocity;
    const double aay = ax * acceleration - ay * velocity * velocity;

    /* The rod as a vector (bx, by) from A to the slider's pin B, at the height of the guide. */
    const double by = offset - ay, bx = sqrt(rod * rod - by * by);
    const double per_bx = 1.0 / bx;
    const double x = ax + bx;

    /* B moves along the guide only: avy + w bx = 0; likewise for the acceleration. */
    const double w = -avy * per_bx;
    const double alpha = -(aay - w * w * by) * per_bx;
    const double v = avx - w * by;
    const double a = aax - alpha * by - w * w * bx;

    out[0] = 0.0, out[1] = 0.0, out[2] = angle;
    out[3] = 0.0, out[4] = 0.0, out[5] = velocity;
    out[6] = 0.0, out[7] = 0.0, out[8] = acceleration;

    out[9] = 0.5 * (ax + x), out[10] = 0.5 * (ay + offset), out[11] = atan2(by, bx);
    out[12] = 0.5 * (avx + v), out[13] = 0.5 * avy, out[14] = w;
    out[15] = 0.5 * (aax + a), out[16] = 0.5 * aay, out[17] = alpha;

    out[18] = x, out[19] = offset, out[20] = 0.0;
    out[21] = v, out[22] = 0.0, out[23] = 0.0;
    out[24] = a, out[25] = 0.0, out[26] = 0.0;
}
