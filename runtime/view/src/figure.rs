//! Drawn geometry of a mechanism: pieces that are fixed in frames.

use crate::mesh::{self, TriangleMesh};
use crate::{Error, text};
use linkwork::drawing::{Kind, Piece, Role};
use linkwork::nalgebra::{Matrix3, SymmetricEigen, Vector3};
use linkwork::{Drawn, Real};
use std::path::Path;

/// Drawing of a mechanism: its frames, and pieces fixed in them.
///
/// [`Figure::of`] takes the pieces of a mechanism with the option `drawing`; further pieces are
/// [added](Figure::add).
#[derive(Clone, Debug, Default)]
pub struct Figure {
    pub(crate) frames: Vec<String>,
    pub(crate) shapes: Vec<DrawnShape>,
    pub(crate) gravity: [f64; 3],
}

/// Piece of a drawing with its dimensions, ready to be drawn.
#[derive(Clone, Debug)]
pub(crate) struct DrawnShape {
    pub(crate) name: String,
    pub(crate) role: Role,
    pub(crate) kind: Kind,
    pub(crate) frames: [Option<usize>; 2],
    pub(crate) numbers: Vec<f64>,
    pub(crate) mesh: Option<TriangleMesh>,
    /// Index of the first number of the shape among the numbers of the declared pieces; `None` for a shape
    /// that the program adds.
    first: Option<usize>,
    /// Whether the piece is the equivalent ellipsoid of mass and moments of inertia, drawn if no shape is
    /// declared.
    fitted: bool,
    /// Whether the mechanism declares the piece; false if the program adds it.
    declared: bool,
}

/// Converts a number of any scalar type to `f64`.
pub(crate) fn to_double<T: Real>(x: T) -> f64 {
    x.to_subset().unwrap_or(f64::NAN)
}

impl Figure {
    /// Returns the drawing that a mechanism declares, for the current values of its parameters.
    pub fn of<M, const NQ: usize, const NV: usize>(mechanism: &M) -> Figure
    where
        M: Drawn<NQ, NV>,
    {
        let numbers = mechanism.drawing_numbers();
        let numbers: Vec<f64> = numbers.as_ref().iter().map(|x| to_double(*x)).collect();
        Figure::from_pieces(M::FRAMES.iter().map(ToString::to_string).collect(), M::DRAWING, &numbers)
    }

    /// Creates a drawing from pieces and their dimensions, in frames with the names `frames`. Pieces with
    /// missing dimensions or dimensions that are not finite are omitted.
    pub fn from_pieces(frames: Vec<String>, pieces: &[Piece], numbers: &[f64]) -> Figure {
        let mut figure = Figure { frames, ..Figure::default() };
        for piece in pieces {
            let end = piece.first.saturating_add(piece.kind.count());
            let Some(numbers) = numbers.get(piece.first..end) else { continue };
            let before = figure.shapes.len();
            figure.push_shape(piece.name, piece.role, piece.kind, piece.frames, numbers);
            figure.shapes[before..].iter_mut().for_each(|shape| shape.first = Some(piece.first));
        }
        figure.shapes.iter_mut().for_each(|shape| shape.declared = true);
        figure.shrink_ellipsoids_to_links();
        figure
    }

    /// Adds a piece to a frame of the drawing, or to the ground if `frame` is `None`. The dimensions are
    /// those documented at [`Kind`], m and rad.
    ///
    /// # Errors
    ///
    /// [`Error::Frame`] for an unknown frame, [`Error::Count`] for a wrong number of dimensions.
    pub fn add(
        mut self,
        name: &str,
        kind: Kind,
        frame: Option<&str>,
        numbers: &[f64],
    ) -> Result<Figure, Error> {
        if numbers.len() != kind.count() {
            let what = format!("the numbers of `{name}`");
            return Err(Error::Count { what, expected: kind.count(), found: numbers.len() });
        }
        let frame = frame.map(|frame| self.frame_index(frame)).transpose()?;
        self.push_shape(name, Role::Visual, kind, [frame; 2], numbers);
        Ok(self)
    }

