//! Spelling of scalar types and values in generated code.

use crate::syntax::ScalarType;

/// Spelling of scalar types, constants and parameters in generated code.
#[derive(Clone, Debug)]
pub struct ScalarSpelling {
    scalar: ScalarType,
    parameters: Vec<String>,
    tables: Vec<String>,
    /// Scalar type of functions of several states; `None` for functions of one state.
    lanes: Option<String>,
}

impl ScalarSpelling {
    /// Returns the spelling for a scalar type and the names of the fields of parameters and tables.
    pub fn new(scalar: ScalarType, parameters: Vec<String>, tables: Vec<String>) -> ScalarSpelling {
        ScalarSpelling { scalar, parameters, tables, lanes: None }
    }

    /// Returns the spelling for functions of several states, generic over `LANES`. Parameters have the same
    /// value in all lanes.
    pub fn spelling_in_lanes(&self) -> ScalarSpelling {
        let lanes = Some(format!("::linkwork::Lanes<{}, LANES>", self.single_lane_scalar_type()));
        ScalarSpelling { lanes, ..self.clone() }
    }

    /// Returns the Rust type of the scalar in one SIMD lane.
    pub fn single_lane_scalar_type(&self) -> &str {
        match &self.scalar {
            ScalarType::F64 => "f64",
            ScalarType::F32 => "f32",
            ScalarType::Generic(name) => name,
        }
    }

    /// Returns the name of the scalar type.
    pub fn scalar_name(&self) -> &str {
        self.lanes.as_deref().unwrap_or_else(|| self.single_lane_scalar_type())
    }

    /// Returns true if the scalar is a type parameter of the struct.
    pub fn is_generic(&self) -> bool {
        matches!(self.scalar, ScalarType::Generic(_))
    }

    /// Returns whether the functions have several states in SIMD lanes.
    pub fn uses_batch_lanes(&self) -> bool {
        self.lanes.is_some()
    }

    /// Returns the names of the runtime functions that constants may call.
    pub fn runtime_functions_called_by_constants(&self) -> impl Iterator<Item = &'static str> {
        self.is_generic().then_some("constant").into_iter()
    }

    /// Returns the name of a parameter's field.
    pub fn parameter_field_name(&self, k: usize) -> &str {
        &self.parameters[k]
    }

    /// Returns the name of a table's field.
    pub fn table_field_name(&self, k: usize) -> &str {
        self.tables.get(k).map_or("missing", String::as_str)
    }

    /// Returns the expression of a parameter's value.
    pub fn parameter_value_expression(&self, k: usize) -> String {
        self.broadcast_number(format!("self.{}", self.parameters[k]))
    }

    /// Returns the Rust expression of a constant.
    pub fn constant_expression(&self, c: f64) -> String {
        self.broadcast_number(match &self.scalar {
            ScalarType::Generic(name) => format!("constant::<{name}>({c:?})"),
            ScalarType::F32 if c != 0.0 && !(c.abs() as f32).is_normal() => format!("({c:?}f64 as f32)"),
            _ => format!("{c:?}"),
        })
    }

    /// Returns the expression of a number, broadcast to all lanes for functions of several states.
    pub fn broadcast_number(&self, number: String) -> String {
        match self.uses_batch_lanes() {
            true => format!("Ops::splat::<{}, LANES>({number})", self.single_lane_scalar_type()),
            false => number,
        }
    }
}
