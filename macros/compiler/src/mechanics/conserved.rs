//! Quantities that are constant along every motion without inputs: energy, Jacobi's integral, momenta.
//! Candidates are tested numerically: a candidate is conserved if its time derivative is zero in random
//! states that satisfy the constraints, with random parameters. A quantity that is conserved for special
//! parameters only is not found.

use super::{added_mass, constraints, crba, energy, lagrange, momentum, rnea, velocity_symbols};
use crate::diag::Diagnostics;
use crate::expr::eval::Tape;
use crate::expr::sample::sample_of_symbol;
use crate::expr::{Expr, Symbol, Vec3};
use crate::kinematics::redundancy::OrthonormalRowBasis;
use crate::kinematics::{CompiledConstraintRows, Joint, mobility, random_configuration};
use crate::mechanism::{Model, Quantity};

/// Number of random states at which conservation is tested.
const STATES: u64 = 5;
/// Tolerance of a zero time derivative relative to the sum of the magnitudes of its terms: the accuracy of
/// the finite differences.
const LEFT: f64 = 1e-9;
/// Tolerance of a zero time derivative relative to the value of the quantity.
const ROUNDING: f64 = 1e-11;
/// Step of the finite differences in time that test conservation, s.
const STEP: f64 = 1e-3;
/// A gradient counts as a linear combination of others if its relative remainder is below this tolerance.
const DEPENDENT: f64 = 1e-6;

/// Conserved quantity of a mechanism: its name and its value.
#[derive(Clone)]
pub struct ConservedQuantity<'g> {
    /// Name of the conserved quantity, as shown to the user.
    pub name: String,
    /// Value of the quantity as an expression of the state.
    pub value: Expr<'g>,
}

/// Returns independent conserved quantities, the simplest first. The list is empty for mechanisms with
/// sliding or unilateral contacts, and if no configuration that satisfies the constraints is found.
pub fn conserved_quantities<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<ConservedQuantity<'g>> {
    let rubs = model.constraints.iter().any(|c| !c.friction.is_empty()) || !model.contacts.is_empty();
    if model.nv() == 0 || rubs {
        return Vec::new();
    }
    let candidates = candidate_quantities(model, joints);
    let values: Vec<Expr<'g>> = candidates.iter().map(|c| c.value).collect();
    let (tape, motion) = (Tape::new(&values), NumericEquationsOfMotion::new(model, joints));
    let mut kept = vec![true; values.len()];
    let mut gradients: Vec<Vec<Vec<f64>>> = Vec::new();
    let places = consistent_configurations(model);
    for (k, (q, seed)) in places.iter().enumerate() {
        let state = SampledState::random_state(model, &motion, q, *seed, k as u64);
        let Some(rates) = state.and_then(|state| {
            gradients.push(state.value_gradients(&tape));
            state.conserved_value_flags(&motion, &tape)
        }) else {
            return Vec::new();
        };
        kept.iter_mut().zip(rates).for_each(|(kept, constant)| *kept &= constant);
    }
    if places.is_empty() {
        return Vec::new();
    }
    let mut bases: Vec<OrthonormalRowBasis> =
        gradients.iter().map(|_| OrthonormalRowBasis::default()).collect();
    let mut adds_independent_gradient = |k: usize| {
        let mut any = false;
        for (basis, gradients) in bases.iter_mut().zip(&gradients) {
            let before = basis.rank();
            basis.add_independent_row(&gradients[k], DEPENDENT);
            any |= basis.rank() > before;
        }
        any
    };
    candidates
        .into_iter()
        .enumerate()
        .filter(|(k, _)| kept[*k] && adds_independent_gradient(*k))
        .map(|(_, c)| c)
        .collect()
}

