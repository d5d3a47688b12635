//! Checks properties that hold for every linear system, such as small residuals and exact round trips, on
//! random systems including stiff and defective ones.

use linkwork_design::matrices::{
    Cost, discrete_lyapunov, discrete_riccati, discrete_sylvester, eigenvalues, exponential, logarithm,
    lyapunov, riccati, sylvester,
};
use linkwork_design::{Error, Hold, Polynomial, Special, StateSpace, TransferFunction};
use nalgebra::{Complex, DMatrix, dmatrix};

type C = Complex<f64>;

struct RandomNumbers(u64);

impl RandomNumbers {
    fn next_number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn random_matrix(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| self.next_number())
    }

    /// Returns a random linear system whose states are scaled by factors of up to `10^spread`.
    fn random_system(&mut self, n: usize, m: usize, p: usize, spread: f64) -> StateSpace {
        let scales: Vec<f64> = (0..n).map(|_| 10f64.powf(spread * self.next_number())).collect();
        let a = DMatrix::from_fn(n, n, |i, j| self.next_number() * scales[i] / scales[j]);
        let b = DMatrix::from_fn(n, m, |i, _| self.next_number() * scales[i]);
        let c = DMatrix::from_fn(p, n, |_, j| self.next_number() / scales[j]);
        StateSpace::new(a, b, c, self.random_matrix(p, m)).unwrap()
    }

    fn random_stable_system(&mut self, n: usize, m: usize, p: usize, spread: f64) -> StateSpace {
        let system = self.random_system(n, m, p, spread);
        let right = system.poles().unwrap().iter().map(|x| x.re).fold(0.0, f64::max);
        let a = system.a() - DMatrix::identity(n, n) * (right + 0.1);
        StateSpace::new(a, system.b().clone(), system.c().clone(), system.d().clone()).unwrap()
    }
}

#[track_caller]
fn assert_small_matrix(what: &str, m: &DMatrix<f64>, size: f64, tolerance: f64) {
    assert!(m.norm() <= tolerance * size, "{what}: {} beside {size}", m.norm());
}

#[test]
fn matrix_equations_have_small_residuals() {
    let mut random = RandomNumbers(1);
    for n in 1..12 {
        let (a, b) = (random.random_matrix(n, n), random.random_matrix(n + 1, n + 1));
        let c = random.random_matrix(n, n + 1);
        let x = sylvester(&a, &b, &c).unwrap();
        assert_small_matrix("sylvester", &(&a * &x + &x * &b - &c), c.norm() + x.norm(), 1e-13);
        let x = discrete_sylvester(&a, &b, &c).unwrap();
        assert_small_matrix("discrete", &(&a * &x * &b - &x + &c), c.norm() + x.norm(), 1e-13);
        let q = &a * a.transpose();
        let x = lyapunov(&a, &q).unwrap();
        assert_small_matrix("lyapunov", &(&a * &x + &x * a.transpose() + &q), q.norm() + x.norm(), 1e-13);
        let x = discrete_lyapunov(&a, &q).unwrap();
        assert_small_matrix(
            "discrete lyapunov",
            &(&a * &x * a.transpose() - &x + &q),
            q.norm() + x.norm(),
            1e-13,
        );
    }
    let defective = dmatrix![-1.0, 1.0, 0.0; 0.0, -1.0, 1.0; 0.0, 0.0, -1.0];
    let x = lyapunov(&defective, &DMatrix::identity(3, 3)).unwrap();
    let residual = &defective * &x + &x * defective.transpose() + DMatrix::<f64>::identity(3, 3);
    assert_small_matrix("defective", &residual, x.norm(), 1e-14);
    assert!(matches!(
        lyapunov(&dmatrix![0.0, 1.0; -1.0, 0.0], &DMatrix::identity(2, 2)),
        Err(Error::Singular { .. })
    ));
}

