//! Conversion of the names in a robot file to field names of a struct.

use linkwork_compiler::syntax::GROUND;
use std::collections::{BTreeMap, BTreeSet};

/// Words that have a meaning in expressions, or that are not valid field names.
const WORDS: [&str; 24] = [
    "x", "y", "z", "t", "u", "w", "e", "pi", "ground", "world", "gravity", "time", "norm", "dot", "cross",
    "rate", "stretch", "speed", "crate", "self", "super", "Self", "true", "false",
];

/// Field names of a converted struct, by the names in the robot file.
#[derive(Clone, Default)]
pub struct StructFieldNames {
    of: BTreeMap<String, String>,
    taken: BTreeSet<String>,
}

impl StructFieldNames {
    /// Adds names of one kind. A name that is already used gets the kind as a suffix.
    pub fn add_names_of_kind<'a>(
        &mut self,
        names: impl Iterator<Item = &'a str>,
        kind: &str,
    ) -> StructFieldNames {
        let mut of = BTreeMap::new();
        for name in names {
            let field = if name == GROUND { name.to_string() } else { self.unused_field_name(name, kind) };
            of.insert(name.to_string(), field);
        }
        StructFieldNames { of, taken: BTreeSet::new() }
    }

    /// Returns a field name that is not used yet.
    pub fn unused_field_name(&mut self, name: &str, kind: &str) -> String {
        let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        let plain = plain.trim_matches('_').to_ascii_lowercase();
        let begins = plain.starts_with(|c: char| c.is_ascii_alphabetic());
        let mut field =
            if begins { plain } else { format!("{kind}_{plain}").trim_end_matches('_').to_string() };
        let is_reserved_word =
            |text: &str| WORDS.contains(&text) || syn::parse_str::<syn::Ident>(text).is_err();
        if is_reserved_word(&field) || self.taken.contains(&field) {
            field = format!("{field}_{kind}");
        }
        let first = field.clone();
        let mut number = 2;
        while !self.taken.insert(field.clone()) {
            field = format!("{first}{number}");
            number += 1;
        }
        field
    }

    /// Returns the field name of a name in the file, or the name itself.
    pub fn field_name_or_original(&self, name: &str) -> String {
        self.field_name(name).unwrap_or_else(|| name.to_string())
    }

    /// Returns the field name, if the name exists in the file.
    pub fn field_name(&self, name: &str) -> Option<String> {
        self.of.get(name).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::StructFieldNames;

    #[test]
    fn robot_names_become_distinct_rust_fields() {
        let mut taken = StructFieldNames::default();
        let links = taken
            .add_names_of_kind(["ground", "Hand-left", "x", "2nd", "fn", "hand left"].into_iter(), "link");
        let joints = taken.add_names_of_kind(["Hand-left", "é"].into_iter(), "joint");
        let field_names_of = |names: &StructFieldNames, list: &[&str]| {
            list.iter().map(|name| names.field_name_or_original(name)).collect::<Vec<_>>()
        };
        let of_links = field_names_of(&links, &["ground", "Hand-left", "x", "2nd", "fn", "hand left"]);
        assert_eq!(of_links, ["ground", "hand_left", "x_link", "link_2nd", "fn_link", "hand_left_link"]);
        assert_eq!(field_names_of(&joints, &["Hand-left", "é"]), ["hand_left_joint", "joint"]);
    }
}
