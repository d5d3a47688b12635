/* Returns one with the sign of a number, also for zeros. */
static inline double lw_signum(double x) {
    return x != x ? x : copysign(1.0, x);
}
