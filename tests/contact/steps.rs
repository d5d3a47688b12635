//! Derivatives of steps of time stepping through contacts that open, close, stick and slide, against closed
//! forms and differences of the steps.

use super::derivatives::{BallInHollow, Solo, quadruped_state_and_torques};
use linkwork::discrete::{self, DifferentiableStep};
use linkwork::nalgebra::SMatrix;
use linkwork::prelude::*;
use linkwork::{ConstraintError, contact};

#[mechanism(gravity = -9.81 * z, derivatives)]
struct Ball {
    restitution: f64,
    #[particle(mass = 0.5)]
    ball: Particle,
    #[joint(ground -> ball, along = z)]
    height: Sleeve,
    #[acts(on = height)]
    push: Force,
    #[contact(ball, ground.plane(z), restitution = restitution)]
    bounce: Contact,
}

/// Block with a foot in the middle of its lower face, which slides without rotating.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct Block {
    friction: f64,
    #[body(mass = 2)]
    block: Body,
    #[joint(ground -> block, along = (x, y))]
    table: Stage,
    #[joint(block -> slide, along = z)]
    height: Sleeve,
    #[body(mass = 1)]
    slide: Body,
    #[acts(on = table.x)]
    push: Force,
    #[contact(slide, ground.plane(z), friction = friction)]
    foot: Contact,
}

#[mechanism(gravity = -9.81 * z, derivatives)]
struct Crate {
    friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[acts(on = block, along = ground.x)]
    push: Force,
    #[acts(on = block.at(0.1 * x), along = ground.y)]
    side: Force,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = friction)]
    floor: Contact,
}

/// Ball with static friction and friction moments.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct RollingBall {
    restitution: f64,
    #[body(mass = 0.5, inertia = sphere(0.5, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(0.05),
        ground.plane(z),
        friction = 0.5,
        stiction = 0.7,
        rolling = 0.001,
        torsional = 0.002,
        restitution = restitution
    )]
    floor: Contact,
}

/// Ball on a crate with three feet, whose normal forces are determinate.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct BallOnCrate {
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    low: Body,
    #[joint(ground -> low)]
    pose: Free,
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    top: Body,
    #[joint(ground -> top)]
    place: Free,
    #[acts(on = low, along = ground.x)]
    push: Force,
    #[contact(low.at(0.15 * x - 0.05 * z), ground.plane(z), friction = 0.4)]
    front: Contact,
    #[contact(low.at(-0.15 * x + 0.1 * y - 0.05 * z), ground.plane(z), friction = 0.4)]
    left: Contact,
    #[contact(low.at(-0.15 * x - 0.1 * y - 0.05 * z), ground.plane(z), friction = 0.4)]
    right: Contact,
    #[contact(top.sphere(0.1), low.cuboid(0.3, 0.2, 0.1), friction = 0.3)]
    shelf: Contact,
}

/// Returns the methods with steps of `h` seconds. A single step of leapfrog is one through the midpoint.
fn stepping_methods(h: f64) -> [TimeStepping<f64>; 2] {
    let method = TimeStepping::step(h);
    [method, method.midpoint()]
}

/// Checks the columns of a step's Jacobians against central differences of sixth order over `3 h`, except for
/// columns along which contacts open or close (`skipped`, displacements first).
fn check_derivative_columns<M, S, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    method: &S,
    (q, v, u): (&SVector<f64, NQ>, &SVector<f64, NV>, &SVector<f64, NU>),
    (h, skipped): (f64, &[usize]),
) where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
    S: DifferentiableStep<f64>,
{
    let found = discrete::transition(m, method, 0.0, q, v, u).unwrap();
    let (end, after) = discrete::step(m, method, 0.0, q, v, u).unwrap();
    assert!((end - found.q).amax() < 1e-14 && (after - found.v).amax() < 1e-13, "{}", after - found.v);
    for k in (0..2 * NV + NU).filter(|k| !skipped.contains(k)) {
        let unit_displacement =
            |s: f64, first: usize| SVector::<f64, NV>::from_fn(|i, _| if i + first == k { s } else { 0.0 });
        let step_end_at_perturbation = |s: f64| {
            let u = SVector::from_fn(|i, _| if i + 2 * NV == k { u[i] + s } else { u[i] });
            let q = m.integrate(q, &unit_displacement(s, 0));
            let (q, v) = discrete::step(m, method, 0.0, &q, &(v + unit_displacement(s, NV)), &u).unwrap();
            [m.difference(&found.q, &q), v]
        };
        // Noise of the search for impulses is divided by `h`.
        let [one, two, three] =
            [1.0, 2.0, 3.0].map(|n| (step_end_at_perturbation(n * h), step_end_at_perturbation(-n * h)));
        let column_from_blocks = |blocks: [&[f64]; 3]| {
            let from = [0, NV, 2 * NV].into_iter().rev().find(|first| *first <= k).unwrap_or(0);
            SVector::<f64, NV>::from_column_slice(&blocks[from / NV][(k - from) * NV..(k - from + 1) * NV])
        };
        let columns = [
            column_from_blocks([found.q_by_q.as_slice(), found.q_by_v.as_slice(), found.q_by_u.as_slice()]),
            column_from_blocks([found.v_by_q.as_slice(), found.v_by_v.as_slice(), found.v_by_u.as_slice()]),
        ];
        for (what, column) in columns.into_iter().enumerate() {
            let difference_of_pair =
                |(after, before): &([SVector<f64, NV>; 2], [SVector<f64, NV>; 2])| after[what] - before[what];
            let expected = (difference_of_pair(&one) * 45.0 - difference_of_pair(&two) * 9.0
                + difference_of_pair(&three))
                / (60.0 * h);
            let off = (column - expected).amax();
            assert!(off < 2e-8 * (1.0 + expected.amax()), "{k}, {what}: {off:e} {expected} {column}");
        }
    }
}