    /// Adds a surface to a frame of the drawing, or to the ground if `frame` is `None`. The function `place`
    /// maps the parameters `u` and `w` between these bounds to a position, m in the axes of the frame.
    ///
    /// Contact surfaces given by functions may be unbounded. This method draws a region of such a surface, or
    /// a larger region of a terrain than [`Motion::of`](crate::Motion::of) draws by default. No floor is
    /// drawn under a surface.
    ///
    /// # Errors
    ///
    /// [`Error::Frame`] for an unknown frame, [`Error::Surface`] if bounds do not increase or a position is
    /// not finite.
    pub fn surface(
        mut self,
        name: &str,
        frame: Option<&str>,
        u: [f64; 2],
        w: [f64; 2],
        place: impl Fn(f64, f64) -> [f64; 3],
    ) -> Result<Figure, Error> {
        let frame = frame.map(|frame| self.frame_index(frame)).transpose()?;
        let mesh = TriangleMesh::triangulate_surface(u, w, place)
            .map_err(|what| Error::Surface { name: name.to_string(), what })?;
        let mut numbers = vec![0.0; Kind::Mesh("").count()];
        numbers[3..12].copy_from_slice(Matrix3::identity().as_slice());
        numbers[12..].fill(1.0);
        self.push_shape(name, Role::Surface, Kind::Mesh(""), [frame; 2], &numbers);
        if let Some(shape) = self.shapes.last_mut() {
            shape.mesh = Some(mesh);
        }
        Ok(self)
    }

    /// Reads the triangles of a robot's meshes, STL, OBJ or COLLADA, from a folder. A path in the robot's
    /// file, `package://name/path` or a plain path, is searched in the folder, first in full, then without
    /// its leading folders one after the other. If this method is not called, or if a file is not found,
    /// bodies are drawn by their mass properties, and [`missing_meshes`](Self::missing_meshes) lists the
    /// files.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the folder or a file that is found cannot be read, [`Error::Mesh`] if a file has no
    /// readable triangles.
    pub fn meshes(mut self, folder: impl AsRef<Path>) -> Result<Figure, Error> {
        let file_error = |cause| Error::File { path: folder.as_ref().to_path_buf(), cause };
        std::fs::read_dir(folder.as_ref()).map_err(file_error)?;
        for shape in &mut self.shapes {
            if let (Kind::Mesh(path), Role::Visual) = (shape.kind, shape.role)
                && let Some(found) = mesh::find_mesh_file(folder.as_ref(), path)
            {
                shape.mesh = Some(mesh::read_mesh(&found)?);
            }
        }
        Ok(self)
    }

    /// Returns the distinct paths of meshes that were not read, in the spelling of the robot's file.
    pub fn missing_meshes(&self) -> Vec<&str> {
        let mut missing = Vec::new();
        for shape in &self.shapes {
            if let (Kind::Mesh(path), Role::Visual, None) = (shape.kind, shape.role, &shape.mesh)
                && !missing.contains(&path)
            {
                missing.push(path);
            }
        }
        missing
    }

    /// Returns the shapes of the drawing that are drawn. Shapes of mass properties are omitted if all meshes
    /// of their body were read.
    pub(crate) fn drawn_shapes(&self) -> impl Iterator<Item = &DrawnShape> {
        self.shapes.iter().filter(|shape| shape.is_visible() && !self.is_represented_by_meshes(shape))
    }

    /// Returns whether a shape represents the mass properties of a body whose meshes were all read.
    fn is_represented_by_meshes(&self, shape: &DrawnShape) -> bool {
        let is_visual_mesh_of_same_body = |s: &&DrawnShape| {
            s.declared && s.role == Role::Visual && matches!(s.kind, Kind::Mesh(_)) && s.name == shape.name
        };
        let mut meshes = self.shapes.iter().filter(is_visual_mesh_of_same_body).peekable();
        shape.declared
            && matches!(shape.role, Role::Body | Role::Link)
            && meshes.peek().is_some()
            && meshes.all(|s| s.mesh.is_some())
    }

    /// Returns the names of the frames of the drawing.
    pub fn frames(&self) -> &[String] {
        &self.frames
    }

    /// Returns the index of a frame by its name, or [`Error::Frame`] if the drawing has no such frame.
    pub(crate) fn frame_index(&self, name: &str) -> Result<usize, Error> {
        let found = self.frames.iter().position(|known| known == name);
        found.ok_or_else(|| Error::Frame { name: name.to_string(), known: self.frames.clone() })
    }

    fn push_shape(
        &mut self,
        name: &str,
        role: Role,
        kind: Kind,
        frames: [Option<usize>; 2],
        numbers: &[f64],
    ) {
        let known = frames.iter().flatten().all(|frame| *frame < self.frames.len());
        if !known || numbers.iter().any(|x| !x.is_finite()) {
            return;
        }
        let fitted = kind == Kind::Inertia;
        let (kind, numbers) = match kind {
            Kind::Inertia => equivalent_ellipsoid(numbers),
            Kind::Gravity => {
                self.gravity.copy_from_slice(&numbers[3..]);
                return;
            }
            kind => (kind, numbers.to_vec()),
        };
        let (name, declared) = (name.to_string(), false);
        let (mesh, first) = (None, None);
        self.shapes.push(DrawnShape { name, role, kind, frames, numbers, mesh, first, fitted, declared });
    }

