//! Published problems and closed forms. The numbers of `data/problems` name their sources; each test has the
//! tolerance that its problem states.

use linkwork::nalgebra::{Matrix2, Matrix6, SMatrix, SVector, Vector2, Vector3, Vector6};
use linkwork::{frame, mechanism};
use std::f64::consts::{FRAC_PI_2, PI};
use support::compare::assert_close;
use support::simulate::advance;
use support::table::Record;

/// Complete elliptic integral of the first kind of modulus `k`, by the arithmetic-geometric mean.
fn elliptic_k(k: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (1.0 - k * k).sqrt());
    while (a - b).abs() > 1e-15 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    PI / (a + b)
}

// ---- Pendulums ---------------------------------------------------------------------------------------------------

/// A point mass on a massless rod.
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
fn iftomm_a01_pendulum() {
    let table = Record::load("problems/pendulums.json");
    let (mut time, mut q, mut v) = (0.0, SVector::from([-FRAC_PI_2]), SVector::from([0.0]));
    for [t, x, y] in table.rows("position") {
        (q, v) = advance(&Pendulum {}, &q, &v, t - time);
        time = t;
        let position = Pendulum {}.frame_placement(frame!(Pendulum, "bob"), &q).translation.vector;
        assert_close(format!("position at {t} s"), position.as_slice(), &[x, y, 0.0], 1e-11);
        let energy = Pendulum {}.kinetic_energy(&q, &v) + Pendulum {}.potential_energy(&q);
        assert_close(format!("energy at {t} s"), &[energy], &[0.0], 1e-11);
    }

    let period = table.number("period");
    let closed_form = 4.0 * elliptic_k((PI / 4.0).sin()) / 9.81_f64.sqrt();
    assert_close("period", &[closed_form], &[period], 1e-14);
    let (q, v) = advance(&Pendulum {}, &SVector::from([-FRAC_PI_2]), &SVector::from([0.0]), period);
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

/// Follows a trajectory given in absolute angles, to a hundred times the error that another program's integration in
/// double precision was seen to have (DOP853): `errors` at the times of the table.
fn check_two_pendulums<const N: usize>(name: &str, errors: [f64; N]) {
    let rows = Record::load("problems/pendulums.json").rows::<5>(name);
    assert_eq!(rows.len(), N + 1);
    let [_, a1, a2, r1, r2] = rows[0];
    let (mut q, mut v) = (Vector2::new(a1, a2 - a1), Vector2::new(r1, r2 - r1));
    for (pair, error) in rows.windows(2).zip(errors) {
        let [t, expected @ ..] = pair[1];
        (q, v) = advance(&TwoPendulums {}, &q, &v, t - pair[0][0]);
        let actual = [q[0], q[0] + q[1], v[0], v[0] + v[1]];
        assert_close(format!("{name} at {t} s"), &actual, &expected, 100.0 * error);
    }
}

#[test]
fn double_pendulum_is_chaotic_and_still_right() {
    check_two_pendulums("double", [4.7e-14, 6.7e-14, 1.6e-12, 1.1e-11, 6.1e-8]);
}

#[test]
fn double_pendulum_with_small_angles() {
    check_two_pendulums("double_small", [4.7e-14, 2.8e-14, 2.2e-14, 2.2e-13]);
}

/// Five point masses.
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

/// In absolute angles θ: `M_ij = n_ij cos(θi − θj)` and `h_i = Σ_j n_ij sin(θi − θj) θ̇j² + n_ii g sin θi`, where
/// `n_ij` is the number of masses beyond both joints.
#[test]
fn chain_of_pendulums_by_its_closed_form() {
    let to_absolute = SMatrix::<f64, 5, 5>::from_fn(|i, j| if j <= i { 1.0 } else { 0.0 });
    let q = SVector::from([0.4, -1.1, 2.0, 0.3, -0.7]);
    let v = SVector::from([1.0, 2.0, -1.5, 0.5, 3.0]);
    let (angle, speed) = (to_absolute * q, to_absolute * v);
    let beyond = |i: usize, j: usize| (5 - i.max(j)) as f64;
    let mass_matrix = SMatrix::<f64, 5, 5>::from_fn(|i, j| beyond(i, j) * (angle[i] - angle[j]).cos());
    let bias = SVector::<f64, 5>::from_fn(|i, _| {
        let turning = |j: usize| beyond(i, j) * (angle[i] - angle[j]).sin() * speed[j] * speed[j];
        (0..5).map(turning).sum::<f64>() + beyond(i, i) * 9.81 * angle[i].sin()
    });
    let expected = to_absolute.transpose() * mass_matrix * to_absolute;
    assert_close("mass matrix", FivePendulums {}.mass_matrix(&q).as_slice(), expected.as_slice(), 1e-13);
    let expected = to_absolute.transpose() * bias;
    assert_close("bias forces", FivePendulums {}.bias_forces(&q, &v).as_slice(), expected.as_slice(), 1e-13);
    let energy = -(0..5).map(|i| beyond(i, i) * 9.81 * angle[i].cos()).sum::<f64>();
    assert_close("potential energy", &[FivePendulums {}.potential_energy(&q)], &[energy], 1e-13);
}

/// A uniform rod on a pin at its end.
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

/// Period with amplitude: `4 K(sin(θ0 / 2)) √(I / (m g d))`.
#[test]
fn physical_pendulum_returns_after_its_period() {
    let rod = SwingingRod { g: 9.81, m: 2.3, l: 1.4 };
    for amplitude in [0.1_f64, 1.0, 2.0, 3.0] {
        let slowness = (2.0 * rod.l / (3.0 * rod.g)).sqrt();
        let period = 4.0 * elliptic_k((amplitude / 2.0).sin()) * slowness;
        let (q, v) = advance(&rod, &SVector::from([amplitude]), &SVector::from([0.0]), period);
        assert_close(format!("amplitude {amplitude}"), &[q[0], v[0]], &[amplitude, 0.0], 1e-10);
    }
}

// ---- Cart with a pole --------------------------------------------------------------------------------------------

/// The pole's angle is measured clockwise from upright.
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
fn cart_pole_trajectory() {
    let table = Record::load("problems/cart_pole.json");
    let rows = table.rows::<5>("trajectory");
    let [_, x, angle, speed, turning] = rows[0];
    let (mut q, mut v) = (Vector2::new(x, angle), Vector2::new(speed, turning));
    for pair in rows.windows(2) {
        let [t, expected @ ..] = pair[1];
        (q, v) = advance(&CartWithPole {}, &q, &v, t - pair[0][0]);
        assert_close(format!("state at {t} s"), &[q[0], q[1], v[0], v[1]], &expected, 1e-9);
        let energy = CartWithPole {}.kinetic_energy(&q, &v) + CartWithPole {}.potential_energy(&q);
        assert_close(format!("energy at {t} s"), &[energy], &[table.number("energy")], 1e-11);
    }
}

// ---- Tops --------------------------------------------------------------------------------------------------------

/// Brüls, Cardona and Arnold's heavy top.
#[mechanism(gravity = -9.81 * z)]
struct HeavyTop {
    #[body(mass = 15, com = y, inertia = diagonal(0.234375, 0.46875, 0.234375))]
    top: Body,
    #[joint(ground -> top)]
    tip: Ball,
}

/// Two unit quaternions, the first x y z w and the second w x y z, are the same rotation.
#[track_caller]
fn assert_same_rotation(what: &str, actual: &[f64], [w, x, y, z]: [f64; 4], tolerance: f64) {
    let expected = [x, y, z, w];
    let dot: f64 = actual.iter().zip(&expected).map(|(a, b)| a * b).sum();
    let actual: Vec<f64> = actual.iter().map(|a| a * dot.signum()).collect();
    assert_close(what, &actual, &expected, tolerance);
}

#[test]
fn heavy_top() {
    let table = Record::load("problems/heavy_top.json");
    let rows = table.rows::<11>("trajectory");
    let start = rows[0];
    let (mut q, mut v) = (HeavyTop {}.neutral(), SVector::from([start[5], start[6], start[7]]));

    // Euler's equations about the fixed point.
    let about_tip = Vector3::new(0.234375 + 15.0, 0.46875, 0.234375 + 15.0);
    let weight = Vector3::y().cross(&Vector3::new(0.0, 0.0, -15.0 * 9.81));
    let expected = (weight - v.cross(&about_tip.component_mul(&v))).component_div(&about_tip);
    let acceleration = HeavyTop {}.forward_dynamics(&q, &v, &SVector::zeros());
    assert_close("initial acceleration", acceleration.as_slice(), expected.as_slice(), 1e-13);

    for pair in rows.windows(2) {
        let [t, qw, qx, qy, qz, wx, wy, wz, x, y, z] = pair[1];
        (q, v) = advance(&HeavyTop {}, &q, &v, t - pair[0][0]);
        assert_same_rotation(&format!("orientation at {t} s"), q.as_slice(), [qw, qx, qy, qz], 1e-7);
        assert_close(format!("angular velocity at {t} s"), v.as_slice(), &[wx, wy, wz], 1e-6);
        let center = HeavyTop {}.center_of_mass(&q);
        assert_close(format!("centre of mass at {t} s"), center.as_slice(), &[x, y, z], 1e-7);
        let energy = HeavyTop {}.kinetic_energy(&q, &v) + HeavyTop {}.potential_energy(&q);
        assert_close(format!("energy at {t} s"), &[energy], &[table.number("energy")], 1e-9);
    }
}

/// Euler's angles: precession, nutation, spin.
#[mechanism(gravity = -10 * z)]
struct TopOnGimbals {
    #[body]
    outer: Body,
    #[body]
    inner: Body,
    #[body(mass = 2, com = z, inertia = diagonal(3, 3, 1))]
    rotor: Body,
    #[joint(ground -> outer, about = z)]
    precession: Pin,
    #[joint(outer -> inner, about = x)]
    nutation: Pin,
    #[joint(inner -> rotor, about = z)]
    spin: Pin,
}

#[mechanism(gravity = -10 * z)]
struct TopOnBall {
    #[body(mass = 2, com = z, inertia = diagonal(3, 3, 1))]
    rotor: Body,
    #[joint(ground -> rotor)]
    tip: Ball,
}

/// `I1 Ω² cos θ − I3 ω3 Ω + m g l = 0` with I1 = 5 (about the tip), I3 = 1, m g l = 20, θ = 0.3, ω3 = 50.
#[test]
fn steady_precession() {
    let (i1, i3, mgl, angle, w3) = (5.0, 1.0, 20.0, 0.3_f64, 50.0);
    let root = (i3 * i3 * w3 * w3 - 4.0 * i1 * angle.cos() * mgl).sqrt();
    let fast = (i3 * w3 + root) / (2.0 * i1 * angle.cos());
    let slow = mgl / (i1 * angle.cos() * fast);
    assert_close("roots", &[slow, fast], &[0.416_578_700_573_935, 10.050_937_314_806_921], 1e-15);

    for precession in [slow, fast] {
        let spin = w3 - precession * angle.cos();
        let (q, v) = (Vector3::new(0.7, angle, 0.2), Vector3::new(precession, 0.0, spin));
        let acceleration = TopOnGimbals {}.forward_dynamics(&q, &v, &SVector::zeros());
        // Forces of the order of I3 ω3 Ω cancel.
        let rounding = 1e-13 * i3 * w3 * precession.max(1.0) / (i1 * angle.sin());
        assert_close("Euler's angles", acceleration.as_slice(), &[0.0; 3], rounding);

        // The body turns about its axis faster than its angular velocity does, by the spin.
        let axis = Vector3::x() * angle;
        let orientation = linkwork::nalgebra::UnitQuaternion::from_scaled_axis(axis);
        let q = SVector::from_column_slice(orientation.coords.as_slice());
        let v = Vector3::new(0.0, precession * angle.sin(), w3);
        let acceleration = TopOnBall {}.forward_dynamics(&q, &v, &SVector::zeros());
        let expected = [precession * angle.sin() * spin, 0.0, 0.0];
        assert_close("angular velocity", acceleration.as_slice(), &expected, 1e-13);
    }
}

/// A body on a ball joint at its centre of mass.
#[mechanism]
struct RigidBody {
    #[body(mass = 1, inertia = diagonal(1, 2, 3))]
    racket: Body,
    #[joint(ground -> racket)]
    center: Ball,
}

/// Rotation about the intermediate axis.
#[test]
fn dzhanibekov() {
    let table = Record::load("problems/dzhanibekov.json");
    let (mut time, mut q, mut v) = (0.0, RigidBody {}.neutral(), Vector3::new(0.01, 3.0, 0.01));
    for [t, qw, qx, qy, qz, wx, wy, wz] in table.rows("trajectory") {
        (q, v) = advance(&RigidBody {}, &q, &v, t - time);
        time = t;
        assert_same_rotation(&format!("orientation at {t} s"), q.as_slice(), [qw, qx, qy, qz], 1e-9);
        assert_close(format!("angular velocity at {t} s"), v.as_slice(), &[wx, wy, wz], 1e-9);
    }
    let start = Vector3::new(0.01, 3.0, 0.01);
    let (_, v) = advance(&RigidBody {}, &RigidBody {}.neutral(), &start, table.number("period"));
    assert_close("after one period", v.as_slice(), start.as_slice(), 1e-9);
}

/// A body thrown into the air: its centre of mass on a parabola, its angular momentum constant.
#[mechanism(gravity = -9.81 * z)]
struct ThrownBody {
    #[body(mass = 1.5, com = [0.1, -0.2, 0.3], inertia = diagonal(0.2, 0.3, 0.4))]
    hammer: Body,
    #[joint(ground -> hammer)]
    flight: Free,
}

#[test]
fn thrown_body_flies_on_a_parabola() {
    let q = ThrownBody {}.neutral();
    let v = Vector6::new(3.0, 1.0, 4.0, 1.0, 5.0, -2.0);
    let (center, momentum) = (ThrownBody {}.center_of_mass(&q), ThrownBody {}.momentum(&q, &v));
    let weight = Vector3::new(0.0, 0.0, -9.81);
    for t in [0.1, 0.7, 2.0] {
        let (q, v) = advance(&ThrownBody {}, &q, &v, t);
        let velocity = momentum.fixed_rows::<3>(0) / 1.5;
        let expected = center + velocity * t + weight * t * t / 2.0;
        assert_close(
            "centre of mass",
            ThrownBody {}.center_of_mass(&q).as_slice(),
            expected.as_slice(),
            1e-11,
        );
        let mut expected = momentum;
        expected[2] -= 1.5 * 9.81 * t;
        assert_close("momentum", ThrownBody {}.momentum(&q, &v).as_slice(), expected.as_slice(), 1e-11);
    }
}

// ---- PUMA 560 ----------------------------------------------------------------------------------------------------

/// Standard Denavit–Hartenberg parameters: the joint turns about z of the link before, and its place on the link
/// after is the inverse of `Tz(d) Tx(a) Rx(α)`. Inertias are parameters, since two of them are impossible.
#[mechanism(gravity = -9.81 * z)]
struct Puma560 {
    i1: f64,
    i3x: f64,
    i3y: f64,
    i3z: f64,
    right: f64,
    #[body(inertia = diagonal(0, i1, 0))]
    link1: Body,
    #[body(mass = 17.4, com = [-0.3638, 0.006, 0.2275], inertia = diagonal(0.13, 0.524, 0.539))]
    link2: Body,
    #[body(mass = 4.8, com = [-0.0203, -0.0141, 0.070], inertia = diagonal(i3x, i3y, i3z))]
    link3: Body,
    #[body(mass = 0.82, com = 0.019 * y, inertia = diagonal(1.8e-3, 1.3e-3, 1.8e-3))]
    link4: Body,
    #[body(mass = 0.34, inertia = diagonal(0.3e-3, 0.4e-3, 0.3e-3))]
    link5: Body,
    #[body(mass = 0.09, com = 0.032 * z, inertia = diagonal(0.15e-3, 0.15e-3, 0.04e-3))]
    link6: Body,
    #[joint(ground -> link1.at(-0.672 * y).rotated(x(-right)), about = z)]
    waist: Pin,
    #[joint(link1 -> link2.at(-0.4318 * x), about = z)]
    shoulder: Pin,
    #[joint(link2 -> link3.at(-0.0203 * x + 0.15005 * y).rotated(x(right)), about = z)]
    elbow: Pin,
    #[joint(link3 -> link4.at(-0.4318 * y).rotated(x(-right)), about = z)]
    wrist1: Pin,
    #[joint(link4 -> link5.rotated(x(right)), about = z)]
    wrist2: Pin,
    #[joint(link5 -> link6, about = z)]
    wrist3: Pin,
}

#[test]
fn puma560() {
    let robot = Puma560 { i1: 0.35, i3x: 0.066, i3y: 0.086, i3z: 0.0125, right: FRAC_PI_2 };
    let table = Record::load("problems/puma560.json");
    let q = SVector::from(table.rows::<6>("configuration")[0]);
    let links = Matrix6::from_fn(|i, j| table.rows::<6>("mass_matrix")[i][j]);
    let gravity = SVector::from(table.rows::<6>("gravity")[0]);
    let coriolis = SVector::from(table.rows::<6>("coriolis")[0]);

    let mass_matrix = robot.mass_matrix(&q);
    assert_close("mass matrix", mass_matrix.as_slice(), links.as_slice(), 1e-12);
    let load = robot.bias_forces(&q, &SVector::zeros());
    assert_close("gravity", load.as_slice(), gravity.as_slice(), 1e-12);
    let v = Vector6::new(1.0, 2.0, 3.0, 1.0, 2.0, 3.0);
    let turning = robot.bias_forces(&q, &v) - load;
    assert_close("Coriolis forces", turning.as_slice(), coriolis.as_slice(), 1e-12);

    // Published to four decimals, with the motors' inertias Jm G² on the diagonal.
    let motor = Vector6::new(200e-6, 200e-6, 200e-6, 33e-6, 33e-6, 33e-6);
    let gear = Vector6::new(-62.6111, 107.815, -53.7063, 76.0364, 71.923, 76.686);
    let with_motors = mass_matrix + Matrix6::from_diagonal(&motor.component_mul(&gear).component_mul(&gear));
    #[rustfmt::skip]
    let published = Matrix6::new(
        3.6594, -0.4044, 0.1006, -0.0025, 0.0, 0.0,
        -0.4044, 4.4137, 0.3509, 0.0, 0.0024, 0.0,
        0.1006, 0.3509, 0.9378, 0.0, 0.0015, 0.0,
        -0.0025, 0.0, 0.0, 0.1925, 0.0, 0.0,
        0.0, 0.0024, 0.0015, 0.0, 0.1713, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.1941,
    );
    assert_close("published mass matrix", with_motors.as_slice(), published.as_slice(), 5e-5);
    let published = [0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0];
    assert_close("published gravity", load.as_slice(), &published, 5e-5);
    let published = [3.1500, 9.4805, 3.6189, 0.1901, 0.3519, 0.5823];
    assert_close("published M v", (with_motors * v).as_slice(), &published, 5e-5);
    let published = [3.35311, 36.0025, 7.42596, 0.190043, 0.203441, 0.194133];
    let forces = with_motors * Vector6::repeat(1.0) + load;
    assert_close("published M a + g", forces.as_slice(), &published, 5e-6);
}

// ---- Springs, dashpots, blows ------------------------------------------------------------------------------------

/// A mass on a rail, and a wheel on a pin, each with a spring and a dashpot.
#[mechanism]
struct Oscillators {
    m: f64,
    j: f64,
    k: f64,
    c: f64,
    k_turn: f64,
    c_turn: f64,
    #[body(mass = m)]
    block: Body,
    #[body(inertia = diagonal(j, j, j))]
    wheel: Body,
    #[joint(ground -> block, along = x)]
    rail: Sleeve,
    #[joint(ground -> wheel, about = y)]
    axle: Pin,
    #[acts(on = rail, stiffness = k, free_length = 0)]
    spring: Spring,
    #[acts(on = rail, damping = c)]
    dashpot: Dashpot,
    #[acts(on = axle, stiffness = k_turn)]
    torsion_spring: Spring,
    #[acts(on = axle, damping = c_turn)]
    torsion_dashpot: Dashpot,
}

/// `m ẍ + c ẋ + k x = 0` from `x0`, `v0` at time `t`, less than critically damped.
fn damped(m: f64, c: f64, k: f64, [x0, v0]: [f64; 2], t: f64) -> [f64; 2] {
    let (decay, rate) = (c / (2.0 * m), (k / m - c * c / (4.0 * m * m)).sqrt());
    let (sin, cos) = (rate * t).sin_cos();
    let (a, b) = (x0, (v0 + decay * x0) / rate);
    let envelope = (-decay * t).exp();
    let x = envelope * (a * cos + b * sin);
    [x, -decay * x + envelope * rate * (b * cos - a * sin)]
}

#[test]
fn mass_spring_dashpot() {
    // An inerter of 0.5 kg to the ground is half a kilogram more: the published number has both.
    for (m, published) in [(2.5, Some(-0.223_423_268_884_342_75)), (2.0, None)] {
        let oscillators = Oscillators { m, j: 0.3, k: 50.0, c: 3.0, k_turn: 8.0, c_turn: 0.1 };
        let (q, v) = (Vector2::new(1.0, 0.5), Vector2::new(0.0, -2.0));
        let (q, v) = advance(&oscillators, &q, &v, 1.0);
        if let Some(published) = published {
            assert_close("published", &[q[0]], &[published], 1e-13);
        }
        assert_close("sliding", &[q[0], v[0]], &damped(m, 3.0, 50.0, [1.0, 0.0], 1.0), 1e-13);
        assert_close("turning", &[q[1], v[1]], &damped(0.3, 0.1, 8.0, [0.5, -2.0], 1.0), 1e-13);
    }
}

/// `v = v0 exp(−c t / m)`; the stopping distance is `m v0 / c`.
#[test]
fn dashpot_alone() {
    let oscillators = Oscillators { m: 2.0, j: 0.3, k: 0.0, c: 3.0, k_turn: 0.0, c_turn: 0.4 };
    let (q, v) = advance(&oscillators, &Vector2::zeros(), &Vector2::new(4.0, 5.0), 2.0);
    let (slowed, turned) = ((-3.0_f64 * 2.0 / 2.0).exp(), (-0.4_f64 * 2.0 / 0.3).exp());
    assert_close("speeds", v.as_slice(), &[4.0 * slowed, 5.0 * turned], 1e-13);
    let distances = [2.0 * 4.0 / 3.0 * (1.0 - slowed), 0.3 * 5.0 / 0.4 * (1.0 - turned)];
    assert_close("distances", q.as_slice(), &distances, 1e-13);
}

/// wall, k1 = 100, m1 = 2, k2 = 40, m2 = 1: the second mass slides on the first, so the second spring is on its joint.
#[mechanism]
struct TwoMasses {
    #[body(mass = 2)]
    first: Body,
    #[body(mass = 1)]
    second: Body,
    #[joint(ground -> first, along = x)]
    rail: Sleeve,
    #[joint(first -> second, along = x)]
    slide: Sleeve,
    #[acts(on = rail, stiffness = 100, free_length = 0.3)]
    anchor: Spring,
    #[acts(on = slide, stiffness = 40, free_length = 0.2)]
    coil: Spring,
}

#[test]
fn natural_frequencies_of_two_masses() {
    let at_rest = Vector2::new(0.3, 0.2);
    let force = |q: Vector2<f64>| TwoMasses {}.bias_forces(&(at_rest + q), &Vector2::zeros());
    assert_close("at rest", force(Vector2::zeros()).as_slice(), &[0.0, 0.0], 1e-14);
    let stiffness = Matrix2::from_columns(&[force(Vector2::x()), force(Vector2::y())]);
    let factor = TwoMasses {}.mass_matrix(&at_rest).cholesky().expect("a positive mass matrix");
    let inverse = factor.l().try_inverse().expect("a regular factor");
    let mut squares = (inverse * stiffness * inverse.transpose()).symmetric_eigenvalues();
    squares.as_mut_slice().sort_by(f64::total_cmp);
    // 2 ω⁴ − 220 ω² + 4000 = 0
    let root = 16_400_f64.sqrt();
    assert_close("ω²", squares.as_slice(), &[(220.0 - root) / 4.0, (220.0 + root) / 4.0], 1e-13);
}

/// A rod on a table, struck at a distance from its centre.
#[mechanism]
struct StruckRod {
    m: f64,
    l: f64,
    distance: f64,
    #[body(mass = m, inertia = rod(m, l, x))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    table: Planar,
    #[acts(on = rod.at(distance * x), along = y)]
    blow: Force,
}

/// The rod begins to turn about a point at `l² / (12 d)` on the other side of its centre.
#[test]
fn centre_of_percussion() {
    let rod = StruckRod { m: 1.2, l: 0.9, distance: 0.25 };
    let start = rod.neutral();
    let change = rod.forward_dynamics(
        &start,
        &SVector::zeros(),
        &rod.generalized_forces(&start, &SVector::from([3.0])),
    );
    let turning_point = rod.l * rod.l / (12.0 * rod.distance);
    let expected = [0.0, 3.0 / rod.m, 3.0 / rod.m / turning_point];
    assert_close("change of velocity", change.as_slice(), &expected, 1e-14);
}

/// Falling flat at speed `v` on a stop at its end, with restitution e: an impulse of `m v (1 + e) / 4`, after which
/// it turns at `1.5 (1 + e) v / l` and its centre falls at `v (3 − e) / 4`.
#[test]
fn falling_rod_strikes_a_stop() {
    let (m, l, speed, restitution) = (1.2, 0.9, 2.0, 0.6);
    let rod = StruckRod { m, l, distance: -l / 2.0 };
    let start = rod.neutral();
    let impulse = SVector::from([m * speed * (1.0 + restitution) / 4.0]);
    let change =
        rod.mass_matrix(&start).try_inverse().expect("mass") * rod.generalized_forces(&start, &impulse);
    let after = Vector3::new(0.0, -speed, 0.0) + change;
    let expected = [0.0, -speed * (3.0 - restitution) / 4.0, -1.5 * (1.0 + restitution) * speed / l];
    assert_close("after", after.as_slice(), &expected, 1e-14);
    let end = after[1] - after[2] * l / 2.0;
    assert_close("restitution", &[end], &[speed * restitution], 1e-14);
}

/// A nut that slides down a fixed screw as it turns.
#[mechanism(gravity = -9.81 * z)]
struct Nut {
    m: f64,
    j: f64,
    p: f64,
    #[body(mass = m, inertia = diagonal(j, j, j))]
    nut: Body,
    #[joint(ground -> nut, about = z, pitch = p)]
    thread: Screw,
}

/// `θ̈ = −m g p / (J + m p²)`.
#[test]
fn nut_on_a_screw() {
    let nut = Nut { m: 0.8, j: 0.002, p: 0.01 };
    let acceleration = -nut.m * 9.81 * nut.p / (nut.j + nut.m * nut.p * nut.p);
    let (q, v) = advance(&nut, &SVector::from([1.0]), &SVector::from([3.0]), 0.5);
    let expected = [1.0 + 3.0 * 0.5 + acceleration * 0.125, 3.0 + acceleration * 0.5];
    assert_close("turn", &[q[0], v[0]], &expected, 1e-13);
    let height = nut.frame_placement(frame!(Nut, "nut"), &q).translation.vector.z;
    assert_close("height", &[height], &[nut.p * expected[0]], 1e-13);
}
