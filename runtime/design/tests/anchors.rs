//! Comparison of the control functions with published values and exact solutions.

#[path = "support/compare.rs"]
mod compare;
#[path = "support/transport.rs"]
mod transport;

use compare::assert_relatively_close;
use linkwork_design::matrices::{Cost, discrete_riccati, eigenvalues, riccati};
use linkwork_design::{Polynomial, Special, TransferFunction};
use nalgebra::{Complex, DMatrix, dmatrix};
use transport::jet_transport;

type C = Complex<f64>;

#[track_caller]
fn assert_contains_pole(all: &[C], re: f64, im: f64, tolerance: f64) {
    let expected = C::new(re, im);
    assert!(
        all.iter().any(|x| (x - expected).norm() <= tolerance * expected.norm()),
        "expected {expected} among {all:?}"
    );
}

#[test]
fn jet_transport_modes_match_published() {
    let system = jet_transport();
    let poles = system.poles().unwrap();
    assert_contains_pole(&poles, -0.032935458097396, 0.946653235187099, 1e-13);
    assert_contains_pole(&poles, -0.562651115485759, 0.0, 1e-13);
    assert_contains_pole(&poles, -0.007277968319449, 0.0, 1e-11);
    let modes = system.modes().unwrap();
    let dutch = modes.iter().find(|m| m.pole.im > 0.0).unwrap();
    assert_relatively_close(dutch.frequency(), 0.9472259984, 1e-9);
    assert_relatively_close(dutch.damping_ratio(), 0.03477043298, 1e-9);
    assert_relatively_close(dutch.time_to_half().unwrap(), 2.0_f64.ln() / 0.032935458097396, 1e-12);
    assert_eq!(modes[0].participants()[0].0, "bank", "the spiral is a bank: {}", modes[0]);
    assert!(!dutch.is_defective());
    assert!(dutch.participation.iter().sum::<f64>() - 1.0 < 1e-12);
}

#[test]
fn jet_transport_channels_match_published() {
    let system = jet_transport();
    let yaw = system.transfer_function("yaw rate", "rudder").unwrap();
    let expected = [-0.475, -0.24788598, -0.118714058120, -0.056326124];
    for (found, expected) in yaw.numerator().coefficients().iter().zip(expected) {
        assert_relatively_close(*found, expected, 2e-8);
    }
    for (found, expected) in
        yaw.denominator().coefficients().iter().zip([1.0, 0.6358, 0.9388738, 0.51163125242, 0.003674147305])
    {
        assert_relatively_close(*found, expected, 1e-9);
    }
    let factored = system.factored("yaw rate", "rudder").unwrap();
    assert_contains_pole(&factored.zeros, -0.49807942502556, 0.0, 1e-12);
    assert_contains_pole(&factored.zeros, -0.011892898013536, 0.487786506836866, 1e-12);
    assert_relatively_close(system.gain_at_rest().unwrap()[(0, 0)], -15.330393510175284, 1e-11);
    assert_relatively_close(yaw.gain_at_rest(), -15.330393510175284, 1e-10);
    let bank = system.factored("bank", "aileron").unwrap();
    assert_contains_pole(&bank.zeros, -0.095354092068606, 0.872291025792194, 1e-12);
    assert_relatively_close(system.gain_at_rest().unwrap()[(1, 1)], 30.098981297570756, 1e-11);
}

#[test]
fn jet_transport_response_matches_reference() {
    let frequencies = [0.1, 0.5, 1.0, 2.0, 10.0];
    let response = jet_transport().frequency_response("yaw rate", "rudder", &frequencies).unwrap();
    // Recomputed with 40 digits (mpmath).
    let decibels = [0.689751832758, -32.711509337895, 9.212440344215, -10.890151461415, -26.411682548156];
    let degrees = [95.609231117885, -133.522626934155, 124.176112301269, 93.643492162448, 90.654845532871];
    for (k, value) in response.values.iter().enumerate() {
        assert_relatively_close(response.decibels()[k], decibels[k], 1e-11);
        assert_relatively_close(value.arg().to_degrees(), degrees[k], 1e-11);
    }
}

