//! Triangles from files: STL (binary or ASCII), OBJ, and [COLLADA](crate::collada).

use crate::encode::base64;
use crate::{Error, collada, text};
use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

/// Triangle mesh as a list of corners, three for each triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TriangleMesh {
    corners: Vec<[f32; 3]>,
}

/// Maximum number of triangles of a mesh file: a page with more would be large and slow.
pub(crate) const MAX_TRIANGLES: usize = 200_000;

/// Number of cells of a triangulated surface along each of its two directions.
const CELLS: u32 = 80;

impl TriangleMesh {
    /// Triangulates a surface between bounds of its two parameters, with two triangles per cell.
    pub(crate) fn triangulate_surface(
        u: [f64; 2],
        w: [f64; 2],
        place: impl Fn(f64, f64) -> [f64; 3],
    ) -> Result<TriangleMesh, String> {
        for [low, high] in [u, w] {
            if !(low < high && (high - low).is_finite()) {
                return Err(format!("expected bounds that increase, found {low} and {high}"));
            }
        }
        let interpolate =
            |[low, high]: [f64; 2], k: u32| low + (high - low) * f64::from(k) / f64::from(CELLS);
        let position_of_grid_corner = |j: u32, k: u32| {
            let (u, w) = (interpolate(u, j), interpolate(w, k));
            let place = place(u, w);
            match place.iter().all(|x| (*x as f32).is_finite()) {
                true => Ok(place.map(|x| x as f32)),
                false => Err(format!("at {u}, {w} its place is not finite")),
            }
        };
        let mut corners = Vec::new();
        for j in 0..CELLS {
            for k in 0..CELLS {
                let [a, b] = [position_of_grid_corner(j, k)?, position_of_grid_corner(j + 1, k)?];
                let [c, d] = [position_of_grid_corner(j + 1, k + 1)?, position_of_grid_corner(j, k + 1)?];
                corners.extend([a, b, c, a, c, d]);
            }
        }
        Ok(TriangleMesh { corners })
    }

    /// Returns the distance of the mesh's farthest corner from the origin.
    pub(crate) fn radius_of_mesh(&self) -> f64 {
        let corner_norm = |c: &[f32; 3]| c.iter().map(|x| f64::from(*x) * f64::from(*x)).sum::<f64>().sqrt();
        self.corners.iter().map(corner_norm).fold(0.0, f64::max)
    }

    /// Returns at most `count` corners of the mesh, evenly chosen.
    pub(crate) fn sampled_corners(&self, count: usize) -> Vec<[f64; 3]> {
        let step = self.corners.len().div_ceil(count).max(1);
        self.corners.iter().step_by(step).map(|corner| corner.map(f64::from)).collect()
    }

    /// Serialises the mesh as JSON, with 16 bits per coordinate and coinciding corners merged: lowest corner,
    /// step sizes, positions, indices.
    pub(crate) fn mesh_json(&self) -> String {
        let extreme_corner_coordinates = |f: fn(f32, f32) -> f32, from: f32| {
            [0, 1, 2].map(|k| self.corners.iter().map(|c| c[k]).fold(from, f))
        };
        let (low, high) = (
            extreme_corner_coordinates(f32::min, f32::INFINITY),
            extreme_corner_coordinates(f32::max, f32::NEG_INFINITY),
        );
        let steps = [0, 1, 2].map(|k| (f64::from(high[k]) - f64::from(low[k])).max(1e-12) / 65535.0);
        let (mut numbers, mut places, mut indices) = (HashMap::new(), Vec::new(), Vec::new());
        for corner in &self.corners {
            let place: [u16; 3] = std::array::from_fn(|k| {
                ((f64::from(corner[k]) - f64::from(low[k])) / steps[k]).round() as u16
            });
            let next = numbers.len() as u32;
            let number = *numbers.entry(place).or_insert_with(|| {
                places.extend(place.iter().flat_map(|x| x.to_le_bytes()));
                next
            });
            indices.extend(number.to_le_bytes());
        }
        text::list([
            text::numbers(&low.map(f64::from)),
            text::numbers(&steps),
            text::json(&base64(&places)),
            text::json(&base64(&indices)),
        ])
    }
}

/// Returns the mesh file in a folder that a path in a robot file refers to, if it exists.
pub(crate) fn find_mesh_file(folder: &Path, path: &str) -> Option<PathBuf> {
    let path = path.split_once("://").map_or(path, |(_, path)| path);
    // `..` is dropped, so that no file outside the folder is read.
    let names: Vec<&std::ffi::OsStr> = Path::new(path)
        .components()
        .filter_map(|part| match part {
            Component::Normal(name) => Some(name),
            _ => None,
        })
        .collect();
    let candidates =
        (0..names.len()).map(|k| names[k..].iter().fold(folder.to_path_buf(), |p, name| p.join(name)));
    candidates.into_iter().find(|candidate| candidate.is_file())
}

/// Reads a triangle mesh in the format that the extension of the file determines.
pub(crate) fn read_mesh(path: &Path) -> Result<TriangleMesh, Error> {
    let bytes = std::fs::read(path).map_err(|cause| Error::File { path: path.to_path_buf(), cause })?;
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let mesh = match ending.as_deref() {
        Some("stl") => read_stl(&bytes),
        Some("obj") => read_obj(&String::from_utf8_lossy(&bytes)),
        Some("dae") => collada::corners_of_triangles(&String::from_utf8_lossy(&bytes))
            .map(|corners| TriangleMesh { corners }),
        _ => Err("expected an STL, OBJ or COLLADA (.dae) file".to_string()),
    };
    let mesh = mesh.and_then(|mesh| match mesh.corners.len() / 3 {
        0 => Err("no triangles".to_string()),
        n if n > MAX_TRIANGLES => {
            Err(format!("{n} triangles, more than {MAX_TRIANGLES}: take a simplified mesh"))
        }
        _ if mesh.corners.iter().flatten().any(|x| !x.is_finite()) => {
            Err("a corner is not finite".to_string())
        }
        _ => Ok(mesh),
    });
    mesh.map_err(|what| Error::Mesh { path: path.to_path_buf(), what })
}

