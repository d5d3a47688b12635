/* Products of a row vector with the Jacobians of forward_dynamics. They are those of inverse_dynamics, at the acceleration, with
 * the row vector -w M^-1. */
static void @PREFIX@_forward_dynamics_vjp(@OWN_DECLARED@@T_DECLARED@const double *q, const double *v, const double *tau, const double *w, double *by_q, double *by_v, double *by_tau) {
    double weights[@NV@], sums_q[@NV@], sums_v[@NV@], sums_tau[@NV@], a[@NV@];
    LW_UNROLL for (int k = 0; k < @NV@; ++k) {
        weights[k] = w[k];
        sums_q[k] = 0.0, sums_v[k] = 0.0, sums_tau[k] = 0.0;
    }
@INVERSE@    LW_UNROLL for (int k = 0; k < @NV@; ++k) {
        by_tau[k] = sums_tau[k];
        weights[k] = -sums_tau[k];
    }
    @PREFIX@_forward_dynamics(@OWN@@T@q, v, tau, a);
    const lw_products<double, @NV@> of_q = {weights, sums_q}, of_v = {weights, sums_v};
    @PREFIX@_inverse_dynamics_derivatives(@OWN@@T@q, v, a, of_q, of_v);
    LW_UNROLL for (int k = 0; k < @NV@; ++k) {
        by_q[k] = sums_q[k];
        by_v[k] = sums_v[k];
    }
}

