/* The sign of a number: one with it, also of zeros. */
static inline double lw_signum(double x) {
    return x != x ? x : copysign(1.0, x);
}
