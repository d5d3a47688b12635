//! Fighter: rates in a published state, trimmed flight, and its linear motion.

use crate::assert_mode_eigenvalue;
use linkwork::Table;
use linkwork::nalgebra::{DMatrix, SVector, UnitQuaternion};
use linkwork::prelude::*;
use linkwork_design::StateSpace;
use linkwork_design::flight::{self, FlightModes, LATERAL};
use linkwork_design::steady::equilibrium;
use linkwork_models::Fighter;

const FOOT: f64 = 0.3048;

/// Tolerance of rotational rates: the source divides by moments of inertia in constants of four digits.
const ROUNDED: f64 = 2.5e-4;

fn pose_coordinates(place: [f64; 3], [bank, pitch, heading]: [f64; 3]) -> SVector<f64, 7> {
    let turn = UnitQuaternion::from_euler_angles(bank, pitch, heading);
    let [x, y, z] = place;
    SVector::from([x, y, z, turn.i, turn.j, turn.k, turn.w])
}

/// Returns the velocity in body axes and the power, for a speed, angle of attack, sideslip, and body rates.
fn velocity_vector_with_power(
    speed: f64,
    alpha: f64,
    beta: f64,
    [p, q, r]: [f64; 3],
    power: f64,
) -> SVector<f64, 7> {
    let across = speed * beta.cos();
    SVector::from([across * alpha.cos(), speed * beta.sin(), across * alpha.sin(), p, q, r, power])
}

/// Checks that the time derivatives of all states of the F-16 model equal the published ones, in a state far
/// from any trim (Stevens, Lewis and Johnson, table 3.5-2).
#[test]
fn state_rates_match_the_book() {
    let fighter = Fighter { place: 0.4, ..Fighter::F16 };
    let (speed, alpha, beta) = (500.0 * FOOT, 0.5, -0.2);
    let q = pose_coordinates([1000.0 * FOOT, 900.0 * FOOT, -10000.0 * FOOT], [-1.0, 1.0, -1.0]);
    let v = velocity_vector_with_power(speed, alpha, beta, [0.7, -0.8, 0.9], 90.0);
    let u = [0.9, 20.0, -15.0, -20.0].into();
    let whole = fighter.extended();
    let tau = whole.generalized_forces(0.0, &q, &v, &u);
    let rates = whole.forward_dynamics(0.0, &q, &v, &tau);
    let (velocity, change) = (v.fixed_rows::<3>(0), rates.fixed_rows::<3>(0));
    let faster = velocity.dot(&change) / speed;
    let plane = v[0] * v[0] + v[2] * v[2];
    let attack = (v[0] * rates[2] - v[2] * rates[0]) / plane;
    let slip = (speed * rates[1] - v[1] * faster) / (speed * plane.sqrt());
    let over_ground = UnitQuaternion::from_euler_angles(-1.0, 1.0, -1.0) * velocity;
    let found = [
        faster / FOOT,
        attack,
        slip,
        rates[3],
        rates[4],
        rates[5],
        over_ground[0] / FOOT,
        over_ground[1] / FOOT,
        -over_ground[2] / FOOT,
        rates[6],
    ];
    let published = [
        -75.23724, -0.8813491, -0.4759990, 12.62679, 0.9649671, 0.5809759, 342.4439, -266.7707, 248.1241,
        -58.68999,
    ];
    for (k, (found, published)) in found.iter().zip(published).enumerate() {
        let digits = if (3..6).contains(&k) { ROUNDED } else { 3e-7 };
        assert!((found - published).abs() <= digits * published.abs(), "expected {published}, found {found}");
    }
}

/// Checks that a file of the command's option `--table` contains a table, point by point.
fn check_table_file<const N: usize>(name: &str, table: &Table<N>) {
    let path = format!("{}/src/fighter/tables/{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a file of the table");
    let parse_row =
        |line: &str| -> Vec<f64> { line.split(',').map(|field| field.parse().expect("a number")).collect() };
    let rows: Vec<Vec<f64>> = text.lines().skip(1).map(parse_row).collect();
    assert_eq!(rows.len(), table.values().len(), "{name}");
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(row[N], table.values()[k], "{name}: {row:?}");
        let mut rest = k;
        for axis in (0..N).rev() {
            let points = table.axes()[axis];
            assert_eq!(row[axis], points[rest % points.len()], "{name}: {row:?}");
            rest /= points.len();
        }
    }
}