/// Reads an STL file. A binary file has a header of 80 bytes, the number of triangles, and 50 bytes per
/// triangle. It is distinguished from ASCII by its length, since its header may also begin with `solid`.
fn read_stl(bytes: &[u8]) -> Result<TriangleMesh, String> {
    let count = bytes.get(80..84).and_then(|n| n.try_into().ok()).map(u32::from_le_bytes);
    if let Some(count) = count.filter(|n| bytes.len() as u64 == 84 + 50 * u64::from(*n)) {
        let read_float = |b: &[u8]| b.try_into().map_or(f32::NAN, f32::from_le_bytes);
        let mut mesh = TriangleMesh { corners: Vec::with_capacity(3 * count as usize) };
        for triangle in bytes[84..].chunks_exact(50) {
            let numbers: Vec<f32> = triangle[12..48].chunks_exact(4).map(read_float).collect();
            mesh.corners.extend(numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]));
        }
        return Ok(mesh);
    }
    let text = std::str::from_utf8(bytes).map_err(|_| "neither a binary STL file nor one of text")?;
    if !text.trim_start().starts_with("solid") {
        return Err("neither a binary STL file nor one of text".to_string());
    }
    let mut mesh = TriangleMesh::default();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        if words.next() == Some("vertex") {
            mesh.corners.push(
                parse_number_triple(words)
                    .ok_or_else(|| format!("expected three numbers: `{}`", line.trim()))?,
            );
        }
    }
    match mesh.corners.len() % 3 {
        0 => Ok(mesh),
        _ => Err("a triangle without three corners".to_string()),
    }
}

/// Reads the corners and faces of an OBJ file; faces with more than three corners are triangulated as fans.
fn read_obj(text: &str) -> Result<TriangleMesh, String> {
    let (mut corners, mut mesh): (Vec<[f32; 3]>, TriangleMesh) = (Vec::new(), TriangleMesh::default());
    for line in text.lines() {
        let unreadable_line_error = || format!("cannot be read: `{}`", line.trim());
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => corners.push(parse_number_triple(words).ok_or_else(unreadable_line_error)?),
            Some("f") => {
                let parse_face_corner = |word: &str| {
                    let n: i64 = word.split('/').next()?.parse().ok()?;
                    let at = if n < 0 { corners.len() as i64 + n } else { n - 1 };
                    corners.get(usize::try_from(at).ok()?).copied()
                };
                let face: Vec<[f32; 3]> =
                    words.map(parse_face_corner).collect::<Option<_>>().ok_or_else(unreadable_line_error)?;
                for pair in face.get(1..).unwrap_or_default().windows(2) {
                    mesh.corners.extend([face[0], pair[0], pair[1]]);
                }
            }
            _ => {}
        }
    }
    Ok(mesh)
}

fn parse_number_triple<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<[f32; 3]> {
    let mut parse_next_number = || words.next()?.parse().ok();
    Some([parse_next_number()?, parse_next_number()?, parse_next_number()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];

    #[test]
    fn stl_and_obj_give_the_same_triangle() {
        let mut binary = vec![0; 80];
        binary.extend(1_u32.to_le_bytes());
        binary.extend([0; 12]);
        TRIANGLE.iter().flatten().for_each(|x| binary.extend(x.to_le_bytes()));
        binary.extend([0; 2]);
        let ascii = "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 0\n\
                     endloop\nendfacet\nendsolid";
        let object = "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1/1/1 2/2/2 -1\n";
        for mesh in [read_stl(&binary), read_stl(ascii.as_bytes()), read_obj(object)] {
            assert_eq!(mesh, Ok(TriangleMesh { corners: TRIANGLE.to_vec() }));
        }
        assert_eq!(TriangleMesh { corners: TRIANGLE.to_vec() }.radius_of_mesh(), 2.0);
    }

    #[test]
    fn invalid_mesh_files_are_errors() {
        for (what, found) in [
            ("neither", read_stl(&[0xff; 90])),
            ("three numbers", read_stl(b"solid\nvertex 0 zero 0")),
            ("three corners", read_stl(b"solid\nvertex 0 0 0")),
            ("cannot be read", read_obj("v 0 0 0\nf 1 2 3")),
            ("cannot be read", read_obj("v 0 0")),
        ] {
            assert!(found.unwrap_err().contains(what), "{what}");
        }
        // The file is shorter than its number of triangles requires.
        let mut short = vec![0; 80];
        short.extend(u32::MAX.to_le_bytes());
        assert!(read_stl(&short).is_err());
    }

    #[test]
    fn mesh_paths_stay_in_the_folder() {
        assert_eq!(find_mesh_file(Path::new("/nowhere"), "package://robot/../../etc/hosts"), None);
        let source = Path::new(env!("CARGO_MANIFEST_DIR"));
        assert_eq!(
            find_mesh_file(source, "package://any/deep/src/mesh.rs"),
            Some(source.join("src/mesh.rs"))
        );
    }
}
