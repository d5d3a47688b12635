//! Linear systems of aircraft, lags, rotors and satellites, computed from mechanisms and compared with closed
//! forms.

#[path = "support/compare.rs"]
mod compare;

use compare::assert_relatively_close;
use linkwork::constraint::stabilized;
use linkwork::prelude::*;
use linkwork_design::mechanism::{constrained_system, linear_system, measured_system, second_order_form};
use linkwork_design::steady::{constrained_equilibrium, equilibrium};
use linkwork_design::{Error, Signal, StateSpace};
use nalgebra::Complex;

#[track_caller]
fn assert_contains_pole(system: &StateSpace, re: f64, im: f64) {
    let (all, expected) = (system.poles().unwrap(), Complex::new(re, im));
    assert!(
        all.iter().any(|pole| (pole - expected).norm() <= 1e-10 * expected.norm()),
        "expected {expected} among {all:?}"
    );
}

/// Aircraft with lift `k V²` perpendicular to its velocity and without drag (Lanchester 1908).
#[mechanism(gravity = -g * y, derivatives)]
struct LanchesterAircraft {
    g: f64,
    mass: f64,
    k: f64,
    #[joint(ground -> craft, along = (x, y))]
    place: Stage,
    #[particle(mass = mass)]
    craft: Particle,
    #[define(v(craft / ground / ground))]
    velocity: Vector,
    #[acts(on = craft, value = k * norm(velocity) * cross(ground.z, velocity))]
    lift: Force,
}

#[test]
fn phugoid_matches_lanchester() {
    let (g, u0, mass) = (9.81, 235.9, 2.9e5);
    let craft = LanchesterAircraft { g, mass, k: mass * g / (u0 * u0) };
    let system = linear_system(&craft, &[0.0, 0.0].into(), &[u0, 0.0].into(), &[].into()).unwrap();
    let modes = system.modes().unwrap();
    let phugoid = modes.iter().find(|mode| mode.pole.im > 0.0).unwrap();
    let period = std::f64::consts::TAU / phugoid.damped_frequency();
    assert_relatively_close(period, 106.8375214181, 1e-11);
    assert_relatively_close(period, std::f64::consts::PI * 2.0_f64.sqrt() * u0 / g, 1e-13);
    assert!(phugoid.pole.re.abs() < 1e-12);
}

/// Test mechanism: a wing with constant coefficients of lift and drag and a thrust along the path, without
/// outputs.
#[mechanism(gravity = 9.81 * z, derivatives)]
struct Wing {
    mass: f64,
    lift_area: f64,
    drag_area: f64,
    thrust: Input,
    #[joint(ground -> wing, along = (x, z))]
    place: Stage,
    #[particle(mass = mass)]
    wing: Particle,
    #[define(v(wing / ground / ground))]
    velocity: Vector,
    #[define(1.2 / 2 * norm(velocity))]
    pressure: Scalar,
    #[acts(on = wing, value = pressure * lift_area * cross(ground.y, velocity))]
    lift: Force,
    #[acts(on = wing, value = -pressure * drag_area * velocity)]
    drag: Force,
    #[acts(on = wing, value = thrust * unit(velocity))]
    engine: Force,
}

