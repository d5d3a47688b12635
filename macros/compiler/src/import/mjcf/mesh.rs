//! Volume and mass properties of meshes, computed as MuJoCo does by default.
//!
//! A mesh is the sum of the pyramids from an interior point to its triangles (MuJoCo,
//! `mjCMesh::ComputeInertia`). The interior point is the centroid of the surface for the centre of mass, and
//! the centre of mass for the inertia. With `inertia="legacy"`, the default, the volume of each pyramid
//! counts as positive.

use super::defaults::{Defaults, ElementWithDefaults};
use super::geometry::BodyMassProperties;
use super::settings::MjcfSettings;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{Node, child_elements, element_source_position, read_name_attribute};
use crate::import::mesh::{self, Triangle};
use crate::import::pose::{
    Matrix, Vector, cross, dot, matrix_times_vector, rotation_of_quaternion, transpose, vector_norm,
    vector_sum, vector_times_scalar,
};
use crate::syntax::{Mesh, MeshVertices, Name};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Areas and volumes below this value are treated as zero.
const NOTHING: f64 = 1e-15;

/// Meshes of a file. A mesh is read only if its mass properties are needed.
pub(super) struct Meshes<'a> {
    folder: PathBuf,
    /// Whether the folders in names of mesh files are ignored.
    strips: bool,
    known: BTreeMap<String, ElementWithDefaults<'a>>,
    /// Mass properties at density 1 of the meshes that were read.
    read: BTreeMap<String, Option<BodyMassProperties>>,
    /// Paths of the mesh files that were read.
    pub(super) files: Vec<PathBuf>,
}

