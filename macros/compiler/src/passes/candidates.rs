//! Candidates for the frame of a link, among which a pass chooses.

use super::motions::{FrameFreedom, freedom_of_link_frame};
use super::number::{
    IDENTITY, NumericFrame, NumericMassProperties, Vector, axis_rotation, column, cross, dot,
    matrix_times_vector, multiply_transposed, norm, round_noise_to_zero, transpose, unit_axis,
};
use crate::mechanism::{Link, Motion};
use std::f64::consts::FRAC_PI_2;

/// Data that the choice of a link's frame depends on.
pub struct FrameChoiceData {
    /// Index of the parent link; `None` for the ground.
    pub parent: Option<usize>,
    /// Frame of the joint on the parent link, if its numbers are constant.
    pub place: Option<NumericFrame>,
    /// Freedom to choose the frame of the link.
    pub freedom: FrameFreedom,
    /// Mass properties of the link, if they are constant numbers.
    pub mass: Option<NumericMassProperties>,
    /// Maximum distance by which the link's origin may be moved along its axis: a few times the link's size.
    /// The rounding error of moments of inertia about the origin grows as the square of this
    /// distance.
    pub reach: f64,
}

impl FrameChoiceData {
    /// Returns the data for the choice of the frame of a link of a given size. With `free_parameters`, its
    /// mass properties need not be numeric.
    pub fn from_link(link: &Link<'_>, size: f64, free_parameters: bool) -> FrameChoiceData {
        let (place, mass) =
            (NumericFrame::from_pose(&link.placement), NumericMassProperties::from_inertia(&link.inertia));
        let free = freedom_of_link_frame(&link.motion);
        let numeric = place.is_some() && (mass.is_some() || free_parameters);
        let place = place.filter(|_| !matches!(link.motion, Motion::Placed));
        FrameChoiceData {
            parent: link.parent.map(|p| p.0),
            place,
            freedom: free.filter(|_| numeric).unwrap_or(FrameFreedom::None),
            mass,
            reach: REACH * size,
        }
    }

    /// Returns the joint's axis in the parent's frame.
    fn joint_axis(&self) -> Option<Vector> {
        let place = self.place.as_ref()?;
        match self.freedom {
            FrameFreedom::Turn { k, .. } => Some(column(&place.rotation, k)),
            FrameFreedom::Slide { along } => Some(matrix_times_vector(&place.rotation, along)),
            FrameFreedom::None => None,
        }
    }
}

/// Maximum numbers of angles and of shifts that are tried for one link.
const MAX_CANDIDATES: usize = 5;

/// Maximum distance by which a link's origin may be moved, in units of its size. The common normal of two
/// axes is within this distance if the sine of the angle between them exceeds its inverse. At this distance
/// rounding costs the link's moments of inertia at most two digits.
const REACH: f64 = 8.0;

/// Sine of the angle below which axes are also treated as parallel. Only the choice of candidates depends on
/// it: placements are computed exactly for any chosen frames.
const NEARLY_PARALLEL: f64 = 1e-3;

/// Returns candidate frames of link `k`, relative to its present frame, which comes first. `chosen` holds the
/// candidates of later links.
pub fn candidate_frames(
    sites: &[FrameChoiceData],
    k: usize,
    chosen: &[Vec<NumericFrame>],
) -> Vec<NumericFrame> {
    match sites[k].freedom {
        FrameFreedom::None => vec![NumericFrame::IDENTITY],
        FrameFreedom::Turn { k: a, .. } => {
            let list = frame_choices_of_revolute_joint(sites, k, a, chosen);
            let mut places = Vec::new();
            for angle in &list.angles {
                let rotation = axis_rotation(a, *angle);
                places.extend(
                    list.shifts
                        .iter()
                        .map(|s| NumericFrame { rotation, translation: unit_axis(a).map(|c| c * s) }),
                );
            }
            places
        }
        FrameFreedom::Slide { along } => candidates_of_sliding_link(sites, k, along),
    }
}

fn indices_of_child_links(sites: &[FrameChoiceData], k: usize) -> impl Iterator<Item = usize> {
    (k + 1..sites.len()).filter(move |c| sites[*c].parent == Some(k))
}

/// Candidate angles and shifts of a link's frame about and along the joint axis.
struct CandidateAnglesAndShifts {
    /// Index of the coordinate axis about which the frame is rotated.
    a: usize,
    angles: Vec<f64>,
    shifts: Vec<f64>,
    /// Maximum shift of the link frame along the axis, m.
    reach: f64,
}

impl CandidateAnglesAndShifts {
    /// Adds the angle, reduced by right angles to within 45°, that aligns an axis of the frame with the
    /// component of a vector normal to the joint's axis. Right angles cost nothing.
    fn add_alignment_angle(&mut self, v: Vector) {
        let (x, y) = (v[(self.a + 1) % 3], v[(self.a + 2) % 3]);
        if round_noise_to_zero(libm::hypot(x, y), norm(v)) == 0.0 {
            return;
        }
        let angle = libm::atan2(y, x);
        let rest = angle - (angle / FRAC_PI_2).round() * FRAC_PI_2;
        push_if_distinct(&mut self.angles, round_noise_to_zero(rest, 2.0 * angle.abs()), 1.0);
    }

