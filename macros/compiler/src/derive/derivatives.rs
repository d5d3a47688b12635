//! Derivation of the functions of the option `derivatives`.

use super::output::{BlockLoopDerivatives, Function};
use super::second;
use super::specialisation::ParameterSpecialisation;
use super::{block_loops, limb_lanes};
use crate::catalogue::{InverseForm, MatrixStructure};
use crate::expr::Expr;
use crate::kinematics::{self, Joint};
use crate::lower::{Operand, Program, lower};
use crate::machine::{
    BLOCKED_VELOCITIES, DERIVATIVES_COMPARED, DERIVATIVES_WRITTEN_OUT, INVERSE_WRITTEN_OUT,
};
use crate::mechanics::derivatives::{
    self, BlockInverseMassMatrix, DerivationMethod, ForceDerivatives, LinearizedEquations,
    MatrixFactorisation, TrunkLimbPartition, analytic, invariance, inverse_terms_for_runtime_loops, symbolic,
};
use crate::mechanics::passive::passive_forces;
use crate::mechanics::speeds::displacement_commutators;
use crate::mechanics::{self, added_mass, constraints, crba, forces, momentum, rnea};
use crate::mechanism::{Model, Quantity};
use crate::passes::{self, ModelVariant, PassSelection};
use crate::vectorise::{self, VectorisedMechanism};

/// Maximum number of velocities for which symbolic differentiation is tried as a candidate.
pub(super) const DIFFERENTIATE: usize = 6;

/// Returns the variants of the model among which the cheapest is chosen.
pub(super) fn model_variants<'g>(model: &Model<'g>, passes: PassSelection) -> Vec<ModelVariant<'g>> {
    let mut variants = passes::model_variants(model, passes);
    if passes.frames && model.nv() <= DERIVATIVES_COMPARED {
        variants.extend(passes::model_variants(model, PassSelection { frames: false, ..passes }));
    }
    variants.retain(|variant| !variant.for_inverse_dynamics);
    if model.nv() > DERIVATIVES_COMPARED {
        variants.truncate(1);
    }
    if passes.parallel {
        variants.extend(passes::variants_in_common_axes(&variants));
    }
    variants
}

/// The derivative functions, derived from the variant of the model in which inverse dynamics derivatives cost
/// least.
pub(super) struct DerivativeFunctions<'a, 'g> {
    parts: DerivativeVariant<'a, 'g>,
    /// Generalized forces of the inputs, `τ(q, u)`.
    tau: Vec<Expr<'g>>,
    /// True if the mechanism has constraints, whose multipliers are arguments.
    constrained: bool,
}

