/* a + 2 u x (u x a + w a) */
static void lw_rotate(const double q[4], const double a[3], double r[3]) {
    double inner[3], outer[3];
    lw_cross_into(q, a, inner);
    for (int k = 0; k < 3; ++k) {
        inner[k] += q[3] * a[k];
    }
    lw_cross_into(q, inner, outer);
    for (int k = 0; k < 3; ++k) {
        r[k] = a[k] + 2.0 * outer[k];
    }
}

/* Free joints: position and quaternion; velocities in body axes, linear components first. */
static void lw_free_integrate(const double q[7], const double dv[6], double result[7]) {
    double factors[2];
    lw_left_jacobian(lw_dot_of(dv + 3, dv + 3), factors);
    double start[4], first[3], second[3], moved[3], turned[4];
    lw_normalise(q + 3, start);
    lw_cross_into(dv + 3, dv, first);
    lw_cross_into(dv + 3, first, second);
    for (int k = 0; k < 3; ++k) {
        moved[k] = dv[k] + factors[0] * first[k] + factors[1] * second[k];
    }
    lw_rotate(start, moved, moved);
    lw_ball_integrate(start, dv + 3, turned);
    for (int k = 0; k < 3; ++k) {
        result[k] = q[k] + moved[k];
    }
    for (int k = 0; k < 4; ++k) {
        result[3 + k] = turned[k];
    }
}

static void lw_free_difference(const double from[7], const double to[7], double result[6]) {
    double start[4], back[4], turn[3], moved[3], first[3], second[3];
    lw_normalise(from + 3, start);
    lw_ball_difference(start, to + 3, turn);
    for (int k = 0; k < 3; ++k) {
        back[k] = -start[k];
        moved[k] = to[k] - from[k];
    }
    back[3] = start[3];
    lw_rotate(back, moved, moved);
    lw_cross_into(turn, moved, first);
    lw_cross_into(turn, first, second);
    const double factor = lw_second_bracket(lw_dot_of(turn, turn));
    for (int k = 0; k < 3; ++k) {
        result[k] = moved[k] - 0.5 * first[k] + factor * second[k];
        result[3 + k] = turn[k];
    }
}

static void lw_bracket(const double a[6], const double b[6], double c[6]) {
    double first[3], second[3], turned[3];
    lw_cross_into(a + 3, b, first);
    lw_cross_into(a, b + 3, second);
    lw_cross_into(a + 3, b + 3, turned);
    for (int k = 0; k < 3; ++k) {
        c[k] = first[k] + second[k];
        c[3 + k] = turned[k];
    }
}

/* v + [dv, v] / 2 + [dv, [dv, v]] / 12 - ..., summed in closed form (Hairer, Lubich and Wanner 2006, III.4). */
static void lw_free_tangent_rate(const double dv[6], const double v[6], double result[6]) {
    double factors[2];
    lw_even_brackets(lw_dot_of(dv + 3, dv + 3), factors);
    double once[6], twice[6], thrice[6], four_times[6];
    lw_bracket(dv, v, once);
    lw_bracket(dv, once, twice);
    lw_bracket(dv, twice, thrice);
    lw_bracket(dv, thrice, four_times);
    for (int k = 0; k < 6; ++k) {
        result[k] = v[k] + 0.5 * once[k] + factors[0] * twice[k] + factors[1] * four_times[k];
    }
}
