//! Separating directions of two polytopes: face normals, and common normals of edges.

use super::{MAX_EDGES, MAX_VERTICES, PlacedPolytope, constant};
use crate::Real;
use nalgebra::Vector3;

/// Amount by which a bound must be below a known separation for its direction to be skipped, relative to the
/// distance of the centres: more than rounding errors.
const SLACK: f64 = 1e-9;

/// Squared sine of the angle below which edges are treated as parallel; faces then determine the contact.
const PARALLEL: f64 = 1e-10;

/// Face along whose normal two polytopes have the largest separation.
#[derive(Clone, Copy)]
pub(super) struct FaceAxis<T> {
    /// Separation along the normal, negative if the polytopes overlap.
    pub(super) distance: T,
    /// Index of the face.
    pub(super) face: usize,
    /// Whether the face belongs to the second polytope.
    pub(super) is_second: bool,
}

/// Pair of edges along whose common normal two polytopes have the largest separation.
#[derive(Clone, Copy)]
pub(super) struct EdgeAxis<T> {
    /// Separation along the common normal, negative if the polytopes overlap.
    pub(super) distance: T,
    /// Indices of the edges of both polytopes.
    pub(super) edges: [usize; 2],
    /// Sign with which the cross product of both edges points towards the first polytope.
    pub(super) side: T,
}

/// Upper bounds of the separation of two polytopes along directions. The separation along a unit vector is at
/// most the component of any vector between points of both polytopes. Directions whose bound is not above a
/// known separation are skipped, without any effect on the result: of distant polytopes, few faces and edges
/// are evaluated.
#[derive(Clone, Copy)]
pub(super) struct SeparationBounds<T> {
    /// Vector from the centre of the first polytope to that of the second; `None` to skip no direction.
    pub(super) between: Option<Vector3<T>>,
}

impl<T: Real> SeparationBounds<T> {
    /// Returns the bounds that the mean positions of the vertices give.
    pub(super) fn bounds_from_centers(first: &PlacedPolytope<'_, T>, second: &PlacedPolytope<'_, T>) -> Self {
        SeparationBounds { between: Some(second.center() - first.center()) }
    }

    /// Whether the separation along an outward normal of the first polytope may exceed a known separation.
    fn may_face_separation_exceed(&self, normal: &Vector3<T>, is_second: bool, known: T) -> bool {
        let side = if is_second { -T::one() } else { T::one() };
        self.between
            .is_none_or(|between| normal.dot(&between) * side > known - rounding_slack_of_bound(&between))
    }

    /// Whether the separation along a common normal of an edge and another edge may exceed a known
    /// separation: along some direction between the normals at the edge.
    fn may_edge_separation_exceed(
        &self,
        normals: Option<[Vector3<T>; 2]>,
        along: &Vector3<T>,
        is_second: bool,
        known: T,
    ) -> bool {
        let Some(between) = self.between else { return true };
        let between = if is_second { -between } else { between };
        let known = known - rounding_slack_of_bound(&between);
        let across = between - along * along.dot(&between);
        if across.norm_squared() <= known * known && known > T::zero() {
            return false;
        }
        let Some([a, b]) = normals else { return true };
        let is_inside = a.cross(&across).dot(along) * across.cross(&b).dot(along) >= T::zero()
            && (a + b).dot(&across) > T::zero();
        is_inside || a.dot(&between).max(b.dot(&between)) > known
    }
}

fn rounding_slack_of_bound<T: Real>(between: &Vector3<T>) -> T {
    between.norm() * constant(SLACK)
}

/// Returns the face with the largest separation; `None` if no polytope has faces. Between equal separations,
/// a face of the larger polytope is chosen; for polytopes of equal size, of the first one if `height` is
/// positive. The order of the polytopes therefore has no effect.
pub(super) fn best_face_axis<T: Real>(
    first: &PlacedPolytope<'_, T>,
    second: &PlacedPolytope<'_, T>,
    height: T,
    tolerance: T,
    bounds: &SeparationBounds<T>,
) -> Option<FaceAxis<T>> {
    let [of_first, of_second] =
        [(first, second, false), (second, first, true)].map(|(own, other, is_second)| {
            let best = best_separating_face((own, other), is_second, tolerance, bounds);
            best.map(|(distance, face)| FaceAxis { distance, face, is_second })
        });
    let (a, b) = match (of_first, of_second) {
        (Some(a), Some(b)) => (a, b),
        (a, b) => return a.or(b),
    };
    let difference = constant::<T>(first.shape.size - second.shape.size);
    let preference = if difference.abs() > tolerance { difference } else { height };
    let bonus = if preference >= T::zero() { tolerance } else { -tolerance };
    Some(if a.distance - b.distance + bonus >= T::zero() { a } else { b })
}