#[test]
fn yaw_damper_moves_poles_to_published_values() {
    let yaw = jet_transport().channel("yaw rate", "rudder").unwrap();
    let closed = yaw.feedback_gain(&dmatrix![-2.85]).unwrap().poles().unwrap();
    assert_contains_pole(&closed, -0.297221693126074, 0.60611851148743, 1e-12);
    assert_contains_pole(&closed, -0.342216765800175, 0.0, 1e-12);
    assert_contains_pole(&closed, -1.052889847947678, 0.0, 1e-12);
}

#[test]
fn riccati_solution_matches_maple() {
    let (a, b) = (dmatrix![-3.0, 2.0; 1.0, 1.0], dmatrix![0.0; 1.0]);
    let best = riccati(&a, &b, &Cost::new(dmatrix![1.0, -1.0; -1.0, 1.0], dmatrix![3.0])).unwrap();
    let x = [0.589517437276261, 1.821574724886083, 1.821574724886083, 8.818839806923112];
    best.x.iter().zip(x).for_each(|(found, expected)| assert_relatively_close(*found, expected, 1e-13));
    assert_relatively_close(best.gain[(0, 0)], 0.607191574962028, 1e-13);
    assert_relatively_close(best.gain[(0, 1)], 2.93961326897437, 1e-13);
    assert_contains_pole(&best.poles, -3.502628911023546, 0.0, 1e-13);
    assert_contains_pole(&best.poles, -1.436984357950825, 0.0, 1e-13);
}

#[test]
fn margins_and_routh_table_match_published() {
    let open = TransferFunction::new([1.0], [1.0, 2.0, 3.0, 4.0]).unwrap();
    let margins = open.margins().unwrap();
    let gain = margins.gain_increase().unwrap();
    assert_relatively_close(gain.factor, 2.0, 1e-12);
    assert_relatively_close(gain.frequency, 3.0_f64.sqrt(), 1e-12);
    assert!(margins.phase.is_empty());
    assert_relatively_close(margins.stability.distance, 0.4169761762, 1e-9);
    assert_relatively_close(margins.stability.frequency, 1.6620202928, 1e-8);
    let ranges = Polynomial::new([1.0, 2.0, 3.0, 4.0]).stable_gains(&Polynomial::constant(1.0)).unwrap();
    assert_eq!(ranges.len(), 1);
    assert_relatively_close(ranges[0].low, -4.0, 1e-12);
    assert_relatively_close(ranges[0].high, 2.0, 1e-12);
}

#[test]
fn step_responses_match_published() {
    let figures = TransferFunction::new([-1.0, 1.0], [1.0, 1.0, 1.0]).unwrap().step_figures().unwrap();
    // The published values are computed from samples; python-control's tests allow 2 %.
    assert_relatively_close(figures.rise_time, 1.242, 2e-2);
    assert_relatively_close(figures.settling_time, 9.110, 2e-2);
    assert_relatively_close(figures.overshoot, 20.840, 2e-2);
    assert_relatively_close(figures.undershoot, 28.0, 2e-2);
    assert_relatively_close(figures.peak, 1.208, 2e-2);
    assert_relatively_close(figures.peak_time, 4.282, 2e-2);
    // Exact: 1 − e^{−t/2} (cos ωt + √3 sin ωt) with ω = √3/2; its derivative is zero at ωt = π/6 and 7π/6.
    let omega = 0.75_f64.sqrt();
    let expected_step_response =
        |t: f64| 1.0 - (-t / 2.0).exp() * ((omega * t).cos() + 3.0_f64.sqrt() * (omega * t).sin());
    let turn = std::f64::consts::PI / 6.0;
    assert_relatively_close(figures.peak_time, 7.0 * turn / omega, 1e-12);
    assert_relatively_close(figures.peak, expected_step_response(7.0 * turn / omega), 1e-13);
    assert_relatively_close(figures.undershoot, -100.0 * expected_step_response(turn / omega), 1e-13);
    assert_relatively_close((expected_step_response(figures.settling_time) - 1.0).abs(), 0.02, 1e-10);
    let figures = TransferFunction::new([-1.0, 1.0], [1.0, 1.0]).unwrap().step_figures().unwrap();
    assert_relatively_close(figures.rise_time, 9.0_f64.ln(), 1e-12);
    assert_relatively_close(figures.settling_time, 100.0_f64.ln(), 1e-12);
    assert_relatively_close(figures.overshoot, 0.0, 1e-9);
    assert_relatively_close(figures.undershoot, 100.0, 1e-12);
    assert_relatively_close(figures.peak, 1.0, 1e-12);
}

