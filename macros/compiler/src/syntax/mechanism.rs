//! What a use of `#[mechanism]` says as a whole: its description, its options, and what remains of the struct.

use super::figures::{FileField, FileFigures};
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

/// What is generated beside the functions of every mechanism, by words among the attribute's arguments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Requests {
    /// First derivatives of the dynamics.
    pub derivatives: bool,
    /// Second derivatives, too.
    pub second_derivatives: bool,
    /// Derivatives of momenta and of their rates, too.
    pub momentum_derivatives: bool,
    /// The matrix of the momentum, and its bias.
    pub centroidal: bool,
    /// Energy and canonical equations as functions of configuration and momentum.
    pub hamilton: bool,
    /// Motion without cyclic coordinates, by their momenta.
    pub routh: bool,
    /// Quantities that keep their values.
    pub conserved: bool,
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
    /// What it looks like.
    pub drawing: bool,
    /// Figures of a file are parameters.
    pub file_parameters: bool,
    /// Mass properties of links are among them.
    pub file_inertials: bool,
    /// No instructions beside those of the compilation's target.
    pub target_only: bool,
    /// Passes over the model that are left out.
    pub skipped: Skipped,
    /// Which equations are printed.
    pub equations: Printed,
}

/// Which equations are printed: `equations = word`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Printed {
    /// Lagrange's, if they are short enough to be read.
    #[default]
    Readable,
    /// Lagrange's, also where they are long.
    Lagrange,
    /// Hamilton's.
    Hamilton,
    /// Kane's, in independent speeds.
    Kane,
    /// Routh's.
    Routh,
    /// Their structure alone.
    Structure,
}

impl Printed {
    /// The words that ask for others than the readable ones.
    pub const WORDS: [(&str, Printed); 5] = [
        ("lagrange", Printed::Lagrange),
        ("hamilton", Printed::Hamilton),
        ("kane", Printed::Kane),
        ("routh", Printed::Routh),
        ("structure", Printed::Structure),
    ];
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
    /// Contacts name the collision geometry of links.
    pub collisions: bool,
    /// Visual geometry is drawn.
    pub visuals: bool,
}

/// The words of [`Requests`].
pub(super) const REQUESTS: [&str; 13] = [
    "derivatives",
    "second_derivatives",
    "momentum_derivatives",
    "centroidal",
    "hamilton",
    "routh",
    "conserved",
    "regressor",
    "sensitivities",
    "packed",
    "prepare",
    "batch",
    "drawing",
];
