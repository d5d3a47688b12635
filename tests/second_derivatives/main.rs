//! Checks of second derivatives of the dynamics against finite differences of first derivatives along the
//! tangent space. The mechanisms have rotating axes, driven motion, and inputs in body axes; constrained ones
//! are in `constrained`.

mod constrained;
mod hyper;
mod reference;
mod speeds;
mod turning;

use linkwork::prelude::*;
use linkwork::{Derivatives, SecondDerivatives, discrete};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::{compile, parse_source_and_import};
use std::path::Path;
use support::differences;
use support::random::Random;

/// Flying body with a load on a ball joint below, and a spring between them. Forces and a torque act along
/// lines that the motion moves.
#[mechanism(gravity = -9.81 * z, second_derivatives)]
struct FlyingBodyWithLoad {
    #[body(mass = 1.2, com = 0.02 * z, inertia = diagonal(0.01, 0.012, 0.02))]
    frame: Body,
    #[body(mass = 0.3, com = -0.4 * z + 0.05 * x, inertia = diagonal(0.004, 0.005, 0.001))]
    load: Body,
    #[joint(ground -> frame)]
    flight: Free,
    #[joint(frame.at(-0.05 * z) -> load)]
    hook: Ball,
    #[acts(on = frame.at(0.2 * x), along = frame.z)]
    front: Force,
    #[acts(on = load.at(0.3 * y), along = x)]
    wind: Force,
    #[acts(on = load, about = frame.z)]
    drag: Torque,
    #[acts(between = (frame.at(0.1 * x), load.at(-0.3 * z)), stiffness = 30, free_length = 0.2)]
    spring: Spring,
}

/// Pendulum with a motor and a second pendulum, on a pivot that is driven up and down.
#[mechanism(gravity = -9.81 * y, second_derivatives)]
struct DoublePendulumOnDrivenPivot {
    rate: f64,
    #[point(at = 0.1 * sin(rate * t) * y)]
    pivot: Point,
    #[body(mass = 0.7, com = -0.3 * y, inertia = diagonal(0.01, 0.01, 0.02))]
    bob: Body,
    #[body(mass = 0.4, com = -0.2 * y, inertia = diagonal(0.01, 0.01, 0.005))]
    second: Body,
    #[joint(pivot -> bob, about = z)]
    hinge: Pin,
    #[joint(bob.at(-0.6 * y) -> second, about = z)]
    lower: Pin,
    #[acts(on = hinge)]
    motor: Torque,
}

/// Panda robot arm with seven axes and a gripper.
#[mechanism(urdf = "../models/urdf/panda.urdf", second_derivatives)]
struct Panda;

/// Solo12 quadruped robot with a free base.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, second_derivatives)]
struct Solo;

/// Maximum difference of derivatives, relative to the largest entry.
const TOLERANCE: f64 = 2e-9;

const STEP: f64 = 9e-4;

/// Returns the derivatives of a vector function along each entry of its argument, as columns.
fn derivative_columns<const N: usize, const R: usize>(
    of: impl Fn(&SVector<f64, N>) -> SVector<f64, R>,
) -> SMatrix<f64, R, N> {
    differences::derivative_columns([STEP; N], |d| of(&d))
}

/// Returns the derivatives of `λᵀ A` by differences: entry `(i, j)` is the derivative along `j` of the
/// derivative along `i`.
fn contracted_derivatives<const NV: usize, const N: usize, const C: usize>(
    lambda: &SVector<f64, NV>,
    of: impl Fn(&SVector<f64, N>) -> SMatrix<f64, NV, C>,
) -> SMatrix<f64, C, N> {
    derivative_columns(|d: &SVector<f64, N>| of(d).tr_mul(lambda))
}

fn assert_block<const R: usize, const C: usize>(
    what: &str,
    found: &SMatrix<f64, R, C>,
    expected: &SMatrix<f64, R, C>,
    scale: f64,
) {
    let off = (found - expected).amax();
    assert!(off <= TOLERANCE * scale, "{what}: off by {off:e} of {scale:e}\n{found:.6}{expected:.6}");
}

