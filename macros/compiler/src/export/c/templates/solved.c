/* Solves for accelerations with the inverse and, without limbs, one step of iterative refinement: the inverse of an ill-conditioned
 * matrix is accurate enough for the residual, but not for the solution. Without limbs, every velocity belongs to the trunk. */
static void lw_solve(int rows, int width, const double *inverse, const int *trunk, const int *limb, const double *borders, double *column) {
    double x[@NV@], rest[@NV@];
    int limbs = 0;
    for (int i = 0; i < rows; ++i) {
        rest[i] = column[i];
        column[i] = 0.0;
        limbs += limb[i] >= 0;
    }
    for (int pass = 0; pass < (limbs > 0 ? 1 : 2); ++pass) {
        for (int i = 0; i < rows; ++i) {
            x[i] = 0.0;
        }
        for (int k = 0; k < rows; ++k) {
            for (int i = 0; i < rows; ++i) {
                x[i] += rest[k] * inverse[k * rows + i];
            }
        }
        for (int i = 0; i < rows; ++i) {
            column[i] += x[i];
        }
        for (int k = 0; k < rows; ++k) {
            for (int t = 0; t < width; ++t) {
                rest[trunk[t]] -= x[k] * borders[k * width + t];
            }
        }
    }
}
