/* An FMU of the Functional Mock-up Interface 3.0 for model exchange and co-simulation: the mechanism of lw_model.h.
 *
 * Value references: 0 is time; then follow the states, their rates, inputs, parameters, outputs and event
 * indicators. */

#include "lw_fmi3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Copies the rows of an output's derivatives to a matrix of `total` rows; lw_model.h calls it. */
static inline void lw_put_rows(int total, int first, int rows, int columns, const double *from, double *to) {
    for (int j = 0; j < columns; ++j) {
        for (int i = 0; i < rows; ++i) {
            to[j * total + first + i] = from[j * rows + i];
        }
    }
}

#include "lw_model.h"

#include "lw_common.h"

#if LW_LIBRARY

#include "lw_library.h"

#else

#include "lw_dynamics.h"

#include "lw_integration.h"

#include "lw_derivatives.h"

#endif

enum {
    LW_FIRST_STATE = 1,
    LW_FIRST_RATE = LW_FIRST_STATE + LW_STATES,
    LW_FIRST_INPUT = LW_FIRST_RATE + (LW_LIBRARY ? 0 : LW_STATES),
    LW_FIRST_PARAMETER = LW_FIRST_INPUT + LW_NU,
    LW_FIRST_OUTPUT = LW_FIRST_PARAMETER + LW_NP,
    LW_FIRST_INDICATOR = LW_FIRST_OUTPUT + LW_NY,
    LW_VARIABLES = LW_FIRST_INDICATOR + LW_CONTACTS
};

/* Modes of an instance, as sets. */
enum {
    LW_INSTANTIATED = 1,
    LW_INITIALISING = 2,
    LW_EVENT = 4,
    LW_CONTINUOUS = 8,
    LW_STEPPING = 16,
    LW_TERMINATED = 32,
    LW_ANY = 63
};

typedef struct {
    bool is_co_simulation;
    bool is_current; /* whether `values` are those of the state */
    bool has_stop;
    double stop;
    double tolerance;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    lw_state state;
    lw_values values;
} lw_instance;

/* Reports an error with the logger of the importer. */
static fmi3Status lw_fail(const lw_instance *s, fmi3Status status, const char *function, const char *message) {
    char text[512];
    if (s->log) {
        snprintf(text, sizeof text, "%s: %s", function, message);
        s->log(s->environment, status, "logStatusError", text);
    }
    return status;
}

/* Reports an error of a variable. */
static fmi3Status lw_fail_of(const lw_instance *s, const char *function, fmi3ValueReference reference,
    const char *message) {
    char text[256];
    if (reference < LW_VARIABLES) {
        snprintf(text, sizeof text, "`%.120s` %s", lw_names[reference], message);
    } else {
        snprintf(text, sizeof text, "there is no variable with the value reference %lu", (unsigned long)reference);
    }
    return lw_fail(s, fmi3Error, function, text);
}

/* Checks that a function may be called in the present mode. */
static bool lw_may(const lw_instance *s, int modes, const char *function) {
    static const char *const names[6] = {"after instantiation", "in Initialization Mode", "in Event Mode",
        "in Continuous-Time Mode", "in Step Mode", "after termination"};
    char text[128];
    if (!s) {
        return false;
    }
    if (s->state.mode & modes) {
        return true;
    }
    int mode = 0;
    while (mode < 5 && !(s->state.mode >> mode & 1)) {
        ++mode;
    }
    snprintf(text, sizeof text, "wrong order of calls: not allowed %s", names[mode]);
    lw_fail(s, fmi3Error, function, text);
    return false;
}

/* Begins a function of the interface that may be called in some modes. */
#define LW_BEGIN(modes, function)                 \
    lw_instance *s = (lw_instance *)instance;     \
    if (!lw_may(s, modes, function)) {            \
        return fmi3Error;                         \
    }