/// Checks that a glide descends at `tan γ = C_D / C_L`, that level flight needs the thrust `m g C_D / C_L`,
/// and that with a given sink rate `w` the thrust is the drag minus `m g w / V`.
#[test]
fn glide_and_level_flight_match_closed_form() {
    let wing = Wing { mass: 300.0, lift_area: 9.0, drag_area: 0.45 };
    let weight = 300.0 * 9.81;
    let trim_problem_of_wing = || equilibrium(&wing).moving([30.0, 1.0].into()).fix(["place.x", "place.y"]);
    let glide = trim_problem_of_wing().speeds(["place.x", "place.y"]).find().unwrap();
    assert_relatively_close(glide.v[1].atan2(glide.v[0]), (0.45_f64 / 9.0).atan(), 1e-12);
    assert_relatively_close(0.6 * glide.v.norm_squared() * 9.0_f64.hypot(0.45), weight, 1e-12);

    let trim_with_sink_rate = |w: f64| {
        let trim = trim_problem_of_wing().speeds(["place.x", "place.y"]).inputs(["thrust"]);
        trim.condition("sink", w, |_, _, v, _| v[1]).find().unwrap()
    };
    let level = trim_with_sink_rate(0.0);
    assert!(level.v[1].abs() < 1e-12);
    assert_relatively_close(level.u[0], weight * 0.05, 1e-11);
    assert_relatively_close(0.6 * level.v[0].powi(2) * 9.0, weight, 1e-11);
    for w in [-3.0, 0.5, glide.v[1]] {
        let found = trim_with_sink_rate(w);
        let speed = found.v.norm();
        assert_relatively_close(found.v[1], w, 1e-11);
        assert_relatively_close(found.u[0], 0.6 * speed.powi(2) * 0.45 - weight * w / speed, 1e-9);
        assert_relatively_close(0.6 * speed.powi(2) * 9.0, weight * found.v[0] / speed, 1e-11);
    }

    // A condition that cannot hold is reported by its name, and so is one that is given twice.
    let never = trim_problem_of_wing()
        .speeds(["place.x", "place.y"])
        .condition("sink", 0.0, |_, _, v, _| v[1])
        .find();
    assert!(matches!(never, Err(Error::NoSteadyState { .. })), "{never:?}");
    let twice = trim_problem_of_wing().condition("sink", 0.0, |_, _, v, _| v[1]).condition(
        "sink",
        1.0,
        |_, _, v, _| v[1],
    );
    assert!(matches!(twice.find(), Err(Error::Repeated { kind: "condition", .. })));
}

/// Test mechanism: boat whose thrust follows the throttle with a lag.
#[mechanism(derivatives)]
struct Boat {
    mass: f64,
    drag: f64,
    lag: f64,
    throttle: Input,
    #[state(rate = (throttle - thrust) / lag)]
    thrust: State,
    #[body(mass = mass)]
    hull: Body,
    #[joint(ground -> hull, along = x)]
    way: Sleeve,
    #[acts(on = way, value = thrust - drag * rate(way) * rate(way))]
    propeller: Force,
}

#[test]
fn trim_solves_for_first_order_states() {
    let boat = Boat { mass: 800.0, drag: 20.0, lag: 2.0, thrust: 0.0 };
    let whole = boat.extended();
    // At 5 m/s the drag is 500 N; thrust and throttle must equal it.
    let trim = equilibrium(&whole).moving([5.0, 0.0].into()).fix(["way"]).inputs(["throttle"]);
    let found = trim.find().unwrap();
    assert_relatively_close(found.v[1], 500.0, 1e-12);
    assert_relatively_close(found.u[0], 500.0, 1e-12);
    let system = trim.linear_system(&found).unwrap();
    let names: Vec<&str> = system.states().iter().map(|state| state.name.as_str()).collect();
    assert_eq!(names, ["way", "way'", "thrust"]);
    let mut poles: Vec<f64> = system.poles().unwrap().iter().map(|pole| pole.re).collect();
    poles.sort_by(f64::total_cmp);
    // Poles: the lag, 2 k v / m of the drag, and zero for the position, on which nothing depends.
    assert_relatively_close(poles[0], -0.5, 1e-12);
    assert_relatively_close(poles[1], -0.25, 1e-12);
    assert!(poles[2].abs() < 1e-12);
    let whole = linear_system(&at(&whole, 0.0), &found.q, &found.v, &found.u).unwrap();
    assert!((whole.a() - system.a()).norm() < 1e-12 && (whole.b() - system.b()).norm() < 1e-12);
}

/// Disk on a rotating elastic shaft, with external damping and internal damping in the shaft.
#[mechanism(derivatives)]
struct DampedRotor {
    mass: f64,
    stiffness: f64,
    outside: f64,
    within: f64,
    spin: f64,
    #[joint(ground -> disk, along = (x, y))]
    bow: Stage,
    #[particle(mass = mass)]
    disk: Particle,
    #[define(r(disk / ground))]
    place: Vector,
    #[define(v(disk / ground / ground))]
    velocity: Vector,
    #[acts(on = disk, value = -stiffness * place - outside * velocity)]
    shaft: Force,
    #[acts(on = disk, value = -within * (velocity - cross(spin * ground.z, place)))]
    friction: Force,
}

