//! Tokens → what the user wrote, with the place of every word. Knows Rust's grammar and the names of the
//! language's elements; no mechanics. Imported files arrive in the same [`Description`].

use crate::diag::Place;

pub mod action;
pub mod arguments;
pub mod attribute;
pub mod constraint;
pub mod contact;
pub mod declaration;
pub mod element;
pub mod expression;
pub mod figures;
pub mod guard;
pub mod home;
pub mod joint;
pub mod joint_kind;
pub mod limit;
mod lists;
pub mod mechanism;
pub mod skipped;
pub mod sound;
mod state;
mod table;
pub mod words;

pub use attribute::parse_mechanism;
pub use expression::IF;
pub use joint_kind::JointKind;
pub use mechanism::{
    FileFormat, FileOptions, GROUND, InputOption, LimitOption, Mechanism, Printed, ROOT_JOINT, Requests,
    Shell, Skipped,
};

/// What stands after a state's name in that of the function for its rate.
pub const RATE_OF_STATE: &str = "_rate";

/// A word of the user's: an identifier of the source or a name of an imported file.
#[derive(Clone, Debug)]
pub struct Name {
    /// The word.
    pub text: String,
    /// Where it stands.
    pub place: Place,
}

/// An expression as written; names are not yet resolved.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub place: Place,
}

/// The forms of an expression.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A number, finite.
    Number(f64),
    /// `length`, `x`, `t`.
    Name(String),
    /// `hoop.x`.
    Field(Box<Expr>, Name),
    /// `body.at(vector)`.
    Method(Box<Expr>, Name, Vec<Expr>),
    /// `sin(angle)`, `rod(mass, length, y)`.
    Call(Name, Vec<Expr>),
    /// `-e`.
    Neg(Box<Expr>),
    /// `a + b` and its kin, with the operator's place.
    Binary(BinaryOp, Box<Expr>, Box<Expr>, Place),
    /// `(a, b)`.
    Tuple(Vec<Expr>),
    /// `[a, b, c]`.
    Array(Vec<Expr>),
}

/// The operators between two expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `*`
    Mul,
    /// `/`, both division and the slash of `r(y / x)`
    Div,
}

impl Expr {
    /// This expression and everything inside it, from the outside in.
    pub fn parts(&self) -> Vec<&Expr> {
        let mut parts = vec![self];
        let mut at = 0;
        while let Some(part) = parts.get(at) {
            at += 1;
            match &part.kind {
                ExprKind::Number(_) | ExprKind::Name(_) => {}
                ExprKind::Field(base, _) | ExprKind::Neg(base) => parts.push(base),
                ExprKind::Method(base, _, items) => parts.extend([&**base].into_iter().chain(items)),
                ExprKind::Call(_, items) | ExprKind::Tuple(items) | ExprKind::Array(items) => {
                    parts.extend(items);
                }
                ExprKind::Binary(_, a, b, _) => parts.extend([&**a, b]),
            }
        }
        parts
    }

    /// The name that it is, if it is one.
    pub fn name(&self) -> Option<&str> {
        match &self.kind {
            ExprKind::Name(name) => Some(name),
            _ => None,
        }
    }

    /// The number that it is as written, with its sign.
    pub fn literal(&self) -> Option<f64> {
        match &self.kind {
            ExprKind::Number(n) => Some(*n),
            ExprKind::Neg(inner) => inner.literal().map(|n| -n),
            _ => None,
        }
    }

    /// A number at a place.
    pub fn number(value: f64, place: &Place) -> Expr {
        Expr { kind: ExprKind::Number(value), place: place.clone() }
    }

    /// A function call at a place.
    pub fn call(function: &str, arguments: Vec<Expr>, place: &Place) -> Expr {
        let name = Name { text: function.to_string(), place: place.clone() };
        Expr { kind: ExprKind::Call(name, arguments), place: place.clone() }
    }

    /// Three numbers as a vector `[a, b, c]` at a place.
    pub fn vector(values: [f64; 3], place: &Place) -> Expr {
        let items = values.iter().map(|v| Expr::number(*v, place)).collect();
        Expr { kind: ExprKind::Array(items), place: place.clone() }
    }
}

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
    /// Names of all inputs, in order: those of force elements without a value, and fields that are inputs themselves.
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

/// What a constraint restricts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintKind {
    /// Configurations.
    Holonomic,
    /// Velocities.
    Nonholonomic,
    /// Two surfaces that touch and do not slip.
    Rolling,
    /// Two surfaces that touch and slip with friction.
    Slipping,
}

