//! Unresolved description of a mechanism, written by the user or read from a file: the output of the parser
//! and the input of name resolution.

use crate::diag::Place;

mod constraint;
mod definition;
mod expr;
mod force;
mod geometry;
mod structure;

pub use constraint::{
    Constraint, ConstraintKind, Contact, FileContact, FileContactKind, Limit, restitution_value_and_kind,
};
pub use definition::{Definition, Equilibrium, Rank, Table};
pub use expr::{BinaryOp, Callee, Expr, ExprKind, LanguageWord, Member, Name};
pub use force::{
    Action, FileForceElement, FileForceLaw, FileForceQuantity, FileForceTarget, Target, Wrench,
    WrittenArguments,
};
pub use geometry::{CollisionShape, Mesh, MeshVertices, Shape, VisualShape};
pub use structure::{Body, Endpoint, Frame, FreeCoordinate, Joint, MimicRelation, Particle, Point};

/// Scalar type of the generated functions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScalarType {
    /// The scalar type `f64`: double precision.
    F64,
    /// The scalar type `f32`: single precision.
    F32,
    /// The type parameter of the struct with this name.
    Generic(String),
}

/// Attachment of the root of an imported file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseAttachment {
    /// The root link is welded to the ground.
    Fixed,
    /// The root is connected to the ground by a free joint.
    Free,
}

/// A mechanism as written by the user. Only the grammar has been checked; names are unresolved.
#[derive(Clone, Debug)]
pub struct Description {
    /// Name of the mechanism's struct.
    pub name: Name,
    /// Uniform gravitational acceleration, a vector in ground axes, m/s².
    pub gravity: Option<Expr>,
    /// Speed at which regularised Coulomb friction reaches `tanh 1` of its maximum.
    pub friction_speed: Option<Expr>,
    /// Scalar type of the mechanism.
    pub scalar: ScalarType,
    /// Parameters of the mechanism: the fields that remain in the struct.
    pub parameters: Vec<Name>,
    /// Interpolation tables: parameters that are functions.
    pub tables: Vec<Table>,
    /// States of first order: parameters that change, each with its index among the parameters.
    pub states: Vec<(Name, usize)>,
    /// Units of parameters stated by `#[unit(…)]`, with the index of the parameter.
    pub units: Vec<(usize, Expr)>,
    /// Units of the last parameters, which replace values of a file.
    pub file_units: Vec<&'static str>,
    /// Rigid bodies of the mechanism.
    pub bodies: Vec<Body>,
    /// Particles of the mechanism.
    pub particles: Vec<Particle>,
    /// Joints of the mechanism.
    pub joints: Vec<Joint>,
    /// Declared force elements and inputs of the mechanism.
    pub actions: Vec<Action>,
    /// Force elements and inputs that the robot file defines.
    pub drives: Vec<FileForceElement>,
    /// Declared limits of coordinates.
    pub limits: Vec<Limit>,
    /// Equilibria about which linear equations are printed.
    pub equilibria: Vec<Equilibrium>,
    /// Declared coordinates, which belong to no joint.
    pub coordinates: Vec<FreeCoordinate>,
    /// Names of all inputs, in order: those of force elements without a value, and fields of the type
    /// `Input`.
    pub inputs: Vec<Name>,
    /// Declared frames of the mechanism.
    pub frames: Vec<Frame>,
    /// Declared points of the mechanism.
    pub points: Vec<Point>,
    /// Named expressions, each of which other expressions may use.
    pub definitions: Vec<Definition>,
    /// Names of the definitions that are generalized speeds.
    pub speeds: Vec<Name>,
    /// Output expressions, which become functions of the mechanism.
    pub outputs: Vec<Definition>,
    /// Declared potential energies with their names.
    pub energies: Vec<(Name, Expr)>,
    /// Declared Rayleigh dissipation functions with their names.
    pub dissipations: Vec<(Name, Expr)>,
    /// Declared constraints, other than those of loop-closing joints.
    pub constraints: Vec<Constraint>,
    /// Declared unilateral contacts.
    pub contacts: Vec<Contact>,
    /// Names of the parameters of contacts that have been separated from the mechanism.
    pub separate_contact_parameters: Vec<String>,
    /// Collision geometry of a file's links.
    pub collisions: Vec<CollisionShape>,
    /// Whether the option `drawing` is set.
    pub drawing: bool,
    /// Visual geometry of a file's links, for the drawing.
    pub visuals: Vec<VisualShape>,
    /// Solution method for constrained motion: multipliers or independent speeds.
    pub formulation: Formulation,
    /// Numbers of a file that were rounded by the option `snap`.
    pub snapped: Vec<String>,
    /// Descriptions of contents of the robot file that the mechanism omits.
    pub left_out: Vec<String>,
    /// Option for the treatment of mass properties: check, trust or none.
    pub inertias: InertiaOption,
    /// Whether the file's root is the ground, which then has a frame as other links have.
    pub ground_frame: bool,
    /// Whether elements with errors were removed; it is then unknown which bodies these would hold.
    pub partial: bool,
}

impl Description {
    /// Returns a mechanism with a name and without elements.
    pub fn empty_description(name: Name) -> Description {
        Description {
            name,
            gravity: None,
            friction_speed: None,
            scalar: ScalarType::F64,
            parameters: Vec::new(),
            tables: Vec::new(),
            states: Vec::new(),
            units: Vec::new(),
            file_units: Vec::new(),
            bodies: Vec::new(),
            particles: Vec::new(),
            joints: Vec::new(),
            actions: Vec::new(),
            drives: Vec::new(),
            limits: Vec::new(),
            equilibria: Vec::new(),
            contacts: Vec::new(),
            separate_contact_parameters: Vec::new(),
            collisions: Vec::new(),
            drawing: false,
            visuals: Vec::new(),
            coordinates: Vec::new(),
            inputs: Vec::new(),
            frames: Vec::new(),
            points: Vec::new(),
            definitions: Vec::new(),
            speeds: Vec::new(),
            outputs: Vec::new(),
            energies: Vec::new(),
            dissipations: Vec::new(),
            constraints: Vec::new(),
            formulation: Formulation::default(),
            snapped: Vec::new(),
            left_out: Vec::new(),
            inertias: InertiaOption::Check,
            ground_frame: false,
            partial: false,
        }
    }
}

/// Option for the treatment of mass properties.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InertiaOption {
    /// Mass properties are checked for physical consistency.
    #[default]
    Check,
    /// Mass properties are accepted without a check.
    Trust,
    /// Mass properties are absent: the mechanism has no dynamics.
    None,
}

/// Solution method for the accelerations of a mechanism with constraints.
#[derive(Clone, Debug, Default)]
pub enum Formulation {
    /// Constrained motion is solved with Lagrange multipliers.
    #[default]
    Multipliers,
    /// Equations are formulated in independent velocities: the listed velocities, or automatically chosen
    /// ones if the list is empty.
    Speeds(Vec<Expr>, Place),
}
