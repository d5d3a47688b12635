//! The algorithms of dynamics on variants of a model that have the same frames.

use crate::derive::limb_lanes;
use crate::derive::specialisation::{Candidate, Specialisation};
use crate::expr::Expr;
use crate::kinematics::Joint;
use crate::lower::Program;
use crate::mechanics::derivatives::Factor;
use crate::mechanics::passive::passive_forces;
use crate::mechanics::speeds::{InSpeeds, Role};
use crate::mechanics::{self, aba, added_mass, constraints, crba, friction, ldl, massless, rnea};
use crate::mechanism::Model;
use crate::passes::{Passes, Variant};
use crate::vectorise::{self, Limbs};
use std::rc::Rc;

/// Variants of a model with the same frames.
pub struct Variants<'g> {
    all: Vec<Variant<'g>>,
    pub joints: Vec<Joint<'g>>,
    specialisation: Specialisation,
    /// What results are written in, if not in the velocities of the joints.
    speeds: Option<Rc<InSpeeds<'g>>>,
    /// The variants with alike limbs as lanes, and whether they are good for inverse dynamics alone; none if there are no such limbs.
    limbs: Vec<(Limbs<'g>, bool)>,
    pub bias: Bias,
}

/// `h`, and the variant in which it is cheapest: all variants need the same forces, so that each part of a function can be taken
/// from the variant where it is.
#[derive(Default)]
pub struct Bias {
    pub program: Program,
    variant: usize,
    /// The program with alike limbs as lanes, and its variant.
    pub simd: Option<(usize, Program)>,
}

impl<'g> Variants<'g> {
    pub fn new(
        all: Vec<Variant<'g>>,
        passes: Passes,
        specialisation: Specialisation,
        speeds: Option<Rc<InSpeeds<'g>>>,
    ) -> Variants<'g> {
        // All have the same joints.
        let joints = match all.as_slice() {
            [any, ..] => any.joints.clone(),
            [] => Vec::new(),
        };
        let groups = match all.as_slice() {
            [any, ..] if passes.lanes && specialisation == Specialisation::None && speeds.is_none() => {
                vectorise::find(&any.model, &joints)
            }
            _ => Vec::new(),
        };
        let in_lanes = |variant: &Variant<'g>| {
            let forces = || passive_forces(&variant.model, true);
            Some((Limbs::of(&variant.model, &joints, &groups, forces)?, variant.for_inverse_dynamics))
        };
        let limbs = all.iter().filter_map(in_lanes).collect();
        Variants { all, joints, specialisation, speeds, limbs, bias: Bias::default() }
    }

    pub fn find_bias(&mut self) {
        let (variant, program) = self.specialisation.cheapest_of(self.recursions(false));
        let simd = self.recursions_in_lanes(false).map(|list| self.specialisation.sized(list));
        let simd = self.specialisation.programs(simd).into_iter().min_by_key(|(_, program)| program.cost());
        self.bias = Bias { program, variant, simd };
    }

    /// Variants that serve all functions.
    pub fn plain(&self) -> impl Iterator<Item = &Model<'g>> {
        self.all.iter().filter(|variant| !variant.for_inverse_dynamics).map(|variant| &variant.model)
    }

    /// Variants with alike limbs as lanes, but those for inverse dynamics alone.
    pub fn plain_limbs(&self) -> impl Iterator<Item = &Limbs<'g>> {
        self.limbs.iter().filter(|(_, for_inverse_dynamics)| !for_inverse_dynamics).map(|(limbs, _)| limbs)
    }

    /// The outputs of a function of any role, variant by variant.
    pub fn candidates(
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

    /// The program of the variant in which a function of any role takes the fewest operations.
    pub fn cheapest(&self, role: Role, outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>) -> Program {
        self.specialisation.cheapest(self.candidates(role, outputs))
    }

    /// The program of the variant in which its outputs are the smallest, which is found quicker.
    pub fn smallest(&self, role: Role, outputs: impl FnMut(&Model<'g>) -> Vec<Expr<'g>>) -> Program {
        let smallest = self.candidates(role, outputs).min_by_key(|list| list.size);
        smallest.map_or_else(Program::default, |list| self.specialisation.program(&list.outputs))
    }

    pub fn mass_matrices(&self) -> impl Iterator<Item = Candidate<'g>> {
        self.candidates(Role::Metric, |model| crba::mass_matrix(model, &self.joints).concat())
    }

    /// Inverse dynamics, or the bias alone.
    pub fn recursions(&self, accelerations: bool) -> impl Iterator<Item = Candidate<'g>> {
        self.all.iter().map(move |variant| {
            let (v, a) = (mechanics::velocities(&variant.model), mechanics::accelerations(&variant.model));
            let Some(speeds) = &self.speeds else {
                let a = accelerations.then_some(a.as_slice());
                return self.specialisation.sized(rnea::inverse_dynamics(
                    &variant.model,
                    &self.joints,
                    &v,
                    a,
                ));
            };
            // At zero rates of the speeds the joints may accelerate.
            let all = rnea::inverse_dynamics(&variant.model, &self.joints, &v, Some(&a));
            let all = speeds.results(Role::Forces, &all);
            self.specialisation.sized(if accelerations { all } else { speeds.without_accelerations(&all) })
        })
    }

    pub fn recursions_in_lanes(&self, accelerations: bool) -> impl Iterator<Item = Vec<Expr<'g>>> {
        self.limbs.iter().map(move |(limbs, _)| limb_lanes::inverse_dynamics(limbs, accelerations))
    }

    /// Forward dynamics by articulated bodies.
    pub fn articulated(&self) -> Vec<Candidate<'g>> {
        let Some(bias) = self.all.get(self.bias.variant).map(|variant| &variant.model) else {
            return Vec::new();
        };
        let v = mechanics::velocities(bias);
        let wrenches = rnea::wrenches(bias, &self.joints, &v, None);
        let tau = mechanics::efforts(bias);
        let all = self.plain().filter_map(|model| {
            let list = aba::forward_dynamics(model, &self.joints, wrenches.clone(), &tau)?;
            Some(self.candidate(Role::Accelerations(0), list))
        });
        all.collect()
    }

    /// Forward dynamics by articulated bodies, with alike limbs as lanes.
    pub fn articulated_in_lanes(&self) -> Vec<Vec<Expr<'g>>> {
        let bias = self.bias.simd.as_ref().and_then(|(k, _)| self.limbs.get(*k));
        let Some((bias, _)) = bias else { return Vec::new() };
        self.plain_limbs().filter_map(|limbs| limb_lanes::forward_dynamics(limbs, bias)).collect()
    }

    /// Forward dynamics by factorisation of the mass matrix.
    pub fn factorised(&self) -> Vec<Candidate<'g>> {
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
        let Some(bias) = self.all.get(self.bias.variant).map(|variant| &variant.model) else {
            return Vec::new();
        };
        let h = rnea::inverse_dynamics(bias, &self.joints, &mechanics::velocities(bias), None);
        mechanics::efforts(bias).iter().zip(h).map(|(tau, h)| *tau - h).collect()
    }
}