/* Requires a condition on the arguments. */
#define LW_REQUIRE(condition, function, message)            \
    if (!(condition)) {                                     \
        return lw_fail(s, fmi3Error, function, message);    \
    }

/* Decay rate of violated constraints in the present mode. */
static double lw_decay(const lw_instance *s) {
    return !s->is_co_simulation && s->state.mode == LW_CONTINUOUS ? LW_STABILISATION : 0.0;
}

/* Computes the values of the state unless they are known. */
static fmi3Status lw_update(lw_instance *s, const char *function, fmi3Status status) {
    if (!s->is_current) {
        const char *problem = lw_evaluate(&s->state, lw_decay(s), &s->values);
        if (problem) {
            return lw_fail(s, status, function, problem);
        }
        s->is_current = true;
    }
    return fmi3OK;
}

/* Replaces the state by another one, which keeps the mechanism of the instance in the library. */
static void lw_replace(lw_instance *s, const lw_state *state) {
#if LW_LIBRARY
    lw_robot *robot = s->state.robot;
    s->state = *state;
    s->state.robot = robot;
#else
    s->state = *state;
#endif
    s->is_current = false;
}

static void lw_reset(lw_instance *s) {
    static const lw_state zero;
    lw_replace(s, &zero);
    s->state.mode = LW_INSTANTIATED;
    s->state.step = 1e-3;
    memcpy(s->state.states, lw_start, LW_STATES * sizeof(double));
    memcpy(s->state.inputs, lw_start + LW_STATES, LW_NU * sizeof(double));
    memcpy(s->state.parameters, lw_start + LW_STATES + LW_NU, LW_NP * sizeof(double));
    s->is_current = false;
    s->has_stop = false;
    s->tolerance = 1e-8;
}

static fmi3Instance lw_instantiate(const char *token, bool is_co_simulation, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log) {
    lw_instance *s = (lw_instance *)calloc(1, sizeof *s);
    if (!s) {
        return NULL;
    }
    s->is_co_simulation = is_co_simulation;
    s->environment = environment;
    s->log = log;
    if (!token || strcmp(token, LW_TOKEN) != 0) {
        lw_fail(s, fmi3Error, "fmi3Instantiate", "the instantiation token is not that of modelDescription.xml");
        free(s);
        return NULL;
    }
#if LW_LIBRARY
    const char *problem = is_co_simulation ? lw_open(&s->state) : "the model is for co-simulation";
    if (problem) {
        lw_fail(s, fmi3Error, "fmi3Instantiate", problem);
        free(s);
        return NULL;
    }
#endif
    lw_reset(s);
    return s;
}

LW_EXPORT void LW_FMI(fmi3FreeInstance)(fmi3Instance instance) {
#if LW_LIBRARY
    if (instance) {
        lw_free(((lw_instance *)instance)->state.robot);
    }
#endif
    free(instance);
}

LW_EXPORT const char *LW_FMI(fmi3GetVersion)(void) {
    return "3.0";
}

/* Checks the categories. There are no messages for debugging, and errors are always reported. */
LW_EXPORT fmi3Status LW_FMI(fmi3SetDebugLogging)(fmi3Instance instance, fmi3Boolean on, size_t count,
    const fmi3String categories[]) {
    LW_BEGIN(LW_ANY, "fmi3SetDebugLogging")
    (void)on;
    LW_REQUIRE(count == 0 || categories, "fmi3SetDebugLogging", "`categories` is NULL")
    for (size_t k = 0; k < count; ++k) {
        const bool is_known = categories[k] && strcmp(categories[k], "logStatusError") == 0;
        LW_REQUIRE(is_known, "fmi3SetDebugLogging", "the only log category is logStatusError")
    }
    return fmi3OK;
}

LW_EXPORT fmi3Instance LW_FMI(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
    fmi3Boolean visible, fmi3Boolean logs, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    (void)name, (void)resources, (void)visible, (void)logs;
    return lw_instantiate(token, false, environment, log);
}

