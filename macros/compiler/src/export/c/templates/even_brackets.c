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
