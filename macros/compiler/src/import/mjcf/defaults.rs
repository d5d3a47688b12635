//! `<default>` classes of MJCF: default values of attributes.

use super::super::context::{Cx, format_position, quote_word};
use super::super::element::{
    Node, child_elements, element_source_position, read_name_attribute, read_number_attribute,
    read_numbers_attribute, report_missing_or_misspelt_attributes,
};
use crate::import::imported::Located;
use crate::syntax::Name;
use std::collections::BTreeMap;

/// Name of the outermost default class of MJCF.
const MAIN: &str = "main";

/// Class of defaults: the elements with default values, and the parent class.
#[derive(Default)]
struct Class<'a> {
    parent: Option<usize>,
    elements: Vec<Node<'a>>,
}

/// All classes of a file. The first is the outermost class.
pub(super) struct Defaults<'a> {
    classes: Vec<Class<'a>>,
    names: BTreeMap<&'a str, usize>,
}

/// MJCF element with its defaults: values of the element have priority over those of its class, then of
/// parent classes.
#[derive(Clone)]
pub(super) struct ElementWithDefaults<'a> {
    /// XML element whose attributes are read.
    pub(super) node: Node<'a>,
    layers: Vec<Node<'a>>,
}

impl<'a> Defaults<'a> {
    /// Reads the `<default>` elements of an MJCF file.
    pub(super) fn read_defaults(root: Node<'a>, cx: &mut Cx<'_>) -> Defaults<'a> {
        let mut all = Defaults { classes: vec![Class::default()], names: BTreeMap::new() };
        for node in child_elements(root).filter(|node| node.tag_name().name() == "default") {
            match node.attribute("class") {
                Some(class) if class != MAIN => {
                    // The outermost class may have any name. Several `<default>` elements share it.
                    all.names.insert(class, 0);
                }
                _ => {}
            }
            all.read_class(node, 0, cx);
        }
        all.names.insert(MAIN, 0);
        all
    }

    fn read_class(&mut self, node: Node<'a>, class: usize, cx: &mut Cx<'_>) {
        // An explicit stack replaces recursion, because classes may be nested deeply.
        let mut open = vec![(node, class)];
        while let Some((node, class)) = open.pop() {
            report_missing_or_misspelt_attributes(node, &[], &["class"], cx);
            for child in child_elements(node) {
                if child.tag_name().name() != "default" {
                    self.classes[class].elements.push(child);
                    continue;
                }
                let Some(within) = child.attribute("class") else {
                    let help = "write `<default class=\"…\">`; only the outermost needs no name";
                    cx.report_error(
                        &element_source_position(child, cx),
                        "`<default>` without `class`",
                        |d| d.add_help(help),
                    );
                    continue;
                };
                let number = self.classes.len();
                if let Some(known) = self.names.insert(within, number) {
                    let at = self.classes.get(known).and_then(|class| class.elements.first());
                    let first = at.map(|node| format_position(&element_source_position(*node, cx)));
                    let message = format!("second class {}", quote_word(within));
                    cx.report_error(&element_source_position(child, cx), message, |d| match first {
                        Some(first) => d.add_help(format!("the first is at {first}")),
                        None => d,
                    });
                }
                self.classes.push(Class { parent: Some(class), elements: Vec::new() });
                open.push((child, number));
            }
        }
    }

    /// Returns the index of the class that an attribute names. Without the attribute, or if the class is
    /// unknown, returns `inherited`.
    pub(super) fn class_index(
        &self,
        node: Node<'_>,
        attribute: &str,
        inherited: usize,
        cx: &mut Cx<'_>,
    ) -> usize {
        let Some(Name { text, place }) = read_name_attribute(node, attribute, cx) else { return inherited };
        match self.names.get(text.as_str()) {
            Some(class) => *class,
            None => {
                let known = self.names.keys().copied();
                let message = format!("unknown class {}", quote_word(&text));
                cx.report_error(&place, message, |d| d.suggest_name(&text, known));
                inherited
            }
        }
    }

    /// Returns an element with the defaults of its class for any of `tags`. The class is `inherited` unless
    /// the element names one.
    pub(super) fn element_with_defaults(
        &self,
        node: Node<'a>,
        tags: &[&str],
        inherited: usize,
        cx: &mut Cx<'_>,
    ) -> ElementWithDefaults<'a> {
        let classes = self.defaults_by_class(node, tags, inherited, cx);
        let defaults = classes.into_iter().rev().flat_map(|class| class.into_iter().rev());
        ElementWithDefaults { node, layers: std::iter::once(node).chain(defaults).collect() }
    }

    /// Returns the defaults for any of `tags` that apply to an element, one list for each class from the
    /// outermost class to the element's own.
    pub(super) fn defaults_by_class(
        &self,
        node: Node<'_>,
        tags: &[&str],
        inherited: usize,
        cx: &mut Cx<'_>,
    ) -> Vec<Vec<Node<'a>>> {
        let mut found = Vec::new();
        let mut at = self.classes.get(self.class_index(node, "class", inherited, cx));
        while let Some(class) = at {
            let of_tags = class.elements.iter().filter(|node| tags.contains(&node.tag_name().name()));
            found.push(of_tags.copied().collect());
            at = class.parent.and_then(|parent| self.classes.get(parent));
        }
        found.reverse();
        found
    }
}