LW_EXPORT fmi3Instance LW_FMI(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
    fmi3Boolean visible, fmi3Boolean logs, fmi3Boolean uses_events, fmi3Boolean may_return_early,
    const fmi3ValueReference intermediate[], size_t count, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
    (void)name, (void)resources, (void)visible, (void)logs, (void)may_return_early, (void)intermediate, (void)update;
    lw_instance *s = (lw_instance *)lw_instantiate(token, true, environment, log);
    if (s && (uses_events || count > 0)) {
        lw_fail(s, fmi3Error, "fmi3InstantiateCoSimulation", "there is no Event Mode and no intermediate update");
        LW_FMI(fmi3FreeInstance)(s);
        return NULL;
    }
    return s;
}

LW_EXPORT fmi3Instance LW_FMI(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token,
    fmi3String resources, fmi3Boolean visible, fmi3Boolean logs, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logs, (void)clock, (void)lock, (void)unlock;
    if (log) {
        log(environment, fmi3Error, "logStatusError", "fmi3InstantiateScheduledExecution: not supported");
    }
    return NULL;
}

LW_EXPORT fmi3Status LW_FMI(fmi3EnterInitializationMode)(fmi3Instance instance, fmi3Boolean has_tolerance,
    fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop) {
    static const char function[] = "fmi3EnterInitializationMode";
    LW_BEGIN(LW_INSTANTIATED, function)
    LW_REQUIRE(!has_tolerance || (tolerance > 0.0 && isfinite(tolerance)), function, "the tolerance is not positive")
    LW_REQUIRE(isfinite(start), function, "the start time is not finite")
    LW_REQUIRE(!has_stop || stop >= start, function, "the stop time is before the start time")
    s->tolerance = has_tolerance ? fmax(tolerance, 1e-13) : s->tolerance;
    s->state.time = start;
    s->has_stop = has_stop;
    s->stop = stop;
    s->state.mode = LW_INITIALISING;
    s->is_current = false;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3ExitInitializationMode)(fmi3Instance instance) {
    static const char function[] = "fmi3ExitInitializationMode";
    LW_BEGIN(LW_INITIALISING, function)
    const lw_state before = s->state;
    const char *problem = lw_check_parameters(&s->state);
    problem = problem ? problem : lw_make_consistent(&s->state, 1e-12);
    s->is_current = false;
    problem = problem ? problem : lw_evaluate(&s->state, 0.0, &s->values);
    if (problem) {
        s->state = before;
        return lw_fail(s, fmi3Error, function, problem);
    }
    s->state.mode = s->is_co_simulation ? LW_STEPPING : LW_EVENT;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3EnterEventMode)(fmi3Instance instance) {
    LW_BEGIN(LW_CONTINUOUS, "fmi3EnterEventMode")
    s->state.mode = LW_EVENT;
    s->is_current = false;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3Terminate)(fmi3Instance instance) {
    LW_BEGIN(LW_EVENT | LW_CONTINUOUS | LW_STEPPING, "fmi3Terminate")
    s->state.mode = LW_TERMINATED;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3Reset)(fmi3Instance instance) {
    LW_BEGIN(LW_ANY, "fmi3Reset")
    lw_reset(s);
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3GetFloat64)(fmi3Instance instance, const fmi3ValueReference references[],
    size_t count, fmi3Float64 values[], size_t length) {
    static const char function[] = "fmi3GetFloat64";
    LW_BEGIN(LW_ANY, function)
    LW_REQUIRE(count == 0 || (references && values), function, "an argument is NULL")
    LW_REQUIRE(length == count, function, "the number of values differs from that of the variables, all scalars")
    for (size_t k = 0; k < count; ++k) {
        const fmi3ValueReference r = references[k];
        const bool is_stored = r < LW_FIRST_RATE || (r >= LW_FIRST_INPUT && r < LW_FIRST_OUTPUT);
        if (r >= LW_VARIABLES) {
            return lw_fail_of(s, function, r, "");
        }
        if (!is_stored && lw_update(s, function, fmi3Error) != fmi3OK) {
            return fmi3Error;
        }
        values[k] = r < LW_FIRST_STATE ? s->state.time
            : r < LW_FIRST_RATE ? s->state.states[r - LW_FIRST_STATE]
            : r < LW_FIRST_INPUT ? s->values.rates[r - LW_FIRST_RATE]
            : r < LW_FIRST_PARAMETER ? s->state.inputs[r - LW_FIRST_INPUT]
            : r < LW_FIRST_OUTPUT ? s->state.parameters[r - LW_FIRST_PARAMETER]
            : r < LW_FIRST_INDICATOR ? s->values.outputs[r - LW_FIRST_OUTPUT]
            : s->values.indicators[r - LW_FIRST_INDICATOR];
    }
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3SetFloat64)(fmi3Instance instance, const fmi3ValueReference references[],
    size_t count, const fmi3Float64 values[], size_t length) {
    static const char function[] = "fmi3SetFloat64";
    LW_BEGIN(LW_ANY & ~LW_TERMINATED, function)
    LW_REQUIRE(count == 0 || (references && values), function, "an argument is NULL")
    LW_REQUIRE(length == count, function, "the number of values differs from that of the variables, all scalars")
    const bool starts = s->state.mode & (LW_INSTANTIATED | LW_INITIALISING);
    const bool tunes = starts || s->state.mode & (LW_EVENT | LW_STEPPING);
    const lw_state before = s->state;
    bool are_tuned = false;
    for (size_t k = 0; k < count; ++k) {
        const fmi3ValueReference r = references[k];
        const bool is_state = r >= LW_FIRST_STATE && r < LW_FIRST_RATE;
        const bool is_input = r >= LW_FIRST_INPUT && r < LW_FIRST_PARAMETER;
        const bool is_parameter = r >= LW_FIRST_PARAMETER && r < LW_FIRST_OUTPUT;
        const char *problem = !(is_state || is_input || is_parameter) ? "cannot be set"
            : !isfinite(values[k]) ? "is set to a value that is not finite"
            : is_state && !starts ? "is a state: it can be set until initialization ends"
            : is_parameter && !tunes ? "is a parameter: set it between steps or in Event Mode"
            : NULL;
        if (problem) {
            s->state = before;
            return lw_fail_of(s, function, r, problem);
        }
        if (is_state) {
            s->state.states[r - LW_FIRST_STATE] = values[k];
        } else if (is_input) {
            s->state.inputs[r - LW_FIRST_INPUT] = values[k];
        } else {
            s->state.parameters[r - LW_FIRST_PARAMETER] = values[k];
            are_tuned = true;
        }
    }
    const char *problem = are_tuned && !starts ? lw_check_parameters(&s->state) : NULL;
    if (problem) {
        s->state = before;
        return lw_fail(s, fmi3Error, function, problem);
    }
    s->is_current = false;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3GetFMUState)(fmi3Instance instance, fmi3FMUState *state) {
    LW_BEGIN(LW_ANY, "fmi3GetFMUState")
    LW_REQUIRE(state, "fmi3GetFMUState", "the pointer to the state is NULL")
    *state = *state ? *state : malloc(sizeof(lw_state));
    LW_REQUIRE(*state, "fmi3GetFMUState", "there is no memory left")
    memcpy(*state, &s->state, sizeof s->state);
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3SetFMUState)(fmi3Instance instance, fmi3FMUState state) {
    LW_BEGIN(LW_ANY, "fmi3SetFMUState")
    LW_REQUIRE(state, "fmi3SetFMUState", "the state is NULL")
    lw_replace(s, (const lw_state *)state);
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3FreeFMUState)(fmi3Instance instance, fmi3FMUState *state) {
    LW_BEGIN(LW_ANY, "fmi3FreeFMUState")
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

/* A serialised state begins with the token of the model. */
#define LW_SERIALISED (sizeof LW_TOKEN + sizeof(lw_state))

LW_EXPORT fmi3Status LW_FMI(fmi3SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state, size_t *size) {
    LW_BEGIN(LW_ANY, "fmi3SerializedFMUStateSize")
    LW_REQUIRE(state && size, "fmi3SerializedFMUStateSize", "an argument is NULL")
    *size = LW_SERIALISED;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3SerializeFMUState)(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],
    size_t size) {
    LW_BEGIN(LW_ANY, "fmi3SerializeFMUState")
    LW_REQUIRE(state && bytes && size == LW_SERIALISED, "fmi3SerializeFMUState", "NULL, or another size")
    memcpy(bytes, LW_TOKEN, sizeof LW_TOKEN);
    memcpy(bytes + sizeof LW_TOKEN, state, sizeof(lw_state));
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3DeserializeFMUState)(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
    fmi3FMUState *state) {
    static const char function[] = "fmi3DeserializeFMUState";
    LW_BEGIN(LW_ANY, function)
    LW_REQUIRE(state && bytes && size == LW_SERIALISED, function, "NULL, or another size")
    LW_REQUIRE(memcmp(bytes, LW_TOKEN, sizeof LW_TOKEN) == 0, function, "the bytes are no state of this model")
    lw_state copy;
    memcpy(&copy, bytes + sizeof LW_TOKEN, sizeof copy);
    const int kinds = s->is_co_simulation ? LW_STEPPING : LW_EVENT | LW_CONTINUOUS;
    const int modes = kinds | LW_INSTANTIATED | LW_INITIALISING | LW_TERMINATED;
    const bool is_one = copy.mode > 0 && (copy.mode & (copy.mode - 1)) == 0 && copy.mode & modes;
    const bool is_finite = isfinite(copy.time) && copy.step > 0.0 && lw_all_finite(LW_STATES, copy.states);
    LW_REQUIRE(is_one && is_finite, function, "the bytes are no state of this model")
    *state = *state ? *state : malloc(sizeof copy);
    LW_REQUIRE(*state, function, "there is no memory left")
    memcpy(*state, &copy, sizeof copy);
    return fmi3OK;
}

