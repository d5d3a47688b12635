//! Polytopes of contact surfaces: hulls, boxes and the axes of capsules.

use crate::hull::{Hull, MAX_VERTICES};
use crate::mechanism::{Polytope, PolytopeEdge, PolytopeFace};

/// Returns the polytope of a hull; `None` if its faces are not a closed surface, because rounding errors
/// decide which of its vertices are coplanar.
pub(super) fn hull_polytope(hull: &Hull) -> Option<Polytope> {
    let faces: Vec<PolytopeFace> = hull
        .faces
        .iter()
        .map(|face| PolytopeFace {
            normal: face.normal,
            offset: face.offset,
            corners: ordered_corners(&hull.vertices, face.normal, &face.corner_indices()),
        })
        .collect();
    let edges = edges_of_faces(&hull.vertices, &faces)?;
    // Euler's formula.
    let is_closed = hull.vertices.len() + faces.len() == edges.len() + 2;
    is_closed.then(|| Polytope { vertices: hull.vertices.clone(), faces, edges, radius: 0.0 })
}

/// Returns the polytope of a box with edges of these lengths; `None` if a length is not positive.
pub(super) fn box_polytope(lengths: [f64; 3]) -> Option<Polytope> {
    let corner =
        |k: usize| std::array::from_fn(|axis| lengths[axis] * if k >> axis & 1 == 0 { -0.5 } else { 0.5 });
    let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
    hull_polytope(&Hull::new(&corners, MAX_VERTICES).ok()?)
}

/// Returns a line segment of this length along a unit vector, with its centre at the origin.
pub(super) fn segment_polytope(along: [f64; 3], length: f64) -> Polytope {
    let vertices = [-0.5, 0.5].map(|side| along.map(|x| x * side * length)).to_vec();
    let edge = PolytopeEdge { ends: [0, 1], faces: PolytopeEdge::NO_FACES };
    Polytope { vertices, faces: Vec::new(), edges: vec![edge], radius: 0.0 }
}

/// Returns the vertices of a face, counter-clockwise about its normal.
fn ordered_corners(vertices: &[[f64; 3]], normal: [f64; 3], corners: &[usize]) -> Vec<u8> {
    let count = corners.len().max(1) as f64;
    let center: [f64; 3] =
        std::array::from_fn(|axis| corners.iter().map(|k| vertices[*k][axis]).sum::<f64>() / count);
    let arm = |k: usize| -> [f64; 3] { std::array::from_fn(|axis| vertices[k][axis] - center[axis]) };
    let first = corners.first().map_or([0.0; 3], |k| arm(*k));
    let second = cross(normal, first);
    let angle = |k: usize| libm::atan2(dot(second, arm(k)), dot(first, arm(k)));
    let mut ordered: Vec<(f64, u8)> = corners.iter().map(|k| (angle(*k), *k as u8)).collect();
    ordered.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    ordered.into_iter().map(|(_, k)| k).collect()
}

/// Returns the edges between the faces; `None` if a side of a face belongs to no other face.
fn edges_of_faces(vertices: &[[f64; 3]], faces: &[PolytopeFace]) -> Option<Vec<PolytopeEdge>> {
    let vertex_pairs_of_sides = |face: &PolytopeFace| -> Vec<[u8; 2]> {
        let next = face.corners.iter().cycle().skip(1);
        face.corners.iter().zip(next).map(|(from, to)| [*from, *to]).collect()
    };
    let mut edges = Vec::new();
    for (k, face) in faces.iter().enumerate() {
        for [from, to] in vertex_pairs_of_sides(face) {
            let other = faces.iter().position(|other| vertex_pairs_of_sides(other).contains(&[to, from]))?;
            if from > to {
                continue;
            }
            let along: [f64; 3] = std::array::from_fn(|axis| {
                vertices[usize::from(to)][axis] - vertices[usize::from(from)][axis]
            });
            let is_ordered = dot(cross(faces[other].normal, face.normal), along) > 0.0;
            let ends = if is_ordered { [from, to] } else { [to, from] };
            edges.push(PolytopeEdge { ends, faces: [k as u8, other as u8] });
        }
    }
    Some(edges)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The faces of a box are squares, each with two sides in every other direction; the normals at each edge
    /// have the cross product along it.
    #[test]
    fn box_has_twelve_edges_between_six_faces() {
        let shape = box_polytope([1.0, 2.0, 3.0]).expect("a box");
        assert_eq!((shape.vertices.len(), shape.faces.len(), shape.edges.len()), (8, 6, 12));
        assert!(shape.faces.iter().all(|face| face.corners.len() == 4));
        assert!((shape.half_sum_of_lengths() - 3.0).abs() < 1e-15 && shape.center() == [0.0; 3]);
        for edge in &shape.edges {
            let [a, b] = edge.ends.map(|k| shape.vertices[usize::from(k)]);
            let along = std::array::from_fn(|axis| b[axis] - a[axis]);
            let [first, second] = edge.faces.map(|k| shape.faces[usize::from(k)].normal);
            let length = dot(along, along).sqrt();
            assert!((dot(cross(second, first), along) - length).abs() < 1e-12, "{edge:?}");
        }
    }

    /// Counter-clockwise corners have the cross product of successive sides along the normal.
    #[test]
    fn corners_are_counter_clockwise() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]];
        let shape = hull_polytope(&Hull::new(&points, 32).expect("a hull")).expect("a polytope");
        assert_eq!((shape.faces.len(), shape.edges.len()), (5, 8));
        for face in &shape.faces {
            let corner_of_face = |k: usize| shape.vertices[usize::from(face.corners[k % face.corners.len()])];
            for k in 0..face.corners.len() {
                let side_vector_from_corner = |k: usize| -> [f64; 3] {
                    std::array::from_fn(|axis| corner_of_face(k + 1)[axis] - corner_of_face(k)[axis])
                };
                assert!(
                    dot(cross(side_vector_from_corner(k), side_vector_from_corner(k + 1)), face.normal) > 0.0,
                    "{face:?}"
                );
            }
        }
    }
}
