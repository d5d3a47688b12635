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
