//! Gibbs vectors, the classical Rodrigues parameters, and the Cayley transform.

use super::euler_parameters::quaternion_of_rotation;
use super::matrix::axial;
use super::singular::Singular;
use crate::Real;
use crate::private::constant;
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

/// The Gibbs (Rodrigues) vector `g = n tan(θ/2) = u / w`: infinite for a rotation by π, the same for `q` and
/// `−q`, and the same in space and in body axes.
///
/// Shuster; Kane, Likins and Levinson, §1.4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gibbs<T>(pub Vector3<T>);

impl<T: Real> Gibbs<T> {
    /// Returns the rotation matrix `1 + 2 ([g]ₓ + [g]ₓ²) / (1 + g²)`.
    pub fn rotation(&self) -> Rotation3<T> {
        self.quaternion().to_rotation_matrix()
    }

    /// Returns the Euler parameters `(g, 1) / √(1 + g²)`, with `w > 0`.
    pub fn quaternion(&self) -> UnitQuaternion<T> {
        // Scaled, so that the square of a large vector does not overflow.
        let scale = self.0.amax().max(T::one());
        UnitQuaternion::new_normalize(Quaternion::from_parts(T::one() / scale, self.0 / scale))
    }

    /// Returns the Gibbs vector of a rotation matrix.
    ///
    /// # Errors
    ///
    /// The errors of [`Self::from_quaternion`].
    pub fn from_rotation(rotation: &Rotation3<T>) -> Result<Self, Singular> {
        Self::from_quaternion(&quaternion_of_rotation(rotation))
    }

    /// Returns the Gibbs vector `u / w` of Euler parameters of either sign.
    ///
    /// # Errors
    ///
    /// [`Singular::HalfTurn`] if it is not finite. Close to that, its magnitude is of order 1/ε, and it still
    /// reproduces the rotation to rounding.
    pub fn from_quaternion(q: &UnitQuaternion<T>) -> Result<Self, Singular> {
        finite_gibbs_vector(q.imag() / q.w)
    }

    /// Returns the Gibbs vector of the product `R R'` of the rotation of `self` and that of `other`:
    /// `(g + g' + g × g') / (1 − g · g')`.
    ///
    /// # Errors
    ///
    /// [`Singular::HalfTurn`] if the product is a rotation by π, whose Gibbs vector is not finite.
    pub fn compose(&self, other: &Self) -> Result<Self, Singular> {
        let (g, h) = (self.0, other.0);
        finite_gibbs_vector((g + h + g.cross(&h)) / (T::one() - g.dot(&h)))
    }

    /// Returns the vector `−g` of the inverse rotation.
    pub fn inverse(&self) -> Self {
        Self(-self.0)
    }

    /// Returns the rate `ġ = ½ (ω + g × ω + g (g · ω))`, 1/s, for an angular velocity in body axes, rad/s.
    ///
    /// Source: Shuster. Finite if `g` is.
    pub fn rate_from_body(&self, omega: &Vector3<T>) -> Vector3<T> {
        let g = self.0;
        (omega + g.cross(omega) + g * g.dot(omega)) * constant::<T>(0.5)
    }

    /// Returns the rate `ġ = ½ (ω − g × ω + g (g · ω))`, 1/s, for an angular velocity in space axes, rad/s.
    pub fn rate_from_space(&self, omega: &Vector3<T>) -> Vector3<T> {
        -self.inverse().rate_from_body(&-omega)
    }

    /// Returns the angular velocity in body axes, rad/s: `ω = 2 (ġ − g × ġ) / (1 + g²)`. Never singular.
    pub fn omega_body(&self, rate: &Vector3<T>) -> Vector3<T> {
        let factor = constant::<T>(2.0) / (T::one() + self.0.norm_squared());
        (rate - self.0.cross(rate)) * factor
    }

    /// Returns the angular velocity in space axes, rad/s: `ω = 2 (ġ + g × ġ) / (1 + g²)`. Never singular.
    pub fn omega_space(&self, rate: &Vector3<T>) -> Vector3<T> {
        -self.inverse().omega_body(&-rate)
    }
}

fn finite_gibbs_vector<T: Real>(g: Vector3<T>) -> Result<Gibbs<T>, Singular> {
    if g.iter().all(|x| x.is_finite()) { Ok(Gibbs(g)) } else { Err(Singular::HalfTurn) }
}

/// Returns the Cayley transform `R = (1 + S)(1 − S)⁻¹` of a skew-symmetric matrix `S = [g]ₓ`: the rotation of
/// the Gibbs vector `g`. The symmetric part of the argument is ignored. Never singular.
///
/// Source: Shuster (for the transpose).
pub fn cayley<T: Real>(skew: &Matrix3<T>) -> Rotation3<T> {
    Gibbs(axial(skew)).rotation()
}

/// Returns the skew-symmetric matrix `S = (R − 1)(R + 1)⁻¹` whose Cayley transform is `R`.
///
/// # Errors
///
/// [`Singular::HalfTurn`] where `R + 1` has no inverse.
pub fn inverse_cayley<T: Real>(rotation: &Rotation3<T>) -> Result<Matrix3<T>, Singular> {
    Ok(Gibbs::from_rotation(rotation)?.0.cross_matrix())
}