/// A ball bounces with −e times its velocity, falls freely before, and stays at rest without restitution.
#[test]
fn contact_step_jacobian_covers_a_bouncing_ball() {
    let h = 0.01;
    for method in stepping_methods(h).into_iter().chain([TimeStepping::step(h).leapfrog()]) {
        let ball_transition = |restitution: f64, q: f64, v: f64| {
            let u = [0.2].into();
            discrete::transition(&Ball { restitution }, &method, 0.0, &[q].into(), &[v].into(), &u).unwrap()
        };
        let falls = ball_transition(0.6, 1.0, 0.3);
        assert!((falls.a::<2>() - SMatrix::from([[1.0, 0.0], [h, 1.0]])).amax() < 1e-14);
        assert!((falls.v_by_u[0] - h / 0.5).abs() < 1e-15);
        // The step ends on the ground, and the velocity is −e times that before the step.
        for bounces in [ball_transition(0.6, 0.01, -2.0), ball_transition(0.6, 0.0, -2.0)] {
            assert!((bounces.v[0] - 1.2).abs() < 1e-14 && (bounces.v_by_v[0] + 0.6).abs() < 1e-14);
            assert!(bounces.v_by_q[0].abs() + bounces.v_by_u[0].abs() < 1e-14);
        }
        // At rest no displacement towards the open side remains after a step.
        for rests in [
            ball_transition(0.0, 0.01, -2.0),
            ball_transition(0.0, 0.0, 0.0),
            ball_transition(0.0, 1e-9, 0.0),
        ] {
            assert!(rests.q[0].abs() < 1e-10 && rests.a::<2>().amax() + rests.b::<2>().amax() < 1e-14);
        }
        check_derivative_columns(
            &Ball { restitution: 0.6 },
            &method,
            (&[0.01].into(), &[-2.0].into(), &[0.2].into()),
            (1e-5, &[]),
        );
    }
}

/// Along its slip a block has the derivative 1, across it the ratio of the speeds after and before the step,
/// since friction turns with the slip. A block that sticks does not answer to forces.
#[test]
fn step_jacobian_of_block_depends_on_slip_direction() {
    let (m, h) = (Block { friction: 0.5 }, 0.01);
    for method in stepping_methods(h) {
        let block_transition = |speed: f64| {
            let (v, u) = ([speed, 0.0, 0.0].into(), [0.2].into());
            discrete::transition(&m, &method, 0.0, &SVector::zeros(), &v, &u).unwrap()
        };
        let slides = block_transition(1.0);
        let after = 1.0 + h * (0.2 - 0.5 * 9.81) / 3.0;
        assert!((slides.v[0] - after).abs() < 1e-14);
        assert!(
            (slides.v_by_v[(0, 0)] - 1.0).abs() < 1e-14 && (slides.v_by_u[(0, 0)] - h / 3.0).abs() < 1e-14
        );
        assert!((slides.q_by_v[(0, 0)] - h).abs() < 1e-14);
        check_derivative_columns(
            &m,
            &method,
            (&SVector::zeros(), &[1.0, 0.5, 0.0].into(), &[0.2].into()),
            (1e-6, &[2, 5]),
        );
        let sticks = block_transition(0.0);
        assert!(sticks.v_by_v.amax() + sticks.v_by_u.amax() + sticks.q_by_u.amax() < 1e-14);
        assert_eq!(sticks.q_by_q[(0, 0)], 1.0);
    }
}