/// Compares the poles with those of `m z̈ + (cₑ + cᵢ) ż + (k − i cᵢ Ω) z = 0` for `z = x + i y` (Genta,
/// *Dynamics of Rotating Systems*, 2005, § 2.6). The rotor is unstable above the rate `ω (1 + cₑ / cᵢ)`.
#[test]
fn internally_damped_rotor_has_genta_poles() {
    let rotor_with_spin =
        |spin| DampedRotor { mass: 3.0, stiffness: 1200.0, outside: 2.0, within: 5.0, spin };
    let linear_system_of_spinning_rotor = |spin| {
        linear_system(&rotor_with_spin(spin), &[0.0, 0.0].into(), &[0.0, 0.0].into(), &[].into()).unwrap()
    };
    for spin in [0.0, 15.0, 40.0] {
        let (m, c) = (3.0, 7.0);
        let root = (Complex::new(c * c - 4.0 * m * 1200.0, 4.0 * m * 5.0 * spin)).sqrt();
        for pole in [(root - c) / (2.0 * m), (-root - c) / (2.0 * m)] {
            assert_contains_pole(&linear_system_of_spinning_rotor(spin), pole.re, pole.im);
            assert_contains_pole(&linear_system_of_spinning_rotor(spin), pole.re, -pole.im);
        }
    }
    let threshold = (1200.0_f64 / 3.0).sqrt() * (1.0 + 2.0 / 5.0);
    assert!(linear_system_of_spinning_rotor(threshold * (1.0 - 1e-6)).is_stable().unwrap());
    assert!(!linear_system_of_spinning_rotor(threshold * (1.0 + 1e-6)).is_stable().unwrap());
}

/// Test mechanism: a balanced rotor in massless gimbals.
#[mechanism(derivatives)]
struct BalancedRotor {
    axial: f64,
    across: f64,
    #[body]
    outer: Body,
    #[body]
    inner: Body,
    #[body(mass = 1, inertia = diagonal(across, across, axial))]
    rotor: Body,
    #[joint(ground -> outer, about = z)]
    precession: Pin,
    #[joint(outer -> inner, about = x)]
    nutation: Pin,
    #[joint(inner -> rotor, about = z)]
    spin: Pin,
}

/// Checks the nutation frequency `C n / A` (Magnus, *Kreisel*, 1971).
#[test]
fn gyroscope_nutation_has_textbook_frequency() {
    let (rotor, n) = (BalancedRotor { axial: 0.03, across: 0.02 }, 70.0);
    let q = [0.0, std::f64::consts::FRAC_PI_2, 0.0].into();
    let system = linear_system(&rotor, &q, &[0.0, 0.0, n].into(), &[].into()).unwrap();
    assert_contains_pole(&system, 0.0, rotor.axial * n / rotor.across);
    let other = system.poles().unwrap();
    assert_eq!(other.iter().filter(|pole| pole.norm() < 1e-6).count(), 4);
}

/// Test mechanism: satellite on a circular orbit, with x radially outward, y forward and z normal to the
/// orbit.
#[mechanism(derivatives)]
struct Satellite {
    mu: f64,
    radius: f64,
    rate: f64,
    ixx: f64,
    iyy: f64,
    izz: f64,
    #[frame(ground, z(rate * t))]
    orbit: Frame,
    #[body(at = radius * orbit.x, frame = orbit)]
    place: Body,
    #[body(mass = 1, inertia = diagonal(ixx, iyy, izz))]
    satellite: Body,
    #[joint(place -> satellite)]
    attitude: Ball,
    #[acts(between = (ground, satellite), mu = mu)]
    gravity: Gravity,
}

