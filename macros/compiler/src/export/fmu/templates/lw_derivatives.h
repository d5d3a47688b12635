/* Derivatives of rates and outputs by states, inputs and parameters.
 *
 * LW_GENERATED: those by q, v and inputs are from generated functions. LW_GENERATED_CONSTANTS: those by states of first
 * order and parameters too. All others are central differences. */

#if LW_DIFFERENTIABLE

#define LW_KNOWNS (LW_STATES + LW_NU + LW_NP)
#define LW_UNKNOWNS (LW_STATES + LW_NY)
#define LW_CONSTANTS (LW_NX + LW_NP)

/* Magnitude of a value, of which a difference is a small part. A parameter may be far smaller than one. */
static inline double lw_magnitude(const lw_state *s, int k) {
    const int parameter = k - LW_STATES - LW_NU;
    if (parameter >= 0) {
        return s->parameters[parameter] != 0.0 ? fabs(s->parameters[parameter]) : 1.0;
    }
    return fmax(1.0, fabs(k < LW_STATES ? s->states[k] : s->inputs[k - LW_STATES]));
}

/* Writes the change of rates and outputs by central differences. Returns NULL, or why it cannot be computed. */
static inline const char *lw_differences(const lw_state *s, double decay, const double *change, double *result) {
    double size = 0.0;
    lw_values values[2];
    memset(result, 0, LW_UNKNOWNS * sizeof(double));
    for (int k = 0; k < LW_KNOWNS; ++k) {
        size = fmax(size, fabs(change[k]) / lw_magnitude(s, k));
    }
    if (!(size > 0.0)) {
        return NULL;
    }
    for (int side = 0; side < 2; ++side) {
        const double part = (side ? 1e-5 : -1e-5) / size;
        lw_state moved = *s;
        for (int k = 0; k < LW_STATES; ++k) {
            moved.states[k] += part * change[k];
        }
        for (int k = 0; k < LW_NU; ++k) {
            moved.inputs[k] += part * change[LW_STATES + k];
        }
        for (int k = 0; k < LW_NP; ++k) {
            moved.parameters[k] += part * change[LW_STATES + LW_NU + k];
        }
        const char *problem = lw_evaluate(&moved, decay, &values[side]);
        if (problem) {
            return problem;
        }
    }
    for (int k = 0; k < LW_STATES; ++k) {
        result[k] = (values[1].rates[k] - values[0].rates[k]) * size / 2e-5;
    }
    for (int k = 0; k < LW_NY; ++k) {
        result[LW_STATES + k] = (values[1].outputs[k] - values[0].outputs[k]) * size / 2e-5;
    }
    return NULL;
}

#if !LW_GENERATED

typedef struct {
    char none;
} lw_derivatives;

static inline const char *lw_differentiate(const lw_state *s, double decay, lw_derivatives *d) {
    (void)s, (void)decay, (void)d;
    return NULL;
}

static inline const char *lw_apply(const lw_state *s, double decay, const lw_derivatives *d, const double *change,
    double *result) {
    (void)d;
    return lw_differences(s, decay, change, result);
}

#else

/* Matrices by columns; derivatives by `q` are along displacements, and `constants` are all members of the
 * parameter struct: states of first order and parameters. */
typedef struct {
    double a_by_q[LW_AT_LEAST_ONE(LW_SQUARE)];
    double a_by_v[LW_AT_LEAST_ONE(LW_SQUARE)];
    double a_by_u[LW_AT_LEAST_ONE(LW_NV * LW_NU)];
    double a_by_constants[LW_AT_LEAST_ONE(LW_NV * LW_CONSTANTS)];
    double r_by_q[LW_AT_LEAST_ONE(LW_RESULTS * LW_NV)];
    double r_by_v[LW_AT_LEAST_ONE(LW_RESULTS * LW_NV)];
    double r_by_a[LW_AT_LEAST_ONE(LW_RESULTS * LW_NV)];
    double r_by_u[LW_AT_LEAST_ONE(LW_RESULTS * LW_NU)];
    double r_by_constants[LW_AT_LEAST_ONE(LW_RESULTS * LW_CONSTANTS)];
} lw_derivatives;

