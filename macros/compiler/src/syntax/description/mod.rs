//! A mechanism as the user wrote it, or as a file says it: the data that reading makes and resolution takes.

use crate::diag::Place;

mod constraint;
mod definition;
mod expr;
mod force;
mod geometry;
mod structure;

pub use constraint::{Constraint, ConstraintKind, Contact, Limit, Restitution, SlipFriction, Softness};
pub use definition::{Definition, Equilibrium, Rank, Table};
pub use expr::{BinaryOp, Callee, Expr, ExprKind, Member, Name, Term};
pub use force::{Action, Drive, DriveLaw, DriveOn, Target, Wrench};
pub use geometry::{Collision, Mesh, Shape, Visual};
pub use structure::{Body, Endpoint, Frame, FreeCoordinate, Joint, Mimic, Particle, Point};

/// The scalar type of the generated functions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScalarType {
    /// `f64`
    F64,
    /// `f32`
    F32,
    /// The struct's own type parameter.
    Generic(String),
}

/// How the root of an imported file is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// Welded to the ground.
    Fixed,
    /// On a free joint.
    Free,
}

/// A mechanism as the user wrote it: nothing is resolved and nothing is checked but the grammar.
#[derive(Clone, Debug)]
pub struct Description {
    /// The struct's name.
    pub name: Name,
    /// Uniform gravity, a vector in ground axes.
    pub gravity: Option<Expr>,
    /// Speed at which regularised Coulomb friction reaches `tanh 1` of its full value.
    pub friction_speed: Option<Expr>,
    /// The scalar type.
    pub scalar: ScalarType,
    /// Parameters: the fields that stay in the struct.
    pub parameters: Vec<Name>,
    /// Tables: functions that are parameters.
    pub tables: Vec<Table>,
    /// States of first order: parameters that change, each with its index among them.
    pub states: Vec<(Name, usize)>,
    /// `#[unit(…)]` of parameters, by index.
    pub units: Vec<(usize, Expr)>,
    /// Units of the last parameters: those that are figures of a file.
    pub file_units: Vec<&'static str>,
    /// Rigid bodies.
    pub bodies: Vec<Body>,
    /// Particles.
    pub particles: Vec<Particle>,
    /// Joints.
    pub joints: Vec<Joint>,
    /// Force elements and inputs.
    pub actions: Vec<Action>,
    /// Force elements and inputs of a file on its joints.
    pub drives: Vec<Drive>,
    /// Limits of coordinates.
    pub limits: Vec<Limit>,
    /// Configurations at rest about which linear equations are printed.
    pub equilibria: Vec<Equilibrium>,
    /// Coordinates of their own.
    pub coordinates: Vec<FreeCoordinate>,
    /// Names of all inputs, in order: those of force elements without a value, and fields that are inputs
    /// themselves.
    pub inputs: Vec<Name>,
    /// Frames.
    pub frames: Vec<Frame>,
    /// Points.
    pub points: Vec<Point>,
    /// Names for expressions.
    pub definitions: Vec<Definition>,
    /// Definitions that are generalized speeds.
    pub speeds: Vec<Name>,
    /// Expressions that become functions.
    pub outputs: Vec<Definition>,
    /// Potential energies.
    pub energies: Vec<(Name, Expr)>,
    /// Rayleigh dissipation functions.
    pub dissipations: Vec<(Name, Expr)>,
    /// Constraints beside those of joints that close loops.
    pub constraints: Vec<Constraint>,
    /// Surfaces that may touch.
    pub contacts: Vec<Contact>,
    /// Collision geometry of a file's links.
    pub collisions: Vec<Collision>,
    /// What it looks like is asked for.
    pub drawing: bool,
    /// Visual geometry of a file's links, for the drawing.
    pub visuals: Vec<Visual>,
    /// How constrained motion is solved.
    pub formulation: Formulation,
    /// Numbers of a file that were rounded, as the user asked for.
    pub snapped: Vec<String>,
    /// What is in the file and not in the mechanism.
    pub left_out: Vec<String>,
    /// What is made of mass properties.
    pub inertias: Inertias,
    /// The file's root is the ground: it is a frame as other links are.
    pub ground_frame: bool,
    /// Parts with mistakes are left out: nobody knows what they would hold.
    pub partial: bool,
}

impl Description {
    /// A mechanism of which nothing but the name is known.
    pub fn empty(name: Name) -> Description {
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
            inertias: Inertias::Check,
            ground_frame: false,
            partial: false,
        }
    }
}

/// What is made of mass properties.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inertias {
    /// They are those of real bodies.
    #[default]
    Check,
    /// They are taken as they are.
    Trust,
    /// There are none: the mechanism has no dynamics.
    None,
}

/// How the accelerations of a mechanism with constraints are found.
#[derive(Clone, Debug, Default)]
pub enum Formulation {
    /// By Lagrange multipliers.
    #[default]
    Multipliers,
    /// By independent speeds, of those velocities or of any.
    Speeds(Vec<Expr>, Place),
}
