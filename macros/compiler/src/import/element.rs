//! Checked access to the children, attributes, numbers and names of one XML element, each with its source
//! position. This module knows no particular element.

use super::context::{Cx, format_position, quote_first_eight_words, quote_word};
use crate::diag::{Place, nearest_candidate};
use crate::import::imported::Located;
use crate::syntax::Name;

/// XML element of a robot file.
pub(super) type Node<'a> = roxmltree::Node<'a, 'a>;

/// Attribute of an XML element of a robot file.
pub(super) type Attribute<'a> = roxmltree::Attribute<'a, 'a>;

/// Returns the source position of an XML element.
pub(super) fn element_source_position(node: Node<'_>, cx: &Cx<'_>) -> Place {
    cx.source_position(node.range().start)
}

/// Returns the tag `<name>` of an XML element, in backticks.
pub(super) fn quoted_tag(node: Node<'_>) -> String {
    quote_word(&format!("<{}>", node.tag_name().name()))
}

/// Returns the child elements in the namespace of the element itself. Children with another prefix are
/// extensions of other tools.
pub(super) fn child_elements<'a>(node: Node<'a>) -> impl Iterator<Item = Node<'a>> {
    let namespace = node.tag_name().namespace();
    node.children().filter(move |child| child.is_element() && child.tag_name().namespace() == namespace)
}

/// Returns the child elements named in `known`, at most one of each. Other children are ignored, unless their
/// name looks like a typing error: to ignore `<inertal>` would silently remove a body's mass.
pub(super) fn child_for_each_name<'a, const N: usize>(
    node: Node<'a>,
    known: [&str; N],
    cx: &mut Cx<'_>,
) -> [Option<Node<'a>>; N] {
    let mut found = [None; N];
    for child in child_elements(node) {
        let name = child.tag_name().name();
        match known.iter().position(|k| *k == name) {
            Some(k) if found[k].is_none() => found[k] = Some(child),
            Some(k) => report_duplicate(child, found[k], cx),
            None => report_misspelt_element_name(child, &known, cx),
        }
    }
    found
}

/// Reports an element that occurs a second time in its parent.
pub(super) fn report_duplicate(child: Node<'_>, first: Option<Node<'_>>, cx: &mut Cx<'_>) {
    let first = first.map(|node| format_position(&element_source_position(node, cx))).unwrap_or_default();
    let message = format!("second {} of one element", quoted_tag(child));
    cx.report_error(&element_source_position(child, cx), message, |d| {
        d.add_help(format!("the first is at {first}"))
    });
}

/// Reports an element whose name is similar to, but not in, `known`.
pub(super) fn report_misspelt_element_name(node: Node<'_>, known: &[&str], cx: &mut Cx<'_>) {
    if known.contains(&node.tag_name().name()) {
        return;
    }
    if let Some(best) = nearest_candidate(node.tag_name().name(), known) {
        let help = format!("did you mean `<{best}>`?");
        cx.report_error(
            &element_source_position(node, cx),
            format!("unknown element {}", quoted_tag(node)),
            |d| d.add_help(help),
        );
    }
}

/// Reports missing required attributes and misspelt attributes. A misspelt required attribute is one error,
/// not two.
pub(super) fn report_missing_or_misspelt_attributes(
    node: Node<'_>,
    required: &[&str],
    optional: &[&str],
    cx: &mut Cx<'_>,
) {
    let mut missing: Vec<&str> = required.iter().copied().filter(|name| !node.has_attribute(*name)).collect();
    let is_known_attribute = |name: &str| required.contains(&name) || optional.contains(&name);
    for attribute in node.attributes().filter(|a| a.namespace().is_none() && !is_known_attribute(a.name())) {
        let absent = optional.iter().copied().filter(|name| !node.has_attribute(*name));
        let candidates: Vec<&str> = missing.iter().copied().chain(absent).collect();
        if let Some(best) = nearest_candidate(attribute.name(), &candidates) {
            missing.retain(|name| *name != best);
            let message =
                format!("unknown attribute {} of {}", quote_word(attribute.name()), quoted_tag(node));
            let place = cx.source_position(attribute.range().start);
            cx.report_error(&place, message, |d| d.add_help(format!("did you mean `{best}`?")));
        }
    }
    if !missing.is_empty() {
        let message =
            format!("{} without {}", quoted_tag(node), quote_first_eight_words(missing.into_iter()));
        let help = expected_element_help(node.tag_name().name(), required);
        cx.report_error(&element_source_position(node, cx), message, |d| d.add_help(help));
    }
}

