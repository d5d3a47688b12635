//! Random values of symbols, for numeric tests of identities between expressions.

use super::eval::eval_one;
use super::{Expr, Symbol};

/// Tolerance for comparing values of expressions at random symbols.
const TOLERANCE: f64 = 1e-9;

/// Returns a reproducible value in [0.5, 1.5) for a symbol. Each `seed` gives another set of values; special
/// values are unlikely.
pub fn sample_of_symbol(symbol: Symbol, seed: u64) -> f64 {
    let mut h = (u64::from(symbol.0) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ (seed + 1).wrapping_mul(0xD1B5_4A32_D192_ED03);
    h = (h ^ (h >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    h ^= h >> 31;
    0.5 + (h >> 11) as f64 / (1_u64 << 53) as f64
}

/// Returns true if an expression equals `value`, within the tolerance, at three samples.
pub fn always_equals_number(e: Expr<'_>, value: f64) -> bool {
    (0..3).all(|seed| (eval_one(e, &|s| sample_of_symbol(s, seed)) - value).abs() <= TOLERANCE)
}
