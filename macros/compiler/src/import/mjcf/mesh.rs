//! Volume and mass properties of meshes, computed as MuJoCo does by default.
//!
//! A mesh is the sum of the pyramids from an interior point to its triangles (MuJoCo,
//! `mjCMesh::ComputeInertia`). The interior point is the centroid of the surface for the centre of mass, and
//! the centre of mass for the inertia. With `inertia="legacy"`, the default, the volume of each pyramid
//! counts as positive.

use super::defaults::{Defaults, Element};
use super::geometry::Mass;
use super::settings::Settings;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{Node, child_elements, element_position, read_name_attribute};
use crate::import::pose::{
    Matrix, Vector, add, cross, dot, length, matrix_times_vector, of_quaternion, scale_vector, transpose,
};
use crate::syntax::{Mesh, Name};
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest size of a mesh file, bytes.
const LARGEST: u64 = 64 << 20;

/// Areas and volumes below this value are treated as zero.
const NOTHING: f64 = 1e-15;

type Triangle = [Vector; 3];

/// Meshes of a file. A mesh is read only if its mass properties are needed.
pub(super) struct Meshes<'a> {
    folder: PathBuf,
    /// Whether the folders in file names are ignored.
    strips: bool,
    known: BTreeMap<String, Element<'a>>,
    /// Mass properties at density 1 of the meshes that were read.
    read: BTreeMap<String, Option<Mass>>,
    /// Paths of the files that were read.
    pub(super) files: Vec<PathBuf>,
}

