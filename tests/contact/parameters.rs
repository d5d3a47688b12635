//! Derivatives of steps with contacts with respect to parameters, against closed forms and differences of the
//! steps, and identification of parameters from a motion with impacts and friction.

use linkwork::nalgebra::SMatrix;
use linkwork::prelude::*;
use linkwork::{Derivatives, Sensitivities, discrete};

/// Access to a parameter of a mechanism.
type ParameterAccess<M> = fn(&mut M) -> &mut f64;

/// Ball above a floor. All of its values are parameters.
#[mechanism(gravity = -g * z, derivatives, sensitivities)]
#[derive(Clone, Copy)]
struct Ball {
    g: f64,
    m: f64,
    radius: f64,
    height: f64,
    friction: f64,
    restitution: f64,
    rolling: f64,
    #[body(mass = m, inertia = sphere(m, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(radius),
        ground.at(height * z).plane(z),
        friction = friction,
        rolling = rolling,
        restitution = restitution
    )]
    floor: Contact,
}

const BALL: Ball =
    Ball { g: 9.7, m: 0.6, radius: 0.1, height: 0.05, friction: 0.4, restitution: 0.0, rolling: 0.002 };
const OF_BALL: [ParameterAccess<Ball>; 7] = [
    |ball| &mut ball.g,
    |ball| &mut ball.m,
    |ball| &mut ball.radius,
    |ball| &mut ball.height,
    |ball| &mut ball.friction,
    |ball| &mut ball.restitution,
    |ball| &mut ball.rolling,
];

/// Block with a foot in the middle of its lower face, which slides without rotating.
#[mechanism(gravity = -9.81 * z, derivatives, sensitivities)]
#[derive(Clone, Copy)]
struct Block {
    friction: f64,
    m: f64,
    restitution: f64,
    #[body(mass = m)]
    block: Body,
    #[joint(ground -> block, along = (x, y, z))]
    place: Stage,
    #[acts(on = block, along = ground.x)]
    push: Force,
    #[contact(block, ground.plane(z), friction = friction, restitution = restitution)]
    foot: Contact,
}

const OF_BLOCK: [ParameterAccess<Block>; 3] =
    [|block| &mut block.friction, |block| &mut block.m, |block| &mut block.restitution];

/// Ball on a box with three feet.
#[mechanism(gravity = -9.81 * z, derivatives, sensitivities)]
#[derive(Clone, Copy)]
struct BallOnBox {
    m: f64,
    width: f64,
    low_friction: f64,
    high_friction: f64,
    radius: f64,
    #[body(mass = m, inertia = cuboid(m, width, 0.2, 0.1))]
    low: Body,
    #[joint(ground -> low)]
    pose: Free,
    #[body(mass = 1, inertia = sphere(1, radius))]
    top: Body,
    #[joint(ground -> top)]
    place: Free,
    #[acts(on = low, along = ground.x)]
    push: Force,
    #[contact(low.at(width / 2 * x - 0.05 * z), ground.plane(z), friction = low_friction)]
    front: Contact,
    #[contact(low.at(-width / 2 * x + 0.1 * y - 0.05 * z), ground.plane(z), friction = low_friction)]
    left: Contact,
    #[contact(low.at(-width / 2 * x - 0.1 * y - 0.05 * z), ground.plane(z), friction = low_friction)]
    right: Contact,
    #[contact(top.sphere(radius), low.cuboid(width, 0.2, 0.1), friction = high_friction)]
    shelf: Contact,
}

/// Leg of two links with a sprung knee, whose foot slips or sticks on a step.
#[mechanism(gravity = -9.81 * y, derivatives, sensitivities)]
#[derive(Clone, Copy)]
struct Leg {
    stiffness: f64,
    length: f64,
    friction: f64,
    height: f64,
    restitution: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.2, 0.2, 0.2))]
    trunk: Body,
    #[joint(ground -> trunk, about = z)]
    pose: Planar,
    #[body(mass = 0.4, com = -length / 2 * y, inertia = rod(0.4, length, y))]
    thigh: Body,
    #[joint(trunk -> thigh, about = z)]
    hip: Pin,
    #[body(mass = 0.2, com = -length / 2 * y, inertia = rod(0.2, length, y))]
    shank: Body,
    #[joint(thigh.at(-length * y) -> shank, about = z)]
    knee: Pin,
    #[acts(on = knee, stiffness = stiffness)]
    spring: Spring,
    #[acts(on = hip)]
    motor: Torque,
    #[contact(
        shank.at(-length * y).sphere(0.02),
        ground.at(height * y).plane(y),
        friction = friction,
        restitution = restitution
    )]
    foot: Contact,
}

