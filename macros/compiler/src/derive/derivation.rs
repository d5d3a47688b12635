//! Derivation of programs from the functions of the catalogue: the equations of each function, selected by
//! its id.

use super::derivatives::DerivativeFunctions;
use super::dynamics::DynamicsDerivation;
use super::output::{BlockLoopDerivatives, Function};
use super::regressor::IdentificationFunctions;
use super::sensitivities::SensitivityDerivation;
use super::specialisation::ParameterSpecialisation;
use super::{OptionalFunctionData, constraints, outputs};
use crate::catalogue::{DeclaredFunction, Facts, GeneratedId, MatrixStructure};
use crate::expr::{Expr, Graph};
use crate::kinematics::Joint;
use crate::lower::{Program, pipeline};
use crate::mechanics::derivatives::parameters;
use crate::mechanics::hamilton::HamiltonEquations;
use crate::mechanics::limb_contacts::LimbContacts;
use crate::mechanics::routh::RouthEquations;
use crate::mechanics::speeds::SpeedTransformation;
use crate::mechanics::{energy, forces, power};
use crate::mechanism::{Model, PassiveForces};
use crate::passes::PassSelection;
use std::cell::OnceCell;
use std::rc::Rc;

/// The functions of a mechanism. Each function is derived on request; intermediate results that several
/// functions need are derived once.
pub(super) struct Derivation<'a, 'g> {
    /// The model. With declared speeds, the model in which velocities are expressed in these.
    pub(super) model: &'a Model<'g>,
    pub(super) joints: &'a [Joint<'g>],
    speeds: Option<&'a Rc<SpeedTransformation<'g>>>,
    passes: PassSelection,
    specialisation: ParameterSpecialisation,
    facts: &'a Facts,
    /// Data of the optional functions; `None` while only the functions without an option are derived.
    extras: Option<&'a OptionalFunctionData<'a, 'g>>,
    /// Data of the option `derivatives`; `None` without the option.
    derivatives: Option<&'a DerivativeFunctions<'a, 'g>>,
    dynamics: OnceCell<DynamicsDerivation<'g>>,
    sensitivities: OnceCell<SensitivityDerivation<'g>>,
}

