//! Arguments by the tables of the language: keys with expressions, and conditions on which of them are given
//! together.

use super::arguments::Arguments;
use super::{Expr, ExprKind, Name, WrittenArguments};
use crate::diag::Diagnostics;
use crate::language::{ArgumentRelation, Callable, Key, OtherKind};

/// Arguments of an element that its row in the table lists.
pub struct ElementArgumentKeys<'a> {
    /// All arguments that the element's row lists.
    pub all: &'a [Key],
    /// Arguments that give alternative laws; one of them is given.
    pub laws: &'a [Key],
    /// Arguments that the element requires, with an example value for each.
    pub required: &'a [(Key, &'a str)],
    /// Attribute in which the arguments are written.
    pub attribute: &'a str,
    /// Names of all arguments that the element can have.
    pub names: &'a [&'a str],
}

impl<'a> ElementArgumentKeys<'a> {
    /// Returns the arguments of an element that is no force element.
    pub fn new(kind: OtherKind, names: &'a [&'a str]) -> ElementArgumentKeys<'a> {
        let row = kind.row();
        let attribute = row.attributes.first().copied().unwrap_or_default();
        ElementArgumentKeys { all: row.arguments, laws: &[], required: row.required, attribute, names }
    }

    /// Reads the arguments of an element, laws first. The second result is false if a required argument is
    /// missing.
    pub fn read_element_arguments(
        &self,
        arguments: &mut Arguments,
        cx: &mut Diagnostics,
    ) -> (WrittenArguments, bool) {
        let mut given: Vec<(Key, Expr)> = Vec::new();
        let mut is_complete = true;
        let others = self.all.iter().filter(|key| !self.laws.contains(key));
        for key in self.laws.iter().chain(others) {
            let has_law = self.laws.contains(key) && given.iter().any(|(known, _)| self.laws.contains(known));
            let value = match self.required.iter().find(|(known, _)| known == key) {
                Some((_, example)) if !has_law => {
                    let value =
                        arguments.require_expression(key.name(), example, self.attribute, self.names, cx);
                    is_complete &= value.is_some();
                    value
                }
                _ => arguments.take_expression_of_key(key.name(), cx),
            };
            let value = value.filter(|e| *key != Key::Restitution || check_poisson_argument_count(e, cx));
            given.extend(value.map(|value| (*key, value)));
        }
        (WrittenArguments(given), is_complete)
    }
}

/// Checks that `poisson(…)`, a coefficient of restitution as a ratio of impulses, has one argument. Otherwise
/// reports an error and returns false.
fn check_poisson_argument_count(e: &Expr, cx: &mut Diagnostics) -> bool {
    match &e.kind {
        ExprKind::Call(word, list) if word.id == Some(Callable::Poisson) && list.len() != 1 => {
            cx.report_error(word.place.clone(), "`poisson` takes one coefficient")
                .add_help("write `restitution = poisson(e)`");
            false
        }
        _ => true,
    }
}

/// Reports arguments that exclude each other or need others, each once. Returns false then.
pub fn check_argument_relations(
    relations: &[ArgumentRelation],
    given: &WrittenArguments,
    name: &Name,
    cx: &mut Diagnostics,
) -> bool {
    let mut reported: Vec<&ArgumentRelation> = Vec::new();
    for relation in relations {
        let Some(e) = given.expression_of_key(relation.key) else { continue };
        let has_other = relation.others.iter().any(|key| given.expression_of_key(*key).is_some());
        let is_reported_relation =
            |known: &&ArgumentRelation| known.key == relation.key || known.message == relation.message;
        if has_other != relation.needs && !reported.iter().any(is_reported_relation) {
            cx.report_error(e.place.clone(), relation.message.replace("NAME", &name.text))
                .add_help(relation.help);
            reported.push(relation);
        }
    }
    reported.is_empty()
}