impl ConstraintKind {
    /// What a pair of surfaces does.
    pub fn verb(self) -> &'static str {
        if self == ConstraintKind::Slipping { "slips" } else { "rolls" }
    }
}

/// Coulomb's friction of surfaces that slip.
#[derive(Clone, Debug)]
pub struct SlipFriction {
    /// Coefficient of friction.
    pub coefficient: Expr,
    /// Speed around which it is smooth; the mechanism's if absent.
    pub speed: Option<Expr>,
}

/// An expression that stays zero, or two that stay equal; or a pair of surfaces.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Its name.
    pub name: Name,
    /// What it restricts.
    pub kind: ConstraintKind,
    /// The expression, a scalar or a vector, or `rolls(surface, surface)` or `slips(surface, surface)`.
    pub value: Expr,
    /// What it stays equal to; zero if absent.
    pub other: Option<Expr>,
    /// Friction of surfaces that slip.
    pub friction: Option<SlipFriction>,
}

/// A function that is a parameter, given by a table.
#[derive(Clone, Debug)]
pub struct Table {
    /// Its name.
    pub name: Name,
    /// How many variables it has, one to three.
    pub variables: usize,
}

/// A generalized coordinate that belongs to no joint.
#[derive(Clone, Debug)]
pub struct FreeCoordinate {
    /// Its name.
    pub name: Name,
    /// How many joints are declared before it.
    pub joints_before: usize,
}

/// A configuration at rest: what is not named is zero, and orientations are those of the axes beside them.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Its name.
    pub name: Name,
    /// Coordinates, inputs and states, each with its value.
    pub values: Vec<(Expr, Expr)>,
}

/// Bounds of a coordinate.
#[derive(Clone, Debug)]
pub struct Limit {
    /// Its name; that of the joint if it comes from a file.
    pub name: Name,
    /// The joint, or the coordinate of a joint, or a coordinate of its own.
    pub on: Expr,
    /// Least value.
    pub from: Option<Expr>,
    /// Largest value.
    pub to: Option<Expr>,
    /// Largest rate, in both directions.
    pub max_speed: Option<Expr>,
    /// Largest force or torque, in both directions.
    pub max_effort: Option<Expr>,
    /// How much of its speed a coordinate keeps that strikes a bound, which is a stop then.
    pub restitution: Option<Expr>,
}

/// Two surfaces that may part, strike, slide and stick.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Its name.
    pub name: Name,
    /// One surface.
    pub first: Expr,
    /// The other.
    pub second: Expr,
    /// Coefficient of friction; none if absent.
    pub friction: Option<Expr>,
    /// Largest moment of friction about the normal, by the normal force; none if absent.
    pub torsional: Option<Expr>,
    /// Largest moment of friction about the tangents, by the normal force; none if absent.
    pub rolling: Option<Expr>,
    /// Coefficient of restitution; zero if absent.
    pub restitution: Option<Expr>,
    /// The surfaces yield instead of being rigid.
    pub soft: Option<Softness>,
    /// A file says it: what never parts is left out.
    pub of_file: bool,
}

/// How surfaces yield.
#[derive(Clone, Debug)]
pub struct Softness {
    /// Force by overlap, or by its power of 3/2.
    pub stiffness: Expr,
    /// The power is that of bodies with round surfaces (Hertz).
    pub hertz: bool,
    /// Dissipation by speed of approach (Hunt and Crossley); none if absent.
    pub dissipation: Option<Expr>,
    /// Speed of slip below which friction falls off.
    pub speed: Option<Expr>,
}

/// A frame: axes without a place.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Its name.
    pub name: Name,
    /// The body or frame whose axes it starts with.
    pub start: Expr,
    /// Rotations about carried axes.
    pub rotations: Vec<Expr>,
}

/// A point.
#[derive(Clone, Debug)]
pub struct Point {
    /// Its name.
    pub name: Name,
    /// What it is fixed in or measured from: a body or another point; the ground if absent.
    pub on: Option<Expr>,
    /// Its place there.
    pub at: Option<Expr>,
}

/// What an expression stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rank {
    /// A number.
    Scalar,
    /// A physical vector.
    Vector,
    /// A physical matrix, which takes vectors to vectors.
    Matrix,
}

impl Rank {
    /// That of an element's type.
    fn of(kind: &str) -> Rank {
        match kind {
            "Vector" => Rank::Vector,
            "Matrix" => Rank::Matrix,
            _ => Rank::Scalar,
        }
    }

