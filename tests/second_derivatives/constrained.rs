//! Second derivatives under constraints, against automatic differentiation of hand-written equations, and
//! against differences of first derivatives for loops and spatial rolling.

use super::hyper::{HyperDual, solve_linear_system};
use super::{TOLERANCE, assert_block, check_second_derivatives, check_second_derivatives_of_steps};
use linkwork::prelude::*;
use support::random::Random;

/// Four-bar linkage with a motor on its crank and a spring across the loop.
#[mechanism(gravity = -9.81 * y, second_derivatives)]
struct FourBar {
    #[body(mass = 1.0, com = 0.2 * x, inertia = diagonal(0.01, 0.02, 0.03))]
    crank: Body,
    #[body(mass = 1.5, com = 0.5 * x + 0.1 * y, inertia = diagonal(0.1, 0.11, 0.2))]
    coupler: Body,
    #[body(mass = 1.2, com = 0.4 * x, inertia = diagonal(0.01, 0.1, 0.1))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    input: Pin,
    #[joint(crank.at(0.4 * x) -> coupler, about = z)]
    middle: Pin,
    #[joint(ground.at(1.1 * x) -> rocker, about = z)]
    output: Pin,
    #[joint(coupler.at(1.0 * x) -> rocker.at(0.8 * x), about = z)]
    last: Pin,
    #[acts(on = input)]
    motor: Torque,
    #[acts(between = (ground.at(0.5 * y), coupler.at(0.6 * x)), stiffness = 20, free_length = 0.3)]
    spring: Spring,
}

/// Flying body with a rod on a ball joint; a second ball joint closes the loop.
#[mechanism(gravity = -9.81 * z, second_derivatives)]
pub struct TiedFlyingBody {
    #[body(mass = 1.2, com = 0.02 * z, inertia = diagonal(0.05, 0.06, 0.07))]
    flyer: Body,
    #[body(mass = 0.6, com = -0.4 * z, inertia = diagonal(0.04, 0.05, 0.01))]
    rod: Body,
    #[joint(ground -> flyer)]
    flight: Free,
    #[joint(ground -> rod)]
    hook: Ball,
    #[joint(rod.at(-0.8 * z) -> flyer.at(0.1 * x + 0.2 * y))]
    tie: Ball,
    #[acts(on = flyer.at(0.2 * x), along = flyer.z)]
    rotor: Force,
}

/// Marble on a plane, with its centre of mass off its geometric centre.
#[mechanism(gravity = -9.81 * z, second_derivatives)]
pub struct Marble {
    #[body(mass = 0.5, com = 0.05 * x, inertia = diagonal(0.01, 0.012, 0.013))]
    marble: Body,
    #[joint(ground -> marble)]
    pose: Free,
    #[constraint(rolls(marble.sphere(0.3), ground.plane(z)))]
    contact: Rolling,
    #[acts(on = marble, along = marble.x)]
    fan: Force,
}

/// Double pendulum with point masses on a cart. Its tip stays at a constant distance from a driven peg, and
/// the velocity of the elbow is a function of shoulder angle and cart velocity.
#[mechanism(gravity = -9.81 * y, second_derivatives)]
struct DoublePendulumTiedToDrivenPeg {
    sway: f64,
    #[body(mass = 0.8)]
    cart: Body,
    #[body(mass = 0.7, com = -0.9 * y)]
    upper: Body,
    #[body(mass = 0.4, com = -0.7 * y)]
    lower: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(-0.9 * y) -> lower, about = z)]
    elbow: Pin,
    #[point(at = x + (0.2 * sin(sway * t) - 1.1) * y)]
    peg: Point,
    #[constraint(dot(r(lower.at(-0.7 * y) / peg), r(lower.at(-0.7 * y) / peg)) = 0.64)]
    string: Holonomic,
    #[constraint(rate(elbow) - 1 * sin(shoulder) * rate(rail) = 0)]
    gear: Nonholonomic,
    #[acts(on = cart, along = x)]
    push: Force,
}

