//! Rates of rotation matrices by Poisson's equation.

use crate::Real;
use crate::private::constant;
use nalgebra::{ArrayStorage, Matrix3, Rotation3, Vector3};

/// Returns the vector `a` of the skew-symmetric part of a matrix: `½ (M − Mᵀ) = [a]ₓ`, the inverse of
/// nalgebra's `cross_matrix`.
pub fn axial<T: Real>(matrix: &Matrix3<T>) -> Vector3<T> {
    let ArrayStorage([[_, m10, m20], [m01, _, m21], [m02, m12, _]]) = matrix.data;
    Vector3::new(m21 - m12, m02 - m20, m10 - m01) * constant::<T>(0.5)
}

/// Returns the rate `Ṙ = R [ω_body]ₓ`, 1/s, of a rotation matrix for an angular velocity in body axes, rad/s.
///
/// Poisson's equation; Hughes, ch. 2, for the transpose. Never singular.
pub fn rotation_rate_from_body<T: Real>(rotation: &Rotation3<T>, omega: &Vector3<T>) -> Matrix3<T> {
    rotation.matrix() * omega.cross_matrix()
}

/// Returns the rate `Ṙ = [ω_space]ₓ R`, 1/s, of a rotation matrix for an angular velocity in space axes,
/// rad/s.
pub fn rotation_rate_from_space<T: Real>(rotation: &Rotation3<T>, omega: &Vector3<T>) -> Matrix3<T> {
    omega.cross_matrix() * rotation.matrix()
}

/// Returns the angular velocity in body axes, rad/s: the axial vector of `Rᵀ Ṙ`. Components of `Ṙ`, 1/s, that
/// would make the matrix no longer a rotation are ignored.
pub fn rotation_omega_body<T: Real>(rotation: &Rotation3<T>, rate: &Matrix3<T>) -> Vector3<T> {
    axial(&(rotation.matrix().transpose() * rate))
}

/// Returns the angular velocity in space axes, rad/s: the axial vector of `Ṙ Rᵀ`. Components of `Ṙ`, 1/s,
/// that would make the matrix no longer a rotation are ignored.
pub fn rotation_omega_space<T: Real>(rotation: &Rotation3<T>, rate: &Matrix3<T>) -> Vector3<T> {
    axial(&(rate * rotation.matrix().transpose()))
}