/* Adds the product of a matrix of `rows` by `columns` and a vector. */
static inline void lw_add_product(int rows, int columns, const double *matrix, const double *x, double *y) {
    for (int j = 0; j < columns; ++j) {
        for (int i = 0; i < rows; ++i) {
            y[i] += matrix[j * rows + i] * x[j];
        }
    }
}

#if LW_CONSTRAINTS > 0

/* Solves for the change of accelerations that belongs to changes of forces and of the accelerations of the rows. */
static inline void lw_respond(const lw_rows *r, const double *forces, double *rows, double *a) {
    bool selected[LW_ROWS];
    double x[LW_ROWS];
    memcpy(a, forces, LW_NV * sizeof(double));
    lw_solve_factorised(LW_NV, r->factor, a);
    for (int i = 0; i < LW_ROWS; ++i) {
        selected[i] = true;
        for (int k = 0; k < LW_NV; ++k) {
            rows[i] += r->jacobian[i * LW_NV + k] * a[k];
        }
    }
    lw_solve_selected(r->matrix, rows, selected, x);
    lw_add_responses(r, x, a);
}

/* Writes the derivatives of accelerations of a mechanism with constraints, and the accelerations. */
static inline const char *lw_acceleration_changes(const lw_state *s, const lw_point *p, double decay,
    const double *f_by_q, const double *f_by_v, const double *f_by_u, double *a, lw_derivatives *d) {
    lw_rows r;
    bool selected[LW_ROWS];
    double c[LW_ROWS], x[LW_ROWS], forces[LW_NV], forces_by_q[LW_SQUARE], forces_by_v[LW_SQUARE];
    double rows[LW_ROWS], bias_by_q[LW_ROWS * LW_NV], bias_by_v[LW_ROWS * LW_NV], rates_by_q[LW_ROWS * LW_NV];
    if (!lw_rows_at(p, &r)) {
        return "the mass matrix is not positive definite";
    }
    lw_select(s, selected);
    lw_free_accelerations(p, &r, decay, a, c);
    lw_solve_selected(r.matrix, c, selected, x);
    lw_add_responses(&r, x, a);
    lw_motion_derivatives(&p->own, p->t, p->q, p->v, a, x, forces_by_q, forces_by_v, bias_by_q, bias_by_v, rates_by_q);
    for (int j = 0; j < LW_NV; ++j) {
        for (int k = 0; k < LW_NV; ++k) {
            forces[k] = f_by_q[j * LW_NV + k] - forces_by_q[j * LW_NV + k];
        }
        for (int i = 0; i < LW_ROWS; ++i) {
            const double of_residual = i < LW_HOLONOMIC ? decay * decay * r.jacobian[i * LW_NV + j] : 0.0;
            rows[i] = bias_by_q[j * LW_ROWS + i] + 2.0 * decay * rates_by_q[j * LW_ROWS + i] + of_residual;
        }
        lw_respond(&r, forces, rows, d->a_by_q + j * LW_NV);
        for (int k = 0; k < LW_NV; ++k) {
            forces[k] = f_by_v[j * LW_NV + k] - forces_by_v[j * LW_NV + k];
        }
        for (int i = 0; i < LW_ROWS; ++i) {
            rows[i] = bias_by_v[j * LW_ROWS + i] + 2.0 * decay * r.jacobian[i * LW_NV + j];
        }
        lw_respond(&r, forces, rows, d->a_by_v + j * LW_NV);
    }
    for (int j = 0; j < LW_NU; ++j) {
        memset(rows, 0, sizeof rows);
        lw_respond(&r, f_by_u + j * LW_NV, rows, d->a_by_u + j * LW_NV);
    }
    return NULL;
}

#else

