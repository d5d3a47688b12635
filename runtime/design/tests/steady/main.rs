//! Equilibria and steady motions, compared with closed forms.

#[path = "../support/compare.rs"]
mod compare;
mod loads;

use compare::assert_relatively_close;
use linkwork::prelude::*;
use linkwork_design::Error;
use linkwork_design::steady::{Verdict, constrained_equilibrium, equilibrium};
use nalgebra::vector;
use std::f64::consts::PI;

/// Finds a root of a function between two points by bisection.
fn root_by_bisection(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let side = f(low) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == side { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Test mechanism: chain of six links between two pins at the same height.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct HangingChain {
    span: f64,
    #[body(mass = 0.3, com = 0.1 * x, inertia = rod(0.3, 0.2, x))]
    link: [Body; 6],
    #[joint(ground -> link[0], about = z)]
    first: Pin,
    #[joint(link[i].at(0.2 * x) -> link[i + 1], about = z)]
    hinge: [Pin; 5],
    #[joint(link[5].at(0.2 * x) -> ground.at(span * x), about = z)]
    last: Pin,
}

/// Compares the steady state of a hanging chain of heavy links with its exact slopes,
/// `tan φₖ = (k − 5/2) w / H`, where `w` is the weight of a link. The horizontal force `H` is such that the
/// chain spans the distance of the pins.
#[test]
fn chain_hangs_in_catenary() {
    let (chain, weight) = (HangingChain { span: 0.9 }, 0.3 * 9.81);
    let slope_of_link = |pull: f64, k: usize| ((k as f64 - 2.5) * weight / pull).atan();
    let excess_reach = |pull: f64| (0..6).map(|k| 0.2 * slope_of_link(pull, k).cos()).sum::<f64>() - 0.9;
    let pull = root_by_bisection(excess_reach, 0.1, 100.0);
    let problem = constrained_equilibrium(&chain).from([-1.0, 0.3, 0.3, 0.3, 0.3, 0.3].into());
    let found = problem.find().unwrap();
    let mut angle = 0.0;
    for k in 0..6 {
        angle += found.q[k];
        assert_relatively_close(angle, slope_of_link(pull, k), 1e-10);
    }
    let [(x, horizontal), (y, vertical)] = found.multipliers[..] else { panic!("two multipliers") };
    assert_eq!((x, y), ("last.x", "last.y"));
    assert_relatively_close(horizontal.abs(), pull, 1e-10);
    assert_relatively_close(vertical.abs(), 3.0 * weight, 1e-10);
    let stiffness = problem.stiffness(&found).unwrap();
    assert_eq!((stiffness.verdict(), stiffness.curvatures.len()), (Verdict::Stable, 4));
    let system = problem.linear_system(&found).unwrap();
    for (curvature, mode) in stiffness.curvatures.iter().zip(system.modes().unwrap()) {
        assert_relatively_close(mode.frequency(), curvature.sqrt(), 1e-6);
    }
    // The arch, which is the mirrored shape, is also an equilibrium.
    let arch = problem.from([1.0, -0.3, -0.3, -0.3, -0.3, -0.3].into());
    let standing = arch.find().unwrap();
    assert!((standing.q + found.q).amax() < 1e-9, "{} {}", standing.q, found.q);
    assert_eq!(arch.stiffness(&standing).unwrap().verdict(), Verdict::Unstable);
}

/// Test mechanism: Watt's governor, two balls on arms that hang from a rotating shaft.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct WattGovernor {
    #[body(mass = 1, inertia = diagonal(0.1, 0.1, 0.1))]
    shaft: Body,
    #[body]
    left: Body,
    #[body]
    right: Body,
    #[joint(ground -> shaft, about = z)]
    turn: Pin,
    #[joint(shaft -> left, about = y)]
    hinge: Pin,
    #[joint(shaft -> right, about = -y)]
    other: Pin,
    #[particle(mass = 2, at = left.at(-0.4 * z))]
    ball: Particle,
    #[particle(mass = 2, at = right.at(-0.4 * z))]
    other_ball: Particle,
}

#[test]
fn governor_arms_rise_with_speed() {
    let speed = 7.0_f64;
    let lifted = (9.81 / (speed * speed * 0.4)).acos();
    let problem = equilibrium(&WattGovernor {}).fix(["turn"]).moving(vector![speed, 0.0, 0.0]);
    let found = problem.from(vector![0.0, -0.8, -0.8]).find().unwrap();
    assert_relatively_close(found.q[1], -lifted, 1e-12);
    assert_relatively_close(found.q[2], -lifted, 1e-12);
    // Inverse problem: at which speed are the arms raised by one radian?
    let problem = equilibrium(&WattGovernor {}).from(vector![0.0, 1.0, 1.0]).coordinates([] as [&str; 0]);
    let problem = problem.moving(vector![5.0, 0.0, 0.0]).speeds(["turn"]);
    assert_relatively_close(problem.find().unwrap().v[0], (9.81 / (0.4 * 1.0_f64.cos())).sqrt(), 1e-12);
    assert!(matches!(problem.stiffness(&problem.find().unwrap()), Err(Error::NoPotential { .. })));
}

/// Test mechanism: bead on a hoop that rotates at constant speed.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct RotatingHoop {
    spin: f64,
    theta: Coordinate,
    #[frame(ground, z(spin * t))]
    hoop: Frame,
    #[particle(mass = 0.2, at = 0.5 * (sin(theta) * hoop.x - cos(theta) * hoop.z))]
    bead: Particle,
}

