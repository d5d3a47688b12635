//! Limits of the coordinates, velocities and forces of a mechanism, for controllers and planners.

use crate::private::constant;
use crate::{At, Real};
use nalgebra::{SMatrix, SVector};

/// Limits of the coordinates of a mechanism, of their velocities and of the generalized forces on them: the
/// joint limits of a file, and each [`Limit`](crate::elements::Limit) of a struct. Every mechanism implements
/// the trait. Unlimited entries are infinite; entries of ball and free joints always are.
///
/// Limits exert no force, and the dynamics do not depend on them. They are functions, not constants, because
/// they may be expressions of the parameters; constant limits are free of cost. The functions allocate no
/// memory, and do not branch on `NV` alone.
///
/// ```
/// use linkwork::prelude::*;
///
/// #[mechanism(urdf = "../models/urdf/ur5.urdf")]
/// pub struct Ur5;
///
/// /// The generalized force within the limits of the motors.
/// fn saturated<M: Limits<NQ, NV>, const NQ: usize, const NV: usize>(
///     m: &M,
///     tau: &SVector<M::Scalar, NV>,
/// ) -> SVector<M::Scalar, NV> {
///     m.clamp_effort(tau)
/// }
///
/// assert_eq!(Ur5.effort_limits()[0], 150.0);
/// assert_eq!(saturated(&Ur5, &SVector::repeat(-1000.0))[0], -150.0);
/// ```
#[diagnostic::on_unimplemented(message = "`{Self}` has no limits", label = "expected a mechanism")]
pub trait Limits<const NQ: usize, const NV: usize> {
    /// Scalar type of the mechanism, and of the limits.
    type Scalar: Real;

    /// Returns the lower limit of the coordinate whose rate is each entry of `v`, m or rad; −∞ if unlimited.
    /// With declared generalized speeds ([`Speed`](crate::elements::Speed)), entries refer to the joint
    /// velocities that the speeds replace.
    fn lower_limits(&self) -> SVector<Self::Scalar, NV> {
        SVector::repeat(constant(f64::NEG_INFINITY))
    }

    /// Returns the upper limit of the coordinate whose rate is each entry of `v`, m or rad; ∞ if unlimited.
    /// With declared generalized speeds, see [`lower_limits`](Self::lower_limits).
    fn upper_limits(&self) -> SVector<Self::Scalar, NV> {
        SVector::repeat(constant(f64::INFINITY))
    }

    /// Returns the limit of the magnitude of each velocity, m/s or rad/s; ∞ if unlimited.
    fn velocity_limits(&self) -> SVector<Self::Scalar, NV> {
        SVector::repeat(constant(f64::INFINITY))
    }

    /// Returns the limit of the magnitude of each generalized force `τ`, N or N·m; ∞ if unlimited.
    fn effort_limits(&self) -> SVector<Self::Scalar, NV> {
        SVector::repeat(constant(f64::INFINITY))
    }

    /// Returns the configuration with each coordinate clamped to its limits. NaN remains NaN.
    fn clamp_configuration(&self, q: &SVector<Self::Scalar, NQ>) -> SVector<Self::Scalar, NQ> {
        *q
    }

    /// Returns the coordinates in the order of the limits, and the matrix that maps their rates to
    /// generalized speeds. Returns `None` without declared speeds, when velocities are rates of the
    /// coordinates.
    #[doc(hidden)]
    #[allow(clippy::type_complexity, reason = "a vector and a matrix")]
    fn limited_coordinates(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
    ) -> Option<(SVector<Self::Scalar, NV>, SMatrix<Self::Scalar, NV, NV>)> {
        None
    }

    /// Returns the velocity with each entry clamped to its limit. NaN remains NaN.
    fn clamp_velocity(&self, v: &SVector<Self::Scalar, NV>) -> SVector<Self::Scalar, NV> {
        clamp_magnitudes(v, &self.velocity_limits())
    }

    /// Returns the generalized force with each entry clamped to its limit. NaN remains NaN.
    fn clamp_effort(&self, tau: &SVector<Self::Scalar, NV>) -> SVector<Self::Scalar, NV> {
        clamp_magnitudes(tau, &self.effort_limits())
    }
}

/// Returns the vector `x` with the magnitude of each entry limited to that entry of `most`.
fn clamp_magnitudes<T: Real, const N: usize>(x: &SVector<T, N>, most: &SVector<T, N>) -> SVector<T, N> {
    x.zip_map(most, |x, most| at_most(at_least(x, -most), most))
}

/// Returns the larger of `x` and `bound`; `x` if it is NaN.
#[inline(always)]
pub fn at_least<T: Real>(x: T, bound: T) -> T {
    x.clamp(bound, constant(f64::INFINITY))
}

/// Returns the smaller of `x` and `bound`; `x` if it is NaN.
#[inline(always)]
pub fn at_most<T: Real>(x: T, bound: T) -> T {
    x.clamp(constant(f64::NEG_INFINITY), bound)
}

/// Writes functions that return the limits of a wrapped mechanism.
macro_rules! pass_on {
    ($self:ident => $to:expr) => {
        fn lower_limits(&$self) -> SVector<Self::Scalar, NV> {
            $to.lower_limits()
        }

        fn upper_limits(&$self) -> SVector<Self::Scalar, NV> {
            $to.upper_limits()
        }

        fn velocity_limits(&$self) -> SVector<Self::Scalar, NV> {
            $to.velocity_limits()
        }

        fn effort_limits(&$self) -> SVector<Self::Scalar, NV> {
            $to.effort_limits()
        }

        fn clamp_configuration(&$self, q: &SVector<Self::Scalar, NQ>) -> SVector<Self::Scalar, NQ> {
            $to.clamp_configuration(q)
        }

        fn limited_coordinates(
            &$self,
            q: &SVector<Self::Scalar, NQ>,
        ) -> Option<(SVector<Self::Scalar, NV>, SMatrix<Self::Scalar, NV, NV>)> {
            $to.limited_coordinates(q)
        }

        fn clamp_velocity(&$self, v: &SVector<Self::Scalar, NV>) -> SVector<Self::Scalar, NV> {
            $to.clamp_velocity(v)
        }

        fn clamp_effort(&$self, tau: &SVector<Self::Scalar, NV>) -> SVector<Self::Scalar, NV> {
            $to.clamp_effort(tau)
        }
    };
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M: Limits<NQ, NV> + ?Sized, const NQ: usize, const NV: usize> Limits<NQ, NV> for &M {
    type Scalar = M::Scalar;

    pass_on!(self => (**self));
}

/// Implements the limits of a mechanism at a fixed time, which do not depend on time.
#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M: Limits<NQ, NV>, T, const NQ: usize, const NV: usize> Limits<NQ, NV> for At<'_, M, T> {
    type Scalar = M::Scalar;

    pass_on!(self => self.mechanism);
}
