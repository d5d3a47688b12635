//! What names mean where an expression stands: what is declared, what is placed so far and how it moves, what
//! an expression may depend on.

use super::resolved::Resolved;
use crate::expr::{Expr, Graph, Rotation, Sym3, Vec3};
use crate::kinematics::{Joint, Spatial, change_axes};
use crate::mechanism::{Chart, Coordinate, LinkId, Pose, Requirement};
use crate::syntax::{self, Name, Rank};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// What names mean where an expression stands.
pub struct Scope<'a, 'g> {
    /// Owner of the expressions.
    pub graph: &'g Graph,
    /// Parameters of the struct.
    pub parameters: &'a [Name],
    /// Whether each parameter was used.
    pub used: std::cell::RefCell<Vec<bool>>,
    /// Functions that are parameters.
    pub tables: &'a [syntax::Table],
    /// Whether each of them was used.
    pub used_tables: RefCell<Vec<bool>>,
    /// Names of bodies and particles.
    pub bodies: Vec<String>,
    /// Names of frames.
    pub frames: Vec<String>,
    /// Names of joints.
    pub joints: Vec<String>,
    /// Names of force elements.
    pub actions: Vec<String>,
    /// Names of inputs, in order, after those of driven joints and of drives.
    pub inputs: &'a [Name],
    /// How many joints and drives have inputs of their own.
    pub driven: usize,
    /// States of first order, each with its number among the parameters.
    pub states: &'a [(Name, usize)],
    /// Names for expressions.
    pub definitions: &'a [syntax::Definition],
    /// Those of them that are generalized speeds.
    pub speeds: &'a [Name],
    /// What expressions may depend on, and what `x`, `y` and `z` alone mean.
    pub context: RefCell<Context<'g>>,
    /// What is placed so far, and how it moves.
    pub kinematics: RefCell<Kinematics<'g>>,
    /// Names without a value that were told: each once, most likely a declaration is missing.
    pub unknown: RefCell<BTreeSet<String>>,
    /// Numbers are `f32`.
    pub single: bool,
    /// Definitions whose mistakes were told.
    pub failed: RefCell<BTreeSet<String>>,
    /// A constraint on configurations is being read.
    pub constrains: std::cell::Cell<bool>,
    /// Definitions that were looked up for the one whose value is asked for: each once, however often the
    /// others name it.
    pub known: RefCell<Known<'g>>,
    /// What figures that follow from parameters must fulfil, as far as it was met.
    pub requirements: RefCell<Vec<Requirement<'g>>>,
}

/// Values of definitions, by name, by what they may depend on, and by whether `x`, `y` and `z` alone are the
/// ground's; `None` for those with mistakes.
pub type Known<'g> = BTreeMap<(String, Allowed, bool), Option<Value<'g>>>;

/// The axes that a vector is given in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Those of the frame that the attribute belongs to.
    Own,
    /// Those of a named body (or `ground`), where the links are not yet known.
    Of(String),
    /// Those of a link, or of the ground.
    Link(Option<LinkId>),
}

/// A value: a scalar, a vector as a sum over axes, or a matrix.
#[derive(Clone, Debug)]
pub enum Value<'g> {
    /// A number.
    Scalar(Expr<'g>),
    /// A physical vector.
    Vector(Vec<(Axes, Vec3<'g>)>),
    /// A physical matrix.
    Matrix(Resolved<'g>),
}

impl Value<'_> {
    /// What it is declared as.
    pub fn rank(&self) -> Rank {
        match self {
            Value::Scalar(_) => Rank::Scalar,
            Value::Vector(_) => Rank::Vector,
            Value::Matrix(_) => Rank::Matrix,
        }
    }

    /// It in a word, with its article.
    pub fn word(&self) -> &'static str {
        match self {
            Value::Scalar(_) => "a scalar",
            Value::Vector(_) => "a vector",
            Value::Matrix(_) => "a matrix",
        }
    }
}

/// What an expression may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Allowed {
    /// Parameters alone.
    Constant,
    /// Coordinates and time too.
    Placement,
    /// Rates, velocities and inputs too.
    Motion,
    /// Accelerations too.
    Acceleration,
    /// Reactions of joints too.
    Reaction,
}

/// Where an expression stands.
#[derive(Clone, Debug)]
pub struct Context<'g> {
    /// What it may depend on.
    pub allowed: Allowed,
    /// The link and placement whose axes `x`, `y` and `z` are; none where they are the attribute's own.
    pub axes: Option<(Option<LinkId>, Pose<'g>)>,
    /// Names of the place, such as `stretch`.
    pub locals: Vec<(&'static str, Expr<'g>)>,
    /// What decides between pieces of a law that are being read, as written, and the symbols that stand for
    /// it in them.
    pub deciding: Vec<(syntax::Expr, Expr<'g>)>,
    /// Definitions that are being looked up.
    pub defining: Vec<String>,
}

impl<'g> Context<'g> {
    /// A context without names of its own.
    pub fn new(allowed: Allowed, axes: Option<(Option<LinkId>, Pose<'g>)>) -> Context<'g> {
        Context { allowed, axes, locals: Vec::new(), deciding: Vec::new(), defining: Vec::new() }
    }

    /// The context with these names of its own.
    pub fn with_locals(mut self, locals: Vec<(&'static str, Expr<'g>)>) -> Context<'g> {
        self.locals = locals;
        self
    }
}

/// What can be placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlacedKind {
    /// A body: axes and origin.
    Body,
    /// A particle or a point: an origin, with the axes of what carries it.
    Point,
    /// A frame: axes.
    Frame,
}

/// A placed thing: the link it is fixed in (the ground if none) and where.
#[derive(Clone, Debug)]
pub struct Placed<'g> {
    /// The link.
    pub link: Option<LinkId>,
    /// Its placement in the link.
    pub pose: Pose<'g>,
    /// What it is.
    pub kind: PlacedKind,
}

