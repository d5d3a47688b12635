    const lw_products<double, @NV@> of_tau = {weights, sums_tau};
    @PREFIX@_mass_matrix_inverse(@OWN@@T@q, of_tau);
