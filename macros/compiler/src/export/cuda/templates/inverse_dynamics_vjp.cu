/* Products of a row vector with the Jacobians of inverse_dynamics. */
static void @PREFIX@_inverse_dynamics_vjp(@OWN_DECLARED@@T_DECLARED@const double *q, const double *v, const double *a, const double *w, double *by_q, double *by_v, double *by_a) {
    double weights[@NV@], sums_q[@NV@], sums_v[@NV@], sums_a[@NV@];
    LW_UNROLL for (int k = 0; k < @NV@; ++k) {
        weights[k] = w[k];
        sums_q[k] = 0.0, sums_v[k] = 0.0, sums_a[k] = 0.0;
    }
    const lw_products<double, @NV@> of_q = {weights, sums_q}, of_v = {weights, sums_v}, of_a = {weights, sums_a};
    @PREFIX@_inverse_dynamics_derivatives(@OWN@@T@q, v, a, of_q, of_v);
    @PREFIX@_mass_matrix(@OWN@@T@q, of_a);
    LW_UNROLL for (int k = 0; k < @NV@; ++k) {
        by_q[k] = sums_q[k];
        by_v[k] = sums_v[k];
        by_a[k] = sums_a[k];
    }
}

