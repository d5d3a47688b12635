//! Writer of random test mechanisms as source text.

use crate::spec::{
    AttachmentPoint, Body, ForceElement, ForceLaw, ForcePath, FrictionParameters, MechanismSpec, Placement,
    TestJointKind,
};
use std::fmt::Write;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Returns the source text of a random mechanism: arguments of the attribute, and the struct.
pub fn mechanism_source(spec: &MechanismSpec, name: &str, requests: &str) -> (String, String) {
    let mut out = String::new();
    for (k, body) in spec.bodies.iter().enumerate() {
        write_body(k, body, spec.symbolic, &mut out);
    }
    for (k, element) in spec.elements.iter().enumerate() {
        write_element(k, element, &spec.bodies, &mut out);
    }
    let arguments = format!("gravity = {:?}{requests}", spec.gravity);
    (arguments, format!("pub struct {name} {{\n{out}}}"))
}

fn write_body(k: usize, body: &Body, symbolic: bool, out: &mut String) {
    let mass = match symbolic {
        true => {
            let _ = writeln!(out, "pub mass{k}: f64,");
            format!("mass{k}")
        }
        false => format!("{:?}", body.mass),
    };
    let [a, b, c] = body.moments;
    let turned = rotation_text(&body.inertia_turns);
    let _ = writeln!(
        out,
        "#[body(mass = {mass}, com = {:?}, inertia = diagonal({a:?}, {b:?}, {c:?}){turned})] body{k}: Body,",
        body.com
    );
    let parent = body_name(body.parent);
    let _ = writeln!(
        out,
        "#[joint({} -> {}{})] joint{k}: {:?},",
        placement_text(&parent, &body.on_parent),
        placement_text(&format!("body{k}"), &body.on_child),
        joint_axes_source_text(body),
        body.kind
    );
    if let Some((mass, at)) = body.particle {
        let _ = writeln!(out, "#[particle(mass = {mass:?}, at = body{k}.at({at:?}))] particle{k}: Particle,");
    }
    if let Some(slider) = &body.slider {
        let [x, y, z] = slider.offset;
        let _ = writeln!(
            out,
            "slide{k}: Coordinate,
             #[particle(
                 mass = {:?},
                 at = body{k}.at(slide{k} * ground.x + ({x:?}) * ground.y + ({y:?}) * x + ({z:?}) * y)
             )]
             slider{k}: Particle,",
            slider.mass
        );
    }
}

fn body_name(body: Option<usize>) -> String {
    body.map_or("ground".to_string(), |k| format!("body{k}"))
}

fn placement_text(name: &str, place: &Placement) -> String {
    let at = if place.at == [0.0; 3] { String::new() } else { format!(".at({:?})", place.at) };
    format!("{name}{at}{}", rotation_text(&place.turns))
}

fn rotation_text(turns: &[(usize, f64)]) -> String {
    if turns.is_empty() {
        return String::new();
    }
    let list: Vec<String> = turns.iter().map(|(axis, angle)| format!("{}({angle:?})", AXES[*axis])).collect();
    format!(".rotated({})", list.join(", "))
}

fn joint_axes_source_text(body: &Body) -> String {
    let [a, b] = body.axes.map(|axis| format!("unit({axis:?})"));
    match body.kind {
        TestJointKind::Pin | TestJointKind::Collar => format!(", about = {a}"),
        TestJointKind::Sleeve => format!(", along = {a}"),
        TestJointKind::Screw => format!(", about = {a}, pitch = {:?}", body.pitch),
        TestJointKind::Slot => format!(", along = {a}, about = {b}"),
        TestJointKind::Universal => ", about = (x, y)".to_string(),
        TestJointKind::Planar => ", along = (x, y)".to_string(),
        TestJointKind::Stage => ", along = (x, y, z)".to_string(),
        TestJointKind::Ball | TestJointKind::Free | TestJointKind::Weld => String::new(),
    }
}