    /// Limits the equivalent ellipsoids to the length of the links, because many robot files have fictitious
    /// inertias.
    fn shrink_ellipsoids_to_links(&mut self) {
        let length =
            |s: &DrawnShape| (0..3).map(|k| (s.numbers[3 + k] - s.numbers[k]).powi(2)).sum::<f64>().sqrt();
        let bars: Vec<(Option<usize>, f64)> =
            self.shapes.iter().filter(|s| s.kind == Kind::Bar).map(|s| (s.frames[0], length(s))).collect();
        let mean = bars.iter().map(|(_, length)| length).sum::<f64>() / bars.len().max(1) as f64;
        for shape in self.shapes.iter_mut().filter(|s| s.role == Role::Body && s.kind == Kind::Ellipsoid) {
            let own = bars.iter().filter(|(frame, _)| *frame == shape.frames[0]).map(|(_, length)| *length);
            let most = own.fold(mean, f64::max) / 2.0;
            let largest = shape.numbers[12..].iter().copied().fold(0.0, f64::max);
            if shape.fitted && most > 0.0 && largest > most {
                shape.numbers[12..].iter_mut().for_each(|half| *half *= most / largest);
            }
        }
    }

    /// Returns the indices of the frames in which pieces of the drawing are fixed.
    pub(crate) fn used_frames(&self) -> Vec<usize> {
        (0..self.frames.len()).filter(|k| self.shapes.iter().any(|s| s.frames.contains(&Some(*k)))).collect()
    }

    /// Returns the common direction of all revolute axes of the drawing if they are parallel: the normal of a
    /// planar motion.
    pub(crate) fn common_hinge_direction(
        &self,
        turn: impl Fn(Option<usize>, Vector3<f64>) -> Vector3<f64>,
    ) -> Option<Vector3<f64>> {
        let hinge_axis = |s: &DrawnShape| turn(s.frames[0], Vector3::from_column_slice(&s.numbers[3..6]));
        let hinges: Vec<Vector3<f64>> =
            self.shapes.iter().filter(|s| s.kind == Kind::Hinge).map(hinge_axis).collect();
        let first = hinges.first()?;
        hinges.iter().all(|other| other.cross(first).norm() < 1e-6).then_some(*first)
    }
}

impl DrawnShape {
    /// Returns the index of the first number of the shape among the numbers of the declared pieces, and the
    /// count of these numbers. An equivalent ellipsoid takes only its position from them.
    pub(crate) fn range_in_declared_numbers(&self) -> Option<[usize; 2]> {
        let count = if self.fitted { 3 } else { self.numbers.len() };
        self.first.map(|first| [first, count])
    }

    /// Returns the reference points of the shape, each with its frame and the distance by which the shape
    /// extends beyond it.
    pub(crate) fn reference_points_of_shape(&self) -> Vec<(Option<usize>, Vector3<f64>, f64)> {
        let n = &self.numbers;
        let vector_from_entry = |k: usize| Vector3::new(n[k], n[k + 1], n[k + 2]);
        let [a, b] = self.frames;
        let spheres_at_ends = |half: f64, radius: f64| {
            vec![
                (a, vector_from_entry(0) - vector_from_entry(3) * half, radius),
                (a, vector_from_entry(0) + vector_from_entry(3) * half, radius),
            ]
        };
        let norm_of_vector = |k: usize| vector_from_entry(k).norm();
        match self.kind {
            Kind::Rod => spheres_at_ends(n[6] / 2.0, 0.0),
            Kind::Cylinder | Kind::Capsule => spheres_at_ends(n[7] / 2.0, n[6]),
            Kind::Cone => spheres_at_ends(n[7] * 0.75, n[6]),
            Kind::Tube => spheres_at_ends(n[8] / 2.0, n[7]),
            Kind::Ring | Kind::Disk => vec![(a, vector_from_entry(0), n[6])],
            Kind::Torus => vec![(a, vector_from_entry(0), n[6] + n[7])],
            Kind::Sphere => vec![(a, vector_from_entry(0), n[3])],
            Kind::Cuboid => vec![(a, vector_from_entry(0), norm_of_vector(12) / 2.0)],
            Kind::Ellipsoid => vec![(a, vector_from_entry(0), n[12].max(n[13]).max(n[14]))],
            Kind::Bar | Kind::Coil | Kind::Damper => {
                vec![(a, vector_from_entry(0), 0.0), (b, vector_from_entry(3), 0.0)]
            }
            Kind::Terrain(_) => Vec::new(),
            // A surface has no definite size, like a plane.
            Kind::Mesh(_) if self.role == Role::Surface => Vec::new(),
            Kind::Mesh(_) => match &self.mesh {
                Some(mesh) => {
                    vec![(
                        a,
                        vector_from_entry(0),
                        mesh.radius_of_mesh() * n[12].abs().max(n[13].abs()).max(n[14].abs()),
                    )]
                }
                None => Vec::new(),
            },
            Kind::Plane | Kind::Funnel | Kind::Pipe | Kind::Bowl | Kind::Gravity | Kind::Inertia => {
                Vec::new()
            }
            Kind::Point
            | Kind::Hinge
            | Kind::Slide
            | Kind::Ball
            | Kind::Spiral
            | Kind::Brake
            | Kind::Force(_)
            | Kind::Torque(_) => vec![(a, vector_from_entry(0), 0.0)],
        }
    }

