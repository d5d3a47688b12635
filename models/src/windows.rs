use linkwork::mechanism;

/// Two windows of the mechanism with N windows: rods in a row of parallelograms, all verticals upright at the
/// start.
///
/// Source: IFToMM library of computational benchmark problems, A02; González, Dopico, Lugrís and Cuadrado, *A
/// benchmarking system for MBS simulation software*, Multibody Syst. Dyn. 16 (2006).
///
/// - Coordinates: `b0`, `b1`, `b2`, the angles of the uprights from the vertical, and `t0`, `t1`, the angles
///   of the horizontal rods from the uprights that carry them, rad; y points up. The pins `close1` and
///   `close2` close the loops.
/// - With all links on one line, twice in each turn, the constraints lose rank and other motions branch off.
///   In the parallelogram's assembly mode the motion is that of a pendulum, with `N = 2` windows and the
///   angle `θ` of all uprights: `(N + (N + 1)/3) l θ̈ = (N + (N + 1)/2) g sin θ`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoWindows {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of each rod, kg.
    pub mass: f64,
    /// Length of each rod, m.
    pub length: f64,

    #[body(mass = mass, com = length / 2 * y, inertia = rod(mass, length, y))]
    left: Body,
    #[body(mass = mass, com = length / 2 * x, inertia = rod(mass, length, x))]
    first: Body,
    #[body(mass = mass, com = length / 2 * y, inertia = rod(mass, length, y))]
    middle: Body,
    #[body(mass = mass, com = length / 2 * x, inertia = rod(mass, length, x))]
    second: Body,
    #[body(mass = mass, com = length / 2 * y, inertia = rod(mass, length, y))]
    right: Body,
    #[joint(ground -> left, about = z)]
    b0: Pin,
    #[joint(left.at(length * y) -> first, about = z)]
    t0: Pin,
    #[joint(ground.at(length * x) -> middle, about = z)]
    b1: Pin,
    #[joint(middle.at(length * y) -> second, about = z)]
    t1: Pin,
    #[joint(ground.at(2 * length * x) -> right, about = z)]
    b2: Pin,
    #[joint(first.at(length * x) -> middle.at(length * y), about = z)]
    close1: Pin,
    #[joint(second.at(length * x) -> right.at(length * y), about = z)]
    close2: Pin,
}
