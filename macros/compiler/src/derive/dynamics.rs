//! Programs of the functions of dynamics. They are derived from several forms of one model, with equal functions, and
//! the cheapest program is kept.

use super::{Candidate, Stage, in_lanes};
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
    bias: Choice,
}

/// A program, and the forms it was derived from: one of all, and one of those with alike limbs as lanes if there are
/// any.
struct Choice {
    program: Program,
    form: usize,
    limbs: Option<usize>,
}

impl<'g> Dynamics<'g> {
    /// The forms that the passes give; of a small mechanism, in the frames as they are or in the moved ones, whichever
    /// cost less.
    pub(super) fn new(model: &Model<'g>, passes: Passes, stage: Stage) -> Dynamics<'g> {
        let mut all = vec![Forms::new(model, passes, stage)];
        if passes.frames && model.nv() <= COMPARE {
            all.push(Forms::new(model, Passes { frames: false, ..passes }, stage));
        }
        let mass = Compared::of(&all, |forms| forms.mass_matrices().collect());
        let inverse = Compared::of(&all, |forms| forms.recursions(true).collect());
        let mass_matrix = mass.program.or_in_lanes(all[mass.best].mass_matrices_in_lanes());
        let in_lanes = stage.programs(all[inverse.best].recursions_in_lanes(true));
        let inverse_dynamics = inverse.program.or_in_lanes(in_lanes.into_iter().map(|(_, program)| program));
        let best = (0..all.len()).min_by_key(|k| mass.sizes[*k] + inverse.sizes[*k]).unwrap_or(0);
        let forms = all.swap_remove(best);
        let bias = forms.bias();
        Dynamics { forms, mass_matrix, inverse_dynamics, bias }
    }

    /// The program of a function; `None` if it is none of dynamics.
    pub(super) fn program(&self, name: &str) -> Option<Program> {
        let expressions: fn(&Model<'g>, &[Joint<'g>], &[Expr<'g>]) -> Vec<Expr<'g>> = match name {
            "mass_matrix" => return Some(self.mass_matrix.clone()),
            "inverse_dynamics" => return Some(self.inverse_dynamics.clone()),
            "bias_forces" => return Some(self.bias.program.clone()),
            "forward_dynamics" => return Some(self.forms.forward_dynamics(&self.bias)),
            "__constrained_dynamics" => return Some(self.forms.constrained_dynamics(&self.bias)),
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
        Some(self.forms.smallest(|model| expressions(model, joints, &mechanics::velocities(model))))
    }
}

/// A function derived with frames of several kinds.
struct Compared {
    /// Of the smallest outputs with frames of each kind.
    sizes: Vec<usize>,
    /// The kind that the program is of.
    best: usize,
    program: Program,
}

impl Compared {
    fn of<'g>(all: &[Forms<'g>], outputs: impl Fn(&Forms<'g>) -> Vec<Candidate<'g>>) -> Compared {
        let (mut sizes, mut kinds, mut lists) = (Vec::new(), Vec::new(), Vec::new());
        for (kind, forms) in all.iter().enumerate() {
            let own = outputs(forms);
            sizes.push(own.iter().map(|list| list.size).min().unwrap_or(0));
            kinds.extend(own.iter().map(|_| kind));
            lists.extend(own);
        }
        let (k, program) =
            all.first().map(|forms| forms.stage.cheapest(lists.into_iter())).unwrap_or_default();
        Compared { sizes, best: kinds.get(k).copied().unwrap_or(0), program }
    }
}

/// Forms of a model with the same frames.
struct Forms<'g> {
    all: Vec<Form<'g>>,
    joints: Vec<Joint<'g>>,
    stage: Stage,
    /// The forms with alike limbs as lanes, and whether they are anchored; none if there are no such limbs.
    limbs: Vec<(Limbs<'g>, bool)>,
    /// In how many lanes columns are tried, beside none.
    wide: &'static [usize],
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
        Forms {
            wide: passes.wide(model.nv()),
            limbs: all.iter().filter_map(in_lanes).collect(),
            all,
            joints,
            stage,
        }
    }

    /// Forms that serve all functions.
    fn plain(&self) -> impl Iterator<Item = &Model<'g>> {
        self.all.iter().filter(|form| !form.anchored).map(|form| &form.model)
    }

