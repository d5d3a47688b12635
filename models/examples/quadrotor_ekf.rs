//! Extended Kalman filter of a quadrotor in gusts, from its inertial measurement unit and five position fixes
//! per second. It uses the generated Jacobians of the step and of the sensors. The quadrotor is controlled by
//! the filter's estimate.
//!
//! The state is a pose and a velocity. Covariances are those of displacements and velocities in the
//! quadrotor's axes (twelve numbers), so that no quaternion is estimated directly. In still air an
//! accelerometer measures the drag, which makes the tilt observable (Martin and Salaün, *The true role of
//! accelerometer feedback in quadrotor control*, ICRA 2010).
//!
//! ```text
//! cargo run --release --example quadrotor_ekf -p linkwork-models
//! ```

mod regulator;

use linkwork::optimal::{Policy, Quadratic};
use linkwork::prelude::*;
use linkwork::{OutputDerivatives, Outputs, discrete};
use regulator::linear_quadratic_regulator;
use std::ops::Range;

/// Quadrotor with the thrust of each rotor, N, as an input, and a gyroscope and an accelerometer off the
/// centre of mass.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct Quadrotor {
    front: Input,
    left: Input,
    back: Input,
    right: Input,

    #[body(mass = 1, inertia = diagonal(0.01, 0.01, 0.018))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[acts(on = hull, value = (front + left + back + right) * hull.z)]
    lift: Force,
    #[acts(
        on = hull,
        value = 0.2 * (left - right) * hull.x + 0.2 * (back - front) * hull.y
            + 0.02 * (front - left + back - right) * hull.z
    )]
    turn: Torque,
    #[acts(on = hull, value = -0.4 * v(hull / ground / ground))]
    drag: Force,

    #[output(omega(hull / ground), resolved_in = hull)]
    gyroscope: Vector,
    #[output(a(hull.at(0.05 * x) / ground / ground) + 9.81 * z, resolved_in = hull)]
    accelerometer: Vector,
    #[output(r(hull / ground))]
    position: Vector,
}

type Pose = SVector<f64, { Quadrotor::NQ }>;
type Twist = SVector<f64, { Quadrotor::NV }>;
type Thrusts = SVector<f64, { Quadrotor::NU }>;
/// Error of the estimated state: displacement, then velocity.
type StateError = SVector<f64, 12>;
type Measurements = SVector<f64, 9>;

/// Period of the controller and of the measurements, s. The constant `METHOD` is the integrator of a period.
const PERIOD: f64 = 0.01;
const METHOD: Rk4<f64> = Rk4::step(PERIOD);
/// Standard deviations of the changes of linear and angular velocity by gusts in a period, m/s and rad/s.
const GUSTS: [f64; 2] = [0.02, 0.02];
/// Standard deviations of the measurements: rates, rad/s; accelerations, m/s²; position, m.
const NOISE: [f64; 3] = [0.01, 0.1, 0.1];
const UNIT: Range<usize> = 0..6;
const FIX: Range<usize> = 6..9;

/// Random numbers with a standard normal distribution (splitmix64; Box and Muller).
struct RandomNumbers(u64);

