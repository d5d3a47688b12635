//! The equations of motion of small mechanisms in normal form, and as text in the user's own names. They are the
//! recursive algorithms' mass matrix and bias, which hold for ball and free joints as they are and are there already;
//! Lagrange's equations are the same polynomials, as a test shows.

use super::crba::Matrix;
use super::kinematics::Joint;
use super::{accelerations, constraints, energy, forces, rnea, velocities};
use crate::expr::factor::without_noise;
use crate::expr::normal::Normal;
use crate::expr::polynomial::{Polynomial, Rank, Ring};
use crate::expr::trigonometry::simplified;
use crate::expr::{Expr, Function, Node, Symbol};
use crate::model::{Model, Quantity};

#[cfg(test)]
mod tests;
mod written;

pub use written::written;

/// Most velocities of a mechanism whose equations are written.
const VELOCITIES: usize = 4;
/// Most moving frames.
const LINKS: usize = 8;
/// Most terms, of all equations together, that anybody would read.
const READABLE: usize = 150;
/// Most terms before they are shortened.
const LONG: usize = 300;

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
}

/// True if the equations are worth trying.
pub fn is_small(model: &Model<'_>) -> bool {
    (1..=VELOCITIES).contains(&model.nv()) && model.links.len() <= LINKS
}

/// The equations of a small mechanism; `None` where they would be too long to read.
pub fn derive<'g>(model: &Model<'g>, joints: &[Joint<'g>], mass: &Matrix<'g>) -> Option<Equations> {
    if !is_small(model) {
        return None;
    }
    let mut normal = Normal::new(model.graph, rank);
    // Angles in the order of `q`, so that sums of them are read in this order.
    for angle in angles(model) {
        normal.of(angle.sin())?;
    }
    let v = velocities(model);
    let mut motion = normals(&mut normal, &rnea::inverse_dynamics(model, joints, &v, None))?;
    let (v, a) = (normals(&mut normal, &v)?, normals(&mut normal, &accelerations(model))?);
    for (i, row) in mass.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let entry = normal.of(*entry)?;
            let force = normal.ring.times(&entry, &a[j])?;
            motion[i] = normal.ring.plus(&motion[i], &force)?;
        }
    }
    let kinetic = kinetic(model, joints, mass, &v, &mut normal)?;
    let potential = normal.of(energy::potential_energy(model, joints))?;
    let lagrangian = normal.ring.plus(&kinetic, &potential.scaled(-1.0))?;
    let mut right = forces::generalized_forces(model, joints);
    let held = constraints::forces(model, &constraints::multipliers(model));
    right.iter_mut().zip(held).for_each(|(force, held)| *force += held);
    let mut forces = normals(&mut normal, &right)?;
    for c in &model.constraints {
        motion.push(normal.of(c.residual.unwrap_or(c.rate))?);
        forces.push(Polynomial::default());
    }
    readable(normal.ring, lagrangian, motion, forces)
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
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    v: &[Polynomial],
    normal: &mut Normal<'g>,
) -> Option<Polynomial> {
    if joints.iter().any(|joint| joint.drift.is_some()) {
        return normal.of(energy::kinetic_energy(model, joints, &velocities(model)));
    }
    let mut twice = Polynomial::default();
    for (i, row) in mass.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let momentum = normal.of(*entry).and_then(|entry| normal.ring.times(&entry, &v[j]))?;
            let energy = normal.ring.times(&momentum, &v[i])?;
            twice = normal.ring.plus(&twice, &energy)?;
        }
    }
    Some(twice.scaled(0.5))
}

fn normals<'g>(normal: &mut Normal<'g>, list: &[Expr<'g>]) -> Option<Vec<Polynomial>> {
    list.iter().map(|e| normal.of(*e)).collect()
}

/// Shortened, and few enough terms.
fn readable(
    mut ring: Ring,
    lagrangian: Polynomial,
    motion: Vec<Polynomial>,
    forces: Vec<Polynomial>,
) -> Option<Equations> {
    let all = || motion.iter().chain(&forces).chain([&lagrangian]);
    if all().map(|p| p.terms.len()).sum::<usize>() > LONG {
        return None;
    }
    let mut left = READABLE;
    let mut short = |p: &Polynomial| {
        let p = without_noise(&ring, p);
        let p = simplified(&mut ring, &p)?;
        left = left.checked_sub(p.terms.len())?;
        p.terms.iter().all(|t| t.coefficient.is_finite()).then_some(p)
    };
    let lagrangian = short(&lagrangian)?;
    let motion = motion.iter().map(&mut short).collect::<Option<_>>()?;
    let forces = forces.iter().map(&mut short).collect::<Option<_>>()?;
    Some(Equations { ring, lagrangian, motion, forces })
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
