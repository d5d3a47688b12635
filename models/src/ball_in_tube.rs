use linkwork::mechanism;

/// Ball that rolls without slipping inside a vertical tube. It does not fall: it descends, reverses and rises
/// again, as a golf ball that leaves the hole.
///
/// Source: Gualtieri, Tokieda, Advis-Gaete, Carry, Reffet and Guthmann, *Golfer's dilemma*, Am. J. Phys. 74
/// (2006); Neimark and Fufaev, *Dynamics of Nonholonomic Systems* (1972), ch. II.
///
/// - Configuration: position and unit quaternion of `pose`; velocity: linear and angular, in the ball's axes;
///   z points up along the tube's axis.
/// - The rate `Ω` of the motion around the axis is constant, and with the spin `n` about the radial
///   direction: `r ṅ = Ω ż`, `(7/5) z̈ + (2/5) r n Ω + g = 0`, an oscillation with the frequency `√(2/7) Ω`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallInTube {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the ball, kg.
    pub mass: f64,
    /// Radius of the ball, m.
    pub radius: f64,
    /// Inner radius of the tube, m.
    pub tube: f64,

    #[body(mass = mass, inertia = sphere(mass, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(rolls(ball.sphere(radius), ground.tube(tube, z)))]
    contact: Rolling,
}