/// Mass, centre of mass in body axes, inertia about it.
pub type MassProperties<'g> = (Expr<'g>, Vec3<'g>, Sym3<'g>);

/// What is placed so far, and how it moves.
#[derive(Debug, Default)]
pub struct Kinematics<'g> {
    /// By name.
    pub places: BTreeMap<String, Placed<'g>>,
    /// Plain coordinates by full name; true for an angle.
    pub coordinates: Vec<(String, Coordinate, bool)>,
    /// Kinematics of the links.
    pub joints: Vec<Joint<'g>>,
    /// The configuration space, once all links are there.
    pub charts: Vec<Chart>,
    /// Twists of the links, once all are there.
    pub twists: Vec<Spatial<'g>>,
    /// By joint: its number, and the axes of its frame on the parent, in which its reactions are resolved.
    pub transmissions: BTreeMap<String, (usize, Option<LinkId>, Rotation<'g>)>,
    /// By contact: what its surfaces exert on each other.
    pub touches: BTreeMap<String, Exerted<'g>>,
    /// By force element that an output asks for: what it delivers.
    pub powers: BTreeMap<String, Delivered<'g>>,
    /// Accelerations of the links, once all are there.
    pub accelerations: Vec<Spatial<'g>>,
    /// Mass, centre of mass and central inertia of bodies and particles.
    pub masses: BTreeMap<String, MassProperties<'g>>,
}

/// What the second surface of a contact exerts on the first, by axes of links.
#[derive(Debug, Default)]
pub struct Exerted<'g> {
    /// Forces at all points.
    pub forces: Vec<(Option<LinkId>, Vec3<'g>)>,
    /// Moments of friction against spin and rolling.
    pub moments: Vec<(Option<LinkId>, Vec3<'g>)>,
    /// What all of them deliver.
    pub power: Option<Expr<'g>>,
}

impl<'g> Exerted<'g> {
    /// Adds power.
    pub fn deliver(&mut self, power: Expr<'g>) {
        self.power = Some(self.power.map_or(power, |sum| sum + power));
    }
}

/// What a force element delivers, or why that is not known.
pub type Delivered<'g> = Result<Expr<'g>, &'static str>;

/// A vector as a sum over the axes of links.
pub type Terms<'g> = Vec<(Option<LinkId>, Vec3<'g>)>;

impl<'g> Kinematics<'g> {
    /// The components of a sum in the axes of one link.
    pub fn resolve(&self, terms: &Terms<'g>, link: Option<LinkId>, zero: Vec3<'g>) -> Vec3<'g> {
        terms.iter().fold(zero, |sum, (from, v)| sum + change_axes(&self.joints, *v, *from, link))
    }

    /// The position of a point from the ground's origin.
    pub fn position(&self, link: Option<LinkId>, p: Vec3<'g>) -> Terms<'g> {
        let mut terms = vec![(link, p)];
        let mut at = link;
        while let Some(l) = at {
            let joint = &self.joints[l.0];
            terms.push((joint.parent, joint.translation));
            at = joint.parent;
        }
        terms
    }

    /// `r(y / x)`, with what both share left out.
    pub fn between(&self, y: &Placed<'g>, x: &Placed<'g>) -> Terms<'g> {
        let mut sum = self.position(y.link, y.pose.translation);
        for (axes, v) in self.position(x.link, x.pose.translation) {
            match sum.iter_mut().find(|(known, _)| *known == axes) {
                Some((_, total)) => *total -= v,
                None => sum.push((axes, -v)),
            }
        }
        sum.retain(|(_, v)| !v.is_zero());
        sum
    }

    /// Velocity of a point relative to the ground.
    pub fn velocity(&self, p: &Placed<'g>) -> Terms<'g> {
        p.link.map_or(Vec::new(), |l| {
            let t = &self.twists[l.0];
            vec![(p.link, t.linear + t.angular.cross(p.pose.translation))]
        })
    }

    /// Acceleration of a point relative to the ground.
    pub fn acceleration(&self, p: &Placed<'g>) -> Terms<'g> {
        p.link.map_or(Vec::new(), |l| {
            let (t, a, r) = (&self.twists[l.0], &self.accelerations[l.0], p.pose.translation);
            vec![(p.link, a.linear + a.angular.cross(r) + t.angular.cross(t.angular.cross(r)))]
        })
    }
}

impl<'g> Scope<'_, 'g> {
    /// Evaluates with another context.
    pub fn in_context<T>(&self, context: Context<'g>, f: impl FnOnce(&Self) -> T) -> T {
        let before = self.context.replace(context);
        let result = f(self);
        self.context.replace(before);
        result
    }

    /// What expressions may depend on here.
    pub fn allowed(&self) -> Allowed {
        self.context.borrow().allowed
    }
}
