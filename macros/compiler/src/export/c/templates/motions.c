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
    const double square = lw_dot_of(dv + 3, dv + 3);
    double a, b;
    if (square < 0.05) {
        static const double even[6] = {2.0, 24.0, 720.0, 40320.0, 3628800.0, 479001600.0};
        static const double odd[6] = {6.0, 120.0, 5040.0, 362880.0, 39916800.0, 6227020800.0};
        a = 0.0;
        b = 0.0;
        for (int k = 5; k >= 0; --k) {
            a = 1.0 / even[k] - square * a;
            b = 1.0 / odd[k] - square * b;
        }
    } else {
        const double angle = sqrt(square);
        const double half = sin(0.5 * angle);
        a = 2.0 * half * half / square;
        b = (angle - sin(angle)) / (angle * square);
    }
    double start[4], first[3], second[3], moved[3], turned[4];
    lw_normalise(q + 3, start);
    lw_cross_into(dv + 3, dv, first);
    lw_cross_into(dv + 3, first, second);
    for (int k = 0; k < 3; ++k) {
        moved[k] = dv[k] + a * first[k] + b * second[k];
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
    static const double series[8] = {1.0 / 12.0, 1.0 / 720.0, 1.0 / 30240.0, 1.0 / 1209600.0, 1.0 / 47900160.0,
        691.0 / 1307674368000.0, 1.0 / 74724249600.0, 3617.0 / 10670622842880000.0};
    const double square = lw_dot_of(dv + 3, dv + 3);
    double second = 0.0, fourth = 0.0;
    if (square < 0.25) {
        for (int k = 7; k >= 0; --k) {
            second = second * square + (1 - k) * series[k];
        }
        for (int k = 7; k >= 1; --k) {
            fourth = fourth * square - k * series[k];
        }
    } else {
        const double half = 0.5 * sqrt(square);
        const double sine = sin(half), cosine = cos(half);
        const double value = 1.0 - half * cosine / sine;
        const double slope = 0.5 * (half * cosine / sine - half * half / (sine * sine));
        second = (2.0 * value + slope) / square;
        fourth = (value + slope) / (square * square);
    }
    double once[6], twice[6], thrice[6], four_times[6];
    lw_bracket(dv, v, once);
    lw_bracket(dv, once, twice);
    lw_bracket(dv, twice, thrice);
    lw_bracket(dv, thrice, four_times);
    for (int k = 0; k < 6; ++k) {
        result[k] = v[k] + 0.5 * once[k] + second * twice[k] + fourth * four_times[k];
    }
}
