    double inverse[@NV@ * @NV@];
    @PREFIX@_mass_matrix_inverse(@OWN@@T@q, inverse);
    for (int j = 0; j < @NV@; ++j) {
        for (int k = 0; k < @NV@; ++k) {
            sums_tau[j] += weights[k] * inverse[j * @NV@ + k];
        }
    }
