//! Collision and visual geometry of a file's links.

use super::Endpoint;
use crate::diag::Place;

/// A shape of the collision geometry of a file's link.
#[derive(Clone, Debug)]
pub struct Collision {
    /// Link, with the pose of the shape's centre on it.
    pub on: Endpoint,
    /// Shape of the geometry.
    pub shape: Shape,
    /// Position of the geometry in the file.
    pub place: Place,
}

/// Shape of collision or visual geometry; lengths in m.
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
    /// Mesh of triangles in another file.
    Mesh,
}

/// A shape of the visual geometry of a file's link.
#[derive(Clone, Debug)]
pub struct Visual {
    /// Link, with the pose of the shape's centre on it.
    pub on: Endpoint,
    /// Shape of the visual geometry.
    pub shape: Shape,
    /// Mesh of the geometry, if the shape is a mesh.
    pub mesh: Option<Mesh>,
}

/// Mesh of triangles in another file.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Path of the mesh, as written in the robot file.
    pub path: String,
    /// Scale factors of the mesh along its axes.
    pub scale: [f64; 3],
}
