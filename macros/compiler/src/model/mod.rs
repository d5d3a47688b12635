//! What the user wrote → a checked mechanism: names resolved, the tree of links found, joints reduced to elementary
//! motions, bodies lumped into the links that carry them. Values are expressions of the parameters. All mistakes of
//! the user are found here or before; knows neither algorithms nor generated code.

use crate::diag::Place;
use crate::expr::{Expr, Graph, Rotation, Sym3, Symbol, Vec3};
use crate::syntax::ScalarType;
use std::rc::Rc;

mod action;
mod axis;
mod build;
mod carriers;
mod closed_form;
mod constraint;
mod contact;
mod figures;
pub mod gradients;
mod inertia;
mod joint;
pub mod kinematics;
mod masses;
mod mobility;
mod outline;
pub mod passive;
mod place;
mod reaction;
mod redundancy;
mod resolve;
mod rows;
mod slips;
mod terms;
mod tree;
pub mod units;
mod world;

pub use axis::sample;
pub use build::build_model;
pub use outline::{Outline, Uses, outline};
pub use rows::random_configuration;

/// What a symbol of the expressions stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A parameter of the struct.
    Parameter(usize),
    /// An entry of `q`.
    Configuration(usize),
    /// An entry of `v`.
    Velocity(usize),
    /// An entry of `a`.
    Acceleration(usize),
    /// An entry of `tau`.
    Force(usize),
    /// An entry of `u`.
    Input(usize),
    /// Time.
    Time,
    /// An entry of an intermediate result that is handed to a generated function.
    Given(usize),
    /// A number that is computed from the parameters before.
    Prepared(usize),
    /// A component of what a joint transmits: six for each, a force and then a torque.
    Reaction(usize),
    /// A passive force that a function of its own computes, by velocity.
    PassiveForce(usize),
    /// A derivative of passive forces that a function of its own computes, in the order of its results.
    PassiveDerivative(usize),
}

impl Quantity {
    const SHIFT: u32 = 20;

    /// The symbol that stands for it.
    pub fn symbol(self) -> Symbol {
        let (kind, index) = match self {
            Quantity::Parameter(k) => (0, k),
            Quantity::Configuration(k) => (1, k),
            Quantity::Velocity(k) => (2, k),
            Quantity::Acceleration(k) => (3, k),
            Quantity::Force(k) => (4, k),
            Quantity::Input(k) => (5, k),
            Quantity::Time => (6, 0),
            Quantity::Given(k) => (7, k),
            Quantity::Prepared(k) => (8, k),
            Quantity::Reaction(k) => (9, k),
            Quantity::PassiveForce(k) => (10, k),
            Quantity::PassiveDerivative(k) => (11, k),
        };
        Symbol((kind << Quantity::SHIFT) | index as u32)
    }

    /// What a symbol stands for.
    pub fn of(symbol: Symbol) -> Quantity {
        let index = (symbol.0 & ((1 << Quantity::SHIFT) - 1)) as usize;
        match symbol.0 >> Quantity::SHIFT {
            0 => Quantity::Parameter(index),
            1 => Quantity::Configuration(index),
            2 => Quantity::Velocity(index),
            3 => Quantity::Acceleration(index),
            4 => Quantity::Force(index),
            5 => Quantity::Input(index),
            6 => Quantity::Time,
            7 => Quantity::Given(index),
            8 => Quantity::Prepared(index),
            9 => Quantity::Reaction(index),
            10 => Quantity::PassiveForce(index),
            _ => Quantity::PassiveDerivative(index),
        }
    }

    /// It as an expression.
    pub fn expr(self, graph: &Graph) -> Expr<'_> {
        graph.symbol(self.symbol())
    }
}

/// Index of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LinkId(pub usize);

/// The placement of a child frame in a parent frame.
#[derive(Clone, Debug)]
pub struct Pose<'g> {
    /// Orientation of the child's axes in the parent's.
    pub rotation: Rotation<'g>,
    /// The child's origin, in parent axes.
    pub translation: Vec3<'g>,
}

