//! Numbers of several states in the lanes of SIMD registers.
//!
//! A mechanism whose scalars are [`Lanes`] is evaluated for several states (or several identical limbs) at
//! once. Each lane equals, bit for bit, the result of the same operations on its numbers alone: no operation
//! is reassociated, fused multiply-add is used exactly where scalars use it, and lanes do not depend on each
//! other.

#[cfg(feature = "std")]
pub(crate) mod angles;
mod field;
mod numeric;
mod registers;
#[cfg(all(
    feature = "std",
    target_arch = "x86_64",
    not(all(target_feature = "avx2", target_feature = "fma"))
))]
pub(crate) mod x86;

use crate::Real;
use crate::arithmetic::{Arithmetic, Compiled};
use core::fmt;
use core::ops::{
    Add, AddAssign, Div, DivAssign, Index, IndexMut, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign,
};
use nalgebra::{ArrayStorage, SMatrix};
pub(crate) use registers::{Registers, VectorLoop};

/// `N` numbers with lane-by-lane arithmetic and elementary functions.
///
/// The type is a [`Real`], so that a generic mechanism can be instantiated with it. Three operations do not
/// act lane by lane:
///
/// - Comparisons combine all lanes: `a < b` is true if it is true in every lane, and both `a < b` and `b < a`
///   are false if lanes differ. Algorithms that branch (factorisations with pivots, adaptive steps) are
///   therefore unsuitable for lanes; [`select`](Self::select) chooses lane by lane.
/// - `is_finite` is true if any lane is finite, because integrators stop if it is false: lanes that are not
///   finite do not stop the others.
/// - [`sum`](Self::sum) adds the lanes to one another, in a fixed order.
///
/// The angles of [`sin_cos`](Self::sin_cos) may be of any magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
// With this alignment, registers of 16 or 32 bytes of two lanes or more never cross a cache line.
#[repr(align(32))]
pub struct Lanes<T, const N: usize>(
    /// One number for each lane, in the order of the lanes.
    pub [T; N],
);

/// SIMD vector of four double-precision numbers: one register of AVX2.
#[allow(non_camel_case_types, reason = "the customary name")]
pub type f64x4 = Lanes<f64, 4>;
/// Eight double-precision lanes: a register of AVX-512, two of AVX2, four of SSE2 or NEON.
#[allow(non_camel_case_types, reason = "the customary name")]
pub type f64x8 = Lanes<f64, 8>;
/// SIMD vector of eight single-precision numbers: one register of AVX2.
#[allow(non_camel_case_types, reason = "the customary name")]
pub type f32x8 = Lanes<f32, 8>;
/// SIMD vector of sixteen single-precision numbers: one register of AVX-512.
#[allow(non_camel_case_types, reason = "the customary name")]
pub type f32x16 = Lanes<f32, 16>;

impl<T: Copy, const N: usize> Lanes<T, N> {
    /// Returns lanes with the same number in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(x: T) -> Self {
        Self([x; N])
    }

    /// Returns lanes computed from the index of each lane.
    #[inline(always)]
    #[must_use]
    pub fn from_fn(f: impl FnMut(usize) -> T) -> Self {
        Self(core::array::from_fn(f))
    }

    /// Returns the first `M` lanes. Does not compile if `N` is less than `M`.
    #[inline(always)]
    #[must_use]
    pub fn first<const M: usize>(self) -> Lanes<T, M> {
        const { assert!(M <= N, "there are fewer lanes") };
        Lanes::from_fn(|k| self.0[k])
    }

    /// Applies a function to the number in each lane and returns the results as lanes.
    #[inline(always)]
    #[must_use]
    pub fn map<U: Copy>(self, f: impl FnMut(T) -> U) -> Lanes<U, N> {
        Lanes(self.0.map(f))
    }

    /// Applies a function to the numbers in each lane of `self` and `other`, and returns the results as
    /// lanes.
    #[inline(always)]
    #[must_use]
    pub fn zip<U: Copy, V: Copy>(self, other: Lanes<U, N>, mut f: impl FnMut(T, U) -> V) -> Lanes<V, N> {
        Lanes::from_fn(|k| f(self.0[k], other.0[k]))
    }

    /// Selects a number lane by lane: that of `a` where the mask is true, otherwise that of `b`.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: [bool; N], a: Self, b: Self) -> Self {
        Self::from_fn(|k| if mask[k] { a.0[k] } else { b.0[k] })
    }
}

impl<T: Real, const N: usize> Lanes<T, N> {
    /// Returns the sum of all lanes. The upper half of the lanes is added to the lower half until one lane is
    /// left, so that four lanes are summed as `(x₀ + x₂) + (x₁ + x₃)`. For an odd number of lanes, the middle
    /// one waits for the next round.
    #[inline(always)]
    #[must_use]
    pub fn sum(self) -> T {
        let mut x = self.0;
        let mut n = N;
        while n > 1 {
            let half = n.div_ceil(2);
            for k in half..n {
                x[k - half] += x[k];
            }
            n = half;
        }
        x.first().copied().unwrap_or(T::zero())
    }

    /// Returns the sine and the cosine of the angle in each lane, rad, of any magnitude.
    #[inline(always)]
    #[must_use]
    pub fn sin_cos(self) -> (Self, Self) {
        let (s, c) = Compiled::sin_cos(Compiled::lanes(self.0));
        (s.lanes(), c.lanes())
    }

