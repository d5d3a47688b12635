use linkwork::mechanism;

/// Flywheel on a shaft with a brake: dry friction brings it to rest.
///
/// Source: Coulomb, *Théorie des machines simples* (1785); Bernstein, Goel and Ansari, *Geometry, Kinematics,
/// Statics, and Dynamics*, on dashpots and friction.
///
/// - Coordinate: `shaft`, the flywheel's angle, rad. Input: `motor`, a torque, N·m.
/// - Equation of motion: `J ω̇ = τ − f tanh(ω / ω₀)`: the smooth form of `τ − f sign ω`; below the small
///   speed `ω₀` it creeps.
/// - Running down from `ω(0)`: `sinh(ω / ω₀) = sinh(ω(0) / ω₀) exp(−f t / (J ω₀))`, so that
///   `ω = ω(0) − f t / J` until it is nearly at rest, after `J ω(0) / f`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrakedFlywheel {
    /// Moment of inertia of the flywheel, kg·m².
    pub inertia: f64,
    /// Torque of the brake, N·m.
    pub brake_torque: f64,
    /// Angular velocity below which the flywheel is considered at rest, rad/s.
    pub creep: f64,

    #[body(inertia = diagonal(inertia / 2, inertia / 2, inertia))]
    flywheel: Body,
    #[joint(ground -> flywheel, about = z)]
    shaft: Pin,
    #[acts(on = shaft, coulomb = brake_torque, speed = creep)]
    brake: Friction,
    #[acts(on = shaft)]
    motor: Torque,
}
