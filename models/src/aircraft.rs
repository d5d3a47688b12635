use linkwork::mechanism;

/// Aircraft as a rigid body with linear aerodynamics in pitch: lift, drag, pitching moment, elevator and
/// thrust.
///
/// Source: Bernstein, Goel and Ansari, *Geometry, Kinematics, Statics, and Dynamics*, on aircraft; Etkin and
/// Reid, *Dynamics of Flight* (1996), ch. 2 and 4.
///
/// - Axes: forward, right, down, also those of the ground. Configuration: position and unit quaternion of
///   `flight`; velocity: linear and angular in the aircraft's axes, (u, v, w) and (p, q, r). Inputs:
///   `elevator`, rad; `thrust`, N, forward.
/// - Angle of attack `α = atan2(w, u)`, dynamic pressure `Q = ½ ρ V²`. In the plane of symmetry: lift
///   `Q S (C_L0 + C_Lα α)`, drag `Q S (C_D0 + K C_L²)`, pitching moment
///   `Q S c (C_m0 + C_mα α + C_mq q c / (2 V) + C_mδ δ)`.
/// - Level flight: `L + T sin α = m g`, `T cos α = D`, zero moment. Level turn with the bank `φ` without
///   drag: `L = m g / cos φ`, and the path turns at the rate `g tan φ / V`.
#[mechanism(gravity = g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aircraft {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the aircraft, kg.
    pub mass: f64,
    /// Moment of inertia of the aircraft about its forward axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia of the aircraft about its right axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia of the aircraft about its downward axis, kg·m².
    pub izz: f64,
    /// Entry of the inertia matrix in row x and column z, kg·m²: minus the product of inertia of the
    /// handbooks.
    pub ixz: f64,
    /// Density of the air, kg/m³.
    pub density: f64,
    /// Wing area, m².
    pub area: f64,
    /// Mean chord of the wing, m.
    pub chord: f64,
    /// Lift coefficient at zero angle of attack.
    pub cl_0: f64,
    /// Slope of the lift coefficient with the angle of attack, 1/rad.
    pub cl_alpha: f64,
    /// Drag coefficient at zero lift.
    pub cd_0: f64,
    /// Induced drag: factor of the squared lift coefficient.
    pub cd_induced: f64,
    /// Coefficient of the pitching moment at zero angle of attack.
    pub cm_0: f64,
    /// Slope of the pitching moment's coefficient with the angle of attack, 1/rad, negative if stable.
    pub cm_alpha: f64,
    /// Slope of the pitching moment's coefficient with the pitch rate, made dimensionless by half the chord
    /// over the speed.
    pub cm_rate: f64,
    /// Slope of the pitching moment's coefficient with the elevator's angle, 1/rad.
    pub cm_elevator: f64,

    elevator: Input,
    #[body(mass = mass, inertia = [[ixx, 0, ixz], [0, iyy, 0], [ixz, 0, izz]])]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,

    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[define(norm(velocity))]
    speed: Scalar,
    #[define(atan2(dot(velocity, airframe.z), dot(velocity, airframe.x)))]
    attack: Scalar,
    #[define(density / 2 * dot(velocity, velocity) * area)]
    load: Scalar,
    #[define(cl_0 + cl_alpha * attack)]
    lift_coefficient: Scalar,
    #[define(dot(omega(airframe / ground), airframe.y))]
    pitch_rate: Scalar,

    #[acts(
        on = airframe, value = load * lift_coefficient * (sin(attack) * airframe.x - cos(attack) * airframe.z)
    )]
    lift: Force,
    #[acts(
        on = airframe,
        value = -load * (cd_0 + cd_induced * pow(lift_coefficient, 2))
            * (cos(attack) * airframe.x + sin(attack) * airframe.z)
    )]
    drag: Force,
    #[acts(
        on = airframe,
        value = load * chord * (cm_0 + cm_alpha * attack + cm_rate * pitch_rate * chord / (2 * speed)
            + cm_elevator * elevator) * airframe.y
    )]
    pitching_moment: Torque,
    #[acts(on = airframe, along = airframe.x)]
    thrust: Force,

    #[output(attack)]
    angle_of_attack: Scalar,
    #[output(speed)]
    airspeed: Scalar,
}
