/* Accelerations for given inputs. */
static void lw_accelerations_under(@OWN_DECLARED@@T_DECLARED@const double *q, const double *v, const double *u, double *a) {
    double tau[@NV@];
#if INPUTS
    @FORCES@;
#else
    (void)(u);
    for (int k = 0; k < @N@; ++k) {
        tau[k] = 0.0;
    }
#endif
    @PREFIX@_forward_dynamics(@OWN@@T@q, v, tau, a);
}

@semi_implicit_euler_step@ {
    double a[@NV@], w[@NV@], dv[@NV@];
    lw_accelerations_under(@OWN@@T@q, v, u, a);
    for (int k = 0; k < @N@; ++k) {
        w[k] = v[k] + h * a[k];
        dv[k] = h * w[k];
    }
    @PREFIX@_integrate(@OWN@q, dv, next_q);
    for (int k = 0; k < @N@; ++k) {
        next_v[k] = w[k];
    }
}

@rk4_step@ {
    static const double parts[3] = {0.5, 0.5, 1.0};
    double rate[@NV@], a[@NV@], dv[@NV@], w[@NV@], at[@NQ@];
    /* Sums over the first and the last stage, and over those between them. */
    double outer_rate[@NV@], outer_a[@NV@], inner_rate[@NV@], inner_a[@NV@];
    lw_accelerations_under(@OWN@@T@q, v, u, a);
    for (int k = 0; k < @N@; ++k) {
        rate[k] = v[k];
        outer_rate[k] = v[k];
        outer_a[k] = a[k];
        inner_rate[k] = 0.0;
        inner_a[k] = 0.0;
    }
    for (int stage = 0; stage < 3; ++stage) {
        const double s = parts[stage] * h;
        double *sum_rate = stage < 2 ? inner_rate : outer_rate;
        double *sum_a = stage < 2 ? inner_a : outer_a;
        for (int k = 0; k < @N@; ++k) {
            dv[k] = s * rate[k];
            w[k] = v[k] + s * a[k];
        }
#if SPEEDS
        @PREFIX@_displacement_rate(@OWN@q, dv, w, rate);
#else
        @PREFIX@_tangent_rate(@OWN@dv, w, rate);
#endif
        @PREFIX@_integrate(@OWN@q, dv, at);
        lw_accelerations_under(@OWN@@LATER@at, w, u, a);
        for (int k = 0; k < @N@; ++k) {
            sum_rate[k] += rate[k];
            sum_a[k] += a[k];
        }
    }
    for (int k = 0; k < @N@; ++k) {
        dv[k] = h / 6.0 * (outer_rate[k] + 2.0 * inner_rate[k]);
        w[k] = v[k] + h / 6.0 * (outer_a[k] + 2.0 * inner_a[k]);
    }
    @PREFIX@_integrate(@OWN@q, dv, next_q);
    for (int k = 0; k < @N@; ++k) {
        next_v[k] = w[k];
    }
}

#if TRANSITIONS
/* Accelerations for given inputs, with their derivatives. */
static void lw_linear_motion(@OWN_DECLARED@@T_DECLARED@const double *q, const double *v, const double *u, double *a, double *by_q,
    double *by_v, double *by_u) {
    double tau[@NV@], by_tau[@NV@ * @NV@];
#if INPUTS
    @FORCES@;
#else
    (void)(u);
    for (int k = 0; k < @N@; ++k) {
        tau[k] = 0.0;
    }
#endif
    @PREFIX@_forward_dynamics_derivatives(@OWN@@T@q, v, tau, by_q, by_v, by_tau);
#if INPUTS
    double force_by_q[@NV@ * @NV@], force_by_v[@NV@ * @NV@], force_by_u[@NV@ * @NU@];
    @PREFIX@_generalized_forces_derivatives(@OWN@@T@q, v, u, force_by_q, force_by_v, force_by_u);
#if FORCES_BY_Q
    lw_add_products(@N@, by_tau, force_by_q, by_q);
#endif
#if FORCES_BY_V
    lw_add_products(@N@, by_tau, force_by_v, by_v);
#endif
    for (int k = 0; k < @N@ * @M@; ++k) {
        by_u[k] = 0.0;
    }
    lw_add_products(@M@, by_tau, force_by_u, by_u);
#else
    (void)(by_u);
#endif
    @PREFIX@_forward_dynamics(@OWN@@T@q, v, tau, a);
}

/* Layout of quantities that depend on the start of a step: the value, then the derivatives with respect to q, v, u and h, with NV
 * entries each. */
enum {
    LW_CHANGING = (1 + @COLUMNS@) * @NV@,
    LW_BY_Q = @N@,
    LW_BY_V = (1 + @N@) * @N@,
    LW_BY_U = (1 + 2 * @N@) * @N@,
    LW_BY_H = (1 + 2 * @N@ + @M@) * @N@
};

/* a + s b, where s is a fraction of the step size. */
static void lw_plus_part(const double *a, double part, double h, const double *b, double *sum) {
    for (int k = 0; k < LW_CHANGING; ++k) {
        sum[k] = a[k] + part * h * b[k];
    }
#if !TIME
    for (int k = 0; k < @N@; ++k) {
        sum[LW_BY_H + k] += part * b[k];
    }
#endif
}

#if SPEEDS
/* Motion of the configuration after a displacement, with its derivatives. */
static void lw_moved(@START_DECLARED@const double *displacement, double *motion) {
    double by_q[@NV@ * @NV@], by_dv[@NV@ * @NV@];
    @PREFIX@_integrate_derivatives(@START@displacement, by_q, by_dv);
    for (int k = 0; k < LW_CHANGING; ++k) {
        motion[k] = k < @N@ ? displacement[k] : 0.0;
    }
    lw_add_products(@COLUMNS@, by_dv, displacement + LW_BY_Q, motion + LW_BY_Q);
    for (int k = 0; k < @N@ * @N@; ++k) {
        motion[LW_BY_Q + k] += by_q[k];
    }
}

