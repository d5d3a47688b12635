//! The functions of the word `sensitivities`: how the motion depends on the parameters.

use super::specialisation::Specialisation;
use crate::expr::Expr;
use crate::kinematics;
use crate::lower::Program;
use crate::machine::DERIVATIVES_COMPARED;
use crate::mechanics::derivatives::parameters;
use crate::mechanism::{Model, Quantity};
use crate::passes::{self, Form, Passes};

/// What both functions are derived from: the model as it is or one of its forms, whichever costs less.
pub(super) struct Sensitivities<'g> {
    form: Option<Form<'g>>,
    inverse: Program,
    specialisation: Specialisation,
}

impl<'g> Sensitivities<'g> {
    pub(super) fn new(
        model: &Model<'g>,
        passes: Passes,
        specialisation: Specialisation,
    ) -> Sensitivities<'g> {
        // Given forces do not show what they depend on.
        let model = &Model { passive: None, ..model.clone() };
        let mut forms =
            if model.nv() <= DERIVATIVES_COMPARED { passes::forms(model, passes) } else { Vec::new() };
        forms.retain(|form| !form.anchored);
        forms.push(Form { joints: kinematics::joints(model), model: model.clone(), anchored: false });
        if passes.parallel {
            forms.extend(passes::in_common_axes(&forms));
        }
        let inverse = |form: &Form<'_>| {
            specialisation.program(&parameters::inverse_dynamics(&form.model, &form.joints).concat())
        };
        let all = forms.into_iter().map(|form| {
            let program = inverse(&form);
            (form, program)
        });
        let best = all.min_by_key(|(_, program)| program.counts.total());
        let (form, inverse) = best.map_or((None, Program::default()), |(form, p)| (Some(form), p));
        Sensitivities { form, inverse, specialisation }
    }

    pub(super) fn inverse_dynamics(&self) -> Program {
        self.inverse.clone()
    }

    pub(super) fn forward_dynamics(&self) -> Program {
        let accelerations = self.form.as_ref().map_or_else(Vec::new, accelerations);
        self.specialisation.program(&accelerations.concat())
    }
}

fn accelerations<'g>(form: &Form<'g>) -> Vec<Vec<Expr<'g>>> {
    let model = &form.model;
    let tau: Vec<Expr<'g>> = (0..model.nv()).map(|k| Quantity::Force(k).expr(model.graph)).collect();
    parameters::forward_dynamics(model, &form.joints, &tau)
}
