//! Tests of the model: compare the model of a mechanism, or the errors, as text.

mod solids;
mod surfaces;

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::eval::eval_one;
use linkwork_compiler::expr::{Expr, Graph, Mat3, Vec3};
use linkwork_compiler::mechanism::{Coordinate, Link, LinkId, Model, Motion, Pose, Quantity};
use linkwork_compiler::resolve::build_model;
use linkwork_compiler::syntax::{FileFormat, FileOptions, Name};
use linkwork_compiler::{import, parse_source_and_import};
use std::path::Path;

/// Compares the model of a mechanism with these fields; indentation is ignored.
fn check_model(fields: &str, expected: &str) {
    assert_same_trimmed_lines(&model_text_or_messages(fields, None), expected);
}

/// Compares the model of a URDF file with these contents of `<robot>`; indentation is ignored.
fn check_urdf(inside: &str, expected: &str) {
    assert_same_trimmed_lines(
        &model_text_or_messages("", Some(&format!("<robot name=\"r\">{inside}</robot>"))),
        expected,
    );
}

fn assert_same_trimmed_lines(actual: &str, expected: &str) {
    let trimmed_lines = |text: &str| -> Vec<String> {
        text.lines().map(|line| line.trim().to_string()).filter(|line| !line.is_empty()).collect()
    };
    assert!(trimmed_lines(actual) == trimmed_lines(expected), "expected\n{expected}\nfound\n{actual}");
}

fn model_text_or_messages(fields: &str, urdf: Option<&str>) -> String {
    let mut cx = Diagnostics::new();
    let item = format!("struct S {{ {fields} }}").parse().unwrap();
    let Some(mut source) = parse_source_and_import("".parse().unwrap(), item, Path::new(""), &mut cx) else {
        return cx.full_message_texts().join("\n");
    };
    if let Some(text) = urdf {
        let place = source.mechanism.description.name.place.clone();
        let path = Name { text: "r.urdf".to_string(), place };
        let options = FileOptions::default_options_of_file(FileFormat::Urdf, path);
        if let Some(imported) = import::import_file(text, Path::new(""), &options, &mut cx) {
            source.mechanism.description.bodies = imported.bodies;
            source.mechanism.description.joints = imported.joints;
        }
    }
    let graph = Graph::new();
    let model =
        if cx.is_empty() { build_model(&source.mechanism.description, &graph, &mut cx) } else { None };
    match model {
        Some(model) => model_text(&model),
        None => cx.full_message_texts().join("\n"),
    }
}

fn model_text(model: &Model<'_>) -> String {
    let mut text = format!("q: {}\n", model.configuration.join(" "));
    let velocities: Vec<&str> = model.velocities.iter().map(|(name, _)| name.as_str()).collect();
    if velocities != model.configuration {
        text += &format!("v: {}\n", velocities.join(" "));
    }
    let inputs: Vec<&str> = model.inputs.iter().map(|(name, _)| name.as_str()).collect();
    if !inputs.is_empty() {
        text += &format!("u: {}\n", inputs.join(" "));
    }
    for (k, link) in model.links.iter().enumerate() {
        text += &format!("link {k} on {}{}\n", link_text(link.parent), link_motion_text(link, model));
    }
    for frame in &model.frames {
        text += &format!("frame {} on {}{}\n", frame.name, link_text(frame.link), pose_text(&frame.pose));
    }
    text
}

fn link_text(link: Option<LinkId>) -> String {
    link.map_or("ground".to_string(), |link| link.0.to_string())
}

