//! Instructions of x86-64 processors that the compilation's target does not promise.

/// Methods that call functions with target features, of the same names.
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