    /// The element's type.
    pub fn kind(self) -> &'static str {
        match self {
            Rank::Scalar => "Scalar",
            Rank::Vector => "Vector",
            Rank::Matrix => "Matrix",
        }
    }
}

/// A name for an expression.
#[derive(Clone, Debug)]
pub struct Definition {
    /// The name.
    pub name: Name,
    /// What it stands for.
    pub rank: Rank,
    /// The expression.
    pub value: Expr,
    /// The axes of an output's components.
    pub resolved_in: Option<Expr>,
}

/// A rigid body.
#[derive(Clone, Debug)]
pub struct Body {
    /// Its name, which also names its frame.
    pub name: Name,
    /// Mass; zero if absent.
    pub mass: Option<Expr>,
    /// Centre of mass, in body axes from the body's origin; the origin if absent.
    pub com: Option<Expr>,
    /// Inertia in body axes; zero if absent.
    pub inertia: Option<Expr>,
    /// The point that the inertia is about, in body axes from the body's origin; the centre of mass if absent.
    pub about: Option<Expr>,
    /// Where its origin is, for a body placed by expressions.
    pub at: Option<Expr>,
    /// The frame whose axes it has, for a body placed by expressions.
    pub frame: Option<Expr>,
}

/// A particle: mass at a point.
#[derive(Clone, Debug)]
pub struct Particle {
    /// Its name, which also names its frame (axes of the body that carries it).
    pub name: Name,
    /// Mass.
    pub mass: Expr,
    /// `body.at(vector)`; absent for a particle that is itself the end of a joint.
    pub at: Option<Expr>,
}

/// A joint from a parent to a child.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Its name; it names the coordinate of a joint with one degree of freedom.
    pub name: Name,
    /// Which joint.
    pub kind: JointKind,
    /// Parent body, with the joint's place on it.
    pub parent: Endpoint,
    /// Child body, with the joint's place on it.
    pub child: Endpoint,
    /// Rotation axes, in the joint's frame on the parent (a later one in the carried frame).
    pub about: Vec<Expr>,
    /// Translation axes, in the joint's frame on the parent.
    pub along: Vec<Expr>,
    /// Screw: advance per radian.
    pub pitch: Option<Expr>,
    /// Screw: advance per turn.
    pub lead: Option<Expr>,
    /// The axis need not be of unit length (URDF): it is normalised, and only zero is a mistake.
    pub normalise_axis: bool,
    /// A joint that closes a loop: which of the two solutions of a loop that is solved in closed form.
    pub branch: Option<Expr>,
    /// The coordinate follows another joint's.
    pub mimic: Option<Mimic>,
    /// Viscous damping on the coordinate (URDF).
    pub damping: Option<Expr>,
    /// Coulomb friction on the coordinate (URDF).
    pub friction: Option<Expr>,
    /// The joint's coordinate is an input of its own (URDF: the joint's motor).
    pub driven: bool,
}

/// One end of a joint: `body.at(position).rotated(rotation, …)`.
#[derive(Clone, Debug)]
pub struct Endpoint {
    /// The body (or `ground`).
    pub body: Name,
    /// The joint's place on it, in body axes; its origin if absent.
    pub at: Option<Expr>,
    /// Rotations about carried axes, from the body's axes to the joint's: `z(a)`, `eigenaxis(n, a)`, or a
    /// 3×3 matrix whose columns are the joint's axes.
    pub rotated: Vec<Expr>,
}

/// A part of the collision geometry of a file's link.
#[derive(Clone, Debug)]
pub struct Collision {
    /// The link, and where the shape's centre and axes are on it.
    pub on: Endpoint,
    /// The shape.
    pub shape: Shape,
    /// Where the file says it.
    pub place: Place,
}

/// Shapes of collision geometry; lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Radius.
    Sphere(f64),
    /// Edges along the axes.
    Cuboid([f64; 3]),
    /// Radius and length, along z.
    Cylinder(f64, f64),
    /// Radius, and distance of the centres of the spheres, along z.
    Capsule(f64, f64),
    /// Half lengths along the axes.
    Ellipsoid([f64; 3]),
    /// Triangles of another file.
    Mesh,
}

/// A part of the visual geometry of a file's link.
#[derive(Clone, Debug)]
pub struct Visual {
    /// The link, and where the shape's centre and axes are on it.
    pub on: Endpoint,
    /// The shape.
    pub shape: Shape,
    /// Its triangles, if it is a mesh.
    pub mesh: Option<Mesh>,
}

