//! Model of a whole mechanism, which all later stages read.

use super::constraint::{ClosedFormJoint, Constraint, ConstraintPivot, DegreeOfFreedomCounts};
use super::contact::Contact;
use super::drawing::Piece;
use super::element::{AccelerationForce, CoulombFriction, Dashpot, Inertance, InputEffect, Load, Spring};
use super::equilibrium::Equilibrium;
use super::gradients::DerivativeCache;
use super::inertia::Inertia;
use super::limit::CoordinateLimits;
use super::link::{ConfigurationSpace, Link, NamedFrame};
use super::motion::Chart;
use super::passive::PassiveForces;
use super::polytope::PolytopePair;
use super::requirement::Requirement;
use super::speeds::Speeds;
use super::units::Units;
use crate::diag::Place;
use crate::expr::{Expr, Graph, Vec3};
use std::rc::Rc;

/// Mechanism that has been resolved and checked.
#[derive(Clone)]
pub struct Model<'g> {
    /// Graph that owns all expressions of the model.
    pub graph: &'g Graph,
    /// Name of the mechanism's struct.
    pub name: String,
    /// Source position of the struct's name.
    pub place: Place,
    /// Names of the mechanism's parameters.
    pub parameters: Vec<String>,
    /// True if the user requested a mechanism without dynamics, which needs no inertia.
    pub kinematic: bool,
    /// Gravitational acceleration, uniform, in ground axes.
    pub gravity: Vec3<'g>,
    /// Velocity that scales the regularisation of dry friction.
    pub friction_speed: Expr<'g>,
    /// Links of the mechanism, parents before children.
    pub links: Vec<Link<'g>>,
    /// Mass properties of bodies that a pass found to be at rest. Such bodies are fixed to the ground but
    /// count as moving mass.
    pub still: Inertia<'g>,
    /// True if an expression of the model depends on time.
    pub time: bool,
    /// True if the effect of the inputs depends on the velocity.
    pub velocity_inputs: bool,
    /// Coordinate charts of the configuration space, in the order of `v`.
    pub charts: Vec<Chart>,
    /// Cache of the generalized forces of elements with energies.
    pub gradients: DerivativeCache,
    /// Name of every entry of `q`.
    pub configuration: Vec<String>,
    /// Configuration in the pose of the robot file, if it differs from the neutral one: its free bodies are
    /// where the file places them.
    pub initial_configuration: Option<Vec<f64>>,
    /// Name of every entry of `v`, with the place of the joint.
    pub velocities: Vec<(String, Place)>,
    /// Generalized speeds that the entries of `v` are, if the user declared any. All other expressions of the
    /// model contain joint velocities.
    pub speeds: Option<Rc<Speeds<'g>>>,
    /// Name and effect of every entry of `u`.
    pub inputs: Vec<(String, InputEffect<'g>)>,
    /// Limits, one for each entry of `v` that has any.
    pub limits: Vec<CoordinateLimits<'g>>,
    /// Equilibria about which linearised equations are printed.
    pub equilibria: Vec<Equilibrium<'g>>,
    /// Unilateral contacts, including stops.
    pub contacts: Vec<Contact<'g>>,
    /// Pairs of polytopes whose features determine contacts, in the order of their features.
    pub polytopes: Vec<PolytopePair<'g>>,
    /// Conditions on values that depend on parameters, which the generated `validate` checks.
    pub requirements: Vec<Requirement<'g>>,
    /// Named frames of the mechanism.
    pub frames: Vec<NamedFrame<'g>>,
    /// Pieces of the drawing, if the option `drawing` requests them.
    pub drawing: Vec<Piece<'g>>,
    /// Heights of the terrains as expressions of two arguments.
    pub heights: Vec<Expr<'g>>,
    /// Linear springs on coordinates.
    pub springs: Vec<Spring<'g>>,
    /// Linear dashpots on coordinates.
    pub dashpots: Vec<Dashpot<'g>>,
    /// Dry friction on coordinates.
    pub frictions: Vec<CoulombFriction<'g>>,
    /// Potential energies other than those of gravity and of springs on coordinates.
    pub potentials: Vec<Expr<'g>>,
    /// Rayleigh dissipation functions.
    pub dissipations: Vec<Expr<'g>>,
    /// Forces other than those of springs, dashpots and friction on coordinates.
    pub loads: Vec<Load<'g>>,
    /// Terms of other forces that are linear in the accelerations.
    pub acceleration_forces: Vec<AccelerationForce<'g>>,
    /// Passive forces of springs, dashpots, friction, potentials and loads, if a separate function computes
    /// them and the other functions call it.
    pub passive: Option<Rc<PassiveForces<'g>>>,
    /// Inertances of inerters.
    pub inertances: Vec<Inertance<'g>>,
    /// Scalar constraints, holonomic ones first.
    pub constraints: Vec<Constraint<'g>>,
    /// Names of rows of joints and constraints that depend on the others in every configuration.
    pub redundant: Vec<String>,
    /// Pivots for elimination of the dependent velocities, in elimination order, if independent velocities
    /// are to be used.
    pub dependent: Option<Vec<ConstraintPivot>>,
    /// Joints for which loops are solved in closed form, two for each loop.
    pub solved: Vec<ClosedFormJoint<'g>>,
    /// Numbers of independent coordinates and velocities of the mechanism.
    pub freedom: DegreeOfFreedomCounts,
    /// Outputs of the mechanism.
    pub outputs: Vec<OutputExpression<'g>>,
    /// Copy of the mechanism in which each joint whose reaction is an output has six degrees of freedom;
    /// these coordinates come last.
    pub released: Option<Rc<ReleasedMechanism<'g>>>,
    /// Units of parameters, coordinates, inputs, outputs and constraints.
    pub units: Units,
}

