//! Mesh files: STL, OBJ and MuJoCo's own format. This module knows no format of robot files.

use super::context::quote_word;
use super::pose::{Vector, vector_norm, vector_sum, vector_times_scalar};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Maximum size of a mesh file, bytes.
const LARGEST: u64 = 64 << 20;

/// Number of folders above that of a robot file in which its packages are searched.
const ABOVE: usize = 4;

/// Corners of a triangle of a mesh, m.
pub(super) type Triangle = [Vector; 3];

/// Returns the paths at which a mesh may be, most likely first. `package://` and `model://` begin with the
/// name of a folder, which contains the robot file or is next to a folder that contains it.
pub(super) fn candidate_paths(folder: &Path, uri: &str) -> Vec<PathBuf> {
    let Some((scheme, rest)) = uri.split_once("://") else { return vec![folder.join(uri)] };
    if scheme == "file" {
        return vec![folder.join(rest)];
    }
    let inner = rest.split_once('/').map_or(rest, |(_, inner)| inner);
    let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_path_buf());
    folder.ancestors().take(ABOVE).flat_map(|above| [above.join(rest), above.join(inner)]).collect()
}

/// Reads the triangles of a mesh file, or returns an error message. `name` is the path for messages.
pub(super) fn read_triangles(path: &Path, name: &str) -> Result<Vec<Triangle>, String> {
    let shown = quote_word(name);
    let bytes = read_mesh_file_bytes(path).map_err(|why| format!("cannot read the mesh {shown}: {why}"))?;
    let end = path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let triangles = match end.as_str() {
        "stl" => read_stl(&bytes),
        "obj" => read_obj(&bytes),
        "msh" => read_msh(&bytes),
        _ => {
            return Err(format!("mesh {shown} has an unsupported format: expected `.stl`, `.obj` or `.msh`"));
        }
    };
    triangles.ok_or_else(|| format!("mesh {shown} is damaged, or has the wrong extension"))
}

fn read_mesh_file_bytes(path: &Path) -> Result<Vec<u8>, String> {
    let about = fs::metadata(path).map_err(|error| error.to_string())?;
    if !about.is_file() {
        return Err("it is not a regular file".to_string());
    }
    let mut bytes = Vec::new();
    let file = fs::File::open(path).map_err(|error| error.to_string())?;
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if bytes.len() as u64 > LARGEST {
        return Err(format!("it has more than {} MiB", LARGEST >> 20));
    }
    Ok(bytes)
}

/// Returns three little-endian single-precision numbers of a binary mesh file.
fn read_f32_vector(bytes: &[u8], at: usize) -> Option<Vector> {
    let read_f32 = |k: usize| {
        let word = bytes.get(at + 4 * k..at + 4 * k + 4)?;
        Some(f64::from(f32::from_le_bytes(word.try_into().ok()?)))
    };
    Some([read_f32(0)?, read_f32(1)?, read_f32(2)?])
}

fn read_u32(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..at + 4)?;
    usize::try_from(i32::from_le_bytes(word.try_into().ok()?)).ok()
}

/// Reads STL, binary or as text. A binary file has a header of 80 bytes, the number of triangles, and for
/// each triangle a normal, three corners and two more bytes.
fn read_stl(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let Some(count) = read_u32(bytes, 80).filter(|count| bytes.len() == 84 + 50 * count) else {
        return read_stl_text(std::str::from_utf8(bytes).ok()?);
    };
    (0..count)
        .map(|k| {
            let at = 84 + 50 * k;
            Some([
                read_f32_vector(bytes, at + 12)?,
                read_f32_vector(bytes, at + 24)?,
                read_f32_vector(bytes, at + 36)?,
            ])
        })
        .collect()
}

/// Reads STL as text: lines `vertex x y z`, three for each triangle.
fn read_stl_text(text: &str) -> Option<Vec<Triangle>> {
    let mut corners = Vec::new();
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        if words.next() == Some("vertex") {
            let mut next_number = || words.next()?.parse::<f64>().ok();
            corners.push([next_number()?, next_number()?, next_number()?]);
        }
    }
    let triangles: Vec<Triangle> = corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    (!triangles.is_empty() && corners.len() % 3 == 0).then_some(triangles)
}

/// Reads MuJoCo's own format: the numbers of vertices, normals, texture coordinates and triangles, followed
/// by these data.
fn read_msh(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let [vertices, normals, coordinates, faces] =
        [read_u32(bytes, 0)?, read_u32(bytes, 4)?, read_u32(bytes, 8)?, read_u32(bytes, 12)?];
    let start = 16 + 12 * vertices + 12 * normals + 8 * coordinates;
    if faces == 0 || bytes.len() != start + 12 * faces {
        return None;
    }
    let triangle_corner = |face: usize, k: usize| {
        let number = read_u32(bytes, start + 12 * face + 4 * k).filter(|number| *number < vertices)?;
        read_f32_vector(bytes, 16 + 12 * number)
    };
    (0..faces)
        .map(|face| Some([triangle_corner(face, 0)?, triangle_corner(face, 1)?, triangle_corner(face, 2)?]))
        .collect()
}

