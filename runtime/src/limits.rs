//! Limits of coordinates, for controllers and planners.

use crate::private::constant;
use crate::{At, Real};
use nalgebra::{SMatrix, SVector};

/// What the coordinates of a mechanism, their velocities and the generalized forces on them stay within: what a file says of its
/// joints, and each [`Limit`](crate::elements::Limit) of a struct. Every mechanism implements it; entries that nothing bounds are
/// infinite, those of ball and free joints always.
///
/// Limits exert no force, and no function of the dynamics knows them. They are functions, not constants, since they may be
/// expressions of the parameters; numbers cost nothing. None of the functions here allocates, and none has branches that depend
/// on `NV` alone.
///
/// ```
/// use linkwork::prelude::*;
///
/// #[mechanism(urdf = "../models/urdf/ur5.urdf")]
/// pub struct Ur5;
///
/// /// A force that the motors can give.
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
    /// The scalar type.
    type Scalar: Real;

    /// The least value of the coordinate whose rate is each entry of `v`, m or rad; −∞ where there is none. Where speeds are declared
    /// ([`Speed`](crate::elements::Speed)), that of the coordinate whose rate the entry would be without them.
    fn lower_limits(&self) -> SVector<Self::Scalar, NV> {
        SVector::repeat(constant(f64::NEG_INFINITY))
    }

    /// The largest value of the coordinate whose rate is each entry of `v`, m or rad; ∞ where there is none. With declared speeds as
    /// for [`lower_limits`](Self::lower_limits).
    fn upper_limits(&self) -> SVector<Self::Scalar, NV> {
        SVector::repeat(constant(f64::INFINITY))
    }

    /// The largest magnitude of each entry of `v`, m/s or rad/s; ∞ where there is none.
    fn velocity_limits(&self) -> SVector<Self::Scalar, NV> {
        SVector::repeat(constant(f64::INFINITY))
    }

    /// The largest magnitude of each generalized force `τ`, N or N·m; ∞ where there is none.
    fn effort_limits(&self) -> SVector<Self::Scalar, NV> {
        SVector::repeat(constant(f64::INFINITY))
    }

    /// The configuration with each coordinate that is beyond a limit put at that limit. What is not a number stays so.
    fn clamp_configuration(&self, q: &SVector<Self::Scalar, NQ>) -> SVector<Self::Scalar, NQ> {
        *q
    }

    /// The coordinates in the order of these limits, and by which matrix speeds follow from their rates; `None` where no speeds are
    /// declared, and velocities are rates.
    #[doc(hidden)]
    #[allow(clippy::type_complexity, reason = "a vector and a matrix")]
    fn limited_coordinates(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
    ) -> Option<(SVector<Self::Scalar, NV>, SMatrix<Self::Scalar, NV, NV>)> {
        None
    }

    /// The velocity with each entry that is beyond its limit put at that limit. What is not a number stays so.
    fn clamp_velocity(&self, v: &SVector<Self::Scalar, NV>) -> SVector<Self::Scalar, NV> {
        within(v, &self.velocity_limits())
    }

    /// The generalized force with each entry that is beyond its limit put at that limit. What is not a number stays so.
    fn clamp_effort(&self, tau: &SVector<Self::Scalar, NV>) -> SVector<Self::Scalar, NV> {
        within(tau, &self.effort_limits())
    }
}

/// Each entry of `x`, of the magnitude in `most` at most.
fn within<T: Real, const N: usize>(x: &SVector<T, N>, most: &SVector<T, N>) -> SVector<T, N> {
    x.zip_map(most, |x, most| at_most(at_least(x, -most), most))
}

/// The larger of both; `x` if it is not a number.
#[inline(always)]
pub fn at_least<T: Real>(x: T, bound: T) -> T {
    x.clamp(bound, constant(f64::INFINITY))
}

/// The smaller of both; `x` if it is not a number.
#[inline(always)]
pub fn at_most<T: Real>(x: T, bound: T) -> T {
    x.clamp(constant(f64::NEG_INFINITY), bound)
}

/// Passes every function on.
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

/// Limits do not depend on time.
#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M: Limits<NQ, NV>, T, const NQ: usize, const NV: usize> Limits<NQ, NV> for At<'_, M, T> {
    type Scalar = M::Scalar;

    pass_on!(self => self.mechanism);
}
