//! Text → XML tree, with the limits that keep a hostile file from taking time or memory, and the parser's
//! errors in our words. Knows of the formats only that files are sometimes made by xacro.

use super::context::{Cx, quote};
use super::file::with_plain_blanks;
use crate::diag::Place;
use crate::syntax::FileFormat;
use roxmltree::{Document, Error, Node, ParsingOptions};
use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::BTreeSet;

/// Attributes of one element: the parser compares each with each.
const MOST_ATTRIBUTES: usize = 64;
/// Namespace declarations of a file: the parser hands each down the tree.
const MOST_NAMESPACES: usize = 256;
/// `<` and `=` of a file: the parser reserves memory for each.
const MOST_MARKS: usize = 1_000_000;

/// The elements whose attributes are read; the text of others (a plug-in's, say) may hold anything.
const READ: [&str; 12] = [
    "robot", "link", "joint", "inertial", "mass", "inertia", "origin", "axis", "parent", "child", "dynamics",
    "mimic",
];

/// Most elements inside one another. URDF needs six, MJCF one for each link of a chain.
fn max_depth(format: FileFormat) -> usize {
    match format {
        FileFormat::Urdf | FileFormat::Sdf => 64,
        FileFormat::Mjcf => 256,
    }
}

/// Returns the text of a file with spaces in the place of blanks that XML does not know, and of an XML
/// declaration that follows empty lines: other readers of URDF take both. Lines and columns are preserved.
pub(super) fn cleaned(text: &str) -> Cow<'_, str> {
    match with_plain_blanks(text.trim_end_matches('\0')) {
        Cow::Borrowed(plain) => without_late_declaration(plain),
        Cow::Owned(plain) => Cow::Owned(without_late_declaration(&plain).into_owned()),
    }
}

fn without_late_declaration(text: &str) -> Cow<'_, str> {
    let start = text.len() - text.trim_start().len();
    let declaration = &text[start..];
    if start == 0 || !declaration.starts_with("<?xml ") {
        return Cow::Borrowed(text);
    }
    let Some((declaration, rest)) = declaration.split_once("?>") else { return Cow::Borrowed(text) };
    let blank: String = declaration.chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
    Cow::Owned(format!("{}{blank}  {rest}", &text[..start]))
}

/// Prefixes that the root does not declare and that are declared for the file.
const MOST_PREFIXES: usize = 16;

/// Parses the file; `None` if it is not XML or is a template. `declared` holds its text where that lacks
/// declarations.
///
/// Exporters drop the declarations of simulators' prefixes (`drake:`, `sensor:`) and keep what bears them.
/// All of that is skipped, so it is no mistake: the prefixes are declared in the root element.
pub(super) fn parse<'t>(
    text: &'t str,
    declared: &'t OnceCell<String>,
    format: FileFormat,
    cx: &mut Cx<'_>,
) -> Option<Document<'t>> {
    let Scan { root, unclosed, prefixes } = match scan(text, format) {
        Ok(found) => found,
        Err((offset, message)) => {
            cx.error(&cx.place(offset), message, |d| d);
            return None;
        }
    };
    let error = match parse_plain(text) {
        Ok(document) => return refuse_template(&document, format, cx).then_some(document),
        Err(error) => error,
    };
    let at = behind_name(text, root);
    let declarations = match &error {
        Error::UnknownNamespace(..) if root < text.len() => declarations(&text[root..], &prefixes),
        _ => String::new(),
    };
    cx.add(at, &declarations);
    let error = match &declarations {
        none if none.is_empty() => error,
        some => match parse_plain(declared.get_or_init(|| with(text, at, some))) {
            Ok(document) => return refuse_template(&document, format, cx).then_some(document),
            Err(error) => error,
        },
    };
    let unclosed = unclosed.map(|start| if start > at { start + declarations.len() } else { start });
    report(&error, text, unclosed, format, cx);
    None
}

/// The end of an element's name.
fn behind_name(text: &str, element: usize) -> usize {
    let name = text.get(element + 1..).unwrap_or_default();
    let end = name.find(|c: char| c.is_whitespace() || matches!(c, '/' | '>' | '='));
    end.map_or(text.len(), |length| element + 1 + length)
}

fn with(text: &str, at: usize, more: &str) -> String {
    let (before, after) = text.split_at(at);
    [before, more, after].concat()
}

