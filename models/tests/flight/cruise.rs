//! Transport and light aircraft given by their stability derivatives.

use crate::{assert_mode_eigenvalue, assert_relatively_close};
use linkwork::nalgebra::DMatrix;
use linkwork::prelude::*;
use linkwork_design::StateSpace;
use linkwork_design::flight::{self, Derivatives, FlightModes, LATERAL, Reference};
use linkwork_design::mechanism::measured_system;
use linkwork_design::steady::equilibrium;
use linkwork_models::CruisingAircraft;

type CruiseState = (SVector<f64, 7>, SVector<f64, 6>, SVector<f64, 4>);

/// Trims level flight at the cruise speed: pitch, climb, elevator and thrust are unknown.
fn trim_level_flight(craft: &CruisingAircraft) -> CruiseState {
    let found = equilibrium(craft)
        .moving([craft.cruise, 0.0, 0.0, 0.0, 0.0, 0.0].into())
        .with_inputs([0.01, 0.0, 0.0, 1e3].into())
        .coordinates(["flight.wy"])
        .speeds(["flight.vx", "flight.vz"])
        .inputs(["elevator", "thrust"])
        .output("climb", 0.0)
        .output("airspeed", craft.cruise)
        .find()
        .unwrap();
    (found.q, found.v, found.u)
}

fn linearize_at_level_flight(craft: &CruisingAircraft) -> StateSpace {
    let (q, v, u) = trim_level_flight(craft);
    flight::linear_system(craft, &q, &v, &u).unwrap()
}

const TRANSPORT: CruisingAircraft = CruisingAircraft::BOEING_747;

#[test]
fn transport_aircraft_cruises() {
    let (q, v, u) = trim_level_flight(&TRANSPORT);
    // In cruise the derivatives alone determine the trim: all deflections are zero.
    assert!((v[0] - 235.9).abs() < 1e-12 && v[2].abs() < 1e-9 && q[4].abs() < 1e-12);
    assert!(u[0].abs() < 1e-12 && u[3].abs() < 1e-6, "{u}");
    let felt = measured_system(&TRANSPORT, 0.0, &q, &v, &u).unwrap();
    assert_eq!(felt.outputs()[3].name, "felt");
}

/// Checks the state-space matrices of a transport aircraft. They equal an independent computation from
/// Etkin's derivatives to 1e-9, and Etkin's printed matrices (ft and s) to their digits.
#[test]
fn transport_matches_etkin_and_reid_matrices() {
    let system = linearize_at_level_flight(&TRANSPORT);
    let part = system.of_states(&["u", "w", "q", "theta"]).unwrap();
    let own = [
        [-0.006866611275943936, 0.013943035674208383, 0.0, -9.81],
        [-0.09050889360654447, -0.31489494006034713, 235.89334048404203, 0.0],
        [0.00038918098285667125, -0.003361353515319591, -0.42814117544558544, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ];
    let feet = 1.0 / 0.3048;
    let published = [
        [-0.006868, 0.01395, 0.0, -32.2],
        [-0.09055, -0.3151, 773.98, 0.0],
        [0.0001187, -0.001026, -0.4285, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ];
    let in_feet = [1.0 / feet, 1.0 / feet, 1.0, 1.0];
    for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let found = part.a()[(i, j)];
        assert!((found - own[i][j]).abs() <= 1e-9 * own[i][j].abs() + 1e-12, "A[{i}, {j}] is {found}");
        let found = found / in_feet[i] * in_feet[j];
        assert!(
            (found - published[i][j]).abs() <= 1.5e-3 * published[i][j].abs() + 1e-9,
            "A[{i}, {j}] is {found}"
        );
    }
    let part = system.of_states(&LATERAL).unwrap();
    let own = [
        [-0.05576578472342987, 0.0, -235.9, 9.81],
        [-0.01270078301241097, -0.4349018915599015, 0.4142375389921919, 0.0],
        [0.003565068319118036, -0.006054072298785469, -0.14579164379805434, 0.0],
        [0.0, 1.0, 0.0, 0.0],
    ];
    for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let found = part.a()[(i, j)];
        assert!((found - own[i][j]).abs() <= 1e-9 * own[i][j].abs() + 1e-12, "A[{i}, {j}] is {found}");
    }
    // Effect of the elevator: Z_δ / (m − Z_ẇ), and M_δ plus the effect of the resulting downwash.
    let column = system.input_index("elevator").unwrap();
    let CruisingAircraft { mass, density, cruise, area, chord, iyy, .. } = TRANSPORT;
    let (load, lag) = (0.5 * density * cruise * cruise * area, 0.25 * density * chord * area);
    let heave = load * TRANSPORT.cz_elevator / (mass - lag * TRANSPORT.cz_alpha_rate);
    assert_relatively_close(system.b()[(2, column)], heave, 1e-12);
    let pitch = load * chord * TRANSPORT.cm_elevator + lag * chord * TRANSPORT.cm_alpha_rate * heave;
    assert_relatively_close(system.b()[(4, column)], pitch / iyy, 1e-12);
}

