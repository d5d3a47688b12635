//! Kinetic and potential energy, total mass and centre of mass.

use super::crba::{composite_inertias, momentum};
use super::inertances;
use crate::expr::{Expr, Vec3};
use crate::kinematics::{Joint, coordinate_in_terms_of_q, twists};
use crate::mechanism::Model;

/// Returns the kinetic energy: half of twist times momentum, summed over the links, plus that of inerters.
pub fn kinetic_energy<'g>(model: &Model<'g>, joints: &[Joint<'g>], v: &[Expr<'g>]) -> Expr<'g> {
    let twists = twists(model, joints, v);
    let twice = model
        .links
        .iter()
        .zip(&twists)
        .fold(model.graph.zero(), |sum, (link, twist)| sum + twist.dot(&momentum(&link.inertia, twist)));
    twice * 0.5 + inertances::kinetic_energy(model)
}

/// Returns the total mass of the moving bodies, and their first moment about the ground's origin in ground
/// axes.
pub fn mass_and_moment<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> (Expr<'g>, Vec3<'g>) {
    let composites = composite_inertias(model, joints);
    let roots = joints.iter().zip(&composites).filter(|(joint, _)| joint.parent.is_none());
    let sum = roots.fold(model.still, |sum, (joint, c)| joint.add_inertia_to_parent(&sum, c));
    (sum.mass, sum.moment)
}

/// Returns the centre of mass in ground axes, or the first moment (zero) if the total mass is zero.
pub fn center_of_mass<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec3<'g> {
    let (mass, moment) = mass_and_moment(model, joints);
    if mass.is_zero() {
        return moment;
    }
    let inverse = mass.num(1.0) / mass;
    moment * inverse
}

/// Returns the potential energy of gravity, springs and other potentials.
pub fn potential_energy<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Expr<'g> {
    let (_, moment) = mass_and_moment(model, joints);
    let mut energy = -model.gravity.dot(moment);
    for spring in &model.springs {
        let stretch = coordinate_in_terms_of_q(model, &spring.on) - spring.free;
        energy += spring.stiffness * 0.5 * stretch.square();
    }
    model.potentials.iter().fold(energy, |sum, e| sum + *e)
}
