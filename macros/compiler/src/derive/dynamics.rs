//! Programs of the functions of dynamics. They are derived from several forms of one model, with equal functions, and
//! the cheapest program is kept.

use super::in_lanes;
use super::specialisation::{Candidate, Specialisation};
use crate::expr::Expr;
use crate::kinematics::Joint;
use crate::lower::Program;
use crate::machine::{COMPARED_OPERATIONS, COMPARED_VELOCITIES};
use crate::mechanics::derivatives::Factor;
use crate::mechanics::passive::passive_forces;
use crate::mechanics::speeds::{InSpeeds, Role};
use crate::mechanics::{
    self, aba, added_mass, constraints, crba, energy, frames, friction, ldl, massless, momentum, rnea,
};
use crate::mechanism::{Model, Quantity};
use crate::passes::{self, Form, Passes};
use crate::vectorise::{self, Limbs};
use std::rc::Rc;

/// Frames in which mass matrix and inverse dynamics are larger by more than one in so many are not tried further.
const SIMILAR: usize = 8;
/// Of a mechanism with many operations, frames are not tried further that are larger by more than one in so many with the first
/// distribution of its masses, which is enough to tell there.
const SIMILAR_AT_FIRST: usize = 24;

/// What dynamics is derived from.
pub(super) struct Dynamics<'g> {
    /// The model's forms with frames of each kind that may be good, the best first.
    kinds: Vec<Forms<'g>>,
    /// Functions are in declared speeds.
    in_speeds: bool,
    /// One algorithm of forward dynamics is taken without comparing.
    is_large: bool,
    specialisation: Specialisation,
    mass_matrix: Program,
    inverse_dynamics: Program,
    bias: Program,
}

