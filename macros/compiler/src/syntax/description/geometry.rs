//! Collision and visual geometry of a file's links.

use super::Endpoint;
use crate::diag::Place;

/// A shape of the collision geometry of a file's link.
#[derive(Clone, Debug)]
pub struct Collision {
    /// Link, with the pose of the shape's centre on it.
    pub on: Endpoint,
    /// Shape.
    pub shape: Shape,
    /// Position in the file.
    pub place: Place,
}

/// Shape of collision or visual geometry; lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Radius.
    Sphere(f64),
    /// Edge lengths along the axes.
    Cuboid([f64; 3]),
    /// Radius and length, along z.
    Cylinder(f64, f64),
    /// Radius, and distance of the centres of the spheres, along z.
    Capsule(f64, f64),
    /// Half lengths along the axes.
    Ellipsoid([f64; 3]),
    /// Triangles of another file.
    Mesh,
}

/// A shape of the visual geometry of a file's link.
#[derive(Clone, Debug)]
pub struct Visual {
    /// Link, with the pose of the shape's centre on it.
    pub on: Endpoint,
    /// Shape.
    pub shape: Shape,
    /// Triangles, if the shape is a mesh.
    pub mesh: Option<Mesh>,
}

/// Triangles of another file.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Path as written in the file.
    pub path: String,
    /// Scale factors along the axes.
    pub scale: [f64; 3],
}
