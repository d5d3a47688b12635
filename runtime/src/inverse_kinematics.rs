//! Inverse kinematics: a configuration in which one or several frames reach target poses, within the joint
//! limits.
//!
//! [`InverseKinematics::reach`] minimises the weighted squares of the pose errors by the Levenberg–Marquardt
//! method on the configuration manifold (Sugihara, *Solvability-unconcerned inverse kinematics by the
//! Levenberg–Marquardt method*, IEEE Transactions on Robotics 27, 2011). Coordinates that would exceed their
//! [`Limits`] are fixed at them. Redundant degrees of freedom remain near a posture. The solver allocates no
//! memory, and the number of iterations is bounded: each evaluates the placement and the Jacobian of every
//! target, and solves `NV` linear equations.
//!
//! ```
//! use linkwork::inverse_kinematics::{InverseKinematics, Target};
//! use linkwork::prelude::*;
//!
//! #[mechanism(urdf = "../models/urdf/ur5.urdf")]
//! pub struct Ur5;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // The placement of the tool in some configuration is reachable.
//! let placement = Ur5.frame_placement(frame!(Ur5, "tool0"), &[0.4, -1.2, 1.5, -0.6, 1.3, 0.2].into());
//! let target = Target::pose(index!(Ur5::FRAMES, "tool0"), placement);
//! let start = [0.0, -1.0, 1.0, 0.0, 1.0, 0.0].into();
//! let found = InverseKinematics::new().reach(&Ur5, 0.0, &[target], &start)?;
//! let reached = Ur5.frame_placement(frame!(Ur5, "tool0"), &found.q);
//! assert!((reached.translation.vector - placement.translation.vector).norm() < 1e-6);
//! assert!((reached.rotation.matrix() - placement.rotation.matrix()).amax() < 1e-6);
//! # Ok(())
//! # }
//! ```

use crate::blocks::{add_product, factors, product, solve, transposed, zeros};
use crate::limits::at_least;
use crate::private::{constant, to_f64};
use crate::{Frames, Limits, Mechanism, Real, placement_difference};
use nalgebra::{IsometryMatrix3, SMatrix, SVector};

/// Target pose of a frame for inverse kinematics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<T: Real> {
    /// Index of the frame in the list of frames: `index!(Arm::FRAMES, "tool")`, or
    /// [`index_of`](crate::index_of) for a name that is known only at run time.
    pub frame: usize,
    /// Target placement in the ground frame: axes, and origin, m.
    pub placement: IsometryMatrix3<T>,
    /// Weight of the distance, 1/m; zero if the position does not matter.
    pub position: T,
    /// Weight of the angle, 1/rad; zero if the orientation does not matter.
    pub orientation: T,
}

impl<T: Real> Target<T> {
    /// Returns a target of position and orientation for a frame. One metre of position error has the same
    /// weight as one radian of orientation error.
    pub fn pose(frame: usize, placement: IsometryMatrix3<T>) -> Self {
        Self { frame, placement, position: T::one(), orientation: T::one() }
    }

    /// Returns a target for the position of a frame alone, m.
    pub fn position(frame: usize, position: SVector<T, 3>) -> Self {
        let placement = IsometryMatrix3::from_parts(position.into(), nalgebra::Rotation3::identity());
        Self { frame, placement, position: T::one(), orientation: T::zero() }
    }
}

/// Result of inverse kinematics whose configuration reaches all targets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached<T, const NQ: usize> {
    /// Configuration that reaches the targets.
    pub q: SVector<T, NQ>,
    /// Number of iterations that the solver took.
    pub iterations: usize,
}

/// Error for targets of inverse kinematics that were not reached.
#[derive(Clone, Copy, PartialEq)]
pub enum Unreached<T, const NQ: usize> {
    /// Error: the index of a target's frame is out of range.
    UnknownFrame {
        /// Index of the target whose frame does not exist.
        target: usize,
    },
    /// Error: a weight or a placement of a target, or the placement of its frame at the start, is not finite,
    /// or a weight is negative.
    NotFinite {
        /// Index of the target that is not finite or has a negative weight.
        target: usize,
    },
    /// Error: the targets are out of reach, contradict each other, or are separated from this start by joint
    /// limits.
    OutOfReach {
        /// Configuration nearest to the targets that the solver found.
        q: SVector<T, NQ>,
        /// Largest position error in `q` over the targets with nonzero position weight, m.
        position: f64,
        /// Largest orientation error in `q` over the targets with nonzero orientation weight, rad.
        orientation: f64,
        /// Number of iterations that the solver took.
        iterations: usize,
    },
}