impl<'a, 'g> Derivation<'a, 'g> {
    pub(super) fn new(
        model: &'a Model<'g>,
        joints: &'a [Joint<'g>],
        speeds: Option<&'a Rc<SpeedTransformation<'g>>>,
        passes: PassSelection,
        specialisation: ParameterSpecialisation,
        facts: &'a Facts,
    ) -> Derivation<'a, 'g> {
        let (dynamics, sensitivities) = (OnceCell::new(), OnceCell::new());
        let (extras, derivatives) = (None, None);
        Derivation {
            model,
            joints,
            speeds,
            passes,
            specialisation,
            facts,
            extras,
            derivatives,
            dynamics,
            sensitivities,
        }
    }

    /// Adds the data for the functions of several options; results that are already derived are retained.
    pub(super) fn with_option_data<'b>(
        self,
        facts: &'b Facts,
        extras: &'b OptionalFunctionData<'b, 'g>,
        derivatives: Option<&'b DerivativeFunctions<'b, 'g>>,
    ) -> Derivation<'b, 'g>
    where
        'a: 'b,
    {
        Derivation { facts, extras: Some(extras), derivatives, ..self }
    }

    /// Derives the declared functions. The list `done` holds the functions derived before, since some
    /// programs are reused.
    pub(super) fn derive_declared_functions(
        &self,
        declared: Vec<DeclaredFunction>,
        mut done: Vec<Function>,
    ) -> Vec<Function> {
        for declared in declared {
            pipeline::set_observed_function_name(&declared.name);
            let (program, structure) = match self.model.graph.is_full() {
                true => Default::default(),
                false => self.program_of_function(&declared, &done),
            };
            let loops = self.block_loops_of_function(&declared, &program);
            done.push(Function { loops, ..Function::new(declared, program, structure) });
        }
        done
    }

    /// Returns the form of a function with loops over blocks of links, if it has one and it is faster.
    fn block_loops_of_function(
        &self,
        declared: &DeclaredFunction,
        program: &Program,
    ) -> Option<Box<BlockLoopDerivatives>> {
        match declared.id {
            GeneratedId::InverseDynamicsDerivatives | GeneratedId::InverseDynamicsDerivativesInto => {
                self.derivatives?.cheaper_inverse_dynamics_block_loops(program).map(Box::new)
            }
            _ => None,
        }
    }

    fn derived_dynamics(&self) -> &DynamicsDerivation<'g> {
        let native = self.speeds.map_or(self.model, |speeds| &speeds.native);
        self.dynamics
            .get_or_init(|| DynamicsDerivation::new(native, self.passes, self.specialisation, self.speeds))
    }

    fn derived_sensitivities(&self) -> &SensitivityDerivation<'g> {
        self.sensitivities
            .get_or_init(|| SensitivityDerivation::new(self.model, self.passes, self.specialisation))
    }

    /// Returns a function of the option `derivatives`, whose data exist if such a function is declared.
    fn derivative_program(
        &self,
        function: impl FnOnce(&DerivativeFunctions<'a, 'g>) -> Program,
    ) -> (Program, MatrixStructure) {
        self.derivative_assembled_at_run_time(|derivatives| {
            (function(derivatives), MatrixStructure::default())
        })
    }

    /// Returns a function of the option `derivatives` whose results the runtime assembles.
    fn derivative_assembled_at_run_time(
        &self,
        function: impl FnOnce(&DerivativeFunctions<'a, 'g>) -> (Program, MatrixStructure),
    ) -> (Program, MatrixStructure) {
        self.derivatives.map(function).unwrap_or_default()
    }

    fn contact_responses(&self) -> Program {
        let native = self.speeds.map_or(self.model, |speeds| &speeds.native);
        self.derived_dynamics().contact_responses(&constraints::contact_jacobian_rows(native))
    }

    /// Returns the program of a contact function from its values, one for each contact velocity.
    fn contact_program(&self, values: &[Expr<'g>]) -> Program {
        self.with_limb_lane_variant(self.specialisation.lower_to_program(values), |contacts| {
            contacts.merge_contact_values_into_lanes(values)
        })
    }

    fn contact_jacobian(&self) -> Program {
        let rows = constraints::contact_jacobian_rows(self.model);
        let plain = self.specialisation.lower_to_program(&constraints::matrix_by_columns(self.model, &rows));
        self.with_limb_lane_variant(plain, |contacts| {
            Some(constraints::matrix_by_columns(self.model, &contacts.merge_jacobian_rows_into_lanes(&rows)?))
        })
    }

    fn contact_derivatives(&self) -> Program {
        let found = constraints::ContactDerivatives::new(self.model);
        let plain = self.specialisation.lower_to_program(&found.contact_derivative_outputs(self.model));
        self.with_limb_lane_variant(plain, |contacts| {
            found.contact_derivatives_in_lanes(self.model, contacts)
        })
    }

    /// Returns the program of a contact function with the version in which identical limbs are SIMD lanes, if
    /// one exists.
    fn with_limb_lane_variant(
        &self,
        plain: Program,
        outputs: impl FnOnce(&mut LimbContacts<'_, 'g>) -> Option<Vec<Expr<'g>>>,
    ) -> Program {
        match self.facts.kinematic {
            true => plain,
            false => self.derived_dynamics().with_limb_lane_variant(
                plain,
                &constraints::contact_jacobian_rows(self.model),
                outputs,
            ),
        }
    }

    /// Returns the conserved quantities, for the option `conserved`.
    fn conserved_quantities(&self) -> Vec<Expr<'g>> {
        let kept = self.extras.and_then(|extras| extras.conserved.as_ref());
        kept.map_or_else(Vec::new, |kept| kept.iter().map(|c| c.value).collect())
    }

    /// Returns the outputs of a function of the option `regressor`, whose data exist if such a function is
    /// declared.
    pub(super) fn regressor_outputs(
        &self,
        outputs: impl FnOnce(&IdentificationFunctions<'a, 'g>) -> Vec<Expr<'g>>,
    ) -> Vec<Expr<'g>> {
        self.extras.and_then(|extras| extras.identification.as_ref()).map(outputs).unwrap_or_default()
    }

    /// Returns the outputs of a function of the option `hamilton`.
    pub(super) fn hamilton_outputs(
        &self,
        outputs: impl FnOnce(&HamiltonEquations<'g>) -> Vec<Expr<'g>>,
    ) -> Vec<Expr<'g>> {
        self.extras.and_then(|extras| extras.hamilton.as_ref()).map(outputs).unwrap_or_default()
    }

    /// Returns the outputs of a function of the option `routh`.
    fn routh_outputs(&self, outputs: impl FnOnce(&RouthEquations<'g>) -> Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        self.extras.and_then(|extras| extras.routh.as_ref()).map(outputs).unwrap_or_default()
    }

    /// Returns the outputs of a function of the passive forces, if the passive forces have separate
    /// functions.
    fn passive_outputs(&self, outputs: fn(&PassiveForces<'g>) -> Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        self.model.passive.as_deref().map_or_else(Vec::new, outputs)
    }

    /// Lowers the outputs of a function whose matrices have no structure to exploit.
    fn lower_unstructured(&self, outputs: &[Expr<'g>]) -> (Program, MatrixStructure) {
        unstructured_program(self.specialisation.lower_to_program(outputs))
    }

    /// Returns the program of a declared function, with the structure of its matrices. Functions that are
    /// `done` may be used.
    fn program_of_function(
        &self,
        declared: &DeclaredFunction,
        done: &[Function],
    ) -> (Program, MatrixStructure) {
        match self.speeds.and_then(|speeds| self.outputs_in_speeds(speeds, declared)) {
            Some(outputs) => self.lower_unstructured(&outputs),
            None => self.program_in_joint_velocities(declared, done),
        }
    }

    /// Returns the program of a function whose velocities are those of the joints, or that contains none.
    fn program_in_joint_velocities(
        &self,
        declared: &DeclaredFunction,
        done: &[Function],
    ) -> (Program, MatrixStructure) {
        let (model, joints) = (self.model, self.joints);
        let find_derived_function = |id: GeneratedId| done.iter().find(|f| f.id == id);
        match declared.id {
            GeneratedId::Neutral => {
                self.lower_unstructured(&constant_expressions(model.graph, &model.neutral_configuration()))
            }
            GeneratedId::InitialConfiguration => {
                let configuration = model.initial_configuration.as_deref().unwrap_or_default();
                self.lower_unstructured(&constant_expressions(model.graph, configuration))
            }
            GeneratedId::Limits => self.lower_unstructured(&model.coordinate_limit_bounds()),
            GeneratedId::Drawing => self.lower_unstructured(&model.drawing_numbers()),
            GeneratedId::Heights => self.lower_unstructured(&model.heights),
            GeneratedId::Figures => self.lower_unstructured(&model.requirement_values()),
            GeneratedId::GeneralizedForces => {
                self.lower_unstructured(&forces::generalized_forces_of_inputs(model, joints))
            }
            GeneratedId::DissipatedPower => self.lower_unstructured(&[power::dissipated_power(model)]),
            GeneratedId::ControlPower => self.lower_unstructured(&[power::control_power(model, joints)]),
            GeneratedId::DisturbancePower => self.lower_unstructured(&[power::disturbance_power(model)]),
            GeneratedId::TotalMass => self.lower_unstructured(&[energy::mass_and_moment(model, joints).0]),
            GeneratedId::MassMatrix => unstructured_program(self.derived_dynamics().mass_matrix()),
            GeneratedId::InverseDynamics => unstructured_program(self.derived_dynamics().inverse_dynamics()),
            GeneratedId::BiasForces => unstructured_program(self.derived_dynamics().bias_forces()),
            GeneratedId::ForwardDynamics => unstructured_program(self.derived_dynamics().forward_dynamics()),
            GeneratedId::KineticEnergy => unstructured_program(self.derived_dynamics().kinetic_energy()),
            GeneratedId::PotentialEnergy => unstructured_program(self.derived_dynamics().potential_energy()),
            GeneratedId::GeneralizedMomentum => {
                unstructured_program(self.derived_dynamics().generalized_momentum())
            }
            GeneratedId::MomentumRate => unstructured_program(self.derived_dynamics().momentum_rate()),
            GeneratedId::CenterOfMass => unstructured_program(self.derived_dynamics().center_of_mass()),
            GeneratedId::Momentum => unstructured_program(self.derived_dynamics().centroidal_momentum()),
            GeneratedId::CentroidalMomentumMatrix => {
                unstructured_program(self.derived_dynamics().centroidal_momentum_matrix())
            }
            GeneratedId::CentroidalMomentumBias => {
                unstructured_program(self.derived_dynamics().centroidal_momentum_bias())
            }
            GeneratedId::Hamiltonian => {
                self.lower_unstructured(&self.hamilton_outputs(|h| vec![h.hamiltonian]))
            }
            GeneratedId::CanonicalVelocity => {
                self.lower_unstructured(&self.hamilton_outputs(|h| h.velocity.clone()))
            }
            GeneratedId::CanonicalMomentumRate => {
                self.lower_unstructured(&self.hamilton_outputs(|h| h.momentum_rate.clone()))
            }
            GeneratedId::Routhian => self.lower_unstructured(&self.routh_outputs(|r| vec![r.routhian])),
            GeneratedId::CyclicVelocities => {
                self.lower_unstructured(&self.routh_outputs(|r| r.velocity.clone()))
            }
            GeneratedId::ReducedAccelerations => {
                self.lower_unstructured(&self.routh_outputs(|r| r.acceleration.clone()))
            }
            GeneratedId::Conserved => self.lower_unstructured(&self.conserved_quantities()),
            GeneratedId::ConstraintResiduals => self.lower_unstructured(&constraints::residuals(model)),
            GeneratedId::ConstraintRates => {
                self.lower_unstructured(&constraints::constraint_velocities(model))
            }
            GeneratedId::ConstraintJacobian => {
                self.lower_unstructured(&constraints::constraint_jacobian(model))
            }
            GeneratedId::ConstraintBias => self.lower_unstructured(&constraints::constraint_biases(model)),
            GeneratedId::ContactGaps => self.lower_unstructured(&constraints::contact_gaps(model)),
            GeneratedId::ContactRates => unstructured_program(self.contact_program(&model.contact_rates())),
            GeneratedId::ContactJacobian => unstructured_program(self.contact_jacobian()),
            GeneratedId::ContactBias => {
                unstructured_program(self.contact_program(&constraints::contact_biases(model)))
            }
            GeneratedId::PolytopePoses => self.lower_unstructured(&model.polytope_poses()),
            GeneratedId::ContactLaws => self.lower_unstructured(&constraints::contact_coefficients(model)),
            GeneratedId::ContactResponses => unstructured_program(self.contact_responses()),
            GeneratedId::ContactDerivatives => unstructured_program(self.contact_derivatives()),
            GeneratedId::ContactDerivativesByParameters => {
                self.lower_unstructured(&constraints::contact_parameter_derivatives(model))
            }
            GeneratedId::ConstrainedDynamics => {
                unstructured_program(self.derived_dynamics().constrained_dynamics())
            }
            GeneratedId::ConstraintResponse => {
                unstructured_program(self.derived_dynamics().constraint_response())
            }
            GeneratedId::SlippingResponse => {
                unstructured_program(self.derived_dynamics().slipping_response())
            }
            GeneratedId::Output
            | GeneratedId::OutputJacobian
            | GeneratedId::OutputDerivatives
            | GeneratedId::OutputByParameters
            | GeneratedId::Reaction
            | GeneratedId::Touched => {
                self.lower_unstructured(&outputs::output_function_expressions(model, declared))
            }
            GeneratedId::MassMatrixInverse => {
                self.derivative_assembled_at_run_time(DerivativeFunctions::mass_matrix_inverse)
            }
            GeneratedId::CoriolisMatrix => self.derivative_program(DerivativeFunctions::coriolis_matrix),
            GeneratedId::InverseDynamicsDerivatives => {
                self.derivative_program(DerivativeFunctions::inverse_dynamics_derivatives)
            }
            GeneratedId::GeneralizedMomentumDerivatives => {
                self.derivative_program(DerivativeFunctions::momentum_derivatives)
            }
            GeneratedId::MomentumRateDerivatives => {
                self.derivative_program(DerivativeFunctions::momentum_rate_derivatives)
            }
            GeneratedId::ForwardDynamicsDerivatives => self.derivative_assembled_at_run_time(|d| {
                d.forward_dynamics_derivatives(find_derived_function(GeneratedId::InverseDynamicsDerivatives))
            }),
            GeneratedId::Linearize => self.derivative_program(DerivativeFunctions::linearization_program),
            GeneratedId::AccelerationsAndInverse => {
                self.derivative_assembled_at_run_time(DerivativeFunctions::accelerations_and_inverse)
            }
            GeneratedId::MotionDerivatives => {
                self.derivative_program(DerivativeFunctions::constrained_motion_derivative_terms)
            }
            GeneratedId::InputDerivatives => self.derivative_program(DerivativeFunctions::input_derivatives),
            GeneratedId::InverseDynamicsDerivativesInto => {
                copied_program_or_empty(find_derived_function(GeneratedId::InverseDynamicsDerivatives))
            }
            GeneratedId::ForwardDynamicsDerivativesInto => {
                copied_program_or_empty(find_derived_function(GeneratedId::ForwardDynamicsDerivatives))
            }
            GeneratedId::InverseDynamicsSecondDerivatives => {
                self.derivative_program(DerivativeFunctions::inverse_dynamics_second_derivatives)
            }
            GeneratedId::GeneralizedForcesSecondDerivatives => {
                self.derivative_program(DerivativeFunctions::generalized_forces_second_derivatives)
            }
            GeneratedId::ConstraintCurvature => {
                self.derivative_program(DerivativeFunctions::constraint_curvature)
            }
            GeneratedId::JointTorqueRegressor => {
                self.lower_unstructured(&self.regressor_outputs(|i| i.joint_torque_regressor(joints)))
            }
            GeneratedId::StandardParameters => {
                self.lower_unstructured(&self.regressor_outputs(IdentificationFunctions::standard_parameters))
            }
            GeneratedId::BaseRegressor => {
                self.lower_unstructured(&self.regressor_outputs(IdentificationFunctions::base_regressor))
            }
            GeneratedId::BaseParameters => {
                self.lower_unstructured(&self.regressor_outputs(IdentificationFunctions::base_parameters))
            }
            GeneratedId::InverseDynamicsByParameters => {
                unstructured_program(self.derived_sensitivities().inverse_dynamics_sensitivities())
            }
            GeneratedId::ForwardDynamicsByParameters => {
                unstructured_program(self.derived_sensitivities().forward_dynamics_sensitivities())
            }
            GeneratedId::GeneralizedForcesByParameters => {
                self.lower_unstructured(&parameters::generalized_forces_of_inputs(model, joints).concat())
            }
            GeneratedId::MassMatrixPacked | GeneratedId::MassMatrixInto => {
                self.packed_mass_matrix(declared.id)
            }
            GeneratedId::PassiveForces => {
                self.lower_unstructured(&self.passive_outputs(|p| p.forces.clone()))
            }
            GeneratedId::PassiveDerivatives => {
                self.lower_unstructured(&self.passive_outputs(|p| p.derivatives.clone()))
            }
            // Functions of mechanisms with speeds alone, which `outputs_in_speeds` has already handled.
            GeneratedId::RatesOfSpeeds
            | GeneratedId::SpeedsOfRates
            | GeneratedId::RateMatrix
            | GeneratedId::SpeedMatrix
            | GeneratedId::RateChanges
            | GeneratedId::RateAccelerations
            | GeneratedId::Turning
            | GeneratedId::Part => unstructured_program(Program::default()),
        }
    }

    /// Returns the program of the entries of the mass matrix that are not identically zero.
    fn packed_mass_matrix(&self, id: GeneratedId) -> (Program, MatrixStructure) {
        let entries = &self.facts.entries;
        let at: Vec<usize> = entries.iter().map(|(i, j)| j * self.model.nv() + i).collect();
        let entries = if id == GeneratedId::MassMatrixInto { entries.clone() } else { Vec::new() };
        (
            self.derived_dynamics().mass_matrix().with_selected_outputs(&at),
            MatrixStructure { entries, ..MatrixStructure::default() },
        )
    }
}

/// Returns a program whose matrices have no structure to exploit.
fn unstructured_program(program: Program) -> (Program, MatrixStructure) {
    (program, MatrixStructure::default())
}

/// Returns a copy of the program of another function; an empty program if that function does not exist.
fn copied_program_or_empty(other: Option<&Function>) -> (Program, MatrixStructure) {
    other.map(|f| (f.program.clone(), f.structure.clone())).unwrap_or_default()
}

/// Returns constants as expressions.
fn constant_expressions<'g>(graph: &'g Graph, values: &[f64]) -> Vec<Expr<'g>> {
    values.iter().map(|value| graph.num(*value)).collect()
}
