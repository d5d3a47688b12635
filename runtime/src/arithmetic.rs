//! The arithmetic of generated functions: that of the target they are compiled for, or that of the processor they run on.
//!
//! A generated body is written once, generic over [`Arithmetic`]: [`Compiled`] has the instructions of the compilation's
//! target; large functions may run with more of them ([`dispatch`](dispatch::dispatch)). Everything of a body is inlined, so that it is compiled
//! with the features of the function that it ends up in. Without optimisation nothing here has to be inlined: each call would
//! keep its arguments on the stack of the body, which is then twice as large.

/// Gives the elementary functions to a macro, which makes something of each.
macro_rules! elementary_functions {
    ($make:ident) => {
        $make! {
            /// The square root; NaN for `x < 0`.
            sqrt(x);
            /// The sine of `x`, rad.
            sin(x);
            /// The cosine of `x`, rad.
            cos(x);
            /// The tangent of `x`, rad.
            tan(x);
            /// The arc sine, rad; NaN outside [−1, 1].
            asin(x);
            /// The arc cosine, rad; NaN outside [−1, 1].
            acos(x);
            /// The arc tangent, rad.
            atan(x);
            /// The angle of the point (`x`, `y`), rad: `atan2(y, x)` as in the standard library.
            atan2(y, x);
            /// The hyperbolic sine.
            sinh(x);
            /// The hyperbolic cosine.
            cosh(x);
            /// The hyperbolic tangent.
            tanh(x);
            /// The exponential.
            exp(x);
            /// The natural logarithm; NaN for `x < 0`.
            ln(x);
            /// The power `x` to `y`; NaN for `x < 0` and a `y` that is no integer.
            powf(x, y);
            /// The smaller one; the other one if one is NaN.
            min(x, y);
            /// The larger one; the other one if one is NaN.
            max(x, y);
            /// The magnitude.
            abs(x);
            /// 1 or −1 with the sign of `x`, also for zeros.
            signum(x);
            /// The temperature of the standard atmosphere at a geopotential height, m: K.
            isa_temperature(h);
            /// By how much it changes with the height, K/m.
            isa_lapse_rate(h);
            /// The pressure of the standard atmosphere at a geopotential height, m: Pa.
            isa_pressure(h);
        }
    };
}

pub(crate) mod dispatch;
mod number;
mod vector;

use crate::lanes::Registers;
use crate::{Lanes, Real, Table};
pub use number::{Elementary, Number};
pub use vector::Vector;

/// The instructions of the compilation's target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compiled;