impl<'g> Dynamics<'g> {
    /// The forms that the passes give, in moved frames, of a small mechanism also in those as they are, and in common
    /// axes.
    /// With speeds what the algorithms give is written in these.
    pub(super) fn new(
        model: &Model<'g>,
        passes: Passes,
        specialisation: Specialisation,
        speeds: Option<&Rc<InSpeeds<'g>>>,
    ) -> Dynamics<'g> {
        let mut all = Kind::all(model, passes, specialisation, speeds);
        all.sort_by_key(|kind| kind.size);
        if model.nv() > COMPARED_VELOCITIES {
            all.truncate(1);
        }
        let least = all.first().map_or(0, |kind| kind.size);
        let most = least + least / SIMILAR;
        let (mut masses, mut recursions, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
        for kind in all {
            masses.extend(kind.masses);
            recursions.extend(kind.recursions);
            if kind.size <= most {
                kinds.push(kind.forms);
            }
        }
        kinds.iter_mut().for_each(Forms::find_bias);
        let wide = if speeds.is_none() { passes.wide(model.nv()) } else { &[] };
        let wide = mass_matrices_in_lanes(&kinds, specialisation, wide);
        let side_by_side =
            in_lanes_of(specialisation, kinds.iter().flat_map(|forms| forms.recursions_in_lanes(true)));
        let biases = kinds.iter().map(|forms| &forms.bias.program);
        let bias = biases.min_by_key(|p| (p.counts.total(), p.fused_length())).cloned();
        let biases_in_lanes = kinds.iter().filter_map(|forms| Some(forms.bias.simd.as_ref()?.1.clone()));
        Dynamics {
            mass_matrix: specialisation.cheapest(masses.into_iter()).or_in_lanes(wide),
            inverse_dynamics: specialisation.cheapest(recursions.into_iter()).or_in_lanes(side_by_side),
            bias: bias.unwrap_or_default().or_in_lanes(biases_in_lanes),
            is_large: model.nv() > COMPARED_VELOCITIES || least > COMPARED_OPERATIONS,
            kinds,
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
        self.smallest(Role::Scalars, |m, j, v| vec![energy::kinetic_energy(m, j, v)])
    }

    pub(super) fn potential_energy(&self) -> Program {
        self.smallest(Role::Scalars, |m, j, _| vec![energy::potential_energy(m, j)])
    }

    pub(super) fn generalized_momentum(&self) -> Program {
        self.smallest(Role::Forces, momentum::generalized_momentum)
    }

    pub(super) fn momentum_rate(&self) -> Program {
        self.smallest(Role::MomentumRate, |m, j, v| {
            let mut rate = momentum::momentum_rate(m, j, v);
            if self.in_speeds {
                rate.extend(momentum::generalized_momentum(m, j, v));
            }
            rate
        })
    }

    pub(super) fn center_of_mass(&self) -> Program {
        self.smallest(Role::Scalars, |m, j, _| energy::center_of_mass(m, j).0.to_vec())
    }

    pub(super) fn momentum(&self) -> Program {
        self.smallest(Role::Scalars, |m, j, v| frames::flat(&momentum::centroidal_momentum(m, j, v)))
    }

    pub(super) fn centroidal_momentum_matrix(&self) -> Program {
        self.smallest(Role::Columns(6), |m, j, _| momentum::centroidal_momentum_matrix(m, j))
    }

    pub(super) fn centroidal_momentum_bias(&self) -> Program {
        self.smallest(Role::Bias(6), |m, j, v| {
            let mut bias = frames::flat(&momentum::centroidal_bias(m, j, v)).to_vec();
            if self.in_speeds {
                bias.extend(momentum::centroidal_momentum_matrix(m, j));
            }
            bias
        })
    }

    pub(super) fn constrained_dynamics(&self) -> Program {
        self.of_best(Forms::constrained_dynamics)
    }

    pub(super) fn constraint_response(&self) -> Program {
        self.of_best(Forms::constraint_response)
    }

    pub(super) fn slipping_response(&self) -> Program {
        self.of_best(Forms::slipping_response)
    }

    /// What impulses along given rates do to the velocities and to these rates.
    pub(super) fn contact_responses(&self, rows: &crba::Matrix<'g>) -> Program {
        self.of_best(|forms| {
            // Contacts and speeds exclude each other.
            forms.cheapest(Role::Scalars, |model| {
                let mass = crba::mass_matrix(model, &forms.joints);
                Factor::of(&mass, &forms.joints).responses(rows)
            })
        })
    }

    fn of_best(&self, program: impl FnOnce(&Forms<'g>) -> Program) -> Program {
        self.kinds.first().map(program).unwrap_or_default()
    }

    /// The program of the form in which these expressions of model, joints and velocities are the smallest.
    fn smallest(
        &self,
        role: Role,
        expressions: impl Fn(&Model<'g>, &[Joint<'g>], &[Expr<'g>]) -> Vec<Expr<'g>>,
    ) -> Program {
        self.of_best(|forms| {
            forms.smallest(role, |model| expressions(model, &forms.joints, &mechanics::velocities(model)))
        })
    }

    /// Articulated bodies or factorisation, whichever takes less time: the chains of the first are longer.
    pub(super) fn forward_dynamics(&self) -> Program {
        let articulated: Vec<Candidate<'g>> = self.kinds.iter().flat_map(Forms::articulated).collect();
        let is_large = self.is_large;
        let factorised: Vec<Candidate<'g>> = match is_large && !articulated.is_empty() {
            true => Vec::new(),
            false => self.kinds.iter().flat_map(Forms::factorised).collect(),
        };
        let is_larger = smallest(&factorised).is_none_or(|f| smallest(&articulated).is_some_and(|a| f > a));
        let others = articulated.into_iter().filter(|_| is_larger);
        let both =
            [self.specialisation.cheapest(factorised.into_iter()), self.specialisation.cheapest(others)];
        let found = both.into_iter().filter(|program| !program.outputs.is_empty()).min_by_key(Program::time);
        let in_lanes =
            in_lanes_of(self.specialisation, self.kinds.iter().flat_map(Forms::articulated_in_lanes));
        found.unwrap_or_default().or_in_lanes(in_lanes)
    }
}

/// The forms with frames of one kind, with their mass matrices and inverse dynamics.
struct Kind<'g> {
    forms: Forms<'g>,
    masses: Vec<Candidate<'g>>,
    recursions: Vec<Candidate<'g>>,
    /// Of the smallest of both together.
    size: usize,
}

impl<'g> Kind<'g> {
    /// Those with frames of every kind.
    fn all(
        model: &Model<'g>,
        passes: Passes,
        specialisation: Specialisation,
        speeds: Option<&Rc<InSpeeds<'g>>>,
    ) -> Vec<Kind<'g>> {
        let mut kinds = vec![passes::forms(model, passes)];
        if passes.frames && model.nv() <= COMPARED_VELOCITIES {
            kinds.push(passes::forms(model, Passes { frames: false, ..passes }));
        }
        if passes.parallel {
            let common: Vec<Vec<Form<'g>>> =
                kinds.iter().map(|forms| passes::in_common_axes(forms)).collect();
            kinds.extend(common.into_iter().filter(|forms| !forms.is_empty()));
        }
        let mut found: Vec<Kind<'g>> = Vec::new();
        for forms in kinds.into_iter().map(|forms| Forms::new(forms, passes, specialisation, speeds.cloned()))
        {
            if found.first().is_none_or(|first| first.is_similar(&forms)) {
                found.push(Kind::new(forms));
            }
        }
        found
    }

