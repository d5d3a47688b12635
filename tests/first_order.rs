//! First-order states: every integrator integrates them, and every derivative includes them.

use linkwork::integrate::Method;
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork::{Derivatives, Mechanism, OutputDerivatives, Outputs, mechanism};
use support::compare::assert_close_relative_to_largest;
use support::differences::derivative_columns;
use support::random::Random;
use support::slider_crank;

/// Tolerance between derivatives and central differences of eighth order.
const DIFFERENCE: f64 = 1e-10;

/// Aircraft with first-order states: its thrust follows the throttle with a lag, and a filtered angle of
/// attack moves its elevator. The force of the deflected jet is proportional to the current thrust; the
/// deflection is an input.
#[mechanism(gravity = 9.81 * z, derivatives)]
#[derive(Debug)]
struct Fighter<T: Real> {
    mass: T,
    area: T,
    arm: T,
    lag: T,
    lift: Table<2>,
    throttle: Input,
    deflection: Input,
    #[state(rate = (1e4 * throttle - power) * (1 + speed / 400) / lag)]
    power: State,
    #[state(rate = (alpha - sensed * sensed * sensed) / lag + wind * throttle)]
    sensed: State,
    #[define(sin(t) / (5 * lag))]
    wind: Scalar,
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
    #[define(density(-dot(r(airframe / ground), ground.z)) / 2 * dot(velocity, velocity) * area)]
    load: Scalar,
    #[acts(on = airframe, value = -load * lift(alpha, sensed) * airframe.z)]
    lifting: Force,
    #[acts(on = airframe, value = power * airframe.x)]
    pushing: Force,
    #[acts(on = airframe, value = power * arm * (2 + sensed) * sin(deflection) * airframe.y)]
    turning: Torque,
    #[output(load * lift(alpha, sensed) / mass + sensed * dot(a(airframe / ground / ground), airframe.x))]
    felt: Scalar,
    #[output(sin(deflection) * power * power / mass * velocity)]
    jet: Vector,
}

static ANGLES: [f64; 4] = [-1.6, -0.1, 0.4, 1.7];
static ELEVATOR: [f64; 3] = [-1.5, 0.2, 1.5];

fn tabulated_fighter() -> Fighter<f64> {
    let lift_coefficient = |a: f64, d: f64| (0.2 + 5.0 * a - 3.0 * a * a) * (1.0 + 0.3 * d);
    let values: Vec<f64> = ANGLES.iter().flat_map(|a| ELEVATOR.map(|d| lift_coefficient(*a, d))).collect();
    let lift = Table::new([&ANGLES, &ELEVATOR], values.leak()).unwrap().smooth();
    Fighter { mass: 900.0, area: 12.0, arm: 0.8, lag: 0.7, lift, power: 3e3, sensed: 0.1 }
}

struct FighterCase {
    t: f64,
    q: SVector<f64, 7>,
    v: SVector<f64, 8>,
    a: SVector<f64, 8>,
    u: SVector<f64, 2>,
}

fn random_fighter_cases() -> Vec<FighterCase> {
    let mut random = Random::new(11);
    let random_case = |k: usize| {
        let turn: SVector<f64, 4> = random.random_vector::<4>(1.0).normalize();
        let q = SVector::from_column_slice(&[10.0, 20.0, -900.0, turn[0], turn[1], turn[2], turn[3]]);
        let mut v: SVector<f64, 8> = random.random_vector(0.7);
        v[0] += 60.0;
        v[2] += 3.0 * k as f64;
        v[6] = 4000.0 + 100.0 * v[6];
        FighterCase {
            t: random.uniform_number(2.0),
            q,
            v,
            a: random.random_vector(2.0),
            u: random.random_vector(1.0),
        }
    };
    (0..6).map(random_case).collect()
}

const STEP: [f64; 8] = [1e-2, 1e-2, 1e-2, 1e-2, 1e-2, 1e-2, 10.0, 1e-2];

#[test]
fn first_order_states_are_named_after_the_velocities() {
    fn velocity_names<M: Mechanism<NQ, NV, NU>, const NQ: usize, const NV: usize, const NU: usize>(
        _: &M,
    ) -> [&'static str; NV] {
        assert_eq!(M::FIRST_ORDER, 2);
        M::VELOCITIES
    }
    let fighter = tabulated_fighter();
    assert_eq!(velocity_names(&fighter.extended())[5..], ["flight.wz", "power", "sensed"]);
    assert_eq!(fighter.states().as_slice(), [3e3, 0.1]);
    let other = fighter.with_states(&[1.0, 2.0].into());
    assert_eq!((other.power, other.sensed, other.mass), (1.0, 2.0, 900.0));
}

#[test]
fn forward_dynamics_inverts_inverse_dynamics() {
    let fighter = tabulated_fighter();
    let whole = fighter.extended();
    for FighterCase { t, q, v, a, .. } in random_fighter_cases() {
        let tau = whole.inverse_dynamics(t, &q, &v, &a);
        let back = whole.forward_dynamics(t, &q, &v, &tau);
        assert_close_relative_to_largest("accelerations and rates", back.as_slice(), a.as_slice(), 1e-12);
        let sum = whole.mass_matrix(t, &q) * a + whole.bias_forces(t, &q, &v);
        assert_close_relative_to_largest("M v̇ + h", sum.as_slice(), tau.as_slice(), 1e-12);
    }
}

