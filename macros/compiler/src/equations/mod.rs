//! The equations of motion of small mechanisms in normal form, and as text in the user's own names. They are the
//! recursive algorithms' mass matrix and bias, which hold for ball and free joints as they are and are there already;
//! Lagrange's equations are the same polynomials, as a test shows.

use crate::algebra::factor::without_noise;
use crate::algebra::normal::Normal;
use crate::algebra::polynomial::{Atom, Polynomial, Rank, Ring};
use crate::algebra::trigonometry::simplified;
use crate::algebra::unit::on_unit_sphere;
use crate::expr::eval::Tape;
use crate::expr::{Expr, Function, Node, Symbol, Vec3};
use crate::kinematics::Joint;
use crate::kinematics::speeds::quaternions;
use crate::mechanics::crba::Matrix;
use crate::mechanics::speeds::InSpeeds;
use crate::mechanics::{accelerations, added_mass, constraints, energy, forces, rnea, velocities};
use crate::mechanism::{Model, Quantity};

mod canonical;
pub mod kane;
pub mod linear;
pub mod print;
pub mod reduced;
#[cfg(test)]
mod tests;
mod written;

pub use canonical::{Canonical, canonical, determinant};
pub use print::Written;
pub use written::{written, written_canonical};

/// How much is multiplied out and written.
pub struct Limits {
    /// Most operations of the mass matrix, and of all equations, that are multiplied out: a look at them is cheap, and what takes
    /// more would be too long.
    operations: [usize; 2],
    /// Most terms, of all equations together.
    terms: usize,
    /// Most terms before they are shortened.
    long: usize,
}

/// Maximum number of written terms, those in arguments of functions and in divisors included, relative to the maximum number
/// of terms alone. An argument that itself has functions of functions is written out wherever it occurs.
const NESTED_TERMS: usize = 20;

impl Limits {
    /// What anybody would read.
    pub const READABLE: Limits = Limits { operations: [200, 500], terms: 150, long: 400 };
    /// What is written for those who ask.
    pub const ASKED: Limits = Limits { operations: [2000, 5000], terms: 3000, long: 8000 };
    /// What anybody would read, in declared speeds: most of what is multiplied out cancels.
    pub const READABLE_IN_SPEEDS: Limits = Limits { operations: [2000, 5000], terms: 150, long: 8000 };
}

/// The equations of a mechanism as polynomials of one ring.
pub struct Equations {
    /// The atoms.
    pub ring: Ring,
    /// `L = T − U`.
    pub lagrangian: Polynomial,
    /// `M v̇ + h`, by velocity; then what the constraints keep at zero.
    pub motion: Vec<Polynomial>,
    /// What the inputs and the multipliers contribute, by velocity; then zeros.
    pub forces: Vec<Polynomial>,
    /// With declared speeds: the velocities of joints that they replace, by index, as they follow from the speeds.
    pub rates: Vec<(usize, Polynomial)>,
    /// Forces stand as a name for each velocity, and the Lagrangian is the kinetic energy alone.
    pub without_forces: bool,
}

