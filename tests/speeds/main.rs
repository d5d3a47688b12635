//! Mechanisms with declared generalized speeds against the same mechanisms in joint velocities.

use linkwork::discrete;
use linkwork::frame;
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::prelude::*;
use support::compare::{assert_close, assert_close_relative_to_largest};
use support::differences;
use support::mechanisms::SatelliteInSpeeds;
use support::random::Random;
use support::simulate::state_after_duration;
use support::with_common_fields;

mod contacts;
mod singular;

/// Tolerance of derivatives against finite differences.
const DIFFERENCE: f64 = 1e-8;

with_common_fields! {
    {
        axial: f64,
        #[body(mass = 0, inertia = 0)]
        first: Body,
        #[body(mass = 0, inertia = 0)]
        second: Body,
        #[body(mass = 2, com = 0.3 * z, inertia = diagonal(0.2, 0.3, axial))]
        top: Body,
        #[joint(ground -> first, about = z)]
        psi: Pin,
        #[joint(first -> second, about = x)]
        theta: Pin,
        #[joint(second -> top, about = z)]
        phi: Pin,
        #[acts(on = theta, stiffness = 0.4, free_angle = 1)]
        spring: Spring,
        #[acts(on = phi)]
        motor: Torque,
    }

    /// Rigid body about a fixed point, with Euler angles as coordinates.
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct EulerAngleBody {}

    /// Rigid body about a fixed point. The generalized speeds are the components of its angular velocity in
    /// body axes.
    #[mechanism(gravity = -9.81 * z, derivatives, prepare, batch)]
    struct EulerAngleBodyInSpeeds {
        #[speed(rate(psi) * sin(theta) * sin(phi) + rate(theta) * cos(phi))]
        wx: Speed,
        #[speed(dot(omega(top / ground), top.y))]
        wy: Speed,
        #[speed(rate(psi) * cos(theta) + rate(phi))]
        wz: Speed,
        #[output(wz)]
        spin: Scalar,
    }
}

with_common_fields! {
    {
        #[body(mass = 0, inertia = 0)]
        upright: Body,
        #[body(mass = 0, inertia = 0)]
        turned: Body,
        #[body(mass = 0, inertia = 0)]
        leaning: Body,
        #[body(mass = 3, inertia = disk(3, 0.4, y))]
        disk: Body,
        #[joint(ground -> upright, along = (x, y, z))]
        place: Stage,
        #[joint(upright -> turned, about = z)]
        heading: Pin,
        #[joint(turned -> leaning, about = x)]
        lean: Pin,
        #[joint(leaning -> disk, about = y)]
        roll: Pin,
        #[constraint(rolls(disk.circle(0.4, y), ground.plane(z)))]
        contact: Rolling,
    }

    /// Disk that rolls on a table, in joint velocities.
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct Disk {}

    /// Rolling disk whose generalized speeds are the components of its angular velocity in the leaning axes
    /// (Kane and Levinson 1985, ch. 4).
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct DiskInSpeeds {
        #[speed(dot(omega(disk / ground), leaning.x))]
        u1: Speed,
        #[speed(dot(omega(disk / ground), leaning.y))]
        u2: Speed,
        #[speed(dot(omega(disk / ground), leaning.z))]
        u3: Speed,
    }
}

/// Returns the derivatives of `f` along each entry of its argument, a column for each.
fn derivative_columns<const R: usize, const C: usize>(
    f: impl Fn(SVector<f64, C>) -> SVector<f64, R>,
) -> SMatrix<f64, R, C> {
    differences::derivative_columns([5e-4; C], f)
}

