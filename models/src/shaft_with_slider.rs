use linkwork::mechanism;

/// Slider on a rotating shaft: an arm rotates about a vertical pin and carries a sleeve that slides freely
/// along it, outwards, as in a centrifugal governor.
///
/// Source: Meriam and Kraige, *Engineering Mechanics: Dynamics* (2012), ch. 2 (polar coordinates); Landau and
/// Lifshitz, *Mechanics* (1976), §39 (centrifugal force).
///
/// - Coordinates: `bearing`, the shaft's angle `θ`, rad, about the vertical z; `sleeve`, the slider's
///   distance `r` from the axis, m. Input: `motor`, a torque on the shaft, N·m.
/// - Equations of motion: `(J + m r²) θ̈ + 2 m r ṙ θ̇ = τ`, `r̈ = r θ̇²`.
/// - Without a torque the angular momentum `(J + m r²) θ̇` is conserved; at constant `θ̇ = ω`,
///   `r = r₀ cosh ωt`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftWithSlider {
    /// Moment of inertia of the shaft about its bearing, kg·m².
    pub inertia: f64,
    /// Mass of the slider, kg.
    pub mass: f64,

    #[body(inertia = diagonal(0, inertia, inertia))]
    shaft: Body,
    #[body(mass = mass)]
    slider: Body,
    #[joint(ground -> shaft, about = z)]
    bearing: Pin,
    #[joint(shaft -> slider, along = x)]
    sleeve: Sleeve,
    #[acts(on = bearing)]
    motor: Torque,
}
