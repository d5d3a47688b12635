//! Forces that are linear in the accelerations: aerodynamic forces that depend on the rate of the angle of
//! attack, and the inertia of fluid that moves with a body (added mass).

use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::prelude::*;
use linkwork::{Derivatives, Lanes, mechanism};
use support::compare::assert_close_relative_to_largest;
use support::differences::derivative_columns;
use support::random::Random;

/// Tolerance between derivatives and central differences of eighth order.
const DIFFERENCE: f64 = 1e-10;

/// Aircraft with the state of its engine, whose lift and pitching moment depend on the rate of the angle of
/// attack. A table gives the lift coefficient.
#[mechanism(gravity = 9.81 * z, derivatives)]
#[derive(Debug)]
struct AircraftWithUnsteadyLift<T: Real> {
    mass: T,
    area: T,
    chord: T,
    lag: T,
    lift: Table<1>,
    lift_rate: T,
    moment_rate: T,
    elevator: Input,
    throttle: Input,
    #[state(rate = (throttle - power) / lag)]
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
    #[output(dot(a(airframe / ground / ground), airframe.z))]
    felt: Scalar,
}

static ANGLES: [f64; 5] = [-1.6, -0.5, 0.1, 0.6, 1.7];
static LIFTS: [f64; 5] = [-0.3, -0.9, 0.6, 1.4, 0.2];

fn unsteady_aircraft() -> AircraftWithUnsteadyLift<f64> {
    let lift = Table::new([&ANGLES], &LIFTS).unwrap().smooth();
    AircraftWithUnsteadyLift {
        mass: 900.0,
        area: 12.0,
        chord: 1.4,
        lag: 0.7,
        lift,
        lift_rate: 300.0,
        moment_rate: -90.0,
        power: 2e3,
    }
}

/// Two links and a slider. The matrix that maps accelerations to these forces is not symmetric and depends on
/// position, velocity and time.
#[mechanism(gravity = -9.81 * y, derivatives, batch, prepare, sensitivities)]
#[derive(Clone, Copy, Debug)]
struct CoupledArmAndSlider {
    gain: f64,
    share: f64,
    reach: f64,
    added: f64,
    push: Input,
    #[body(mass = 2, com = -0.5 * y, inertia = rod(2, 1, y))]
    upper: Body,
    #[body(mass = 1, com = -0.4 * y, inertia = rod(1, 0.8, y))]
    lower: Body,
    #[body(mass = 3)]
    slider: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(-y) -> lower, about = z)]
    elbow: Pin,
    #[joint(ground -> slider, along = x)]
    rail: Sleeve,
    #[define(reach * sin(shoulder) * rate(elbow) + rate(rail) * cos(t))]
    mixed: Scalar,
    #[acts(on = elbow, value = gain * cos(elbow) * rate(rate(shoulder)) + push)]
    felt: Torque,
    #[acts(on = rail, value = share * rate(mixed) / (1 + pow(rate(elbow), 2)) - added * rate(rate(rail)))]
    pushed: Force,
    #[acts(on = lower.at(-0.8 * y), value = -added * a(lower.at(-0.8 * y) / ground / ground))]
    carried: Force,
}

const COUPLED: CoupledArmAndSlider = CoupledArmAndSlider { gain: 0.2, share: 0.5, reach: 1.3, added: 0.7 };

struct Case<const NQ: usize, const NV: usize, const NU: usize> {
    t: f64,
    q: SVector<f64, NQ>,
    v: SVector<f64, NV>,
    a: SVector<f64, NV>,
    u: SVector<f64, NU>,
}

fn flight_cases() -> Vec<Case<7, 7, 2>> {
    let mut random = Random::new(3);
    let random_case = |k: usize| {
        let turn: SVector<f64, 4> = random.random_vector::<4>(1.0).normalize();
        let q = SVector::from_column_slice(&[10.0, 20.0, -900.0, turn[0], turn[1], turn[2], turn[3]]);
        let mut v: SVector<f64, 7> = random.random_vector(0.7);
        v[0] += 60.0;
        v[2] += 3.0 * k as f64;
        v[6] = 3000.0 + 100.0 * v[6];
        Case { t: 0.0, q, v, a: random.random_vector(2.0), u: random.random_vector(1.0) }
    };
    (0..6).map(random_case).collect()
}

fn random_cases_of_coupled_arm() -> Vec<Case<3, 3, 1>> {
    let mut random = Random::new(8);
    let random_case = |_| Case {
        t: random.uniform_number(2.0),
        q: random.random_vector(1.5),
        v: random.random_vector(1.5),
        a: random.random_vector(3.0),
        u: random.random_vector(2.0),
    };
    (0..8).map(random_case).collect()
}

