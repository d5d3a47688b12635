//! Checks of extended Kalman filters for the state of a load on a ball joint with an inertial measurement
//! unit. Observable components converge, unobservable ones keep their error, and errors agree with the
//! covariance of the filter.

use linkwork::nalgebra::{SMatrix, SVector, UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork::{Derivatives, OutputDerivatives, Outputs, discrete};
use support::random::Random;
use support::with_common_fields;

with_common_fields! {
    {
        #[body(mass = 1.5, com = -0.8 * z, inertia = diagonal(0.02, 0.03, 0.01))]
        load: Body,
        #[joint(ground -> load)]
        hook: Ball,
        #[output(omega(load / ground), resolved_in = load)]
        gyroscope: Vector,
        #[output(a(load.at(0.1 * x - 0.8 * z) / ground / ground) + 9.81 * z, resolved_in = load)]
        accelerometer: Vector,
    }

    /// Load that swings and rotates on a ball joint, with a gyroscope and an accelerometer.
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct LoadWithInertialSensors {}

    /// Load on a ball joint with a gyroscope, an accelerometer and a compass.
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct LoadWithCompass {
        #[output(ground.x, resolved_in = load)]
        compass: Vector,
    }
}

const PERIOD: f64 = 0.01;
/// Variances of the sensor noise, and of the random changes of velocity in each period.
const NOISE: f64 = 1e-4;
const GUSTS: f64 = 1e-6;
/// Maximum number of linearisations in one correction of the iterated filter.
const MOST: usize = 20;

/// Estimate of the state with the covariance of its error: displacements first, then velocities.
struct Belief {
    q: SVector<f64, 4>,
    v: SVector<f64, 3>,
    spread: SMatrix<f64, 6, 6>,
}

/// Runs one period of the iterated extended Kalman filter. The correction is linearised again at its own
/// result until the result changes no more, which finds the most likely state also from a distant prediction
/// (Bell and Cathey, *The iterated Kalman filter update as a Gauss-Newton method*, 1993).
fn predict_and_correct_belief<M, const NY: usize>(m: &M, belief: &mut Belief, y: &SVector<f64, NY>)
where
    M: Derivatives<4, 3, 0, Scalar = f64> + OutputDerivatives<4, 3, 0, NY, Scalar = f64>,
{
    let u = SVector::from([]);
    let step = discrete::transition(m, &Rk4::step(PERIOD), 0.0, &belief.q, &belief.v, &u).unwrap();
    let a = step.a::<6>();
    let mut spread = a * belief.spread * a.transpose();
    (3..6).for_each(|k| spread[(k, k)] += GUSTS);
    // The unknown is a displacement from the prediction.
    let mut x = SVector::<f64, 6>::zeros();
    let (mut gain, mut c) = (SMatrix::<f64, 6, NY>::zeros(), SMatrix::<f64, NY, 6>::zeros());
    let mut moved = SMatrix::<f64, 6, 6>::identity();
    for _ in 0..MOST {
        let (dq, dv) = discrete::split(&x);
        (belief.q, belief.v) = (m.integrate(&step.q, &dq), step.v + dv);
        let motion = at(m, 0.0).linear_motion(&belief.q, &belief.v, &u);
        let (q, v, a) = (&belief.q, &belief.v, &motion.acceleration);
        let seen = m.output_derivatives(0.0, q, v, a, &u).in_motion(&motion);
        // Derivative of the displaced state, in its own axes, with respect to the displacement.
        moved.fixed_view_mut::<3, 3>(0, 0).copy_from(&m.integrate_derivatives(&dq).1);
        c = seen.c::<6>() * moved;
        let innovation = c * spread * c.transpose() + SMatrix::identity() * NOISE;
        gain = spread * c.transpose() * innovation.try_inverse().unwrap();
        let next = gain * (y - m.outputs(0.0, q, v, a, &u) + c * x);
        let settled = (next - x).amax() < 1e-9;
        x = next;
        if settled {
            break;
        }
    }
    let kept = SMatrix::<f64, 6, 6>::identity() - gain * c;
    let updated = kept * spread * kept.transpose() + gain * gain.transpose() * NOISE;
    belief.spread = moved * updated * moved.transpose();
}

/// Returns approximately normal random numbers: each is the sum of twelve uniform numbers (Irwin and Hall).
fn random_gaussian_vector<const N: usize>(random: &mut Random, variance: f64) -> SVector<f64, N> {
    SVector::from_fn(|_, _| (0..12).map(|_| random.uniform_number(0.5)).sum::<f64>() * variance.sqrt())
}

/// Runs the filter for `duration` seconds from an initial error with standard deviation `off`. Returns the
/// displacement from the estimate to the true state (configuration, then velocity), the last estimate and the
/// last true configuration.
fn run_estimation_filter<M, const NY: usize>(
    m: &M,
    random: &mut Random,
    off: f64,
    duration: f64,
    gusts: f64,
) -> (SVector<f64, 6>, Belief, SVector<f64, 4>)
where
    M: Derivatives<4, 3, 0, Scalar = f64>
        + OutputDerivatives<4, 3, 0, NY, Scalar = f64>
        + Outputs<4, 3, 0, NY, Scalar = f64>,
{
    let u = SVector::from([]);
    let mut q = m.integrate(&m.neutral(), &[0.4, -0.3, 0.7].into());
    let mut v: SVector<f64, 3> = [0.5, 0.8, 1.5].into();
    let error = random_gaussian_vector::<6>(random, off * off);
    let (dq, dv) = discrete::split(&error);
    let mut belief =
        Belief { q: m.integrate(&q, &-dq), v: v - dv, spread: SMatrix::identity() * (off * off) };
    for _ in 0..(duration / PERIOD) as usize {
        (q, v) = discrete::step(m, &Rk4::step(PERIOD), 0.0, &q, &v, &u).unwrap();
        v += random_gaussian_vector::<3>(random, gusts);
        let a = m.forward_dynamics(0.0, &q, &v, &SVector::zeros());
        let y: SVector<f64, NY> =
            m.outputs(0.0, &q, &v, &a, &u) + random_gaussian_vector::<NY>(random, gusts / GUSTS * NOISE);
        predict_and_correct_belief(m, &mut belief, &y);
    }
    let left = discrete::stacked(&m.difference(&belief.q, &q), &(v - belief.v));
    (left, belief, q)
}

/// Checks that with a compass the filter finds the whole state, from errors with standard deviations of 0.3
/// rad and 0.3 rad/s.
#[test]
fn filter_estimates_a_load_on_a_ball_joint() {
    for seed in 0..5 {
        let (left, ..) =
            run_estimation_filter::<_, 9>(&LoadWithCompass {}, &mut Random::new(seed), 0.3, 2.0, 0.0);
        assert!(left.amax() < 1e-3, "{seed}: {left}");
    }
}

/// Gyroscope and accelerometer do not observe the heading of the load about the vertical. All other
/// components converge; the heading keeps its error, and the filter's covariance shows that.
#[test]
fn heading_is_unobservable_without_a_compass() {
    for seed in 0..5 {
        let off = 0.3;
        let (left, belief, q) =
            run_estimation_filter::<_, 6>(&LoadWithInertialSensors {}, &mut Random::new(seed), off, 2.0, 0.0);
        let attitude = UnitQuaternion::from_quaternion([q[0], q[1], q[2], q[3]].into());
        let up = attitude.inverse_transform_vector(&Vector3::z());
        let turned = left.fixed_rows::<3>(0).into_owned();
        let heading = turned.dot(&up);
        let tilt = turned - up * heading;
        assert!(tilt.amax() < 5e-3 && left.fixed_rows::<3>(3).amax() < 5e-3, "{seed}: {left}");
        let spread = up.dot(&(belief.spread.fixed_view::<3, 3>(0, 0) * up)).sqrt();
        assert!(spread > 0.5 * off && heading.abs() < 3.0 * off, "{seed}: {heading} {spread}");
    }
}

/// The errors agree with the filter's covariance: the mean of `eᵀ P⁻¹ e` is the number of unknowns
/// (Bar-Shalom, Li and Kirubarajan, *Estimation with applications to tracking and navigation*, 2001, § 5.4).
#[test]
fn filter_errors_agree_with_the_covariance() {
    const RUNS: u64 = 30;
    let mut sum = 0.0;
    for seed in 0..RUNS {
        let (left, belief, _) =
            run_estimation_filter::<_, 9>(&LoadWithCompass {}, &mut Random::new(100 + seed), 0.1, 1.0, GUSTS);
        sum += left.dot(&(belief.spread.try_inverse().unwrap() * left));
    }
    // The mean of 30 chi-square values with six degrees of freedom is within 3.3 standard deviations in 99.9
    // % of cases.
    let mean = sum / RUNS as f64;
    assert!((mean - 6.0).abs() < 3.3 * (12.0 / RUNS as f64).sqrt(), "{mean}");
}
