/* Equations of motion of the mechanism that lw_model.h describes: the rates of its states, with constraint forces and
 * with the forces of closed contacts.
 *
 * Constraints and contacts have rows: first those of the constraints, then one for each contact, its gap. The matrix
 * of the rows is A = G inverse(M) transpose(G), with their Jacobian G. */

#define LW_ROWS (LW_CONSTRAINTS + LW_CONTACTS)
#define LW_SQUARE (LW_NV * LW_NV)

/* Decay rate of violated constraints in model exchange, 1/s. */
#define LW_STABILISATION 10.0
/* Violation of constraints above which the states are projected, m or rad. */
#define LW_VIOLATION 1e-6
/* Gap below which a contact can close, m or rad. */
#define LW_NEAR 1e-7
/* Overlap at which an impact is located, m or rad: separated contacts have a clear sign of their event indicator. */
#define LW_OVERLAP 1e-12
/* Velocity above which contacts separate, and below which impacts have no restitution, m/s or rad/s. */
#define LW_SLOW 1e-7
#define LW_REBOUND 1e-4

/* What changes in the course of a simulation. */
typedef struct {
    int mode;
    double time;
    double step; /* step of the integrator in co-simulation, s */
    double states[LW_AT_LEAST_ONE(LW_STATES)]; /* q, v, x */
    double inputs[LW_AT_LEAST_ONE(LW_NU)];
    double parameters[LW_AT_LEAST_ONE(LW_NP)];
    unsigned char closed[LW_AT_LEAST_ONE(LW_CONTACTS)];
} lw_state;

/* Rates and outputs of a state. */
typedef struct {
    double rates[LW_AT_LEAST_ONE(LW_STATES)];
    double outputs[LW_AT_LEAST_ONE(LW_NY)];
    double indicators[LW_AT_LEAST_ONE(LW_CONTACTS)];
} lw_values;

/* Arguments of the functions of the mechanism. */
typedef struct {
    lw_mechanism own;
    double t;
    double q[LW_AT_LEAST_ONE(LW_NQ)];
    double v[LW_AT_LEAST_ONE(LW_NV)];
    const double *u;
} lw_point;

/* Writes the arguments of functions at a state, with normalised quaternions. */
static inline void lw_point_at(const lw_state *s, lw_point *p) {
    memset(p, 0, sizeof *p);
    p->t = s->time;
    p->u = s->inputs;
    memcpy(p->q, s->states, LW_NQ * sizeof(double));
    memcpy(p->v, s->states + LW_NQ, LW_NV * sizeof(double));
    lw_put_parameters(&p->own, s->states + LW_NQ + LW_NV, s->parameters);
    lw_normalise_all(p->q);
}

/* Rotates a vector by a quaternion, which need not be normalised; with the sign -1 in the opposite direction. */
static inline void lw_rotate_by(const double *a, double sign, const double *v, double *result) {
    const double square = a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + a[3] * a[3];
    double c[3];
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = a[j] * v[k] - a[k] * v[j] + sign * a[3] * v[i];
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        result[i] = v[i] + 2.0 * (a[j] * c[k] - a[k] * c[j]) / square;
    }
}

/* Rate of the configuration, which may have quaternions that are not normalised, for joint velocities w. */
static inline void lw_configuration_rate(const double *q, const double *w, double *rate) {
    for (int k = 0; k < LW_PLAINS; ++k) {
        rate[lw_plains[k][0]] = w[lw_plains[k][1]];
    }
    for (int k = 0; k < LW_BALLS; ++k) {
        const double *a = q + lw_balls[k][0], *o = w + lw_balls[k][1];
        double *r = rate + lw_balls[k][0];
        r[0] = 0.5 * (a[3] * o[0] + a[1] * o[2] - a[2] * o[1]);
        r[1] = 0.5 * (a[3] * o[1] + a[2] * o[0] - a[0] * o[2]);
        r[2] = 0.5 * (a[3] * o[2] + a[0] * o[1] - a[1] * o[0]);
        r[3] = -0.5 * (a[0] * o[0] + a[1] * o[1] + a[2] * o[2]);
        if (lw_balls[k][2] >= 0) {
            /* A free joint: its position changes with the velocity in axes of the body. */
            lw_rotate_by(a, 1.0, w + lw_balls[k][1] - 3, rate + lw_balls[k][2]);
        }
    }
}

