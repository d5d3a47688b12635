static void ball_tangent_rate(const double dv[3], const double v[3], double result[3]) {
    double first[3], second[3];
    cross_into(dv, v, first);
    cross_into(dv, first, second);
    const double factor = second_bracket(dot_of(dv, dv));
    for (int k = 0; k < 3; ++k) {
        result[k] = v[k] + 0.5 * first[k] + factor * second[k];
    }
}
