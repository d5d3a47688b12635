//! Result of parsing `#[mechanism]`: the description, the options, and the remaining struct.

use super::contact::MAX_CONTACT_POINTS;
use super::declaration::doc_lines;
use super::file_parameters::{FileField, FileParameters};
use super::readable::MechanismReadability;
use super::request::RequestedFunctions;
use super::{BaseAttachment, Description, InertiaOption, Name};
use syn::{Attribute, Field, Ident, Visibility};

/// Parsed struct with the attribute `#[mechanism]`.
pub struct Mechanism {
    /// Description of the mechanism: its declared elements.
    pub description: Description,
    /// Struct without the fields that declare elements.
    pub shell: GeneratedStruct,
    /// Options of the robot file to import, if there is one.
    pub file: Option<FileOptions>,
    /// Optional functions that are generated on request.
    pub requests: RequestedFunctions,
    /// Record of which fields could be read in spite of errors.
    pub reading: MechanismReadability,
}

/// Generated struct: the declared one without the fields that are elements.
pub struct GeneratedStruct {
    /// Documentation and other attributes that remain on the struct.
    pub attributes: Vec<Attribute>,
    /// Visibility of the struct.
    pub visibility: Visibility,
    /// Name of the struct.
    pub ident: Ident,
    /// Generics of the struct, with their where clause.
    pub generics: syn::Generics,
    /// Fields that remain in the struct as parameters.
    pub parameters: Vec<Field>,
    /// Fields that are interpolation tables, which also remain in the struct.
    pub tables: Vec<Field>,
    /// Fields of the struct that hold values of the robot file.
    pub file_fields: Vec<FileField>,
    /// Name and type of each removed field, for editors.
    pub elements: Vec<(Ident, Ident)>,
    /// Doc comments of fields: name of the field, first paragraph.
    pub notes: Vec<(String, String)>,
    /// Source text of the attribute and the struct, if the compiler provides it.
    pub declaration: Option<String>,
    /// Path of the runtime in generated code, if it is not that of its crate.
    pub runtime: Option<syn::Path>,
}

impl GeneratedStruct {
    /// Returns the lines of the documentation comments.
    pub fn documentation_lines(&self) -> String {
        let lines: Vec<String> = doc_lines(&self.attributes).map(|line| line.trim().to_string()).collect();
        lines.join("\n").trim().to_string()
    }

    /// Returns the names of all interpolation tables.
    pub fn table_names(&self) -> Vec<String> {
        self.tables.iter().filter_map(|field| field.ident.as_ref().map(ToString::to_string)).collect()
    }

    /// Returns the member access of every parameter relative to a mechanism.
    pub fn parameter_access_paths(&self) -> Vec<String> {
        let own = self.parameters.iter().filter_map(|field| field.ident.as_ref().map(ToString::to_string));
        own.chain(self.file_fields.iter().flat_map(FileField::value_access_paths)).collect()
    }
}

/// Name of the ground, the fixed frame.
pub const GROUND: &str = "ground";

/// Name of the joint of a file's root, which is unnamed in files; a number is appended if the name is taken.
pub const ROOT_JOINT: &str = "root_joint";

/// Option for the treatment of the limits of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitOption {
    /// Limits of the robot file are bounds for controllers.
    Honour,
    /// Limits of the robot file are not read.
    Ignore,
    /// Limits of the file are bounds for controllers and also stops.
    Stops,
}

/// Option for the contacts of an MJCF file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactOption {
    /// Contacts of the file are not read.
    Ignore,
    /// Only contacts of bodies with the world are read.
    Ground,
    /// All contacts of the file are read.
    File,
}

/// Option for the treatment of loops of a URDF file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopOption {
    /// Loops are errors.
    Refuse,
    /// Joints of the file and of other tools' extensions close loops.
    Close,
    /// Loops remain open: joints that close them are left out.
    Ignore,
}

/// File format of robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// URDF, imported by the option `urdf = "…"`.
    Urdf,
    /// MJCF, imported by the option `mjcf = "…"`.
    Mjcf,
    /// SDF, imported by the option `sdf = "…"`.
    Sdf,
}