impl<'a> ElementWithDefaults<'a> {
    /// Returns the node with the effective value of `attribute`: the element itself or a default.
    pub(super) fn node_with_attribute(&self, attribute: &str) -> Option<Node<'a>> {
        self.node_with_any_attribute(&[attribute])
    }

    /// Returns the first of element and defaults that has one of these attributes.
    pub(super) fn node_with_any_attribute(&self, attributes: &[&str]) -> Option<Node<'a>> {
        self.layers.iter().copied().find(|node| attributes.iter().any(|name| node.has_attribute(*name)))
    }

    /// Returns the text of an attribute without surrounding whitespace.
    pub(super) fn trimmed_attribute_text(&self, attribute: &str) -> Option<&'a str> {
        self.node_with_attribute(attribute).and_then(|node| node.attribute(attribute)).map(str::trim)
    }

    /// Returns the text of an attribute with its source position.
    pub(super) fn attribute_text_with_span(&self, attribute: &str, cx: &mut Cx<'_>) -> Option<Name> {
        read_name_attribute(self.node_with_attribute(attribute)?, attribute, cx)
    }

    /// Returns the value of an attribute that must be a finite number.
    pub(super) fn read_finite_attribute(&self, attribute: &str, cx: &mut Cx<'_>) -> Option<Located<f64>> {
        read_number_attribute(self.node_with_attribute(attribute)?, attribute, cx)
    }

    /// Returns the value of an attribute that must be a finite number, or `None` if it is zero.
    pub(super) fn nonzero_attribute_number(&self, attribute: &str, cx: &mut Cx<'_>) -> Option<Located<f64>> {
        self.read_finite_attribute(attribute, cx).filter(|found| found.value != 0.0)
    }

    /// Returns the coefficients of a polynomial force from the first order on, or `None` if they are zero.
    pub(super) fn polynomial_force_coefficients(
        &self,
        attribute: &str,
        cx: &mut Cx<'_>,
    ) -> Option<Located<[f64; 3]>> {
        self.numbers_with_defaults(attribute, [0.0; 3], cx).filter(|found| found.value != [0.0; 3])
    }

    /// Returns the coefficient of a force on a joint with several coordinates, which must be linear.
    pub(super) fn linear_coefficient(
        &self,
        attribute: &str,
        help: &'static str,
        cx: &mut Cx<'_>,
    ) -> Option<Located<f64>> {
        let Located { value: [linear, square, cube], place } =
            self.polynomial_force_coefficients(attribute, cx)?;
        if square != 0.0 || cube != 0.0 {
            let message = format!("a polynomial `{attribute}` is supported only on a `hinge` or a `slide`");
            cx.report_error(&place, message, |d| {
                d.add_help("expected one number: a linear coefficient").add_help(help)
            });
        }
        (linear != 0.0).then_some(Located { value: linear, place })
    }

    /// Returns the value of an attribute that must be exactly `N` finite numbers.
    pub(super) fn read_exactly_n_numbers<const N: usize>(
        &self,
        attribute: &str,
        cx: &mut Cx<'_>,
    ) -> Option<Located<[f64; N]>> {
        read_numbers_attribute(self.node_with_attribute(attribute)?, attribute, cx)
    }

    /// Returns up to `N` finite numbers of an attribute. Missing entries come from the element's defaults,
    /// then from `rest`.
    pub(super) fn numbers_with_defaults<const N: usize>(
        &self,
        attribute: &str,
        rest: [f64; N],
        cx: &mut Cx<'_>,
    ) -> Option<Located<[f64; N]>> {
        let said = self.layers.iter().rev().filter(|node| node.has_attribute(attribute));
        let mut found: Option<Located<[f64; N]>> = None;
        for node in said {
            let rest = found.map_or(rest, |found| found.value);
            found = Some(numbers_with_defaults(*node, attribute, rest, cx)?);
        }
        found
    }

    /// Returns the value of a `true`/`false` attribute; `None` for `auto`.
    pub(super) fn read_boolean_attribute(&self, attribute: &str, cx: &mut Cx<'_>) -> Option<bool> {
        read_boolean_attribute(self.node_with_attribute(attribute)?, attribute, cx)
    }

    /// Returns the source position of an attribute's value, or of the element if the attribute is missing.
    pub(super) fn place_of_attribute_value(&self, attribute: &str, cx: &Cx<'_>) -> crate::diag::Place {
        let found = self.node_with_attribute(attribute).and_then(|node| node.attribute_node(attribute));
        found.map_or_else(
            || element_source_position(self.node, cx),
            |found| cx.source_position(found.range_value().start),
        )
    }
}

