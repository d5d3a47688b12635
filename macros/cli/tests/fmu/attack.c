/* An importer that is linked with the sources of an FMU and calls its functions at random: in any order, with wrong
 * lengths, value references, numbers and pointers. Prints a line for each rule that a call violates.
 *
 * Every call returns a status other than fmi3Fatal, errors have a message, a failed call changes no value, and functions
 * without an instance fail. */

#include "calls.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CAPACITY = 64, CALLS = 28 };

static uint64_t seed = 1;
static int messages = 0;

static unsigned random_below(unsigned n) {
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (unsigned)((seed >> 11) % n);
}

static double random_number(void) {
    static const double special[] = {0.0, -1.0, 1e-300, -1e300, 1e9, INFINITY, -INFINITY, NAN};
    return random_below(8) == 0 ? special[random_below(8)] : (double)random_below(2001) / 1000.0 - 1.0;
}

static bool has_luck(void) { return random_below(12) != 0; }

static void count_message(void *environment, fmi3Status status, fmi3String category, fmi3String message) {
    (void)environment, (void)status, (void)category;
    messages += message && strlen(message) > 8;
}

/* Arguments of a call, some of which are wrong. */
typedef struct {
    fmi3ValueReference references[2][CAPACITY];
    size_t counts[2];
    double numbers[CAPACITY], results[CAPACITY];
    bool flags[5];
} arguments;

static void choose(arguments *a, size_t variables) {
    for (int list = 0; list < 2; ++list) {
        a->counts[list] = random_below(6);
        for (size_t k = 0; k < CAPACITY; ++k) {
            a->references[list][k] = has_luck() ? random_below((unsigned)variables + 1) : (fmi3ValueReference)seed;
        }
    }
    for (size_t k = 0; k < CAPACITY; ++k) {
        a->numbers[k] = random_number();
    }
}

#define OR_NULL(pointer) (has_luck() ? (pointer) : NULL)
#define OR_OTHER(count) (has_luck() ? (count) : (count) + 1 + random_below(3))

static fmi3Status call(int which, instance m, fmi3FMUState *stored, size_t variables, size_t states) {
    static fmi3Byte bytes[1 << 16];
    static size_t written = 0;
    arguments a;
    choose(&a, variables);
    double *numbers = OR_NULL(a.numbers), *results = OR_NULL(a.results), now = 0.0;
    const fmi3ValueReference *first = OR_NULL(a.references[0]), *second = OR_NULL(a.references[1]);
    bool *flags = OR_NULL(a.flags);
    const size_t n = a.counts[0], k = a.counts[1];
    const fmi3ValueReference time = 0;
    size_t size = 0;
    fmi3Status status;
    switch (which) {
    case 0: return fmi3EnterInitializationMode(m, has_luck(), has_luck() ? 1e-6 : random_number(), 0.0, false, 0.0);
    case 1: return fmi3ExitInitializationMode(m);
    case 2: return fmi3EnterEventMode(m);
    case 3: return fmi3EnterContinuousTimeMode(m);
    case 4: return random_below(8) ? fmi3OK : fmi3Terminate(m);
    case 5: return random_below(8) ? fmi3OK : fmi3Reset(m);
    case 6: return fmi3GetFloat64(m, first, n, results, OR_OTHER(n));
    case 7: return fmi3SetFloat64(m, first, n, numbers, OR_OTHER(n));
    case 8: return fmi3GetInt32(m, first, n, NULL, n);
    case 9: return fmi3GetFMUState(m, has_luck() ? stored : NULL);
    case 10: return fmi3SetFMUState(m, *stored);
    case 11: return random_below(4) ? fmi3OK : fmi3FreeFMUState(m, stored);
    case 12:
        if (*stored && fmi3SerializedFMUStateSize(m, *stored, &size) == fmi3OK && size <= sizeof bytes) {
            written = size;
            return fmi3SerializeFMUState(m, *stored, has_luck() ? bytes : NULL, OR_OTHER(size));
        }
        return fmi3SerializedFMUStateSize(m, NULL, &size);
    case 13:
        if (written && !has_luck()) {
            bytes[random_below((unsigned)written)] ^= (fmi3Byte)(1 + random_below(255));
        }
        return fmi3DeserializeFMUState(m, OR_NULL(bytes), written ? OR_OTHER(written) : 0, OR_NULL(stored));
    case 14: return fmi3GetDirectionalDerivative(m, first, n, second, k, numbers, OR_OTHER(k), results, OR_OTHER(n));
    case 15: return fmi3GetAdjointDerivative(m, first, n, second, k, numbers, OR_OTHER(n), results, OR_OTHER(k));
    case 16: return fmi3UpdateDiscreteStates(m, flags, a.flags + 1, a.flags + 2, a.flags + 3, a.flags + 4, results);
    case 17: return fmi3CompletedIntegratorStep(m, true, flags, a.flags + 1);
    case 18: return fmi3SetTime(m, random_number());
    case 19: return fmi3SetContinuousStates(m, numbers, OR_OTHER(states));
    case 20: return fmi3GetContinuousStates(m, results, OR_OTHER(states));
    case 21: return fmi3GetContinuousStateDerivatives(m, results, OR_OTHER(states));
    case 22: return fmi3GetEventIndicators(m, results, random_below(4));
    case 23: return fmi3GetNominalsOfContinuousStates(m, results, OR_OTHER(states));
    case 24: return fmi3SetDebugLogging(m, true, random_below(2), NULL);
    case 25: return fmi3EnterStepMode(m);
    case 26: return fmi3GetNumberOfEventIndicators(m, OR_NULL(&size));
    default:
        status = fmi3GetFloat64(m, &time, 1, &now, 1);
        if (status != fmi3OK) {
            return status;
        }
        return fmi3DoStep(m, has_luck() ? now : random_number(), has_luck() ? 1e-3 : random_number(), true, flags,
            a.flags + 1, a.flags + 2, results);
    }
}

