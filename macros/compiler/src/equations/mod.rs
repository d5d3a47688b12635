//! Equations of motion of small mechanisms in normal form, and as text with the user's names. They consist of
//! the mass matrix and bias forces of the recursive algorithms, which are already computed and need no
//! adaptation for ball and free joints. A test shows that Lagrange's equations are the same polynomials.

use crate::algebra::factor::remove_rounding_noise;
use crate::algebra::normal::NormalFormCache;
use crate::algebra::polynomial::{Atom, AtomRank, Polynomial, Ring};
use crate::algebra::trigonometry::simplify_trigonometry;
use crate::algebra::unit::simplify_on_unit_sphere;
use crate::expr::eval::Tape;
use crate::expr::{Expr, Function, Node, Symbol, Vec3};
use crate::kinematics::Joint;
use crate::kinematics::speeds::quaternion_symbols;
use crate::mechanics::crba::Matrix;
use crate::mechanics::speeds::SpeedTransformation;
use crate::mechanics::{
    acceleration_symbols, added_mass, constraints, energy, forces, rnea, velocity_symbols,
};
use crate::mechanism::{Model, Quantity};

mod canonical;
pub mod kane;
pub mod linear;
pub mod print;
pub mod reduced;
#[cfg(test)]
mod tests;
mod written;

pub use canonical::{CanonicalEquations, canonical_equations, determinant_symbol};
pub use print::PrintedEquations;
pub use written::{format_canonical_equations, format_equations};

/// Limits on the length of printed equations.
pub struct EquationSizeLimits {
    /// Maximum number of operations of the mass matrix, and of all equations, that are expanded to
    /// polynomials. Counting operations is cheap, and the polynomials of longer expressions would be too
    /// long.
    operations: [usize; 2],
    /// Maximum number of terms of all printed equations together.
    terms: usize,
    /// Maximum number of terms of the equations before simplification.
    long: usize,
}

/// Limit of the terms that are printed, including those in arguments of functions and in divisors, as a
/// multiple of `Limits::terms`. An argument with nested functions counts each time it is printed.
const NESTED_TERMS: usize = 20;

impl EquationSizeLimits {
    /// Limits of equations that are readable in documentation.
    pub const READABLE: EquationSizeLimits =
        EquationSizeLimits { operations: [200, 500], terms: 150, long: 400 };
    /// Limits for equations that the user requests.
    pub const ASKED: EquationSizeLimits =
        EquationSizeLimits { operations: [2000, 5000], terms: 3000, long: 8000 };
    /// Limits of a readable text in generalized speeds: most of the expanded terms cancel.
    pub const READABLE_IN_SPEEDS: EquationSizeLimits =
        EquationSizeLimits { operations: [2000, 5000], terms: 150, long: 8000 };
}

/// Equations of motion of a mechanism as polynomials of one ring.
pub struct EquationsOfMotion {
    /// Ring of all polynomials.
    pub ring: Ring,
    /// Lagrangian `L = T − U`.
    pub lagrangian: Polynomial,
    /// Left sides of the equations of motion: `M v̇ + h` for each velocity, then the residual or rate of each
    /// constraint.
    pub motion: Vec<Polynomial>,
    /// Right sides of the equations of motion: forces of inputs and multipliers for each velocity, then zeros
    /// for the constraints.
    pub forces: Vec<Polynomial>,
    /// Joint velocities that generalized speeds replace, with their indices, in terms of the speeds.
    pub rates: Vec<(usize, Polynomial)>,
    /// True if forces are symbols, one for each velocity, and `lagrangian` is the kinetic energy alone.
    pub without_forces: bool,
}

