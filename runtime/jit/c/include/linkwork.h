/* Linkwork: mechanisms that are loaded at run time.
 *
 * Functions return LW_OK or the code of an error, whose text lw_message returns. SI units, angles in radians.
 * Vectors are plain arrays, matrices are stored by columns, quaternions are x y z w. Any number of threads may
 * call functions of one robot at the same time, as long as none changes or frees it. Texts belong to the robot.
 */
#ifndef LINKWORK_H
#define LINKWORK_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Error codes. */
enum {
    LW_OK = 0,
    LW_FILE = 1,      /* a file cannot be read */
    LW_SYNTAX = 2,    /* a text is not a declaration, or options are not those of the attribute */
    LW_MECHANISM = 3, /* the mechanism is wrong: the message has the errors of the compiler */
    LW_UNKNOWN = 4,   /* no function, parameter, frame or mechanism of this name or index */
    LW_LENGTH = 5,    /* an array or the list of arguments has the wrong length */
    LW_VALUE = 6,     /* a parameter has no value, or an impossible one */
    LW_NULL = 7,      /* a pointer is NULL, or a text is not UTF-8 */
    LW_INTERNAL = 8,  /* an internal error of Linkwork */
    LW_MOTION = 9     /* a motion cannot be continued, or no state satisfies the constraints */
};

/* Lists of names. */
enum {
    LW_CONFIGURATION = 0,
    LW_VELOCITIES = 1, /* accelerations and generalized forces have the same order */
    LW_INPUTS = 2,
    LW_PARAMETERS = 3,
    LW_FRAMES = 4,
    LW_FUNCTIONS = 5,
    LW_TABLES = 6
};

/* A mechanism with values of its parameters. */
typedef struct lw_robot lw_robot;

/* Text of the last error of this thread; empty if there was none. */
const char *lw_message(void);

/* Loads a URDF, MJCF or SDF file, or a Rust file with one mechanism. Options are those of the attribute, for
 * example "base = free, derivatives"; NULL for none. */
int lw_load(const char *path, const char *options, lw_robot **robot);

/* Loads a mechanism from its declaration in Rust's syntax. */
int lw_declare(const char *text, const char *options, lw_robot **robot);

/* Copies a robot: both share the machine code, each has parameters of its own. */
int lw_copy(const lw_robot *robot, lw_robot **copy);

/* Frees a robot; NULL is ignored. */
void lw_free(lw_robot *robot);

/* Name of the mechanism. */
const char *lw_mechanism(const lw_robot *robot);

/* Number of entries of a list, zero for an unknown list: lw_count(robot, LW_VELOCITIES) is NV. */
size_t lw_count(const lw_robot *robot, int list);

/* Name of an entry of a list; NULL if there is none. */
const char *lw_name(const lw_robot *robot, int list, size_t index);

/* Unit of an entry of a list; empty for frames, functions and tables, NULL if there is no such entry. */
const char *lw_unit(const lw_robot *robot, int list, size_t index);

/* Index of an entry by its name. */
int lw_index(const lw_robot *robot, int list, const char *name, size_t *index);

/* Parameters by index. lw_validate checks whether a physical mechanism can have their values. */
int lw_set_parameter(lw_robot *robot, size_t index, double value);
int lw_parameter(const lw_robot *robot, size_t index, double *value);
int lw_validate(const lw_robot *robot);

/* Interpolation tables: functions of one to three variables that are parameters. A table is set by the grid points
 * of each axis, their numbers, and the values at all grid points, the last axis varying fastest. It is linear
 * between the points and constant beyond, or has the options LW_SMOOTH and LW_EXTRAPOLATED. Values are copied. */
enum { LW_SMOOTH = 1, LW_EXTRAPOLATED = 2 };
size_t lw_variables(const lw_robot *robot, size_t table);
int lw_set_table(lw_robot *robot, size_t table, const double *const *axes, const size_t *lengths,
                 const double *values, int options);

/* Limits: NV values each, infinite where there are none. */
int lw_limits(const lw_robot *robot, double *lower, double *upper, double *velocity, double *effort);

/* Documentation of a function; NULL if there is no such function. */
const char *lw_documentation(const lw_robot *robot, size_t function);

/* Arguments of a function: their number, and name and length of each. */
size_t lw_arguments(const lw_robot *robot, size_t function);
int lw_argument(const lw_robot *robot, size_t function, size_t argument, const char **name, size_t *length);

/* Results of a function: their number; name, rows and columns of each; the number of all values. They are
 * written one after the other. */
size_t lw_results(const lw_robot *robot, size_t function);
int lw_result(const lw_robot *robot, size_t function, size_t result, const char **name, size_t *rows,
              size_t *columns);
size_t lw_length(const lw_robot *robot, size_t function);

/* Generates the machine code of a function now instead of at its first call. */
int lw_compile(const lw_robot *robot, size_t function);

/* Calls a function. Each argument points to as many values as lw_argument says, `results` to lw_length. */
int lw_call(const lw_robot *robot, size_t function, const double *const *arguments, double *results);

/* Calls a function for `count` sets of arguments, after a check of all lengths. An argument has the values of
 * all sets one after the other, or those of one set, which all share. */
int lw_call_many(const lw_robot *robot, size_t function, size_t count, size_t arguments,
                 const double *const *values, const size_t *lengths, double *results, size_t length);

/* Writes the NU inputs at a time and a state. The velocity is followed by the states of first order. Another
 * value than zero ends the run. Large mechanisms call it on a thread of the library. */
typedef int (*lw_controller)(void *user, double t, const double *q, const double *v, double *u);

/* Settings of a simulation. */
typedef struct {
    double start;         /* time at the start, s */
    double duration;      /* s */
    double every;         /* time between samples, s; 0: every step is a sample */
    const char *method;   /* automatic, dormand_prince, dormand_prince8, rodas, rk4, implicit_midpoint, rosenbrock,
                           * semi_implicit_euler; for contacts automatic, time_stepping, time_stepping_midpoint,
                           * time_stepping_leapfrog, event_driven; NULL: automatic */
    double setting;       /* tolerance or step, s, of the method; 0: 1e-9 or 1e-3 */
    lw_controller control; /* NULL: the inputs are zero */
    void *user;           /* first argument of the controller */
    double period;        /* period of a digital controller, s; 0: it is called whenever inputs are needed */
    int without_contacts; /* bodies pass through each other */
    int overlaps;         /* surfaces that overlap at the start: 0 is an error, 1 separates them, 2 leaves them, to
                           * continue a run */
} lw_simulation;

/* Number of values of a sample: 1 + NQ + NV + NU and the states of first order. */
size_t lw_sample(const lw_robot *robot);

/* Simulates from the configuration q (NQ values) and the velocity v (NV values), with contacts and constraints.
 * Samples are rows of time, configuration, velocity, states of first order, and inputs. `count` is their number;
 * if it is greater than `rows`, the first ones are written, and LW_LENGTH is returned. */
int lw_simulate(const lw_robot *robot, const double *q, const double *v, const lw_simulation *settings,
                double *samples, size_t rows, size_t *count);

/* Writes a configuration near q that satisfies the constraints; coordinates whose velocities have the indices
 * `held` keep their values. */
int lw_assemble(const lw_robot *robot, const double *q, const size_t *held, size_t count, double *result);

/* Writes the velocity with the entries `held` of v that satisfies the constraints at q. */
int lw_complete_velocity(const lw_robot *robot, const double *q, const double *v, const size_t *held,
                         size_t count, double *result);

#ifdef __cplusplus
}
#endif

#endif
