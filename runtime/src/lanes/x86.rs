//! Implementations with x86-64 instructions that the compilation target does not guarantee; the processor is
//! queried at run time.

/// Defines methods that call the functions of the same names with target features.
macro_rules! methods {
    ($($name:ident($($a:ident)+) $(= $doubles:expr, $singles:expr)?;)+) => {$(
        #[inline(always)]
        fn $name<T: Real, const N: usize>($($a: &[T; N]),+) -> [T; N] {
            // SAFETY: the processor has the instructions.
            unsafe { with_features::$name($($a),+) }
        }
    )+};
}

pub(crate) mod avx2;
pub(crate) mod avx512;
