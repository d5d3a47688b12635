use linkwork::mechanism;

/// Gyroscope: a rotor in two massless gimbals, with an optional offset of its centre of mass.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), §5.7; Magnus, *Kreisel* (1971).
///
/// - Coordinates: Euler angles `precession` about the vertical z, `nutation` about the line of nodes, `spin`
///   about the rotor's axis: `φ`, `θ`, `ψ`, rad. The gimbals are massless, so the mass matrix is singular
///   where the axis is vertical (`θ = 0`: gimbal lock).
/// - Steady precession at constant `θ`, with `A` the transverse moment of inertia about the pivot, `C` the
///   axial one and the total spin `n = ψ̇ + φ̇ cos θ`: `A φ̇² cos θ − C n φ̇ + m g h = 0`. For a fast rotor
///   `φ̇ ≈ m g h / (C n)`.
/// - Output: `rotor_rate`, the angular velocity of the rotor in the axes of the inner gimbal,
///   `(θ̇, φ̇ sin θ, n)`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyroscope {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the rotor, kg.
    pub mass: f64,
    /// Distance of the rotor's centre of mass from the pivot along its axis, m.
    pub offset: f64,
    /// Moment of inertia of the rotor about its axis, kg·m².
    pub axial: f64,
    /// Moment of inertia of the rotor across its axis, about the centre of mass, kg·m².
    pub transverse: f64,

    #[body]
    outer: Body,
    #[body]
    inner: Body,
    #[body(mass = mass, com = offset * z, inertia = diagonal(transverse, transverse, axial))]
    rotor: Body,
    #[joint(ground -> outer, about = z)]
    precession: Pin,
    #[joint(outer -> inner, about = x)]
    nutation: Pin,
    #[joint(inner -> rotor, about = z)]
    spin: Pin,
    #[output(omega(rotor / ground), resolved_in = inner)]
    rotor_rate: Vector,
}
