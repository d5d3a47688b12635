//! Scopes for the resolution of expressions: declared names, elements placed so far with their motion, and
//! the quantities on which an expression may depend.

use super::resolved::ResolvedMatrix;
use crate::expr::{Expr, Graph, Rotation, Sym3, Vec3};
use crate::kinematics::{Joint, SpatialVector, express_in_link_axes};
use crate::mechanism::{Chart, Coordinate, InQ, InV, LinkId, Pose, Requirement};
use crate::syntax::{self, Description, Rank};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Scope in which the names of an expression are resolved.
pub struct Scope<'a, 'g> {
    /// Graph that owns the expressions of the model.
    pub graph: &'g Graph,
    /// Description written by the user.
    pub description: &'a Description,
    /// Names of bodies, particles and frames.
    pub bodies: Vec<String>,
    /// Number of joints and drives with inputs of their own. In `u` they precede the declared inputs.
    pub driven: usize,
    /// Quantities on which expressions may depend, and the meaning of the unqualified axes `x`, `y` and `z`.
    pub context: RefCell<Context<'g>>,
    /// Elements placed so far, with their motion.
    pub kinematics: PlacedElements<'g>,
    /// Facts that have been found while expressions were resolved.
    pub records: RefCell<ResolutionRecords<'g>>,
}

/// Records of what was found while expressions were resolved, such as used parameters.
#[derive(Debug, Default)]
pub struct ResolutionRecords<'g> {
    /// Whether each parameter was used in an expression.
    pub used: Vec<bool>,
    /// Whether each table was used in an expression.
    pub used_tables: Vec<bool>,
    /// Unknown names that have been reported. Each is reported once, because a declaration is most likely
    /// missing.
    pub reported_names: BTreeSet<String>,
    /// Names of the definitions whose errors have been reported.
    pub reported_definitions: BTreeSet<String>,
    /// Whether a constraint on configurations is being resolved.
    pub in_holonomic_constraint: bool,
    /// Placements that replace those of the elements while a field is differentiated.
    pub displaced: Vec<(String, PlacedElement<'g>)>,
    /// Values of definitions used by the definition that is being evaluated. Each is evaluated once, even if
    /// several others use it.
    pub definition_values: DefinitionValues<'g>,
    /// Conditions on values that depend on parameters, recorded so far.
    pub requirements: Vec<Requirement<'g>>,
}

/// Values of definitions, by name, by allowed quantities, and by whether unqualified axes are those of the
/// ground; `None` for definitions with errors.
pub type DefinitionValues<'g> = BTreeMap<(String, AllowedQuantities, bool), Option<Value<'g>>>;

/// Axes in which the components of a vector are given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Axes of the frame to which the attribute belongs.
    Own,
    /// Axes of a named body (or `ground`) whose link is not yet resolved.
    Of(String),
    /// Axes of a link, or of the ground for `None`.
    Link(Option<LinkId>),
}

/// Value of an expression: a scalar, a vector as a sum over axes, or a matrix.
#[derive(Clone, Debug)]
pub enum Value<'g> {
    /// Scalar value of an expression.
    Scalar(Expr<'g>),
    /// Physical vector, by its components in the axes of one or more frames.
    Vector(Vec<(Axes, Vec3<'g>)>),
    /// Physical matrix, with the frame of its axes.
    Matrix(ResolvedMatrix<'g>),
}

impl Value<'_> {
    /// Returns the rank as which the value can be declared.
    pub fn value_rank(&self) -> Rank {
        match self {
            Value::Scalar(_) => Rank::Scalar,
            Value::Vector(_) => Rank::Vector,
            Value::Matrix(_) => Rank::Matrix,
        }
    }

    /// Returns the kind of value, with its article, for messages.
    pub fn kind_with_article(&self) -> &'static str {
        match self {
            Value::Scalar(_) => "a scalar",
            Value::Vector(_) => "a vector",
            Value::Matrix(_) => "a matrix",
        }
    }
}

/// Quantities on which an expression may depend; each kind includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AllowedQuantities {
    /// The expression may depend on parameters only.
    Constant,
    /// The expression may depend on coordinates and time, in addition to parameters.
    Placement,
    /// The expression may depend on velocities and inputs as well.
    Motion,
    /// The expression may depend on accelerations as well.
    Acceleration,
    /// Reactions of joints and contact forces, in addition to accelerations.
    Reaction,
}

