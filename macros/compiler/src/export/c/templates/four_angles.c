/* Four at a time, which compilers turn into vector instructions. */
static inline void sin_cos_4(const double x[4], double s[4], double c[4]) {
#ifdef ROUND
    double sines[4], cosines[4];
    double largest = 0.0;
    for (int k = 0; k < 4; ++k) {
        largest = fmax(largest, fabs(x[k]));
    }
    if (largest <= 1e5) {
        for (int k = 0; k < 4; ++k) {
            small_sin_cos(x[k], &sines[k], &cosines[k]);
        }
        for (int k = 0; k < 4; ++k) {
            s[k] = sines[k];
            c[k] = cosines[k];
        }
        return;
    }
#endif
    for (int k = 0; k < 4; ++k) {
        sin_cos(x[k], &s[k], &c[k]);
    }
}