/* Writes all states, inputs and parameters. */
static void read_values(instance m, size_t variables, size_t states, double *values) {
    fmi3ValueReference r;
    for (size_t k = 0; k < variables && k < 4 * CAPACITY; ++k) {
        r = (fmi3ValueReference)k;
        values[k] = 0.0;
        /* Rates and outputs are computed, and need not exist. */
        if (k <= states) {
            fmi3GetFloat64(m, &r, 1, &values[k], 1);
        }
    }
}

int main(int count, char **given) {
    if (count < 4) {
        return 2;
    }
    const char *token = given[1];
    const size_t variables = (size_t)atoi(given[2]);
    const int rounds = atoi(given[3]);
    int violations = 0, failures = 0, successes = 0;
    size_t states = 0;
    for (int which = 0; which < CALLS; ++which) {
        fmi3FMUState none = NULL;
        if (which != 4 && which != 5 && which != 11 && call(which, NULL, &none, variables, 0) != fmi3Error) {
            printf("function %d succeeds without an instance\n", which);
            ++violations;
        }
    }
    for (int round = 0; round < rounds; ++round) {
        instance m = round % 2
            ? fmi3InstantiateCoSimulation("m", token, NULL, false, true, false, false, NULL, 0, NULL, count_message, NULL)
            : fmi3InstantiateModelExchange("m", token, NULL, false, true, NULL, count_message);
        fmi3FMUState stored = NULL;
        if (!m || fmi3GetNumberOfContinuousStates(m, &states) != fmi3OK) {
            return 2;
        }
        if (random_below(2)) {
            fmi3EnterInitializationMode(m, false, 0.0, 0.0, false, 0.0);
            fmi3ExitInitializationMode(m);
        }
        for (int step = 0; step < 200; ++step) {
            double before[4 * CAPACITY], after[4 * CAPACITY];
            const int which = (int)random_below(CALLS);
            read_values(m, variables, states, before);
            const int known = messages;
            const fmi3Status status = call(which, m, &stored, variables, states);
            *(status == fmi3OK ? &successes : &failures) += 1;
            if (status != fmi3OK) {
                const bool has_message = messages > known;
                read_values(m, variables, states, after);
                if (status == fmi3Fatal || !has_message || memcmp(before, after, (states + 1) * sizeof *before) != 0) {
                    printf("function %d returns %d, %s message%s\n", which, (int)status, has_message ? "with a" : "without a",
                        memcmp(before, after, (states + 1) * sizeof *before) ? ", and changes values" : "");
                    ++violations;
                }
            }
        }
        fmi3FreeFMUState(m, &stored);
        fmi3FreeInstance(m);
    }
    printf("%d %d %d\n", violations, failures, successes);
    return 0;
}