/// Declarations of prefixes for the text of the root element, those that it declares itself left out: all at
/// once, because each attempt to parse takes as long as the file.
fn declarations(root: &str, prefixes: &[&str]) -> String {
    let tag = &root[..scan_tag(root, 0, &mut Vec::new(), &mut |_| {}).unwrap_or(root.len())];
    let own: Vec<&str> =
        tag.split("xmlns:").skip(1).filter_map(|rest| rest.split(not_in_a_name).next()).collect();
    let is_wanted = |prefix: &&&str| {
        // The root's own prefix would make all that is in it foreign.
        let is_root = tag
            .strip_prefix('<')
            .and_then(|name| name.strip_prefix(**prefix))
            .is_some_and(|rest| rest.starts_with(':'));
        !is_root && !["xacro", "xml", "xmlns"].contains(*prefix) && !own.contains(*prefix)
    };
    let wanted = prefixes.iter().filter(is_wanted).take(MOST_PREFIXES);
    wanted.map(|prefix| format!(" xmlns:{prefix}=\"undeclared:{prefix}\"")).collect()
}

/// True for characters that stand in no prefix.
fn not_in_a_name(c: char) -> bool {
    c.is_ascii() && !c.is_ascii_alphanumeric() && !matches!(c, '_' | '-' | '.')
}

fn parse_plain(text: &str) -> Result<Document<'_>, Error> {
    Document::parse_with_options(text, ParsingOptions { allow_dtd: false, ..ParsingOptions::default() })
}

/// What a look at the marks of a file tells.
struct Scan<'t> {
    /// Where the first element begins.
    root: usize,
    /// Where the innermost element begins that is never closed.
    unclosed: Option<usize>,
    /// The prefixes of names, in the order in which they come first.
    prefixes: Vec<&'t str>,
}

/// Checks the limits without building a tree.
///
/// It follows the parser's own reading of the text up to the first mistake of the text; behind that it may
/// err, because the parser stops there.
fn scan(text: &str, format: FileFormat) -> Result<Scan<'_>, (usize, String)> {
    let marks = text.bytes().filter(|b| matches!(b, b'<' | b'=')).count();
    if marks > MOST_MARKS || text.matches("xmlns").count() > MOST_NAMESPACES {
        return Err((0, "the file has too many elements, attributes or namespaces for a robot".to_string()));
    }
    let deepest = max_depth(format);
    let mut open = Vec::new();
    let (mut at, mut root) = (0, None);
    let (mut prefixes, mut known) = (Vec::new(), BTreeSet::new());
    let mut note = |prefix| {
        if known.insert(prefix) {
            prefixes.push(prefix);
        }
    };
    while let Some(start) = text[at..].find('<').map(|k| at + k) {
        let rest = &text[start..];
        at = start
            + if rest.starts_with("<!--") {
                end_behind(rest, 4, "-->")
            } else if rest.starts_with("<![CDATA[") {
                end_behind(rest, 9, "]]>")
            } else if rest.starts_with("<?") {
                end_behind(rest, 2, "?>")
            } else if rest.starts_with("<!DOCTYPE") {
                return Err((
                    start,
                    format!("{} has no document type and no entities of its own", format.article()),
                ));
            } else if rest.starts_with("</") {
                open.pop();
                end_behind(rest, 2, ">")
            } else {
                root.get_or_insert(start);
                let length = scan_tag(rest, start, &mut open, &mut note)?;
                if open.len() > deepest {
                    return Err((start, format!("more than {deepest} elements inside one another")));
                }
                length
            };
    }
    Ok(Scan { root: root.unwrap_or(text.len()), unclosed: open.pop(), prefixes })
}

/// Length of a piece of markup that ends with `end`.
fn end_behind(rest: &str, skip: usize, end: &str) -> usize {
    rest.get(skip..).and_then(|body| body.find(end)).map_or(rest.len(), |k| skip + k + end.len())
}

/// Length of the start tag at the head of `rest`; the element is added to `open` unless it is empty, and
/// prefixes of names are noted.
fn scan_tag<'t>(
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
        if bytes.get(k).is_none_or(|b| not_in_a_name(char::from(*b))) {
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
    // The `<` of a tag without end belongs to the next one.
    Ok(if bytes.get(k) == Some(&b'>') { k + 1 } else { k })
}

