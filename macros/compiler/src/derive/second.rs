//! Derivation of the functions of the option `second_derivatives`.

use super::derivatives::{DIFFERENTIATE, entries_by_column};
use super::specialisation::ParameterSpecialisation;
use crate::expr::Expr;
use crate::kinematics::Joint;
use crate::lower::Program;
use crate::mechanics::derivatives::second::{self, ConstraintHessian, Hessian, InputPowerHessian};
use crate::mechanism::Model;

/// Returns the second derivatives of inverse dynamics, by recursion (also in each of the lane counts `wide`)
/// or by differentiation.
pub(super) fn inverse_dynamics_second_derivatives<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    wide: &[usize],
    specialisation: ParameterSpecialisation,
) -> Program {
    // Passive forces as symbols hide their dependence on the state, so the elements themselves are
    // differentiated.
    let model = &Model { passive: None, ..model.clone() };
    let hessian_blocks_in_lanes = |most: usize| {
        second::hessian_by_recursion(model, joints, most).map(|found| state_hessian_blocks(&found).concat())
    };
    let Some(plain) = hessian_blocks_in_lanes(1) else {
        return specialisation.lower_to_program(
            &state_hessian_blocks(&second::hessian_by_differentiation(model, joints)).concat(),
        );
    };
    let candidates = match model.nv() <= DIFFERENTIATE {
        true => {
            vec![plain, state_hessian_blocks(&second::hessian_by_differentiation(model, joints)).concat()]
        }
        false => vec![plain],
    };
    let program = specialisation
        .cheapest_program(candidates.into_iter().map(|list| specialisation.candidate_with_size(list)));
    let wide = wide
        .iter()
        .filter_map(|most| Some(specialisation.lower_to_program(&hessian_blocks_in_lanes(*most)?)));
    program.with_cheapest_lane_variant(wide)
}

/// Returns the second derivatives of the power of the input forces.
pub(super) fn input_power_hessian<'g>(
    model: &Model<'g>,
    tau: &[Expr<'g>],
    specialisation: ParameterSpecialisation,
) -> Program {
    let InputPowerHessian { state: by_state, qu, vu, uu } = second::hessian_of_input_power(model, tau);
    let [qq, qv, vv, _] = state_hessian_blocks(&by_state);
    let blocks = [qq, qv, vv, entries_by_column(&qu), entries_by_column(&vu), entries_by_column(&uu)];
    specialisation.lower_to_program(&blocks.concat())
}

/// Returns the second derivatives of the terms that constraints add to the equations of motion.
pub(super) fn constraint_hessian(model: &Model<'_>, specialisation: ParameterSpecialisation) -> Program {
    let ConstraintHessian { state: by_state, q_lambda } = second::hessian_of_constraints(model);
    let mut outputs = state_hessian_blocks(&by_state).concat();
    outputs.extend(entries_by_column(&q_lambda));
    specialisation.lower_to_program(&outputs)
}

/// Returns the blocks of the state and the accelerations, each column by column.
pub(super) fn state_hessian_blocks<'g>(found: &Hessian<'g>) -> [Vec<Expr<'g>>; 4] {
    [&found.qq, &found.qv, &found.vv, &found.qa].map(entries_by_column)
}
