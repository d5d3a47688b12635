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

