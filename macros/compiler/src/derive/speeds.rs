//! Functions of a mechanism with declared generalized speeds, except dynamics: the transformation from speeds
//! to joint velocities, and all derivatives, by differentiation of the equations in speeds.

use super::derivation::Derivation;
use super::derivatives::entries_by_column;
use super::second;
use crate::catalogue::{DeclaredFunction, GeneratedId};
use crate::expr::Expr;
use crate::expr::diff::DirectionalDerivative;
use crate::expr::replace::substitute_symbols_in_all;
use crate::kinematics::symbols_in;
use crate::mechanics::derivatives::second::{self as hessian, Hessian, InputPowerHessian};
use crate::mechanics::derivatives::{
    ForceDerivatives, MatrixFactorisation, analytic, subtract_matrix, symbolic,
};
use crate::mechanics::speeds::{ResultKind, SpeedTransformation};
use crate::mechanics::{
    self, added_mass, constraints, crba, energy, forces, momentum, power, reactions, rnea,
};
use crate::mechanism::{Model, Quantity};
use crate::syntax::{EquationsOption, RequestedFunctions};

/// Returns the error message and help for an option that does not support these speeds.
pub(super) fn unsupported_option_message(
    speeds: &SpeedTransformation<'_>,
    requests: RequestedFunctions,
) -> Option<(&'static str, &'static str)> {
    if requests.routh || requests.equations == EquationsOption::Routh {
        return Some((
            "Routh's equations are available in coordinates, not in declared speeds",
            "the reduction replaces the rates of cyclic coordinates by their momenta, but declared speeds \
             replace these rates: remove `routh` or the speeds",
        ));
    }
    let of_speeds: Vec<Expr<'_>> = speeds.speed_to_velocity_matrix().iter().flatten().copied().collect();
    let by_parameters = symbols_in(&of_speeds)
        .into_iter()
        .any(|s| matches!(Quantity::from_symbol(s), Quantity::Parameter(_)));
    (requests.sensitivities && by_parameters).then_some((
        "derivatives with respect to parameters are not available with speeds that contain parameters",
        "the motion of the configuration would depend on the parameters: remove the option `sensitivities`, \
         or the parameters in `#[speed(…)]`",
    ))
}