#if LW_DIFFERENTIABLE

/* Index of a variable among states, inputs and parameters, or -1. */
static int lw_known(fmi3ValueReference r) {
    return r >= LW_FIRST_STATE && r < LW_FIRST_RATE ? (int)r - LW_FIRST_STATE
        : r >= LW_FIRST_INPUT && r < LW_FIRST_OUTPUT ? (int)r - LW_FIRST_INPUT + LW_STATES
        : -1;
}

/* Index of a variable among rates and outputs, or -1. */
static int lw_unknown(fmi3ValueReference r) {
    return r >= LW_FIRST_RATE && r < LW_FIRST_INPUT ? (int)r - LW_FIRST_RATE
        : r >= LW_FIRST_OUTPUT && r < LW_FIRST_INDICATOR ? (int)r - LW_FIRST_OUTPUT + LW_STATES
        : -1;
}

/* Computes the product of the derivatives with a seed, for one known or for all of them together. */
static fmi3Status lw_derivative(lw_instance *s, const char *function, bool is_adjoint,
    const fmi3ValueReference unknowns[], size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count,
    const fmi3Float64 seed[], size_t seed_length, fmi3Float64 result[], size_t length) {
    double change[LW_AT_LEAST_ONE(LW_KNOWNS)] = {0.0}, changes[LW_UNKNOWNS] = {0.0};
    const bool are_given = (unknown_count == 0 || unknowns) && (known_count == 0 || knowns);
    const size_t expected = is_adjoint ? unknown_count : known_count;
    LW_REQUIRE(are_given && (seed || !seed_length) && (result || !length), function, "an argument is NULL")
    LW_REQUIRE(seed_length == expected && length == unknown_count + known_count - expected, function,
        "an array has another length than the variables, all scalars")
    for (size_t k = 0; k < known_count; ++k) {
        if (lw_known(knowns[k]) < 0) {
            return lw_fail_of(s, function, knowns[k], "is no state, input or parameter");
        }
    }
    for (size_t k = 0; k < unknown_count; ++k) {
        const bool is_constant = unknowns[k] >= LW_FIRST_STATE && unknowns[k] < LW_FIRST_RATE;
        if (lw_unknown(unknowns[k]) < 0 && !is_constant) {
            return lw_fail_of(s, function, unknowns[k], "is no rate, state or output");
        }
    }
    lw_derivatives *d = (lw_derivatives *)malloc(sizeof *d);
    LW_REQUIRE(d, function, "there is no memory left")
    const char *problem = lw_differentiate(&s->state, lw_decay(s), d);
    if (problem) {
        free(d);
        return lw_fail(s, fmi3Error, function, problem);
    }
    const size_t rounds = is_adjoint ? known_count : 1;
    for (size_t round = 0; round < rounds && !problem; ++round) {
        double sum = 0.0;
        memset(change, 0, sizeof change);
        for (size_t k = 0; k < known_count; ++k) {
            change[lw_known(knowns[k])] += is_adjoint ? (k == round ? 1.0 : 0.0) : seed[k];
        }
        problem = lw_apply(&s->state, lw_decay(s), d, change, changes);
        for (size_t k = 0; k < unknown_count; ++k) {
            /* A state that is an output depends on itself. */
            const int at = lw_unknown(unknowns[k]);
            const double value = at >= 0 ? changes[at] : change[unknowns[k] - LW_FIRST_STATE];
            if (is_adjoint) {
                sum += seed[k] * value;
            } else {
                result[k] = value;
            }
        }
        if (is_adjoint) {
            result[round] = sum;
        }
    }
    free(d);
    return problem ? lw_fail(s, fmi3Error, function, problem) : fmi3OK;
}

