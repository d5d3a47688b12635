/* An importer of FMUs that is linked with the sources of one: it simulates in both modes, and prints derivatives and
 * messages. */

#include "calls.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX = 64 };

static void print_message(void *environment, fmi3Status status, fmi3String category, fmi3String message) {
    (void)environment, (void)category;
    printf("%d %s\n", (int)status, message);
}

/* Ends the program if a call fails. */
static void check(fmi3Status status) {
    if (status != fmi3OK) {
        fprintf(stderr, "a call returns %d\n", (int)status);
        exit(1);
    }
}

static instance started(const char *token, bool is_co_simulation, double tolerance) {
    instance m = is_co_simulation
        ? fmi3InstantiateCoSimulation("m", token, NULL, false, true, false, false, NULL, 0, NULL, print_message, NULL)
        : fmi3InstantiateModelExchange("m", token, NULL, false, true, NULL, print_message);
    if (!m) {
        exit(1);
    }
    check(fmi3EnterInitializationMode(m, true, tolerance, 0.0, false, 0.0));
    check(fmi3ExitInitializationMode(m));
    return m;
}

static void print_states(instance m, double t) {
    double x[MAX];
    size_t n;
    check(fmi3GetNumberOfContinuousStates(m, &n));
    check(fmi3GetContinuousStates(m, x, n));
    printf("%.17g", t);
    for (size_t k = 0; k < n; ++k) {
        printf(" %.17g", x[k]);
    }
    printf("\n");
}

static void do_step(instance m, double t, double h) {
    bool events, ends, early;
    double last;
    check(fmi3DoStep(m, t, h, true, &events, &ends, &early, &last));
    if (events || ends || early || fabs(last - t - h) > 1e-12) {
        exit(1);
    }
}

static void co_simulate(const char *token, double stop, int samples) {
    instance m = started(token, true, 1e-11);
    print_states(m, 0.0);
    for (int k = 0; k < samples; ++k) {
        do_step(m, stop * k / samples, stop / samples);
        print_states(m, stop * (k + 1) / samples);
    }
    check(fmi3Terminate(m));
    fmi3FreeInstance(m);
}

static void rates_at(instance m, double t, const double *x, size_t n, double *rates) {
    check(fmi3SetTime(m, t));
    check(fmi3SetContinuousStates(m, x, n));
    check(fmi3GetContinuousStateDerivatives(m, rates, n));
}

