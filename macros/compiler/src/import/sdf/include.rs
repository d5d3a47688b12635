//! Expands `<include>` elements to the model of the included file, with the name and pose of the `<include>`.
//! The result is one text composed of pieces, each with its file of origin.
//!
//! Each file is first parsed separately, so that errors are reported at their positions in that file.

use super::version;
use crate::diag::Diagnostics;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, child_elements, element_source_position, nonblank_texts_and_own_elements, read_trimmed_content,
    report_duplicate, report_missing_or_misspelt_attributes,
};
use crate::import::whole::{
    ComposedText, LoadedRobotFile, MAX_DEPTH, MAX_FILES, canonical_path, report_include_cycle,
    report_too_many_includes,
};
use crate::import::{file, xml};
use crate::syntax::{FileFormat, Name};
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Child elements that the SDF element `<include>` may have.
const INCLUDE: [&str; 6] = ["uri", "name", "pose", "static", "plugin", "placement_frame"];

/// Half-open range of bytes in a file.
type ByteRange = std::ops::Range<usize>;

/// Step of the expansion. The list of steps is a stack: the last step is executed first.
enum ModelExpansionStep {
    /// Expansion step that copies a range of bytes of the file with this index.
    Copy(usize, ByteRange),
    /// Inserted text, attributed to a byte of a file: text, index of the file, offset.
    Put(String, usize, usize),
    /// Expansion step at the start of an included file.
    Include(Box<Include>),
    /// End of an included file. A later `<include>` of the same file is a repetition, not a cycle.
    Leave,
}

/// An `<include>` element: index of the including file and byte offset there, URI with its source position,
/// name, pose and plug-ins, and nesting depth.
struct Include {
    by: usize,
    from: usize,
    uri: Name,
    name: Option<ByteRange>,
    pose: Option<ByteRange>,
    plugins: Vec<ByteRange>,
    depth: usize,
}

/// Reads a file together with all files that it includes.
pub(super) fn read_with_includes(
    text: &str,
    path: &Path,
    name: &Name,
    cx: &mut Diagnostics,
) -> Option<ComposedText> {
    let mut whole = ComposedText::new(text, path, name);
    let mut places = vec![name.clone()];
    let (mut open, mut count) = (vec![0], 0);
    let mut steps = expansion_steps(&whole.files, 0, name, None, cx)?;
    while let Some(step) = steps.pop() {
        match step {
            ModelExpansionStep::Copy(file, range) => {
                whole.append_file_excerpt(file, range.start, range.end, name, cx)?
            }
            ModelExpansionStep::Put(text, file, at) => whole.append_text(&text, (file, at), name, cx)?,
            ModelExpansionStep::Leave => {
                open.pop();
            }
            ModelExpansionStep::Include(include) => {
                let found = find_included_file(&whole.files, &include, cx)?;
                count += 1;
                if include.depth > MAX_DEPTH || count > MAX_FILES {
                    report_too_many_includes(include.depth, &include.uri, cx);
                    return None;
                }
                let known = whole.files.iter().position(|read| canonical_path(&read.path) == found.path);
                if let Some(known) = known.filter(|known| open.contains(known)) {
                    report_include_cycle(known, &open, &whole.files, &places, &include.uri, cx);
                    return None;
                }
                let file = known.unwrap_or(whole.files.len());
                if known.is_none() {
                    whole.files.push(found);
                    places.push(include.uri.clone());
                }
                open.push(file);
                steps.push(ModelExpansionStep::Leave);
                steps.extend(expansion_steps(&whole.files, file, &include.uri, Some(&include), cx)?);
            }
        }
    }
    Some(whole)
}

