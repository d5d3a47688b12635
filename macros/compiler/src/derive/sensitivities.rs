//! The functions of the word `sensitivities`: how the motion depends on the parameters.

use super::Stage;
use super::signatures::{self, Sizes};
use crate::emit::Function;
use crate::expr::Expr;
use crate::mechanics;
use crate::mechanics::derivatives::parameters;
use crate::model::{Model, Quantity};
use crate::passes::{self, Form, Passes};

/// Up to how many velocities several forms of the model are tried.
const SMALL: usize = 10;

/// Both, from the model as it is or one of its forms, whichever costs less. Under constraints the accelerations depend
/// on multipliers as well; there the forces alone have derivatives.
pub(super) fn functions(model: &Model<'_>, passes: Passes, stage: Stage) -> Vec<Function> {
    let mut forms = if model.nv() <= SMALL { passes::forms(model, passes) } else { Vec::new() };
    forms.retain(|form| !form.anchored);
    forms.push(Form { joints: mechanics::joints(model), model: model.clone(), anchored: false });
    if passes.parallel {
        forms.extend(passes::in_common_axes(&forms));
    }
    let inverse =
        |form: &Form<'_>| stage.program(&parameters::inverse_dynamics(&form.model, &form.joints).concat());
    let best =
        forms.iter().map(|form| (form, inverse(form))).min_by_key(|(_, program)| program.counts.total());
    let Some((form, program)) = best else { return Vec::new() };
    let mut functions = signatures::sensitivities(&Sizes::of(model), model.parameters.len());
    functions.retain(|f| model.constraints.is_empty() || f.name == "inverse_dynamics_by_parameters");
    for f in &mut functions {
        f.program = match f.name.as_str() {
            "inverse_dynamics_by_parameters" => program.clone(),
            _ => stage.program(&accelerations(form).concat()),
        };
    }
    functions
}

fn accelerations<'g>(form: &Form<'g>) -> Vec<Vec<Expr<'g>>> {
    let model = &form.model;
    let tau: Vec<Expr<'g>> = (0..model.nv()).map(|k| Quantity::Force(k).expr(model.graph)).collect();
    parameters::forward_dynamics(model, &form.joints, &tau)
}
