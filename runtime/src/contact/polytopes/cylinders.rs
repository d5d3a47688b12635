//! Features of cylinders with two end faces, in contact with each other and with hulls.
//!
//! A cylinder is a line segment with a radius: its side is at this distance from the segment, and its rims
//! are circles around the ends of the segment. The contact is described by two kinds of features, which are
//! constant in the axes of their bodies:
//!
//! - A face of one body, and points of the other body on it. The opposite end of a cylinder is represented by
//!   its lowest point and a polygon of points of its rim, its side by both ends of its lowest line.
//! - Two [curves](super::curves): rims, axes of sides, edges or vertices, where the bodies are closest.
//!
//! The separation of the bodies along a direction is the difference of their support functions. Its maximum
//! over all directions is the signed distance.
//!
//! 1. The face with the largest separation is found, as for polytopes. If the lowest point of the other body
//!    is above this face and the bodies do not overlap, the separation is the distance.
//! 2. Otherwise a [search](super::search) climbs to a maximum of the separation. Near this direction, each
//!    body is a segment with two ends: an edge with its vertices, or a side with its rims. Newton's method
//!    finds the closest points of all nine pairs of a segment or end with a segment or end. The pair with the
//!    largest separation along its normal determines the contact.
//! 3. Parallel segments touch at two points, at the ends of their common part.

use super::axes::{FaceAxis, SeparationBounds, best_face_axis};
use super::clip::opposite_face;
use super::curves::{ClosestCurves, Curve};
use super::search::{climb_to_separation_maximum, separation_along_normal};
use super::{PlacedPolytope, TIE_TOLERANCE, components, constant};
use crate::Real;
use nalgebra::Vector3;

/// Number of features of a pair that are not those of a point.
pub(super) const HEAD: usize = 6;
/// Numbers of contact points on curves, and of points fixed in the body opposite to a face.
const CURVED_POINTS: usize = 3;
const FIXED_POINTS: usize = 5;
/// Numbers of features of a point on curves, and of a point fixed in its body.
const CURVED: usize = 23;
const FIXED: usize = 4;
/// Number of features of a pair.
pub(super) const FEATURES: usize = HEAD + CURVED_POINTS * CURVED + FIXED_POINTS * FIXED;

/// Number of points that represent a rim, and sine and cosine of the angle between two of them.
const RIM_POINTS: usize = 16;
const RIM_STEP: [f64; 2] = [0.382_683_432_365_089_8, 0.923_879_532_511_286_7];
/// Maximum number of points of a clipped face.
const MAX_POINTS: usize = 64;
/// Sine of the angle between a face and a parallel end below which no point of the rim is the lowest.
const FLAT: f64 = 1e-7;
/// Sine of the angle between a face and an axis above which the end of a cylinder is opposite to the face.
const UPRIGHT: f64 = 0.7;
/// Cosine of the angle below which segments are treated as crossing, and touch at one point.
const ALIGNED: f64 = 0.9;
/// Height below the highest vertex of a hull above which edges are examined, relative to the size.
const NEARLY_HIGHEST: f64 = 1e-4;

/// Contact point on two curves.
#[derive(Clone, Copy)]
struct CurveContactPoint<T> {
    /// One for a point on a face.
    on_face: T,
    /// Sign with which the cross product of both tangents points towards the first body; zero for none.
    side: T,
    /// One if the normal is along the shortest connection of both curves.
    is_closest: T,
    curves: [Curve<T>; 2],
}

/// List of points with a maximum length.
#[derive(Clone, Copy)]
struct Points<T> {
    places: [Vector3<T>; MAX_POINTS],
    count: usize,
}

impl<T: Real> Points<T> {
    fn new() -> Self {
        Points { places: [Vector3::zeros(); MAX_POINTS], count: 0 }
    }

    fn push(&mut self, place: Vector3<T>) {
        if let Some(slot) = self.places.get_mut(self.count) {
            *slot = place;
            self.count += 1;
        }
    }

    fn places(&self) -> &[Vector3<T>] {
        self.places.get(..self.count).unwrap_or(&self.places)
    }