/// Returns all quantities of a mechanism that may be conserved, such as the momenta of its coordinates.
fn candidate_quantities<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<ConservedQuantity<'g>> {
    let v = velocity_symbols(model);
    let p = momentum::generalized_momentum(model, joints, &v);
    let kinetic = energy::kinetic_energy(model, joints, &v);
    let potential = energy::potential_energy(model, joints);
    let mut all = vec![ConservedQuantity { name: "energy".to_string(), value: kinetic + potential }];
    if model.time {
        let power = p.iter().zip(&v).fold(model.graph.zero(), |sum, (p, v)| sum + *p * *v);
        all.push(ConservedQuantity {
            name: "Jacobi's integral".to_string(),
            value: power - kinetic + potential,
        });
    }
    for (p, (name, _)) in p.iter().zip(&model.velocities) {
        all.push(ConservedQuantity { name: format!("momentum of {name}"), value: *p });
    }
    let whole = momentum::centroidal_momentum(model, joints, &v);
    let center = energy::center_of_mass(model, joints);
    let mut add_momentum_components = |what: &str, vector: Vec3<'g>, about: &str| {
        for (axis, value) in ["x", "y", "z"].into_iter().zip(vector.0) {
            all.push(ConservedQuantity { name: format!("{what} momentum along {axis}{about}"), value });
        }
    };
    add_momentum_components("linear", whole.linear, "");
    add_momentum_components("angular", whole.angular, ", about the centre of mass");
    add_momentum_components(
        "angular",
        whole.angular + center.cross(whole.linear),
        ", about the ground's origin",
    );
    all
}

/// Returns configurations that satisfy the constraints, each with the seed of its parameters.
fn consistent_configurations(model: &Model<'_>) -> Vec<(Vec<f64>, u64)> {
    if model.constraints.is_empty() {
        return (0..STATES).map(|seed| (random_configuration(model, seed), seed)).collect();
    }
    let found = mobility::sample_feasible_configurations(
        model,
        &CompiledConstraintRows::new(model),
        &mut Diagnostics::new(),
    );
    found.into_iter().cycle().take(STATES as usize).collect()
}

/// Equations of motion from which the accelerations are computed numerically.
struct NumericEquationsOfMotion<'g> {
    nv: usize,
    nc: usize,
    /// Mass matrix, bias forces, Jacobian by rows, then velocities and biases of the constraints.
    equations: Tape<'g>,
    /// Time derivatives of the configuration, compiled for numeric evaluation.
    rates: Tape<'g>,
}

impl<'g> NumericEquationsOfMotion<'g> {
    fn new(model: &Model<'g>, joints: &[Joint<'g>]) -> NumericEquationsOfMotion<'g> {
        let mut all = added_mass::effective_mass_matrix(model, &crba::mass_matrix(model, joints)).concat();
        all.extend(rnea::inverse_dynamics(model, joints, &velocity_symbols(model), None));
        all.extend(constraints::jacobian(model).concat());
        all.extend(constraints::constraint_velocities(model));
        all.extend(constraints::constraint_biases(model));
        let (equations, rates) = (Tape::new(&all), Tape::new(&lagrange::configuration_rates(model)));
        NumericEquationsOfMotion { nv: model.nv(), nc: model.constraints.len(), equations, rates }
    }
}

/// Numeric state at which conservation is tested: time, configuration and velocity.
#[derive(Clone)]
struct SampledState {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    seed: u64,
}

