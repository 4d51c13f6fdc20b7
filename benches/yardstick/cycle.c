#include "cycle.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "fmi2Functions.h"

#define FUNCTIONS(X)                                                                               \
    X(Instantiate) X(FreeInstance) X(SetupExperiment) X(EnterInitializationMode)                   \
    X(ExitInitializationMode) X(SetReal) X(DoStep) X(GetReal)

enum { INPUTS = 3, FIRST_OUTPUT = 9 };

struct cycle {
    void *library;
    fmi2Component component;
    fmi2CallbackFunctions callbacks;
    unsigned turn, at; /* steps per turn; steps done of a turn there and back again */
    unsigned long long done;
    fmi2ValueReference order[OUTPUTS];
    fmi2Real inputs[INPUTS], outputs[OUTPUTS];
#define X(name) fmi2##name##TYPE *name;
    FUNCTIONS(X)
#undef X
};

static void logger(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    (void)environment, (void)category;
    fprintf(stderr, "%s: status %d: %s\n", instance, (int)status, message);
}

void cycle_close(struct cycle *cycle)
{
    if (cycle->component) cycle->FreeInstance(cycle->component);
    if (cycle->library) dlclose(cycle->library);
    free(cycle);
}

static struct cycle *fail(struct cycle *cycle, const char *what)
{
    fprintf(stderr, "cycle: %s\n", what);
    cycle_close(cycle);
    return NULL;
}

struct cycle *cycle_open(const char *library, const char *guid, const char *resources,
                         unsigned turn, const unsigned order[OUTPUTS])
{
    struct cycle *cycle = calloc(1, sizeof *cycle);
    if (!cycle) return NULL;
    cycle->turn = turn;
    for (unsigned k = 0; k < OUTPUTS; k++) cycle->order[k] = FIRST_OUTPUT + order[k];
    cycle->library = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!cycle->library) return fail(cycle, dlerror());
#define X(name)                                                                                    \
    {                                                                                              \
        void *symbol = dlsym(cycle->library, "fmi2" #name);                                        \
        if (!symbol) return fail(cycle, "fmi2" #name " is not exported");                          \
        /* ISO C converts no object pointer to a function pointer; POSIX has them alike. */        \
        memcpy(&cycle->name, &symbol, sizeof symbol);                                              \
    }
    FUNCTIONS(X)
#undef X
    const fmi2CallbackFunctions callbacks = {
        .logger = logger, .allocateMemory = calloc, .freeMemory = free};
    memcpy(&cycle->callbacks, &callbacks, sizeof callbacks);
    cycle->component = cycle->Instantiate("four_bar", fmi2CoSimulation, guid, resources,
                                          &cycle->callbacks, fmi2False, fmi2False);
    if (!cycle->component) return fail(cycle, "fmi2Instantiate returned a null pointer");
    fmi2Component c = cycle->component;
    if (cycle->SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) != fmi2OK ||
        cycle->EnterInitializationMode(c) != fmi2OK || cycle->ExitInitializationMode(c) != fmi2OK)
        return fail(cycle, "initialization failed");
    return cycle;
}

long long cycle_run(struct cycle *cycle, unsigned long long cycles)
{
    static const fmi2ValueReference in[INPUTS] = {0, 1, 2};
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
        if (cycle->SetReal(cycle->component, in, INPUTS, cycle->inputs) != fmi2OK ||
            cycle->DoStep(cycle->component, size * (double)cycle->done, size, fmi2True) != fmi2OK ||
            cycle->GetReal(cycle->component, cycle->order, OUTPUTS, cycle->outputs) != fmi2OK)
            return -1;
    }
    return thread_time() - started;
}

const double *cycle_inputs(const struct cycle *cycle) { return cycle->inputs; }
const double *cycle_outputs(const struct cycle *cycle) { return cycle->outputs; }
