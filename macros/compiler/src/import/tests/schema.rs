//! Attributes of MJCF: each attribute that may affect the motion changes the imported description or is
//! rejected.

use super::mjcf::mjcf_options;
use super::*;
use crate::import::mjcf::schema;
use std::collections::{BTreeMap, BTreeSet};

const CASES: &str = include_str!("schema.txt");

/// Bodies with joints, sites, a shape, tendons, couplings and an actuator.
const BODIES: &str = "<worldbody><site name='o'/><body name='b' euler='10 20 30'>\
    <joint name='j' range='-1 1' limited='true' stiffness='3' damping='2' frictionloss='1'/><geom type='box' size='1 2 3'/>\
    <body name='e'><joint name='k' type='slide' range='-1 1' limited='true'/><joint name='n'/>\
    <inertial pos='1 0 0' mass='2' diaginertia='1 1 3'/><geom name='g' type='cylinder' size='.1 1' pos='3 0 0'/>\
    <site name='s' pos='5 1 0'/></body></body></worldbody>\
    <tendon><fixed name='t'><joint joint='j' coef='2'/></fixed><fixed name='u'><joint joint='n' coef='3'/></fixed></tendon>\
    <equality><joint joint1='n' joint2='k'/></equality><actuator><motor joint='j' group='2'/></actuator>";

/// MJCF class of defaults with values that occur nowhere else.
const CLASS: &str = "<default><default class='c'><joint stiffness='7'/><geom density='7'/><site pos='7 7 7'/><motor gear='9'/>\
    <tendon stiffness='7'/><equality active='false'/></default></default>";

const LISTS: [(&str, &str); 4] = [
    ("*axes", "quat=1 2 3 4; axisangle=1 0 0 1; euler=10 20 30; xyaxes=0 1 0 1 0 0; zaxis=1 0 0"),
    (
        "*tendon",
        "actuatorfrclimited=true; actuatorfrcrange=-1 1; armature=2; damping=3; frictionloss=4; limited=true; \
         range=-1 1; springlength=0.5; springyield=1; stiffness=8",
    ),
    (
        "*motor",
        "armature=2; class=c; ctrllimited=true; ctrlrange=-1 1; damping=3; delay=1; forcelimited=true; forcerange=-1 1; gear=7; \
         name=x",
    ),
    ("*target", "joint=k; jointinparent=k; site=s; slidersite=s; cranksite=s; tendon=t"),
];

/// MJCF elements that are rejected together with all their attributes.
const REFUSED: [&str; 2] = ["adhesion", "orientation"];

/// Returns the imported MJCF description as text, or the error messages.
fn import_mjcf_as_text(text: &str) -> String {
    let mut cx = Diagnostics::new();
    match import_text(text, &mjcf_options(), &mut cx) {
        Some(imported) => format!("{imported:?}"),
        None => cx.full_message_texts().join("\n"),
    }
}

/// Returns the results of a file with and without an attribute. Spaces replace the attribute, so that source
/// positions are equal.
fn results_with_and_without_attribute(file: &str, attribute: &str, value: &str) -> [String; 2] {
    let said = format!("{attribute}=\"{value}\"");
    let file = file.replace('$', CLASS).replace('#', BODIES);
    [said.clone(), " ".repeat(said.len())]
        .map(|said| import_mjcf_as_text(&format!("<mujoco>{}</mujoco>", file.replace('@', &said))))
}

#[test]
fn attributes_that_affect_motion_are_read_or_rejected() {
    let mut silent = Vec::new();
    let (mut shown, mut at): (BTreeMap<&str, BTreeSet<&str>>, _) = (BTreeMap::new(), None);
    for line in CASES.lines().skip_while(|line| !line.starts_with('>')).filter(|line| !line.is_empty()) {
        if let Some((element, file)) = line.strip_prefix("> ").and_then(|line| line.split_once(": ")) {
            at = Some((element, file));
            continue;
        }
        let (element, file) = at.expect("an element stands before its attributes");
        let known = shown.entry(element).or_default();
        if let Some(elsewhere) = line.strip_prefix("! ") {
            known.extend(elsewhere.split(' '));
            continue;
        }
        let list = LISTS.iter().find(|(name, _)| *name == line).map_or(line, |(_, list)| list);
        for (attribute, value) in list.split("; ").filter_map(|one| one.split_once('=')) {
            known.insert(attribute);
            let [with, without] = results_with_and_without_attribute(file, attribute, value);
            if with == without || with.contains("unknown attribute") {
                silent.push(format!("{element} {attribute}=\"{value}\""));
            }
        }
    }
    for (element, attributes) in schema::read_schema() {
        if REFUSED.iter().any(|kind| element == format!("actuator/{kind}")) {
            let text =
                format!("<mujoco>{BODIES}<actuator><{}/></actuator></mujoco>", &element["actuator/".len()..]);
            assert!(import_mjcf_as_text(&text).contains("is not supported"), "{element}");
            continue;
        }
        let known = shown.get(element.as_str());
        let missing: Vec<&str> = attributes
            .moving
            .into_iter()
            .filter(|one| !known.is_some_and(|known| known.contains(one)))
            .collect();
        silent.extend(missing.into_iter().map(|one| format!("{element} {one} is not in the list")));
    }
    assert!(silent.is_empty(), "attributes that change nothing:\n{}", silent.join("\n"));
}

