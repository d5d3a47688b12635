/* Sizes and checks of states. */

#define LW_AT_LEAST_ONE(n) ((n) > 0 ? (n) : 1)
#define LW_STATES (LW_NQ + LW_NV + LW_NX)

static inline bool lw_all_finite(int n, const double *values) {
    for (int k = 0; k < n; ++k) {
        if (!isfinite(values[k])) {
            return false;
        }
    }
    return true;
}

/* Normalises the quaternions of a configuration. Returns false if one is zero. */
static inline bool lw_normalise_all(double *q) {
    for (int k = 0; k < LW_BALLS; ++k) {
        double *quaternion = q + lw_balls[k][0], square = 0.0;
        for (int i = 0; i < 4; ++i) {
            square += quaternion[i] * quaternion[i];
        }
        if (!(square > 1e-18)) {
            return false;
        }
        const double factor = 1.0 / sqrt(square);
        for (int i = 0; i < 4; ++i) {
            quaternion[i] *= factor;
        }
    }
    return true;
}
