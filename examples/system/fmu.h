/* The functions of FMI 2.0 for co-simulation that the models of this folder have in common.
 *
 * A model defines GUID, the variables of its model description by their value references, of which
 * a master may set the first SETTABLE ones, their START values, and the functions `start`, called
 * at the end of initialization, and `step` from `time` over `h`. It includes this file at its end.
 */
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

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
    if (type != fmi2CoSimulation || strcmp(guid, GUID) != 0) {
        return NULL;
    }
    double *values = malloc(sizeof START);
    if (values != NULL) {
        memcpy(values, START, sizeof START);
    }
    return values;
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
    start(c);
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) {
    (void)c;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    memcpy(c, START, sizeof START);
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= VARIABLES) {
            return fmi2Error;
        }
        value[i] = ((double *)c)[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                       const fmi2Real value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= SETTABLE) {
            return fmi2Error;
        }
        ((double *)c)[vr[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean no_set_before) {
    (void)no_set_before;
    step(c, time, h);
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