/// Columns along which the four lower corners of a crate stay on the ground, or move as a whole.
const FLAT: [usize; 6] = [2, 3, 4, 8, 9, 10];

#[test]
fn crate_step_jacobians_match_differences_in_every_mode() {
    for (friction, method) in stepping_methods(0.01)
        .map(|method| (0.5, method))
        .into_iter()
        .chain([(0.0, stepping_methods(0.01)[0])])
    {
        let m = Crate { friction };
        let (rest, u) =
            (m.integrate(&m.neutral(), &[0.0, 0.0, 0.05, 0.0, 0.0, 0.0].into()), [3.0, 1.0].into());
        let check_crate_columns = |q: &SVector<f64, 7>, v: [f64; 6], h: f64, skipped: &[usize]| {
            check_derivative_columns(&m, &method, (q, &v.into(), &u), (h, skipped));
        };
        check_crate_columns(&rest, [0.0; 6], 1e-6, &FLAT);
        let turned = m.integrate(&rest, &[0.0, 0.0, 0.2, 0.3, 0.4, 0.2].into());
        check_crate_columns(&turned, [0.1, 0.5, 0.4, 1.0, 2.0, 3.0], 1e-5, &[]);
        // A corner that lands, and one on which the crate slides and tips over.
        let mut corner = turned;
        corner[2] -= m.contact_gaps(&turned).min() - 0.01;
        check_crate_columns(&corner, [0.6, 0.3, -2.0, 0.3, 0.4, 0.5], 1e-6, &[]);
        corner[2] -= 0.01;
        check_crate_columns(&corner, [0.6, 0.3, -0.2, 1.3, 0.4, 0.5], 1e-6, &[0, 1, 2, 3, 4, 5]);
    }
}

#[test]
fn contact_step_jacobian_covers_friction_moments_and_terrain() {
    for method in stepping_methods(0.01) {
        let mut q = RollingBall { restitution: 0.0 }.neutral();
        q[2] = 0.05;
        let check_rolling_ball_columns =
            |restitution: f64, q: &SVector<f64, 7>, v: [f64; 6], skipped: &[usize]| {
                let m = RollingBall { restitution };
                check_derivative_columns(&m, &method, (q, &v.into(), &SVector::zeros()), (1e-5, skipped));
            };
        check_rolling_ball_columns(0.0, &q, [1.0, 0.0, 0.0, 0.0, 20.0, 0.3], &[2, 8]);
        check_rolling_ball_columns(0.0, &q, [1.0, 0.0, 0.0, 0.0, 2.0, 0.3], &[2, 8]);
        q[2] = 0.055;
        check_rolling_ball_columns(0.0, &q, [0.1, 0.3, -1.0, -20.0, 2.0, 0.3], &[]);
        check_rolling_ball_columns(0.4, &q, [1.0, 0.3, -2.0, -2.0, 2.0, 0.3], &[]);
        let m = BallInHollow {};
        (q[0], q[1], q[2]) = (0.3, 0.2, 0.2);
        q[2] -= m.contact_gaps(0.0, &q)[0] - 1e-3;
        let v = [0.5, 0.2, -1.0, -0.4, -0.7, -1.0].into();
        check_derivative_columns(&m, &method, (&q, &v, &SVector::zeros()), (1e-6, &[]));
    }
}

#[test]
fn contact_step_jacobian_covers_a_landing_quadruped() {
    let (m, (mut q, mut v, _)) = (Solo {}, quadruped_state_and_torques());
    let u = SVector::from_fn(|k, _| 0.4 * (0.9 * k as f64).cos());
    q[2] -= m.contact_gaps(&q).min() - 0.01;
    v[2] = -2.0;
    check_derivative_columns(&m, &stepping_methods(0.01)[0], (&q, &v, &u), (1e-5, &[]));
    // On four feet, of which one slides.
    let mut q = m.neutral();
    for leg in 0..4 {
        (q[7 + 3 * leg], q[8 + 3 * leg], q[9 + 3 * leg]) = (0.0, 0.8, -1.6);
    }
    q[2] -= m.contact_gaps(&q).min() - 1e-3;
    v = SVector::zeros();
    (v[0], v[2]) = (0.2, -1.0);
    check_derivative_columns(&m, &stepping_methods(0.01)[1], (&q, &v, &u), (1e-5, &[]));
}

