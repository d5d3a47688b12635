//! The functions of the option `sensitivities`: derivatives of the motion with respect to the parameters.

use super::specialisation::ParameterSpecialisation;
use crate::expr::Expr;
use crate::kinematics;
use crate::lower::Program;
use crate::machine::DERIVATIVES_COMPARED;
use crate::mechanics::{self, derivatives::parameters};
use crate::mechanism::Model;
use crate::passes::{self, ModelVariant, PassSelection};

/// The model, or the cheapest of its variants, from which both functions are derived.
pub(super) struct SensitivityDerivation<'g> {
    variant: Option<ModelVariant<'g>>,
    inverse: Program,
    specialisation: ParameterSpecialisation,
}

impl<'g> SensitivityDerivation<'g> {
    pub(super) fn new(
        model: &Model<'g>,
        passes: PassSelection,
        specialisation: ParameterSpecialisation,
    ) -> SensitivityDerivation<'g> {
        // Passive forces as symbols hide their dependence on the parameters, so the elements themselves are
        // differentiated.
        let model = &Model { passive: None, ..model.clone() };
        let mut variants = if model.nv() <= DERIVATIVES_COMPARED {
            passes::model_variants(model, passes)
        } else {
            Vec::new()
        };
        variants.retain(|variant| !variant.for_inverse_dynamics);
        variants.push(ModelVariant {
            joints: kinematics::joints_of_model(model),
            model: model.clone(),
            for_inverse_dynamics: false,
        });
        if passes.parallel {
            variants.extend(passes::variants_in_common_axes(&variants));
        }
        let parameter_derivatives_program = |variant: &ModelVariant<'_>| {
            specialisation
                .lower_to_program(&parameters::inverse_dynamics(&variant.model, &variant.joints).concat())
        };
        let all = variants.into_iter().map(|variant| {
            let program = parameter_derivatives_program(&variant);
            (variant, program)
        });
        let best = all.min_by_key(|(_, program)| program.counts.total_operations());
        let (variant, inverse) = best.map_or((None, Program::default()), |(variant, p)| (Some(variant), p));
        SensitivityDerivation { variant, inverse, specialisation }
    }

    pub(super) fn inverse_dynamics_sensitivities(&self) -> Program {
        self.inverse.clone()
    }

    pub(super) fn forward_dynamics_sensitivities(&self) -> Program {
        let accelerations = self.variant.as_ref().map_or_else(Vec::new, acceleration_sensitivities);
        self.specialisation.lower_to_program(&accelerations.concat())
    }
}

fn acceleration_sensitivities<'g>(variant: &ModelVariant<'g>) -> Vec<Vec<Expr<'g>>> {
    let model = &variant.model;
    parameters::forward_dynamics(model, &variant.joints, &mechanics::generalized_force_symbols(model))
}