/// The equations of a mechanism; `None` where they would be longer than the limits. Their length decides, as soon as it is known.
///
/// With declared speeds they are Kane's: those of the joints' velocities, exchanged.
pub fn derive<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    speeds: Option<&InSpeeds<'g>>,
    limits: &Limits,
) -> Option<Equations> {
    let metric = |mass: &Matrix<'g>| speeds.map_or_else(|| mass.clone(), |speeds| speeds.metric(mass));
    let entries: Vec<Expr<'g>> = metric(mass).concat();
    if entries.is_empty() || Tape::of(&entries).steps() > limits.operations[0] {
        return None;
    }
    let bias = bias(model, joints, speeds);
    let mut right = right_sides(model, joints);
    let mut constraints = &model.constraints;
    if let Some(speeds) = speeds {
        right = speeds.forces(&right);
        constraints = &speeds.model.constraints;
    }
    let kept: Vec<Expr<'g>> = constraints.iter().map(|c| c.residual.unwrap_or(c.rate)).collect();
    let all: Vec<Expr<'g>> = entries.iter().chain(&bias).chain(&right).chain(&kept).copied().collect();
    if Tape::of(&all).steps() > limits.operations[1] {
        return None;
    }
    let mut normal = Normal::new(model.graph, rank);
    if limits.long > Limits::READABLE.long {
        normal.ring.allow_more();
    }
    // Angles in the order of `q`, so that sums of them are read in this order.
    for angle in angles(model) {
        normal.of(angle.sin())?;
    }
    let entries = normals(&mut normal, &entries)?;
    let mut motion = normals(&mut normal, &bias)?;
    let (v, a) = (normals(&mut normal, &velocities(model))?, normals(&mut normal, &accelerations(model))?);
    let effective: Vec<Expr<'g>> = metric(&added_mass::effective(model, mass)).concat();
    let effective = if model.acceleration_forces.is_empty() {
        entries.clone()
    } else {
        normals(&mut normal, &effective)?
    };
    for (k, entry) in effective.iter().enumerate() {
        let (i, j) = (k / model.nv(), k % model.nv());
        let force = normal.ring.times(entry, &a[j])?;
        motion[i] = normal.ring.plus(&motion[i], &force)?;
    }
    let kinetic = kinetic((model, speeds), joints, &entries, &v, &mut normal)?;
    let potential = normal.of(energy::potential_energy(model, joints))?;
    let lagrangian = normal.ring.plus(&kinetic, &potential.scaled(-1.0))?;
    let mut forces = normals(&mut normal, &right)?;
    motion.extend(normals(&mut normal, &kept)?);
    forces.resize(motion.len(), Polynomial::default());
    let replaced: Vec<usize> = speeds.map_or_else(Vec::new, InSpeeds::replaced);
    let mut rates = Vec::new();
    for (k, speeds) in replaced.into_iter().filter_map(|k| Some((k, speeds?))) {
        rates.push((k, normal.of(speeds.rates[k])?));
    }
    let found = Equations { ring: Ring::new(rank), lagrangian, motion, forces, rates, without_forces: false };
    shortened(Short::new(normal.ring, quaternions(model), limits), found)
}

/// The equations of a mechanism without constraints whose forces are too long to be read: inertia alone, of a body in space
/// Euler's equations. `None` where that is too long as well.
pub fn derive_inertia<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    limits: &Limits,
) -> Option<Equations> {
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
        let symbol = found.ring.atom(Atom::Symbol(Quantity::Force(k).symbol()))?;
        *force = Polynomial::single(symbol, 1.0);
    }
    found.without_forces = true;
    Some(found)
}

/// `h`, or what stands for it with declared speeds.
fn bias<'g>(model: &Model<'g>, joints: &[Joint<'g>], speeds: Option<&InSpeeds<'g>>) -> Vec<Expr<'g>> {
    let v = velocities(model);
    let Some(speeds) = speeds else { return rnea::inverse_dynamics(model, joints, &v, None) };
    let all = rnea::inverse_dynamics(model, joints, &v, Some(&accelerations(model)));
    speeds.without_accelerations(&speeds.forces(&all))
}

/// What the inputs and the multipliers contribute, by velocity.
fn right_sides<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let held = constraints::forces(model, &constraints::multipliers(model));
    let forces = forces::generalized_forces(model, joints);
    forces.into_iter().zip(held).map(|(force, held)| force + held).collect()
}

