//! Programs of the functions of dynamics. They are derived from several variants of one model that define
//! equal functions, and the cheapest program is selected.

use super::limb_lanes;
use super::specialisation::{Candidate, ParameterSpecialisation};
use crate::expr::Expr;
use crate::kinematics::Joint;
use crate::lower::Program;
use crate::machine::{COMPARED_OPERATIONS, COMPARED_VELOCITIES};
use crate::mechanics::derivatives::MatrixFactorisation;
use crate::mechanics::limb_contacts::LimbContacts;
use crate::mechanics::speeds::{ResultKind, SpeedTransformation};
use crate::mechanics::{self, crba, energy, frames, limb_responses, momentum};
use crate::mechanism::Model;
use crate::passes::PassSelection;
use std::rc::Rc;

mod frame_choice;
mod variants;

use frame_choice::{FrameChoice, smallest_candidate_size};
use variants::ModelVariants;

/// Inverse tolerance of the comparison of frames: frames whose mass matrix and inverse dynamics exceed the
/// minimum size by more than one part in this number are excluded.
const SIMILAR: usize = 8;

/// The variants of a model from which the functions of dynamics are derived.
pub(super) struct DynamicsDerivation<'g> {
    /// Variants of the model for each frame choice that may be the cheapest, the best first.
    choices: Vec<ModelVariants<'g>>,
    /// True if the results are in declared generalized speeds.
    in_speeds: bool,
    /// True if forward dynamics uses one algorithm without comparing alternatives.
    is_large: bool,
    specialisation: ParameterSpecialisation,
    mass_matrix: Program,
    inverse_dynamics: Program,
    bias: Program,
}

