use linkwork::mechanism;

/// Vehicle that glides from orbit, in six degrees of freedom over the round Earth, which rotates with its
/// atmosphere.
///
/// Source: Vinh, Busemann and Culp, *Hypersonic and Planetary Entry Flight Mechanics* (1980), ch. 2; Stevens,
/// Lewis and Johnson, *Aircraft Control and Simulation* (2015), § 1.7.
///
/// - Ground: inertial axes in the centre of the Earth, z to the North Pole. `flight` is the pose in axes that
///   rotate with the Earth and coincide with those of the ground at the time 0. Axes of the vehicle: forward,
///   right, down. Inputs: `lift`, upwards in them, and `thrust`, forward, N; `moment`, about the right axis,
///   N·m.
/// - In the rotating axes, `a = −μ r / r³ − 2 Ω × v − Ω × (Ω × r) + f / m`.
/// - Level flight to the east over the equator at `V` needs the lift `m (μ / r² − (V + Ω r)² / r)`, which is
///   less than to the west.
/// - Drag is `½ ρ V² S_D`, with `ρ = ρ₀ e^{−(r − R) / H}` and the velocity `V` relative to the Earth and its
///   atmosphere.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HypersonicGlider {
    /// Gravitational parameter of the Earth, m³/s².
    pub mu: f64,
    /// Rotation rate of the Earth, rad/s.
    pub turning: f64,
    /// Radius of the Earth, m.
    pub radius: f64,
    /// Density of the air at the radius of the Earth, kg/m³.
    #[unit(kg / m3)]
    pub density: f64,
    /// Scale height of the atmosphere, in which the density decreases by the factor `1/e`, m.
    pub scale: f64,
    /// Mass of the vehicle, kg.
    pub mass: f64,
    /// Moment of inertia of the vehicle about its forward axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia of the vehicle about its right axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia of the vehicle about its downward axis, kg·m².
    pub izz: f64,
    /// Reference area times the drag coefficient of the vehicle, m².
    #[unit(m2)]
    pub drag_area: f64,

    #[frame(ground, z(turning * t))]
    earth: Frame,
    #[body(frame = earth)]
    globe: Body,
    #[body(mass = mass, inertia = diagonal(ixx, iyy, izz))]
    craft: Body,
    #[joint(globe -> craft)]
    flight: Free,
    #[acts(between = (ground, craft), mu = mu)]
    gravity: Gravity,

    #[define(v(craft / ground / earth))]
    velocity: Vector,
    #[define(norm(r(craft / ground)) - radius)]
    height: Scalar,
    #[acts(on = craft, value = -density / 2 * exp(-height / scale) * drag_area * norm(velocity) * velocity)]
    drag: Force,
    #[acts(on = craft, along = -craft.z)]
    lift: Force,
    #[acts(on = craft, along = craft.x)]
    thrust: Force,
    #[acts(on = craft, about = craft.y)]
    moment: Torque,

    #[output(height)]
    altitude: Scalar,
    #[output(norm(velocity))]
    ground_speed: Scalar,
}