    /// Returns the points behind a plane, and those where the polygon crosses it.
    fn polygon_behind_plane(&self, outward: &Vector3<T>, limit: T) -> Self {
        let mut clipped = Points::new();
        let places = self.places();
        for (k, place) in places.iter().enumerate() {
            let Some(next) = places.get(k + 1).or(places.first()) else { continue };
            let [here, there] = [place, next].map(|place| outward.dot(place) - limit);
            if here <= T::zero() {
                clipped.push(*place);
            }
            if (here <= T::zero()) != (there <= T::zero()) {
                clipped.push(place + (next - place) * (here / (here - there)));
            }
        }
        clipped
    }
}

/// Selected features of a contact.
struct SelectedPoints<T> {
    curved: [Option<CurveContactPoint<T>>; CURVED_POINTS],
    /// Points of the body opposite to the face.
    fixed: Points<T>,
}

impl<T: Real> SelectedPoints<T> {
    /// Adds a contact point; without effect if there are too many.
    fn push(&mut self, point: CurveContactPoint<T>) {
        if let Some(slot) = self.curved.iter_mut().find(|slot| slot.is_none()) {
            *slot = Some(point);
        }
    }
}

/// Points of a body opposite to a face.
struct PointsOppositeFace<T> {
    /// Lowest point or lowest line of a cylinder, as points on circles around its axis.
    moving: [Option<Curve<T>>; 2],
    fixed: Points<T>,
    /// Whether a point above the face has the separation of the face.
    has_lowest: bool,
}

/// Writes the features of a pair with a cylinder. `height` decides between faces of equal separation.
pub(super) fn write_features<T: Real>(
    first: &PlacedPolytope<'_, T>,
    second: &PlacedPolytope<'_, T>,
    height: T,
    into: &mut [T],
) {
    let size = constant::<T>(first.shape.size + second.shape.size);
    let tolerance = size * constant(TIE_TOLERANCE);
    let bounds = SeparationBounds::bounds_from_centers(first, second);
    let Some(face) = best_face_axis(first, second, height, tolerance, &bounds) else { return };
    let (own, other) = if face.is_second { (second, first) } else { (first, second) };
    let opposite = points_opposite_to_face(own, other, face.face, tolerance);
    let curves = match opposite.has_lowest && face.distance >= -tolerance {
        true => None,
        false => closest_curves(first, second, &face, size),
    };
    let curves = curves.filter(|(best, ..)| {
        let is_larger = best.separation_score() > face.distance + tolerance;
        is_larger || (!opposite.has_lowest && best.gap - best.separation <= tolerance)
    });
    let mut selected = SelectedPoints { curved: [None; CURVED_POINTS], fixed: opposite.fixed };
    let mut least = -size * constant(1e6);
    if let Some((best, others)) = &curves {
        least = best.separation - face.distance.min(T::zero());
        for closest in [Some(best), others[0].as_ref(), others[1].as_ref()].into_iter().flatten() {
            let (side, is_closest, curves) = (closest.side, closest.is_closest, closest.curves);
            selected.push(CurveContactPoint { on_face: T::zero(), side, is_closest, curves });
        }
    }
    let nowhere = Curve::vertex(Vector3::zeros());
    let contact_point_on_face = |curve: Curve<T>| CurveContactPoint {
        on_face: T::one(),
        side: T::zero(),
        is_closest: T::zero(),
        curves: if face.is_second { [curve, nowhere] } else { [nowhere, curve] },
    };
    opposite.moving.into_iter().flatten().for_each(|curve| selected.push(contact_point_on_face(curve)));
    if curves.is_none() && !opposite.has_lowest {
        // Rounding errors hide the point that has the separation of the face.
        selected.push(contact_point_on_face(Curve::vertex(other.support(&-own.normal(face.face)))));
    }
    write_selected_features((first, second), &face, least, selected, contact_point_on_face, into);
}

