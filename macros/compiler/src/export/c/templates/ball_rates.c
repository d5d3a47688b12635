static void lw_ball_tangent_rate(const double dv[3], const double v[3], double result[3]) {
    double first[3], second[3];
    lw_cross_into(dv, v, first);
    lw_cross_into(dv, first, second);
    const double factor = lw_second_bracket(lw_dot_of(dv, dv));
    for (int k = 0; k < 3; ++k) {
        result[k] = v[k] + 0.5 * first[k] + factor * second[k];
    }
}
