//! Derivatives of the dynamics with respect to parameters, against finite differences of the same functions.

use linkwork::discrete::{self, StepByParameters};
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::prelude::{Rk4, SemiImplicitEuler};
use linkwork::{Derivatives, Sensitivities, mechanism};
use support::compare::assert_close_relative_to_largest;
use support::differences::derivative_at_zero;
use support::mechanisms::BeadOnRotatingHoop;
use support::random::Random;

/// Tolerance of derivatives against finite differences.
const TOLERANCE: f64 = 1e-7;

/// Arm whose lengths, masses, angles and elements are parameters.
#[mechanism(gravity = -g * z, sensitivities, prepare)]
#[derive(Clone, Copy)]
struct Arm {
    g: f64,
    m: f64,
    l: f64,
    tilt: f64,
    stiffness: f64,
    rest: f64,
    damping: f64,
    dry: f64,
    _spare: f64,
    #[body(mass = m, com = l / 2 * x + l / 9 * y, inertia = rod(m, l, x))]
    upper: Body,
    #[body(
        mass = m / 2, com = [l / 3, -l / 7, l / 11], inertia = cuboid(m / 2, l, l / 4, l / 5).rotated(z(tilt))
    )]
    lower: Body,
    #[particle(mass = m / 5, at = lower.at(l / 3 * x))]
    tool: Particle,
    #[joint(ground.rotated(x(tilt)) -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(l * x + l / 8 * y).rotated(y(tilt)) -> lower)]
    wrist: Ball,
    #[acts(on = shoulder, stiffness = stiffness, free_angle = rest)]
    spring: Spring,
    #[acts(between = (ground, tool), stiffness = stiffness / (l * l), free_length = l / 2)]
    rope: Spring,
    #[acts(on = shoulder, damping = damping)]
    dashpot: Dashpot,
    #[acts(on = shoulder, coulomb = dry, speed = 1)]
    friction: Friction,
}

/// Flying robot from a file, with a load and a spring.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, sensitivities)]
#[derive(Clone, Copy)]
struct Quadruped {
    load: f64,
    height: f64,
    stiffness: f64,
    #[particle(mass = load, at = base_link.at(height * z))]
    pack: Particle,
    #[acts(on = FL_KFE, stiffness = stiffness)]
    spring: Spring,
}

/// Returns the derivatives of `f` with respect to each parameter, by differences.
fn parameter_derivatives<M: Copy, const NV: usize, const NP: usize>(
    at: M,
    parameters: [fn(&mut M) -> &mut f64; NP],
    f: impl Fn(&M) -> SVector<f64, NV>,
) -> SMatrix<f64, NV, NP> {
    SMatrix::from_columns(&parameters.map(|parameter| {
        derivative_at_zero(5e-4, |s| {
            let mut other = at;
            *parameter(&mut other) += s;
            f(&other)
        })
    }))
}

#[test]
fn arm_sensitivities_agree_with_differences() {
    let arm = Arm {
        g: 9.7,
        m: 1.3,
        l: 0.6,
        tilt: 0.4,
        stiffness: 3.0,
        rest: 0.3,
        damping: 0.7,
        dry: 0.2,
        _spare: 1.0,
    };
    let names = ["g", "m", "l", "tilt", "stiffness", "rest", "damping", "dry", "_spare"];
    assert_eq!(Arm::PARAMETERS, names);
    let parameters: [fn(&mut Arm) -> &mut f64; 9] = [
        |arm| &mut arm.g,
        |arm| &mut arm.m,
        |arm| &mut arm.l,
        |arm| &mut arm.tilt,
        |arm| &mut arm.stiffness,
        |arm| &mut arm.rest,
        |arm| &mut arm.damping,
        |arm| &mut arm.dry,
        |arm| &mut arm._spare,
    ];
    let mut random = Random::new(31);
    for _ in 0..5 {
        let q = random.random_configuration(&arm);
        let [v, a, tau] = [random.random_vector(2.0), random.random_vector(2.0), random.random_vector(5.0)];
        let inverse = arm.inverse_dynamics_by_parameters(&q, &v, &a);
        let expected = parameter_derivatives(arm, parameters, |arm| arm.inverse_dynamics(&q, &v, &a));
        assert_close_relative_to_largest("∂τ/∂p", inverse.as_slice(), expected.as_slice(), TOLERANCE);
        let forward = arm.forward_dynamics_by_parameters(&q, &v, &tau);
        let expected = parameter_derivatives(arm, parameters, |arm| arm.forward_dynamics(&q, &v, &tau));
        assert_close_relative_to_largest("∂v̇/∂p", forward.as_slice(), expected.as_slice(), TOLERANCE);
        let prepared = arm.prepare();
        let again = prepared.inverse_dynamics_by_parameters(&q, &v, &a);
        assert_close_relative_to_largest("prepared ∂τ/∂p", again.as_slice(), inverse.as_slice(), 1e-12);
        let again = prepared.forward_dynamics_by_parameters(&q, &v, &tau);
        assert_close_relative_to_largest("prepared ∂v̇/∂p", again.as_slice(), forward.as_slice(), 1e-10);
    }
}