    /// Returns `self * b + c` lane by lane, fused if the hardware supports it.
    #[inline(always)]
    #[must_use]
    pub fn mul_add(self, b: Self, c: Self) -> Self {
        if Compiled::FUSED { Self(Compiled::fused(&self.0, &b.0, &c.0)) } else { self * b + c }
    }
}

/// Returns lanes that all contain a constant or parameter, for generated code.
#[inline(always)]
pub fn splat<T: Copy, const N: usize>(x: T) -> Lanes<T, N> {
    Lanes::splat(x)
}

/// Extracts lane `k` of a matrix of SIMD lanes as a matrix of scalars, for generated code.
#[inline]
pub fn lane<T: Real, const N: usize, const R: usize, const C: usize>(
    x: &SMatrix<Lanes<T, N>, R, C>,
    k: usize,
) -> SMatrix<T, R, C> {
    x.map(|x| x.0.get(k).copied().unwrap_or(T::zero()))
}

/// Assembles a matrix of SIMD lanes from the scalar matrices of the lanes, for generated code. The scalar
/// matrices are computed one after another, because each occupies stack in a debug build.
#[inline]
pub fn lane_by_lane<T: Real, const N: usize, const R: usize, const C: usize>(
    mut f: impl FnMut(usize) -> SMatrix<T, R, C>,
) -> SMatrix<Lanes<T, N>, R, C> {
    let mut all = SMatrix::from_array_storage(ArrayStorage([[Lanes([T::zero(); N]); R]; C]));
    for k in 0..N {
        set_lane(&mut all, k, &f(k));
    }
    all
}

/// Writes a matrix to lane `k` of another, for generated code.
#[inline]
pub fn set_lane<T: Real, const N: usize, const R: usize, const C: usize>(
    all: &mut SMatrix<Lanes<T, N>, R, C>,
    k: usize,
    one: &SMatrix<T, R, C>,
) {
    for (lanes, x) in all.iter_mut().zip(one) {
        lanes.0.iter_mut().skip(k).take(1).for_each(|lane| *lane = *x);
    }
}

impl<T, const N: usize> From<[T; N]> for Lanes<T, N> {
    #[inline(always)]
    fn from(numbers: [T; N]) -> Self {
        Self(numbers)
    }
}

impl<T, const N: usize> From<Lanes<T, N>> for [T; N] {
    #[inline(always)]
    fn from(lanes: Lanes<T, N>) -> Self {
        lanes.0
    }
}

impl<T: Real, const N: usize> Default for Lanes<T, N> {
    #[inline(always)]
    fn default() -> Self {
        Self::splat(T::zero())
    }
}

/// Accesses a lane; panics if the index is out of range.
impl<T, const N: usize> Index<usize> for Lanes<T, N> {
    type Output = T;

    #[inline(always)]
    fn index(&self, lane: usize) -> &T {
        &self.0[lane]
    }
}

impl<T, const N: usize> IndexMut<usize> for Lanes<T, N> {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut T {
        &mut self.0[lane]
    }
}

impl<T: fmt::Display, const N: usize> fmt::Display for Lanes<T, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[")?;
        for (k, x) in self.0.iter().enumerate() {
            f.write_str(if k == 0 { "" } else { ", " })?;
            x.fmt(f)?;
        }
        f.write_str("]")
    }
}

macro_rules! operators {
    ($($operator:ident $function:ident $assigning:ident $assign:ident $symbol:tt;)+) => {$(
        impl<T: Real, const N: usize> $operator for Lanes<T, N> {
            type Output = Self;

            #[cfg_attr(debug_assertions, inline)]
            #[cfg_attr(not(debug_assertions), inline(always))]
            fn $function(self, other: Self) -> Self {
                Self(operators!(@apply $function)(&self.0, &other.0))
            }
        }

        /// Combines each lane with the same scalar `other`.
        impl<T: Real, const N: usize> $operator<T> for Lanes<T, N> {
            type Output = Self;

            #[cfg_attr(debug_assertions, inline)]
            #[cfg_attr(not(debug_assertions), inline(always))]
            fn $function(self, other: T) -> Self {
                self $symbol Self::splat(other)
            }
        }

        impl<T: Real, const N: usize> $assigning for Lanes<T, N> {
            #[cfg_attr(debug_assertions, inline)]
            #[cfg_attr(not(debug_assertions), inline(always))]
            fn $assign(&mut self, other: Self) {
                *self = *self $symbol other;
            }
        }

        impl<T: Real, const N: usize> $assigning<T> for Lanes<T, N> {
            #[cfg_attr(debug_assertions, inline)]
            #[cfg_attr(not(debug_assertions), inline(always))]
            fn $assign(&mut self, other: T) {
                *self = *self $symbol other;
            }
        }
    )+};
    (@apply rem) => { registers::rem };
    (@apply $function:ident) => { Compiled::$function };
}

operators! {
    Add add AddAssign add_assign +;
    Sub sub SubAssign sub_assign -;
    Mul mul MulAssign mul_assign *;
    Div div DivAssign div_assign /;
    Rem rem RemAssign rem_assign %;
}

impl<T: Real, const N: usize> Neg for Lanes<T, N> {
    type Output = Self;

    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn neg(self) -> Self {
        Self(Compiled::neg(&self.0))
    }
}

#[cfg(test)]
mod tests;
