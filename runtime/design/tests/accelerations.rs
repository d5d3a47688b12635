//! Linear systems and steady motions under acceleration-dependent forces, compared with automatic
//! differentiation.

use linkwork::nalgebra::{DMatrix, SVector};
use linkwork::prelude::*;
use linkwork_design::Error;
use linkwork_design::mechanism::{linear_system, second_order_form};
use linkwork_design::steady::equilibrium;
use num_dual::Dual64;

/// Tolerance between generated and dual-number derivatives, relative to the largest entry.
const ROUNDING: f64 = 1e-10;

/// Returns the derivatives of a function at zero along `K` directions by dual numbers, which are exact up to
/// rounding.
fn dual_derivatives<const N: usize, const K: usize>(
    f: impl Fn(SVector<Dual64, K>) -> SVector<Dual64, N>,
) -> DMatrix<f64> {
    let column_of_derivatives = |k: usize| {
        f(SVector::from_fn(|i, _| Dual64::new(0.0, if i == k { 1.0 } else { 0.0 }))).map(|entry| entry.eps)
    };
    let columns: Vec<_> = (0..K).map(column_of_derivatives).collect();
    DMatrix::from_fn(N, K, |i, k| columns[k][i])
}

fn to_dual_numbers<const N: usize>(x: &SVector<f64, N>) -> SVector<Dual64, N> {
    x.map(Dual64::from)
}

#[track_caller]
fn assert_matrices_agree(what: &str, found: &DMatrix<f64>, expected: &DMatrix<f64>) {
    assert_eq!(found.shape(), expected.shape(), "{what}");
    let (error, size) = ((found - expected).amax(), expected.amax().max(1e-3));
    assert!(error <= ROUNDING * size, "{what} is {error:e} off: found {found}expected {expected}");
}

/// Aircraft with lift from a table, forces that depend on the rate of the angle of attack, and an engine lag.
#[mechanism(gravity = 9.81 * z, derivatives)]
struct UnsteadyAircraft<T: Real> {
    mass: T,
    area: T,
    chord: T,
    lag: T,
    lift: Table<1>,
    lift_rate: T,
    moment_rate: T,
    elevator: Input,
    throttle: Input,
    #[state(rate = (throttle - power) * (1 + speed / 300) / lag)]
    power: State,
    #[body(mass = mass, inertia = [[1000, 0, 120], [0, 2000, 0], [120, 0, 2500]])]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,
    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[define(norm(velocity))]
    speed: Scalar,
    #[define(angle_of_attack(airframe, velocity))]
    alpha: Scalar,
    #[define(rate(alpha) * chord / (2 * speed))]
    reduced: Scalar,
    #[define(density(-dot(r(airframe / ground), ground.z)) / 2 * speed * speed * area)]
    load: Scalar,
    #[acts(
        on = airframe, value = -load * (lift(alpha) + lift_rate * reduced) * airframe.z + power * airframe.x
    )]
    lifting: Force,
    #[acts(
        on = airframe, value = load * chord * (elevator + moment_rate * (1 + alpha) * reduced) * airframe.y
    )]
    pitching: Torque,
}

static ANGLES: [f64; 5] = [-1.6, -0.5, 0.1, 0.6, 1.7];
static LIFTS: [f64; 5] = [-0.3, -0.9, 0.6, 1.4, 0.2];

fn unsteady_aircraft<T: Real>(state: T) -> UnsteadyAircraft<T> {
    let scalar_from_f64 = |x: f64| nalgebra::convert(x);
    let lift = Table::new([&ANGLES], &LIFTS).unwrap().smooth();
    UnsteadyAircraft {
        mass: scalar_from_f64(900.0),
        area: scalar_from_f64(12.0),
        chord: scalar_from_f64(1.4),
        lag: scalar_from_f64(0.7),
        lift,
        lift_rate: scalar_from_f64(300.0),
        moment_rate: scalar_from_f64(-90.0),
        power: state,
    }
}

fn flight_state(k: usize) -> (SVector<f64, 7>, SVector<f64, 7>, SVector<f64, 2>) {
    let k = k as f64;
    let turn = SVector::<f64, 4>::from([0.3 + 0.1 * k, -0.2, 0.25 * k, 0.9]).normalize();
    let q = SVector::from([10.0, 20.0, -900.0 - 3000.0 * k, turn[0], turn[1], turn[2], turn[3]]);
    let v = SVector::from([60.0 + 9.0 * k, 2.0 - k, 3.0 * k, 0.3, 0.2 * k - 0.1, -0.4, 3000.0 + 70.0 * k]);
    (q, v, [0.02 * k, 3100.0].into())
}