/// Checks that the files from which the gallery's page is written contain the tables of the F-16.
#[test]
fn files_contain_the_tables() {
    let f = &Fighter::F16;
    let of_two = [
        ("cx", &f.cx),
        ("cl", &f.cl),
        ("cm", &f.cm),
        ("cn", &f.cn),
        ("cl_aileron", &f.cl_aileron),
        ("cl_rudder", &f.cl_rudder),
        ("cn_aileron", &f.cn_aileron),
        ("cn_rudder", &f.cn_rudder),
    ];
    let of_attack = [
        ("cz", &f.cz),
        ("cx_q", &f.cx_q),
        ("cy_r", &f.cy_r),
        ("cy_p", &f.cy_p),
        ("cz_q", &f.cz_q),
        ("cl_r", &f.cl_r),
        ("cl_p", &f.cl_p),
        ("cm_q", &f.cm_q),
        ("cn_r", &f.cn_r),
        ("cn_p", &f.cn_p),
    ];
    of_two.iter().for_each(|(name, table)| check_table_file(name, table));
    of_attack.iter().for_each(|(name, table)| check_table_file(name, table));
    check_table_file("thrust", &f.thrust);
}

struct LevelFlightState {
    q: SVector<f64, 7>,
    v: SVector<f64, 7>,
    u: SVector<f64, 4>,
}

/// Trims level flight at sea level: angle of attack, throttle, power and elevator are unknown.
fn trim_level_flight(fighter: &Fighter, speed: f64) -> LevelFlightState {
    let whole = fighter.extended();
    let found = equilibrium(&whole)
        .from(pose_coordinates([0.0; 3], [0.0, 0.1, 0.0]))
        .moving(velocity_vector_with_power(speed * FOOT, 0.1, 0.0, [0.0; 3], 20.0))
        .with_inputs([0.3, -1.0, 0.0, 0.0].into())
        .coordinates(["flight.wy"])
        .speeds(["flight.vx", "flight.vz"])
        .inputs(["throttle", "elevator"])
        .output("climb", 0.0)
        .output("airspeed", speed * FOOT)
        .find()
        .unwrap();
    LevelFlightState { q: found.q, v: found.v, u: found.u }
}

/// Checks that throttle, angle of attack and elevator (degrees) as functions of the speed (ft/s) in level
/// flight at sea level equal table 3.6-2 of Stevens, Lewis and Johnson.
#[test]
fn trimmed_flight_matches_the_book() {
    let published = [
        (170.0, 0.464, 27.2, 0.621),
        (200.0, 0.287, 19.7, 0.723),
        (260.0, 0.148, 11.6, -0.09),
        (300.0, 0.122, 8.49, -0.591),
        (350.0, 0.107, 5.87, -0.539),
        (400.0, 0.108, 4.16, -0.591),
        (440.0, 0.113, 3.19, -0.671),
        (500.0, 0.137, 2.14, -0.756),
        (540.0, 0.160, 1.63, -0.798),
        (600.0, 0.200, 1.04, -0.846),
        (640.0, 0.230, 0.742, -0.871),
        (700.0, 0.282, 0.382, -0.900),
        (800.0, 0.378, -0.045, -0.943),
    ];
    for (speed, throttle, alpha, elevator) in published {
        let LevelFlightState { v, u, .. } = trim_level_flight(&Fighter::F16, speed);
        let found = [u[0], v[2].atan2(v[0]).to_degrees(), u[1]];
        for (found, (expected, digits)) in
            found.into_iter().zip([(throttle, 0.0012), (alpha, 0.05), (elevator, 0.006)])
        {
            assert!((found - expected).abs() <= digits, "{speed} ft/s: expected {expected}, found {found}");
        }
    }
    // Table 3.6-3: effect of the position of the centre of mass on the elevator.
    for (place, throttle, alpha, elevator) in
        [(0.35, 0.1385, 0.03691, -0.7588), (0.3, 0.1485, 0.03936, -1.931), (0.38, 0.1325, 0.03544, -0.0559)]
    {
        let LevelFlightState { v, u, .. } = trim_level_flight(&Fighter { place, ..Fighter::F16 }, 502.0);
        assert!((u[0] - throttle).abs() < 2e-4, "{u}");
        assert!((v[2].atan2(v[0]) - alpha).abs() < 2e-5, "{v}");
        assert!((u[1] - elevator).abs() < 1e-3, "{u}");
    }
}

