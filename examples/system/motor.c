/* A motor with a speed controller, as an FMU for co-simulation (FMI 2.0).
 *
 * The shaft follows the speed that is asked for with the time constant tau:
 *
 *     angle' = speed,  speed' = (asked - speed) / tau
 *
 * The controller asks for `fast` while the toe is more than `clearance` above its lowest point
 * `ground`, for `slow` on the ground, and for a speed in proportion in between. The input is held
 * over a step, over which the equations are solved exactly.
 */
#include <math.h>

#define GUID "{0f6a2f0e-5f0b-4f0a-9d43-6d1d0f1c2a77}"

enum { HEIGHT, FAST, SLOW, TAU, GROUND, CLEARANCE, ANGLE, SPEED, ACCELERATION, VARIABLES };
enum { SETTABLE = ANGLE };

static const double START[VARIABLES] = {-0.0918, 12.0, 4.0, 0.05, -0.0918, 0.015, 0.0, 0.0, 0.0};

static double asked(const double *v) {
    double lift = (v[HEIGHT] - v[GROUND]) / v[CLEARANCE];
    return v[SLOW] + (v[FAST] - v[SLOW]) * fmin(fmax(lift, 0.0), 1.0);
}

static void start(double *v) { v[ACCELERATION] = (asked(v) - v[SPEED]) / v[TAU]; }

static void step(double *v, double time, double h) {
    (void)time;
    double target = asked(v), decay = exp(-h / v[TAU]);
    v[ANGLE] += target * h + (v[SPEED] - target) * v[TAU] * (1.0 - decay);
    v[SPEED] = target + (v[SPEED] - target) * decay;
    start(v);
}

#include "fmu.h"
