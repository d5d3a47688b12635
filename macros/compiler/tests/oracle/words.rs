//! Writer of random test mechanisms as source text.

use crate::spec::{Body, Element, End, Friction, Kind, Law, Path, Place, Spec};
use std::fmt::Write;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Returns the source text of a random mechanism: arguments of the attribute, and the struct.
pub fn mechanism_source(spec: &Spec, name: &str, requests: &str) -> (String, String) {
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

fn placement_text(name: &str, place: &Place) -> String {
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
        Kind::Pin | Kind::Collar => format!(", about = {a}"),
        Kind::Sleeve => format!(", along = {a}"),
        Kind::Screw => format!(", about = {a}, pitch = {:?}", body.pitch),
        Kind::Slot => format!(", along = {a}, about = {b}"),
        Kind::Universal => ", about = (x, y)".to_string(),
        Kind::Planar => ", along = (x, y)".to_string(),
        Kind::Stage => ", along = (x, y, z)".to_string(),
        Kind::Ball | Kind::Free | Kind::Weld => String::new(),
    }
}

pub fn end_text(end: &End) -> String {
    format!("{}.at({:?})", body_name(end.body), end.at)
}

fn write_element(k: usize, element: &Element, bodies: &[Body], out: &mut String) {
    let _ = match element {
        Element::Between(law, a, b) => {
            let (words, kind) = force_law_source_text(*law, "free_length");
            writeln!(
                out,
                "#[acts(between = ({}, {}), {words})] element{k}: {kind},",
                end_text(a),
                end_text(b)
            )
        }
        Element::Along(law, path) => {
            let (words, kind) = force_law_source_text(*law, "free_length");
            writeln!(out, "#[acts(on = {}, {words})] element{k}: {kind},", force_path_source_text(path))
        }
        Element::On(law, body, coordinate) => {
            let kind = bodies[*body].kind;
            let which = kind.coordinate_names()[*coordinate];
            let is_angle = matches!(which, ".turn" | ".first" | ".second" | ".angle")
                || matches!(kind, Kind::Pin | Kind::Screw);
            let free = if is_angle { "free_angle" } else { "free_length" };
            let (words, kind) = force_law_source_text(*law, free);
            writeln!(out, "#[acts(on = joint{body}{which}, {words})] element{k}: {kind},")
        }
        Element::Push(end, [x, y, z]) => writeln!(
            out,
            "#[acts(on = {}, value = ({x:?}) * ground.x + ({y:?}) * ground.y + ({z:?}) * ground.z)] \
             element{k}: Force,",
            end_text(end)
        ),
        Element::Twist(body, [x, y, z]) => writeln!(
            out,
            "#[acts(on = body{body}, value = ({x:?}) * ground.x + ({y:?}) * ground.y + ({z:?}) * ground.z)] \
             element{k}: Torque,"
        ),
        Element::Follow(end, [x, y, z]) => {
            let b = body_name(end.body);
            writeln!(
                out,
                "#[acts(on = {}, value = ({x:?}) * {b}.x + ({y:?}) * {b}.y + ({z:?}) * {b}.z)] element{k}: \
                 Force,",
                end_text(end)
            )
        }
    };
}

fn force_path_source_text(path: &Path) -> String {
    match path {
        Path::Rope([a, b, c]) => {
            format!("norm(r({0} / {1})) + norm(r({1} / {2}))", end_text(a), end_text(b), end_text(c))
        }
        Path::Cable { ends: [a, b], around, radius, axis } => {
            let surface = match axis {
                None => format!("sphere({radius:?})"),
                Some(axis) => format!("cylinder({radius:?}, unit({axis:?}))"),
            };
            format!("cable({} / {}, {}.{surface})", end_text(a), end_text(b), end_text(around))
        }
    }
}

fn force_law_source_text(law: Law, free: &str) -> (String, &'static str) {
    match law {
        Law::Spring(k, free_value) => (format!("stiffness = {k:?}, {free} = {free_value:?}"), "Spring"),
        Law::Dashpot(c) => (format!("damping = {c:?}"), "Dashpot"),
        Law::Inerter(b) => (format!("inertance = {b:?}"), "Inerter"),
        Law::Attraction(k) => (format!("strength = {k:?}"), "Attraction"),
        Law::Friction(Friction { coulomb, stiction, stribeck_speed, viscous, speed }) => (
            format!(
                "coulomb = {coulomb:?}, stiction = {stiction:?}, stribeck_speed = {stribeck_speed:?}, \
                 viscous = {viscous:?}, speed = {speed:?}"
            ),
            "Friction",
        ),
    }
}
