//! Columns of the derivatives of forward dynamics that follow from invariance without any product. The motion
//! of a mechanism with a free base, in the axes of the base, depends neither on the position nor on the
//! velocity of the base (Galilean invariance). It depends on the orientation of the base only through the
//! components of uniform gravity. With the linear and angular velocity `v` and `ω` of the base and gravity
//! `g`, all in its axes, all accelerations equal those without gravity, except that of the base,
//! `v̇ = … + g − ω × v`. A rotation `φ` of the base in its axes changes `g` by `g × φ`, so that
//! `∂v̇/∂φ = [g]×` and `∂v̇/∂v = −[ω]×`. The derivatives of all other accelerations are zero.
//!
//! The invariance requires that the links move in the axes of the base as if the ground did not exist. No
//! other term of the equations may change with the orientation, the velocity or the acceleration of the base.
//! Springs, dashpots and inerters attached to the ground violate this, and so do elements placed along ground
//! axes. The condition is checked on the expressions of the equations themselves.

use super::{ForceDerivatives, symbolic};
use crate::expr::diff::DirectionalDerivative;
use crate::expr::{Expr, Mat3, Symbol, Vec3};
use crate::kinematics::{Joint, SpatialVector, symbols_in};
use crate::mechanics::{acceleration_symbols, rnea, velocity_symbols};
use crate::mechanism::{Inertia, Link, Model, Motion, Quantity};

/// Columns of a matrix that invariance determines, each with its index.
type IndexedColumns<'g> = Vec<(usize, Vec<Expr<'g>>)>;

/// Columns of `∂v̇/∂q` and `∂v̇/∂v` that invariance under displacements of a free base determines.
#[derive(Default)]
pub struct InvariantColumns<'g> {
    /// Columns of `∂v̇/∂q` that invariance under displacements determines.
    pub by_q: IndexedColumns<'g>,
    /// Columns of `∂v̇/∂v` that invariance under displacements determines.
    pub by_v: IndexedColumns<'g>,
}

/// Finds the columns of derivatives that invariance under displacements of a free base determines.
pub fn columns_determined_by_invariance<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> InvariantColumns<'g> {
    let mut found = InvariantColumns::default();
    let free_base_of_link = |base: usize| match model.links[base] {
        Link { parent: None, motion: Motion::Free { q, v }, .. } => {
            Some(FreeBase { link: base, q: q.0, v: v.0 })
        }
        _ => None,
    };
    let bases: Vec<FreeBase> = (0..joints.len()).filter_map(free_base_of_link).collect();
    if bases.is_empty() {
        return found;
    }
    let others = TermsWithoutInertialForces::new(model, joints);
    for base in bases.into_iter().filter(|base| {
        base.is_dynamics_independent_of_base(model, joints) && others.has_only_link_inertia(base.v)
    }) {
        let v = base.v;
        let columns_containing_block = |first: usize, block: Mat3<'g>| {
            (0..3).map(move |k| {
                let mut column = vec![model.graph.zero(); model.nv()];
                for (i, entry) in column[v..v + 3].iter_mut().enumerate() {
                    *entry = block.0[i][k];
                }
                (first + k, column)
            })
        };
        if are_zero_columns(&others.forces.by_q, v + 3) {
            let gravity = joints[base.link].rotation.vector_in_child_axes(model.gravity);
            found.by_q.extend(columns_containing_block(v + 3, Mat3::skew(gravity)));
        }
        if are_zero_columns(&others.forces.by_v, v) {
            let w = Vec3([3, 4, 5].map(|k| Quantity::Velocity(v + k).expr(model.graph)));
            found.by_v.extend(columns_containing_block(v, Mat3::skew(-w)));
        }
    }
    found
}

/// A link that moves freely relative to the ground, with the first indices of its coordinates and velocities.
struct FreeBase {
    link: usize,
    q: usize,
    v: usize,
}