/* Factorises a positive definite matrix to its lower triangle. Returns false if the matrix is another one. */
static inline bool lw_factorise(int n, double *a) {
    for (int j = 0; j < n; ++j) {
        const double diagonal = a[j * n + j];
        for (int k = 0; k < j; ++k) {
            a[j * n + j] -= a[k * n + j] * a[k * n + j];
        }
        if (!(a[j * n + j] > 1e-14 * diagonal)) {
            return false;
        }
        a[j * n + j] = sqrt(a[j * n + j]);
        for (int i = j + 1; i < n; ++i) {
            for (int k = 0; k < j; ++k) {
                a[j * n + i] -= a[k * n + i] * a[k * n + j];
            }
            a[j * n + i] /= a[j * n + j];
        }
    }
    return true;
}

/* Solves a system with the factor of lw_factorise. */
static inline void lw_solve_factorised(int n, const double *l, double *x) {
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < i; ++k) {
            x[i] -= l[k * n + i] * x[k];
        }
        x[i] /= l[i * n + i];
    }
    for (int i = n - 1; i >= 0; --i) {
        for (int k = i + 1; k < n; ++k) {
            x[i] -= l[i * n + k] * x[k];
        }
        x[i] /= l[i * n + i];
    }
}

#if LW_ROWS > 0

/* Rows of constraints and contacts at a state, and what the forces of the rows do. */
typedef struct {
    double factor[LW_SQUARE]; /* of the mass matrix */
    double jacobian[LW_ROWS * LW_NV]; /* row by row */
    double responses[LW_ROWS * LW_NV]; /* accelerations by a unit force of each row */
    double matrix[LW_ROWS * LW_ROWS];
    double residuals[LW_ROWS]; /* zero for constraints of velocities */
    double velocities[LW_ROWS];
    double biases[LW_ROWS];
} lw_rows;

/* Kinds of rows in a system. */
enum { LW_ABSENT, LW_BILATERAL, LW_UNILATERAL };

/* Writes the rows. Returns false if the mass matrix is not positive definite. */
static inline bool lw_rows_at(const lw_point *p, lw_rows *r) {
    double columns[LW_ROWS * LW_NV];
    memset(r, 0, sizeof *r);
    lw_mass_matrix(&p->own, p->t, p->q, r->factor);
    if (!lw_factorise(LW_NV, r->factor)) {
        return false;
    }
#if LW_CONSTRAINTS > 0
    lw_constraint_rows(&p->own, p->t, p->q, p->v, r->residuals, r->velocities, r->biases, columns);
    for (int i = 0; i < LW_CONSTRAINTS; ++i) {
        for (int k = 0; k < LW_NV; ++k) {
            r->jacobian[i * LW_NV + k] = columns[k * LW_CONSTRAINTS + i];
        }
    }
#endif
#if LW_CONTACTS > 0
    lw_contact_rows(&p->own, p->t, p->q, p->v, r->residuals + LW_CONSTRAINTS, r->velocities + LW_CONSTRAINTS,
        r->biases + LW_CONSTRAINTS, columns);
    for (int i = 0; i < LW_CONTACTS; ++i) {
        for (int k = 0; k < LW_NV; ++k) {
            r->jacobian[(LW_CONSTRAINTS + i) * LW_NV + k] = columns[k * LW_CONTACTS + i];
        }
    }
#endif
    memcpy(r->responses, r->jacobian, sizeof r->responses);
    for (int i = 0; i < LW_ROWS; ++i) {
        lw_solve_factorised(LW_NV, r->factor, r->responses + i * LW_NV);
        for (int j = 0; j <= i; ++j) {
            double sum = 0.0;
            for (int k = 0; k < LW_NV; ++k) {
                sum += r->responses[i * LW_NV + k] * r->jacobian[j * LW_NV + k];
            }
            r->matrix[i * LW_ROWS + j] = sum;
            r->matrix[j * LW_ROWS + i] = sum;
        }
    }
    return true;
}

