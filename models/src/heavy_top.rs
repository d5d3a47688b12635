use linkwork::{Real, mechanism};

/// Heavy symmetric top: a body of revolution that spins about a fixed point on its axis. Also called
/// Lagrange's top.
///
/// Source: Landau and Lifshitz, *Mechanics* (1976), §35, problem 1; Goldstein, Poole and Safko, *Classical
/// Mechanics* (2002), §5.7.
///
/// - Configuration: the unit quaternion of the ball joint `tip`; velocity: the angular velocity in the top's
///   axes; z is the axis of the top, and up in the ground.
/// - Euler's equations about the fixed point, all in the top's axes, with the height `h` of the centre of
///   mass above the tip and the moments of inertia `C` about the axis and `A = transverse + m h²` across it:
///   the mass matrix is `M = diag(A, A, C)`, the bias forces are `ω × M ω − h e₃ × m g`.
/// - Steady precession `Ω` at the inclination `θ` with the axial spin `n`: `A Ω² cos θ − C n Ω + m g h = 0`.
/// - The upright top is stable ("sleeps") if `C² n² > 4 A m g h`.
///
/// Generic over the scalar type.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeavyTop<T: Real> {
    /// Gravitational acceleration, m/s².
    pub g: T,
    /// Mass of the top, kg.
    pub mass: T,
    /// Height of the top's centre of mass above its tip, m.
    pub height: T,
    /// Moment of inertia of the top about its axis, kg·m².
    pub axial: T,
    /// Moment of inertia of the top across its axis, about the centre of mass, kg·m².
    pub transverse: T,

    #[body(mass = mass, com = height * z, inertia = diagonal(transverse, transverse, axial))]
    top: Body,
    #[joint(ground -> top)]
    tip: Ball,
}
