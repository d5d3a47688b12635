use linkwork::mechanism;

/// Duffing oscillator: a mass on a spring with a cubic stiffness (hardening or softening), with a dashpot and
/// a harmonic force.
///
/// Source: Duffing, *Erzwungene Schwingungen bei veränderlicher Eigenfrequenz* (1918); Nayfeh and Mook,
/// *Nonlinear Oscillations* (1979), ch. 4; Kovacic and Brennan, *The Duffing Equation* (2011).
///
/// - Coordinate: `slide`, the displacement `x`, m. The force is a function of time, so the functions have the
///   time as their first argument.
/// - Equation of motion: `m ẍ + c ẋ + α x + β x³ = F cos Ωt`.
/// - Free and undamped from rest at `A`: period `4 K(k) √(m / (α + β A²))` with `k² = ½ β A² / (α + β A²)`.
/// - With `α < 0 < β` there are two wells at `±√(−α/β)`, in which small oscillations have the frequency
///   `√(−2α/m)`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DuffingOscillator {
    /// Mass of the oscillator, kg.
    pub mass: f64,
    /// Coefficient of the dashpot, N·s/m.
    pub damping: f64,
    /// Linear stiffness of the spring, N/m.
    pub alpha: f64,
    /// Cubic stiffness of the spring, N/m³.
    pub beta: f64,
    /// Amplitude of the harmonic force, N.
    pub drive: f64,
    /// Angular frequency of the harmonic force, rad/s.
    pub frequency: f64,

    #[body(mass = mass)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    slide: Sleeve,
    #[acts(on = slide, force = alpha * stretch + beta * pow(stretch, 3))]
    spring: Spring,
    #[acts(on = slide, damping = damping)]
    dashpot: Dashpot,
    #[acts(on = slide, value = drive * cos(frequency * t))]
    shaker: Force,
}
