//! Features that determine the contact of two convex polytopes: hulls, boxes and axes of capsules.
//!
//! Generated code computes gaps, normals and contact points from the features of each pair: a face and the
//! points of the other polytope on it, or two edges, or the closest points. Features are constant in the axes
//! of their bodies, and change only from one set to another. The generated expressions are therefore
//! differentiated as if the features were constants.
//!
//! 1. The separation is the largest over all face normals of both polytopes, and over the common normals of
//!    all pairs of edges whose arcs on the Gauss sphere cross (Gregorius, *The separating axis test between
//!    convex polyhedra*, Game Developers Conference, 2013). It is the distance or, if negative, the depth of
//!    penetration, unless the polytopes are nearest at a vertex and an edge or at two vertices.
//! 2. If a face has the largest separation, the opposite face of the other polytope is clipped by its sides
//!    (Sutherland and Hodgman, *Reentrant polygon clipping*, Communications of the ACM 17, 1974).
//! 3. If separated polytopes have no point of the face at this distance, their closest points are sought
//!    among vertices and edges.
//!
//! Pairs with a cylinder that has end faces have other features, described in [`cylinders`].

mod axes;
mod clip;
mod closest;
mod curves;
mod cylinders;
mod search;

use crate::Real;
use crate::private::constant;
use axes::{EdgeAxis, FaceAxis, SeparationBounds, best_edge_axis, best_face_axis};
use clip::{ClippedPoint, PointOrigin, write_clipped_points};
use closest::{ClosestFeatures, closest_features, edge_parameters};
use nalgebra::{Matrix3, SVector, Vector3};

/// Maximum numbers of vertices, faces and edges of a polytope.
const MAX_VERTICES: usize = 32;
const MAX_FACES: usize = 2 * MAX_VERTICES - 4;
const MAX_EDGES: usize = 3 * MAX_VERTICES - 6;

/// Amount by which the separation along a later direction must exceed that of an earlier one to replace it,
/// and tolerance of positions, relative to the size of the polytopes.
const TIE_TOLERANCE: f64 = 1e-9;

/// Number of values that describe the pose of a pair: orientation of the second polytope relative to the
/// first, column by column, its position, and the height of the second above the first along a fixed
/// direction.
const POSE: usize = 13;
/// Number of features of a pair that are not those of a point, and number of features of a point.
const HEAD: usize = 22;
const POINT: usize = 13;

/// Face of a [`Polytope`].
#[derive(Clone, Copy, Debug)]
pub struct PolytopeFace<'a> {
    /// Outward unit normal.
    pub normal: [f64; 3],
    /// Distance of the plane from the origin along the normal, m.
    pub offset: f64,
    /// Indices of the vertices, counter-clockwise about the normal.
    pub corners: &'a [u8],
}

/// Edge of a [`Polytope`].
#[derive(Clone, Copy, Debug)]
pub struct PolytopeEdge {
    /// Indices of the vertices at both ends. The direction from the first to the second is that of the cross
    /// product of the normals of the second and the first face.
    pub ends: [u8; 2],
    /// Indices of the adjacent faces; of no faces for a line segment, the axis of a capsule.
    pub faces: [u8; 2],
}

/// Convex polytope whose vertices are constant in the axes of its body, a line segment, or a cylinder with
/// two end faces around a line segment.
#[derive(Clone, Copy, Debug)]
pub struct Polytope<'a> {
    /// Positions of the vertices, m.
    pub vertices: &'a [[f64; 3]],
    /// Faces, none for a line segment.
    pub faces: &'a [PolytopeFace<'a>],
    /// Edges.
    pub edges: &'a [PolytopeEdge],
    /// Half the sum of the lengths along the axes of the body, m.
    pub size: f64,
    /// Radius of the cylinder with two end faces around a line segment, m; zero for other shapes.
    pub radius: f64,
}

