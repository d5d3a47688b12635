//! Checks derivatives of contacts, linear systems in independent coordinates and second derivatives of
//! accelerations of loaded mechanisms. They are compared with the same mechanisms compiled by the attribute,
//! and with differences.

use linkwork::contact::{self, Touch};
use linkwork::integrate::TimeStepping;
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork::{SecondDerivatives, at, discrete};
use linkwork_jit::{Error, Loader, Robot};

type Failure = Box<dyn std::error::Error>;

/// Declares a mechanism by the attribute, and a constant with the same declaration as text.
macro_rules! declared_twice {
    ($text:ident: $($declaration:tt)*) => {
        $($declaration)*
        const $text: &str = stringify!($($declaration)*);
    };
}

declared_twice! { BLOCK:
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct ContactBlock {
        #[body(mass = 2, com = 0.05 * x, inertia = cuboid(2, 0.3, 0.2, 0.1))]
        block: Body,
        #[joint(ground -> block)]
        pose: Free,
        #[contact(block.at(0.2 * x), ground.plane(z), friction = 0.5)]
        front: Contact,
        #[contact(block.at(-0.2 * x + 0.1 * y), ground.plane(z), friction = 0.3)]
        back: Contact,
        #[acts(on = block, along = x)]
        push: Force,
    }
}

declared_twice! { FOUR_BAR:
    #[mechanism(gravity = -9.81 * y, second_derivatives)]
    struct FourBar {
        #[body(mass = 1, com = 0.1 * x, inertia = rod(1, 0.2, x))]
        crank: Body,
        #[body(mass = 2, com = 0.25 * x, inertia = rod(2, 0.5, x))]
        coupler: Body,
        #[body(mass = 2, com = 0.2 * x, inertia = rod(2, 0.4, x))]
        rocker: Body,
        #[joint(ground -> crank, about = z)]
        input: Pin,
        #[joint(crank.at(0.2 * x) -> coupler, about = z)]
        joint: Pin,
        #[joint(ground.at(0.5 * x) -> rocker, about = z)]
        output: Pin,
        #[joint(coupler.at(0.5 * x) -> rocker.at(0.4 * x), about = z)]
        loop_: Pin,
        #[acts(on = input)]
        motor: Torque,
    }
}

declared_twice! { SLEIGH:
    #[mechanism(derivatives)]
    struct Sleigh {
        #[body(mass = 2, com = 0.3 * x, inertia = diagonal(0.1, 0.1, 0.1))]
        sleigh: Body,
        #[joint(ground -> sleigh, about = z)]
        ice: Planar,
        #[constraint(dot(v(sleigh / ground / ground), sleigh.y) = 0)]
        knife: Nonholonomic,
        #[acts(on = sleigh, along = x)]
        pull: Force,
    }
}

declared_twice! { TOP:
    #[mechanism(gravity = -9.81 * z, second_derivatives)]
    struct Top {
        #[body(mass = 1, com = 0.2 * z, inertia = diagonal(0.02, 0.02, 0.01))]
        top: Body,
        #[joint(ground -> top)]
        tip: Ball,
    }
}

/// Returns values of magnitude one, different for each seed.
fn sample<const N: usize>(seed: usize) -> SVector<f64, N> {
    SVector::from_fn(|k, _| ((7 * k + 3 * seed + 1) as f64).sin())
}

fn padded_vector<const N: usize>(x: &[f64]) -> SVector<f64, N> {
    SVector::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0))
}

/// Compares a matrix with the first rows and columns of a padded one.
fn assert_leading_block<const R: usize, const C: usize, const N: usize, const M: usize>(
    padded: &linkwork::nalgebra::SMatrix<f64, N, M>,
    expected: &linkwork::nalgebra::SMatrix<f64, R, C>,
    what: &str,
) {
    let scale = expected.amax().max(1.0);
    for (i, j) in (0..R).flat_map(|i| (0..C).map(move |j| (i, j))) {
        let (found, expected) = (padded[(i, j)], expected[(i, j)]);
        assert!((found - expected).abs() < 1e-9 * scale, "{what} ({i}, {j}): {found} instead of {expected}");
    }
}

fn block_robot() -> Result<Robot, Error> {
    Loader::text(BLOCK).load()
}

