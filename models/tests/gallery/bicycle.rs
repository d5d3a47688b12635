use crate::testing::assert_number_close;
use linkwork::nalgebra::{Matrix2, Matrix4};
use linkwork::prelude::*;
use linkwork_models::Bicycle;

/// Index of the frame's roll rate in the velocity `v`. The constants below are those of the rear wheel's
/// rotation and of the steering rate.
const LEAN: usize = 3;
const WHEEL: usize = 6;
const STEER: usize = 7;

/// Returns the matrix `A` of the linearised motion `ẋ = A x` in lean, steer and their rates at a speed, and
/// the inverse of the mass matrix.
fn linearized_bicycle(speed: f64) -> (Matrix4<f64>, Matrix2<f64>) {
    let bicycle = Bicycle::BENCHMARK;
    let q = bicycle.neutral();
    let v = SVector::from([
        speed,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        -speed / bicycle.rear_radius,
        0.0,
        -speed / bicycle.front_radius,
    ]);
    assert!(bicycle.constraint_residuals(&q).amax() < 1e-15);
    assert!(bicycle.constraint_rates(&q, &v).amax() < 1e-14);
    let linear = bicycle.linearize(&q, &v, &SVector::zeros(), &[LEAN, STEER, WHEEL]).expect("regular");
    let position =
        |k| linear.coordinates.iter().position(|i| *i == k).expect("lean and steer are independent");
    let row_of_speed =
        |k| 7 + linear.speeds.iter().position(|i| *i == k).expect("their rates are independent");
    let rows = [position(LEAN), position(STEER), row_of_speed(LEAN), row_of_speed(STEER)];
    let (.., by_force) = bicycle.forward_dynamics_derivatives(&q, &v, &SVector::zeros());
    let inverse = Matrix2::from_fn(|i, j| by_force[([LEAN, STEER][i], [LEAN, STEER][j])]);
    (Matrix4::from_fn(|i, j| linear.a[(rows[i], rows[j])]), inverse)
}

#[test]
fn bicycle_matches_published_matrices() {
    assert_eq!((Bicycle::NV, Bicycle::NC, Bicycle::NP, Bicycle::NS), (9, 6, 7, 3));
    let m = Matrix2::new(80.817_22, 2.319_413_322_087_091, 2.319_413_322_087_091, 0.297_841_881_996_855_5);
    let c1 = Matrix2::new(0.0, 33.866_413_914_924_94, -0.850_356_414_569_784_4, 1.685_403_973_975_596_7);
    let k0 = Matrix2::new(-80.95, -2.599_516_852_498_716, -2.599_516_852_498_716, -0.803_294_884_586_176_9);
    let k2 = Matrix2::new(0.0, 76.597_345_895_732_22, 0.0, 2.654_315_237_946_04);
    let assert_close_matrices = |found: Matrix2<f64>, expected: Matrix2<f64>| {
        let worst = (found - expected).amax();
        assert!(worst <= 1e-11 * expected.amax().max(1.0), "{found} for {expected}");
    };
    for speed in [0.0, 1.0, 4.6] {
        let (a, inverse) = linearized_bicycle(speed);
        let mass = inverse.try_inverse().expect("regular");
        assert_close_matrices(mass, m);
        assert_close_matrices(-mass * a.fixed_view::<2, 2>(2, 0), k0 * 9.81 + k2 * (speed * speed));
        assert_close_matrices(-mass * a.fixed_view::<2, 2>(2, 2), c1 * speed + Matrix2::zeros());
    }
}