/// Derives the equations of motion of a mechanism. `None` if they exceed the limits, which are checked as
/// early as possible.
///
/// With declared generalized speeds these are Kane's equations: the equations in joint velocities,
/// transformed.
pub fn derive<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    speeds: Option<&SpeedTransformation<'g>>,
    limits: &EquationSizeLimits,
) -> Option<EquationsOfMotion> {
    let mass_matrix_in_speeds =
        |mass: &Matrix<'g>| speeds.map_or_else(|| mass.clone(), |speeds| speeds.transform_mass_matrix(mass));
    let entries: Vec<Expr<'g>> = mass_matrix_in_speeds(mass).concat();
    if entries.is_empty() || Tape::new(&entries).node_count() > limits.operations[0] {
        return None;
    }
    let bias = bias_of_equations(model, joints, speeds);
    let mut right = right_sides(model, joints);
    let mut constraints = &model.constraints;
    if let Some(speeds) = speeds {
        right = speeds.transform_forces(&right);
        constraints = &speeds.model.constraints;
    }
    let kept: Vec<Expr<'g>> = constraints.iter().map(|c| c.residual.unwrap_or(c.rate)).collect();
    let all: Vec<Expr<'g>> = entries.iter().chain(&bias).chain(&right).chain(&kept).copied().collect();
    if Tape::new(&all).node_count() > limits.operations[1] {
        return None;
    }
    let mut normal = NormalFormCache::new(model.graph, rank_of_symbol);
    if limits.long > EquationSizeLimits::READABLE.long {
        normal.ring.raise_term_limits();
    }
    // Angles in the order of `q`, so that sums of angles are printed in this order.
    for angle in trigonometric_coordinates(model) {
        normal.normal_form(angle.sin())?;
    }
    let entries = normal_forms(&mut normal, &entries)?;
    let mut motion = normal_forms(&mut normal, &bias)?;
    let (v, a) = (
        normal_forms(&mut normal, &velocity_symbols(model))?,
        normal_forms(&mut normal, &acceleration_symbols(model))?,
    );
    let effective: Vec<Expr<'g>> =
        mass_matrix_in_speeds(&added_mass::effective_mass_matrix(model, mass)).concat();
    let effective = if model.acceleration_forces.is_empty() {
        entries.clone()
    } else {
        normal_forms(&mut normal, &effective)?
    };
    for (k, entry) in effective.iter().enumerate() {
        let (i, j) = (k / model.nv(), k % model.nv());
        let force = normal.ring.multiply_and_reduce(entry, &a[j])?;
        motion[i] = normal.ring.add_within_limits(&motion[i], &force)?;
    }
    let kinetic = kinetic_energy_polynomial((model, speeds), joints, &entries, &v, &mut normal)?;
    let potential = normal.normal_form(energy::potential_energy(model, joints))?;
    let lagrangian = normal.ring.add_within_limits(&kinetic, &potential.multiplied_by_number(-1.0))?;
    let mut forces = normal_forms(&mut normal, &right)?;
    motion.extend(normal_forms(&mut normal, &kept)?);
    forces.resize(motion.len(), Polynomial::default());
    let replaced: Vec<usize> = speeds.map_or_else(Vec::new, SpeedTransformation::replaced_velocity_indices);
    let mut rates = Vec::new();
    for (k, speeds) in replaced.into_iter().filter_map(|k| Some((k, speeds?))) {
        rates.push((k, normal.normal_form(speeds.rates[k])?));
    }
    let found = EquationsOfMotion {
        ring: Ring::new(rank_of_symbol),
        lagrangian,
        motion,
        forces,
        rates,
        without_forces: false,
    };
    simplify_equations(Simplifier::new(normal.ring, quaternion_symbols(model), limits), found)
}

/// Derives the equations of a mechanism without constraints whose forces are too long to be readable: only
/// the inertial terms, which for a free body are Euler's equations, with a symbol for each force. `None` if
/// these are too long as well.
pub fn derive_inertial_terms<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    limits: &EquationSizeLimits,
) -> Option<EquationsOfMotion> {
    if !model.constraints.is_empty() {
        return None;
    }
    let zero = model.graph.zero();
    let bare = Model {
        gravity: Vec3([zero; 3]),
        springs: Vec::new(),
        dashpots: Vec::new(),
        frictions: Vec::new(),
        potentials: Vec::new(),
        dissipations: Vec::new(),
        loads: Vec::new(),
        acceleration_forces: Vec::new(),
        passive: None,
        inputs: Vec::new(),
        ..model.clone()
    };
    let mut found = derive(&bare, joints, mass, None, limits)?;
    for (k, force) in found.forces.iter_mut().enumerate() {
        let symbol = found.ring.intern_atom_as_monomial(Atom::Symbol(Quantity::Force(k).symbol()))?;
        *force = Polynomial::from_term(symbol, 1.0);
    }
    found.without_forces = true;
    Some(found)
}

/// Returns the bias forces `h`, or the terms without accelerations of the equations in generalized speeds.
fn bias_of_equations<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    speeds: Option<&SpeedTransformation<'g>>,
) -> Vec<Expr<'g>> {
    let v = velocity_symbols(model);
    let Some(speeds) = speeds else { return rnea::inverse_dynamics(model, joints, &v, None) };
    let all = rnea::inverse_dynamics(model, joints, &v, Some(&acceleration_symbols(model)));
    speeds.without_accelerations(&speeds.transform_forces(&all))
}

/// Returns the right sides of the equations of motion: generalized forces of inputs and multipliers.
fn right_sides<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let held = constraints::constraint_forces(model, &constraints::multiplier_argument_symbols(model));
    let forces = forces::generalized_forces_of_inputs(model, joints);
    forces.into_iter().zip(held).map(|(force, held)| force + held).collect()
}

