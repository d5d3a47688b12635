use linkwork::mechanism;

/// Chaplygin's sleigh: a body on ice with a knife edge behind its centre of mass, which cannot move sideways.
///
/// Source: Neimark and Fufaev, *Dynamics of Nonholonomic Systems* (1972), ch. III.
///
/// - Coordinates: `ice.x`, `ice.y`, position of the knife, m; `ice.angle`, its heading from x, rad.
/// - With the speed `u` along the knife and the turning rate `ω`: `u̇ = a ω²`, `(J + m a²) ω̇ = −m a u ω`.
///   The energy is constant; nevertheless the sleigh approaches a straight motion with its centre of mass
///   ahead, `u = V tanh(a V t / b² + const)`, `b² = a² + J/m`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChaplyginSleigh {
    /// Mass of the sleigh, kg.
    pub m: f64,
    /// Moment of inertia of the sleigh about its centre of mass, kg·m².
    pub j: f64,
    /// Distance of the centre of mass ahead of the knife, m.
    pub a: f64,

    #[body(mass = m, com = a * x, inertia = diagonal(j, j, j))]
    sleigh: Body,
    #[joint(ground -> sleigh, about = z)]
    ice: Planar,
    #[constraint(dot(v(sleigh / ground / ground), sleigh.y) = 0)]
    knife: Nonholonomic,
}
