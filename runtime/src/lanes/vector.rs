//! Arithmetic of lanes in vector registers.
//!
//! The compiler's own vectorisation finds isolated loops, but not the vectors of a long straight-line program. `wide`,
//! which nalgebra brings along with the standard library, names the registers; without it every operation is a loop.

use crate::Real;
#[cfg(feature = "std")]
use crate::trigonometry::same;

/// Returns the result if the lanes fill this register.
#[cfg(not(feature = "std"))]
macro_rules! register {
    ($($anything:tt)*) => {};
}
#[cfg(feature = "std")]
macro_rules! register {
    ($number:ident $lanes:literal $register:ident: ($($a:ident)+) => $f:expr) => {
        if N == $lanes
            && size_of::<T>() == size_of::<$number>()
            && let ($(Some($a),)+) = ($(same::<_, [$number; $lanes]>($a),)+)
        {
            $(let $a = wide::$register::new(*$a);)+
            let result = $f.to_array();
            if let Some(result) = same(&result) {
                return *result;
            }
        }
    };
}

macro_rules! operations {
    ($($name:ident($($a:ident)+) = $f:expr;)+) => {$(
        #[inline]
        pub(super) fn $name<T: Real, const N: usize>($($a: &[T; N]),+) -> [T; N] {
            register!(f64 2 f64x2: ($($a)+) => $f);
            register!(f64 4 f64x4: ($($a)+) => $f);
            register!(f64 8 f64x8: ($($a)+) => $f);
            register!(f32 4 f32x4: ($($a)+) => $f);
            register!(f32 8 f32x8: ($($a)+) => $f);
            register!(f32 16 f32x16: ($($a)+) => $f);
            // Plain loops are unrolled where functions of arrays are not always inlined.
            let mut result = [T::zero(); N];
            for (k, result) in result.iter_mut().enumerate() {
                $(let $a = $a[k];)+
                *result = $f;
            }
            result
        }
    )+};
}

operations! {
    add(a b) = a + b;
    sub(a b) = a - b;
    mul(a b) = a * b;
    div(a b) = a / b;
    neg(a) = -a;
    sqrt(a) = a.sqrt();
    fused(a b c) = a.mul_add(b, c);
}

/// The magnitude.
#[inline]
pub(super) fn abs<T: Real, const N: usize>(a: &[T; N]) -> [T; N] {
    register!(f64 2 f64x2: (a) => a.abs());
    register!(f64 4 f64x4: (a) => a.abs());
    register!(f64 8 f64x8: (a) => a.abs());
    a.map(nalgebra::ComplexField::abs)
}

/// The remainder, for which there are no instructions.
#[inline]
pub(super) fn rem<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    core::array::from_fn(|k| a[k] % b[k])
}