impl<'a> Meshes<'a> {
    /// Lists the meshes of the root element. Paths are relative to `folder`.
    pub(super) fn list_meshes(
        root: Node<'a>,
        folder: &Path,
        settings: &MjcfSettings,
        defaults: &Defaults<'a>,
        cx: &mut Cx<'_>,
    ) -> Meshes<'a> {
        let assets =
            child_elements(root).filter(|node| node.tag_name().name() == "asset").flat_map(child_elements);
        let mut known = BTreeMap::new();
        for node in assets.filter(|node| node.tag_name().name() == "mesh") {
            let element = defaults.element_with_defaults(node, &["mesh"], 0, cx);
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
    pub(super) fn mass_properties_of_mesh_shape(
        &mut self,
        shape: &ElementWithDefaults<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<BodyMassProperties> {
        let (mesh, element) = self.mesh_of_shape(shape, cx)?;
        if let Some(known) = self.read.get(&mesh) {
            return *known;
        }
        let found = self.mass_properties_of_mesh(&element, cx);
        self.read.insert(mesh, found);
        found
    }

    /// Returns the name of a shape's mesh, and the mesh.
    fn mesh_of_shape(
        &self,
        shape: &ElementWithDefaults<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<(String, ElementWithDefaults<'a>)> {
        let Some(mesh) = shape.attribute_text_with_span("mesh", cx) else {
            cx.report_error(
                &element_source_position(shape.node, cx),
                "a shape of type `mesh` without `mesh`",
                |d| d,
            );
            return None;
        };
        let found = self.known.get(&mesh.text).cloned();
        if found.is_none() {
            let known = self.known.keys().map(String::as_str);
            cx.report_error(&mesh.place, format!("unknown mesh {}", quote_word(&mesh.text)), |d| {
                d.suggest_name(&mesh.text, known)
            });
        }
        found.map(|element| (mesh.text, element))
    }

    /// Returns the source of the vertices of a mesh shape, for its convex hull; `None` for a mesh that MuJoCo
    /// generates.
    pub(super) fn vertex_source_of_mesh_shape(
        &self,
        shape: &ElementWithDefaults<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<MeshVertices> {
        let (mesh, element) = self.mesh_of_shape(shape, cx)?;
        let (linear, offset) = vertex_transformation(&element, cx);
        let place = element_source_position(element.node, cx);
        if element.node.has_attribute("file") {
            let name = read_name_attribute(element.node, "file", cx)?;
            return Some(MeshVertices {
                paths: vec![self.mesh_path(&name)],
                name,
                written: Vec::new(),
                linear,
                offset,
            });
        }
        let place = match element.node_with_attribute("vertex") {
            Some(_) => element.place_of_attribute_value("vertex", cx),
            None => place,
        };
        let numbers: Option<Vec<f64>> = element
            .trimmed_attribute_text("vertex")?
            .split_ascii_whitespace()
            .map(|word| word.parse().ok())
            .collect();
        let Some(numbers) = numbers.filter(|numbers| numbers.len() % 3 == 0) else {
            cx.report_error(&place, "expected three numbers for each vertex", |d| d);
            return None;
        };
        let written = numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        Some(MeshVertices { name: Name { text: mesh, place }, paths: Vec::new(), written, linear, offset })
    }

    /// Returns the path of a mesh file.
    fn mesh_path(&self, file: &Name) -> PathBuf {
        let stripped = Path::new(&file.text).file_name().filter(|_| self.strips);
        self.folder.join(stripped.unwrap_or(file.text.as_ref()))
    }

    /// Returns the mesh to draw for a shape, in the axes of the mesh file; `None` for a mesh with reference
    /// axes of its own.
    pub(super) fn mesh_to_draw(&self, shape: &ElementWithDefaults<'a>, cx: &mut Cx<'_>) -> Option<Mesh> {
        let element = self.known.get(shape.trimmed_attribute_text("mesh")?)?;
        if element.node_with_any_attribute(&["refpos", "refquat"]).is_some() {
            return None;
        }
        let scale = element.read_exactly_n_numbers("scale", cx).map_or([1.0; 3], |found| found.value);
        Some(Mesh { path: element.trimmed_attribute_text("file")?.to_string(), scale })
    }

    fn mass_properties_of_mesh(
        &mut self,
        element: &ElementWithDefaults<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<BodyMassProperties> {
        let exact = match element.trimmed_attribute_text("inertia") {
            None | Some("legacy") => false,
            Some("exact") => true,
            Some(other) => {
                let message = format!("`inertia` {} of a mesh is not supported", quote_word(other));
                let help =
                    "expected `legacy` or `exact`, or an `<inertial>` in the bodies that have the mesh";
                cx.report_error(&element.place_of_attribute_value("inertia", cx), message, |d| {
                    d.add_help(help)
                });
                return None;
            }
        };
        if element.node.attribute("file").is_none() {
            let message = "the mass of a mesh without `file` is not computed";
            cx.report_error(&element_source_position(element.node, cx), message, |d| {
                d.add_help(super::geometry::NEEDS_INERTIAL)
            });
            return None;
        }
        let file = read_name_attribute(element.node, "file", cx)?;
        let path = self.mesh_path(&file);
        let mut triangles = read_mesh(&path, &file, cx)?;
        self.files.push(path);
        transform_triangles(element, &mut triangles, cx);
        let found = triangulated_solid_mass_properties(&triangles, exact);
        if found.is_none() {
            let message = format!("mesh {} has no volume", quote_word(&file.text));
            cx.report_error(&file.place, message, |d| d.add_help(super::geometry::NEEDS_INERTIAL));
        }
        found
    }
}

/// Returns the map of vertices by `refpos`, `refquat` and `scale`, in this order: a matrix and an offset.
fn vertex_transformation(element: &ElementWithDefaults<'_>, cx: &mut Cx<'_>) -> (Matrix, Vector) {
    let from = element.read_exactly_n_numbers("refpos", cx).map_or([0.0; 3], |found| found.value);
    let factors = element.read_exactly_n_numbers("scale", cx).map_or([1.0; 3], |found| found.value);
    let quat =
        element.read_exactly_n_numbers::<4>("refquat", cx).map_or([1.0, 0.0, 0.0, 0.0], |found| found.value);
    let size = quat.iter().map(|x| x * x).sum::<f64>().sqrt();
    let axes: Matrix = transpose(&rotation_of_quaternion(quat.map(|x| x / size)));
    let linear: Matrix = std::array::from_fn(|k| vector_times_scalar(axes[k], factors[k]));
    (linear, vector_times_scalar(matrix_times_vector(&linear, from), -1.0))
}

/// Transforms the vertices of a mesh by its `refpos`, `refquat` and `scale`.
fn transform_triangles(element: &ElementWithDefaults<'_>, triangles: &mut [Triangle], cx: &mut Cx<'_>) {
    let (linear, offset) = vertex_transformation(element, cx);
    for corner in triangles.iter_mut().flatten() {
        *corner = vector_sum(matrix_times_vector(&linear, *corner), offset);
    }
    // A reflection reverses the orientation of the triangles.
    if dot(linear[0], cross(linear[1], linear[2])) < 0.0 {
        triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
}

/// Returns the mass properties at density 1 of a triangulated solid; `None` if its volume is zero.
fn triangulated_solid_mass_properties(triangles: &[Triangle], exact: bool) -> Option<BodyMassProperties> {
    let signed_or_absolute_volume = |volume: f64| if exact { volume } else { volume.abs() };
    let (mut area, mut middle) = (0.0, [0.0; 3]);
    for [a, b, c] in triangles {
        let one = vector_norm(cross(
            vector_sum(*b, vector_times_scalar(*a, -1.0)),
            vector_sum(*c, vector_times_scalar(*a, -1.0)),
        )) / 2.0;
        area += one;
        middle = vector_sum(middle, vector_times_scalar(vector_sum(vector_sum(*a, *b), *c), one / 3.0));
    }
    if area < NOTHING || !area.is_finite() {
        return None;
    }
    let middle = vector_times_scalar(middle, 1.0 / area);
    let (mut volume, mut com) = (0.0, [0.0; 3]);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| vector_sum(corner, vector_times_scalar(middle, -1.0)));
        let one = signed_or_absolute_volume(dot(a, cross(b, c)) / 6.0);
        volume += one;
        com = vector_sum(com, vector_times_scalar(vector_sum(vector_sum(a, b), c), one / 4.0));
    }
    if volume < NOTHING || !volume.is_finite() {
        return None;
    }
    let com = vector_sum(middle, vector_times_scalar(com, 1.0 / volume));
    let (mut mass, mut products) = (0.0, [[0.0; 3]; 3]);
    for triangle in triangles {
        let corners = triangle.map(|corner| vector_sum(corner, vector_times_scalar(com, -1.0)));
        let [a, b, c] = corners;
        let one = signed_or_absolute_volume(dot(a, cross(b, c)) / 6.0);
        mass += one;
        let sum = vector_sum(vector_sum(a, b), c);
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
    Some(BodyMassProperties { mass, com, inertia })
}

impl BodyMassProperties {
    /// Scales the mass properties to another total mass.
    pub(super) fn scaled_to_mass(&self, mass: f64) -> BodyMassProperties {
        BodyMassProperties {
            mass,
            com: self.com,
            inertia: self.inertia.map(|row| vector_times_scalar(row, mass / self.mass)),
        }
    }
}

/// Reads a mesh. Errors are reported at the name of the mesh.
fn read_mesh(path: &Path, name: &Name, cx: &mut Cx<'_>) -> Option<Vec<Triangle>> {
    match mesh::read_triangles(path, &name.text) {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Box with edges 2, 4 and 6 and a corner at (1, 1, 1), as six faces.
    const BOX: &str = "v 1 1 1\nv 3 1 1\nv 3 5 1\nv 1 5 1\nv 1 1 7\nv 3 1 7\nv 3 5 7\nv 1 5 7\n\
        f 4 3 2 1\nf 5/1 6/2 7/3 8/4\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf -8 -4 -1 -5\n";

    fn check_box_mass_properties(found: &BodyMassProperties, at: f64) {
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
    fn triangulated_box_has_the_inertia_of_a_box() {
        let triangles = mesh::read_obj(BOX.as_bytes()).expect("a mesh");
        assert_eq!(triangles.len(), 12);
        check_box_mass_properties(
            &triangulated_solid_mass_properties(&triangles, true).expect("a solid"),
            0.0,
        );
        check_box_mass_properties(
            &triangulated_solid_mass_properties(&triangles, false).expect("a solid"),
            0.0,
        );
    }
}
