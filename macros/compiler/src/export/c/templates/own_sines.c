/* Sine and cosine as in the functions of the mechanism. */
static double lw_sine(double x) {
    double sine, cosine;
    lw_sin_cos(x, &sine, &cosine);
    return sine;
}

static double lw_cosine(double x) {
    double sine, cosine;
    lw_sin_cos(x, &sine, &cosine);
    return cosine;
}
#define lw_sine lw_sine