/// Checks that the modes of a transport aircraft have the published eigenvalues of Etkin and Reid, and those
/// of an independent computation.
#[test]
fn transport_matches_etkin_and_reid_modes() {
    let modes = FlightModes::from_system(&linearize_at_level_flight(&TRANSPORT)).unwrap();
    assert_mode_eigenvalue(modes.short_period.as_ref(), -0.37166215649674494, 0.8868788584671381, 1e-9);
    assert_mode_eigenvalue(modes.phugoid.as_ref(), -0.003289206894193512, 0.06720807985472561, 1e-9);
    assert_mode_eigenvalue(modes.dutch_roll.as_ref(), -0.033052210108050734, 0.9467852313277423, 1e-9);
    assert_mode_eigenvalue(modes.roll.as_ref(), -0.5630776981191257, 0.0, 1e-9);
    assert_mode_eigenvalue(modes.spiral.as_ref(), -0.007277201746158317, 0.0, 1e-9);
    assert_mode_eigenvalue(modes.short_period.as_ref(), -0.3719, 0.8875, 1e-3);
    assert_mode_eigenvalue(modes.phugoid.as_ref(), -0.003289, 0.06723, 1e-3);
    assert_mode_eigenvalue(modes.dutch_roll.as_ref(), -0.033011, 0.94655, 1e-3);
    assert_mode_eigenvalue(modes.roll.as_ref(), -0.56248, 0.0, 1.2e-3);
    assert_mode_eigenvalue(modes.spiral.as_ref(), -0.0072973, 0.0, 3e-3);
    // Height is the remaining state: nothing depends on it in air of uniform density.
    let [height] = &modes.others[..] else { panic!("{:?}", modes.others) };
    assert!(height.frequency() < 1e-9);
    assert_eq!(modes.named_modes().len(), 5);
}

/// Checks that without the derivatives with respect to `α̇` the short period has seven eighths of its damping
/// ratio.
#[test]
fn alpha_rate_forces_damp_short_period() {
    let short_period_damping = |craft| {
        FlightModes::from_system(&linearize_at_level_flight(&craft))
            .unwrap()
            .short_period
            .unwrap()
            .damping_ratio()
    };
    let without = CruisingAircraft { cz_alpha_rate: 0.0, cm_alpha_rate: 0.0, ..TRANSPORT };
    let ratio = short_period_damping(without) / short_period_damping(TRANSPORT);
    assert!((ratio - 7.0 / 8.0).abs() < 0.01, "{ratio}");
}

/// Checks that dimensionless derivatives, computed from the dimensional derivatives of an aircraft, equal the
/// declared ones.
#[test]
fn dimensionless_derivatives_match_declared() {
    let craft = TRANSPORT;
    let (q, v, u) = trim_level_flight(&craft);
    let found = Derivatives::at_state(&craft, &q, &v, &u).unwrap();
    let reference =
        Reference { density: craft.density, area: craft.area, chord: craft.chord, span: craft.span };
    let declared = [
        ("X", "u", craft.cx_u),
        ("X", "w", craft.cx_alpha),
        ("Z", "u", craft.cz_u),
        ("Z", "w", craft.cz_alpha),
        ("Z", "q", craft.cz_q),
        ("Z", "w'", craft.cz_alpha_rate),
        ("Z", "elevator", craft.cz_elevator),
        ("M", "u", craft.cm_u),
        ("M", "w", craft.cm_alpha),
        ("M", "q", craft.cm_q),
        ("M", "w'", craft.cm_alpha_rate),
        ("M", "elevator", craft.cm_elevator),
        ("Y", "v", craft.cy_beta),
        ("Y", "rudder", craft.cy_rudder),
        ("L", "v", craft.cl_beta),
        ("L", "p", craft.cl_p),
        ("L", "r", craft.cl_r),
        ("L", "aileron", craft.cl_aileron),
        ("N", "v", craft.cn_beta),
        ("N", "p", craft.cn_p),
        ("N", "r", craft.cn_r),
        ("N", "rudder", craft.cn_rudder),
    ];
    for axes in [found.clone(), found.in_stability_axes()] {
        for (force, by, expected) in declared {
            assert_relatively_close(axes.coefficient(force, by, &reference).unwrap(), expected, 1e-9);
        }
    }
    // Table 6.2 of the book, in N·s/m: X_u = −1.982e3, Z_w = −9.030e4, M_q = −1.521e7, Z_ẇ = 1.909e3.
    for (force, by, published) in
        [("X", "u", -1.982e3), ("Z", "w", -9.030e4), ("M", "q", -1.521e7), ("Z", "w'", 1.909e3)]
    {
        assert_relatively_close(found.of_force(force, by).unwrap(), published, 1e-3);
    }
    assert_relatively_close(found.static_margin(craft.chord).unwrap(), 1.023 / 4.920, 1e-9);
    assert!(found.of_force("M", "flaps").unwrap_err().to_string().contains("elevator"));
}