/// Returns the methods with steps of `h` seconds.
fn stepping_methods(h: f64) -> [TimeStepping<f64>; 2] {
    [TimeStepping::step(h), TimeStepping::step(h).midpoint()]
}

/// Checks the derivatives of a step with respect to parameters against central differences of sixth order
/// over `3 h`, except for parameters that change a contact mode (`skipped`).
fn check_parameter_columns<M, const NQ: usize, const NV: usize, const NU: usize, const NP: usize>(
    what: &str,
    m: M,
    (method, parameters): (&TimeStepping<f64>, [ParameterAccess<M>; NP]),
    (q, v, u): (&SVector<f64, NQ>, &SVector<f64, NV>, &SVector<f64, NU>),
    (h, skipped): (f64, &[usize]),
) where
    M: Derivatives<NQ, NV, NU, Scalar = f64> + Sensitivities<NQ, NV, NU, NP, Scalar = f64> + Copy,
{
    let (by_q, by_v) = discrete::by_parameters(&m, method, 0.0, q, v, u).unwrap();
    let (end, _) = discrete::step(&m, method, 0.0, q, v, u).unwrap();
    for (k, parameter) in parameters.iter().enumerate().filter(|(k, _)| !skipped.contains(k)) {
        let step_end_at_parameter_change = |s: f64| {
            let mut other = m;
            *parameter(&mut other) += s;
            let (q, v) = discrete::step(&other, method, 0.0, q, v, u).unwrap();
            [m.difference(&end, &q), v]
        };
        let [one, two, three] = [1.0, 2.0, 3.0]
            .map(|n| (step_end_at_parameter_change(n * h), step_end_at_parameter_change(-n * h)));
        for (block, found) in [by_q.column(k), by_v.column(k)].into_iter().enumerate() {
            let difference_of_pair = |(after, before): &([SVector<f64, NV>; 2], [SVector<f64, NV>; 2])| {
                after[block] - before[block]
            };
            let expected = (difference_of_pair(&one) * 45.0 - difference_of_pair(&two) * 9.0
                + difference_of_pair(&three))
                / (60.0 * h);
            let off = (found - expected).amax();
            assert!(
                off < 2e-8 * (1.0 + expected.amax()),
                "{what}: parameter {k}, block {block}: {off:e} {expected} {found}"
            );
        }
    }
}

/// A step of a bouncing block ends with `−e v`, one of a sliding block with `v + h (F / m − μ g)`.
#[test]
fn contact_step_derivatives_by_parameters_have_closed_forms() {
    let h = 0.01;
    for method in stepping_methods(h) {
        let m = Block { friction: 0.3, m: 2.0, restitution: 0.0 };
        let parameter_derivatives = |m: &Block, v: [f64; 3]| {
            discrete::by_parameters(m, &method, 0.0, &SVector::zeros(), &v.into(), &[1.0].into()).unwrap()
        };
        let (by_q, by_v) = parameter_derivatives(&m, [1.0, 0.0, 0.0]);
        assert!((by_v[(0, 0)] + h * 9.81).abs() < 1e-14 && (by_v[(0, 1)] + h / 4.0).abs() < 1e-14);
        assert!((by_q[(0, 0)] + h * h * 9.81 / 2.0).abs() < 1e-14 && by_q.row(2).amax() < 1e-14);
        let (by_q, by_v) = parameter_derivatives(&m, [0.0; 3]);
        assert!(by_q.amax() + by_v.amax() < 1e-14, "a sticking block stays: {by_v}");
        for restitution in [0.0, 0.5] {
            let (_, by_v) =
                parameter_derivatives(&Block { friction: 0.0, restitution, ..m }, [0.3, 0.0, -2.0]);
            assert!((by_v[(2, 2)] - 2.0).abs() < 1e-14 && by_v[(2, 1)].abs() < 1e-14, "{by_v}");
            assert!((by_v[(0, 1)] + h / 4.0).abs() < 1e-14 && by_v[(0, 0)] == 0.0, "{by_v}");
        }
    }
}