/// Returns up to `N` finite numbers of an attribute. Missing entries are taken from `rest`.
pub(super) fn numbers_with_defaults<const N: usize>(
    node: Node<'_>,
    attribute: &str,
    mut rest: [f64; N],
    cx: &mut Cx<'_>,
) -> Option<Located<[f64; N]>> {
    let text = node.attribute(attribute)?;
    let count = text.split_ascii_whitespace().count();
    let place = cx.source_position(node.attribute_node(attribute)?.range_value().start);
    // One instance of `numbers` per length, so that only `numbers` reports a wrong count.
    macro_rules! of_length {
        ($($n:literal)*) => {
            match count {
                $($n if $n <= N => {
                    let found = read_numbers_attribute::<$n>(node, attribute, cx)?;
                    rest.iter_mut().zip(found.value).for_each(|(to, from)| *to = from);
                    Some(Located { value: rest, place })
                })*
                _ => read_numbers_attribute::<N>(node, attribute, cx),
            }
        };
    }
    of_length!(1 2 3 4 5 6 7 8 9 10)
}

/// Returns the value of a `true`/`false` attribute; `None` for `auto` or a missing attribute.
pub(super) fn read_boolean_attribute(node: Node<'_>, attribute: &str, cx: &mut Cx<'_>) -> Option<bool> {
    let found = node.attribute_node(attribute)?;
    match found.value().trim() {
        "true" | "enable" => Some(true),
        "false" | "disable" => Some(false),
        "auto" => None,
        other => {
            let message =
                format!("expected `true` or `false` for `{attribute}`, found {}", quote_word(other));
            cx.report_error(&cx.source_position(found.range_value().start), message, |d| d);
            None
        }
    }
}