impl SampledState {
    /// Returns a state with the configuration `q` and a random velocity that satisfies the constraints, or
    /// `None` if the velocity is not finite. `at` is the seed of the velocity, `seed` that of the parameters.
    fn random_state(
        model: &Model<'_>,
        motion: &NumericEquationsOfMotion<'_>,
        q: &[f64],
        seed: u64,
        at: u64,
    ) -> Option<SampledState> {
        let random_velocity =
            |k: usize| 4.0 * sample_of_symbol(Quantity::Velocity(k).symbol(), 100 + at) - 4.0;
        let t = sample_of_symbol(Quantity::Time.symbol(), seed);
        let mut state =
            SampledState { t, q: q.to_vec(), v: (0..model.nv()).map(random_velocity).collect(), seed };
        if motion.nc > 0 {
            let values = motion.equations.evaluate_at(&|s| state.value_of_symbol(s));
            let (nv, nc) = (motion.nv, motion.nc);
            let jacobian: Vec<&[f64]> = values[nv * nv + nv..][..nc * nv].chunks(nv).collect();
            let gap = &values[nv * nv + nv + nc * nv..][..nc];
            // Correction of minimum norm: x = Jᵀ y.
            let product_of_jacobian_rows =
                |i: usize, j: usize| jacobian[i].iter().zip(jacobian[j]).map(|(a, b)| a * b).sum();
            let normal = (0..nc).map(|i| (0..nc).map(|j| product_of_jacobian_rows(i, j)).collect()).collect();
            let y = solve_linear_system(normal, gap.to_vec());
            for (row, y) in jacobian.iter().zip(y) {
                state.v.iter_mut().zip(*row).for_each(|(v, entry)| *v -= entry * y);
            }
        }
        state.q.iter().chain(&state.v).all(|x| x.is_finite()).then_some(state)
    }

    fn value_of_symbol(&self, s: Symbol) -> f64 {
        match Quantity::from_symbol(s) {
            Quantity::Configuration(k) => self.q[k],
            Quantity::Velocity(k) => self.v[k],
            Quantity::Time => self.t,
            Quantity::Input(_) => 0.0,
            _ => sample_of_symbol(s, self.seed),
        }
    }

    fn tape_values(&self, tape: &Tape<'_>) -> Vec<f64> {
        tape.evaluate_at(&|s| self.value_of_symbol(s))
    }

    /// Returns the time derivatives of the configuration, and the accelerations, without inputs.
    fn state_derivatives(&self, motion: &NumericEquationsOfMotion<'_>) -> (Vec<f64>, Vec<f64>) {
        let (nv, nc) = (motion.nv, motion.nc);
        let values = self.tape_values(&motion.equations);
        let (mass, rest) = values.split_at(nv * nv);
        let (bias, rest) = rest.split_at(nv);
        let (jacobian, rest) = rest.split_at(nc * nv);
        let entry_of_constrained_system = |i: usize, j: usize| match (i < nv, j < nv) {
            (true, true) => mass[i * nv + j],
            (true, false) => jacobian[(j - nv) * nv + i],
            (false, true) => jacobian[(i - nv) * nv + j],
            (false, false) => 0.0,
        };
        let system =
            (0..nv + nc).map(|i| (0..nv + nc).map(|j| entry_of_constrained_system(i, j)).collect()).collect();
        let right = bias.iter().chain(&rest[nc..]).map(|x| -x).collect();
        let mut a = solve_linear_system(system, right);
        a.truncate(nv);
        (self.tape_values(&motion.rates), a)
    }

    /// Returns the state displaced by `h` times constant time derivatives `t`, `q` and `v`.
    fn displaced_state(&self, h: f64, t: f64, q: &[f64], v: &[f64]) -> SampledState {
        let displaced_by_rate =
            |x: &[f64], rate: &[f64]| x.iter().zip(rate).map(|(x, rate)| x + h * rate).collect();
        SampledState {
            t: self.t + h * t,
            q: displaced_by_rate(&self.q, q),
            v: displaced_by_rate(&self.v, v),
            seed: self.seed,
        }
    }

    /// Returns the derivatives of the values along a direction `(t, q, v)` of time, configuration and
    /// velocity, by central differences of fourth order.
    fn directional_derivatives(&self, tape: &Tape<'_>, t: f64, q: &[f64], v: &[f64]) -> Vec<f64> {
        let values_after_step = |h: f64| self.displaced_state(h * STEP, t, q, v).tape_values(tape);
        let all = [
            values_after_step(-2.0),
            values_after_step(-1.0),
            values_after_step(1.0),
            values_after_step(2.0),
        ];
        let central_difference =
            |k: usize| (8.0 * (all[2][k] - all[1][k]) - (all[3][k] - all[0][k])) / (12.0 * STEP);
        (0..all[0].len()).map(central_difference).collect()
    }

