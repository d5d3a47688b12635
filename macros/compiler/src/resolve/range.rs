//! Range checks of masses, moments and lengths: products of two values and reciprocals must remain finite.

use crate::diag::{Diagnostics, Place};
use crate::expr::Expr;
use crate::syntax::ScalarType;

/// Range of parameter values whose products and reciprocals are finite.
#[derive(Clone, Copy, Debug)]
pub struct FiniteParameterRange {
    /// Maximum mass and moment of inertia, whose squares are finite.
    pub max: f64,
    /// Maximum length; with a mass of one, its moment of inertia is in the range of the scalar type.
    pub length: f64,
    /// Minimum nonzero mass and moment of inertia, whose reciprocal is finite.
    pub min_nonzero: f64,
    /// Name of the scalar type, for messages.
    pub name: &'static str,
}

impl FiniteParameterRange {
    /// Returns the range of a scalar type; a type parameter has the range of `f64`.
    pub fn range_of_scalar_type(scalar: &ScalarType) -> FiniteParameterRange {
        match scalar {
            ScalarType::F32 => {
                FiniteParameterRange { max: 1e18, length: 1e9, min_nonzero: 1e-36, name: "f32" }
            }
            _ => FiniteParameterRange { max: 1e150, length: 1e75, min_nonzero: 1e-300, name: "f64" },
        }
    }

    /// Reports a constant mass or moment outside the range. Returns false then.
    pub fn check_mass_in_range(&self, e: Expr<'_>, place: &Place, cx: &mut Diagnostics) -> bool {
        let Some(n) = e.constant_value().filter(|n| *n != 0.0) else { return true };
        if n.abs() > self.max {
            cx.report_error(place.clone(), format!("this number is too large for `{}`: {n:e}", self.name))
                .add_help(format!("products of it overflow; write at most {:e}", self.max));
            return false;
        }
        if n.abs() < self.min_nonzero {
            cx.report_error(place.clone(), format!("this number is too small for `{}`: {n:e}", self.name))
                .add_help(format!("division by it overflows; write 0, or more than {:e}", self.min_nonzero));
            return false;
        }
        true
    }

    /// Reports a constant length outside the range. Returns false then.
    pub fn check_length(&self, e: Expr<'_>, place: &Place, cx: &mut Diagnostics) -> bool {
        let Some(n) = e.constant_value().filter(|n| n.abs() > self.length) else { return true };
        cx.report_error(place.clone(), format!("this length is too large for `{}`: {n:e}", self.name))
            .add_help(format!("its square overflows; write at most {:e} m", self.length));
        false
    }
}
