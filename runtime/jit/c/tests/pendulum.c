/* A pendulum: its accelerations, names and errors. */
#include "linkwork.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const TEXT =
    "#[mechanism(gravity = -9.81 * y)] struct Pendulum { length: f64,"
    "#[body(mass = 2, com = -length / 2 * y, inertia = rod(2, length, y))] rod: Body,"
    "#[joint(ground -> rod, about = z)] hinge: Pin, #[acts(on = hinge)] motor: Torque }";

#define CHECK(condition)                                                        \
    do {                                                                        \
        if (!(condition)) {                                                     \
            fprintf(stderr, "line %d: %s: %s\n", __LINE__, #condition, lw_message()); \
            return 1;                                                           \
        }                                                                       \
    } while (0)

int main(void) {
    lw_robot *robot = NULL, *copy = NULL;
    CHECK(lw_declare(TEXT, NULL, &robot) == LW_OK);
    CHECK(strcmp(lw_mechanism(robot), "Pendulum") == 0);
    CHECK(lw_count(robot, LW_VELOCITIES) == 1 && lw_count(robot, LW_INPUTS) == 1);
    CHECK(strcmp(lw_name(robot, LW_VELOCITIES, 0), "hinge") == 0);
    CHECK(strcmp(lw_unit(robot, LW_VELOCITIES, 0), "rad/s") == 0);

    size_t f = 0;
    CHECK(lw_index(robot, LW_FUNCTIONS, "forward_dynamics", &f) == LW_OK);
    const double q = 0.3, v = 0.0, tau = 0.0;
    const double *arguments[] = {&q, &v, &tau};
    double a = 0.0;
    CHECK(lw_call(robot, f, arguments, &a) == LW_VALUE && strstr(lw_message(), "length") != NULL);
    CHECK(lw_set_parameter(robot, 0, 1.5) == LW_OK);
    CHECK(lw_call(robot, f, arguments, &a) == LW_OK);
    /* -3 g sin(q) / (2 l) */
    CHECK(fabs(a + 1.5 * 9.81 * sin(0.3) / 1.5) < 1e-12);

    CHECK(lw_copy(robot, &copy) == LW_OK && lw_set_parameter(copy, 0, 3.0) == LW_OK);
    lw_free(robot);
    CHECK(lw_call(copy, f, arguments, &a) == LW_OK);
    CHECK(fabs(a + 1.5 * 9.81 * sin(0.3) / 3.0) < 1e-12);

    const double many[] = {0.1, 0.2};
    const double *sets[] = {many, &v, &tau};
    const size_t lengths[] = {2, 1, 1};
    double both[2];
    CHECK(lw_call_many(copy, f, 2, 3, sets, lengths, both, 2) == LW_OK);
    CHECK(fabs(both[1] + 1.5 * 9.81 * sin(0.2) / 3.0) < 1e-12);
    CHECK(lw_call_many(copy, f, 3, 3, sets, lengths, both, 2) == LW_LENGTH);
    CHECK(lw_call_many(copy, f, 1, 2, sets, lengths, both, 1) == LW_LENGTH);

    CHECK(lw_index(copy, LW_FUNCTIONS, "forward", &f) == LW_UNKNOWN);
    CHECK(lw_set_parameter(copy, 7, 1.0) == LW_UNKNOWN && lw_set_parameter(copy, 0, NAN) == LW_VALUE);
    CHECK(lw_call(NULL, f, arguments, &a) == LW_NULL && lw_count(copy, 9) == 0);
    CHECK(lw_load("missing.urdf", NULL, &robot) == LW_FILE && robot == NULL);
    CHECK(lw_declare("struct", NULL, &robot) == LW_SYNTAX && lw_declare(NULL, NULL, &robot) == LW_NULL);
    lw_free(copy);
    lw_free(NULL);
    return 0;
}
