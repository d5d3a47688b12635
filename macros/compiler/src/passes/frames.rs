//! Choice of link frames with sparse placements. As with the frames of Denavit and Hartenberg (1955), a frame
//! may be shifted along and rotated about its joint's axis. Typically its origin is at the foot of the common
//! normal with a child's axis, an axis of the frame points along that normal, and the remaining rotation
//! about the joint's axis becomes an offset of the joint.
//!
//! The cost of a placement depends on the frames of both links, so the candidates of all links are compared
//! together by dynamic programming from the leaves to the root (Bellman 1957).

use super::candidates::{FrameChoiceData, candidate_frames};
use super::cost;
use super::motions::{FrameFreedom, rewrite_motion_in_frame};
use super::number::{NumericFrame, NumericMassProperties, norm};
use crate::mechanism::{Inertia, InputEffect, Link, Model, Pose, SumOfLinkVectors};

/// New frame that was chosen for one link.
#[derive(Clone, Copy)]
struct ChosenLinkFrame {
    /// New frame of the link relative to the old one.
    frame: NumericFrame,
    /// The joint's frame relative to the parent's new frame.
    placement: NumericFrame,
    /// Offset of the joint coordinate that a rotation of the frame about its axis adds.
    offset: f64,
}

/// Chooses and applies the frames of links with these sizes.
pub fn choose_link_frames(model: &mut Model<'_>, sizes: &[f64], free_parameters: bool) {
    let sites = frame_choice_data_of_links(model, sizes, free_parameters);
    let Some(frames) = choose_frames(&sites) else { return };
    let steps: Vec<Option<ChosenLinkFrame>> = (0..sites.len())
        .map(|k| {
            let parent = sites[k].parent.map_or(NumericFrame::IDENTITY, |p| frames[p]);
            let (_, placement, offset) = cost::cheapest_joint_placement(&sites[k], &parent, &frames[k])?;
            Some(ChosenLinkFrame { frame: frames[k], placement, offset })
        })
        .collect();
    apply_frame_choice(model, &sites, &steps);
}

/// Returns the size of every link: the maximum of the distances of its joint from the parent's origin plus
/// its radius of gyration, and of its children's joints, as far as these are numeric.
pub fn characteristic_link_sizes(model: &Model<'_>) -> Vec<f64> {
    let places: Vec<Option<NumericFrame>> =
        model.links.iter().map(|link| NumericFrame::from_pose(&link.placement)).collect();
    let distance_of_link_from_origin =
        |k: usize| places[k].as_ref().map_or(0.0, |place| norm(place.translation));
    let link_length_scale = |(k, link): (usize, &Link<'_>)| {
        let children =
            (k + 1..model.links.len()).filter(|c| model.links[*c].parent.is_some_and(|p| p.0 == k));
        let masses = NumericMassProperties::from_inertia(&link.inertia)
            .map_or(0.0, |mass| mass.root_mean_square_radius());
        children.map(distance_of_link_from_origin).fold(distance_of_link_from_origin(k) + masses, f64::max)
    };
    model.links.iter().enumerate().map(link_length_scale).collect()
}

/// Returns the data that the choice of frames depends on.
fn frame_choice_data_of_links(
    model: &Model<'_>,
    sizes: &[f64],
    free_parameters: bool,
) -> Vec<FrameChoiceData> {
    let frame_choice_data_of_link =
        |(link, size): (&Link<'_>, &f64)| FrameChoiceData::from_link(link, *size, free_parameters);
    let mut sites: Vec<FrameChoiceData> =
        model.links.iter().zip(sizes).map(frame_choice_data_of_link).collect();
    for k in 0..sites.len() {
        // A placement that is not numeric fixes the frames on both sides.
        if let (None, Some(p)) = (&sites[k].place, sites[k].parent) {
            sites[p].freedom = FrameFreedom::None;
        }
    }
    sites
}

/// Returns the cheapest frame of every link relative to its present frame, or `None` if no frame can be
/// chosen.
fn choose_frames(sites: &[FrameChoiceData]) -> Option<Vec<NumericFrame>> {
    if sites.iter().all(|site| matches!(site.freedom, FrameFreedom::None)) {
        return None;
    }
    let mut choices: Vec<Vec<NumericFrame>> = vec![Vec::new(); sites.len()];
    let mut costs: Vec<Vec<f64>> = vec![Vec::new(); sites.len()];
    for k in (0..sites.len()).rev() {
        choices[k] = candidate_frames(sites, k, &choices);
        costs[k] = choices[k].iter().map(|frame| cost::cost_of_mass_properties(&sites[k], frame)).collect();
        for child in (k + 1..sites.len()).filter(|c| sites[*c].parent == Some(k)) {
            for (c, frame) in choices[k].iter().enumerate() {
                costs[k][c] += best_frame_candidate(&sites[child], frame, &choices[child], &costs[child]).1;
            }
        }
    }
    let mut frames: Vec<NumericFrame> = Vec::with_capacity(sites.len());
    for k in 0..sites.len() {
        let parent = sites[k].parent.map_or(NumericFrame::IDENTITY, |p| frames[p]);
        frames.push(choices[k][best_frame_candidate(&sites[k], &parent, &choices[k], &costs[k]).0]);
    }
    Some(frames)
}

/// Returns the index of the best candidate of a link for a parent's frame, and its cost including all
/// descendants.
fn best_frame_candidate(
    site: &FrameChoiceData,
    parent: &NumericFrame,
    choices: &[NumericFrame],
    costs: &[f64],
) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (c, frame) in choices.iter().enumerate() {
        let own = cost::cheapest_joint_placement(site, parent, frame).map_or(0.0, |(cost, ..)| cost);
        // The first of equal candidates wins: it is the present frame, if that is among them.
        if own + costs[c] < best.1 - 1e-9 {
            best = (c, own + costs[c]);
        }
    }
    best
}

