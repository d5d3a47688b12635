//! Flying body with a thruster, and a weight on a ball joint.

use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * z)]
pub struct Flail {
    pub handle: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.1, 0.2, handle))]
    grip: Body,
    #[body(mass = 1, com = -z / 2, inertia = cylinder(1, 0.1, 0.3, z))]
    weight: Body,
    #[joint(ground -> grip)]
    flight: Free,
    #[joint(grip.at(-handle / 2 * z) -> weight)]
    chain: Ball,
    #[acts(on = grip, along = grip.z)]
    thrust: Force,
}