impl<'g> Pose<'g> {
    /// The child frame is the parent frame.
    pub fn identity(graph: &'g Graph) -> Pose<'g> {
        Pose { rotation: Rotation::identity(graph), translation: Vec3::zero(graph) }
    }

    /// This placement, then `next` in the child frame.
    pub fn then(&self, next: &Pose<'g>) -> Pose<'g> {
        Pose {
            rotation: self.rotation.clone().then(&next.rotation),
            translation: self.point(next.translation),
        }
    }

    /// The placement of the parent frame in the child frame.
    pub fn inverse(&self) -> Pose<'g> {
        let rotation = self.rotation.inverse();
        Pose { translation: -rotation.to_parent(self.translation), rotation }
    }

    /// A point of the child frame, from the parent's origin in parent axes.
    pub fn point(&self, p: Vec3<'g>) -> Vec3<'g> {
        self.translation + self.rotation.to_parent(p)
    }
}

/// Mass properties of a link about its frame's origin, in its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia<'g> {
    /// Mass.
    pub mass: Expr<'g>,
    /// Mass times centre of mass.
    pub moment: Vec3<'g>,
    /// Inertia about the origin.
    pub tensor: Sym3<'g>,
}

impl<'g> Inertia<'g> {
    /// Nothing.
    pub fn zero(graph: &'g Graph) -> Inertia<'g> {
        Inertia { mass: graph.zero(), moment: Vec3::zero(graph), tensor: Sym3::zero(graph) }
    }

    /// A body with its centre of mass at `c` and an inertia about it.
    pub fn of_body(mass: Expr<'g>, c: Vec3<'g>, central: Sym3<'g>) -> Inertia<'g> {
        Inertia { mass, moment: c * mass, tensor: central + Sym3::point(mass, c) }
    }

    /// The sum.
    pub fn plus(&self, b: &Inertia<'g>) -> Inertia<'g> {
        Inertia { mass: self.mass + b.mass, moment: self.moment + b.moment, tensor: self.tensor + b.tensor }
    }

    /// The sum with mass properties of a frame placed in this one.
    ///
    /// With `h` the other's first moment in these axes and `s = h + m p / 2`, the parallel-axis theorem adds
    /// `2 (p · s) 1 − (p sᵀ + s pᵀ)`.
    pub fn plus_placed(&self, other: &Inertia<'g>, rotation: &Rotation<'g>, p: Vec3<'g>) -> Inertia<'g> {
        let h = rotation.to_parent(other.moment);
        let s = h + p * (other.mass * 0.5);
        let twice: [Expr<'g>; 3] = std::array::from_fn(|k| (p[k] * 2.0) * s[k]);
        let shift = Sym3 {
            diagonal: [twice[1] + twice[2], twice[2] + twice[0], twice[0] + twice[1]],
            off: [(0, 1), (0, 2), (1, 2)].map(|(i, j)| -(p[i] * s[j] + p[j] * s[i])),
        };
        Inertia {
            mass: self.mass + other.mass,
            moment: self.moment + (h + p * other.mass),
            tensor: self.tensor + (rotation.sym_to_parent(other.tensor) + shift),
        }
    }
}

/// A joint coordinate: `ratio × q[index] + offset`, with velocity `ratio × v[index]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// Index in `q`.
    pub q: usize,
    /// Index in `v`.
    pub v: usize,
    /// Factor.
    pub ratio: f64,
    /// Offset.
    pub offset: f64,
}

/// The motion of a link in its parent's joint frame.
#[derive(Clone, Debug)]
pub enum Motion<'g> {
    /// Rotation about a unit axis.
    Turn {
        /// Axis, in joint axes.
        axis: Vec3<'g>,
        /// Angle.
        coordinate: Coordinate,
    },
    /// Translation along a unit axis.
    Slide {
        /// Axis, in joint axes.
        axis: Vec3<'g>,
        /// Length.
        coordinate: Coordinate,
    },
    /// Rotation about an axis with a proportional translation along it.
    Helix {
        /// Axis, in joint axes.
        axis: Vec3<'g>,
        /// Advance per radian.
        pitch: Expr<'g>,
        /// Angle.
        coordinate: Coordinate,
    },
    /// All rotations: a quaternion from `q`, three angular velocities in link axes from `v`.
    Ball {
        /// First of four entries of `q`.
        q: usize,
        /// First of three entries of `v`.
        v: usize,
    },
    /// All motions: position and quaternion from `q`, linear and angular velocity in link axes from `v`.
    Free {
        /// First of seven entries of `q`.
        q: usize,
        /// First of six entries of `v`.
        v: usize,
    },
    /// The link's placement is itself an expression of coordinates and time.
    Placed,
}

/// A part of the configuration space: first entries of `q` and `v`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chart {
    /// A plain coordinate.
    Plain(usize, usize),
    /// A ball's quaternion.
    Ball(usize, usize),
    /// A free joint's position and quaternion.
    Free(usize, usize),
}

/// A moving frame of the tree, with everything that is fixed in it.
#[derive(Clone, Debug)]
pub struct Link<'g> {
    /// The link that carries it; the ground if none. Its index is smaller.
    pub parent: Option<LinkId>,
    /// The joint's frame on the parent link.
    pub placement: Pose<'g>,
    /// How the link moves in the joint's frame.
    pub motion: Motion<'g>,
    /// Mass properties of all bodies fixed in it.
    pub inertia: Inertia<'g>,
}

/// A named frame: a body's, a particle's or a point's.
#[derive(Clone, Debug)]
pub struct NamedFrame<'g> {
    /// Name.
    pub name: String,
    /// It may have mass: it is no point.
    pub massive: bool,
    /// The link it is fixed in; the ground if none.
    pub link: Option<LinkId>,
    /// Its placement in the link's frame.
    pub pose: Pose<'g>,
}

/// A linear spring on a coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Spring<'g> {
    /// What it acts on.
    pub on: Coordinate,
    /// Stiffness.
    pub stiffness: Expr<'g>,
    /// Coordinate without force.
    pub free: Expr<'g>,
}