/// Prints the text of `Display`, because `main` prints a returned error with `Debug`.
impl<T, const NQ: usize> core::fmt::Debug for Unreached<T, NQ> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        core::fmt::Display::fmt(self, f)
    }
}

impl<T, const NQ: usize> core::fmt::Display for Unreached<T, NQ> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::UnknownFrame { target } => write!(f, "target {target} names a frame that does not exist"),
            Self::NotFinite { target } => {
                write!(
                    f,
                    "target {target} has a weight that is negative, or a weight or a placement that is not \
                     finite"
                )
            }
            Self::OutOfReach { position, orientation, iterations, .. } => write!(
                f,
                "the targets were not reached in {iterations} iterations: {position:.3e} m and \
                 {orientation:.3e} rad are left"
            ),
        }
    }
}

impl<T, const NQ: usize> core::error::Error for Unreached<T, NQ> {}

/// Settings of the inverse-kinematics solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InverseKinematics<T> {
    /// Position error below which a target counts as reached, m.
    pub position: T,
    /// Orientation error below which a target counts as reached, rad.
    pub orientation: T,
    /// Maximum number of iterations of the solver.
    pub iterations: usize,
}

impl<T: Real> Default for InverseKinematics<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// Weight of the attraction to the initial posture, relative to the targets. It decreases with the pose
/// errors, so that it does not prevent convergence to the targets.
const PULL: f64 = 1e-3;

/// Pose errors of all targets; the field `cost` is half of the sum of their weighted squares.
struct PoseErrors<T, const NV: usize> {
    cost: T,
    position: T,
    orientation: T,
    /// Gradient `Jᵀ W e` of the costs, with Jacobian `J`, weights `W` and pose errors `e`. The field `normal`
    /// is the matrix `Jᵀ W J`.
    gradient: SVector<T, NV>,
    normal: SMatrix<T, NV, NV>,
}

impl<T: Real> InverseKinematics<T> {
    /// Returns a solver with tolerances of a millionth of a metre and of a radian, and at most 100
    /// iterations.
    pub fn new() -> Self {
        Self { position: constant(1e-6), orientation: constant(1e-6), iterations: 100 }
    }

