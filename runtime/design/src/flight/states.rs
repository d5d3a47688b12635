//! Transformation from displacements in body axes to the usual states of an aircraft.

use crate::{Error, Signal, StateSpace, mechanism};
use linkwork::{Derivatives, Mechanism, Scleronomic};
use nalgebra::{DMatrix, Matrix3, Quaternion, SVector, UnitQuaternion};

/// States of longitudinal motion: forward and downward velocity, pitch rate, pitch angle, height.
pub const LONGITUDINAL: [&str; 5] = ["u", "w", "q", "theta", "h"];

/// States of lateral motion: sideways velocity, roll and yaw rate, bank angle.
pub const LATERAL: [&str; 4] = ["v", "p", "r", "phi"];

/// Names and units of the states of an aircraft, in the order of the free joint's velocities and
/// displacements. Horizontal position and heading are omitted.
const STATES: [(&str, &str); 9] = [
    ("u", "m/s"),
    ("v", "m/s"),
    ("w", "m/s"),
    ("p", "rad/s"),
    ("q", "rad/s"),
    ("r", "rad/s"),
    ("phi", "rad"),
    ("theta", "rad"),
    ("h", "m"),
];

/// Magnitude of accelerations and angular rates below which flight counts as steady, m/s², rad/s² and rad/s.
const STEADY: f64 = 1e-6;

/// Dependence on horizontal position or heading, relative to the largest entry of `A`, below which it is
/// rounding error.
const ROUNDING: f64 = 1e-9;

/// Suffixes of the velocity names of a free joint, linear before angular.
const FREE: [&str; 6] = [".vx", ".vy", ".vz", ".wx", ".wy", ".wz"];

/// Returns an error for a mechanism that does not begin with a free joint.
pub(super) fn check_begins_with_free_joint(velocities: &[&'static str]) -> Result<(), Error> {
    for (k, suffix) in FREE.iter().enumerate() {
        let name = velocities.get(k).copied().unwrap_or("nothing");
        if !name.ends_with(suffix) {
            let known = velocities.iter().map(|name| (*name).to_owned()).collect();
            return Err(Error::Unknown {
                kind: "velocity of a free joint",
                name: (*suffix).to_owned(),
                known,
            });
        }
    }
    Ok(())
}

/// Attitude of the airframe: its axes in the ground frame, and the matrix from body rates to rates of bank,
/// pitch angle and heading.
struct AirframeAttitude {
    axes: Matrix3<f64>,
    rates: Matrix3<f64>,
}

impl AirframeAttitude {
    fn attitude_from_configuration(q: &[f64]) -> Result<Self, Error> {
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(q[6], q[3], q[4], q[5]));
        let axes = turn.to_rotation_matrix().into_inner();
        let (sine, across) = (-axes[(2, 0)], axes[(2, 1)].hypot(axes[(2, 2)]));
        if across < 1e-6 {
            return Err(Error::Singular { what: "bank and heading of a nose straight up or down" });
        }
        let (s, c) = (axes[(2, 1)] / across, axes[(2, 2)] / across);
        let (tangent, secant) = (sine / across, 1.0 / across);
        let rates = Matrix3::new(1.0, s * tangent, c * tangent, 0.0, c, -s, 0.0, s * secant, c * secant);
        Ok(Self { axes, rates })
    }
}

/// Linearises the motion of an aircraft about steady flight as `ẋ = A x + B δu`. The states are the velocity
/// `u`, `v`, `w` and angular velocity `p`, `q`, `r` in forward, right and down axes, the bank angle `phi`,
/// the pitch angle `theta`, the height `h` (positive upward), then all other states of the mechanism. The
/// outputs are the states. For a mechanism with states of first order, pass `&at(&m.extended(), t)`.
///
/// In a climb through air whose properties depend on height, the result is valid at one instant.
///
/// # Errors
///
/// [`Error::NotSteady`] with the largest acceleration or rate of bank or pitch angle; [`Error::Unknown`] if
/// the first joint is not free; [`Error::Singular`] if the nose points straight up or down; [`Error::Range`]
/// if forces depend on horizontal position or heading.
pub fn linear_system<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    u: &SVector<f64, NU>,
) -> Result<StateSpace, Error>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64> + Scleronomic,
{
    check_begins_with_free_joint(&M::VELOCITIES)?;
    let attitude = AirframeAttitude::attitude_from_configuration(q.as_slice())?;
    let forces = Mechanism::generalized_forces(m, 0.0, q, v, u);
    let acceleration = Mechanism::forward_dynamics(m, 0.0, q, v, &forces);
    let turning = attitude.rates * v.fixed_rows::<3>(3);
    let angles = [("bank'".to_owned(), turning[0]), ("pitch angle'".to_owned(), turning[1])];
    let names = mechanism::acceleration_names::<M, NQ, NV, NU>();
    let rates = names.into_iter().zip(acceleration.iter().copied()).chain(angles);
    let worst = rates.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    if let Some((what, rate)) = worst.filter(|(_, rate)| !rate.is_finite() || rate.abs() > STEADY) {
        return Err(Error::NotSteady { what, rate });
    }
    let system = mechanism::linear_system(m, q, v, u)?;
    system_in_flight_states(&system, &attitude, NV - M::FIRST_ORDER)
}

fn system_in_flight_states(
    system: &StateSpace,
    attitude: &AirframeAttitude,
    displacements: usize,
) -> Result<StateSpace, Error> {
    let n = system.order();
    let (mut to, mut from) = (DMatrix::identity(n, n), DMatrix::identity(n, n));
    let singular = Error::Singular { what: "rates of bank, pitch and heading" };
    let back = attitude.rates.try_inverse().ok_or(singular)?;
    to.view_mut((0, 0), (3, 3)).copy_from(&attitude.axes);
    from.view_mut((0, 0), (3, 3)).copy_from(&attitude.axes.transpose());
    to.view_mut((3, 3), (3, 3)).copy_from(&attitude.rates);
    from.view_mut((3, 3), (3, 3)).copy_from(&back);
    // Height is positive upward, the position downward.
    to.row_mut(2).neg_mut();
    from.column_mut(2).neg_mut();
    let (a, b) = (&to * system.a() * from, &to * system.b());
    // Velocities, bank angle, pitch angle, height, then other displacements and velocities.
    let own = displacements..displacements + 6;
    let rest = (6..displacements).chain(displacements + 6..n);
    let kept: Vec<usize> = own.chain([3, 4, 2]).chain(rest.clone()).collect();
    for left_out in [0, 1, 5] {
        let most = kept.iter().map(|k| a[(*k, left_out)].abs()).fold(0.0, f64::max);
        if most > ROUNDING * a.amax() {
            return Err(Error::Range { what: "a dependence of the motion on place or heading", value: most });
        }
    }
    let names = STATES.map(Signal::from).into_iter().chain(rest.map(|k| system.states()[k].clone()));
    let count = kept.len();
    let (a, b) = (a.select_rows(&kept).select_columns(&kept), b.select_rows(&kept));
    let found =
        StateSpace::new(a, b, DMatrix::identity(count, count), DMatrix::zeros(count, system.b().ncols()))?;
    Ok(found.with_states(names)?.with_inputs(system.inputs().to_vec())?.with_states_as_outputs())
}