/// Writes the face, the points on curves and the points fixed in the body opposite to the face. Points that
/// are too many are omitted evenly around the face.
fn write_selected_features<T: Real>(
    (first, second): (&PlacedPolytope<'_, T>, &PlacedPolytope<'_, T>),
    face: &FaceAxis<T>,
    least: T,
    mut selected: SelectedPoints<T>,
    on_face: impl Fn(Curve<T>) -> CurveContactPoint<T>,
    into: &mut [T],
) {
    let (own, other) = if face.is_second { (second, first) } else { (first, second) };
    let normal = own.rotation.tr_mul(&own.normal(face.face));
    let offset = own.offset(face.face) - own.normal(face.face).dot(&own.position);
    let is_second = if face.is_second { T::one() } else { T::zero() };
    let head = [is_second, least].into_iter().chain(components(normal)).chain([offset]);
    into.iter_mut().zip(head).for_each(|(into, value)| *into = value);
    let free = selected.curved.iter().filter(|slot| slot.is_none()).count() + FIXED_POINTS;
    let count = selected.fixed.count;
    let places = selected.fixed;
    let mut slots = into.get_mut(HEAD + CURVED_POINTS * CURVED..).unwrap_or(&mut []).chunks_exact_mut(FIXED);
    let written = count.min(free);
    for k in 0..written {
        let Some(place) = (k * count).checked_div(written).and_then(|k| places.places().get(k)) else {
            continue;
        };
        if let Some(slot) = slots.next() {
            let values = [T::one()].into_iter().chain(components(other.position_in_body_axes(place)));
            slot.iter_mut().zip(values).for_each(|(into, value)| *into = value);
        } else {
            selected.push(on_face(Curve::vertex(*place)));
        }
    }
    let slots = into.get_mut(HEAD..).unwrap_or(&mut []).chunks_exact_mut(CURVED);
    for (slot, point) in slots.zip(selected.curved.iter().flatten()) {
        let [a, b] = point.curves;
        let values = [point.on_face, point.side, point.is_closest, a.radius, b.radius].into_iter();
        let vectors = [(first, a), (second, b)].into_iter().flat_map(|(body, curve)| {
            let directions = [curve.tangent, curve.curvature].map(|v| body.rotation.tr_mul(&v));
            [body.position_in_body_axes(&curve.point), directions[0], directions[1]]
                .into_iter()
                .flat_map(components)
        });
        slot.iter_mut().zip(values.chain(vectors)).for_each(|(into, value)| *into = value);
    }
}

/// Returns the corners of a face in counter-clockwise order about its normal; points of the rim for the end
/// of a cylinder.
fn corners<T: Real>(shape: &PlacedPolytope<'_, T>, face: usize) -> Points<T> {
    let mut points = Points::new();
    if shape.shape.radius <= 0.0 {
        let corners = shape.shape.faces.get(face).map_or(&[][..], |face| face.corners);
        corners.iter().for_each(|k| points.push(shape.vertex(*k)));
        return points;
    }
    let (normal, radius) = (shape.normal(face), constant::<T>(shape.shape.radius));
    let center = shape.vertex(face as u8);
    let mut along = shape.rotation * perpendicular(&shape.rotation.tr_mul(&normal));
    let mut across = normal.cross(&along);
    let (sine, cosine) = (constant::<T>(RIM_STEP[0]), constant::<T>(RIM_STEP[1]));
    for _ in 0..RIM_POINTS {
        points.push(center + along * radius);
        (along, across) = (along * cosine + across * sine, across * cosine - along * sine);
    }
    points
}

/// Returns a unit vector that is perpendicular to a unit vector.
fn perpendicular<T: Real>(axis: &Vector3<T>) -> Vector3<T> {
    let other = if axis.x.abs() < constant(UPRIGHT) { Vector3::x() } else { Vector3::y() };
    axis.cross(&other).normalize()
}