#[test]
fn bead_on_hoop_has_four_equilibria() {
    let hoop = RotatingHoop { spin: 6.0 };
    let lifted = (9.81 / (36.0 * 0.5_f64)).acos();
    let guesses = [-3.0, -2.5, -1.2, -0.3, 0.1, 0.2, 0.9, 1.1, 3.1].map(|x| vector![x]);
    let mut problem = equilibrium(&hoop);
    let mut all = problem.find_all(guesses).unwrap();
    all.sort_by(|a, b| a.q[0].total_cmp(&b.q[0]));
    let expected = [
        (-PI, Verdict::Unstable),
        (-lifted, Verdict::Stable),
        (0.0, Verdict::Unstable),
        (lifted, Verdict::Stable),
        (PI, Verdict::Unstable),
    ];
    assert_eq!(all.len(), expected.len());
    for (found, (theta, verdict)) in all.iter().zip(expected) {
        assert!((found.q[0] - theta).abs() < 1e-12, "{theta}: {}", found.q[0]);
        assert_eq!(problem.stiffness(found).unwrap().verdict(), verdict, "at {theta}");
    }
    let mode = &problem.linear_system(&all[3]).unwrap().modes().unwrap()[0];
    assert_relatively_close(mode.frequency(), 6.0 * lifted.sin(), 1e-12);
}

/// Test mechanism: a spinning top in massless gimbals.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct GimballedTop {
    #[body]
    turned: Body,
    #[body]
    tilted: Body,
    #[body(mass = 0.3, com = 0.05 * z, inertia = diagonal(1.8e-4, 1.8e-4, 2.4e-4))]
    top: Body,
    #[joint(ground -> turned, about = z)]
    precession: Pin,
    #[joint(turned -> tilted, about = x)]
    nutation: Pin,
    #[joint(tilted -> top, about = z)]
    spin: Pin,
    #[output(dot(omega(top / ground), top.z))]
    axial_rate: Scalar,
}

