use super::*;
use nalgebra::{Rotation3, Vector3};
use std::vec;
use std::vec::Vec;

/// Vertices, edges and faces of an octahedron with different semi-axes.
const VERTICES: [[f64; 3]; 6] =
    [[0.3, 0.0, 0.0], [-0.3, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, -0.2, 0.0], [0.0, 0.0, 0.1], [0.0, 0.0, -0.1]];
const CORNERS: [[u8; 3]; 8] =
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

/// Returns the faces and edges of the octahedron.
fn octahedron_faces() -> ([PolytopeFace<'static>; 8], Vec<PolytopeEdge>) {
    let vertex = |k: u8| Vector3::from(VERTICES[usize::from(k)]);
    let faces = core::array::from_fn(|k| {
        let [a, b, c] = CORNERS[k].map(vertex);
        let normal = (b - a).cross(&(c - a)).normalize();
        PolytopeFace { normal: normal.into(), offset: normal.dot(&a), corners: &CORNERS[k] }
    });
    let mut edges = Vec::new();
    for (k, corners) in CORNERS.iter().enumerate() {
        for side in 0..3 {
            let [from, to] = [corners[side], corners[(side + 1) % 3]];
            let has_reversed_edge =
                |other: &[u8; 3]| (0..3).any(|i| [other[i], other[(i + 1) % 3]] == [to, from]);
            let other = CORNERS.iter().position(has_reversed_edge).expect("a face on the other side");
            if from < to {
                edges.push(PolytopeEdge { ends: [to, from], faces: [k as u8, other as u8] });
            }
        }
    }
    (faces, edges)
}

/// Bounds that skip faces, edges and vertices change no bit of the features, near and far.
#[test]
fn bounds_do_not_change_features() {
    let (faces, edges) = octahedron_faces();
    let shape = Polytope { vertices: &VERTICES, faces: &faces, edges: &edges, size: 0.6, radius: 0.0 };
    let pair = PolytopePair { first: shape, second: shape, points: 6 };
    let mut state = 9_u64;
    let mut next_random_number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    };
    for k in 0..600 {
        let mut random_vector =
            |size: f64| Vector3::new(next_random_number(), next_random_number(), next_random_number()) * size;
        let turn = Rotation3::from_scaled_axis(random_vector(3.0)).into_inner();
        let place = random_vector([0.1, 0.5, 3.0][k % 3]);
        let pose: Vec<f64> = turn.iter().copied().chain(place.iter().copied()).chain([place[2]]).collect();
        let mut features = [vec![0.0; pair.feature_count()], vec![0.0; pair.feature_count()]];
        let [bounded, all] = &mut features;
        write_features(&pair, &pose, true, bounded);
        write_features(&pair, &pose, false, all);
        assert_eq!(bounded, all, "{place} {turn}");
    }
}
