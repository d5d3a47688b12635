//// lw_sine
#if OWN_SINES
/* Sine as in the functions of the mechanism. */
static double lw_sine(double x) {
    double sine, cosine;
    lw_sin_cos(x, &sine, &cosine);
    return sine;
}
#else
#ifndef lw_sine
#define lw_sine(x) sin(x)
#endif
#endif
//// lw_cosine
#if OWN_SINES
/* Cosine as in the functions of the mechanism. */
static double lw_cosine(double x) {
    double sine, cosine;
    lw_sin_cos(x, &sine, &cosine);
    return cosine;
}
#else
#ifndef lw_cosine
#define lw_cosine(x) cos(x)
#endif
#endif
//// lw_cross_into
/* Quaternions (x, y, z, w) and rotation vectors. The operations are those of the functions in Rust. */
static void lw_cross_into(const double a[3], const double b[3], double c[3]) {
    const double x = a[1] * b[2] - a[2] * b[1];
    const double y = a[2] * b[0] - a[0] * b[2];
    const double z = a[0] * b[1] - a[1] * b[0];
    c[0] = x;
    c[1] = y;
    c[2] = z;
}
//// lw_dot_of
static double lw_dot_of(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
//// lw_normalise
static void lw_normalise(const double q[4], double n[4]) {
    const double norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; ++k) {
        n[k] = q[k] / norm;
    }
}
//// lw_multiply_turns
static void lw_multiply_turns(const double a[4], const double b[4], double c[4]) {
    double turned[3];
    lw_cross_into(a, b, turned);
    for (int k = 0; k < 3; ++k) {
        turned[k] = turned[k] + a[3] * b[k] + b[3] * a[k];
    }
    c[3] = a[3] * b[3] - lw_dot_of(a, b);
    for (int k = 0; k < 3; ++k) {
        c[k] = turned[k];
    }
}
//// lw_alternating
/* 1 / d[0] - x / d[1] + x^2 / d[2] - ... */
static double lw_alternating(double x, int count, const double *divisors) {
    double sum = 0.0;
    for (int k = count - 1; k >= 0; --k) {
        sum = 1.0 / divisors[k] - x * sum;
    }
    return sum;
}
//// lw_exponential
/* The unit quaternion of a rotation vector. */
static void lw_exponential(const double dv[3], double turn[4]) {
    static const double odd[6] = {1.0, 6.0, 120.0, 5040.0, 362880.0, 39916800.0};
    static const double even[6] = {1.0, 2.0, 24.0, 720.0, 40320.0, 3628800.0};
    const double square = lw_dot_of(dv, dv);
    double factor;
    if (square < 0.05) {
        factor = lw_alternating(0.25 * square, 6, odd) * 0.5;
        turn[3] = lw_alternating(0.25 * square, 6, even);
    } else {
        const double angle = sqrt(square);
        factor = lw_sine(0.5 * angle) / angle;
        turn[3] = lw_cosine(0.5 * angle);
    }
    for (int k = 0; k < 3; ++k) {
        turn[k] = factor * dv[k];
    }
}
//// lw_ball_integrate
static void lw_ball_integrate(const double q[4], const double dv[3], double result[4]) {
    double turn[4], product[4];
    lw_exponential(dv, turn);
    lw_multiply_turns(q, turn, product);
    lw_normalise(product, result);
}
//// lw_ball_difference
static void lw_ball_difference(const double from[4], const double to[4], double result[3]) {
    static const double divisors[7] = {1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0};
    double start[4], end[4], between[4];
    lw_normalise(from, start);
    lw_normalise(to, end);
    for (int k = 0; k < 3; ++k) {
        start[k] = -start[k];
    }
    lw_multiply_turns(start, end, between);
    const double sign = copysign(1.0, between[3]);
    const double w = sign * between[3];
    const double square = lw_dot_of(between, between);
    double factor;
    if (square < w * w * 0.0025) {
        const double inverse = 1.0 / w;
        factor = lw_alternating(square * inverse * inverse, 7, divisors) * inverse * 2.0;
    } else {
        const double sine = sqrt(square);
        factor = 2.0 * atan2(sine, w) / sine;
    }
    for (int k = 0; k < 3; ++k) {
        result[k] = sign * factor * between[k];
    }
}
//// lw_series
/* The sum of weight(k) c(k) x^(k - from) over k >= from, where c(k) = |B(2k)| / (2k)! has the Bernoulli numbers B, and weight(k) =
 * (first - slope k) (k - root), without the second factor if the root is zero. */
