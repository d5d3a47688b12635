/* a + s b */
static void lw_plus_into(const double a[6], double s, const double b[6], double c[6]) {
    for (int k = 0; k < 6; ++k) {
        c[k] = a[k] + s * b[k];
    }
}

/* Factors of ad, ad^2, ad^3 and ad^4 in the left Jacobian of SE(3), the sum of ad^k / (k + 1)!, as functions of x^2: ad has the
 * minimal polynomial ad (ad^2 + x^2)^2 (Selig, Geometric Fundamentals of Robotics, 4.6). */
static void lw_jacobian_factors(double square, double c[4]) {
    if (square < 1.0) {
        double power = 1.0, odd = 0.5, even = 1.0 / 6.0;
        c[0] = 0.5;
        c[1] = 1.0 / 6.0;
        c[2] = 0.0;
        c[3] = 0.0;
        for (int n = 1; n <= 9; ++n) {
            const double next = -power * square;
            odd /= (2.0 * n + 1.0) * (2.0 * n + 2.0);
            even /= (2.0 * n + 2.0) * (2.0 * n + 3.0);
            c[0] -= (n - 1) * odd * next;
            c[1] -= (n - 1) * even * next;
            c[2] += n * odd * power;
            c[3] += n * even * power;
            power = next;
        }
    } else {
        const double angle = sqrt(square), fourth = square * square;
        const double sine = lw_sine(angle), cosine = lw_cosine(angle);
        c[0] = (4.0 - angle * sine - 4.0 * cosine) / (2.0 * square);
        c[1] = (4.0 * angle - 5.0 * sine + angle * cosine) / (2.0 * square * angle);
        c[2] = (2.0 - angle * sine - 2.0 * cosine) / (2.0 * fourth);
        c[3] = (2.0 * angle - 3.0 * sine + angle * cosine) / (2.0 * fourth * angle);
    }
}

/* Copies the lower halves of the last three columns to the upper halves of the first three: motions of SE(3) are rotations with dual
 * numbers (Selig, Geometric Fundamentals of Robotics, 7.5). */
static void lw_copy_dual(double columns[36]) {
    for (int j = 0; j < 3; ++j) {
        for (int k = 0; k < 3; ++k) {
            columns[6 * j + k] = columns[6 * (3 + j) + 3 + k];
            columns[6 * j + 3 + k] = 0.0;
        }
    }
}

/* Derivatives of q + dv of a free joint in body axes with respect to q and dv: the adjoint of exp(-dv) and the right Jacobian of
 * SE(3), by columns, with linear components first. */
static void lw_free_integrate_derivatives(const double dv[6], double by_q[36], double by_dv[36]) {
    static const double identity[7] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
    const double turn[3] = {-dv[3], -dv[4], -dv[5]};
    double end[7], back[4], c[4];
    lw_free_integrate(identity, dv, end);
    lw_exponential(turn, back);
    lw_jacobian_factors(lw_dot_of(dv + 3, dv + 3), c);
    for (int j = 3; j < 6; ++j) {
        double e[6] = {0.0}, moved[3], once[6], twice[6], thrice[6], four_times[6];
        e[j] = 1.0;
        lw_cross_into(e + 3, end, moved);
        lw_rotate(back, moved, by_q + 6 * j);
        lw_rotate(back, e + 3, by_q + 6 * j + 3);
        lw_bracket(dv, e, once);
        lw_bracket(dv, once, twice);
        lw_bracket(dv, twice, thrice);
        lw_bracket(dv, thrice, four_times);
        for (int k = 0; k < 6; ++k) {
            by_dv[6 * j + k] = e[k] - c[0] * once[k] + c[1] * twice[k] - c[2] * thrice[k] + c[3] * four_times[k];
        }
    }
    lw_copy_dual(by_q);
    lw_copy_dual(by_dv);
}

/* Derivatives of the factors of ad^2 and ad^4 in the inverse Jacobian of SE(3) with respect to x^2. */
static void lw_even_slopes(double square, double slopes[2]) {
    if (square < 0.25) {
        slopes[0] = lw_series(square, 2, 2, 1, 1);
        slopes[1] = lw_series(square, 3, 1, 1, 2);
        return;
    }
    const double half = 0.5 * sqrt(square);
    const double sine = lw_sine(half);
    const double along = half * lw_cosine(half) / sine;
    const double over = half * half / (sine * sine);
    const double value = 1.0 - along, slope = 0.5 * (along - over);
    const double slope_by = 0.25 * (along - 3.0 * over + 2.0 * over * along);
    slopes[0] = (slope_by - 2.0 * slope - (2.0 * value + slope)) / (square * square);
    slopes[1] = (slope_by - slope - 2.0 * (value + slope)) / (square * square * square);
}

/* Derivatives of the rate of dv of a free joint with respect to dv and v. */
static void lw_free_tangent_rate_derivatives(const double dv[6], const double v[6], double by_dv[36], double by_v[36]) {
    const double square = lw_dot_of(dv + 3, dv + 3);
    double factors[2], slopes[2], b1[6], b2[6], b3[6], b4[6];
    lw_even_brackets(square, factors);
    lw_even_slopes(square, slopes);
    lw_bracket(dv, v, b1);
    lw_bracket(dv, b1, b2);
    lw_bracket(dv, b2, b3);
    lw_bracket(dv, b3, b4);
    for (int j = 3; j < 6; ++j) {
        double e[6] = {0.0}, c1[6], c2[6], c3[6], c4[6], inner[6];
        e[j] = 1.0;
        const double along = 2.0 * dv[j];
        lw_bracket(e, v, c1);
        lw_bracket(e, b1, c2);
        lw_bracket(dv, c1, inner);
        lw_plus_into(c2, 1.0, inner, c2);
        lw_bracket(e, b2, c3);
        lw_bracket(dv, c2, inner);
        lw_plus_into(c3, 1.0, inner, c3);
        lw_bracket(e, b3, c4);
        lw_bracket(dv, c3, inner);
        lw_plus_into(c4, 1.0, inner, c4);
        for (int k = 0; k < 6; ++k) {
            by_dv[6 * j + k] = 0.5 * c1[k] + factors[0] * c2[k] + factors[1] * c4[k] + slopes[0] * along * b2[k]
                + slopes[1] * along * b4[k];
        }
        lw_free_tangent_rate(dv, e, by_v + 6 * j);
    }
    lw_copy_dual(by_dv);
    lw_copy_dual(by_v);
}
