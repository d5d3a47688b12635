use linkwork::mechanism;

/// Motor that drives a link through a gear with backlash, elastic teeth and losses proportional to the load.
///
/// Source: Nordin and Gutman, *Controlling mechanical systems with backlash – a survey*, Automatica 38
/// (2002); Siciliano, Sciavicco, Villani and Oriolo, *Robotics* (2009), §5.2.
///
/// - Coordinates: `motor` and `output`, the angles of rotor and link, rad. Input: `drive`, the torque of the
///   motor, N·m. Output: `torque`, that of the teeth on the link.
/// - The twist `δ = motor / n − output` is free within `±b / 2`; beyond, the teeth transmit the torque
///   `T = k (δ ∓ b / 2)` to the link.
/// - Sliding teeth take the torque `μ |T| / n` from the motor, in the direction of its rotation. The
///   efficiency is `1 / (1 + μ)` if the motor drives the link, and `1 − μ` if the link drives the motor: with
///   `μ ≥ 1` the gear is self-locking.
/// - With the teeth in contact at constant twist `α = n τ / (n² J + (1 + μ) I)` at the output.
/// - Without losses, free oscillations of the twist have the period `2π √(m / k) + 2 b / v` for the reduced
///   inertia `m` with `1 / m = 1 / (n² J) + 1 / I`, and the speed `v` of the twist within the backlash.
#[mechanism(derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearedJoint {
    /// Moment of inertia of the rotor, kg·m².
    pub rotor_inertia: f64,
    /// Moment of inertia of the link, kg·m².
    pub inertia: f64,
    /// Gear ratio: rotation of the rotor per rotation of the link.
    pub ratio: f64,
    /// Stiffness of the teeth at the output, N·m/rad.
    pub stiffness: f64,
    /// Backlash: free rotation of the link with the rotor at rest, rad.
    pub backlash: f64,
    /// Loss coefficient of the gear: torque lost per torque transmitted.
    pub loss: f64,
    /// Angular velocity of the rotor at which the losses have three quarters of their full value, rad/s.
    pub creep: f64,

    #[body(inertia = diagonal(rotor_inertia, rotor_inertia, rotor_inertia))]
    rotor: Body,
    #[body(inertia = diagonal(inertia, inertia, inertia))]
    link: Body,
    #[joint(ground -> rotor, about = z)]
    motor: Pin,
    #[joint(ground -> link, about = z)]
    output: Pin,
    #[define(motor / ratio - output)]
    twist: Scalar,
    #[define(twist - min(max(twist, -backlash / 2), backlash / 2))]
    deflection: Scalar,
    #[define(stiffness * deflection)]
    transmitted: Scalar,
    #[energy(transmitted / 2 * deflection)]
    teeth: Potential,
    #[acts(on = motor, value = -loss * abs(transmitted) / ratio * tanh(rate(motor) / creep))]
    sliding: Torque,
    #[acts(on = motor)]
    drive: Torque,
    #[output(transmitted)]
    torque: Scalar,
}
