//! Euler parameters (unit quaternions): sign, rotation matrix and rates.

use crate::Real;
use crate::private::constant;
use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};

/// Returns the other quaternion of the same rotation, `−q`.
pub fn antipode<T: Real>(q: &UnitQuaternion<T>) -> UnitQuaternion<T> {
    UnitQuaternion::new_unchecked(-q.into_inner())
}

/// Returns the quaternion of the same rotation with `w ≥ 0`: a rotation by at most π. For `w = 0` either sign
/// is valid, and `q` is returned unchanged.
pub fn shorter<T: Real>(q: &UnitQuaternion<T>) -> UnitQuaternion<T> {
    if q.w < T::zero() { antipode(q) } else { *q }
}

/// Returns the Euler parameters of a rotation matrix, with `w ≥ 0` and unit norm to rounding.
///
/// Of the four formulas, the function uses the one that divides by a component of at least ½ (Shepperd,
/// *Quaternion from rotation matrix*, Journal of Guidance and Control 1 (1978) 223), so that no rotation is
/// singular. nalgebra's conversion uses the same formulas, but does not normalise the sign or the norm.
pub fn quaternion_of_rotation<T: Real>(rotation: &Rotation3<T>) -> UnitQuaternion<T> {
    let found = UnitQuaternion::from_rotation_matrix(rotation).into_inner();
    shorter(&UnitQuaternion::new_normalize(found))
}

/// Returns the rate `q̇ = ½ q (ω_body, 0)`, 1/s, for an angular velocity in body axes, rad/s. Never singular.
///
/// Source: Shuster. `q̇` is perpendicular to `q`. The antipode `−q` has the rate `−q̇`.
pub fn quaternion_rate_from_body<T: Real>(q: &UnitQuaternion<T>, omega: &Vector3<T>) -> Quaternion<T> {
    q.into_inner() * Quaternion::from_imag(omega * constant::<T>(0.5))
}

/// Returns the rate `q̇ = ½ (ω_space, 0) q`, 1/s, for an angular velocity in space axes, rad/s. Never
/// singular.
pub fn quaternion_rate_from_space<T: Real>(q: &UnitQuaternion<T>, omega: &Vector3<T>) -> Quaternion<T> {
    Quaternion::from_imag(omega * constant::<T>(0.5)) * q.into_inner()
}

/// Returns the angular velocity in body axes, rad/s: `2 q⁻¹ q̇` without its scalar part, which is the
/// component of `q̇`, 1/s, that would change the norm of `q`.
pub fn quaternion_omega_body<T: Real>(q: &UnitQuaternion<T>, rate: &Quaternion<T>) -> Vector3<T> {
    (q.conjugate().into_inner() * rate).imag() * constant::<T>(2.0)
}

/// Returns the angular velocity in space axes, rad/s: `2 q̇ q⁻¹` without its scalar part.
pub fn quaternion_omega_space<T: Real>(q: &UnitQuaternion<T>, rate: &Quaternion<T>) -> Vector3<T> {
    (rate * q.conjugate().into_inner()).imag() * constant::<T>(2.0)
}
