//! Parsing of XML. Limits prevent a hostile file from taking excessive time or memory, and the parser's
//! errors are reported with the compiler's own messages. This module knows of the file formats only their
//! depth and that xacro may generate them.

use super::context::{Cx, quote_word};
use super::file::with_standard_whitespace;
use crate::diag::Place;
use crate::syntax::FileFormat;
use roxmltree::{Document, Error, Node, ParsingOptions};
use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::BTreeSet;

/// Maximum number of attributes of one element, since the parser compares every pair of them.
const MOST_ATTRIBUTES: usize = 64;
/// Maximum number of namespace declarations in a file, since the parser passes each one down the tree.
const MOST_NAMESPACES: usize = 256;
/// Maximum number of `<` and `=` in a file. The parser reserves memory for each.
const MOST_MARKS: usize = 1_000_000;

/// Elements of URDF and MJCF whose attributes are searched for expressions of xacro. Attributes of other
/// elements, for example of plug-ins, may contain any text.
const READ: [&str; 12] = [
    "robot", "link", "joint", "inertial", "mass", "inertia", "origin", "axis", "parent", "child", "dynamics",
    "mimic",
];

/// Returns the maximum nesting depth of elements. URDF needs six levels, MJCF one for each link of a chain.
fn max_depth(format: FileFormat) -> usize {
    match format {
        FileFormat::Urdf | FileFormat::Sdf => 64,
        FileFormat::Mjcf => 256,
    }
}

/// Returns the text of a file in which whitespace characters that XML does not know, and an XML declaration
/// after empty lines, are replaced by spaces. Other readers of URDF accept both. Lines and columns are
/// preserved.
pub(super) fn blank_out_nonstandard_xml(text: &str) -> Cow<'_, str> {
    match with_standard_whitespace(text.trim_end_matches('\0')) {
        Cow::Borrowed(plain) => blank_out_late_xml_declaration(plain),
        Cow::Owned(plain) => Cow::Owned(blank_out_late_xml_declaration(&plain).into_owned()),
    }
}

fn blank_out_late_xml_declaration(text: &str) -> Cow<'_, str> {
    let start = text.len() - text.trim_start().len();
    let declaration = &text[start..];
    if start == 0 || !declaration.starts_with("<?xml ") {
        return Cow::Borrowed(text);
    }
    let Some((declaration, rest)) = declaration.split_once("?>") else { return Cow::Borrowed(text) };
    let blank: String = declaration.chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
    Cow::Owned(format!("{}{blank}  {rest}", &text[..start]))
}

/// Maximum number of undeclared prefixes for which declarations are added.
const MOST_PREFIXES: usize = 16;

/// Parses a file. Returns `None` with the error in `cx` if the file is not XML or is a template of xacro. If
/// the file uses undeclared prefixes, `declared` receives its text with the missing declarations.
///
/// Exporters drop the declarations of simulators' prefixes (`drake:`, `sensor:`) but keep the elements and
/// attributes with these prefixes. The importers skip all of these, so missing declarations are not an error:
/// the prefixes are declared in the root element.
pub(super) fn parse_document<'t>(
    text: &'t str,
    declared: &'t OnceCell<String>,
    format: FileFormat,
    cx: &mut Cx<'_>,
) -> Option<Document<'t>> {
    let MarkupScan { root, unclosed, prefixes } = match check_size_and_nesting(text, format) {
        Ok(found) => found,
        Err((offset, message)) => {
            cx.report_error(&cx.source_position(offset), message, |d| d);
            return None;
        }
    };
    let error = match parse_xml_without_dtd(text) {
        Ok(document) => return reject_template(&document, format, cx).then_some(document),
        Err(error) => error,
    };
    let at = end_of_name(text, root);
    let declarations = match &error {
        Error::UnknownNamespace(..) if root < text.len() => {
            missing_prefix_declarations(&text[root..], &prefixes)
        }
        _ => String::new(),
    };
    cx.record_inserted_text(at, &declarations);
    let error = match &declarations {
        none if none.is_empty() => error,
        some => match parse_xml_without_dtd(declared.get_or_init(|| insert_text(text, at, some))) {
            Ok(document) => return reject_template(&document, format, cx).then_some(document),
            Err(error) => error,
        },
    };
    let unclosed = unclosed.map(|start| if start > at { start + declarations.len() } else { start });
    report_parser_error(&error, text, unclosed, format, cx);
    None
}

