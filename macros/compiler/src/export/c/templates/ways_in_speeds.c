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