/// Whether a point is above a face: within its sides, up to a tolerance.
fn is_above_face<T: Real>(
    shape: &PlacedPolytope<'_, T>,
    face: usize,
    place: &Vector3<T>,
    tolerance: T,
) -> bool {
    let normal = shape.normal(face);
    if shape.shape.radius > 0.0 {
        let arm = place - shape.vertex(face as u8);
        return (arm - normal * normal.dot(&arm)).norm() <= constant::<T>(shape.shape.radius) + tolerance;
    }
    side_planes(&corners(shape, face), &normal)
        .all(|(outward, limit)| outward.dot(place) <= limit + tolerance)
}

/// Returns the planes of the sides of a face: unit normals out of the face, and offsets.
fn side_planes<T: Real>(corners: &Points<T>, normal: &Vector3<T>) -> impl Iterator<Item = (Vector3<T>, T)> {
    let (corners, normal) = (*corners, *normal);
    (0..corners.count).filter_map(move |k| {
        let start = corners.places().get(k)?;
        let end = corners.places().get(k + 1).or(corners.places().first())?;
        let outward = (end - start).cross(&normal).normalize();
        Some((outward, outward.dot(start)))
    })
}

/// Returns the points of a body that are opposite to a face and above it.
fn points_opposite_to_face<T: Real>(
    own: &PlacedPolytope<'_, T>,
    other: &PlacedPolytope<'_, T>,
    face: usize,
    tolerance: T,
) -> PointsOppositeFace<T> {
    let (normal, offset) = (own.normal(face), own.offset(face));
    let height = |place: &Vector3<T>| normal.dot(place) - offset;
    let lowest = other.support(&-normal);
    let mut has_lowest = is_above_face(own, face, &lowest, tolerance);
    let mut moving = [None; 2];
    let axis = other.direction(0);
    let cosine = axis.dot(&normal);
    let (is_round, is_upright) = (other.shape.radius > 0.0, cosine.abs() > constant(UPRIGHT));
    let mut fixed = if is_round && is_upright {
        corners(other, usize::from(cosine < T::zero()))
    } else if is_round {
        let mut line = Points::new();
        let (start, end) = (other.vertex(0), other.vertex(1));
        let arm = other.offset_from_cylinder_axis(&lowest);
        line.push(start + arm);
        line.push(end + arm);
        line
    } else {
        opposite_face(other, &normal, tolerance).map_or_else(Points::new, |k| corners(other, k))
    };
    for (outward, limit) in side_planes(&corners(own, face), &normal) {
        fixed = fixed.polygon_behind_plane(&outward, limit + tolerance);
    }
    let reached = height(&lowest) + tolerance;
    has_lowest |= fixed.places().iter().any(|place| height(place) <= reached);
    if is_round && is_upright {
        let is_tilted = (T::one() - cosine * cosine).max(T::zero()).sqrt() > constant(FLAT);
        let is_used = is_tilted && is_above_face(own, face, &lowest, tolerance);
        moving[0] = is_used.then(|| Curve::circle(other, lowest));
    } else if is_round {
        // The ends of the part of the lowest line that is above the face.
        let position_along_axis = |place: &Vector3<T>| axis.dot(place);
        let compare_along_axis = |a: &&Vector3<T>, b: &&Vector3<T>| {
            position_along_axis(a).partial_cmp(&position_along_axis(b)).unwrap_or(core::cmp::Ordering::Equal)
        };
        let places = fixed.places().iter();
        let ends = [places.clone().min_by(compare_along_axis), places.max_by(compare_along_axis)];
        moving = ends.map(|end| end.map(|end| Curve::circle(other, *end)));
        let lower = moving.get_mut(usize::from(cosine < T::zero()));
        if let (Some(lower), true) = (lower, is_above_face(own, face, &lowest, tolerance)) {
            *lower = Some(Curve::circle(other, lowest));
        }
        fixed.count = 0;
    } else {
        rotate_to_lowest(&mut fixed, height);
        let is_listed = fixed.places().first().is_some_and(|place| height(place) <= reached);
        let is_hidden = !is_listed && is_above_face(own, face, &lowest, tolerance);
        moving[0] = is_hidden.then(|| Curve::vertex(lowest));
    }
    PointsOppositeFace { moving, fixed, has_lowest }
}

