    double way[@NV@], rates[@NV@], rate[@NV@], there[@NQ@];
    @PREFIX@_rates_of_speeds(@OWN@q, dv, way);
    @PREFIX@_joints_integrate(@OWN@q, way, there);
    @PREFIX@_rates_of_speeds(@OWN@there, v, rates);
    @PREFIX@_joints_tangent_rate(@OWN@way, rates, rate);
    @PREFIX@_speeds_of_rates(@OWN@q, rate, result);