impl<'a> Meshes<'a> {
    /// Lists the meshes of the root element. Paths are relative to `folder`.
    pub(super) fn list(
        root: Node<'a>,
        folder: &Path,
        settings: &Settings,
        defaults: &Defaults<'a>,
        cx: &mut Cx<'_>,
    ) -> Meshes<'a> {
        let assets =
            child_elements(root).filter(|node| node.tag_name().name() == "asset").flat_map(child_elements);
        let mut known = BTreeMap::new();
        for node in assets.filter(|node| node.tag_name().name() == "mesh") {
            let element = defaults.element(node, &["mesh"], 0, cx);
            let stem = node.attribute("file").map(|file| {
                Path::new(file)
                    .file_stem()
                    .map(|stem| stem.to_string_lossy().into_owned())
                    .unwrap_or_default()
            });
            if let Some(name) = node.attribute("name").map(str::to_string).or(stem) {
                known.insert(name, element);
            }
        }
        let (folder, strips) = (folder.join(&settings.meshes), settings.strip_paths);
        Meshes { folder, strips, known, read: BTreeMap::new(), files: Vec::new() }
    }

    /// Returns the mass properties at density 1 of a mesh shape, in the axes of the mesh file.
    pub(super) fn of_shape(&mut self, shape: &Element<'a>, cx: &mut Cx<'_>) -> Option<Mass> {
        let Some(mesh) = shape.name("mesh", cx) else {
            cx.report_error(
                &element_position(shape.node, cx),
                "a shape of type `mesh` without `mesh`",
                |d| d,
            );
            return None;
        };
        if let Some(known) = self.read.get(&mesh.text) {
            return *known;
        }
        let Some(element) = self.known.get(&mesh.text).cloned() else {
            let known = self.known.keys().map(String::as_str);
            cx.report_error(&mesh.place, format!("unknown mesh {}", quote_word(&mesh.text)), |d| {
                d.suggest_name(&mesh.text, known)
            });
            return None;
        };
        let found = self.mass(&element, cx);
        self.read.insert(mesh.text, found);
        found
    }

    /// Returns the mesh to draw for a shape, in the axes of the mesh file; `None` for a mesh with reference
    /// axes of its own.
    pub(super) fn drawn(&self, shape: &Element<'a>, cx: &mut Cx<'_>) -> Option<Mesh> {
        let element = self.known.get(shape.text("mesh")?)?;
        if element.with_any(&["refpos", "refquat"]).is_some() {
            return None;
        }
        let scale = element.numbers("scale", cx).map_or([1.0; 3], |found| found.value);
        Some(Mesh { path: element.text("file")?.to_string(), scale })
    }

    fn mass(&mut self, element: &Element<'a>, cx: &mut Cx<'_>) -> Option<Mass> {
        let exact = match element.text("inertia") {
            None | Some("legacy") => false,
            Some("exact") => true,
            Some(other) => {
                let message = format!("`inertia` {} of a mesh is not supported", quote_word(other));
                let help =
                    "expected `legacy` or `exact`, or an `<inertial>` in the bodies that have the mesh";
                cx.report_error(&element.place("inertia", cx), message, |d| d.add_help(help));
                return None;
            }
        };
        if element.node.attribute("file").is_none() {
            let message = "the mass of a mesh without `file` is not computed";
            cx.report_error(&element_position(element.node, cx), message, |d| {
                d.add_help(super::geometry::NEEDS_INERTIAL)
            });
            return None;
        }
        let file = read_name_attribute(element.node, "file", cx)?;
        let stripped = Path::new(&file.text).file_name().filter(|_| self.strips);
        let path = self.folder.join(stripped.unwrap_or(file.text.as_ref()));
        let mut triangles = read(&path, &file, cx)?;
        self.files.push(path);
        self.transform(element, &mut triangles, cx);
        let found = solid(&triangles, exact);
        if found.is_none() {
            let message = format!("mesh {} has no volume", quote_word(&file.text));
            cx.report_error(&file.place, message, |d| d.add_help(super::geometry::NEEDS_INERTIAL));
        }
        found
    }

    /// Applies `refpos`, `refquat` and `scale`, in this order.
    fn transform(&self, element: &Element<'a>, triangles: &mut [Triangle], cx: &mut Cx<'_>) {
        let from = element.numbers("refpos", cx).map_or([0.0; 3], |found| found.value);
        let factors = element.numbers("scale", cx).map_or([1.0; 3], |found| found.value);
        let quat = element.numbers::<4>("refquat", cx).map_or([1.0, 0.0, 0.0, 0.0], |found| found.value);
        let size = quat.iter().map(|x| x * x).sum::<f64>().sqrt();
        let axes: Matrix = transpose(&of_quaternion(quat.map(|x| x / size)));
        for corner in triangles.iter_mut().flatten() {
            let turned = matrix_times_vector(&axes, add(*corner, scale_vector(from, -1.0)));
            *corner = std::array::from_fn(|k| turned[k] * factors[k]);
        }
        // A reflection reverses the orientation of the triangles.
        if factors.iter().product::<f64>() < 0.0 {
            triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
    }
}

/// Returns the mass properties at density 1 of a triangulated solid; `None` if its volume is zero.
fn solid(triangles: &[Triangle], exact: bool) -> Option<Mass> {
    let count = |volume: f64| if exact { volume } else { volume.abs() };
    let (mut area, mut middle) = (0.0, [0.0; 3]);
    for [a, b, c] in triangles {
        let one = length(cross(add(*b, scale_vector(*a, -1.0)), add(*c, scale_vector(*a, -1.0)))) / 2.0;
        area += one;
        middle = add(middle, scale_vector(add(add(*a, *b), *c), one / 3.0));
    }
    if area < NOTHING || !area.is_finite() {
        return None;
    }
    let middle = scale_vector(middle, 1.0 / area);
    let (mut volume, mut com) = (0.0, [0.0; 3]);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| add(corner, scale_vector(middle, -1.0)));
        let one = count(dot(a, cross(b, c)) / 6.0);
        volume += one;
        com = add(com, scale_vector(add(add(a, b), c), one / 4.0));
    }
    if volume < NOTHING || !volume.is_finite() {
        return None;
    }
    let com = add(middle, scale_vector(com, 1.0 / volume));
    let (mut mass, mut products) = (0.0, [[0.0; 3]; 3]);
    for triangle in triangles {
        let corners = triangle.map(|corner| add(corner, scale_vector(com, -1.0)));
        let [a, b, c] = corners;
        let one = count(dot(a, cross(b, c)) / 6.0);
        mass += one;
        let sum = add(add(a, b), c);
        for (i, row) in products.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                // ∫ xᵢ xⱼ over a pyramid whose apex is the origin.
                let corners: f64 = corners.iter().map(|corner| corner[i] * corner[j]).sum();
                *entry += one / 20.0 * (sum[i] * sum[j] + corners);
            }
        }
    }
    let trace = products[0][0] + products[1][1] + products[2][2];
    let inertia = std::array::from_fn(|i| {
        std::array::from_fn(|j| if i == j { trace - products[i][i] } else { -products[i][j] })
    });
    Some(Mass { mass, com, inertia })
}

