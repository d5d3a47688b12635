//! Closest points of two separated polytopes, at vertices and edges.

use super::{PlacedPolytope, Polytope, edge_as_centered_segment, vector_from_array};
use crate::Real;
use crate::private::constant;
use nalgebra::Vector3;

/// Amount by which the square of a bound must exceed that of a known distance, relative to the latter: more
/// than rounding errors.
const SLACK: f64 = 1e-9;

/// Squared sine of the angle below which edges have no crossing.
const PARALLEL: f64 = 1e-12;

/// Vertex or edge of a polytope, by its index.
#[derive(Clone, Copy)]
enum VertexOrEdge {
    Vertex(usize),
    Edge(usize),
}

/// Vertices or edges at which two polytopes are closest.
#[derive(Clone, Copy)]
pub(super) struct ClosestFeatures([VertexOrEdge; 2]);

impl ClosestFeatures {
    /// Returns two edges, by their indices.
    pub(super) fn from_edge_indices(edges: [usize; 2]) -> ClosestFeatures {
        ClosestFeatures(edges.map(VertexOrEdge::Edge))
    }

    /// Returns both features as segments in the axes of their bodies: midpoint, unit vector and half of the
    /// length; both are zero for a vertex.
    pub(super) fn features_as_segments<T: Real>(
        &self,
        first: &Polytope<'_>,
        second: &Polytope<'_>,
    ) -> [(Vector3<T>, Vector3<T>, T); 2] {
        let [a, b] = self.0;
        [(a, first), (b, second)].map(|(feature, shape)| match feature {
            VertexOrEdge::Vertex(k) => {
                let vertex = shape.vertices.get(k).map_or_else(Vector3::zeros, |p| vector_from_array(*p));
                (vertex, Vector3::zeros(), T::zero())
            }
            VertexOrEdge::Edge(k) => shape.edges.get(k).map_or_else(
                || (Vector3::zeros(), Vector3::zeros(), T::zero()),
                |edge| edge_as_centered_segment(shape, edge),
            ),
        })
    }
}

/// Returns the positions between −1 and 1 on two edges where their lines are closest; `None` if one of them
/// is beyond its edge, or if the edges are parallel.
pub(super) fn edge_parameters<T: Real>(
    first: &PlacedPolytope<'_, T>,
    second: &PlacedPolytope<'_, T>,
    [i, j]: [usize; 2],
) -> Option<[T; 2]> {
    let [(a, own), (b, along)] =
        [edge_midpoint_and_half_vector(first, i)?, edge_midpoint_and_half_vector(second, j)?];
    let (offset, x, y, z) = (a - b, own.norm_squared(), along.norm_squared(), own.dot(&along));
    let determinant = x * y - z * z;
    if determinant <= x * y * constant(PARALLEL) {
        return None;
    }
    let (by_own, by_other) = (own.dot(&offset), along.dot(&offset));
    let s = (z * by_other - y * by_own) / determinant;
    let t = (x * by_other - z * by_own) / determinant;
    (s.abs() <= T::one() && t.abs() <= T::one()).then_some([s, t])
}

/// Returns the midpoint of an edge, and half of the vector along it.
fn edge_midpoint_and_half_vector<T: Real>(
    shape: &PlacedPolytope<'_, T>,
    edge: usize,
) -> Option<(Vector3<T>, Vector3<T>)> {
    let edge = shape.shape.edges.get(edge)?;
    let ([a, b], half) = (edge.ends.map(|k| shape.vertex(k)), constant::<T>(0.5));
    Some(((a + b) * half, (b - a) * half))
}

/// Returns the closest vertex and edge of two polytopes. Two closest vertices are ends of an edge.
pub(super) fn closest_features<T: Real>(
    first: &PlacedPolytope<'_, T>,
    second: &PlacedPolytope<'_, T>,
    is_bounded: bool,
) -> ClosestFeatures {
    let mut best = (None::<T>, ClosestFeatures([VertexOrEdge::Vertex(0); 2]));
    let between = second.vertex(0) - first.vertex(0);
    for (own, other, is_second) in [(first, second, false), (second, first, true)] {
        // The distance is at least the difference of heights along a direction towards the other polytope.
        let towards = if is_second { -between } else { between };
        let towards = towards / towards.norm();
        let heights = other.vertices().iter().map(|vertex| towards.dot(vertex));
        let lowest = heights.reduce(T::min).unwrap_or_else(T::zero);
        for (i, vertex) in own.vertices().iter().enumerate() {
            let height = (lowest - towards.dot(vertex)).max(T::zero());
            if is_bounded && best.0.is_some_and(|known| height * height > known * constant(1.0 + SLACK)) {
                continue;
            }
            for j in 0..other.shape.edges.len() {
                let Some((middle, half)) = edge_midpoint_and_half_vector(other, j) else { continue };
                let offset = vertex - middle;
                let t = (offset.dot(&half) / half.norm_squared()).clamp(-T::one(), T::one());
                let square = (offset - half * t).norm_squared();
                if best.0.is_none_or(|known| square < known) {
                    let pair = [VertexOrEdge::Vertex(i), VertexOrEdge::Edge(j)];
                    best = (Some(square), ClosestFeatures(if is_second { [pair[1], pair[0]] } else { pair }));
                }
            }
        }
    }
    best.1
}
