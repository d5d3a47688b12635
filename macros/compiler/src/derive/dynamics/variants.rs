//! The algorithms of dynamics on variants of a model that have the same frames.

use crate::derive::limb_lanes;
use crate::derive::specialisation::{Candidate, ParameterSpecialisation};
use crate::expr::Expr;
use crate::kinematics::Joint;
use crate::lower::Program;
use crate::mechanics::derivatives::MatrixFactorisation;
use crate::mechanics::passive::passive_forces;
use crate::mechanics::speeds::{ResultKind, SpeedTransformation};
use crate::mechanics::{self, aba, added_mass, constraints, crba, friction, ldl, massless, rnea};
use crate::mechanism::Model;
use crate::passes::{ModelVariant, PassSelection};
use crate::vectorise::{self, VectorisedMechanism};
use std::rc::Rc;

/// Variants of a model that have the same link frames.
pub struct ModelVariants<'g> {
    all: Vec<ModelVariant<'g>>,
    pub joints: Vec<Joint<'g>>,
    specialisation: ParameterSpecialisation,
    /// Generalized speeds of the results; `None` if the results are in joint velocities.
    speeds: Option<Rc<SpeedTransformation<'g>>>,
    /// Variants with identical limbs in SIMD lanes, each with whether it serves inverse dynamics only. Empty
    /// if there are no identical limbs.
    limbs: Vec<(VectorisedMechanism<'g>, bool)>,
    pub bias: CheapestBias,
}

/// The bias `h`, and the variant in which it is cheapest. All variants have the same generalized forces, so
/// each term of a function can come from the variant in which that term is cheapest.
#[derive(Default)]
pub struct CheapestBias {
    pub program: Program,
    variant: usize,
    /// Program with identical limbs in SIMD lanes, with the index of its variant; `None` without such limbs.
    pub simd: Option<(usize, Program)>,
}

