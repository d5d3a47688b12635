//! Printed form of Hamilton's equations: the Hamiltonian, and the rates of coordinates and momenta.

use super::{EquationSizeLimits, Simplifier, quaternion_symbols, rank_of_symbol};
use crate::algebra::normal::NormalFormCache;
use crate::algebra::polynomial::{Polynomial, Ring};
use crate::expr::replace::substitute_symbols_in_all;
use crate::expr::sample::always_equals_number;
use crate::expr::{Expr, Symbol};
use crate::kinematics::{Joint, symbols_in};
use crate::mechanics::crba::Matrix;
use crate::mechanics::{energy, forces, momentum};
use crate::mechanism::{Model, Quantity};

/// Hamilton's canonical equations as polynomials of one ring, with the momenta as arguments.
pub struct CanonicalEquations {
    /// Ring of all polynomials.
    pub ring: Ring,
    /// Hamiltonian `H` as a polynomial.
    pub hamiltonian: Polynomial,
    /// Joint velocities in terms of the momenta.
    pub velocity: Vec<Polynomial>,
    /// Rates of the momenta, including the forces of inputs.
    pub momentum_rate: Vec<Polynomial>,
    /// Inertias that have symbols of their own: determinants of the inertia of coupled coordinates, and
    /// inertias that are sums.
    pub determinants: Vec<Polynomial>,
}

/// Returns the symbol that stands for determinant `k` in printed equations.
pub fn determinant_symbol(k: usize) -> Quantity {
    Quantity::Prepared(k)
}

/// Maximum number of momenta that are coupled with each other, since the inverse of their inertia is
/// expressed by cofactors.
const COUPLED: usize = 3;

/// Derives the canonical equations of a mechanism without constraints. Returns `None` if they would be too
/// long.
pub fn canonical_equations<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
) -> Option<CanonicalEquations> {
    let g = model.graph;
    let zero = vec![g.zero(); model.nv()];
    let p: Vec<Expr<'g>> = (0..model.nv()).map(|k| Quantity::Momentum(k).expr(g)).collect();
    let driven = replace_velocities(&momentum::generalized_momentum(model, joints, &zero), &zero);
    let relative: Vec<Expr<'g>> = p.iter().zip(&driven).map(|(p, driven)| *p - *driven).collect();
    let mut normal = NormalFormCache::new(g, rank_of_symbol);
    normal.ring.raise_term_limits();
    let (velocity, determinants) = velocities_of_momenta(mass, &relative, &mut normal)?;
    let potential = energy::potential_energy(model, joints);
    let power = p.iter().zip(&velocity).fold(g.zero(), |sum, (p, v)| sum + *p * *v);
    let hamiltonian = if !model.time {
        power * 0.5 + potential
    } else {
        power - replace_velocities(&[energy::kinetic_energy(model, joints, &velocity)], &velocity)[0]
            + potential
    };
    let rate = momentum::momentum_rate_without_inputs(model, joints, &velocity);
    let inputs = forces::generalized_forces_of_inputs(model, joints);
    let rate: Vec<Expr<'g>> = rate.into_iter().zip(inputs).map(|(rate, input)| rate + input).collect();
    let rate = replace_velocities(&rate, &velocity);
    let all: Vec<Expr<'g>> =
        [hamiltonian].into_iter().chain(velocity).chain(rate).chain(determinants).collect();
    let all: Vec<Polynomial> = all.iter().map(|e| normal.normal_form(*e)).collect::<Option<_>>()?;
    let mut short = Simplifier::new(normal.ring, quaternion_symbols(model), &EquationSizeLimits::ASKED);
    let mut all = all.iter().map(|p| short.shorten_polynomial(p)).collect::<Option<Vec<_>>>()?;
    let determinants = all.split_off(1 + 2 * model.nv());
    let momentum_rate = all.split_off(1 + model.nv());
    let velocity = all.split_off(1);
    Some(CanonicalEquations {
        ring: short.ring,
        hamiltonian: all.pop()?,
        velocity,
        momentum_rate,
        determinants,
    })
}

fn replace_velocities<'g>(e: &[Expr<'g>], v: &[Expr<'g>]) -> Vec<Expr<'g>> {
    substitute_symbols_in_all(e, &|s| match Quantity::from_symbol(s) {
        Quantity::Velocity(k) => Some(v[k]),
        _ => None,
    })
}

/// Returns `M⁻¹ p`, computed for each group of coupled coordinates, and the determinants of the groups.
/// `None` if a group is too large.
pub(super) fn velocities_of_momenta<'g>(
    mass: &Matrix<'g>,
    p: &[Expr<'g>],
    normal: &mut NormalFormCache<'g>,
) -> Option<(Vec<Expr<'g>>, Vec<Expr<'g>>)> {
    let (mut out, mut determinants) = (p.to_vec(), Vec::new());
    let mut left: Vec<usize> = (0..p.len()).collect();
    while let Some(first) = left.first().copied() {
        let mut group = vec![first];
        let mut k = 0;
        while k < group.len() {
            let row = &mass[group[k]];
            // Some entries are zero only by trigonometric identities.
            let more: Vec<usize> =
                (0..p.len()).filter(|j| !always_equals_number(row[*j], 0.0) && !group.contains(j)).collect();
            group.extend(more);
            k += 1;
        }
        left.retain(|k| !group.contains(k));
        group.sort_unstable();
        if group.len() > COUPLED {
            return None;
        }
        let own: Matrix<'g> = group.iter().map(|i| group.iter().map(|j| mass[*i][*j]).collect()).collect();
        let n = group.len();
        let cofactors: Matrix<'g> =
            (0..n).map(|i| (0..n).map(|j| cofactor_of_entry(&own, i, j)).collect()).collect();
        let mut divisor = (0..n).map(|j| own[0][j] * cofactors[0][j]).reduce(|a, b| a + b)?;
        // A sum of sines and cosines in a denominator would not be simplified.
        let is_configuration_symbol =
            |s: &Symbol| matches!(Quantity::from_symbol(*s), Quantity::Configuration(_));
        if n > 1
            || (symbols_in(&[divisor]).iter().any(is_configuration_symbol)
                && normal.normal_form(divisor)?.terms.len() > 1)
        {
            determinants.push(divisor);
            divisor = determinant_symbol(determinants.len() - 1).expr(divisor.graph());
        }
        for (i, k) in group.iter().enumerate() {
            let sum = (0..n).map(|j| cofactors[i][j] * p[group[j]]).reduce(|a, b| a + b)?;
            out[*k] = sum / divisor;
        }
    }
    Some((out, determinants))
}

/// Returns the cofactor of an entry of a matrix with at most three rows.
fn cofactor_of_entry<'g>(m: &Matrix<'g>, i: usize, j: usize) -> Expr<'g> {
    let n = m.len();
    // With cyclic indices no sign is needed.
    let entry_of_minor = |a: usize, b: usize| m[(i + a) % n][(j + b) % n];
    match n {
        1 => m[0][0].num(1.0),
        2 if i == j => entry_of_minor(1, 1),
        2 => -entry_of_minor(1, 1),
        _ => entry_of_minor(1, 1) * entry_of_minor(2, 2) - entry_of_minor(1, 2) * entry_of_minor(2, 1),
    }
}