/// Compares the steady precessions with the roots of `A Ω² cos θ − C n Ω + m g h = 0`, a slow and a fast one.
/// Nutations about them have `ω² = Ω² − 2 κ cos θ + κ² / Ω²` with `κ = m g h / A` (Goldstein, Poole and
/// Safko, *Classical Mechanics*, 2002, § 5.7; Routh, *Advanced Rigid Dynamics*, 1905, § 207).
#[test]
fn top_precesses_slowly_or_fast() {
    let (theta, n) = (0.5_f64, 150.0_f64);
    let (a, c, moment) = (1.8e-4 + 0.3 * 0.05 * 0.05, 2.4e-4, 0.3 * 9.81 * 0.05);
    let discriminant = ((c * n).powi(2) - 4.0 * a * theta.cos() * moment).sqrt();
    for (guess, rate) in [
        (1.0, 2.0 * moment / (c * n + discriminant)),
        (100.0, (c * n + discriminant) / (2.0 * a * theta.cos())),
    ] {
        let problem = equilibrium(&GimballedTop {})
            .from(vector![0.0, theta, 0.0])
            .coordinates([] as [&str; 0])
            .moving(vector![guess, 0.0, n])
            .speeds(["precession", "spin"])
            .output("axial_rate", n);
        let found = problem.find().unwrap();
        assert_relatively_close(found.v[0], rate, 1e-12);
        assert_relatively_close(found.v[2] + found.v[0] * theta.cos(), n, 1e-12);
        let kappa = moment / a;
        let expected = (rate * rate - 2.0 * kappa * theta.cos() + (kappa / rate).powi(2)).sqrt();
        let modes = problem.linear_system(&found).unwrap().modes().unwrap();
        assert_relatively_close(modes.last().unwrap().frequency(), expected, 1e-6);
    }
    // A top that spins too slowly cannot precess at this inclination.
    let slow = equilibrium(&GimballedTop {})
        .from(vector![0.0, theta, 0.0])
        .coordinates([] as [&str; 0])
        .moving(vector![10.0, 0.0, 50.0])
        .speeds(["precession", "spin"])
        .output("axial_rate", 50.0);
    let error = slow.find().unwrap_err();
    let Error::NoSteadyState { condition, unknowns: 2, .. } = &error else { panic!("{error}") };
    assert_eq!(condition, "nutation''");
}

/// Test mechanism: cart on a rail with an inverted pendulum.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct CartPole {
    #[body(mass = 2)]
    cart: Body,
    #[body(mass = 0.3, com = 0.5 * y, inertia = rod(0.3, 1, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,
    #[acts(on = cart, along = x)]
    push: Force,
}

#[test]
fn steady_state_errors_name_the_variable() {
    let cart = CartPole {};
    // The position of the cart is not determined.
    let error = equilibrium(&cart).find().unwrap_err();
    assert!(matches!(&error, Error::Undetermined { unknowns, .. } if unknowns == &["rail"]), "{error}");
    assert!(equilibrium(&cart).nearest().find().is_ok());
    // A force acts on the cart, and nothing balances it.
    let error = equilibrium(&cart).fix(["rail"]).with_inputs(vector![5.0]).find().unwrap_err();
    let Error::NoSteadyState { conditions: 2, unknowns: 1, residual, place, .. } = &error else {
        panic!("{error}")
    };
    assert!(residual.abs() > 0.1 && place[1].0 == "hinge", "{error}");
    // The pole remains at a constant angle while the cart accelerates: the acceleration is g times the
    // tangent of the angle.
    let leaning =
        equilibrium(&cart).coordinates(["hinge"]).acceleration("rail", 2.0).inputs(["push"]).find().unwrap();
    assert_relatively_close(leaning.q[1], -(2.0 / 9.81_f64).atan(), 1e-12);
    assert_relatively_close(leaning.u[0], 2.3 * 2.0, 1e-12);
    // With a locked cart, the pole is unstable, and the system has one degree of freedom.
    let held = equilibrium(&cart).hold(["rail"]);
    let upright = held.find().unwrap();
    let system = held.linear_system(&upright).unwrap();
    assert_eq!(system.states()[0].name, "hinge");
    let poles = system.poles().unwrap();
    assert_relatively_close(
        poles.iter().map(|pole| pole.re).fold(0.0, f64::max),
        (1.5_f64 * 9.81).sqrt(),
        1e-12,
    );
    assert_eq!(held.stiffness(&upright).unwrap().verdict(), Verdict::Unstable);
    let error = equilibrium(&cart).fix(["hinges"]).find().unwrap_err();
    assert_eq!(error.to_string(), "no coordinate `hinges`, perhaps `hinge`; there are rail, hinge");
    let error = equilibrium(&cart).find_all([]).unwrap_err();
    assert!(matches!(error, Error::Count { what: "guesses", .. }));
    let error = equilibrium(&cart).from(vector![f64::NAN, f64::NAN]).find().unwrap_err();
    assert!(matches!(error, Error::NotFinite { .. }), "{error}");
}

