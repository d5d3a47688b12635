//! Programs of the functions of dynamics. They are derived from several forms of one model, with equal functions, and
//! the cheapest program is kept.

use super::{Stage, done, in_lanes};
use crate::expr::Expr;
use crate::lower::Program;
use crate::mechanics::{
    self, Joint, aba, constraints, crba, energy, frames, friction, ldl, massless, momentum, rnea,
};
use crate::model::{Model, Quantity};
use crate::passes::limbs::{self, Limbs};
use crate::passes::{self, Form, Passes};

/// Up to how many velocities both frames, and both algorithms of forward dynamics, are derived and compared.
const COMPARE: usize = 18;

/// What dynamics is derived from.
pub(super) struct Dynamics<'g> {
    forms: Forms<'g>,
    mass_matrix: Program,
    inverse_dynamics: Program,
}

impl<'g> Dynamics<'g> {
    /// The forms that the passes give; of a small mechanism, in the frames as they are or in the moved ones, whichever
    /// cost less.
    pub(super) fn new(model: &Model<'g>, passes: Passes, stage: Stage) -> Dynamics<'g> {
        let moved = Dynamics::of(Forms::new(model, passes, stage));
        if !passes.frames || model.nv() > COMPARE {
            return moved;
        }
        let still = Dynamics::of(Forms::new(model, Passes { frames: false, ..passes }, stage));
        let total = |d: &Dynamics<'g>| d.mass_matrix.counts.total() + d.inverse_dynamics.counts.total();
        Dynamics {
            forms: if total(&still) < total(&moved) { still.forms } else { moved.forms },
            mass_matrix: cheapest([moved.mass_matrix, still.mass_matrix].into_iter()),
            inverse_dynamics: cheapest([moved.inverse_dynamics, still.inverse_dynamics].into_iter()),
        }
    }

    fn of(forms: Forms<'g>) -> Dynamics<'g> {
        let (mass_matrix, inverse_dynamics) = (forms.mass_matrix(), forms.recursion(true));
        Dynamics { forms, mass_matrix, inverse_dynamics }
    }

    /// The program of a function; `None` if it is none of dynamics.
    pub(super) fn program(&self, name: &str) -> Option<Program> {
        let expressions: fn(&Model<'g>, &[Joint<'g>], &[Expr<'g>]) -> Vec<Expr<'g>> = match name {
            "mass_matrix" => return Some(self.mass_matrix.clone()),
            "inverse_dynamics" => return Some(self.inverse_dynamics.clone()),
            "bias_forces" => return Some(self.forms.recursion(false)),
            "forward_dynamics" => return Some(self.forms.forward_dynamics()),
            "__constrained_dynamics" => return Some(self.forms.constrained_dynamics()),
            "__constraint_correction" => return Some(self.forms.constraint_correction()),
            "__slipping_response" => return Some(self.forms.slipping_response()),
            "kinetic_energy" => |m, j, v| vec![energy::kinetic_energy(m, j, v)],
            "potential_energy" => |m, j, _| vec![energy::potential_energy(m, j)],
            "generalized_momentum" => |m, j, v| momentum::generalized_momentum(m, j, v),
            "momentum_rate" => |m, j, v| momentum::momentum_rate(m, j, v),
            "center_of_mass" => |m, j, _| energy::center_of_mass(m, j).0.to_vec(),
            "momentum" => |m, j, v| frames::flat(&momentum::centroidal_momentum(m, j, v)),
            "centroidal_momentum_matrix" => |m, j, _| momentum::centroidal_momentum_matrix(m, j),
            "centroidal_momentum_bias" => |m, j, v| frames::flat(&momentum::centroidal_bias(m, j, v)),
            _ => return None,
        };
        let joints = &self.forms.joints;
        Some(cheapest(self.forms.plain().map(|model| {
            let v = mechanics::velocities(model);
            self.forms.stage.program(&expressions(model, joints, &v))
        })))
    }
}

/// Forms of a model with the same frames.
struct Forms<'g> {
    all: Vec<Form<'g>>,
    joints: Vec<Joint<'g>>,
    stage: Stage,
    /// The forms with alike limbs as lanes, and whether they are anchored; none if there are no such limbs.
    limbs: Vec<(Limbs<'g>, bool)>,
}

impl<'g> Forms<'g> {
    fn new(model: &Model<'g>, passes: Passes, stage: Stage) -> Forms<'g> {
        let all = passes::forms(model, passes);
        let joints = all.first().map_or(Vec::new(), |form| mechanics::joints(&form.model));
        let groups = match all.first() {
            Some(form) if passes.lanes && stage == Stage::Whole => limbs::find(&form.model, &joints),
            _ => Vec::new(),
        };
        let in_lanes = |form: &Form<'g>| Some((Limbs::of(&form.model, &joints, &groups)?, form.anchored));
        Forms { limbs: all.iter().filter_map(in_lanes).collect(), all, joints, stage }
    }

    /// Forms that serve all functions.
    fn plain(&self) -> impl Iterator<Item = &Model<'g>> {
        self.all.iter().filter(|form| !form.anchored).map(|form| &form.model)
    }

    /// The same with alike limbs as lanes.
    fn plain_limbs(&self) -> impl Iterator<Item = &Limbs<'g>> {
        self.limbs.iter().filter(|(_, anchored)| !anchored).map(|(limbs, _)| limbs)
    }

    fn mass_matrix(&self) -> Program {
        let program = cheapest(
            self.plain().map(|model| self.stage.program(&crba::mass_matrix(model, &self.joints).concat())),
        );
        program.or_in_lanes(self.plain_limbs().map(|limbs| done(&in_lanes::mass_matrix(limbs))))
    }

    /// Inverse dynamics, or the bias alone.
    fn recursion(&self, accelerations: bool) -> Program {
        let program = cheapest(self.all.iter().map(|form| self.recursion_of(&form.model, accelerations)));
        program.or_in_lanes(
            self.limbs.iter().map(|(limbs, _)| done(&in_lanes::inverse_dynamics(limbs, accelerations))),
        )
    }

    fn recursion_of(&self, model: &Model<'g>, accelerations: bool) -> Program {
        let v = mechanics::velocities(model);
        let a = accelerations.then(|| mechanics::accelerations(model));
        self.stage.program(&rnea::inverse_dynamics(model, &self.joints, &v, a.as_deref()))
    }

    /// Forward dynamics, also with alike limbs as lanes.
    fn forward_dynamics(&self) -> Program {
        let program = self.forward_dynamics_alone();
        let bias =
            self.limbs.iter().min_by_key(|(limbs, _)| cost(&done(&in_lanes::inverse_dynamics(limbs, false))));
        let Some((bias, _)) = bias else { return program };
        program.or_in_lanes(
            self.plain_limbs().filter_map(|limbs| Some(done(&in_lanes::forward_dynamics(limbs, bias)?))),
        )
    }

    /// The cheaper of articulated bodies and factorisation. Of two that are about equal the factorisation is taken: its
    /// divisions wait less for each other.
    fn forward_dynamics_alone(&self) -> Program {
        // All forms need the same forces, so that each part can be taken from the form where it is cheapest.
        let bias = self.all.iter().min_by_key(|form| cost(&self.recursion_of(&form.model, false)));
        let Some(bias) = bias.map(|form| &form.model) else { return Program::default() };
        let v = mechanics::velocities(bias);
        let tau: Vec<Expr<'g>> = (0..bias.nv()).map(|k| Quantity::Force(k).expr(bias.graph)).collect();
        let wrenches = rnea::wrenches(bias, &self.joints, &v, None);
        let articulated = self.plain().filter_map(|model| {
            let a = aba::forward_dynamics(model, &self.joints, wrenches.clone(), &tau)?;
            Some(self.stage.program(&a))
        });
        let articulated = articulated.min_by_key(cost);
        if let Some(program) = &articulated
            && bias.nv() > COMPARE
        {
            return program.clone();
        }
        let h = rnea::inverse_dynamics(bias, &self.joints, &v, None);
        let r: Vec<Expr<'g>> = tau.iter().zip(h).map(|(tau, h)| *tau - h).collect();
        let factorised = cheapest(self.plain().map(|model| {
            let mass = crba::mass_matrix(model, &self.joints);
            self.stage.program(&ldl::solve(mass, r.clone(), &self.joints))
        }));
        match articulated {
            Some(program) if factorised.counts.total() * 20 > program.counts.total() * 21 => program,
            _ => factorised,
        }
    }
}

impl<'g> Forms<'g> {
    /// Accelerations and multipliers under the forces `tau`.
    fn constrained_dynamics(&self) -> Program {
        let bias = self.all.iter().min_by_key(|form| cost(&self.recursion_of(&form.model, false)));
        let Some(bias) = bias.map(|form| &form.model) else { return Program::default() };
        let v = mechanics::velocities(bias);
        let h = rnea::inverse_dynamics(bias, &self.joints, &v, None);
        let tau = (0..bias.nv()).map(|k| Quantity::Force(k).expr(bias.graph));
        let force: Vec<Expr<'g>> = tau.zip(h).map(|(tau, h)| tau - h).collect();
        let biases = constraints::biases(bias);
        if !friction::slipping(bias).is_empty() {
            return self.slipping(&force, &biases);
        }
        let Some(pivots) = &bias.dependent else { return self.multipliers(&force, &biases) };
        cheapest(self.plain().map(|model| {
            let mass = crba::mass_matrix(model, &self.joints);
            self.stage.program(&constraints::solve_by_speeds(model, &mass, &force, biases.clone(), pivots))
        }))
    }

    /// The same for forces and biases that are given.
    fn constraint_correction(&self) -> Program {
        let Some(form) = self.all.first() else { return Program::default() };
        let (force, bias) = constraints::given(&form.model);
        self.multipliers(&force, &bias)
    }

    /// The same with friction.
    fn slipping_response(&self) -> Program {
        let Some(form) = self.all.first() else { return Program::default() };
        let (force, bias) = constraints::given(&form.model);
        self.slipping(&force, &bias)
    }

    fn multipliers(&self, force: &[Expr<'g>], bias: &[Expr<'g>]) -> Program {
        cheapest(self.plain().map(|model| {
            let rows = constraints::jacobian(model);
            if model.is_overdetermined() {
                let mass = crba::mass_matrix(model, &self.joints);
                let parts = constraints::responses(&mass, &rows, force.to_vec(), bias, &self.joints);
                return self.stage.program(&parts);
            }
            let (mass, force) = self.loaded(model, force, bias);
            self.stage.program(&constraints::solve(model, &mass, &rows, force, bias.to_vec()))
        }))
    }

    fn slipping(&self, force: &[Expr<'g>], bias: &[Expr<'g>]) -> Program {
        cheapest(self.plain().map(|model| {
            let (mass, force) = self.loaded(model, force, bias);
            self.stage.program(&friction::solve(model, &mass, force, bias.to_vec()))
        }))
    }

    /// Mass matrix and forces with what makes up for coordinates without inertia.
    fn loaded(
        &self,
        model: &Model<'g>,
        force: &[Expr<'g>],
        bias: &[Expr<'g>],
    ) -> (crba::Matrix<'g>, Vec<Expr<'g>>) {
        let mass = crba::mass_matrix(model, &self.joints);
        let force = massless::loaded_force(model, &self.joints, force, bias);
        (massless::loaded_mass(model, &self.joints, mass), force)
    }
}

fn cheapest(programs: impl Iterator<Item = Program>) -> Program {
    programs.min_by_key(cost).unwrap_or_default()
}

/// Operations, and of equally many the instructions that are left when products are fused into sums.
fn cost(program: &Program) -> (usize, usize) {
    (program.counts.total(), program.instructions.len())
}
