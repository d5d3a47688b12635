    double way[@NV@];
    @PREFIX@_rates_of_speeds(@OWN@q, dv, way);
    @PREFIX@_joints_integrate(@OWN@q, way, result);
