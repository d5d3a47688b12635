//! Methods of a body: `body.at(vector)`, `body.rotated(z(angle))`, `ball.sphere(radius)`.

use super::SurfaceId;
use super::callable::COLLISION;

/// A method of a body or an inertia.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyOrInertiaMethod {
    /// Point of a body: `body.at(vector)`.
    At,
    /// `body.rotated(rotation, …)`: axes, or an inertia, after successive rotations about the rotated axes.
    Rotated,
    /// `link.collision()`: the collision geometry of a file's link.
    Collision,
    /// Surface of a body.
    Surface(SurfaceId),
}

impl BodyOrInertiaMethod {
    /// Returns the method of a name and a number of arguments.
    pub fn find_by_name_and_argument_count(name: &str, count: usize) -> Option<BodyOrInertiaMethod> {
        match name {
            "at" => Some(BodyOrInertiaMethod::At),
            "rotated" => Some(BodyOrInertiaMethod::Rotated),
            COLLISION => Some(BodyOrInertiaMethod::Collision),
            _ => SurfaceId::find_closest_by_argument_count(name, count).map(BodyOrInertiaMethod::Surface),
        }
    }
}