/// A dashpot on a coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Dashpot<'g> {
    /// What it acts on.
    pub on: Coordinate,
    /// Damping coefficient.
    pub damping: Expr<'g>,
}

/// Coulomb friction on a coordinate, regularised as `friction × tanh(rate / friction_speed)`.
#[derive(Clone, Copy, Debug)]
pub struct CoulombFriction<'g> {
    /// What it acts on.
    pub on: Coordinate,
    /// Force or torque of full friction.
    pub friction: Expr<'g>,
}

/// What an entry of `u` does.
#[derive(Clone, Debug)]
pub enum Input<'g> {
    /// Nothing by itself: expressions name it.
    Named,
    /// A force or torque on a coordinate.
    Coordinate(Coordinate),
    /// A force on a link.
    Force {
        /// The link.
        link: LinkId,
        /// Point of application, in link axes.
        point: Vec3<'g>,
        /// Direction.
        along: Direction<'g>,
    },
    /// A torque on a link.
    Torque {
        /// The link.
        link: LinkId,
        /// Direction.
        about: Direction<'g>,
    },
}

/// A sum of vectors, each in the axes of a link (of the ground if none).
pub type Direction<'g> = Vec<(Option<LinkId>, Vec3<'g>)>;

/// A checked mechanism.
#[derive(Clone)]
pub struct Model<'g> {
    /// Owner of all expressions.
    pub graph: &'g Graph,
    /// The struct's name.
    pub name: String,
    /// Where the name stands.
    pub place: Place,
    /// Scalar type of the generated functions.
    pub scalar: ScalarType,
    /// Names of the parameters.
    pub parameters: Vec<String>,
    /// There are no dynamics, as the user asked for: nothing needs inertia.
    pub kinematic: bool,
    /// Uniform gravity, in ground axes.
    pub gravity: Vec3<'g>,
    /// Speed at which friction is regularised.
    pub friction_speed: Expr<'g>,
    /// Links, parents before children.
    pub links: Vec<Link<'g>>,
    /// Mass properties that count as moving although the ground carries them: what a pass found to stay where it is.
    pub still: Inertia<'g>,
    /// Something depends on time.
    pub time: bool,
    /// Inputs act by way of the velocity.
    pub velocity_inputs: bool,
    /// Parts of the configuration space, in the order of `v`.
    pub charts: Vec<Chart>,
    /// Forces of elements that were found so far.
    pub gradients: gradients::Gradients,
    /// Name of every entry of `q`.
    pub configuration: Vec<String>,
    /// Name of every entry of `v`, and where the joint stands.
    pub velocities: Vec<(String, Place)>,
    /// Name of every entry of `u`.
    pub inputs: Vec<(String, Input<'g>)>,
    /// Named frames.
    pub frames: Vec<NamedFrame<'g>>,
    /// Springs.
    pub springs: Vec<Spring<'g>>,
    /// Dashpots.
    pub dashpots: Vec<Dashpot<'g>>,
    /// Dry friction.
    pub frictions: Vec<CoulombFriction<'g>>,
    /// Potential energies beside those of gravity and springs on coordinates.
    pub potentials: Vec<Expr<'g>>,
    /// Rayleigh dissipation functions.
    pub dissipations: Vec<Expr<'g>>,
    /// Other forces.
    pub loads: Vec<Load<'g>>,
    /// The forces of all these, where a function of its own computes them and all others take them as given.
    pub passive: Option<Rc<passive::PassiveForces<'g>>>,
    /// Inertances.
    pub inertances: Vec<Inertance<'g>>,
    /// Scalar constraints; those on configurations first.
    pub constraints: Vec<Constraint<'g>>,
    /// Names of rows of joints and constraints that follow from the others everywhere.
    pub redundant: Vec<String>,
    /// The pivots by which dependent velocities are solved for, constraint and velocity, where independent speeds are to
    /// be used.
    pub dependent: Option<Vec<(usize, usize)>>,
    /// The joints that loops are solved for in closed form, two for each.
    pub solved: Vec<SolvedSide<'g>>,
    /// Degrees of freedom: independent coordinates and independent velocities.
    pub freedom: [usize; 2],
    /// Outputs.
    pub outputs: Vec<OutputValue<'g>>,
    /// The same mechanism with the joints whose reactions outputs name opened: six coordinates for each after all others.
    pub opened: Option<Rc<Opened<'g>>>,
    /// Units of parameters, coordinates, inputs, outputs and constraints.
    pub units: units::Units,
}

