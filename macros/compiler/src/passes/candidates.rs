//! Frames worth trying for a link.

use super::motions::{Freedom, freedom};
use super::number::{
    Frame, IDENTITY, Mass, Vector, about, axis, clean, column, cross, dot, norm, times, transpose,
    transposed_times,
};
use crate::mechanism::{Link, Motion};
use std::f64::consts::FRAC_PI_2;

/// What the choice of a link's frame depends on.
pub struct Site {
    /// The parent link.
    pub parent: Option<usize>,
    /// The joint's frame on the parent, if in numbers.
    pub place: Option<Frame>,
    /// Which choice there is.
    pub freedom: Freedom,
    /// Mass properties, if in numbers.
    pub mass: Option<Mass>,
    /// How far along its axis the link's origin may be moved. The rounding of moments of inertia about the origin grows as
    /// the square of its distance, beside which what the link has of its own is lost: it stays within a few times the
    /// link's size.
    pub reach: f64,
}

impl Site {
    /// The site of a link of some size; where parameters cost nothing (`free`), its mass properties need not be numbers.
    pub fn of(link: &Link<'_>, size: f64, free_parameters: bool) -> Site {
        let (place, mass) = (Frame::of(&link.placement), Mass::of(&link.inertia));
        let free = freedom(&link.motion);
        let numeric = place.is_some() && (mass.is_some() || free_parameters);
        let place = place.filter(|_| !matches!(link.motion, Motion::Placed));
        Site {
            parent: link.parent.map(|p| p.0),
            place,
            freedom: free.filter(|_| numeric).unwrap_or(Freedom::None),
            mass,
            reach: REACH * size,
        }
    }

    /// The joint's axis in the parent's frame.
    fn direction(&self) -> Option<Vector> {
        let place = self.place.as_ref()?;
        match self.freedom {
            Freedom::Turn { k, .. } => Some(column(&place.rotation, k)),
            Freedom::Slide { along } => Some(times(&place.rotation, along)),
            Freedom::None => None,
        }
    }
}

/// Most angles and most shifts that are tried for one link.
const MAX_CANDIDATES: usize = 5;

/// How many times its size a link's origin may be moved. With the sine of the angle between them above its inverse the common
/// normal of two axes is within reach whatever their places are. At this distance rounding takes two digits at most off the
/// link's moments of inertia.
const REACH: f64 = 8.0;

/// Axes of which the sine is smaller are taken for parallel as well. No accuracy depends on it, only which frames are tried:
/// a placement is that of the frames that are chosen, whatever they are.
const NEARLY_PARALLEL: f64 = 1e-3;

/// Frames for link `k`, in its present one; that one is the first. `chosen` are the candidates of later links.
pub fn candidates(sites: &[Site], k: usize, chosen: &[Vec<Frame>]) -> Vec<Frame> {
    match sites[k].freedom {
        Freedom::None => vec![Frame::IDENTITY],
        Freedom::Turn { k: a, .. } => {
            let list = turning(sites, k, a, chosen);
            let mut places = Vec::new();
            for angle in &list.angles {
                let rotation = about(a, *angle);
                places.extend(
                    list.shifts.iter().map(|s| Frame { rotation, translation: axis(a).map(|c| c * s) }),
                );
            }
            places
        }
        Freedom::Slide { along } => sliding(sites, k, along),
    }
}

fn children(sites: &[Site], k: usize) -> impl Iterator<Item = usize> {
    (k + 1..sites.len()).filter(move |c| sites[*c].parent == Some(k))
}

/// Angles about and shifts along a link's axis.
struct Choices {
    /// The axis.
    a: usize,
    angles: Vec<f64>,
    shifts: Vec<f64>,
    /// Largest shift.
    reach: f64,
}

impl Choices {
    /// An axis of the frame along a vector's part normal to the joint's axis, if it has one. By right angles within
    /// 45°: those cost nothing.
    fn head(&mut self, v: Vector) {
        let (x, y) = (v[(self.a + 1) % 3], v[(self.a + 2) % 3]);
        if clean(x.hypot(y), norm(v)) == 0.0 {
            return;
        }
        let angle = y.atan2(x);
        let rest = angle - (angle / FRAC_PI_2).round() * FRAC_PI_2;
        push(&mut self.angles, clean(rest, 2.0 * angle.abs()), 1.0);
    }