fn check_second_derivatives<M, const NQ: usize, const NV: usize, const NU: usize>(
    name: &str,
    m: &M,
    push: f64,
) where
    M: SecondDerivatives<NQ, NV, NU, Scalar = f64>,
{
    for seed in 0..2 {
        let mut random = Random::new(seed);
        let q = m.integrate(&m.neutral(), &random.random_vector(1.2));
        let (v, a, tau, lambda) = (
            random.random_vector(1.5),
            random.random_vector(2.0),
            random.random_vector(3.0),
            random.random_vector(1.0),
        );
        let (u, t) = (random.random_vector::<NU>(push), random.uniform_number(1.0));
        let (v, a, tau, lambda): (SVector<f64, NV>, SVector<f64, NV>, _, _) = (v, a, tau, lambda);
        let displaced_configuration = |dq: &SVector<f64, NV>| m.integrate(&q, dq);
        // Maps changes of `dq` to changes of `q ⊕ dq`.
        let displacement_jacobian = |dq: &SVector<f64, NV>| m.integrate_derivatives_at(&q, dq).1;
        let largest_magnitude = |blocks: &[f64]| blocks.iter().fold(1.0_f64, |s, x| s.max(x.abs()));

        let (qq, qv, vv, qa) = m.inverse_dynamics_second_derivatives(t, &q, &v, &a, &lambda);
        let inverse_derivatives =
            |q: &_, v: &_, a: &_| Derivatives::inverse_dynamics_derivatives(m, t, q, v, a);
        let expected = [
            contracted_derivatives(&lambda, |d| {
                inverse_derivatives(&displaced_configuration(d), &v, &a).0 * displacement_jacobian(d)
            }),
            contracted_derivatives(&lambda, |d: &SVector<f64, NV>| inverse_derivatives(&q, &(v + d), &a).0),
            contracted_derivatives(&lambda, |d: &SVector<f64, NV>| inverse_derivatives(&q, &(v + d), &a).1),
            contracted_derivatives(&lambda, |d: &SVector<f64, NV>| inverse_derivatives(&q, &v, &(a + d)).0),
        ];
        let size = largest_magnitude(&expected.concat_matrix_entries());
        for (what, (found, expected)) in
            ["qq", "qv", "vv", "qa"].iter().zip([qq, qv, vv, qa].iter().zip(&expected))
        {
            assert_block(&format!("{name}, {seed}: inverse dynamics, {what}"), found, expected, size);
        }

        let (qq, qv, vv, qf) = m.forward_dynamics_second_derivatives(t, &q, &v, &tau, &lambda);
        let forward_derivatives =
            |q: &_, v: &_, tau: &_| Derivatives::forward_dynamics_derivatives(m, t, q, v, tau);
        let expected = [
            contracted_derivatives(&lambda, |d| {
                forward_derivatives(&displaced_configuration(d), &v, &tau).0 * displacement_jacobian(d)
            }),
            contracted_derivatives(&lambda, |d: &SVector<f64, NV>| forward_derivatives(&q, &(v + d), &tau).0),
            contracted_derivatives(&lambda, |d: &SVector<f64, NV>| forward_derivatives(&q, &(v + d), &tau).1),
            contracted_derivatives(&lambda, |d: &SVector<f64, NV>| forward_derivatives(&q, &v, &(tau + d)).0),
        ];
        let size = largest_magnitude(&expected.concat_matrix_entries());
        for (what, (found, expected)) in
            ["qq", "qv", "vv", "qτ"].iter().zip([qq, qv, vv, qf].iter().zip(&expected))
        {
            assert_block(&format!("{name}, {seed}: forward dynamics, {what}"), found, expected, size);
        }

        let now = at(m, t);
        let (qq, qv, vv, qu, vu, uu) = now.second_order_motion(&q, &v, &u, &lambda);
        let linearization_at_state = |q: &_, v: &_, u: &_| now.linear_motion(q, v, u);
        let linearization_at_input_step = |d: &SVector<f64, NU>| linearization_at_state(&q, &v, &(u + d));
        let states = [
            (
                qq,
                contracted_derivatives(&lambda, |d| {
                    linearization_at_state(&displaced_configuration(d), &v, &u).by_q
                        * displacement_jacobian(d)
                }),
            ),
            (
                qv,
                contracted_derivatives(&lambda, |d: &SVector<f64, NV>| {
                    linearization_at_state(&q, &(v + d), &u).by_q
                }),
            ),
            (
                vv,
                contracted_derivatives(&lambda, |d: &SVector<f64, NV>| {
                    linearization_at_state(&q, &(v + d), &u).by_v
                }),
            ),
        ];
        let size = states.iter().fold(1.0_f64, |s, (_, b)| s.max(b.amax()));
        for (k, (found, expected)) in states.iter().enumerate() {
            assert_block(&format!("{name}, {seed}: motion, block {k}"), found, expected, size);
        }
        assert_block(
            "qu",
            &qu,
            &contracted_derivatives(&lambda, |d| linearization_at_input_step(d).by_q),
            size,
        );
        assert_block(
            "vu",
            &vu,
            &contracted_derivatives(&lambda, |d| linearization_at_input_step(d).by_v),
            size,
        );
        assert_block(
            "uu",
            &uu,
            &contracted_derivatives(&lambda, |d| linearization_at_input_step(d).by_u),
            size,
        );
    }
}

/// Concatenation of the entries of several matrices into one list, for comparisons.
trait ConcatMatrixEntries {
    fn concat_matrix_entries(&self) -> Vec<f64>;
}

impl<const N: usize, const NV: usize> ConcatMatrixEntries for [SMatrix<f64, NV, NV>; N] {
    fn concat_matrix_entries(&self) -> Vec<f64> {
        self.iter().flat_map(|m| m.iter().copied()).collect()
    }
}

#[test]
fn second_derivatives_agree_with_differences() {
    check_second_derivatives("driven", &DoublePendulumOnDrivenPivot { rate: 3.0 }, 1.0);
    check_second_derivatives("carrier", &FlyingBodyWithLoad {}, 3.0);
    check_second_derivatives("arm", &Panda, 5.0);
    check_second_derivatives("quadruped", &Solo, 5.0);
}