/// A joint that a loop is solved for: it turns about an axis or slides along one, in its frame on the parent.
#[derive(Clone, Debug)]
pub struct SolvedSide<'g> {
    /// The joint, by number.
    pub joint: usize,
    /// A Pin, otherwise a Sleeve.
    pub turns: bool,
    /// Its axis.
    pub axis: Vec3<'g>,
}

/// A force with the rate that it does work on: its power is `force × rate`, and it contributes `force × ∂rate/∂v` to the
/// generalized forces.
#[derive(Clone, Copy, Debug)]
pub struct Load<'g> {
    /// Linear in the velocities.
    pub rate: Expr<'g>,
    /// An expression of state, time and inputs.
    pub force: Expr<'g>,
    /// It takes energy out, as a dashpot does; otherwise it is applied from outside.
    pub dissipative: bool,
}

/// An inertance on a rate: kinetic energy `½ b rate²`.
#[derive(Clone, Copy, Debug)]
pub struct Inertance<'g> {
    /// Linear in the velocities.
    pub rate: Expr<'g>,
    /// Inertance `b`.
    pub inertance: Expr<'g>,
}

/// A scalar constraint: `rate` stays zero, and so does `residual` if it restricts configurations.
#[derive(Clone, Debug)]
pub struct Constraint<'g> {
    /// Its name: that of the joint or constraint, and which component.
    pub name: String,
    /// Where that stands.
    pub place: Place,
    /// An expression of configuration and time whose derivative is `rate`; none for a constraint on velocities alone.
    pub residual: Option<Expr<'g>>,
    /// Linear in the velocities, with a term that does not contain them where something is driven in time.
    pub rate: Expr<'g>,
    /// Derivative of `rate` at zero accelerations.
    pub bias: Expr<'g>,
    /// What `residual` measures, or where there is none, what `rate` is the rate of.
    pub measure: Measure,
    /// What its multiplier is in a joint that closes a loop.
    pub transmits: Vec<Transmission<'g>>,
    /// Constraints of one number are components of one vector: how much each of them restricts is measured by all.
    pub group: usize,
    /// It determines coordinates that may have no inertia.
    pub determines: bool,
    /// Friction in proportion to its multiplier, the normal force of a contact that slips.
    pub friction: Vec<FrictionTerm<'g>>,
}

