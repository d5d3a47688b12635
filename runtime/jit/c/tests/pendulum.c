/* A pendulum: its accelerations, names and errors. */
#include "linkwork.h"
#include <math.h>
#include <stdint.h>
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

static const char *const BALL =
    "#[mechanism(gravity = -9.81 * z)] struct Ball { #[particle(mass = 0.1)] ball: Particle,"
    "#[joint(ground -> ball, along = z)] height: Sleeve,"
    "#[contact(ball, ground.plane(z), restitution = 0.5)] bounce: Contact }";

static const char *const LINKS =
    "#[mechanism] struct Links { #[body(mass = 1)] a: Body, #[body(mass = 1)] b: Body,"
    "#[joint(ground -> a, along = x)] first: Sleeve, #[joint(ground -> b, along = x)] second: Sleeve,"
    "#[constraint(2 * first = second)] gear: Holonomic }";

/* Damps the motor, and ends the run at the time in `user`. */
static int brake(void *user, double t, const double *q, const double *v, double *u) {
    (void)q;
    u[0] = -0.1 * v[0];
    return t > *(double *)user;
}

/* Motions with a controller, with contacts and with constraints. */
static int simulate(const lw_robot *pendulum) {
    double limit = 10.0, rows[11][4];
    const double q = 0.3, v = 0.0;
    size_t count = 0;
    lw_simulation settings = {0};
    settings.duration = 1.0;
    settings.every = 0.1;
    settings.control = brake;
    settings.user = &limit;
    CHECK(lw_sample(pendulum) == 4);
    CHECK(lw_simulate(pendulum, &q, &v, &settings, &rows[0][0], 11, &count) == LW_OK && count == 11);
    CHECK(rows[10][0] == 1.0 && fabs(rows[10][3] + 0.1 * rows[10][2]) < 1e-12);
    CHECK(lw_simulate(pendulum, &q, &v, &settings, &rows[0][0], 5, &count) == LW_LENGTH && count == 11);
    limit = 0.5;
    CHECK(lw_simulate(pendulum, &q, &v, &settings, &rows[0][0], 11, &count) == LW_VALUE);
    settings.method = "euler";
    CHECK(lw_simulate(pendulum, &q, &v, &settings, &rows[0][0], 11, &count) == LW_UNKNOWN);

    /* From 1 m the ball falls for sqrt(2 h / g), and reaches 0.25 m after half of that time again. */
    lw_robot *ball = NULL, *links = NULL;
    const lw_simulation bounce = {.duration = 1.5 * sqrt(2.0 / 9.81), .every = 1.0, .method = "event_driven"};
    double states[2][3];
    const double top = 1.0;
    CHECK(lw_declare(BALL, NULL, &ball) == LW_OK);
    CHECK(lw_simulate(ball, &top, &v, &bounce, &states[0][0], 2, &count) == LW_OK && count == 2);
    CHECK(fabs(states[1][1] - 0.25) < 1e-8);
    const double inside = -0.1;
    CHECK(lw_simulate(ball, &inside, &v, &bounce, &states[0][0], 2, &count) == LW_MOTION);
    CHECK(strstr(lw_message(), "`bounce`") != NULL);
    lw_free(ball);

    CHECK(lw_declare(LINKS, NULL, &links) == LW_OK);
    const double guess[] = {0.5, 0.0}, pace[] = {1.0, 0.0};
    const size_t held = 0;
    double place[2], rates[2];
    CHECK(lw_assemble(links, guess, &held, 1, place) == LW_OK && fabs(place[1] - 1.0) < 1e-12);
    CHECK(lw_complete_velocity(links, place, pace, &held, 1, rates) == LW_OK && fabs(rates[1] - 2.0) < 1e-12);
    lw_free(links);
    return 0;
}