impl<'a, 'g> DerivativeFunctions<'a, 'g> {
    pub(super) fn new(
        model: &Model<'g>,
        variants: &'a [ModelVariant<'g>],
        passes: PassSelection,
        specialisation: ParameterSpecialisation,
    ) -> Option<DerivativeFunctions<'a, 'g>> {
        let mut parts: Vec<DerivativeVariant<'_, '_>> =
            variants.iter().map(|variant| DerivativeVariant::new(variant, specialisation)).collect();
        if model.nv() <= DIFFERENTIATE {
            parts.extend(variants.iter().map(|variant| DerivativeVariant {
                method: DerivationMethod::Differentiation,
                ..DerivativeVariant::new(variant, specialisation)
            }));
        }
        let mut parts =
            parts.into_iter().min_by_key(DerivativeVariant::operation_count_of_force_derivatives)?;
        if parts.model.acceleration_forces.is_empty() {
            parts.known = invariance::columns_determined_by_invariance(parts.model, &parts.joints);
        }
        if derivatives::supports_recursive_derivatives(parts.model) {
            parts.wide = passes.tried_lane_counts(model.nv());
            parts.find_limbs_and_trunk(passes.lanes && specialisation == ParameterSpecialisation::None);
        }
        let tau = forces::generalized_forces_of_inputs(model, &kinematics::joints_of_model(model));
        Some(DerivativeFunctions { parts, tau, constrained: !model.constraints.is_empty() })
    }

    /// Returns true if the generated derivatives of forward dynamics call other functions.
    pub(super) fn forward_dynamics_derivatives_call_functions(&self) -> bool {
        !self.constrained && self.parts.exceeds_single_function()
    }

    /// Returns true if the linearization calls other generated functions.
    pub(super) fn linearization_calls_functions(&self) -> bool {
        self.parts.model.nv() > DERIVATIVES_COMPARED && self.parts.model.acceleration_forces.is_empty()
    }

    pub(super) fn mass_matrix_inverse(&self) -> (Program, MatrixStructure) {
        self.parts.inverse_mass_matrix_program(false)
    }

    pub(super) fn accelerations_and_inverse(&self) -> (Program, MatrixStructure) {
        self.parts.inverse_mass_matrix_program(true)
    }

    pub(super) fn coriolis_matrix(&self) -> Program {
        self.parts.coriolis_matrix()
    }

    pub(super) fn inverse_dynamics_derivatives(&self) -> Program {
        self.parts.inverse_dynamics_derivatives_program()
    }

    /// Returns the form of the derivatives of inverse dynamics with loops over blocks of links, if it costs
    /// less than their `program`.
    pub(super) fn cheaper_inverse_dynamics_block_loops(
        &self,
        program: &Program,
    ) -> Option<BlockLoopDerivatives> {
        let DerivativeVariant { model, joints, specialisation, .. } = &self.parts;
        let supported = *specialisation == ParameterSpecialisation::None
            && model.nv() >= BLOCKED_VELOCITIES
            && derivatives::supports_recursive_derivatives(model);
        supported.then(|| block_loops::cheaper_block_loops(model, joints, program)).flatten()
    }

    pub(super) fn momentum_derivatives(&self) -> Program {
        let DerivativeVariant { model, joints, specialisation, .. } = &self.parts;
        let p = momentum::generalized_momentum(model, joints, &mechanics::velocity_symbols(model));
        specialisation.lower_to_program(&entries_by_column(&symbolic::configuration_derivatives(model, &p)))
    }

    pub(super) fn momentum_rate_derivatives(&self) -> Program {
        let DerivativeVariant { model, joints, specialisation, .. } = &self.parts;
        let rate = momentum::momentum_rate_without_inputs(model, joints, &mechanics::velocity_symbols(model));
        specialisation.lower_to_program(&force_derivative_entries(
            &symbolic::configuration_and_velocity_derivatives(model, &rate),
        ))
    }

    /// Returns the derivatives of forward dynamics. `forces` are the derivatives of inverse dynamics, which
    /// determine the entries that are always zero.
    pub(super) fn forward_dynamics_derivatives(
        &self,
        forces: Option<&Function>,
    ) -> (Program, MatrixStructure) {
        let parts = &self.parts;
        let is_zero_constant = |o: &Operand| *o == Operand::Const(0.0);
        let zeros =
            forces.map_or_else(Vec::new, |f| f.program.outputs.iter().map(is_zero_constant).collect());
        let (inverse, known) = (parts.form_of_inverse(), parts.known.invariant_column_indices());
        let program = match (self.forward_dynamics_derivatives_call_functions(), &parts.trunk) {
            (true, _) => parts.specialisation.lower_to_program(&parts.known.all_invariant_columns()),
            (false, Some(trunk)) => parts.forward_dynamics_derivatives_by_blocks(trunk),
            (false, None) => parts.forward_dynamics_derivatives_program(),
        };
        (program, MatrixStructure { inverse, zeros, known, ..MatrixStructure::default() })
    }

    pub(super) fn linearization_program(&self) -> Program {
        match self.linearization_calls_functions() {
            true => self.parts.input_force_program(&self.tau),
            false => self.parts.linearization_program(&self.tau),
        }
    }

    pub(super) fn inverse_dynamics_second_derivatives(&self) -> Program {
        let parts = &self.parts;
        second::inverse_dynamics_second_derivatives(
            parts.model,
            &parts.joints,
            parts.wide,
            parts.specialisation,
        )
    }

    pub(super) fn generalized_forces_second_derivatives(&self) -> Program {
        second::input_power_hessian(self.parts.model, &self.tau, self.parts.specialisation)
    }

    pub(super) fn constraint_curvature(&self) -> Program {
        second::constraint_hessian(self.parts.model, self.parts.specialisation)
    }

    pub(super) fn constrained_motion_derivative_terms(&self) -> Program {
        self.parts.constrained_motion_derivative_terms()
    }

    pub(super) fn input_derivatives(&self) -> Program {
        self.parts.input_program_without_commutators(&self.tau)
    }
}