/// Reference eigenvalues (real and imaginary parts, 1/s) of the bicycle for each speed, m/s, recomputed from
/// the published parameters with 40 digits.
const EIGENVALUES: [(f64, [(f64, f64); 4]); 11] = [
    (
        0.0,
        [
            (-5.530943717653934, 0.0),
            (-3.1316432479065557, 0.0),
            (3.1316432479065557, 0.0),
            (5.530943717653934, 0.0),
        ],
    ),
    (
        1.0,
        [
            (-7.110080146374408, 0.0),
            (-3.1342312506657843, 0.0),
            (3.5269617099006942, 0.80774027519931),
            (3.5269617099006942, -0.80774027519931),
        ],
    ),
    (
        2.0,
        [
            (-8.673879848317371, 0.0),
            (-3.0715864564151425, 0.0),
            (2.6823451751274536, -1.6806629659067578),
            (2.6823451751274536, 1.6806629659067578),
        ],
    ),
    (
        3.0,
        [
            (-10.351014672459229, 0.0),
            (-2.633661372536653, 0.0),
            (1.706756056639735, -2.3158244738432434),
            (1.706756056639735, 2.3158244738432434),
        ],
    ),
    (
        4.0,
        [
            (-12.15861426576444, 0.0),
            (-1.4294442736132575, 0.0),
            (0.4132533152112413, -3.0791081860320535),
            (0.4132533152112413, 3.0791081860320535),
        ],
    ),
    (
        5.0,
        [
            (-14.078389692798247, 0.0),
            (-0.7753418821958419, 4.464867713788225),
            (-0.7753418821958419, -4.464867713788225),
            (-0.3228664290040871, 0.0),
        ],
    ),
    (
        6.0,
        [
            (-16.085371230980282, 0.0),
            (-1.5264448658414171, 5.876730605987084),
            (-1.5264448658414171, -5.876730605987084),
            (-0.004066900769703363, 0.0),
        ],
    ),
    (
        7.0,
        [
            (-18.15788466125202, 0.0),
            (-2.138756442583634, -7.195259133298043),
            (-2.138756442583634, 7.195259133298043),
            (0.10268170574766416, 0.0),
        ],
    ),
    (
        8.0,
        [
            (-20.27940894394566, 0.0),
            (-2.6934868358109476, 8.460379713969337),
            (-2.6934868358109476, -8.460379713969337),
            (0.1432787976571295, 0.0),
        ],
    ),
    (
        9.0,
        [
            (-22.43788559040859, 0.0),
            (-3.2167540225249076, -9.693773515317822),
            (-3.2167540225249076, 9.693773515317822),
            (0.15790184030917298, 0.0),
        ],
    ),
    (
        10.0,
        [
            (-24.624596350174, 0.0),
            (-3.7201684043728758, -10.906811394762881),
            (-3.7201684043728758, 10.906811394762881),
            (0.16105338653171555, 0.0),
        ],
    ),
];

#[test]
fn bicycle_matches_published_eigenvalues() {
    for (speed, expected) in EIGENVALUES {
        let found = linearized_bicycle(speed).0.complex_eigenvalues();
        for (re, im) in expected {
            let nearest = found.iter().map(|e| (e.re - re).hypot(e.im - im)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-10, "{re} + {im} i at {speed} m/s is off by {nearest}");
        }
    }
}

#[test]
fn bicycle_has_published_weave_and_capsize_speeds() {
    let largest_growth_rate = |speed: f64, weaving: bool| {
        let exponents = linearized_bicycle(speed).0.complex_eigenvalues();
        let of = exponents.iter().filter(|e| (e.im.abs() > 1e-6) == weaving).map(|e| e.re);
        of.fold(f64::NEG_INFINITY, f64::max)
    };
    for (weaving, between, published) in
        [(true, (4.0, 5.0), 4.292_382_536_341_11), (false, (5.0, 7.0), 6.024_262_015_388_37)]
    {
        let (mut below, mut above) = between;
        let sign = largest_growth_rate(below, weaving).signum();
        for _ in 0..50 {
            let middle = (below + above) / 2.0;
            if largest_growth_rate(middle, weaving).signum() == sign {
                below = middle
            } else {
                above = middle
            }
        }
        assert_number_close(below, published, 1e-11);
    }
}
