/* A host in C of FMI 3.0 for the tests: loads the runtime library and calls its functions through
 * the types of the standard's own header, so that a call which does not fit them is no program.
 *
 *     host3 LIBRARY TOKEN RESOURCES SCENARIO
 *
 * A scenario prints its results to stdout, one per line. Whatever it did not expect ends it with a
 * message on stderr and status 1. Value references are those of the shipped mechanism that the test
 * names. */

#define _POSIX_C_SOURCE 200809L

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Each function that goes to an instance, with arguments that no state objects to. */
#define CALLS(X)                                                                                   \
    X(SetDebugLogging, (instance, fmi3True, 0, NULL))                                              \
    X(EnterInitializationMode, (instance, fmi3False, 0, 0, fmi3False, 0))                          \
    X(ExitInitializationMode, (instance)) X(EnterEventMode, (instance))                            \
    X(Terminate, (instance)) X(Reset, (instance)) X(GetFloat32, (instance, NULL, 0, NULL, 0))      \
    X(GetFloat64, (instance, NULL, 0, NULL, 0)) X(GetInt8, (instance, NULL, 0, NULL, 0))           \
    X(GetUInt8, (instance, NULL, 0, NULL, 0)) X(GetInt16, (instance, NULL, 0, NULL, 0))            \
    X(GetUInt16, (instance, NULL, 0, NULL, 0)) X(GetInt32, (instance, NULL, 0, NULL, 0))           \
    X(GetUInt32, (instance, NULL, 0, NULL, 0)) X(GetInt64, (instance, NULL, 0, NULL, 0))           \
    X(GetUInt64, (instance, NULL, 0, NULL, 0)) X(GetBoolean, (instance, NULL, 0, NULL, 0))         \
    X(GetString, (instance, NULL, 0, NULL, 0))                                                     \
    X(GetBinary, (instance, NULL, 0, NULL, NULL, 0)) X(GetClock, (instance, NULL, 0, NULL))        \
    X(SetFloat32, (instance, NULL, 0, NULL, 0)) X(SetFloat64, (instance, NULL, 0, NULL, 0))        \
    X(SetInt8, (instance, NULL, 0, NULL, 0)) X(SetUInt8, (instance, NULL, 0, NULL, 0))             \
    X(SetInt16, (instance, NULL, 0, NULL, 0)) X(SetUInt16, (instance, NULL, 0, NULL, 0))           \
    X(SetInt32, (instance, NULL, 0, NULL, 0)) X(SetUInt32, (instance, NULL, 0, NULL, 0))           \
    X(SetInt64, (instance, NULL, 0, NULL, 0)) X(SetUInt64, (instance, NULL, 0, NULL, 0))           \
    X(SetBoolean, (instance, NULL, 0, NULL, 0)) X(SetString, (instance, NULL, 0, NULL, 0))         \
    X(SetBinary, (instance, NULL, 0, NULL, NULL, 0)) X(SetClock, (instance, NULL, 0, NULL))        \
    X(GetNumberOfVariableDependencies, (instance, 1, &size))                                       \
    X(GetVariableDependencies, (instance, 1, NULL, NULL, NULL, NULL, 0))                           \
    X(GetFMUState, (instance, &state)) X(SetFMUState, (instance, other))                           \
    X(FreeFMUState, (instance, &none)) X(SerializedFMUStateSize, (instance, other, &size))         \
    X(SerializeFMUState, (instance, other, bytes, other_size))                                     \
    X(DeserializeFMUState, (instance, other_bytes, other_size, &state))                            \
    X(GetDirectionalDerivative, (instance, NULL, 0, NULL, 0, NULL, 0, NULL, 0))                    \
    X(GetAdjointDerivative, (instance, NULL, 0, NULL, 0, NULL, 0, NULL, 0))                        \
    X(EnterConfigurationMode, (instance)) X(ExitConfigurationMode, (instance))                     \
    X(GetIntervalDecimal, (instance, NULL, 0, NULL, NULL))                                         \
    X(GetIntervalFraction, (instance, NULL, 0, NULL, NULL, NULL))                                  \
    X(GetShiftDecimal, (instance, NULL, 0, NULL))                                                  \
    X(GetShiftFraction, (instance, NULL, 0, NULL, NULL))                                           \
    X(SetIntervalDecimal, (instance, NULL, 0, NULL))                                               \
    X(SetIntervalFraction, (instance, NULL, 0, NULL, NULL))                                        \
    X(SetShiftDecimal, (instance, NULL, 0, NULL))                                                  \
    X(SetShiftFraction, (instance, NULL, 0, NULL, NULL)) X(EvaluateDiscreteStates, (instance))     \
    X(UpdateDiscreteStates, (instance, &flag, &flag, &flag, &flag, &flag, &number))                \
    X(EnterContinuousTimeMode, (instance))                                                         \
    X(CompletedIntegratorStep, (instance, fmi3True, &flag, &flag)) X(SetTime, (instance, 0))       \
    X(SetContinuousStates, (instance, NULL, 0))                                                    \
    X(GetContinuousStateDerivatives, (instance, NULL, 0))                                          \
    X(GetEventIndicators, (instance, NULL, 0)) X(GetContinuousStates, (instance, NULL, 0))         \
    X(GetNominalsOfContinuousStates, (instance, NULL, 0))                                          \
    X(GetNumberOfEventIndicators, (instance, &size))                                               \
    X(GetNumberOfContinuousStates, (instance, &size)) X(EnterStepMode, (instance))                 \
    X(GetOutputDerivatives, (instance, NULL, 0, NULL, NULL, 0))                                    \
    X(DoStep, (instance, 0, 0.125, fmi3True, &flag, &flag, &flag, &number))                        \
    X(ActivateModelPartition, (instance, 0, 0))

