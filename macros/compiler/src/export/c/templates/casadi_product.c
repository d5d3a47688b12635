/* Product of two matrices. */
static void lw_product(int rows, int inner, int columns, const casadi_real *a, const casadi_real *b, casadi_real *c) {
    for (int j = 0; j < columns; ++j) {
        for (int i = 0; i < rows; ++i) {
            c[j * rows + i] = 0.0;
        }
        for (int k = 0; k < inner; ++k) {
            for (int i = 0; i < rows; ++i) {
                c[j * rows + i] += a[k * rows + i] * b[j * inner + k];
            }
        }
    }
}

