use linkwork::mechanism;

/// Planar five-bar linkage: a parallel robot with both motors on the ground that move one tool.
///
/// Source: Liu, Wang and Pritschow, *Kinematics, singularity and workspace of planar 5R symmetrical parallel
/// mechanisms*, Mech. Mach. Theory 41 (2006).
///
/// - Coordinates: `left` and `right` `θ₁`, `θ₂`, the angles of the two cranks from x; `left_elbow` and
///   `right_elbow`, the angles of the forearms from their cranks; rad. y points up. The left crank rotates
///   about the origin, the right one about `(base, 0)`. The pin `wrist` closes the loop; the tool is there.
///   Inputs: `left_motor` and `right_motor`, torques on the cranks, N·m.
/// - The tool `P` is on circles about both elbows `Eᵢ`: `|P − Eᵢ| = forearm`. The rates follow from
///   `(P − Eᵢ) · (Ṗ − Ėᵢ) = 0`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiveBar {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of each crank, kg.
    pub crank_mass: f64,
    /// Mass of each forearm, kg.
    pub forearm_mass: f64,
    /// Mass of the tool, kg.
    pub tool_mass: f64,
    /// Distance of the motors, m.
    pub base: f64,
    /// Length of each crank, m.
    pub crank: f64,
    /// Length of each forearm, m.
    pub forearm: f64,

    #[body(mass = crank_mass, com = crank / 2 * x, inertia = rod(crank_mass, crank, x))]
    left_crank: Body,
    #[body(mass = forearm_mass, com = forearm / 2 * x, inertia = rod(forearm_mass, forearm, x))]
    left_forearm: Body,
    #[body(mass = crank_mass, com = crank / 2 * x, inertia = rod(crank_mass, crank, x))]
    right_crank: Body,
    #[body(mass = forearm_mass, com = forearm / 2 * x, inertia = rod(forearm_mass, forearm, x))]
    right_forearm: Body,
    #[particle(mass = tool_mass, at = left_forearm.at(forearm * x))]
    tool: Particle,
    #[joint(ground -> left_crank, about = z)]
    left: Pin,
    #[joint(left_crank.at(crank * x) -> left_forearm, about = z)]
    left_elbow: Pin,
    #[joint(ground.at(base * x) -> right_crank, about = z)]
    right: Pin,
    #[joint(right_crank.at(crank * x) -> right_forearm, about = z)]
    right_elbow: Pin,
    #[joint(left_forearm.at(forearm * x) -> right_forearm.at(forearm * x), about = z)]
    wrist: Pin,
    #[acts(on = left)]
    left_motor: Torque,
    #[acts(on = right)]
    right_motor: Torque,
}