/* Rate of a displacement for which the configuration moves with the velocity v, with its derivatives. */
static void lw_rate_of(@START_DECLARED@const double *displacement, const double *v, double *rate) {
    double by_q[@NV@ * @NV@], by_dv[@NV@ * @NV@], by_v[@NV@ * @NV@];
    @PREFIX@_displacement_rate_derivatives(@START@displacement, v, by_q, by_dv, by_v);
    for (int k = 0; k < LW_CHANGING; ++k) {
        rate[k] = 0.0;
    }
    @PREFIX@_displacement_rate(@START@displacement, v, rate);
    lw_add_products(@COLUMNS@, by_dv, displacement + LW_BY_Q, rate + LW_BY_Q);
    lw_add_products(@COLUMNS@, by_v, v + LW_BY_Q, rate + LW_BY_Q);
    for (int k = 0; k < @N@ * @N@; ++k) {
        rate[LW_BY_Q + k] += by_q[k];
    }
}
#else
#if PLAINS
/* Velocities of the plain coordinates. */
static const int lw_plain_joints[@PLAINS@] = {@PLAIN_JOINTS@};

#endif
/* Motion of the configuration after a displacement, with its derivatives. */
static void lw_moved(const double *displacement, double *motion) {
    for (int k = 0; k < LW_CHANGING; ++k) {
        motion[k] = displacement[k];
    }
#if PLAINS
    for (int j = 0; j < @PLAINS@; ++j) {
        motion[(1 + lw_plain_joints[j]) * @N@ + lw_plain_joints[j]] += 1.0;
    }
#endif
#if BALLS
    for (int j = 0; j < @BALLS@; ++j) {
        double by_q[9], by_dv[9];
        const int at = lw_ball_joints[j];
        lw_ball_integrate_derivatives(displacement + at, by_q, by_dv);
        lw_moved_block(3, at, by_dv, displacement, motion);
        for (int k = 0; k < 9; ++k) {
            motion[(1 + at + k / 3) * @N@ + at + k % 3] += by_q[k];
        }
    }
#endif
#if FREES
    for (int j = 0; j < @FREES@; ++j) {
        double by_q[36], by_dv[36];
        const int at = lw_free_joints[j];
        lw_free_integrate_derivatives(displacement + at, by_q, by_dv);
        lw_moved_block(6, at, by_dv, displacement, motion);
        for (int k = 0; k < 36; ++k) {
            motion[(1 + at + k / 6) * @N@ + at + k % 6] += by_q[k];
        }
    }
#endif
}

/* Rate of a displacement for which the configuration moves with the velocity v, with its derivatives. */
static void lw_rate_of(const double *displacement, const double *v, double *rate) {
    for (int k = 0; k < LW_CHANGING; ++k) {
        rate[k] = v[k];
    }
    (void)(displacement);
#if BALLS
    for (int j = 0; j < @BALLS@; ++j) {
        double by_dv[9], by_v[9], of_v[LW_CHANGING];
        const int at = lw_ball_joints[j];
        lw_ball_tangent_rate_derivatives(displacement + at, v + at, by_dv, by_v);
        lw_ball_tangent_rate(displacement + at, v + at, rate + at);
        lw_moved_block(3, at, by_dv, displacement, rate);
        lw_moved_block(3, at, by_v, v, of_v);
        for (int i = 1; i <= @COLUMNS@; ++i) {
            for (int k = at; k < at + 3; ++k) {
                rate[i * @N@ + k] += of_v[i * @N@ + k];
            }
        }
    }
#endif
#if FREES
    for (int j = 0; j < @FREES@; ++j) {
        double by_dv[36], by_v[36], of_v[LW_CHANGING];
        const int at = lw_free_joints[j];
        lw_free_tangent_rate_derivatives(displacement + at, v + at, by_dv, by_v);
        lw_free_tangent_rate(displacement + at, v + at, rate + at);
        lw_moved_block(6, at, by_dv, displacement, rate);
        lw_moved_block(6, at, by_v, v, of_v);
        for (int i = 1; i <= @COLUMNS@; ++i) {
            for (int k = at; k < at + 6; ++k) {
                rate[i * @N@ + k] += of_v[i * @N@ + k];
            }
        }
    }
#endif
}
#endif

/* Acceleration with its derivatives, from the derivatives of configuration and velocity. */
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
#if !INPUTS
    (void)(by_input);
#endif
    for (int k = 0; k < @N@; ++k) {
        next_v[k] = v[k];
        for (int j = 0; j < 2 * @N@; ++j) {
            by_state[j * 2 * @N@ + k] = motion[LW_BY_Q + j * @N@ + k];
            by_state[j * 2 * @N@ + @N@ + k] = v[LW_BY_Q + j * @N@ + k];
        }
#if INPUTS
        for (int j = 0; j < @M@; ++j) {
            by_input[j * 2 * @N@ + k] = motion[LW_BY_U + j * @N@ + k];
            by_input[j * 2 * @N@ + @N@ + k] = v[LW_BY_U + j * @N@ + k];
        }
#endif
#if !TIME
        by_h[k] = motion[LW_BY_H + k];
        by_h[@N@ + k] = v[LW_BY_H + k];
#endif
    }
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
#if TIME
        const double s = part * h;
#endif
        lw_plus_part(zero, part, h, rate, displacement);
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
#endif