/* Solves A x = -c for the selected rows, and writes zero to the other ones and to those that depend on others. */
static inline void lw_solve_selected(const double *a, const double *c, const bool *selected, double *x) {
    double l[LW_ROWS * LW_ROWS], rest[LW_ROWS], y[LW_ROWS], largest = 0.0;
    int order[LW_ROWS], count = 0, rank = 0;
    for (int i = 0; i < LW_ROWS; ++i) {
        x[i] = 0.0;
        rest[i] = a[i * LW_ROWS + i];
        if (selected[i]) {
            order[count++] = i;
            largest = fmax(largest, rest[i]);
        }
    }
    for (; rank < count; ++rank) {
        int best = rank;
        for (int i = rank + 1; i < count; ++i) {
            best = rest[order[i]] > rest[order[best]] ? i : best;
        }
        if (!(rest[order[best]] > 1e-12 * largest)) {
            break;
        }
        const int row = order[best];
        order[best] = order[rank];
        order[rank] = row;
        const double pivot = sqrt(rest[row]);
        y[rank] = -c[row];
        for (int k = 0; k < rank; ++k) {
            y[rank] -= l[row * LW_ROWS + k] * y[k];
        }
        y[rank] /= pivot;
        l[row * LW_ROWS + rank] = pivot;
        for (int i = rank + 1; i < count; ++i) {
            double *other = l + order[i] * LW_ROWS;
            other[rank] = a[order[i] * LW_ROWS + row];
            for (int k = 0; k < rank; ++k) {
                other[rank] -= other[k] * l[row * LW_ROWS + k];
            }
            other[rank] /= pivot;
            rest[order[i]] -= other[rank] * other[rank];
        }
    }
    for (int i = rank - 1; i >= 0; --i) {
        double sum = y[i];
        for (int k = i + 1; k < rank; ++k) {
            sum -= l[order[k] * LW_ROWS + i] * x[order[k]];
        }
        x[order[i]] = sum / l[order[i] * LW_ROWS + i];
    }
}

/* Finds x with A x + c = 0 in bilateral rows, and in unilateral rows A x + c >= 0 and x >= 0, one of them zero.
 * Exchanges the first row that violates its conditions, until none does (the method of Murty). */
static inline bool lw_solve_complementary(const double *a, const double *c, const int *kinds, double *x) {
    bool selected[LW_ROWS];
    double scale = 0.0;
    for (int i = 0; i < LW_ROWS; ++i) {
        selected[i] = kinds[i] == LW_BILATERAL || (kinds[i] == LW_UNILATERAL && c[i] < 0.0);
        scale = kinds[i] == LW_ABSENT ? scale : fmax(scale, fabs(c[i]));
    }
    for (int attempt = 0; attempt < 64 + 16 * LW_ROWS * LW_ROWS; ++attempt) {
        lw_solve_selected(a, c, selected, x);
        int wrong = -1;
        for (int i = 0; i < LW_ROWS && wrong < 0; ++i) {
            double sum = c[i];
            for (int k = 0; k < LW_ROWS; ++k) {
                sum += a[i * LW_ROWS + k] * x[k];
            }
            const bool is_violated = selected[i] ? x[i] < 0.0 : sum < -1e-11 * scale;
            wrong = kinds[i] == LW_UNILATERAL && is_violated ? i : -1;
        }
        if (wrong < 0) {
            return true;
        }
        selected[wrong] = !selected[wrong];
    }
    return false;
}

/* Adds the effect of the forces or impulses x of the rows to accelerations or velocities. */
static inline void lw_add_responses(const lw_rows *r, const double *x, double *a) {
    for (int i = 0; i < LW_ROWS; ++i) {
        for (int k = 0; k < LW_NV; ++k) {
            a[k] += r->responses[i * LW_NV + k] * x[i];
        }
    }
}

/* Writes the accelerations without the forces of rows, and the accelerations c of the rows that belong to them;
 * violated rows decay at the rate `decay`. */
static inline void lw_free_accelerations(const lw_point *p, const lw_rows *r, double decay, double *a, double *c) {
    double bias[LW_NV];
    lw_input_forces(&p->own, p->t, p->q, p->v, p->u, a);
    lw_bias_forces(&p->own, p->t, p->q, p->v, bias);
    for (int k = 0; k < LW_NV; ++k) {
        a[k] -= bias[k];
    }
    lw_solve_factorised(LW_NV, r->factor, a);
    for (int i = 0; i < LW_ROWS; ++i) {
        c[i] = r->biases[i] + 2.0 * decay * r->velocities[i] + decay * decay * r->residuals[i];
        for (int k = 0; k < LW_NV; ++k) {
            c[i] += r->jacobian[i * LW_NV + k] * a[k];
        }
    }
}

/* Selects the rows of constraints and closed contacts. */
static inline void lw_select(const lw_state *s, bool *selected) {
    for (int i = 0; i < LW_ROWS; ++i) {
        selected[i] = i < LW_CONSTRAINTS || s->closed[i - LW_CONSTRAINTS];
    }
}