/// A variant of the model with the data that all derivative functions share.
struct DerivativeVariant<'a, 'g> {
    model: &'a Model<'g>,
    joints: Vec<Joint<'g>>,
    mass: crba::Matrix<'g>,
    /// Effective mass matrix: the mass matrix minus the coefficients of the forces that are linear in
    /// accelerations.
    effective: crba::Matrix<'g>,
    method: DerivationMethod,
    specialisation: ParameterSpecialisation,
    /// Trunk of a large mechanism, if its tree branches.
    trunk: Option<TrunkLimbPartition>,
    /// Variant of the mechanism with identical limbs in SIMD lanes.
    limbs: Option<MechanismInLanes<'g>>,
    /// Numbers of SIMD lanes that are tried for the recursion towards the root, in addition to scalar code.
    wide: &'static [usize],
    /// Columns of the derivatives of forward dynamics that follow from invariance.
    known: invariance::InvariantColumns<'g>,
}

/// A mechanism with identical limbs in SIMD lanes.
struct MechanismInLanes<'g> {
    limbs: VectorisedMechanism<'g>,
    mass: crba::Matrix<'g>,
    trunk: Option<TrunkLimbPartition>,
}

impl<'a, 'g> DerivativeVariant<'a, 'g> {
    fn new(
        variant: &'a ModelVariant<'g>,
        specialisation: ParameterSpecialisation,
    ) -> DerivativeVariant<'a, 'g> {
        let mass = crba::mass_matrix(&variant.model, &variant.joints);
        DerivativeVariant {
            model: &variant.model,
            joints: variant.joints.clone(),
            effective: added_mass::effective_mass_matrix(&variant.model, &mass),
            mass,
            method: DerivationMethod::Recursion(1),
            specialisation,
            trunk: None,
            limbs: None,
            wide: &[],
            known: invariance::InvariantColumns::default(),
        }
    }

    /// Finds groups of identical limbs, and the trunk that carries all limbs.
    fn find_limbs_and_trunk(&mut self, lanes: bool) {
        let groups = if lanes { vectorise::find_limb_groups(self.model, &self.joints) } else { Vec::new() };
        let limbs =
            VectorisedMechanism::new(self.model, &self.joints, &groups, || passive_forces(self.model, true));
        let marked = limbs
            .as_ref()
            .map(|limbs| TrunkLimbPartition::branching_descendant_flags(&limbs.joints, limbs.model.nv()));
        if self.model.nv() > DERIVATIVES_COMPARED {
            let whole = match (&limbs, &marked) {
                (Some(limbs), Some(marked)) => limbs.marked_velocities_outside_limbs(marked),
                _ => TrunkLimbPartition::branching_descendant_flags(&self.joints, self.model.nv()),
            };
            self.trunk = TrunkLimbPartition::new(&self.joints, &self.mass, &whole);
        }
        self.limbs = limbs.zip(marked).map(|(limbs, marked)| {
            let mass = crba::mass_matrix(&limbs.model, &limbs.joints);
            let trunk =
                self.trunk.as_ref().and_then(|_| TrunkLimbPartition::new(&limbs.joints, &mass, &marked));
            MechanismInLanes { limbs, mass, trunk }
        });
    }

    fn operation_count_of_force_derivatives(&self) -> usize {
        self.specialisation
            .lower_to_program(&self.force_derivative_entries(self.method))
            .counts
            .total_operations()
    }

