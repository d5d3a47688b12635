use linkwork::mechanism;

/// A glider with a parabolic polar, `C_D = C_D0 + K C_L²`, and linear moments.
///
/// Source: Anderson, *Aircraft Performance and Design* (1999), § 5.10, on gliding; Etkin and Reid, *Dynamics
/// of Flight* (1996), ch. 6, on the spiral.
///
/// - Axes: forward, right, down, of the ground too. Input: `elevator`, rad, which sets the angle of attack.
/// - Steady: the whole force of the air is the weight, and the path goes down at `tan γ = C_D / C_L`. It is
///   flattest where `C_L = √(C_D0 / K)`, with `C_L / C_D = 1 / (2 √(K C_D0))`, and sinks slowest near
///   `C_L = √(3 C_D0 / K)`.
/// - Where the angle of attack hardly changes the phugoid takes `√2 π V / g` seconds, with the damping ratio
///   `3 C_D / (2 √2 C_L)`.
/// - The static margin is `−C_mα / (C_Lα + C_D)` chords.
/// - Near level flight the spiral is stable if `C_lβ C_nr > C_nβ C_lr`.
#[mechanism(gravity = g * z, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glider {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Moment of inertia about the forward axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia about the right axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia about the downward axis, kg·m².
    pub izz: f64,
    /// Density of the air, kg/m³.
    pub density: f64,
    /// Wing area, m².
    pub area: f64,
    /// Mean chord, m.
    pub chord: f64,
    /// Wing span, m.
    pub span: f64,
    /// Lift at zero angle of attack.
    pub cl_0: f64,
    /// Slope of the lift with the angle of attack, 1/rad.
    pub cl_alpha: f64,
    /// Drag without lift.
    pub cd_0: f64,
    /// `K`, of the drag by lift.
    pub cd_induced: f64,
    /// Pitching moment by the angle of attack, 1/rad.
    pub cm_alpha: f64,
    /// Pitching moment by the pitch rate.
    pub cm_rate: f64,
    /// Pitching moment by the elevator, 1/rad.
    pub cm_elevator: f64,
    /// Force to the right by sideslip, 1/rad.
    pub cy_beta: f64,
    /// Rolling moment by sideslip, 1/rad: negative with dihedral.
    pub roll_beta: f64,
    /// Rolling moment by the roll rate.
    pub roll_p: f64,
    /// Rolling moment by the yaw rate.
    pub roll_r: f64,
    /// Yawing moment by sideslip, 1/rad.
    pub yaw_beta: f64,
    /// Yawing moment by the yaw rate.
    pub yaw_r: f64,

    elevator: Input,
    #[body(mass = mass, inertia = diagonal(ixx, iyy, izz))]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,

    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[define(norm(velocity))]
    speed: Scalar,
    #[define(angle_of_attack(airframe, velocity))]
    alpha: Scalar,
    #[define(sideslip(airframe, velocity))]
    beta: Scalar,
    #[define(density / 2 * speed * speed * area)]
    load: Scalar,
    #[define(cl_0 + cl_alpha * alpha)]
    lifting: Scalar,
    #[define(omega(airframe / ground))]
    turning: Vector,
    #[define(span / (2 * speed) * dot(turning, airframe.x))]
    rolling: Scalar,
    #[define(chord / (2 * speed) * dot(turning, airframe.y))]
    pitching: Scalar,
    #[define(span / (2 * speed) * dot(turning, airframe.z))]
    yawing: Scalar,

    #[acts(on = airframe, value = load * lifting * (sin(alpha) * airframe.x - cos(alpha) * airframe.z))]
    lift: Force,
    #[acts(on = airframe, value = -load * (cd_0 + cd_induced * lifting * lifting) / speed * velocity)]
    drag: Force,
    #[acts(on = airframe, value = load * cy_beta * beta * airframe.y)]
    side: Force,
    #[acts(
        on = airframe,
        value = load * span * (roll_beta * beta + roll_p * rolling + roll_r * yawing) * airframe.x
            + load * chord * (cm_alpha * alpha + cm_rate * pitching + cm_elevator * elevator) * airframe.y
            + load * span * (yaw_beta * beta + yaw_r * yawing) * airframe.z
    )]
    moment: Torque,

    #[output(speed)]
    airspeed: Scalar,
    #[output(dot(velocity, ground.z))]
    sink: Scalar,
}