/// Returns the index of the byte after the name of the element that starts at byte `element`.
fn end_of_name(text: &str, element: usize) -> usize {
    let name = text.get(element + 1..).unwrap_or_default();
    let end = name.find(|c: char| c.is_whitespace() || matches!(c, '/' | '>' | '='));
    end.map_or(text.len(), |length| element + 1 + length)
}

fn insert_text(text: &str, at: usize, more: &str) -> String {
    let (before, after) = text.split_at(at);
    [before, more, after].concat()
}

/// Returns declarations of the undeclared prefixes, for insertion into the root element. All are added at
/// once, because each attempt to parse takes time proportional to the size of the file.
fn missing_prefix_declarations(root: &str, prefixes: &[&str]) -> String {
    let tag = &root[..scan_start_tag(root, 0, &mut Vec::new(), &mut |_| {}).unwrap_or(root.len())];
    let own: Vec<&str> =
        tag.split("xmlns:").skip(1).filter_map(|rest| rest.split(is_not_prefix_character).next()).collect();
    let is_undeclared_prefix = |prefix: &&&str| {
        // Declaring the root's own prefix would put the whole tree into a foreign namespace.
        let is_root = tag
            .strip_prefix('<')
            .and_then(|name| name.strip_prefix(**prefix))
            .is_some_and(|rest| rest.starts_with(':'));
        !is_root && !["xacro", "xml", "xmlns"].contains(*prefix) && !own.contains(*prefix)
    };
    let wanted = prefixes.iter().filter(is_undeclared_prefix).take(MOST_PREFIXES);
    wanted.map(|prefix| format!(" xmlns:{prefix}=\"undeclared:{prefix}\"")).collect()
}

/// Returns true for characters that cannot be part of a prefix.
fn is_not_prefix_character(c: char) -> bool {
    c.is_ascii() && !c.is_ascii_alphanumeric() && !matches!(c, '_' | '-' | '.')
}

fn parse_xml_without_dtd(text: &str) -> Result<Document<'_>, Error> {
    Document::parse_with_options(text, ParsingOptions { allow_dtd: false, ..ParsingOptions::default() })
}

/// Result of a scan of an XML file's markup without building a tree.
struct MarkupScan<'t> {
    /// Byte offset of the root element.
    root: usize,
    /// Byte offset of the innermost element that is never closed.
    unclosed: Option<usize>,
    /// Prefixes of names, in the order of their first use.
    prefixes: Vec<&'t str>,
}

/// Checks the limits on size and nesting of an XML file without building a tree.
///
/// The scan agrees with the parser up to the first syntax error. After it the scan may be wrong, which has no
/// effect because the parser stops there.
fn check_size_and_nesting(text: &str, format: FileFormat) -> Result<MarkupScan<'_>, (usize, String)> {
    let marks = text.bytes().filter(|b| matches!(b, b'<' | b'=')).count();
    if marks > MOST_MARKS || text.matches("xmlns").count() > MOST_NAMESPACES {
        return Err((0, "the file has too many elements, attributes or namespaces for a robot".to_string()));
    }
    let deepest = max_depth(format);
    let mut open = Vec::new();
    let (mut at, mut root) = (0, None);
    let (mut prefixes, mut known) = (Vec::new(), BTreeSet::new());
    let mut record_prefix = |prefix| {
        if known.insert(prefix) {
            prefixes.push(prefix);
        }
    };
    while let Some(start) = text[at..].find('<').map(|k| at + k) {
        let rest = &text[start..];
        at = start
            + if rest.starts_with("<!--") {
                markup_length(rest, 4, "-->")
            } else if rest.starts_with("<![CDATA[") {
                markup_length(rest, 9, "]]>")
            } else if rest.starts_with("<?") {
                markup_length(rest, 2, "?>")
            } else if rest.starts_with("<!DOCTYPE") {
                return Err((
                    start,
                    format!(
                        "{} has no document type and no entities of its own",
                        format.file_format_phrase()
                    ),
                ));
            } else if rest.starts_with("</") {
                open.pop();
                markup_length(rest, 2, ">")
            } else {
                root.get_or_insert(start);
                let length = scan_start_tag(rest, start, &mut open, &mut record_prefix)?;
                if open.len() > deepest {
                    return Err((start, format!("more than {deepest} nested elements")));
                }
                length
            };
    }
    Ok(MarkupScan { root: root.unwrap_or(text.len()), unclosed: open.pop(), prefixes })
}