    /// Returns a configuration in which the frames reach their targets, at time `t`, s (which matters only
    /// for driven motion). The search begins at `start`, clamped to the limits; redundant degrees of freedom
    /// remain near `start`.
    ///
    /// # Errors
    ///
    /// [`Unreached`] contains the index of an invalid target, or the pose errors after the last iteration.
    pub fn reach<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        mechanism: &M,
        t: T,
        targets: &[Target<T>],
        start: &SVector<T, NQ>,
    ) -> Result<Reached<T, NQ>, Unreached<T, NQ>>
    where
        M: Mechanism<NQ, NV, NU, Scalar = T> + Frames<NQ, NV, Scalar = T> + Limits<NQ, NV, Scalar = T>,
    {
        let mut q = mechanism.clamp_configuration(start);
        let mut left = self.pose_errors_of_targets(mechanism, t, targets, &q)?;
        let (mut damping, mut pull) = (constant::<T>(1e-3), constant::<T>(PULL));
        for iterations in 0..=self.iterations {
            if left.position <= self.position && left.orientation <= self.orientation {
                return Ok(Reached { q, iterations });
            }
            if iterations == self.iterations {
                break;
            }
            let posture = mechanism.difference(&q, start) * (pull * left.cost);
            let step = levenberg_marquardt_step(mechanism, &q, &left, (damping + pull) * left.cost, &posture);
            let tried = mechanism.clamp_configuration(&mechanism.integrate(&q, &step));
            let next = self.pose_errors_of_targets(mechanism, t, targets, &tried)?;
            if next.cost < left.cost {
                (q, left) = (tried, next);
                damping = at_least(damping * constant(0.3), constant(1e-9));
                pull = constant(PULL);
            } else {
                // If the attraction to the posture increases the pose errors, only the targets count.
                damping *= constant(8.0);
                pull = T::zero();
            }
        }
        let (position, orientation) = (to_f64(left.position), to_f64(left.orientation));
        Err(Unreached::OutOfReach { q, position, orientation, iterations: self.iterations })
    }

    fn pose_errors_of_targets<M, const NQ: usize, const NV: usize>(
        &self,
        mechanism: &M,
        t: T,
        targets: &[Target<T>],
        q: &SVector<T, NQ>,
    ) -> Result<PoseErrors<T, NV>, Unreached<T, NQ>>
    where
        M: Frames<NQ, NV, Scalar = T>,
    {
        let zero = T::zero();
        let mut left =
            PoseErrors { cost: zero, position: zero, orientation: zero, gradient: zeros(), normal: zeros() };
        for (target, wanted) in targets.iter().enumerate() {
            let found =
                mechanism.placement_of(wanted.frame, t, q).zip(mechanism.jacobian_of(wanted.frame, t, q));
            let Some((placement, mut jacobian)) = found else {
                return Err(Unreached::UnknownFrame { target });
            };
            let missing = placement_difference(&placement, &wanted.placement);
            let weights = [wanted.position, wanted.orientation];
            let mut error = missing;
            for (k, entry) in error.iter_mut().enumerate() {
                *entry *= weights[k / 3];
            }
            let cost = error.norm_squared() * constant(0.5);
            if !cost.is_finite() || weights.iter().any(|w| *w < zero) {
                return Err(Unreached::NotFinite { target });
            }
            for column in &mut jacobian.data.0 {
                for (k, entry) in column.iter_mut().enumerate() {
                    *entry *= weights[k / 3];
                }
            }
            let rows = transposed(&jacobian);
            add_product(&mut left.gradient, &rows, &error);
            add_product(&mut left.normal, &rows, &jacobian);
            left.cost += cost;
            if weights[0] > zero {
                left.position = at_least(left.position, missing.fixed_rows::<3>(0).norm());
            }
            if weights[1] > zero {
                left.orientation = at_least(left.orientation, missing.fixed_rows::<3>(3).norm());
            }
        }
        Ok(left)
    }
}

/// Returns the Levenberg–Marquardt step, `(JᵀWJ + μ) dq = JᵀWe + posture`; coordinates that it would move
/// beyond their limits are fixed.
fn levenberg_marquardt_step<M, T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    q: &SVector<T, NQ>,
    left: &PoseErrors<T, NV>,
    damping: T,
    posture: &SVector<T, NV>,
) -> SVector<T, NV>
where
    M: Mechanism<NQ, NV, NU, Scalar = T> + Limits<NQ, NV, Scalar = T>,
{
    // Plain coordinates are displacements from zero; others have no limits.
    let (at, of_rates) = match mechanism.limited_coordinates(q) {
        Some((at, of_rates)) => (at, Some(of_rates)),
        None => (mechanism.difference(&mechanism.neutral(), q), None),
    };
    let (lower, upper) = (mechanism.lower_limits(), mechanism.upper_limits());
    let damping = at_least(damping, constant(1e-12));
    let (mut normal, mut right) = (left.normal, left.gradient + posture);
    for k in 0..NV {
        normal[(k, k)] += damping;
    }
    if let Some(of_rates) = &of_rates {
        let rows = transposed(of_rates);
        (normal, right) = (product(&product(&rows, &normal), of_rates), rows * right);
    }
    let mut held = [false; NV];
    // Each round fixes at least one more coordinate.
    for _ in 0..=NV {
        let mut step = -right;
        let Ok((factor, pivots)) = factors(&normal, T::zero()) else { return SVector::zeros() };
        solve(&factor, &pivots, &mut step);
        let mut more = false;
        for k in 0..NV {
            let beyond =
                (at[k] >= upper[k] && step[k] > T::zero()) || (at[k] <= lower[k] && step[k] < T::zero());
            if beyond && !held[k] {
                (held[k], more) = (true, true);
                for i in 0..NV {
                    normal[(i, k)] = T::zero();
                    normal[(k, i)] = T::zero();
                }
                (normal[(k, k)], right[k]) = (T::one(), T::zero());
            }
        }
        if !more {
            return of_rates.map_or(step, |of_rates| of_rates * step);
        }
    }
    SVector::zeros()
}