/// Test mechanism: aircraft with lift, drag and pitching moment; aileron and rudder are torques.
#[mechanism(gravity = 9.81 * z, derivatives)]
struct TrimmedAircraft {
    elevator: Input,
    aileron: Input,
    rudder: Input,
    #[body(mass = 1050, inertia = [[1290, 0, -40], [0, 1830, 0], [-40, 0, 2670]])]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,
    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[define(omega(airframe / ground))]
    turning: Vector,
    #[define(atan2(dot(velocity, airframe.z), dot(velocity, airframe.x)))]
    attack: Scalar,
    #[define(1.225 / 2 * 16.2 * dot(velocity, velocity))]
    load: Scalar,
    #[define(0.3 + 4.6 * attack)]
    cl: Scalar,
    #[acts(on = airframe, value = load * cl * (sin(attack) * airframe.x - cos(attack) * airframe.z))]
    lift: Force,
    #[acts(
        on = airframe,
        value = -load * (0.03 + 0.05 * cl * cl) * (cos(attack) * airframe.x + sin(attack) * airframe.z)
    )]
    drag: Force,
    #[acts(on = airframe, value = load * 1.5 * (0.02 - 0.9 * attack - 1.3 * elevator - 9 * dot(turning, airframe.y) / norm(velocity)) * airframe.y)]
    pitch: Torque,
    #[acts(on = airframe, along = airframe.x)]
    thrust: Force,
    #[acts(on = airframe, value = aileron * airframe.x + rudder * airframe.z)]
    controls: Torque,
    #[output(norm(velocity))]
    airspeed: Scalar,
    #[output(attack)]
    angle_of_attack: Scalar,
    #[output(dot(velocity, airframe.y))]
    slip: Scalar,
    #[output(-dot(velocity, ground.z))]
    climb: Scalar,
    #[output(turning, resolved_in = ground)]
    turn: Vector,
    #[output(dot(airframe.y, ground.z))]
    bank: Scalar,
}