    /// Returns for each value whether it is constant along the motion, or `None` if the motion is not finite.
    fn conserved_value_flags(
        &self,
        motion: &NumericEquationsOfMotion<'_>,
        tape: &Tape<'_>,
    ) -> Option<Vec<bool>> {
        let (q, v) = self.state_derivatives(motion);
        let (no_q, no_v) = (vec![0.0; q.len()], vec![0.0; v.len()]);
        let whole = self.directional_derivatives(tape, 1.0, &q, &v);
        let parts = [
            self.directional_derivatives(tape, 1.0, &no_q, &no_v),
            self.directional_derivatives(tape, 0.0, &q, &no_v),
            self.directional_derivatives(tape, 0.0, &no_q, &v),
        ];
        let now = self.tape_values(tape);
        let is_conserved_entry = |k: usize| {
            let size: f64 = parts.iter().map(|part| part[k].abs()).sum();
            whole[k].abs() <= LEFT * size + ROUNDING * now[k].abs()
        };
        v.iter().all(|a| a.is_finite()).then(|| (0..now.len()).map(is_conserved_entry).collect())
    }

    /// Returns for each value its gradient with respect to all entries of the configuration, then of the
    /// velocity.
    fn value_gradients(&self, tape: &Tape<'_>) -> Vec<Vec<f64>> {
        let (nq, nv) = (self.q.len(), self.v.len());
        let unit_vector =
            |n: usize, k: usize| (0..n).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
        let derivatives_by_entry = |k: usize| {
            self.directional_derivatives(tape, 0.0, &unit_vector(nq, k), &unit_vector(nv, k.wrapping_sub(nq)))
        };
        let columns: Vec<Vec<f64>> = (0..nq + nv).map(derivatives_by_entry).collect();
        let count = columns.first().map_or(0, Vec::len);
        (0..count).map(|value| columns.iter().map(|column| column[value]).collect()).collect()
    }
}

/// Solves `m x = r` by elimination with complete pivoting. Unknowns that the rows leave undetermined are
/// zero.
fn solve_linear_system(mut m: Vec<Vec<f64>>, mut r: Vec<f64>) -> Vec<f64> {
    /// Pivots below this fraction of the first pivot count as zero.
    const PIVOT_TOLERANCE: f64 = 1e-11;
    let n = r.len();
    let mut pivots: Vec<(usize, usize)> = Vec::new();
    let (mut rows, mut columns): (Vec<usize>, Vec<usize>) = ((0..n).collect(), (0..n).collect());
    let mut first = 0.0;
    while !rows.is_empty() {
        let all = rows.iter().flat_map(|i| columns.iter().map(move |j| (*i, *j)));
        let Some((row, column)) = all.max_by(|a, b| m[a.0][a.1].abs().total_cmp(&m[b.0][b.1].abs())) else {
            break;
        };
        rows.retain(|i| *i != row);
        columns.retain(|j| *j != column);
        let pivot = m[row][column];
        first = f64::max(first, pivot.abs());
        if pivot.abs() <= PIVOT_TOLERANCE * first {
            break;
        }
        pivots.push((row, column));
        let (own, right) = (m[row].clone(), r[row]);
        for i in (0..n).filter(|i| *i != row) {
            let factor = m[i][column] / pivot;
            m[i].iter_mut().zip(&own).for_each(|(x, own)| *x -= factor * own);
            r[i] -= factor * right;
        }
    }
    let mut x = vec![0.0; n];
    pivots.iter().for_each(|(row, column)| x[*column] = r[*row] / m[*row][*column]);
    x
}
