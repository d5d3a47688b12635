/* Motion of the mechanism by the run-time library of Linkwork, for contacts with friction and whatever else the functions
 * in C do not have. The library compiles the declaration in lw_model.h when an instance is created. */

#include <stddef.h>

/* Functions of the library, as linkwork.h documents them. */
typedef struct lw_robot lw_robot;
typedef int (*lw_controller)(void *user, double t, const double *q, const double *v, double *u);
typedef struct {
    double start, duration, every;
    const char *method;
    double setting;
    lw_controller control;
    void *user;
    double period;
    int without_contacts;
    int overlaps;
} lw_simulation;
enum { LW_OK = 0, LW_FUNCTIONS = 5 };
extern const char *lw_message(void);
extern int lw_declare(const char *text, const char *options, lw_robot **robot);
extern void lw_free(lw_robot *robot);
extern int lw_index(const lw_robot *robot, int list, const char *name, size_t *index);
extern int lw_set_parameter(lw_robot *robot, size_t index, double value);
extern int lw_validate(const lw_robot *robot);
extern size_t lw_arguments(const lw_robot *robot, size_t function);
extern int lw_argument(const lw_robot *robot, size_t function, size_t argument, const char **name, size_t *length);
extern int lw_call(const lw_robot *robot, size_t function, const double *const *arguments, double *results);
extern int lw_simulate(const lw_robot *robot, const double *q, const double *v, const lw_simulation *settings,
    double *samples, size_t rows, size_t *count);
extern int lw_assemble(const lw_robot *robot, const double *q, const size_t *held, size_t count, double *result);
extern int lw_complete_velocity(const lw_robot *robot, const double *q, const double *v, const size_t *held,
    size_t count, double *result);

#define LW_ROWS 0
#define LW_STABILISATION 0.0
#define LW_VIOLATION 1e-6

/* Largest step of time stepping, s. */
#define LW_LARGEST_STEP 1e-3

/* What changes in the course of a simulation. */
typedef struct {
    int mode;
    double time;
    double step;
    double states[LW_AT_LEAST_ONE(LW_STATES)]; /* q, v, x */
    double inputs[LW_AT_LEAST_ONE(LW_NU)];
    double parameters[LW_AT_LEAST_ONE(LW_NP)];
    bool has_moved; /* later steps leave overlaps of rounding error */
    lw_robot *robot; /* of the instance */
} lw_state;

typedef struct {
    double rates[LW_AT_LEAST_ONE(LW_STATES)]; /* zero: there is no model exchange */
    double outputs[LW_AT_LEAST_ONE(LW_NY)];
    double indicators[1];
} lw_values;

/* Creates the mechanism of an instance. Returns NULL, or why it cannot be done. */
static inline const char *lw_open(lw_state *s) {
    return lw_declare(lw_declaration, NULL, &s->robot) == LW_OK ? NULL : lw_message();
}

/* Passes parameters and states of first order to the library. Returns NULL, or why one is invalid. */
static inline const char *lw_check_parameters(const lw_state *s) {
    for (int k = 0; k < LW_NX + LW_NP; ++k) {
        const double value = k < LW_NX ? s->states[LW_NQ + LW_NV + k] : s->parameters[k - LW_NX];
        if (lw_set_parameter(s->robot, lw_indices[k], value) != LW_OK) {
            return lw_message();
        }
    }
    return lw_validate(s->robot) == LW_OK ? NULL : lw_message();
}

/* Writes the outputs of a state. Returns NULL, or why they cannot be computed. */
static inline const char *lw_evaluate(const lw_state *s, double decay, lw_values *values) {
    double q[LW_AT_LEAST_ONE(LW_NQ)], *output = values->outputs;
    (void)(decay);
    memset(values, 0, sizeof *values);
    memcpy(q, s->states, LW_NQ * sizeof(double));
    const char *problem = lw_normalise_all(q) ? lw_check_parameters(s) : "a quaternion is zero";
    for (int k = 0; k < LW_OUTPUTS && !problem; ++k) {
        const double *arguments[4] = {NULL, NULL, NULL, NULL};
        const char *name = "";
        size_t function, length;
        if (lw_index(s->robot, LW_FUNCTIONS, lw_outputs[k].name, &function) != LW_OK) {
            return lw_message();
        }
        const size_t count = lw_arguments(s->robot, function);
        for (size_t i = 0; i < count && i < 4; ++i) {
            lw_argument(s->robot, function, i, &name, &length);
            arguments[i] = name[0] == 't' ? &s->time
                : name[0] == 'q' ? q
                : name[0] == 'v' ? s->states + LW_NQ
                : s->inputs;
        }
        problem = lw_call(s->robot, function, arguments, output) == LW_OK ? NULL : lw_message();
        output += lw_outputs[k].size;
    }
    return problem ? problem : lw_all_finite(LW_NY, values->outputs) ? NULL : "an output is not finite";
}

/* Makes a state consistent with constraints and quaternions. Returns NULL, or why it cannot be done. */
static inline const char *lw_make_consistent(lw_state *s, double tolerance) {
    (void)(tolerance);
    if (!lw_normalise_all(s->states)) {
        return "a quaternion is zero";
    }
#if LW_CONSTRAINTS > 0
    if (!s->has_moved) {
        double q[LW_NQ], v[LW_NV];
        const char *problem = lw_check_parameters(s);
        if (problem) {
            return problem;
        }
        const bool is_assembled = lw_assemble(s->robot, s->states, NULL, 0, q) == LW_OK
            && lw_complete_velocity(s->robot, q, s->states + LW_NQ, NULL, 0, v) == LW_OK;
        if (!is_assembled) {
            return lw_message();
        }
        memcpy(s->states, q, sizeof q);
        memcpy(s->states + LW_NQ, v, sizeof v);
    }
#endif
    return NULL;
}

/* Copies the inputs, which are constant during a communication step. */
static int lw_hold(void *user, double t, const double *q, const double *v, double *u) {
    (void)t, (void)q, (void)v;
    memcpy(u, user, LW_NU * sizeof(double));
    return 0;
}

/* Integrates to the time `end`. Returns NULL, or why it cannot be done. */
static inline const char *lw_integrate_to(lw_state *s, double end, double tolerance) {
    enum { WIDTH = 1 + LW_STATES + LW_NU, ROWS = 3 };
    double samples[ROWS * WIDTH];
    size_t count = 0;
    lw_simulation settings = {0};
    const char *problem = lw_check_parameters(s);
    settings.start = s->time;
    settings.duration = end - s->time;
    settings.every = settings.duration;
    settings.method = LW_METHOD;
    settings.setting = LW_HAS_STEPS ? fmin(LW_LARGEST_STEP, settings.duration) : tolerance;
    settings.control = LW_NU > 0 ? lw_hold : NULL;
    settings.user = s->inputs;
    settings.overlaps = s->has_moved ? 2 : 1;
    if (problem) {
        return problem;
    }
    if (lw_simulate(s->robot, s->states, s->states + LW_NQ, &settings, samples, ROWS, &count) != LW_OK || count < 2) {
        return lw_message();
    }
    memcpy(s->states, samples + (count - 1) * WIDTH + 1, LW_STATES * sizeof(double));
    s->has_moved = true;
    s->time = end;
    return NULL;
}
