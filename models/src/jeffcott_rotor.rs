use linkwork::mechanism;

/// Jeffcott's (or Laval's) rotor: an unbalanced disk in the middle of an elastic shaft that rotates at a
/// constant rate.
///
/// Source: Jeffcott, *The lateral vibration of loaded shafts…*, Phil. Mag. 37 (1919); Den Hartog, *Mechanical
/// Vibrations* (1956), ch. 6.
///
/// - Coordinates: `bow.x` and `bow.y`, the deflection of the shaft across its axis z, m. The disk rotates at
///   the prescribed rate `Ω`, so the functions have the time as their first argument.
/// - Equations of motion, with the eccentricity `e`: `m ẍ + c ẋ + k x = m e Ω² cos Ωt`,
///   `m ÿ + c ẏ + k y = m e Ω² sin Ωt`.
/// - Steady whirl on a circle with the radius `e r² / √((1 − r²)² + (2 ζ r)²)`, `r = Ω √(m/k)`,
///   `ζ = ½ c / √(k m)`, which lags the unbalance by the angle `atan2(2 ζ r, 1 − r²)`. Far above the critical
///   speed the disk rotates about its centre of mass.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JeffcottRotor {
    /// Angular velocity of the shaft, rad/s.
    pub spin: f64,
    /// Mass of the disk, kg.
    pub mass: f64,
    /// Distance of the disk's centre of mass from the shaft, m.
    pub eccentricity: f64,
    /// Stiffness of the shaft, N/m.
    pub stiffness: f64,
    /// External damping of the disk's motion, N·s/m.
    pub damping: f64,

    #[body]
    hub: Body,
    #[joint(ground -> hub, along = (x, y))]
    bow: Stage,
    #[frame(hub, z(spin * t))]
    disk: Frame,
    #[particle(mass = mass, at = hub.at(eccentricity * disk.x))]
    unbalance: Particle,
    #[acts(on = bow.x, stiffness = stiffness)]
    shaft_x: Spring,
    #[acts(on = bow.y, stiffness = stiffness)]
    shaft_y: Spring,
    #[acts(on = bow.x, damping = damping)]
    damper_x: Dashpot,
    #[acts(on = bow.y, damping = damping)]
    damper_y: Dashpot,
}
