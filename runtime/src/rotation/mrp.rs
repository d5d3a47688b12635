//! Modified Rodrigues parameters, and the alternative (shadow) set of the same rotation.

use super::euler_parameters::{quaternion_of_rotation, shorter};
use super::singular::Singular;
use crate::Real;
use crate::private::constant;
use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};

/// Modified Rodrigues vector `σ = n tan(θ/4) = u / (1 + w)`: infinite for a rotation by 2π, the same in space
/// and in body axes.
///
/// Every rotation except the identity has two such vectors, `σ` and its shadow `−σ / σ²`, which belong to `q`
/// and to `−q`. One of them is inside the unit ball and corresponds to a rotation by at most π; for a
/// rotation by π, both are on the unit sphere. An integration of `σ̇` that switches to the shadow whenever
/// `|σ| > 1` ([`Self::switched`]) avoids all singularities. Schaub and Junkins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mrp<T>(pub Vector3<T>);

impl<T: Real> Mrp<T> {
    /// Returns the rotation matrix `1 + (8 [σ]ₓ² + 4 (1 − σ²) [σ]ₓ) / (1 + σ²)²`.
    pub fn rotation(&self) -> Rotation3<T> {
        self.quaternion().to_rotation_matrix()
    }

    /// Returns the Euler parameters `(2 σ, 1 − σ²) / (1 + σ²)`: `w < 0` outside the unit ball, so that the
    /// shadow yields `−q`.
    pub fn quaternion(&self) -> UnitQuaternion<T> {
        let square = self.0.norm_squared();
        let two = constant::<T>(2.0);
        // Outside the ball the inverse square is used, because the square itself may overflow.
        let q = if square > T::one() {
            let inverse = T::one() / square;
            let sum = T::one() + inverse;
            Quaternion::from_parts((inverse - T::one()) / sum, self.0 * (two * inverse / sum))
        } else {
            let sum = T::one() + square;
            Quaternion::from_parts((T::one() - square) / sum, self.0 * (two / sum))
        };
        UnitQuaternion::new_unchecked(q)
    }

    /// Returns the modified Rodrigues vector of a rotation matrix, inside or on the unit ball. Never
    /// singular.
    pub fn from_rotation(rotation: &Rotation3<T>) -> Self {
        Self::from_quaternion(&quaternion_of_rotation(rotation))
    }

    /// Returns the modified Rodrigues vector of Euler parameters, inside or on the unit ball. It is the same
    /// for `q` and `−q`, except for rotations by π. Never singular.
    pub fn from_quaternion(q: &UnitQuaternion<T>) -> Self {
        let q = shorter(q);
        Self(q.imag() / (T::one() + q.w))
    }

    /// Returns the other modified Rodrigues vector of the same rotation, `−σ / σ²`.
    ///
    /// # Errors
    ///
    /// [`Singular::FullTurn`] if it is not finite, for the zero vector.
    pub fn shadow(&self) -> Result<Self, Singular> {
        let largest = self.0.amax();
        let scaled = self.0 / largest;
        let shadow = -scaled / (scaled.norm_squared() * largest);
        if shadow.iter().all(|x| x.is_finite()) { Ok(Self(shadow)) } else { Err(Singular::FullTurn) }
    }

    /// Returns the rate of the shadow vector, 1/s, given the rate `σ̇` of this vector, 1/s:
    /// `(2 σ (σ · σ̇) / σ² − σ̇) / σ²`.
    ///
    /// # Errors
    ///
    /// [`Singular::FullTurn`] if the square of the shadow is not finite.
    pub fn shadow_rate(&self, rate: &Vector3<T>) -> Result<Vector3<T>, Singular> {
        let shadow = self.shadow()?.0;
        let square = shadow.norm_squared();
        if !square.is_finite() {
            return Err(Singular::FullTurn);
        }
        // The shadow s satisfies −s / s² = σ.
        Ok(shadow * (constant::<T>(2.0) * shadow.dot(rate)) - rate * square)
    }

    /// Returns the shorter of this vector and its shadow: the vector itself up to `|σ| = 1`.
    pub fn switched(&self) -> Self {
        if self.0.norm_squared() > T::one() { self.shadow().unwrap_or(*self) } else { *self }
    }

    /// Returns the modified Rodrigues vector, inside or on the unit ball, of the product `R R'` of the
    /// rotation of `self` and that of `other`:
    /// `((1 − σ'²) σ + (1 − σ²) σ' + 2 σ × σ') / (1 + σ² σ'² − 2 σ · σ')` or its shadow, which has the
    /// denominator `|σ + σ'|²` and the opposite sign. Never singular: the larger denominator is used, which
    /// is at least `½ (1 + σ²)(1 + σ'²)`.
    pub fn compose(&self, other: &Self) -> Self {
        let (a, b) = (self.switched().0, other.switched().0);
        let (square, other_square) = (a.norm_squared(), b.norm_squared());
        let two = constant::<T>(2.0);
        let sum = a * (T::one() - other_square) + b * (T::one() - square) + a.cross(&b) * two;
        let direct = T::one() + square * other_square - two * a.dot(&b);
        let shadow = (a + b).norm_squared();
        Self(if direct >= shadow { sum / direct } else { -sum / shadow })
    }

    /// Returns the vector `−σ` of the inverse rotation.
    pub fn inverse(&self) -> Self {
        Self(-self.0)
    }

    /// Returns the rate `σ̇ = ¼ ((1 − σ²) ω + 2 σ × ω + 2 σ (σ · ω))`, 1/s, for an angular velocity in body
    /// axes, rad/s.
    ///
    /// Schaub and Junkins; Shuster. Finite if `σ` is.
    pub fn rate_from_body(&self, omega: &Vector3<T>) -> Vector3<T> {
        let s = self.0;
        let two = constant::<T>(2.0);
        let doubled = s.cross(omega) + s * s.dot(omega);
        (omega * (T::one() - s.norm_squared()) + doubled * two) * constant::<T>(0.25)
    }

    /// Returns the rate `σ̇ = ¼ ((1 − σ²) ω − 2 σ × ω + 2 σ (σ · ω))`, 1/s, for an angular velocity in space
    /// axes, rad/s.
    pub fn rate_from_space(&self, omega: &Vector3<T>) -> Vector3<T> {
        -self.inverse().rate_from_body(&-omega)
    }

    /// Returns the angular velocity in body axes, rad/s:
    /// `ω = 4 ((1 − σ²) σ̇ − 2 σ × σ̇ + 2 σ (σ · σ̇)) / (1 + σ²)²`. Never singular.
    pub fn omega_body(&self, rate: &Vector3<T>) -> Vector3<T> {
        let s = self.0;
        let (square, two) = (s.norm_squared(), constant::<T>(2.0));
        let sum = T::one() + square;
        let doubled = s * s.dot(rate) - s.cross(rate);
        (rate * (T::one() - square) + doubled * two) * (constant::<T>(4.0) / (sum * sum))
    }

    /// Returns the angular velocity in space axes, rad/s:
    /// `ω = 4 ((1 − σ²) σ̇ + 2 σ × σ̇ + 2 σ (σ · σ̇)) / (1 + σ²)²`. Never singular.
    pub fn omega_space(&self, rate: &Vector3<T>) -> Vector3<T> {
        -self.inverse().omega_body(&-rate)
    }
}
