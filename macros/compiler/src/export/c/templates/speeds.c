@integrate@ {
    double way[@NV@];
    @PREFIX@_rates_of_speeds(@OWN@q, dv, way);
    @PREFIX@_joints_integrate(@OWN@q, way, result);
}

@difference@ {
    double way[@NV@];
    @PREFIX@_joints_difference(@OWN@from, to, way);
    @PREFIX@_speeds_of_rates(@OWN@from, way, result);
}

@displacement_rate@ {
    double way[@NV@], rates[@NV@], rate[@NV@], there[@NQ@];
    @PREFIX@_rates_of_speeds(@OWN@q, dv, way);
    @PREFIX@_joints_integrate(@OWN@q, way, there);
    @PREFIX@_rates_of_speeds(@OWN@there, v, rates);
    @PREFIX@_joints_tangent_rate(@OWN@way, rates, rate);
    @PREFIX@_speeds_of_rates(@OWN@q, rate, result);
}

#if DERIVATIVES
@integrate_derivatives@ {
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
}

@displacement_rate_derivatives@ {
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
}

#endif
