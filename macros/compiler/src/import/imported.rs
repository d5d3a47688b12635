//! What is made of a file.

use crate::diag::Place;
use crate::syntax::figures::FileField;
use crate::syntax::{Body, Collision, Constraint, Contact, Drive, Expr, Joint, Limit, Name, Visual};
use std::path::PathBuf;

/// What a file describes.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The links, a parent before its children.
    pub bodies: Vec<Body>,
    /// The joints in coordinate order: the root's, then depth first, alphabetical under one link.
    pub joints: Vec<Joint>,
    /// Springs, dampers, rotors and motors on coordinates.
    pub drives: Vec<Drive>,
    /// Rayleigh's functions of what has no coordinate of its own.
    pub dissipations: Vec<(Name, Expr)>,
    /// Conditions on coordinates.
    pub constraints: Vec<Constraint>,
    /// Gravity, m/s², if the format says something of it.
    pub gravity: Option<Expr>,
    /// Limits of the joints.
    pub limits: Vec<Limit>,
    /// Fields that hold figures of the file.
    pub fields: Vec<FileField>,
    /// The file's root is the ground itself.
    pub is_ground: bool,
    /// What touches what, if it was asked for.
    pub contacts: Vec<Contact>,
    /// Collision geometry of the links, if it was asked for.
    pub collisions: Vec<Collision>,
    /// Visual geometry of the links, if it was asked for.
    pub visuals: Vec<Visual>,
    /// Numbers that were rounded, as the user asked for: joint, entry, what it was, what it is.
    pub snapped: Vec<String>,
    /// What is in the file and not in the mechanism.
    pub left_out: Vec<String>,
    /// Further files that were read.
    pub files: Vec<PathBuf>,
}

/// A value with its place.
#[derive(Clone, Debug)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Its place.
    pub place: Place,
}
