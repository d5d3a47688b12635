/* The parts of `src/main.rs` that exist in C, with the same random states: the same lines result. */

#include "arm.h"
#include "functions.h"
#include "quadruped.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t hash, seed;

static void add(const double *numbers, int count) {
    for (int k = 0; k < count; ++k) {
        uint64_t bits;
        memcpy(&bits, &numbers[k], sizeof bits);
        bits = (hash ^ bits) * UINT64_C(0x00000100000001b3);
        hash = bits << 29 | bits >> 35;
    }
}

static double next(void) {
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return 4.0 * ((double)(seed >> 11) / 9007199254740992.0) - 2.0;
}

static void fill(double *numbers, int count) {
    for (int k = 0; k < count; ++k) {
        numbers[k] = next();
    }
}

static void start(uint64_t number) {
    hash = UINT64_C(0xcbf29ce484222325);
    seed = number;
}

static void report(const char *part, long count) {
    printf("| %s | %ld | `%016" PRIx64 "` |\n", part, count, hash);
}

/* The dynamics, and the derivatives, of a mechanism at random states. */
#define DYNAMICS(name, NAME, part, count) \
    start(1); \
    for (long k = 0; k < (count); ++k) { \
        double neutral[NAME##_NQ], dv[NAME##_NV], q[NAME##_NQ], v[NAME##_NV], u[NAME##_NV], a[NAME##_NV], tau[NAME##_NV]; \
        fill(dv, NAME##_NV); \
        name##_neutral(neutral); \
        name##_integrate(neutral, dv, q); \
        fill(v, NAME##_NV); \
        fill(u, NAME##_NV); \
        name##_forward_dynamics(q, v, u, a); \
        name##_inverse_dynamics(q, v, a, tau); \
        add(tau, NAME##_NV); \
        add(a, NAME##_NV); \
    } \
    report(part, count)

#define DERIVATIVES(name, NAME, part, count) \
    start(2); \
    for (long k = 0; k < (count); ++k) { \
        double neutral[NAME##_NQ], dv[NAME##_NV], q[NAME##_NQ], v[NAME##_NV], u[NAME##_NV]; \
        static double by_q[NAME##_NV * NAME##_NV], by_v[NAME##_NV * NAME##_NV], inverse[NAME##_NV * NAME##_NV]; \
        fill(dv, NAME##_NV); \
        name##_neutral(neutral); \
        name##_integrate(neutral, dv, q); \
        fill(v, NAME##_NV); \
        fill(u, NAME##_NV); \
        name##_forward_dynamics_derivatives(q, v, u, by_q, by_v, inverse); \
        add(by_q, NAME##_NV * NAME##_NV); \
        add(by_v, NAME##_NV * NAME##_NV); \
        add(inverse, NAME##_NV * NAME##_NV); \
    } \
    report(part, count)

static void elementary_functions(long count) {
    start(3);
    for (long k = 0; k < count; ++k) {
        const double x = next(), large = k % 64 == 0 ? 1e6 * x : x;
        const double values[5] = {functions_angles(&large), functions_inverse_functions(&x), functions_exponentials(&x),
            functions_powers(&x), functions_pieces(&x)};
        add(values, 5);
    }
    report("elementary functions", count);
}

int main(int count, char **arguments) {
    const long calls = count > 1 ? strtol(arguments[1], NULL, 10) : 1000000;
    DYNAMICS(arm, ARM, "arm, dynamics", calls);
    DERIVATIVES(arm, ARM, "arm, derivatives", calls / 10);
    DYNAMICS(quadruped, QUADRUPED, "quadruped, dynamics", calls / 10);
    DERIVATIVES(quadruped, QUADRUPED, "quadruped, derivatives", calls / 50);
    elementary_functions(calls / 10);
    return 0;
}
