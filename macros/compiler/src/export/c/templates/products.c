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
