use linkwork::mechanism;

/// Rattleback, or celt: a half ellipsoid whose principal axes of inertia are rotated against those of its
/// shape. Spun in one direction it begins to rattle, stops and reverses its rotation.
///
/// Source: Kane and Levinson, *Realistic mathematical modeling of the rattleback*, Int. J. Non-Linear Mech.
/// 17 (1982); Walker, *On a dynamical top*, Q. J. Pure Appl. Math. 28 (1896). [`BENCHMARK`](Self::BENCHMARK)
/// has the parameters of the first.
///
/// - Configuration: position and unit quaternion of `pose`; velocity: linear and angular, in the body's axes,
///   which are those of the ellipsoid `x²/a² + y²/b² + z²/c² = 1`. z points up; the centre of mass is below
///   the ellipsoid's centre.
/// - It touches the table at `−(a² n₁, b² n₂, c² n₃) / √(a² n₁² + b² n₂² + c² n₃²)` from the centre, where
///   `n` are the components of the upward normal, and the contact point is at rest.
/// - No force dissipates: the energy is constant.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rattleback {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the rattleback, kg.
    pub mass: f64,
    /// Semi-axis of the ellipsoid along x, m.
    pub a: f64,
    /// Semi-axis of the ellipsoid along y, m.
    pub b: f64,
    /// Semi-axis of the ellipsoid along z, m.
    pub c: f64,
    /// Depth of the centre of mass below the ellipsoid's centre, m.
    pub depth: f64,
    /// Moment of inertia of the rattleback about its x axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia of the rattleback about its y axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia of the rattleback about its z axis, kg·m².
    pub izz: f64,
    /// Product of inertia of the rattleback (entry xy of the matrix), kg·m².
    pub ixy: f64,

    #[body(mass = mass, com = -depth * z, inertia = [[ixx, ixy, 0], [ixy, iyy, 0], [0, 0, izz]])]
    stone: Body,
    #[joint(ground -> stone)]
    pose: Free,
    #[constraint(rolls(stone.ellipsoid(a, b, c), ground.plane(z)))]
    contact: Rolling,
}

impl Rattleback {
    /// Parameters of Kane and Levinson's rattleback.
    pub const BENCHMARK: Rattleback = Rattleback {
        g: 9.81,
        mass: 1.0,
        a: 0.2,
        b: 0.03,
        c: 0.02,
        depth: 0.01,
        ixx: 2e-4,
        iyy: 1.6e-3,
        izz: 1.7e-3,
        ixy: -2e-5,
    };
}
