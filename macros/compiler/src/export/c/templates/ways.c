@MOVED_BLOCK@/* Motion of the configuration after a displacement, with its derivatives. */
static void lw_moved(const double *displacement, double *motion) {
    for (int k = 0; k < LW_CHANGING; ++k) {
        motion[k] = displacement[k];
    }
@MOVED_PLAIN@@MOVED@}

/* Rate of a displacement for which the configuration moves with the velocity v, with its derivatives. */
static void lw_rate_of(const double *displacement, const double *v, double *rate) {
    for (int k = 0; k < LW_CHANGING; ++k) {
        rate[k] = v[k];
    }
    (void)(displacement);
@RATE@}

