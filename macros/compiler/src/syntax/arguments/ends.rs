//! Parsing of the two ends of a joint, `parent -> child`, with corrections of common errors.

use super::{ArgumentValue, Arguments};
use crate::diag::{Diagnostics, Place};
use crate::syntax::{BinaryOp, Expr, ExprKind, Name};

/// Names of the two ends of an element in other tools.
const END_KEYS: [(&str, &str); 14] = [
    ("parent", "child"),
    ("from", "to"),
    ("base", "follower"),
    ("predecessor", "successor"),
    ("inboard", "outboard"),
    ("frame_a", "frame_b"),
    ("body_a", "body_b"),
    ("body1", "body2"),
    ("link1", "link2"),
    ("point1", "point2"),
    ("first", "second"),
    ("start", "end"),
    ("a", "b"),
    ("parent_link", "child_link"),
];

impl Arguments {
    /// Returns the relation `parent -> child`, or reports an error.
    pub fn require_joint_relation(&mut self, known: &[&str], cx: &mut Diagnostics) -> Option<(Expr, Expr)> {
        if self.relation.is_none() {
            let (place, ends) = self.guess_joint_ends(known);
            self.plain.clear();
            let diagnostic = cx.report_error(place, "a joint needs the two bodies that it connects");
            match ends {
                Some([parent, child]) => diagnostic.add_help(format!("write `{parent} -> {child}`")),
                None => diagnostic
                    .add_help("write `#[joint(parent -> child, …)]`, with `ground` for the fixed reference"),
            };
        }
        self.relation.take()
    }

    /// Returns the likely ends of a joint without an arrow, and the span of the error. Ends with keys are
    /// removed.
    fn guess_joint_ends(&mut self, known: &[&str]) -> (Place, Option<[String; 2]>) {
        let source_texts_of_ends = |a: &Expr, b: &Expr| Some([a.short_source_text(), b.short_source_text()]);
        if let Some((place, a, b)) = self.take_ends_with_own_keys() {
            return (place, source_texts_of_ends(&a, &b));
        }
        let place = self.plain.first().map_or(&self.place, |e| &e.place).clone();
        match self.plain.as_slice() {
            [Expr { kind: ExprKind::Binary(BinaryOp::Sub, a, b, _), .. }] => {
                return (place, source_texts_of_ends(a, b));
            }
            [a] => return (place, Some(["parent".to_string(), a.short_source_text()])),
            [a, b, ..] => return (place, source_texts_of_ends(a, b)),
            [] => {}
        }
        let is_unknown_argument = |(name, value): &(Name, ArgumentValue)| {
            !known.contains(&name.text.as_str()) && matches!(value, ArgumentValue::Expr(_))
        };
        let Some(index) = self.named.iter().position(is_unknown_argument) else { return (place, None) };
        let (name, value) = self.named.remove(index);
        let ArgumentValue::Expr(value) = value else { return (name.place, None) };
        let ends = match (&value.kind, name.text.as_str()) {
            (ExprKind::Tuple(two) | ExprKind::Array(two), _) if two.len() == 2 => {
                source_texts_of_ends(&two[0], &two[1])
            }
            (ExprKind::Name(_), "parent" | "from" | "base") => {
                Some([value.short_source_text(), "child".to_string()])
            }
            (ExprKind::Name(_), "on" | "body" | "child" | "to" | "link") => {
                Some(["parent".to_string(), value.short_source_text()])
            }
            (ExprKind::Name(_) | ExprKind::Method(..), other) => {
                Some([other.to_string(), value.short_source_text()])
            }
            _ => None,
        };
        (name.place, ends)
    }

    /// Removes and returns two ends with keys of their own, such as `from = a, to = b`.
    pub fn take_ends_with_own_keys(&mut self) -> Option<(Place, Expr, Expr)> {
        let has_expression_for_key = |key: &str| {
            self.named.iter().any(|(name, value)| name.text == key && matches!(value, ArgumentValue::Expr(_)))
        };
        let (a, b) =
            END_KEYS.into_iter().find(|(a, b)| has_expression_for_key(a) && has_expression_for_key(b))?;
        let place = self.named.iter().find(|(name, _)| name.text == a || name.text == b)?.0.place.clone();
        let mut take_end_with_key = |key: &str| match self.take_named_argument(key) {
            Some((_, ArgumentValue::Expr(e))) => Some(e),
            _ => None,
        };
        Some((place, take_end_with_key(a)?, take_end_with_key(b)?))
    }
}
