use linkwork::mechanism;

/// Bricard's linkage: six rods in a ring, joined by six pins, along the edges of a cube. It is mobile
/// although Grübler's count gives no degree of freedom: one of its conditions follows from the others.
///
/// Source: Bricard, *Leçons de cinématique* II (1927); IFToMM library of computational benchmark problems,
/// A04: rods of one metre and one kilogram, released from the cube for ten seconds; González, Dopico, Lugrís
/// and Cuadrado, *A benchmarking system for MBS simulation software*, Multibody Syst. Dyn. 16 (2006).
///
/// - Coordinates: `p1` to `p5`, the angles of five pins, rad. The sixth rod is the ground, and the pin `p6`
///   closes the ring. y points up. With all angles zero the ring extends along `x`, `−y`, `z`, `−x`, `y`,
///   `−z`.
/// - The angles of the pins are alternately `θ` (`p1`, `p3`, `p5`) and `φ` (`p2`, `p4`), with
///   `sin θ + sin φ + sin θ sin φ = 0`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BricardLinkage {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of each rod, kg.
    pub mass: f64,
    /// Length of each rod, m.
    pub length: f64,

    #[body(mass = mass, com = length / 2 * x, inertia = rod(mass, length, x))]
    rod1: Body,
    #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
    rod2: Body,
    #[body(mass = mass, com = length / 2 * z, inertia = rod(mass, length, z))]
    rod3: Body,
    #[body(mass = mass, com = -length / 2 * x, inertia = rod(mass, length, x))]
    rod4: Body,
    #[body(mass = mass, com = length / 2 * y, inertia = rod(mass, length, y))]
    rod5: Body,
    #[joint(ground -> rod1, about = y)]
    p1: Pin,
    #[joint(rod1.at(length * x) -> rod2, about = z)]
    p2: Pin,
    #[joint(rod2.at(-length * y) -> rod3, about = x)]
    p3: Pin,
    #[joint(rod3.at(length * z) -> rod4, about = y)]
    p4: Pin,
    #[joint(rod4.at(-length * x) -> rod5, about = z)]
    p5: Pin,
    #[joint(rod5.at(length * y) -> ground.at(length * z), about = x)]
    p6: Pin,
}