static struct {
#define X(name, arguments) fmi3##name##TYPE *name;
    CALLS(X)
#undef X
    fmi3GetVersionTYPE *GetVersion;
    fmi3InstantiateModelExchangeTYPE *InstantiateModelExchange;
    fmi3InstantiateCoSimulationTYPE *InstantiateCoSimulation;
    fmi3InstantiateScheduledExecutionTYPE *InstantiateScheduledExecution;
    fmi3FreeInstanceTYPE *FreeInstance;
} fmu;

static const char *token, *resources;

static void fail(const char *what, const char *detail)
{
    fprintf(stderr, "host3: %s: %s\n", what, detail);
    exit(1);
}

static void check(fmi3Status status, const char *what)
{
    if (status != fmi3OK) fail(what, "is not fmi3OK");
}

static void load(const char *path)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) fail("cannot load the library", dlerror());
#define SYMBOL(name)                                                                               \
    {                                                                                              \
        void *symbol = dlsym(library, "fmi3" #name);                                               \
        if (!symbol) fail("not exported", "fmi3" #name);                                           \
        /* ISO C converts no object pointer to a function pointer; POSIX has them alike. */        \
        memcpy(&fmu.name, &symbol, sizeof symbol);                                                 \
    }
#define X(name, arguments) SYMBOL(name)
    CALLS(X)
#undef X
    SYMBOL(GetVersion)
    SYMBOL(InstantiateModelExchange)
    SYMBOL(InstantiateCoSimulation)
    SYMBOL(InstantiateScheduledExecution)
    SYMBOL(FreeInstance)
}

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status,
                        fmi3String category, fmi3String message)
{
    (void)environment;
    printf("log %d %s %s\n", (int)status, category, message);
}

static fmi3Instance model_exchange(void)
{
    fmi3Instance instance = fmu.InstantiateModelExchange("instance", token, resources, fmi3False,
                                                         fmi3False, NULL, log_message);
    if (!instance) fail("InstantiateModelExchange", "null");
    return instance;
}

