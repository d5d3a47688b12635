//! The equations of motion of small mechanisms in normal form, and as text in the user's own names. They are the
//! recursive algorithms' mass matrix and bias, which hold for ball and free joints as they are and are there already;
//! Lagrange's equations are the same polynomials, as a test shows.

use super::crba::Matrix;
use super::{accelerations, constraints, energy, forces, rnea, velocities};
use crate::expr::eval::Tape;
use crate::expr::factor::without_noise;
use crate::expr::normal::Normal;
use crate::expr::polynomial::{Polynomial, Rank, Ring};
use crate::expr::trigonometry::simplified;
use crate::expr::unit::on_unit_sphere;
use crate::expr::{Expr, Function, Node, Symbol};
use crate::kinematics::Joint;
use crate::mechanism::{Chart, Model, Quantity};

#[cfg(test)]
mod tests;
mod written;

pub use written::written;

/// Most operations of the mass matrix, and of all equations, that are multiplied out: a look at them is cheap, and what takes
/// more would be too long.
const OPERATIONS: [usize; 2] = [200, 500];
/// Most terms, of all equations together, that anybody would read.
const READABLE: usize = 150;
/// Most terms before they are shortened.
const LONG: usize = 400;

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

/// The equations of a mechanism; `None` where they would be too long to read. Their length decides, as soon as it is known.
pub fn derive<'g>(model: &Model<'g>, joints: &[Joint<'g>], mass: &Matrix<'g>) -> Option<Equations> {
    let entries: Vec<Expr<'g>> = mass.iter().flatten().copied().collect();
    if entries.is_empty() || Tape::of(&entries).steps() > OPERATIONS[0] {
        return None;
    }
    let bias = rnea::inverse_dynamics(model, joints, &velocities(model), None);
    let right = right_sides(model, joints);
    let kept: Vec<Expr<'g>> = model.constraints.iter().map(|c| c.residual.unwrap_or(c.rate)).collect();
    let all: Vec<Expr<'g>> = entries.iter().chain(&bias).chain(&right).chain(&kept).copied().collect();
    if Tape::of(&all).steps() > OPERATIONS[1] {
        return None;
    }
    let mut normal = Normal::new(model.graph, rank);
    // Angles in the order of `q`, so that sums of them are read in this order.
    for angle in angles(model) {
        normal.of(angle.sin())?;
    }
    let entries = normals(&mut normal, &entries)?;
    let mut motion = normals(&mut normal, &bias)?;
    let (v, a) = (normals(&mut normal, &velocities(model))?, normals(&mut normal, &accelerations(model))?);
    for (k, entry) in entries.iter().enumerate() {
        let (i, j) = (k / model.nv(), k % model.nv());
        let force = normal.ring.times(entry, &a[j])?;
        motion[i] = normal.ring.plus(&motion[i], &force)?;
    }
    let kinetic = kinetic(model, joints, &entries, &v, &mut normal)?;
    let potential = normal.of(energy::potential_energy(model, joints))?;
    let lagrangian = normal.ring.plus(&kinetic, &potential.scaled(-1.0))?;
    let mut forces = normals(&mut normal, &right)?;
    motion.extend(normals(&mut normal, &kept)?);
    forces.resize(motion.len(), Polynomial::default());
    readable(normal.ring, &quaternions(model), lagrangian, motion, forces)
}

/// The components of all unit quaternions.
fn quaternions(model: &Model<'_>) -> Vec<[Symbol; 4]> {
    let firsts = model.charts.iter().filter_map(|chart| match chart {
        Chart::Ball(q, _) => Some(*q),
        Chart::Free(q, _) => Some(q + 3),
        Chart::Plain(..) => None,
    });
    firsts.map(|q| [0, 1, 2, 3].map(|k| Quantity::Configuration(q + k).symbol())).collect()
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
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &[Polynomial],
    v: &[Polynomial],
    normal: &mut Normal<'g>,
) -> Option<Polynomial> {
    if joints.iter().any(|joint| joint.drift.is_some()) {
        return normal.of(energy::kinetic_energy(model, joints, &velocities(model)));
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

/// Shortened, and few enough terms.
fn readable(
    mut ring: Ring,
    quaternions: &[[Symbol; 4]],
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
        let mut p = simplified(&mut ring, &p)?;
        for quaternion in quaternions {
            p = on_unit_sphere(&mut ring, &p, quaternion)?;
        }
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
