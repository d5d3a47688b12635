//! Drawing of surfaces in contact.

use super::surface::{Surface, SurfaceForm};
use crate::expr::{Expr, Vec3};
use crate::mechanism::drawing::{entries_by_row, entries_of_vectors, pose_relative_to_named_frame};
use crate::mechanism::{NamedFrame, Piece, PieceShape, ShownObjectKind};

/// Returns the pieces for surfaces with the names of their contacts, each once, and the heights of terrains.
pub fn surface_pieces<'g>(
    surfaces: &[(String, Surface<'g>)],
    frames: &[NamedFrame<'g>],
) -> (Vec<Piece<'g>>, Vec<Expr<'g>>) {
    let (mut pieces, mut heights) = (Vec::<Piece<'g>>::new(), Vec::new());
    for (name, surface) in surfaces {
        let edges = hull_pieces(frames, name, surface);
        for drawing_piece in edges.into_iter().chain(surface_piece(frames, name, surface, &mut heights)) {
            let is_same_drawn_piece = |known: &Piece<'g>| {
                known.kind == drawing_piece.kind
                    && known.frames == drawing_piece.frames
                    && known.numbers == drawing_piece.numbers
            };
            if !pieces.iter().any(is_same_drawn_piece) {
                pieces.push(drawing_piece);
            }
        }
    }
    (pieces, heights)
}

/// Returns the edges of a hull as bars; its points if they depend on parameters.
fn hull_pieces<'g>(
    frames: &[NamedFrame<'g>],
    name: &str,
    Surface { frame, form }: &Surface<'g>,
) -> Vec<Piece<'g>> {
    let SurfaceForm::Hull(hull) = form else { return Vec::new() };
    let Some((index, pose)) = pose_relative_to_named_frame(frames, frame.link, &frame.pose) else {
        return Vec::new();
    };
    let position_in_named_frame = |p: Vec3<'g>| pose.translation + pose.rotation.vector_in_parent_axes(p);
    let drawing_piece = |kind, frames, ends: &[Vec3<'g>]| {
        let numbers =
            entries_of_vectors(&ends.iter().map(|p| position_in_named_frame(*p)).collect::<Vec<_>>());
        Piece { name: name.to_string(), role: ShownObjectKind::Surface, kind, frames, numbers }
    };
    match &hull.shape {
        Some(shape) => {
            let ends = shape.edges.iter().map(|edge| edge.map(|k| hull.vertices[k]));
            ends.map(|ends| drawing_piece(PieceShape::Bar, [index, index], &ends)).collect()
        }
        None => {
            hull.vertices.iter().map(|p| drawing_piece(PieceShape::Point, [index, None], &[*p])).collect()
        }
    }
}

fn surface_piece<'g>(
    frames: &[NamedFrame<'g>],
    name: &str,
    Surface { frame, form }: &Surface<'g>,
    heights: &mut Vec<Expr<'g>>,
) -> Option<Piece<'g>> {
    let (index, pose) = pose_relative_to_named_frame(frames, frame.link, &frame.pose)?;
    let at = entries_of_vectors(&[pose.translation]);
    let numbers_of_axial_shape = |axis, numbers: &[Expr<'g>]| {
        [entries_of_vectors(&[pose.translation, pose.rotation.vector_in_parent_axes(axis)]), numbers.to_vec()]
            .concat()
    };
    let numbers_of_oriented_shape = |lengths: &[Expr<'g>; 3]| {
        [at.clone(), entries_by_row(&pose.rotation.rotation_matrix()), lengths.to_vec()].concat()
    };
    let (kind, numbers) = match form {
        SurfaceForm::Circle(r, n) => (PieceShape::Ring, numbers_of_axial_shape(*n, &[*r])),
        SurfaceForm::Torus(r, tube, n) => (PieceShape::Torus, numbers_of_axial_shape(*n, &[*r, *tube])),
        SurfaceForm::Sphere(r) => (PieceShape::Sphere, [at.clone(), vec![*r]].concat()),
        SurfaceForm::Bowl(r) => (PieceShape::Bowl, [at.clone(), vec![*r]].concat()),
        SurfaceForm::Ellipsoid(lengths) => (PieceShape::Ellipsoid, numbers_of_oriented_shape(lengths)),
        SurfaceForm::Cuboid(lengths) => (PieceShape::Cuboid, numbers_of_oriented_shape(lengths)),
        SurfaceForm::Plane(n) => (PieceShape::Plane, numbers_of_axial_shape(*n, &[])),
        SurfaceForm::Cylinder(r, n) | SurfaceForm::Tube(r, n) => {
            (PieceShape::Pipe, numbers_of_axial_shape(*n, &[*r]))
        }
        SurfaceForm::Drum(r, length, n) => (PieceShape::Cylinder, numbers_of_axial_shape(*n, &[*r, *length])),
        SurfaceForm::Capsule(r, length, n) => {
            (PieceShape::Capsule, numbers_of_axial_shape(*n, &[*r, *length]))
        }
        SurfaceForm::Cone(half, n) | SurfaceForm::Funnel(half, n) => {
            (PieceShape::Funnel, numbers_of_axial_shape(*n, &[*half]))
        }
        SurfaceForm::Point => (PieceShape::Point, at.clone()),
        SurfaceForm::Terrain(terrain) => {
            let known = heights.iter().position(|height| *height == terrain.height);
            let number = known.unwrap_or(heights.len());
            heights.extend(known.is_none().then_some(terrain.height));
            (
                PieceShape::Terrain(number),
                [at.clone(), entries_by_row(&pose.rotation.rotation_matrix())].concat(),
            )
        }
        // A sheet is unbounded and has no axis of symmetry; a hull is drawn by its edges.
        SurfaceForm::ParametricSurface(_) | SurfaceForm::Hull(_) => return None,
    };
    Some(Piece {
        name: name.to_string(),
        role: ShownObjectKind::Surface,
        kind,
        frames: [index, None],
        numbers,
    })
}
