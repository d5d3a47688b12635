//! Tables, the standard atmosphere and angles of flight in mechanisms. A table of a parabola equals the
//! parabola in every function and derivative; other tables agree with differences of high order.

use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{Lanes, Real, Table, mechanism};
use support::compare::assert_close_relative_to_largest;
use support::differences::derivative_at_zero;
use support::random::Random;

/// Tolerance between an interpolated table and the formula from which its values were computed.
const FORMULA: f64 = 1e-10;
/// Tolerance between derivatives and central differences of eighth order.
const DIFFERENCE: f64 = 1e-10;
/// Step of the central differences with which derivatives are compared.
const STEP: f64 = 2e-3;

/// Defines an aircraft with coefficients from tables or formulas. The braces declare the parameters of the
/// coefficients.
macro_rules! aircraft {
    ($name:ident<$t:ident>, { $($parameter:ident: $kind:ty),* }, $lift:expr, $drag:expr, $thrust:expr) => {
        #[mechanism(gravity = 9.81 * z, derivatives, second_derivatives, sensitivities, prepare, batch)]
        #[derive(Clone, Copy, Debug, PartialEq)]
        struct $name<$t: Real> {
            mass: $t,
            area: $t,
            $($parameter: $kind,)*
            elevator: Input,
            throttle: Input,
            #[body(mass = mass, inertia = diagonal(1000, 2000, 2500))]
            airframe: Body,
            #[joint(ground -> airframe)]
            flight: Free,
            #[define(v(airframe / ground / ground))]
            velocity: Vector,
            #[define(angle_of_attack(airframe, velocity))]
            alpha: Scalar,
            #[define(-dot(r(airframe / ground), ground.z))]
            height: Scalar,
            #[define(density(height) / 2 * dot(velocity, velocity))]
            load: Scalar,
            #[acts(on = airframe, value = -load * area * $lift * airframe.z)]
            lifting: Force,
            #[acts(on = airframe, value = -load * area * $drag * airframe.x)]
            dragging: Force,
            #[acts(on = airframe, value = $thrust * airframe.x)]
            pushing: Force,
            #[output(alpha)]
            attack: Scalar,
            #[output($lift)]
            coefficient: Scalar,
        }
    };
}

aircraft!(
    Tabulated<T>,
    { lift: Table<2>, drag: Table<1>, thrust: Table<3> },
    lift(alpha, elevator),
    drag(alpha),
    thrust(throttle, height, norm(velocity))
);
aircraft!(
    Written<T>,
    {},
    ((0.2 + 5 * alpha - 3 * alpha * alpha) * (1 + 0.3 * elevator + elevator * elevator)),
    (0.02 + 0.9 * alpha * alpha),
    (2000 * (0.1 + throttle + throttle * throttle / 4) * (1 - height / 20000) * (1 - norm(velocity) / 400))
);

static ANGLES: [f64; 6] = [-1.6, -0.4, -0.05, 0.3, 0.8, 1.7];
static ELEVATOR: [f64; 4] = [-1.2, -0.3, 0.1, 1.3];
static POWER: [f64; 4] = [-1.5, 0.0, 0.4, 1.6];
static HEIGHT: [f64; 3] = [-10.0, 800.0, 9000.0];
static SPEED: [f64; 3] = [0.0, 40.0, 300.0];

fn aircraft_tables() -> (Table<2>, Table<1>, Table<3>) {
    let (mut lift, mut drag, mut thrust) = (Vec::new(), Vec::new(), Vec::new());
    for a in ANGLES {
        lift.extend(ELEVATOR.map(|d| (0.2 + 5.0 * a - 3.0 * a * a) * (1.0 + 0.3 * d + d * d)));
        drag.push(0.02 + 0.9 * a * a);
    }
    for p in POWER {
        for h in HEIGHT {
            thrust.extend(
                SPEED.map(|v| 2000.0 * (0.1 + p + p * p / 4.0) * (1.0 - h / 20_000.0) * (1.0 - v / 400.0)),
            );
        }
    }
    let lift = Table::new([&ANGLES, &ELEVATOR], lift.leak()).unwrap();
    let drag = Table::new([&ANGLES], drag.leak()).unwrap();
    (lift, drag, Table::new([&POWER, &HEIGHT, &SPEED], thrust.leak()).unwrap())
}