/// Checks the operations of the configuration space in generalized speeds: inverses, rates, and all
/// derivatives.
fn check_configuration_space<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
) where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    let mut random = Random::new(3);
    for _ in 0..3 {
        let (dv, v): (SVector<f64, NV>, SVector<f64, NV>) =
            (random.random_vector(0.3), random.random_vector(1.0));
        let there = m.integrate(q, &dv);
        assert_close("difference", m.difference(q, &there).as_slice(), dv.as_slice(), 1e-12);
        // A displacement that changes at this rate has an end that moves with `v`.
        let rate = m.displacement_rate(q, &dv, &v);
        let back =
            derivative_columns::<NV, 1>(|e| m.difference(&there, &m.integrate(q, &(dv + rate * e[0]))));
        assert_close("displacement rate", back.as_slice(), v.as_slice(), DIFFERENCE);
        let (by_q, by_dv) = m.integrate_derivatives_at(q, &dv);
        let displacement_between =
            |q: &SVector<f64, NQ>, dv: &SVector<f64, NV>| m.difference(&there, &m.integrate(q, dv));
        assert_close_relative_to_largest(
            "∂(q ⊕ dv)/∂q",
            by_q.as_slice(),
            derivative_columns(|e| displacement_between(&m.integrate(q, &e), &dv)).as_slice(),
            DIFFERENCE,
        );
        assert_close_relative_to_largest(
            "∂(q ⊕ dv)/∂dv",
            by_dv.as_slice(),
            derivative_columns(|e| displacement_between(q, &(dv + e))).as_slice(),
            DIFFERENCE,
        );
        let (by_q, by_dv, by_v) = m.displacement_rate_derivatives(q, &dv, &v);
        let perturbed_rate =
            |e: [SVector<f64, NV>; 3]| m.displacement_rate(&m.integrate(q, &e[0]), &(dv + e[1]), &(v + e[2]));
        let o = SVector::zeros();
        assert_close_relative_to_largest(
            "∂/∂q",
            by_q.as_slice(),
            derivative_columns(|e| perturbed_rate([e, o, o])).as_slice(),
            DIFFERENCE,
        );
        assert_close_relative_to_largest(
            "∂/∂dv",
            by_dv.as_slice(),
            derivative_columns(|e| perturbed_rate([o, e, o])).as_slice(),
            DIFFERENCE,
        );
        assert_close_relative_to_largest(
            "∂/∂v",
            by_v.as_slice(),
            derivative_columns(|e| perturbed_rate([o, o, e])).as_slice(),
            DIFFERENCE,
        );
    }
}

/// Function that maps configuration and velocity before an integration step to those after it.
type StepMap<'a, const NQ: usize, const NV: usize> =
    &'a dyn Fn(&SVector<f64, NQ>, &SVector<f64, NV>) -> (SVector<f64, NQ>, SVector<f64, NV>);

/// Checks the Jacobians of a step against differences of the step, in displacements and generalized speeds.
fn check_step_jacobians<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
) where
    M: Derivatives<NQ, NV, NU, Scalar = f64> + linkwork::Scleronomic,
{
    let u: SVector<f64, NU> = Random::new(9).random_vector(1.0);
    let step_derivatives = |method: StepMap<'_, NQ, NV>| {
        let there = method(q, v);
        let by_q = derivative_columns(|e| m.difference(&there.0, &method(&m.integrate(q, &e), v).0));
        let by_v = derivative_columns(|e| m.difference(&there.0, &method(q, &(v + e)).0));
        let faster = derivative_columns(|e| method(&m.integrate(q, &e), v).1);
        [by_q, by_v, faster]
    };
    let (rk4, euler) = (Rk4::step(0.05), SemiImplicitEuler::step(0.05));
    let found = [
        (
            discrete::transition(m, &rk4, 0.0, q, v, &u).unwrap(),
            step_derivatives(&|q, v| discrete::step(m, &rk4, 0.0, q, v, &u).unwrap()),
        ),
        (
            discrete::transition(m, &euler, 0.0, q, v, &u).unwrap(),
            step_derivatives(&|q, v| discrete::step(m, &euler, 0.0, q, v, &u).unwrap()),
        ),
    ];
    for (found, [by_q, by_v, faster]) in found {
        assert_close_relative_to_largest("q by q", found.q_by_q.as_slice(), by_q.as_slice(), DIFFERENCE);
        assert_close_relative_to_largest("q by v", found.q_by_v.as_slice(), by_v.as_slice(), DIFFERENCE);
        assert_close_relative_to_largest("v by q", found.v_by_q.as_slice(), faster.as_slice(), DIFFERENCE);
    }
    // Displacement φ between two neighbouring motions with the same generalized speeds: φ(h) = (1 + h T) φ +
    // O(h²).
    let (h, turning) = (1e-5, m.linear_motion(q, v, &u).turning);
    let configuration_after =
        |q: &SVector<f64, NQ>| discrete::step(m, &Rk4::step(h), 0.0, q, v, &u).unwrap().0;
    let grown = derivative_columns(|e| {
        m.difference(&configuration_after(q), &configuration_after(&m.integrate(q, &e)))
    });
    let rate = (grown - SMatrix::<f64, NV, NV>::identity()) / h;
    assert_close_relative_to_largest("turning", turning.as_slice(), rate.as_slice(), 1e-4);
}

