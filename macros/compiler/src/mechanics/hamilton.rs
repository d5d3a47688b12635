//! Hamilton's form of the equations: the energy and the canonical equations as functions of configuration and
//! momentum (Goldstein, Poole and Safko, *Classical Mechanics*, 2002, ch. 8). For ball and free joints the
//! momenta are body components, and the equations are the Lie–Poisson equations.

use super::crba::Matrix;
use super::{energy, ldl, momentum};
use crate::expr::Expr;
use crate::expr::replace::substitute_symbols_in_all;
use crate::kinematics::Joint;
use crate::mechanism::{Model, Quantity};

/// Hamilton's equations as functions of `q` and the generalized momenta.
pub struct HamiltonEquations<'g> {
    /// Hamiltonian `H = p·v − T + U`.
    pub hamiltonian: Expr<'g>,
    /// Joint velocities `v` as functions of the momenta.
    pub velocity: Vec<Expr<'g>>,
    /// Momentum rates `ṗ` under the forces `τ`.
    pub momentum_rate: Vec<Expr<'g>>,
}

/// Solves `p = M v + p₀` for the velocities and inserts them into the energy and the rates, where `p₀` is the
/// momentum due to motion that is prescribed in time.
pub fn derive<'g>(model: &Model<'g>, joints: &[Joint<'g>], mass: &Matrix<'g>) -> HamiltonEquations<'g> {
    let g = model.graph;
    let zero = vec![g.zero(); model.nv()];
    let p: Vec<Expr<'g>> = (0..model.nv()).map(|k| Quantity::Momentum(k).expr(g)).collect();
    let driven = replace_velocities(&momentum::generalized_momentum(model, joints, &zero), &zero);
    let relative = p.iter().zip(&driven).map(|(p, driven)| *p - *driven).collect();
    let velocity = ldl::solve_symmetric(mass.clone(), relative, joints);
    let power = p.iter().zip(&velocity).fold(g.zero(), |sum, (p, v)| sum + *p * *v);
    let potential = energy::potential_energy(model, joints);
    let hamiltonian = if !model.time {
        power * 0.5 + potential
    } else {
        power - energy::kinetic_energy(model, joints, &velocity) + potential
    };
    let mut rate = momentum::momentum_rate_without_inputs(model, joints, &velocity);
    rate.iter_mut().enumerate().for_each(|(k, rate)| *rate += Quantity::Force(k).expr(g));
    let hamiltonian = replace_velocities(&[hamiltonian], &velocity)[0];
    HamiltonEquations { hamiltonian, momentum_rate: replace_velocities(&rate, &velocity), velocity }
}

/// Returns expressions with the velocity symbols replaced by `v`. Elements' energies and forces contain the
/// velocity symbols of the mechanism.
fn replace_velocities<'g>(e: &[Expr<'g>], v: &[Expr<'g>]) -> Vec<Expr<'g>> {
    substitute_symbols_in_all(e, &|s| match Quantity::from_symbol(s) {
        Quantity::Velocity(k) => Some(v[k]),
        _ => None,
    })
}