    /// The origin at a distance that comes from lengths of size `scale`, if that is within reach.
    fn shift(&mut self, s: f64, scale: f64) {
        if s.abs() <= self.reach {
            push(&mut self.shifts, clean(s, scale), scale);
        }
    }
}

/// Adds a number that comes from numbers of size `scale`, unless it is there.
fn push(list: &mut Vec<f64>, x: f64, scale: f64) {
    if list.len() < MAX_CANDIDATES && !list.iter().any(|y| clean(x - y, 4.0 * (scale + x.abs())) == 0.0) {
        list.push(x);
    }
}

fn turning(sites: &[Site], k: usize, a: usize, chosen: &[Vec<Frame>]) -> Choices {
    let mut list = Choices { a, angles: vec![0.0], shifts: vec![0.0], reach: sites[k].reach };
    for c in children(sites, k) {
        if let Some(place) = &sites[c].place {
            towards(&mut list, &sites[c], place, &chosen[c]);
        }
    }
    if let Some(place) = &sites[k].place {
        // At the parent's origin along the axis, and with an axis normal to one of the parent's.
        let back = transposed_times(&place.rotation, place.translation);
        list.shift(-back[a], norm(back));
        let own = column(&place.rotation, a);
        for r in 0..3 {
            list.head(transposed_times(&place.rotation, cross(axis(r), own)));
        }
    }
    if let Some(mass) = &sites[k].mass {
        let normal = |v: Vector| std::array::from_fn(|i| if i == a { 0.0 } else { v[i] });
        let (moment, products) = (normal(mass.moment), normal(column(&mass.tensor, a)));
        list.head(moment);
        list.head(products);
        // Where the product of inertia along the first moment vanishes.
        if norm(moment) > 0.0 {
            list.shift(-dot(products, moment) / dot(moment, moment), 0.0);
        }
    }
    list
}

/// On the common normal with a child's axis, and along it.
fn towards(list: &mut Choices, child: &Site, place: &Frame, chosen: &[Frame]) {
    let (a, p) = (list.a, place.translation);
    let scale = norm(p);
    let direction = child.direction();
    if let Some(u) = direction {
        // Where the common normal meets the axis, from the parts of both vectors across it, of which no digits cancel. Of
        // axes that are parallel but for rounding it is anywhere, and most often out of reach.
        let across = |v: Vector| std::array::from_fn(|i| if i == a { 0.0 } else { v[i] });
        let (side, away) = (across(u), across(p));
        if clean(norm(side), 1.0) != 0.0 {
            list.shift(p[a] - u[a] * dot(away, side) / dot(side, side), scale);
            list.head(cross(axis(a), u));
        }
    }
    match direction {
        Some(u) if norm([u[(a + 1) % 3], u[(a + 2) % 3], 0.0]) > NEARLY_PARALLEL => {}
        Some(_) => {
            // Of parallel axes all normals are common: the child's own choices carry over.
            list.shift(p[a], scale);
            for choice in chosen {
                let ahead = times(&place.rotation, choice.translation);
                list.shift(p[a] + ahead[a], scale + norm(ahead));
            }
        }
        None => list.shift(p[a], scale),
    }
    list.head(p);
}

/// Frames for a sliding link: turned as its parent or a child, at their places or its own.
fn sliding(sites: &[Site], k: usize, slide: Vector) -> Vec<Frame> {
    let mut rotations = vec![IDENTITY];
    let mut points = vec![[0.0; 3]];
    if let Some(place) = &sites[k].place {
        rotations.push(transpose(&place.rotation));
        points.push(transposed_times(&place.rotation, place.translation).map(|c| -c));
    }
    for place in children(sites, k).filter_map(|c| sites[c].place.as_ref()) {
        rotations.push(place.rotation);
        points.push(place.translation);
    }
    // Sliding along a coordinate axis is cheap, so it stays so.
    let entries = |v: Vector| v.iter().filter(|c| clean(**c, 1.0) != 0.0).count();
    rotations.retain(|rotation| entries(transposed_times(rotation, slide)) <= entries(slide));
    rotations.truncate(MAX_CANDIDATES);
    points.truncate(MAX_CANDIDATES);
    let all = rotations.iter().flat_map(|r| points.iter().map(|p| Frame { rotation: *r, translation: *p }));
    all.collect()
}
