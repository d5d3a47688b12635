use linkwork::mechanism;

/// Solid cylinder that rolls without slipping inside a cylindrical trough.
///
/// Source: Landau and Lifshitz, *Mechanics* (1976), §32, problem 6; Goldstein, Poole and Safko, *Classical
/// Mechanics* (2002), ch. 2.
///
/// - Coordinate: `phi`, the angle `φ` of the line of centres from the vertical, rad, counter-clockwise seen
///   from +z; y points up. The cylinder rotates in the opposite direction, by `−(R − r) φ / r`.
/// - Equation of motion: `(3/2) m (R − r)² φ̈ + m g (R − r) sin φ = 0`: a pendulum with the length
///   `(3/2) (R − r)`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylinderInTrough {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the cylinder, kg.
    pub mass: f64,
    /// Radius of the cylinder, m.
    pub radius: f64,
    /// Length of the cylinder, m.
    pub width: f64,
    /// Radius of the trough, m.
    pub trough: f64,

    phi: Coordinate,
    #[frame(ground, z(-(trough - radius) / radius * phi))]
    turned: Frame,
    #[body(
        mass = mass,
        inertia = cylinder(mass, radius, width, z),
        at = (trough - radius) * (sin(phi) * x - cos(phi) * y),
        frame = turned
    )]
    cylinder: Body,
}
