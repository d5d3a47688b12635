/* Negative derivative of (1 - (x/2) cot(x/2)) / x^2 with respect to x^2. It is also the factor of the fourth bracket of SE(3). */
static double lw_fourth_bracket(double square) {
    static const double series[8] = {1.0 / 12.0, 1.0 / 720.0, 1.0 / 30240.0, 1.0 / 1209600.0, 1.0 / 47900160.0,
        691.0 / 1307674368000.0, 1.0 / 74724249600.0, 3617.0 / 10670622842880000.0};
    if (square < 0.25) {
        double sum = 0.0;
        for (int k = 7; k >= 1; --k) {
            sum = sum * square - k * series[k];
        }
        return sum;
    }
    const double half = 0.5 * sqrt(square);
    const double along = half * cos(half) / sin(half);
    const double over = half * half / (sin(half) * sin(half));
    return (1.0 - along + 0.5 * (along - over)) / (square * square);
}
