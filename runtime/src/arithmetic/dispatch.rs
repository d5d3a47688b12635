//! Selection of a body's arithmetic at run time.
//!
//! If the target is x86-64 without fused multiply-add, large functions are compiled twice: for the target,
//! and for processors with AVX2 and FMA, which are detected once. Runtime loops in these functions are also
//! compiled for AVX-512. Debug builds are excluded, because compilation time matters more there, and so are
//! builds without the standard library, which detects the features.

use super::{Arithmetic, Compiled};
use crate::Real;

/// Body of function number `K` of a mechanism, which takes `Arguments`.
pub trait Evaluate<const K: usize, Arguments> {
    /// Type of the result of the function body.
    type Output;

    /// Evaluates the function body; always inlined.
    fn evaluate<A: Arithmetic>(&self, arguments: Arguments) -> Self::Output;
}

/// Evaluates a body on numbers of type `T` with the best instructions available; in debug builds, with those
/// of the target.
#[inline(always)]
pub fn dispatch<const K: usize, T: Real, M: Evaluate<K, Arguments>, Arguments>(
    mechanism: &M,
    arguments: Arguments,
) -> M::Output {
    #[cfg(any(test, not(debug_assertions)))]
    return dispatch_in_any_build::<K, T, M, Arguments>(mechanism, arguments);
    #[cfg(not(any(test, not(debug_assertions))))]
    mechanism.evaluate::<Compiled>(arguments)
}

/// Evaluates a body on numbers of type `T` with the best instructions available, in debug builds, too: their
/// results are then those of code that is generated at run time.
#[inline(always)]
pub fn dispatch_in_any_build<const K: usize, T: Real, M: Evaluate<K, Arguments>, Arguments>(
    mechanism: &M,
    arguments: Arguments,
) -> M::Output {
    #[cfg(all(
        feature = "std",
        target_arch = "x86_64",
        not(all(target_feature = "avx2", target_feature = "fma"))
    ))]
    if crate::lanes::x86::avx2::speeds_up_scalar_type::<T>() && crate::lanes::x86::avx2::is_available() {
        #[expect(unsafe_code, reason = "calls of functions with target features are")]
        // SAFETY: the processor has the features.
        return unsafe { with_avx2(mechanism, arguments) };
    }
    mechanism.evaluate::<Compiled>(arguments)
}

#[cfg(all(
    feature = "std",
    target_arch = "x86_64",
    not(all(target_feature = "avx2", target_feature = "fma"))
))]
#[target_feature(enable = "avx2,fma")]
fn with_avx2<const K: usize, M: Evaluate<K, Arguments>, Arguments>(
    mechanism: &M,
    arguments: Arguments,
) -> M::Output {
    mechanism.evaluate::<crate::lanes::x86::avx2::Avx2>(arguments)
}