/* Returns the largest violation of constraints and closed contacts. */
static inline double lw_violation(const lw_state *s, const lw_rows *r) {
    bool selected[LW_ROWS];
    double largest = 0.0;
    lw_select(s, selected);
    for (int i = 0; i < LW_ROWS; ++i) {
        largest = selected[i] ? fmax(largest, fmax(fabs(r->residuals[i]), fabs(r->velocities[i]))) : largest;
    }
    return largest;
}

/* Projects the configuration onto the selected rows, and on request the velocity too, in the metric of the mass
 * matrix. Returns NULL, or why it cannot be done. */
static inline const char *lw_project(lw_state *s, const bool *selected, bool projects_velocity) {
    lw_point p;
    lw_rows r;
    double x[LW_ROWS], error = 0.0;
    for (int attempt = 0; attempt < 50; ++attempt) {
        double before = error, step[LW_NV] = {0.0};
        lw_point_at(s, &p);
        if (!lw_rows_at(&p, &r)) {
            return "the mass matrix is not positive definite";
        }
        error = 0.0;
        for (int i = 0; i < LW_ROWS; ++i) {
            error = selected[i] ? fmax(error, fabs(r.residuals[i])) : error;
        }
        if (error < 1e-13 || (attempt > 1 && error < 1e-9 && error >= before) || !isfinite(error)) {
            break;
        }
        lw_solve_selected(r.matrix, r.residuals, selected, x);
        lw_add_responses(&r, x, step);
        lw_integrate(&p.own, p.q, step, s->states);
    }
    if (!(error < 1e-9)) {
        return "no configuration near the present one satisfies the constraints";
    }
    memcpy(s->states, p.q, LW_NQ * sizeof(double));
    if (projects_velocity) {
        lw_solve_selected(r.matrix, r.velocities, selected, x);
        lw_add_responses(&r, x, s->states + LW_NQ);
    }
    return NULL;
}

#endif

/* Writes rates, outputs and event indicators of a state. Returns NULL, or why they cannot be computed. */
static inline const char *lw_evaluate(const lw_state *s, double decay, lw_values *values) {
    lw_point p;
    double w[LW_AT_LEAST_ONE(LW_NV)], *a = values->rates + LW_NQ;
    lw_point_at(s, &p);
    lw_joint_velocities(&p.own, p.t, p.q, p.v, w);
    lw_configuration_rate(s->states, w, values->rates);
#if LW_ROWS > 0
    lw_rows r;
    bool selected[LW_ROWS];
    double c[LW_ROWS], x[LW_ROWS];
    if (!lw_rows_at(&p, &r)) {
        return "the mass matrix is not positive definite";
    }
    lw_select(s, selected);
    lw_free_accelerations(&p, &r, decay, a, c);
    lw_solve_selected(r.matrix, c, selected, x);
    lw_add_responses(&r, x, a);
    for (int i = 0; i < LW_CONTACTS; ++i) {
        const int row = LW_CONSTRAINTS + i;
        values->indicators[i] = s->closed[i] ? x[row] : r.residuals[row] + LW_OVERLAP;
    }
#else
    double tau[LW_AT_LEAST_ONE(LW_NV)];
    (void)(decay);
    lw_input_forces(&p.own, p.t, p.q, p.v, p.u, tau);
    lw_accelerations(&p.own, p.t, p.q, p.v, tau, a);
#endif
    lw_results(&p.own, p.t, p.q, p.v, a, p.u, values->rates + LW_NQ + LW_NV, values->outputs);
    if (!lw_all_finite(LW_STATES, values->rates)) {
        return "the rates of the states are not finite: the state is singular, or a parameter has no physical value";
    }
    if (!lw_all_finite(LW_NY, values->outputs)) {
        return "an output is not finite";
    }
    return NULL;
}

/* Returns NULL for parameters that give a positive definite mass matrix, otherwise the message. */
static inline const char *lw_check_parameters(const lw_state *s) {
    lw_point p;
    double matrix[LW_AT_LEAST_ONE(LW_SQUARE)];
    lw_point_at(s, &p);
    lw_mass_matrix(&p.own, p.t, p.q, matrix);
    return lw_factorise(LW_NV, matrix) ? NULL : "the mass matrix is not positive definite: check masses and inertias";
}