/// Checks that a coordinated turn of 0.3 rad/s at 502 ft/s equals table 3.6-3 of Stevens, Lewis and Johnson.
#[test]
fn coordinated_turn_matches_the_book() {
    let fighter = Fighter { place: 0.3, ..Fighter::F16 };
    let whole = fighter.extended();
    let (bank, pitch, turning) = (1.367_f64, 0.05185_f64, 0.3);
    let rates =
        [-pitch.sin(), bank.sin() * pitch.cos(), bank.cos() * pitch.cos()].map(|share| share * turning);
    let v = velocity_vector_with_power(502.0 * FOOT, 0.2485, 4.8e-4, rates, 64.0);
    let found = equilibrium(&whole)
        .from(pose_coordinates([0.0; 3], [bank, pitch, 0.0]))
        .moving(v)
        .with_inputs([0.85, -6.0, 0.1, -0.4].into())
        .coordinates(["flight.wx", "flight.wy"])
        .speeds(["flight.vx", "flight.vy", "flight.vz", "flight.wx", "flight.wy", "flight.wz"])
        .inputs(["throttle", "elevator", "aileron", "rudder"])
        .output("climb", 0.0)
        .output("airspeed", 502.0 * FOOT)
        .output("banking", 0.0)
        .output("rising", 0.0)
        .output("turning_right", turning)
        .output("felt_sideways", 0.0)
        .find()
        .unwrap();
    let turn = UnitQuaternion::new_normalize(linkwork::nalgebra::Quaternion::new(
        found.q[6], found.q[3], found.q[4], found.q[5],
    ));
    let (roll, pitch, _) = turn.euler_angles();
    let (v, u) = (found.v, found.u);
    let speed = v.fixed_rows::<3>(0).norm();
    let all = [
        (v[2].atan2(v[0]), 0.2485, 5e-4),
        ((v[1] / speed).asin(), 4.8e-4, 5e-5),
        (roll, 1.367, 5e-4),
        (pitch, 0.05185, 5e-5),
        (v[3], -0.01555, 1e-5),
        (v[4], 0.2934, 5e-5),
        (v[5], 0.06071, 5e-6),
        (u[0], 0.8499, 5e-4),
        (u[1], -6.256, 1e-3),
        (u[2], 0.09891, 5e-5),
        (u[3], -0.4218, 5e-4),
    ];
    for (found, expected, tolerance) in all {
        assert!((found - expected).abs() <= tolerance, "expected {expected}, found {found}");
    }
}

fn linearize_fighter_at_level_flight(fighter: &Fighter, at_rest: &LevelFlightState) -> StateSpace {
    let whole = fighter.extended();
    flight::linear_system(&at(&whole, 0.0), &at_rest.q, &at_rest.v, &at_rest.u).unwrap()
}

/// Published matrix for speed (ft/s), angle of attack, pitch and pitch rate at 502 ft/s at sea level (example
/// 3.7-1).
const LONGITUDINAL: [[f64; 4]; 4] = [
    [-1.9311e-2, 8.8157, -32.170, -0.57499],
    [-2.5389e-4, -1.0189, 0.0, 0.90506],
    [0.0, 0.0, 0.0, 1.0],
    [0.0, 0.82225, 0.0, -1.0774],
];

/// Published rows for sideslip, roll rate and yaw rate at 502 ft/s at sea level, with the columns sideslip,
/// roll rate, yaw rate and bank (example 5.3-1).
const ACROSS: [[f64; 4]; 3] =
    [[-0.3220, 0.0364, -0.9917, 0.0640], [-30.6492, -3.6784, 0.6646, 0.0], [8.5396, -0.0254, -0.4764, 0.0]];