/// Returns the accelerations of `DoublePendulumTiedToDrivenPeg` by Lagrange's equations with multipliers; `x`
/// has configuration, velocity and forces.
fn constrained_accelerations(sway: f64, t: f64, x: &[HyperDual; 9]) -> [HyperDual; 3] {
    let ([_, q1, q2, v0, v1, v2, ..], number) = (*x, HyperDual::constant_hyper);
    let (masses, reach, gravity) =
        ([number(0.8), number(0.7), number(0.4)], [0.9, 0.7].map(number), number(9.81));
    let ((s, c), (s2, c2), zero) = (q1.sin_cos(), (q1 + q2).sin_cos(), number(0.0));
    let (turn, both) = (v1 * v1, (v1 + v2) * (v1 + v2));
    // Columns of the Jacobian of each mass, and its acceleration for zero v̇.
    let (along, across) = ([reach[0] * c, reach[0] * s], [reach[1] * c2, reach[1] * s2]);
    let hand = [[number(1.0), zero], [along[0] + across[0], along[1] + across[1]], across];
    let columns =
        [[[number(1.0), zero], [zero; 2], [zero; 2]], [[number(1.0), zero], along, [zero; 2]], hand];
    let middle = [-reach[0] * s * turn, reach[0] * c * turn];
    let end = [middle[0] - reach[1] * s2 * both, middle[1] + reach[1] * c2 * both];
    let own = [[zero; 2], middle, end];
    let dot_product = |a: [HyperDual; 2], b: [HyperDual; 2]| a[0] * b[0] + a[1] * b[1];
    let weighted_sum =
        |f: &dyn Fn(usize) -> HyperDual| masses.iter().zip(0..).fold(zero, |sum, (m, k)| sum + *m * f(k));
    let mass_entry = |i: usize, j: usize| weighted_sum(&|k| dot_product(columns[k][i], columns[k][j]));
    let bias_entry =
        |i: usize| weighted_sum(&|k| dot_product(columns[k][i], own[k]) + gravity * columns[k][i][1]);
    // Squared distance from the peg.
    let (wave, slope) = (sway * t).sin_cos();
    let peg = [number(1.0), number(0.2 * wave - 1.1)];
    let place = [x[0] + reach[0] * s + reach[1] * s2, -(reach[0] * c + reach[1] * c2)];
    let apart = [place[0] - peg[0], place[1] - peg[1]];
    let hand_velocity_component = |d: usize| hand[0][d] * v0 + hand[1][d] * v1 + hand[2][d] * v2;
    let leaving = [hand_velocity_component(0), hand_velocity_component(1) - number(0.2 * sway * slope)];
    let free = [end[0], end[1] + number(0.2 * sway * sway * wave)];
    let two = number(2.0);
    let rows = [hand.map(|column| two * dot_product(apart, column)), [-s, zero, number(1.0)]];
    let known = [two * dot_product(leaving, leaving) + two * dot_product(apart, free), -c * v1 * v0];
    let system = std::array::from_fn::<_, 5, _>(|i| {
        std::array::from_fn::<_, 5, _>(|j| match (i < 3, j < 3) {
            (true, true) => mass_entry(i, j),
            (true, false) => rows[j - 3][i],
            (false, true) => rows[i - 3][j],
            (false, false) => zero,
        })
    });
    let side = std::array::from_fn(|i| if i < 3 { x[6 + i] - bias_entry(i) } else { -known[i - 3] });
    let [a, b, c, ..] = solve_linear_system::<5>(system, side);
    [a, b, c]
}

/// Returns the second derivatives of `λᵀ v̇` with respect to configuration, velocity and forces.
fn acceleration_hessian(
    sway: f64,
    t: f64,
    x: &SVector<f64, 9>,
    lambda: &SVector<f64, 3>,
) -> SMatrix<f64, 9, 9> {
    SMatrix::from_fn(|i, j| {
        let kronecker_delta = |k: usize, direction: usize| if k == direction { 1.0 } else { 0.0 };
        let seeded_coordinate = |k: usize| HyperDual {
            value: x[k],
            first: [kronecker_delta(k, i), kronecker_delta(k, j)],
            second: 0.0,
        };
        let a = constrained_accelerations(sway, t, &std::array::from_fn(seeded_coordinate));
        a.iter().zip(lambda.iter()).map(|(a, factor)| a.second * factor).sum()
    })
}