    /// False for frames that cost more, as far as the first distribution of the masses tells; of a mechanism with few operations
    /// all distributions are asked later.
    fn is_similar(&self, forms: &Forms<'g>) -> bool {
        let first = |masses: &[Candidate<'_>], recursions: &[Candidate<'_>]| {
            Some(masses.first()?.size + recursions.first()?.size)
        };
        let own = first(&self.masses, &self.recursions).filter(|own| *own > COMPARED_OPERATIONS);
        own.is_none_or(|own| {
            let [masses, recursions] =
                [forms.mass_matrices().take(1).collect(), forms.recursions(true).take(1).collect::<Vec<_>>()];
            first(&masses, &recursions).is_none_or(|other| other <= own + own / SIMILAR_AT_FIRST)
        })
    }

    fn new(forms: Forms<'g>) -> Kind<'g> {
        let masses: Vec<Candidate<'g>> = forms.mass_matrices().collect();
        let recursions: Vec<Candidate<'g>> = forms.recursions(true).collect();
        let size = smallest(&masses).unwrap_or(0) + smallest(&recursions).unwrap_or(0);
        Kind { forms, masses, recursions, size }
    }
}

/// The size of the smallest outputs.
fn smallest(all: &[Candidate<'_>]) -> Option<usize> {
    all.iter().map(|list| list.size).min()
}

/// Mass matrices in which alike limbs, or columns, are lanes.
fn mass_matrices_in_lanes<'g>(
    kinds: &[Forms<'g>],
    specialisation: Specialisation,
    wide: &[usize],
) -> Vec<Program> {
    let limbs = |most| {
        let of = move |forms: &Forms<'g>| {
            forms.plain_limbs().map(|limbs| in_lanes::mass_matrix(limbs, most)).collect::<Vec<_>>()
        };
        in_lanes_of(specialisation, kinds.iter().flat_map(of))
    };
    let columns = |most| {
        let of = move |forms: &Forms<'g>| {
            let all = forms.plain();
            all.map(|m| crba::mass_matrix_in_lanes(m, &forms.joints, most).concat()).collect::<Vec<_>>()
        };
        in_lanes_of(specialisation, kinds.iter().flat_map(of))
    };
    [1].iter()
        .chain(wide)
        .flat_map(|most| limbs(*most))
        .chain(wide.iter().flat_map(|most| columns(*most)))
        .collect()
}

/// The programs of outputs in lanes that may be the cheapest.
fn in_lanes_of<'g>(
    specialisation: Specialisation,
    lists: impl Iterator<Item = Vec<Expr<'g>>>,
) -> Vec<Program> {
    let programs = specialisation.programs(lists.map(|list| specialisation.sized(list)));
    programs.into_iter().map(|(_, program)| program).collect()
}

/// Forms of a model with the same frames.
struct Forms<'g> {
    all: Vec<Form<'g>>,
    joints: Vec<Joint<'g>>,
    specialisation: Specialisation,
    /// What results are written in, if not in the velocities of the joints.
    speeds: Option<Rc<InSpeeds<'g>>>,
    /// The forms with alike limbs as lanes, and whether they are anchored; none if there are no such limbs.
    limbs: Vec<(Limbs<'g>, bool)>,
    bias: Bias,
}

