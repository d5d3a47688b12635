//! What is made of a file.

use crate::diag::Place;
use crate::syntax::figures::FileField;
use crate::syntax::{Body, Collision, Joint, Limit};

/// What a file describes.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The links, a parent before its children.
    pub bodies: Vec<Body>,
    /// The joints in coordinate order: the root's, then depth first, alphabetical under one link.
    pub joints: Vec<Joint>,
    /// Limits of the joints.
    pub limits: Vec<Limit>,
    /// Fields that hold figures of the file.
    pub fields: Vec<FileField>,
    /// The file's root is the ground itself.
    pub is_ground: bool,
    /// Collision geometry of the links, if it was asked for.
    pub collisions: Vec<Collision>,
    /// Numbers that were rounded, as the user asked for: joint, entry, what it was, what it is.
    pub snapped: Vec<String>,
}

/// A value with its place.
#[derive(Clone, Debug)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Its place.
    pub place: Place,
}