#[test]
fn loaded_robot_sensitivities_agree_with_differences() {
    let robot = Quadruped { load: 0.7, height: 0.1, stiffness: 2.0 };
    let parameters: [fn(&mut Quadruped) -> &mut f64; 3] =
        [|robot| &mut robot.load, |robot| &mut robot.height, |robot| &mut robot.stiffness];
    let mut random = Random::new(32);
    let q = random.random_configuration(&robot);
    let [v, a, tau] = [random.random_vector(2.0), random.random_vector(2.0), random.random_vector(5.0)];
    let inverse = robot.inverse_dynamics_by_parameters(&q, &v, &a);
    let expected = parameter_derivatives(robot, parameters, |robot| robot.inverse_dynamics(&q, &v, &a));
    assert_close_relative_to_largest("∂τ/∂p", inverse.as_slice(), expected.as_slice(), TOLERANCE);
    let forward = robot.forward_dynamics_by_parameters(&q, &v, &tau);
    let expected = parameter_derivatives(robot, parameters, |robot| robot.forward_dynamics(&q, &v, &tau));
    assert_close_relative_to_largest("∂v̇/∂p", forward.as_slice(), expected.as_slice(), TOLERANCE);
}

/// The hoop's bead satisfies `m r² θ̈ = m r (r Ω² cos θ − g) sin θ`, whose derivatives with respect to the
/// parameters are known.
#[test]
fn driven_hoop_sensitivities_have_closed_forms() {
    let hoop = BeadOnRotatingHoop { g: 9.81, m: 0.1, radius: 0.3, spin: 8.0 };
    let (q, v, tau) = ([0.5].into(), [2.0].into(), [0.02].into());
    let (sin, cos) = 0.5_f64.sin_cos();
    let by = hoop.forward_dynamics_by_parameters(0.7, &q, &v, &tau);
    let (m, r) = (hoop.m, hoop.radius);
    let expected = [
        -sin / r,
        -0.02 / (m * m * r * r),
        hoop.g * sin / (r * r) - 2.0 * 0.02 / (m * r * r * r),
        2.0 * hoop.spin * sin * cos,
    ];
    assert_close_relative_to_largest("∂v̇/∂p", by.as_slice(), &expected, 1e-12);
}

/// Flying body with a pendulum and a force at the end of an arm whose length is a parameter.
#[mechanism(gravity = -g * z, derivatives, sensitivities)]
#[derive(Clone, Copy)]
struct Flyer {
    g: f64,
    m: f64,
    l: f64,
    #[body(mass = m, com = l / 9 * z, inertia = cuboid(m, l, 0.7 * l, 0.2 * l))]
    frame: Body,
    #[body(mass = m / 3, com = -l * z, inertia = cuboid(m / 3, l / 5, l / 4, l))]
    load: Body,
    #[joint(ground -> frame)]
    flight: Free,
    #[joint(frame.at(-l / 5 * z) -> load)]
    hook: Ball,
    #[acts(on = frame.at(l * x), along = frame.z)]
    rotor: Force,
}

