//! Rotations and their rates: Euler angles, quaternions, rotation vectors and other parameters.
//!
//! Euler angles of all 24 sequences, rotation vectors, Euler parameters, Gibbs and modified Rodrigues
//! vectors, their conversions and their rate kinematics, on nalgebra's [`Rotation3`](nalgebra::Rotation3) and
//! [`UnitQuaternion`](nalgebra::UnitQuaternion). These types serve user code; mechanisms do not need them.
//!
//! | parameters | type | cannot represent | rates fail |
//! | --- | --- | --- | --- |
//! | rotation matrix | `Rotation3` | | nowhere: [`rotation_rate_from_body`] |
//! | Euler angles | [`EulerSequence`] with `[T; 3]` | | first axis parallel to the third |
//! | Euler parameters | `UnitQuaternion` | | nowhere: [`quaternion_rate_from_body`] |
//! | rotation vector | [`RotationVector`] | | full turns, but not zero |
//! | Gibbs vector | [`Gibbs`] | half a turn | nowhere |
//! | modified Rodrigues vector | [`Mrp`] | a full turn | nowhere |
//!
//! **Conventions.** Angles in rad, angular velocities in rad/s. The columns of a rotation matrix `R` are the
//! body axes in space axes: `v_space = R v_body`. Angular velocities are of the body relative to space,
//! resolved in body axes (`…_body`) or in space axes (`…_space`), with `ω_space = R ω_body`. The product `R₁
//! R₂` rotates by `R₂` first if both are interpreted in space axes, and by `R₁` first if each is interpreted
//! in the axes rotated by the previous ones. The quaternion `(u, w) = (n sin(θ/2), cos(θ/2))`, stored x y z
//! w, rotates by `θ` about the unit vector `n`.
//!
//! The orientation matrix `O_{B/A}` of Bernstein, Goel and Ansari, *Geometry, Kinematics, Statics, and
//! Dynamics*, which resolves in B a vector that was resolved in A, is the transpose of the rotation matrix
//! `R` of B relative to A; the attitude matrix of Shuster and of Hughes is that transpose too. Products of
//! orientation matrices are in reverse order.
//!
//! **Sources**, by name in what follows: Shuster, *A survey of attitude representations*, Journal of the
//! Astronautical Sciences 41 (1993) 439; Kane, Likins and Levinson, *Spacecraft Dynamics* (1983), ch. 1 and
//! appendices I, II; Hughes, *Spacecraft Attitude Dynamics* (1986), ch. 2; Schaub and Junkins, *Stereographic
//! orientation parameters*, Journal of the Astronautical Sciences 44 (1996) 1.
//!
//! **Singular cases** are reported by [`Singular`], by `None` or by [`Angles::singular`]; no function returns
//! NaN for finite arguments whose squares do not overflow. The functions neither allocate nor panic.
//!
//! ```
//! use linkwork::rotation::{EulerSequence, Mrp};
//!
//! // Yaw, pitch and roll of an aircraft, rad, and their rates.
//! let (angles, rates) = ([0.3, -0.7, 1.1], [0.5, -0.2, 0.9]);
//! let attitude = EulerSequence::BODY_ZYX.rotation(angles);
//! let omega = EulerSequence::BODY_ZYX.omega_body(angles, rates);
//!
//! let sigma = Mrp::from_rotation(&attitude);
//! let sigma_rate = sigma.rate_from_body(&omega);
//! assert!((sigma.omega_body(&sigma_rate) - omega).norm() < 1e-15);
//!
//! let found = EulerSequence::SPACE_XYZ.angles(&sigma.rotation());
//! assert!(!found.singular);
//! assert!((found.angles[0] - 1.1_f64).abs() < 1e-15);
//! ```

mod convert;
mod eigenaxis;
mod euler_angles;
mod euler_parameters;
mod euler_rates;
mod frames;
mod gibbs;
mod matrix;
mod mrp;
mod nearest;
mod rotation_vector;
mod sequence;
mod singular;
mod standard;

pub use eigenaxis::{angle_between, eigenaxis, rodrigues, rotate_about};
pub use euler_angles::Angles;
pub use euler_parameters::{
    antipode, quaternion_of_rotation, quaternion_omega_body, quaternion_omega_space,
    quaternion_rate_from_body, quaternion_rate_from_space, shorter,
};
pub use frames::{reciprocal, unvectorized, vectorized, wedge};
pub use gibbs::{Gibbs, cayley, inverse_cayley};
pub use matrix::{
    axial, rotation_omega_body, rotation_omega_space, rotation_rate_from_body, rotation_rate_from_space,
};
pub use mrp::Mrp;
pub use nearest::nearest_rotation;
pub use rotation_vector::RotationVector;
pub use sequence::{Axis, EulerSequence, FixedIn};
pub use singular::Singular;

#[cfg(test)]
mod tests;