/// Reports a file that xacro has still to expand, once; true if it is none.
fn refuse_template(document: &Document<'_>, format: FileFormat, cx: &mut Cx<'_>) -> bool {
    for node in document.descendants().filter(Node::is_element) {
        let name = node.tag_name();
        if name.namespace().is_some_and(|uri| uri.contains("xacro")) {
            let message =
                format!("{} is an instruction to xacro", quote(&format!("<xacro:{}>", name.name())));
            cx.error(&cx.place(node.range().start), message, |d| d.help(run_xacro(format)));
            return false;
        }
        if let Some((offset, value)) = expression(node, format) {
            let message = format!("{} is an expression of xacro", quote(value));
            cx.error(&cx.place(offset), message, |d| d.help(run_xacro(format)));
            return false;
        }
    }
    true
}

/// An expression that xacro would have put a value for, and where it is.
fn expression<'t>(node: Node<'_, 't>, format: FileFormat) -> Option<(usize, &'t str)> {
    let is_read = READ.contains(&node.tag_name().name());
    let is_expression = |value: &str| value.contains("${") || value.contains("$(");
    let attributes = node.attributes().filter(|_| is_read || format == FileFormat::Sdf);
    let mut said = attributes.filter(|attribute| is_expression(attribute.value()));
    if let Some(found) = said.next() {
        return Some((found.range_value().start, document_slice(node, found.range_value())?));
    }
    // What SDF says stands in elements; those with elements in them, and plug-ins, may hold anything.
    let text = node.first_child().filter(|child| format == FileFormat::Sdf && child.is_text())?;
    let in_plugin = node.ancestors().any(|above| above.tag_name().name() == "plugin");
    let found = text.text().filter(|text| is_expression(text) && !in_plugin)?;
    let before = found.len() - found.trim_start().len();
    Some((text.range().start + before, document_slice(node, text.range())?.trim()))
}

fn document_slice<'t>(node: Node<'_, 't>, range: std::ops::Range<usize>) -> Option<&'t str> {
    node.document().input_text().get(range)
}

/// What expands a template.
fn run_xacro(format: FileFormat) -> &'static str {
    match format {
        FileFormat::Urdf => "expand the file first: `xacro robot.urdf.xacro > robot.urdf`",
        FileFormat::Mjcf => "expand the file first: `xacro robot.xml.xacro > robot.xml`",
        FileFormat::Sdf => "expand the file first: `xacro robot.sdf.xacro > robot.sdf`",
    }
}

/// Reports the parser's error.
fn report(error: &Error, text: &str, unclosed: Option<usize>, format: FileFormat, cx: &mut Cx<'_>) {
    let mut help = None;
    let message = match error {
        Error::UnexpectedCloseTag(expected, actual, _) => {
            let (expected, actual) = (format!("</{expected}>"), format!("</{actual}>"));
            format!("expected {}, found {}", quote(&expected), quote(&actual))
        }
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => match unclosed {
            Some(_) => "this element is never closed".to_string(),
            None => "the file ends in the middle of a tag".to_string(),
        },
        Error::NoRootNode => "there is no element".to_string(),
        Error::DuplicatedAttribute(name, _) => format!("attribute {} is given twice", quote(name)),
        Error::UnknownEntityReference(name, _) => format!("unknown entity {}", quote(&format!("&{name};"))),
        Error::MalformedEntityReference(_) => {
            help = Some("write `&amp;` for `&`");
            "this `&` begins no entity".to_string()
        }
        Error::UnknownNamespace(prefix, _) => {
            help = (prefix == "xacro").then_some(run_xacro(format));
            format!("unknown namespace prefix {}", quote(prefix))
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
    cx.error(&place_of(error, unclosed, cx), format!("malformed XML: {message}"), |d| match help {
        Some(help) => d.help(help),
        None => d,
    });
}

/// The parser knows no place for an early end.
fn place_of(error: &Error, unclosed: Option<usize>, cx: &Cx<'_>) -> Place {
    match (error, unclosed) {
        (Error::UnclosedRootNode | Error::UnexpectedEndOfStream, Some(offset)) => cx.place(offset),
        (Error::UnclosedRootNode | Error::UnexpectedEndOfStream, None) => cx.end(),
        _ => cx.parsed_at(error.pos().row, error.pos().col),
    }
}
