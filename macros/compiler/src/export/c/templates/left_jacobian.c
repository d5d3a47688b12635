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
