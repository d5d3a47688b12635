use linkwork::mechanism;

/// Forearm lifted by a Hill-type muscle: a fibre in series with an elastic tendon, over the round end of the
/// upper arm.
///
/// Source: Zajac, *Muscle and tendon*, Critical Reviews in Biomedical Engineering 17 (1989); Thelen,
/// *Adjustment of muscle mechanics model parameters*, J. Biomechanical Engineering 125 (2003).
///
/// - Coordinate: `elbow`, the angle of the forearm from the horizontal, rad. States: `activation`, and
///   `fibre`, the length of the fibre divided by its optimal length. Input: `excitation`, from 0.01 to 1.
/// - Activation: `ȧ = (u − a) / (τ₁ (½ + 3/2 a))` if it rises, `ȧ = (u − a) (½ + 3/2 a) / τ₂` if it falls.
/// - Forces divided by the maximum: tendon `K max(ε, 0)²` with its strain `ε`; passive fibre
///   `P max(fibre − 1, 0)²`; active fibre `a · exp(−((fibre − 1) / w)²) · f`.
/// - Equilibrium of tendon and fibre determines `f`; from it follows the speed of the fibre by Hill's
///   hyperbolas. It shortens by `v̂ (1 − f) / (1 + f / h)` if `f < 1`, at most by `v̂`. It lengthens by
///   `v̂ (1 − p) / (1 + c p)` otherwise, with `p = (e − f) / (e − 1)`, at most by `v̂` at `f = e`. The slopes
///   of both are equal at rest for `1 + c = (1 + 1 / h) / (e − 1)`.
#[mechanism(gravity = -9.81 * y, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuscleForearm {
    /// Maximum isometric force of the muscle, N.
    pub strength: f64,
    /// Optimal length of the fibre, m.
    pub optimal: f64,
    /// Length of the relaxed tendon, m.
    pub slack: f64,
    /// Force of the tendon, divided by the maximum, per squared strain.
    pub tendon_stiffness: f64,
    /// Passive force of the fibre, divided by the maximum, per squared stretch.
    pub passive_stiffness: f64,
    /// Width of the curve of active force over length.
    pub width: f64,
    /// Maximum shortening velocity of the fibre, in optimal lengths per second, 1/s.
    pub fastest: f64,
    /// Shape parameter of Hill's hyperbola (force over velocity) for shortening.
    pub hill: f64,
    /// Ratio of the maximum force while lengthening to the isometric force.
    pub eccentric: f64,
    /// Time constant of the muscle's activation, s.
    pub rise: f64,
    /// Time constant of the muscle's deactivation, s.
    pub fall: f64,

    excitation: Input,
    /// State: activation of the muscle.
    #[state(
        rate = if excitation < activation { (excitation - activation) * (0.5 + 1.5 * activation) / fall }
            else { (excitation - activation) / (rise * (0.5 + 1.5 * activation)) }
    )]
    pub activation: State,
    /// State: length of the fibre divided by its optimal length.
    #[state(
        rate = if ratio < 1 { -fastest * (1 - ratio) / (1 + ratio / hill) }
            else { fastest * (1 - part) / (1 + ((1 + 1 / hill) / (eccentric - 1) - 1) * part) }
    )]
    pub fibre: State,

    #[body(mass = 1.5, com = 0.15 * x, inertia = rod(1.5, 0.3, x))]
    forearm: Body,
    #[joint(ground -> forearm, about = z)]
    elbow: Pin,
    #[define(cable(forearm.at(0.05 * x) / ground.at(0.3 * y), ground.cylinder(0.03, z)))]
    path: Scalar,
    #[define(max((path - optimal * fibre) / slack - 1, 0))]
    strain: Scalar,
    #[define(max(fibre - 1, 0))]
    stretched: Scalar,
    #[define(tendon_stiffness * strain * strain)]
    tendon: Scalar,
    #[define(activation * exp(-pow((fibre - 1) / width, 2)))]
    active: Scalar,
    #[define(min(max((tendon - passive_stiffness * stretched * stretched) / active, 0), eccentric))]
    ratio: Scalar,
    #[define((eccentric - ratio) / (eccentric - 1))]
    part: Scalar,
    #[acts(on = path, value = -strength * tendon)]
    muscle: Force,
}