#[test]
fn forward_dynamics_inverts_inverse_dynamics() {
    let craft = unsteady_aircraft();
    let whole = craft.extended();
    for Case { t, q, v, a, .. } in flight_cases() {
        let tau = whole.inverse_dynamics(t, &q, &v, &a);
        assert_close_relative_to_largest(
            "v̇",
            whole.forward_dynamics(t, &q, &v, &tau).as_slice(),
            a.as_slice(),
            1e-11,
        );
    }
    for Case { t, q, v, a, .. } in random_cases_of_coupled_arm() {
        let tau = COUPLED.inverse_dynamics(t, &q, &v, &a);
        assert_close_relative_to_largest(
            "v̇",
            COUPLED.forward_dynamics(t, &q, &v, &tau).as_slice(),
            a.as_slice(),
            1e-11,
        );
    }
}

#[test]
fn effective_mass_matrix_is_not_symmetric() {
    for Case { t, q, v, .. } in random_cases_of_coupled_arm() {
        let at_rest = COUPLED.inverse_dynamics(t, &q, &v, &SVector::zeros());
        assert_close_relative_to_largest(
            "h",
            at_rest.as_slice(),
            COUPLED.bias_forces(t, &q, &v).as_slice(),
            1e-14,
        );
        let mass_matrix_column = |k: usize| {
            let mut a = SVector::zeros();
            a[k] = 1.0;
            COUPLED.inverse_dynamics(t, &q, &v, &a) - at_rest
        };
        let matrix = SMatrix::<f64, 3, 3>::from_columns(&[
            mass_matrix_column(0),
            mass_matrix_column(1),
            mass_matrix_column(2),
        ]);
        // The expected matrix is derived by hand from the definition: the water at the tip is a particle
        // there.
        let CoupledArmAndSlider { gain, share, reach, added } = COUPLED;
        let c = q[1].cos();
        let mut expected = COUPLED.mass_matrix(t, &q);
        expected[(0, 0)] += added * (1.0 + 0.64 + 1.6 * c);
        expected[(0, 1)] += added * (0.64 + 0.8 * c);
        expected[(1, 0)] += added * (0.64 + 0.8 * c);
        expected[(1, 1)] += added * 0.64;
        expected[(1, 0)] -= gain * c;
        let share = share / (1.0 + v[1] * v[1]);
        expected[(2, 1)] -= share * reach * q[0].sin();
        expected[(2, 2)] += added - share * t.cos();
        assert_close_relative_to_largest("M − C", matrix.as_slice(), expected.as_slice(), 1e-13);
        assert!((matrix[(2, 1)] - matrix[(1, 2)]).abs() > 1e-3);
    }
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let craft = unsteady_aircraft();
    let whole = craft.extended();
    let (mut still, step) = ([1e-2; 7], [1e-2, 1e-2, 1e-2, 1e-2, 1e-2, 1e-2, 10.0]);
    still[6] = 1.0;
    for Case { t, q, v, a, u } in flight_cases() {
        let tau = whole.generalized_forces(t, &q, &v, &u);
        let (by_q, by_v, by_force) = whole.forward_dynamics_derivatives(t, &q, &v, &tau);
        let accelerations_of_extended_mechanism =
            |q: &_, v: &_, tau: &_| whole.forward_dynamics(t, q, v, tau);
        let displaced_configuration = |by| whole.integrate(&q, &by);
        let found = derivative_columns(still, |by| {
            accelerations_of_extended_mechanism(&displaced_configuration(by), &v, &tau)
        });
        assert_close_relative_to_largest("∂v̇/∂q", by_q.as_slice(), found.as_slice(), DIFFERENCE);
        let found = derivative_columns(step, |by| accelerations_of_extended_mechanism(&q, &(v + by), &tau));
        assert_close_relative_to_largest("∂v̇/∂v", by_v.as_slice(), found.as_slice(), DIFFERENCE);
        let found =
            derivative_columns([1e2; 7], |by| accelerations_of_extended_mechanism(&q, &v, &(tau + by)));
        assert_close_relative_to_largest("∂v̇/∂τ", by_force.as_slice(), found.as_slice(), 1e-9);
        let (by_q, by_v) = whole.inverse_dynamics_derivatives(t, &q, &v, &a);
        let found =
            derivative_columns(still, |by| whole.inverse_dynamics(t, &displaced_configuration(by), &v, &a));
        assert_close_relative_to_largest("∂τ/∂q", by_q.as_slice(), found.as_slice(), DIFFERENCE);
        let found = derivative_columns(step, |by| whole.inverse_dynamics(t, &q, &(v + by), &a));
        assert_close_relative_to_largest("∂τ/∂v", by_v.as_slice(), found.as_slice(), DIFFERENCE);
    }
}

