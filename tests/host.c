/* A host in C for the tests: loads the runtime library and calls its functions through the types
 * of the standard's own header, so that a call which does not fit them is no program.
 *
 *     host LIBRARY
 *
 * Each line of stdin is a request, a function without its `fmi2` and its arguments:
 *
 *     Instantiate  SLOT NAME GUID URI TYPE LOGGING_ON CALLBACKS
 *     GetReal      SLOT N VALUE_REFERENCES VALUES
 *     DoStep       SLOT POINT SIZE NO_SET_FMU_STATE_PRIOR_TO_CURRENT_POINT
 *
 *     Lives        COUNT GUID URI
 *     Run          "at once" or "in turn" STEPS OUTPUT
 *     Modes        GUID URI N VALUE_REFERENCES
 *
 * and so on, as `requests` has them; `in-thread` before the function makes the call from another
 * thread. FMU states have slots of their own, which are numbered alike; bytes are hexadecimal. The answer is one line for each message that the logger got meanwhile and a last one:
 *
 *     log     SLOT INSTANCE_NAME STATUS CATEGORY MESSAGE
 *     answer  STATUS RESULT...
 *
 * Fields are separated by tabs. In them `\t`, `\n` and `\\` stand for these characters, `\xFF` for
 * the byte of that number and `\N` for a null pointer. Items of a list are separated by commas. Slots are 0 to 3; `\N` is the null
 * instance. At the end of stdin all instances and states are freed. Whatever the host did not expect ends
 * it with a message on stderr and status 1. */

#define _POSIX_C_SOURCE 200809L

#include <dlfcn.h>
#include <fenv.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* ---- the library ---- */

#define FUNCTIONS(X)                                                                               \
    X(GetTypesPlatform) X(GetVersion) X(SetDebugLogging) X(Instantiate) X(FreeInstance)            \
    X(SetupExperiment) X(EnterInitializationMode) X(ExitInitializationMode) X(Terminate) X(Reset)  \
    X(GetReal) X(GetInteger) X(GetBoolean) X(GetString)                                            \
    X(SetReal) X(SetInteger) X(SetBoolean) X(SetString)                                            \
    X(GetFMUstate) X(SetFMUstate) X(FreeFMUstate)                                                  \
    X(SerializedFMUstateSize) X(SerializeFMUstate) X(DeSerializeFMUstate)                          \
    X(GetDirectionalDerivative)                                                                    \
    X(EnterEventMode) X(NewDiscreteStates) X(EnterContinuousTimeMode) X(CompletedIntegratorStep)   \
    X(SetTime) X(SetContinuousStates) X(GetDerivatives) X(GetEventIndicators)                      \
    X(GetContinuousStates) X(GetNominalsOfContinuousStates)                                        \
    X(SetRealInputDerivatives) X(GetRealOutputDerivatives) X(DoStep) X(CancelStep)                 \
    X(GetStatus) X(GetRealStatus) X(GetIntegerStatus) X(GetBooleanStatus) X(GetStringStatus)

static struct {
#define X(name) fmi2##name##TYPE *name;
    FUNCTIONS(X)
#undef X
} fmu;

static void fail(const char *what, const char *detail)
{
    fprintf(stderr, "host: %s: %s\n", what, detail);
    exit(1);
}