/// Context in which an expression is resolved.
#[derive(Clone, Debug)]
pub struct Context<'g> {
    /// Quantities on which the expression may depend.
    pub allowed: AllowedQuantities,
    /// Link and pose whose axes `x`, `y` and `z` denote; `None` for the attribute's own axes.
    pub axes: Option<(Option<LinkId>, Pose<'g>)>,
    /// Local names of the expression, such as `stretch`, with their values.
    pub locals: Vec<(&'static str, Expr<'g>)>,
    /// Compared expressions of the piecewise laws that are being resolved, as written, with the symbols that
    /// replace them.
    pub compared: Vec<(syntax::Expr, Expr<'g>)>,
    /// Names of the definitions that are being evaluated.
    pub defining: Vec<String>,
}

impl<'g> Context<'g> {
    /// Returns a context for expressions without local names.
    pub fn new(allowed: AllowedQuantities, axes: Option<(Option<LinkId>, Pose<'g>)>) -> Context<'g> {
        Context { allowed, axes, locals: Vec::new(), compared: Vec::new(), defining: Vec::new() }
    }

    /// Returns the context with these local names.
    pub fn with_locals(mut self, locals: Vec<(&'static str, Expr<'g>)>) -> Context<'g> {
        self.locals = locals;
        self
    }
}

/// Kind of a placed element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlacedElementKind {
    /// The placed element is a body: it has axes and an origin.
    Body,
    /// Particle or point: an origin, with the axes of the element that carries it.
    Point,
    /// The placed element is a frame: it has axes and no origin.
    Frame,
}

/// Placed element: the link in which it is fixed, and its pose.
#[derive(Clone, Debug)]
pub struct PlacedElement<'g> {
    /// Link in which the element is fixed; `None` for the ground.
    pub link: Option<LinkId>,
    /// Pose of the element relative to its link.
    pub pose: Pose<'g>,
    /// Kind of the placed element.
    pub kind: PlacedElementKind,
}

/// Coordinate on which force elements can act: full name, coordinate, and whether it is an angle.
pub type NamedCoordinate = (String, Coordinate, bool);

/// Coordinates of a joint, after numbering.
#[derive(Debug)]
pub struct JointCoordinates {
    /// Index of the joint's first coordinate in `q`.
    pub q: InQ,
    /// Index of the joint's first velocity in `v`.
    pub v: InV,
    /// Coordinates on which force elements can act.
    pub plain: Vec<NamedCoordinate>,
}

/// Mass, centre of mass in body axes, and central inertia.
pub type MassProperties<'g> = (Expr<'g>, Vec3<'g>, Sym3<'g>);

/// Elements placed so far, with their motion.
#[derive(Debug, Default)]
pub struct PlacedElements<'g> {
    /// Placements of the elements, by name of the element.
    pub places: BTreeMap<String, PlacedElement<'g>>,
    /// Plain coordinates by full name; true for an angle.
    pub coordinates: Vec<NamedCoordinate>,
    /// Coordinates of each joint.
    pub joint_coordinates: Vec<JointCoordinates>,
    /// First coordinate and velocity of released joints; `None` if no joint is released.
    pub first_released: Option<(InQ, InV)>,
    /// Kinematics of the links that joints move.
    pub joints: Vec<Joint<'g>>,
    /// Charts of the configuration space; set after all links are placed.
    pub charts: Vec<Chart>,
    /// Twists of the links; set after all links are placed.
    pub twists: Vec<SpatialVector<'g>>,
    /// Index of each joint, and the axes of its frame on the parent, in which its reactions are resolved.
    pub transmissions: BTreeMap<String, (usize, Option<LinkId>, Rotation<'g>)>,
    /// Forces and moments between the surfaces of each contact.
    pub contact_loads: BTreeMap<String, ContactLoads<'g>>,
    /// Power of each force element that an output uses.
    pub powers: BTreeMap<String, ElementPower<'g>>,
    /// Quantities of force elements of a file, by the names that the laws of these elements contain.
    pub file_element_quantities: BTreeMap<String, Expr<'g>>,
    /// Accelerations of the links; set after all links are placed.
    pub accelerations: Vec<SpatialVector<'g>>,
    /// Mass, centre of mass and central inertia of bodies and particles.
    pub masses: BTreeMap<String, MassProperties<'g>>,
}

