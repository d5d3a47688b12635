//! Numbers of several states side by side: the lanes of vector registers.
//!
//! A mechanism whose scalars are [`Lanes`] is evaluated for several states (or several equal limbs) at once. Each lane
//! holds, bit for bit, what the same operations give for its numbers alone: nothing is reassociated, fused
//! multiplication and addition are used where scalars use them, and nothing depends on the neighbours.

#[cfg(feature = "std")]
pub(crate) mod angles;
mod field;
mod numeric;
mod registers;
#[cfg(all(
    feature = "std",
    target_arch = "x86_64",
    not(all(target_feature = "avx2", target_feature = "fma")),
    any(test, not(debug_assertions))
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

/// `N` numbers, with all arithmetic and all elementary functions from lane to lane.
///
/// It is a [`Real`], so that a generic mechanism can be instantiated with it. Three things are not done lane by lane:
///
/// - Comparisons ask for all lanes: `a < b` where it is so in every lane, and neither `a < b` nor `b < a` where lanes
///   differ. Algorithms that branch (factorisations with pivots, adaptive steps) are therefore not meant for lanes;
///   [`select`](Self::select) chooses lane by lane.
/// - `is_finite` asks for any lane, since integrators stop where it is false: lanes that are not finite do not stop the others.
/// - [`sum`](Self::sum) adds the lanes to one another, in a fixed order.
///
/// The angles of [`sin_cos`](Self::sin_cos) may be of any size.
#[derive(Clone, Copy, Debug, PartialEq)]
// Two lanes or more in registers of 16 or 32 bytes never cross a line of the cache.
#[repr(align(32))]
pub struct Lanes<T, const N: usize>(
    /// The numbers, lane by lane.
    pub [T; N],
);

/// Four double-precision lanes: a register of AVX2.
#[allow(non_camel_case_types, reason = "the customary name")]
pub type f64x4 = Lanes<f64, 4>;
/// Eight double-precision lanes: a register of AVX-512, two of AVX2, four of SSE2 or NEON.
#[allow(non_camel_case_types, reason = "the customary name")]
pub type f64x8 = Lanes<f64, 8>;
/// Eight single-precision lanes: a register of AVX2.
#[allow(non_camel_case_types, reason = "the customary name")]
pub type f32x8 = Lanes<f32, 8>;
/// Sixteen single-precision lanes: a register of AVX-512.
#[allow(non_camel_case_types, reason = "the customary name")]
pub type f32x16 = Lanes<f32, 16>;

impl<T: Copy, const N: usize> Lanes<T, N> {
    /// The same number in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(x: T) -> Self {
        Self([x; N])
    }

    /// The number of each lane from its index.
    #[inline(always)]
    #[must_use]
    pub fn from_fn(f: impl FnMut(usize) -> T) -> Self {
        Self(core::array::from_fn(f))
    }

    /// The first `M` lanes. Does not compile if there are fewer.
    #[inline(always)]
    #[must_use]
    pub fn first<const M: usize>(self) -> Lanes<T, M> {
        const { assert!(M <= N, "there are not so many lanes") };
        Lanes::from_fn(|k| self.0[k])
    }

    /// A function of each lane.
    #[inline(always)]
    #[must_use]
    pub fn map<U: Copy>(self, f: impl FnMut(T) -> U) -> Lanes<U, N> {
        Lanes(self.0.map(f))
    }

    /// A function of each lane and the same lane of another.
    #[inline(always)]
    #[must_use]
    pub fn zip<U: Copy, V: Copy>(self, other: Lanes<U, N>, mut f: impl FnMut(T, U) -> V) -> Lanes<V, N> {
        Lanes::from_fn(|k| f(self.0[k], other.0[k]))
    }

    /// In each lane the number of `a` where the mask is true, else that of `b`.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: [bool; N], a: Self, b: Self) -> Self {
        Self::from_fn(|k| if mask[k] { a.0[k] } else { b.0[k] })
    }
}

impl<T: Real, const N: usize> Lanes<T, N> {
    /// The sum of all lanes: the upper half of the lanes is added to the lower half until one is left, the middle of an
    /// odd number waiting for the next turn. Four lanes are summed as `(x₀ + x₂) + (x₁ + x₃)`.
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

    /// Sines and cosines, rad, of angles of any size.
    #[inline(always)]
    #[must_use]
    pub fn sin_cos(self) -> (Self, Self) {
        let (s, c) = Compiled::sin_cos(Compiled::lanes(self.0));
        (s.lanes(), c.lanes())
    }

    /// `self * b + c`, fused where the hardware can.
    #[inline(always)]
    #[must_use]
    pub fn mul_add(self, b: Self, c: Self) -> Self {
        if Compiled::FUSED { Self(Compiled::fused(&self.0, &b.0, &c.0)) } else { self * b + c }
    }
}

/// A constant or parameter in all lanes, for generated code.
#[inline(always)]
pub fn splat<T: Copy, const N: usize>(x: T) -> Lanes<T, N> {
    Lanes::splat(x)
}

/// One lane of a column, for generated code.
#[inline]
pub fn lane<T: Real, const N: usize, const R: usize, const C: usize>(
    x: &SMatrix<Lanes<T, N>, R, C>,
    k: usize,
) -> SMatrix<T, R, C> {
    x.map(|x| x.0.get(k).copied().unwrap_or(T::zero()))
}

/// A matrix from the matrices of its lanes, for generated code. One after another: in a debug build each takes its place on the
/// stack.
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

/// Puts a matrix into lane `k` of one, for generated code.
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

/// A lane; panics for one that is not there.
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

        /// With the same number in every lane.
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