impl<'g> DynamicsDerivation<'g> {
    /// Derives mass matrix, inverse dynamics and bias of all variants. The variants have moved frames; for a
    /// small mechanism also the original frames, and frames with common axes. With `speeds`, results are
    /// transformed to generalized speeds.
    pub(super) fn new(
        model: &Model<'g>,
        passes: PassSelection,
        specialisation: ParameterSpecialisation,
        speeds: Option<&Rc<SpeedTransformation<'g>>>,
    ) -> DynamicsDerivation<'g> {
        let mut all = FrameChoice::candidate_frame_choices(model, passes, specialisation, speeds);
        all.sort_by_key(|choice| choice.size);
        if model.nv() > COMPARED_VELOCITIES {
            all.truncate(1);
        }
        let least = all.iter().map(|choice| choice.size).min().unwrap_or_default();
        let most = least + least / SIMILAR;
        let (mut masses, mut recursions, mut choices) = (Vec::new(), Vec::new(), Vec::new());
        for choice in all {
            masses.extend(choice.masses);
            recursions.extend(choice.recursions);
            if choice.size <= most {
                choices.push(choice.variants);
            }
        }
        choices.iter_mut().for_each(ModelVariants::store_cheapest_bias_program);
        let wide = if speeds.is_none() { passes.tried_lane_counts(model.nv()) } else { &[] };
        let wide = lane_mass_matrix_programs(&choices, specialisation, wide);
        let side_by_side = cheapest_lane_programs(
            specialisation,
            choices.iter().flat_map(|variants| variants.inverse_dynamics_in_limb_lanes(true)),
        );
        let biases = choices.iter().map(|variants| &variants.bias.program);
        let bias =
            biases.min_by_key(|p| (p.counts.total_operations(), p.instruction_count_after_fusion())).cloned();
        let biases_in_lanes =
            choices.iter().filter_map(|variants| Some(variants.bias.simd.as_ref()?.1.clone()));
        DynamicsDerivation {
            mass_matrix: specialisation.cheapest_program(masses.into_iter()).with_cheapest_lane_variant(wide),
            inverse_dynamics: specialisation
                .cheapest_program(recursions.into_iter())
                .with_cheapest_lane_variant(side_by_side),
            bias: bias.unwrap_or_default().with_cheapest_lane_variant(biases_in_lanes),
            is_large: model.nv() > COMPARED_VELOCITIES || least > COMPARED_OPERATIONS,
            choices,
            in_speeds: speeds.is_some(),
            specialisation,
        }
    }

    pub(super) fn mass_matrix(&self) -> Program {
        self.mass_matrix.clone()
    }

    pub(super) fn inverse_dynamics(&self) -> Program {
        self.inverse_dynamics.clone()
    }

    pub(super) fn bias_forces(&self) -> Program {
        self.bias.clone()
    }

    pub(super) fn kinetic_energy(&self) -> Program {
        self.smallest_program(ResultKind::Scalars, |m, j, v| vec![energy::kinetic_energy(m, j, v)])
    }

    pub(super) fn potential_energy(&self) -> Program {
        self.smallest_program(ResultKind::Scalars, |m, j, _| vec![energy::potential_energy(m, j)])
    }

    pub(super) fn generalized_momentum(&self) -> Program {
        self.smallest_program(ResultKind::Forces, momentum::generalized_momentum)
    }

    pub(super) fn momentum_rate(&self) -> Program {
        self.smallest_program(ResultKind::MomentumRate, |m, j, v| {
            let mut rate = momentum::momentum_rate_without_inputs(m, j, v);
            if self.in_speeds {
                rate.extend(momentum::generalized_momentum(m, j, v));
            }
            rate
        })
    }

    pub(super) fn center_of_mass(&self) -> Program {
        self.smallest_program(ResultKind::Scalars, |m, j, _| energy::center_of_mass(m, j).0.to_vec())
    }

    pub(super) fn centroidal_momentum(&self) -> Program {
        self.smallest_program(ResultKind::Scalars, |m, j, v| {
            frames::spatial_components(&momentum::centroidal_momentum(m, j, v))
        })
    }

    pub(super) fn centroidal_momentum_matrix(&self) -> Program {
        self.smallest_program(ResultKind::Columns(6), |m, j, _| momentum::centroidal_momentum_matrix(m, j))
    }

    pub(super) fn centroidal_momentum_bias(&self) -> Program {
        self.smallest_program(ResultKind::Bias(6), |m, j, v| {
            let mut bias = frames::spatial_components(&momentum::centroidal_bias(m, j, v)).to_vec();
            if self.in_speeds {
                bias.extend(momentum::centroidal_momentum_matrix(m, j));
            }
            bias
        })
    }

    pub(super) fn constrained_dynamics(&self) -> Program {
        self.best_variant_program(ModelVariants::constrained_dynamics)
    }

    pub(super) fn constraint_response(&self) -> Program {
        self.best_variant_program(ModelVariants::constraint_response)
    }

    pub(super) fn slipping_response(&self) -> Program {
        self.best_variant_program(ModelVariants::slipping_response)
    }

    /// Returns the changes of the velocities, and of the contact velocities with these rows, due to unit
    /// impulses.
    pub(super) fn contact_responses(&self, rows: &crba::Matrix<'g>) -> Program {
        self.best_variant_program(|variants| {
            let plain = variants.cheapest_program(ResultKind::Responses(rows.len()), |model| {
                let mass = crba::mass_matrix(model, &variants.joints);
                MatrixFactorisation::new(&mass, &variants.joints).constraint_responses(rows)
            });
            let limbs = variants
                .vectorised_mechanisms_for_all_functions()
                .filter_map(|limbs| limb_responses::limb_contact_responses(limbs, rows));
            plain.with_cheapest_lane_variant(cheapest_lane_programs(self.specialisation, limbs))
        })
    }

    /// Returns a contact function, whose contact velocities have these rows, with the version in which
    /// identical limbs are SIMD lanes, if one exists.
    pub(super) fn with_limb_lane_variant(
        &self,
        plain: Program,
        rows: &crba::Matrix<'g>,
        outputs: impl FnOnce(&mut LimbContacts<'_, 'g>) -> Option<Vec<Expr<'g>>>,
    ) -> Program {
        let limbs = self
            .choices
            .first()
            .and_then(|variants| variants.vectorised_mechanisms_for_all_functions().next());
        let mut contacts = limbs.and_then(|limbs| LimbContacts::new(limbs, rows));
        let found = contacts.as_mut().and_then(outputs);
        plain.with_cheapest_lane_variant(found.map(|outputs| self.specialisation.lower_to_program(&outputs)))
    }

    fn best_variant_program(&self, program: impl FnOnce(&ModelVariants<'g>) -> Program) -> Program {
        self.choices.first().map(program).unwrap_or_default()
    }

    /// Returns the program of the variant in which these expressions of model, joints and velocities are
    /// smallest.
    fn smallest_program(
        &self,
        role: ResultKind,
        expressions: impl Fn(&Model<'g>, &[Joint<'g>], &[Expr<'g>]) -> Vec<Expr<'g>>,
    ) -> Program {
        self.best_variant_program(|variants| {
            variants.smallest_program(role, |model| {
                expressions(model, &variants.joints, &mechanics::velocity_symbols(model))
            })
        })
    }

    /// Returns forward dynamics by articulated bodies or by factorisation, whichever takes less time. The
    /// dependency chains of articulated bodies are longer.
    pub(super) fn forward_dynamics(&self) -> Program {
        let articulated: Vec<Candidate<'g>> =
            self.choices.iter().flat_map(ModelVariants::articulated_forward_dynamics_candidates).collect();
        let is_large = self.is_large;
        let factorised: Vec<Candidate<'g>> = match is_large && !articulated.is_empty() {
            true => Vec::new(),
            false => {
                self.choices.iter().flat_map(ModelVariants::factorised_forward_dynamics_candidates).collect()
            }
        };
        let is_larger = smallest_candidate_size(&factorised)
            .is_none_or(|f| smallest_candidate_size(&articulated).is_some_and(|a| f > a));
        let others = articulated.into_iter().filter(|_| is_larger);
        let both = [
            self.specialisation.cheapest_program(factorised.into_iter()),
            self.specialisation.cheapest_program(others),
        ];
        let found = both
            .into_iter()
            .filter(|program| !program.outputs.is_empty())
            .min_by_key(Program::estimated_program_time);
        let in_lanes = cheapest_lane_programs(
            self.specialisation,
            self.choices.iter().flat_map(ModelVariants::articulated_dynamics_in_lanes),
        );
        found.unwrap_or_default().with_cheapest_lane_variant(in_lanes)
    }
}