impl RandomNumbers {
    fn uniform_number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((bits ^ (bits >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn normal_number(&mut self) -> f64 {
        (-2.0 * self.uniform_number().ln()).sqrt() * (std::f64::consts::TAU * self.uniform_number()).cos()
    }
}

/// Estimate of the state with the covariance of its displacements and velocities.
struct StateEstimate {
    q: Pose,
    v: Twist,
    spread: SMatrix<f64, 12, 12>,
}

impl StateEstimate {
    /// Predicts the estimate over one period, with the uncertainty due to gusts.
    fn predict_estimate(&mut self, u: &Thrusts) -> Result<(), Error> {
        let next = discrete::transition(&Quadrotor {}, &METHOD, 0.0, &self.q, &self.v, u)?;
        let a = next.a::<12>();
        self.spread = a * self.spread * a.transpose();
        for (k, deviation) in [(6, GUSTS[0]), (9, GUSTS[1])] {
            (k..k + 3).for_each(|i| self.spread[(i, i)] += deviation * deviation);
        }
        (self.q, self.v) = (next.q, next.v);
        Ok(())
    }

    /// Corrects the estimate with the measured outputs of `rows`, one scalar after the other.
    fn correct_estimate(&mut self, u: &Thrusts, measured: &Measurements, rows: Range<usize>) {
        let (m, q, v) = (Quadrotor {}, self.q, self.v);
        let motion = m.linear_motion(&q, &v, u);
        let seen = m.output_derivatives(0.0, &q, &v, &motion.acceleration, u).in_motion(&motion);
        let (c, expected) = (seen.c::<12>(), m.outputs(0.0, &q, &v, &motion.acceleration, u));
        let mut x = StateError::zeros();
        for row in rows {
            let c = c.row(row);
            let shared = self.spread * c.transpose();
            let gain = shared / ((c * shared)[0] + NOISE[row / 3].powi(2));
            x += gain * (measured[row] - expected[row] - (c * x)[0]);
            self.spread -= gain * shared.transpose();
        }
        let (dq, dv) = discrete::split(&x);
        (self.q, self.v) = (m.integrate(&q, &dq), v + dv);
    }

    /// Returns the error of the estimate relative to the true state.
    fn error_of_estimate(&self, q: &Pose, v: &Twist) -> StateError {
        discrete::stacked(&Quadrotor {}.difference(&self.q, q), &(v - self.v))
    }
}

/// Returns the thrusts for hovering, and a regulator that stabilises it.
fn hover_regulator() -> Option<(Thrusts, Policy<f64, 6, 4>)> {
    let thrusts = Thrusts::repeat(9.81 / 4.0);
    let costs = Quadratic {
        qq: SMatrix::from_diagonal(&[4.0, 4.0, 4.0, 1.0, 1.0, 1.0].into()),
        vv: SMatrix::from_diagonal_element(0.5),
        uu: SMatrix::from_diagonal_element(1.0),
        ..Quadratic::zeros()
    };
    let (regulator, _) =
        linear_quadratic_regulator(&Quadrotor {}, &METHOD, &Quadrotor {}.neutral(), &thrusts, &costs)?;
    Some((thrusts, regulator))
}

/// Returns the thrusts for the estimated state, towards a moving point on a circle.
fn steering_thrusts(hover: &(Thrusts, Policy<f64, 6, 4>), t: f64, belief: &StateEstimate) -> Thrusts {
    let (sin, cos) = (0.8 * t).sin_cos();
    let (target, speed) = ([2.0 * cos, 2.0 * sin, 1.0], [-1.6 * sin, 1.6 * cos, 0.0]);
    let pose = Quadrotor {}
        .integrate(&Quadrotor {}.neutral(), &[target[0], target[1], target[2], 0.0, 0.0, 0.0].into());
    let dv = belief.v - Twist::from([speed[0], speed[1], speed[2], 0.0, 0.0, 0.0]);
    hover.0 + hover.1.inputs(1.0, &Quadrotor {}.difference(&pose, &belief.q), &dv)
}

/// Mean squared errors of the estimate during a flight.
#[derive(Default)]
struct MeanSquaredFlightErrors {
    position: f64,
    tilt: f64,
    speed: f64,
    /// Squared error of the estimate, normalised by its covariance: 12 for a consistent filter.
    normalised: f64,
}

/// Simulates a flight of some seconds, and prints it if requested.
fn simulate_flight(seed: u64, seconds: f64, print: bool) -> Result<MeanSquaredFlightErrors, Error> {
    let (m, mut random) = (Quadrotor {}, RandomNumbers(seed));
    let hover = hover_regulator().expect("four rotors can keep it in its place");
    // The true initial state deviates randomly from the estimate.
    let deviations = StateError::from_fn(|k, _| [0.3, 0.15, 0.3, 0.1][k / 3]);
    let off = deviations.map(|deviation| deviation * random.normal_number());
    let start = m.integrate(&m.neutral(), &[2.0, 0.0, 1.0, 0.0, 0.0, 0.0].into());
    let mut belief = StateEstimate {
        q: start,
        v: Twist::zeros(),
        spread: SMatrix::from_diagonal(&deviations.map(|x| x * x)),
    };
    let (dq, dv) = discrete::split(&off);
    let (mut q, mut v) = (m.integrate(&start, &dq), dv);

    let (steps, mut sum) = ((seconds / PERIOD) as usize, MeanSquaredFlightErrors::default());
    for k in 0..steps {
        let t = PERIOD * k as f64;
        let u = steering_thrusts(&hover, t, &belief);
        (q, v) = discrete::step(&m, &METHOD, 0.0, &q, &v, &u)?;
        v += Twist::from_fn(|i, _| GUSTS[i / 3] * random.normal_number());
        let a = m.forward_dynamics(&q, &v, &m.generalized_forces(&q, &u));
        let measured = m.outputs(0.0, &q, &v, &a, &u)
            + Measurements::from_fn(|i, _| NOISE[i / 3] * random.normal_number());

        belief.predict_estimate(&u)?;
        belief.correct_estimate(&u, &measured, UNIT);
        if k % 20 == 0 {
            belief.correct_estimate(&u, &measured, FIX);
        }

        let error = belief.error_of_estimate(&q, &v);
        let [position, tilt, speed] = [0, 3, 6].map(|i| error.fixed_rows::<3>(i).norm());
        let normalised = belief.spread.cholesky().map_or(f64::NAN, |factor| error.dot(&factor.solve(&error)));
        if print && k % 50 == 0 {
            println!(
                "{t:6.2} {:8.2} {:6.2} {:6.2} {position:12.3} {tilt:12.3} {speed:12.3} {normalised:10.1}",
                q[0], q[1], q[2]
            );
        }
        sum.position += position * position / steps as f64;
        sum.tilt += tilt * tilt / steps as f64;
        sum.speed += speed * speed / steps as f64;
        sum.normalised += normalised / steps as f64;
    }
    Ok(sum)
}

fn main() -> Result<(), Error> {
    println!(
        "  t, s     x, m   y, m   z, m   off by, m   turned, rad   by, m/s   squared error by its spread"
    );
    let flights =
        [simulate_flight(1, 5.0, true)?, simulate_flight(2, 5.0, false)?, simulate_flight(3, 5.0, false)?];
    let mean_over_flights = |figure: fn(&MeanSquaredFlightErrors) -> f64| {
        flights.iter().map(figure).sum::<f64>() / flights.len() as f64
    };
    let [position, tilt, speed] =
        [mean_over_flights(|f| f.position), mean_over_flights(|f| f.tilt), mean_over_flights(|f| f.speed)]
            .map(f64::sqrt);
    let normalised = mean_over_flights(|f| f.normalised);
    println!(
        "\nof three flights: {position:.3} m, {tilt:.3} rad, {speed:.3} m/s; {normalised:.1} by the spread, \
         of 12"
    );

    // A position fix alone has an error of 0.17 m, √3 times its deviation along each axis.
    assert!(position < 0.17 && tilt < 0.1 && speed < 0.2, "the filter knows better than its sensors");
    assert!((normalised - 12.0).abs() < 3.0, "and it knows how well");
    Ok(())
}

#[test]
fn filter_estimates_the_flight() -> Result<(), Error> {
    main()
}
