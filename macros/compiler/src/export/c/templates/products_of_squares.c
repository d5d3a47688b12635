/* Product of two square matrices. */
static void lw_product_of(const double *a, const double *b, double *result) {
    for (int k = 0; k < @NV@ * @NV@; ++k) {
        result[k] = 0.0;
    }
    lw_add_products(@NV@, a, b, result);
}