/// A mechanism with released joints. The forces that fix the released coordinates at zero are the reactions
/// of the joints.
#[derive(Clone)]
pub struct ReleasedMechanism<'g> {
    /// Model of the mechanism in which the joints are released.
    pub model: Model<'g>,
    /// Indices of the released joints, in the order of their coordinates.
    pub joints: Vec<usize>,
}

/// An output expression, which becomes a generated function.
#[derive(Clone, Debug)]
pub struct OutputExpression<'g> {
    /// Name of the output function.
    pub name: String,
    /// Components of the output: one, three or nine; nine for each action of a free-body diagram.
    pub values: Vec<Expr<'g>>,
    /// Free-body diagram that the output values represent, if any.
    pub diagram: Option<FreeBodyDiagram>,
}

/// A free-body diagram: the actions on a body. The values of each action are the point, the force and the
/// torque.
#[derive(Clone, Debug)]
pub struct FreeBodyDiagram {
    /// Name of the body to which the free-body diagram belongs.
    pub body: String,
    /// Name and kind of each action on the body in the diagram.
    pub actions: Vec<(String, ActionOrigin)>,
    /// Indices of the joints to be released: joints, then positions of bodies and particles, in the order of
    /// the declaration.
    pub released: Vec<usize>,
}

/// Kind of an action on a body in a free-body diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionOrigin {
    /// The action is the weight of the body in uniform gravity.
    Gravity,
    /// The action is the force and torque of a force element.
    Element,
    /// The action is the force and torque of an input.
    Input,
    /// The action is the force and torque of a joint on the body.
    Joint,
    /// The action is the force and torque of a constraint.
    Constraint,
    /// The action is the force and torque of a unilateral contact.
    Contact,
}

/// Quantities that a value depends on in addition to the configuration and time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UsedQuantities {
    /// True if the output depends on velocities.
    pub velocities: bool,
    /// True if the output depends on accelerations.
    pub accelerations: bool,
    /// True if the output depends on inputs.
    pub inputs: bool,
}

impl<'g> Model<'g> {
    /// Returns the configuration space of the mechanism.
    pub fn configuration_space(&self) -> ConfigurationSpace<'_, 'g> {
        ConfigurationSpace { graph: self.graph, charts: &self.charts, speeds: self.speeds.as_deref() }
    }

    /// Returns the configuration with zero coordinates and identity quaternions.
    pub fn neutral_configuration(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.nq()];
        for first in self.charts.iter().filter_map(Chart::first_quaternion_index) {
            q[first.0 + 3] = 1.0;
        }
        q
    }

    /// Returns the number of entries of `q`.
    pub fn nq(&self) -> usize {
        self.configuration.len()
    }

    /// Returns the number of entries of `v`.
    pub fn nv(&self) -> usize {
        self.velocities.len()
    }

    /// Returns the number of entries of `u`.
    pub fn nu(&self) -> usize {
        self.inputs.len()
    }

    /// Returns the bounds of all coordinate limits, in their order.
    pub fn coordinate_limit_bounds(&self) -> Vec<Expr<'g>> {
        self.limits.iter().flat_map(|limit| limit.bounds()).flatten().collect()
    }

    /// Returns the geometric values of the drawing, piece by piece.
    pub fn drawing_numbers(&self) -> Vec<Expr<'g>> {
        self.drawing.iter().flat_map(|piece| &piece.numbers).copied().collect()
    }

    /// Returns the contact velocities of all contacts, the normal velocity of each first.
    pub fn contact_rates(&self) -> Vec<Expr<'g>> {
        self.contacts.iter().flat_map(|contact| &contact.rates).copied().collect()
    }

    /// Returns the number of features of all pairs of polytopes.
    pub fn polytope_feature_count(&self) -> usize {
        self.polytopes.iter().map(PolytopePair::feature_count).sum()
    }

    /// Returns the poses of all pairs of polytopes, one after another.
    pub fn polytope_poses(&self) -> Vec<Expr<'g>> {
        self.polytopes.iter().flat_map(|pair| pair.pose).collect()
    }

    /// Returns the values of all requirements on parameters, in their order.
    pub fn requirement_values(&self) -> Vec<Expr<'g>> {
        self.requirements.iter().flat_map(|requirement| &requirement.values).copied().collect()
    }

    /// Returns the number of holonomic constraints.
    pub fn holonomic_count(&self) -> usize {
        self.constraints.iter().filter(|c| c.residual.is_some()).count()
    }

    /// Returns true if constraints depend on others in every admissible configuration although the
    /// elimination did not identify them, as in Bricard's linkage.
    pub fn has_unpruned_redundancy(&self) -> bool {
        let plain = self.constraints.iter().all(|c| c.friction.is_empty() && !c.determines);
        plain && self.constraints.len() + self.freedom.velocities > self.nv()
    }
}
