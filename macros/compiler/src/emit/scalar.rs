//! How scalars are spelt in generated code.

use crate::syntax::ScalarType;

/// How scalars are spelt in generated code.
#[derive(Clone, Debug)]
pub struct ScalarSpelling {
    scalar: ScalarType,
    parameters: Vec<String>,
}

impl ScalarSpelling {
    /// For a scalar type and the fields of the parameters, as they are written.
    pub fn new(scalar: ScalarType, parameters: Vec<String>) -> ScalarSpelling {
        ScalarSpelling { scalar, parameters }
    }

    /// The type.
    pub fn name(&self) -> &str {
        match &self.scalar {
            ScalarType::F64 => "f64",
            ScalarType::F32 => "f32",
            ScalarType::Generic(name) => name,
        }
    }

    /// True for the struct's own type parameter.
    pub fn is_generic(&self) -> bool {
        matches!(self.scalar, ScalarType::Generic(_))
    }

    /// The field of a parameter.
    pub fn parameter(&self, k: usize) -> &str {
        &self.parameters[k]
    }

    /// A constant.
    pub fn constant(&self, c: f64) -> String {
        match &self.scalar {
            ScalarType::Generic(name) => format!("constant::<{name}>({c:?})"),
            ScalarType::F32 if c != 0.0 && !(c.abs() as f32).is_normal() => format!("({c:?}f64 as f32)"),
            _ => format!("{c:?}"),
        }
    }
}