/// Checks straight climbing and level turning flight: forces along and perpendicular to the path, and
/// `tan φ = V Ω / g`.
#[test]
fn aircraft_climbs_and_turns() {
    let aircraft = TrimmedAircraft {};
    let (speed, mass, g) = (50.0, 1050.0, 9.81);
    for (climb, rate) in [(0.0, 0.0), (4.0, 0.0), (0.0, 0.15), (-2.0, 0.1)] {
        let problem = equilibrium(&aircraft)
            .coordinates(["flight.wx", "flight.wy"])
            .moving(vector![speed, 0.0, 0.0, 0.0, 0.0, 0.0])
            .speeds(TrimmedAircraft::VELOCITIES)
            .inputs(TrimmedAircraft::INPUTS)
            .output("airspeed", speed)
            .output("slip", 0.0)
            .output("climb", climb)
            .output("turn.x", 0.0)
            .output("turn.y", 0.0)
            .output("turn.z", rate);
        let found = problem.find().unwrap();
        assert!(found.acceleration.amax() < 1e-9 && found.iterations < 20, "{found:?}");
        let alpha: f64 = aircraft.angle_of_attack(&found.q, &found.v);
        let pressure = 1.225 / 2.0 * 16.2 * speed * speed;
        let cl = 0.3 + 4.6 * alpha;
        let drag = pressure * (0.03 + 0.05 * cl * cl);
        let thrust = found.u[TrimmedAircraft::INPUTS.iter().position(|n| *n == "thrust").unwrap()];
        let slope = (climb / speed).asin();
        assert_relatively_close(thrust * alpha.cos(), drag + mass * g * slope.sin(), 1e-9);
        // Perpendicular to the path: the weight and the centripetal force.
        let across = pressure * cl + thrust * alpha.sin();
        let turned = mass * speed * slope.cos() * rate;
        assert_relatively_close(across, (mass * g * slope.cos()).hypot(turned), 1e-9);
        if climb == 0.0 {
            assert_relatively_close(aircraft.bank(&found.q), (speed * rate / g).atan().sin(), 1e-9);
        }
        // Two unknowns too few.
        let short = problem.inputs([] as [&str; 0]).coordinates(["flight.wy"]);
        if rate > 0.0 {
            assert!(matches!(short.find(), Err(Error::NoSteadyState { .. })));
        }
    }
    let system = equilibrium(&aircraft);
    let system = system.output("climbs", 0.0).find().unwrap_err().to_string();
    assert!(system.starts_with("no output `climbs`, perhaps `climb`; there are airspeed"), "{system}");
}

/// Checks that a pendulum of a constrained particle and a pendulum on a pin have the same outputs under a
/// horizontal force.
#[test]
fn constrained_outputs_match_independent_ones() {
    #[mechanism(gravity = -9.81 * y, derivatives)]
    struct ConstrainedPendulum {
        px: Coordinate,
        py: Coordinate,
        #[particle(mass = 2, at = px * x + py * y)]
        bob: Particle,
        #[constraint(norm(r(bob / ground)) = 1.5)]
        rod: Holonomic,
        #[acts(on = bob, along = x)]
        push: Force,
        #[acts(on = bob, value = -0.7 * v(bob / ground / ground))]
        drag: Force,
        #[output(r(bob / ground))]
        place: Vector,
        #[output(v(bob / ground / ground))]
        velocity: Vector,
        #[output(a(bob / ground / ground))]
        acceleration: Vector,
        #[output(push + 3 * py)]
        mixed: Scalar,
    }
    #[mechanism(gravity = -9.81 * y, derivatives)]
    struct PinnedPendulum {
        #[body(mass = 0, inertia = 0)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[particle(mass = 2, at = arm.at(-1.5 * y))]
        bob: Particle,
        #[acts(on = bob, along = ground.x)]
        push: Force,
        #[acts(on = bob, value = -0.7 * v(bob / ground / ground))]
        drag: Force,
        #[output(r(bob / ground))]
        place: Vector,
        #[output(v(bob / ground / ground))]
        velocity: Vector,
        #[output(a(bob / ground / ground))]
        acceleration: Vector,
        #[output(push + 3 * dot(r(bob / ground), y))]
        mixed: Scalar,
    }
    let push = vector![12.0];
    let held = constrained_equilibrium(&ConstrainedPendulum {}).with_inputs(push).from(vector![0.8, -1.2]);
    let pinned = equilibrium(&PinnedPendulum {}).with_inputs(push).from(vector![0.5]);
    let held = held.measured_system(&held.find().unwrap()).unwrap();
    let pinned = pinned.measured_system(&pinned.find().unwrap()).unwrap();
    assert_eq!(held.outputs().len(), 10);
    assert_eq!((held.a().nrows(), held.outputs()), (2, pinned.outputs()));
    for w in [0.0, 1.0, 2.7, 40.0] {
        let s = nalgebra::Complex::new(0.3, w);
        let (a, b) = (held.at(s).unwrap(), pinned.at(s).unwrap());
        assert!((&a - &b).camax() < 1e-9 * (1.0 + b.camax()), "{a} {b}");
        assert!(b.camax() > 1e-3, "something is measured");
    }
}
