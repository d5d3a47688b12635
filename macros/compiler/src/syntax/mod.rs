//! Parser from tokens to the unresolved description, with the source position of every word. Depends on
//! Rust's grammar and the names of the language's elements, not on mechanics. Imported files produce the same
//! [`Description`].

pub mod action;
pub mod arguments;
pub mod attribute;
pub mod constraint;
pub mod contact;
pub mod crate_path;
pub mod declaration;
pub mod description;
mod duplicate;
pub mod element;
pub mod expression;
mod field;
pub mod file_parameters;
pub mod guard;
pub mod joint;
mod keys;
mod lists;
pub mod mechanism;
mod options;
mod parameter;
pub mod readable;
mod request;
mod separate;
pub mod skipped;
mod state;
mod table;
pub mod words;

pub use crate::language::{
    BodyOrInertiaMethod, ElementKind, ForceKind, JointKind, Key, OtherKind, SurfaceFeatureCounts, SurfaceId,
};
pub use attribute::parse_mechanism;
pub use description::{
    Action, BaseAttachment, BinaryOp, Body, Callee, CollisionShape, Constraint, ConstraintKind, Contact,
    Definition, Description, Endpoint, Equilibrium, Expr, ExprKind, FileContact, FileContactKind,
    FileForceElement, FileForceLaw, FileForceQuantity, FileForceTarget, Formulation, Frame, FreeCoordinate,
    InertiaOption, Joint, LanguageWord, Limit, Member, Mesh, MeshVertices, MimicRelation, Name, Particle,
    Point, Rank, ScalarType, Shape, Table, Target, VisualShape, Wrench, WrittenArguments,
    restitution_value_and_kind,
};
pub use duplicate::struct_without_fields_if_duplicate;
pub use mechanism::{
    ContactOption, FileFormat, FileInputSource, FileOptions, GROUND, GeneratedStruct, LimitOption,
    LoopOption, Mechanism, ROOT_JOINT,
};
pub use request::{EquationsOption, RequestOption, RequestedFunctions, SkippedPasses};
pub use separate::insert_missing_commas;

/// Suffix that, appended to the name of a state, gives the name of the function that returns the state's time
/// derivative.
pub const RATE_OF_STATE: &str = "_rate";
