//! SIMD vectors of lanes that generated function bodies compute with.

use crate::lanes::Registers;
#[cfg(feature = "std")]
use crate::trigonometry::reference_if_same_type;
use crate::{Lanes, Real};
use core::marker::PhantomData;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// Vector of lanes whose arithmetic uses the registers of `A`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Vector<A, T, const N: usize>(Lanes<T, N>, PhantomData<A>);

impl<A, T, const N: usize> From<Lanes<T, N>> for Vector<A, T, N> {
    #[inline(always)]
    fn from(lanes: Lanes<T, N>) -> Self {
        Self(lanes, PhantomData)
    }
}

impl<A, T, const N: usize> Vector<A, T, N> {
    /// Converts lanes to SIMD vectors without copying.
    #[inline(always)]
    pub fn from_lanes<const R: usize>(lanes: &[Lanes<T, N>; R]) -> &[Self; R] {
        #[expect(unsafe_code, reason = "no safe function converts references to transparent types")]
        // SAFETY: a vector is transparent over its lanes, and arrays of the two have the same layout.
        unsafe {
            &*core::ptr::from_ref(lanes).cast()
        }
    }
}

impl<A, T: Copy, const N: usize> Vector<A, T, N> {
    #[inline(always)]
    pub(crate) fn from_array(numbers: [T; N]) -> Self {
        Self(Lanes(numbers), PhantomData)
    }

    #[inline]
    pub(crate) fn splat(x: T) -> Self {
        Self::from_array([x; N])
    }

    #[inline(always)]
    pub(crate) fn lane_numbers(&self) -> &[T; N] {
        &self.0.0
    }

    /// Returns the lanes, as the result of a function.
    #[inline(always)]
    pub fn lanes(self) -> Lanes<T, N> {
        self.0
    }

    /// Returns lane `K` of the vector. Fails to compile if there are fewer lanes. Takes a reference, because
    /// without optimisation every copy needs stack.
    #[inline(always)]
    pub fn lane<const K: usize>(&self) -> T {
        const { assert!(K < N, "there are fewer lanes") };
        self.0.0[K]
    }

    /// Concatenates the lanes of two vectors. Does not compile if `M` is not `2 N`.
    #[inline]
    pub(crate) fn join_vectors<const M: usize>(a: &Vector<A, T, N>, b: &Vector<A, T, N>) -> Vector<A, T, M> {
        const { assert!(N > 0 && M == 2 * N, "half of the lanes come from either") };
        let mut numbers = [a.0.0[0]; M];
        let mut places = numbers.iter_mut();
        for (x, place) in a.lane_numbers().iter().zip(places.by_ref()) {
            *place = *x;
        }
        for (x, place) in b.lane_numbers().iter().zip(places) {
            *place = *x;
        }
        Vector::from_array(numbers)
    }

    /// Returns the first `M` lanes of the vector. Does not compile if there are fewer.
    #[inline]
    pub fn first<const M: usize>(&self) -> Vector<A, T, M> {
        Vector::from(self.0.first())
    }
}

impl<A, T: Real, const N: usize> Vector<A, T, N> {
    /// Returns lane `i` of this vector and lane `j` of another vector, if both exist. The indices are
    /// constant after inlining.
    #[inline(always)]
    pub(crate) fn pair_of_lanes<const M: usize>(
        &self,
        i: usize,
        other: &Vector<A, T, M>,
        j: usize,
    ) -> Option<[T; 2]> {
        let (a, b) = (self.lane_numbers(), other.lane_numbers());
        // Through registers: lanes used more than once would otherwise be stored one by one.
        #[cfg(feature = "std")]
        if i % 2 == j % 2
            && i < N
            && j < M
            && N.is_multiple_of(2)
            && M.is_multiple_of(2)
            && let (Some(a), Some(b)) =
                (reference_if_same_type::<_, [f64; N]>(a), reference_if_same_type::<_, [f64; M]>(b))
        {
            let (k, l) = (i - i % 2, j - j % 2);
            let (a, b) = (wide::f64x2::new([a[k], a[k + 1]]), wide::f64x2::new([b[l], b[l + 1]]));
            let two = wide::f64x2::transpose([a, b])[i % 2].to_array();
            if let Some(two) = reference_if_same_type(&two) {
                return Some(*two);
            }
        }
        Some([*a.get(i)?, *b.get(j)?])
    }

    /// Returns the sum of all lanes, in the order of [`Lanes::sum`].
    #[inline]
    pub fn sum(&self) -> T {
        self.0.sum()
    }
}

macro_rules! operators {
    ($($operator:ident $function:ident;)+) => {$(
        impl<A: Registers, T: Real, const N: usize> $operator for Vector<A, T, N> {
            type Output = Self;

            #[cfg_attr(debug_assertions, inline)]
            #[cfg_attr(not(debug_assertions), inline(always))]
            fn $function(self, other: Self) -> Self {
                Self::from_array(A::$function(self.lane_numbers(), other.lane_numbers()))
            }
        }
    )+};
}

operators! {
    Add add;
    Sub sub;
    Mul mul;
    Div div;
}

impl<A: Registers, T: Real, const N: usize> Neg for Vector<A, T, N> {
    type Output = Self;

    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn neg(self) -> Self {
        Self::from_array(A::neg(self.lane_numbers()))
    }
}