#[test]
fn regulators_are_optimal() {
    let mut random = RandomNumbers(2);
    for k in 0..60 {
        let (n, m) = (1 + k % 8, 1 + k % 3);
        let system = random.random_system(n, m, 1, 0.5 * f64::from(u8::from(k % 4 == 3)));
        let (a, b) = (system.a(), system.b());
        let root = random.random_matrix(n, n);
        let cost = Cost::new(&root * root.transpose(), DMatrix::identity(m, m))
            .with_products(&root * random.random_matrix(n, m) * 0.1);
        let best = riccati(a, b, &cost).unwrap();
        let x = &best.x;
        let residual = a.transpose() * x + x * a + &cost.q - (x * b + &cost.n) * &best.gain;
        assert_small_matrix("continuous", &residual, (a.transpose() * x).norm() + cost.q.norm(), 1e-11);
        // Eigenvalues of Hamiltonian matrices are symmetric about the imaginary axis; the stable half are
        // the regulator's.
        assert!(best.poles.iter().all(|p| p.re < 0.0));
        let best = discrete_riccati(a, b, &cost).unwrap();
        let x = &best.x;
        let residual = a.transpose() * x * a - x + &cost.q - (a.transpose() * x * b + &cost.n) * &best.gain;
        assert_small_matrix("discrete", &residual, x.norm() + cost.q.norm(), 1e-11);
        assert!(best.poles.iter().all(|p| p.norm() < 1.0));
    }
    // A delay, whose matrix A is singular.
    let (a, b) = (dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 1.0]);
    assert!(discrete_riccati(&a, &b, &Cost::diagonal(&[1.0, 1.0], &[1.0])).is_ok());
}

#[test]
fn impossible_regulators_are_errors() {
    let system_from_matrices = |a, b: DMatrix<f64>| {
        let n = b.nrows();
        let m = b.ncols();
        StateSpace::new(a, b, DMatrix::identity(n, n), DMatrix::zeros(n, m)).unwrap()
    };
    let stuck = system_from_matrices(dmatrix![1.0, 0.0; 0.0, -1.0], dmatrix![0.0; 1.0]);
    let cost = Cost::diagonal(&[1.0, 1.0], &[1.0]);
    assert!(matches!(stuck.lqr(&cost), Err(Error::Unstabilizable { mode }) if mode.re == 1.0));
    let unseen = system_from_matrices(dmatrix![0.0, 1.0; -1.0, 0.0], dmatrix![0.0; 1.0]);
    assert!(matches!(unseen.lqr(&Cost::diagonal(&[0.0, 0.0], &[1.0])), Err(Error::Undetectable { .. })));
    assert_eq!(unseen.lqr(&Cost::diagonal(&[1.0, 1.0], &[0.0])), Err(Error::Singular { what: "R" }));
    assert_eq!(unseen.lqr(&Cost::diagonal(&[1.0, 1.0], &[-1.0])), Err(Error::Indefinite { matrix: "R" }));
    let short = Cost::diagonal(&[1.0], &[1.0]);
    assert_eq!(unseen.lqr(&short), Err(Error::Shape { matrix: "Q", expected: (2, 2), found: (1, 1) }));
    assert!(matches!(unseen.controllability_gramian(), Err(Error::Unstable { .. })));
    assert_eq!(unseen.discretize(-0.1, Hold::Zero), Err(Error::Period { period: -0.1 }));
    let differentiator = TransferFunction::s();
    assert_eq!(differentiator.state_space(), Err(Error::Improper { numerator: 1, denominator: 0 }));
    let bad = StateSpace::new(dmatrix![f64::NAN], dmatrix![1.0], dmatrix![1.0], dmatrix![0.0]);
    assert_eq!(bad, Err(Error::NotFinite { what: "A" }));
}

#[test]
fn eigenvalues_of_hard_matrices_are_accurate() {
    // Known spectra by similarity transformations, and a companion matrix of wide range.
    let mut random = RandomNumbers(3);
    for n in 2..20 {
        let diagonal: Vec<f64> = (0..n).map(|k| (k as f64) - 3.5).collect();
        let t = random.random_matrix(n, n) + DMatrix::identity(n, n) * 3.0;
        let d = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(diagonal.clone()));
        let a = t.clone() * d * t.try_inverse().unwrap();
        for (found, expected) in eigenvalues(&a).unwrap().iter().zip(diagonal) {
            assert!((found - expected).norm() < 1e-9, "{n}: {found} for {expected}");
        }
    }
    let roots = Polynomial::from_roots(&[-1e-4, -1.0, -1e4].map(|x| C::new(x, 0.0))).roots().unwrap();
    for (found, expected) in roots.iter().zip([-1e4, -1.0, -1e-4]) {
        assert!((found.re / expected - 1.0).abs() < 1e-12);
    }
    // A cyclic permutation, on which QR without exceptional shifts makes no progress.
    let cycle = DMatrix::from_fn(6, 6, |i, j| f64::from((j + 1) % 6 == i));
    assert!(eigenvalues(&cycle).unwrap().iter().all(|x| (x.norm() - 1.0).abs() < 1e-14));
    let chain = StateSpace::new(
        dmatrix![-1.0, 1.0; 0.0, -1.0],
        dmatrix![0.0; 1.0],
        dmatrix![1.0, 0.0],
        dmatrix![0.0],
    );
    assert!(chain.unwrap().modes().unwrap().iter().all(|mode| mode.is_defective()));
}

