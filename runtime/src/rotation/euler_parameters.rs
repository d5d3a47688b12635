//! Euler parameters, that is unit quaternions: sign, rotation matrix and rates.

use crate::Real;
use crate::private::constant;
use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};

/// The other quaternion of the same rotation, `−q`.
pub fn antipode<T: Real>(q: &UnitQuaternion<T>) -> UnitQuaternion<T> {
    UnitQuaternion::new_unchecked(-q.into_inner())
}

/// The quaternion of the same rotation with `w ≥ 0`: a turn by at most π. At `w = 0` either sign does, and `q` stays.
pub fn shorter<T: Real>(q: &UnitQuaternion<T>) -> UnitQuaternion<T> {
    if q.w < T::zero() { antipode(q) } else { *q }
}

/// The Euler parameters of a rotation matrix, with `w ≥ 0` and of unit length to rounding.
///
/// Of the four ways to divide the one by a component of at least ½ is taken (Shepperd, *Quaternion from rotation matrix*,
/// Journal of Guidance and Control 1 (1978) 223), so none is singular. nalgebra's conversion takes the same four, without
/// the sign and without normalising.
pub fn quaternion_of_rotation<T: Real>(rotation: &Rotation3<T>) -> UnitQuaternion<T> {
    let found = UnitQuaternion::from_rotation_matrix(rotation).into_inner();
    shorter(&UnitQuaternion::new_normalize(found))
}

/// `q̇ = ½ q (ω_body, 0)`, 1/s, of the angular velocity in body axes, rad/s. Never singular.
///
/// Source: Shuster. `q̇` is perpendicular to `q`. The antipode `−q` has the rate `−q̇`.
pub fn quaternion_rate_from_body<T: Real>(q: &UnitQuaternion<T>, omega: &Vector3<T>) -> Quaternion<T> {
    q.into_inner() * Quaternion::from_imag(omega * constant::<T>(0.5))
}

/// `q̇ = ½ (ω_space, 0) q`, 1/s, of the angular velocity in space axes, rad/s. Never singular.
pub fn quaternion_rate_from_space<T: Real>(q: &UnitQuaternion<T>, omega: &Vector3<T>) -> Quaternion<T> {
    Quaternion::from_imag(omega * constant::<T>(0.5)) * q.into_inner()
}

/// The angular velocity in body axes, rad/s: `2 q⁻¹ q̇` without its scalar part, which is what of `q̇`, 1/s, would change
/// the length of `q`.
pub fn quaternion_omega_body<T: Real>(q: &UnitQuaternion<T>, rate: &Quaternion<T>) -> Vector3<T> {
    (q.conjugate().into_inner() * rate).imag() * constant::<T>(2.0)
}

/// The angular velocity in space axes, rad/s: `2 q̇ q⁻¹` without its scalar part.
pub fn quaternion_omega_space<T: Real>(q: &UnitQuaternion<T>, rate: &Quaternion<T>) -> Vector3<T> {
    (rate * q.conjugate().into_inner()).imag() * constant::<T>(2.0)
}
