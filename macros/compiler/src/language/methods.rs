//! Methods of a body: `body.at(vector)`, `body.rotated(z(angle))`, `ball.sphere(radius)`.

use super::SurfaceId;
use super::callable::COLLISION;

/// A method of a body or an inertia.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Point of a body: `body.at(vector)`.
    At,
    /// `body.rotated(rotation, …)`: axes, or an inertia, after successive rotations about the rotated axes.
    Rotated,
    /// `link.collision()`: the collision geometry of a file's link.
    Collision,
    /// Surface of a body.
    Surface(SurfaceId),
}

impl Method {
    /// Returns the method of a name and a number of arguments.
    pub fn find_by_name_and_argument_count(name: &str, count: usize) -> Option<Method> {
        match name {
            "at" => Some(Method::At),
            "rotated" => Some(Method::Rotated),
            COLLISION => Some(Method::Collision),
            _ => SurfaceId::find_by_name_and_argument_count(name, count).map(Method::Surface),
        }
    }
}
