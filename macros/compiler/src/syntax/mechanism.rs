//! What a use of `#[mechanism]` says as a whole: its description, its options, and what remains of the
//! struct.

use super::figures::{FileField, FileFigures};
use super::request::Requests;
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
    pub file: Option<FileOptions>,
    /// What is generated on request.
    pub requests: Requests,
    /// What could be read.
    pub reading: Reading,
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
    /// The fields that are tables, which stay too.
    pub tables: Vec<Field>,
    /// The fields that hold figures of a file.
    pub file_fields: Vec<FileField>,
    /// Name and type of the fields that go, for the editor's sake.
    pub elements: Vec<(Ident, Ident)>,
    /// What the user says of fields in doc comments: name of the field, first paragraph.
    pub notes: Vec<(String, String)>,
    /// The attribute and the struct as they are written, if the compiler can tell.
    pub declaration: Option<String>,
    /// Where generated code finds the runtime, if not in a crate of its own name.
    pub runtime: Option<syn::Path>,
}

impl Shell {
    /// Whether generated code is concrete in its parameters: nothing is generic.
    pub fn is_concrete(&self) -> bool {
        self.generics.params.is_empty()
    }

    /// The name of every table.
    pub fn table_names(&self) -> Vec<String> {
        self.tables.iter().filter_map(|field| field.ident.as_ref().map(ToString::to_string)).collect()
    }

    /// How every parameter is written behind a mechanism.
    pub fn accesses(&self) -> Vec<String> {
        let own = self.parameters.iter().filter_map(|field| field.ident.as_ref().map(ToString::to_string));
        own.chain(self.file_fields.iter().flat_map(FileField::members)).collect()
    }
}

/// The name of the fixed frame.
pub const GROUND: &str = "ground";

/// The joint that holds the root of a file, which no file names; with a number if one does.
pub const ROOT_JOINT: &str = "root_joint";

/// What is made of the limits of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitOption {
    /// They are bounds that controllers read.
    Honour,
    /// They are left out.
    Ignore,
    /// They are bounds, and stops for the motion.
    Stops,
}

/// A format of files that describe robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// `urdf = "…"`
    Urdf,
    /// `mjcf = "…"`
    Mjcf,
    /// `sdf = "…"`
    Sdf,
}

impl FileFormat {
    /// All of them.
    pub const ALL: [FileFormat; 3] = [FileFormat::Urdf, FileFormat::Mjcf, FileFormat::Sdf];

    /// The word among the attribute's arguments.
    pub fn word(self) -> &'static str {
        match self {
            FileFormat::Urdf => "urdf",
            FileFormat::Mjcf => "mjcf",
            FileFormat::Sdf => "sdf",
        }
    }

    /// The format's word for a body.
    pub fn body(self) -> &'static str {
        match self {
            FileFormat::Urdf | FileFormat::Sdf => "link",
            FileFormat::Mjcf => "body",
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            FileFormat::Urdf => "URDF",
            FileFormat::Mjcf => "MJCF",
            FileFormat::Sdf => "SDF",
        }
    }

    /// A file of it.
    pub fn article(self) -> &'static str {
        match self {
            FileFormat::Urdf => "a URDF file",
            FileFormat::Mjcf => "an MJCF file",
            FileFormat::Sdf => "an SDF file",
        }
    }

    /// How names of such files end.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            FileFormat::Urdf => &["urdf", "xml"],
            FileFormat::Mjcf => &["xml", "mjcf"],
            FileFormat::Sdf => &["sdf", "world"],
        }
    }
}

/// What the inputs of a file are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputOption {
    /// Every moving joint with one degree of freedom.
    Joints,
    /// The motors that the file declares.
    Actuators,
    /// There are none.
    None,
}

/// The options of `#[mechanism(urdf = "…", …)]` and `#[mechanism(mjcf = "…", …)]`.
#[derive(Clone, Debug)]
pub struct FileOptions {
    /// The format.
    pub format: FileFormat,
    /// Path as written.
    pub path: Name,
    /// How the root link is held.
    pub base: Base,
    /// Damping and friction of the file are kept.
    pub honour_passive: bool,
    /// Mimic joints follow their masters.
    pub follow_mimic: bool,
    /// What is made of the limits of the file.
    pub limits: LimitOption,
    /// What is made of mass properties.
    pub inertias: Inertias,
    /// What the inputs are.
    pub inputs: InputOption,
    /// Joints frozen at zero.
    pub lock: Vec<Name>,
    /// How far off round numbers the file's frames and axes may be to be taken for round, rad and m.
    pub snap: Option<f64>,
    /// Figures that are parameters.
    pub parameters: Vec<FileFigures>,
    /// What touches what is taken from the file.
    pub contacts: bool,
    /// Whether a link of a URDF file may be the child of several joints, of which all but one close loops.
    pub close_loops: bool,
    /// Contacts name the collision geometry of links.
    pub collisions: bool,
    /// Visual geometry is drawn.
    pub visuals: bool,
}
