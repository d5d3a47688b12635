//! Clipping of a face, or of a line segment, by the sides of a face.

use super::axes::FaceAxis;
use super::{MAX_VERTICES, PlacedPolytope, Polytope, constant, vertex_position_in_body};
use crate::Real;
use nalgebra::Vector3;

/// Maximum number of points of a clipped face.
pub(super) const MAX_POINTS: usize = 2 * MAX_VERTICES;

/// Origin of a point of a clipped face.
#[derive(Clone, Copy)]
pub(super) enum PointOrigin {
    /// The point is a vertex of the clipped face.
    Vertex(u8),
    /// The point is where a side of the clipping face cuts the edge of the clipped face between two vertices.
    Edge { ends: [u8; 2], side: usize },
    /// The point is a vertex of the clipping face above or below the clipped face.
    BoxInCorner(u8),
}

/// Point of a clipped face.
#[derive(Clone, Copy)]
pub(super) struct ClippedPoint<T> {
    place: Vector3<T>,
    /// Height above the clipping face, m.
    pub(super) height: T,
    pub(super) origin: PointOrigin,
    /// Number that the point keeps while the polytopes move: that of a corner of the clipped face for the
    /// corner, or for the point where the edge before it is cut off; for other points, the number of corners
    /// plus that of the side of the clipping face that ends there.
    pub(super) number: usize,
    /// Line from this point to the next.
    next: Line,
}

/// Line that bounds a clipped face.
#[derive(Clone, Copy)]
enum Line {
    /// Edge of the clipped face between two vertices, with the number of the corner at its end.
    Edge([u8; 2], usize),
    /// Side of the clipping face.
    Side(usize),
}

impl<T: Real> ClippedPoint<T> {
    /// Returns a placeholder.
    pub(super) fn placeholder_point() -> Self {
        let origin = PointOrigin::Vertex(0);
        ClippedPoint { place: Vector3::zeros(), height: T::zero(), origin, number: 0, next: Line::Side(0) }
    }
}

/// List of points with a maximum length.
struct Polygon<T> {
    points: [ClippedPoint<T>; MAX_POINTS],
    count: usize,
}

impl<T: Real> Polygon<T> {
    fn new() -> Self {
        Polygon { points: [ClippedPoint::placeholder_point(); MAX_POINTS], count: 0 }
    }

    fn push(&mut self, point: ClippedPoint<T>) {
        if let Some(slot) = self.points.get_mut(self.count) {
            *slot = point;
            self.count += 1;
        }
    }

    fn points(&self) -> &[ClippedPoint<T>] {
        self.points.get(..self.count).unwrap_or(&self.points)
    }
}

/// Returns the plane of a side of a face in the axes of the body: unit normal out of the face, and offset.
pub(super) fn side_plane<T: Real>(
    shape: &Polytope<'_>,
    face: usize,
    side: usize,
    normal: &Vector3<T>,
) -> (Vector3<T>, T) {
    let corners = shape.faces.get(face).map_or(&[][..], |face| face.corners);
    let corner_of_face = |k: usize| {
        let index = if k == corners.len() { 0 } else { k };
        corners.get(index).map_or_else(Vector3::zeros, |k| vertex_position_in_body::<T>(shape, *k))
    };
    let (start, end) = (corner_of_face(side), corner_of_face(side + 1));
    let outward = (end - start).cross(normal).normalize();
    (outward, outward.dot(&start))
}

/// Writes the points of the other polytope within the sides of a face, and returns their number and the index
/// of the face that was clipped; `None` for a line segment.
pub(super) fn write_clipped_points<T: Real>(
    own: &PlacedPolytope<'_, T>,
    other: &PlacedPolytope<'_, T>,
    axis: &FaceAxis<T>,
    tolerance: T,
    into: &mut [ClippedPoint<T>; MAX_POINTS],
) -> (usize, Option<usize>) {
    let (normal, offset) = (own.normal(axis.face), own.offset(axis.face));
    let opposite = opposite_face(other, &normal, tolerance);
    let mut polygon = Polygon::new();
    let segment = other.shape.edges.first().map_or([0, 0], |edge| edge.ends);
    let corners = opposite.and_then(|k| other.shape.faces.get(k)).map_or(&segment[..], |face| face.corners);
    for (k, corner) in corners.iter().enumerate() {
        let end = if k + 1 < corners.len() { k + 1 } else { 0 };
        let ends = [*corner, corners.get(end).copied().unwrap_or(*corner)];
        let (place, origin) = (other.vertex(*corner), PointOrigin::Vertex(*corner));
        let next = Line::Edge(ends, end);
        polygon.push(ClippedPoint { place, height: normal.dot(&place) - offset, origin, number: k, next });
    }
    let sides = own.shape.faces.get(axis.face).map_or(&[][..], |face| face.corners);
    for side in 0..sides.len() {
        let corner =
            |k: usize| sides.get(k).or(sides.first()).map_or_else(Vector3::zeros, |k| own.vertex(*k));
        let (start, end) = (corner(side), corner(side + 1));
        let outward = (end - start).cross(&normal).normalize();
        let plane = (outward, outward.dot(&start) + tolerance);
        polygon = match opposite {
            Some(_) => clip_polygon(&polygon, plane, (side, sides), corners.len()),
            None => clip_segment(&polygon, plane, side),
        };
    }
    for point in polygon.points.iter_mut().take(polygon.count) {
        point.height = normal.dot(&point.place) - offset;
    }
    *into = polygon.points;
    (polygon.count, opposite)
}