impl<'g> ModelVariants<'g> {
    pub fn new(
        all: Vec<ModelVariant<'g>>,
        passes: PassSelection,
        specialisation: ParameterSpecialisation,
        speeds: Option<Rc<SpeedTransformation<'g>>>,
    ) -> ModelVariants<'g> {
        // All variants have the same joints.
        let joints = match all.as_slice() {
            [any, ..] => any.joints.clone(),
            [] => Vec::new(),
        };
        let groups = match all.as_slice() {
            [any, ..]
                if passes.lanes && specialisation == ParameterSpecialisation::None && speeds.is_none() =>
            {
                vectorise::find_limb_groups(&any.model, &joints)
            }
            _ => Vec::new(),
        };
        let vectorised_mechanism_of_variant = |variant: &ModelVariant<'g>| {
            let passive_forces_of_variant = || passive_forces(&variant.model, true);
            Some((
                VectorisedMechanism::new(&variant.model, &joints, &groups, passive_forces_of_variant)?,
                variant.for_inverse_dynamics,
            ))
        };
        let limbs = all.iter().filter_map(vectorised_mechanism_of_variant).collect();
        ModelVariants { all, joints, specialisation, speeds, limbs, bias: CheapestBias::default() }
    }

    pub fn store_cheapest_bias_program(&mut self) {
        let (variant, program) =
            self.specialisation.cheapest_program_with_index(self.inverse_dynamics_candidates(false));
        let simd = self
            .inverse_dynamics_in_limb_lanes(false)
            .map(|list| self.specialisation.candidate_with_size(list));
        let simd = self
            .specialisation
            .candidate_programs(simd)
            .into_iter()
            .min_by_key(|(_, program)| program.estimated_cost());
        self.bias = CheapestBias { program, variant, simd };
    }

    /// Returns the variants of the model that serve all functions.
    pub fn variants_for_all_functions(&self) -> impl Iterator<Item = &Model<'g>> {
        self.all.iter().filter(|variant| !variant.for_inverse_dynamics).map(|variant| &variant.model)
    }

    /// Returns the variants with identical limbs in SIMD lanes, except variants that serve inverse dynamics
    /// only.
    pub fn vectorised_mechanisms_for_all_functions(&self) -> impl Iterator<Item = &VectorisedMechanism<'g>> {
        self.limbs.iter().filter(|(_, for_inverse_dynamics)| !for_inverse_dynamics).map(|(limbs, _)| limbs)
    }

    /// Returns the outputs of a function for each variant of the model.
    pub fn candidate_outputs(
        &self,
        role: ResultKind,
        outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>,
    ) -> impl Iterator<Item = Candidate<'g>> {
        self.variants_for_all_functions().map(outputs).map(move |list| self.candidate_in_speeds(role, list))
    }

    /// Returns outputs as a candidate, transformed to generalized speeds if there are any.
    fn candidate_in_speeds(&self, role: ResultKind, list: Vec<Expr<'g>>) -> Candidate<'g> {
        match &self.speeds {
            None => self.specialisation.candidate_with_size(list),
            Some(speeds) => {
                self.specialisation.candidate_with_size(speeds.results_in_generalized_speeds(role, &list))
            }
        }
    }

    /// Returns the program of the variant in which the function takes the fewest operations.
    pub fn cheapest_program(
        &self,
        role: ResultKind,
        outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>,
    ) -> Program {
        self.specialisation.cheapest_program(self.candidate_outputs(role, outputs))
    }

    /// Returns the program of the variant with the smallest outputs. This is faster than
    /// [`cheapest_program`](Self::cheapest_program), since only one program is lowered.
    pub fn smallest_program(
        &self,
        role: ResultKind,
        outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>,
    ) -> Program {
        let smallest = self.candidate_outputs(role, outputs).min_by_key(|list| list.size);
        smallest.map_or_else(Program::default, |list| self.specialisation.lower_to_program(&list.outputs))
    }

    pub fn mass_matrix_candidates(&self) -> impl Iterator<Item = Candidate<'g>> {
        self.candidate_outputs(ResultKind::Metric, |model| crba::mass_matrix(model, &self.joints).concat())
    }

    /// Returns inverse dynamics, or the bias if `accelerations` is false.
    pub fn inverse_dynamics_candidates(&self, accelerations: bool) -> impl Iterator<Item = Candidate<'g>> {
        self.all.iter().map(move |variant| {
            let (v, a) = (
                mechanics::velocity_symbols(&variant.model),
                mechanics::acceleration_symbols(&variant.model),
            );
            let Some(speeds) = &self.speeds else {
                let a = accelerations.then_some(a.as_slice());
                return self.specialisation.candidate_with_size(rnea::inverse_dynamics(
                    &variant.model,
                    &self.joints,
                    &v,
                    a,
                ));
            };
            // At zero rates of the speeds, joint accelerations may be different from zero.
            let all = rnea::inverse_dynamics(&variant.model, &self.joints, &v, Some(&a));
            let all = speeds.results_in_generalized_speeds(ResultKind::Forces, &all);
            self.specialisation.candidate_with_size(if accelerations {
                all
            } else {
                speeds.without_accelerations(&all)
            })
        })
    }

    pub fn inverse_dynamics_in_limb_lanes(&self, accelerations: bool) -> impl Iterator<Item = Vec<Expr<'g>>> {
        self.limbs.iter().map(move |(limbs, _)| limb_lanes::inverse_dynamics(limbs, accelerations))
    }

    /// Returns the outputs of forward dynamics by the articulated-body algorithm.
    pub fn articulated_forward_dynamics_candidates(&self) -> Vec<Candidate<'g>> {
        let Some(bias) = self.all.get(self.bias.variant).map(|variant| &variant.model) else {
            return Vec::new();
        };
        let v = mechanics::velocity_symbols(bias);
        let wrenches = rnea::link_wrenches(bias, &self.joints, &v, None);
        let tau = mechanics::generalized_force_symbols(bias);
        let all = self.variants_for_all_functions().filter_map(|model| {
            let list = aba::forward_dynamics(model, &self.joints, wrenches.clone(), &tau)?;
            Some(self.candidate_in_speeds(ResultKind::Accelerations(0), list))
        });
        all.collect()
    }

    /// Returns forward dynamics by articulated bodies, with identical limbs in SIMD lanes.
    pub fn articulated_dynamics_in_lanes(&self) -> Vec<Vec<Expr<'g>>> {
        let bias = self.bias.simd.as_ref().and_then(|(k, _)| self.limbs.get(*k));
        let Some((bias, _)) = bias else { return Vec::new() };
        self.vectorised_mechanisms_for_all_functions()
            .filter_map(|limbs| limb_lanes::forward_dynamics(limbs, bias))
            .collect()
    }

    /// Returns forward dynamics by factorisation of the mass matrix.
    pub fn factorised_forward_dynamics_candidates(&self) -> Vec<Candidate<'g>> {
        let r = self.unbalanced_forces();
        let solve_for_accelerations = |model: &Model<'g>| {
            let mass = crba::mass_matrix(model, &self.joints);
            match model.acceleration_forces.is_empty() {
                true => ldl::solve_symmetric(mass, r.clone(), &self.joints),
                false => {
                    MatrixFactorisation::new(&added_mass::effective_mass_matrix(model, &mass), &self.joints)
                        .solve_factored(r.clone())
                }
            }
        };
        self.candidate_outputs(ResultKind::Accelerations(0), solve_for_accelerations).collect()
    }

    /// Returns the forces that accelerate the mechanism, `τ − h`.
    fn unbalanced_forces(&self) -> Vec<Expr<'g>> {
        let Some(bias) = self.all.get(self.bias.variant).map(|variant| &variant.model) else {
            return Vec::new();
        };
        let h = rnea::inverse_dynamics(bias, &self.joints, &mechanics::velocity_symbols(bias), None);
        mechanics::generalized_force_symbols(bias).iter().zip(h).map(|(tau, h)| *tau - h).collect()
    }
}