    /// The same with alike limbs as lanes.
    fn plain_limbs(&self) -> impl Iterator<Item = &Limbs<'g>> {
        self.limbs.iter().filter(|(_, anchored)| !anchored).map(|(limbs, _)| limbs)
    }

    /// The outputs of a function of any kind, form by form.
    fn candidates(
        &self,
        outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>,
    ) -> impl Iterator<Item = Candidate<'g>> {
        self.plain().map(outputs).map(|list| self.stage.sized(list))
    }

    /// The program of the form in which a function of any kind takes the fewest operations.
    fn cheapest(&self, outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>) -> Program {
        self.stage.cheapest(self.candidates(outputs)).1
    }

    /// The program of the form in which its outputs are the smallest, which is found quicker.
    fn smallest(&self, outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>) -> Program {
        let smallest = self.candidates(outputs).min_by_key(|list| list.size);
        smallest.map_or_else(Program::default, |list| self.stage.program(&list.outputs))
    }

    fn mass_matrices(&self) -> impl Iterator<Item = Candidate<'g>> {
        self.candidates(|model| crba::mass_matrix(model, &self.joints).concat())
    }

    /// Those in which alike limbs, or columns, are lanes.
    fn mass_matrices_in_lanes(&self) -> Vec<Program> {
        let mut all = self.programs(self.plain_limbs().map(|limbs| in_lanes::mass_matrix(limbs, 1)));
        for most in self.wide {
            all.extend(self.programs(self.plain_limbs().map(|limbs| in_lanes::mass_matrix(limbs, *most))));
            let columns = |model: &Model<'g>| crba::mass_matrix_in_lanes(model, &self.joints, *most).concat();
            all.extend(self.programs(self.plain().map(columns)));
        }
        all
    }

    /// Inverse dynamics, or the bias alone.
    fn recursions(&self, accelerations: bool) -> impl Iterator<Item = Candidate<'g>> {
        self.all.iter().map(move |form| {
            let (v, a) = (mechanics::velocities(&form.model), mechanics::accelerations(&form.model));
            let a = accelerations.then_some(a.as_slice());
            self.stage.sized(rnea::inverse_dynamics(&form.model, &self.joints, &v, a))
        })
    }

    fn recursions_in_lanes(&self, accelerations: bool) -> impl Iterator<Item = Candidate<'g>> {
        let all = self.limbs.iter().map(move |(limbs, _)| in_lanes::inverse_dynamics(limbs, accelerations));
        all.map(|list| self.stage.sized(list))
    }

    fn programs(&self, lists: impl Iterator<Item = Vec<Expr<'g>>>) -> Vec<Program> {
        let programs = self.stage.programs(lists.map(|list| self.stage.sized(list)));
        programs.into_iter().map(|(_, program)| program).collect()
    }

    fn bias(&self) -> Choice {
        let (form, program) = self.stage.cheapest(self.recursions(false));
        let in_lanes = self.stage.programs(self.recursions_in_lanes(false));
        let in_lanes = in_lanes.into_iter().min_by_key(|(_, program)| program.cost());
        let limbs = in_lanes.as_ref().map(|(k, _)| *k);
        Choice { program: program.or_in_lanes(in_lanes.map(|(_, program)| program)), form, limbs }
    }

    /// Forward dynamics, also with alike limbs as lanes.
    fn forward_dynamics(&self, bias: &Choice) -> Program {
        let program = self.forward_dynamics_alone(bias);
        let Some((bias, _)) = bias.limbs.and_then(|k| self.limbs.get(k)) else { return program };
        let all = self.plain_limbs().filter_map(|limbs| in_lanes::forward_dynamics(limbs, bias));
        program.or_in_lanes(self.programs(all))
    }

    /// The cheaper of articulated bodies and factorisation. Of two that are about equal the factorisation is taken: its
    /// divisions wait less for each other.
    fn forward_dynamics_alone(&self, bias: &Choice) -> Program {
        // All forms need the same forces, so that each part can be taken from the form where it is cheapest.
        let Some(bias) = self.all.get(bias.form).map(|form| &form.model) else { return Program::default() };
        let v = mechanics::velocities(bias);
        let tau: Vec<Expr<'g>> = (0..bias.nv()).map(|k| Quantity::Force(k).expr(bias.graph)).collect();
        let wrenches = rnea::wrenches(bias, &self.joints, &v, None);
        let articulated = self
            .plain()
            .filter_map(|model| aba::forward_dynamics(model, &self.joints, wrenches.clone(), &tau));
        let articulated: Vec<Candidate<'g>> = articulated.map(|list| self.stage.sized(list)).collect();
        if !articulated.is_empty() && bias.nv() > COMPARE {
            return self.stage.cheapest(articulated.into_iter()).1;
        }
        let h = rnea::inverse_dynamics(bias, &self.joints, &v, None);
        let r: Vec<Expr<'g>> = tau.iter().zip(h).map(|(tau, h)| *tau - h).collect();
        let factorised = self
            .candidates(|model| ldl::solve(crba::mass_matrix(model, &self.joints), r.clone(), &self.joints));
        let factorised: Vec<Candidate<'g>> = factorised.collect();
        let size = |all: &[Candidate<'g>]| all.iter().map(|list| list.size).min();
        let is_shorter =
            size(&articulated).is_some_and(|a| size(&factorised).is_none_or(|f| f * 20 > a * 21));
        self.stage.cheapest(if is_shorter { articulated } else { factorised }.into_iter()).1
    }
}

impl<'g> Forms<'g> {
    /// Accelerations and multipliers under the forces `tau`.
    fn constrained_dynamics(&self, bias: &Choice) -> Program {
        let Some(bias) = self.all.get(bias.form).map(|form| &form.model) else { return Program::default() };
        let v = mechanics::velocities(bias);
        let h = rnea::inverse_dynamics(bias, &self.joints, &v, None);
        let tau = (0..bias.nv()).map(|k| Quantity::Force(k).expr(bias.graph));
        let force: Vec<Expr<'g>> = tau.zip(h).map(|(tau, h)| tau - h).collect();
        let biases = constraints::biases(bias);
        if !friction::slipping(bias).is_empty() {
            return self.slipping(&force, &biases);
        }
        let Some(pivots) = &bias.dependent else { return self.multipliers(&force, &biases) };
        self.cheapest(|model| {
            let mass = crba::mass_matrix(model, &self.joints);
            constraints::solve_by_speeds(model, &mass, &force, biases.clone(), pivots)
        })
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
        self.cheapest(|model| {
            let rows = constraints::jacobian(model);
            if model.is_overdetermined() {
                let mass = crba::mass_matrix(model, &self.joints);
                return constraints::responses(&mass, &rows, force.to_vec(), bias, &self.joints);
            }
            let (mass, force) = self.loaded(model, force, bias);
            constraints::solve(model, &mass, &rows, force, bias.to_vec())
        })
    }

    fn slipping(&self, force: &[Expr<'g>], bias: &[Expr<'g>]) -> Program {
        self.cheapest(|model| {
            let (mass, force) = self.loaded(model, force, bias);
            friction::solve(model, &mass, force, bias.to_vec())
        })
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