/// Compares with the cruising Boeing 747 of Etkin and Reid, *Dynamics of Flight* (1996), in ft and s as
/// printed.
#[test]
#[expect(clippy::approx_constant, reason = "an entry of a published matrix")]
fn boeing_747_matches_published_modes() {
    let printed_and_own = [
        (
            dmatrix![
                -0.006868, 0.01395, 0.0, -32.2;
                -0.09055, -0.3151, 773.98, 0.0;
                0.0001187, -0.001026, -0.4285, 0.0;
                0.0, 0.0, 1.0, 0.0
            ],
            &[(-0.371945, 0.887540, 1e-5), (-0.00328948, 0.0672311, 1e-5)][..],
        ),
        (
            dmatrix![
                -0.0558, 0.0, -774.0, 32.2;
                -0.003865, -0.4342, 0.4136, 0.0;
                0.001086, -0.006112, -0.1458, 0.0;
                0.0, 1.0, 0.0, 0.0
            ],
            &[(-0.0330114, 0.946546, 1e-5), (-0.562480, 0.0, 1e-5), (-0.00729733, 0.0, 1e-5)][..],
        ),
        (
            dmatrix![
                -0.006866611275943936, 0.013943035674208383, 0.0, -9.81;
                -0.09050889360654447, -0.31489494006034713, 235.89334048404203, 0.0;
                0.00038918098285667125, -0.003361353515319591, -0.42814117544558544, 0.0;
                0.0, 0.0, 1.0, 0.0
            ],
            &[
                (-0.37166215649674494, 0.8868788584671381, 1e-12),
                (-0.003289206894193512, 0.06720807985472561, 1e-10),
            ][..],
        ),
        (
            dmatrix![
                -0.05576578472342987, 0.0, -235.9, 9.81;
                -0.01270078301241097, -0.4349018915599015, 0.4142375389921919, 0.0;
                0.003565068319118036, -0.006054072298785469, -0.14579164379805434, 0.0;
                0.0, 1.0, 0.0, 0.0
            ],
            &[
                (-0.033052210108050734, 0.9467852313277423, 1e-12),
                (-0.5630776981191257, 0.0, 1e-12),
                (-0.007277201746158317, 0.0, 1e-10),
            ][..],
        ),
    ];
    for (matrix, modes) in printed_and_own {
        let poles = eigenvalues(&matrix).unwrap();
        for (re, im, tolerance) in modes {
            assert_contains_pole(&poles, *re, *im, *tolerance);
        }
    }
}

