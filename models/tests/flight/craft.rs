//! Glider, quadrotor, satellite with wheels, and vehicle over the round Earth, against closed-form solutions.

use crate::{assert_mode_eigenvalue, assert_relatively_close};
use linkwork::nalgebra::{Complex, Quaternion, SVector, UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork::{Mechanism, Outputs};
use linkwork_design::flight::{self, Derivatives, FlightModes};
use linkwork_design::mechanism::{linear_system, measured_system};
use linkwork_design::steady::{SteadyState, equilibrium};
use linkwork_models::{Glider, HypersonicGlider, Quadrotor, WheeledSatellite};
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

const GLIDER: Glider = Glider {
    g: 9.81,
    mass: 350.0,
    ixx: 1200.0,
    iyy: 600.0,
    izz: 1750.0,
    density: 1.225,
    area: 11.0,
    chord: 0.75,
    span: 15.0,
    cl_0: 0.35,
    cl_alpha: 5.7,
    cd_0: 0.010,
    cd_induced: 0.017,
    cm_alpha: -0.9,
    cm_rate: -14.0,
    cm_elevator: -1.2,
    cy_beta: -0.3,
    roll_beta: -0.09,
    roll_p: -0.55,
    roll_r: 0.12,
    yaw_beta: 0.04,
    yaw_r: -0.03,
};

/// Returns a steady glide of the glider, at the elevator angle for this lift coefficient.
fn steady_glide(glider: &Glider, lift: f64) -> SteadyState<7, 6, 1> {
    let alpha = (lift - glider.cl_0) / glider.cl_alpha;
    let elevator = -glider.cm_alpha * alpha / glider.cm_elevator;
    equilibrium(glider)
        .moving([28.0, 0.0, 0.5, 0.0, 0.0, 0.0].into())
        .with_inputs([elevator].into())
        .coordinates(["flight.wy"])
        .speeds(["flight.vx", "flight.vz"])
        .find()
        .unwrap()
}

fn speed_and_descent_of_glide(glider: &Glider, found: &SteadyState<7, 6, 1>) -> (f64, f64) {
    let seen = Outputs::outputs(glider, 0.0, &found.q, &found.v, &SVector::zeros(), &found.u);
    (seen[0], seen[1])
}

#[test]
fn glider_follows_its_polar() {
    let Glider { g, mass, density, area, cd_0, cd_induced, .. } = GLIDER;
    let best = (cd_0 / cd_induced).sqrt();
    for lift in [0.5 * best, best, 1.3 * best] {
        let (speed, down) = speed_and_descent_of_glide(&GLIDER, &steady_glide(&GLIDER, lift));
        let drag = cd_0 + cd_induced * lift * lift;
        assert_relatively_close(down / speed, drag / lift.hypot(drag), 1e-9);
        assert_relatively_close(0.5 * density * speed * speed * area * lift.hypot(drag), mass * g, 1e-9);
    }
    let glide_angle_sine = |lift: f64| {
        speed_and_descent_of_glide(&GLIDER, &steady_glide(&GLIDER, lift)).1
            / speed_and_descent_of_glide(&GLIDER, &steady_glide(&GLIDER, lift)).0
    };
    let ratio = 1.0 / (2.0 * (cd_0 * cd_induced).sqrt());
    assert_relatively_close(glide_angle_sine(best).asin().tan(), 1.0 / ratio, 1e-9);
    assert!(
        glide_angle_sine(0.97 * best) > glide_angle_sine(best)
            && glide_angle_sine(1.03 * best) > glide_angle_sine(best)
    );
    let slowest = 3.0_f64.sqrt() * best;
    let sink_rate_at_lift = |lift| speed_and_descent_of_glide(&GLIDER, &steady_glide(&GLIDER, lift)).1;
    assert!(
        sink_rate_at_lift(0.97 * slowest) > sink_rate_at_lift(slowest)
            && sink_rate_at_lift(1.03 * slowest) > sink_rate_at_lift(slowest)
    );
}

fn compute_glider_flight_modes(glider: &Glider, lift: f64) -> FlightModes {
    let found = steady_glide(glider, lift);
    FlightModes::from_system(&flight::linear_system(glider, &found.q, &found.v, &found.u).unwrap()).unwrap()
}

/// Checks period and damping of a glider's phugoid. With a constant angle of attack, `V̇ = −k_D V² − g sin γ`
/// and `V γ̇ = k_L V² − g cos γ`. About the glide at `tan γ = −C_D / C_L` the trace is
/// `−3 (g / V) C_D / C_L`, a third of which is due to the slope of the path.
#[test]
fn glider_phugoid_has_closed_form_period_and_damping() {
    let (lift, firm) = (0.8, Glider { cm_alpha: -1000.0, ..GLIDER });
    let speed = speed_and_descent_of_glide(&firm, &steady_glide(&firm, lift)).0;
    let found = compute_glider_flight_modes(&firm, lift);
    let phugoid = found.phugoid.unwrap();
    assert_relatively_close(2.0 * PI / phugoid.frequency(), SQRT_2 * PI * speed / firm.g, 0.01);
    let ratio = lift / (firm.cd_0 + firm.cd_induced * lift * lift);
    assert_relatively_close(phugoid.damping_ratio(), 3.0 / (2.0 * SQRT_2 * ratio), 0.01);
    // Distance of the neutral point behind the centre of mass, in chords; pitch is much faster.
    let derivatives = {
        let SteadyState { q, v, u, .. } = steady_glide(&GLIDER, lift);
        Derivatives::at_state(&GLIDER, &q, &v, &u).unwrap().in_stability_axes()
    };
    let drag = GLIDER.cd_0 + GLIDER.cd_induced * lift * lift;
    assert_relatively_close(
        derivatives.static_margin(GLIDER.chord).unwrap(),
        -GLIDER.cm_alpha / (GLIDER.cl_alpha + drag),
        1e-3,
    );
    assert!(found.short_period.unwrap().frequency() > 20.0 * phugoid.frequency());
}

/// Checks the stability of the spiral mode, which the constant term of the characteristic polynomial
/// determines (Etkin and Reid, § 6.8).
#[test]
fn dihedral_stabilises_the_spiral() {
    let boundary = GLIDER.yaw_beta * GLIDER.roll_r / GLIDER.yaw_r;
    for (part, stable) in [(0.7, false), (1.3, true)] {
        let spiral = compute_glider_flight_modes(&Glider { roll_beta: part * boundary, ..GLIDER }, 0.5)
            .spiral
            .unwrap();
        assert_eq!(spiral.exponent.re < 0.0, stable, "{spiral}");
    }
}

const QUADROTOR: Quadrotor = Quadrotor {
    g: 9.81,
    mass: 0.8,
    ixx: 6e-3,
    iyy: 7e-3,
    izz: 11e-3,
    arm: 0.2,
    thrust: 9e-6,
    drag: 1.5e-7,
    lag: 0.04,
    front_speed: 0.0,
    left_speed: 0.0,
    back_speed: 0.0,
    right_speed: 0.0,
};

#[test]
fn quadrotor_hovers_and_responds() {
    let Quadrotor { g, mass, ixx, izz, arm, thrust, drag, lag, .. } = QUADROTOR;
    let whole = QUADROTOR.extended();
    let mut v = SVector::<f64, 10>::zeros();
    v.fixed_rows_mut::<4>(6).fill(400.0);
    let found = equilibrium(&whole)
        .moving(v)
        .with_inputs([400.0; 4].into())
        .speeds(["front_speed", "left_speed", "back_speed", "right_speed"])
        .inputs(["front", "left", "back", "right"])
        .nearest()
        .find()
        .unwrap();
    let hover = (mass * g / (4.0 * thrust)).sqrt();
    found
        .u
        .iter()
        .chain(found.v.rows(6, 4).iter())
        .for_each(|speed| assert_relatively_close(*speed, hover, 1e-9));

    let system = measured_system(&at(&whole, 0.0), 0.0, &found.q, &found.v, &found.u).unwrap();
    let (across, up, roll, yaw) = (1, 2, 3, 5);
    for omega in [0.3, 5.0, 80.0] {
        let s = Complex::new(0.0, omega);
        let answer = system.at(s).unwrap();
        let late = (s * lag + 1.0).inv();
        let all = [0, 1, 2, 3].map(|rotor| answer[(up, rotor)]).iter().sum::<Complex<f64>>();
        let rolls = late / s * (2.0 * arm * thrust * hover / ixx);
        let expected = [
            (all, late / (s * s) * (8.0 * thrust * hover / mass)),
            (answer[(roll, 1)], rolls),
            (answer[(yaw, 0)], late / s * (2.0 * drag * hover / izz)),
            (answer[(across, 1)], rolls / (s * s * s) * -g),
        ];
        for (found, expected) in expected {
            assert!(
                (found - expected).norm() <= 1e-9 * expected.norm(),
                "expected {expected}, found {found}"
            );
        }
    }
}

const SATELLITE: WheeledSatellite =
    WheeledSatellite { mass: 80.0, ixx: 9.0, iyy: 6.0, izz: 12.0, wheel_mass: 2.0, wheel: 0.03 };

fn neutral_state_at_rest() -> (SVector<f64, 7>, SVector<f64, 6>) {
    ([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0].into(), SVector::zeros())
}

#[test]
fn reaction_wheels_rotate_the_satellite() {
    let (q, v) = neutral_state_at_rest();
    // Rest-to-rest manoeuvre: acceleration in one direction, then in the opposite one.
    let simulate_wheel_torques = |torques: [f64; 3], q, v, duration: f64| {
        let path = simulate(&SATELLITE)
            .from(q, v)
            .inputs(|_, _, _| torques.into())
            .duration(duration)
            .method(DormandPrince8::new().tolerance(1e-12, 1e-12))
            .finish()
            .unwrap();
        (path.q, path.v)
    };
    let (q, v) = simulate_wheel_torques([0.1, 0.0, 0.0], q, v, 20.0);
    let (q, v) = simulate_wheel_torques([-0.1, 0.0, 0.0], q, v, 20.0);
    assert!(v.norm() < 1e-8, "{v}");
    let hull = 2.0 * q[0].atan2(q[3]);
    assert_relatively_close(hull, -SATELLITE.wheel / (SATELLITE.ixx + 2.0 * SATELLITE.wheel) * q[4], 1e-8);

    // With all wheels at once, and while tumbling, the angular momentum is constant.
    let v = SVector::from([0.1, -0.2, 0.15, 80.0, -50.0, 20.0]);
    let outputs_of_state =
        |q: &_, v: &_| Outputs::outputs(&SATELLITE, 0.0, q, v, &SVector::zeros(), &SVector::zeros());
    let (later, faster) = simulate_wheel_torques([0.05, 0.1, -0.02], q, v, 15.0);
    let (before, after) = (outputs_of_state(&q, &v), outputs_of_state(&later, &faster));
    assert!((before - after).norm() < 1e-7 * before.norm(), "{before} {after}");
    assert!((faster - v).norm() > 10.0);
}

#[test]
fn satellite_with_spinning_wheel_nutates() {
    let (q, mut v) = neutral_state_at_rest();
    v[4] = 300.0;
    let momentum = SATELLITE.wheel * v[4];
    let system = linear_system(&SATELLITE, &q, &v, &SVector::zeros()).unwrap();
    let across = [SATELLITE.ixx, SATELLITE.izz].map(|hull| hull + SATELLITE.wheel);
    let nutation = momentum / (across[0] * across[1]).sqrt();
    let found: Vec<_> = system.modes().unwrap().into_iter().filter(|mode| mode.exponent.im > 1e-3).collect();
    assert_eq!(found.len(), 1);
    assert_mode_eigenvalue(found.first(), 0.0, nutation, 1e-10);
}

/// Checks a satellite that rotates at `ν` about the axis of its intermediate moment of inertia and tumbles. A
/// wheel with the momentum `h` along that axis stabilises it if `(h + (I₁ − I₂) ν) (h + (I₁ − I₃) ν) > 0`,
/// which divided by `I₂ I₃` is the square of its nutation frequency (Hughes, § 6.3).
#[test]
fn wheel_stabilises_intermediate_axis() {
    let (q, _) = neutral_state_at_rest();
    let wheel = SATELLITE.wheel;
    let [i2, i3] = [SATELLITE.iyy, SATELLITE.izz].map(|hull| hull + wheel);
    let (i1, rate) = (SATELLITE.ixx + 2.0 * wheel, 0.2);
    let mut verdicts = [0, 0];
    for spin in [0.0, -60.0, -10.0, 10.0, 40.0, 300.0] {
        let v = [rate, 0.0, 0.0, spin, 0.0, 0.0].into();
        let momentum = wheel * spin;
        let square = (momentum + (i1 - i2) * rate) * (momentum + (i1 - i3) * rate) / (i2 * i3);
        let system = linear_system(&SATELLITE, &q, &v, &SVector::zeros()).unwrap();
        let expected = Complex::new(square, 0.0).sqrt();
        let poles = system.poles().unwrap();
        for root in [expected * Complex::i(), -expected * Complex::i()] {
            let nearest = poles.iter().map(|pole| (pole - root).norm()).fold(f64::MAX, f64::min);
            assert!(nearest < 1e-9, "{spin}: {root} among {poles:?}");
        }
        let grows = system.of_states(&["attitude.wy'", "attitude.wz'"]).unwrap();
        let growing = grows.poles().unwrap().iter().any(|pole| pole.re > 1e-9);
        assert_eq!(growing, square < 0.0, "{spin}");
        verdicts[usize::from(growing)] += 1;
    }
    assert!(verdicts.iter().all(|count| *count > 1), "{verdicts:?}");
}

const CRAFT: HypersonicGlider = HypersonicGlider {
    mu: 3.986_004_418e14,
    turning: 7.292_115e-5,
    radius: 6.371e6,
    density: 1.225,
    scale: 7200.0,
    mass: 5000.0,
    ixx: 4e3,
    iyy: 2e4,
    izz: 2.2e4,
    drag_area: 1.2,
};

/// Returns the pose at a position over the Earth with local axes of the craft: forward, right, down.
fn pose_above_earth(place: Vector3<f64>, forward: Vector3<f64>) -> (SVector<f64, 7>, UnitQuaternion<f64>) {
    let down = -place.normalize();
    let axes = linkwork::nalgebra::Matrix3::from_columns(&[forward, down.cross(&forward), down]);
    let turn = UnitQuaternion::from_matrix(&axes);
    let c = turn.coords;
    ([place.x, place.y, place.z, c.x, c.y, c.z, c.w].into(), turn)
}

/// Returns the rate of the velocity relative to the Earth, in axes of the Earth.
fn acceleration_in_earth_axes(t: f64, q: &SVector<f64, 7>, v: &SVector<f64, 6>, u: [f64; 3]) -> Vector3<f64> {
    let tau = Mechanism::generalized_forces(&CRAFT, t, q, v, &u.into());
    let rates = Mechanism::forward_dynamics(&CRAFT, t, q, v, &tau);
    let (linear, angular) = (v.fixed_rows::<3>(0).into_owned(), v.fixed_rows::<3>(3).into_owned());
    let turn = UnitQuaternion::new_normalize(Quaternion::new(q[6], q[3], q[4], q[5]));
    turn * (rates.fixed_rows::<3>(0) + angular.cross(&linear))
}

#[test]
fn eastward_flight_needs_less_lift() {
    let r = CRAFT.radius + 40e3;
    let place = Vector3::new(r, 0.0, 0.0);
    for (speed, sign) in [(2000.0, 1.0), (2000.0, -1.0), (5000.0, 1.0), (5000.0, -1.0)] {
        let (q, _) = pose_above_earth(place, Vector3::new(0.0, sign, 0.0));
        let v = [speed, 0.0, 0.0, 0.0, -speed / r, 0.0].into();
        let inertial: f64 = sign * speed + CRAFT.turning * r;
        let lift = CRAFT.mass * (CRAFT.mu / (r * r) - inertial * inertial / r);
        let drag = 0.5 * CRAFT.density * (-40e3 / CRAFT.scale).exp() * CRAFT.drag_area * speed * speed;
        // Level and steady, with thrust equal to drag: the only acceleration is towards the centre.
        let found = acceleration_in_earth_axes(0.0, &q, &v, [lift, drag, 0.0]);
        let expected = Vector3::new(-speed * speed / r, 0.0, 0.0);
        assert!((found - expected).norm() < 1e-8 * CRAFT.mu / (r * r), "{found} {expected}");
    }
}

#[test]
fn gravity_and_inertial_forces_match_earth_model() {
    for (k, latitude) in [-1.2_f64, -0.4, 0.3, 0.9].into_iter().enumerate() {
        let k = k as f64;
        let (longitude, r) = (0.7 * k - 1.0, CRAFT.radius + 200e3 + 1e4 * k);
        let up =
            Vector3::new(latitude.cos() * longitude.cos(), latitude.cos() * longitude.sin(), latitude.sin());
        let east = Vector3::z().cross(&up).normalize();
        let forward = UnitQuaternion::from_scaled_axis(up * (0.5 + k)) * east;
        let (q, turn) = pose_above_earth(up * r, forward);
        let v = [3000.0 + 500.0 * k, 20.0, -40.0, 0.01, -0.02, 0.003].into();
        let found = acceleration_in_earth_axes(50.0 * k, &q, &v, [2e4, 0.0, 0.0]);
        let velocity = turn * v.fixed_rows::<3>(0);
        let spin = Vector3::z() * CRAFT.turning;
        let air = CRAFT.density * (-(r - CRAFT.radius) / CRAFT.scale).exp();
        let expected = -up * (CRAFT.mu / (r * r))
            - 2.0 * spin.cross(&velocity)
            - spin.cross(&spin.cross(&(up * r)))
            - velocity * (0.5 * air * CRAFT.drag_area * velocity.norm() / CRAFT.mass)
            + turn * Vector3::new(0.0, 0.0, -2e4 / CRAFT.mass);
        assert!((found - expected).norm() < 1e-9 * expected.norm(), "{found} {expected}");
    }
}

/// Checks that after a quarter of a polar orbit the Earth has rotated below the craft.
#[test]
fn polar_orbit_drifts_westward() {
    let craft = HypersonicGlider { density: 0.0, ..CRAFT };
    let r = CRAFT.radius + 300e3;
    let (q, _) = pose_above_earth(Vector3::new(r, 0.0, 0.0), Vector3::z());
    let (speed, rate) = ((CRAFT.mu / r).sqrt(), (CRAFT.mu / (r * r * r)).sqrt());
    // Relative to the Earth the craft moves west, to the left of its northward heading.
    let turning = CRAFT.turning;
    let v = [speed, -turning * r, 0.0, -turning, -rate, 0.0];
    let duration = FRAC_PI_2 / rate / 2.0;
    let path = simulate(&craft)
        .from(q, v)
        .duration(duration)
        .method(DormandPrince8::new().tolerance(1e-12, 1e-12))
        .finish()
        .unwrap();
    let (half, west) = (std::f64::consts::FRAC_PI_4, -turning * duration);
    let expected = Vector3::new(half.cos() * west.cos(), half.cos() * west.sin(), half.sin()) * r;
    assert!((path.q.fixed_rows::<3>(0) - expected).norm() < 1.0, "{} {expected}", path.q);
}