/// `h`, and the form in which it is cheapest: all forms need the same forces, so that each part of a function can be taken
/// from the form where it is.
#[derive(Default)]
struct Bias {
    program: Program,
    form: usize,
    /// The same with alike limbs as lanes.
    simd: Option<(usize, Program)>,
}

impl<'g> Forms<'g> {
    fn new(
        all: Vec<Form<'g>>,
        passes: Passes,
        specialisation: Specialisation,
        speeds: Option<Rc<InSpeeds<'g>>>,
    ) -> Forms<'g> {
        let joints = all.first().map_or(Vec::new(), |form| form.joints.clone());
        let groups = match all.first() {
            Some(form) if passes.lanes && specialisation == Specialisation::None && speeds.is_none() => {
                vectorise::find(&form.model, &joints)
            }
            _ => Vec::new(),
        };
        let in_lanes = |form: &Form<'g>| {
            let forces = || passive_forces(&form.model, true);
            Some((Limbs::of(&form.model, &joints, &groups, forces)?, form.anchored))
        };
        let limbs = all.iter().filter_map(in_lanes).collect();
        Forms { all, joints, specialisation, speeds, limbs, bias: Bias::default() }
    }

    fn find_bias(&mut self) {
        let (form, program) = self.specialisation.cheapest_of(self.recursions(false));
        let simd = self.recursions_in_lanes(false).map(|list| self.specialisation.sized(list));
        let simd = self.specialisation.programs(simd).into_iter().min_by_key(|(_, program)| program.cost());
        self.bias = Bias { program, form, simd };
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
        role: Role,
        outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>,
    ) -> impl Iterator<Item = Candidate<'g>> {
        self.plain().map(outputs).map(move |list| self.candidate(role, list))
    }

    /// Outputs, written in speeds where there are some.
    fn candidate(&self, role: Role, list: Vec<Expr<'g>>) -> Candidate<'g> {
        match &self.speeds {
            None => self.specialisation.sized(list),
            Some(speeds) => self.specialisation.sized(speeds.results(role, &list)),
        }
    }

    /// The program of the form in which a function of any kind takes the fewest operations.
    fn cheapest(&self, role: Role, outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>) -> Program {
        self.specialisation.cheapest(self.candidates(role, outputs))
    }

    /// The program of the form in which its outputs are the smallest, which is found quicker.
    fn smallest(&self, role: Role, outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>) -> Program {
        let smallest = self.candidates(role, outputs).min_by_key(|list| list.size);
        smallest.map_or_else(Program::default, |list| self.specialisation.program(&list.outputs))
    }

    fn mass_matrices(&self) -> impl Iterator<Item = Candidate<'g>> {
        self.candidates(Role::Metric, |model| crba::mass_matrix(model, &self.joints).concat())
    }

    /// Inverse dynamics, or the bias alone.
    fn recursions(&self, accelerations: bool) -> impl Iterator<Item = Candidate<'g>> {
        self.all.iter().map(move |form| {
            let (v, a) = (mechanics::velocities(&form.model), mechanics::accelerations(&form.model));
            let Some(speeds) = &self.speeds else {
                let a = accelerations.then_some(a.as_slice());
                return self.specialisation.sized(rnea::inverse_dynamics(&form.model, &self.joints, &v, a));
            };
            // At zero rates of the speeds the joints may accelerate.
            let all = rnea::inverse_dynamics(&form.model, &self.joints, &v, Some(&a));
            let all = speeds.results(Role::Forces, &all);
            self.specialisation.sized(if accelerations { all } else { speeds.without_accelerations(&all) })
        })
    }

    fn recursions_in_lanes(&self, accelerations: bool) -> impl Iterator<Item = Vec<Expr<'g>>> {
        self.limbs.iter().map(move |(limbs, _)| in_lanes::inverse_dynamics(limbs, accelerations))
    }

    /// Forward dynamics by articulated bodies.
    fn articulated(&self) -> Vec<Candidate<'g>> {
        let Some(bias) = self.all.get(self.bias.form).map(|form| &form.model) else { return Vec::new() };
        let v = mechanics::velocities(bias);
        let wrenches = rnea::wrenches(bias, &self.joints, &v, None);
        let tau = efforts(bias);
        let all = self.plain().filter_map(|model| {
            let list = aba::forward_dynamics(model, &self.joints, wrenches.clone(), &tau)?;
            Some(self.candidate(Role::Accelerations(0), list))
        });
        all.collect()
    }

    /// The same with alike limbs as lanes.
    fn articulated_in_lanes(&self) -> Vec<Vec<Expr<'g>>> {
        let bias = self.bias.simd.as_ref().and_then(|(k, _)| self.limbs.get(*k));
        let Some((bias, _)) = bias else { return Vec::new() };
        self.plain_limbs().filter_map(|limbs| in_lanes::forward_dynamics(limbs, bias)).collect()
    }

    /// Forward dynamics by factorisation of the mass matrix.
    fn factorised(&self) -> Vec<Candidate<'g>> {
        let r = self.unbalanced();
        let solve = |model: &Model<'g>| {
            let mass = crba::mass_matrix(model, &self.joints);
            match model.acceleration_forces.is_empty() {
                true => ldl::solve(mass, r.clone(), &self.joints),
                false => Factor::of(&added_mass::effective(model, &mass), &self.joints).solve(r.clone()),
            }
        };
        self.candidates(Role::Accelerations(0), solve).collect()
    }

    /// `τ − h`.
    fn unbalanced(&self) -> Vec<Expr<'g>> {
        let Some(bias) = self.all.get(self.bias.form).map(|form| &form.model) else { return Vec::new() };
        let h = rnea::inverse_dynamics(bias, &self.joints, &mechanics::velocities(bias), None);
        efforts(bias).iter().zip(h).map(|(tau, h)| *tau - h).collect()
    }
}