/// Compares with the published matrices and eigenvalues of the benchmark bicycle (Meijaard, Papadopoulos,
/// Ruina and Schwab, 2007).
#[test]
fn whipple_bicycle_matches_benchmark() {
    use linkwork_design::SecondOrderForm;
    let mass = dmatrix![80.81722, 2.31941332208709; 2.31941332208709, 0.29784188199686];
    let c1 = dmatrix![0.0, 33.86641391492494; -0.85035641456978, 1.68540397397560];
    let k0 = dmatrix![-80.95, -2.59951685249872; -2.59951685249872, -0.80329488458618];
    let k2 = dmatrix![0.0, 76.59734589573222; 0.0, 2.65431523794604];
    let bicycle_at_speed = |v: f64| {
        let form =
            SecondOrderForm::new(mass.clone(), &c1 * v, &k0 * 9.81 + &k2 * (v * v), DMatrix::zeros(2, 0))
                .unwrap();
        assert!((&form.damping + &form.gyroscopic - &c1 * v).norm() < 1e-14);
        form.state_space().unwrap()
    };
    let published: [(f64, [(f64, f64); 3]); 4] = [
        (0.0, [(-5.53094371765393, 0.0), (-3.13164324790656, 0.0), (3.13164324790656, 0.0)]),
        (1.0, [(-7.11008014637442, 0.0), (-3.13423125066578, 0.0), (3.5269617099007, 0.8077402751993)]),
        (5.0, [(-14.07838969279822, 0.0), (-0.32286642900409, 0.0), (-0.77534188219585, 4.46486771378823)]),
        (10.0, [(-24.62459635017404, 0.0), (0.16105338653172, 0.0), (-3.72016840437287, 10.90681139476287)]),
    ];
    for (v, expected) in published {
        let poles = bicycle_at_speed(v).poles().unwrap();
        expected.iter().for_each(|(re, im)| assert_contains_pole(&poles, *re, *im, 1e-11));
    }
    // The bicycle is self-stable between the weave speed and the capsize speed.
    for (v, stable) in
        [(4.29238253634, false), (4.29238253635, true), (6.024262015, true), (6.024262016, false)]
    {
        assert_eq!(bicycle_at_speed(v).is_stable().unwrap(), stable, "at {v} m/s");
    }
}

/// Compares with exact solutions of Benner, Laub and Mehrmann, *A collection of benchmark examples for the
/// numerical solution of algebraic Riccati equations* (1995), continuous time, examples 1, 2, 7 and 12.
#[test]
fn riccati_solutions_match_benchmarks() {
    let assert_same_matrix = |found: &DMatrix<f64>, expected: &DMatrix<f64>, tolerance: f64| {
        assert!(
            (found - expected).norm() <= tolerance * expected.norm(),
            "expected {expected}, found {found}"
        );
    };
    let x = riccati(&dmatrix![0.0, 1.0; 0.0, 0.0], &dmatrix![0.0; 1.0], &Cost::diagonal(&[1.0, 2.0], &[1.0]));
    assert_same_matrix(&x.unwrap().x, &dmatrix![2.0, 1.0; 1.0, 2.0], 1e-14);
    let q = dmatrix![9.0, 6.0; 6.0, 4.0];
    let x = riccati(
        &dmatrix![4.0, 3.0; -4.5, -3.5],
        &dmatrix![1.0; -1.0],
        &Cost::new(q.clone(), DMatrix::identity(1, 1)),
    );
    assert_same_matrix(&x.unwrap().x, &(q * (1.0 + 2.0_f64.sqrt())), 1e-13);
    // Nearly uncontrollable.
    for epsilon in [1.0, 1e-2, 1e-4, 1e-6_f64] {
        let (a, b) = (dmatrix![1.0, 0.0; 0.0, -2.0], dmatrix![epsilon; 0.0]);
        let found = riccati(&a, &b, &Cost::new(DMatrix::from_element(2, 2, 1.0), DMatrix::identity(1, 1)));
        let found = found.unwrap().x;
        let root = (1.0 + epsilon * epsilon).sqrt();
        let across = 1.0 / (2.0 + root);
        assert_relatively_close(found[(0, 0)], (1.0 + root) / (epsilon * epsilon), 1e-10);
        assert_relatively_close(found[(0, 1)], across, 1e-6);
        assert_relatively_close(found[(1, 1)], 0.25 * (1.0 - epsilon * epsilon * across * across), 1e-6);
    }
    // Eigenvalues and costs of very different magnitudes.
    let turn = DMatrix::identity(3, 3) - DMatrix::from_element(3, 3, 2.0 / 3.0);
    for e in [1e-2_f64, 1.0, 1e2, 1e4] {
        let rotated_diagonal = |d: [f64; 3]| &turn * DMatrix::from_diagonal(&d.to_vec().into()) * &turn;
        let cost = Cost::new(rotated_diagonal([1.0 / e, 1.0, e]), DMatrix::identity(3, 3) * e);
        let found =
            riccati(&rotated_diagonal([e, 2.0 * e, 3.0 * e]), &DMatrix::identity(3, 3), &cost).unwrap();
        let (square, four) = (e * e, e.powi(4));
        let x = [
            square + (four + 1.0).sqrt(),
            2.0 * square + (4.0 * four + e).sqrt(),
            3.0 * square + (9.0 * four + square).sqrt(),
        ];
        assert_same_matrix(&found.x, &rotated_diagonal(x), 1e-12);
    }
}

