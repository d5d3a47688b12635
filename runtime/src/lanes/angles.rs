//! Sines and cosines of many angles in SIMD lanes.

use super::registers::Registers;
use crate::Real;
use crate::arithmetic::Vector;
use crate::trigonometry::{CacheAligned, reduced_sine_and_cosine, reference_if_same_type};
use core::any::Any;

/// Returns sines and cosines of angles, rad, that are within the range of the fast argument reduction.
#[inline(always)]
pub(super) fn sin_cos_of_small<A: Registers, const L: usize>(x: &[f64; L]) -> [[f64; L]; 2] {
    let (s, c, shifted) = reduced_sine_and_cosine::<A, _>(Vector::<A, f64, L>::from_array(*x));
    A::rotate_quadrants(s.lane_numbers(), c.lane_numbers(), shifted.lane_numbers())
}

/// Replaces the angles, rad, by their sines and returns the cosines.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
fn replace_by_sines_return_cosines<A: Registers, const L: usize, const N: usize>(
    x: &mut [Vector<A, f64, L>; N],
) -> [Vector<A, f64, L>; N] {
    let mut c = [Vector::splat(0.0); N];
    if !A::are_angles_in_fast_range(&x.map(|x| *x.lane_numbers())) {
        for (x, c) in x.iter_mut().zip(&mut c) {
            // A copy, so that the angles themselves need not be stored in memory.
            let angles = CacheAligned(*x.lane_numbers());
            let (sines, cosines) = A::sin_cos_of_large(&angles.0);
            (*x, *c) = (Vector::from_array(sines), Vector::from_array(cosines));
        }
        return c;
    }
    for (x, c) in x.iter_mut().zip(&mut c) {
        let [sines, cosines] = A::sin_cos_of_small(x.lane_numbers());
        (*x, *c) = (Vector::from_array(sines), Vector::from_array(cosines));
    }
    c
}

/// Sines and cosines of the same angles.
type SinesAndCosines<X> = (X, X);

/// Returns sines and cosines of angles, rad, if the lanes fill a register, otherwise `None`.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn sin_cos_all<A: Registers, T: Real, const L: usize, const N: usize>(
    mut x: [Vector<A, T, L>; N],
) -> Option<SinesAndCosines<[Vector<A, T, L>; N]>> {
    macro_rules! case {
        ($lanes:literal) => {
            if let Some(s) = (&mut x as &mut dyn Any).downcast_mut::<[Vector<A, f64, $lanes>; N]>() {
                let c = replace_by_sines_return_cosines::<A, $lanes, N>(s);
                return reference_if_same_type(&c).map(|c| (x, *c));
            }
        };
    }
    case!(2);
    case!(4);
    case!(8);
    None
}

/// Returns sines and cosines of angles, rad, whose scalar type is itself SIMD lanes, if these lanes fill a
/// register; otherwise `None`.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn sin_cos_of_lanes<A: Registers, T: Real, const N: usize>(
    x: &[T; N],
) -> Option<SinesAndCosines<[T; N]>> {
    macro_rules! case {
        ($lanes:literal) => {
            if let Some(x) = reference_if_same_type::<_, [crate::Lanes<f64, $lanes>; N]>(x)
                && let Some((s, c)) = sin_cos_all(x.map(Vector::<A, f64, $lanes>::from))
                && let (s, c) = (s.map(Vector::lanes), c.map(Vector::lanes))
                && let (Some(s), Some(c)) = (reference_if_same_type(&s), reference_if_same_type(&c))
            {
                return Some((*s, *c));
            }
        };
    }
    case!(2);
    case!(4);
    case!(8);
    None
}
