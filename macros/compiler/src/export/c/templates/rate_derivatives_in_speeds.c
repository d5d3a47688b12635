    enum { N = @NV@ * @NV@ };
    double way[@NV@], there[@NQ@], rates[@NV@], rate[@NV@], found[@NV@], z[N], y[N], z_there[N], of_way[N], of_rates[N];
    double moved_by_q[N], moved_by_dv[N], changes[N], of_found[N], changes_there[N], turned[N], sum[N], more[N];
    @PREFIX@_rates_of_speeds(@OWN@q, dv, way);
    @PREFIX@_joints_integrate(@OWN@q, way, there);
    @PREFIX@_rates_of_speeds(@OWN@there, v, rates);
    @PREFIX@_joints_tangent_rate(@OWN@way, rates, rate);
    @PREFIX@_speeds_of_rates(@OWN@q, rate, found);
    @PREFIX@_rate_matrix(@OWN@q, z);
    @PREFIX@_speed_matrix(@OWN@q, y);
    @PREFIX@_rate_matrix(@OWN@there, z_there);
    @PREFIX@_rate_changes(@OWN@q, dv, changes);
    @PREFIX@_rate_changes(@OWN@q, found, of_found);
    @PREFIX@_rate_changes(@OWN@there, v, changes_there);
    @PREFIX@_integrate_derivatives(@OWN@q, dv, moved_by_q, moved_by_dv);
    @PREFIX@_joints_tangent_rate_derivatives(@OWN@way, rates, of_way, of_rates);
    lw_product_of(of_rates, changes_there, turned);
    lw_product_of(of_way, changes, sum);
    lw_product_of(turned, moved_by_q, more);
    for (int k = 0; k < N; ++k) {
        sum[k] = sum[k] + more[k] - of_found[k];
    }
    lw_product_of(y, sum, by_q);
    lw_product_of(of_way, z, sum);
    lw_product_of(turned, moved_by_dv, more);
    for (int k = 0; k < N; ++k) {
        sum[k] += more[k];
    }
    lw_product_of(y, sum, by_dv);
    lw_product_of(y, of_rates, sum);
    lw_product_of(sum, z_there, by_v);