static double lw_series(double x, int from, int first, int slope, int root) {
    static const double series[8] = {1.0 / 12.0, 1.0 / 720.0, 1.0 / 30240.0, 1.0 / 1209600.0, 1.0 / 47900160.0,
        691.0 / 1307674368000.0, 1.0 / 74724249600.0, 3617.0 / 10670622842880000.0};
    double sum = 0.0, power = 1.0;
    for (int k = from; k <= 8; ++k) {
        const double weight = (first - slope * k) * (root == 0 ? 1 : k - root);
        sum = sum + power * (weight * series[k - 1]);
        power = power * x;
    }
    return sum;
}
//// lw_second_bracket
/* (1 - (x/2) cot(x/2)) / x^2 as a function of x^2; for small x by its series. */
static double lw_second_bracket(double square) {
    if (square < 0.25) {
        return lw_series(square, 1, 1, 0, 0);
    }
    const double half = 0.5 * sqrt(square);
    return (1.0 - half / tan(half)) / square;
}
//// lw_left_jacobian
/* (1 - cos x)/x^2 and (x - sin x)/x^3 as functions of x^2, the factors a and b of the left Jacobian 1 + a [x] + b [x]^2 of SO(3). */
static void lw_left_jacobian(double square, double factors[2]) {
    static const double even[6] = {2.0, 24.0, 720.0, 40320.0, 3628800.0, 479001600.0};
    static const double odd[6] = {6.0, 120.0, 5040.0, 362880.0, 39916800.0, 6227020800.0};
    if (square < 0.05) {
        factors[0] = lw_alternating(square, 6, even);
        factors[1] = lw_alternating(square, 6, odd);
    } else {
        const double angle = sqrt(square);
        const double half = lw_sine(0.5 * angle);
        factors[0] = 2.0 * half * half / square;
        factors[1] = (angle - lw_sine(angle)) / (angle * square);
    }
}
//// lw_even_brackets
/* Factors of the second and fourth bracket in the inverse Jacobian of SE(3), as functions of x^2. */
static void lw_even_brackets(double square, double factors[2]) {
    if (square < 0.25) {
        factors[0] = lw_series(square, 1, 2, 1, 0);
        factors[1] = lw_series(square, 2, 1, 1, 0);
        return;
    }
    const double half = 0.5 * sqrt(square);
    const double sine = lw_sine(half), cosine = lw_cosine(half);
    const double value = 1.0 - half * cosine / sine;
    const double slope = 0.5 * (half * cosine / sine - half * half / (sine * sine));
    factors[0] = (2.0 * value + slope) / square;
    factors[1] = (value + slope) / (square * square);
}
//// lw_ball_tangent_rate
static void lw_ball_tangent_rate(const double dv[3], const double v[3], double result[3]) {
    double first[3], second[3];
    lw_cross_into(dv, v, first);
    lw_cross_into(dv, first, second);
    const double factor = lw_second_bracket(lw_dot_of(dv, dv));
    for (int k = 0; k < 3; ++k) {
        result[k] = v[k] + 0.5 * first[k] + factor * second[k];
    }
}
//// lw_rotate
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
//// lw_free_integrate
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
//// lw_free_difference
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
//// lw_bracket
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
//// lw_free_tangent_rate
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
//// lw_ball_integrate_derivatives
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
//// lw_ball_tangent_rate_derivatives
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
//// lw_plus_into
/* a + s b */
static void lw_plus_into(const double a[6], double s, const double b[6], double c[6]) {
    for (int k = 0; k < 6; ++k) {
        c[k] = a[k] + s * b[k];
    }
}
//// lw_jacobian_factors
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
//// lw_copy_dual
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
//// lw_free_integrate_derivatives
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
//// lw_even_slopes
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
//// lw_free_tangent_rate_derivatives
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