/// Friction along a direction: its power is `share × rate` for each unit of normal force, pressing or pulling.
#[derive(Clone, Copy, Debug)]
pub struct FrictionTerm<'g> {
    /// The rate of slip, linear in the velocities.
    pub rate: Expr<'g>,
    /// Force along it by normal force, an expression of state and time.
    pub share: Expr<'g>,
}

/// What a scalar constraint measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A length between two points or surfaces.
    Length,
    /// The sine of an angle, or the difference of a cosine, which are zero where the angle is right.
    Angle,
    /// What an expression is, or the rate of something: that of a declared constraint, by its index.
    Declared(usize),
}

/// A part of the force or torque that a joint's parent exerts on its child.
#[derive(Clone, Copy, Debug)]
pub struct Transmission<'g> {
    /// The joint.
    pub joint: usize,
    /// A torque, not a force.
    pub torque: bool,
    /// Direction in ground axes.
    pub direction: Vec3<'g>,
}

/// A mechanism with opened joints: what holds their coordinates at zero is what they transmit.
#[derive(Clone)]
pub struct Opened<'g> {
    /// The mechanism.
    pub model: Model<'g>,
    /// The joints in the order of their coordinates.
    pub joints: Vec<usize>,
}

/// An expression that becomes a function.
#[derive(Clone, Debug)]
pub struct OutputValue<'g> {
    /// Its name.
    pub name: String,
    /// One component, or three.
    pub values: Vec<Expr<'g>>,
}

impl<'g> Model<'g> {
    /// The configuration space.
    pub fn space(&self) -> kinematics::Space<'_, 'g> {
        kinematics::Space { graph: self.graph, charts: &self.charts }
    }

    /// Number of entries of `q`.
    pub fn nq(&self) -> usize {
        self.configuration.len()
    }

    /// Number of entries of `v`.
    pub fn nv(&self) -> usize {
        self.velocities.len()
    }

    /// Number of entries of `u`.
    pub fn nu(&self) -> usize {
        self.inputs.len()
    }

    /// Number of constraints on configurations.
    pub fn holonomic(&self) -> usize {
        self.constraints.iter().filter(|c| c.residual.is_some()).count()
    }

    /// Whether some constraints follow from others wherever all are fulfilled, though no elimination could tell which: as
    /// in Bricard's linkage.
    pub fn is_overdetermined(&self) -> bool {
        let plain = self.constraints.iter().all(|c| c.friction.is_empty() && !c.determines);
        plain && self.constraints.len() + self.freedom[1] > self.nv()
    }
}
