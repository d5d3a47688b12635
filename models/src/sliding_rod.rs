use linkwork::mechanism;

/// Rod whose lower end slides on a rough floor, as chalk that is pushed over a board: the mechanism of
/// Painlevé's paradox.
///
/// Source: Painlevé, *Sur les lois du frottement de glissement*, C. R. Acad. Sci. 121 (1895); Génot and
/// Brogliato, *New results on Painlevé paradoxes*, Eur. J. Mech. A 18 (1999).
///
/// - Coordinates: `pose.x`, `pose.y` of the rod's centre, m, and its angle `pose.angle` from the level, rad;
///   y points up. The lower end is a ball.
/// - With the contact at `(c, d)` from the centre, where `c = −l cos θ` and `d = −l sin θ − r`, and the
///   factor `σ = s / √(s² + v₀²)` of the slip velocity `s` (`v₀` is 1 mm/s), the normal force `N` satisfies
///   `(1/m + c²/J + μ σ c d / J) N = g − l sin θ θ̇²`. If the bracket is not positive, friction jams. For a
///   thin rod this needs `μ > 4/3`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlidingRod {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the rod, kg.
    pub mass: f64,
    /// Half the length of the rod, `l`, m.
    pub half: f64,
    /// Radius of the rod's round end, `r`, m.
    pub radius: f64,
    /// Coefficient of friction `μ` between rod and floor.
    pub friction: f64,

    #[body(mass = mass, inertia = rod(mass, 2 * half, x))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    pose: Planar,
    #[constraint(
        slips(rod.at(-half * x).sphere(radius), ground.plane(y)), friction = friction, speed = 0.001
    )]
    floor: Slipping,
}
