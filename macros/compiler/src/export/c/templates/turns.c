/* Quaternions (x, y, z, w) and rotation vectors. The operations are those of the functions in Rust. */
#ifndef lw_sine
#define lw_sine(x) sin(x)
#define lw_cosine(x) cos(x)
#endif

static void lw_cross_into(const double a[3], const double b[3], double c[3]) {
    const double x = a[1] * b[2] - a[2] * b[1];
    const double y = a[2] * b[0] - a[0] * b[2];
    const double z = a[0] * b[1] - a[1] * b[0];
    c[0] = x;
    c[1] = y;
    c[2] = z;
}

static double lw_dot_of(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void lw_normalise(const double q[4], double n[4]) {
    const double norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; ++k) {
        n[k] = q[k] / norm;
    }
}

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

/* 1 / d[0] - x / d[1] + x^2 / d[2] - ... */
static double lw_alternating(double x, int count, const double *divisors) {
    double sum = 0.0;
    for (int k = count - 1; k >= 0; --k) {
        sum = 1.0 / divisors[k] - x * sum;
    }
    return sum;
}

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

static void lw_ball_integrate(const double q[4], const double dv[3], double result[4]) {
    double turn[4], product[4];
    lw_exponential(dv, turn);
    lw_multiply_turns(q, turn, product);
    lw_normalise(product, result);
}

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

/* (1 - (x/2) cot(x/2)) / x^2 as a function of x^2; for small x by its series. */
static double lw_second_bracket(double square) {
    if (square < 0.25) {
        return lw_series(square, 1, 1, 0, 0);
    }
    const double half = 0.5 * sqrt(square);
    return (1.0 - half / tan(half)) / square;
}