/// A ball rolls on a crate, which sticks to the ground or slides.
#[test]
fn contact_step_jacobian_covers_stacked_bodies() {
    let m = BallOnCrate {};
    let (mut q, v) = (m.neutral(), SVector::<f64, 12>::zeros());
    (q[2], q[7], q[9]) = (0.05, 0.03, 0.2);
    // Displacements and velocities that open or close a contact.
    let closed = [2, 3, 4, 8, 14, 15, 16, 20];
    for (method, push) in
        stepping_methods(0.01).into_iter().flat_map(|method| [(method, 2.0), (method, 20.0)])
    {
        check_derivative_columns(&m, &method, (&q, &v, &[push].into()), (1e-6, &closed));
    }
}

/// Returns the gradient of a function of the state after `n` steps under constant inputs, with respect to the
/// initial state and the inputs, by adjoint products backwards in time.
#[allow(clippy::type_complexity, reason = "three gradients")]
fn rollout_gradient<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    method: &TimeStepping<f64>,
    (mut q, mut v, u): (SVector<f64, NQ>, SVector<f64, NV>, SVector<f64, NU>),
    n: usize,
    by_end: (SVector<f64, NV>, SVector<f64, NV>),
) -> (SVector<f64, NV>, SVector<f64, NV>, SVector<f64, NU>)
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    let mut steps = Vec::new();
    for _ in 0..n {
        let step = discrete::transition(m, method, 0.0, &q, &v, &u).unwrap();
        (q, v) = (step.q, step.v);
        steps.push(step);
    }
    let (mut by_q, mut by_v, mut by_u) = (by_end.0, by_end.1, SVector::zeros());
    for step in steps.iter().rev() {
        let found = step.adjoint(&by_q, &by_v);
        (by_q, by_v) = (found.0, found.1);
        by_u += found.2;
    }
    (by_q, by_v, by_u)
}

/// Gradients through a hundred steps in which bodies fall, bounce, slide, roll and come to rest.
#[test]
fn gradients_through_contact_rollouts_agree_with_differences() {
    for method in [stepping_methods(5e-3)[0], stepping_methods(5e-3)[1]] {
        // The crate lands on its face, slides and stops.
        let (m, u) = (Crate { friction: 0.5 }, SVector::from([2.0, 0.0]));
        let start = [0.0, 0.0, 0.07, 0.0, 0.0, 0.0, 1.0].into();
        let v = SVector::from([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let along = SVector::from([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let found = rollout_gradient(&m, &method, (start, v, u), 100, (along, SVector::zeros()));
        let rest_position_after_perturbation = |height: f64, speed: f64, push: f64| {
            let (mut q, mut v, u) = (start, v, [2.0 + push, 0.0].into());
            (q[2], v[0]) = (q[2] + height, v[0] + speed);
            for _ in 0..100 {
                (q, v) = discrete::step(&m, &method, 0.0, &q, &v, &u).unwrap();
            }
            assert!(v.amax() < 1e-9, "it has come to rest");
            q[0]
        };
        // Smaller displacements show the tolerance of the search for impulses.
        let h = 3e-5;
        for (found, expected) in [
            (
                found.0[2],
                rest_position_after_perturbation(h, 0.0, 0.0)
                    - rest_position_after_perturbation(-h, 0.0, 0.0),
            ),
            (
                found.1[0],
                rest_position_after_perturbation(0.0, h, 0.0)
                    - rest_position_after_perturbation(0.0, -h, 0.0),
            ),
            (
                found.2[0],
                rest_position_after_perturbation(0.0, 0.0, h)
                    - rest_position_after_perturbation(0.0, 0.0, -h),
            ),
        ] {
            let expected = expected / (2.0 * h);
            assert!((found - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }
}

/// Poisson's restitution has no derivatives; the error names the contact.
#[test]
fn poisson_restitution_has_no_derivatives() {
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct PoissonBouncingBall {
        #[particle(mass = 0.5)]
        ball: Particle,
        #[joint(ground -> ball, along = z)]
        height: Sleeve,
        #[contact(ball, ground.plane(z), restitution = poisson(0.5))]
        bounce: Contact,
    }
    let method = TimeStepping::step(0.01);
    let step = discrete::transition(
        &PoissonBouncingBall {},
        &method,
        0.0,
        &[0.0].into(),
        &[-1.0].into(),
        &[].into(),
    );
    let reason = ConstraintError::NoDerivatives { constraint: "bounce" };
    assert_eq!(step.unwrap_err(), Error::Constraint { t: 0.0, reason });
    let free = discrete::transition(
        &PoissonBouncingBall {},
        &method,
        0.0,
        &[1.0].into(),
        &[-1.0].into(),
        &[].into(),
    );
    assert!(free.is_ok() && contact::check(&PoissonBouncingBall {}, 0.0, &[1.0].into()).is_ok());
}
