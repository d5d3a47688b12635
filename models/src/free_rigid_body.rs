use linkwork::mechanism;

/// Rigid body in free flight without gravity: Euler's top. Spun about its intermediate axis it turns over
/// periodically (Dzhanibekov's effect, the tennis racket theorem).
///
/// Source: Euler, *Theoria motus corporum* (1765); Landau and Lifshitz, *Mechanics* (1976), §37; Ashbaugh,
/// Chicone and Cushman, *The twisting tennis racket*, J. Dyn. Diff. Eq. 3 (1991).
///
/// - Configuration: position and unit quaternion of `flight`; velocity: linear `v` and angular `ω`, in the
///   body's axes.
/// - Newton's and Euler's equations: `m (v̇ + ω × v) = 0`, `I ω̇ + ω × I ω = 0`.
/// - Energy and angular momentum (in the ground frame) are constant. With the principal moments of inertia
///   `I₁ < I₂ < I₃`, the rotational energy `E` and the angular momentum `L` such that `L² > 2 E I₂`, the
///   angular velocity returns after `4 K(k) √(I₁ I₂ I₃ / ((I₃ − I₂)(L² − 2 E I₁)))`,
///   `k² = (I₂ − I₁)(2 E I₃ − L²) / ((I₃ − I₂)(L² − 2 E I₁))`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRigidBody {
    /// Mass of the body, kg.
    pub mass: f64,
    /// Moment of inertia of the body about its x axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia of the body about its y axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia of the body about its z axis, kg·m².
    pub izz: f64,

    #[body(mass = mass, inertia = diagonal(ixx, iyy, izz))]
    body: Body,
    #[joint(ground -> body)]
    flight: Free,
}
