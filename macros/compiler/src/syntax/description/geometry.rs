//! Collision and visual geometry of a file's links.

use super::Endpoint;
use crate::diag::Place;

/// A part of the collision geometry of a file's link.
#[derive(Clone, Debug)]
pub struct Collision {
    /// The link, and where the shape's centre and axes are on it.
    pub on: Endpoint,
    /// The shape.
    pub shape: Shape,
    /// Where the file says it.
    pub place: Place,
}

/// Shapes of collision geometry; lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Radius.
    Sphere(f64),
    /// Edges along the axes.
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

/// A part of the visual geometry of a file's link.
#[derive(Clone, Debug)]
pub struct Visual {
    /// The link, and where the shape's centre and axes are on it.
    pub on: Endpoint,
    /// The shape.
    pub shape: Shape,
    /// Its triangles, if it is a mesh.
    pub mesh: Option<Mesh>,
}

/// Triangles of another file.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Its path, as the file writes it.
    pub path: String,
    /// Factors along the axes.
    pub scale: [f64; 3],
}
