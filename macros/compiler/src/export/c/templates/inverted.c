/* Replaces a symmetric positive definite matrix by its inverse: Gauss-Jordan elimination without row exchanges (Golub and
 * Van Loan 2013, ch. 3.2). */
static void lw_invert_inner(int n, double *m) {
    for (int k = 0; k < n; ++k) {
        const double by = 1.0 / m[k * n + k];
        m[k * n + k] = 1.0;
        for (int i = 0; i < n; ++i) {
            m[i * n + k] *= by;
        }
        for (int i = 0; i < n; ++i) {
            const double factor = m[k * n + i];
            if (i == k) {
                continue;
            }
            m[k * n + i] = 0.0;
            for (int j = 0; j < n; ++j) {
                m[j * n + i] -= factor * m[j * n + k];
            }
        }
    }
}

/* Inverts a mass matrix [A B; B' C]. Initially, the columns of the limbs contain the inverse of C, with one block per limb, and
 * borders contains the rows of the trunk, column by column. Velocities of the trunk have the limb index -1. */
static void lw_invert(int rows, int width, double *matrix, const int *trunk, const int *limb, const double *borders) {
    double g[@NV@ * @NV@], inner[@NV@ * @NV@];
    for (int c = 0; c < width; ++c) {
        for (int t = 0; t < width; ++t) {
            inner[c * width + t] = borders[trunk[c] * width + t];
        }
    }
    for (int k = 0; k < rows; ++k) {
        for (int t = 0; t < width; ++t) {
            g[k * width + t] = 0.0;
        }
        if (limb[k] < 0) {
            continue;
        }
        for (int j = 0; j < rows; ++j) {
            if (limb[j] == limb[k]) {
                const double by = matrix[k * rows + j];
                for (int t = 0; t < width; ++t) {
                    g[k * width + t] -= by * borders[j * width + t];
                }
            }
        }
        for (int c = 0; c < width; ++c) {
            for (int t = 0; t < width; ++t) {
                inner[c * width + t] += g[k * width + c] * borders[k * width + t];
            }
        }
    }
    lw_invert_inner(width, inner);
    for (int c = 0; c < width; ++c) {
        double *column = matrix + trunk[c] * rows;
        for (int i = 0; i < rows; ++i) {
            double sum = 0.0;
            for (int t = 0; t < width; ++t) {
                sum += g[i * width + t] * inner[c * width + t];
            }
            column[i] = sum;
        }
        for (int t = 0; t < width; ++t) {
            column[trunk[t]] = inner[c * width + t];
        }
    }
    lw_complete(rows, width, matrix, trunk, g);
}
