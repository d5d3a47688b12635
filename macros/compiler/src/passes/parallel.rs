//! Links that turn about parallel axes, one after the other, in the same axes: those that do not turn with the first of
//! them. Nothing that is handed from one to the next is turned then. What is turned, by the sum of the angles, are the
//! constants of each link, its mass properties and the places of what it carries (Khalil and Dombre, *Modeling,
//! Identification and Control of Robots*, 2002, ch. 3, for the geometry of arms).
//!
//! Axes are those in which components are told. Velocities and accelerations stay those of the links, so that all
//! recursions of vectors hold as they are; a link's mass properties become expressions of its angle.

use super::Variant;
use super::motions::coordinate_axis;
use crate::expr::{Expr, Rotation};
use crate::kinematics::position_in;
use crate::mechanism::{Link, Model, Motion};

/// The variants with the axes of parallel joints in common. Empty if there are no such joints.
pub fn in_common_axes<'g>(variants: &[Variant<'g>]) -> Vec<Variant<'g>> {
    variants.iter().filter_map(with_common_axes).collect()
}

/// Axes of which the sine is no larger are parallel. The equations in common axes are those of axes that are: they change by as
/// much beside one, less than what π with twelve digits is off, as files have it.
const PARALLEL: f64 = 2.5e-13;

/// A joint about or along a coordinate axis, of those that are parallel to each other.
#[derive(Clone, Copy)]
struct Member {
    /// The axis.
    axis: usize,
    /// The first of them.
    first: usize,
    /// The cosine between the axis and that of the parent, plus or minus one, if the parent is one of them.
    along: Option<f64>,
}

fn with_common_axes<'g>(variant: &Variant<'g>) -> Option<Variant<'g>> {
    let members = members(&variant.model);
    if members.iter().all(Option::is_none) {
        return None;
    }
    let mut variant = variant.clone();
    // By link: the angle about the axis that its own axes have in the common ones.
    let mut angles: Vec<Option<Expr<'g>>> = Vec::new();
    // Of its own axes in those in which it is described now.
    let mut turned: Vec<Option<Rotation<'g>>> = Vec::new();
    for ((link, joint), member) in variant.model.links.iter_mut().zip(&mut variant.joints).zip(members) {
        let above = joint.parent.and_then(|p| turned[p.0].clone());
        if let Some(above) = &above {
            joint.translation = above.to_parent(joint.translation);
        }
        let Some(Member { axis, along, .. }) = member else {
            joint.rotation = after(above, &joint.rotation);
            angles.push(None);
            turned.push(None);
            continue;
        };
        let carried = along.zip(joint.parent.and_then(|p| angles[p.0])).map(|(cosine, angle)| angle * cosine);
        // A constant rotation that keeps the axis may come before the turn about it as well as after.
        let above = if along.is_some() { None } else { above };
        joint.rotation = after(above, &link.placement.rotation);
        let own = own_angle(link, axis);
        let angle = own.map_or(carried, |own| Some(carried.map_or(own, |carried| carried + own)));
        let turn = angle.map(|angle| Rotation::about_axis(axis, angle));
        if let Some(turn) = &turn {
            link.inertia.moment = turn.to_parent(link.inertia.moment);
            link.inertia.tensor = turn.sym_to_parent(link.inertia.tensor);
        }
        angles.push(angle);
        turned.push(turn);
    }
    Some(variant)
}

/// By link: its place among joints that are parallel to each other, of which two turn at least.
fn members(model: &Model<'_>) -> Vec<Option<Member>> {
    let mut members: Vec<Option<Member>> = Vec::with_capacity(model.links.len());
    let mut turns = vec![0; model.links.len()];
    for (k, link) in model.links.iter().enumerate() {
        let member = axis(link).map(|axis| {
            let above = link.parent.and_then(|p| members[p.0]);
            let along = above.and_then(|above| {
                let direction = link.placement.rotation.matrix().column(axis).values()?;
                let cosine = direction[above.axis];
                // The cosine of a small angle is one, too: its sine tells.
                let across = [(above.axis + 1) % 3, (above.axis + 2) % 3];
                let is_parallel = across.iter().all(|i| direction[*i].abs() <= PARALLEL);
                (is_parallel && cosine.abs() == 1.0).then_some((cosine, above.first))
            });
            Member { axis, first: along.map_or(k, |(_, first)| first), along: along.map(|(c, _)| c) }
        });
        if let (Some(member), Motion::Turn { .. }) = (member, &link.motion) {
            turns[member.first] += 1;
        }
        members.push(member);
    }
    members.into_iter().map(|member| member.filter(|m| turns[m.first] > 1)).collect()
}

/// The coordinate axis about or along which a link moves.
fn axis(link: &Link<'_>) -> Option<usize> {
    let (Motion::Turn { axis, .. } | Motion::Slide { axis, .. }) = link.motion else { return None };
    coordinate_axis(axis).filter(|k| axis[*k].value().is_some_and(|c| c.abs() == 1.0))
}

/// The angle by which a link turns about a coordinate axis.
fn own_angle<'g>(link: &Link<'g>, axis: usize) -> Option<Expr<'g>> {
    let Motion::Turn { axis: direction, coordinate } = &link.motion else { return None };
    let angle = position_in(direction[axis].graph(), coordinate);
    let backwards = direction[axis].value().is_some_and(|c| c < 0.0);
    Some(if backwards { -angle } else { angle })
}

fn after<'g>(above: Option<Rotation<'g>>, rotation: &Rotation<'g>) -> Rotation<'g> {
    match above {
        Some(above) => above.then(rotation),
        None => rotation.clone(),
    }
}