fn tabulated_aircraft<T: Real>(mass: T, area: T) -> Tabulated<T> {
    let (lift, drag, thrust) = aircraft_tables();
    Tabulated { mass, area, lift: lift.smooth(), drag: drag.smooth(), thrust: thrust.smooth() }
}

struct State {
    q: SVector<f64, 7>,
    v: SVector<f64, 6>,
    u: SVector<f64, 2>,
}

fn random_states() -> Vec<State> {
    let mut random = Random::new(5);
    let random_state = |k: usize| {
        let turn: SVector<f64, 4> = random.random_vector::<4>(1.0).normalize();
        let r: SVector<f64, 3> = random.random_vector(100.0);
        let mut v: SVector<f64, 6> = random.random_vector(1.0);
        v[0] += 60.0;
        v[2] += 4.0 * k as f64;
        let q = SVector::from_column_slice(&[r[0], r[1], -1000.0 - r[2], turn[0], turn[1], turn[2], turn[3]]);
        State { q, v, u: random.random_vector(1.0) }
    };
    (0..4).map(random_state).collect()
}

#[test]
fn table_of_a_parabola_equals_the_parabola() {
    let (table, formula) = (tabulated_aircraft(900.0, 16.0), Written { mass: 900.0, area: 16.0 });
    let prepared = table.prepare();
    for State { q, v, u } in random_states() {
        let check_same_values = |what: &str, found: &[f64], expected: &[f64]| {
            assert_close_relative_to_largest(what, found, expected, FORMULA)
        };
        let (tau, expected) = (table.generalized_forces(&q, &v, &u), formula.generalized_forces(&q, &v, &u));
        check_same_values("τ", tau.as_slice(), expected.as_slice());
        check_same_values(
            "τ, prepared",
            prepared.generalized_forces(&q, &v, &u).as_slice(),
            expected.as_slice(),
        );
        check_same_values("output", &[table.coefficient(&q, &v, &u)], &[formula.coefficient(&q, &v, &u)]);
        let ((a, b), (c, d)) = (table.linearize(&q, &v, &u), formula.linearize(&q, &v, &u));
        check_same_values("A", a.as_slice(), c.as_slice());
        check_same_values("B", b.as_slice(), d.as_slice());
        let (a, b) = prepared.linearize(&q, &v, &u);
        check_same_values("A, prepared", a.as_slice(), c.as_slice());
        check_same_values("B, prepared", b.as_slice(), d.as_slice());
    }
}

#[test]
fn table_derivatives_agree_with_high_order_differences() {
    let (lift, drag, thrust) = aircraft_tables();
    for linear in [true, false] {
        let aircraft_with_tables = |smooth: bool| {
            if smooth {
                tabulated_aircraft(900.0, 16.0)
            } else {
                Tabulated { mass: 900.0, area: 16.0, lift: lift.extrapolated(), drag, thrust }
            }
        };
        let aircraft = aircraft_with_tables(!linear);
        for State { q, v, u } in random_states() {
            let (state, input) = aircraft.linearize(&q, &v, &u);
            let zero = SVector::<f64, 6>::zeros();
            let acceleration_at_change =
                |dq: &SVector<f64, 6>, dv: &SVector<f64, 6>, du: &SVector<f64, 2>| {
                    let (q, v, u) = (aircraft.integrate(&q, dq), v + dv, u + du);
                    aircraft.forward_dynamics(&q, &v, &aircraft.generalized_forces(&q, &v, &u))
                };
            for k in 0..6 {
                let unit = SVector::<f64, 6>::from_fn(|i, _| f64::from(u8::from(i == k)));
                let none = SVector::<f64, 2>::zeros();
                let by_q = derivative_at_zero(STEP, |s| acceleration_at_change(&(unit * s), &zero, &none));
                let by_v = derivative_at_zero(STEP, |s| acceleration_at_change(&zero, &(unit * s), &none));
                let acceleration_derivative_column = |j: usize| state.fixed_view::<6, 1>(6, j).into_owned();
                assert_close_relative_to_largest(
                    "by q",
                    acceleration_derivative_column(k).as_slice(),
                    by_q.as_slice(),
                    DIFFERENCE,
                );
                assert_close_relative_to_largest(
                    "by v",
                    acceleration_derivative_column(6 + k).as_slice(),
                    by_v.as_slice(),
                    DIFFERENCE,
                );
            }
            for k in 0..2 {
                let unit = SVector::<f64, 2>::from_fn(|i, _| f64::from(u8::from(i == k)));
                let by_u = derivative_at_zero(STEP, |s| acceleration_at_change(&zero, &zero, &(unit * s)));
                let column = input.fixed_view::<6, 1>(6, k).into_owned();
                assert_close_relative_to_largest("by u", column.as_slice(), by_u.as_slice(), DIFFERENCE);
            }
        }
    }
}