/// Checks that the Navion has the printed eigenvalues (Nelson, *Flight Stability and Automatic Control*,
/// 1998, ch. 4 and 5).
#[test]
fn navion_matches_nelson_modes() {
    let modes = FlightModes::from_system(&linearize_at_level_flight(&CruisingAircraft::NAVION)).unwrap();
    assert_mode_eigenvalue(modes.short_period.as_ref(), -2.51, 2.59, 1e-2);
    assert_mode_eigenvalue(modes.phugoid.as_ref(), -0.017, 0.213, 1e-2);
    assert_mode_eigenvalue(modes.dutch_roll.as_ref(), -0.487, 2.335, 1e-2);
    assert_mode_eigenvalue(modes.roll.as_ref(), -8.435, 0.0, 1e-2);
    assert_mode_eigenvalue(modes.spiral.as_ref(), -0.00877, 0.0, 2e-1);
}

/// Checks the modes of the DC-8 at 468.2 ft/s in 15 000 ft (Teper, *Aircraft Stability and Control Data*,
/// 1969, as in Cook, *Flight Dynamics Principles*, 2007, ch. 7). Its lateral derivatives, per ft/s and rad/s,
/// give the characteristic polynomial `(s + 0.0065) (s + 1.329) (s² + 0.254 s + 1.433)`. The mass, moments of
/// inertia, area and span that make them dimensionless cancel.
#[test]
fn dc8_matches_cook_modes() {
    let (feet, speed) = (0.3048, 468.2 * 0.3048);
    let base = CruisingAircraft { g: 32.2 * feet, cruise: speed, product: 0.0, ..TRANSPORT };
    let CruisingAircraft { mass, ixx, izz, density, area, span, .. } = base;
    let load = 0.5 * density * speed * speed * area;
    let derivative_by_sideslip =
        |derivative: f64, inertia: f64| derivative / feet * speed * inertia / (load * span);
    let derivative_by_rate =
        |derivative: f64, inertia: f64| derivative * 2.0 * speed * inertia / (load * span * span);
    let craft = CruisingAircraft {
        cy_beta: -0.1008 * mass * speed / load,
        cl_beta: derivative_by_sideslip(-0.00579, ixx),
        cl_p: derivative_by_rate(-1.232, ixx),
        cl_r: derivative_by_rate(0.397, ixx),
        cn_beta: derivative_by_sideslip(0.00278, izz),
        cn_p: derivative_by_rate(-0.0346, izz),
        cn_r: derivative_by_rate(-0.257, izz),
        ..base
    };
    let modes = FlightModes::from_system(&linearize_at_level_flight(&craft)).unwrap();
    let dutch_roll = modes.dutch_roll.unwrap();
    assert_relatively_close(2.0 * dutch_roll.damping_ratio() * dutch_roll.frequency(), 0.254, 2e-3);
    assert_relatively_close(dutch_roll.frequency().powi(2), 1.433, 1e-3);
    assert_mode_eigenvalue(modes.roll.as_ref(), -1.329, 0.0, 1e-3);
    assert_mode_eigenvalue(modes.spiral.as_ref(), -0.0065, 0.0, 5e-3);
}

/// Checks the modes of the A-7A at 20 000 ft and 676 ft/s (Mach 0.6), in body axes that climb at 13.3° to the
/// wind (Cook, *Flight Dynamics Principles*, 2007, ch. 5). The printed state matrix gives
/// `(s² + 0.033 s + 0.020) (s² + 0.902 s + 2.666)`.
#[test]
fn printed_matrices_yield_named_modes() {
    let a = DMatrix::from_row_slice(
        4,
        4,
        &[
            0.00501, 0.00464, -72.9, -31.34, -0.0857, -0.545, 309.0, -7.4, 0.00185, -0.00767, -0.395,
            0.00132, 0.0, 0.0, 1.0, 0.0,
        ],
    );
    let system = StateSpace::new(a, DMatrix::zeros(4, 0), DMatrix::identity(4, 4), DMatrix::zeros(4, 0));
    let states = [("u", "ft/s"), ("w", "ft/s"), ("q", "rad/s"), ("theta", "rad")];
    let modes = FlightModes::from_system(&system.unwrap().with_states(states).unwrap()).unwrap();
    for (mode, damping, stiffness, digits) in
        [(modes.phugoid.unwrap(), 0.033, 0.020, 0.02), (modes.short_period.unwrap(), 0.902, 2.666, 1e-3)]
    {
        assert_relatively_close(2.0 * mode.damping_ratio() * mode.frequency(), damping, digits);
        assert_relatively_close(mode.frequency().powi(2), stiffness, digits);
    }
}

#[test]
fn error_away_from_steady_state_names_the_rate() {
    let (q, mut v, u) = trim_level_flight(&TRANSPORT);
    v[4] = 0.01;
    let error = flight::linear_system(&TRANSPORT, &q, &v, &u).unwrap_err().to_string();
    assert!(error.contains("not steady") && error.contains("flight.v"), "{error}");
}