#[test]
fn ball_step_derivatives_by_parameters_match_differences() {
    for method in stepping_methods(0.01) {
        let state_at_gap = |gap: f64| {
            let mut q = BALL.neutral();
            (q[0], q[2]) = (0.1, BALL.height + BALL.radius + gap);
            q
        };
        let check_ball_parameter_columns = |what: &str, m: Ball, gap: f64, v: [f64; 6], skipped: &[usize]| {
            let state = (&state_at_gap(gap), &v.into(), &SVector::zeros());
            check_parameter_columns(what, m, (&method, OF_BALL), state, (1e-5, skipped));
        };
        check_ball_parameter_columns("separated", BALL, 1.0, [1.0, 0.0, -2.0, 1.0, 2.0, 3.0], &[5]);
        check_ball_parameter_columns("lands and sticks", BALL, 0.005, [0.1, 0.3, -1.0, -3.0, 1.0, 0.3], &[5]);
        check_ball_parameter_columns(
            "lands and slides",
            BALL,
            0.005,
            [2.0, 0.3, -1.0, -20.0, 2.0, 0.3],
            &[5],
        );
        // Radius and height open or close the gap of a ball on the floor.
        check_ball_parameter_columns("slides", BALL, 0.0, [1.0, 0.2, 0.0, 0.0, 20.0, 0.3], &[2, 3, 5]);
        check_ball_parameter_columns("rolls", BALL, 0.0, [1.0, 0.0, 0.0, 0.0, 10.0, 0.3], &[2, 3, 5]);
        let elastic = Ball { restitution: 0.6, ..BALL };
        check_ball_parameter_columns(
            "bounces and sticks",
            elastic,
            0.005,
            [0.1, 0.3, -2.0, -3.0, 1.0, 0.3],
            &[],
        );
        check_ball_parameter_columns(
            "bounces and slides",
            elastic,
            0.005,
            [2.0, 0.3, -1.0, -20.0, 2.0, 0.3],
            &[],
        );
    }
}

#[test]
fn stack_step_derivatives_by_parameters_match_differences() {
    let m = BallOnBox { m: 2.0, width: 0.3, low_friction: 0.4, high_friction: 0.3, radius: 0.1 };
    let of_stack: [ParameterAccess<BallOnBox>; 5] = [
        |m| &mut m.m,
        |m| &mut m.width,
        |m| &mut m.low_friction,
        |m| &mut m.high_friction,
        |m| &mut m.radius,
    ];
    let (mut q, v) = (m.neutral(), SVector::<f64, 12>::zeros());
    (q[2], q[7], q[9]) = (0.05, 0.03, 0.2);
    for (method, push) in
        stepping_methods(0.01).into_iter().flat_map(|method| [(method, 2.0), (method, 20.0)])
    {
        let state = (&q, &v, &[push].into());
        check_parameter_columns(&format!("push {push}"), m, (&method, of_stack), state, (1e-6, &[4]));
        // The box lands on one foot.
        let high = m.integrate(&q, &[0.0, 0.0, 0.05, 0.1, 0.2, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0].into());
        let mut falling = SVector::<f64, 12>::zeros();
        (falling[0], falling[2]) = (0.5, -8.0);
        let state = (&high, &falling, &[push].into());
        check_parameter_columns("lands", m, (&method, of_stack), state, (1e-6, &[]));
    }
}

#[test]
fn leg_step_derivatives_by_parameters_match_differences() {
    let of_leg: [ParameterAccess<Leg>; 5] = [
        |m| &mut m.stiffness,
        |m| &mut m.length,
        |m| &mut m.friction,
        |m| &mut m.height,
        |m| &mut m.restitution,
    ];
    for (method, (friction, restitution)) in stepping_methods(0.01)
        .into_iter()
        .flat_map(|method| [(0.2, 0.0), (2.0, 0.0), (0.2, 0.5), (2.0, 0.5)].map(|laws| (method, laws)))
    {
        let m = Leg { stiffness: 30.0, length: 0.4, friction, height: 0.1, restitution };
        let mut q = m.neutral();
        (q[3], q[4]) = (0.5, -0.9);
        q[1] -= m.contact_gaps(&q)[0] - 0.005;
        let v = [0.6, -2.0, 0.1, 0.2, -0.3].into();
        let skipped: &[usize] = if restitution == 0.0 { &[4] } else { &[] };
        let what = format!("friction {friction}, restitution {restitution}");
        check_parameter_columns(&what, m, (&method, of_leg), (&q, &v, &[0.5].into()), (1e-6, skipped));
    }
}

/// Motion of `N` steps, with the derivatives of the configuration after each step with respect to the
/// parameters.
#[allow(clippy::type_complexity, reason = "configurations with derivatives")]
fn rollout_with_parameter_derivatives<M, const NV: usize, const NU: usize, const NP: usize>(
    m: &M,
    method: &TimeStepping<f64>,
    (mut q, mut v): (SVector<f64, NV>, SVector<f64, NV>),
    input: impl Fn(usize) -> SVector<f64, NU>,
    n: usize,
) -> Vec<(SVector<f64, NV>, SMatrix<f64, NV, NP>)>
where
    M: Derivatives<NV, NV, NU, Scalar = f64> + Sensitivities<NV, NV, NU, NP, Scalar = f64>,
{
    let (mut q_by, mut v_by) = (SMatrix::zeros(), SMatrix::zeros());
    let step_with_parameter_derivatives = |k: usize| {
        let u = input(k);
        let step = discrete::transition(m, method, 0.0, &q, &v, &u).unwrap();
        let direct = discrete::by_parameters(m, method, 0.0, &q, &v, &u).unwrap();
        (q_by, v_by) = (
            step.q_by_q * q_by + step.q_by_v * v_by + direct.0,
            step.v_by_q * q_by + step.v_by_v * v_by + direct.1,
        );
        (q, v) = (step.q, step.v);
        (q, q_by)
    };
    (0..n).map(step_with_parameter_derivatives).collect()
}