/// Returns the steps that expand a file, last first: the whole file, or only its model for an `<include>`.
fn expansion_steps(
    files: &[LoadedRobotFile],
    file: usize,
    name: &Name,
    include: Option<&Include>,
    cx: &mut Diagnostics,
) -> Option<Vec<ModelExpansionStep>> {
    let read = files.get(file)?;
    let shown = Name { text: read.shown.clone(), place: name.place.clone() };
    let cx = &mut Cx::new(&read.text, &shown, cx);
    let declared = OnceCell::new();
    let document = xml::parse_document(&read.text, &declared, FileFormat::Sdf, cx)?;
    version::report_unsupported_sdf_version(document.root_element(), cx);
    // Declarations of undeclared prefixes shift the bytes of the text, so pieces of it cannot be copied.
    if declared.get().is_some() {
        return match include {
            None => copy_step_of_whole_file(&document, file, read, cx),
            Some(_) => {
                report_undeclared_prefixes(document.root_element(), cx);
                None
            }
        };
    }
    let root = document.root_element();
    let mut steps = Vec::new();
    let (top, mut at, end) = match include {
        None => (root, 0, read.text.len()),
        Some(include) => {
            let model = only_model_of_file(root, cx)?;
            add_model_start_tag(&mut steps, model, file, include);
            let byte_range_of_child = |child: Option<Node<'_>>| child.map(|child| child.range());
            let first =
                byte_range_of_child(model.first_child()).map_or(model.range().end, |range| range.start);
            let last = byte_range_of_child(model.last_child()).map_or(first, |range| range.end);
            (model, first, last)
        }
    };
    let depth = include.map_or(1, |include| include.depth + 1);
    for node in top.descendants().filter(Node::is_element) {
        let range = node.range();
        let is_moved = include.is_some_and(|include| include.pose.is_some());
        let is_own_pose = node.parent() == Some(top) && node.tag_name().name() == "pose" && is_moved;
        let replaces = if is_own_pose {
            None
        } else if node.tag_name().name() == "include" {
            match read_include(node, files, file, depth, cx) {
                Some(found) => Some(ModelExpansionStep::Include(Box::new(found))),
                // A world may include missing models, which are skipped.
                None => continue,
            }
        } else {
            continue;
        };
        steps.push(ModelExpansionStep::Copy(file, at..range.start));
        steps.extend(replaces);
        at = range.end;
    }
    steps.push(ModelExpansionStep::Copy(file, at..end));
    if include.is_some() {
        steps.push(ModelExpansionStep::Put("</model>".to_string(), file, end));
    }
    steps.reverse();
    (!cx.has_errors()).then_some(steps)
}

/// Returns the single copy step of a file with undeclared prefixes. Reports an `<include>` in it.
fn copy_step_of_whole_file(
    document: &roxmltree::Document<'_>,
    file: usize,
    read: &LoadedRobotFile,
    cx: &mut Cx<'_>,
) -> Option<Vec<ModelExpansionStep>> {
    let include =
        document.descendants().find(|node| node.is_element() && node.tag_name().name() == "include");
    if let Some(include) = include.filter(|include| !is_in_world(*include)) {
        report_undeclared_prefixes(include, cx);
        return None;
    }
    Some(vec![ModelExpansionStep::Copy(file, 0..read.text.len())])
}

fn report_undeclared_prefixes(node: Node<'_>, cx: &mut Cx<'_>) {
    cx.report_error(&element_source_position(node, cx), "prefixes of names are not declared", |d| {
        d.add_help(
            "files that include others, or are included, declare them: `<sdf \
             xmlns:gz=\"http://gazebosim.org/schema\">`",
        )
    });
}

fn is_in_world(node: Node<'_>) -> bool {
    node.parent().is_some_and(|parent| parent.tag_name().name() == "world")
}