static void *load(const char *path)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) fail("cannot load the library", dlerror());
#define X(name)                                                                                    \
    {                                                                                              \
        void *symbol = dlsym(library, "fmi2" #name);                                               \
        if (!symbol) fail("not exported", "fmi2" #name);                                           \
        /* ISO C converts no object pointer to a function pointer; POSIX has them alike. */        \
        memcpy(&fmu.name, &symbol, sizeof symbol);                                                 \
    }
    FUNCTIONS(X)
#undef X
    return library;
}

/* ---- requests and answers ---- */

/* What is left of the request. */
static char *rest;

/* Cuts the next piece off `*text`; a null pointer if nothing is left. */
static char *cut(char **text, char separator)
{
    char *piece = *text;
    if (piece) {
        char *end = strchr(piece, separator);
        *text = end ? end + 1 : NULL;
        if (end) *end = '\0';
    }
    return piece;
}

static char *field(void)
{
    char *text = cut(&rest, '\t');
    if (!text) fail("request too short", "a field is missing");
    return text;
}

static int is(const char *a, const char *b) { return strcmp(a, b) == 0; }

/* Resolves the escapes of a text in place; a null pointer for `\N`. */
static char *unescape(char *text)
{
    if (is(text, "\\N")) return NULL;
    char *to = text;
    for (const char *from = text; *from; from++) {
        if (*from == '\\') {
            from++;
            unsigned byte;
            if (*from == 'x' && sscanf(from + 1, "%2x", &byte) == 1) {
                *to++ = (char)byte;
                from += 2;
            } else {
                *to++ = *from == 't' ? '\t' : *from == 'n' ? '\n' : *from;
            }
        } else {
            *to++ = *from;
        }
    }
    *to = '\0';
    return text;
}

static double real(const char *text)
{
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end) fail("not a number", text);
    return value;
}

static long long integer(const char *text)
{
    char *end;
    long long value = strtoll(text, &end, 10);
    if (end == text || *end) fail("not an integer", text);
    return value;
}

static size_t size(const char *text) { return strtoull(text, NULL, 10); }

#define LONGEST_LIST 256

/* Takes a list into `items`; a null pointer for `\N`. */
#define LIST(type, name, parse)                                                                    \
    static type *name(type items[LONGEST_LIST])                                                    \
    {                                                                                              \
        char *text = field();                                                                      \
        if (is(text, "\\N")) return NULL;                                                          \
        size_t n = 0;                                                                              \
        for (char *item; *text && (item = cut(&text, ',')); n++) {                                 \
            if (n == LONGEST_LIST) fail("too many items", item);                                   \
            items[n] = (type)parse(item);                                                          \
            if (!text) break;                                                                      \
        }                                                                                          \
        return items;                                                                              \
    }

LIST(fmi2Real, reals, real)
LIST(fmi2Integer, integers, integer)
LIST(fmi2ValueReference, value_references, integer)
LIST(fmi2String, strings, unescape)

static void put_text(const char *text)
{
    putchar('\t');
    if (!text) fputs("\\N", stdout);
    for (; text && *text; text++) {
        switch (*text) {
        case '\t': fputs("\\t", stdout); break;
        case '\n': fputs("\\n", stdout); break;
        case '\\': fputs("\\\\", stdout); break;
        default: putchar(*text);
        }
    }
}

static void put_real(fmi2Real value) { printf("\t%.17g", value); }
static void put_integer(fmi2Integer value) { printf("\t%d", value); }

static void answer(fmi2Status status) { printf("answer\t%d", (int)status); }

/* ---- instances ---- */

static struct slot {
    int number;
    fmi2Component component;
    /* Lives as long as the instance, which may use it. */
    fmi2CallbackFunctions *callbacks;
    /* Whether its logger calls functions of the instance. */
    int calls_back;
} slots[4] = {{.number = 0}, {.number = 1}, {.number = 2}, {.number = 3}};

static struct slot *slot(const char *text)
{
    long long number = integer(text);
    if (number < 0 || number >= (long long)COUNT(slots)) fail("no such slot", text);
    return &slots[number];
}

static fmi2Component component(void)
{
    char *text = field();
    if (is(text, "\\N")) return NULL;
    fmi2Component c = slot(text)->component;
    if (!c) fail("no instance in slot", text);
    return c;
}

