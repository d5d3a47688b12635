//! Random systems of light and heavy bodies with nearly dependent constraints, compared with an elimination
//! in double-double precision.

use super::*;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Number with about 32 digits, represented as a sum of two (Dekker, *A floating-point technique for
/// extending the available precision*, Numer. Math. 18, 1971).
#[derive(Clone, Copy)]
struct DoubleDouble(f64, f64);

impl DoubleDouble {
    fn exact_sum_of_doubles(a: f64, b: f64) -> DoubleDouble {
        let s = a + b;
        let part = s - a;
        DoubleDouble(s, (a - (s - part)) + (b - part))
    }
}

impl Add for DoubleDouble {
    type Output = DoubleDouble;
    fn add(self, o: DoubleDouble) -> DoubleDouble {
        let (high, low) = (
            DoubleDouble::exact_sum_of_doubles(self.0, o.0),
            DoubleDouble::exact_sum_of_doubles(self.1, o.1),
        );
        let middle = DoubleDouble::exact_sum_of_doubles(high.0, high.1 + low.0);
        DoubleDouble::exact_sum_of_doubles(middle.0, middle.1 + low.1)
    }
}

impl Neg for DoubleDouble {
    type Output = DoubleDouble;
    fn neg(self) -> DoubleDouble {
        DoubleDouble(-self.0, -self.1)
    }
}

impl Sub for DoubleDouble {
    type Output = DoubleDouble;
    fn sub(self, o: DoubleDouble) -> DoubleDouble {
        self + -o
    }
}

impl Mul for DoubleDouble {
    type Output = DoubleDouble;
    fn mul(self, o: DoubleDouble) -> DoubleDouble {
        let p = self.0 * o.0;
        DoubleDouble::exact_sum_of_doubles(p, self.0.mul_add(o.0, -p) + (self.0 * o.1 + self.1 * o.0))
    }
}

impl Div for DoubleDouble {
    type Output = DoubleDouble;
    fn div(self, o: DoubleDouble) -> DoubleDouble {
        let first = self.0 / o.0;
        let rest = self - o * DoubleDouble(first, 0.0);
        let second = rest.0 / o.0;
        let rest = rest - o * DoubleDouble(second, 0.0);
        DoubleDouble::exact_sum_of_doubles(first, second) + DoubleDouble(rest.0 / o.0, 0.0)
    }
}

/// Random number generator SplitMix64 (Steele, Lea and Flood, 2014).
struct SplitMix64(u64);

impl SplitMix64 {
    /// Returns a uniformly distributed number in `[-1, 1)`.
    fn next_number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Random system of constrained dynamics: mass matrix, Jacobian, forces and biases.
#[derive(Clone, Copy)]
struct RandomSystem<const NV: usize, const NC: usize> {
    mass: SMatrix<f64, NV, NV>,
    jacobian: SMatrix<f64, NC, NV>,
    force: [f64; NV],
    bias: [f64; NC],
}

impl<const NV: usize, const NC: usize> RandomSystem<NV, NC> {
    /// Returns a random system of point masses on a chain of coordinates; masses differ by up to a factor of
    /// `10^(2 spread)`. Half of the systems have a constraint that differs from another one by at least
    /// `10^-near`.
    fn random_constrained_system(random: &mut SplitMix64, spread: f64, near: f64) -> Self {
        let mut mass = SMatrix::<f64, NV, NV>::zeros();
        for link in 0..NV {
            let weight = 10_f64.powf(spread * random.next_number());
            for _ in 0..2 {
                let moves =
                    SVector::<f64, NV>::from_fn(|i, _| if i <= link { random.next_number() } else { 0.0 });
                mass += moves * moves.transpose() * weight;
            }
        }
        let mut jacobian = SMatrix::<f64, NC, NV>::from_fn(|i, j| match random.next_number() < -0.4 {
            true if i != j => 0.0,
            _ => random.next_number(),
        });
        if NC > 1 && random.next_number() > 0.0 {
            let part = 10_f64.powf(-near * random.next_number().abs());
            let other = jacobian.row(0) * random.next_number() + jacobian.row(NC - 1) * part;
            jacobian.set_row(NC - 1, &other);
        }
        let force = core::array::from_fn(|_| random.next_number());
        Self { mass, jacobian, force, bias: core::array::from_fn(|_| random.next_number()) }
    }

    /// Returns the system with a random rounding error in every number.
    fn system_with_rounding_errors(&self, random: &mut SplitMix64, epsilon: f64) -> Self {
        let mut other = *self;
        for i in 0..NV {
            for j in 0..=i {
                let size = (self.mass[(i, i)] * self.mass[(j, j)]).sqrt();
                other.mass[(i, j)] += epsilon * size * random.next_number();
                other.mass[(j, i)] = other.mass[(i, j)];
            }
        }
        let mut shake = |x: &mut f64| *x *= 1.0 + epsilon * random.next_number();
        other.jacobian.iter_mut().for_each(&mut shake);
        other.force.iter_mut().for_each(&mut shake);
        other.bias.iter_mut().for_each(&mut shake);
        other
    }

    /// Returns accelerations and multipliers from elimination with complete pivoting.
    fn double_double_elimination_solution(&self) -> (SVector<f64, NV>, SVector<f64, NC>) {
        let n = NV + NC;
        let mut rows: Vec<Vec<DoubleDouble>> = (0..n)
            .map(|i| {
                let entry_of_system = |j: usize| match (i < NV, j < NV) {
                    (true, true) => self.mass[(i, j)],
                    (true, false) => -self.jacobian[(j - NV, i)],
                    (false, true) => self.jacobian[(i - NV, j)],
                    (false, false) => 0.0,
                };
                let right = if i < NV { self.force[i] } else { -self.bias[i - NV] };
                (0..n).map(entry_of_system).chain([right]).map(|x| DoubleDouble(x, 0.0)).collect()
            })
            .collect();
        let mut order: Vec<usize> = (0..n).collect();
        for k in 0..n {
            let places = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
            let best = places.max_by(|a, b| rows[a.0][a.1].0.abs().total_cmp(&rows[b.0][b.1].0.abs()));
            let (i, j) = best.expect("there are entries left");
            rows.swap(i, k);
            rows.iter_mut().for_each(|row| row.swap(j, k));
            order.swap(j, k);
            for i in k + 1..n {
                let factor = rows[i][k] / rows[k][k];
                for j in k..=n {
                    let part = factor * rows[k][j];
                    rows[i][j] = rows[i][j] - part;
                }
            }
        }
        let mut x = vec![DoubleDouble(0.0, 0.0); n];
        for k in (0..n).rev() {
            let rest = (k + 1..n).fold(rows[k][n], |sum, j| sum - rows[k][j] * x[j]);
            x[k] = rest / rows[k][k];
        }
        let solution_entry = |k: usize| order.iter().position(|o| *o == k).map_or(0.0, |place| x[place].0);
        (SVector::from_fn(|k, _| solution_entry(k)), SVector::from_fn(|k, _| solution_entry(NV + k)))
    }

    fn rank_revealing_solution<T: Real>(&self, rank: usize) -> (SVector<f64, NV>, SVector<f64, NC>) {
        let convert_number = |x: f64| constant::<T>(x);
        let structure = Structure { groups: core::array::from_fn(|k| k), determining: &[], rank };
        let (mass, jacobian) = (self.mass.map(convert_number), self.jacobian.map(convert_number));
        let (a, lambda) = DynamicsEquations {
            mass,
            jacobian,
            force: self.force.map(convert_number),
            bias: self.bias.map(convert_number),
        }
        .solve_with_rows_above_magnitude(
            &structure,
            well_conditioned_threshold(),
            DependentRowTreatment::Taken,
        )
        .0;
        (a.map(crate::private::to_f64), lambda.map(crate::private::to_f64))
    }
}

/// Checks that the solution of a random constrained system is as close to the exact solution as rounding
/// errors of the system permit.
fn check_against_exact_solution<T: Real, const NV: usize, const NC: usize>(
    seed: u64,
    spread: f64,
    near: f64,
) {
    let mut random = SplitMix64(seed);
    let epsilon = crate::private::to_f64(epsilon::<T>());
    for case in 0..300 {
        let all = RandomSystem::<NV, NC>::random_constrained_system(&mut random, spread, near);
        // Numbers rounded to `T`.
        let round_to_scalar_type = |x: f64| crate::private::to_f64(constant::<T>(x));
        let system = RandomSystem {
            mass: all.mass.map(round_to_scalar_type),
            jacobian: all.jacobian.map(round_to_scalar_type),
            force: all.force.map(round_to_scalar_type),
            bias: all.bias.map(round_to_scalar_type),
        };
        let (a, lambda) = system.double_double_elimination_solution();
        let (mut a_error, mut lambda_error) = (10.0 * epsilon * a.amax(), 10.0 * epsilon * lambda.amax());
        for _ in 0..4 {
            let (b, mu) =
                system.system_with_rounding_errors(&mut random, epsilon).double_double_elimination_solution();
            a_error = a_error.max((a - b).amax());
            lambda_error = lambda_error.max((lambda - mu).amax());
        }
        let (found, mu) = system.rank_revealing_solution::<T>(NC);
        // If rounding errors change the solution completely, it is not compared.
        if a_error < 1e-3 * a.amax() {
            assert!((found - a).amax() < 1e3 * a_error, "case {case}: {} for {a_error}", (found - a).amax());
        }
        if lambda_error < 1e-3 * lambda.amax() {
            let off = (mu - lambda).amax();
            assert!(off < 1e3 * lambda_error, "case {case}: {off} for {lambda_error}");
        }
    }
}

#[test]
fn light_and_heavy_bodies_lose_no_digits() {
    check_against_exact_solution::<f64, 3, 1>(1, 6.0, 0.0);
    check_against_exact_solution::<f64, 5, 3>(2, 6.0, 0.0);
    check_against_exact_solution::<f64, 8, 6>(3, 6.0, 0.0);
    check_against_exact_solution::<f64, 9, 4>(4, 3.0, 0.0);
    check_against_exact_solution::<f32, 3, 1>(5, 3.0, 0.0);
    check_against_exact_solution::<f32, 5, 3>(6, 3.0, 0.0);
}

#[test]
fn nearly_dependent_constraints_are_satisfied() {
    check_against_exact_solution::<f64, 5, 3>(7, 0.5, 12.0);
    check_against_exact_solution::<f64, 8, 6>(8, 2.0, 12.0);
    check_against_exact_solution::<f64, 8, 6>(9, 6.0, 10.0);
    check_against_exact_solution::<f32, 5, 3>(10, 0.5, 4.0);
}

/// Compares a system with an exactly redundant constraint with the system without it: the motions are equal,
/// and the multipliers have minimum norm.
#[test]
fn dependent_constraint_preserves_the_motion() {
    let mut random = SplitMix64(11);
    for case in 0..300 {
        let less = RandomSystem::<6, 3>::random_constrained_system(
            &mut random,
            if case % 2 == 0 { 6.0 } else { 0.5 },
            0.0,
        );
        let (a, _) = less.double_double_elimination_solution();
        let mut error = 1e-15 * a.amax();
        for _ in 0..4 {
            error = error.max(
                (a - less
                    .system_with_rounding_errors(&mut random, 1e-16)
                    .double_double_elimination_solution()
                    .0)
                    .amax(),
            );
        }
        let combination = [0.5, -2.0, 1.0, -1.0];
        let mut all = RandomSystem::<6, 4> {
            mass: less.mass,
            jacobian: SMatrix::zeros(),
            force: less.force,
            bias: [0.0; 4],
        };
        for k in 0..3 {
            // Fewer digits, so that sums are exact.
            let round_to_few_bits = |x: f64| (x * 1024.0).round() / 1024.0;
            let row = less.jacobian.row(k).map(round_to_few_bits);
            all.jacobian.set_row(k, &row);
            all.bias[k] = round_to_few_bits(less.bias[k]);
        }
        let sum = (0..3).fold(all.jacobian.row(3) * 0.0, |sum, k| sum + all.jacobian.row(k) * combination[k]);
        all.jacobian.set_row(3, &sum);
        all.bias[3] = (0..3).map(|k| all.bias[k] * combination[k]).sum();
        let short = RandomSystem::<6, 3> {
            jacobian: all.jacobian.fixed_rows::<3>(0).into_owned(),
            bias: [all.bias[0], all.bias[1], all.bias[2]],
            ..less
        };
        let (a, lambda) = short.double_double_elimination_solution();
        let (found, mu) = all.rank_revealing_solution::<f64>(3);
        assert!(
            (found - a).amax() < 1e4 * error.max(1e-15 * a.amax()),
            "case {case}: {}",
            (found - a).amax()
        );
        let off: f64 = (0..4).map(|k| mu[k] * combination[k]).sum();
        assert!(off.abs() < 1e-9 * mu.amax(), "case {case}: {off}");
        let force = short.jacobian.transpose() * lambda - all.jacobian.transpose() * mu;
        assert!(force.amax() < 1e-8 * mu.amax(), "case {case}: {}", force.amax());
    }
}

/// Checks a particle on a line in the plane with the same constraint twice: each constraint exerts half of
/// the force.
#[test]
fn redundant_constraints_share_the_force() {
    let system = RandomSystem::<2, 2> {
        mass: SMatrix::identity() * 2.0,
        jacobian: SMatrix::<f64, 2, 2>::new(0.0, 1.0, 0.0, 1.0),
        force: [3.0, -20.0],
        bias: [0.0; 2],
    };
    let (a, lambda) = system.rank_revealing_solution::<f64>(1);
    assert!((a - SVector::from([1.5, 0.0])).norm() < 1e-14);
    assert!((lambda - SVector::from([10.0, 10.0])).norm() < 1e-14);
}

/// Checks a mass on a line with a coordinate without inertia that equals twice the position of the mass:
/// forces on both accelerate the mass.
#[test]
fn coordinates_without_inertia_are_determined() {
    let structure = Structure { groups: [0], determining: &[0], rank: 1 };
    let mass = SMatrix::<f64, 2, 2>::new(4.0, 0.0, 0.0, 0.0);
    let jacobian = SMatrix::<f64, 1, 2>::new(-2.0, 1.0);
    let (a, lambda) = DynamicsEquations { mass, jacobian, force: [1.0, 3.0], bias: [0.5] }
        .solve_with_rows_above_magnitude(
            &structure,
            well_conditioned_threshold(),
            DependentRowTreatment::Taken,
        )
        .0;
    assert!((a - SVector::from([1.75, 3.0])).norm() < 1e-14, "{a}");
    assert!((lambda[0] + 3.0).abs() < 1e-14, "{lambda}");
}