#[test]
fn first_order_rates_equal_their_declared_expressions() {
    let fighter = tabulated_fighter();
    for FighterCase { t, q, v, u, .. } in random_fighter_cases() {
        let now = fighter.with_states(&[v[6], v[7]].into());
        let own = v.fixed_rows::<6>(0).into_owned();
        let whole = fighter.extended();
        let found = whole.forward_dynamics(t, &q, &v, &whole.generalized_forces(t, &q, &v, &u));
        let tau = Mechanism::generalized_forces(&now, t, &q, &own, &u);
        let accelerations = Mechanism::forward_dynamics(&now, t, &q, &own, &tau);
        assert_close_relative_to_largest(
            "v̇",
            found.fixed_rows::<6>(0).as_slice(),
            accelerations.as_slice(),
            1e-14,
        );
        // Velocities are expressed in body axes.
        let speed = own.fixed_rows::<3>(0).norm();
        let alpha = own[2].atan2(own[0]);
        let power = (1e4 * u[0] - v[6]) * (1.0 + speed / 400.0) / 0.7;
        let sensed = (alpha - v[7].powi(3)) / 0.7 + t.sin() / 3.5 * u[0];
        assert_close_relative_to_largest("ẋ", &[found[6], found[7]], &[power, sensed], 1e-12);
    }
}

#[test]
fn first_order_derivatives_agree_with_differences() {
    let fighter = tabulated_fighter();
    let whole = fighter.extended();
    for FighterCase { t, q, v, a, u } in random_fighter_cases() {
        let tau = whole.inverse_dynamics(t, &q, &v, &a);
        let displaced_configuration = |by| whole.integrate(&q, &by);
        let mut still = STEP;
        still[6..].fill(1.0);

        let (by_q, by_v, by_force) = whole.forward_dynamics_derivatives(t, &q, &v, &tau);
        let extended_forward_dynamics = |q: &_, v: &_, tau: &_| whole.forward_dynamics(t, q, v, tau);
        assert_close_relative_to_largest(
            "∂v̇/∂q",
            by_q.as_slice(),
            derivative_columns(still, |by| extended_forward_dynamics(&displaced_configuration(by), &v, &tau))
                .as_slice(),
            DIFFERENCE,
        );
        assert_close_relative_to_largest(
            "∂v̇/∂v",
            by_v.as_slice(),
            derivative_columns(STEP, |by| extended_forward_dynamics(&q, &(v + by), &tau)).as_slice(),
            DIFFERENCE,
        );
        let by_tau = derivative_columns([1.0; 8], |by| extended_forward_dynamics(&q, &v, &(tau + by)));
        assert_close_relative_to_largest("∂v̇/∂τ", by_force.as_slice(), by_tau.as_slice(), 1e-9);

        let (by_q, by_v) = whole.inverse_dynamics_derivatives(t, &q, &v, &a);
        let inverse_dynamics_of_extended_mechanism = |q: &_, v: &_| whole.inverse_dynamics(t, q, v, &a);
        assert_close_relative_to_largest(
            "∂τ/∂q",
            by_q.as_slice(),
            derivative_columns(still, |by| {
                inverse_dynamics_of_extended_mechanism(&displaced_configuration(by), &v)
            })
            .as_slice(),
            DIFFERENCE,
        );
        assert_close_relative_to_largest(
            "∂τ/∂v",
            by_v.as_slice(),
            derivative_columns(STEP, |by| inverse_dynamics_of_extended_mechanism(&q, &(v + by))).as_slice(),
            DIFFERENCE,
        );

        let (by_q, by_v, by_u) = whole.generalized_forces_derivatives(t, &q, &v, &u);
        let forces_of_extended_system = |q: &_, v: &_, u: &_| whole.generalized_forces(t, q, v, u);
        let found =
            derivative_columns(still, |by| forces_of_extended_system(&displaced_configuration(by), &v, &u));
        assert_close_relative_to_largest("inputs, ∂τ/∂q", by_q.as_slice(), found.as_slice(), DIFFERENCE);
        let found = derivative_columns(STEP, |by| forces_of_extended_system(&q, &(v + by), &u));
        assert_close_relative_to_largest("inputs, ∂τ/∂v", by_v.as_slice(), found.as_slice(), DIFFERENCE);
        let found =
            derivative_columns([1e-2; 2], |by: SVector<f64, 2>| forces_of_extended_system(&q, &v, &(u + by)));
        assert_close_relative_to_largest("inputs, ∂τ/∂u", by_u.as_slice(), found.as_slice(), DIFFERENCE);
    }
}

