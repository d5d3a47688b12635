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