impl Mass {
    /// Rescales the body to another mass.
    pub(super) fn of_mass(&self, mass: f64) -> Mass {
        Mass { mass, com: self.com, inertia: self.inertia.map(|row| scale_vector(row, mass / self.mass)) }
    }
}

/// Reads a mesh. Errors are reported at the name of the mesh.
fn read(path: &Path, name: &Name, cx: &mut Cx<'_>) -> Option<Vec<Triangle>> {
    let shown = quote_word(&name.text);
    let found =
        read_bytes(path).map_err(|why| format!("cannot read the mesh {shown}: {why}")).and_then(|bytes| {
            let end =
                path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
            let triangles = match end.as_str() {
                "stl" => stl(&bytes),
                "obj" => obj(&bytes),
                "msh" => msh(&bytes),
                _ => {
                    return Err(format!(
                        "mesh {shown} has an unsupported format: expected `.stl`, `.obj` or `.msh`"
                    ));
                }
            };
            triangles.ok_or_else(|| format!("mesh {shown} is damaged, or has the wrong extension"))
        });
    match found {
        Ok(triangles) => Some(triangles),
        Err(message) => {
            cx.report_error(&name.place, message, |d| match path.is_file() {
                true => d,
                false => d
                    .add_help(format!("looked for `{}`", path.display()))
                    .add_help(super::geometry::NEEDS_INERTIAL),
            });
            None
        }
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
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

/// Returns three little-endian single-precision numbers.
fn vector(bytes: &[u8], at: usize) -> Option<Vector> {
    let number = |k: usize| {
        let word = bytes.get(at + 4 * k..at + 4 * k + 4)?;
        Some(f64::from(f32::from_le_bytes(word.try_into().ok()?)))
    };
    Some([number(0)?, number(1)?, number(2)?])
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..at + 4)?;
    usize::try_from(i32::from_le_bytes(word.try_into().ok()?)).ok()
}

/// Reads binary STL: a header of 80 bytes, the number of triangles, and for each triangle a normal, three
/// corners and two more bytes.
fn stl(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let count = word(bytes, 80)?;
    if bytes.len() != 84 + 50 * count {
        return None;
    }
    (0..count)
        .map(|k| {
            let at = 84 + 50 * k;
            Some([vector(bytes, at + 12)?, vector(bytes, at + 24)?, vector(bytes, at + 36)?])
        })
        .collect()
}

/// Reads MuJoCo's own format: the numbers of vertices, normals, texture coordinates and triangles, followed
/// by these data.
fn msh(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let [vertices, normals, coordinates, faces] =
        [word(bytes, 0)?, word(bytes, 4)?, word(bytes, 8)?, word(bytes, 12)?];
    let start = 16 + 12 * vertices + 12 * normals + 8 * coordinates;
    if faces == 0 || bytes.len() != start + 12 * faces {
        return None;
    }
    let corner = |face: usize, k: usize| {
        let number = word(bytes, start + 12 * face + 4 * k).filter(|number| *number < vertices)?;
        vector(bytes, 16 + 12 * number)
    };
    (0..faces).map(|face| Some([corner(face, 0)?, corner(face, 1)?, corner(face, 2)?])).collect()
}

/// Reads Wavefront OBJ: lines `v x y z` and `f a/b/c …`. Indices count from one, or from the end if negative.
fn obj(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let text = std::str::from_utf8(bytes).ok()?;
    let (mut vertices, mut triangles): (Vec<Vector>, Vec<Triangle>) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let mut number = || Some(f64::from(words.next()?.parse::<f32>().ok()?));
                vertices.push([number()?, number()?, number()?]);
            }
            Some("f") => {
                let corner = |word: &str| {
                    let number: i64 = word.split('/').next()?.parse().ok()?;
                    let index = if number < 0 { vertices.len() as i64 + number } else { number - 1 };
                    vertices.get(usize::try_from(index).ok()?).copied()
                };
                let corners = words.map(corner).collect::<Option<Vec<Vector>>>()?;
                add_face(&corners, &mut triangles)?;
            }
            _ => {}
        }
    }
    (!triangles.is_empty()).then_some(triangles)
}