/// Two polytopes in contact, of which at least one has faces or is a cylinder.
#[derive(Clone, Copy, Debug)]
pub struct PolytopePair<'a> {
    /// Polytope of the first surface.
    pub first: Polytope<'a>,
    /// Polytope of the second surface.
    pub second: Polytope<'a>,
    /// Maximum number of contact points of a face; without effect for cylinders.
    pub points: usize,
}

/// Polytope in the axes of the first polytope of its pair.
struct PlacedPolytope<'a, T> {
    shape: &'a Polytope<'a>,
    rotation: Matrix3<T>,
    position: Vector3<T>,
    vertices: [Vector3<T>; MAX_VERTICES],
    normals: [Vector3<T>; MAX_FACES],
    offsets: [T; MAX_FACES],
    /// Unit vectors along the edges.
    directions: [Vector3<T>; MAX_EDGES],
}

/// Features of a contact.
enum DeterminingFeatures<T> {
    /// Points of one polytope on a face of the other.
    Face,
    /// Two edges that cross.
    Edges(EdgeAxis<T>),
    /// Closest points of separated polytopes.
    Points(ClosestFeatures),
}

fn vector_from_array<T: Real>(v: [f64; 3]) -> Vector3<T> {
    Vector3::from(v.map(constant))
}

impl PolytopePair<'_> {
    /// Returns the number of features of the pair.
    pub fn feature_count(&self) -> usize {
        if self.has_cylinder() { cylinders::FEATURES } else { HEAD + POINT * self.points }
    }

    fn has_cylinder(&self) -> bool {
        self.first.radius > 0.0 || self.second.radius > 0.0
    }
}

impl<'a, T: Real> PlacedPolytope<'a, T> {
    fn new(shape: &'a Polytope<'a>, rotation: &Matrix3<T>, position: &Vector3<T>) -> Self {
        let zero = Vector3::zeros();
        let mut placed = PlacedPolytope {
            shape,
            rotation: *rotation,
            position: *position,
            vertices: [zero; MAX_VERTICES],
            normals: [zero; MAX_FACES],
            offsets: [T::zero(); MAX_FACES],
            directions: [zero; MAX_EDGES],
        };
        for (into, vertex) in placed.vertices.iter_mut().zip(shape.vertices) {
            *into = rotation * vector_from_array::<T>(*vertex) + position;
        }
        for ((normal, offset), face) in placed.normals.iter_mut().zip(&mut placed.offsets).zip(shape.faces) {
            *normal = rotation * vector_from_array::<T>(face.normal);
            *offset = constant::<T>(face.offset) + normal.dot(position);
        }
        for (direction, edge) in placed.directions.iter_mut().zip(shape.edges) {
            *direction = rotation * edge_as_centered_segment(shape, edge).1;
        }
        if shape.radius > 0.0 {
            // The end faces of a cylinder.
            let axis = placed.direction(0);
            for (k, normal) in [-axis, axis].into_iter().enumerate() {
                let offset = normal.dot(&placed.vertex(k as u8));
                let face = placed.normals.get_mut(k).zip(placed.offsets.get_mut(k));
                face.into_iter().for_each(|(n, d)| (*n, *d) = (normal, offset));
            }
        }
        placed
    }

    /// Returns the number of faces, two for a cylinder.
    fn face_count(&self) -> usize {
        if self.shape.radius > 0.0 { 2 } else { self.shape.faces.len() }
    }

    fn vertices(&self) -> &[Vector3<T>] {
        self.vertices.get(..self.shape.vertices.len()).unwrap_or(&self.vertices)
    }

    fn vertex(&self, index: u8) -> Vector3<T> {
        self.vertices.get(usize::from(index)).copied().unwrap_or_else(Vector3::zeros)
    }

    fn normal(&self, face: usize) -> Vector3<T> {
        self.normals.get(face).copied().unwrap_or_else(Vector3::zeros)
    }

    fn offset(&self, face: usize) -> T {
        self.offsets.get(face).copied().unwrap_or_else(T::zero)
    }

