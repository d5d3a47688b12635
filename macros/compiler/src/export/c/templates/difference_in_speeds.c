    double way[@NV@];
    @PREFIX@_joints_difference(@OWN@from, to, way);
    @PREFIX@_speeds_of_rates(@OWN@from, way, result);
