/* Tests the library of a bead on a wire: assembly, a controller that holds the bead, and forces that equal those of statics. */
#include "bead.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define CHECK(what) \
    do { \
        if (!(what)) { \
            printf("line %d: %s (%s)\n", __LINE__, #what, bead_message()); \
            return 1; \
        } \
    } while (0)

/* Controller that holds the bead at x = 0.6, y = -0.8, and counts its calls. */
static int hold(void *user, double t, const double *q, const double *v, double *u) {
    const double mass = 3.0;
    (void)(t);
    ++*(int *)user;
    u[0] = mass * 9.81 * 0.75 - 200.0 * (q[0] - 0.6) - 60.0 * v[0];
    return 0;
}

static int give_up(void *user, double t, const double *q, const double *v, double *u) {
    (void)(user), (void)(q), (void)(v), (void)(u);
    return t > 0.5;
}

int main(void) {
    const double own[BEAD_PARAMETERS] = {3.0}, wrong[BEAD_PARAMETERS] = {-3.0};
    double q[BEAD_NQ] = {0.5, -0.7}, v[BEAD_NV] = {0.0, 0.0}, held[BEAD_NV] = {1.0, 0.0};
    CHECK(bead_validate(own) == 0);
    CHECK(bead_validate(wrong) == 1 && strstr(bead_message(), "cannot be negative"));

    CHECK(bead_assemble(own, q, held, q) == 0);
    CHECK(fabs(q[0] - 0.5) < 1e-12 && fabs(q[1] + sqrt(0.75)) < 1e-12);
    double nowhere[BEAD_NQ] = {1.5, 0.0}, to[BEAD_NQ];
    CHECK(bead_assemble(own, nowhere, held, to) == 1 && strlen(bead_message()) > 0);

    double samples[201][1 + BEAD_NQ + BEAD_NV + BEAD_NU];
    int calls = 0;
    size_t count = 0;
    bead_settings settings = {0.0, 20.0, 0.1, "dormand_prince", 1e-10, 0.01, hold, &calls};
    CHECK(bead_simulate(own, q, v, &settings, &samples[0][0], 201, &count) == 0);
    CHECK(count == 201 && calls >= 2000 && calls <= 2001);
    for (size_t k = 0; k < count; ++k) {
        CHECK(fabs(hypot(samples[k][1], samples[k][2]) - 1.0) < 1e-9);
    }
    const double *end = samples[200];
    CHECK(fabs(end[0] - 20.0) < 1e-12 && fabs(end[1] - 0.6) < 1e-6 && fabs(end[2] + 0.8) < 1e-6);

    /* At rest in this position, the wire balances the weight and the input force. */
    const double there[BEAD_NQ] = {0.6, -0.8}, push[BEAD_NU] = {3.0 * 9.81 * 0.75};
    double tau[BEAD_NV], a[BEAD_NV], lambda, jacobian[BEAD_NV];
    CHECK(bead_generalized_forces(own, there, push, tau) == 0);
    CHECK(bead_constrained_dynamics(own, there, v, tau, a, &lambda) == 0);
    CHECK(bead_constraint_jacobian(own, there, jacobian) == 0);
    CHECK(fabs(a[0]) < 1e-9 && fabs(a[1]) < 1e-9);
    CHECK(fabs(fabs(lambda) * hypot(jacobian[0], jacobian[1]) - 3.0 * 9.81 * 1.25) < 1e-9);

    /* Small oscillations about the lowest point have the frequency of a pendulum of 1 m. */
    const double down[BEAD_NQ] = {0.0, -1.0}, none[BEAD_NU] = {0.0}, preferred[BEAD_NV] = {1.0, 0.0};
    double state[4], input[2], coordinates[1], speeds[1];
    CHECK(bead_linearize(own, down, v, none, preferred, state, input, coordinates, speeds) == 0);
    CHECK(fabs(state[1] + 9.81) < 1e-9 && fabs(state[2] - 1.0) < 1e-12 && fabs(input[1] - 1.0 / 3.0) < 1e-12);

    /* A controller may end a run, and the name of the method must exist. */
    settings.control = give_up;
    CHECK(bead_simulate(own, q, v, &settings, &samples[0][0], 201, &count) == 1 && count == 6);
    settings.method = "euler";
    CHECK(bead_simulate(own, q, v, &settings, &samples[0][0], 201, &count) == 1);
    CHECK(strstr(bead_message(), "no method `euler`"));

    /* Several states in one call, one of which has no result. */
    const double many[3 * BEAD_NQ] = {0.6, -0.7, 1.5, 0.0, 0.0, -0.9};
    const double marks[3 * BEAD_NV] = {1.0, 0.0, 1.0, 0.0, 1.0, 0.0};
    double found[3 * BEAD_NQ];
    const double *arguments[2] = {many, marks};
    double *results[1] = {found};
    /* The number of a function is the index of its name in the description. */
    const char *at = strstr(bead_description(), "\"functions\"");
    const char *until = strstr(at, "\"name\":\"assemble\"");
    size_t function = 0;
    for (; at && until && (at = strstr(at, "\"documentation\"")) && at < until; ++at) {
        ++function;
    }
    CHECK(bead_call(function - 1, own, arguments, results, 3, 2) == 1);
    CHECK(strstr(bead_message(), "state 1: "));
    CHECK(fabs(found[1] + 0.8) < 1e-12 && isnan(found[2]) && fabs(found[5] + 1.0) < 1e-12);
    CHECK(bead_call(100000, own, arguments, results, 3, 2) == 1);
    return 0;
}