fn sample_body_in_speeds() -> EulerAngleBodyInSpeeds {
    EulerAngleBodyInSpeeds { axial: 0.45 }
}

fn euler_angle_start_state() -> (SVector<f64, 3>, SVector<f64, 3>) {
    ([0.3, 0.9, -0.4].into(), [0.5, -0.7, 6.0].into())
}

#[test]
fn configuration_space_is_independent_of_speeds() {
    let (q, v) = euler_angle_start_state();
    check_configuration_space(&sample_body_in_speeds(), &q);
    check_step_jacobians(&sample_body_in_speeds(), &q, &(v * 0.3));
    let q = Random::new(5).random_configuration(&SatelliteInSpeeds {});
    check_configuration_space(&SatelliteInSpeeds {}, &q);
    check_step_jacobians(&SatelliteInSpeeds {}, &q, &Random::new(6).random_vector(0.8));
}

#[test]
fn speeds_have_names_and_conversions() {
    assert_eq!(EulerAngleBodyInSpeeds::VELOCITIES, ["wx", "wy", "wz"]);
    assert_eq!(SatelliteInSpeeds::VELOCITIES, ["ux", "uy", "uz", "wx", "wy", "wz", "hinge"]);
    assert_eq!(EulerAngleBodyInSpeeds::CONFIGURATION, ["psi", "theta", "phi"]);
    let (q, rates) = euler_angle_start_state();
    let m = sample_body_in_speeds();
    let u = m.speeds_of_rates(&q, &rates);
    assert_close("rates", m.rates_of_speeds(&q, &u).as_slice(), rates.as_slice(), 1e-14);
    // Mass matrix of the body about its fixed point, in body axes.
    let fixed = 2.0 * 0.3 * 0.3;
    let expected = SMatrix::<f64, 3, 3>::from_diagonal(&[0.2 + fixed, 0.3 + fixed, 0.45].into());
    assert_close("mass matrix", m.mass_matrix(&q).as_slice(), expected.as_slice(), 1e-14);
    assert_close("output", &[m.spin(&q, &u)], &[u[2]], 1e-14);
    assert!(Mechanism::tangent_rate(&m, &u, &u).iter().all(|x| x.is_nan()));
}

#[test]
fn frame_velocities_are_equal_in_speeds() {
    let (q, rates) = euler_angle_start_state();
    let (plain, m) = (EulerAngleBody { axial: 0.45 }, sample_body_in_speeds());
    let u = m.speeds_of_rates(&q, &rates);
    let (twist, expected) = (
        m.frame_velocity(frame!(EulerAngleBodyInSpeeds, "top"), &q, &u),
        plain.frame_velocity(frame!(EulerAngleBody, "top"), &q, &rates),
    );
    assert_close("velocity", twist.as_slice(), expected.as_slice(), 1e-13);
    let jacobian = m.frame_jacobian(frame!(EulerAngleBodyInSpeeds, "top"), &q);
    assert_close("Jacobian", (jacobian * u).as_slice(), expected.as_slice(), 1e-13);
    let tau: SVector<f64, 3> = [0.2, -0.3, 0.5].into();
    let (a, du) = (
        plain.forward_dynamics(&q, &rates, &SVector::zeros()),
        m.forward_dynamics(&q, &u, &SVector::zeros()),
    );
    let found = m.frame_acceleration(frame!(EulerAngleBodyInSpeeds, "top"), &q, &u, &du);
    assert_close(
        "acceleration",
        found.as_slice(),
        plain.frame_acceleration(frame!(EulerAngleBody, "top"), &q, &rates, &a).as_slice(),
        1e-11,
    );
    let prepared = m.prepare();
    assert_close(
        "prepared",
        prepared.forward_dynamics(&q, &u, &tau).as_slice(),
        m.forward_dynamics(&q, &u, &tau).as_slice(),
        1e-13,
    );
    assert_close("prepared", prepared.integrate(&q, &u).as_slice(), m.integrate(&q, &u).as_slice(), 1e-14);
}