/// Reports all contents of an element other than the attributes in `required`, `optional` and `foreign`
/// (attributes of other tools), since they would be ignored silently.
pub(super) fn report_unexpected_contents(
    node: Node<'_>,
    required: &[&str],
    optional: &[&str],
    foreign: &[&str],
    cx: &mut Cx<'_>,
) {
    let all = [required, optional].concat();
    let is_accepted_attribute = |name: &str| all.contains(&name) || foreign.contains(&name);
    let help =
        expected_element_help(node.tag_name().name(), if required.is_empty() { optional } else { required });
    let unknown = node.attributes().find(|a| a.namespace().is_none() && !is_accepted_attribute(a.name()));
    if let Some(child) = nonblank_texts_and_own_elements(node).next() {
        report_meaningless_node(child, node, help, cx);
    } else if let Some(attribute) = unknown.filter(|a| nearest_candidate(a.name(), &all).is_none()) {
        let message = format!("unknown attribute {} of {}", quote_word(attribute.name()), quoted_tag(node));
        let place = cx.source_position(attribute.range().start);
        cx.report_error(&place, message, |d| d.add_help(help));
    } else {
        report_missing_or_misspelt_attributes(node, required, optional, cx);
    }
}

/// Returns the texts that are not blank and the elements of the file's own vocabulary in an element.
pub(super) fn nonblank_texts_and_own_elements<'a>(node: Node<'a>) -> impl Iterator<Item = Node<'a>> {
    node.children().filter(move |child| match child.is_text() {
        true => child.text().is_some_and(|text| !text.trim().is_empty()),
        false => child.is_element() && child.tag_name().namespace() == node.tag_name().namespace(),
    })
}

/// Reports a text or an element that has no meaning in `node`.
fn report_meaningless_node(child: Node<'_>, node: Node<'_>, help: impl Into<String>, cx: &mut Cx<'_>) {
    let text = child.text().unwrap_or_default();
    let start = child.range().start;
    let (found, start) = match child.is_text() {
        true => (format!("text {}", quote_word(text.trim())), start + text.len() - text.trim_start().len()),
        false => (quoted_tag(child), start),
    };
    let message = format!("unexpected {found} in {}", quoted_tag(node));
    cx.report_error(&cx.source_position(start), message, |d| d.add_help(help));
}

/// Reports attributes that are not in `known` on an element whose values are text or child elements.
pub(super) fn check_attributes_of_value_element(node: Node<'_>, known: &[&str], cx: &mut Cx<'_>) {
    report_missing_or_misspelt_attributes(node, &[], known, cx);
    let unknown = node.attributes().filter(|a| a.namespace().is_none() && !known.contains(&a.name()));
    for attribute in unknown.filter(|a| nearest_candidate(a.name(), known).is_none()) {
        let message = format!("unknown attribute {} of {}", quote_word(attribute.name()), quoted_tag(node));
        let name = attribute.name();
        let help = format!("values are elements or text, as in `<{name}>{}</{name}>`", attribute.value());
        cx.report_error(&cx.source_position(attribute.range().start), message, |d| d.add_help(help));
    }
}

fn expected_element_help(element: &str, attributes: &[&str]) -> String {
    let attributes: String = attributes.iter().map(|name| format!(" {name}=\"…\"")).collect();
    format!("expected `<{element}{attributes}/>`")
}

/// Returns the required child `element` of `node`, or reports that it is missing. `attributes` are the
/// attributes of the child that the help text shows.
pub(super) fn required_child<'a>(
    child: Option<Node<'a>>,
    node: Node<'_>,
    element: &str,
    attributes: &[&str],
    cx: &mut Cx<'_>,
) -> Option<Node<'a>> {
    if child.is_none() {
        let message = format!("{} without `<{element}>`", quoted_tag(node));
        cx.report_error(&element_source_position(node, cx), message, |d| {
            d.add_help(expected_element_help(element, attributes))
        });
    }
    child
}

/// Returns the name in an attribute, if the attribute is present. Reports an empty name.
pub(super) fn read_name_attribute(node: Node<'_>, attribute: &str, cx: &mut Cx<'_>) -> Option<Name> {
    let found = node.attribute_node(attribute)?;
    let (text, place) = (found.value().to_string(), cx.source_position(found.range_value().start));
    if text.trim().is_empty() {
        let help = format!("write a name: `{attribute}=\"…\"`");
        cx.report_error(&place, format!("empty `{attribute}` of {}", quoted_tag(node)), |d| d.add_help(help));
        return None;
    }
    Some(Name { text, place })
}

/// Returns the finite number in an attribute, if the attribute is present and valid. Reports invalid values.
pub(super) fn read_number_attribute(
    node: Node<'_>,
    attribute: &str,
    cx: &mut Cx<'_>,
) -> Option<Located<f64>> {
    let Located { value: [value], place } = read_numbers_attribute(node, attribute, cx)?;
    Some(Located { value, place })
}

/// Returns the `N` finite numbers in an attribute, separated by spaces, if the attribute is present and
/// valid.
pub(super) fn read_numbers_attribute<const N: usize>(
    node: Node<'_>,
    attribute: &str,
    cx: &mut Cx<'_>,
) -> Option<Located<[f64; N]>> {
    let found = node.attribute_node(attribute)?;
    read_numbers(found.value(), found.range_value(), attribute, cx)
}