static fmi3Instance co_simulation(int events, int early, const fmi3ValueReference *required,
                                  size_t n, void *environment,
                                  fmi3IntermediateUpdateCallback update)
{
    fmi3Instance instance = fmu.InstantiateCoSimulation(
        "instance", token, resources, fmi3False, fmi3False, events, early, required, n,
        environment, log_message, update);
    if (!instance) fail("InstantiateCoSimulation", "null");
    return instance;
}

static void initialize(fmi3Instance instance)
{
    check(fmu.EnterInitializationMode(instance, fmi3False, 0, 0, fmi3False, 0), "enter");
    check(fmu.ExitInitializationMode(instance), "exit");
}

static fmi3Float64 get(fmi3Instance instance, fmi3ValueReference reference)
{
    fmi3Float64 value = NAN;
    check(fmu.GetFloat64(instance, &reference, 1, &value, 1), "GetFloat64");
    return value;
}

static void set(fmi3Instance instance, fmi3ValueReference reference, fmi3Float64 value)
{
    check(fmu.SetFloat64(instance, &reference, 1, &value, 1), "SetFloat64");
}

/* ---- the state machine ---- */

/* What intermediate update tries. */
static struct {
    fmi3Instance instance;
    fmi3Status (*call)(fmi3Instance);
    fmi3Status status;
} attempt;

static void try_call(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean set_requested,
                     fmi3Boolean get_allowed, fmi3Boolean finished, fmi3Boolean can_return_early,
                     fmi3Boolean *early_return, fmi3Float64 *early_return_time)
{
    (void)environment, (void)time, (void)set_requested, (void)get_allowed, (void)finished;
    (void)can_return_early, (void)early_return, (void)early_return_time;
    if (attempt.call) attempt.status = attempt.call(attempt.instance);
    attempt.call = NULL;
}

static fmi3FMUState other;
static fmi3Byte *other_bytes, *bytes;
static size_t other_size;

#define X(name, arguments)                                                                               \
    static fmi3Status call_##name(fmi3Instance instance)                                           \
    {                                                                                              \
        fmi3Boolean flag;                                                                          \
        fmi3Float64 number;                                                                        \
        fmi3FMUState state = NULL, none = NULL;                                                    \
        size_t size;                                                                               \
        (void)flag, (void)number, (void)none, (void)size;                                          \
        fmi3Status status = fmu.name arguments;                         \
        if (state) fmu.FreeFMUState(instance, &state);                                             \
        return status;                                                                             \
    }
CALLS(X)
#undef X

static const struct {
    const char *name;
    fmi3Status (*call)(fmi3Instance);
} calls[] = {
#define X(name, arguments) {#name, call_##name},
    CALLS(X)
#undef X
};

enum { INSTANTIATED, INITIALIZATION, EVENT, CONTINUOUS, STEP, INTERMEDIATE, TERMINATED, STATES };

static const char *const state_names[STATES] = {
    "instantiated", "initializationMode",     "eventMode",  "continuousTimeMode",
    "stepMode",     "intermediateUpdateMode", "terminated",
};

static fmi3Instance in_state(int exchange, int state)
{
    fmi3Instance instance =
        exchange ? model_exchange() : co_simulation(1, 1, NULL, 0, NULL, try_call);
    if (state == INSTANTIATED) return instance;
    check(fmu.EnterInitializationMode(instance, fmi3False, 0, 0, fmi3False, 0), "enter");
    if (state == INITIALIZATION) return instance;
    check(fmu.ExitInitializationMode(instance), "exit");
    if (state == EVENT) return instance;
    check(exchange ? fmu.EnterContinuousTimeMode(instance) : fmu.EnterStepMode(instance), "mode");
    if (state == TERMINATED) check(fmu.Terminate(instance), "terminate");
    return instance;
}

/* Prints, for each interface and state, the calls that are not refused, and checks that a refused
 * one ends the simulation. */
