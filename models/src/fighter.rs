use linkwork::{Table, mechanism};

mod tables;

/// Fighter with tabulated aerodynamics and an engine with a lag: the F-16 at subsonic speeds.
///
/// Source: Stevens, Lewis and Johnson, *Aircraft Control and Simulation* (2015), § 3.5 and appendix A, after
/// Nguyen and others, NASA TP 1538 (1979).
///
/// - Axes: forward, right, down, also those of the ground, from the centre of mass. Inputs: `throttle`, from
///   0 to 1; `elevator`, `aileron`, `rudder`, in degrees, as are the tables' angles. State: `power`, of the
///   engine, in per cent.
/// - Coefficients are sums of tables over the angles of attack and sideslip and over deflections, and of
///   tables over the angle of attack times dimensionless rates. The centre of mass is `place` chords behind
///   the leading edge, the moments' reference `reference`.
/// - The power follows the throttle's command at a rate that depends on both, with an intermediate target of
///   60 per cent while the afterburner is switched on, and of 40 per cent while it is switched off: a
///   piecewise law, whose pieces `signum` selects.
/// - The rotor of the engine has an angular momentum, `spin`.
/// - The atmosphere is the source's: `ρ = ρ₀ (1 − h / h₀)^4.14`, `T = T₀ (1 − h / h₀)`, up to 35 000 ft.
#[mechanism(gravity = g * z, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fighter {
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
    /// Product of inertia of the handbooks, kg·m²: minus the entry of the inertia matrix in row x and column
    /// z.
    pub product: f64,
    /// Angular momentum of the engine's rotor, kg·m²/s, along the forward axis.
    pub spin: f64,
    /// Wing area, m².
    pub area: f64,
    /// Wing span, m.
    pub span: f64,
    /// Mean chord of the wing, m.
    pub chord: f64,
    /// Position of the centre of mass, in chords behind the leading edge.
    pub place: f64,
    /// Reference point of the moments, in chords behind the leading edge.
    pub reference: f64,
    /// Density of the air at sea level, kg/m³.
    pub sea_density: f64,
    /// Speed of sound at sea level, m/s.
    pub sea_sound: f64,
    /// Height at which the formula for the density of the air becomes zero, m.
    pub depth: f64,
    /// Unit of time in which the engine's time constants are given, s.
    pub second: f64,
    /// Table of the forward force's coefficient, over elevator angle and angle of attack.
    pub cx: Table<2>,
    /// Table of the downward force's coefficient, over the angle of attack.
    pub cz: Table<1>,
    /// Table of the rolling moment's coefficient, over sideslip and angle of attack.
    pub cl: Table<2>,
    /// Table of the pitching moment's coefficient, over elevator angle and angle of attack.
    pub cm: Table<2>,
    /// Table of the yawing moment's coefficient, over sideslip and angle of attack.
    pub cn: Table<2>,
    /// Table of the rolling moment due to 20° of aileron, over sideslip and angle of attack.
    pub cl_aileron: Table<2>,
    /// Table of the rolling moment due to 30° of rudder, over sideslip and angle of attack.
    pub cl_rudder: Table<2>,
    /// Table of the yawing moment due to 20° of aileron, over sideslip and angle of attack.
    pub cn_aileron: Table<2>,
    /// Table of the yawing moment due to 30° of rudder, over sideslip and angle of attack.
    pub cn_rudder: Table<2>,
    /// Derivative of the forward force with respect to the pitch rate.
    pub cx_q: Table<1>,
    /// Derivative of the side force with respect to the yaw rate.
    pub cy_r: Table<1>,
    /// Derivative of the side force with respect to the roll rate.
    pub cy_p: Table<1>,
    /// Derivative of the downward force with respect to the pitch rate.
    pub cz_q: Table<1>,
    /// Derivative of the rolling moment with respect to the yaw rate.
    pub cl_r: Table<1>,
    /// Derivative of the rolling moment with respect to the roll rate.
    pub cl_p: Table<1>,
    /// Derivative of the pitching moment with respect to the pitch rate.
    pub cm_q: Table<1>,
    /// Derivative of the yawing moment with respect to the yaw rate.
    pub cn_r: Table<1>,
    /// Derivative of the yawing moment with respect to the roll rate.
    pub cn_p: Table<1>,
    /// Thrust, N, over Mach number, height (m) and power.
    pub thrust: Table<3>,

    throttle: Input,
    elevator: Input,
    aileron: Input,
    rudder: Input,

    #[define(max(64.94 * throttle, 217.38 * throttle - 117.38))]
    command: Scalar,
    #[define((1 + signum(command - 50)) / 2)]
    commands_burner: Scalar,
    #[define((1 + signum(power - 50)) / 2)]
    burns: Scalar,
    #[define(
        commands_burner * (burns * command + (1 - burns) * 60) + (1 - commands_burner) * (burns * 40 + (1 - burns) * command)
    )]
    target: Scalar,
    #[define(burns * 5 + (1 - burns) * min(max(1.9 - 0.036 * (target - power), 0.1), 1))]
    quickness: Scalar,
    /// Power of the engine, per cent.
    #[state(rate = quickness * (target - power) / second)]
    pub power: State,

    #[body(mass = mass, inertia = [[ixx, 0, -product], [0, iyy, 0], [-product, 0, izz]])]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,

    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[define(norm(velocity))]
    speed: Scalar,
    #[define(-dot(r(airframe / ground), ground.z))]
    height: Scalar,
    #[define(1 - height / depth)]
    warmth: Scalar,
    #[define(sea_density / 2 * pow(warmth, 4.14) * speed * speed * area)]
    load: Scalar,
    #[define(speed / (sea_sound * sqrt(warmth)))]
    mach: Scalar,
    #[define(57.29578 * angle_of_attack(airframe, velocity))]
    alpha: Scalar,
    #[define(57.29578 * sideslip(airframe, velocity))]
    beta: Scalar,
    #[define(omega(airframe / ground))]
    turning: Vector,
    #[define(span / (2 * speed) * dot(turning, airframe.x))]
    rolling: Scalar,
    #[define(chord / (2 * speed) * dot(turning, airframe.y))]
    pitching: Scalar,
    #[define(span / (2 * speed) * dot(turning, airframe.z))]
    yawing: Scalar,
    #[define(aileron / 20)]
    ailerons: Scalar,
    #[define(rudder / 30)]
    rudders: Scalar,

    #[define(cx(elevator, alpha) + cx_q(alpha) * pitching)]
    forward: Scalar,
    #[define(
        -0.02 * beta + 0.021 * ailerons + 0.086 * rudders + cy_r(alpha) * yawing + cy_p(alpha) * rolling
    )]
    sideways: Scalar,
    #[define(cz(alpha) * (1 - pow(beta / 57.3, 2)) - 0.19 * elevator / 25 + cz_q(alpha) * pitching)]
    downward: Scalar,
    #[define(
        cl(beta, alpha) + cl_aileron(beta, alpha) * ailerons + cl_rudder(beta, alpha) * rudders + cl_r(alpha) * yawing
            + cl_p(alpha) * rolling
    )]
    roll_moment: Scalar,
    #[define(cm(elevator, alpha) + cm_q(alpha) * pitching + downward * (reference - place))]
    pitch_moment: Scalar,
    #[define(
        cn(beta, alpha) + cn_aileron(beta, alpha) * ailerons + cn_rudder(beta, alpha) * rudders + cn_r(alpha) * yawing
            + cn_p(alpha) * rolling - sideways * (reference - place) * chord / span
    )]
    yaw_moment: Scalar,

    #[acts(
        on = airframe,
        value = load * (forward * airframe.x + sideways * airframe.y + downward * airframe.z)
    )]
    aerodynamic_force: Force,
    #[acts(
        on = airframe,
        value = load * (span * roll_moment * airframe.x + chord * pitch_moment * airframe.y + span * yaw_moment * airframe.z)
    )]
    aerodynamic_moment: Torque,
    #[acts(on = airframe, value = thrust(mach, height, power) * airframe.x)]
    jet: Force,
    #[acts(on = airframe, value = cross(spin * airframe.x, turning))]
    rotor: Torque,

    #[output(alpha / 57.29578)]
    angle_of_attack: Scalar,
    #[output(beta / 57.29578)]
    sideslip_angle: Scalar,
    #[output(speed)]
    airspeed: Scalar,
    #[output(flight_path(velocity))]
    climb: Scalar,
    #[output(load * sideways / (mass * g))]
    felt_sideways: Scalar,
    #[output(dot(turning, ground.z))]
    turning_right: Scalar,
    #[output(rate(bank(airframe)))]
    banking: Scalar,
    #[output(rate(elevation(airframe)))]
    rising: Scalar,
}