impl FreeBase {
    /// Returns whether the masses, gravity and joints of all other links are independent of the pose and the
    /// velocity of the base, whether or not these links are descendants of the base.
    fn is_dynamics_independent_of_base<'g>(&self, model: &Model<'g>, joints: &[Joint<'g>]) -> bool {
        let mut all = model.gravity.0.to_vec();
        for (k, (link, joint)) in model.links.iter().zip(joints).enumerate() {
            let Inertia { mass, moment, tensor } = link.inertia;
            all.push(mass);
            all.extend(moment.0.iter().chain(&tensor.diagonal).chain(&tensor.off));
            if k == self.link {
                continue;
            }
            if joint.dofs.iter().any(|dof| (self.v..self.v + 6).contains(&dof.index)) {
                return false;
            }
            all.extend(joint.rotation.rotation_matrix().0.as_flattened());
            all.extend(joint.translation.0);
            let mut collect_spatial_components =
                |s: &SpatialVector<'g>| all.extend(s.linear.0.iter().chain(&s.angular.0));
            joint.dofs.iter().for_each(|dof| collect_spatial_components(&dof.subspace));
            if let Some(drift) = &joint.drift {
                [&drift.twist, &drift.acceleration]
                    .into_iter()
                    .chain(&drift.subspace_rates)
                    .for_each(collect_spatial_components);
            }
        }
        !symbols_in(&all).into_iter().any(|s| self.is_symbol_of_base(s))
    }

    /// Returns true for a coordinate or a velocity of the base.
    fn is_symbol_of_base(&self, symbol: Symbol) -> bool {
        match Quantity::from_symbol(symbol) {
            Quantity::Configuration(k) => (self.q..self.q + 7).contains(&k),
            Quantity::Velocity(k) => (self.v..self.v + 6).contains(&k),
            _ => false,
        }
    }
}

/// All terms of the equations of motion except the inertial forces of the links.
struct TermsWithoutInertialForces<'g> {
    /// Derivatives of the terms with respect to configuration and velocity.
    forces: ForceDerivatives<'g>,
    /// For each velocity: whether the terms depend on the acceleration of that velocity.
    inertial: Vec<bool>,
}

impl<'g> TermsWithoutInertialForces<'g> {
    /// Derives the equations of motion of the model with massless links.
    fn new(model: &Model<'g>, joints: &[Joint<'g>]) -> TermsWithoutInertialForces<'g> {
        let mut massless = model.clone();
        for link in &mut massless.links {
            link.inertia = Inertia::zero(model.graph);
        }
        let (v, a) = (velocity_symbols(model), acceleration_symbols(model));
        let forces = rnea::inverse_dynamics(&massless, joints, &v, Some(&a));
        let forces_depend_on_acceleration = |k: usize| {
            let mut d =
                DirectionalDerivative::with_respect_to(Quantity::Acceleration(k).symbol(), model.graph);
            forces.iter().any(|force| !d.differentiate(*force).is_zero())
        };
        let inertial = (0..model.nv()).map(forces_depend_on_acceleration).collect();
        TermsWithoutInertialForces {
            forces: symbolic::configuration_and_velocity_derivatives(model, &forces),
            inertial,
        }
    }

    /// Returns true if no inertia except that of the links acts on the linear acceleration of the base whose
    /// velocities begin at `v`.
    fn has_only_link_inertia(&self, v: usize) -> bool {
        !self.inertial[v..v + 3].contains(&true)
    }
}

/// Returns true if the three columns from `first` on are zero.
fn are_zero_columns(of: &[Vec<Expr<'_>>], first: usize) -> bool {
    of.iter().all(|row| row[first..first + 3].iter().all(|e| e.is_zero()))
}

impl<'g> InvariantColumns<'g> {
    /// Replaces the columns of the force derivatives by the known columns of the acceleration derivatives;
    /// the other columns of the acceleration derivatives are computed from the force derivatives.
    pub fn insert_invariant_columns(&self, forces: &mut ForceDerivatives<'g>) {
        for (to, from) in [(&mut forces.by_q, &self.by_q), (&mut forces.by_v, &self.by_v)] {
            for (k, column) in from {
                for (row, entry) in to.iter_mut().zip(column) {
                    row[*k] = *entry;
                }
            }
        }
    }

    /// Returns all known columns, concatenated: columns of `∂v̇/∂q`, then columns of `∂v̇/∂v`.
    pub fn all_invariant_columns(&self) -> Vec<Expr<'g>> {
        self.by_q.iter().chain(&self.by_v).flat_map(|(_, column)| column.iter().copied()).collect()
    }

    /// Returns the indices of the known columns of `∂v̇/∂q` and of `∂v̇/∂v`.
    pub fn invariant_column_indices(&self) -> [Vec<usize>; 2] {
        [&self.by_q, &self.by_v].map(|columns| columns.iter().map(|(k, _)| *k).collect())
    }
}