/* A mass on a spring whose force is a table of the elongation. */
static int tabulate(void) {
    lw_robot *robot = NULL;
    const char *const text =
        "#[mechanism] struct Oscillator { force: Table<1>, #[body(mass = 2)] block: Body,"
        "#[joint(ground -> block, along = x)] slide: Sleeve, #[acts(on = slide, value = -force(slide))] spring: Force }";
    const double points[] = {-1.0, 0.0, 2.0}, values[] = {-3.0, 0.0, 8.0}, falling[] = {0.0, -1.0, 2.0};
    const double *axes[] = {points}, *wrong[] = {falling};
    const size_t length = 3;
    size_t table = 9, f = 0;
    CHECK(lw_declare(text, NULL, &robot) == LW_OK && lw_count(robot, LW_TABLES) == 1);
    CHECK(lw_index(robot, LW_TABLES, "force", &table) == LW_OK && table == 0 && lw_variables(robot, 0) == 1);
    CHECK(lw_index(robot, LW_FUNCTIONS, "forward_dynamics", &f) == LW_OK);
    double q = 1.0, v = 0.0, a = 0.0;
    const double *arguments[] = {&q, &v, &v};
    CHECK(lw_call(robot, f, arguments, &a) == LW_VALUE && strstr(lw_message(), "force") != NULL);
    CHECK(lw_set_table(robot, 0, wrong, &length, values, 0) == LW_VALUE);
    CHECK(lw_set_table(robot, 1, axes, &length, values, 0) == LW_UNKNOWN);
    CHECK(lw_set_table(robot, 0, axes, &length, NULL, 0) == LW_NULL);
    CHECK(lw_set_table(robot, 0, axes, &length, values, 0) == LW_OK);
    CHECK(lw_call(robot, f, arguments, &a) == LW_OK && a == -2.0);
    /* Beyond the grid the force is constant, or has the last slope. */
    q = 3.0;
    CHECK(lw_call(robot, f, arguments, &a) == LW_OK && a == -4.0);
    CHECK(lw_set_table(robot, 0, axes, &length, values, LW_EXTRAPOLATED) == LW_OK);
    CHECK(lw_call(robot, f, arguments, &a) == LW_OK && a == -6.0);
    lw_free(robot);
    return 0;
}

/* Null pointers, indices and lengths that do not exist, and values that are not finite: errors, no crash. */
static int attack(lw_robot *robot, size_t f) {
    const double q = 0.1, *arguments[] = {&q, NULL, &q}, nothing = NAN;
    const double *sets[] = {&q, &q, &q};
    const size_t lengths[] = {SIZE_MAX, 1, 1}, outside = 99;
    double a = 0.0, samples[8];
    size_t count = 0;
    CHECK(lw_call(robot, f, NULL, &a) == LW_NULL && lw_call(robot, f, arguments, &a) == LW_NULL);
    CHECK(lw_call(robot, f, sets, NULL) == LW_NULL && lw_call(robot, SIZE_MAX, sets, &a) == LW_UNKNOWN);
    CHECK(lw_call_many(robot, f, 1, 3, sets, lengths, &a, 1) == LW_UNKNOWN);
    CHECK(lw_call_many(robot, f, 1, SIZE_MAX, sets, lengths, &a, 1) == LW_UNKNOWN);
    CHECK(lw_name(robot, LW_INPUTS, 7) == NULL && lw_unit(robot, -1, 0) == NULL && lw_count(NULL, 0) == 0);
    CHECK(lw_index(robot, LW_INPUTS, NULL, &count) == LW_NULL && lw_index(robot, 99, "motor", &count) == LW_UNKNOWN);
    CHECK(lw_index(robot, LW_INPUTS, "\xff", &count) == LW_NULL);
    CHECK(lw_set_table(robot, 0, sets, lengths, &q, 0) == LW_UNKNOWN && lw_variables(robot, 0) == 0);
    CHECK(lw_assemble(robot, &q, &outside, 1, &a) != LW_OK && lw_assemble(robot, &q, NULL, 1, &a) == LW_NULL);
    lw_simulation settings = {0};
    settings.duration = 1e9;
    settings.every = 1e-9;
    CHECK(lw_simulate(robot, &q, &q, &settings, samples, 2, &count) == LW_VALUE);
    CHECK(lw_simulate(robot, &q, &q, NULL, samples, 2, &count) == LW_NULL);
    CHECK(lw_simulate(robot, &q, &q, &settings, samples, SIZE_MAX, &count) == LW_UNKNOWN);
    settings.duration = settings.every = 1.0;
    settings.start = NAN;
    CHECK(lw_simulate(robot, &q, &q, &settings, samples, 2, &count) == LW_VALUE);
    settings.start = 0.0;
    CHECK(lw_simulate(robot, &nothing, &q, &settings, samples, 2, &count) != LW_OK);
    CHECK(lw_load("/", NULL, &robot) == LW_FILE && lw_load("", NULL, &robot) == LW_FILE);
    return 0;
}

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

    CHECK(attack(copy, f) == 0);
    CHECK(lw_index(copy, LW_FUNCTIONS, "forward", &f) == LW_UNKNOWN);
    CHECK(lw_set_parameter(copy, 7, 1.0) == LW_UNKNOWN && lw_set_parameter(copy, 0, NAN) == LW_VALUE);
    CHECK(lw_call(NULL, f, arguments, &a) == LW_NULL && lw_count(copy, 9) == 0);
    CHECK(lw_load("missing.urdf", NULL, &robot) == LW_FILE && robot == NULL);
    CHECK(lw_declare("struct", NULL, &robot) == LW_SYNTAX && lw_declare(NULL, NULL, &robot) == LW_NULL);
    CHECK(simulate(copy) == 0 && tabulate() == 0);
    lw_free(copy);
    lw_free(NULL);
    return 0;
}