impl FileFormat {
    /// All file formats from which robots are imported.
    pub const ALL: [FileFormat; 3] = [FileFormat::Urdf, FileFormat::Mjcf, FileFormat::Sdf];

    /// Returns the option of `#[mechanism]` that imports a file of the format.
    pub fn import_option_name(self) -> &'static str {
        match self {
            FileFormat::Urdf => "urdf",
            FileFormat::Mjcf => "mjcf",
            FileFormat::Sdf => "sdf",
        }
    }

    /// Returns the term of the format for a body, such as `link`.
    pub fn word_for_body(self) -> &'static str {
        match self {
            FileFormat::Urdf | FileFormat::Sdf => "link",
            FileFormat::Mjcf => "body",
        }
    }

    /// Returns the name of the file format.
    pub fn format_name(self) -> &'static str {
        match self {
            FileFormat::Urdf => "URDF",
            FileFormat::Mjcf => "MJCF",
            FileFormat::Sdf => "SDF",
        }
    }

    /// Returns the phrase for a file of this format, with its article.
    pub fn file_format_phrase(self) -> &'static str {
        match self {
            FileFormat::Urdf => "a URDF file",
            FileFormat::Mjcf => "an MJCF file",
            FileFormat::Sdf => "an SDF file",
        }
    }

    /// Returns the file extensions of the format.
    pub fn extensions_of_file_format(self) -> &'static [&'static str] {
        match self {
            FileFormat::Urdf => &["urdf", "xml"],
            FileFormat::Mjcf => &["xml", "mjcf"],
            FileFormat::Sdf => &["sdf", "world"],
        }
    }
}

/// Option for the inputs of a mechanism from a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileInputSource {
    /// One input per moving joint with one degree of freedom.
    Joints,
    /// One input for each motor that the file declares.
    Actuators,
    /// The mechanism has no inputs.
    None,
}

/// Options of `#[mechanism(urdf = "…", …)]` and `#[mechanism(mjcf = "…", …)]`.
#[derive(Clone, Debug)]
pub struct FileOptions {
    /// Format of the robot file.
    pub format: FileFormat,
    /// Path of the robot file as written.
    pub path: Name,
    /// Option for the attachment of the root link.
    pub base: BaseAttachment,
    /// Whether damping and friction of the file are included.
    pub honour_passive: bool,
    /// Whether mimic joints follow their leaders.
    pub follow_mimic: bool,
    /// Option for the treatment of the limits of the file.
    pub limits: LimitOption,
    /// Option for the treatment of mass properties.
    pub inertias: InertiaOption,
    /// Option for the inputs of the mechanism.
    pub inputs: FileInputSource,
    /// Names of the joints that are locked at the coordinate zero.
    pub lock: Vec<Name>,
    /// Tolerance within which frames and axes of the file are rounded, rad and m.
    pub snap: Option<f64>,
    /// Values of the robot file that become parameters.
    pub parameters: Vec<FileParameters>,
    /// Option for the contacts of the file.
    pub contacts: ContactOption,
    /// Option for loops of a URDF file: a link may be the child of several joints, of which all but one close
    /// loops.
    pub loops: LoopOption,
    /// Whether contacts use the collision geometry of links.
    pub collisions: bool,
    /// Whether the visual geometry of a robot file is drawn.
    pub visuals: bool,
    /// Maximum number of contact points.
    pub contact_points: usize,
}

impl FileOptions {
    /// Returns the options that hold for a file if none are written.
    pub fn default_options_of_file(format: FileFormat, path: Name) -> FileOptions {
        FileOptions {
            format,
            path,
            base: BaseAttachment::Fixed,
            honour_passive: true,
            follow_mimic: true,
            limits: LimitOption::Honour,
            inertias: InertiaOption::Check,
            inputs: FileInputSource::None,
            lock: Vec::new(),
            snap: None,
            parameters: Vec::new(),
            contacts: ContactOption::Ignore,
            loops: LoopOption::Refuse,
            collisions: false,
            visuals: false,
            contact_points: MAX_CONTACT_POINTS,
        }
    }
}