    /// Adds a shift of the origin, computed from lengths of magnitude `scale`, if it is within reach.
    fn add_shift(&mut self, s: f64, scale: f64) {
        if s.abs() <= self.reach {
            push_if_distinct(&mut self.shifts, round_noise_to_zero(s, scale), scale);
        }
    }
}

/// Adds a number, computed from numbers of magnitude `scale`, unless it is in the list.
fn push_if_distinct(list: &mut Vec<f64>, x: f64, scale: f64) {
    if list.len() < MAX_CANDIDATES
        && !list.iter().any(|y| round_noise_to_zero(x - y, 4.0 * (scale + x.abs())) == 0.0)
    {
        list.push(x);
    }
}

fn frame_choices_of_revolute_joint(
    sites: &[FrameChoiceData],
    k: usize,
    a: usize,
    chosen: &[Vec<NumericFrame>],
) -> CandidateAnglesAndShifts {
    let mut list =
        CandidateAnglesAndShifts { a, angles: vec![0.0], shifts: vec![0.0], reach: sites[k].reach };
    for c in indices_of_child_links(sites, k) {
        if let Some(place) = &sites[c].place {
            add_alignment_with_child(&mut list, &sites[c], place, &chosen[c]);
        }
    }
    if let Some(place) = &sites[k].place {
        // The point nearest to the parent's origin, and orientations with an axis normal to one of the
        // parent's.
        let back = multiply_transposed(&place.rotation, place.translation);
        list.add_shift(-back[a], norm(back));
        let own = column(&place.rotation, a);
        for r in 0..3 {
            list.add_alignment_angle(multiply_transposed(&place.rotation, cross(unit_axis(r), own)));
        }
    }
    if let Some(mass) = &sites[k].mass {
        let component_normal_to_axis = |v: Vector| std::array::from_fn(|i| if i == a { 0.0 } else { v[i] });
        let (moment, products) =
            (component_normal_to_axis(mass.moment), component_normal_to_axis(column(&mass.tensor, a)));
        list.add_alignment_angle(moment);
        list.add_alignment_angle(products);
        // The shift at which the product of inertia along the first moment vanishes.
        if norm(moment) > 0.0 {
            list.add_shift(-dot(products, moment) / dot(moment, moment), 0.0);
        }
    }
    list
}

/// Adds the shift to the common normal with a child's axis, and the angle that points along it.
fn add_alignment_with_child(
    list: &mut CandidateAnglesAndShifts,
    child: &FrameChoiceData,
    place: &NumericFrame,
    chosen: &[NumericFrame],
) {
    let (a, p) = (list.a, place.translation);
    let scale = norm(p);
    let direction = child.joint_axis();
    if let Some(u) = direction {
        // The foot of the common normal, computed from the components of both vectors across the axis,
        // without cancellation. For axes that are parallel up to rounding it is arbitrary, and mostly out of
        // reach.
        let component_normal_to_axis = |v: Vector| std::array::from_fn(|i| if i == a { 0.0 } else { v[i] });
        let (side, away) = (component_normal_to_axis(u), component_normal_to_axis(p));
        if round_noise_to_zero(norm(side), 1.0) != 0.0 {
            list.add_shift(p[a] - u[a] * dot(away, side) / dot(side, side), scale);
            list.add_alignment_angle(cross(unit_axis(a), u));
        }
    }
    match direction {
        Some(u) if norm([u[(a + 1) % 3], u[(a + 2) % 3], 0.0]) > NEARLY_PARALLEL => {}
        Some(_) => {
            // Parallel axes have all normals in common, so the child's candidates are candidates here.
            list.add_shift(p[a], scale);
            for choice in chosen {
                let ahead = matrix_times_vector(&place.rotation, choice.translation);
                list.add_shift(p[a] + ahead[a], scale + norm(ahead));
            }
        }
        None => list.add_shift(p[a], scale),
    }
    list.add_alignment_angle(p);
}

/// Returns candidate frames of a sliding link: oriented like itself, its parent or a child, and at their
/// positions.
fn candidates_of_sliding_link(sites: &[FrameChoiceData], k: usize, slide: Vector) -> Vec<NumericFrame> {
    let mut rotations = vec![IDENTITY];
    let mut points = vec![[0.0; 3]];
    if let Some(place) = &sites[k].place {
        rotations.push(transpose(&place.rotation));
        points.push(multiply_transposed(&place.rotation, place.translation).map(|c| -c));
    }
    for place in indices_of_child_links(sites, k).filter_map(|c| sites[c].place.as_ref()) {
        rotations.push(place.rotation);
        points.push(place.translation);
    }
    // Sliding along a coordinate axis is cheap and is preserved.
    let count_nonzero_components =
        |v: Vector| v.iter().filter(|c| round_noise_to_zero(**c, 1.0) != 0.0).count();
    rotations.retain(|rotation| {
        count_nonzero_components(multiply_transposed(rotation, slide)) <= count_nonzero_components(slide)
    });
    rotations.truncate(MAX_CANDIDATES);
    points.truncate(MAX_CANDIDATES);
    let all =
        rotations.iter().flat_map(|r| points.iter().map(|p| NumericFrame { rotation: *r, translation: *p }));
    all.collect()
}