#[test]
fn linearisation_agrees_with_finite_differences() {
    for Case { t, q, v, u, .. } in random_cases_of_coupled_arm() {
        let now = at(&COUPLED, t);
        let motion = Derivatives::linear_motion(&now, &q, &v, &u);
        let coupled_accelerations = |q: &SVector<f64, 3>, v: &SVector<f64, 3>, u: &SVector<f64, 1>| {
            COUPLED.forward_dynamics(t, q, v, &COUPLED.generalized_forces(t, q, u))
        };
        assert_close_relative_to_largest(
            "v̇",
            motion.acceleration.as_slice(),
            coupled_accelerations(&q, &v, &u).as_slice(),
            1e-13,
        );
        let found = derivative_columns([1e-2; 3], |by| coupled_accelerations(&(q + by), &v, &u));
        assert_close_relative_to_largest("∂v̇/∂q", motion.by_q.as_slice(), found.as_slice(), DIFFERENCE);
        let found = derivative_columns([1e-2; 3], |by| coupled_accelerations(&q, &(v + by), &u));
        assert_close_relative_to_largest("∂v̇/∂v", motion.by_v.as_slice(), found.as_slice(), DIFFERENCE);
        let found = derivative_columns([1e-2; 1], |by| coupled_accelerations(&q, &v, &(u + by)));
        assert_close_relative_to_largest("∂v̇/∂u", motion.by_u.as_slice(), found.as_slice(), DIFFERENCE);
    }
}

#[test]
fn parameter_derivatives_agree_with_finite_differences() {
    for Case { t, q, v, a, .. } in random_cases_of_coupled_arm() {
        let perturbed_mechanism = |by: SVector<f64, 4>| {
            let CoupledArmAndSlider { gain, share, reach, added } = COUPLED;
            CoupledArmAndSlider {
                gain: gain + by[0],
                share: share + by[1],
                reach: reach + by[2],
                added: added + by[3],
            }
        };
        let by = COUPLED.inverse_dynamics_by_parameters(t, &q, &v, &a);
        let found = derivative_columns([1e-2; 4], |s| perturbed_mechanism(s).inverse_dynamics(t, &q, &v, &a));
        assert_close_relative_to_largest("∂τ/∂p", by.as_slice(), found.as_slice(), DIFFERENCE);
        let tau = a;
        let by = COUPLED.forward_dynamics_by_parameters(t, &q, &v, &tau);
        let found =
            derivative_columns([1e-2; 4], |s| perturbed_mechanism(s).forward_dynamics(t, &q, &v, &tau));
        assert_close_relative_to_largest("∂v̇/∂p", by.as_slice(), found.as_slice(), DIFFERENCE);
    }
}

#[test]
fn prepared_and_batched_functions_have_acceleration_forces() {
    let prepared = COUPLED.prepare();
    for Case { t, q, v, a, .. } in random_cases_of_coupled_arm() {
        let tau = COUPLED.inverse_dynamics(t, &q, &v, &a);
        let again = prepared.inverse_dynamics(t, &q, &v, &a);
        assert_close_relative_to_largest("τ", again.as_slice(), tau.as_slice(), 1e-13);
        let back = prepared.forward_dynamics(t, &q, &v, &tau);
        assert_close_relative_to_largest("v̇", back.as_slice(), a.as_slice(), 1e-11);
    }
    let all = random_cases_of_coupled_arm();
    let lanes_of_cases = |f: fn(&Case<3, 3, 1>) -> SVector<f64, 3>| {
        SVector::<Lanes<f64, 4>, 3>::from_fn(|i, _| Lanes::from_fn(|k| f(&all[k])[i]))
    };
    let t = Lanes::from_fn(|k| all[k].t);
    let found = COUPLED.forward_dynamics_lanes(
        t,
        &lanes_of_cases(|c| c.q),
        &lanes_of_cases(|c| c.v),
        &lanes_of_cases(|c| c.a),
    );
    for (k, Case { t, q, v, a, .. }) in all.iter().take(4).enumerate() {
        let one = COUPLED.forward_dynamics(*t, q, v, a);
        let lane: Vec<f64> = found.iter().map(|entry| entry[k]).collect();
        assert_close_relative_to_largest("v̇ in lanes", &lane, one.as_slice(), 1e-12);
    }
}

/// Hull with the added mass of Kirchhoff's equations, in body axes.
#[mechanism(derivatives)]
struct Hull {
    mass: f64,
    along: f64,
    across: f64,
    turning: f64,
    #[body(mass = mass, inertia = diagonal(2, 5, 6))]
    hull: Body,
    #[joint(ground -> hull)]
    way: Free,
    #[define(v(hull / ground / ground))]
    velocity: Vector,
    #[define(dot(velocity, hull.x))]
    surge: Scalar,
    #[define(dot(velocity, hull.y))]
    sway: Scalar,
    #[define(dot(velocity, hull.z))]
    heave: Scalar,
    #[define(dot(omega(hull / ground), hull.y))]
    pitching: Scalar,
    #[define(along * surge * hull.x + across * (sway * hull.y + heave * hull.z))]
    impulse: Vector,
    #[acts(
        on = hull,
        value = -along * rate(surge) * hull.x - across * (rate(sway) * hull.y + rate(heave) * hull.z)
            - cross(omega(hull / ground), impulse)
    )]
    water: Force,
    #[acts(
        on = hull,
        value = -turning * (rate(pitching) * hull.y + cross(omega(hull / ground), pitching * hull.y))
            - cross(velocity, impulse)
    )]
    munk: Torque,
}