/// Adds the start tag of an included SDF model, with name and pose of the `<include>` if it has them,
/// otherwise those of the model.
fn add_model_start_tag(steps: &mut Vec<ModelExpansionStep>, model: Node<'_>, file: usize, include: &Include) {
    let start = model.range().start;
    let text_expansion_step = |text: &str| ModelExpansionStep::Put(text.to_string(), file, start);
    steps.push(ModelExpansionStep::Put("<model name=\"".to_string(), include.by, include.from));
    match &include.name {
        Some(range) => steps.push(ModelExpansionStep::Copy(include.by, range.clone())),
        None => steps.extend(
            model.attribute_node("name").map(|name| ModelExpansionStep::Copy(file, name.range_value())),
        ),
    }
    steps.push(text_expansion_step("\""));
    // The version of the included file determines the interpretation of its elements.
    if let Some(version) = model.document().root_element().attribute_node("version") {
        steps.push(text_expansion_step(&format!(" {}=\"", version::OF_INCLUDED)));
        steps.push(ModelExpansionStep::Copy(file, version.range_value()));
        steps.push(text_expansion_step("\""));
    }
    let is_attribute_to_copy = |name: &str| name != "name" && name != version::OF_INCLUDED;
    for attribute in model.attributes().filter(|attribute| is_attribute_to_copy(attribute.name())) {
        steps.push(text_expansion_step(&format!(" {}=\"", attribute.name())));
        steps.push(ModelExpansionStep::Copy(file, attribute.range_value()));
        steps.push(text_expansion_step("\""));
    }
    steps.push(text_expansion_step(">"));
    let parts = include.pose.iter().chain(&include.plugins);
    steps.extend(parts.map(|part| ModelExpansionStep::Copy(include.by, part.clone())));
}

/// Returns the only model of an included file, or reports that it has no model or several.
fn only_model_of_file<'a>(root: Node<'a>, cx: &mut Cx<'_>) -> Option<Node<'a>> {
    let mut models = child_elements(root).filter(|node| node.tag_name().name() == "model");
    let found = models.next().filter(|_| root.tag_name().name() == "sdf");
    let second = models.next();
    if let (Some(model), None) = (found, second) {
        return Some(model);
    }
    let at = element_source_position(second.unwrap_or(root), cx);
    let what = if second.is_some() { "several models" } else { "no model" };
    cx.report_error(&at, format!("expected an SDF file with one model, found {what}"), |d| {
        d.add_help("an included file is `<sdf version=\"…\"><model name=\"…\"> … </model></sdf>`")
    });
    None
}

/// Reads an `<include>`. Returns `None` if it is invalid, which is reported, or if a world includes a missing
/// or static model.
fn read_include(
    node: Node<'_>,
    files: &[LoadedRobotFile],
    by: usize,
    depth: usize,
    cx: &mut Cx<'_>,
) -> Option<Include> {
    report_missing_or_misspelt_attributes(node, &[], &["merge"], cx);
    if node.attribute("merge").is_some_and(|merge| matches!(merge.trim(), "true" | "1")) {
        cx.report_error(
            &element_source_position(node, cx),
            "`merge` of an `<include>` is not supported",
            |d| d.add_help("write the expanded file: `gz sdf -p robot.sdf > whole.sdf`"),
        );
        return None;
    }
    let mut uri = None;
    let (mut own_name, mut pose, mut plugins) = (None, None, Vec::new());
    let mut seen: BTreeMap<&str, Node<'_>> = BTreeMap::new();
    for child in child_elements(node) {
        let text_range_of_child =
            || nonblank_texts_and_own_elements(child).find(Node::is_text).map(trimmed_range);
        let kind = child.tag_name().name();
        if let Some(first) = seen.insert(kind, child).filter(|_| kind != "plugin") {
            report_duplicate(child, Some(first), cx);
        }
        match kind {
            "uri" => uri = read_trimmed_content(child, cx),
            "name" => own_name = text_range_of_child(),
            "pose" => pose = Some(child.range()),
            "plugin" => plugins.push(child.range()),
            "static"
                if read_trimmed_content(child, cx)
                    .is_some_and(|word| matches!(word.text.as_str(), "true" | "1")) =>
            {
                if is_in_world(node) {
                    return None;
                }
                cx.report_error(
                    &element_source_position(child, cx),
                    "the included model is static and cannot move",
                    |d| d.add_help("remove `<static>`"),
                );
            }
            "placement_frame" => cx.report_error(
                &element_source_position(child, cx),
                "`placement_frame` is not supported",
                |d| d.add_help("give the `<include>` a `<pose>`"),
            ),
            _ => crate::import::element::report_misspelt_element_name(child, &INCLUDE, cx),
        }
    }
    let Some(uri) = uri else {
        cx.report_error(&element_source_position(node, cx), "`<include>` without a `<uri>`", |d| {
            d.add_help("expected `<uri>model://…</uri>` or the path of a file")
        });
        return None;
    };
    let from = node.range().start;
    if is_in_world(node) && include_candidates(files, by, &uri.text).iter().all(|(path, _)| !path.is_file()) {
        return None;
    }
    Some(Include { by, from, uri, name: own_name, pose, plugins, depth })
}