/// Compares with exact solutions of Benner, Laub and Mehrmann's collection for discrete time, in which the
/// weight of the inputs may vanish.
#[test]
fn discrete_riccati_benchmarks_match_exact_solutions() {
    let (a, b) = (dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 1.0]);
    let q = dmatrix![1.0, 2.0; 2.0, 4.0];
    let x = discrete_riccati(&a, &b, &Cost::new(q, DMatrix::identity(1, 1))).unwrap().x;
    let expected = dmatrix![1.0, 2.0; 2.0, 2.0 + 5.0_f64.sqrt()];
    assert!((x - expected).norm() < 1e-12);
    let (a, b) = (dmatrix![2.0, -1.0; 1.0, 0.0], dmatrix![1.0; 0.0]);
    let x = discrete_riccati(&a, &b, &Cost::diagonal(&[0.0, 1.0], &[0.0])).unwrap().x;
    assert!((x - DMatrix::identity(2, 2)).norm() < 1e-12);
}

/// Checks the gain margin of `K / (s + 1)ⁿ`, which crosses the real axis at `tan(π/n)` with gain `cosⁿ(π/n)`,
/// and of `K / (s (s + 1) (s + 5))`, which crosses it at `√5` with gain `K / 30`.
#[test]
fn repeated_poles_have_closed_form_gain_margin() {
    for n in [3_usize, 4, 5, 8] {
        let roots = vec![C::new(-1.0, 0.0); n];
        let denominator = Polynomial::from_roots(&roots);
        let open = TransferFunction::quotient(&Polynomial::constant(0.9), &denominator).unwrap();
        let margin = open.margins().unwrap().gain_increase().unwrap();
        let angle = std::f64::consts::PI / n as f64;
        assert_relatively_close(margin.frequency, angle.tan(), 1e-9);
        assert_relatively_close(margin.factor, angle.cos().powi(-(n as i32)) / 0.9, 1e-9);
        assert!(open.margins().unwrap().phase.is_empty());
    }
    for gain in [10.0, 100.0] {
        let margins = TransferFunction::new([gain], [1.0, 6.0, 5.0, 0.0]).unwrap().margins().unwrap();
        let margin = margins.nearest_gain().unwrap();
        assert_relatively_close(margin.factor, 30.0 / gain, 1e-12);
        assert_relatively_close(margin.frequency, 5.0_f64.sqrt(), 1e-12);
        let phase = margins.nearest_phase().unwrap();
        let w = phase.frequency;
        assert_relatively_close(
            phase.degrees,
            90.0 - w.atan().to_degrees() - (w / 5.0).atan().to_degrees(),
            1e-10,
        );
        assert_relatively_close(w * (w * w + 1.0).sqrt() * (w * w + 25.0).sqrt(), gain, 1e-12);
    }
}

/// Compares with Ogata, *Modern Control Engineering* (2010), § 5-6: a row that begins with zero, a row of
/// zeros, and roots on the stability boundary.
#[test]
fn routh_tables_match_ogata() {
    let count_right_roots = |c: &[f64]| Polynomial::new(c.to_vec()).routh().unwrap().right;
    assert_eq!(count_right_roots(&[1.0, 2.0, 3.0, 4.0, 5.0]), 2);
    assert_eq!(count_right_roots(&[1.0, 2.0, 1.0, 2.0]), 0);
    assert_eq!(count_right_roots(&[1.0, 0.0, -3.0, 2.0]), 2);
    let table = Polynomial::new([1.0, 2.0, 24.0, 48.0, -25.0, -50.0]).routh().unwrap();
    assert_eq!(table.right, 1);
    assert!(table.special.contains(&Special::ZeroRow));
}