#[test]
fn linear_systems_match_automatic_differentiation() {
    for k in 0..4 {
        let (q, v, u) = flight_state(k);
        let craft = unsteady_aircraft(v[6]);
        let system = linear_system(&at(&craft.extended(), 0.0), &q, &v, &u).unwrap();
        let dual = unsteady_aircraft(Dual64::from(0.0));
        let whole = dual.extended();
        let zero = Dual64::from(0.0);
        let acceleration_of_whole =
            |q: &SVector<Dual64, 7>, v: &SVector<Dual64, 7>, u: &SVector<Dual64, 2>| {
                let tau = whole.generalized_forces(zero, q, v, u);
                whole.forward_dynamics(zero, q, v, &tau)
            };
        let (q, v, u) = (to_dual_numbers(&q), to_dual_numbers(&v), to_dual_numbers(&u));
        let rows = system.a().rows(6, 7);
        let displaced_motion =
            |by: SVector<Dual64, 7>| acceleration_of_whole(&whole.integrate(&q, &by), &v, &u);
        assert_matrices_agree(
            "∂v̇/∂q",
            &rows.columns(0, 6).clone_owned(),
            &dual_derivatives(displaced_motion).columns(0, 6).clone_owned(),
        );
        assert_matrices_agree(
            "∂v̇/∂v",
            &rows.columns(6, 7).clone_owned(),
            &dual_derivatives(|by| acceleration_of_whole(&q, &(v + by), &u)),
        );
        assert_matrices_agree(
            "B",
            &system.b().rows(6, 7).clone_owned(),
            &dual_derivatives(|by| acceleration_of_whole(&q, &v, &(u + by))),
        );
    }
}

/// Pendulum on a cart. The force on each of the two depends on the acceleration of the other, with factors of
/// angle and rate.
#[mechanism(gravity = -9.81 * y, derivatives)]
#[derive(Clone, Copy)]
struct CoupledPendulum<T: Real> {
    gain: T,
    share: T,
    added: T,
    push: Input,
    #[body(mass = 2)]
    cart: Body,
    #[body(mass = 1, com = -0.4 * y, inertia = rod(1, 0.8, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,
    #[acts(on = rail, stiffness = 30)]
    spring: Spring,
    #[acts(on = hinge, value = gain * cos(hinge) * rate(rate(rail)) + push - 0.1 * rate(hinge))]
    felt: Torque,
    #[acts(on = rail, value = share * sin(hinge + 1) * rate(rate(hinge)) / (1 + pow(rate(rail), 2)) - added * rate(rate(rail)))]
    pushed: Force,
}

fn sample_coupled_pendulum<T: Real>() -> CoupledPendulum<T> {
    CoupledPendulum {
        gain: nalgebra::convert(0.2),
        share: nalgebra::convert(0.5),
        added: nalgebra::convert(0.7),
    }
}

#[test]
fn second_order_forms_match_inverse_dynamics() {
    for (q, v, u) in [([0.0, 0.0], [0.0, 0.0], [0.0]), ([0.3, -0.7], [0.5, 1.2], [2.0])] {
        let (q, v, u) = (q.into(), v.into(), u.into());
        let form = second_order_form(&sample_coupled_pendulum::<f64>(), &q, &v, &u).unwrap();
        let dual = sample_coupled_pendulum::<Dual64>();
        let motion = linear_system(&sample_coupled_pendulum::<f64>(), &q, &v, &u).unwrap();
        let forces = sample_coupled_pendulum::<f64>().generalized_forces(&q, &v, &u);
        let a = to_dual_numbers(&sample_coupled_pendulum::<f64>().forward_dynamics(&q, &v, &forces));
        let (q, v, u) = (to_dual_numbers(&q), to_dual_numbers(&v), to_dual_numbers(&u));
        // Residual of the equations of motion: τ(q, v, a) − f(q, u).
        let missing =
            |q: &_, v: &_, a: &_, u: &_| dual.inverse_dynamics(q, v, a) - dual.generalized_forces(q, v, u);
        assert_matrices_agree("M", &form.mass, &dual_derivatives(|by| missing(&q, &v, &(a + by), &u)));
        let velocity = &form.damping + &form.gyroscopic;
        assert_matrices_agree("D + G", &velocity, &dual_derivatives(|by| missing(&q, &(v + by), &a, &u)));
        let position = &form.stiffness + &form.circulatory;
        assert_matrices_agree("K + N", &position, &dual_derivatives(|by| missing(&(q + by), &v, &a, &u)));
        assert_matrices_agree("B", &form.input, &-dual_derivatives(|by| missing(&q, &v, &a, &(u + by))));
        assert!((form.mass[(0, 1)] - form.mass[(1, 0)]).abs() > 0.01, "not symmetric");
        let again = form.state_space().unwrap();
        assert_matrices_agree("A", again.a(), motion.a());
        assert_matrices_agree("B", again.b(), motion.b());
    }
}