/// Rotates the order of points so that the lowest is the first.
fn rotate_to_lowest<T: Real>(points: &mut Points<T>, height: impl Fn(&Vector3<T>) -> T) {
    let heights = points.places().iter().map(height).enumerate();
    let lowest = heights.reduce(|a, b| if b.1 < a.1 { b } else { a });
    let count = points.count;
    if let (Some((k, _)), Some(places)) = (lowest, points.places.get_mut(..count)) {
        places.rotate_left(k.min(count));
    }
}

/// Body near a direction: a segment with two ends.
struct SegmentWithEnds<T> {
    /// The line of the segment and both ends.
    curves: [Curve<T>; 3],
    half_length: T,
}

impl<T: Real> SegmentWithEnds<T> {
    /// Returns the axis of a cylinder with both rims, which are evaluated near their highest points along a
    /// direction.
    fn cylinder_axis_and_rims(shape: &PlacedPolytope<'_, T>, along: &Vector3<T>) -> Self {
        let [start, end] = [shape.vertex(0), shape.vertex(1)];
        let axis = shape.direction(0);
        let across = along - axis * axis.dot(along);
        let norm = across.norm();
        let arm = if norm > constant(FLAT) { across / norm } else { perpendicular(&axis) };
        let arm = arm * constant::<T>(shape.shape.radius);
        let half = constant::<T>(0.5);
        let line = Curve::line((start + end) * half, axis, constant(shape.shape.radius));
        let rims = [start, end].map(|center| Curve::circle(shape, center + arm));
        SegmentWithEnds { curves: [line, rims[0], rims[1]], half_length: (end - start).norm() * half }
    }

    /// Returns an edge of a hull with both vertices.
    fn edge(shape: &PlacedPolytope<'_, T>, edge: usize) -> Option<Self> {
        let [start, end] = shape.shape.edges.get(edge)?.ends.map(|k| shape.vertex(k));
        let half = constant::<T>(0.5);
        let line = Curve::line((start + end) * half, shape.direction(edge), T::zero());
        let curves = [line, Curve::vertex(start), Curve::vertex(end)];
        Some(SegmentWithEnds { curves, half_length: (end - start).norm() * half })
    }

    fn direction(&self) -> Vector3<T> {
        self.curves[0].tangent
    }

    /// Whether a point of the line belongs to the segment.
    fn contains(&self, point: &Vector3<T>, tolerance: T) -> bool {
        let position = self.direction().dot(&(point - self.curves[0].point));
        position.abs() <= self.half_length + tolerance
    }
}

/// Closest curves of two bodies, and up to two more pairs of curves of aligned segments.
type SelectedCurves<T> = (ClosestCurves<T>, [Option<ClosestCurves<T>>; 2]);

/// Returns the curves on which two bodies are closest.
fn closest_curves<T: Real>(
    first: &PlacedPolytope<'_, T>,
    second: &PlacedPolytope<'_, T>,
    face: &FaceAxis<T>,
    size: T,
) -> Option<SelectedCurves<T>> {
    let of_face = if face.is_second { second.normal(face.face) } else { -first.normal(face.face) };
    let between = first.center() - second.center();
    let overlaps = face.distance < T::zero();
    let center_vector_across_axis = |shape: &PlacedPolytope<'_, T>| {
        let axis = shape.direction(0);
        between - axis * axis.dot(&between)
    };
    let crossing = first.direction(0).cross(&second.direction(0));
    let other_starts =
        [between, center_vector_across_axis(first), center_vector_across_axis(second), crossing].map(
            |start| {
                let norm = start.norm();
                let side = if start.dot(&between) < T::zero() { -norm } else { norm };
                (overlaps && norm > constant(FLAT)).then(|| start / side)
            },
        );
    let starts = [Some(of_face)].into_iter().chain(other_starts).flatten();
    let tolerance = size * constant(TIE_TOLERANCE);
    let mut highest: Option<(T, Vector3<T>)> = None;
    for start in starts {
        // Separated bodies have only one maximum.
        if highest.is_some_and(|(value, _)| value > -tolerance) {
            break;
        }
        let found = climb_to_separation_maximum(first, second, start, size);
        if highest.is_none_or(|highest| found.0 > highest.0) {
            highest = Some(found);
        }
    }
    let (_, normal) = highest?;
    let mut best: Option<SelectedCurves<T>> = None;
    for_each_segment(first, &-normal, size, &mut |a| {
        for_each_segment(second, &normal, size, &mut |b| {
            let Some(found) = closest_of_segments((first, second), (a, b), &normal, size) else { return };
            if best.as_ref().is_none_or(|best| found.0.separation_score() > best.0.separation_score()) {
                best = Some(found);
            }
        });
    });
    best
}