/// Returns programs of the mass matrix in which identical limbs, or columns, are SIMD lanes.
fn lane_mass_matrix_programs<'g>(
    choices: &[ModelVariants<'g>],
    specialisation: ParameterSpecialisation,
    wide: &[usize],
) -> Vec<Program> {
    let limb_lane_mass_programs = |most| {
        let limb_lane_mass_matrices = move |variants: &ModelVariants<'g>| {
            variants
                .vectorised_mechanisms_for_all_functions()
                .map(|limbs| limb_lanes::mass_matrix(limbs, most))
                .collect::<Vec<_>>()
        };
        cheapest_lane_programs(specialisation, choices.iter().flat_map(limb_lane_mass_matrices))
    };
    let column_lane_mass_programs = |most| {
        let column_lane_mass_matrices = move |variants: &ModelVariants<'g>| {
            let all = variants.variants_for_all_functions();
            all.map(|m| crba::mass_matrix_in_lanes(m, &variants.joints, most).concat()).collect::<Vec<_>>()
        };
        cheapest_lane_programs(specialisation, choices.iter().flat_map(column_lane_mass_matrices))
    };
    [1].iter()
        .chain(wide)
        .flat_map(|most| limb_lane_mass_programs(*most))
        .chain(wide.iter().flat_map(|most| column_lane_mass_programs(*most)))
        .collect()
}

/// Returns the programs with SIMD lanes that may be the cheapest for the outputs.
fn cheapest_lane_programs<'g>(
    specialisation: ParameterSpecialisation,
    lists: impl Iterator<Item = Vec<Expr<'g>>>,
) -> Vec<Program> {
    let programs =
        specialisation.candidate_programs(lists.map(|list| specialisation.candidate_with_size(list)));
    programs.into_iter().map(|(_, program)| program).collect()
}
