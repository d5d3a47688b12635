//! Reference tables of `tests/data`: JSON objects whose header states the source of the values.

use linkwork::nalgebra::{SMatrix, SVector};
use serde_json::Value;

/// JSON object with reference values for tests.
pub struct Record(Value);

impl Record {
    /// Reads the reference values from the file `tests/data/<path>`.
    pub fn load(path: &str) -> Record {
        let path = format!("{}/data/{path}", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        Record(serde_json::from_str(&text).unwrap_or_else(|error| panic!("{path}: {error}")))
    }

    fn entry_with_key(&self, key: &str) -> &Value {
        self.0.get(key).unwrap_or_else(|| panic!("the table has no `{key}`"))
    }

    /// Whether the object has an entry with this key.
    pub fn has_key(&self, key: &str) -> bool {
        self.0.get(key).is_some()
    }

    /// Returns the list of objects that has this key.
    pub fn records_with_key(&self, key: &str) -> Vec<Record> {
        list_of_value(self.entry_with_key(key)).iter().cloned().map(Record).collect()
    }

    /// Returns the list of strings that has this key.
    pub fn strings_with_key(&self, key: &str) -> Vec<String> {
        list_of_value(self.entry_with_key(key))
            .iter()
            .map(|item| item.as_str().expect("a string").to_string())
            .collect()
    }

    /// Returns the string that has this key.
    pub fn string_with_key(&self, key: &str) -> &str {
        self.entry_with_key(key).as_str().unwrap_or_else(|| panic!("`{key}` is not a string"))
    }

    /// Returns the number that has this key.
    pub fn number_with_key(&self, key: &str) -> f64 {
        number_of_value(self.entry_with_key(key))
    }

    /// Returns the list of numbers that has this key.
    pub fn numbers_with_key(&self, key: &str) -> Vec<f64> {
        numbers_of_value(self.entry_with_key(key))
    }

    /// Returns the list with this key as rows of `N` numbers.
    pub fn rows_with_key<const N: usize>(&self, key: &str) -> Vec<[f64; N]> {
        list_of_value(self.entry_with_key(key))
            .iter()
            .map(|row| array_of_numbers(&numbers_of_value(row)))
            .collect()
    }

    /// Returns the list with this key as a vector of `N` numbers.
    pub fn vector_with_key<const N: usize>(&self, key: &str) -> SVector<f64, N> {
        SVector::from(array_of_numbers(&self.numbers_with_key(key)))
    }

    /// Returns the matrix with this key, which is stored as one list in row-major order.
    pub fn matrix_with_key<const R: usize, const C: usize>(&self, key: &str) -> SMatrix<f64, R, C> {
        let numbers = self.numbers_with_key(key);
        assert_eq!(numbers.len(), R * C, "`{key}`");
        SMatrix::from_row_slice(&numbers)
    }

    /// Returns a symmetric matrix that is stored as the rows of its lower triangle.
    pub fn symmetric_matrix_with_key<const N: usize>(&self, key: &str) -> SMatrix<f64, N, N> {
        let numbers = self.numbers_with_key(key);
        assert_eq!(numbers.len(), N * (N + 1) / 2, "`{key}`");
        SMatrix::from_fn(|i, j| numbers[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)])
    }

    /// Returns the entries of the object with this key, whose values are lists of numbers, together with
    /// their names.
    pub fn number_lists_with_names(&self, key: &str) -> Vec<(String, Vec<f64>)> {
        let object =
            self.entry_with_key(key).as_object().unwrap_or_else(|| panic!("`{key}` is not an object"));
        object.iter().map(|(name, value)| (name.clone(), numbers_of_value(value))).collect()
    }
}

fn list_of_value(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn number_of_value(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn numbers_of_value(value: &Value) -> Vec<f64> {
    list_of_value(value).iter().map(number_of_value).collect()
}

fn array_of_numbers<const N: usize>(numbers: &[f64]) -> [f64; N] {
    numbers.try_into().unwrap_or_else(|_| panic!("{} numbers where {N} are expected", numbers.len()))
}