/// Returns the byte range of a text node without surrounding whitespace.
fn trimmed_range(text: Node<'_>) -> ByteRange {
    let (range, all) = (text.range(), text.text().unwrap_or_default());
    let before = all.len() - all.trim_start().len();
    let after = all.len() - all.trim_end().len();
    range.start + before..range.end.saturating_sub(after).max(range.start + before)
}

/// Returns the possible paths of an included file, each with the path for messages: relative to the including
/// file or to the user's file, and one folder above each. For a folder, the path is that of its model, which
/// is `model.sdf` unless `model.config` names another file.
fn include_candidates(files: &[LoadedRobotFile], by: usize, uri: &str) -> Vec<(PathBuf, String)> {
    let rest = ["model://", "file://", "package://"].iter().find_map(|scheme| uri.strip_prefix(scheme));
    let named = rest.unwrap_or(uri);
    let mut found = Vec::new();
    for file in [by, 0] {
        let Some(read) = files.get(file) else { continue };
        for above in ["", ".."] {
            let candidate_path_beside = |base: &Path| base.with_file_name(above).join(named);
            let (path, shown) =
                (candidate_path_beside(&read.path), candidate_path_beside(Path::new(&read.shown)));
            let inside = if path.is_dir() { Some(model_file_name(&path)) } else { None };
            let path_of_model = |base: PathBuf| match &inside {
                Some(inside) => base.join(inside),
                None => base,
            };
            found.push((path_of_model(path.clone()), path_of_model(shown).to_string_lossy().into_owned()));
        }
    }
    found
}

/// Returns the file name of the model in a folder.
fn model_file_name(folder: &Path) -> String {
    let usual = "model.sdf".to_string();
    let Ok(config) = std::fs::read_to_string(folder.join("model.config")) else { return usual };
    let Ok(document) = roxmltree::Document::parse(&config) else { return usual };
    let mut versions = document.root_element().children().filter(|node| node.tag_name().name() == "sdf");
    let last = versions.next_back().and_then(|node| node.text()).map(|text| text.trim().to_string());
    last.unwrap_or(usual)
}

/// Finds and reads the SDF file of an `<include>`.
fn find_included_file(
    files: &[LoadedRobotFile],
    include: &Include,
    cx: &mut Diagnostics,
) -> Option<LoadedRobotFile> {
    let all = include_candidates(files, include.by, &include.uri.text);
    let there = all.iter().find(|(path, _)| path.is_file());
    if there.is_none() && include.uri.text.contains("://") {
        let first = all.first().map_or(String::new(), |(path, _)| path.display().to_string());
        cx.report_error(
            include.uri.place.clone(),
            format!("{} is not next to the file", quote_word(&include.uri.text)),
        )
        .add_help(format!("looked for `{first}`, and one folder above"))
        .add_help("or write the expanded file: `gz sdf -p robot.sdf > whole.sdf`");
        return None;
    }
    let (path, shown) = there.or(all.first())?;
    let name = Name { text: shown.clone(), place: include.uri.place.clone() };
    let text = file::read_named_file(path, &name, FileFormat::Sdf, cx)?;
    Some(LoadedRobotFile {
        text: xml::blank_out_nonstandard_xml(&text).into_owned(),
        shown: shown.clone(),
        path: canonical_path(path),
    })
}