/// Forces and moments of the second surface of a contact on the first, each in the axes of a link.
#[derive(Debug, Default)]
pub struct ContactLoads<'g> {
    /// Forces of the element at all of its points of action.
    pub forces: Vec<(Option<LinkId>, Vec3<'g>)>,
    /// Friction moments of the element against spin and rolling.
    pub moments: Vec<(Option<LinkId>, Vec3<'g>)>,
    /// Power of all forces and moments of the element.
    pub power: Option<Expr<'g>>,
}

impl<'g> ContactLoads<'g> {
    /// Adds a power to that of the element.
    pub fn add_contact_power(&mut self, power: Expr<'g>) {
        self.power = Some(self.power.map_or(power, |sum| sum + power));
    }
}

/// Power of a force element, or the reason why it is unavailable.
pub type ElementPower<'g> = Result<Expr<'g>, &'static str>;

/// A vector as a sum over the axes of links.
pub type VectorTerms<'g> = Vec<(Option<LinkId>, Vec3<'g>)>;

impl<'g> PlacedElements<'g> {
    /// Returns the components of a sum in the axes of one link.
    pub fn components_in_link_axes(
        &self,
        terms: &VectorTerms<'g>,
        link: Option<LinkId>,
        zero: Vec3<'g>,
    ) -> Vec3<'g> {
        terms.iter().fold(zero, |sum, (from, v)| sum + express_in_link_axes(&self.joints, *v, *from, link))
    }

    /// Returns the position of a point relative to the ground's origin.
    pub fn position_of_point(&self, link: Option<LinkId>, p: Vec3<'g>) -> VectorTerms<'g> {
        let mut terms = vec![(link, p)];
        let mut current = link;
        while let Some(l) = current {
            let joint = &self.joints[l.0];
            terms.push((joint.parent, joint.translation));
            current = joint.parent;
        }
        terms
    }

    /// Returns `r(y / x)`; links that carry both points cancel.
    pub fn position_between(&self, y: &PlacedElement<'g>, x: &PlacedElement<'g>) -> VectorTerms<'g> {
        let mut sum = self.position_of_point(y.link, y.pose.translation);
        for (axes, v) in self.position_of_point(x.link, x.pose.translation) {
            match sum.iter_mut().find(|(known, _)| *known == axes) {
                Some((_, total)) => *total -= v,
                None => sum.push((axes, -v)),
            }
        }
        sum.retain(|(_, v)| !v.is_zero());
        sum
    }

    /// Returns the velocity of a point relative to the ground.
    pub fn velocity_of_point(&self, p: &PlacedElement<'g>) -> VectorTerms<'g> {
        p.link.map_or(Vec::new(), |l| {
            let t = &self.twists[l.0];
            vec![(p.link, t.linear + t.angular.cross(p.pose.translation))]
        })
    }

    /// Returns the acceleration of a point relative to the ground.
    pub fn acceleration_of_point(&self, p: &PlacedElement<'g>) -> VectorTerms<'g> {
        p.link.map_or(Vec::new(), |l| {
            let (t, a, r) = (&self.twists[l.0], &self.accelerations[l.0], p.pose.translation);
            vec![(p.link, a.linear + a.angular.cross(r) + t.angular.cross(t.angular.cross(r)))]
        })
    }
}

impl<'g> Scope<'_, 'g> {
    /// Calls a function while another context applies to expressions.
    pub fn call_in_context<T>(&self, context: Context<'g>, f: impl FnOnce(&Self) -> T) -> T {
        let before = self.context.replace(context);
        let result = f(self);
        self.context.replace(before);
        result
    }

    /// Returns the placement of an element by its name.
    pub fn placement_of_element(&self, name: &str) -> Option<PlacedElement<'g>> {
        let records = self.records.borrow();
        let displaced = records.displaced.iter().rev().find(|(displaced, _)| displaced == name);
        displaced.map(|(_, placed)| placed).or_else(|| self.kinematics.places.get(name)).cloned()
    }

    /// Returns the quantities on which expressions may depend in the current context.
    pub fn allowed_quantities(&self) -> AllowedQuantities {
        self.context.borrow().allowed
    }
}
