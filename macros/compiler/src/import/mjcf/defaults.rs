//! `<default>` classes: what an element has that does not say it itself.

use super::super::context::{Cx, position, quote};
use super::super::element::{Node, check_attributes, elements, name, number, numbers, place};
use crate::import::imported::Placed;
use crate::syntax::Name;
use std::collections::BTreeMap;

/// The class of what has no other.
const MAIN: &str = "main";

/// A class: the elements that it gives defaults for, and the class that it is made from.
#[derive(Default)]
struct Class<'a> {
    parent: Option<usize>,
    elements: Vec<Node<'a>>,
}

/// All classes of a file. The first is that of what has no other.
pub(super) struct Defaults<'a> {
    classes: Vec<Class<'a>>,
    names: BTreeMap<&'a str, usize>,
}

/// An element with its defaults: what it says itself comes first, then what its class says, then what that is
/// made from.
#[derive(Clone)]
pub(super) struct Element<'a> {
    /// The element.
    pub(super) node: Node<'a>,
    layers: Vec<Node<'a>>,
}

impl<'a> Defaults<'a> {
    /// Reads the `<default>` elements of the root.
    pub(super) fn read(root: Node<'a>, cx: &mut Cx<'_>) -> Defaults<'a> {
        let mut all = Defaults { classes: vec![Class::default()], names: BTreeMap::new() };
        for node in elements(root).filter(|node| node.tag_name().name() == "default") {
            match node.attribute("class") {
                Some(class) if class != MAIN => {
                    // The outermost class may have any name, but there is one.
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
        // The classes within, with a list of what is to be done: they may be nested as deep as the file.
        let mut open = vec![(node, class)];
        while let Some((node, class)) = open.pop() {
            check_attributes(node, &[], &["class"], cx);
            for child in elements(node) {
                if child.tag_name().name() != "default" {
                    self.classes[class].elements.push(child);
                    continue;
                }
                let Some(within) = child.attribute("class") else {
                    let help = "write `<default class=\"…\">`; only the outermost needs no name";
                    cx.error(&place(child, cx), "`<default>` without `class`", |d| d.help(help));
                    continue;
                };
                let number = self.classes.len();
                if let Some(known) = self.names.insert(within, number) {
                    let at = self.classes.get(known).and_then(|class| class.elements.first());
                    let first = at.map(|node| position(&place(*node, cx)));
                    let message = format!("second class {}", quote(within));
                    cx.error(&place(child, cx), message, |d| match first {
                        Some(first) => d.help(format!("the first is at {first}")),
                        None => d,
                    });
                }
                self.classes.push(Class { parent: Some(class), elements: Vec::new() });
                open.push((child, number));
            }
        }
    }

    /// The class that an attribute names, or else `inherited`.
    pub(super) fn class(&self, node: Node<'_>, attribute: &str, inherited: usize, cx: &mut Cx<'_>) -> usize {
        let Some(Name { text, place }) = name(node, attribute, cx) else { return inherited };
        match self.names.get(text.as_str()) {
            Some(class) => *class,
            None => {
                let known = self.names.keys().copied();
                let message = format!("unknown class {}", quote(&text));
                cx.error(&place, message, |d| d.suggest(&text, known));
                inherited
            }
        }
    }

    /// An element with the defaults of its class, `inherited` unless it names one, that are written for any
    /// of `tags`.
    pub(super) fn element(
        &self,
        node: Node<'a>,
        tags: &[&str],
        inherited: usize,
        cx: &mut Cx<'_>,
    ) -> Element<'a> {
        let classes = self.by_class(node, tags, inherited, cx);
        let defaults = classes.into_iter().rev().flat_map(|class| class.into_iter().rev());
        Element { node, layers: std::iter::once(node).chain(defaults).collect() }
    }

    /// The defaults written for any of `tags` that apply to an element, of each class that its own is made
    /// from, the outermost first.
    pub(super) fn by_class(
        &self,
        node: Node<'_>,
        tags: &[&str],
        inherited: usize,
        cx: &mut Cx<'_>,
    ) -> Vec<Vec<Node<'a>>> {
        let mut found = Vec::new();
        let mut at = self.classes.get(self.class(node, "class", inherited, cx));
        while let Some(class) = at {
            let of_tags = class.elements.iter().filter(|node| tags.contains(&node.tag_name().name()));
            found.push(of_tags.copied().collect());
            at = class.parent.and_then(|parent| self.classes.get(parent));
        }
        found.reverse();
        found
    }
}