#[test]
fn system_matrix_loses_rank_at_zeros() {
    let mut random = RandomNumbers(4);
    for k in 0..80 {
        let (n, m) = (2 + k % 7, 1 + k % 3);
        let mut system = random.random_system(n, m, m, if k % 5 == 4 { 3.0 } else { 0.0 });
        if k % 2 == 0 {
            let d = DMatrix::zeros(m, m);
            system = StateSpace::new(system.a().clone(), system.b().clone(), system.c().clone(), d).unwrap();
        }
        let zeros = system.zeros().unwrap();
        let expected = if k % 2 == 0 { n.saturating_sub(m) } else { n };
        assert_eq!(zeros.len(), expected, "order {n}, {m} inputs");
        // The system matrix is evaluated through the balanced response, so that the test itself is
        // accurate.
        for zero in zeros {
            let full = system.at(zero).unwrap();
            let far = system.at(zero + C::new(1.0 + zero.norm(), 0.3)).unwrap();
            let (least, size) = (full.singular_values().min(), far.singular_values().min().max(full.norm()));
            assert!(least < 1e-8 * size, "{zero}: {least} beside {size}");
        }
    }
}

#[test]
fn discretisation_is_inverted() {
    let mut random = RandomNumbers(5);
    for n in 1..8 {
        let system = random.random_stable_system(n, 2, 2, 0.0);
        for hold in [Hold::Zero, Hold::First, Hold::Tustin, Hold::Prewarped(1.5)] {
            let back = system.discretize(0.1, hold).unwrap().undiscretize(hold).unwrap();
            for (found, expected) in [
                (back.a(), system.a()),
                (back.b(), system.b()),
                (back.c(), system.c()),
                (back.d(), system.d()),
            ] {
                assert_small_matrix(&format!("{hold:?}"), &(found - expected), expected.norm(), 1e-11);
            }
        }
        // Tustin with prewarping is exact at its frequency.
        let discrete = system.discretize(0.1, Hold::Prewarped(1.5)).unwrap();
        let (one, two) = (C::new(0.0, 1.5), C::new(0.0, 0.15).exp());
        let off = (system.at(one).unwrap() - discrete.at(two).unwrap()).norm();
        assert!(off < 1e-12 * (1.0 + system.at(one).unwrap().norm()), "{off}");
        let log = logarithm(&exponential(system.a()).unwrap()).unwrap();
        assert_small_matrix("logarithm", &(log - system.a()), system.a().norm(), 1e-11);
    }
}