/* Adds the products of a matrix of NV by NV with `columns` columns. */
static inline void lw_add_products_by(int columns, const double *matrix, const double *factors, double *sums) {
    for (int j = 0; j < columns; ++j) {
        lw_add_product(LW_NV, LW_NV, matrix, factors + j * LW_NV, sums + j * LW_NV);
    }
}

#endif

/* Writes the derivatives at a state. Returns NULL, or why they cannot be computed. */
static inline const char *lw_differentiate(const lw_state *s, double decay, lw_derivatives *d) {
    lw_point p;
    double a[LW_AT_LEAST_ONE(LW_NV)];
    double f_by_q[LW_AT_LEAST_ONE(LW_SQUARE)] = {0.0}, f_by_v[LW_AT_LEAST_ONE(LW_SQUARE)] = {0.0};
    double f_by_u[LW_AT_LEAST_ONE(LW_NV * LW_NU)] = {0.0};
    double f_by_constants[LW_AT_LEAST_ONE(LW_NV * LW_CONSTANTS)] = {0.0};
    memset(d, 0, sizeof *d);
    lw_point_at(s, &p);
    lw_force_derivatives(&p.own, p.t, p.q, p.v, p.u, f_by_q, f_by_v, f_by_u, f_by_constants);
#if LW_CONSTRAINTS > 0
    const char *problem = lw_acceleration_changes(s, &p, decay, f_by_q, f_by_v, f_by_u, a, d);
    if (problem) {
        return problem;
    }
#else
    double tau[LW_AT_LEAST_ONE(LW_NV)], by_tau[LW_AT_LEAST_ONE(LW_SQUARE)];
    (void)(decay);
    lw_input_forces(&p.own, p.t, p.q, p.v, p.u, tau);
    lw_accelerations(&p.own, p.t, p.q, p.v, tau, a);
    lw_acceleration_derivatives(&p.own, p.t, p.q, p.v, tau, d->a_by_q, d->a_by_v, by_tau, d->a_by_constants);
    lw_add_products_by(LW_NV, by_tau, f_by_q, d->a_by_q);
    lw_add_products_by(LW_NV, by_tau, f_by_v, d->a_by_v);
    lw_add_products_by(LW_NU, by_tau, f_by_u, d->a_by_u);
    lw_add_products_by(LW_CONSTANTS, by_tau, f_by_constants, d->a_by_constants);
#endif
    lw_result_derivatives(&p.own, p.t, p.q, p.v, a, p.u, d->r_by_q, d->r_by_v, d->r_by_a, d->r_by_u,
        d->r_by_constants);
    const bool is_finite = lw_all_finite(LW_SQUARE, d->a_by_q) && lw_all_finite(LW_SQUARE, d->a_by_v);
    return is_finite ? NULL : "the derivatives are not finite";
}

/* Converts a change of the entries of the configuration to a displacement. */
static inline void lw_displacement(const double *q, const double *change, double *displacement) {
    for (int k = 0; k < LW_PLAINS; ++k) {
        displacement[lw_plains[k][1]] = change[lw_plains[k][0]];
    }
    for (int k = 0; k < LW_BALLS; ++k) {
        const double *a = q + lw_balls[k][0], *b = change + lw_balls[k][0];
        const double square = a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + a[3] * a[3];
        double *rotation = displacement + lw_balls[k][1];
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            rotation[i] = 2.0 * (a[3] * b[i] - b[3] * a[i] - a[j] * b[l] + a[l] * b[j]) / square;
        }
        if (lw_balls[k][2] >= 0) {
            lw_rotate_by(a, -1.0, change + lw_balls[k][2], rotation - 3);
        }
    }
}

