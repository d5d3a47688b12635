//! Shapes of links that contacts name.

use super::origin::Origin;
use crate::diag::Place;
use crate::syntax::{Collision, Endpoint, Name, Shape};

/// A part of a link's collision geometry.
pub(in crate::import) struct FileCollision {
    /// Where its centre and its axes are.
    pub(in crate::import) origin: Origin,
    /// What it is.
    pub(in crate::import) shape: Shape,
    /// Where the file says it.
    pub(in crate::import) place: Place,
}

impl FileCollision {
    /// The part on a link of this name.
    pub(in crate::import) fn on(&self, link: &Name) -> Collision {
        let (at, rotated) = (self.origin.at(), self.origin.rotated());
        let on = Endpoint { body: link.clone(), at, rotated };
        Collision { on, shape: self.shape, place: self.place.clone() }
    }
}