/// Calls a function with the axis of a cylinder, or with each edge of a hull that ends at one of the highest
/// vertices along a direction.
fn for_each_segment<T: Real>(
    shape: &PlacedPolytope<'_, T>,
    along: &Vector3<T>,
    size: T,
    f: &mut dyn FnMut(&SegmentWithEnds<T>),
) {
    if shape.shape.radius > 0.0 {
        return f(&SegmentWithEnds::cylinder_axis_and_rims(shape, along));
    }
    let least = along.dot(&shape.support(along)) - size * constant(NEARLY_HIGHEST);
    for (k, edge) in shape.shape.edges.iter().enumerate() {
        if edge.ends.iter().any(|end| along.dot(&shape.vertex(*end)) >= least) {
            SegmentWithEnds::edge(shape, k).iter().for_each(&mut *f);
        }
    }
}

/// Returns the closest pair of a segment or end with a segment or end. If the segments are aligned, the pairs
/// at both ends of their common part are added.
fn closest_of_segments<T: Real>(
    bodies: (&PlacedPolytope<'_, T>, &PlacedPolytope<'_, T>),
    (a, b): (&SegmentWithEnds<T>, &SegmentWithEnds<T>),
    normal: &Vector3<T>,
    size: T,
) -> Option<SelectedCurves<T>> {
    let tolerance = size * constant(TIE_TOLERANCE);
    let closest_points_on_pair = |i: usize, j: usize| {
        let mut pair = ClosestCurves::solve([*a.curves.get(i)?, *b.curves.get(j)?], normal, size)?;
        let [own, other] = &pair.curves;
        let is_inside =
            (i > 0 || a.contains(&own.point, tolerance)) && (j > 0 || b.contains(&other.point, tolerance));
        pair.separation = separation_along_normal(bodies.0, bodies.1, &pair.normal);
        is_inside.then_some(pair)
    };
    let mut best: Option<(ClosestCurves<T>, bool)> = None;
    for i in 0..3 {
        for j in 0..3 {
            let Some(pair) = closest_points_on_pair(i, j) else { continue };
            if best.as_ref().is_none_or(|(best, _)| pair.separation_score() > best.separation_score()) {
                best = Some((pair, i == 0 || j == 0));
            }
        }
    }
    let (best, is_on_line) = best?;
    let mut others = [None::<ClosestCurves<T>>; 2];
    let along = a.direction();
    if is_on_line && along.dot(&b.direction()).abs() > constant(ALIGNED) {
        let distance_along_segment =
            |pair: &ClosestCurves<T>| along.dot(&(pair.curves[0].point - best.curves[0].point));
        for (i, j) in [(0, 1), (0, 2), (1, 0), (2, 0)] {
            let Some(pair) = closest_points_on_pair(i, j) else { continue };
            let is_usable = pair.gap >= best.separation && pair.normal.dot(&best.normal) > constant(ALIGNED);
            let reach = distance_along_segment(&pair);
            // At the same end, one pair is enough.
            if !is_usable || reach.abs() < size * constant(1e-6) {
                continue;
            }
            let end = others.get_mut(usize::from(reach > T::zero()));
            if let Some(end) =
                end.filter(|end| end.is_none_or(|known| distance_along_segment(&known).abs() < reach.abs()))
            {
                *end = Some(pair);
            }
        }
    }
    Some((best, others))
}
