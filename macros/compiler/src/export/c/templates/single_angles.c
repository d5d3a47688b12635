//// lw_sin_cos
/* Returns sine and cosine of the mathematical library. */
static inline void lw_sin_cos(double x, double *s, double *c) {
    *s = sin(x);
    *c = cos(x);
}
//// lw_sin_cos_4
static inline void lw_sin_cos_4(const double x[4], double s[4], double c[4]) {
    for (int k = 0; k < 4; ++k) {
        lw_sin_cos(x[k], &s[k], &c[k]);
    }
}
