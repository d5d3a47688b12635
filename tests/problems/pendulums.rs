//! Tests of pendulums, some of them on a cart, against references.

use linkwork::nalgebra::{SMatrix, SVector, Vector2};
use linkwork::{frame, mechanism};
use std::f64::consts::{FRAC_PI_2, PI};
use support::compare::assert_close;
use support::simulate::state_after_duration;
use support::table::Record;

/// Returns the complete elliptic integral of the first kind of modulus `k`, by the arithmetic-geometric mean.
fn elliptic_k(k: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (1.0 - k * k).sqrt());
    while (a - b).abs() > 1e-15 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    PI / (a + b)
}

/// Pendulum: a point mass on a massless rod.
#[mechanism(gravity = -9.81 * y)]
struct Pendulum {
    #[body]
    rod: Body,
    #[particle(mass = 1, at = rod.at(-1 * y))]
    bob: Particle,
    #[joint(ground -> rod, about = z)]
    pin: Pin,
}

#[test]
fn iftomm_a01_pendulum_agrees_with_the_reference() {
    let table = Record::load("problems/pendulums.json");
    let (mut time, mut q, mut v) = (0.0, SVector::from([-FRAC_PI_2]), SVector::from([0.0]));
    for [t, x, y] in table.rows_with_key("position") {
        (q, v) = state_after_duration(&Pendulum {}, &q, &v, t - time);
        time = t;
        let position = Pendulum {}.frame_placement(frame!(Pendulum, "bob"), &q).translation.vector;
        assert_close(format!("position at {t} s"), position.as_slice(), &[x, y, 0.0], 1e-11);
        let energy = Pendulum {}.kinetic_energy(&q, &v) + Pendulum {}.potential_energy(&q);
        assert_close(format!("energy at {t} s"), &[energy], &[0.0], 1e-11);
    }

    let period = table.number_with_key("period");
    let closed_form = 4.0 * elliptic_k((PI / 4.0).sin()) / 9.81_f64.sqrt();
    assert_close("period", &[closed_form], &[period], 1e-14);
    let (q, v) =
        state_after_duration(&Pendulum {}, &SVector::from([-FRAC_PI_2]), &SVector::from([0.0]), period);
    assert_close("after one period", &[q[0], v[0]], &[-FRAC_PI_2, 0.0], 1e-11);
}

#[mechanism(gravity = -9.81 * y)]
struct TwoPendulums {
    #[body]
    upper: Body,
    #[body]
    lower: Body,
    #[particle(mass = 1, at = upper.at(-1 * y))]
    upper_bob: Particle,
    #[particle(mass = 1, at = lower.at(-1 * y))]
    lower_bob: Particle,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(-1 * y) -> lower, about = z)]
    elbow: Pin,
}

/// Follows a trajectory in absolute angles, to a hundred times the error of another program's integration in
/// double precision (DOP853): `errors` at the times of the table.
fn check_pendulum_trajectory_in_angles<const N: usize>(name: &str, errors: [f64; N]) {
    let rows = Record::load("problems/pendulums.json").rows_with_key::<5>(name);
    assert_eq!(rows.len(), N + 1);
    let [_, a1, a2, r1, r2] = rows[0];
    let (mut q, mut v) = (Vector2::new(a1, a2 - a1), Vector2::new(r1, r2 - r1));
    for (pair, error) in rows.windows(2).zip(errors) {
        let [t, expected @ ..] = pair[1];
        (q, v) = state_after_duration(&TwoPendulums {}, &q, &v, t - pair[0][0]);
        let actual = [q[0], q[0] + q[1], v[0], v[0] + v[1]];
        assert_close(format!("{name} at {t} s"), &actual, &expected, 100.0 * error);
    }
}

#[test]
fn chaotic_double_pendulum_agrees_with_its_reference() {
    check_pendulum_trajectory_in_angles("double", [4.7e-14, 6.7e-14, 1.6e-12, 1.1e-11, 6.1e-8]);
}

#[test]
fn double_pendulum_of_small_angles_agrees_with_its_reference() {
    check_pendulum_trajectory_in_angles("double_small", [4.7e-14, 2.8e-14, 2.2e-14, 2.2e-13]);
}

/// Pendulum chain of five point masses on massless rods.
#[mechanism(gravity = -9.81 * y)]
struct FivePendulums {
    #[body]
    rod1: Body,
    #[body]
    rod2: Body,
    #[body]
    rod3: Body,
    #[body]
    rod4: Body,
    #[body]
    rod5: Body,
    #[particle(mass = 1, at = rod1.at(-1 * y))]
    bob1: Particle,
    #[particle(mass = 1, at = rod2.at(-1 * y))]
    bob2: Particle,
    #[particle(mass = 1, at = rod3.at(-1 * y))]
    bob3: Particle,
    #[particle(mass = 1, at = rod4.at(-1 * y))]
    bob4: Particle,
    #[particle(mass = 1, at = rod5.at(-1 * y))]
    bob5: Particle,
    #[joint(ground -> rod1, about = z)]
    pin1: Pin,
    #[joint(rod1.at(-1 * y) -> rod2, about = z)]
    pin2: Pin,
    #[joint(rod2.at(-1 * y) -> rod3, about = z)]
    pin3: Pin,
    #[joint(rod3.at(-1 * y) -> rod4, about = z)]
    pin4: Pin,
    #[joint(rod4.at(-1 * y) -> rod5, about = z)]
    pin5: Pin,
}