#[test]
fn batched_table_lookups_are_independent() {
    let aircraft = tabulated_aircraft(900.0, 16.0);
    let wide = tabulated_aircraft(Lanes::<f64, 4>::splat(900.0), Lanes::splat(16.0));
    let states = random_states();
    let lanes_of_states = |f: &dyn Fn(&State) -> f64| Lanes::<f64, 4>::from_fn(|k| f(&states[k]));
    let q = SVector::<_, 7>::from_fn(|i, _| lanes_of_states(&|s| s.q[i]));
    let v = SVector::<_, 6>::from_fn(|i, _| lanes_of_states(&|s| s.v[i]));
    let u = SVector::<_, 2>::from_fn(|i, _| lanes_of_states(&|s| s.u[i]));
    let (all, batched) = (wide.generalized_forces(&q, &v, &u), aircraft.generalized_forces_lanes(&q, &v, &u));
    for (lane, state) in states.iter().enumerate() {
        let one = aircraft.generalized_forces(&state.q, &state.v, &state.u);
        let lane_values = |all: &SVector<Lanes<f64, 4>, 6>| all.map(|x| x.0[lane]);
        assert_close_relative_to_largest(
            "numbers of lanes",
            lane_values(&all).as_slice(),
            one.as_slice(),
            1e-12,
        );
        assert_close_relative_to_largest(
            "functions of lanes",
            lane_values(&batched).as_slice(),
            one.as_slice(),
            1e-12,
        );
    }
}

/// Airframe whose outputs are the angles of flight for a known attitude and velocity.
#[mechanism]
struct AirframeWithFlightAngles {
    #[body(mass = 1, inertia = sphere(1, 1))]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,
    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[output([heading(airframe), elevation(airframe), bank(airframe)])]
    attitude: Vector,
    #[output([angle_of_attack(airframe, velocity), sideslip(airframe, velocity), 0])]
    incidence: Vector,
    #[output([course(velocity), flight_path(velocity), 0])]
    path: Vector,
    #[output(speed_of_sound(-dot(r(airframe / ground), ground.z)))]
    sound: Scalar,
}

#[test]
fn flight_angles_reproduce_the_attitude() {
    use linkwork::nalgebra::{UnitQuaternion, Vector3};
    let (heading, elevation, bank) = (0.7, 0.3, -0.4);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading)
        * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), elevation)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), bank);
    let c = turn.coords;
    let q = SVector::from_column_slice(&[0.0, 0.0, -11_000.0, c[0], c[1], c[2], c[3]]);
    let (attack, slip, speed) = (0.2_f64, -0.1_f64, 50.0);
    let body = Vector3::new(attack.cos() * slip.cos(), slip.sin(), attack.sin() * slip.cos()) * speed;
    let v = SVector::from_column_slice(&[body[0], body[1], body[2], 0.0, 0.0, 0.0]);
    assert_close_relative_to_largest(
        "attitude",
        AirframeWithFlightAngles.attitude(&q).as_slice(),
        &[heading, elevation, bank],
        1e-14,
    );
    assert_close_relative_to_largest(
        "incidence",
        AirframeWithFlightAngles.incidence(&q, &v).as_slice(),
        &[attack, slip, 0.0],
        1e-14,
    );
    let path = turn * body;
    let expected = [path[1].atan2(path[0]), (-path[2] / speed).asin(), 0.0];
    assert_close_relative_to_largest(
        "path",
        AirframeWithFlightAngles.path(&q, &v).as_slice(),
        &expected,
        1e-14,
    );
    // U.S. Standard Atmosphere 1976, table III: 295.154 m/s at 11 km.
    assert!((AirframeWithFlightAngles.sound(&q) - 295.154).abs() < 1e-3);
}