/// Accelerations and forces of sticking and sliding contacts, and their derivatives, in padded dimensions.
#[test]
fn derivatives_of_contacts_equal_compiled_ones() -> Result<(), Failure> {
    let m = block_robot()?.padded_contacts::<8, 8, 3, 4, 10>()?;
    for (seed, touches) in
        [[Touch::Sticks, Touch::Open], [Touch::Slips, Touch::Sticks], [Touch::Slips, Touch::Slips]]
            .into_iter()
            .enumerate()
    {
        let q = ContactBlock {}.integrate(&ContactBlock {}.neutral(), &(sample(seed) * 0.3));
        let (v, tau) = (sample(seed + 1), sample::<6>(seed + 2) * 5.0);
        let own = contact::forward_dynamics_derivatives(&ContactBlock {}, 0.0, &q, &v, &tau, &touches)?;
        let [first, second] = touches;
        let touches = [first, second, Touch::Open, Touch::Open];
        let (q, v, tau) =
            (padded_vector(q.as_slice()), padded_vector(v.as_slice()), padded_vector(tau.as_slice()));
        let found = contact::forward_dynamics_derivatives(&m, 0.0, &q, &v, &tau, &touches)?;
        assert_leading_block(&found.a, &own.a, "accelerations");
        assert_leading_block(&found.forces, &own.forces, "forces");
        for (found, own) in [(found.by_q, own.by_q), (found.by_v, own.by_v), (found.by_tau, own.by_tau)] {
            assert_leading_block(&found, &own, "derivatives of accelerations");
        }
        for (found, own) in [(found.forces_by_q, own.forces_by_q), (found.forces_by_tau, own.forces_by_tau)] {
            assert_leading_block(&found, &own, "derivatives of forces");
        }
    }
    Ok(())
}

/// Jacobians of a step that ends in contact equal compiled ones, and differences of steps.
#[test]
fn jacobians_of_steps_with_contacts_are_differences() -> Result<(), Failure> {
    let m = block_robot()?.padded_contacts::<7, 6, 1, 2, 6>()?;
    let method = TimeStepping::step(1e-2);
    let mut q = ContactBlock {}.neutral();
    q[2] = 1e-4;
    let (v, u) = (SVector::from([0.5, 0.2, -1.0, 0.1, -0.2, 0.3]), SVector::from([0.4]));
    let own = discrete::transition(&ContactBlock {}, &method, 0.0, &q, &v, &u)?;
    let found = discrete::transition(&m, &method, 0.0, &q, &v, &u)?;
    assert_leading_block(&found.v, &own.v, "velocity");
    for (found, own) in [(found.v_by_q, own.v_by_q), (found.v_by_v, own.v_by_v), (found.q_by_v, own.q_by_v)] {
        assert_leading_block(&found, &own, "Jacobian");
    }
    let e = 1e-6;
    for j in 0..6 {
        let velocity_after_step = |by: f64| -> Result<_, Failure> {
            let mut v = v;
            v[j] += by;
            Ok(discrete::step(&m, &method, 0.0, &q, &v, &u)?.1)
        };
        let slope = (velocity_after_step(e)? - velocity_after_step(-e)?) / (2.0 * e);
        assert!((slope - found.v_by_v.column(j)).amax() < 1e-5, "column {j}: {slope}");
    }
    Ok(())
}

/// Linear systems of a linkage and of a sleigh, which has more coordinates than velocities.
#[test]
fn linear_systems_in_independent_coordinates_equal_compiled_ones() -> Result<(), Failure> {
    let robot = Loader::text(FOUR_BAR).load()?;
    let q = FourBar {}.assemble(&[0.9, -0.4, 1.2].into(), &[0])?;
    let v = FourBar {}.complete_velocity(&q, &[1.5, 0.0, 0.0].into(), &[0])?;
    for preferred in [[0], [2]] {
        let own = FourBar {}.linearize(&q, &v, &[0.3].into(), &preferred)?;
        let found = robot.linearize_independent(q.as_slice(), v.as_slice(), &[0.3], &preferred)?;
        assert_eq!((&*found.coordinates, &*found.velocities), (&preferred[..], &preferred[..]));
        let difference =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(difference(found.a.as_slice(), own.a.as_slice()) < 1e-8, "{}{}", found.a, own.a);
        assert!(difference(found.b.as_slice(), own.b.as_slice()) < 1e-8, "{}{}", found.b, own.b);
    }
    // The crank's acceleration at crank angles and velocities nearby, along the constraints.
    let crank_acceleration = |angle: f64, velocity: f64| -> Result<f64, Failure> {
        let q = robot.assemble(&[q[0] + angle, q[1], q[2]], &[0])?;
        let v = robot.complete_velocity(q.as_slice(), &[v[0] + velocity, 0.0, 0.0], &[0])?;
        let tau = robot.generalized_forces(q.as_slice(), v.as_slice(), &[0.3])?;
        Ok(robot.forward_dynamics(q.as_slice(), v.as_slice(), tau.as_slice())?[0])
    };
    let found = robot.linearize_independent(q.as_slice(), v.as_slice(), &[0.3], &[0])?;
    let e = 1e-5;
    for (column, [angle, velocity]) in [(0, [e, 0.0]), (1, [0.0, e])] {
        let slope =
            (crank_acceleration(angle, velocity)? - crank_acceleration(-angle, -velocity)?) / (2.0 * e);
        let entry = found.a[(1, column)];
        assert!((slope - entry).abs() < 1e-5 * slope.abs().max(1.0), "{entry} instead of {slope}");
    }
    let robot = Loader::text(SLEIGH).load()?;
    let (q, v) = ([0.3, -0.2, 0.7], [0.7_f64.cos() * 1.2, 0.7_f64.sin() * 1.2, 0.8]);
    let own = Sleigh {}.linearize(&q.into(), &v.into(), &[0.5].into(), &[])?;
    let found = robot.linearize_independent(&q, &v, &[0.5], &[])?;
    assert_eq!((&*found.coordinates, &*found.velocities), (&own.coordinates[..], &own.speeds[..]));
    assert_eq!(found.a.shape(), (5, 5));
    assert!((found.a - linkwork::nalgebra::DMatrix::from_column_slice(5, 5, own.a.as_slice())).amax() < 1e-9);
    assert!((found.b - linkwork::nalgebra::DMatrix::from_column_slice(5, 1, own.b.as_slice())).amax() < 1e-9);
    Ok(())
}