/// Returns the end of a run in generalized speeds, transformed to joint velocities.
fn end_state_transformed_to_velocities<S: linkwork::integrate::Method<f64>>(
    method: S,
) -> (SVector<f64, 3>, SVector<f64, 3>) {
    let (q, rates) = euler_angle_start_state();
    let m = sample_body_in_speeds();
    let run = simulate(&m).from(q, m.speeds_of_rates(&q, &rates)).duration(0.5).method(method);
    let end = run.finish().expect("it arrives");
    (end.q, m.rates_of_speeds(&end.q, &end.v))
}

/// Halving the step divides the errors by 16 for order four, and by 4 for order two.
#[test]
fn integrators_in_speeds_have_their_orders() {
    let (q, rates) = euler_angle_start_state();
    let exact = state_after_duration(&EulerAngleBody { axial: 0.45 }, &q, &rates, 0.5);
    let error_of_end =
        |(q, v): (SVector<f64, 3>, SVector<f64, 3>)| (q - exact.0).norm() + (v - exact.1).norm();
    let order_of_errors = |coarse: f64, fine: f64| (coarse / fine).log2();
    let rk4 = order_of_errors(
        error_of_end(end_state_transformed_to_velocities(Rk4::step(0.01))),
        error_of_end(end_state_transformed_to_velocities(Rk4::step(0.005))),
    );
    assert!((3.8..4.3).contains(&rk4), "{rk4}");
    let midpoint = order_of_errors(
        error_of_end(end_state_transformed_to_velocities(ImplicitMidpoint::step(0.01))),
        error_of_end(end_state_transformed_to_velocities(ImplicitMidpoint::step(0.005))),
    );
    assert!((1.9..2.1).contains(&midpoint), "{midpoint}");
    let rosenbrock = order_of_errors(
        error_of_end(end_state_transformed_to_velocities(Rosenbrock::step(0.002))),
        error_of_end(end_state_transformed_to_velocities(Rosenbrock::step(0.001))),
    );
    assert!((1.8..2.2).contains(&rosenbrock), "{rosenbrock}");
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let adaptive = error_of_end(end_state_transformed_to_velocities(
            DormandPrince::new().tolerance(tolerance, tolerance),
        ));
        assert!(adaptive < 300.0 * tolerance, "{adaptive} with {tolerance}");
        let stiff = error_of_end(end_state_transformed_to_velocities(
            Rodas::new().tolerance(tolerance.max(1e-9), tolerance.max(1e-9)),
        ));
        assert!(stiff < 1000.0 * tolerance.max(1e-9), "{stiff} with {tolerance}");
    }
}

#[test]
fn batches_in_speeds_equal_single_states() {
    use linkwork::__private::{lane, lane_by_lane};
    let m = sample_body_in_speeds();
    let (q, rates) = euler_angle_start_state();
    let u = m.speeds_of_rates(&q, &rates);
    let speeds_times_lane_number = |k: usize| u * (1.0 + k as f64);
    let q_lanes = lane_by_lane::<f64, 4, 3, 1>(|_| q);
    let u_lanes = lane_by_lane::<f64, 4, 3, 1>(speeds_times_lane_number);
    let moved = m.integrate_lanes(&q_lanes, &u_lanes);
    let rate = m.displacement_rate_lanes(&q_lanes, &u_lanes, &u_lanes);
    for k in 0..4 {
        assert_close(
            "integrate",
            lane(&moved, k).as_slice(),
            m.integrate(&q, &speeds_times_lane_number(k)).as_slice(),
            1e-14,
        );
        let one = m.displacement_rate(&q, &speeds_times_lane_number(k), &speeds_times_lane_number(k));
        assert_close("rate", lane(&rate, k).as_slice(), one.as_slice(), 1e-13);
    }
}

