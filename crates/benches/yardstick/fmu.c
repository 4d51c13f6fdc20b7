/* The closed-form four-bar as the library of an FMU for co-simulation: the inputs, parameters and
 * body outputs of modelDescription/four_bar.xml under the same value references. Has what a host
 * needs to run it, each function with the checks that the standard asks of it. */

#include <stdlib.h>

#include "fmi2Functions.h"
#include "closed_form.h"

enum { ANGLE = 1, VELOCITY, ACCELERATION, CRANK, COUPLER, ROCKER, BASE, FIRST_OUTPUT = 10 };
enum { REALS = FIRST_OUTPUT + OUTPUTS };

enum state { INSTANTIATED, INITIALIZATION, STEP, TERMINATED };

struct instance {
    enum state state;
    fmi2Real real[REALS];
};

static fmi2Boolean is_input(fmi2ValueReference vr) { return vr >= ANGLE && vr <= ACCELERATION; }
static fmi2Boolean is_parameter(fmi2ValueReference vr) { return vr >= CRANK && vr <= BASE; }

static void solve(struct instance *at)
{
    const fmi2Real *real = at->real;
    const struct four_bar lengths = {real[CRANK], real[COUPLER], real[ROCKER], real[BASE]};
    four_bar_solve(&lengths, real[ANGLE], real[VELOCITY], real[ACCELERATION],
                   at->real + FIRST_OUTPUT);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

static void start(struct instance *at)
{
    const fmi2Real degree = 0.017453292519943295;
    at->state = INSTANTIATED;
    at->real[ANGLE] = 60.0 * degree;
    at->real[VELOCITY] = at->real[ACCELERATION] = 0.0;
    at->real[CRANK] = FOUR_BAR.crank;
    at->real[COUPLER] = FOUR_BAR.coupler;
    at->real[ROCKER] = FOUR_BAR.rocker;
    at->real[BASE] = FOUR_BAR.base;
    solve(at);
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging_on)
{
    (void)guid, (void)resources, (void)functions, (void)visible, (void)logging_on;
    if (!name || type != fmi2CoSimulation) return NULL;
    struct instance *made = malloc(sizeof *made);
    if (made) start(made);
    return made;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start_time, fmi2Boolean has_stop, fmi2Real stop)
{
    (void)has_tolerance, (void)tolerance, (void)start_time, (void)has_stop, (void)stop;
    struct instance *at = c;
    return at && at->state == INSTANTIATED ? fmi2OK : fmi2Error;
}

static fmi2Status enter(fmi2Component c, enum state from, enum state to)
{
    struct instance *at = c;
    if (!at || at->state != from) return fmi2Error;
    at->state = to;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return enter(c, INSTANTIATED, INITIALIZATION);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    fmi2Status status = enter(c, INITIALIZATION, STEP);
    if (status == fmi2OK) solve(c);
    return status;
}

fmi2Status fmi2Terminate(fmi2Component c) { return enter(c, STEP, TERMINATED); }

fmi2Status fmi2Reset(fmi2Component c)
{
    if (!c) return fmi2Error;
    start(c);
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                       const fmi2Real value[])
{
    struct instance *at = c;
    if (!at || at->state == TERMINATED || (n && !(vr && value))) return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        fmi2Boolean settable = is_input(vr[k]) || (at->state < STEP && is_parameter(vr[k]));
        /* The difference is 0 for finite numbers only. */
        if (!settable || !(value[k] - value[k] == 0.0)) return fmi2Error;
    }
    for (size_t k = 0; k < n; k++) at->real[vr[k]] = value[k];
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    struct instance *at = c;
    if (!at || at->state == INSTANTIATED || (n && !(vr && value))) return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        if (!vr[k] || vr[k] >= REALS || (vr[k] > BASE && vr[k] < FIRST_OUTPUT)) return fmi2Error;
        value[k] = at->real[vr[k]];
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real point, fmi2Real size,
                      fmi2Boolean no_set_fmu_state_prior_to_current_point)
{
    (void)no_set_fmu_state_prior_to_current_point;
    struct instance *at = c;
    if (!at || at->state != STEP || !(size >= 0.0) || !(point - point == 0.0)) return fmi2Error;
    solve(at);
    return fmi2OK;
}