/// Each element of MuJoCo is in the importer's list of attributes, or in its list of elements that are left
/// out, which the guide names.
#[test]
fn importer_schema_lists_the_elements_of_mujoco() {
    let ours = schema::read_schema();
    let list = include_str!("mujoco_schema.txt").replace("\n    ", " ");
    let mut missing = Vec::new();
    for line in list.lines().skip_while(|line| !line.starts_with("mujoco:")) {
        let (elements, attributes) = line.split_once(':').expect("a colon follows the elements");
        let (parent, names) =
            elements.rsplit_once('/').map_or(("", elements), |(parent, names)| (parent, names));
        for name in names.split(',') {
            let path = if parent.is_empty() { name.to_string() } else { format!("{parent}/{name}") };
            let is_whole = path.split('/').any(|part| schema::WHOLE.contains(&part));
            match ours.get(&path) {
                None if !is_whole => missing.push(path),
                None => {}
                Some(known) => missing.extend(
                    attributes
                        .split_ascii_whitespace()
                        .filter(|one| !known.moving.contains(one) && !known.idle.contains(one))
                        .map(|one| format!("{path} {one}")),
                ),
            }
        }
    }
    assert!(missing.is_empty(), "not in the schema of the importer: {}", missing.join(", "));
    let guide = concat!(env!("CARGO_MANIFEST_DIR"), "/../../runtime/guide/robots.md");
    let guide = std::fs::read_to_string(guide).expect("the guide is in the repository");
    let unnamed: Vec<&str> =
        schema::WHOLE.into_iter().filter(|name| !guide.contains(&format!("`{name}`"))).collect();
    assert!(unnamed.is_empty(), "not in the guide: {}", unnamed.join(", "));
}

#[test]
fn attributes_without_effect_on_motion_are_accepted() {
    for (element, attribute) in
        [("joint", "margin"), ("geom", "rgba"), ("site", "user"), ("geom", "castshadow")]
    {
        let import_with_attribute = |said: &str| {
            import_mjcf_as_text(&format!(
                "<mujoco><worldbody><body><joint/><geom size='1'/><{element} {said}/></body></worldbody>\
                 </mujoco>"
            ))
        };
        let said = format!("{attribute}=\"1\"");
        assert_eq!(
            import_with_attribute(&said),
            import_with_attribute(&" ".repeat(said.len())),
            "{element} {attribute}"
        );
    }
}

#[test]
fn unknown_mjcf_elements_are_rejected() {
    for (inside, at, message, help) in [
        (
            "<worldbody><body colour='red'/></worldbody>",
            "colour",
            "attribute `colour` of `<body>`",
            "remove it",
        ),
        (
            "<worldbody><body><joint stifness='1'/></body></worldbody>",
            "stifness",
            "attribute `stifness` of `<joint>`",
            "`stiffness`",
        ),
        (
            "<worldbody/><sensor><clock frequency='1'/></sensor>",
            "frequency",
            "attribute `frequency` of `<clock>`",
            "remove it",
        ),
        ("<worldbody/><sensor><clok/></sensor>", "<clok", "element `<clok>`", "did you mean `<clock>`?"),
        (
            "<default><joint name='j'/></default><worldbody/>",
            "name",
            "attribute `name` of `<joint>`",
            "remove it",
        ),
        (
            "<default><spatial stiffness='1'/></default><worldbody/>",
            "<spatial",
            "element `<spatial>`",
            "remove it",
        ),
        ("<worldbody><foo/></worldbody>", "<foo", "element `<foo>`", "remove it"),
        ("<worldbody/><tendon><fixde/></tendon>", "<fixde", "element `<fixde>`", "did you mean `<fixed>`?"),
        (
            "<worldbody/><actuator><moter joint='j'/></actuator>",
            "<moter",
            "element `<moter>`",
            "did you mean `<motor>`?",
        ),
    ] {
        let column = inside.find(at).expect("it stands there") + 1;
        let answer = import_as_text(&mjcf_options(), &format!("<mujoco>\n{inside}\n</mujoco>"));
        let expected = format!("r.xml:2:{column}: unknown {message}");
        assert!(answer.starts_with(&expected) && answer.contains(help), "{inside}\n{answer}");
        assert_eq!(answer.matches("r.xml:").count(), 1, "{answer}");
    }
}

#[test]
fn duplicate_mjcf_names_are_rejected() {
    for (inside, message) in [
        (
            "<worldbody><site name='s'/><frame><site name='s'/></frame></worldbody>",
            "second site with the name `s`",
        ),
        (
            "<worldbody><geom name='s' size='1'/><geom name='s' size='1'/></worldbody>",
            "second geom with the name `s`",
        ),
        ("<worldbody><body name='s'/><body name='s'/></worldbody>", "second body with the name `s`"),
        (
            "<worldbody><body><joint name='j'/></body></worldbody><actuator><motor name='m' joint='j'/>\
             <position name='m' joint='j'/></actuator>",
            "second actuator with the name `m`",
        ),
        (
            "<worldbody><body><joint name='j'/></body></worldbody><equality><joint name='m' joint1='j'/>\
             <joint name='m' joint1='j'/></equality>",
            "second equality with the name `m`",
        ),
    ] {
        let answer = import_as_text(&mjcf_options(), &format!("<mujoco>{inside}</mujoco>"));
        assert!(answer.contains(message), "{inside}\n{answer}");
    }
}
