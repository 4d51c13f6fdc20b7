/* A hydraulic cylinder with its valve, as an FMU for co-simulation (FMI 2.0).
 *
 * The pump's flow enters below the piston, where the oil is compressed; the other side is open to
 * the tank. The mechanism that the cylinder moves has an inertia and a bias, as biela gives them
 * for a driver:
 *
 *     (piston + inertia) speed' = area pressure - friction speed - bias
 *     (volume + area stroke) pressure' = modulus (flow(t) - area speed)
 *
 * The valve opens from 0.2 s to 0.4 s and closes from 1.6 s to 1.8 s. Both inputs are held over a
 * step, in which the classical Runge-Kutta method takes steps of its own. While the inertia is
 * zero, which no mechanism has, the piston stands: some masters begin with zeros.
 */
#include <math.h>

#define GUID "{b1f3c9d2-2f0e-4b7a-8c55-0d9e7a4f6b18}"

enum {
    INERTIA, BIAS, AREA, VOLUME, MODULUS, FLOW, FRICTION, PISTON, REST_PRESSURE,
    STROKE, SPEED, ACCELERATION, PRESSURE, VARIABLES
};
enum { SETTABLE = STROKE };

static const double START[VARIABLES] = {
    0.0, 0.0, 0.005, 1e-3, 1.2e9, 7.5e-4, 2e4, 15.0, 5.28e6, 0.0, 0.0, 0.0, 5.28e6,
};

/* Longest step of the Runge-Kutta method [s]: some thousandths of a period of the oil. */
static const double LONGEST = 1e-4;

typedef struct {
    double stroke, speed, pressure;
} State;

static double ramp(double time, double from) { return fmin(fmax((time - from) / 0.2, 0.0), 1.0); }

static State rate(const double *v, double time, State s) {
    double flow = v[FLOW] * (ramp(time, 0.2) - ramp(time, 1.6));
    double force = v[AREA] * s.pressure - v[FRICTION] * s.speed - v[BIAS];
    return (State){
        s.speed,
        v[INERTIA] > 0.0 ? force / (v[PISTON] + v[INERTIA]) : 0.0,
        v[MODULUS] * (flow - v[AREA] * s.speed) / (v[VOLUME] + v[AREA] * s.stroke),
    };
}

static State ahead(State s, double h, State r) {
    return (State){s.stroke + h * r.stroke, s.speed + h * r.speed, s.pressure + h * r.pressure};
}

static void start(double *v) { v[PRESSURE] = v[REST_PRESSURE]; }

static void step(double *v, double time, double h) {
    int steps = (int)ceil(h / LONGEST - 1e-6);
    double k = h / steps;
    State s = {v[STROKE], v[SPEED], v[PRESSURE]};
    for (int i = 0; i < steps; i++) {
        double t = time + i * k;
        State a = rate(v, t, s);
        State b = rate(v, t + 0.5 * k, ahead(s, 0.5 * k, a));
        State c = rate(v, t + 0.5 * k, ahead(s, 0.5 * k, b));
        State d = rate(v, t + k, ahead(s, k, c));
        s = ahead(ahead(ahead(ahead(s, k / 6, a), k / 3, b), k / 3, c), k / 6, d);
    }
    v[STROKE] = s.stroke;
    v[SPEED] = s.speed;
    v[PRESSURE] = s.pressure;
    v[ACCELERATION] = rate(v, time + h, s).speed;
}

#include "fmu.h"