fn link_motion_text(link: &Link<'_>, model: &Model<'_>) -> String {
    let coordinate_text = |c: &Coordinate| {
        let name = &model.configuration[c.q.0];
        match (c.ratio, c.offset) {
            (1.0, 0.0) => name.clone(),
            (ratio, offset) => format!("{ratio} {name} + {offset}"),
        }
    };
    let how = match &link.motion {
        Motion::Turn { axis, coordinate } => {
            format!("turns about {} by {}", vector_text(*axis), coordinate_text(coordinate))
        }
        Motion::Slide { axis, coordinate } => {
            format!("slides along {} by {}", vector_text(*axis), coordinate_text(coordinate))
        }
        Motion::Helix { axis, pitch, coordinate } => {
            format!(
                "turns about {} by {} with pitch {}",
                vector_text(*axis),
                coordinate_text(coordinate),
                number_text(value_of_expression(*pitch))
            )
        }
        Motion::Ball { q, v } => format!("turns freely by q{q}, v{v}"),
        Motion::Free { q, v } => format!("moves freely by q{q}, v{v}"),
        _ => "moves otherwise".to_string(),
    };
    let i = &link.inertia;
    let mut text = format!("{} {how}", pose_text(&link.placement));
    if !i.mass.is_zero() {
        text +=
            &format!("; mass {}, moment {}", number_text(value_of_expression(i.mass)), vector_text(i.moment));
    }
    if i.tensor.diagonal.iter().any(|d| !d.is_zero()) {
        text += &format!(", inertia {}", matrix_text(&i.tensor.full_matrix()));
    }
    text
}

/// Returns the position and axes of a pose as text, without identity parts.
fn pose_text(pose: &Pose<'_>) -> String {
    let mut text = String::new();
    if !pose.translation.is_zero() {
        text += &format!(" at {}", vector_text(pose.translation));
    }
    if !pose.rotation.is_identity() {
        text += &format!(" rotated {}", matrix_text(&pose.rotation.rotation_matrix()));
    }
    text
}

/// Evaluates an expression. The parameters have the values 2, 3, 4, …
fn value_of_expression(e: Expr<'_>) -> f64 {
    eval_one(e, &|symbol| match Quantity::from_symbol(symbol) {
        Quantity::Parameter(k) => k as f64 + 2.0,
        other => unreachable!("{other:?} in a model of numbers"),
    })
}

fn number_text(x: f64) -> String {
    let rounded = (x * 1e6).round() / 1e6;
    (rounded + 0.0).to_string()
}

fn vector_text(v: Vec3<'_>) -> String {
    format!("[{}]", v.0.map(|c| number_text(value_of_expression(c))).join(", "))
}

fn matrix_text(m: &Mat3<'_>) -> String {
    format!("[{}]", m.0.map(|row| vector_text(Vec3(row))).join(", "))
}

const BODY: &str = "#[body(mass = 1, inertia = sphere(1, 1))]";

#[test]
fn coordinates_are_named_by_joint_in_declaration_order() {
    let joints = [
        ("Pin", "about = z", "j", ""),
        ("Sleeve", "along = x", "j", ""),
        ("Screw", "about = z, pitch = 1", "j", ""),
        ("Collar", "about = z", "j.slide j.turn", ""),
        ("Slot", "along = x, about = z", "j.slide j.turn", ""),
        ("Universal", "about = (x, y)", "j.first j.second", ""),
        ("Planar", "about = z", "j.x j.y j.angle", ""),
        ("Stage", "along = (y, z)", "j.x j.y", ""),
        ("Stage", "along = (y, z, x)", "j.x j.y j.z", ""),
        ("Ball", "", "j.qx j.qy j.qz j.qw", "j.wx j.wy j.wz"),
        ("Free", "", "j.x j.y j.z j.qx j.qy j.qz j.qw", "j.vx j.vy j.vz j.wx j.wy j.wz"),
        ("Weld", "", "", ""),
    ];
    for (kind, axes, q, v) in joints {
        let fields = format!("{BODY} b: Body, #[joint(ground -> b, {axes})] j: {kind},");
        let expected =
            if v.is_empty() { vec![format!("q: {q}")] } else { vec![format!("q: {q}"), format!("v: {v}")] };
        let found = model_text_or_messages(&fields, None);
        let names: Vec<&str> = found.lines().take(expected.len()).map(str::trim).collect();
        assert_eq!(names, expected.iter().map(|line| line.trim()).collect::<Vec<_>>(), "{kind}: {found}");
    }
    // Joints are in the order of their declaration, links from the ground outwards.
    check_model(
        "#[body(mass = 1)] b: Body, #[body(mass = 1)] a: Body,
        #[joint(a -> b, along = y)] second: Sleeve,
        #[joint(ground -> a, along = x)] first: Sleeve,
        #[acts(on = second)] push: Force,
        #[acts(on = first)] pull: Force,",
        "q: second first
        u: push pull
        link 0 on ground slides along [1, 0, 0] by first; mass 1, moment [0, 0, 0]
        link 1 on 0 slides along [0, 1, 0] by second; mass 1, moment [0, 0, 0]
        frame b on 1
        frame a on 0",
    );
}