static void states(void)
{
    for (int exchange = 0; exchange < 2; exchange++) {
        for (int state = 0; state < STATES; state++) {
            if (exchange ? state == STEP || state == INTERMEDIATE : state == CONTINUOUS) continue;
            printf("%s %s:", exchange ? "ME" : "CS", state_names[state]);
            for (size_t n = 0; n < COUNT(calls); n++) {
                fmi3Instance instance = in_state(exchange, state);
                fmi3Instance giver = in_state(exchange, state == INTERMEDIATE ? STEP : state);
                check(fmu.GetFMUState(giver, &other), "GetFMUState");
                check(fmu.SerializedFMUStateSize(giver, other, &other_size), "size");
                other_bytes = malloc(other_size), bytes = malloc(other_size);
                check(fmu.SerializeFMUState(giver, other, other_bytes, other_size), "serialize");
                fmi3Status status;
                if (state == INTERMEDIATE) {
                    attempt.instance = instance;
                    attempt.call = calls[n].call;
                    fmi3Boolean flag;
                    fmi3Float64 number;
                    fmi3Status step = fmu.DoStep(instance, 0, 0.125, fmi3True, &flag, &flag, &flag,
                                                 &number);
                    status = attempt.status;
                    if ((step == fmi3OK) != (status == fmi3OK)) fail(calls[n].name, "DoStep");
                } else {
                    status = calls[n].call(instance);
                }
                if (status == fmi3OK) {
                    printf(" %s", calls[n].name);
                } else if (status != fmi3Error) {
                    fail(calls[n].name, "neither fmi3OK nor fmi3Error");
                } else if (fmu.Terminate(instance) != fmi3Error || fmu.Reset(instance) != fmi3OK) {
                    fail(calls[n].name, "was refused and did not end the simulation");
                }
                if (calls[n].call(NULL) != fmi3Error) fail(calls[n].name, "takes null");
                check(fmu.FreeFMUState(giver, &other), "FreeFMUState");
                free(other_bytes), free(bytes);
                fmu.FreeInstance(instance);
                fmu.FreeInstance(giver);
            }
            printf("\n");
        }
    }
    if (strcmp(fmu.GetVersion(), "3.0") != 0) fail("GetVersion", fmu.GetVersion());
    if (fmu.InstantiateScheduledExecution("instance", token, resources, fmi3False, fmi3False, NULL,
                                          log_message, NULL, NULL, NULL))
        fail("InstantiateScheduledExecution", "not null");
}

/* ---- event mode ---- */

/* Sets the input 1 in event mode and prints the output `reference` before and after a step. */
static void events(fmi3ValueReference reference)
{
    fmi3Instance instance = co_simulation(1, 1, NULL, 0, NULL, NULL);
    initialize(instance);
    for (int n = 0; n < 4; n++) {
        fmi3Boolean update, terminate, a, b, c, early, needed;
        fmi3Float64 time;
        if (n > 0) check(fmu.EnterEventMode(instance), "EnterEventMode");
        set(instance, 1, 0.4 + 0.05 * n);
        printf("%.17g", get(instance, reference));
        check(fmu.UpdateDiscreteStates(instance, &update, &terminate, &a, &b, &c, &time), "update");
        if (update || terminate || a || b || c) fail("UpdateDiscreteStates", "there is nothing");
        check(fmu.EnterStepMode(instance), "EnterStepMode");
        printf(" %.17g", get(instance, reference));
        check(fmu.DoStep(instance, 0.125 * n, 0.125, fmi3True, &needed, &terminate, &early, &time),
              "DoStep");
        if (needed || terminate || early || time != 0.125 * (n + 1)) fail("DoStep", "ended early");
        printf(" %.17g\n", get(instance, reference));
    }
    check(fmu.Terminate(instance), "Terminate");
    fmu.FreeInstance(instance);
}

/* ---- intermediate update ---- */

static struct {
    fmi3Instance instance;
    int points;
} update;

static fmi3Float64 swing(fmi3Float64 time) { return 0.25 + sin(2 * time); }