/// Returns the largest separation along a face normal of one polytope, and the index of the face.
fn best_separating_face<T: Real>(
    (own, other): (&PlacedPolytope<'_, T>, &PlacedPolytope<'_, T>),
    is_second: bool,
    tolerance: T,
    bounds: &SeparationBounds<T>,
) -> Option<(T, usize)> {
    let mut best: Option<(T, usize)> = None;
    for k in 0..own.face_count() {
        let (normal, offset) = (own.normal(k), own.offset(k));
        if best.is_some_and(|(known, _)| !bounds.may_face_separation_exceed(&normal, is_second, known)) {
            continue;
        }
        let distance = other.lowest_height_along_normal(&normal) - offset;
        if best.is_none_or(|(known, _)| distance > known + tolerance) {
            best = Some((distance, k));
        }
    }
    best
}

/// Returns the pair of edges with the largest separation along their common normal; `None` if no separation
/// exceeds that of the best face, or no common normal is a direction in which the polytopes touch.
pub(super) fn best_edge_axis<T: Real>(
    first: &PlacedPolytope<'_, T>,
    second: &PlacedPolytope<'_, T>,
    face: T,
    bounds: &SeparationBounds<T>,
) -> Option<EdgeAxis<T>> {
    let mut best: Option<EdgeAxis<T>> = None;
    let mut candidates = [false; MAX_EDGES];
    let others = second.shape.edges.iter().zip(&second.directions);
    for (candidate, (edge, along)) in candidates.iter_mut().zip(others.clone()) {
        *candidate =
            bounds.may_edge_separation_exceed(adjacent_normals(second, edge.faces), along, true, face);
    }
    for (i, (edge, own)) in first.shape.edges.iter().zip(&first.directions).enumerate() {
        let (start, normals) = (first.vertex(edge.ends[0]), adjacent_normals(first, edge.faces));
        if !bounds.may_edge_separation_exceed(normals, own, false, face) {
            continue;
        }
        for (j, (candidate, (other_edge, along))) in candidates.iter().zip(others.clone()).enumerate() {
            let other_normals = adjacent_normals(second, other_edge.faces);
            if !candidate || !do_gauss_arcs_cross((normals, own), (other_normals, along)) {
                continue;
            }
            let across = own.cross(along);
            let square = across.norm_squared();
            if square < constant(PARALLEL) {
                continue;
            }
            // The normal points out of the first polytope and into the second.
            let outward = normals.map_or_else(|| -sum_of_normals(other_normals), |[a, b]| a + b);
            let side = if across.dot(&outward) < T::zero() { -T::one() } else { T::one() };
            let between = second.vertex(other_edge.ends[0]) - start;
            let distance = across.dot(&between) * side / square.sqrt();
            if distance > best.map_or(face, |best| best.distance) {
                best = Some(EdgeAxis { distance, edges: [i, j], side: -side });
            }
        }
    }
    best
}

fn sum_of_normals<T: Real>(normals: Option<[Vector3<T>; 2]>) -> Vector3<T> {
    normals.map_or_else(Vector3::zeros, |[a, b]| a + b)
}

/// Returns the normals of the faces at an edge; `None` for a line segment.
fn adjacent_normals<T: Real>(shape: &PlacedPolytope<'_, T>, faces: [u8; 2]) -> Option<[Vector3<T>; 2]> {
    let count = shape.shape.faces.len().min(2 * MAX_VERTICES);
    let [a, b] = faces.map(usize::from);
    (a < count && b < count).then(|| [shape.normal(a), shape.normal(b)])
}

/// Whether a common normal of two edges is an outward normal of one polytope, and an inward normal of the
/// other: on the Gauss sphere, the arc between the normals at one edge crosses the negative of the arc at the
/// other. The arc of a line segment is a great circle.
fn do_gauss_arcs_cross<T: Real>(
    (normals, own): (Option<[Vector3<T>; 2]>, &Vector3<T>),
    (others, along): (Option<[Vector3<T>; 2]>, &Vector3<T>),
) -> bool {
    let normal_components_along_edge = |normals: Option<[Vector3<T>; 2]>, edge: &Vector3<T>| {
        normals.map(|normals| normals.map(|normal| normal.dot(edge)))
    };
    let (of_others, of_own) =
        (normal_components_along_edge(others, own), normal_components_along_edge(normals, along));
    let have_opposite_signs = |sides: Option<[T; 2]>| sides.is_none_or(|[a, b]| a * b < T::zero());
    let same_half = match (of_others, of_own) {
        (Some([a, _]), Some([_, b])) => a * b < T::zero(),
        _ => true,
    };
    have_opposite_signs(of_others) && have_opposite_signs(of_own) && same_half
}