#else

/* Reports that there are no derivatives. */
static fmi3Status lw_derivative(lw_instance *s, const char *function, bool is_adjoint,
    const fmi3ValueReference unknowns[], size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count,
    const fmi3Float64 seed[], size_t seed_length, fmi3Float64 result[], size_t length) {
    (void)is_adjoint, (void)unknowns, (void)unknown_count, (void)knowns, (void)known_count;
    (void)seed, (void)seed_length, (void)result, (void)length;
    return lw_fail(s, fmi3Error, function, "the model provides no derivatives");
}

#endif

LW_EXPORT fmi3Status LW_FMI(fmi3GetDirectionalDerivative)(fmi3Instance instance, const fmi3ValueReference unknowns[],
    size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
    size_t seed_length, fmi3Float64 sensitivity[], size_t length) {
    LW_BEGIN(LW_ANY & ~LW_INSTANTIATED, "fmi3GetDirectionalDerivative")
    return lw_derivative(s, "fmi3GetDirectionalDerivative", false, unknowns, unknown_count, knowns, known_count,
        seed, seed_length, sensitivity, length);
}

LW_EXPORT fmi3Status LW_FMI(fmi3GetAdjointDerivative)(fmi3Instance instance, const fmi3ValueReference unknowns[],
    size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
    size_t seed_length, fmi3Float64 sensitivity[], size_t length) {
    LW_BEGIN(LW_ANY & ~LW_INSTANTIATED, "fmi3GetAdjointDerivative")
    return lw_derivative(s, "fmi3GetAdjointDerivative", true, unknowns, unknown_count, knowns, known_count,
        seed, seed_length, sensitivity, length);
}

#include "lw_modes.h"

#include "lw_unused.h"
