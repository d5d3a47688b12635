//// lw_minus_products
/* Replaces a factor by the product of the negative inverse and the factor. Both are stored by columns. */
static void lw_minus_products(int rows, int columns, const double *inverse, double *factor) {
    for (int j = 0; j < columns; ++j) {
        double *column = factor + j * rows;
        double sum[@NV@] = {0.0};
        for (int k = 0; k < rows; ++k) {
            const double by = column[k];
            if (by != 0.0) {
                for (int i = 0; i < rows; ++i) {
                    sum[i] -= by * inverse[k * rows + i];
                }
            }
        }
        for (int i = 0; i < rows; ++i) {
            column[i] = sum[i];
        }
    }
}
//// lw_add_products
/* Adds the product of a square matrix and the given number of columns. */
static void lw_add_products(int columns, const double *by, const double *part, double *sum) {
    for (int j = 0; j < columns; ++j) {
        double column[@NV@];
        for (int i = 0; i < @NV@; ++i) {
            column[i] = sum[j * @NV@ + i];
        }
        for (int k = 0; k < @NV@; ++k) {
            const double factor = part[j * @NV@ + k];
            if (factor != 0.0) {
                for (int i = 0; i < @NV@; ++i) {
                    column[i] += by[k * @NV@ + i] * factor;
                }
            }
        }
        for (int i = 0; i < @NV@; ++i) {
            sum[j * @NV@ + i] = column[i];
        }
    }
}
//// lw_product_of
/* Product of two square matrices. */
static void lw_product_of(const double *a, const double *b, double *result) {
    for (int k = 0; k < @NV@ * @NV@; ++k) {
        result[k] = 0.0;
    }
    lw_add_products(@NV@, a, b, result);
}
//// lw_complete
/* Adds a linear combination of the trunk's columns to every column of a matrix; factors has one row of coefficients per column. */
static void lw_complete(int rows, int width, double *matrix, const int *trunk, const double *factors) {
    for (int j = 0; j < rows; ++j) {
        for (int t = 0; t < width; ++t) {
            const double by = factors[j * width + t];
            if (by != 0.0) {
                for (int i = 0; i < rows; ++i) {
                    matrix[j * rows + i] += by * matrix[trunk[t] * rows + i];
                }
            }
        }
    }
}
//// lw_invert_inner
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
//// lw_invert
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
//// lw_solve
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
//// lw_moved_block
/* Multiplies the derivatives in the rows of one joint by a square block; values do not change. */
static void lw_moved_block(int rows, int first, const double *by, const double *part, double *result) {
    for (int j = 1; j <= @COLUMNS@; ++j) {
        for (int i = 0; i < rows; ++i) {
            double sum = 0.0;
            for (int k = 0; k < rows; ++k) {
                sum += by[k * rows + i] * part[j * @NV@ + first + k];
            }
            result[j * @NV@ + first + i] = sum;
        }
    }
}
//// lw_assemble
/* Assembles the matrices of a linear system in (q, v): of each, entries that are already stored do not change. */
static void lw_assemble(int n, int m, const double *by_q, const double *by_v, const double *inverse, double *by_state, double *by_input) {
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            by_state[j * 2 * n + n + i] = by_q[j * n + i];
            by_state[(n + j) * 2 * n + i] = i == j ? 1.0 : 0.0;
            by_state[(n + j) * 2 * n + n + i] = by_v[j * n + i];
        }
    }
    double of_inputs[@NV@ * @NU@];
    for (int j = 0; j < m; ++j) {
        for (int i = 0; i < n; ++i) {
            of_inputs[j * n + i] = by_input[j * 2 * n + n + i];
        }
    }
    lw_minus_products(n, m, inverse, of_inputs);
    for (int j = 0; j < m; ++j) {
        for (int i = 0; i < n; ++i) {
            by_input[j * 2 * n + i] = 0.0;
            by_input[j * 2 * n + n + i] = -of_inputs[j * n + i];
        }
    }
}
//// lw_put_block
/* Puts a square block on the diagonal of a matrix, from the given row. */
static void lw_put_block(int rows, int first, const double *block, double *matrix) {
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < rows; ++i) {
            matrix[(first + j) * @NV@ + first + i] = block[j * rows + i];
        }
    }
}