/// Mechanisms without constraints or without derivatives, and slices of the wrong length, are errors.
#[test]
fn linear_systems_that_do_not_exist_are_errors() -> Result<(), Failure> {
    let robot = Loader::text(FOUR_BAR).options("derivatives").load()?;
    let error = robot.linearize_independent(&[0.0; 3], &[0.0; 2], &[0.0], &[]).expect_err("length");
    assert!(matches!(error, Error::Length { .. }), "{error}");
    let plain = Loader::text(TOP).load()?;
    let error = plain.linearize_independent(&[1.0, 0.0, 0.0, 0.0], &[0.0; 3], &[], &[]).expect_err("plain");
    assert!(error.to_string().contains("has no constraints"), "{error}");
    let without = Loader::text(&SLEIGH.replace("(derivatives)", "")).load()?;
    let error = without.linearize_independent(&[0.0; 3], &[0.0; 3], &[0.0], &[]).expect_err("no derivatives");
    assert!(error.to_string().contains("derivatives"), "{error}");
    Ok(())
}

/// Second derivatives of the accelerations of a linkage and of a top: compiled ones, also when padded.
#[test]
fn second_derivatives_of_accelerations_equal_compiled_ones() -> Result<(), Failure> {
    let robot = Loader::text(FOUR_BAR).load()?;
    let q = FourBar {}.assemble(&[0.9, -0.4, 1.2].into(), &[0])?;
    let v = FourBar {}.complete_velocity(&q, &[1.5, 0.0, 0.0].into(), &[0])?;
    compare_second_derivatives(&FourBar {}, &robot, &q, &v)?;
    let q = Top {}.integrate(&Top {}.neutral(), &sample(3));
    compare_second_derivatives(&Top {}, &Loader::text(TOP).load()?, &q, &sample(4))
}

fn compare_second_derivatives<M, const NQ: usize, const NV: usize, const NU: usize>(
    own: &M,
    robot: &Robot,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
) -> Result<(), Failure>
where
    M: SecondDerivatives<NQ, NV, NU, Scalar = f64>,
{
    let (tau, lambda) = (sample::<NV>(5) * 3.0, sample::<NV>(6));
    let expected = own.forward_dynamics_second_derivatives(0.0, q, v, &tau, &lambda);
    let f = robot.function("forward_dynamics_second_derivatives")?;
    let arguments = [q.as_slice(), v.as_slice(), tau.as_slice(), lambda.as_slice()];
    let found = robot.evaluate(&f, &arguments)?;
    let expected = [expected.0, expected.1, expected.2, expected.3];
    for (block, expected) in found.chunks(NV * NV).zip(expected) {
        let found = linkwork::nalgebra::SMatrix::<f64, NV, NV>::from_column_slice(block);
        assert_leading_block(&found, &expected, robot.name());
    }
    let m = robot.padded::<6, 5, 2>()?;
    let [q, v, tau, lambda] = arguments;
    let (q, v, tau, lambda) = (padded_vector(q), padded_vector(v), padded_vector(tau), padded_vector(lambda));
    let padded = m.forward_dynamics_second_derivatives(0.0, &q, &v, &tau, &lambda);
    assert_leading_block(&padded.0, &expected[0], robot.name());
    assert_leading_block(&padded.1, &expected[1], robot.name());
    // The motion under inputs, whose forces act along a joint.
    let u = sample::<2>(7);
    let motion = at(&m, 0.0).second_order_motion(&q, &v, &u, &lambda);
    let contracted_acceleration = |change: f64| {
        let mut v = v;
        v[0] += change;
        m.forward_dynamics(0.0, &q, &v, &m.generalized_forces(0.0, &q, &v, &u)).dot(&lambda)
    };
    let e = 1e-3;
    let difference = (contracted_acceleration(e) - 2.0 * contracted_acceleration(0.0)
        + contracted_acceleration(-e))
        / (e * e);
    assert!((difference - motion.2[(0, 0)]).abs() < 1e-5, "{difference} instead of {}", motion.2[(0, 0)]);
    Ok(())
}

