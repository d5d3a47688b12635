//! Routh's reduction: cyclic coordinates, on which the Lagrangian does not depend, are eliminated from the
//! equations, and their momenta replace their velocities (Goldstein, Poole and Safko, *Classical Mechanics*,
//! 2002, § 8.3; Whittaker, *Analytical Dynamics*, § 38). The Routhian is `R(q, v, p) = L − p·w`, where `w`
//! are the velocities of cyclic coordinates. It satisfies Lagrange's equations in the other coordinates.

use super::crba::Matrix;
use super::{energy, ldl, momentum, rnea, velocity_symbols};
use crate::expr::Expr;
use crate::expr::eval::Tape;
use crate::expr::replace::substitute_symbols_in_all;
use crate::expr::sample::sample_of_symbol;
use crate::kinematics::{Joint, random_configuration};
use crate::mechanism::{Chart, Model, Quantity};

/// Number of random states at which the rates are tested.
const STATES: u64 = 6;
/// Tolerance of a zero rate relative to the largest rate.
const ROUNDING: f64 = 1e-11;

/// Routh's equations: the mechanism without its cyclic coordinates, as functions of `q`, the velocities of
/// the other coordinates and the momenta of the cyclic coordinates.
pub struct RouthEquations<'g> {
    /// Indices of the velocities of the cyclic coordinates.
    pub cyclic: Vec<usize>,
    /// Routhian `R` as an expression.
    pub routhian: Expr<'g>,
    /// Velocities of the cyclic coordinates in terms of their momenta.
    pub velocity: Vec<Expr<'g>>,
    /// Accelerations of the coordinates that are not cyclic, under the forces `τ`.
    pub acceleration: Vec<Expr<'g>>,
}

/// Returns the cyclic coordinates: plain coordinates whose momenta are constant without inputs. A coordinate
/// that is cyclic for special parameters only is not found.
pub fn cyclic_coordinates<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<usize> {
    let rates = Tape::new(&momentum::momentum_rate_without_inputs(model, joints, &velocity_symbols(model)));
    let mut plain: Vec<usize> = model
        .charts
        .iter()
        .filter_map(|chart| match chart {
            Chart::Plain(_, v) => Some(v.0),
            Chart::Ball(..) | Chart::Free(..) => None,
        })
        .collect();
    for seed in 0..STATES {
        let q = random_configuration(model, seed);
        let values = rates.evaluate_at(&|s| match Quantity::from_symbol(s) {
            Quantity::Configuration(k) => q[k],
            Quantity::Velocity(_) => 3.0 * sample_of_symbol(s, seed) - 3.0,
            Quantity::Input(_) => 0.0,
            _ => sample_of_symbol(s, seed),
        });
        let size = values.iter().map(|rate| rate.abs()).fold(1.0, f64::max);
        plain.retain(|v| values[*v].abs() <= ROUNDING * size);
    }
    plain
}

/// Routhian and velocities of the cyclic coordinates at given momenta.
pub struct RouthianAtMomenta<'g> {
    /// Routhian `R = T(v, 0) − ½ (p − π)·w − U`.
    pub routhian: Expr<'g>,
    /// Velocities `w` of the cyclic coordinates.
    pub velocity: Vec<Expr<'g>>,
}

/// Solves `p = M_cc w + π` for the velocities `w` of cyclic coordinates, where `π` is the contribution of the
/// other velocities and of motion prescribed in time to their momenta. Returns `None` if `solve` does.
pub fn solve_cyclic_velocities<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    cyclic: &[usize],
    solve: &mut dyn FnMut(Vec<Expr<'g>>) -> Option<Vec<Expr<'g>>>,
) -> Option<RouthianAtMomenta<'g>> {
    let g = model.graph;
    let others = velocities_with_cyclic_replaced(model, cyclic, &vec![g.zero(); cyclic.len()]);
    let given = replace_velocities(&momentum::generalized_momentum(model, joints, &others), &others);
    let p = cyclic.iter().enumerate().map(|(c, k)| Quantity::Momentum(c).expr(g) - given[*k]);
    let p: Vec<Expr<'g>> = p.collect();
    let velocity = solve(p.clone())?;
    let kinetic = energy::kinetic_energy(model, joints, &velocity_symbols(model));
    let lagrangian = replace_velocities(&[kinetic - energy::potential_energy(model, joints)], &others)[0];
    let twice = p.iter().zip(&velocity).fold(g.zero(), |sum, (p, w)| sum + *p * *w);
    Some(RouthianAtMomenta { routhian: lagrangian - twice * 0.5, velocity })
}

