/* Accelerations under inputs with their derivatives. */
static void lw_linear_motion(@OWN_DECLARED@@T_DECLARED@const double *q, const double *v, const double *u, double *a, double *by_q,
    double *by_v, double *by_u) {
    double tau[@NV@], by_tau[@NV@ * @NV@];
    @FORCES@
@LINEAR@    @PREFIX@_forward_dynamics(@OWN@@T@q, v, tau, a);
}

/* Arrays of what changes with the start of a step: the value, then derivatives by q, v, u and h, NV numbers each. */
enum { CHANGING = (1 + @COLUMNS@) * @NV@, BY_Q = @N@, BY_V = (1 + @N@) * @N@, BY_U = (1 + 2 * @N@) * @N@, BY_H = (1 + 2 * @N@ + @M@) * @N@ };

/* a + s b, where s is a part of the step's length. */
static void lw_plus_part(const double *a, double part, double h, const double *b, double *sum) {
    for (int k = 0; k < CHANGING; ++k) {
        sum[k] = a[k] + part * h * b[k];
    }
    for (int k = 0; @PERIOD@ && k < @N@; ++k) {
        sum[BY_H + k] += part * b[k];
    }
}

@WAYS@/* The acceleration of a motion and a velocity that change. */
static void lw_changing_acceleration(@OWN_DECLARED@@T_DECLARED@const double *q, const double *motion, const double *v, const double *u,
    double *result) {
    double by_q[@NV@ * @NV@], by_v[@NV@ * @NV@];
    for (int k = BY_Q; k < CHANGING; ++k) {
        result[k] = 0.0;
    }
    lw_linear_motion(@OWN@@T@q, v, u, result, by_q, by_v, result + BY_U);
    lw_add_products(@COLUMNS@, by_q, motion + BY_Q, result + BY_Q);
    lw_add_products(@COLUMNS@, by_v, v + BY_Q, result + BY_Q);
}

/* Where the columns go. */
static void lw_put_columns(const double *motion, const double *v, double *next_v, double *by_state, double *by_input@H_DECLARED@) {
@UNUSED@    for (int k = 0; k < @N@; ++k) {
        next_v[k] = v[k];
        for (int j = 0; j < 2 * @N@; ++j) {
            by_state[j * 2 * @N@ + k] = motion[BY_Q + j * @N@ + k];
            by_state[j * 2 * @N@ + @N@ + k] = v[BY_Q + j * @N@ + k];
        }
@PUT_INPUTS@@PUT_H@    }
}

@semi_implicit_euler_transition@ {
    double start[CHANGING], a[CHANGING], w[CHANGING], displacement[CHANGING], motion[CHANGING];
    for (int k = 0; k < CHANGING; ++k) {
        start[k] = 0.0;
        a[k] = 0.0;
        displacement[k] = 0.0;
    }
    for (int k = 0; k < @N@; ++k) {
        start[k] = v[k];
        start[BY_V + k * @N@ + k] = 1.0;
    }
    lw_linear_motion(@OWN@@T@q, v, u, a, a + BY_Q, a + BY_V, a + BY_U);
    lw_plus_part(start, 1.0, h, a, w);
    lw_plus_part(displacement, 1.0, h, w, displacement);
    lw_moved(@START@displacement, motion);
    @PREFIX@_integrate(@OWN@q, displacement, next_q);
    lw_put_columns(motion, w, next_v, by_state, by_input@H_PASSED@);
}

@rk4_transition@ {
    static const double parts[4] = {0.0, 0.5, 0.5, 1.0};
    double start[CHANGING], zero[CHANGING], rate[CHANGING], a[CHANGING], sum_rate[CHANGING], sum_a[CHANGING];
    double w[CHANGING], displacement[CHANGING], motion[CHANGING], at[@NQ@];
    for (int k = 0; k < CHANGING; ++k) {
        start[k] = 0.0;
        zero[k] = 0.0;
    }
    for (int k = 0; k < @N@; ++k) {
        start[k] = v[k];
        start[BY_V + k * @N@ + k] = 1.0;
    }
    for (int k = 0; k < CHANGING; ++k) {
        rate[k] = start[k];
        a[k] = 0.0;
    }
    lw_linear_motion(@OWN@@T@q, v, u, a, a + BY_Q, a + BY_V, a + BY_U);
    for (int k = 0; k < CHANGING; ++k) {
        sum_rate[k] = rate[k];
        sum_a[k] = a[k];
    }
    for (int stage = 1; stage < 4; ++stage) {
        const double part = parts[stage], weight = stage < 3 ? 2.0 : 1.0;
@S@        lw_plus_part(zero, part, h, rate, displacement);
        lw_plus_part(start, part, h, a, w);
        lw_rate_of(@START@displacement, w, rate);
        lw_moved(@START@displacement, motion);
        @PREFIX@_integrate(@OWN@q, displacement, at);
        lw_changing_acceleration(@OWN@@LATER@at, motion, w, u, a);
        for (int k = 0; k < CHANGING; ++k) {
            sum_rate[k] += weight * rate[k];
            sum_a[k] += weight * a[k];
        }
    }
    lw_plus_part(zero, 1.0 / 6.0, h, sum_rate, displacement);
    lw_plus_part(start, 1.0 / 6.0, h, sum_a, w);
    lw_moved(@START@displacement, motion);
    @PREFIX@_integrate(@OWN@q, displacement, next_q);
    lw_put_columns(motion, w, next_v, by_state, by_input@H_PASSED@);
}