/// Checks a chain of pendulums in absolute angles θ: `M_ij = n_ij cos(θi − θj)` and
/// `h_i = Σ_j n_ij sin(θi − θj) θ̇j² + n_ii g sin θi`, where `n_ij` is the number of masses beyond both
/// joints.
#[test]
fn chain_of_pendulums_has_its_closed_form() {
    let to_absolute = SMatrix::<f64, 5, 5>::from_fn(|i, j| if j <= i { 1.0 } else { 0.0 });
    let q = SVector::from([0.4, -1.1, 2.0, 0.3, -0.7]);
    let v = SVector::from([1.0, 2.0, -1.5, 0.5, 3.0]);
    let (angle, speed) = (to_absolute * q, to_absolute * v);
    let mass_count_beyond = |i: usize, j: usize| (5 - i.max(j)) as f64;
    let mass_matrix =
        SMatrix::<f64, 5, 5>::from_fn(|i, j| mass_count_beyond(i, j) * (angle[i] - angle[j]).cos());
    let bias = SVector::<f64, 5>::from_fn(|i, _| {
        let centrifugal_term =
            |j: usize| mass_count_beyond(i, j) * (angle[i] - angle[j]).sin() * speed[j] * speed[j];
        (0..5).map(centrifugal_term).sum::<f64>() + mass_count_beyond(i, i) * 9.81 * angle[i].sin()
    });
    let expected = to_absolute.transpose() * mass_matrix * to_absolute;
    assert_close("mass matrix", FivePendulums {}.mass_matrix(&q).as_slice(), expected.as_slice(), 1e-13);
    let expected = to_absolute.transpose() * bias;
    assert_close("bias forces", FivePendulums {}.bias_forces(&q, &v).as_slice(), expected.as_slice(), 1e-13);
    let energy = -(0..5).map(|i| mass_count_beyond(i, i) * 9.81 * angle[i].cos()).sum::<f64>();
    assert_close("potential energy", &[FivePendulums {}.potential_energy(&q)], &[energy], 1e-13);
}

/// Uniform rod that swings on a pin at its end.
#[mechanism(gravity = -g * y)]
struct SwingingRod {
    g: f64,
    m: f64,
    l: f64,
    #[body(mass = m, com = -l / 2 * y, inertia = rod(m, l, y))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    pin: Pin,
}

/// The period at the amplitude `θ0` is `4 K(sin(θ0 / 2)) √(I / (m g d))`.
#[test]
fn physical_pendulum_returns_after_its_period() {
    let rod = SwingingRod { g: 9.81, m: 2.3, l: 1.4 };
    for amplitude in [0.1_f64, 1.0, 2.0, 3.0] {
        let slowness = (2.0 * rod.l / (3.0 * rod.g)).sqrt();
        let period = 4.0 * elliptic_k((amplitude / 2.0).sin()) * slowness;
        let (q, v) = state_after_duration(&rod, &SVector::from([amplitude]), &SVector::from([0.0]), period);
        assert_close(format!("amplitude {amplitude}"), &[q[0], v[0]], &[amplitude, 0.0], 1e-10);
    }
}

/// Cart with a pole whose angle is measured clockwise from upright.
#[mechanism(gravity = -9.81 * y)]
struct CartWithPole {
    #[body(mass = 1)]
    cart: Body,
    #[body(mass = 0.1, com = 0.5 * y, inertia = rod(0.1, 1, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = -z)]
    hinge: Pin,
}

#[test]
fn cart_pole_trajectory_agrees_with_the_reference() {
    let table = Record::load("problems/cart_pole.json");
    let rows = table.rows_with_key::<5>("trajectory");
    let [_, x, angle, speed, turning] = rows[0];
    let (mut q, mut v) = (Vector2::new(x, angle), Vector2::new(speed, turning));
    for pair in rows.windows(2) {
        let [t, expected @ ..] = pair[1];
        (q, v) = state_after_duration(&CartWithPole {}, &q, &v, t - pair[0][0]);
        assert_close(format!("state at {t} s"), &[q[0], q[1], v[0], v[1]], &expected, 1e-9);
        let energy = CartWithPole {}.kinetic_energy(&q, &v) + CartWithPole {}.potential_energy(&q);
        assert_close(format!("energy at {t} s"), &[energy], &[table.number_with_key("energy")], 1e-11);
    }
}
