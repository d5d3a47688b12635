//! How scalars are spelt in generated code.

use crate::syntax::ScalarType;

/// How scalars are spelt in generated code.
#[derive(Clone, Debug)]
pub struct ScalarSpelling {
    scalar: ScalarType,
    parameters: Vec<String>,
    tables: Vec<String>,
    /// The type where functions take several states at once.
    lanes: Option<String>,
}

impl ScalarSpelling {
    /// For a scalar type and the fields of the parameters and of the tables, as they are written.
    pub fn new(scalar: ScalarType, parameters: Vec<String>, tables: Vec<String>) -> ScalarSpelling {
        ScalarSpelling { scalar, parameters, tables, lanes: None }
    }

    /// The same for functions of several states at once, generic over `LANES`. Parameters have the same value in all.
    pub fn in_lanes(&self) -> ScalarSpelling {
        let lanes = Some(format!("::linkwork::Lanes<{}, LANES>", self.one()));
        ScalarSpelling { lanes, ..self.clone() }
    }

    /// The type of one lane.
    pub fn one(&self) -> &str {
        match &self.scalar {
            ScalarType::F64 => "f64",
            ScalarType::F32 => "f32",
            ScalarType::Generic(name) => name,
        }
    }

    /// The type.
    pub fn name(&self) -> &str {
        self.lanes.as_deref().unwrap_or_else(|| self.one())
    }

    /// True for the struct's own type parameter.
    pub fn is_generic(&self) -> bool {
        matches!(self.scalar, ScalarType::Generic(_))
    }

    /// True where functions take several states at once.
    pub fn is_in_lanes(&self) -> bool {
        self.lanes.is_some()
    }

    /// The functions of the runtime that constants may call.
    pub fn helpers(&self) -> impl Iterator<Item = &'static str> {
        self.is_generic().then_some("constant").into_iter()
    }

    /// The field of a parameter.
    pub fn parameter(&self, k: usize) -> &str {
        &self.parameters[k]
    }

    /// The field of a table.
    pub fn table(&self, k: usize) -> &str {
        self.tables.get(k).map_or("missing", String::as_str)
    }

    /// The value of a parameter.
    pub fn value(&self, k: usize) -> String {
        self.spread(format!("self.{}", self.parameters[k]))
    }

    /// A constant.
    pub fn constant(&self, c: f64) -> String {
        self.spread(match &self.scalar {
            ScalarType::Generic(name) => format!("constant::<{name}>({c:?})"),
            ScalarType::F32 if c != 0.0 && !(c.abs() as f32).is_normal() => format!("({c:?}f64 as f32)"),
            _ => format!("{c:?}"),
        })
    }

    /// The same number in all lanes.
    pub fn spread(&self, number: String) -> String {
        match self.is_in_lanes() {
            true => format!("Ops::splat::<{}, LANES>({number})", self.one()),
            false => number,
        }
    }
}