    fn force_derivative_entries(&self, method: DerivationMethod) -> Vec<Expr<'g>> {
        let a = mechanics::acceleration_symbols(self.model);
        force_derivative_entries(&derivatives::inverse_dynamics(self.model, &self.joints, &a, method))
    }

    fn inverse_dynamics_derivatives_program(&self) -> Program {
        let program = self.specialisation.lower_to_program(&self.force_derivative_entries(self.method));
        let wide = self.wide.iter().map(|most| {
            self.specialisation
                .lower_to_program(&self.force_derivative_entries(DerivationMethod::Recursion(*most)))
        });
        let in_lanes = self.limbs.iter().flat_map(|lanes| {
            let a = lanes.limbs.lane_symbols_per_velocity(Quantity::Acceleration);
            [1].iter().chain(self.wide).map(move |most| {
                let forces = limb_lanes::inverse_dynamics_derivatives(&lanes.limbs, self.model, &a, *most);
                lower(&force_derivative_entries(&forces))
            })
        });
        program.with_cheapest_lane_variant(wide.chain(in_lanes))
    }

    fn forward_dynamics_derivatives_program(&self) -> Program {
        let tau = mechanics::generalized_force_symbols(self.model);
        let derivative_program_from_mass_matrix = |mass: &crba::Matrix<'g>, method: DerivationMethod| {
            let mut found =
                derivatives::linearize_forward_dynamics(self.model, &self.joints, mass, &tau, method);
            self.known.insert_invariant_columns(&mut found.forces);
            self.specialisation
                .lower_to_program(&[linearization_entries_by_column(&found), found.accelerations].concat())
        };
        let wide = self.wide.iter().map(|most| {
            let mass = crba::mass_matrix_in_lanes(self.model, &self.joints, *most);
            derivative_program_from_mass_matrix(&mass, DerivationMethod::Recursion(*most))
        });
        derivative_program_from_mass_matrix(&self.effective, self.method).with_cheapest_lane_variant(wide)
    }

    /// Returns the derivatives of forward dynamics with `M⁻¹` by the blocks of trunk and limbs.
    fn forward_dynamics_derivatives_by_blocks(&self, trunk: &TrunkLimbPartition) -> Program {
        let model = self.model;
        let inverse = BlockInverseMassMatrix::new(&self.mass, trunk);
        let a = inverse.solve_by_trunk_and_limbs(&self.unbalanced_forces());
        let forces = derivatives::inverse_dynamics(model, &self.joints, &a, self.method);
        let concatenated_derivative_outputs =
            |mut forces: ForceDerivatives<'g>,
             [inverse, factors]: [crba::Matrix<'g>; 2],
             a: Vec<Expr<'g>>| {
                self.known.insert_invariant_columns(&mut forces);
                [force_derivative_entries(&forces), entries_by_column(&inverse), factors.concat(), a].concat()
            };
        let program = self.specialisation.lower_to_program(&concatenated_derivative_outputs(
            forces,
            [inverse.trunk_and_limb_inverse_columns(), inverse.limb_to_trunk_factors()],
            a,
        ));
        let in_lanes = self.limbs.as_ref().and_then(|lanes| {
            let inverse = BlockInverseMassMatrix::new(&lanes.mass, lanes.trunk.as_ref()?);
            let a = limb_lanes::accelerations_in_lanes(&lanes.limbs, &inverse);
            let parts = limb_lanes::scatter_inverse_to_whole_mechanism(
                &lanes.limbs,
                &[inverse.trunk_and_limb_inverse_columns(), inverse.limb_to_trunk_factors()],
            );
            Some([1].iter().chain(self.wide).map(move |most| {
                let forces = limb_lanes::inverse_dynamics_derivatives(&lanes.limbs, model, &a, *most);
                lower(&concatenated_derivative_outputs(
                    forces,
                    parts.clone(),
                    lanes.limbs.scatter_to_velocities(&a),
                ))
            }))
        });
        program.with_cheapest_lane_variant(in_lanes.into_iter().flatten())
    }

    /// Returns the program of `M⁻¹`, by blocks if there is a trunk; after the accelerations if `accelerated`.
    fn straight_line_mass_inverse_program(&self, accelerated: bool) -> Program {
        let inverse_matrix_outputs = |a: Option<Vec<Expr<'g>>>, [inverse, factors]: [crba::Matrix<'g>; 2]| {
            [a.unwrap_or_default(), entries_by_column(&inverse), factors.concat()].concat()
        };
        let Some(trunk) = &self.trunk else {
            let mass = if accelerated { &self.effective } else { &self.mass };
            let factor = MatrixFactorisation::new(mass, &self.joints);
            let a = accelerated.then(|| factor.solve_factored(self.unbalanced_forces()));
            return self
                .specialisation
                .lower_to_program(&inverse_matrix_outputs(a, [factor.inverse(), Vec::new()]));
        };
        let inverse = BlockInverseMassMatrix::new(&self.mass, trunk);
        let a = accelerated.then(|| inverse.solve_by_trunk_and_limbs(&self.unbalanced_forces()));
        let program = self.specialisation.lower_to_program(&inverse_matrix_outputs(
            a,
            [inverse.trunk_and_limb_inverse_columns(), inverse.limb_to_trunk_factors()],
        ));
        program.with_cheapest_lane_variant(self.limbs.iter().filter_map(|lanes| {
            let inverse = BlockInverseMassMatrix::new(&lanes.mass, lanes.trunk.as_ref()?);
            let a = accelerated.then(|| {
                lanes.limbs.scatter_to_velocities(&limb_lanes::accelerations_in_lanes(&lanes.limbs, &inverse))
            });
            let parts = limb_lanes::scatter_inverse_to_whole_mechanism(
                &lanes.limbs,
                &[inverse.trunk_and_limb_inverse_columns(), inverse.limb_to_trunk_factors()],
            );
            Some(lower(&inverse_matrix_outputs(a, parts)))
        }))
    }

    /// Returns the program of the terms from which loops of the runtime compute `M⁻¹`. If `accelerated` is
    /// true, `τ − h` follows these terms, from which the loops compute the accelerations.
    fn inverse_terms_program(&self, accelerated: bool) -> Program {
        let bordered_inverse_outputs =
            |r: Option<Vec<Expr<'g>>>, [inverse, borders]: [crba::Matrix<'g>; 2]| {
                [r.unwrap_or_default(), entries_by_column(&inverse), borders.concat()].concat()
            };
        let r = accelerated.then(|| self.unbalanced_forces());
        let trunk = self.trunk_or_whole_mechanism();
        let inverse_terms_program_from_mass = |mass: &crba::Matrix<'g>| {
            let outputs = bordered_inverse_outputs(r.clone(), inverse_terms_for_runtime_loops(mass, &trunk));
            self.specialisation.lower_to_program(&outputs)
        };
        // Columns of the mass matrix in lanes pay for chains: the inverse of 32 rows takes 1650 ns instead of
        // 2270. For a humanoid they made no difference.
        let tried = if self.trunk.is_none() { self.wide } else { &[] };
        let wide = tried.iter().map(|most| {
            inverse_terms_program_from_mass(&crba::mass_matrix_in_lanes(self.model, &self.joints, *most))
        });
        let in_lanes = self.limbs.iter().filter_map(|lanes| {
            let parts = inverse_terms_for_runtime_loops(&lanes.mass, lanes.trunk.as_ref()?);
            let r = accelerated
                .then(|| lanes.limbs.scatter_to_velocities(&limb_lanes::unbalanced_forces(&lanes.limbs)));
            Some(lower(&bordered_inverse_outputs(
                r,
                limb_lanes::scatter_inverse_to_whole_mechanism(&lanes.limbs, &parts),
            )))
        });
        inverse_terms_program_from_mass(&self.mass).with_cheapest_lane_variant(wide.chain(in_lanes))
    }

    /// Returns true if runtime loops compute `M⁻¹` instead of straight-line code. With identical limbs in
    /// SIMD lanes, the size of the trunk decides, since straight-line code computes the limbs in lanes as
    /// well.
    fn inverts_in_runtime_loops(&self) -> bool {
        let in_lanes = self.limbs.as_ref().is_some_and(|lanes| lanes.trunk.is_some());
        self.exceeds_single_function()
            && match &self.trunk {
                Some(trunk) => !in_lanes || trunk.velocities.len() > INVERSE_WRITTEN_OUT,
                None => self.model.nv() > INVERSE_WRITTEN_OUT,
            }
    }

    /// Returns the trunk, or a trunk of all velocities for a mechanism that does not branch.
    fn trunk_or_whole_mechanism(&self) -> TrunkLimbPartition {
        self.trunk
            .clone()
            .unwrap_or_else(|| TrunkLimbPartition::partition_with_trunk_only(&self.joints, self.model.nv()))
    }

    /// Returns the forces that accelerate the mechanism, `τ − h`.
    fn unbalanced_forces(&self) -> Vec<Expr<'g>> {
        let (model, v) = (self.model, mechanics::velocity_symbols(self.model));
        let bias = rnea::inverse_dynamics(model, &self.joints, &v, None);
        mechanics::generalized_force_symbols(model).into_iter().zip(bias).map(|(tau, h)| tau - h).collect()
    }

    /// Returns true if a single function for all derivatives of forward dynamics would be too large.
    fn exceeds_single_function(&self) -> bool {
        let most = if self.trunk.is_some() { DERIVATIVES_WRITTEN_OUT } else { DERIVATIVES_COMPARED };
        self.model.nv() > most && self.model.acceleration_forces.is_empty()
    }

    fn linearization_program(&self, tau: &[Expr<'g>]) -> Program {
        let linear =
            derivatives::linearize_equations(self.model, &self.joints, &self.effective, tau, self.method);
        let mut outputs = linearization_entries_by_column(&linear);
        outputs.extend(entries_by_column(&displacement_commutators(self.model)));
        self.specialisation.lower_to_program(&outputs)
    }

    /// Returns the program of the input forces `tau` with their derivatives and the commutators of
    /// displacements.
    fn input_force_program(&self, tau: &[Expr<'g>]) -> Program {
        let mut outputs = tau.to_vec();
        outputs.extend(force_derivative_entries(&symbolic::configuration_and_velocity_derivatives(
            self.model, tau,
        )));
        outputs.extend(entries_by_column(&symbolic::input_derivatives_of_expressions(self.model, tau)));
        outputs.extend(entries_by_column(&displacement_commutators(self.model)));
        self.specialisation.lower_to_program(&outputs)
    }

    /// Returns the program of the input forces `tau` with their derivatives, without the commutators of
    /// displacements.
    fn input_program_without_commutators(&self, tau: &[Expr<'g>]) -> Program {
        let mut outputs = tau.to_vec();
        outputs.extend(force_derivative_entries(&symbolic::configuration_and_velocity_derivatives(
            self.model, tau,
        )));
        outputs.extend(entries_by_column(&symbolic::input_derivatives_of_expressions(self.model, tau)));
        self.specialisation.lower_to_program(&outputs)
    }

    /// Returns, at constant accelerations and multipliers, the program of the derivatives of
    /// `M a + h − Jᵀ λ`, of `J a + b` and of the constraint velocities, followed by the commutators of
    /// displacements.
    fn constrained_motion_derivative_terms(&self) -> Program {
        let model = self.model;
        let a = mechanics::acceleration_symbols(model);
        let mut forces = derivatives::inverse_dynamics(model, &self.joints, &a, self.method);
        let parts = constraints::constraint_first_derivatives(model, &a);
        derivatives::subtract_matrix(&mut forces.by_q, &parts.forces.by_q);
        derivatives::subtract_matrix(&mut forces.by_v, &parts.forces.by_v);
        let mut outputs = force_derivative_entries(&forces);
        outputs.extend(force_derivative_entries(&parts.accelerations));
        outputs.extend(entries_by_column(&parts.rates));
        outputs.extend(entries_by_column(&displacement_commutators(model)));
        self.specialisation.lower_to_program(&outputs)
    }

    fn coriolis_matrix(&self) -> Program {
        let v = mechanics::velocity_symbols(self.model);
        let coriolis_program = |most: usize| {
            let matrix = analytic::coriolis_matrix(self.model, &self.joints, &v, most);
            self.specialisation.lower_to_program(&entries_by_column(&matrix))
        };
        let wide = self.wide.iter().map(|most| coriolis_program(*most));
        let in_lanes = self.limbs.iter().flat_map(|lanes| {
            let most = [1].iter().chain(self.wide);
            most.map(|most| lower(&entries_by_column(&limb_lanes::coriolis_matrix(&lanes.limbs, *most))))
        });
        coriolis_program(1).with_cheapest_lane_variant(wide.chain(in_lanes))
    }

    /// Returns the program of `M⁻¹` and the form of its outputs; after the accelerations if `accelerated`.
    fn inverse_mass_matrix_program(&self, accelerated: bool) -> (Program, MatrixStructure) {
        let (program, inverse) = match self.inverts_in_runtime_loops() {
            true => {
                let trunk = self.trunk_or_whole_mechanism();
                let parted = InverseForm::BlockArrow {
                    trunk: trunk.velocities.clone(),
                    limbs: trunk.velocity_indices_of_limbs(),
                };
                (self.inverse_terms_program(accelerated), parted)
            }
            false => (self.straight_line_mass_inverse_program(accelerated), self.form_of_inverse()),
        };
        (program, MatrixStructure { inverse, ..MatrixStructure::default() })
    }

    /// Returns the form of the inverse that straight-line code computes.
    fn form_of_inverse(&self) -> InverseForm {
        self.trunk
            .as_ref()
            .map_or(InverseForm::Explicit, |trunk| InverseForm::LowRankUpdate(trunk.velocities.clone()))
    }
}

/// Returns the entries of a matrix as a list, column by column.
pub(super) fn entries_by_column<'g>(m: &crba::Matrix<'g>) -> Vec<Expr<'g>> {
    let [any, ..] = m.as_slice() else { return Vec::new() };
    (0..any.len()).flat_map(|j| m.iter().map(move |row| row[j])).collect()
}

fn force_derivative_entries<'g>(d: &ForceDerivatives<'g>) -> Vec<Expr<'g>> {
    [&d.by_q, &d.by_v].into_iter().flat_map(entries_by_column).collect()
}

fn linearization_entries_by_column<'g>(l: &LinearizedEquations<'g>) -> Vec<Expr<'g>> {
    let mut all = force_derivative_entries(&l.forces);
    all.extend(entries_by_column(&l.inverse));
    all.extend(entries_by_column(&l.by_u));
    all
}