/// Two carts. The force on each is proportional to the acceleration of the other.
#[mechanism(derivatives)]
struct CoupledCarts {
    forth: f64,
    back: f64,
    push: Input,
    #[body(mass = 2)]
    first: Body,
    #[body(mass = 3)]
    second: Body,
    #[joint(ground -> first, along = x)]
    left: Sleeve,
    #[joint(ground -> second, along = x)]
    right: Sleeve,
    #[acts(on = left, stiffness = 50)]
    left_spring: Spring,
    #[acts(on = right, stiffness = 80)]
    right_spring: Spring,
    #[acts(on = left, value = -forth * rate(rate(right)) - 0.5 * rate(rate(left)) + push)]
    on_left: Force,
    #[acts(on = right, value = -back * rate(rate(left)))]
    on_right: Force,
}

#[test]
fn modes_and_equilibria_use_effective_mass() {
    let carts = CoupledCarts { forth: 0.8, back: -0.1 };
    // The second cart is locked: the first one oscillates with its own effective mass, 2 + 0.5 kg.
    let held = equilibrium(&carts).hold(["right"]);
    let found = held.find().unwrap();
    let modes = held.linear_system(&found).unwrap().modes().unwrap();
    assert!((modes[0].frequency() - (50.0_f64 / 2.5).sqrt()).abs() < 1e-12, "{}", modes[0]);
    // Both carts move: det(K − ω² M) = 0 with the unsymmetric effective mass matrix.
    let free = equilibrium(&carts);
    let found = free.find().unwrap();
    let modes = free.linear_system(&found).unwrap().modes().unwrap();
    let (a, b, c): (f64, f64, f64) = (2.5 * 3.0 + 0.8 * 0.1, -(2.5 * 80.0 + 3.0 * 50.0), 50.0 * 80.0);
    for (mode, sign) in modes.iter().zip([-1.0, 1.0]) {
        let squared: f64 = (-b + sign * (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
        assert!((mode.frequency() - squared.sqrt()).abs() < 1e-12, "{mode}");
    }
    // Required: the first cart accelerates by 2 m/s² from rest, the second one does not.
    let found = equilibrium(&carts)
        .from([0.0, 0.0025].into())
        .fix(["left", "right"])
        .acceleration("left", 2.0)
        .inputs(["push"])
        .find();
    // The second spring balances the force from the first cart's acceleration: 80 · 0.0025 = 0.1 · 2.
    let found = found.unwrap();
    assert!((found.u[0] - 5.0).abs() < 1e-12, "{found:?}");
    assert!(found.acceleration[1].abs() < 1e-12);
}

/// Checks that positive stiffness is no proof of stability with an unsymmetric effective mass matrix:
/// `M = [[m, s], [−s, m]]`, `K = 1` has the roots `s² = −1 / (m ± i s)`.
#[test]
fn energy_criterion_needs_symmetric_inertia() {
    let carts = CoupledCarts { forth: 0.8, back: -0.8 };
    let rest = equilibrium(&carts);
    let found = rest.find().unwrap();
    assert!(matches!(rest.stiffness(&found), Err(Error::NoPotential { .. })));
    let even = CoupledCarts { forth: 0.8, back: 0.8 };
    let rest = equilibrium(&even);
    let found = rest.find().unwrap();
    let curvatures = rest.stiffness(&found).unwrap().curvatures;
    let modes = rest.linear_system(&found).unwrap().modes().unwrap();
    for (curvature, mode) in curvatures.iter().zip(&modes) {
        assert!((curvature.sqrt() - mode.frequency()).abs() < 1e-12);
    }
}

#[test]
fn first_order_states_have_no_second_order_form() {
    let (q, v, u) = flight_state(0);
    let craft = unsteady_aircraft(v[6]);
    let error = second_order_form(&at(&craft.extended(), 0.0), &q, &v, &u).unwrap_err();
    assert!(matches!(error, Error::Count { what: "states of first order", expected: 0, found: 1 }));
}