#[test]
fn welded_bodies_become_one_link() {
    check_model(
        "#[body(mass = 1)] a: Body,
        #[body(mass = 2, com = x)] b: Body,
        #[particle(mass = 3, at = b.at(z))] p: Particle,
        #[body(mass = 7)] post: Body,
        #[joint(ground -> a, along = x)] rail: Sleeve,
        #[joint(a.at(y).rotated(z(pi / 2)) -> b)] bolt: Weld,
        #[joint(ground.at(2 * x) -> post)] footing: Weld,",
        "q: rail
        link 0 on ground slides along [1, 0, 0] by rail; mass 6, moment [0, 7, 3], inertia [[14, 0, 0], [0, 3, -3], [0, -3, 11]]
        frame a on 0
        frame b on 0 at [0, 1, 0] rotated [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
        frame post on ground at [2, 0, 0]
        frame p on 0 at [0, 1, 1] rotated [[0, -1, 0], [1, 0, 0], [0, 0, 1]]",
    );
}

#[test]
fn joint_ends_are_placed_and_rotated() {
    // Both ends of the joint have the same frame, so the body's end coincides with the other end.
    check_model(
        "l: f64,
        #[body(mass = 1)] b: Body,
        #[joint(ground.at(l * x).rotated(x(pi / 2)) -> b.at(l * y), along = y)] rail: Sleeve,",
        "q: rail
        link 0 on ground at [2, 0, 0] rotated [[1, 0, 0], [0, 0, -1], [0, 1, 0]] slides along [0, 1, 0] by rail; mass 1, moment [0, -2, 0], inertia [[4, 0, 0], [0, 0, 0], [0, 0, 4]]
        frame b on 0 at [0, -2, 0]",
    );
    check_model(
        "#[body(mass = 1, com = x)] b: Body,
        #[joint(ground -> b.rotated(z(pi / 2)), about = z)] pin: Pin,",
        "q: pin
        link 0 on ground turns about [0, 0, 1] by pin; mass 1, moment [0, -1, 0], inertia [[1, 0, 0], [0, 0, 0], [0, 0, 1]]
        frame b on 0 rotated [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]",
    );
    // Rotations about successive axes in order; a rotation about a direction by an angle; a matrix by rows.
    for rotations in [
        "x(pi / 2), z(pi / 2)",
        "eigenaxis(x, pi / 2), eigenaxis(z, pi / 2)",
        "[[0, -1, 0], [0, 0, -1], [1, 0, 0]]",
    ] {
        check_model(
            &format!("#[body(mass = 1)] b: Body, \
                      #[joint(ground.rotated({rotations}) -> b, along = x)] j: Sleeve,"),
            "q: j
            link 0 on ground rotated [[0, -1, 0], [0, 0, -1], [1, 0, 0]] slides along [1, 0, 0] by j; mass 1, moment [0, 0, 0]
            frame b on 0",
        );
    }
}

#[test]
fn constant_joint_axes_are_aligned_with_coordinate_axes() {
    // The frame of the body does not change: the rotation of the link's frame is compensated.
    check_model(
        "#[body(mass = 1, com = x)] b: Body, #[joint(ground -> b, about = [0.6, 0, 0.8])] pin: Pin,",
        "q: pin
        link 0 on ground rotated [[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]] turns about [0, 0, 1] by pin; mass 1, moment [0.8, 0, 0.6], inertia [[0.36, 0, -0.48], [0, 1, 0], [-0.48, 0, 0.64]]
        frame b on 0 rotated [[0.8, 0, -0.6], [0, 1, 0], [0.6, 0, 0.8]]",
    );
    check_model(
        "#[body(mass = 1, com = x)] b: Body, #[joint(ground -> b, about = -z)] pin: Pin,",
        "q: pin
        link 0 on ground turns about [0, 0, -1] by pin; mass 1, moment [1, 0, 0], inertia [[0, 0, 0], [0, 1, 0], [0, 0, 1]]
        frame b on 0",
    );
    // An axis that depends on parameters is not transformed, and neither is the axis of a sliding joint.
    check_model(
        "a: f64, #[body(mass = 1, com = z)] b: Body, \
         #[joint(ground -> b, about = cos(a) * x + sin(a) * y)] pin: Pin,",
        "q: pin
        link 0 on ground turns about [-0.416147, 0.909297, 0] by pin; mass 1, moment [0, 0, 1], inertia [[1, 0, 0], [0, 1, 0], [0, 0, 0]]
        frame b on 0",
    );
    check_model(
        "#[body(mass = 1)] b: Body, #[joint(ground -> b, along = unit(3 * x + 4 * y))] rail: Sleeve,",
        "q: rail
        link 0 on ground slides along [0.6, 0.8, 0] by rail; mass 1, moment [0, 0, 0]
        frame b on 0",
    );
}

#[test]
fn multi_coordinate_joints_become_chains() {
    check_model(
        &format!("{BODY} b: Body, #[joint(ground -> b, about = (z, x))] j: Universal,"),
        "q: j.first j.second
        link 0 on ground turns about [0, 0, 1] by j.first
        link 1 on 0 turns about [1, 0, 0] by j.second; mass 1, moment [0, 0, 0], inertia [[0.4, 0, 0], [0, 0.4, 0], [0, 0, 0.4]]
        frame b on 1",
    );
    check_model(
        "#[body(mass = 1)] b: Body, #[particle(mass = 1)] p: Particle,
        #[joint(ground -> b, along = (x, y))] table: Stage,
        #[joint(b.at(z) -> p, along = z)] lift: Sleeve,",
        "q: table.x table.y lift
        link 0 on ground slides along [1, 0, 0] by table.x
        link 1 on 0 slides along [0, 1, 0] by table.y; mass 1, moment [0, 0, 0]
        link 2 on 1 at [0, 0, 1] slides along [0, 0, 1] by lift; mass 1, moment [0, 0, 0]
        frame b on 1
        frame p on 2",
    );
    check_model(
        "#[body(mass = 1, com = x, inertia = sphere(1, 0))] nut: Body, \
         #[joint(ground -> nut, about = x, lead = 2 * pi)] j: Screw,",
        "q: j
        link 0 on ground turns about [1, 0, 0] by j with pitch 1; mass 1, moment [1, 0, 0], inertia [[0, 0, 0], [0, 1, 0], [0, 0, 1]]
        frame nut on 0",
    );
}

#[test]
fn followers_share_the_coordinate_of_their_leader() {
    let link_element = |name: &str| {
        format!(
            "<link name='{name}'><inertial><mass value='1'/>\
             <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
        )
    };
    let joint_element = |name: &str, kind: &str, parent: &str, child: &str, more: &str| {
        format!(
            "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>\
             <axis xyz='0 0 1'/>{more}</joint>"
        )
    };
    let text = link_element("base")
        + &link_element("a")
        + &link_element("b")
        + &link_element("c")
        + &joint_element(
            "a_joint",
            "revolute",
            "base",
            "a",
            "<mimic joint='c_joint' multiplier='-2' offset='0.5'/>",
        )
        + &joint_element("b_joint", "prismatic", "base", "b", "<mimic joint='a_joint' multiplier='3'/>")
        + &joint_element("c_joint", "revolute", "base", "c", "");
    check_urdf(
        &text,
        "q: c_joint
        link 0 on ground turns about [0, 0, 1] by -2 c_joint + 0.5; mass 1, moment [0, 0, 0], inertia [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        link 1 on ground slides along [0, 0, 1] by -6 c_joint + 1.5; mass 1, moment [0, 0, 0], inertia [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        link 2 on ground turns about [0, 0, 1] by c_joint; mass 1, moment [0, 0, 0], inertia [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        frame base on ground
        frame a on 0
        frame b on 1
        frame c on 2",
    );
}

#[test]
fn link_with_inertia_must_have_mass() {
    let robot_with_joint_type = |kind: &str| {
        format!(
            "<link name='a'><inertial><mass value='0'/>
             <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>
             <link name='b'/><joint name='j' type='{kind}'><parent link='b'/><child link='a'/></joint>"
        )
    };
    check_urdf(
        &robot_with_joint_type("revolute"),
        "r.urdf:2:14: `a` has an inertia and no mass
         = help: no real body has an inertia without mass: give it a mass, or an inertia of zero
         = help: correct the file, or write `#[mechanism(urdf = \"…\", inertia = trust)]` to accept the inertia unchanged",
    );
    // Bodies that are fixed to the ground appear in no equation.
    let fixed = format!("<robot>{}</robot>", robot_with_joint_type("fixed"));
    assert!(!model_text_or_messages("", Some(&fixed)).contains("no mass"));
}

/// Checks that inconsistent moments of inertia of rounding-error magnitude, which exporters write for bodies
/// without inertia, are accepted, and that larger ones are rejected.
#[test]
fn inertia_of_rounding_magnitude_counts_as_zero() {
    let robot_with_inertia = |mass: &str, moment: &str| {
        format!(
            "<link name='a'><inertial><mass value='{mass}'/>
             <inertia ixx='0' ixy='0' ixz='0' iyy='{moment}' iyz='0' izz='0'/></inertial></link>
             <link name='b'/><joint name='j' type='JOINT'><parent link='b'/><child link='a'/></joint>"
        )
    };
    let inconsistent_inertia_message = |moment: &str| {
        format!(
            "r.urdf:2:14: the inertia of `a` is not physically consistent
             = help: its principal moments are 0, 0, {moment}: the largest exceeds the sum of the others
             = help: correct the file, or write `#[mechanism(urdf = \"…\", inertia = trust)]` to accept the inertia unchanged"
        )
    };
    for (mass, moment, real) in
        [("0", "1e-18", true), ("0", "2e-18", false), ("2", "1e-16", true), ("2", "3e-16", false)]
    {
        let text = robot_with_inertia(mass, moment);
        let moving = text.replace("JOINT", "revolute");
        match real {
            true => assert!(
                model_text_or_messages("", Some(&format!("<robot>{moving}</robot>"))).starts_with("q: j\n")
            ),
            false => check_urdf(&moving, &inconsistent_inertia_message(moment)),
        }
        // Bodies that are fixed to the ground appear in no equation.
        check_urdf(&text.replace("JOINT", "fixed"), "q:\nframe b on ground\nframe a on ground");
    }
}

#[test]
fn errors_are_reported_together_and_once() {
    check_model(
        "#[body(mass = -1)] a: Body, #[body(mass = 1, com = 2)] b: Body,
        #[joint(ground -> a, along = x + y)] first: Sleeve,
        #[joint(a -> b, about = 0 * z)] second: Pin,
        #[acts(on = second)] push: Force,",
        "this axis is not of unit length
        = help: its length is 1.4142135623730951; write `unit(…)` around it
        this axis has no direction: it is zero
        = help: write `x`, `y`, `z` or another vector of unit length
        the mass of `a` cannot be negative, but it is -1
        = help: a mass is zero or more, kg; the sign belongs to gravity
        expected a vector, found a scalar
        = help: multiply it by a direction, as in `length * y`
        this coordinate is an angle
        = help: the element that acts on it is a Torque",
    );
    // A body with a syntax error is still known to its joints.
    check_model(
        "#[body(mass = )] a: Body, #[joint(ground -> a, along = x)] rail: Sleeve,",
        "`mass` has no value\n= help: write `mass = …`",
    );
    check_model(
        "m: f64, #[body(mass = m * l)] a: Body, #[joint(ground -> a, along = x)] rail: Sleeve,",
        "unknown name `l`
        = help: expected `m`, `x`, `y`, `z` or `pi`
        = help: or declare it: `l: f64` is a parameter, `l: Coordinate` a coordinate",
    );
}

#[test]
fn two_point_elements_act_without_other_elements() {
    let plain = "#[body(mass = 1, inertia = 1)] hull: Body, #[joint(ground -> hull)] pose: Free,";
    let links = model_text_or_messages(plain, None);
    let links = links.lines().next().expect("there is a link");
    for element in [
        "stiffness = 3)] e: Spring",
        "damping = 3)] e: Dashpot",
        "inertance = 3)] e: Inerter",
        "mu = 3)] e: Gravity",
    ] {
        let found = model_text_or_messages(
            &format!("{plain} #[acts(between = (ground.at(x), hull), {element},"),
            None,
        );
        assert!(found.starts_with(links), "{element}: {found}");
    }
}