/// Compares with the pitch frequency `Ω √(3 (I_roll − I_yaw) / I_pitch)` and, for roll and yaw, the roots of
/// `s⁴ + (1 + 3 k₁ + k₁ k₃) Ω² s² + 4 k₁ k₃ Ω⁴` with `k₁ = (I_pitch − I_yaw) / I_roll` and
/// `k₃ = (I_pitch − I_roll) / I_yaw` (Hughes, *Spacecraft Attitude Dynamics*, 1986, § 9.2).
#[test]
fn gravity_gradient_stabilises_satellite() {
    let (mu, radius) = (3.986004418e14_f64, 7.0e6_f64);
    let rate = (mu / radius.powi(3)).sqrt();
    let (yaw, roll, pitch) = (100.0, 420.0, 500.0);
    let satellite = Satellite { mu, radius, rate, ixx: yaw, iyy: roll, izz: pitch };
    for t in [0.0, 1234.5] {
        let now = at(&satellite, t);
        let system = linear_system(&now, &now.neutral(), &SVector::zeros(), &[].into()).unwrap();
        assert_contains_pole(&system, 0.0, rate * (3.0 * (roll - yaw) / pitch).sqrt());
        let (k1, k3) = ((pitch - yaw) / roll, (pitch - roll) / yaw);
        let b = 1.0 + 3.0 * k1 + k1 * k3;
        for sign in [1.0, -1.0] {
            let squared = (b + sign * (b * b - 16.0 * k1 * k3).sqrt()) / 2.0;
            assert_contains_pole(&system, 0.0, rate * squared.sqrt());
        }
    }
}

/// Test mechanism: sled whose thrust follows the throttle with a lag, with an accelerometer and a gauge as
/// outputs.
#[mechanism(derivatives)]
struct Sled {
    mass: f64,
    lag: f64,
    throttle: Input,
    #[state(rate = (throttle - thrust) / lag)]
    thrust: State,
    #[body(mass = mass)]
    sled: Body,
    #[joint(ground -> sled, along = x)]
    rail: Sleeve,
    #[acts(on = rail, value = thrust)]
    engine: Force,
    #[output(dot(a(sled / ground / ground), x))]
    felt: Scalar,
    #[output(thrust + throttle / 2)]
    gauge: Scalar,
}

/// Compares transfer functions of the outputs with `felt = 1 / (m (τ s + 1))` and
/// `gauge = 1 / (τ s + 1) + ½`.
#[test]
fn outputs_include_first_order_states() {
    let (mass, lag) = (2.0, 0.25);
    let sled = Sled { mass, lag, thrust: 0.0 };
    let whole = sled.extended();
    let system =
        measured_system(&at(&whole, 0.0), 0.0, &[0.0].into(), &[3.0, 5.0].into(), &[5.0].into()).unwrap();
    for omega in [0.1, 4.0, 60.0] {
        let late = Complex::new(1.0, lag * omega).inv();
        let answer = system.at(Complex::new(0.0, omega)).unwrap();
        for (found, expected) in answer.iter().zip([late / mass, late + 0.5]) {
            assert!((found - expected).norm() < 1e-14, "expected {expected}, found {found}");
        }
    }
}

/// Test mechanism: carriage on a parabola, with a force as input.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct Carriage {
    mass: f64,
    #[body(mass = mass)]
    carriage: Body,
    #[joint(ground -> carriage, along = (x, y))]
    place: Stage,
    #[constraint(place.y == place.x * place.x)]
    wire: Holonomic,
    #[acts(on = place.x)]
    push: Force,
    #[output(norm(v(carriage / ground / ground)))]
    speed: Scalar,
}

/// Checks that a linearisation in all displacements has two zero eigenvalues for a holonomic constraint, in
/// addition to those of the motion.
#[test]
fn displacements_add_zero_eigenvalues() {
    let zero = SVector::zeros();
    let system = linear_system(&Carriage { mass: 2.0 }, &zero, &zero, &[0.0].into()).unwrap();
    assert_contains_pole(&system, 0.0, (2.0_f64 * 9.81).sqrt());
    let poles = system.poles().unwrap();
    assert!(poles.len() == 4 && poles.iter().filter(|pole| pole.norm() < 1e-7).count() == 2, "{poles:?}");
}

