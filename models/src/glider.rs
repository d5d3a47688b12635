use linkwork::mechanism;

/// Glider with a parabolic polar, `C_D = C_D0 + K C_L²`, and linear moments.
///
/// Source: Anderson, *Aircraft Performance and Design* (1999), § 5.10, on gliding; Etkin and Reid, *Dynamics
/// of Flight* (1996), ch. 6, on the spiral.
///
/// - Axes: forward, right, down, also those of the ground. Input: `elevator`, rad, which determines the angle
///   of attack.
/// - In a steady glide the aerodynamic force balances the weight, and the path descends at
///   `tan γ = C_D / C_L`. The glide is flattest at `C_L = √(C_D0 / K)`, with `C_L / C_D = 1 / (2 √(K C_D0))`,
///   and the sink rate is smallest near `C_L = √(3 C_D0 / K)`.
/// - With a nearly constant angle of attack the phugoid has the period `√2 π V / g`, with the damping ratio
///   `3 C_D / (2 √2 C_L)`.
/// - The static margin is `−C_mα / (C_Lα + C_D)` chords.
/// - Near level flight the spiral is stable if `C_lβ C_nr > C_nβ C_lr`.
#[mechanism(gravity = g * z, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glider {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the glider, kg.
    pub mass: f64,
    /// Moment of inertia of the glider about its forward axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia of the glider about its right axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia of the glider about its downward axis, kg·m².
    pub izz: f64,
    /// Density of the air, kg/m³.
    pub density: f64,
    /// Wing area, m².
    pub area: f64,
    /// Mean chord of the wing, m.
    pub chord: f64,
    /// Wing span, m.
    pub span: f64,
    /// Lift coefficient at zero angle of attack.
    pub cl_0: f64,
    /// Slope of the lift coefficient with the angle of attack, 1/rad.
    pub cl_alpha: f64,
    /// Drag coefficient at zero lift.
    pub cd_0: f64,
    /// Coefficient `K` of the induced drag.
    pub cd_induced: f64,
    /// Derivative of the pitching moment with respect to the angle of attack, 1/rad.
    pub cm_alpha: f64,
    /// Derivative of the pitching moment with respect to the pitch rate.
    pub cm_rate: f64,
    /// Derivative of the pitching moment with respect to the elevator, 1/rad.
    pub cm_elevator: f64,
    /// Derivative of the side force with respect to sideslip, 1/rad.
    pub cy_beta: f64,
    /// Derivative of the rolling moment with respect to sideslip (negative with dihedral), 1/rad.
    pub roll_beta: f64,
    /// Derivative of the rolling moment with respect to the roll rate.
    pub roll_p: f64,
    /// Derivative of the rolling moment with respect to the yaw rate.
    pub roll_r: f64,
    /// Derivative of the yawing moment with respect to sideslip, 1/rad.
    pub yaw_beta: f64,
    /// Derivative of the yawing moment with respect to the yaw rate.
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