/// Returns the length of a piece of markup that ends with `end`.
fn markup_length(rest: &str, skip: usize, end: &str) -> usize {
    rest.get(skip..).and_then(|body| body.find(end)).map_or(rest.len(), |k| skip + k + end.len())
}

/// Returns the length of the start tag at the beginning of `rest`. Adds the element to `open` unless it is
/// empty, and calls `note` with the prefixes of names.
fn scan_start_tag<'t>(
    rest: &'t str,
    start: usize,
    open: &mut Vec<usize>,
    note: &mut dyn FnMut(&'t str),
) -> Result<usize, (usize, String)> {
    let bytes = rest.as_bytes();
    let (mut k, mut attributes, mut name) = (1, 0, 1);
    while k < bytes.len() && bytes[k] != b'>' && bytes[k] != b'<' {
        if matches!(bytes[k], b'"' | b'\'') {
            attributes += 1;
            k = bytes[k + 1..].iter().position(|b| *b == bytes[k]).map_or(bytes.len(), |n| k + 1 + n);
        } else if bytes[k] == b':' && k > name && !matches!(bytes[name], b'0'..=b'9' | b'-' | b'.') {
            note(&rest[name..k]);
        }
        if bytes.get(k).is_none_or(|b| is_not_prefix_character(char::from(*b))) {
            name = k + 1;
        }
        k += 1;
    }
    if attributes > MOST_ATTRIBUTES {
        return Err((start, format!("element with more than {MOST_ATTRIBUTES} attributes")));
    }
    let k = k.min(bytes.len());
    if bytes[k - 1] != b'/' {
        open.push(start);
    }
    // The `<` after an unterminated tag belongs to the next tag.
    Ok(if bytes.get(k) == Some(&b'>') { k + 1 } else { k })
}

/// Reports a template that xacro must expand first; only its first instruction or expression is reported.
/// Returns true if the document is not a template.
fn reject_template(document: &Document<'_>, format: FileFormat, cx: &mut Cx<'_>) -> bool {
    for node in document.descendants().filter(Node::is_element) {
        let name = node.tag_name();
        if name.namespace().is_some_and(|uri| uri.contains("xacro")) {
            let message =
                format!("{} is an instruction to xacro", quote_word(&format!("<xacro:{}>", name.name())));
            cx.report_error(&cx.source_position(node.range().start), message, |d| {
                d.add_help(xacro_help(format))
            });
            return false;
        }
        if let Some((offset, value)) = unexpanded_xacro_expression(node, format) {
            let message = format!("{} is an expression of xacro", quote_word(value));
            cx.report_error(&cx.source_position(offset), message, |d| d.add_help(xacro_help(format)));
            return false;
        }
    }
    true
}