impl<'g> Derivation<'_, 'g> {
    /// Returns the outputs of a function that declared generalized speeds change; `None` for functions that
    /// they do not change.
    pub(super) fn outputs_in_speeds(
        &self,
        speeds: &SpeedTransformation<'g>,
        declared: &DeclaredFunction,
    ) -> Option<Vec<Expr<'g>>> {
        let (native, joints) = (&speeds.native, self.joints);
        let scalars_in_speeds = |e: Vec<Expr<'g>>| Some(speeds.express_in_speeds(&e));
        match declared.id {
            GeneratedId::RatesOfSpeeds => Some(speeds.rates.clone()),
            GeneratedId::SpeedsOfRates => {
                Some(speeds.speeds_of_velocities(&mechanics::velocity_symbols(native)))
            }
            GeneratedId::RateMatrix => Some(entries_by_column(speeds.speed_to_velocity_matrix())),
            GeneratedId::SpeedMatrix => Some(entries_by_column(speeds.velocity_to_speed_matrix())),
            GeneratedId::RateChanges => Some(entries_by_column(&speeds.velocity_configuration_derivatives())),
            GeneratedId::RateAccelerations => Some(speeds.accelerations.clone()),
            GeneratedId::GeneralizedForces => Some(self.input_forces(speeds)),
            GeneratedId::DissipatedPower => scalars_in_speeds(vec![power::dissipated_power(native)]),
            GeneratedId::ControlPower => scalars_in_speeds(vec![power::control_power(native, joints)]),
            GeneratedId::DisturbancePower => scalars_in_speeds(vec![power::disturbance_power(native)]),
            GeneratedId::TotalMass => Some(vec![energy::mass_and_moment(native, joints).0]),
            GeneratedId::Hamiltonian
            | GeneratedId::CanonicalVelocity
            | GeneratedId::CanonicalMomentumRate => self.hamiltons_form_in_speeds(speeds, declared.id),
            GeneratedId::Reaction => {
                let name = declared.name.strip_prefix(crate::catalogue::REACTION)?;
                let output = native.outputs.iter().find(|output| output.name == name)?;
                scalars_in_speeds(reactions::replace_reactions(
                    native,
                    &output.values,
                    output.diagram.is_some(),
                ))
            }
            GeneratedId::JointTorqueRegressor => self.regressor_in_speeds(speeds, true),
            GeneratedId::BaseRegressor => self.regressor_in_speeds(speeds, false),
            GeneratedId::InverseDynamicsByParameters => {
                Some(self.parameter_derivatives(&self.inverse_dynamics_in_speeds(speeds)).concat())
            }
            GeneratedId::ForwardDynamicsByParameters => {
                Some(self.acceleration_derivatives_by_parameters(speeds))
            }
            GeneratedId::GeneralizedForcesByParameters => {
                Some(self.parameter_derivatives(&self.input_forces(speeds)).concat())
            }
            _ => self.derivatives_in_speeds(speeds, declared.id),
        }
    }

    fn derivatives_in_speeds(
        &self,
        speeds: &SpeedTransformation<'g>,
        id: GeneratedId,
    ) -> Option<Vec<Expr<'g>>> {
        let (native, model, joints) = (&speeds.native, &speeds.model, self.joints);
        let v = mechanics::velocity_symbols(native);
        let force_derivative_columns = |e: &[Expr<'g>]| {
            force_derivative_entries(&symbolic::configuration_and_velocity_derivatives(model, e))
        };
        match id {
            GeneratedId::MassMatrixInverse => Some(self.inverse_mass_matrix(speeds, false)),
            GeneratedId::CoriolisMatrix => {
                let (coriolis, mass) =
                    (analytic::coriolis_matrix(native, joints, &v, 1), crba::mass_matrix(native, joints));
                Some(entries_by_column(&speeds.transform_coriolis_matrix(&coriolis, &mass)))
            }
            GeneratedId::InverseDynamicsDerivatives => {
                Some(force_derivative_columns(&self.inverse_dynamics_in_speeds(speeds)))
            }
            GeneratedId::GeneralizedMomentumDerivatives => {
                let p = speeds.transform_forces(&momentum::generalized_momentum(native, joints, &v));
                Some(entries_by_column(&symbolic::configuration_derivatives(model, &p)))
            }
            GeneratedId::MomentumRateDerivatives => {
                let (rate, p) = (
                    momentum::momentum_rate_without_inputs(native, joints, &v),
                    momentum::generalized_momentum(native, joints, &v),
                );
                Some(force_derivative_columns(&speeds.transform_momentum_rate(&rate, &p)))
            }
            GeneratedId::ForwardDynamicsDerivatives => {
                let forces = symbolic::configuration_and_velocity_derivatives(
                    model,
                    &self.inverse_dynamics_in_speeds(speeds),
                );
                let accelerations = self.unconstrained_accelerations(speeds);
                let forces = self.substitute_accelerations(force_derivative_entries(&forces), &accelerations);
                Some([forces, self.inverse_mass_matrix(speeds, true), accelerations].concat())
            }
            GeneratedId::Linearize => Some(self.linearization_in_speeds(speeds)),
            GeneratedId::InputDerivatives => {
                let tau = self.input_forces(speeds);
                let by_inputs = entries_by_column(&symbolic::input_derivatives_of_expressions(model, &tau));
                Some([tau.clone(), force_derivative_columns(&tau), by_inputs].concat())
            }
            GeneratedId::Turning => Some(entries_by_column(&speeds.variational_matrix())),
            GeneratedId::InverseDynamicsSecondDerivatives
            | GeneratedId::GeneralizedForcesSecondDerivatives
            | GeneratedId::ConstraintCurvature => Some(self.second_derivatives_in_speeds(speeds, id)),
            GeneratedId::MotionDerivatives => Some(self.constrained_motion_derivative_terms(speeds)),
            _ => None,
        }
    }

    /// Returns `τ` as a function of the rates of the speeds.
    fn inverse_dynamics_in_speeds(&self, speeds: &SpeedTransformation<'g>) -> Vec<Expr<'g>> {
        let (v, a) =
            (mechanics::velocity_symbols(&speeds.native), mechanics::acceleration_symbols(&speeds.native));
        speeds.transform_forces(&rnea::inverse_dynamics(&speeds.native, self.joints, &v, Some(&a)))
    }

    fn input_forces(&self, speeds: &SpeedTransformation<'g>) -> Vec<Expr<'g>> {
        speeds.transform_forces(&forces::generalized_forces_of_inputs(&speeds.native, self.joints))
    }

    fn mass_matrix_factor(
        &self,
        speeds: &SpeedTransformation<'g>,
        effective: bool,
    ) -> MatrixFactorisation<'g> {
        let mass = crba::mass_matrix(&speeds.native, self.joints);
        let mass = if effective { added_mass::effective_mass_matrix(&speeds.native, &mass) } else { mass };
        MatrixFactorisation::new(&mass, self.joints)
    }

    /// Returns the inverse of the mass matrix, or of the effective mass matrix, column by column.
    fn inverse_mass_matrix(&self, speeds: &SpeedTransformation<'g>, effective: bool) -> Vec<Expr<'g>> {
        entries_by_column(
            &speeds.transform_inverse_mass_matrix(&self.mass_matrix_factor(speeds, effective).inverse()),
        )
    }

    /// Returns the accelerations under symbolic forces, without constraints.
    fn unconstrained_accelerations(&self, speeds: &SpeedTransformation<'g>) -> Vec<Expr<'g>> {
        let native = &speeds.native;
        let bias = rnea::inverse_dynamics(native, self.joints, &mechanics::velocity_symbols(native), None);
        let lacking = mechanics::generalized_force_symbols(native)
            .into_iter()
            .zip(bias)
            .map(|(tau, h)| tau - h)
            .collect();
        speeds.results_in_generalized_speeds(
            ResultKind::Accelerations(0),
            &self.mass_matrix_factor(speeds, true).solve_factored(lacking),
        )
    }

    /// Returns the expressions with the acceleration symbols replaced by `a`.
    fn substitute_accelerations(&self, e: Vec<Expr<'g>>, a: &[Expr<'g>]) -> Vec<Expr<'g>> {
        substitute_symbols_in_all(&e, &|s| match Quantity::from_symbol(s) {
            Quantity::Acceleration(k) => a.get(k).copied(),
            _ => None,
        })
    }

    fn linearization_in_speeds(&self, speeds: &SpeedTransformation<'g>) -> Vec<Expr<'g>> {
        let (model, tau) = (&speeds.model, self.input_forces(speeds));
        let accelerations = substitute_symbols_in_all(&self.unconstrained_accelerations(speeds), &|s| {
            match Quantity::from_symbol(s) {
                Quantity::Force(k) => tau.get(k).copied(),
                _ => None,
            }
        });
        let mut forces =
            symbolic::configuration_and_velocity_derivatives(model, &self.inverse_dynamics_in_speeds(speeds));
        let by_state = symbolic::configuration_and_velocity_derivatives(model, &tau);
        subtract_matrix(&mut forces.by_q, &by_state.by_q);
        subtract_matrix(&mut forces.by_v, &by_state.by_v);
        let mut outputs = self.substitute_accelerations(force_derivative_entries(&forces), &accelerations);
        outputs.extend(self.inverse_mass_matrix(speeds, true));
        outputs.extend(entries_by_column(&symbolic::input_derivatives_of_expressions(model, &tau)));
        outputs.extend(entries_by_column(&speeds.variational_matrix()));
        outputs
    }

    /// Returns, at constant accelerations and multipliers, the derivatives of `M u̇ + h − Jᵀ λ`, of
    /// `J u̇ + b` and of the constraint velocities, followed by the matrix of the variational equation of
    /// displacements.
    fn constrained_motion_derivative_terms(&self, speeds: &SpeedTransformation<'g>) -> Vec<Expr<'g>> {
        let (native, model) = (&speeds.native, &speeds.model);
        let held = speeds.transform_forces(&constraints::constraint_forces(
            native,
            &constraints::multiplier_argument_symbols(native),
        ));
        let lacking: Vec<Expr<'g>> =
            self.inverse_dynamics_in_speeds(speeds).iter().zip(held).map(|(f, held)| *f - held).collect();
        let a = mechanics::acceleration_symbols(model);
        let first = constraints::constraint_first_derivatives(model, &a);
        let mut outputs =
            force_derivative_entries(&symbolic::configuration_and_velocity_derivatives(model, &lacking));
        outputs.extend(force_derivative_entries(&first.accelerations));
        outputs.extend(entries_by_column(&first.rates));
        outputs.extend(entries_by_column(&speeds.variational_matrix()));
        outputs
    }

    /// Returns the second derivatives in speeds. Along `q ⊕ ε dv` the joints move by `ε Z(q) dv`, so the
    /// second derivatives with respect to joint displacements are multiplied by `Z` at `q`.
    fn second_derivatives_in_speeds(
        &self,
        speeds: &SpeedTransformation<'g>,
        id: GeneratedId,
    ) -> Vec<Expr<'g>> {
        let native = &speeds.native;
        let hessian_in_speeds = |found: Hessian<'g>| Hessian {
            qq: speeds.transform_mass_matrix(&found.qq),
            qv: speeds.project_rows_onto_speeds(&found.qv),
            qa: speeds.project_rows_onto_speeds(&found.qa),
            ..found
        };
        match id {
            GeneratedId::ConstraintCurvature => {
                // Second derivatives of the constraints, expressed in speeds, with respect to joint
                // displacements.
                let constraints = speeds.model.constraints.clone();
                let found = hessian::hessian_of_constraints(&Model { constraints, ..native.clone() });
                let mut outputs = second::state_hessian_blocks(&hessian_in_speeds(found.state)).concat();
                outputs.extend(entries_by_column(&speeds.project_rows_onto_speeds(&found.q_lambda)));
                outputs
            }
            GeneratedId::GeneralizedForcesSecondDerivatives => {
                let InputPowerHessian { state, qu, vu, uu } =
                    hessian::hessian_of_input_power(native, &self.input_forces(speeds));
                let [qq, qv, vv, _] = second::state_hessian_blocks(&hessian_in_speeds(state));
                [
                    qq,
                    qv,
                    vv,
                    entries_by_column(&speeds.project_rows_onto_speeds(&qu)),
                    entries_by_column(&vu),
                    entries_by_column(&uu),
                ]
                .concat()
            }
            _ => {
                let found = hessian::hessian_of_power(
                    native,
                    &self.inverse_dynamics_in_speeds(speeds),
                    &hessian::force_factor_symbols(native),
                );
                second::state_hessian_blocks(&hessian_in_speeds(found)).concat()
            }
        }
    }

    /// Returns the derivatives with respect to all parameters, a list for each parameter.
    fn parameter_derivatives(&self, e: &[Expr<'g>]) -> Vec<Vec<Expr<'g>>> {
        let (graph, count) = (self.model.graph, self.model.parameters.len());
        let derivatives_by_one_parameter = |k| {
            let mut by = DirectionalDerivative::with_respect_to(Quantity::Parameter(k).symbol(), graph);
            e.iter().map(|e| by.differentiate(*e)).collect()
        };
        (0..count).map(derivatives_by_one_parameter).collect()
    }

    /// Returns `∂u̇/∂p = −M⁻¹ ∂τ/∂p` at the accelerations under the forces.
    fn acceleration_derivatives_by_parameters(&self, speeds: &SpeedTransformation<'g>) -> Vec<Expr<'g>> {
        let (n, a) = (self.model.nv(), self.unconstrained_accelerations(speeds));
        let inverse = self.inverse_mass_matrix(speeds, true);
        let acceleration_derivatives_from_force_derivatives = |forces: &[Expr<'g>]| -> Vec<Expr<'g>> {
            let acceleration_derivative_of_row = |i: usize| {
                let terms = (0..n).map(|j| inverse[j * n + i] * forces[j]);
                terms.fold(self.model.graph.zero(), |sum, term| sum - term)
            };
            (0..n).map(acceleration_derivative_of_row).collect()
        };
        let changes = self.parameter_derivatives(&self.inverse_dynamics_in_speeds(speeds));
        changes
            .into_iter()
            .flat_map(|change| {
                acceleration_derivatives_from_force_derivatives(&self.substitute_accelerations(change, &a))
            })
            .collect()
    }

    fn regressor_in_speeds(&self, speeds: &SpeedTransformation<'g>, standard: bool) -> Option<Vec<Expr<'g>>> {
        let joints = self.joints;
        let of_joints = self.regressor_outputs(|i| match standard {
            true => i.joint_torque_regressor(joints),
            false => i.base_regressor(),
        });
        let n = self.model.nv().max(1);
        Some(of_joints.chunks(n).flat_map(|column| speeds.transform_forces(column)).collect())
    }

    /// Returns Hamilton's form in speeds. With the momenta `p` of the speeds, the momenta of the joints are
    /// `Yᵀ p`.
    fn hamiltons_form_in_speeds(
        &self,
        speeds: &SpeedTransformation<'g>,
        id: GeneratedId,
    ) -> Option<Vec<Expr<'g>>> {
        let g = self.model.graph;
        let momenta: Vec<Expr<'g>> = (0..self.model.nv()).map(|k| Quantity::Momentum(k).expr(g)).collect();
        let of_joints = speeds.express_in_speeds_and_momenta(&momenta);
        let replace_velocities_by_momenta = |e: Vec<Expr<'g>>| -> Vec<Expr<'g>> {
            let velocity = speeds.speeds_of_velocities(
                &speeds.express_in_speeds_and_momenta(&self.hamilton_outputs(|h| h.velocity.clone())),
            );
            substitute_symbols_in_all(&e, &|s| match Quantity::from_symbol(s) {
                Quantity::Velocity(k) => velocity.get(k).copied(),
                _ => None,
            })
        };
        Some(match id {
            GeneratedId::Hamiltonian => {
                speeds.express_in_speeds_and_momenta(&self.hamilton_outputs(|h| vec![h.hamiltonian]))
            }
            GeneratedId::CanonicalVelocity => {
                replace_velocities_by_momenta(mechanics::velocity_symbols(self.model))
            }
            _ => {
                let rate =
                    speeds.express_in_speeds_and_momenta(&self.hamilton_outputs(|h| h.momentum_rate.clone()));
                replace_velocities_by_momenta(speeds.transform_expressed_momentum_rate(&rate, &of_joints))
            }
        })
    }
}

fn force_derivative_entries<'g>(d: &ForceDerivatives<'g>) -> Vec<Expr<'g>> {
    [&d.by_q, &d.by_v].into_iter().flat_map(entries_by_column).collect()
}
