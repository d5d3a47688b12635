//! The benchmark bicycle: Meijaard, Papadopoulos, Ruina and Schwab, *Linearized dynamics equations for the balance and
//! steer of a bicycle: a benchmark and review*, Proc. R. Soc. A 463 (2007). The matrices follow from the bodies and their
//! rolling wheels; none is put in.

use linkwork::nalgebra::{Matrix2, Matrix4};
use linkwork::prelude::*;

/// Axes of the rear frame in the upright straight configuration: x forward, y right, z down, the origin at the rear
/// contact. The steering axis is tilted by 18° and meets the ground at the trail 0.08 m before the front contact.
#[mechanism(gravity = 9.81 * z, derivatives)]
struct Bicycle {
    #[body(mass = 85, com = 0.3 * x - 0.9 * z, inertia = [[9.2, 0, 2.4], [0, 11, 0], [2.4, 0, 2.8]])]
    frame: Body,
    #[body(mass = 2, inertia = diagonal(0.0603, 0.12, 0.0603))]
    rear: Body,
    #[body(mass = 4, com = (0.9 - 1.1) * x - 0.7 * z, inertia = [[0.05892, 0, -0.00756], [0, 0.06, 0], [-0.00756, 0, 0.00708]])]
    fork: Body,
    #[body(mass = 3, inertia = diagonal(0.1405, 0.28, 0.1405))]
    front: Body,
    #[joint(ground -> frame)]
    pose: Free,
    #[joint(frame.at(-0.3 * z) -> rear, about = y)]
    hub: Pin,
    #[joint(frame.at(1.1 * x) -> fork, about = sin(pi / 10) * x + cos(pi / 10) * z)]
    steer: Pin,
    #[joint(fork.at(-0.08 * x - 0.35 * z) -> front, about = y)]
    front_hub: Pin,
    #[constraint(rolls(rear.circle(0.3, y), ground.plane(-z)))]
    rear_contact: Rolling,
    #[constraint(rolls(front.circle(0.35, y), ground.plane(-z)))]
    front_contact: Rolling,
}

/// Entries of `v`: roll rate of the frame, rotation of the rear wheel, steering rate.
const LEAN: usize = 3;
const WHEEL: usize = 6;
const STEER: usize = 7;

/// `ẋ = A x` in lean, steer and their rates at a speed, and the inverse of the mass matrix.
fn linear(speed: f64) -> (Matrix4<f64>, Matrix2<f64>) {
    let bicycle = Bicycle {};
    let q = bicycle.neutral();
    let v = SVector::from([speed, 0.0, 0.0, 0.0, 0.0, 0.0, -speed / 0.3, 0.0, -speed / 0.35]);
    assert!(bicycle.constraint_residuals(&q).amax() < 1e-15);
    assert!(bicycle.constraint_rates(&q, &v).amax() < 1e-14);
    let linear = bicycle.linearize(&q, &v, &SVector::zeros(), &[LEAN, STEER, WHEEL]).expect("regular");
    let position =
        |k| linear.coordinates.iter().position(|i| *i == k).expect("lean and steer are independent");
    let speed = |k| 7 + linear.speeds.iter().position(|i| *i == k).expect("their rates are independent");
    let rows = [position(LEAN), position(STEER), speed(LEAN), speed(STEER)];
    let (.., by_force) = bicycle.forward_dynamics_derivatives(&q, &v, &SVector::zeros());
    let inverse = Matrix2::from_fn(|i, j| by_force[([LEAN, STEER][i], [LEAN, STEER][j])]);
    (Matrix4::from_fn(|i, j| linear.a[(rows[i], rows[j])]), inverse)
}

#[test]
fn matrices_are_the_published_ones() {
    assert_eq!((Bicycle::NV, Bicycle::NC, Bicycle::NP, Bicycle::NS), (9, 6, 7, 3));
    let m = Matrix2::new(80.817_22, 2.319_413_322_087_091, 2.319_413_322_087_091, 0.297_841_881_996_855_5);
    let c1 = Matrix2::new(0.0, 33.866_413_914_924_94, -0.850_356_414_569_784_4, 1.685_403_973_975_596_7);
    let k0 = Matrix2::new(-80.95, -2.599_516_852_498_716, -2.599_516_852_498_716, -0.803_294_884_586_176_9);
    let k2 = Matrix2::new(0.0, 76.597_345_895_732_22, 0.0, 2.654_315_237_946_04);
    let close = |found: Matrix2<f64>, expected: Matrix2<f64>| {
        let worst = (found - expected).amax();
        assert!(worst <= 1e-11 * expected.amax().max(1.0), "{found} for {expected}");
    };
    for speed in [0.0, 1.0, 4.6] {
        let (a, inverse) = linear(speed);
        let mass = inverse.try_inverse().expect("regular");
        close(mass, m);
        close(-mass * a.fixed_view::<2, 2>(2, 0), k0 * 9.81 + k2 * (speed * speed));
        close(-mass * a.fixed_view::<2, 2>(2, 2), c1 * speed + Matrix2::zeros());
    }
}

/// Real and imaginary parts of the eigenvalues, 1/s, by speed, m/s; recomputed from the published parameters with
/// 40 digits.
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
            (-3.1342312506657843, 6.346480466420744e-92),
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
            (-1.4294442736132575, 7.310282822323906e-92),
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
            (-0.3228664290040871, 5.628396725916113e-91),
        ],
    ),
    (
        6.0,
        [
            (-16.085371230980282, 0.0),
            (-1.5264448658414171, 5.876730605987084),
            (-1.5264448658414171, -5.876730605987084),
            (-0.004066900769703363, 8.796618289997668e-94),
        ],
    ),
    (
        7.0,
        [
            (-18.15788466125202, 0.0),
            (-2.138756442583634, -7.195259133298043),
            (-2.138756442583634, 7.195259133298043),
            (0.10268170574766416, -7.977276881108806e-91),
        ],
    ),
    (
        8.0,
        [
            (-20.27940894394566, 0.0),
            (-2.6934868358109476, 8.460379713969337),
            (-2.6934868358109476, -8.460379713969337),
            (0.1432787976571295, -6.852708533154825e-91),
        ],
    ),
    (
        9.0,
        [
            (-22.43788559040859, 0.0),
            (-3.2167540225249076, -9.693773515317822),
            (-3.2167540225249076, 9.693773515317822),
            (0.15790184030917298, 2.5678218357635044e-92),
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
fn eigenvalues_are_the_published_ones() {
    for (speed, expected) in EIGENVALUES {
        let found = linear(speed).0.complex_eigenvalues();
        for (re, im) in expected {
            let nearest = found.iter().map(|e| (e.re - re).hypot(e.im - im)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-10, "{re} + {im} i at {speed} m/s is off by {nearest}");
        }
    }
}