/// Returns the face of a polytope that is opposite to a normal: of the faces with the largest number of
/// lowest vertices the one whose normal is the most opposed. `None` for a line segment.
pub(super) fn opposite_face<T: Real>(
    shape: &PlacedPolytope<'_, T>,
    normal: &Vector3<T>,
    tolerance: T,
) -> Option<usize> {
    let lowest = shape.vertices().iter().map(|vertex| normal.dot(vertex)).reduce(T::min)?;
    let is_lowest = |k: &&u8| normal.dot(&shape.vertex(**k)) <= lowest + tolerance;
    let mut best: Option<(usize, T, usize)> = None;
    for (k, face) in shape.shape.faces.iter().enumerate() {
        let (count, cosine) = (face.corners.iter().filter(is_lowest).count(), normal.dot(&shape.normal(k)));
        let is_better = best.is_none_or(|(known, least, _)| {
            count > known || (count == known && cosine < least - constant::<T>(super::TIE_TOLERANCE))
        });
        if is_better {
            best = Some((count, cosine, k));
        }
    }
    best.map(|(.., k)| k)
}

/// Returns the part of a polygon behind the plane of a side. The clipped face has `count` corners.
fn clip_polygon<T: Real>(
    polygon: &Polygon<T>,
    (outward, limit): (Vector3<T>, T),
    (side, corners): (usize, &[u8]),
    count: usize,
) -> Polygon<T> {
    let mut clipped = Polygon::new();
    let points = polygon.points();
    for (k, point) in points.iter().enumerate() {
        let Some(next) = points.get(k + 1).or(points.first()) else { continue };
        let [here, there] = [point, next].map(|point| outward.dot(&point.place) - limit);
        let (is_inside, enters) = (here <= T::zero(), there <= T::zero());
        if is_inside {
            clipped.push(*point);
        }
        if is_inside == enters {
            continue;
        }
        let place = point.place + (next.place - point.place) * (here / (here - there));
        let (origin, last) = match point.next {
            Line::Edge(ends, end) => (PointOrigin::Edge { ends, side }, end),
            Line::Side(other) => {
                (PointOrigin::BoxInCorner(corner_between(corners, other, side)), count + other)
            }
        };
        let (number, next) = if is_inside { (last, Line::Side(side)) } else { (count + side, point.next) };
        clipped.push(ClippedPoint { place, height: T::zero(), origin, number, next });
    }
    clipped
}

/// Returns the vertex between two sides of a face; each side begins at the vertex with its index.
fn corner_between(corners: &[u8], a: usize, b: usize) -> u8 {
    let last = corners.len().saturating_sub(1);
    let is_preceding_side = |a: usize, b: usize| a + 1 == b || (a == last && b == 0);
    let index = if is_preceding_side(a, b) { b } else { a };
    corners.get(index).copied().unwrap_or(0)
}

/// Returns the part of a line segment behind the plane of a side.
fn clip_segment<T: Real>(polygon: &Polygon<T>, (outward, limit): (Vector3<T>, T), side: usize) -> Polygon<T> {
    let mut clipped = Polygon::new();
    let [start, end, ..] = polygon.points() else { return clipped };
    let [here, there] = [start, end].map(|point| outward.dot(&point.place) - limit);
    let (is_inside, enters) = (here <= T::zero(), there <= T::zero());
    if !is_inside && !enters {
        return clipped;
    }
    let place = start.place + (end.place - start.place) * (here / (here - there));
    let point_cut_by_plane = |point: &ClippedPoint<T>| {
        let origin = match point.next {
            Line::Edge(ends, _) => PointOrigin::Edge { ends, side },
            Line::Side(_) => point.origin,
        };
        ClippedPoint { place, origin, ..*point }
    };
    clipped.push(if is_inside { *start } else { point_cut_by_plane(start) });
    clipped.push(if enters { *end } else { point_cut_by_plane(end) });
    clipped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_meet_at_their_common_vertex() {
        let corners = [7, 3, 5, 1];
        assert_eq!(corner_between(&corners, 0, 1), 3);
        assert_eq!(corner_between(&corners, 1, 0), 3);
        assert_eq!(corner_between(&corners, 3, 0), 7);
        assert_eq!(corner_between(&corners, 0, 3), 7);
    }
}