impl<'a> Element<'a> {
    /// The node that says `attribute`: the element or a default.
    pub(super) fn with(&self, attribute: &str) -> Option<Node<'a>> {
        self.with_any(&[attribute])
    }

    /// The first that says one of these.
    pub(super) fn with_any(&self, attributes: &[&str]) -> Option<Node<'a>> {
        self.layers.iter().copied().find(|node| attributes.iter().any(|name| node.has_attribute(*name)))
    }

    /// The word that an attribute is.
    pub(super) fn text(&self, attribute: &str) -> Option<&'a str> {
        self.with(attribute).and_then(|node| node.attribute(attribute)).map(str::trim)
    }

    /// The word that an attribute is, with its place.
    pub(super) fn name(&self, attribute: &str, cx: &mut Cx<'_>) -> Option<Name> {
        name(self.with(attribute)?, attribute, cx)
    }

    /// A finite number.
    pub(super) fn number(&self, attribute: &str, cx: &mut Cx<'_>) -> Option<Placed<f64>> {
        number(self.with(attribute)?, attribute, cx)
    }

    /// A number that is not zero.
    pub(super) fn nonzero(&self, attribute: &str, cx: &mut Cx<'_>) -> Option<Placed<f64>> {
        self.number(attribute, cx).filter(|found| found.value != 0.0)
    }

    /// The linear coefficient of a force that newer versions of the format give as a polynomial: reports
    /// others.
    pub(super) fn linear(&self, attribute: &str, help: &'static str, cx: &mut Cx<'_>) -> Option<Placed<f64>> {
        let Placed { value: [linear, square, cube], place } = self.some(attribute, [0.0; 3], cx)?;
        if square != 0.0 || cube != 0.0 {
            let message = format!("`{attribute}` is a polynomial, as MuJoCo reads it since version 3.7");
            cx.error(&place, message, |d| d.help("expected one number: a linear coefficient").help(help));
        }
        (linear != 0.0).then_some(Placed { value: linear, place })
    }

    /// As many finite numbers.
    pub(super) fn numbers<const N: usize>(
        &self,
        attribute: &str,
        cx: &mut Cx<'_>,
    ) -> Option<Placed<[f64; N]>> {
        numbers(self.with(attribute)?, attribute, cx)
    }

    /// Up to `N` finite numbers: the first ones of the element, then further ones of its defaults, then
    /// those that are given.
    pub(super) fn some<const N: usize>(
        &self,
        attribute: &str,
        rest: [f64; N],
        cx: &mut Cx<'_>,
    ) -> Option<Placed<[f64; N]>> {
        let said = self.layers.iter().rev().filter(|node| node.has_attribute(attribute));
        let mut found: Option<Placed<[f64; N]>> = None;
        for node in said {
            let rest = found.map_or(rest, |found| found.value);
            found = Some(some(*node, attribute, rest, cx)?);
        }
        found
    }

    /// `true`, `false` or `auto`; the last is `None`.
    pub(super) fn choice(&self, attribute: &str, cx: &mut Cx<'_>) -> Option<bool> {
        choice(self.with(attribute)?, attribute, cx)
    }

    /// The place of an attribute's value, or else of the element.
    pub(super) fn place(&self, attribute: &str, cx: &Cx<'_>) -> crate::diag::Place {
        let found = self.with(attribute).and_then(|node| node.attribute_node(attribute));
        found.map_or_else(|| place(self.node, cx), |found| cx.place(found.range_value().start))
    }
}

/// Up to `N` finite numbers; those that are not written are as given.
pub(super) fn some<const N: usize>(
    node: Node<'_>,
    attribute: &str,
    mut rest: [f64; N],
    cx: &mut Cx<'_>,
) -> Option<Placed<[f64; N]>> {
    let text = node.attribute(attribute)?;
    let count = text.split_ascii_whitespace().count();
    let place = cx.place(node.attribute_node(attribute)?.range_value().start);
    // One function for each length keeps the message about the number of numbers in one place.
    macro_rules! of_length {
        ($($n:literal)*) => {
            match count {
                $($n if $n <= N => {
                    let found = numbers::<$n>(node, attribute, cx)?;
                    rest.iter_mut().zip(found.value).for_each(|(to, from)| *to = from);
                    Some(Placed { value: rest, place })
                })*
                _ => numbers::<N>(node, attribute, cx),
            }
        };
    }
    of_length!(1 2 3 4 5 6 7 8 9 10)
}

/// `true`, `false` or `auto`; the last is `None`, as is what is not there.
pub(super) fn choice(node: Node<'_>, attribute: &str, cx: &mut Cx<'_>) -> Option<bool> {
    let found = node.attribute_node(attribute)?;
    match found.value().trim() {
        "true" | "enable" => Some(true),
        "false" | "disable" => Some(false),
        "auto" => None,
        other => {
            let message = format!("expected `true` or `false` for `{attribute}`, found {}", quote(other));
            cx.error(&cx.place(found.range_value().start), message, |d| d);
            None
        }
    }
}