/// Triangulates a face: a quadrilateral along its shorter diagonal, any other face from its first corner.
fn add_face(corners: &[Vector], triangles: &mut Vec<Triangle>) -> Option<()> {
    match corners {
        [a, b, c, d] => {
            let across = |a: &Vector, b: &Vector| length(add(*a, scale_vector(*b, -1.0)));
            if across(a, c) < across(b, d) {
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

    /// Box with edges 2, 4 and 6 and a corner at (1, 1, 1), as six faces.
    const BOX: &str = "v 1 1 1\nv 3 1 1\nv 3 5 1\nv 1 5 1\nv 1 1 7\nv 3 1 7\nv 3 5 7\nv 1 5 7\n\
        f 4 3 2 1\nf 5/1 6/2 7/3 8/4\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf -8 -4 -1 -5\n";

    fn check(found: &Mass, at: f64) {
        assert!((found.mass - 48.0).abs() < 1e-12);
        let expected: Vector = [2.0 + at, 3.0, 4.0];
        assert!((0..3).all(|k| (found.com[k] - expected[k]).abs() < 1e-12), "{:?}", found.com);
        let moments = [48.0 / 12.0 * (16.0 + 36.0), 48.0 / 12.0 * (4.0 + 36.0), 48.0 / 12.0 * (4.0 + 16.0)];
        for i in 0..3 {
            for j in 0..3 {
                let expected = if i == j { moments[i] } else { 0.0 };
                assert!((found.inertia[i][j] - expected).abs() < 1e-10, "{:?}", found.inertia);
            }
        }
    }

    #[test]
    fn a_box_of_triangles_is_a_box() {
        let triangles = obj(BOX.as_bytes()).expect("a mesh");
        assert_eq!(triangles.len(), 12);
        check(&solid(&triangles, true).expect("a solid"), 0.0);
        check(&solid(&triangles, false).expect("a solid"), 0.0);
        let bytes: Vec<u8> = triangles
            .iter()
            .flat_map(|corners| {
                let numbers = [0.0; 3].into_iter().chain(corners.iter().flatten().copied());
                numbers.flat_map(|x| (x as f32).to_le_bytes()).chain([0; 2]).collect::<Vec<u8>>()
            })
            .collect();
        let file = [vec![b'x'; 80], (12_u32).to_le_bytes().to_vec(), bytes].concat();
        check(&solid(&stl(&file).expect("a mesh"), true).expect("a solid"), 0.0);
        assert!((0..file.len()).all(|end| stl(&file[..end]).is_none() && msh(&file[..end]).is_none()));
    }

    #[test]
    fn damaged_meshes_are_none() {
        for text in [
            "",
            "v 1 2",
            "f 1 2 3",
            "v 1 1 1\nf 1 1",
            "v 1 1 x",
            "f a b c",
            "v 0 0 0\nf 9999999999999999999 1 1",
        ] {
            assert!(obj(text.as_bytes()).is_none(), "{text}");
        }
        assert!(solid(&[[[0.0; 3]; 3]], false).is_none());
        assert!(stl(&[0xff; 84]).is_none() && msh(&[0x7f; 40]).is_none());
    }
}
