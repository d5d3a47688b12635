//! Properties of elementary motions that the passes use: the freedom to choose a link's frame, the motion
//! relative to the new frame, and the mass properties that may be moved to the parent.

use super::number::{Vector, round_noise_to_zero};
use crate::expr::{Sym3, Vec3};
use crate::mechanism::{Coordinate, Inertia, Link, Motion, Pose};

/// Freedom with which a link's frame can be chosen without a change of the motion.
#[derive(Clone, Copy, Debug)]
pub enum FrameFreedom {
    /// The frame of the link cannot be changed.
    None,
    /// The frame may be shifted along, and rotated about, coordinate axis `k`.
    Turn {
        /// Index of the coordinate axis that is the joint axis.
        k: usize,
        /// True if an offset may be added to the joint's coordinate.
        offset: bool,
    },
    /// The frame of a sliding link may be chosen freely.
    Slide {
        /// Direction of the prismatic axis.
        along: Vector,
    },
}

/// Returns the freedom to choose the frame of a link with this motion, or `None` if it is fixed.
pub fn freedom_of_link_frame(motion: &Motion<'_>) -> Option<FrameFreedom> {
    match motion {
        Motion::Turn { axis, .. } => {
            index_of_parallel_axis(*axis).map(|k| FrameFreedom::Turn { k, offset: true })
        }
        Motion::Helix { axis, .. } => {
            index_of_parallel_axis(*axis).map(|k| FrameFreedom::Turn { k, offset: false })
        }
        Motion::Slide { axis, .. } => axis.constant_components().map(|along| FrameFreedom::Slide { along }),
        Motion::Ball { .. } | Motion::Free { .. } | Motion::Placed => None,
    }
}

/// Rewrites the motion of a link for its new frame, given relative to the old one and rotated about the
/// joint's axis by `offset`.
pub fn rewrite_motion_in_frame<'g>(motion: &mut Motion<'g>, frame: &Pose<'g>, offset: f64) {
    match motion {
        Motion::Turn { axis, coordinate } => shift_coordinate(coordinate, *axis, offset),
        Motion::Slide { axis, .. } => *axis = frame.rotation.vector_in_child_axes(*axis),
        // The frame is shifted along the axis and rotated about it, without an offset.
        Motion::Helix { .. } => {}
        // These frames cannot be chosen.
        Motion::Ball { .. } | Motion::Free { .. } | Motion::Placed => {}
    }
}

/// Adds an angle about the coordinate axis to the coordinate of a joint about `axis`.
fn shift_coordinate(coordinate: &mut Coordinate, axis: Vec3<'_>, offset: f64) {
    let negative = axis.constant_components().is_some_and(|n| n.iter().sum::<f64>() < 0.0);
    let angle = if negative { -offset } else { offset };
    let scale = coordinate.offset.abs() + angle.abs();
    coordinate.offset = round_noise_to_zero(coordinate.offset + angle, scale);
}

/// Convention that makes a moment of inertia of a revolute link vanish. The joint's axis is `k`; the others
/// are `k + 1` and `k + 2`, cyclically.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VanishingMomentConvention {
    /// Regrouping makes the moment of inertia about axis `k + 1` zero.
    First,
    /// Regrouping makes the moment of inertia about axis `k + 2` zero.
    Second,
    /// The moments about both add up to that about `k`, as for a body in the plane normal to `k`.
    #[default]
    Flat,
}

/// Returns the part of a link's mass properties that can be moved to the parent.
pub fn movable_inertia<'g>(link: &Link<'g>, gauge: VanishingMomentConvention) -> Option<Inertia<'g>> {
    let Inertia { mass, moment, tensor } = link.inertia;
    let nothing = Inertia::zero(mass.graph());
    match &link.motion {
        Motion::Turn { axis, .. } => {
            let k = index_of_parallel_axis(*axis)?;
            let mut along = nothing.moment;
            along.0[k] = moment[k];
            Some(Inertia { mass, moment: along, tensor: equalise_transverse_moments(&tensor, k, gauge) })
        }
        Motion::Slide { .. } => Some(Inertia { tensor, ..nothing }),
        Motion::Helix { axis, .. } => {
            let k = index_of_parallel_axis(*axis)?;
            Some(Inertia { tensor: equalise_transverse_moments(&tensor, k, gauge), ..nothing })
        }
        Motion::Ball { .. } => Some(Inertia { mass, ..nothing }),
        Motion::Free { .. } | Motion::Placed => None,
    }
}

/// Returns the inertia with equal moments about the two axes normal to `k` that makes the moment of the gauge
/// vanish.
fn equalise_transverse_moments<'g>(
    tensor: &Sym3<'g>,
    k: usize,
    gauge: VanishingMomentConvention,
) -> Sym3<'g> {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let d = &tensor.diagonal;
    let both = match gauge {
        VanishingMomentConvention::First => d[i],
        VanishingMomentConvention::Second => d[j],
        VanishingMomentConvention::Flat => (d[i] + d[j] - d[k]) * 0.5,
    };
    let mut out = Sym3::multiple_of_identity(both);
    out.diagonal[k] = both.zero();
    out
}

/// Returns the index of the coordinate axis to which a vector is parallel, if there is one.
pub fn index_of_parallel_axis(v: Vec3<'_>) -> Option<usize> {
    let k = (0..3).find(|k| !v[*k].is_zero())?;
    let others = v[(k + 1) % 3].is_zero() && v[(k + 2) % 3].is_zero();
    others.then_some(k)
}