    fn direction(&self, edge: usize) -> Vector3<T> {
        self.directions.get(edge).copied().unwrap_or_else(Vector3::zeros)
    }

    /// Returns the mean position of the vertices.
    fn center(&self) -> Vector3<T> {
        let sum = self.vertices().iter().fold(Vector3::zeros(), |sum, vertex| sum + vertex);
        sum / constant::<T>(self.vertices().len() as f64)
    }

    /// Returns a position in the axes of the body.
    fn position_in_body_axes(&self, place: &Vector3<T>) -> Vector3<T> {
        self.rotation.tr_mul(&(place - self.position))
    }

    /// Returns the position of a point relative to the axis of a cylinder, perpendicular to the axis.
    fn offset_from_cylinder_axis(&self, place: &Vector3<T>) -> Vector3<T> {
        let (axis, from_end) = (self.direction(0), place - self.vertex(0));
        from_end - axis * axis.dot(&from_end)
    }

    /// Returns the farthest point along a direction.
    fn support(&self, along: &Vector3<T>) -> Vector3<T> {
        let heights = self.vertices().iter().map(|vertex| (along.dot(vertex), vertex));
        let highest = heights.reduce(|a, b| if b.0 > a.0 { b } else { a });
        let highest = highest.map_or_else(Vector3::zeros, |(_, vertex)| *vertex);
        let axis = self.direction(0);
        let remove_axial = |v: &Vector3<T>| v - axis * axis.dot(v);
        // The second time removes rounding errors of the first, which matter if the direction is the axis.
        let across = remove_axial(&remove_axial(along));
        let norm = across.norm();
        match self.shape.radius > 0.0 && norm > T::zero() {
            true => highest + across * (constant::<T>(self.shape.radius) / norm),
            false => highest,
        }
    }

    /// Returns the least height above a plane through the origin.
    fn lowest_height_along_normal(&self, normal: &Vector3<T>) -> T {
        if self.shape.radius > 0.0 {
            return normal.dot(&self.support(&-normal));
        }
        self.vertices().iter().map(|vertex| normal.dot(vertex)).reduce(T::min).unwrap_or_else(T::zero)
    }
}

/// Returns the midpoint of an edge, the unit vector along it and half of its length, in the axes of the body.
fn edge_as_centered_segment<T: Real>(
    shape: &Polytope<'_>,
    edge: &PolytopeEdge,
) -> (Vector3<T>, Vector3<T>, T) {
    let [a, b] = edge.ends.map(|k| vertex_position_in_body::<T>(shape, k));
    let along = b - a;
    let length = along.norm();
    let half = constant::<T>(0.5);
    ((a + b) * half, along / length, length * half)
}

fn vertex_position_in_body<T: Real>(shape: &Polytope<'_>, index: u8) -> Vector3<T> {
    shape.vertices.get(usize::from(index)).map_or_else(Vector3::zeros, |p| vector_from_array(*p))
}

