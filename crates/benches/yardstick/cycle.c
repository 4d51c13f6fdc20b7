#include "cycle.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "fmi2Functions.h"
#include "fmi3Functions.h"

#define FUNCTIONS2(X)                                                                              \
    X(2, Instantiate) X(2, FreeInstance) X(2, SetupExperiment) X(2, EnterInitializationMode)       \
    X(2, ExitInitializationMode) X(2, SetReal) X(2, DoStep) X(2, GetReal)
#define FUNCTIONS3(X)                                                                              \
    X(3, InstantiateCoSimulation) X(3, FreeInstance) X(3, EnterInitializationMode)                 \
    X(3, ExitInitializationMode) X(3, SetFloat64) X(3, DoStep) X(3, GetFloat64)

enum { INPUTS = 3, FIRST_OUTPUT = 10 };

struct cycle {
    void *library;
    int version; /* of FMI */
    void *component;
    fmi2CallbackFunctions callbacks;
    unsigned turn, at; /* steps per turn; steps done of a turn there and back again */
    unsigned long long done;
    fmi2ValueReference order[OUTPUTS];
    fmi2Real inputs[INPUTS], outputs[OUTPUTS];
#define X(version, name) fmi##version##name##TYPE *name##version;
    FUNCTIONS2(X)
    FUNCTIONS3(X)
#undef X
};

static void logger(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    (void)environment, (void)category;
    fprintf(stderr, "%s: status %d: %s\n", instance, (int)status, message);
}

static void logger3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                    fmi3String message)
{
    (void)environment, (void)category;
    fprintf(stderr, "status %d: %s\n", (int)status, message);
}

void cycle_close(struct cycle *cycle)
{
    if (cycle->component)
        (cycle->version == 2 ? cycle->FreeInstance2 : cycle->FreeInstance3)(cycle->component);
    if (cycle->library) dlclose(cycle->library);
    free(cycle);
}

static struct cycle *fail(struct cycle *cycle, const char *what)
{
    fprintf(stderr, "cycle: %s\n", what);
    cycle_close(cycle);
    return NULL;
}

/* Loads the functions of the version. Returns the name of one that the library lacks. */
static const char *load(struct cycle *cycle)
{
#define X(version, name)                                                                           \
    {                                                                                              \
        void *symbol = dlsym(cycle->library, "fmi" #version #name);                                \
        if (!symbol) return "fmi" #version #name " is not exported";                               \
        /* ISO C converts no object pointer to a function pointer; POSIX has them alike. */        \
        memcpy(&cycle->name##version, &symbol, sizeof symbol);                                     \
    }
    if (cycle->version == 2) {
        FUNCTIONS2(X)
    } else {
        FUNCTIONS3(X)
    }
#undef X
    return NULL;
}

static int initialize2(struct cycle *cycle, const char *token, const char *resources)
{
    const fmi2CallbackFunctions callbacks = {
        .logger = logger, .allocateMemory = calloc, .freeMemory = free};
    memcpy(&cycle->callbacks, &callbacks, sizeof callbacks);
    fmi2Component c = cycle->component = cycle->Instantiate2(
        "four_bar", fmi2CoSimulation, token, resources, &cycle->callbacks, fmi2False, fmi2False);
    return c && cycle->SetupExperiment2(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK &&
           cycle->EnterInitializationMode2(c) == fmi2OK &&
           cycle->ExitInitializationMode2(c) == fmi2OK;
}

static int initialize3(struct cycle *cycle, const char *token, const char *resources)
{
    fmi3Instance c = cycle->component = cycle->InstantiateCoSimulation3(
        "four_bar", token, resources, fmi3False, fmi3False, fmi3False, fmi3False, NULL, 0, NULL,
        logger3, NULL);
    return c &&
           cycle->EnterInitializationMode3(c, fmi3False, 0.0, 0.0, fmi3False, 0.0) == fmi3OK &&
           cycle->ExitInitializationMode3(c) == fmi3OK;
}

struct cycle *cycle_open(const char *library, int version, const char *token,
                         const char *resources, unsigned turn, const unsigned order[OUTPUTS])
{
    struct cycle *cycle = calloc(1, sizeof *cycle);
    if (!cycle) return NULL;
    cycle->version = version;
    cycle->turn = turn;
    for (unsigned k = 0; k < OUTPUTS; k++) cycle->order[k] = FIRST_OUTPUT + order[k];
    cycle->library = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!cycle->library) return fail(cycle, dlerror());
    const char *missing = load(cycle);
    if (missing) return fail(cycle, missing);
    if (!(version == 2 ? initialize2 : initialize3)(cycle, token, resources))
        return fail(cycle, "initialization failed");
    return cycle;
}

/* The same calls in both versions. The given acceleration contradicts the motion, of which FMI 2.0
   warns once. */
static int step2(struct cycle *cycle, double time, double size)
{
    static const fmi2ValueReference in[INPUTS] = {1, 2, 3};
    return cycle->SetReal2(cycle->component, in, INPUTS, cycle->inputs) == fmi2OK &&
           cycle->DoStep2(cycle->component, time, size, fmi2True) <= fmi2Warning &&
           cycle->GetReal2(cycle->component, cycle->order, OUTPUTS, cycle->outputs) == fmi2OK;
}

static int step3(struct cycle *cycle, double time, double size)
{
    static const fmi3ValueReference in[INPUTS] = {1, 2, 3};
    fmi3Boolean event, terminate, early;
    fmi3Float64 last;
    return cycle->SetFloat643(cycle->component, in, INPUTS, cycle->inputs, INPUTS) == fmi3OK &&
           cycle->DoStep3(cycle->component, time, size, fmi3True, &event, &terminate, &early,
                          &last) == fmi3OK &&
           cycle->GetFloat643(cycle->component, cycle->order, OUTPUTS, cycle->outputs, OUTPUTS) ==
               fmi3OK;
}

long long cycle_run(struct cycle *cycle, unsigned long long cycles)
{
    int (*const step)(struct cycle *, double, double) = cycle->version == 2 ? step2 : step3;
    const double circle = 6.283185307179586, speed = 10.0;
    const unsigned turn = cycle->turn;
    const double angle = circle / turn, size = angle / speed;
    long long started = thread_time();
    for (unsigned long long end = cycle->done + cycles; cycle->done < end; cycle->done++) {
        if (++cycle->at == 2 * turn) cycle->at = 0;
        const int back = cycle->at > turn;
        cycle->inputs[0] = circle / 6.0 + angle * (back ? 2 * turn - cycle->at : cycle->at);
        cycle->inputs[1] = back ? -speed : speed;
        cycle->inputs[2] = 3.0;
        if (!step(cycle, size * (double)cycle->done, size)) return -1;
    }
    return thread_time() - started;
}

const double *cycle_inputs(const struct cycle *cycle) { return cycle->inputs; }
const double *cycle_outputs(const struct cycle *cycle) { return cycle->outputs; }
