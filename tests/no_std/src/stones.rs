//! Two convex hulls, of which one falls on the other.

use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * z)]
struct Stones {
    friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.4, 0.4, 0.2))]
    lower: Body,
    #[joint(ground -> lower)]
    lower_pose: Free,
    #[body(mass = 1, inertia = cuboid(1, 0.2, 0.2, 0.1))]
    upper: Body,
    #[joint(ground -> upper)]
    upper_pose: Free,
    #[contact(lower.cuboid(0.4, 0.4, 0.2), ground.plane(z), friction = friction)]
    floor: Contact,
    #[contact(
        upper.hull([[0.1, 0.1, -0.05], [-0.1, 0.1, -0.05], [-0.1, -0.1, -0.05], [0.1, -0.1, -0.05], [0, 0, 0.1]]),
        lower.hull([
            [0.2, 0.2, 0.1], [-0.2, 0.2, 0.1], [-0.2, -0.2, 0.1], [0.2, -0.2, 0.1],
            [0.2, 0.2, -0.1], [-0.2, 0.2, -0.1], [-0.2, -0.2, -0.1], [0.2, -0.2, -0.1]
        ]),
        friction = friction
    )]
    seat: Contact,
}

/// Whether the upper stone falls on the lower one and comes to rest on its top face.
pub fn upper_stone_comes_to_rest(friction: f64) -> bool {
    let stones = Stones { friction };
    let mut q = stones.neutral();
    (q[2], q[7], q[9]) = (0.1, 0.02, 0.3);
    let run = simulate(&stones).from(q, [0.0; 12]).method(TimeStepping::step(2e-3).midpoint());
    let Ok(end) = run.duration(0.6).finish() else { return false };
    (end.q[9] - 0.25).abs() < 1e-6 && (end.q[7] - 0.02).abs() < 1e-6 && end.v.norm() < 1e-9
}
