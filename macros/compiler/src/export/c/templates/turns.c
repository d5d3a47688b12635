/* Quaternions (x, y, z, w) and rotation vectors. */
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
        turned[k] += a[3] * b[k] + b[3] * a[k];
    }
    c[3] = a[3] * b[3] - lw_dot_of(a, b);
    for (int k = 0; k < 3; ++k) {
        c[k] = turned[k];
    }
}

static void lw_ball_integrate(const double q[4], const double dv[3], double result[4]) {
    const double square = lw_dot_of(dv, dv);
    double turn[4], product[4];
    double factor = 0.5 - square / 48.0;
    turn[3] = 1.0 - square / 8.0;
    if (square >= DBL_EPSILON) {
        const double angle = sqrt(square);
        factor = sin(0.5 * angle) / angle;
        turn[3] = cos(0.5 * angle);
    }
    for (int k = 0; k < 3; ++k) {
        turn[k] = factor * dv[k];
    }
    lw_multiply_turns(q, turn, product);
    lw_normalise(product, result);
}

static void lw_ball_difference(const double from[4], const double to[4], double result[3]) {
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
    double factor = 2.0 / w - 2.0 / 3.0 * square / (w * w * w);
    if (square >= DBL_EPSILON * w * w) {
        const double sine = sqrt(square);
        factor = 2.0 * atan2(sine, w) / sine;
    }
    for (int k = 0; k < 3; ++k) {
        result[k] = sign * factor * between[k];
    }
}

/* (1 - (x/2) cot(x/2)) / x^2 as a function of x^2; for small x by its series with Bernoulli numbers. */
static double lw_second_bracket(double square) {
    static const double series[8] = {1.0 / 12.0, 1.0 / 720.0, 1.0 / 30240.0, 1.0 / 1209600.0, 1.0 / 47900160.0,
        691.0 / 1307674368000.0, 1.0 / 74724249600.0, 3617.0 / 10670622842880000.0};
    if (square < 0.25) {
        double sum = 0.0;
        for (int k = 7; k >= 0; --k) {
            sum = sum * square + series[k];
        }
        return sum;
    }
    const double half = 0.5 * sqrt(square);
    return (1.0 - half / tan(half)) / square;
}
