use linkwork::mechanism;

/// Satellite in orbit with a gravity-gradient torque, since gravity is weaker at its far end.
///
/// Source: Hughes, *Spacecraft Attitude Dynamics* (1986), ch. 9; Bernstein, Goel and Ansari, *Geometry,
/// Kinematics, Statics, and Dynamics*, on central gravity.
///
/// - Configuration: position and unit quaternion of `flight`, the free joint from the centre of attraction;
///   velocity: linear and angular, in the satellite's axes.
/// - At the position `r`, with `n = r/|r|` and the inertia matrix `I`, the torque of gravity is
///   `3 μ / r³ · n × I n`, to second order in size over distance. The force is `−μ m r / r³` and a term of
///   second order, which depends on `I` as the torque does.
/// - On a circular orbit with the rate `Ω = √(μ/r³)`, the orientation with one axis up (yaw), one forward
///   (roll), one across (pitch) is an equilibrium; small oscillations in pitch have the frequency
///   `Ω √(3 (I_roll − I_yaw) / I_pitch)`. It is stable if the long axis is up.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityGradientSatellite {
    /// Gravitational parameter of the central body, m³/s²: 3.986004418e14 for the earth.
    pub mu: f64,
    /// Mass of the satellite, kg.
    pub mass: f64,
    /// Moment of inertia of the satellite about its x axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia of the satellite about its y axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia of the satellite about its z axis, kg·m².
    pub izz: f64,

    #[body(mass = mass, inertia = diagonal(ixx, iyy, izz))]
    satellite: Body,
    #[joint(ground -> satellite)]
    flight: Free,
    #[acts(between = (ground, satellite), mu = mu)]
    gravity: Gravity,
}