static void set_inputs(fmi3InstanceEnvironment environment, fmi3Float64 time,
                       fmi3Boolean set_requested, fmi3Boolean get_allowed, fmi3Boolean finished,
                       fmi3Boolean can_return_early, fmi3Boolean *early_return,
                       fmi3Float64 *early_return_time)
{
    (void)early_return, (void)early_return_time;
    if (environment != &update) fail("environment", "another one");
    if (!set_requested || !get_allowed || !finished || can_return_early) fail("flags", "wrong");
    (void)get(update.instance, 1);
    /* Not freed while the step waits. */
    fmu.FreeInstance(update.instance);
    set(update.instance, 1, swing(time));
    set(update.instance, 2, 2 * cos(2 * time));
    set(update.instance, 3, -4 * sin(2 * time));
    update.points++;
}

/* Prints time, position, velocity and acceleration of three consecutive outputs after each step. */
static void intermediate(const fmi3ValueReference outputs[3])
{
    const fmi3ValueReference required[] = {1, 2, 3};
    update.instance = co_simulation(0, 0, required, COUNT(required), &update, set_inputs);
    set(update.instance, 1, swing(0));
    initialize(update.instance);
    for (int n = 0; n < 16; n++) {
        fmi3Boolean needed, terminate, early;
        fmi3Float64 time;
        check(fmu.DoStep(update.instance, 0.125 * n, 0.125, fmi3True, &needed, &terminate, &early,
                         &time),
              "DoStep");
        printf("%.17g", time);
        for (int order = 0; order < 3; order++)
            printf(" %.17g", get(update.instance, outputs[order]));
        printf("\n");
    }
    if (update.points != 4 * 16) fail("intermediate update", "not four points per step");
    fmu.FreeInstance(update.instance);
}

/* ---- early return ---- */

/* Drives the input 1 from `start` with `velocity` along its own curve and prints where the steps
 * end early: time, whether an event is to be handled, whether the simulation must end. */
static void early(int with_events, fmi3ValueReference extrapolation, double start, double velocity)
{
    fmi3Instance instance = co_simulation(with_events, 1, NULL, 0, NULL, NULL);
    const fmi3Int64 taylor = 2;
    check(fmu.SetInt64(instance, &extrapolation, 1, &taylor, 1), "SetInt64");
    set(instance, 1, start);
    initialize(instance);
    if (with_events) check(fmu.EnterStepMode(instance), "EnterStepMode");
    fmi3Float64 time = 0;
    for (int n = 0; n < 100; n++) {
        fmi3Boolean needed, terminate, early;
        set(instance, 1, start + velocity * time);
        set(instance, 2, velocity);
        check(fmu.DoStep(instance, time, 0.2, fmi3True, &needed, &terminate, &early, &time),
              "DoStep");
        if (early) printf("%.17g %d %d\n", time, needed, terminate);
        if (needed) {
            check(fmu.EnterEventMode(instance), "EnterEventMode");
            check(fmu.EnterStepMode(instance), "EnterStepMode");
        }
        if (terminate) break;
    }
    check(fmu.Terminate(instance), "Terminate");
    fmu.FreeInstance(instance);
}

int main(int count, char **arguments)
{
    if (count < 5) fail("arguments", "LIBRARY TOKEN RESOURCES SCENARIO ...");
    load(arguments[1]);
    token = arguments[2];
    resources = arguments[3];
    const char *scenario = arguments[4];
    double numbers[4] = {0};
    for (int n = 5; n < count && n < 9; n++) numbers[n - 5] = atof(arguments[n]);
    fmi3ValueReference references[4];
    for (size_t n = 0; n < COUNT(references); n++) references[n] = (fmi3ValueReference)numbers[n];
    if (strcmp(scenario, "states") == 0) {
        states();
    } else if (strcmp(scenario, "events") == 0) {
        events(references[0]);
    } else if (strcmp(scenario, "intermediate") == 0) {
        intermediate(references);
    } else if (strcmp(scenario, "early") == 0) {
        early(numbers[0] > 0, references[1], numbers[2], numbers[3]);
    } else {
        fail("no scenario", scenario);
    }
    return 0;
}