/// For how many multipliers it is told what each of them does.
fn answers(model: &Model<'_>) -> usize {
    if model.is_overdetermined() { model.constraints.len() } else { 0 }
}

/// `τ`.
fn efforts<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    (0..model.nv()).map(|k| Quantity::Force(k).expr(model.graph)).collect()
}

impl<'g> Forms<'g> {
    /// Accelerations and multipliers under the forces `tau`.
    fn constrained_dynamics(&self) -> Program {
        let Some(form) = self.all.first() else { return Program::default() };
        let (force, biases) = (self.unbalanced(), constraints::biases(&form.model));
        if !friction::slipping(&form.model).is_empty() {
            return self.slipping(Role::Accelerations(0), &force, &biases);
        }
        let Some(pivots) = &form.model.dependent else {
            let answers = answers(&form.model);
            return self.multipliers(Role::Accelerations(answers), &force, &biases);
        };
        self.cheapest(Role::Accelerations(0), |model| {
            let mass = crba::mass_matrix(model, &self.joints);
            constraints::solve_by_speeds(model, &mass, &force, biases.clone(), pivots)
        })
    }

    /// The same for forces and biases that are given.
    fn constraint_response(&self) -> Program {
        let Some(form) = self.all.first() else { return Program::default() };
        let (force, bias) = constraints::given(&form.model);
        self.multipliers(Role::Answers(answers(&form.model)), &force, &bias)
    }

    /// The same with friction.
    fn slipping_response(&self) -> Program {
        let Some(form) = self.all.first() else { return Program::default() };
        let (force, bias) = constraints::given(&form.model);
        self.slipping(Role::Answers(0), &force, &bias)
    }

    fn multipliers(&self, role: Role, force: &[Expr<'g>], bias: &[Expr<'g>]) -> Program {
        self.cheapest(role, |model| {
            let rows = constraints::jacobian(model);
            if model.is_overdetermined() {
                let mass = crba::mass_matrix(model, &self.joints);
                return constraints::responses(&mass, &rows, force.to_vec(), bias, &self.joints);
            }
            let (mass, force) = self.loaded(model, force, bias);
            constraints::solve(&mass, &rows, force, bias.to_vec())
        })
    }

    fn slipping(&self, role: Role, force: &[Expr<'g>], bias: &[Expr<'g>]) -> Program {
        self.cheapest(role, |model| {
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