/* Writes the change of the rates of the configuration. */
static inline void lw_rate_change(const double *q, const double *v, const double *change, const double *displacement,
    const double *dv, double *result) {
    double w[LW_AT_LEAST_ONE(LW_NV)], of_quaternions[LW_AT_LEAST_ONE(LW_NQ)] = {0.0};
    memcpy(w, dv, LW_NV * sizeof(double));
    for (int k = 0; k < LW_BALLS; ++k) {
        const int first = lw_balls[k][1] - 3;
        for (int i = 0; i < 3 && lw_balls[k][2] >= 0; ++i) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            const double *o = displacement + first + 3;
            w[first + i] += o[j] * v[first + l] - o[l] * v[first + j];
        }
    }
    lw_configuration_rate(q, w, result);
    lw_configuration_rate(change, v, of_quaternions);
    for (int k = 0; k < LW_BALLS; ++k) {
        for (int i = lw_balls[k][0]; i < lw_balls[k][0] + 4; ++i) {
            result[i] += of_quaternions[i];
        }
    }
}

/* Writes the change of rates and of the outputs with generated derivatives. */
static inline void lw_apply_generated(const lw_state *s, const lw_derivatives *d, const double *change, double *result) {
    const double *dv = change + LW_NQ, *du = change + LW_STATES;
    double displacement[LW_AT_LEAST_ONE(LW_NV)], constants[LW_AT_LEAST_ONE(LW_CONSTANTS)] = {0.0};
    double r[LW_AT_LEAST_ONE(LW_RESULTS)] = {0.0}, *a = result + LW_NQ;
    memset(result, 0, LW_UNKNOWNS * sizeof(double));
    lw_displacement(s->states, change, displacement);
    lw_rate_change(s->states, s->states + LW_NQ, change, displacement, dv, result);
    for (int k = 0; k < LW_CONSTANTS && LW_GENERATED_CONSTANTS; ++k) {
        constants[lw_columns[k]] = change[k < LW_NX ? LW_NQ + LW_NV + k : LW_STATES + LW_NU + k - LW_NX];
    }
    lw_add_product(LW_NV, LW_NV, d->a_by_q, displacement, a);
    lw_add_product(LW_NV, LW_NV, d->a_by_v, dv, a);
    lw_add_product(LW_NV, LW_NU, d->a_by_u, du, a);
    lw_add_product(LW_NV, LW_CONSTANTS, d->a_by_constants, constants, a);
    lw_add_product(LW_RESULTS, LW_NV, d->r_by_q, displacement, r);
    lw_add_product(LW_RESULTS, LW_NV, d->r_by_v, dv, r);
    lw_add_product(LW_RESULTS, LW_NV, d->r_by_a, a, r);
    lw_add_product(LW_RESULTS, LW_NU, d->r_by_u, du, r);
    lw_add_product(LW_RESULTS, LW_CONSTANTS, d->r_by_constants, constants, r);
    memcpy(result + LW_NQ + LW_NV, r, LW_RESULTS * sizeof(double));
}

/* Writes the change of rates and outputs that belongs to a change of states, inputs and parameters. Returns NULL, or why
 * it cannot be computed. */
static inline const char *lw_apply(const lw_state *s, double decay, const lw_derivatives *d, const double *change,
    double *result) {
    const int generated = LW_UNKNOWNS - LW_NUMERIC;
    double differences[LW_UNKNOWNS];
    lw_apply_generated(s, d, change, result);
    /* The last outputs, energies among them. */
    const char *problem = lw_differences(s, decay, change, differences);
    memcpy(result + generated, differences + generated, LW_NUMERIC * sizeof(double));
#if LW_CONSTANTS > 0 && !LW_GENERATED_CONSTANTS
    double constants[LW_KNOWNS] = {0.0};
    memcpy(constants + LW_NQ + LW_NV, change + LW_NQ + LW_NV, LW_NX * sizeof(double));
    memcpy(constants + LW_STATES + LW_NU, change + LW_STATES + LW_NU, LW_NP * sizeof(double));
    problem = problem ? problem : lw_differences(s, decay, constants, differences);
    for (int k = 0; k < generated; ++k) {
        result[k] += differences[k];
    }
#endif
    return problem;
}

#endif

#endif
