//! Mechanisms with many elements between points, and with bodies placed by expressions of coordinates.

use crate::chains::MechanismSourceText;
use std::fmt::Write;

/// Number of links of the arm with springs between its links.
const LINKS: usize = 4;

/// Returns an arm of spatial pins with this number of springs between points of the ground and points of its
/// links.
pub fn arm_with_springs_source(springs: usize) -> MechanismSourceText {
    let mut item = "pub struct Arm {\n".to_string();
    let mut parent = "ground".to_string();
    for k in 0..LINKS {
        let axis = ["z", "y", "x"][k % 3];
        let _ = writeln!(
            item,
            "#[body(mass = 2, com = 0.2 * z, inertia = diagonal(0.03, 0.04, 0.02))] link{k}: Body,
            #[joint({parent} -> link{k}, about = {axis})] joint{k}: Pin,"
        );
        parent = format!("link{k}.at(0.4 * z)");
    }
    for k in 0..springs {
        let (x, y, z) = (0.1 + 0.01 * k as f64, 0.3 + 0.003 * k as f64, 0.1 + 0.002 * k as f64);
        let _ = writeln!(
            item,
            "#[acts(between = (ground.at({x:.3} * x + {y:.3} * y), link{}.at({z:.3} * z)), stiffness = {}, \
             free_length = 0.{})] spring{k}: Spring,",
            k % LINKS,
            10 + k,
            1 + k % 9
        );
    }
    item.push('}');
    MechanismSourceText { arguments: "gravity = -9.81 * z".to_string(), item }
}

/// Returns a planar chain of particles on rods; the position of each particle is an expression of the angles
/// of all rods before it.
pub fn particle_chain_source(particles: usize) -> MechanismSourceText {
    let mut item = "pub struct Placed {\n".to_string();
    let (mut x, mut z) = (Vec::new(), Vec::new());
    for k in 1..=particles {
        let length = 0.3 + 0.01 * k as f64;
        x.push(format!("{length:.2} * sin(a{k})"));
        z.push(format!("{length:.2} * cos(a{k})"));
        let mass = 1.0 + 0.1 * k as f64;
        let _ = writeln!(
            item,
            "a{k}: Coordinate,
            #[particle(mass = {mass:.1}, at = ({}) * x - ({}) * z)] p{k}: Particle,",
            x.join(" + "),
            z.join(" + ")
        );
    }
    item.push('}');
    MechanismSourceText { arguments: "gravity = -9.81 * z".to_string(), item }
}
