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
        @RATE_OF_WAY@;
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
