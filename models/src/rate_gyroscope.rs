use linkwork::mechanism;

/// Rate gyroscope: a fast rotor in one gimbal on a rotating base; the gimbal's deflection against its spring
/// measures the rate of the base.
///
/// Source: Magnus, *Kreisel* (1971); Bernstein, Goel and Ansari, *Geometry, Kinematics, Statics, and
/// Dynamics*, on gimbals.
///
/// - The housing rotates about z with the prescribed rate `Ω`, so the functions have the time as their first
///   argument. Coordinates: `gimbal`, its angle `θ` about the housing's x, rad; `spin`, the rotor's angle
///   about its axis, the gimbal's y, rad.
/// - With `n = ψ̇ + Ω sin θ`, the rotor's total spin, and the moments of inertia `C` about its axis and `A`
///   across: `A θ̈ + A Ω² sin θ cos θ − C n Ω cos θ + k θ + c θ̇ = 0`, `C ṅ = 0`.
/// - At rest `k θ = (C n − A Ω sin θ) Ω cos θ`, which is proportional to `Ω` for small rates.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateGyroscope {
    /// Angular velocity of the housing, rad/s.
    pub rate: f64,
    /// Moment of inertia of the rotor about its axis, kg·m².
    pub axial: f64,
    /// Moment of inertia of the rotor across its axis, kg·m².
    pub transverse: f64,
    /// Stiffness of the spring that centres the gimbal, N·m/rad.
    pub stiffness: f64,
    /// Damping of the gimbal, N·m·s/rad.
    pub damping: f64,

    #[frame(ground, z(rate * t))]
    vehicle: Frame,
    #[body(frame = vehicle)]
    housing: Body,
    #[body]
    cradle: Body,
    #[body(inertia = diagonal(transverse, axial, transverse))]
    rotor: Body,
    #[joint(housing -> cradle, about = x)]
    gimbal: Pin,
    #[joint(cradle -> rotor, about = y)]
    spin: Pin,
    #[acts(on = gimbal, stiffness = stiffness)]
    centring: Spring,
    #[acts(on = gimbal, damping = damping)]
    damper: Dashpot,
}
