//! Derivation of programs from the functions of the catalogue: the equations of each function, selected by
//! its id.

use super::derivatives::Derivatives;
use super::dynamics::Dynamics;
use super::output::{BlockLoopDerivatives, Function};
use super::regressor::IdentificationFunctions;
use super::sensitivities::SensitivityDerivation;
use super::specialisation::ParameterSpecialisation;
use super::{OptionalFunctionData, constraints, outputs};
use crate::catalogue::{DeclaredFunction, Facts, Id, Structure};
use crate::expr::{Expr, Graph};
use crate::kinematics::Joint;
use crate::lower::{Program, pipeline};
use crate::mechanics::derivatives::parameters;
use crate::mechanics::hamilton::Hamilton;
use crate::mechanics::limb_contacts::LimbContacts;
use crate::mechanics::routh::Routh;
use crate::mechanics::speeds::SpeedTransformation;
use crate::mechanics::{energy, forces, power};
use crate::mechanism::{Model, PassiveForces};
use crate::passes::Passes;
use std::cell::OnceCell;
use std::rc::Rc;

/// The functions of a mechanism. Each function is derived on request; intermediate results that several
/// functions need are derived once.
pub(super) struct Derivation<'a, 'g> {
    /// The model. With declared speeds, the model in which velocities are expressed in these.
    pub(super) model: &'a Model<'g>,
    pub(super) joints: &'a [Joint<'g>],
    speeds: Option<&'a Rc<SpeedTransformation<'g>>>,
    passes: Passes,
    specialisation: ParameterSpecialisation,
    facts: &'a Facts,
    /// Data of the optional functions; `None` while only the functions without an option are derived.
    extras: Option<&'a OptionalFunctionData<'a, 'g>>,
    /// Data of the option `derivatives`; `None` without the option.
    derivatives: Option<&'a Derivatives<'a, 'g>>,
    dynamics: OnceCell<Dynamics<'g>>,
    sensitivities: OnceCell<SensitivityDerivation<'g>>,
}

