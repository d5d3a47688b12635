//! Operand types of bodies: numbers and vectors of them.

use super::Vector;
use crate::atmosphere::Atmosphere;
use crate::lanes::Registers;
use crate::trigonometry;
use crate::{Real, Table};
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A number, or a vector with a number in each lane.
pub trait Number<A: Registers>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Returns the floating-point number nearest to `x`, in this scalar type or in every lane.
    fn constant(x: f64) -> Self;
    /// Returns `a b + c` with a single rounding.
    fn fused(a: Self, b: Self, c: Self) -> Self;
}

impl<A: Registers, T: Real> Number<A> for T {
    #[inline(always)]
    fn constant(x: f64) -> Self {
        nalgebra::convert(x)
    }

    #[inline(always)]
    fn fused(a: Self, b: Self, c: Self) -> Self {
        a.mul_add(b, c)
    }
}

impl<A: Registers, T: Real, const N: usize> Number<A> for Vector<A, T, N> {
    #[inline(always)]
    fn constant(x: f64) -> Self {
        Self::splat(nalgebra::convert(x))
    }

    #[inline(always)]
    fn fused(a: Self, b: Self, c: Self) -> Self {
        Self::from_array(A::fused(a.lane_numbers(), b.lane_numbers(), c.lane_numbers()))
    }
}

macro_rules! elementary {
    ($($(#[$doc:meta])* $name:ident($x:ident $(, $y:ident)?);)+) => {
        /// A number with elementary functions, which are evaluated lane by lane.
        pub trait Elementary<A: Registers>: Number<A> {
            $(
                $(#[$doc])*
                fn $name($x: Self $(, $y: Self)?) -> Self;
            )+
            /// Returns sines and cosines of `N` angles, rad.
            fn sin_cos_all<const N: usize>(x: [Self; N]) -> ([Self; N], [Self; N]);
            /// Returns the value of a table by interpolation, or its derivative. `orders` are the orders of
            /// differentiation with respect to each argument.
            fn tabulated<const N: usize>(table: &Table<N>, x: [Self; N], orders: [u8; N]) -> Self;
        }

        impl<A: Registers, T: Real> Elementary<A> for T {
            $(
                #[inline(always)]
                fn $name($x: Self $(, $y: Self)?) -> Self {
                    elementary!(@number $name $x $($y)?)
                }
            )+

            #[inline(always)]
            fn sin_cos_all<const N: usize>(x: [Self; N]) -> ([Self; N], [Self; N]) {
                trigonometry::sin_cos_all::<A, T, N>(x)
            }

            fn tabulated<const N: usize>(table: &Table<N>, x: [Self; N], orders: [u8; N]) -> Self {
                table.derivative(x, orders)
            }
        }

        impl<A: Registers, T: Real, const L: usize> Elementary<A> for Vector<A, T, L> {
            $(elementary!(@vector $name $x $($y)?);)+

            #[inline(always)]
            fn sin_cos_all<const N: usize>(x: [Self; N]) -> ([Self; N], [Self; N]) {
                #[cfg(feature = "std")]
                if let Some(done) = crate::lanes::angles::sin_cos_all(x) {
                    return done;
                }
                let (mut s, mut c) = (x, x);
                for ((x, s), c) in x.iter().zip(&mut s).zip(&mut c) {
                    let (sines, cosines) = trigonometry::sin_cos_all::<A, T, L>(*x.lane_numbers());
                    (*s, *c) = (Self::from_array(sines), Self::from_array(cosines));
                }
                (s, c)
            }

            fn tabulated<const N: usize>(table: &Table<N>, x: [Self; N], orders: [u8; N]) -> Self {
                let numbers_of_lane = |k: usize| x.each_ref().map(|x| x.lane_numbers()[k]);
                Self::from_array(core::array::from_fn(|k| table.derivative(numbers_of_lane(k), orders)))
            }
        }
    };
    (@number min $x:ident $y:ident) => {
        minimum_ignoring_nan($x, $y)
    };
    (@number max $x:ident $y:ident) => {
        maximum_ignoring_nan($x, $y)
    };
    (@number $name:ident $x:ident $($y:ident)?) => {
        $x.$name($($y)?)
    };
    (@vector min $x:ident $y:ident) => {
        elementary!(@vector_of minimum_ignoring_nan min $x $y);
    };
    (@vector max $x:ident $y:ident) => {
        elementary!(@vector_of maximum_ignoring_nan max $x $y);
    };
    (@vector_of $function:ident $name:ident $x:ident $y:ident) => {
        #[inline(always)]
        fn $name($x: Self, $y: Self) -> Self {
            let ($x, $y) = ($x.lane_numbers(), $y.lane_numbers());
            Self::from_array(core::array::from_fn(|k| $function($x[k], $y[k])))
        }
    };
    (@vector sqrt $x:ident) => {
        #[inline(always)]
        fn sqrt($x: Self) -> Self {
            Self::from_array(A::root($x.lane_numbers()))
        }
    };
    (@vector abs $x:ident) => {
        #[inline(always)]
        fn abs($x: Self) -> Self {
            Self::from_array(A::magnitude($x.lane_numbers()))
        }
    };
    (@vector $name:ident $x:ident) => {
        #[inline(always)]
        fn $name($x: Self) -> Self {
            Self::from_array($x.lane_numbers().map(|x| x.$name()))
        }
    };
    (@vector $name:ident $x:ident $y:ident) => {
        #[inline(always)]
        fn $name($x: Self, $y: Self) -> Self {
            let ($x, $y) = ($x.lane_numbers(), $y.lane_numbers());
            Self::from_array(core::array::from_fn(|k| $x[k].$name($y[k])))
        }
    };
}

elementary_functions!(elementary);

/// Returns the smaller of two numbers; if one is NaN, the other one. With the feature `reproducible`, a zero
/// has a positive sign; otherwise the sign of the minimum of two zeros depends on the target.
#[inline(always)]
fn minimum_ignoring_nan<T: Real>(x: T, y: T) -> T {
    match cfg!(feature = "reproducible") {
        true => T::min(x, y) + T::zero(),
        false => T::min(x, y),
    }
}

/// Returns the larger of two numbers; if one is NaN, the other one. Zeros are treated as by
/// [`minimum_ignoring_nan`].
#[inline(always)]
fn maximum_ignoring_nan<T: Real>(x: T, y: T) -> T {
    match cfg!(feature = "reproducible") {
        true => T::max(x, y) + T::zero(),
        false => T::max(x, y),
    }
}
