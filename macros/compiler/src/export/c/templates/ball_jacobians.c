/* Derivatives of q + dv of a ball joint in body axes with respect to q and dv, by columns: exp(-dv) and the right Jacobian of
 * SO(3) (Chirikjian, Stochastic Models, Information Theory, and Lie Groups, vol. 2, 2012, 10.6). */
static void lw_ball_integrate_derivatives(const double dv[3], double by_q[9], double by_dv[9]) {
    const double back[3] = {-dv[0], -dv[1], -dv[2]};
    double turn[4], factors[2];
    lw_exponential(back, turn);
    lw_left_jacobian(lw_dot_of(dv, dv), factors);
    for (int j = 0; j < 3; ++j) {
        const double e[3] = {j == 0 ? 1.0 : 0.0, j == 1 ? 1.0 : 0.0, j == 2 ? 1.0 : 0.0};
        double first[3], second[3], inner[3], outer[3];
        lw_cross_into(dv, e, first);
        lw_cross_into(dv, first, second);
        lw_cross_into(turn, e, inner);
        for (int k = 0; k < 3; ++k) {
            inner[k] += turn[3] * e[k];
        }
        lw_cross_into(turn, inner, outer);
        for (int k = 0; k < 3; ++k) {
            by_q[3 * j + k] = e[k] + 2.0 * outer[k];
            by_dv[3 * j + k] = e[k] - factors[0] * first[k] + factors[1] * second[k];
        }
    }
}

/* Derivatives of the rate of dv of a ball joint with respect to dv and v. */
static void lw_ball_tangent_rate_derivatives(const double dv[3], const double v[3], double by_dv[9], double by_v[9]) {
    const double square = lw_dot_of(dv, dv);
    double factors[2], first[3], twice[3];
    lw_even_brackets(square, factors);
    const double second = lw_second_bracket(square), fall = -2.0 * factors[1];
    lw_cross_into(dv, v, first);
    lw_cross_into(dv, first, twice);
    for (int j = 0; j < 3; ++j) {
        const double e[3] = {j == 0 ? 1.0 : 0.0, j == 1 ? 1.0 : 0.0, j == 2 ? 1.0 : 0.0};
        double changed[3], outer[3], inner[3];
        lw_cross_into(e, v, changed);
        lw_cross_into(e, first, outer);
        lw_cross_into(dv, changed, inner);
        for (int k = 0; k < 3; ++k) {
            by_dv[3 * j + k] = 0.5 * changed[k] + second * (outer[k] + inner[k]) + fall * dv[j] * twice[k];
        }
        lw_ball_tangent_rate(dv, e, by_v + 3 * j);
    }
}