/* What no logger may do: calls that read, change and free the instance. */
static void call_back(fmi2Component c)
{
    const fmi2ValueReference first = 1;
    fmi2Real value = 7.0;
    fmi2Status statuses[] = {
        fmu.GetReal(c, &first, 1, &value),
        fmu.SetReal(c, &first, 1, &value),
        fmu.DoStep(c, 0.0, 0.1, fmi2True),
        fmu.Reset(c),
    };
    fmu.FreeInstance(c);
    fputs(value == 7.0 ? " called back:" : " a value was written:", stdout);
    for (size_t k = 0; k < COUNT(statuses); k++) printf(" %d", (int)statuses[k]);
}

static void logger(fmi2ComponentEnvironment environment, fmi2String instance_name,
                   fmi2Status status, fmi2String category, fmi2String message, ...)
{
    const struct slot *from = environment;
    va_list arguments, again;
    va_start(arguments, message);
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, message, arguments);
    char *text = malloc((size_t)length + 1);
    if (length < 0 || !text) fail("cannot format", message);
    vsnprintf(text, (size_t)length + 1, message, again);
    va_end(again);
    va_end(arguments);

    printf("log\t%d", from->number);
    put_text(instance_name);
    printf("\t%d", (int)status);
    put_text(category);
    put_text(text);
    if (from->calls_back) call_back(from->component);
    putchar('\n');
    free(text);
}

/* Frees what is in a slot, if anything. */
static void discard(struct slot *which)
{
    fmu.FreeInstance(which->component);
    free(which->callbacks);
    which->component = NULL;
    which->callbacks = NULL;
}

static void instantiate(void)
{
    struct slot *to = slot(field());
    if (to->component) fail("slot in use", "Instantiate");
    char *name = unescape(field()), *guid = unescape(field()), *uri = unescape(field());
    fmi2Type type = (fmi2Type)integer(field());
    fmi2Boolean logging_on = (fmi2Boolean)integer(field());
    char *callbacks = field();
    to->calls_back = is(callbacks, "calls back");
    if (!is(callbacks, "none")) {
        fmi2CallbackFunctions functions = {
            .logger = is(callbacks, "no logger") ? NULL : logger,
            .allocateMemory = calloc,
            .freeMemory = free,
            .componentEnvironment = to,
        };
        to->callbacks = malloc(sizeof functions);
        if (!to->callbacks) fail("no memory", "Instantiate");
        memcpy(to->callbacks, &functions, sizeof functions);
    }
    to->component = fmu.Instantiate(name, type, guid, uri, to->callbacks, fmi2False, logging_on);
    answer(fmi2OK);
    put_integer(to->component != NULL);
    if (!to->component) discard(to);
}

static void free_instance(void)
{
    char *text = field();
    if (is(text, "\\N"))
        fmu.FreeInstance(NULL);
    else
        discard(slot(text));
    answer(fmi2OK);
}

/* ---- the functions, by the shape of their arguments ---- */

static void get_types_platform(void) { answer(fmi2OK); put_text(fmu.GetTypesPlatform()); }
static void get_version(void) { answer(fmi2OK); put_text(fmu.GetVersion()); }

#define WITHOUT_ARGUMENTS(X)                                                                       \
    X(EnterInitializationMode) X(ExitInitializationMode) X(Terminate) X(Reset) X(CancelStep)       \
    X(EnterEventMode) X(EnterContinuousTimeMode)

#define X(name)                                                                                    \
    static void call_##name(void) { answer(fmu.name(component())); }
WITHOUT_ARGUMENTS(X)
#undef X

static void set_debug_logging(void)
{
    fmi2String categories[LONGEST_LIST];
    fmi2Component c = component();
    fmi2Boolean on = (fmi2Boolean)integer(field());
    size_t n = size(field());
    answer(fmu.SetDebugLogging(c, on, n, strings(categories)));
}

static void setup_experiment(void)
{
    fmi2Component c = component();
    fmi2Real start = real(field());
    char *stop = field();
    fmi2Boolean stops = !is(stop, "\\N");
    answer(fmu.SetupExperiment(c, fmi2False, 0.0, start, stops, stops ? real(stop) : 0.0));
}