/// For how many multipliers it is told what each of them does.
fn answers(model: &Model<'_>) -> usize {
    if model.is_overdetermined() { model.constraints.len() } else { 0 }
}

impl<'g> Variants<'g> {
    /// Accelerations and multipliers under the forces `tau`.
    pub fn constrained_dynamics(&self) -> Program {
        let [variant, ..] = self.all.as_slice() else { return Program::default() };
        let (force, biases) = (self.unbalanced(), constraints::biases(&variant.model));
        if !friction::slipping(&variant.model).is_empty() {
            return self.slipping(Role::Accelerations(0), &force, &biases);
        }
        let Some(pivots) = &variant.model.dependent else {
            let answers = answers(&variant.model);
            return self.multipliers(Role::Accelerations(answers), &force, &biases);
        };
        self.cheapest(Role::Accelerations(0), |model| {
            let mass = crba::mass_matrix(model, &self.joints);
            constraints::solve_by_speeds(model, &mass, &force, biases.clone(), pivots)
        })
    }

    /// The response of constraints to given forces and biases.
    pub fn constraint_response(&self) -> Program {
        let [variant, ..] = self.all.as_slice() else { return Program::default() };
        let (force, bias) = constraints::given(&variant.model);
        self.multipliers(Role::Answers(answers(&variant.model)), &force, &bias)
    }

    /// The response of constraints that slip, with friction, to given forces and biases.
    pub fn slipping_response(&self) -> Program {
        let [variant, ..] = self.all.as_slice() else { return Program::default() };
        let (force, bias) = constraints::given(&variant.model);
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