/// Checks that a constraint stabilised with the rate `α` adds the eigenvalue `−α` twice.
#[test]
fn stabilised_constraints_add_decay_poles() {
    let (carriage, rate) = (Carriage { mass: 2.0 }, 7.0);
    let decaying = stabilized(&carriage, rate);
    let zero = SVector::zeros();
    let system = linear_system(&at(&decaying, 0.0), &zero, &zero, &[0.0].into()).unwrap();
    // At the lowest point of y = x²: ẍ = F / m − 2 g x.
    let own = (2.0_f64 * 9.81).sqrt();
    assert_contains_pole(&system, 0.0, own);
    assert_contains_pole(&system, 0.0, -own);
    let characteristic = system.channel("place.x", "push").unwrap();
    assert_eq!(system.poles().unwrap().len(), 4);
    let is_near_decay_rate = |pole: &Complex<f64>| (pole + rate).norm() < 1e-6 * rate;
    assert_eq!(system.poles().unwrap().iter().filter(|pole| is_near_decay_rate(pole)).count(), 2);
    // The push does not excite the decaying constraint.
    let (s, answer) = (Complex::new(0.3, 2.0), characteristic.at(Complex::new(0.3, 2.0)).unwrap());
    let expected = (s * s + 2.0 * 9.81).inv() / 2.0;
    assert!((answer[0] - expected).norm() < 1e-12, "{answer} {expected}");
}

fn signal_texts(signals: &[Signal]) -> Vec<String> {
    signals.iter().map(ToString::to_string).collect()
}

/// Checks names and units of signals for a tree with a state of first order, for a mechanism with prescribed
/// motion, and with constraints.
#[test]
fn signals_have_names_and_units() {
    let sled = Sled { mass: 2.0, lag: 0.5, thrust: 0.0 };
    let whole = sled.extended();
    let system =
        measured_system(&at(&whole, 0.0), 0.0, &[0.0].into(), &[3.0, 5.0].into(), &[5.0].into()).unwrap();
    assert_eq!(signal_texts(system.states()), ["rail, m", "rail', m/s", "thrust, N"]);
    assert_eq!(signal_texts(system.inputs()), ["throttle, N"]);
    assert_eq!(signal_texts(system.outputs()), ["felt, m/s²", "gauge, N"]);

    let satellite = Satellite { mu: 4e14, radius: 7e6, rate: 1e-3, ixx: 100.0, iyy: 420.0, izz: 500.0 };
    let now = at(&satellite, 3.0);
    let system = linear_system(&now, &now.neutral(), &SVector::zeros(), &[].into()).unwrap();
    assert_eq!(signal_texts(system.states())[2..4], ["attitude.wz, rad", "attitude.wx', rad/s"]);

    let (carriage, zero) = (Carriage { mass: 2.0 }, SVector::zeros());
    let linear = carriage.linearize(&zero, &zero, &[0.0].into(), &[0]).unwrap();
    let of_state = constrained_system(&carriage, &linear).unwrap();
    let problem = constrained_equilibrium(&carriage).moving([0.1, 0.0].into()).fix(["place.x"]);
    let of_states = problem.linear_system(&constrained_equilibrium(&carriage).find().unwrap()).unwrap();
    for system in [&of_state, &of_states] {
        assert_eq!(signal_texts(system.states()), ["place.x, m", "place.x', m/s"]);
        assert_eq!(signal_texts(system.inputs()), ["push, N"]);
    }
    assert_eq!(<Carriage as linkwork::Outputs<2, 2, 1, 1>>::OUTPUT_UNITS, ["m/s"]);
    let form = second_order_form(
        &Boat { mass: 1.0, drag: 0.0, lag: 1.0, thrust: 0.0 },
        &[0.0].into(),
        &[0.0].into(),
        &[0.0].into(),
    );
    assert_eq!(signal_texts(form.unwrap().state_space().unwrap().states()), ["way, m", "way', m/s"]);
}