/// The coordinates of which sines or cosines are taken somewhere.
fn angles<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    let nodes = model.graph.nodes();
    let mut angle = vec![false; model.nq()];
    for node in nodes.iter() {
        if let Node::Call(Function::Sin | Function::Cos, argument) = node
            && let Node::Symbol(symbol) = nodes[*argument as usize]
            && let Quantity::Configuration(k) = Quantity::of(symbol)
            && let Some(angle) = angle.get_mut(k)
        {
            *angle = true;
        }
    }
    drop(nodes);
    let of_angles = (0..model.nq()).filter(|k| angle[*k]);
    of_angles.map(|k| Quantity::Configuration(k).expr(model.graph)).collect()
}

/// Kinetic energy: `½ vᵀ M v`, which is there already, unless something is driven in time.
fn kinetic<'g>(
    (model, speeds): (&Model<'g>, Option<&InSpeeds<'g>>),
    joints: &[Joint<'g>],
    mass: &[Polynomial],
    v: &[Polynomial],
    normal: &mut Normal<'g>,
) -> Option<Polynomial> {
    if joints.iter().any(|joint| joint.drift.is_some()) {
        let energy = energy::kinetic_energy(model, joints, &velocities(model));
        return normal.of(speeds.map_or(energy, |speeds| speeds.written(&[energy])[0]));
    }
    let mut twice = Polynomial::default();
    for (k, entry) in mass.iter().enumerate() {
        let momentum = normal.ring.times(entry, &v[k % v.len()])?;
        let energy = normal.ring.times(&momentum, &v[k / v.len()])?;
        twice = normal.ring.plus(&twice, &energy)?;
    }
    Some(twice.scaled(0.5))
}

fn normals<'g>(normal: &mut Normal<'g>, list: &[Expr<'g>]) -> Option<Vec<Polynomial>> {
    list.iter().map(|e| normal.of(*e)).collect()
}

/// Shortens polynomials, as long as there are few enough terms.
struct Short {
    ring: Ring,
    quaternions: Vec<[Symbol; 4]>,
    long: usize,
    /// Terms that may still be added.
    left: usize,
    /// Written terms that may still be added.
    written_left: usize,
}

impl Short {
    fn new(ring: Ring, quaternions: Vec<[Symbol; 4]>, limits: &Limits) -> Short {
        let written_left = limits.terms * NESTED_TERMS;
        Short { ring, quaternions, long: limits.long, left: limits.terms, written_left }
    }

    fn of(&mut self, p: &Polynomial) -> Option<Polynomial> {
        let p = without_noise(&self.ring, p);
        let mut p = simplified(&mut self.ring, &p)?;
        for quaternion in &self.quaternions {
            p = on_unit_sphere(&mut self.ring, &p, quaternion)?;
        }
        self.left = self.left.checked_sub(p.terms.len())?;
        self.written_left = self.written_left.checked_sub(self.ring.written_terms(&p))?;
        p.terms.iter().all(|t| t.coefficient.is_finite()).then_some(p)
    }
}

/// Shortened, and few enough terms.
fn shortened(mut short: Short, found: Equations) -> Option<Equations> {
    let Equations { lagrangian, motion, forces, rates, without_forces, .. } = found;
    let all = || motion.iter().chain(&forces).chain([&lagrangian]);
    if all().map(|p| p.terms.len()).sum::<usize>() > short.long {
        return None;
    }
    let lagrangian = short.of(&lagrangian)?;
    let motion = motion.iter().map(|p| short.of(p)).collect::<Option<_>>()?;
    let forces = forces.iter().map(|p| short.of(p)).collect::<Option<_>>()?;
    let rates = rates.iter().map(|(k, p)| Some((*k, short.of(p)?))).collect::<Option<_>>()?;
    Some(Equations { ring: short.ring, lagrangian, motion, forces, rates, without_forces })
}

fn rank(symbol: Symbol) -> Rank {
    match Quantity::of(symbol) {
        Quantity::Configuration(_) | Quantity::Time => Rank::Position,
        Quantity::Velocity(_) => Rank::Rate,
        Quantity::Acceleration(_) => Rank::Acceleration,
        Quantity::Input(_) => Rank::Input,
        _ => Rank::Parameter,
    }
}