/// Returns the number of multipliers whose individual accelerations are outputs.
fn multiplier_acceleration_column_count(model: &Model<'_>) -> usize {
    if model.has_unpruned_redundancy() { model.constraints.len() } else { 0 }
}

impl<'g> ModelVariants<'g> {
    /// Returns accelerations and multipliers under the forces `tau`.
    pub fn constrained_dynamics(&self) -> Program {
        let [variant, ..] = self.all.as_slice() else { return Program::default() };
        let (force, biases) = (self.unbalanced_forces(), constraints::constraint_biases(&variant.model));
        if !friction::sliding_contact_constraints(&variant.model).is_empty() {
            return self.friction_solution_program(ResultKind::Accelerations(0), &force, &biases);
        }
        let Some(pivots) = &variant.model.dependent else {
            let answers = multiplier_acceleration_column_count(&variant.model);
            return self.multiplier_solution_program(ResultKind::Accelerations(answers), &force, &biases);
        };
        self.cheapest_program(ResultKind::Accelerations(0), |model| {
            let mass = crba::mass_matrix(model, &self.joints);
            constraints::solve_by_independent_velocities(model, &mass, &force, biases.clone(), pivots)
        })
    }

    /// Returns the response of constraints to forces and biases that are arguments.
    pub fn constraint_response(&self) -> Program {
        let [variant, ..] = self.all.as_slice() else { return Program::default() };
        let (force, bias) = constraints::force_and_bias_symbols(&variant.model);
        self.multiplier_solution_program(
            ResultKind::Answers(multiplier_acceleration_column_count(&variant.model)),
            &force,
            &bias,
        )
    }

    /// Returns the response of sliding contacts with friction to forces and biases that are arguments.
    pub fn slipping_response(&self) -> Program {
        let [variant, ..] = self.all.as_slice() else { return Program::default() };
        let (force, bias) = constraints::force_and_bias_symbols(&variant.model);
        self.friction_solution_program(ResultKind::Answers(0), &force, &bias)
    }

    fn multiplier_solution_program(
        &self,
        role: ResultKind,
        force: &[Expr<'g>],
        bias: &[Expr<'g>],
    ) -> Program {
        self.cheapest_program(role, |model| {
            let rows = constraints::jacobian(model);
            if model.has_unpruned_redundancy() {
                let mass = crba::mass_matrix(model, &self.joints);
                return constraints::minimum_norm_terms(&mass, &rows, force.to_vec(), bias, &self.joints);
            }
            let (mass, force) = self.mass_and_forces_with_massless_terms(model, force, bias);
            constraints::solve_constrained_dynamics(&mass, &rows, force, bias.to_vec())
        })
    }

    fn friction_solution_program(&self, role: ResultKind, force: &[Expr<'g>], bias: &[Expr<'g>]) -> Program {
        self.cheapest_program(role, |model| {
            let (mass, force) = self.mass_and_forces_with_massless_terms(model, force, bias);
            friction::solve_with_friction(model, &mass, force, bias.to_vec())
        })
    }

    /// Returns mass matrix and forces with the terms that compensate for coordinates without inertia.
    fn mass_and_forces_with_massless_terms(
        &self,
        model: &Model<'g>,
        force: &[Expr<'g>],
        bias: &[Expr<'g>],
    ) -> (crba::Matrix<'g>, Vec<Expr<'g>>) {
        let mass = crba::mass_matrix(model, &self.joints);
        let force = massless::force_with_weighted_constraints(model, &self.joints, force, bias);
        (massless::mass_with_weighted_constraints(model, &self.joints, mass), force)
    }
}