/// Second derivatives of the acceleration of a crane's motion equal central differences of first ones.
#[test]
fn second_derivatives_of_accelerations_are_differences() -> Result<(), Error> {
    const CRANE: &str = "#[mechanism(gravity = -9.81 * y, second_derivatives)]
        struct Crane {
            #[body(mass = 2)]
            trolley: Body,
            #[body(mass = 0.5, com = -0.3 * y, inertia = rod(0.5, 0.6, y))]
            rope: Body,
            #[joint(ground -> trolley, along = x)]
            rail: Sleeve,
            #[joint(trolley -> rope, about = z)]
            swing: Pin,
        }";
    const N: usize = 2;
    let crane = Loader::text(CRANE).load()?;
    let f = crane.function("forward_dynamics_second_derivatives")?;
    assert_eq!(f.arguments(), [("q", N), ("v", N), ("tau", N), ("lambda", N)]);
    let (q, v, tau, lambda) = ([0.2, 0.7], [0.5, -1.1], [0.3, 0.9], [0.7, -0.2]);
    let found = crane.evaluate(&f, &[&q, &v, &tau, &lambda])?;
    let first = crane.function("forward_dynamics_derivatives")?;
    // λᵀ ∂v̇/∂q, λᵀ ∂v̇/∂v, λᵀ ∂v̇/∂τ.
    let contracted_acceleration_derivatives = |q: [f64; N], v: [f64; N]| -> Result<Vec<f64>, Error> {
        let all = crane.evaluate(&first, &[&q, &v, &tau])?;
        Ok(all.chunks(N).map(|column| column.iter().zip(&lambda).map(|(x, l)| x * l).sum()).collect())
    };
    let e = 1e-6;
    for j in 0..N {
        let with_displaced_entry = |mut x: [f64; N], change: f64| {
            x[j] += change;
            x
        };
        let central_differences = |ahead: Vec<f64>, behind: Vec<f64>| -> Vec<f64> {
            ahead.iter().zip(behind).map(|(a, b)| (a - b) / (2.0 * e)).collect()
        };
        let by_q = central_differences(
            contracted_acceleration_derivatives(with_displaced_entry(q, e), v)?,
            contracted_acceleration_derivatives(with_displaced_entry(q, -e), v)?,
        );
        let by_v = central_differences(
            contracted_acceleration_derivatives(q, with_displaced_entry(v, e))?,
            contracted_acceleration_derivatives(q, with_displaced_entry(v, -e))?,
        );
        for i in 0..N {
            // Blocks are ∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂τ, with rows for `q`.
            let second_derivative_entry =
                |block: usize, row: usize, column: usize| found[block * N * N + column * N + row];
            for (found, expected) in [
                (second_derivative_entry(0, i, j), by_q[i]),
                (second_derivative_entry(1, i, j), by_v[i]),
                (second_derivative_entry(1, j, i), by_q[N + i]),
                (second_derivative_entry(2, i, j), by_v[N + i]),
                (second_derivative_entry(3, j, i), by_q[2 * N + i]),
            ] {
                assert!((found - expected).abs() < 1e-7, "({i}, {j}): {found} instead of {expected}");
            }
        }
    }
    Ok(())
}

/// A mechanism without velocities has empty derivatives.
#[test]
fn derivatives_of_a_fixed_body_are_empty() -> Result<(), Error> {
    let fixed = Loader::text(
        "#[mechanism(second_derivatives)]
        struct Fixed {
            #[body(mass = 1)]
            block: Body,
            #[joint(ground -> block)]
            weld: Weld,
        }",
    )
    .load()?;
    for name in ["forward_dynamics_derivatives", "forward_dynamics_second_derivatives"] {
        let f = fixed.function(name)?;
        let arguments = vec![&[][..]; f.arguments().len()];
        assert!(fixed.evaluate(&f, &arguments)?.is_empty(), "{name}");
    }
    Ok(())
}
