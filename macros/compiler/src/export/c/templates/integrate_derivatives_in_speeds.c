    enum { N = @NV@ * @NV@ };
    double way[@NV@], there[@NQ@], z[N], y[N], of_q[N], of_way[N], changes[N], sum[N], more[N];
    @PREFIX@_rates_of_speeds(@OWN@q, dv, way);
    @PREFIX@_joints_integrate(@OWN@q, way, there);
    @PREFIX@_rate_matrix(@OWN@q, z);
    @PREFIX@_speed_matrix(@OWN@there, y);
    @PREFIX@_rate_changes(@OWN@q, dv, changes);
    @PREFIX@_joints_integrate_derivatives(@OWN@way, of_q, of_way);
    lw_product_of(of_q, z, sum);
    lw_product_of(of_way, changes, more);
    for (int k = 0; k < N; ++k) {
        sum[k] += more[k];
    }
    lw_product_of(y, sum, by_q);
    lw_product_of(y, of_way, sum);
    lw_product_of(sum, z, by_dv);
