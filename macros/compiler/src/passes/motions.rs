//! What the passes know of elementary motions: how the frame of a link may be chosen, how its motion is seen from there, and what
//! of its mass properties may go to the parent.

use super::number::{Vector, clean};
use crate::expr::{Sym3, Vec3};
use crate::mechanism::{Coordinate, Inertia, Link, Motion, Pose};

/// How a link's frame can be chosen.
#[derive(Clone, Copy, Debug)]
pub enum Freedom {
    /// Not at all.
    None,
    /// Along and about coordinate axis `k`.
    Turn {
        /// The joint's axis.
        k: usize,
        /// The joint's zero can be shifted.
        offset: bool,
    },
    /// Anywhere.
    Slide {
        /// The joint's axis.
        along: Vector,
    },
}

/// How the frame of a link with this motion can be chosen.
pub fn freedom(motion: &Motion<'_>) -> Option<Freedom> {
    match motion {
        Motion::Turn { axis, .. } => coordinate_axis(*axis).map(|k| Freedom::Turn { k, offset: true }),
        Motion::Helix { axis, .. } => coordinate_axis(*axis).map(|k| Freedom::Turn { k, offset: false }),
        Motion::Slide { axis, .. } => axis.values().map(|along| Freedom::Slide { along }),
        Motion::Ball { .. } | Motion::Free { .. } | Motion::Placed => None,
    }
}

/// The motion of a link whose frame is this one in its old one, which is turned about the joint's axis by the angle `offset`.
pub fn seen_from<'g>(motion: &mut Motion<'g>, frame: &Pose<'g>, offset: f64) {
    match motion {
        Motion::Turn { axis, coordinate } => shift(coordinate, *axis, offset),
        Motion::Slide { axis, .. } => *axis = frame.rotation.to_child(*axis),
        // The frame is moved along and about the axis, without an offset.
        Motion::Helix { .. } => {}
        // These frames cannot be chosen.
        Motion::Ball { .. } | Motion::Free { .. } | Motion::Placed => {}
    }
}

/// The coordinate of a joint about `axis` with an angle about the coordinate axis added.
fn shift(coordinate: &mut Coordinate, axis: Vec3<'_>, offset: f64) {
    let negative = axis.values().is_some_and(|n| n.iter().sum::<f64>() < 0.0);
    let angle = if negative { -offset } else { offset };
    let scale = coordinate.offset.abs() + angle.abs();
    coordinate.offset = clean(coordinate.offset + angle, scale);
}

/// Which moment of inertia of a turning link vanishes. About an axis `k` the others are `k + 1` and `k + 2`, cyclic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gauge {
    /// That about axis `k + 1`.
    First,
    /// That about axis `k + 2`.
    Second,
    /// The moments about both add up to that about `k`: no mass is off the plane through the origin.
    #[default]
    Flat,
}

/// What of a link's mass properties acts as if it were fixed to the parent.
pub fn movable<'g>(link: &Link<'g>, gauge: Gauge) -> Option<Inertia<'g>> {
    let Inertia { mass, moment, tensor } = link.inertia;
    let nothing = Inertia::zero(mass.graph());
    match &link.motion {
        Motion::Turn { axis, .. } => {
            let k = coordinate_axis(*axis)?;
            let mut along = nothing.moment;
            along.0[k] = moment[k];
            Some(Inertia { mass, moment: along, tensor: transverse(&tensor, k, gauge) })
        }
        Motion::Slide { .. } => Some(Inertia { tensor, ..nothing }),
        Motion::Helix { axis, .. } => {
            let k = coordinate_axis(*axis)?;
            Some(Inertia { tensor: transverse(&tensor, k, gauge), ..nothing })
        }
        Motion::Ball { .. } => Some(Inertia { mass, ..nothing }),
        Motion::Free { .. } | Motion::Placed => None,
    }
}

/// Equal moments about the two axes normal to `k`.
fn transverse<'g>(tensor: &Sym3<'g>, k: usize, gauge: Gauge) -> Sym3<'g> {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let d = &tensor.diagonal;
    let both = match gauge {
        Gauge::First => d[i],
        Gauge::Second => d[j],
        Gauge::Flat => (d[i] + d[j] - d[k]) * 0.5,
    };
    let mut out = Sym3::scalar(both);
    out.diagonal[k] = both.zero();
    out
}

/// The coordinate axis that a vector points along (either way), if it does.
pub fn coordinate_axis(v: Vec3<'_>) -> Option<usize> {
    let k = (0..3).find(|k| !v[*k].is_zero())?;
    let others = v[(k + 1) % 3].is_zero() && v[(k + 2) % 3].is_zero();
    others.then_some(k)
}
