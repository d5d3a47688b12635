//! Sines and cosines of many angles in lanes.

use super::Lanes;
use crate::Real;
use crate::trigonometry::{LARGEST, kernel, same, with_large};
use core::any::Any;

macro_rules! angles {
    ($function:ident $all:ident $lanes:literal $register:ident $bits:ident, $together:literal) => {
        /// Sines and cosines of small angles, several at a time, so that their long chains of operations overlap.
        #[cfg_attr(debug_assertions, inline)]
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn $function<const M: usize>(x: [Lanes<f64, $lanes>; M]) -> [[Lanes<f64, $lanes>; M]; 2] {
            use wide::{$bits, $register};
            let (s, c, shifted) = kernel(Lanes(x));
            let (mut sines, mut cosines) = (s.0, c.0);
            for k in 0..M {
                let s = $register::new(s.0[k].0).to_bits();
                let c = $register::new(c.0[k].0).to_bits();
                let quadrant = $register::new(shifted.0[k].0).to_bits();
                let (one, sign) = ($bits::splat(1), $bits::splat(1 << 63));
                let exchange = (s ^ c) & ($bits::splat(0) - (quadrant & one));
                let s = s ^ exchange ^ ((quadrant << 62_u32) & sign);
                let c = c ^ exchange ^ (((quadrant + one) << 62_u32) & sign);
                sines[k] = Lanes($register::from_bits(s).to_array());
                cosines[k] = Lanes($register::from_bits(c).to_array());
            }
            [sines, cosines]
        }

        /// Puts the sines in the place of the angles and returns the cosines.
        #[cfg_attr(debug_assertions, inline)]
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn $all<const N: usize>(x: &mut [Lanes<f64, $lanes>; N]) -> [Lanes<f64, $lanes>; N] {
            use wide::$register;
            let mut small = $register::new([f64::from_bits(u64::MAX); $lanes]);
            for x in x.iter() {
                small &= $register::new(x.0).abs().simd_le($register::splat(LARGEST));
            }
            let mut c = [Lanes([0.0; $lanes]); N];
            if !small.all() {
                for (x, c) in x.iter_mut().zip(&mut c) {
                    // A copy, so that the angles themselves need not be in memory.
                    let angles = x.0;
                    (x.0, c.0) = with_large(&angles);
                }
                return c;
            }
            let (mut xs, mut cs) = (x.chunks_exact_mut($together), c.chunks_exact_mut($together));
            for (x, c) in (&mut xs).zip(&mut cs) {
                let mut group = [x[0]; $together];
                group.copy_from_slice(x);
                let [sines, cosines] = $function(group);
                x.copy_from_slice(&sines);
                c.copy_from_slice(&cosines);
            }
            for (x, c) in xs.into_remainder().iter_mut().zip(cs.into_remainder()) {
                let [[sine], [cosine]] = $function([*x]);
                (*x, *c) = (sine, cosine);
            }
            c
        }
    };
}

angles!(two all_two 2 f64x2 u64x2, 4);
angles!(four all_four 4 f64x4 u64x4, 4);
angles!(eight all_eight 8 f64x8 u64x8, 2);

/// Sines and cosines, if the lanes fill a register.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn sin_cos_all<T: Real, const N: usize>(mut x: [T; N]) -> Option<([T; N], [T; N])> {
    macro_rules! case {
        ($lanes:literal $function:ident) => {
            if let Some(s) = (&mut x as &mut dyn Any).downcast_mut::<[Lanes<f64, $lanes>; N]>() {
                let c = $function(s);
                return same(&c).map(|c| (x, *c));
            }
        };
    }
    case!(2 all_two);
    case!(4 all_four);
    case!(8 all_eight);
    None
}