macro_rules! elementary {
    ($($(#[$doc:meta])* $name:ident($($argument:ident),+);)+) => {$(
        $(#[$doc])*
        #[cfg_attr(debug_assertions, inline)]
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn $name<X: Elementary<Self>>($($argument: X),+) -> X {
            X::$name($($argument),+)
        }
    )+};
}

/// What generated bodies call: operations on numbers (every [`Real`](crate::Real)) and on lanes (`Vector`).
pub trait Arithmetic: Registers {
    /// `a b + c`, fused where the hardware can.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul_add<X: Number<Self>>(a: X, b: X, c: X) -> X {
        if Self::FUSED { X::fused(a, b, c) } else { a * b + c }
    }

    /// `a b - c`, fused where the hardware can.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul_sub<X: Number<Self>>(a: X, b: X, c: X) -> X {
        if Self::FUSED { X::fused(a, b, -c) } else { a * b - c }
    }

    /// `c - a b`, fused where the hardware can.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn neg_mul_add<X: Number<Self>>(a: X, b: X, c: X) -> X {
        if Self::FUSED { X::fused(-a, b, c) } else { c - a * b }
    }

    /// Numbers as lanes.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<T, const N: usize>(numbers: [T; N]) -> Vector<Self, T, N> {
        Vector::from(Lanes(numbers))
    }

    /// The same number in every lane.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn splat<T: Copy, const N: usize>(x: T) -> Vector<Self, T, N> {
        Vector::from(Lanes([x; N]))
    }

    /// `x a`.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn scale<T: Real, const N: usize>(x: T, a: Vector<Self, T, N>) -> Vector<Self, T, N> {
        Vector::splat(x) * a
    }

    /// `x a + c`, fused where the hardware can.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn scale_add<T: Real, const N: usize>(
        x: T,
        a: Vector<Self, T, N>,
        c: Vector<Self, T, N>,
    ) -> Vector<Self, T, N> {
        Self::mul_add(Vector::splat(x), a, c)
    }

    /// `x a - c`, fused where the hardware can.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn scale_sub<T: Real, const N: usize>(
        x: T,
        a: Vector<Self, T, N>,
        c: Vector<Self, T, N>,
    ) -> Vector<Self, T, N> {
        Self::mul_sub(Vector::splat(x), a, c)
    }

    /// `c - x a`, fused where the hardware can.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn neg_scale_add<T: Real, const N: usize>(
        x: T,
        a: Vector<Self, T, N>,
        c: Vector<Self, T, N>,
    ) -> Vector<Self, T, N> {
        Self::neg_mul_add(Vector::splat(x), a, c)
    }

    /// The lanes of one vector, then those of another. Does not compile if `M` is not `2 N`.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn join<T: Copy, const N: usize, const M: usize>(
        a: Vector<Self, T, N>,
        b: Vector<Self, T, N>,
    ) -> Vector<Self, T, M> {
        Vector::joined(&a, &b)
    }

    /// Puts lane `I` of one vector and lane `J` of another into rows `ROW` and `ROW + 1` of a column. Does not compile if
    /// there are fewer lanes or rows.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store_two<
        const I: usize,
        const J: usize,
        const ROW: usize,
        T: Real,
        const N: usize,
        const M: usize,
        const R: usize,
    >(
        column: &mut [T; R],
        a: Vector<Self, T, N>,
        b: Vector<Self, T, M>,
    ) {
        const { assert!(ROW + 1 < R, "there are not so many rows") };
        const { assert!(I < N && J < M, "there are not so many lanes") };
        if let Some(rows) = column.get_mut(ROW..).and_then(<[T]>::first_chunk_mut)
            && let Some(two) = a.pair(I, &b, J)
        {
            *rows = two;
        }
    }

    /// Puts all lanes of a vector into the rows of a column from `ROW` on. Does not compile if there are fewer rows.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store_rows<const ROW: usize, T: Real, const N: usize, const R: usize>(
        column: &mut [T; R],
        a: Vector<Self, T, N>,
    ) {
        const { assert!(ROW + N <= R, "there are not so many rows") };
        if let Some(rows) = column.get_mut(ROW..).and_then(<[T]>::first_chunk_mut) {
            *rows = *a.numbers();
        }
    }

    /// Puts the lanes of one vector into row `ROW` of the columns from `COLUMN` on, and those of another into the row below.
    /// Does not compile if there are fewer rows or columns, or more than eight lanes.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store_columns<
        const ROW: usize,
        const COLUMN: usize,
        T: Real,
        const N: usize,
        const R: usize,
        const C: usize,
    >(
        columns: &mut [[T; R]; C],
        a: Vector<Self, T, N>,
        b: Vector<Self, T, N>,
    ) {
        const { assert!(ROW + 1 < R && COLUMN + N <= C, "there are not so many rows or columns") };
        const { assert!(N <= 8, "there are more lanes") };
        let columns = columns.get_mut(COLUMN..).and_then(<[_]>::first_chunk_mut::<N>);
        let Some(columns) = columns else { return };
        // Not a loop: lanes with numbers that change are kept in memory until it is unrolled.
        macro_rules! store {
            ($($lane:literal)+) => {$(
                if let Some(two) = a.pair($lane, &b, $lane)
                    && let Some(column) = columns.get_mut($lane)
                    && let Some(rows) = column.get_mut(ROW..).and_then(<[T]>::first_chunk_mut)
                {
                    *rows = two;
                }
            )+};
        }
        store!(0 1 2 3 4 5 6 7);
    }

    /// Arguments in lanes.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn each<T, const N: usize, const R: usize>(numbers: &[Lanes<T, N>; R]) -> &[Vector<Self, T, N>; R] {
        Vector::from_lanes(numbers)
    }

    /// Sine and cosine of an angle, or of one in each lane, rad.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sin_cos<X: Elementary<Self>>(x: X) -> (X, X) {
        let ([s], [c]) = X::sin_cos_all([x]);
        (s, c)
    }

    /// Sines and cosines of several angles, rad. Of numbers it is fastest for a multiple of eight.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sin_cos_all<X: Elementary<Self>, const N: usize>(x: [X; N]) -> ([X; N], [X; N]) {
        X::sin_cos_all(x)
    }

    /// The value of a table, or its derivative of these orders.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn tabulated<X: Elementary<Self>, const N: usize>(table: &Table<N>, x: [X; N], orders: [u8; N]) -> X {
        X::tabulated(table, x, orders)
    }

    elementary_functions!(elementary);
}

impl<A: Registers> Arithmetic for A {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_agree_with_the_standard_library() {
        type A = Compiled;
        assert_eq!(A::atan2(1.0_f64, -2.0), 1.0_f64.atan2(-2.0));
        assert_eq!(A::powf(2.0_f64, 0.5), 2.0_f64.powf(0.5));
        assert_eq!(A::mul_add(2.0_f64, 3.0, 4.0), 10.0);
        assert_eq!(A::mul_sub(2.0_f64, 3.0, 4.0), 2.0);
        assert_eq!(A::neg_mul_add(2.0_f64, 3.0, 4.0), -2.0);
        assert_eq!(A::signum(-3.0_f64), -1.0);
    }
}