/// Body on Cardan angles with a slider. The generalized speeds are the angular velocity in body axes, which
/// contains no parameter.
#[mechanism(gravity = -g * z, derivatives, sensitivities)]
#[derive(Clone, Copy)]
struct Gimbal {
    g: f64,
    m: f64,
    l: f64,
    #[body(mass = 0, inertia = 0)]
    first: Body,
    #[body(mass = 0, inertia = 0)]
    second: Body,
    #[body(mass = m, com = l / 2 * z, inertia = cuboid(m, l, 0.7 * l, 0.2 * l))]
    top: Body,
    #[joint(ground -> first, about = z)]
    psi: Pin,
    #[joint(first -> second, about = y)]
    theta: Pin,
    #[joint(second -> top, about = x)]
    phi: Pin,
    #[particle(mass = m / 5)]
    bead: Particle,
    #[joint(top.at(l / 9 * x) -> bead, along = z)]
    rail: Sleeve,
    #[acts(on = rail, stiffness = 40)]
    spring: Spring,
    #[acts(on = top.at(l * x), along = top.z)]
    push: Force,
    #[speed(dot(omega(top / ground), top.x))]
    wx: Speed,
    #[speed(dot(omega(top / ground), top.y))]
    wy: Speed,
    #[speed(dot(omega(top / ground), top.z))]
    wz: Speed,
}

/// Compares the derivatives of a step with differences, as displacements of the end of the step.
fn check_step_parameter_derivatives<
    M,
    S,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NP: usize,
>(
    what: &str,
    m: M,
    method: &S,
    parameters: [fn(&mut M) -> &mut f64; NP],
) where
    M: Derivatives<NQ, NV, NU, Scalar = f64> + Sensitivities<NQ, NV, NU, NP, Scalar = f64> + Copy,
    S: StepByParameters<f64>,
{
    let mut random = Random::new(37);
    for _ in 0..3 {
        let q = m.integrate(&m.neutral(), &random.random_vector(1.0));
        let (v, u, t) = (random.random_vector(1.5), random.random_vector(4.0), random.uniform_number(1.0));
        let step_mechanism = |m: &M| discrete::step(m, method, t, &q, &v, &u).expect("it moves");
        let end = step_mechanism(&m);
        let (by_q, by_v) = discrete::by_parameters(&m, method, t, &q, &v, &u).expect("it moves");
        let expected =
            parameter_derivatives(m, parameters, |other| m.difference(&end.0, &step_mechanism(other).0));
        assert_close_relative_to_largest(
            &format!("{what}: ∂q/∂p"),
            by_q.as_slice(),
            expected.as_slice(),
            TOLERANCE,
        );
        let expected = parameter_derivatives(m, parameters, |other| step_mechanism(other).1);
        assert_close_relative_to_largest(
            &format!("{what}: ∂v/∂p"),
            by_v.as_slice(),
            expected.as_slice(),
            TOLERANCE,
        );
    }
}

#[test]
fn step_sensitivities_agree_with_differences() {
    let flyer = Flyer { g: 9.7, m: 1.3, l: 0.6 };
    let of_flyer: [fn(&mut Flyer) -> &mut f64; 3] = [|m| &mut m.g, |m| &mut m.m, |m| &mut m.l];
    assert_eq!(<Flyer as Sensitivities<_, _, _, _>>::PARAMETERS, Flyer::PARAMETERS);
    check_step_parameter_derivatives("flyer, Rk4", flyer, &Rk4::step(0.1), of_flyer);
    check_step_parameter_derivatives("flyer, Euler", flyer, &SemiImplicitEuler::step(0.1), of_flyer);
    let hoop = BeadOnRotatingHoop { g: 9.7, m: 0.4, radius: 0.3, spin: 5.0 };
    let of_hoop: [fn(&mut BeadOnRotatingHoop) -> &mut f64; 4] =
        [|m| &mut m.g, |m| &mut m.m, |m| &mut m.radius, |m| &mut m.spin];
    check_step_parameter_derivatives("hoop, Rk4", hoop, &Rk4::step(0.05), of_hoop);
    let gimbal = Gimbal { g: 9.7, m: 1.3, l: 0.6 };
    let of_gimbal: [fn(&mut Gimbal) -> &mut f64; 3] = [|m| &mut m.g, |m| &mut m.m, |m| &mut m.l];
    check_step_parameter_derivatives("gimbal, Rk4", gimbal, &Rk4::step(0.02), of_gimbal);
    check_step_parameter_derivatives("gimbal, Euler", gimbal, &SemiImplicitEuler::step(0.02), of_gimbal);
}

#[test]
fn invalid_period_is_an_error() {
    let hoop = BeadOnRotatingHoop { g: 9.7, m: 0.4, radius: 0.3, spin: 5.0 };
    for period in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let found =
            discrete::by_parameters(&hoop, &Rk4::step(period), 0.0, &[0.1].into(), &[0.0].into(), &[].into());
        assert!(found.is_err(), "{period}: {found:?}");
    }
}
