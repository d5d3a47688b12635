//! Code generation for the limits of coordinates.

use super::signature::SignatureContext;
use crate::catalogue::Shape;
use crate::mechanism::{CoordinateLimits, Model};
use std::fmt::Write;

/// Limits of an entry of `v` and its coordinate, as indices of the values of the hidden function `__limits`.
#[derive(Clone, Debug)]
pub struct CoordinateLimitIndices {
    /// Index in `q` of the limited coordinate.
    q: usize,
    /// Index in `v` of the coordinate's velocity.
    v: usize,
    /// Name of the coordinate.
    name: String,
    /// Lower limit, upper limit, velocity limit and effort limit: index of the value, and the value if it is
    /// constant.
    bounds: [Option<(usize, Option<f64>)>; 4],
}

impl CoordinateLimitIndices {
    /// Returns all limits of a model, in the order of the values.
    pub fn from_model(model: &Model<'_>) -> Vec<CoordinateLimitIndices> {
        let mut next = 0;
        let mut indices_of_limit = |limit: &CoordinateLimits<'_>| {
            let bounds = limit.bounds().map(|bound| {
                let found = (next, bound?.constant_value());
                next += 1;
                Some(found)
            });
            let names = model.speeds.as_ref().map_or(&model.velocities, |speeds| &speeds.velocities);
            let name = names.get(limit.v.0).map_or(String::new(), |(name, _)| name.clone());
            CoordinateLimitIndices { q: limit.q.0, v: limit.v.0, name, bounds }
        };
        model.limits.iter().map(&mut indices_of_limit).collect()
    }

    /// Returns the index of a bound among the limit values; `None` if the bound is absent.
    fn index_of_bound(&self, which: usize) -> Option<usize> {
        self.bounds.get(which).copied().flatten().map(|(k, _)| k)
    }
}

/// Functions of the trait `Limits`, with the infinity that each returns for a missing limit.
const FUNCTIONS: [(&str, &str); 4] = [
    ("lower_limits", "NEG_INFINITY"),
    ("upper_limits", "INFINITY"),
    ("velocity_limits", "INFINITY"),
    ("effort_limits", "INFINITY"),
];

/// Writes the functions of the trait `Limits`. Omitted functions have defaults, which return no limits.
pub fn write_trait(
    out: &mut String,
    limited: &[CoordinateLimitIndices],
    speeds: bool,
    s: &SignatureContext<'_>,
) {
    let (scalar, q, v) = (s.scalar.scalar_name(), s.vector_type(s.nq), s.vector_type(s.nv));
    let _ = writeln!(out, "type Scalar = {scalar};");
    for (which, (name, infinity)) in FUNCTIONS.into_iter().enumerate() {
        if limited.iter().all(|limit| limit.index_of_bound(which).is_none()) {
            continue;
        }
        let format_limit_entry = |v: usize| {
            let limit = limited.iter().find(|limit| limit.v == v);
            match limit.and_then(|limit| limit.index_of_bound(which)) {
                Some(k) => format!("limits[{k}]"),
                None => "none".to_string(),
            }
        };
        let entries: Vec<String> = (0..s.nv).map(format_limit_entry).collect();
        let _ = writeln!(
            out,
            "#[inline]\nfn {name}(&self) -> {v} {{
            let limits = self.__limits();
            let none = ::linkwork::__private::constant::<{scalar}>(f64::{infinity});
            ::linkwork::nalgebra::SVector::from_array_storage(::linkwork::nalgebra::ArrayStorage([[{}]]))\n}}",
            entries.join(", ")
        );
    }
    if limited.iter().all(|limit| limit.index_of_bound(0).is_none() && limit.index_of_bound(1).is_none()) {
        return;
    }
    if speeds {
        let mut entries = vec![format!("::linkwork::__private::constant::<{scalar}>(0.0)"); s.nv];
        limited.iter().for_each(|limit| entries[limit.v] = format!("q[{}]", limit.q));
        let _ = writeln!(
            out,
            "fn limited_coordinates(&self, q: &{q}) -> ::core::option::Option<({v}, {})> {{
            let of_rates = self.__speed_matrix(q);
            let [q] = q.data.0;
            ::core::option::Option::Some((::linkwork::nalgebra::SVector::from_array_storage(::linkwork::nalgebra::ArrayStorage([[{}]])), of_rates))\n}}",
            s.shape_type(Shape::Square(s.nv)),
            entries.join(", ")
        );
    }
    let _ = writeln!(
        out,
        "#[inline]\nfn clamp_configuration(&self, q: &{q}) -> {q} {{\nlet limits = self.__limits();\nlet \
         [mut q] = q.data.0;"
    );
    for limit in limited {
        let k = limit.q;
        for (which, function) in [(0, "at_least"), (1, "at_most")] {
            if let Some(bound) = limit.index_of_bound(which) {
                let _ = writeln!(out, "q[{k}] = ::linkwork::__private::{function}(q[{k}], limits[{bound}]);");
            }
        }
    }
    out.push_str(
        "::linkwork::nalgebra::SVector::from_array_storage(::linkwork::nalgebra::ArrayStorage([q]))\n}\n",
    );
}

/// Adds a table of the limits to the documentation of the struct.
pub fn write_documentation_table(text: &mut String, limited: &[CoordinateLimitIndices]) {
    if limited.is_empty() {
        return;
    }
    text.push_str(
        "\n# Limits\n\nSI units; forces are generalized ones.\n\n| | from | to | speed | force |\n| --- | \
         ---: | ---: | ---: | ---: |\n",
    );
    for limit in limited {
        let _ = write!(text, "| `{}` |", limit.name);
        for bound in limit.bounds {
            let _ = match bound {
                Some((_, Some(number))) => write!(text, " {number} |"),
                Some((_, None)) => write!(text, " by parameters |"),
                None => write!(text, " |"),
            };
        }
        text.push('\n');
    }
}
