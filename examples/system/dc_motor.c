/* A DC motor on a constant voltage, as an FMU for co-simulation (FMI 2.0).
 *
 * The mechanism that it turns has an inertia and a bias, as biela gives them for a driver:
 *
 *     (rotor + inertia) speed' = constant i - bias,  resistance i = voltage - constant speed
 *
 * Both inputs are held over a step, over which the equations are solved exactly. While the inertia
 * is zero, which no mechanism has, the motor stands: some masters begin with zeros.
 */
#include <math.h>

#define GUID "{6d0c5a0b-7c1e-4a57-9e0b-9b2f64a1c3e1}"

enum { INERTIA, BIAS, VOLTAGE, RESISTANCE, CONSTANT, ROTOR, ANGLE, SPEED, ACCELERATION, VARIABLES };
enum { SETTABLE = ANGLE };

static const double START[VARIABLES] = {0.0, 0.0, 24.0, 0.1, 0.12, 0.004, 0.0, 0.0, 0.0};

static void start(double *v) {
    double torque = v[CONSTANT] * (v[VOLTAGE] - v[CONSTANT] * v[SPEED]) / v[RESISTANCE];
    v[ACCELERATION] = v[INERTIA] > 0.0 ? (torque - v[BIAS]) / (v[ROTOR] + v[INERTIA]) : 0.0;
}

static void step(double *v, double time, double h) {
    (void)time;
    start(v);
    double rate = v[CONSTANT] * v[CONSTANT] / (v[RESISTANCE] * (v[ROTOR] + v[INERTIA]));
    double gain = v[ACCELERATION] / rate, decay = exp(-rate * h);
    v[ANGLE] += (v[SPEED] + gain) * h - gain * (1.0 - decay) / rate;
    v[SPEED] += gain * (1.0 - decay);
    start(v);
}

#include "fmu.h"
