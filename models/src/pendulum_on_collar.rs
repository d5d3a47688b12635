use linkwork::mechanism;

/// Pendulum on a collar: a sleeve rotates about a vertical post and slides along it on a spring; an arm with
/// a weight is pinned to the sleeve. One arm of a centrifugal governor.
///
/// Source: Bernstein, Goel and Ansari, *Geometry, Kinematics, Statics, and Dynamics*, on the collar-pin
/// joint; Landau and Lifshitz, *Mechanics* (1976), §5, problem 4 (the governor).
///
/// - Coordinates: `collar.slide`, the height `s`, zero where the spring is slack, m; `collar.turn`, `φ`, rad;
///   `hinge`, the angle `θ` of the arm from hanging, about the sleeve's x, rad.
/// - Mass matrix (mass `M` and moment of inertia `J` of the sleeve; weight `m` on an arm of length `l`):
///   `M₁₁ = M + m`, `M₁₃ = m l sin θ`, `M₂₂ = J + m l² sin² θ`, `M₃₃ = m l²`, others zero. Potential energy
///   `(M + m) g s + ½ k s² − m g l cos θ`.
/// - Steady rotation at `Ω`: `cos θ = g / (l Ω²)`, `s = −(M + m) g / k`. The angular momentum `M₂₂ φ̇` is
///   conserved.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumOnCollar {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the sleeve, kg.
    pub sleeve_mass: f64,
    /// Moment of inertia of the sleeve about the post, kg·m².
    pub sleeve_inertia: f64,
    /// Stiffness of the spring along the post, N/m.
    pub stiffness: f64,
    /// Mass of the weight, kg.
    pub mass: f64,
    /// Length of the arm, m.
    pub length: f64,

    #[body(mass = sleeve_mass, inertia = diagonal(sleeve_inertia / 2, sleeve_inertia / 2, sleeve_inertia))]
    sleeve: Body,
    #[body]
    arm: Body,
    #[particle(mass = mass, at = arm.at(-length * z))]
    weight: Particle,
    #[joint(ground -> sleeve, along = z)]
    collar: Collar,
    #[joint(sleeve -> arm, about = x)]
    hinge: Pin,
    #[acts(on = collar.slide, stiffness = stiffness)]
    coil: Spring,
}
