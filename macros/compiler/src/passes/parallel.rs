//! Successive links on parallel revolute joints, resolved in common axes: the axes before the first of these
//! joints. Vectors that are passed between these links need no rotation. Instead the constants of each link,
//! its mass properties and the positions of its children, are rotated by the sum of the angles (Khalil and
//! Dombre, *Modeling, Identification and Control of Robots*, 2002, ch. 3, for the geometry of arms).
//!
//! Only the axes in which vectors are resolved change. Velocities and accelerations are still those of the
//! links, so all vector recursions hold unchanged; a link's mass properties become expressions of its angle.

use super::ModelVariant;
use super::motions::index_of_parallel_axis;
use crate::expr::{Expr, Rotation};
use crate::kinematics::coordinate_as_expression;
use crate::mechanism::{Link, Model, Motion};

/// Returns variants in which links on parallel joints are resolved in common axes; the list is empty if there
/// are no such joints.
pub fn variants_in_common_axes<'g>(variants: &[ModelVariant<'g>]) -> Vec<ModelVariant<'g>> {
    variants.iter().filter_map(variant_with_common_axes).collect()
}

/// Maximum sine of the angle between axes that are treated as parallel. The equations in common axes are
/// those of exactly parallel axes, which changes them by this relative amount: less than the error of π with
/// twelve digits in robot files.
const PARALLEL: f64 = 2.5e-13;

/// Joint about or along a coordinate axis, in a chain of parallel joints.
#[derive(Clone, Copy)]
struct ParallelChainJoint {
    /// Index of the coordinate axis that is common to the chain.
    axis: usize,
    /// Index of the first link of the chain with parallel joint axes.
    first: usize,
    /// Cosine of the angle to the parent's axis, plus or minus one; `None` if the parent does not belong to
    /// the chain.
    along: Option<f64>,
}

fn variant_with_common_axes<'g>(variant: &ModelVariant<'g>) -> Option<ModelVariant<'g>> {
    let members = parallel_chain_members(&variant.model);
    if members.iter().all(Option::is_none) {
        return None;
    }
    let mut variant = variant.clone();
    // For each link: the angle of its own axes relative to the common ones.
    let mut angles: Vec<Option<Expr<'g>>> = Vec::new();
    // For each link: the rotation of its own axes relative to the axes in which it is resolved now.
    let mut turned: Vec<Option<Rotation<'g>>> = Vec::new();
    for ((link, joint), member) in variant.model.links.iter_mut().zip(&mut variant.joints).zip(members) {
        let above = joint.parent.and_then(|p| turned[p.0].clone());
        if let Some(above) = &above {
            joint.translation = above.vector_in_parent_axes(joint.translation);
        }
        let Some(ParallelChainJoint { axis, along, .. }) = member else {
            joint.rotation = compose_rotations(above, &joint.rotation);
            angles.push(None);
            turned.push(None);
            continue;
        };
        let carried = along.zip(joint.parent.and_then(|p| angles[p.0])).map(|(cosine, angle)| angle * cosine);
        // A constant rotation about the same axis commutes with the joint's rotation.
        let above = if along.is_some() { None } else { above };
        joint.rotation = compose_rotations(above, &link.placement.rotation);
        let own = angle_about_axis(link, axis);
        let angle = own.map_or(carried, |own| Some(carried.map_or(own, |carried| carried + own)));
        let turn = angle.map(|angle| Rotation::rotation_about_coordinate_axis(axis, angle));
        if let Some(turn) = &turn {
            link.inertia.moment = turn.vector_in_parent_axes(link.inertia.moment);
            link.inertia.tensor = turn.symmetric_tensor_in_parent_axes(link.inertia.tensor);
        }
        angles.push(angle);
        turned.push(turn);
    }
    Some(variant)
}

/// Returns for each link its membership in a chain of parallel joints, at least two of which are revolute;
/// `None` for other links.
fn parallel_chain_members(model: &Model<'_>) -> Vec<Option<ParallelChainJoint>> {
    let mut members: Vec<Option<ParallelChainJoint>> = Vec::with_capacity(model.links.len());
    let mut turns = vec![0; model.links.len()];
    for (k, link) in model.links.iter().enumerate() {
        let member = axis_of_motion(link).map(|axis| {
            let above = link.parent.and_then(|p| members[p.0]);
            let along = above.and_then(|above| {
                let direction =
                    link.placement.rotation.rotation_matrix().column(axis).constant_components()?;
                let cosine = direction[above.axis];
                // The sine decides, because the cosine of a small angle rounds to one.
                let across = [(above.axis + 1) % 3, (above.axis + 2) % 3];
                let is_parallel = across.iter().all(|i| direction[*i].abs() <= PARALLEL);
                (is_parallel && cosine.abs() == 1.0).then_some((cosine, above.first))
            });
            ParallelChainJoint {
                axis,
                first: along.map_or(k, |(_, first)| first),
                along: along.map(|(c, _)| c),
            }
        });
        if let (Some(member), Motion::Turn { .. }) = (member, &link.motion) {
            turns[member.first] += 1;
        }
        members.push(member);
    }
    members.into_iter().map(|member| member.filter(|m| turns[m.first] > 1)).collect()
}

/// Returns the coordinate axis about or along which a link moves.
fn axis_of_motion(link: &Link<'_>) -> Option<usize> {
    let (Motion::Turn { axis, .. } | Motion::Slide { axis, .. }) = link.motion else { return None };
    index_of_parallel_axis(axis).filter(|k| axis[*k].constant_value().is_some_and(|c| c.abs() == 1.0))
}

/// Returns the angle by which a link rotates about a coordinate axis.
fn angle_about_axis<'g>(link: &Link<'g>, axis: usize) -> Option<Expr<'g>> {
    let Motion::Turn { axis: direction, coordinate } = &link.motion else { return None };
    let angle = coordinate_as_expression(direction[axis].graph(), coordinate);
    let backwards = direction[axis].constant_value().is_some_and(|c| c < 0.0);
    Some(if backwards { -angle } else { angle })
}

fn compose_rotations<'g>(above: Option<Rotation<'g>>, rotation: &Rotation<'g>) -> Rotation<'g> {
    match above {
        Some(above) => above.compose_with(rotation),
        None => rotation.clone(),
    }
}