/// Fan whose drive torque and output come from a table of torque over speed, looked up at constant arguments.
#[mechanism(derivatives, prepare, batch, sensitivities)]
struct Fan {
    torque: Table<1>,
    gear: f64,
    #[body(mass = 2, inertia = disk(2, 0.1, z))]
    wheel: Body,
    #[joint(ground -> wheel, about = z)]
    shaft: Pin,
    #[acts(on = shaft, value = gear * torque(3) - torque(0))]
    drive: Torque,
    #[output(torque(2))]
    seen: Scalar,
}

#[test]
fn tables_are_evaluated_at_constants() {
    static SPEED: [f64; 3] = [0.0, 2.0, 4.0];
    static TORQUE: [f64; 3] = [1.0, 5.0, 6.0];
    let fan = Fan { torque: Table::new([&SPEED], &TORQUE).unwrap(), gear: 3.0 };
    let (q, v) = ([0.2].into(), [0.0].into());
    // The moment of inertia is 2 · 0.1² / 2 kg m².
    let expected = (3.0 * 5.5 - 1.0) / 0.01;
    let tau = SVector::zeros();
    let found = [fan.forward_dynamics(&q, &v, &tau)[0], fan.prepare().forward_dynamics(&q, &v, &tau)[0]];
    assert!(found.iter().all(|a| (a - expected).abs() < 1e-11), "{found:?} are not {expected}");
    assert!((fan.seen(&q) - 5.0).abs() < 1e-15);
    assert!((fan.forward_dynamics_by_parameters(&q, &v, &tau)[0] - 550.0).abs() < 1e-10);
}

/// Cam mechanism: a table gives the height of the follower as a function of the angle.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct Cam {
    rise: Table<1>,
    #[body(mass = 2, inertia = disk(2, 0.1, z))]
    disk: Body,
    #[body(mass = 0.5)]
    follower: Body,
    #[joint(ground -> disk, about = z)]
    shaft: Pin,
    #[joint(ground -> follower, along = y)]
    guide: Sleeve,
    #[constraint(guide - rise(shaft))]
    contact: Holonomic,
}

#[test]
fn constraint_may_contain_a_table() {
    static ANGLE: [f64; 4] = [-2.0, -0.5, 0.5, 2.0];
    static RISE: [f64; 4] = [0.4, 0.025, 0.025, 0.4];
    // The follower's height is θ² / 10.
    let cam = Cam { rise: Table::new([&ANGLE], &RISE).unwrap().smooth() };
    let (q, v) = (SVector::from([0.6, 0.036]), SVector::from([1.5, 0.18]));
    let motion = cam.constrained_dynamics(&q, &v, &SVector::zeros());
    // θ̈ (I + m r'²) = −m r' (g + r'' θ̇²), with r' = θ / 5 and r'' = 1/5.
    let (inertia, mass, slope): (f64, f64, f64) = (0.01, 0.5, 0.12);
    let expected = -mass * slope * (9.81 + 0.2 * 1.5 * 1.5) / (inertia + mass * slope * slope);
    assert!((motion.0[0] - expected).abs() < 1e-9, "{} is not {expected}", motion.0[0]);
    let _: SMatrix<f64, 1, 2> = cam.constraint_jacobian(&q);
}

#[test]
fn adaptive_methods_agree_on_a_constrained_motion() {
    use linkwork::prelude::{DormandPrince, DormandPrince8, Rodas, simulate};
    static ANGLE: [f64; 4] = [-2.0, -0.5, 0.5, 2.0];
    static RISE: [f64; 4] = [0.4, 0.025, 0.025, 0.4];
    let cam = Cam { rise: Table::new([&ANGLE], &RISE).unwrap().smooth() };
    let run = simulate(&cam).from([0.6, 0.036], [1.5, 0.18]).duration(2.0);
    let tight = run.clone().method(DormandPrince::new().tolerance(1e-12, 1e-12)).finish().unwrap();
    let eighth = run.clone().method(DormandPrince8::new().tolerance(1e-11, 1e-11)).finish().unwrap();
    let stiff = run.method(Rodas::new().tolerance(1e-7, 1e-7)).finish().unwrap();
    for (end, tolerance) in [(eighth, 1e-8), (stiff, 1e-4)] {
        assert!((end.q - tight.q).norm() < tolerance, "{} for {}", end.q, tight.q);
        assert!((end.v - tight.v).norm() < tolerance, "{} for {}", end.v, tight.v);
    }
}