/// Returns the features of all pairs, one after another: 22 values and 13 for each point of a face; for pairs
/// with a cylinder 6 values, 23 for each of three points on curves and 4 for each of five points on a face.
///
/// For each pair, `poses` contains 13 values: the rotation matrix that converts axes of the second polytope
/// to axes of the first, column by column, the position of the second polytope in the axes of the first, and
/// a length whose sign decides between faces of equal separation.
pub fn contact_features<T: Real, const N: usize>(pairs: &[PolytopePair<'_>], poses: &[T]) -> SVector<T, N> {
    let mut all = SVector::<T, N>::zeros();
    write_contact_features(pairs, poses, all.as_mut_slice());
    all
}

/// Writes the features of all pairs, as [`contact_features`] returns them, to a slice of zeros.
pub fn write_contact_features<T: Real>(pairs: &[PolytopePair<'_>], poses: &[T], into: &mut [T]) {
    let mut rest = into;
    for (pair, pose) in pairs.iter().zip(poses.chunks_exact(POSE)) {
        let Some((own, others)) = rest.split_at_mut_checked(pair.feature_count()) else { break };
        write_features(pair, pose, true, own);
        rest = others;
    }
}

/// Writes the features of a pair. With `is_bounded`, faces and edges that cannot determine the contact are
/// skipped, which does not change the result.
fn write_features<T: Real>(pair: &PolytopePair<'_>, pose: &[T], is_bounded: bool, into: &mut [T]) {
    let pose_entry_or_zero = |k: usize| pose.get(k).copied().unwrap_or_else(T::zero);
    let rotation = Matrix3::from_fn(|i, j| pose_entry_or_zero(3 * j + i));
    let position = Vector3::from_fn(|i, _| pose_entry_or_zero(9 + i));
    let first = PlacedPolytope::new(&pair.first, &Matrix3::identity(), &Vector3::zeros());
    let second = PlacedPolytope::new(&pair.second, &rotation, &position);
    if pair.has_cylinder() {
        return cylinders::write_features(&first, &second, pose_entry_or_zero(12), into);
    }
    let tolerance = constant::<T>((pair.first.size + pair.second.size) * TIE_TOLERANCE);
    let bounds = match is_bounded {
        true => SeparationBounds::bounds_from_centers(&first, &second),
        false => SeparationBounds { between: None },
    };
    let Some(face) = best_face_axis(&first, &second, pose_entry_or_zero(12), tolerance, &bounds) else {
        return;
    };
    let (own, other) = if face.is_second { (&second, &first) } else { (&first, &second) };
    let mut points = [ClippedPoint::placeholder_point(); clip::MAX_POINTS];
    let (count, opposite) = write_clipped_points(own, other, &face, tolerance, &mut points);
    let edge = best_edge_axis(&first, &second, face.distance, &bounds);
    let points = points.get(..count).unwrap_or(&[]);
    let features = choose_features((&first, &second), &face, edge, points, is_bounded, tolerance);
    write_face_and_edges(&features, (&first, &second), &face, into);
    let opposite = opposite.and_then(|k| other.shape.faces.get(k));
    let slots = into.get_mut(HEAD..).unwrap_or(&mut []);
    write_features_of_face_points(points, pair.points, (own.shape, other.shape), (&face, opposite), slots);
}

/// Writes the features of the points on a face to a list of at most `most` points. Further points are omitted
/// evenly around the face.
fn write_features_of_face_points<T: Real>(
    points: &[ClippedPoint<T>],
    most: usize,
    shapes: (&Polytope<'_>, &Polytope<'_>),
    faces: (&FaceAxis<T>, Option<&PolytopeFace<'_>>),
    into: &mut [T],
) {
    let (count, written) = (points.len(), points.len().min(most));
    let mut used = [false; clip::MAX_POINTS];
    for k in 0..written {
        let Some(point) = (k * count).checked_div(written).and_then(|k| points.get(k)) else { continue };
        // A point stays at its place in the list as long as it exists.
        let mut places = (0..most).filter_map(|k| (point.number + k).checked_rem(most));
        let Some(place) = places.find(|place| used.get(*place) == Some(&false)) else { break };
        if let Some(used) = used.get_mut(place) {
            *used = true;
        }
        if let Some(slot) = into.get_mut(POINT * place..POINT * (place + 1)) {
            write_features_of_point(point, shapes, faces, slot);
        }
    }
}

/// Returns the features that determine the contact.
fn choose_features<T: Real>(
    (first, second): (&PlacedPolytope<'_, T>, &PlacedPolytope<'_, T>),
    face: &FaceAxis<T>,
    edge: Option<EdgeAxis<T>>,
    points: &[ClippedPoint<T>],
    is_bounded: bool,
    tolerance: T,
) -> DeterminingFeatures<T> {
    let edge = edge.filter(|edge| edge.distance > face.distance + tolerance);
    let largest = edge.as_ref().map_or(face.distance, |edge| edge.distance);
    let is_met = match &edge {
        Some(edge) => edge_parameters(first, second, edge.edges).is_some(),
        None => points.iter().any(|point| point.height <= face.distance + tolerance),
    };
    match (edge, is_met || largest <= tolerance) {
        (Some(edge), true) => DeterminingFeatures::Edges(edge),
        (None, true) => DeterminingFeatures::Face,
        (_, false) => DeterminingFeatures::Points(closest_features(first, second, is_bounded)),
    }
}

/// Writes the features of the face and of the edges.
fn write_face_and_edges<T: Real>(
    features: &DeterminingFeatures<T>,
    (first, second): (&PlacedPolytope<'_, T>, &PlacedPolytope<'_, T>),
    face: &FaceAxis<T>,
    into: &mut [T],
) {
    let own = if face.is_second { second } else { first };
    let (normal, offset) = own
        .shape
        .faces
        .get(face.face)
        .map_or_else(|| (Vector3::zeros(), T::zero()), |f| (vector_from_array(f.normal), constant(f.offset)));
    let (zero, one) = (T::zero(), T::one());
    // Gaps of the points on a face are not below this value.
    let unbounded = -constant::<T>(1e6 * (first.shape.size + second.shape.size));
    let (least, side, is_closest, closest) = match features {
        DeterminingFeatures::Face => (unbounded, zero, zero, None),
        DeterminingFeatures::Edges(edge) => (
            edge.distance - face.distance,
            edge.side,
            zero,
            Some(ClosestFeatures::from_edge_indices(edge.edges)),
        ),
        DeterminingFeatures::Points(closest) => (unbounded, zero, one, Some(*closest)),
    };
    let nowhere = [(Vector3::zeros(), Vector3::zeros(), zero); 2];
    let segments = closest.map_or(nowhere, |closest| closest.features_as_segments(first.shape, second.shape));
    let values = [if face.is_second { one } else { zero }, least]
        .into_iter()
        .chain(components(normal))
        .chain([offset, side, is_closest])
        .chain(segments.into_iter().flat_map(|(middle, along, reach)| {
            components(middle).into_iter().chain(components(along)).chain([reach])
        }));
    into.iter_mut().zip(values).for_each(|(into, value)| *into = value);
}

/// Writes the features of a point on a face: whether it exists, whether it is cut off by a plane, and whether
/// its line belongs to the polytope with the face; the line, and the plane of the other polytope that
/// cuts it.
fn write_features_of_point<T: Real>(
    point: &ClippedPoint<T>,
    (own, other): (&Polytope<'_>, &Polytope<'_>),
    (face, opposite): (&FaceAxis<T>, Option<&PolytopeFace<'_>>),
    into: &mut [T],
) {
    let (zero, one) = (T::zero(), T::one());
    let normal =
        own.faces.get(face.face).map_or_else(Vector3::zeros, |face| vector_from_array::<T>(face.normal));
    let (is_cut, is_own, start, along, plane) = match point.origin {
        PointOrigin::Vertex(k) => {
            (zero, zero, vertex_position_in_body(other, k), Vector3::zeros(), (Vector3::zeros(), zero))
        }
        PointOrigin::Edge { ends: [a, b], side } => {
            let (start, end) =
                (vertex_position_in_body::<T>(other, a), vertex_position_in_body::<T>(other, b));
            let plane = clip::side_plane(own, face.face, side, &normal);
            (one, zero, start, (end - start).normalize(), plane)
        }
        PointOrigin::BoxInCorner(k) => {
            let plane = opposite.map_or_else(
                || (normal, zero),
                |face| (vector_from_array(face.normal), constant(face.offset)),
            );
            (one, one, vertex_position_in_body(own, k), normal, plane)
        }
    };
    let values = [one, is_cut, is_own]
        .into_iter()
        .chain(components(start))
        .chain(components(along))
        .chain(components(plane.0))
        .chain([plane.1]);
    into.iter_mut().zip(values).for_each(|(into, value)| *into = value);
}

fn components<T: Real>(v: Vector3<T>) -> [T; 3] {
    v.into()
}

#[cfg(test)]
mod tests;