/// Returns the coordinates whose sine or cosine occurs in the graph.
fn trigonometric_coordinates<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    let nodes = model.graph.nodes();
    let mut angle = vec![false; model.nq()];
    for node in nodes.iter() {
        if let Node::Call(Function::Sin | Function::Cos, argument) = node
            && let Node::Symbol(symbol) = nodes[*argument as usize]
            && let Quantity::Configuration(k) = Quantity::from_symbol(symbol)
            && let Some(angle) = angle.get_mut(k)
        {
            *angle = true;
        }
    }
    drop(nodes);
    let of_angles = (0..model.nq()).filter(|k| angle[*k]);
    of_angles.map(|k| Quantity::Configuration(k).expr(model.graph)).collect()
}

/// Returns the kinetic energy: `½ vᵀ M v` from the given mass matrix, unless the mechanism is driven in time.
fn kinetic_energy_polynomial<'g>(
    (model, speeds): (&Model<'g>, Option<&SpeedTransformation<'g>>),
    joints: &[Joint<'g>],
    mass: &[Polynomial],
    v: &[Polynomial],
    normal: &mut NormalFormCache<'g>,
) -> Option<Polynomial> {
    if joints.iter().any(|joint| joint.drift.is_some()) {
        let energy = energy::kinetic_energy(model, joints, &velocity_symbols(model));
        return normal.normal_form(speeds.map_or(energy, |speeds| speeds.express_in_speeds(&[energy])[0]));
    }
    let mut twice = Polynomial::default();
    for (k, entry) in mass.iter().enumerate() {
        let momentum = normal.ring.multiply_and_reduce(entry, &v[k % v.len()])?;
        let energy = normal.ring.multiply_and_reduce(&momentum, &v[k / v.len()])?;
        twice = normal.ring.add_within_limits(&twice, &energy)?;
    }
    Some(twice.multiplied_by_number(0.5))
}

fn normal_forms<'g>(normal: &mut NormalFormCache<'g>, list: &[Expr<'g>]) -> Option<Vec<Polynomial>> {
    list.iter().map(|e| normal.normal_form(*e)).collect()
}

/// Simplifies polynomials within a maximum total number of terms.
struct Simplifier {
    ring: Ring,
    quaternions: Vec<[Symbol; 4]>,
    long: usize,
    /// Number of terms that may still be added to polynomials.
    left: usize,
    /// Number of printed terms that may still be added.
    written_left: usize,
}

impl Simplifier {
    fn new(ring: Ring, quaternions: Vec<[Symbol; 4]>, limits: &EquationSizeLimits) -> Simplifier {
        let written_left = limits.terms * NESTED_TERMS;
        Simplifier { ring, quaternions, long: limits.long, left: limits.terms, written_left }
    }

    fn shorten_polynomial(&mut self, p: &Polynomial) -> Option<Polynomial> {
        let p = remove_rounding_noise(&self.ring, p);
        let mut p = simplify_trigonometry(&mut self.ring, &p)?;
        for quaternion in &self.quaternions {
            p = simplify_on_unit_sphere(&mut self.ring, &p, quaternion)?;
        }
        self.left = self.left.checked_sub(p.terms.len())?;
        self.written_left = self.written_left.checked_sub(self.ring.printed_term_count(&p))?;
        p.terms.iter().all(|t| t.coefficient.is_finite()).then_some(p)
    }
}

/// Simplifies all equations of motion. Returns `None` if they are too long.
fn simplify_equations(mut short: Simplifier, found: EquationsOfMotion) -> Option<EquationsOfMotion> {
    let EquationsOfMotion { lagrangian, motion, forces, rates, without_forces, .. } = found;
    let all_polynomials = || motion.iter().chain(&forces).chain([&lagrangian]);
    if all_polynomials().map(|p| p.terms.len()).sum::<usize>() > short.long {
        return None;
    }
    let lagrangian = short.shorten_polynomial(&lagrangian)?;
    let motion = motion.iter().map(|p| short.shorten_polynomial(p)).collect::<Option<_>>()?;
    let forces = forces.iter().map(|p| short.shorten_polynomial(p)).collect::<Option<_>>()?;
    let rates = rates.iter().map(|(k, p)| Some((*k, short.shorten_polynomial(p)?))).collect::<Option<_>>()?;
    Some(EquationsOfMotion { ring: short.ring, lagrangian, motion, forces, rates, without_forces })
}

fn rank_of_symbol(symbol: Symbol) -> AtomRank {
    match Quantity::from_symbol(symbol) {
        Quantity::Configuration(_) | Quantity::Time => AtomRank::Position,
        Quantity::Velocity(_) => AtomRank::Rate,
        Quantity::Acceleration(_) => AtomRank::Acceleration,
        Quantity::Input(_) => AtomRank::Input,
        _ => AtomRank::Parameter,
    }
}
