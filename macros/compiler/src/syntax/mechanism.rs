//! What a use of `#[mechanism]` says as a whole: its description, its options, and what remains of the struct.

use super::sound::Reading;
use super::{Base, Description, Inertias, Name};
use syn::{Attribute, Field, Ident, Visibility};

/// A parsed use of `#[mechanism]`.
pub struct Mechanism {
    /// What the struct says.
    pub description: Description,
    /// What remains of the struct itself.
    pub shell: Shell,
    /// The file to read, if one is named.
    pub urdf: Option<UrdfOptions>,
    /// What is generated on request.
    pub requests: Requests,
    /// What could be read.
    pub reading: Reading,
}

/// What is generated beside the functions of every mechanism, by words among the attribute's arguments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Requests {
    /// First derivatives of the dynamics.
    pub derivatives: bool,
    /// Second derivatives, too.
    pub second_derivatives: bool,
    /// The matrix of the momentum, and its bias.
    pub centroidal: bool,
    /// The dynamics as linear functions of the mass properties.
    pub regressor: bool,
    /// Derivatives of the dynamics by the parameters.
    pub sensitivities: bool,
    /// The mass matrix without its zeros.
    pub packed: bool,
    /// A second struct that holds what depends on the parameters alone.
    pub prepare: bool,
    /// Functions of several states at once, in lanes.
    pub batch: bool,
    /// No instructions beside those of the compilation's target.
    pub target_only: bool,
    /// Passes over the model that are left out.
    pub skipped: Skipped,
}

/// The passes that are left out: `skip_passes = [word, …]`. No function depends on them, only what it costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Link frames stay where they are described.
    pub frames: bool,
    /// Mass properties stay with their links.
    pub regroup: bool,
    /// Links that turn about parallel axes are described in their own axes.
    pub parallel: bool,
    /// Neither alike limbs nor joints of one path are lanes.
    pub limbs: bool,
}

/// The struct without its elements.
pub struct Shell {
    /// Documentation and other attributes.
    pub attributes: Vec<Attribute>,
    /// Visibility.
    pub visibility: Visibility,
    /// Name.
    pub ident: Ident,
    /// Generics, with their where clause.
    pub generics: syn::Generics,
    /// The fields that stay.
    pub parameters: Vec<Field>,
    /// Name and type of the fields that go, for the editor's sake.
    pub elements: Vec<(Ident, Ident)>,
    /// What the user says of fields in doc comments: name of the field, first paragraph.
    pub notes: Vec<(String, String)>,
    /// The attribute and the struct as they are written, if the compiler can tell.
    pub declaration: Option<String>,
    /// Where generated code finds the runtime, if not in a crate of its own name.
    pub home: Option<syn::Path>,
}

/// The name of the fixed frame.
pub const GROUND: &str = "ground";

/// The joint that holds the root of a file, which no file names; with a number if one does.
pub const ROOT_JOINT: &str = "root_joint";

/// The options of `#[mechanism(urdf = "…", …)]`.
#[derive(Clone, Debug)]
pub struct UrdfOptions {
    /// Path as written.
    pub path: Name,
    /// How the root link is held.
    pub base: Base,
    /// Damping and friction of the file are kept.
    pub honour_passive: bool,
    /// Mimic joints follow their masters.
    pub follow_mimic: bool,
    /// Limits of the file are kept.
    pub honour_limits: bool,
    /// What is made of mass properties.
    pub inertias: Inertias,
    /// Every moving joint with one degree of freedom is an input.
    pub inputs: bool,
    /// Joints frozen at zero.
    pub lock: Vec<Name>,
    /// How far off round numbers the file's frames and axes may be to be taken for round, rad and m.
    pub snap: Option<f64>,
}

/// The words of [`Requests`].
pub(super) const REQUESTS: [&str; 8] = [
    "derivatives",
    "second_derivatives",
    "centroidal",
    "regressor",
    "sensitivities",
    "packed",
    "prepare",
    "batch",
];
