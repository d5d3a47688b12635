//! Shifting of link frames along revolute axes for symbolic placements. As with the frames of Denavit and
//! Hartenberg (1955), two lengths along one axis become one. Mass properties in a frame that is shifted by a
//! parameter cost operations, but fewer than the shift saves.

use super::cost::{LENGTH, PRODUCT};
use super::frames::move_contents_to_new_frames;
use super::motions::index_of_parallel_axis;
use crate::expr::{Expr, Vec3};
use crate::mechanism::{Inertia, Link, Model, Motion, Pose};

/// Shifts the frames of the links along their joint axes, parents before their children.
pub fn slide_frames(model: &mut Model<'_>) {
    let g = model.graph;
    let mut all = vec![Pose::identity(g); model.links.len()];
    for k in 0..model.links.len() {
        let Some(shift) = cheapest_shift(model, k) else { continue };
        let step = Pose { translation: shift, ..Pose::identity(g) };
        let back = step.inverse();
        let link = &mut model.links[k];
        link.placement = link.placement.compose_with(&step);
        link.inertia =
            Inertia::zero(g).sum_with_placed_inertia(&link.inertia, &back.rotation, back.translation);
        for child in model.links.iter_mut().filter(|c| c.parent.is_some_and(|p| p.0 == k)) {
            child.placement = back.compose_with(&child.placement);
        }
        all[k] = back;
    }
    move_contents_to_new_frames(model, &all);
}

/// Returns the shift of link `k` that saves most operations, if a shift saves any.
fn cheapest_shift<'g>(model: &Model<'g>, k: usize) -> Option<Vec3<'g>> {
    let link = &model.links[k];
    let Motion::Turn { axis, .. } = &link.motion else { return None };
    let a = index_of_parallel_axis(*axis)?;
    let children: Vec<&Link<'g>> =
        model.links.iter().filter(|c| c.parent.is_some_and(|p| p.0 == k)).collect();
    let has_joint_motion = |c: &&Link<'g>| !matches!(c.motion, Motion::Placed);
    let has_constant_translation = |c: &&Link<'g>| c.placement.translation.constant_components().is_some();
    let own = link.placement.translation;
    // Numeric frames are chosen by `place_frames`.
    if !children.iter().all(has_joint_motion)
        || has_constant_translation(&link) && children.iter().all(has_constant_translation)
    {
        return None;
    }
    let along = link.placement.rotation.vector_in_parent_axes(Vec3::coordinate_axis(model.graph, a));
    let cost_of_slide = |s: Expr<'g>| {
        let shift = Vec3::coordinate_axis(model.graph, a) * s;
        let lengths =
            children.iter().map(|c| nonzero_component_count(c.placement.translation - shift)).sum::<usize>();
        // The position of a joint on the ground costs nothing.
        let lengths =
            lengths + if link.parent.is_some() { nonzero_component_count(own + along * s) } else { 0 };
        let h = link.inertia.moment;
        let products = [(a + 1) % 3, (a + 2) % 3]
            .map(|i| usize::from(!(link.inertia.tensor.entry(a, i) - h[i] * s).is_zero()));
        LENGTH * lengths as f64 + PRODUCT * products.iter().sum::<usize>() as f64
    };
    let mut best = (model.graph.zero(), cost_of_slide(model.graph.zero()));
    let ends = children.iter().map(|c| c.placement.translation[a]);
    for s in ends.chain([-link.placement.rotation.vector_in_child_axes(own)[a]]) {
        let cost = cost_of_slide(s);
        if cost < best.1 {
            best = (s, cost);
        }
    }
    (!best.0.is_zero()).then(|| Vec3::coordinate_axis(model.graph, a) * best.0)
}

fn nonzero_component_count(v: Vec3<'_>) -> usize {
    v.0.iter().filter(|c| !c.is_zero()).count()
}
