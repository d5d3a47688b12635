/* Returns sine and cosine of the mathematical library. */
static inline void lw_sin_cos(double x, double *s, double *c) {
    *s = sin(x);
    *c = cos(x);
}