#[test]
fn hand_derived_equations_have_the_generated_second_derivatives() {
    let (m, t) = (DoublePendulumTiedToDrivenPeg { sway: 2.0 }, 0.4);
    for seed in 0..8 {
        let mut random = Random::new(seed);
        let (q, v) = (random.random_vector::<3>(1.2), random.random_vector::<3>(2.0));
        let (tau, lambda) = (random.random_vector::<3>(5.0), random.random_vector::<3>(1.0));
        let x = SVector::from_fn(|k, _| [q[k % 3], v[k % 3], tau[k % 3]][k / 3]);
        let values =
            constrained_accelerations(2.0, t, &std::array::from_fn(|k| HyperDual::constant_hyper(x[k])))
                .map(|a| a.value);
        let off = (m.forward_dynamics(t, &q, &v, &tau) - SVector::from(values)).amax();
        assert!(off < 1e-10 * (1.0 + values.iter().fold(0.0_f64, |s, a| s.max(a.abs()))), "{off:e}");

        let expected = acceleration_hessian(2.0, t, &x, &lambda);
        let block_of_hessian = |i: usize, j: usize| expected.fixed_view::<3, 3>(3 * i, 3 * j).clone_owned();
        let (qq, qv, vv, qf) = m.forward_dynamics_second_derivatives(t, &q, &v, &tau, &lambda);
        let size = expected.amax().max(1.0) * 1e-9 / TOLERANCE;
        for (what, found, (i, j)) in
            [("qq", qq, (0, 0)), ("qv", qv, (0, 1)), ("vv", vv, (1, 1)), ("qτ", qf, (0, 2))]
        {
            assert_block(&format!("{seed}: {what}"), &found, &block_of_hessian(i, j), size);
        }
        assert!(
            block_of_hessian(1, 2).amax() == 0.0 && block_of_hessian(2, 2).amax() == 0.0,
            "these are not given"
        );
    }
}

#[test]
fn constrained_second_derivatives_agree_with_differences() {
    check_second_derivatives("four-bar linkage", &FourBar {}, 2.0);
    check_second_derivatives("tied bodies", &TiedFlyingBody {}, 3.0);
    check_second_derivatives("marble", &Marble {}, 1.0);
    check_second_derivatives("driven", &DoublePendulumTiedToDrivenPeg { sway: 2.0 }, 1.0);
}

#[test]
fn constrained_step_second_derivatives_agree_with_differences() {
    let m = FourBar {};
    let q = m.assemble(&[0.9, -0.5, 1.6].into(), &[0]).expect("it can be assembled");
    let v = m.project_velocity(&q, &[1.5, 0.0, 0.0].into()).expect("it moves");
    check_second_derivatives_of_steps("linkage", &m, &Rk4::step(0.02), 2.0, q, v);
    // The state violates the constraints, so that the projection has a larger effect.
    check_second_derivatives_of_steps(
        "torn linkage",
        &m,
        &Rk4::step(0.02),
        2.0,
        q.add_scalar(0.05),
        v.add_scalar(0.3),
    );

    let m = DoublePendulumTiedToDrivenPeg { sway: 2.0 };
    let q = m.assemble(0.3, &[0.2, 0.4, 0.5].into(), &[0]).expect("it can be assembled");
    let v = m.project_velocity(0.3, &q, &[0.7, 0.3, 0.0].into()).expect("it moves");
    check_second_derivatives_of_steps("driven", &m, &Rk4::step(0.02), 1.0, q, v);
}

/// A bead on a circular wire is a pendulum: `v̇ = −g / l sin q`.
#[test]
fn bead_on_a_wire_has_pendulum_second_derivatives() {
    #[mechanism(gravity = -9.81 * y, second_derivatives)]
    struct Bead {
        #[particle(mass = 2)]
        bead: Particle,
        #[joint(ground -> bead, along = (x, y))]
        plane: Stage,
        #[constraint(plane.x * plane.x + plane.y * plane.y = 0.25)]
        wire: Holonomic,
    }
    // Second derivative of the tangential v̇ with respect to s, along the wire q(s) = l (sin s, −cos s), at
    // rest.
    let (l, s) = (0.5, 0.7_f64);
    let (along, inwards) = (SVector::from([s.cos(), s.sin()]), SVector::from([-s.sin(), s.cos()]));
    let q = inwards * -l;
    let (none, m) = (SVector::zeros(), Bead {});
    // The direction e rotates along the wire: d²/ds² (e·v̇) = e·v̇ₛₛ + 2 eₛ·v̇ₛ + eₛₛ·v̇.
    let a = m.forward_dynamics(&q, &none, &none);
    let (by_q, ..) = m.forward_dynamics_derivatives(&q, &none, &none);
    let (qq, ..) = m.forward_dynamics_second_derivatives(&q, &none, &none, &along);
    let first = by_q * along * l;
    let second = (along * l).dot(&(qq * along * l)) + along.dot(&(by_q * inwards * l));
    let found = second + 2.0 * inwards.dot(&first) - along.dot(&a);
    assert!((found - 9.81 * s.sin()).abs() < 1e-10, "{found}");
}