/* One step of the classical method of Runge and Kutta; the state of the instance is that at its end. */
static void step_rk4(instance m, double t, double h, const double *x, size_t n, double *end) {
    static const double nodes[4] = {0.0, 0.5, 0.5, 1.0}, weights[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    double rates[MAX], at[MAX];
    memcpy(at, x, n * sizeof *x);
    memcpy(end, x, n * sizeof *x);
    for (int stage = 0; stage < 4; ++stage) {
        rates_at(m, t + nodes[stage] * h, at, n, rates);
        for (size_t k = 0; k < n; ++k) {
            end[k] += h * weights[stage] * rates[k];
            at[k] = x[k] + h * (stage < 3 ? nodes[stage + 1] : 0.0) * rates[k];
        }
    }
    check(fmi3SetTime(m, t + h));
    check(fmi3SetContinuousStates(m, end, n));
}

static void update(instance m) {
    bool again = true, ends, nominals, values, next;
    double time;
    while (again) {
        check(fmi3UpdateDiscreteStates(m, &again, &ends, &nominals, &values, &next, &time));
    }
    check(fmi3EnterContinuousTimeMode(m));
}

/* Returns true if an event indicator has changed its sign. */
static bool has_crossed(instance m, const double *before, size_t n) {
    double after[MAX];
    bool has = false;
    check(fmi3GetEventIndicators(m, after, n));
    for (size_t k = 0; k < n; ++k) {
        has = has || ((before[k] > 0.0) != (after[k] > 0.0));
    }
    return has;
}

static void exchange(const char *token, double stop, int samples, int steps) {
    instance m = started(token, false, 1e-9);
    double x[MAX], end[MAX], indicators[MAX], h = stop / samples / steps;
    size_t n, n_events;
    check(fmi3GetNumberOfContinuousStates(m, &n));
    check(fmi3GetNumberOfEventIndicators(m, &n_events));
    update(m);
    print_states(m, 0.0);
    for (int k = 0; k < samples * steps; ++k) {
        double done = 0.0;
        while (done < h) {
            bool enters, ends;
            double high = h - done, low = 0.0;
            check(fmi3GetContinuousStates(m, x, n));
            check(fmi3GetEventIndicators(m, indicators, n_events));
            step_rk4(m, k * h + done, high, x, n, end);
            if (has_crossed(m, indicators, n_events)) {
                while (high - low > 1e-15) {
                    const double middle = 0.5 * (low + high);
                    step_rk4(m, k * h + done, middle, x, n, end);
                    *(has_crossed(m, indicators, n_events) ? &high : &low) = middle;
                }
                step_rk4(m, k * h + done, high, x, n, end);
                check(fmi3EnterEventMode(m));
                update(m);
            } else {
                check(fmi3CompletedIntegratorStep(m, true, &enters, &ends));
                if (enters) {
                    check(fmi3EnterEventMode(m));
                    update(m);
                }
            }
            done += high;
        }
        if ((k + 1) % steps == 0) {
            print_states(m, (k + 1) * h);
        }
    }
    fmi3FreeInstance(m);
}

/* Prints, for each known variable, the derivatives of all unknown ones: directional and adjoint ones, and central
 * differences. */
static void differentiate(const char *token, size_t inputs, size_t parameters, size_t outputs) {
    instance m = started(token, false, 1e-9);
    fmi3ValueReference knowns[MAX], unknowns[MAX];
    double start[MAX], sides[2][MAX], seed[MAX] = {0.0}, found[MAX], row[MAX];
    size_t n, known = 0, unknown = 0;
    check(fmi3GetNumberOfContinuousStates(m, &n));
    for (size_t k = 0; k < n; ++k) {
        knowns[known++] = (fmi3ValueReference)(1 + k);
        unknowns[unknown++] = (fmi3ValueReference)(1 + n + k);
    }
    for (size_t k = 0; k < inputs + parameters; ++k) {
        knowns[known++] = (fmi3ValueReference)(1 + 2 * n + k);
    }
    for (size_t k = 0; k < outputs; ++k) {
        unknowns[unknown++] = (fmi3ValueReference)(1 + 2 * n + inputs + parameters + k);
    }
    check(fmi3GetFloat64(m, knowns, known, start, known));
    for (size_t k = 0; k < known; ++k) {
        seed[k] = 1.0;
        check(fmi3GetDirectionalDerivative(m, unknowns, unknown, knowns, known, seed, known, found, unknown));
        seed[k] = 0.0;
        instance moved = fmi3InstantiateModelExchange("m", token, NULL, false, true, NULL, print_message);
        check(fmi3EnterInitializationMode(moved, false, 0.0, 0.0, false, 0.0));
        for (int side = 0; side < 2; ++side) {
            const double h = 1e-6 * fmax(1.0, fabs(start[k])), value = start[k] + (side ? h : -h);
            check(fmi3SetFloat64(moved, knowns, known, start, known));
            check(fmi3SetFloat64(moved, knowns + k, 1, &value, 1));
            check(fmi3GetFloat64(moved, unknowns, unknown, sides[side], unknown));
        }
        fmi3FreeInstance(moved);
        for (size_t i = 0; i < unknown; ++i) {
            seed[i] = 1.0;
            check(fmi3GetAdjointDerivative(m, unknowns, unknown, knowns, known, seed, unknown, row, known));
            seed[i] = 0.0;
            const double h = 2e-6 * fmax(1.0, fabs(start[k]));
            printf("%.17g %.17g %.17g\n", found[i], row[k], (sides[1][i] - sides[0][i]) / h);
        }
    }
    fmi3FreeInstance(m);
}

/* Prints, for each state in Continuous-Time Mode, the directional derivatives of the rates and central differences, at a
 * state that violates constraints. */
static void differentiate_rates(const char *token) {
    instance m = started(token, false, 1e-9);
    fmi3ValueReference knowns[MAX], unknowns[MAX];
    double x[MAX], found[MAX], sides[2][MAX];
    size_t n;
    check(fmi3GetNumberOfContinuousStates(m, &n));
    update(m);
    check(fmi3GetContinuousStates(m, x, n));
    for (size_t k = 0; k < n; ++k) {
        knowns[k] = (fmi3ValueReference)(1 + k);
        unknowns[k] = (fmi3ValueReference)(1 + n + k);
        x[k] += 0.01 * (double)(1 + k % 3);
    }
    for (size_t k = 0; k < n; ++k) {
        const double h = 1e-6, value = x[k], one = 1.0;
        check(fmi3SetContinuousStates(m, x, n));
        check(fmi3GetDirectionalDerivative(m, unknowns, n, knowns + k, 1, &one, 1, found, n));
        for (int side = 0; side < 2; ++side) {
            x[k] = value + (side ? h : -h);
            check(fmi3SetContinuousStates(m, x, n));
            check(fmi3GetContinuousStateDerivatives(m, sides[side], n));
        }
        x[k] = value;
        for (size_t i = 0; i < n; ++i) {
            printf("%.17g %.17g %.17g\n", found[i], found[i], (sides[1][i] - sides[0][i]) / (2.0 * h));
        }
    }
    fmi3FreeInstance(m);
}

/* Continues twice from a stored and from a serialised state, and prints both ends. */
static void restore(const char *token) {
    instance m = started(token, true, 1e-9);
    fmi3FMUState stored = NULL, copy = NULL;
    size_t size;
    do_step(m, 0.0, 0.3);
    check(fmi3GetFMUState(m, &stored));
    check(fmi3SerializedFMUStateSize(m, stored, &size));
    fmi3Byte *bytes = (fmi3Byte *)malloc(size);
    check(fmi3SerializeFMUState(m, stored, bytes, size));
    do_step(m, 0.3, 0.4);
    print_states(m, 0.7);
    check(fmi3SetFMUState(m, stored));
    do_step(m, 0.3, 0.4);
    print_states(m, 0.7);
    check(fmi3FreeFMUState(m, &stored));
    fmi3FreeInstance(m);
    m = started(token, true, 1e-9);
    check(fmi3DeserializeFMUState(m, bytes, size, &copy));
    check(fmi3SetFMUState(m, copy));
    do_step(m, 0.3, 0.4);
    print_states(m, 0.7);
    bytes[0] ^= 1;
    printf("%d\n", (int)fmi3DeserializeFMUState(m, bytes, size, &copy));
    check(fmi3FreeFMUState(m, &copy));
    free(bytes);
    fmi3FreeInstance(m);
}

/* Calls functions in a wrong order and with invalid arguments. */
static void fail(const char *token, fmi3ValueReference parameter) {
    const fmi3ValueReference unknown = 1000000, state = 1;
    double value = NAN, values[MAX] = {0.0}, zero = 0.0, half = 0.5;
    bool flags[5];
    int32_t whole;
    fmi3InstantiateModelExchange("m", "another token", NULL, false, true, NULL, print_message);
    fmi3InstantiateCoSimulation("m", token, NULL, false, true, true, false, NULL, 0, NULL, print_message, NULL);
    instance m = fmi3InstantiateModelExchange("m", token, NULL, false, true, NULL, print_message);
    fmi3ExitInitializationMode(m);
    fmi3EnterInitializationMode(m, true, -1.0, 0.0, false, 0.0);
    fmi3EnterInitializationMode(m, false, 0.0, 1.0, true, 0.0);
    check(fmi3EnterInitializationMode(m, false, 0.0, 0.0, false, 0.0));
    fmi3SetFloat64(m, &parameter, 1, &value, 1);
    fmi3SetFloat64(m, &unknown, 1, &half, 1);
    fmi3SetFloat64(m, &parameter, 1, &half, 2);
    fmi3SetFloat64(m, &parameter, 1, NULL, 1);
    fmi3GetInt32(m, &state, 1, &whole, 1);
    fmi3GetClock(m, &state, 1, flags);
    fmi3SetContinuousStates(m, values, 1);
    check(fmi3SetFloat64(m, &parameter, 1, &zero, 1));
    fmi3ExitInitializationMode(m);
    check(fmi3SetFloat64(m, &parameter, 1, &half, 1));
    check(fmi3ExitInitializationMode(m));
    fmi3DoStep(m, 0.0, 0.1, true, flags, flags + 1, flags + 2, &value);
    fmi3SetFloat64(m, &state, 1, &half, 1);
    fmi3SetFloat64(m, &parameter, 1, &zero, 1);
    check(fmi3EnterContinuousTimeMode(m));
    fmi3SetFloat64(m, &parameter, 1, &half, 1);
    fmi3SetContinuousStates(m, values, 1000);
    fmi3SetTime(m, NAN);
    check(fmi3Terminate(m));
    fmi3EnterEventMode(m);
    check(fmi3Reset(m));
    fmi3FreeInstance(m);
    m = started(token, true, 1e-9);
    fmi3DoStep(m, 0.5, 0.1, true, flags, flags + 1, flags + 2, &value);
    fmi3DoStep(m, 0.0, -0.1, true, flags, flags + 1, flags + 2, &value);
    fmi3EnterContinuousTimeMode(m);
    do_step(m, 0.0, 0.1);
    fmi3FreeInstance(m);
    printf("%d\n", (int)fmi3Terminate(NULL));
}

int main(int count, char **arguments) {
    if (count < 6) {
        return 2;
    }
    const char *kind = arguments[1], *token = arguments[2];
    const double stop = atof(arguments[3]);
    const int samples = atoi(arguments[4]), steps = atoi(arguments[5]);
    if (strcmp(kind, "co-simulation") == 0) {
        co_simulate(token, stop, samples);
    } else if (strcmp(kind, "exchange") == 0) {
        exchange(token, stop, samples, steps);
    } else if (strcmp(kind, "derivatives") == 0) {
        differentiate(token, (size_t)atoi(arguments[3]), (size_t)samples, (size_t)steps);
    } else if (strcmp(kind, "rate-derivatives") == 0) {
        differentiate_rates(token);
    } else if (strcmp(kind, "states") == 0) {
        restore(token);
    } else {
        fail(token, (fmi3ValueReference)samples);
    }
    return 0;
}
