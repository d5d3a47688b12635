/* Accelerations for given inputs. */
static void lw_accelerations_under(@OWN_DECLARED@@T_DECLARED@const double *q, const double *v, const double *u, double *a) {
    double tau[@NV@];
    @FORCES@
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
    double rate[@NV@], a[@NV@], dv[@NV@], w[@NV@], sum_rate[@NV@], sum_a[@NV@], at[@NQ@];
    lw_accelerations_under(@OWN@@T@q, v, u, a);
    for (int k = 0; k < @N@; ++k) {
        rate[k] = v[k];
        sum_rate[k] = v[k];
        sum_a[k] = a[k];
    }
    for (int stage = 0; stage < 3; ++stage) {
        const double s = parts[stage] * h, weight = stage < 2 ? 2.0 : 1.0;
        for (int k = 0; k < @N@; ++k) {
            dv[k] = s * rate[k];
            w[k] = v[k] + s * a[k];
        }
        @RATE_OF_WAY@;
        @PREFIX@_integrate(@OWN@q, dv, at);
        lw_accelerations_under(@OWN@@LATER@at, w, u, a);
        for (int k = 0; k < @N@; ++k) {
            sum_rate[k] += weight * rate[k];
            sum_a[k] += weight * a[k];
        }
    }
    for (int k = 0; k < @N@; ++k) {
        dv[k] = h / 6.0 * sum_rate[k];
        w[k] = v[k] + h / 6.0 * sum_a[k];
    }
    @PREFIX@_integrate(@OWN@q, dv, next_q);
    for (int k = 0; k < @N@; ++k) {
        next_v[k] = w[k];
    }
}