/// Derives Routh's equations, from which the cyclic coordinates are eliminated.
pub fn derive<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    cyclic: Vec<usize>,
) -> RouthEquations<'g> {
    let g = model.graph;
    let own = matrix_block(mass, &cyclic, &cyclic);
    let mut solve_cyclic_mass_block = |r: Vec<Expr<'g>>| Some(solve_linear_system(&own, r));
    let found = solve_cyclic_velocities(model, joints, &cyclic, &mut solve_cyclic_mass_block);
    let RouthianAtMomenta { routhian, velocity } =
        found.unwrap_or_else(|| RouthianAtMomenta { routhian: g.zero(), velocity: Vec::new() });
    let all = velocities_with_cyclic_replaced(model, &cyclic, &velocity);
    // M_rr a + M_rc b = f_r and M_cr a + M_cc b = f_c, with b eliminated.
    let others: Vec<usize> = (0..model.nv()).filter(|k| !cyclic.contains(k)).collect();
    let bias =
        replace_velocities(&rnea::inverse_dynamics(model, joints, &velocity_symbols(model), None), &all);
    let force: Vec<Expr<'g>> =
        bias.iter().enumerate().map(|(k, bias)| Quantity::Force(k).expr(g) - *bias).collect();
    let selected_forces = |list: &[usize]| -> Vec<Expr<'g>> { list.iter().map(|k| force[*k]).collect() };
    let across = matrix_block(mass, &others, &cyclic);
    let taken: Matrix<'g> = across.iter().map(|row| solve_linear_system(&own, row.clone())).collect();
    let dot_product =
        |a: &[Expr<'g>], b: &[Expr<'g>]| a.iter().zip(b).fold(g.zero(), |sum, (a, b)| sum + *a * *b);
    let mut reduced = matrix_block(mass, &others, &others);
    for (row, across) in reduced.iter_mut().zip(&across) {
        row.iter_mut().zip(&taken).for_each(|(entry, taken)| *entry -= dot_product(across, taken));
    }
    let of_cyclic = selected_forces(&cyclic);
    let right =
        selected_forces(&others).into_iter().zip(&taken).map(|(f, taken)| f - dot_product(taken, &of_cyclic));
    let acceleration = solve_linear_system(&reduced, right.collect());
    RouthEquations { cyclic, routhian, velocity, acceleration }
}

/// Returns the symbols of all velocities, where the velocities of the cyclic coordinates are replaced by
/// `velocity`.
pub fn velocities_with_cyclic_replaced<'g>(
    model: &Model<'g>,
    cyclic: &[usize],
    velocity: &[Expr<'g>],
) -> Vec<Expr<'g>> {
    let mut all = velocity_symbols(model);
    cyclic.iter().zip(velocity).for_each(|(k, w)| all[*k] = *w);
    all
}

/// Returns the expressions with the velocity symbols replaced by `v`.
pub fn replace_velocities<'g>(e: &[Expr<'g>], v: &[Expr<'g>]) -> Vec<Expr<'g>> {
    substitute_symbols_in_all(e, &|s| match Quantity::from_symbol(s) {
        Quantity::Velocity(k) => Some(v[k]),
        _ => None,
    })
}

/// Returns the block of the given rows and columns of a matrix.
pub fn matrix_block<'g>(m: &Matrix<'g>, rows: &[usize], columns: &[usize]) -> Matrix<'g> {
    rows.iter().map(|i| columns.iter().map(|j| m[*i][*j]).collect()).collect()
}

fn solve_linear_system<'g>(m: &Matrix<'g>, r: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
    let order: Vec<usize> = (0..r.len()).rev().collect();
    ldl::solve_in_order(m.clone(), r, &order, 0).x
}
