use linkwork::prelude::*;

/// Bead on a circular wire of 1 m in a vertical plane, with a sideways input force.
#[mechanism(gravity = -9.81 * y, derivatives)]
pub struct Bead {
    mass: f64,
    #[particle(mass = mass)]
    bead: Particle,
    #[joint(ground -> bead, along = (x, y))]
    plane: Stage,
    #[constraint(plane.x * plane.x + plane.y * plane.y = 1)]
    wire: Holonomic,
    #[acts(on = bead, along = x)]
    push: Force,
}