/// Returns the `N` finite numbers in the text of an element, separated by spaces. Reports elements among
/// them, and numbers on both sides of a comment.
pub(super) fn read_numbers_content<const N: usize>(
    node: Node<'_>,
    cx: &mut Cx<'_>,
) -> Option<Located<[f64; N]>> {
    let mut all = nonblank_texts_and_own_elements(node);
    let text = all.next().filter(Node::is_text);
    if let Some(other) = nonblank_texts_and_own_elements(node).find(Node::is_element).or(all.next()) {
        report_meaningless_node(other, node, "expected numbers, and comments before or after them", cx);
        return None;
    }
    match text {
        Some(text) => read_numbers(text.text().unwrap_or_default(), text.range(), node.tag_name().name(), cx),
        None => read_numbers("", node.range(), node.tag_name().name(), cx),
    }
}

/// Returns the trimmed text of an element with its source position; `None` if it is empty.
pub(super) fn read_trimmed_content(node: Node<'_>, cx: &Cx<'_>) -> Option<Name> {
    let found = nonblank_texts_and_own_elements(node).find(Node::is_text)?;
    let whole = found.text()?;
    let before = whole.len() - whole.trim_start().len();
    let text = whole.trim().to_string();
    (!text.is_empty()).then(|| Name { text, place: cx.source_position(found.range().start + before) })
}

fn read_numbers<const N: usize>(
    text: &str,
    range: std::ops::Range<usize>,
    attribute: &str,
    cx: &mut Cx<'_>,
) -> Option<Located<[f64; N]>> {
    let start = range.start;
    let place = cx.source_position(start + text.len() - text.trim_start().len());
    if text.contains(',') {
        // Decimal commas usually occur in all vectors of a file and are reported once.
        let expected = if N == 1 { "a number".to_string() } else { format!("{N} numbers") };
        let message = format!("expected {expected} in `{attribute}`, found {}", quote_word(text));
        cx.report_first_of_similar_errors(&place, message, if N == 1 { POINT } else { SEPARATE });
        return None;
    }
    let count = text.split_ascii_whitespace().count();
    if count != N {
        let expected = if N == 1 { "a number".to_string() } else { format!("{N} numbers") };
        let message = format!("expected {expected} in `{attribute}`, found {}", quote_word(text));
        let missing = if N == 1 { POINT } else { SPACES };
        cx.report_error(&place, message, |d| d.add_help(missing));
        return None;
    }
    // Character references (`&#32;`) change the offsets of the words after them.
    let verbatim = cx.file_text_in_range(range) == Some(text);
    let mut value = [0.0; N];
    let mut good = true;
    for (k, word) in text.split_ascii_whitespace().enumerate() {
        let offset = if verbatim { word.as_ptr() as usize - text.as_ptr() as usize } else { 0 };
        match word.parse::<f64>() {
            // Adding zero converts −0 to 0.
            Ok(number) if number.is_finite() => value[k] = number + 0.0,
            Ok(_) => {
                good = false;
                let message = format!("{} is not a finite number", quote_word(word));
                cx.report_error(&cx.source_position(start + offset), message, |d| d.add_help(DIGITS));
            }
            Err(_) => {
                good = false;
                let message = format!("{} is not a number", quote_word(word));
                cx.report_error(&cx.source_position(start + offset), message, |d| d.add_help(DIGITS));
            }
        }
    }
    good.then_some(Located { value, place })
}

/// Largest angle, rad, that is accepted as radians in any notation: a full revolution with a margin for
/// rounding.
const LARGEST_TURN: f64 = 7.0;

/// Reports angles that are most likely in degrees: multiples of ½ beyond a full revolution. Multiples of π
/// are accepted. `help` states the unit of the format.
pub(super) fn report_likely_degrees(angles: &[f64], place: &Place, help: &'static str, cx: &mut Cx<'_>) {
    let is_likely_in_degrees = |n: &&f64| n.abs() > LARGEST_TURN && (2.0 * **n).fract() == 0.0;
    let Some(n) = angles.iter().find(is_likely_in_degrees) else { return };
    let (degrees, turned) = (n.to_radians(), n % std::f64::consts::TAU);
    let message = format!(
        "an angle of {n} rad is more than a full turn: {n}° are {degrees} rad, {n} rad is the same rotation \
         as {turned} rad"
    );
    cx.report_first_of_similar_errors(place, message, help);
}

const SEPARATE: &str =
    "write spaces between the numbers instead of commas, and a decimal point, everywhere in the file";
const POINT: &str = "write one number, with a decimal point";
const SPACES: &str = "write that many numbers, separated by spaces";
const DIGITS: &str = "write digits, as in `-0.5` or `1e-3`";