#[test]
fn gramians_agree_with_energies() {
    let mut random = RandomNumbers(6);
    for n in 1..6 {
        let system = random.random_stable_system(n, 1, 1, 0.0);
        let system =
            StateSpace::new(system.a().clone(), system.b().clone(), system.c().clone(), dmatrix![0.0])
                .unwrap();
        let norm = system.h2_norm().unwrap();
        // Parseval's theorem: the integral of the squared impulse response, by Simpson's rule.
        let times = system.times(200.0, 80_001).unwrap();
        let y = system.impulse_response(0, &times).unwrap().outputs;
        let simpson_weight =
            |k: usize| if k == 0 || k + 1 == times.len() { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
        let energy: f64 =
            y.iter().enumerate().map(|(k, y)| simpson_weight(k) * y * y).sum::<f64>() * (times[1] / 3.0);
        assert!((energy.sqrt() / norm - 1.0).abs() < 1e-7, "{} and {norm}", energy.sqrt());
        let peak = system.peak_gain().unwrap();
        let grid = linkwork_design::logarithmic(1e-3, 1e3, 4000).unwrap();
        let response = system.frequency_response(0, 0, &grid).unwrap();
        let highest = response.peak().unwrap().0;
        assert!(
            peak.gain >= highest * (1.0 - 1e-12)
                && peak.gain < 1.01 * highest.max(system.at(C::new(0.0, 0.0)).unwrap()[(0, 0)].norm())
        );
        let hankel = system.hankel_values().unwrap();
        assert!(peak.gain <= 2.0 * hankel.iter().sum::<f64>() * (1.0 + 1e-9));
        assert!(peak.gain >= hankel[0] * (1.0 - 1e-9));
    }
}

#[test]
fn routh_counts_roots() {
    let mut random = RandomNumbers(7);
    let mut specials = [0; 2];
    for k in 0..3000 {
        let n = 1 + k % 7;
        // Small integer coefficients produce every singular case.
        let mut c: Vec<f64> = (0..=n).map(|_| (3.0 * random.next_number()).round()).collect();
        c[0] = if c[0] == 0.0 { 1.0 } else { c[0] };
        let mut polynomial = Polynomial::new(c);
        if k % 3 == 0 {
            polynomial = &polynomial * &Polynomial::new([1.0, 0.0, 1.0 + (k % 5) as f64]);
        }
        let table = polynomial.routh().unwrap();
        specials[0] += usize::from(table.special.contains(&Special::LeadingZero));
        specials[1] += usize::from(table.special.contains(&Special::ZeroRow));
        let roots = polynomial.roots().unwrap();
        let near = roots.iter().any(|r| r.re != 0.0 && r.re.abs() < 1e-3);
        if !near {
            let right = roots.iter().filter(|r| r.re > 0.0).count();
            assert_eq!(table.right, right, "{polynomial}: {roots:?}, {table:?}");
        }
    }
    assert!(specials.iter().all(|count| *count > 100), "{specials:?}");
}

#[test]
fn realisations_are_minimal() {
    let mut random = RandomNumbers(8);
    for k in 0..40 {
        let n = 1 + k % 6;
        let seen = random.random_stable_system(n, 1, 1, 0.0);
        // In parallel with it, an uncontrollable and an unobservable system.
        let hidden = random.random_stable_system(2, 1, 1, 0.0);
        let still =
            StateSpace::new(hidden.a() * 1.1, DMatrix::zeros(2, 1), hidden.c().clone(), dmatrix![0.0])
                .unwrap();
        let mute = StateSpace::new(hidden.a() * 1.5, hidden.b().clone(), DMatrix::zeros(1, 2), dmatrix![0.0])
            .unwrap();
        let both = seen.parallel(&still).unwrap().parallel(&mute).unwrap();
        // Similarity transformation to other states.
        let t = random.random_matrix(n + 4, n + 4) + DMatrix::identity(n + 4, n + 4) * 3.0;
        let inverse = t.clone().try_inverse().unwrap();
        let mixed =
            StateSpace::new(&inverse * both.a() * &t, inverse * both.b(), both.c() * t, both.d().clone())
                .unwrap();
        let ranks = mixed.kalman_ranks(1e-10).unwrap();
        assert_eq!((ranks.both, ranks.controllable_only, ranks.observable_only), (n, 2, 2));
        let minimal = mixed.minimal(1e-10).unwrap();
        assert_eq!(minimal.order(), n);
        let s = C::new(0.3, 0.7);
        let off = (minimal.at(s).unwrap() - seen.at(s).unwrap()).norm();
        assert!(off < 1e-10, "{off}");
        let g = minimal.transfer_function(0, 0).unwrap();
        assert_eq!(g.denominator().degree(), n);
        assert!((g.at(s) - seen.at(s).unwrap()[(0, 0)]).norm() < 1e-9);
    }
}

#[test]
fn linear_inputs_are_exact() {
    // ẋ = −x + t from zero: x = t − 1 + e^{−t}.
    let lag = TransferFunction::new([1.0], [1.0, 1.0]).unwrap().state_space().unwrap();
    let times = lag.times(3.0, 7).unwrap();
    let ramp = DMatrix::from_fn(1, 7, |_, k| times[k]);
    let y = lag.forced_response(&ramp, &[0.0], &times, Hold::First).unwrap().output(0).unwrap();
    for (t, y) in times.iter().zip(y) {
        assert!((y - (t - 1.0 + (-t).exp())).abs() < 1e-14, "{y} at {t}");
    }
}

#[test]
fn connections_multiply_and_add_responses() {
    let mut random = RandomNumbers(9);
    let (one, two) = (random.random_stable_system(3, 2, 2, 0.0), random.random_stable_system(2, 2, 2, 0.0));
    let s = C::new(0.2, 0.9);
    let (g, h) = (one.at(s).unwrap(), two.at(s).unwrap());
    let assert_close_matrices = |found: DMatrix<C>, expected: DMatrix<C>| {
        assert!((found - &expected).norm() < 1e-12 * expected.norm())
    };
    assert_close_matrices(one.series(&two).unwrap().at(s).unwrap(), &h * &g);
    assert_close_matrices(one.parallel(&two).unwrap().at(s).unwrap(), &h + &g);
    let sensitivity = (DMatrix::identity(2, 2) + &g * &h).try_inverse().unwrap();
    assert_close_matrices(one.feedback(&two).unwrap().at(s).unwrap(), sensitivity * &g);
    let direct = StateSpace::gain(dmatrix![1.0]).unwrap();
    assert_eq!(direct.feedback_gain(&dmatrix![-1.0]), Err(Error::AlgebraicLoop));
}

/// Checks `det(s I − A + B K) = Π (s − pᵢ)` at points away from all poles, including repeated poles and poles
/// of the open loop.
#[test]
fn placed_poles_are_the_required_ones() {
    let mut random = RandomNumbers(31);
    for k in 0..60 {
        let (n, m) = (2 + k % 6, 1 + k % 3);
        let system = random.random_system(n, m, 1, if k % 4 == 3 { 1.0 } else { 0.0 });
        let mut poles: Vec<C> = match k % 5 {
            4 => system.poles().unwrap(),
            3 => vec![C::new(-1.0, 0.0); n.min(2)],
            _ => vec![C::new(-1.0, 2.0), C::new(-1.0, -2.0)],
        };
        (poles.len()..n).for_each(|i| poles.push(C::new(-2.0 - 0.7 * i as f64, 0.0)));
        let gain = system.place(&poles).unwrap();
        let closed = (system.a() - system.b() * &gain).map(|x| C::new(x, 0.0));
        for s in [C::new(0.5, 1.5), C::new(3.0, -0.4), C::new(-1.2, 5.0)] {
            let found = (DMatrix::identity(n, n) * s - &closed).determinant();
            let expected: C = poles.iter().map(|pole| s - pole).product();
            assert!((found - expected).norm() < 1e-6 * expected.norm(), "{k}: {found} {expected}");
        }
    }
    let fixed =
        StateSpace::new(dmatrix![-3.0, 0.0; 0.0, 1.0], dmatrix![0.0; 1.0], dmatrix![1.0, 1.0], dmatrix![0.0]);
    let fixed = fixed.unwrap();
    let (one, alone) = (C::new(-1.0, 0.0), C::new(-1.0, 1.0));
    let Err(Error::Unstabilizable { mode }) = fixed.place(&[one, one]) else { panic!() };
    assert!((mode - C::new(-3.0, 0.0)).norm() < 1e-12);
    assert_eq!(fixed.place(&[one, alone]), Err(Error::Unpaired { pole: alone }));
    assert!(matches!(fixed.place(&[one]), Err(Error::Count { expected: 2, found: 1, .. })));
}

/// Checks that every crossing on a fine grid is found and satisfies its equation, and that the stability
/// margin is the minimum distance from −1.
#[test]
fn margins_include_every_crossing() {
    let mut random = RandomNumbers(7);
    for k in 0..21 {
        let system = random.random_stable_system(2 + k % 7, 1, 1, if k % 3 == 0 { 2.0 } else { 0.0 });
        let size = 10f64.powf(2.0 * random.next_number());
        let loose = StateSpace::gain(dmatrix![size]).unwrap().series(&system).unwrap();
        let margins = loose.margins().unwrap();
        let grid = loose.natural_frequencies(1500).unwrap();
        let values = loose.frequency_response(0, 0, &grid).unwrap().values;
        let (mut real, mut one) = (Vec::new(), Vec::new());
        for (pair, w) in values.windows(2).zip(&grid) {
            if pair[0].im * pair[1].im < 0.0 && pair[0].re < 0.0 && pair[1].re < 0.0 {
                real.push(*w);
            }
            if (pair[0].norm() - 1.0) * (pair[1].norm() - 1.0) < 0.0 {
                one.push(*w);
            }
        }
        for w in real {
            assert!(margins.gain.iter().any(|m| (m.frequency / w - 1.0).abs() < 1e-2), "{k}: gain at {w}");
        }
        for w in one {
            assert!(margins.phase.iter().any(|m| (m.frequency / w - 1.0).abs() < 1e-2), "{k}: phase at {w}");
        }
        let open_loop_response = |w: f64| loose.at(C::new(0.0, w)).unwrap()[(0, 0)];
        for m in &margins.gain {
            assert!((open_loop_response(m.frequency) * m.factor + 1.0).norm() < 1e-6, "{k}: {m:?}");
        }
        for m in &margins.phase {
            assert!((open_loop_response(m.frequency).norm() - 1.0).abs() < 1e-9, "{k}: {m:?}");
        }
        let ends = [open_loop_response(0.0), open_loop_response(1e9 * grid[grid.len() - 1])];
        let least = values.iter().chain(&ends).map(|x| (x + 1.0).norm()).fold(f64::INFINITY, f64::min);
        assert!(
            margins.stability.distance <= least * (1.0 + 1e-9),
            "{k}: {} {least}",
            margins.stability.distance
        );
        assert!(margins.stability.distance >= least * 0.99, "{k}: {} {least}", margins.stability.distance);
    }
}