/// Force on the block in a step: pushes to and fro.
fn push_in_step(k: usize) -> SVector<f64, 1> {
    [12.0 * (0.11 * k as f64).sin()].into()
}

/// State of a block that falls obliquely.
fn start_of_block() -> (SVector<f64, 3>, SVector<f64, 3>) {
    ([0.0, 0.0, 0.03].into(), [1.5, 0.4, -0.5].into())
}

/// Gradients of a motion of a hundred steps in which a block bounces, slides, stops and slides again.
#[test]
fn parameter_gradients_through_contact_rollouts_agree_with_differences() {
    for method in stepping_methods(5e-3) {
        let m = Block { friction: 0.3, m: 2.0, restitution: 0.6 };
        let found = rollout_with_parameter_derivatives(&m, &method, start_of_block(), push_in_step, 100);
        let (_, by_parameters) = found[99];
        for (k, parameter) in OF_BLOCK.iter().enumerate() {
            let final_place_at_parameter_change = |s: f64| {
                let (mut other, (mut q, mut v)) = (m, start_of_block());
                *parameter(&mut other) += s;
                for k in 0..100 {
                    (q, v) = discrete::step(&other, &method, 0.0, &q, &v, &push_in_step(k)).unwrap();
                }
                q
            };
            let h = 2e-5;
            let expected =
                (final_place_at_parameter_change(h) - final_place_at_parameter_change(-h)) / (2.0 * h);
            let off = (by_parameters.column(k) - expected).amax();
            assert!(off < 1e-7 * (1.0 + expected.amax()), "{k}: {off:e} {by_parameters} {expected}");
        }
    }
}

/// Friction and mass of a block follow from its measured path: Gauss–Newton iterations with the derivatives
/// find them from a wrong guess.
#[test]
fn friction_and_mass_are_identified_from_a_bouncing_and_sliding_motion() {
    let method = TimeStepping::step(5e-3);
    let truth = Block { friction: 0.3, m: 2.0, restitution: 0.6 };
    let path = |m: &Block| {
        rollout_with_parameter_derivatives::<_, 3, 1, 3>(m, &method, start_of_block(), push_in_step, 100)
    };
    let measured = path(&truth);
    let mut guess = Block { friction: 0.45, m: 1.4, ..truth };
    for _ in 0..12 {
        let (mut normal, mut gradient) = (SMatrix::<f64, 2, 2>::zeros(), SVector::<f64, 2>::zeros());
        for ((q, by), (expected, _)) in path(&guess).iter().zip(&measured) {
            let by = by.fixed_columns::<2>(0);
            normal += by.tr_mul(&by);
            gradient += by.tr_mul(&(expected - q));
        }
        let change = normal.try_inverse().expect("the motion depends on both") * gradient;
        guess.friction = (guess.friction + change[0]).max(0.01);
        guess.m = (guess.m + change[1]).max(0.1);
    }
    let off = (guess.friction - truth.friction).abs().max((guess.m - truth.m).abs());
    assert!(off < 1e-9, "friction {}, mass {}", guess.friction, guess.m);
}

/// Time stepping without contacts has the same derivatives as differences of its steps.
#[test]
fn time_stepping_without_contacts_has_parameter_derivatives() {
    #[mechanism(gravity = -9.81 * y, derivatives, sensitivities)]
    #[derive(Clone, Copy)]
    struct Pendulum {
        m: f64,
        length: f64,
        #[body(mass = m, com = -length * y, inertia = cuboid(m, length / 4, length, length / 5))]
        bob: Body,
        #[joint(ground -> bob)]
        hinge: Ball,
        #[acts(on = bob.at(-length * y), along = ground.x)]
        wind: Force,
    }
    let m = Pendulum { m: 0.5, length: 0.8 };
    let of_pendulum: [ParameterAccess<Pendulum>; 2] = [|m| &mut m.m, |m| &mut m.length];
    let q = m.integrate(&m.neutral(), &[0.3, 0.4, 0.5].into());
    for method in stepping_methods(0.05) {
        let state = (&q, &[1.0, 2.0, -1.0].into(), &[0.7].into());
        check_parameter_columns("pendulum", m, (&method, of_pendulum), state, (1e-3, &[]));
    }
}
