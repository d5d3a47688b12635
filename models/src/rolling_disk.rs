use linkwork::mechanism;

/// Uniform disk that rolls without slipping on a table, upright or leaning. Also called Euler's disk.
///
/// Source: Neimark and Fufaev, *Dynamics of Nonholonomic Systems* (1972), ch. II; Kane and Levinson,
/// *Dynamics: Theory and Applications* (1985), ch. 4.
///
/// - Coordinates: `place` of the centre, m; `heading` `q₁` about z, `lean` `q₂` about the rotated x, `roll`
///   `q₃` about the disk's axis, the rotated y; rad. z points up. They are singular where the disk lies flat.
/// - With the angular velocity `u = (q̇₂, q̇₃ + q̇₁ sin q₂, q̇₁ cos q₂)` in the axes that lean but do not
///   roll: `u̇₁ = (4 g sin q₂ + 6 r u₂ u₃ − r u₃² tan q₂) / (5 r)`, `u̇₂ = −⅔ u₁ u₃`,
///   `u̇₃ = (−2 u₂ + u₃ tan q₂) u₁`.
/// - Rolling straight and upright at the speed `v` is stable if `v² > g r / 3`; small leans have the
///   exponents `s² = 4 g / (5 r) − 12 v² / (5 r²)`.
#[mechanism(gravity = -g * z, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingDisk {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the disk, kg.
    pub m: f64,
    /// Radius of the disk, m.
    pub radius: f64,

    #[body]
    upright: Body,
    #[body]
    turned: Body,
    #[body]
    leaning: Body,
    #[body(mass = m, inertia = disk(m, radius, y))]
    disk: Body,
    #[joint(ground -> upright, along = (x, y, z))]
    place: Stage,
    #[joint(upright -> turned, about = z)]
    heading: Pin,
    #[joint(turned -> leaning, about = x)]
    lean: Pin,
    #[joint(leaning -> disk, about = y)]
    roll: Pin,
    #[constraint(rolls(disk.circle(radius, y), ground.plane(z)))]
    contact: Rolling,
}