pub fn attachment_point_text(end: &AttachmentPoint) -> String {
    format!("{}.at({:?})", body_name(end.body), end.at)
}

fn write_element(k: usize, element: &ForceElement, bodies: &[Body], out: &mut String) {
    let _ = match element {
        ForceElement::Between(law, a, b) => {
            let (words, kind) = force_law_source_text(*law, "free_length");
            writeln!(
                out,
                "#[acts(between = ({}, {}), {words})] element{k}: {kind},",
                attachment_point_text(a),
                attachment_point_text(b)
            )
        }
        ForceElement::Along(law, path) => {
            let (words, kind) = force_law_source_text(*law, "free_length");
            writeln!(out, "#[acts(on = {}, {words})] element{k}: {kind},", force_path_source_text(path))
        }
        ForceElement::On(law, body, coordinate) => {
            let kind = bodies[*body].kind;
            let which = kind.suffixes_of_actuatable_coordinates()[*coordinate];
            let is_angle = matches!(which, ".turn" | ".first" | ".second" | ".angle")
                || matches!(kind, TestJointKind::Pin | TestJointKind::Screw);
            let free = if is_angle { "free_angle" } else { "free_length" };
            let (words, kind) = force_law_source_text(*law, free);
            writeln!(out, "#[acts(on = joint{body}{which}, {words})] element{k}: {kind},")
        }
        ForceElement::Push(end, [x, y, z]) => writeln!(
            out,
            "#[acts(on = {}, value = ({x:?}) * ground.x + ({y:?}) * ground.y + ({z:?}) * ground.z)] \
             element{k}: Force,",
            attachment_point_text(end)
        ),
        ForceElement::Twist(body, [x, y, z]) => writeln!(
            out,
            "#[acts(on = body{body}, value = ({x:?}) * ground.x + ({y:?}) * ground.y + ({z:?}) * ground.z)] \
             element{k}: Torque,"
        ),
        ForceElement::Follow(end, [x, y, z]) => {
            let b = body_name(end.body);
            writeln!(
                out,
                "#[acts(on = {}, value = ({x:?}) * {b}.x + ({y:?}) * {b}.y + ({z:?}) * {b}.z)] element{k}: \
                 Force,",
                attachment_point_text(end)
            )
        }
    };
}

fn force_path_source_text(path: &ForcePath) -> String {
    match path {
        ForcePath::Rope([a, b, c]) => {
            format!(
                "norm(r({0} / {1})) + norm(r({1} / {2}))",
                attachment_point_text(a),
                attachment_point_text(b),
                attachment_point_text(c)
            )
        }
        ForcePath::Cable { ends: [a, b], around, radius, axis } => {
            let surface = match axis {
                None => format!("sphere({radius:?})"),
                Some(axis) => format!("cylinder({radius:?}, unit({axis:?}))"),
            };
            format!(
                "cable({} / {}, {}.{surface})",
                attachment_point_text(a),
                attachment_point_text(b),
                attachment_point_text(around)
            )
        }
    }
}

fn force_law_source_text(law: ForceLaw, free: &str) -> (String, &'static str) {
    match law {
        ForceLaw::Spring(k, free_value) => (format!("stiffness = {k:?}, {free} = {free_value:?}"), "Spring"),
        ForceLaw::Dashpot(c) => (format!("damping = {c:?}"), "Dashpot"),
        ForceLaw::Inerter(b) => (format!("inertance = {b:?}"), "Inerter"),
        ForceLaw::Attraction(k) => (format!("strength = {k:?}"), "Attraction"),
        ForceLaw::Friction(FrictionParameters { coulomb, stiction, stribeck_speed, viscous, speed }) => (
            format!(
                "coulomb = {coulomb:?}, stiction = {stiction:?}, stribeck_speed = {stribeck_speed:?}, \
                 viscous = {viscous:?}, speed = {speed:?}"
            ),
            "Friction",
        ),
    }
}