/// Triangles of another file.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Its path, as the file writes it.
    pub path: String,
    /// Factors along the axes.
    pub scale: [f64; 3],
}

/// `coordinate = multiplier × other + offset`.
#[derive(Clone, Debug)]
pub struct Mimic {
    /// The joint that is followed.
    pub joint: Name,
    /// Factor.
    pub multiplier: f64,
    /// Offset.
    pub offset: f64,
}

/// A force element or an input.
#[derive(Clone, Debug)]
pub struct Action {
    /// Its name; an input's name is its entry in `INPUTS`.
    pub name: Name,
    /// What it is, with its parameters.
    pub kind: ActionKind,
    /// What it acts on.
    pub on: Target,
}

/// What a file says of springs, dampers, rotors and motors: a force element on a weighted sum of coordinates.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Its name; an input's name is its entry in `INPUTS`.
    pub name: Name,
    /// The joints with their weights; each has one coordinate.
    pub terms: Vec<(Name, f64)>,
    /// What it does.
    pub law: DriveLaw,
}

/// How a force element of a file answers to the sum of coordinates that it is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveLaw {
    /// With a force in proportion to what the sum differs from a free length.
    Spring {
        /// Stiffness.
        stiffness: f64,
        /// Where the force is zero.
        free: f64,
    },
    /// With a force against its rate, in proportion to that.
    Damper(f64),
    /// With a force against its rate, of this size.
    Friction(f64),
    /// With a force against its acceleration, in proportion to that.
    Inerter(f64),
    /// With this force always.
    Push(f64),
    /// With the force that an input says; the input's unit.
    Input(&'static str),
}

/// What a force element acts on.
#[derive(Clone, Debug)]
pub enum Target {
    /// `joint`, `joint.coordinate`, `body`, `body.at(vector)`, `point`.
    On(Expr),
    /// Two points: of bodies, or named ones.
    Between(Expr, Expr),
}

impl Target {
    /// Where it stands.
    pub fn place(&self) -> &Place {
        match self {
            Target::On(e) | Target::Between(_, e) => &e.place,
        }
    }
}

/// How a spring or a dashpot answers.
#[derive(Clone, Debug)]
pub enum Law {
    /// In proportion, with this coefficient.
    Linear(Expr),
    /// With this force, an expression of `stretch` (spring) or `speed` (dashpot).
    Force(Expr),
    /// With the force that follows from this energy, an expression of `stretch`.
    Energy(Expr),
}

/// The force elements of the language.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there are few of them, and they are not moved")]
pub enum ActionKind {
    /// A spring: on a coordinate, or between two points.
    Spring {
        /// Stiffness, force or energy.
        law: Law,
        /// Coordinate or length at which the force is zero; true if it is given as an angle.
        free: Option<(Expr, bool)>,
    },
    /// A dashpot: on a coordinate, or between two points.
    Dashpot {
        /// Damping coefficient or force.
        law: Law,
    },
    /// An inerter: a force in proportion to the relative acceleration.
    Inerter {
        /// Inertance.
        inertance: Expr,
    },
    /// Dry and viscous friction on a coordinate.
    Friction {
        /// Force of sliding friction.
        coulomb: Expr,
        /// Force at breakaway.
        stiction: Option<Expr>,
        /// Speed at which the force has fallen from breakaway to sliding.
        stribeck_speed: Option<Expr>,
        /// Viscous coefficient.
        viscous: Option<Expr>,
        /// Speed of the regularisation.
        speed: Option<Expr>,
    },
    /// Central gravity between two bodies, or towards a fixed point.
    Gravity {
        /// Gravitational constant, for two bodies with mass.
        constant: Option<Expr>,
        /// Gravitational parameter of the attracting one.
        mu: Option<Expr>,
    },
    /// Inverse-square attraction of the given strength (repulsion if negative).
    Attraction {
        /// Force times distance squared.
        strength: Expr,
    },
    /// A force: on a sliding coordinate, or on a body; without a value an input.
    Force {
        /// Direction of an input on a body.
        along: Option<Expr>,
        /// Its value.
        value: Option<Expr>,
    },
    /// A torque: on a turning coordinate, or on a body; without a value an input.
    Torque {
        /// Direction of an input on a body.
        about: Option<Expr>,
        /// Its value.
        value: Option<Expr>,
    },
}
