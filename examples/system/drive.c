/* A DC motor with a speed controller, as an FMU for co-simulation (FMI 2.0).
 *
 * The controller's voltage has a part in proportion to the error of the speed and one to its
 * integral; the current of the armature has a rate of its own:
 *
 *     inductance current' = proportional error + integral sum - constant speed - resistance current
 *     sum' = error,  error = target - speed,  torque = constant current
 *
 * The input, the speed of the shaft, is held over a step, over which the equations are solved
 * exactly.
 */
#include <math.h>

#define GUID "{3b7f5e0c-94d1-4c0e-8a86-5f2d7e9b1a43}"

enum {
    SPEED, TARGET, PROPORTIONAL, INTEGRAL, RESISTANCE, INDUCTANCE, CONSTANT,
    CURRENT, TORQUE, SUM, VARIABLES
};
enum { SETTABLE = CURRENT };

static const double START[VARIABLES] = {0.0, 10.0, 3.0, 10.0, 0.5, 0.01, 2.0, 0.0, 0.0, 0.0};

static void start(double *v) { v[TORQUE] = v[CONSTANT] * v[CURRENT]; }

static void step(double *v, double time, double h) {
    (void)time;
    double error = v[TARGET] - v[SPEED], tau = v[INDUCTANCE] / v[RESISTANCE];
    double voltage = v[PROPORTIONAL] * error + v[INTEGRAL] * v[SUM] - v[CONSTANT] * v[SPEED];
    /* tau current' = level + slope t - current, which the current follows with a lag of tau. */
    double slope = v[INTEGRAL] * error / v[RESISTANCE];
    double level = voltage / v[RESISTANCE] - slope * tau;
    v[CURRENT] = level + slope * h + (v[CURRENT] - level) * exp(-h / tau);
    v[SUM] += error * h;
    start(v);
}

#include "fmu.h"