#[test]
fn output_derivatives_include_first_order_states() {
    let fighter = tabulated_fighter();
    let whole = fighter.extended();
    for FighterCase { t, q, v, a, u } in random_fighter_cases() {
        let outputs_of_extended_mechanism = |v: &_, a: &_, u: &_| whole.outputs(t, &q, v, a, u);
        let found = whole.output_derivatives(t, &q, &v, &a, &u);
        let by_v = derivative_columns(STEP, |by| outputs_of_extended_mechanism(&(v + by), &a, &u));
        assert_close_relative_to_largest("∂y/∂v", found.by_v.as_slice(), by_v.as_slice(), DIFFERENCE);
        let by_a = derivative_columns([1.0; 8], |by| outputs_of_extended_mechanism(&v, &(a + by), &u));
        assert_close_relative_to_largest("∂y/∂v̇", found.by_a.as_slice(), by_a.as_slice(), DIFFERENCE);
        let by_u = derivative_columns([1e-2; 2], |by| outputs_of_extended_mechanism(&v, &a, &(u + by)));
        assert_close_relative_to_largest("∂y/∂u", found.by_u.as_slice(), by_u.as_slice(), DIFFERENCE);
        let displaced_configuration = |by: SVector<f64, 8>| whole.integrate(&q, &by);
        let by_q =
            derivative_columns([1e-2; 8], |by| whole.outputs(t, &displaced_configuration(by), &v, &a, &u));
        assert_close_relative_to_largest("∂y/∂q", found.by_q.as_slice(), by_q.as_slice(), DIFFERENCE);
    }
}

/// Sled whose engine has a lag: `F = F₀ (1 − e^{−t/τ})`.
#[mechanism]
#[derive(Clone, Copy)]
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
}

#[track_caller]
fn check_sled_motion(method: impl Method<f64>, lag: f64, tolerance: f64) {
    let sled = Sled { mass: 2.0, lag, thrust: 0.0 };
    let whole = sled.extended();
    let run = simulate(&whole).from([0.0], [0.0, 0.0]).inputs(|_, _, _| [6.0].into());
    let end = run.method(method).duration(1.5).finish().unwrap();
    let late = 1.0 - (-1.5 / lag).exp();
    let (force, speed) = (6.0 * late, 3.0 * (1.5 - lag * late));
    let place = 3.0 * (1.5 * 1.5 / 2.0 - lag * (1.5 - lag * late));
    assert_close_relative_to_largest(
        "place, speed, thrust",
        &[end.q[0], end.v[0], end.v[1]],
        &[place, speed, force],
        tolerance,
    );
}

#[test]
fn every_integrator_integrates_first_order_states() {
    check_sled_motion(Rk4::step(1e-3), 0.4, 1e-11);
    check_sled_motion(DormandPrince::new().tolerance(1e-11, 1e-12), 0.4, 1e-9);
    check_sled_motion(DormandPrince8::new().tolerance(1e-12, 1e-13), 0.4, 1e-10);
    check_sled_motion(Rodas::new().tolerance(1e-8, 1e-9), 0.4, 1e-6);
    check_sled_motion(Rosenbrock::step(1e-3), 0.4, 1e-5);
    check_sled_motion(ImplicitMidpoint::step(1e-3), 0.4, 1e-5);
    check_sled_motion(SemiImplicitEuler::step(1e-4), 0.4, 1e-3);
    // The lag is a thousand times shorter than a step.
    check_sled_motion(Rodas::new().tolerance(1e-6, 1e-8), 1e-5, 1e-5);
    check_sled_motion(Rosenbrock::step(1e-2), 1e-5, 1e-4);
}

slider_crank! {
    /// Slider-crank that is driven by a torque with a lag.
    #[mechanism(gravity = -9.81 * y)]
    struct SliderCrankWithMotorLag {
        lag: f64,
        command: Input,
        #[state(rate = (command - torque) / lag)]
        torque: State,
        #[acts(on = main, value = torque)]
        motor: Torque,
    }
}

slider_crank! {
    /// Slider-crank that is driven by a torque that is an input.
    #[mechanism(gravity = -9.81 * y)]
    struct SliderCrankWithDirectTorque {
        #[acts(on = main)]
        motor: Torque,
    }
}

#[test]
fn constrained_mechanisms_may_have_first_order_states() {
    let (lag, q) = (0.3, [0.0, 0.0, 0.8]);
    let late = SliderCrankWithMotorLag { lag, torque: 0.0 };
    let constant_command = |_, _: &_, _: &_| [12.0].into();
    let run =
        simulate(&late.extended()).from(q, [0.0; 4]).inputs(constant_command).duration(1.0).finish().unwrap();
    let lagged_command =
        |t: f64, _: &SVector<f64, 3>, _: &SVector<f64, 3>| [12.0 * (1.0 - (-t / lag).exp())].into();
    let other = simulate(&SliderCrankWithDirectTorque {})
        .from(q, [0.0; 3])
        .inputs(lagged_command)
        .duration(1.0)
        .finish()
        .unwrap();
    assert_close_relative_to_largest("q", run.q.as_slice(), other.q.as_slice(), 1e-5);
    assert_close_relative_to_largest("v", run.v.fixed_rows::<3>(0).as_slice(), other.v.as_slice(), 1e-5);
    assert!(other.v[0].abs() > 1.0, "it moves");
}