/// Returns an expression that xacro would have replaced by a value, with its byte offset.
fn unexpanded_xacro_expression<'t>(node: Node<'_, 't>, format: FileFormat) -> Option<(usize, &'t str)> {
    let has_known_tag = READ.contains(&node.tag_name().name());
    let contains_xacro_expression = |value: &str| value.contains("${") || value.contains("$(");
    let attributes = node.attributes().filter(|_| has_known_tag || format == FileFormat::Sdf);
    let mut said = attributes.filter(|attribute| contains_xacro_expression(attribute.value()));
    if let Some(found) = said.next() {
        return Some((found.range_value().start, document_text_in_range(node, found.range_value())?));
    }
    // Values in SDF are the text of elements. Plug-ins and elements with children may contain any text.
    let text = node.first_child().filter(|child| format == FileFormat::Sdf && child.is_text())?;
    let in_plugin = node.ancestors().any(|above| above.tag_name().name() == "plugin");
    let found = text.text().filter(|text| contains_xacro_expression(text) && !in_plugin)?;
    let before = found.len() - found.trim_start().len();
    Some((text.range().start + before, document_text_in_range(node, text.range())?.trim()))
}

fn document_text_in_range<'t>(node: Node<'_, 't>, range: std::ops::Range<usize>) -> Option<&'t str> {
    node.document().input_text().get(range)
}

/// Returns the help text with the command that expands a template.
fn xacro_help(format: FileFormat) -> &'static str {
    match format {
        FileFormat::Urdf => "expand the file first: `xacro robot.urdf.xacro > robot.urdf`",
        FileFormat::Mjcf => "expand the file first: `xacro robot.xml.xacro > robot.xml`",
        FileFormat::Sdf => "expand the file first: `xacro robot.sdf.xacro > robot.sdf`",
    }
}

/// Reports a syntax error that the XML parser found.
fn report_parser_error(
    error: &Error,
    text: &str,
    unclosed: Option<usize>,
    format: FileFormat,
    cx: &mut Cx<'_>,
) {
    let mut help = None;
    let message = match error {
        Error::UnexpectedCloseTag(expected, actual, _) => {
            let (expected, actual) = (format!("</{expected}>"), format!("</{actual}>"));
            format!("expected {}, found {}", quote_word(&expected), quote_word(&actual))
        }
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => match unclosed {
            Some(_) => "this element is never closed".to_string(),
            None => "the file ends in the middle of a tag".to_string(),
        },
        Error::NoRootNode => "there is no element".to_string(),
        Error::DuplicatedAttribute(name, _) => format!("attribute {} is given twice", quote_word(name)),
        Error::UnknownEntityReference(name, _) => {
            format!("unknown entity {}", quote_word(&format!("&{name};")))
        }
        Error::MalformedEntityReference(_) => {
            help = Some("write `&amp;` for `&`");
            "this `&` does not begin an entity".to_string()
        }
        Error::UnknownNamespace(prefix, _) => {
            help = (prefix == "xacro").then_some(xacro_help(format));
            format!("unknown namespace prefix {}", quote_word(prefix))
        }
        other => other.to_string().replace(&format!(" at {}", other.pos()), "").replace('\'', "`"),
    };
    if !text.trim_start().starts_with('<') {
        help = Some(match format {
            FileFormat::Urdf => "a URDF file is XML: `<robot name=\"…\"> … </robot>`",
            FileFormat::Mjcf => "an MJCF file is XML: `<mujoco> … </mujoco>`",
            FileFormat::Sdf => "an SDF file is XML: `<sdf version=\"…\"> … </sdf>`",
        });
    }
    cx.report_error(
        &position_of_parser_error(error, unclosed, cx),
        format!("malformed XML: {message}"),
        |d| match help {
            Some(help) => d.add_help(help),
            None => d,
        },
    );
}

/// Returns the position of a parser error. The parser gives no position for a premature end of the file.
fn position_of_parser_error(error: &Error, unclosed: Option<usize>, cx: &Cx<'_>) -> Place {
    match (error, unclosed) {
        (Error::UnclosedRootNode | Error::UnexpectedEndOfStream, Some(offset)) => cx.source_position(offset),
        (Error::UnclosedRootNode | Error::UnexpectedEndOfStream, None) => cx.end_of_file(),
        _ => cx.source_position_from_parsed_text(error.pos().row, error.pos().col),
    }
}