#[test]
fn rolling_disk_moves_equally_in_kanes_speeds() {
    let (plain, m) = (Disk {}, DiskInSpeeds {});
    let q: SVector<f64, 6> = [0.1, -0.2, 0.4 * 0.3_f64.cos(), 0.5, 0.3, 0.2].into();
    let rates = plain.project_velocity(&q, &[0.3, -0.4, 0.5, 1.0, 0.6, 5.0].into()).expect("it is regular");
    let u = m.speeds_of_rates(&q, &rates);
    assert_close(
        "rates of constraints",
        m.constraint_rates(&q, &u).as_slice(),
        &[0.0; DiskInSpeeds::NC],
        1e-13,
    );
    let tau: SVector<f64, 6> = Random::new(2).random_vector(1.0);
    // Generalized forces in joint velocities with the same power: `Yᵀ τ`.
    let forces = SVector::<f64, 6>::from_fn(|k, _| tau.dot(&m.speeds_of_rates(&q, &SVector::ith(k, 1.0))));
    let expected = plain.forward_dynamics(&q, &rates, &forces);
    let du = m.forward_dynamics(&q, &u, &tau);
    let rates_later = |h: f64| {
        let there = m.integrate(&q, &(u * h));
        m.rates_of_speeds(&there, &(u + du * h))
    };
    let h = 1e-4;
    let found = (rates_later(h) - rates_later(-h)) / (2.0 * h);
    assert_close("accelerations", found.as_slice(), expected.as_slice(), 1e-5);
    let exact = state_after_duration(&plain, &q, &rates, 1.0);
    let run = simulate(&m).from(q, u).duration(1.0).method(DormandPrince::new().tolerance(1e-13, 1e-13));
    let end = run.finish().expect("it rolls");
    assert_close("configuration", end.q.as_slice(), exact.0.as_slice(), 1e-9);
    assert_close("rates", m.rates_of_speeds(&end.q, &end.v).as_slice(), exact.1.as_slice(), 1e-9);
    let total_energy = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
    assert_close("energy", &[total_energy(&end.q, &end.v)], &[total_energy(&q, &u)], 1e-9);
    // Derivatives under constraints, along displacements in generalized speeds.
    let (by_q, by_v, by_tau) = m.forward_dynamics_derivatives(&q, &u, &tau);
    let expected = derivative_columns(|e| m.forward_dynamics(&q, &(u + e), &tau));
    assert_close_relative_to_largest("∂u̇/∂u", by_v.as_slice(), expected.as_slice(), 1e-7);
    let expected = derivative_columns(|e| m.forward_dynamics(&m.integrate(&q, &e), &u, &tau));
    assert_close_relative_to_largest("∂u̇/∂q", by_q.as_slice(), expected.as_slice(), 1e-7);
    let expected = derivative_columns(|e| m.forward_dynamics(&q, &u, &(tau + e)));
    assert_close_relative_to_largest("∂u̇/∂τ", by_tau.as_slice(), expected.as_slice(), 1e-7);
}

/// Implicit steps under constraints have their order of convergence, and the energy does not drift.
#[test]
fn implicit_steps_in_speeds_keep_convergence_order() {
    let (plain, m) = (Disk {}, DiskInSpeeds {});
    let q: SVector<f64, 6> = [0.1, -0.2, 0.4 * 0.3_f64.cos(), 0.5, 0.3, 0.2].into();
    let rates = plain.project_velocity(&q, &[0.3, -0.4, 0.5, 1.0, 0.6, 5.0].into()).expect("it is regular");
    let u = m.speeds_of_rates(&q, &rates);
    let exact = state_after_duration(&plain, &q, &rates, 0.5);
    let error_of_end = |(q, v): (SVector<f64, 6>, SVector<f64, 6>)| {
        (q - exact.0).norm() + (m.rates_of_speeds(&q, &v) - exact.1).norm()
    };
    let end_of_midpoint = |h: f64, duration: f64| {
        let run = simulate(&m).from(q, u).duration(duration).method(ImplicitMidpoint::step(h));
        let end = run.finish().expect("it rolls");
        (end.q, end.v)
    };
    let order = (error_of_end(end_of_midpoint(0.01, 0.5)) / error_of_end(end_of_midpoint(0.005, 0.5))).log2();
    assert!((1.9..2.1).contains(&order), "{order}");
    let semi_implicit_euler_error = |h: f64| {
        let run = simulate(&m).from(q, u).duration(0.5).method(SemiImplicitEuler::step(h));
        let end = run.finish().expect("it rolls");
        error_of_end((end.q, end.v))
    };
    let order = (semi_implicit_euler_error(0.002) / semi_implicit_euler_error(0.001)).log2();
    assert!((0.9..1.1).contains(&order), "{order}");
    let total_energy = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
    let energy_change =
        |(at, v): (SVector<f64, 6>, SVector<f64, 6>)| (total_energy(&at, &v) - total_energy(&q, &u)).abs();
    let (early, late) =
        (energy_change(end_of_midpoint(0.01, 1.0)), energy_change(end_of_midpoint(0.01, 20.0)));
    assert!(late < 20.0 * early.max(1e-5), "{early:e} {late:e}");
}