/// Reads Wavefront OBJ: lines `v x y z` and `f a/b/c …`. Indices count from one, or from the end if negative.
pub(super) fn read_obj(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let text = std::str::from_utf8(bytes).ok()?;
    let (mut vertices, mut triangles): (Vec<Vector>, Vec<Triangle>) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let mut next_number = || Some(f64::from(words.next()?.parse::<f32>().ok()?));
                vertices.push([next_number()?, next_number()?, next_number()?]);
            }
            Some("f") => {
                let referenced_vertex = |word: &str| {
                    let number: i64 = word.split('/').next()?.parse().ok()?;
                    let index = if number < 0 { vertices.len() as i64 + number } else { number - 1 };
                    vertices.get(usize::try_from(index).ok()?).copied()
                };
                let corners = words.map(referenced_vertex).collect::<Option<Vec<Vector>>>()?;
                triangulate_face(&corners, &mut triangles)?;
            }
            _ => {}
        }
    }
    (!triangles.is_empty()).then_some(triangles)
}

/// Triangulates a face: a quadrilateral along its shorter diagonal, any other face from its first corner.
fn triangulate_face(corners: &[Vector], triangles: &mut Vec<Triangle>) -> Option<()> {
    match corners {
        [a, b, c, d] => {
            let distance_of_points =
                |a: &Vector, b: &Vector| vector_norm(vector_sum(*a, vector_times_scalar(*b, -1.0)));
            if distance_of_points(a, c) < distance_of_points(b, d) {
                triangles.extend([[*a, *b, *c], [*a, *c, *d]]);
            } else {
                triangles.extend([[*a, *b, *d], [*b, *c, *d]]);
            }
        }
        [first, rest @ ..] if rest.len() > 1 => {
            triangles.extend(rest.iter().zip(rest.iter().skip(1)).map(|(b, c)| [*first, *b, *c]));
        }
        _ => return None,
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangle_mesh_is_read_in_every_format() {
        let corners: Triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.5]];
        let corner_bytes = || corners.iter().flatten().flat_map(|x| (*x as f32).to_le_bytes());
        let u32_bytes = |n: u32| n.to_le_bytes();
        let binary: Vec<u8> = [b'x'; 80]
            .into_iter()
            .chain(u32_bytes(1))
            .chain([0; 12])
            .chain(corner_bytes())
            .chain([0; 2])
            .collect();
        let counts = [3, 0, 0, 1].into_iter().flat_map(u32_bytes);
        let own: Vec<u8> =
            counts.chain(corner_bytes()).chain([0, 1, 2].into_iter().flat_map(u32_bytes)).collect();
        let text = "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 5e-1\n\
                    endloop\nendfacet\nendsolid";
        let object = "v 0 0 0\nv 1 0 0\nv 0 2 0.5\nf 1/1/1 2/2/2 -1\n";
        for found in
            [read_stl(&binary), read_stl(text.as_bytes()), read_obj(object.as_bytes()), read_msh(&own)]
        {
            assert_eq!(found, Some(vec![corners]));
        }
        assert!(
            (0..binary.len())
                .all(|end| read_stl(&binary[..end]).is_none() && read_msh(&binary[..end]).is_none())
        );
    }

    #[test]
    fn package_paths_are_resolved_above_the_robot_file() {
        let found = candidate_paths(Path::new("/a/robot/urdf"), "package://robot/meshes/foot.stl");
        assert_eq!(found[0], Path::new("/a/robot/urdf/robot/meshes/foot.stl"));
        assert!(found.contains(&PathBuf::from("/a/robot/meshes/foot.stl")));
        assert_eq!(candidate_paths(Path::new("/a"), "b/c.obj"), [PathBuf::from("/a/b/c.obj")]);
        assert_eq!(candidate_paths(Path::new("/a"), "file:///b/c.obj"), [PathBuf::from("/b/c.obj")]);
    }

    #[test]
    fn damaged_mesh_files_are_rejected() {
        for text in [
            "",
            "v 1 2",
            "f 1 2 3",
            "v 1 1 1\nf 1 1",
            "v 1 1 x",
            "f a b c",
            "v 0 0 0\nf 9999999999999999999 1 1",
        ] {
            assert!(read_obj(text.as_bytes()).is_none(), "{text}");
        }
        assert!(read_stl(&[0xff; 84]).is_none() && read_msh(&[0x7f; 40]).is_none());
    }
}
