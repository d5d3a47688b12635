//! Collision and visual geometry of a file's links.

use super::{Endpoint, Name};
use crate::diag::Place;
use crate::language::SurfaceId;
use std::path::PathBuf;

/// A shape of the collision geometry of a file's link.
#[derive(Clone, Debug)]
pub struct CollisionShape {
    /// Link, with the pose of the shape's centre on it.
    pub on: Endpoint,
    /// Shape of the collision geometry.
    pub shape: Shape,
    /// Source of the vertices, if the shape is a mesh that can be read.
    pub mesh: Option<MeshVertices>,
    /// Vertices of the convex hull of the mesh, m, if a contact uses it.
    pub hull: Vec<[f64; 3]>,
    /// Source position of the geometry in the file.
    pub place: Place,
}

impl CollisionShape {
    /// Whether the shape is a mesh that has no convex hull.
    pub fn is_mesh_without_hull(&self) -> bool {
        self.shape == Shape::Mesh && self.hull.is_empty()
    }
}

/// Vertices of a mesh for its convex hull: those of a file, or as written.
#[derive(Clone, Debug)]
pub struct MeshVertices {
    /// Path or name of the mesh as written, for messages.
    pub name: Name,
    /// Paths at which the file may be; empty for written vertices.
    pub paths: Vec<PathBuf>,
    /// Vertices that the file lists directly.
    pub written: Vec<[f64; 3]>,
    /// Matrix by which vertices are multiplied, such as scale factors.
    pub linear: [[f64; 3]; 3],
    /// Position that is added to the transformed vertices, m.
    pub offset: [f64; 3],
}

impl MeshVertices {
    /// Returns the vertices of a file, scaled along the axes.
    pub fn scaled_vertices_of_file(name: Name, paths: Vec<PathBuf>, scale: [f64; 3]) -> MeshVertices {
        let linear = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { scale[i] } else { 0.0 }));
        MeshVertices { name, paths, written: Vec::new(), linear, offset: [0.0; 3] }
    }
}

/// Shape of collision or visual geometry with lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Sphere, given by its radius.
    Sphere(f64),
    /// Cuboid, given by its edge lengths along the axes.
    Cuboid([f64; 3]),
    /// Cylinder along z, given by radius and length.
    Cylinder(f64, f64),
    /// Radius, and distance of the centres of the spheres, along z.
    Capsule(f64, f64),
    /// Ellipsoid, given by its half lengths along the axes.
    Ellipsoid([f64; 3]),
    /// Mesh of triangles in a separate file.
    Mesh,
}

impl Shape {
    /// Returns the surface of the shape; a mesh collides as its convex hull.
    pub fn surface_id(&self) -> SurfaceId {
        match self {
            Shape::Sphere(_) => SurfaceId::Sphere,
            Shape::Cuboid(_) => SurfaceId::Cuboid,
            Shape::Cylinder(..) => SurfaceId::Drum,
            Shape::Capsule(..) => SurfaceId::Capsule,
            Shape::Ellipsoid(_) => SurfaceId::Ellipsoid,
            Shape::Mesh => SurfaceId::Hull,
        }
    }

    /// Returns the radius of the sphere around the shape, m; zero for a mesh, whose size is in its file.
    pub fn bounding_radius(&self) -> f64 {
        match *self {
            Shape::Sphere(radius) => radius,
            Shape::Cuboid([a, b, c]) => (a * a + b * b + c * c).sqrt() / 2.0,
            Shape::Cylinder(radius, length) => radius.hypot(length / 2.0),
            Shape::Capsule(radius, length) => radius + length / 2.0,
            Shape::Ellipsoid(radii) => radii.into_iter().fold(0.0, f64::max),
            Shape::Mesh => 0.0,
        }
    }
}

/// A shape of the visual geometry of a file's link.
#[derive(Clone, Debug)]
pub struct VisualShape {
    /// Link, with the pose of the shape's centre on it.
    pub on: Endpoint,
    /// Shape of the visual geometry.
    pub shape: Shape,
    /// Mesh of the geometry, if the shape is a mesh.
    pub mesh: Option<Mesh>,
}

/// Mesh of triangles in a separate file, with its scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Path of the mesh, as written in the robot file.
    pub path: String,
    /// Scale factors of the mesh along its axes.
    pub scale: [f64; 3],
}
