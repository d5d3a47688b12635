//! The mechanism as a whole.

use super::constraint::{Constraint, Freedom, Pivot, SolvedSide};
use super::contact::Contact;
use super::drawing::Piece;
use super::element::{AccelerationForce, CoulombFriction, Dashpot, Inertance, Input, Load, Spring};
use super::equilibrium::Equilibrium;
use super::gradients::Gradients;
use super::index::{InQ, InV};
use super::inertia::Inertia;
use super::limit::Limit;
use super::link::{Link, NamedFrame, Space};
use super::motion::Chart;
use super::passive::PassiveForces;
use super::requirement::Requirement;
use super::speeds::Speeds;
use super::units::Units;
use crate::diag::Place;
use crate::expr::{Expr, Graph, Vec3};
use std::rc::Rc;

/// A checked mechanism.
#[derive(Clone)]
pub struct Model<'g> {
    /// Owner of all expressions.
    pub graph: &'g Graph,
    /// The struct's name.
    pub name: String,
    /// Where the name stands.
    pub place: Place,
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
    pub gradients: Gradients,
    /// Name of every entry of `q`.
    pub configuration: Vec<String>,
    /// Name of every entry of `v`, and where the joint stands.
    pub velocities: Vec<(String, Place)>,
    /// The speeds that are the entries of `v`, if the user chose some. Everything else of the model is written in the
    /// velocities that the joints have.
    pub speeds: Option<Rc<Speeds<'g>>>,
    /// Name of every entry of `u`.
    pub inputs: Vec<(String, Input<'g>)>,
    /// Limits, one for each entry of `v` that has any.
    pub limits: Vec<Limit<'g>>,
    /// Configurations at rest about which linear equations are printed.
    pub equilibria: Vec<Equilibrium<'g>>,
    /// Contacts that open and close, stops among them.
    pub contacts: Vec<Contact<'g>>,
    /// What figures that follow from parameters must fulfil.
    pub requirements: Vec<Requirement<'g>>,
    /// Named frames.
    pub frames: Vec<NamedFrame<'g>>,
    /// What it looks like, if that was asked for.
    pub drawing: Vec<Piece<'g>>,
    /// The heights of its terrains, by two given numbers.
    pub heights: Vec<Expr<'g>>,
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
    /// What of other forces is linear in the accelerations.
    pub acceleration_forces: Vec<AccelerationForce<'g>>,
    /// The forces of all these, where a function of its own computes them and all others take them as given.
    pub passive: Option<Rc<PassiveForces<'g>>>,
    /// Inertances.
    pub inertances: Vec<Inertance<'g>>,
    /// Scalar constraints; those on configurations first.
    pub constraints: Vec<Constraint<'g>>,
    /// Names of rows of joints and constraints that follow from the others everywhere.
    pub redundant: Vec<String>,
    /// The pivots by which dependent velocities are solved for, in their order, where independent speeds are to be used.
    pub dependent: Option<Vec<Pivot>>,
    /// The joints that loops are solved for in closed form, two for each.
    pub solved: Vec<SolvedSide<'g>>,
    /// Degrees of freedom.
    pub freedom: Freedom,
    /// Outputs.
    pub outputs: Vec<OutputValue<'g>>,
    /// The mechanism with the joints released whose reactions outputs name: six coordinates for each, after all others.
    pub released: Option<Rc<Released<'g>>>,
    /// Units of parameters, coordinates, inputs, outputs and constraints.
    pub units: Units,
}

/// A mechanism with released joints: what holds their coordinates at zero is what they transmit.
#[derive(Clone)]
pub struct Released<'g> {
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
    /// One component, three or nine; of a diagram nine for each action.
    pub values: Vec<Expr<'g>>,
    /// What the values are, if they are a free-body diagram.
    pub diagram: Option<Diagram>,
}

/// A free-body diagram: what acts on a body. By action its values are the point, the force and the torque.
#[derive(Clone, Debug)]
pub struct Diagram {
    /// The body.
    pub body: String,
    /// Name of each action, and what of the declaration it is.
    pub actions: Vec<(String, Origin)>,
    /// What has to be released: joints, then places of bodies and particles, in the order of the declaration.
    pub released: Vec<usize>,
}

/// Where an action of a free-body diagram comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Uniform gravity.
    Gravity,
    /// A force element.
    Element,
    /// An input.
    Input,
    /// A joint.
    Joint,
    /// A constraint.
    Constraint,
    /// A contact that opens and closes.
    Contact,
}

/// What a value depends on beside the configuration and time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Uses {
    /// Velocities.
    pub velocities: bool,
    /// Accelerations.
    pub accelerations: bool,
    /// Inputs.
    pub inputs: bool,
}

impl<'g> Model<'g> {
    /// The configuration space.
    pub fn space(&self) -> Space<'_, 'g> {
        Space { graph: self.graph, charts: &self.charts, speeds: self.speeds.as_deref() }
    }

    /// Number of entries of `q`.
    pub fn nq(&self) -> usize {
        self.configuration.len()
    }

    /// Number of entries of `v`.
    pub fn nv(&self) -> usize {
        self.velocities.len()
    }

    /// The places of a coordinate that is to come after those that are there, and of its rate.
    pub fn next_coordinate(&self) -> (InQ, InV) {
        (InQ(self.nq()), InV(self.nv()))
    }

    /// Number of entries of `u`.
    pub fn nu(&self) -> usize {
        self.inputs.len()
    }

    /// The bounds of all limits, in their order.
    pub fn limit_values(&self) -> Vec<Expr<'g>> {
        self.limits.iter().flat_map(|limit| limit.bounds()).flatten().collect()
    }

    /// The numbers of the drawing, piece by piece.
    pub fn drawing_numbers(&self) -> Vec<Expr<'g>> {
        self.drawing.iter().flat_map(|piece| &piece.numbers).copied().collect()
    }

    /// The rates of all contacts, each with its normal one first.
    pub fn contact_rates(&self) -> Vec<Expr<'g>> {
        self.contacts.iter().flat_map(|contact| &contact.rates).copied().collect()
    }

    /// The figures of all requirements, in their order.
    pub fn figures(&self) -> Vec<Expr<'g>> {
        self.requirements.iter().flat_map(|requirement| &requirement.values).copied().collect()
    }

    /// Number of constraints on configurations.
    pub fn holonomic(&self) -> usize {
        self.constraints.iter().filter(|c| c.residual.is_some()).count()
    }

    /// Whether some constraints follow from others wherever all are fulfilled, though no elimination could tell which: as
    /// in Bricard's linkage.
    pub fn is_overdetermined(&self) -> bool {
        let plain = self.constraints.iter().all(|c| c.friction.is_empty() && !c.determines);
        plain && self.constraints.len() + self.freedom.velocities > self.nv()
    }
}
