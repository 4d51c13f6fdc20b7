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
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

enum { HEIGHT, FAST, SLOW, TAU, GROUND, CLEARANCE, ANGLE, SPEED, ACCELERATION, VARIABLES };

static const double START[VARIABLES] = {-0.0918, 12.0, 4.0, 0.05, -0.0918, 0.015, 0.0, 0.0, 0.0};

typedef struct {
    double value[VARIABLES];
} Motor;

static double asked(const Motor *motor) {
    const double *v = motor->value;
    double lift = (v[HEIGHT] - v[GROUND]) / v[CLEARANCE];
    return v[SLOW] + (v[FAST] - v[SLOW]) * fmin(fmax(lift, 0.0), 1.0);
}

static void accelerate(Motor *motor) {
    double *v = motor->value;
    v[ACCELERATION] = (asked(motor) - v[SPEED]) / v[TAU];
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]) {
    (void)c, (void)on, (void)n, (void)names;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
    (void)name, (void)resources, (void)functions, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || strcmp(guid, "{0f6a2f0e-5f0b-4f0a-9d43-6d1d0f1c2a77}") != 0) {
        return NULL;
    }
    Motor *motor = malloc(sizeof *motor);
    if (motor != NULL) {
        memcpy(motor->value, START, sizeof START);
    }
    return motor;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    (void)c;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    accelerate(c);
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) {
    (void)c;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    memcpy(((Motor *)c)->value, START, sizeof START);
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= VARIABLES) {
            return fmi2Error;
        }
        value[i] = ((Motor *)c)->value[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                       const fmi2Real value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= ANGLE) {
            return fmi2Error;
        }
        ((Motor *)c)->value[vr[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean no_set_before) {
    (void)time, (void)no_set_before;
    double *v = ((Motor *)c)->value;
    double target = asked(c), decay = exp(-h / v[TAU]);
    v[ANGLE] += target * h + (v[SPEED] - target) * v[TAU] * (1.0 - decay);
    v[SPEED] = target + (v[SPEED] - target) * decay;
    accelerate(c);
    return fmi2OK;
}

/* What the model description does not offer. */

#define NONE_OF(type)                                                                         \
    fmi2Status fmi2Get##type(fmi2Component c, const fmi2ValueReference vr[], size_t n,       \
                             fmi2##type value[]) {                                            \
        (void)c, (void)vr, (void)value;                                                       \
        return n == 0 ? fmi2OK : fmi2Error;                                                   \
    }                                                                                         \
    fmi2Status fmi2Set##type(fmi2Component c, const fmi2ValueReference vr[], size_t n,       \
                             const fmi2##type value[]) {                                      \
        (void)c, (void)vr, (void)value;                                                       \
        return n == 0 ? fmi2OK : fmi2Error;                                                   \
    }
NONE_OF(Integer)
NONE_OF(Boolean)
NONE_OF(String)

#define REFUSED(name, ...)                                                                    \
    fmi2Status fmi2##name(__VA_ARGS__) { return fmi2Error; }
REFUSED(GetFMUstate, fmi2Component c, fmi2FMUstate *s)
REFUSED(SetFMUstate, fmi2Component c, fmi2FMUstate s)
REFUSED(FreeFMUstate, fmi2Component c, fmi2FMUstate *s)
REFUSED(SerializedFMUstateSize, fmi2Component c, fmi2FMUstate s, size_t *n)
REFUSED(SerializeFMUstate, fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n)
REFUSED(DeSerializeFMUstate, fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
REFUSED(GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference u[], size_t nu,
        const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[])
REFUSED(SetRealInputDerivatives, fmi2Component c, const fmi2ValueReference vr[], size_t n,
        const fmi2Integer order[], const fmi2Real value[])
REFUSED(GetRealOutputDerivatives, fmi2Component c, const fmi2ValueReference vr[], size_t n,
        const fmi2Integer order[], fmi2Real value[])
REFUSED(CancelStep, fmi2Component c)
REFUSED(GetStatus, fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
REFUSED(GetRealStatus, fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
REFUSED(GetIntegerStatus, fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
REFUSED(GetBooleanStatus, fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
REFUSED(GetStringStatus, fmi2Component c, const fmi2StatusKind s, fmi2String *value)