impl<'a, 'g> Derivation<'a, 'g> {
    pub(super) fn new(
        model: &'a Model<'g>,
        joints: &'a [Joint<'g>],
        speeds: Option<&'a Rc<SpeedTransformation<'g>>>,
        passes: Passes,
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
        derivatives: Option<&'b Derivatives<'b, 'g>>,
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
            Id::InverseDynamicsDerivatives | Id::InverseDynamicsDerivativesInto => {
                self.derivatives?.block_loops(program).map(Box::new)
            }
            _ => None,
        }
    }

    fn derived_dynamics(&self) -> &Dynamics<'g> {
        let native = self.speeds.map_or(self.model, |speeds| &speeds.native);
        self.dynamics.get_or_init(|| Dynamics::new(native, self.passes, self.specialisation, self.speeds))
    }

    fn derived_sensitivities(&self) -> &SensitivityDerivation<'g> {
        self.sensitivities
            .get_or_init(|| SensitivityDerivation::new(self.model, self.passes, self.specialisation))
    }

    /// Returns a function of the option `derivatives`, whose data exist if such a function is declared.
    fn derivative_program(
        &self,
        function: impl FnOnce(&Derivatives<'a, 'g>) -> Program,
    ) -> (Program, Structure) {
        self.derivative_assembled_at_run_time(|derivatives| (function(derivatives), Structure::default()))
    }

    /// Returns a function of the option `derivatives` whose results the runtime assembles.
    fn derivative_assembled_at_run_time(
        &self,
        function: impl FnOnce(&Derivatives<'a, 'g>) -> (Program, Structure),
    ) -> (Program, Structure) {
        self.derivatives.map(function).unwrap_or_default()
    }

    fn contact_responses(&self) -> Program {
        let native = self.speeds.map_or(self.model, |speeds| &speeds.native);
        self.derived_dynamics().contact_responses(&constraints::contact_rows(native))
    }

    /// Returns the program of a contact function from its values, one for each contact velocity.
    fn contact_program(&self, values: &[Expr<'g>]) -> Program {
        self.with_limb_contacts(self.specialisation.lower_to_program(values), |contacts| {
            contacts.merge_contact_values(values)
        })
    }

    fn contact_jacobian(&self) -> Program {
        let rows = constraints::contact_rows(self.model);
        let plain = self.specialisation.lower_to_program(&constraints::matrix_by_columns(self.model, &rows));
        self.with_limb_contacts(plain, |contacts| {
            Some(constraints::matrix_by_columns(self.model, &contacts.merge_rows(&rows)?))
        })
    }

    fn contact_derivatives(&self) -> Program {
        let found = constraints::ContactDerivatives::new(self.model);
        let plain = self.specialisation.lower_to_program(&found.contact_derivative_outputs(self.model));
        self.with_limb_contacts(plain, |contacts| found.contact_derivatives_in_lanes(self.model, contacts))
    }

    /// Returns the program of a contact function with the version in which identical limbs are SIMD lanes, if
    /// one exists.
    fn with_limb_contacts(
        &self,
        plain: Program,
        outputs: impl FnOnce(&mut LimbContacts<'_, 'g>) -> Option<Vec<Expr<'g>>>,
    ) -> Program {
        match self.facts.kinematic {
            true => plain,
            false => self.derived_dynamics().with_limb_contacts(
                plain,
                &constraints::contact_rows(self.model),
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
        outputs: impl FnOnce(&Hamilton<'g>) -> Vec<Expr<'g>>,
    ) -> Vec<Expr<'g>> {
        self.extras.and_then(|extras| extras.hamilton.as_ref()).map(outputs).unwrap_or_default()
    }

    /// Returns the outputs of a function of the option `routh`.
    fn routh_outputs(&self, outputs: impl FnOnce(&Routh<'g>) -> Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        self.extras.and_then(|extras| extras.routh.as_ref()).map(outputs).unwrap_or_default()
    }

    /// Returns the outputs of a function of the passive forces, if the passive forces have separate
    /// functions.
    fn passive_outputs(&self, outputs: fn(&PassiveForces<'g>) -> Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        self.model.passive.as_deref().map_or_else(Vec::new, outputs)
    }

    /// Lowers the outputs of a function whose matrices have no structure to exploit.
    fn lower_unstructured(&self, outputs: &[Expr<'g>]) -> (Program, Structure) {
        unstructured_program(self.specialisation.lower_to_program(outputs))
    }

    /// Returns the program of a declared function, with the structure of its matrices. Functions that are
    /// `done` may be used.
    fn program_of_function(&self, declared: &DeclaredFunction, done: &[Function]) -> (Program, Structure) {
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
    ) -> (Program, Structure) {
        let (model, joints) = (self.model, self.joints);
        let find_derived_function = |id: Id| done.iter().find(|f| f.id == id);
        match declared.id {
            Id::Neutral => {
                self.lower_unstructured(&constant_expressions(model.graph, &model.neutral_configuration()))
            }
            Id::InitialConfiguration => {
                let configuration = model.initial_configuration.as_deref().unwrap_or_default();
                self.lower_unstructured(&constant_expressions(model.graph, configuration))
            }
            Id::Limits => self.lower_unstructured(&model.coordinate_limit_bounds()),
            Id::Drawing => self.lower_unstructured(&model.drawing_numbers()),
            Id::Heights => self.lower_unstructured(&model.heights),
            Id::Figures => self.lower_unstructured(&model.requirement_values()),
            Id::GeneralizedForces => self.lower_unstructured(&forces::generalized_forces(model, joints)),
            Id::DissipatedPower => self.lower_unstructured(&[power::dissipated_power(model)]),
            Id::ControlPower => self.lower_unstructured(&[power::control_power(model, joints)]),
            Id::DisturbancePower => self.lower_unstructured(&[power::disturbance_power(model)]),
            Id::TotalMass => self.lower_unstructured(&[energy::mass_and_moment(model, joints).0]),
            Id::MassMatrix => unstructured_program(self.derived_dynamics().mass_matrix()),
            Id::InverseDynamics => unstructured_program(self.derived_dynamics().inverse_dynamics()),
            Id::BiasForces => unstructured_program(self.derived_dynamics().bias_forces()),
            Id::ForwardDynamics => unstructured_program(self.derived_dynamics().forward_dynamics()),
            Id::KineticEnergy => unstructured_program(self.derived_dynamics().kinetic_energy()),
            Id::PotentialEnergy => unstructured_program(self.derived_dynamics().potential_energy()),
            Id::GeneralizedMomentum => unstructured_program(self.derived_dynamics().generalized_momentum()),
            Id::MomentumRate => unstructured_program(self.derived_dynamics().momentum_rate()),
            Id::CenterOfMass => unstructured_program(self.derived_dynamics().center_of_mass()),
            Id::Momentum => unstructured_program(self.derived_dynamics().momentum_program()),
            Id::CentroidalMomentumMatrix => {
                unstructured_program(self.derived_dynamics().centroidal_momentum_matrix())
            }
            Id::CentroidalMomentumBias => {
                unstructured_program(self.derived_dynamics().centroidal_momentum_bias())
            }
            Id::Hamiltonian => self.lower_unstructured(&self.hamilton_outputs(|h| vec![h.hamiltonian])),
            Id::CanonicalVelocity => self.lower_unstructured(&self.hamilton_outputs(|h| h.velocity.clone())),
            Id::CanonicalMomentumRate => {
                self.lower_unstructured(&self.hamilton_outputs(|h| h.momentum_rate.clone()))
            }
            Id::Routhian => self.lower_unstructured(&self.routh_outputs(|r| vec![r.routhian])),
            Id::CyclicVelocities => self.lower_unstructured(&self.routh_outputs(|r| r.velocity.clone())),
            Id::ReducedAccelerations => {
                self.lower_unstructured(&self.routh_outputs(|r| r.acceleration.clone()))
            }
            Id::Conserved => self.lower_unstructured(&self.conserved_quantities()),
            Id::ConstraintResiduals => self.lower_unstructured(&constraints::residuals(model)),
            Id::ConstraintRates => self.lower_unstructured(&constraints::constraint_velocities(model)),
            Id::ConstraintJacobian => self.lower_unstructured(&constraints::constraint_jacobian(model)),
            Id::ConstraintBias => self.lower_unstructured(&constraints::constraint_biases(model)),
            Id::ContactGaps => self.lower_unstructured(&constraints::contact_gaps(model)),
            Id::ContactRates => unstructured_program(self.contact_program(&model.contact_rates())),
            Id::ContactJacobian => unstructured_program(self.contact_jacobian()),
            Id::ContactBias => {
                unstructured_program(self.contact_program(&constraints::contact_biases(model)))
            }
            Id::PolytopePoses => self.lower_unstructured(&model.polytope_poses()),
            Id::ContactLaws => self.lower_unstructured(&constraints::contact_coefficients(model)),
            Id::ContactResponses => unstructured_program(self.contact_responses()),
            Id::ContactDerivatives => unstructured_program(self.contact_derivatives()),
            Id::ContactDerivativesByParameters => {
                self.lower_unstructured(&constraints::contact_parameter_derivatives(model))
            }
            Id::ConstrainedDynamics => unstructured_program(self.derived_dynamics().constrained_dynamics()),
            Id::ConstraintResponse => unstructured_program(self.derived_dynamics().constraint_response()),
            Id::SlippingResponse => unstructured_program(self.derived_dynamics().slipping_response()),
            Id::Output
            | Id::OutputJacobian
            | Id::OutputDerivatives
            | Id::OutputByParameters
            | Id::Reaction
            | Id::Touched => self.lower_unstructured(&outputs::output_function_expressions(model, declared)),
            Id::MassMatrixInverse => self.derivative_assembled_at_run_time(Derivatives::mass_matrix_inverse),
            Id::CoriolisMatrix => self.derivative_program(Derivatives::coriolis_matrix),
            Id::InverseDynamicsDerivatives => {
                self.derivative_program(Derivatives::inverse_dynamics_derivatives)
            }
            Id::GeneralizedMomentumDerivatives => self.derivative_program(Derivatives::momentum_derivatives),
            Id::MomentumRateDerivatives => self.derivative_program(Derivatives::momentum_rate_derivatives),
            Id::ForwardDynamicsDerivatives => self.derivative_assembled_at_run_time(|d| {
                d.forward_dynamics_derivatives(find_derived_function(Id::InverseDynamicsDerivatives))
            }),
            Id::Linearize => self.derivative_program(Derivatives::linearization_program),
            Id::AccelerationsAndInverse => {
                self.derivative_assembled_at_run_time(Derivatives::accelerations_and_inverse)
            }
            Id::MotionDerivatives => self.derivative_program(Derivatives::motion_derivatives),
            Id::InputDerivatives => self.derivative_program(Derivatives::input_derivatives),
            Id::InverseDynamicsDerivativesInto => {
                program_of_function(find_derived_function(Id::InverseDynamicsDerivatives))
            }
            Id::ForwardDynamicsDerivativesInto => {
                program_of_function(find_derived_function(Id::ForwardDynamicsDerivatives))
            }
            Id::InverseDynamicsSecondDerivatives => {
                self.derivative_program(Derivatives::inverse_dynamics_second_derivatives)
            }
            Id::GeneralizedForcesSecondDerivatives => {
                self.derivative_program(Derivatives::generalized_forces_second_derivatives)
            }
            Id::ConstraintCurvature => self.derivative_program(Derivatives::constraint_curvature),
            Id::JointTorqueRegressor => {
                self.lower_unstructured(&self.regressor_outputs(|i| i.joint_torque_regressor(joints)))
            }
            Id::StandardParameters => {
                self.lower_unstructured(&self.regressor_outputs(IdentificationFunctions::standard_parameters))
            }
            Id::BaseRegressor => {
                self.lower_unstructured(&self.regressor_outputs(IdentificationFunctions::base_regressor))
            }
            Id::BaseParameters => {
                self.lower_unstructured(&self.regressor_outputs(IdentificationFunctions::base_parameters))
            }
            Id::InverseDynamicsByParameters => {
                unstructured_program(self.derived_sensitivities().inverse_dynamics())
            }
            Id::ForwardDynamicsByParameters => {
                unstructured_program(self.derived_sensitivities().forward_dynamics())
            }
            Id::GeneralizedForcesByParameters => {
                self.lower_unstructured(&parameters::generalized_forces(model, joints).concat())
            }
            Id::MassMatrixPacked | Id::MassMatrixInto => self.packed_mass_matrix(declared.id),
            Id::PassiveForces => self.lower_unstructured(&self.passive_outputs(|p| p.forces.clone())),
            Id::PassiveDerivatives => {
                self.lower_unstructured(&self.passive_outputs(|p| p.derivatives.clone()))
            }
            // Functions of mechanisms with speeds alone, which `outputs_in_speeds` has already handled.
            Id::RatesOfSpeeds
            | Id::SpeedsOfRates
            | Id::RateMatrix
            | Id::SpeedMatrix
            | Id::RateChanges
            | Id::RateAccelerations
            | Id::Turning
            | Id::Part => unstructured_program(Program::default()),
        }
    }

    /// Returns the program of the entries of the mass matrix that are not identically zero.
    fn packed_mass_matrix(&self, id: Id) -> (Program, Structure) {
        let entries = &self.facts.entries;
        let at: Vec<usize> = entries.iter().map(|(i, j)| j * self.model.nv() + i).collect();
        let entries = if id == Id::MassMatrixInto { entries.clone() } else { Vec::new() };
        (
            self.derived_dynamics().mass_matrix().with_selected_outputs(&at),
            Structure { entries, ..Structure::default() },
        )
    }
}

/// Returns a program whose matrices have no structure to exploit.
fn unstructured_program(program: Program) -> (Program, Structure) {
    (program, Structure::default())
}

/// Returns a copy of the program of another function; an empty program if that function does not exist.
fn program_of_function(other: Option<&Function>) -> (Program, Structure) {
    other.map(|f| (f.program.clone(), f.structure.clone())).unwrap_or_default()
}

/// Returns constants as expressions.
fn constant_expressions<'g>(graph: &'g Graph, values: &[f64]) -> Vec<Expr<'g>> {
    values.iter().map(|value| graph.num(*value)).collect()
}
