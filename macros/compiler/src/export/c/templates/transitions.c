/* Accelerations for given inputs, with their derivatives. */
static void lw_linear_motion(@OWN_DECLARED@@T_DECLARED@const double *q, const double *v, const double *u, double *a, double *by_q,
    double *by_v, double *by_u) {
    double tau[@NV@], by_tau[@NV@ * @NV@];
    @FORCES@
@LINEAR@    @PREFIX@_forward_dynamics(@OWN@@T@q, v, tau, a);
}

/* Layout of quantities that depend on the start of a step: the value, then the derivatives with respect to q, v, u and h, with NV
 * entries each. */
enum { LW_CHANGING = (1 + @COLUMNS@) * @NV@, LW_BY_Q = @N@, LW_BY_V = (1 + @N@) * @N@, LW_BY_U = (1 + 2 * @N@) * @N@, LW_BY_H = (1 + 2 * @N@ + @M@) * @N@ };

/* a + s b, where s is a fraction of the step size. */
static void lw_plus_part(const double *a, double part, double h, const double *b, double *sum) {
    for (int k = 0; k < LW_CHANGING; ++k) {
        sum[k] = a[k] + part * h * b[k];
    }
    for (int k = 0; @PERIOD@ && k < @N@; ++k) {
        sum[LW_BY_H + k] += part * b[k];
    }
}

@WAYS@/* Acceleration with its derivatives, from the derivatives of configuration and velocity. */
static void lw_changing_acceleration(@OWN_DECLARED@@T_DECLARED@const double *q, const double *motion, const double *v, const double *u,
    double *result) {
    double by_q[@NV@ * @NV@], by_v[@NV@ * @NV@];
    for (int k = LW_BY_Q; k < LW_CHANGING; ++k) {
        result[k] = 0.0;
    }
    lw_linear_motion(@OWN@@T@q, v, u, result, by_q, by_v, result + LW_BY_U);
    lw_add_products(@COLUMNS@, by_q, motion + LW_BY_Q, result + LW_BY_Q);
    lw_add_products(@COLUMNS@, by_v, v + LW_BY_Q, result + LW_BY_Q);
}

/* Stores the columns of the derivatives in the results. */
static void lw_put_columns(const double *motion, const double *v, double *next_v, double *by_state, double *by_input@H_DECLARED@) {
@UNUSED@    for (int k = 0; k < @N@; ++k) {
        next_v[k] = v[k];
        for (int j = 0; j < 2 * @N@; ++j) {
            by_state[j * 2 * @N@ + k] = motion[LW_BY_Q + j * @N@ + k];
            by_state[j * 2 * @N@ + @N@ + k] = v[LW_BY_Q + j * @N@ + k];
        }
@PUT_INPUTS@@PUT_H@    }
}

@semi_implicit_euler_transition@ {
    double start[LW_CHANGING], a[LW_CHANGING], w[LW_CHANGING], displacement[LW_CHANGING], motion[LW_CHANGING];
    for (int k = 0; k < LW_CHANGING; ++k) {
        start[k] = 0.0;
        a[k] = 0.0;
        displacement[k] = 0.0;
    }
    for (int k = 0; k < @N@; ++k) {
        start[k] = v[k];
        start[LW_BY_V + k * @N@ + k] = 1.0;
    }
    lw_linear_motion(@OWN@@T@q, v, u, a, a + LW_BY_Q, a + LW_BY_V, a + LW_BY_U);
    lw_plus_part(start, 1.0, h, a, w);
    lw_plus_part(displacement, 1.0, h, w, displacement);
    lw_moved(@START@displacement, motion);
    @PREFIX@_integrate(@OWN@q, displacement, next_q);
    lw_put_columns(motion, w, next_v, by_state, by_input@H_PASSED@);
}

@rk4_transition@ {
    static const double parts[4] = {0.0, 0.5, 0.5, 1.0};
    double start[LW_CHANGING], zero[LW_CHANGING], rate[LW_CHANGING], a[LW_CHANGING], sum_rate[LW_CHANGING], sum_a[LW_CHANGING];
    double w[LW_CHANGING], displacement[LW_CHANGING], motion[LW_CHANGING], at[@NQ@];
    for (int k = 0; k < LW_CHANGING; ++k) {
        start[k] = 0.0;
        zero[k] = 0.0;
    }
    for (int k = 0; k < @N@; ++k) {
        start[k] = v[k];
        start[LW_BY_V + k * @N@ + k] = 1.0;
    }
    for (int k = 0; k < LW_CHANGING; ++k) {
        rate[k] = start[k];
        a[k] = 0.0;
    }
    lw_linear_motion(@OWN@@T@q, v, u, a, a + LW_BY_Q, a + LW_BY_V, a + LW_BY_U);
    for (int k = 0; k < LW_CHANGING; ++k) {
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
        for (int k = 0; k < LW_CHANGING; ++k) {
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

