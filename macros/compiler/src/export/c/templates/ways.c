@MOVED_BLOCK@/* How the configuration moves that a displacement leads to. */
static void lw_moved(const double *displacement, double *motion) {
    for (int k = 0; k < LW_CHANGING; ++k) {
        motion[k] = displacement[k];
    }
@MOVED_PLAIN@@MOVED@}

/* The rate of a displacement with which the configuration moves with the velocity v. */
static void lw_rate_of(const double *displacement, const double *v, double *rate) {
    for (int k = 0; k < LW_CHANGING; ++k) {
        rate[k] = v[k];
    }
    (void)(displacement);
@RATE@}