/// Checks second derivatives of steps against differences of their Jacobians.
fn check_steps_at_random_state<M, S, const NV: usize, const NU: usize>(
    name: &str,
    m: &M,
    method: &S,
    push: f64,
) where
    M: SecondDerivatives<NV, NV, NU, Scalar = f64>,
    S: discrete::TwiceDifferentiableStep<f64>,
{
    let mut random = Random::new(11);
    let (q, v) = (random.random_vector::<NV>(1.0), random.random_vector::<NV>(1.0));
    check_second_derivatives_of_steps(name, m, method, push, q, v);
}

/// Checks second derivatives of steps against differences, from a given state at the time 0.3 s.
fn check_second_derivatives_of_steps<M, S, const NV: usize, const NU: usize>(
    name: &str,
    m: &M,
    method: &S,
    push: f64,
    q: SVector<f64, NV>,
    v: SVector<f64, NV>,
) where
    M: SecondDerivatives<NV, NV, NU, Scalar = f64>,
    S: discrete::TwiceDifferentiableStep<f64>,
{
    let mut random = Random::new(12);
    let (u, t) = (random.random_vector::<NU>(push), 0.3);
    let factors = (random.random_vector::<NV>(1.0), random.random_vector::<NV>(1.0));
    let (qq, qv, vv, qu, vu, uu) =
        discrete::second_order(m, method, t, &q, &v, &u, (&factors.0, &factors.1)).expect("it moves");
    let gradient_of_step = |q: &_, v: &_, u: &_| {
        discrete::transition(m, method, t, q, v, u).expect("it moves").adjoint(&factors.0, &factors.1)
    };
    let by_q = derivative_columns(|d: &SVector<f64, NV>| gradient_of_step(&(q + d), &v, &u).0);
    let size = by_q.amax().max(1.0);
    assert_block(&format!("{name}: qq"), &qq, &by_q, size);
    let gradient_at_velocity_step = |d: &SVector<f64, NV>| gradient_of_step(&q, &(v + d), &u);
    assert_block(&format!("{name}: qv"), &qv, &derivative_columns(|d| gradient_at_velocity_step(d).0), size);
    assert_block(&format!("{name}: vv"), &vv, &derivative_columns(|d| gradient_at_velocity_step(d).1), size);
    let gradient_at_input_step = |d: &SVector<f64, NU>| gradient_of_step(&q, &v, &(u + d));
    assert_block(&format!("{name}: qu"), &qu, &derivative_columns(|d| gradient_at_input_step(d).0), size);
    assert_block(&format!("{name}: vu"), &vu, &derivative_columns(|d| gradient_at_input_step(d).1), size);
    let by_inputs = derivative_columns(|d| gradient_at_input_step(d).2);
    assert_block(&format!("{name}: uu"), &uu, &by_inputs, size);
}

#[test]
fn step_second_derivatives_agree_with_differences() {
    check_steps_at_random_state(
        "driven, Rk4",
        &DoublePendulumOnDrivenPivot { rate: 3.0 },
        &Rk4::step(0.05),
        1.0,
    );
    check_steps_at_random_state(
        "driven, Euler",
        &DoublePendulumOnDrivenPivot { rate: 3.0 },
        &SemiImplicitEuler::step(0.05),
        1.0,
    );
    check_steps_at_random_state("arm, Rk4", &Panda, &Rk4::step(0.01), 5.0);
    check_steps_at_random_state("arm, Euler", &Panda, &SemiImplicitEuler::step(0.01), 5.0);
}

/// Returns the numbers of operations of first and second derivatives of inverse dynamics.
fn derivative_operation_counts(arguments: &str) -> [usize; 2] {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let source =
        parse_source_and_import(parse_tokens(arguments), parse_tokens("struct Robot;"), folder, &mut cx);
    let Some((_, output)) = source.and_then(|s| compile(&s, &graph, &mut cx)) else {
        panic!("{}", cx.full_message_texts().join("\n"));
    };
    ["inverse_dynamics_derivatives", "inverse_dynamics_second_derivatives"].map(|name| {
        let f = output.functions.iter().find(|f| f.name == name).expect("the function is generated");
        f.program.counts.total_operations()
    })
}

/// Second derivatives follow from a recursion, so that their cost is a small multiple of that of the first
/// derivatives.
#[test]
fn second_derivatives_cost_twice_the_first() {
    let fingers = "lock = [\"panda_finger_joint1\", \"panda_finger_joint2\"]";
    for (robot, options, most) in [
        ("ur5", "base = fixed", 1450),
        ("panda", fingers, 4800),
        ("solo12", "base = free", 6700),
        ("simple_humanoid", "base = free", 26_700),
    ] {
        let [first, second] = derivative_operation_counts(&format!(
            "urdf = \"../models/urdf/{robot}.urdf\", {options}, second_derivatives"
        ));
        println!("{robot}: {first} {second}");
        assert!(second <= most && second <= 2 * first, "{robot}: {first} and {second}");
    }
}