static void do_step(void)
{
    fmi2Component c = component();
    fmi2Real point = real(field()), step = real(field());
    fmi2Boolean no_set_prior = (fmi2Boolean)integer(field());
    answer(fmu.DoStep(c, point, step, no_set_prior));
}

/* Values that a getter has not written come back as 7; those of strings as null. */
#define ACCESS(type, initial, put, parse)                                                          \
    static void get_##type(void)                                                                   \
    {                                                                                              \
        fmi2ValueReference vr[LONGEST_LIST];                                                       \
        fmi2##type values[LONGEST_LIST];                                                           \
        for (size_t k = 0; k < LONGEST_LIST; k++) values[k] = initial;                             \
        fmi2Component c = component();                                                             \
        size_t n = size(field());                                                                  \
        const fmi2ValueReference *from = value_references(vr);                                     \
        int none = is(field(), "\\N");                                                             \
        answer(fmu.Get##type(c, from, n, none ? NULL : values));                                   \
        for (size_t k = 0; !none && k < n && k < LONGEST_LIST; k++) put(values[k]);                \
    }                                                                                              \
    static void set_##type(void)                                                                   \
    {                                                                                              \
        fmi2ValueReference vr[LONGEST_LIST];                                                       \
        fmi2##type values[LONGEST_LIST];                                                           \
        fmi2Component c = component();                                                             \
        size_t n = size(field());                                                                  \
        const fmi2ValueReference *to = value_references(vr);                                       \
        answer(fmu.Set##type(c, to, n, parse(values)));                                            \
    }

ACCESS(Real, 7.0, put_real, reals)
ACCESS(Integer, 7, put_integer, integers)
ACCESS(Boolean, 7, put_integer, integers)
ACCESS(String, NULL, put_text, strings)

static void set_real_input_derivatives(void)
{
    fmi2ValueReference vr[LONGEST_LIST];
    fmi2Integer orders[LONGEST_LIST];
    fmi2Real values[LONGEST_LIST];
    fmi2Component c = component();
    size_t n = size(field());
    const fmi2ValueReference *to = value_references(vr);
    const fmi2Integer *order = integers(orders);
    answer(fmu.SetRealInputDerivatives(c, to, n, order, reals(values)));
}

#define STATUS(name, type, initial, put)                                                           \
    static void call_##name(void)                                                                  \
    {                                                                                              \
        type value = initial;                                                                      \
        fmi2Component c = component();                                                             \
        fmi2StatusKind kind = (fmi2StatusKind)integer(field());                                    \
        int none = is(field(), "\\N");                                                             \
        answer(fmu.name(c, kind, none ? NULL : &value));                                           \
        put(value);                                                                                \
    }

static void put_status(fmi2Status status) { put_integer((fmi2Integer)status); }

STATUS(GetStatus, fmi2Status, fmi2Pending, put_status)
STATUS(GetRealStatus, fmi2Real, 7.0, put_real)
STATUS(GetIntegerStatus, fmi2Integer, 7, put_integer)
STATUS(GetBooleanStatus, fmi2Boolean, 7, put_integer)
STATUS(GetStringStatus, fmi2String, NULL, put_text)

/* ---- FMU states ---- */

static fmi2FMUstate states[4];

/* A place for a state; a null pointer for `\N`. */
static fmi2FMUstate *place(void)
{
    char *text = field();
    if (is(text, "\\N")) return NULL;
    long long number = integer(text);
    if (number < 0 || number >= (long long)COUNT(states)) fail("no such slot", text);
    return &states[number];
}

/* The state in a slot, perhaps null; null for `\N`. */
static fmi2FMUstate state(void)
{
    fmi2FMUstate *from = place();
    return from ? *from : NULL;
}

/* Tells whether there is a state then, and whether it is the object that was there before. */
#define CHANGES_STATE(name)                                                                        \
    static void call_##name(void)                                                                  \
    {                                                                                              \
        fmi2Component c = component();                                                             \
        fmi2FMUstate *to = place(), before = to ? *to : NULL;                                      \
        answer(fmu.name(c, to));                                                                   \
        if (to) put_integer(*to != NULL), put_integer(*to == before);                              \
    }

CHANGES_STATE(GetFMUstate)
CHANGES_STATE(FreeFMUstate)

static void set_fmu_state(void)
{
    fmi2Component c = component();
    answer(fmu.SetFMUstate(c, state()));
}

static void serialized_fmu_state_size(void)
{
    size_t bytes = 7;
    fmi2Component c = component();
    fmi2FMUstate from = state();
    int none = is(field(), "\\N");
    answer(fmu.SerializedFMUstateSize(c, from, none ? NULL : &bytes));
    printf("\t%zu", bytes);
}

static void serialize_fmu_state(void)
{
    fmi2Component c = component();
    fmi2FMUstate from = state();
    size_t n = size(field());
    int none = is(field(), "\\N");
    fmi2Byte *bytes = malloc(n + 1);
    if (!bytes) fail("no memory", "SerializeFMUstate");
    memset(bytes, 7, n + 1);
    answer(fmu.SerializeFMUstate(c, from, none ? NULL : bytes, n));
    putchar('\t');
    for (size_t k = 0; k < n; k++) printf("%02x", (unsigned char)bytes[k]);
    if (bytes[n] != 7) fail("wrote past the end", "SerializeFMUstate");
    free(bytes);
}

static void deserialize_fmu_state(void)
{
    fmi2Component c = component();
    char *text = field();
    size_t n = size(field());
    fmi2FMUstate *to = place(), before = to ? *to : NULL;
    int none = is(text, "\\N");
    /* Just as much as there is, so that reading more is an error to be found. */
    fmi2Byte *bytes = malloc(n ? n : 1);
    if (!bytes) fail("no memory", "DeSerializeFMUstate");
    for (size_t k = 0; !none && k < n; k++) {
        unsigned byte;
        if (sscanf(text + 2 * k, "%2x", &byte) != 1) fail("too few bytes", text);
        bytes[k] = (fmi2Byte)byte;
    }
    answer(fmu.DeSerializeFMUstate(c, none ? NULL : bytes, n, to));
    if (to) put_integer(*to != before);
    free(bytes);
}

static void get_real_output_derivatives(void)
{
    fmi2ValueReference vr[LONGEST_LIST];
    fmi2Integer orders[LONGEST_LIST];
    fmi2Real values[LONGEST_LIST];
    for (size_t k = 0; k < LONGEST_LIST; k++) values[k] = 7.0;
    fmi2Component c = component();
    size_t n = size(field());
    const fmi2ValueReference *from = value_references(vr);
    const fmi2Integer *order = integers(orders);
    int none = is(field(), "\\N");
    answer(fmu.GetRealOutputDerivatives(c, from, n, order, none ? NULL : values));
    for (size_t k = 0; !none && k < n && k < LONGEST_LIST; k++) put_real(values[k]);
}

static void get_directional_derivative(void)
{
    fmi2ValueReference of[LONGEST_LIST], by[LONGEST_LIST];
    fmi2Real changes[LONGEST_LIST], values[LONGEST_LIST];
    for (size_t k = 0; k < LONGEST_LIST; k++) values[k] = 7.0;
    fmi2Component c = component();
    size_t n_unknown = size(field());
    const fmi2ValueReference *unknown = value_references(of);
    size_t n_known = size(field());
    const fmi2ValueReference *known = value_references(by);
    const fmi2Real *change = reals(changes);
    int none = is(field(), "\\N");
    answer(fmu.GetDirectionalDerivative(c, unknown, n_unknown, known, n_known, change,
                                        none ? NULL : values));
    for (size_t k = 0; !none && k < n_unknown && k < LONGEST_LIST; k++) put_real(values[k]);
}

/* ---- model exchange ---- */

static void set_time(void)
{
    fmi2Component c = component();
    answer(fmu.SetTime(c, real(field())));
}

static void new_discrete_states(void)
{
    fmi2EventInfo info = {7, 7, 7, 7, 7, 7.0};
    fmi2Component c = component();
    int none = is(field(), "\\N");
    answer(fmu.NewDiscreteStates(c, none ? NULL : &info));
    put_integer(info.newDiscreteStatesNeeded);
    put_integer(info.terminateSimulation);
    put_integer(info.nominalsOfContinuousStatesChanged);
    put_integer(info.valuesOfContinuousStatesChanged);
    put_integer(info.nextEventTimeDefined);
}

static void completed_integrator_step(void)
{
    fmi2Boolean enter_event_mode = 7, terminate_simulation = 7;
    fmi2Component c = component();
    int no_event = is(field(), "\\N"), no_end = is(field(), "\\N");
    answer(fmu.CompletedIntegratorStep(c, fmi2True, no_event ? NULL : &enter_event_mode,
                                       no_end ? NULL : &terminate_simulation));
    put_integer(enter_event_mode);
    put_integer(terminate_simulation);
}

/* The arrays of continuous states and event indicators, of which there are none: nothing may be
   written there, whatever their length. */
#define OF_NONE(X)                                                                                 \
    X(SetContinuousStates) X(GetDerivatives) X(GetEventIndicators) X(GetContinuousStates)          \
    X(GetNominalsOfContinuousStates)

#define X(name)                                                                                    \
    static void call_##name(void)                                                                  \
    {                                                                                              \
        fmi2Real array[1] = {7.0};                                                                 \
        fmi2Component c = component();                                                             \
        answer(fmu.name(c, array, size(field())));                                                 \
        put_real(array[0]);                                                                        \
    }
OF_NONE(X)
#undef X

/* ---- much at once ---- */

/* Takes an instance through its life again and again, without a word in between. */
static void lives(void)
{
    long long n = integer(field());
    char *guid = unescape(field()), *uri = unescape(field());
    fmi2CallbackFunctions callbacks = {.allocateMemory = calloc, .freeMemory = free};
    const fmi2ValueReference first = 1;
    const fmi2Integer order = 1;
    int worst = fmi2OK;
    for (; n > 0; n--) {
        fmi2Component c =
            fmu.Instantiate("life", fmi2CoSimulation, guid, uri, &callbacks, fmi2False, fmi2False);
        if (!c) fail("no instance", uri);
        fmi2FMUstate saved = NULL, read = NULL;
        fmi2Real value = 0.4;
        size_t bytes = 0;
#define CALL(name, ...)                                                                            \
    do {                                                                                           \
        int status = (int)fmu.name(c, __VA_ARGS__);                                                \
        worst = status > worst ? status : worst;                                                   \
    } while (0)
        CALL(SetupExperiment, fmi2False, 0.0, 0.0, fmi2False, 0.0);
        fmu.EnterInitializationMode(c);
        fmu.ExitInitializationMode(c);
        CALL(SetReal, &first, 1, &value);
        CALL(DoStep, 0.0, 0.1, fmi2True);
        CALL(GetFMUstate, &saved);
        CALL(GetFMUstate, &saved);
        CALL(SerializedFMUstateSize, saved, &bytes);
        fmi2Byte *buffer = malloc(bytes);
        if (!buffer) fail("no memory", "Lives");
        CALL(SerializeFMUstate, saved, buffer, bytes);
        CALL(DeSerializeFMUstate, buffer, bytes, &read);
        CALL(SetFMUstate, read);
        CALL(SetRealInputDerivatives, &first, 1, &order, &value);
        CALL(DoStep, 0.1, 0.1, fmi2True);
        CALL(FreeFMUstate, &saved);
        CALL(FreeFMUstate, &read);
#undef CALL
        free(buffer);
        fmu.FreeInstance(c);
    }
    answer((fmi2Status)worst);
}

#define MOST_STEPS 100

struct runner {
    fmi2Component component;
    int steps;
    fmi2ValueReference output;
    fmi2Real values[MOST_STEPS];
};

static void *run(void *argument)
{
    struct runner *runner = argument;
    const fmi2ValueReference input = 1;
    for (int k = 0; k < runner->steps; k++) {
        fmi2Real t = 0.1 * k, value = 0.35 + 0.01 * t;
        fmu.SetReal(runner->component, &input, 1, &value);
        fmu.DoStep(runner->component, t, 0.1, fmi2True);
        fmu.GetReal(runner->component, &runner->output, 1, &runner->values[k]);
    }
    return NULL;
}

/* Runs all instances at the same time, each in a thread, or one after the other; gives an output
 * of each after every step. */
static void run_all(void)
{
    static struct runner runners[COUNT(slots)];
    pthread_t threads[COUNT(slots)];
    int at_once = is(field(), "at once");
    int steps = (int)integer(field());
    fmi2ValueReference output = (fmi2ValueReference)integer(field());
    if (steps > MOST_STEPS) fail("too many steps", "Run");
    for (size_t k = 0; k < COUNT(slots); k++) {
        runners[k].component = slots[k].component;
        runners[k].steps = slots[k].component ? steps : 0;
        runners[k].output = output;
        if (!at_once)
            run(&runners[k]);
        else if (pthread_create(&threads[k], NULL, run, &runners[k]))
            fail("no thread", "Run");
    }
    for (size_t k = 0; at_once && k < COUNT(slots); k++) pthread_join(threads[k], NULL);
    answer(fmi2OK);
    for (size_t k = 0; k < COUNT(slots); k++)
        for (int step = 0; step < runners[k].steps; step++) put_real(runners[k].values[step]);
}

/* Takes an instance through its life in each rounding mode; gives the number of values that are
 * other bits than in the first mode, to nearest, and of calls that left another mode behind. */
static void modes(void)
{
    static const int modes[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    static fmi2Real times[MOST_STEPS], inputs[MOST_STEPS];
    static fmi2Real values[MOST_STEPS][LONGEST_LIST], first[MOST_STEPS][LONGEST_LIST];
    fmi2ValueReference outputs[LONGEST_LIST];
    const fmi2ValueReference input = 1;
    char *guid = unescape(field()), *uri = unescape(field());
    size_t n = size(field());
    value_references(outputs);
    fmi2CallbackFunctions callbacks = {.allocateMemory = calloc, .freeMemory = free};
    int differences = 0, lost = 0, worst = fmi2OK;
    /* The host's own numbers are made to nearest. */
    for (int k = 0; k < MOST_STEPS; k++) {
        times[k] = 0.1 * k;
        inputs[k] = 0.35 + 0.01 * times[k];
    }
#define CALL(call)                                                                                 \
    do {                                                                                           \
        int status = (int)(call);                                                                  \
        worst = status > worst ? status : worst;                                                   \
        lost += fegetround() != modes[mode];                                                       \
    } while (0)
    for (size_t mode = 0; mode < COUNT(modes); mode++) {
        if (fesetround(modes[mode])) fail("cannot set the rounding mode", "Modes");
        fmi2Component c =
            fmu.Instantiate("mode", fmi2CoSimulation, guid, uri, &callbacks, fmi2False, fmi2False);
        lost += fegetround() != modes[mode];
        if (!c) {
            worst = fmi2Error;
            continue;
        }
        CALL(fmu.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
        CALL(fmu.EnterInitializationMode(c));
        CALL(fmu.ExitInitializationMode(c));
        for (int k = 0; k < MOST_STEPS; k++) {
            CALL(fmu.SetReal(c, &input, 1, &inputs[k]));
            CALL(fmu.DoStep(c, times[k], times[1], fmi2True));
            CALL(fmu.GetReal(c, outputs, n, values[k]));
            if (mode == 0)
                memcpy(first[k], values[k], n * sizeof *values[k]);
            else
                for (size_t j = 0; j < n; j++)
                    differences += memcmp(&first[k][j], &values[k][j], sizeof(fmi2Real)) != 0;
        }
        fmu.FreeInstance(c);
    }
#undef CALL
    fesetround(FE_TONEAREST);
    answer((fmi2Status)worst);
    put_integer(differences);
    put_integer(lost);
}

/* ---- the loop ---- */

static const struct request {
    const char *name;
    void (*make)(void);
} requests[] = {
    {"GetTypesPlatform", get_types_platform},
    {"GetVersion", get_version},
    {"Instantiate", instantiate},
    {"FreeInstance", free_instance},
    {"SetDebugLogging", set_debug_logging},
    {"SetupExperiment", setup_experiment},
    {"DoStep", do_step},
    {"GetReal", get_Real},
    {"GetInteger", get_Integer},
    {"GetBoolean", get_Boolean},
    {"GetString", get_String},
    {"SetReal", set_Real},
    {"SetInteger", set_Integer},
    {"SetBoolean", set_Boolean},
    {"SetString", set_String},
    {"SetRealInputDerivatives", set_real_input_derivatives},
    {"Lives", lives},
    {"Run", run_all},
    {"Modes", modes},
    {"GetFMUstate", call_GetFMUstate},
    {"SetFMUstate", set_fmu_state},
    {"FreeFMUstate", call_FreeFMUstate},
    {"SerializedFMUstateSize", serialized_fmu_state_size},
    {"SerializeFMUstate", serialize_fmu_state},
    {"DeSerializeFMUstate", deserialize_fmu_state},
    {"GetRealOutputDerivatives", get_real_output_derivatives},
    {"GetStatus", call_GetStatus},
    {"GetRealStatus", call_GetRealStatus},
    {"GetIntegerStatus", call_GetIntegerStatus},
    {"GetBooleanStatus", call_GetBooleanStatus},
    {"GetStringStatus", call_GetStringStatus},
#define X(name) {#name, call_##name},
    WITHOUT_ARGUMENTS(X) OF_NONE(X)
#undef X
    {"GetDirectionalDerivative", get_directional_derivative},
    {"SetTime", set_time},
    {"NewDiscreteStates", new_discrete_states},
    {"CompletedIntegratorStep", completed_integrator_step},
};

static const struct request *find(const char *name)
{
    for (size_t k = 0; k < COUNT(requests); k++)
        if (is(requests[k].name, name)) return &requests[k];
    fail("unknown request", name);
    return NULL;
}

static void *make(void *request)
{
    ((const struct request *)request)->make();
    return NULL;
}

static void serve(void)
{
    char *name = field();
    int in_thread = is(name, "in-thread");
    const struct request *request = find(in_thread ? field() : name);
    if (in_thread) {
        pthread_t thread;
        if (pthread_create(&thread, NULL, make, (void *)request) || pthread_join(thread, NULL))
            fail("no thread for", request->name);
    } else {
        request->make();
    }
    if (rest) fail("request too long", rest);
    putchar('\n');
    fflush(stdout);
}

int main(int argc, char **argv)
{
    if (argc != 2) fail("usage", "host LIBRARY");
    void *library = load(argv[1]);
    char *line = NULL;
    size_t capacity = 0;
    for (ssize_t length; (length = getline(&line, &capacity, stdin)) > 0;) {
        if (line[length - 1] == '\n') line[length - 1] = '\0';
        rest = line;
        serve();
    }
    free(line);
    for (size_t k = 0; k < COUNT(slots) * COUNT(states); k++) {
        fmi2Component c = slots[k / COUNT(states)].component;
        if (c) fmu.FreeFMUstate(c, &states[k % COUNT(states)]);
    }
    for (size_t k = 0; k < COUNT(slots); k++) discard(&slots[k]);
    if (dlclose(library)) fail("cannot unload the library", dlerror());
    return 0;
}