fn apply_frame_choice<'g>(
    model: &mut Model<'g>,
    sites: &[FrameChoiceData],
    steps: &[Option<ChosenLinkFrame>],
) {
    let g = model.graph;
    for (link, (site, step)) in model.links.iter_mut().zip(sites.iter().zip(steps)) {
        let Some(step) = step else { continue };
        link.placement = step.placement.frame_to_pose(g);
        if matches!(site.freedom, FrameFreedom::None) {
            continue;
        }
        link.inertia = match &site.mass {
            Some(mass) => mass.mass_properties_in_frame(&step.frame).inertia_expressions(g),
            None => {
                let back = step.frame.frame_to_pose(g).inverse();
                Inertia::zero(g).sum_with_placed_inertia(&link.inertia, &back.rotation, back.translation)
            }
        };
        rewrite_motion_in_frame(&mut link.motion, &step.frame.frame_to_pose(g), step.offset);
    }
    let back =
        steps.iter().map(|s| s.as_ref().map_or(Pose::identity(g), |s| s.frame.frame_to_pose(g).inverse()));
    move_contents_to_new_frames(model, &back.collect::<Vec<_>>());
}

/// Transforms everything that is fixed in the links to their new frames; `back` holds the old frames relative
/// to the new ones.
pub fn move_contents_to_new_frames<'g>(model: &mut Model<'g>, back: &[Pose<'g>]) {
    // All fields are listed, so that rustc asks about each new one. Expressions of the state, such as those
    // of loads and outputs, do not depend on the link frames any more; the drawing is placed in named frames.
    let Model {
        graph: _,
        kinematic: _,
        name: _,
        place: _,
        parameters: _,
        gravity: _,
        friction_speed: _,
        links: _,
        still: _,
        time: _,
        velocity_inputs: _,
        charts: _,
        gradients: _,
        configuration: _,
        initial_configuration: _,
        velocities: _,
        inputs,
        frames,
        springs: _,
        dashpots: _,
        frictions: _,
        potentials: _,
        dissipations: _,
        loads: _,
        acceleration_forces: _,
        passive: _,
        constraints: _,
        redundant: _,
        dependent: _,
        solved: _,
        freedom: _,
        inertances: _,
        outputs: _,
        released: _,
        drawing: _,
        heights: _,
        limits: _,
        equilibria: _,
        contacts: _,
        polytopes: _,
        requirements: _,
        units: _,
        speeds: _,
    } = model;
    for frame in frames {
        if let Some(link) = frame.link {
            frame.pose = back[link.0].compose_with(&frame.pose);
        }
    }
    for (_, input) in inputs {
        match input {
            InputEffect::Named | InputEffect::Coordinate(_) | InputEffect::Sum(..) => {}
            InputEffect::Force { link, point, along } => {
                *point = back[link.0].transform_point(*point);
                rotate_direction(along, back);
            }
            InputEffect::Torque { about, .. } => rotate_direction(about, back),
        }
    }
}

fn rotate_direction<'g>(direction: &mut SumOfLinkVectors<'g>, back: &[Pose<'g>]) {
    for (link, v) in direction {
        if let Some(link) = link {
            *v = back[link.0].rotation.vector_in_parent_axes(*v);
        }
    }
}
