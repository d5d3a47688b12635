//! Triangulation of terrains, whose height is a function of the mechanism, over the region of a motion.

use crate::figure::Figure;
use crate::mesh::TriangleMesh;
use linkwork::drawing::Kind;
use linkwork::nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Vector3};

impl Figure {
    /// Replaces every terrain of the drawing by a surface over the region of the frames' positions, extended
    /// by `beyond`, m.
    pub(crate) fn draw_terrains_as_surfaces(
        &mut self,
        placements: &[Vec<IsometryMatrix3<f64>>],
        beyond: f64,
        height: impl Fn(usize, [f64; 2]) -> Option<f64>,
    ) {
        let moving = self.used_frames();
        for shape in &mut self.shapes {
            let Kind::Terrain(number) = shape.kind else { continue };
            let own = Rotation3::from_matrix_unchecked(Matrix3::from_row_slice(&shape.numbers[3..12]));
            let own =
                IsometryMatrix3::from_parts(Vector3::from_column_slice(&shape.numbers[..3]).into(), own);
            let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
            for placed in placements {
                let terrain = shape.frames[0].map_or(own, |frame| placed[frame] * own);
                for frame in &moving {
                    let at = terrain.inverse_transform_point(&placed[*frame].translation.vector.into());
                    for (bound, x) in bounds.iter_mut().zip([at.x, at.y]) {
                        *bound = [bound[0].min(x), bound[1].max(x)];
                    }
                }
            }
            let [u, w] = bounds.map(|[low, high]| match low <= high {
                true => [low - beyond, high + beyond],
                false => [-beyond, beyond],
            });
            let point_on_terrain = |u: f64, w: f64| [u, w, height(number, [u, w]).unwrap_or(f64::NAN)];
            if let Ok(mesh) = TriangleMesh::triangulate_surface(u, w, point_on_terrain) {
                (shape.kind, shape.mesh) = (Kind::Mesh(""), Some(mesh));
                // Unit scales along the axes.
                shape.numbers.extend([1.0; 3]);
            }
        }
    }
}
