//! Arithmetic of generated functions: that of the compilation target, or that of the processor at run time.
//!
//! A generated body is generic over [`Arithmetic`]. [`Compiled`] uses the instructions of the compilation
//! target; large functions may be dispatched at run time to more instructions
//! ([`dispatch`](dispatch::dispatch)). A body and all functions that it calls are inlined, so that they are
//! compiled with the target features of the enclosing function. Without optimisation, inlining is not forced:
//! each inlined call would store its arguments on the stack of the body and double its size.

/// Passes the list of elementary functions to the macro `$make`.
macro_rules! elementary_functions {
    ($make:ident) => {
        $make! {
            /// Returns the square root; NaN for `x < 0`.
            sqrt(x);
            /// Returns the sine of the angle `x`, rad.
            sin(x);
            /// Returns the cosine of the angle `x`, rad.
            cos(x);
            /// Returns the tangent of the angle `x`, rad.
            tan(x);
            /// Returns the arc sine, rad; NaN outside [−1, 1].
            asin(x);
            /// Returns the arc cosine, rad; NaN outside [−1, 1].
            acos(x);
            /// Returns the arc tangent of `x`, rad.
            atan(x);
            /// Returns the angle of the point (`x`, `y`), rad: `atan2(y, x)` as in the standard library.
            atan2(y, x);
            /// Returns the hyperbolic sine of `x`.
            sinh(x);
            /// Returns the hyperbolic cosine of `x`.
            cosh(x);
            /// Returns the hyperbolic tangent of `x`.
            tanh(x);
            /// Returns the exponential function of `x`.
            exp(x);
            /// Returns the natural logarithm; NaN for `x < 0`.
            ln(x);
            /// Returns `x` to the power `y`; NaN for `x < 0` and noninteger `y`.
            powf(x, y);
            /// Returns the smaller of two numbers; if one is NaN, the other one.
            min(x, y);
            /// Returns the larger of two numbers; if one is NaN, the other one.
            max(x, y);
            /// Returns the magnitude of `x`.
            abs(x);
            /// Returns 1 or −1 with the sign of `x`, also for zeros.
            signum(x);
            /// Returns the temperature, K, of the standard atmosphere at a geopotential height, m.
            isa_temperature(h);
            /// Returns the derivative, K/m, of the standard atmosphere's temperature with respect to the
            /// height.
            isa_lapse_rate(h);
            /// Returns the pressure, Pa, of the standard atmosphere at a geopotential height, m.
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

/// Arithmetic with the instructions of the compilation target.
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

/// Operations that generated bodies call, on numbers (every [`Real`](crate::Real)) and on lanes (`Vector`).
pub trait Arithmetic: Registers {
    /// Returns `a b + c`, fused if the hardware supports it.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul_add<X: Number<Self>>(a: X, b: X, c: X) -> X {
        if Self::FUSED { X::fused(a, b, c) } else { a * b + c }
    }

    /// Returns `a b − c`, fused if the hardware supports it.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul_sub<X: Number<Self>>(a: X, b: X, c: X) -> X {
        if Self::FUSED { X::fused(a, b, -c) } else { a * b - c }
    }

    /// Returns `c - a b`, fused if the hardware supports it.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn neg_mul_add<X: Number<Self>>(a: X, b: X, c: X) -> X {
        if Self::FUSED { X::fused(-a, b, c) } else { c - a * b }
    }

    /// Returns a vector with the given lanes.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<T, const N: usize>(numbers: [T; N]) -> Vector<Self, T, N> {
        Vector::from(Lanes(numbers))
    }

    /// Returns a vector with the same number in every lane.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn splat<T: Copy, const N: usize>(x: T) -> Vector<Self, T, N> {
        Vector::from(Lanes([x; N]))
    }

    /// Returns the product `x a` of a scalar and a vector of lanes.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn scale<T: Real, const N: usize>(x: T, a: Vector<Self, T, N>) -> Vector<Self, T, N> {
        Vector::splat(x) * a
    }

    /// Returns `x a + c`, fused if the hardware supports it.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn scale_add<T: Real, const N: usize>(
        x: T,
        a: Vector<Self, T, N>,
        c: Vector<Self, T, N>,
    ) -> Vector<Self, T, N> {
        Self::mul_add(Vector::splat(x), a, c)
    }

    /// Returns `x a - c`, fused if the hardware supports it.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn scale_sub<T: Real, const N: usize>(
        x: T,
        a: Vector<Self, T, N>,
        c: Vector<Self, T, N>,
    ) -> Vector<Self, T, N> {
        Self::mul_sub(Vector::splat(x), a, c)
    }

    /// Returns `c - x a`, fused if the hardware supports it.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn neg_scale_add<T: Real, const N: usize>(
        x: T,
        a: Vector<Self, T, N>,
        c: Vector<Self, T, N>,
    ) -> Vector<Self, T, N> {
        Self::neg_mul_add(Vector::splat(x), a, c)
    }

    /// Concatenates the lanes of two vectors. Does not compile if `M` is not `2 N`.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn join<T: Copy, const N: usize, const M: usize>(
        a: Vector<Self, T, N>,
        b: Vector<Self, T, N>,
    ) -> Vector<Self, T, M> {
        Vector::join_vectors(&a, &b)
    }

    /// Stores lane `I` of one vector and lane `J` of another vector to rows `ROW` and `ROW + 1` of a matrix
    /// column. Fails to compile if there are fewer lanes or rows.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store_two_lanes_in_column<
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
        const { assert!(ROW + 1 < R, "there are fewer rows") };
        const { assert!(I < N && J < M, "there are fewer lanes") };
        if let Some(rows) = column.get_mut(ROW..).and_then(<[T]>::first_chunk_mut)
            && let Some(two) = a.pair_of_lanes(I, &b, J)
        {
            *rows = two;
        }
    }

    /// Stores all lanes of a vector to the rows of a column from `ROW` on. Does not compile if there are
    /// fewer rows.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store_lanes_in_column<const ROW: usize, T: Real, const N: usize, const R: usize>(
        column: &mut [T; R],
        a: Vector<Self, T, N>,
    ) {
        const { assert!(ROW + N <= R, "there are fewer rows") };
        if let Some(rows) = column.get_mut(ROW..).and_then(<[T]>::first_chunk_mut) {
            *rows = *a.lane_numbers();
        }
    }

    /// Stores the lanes of one vector to row `ROW` of a matrix, one lane per column from column `COLUMN` on,
    /// and those of another vector to the row below. Fails to compile if there are fewer rows or columns, or
    /// more than eight lanes.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store_two_rows<
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
        const { assert!(ROW + 1 < R && COLUMN + N <= C, "there are fewer rows or columns") };
        const { assert!(N <= 8, "there are more lanes") };
        let columns = columns.get_mut(COLUMN..).and_then(<[_]>::first_chunk_mut::<N>);
        let Some(columns) = columns else { return };
        // Not a loop: lanes with a variable index are stored in memory until the loop is unrolled.
        macro_rules! store {
            ($($lane:literal)+) => {$(
                if let Some(two) = a.pair_of_lanes($lane, &b, $lane)
                    && let Some(column) = columns.get_mut($lane)
                    && let Some(rows) = column.get_mut(ROW..).and_then(<[T]>::first_chunk_mut)
                {
                    *rows = two;
                }
            )+};
        }
        store!(0 1 2 3 4 5 6 7);
    }

    /// Converts arguments in lanes to SIMD vectors, without copying.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn each<T, const N: usize, const R: usize>(numbers: &[Lanes<T, N>; R]) -> &[Vector<Self, T, N>; R] {
        Vector::from_lanes(numbers)
    }

    /// Returns sine and cosine of an angle, or of the angle in each lane, rad.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sin_cos<X: Elementary<Self>>(x: X) -> (X, X) {
        let ([s], [c]) = X::sin_cos_all([x]);
        (s, c)
    }

    /// Returns sines and cosines of several angles, rad. For numbers, multiples of eight angles are fastest.
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sin_cos_all<X: Elementary<Self>, const N: usize>(x: [X; N]) -> ([X; N], [X; N]) {
        X::sin_cos_all(x)
    }

    /// Returns the value of a table by interpolation, or its derivative. `orders` are the orders of
    /// differentiation with respect to each argument.
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
    fn arithmetic_matches_the_standard_library() {
        type A = Compiled;
        assert_eq!(A::atan2(1.0_f64, -2.0), 1.0_f64.atan2(-2.0));
        assert_eq!(A::powf(2.0_f64, 0.5), 2.0_f64.powf(0.5));
        assert_eq!(A::mul_add(2.0_f64, 3.0, 4.0), 10.0);
        assert_eq!(A::mul_sub(2.0_f64, 3.0, 4.0), 2.0);
        assert_eq!(A::neg_mul_add(2.0_f64, 3.0, 4.0), -2.0);
        assert_eq!(A::signum(-3.0_f64), -1.0);
    }
}
