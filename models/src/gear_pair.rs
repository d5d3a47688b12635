use linkwork::mechanism;

/// Two gears in mesh, on fixed axles: a constraint couples their angles.
///
/// Source: Norton, *Design of Machinery* (2004), ch. 9; Shabana, *Dynamics of Multibody Systems* (2013), ch.
/// 3.
///
/// - Coordinates: `pinion` and `wheel`, the angles of the two gears about z, rad. Input: `motor`, a torque on
///   the pinion, N·m. They rotate in opposite directions: `r₁ θ₁ + r₂ θ₂ = 0`, a length of arc.
/// - With the motor's torque `M`: `(J₁ + (r₁/r₂)² J₂) θ̈₁ = M`, and the multiplier of `teeth` is the force
///   between the teeth, `−(r₁ J₂ / r₂²) θ̈₁`, N: negative if it retards the pinion.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearPair {
    /// Moment of inertia of the small gear about its axis, kg·m².
    pub small_inertia: f64,
    /// Moment of inertia of the large gear about its axis, kg·m².
    pub large_inertia: f64,
    /// Pitch radius of the small gear, m.
    pub small_radius: f64,
    /// Pitch radius of the large gear, m.
    pub large_radius: f64,

    #[body(inertia = diagonal(small_inertia / 2, small_inertia / 2, small_inertia))]
    small: Body,
    #[body(inertia = diagonal(large_inertia / 2, large_inertia / 2, large_inertia))]
    large: Body,
    #[joint(ground -> small, about = z)]
    pinion: Pin,
    #[joint(ground.at((small_radius + large_radius) * x) -> large, about = z)]
    wheel: Pin,
    #[constraint(small_radius * pinion = -large_radius * wheel)]
    teeth: Holonomic,
    #[acts(on = pinion)]
    motor: Torque,
}