#[test]
fn linearised_fighter_matches_the_book() {
    let trim = trim_level_flight(&Fighter::F16, 502.0);
    let system = linearize_fighter_at_level_flight(&Fighter::F16, &trim);
    let part = system.of_states(&["u", "w", "theta", "q"]).unwrap();
    let speed = 502.0 * FOOT;
    let (s, c) = trim.v[2].atan2(trim.v[0]).sin_cos();
    let mut to = DMatrix::identity(4, 4);
    (to[(0, 0)], to[(0, 1)], to[(1, 0)], to[(1, 1)]) = (c / FOOT, s / FOOT, -s / speed, c / speed);
    let a = &to * part.a() * to.clone().try_inverse().unwrap();
    for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let (found, expected) = (a[(i, j)], LONGITUDINAL[i][j]);
        assert!(
            (found - expected).abs() <= ROUNDED * expected.abs() + 1e-9,
            "A[{i}, {j}]: {expected}, found {found}"
        );
    }
    let elevator = to * part.b().column(1);
    for (found, expected) in elevator.iter().zip([0.17370, -2.1499e-3, 0.0, -0.17555]) {
        assert!((found - expected).abs() <= ROUNDED * expected.abs() + 1e-9, "B: {expected}, found {found}");
    }
    let part = system.of_states(&LATERAL).unwrap();
    for (i, j) in (0..3).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let unit = [speed, 1.0, 1.0, 1.0];
        let (found, expected) = (part.a()[(i, j)] * unit[j] / unit[i], ACROSS[i][j]);
        assert!(
            (found - expected).abs() <= ROUNDED * expected.abs() + 5e-5,
            "A[{i}, {j}]: {expected}, found {found}"
        );
    }
}

/// Checks the modes of a fighter aircraft. With an aft centre of mass it has two real pitch modes, one of
/// them unstable; with a forward centre of mass it has a short period. The engine is a separate mode with a
/// lag of one second.
#[test]
fn centre_of_mass_determines_pitch_modes() {
    let flight_modes_for_center_of_mass = |place| {
        let fighter = Fighter { place, ..Fighter::F16 };
        FlightModes::from_system(&linearize_fighter_at_level_flight(
            &fighter,
            &trim_level_flight(&fighter, 502.0),
        ))
        .unwrap()
    };
    let (stable, unstable) = (flight_modes_for_center_of_mass(0.3), flight_modes_for_center_of_mass(0.38));
    assert!(stable.short_period.is_some_and(|mode| mode.exponent.re < -1.0));
    assert!(stable.others.iter().all(|mode| mode.exponent.re < 0.0));
    let engine =
        stable.others.iter().find(|mode| mode.participation_of("power").is_some_and(|part| part > 0.99));
    assert_mode_eigenvalue(engine, -1.0, 0.0, 1e-9);
    assert!(unstable.short_period.is_none());
    let growing: Vec<_> = unstable.others.iter().filter(|mode| mode.exponent.re > 0.0).collect();
    assert!(
        growing.len() == 1 && growing[0].exponent.im == 0.0 && growing[0].participation_of("q") > Some(0.3)
    );

    // Lateral modes: those of the book's matrix with its bank rate, p + r tan θ.
    let trim = trim_level_flight(&Fighter::F16, 502.0);
    let [beta, p, r] = ACROSS;
    let bank = [0.0, 1.0, trim.v[2] / trim.v[0], 0.0];
    let published = DMatrix::from_fn(4, 4, |i, j| [beta, p, r, bank][i][j]).complex_eigenvalues();
    let found = FlightModes::from_system(&linearize_fighter_at_level_flight(&Fighter::F16, &trim)).unwrap();
    let real =
        |from: f64, to: f64| published.iter().find(|e| e.im == 0.0 && from < e.re && e.re < to).unwrap();
    let wave = published.iter().find(|e| e.im > 0.0).unwrap();
    assert_mode_eigenvalue(found.dutch_roll.as_ref(), wave.re, wave.im, 1e-3);
    assert_mode_eigenvalue(found.roll.as_ref(), real(-5.0, -1.0).re, 0.0, 1e-3);
    assert_mode_eigenvalue(found.spiral.as_ref(), real(-0.1, 0.0).re, 0.0, 3e-2);
}