/// Kirchhoff's equations of a body in an ideal fluid: impulse and moment of impulse are constant in the
/// ground frame (Lamb, *Hydrodynamics*, 1932, §§ 124–126).
#[test]
fn hull_in_ideal_fluid_obeys_kirchhoffs_equations() {
    let hull = Hull { mass: 3.0, along: 0.4, across: 2.5, turning: 1.5 };
    let mut random = Random::new(5);
    for _ in 0..6 {
        let turn: SVector<f64, 4> = random.random_vector::<4>(1.0).normalize();
        let q = SVector::from_column_slice(&[1.0, 2.0, 3.0, turn[0], turn[1], turn[2], turn[3]]);
        let v: SVector<f64, 6> = random.random_vector(2.0);
        let total = SVector::<f64, 6>::from([3.4, 5.5, 5.5, 2.0, 6.5, 6.0]);
        let momentum = total.component_mul(&v);
        let (p, l) = (momentum.fixed_rows::<3>(0), momentum.fixed_rows::<3>(3));
        let (u, w) = (v.fixed_rows::<3>(0), v.fixed_rows::<3>(3));
        let (force, torque) = (p.cross(&w), l.cross(&w) + p.cross(&u));
        let mut expected = SVector::<f64, 6>::zeros();
        expected.fixed_rows_mut::<3>(0).copy_from(&force);
        expected.fixed_rows_mut::<3>(3).copy_from(&torque);
        let expected = expected.component_div(&total);
        let found = hull.forward_dynamics(&q, &v, &SVector::zeros());
        assert_close_relative_to_largest("v̇", found.as_slice(), expected.as_slice(), 1e-13);
    }
}

macro_rules! carts {
    ($name:ident, { $($element:tt)* }) => {
        #[mechanism(gravity = -9.81 * y, derivatives)]
        #[derive(Clone, Copy)]
        struct $name {
            b: f64,
            #[body(mass = 2)]
            cart: Body,
            #[body(mass = 1, com = -0.4 * y, inertia = rod(1, 0.8, y))]
            pole: Body,
            #[joint(ground -> cart, along = x)]
            rail: Sleeve,
            #[joint(cart -> pole, about = z)]
            hinge: Pin,
            $($element)*
        }
    };
}
carts!(Inertial, {
    #[acts(on = hinge, inertance = b)]
    inerter: Inerter,
});
carts!(Written, {
    #[acts(on = hinge, value = -b * rate(rate(hinge)))]
    inerter: Torque,
});

#[test]
fn integrators_treat_acceleration_forces_like_an_inerter() {
    let (q, v) = ([0.0, 1.0], [0.3, 0.0]);
    let (other, own) = (Inertial { b: 0.4 }, Written { b: 0.4 });
    macro_rules! compare {
        ($method:expr, $tolerance:expr) => {
            let a = simulate(&other).from(q, v).method($method).duration(1.0).finish().unwrap();
            let b = simulate(&own).from(q, v).method($method).duration(1.0).finish().unwrap();
            assert_close_relative_to_largest("q", b.q.as_slice(), a.q.as_slice(), $tolerance);
            assert_close_relative_to_largest("v", b.v.as_slice(), a.v.as_slice(), $tolerance);
        };
    }
    compare!(Rk4::step(1e-3), 1e-12);
    compare!(DormandPrince8::new().tolerance(1e-12, 1e-13), 1e-11);
    compare!(Rodas::new().tolerance(1e-9, 1e-10), 1e-7);
    compare!(Rosenbrock::step(1e-3), 1e-11);
    compare!(SemiImplicitEuler::step(1e-3), 1e-11);
    // One of the two mechanisms takes the midpoint of momenta, the other that of velocities. The results
    // differ by the error of a step.
    compare!(ImplicitMidpoint::step(1e-4), 1e-6);
    let (q, v) = (q.into(), v.into());
    let (a, b) = (other.linear_motion(&q, &v, &[].into()), own.linear_motion(&q, &v, &[].into()));
    assert_close_relative_to_largest("∂v̇/∂q", b.by_q.as_slice(), a.by_q.as_slice(), 1e-13);
    assert_close_relative_to_largest("∂v̇/∂v", b.by_v.as_slice(), a.by_v.as_slice(), 1e-12);
}
