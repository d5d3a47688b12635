//! Regrouping of mass properties from links to their parents (Khalil and Kleinfinger 1987; Gautier and Khalil
//! 1990).
//!
//! A part `X` of a link's mass properties can be moved across a joint with motion subspace `S` if `X S = 0`
//! and the joint's motion leaves `X` invariant: wrench, momentum and energy are then the same as if it were
//! fixed to the parent. For a revolute joint about `z` these are a mass at the origin, a first moment along
//! `z`, and equal moments of inertia about `x` and `y`. For a prismatic joint they are all moments of
//! inertia, for a screw equal moments about `x` and `y`, for a ball joint a mass at its centre.

use super::motions::{VanishingMomentConvention, index_of_parallel_axis, movable_inertia};
use super::number::{NumericFrame, NumericMassProperties};

use crate::mechanism::{Inertia, Link, LinkId, Model, Motion};

/// Options of the pass that regroups mass properties towards the base.
#[derive(Clone, Copy, Debug, Default)]
pub struct RegroupOptions {
    /// Moment of inertia that the regrouping makes zero.
    pub gauge: VanishingMomentConvention,
    /// Also moves mass to a child's origin, where that removes a component of the link's first moment.
    pub to_children: bool,
    /// Also moves symbolic mass properties to the parents, although that costs operations.
    pub symbolic: bool,
}

/// Moves all mass properties that can be moved from links to their parents.
pub fn move_inertias_to_parents(
    model: &mut Model<'_>,
    RegroupOptions { gauge, to_children, symbolic }: RegroupOptions,
) {
    for k in (0..model.links.len()).rev() {
        if to_children {
            move_mass_to_child(model, k);
        }
        let link = &model.links[k];
        let target = link.parent.map_or(&model.still, |p| &model.links[p.0].inertia);
        if !(symbolic
            || is_numeric_inertia(&link.inertia) && is_numeric_inertia(target) && has_numeric_placement(link))
        {
            continue;
        }
        let Some(part) = movable_inertia(link, gauge) else { continue };
        let placement = link.placement.clone();
        let parent = link.parent;
        model.links[k].inertia = subtract_inertia_part(&model.links[k], &part);
        let target = match parent {
            Some(p) => &mut model.links[p.0].inertia,
            None => &mut model.still,
        };
        *target = target.sum_with_placed_inertia(&part, &placement.rotation, placement.translation);
    }
}

/// Moves a mass from link `k` to the origin of a revolute or ball joint of a child, so that a component of
/// the link's first moment vanishes. The force on the mass is its product with an acceleration that is
/// computed anyway.
fn move_mass_to_child(model: &mut Model<'_>, k: usize) {
    let Motion::Turn { axis, .. } = &model.links[k].motion else { return };
    let (Some(own), Some(mut inertia)) =
        (index_of_parallel_axis(*axis), NumericMassProperties::from_inertia(&model.links[k].inertia))
    else {
        return;
    };
    if !has_force_effect_beyond_moment(model, k) {
        return;
    }
    let g = model.graph;
    let masses = model.links.iter().map(|l| l.inertia.mass).chain([model.still.mass]);
    let total: f64 = masses.filter_map(|m| m.constant_value()).sum();
    for c in k + 1..model.links.len() {
        let child = &model.links[c];
        let turns = matches!(child.motion, Motion::Turn { .. } | Motion::Ball { .. });
        let (Some(place), Some(mut other)) =
            (NumericFrame::from_pose(&child.placement), NumericMassProperties::from_inertia(&child.inertia))
        else {
            continue;
        };
        // The acceleration of a child without first moment may not be needed at all.
        if !turns || child.parent != Some(LinkId(k)) || other.mass != 0.0 || other.moment == [0.0; 3] {
            continue;
        }
        let p = place.translation;
        let normal: Vec<usize> = (0..3).filter(|i| *i != own).collect();
        let along: Vec<usize> = normal.iter().copied().filter(|i| p[*i] != 0.0).collect();
        let [i] = along[..] else { continue };
        if inertia.moment[i] == 0.0 {
            continue;
        }
        let mass = inertia.moment[i] / p[i];
        // A short lever arm would need a large mass and lose digits.
        if mass.abs() > total {
            continue;
        }
        inertia = inertia.plus_point_mass(-mass, p);
        inertia.moment[i] = 0.0;
        other.mass = mass;
        model.links[c].inertia = other.inertia_expressions(g);
        model.links[k].inertia = inertia.inertia_expressions(g);
    }
}

/// Returns true if the force on a link has an effect in addition to its moment: a revolute joint with a lever
/// arm, or a prismatic joint, lies between the link and the root.
fn has_force_effect_beyond_moment(model: &Model<'_>, mut k: usize) -> bool {
    loop {
        let link = &model.links[k];
        match (&link.motion, link.parent) {
            (Motion::Turn { .. } | Motion::Ball { .. }, None) => return false,
            (Motion::Turn { .. } | Motion::Ball { .. }, Some(parent)) => {
                if !link.placement.translation.is_zero() && model.links[parent.0].parent.is_some() {
                    return true;
                }
                k = parent.0;
            }
            _ => return true,
        }
    }
}

fn is_numeric_inertia(inertia: &Inertia<'_>) -> bool {
    inertia.mass.constant_value().is_some()
        && inertia.moment.constant_components().is_some()
        && inertia.tensor.full_matrix().entries_if_all_constant().is_some()
}

fn has_numeric_placement(link: &Link<'_>) -> bool {
    link.placement.translation.constant_components().is_some()
        && link.placement.rotation.rotation_matrix().entries_if_all_constant().is_some()
}

fn subtract_inertia_part<'g>(link: &Link<'g>, part: &Inertia<'g>) -> Inertia<'g> {
    let Inertia { mass, moment, tensor } = link.inertia;
    Inertia { mass: mass - part.mass, moment: moment - part.moment, tensor: tensor - part.tensor }
}