    /// Serialises the shape as JSON. `renumber` converts frame indices of the drawing to those of the page.
    pub(crate) fn shape_json(&self, renumber: impl Fn(usize) -> usize) -> String {
        let frame_number_text = |k: Option<usize>| k.map_or("-1".to_string(), |k| renumber(k).to_string());
        let (kind, more) = match self.kind {
            Kind::Force(k) => ("Force".to_string(), k.to_string()),
            Kind::Torque(k) => ("Torque".to_string(), k.to_string()),
            Kind::Mesh(_) => {
                ("Mesh".to_string(), self.mesh.as_ref().map_or("null".to_string(), TriangleMesh::mesh_json))
            }
            kind => (format!("{kind:?}"), "null".to_string()),
        };
        text::list([
            text::json(&kind),
            text::json(&format!("{:?}", self.role)),
            text::json(&self.name),
            frame_number_text(self.frames[0]),
            frame_number_text(self.frames[1]),
            text::numbers(&self.numbers),
            more,
        ])
    }
}

/// Returns the homogeneous ellipsoid of a given mass and inertia: with principal moments `I₁ …`, the
/// semi-axes satisfy `a₁² = 5 (I₂ + I₃ − I₁) / (2 m)`. Impossible moments, such as those of planar
/// mechanisms, yield flat ellipsoids.
fn equivalent_ellipsoid(numbers: &[f64]) -> (Kind, Vec<f64>) {
    let [x, y, z, mass, xx, yy, zz, xy, xz, yz] = *numbers else { return (Kind::Point, vec![0.0; 3]) };
    if mass <= 0.0 {
        return (Kind::Point, vec![x, y, z]);
    }
    let SymmetricEigen { eigenvectors: mut axes, eigenvalues: i } =
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz).symmetric_eigen();
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    let squared_semi_axis = |k: usize| 5.0 * (i.sum() - 2.0 * i[k]) / (2.0 * mass);
    let squares = [0, 1, 2].map(squared_semi_axis);
    let largest = squares.into_iter().fold(0.0, f64::max);
    let halves = squares.map(|s| s.max(largest * 0.01).sqrt());
    let axes = axes.transpose();
    (Kind::Ellipsoid, [&[x, y, z], axes.as_slice(), &halves].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that the equivalent ellipsoid of a homogeneous ellipsoid is itself. With semi-axes a, b, c, its
    /// inertia is `I_xx = m (b² + c²) / 5` (any table of mechanics).
    #[test]
    fn equivalent_of_ellipsoid_is_itself() {
        let (m, [a, b, c]) = (3.0, [0.5, 0.2, 0.3_f64]);
        let ellipsoid_moment = |p: f64, q: f64| m * (p * p + q * q) / 5.0;
        let numbers = [
            1.0,
            2.0,
            3.0,
            m,
            ellipsoid_moment(b, c),
            ellipsoid_moment(a, c),
            ellipsoid_moment(a, b),
            0.0,
            0.0,
            0.0,
        ];
        let (kind, n) = equivalent_ellipsoid(&numbers);
        assert_eq!((kind, &n[..3]), (Kind::Ellipsoid, &[1.0, 2.0, 3.0][..]));
        // Each column of the axes is a coordinate axis, with the corresponding semi-axis.
        for (k, half) in [a, b, c].into_iter().enumerate() {
            let column = (0..3).find(|j| n[3 + 3 * k + j].abs() > 0.999_999).unwrap();
            assert!((n[12 + column] - half).abs() < 1e-12);
        }
    }

    #[test]
    fn pieces_without_numbers_are_omitted() {
        let frames = vec!["a".to_string()];
        let piece =
            |first| Piece { name: "p", role: Role::Body, kind: Kind::Sphere, frames: [Some(0), None], first };
        let figure =
            Figure::from_pieces(frames, &[piece(0), piece(2), piece(usize::MAX)], &[0.0, 0.0, 0.0, 1.0]);
        assert_eq!(figure.shapes.len(), 1);
    }
}
