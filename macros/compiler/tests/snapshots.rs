//! Generated code of small mechanisms, for reviewing changes of the compiler. A difference is not an error in
//! itself: review it, and regenerate the files with
//! `LINKWORK_WRITE=1 cargo test -p linkwork-compiler --test snapshots`.

mod generated;

use linkwork_compiler::expand;
use proc_macro2::TokenTree;
use quote::ToTokens;
use std::fs;
use std::path::Path;

const PENDULUM: &str = "m: f64, l: f64,
    #[particle(mass = m)] bob: Particle,
    #[joint(ground -> bob.at(-l * y), about = z)] hinge: Pin,";

const CART_POLE: &str = "
    #[body(mass = 1)] cart: Body,
    #[body(mass = 0.2, com = 0.3 * y, inertia = rod(0.2, 0.6, y))] pole: Body,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[joint(cart -> pole, about = z)] hinge: Pin,
    #[acts(on = rail)] push: Force,";

/// Test mechanism with joints of every coordinate chart, a limit, a contact, and outputs that depend on the
/// motion.
const BUOY: &str = "k: f64,
    #[body(mass = 2, inertia = sphere(2, 0.3))] hull: Body,
    #[body(mass = 1, inertia = sphere(1, 0.2))] eye: Body,
    #[body(mass = 1)] cart: Body,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[joint(ground -> hull)] flight: Free,
    #[joint(hull -> eye)] socket: Ball,
    #[limit(on = rail, from = -1, to = k)] stop: Limit,
    #[contact(hull.sphere(0.3), ground.plane(y), friction = 0.3)] floor: Contact,
    #[acts(on = rail)] motor: Force,
    #[output(contact_force(floor))] push: Vector,
    #[output(hull, resolved_in = ground)] diagram: FreeBody,";

/// Test mechanism: a rod whose end slides on the ground.
const SLIDING: &str = "friction: f64,
    #[body(mass = 2, inertia = rod(2, 1, x))] rod: Body,
    #[joint(ground -> rod, about = z)] pose: Planar,
    #[constraint(slips(rod.at(-0.5 * x).sphere(0.01), ground.plane(y)), friction = friction, speed = 0.001)]
    floor: Slipping,";

/// Test mechanism with forces that depend on time, without inputs.
const DRIVEN: &str = "#[body(mass = 2, inertia = sphere(2, 0.3))] ball: Body,
    #[joint(ground -> ball, about = z)] pose: Planar,
    #[acts(on = ball, value = sin(t) * ground.x)] wind: Force,
    #[contact(ball.sphere(0.3), ground.plane(y), friction = 0.3, rolling = 0.01)] floor: Contact,
    #[limit(on = pose.x, max_speed = 3)] stop: Limit,
    #[limit(on = pose.angle, from = -1)] bound: Limit,
    #[output(reaction_force(pose))] load: Vector,
    #[output(contact_force(floor))] push: Vector,
    #[output(ball, resolved_in = ground)] diagram: FreeBody,";

/// Test mechanism: a sleigh with a motor force that depends on its velocity.
const GOVERNED: &str = "command: Input,
    #[body(mass = 2, inertia = diagonal(0.3, 0.4, 0.5))] sleigh: Body,
    #[joint(ground -> sleigh, about = z)] pose: Planar,
    #[acts(on = pose.x, value = command * rate(pose.x) + sin(t))] motor: Force,
    #[constraint(dot(v(sleigh.at(0.7 * x) / ground / ground), sleigh.y) = 0)] blade: Nonholonomic,
    #[output(reaction_force(pose))] load: Vector,
    #[output(sleigh)] diagram: FreeBody,";

/// Outputs of every shape, and a state of first order.
const MEASURED: &str = "command: Input, lag: f64,
    #[body(mass = 1, inertia = sphere(1, 0.2))] ball: Body,
    #[joint(ground -> ball)] pose: Free,
    #[state(rate = (command - filtered) / lag)] filtered: State,
    #[acts(on = ball, value = filtered * ground.x)] push: Force,
    #[output(filtered)] level: Scalar,
    #[output(r(ball / ground))] place: Vector,
    #[output(rotation(ball / ground))] turn: Matrix,
    #[output(dot(a(ball / ground / ground), ground.x))] felt: Scalar,";

/// Test mechanism with declared generalized speeds and a ball joint.
const SPEEDS: &str = "
    #[body(mass = 2)] cart: Body,
    #[body(mass = 1, com = x, inertia = rod(1, 2, x))] arm: Body,
    #[body(mass = 1, inertia = sphere(1, 0.2))] ball: Body,
    #[joint(ground -> ball)] socket: Ball,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[joint(cart -> arm, about = z)] hinge: Pin,
    #[speed(rate(rail) * cos(hinge) + 0.3 * rate(hinge))] along: Speed,
    #[speed(1.5 * rate(hinge) - rate(rail) * sin(hinge))] turn: Speed,";

/// Name, arguments of the attribute, fields, and the functions to show: with their bodies, or of traits
/// (`Trait::*`). Trait functions that only call the function of the same name are omitted.
const MECHANISMS: [(&str, &str, &str, &[&str]); 15] = [
    (
        "pendulum",
        "gravity = -9.81 * y",
        PENDULUM,
        &[
            "EQUATIONS",
            "mass_matrix",
            "bias_forces",
            "inverse_dynamics",
            "forward_dynamics",
            "kinetic_energy",
        ],
    ),
    (
        "closed",
        "gravity = -9.81 * y",
        "#[body(mass = 1, com = x / 2, inertia = rod(1, 1, x))] crank: Body,
        #[body(mass = 2, com = x, inertia = rod(2, 2, x))] coupler: Body,
        #[body(mass = 2, com = x, inertia = rod(2, 2, x))] rocker: Body,
        #[joint(ground -> crank, about = z)] input: Pin,
        #[joint(crank.at(x) -> coupler, about = z)] middle: Pin,
        #[joint(ground.at(2 * x) -> rocker, about = z)] output: Pin,
        #[joint(coupler.at(2 * x) -> rocker.at(2 * x), about = z)] last: Pin,",
        &[
            "constraint_residuals",
            "constraint_jacobian",
            "forward_dynamics",
            "constrained_dynamics",
            "__constrained_dynamics",
        ],
    ),
    (
        "independent",
        "gravity = -9.81 * y, formulation = speeds, batch",
        "#[particle(mass = 2)] bead: Particle,
        #[joint(ground -> bead, along = (x, y))] plane: Stage,
        #[constraint(plane.y = 0.3 * plane.x * plane.x)] wire: Holonomic,",
        &["forward_dynamics", "constrained_dynamics", "__constrained_dynamics", "forward_dynamics_lanes"],
    ),
    (
        "limbs",
        "gravity = -9.81 * y",
        "#[body(mass = 1)] cart: Body,
        #[body(mass = 0.2, com = 0.3 * y, inertia = rod(0.2, 0.6, y))] left: Body,
        #[body(mass = 0.2, com = 0.3 * y, inertia = rod(0.2, 0.6, y))] right: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(cart.at(-x) -> left, about = z)] first: Pin,
        #[joint(cart.at(x) -> right, about = z)] second: Pin,",
        &["mass_matrix", "bias_forces", "inverse_dynamics", "forward_dynamics"],
    ),
    (
        "prepare",
        "gravity = -9.81 * y, prepare",
        PENDULUM,
        &["prepare", "__prepared_numbers", "inverse_dynamics", "forward_dynamics"],
    ),
    ("batch", "gravity = -9.81 * y, batch", CART_POLE, &["forward_dynamics", "forward_dynamics_lanes"]),
    (
        "derivatives",
        "gravity = -9.81 * y, derivatives",
        CART_POLE,
        &["mass_matrix_inverse", "inverse_dynamics_derivatives", "forward_dynamics_derivatives", "linearize"],
    ),
    (
        "charts",
        "gravity = -9.81 * y, derivatives, second_derivatives",
        BUOY,
        &[
            "neutral",
            "diagram",
            "diagram_under",
            "push",
            "integrate",
            "difference",
            "tangent_rate",
            "__carry",
            "integrate_derivatives",
            "tangent_rate_derivatives",
            "__tangent_rate_second_derivatives",
            "generalized_forces_derivatives",
            "forward_dynamics_second_derivatives",
            "validate",
            "__Steps::*",
            "Limits::*",
            "Mechanism::*",
            "Derivatives::*",
            "SecondDerivatives::*",
            "Contacts::*",
            "ContactDerivatives::*",
            "Frames::*",
        ],
    ),
    (
        "slipping",
        "gravity = -9.81 * y, derivatives, batch",
        SLIDING,
        &[
            "constrained_dynamics",
            "try_constrained_dynamics",
            "forward_dynamics",
            "forward_dynamics_lanes",
            "generalized_forces",
            "Mechanism::*",
            "Derivatives::*",
            "Constraints::*",
        ],
    ),
    (
        "driven",
        "gravity = -9.81 * y",
        DRIVEN,
        &[
            "load",
            "__reaction_load",
            "push",
            "__touched_push",
            "diagram",
            "__reaction_diagram",
            "diagram_under",
            "Limits::*",
            "Contacts::*",
        ],
    ),
    (
        "governed",
        "gravity = -9.81 * y, batch",
        GOVERNED,
        &["load", "diagram", "forward_dynamics_lanes", "Mechanism::*"],
    ),
    (
        "measured",
        "gravity = -9.81 * y, derivatives",
        MEASURED,
        &[
            "Outputs::*",
            "OutputDerivatives::*",
            "OutputsByStates::*",
            "Sensitivities::*",
            "FirstOrder::*",
            "FirstOrderDerivatives::*",
        ],
    ),
    (
        "speeds",
        "gravity = -9.81 * y, derivatives, second_derivatives",
        SPEEDS,
        &[
            "integrate",
            "difference",
            "tangent_rate",
            "displacement_rate",
            "integrate_derivatives",
            "Mechanism::*",
            "Derivatives::*",
            "SecondDerivatives::*",
        ],
    ),
    (
        "file",
        "urdf = \"../../models/urdf/double_pendulum.urdf\", parameters = [inertial, placement], regressor",
        "",
        &["from_file", "inertials", "set_inertials", "set_base_parameters", "Identifiable::*"],
    ),
    (
        "f32",
        "gravity = -9.81 * y, scalar = f32",
        // Values that follow from these coefficients are subnormal or zero in `f32`.
        "#[particle(mass = 1e-20)] bob: Particle,
        #[joint(ground -> bob.at(-1e-10 * y), about = z)] hinge: Pin,",
        &["mass_matrix", "kinetic_energy"],
    ),
];

/// Returns true for the function of a trait that only calls the inherent function of the same name.
fn is_forwarding_function(function: &syn::ImplItemFn) -> bool {
    let body = function.block.to_token_stream().to_string();
    body.starts_with(&format!("{{ Self :: {} (", function.sig.ident))
}

/// Returns the generated code without documentation, frames, and functions that only report that a feature is
/// absent.
fn generated_code_of_functions(text: &str, functions: &[&str]) -> String {
    let mut file = syn::parse_file(text).unwrap();
    file.items = generated::items_of_generated_code(file.clone());
    file.items.retain_mut(|item| {
        let syn::Item::Impl(block) = item else { return false };
        let clause = block.generics.where_clause.to_token_stream().to_string();
        let of = block.trait_.as_ref().and_then(|t| Some(t.0.segments.last()?.ident.to_string()));
        let asked = of.as_ref().is_some_and(|of| functions.contains(&format!("{of}::*").as_str()));
        let large = of.as_deref() == Some("Evaluate") && !functions.iter().any(|name| name.ends_with("::*"));
        if clause.contains("absent") || !(of.is_none() || asked || large) {
            return false;
        }
        block.attrs.clear();
        let inherent = of.is_none();
        block.items.retain_mut(|member| {
            let attributes = match member {
                syn::ImplItem::Fn(f) => {
                    let name = f.sig.ident.to_string();
                    if inherent && !functions.contains(&name.as_str()) || asked && is_forwarding_function(f) {
                        return false;
                    }
                    &mut f.attrs
                }
                syn::ImplItem::Const(c) if inherent && c.ident == "EQUATIONS" && functions.is_empty() => {
                    &mut c.attrs
                }
                syn::ImplItem::Const(c) if asked => &mut c.attrs,
                syn::ImplItem::Type(_) => return true,
                _ => return false,
            };
            attributes.retain(|attribute| !attribute.path().is_ident("doc"));
            true
        });
        !block.items.is_empty()
    });
    prettyplease::unparse(&file)
        .replace("::linkwork::nalgebra::", "na::")
        .replace("::linkwork::__private::", "private::")
}

/// Compares a text with a file of this folder, or writes the file. Returns the first difference.
fn snapshot_difference(name: &str, text: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots").join(format!("{name}.txt"));
    if std::env::var_os("LINKWORK_WRITE").is_some() {
        fs::write(&path, text).unwrap();
    }
    let expected = fs::read_to_string(&path).unwrap_or_default();
    let lines = text.lines().count().max(expected.lines().count());
    let repeat_line_endlessly = |text: &'static str| std::iter::repeat(text);
    let both = text
        .lines()
        .chain(repeat_line_endlessly("(no more)"))
        .zip(expected.lines().chain(repeat_line_endlessly("(no more)")));
    let (k, (now, before)) = both.take(lines).enumerate().find(|(_, (now, before))| now != before)?;
    Some(format!("{name}.txt, line {}:\n  before: {before}\n  now:    {now}", k + 1))
}

/// Defines one snapshot test of generated code for each named mechanism.
macro_rules! snapshots {
    ($($name:ident)+) => {
        const TESTS: &[&str] = &[$(stringify!($name)),+];

        $(#[test]
        fn $name() {
            assert_equals_snapshot(stringify!($name));
        })+
    };
}

snapshots!(pendulum closed independent limbs prepare batch derivatives charts slipping driven governed measured speeds file f32);

fn assert_equals_snapshot(name: &str) {
    let of = MECHANISMS.iter().find(|(known, ..)| *known == name);
    let (_, attribute, fields, functions) = of.expect("a mechanism of this name");
    let item = format!("pub struct Shown {{ {fields} }}").parse().unwrap();
    let emitted = expand(attribute.parse().unwrap(), item, Path::new(""));
    assert!(!emitted.tokens.to_string().contains("compile_error"), "{name}: {}", emitted.tokens);
    assert_eq!(
        snapshot_difference(name, &generated_code_of_functions(&emitted.text, functions)),
        None,
        "generated code differs; with `LINKWORK_WRITE=1` it is written anew"
    );
}

#[test]
fn every_snapshot_mechanism_has_a_test() {
    assert!(MECHANISMS.iter().map(|(name, ..)| *name).eq(TESTS.iter().copied()));
}

/// Mechanisms whose documentation comments cover all sections together.
const DOCUMENTED: [(&str, &str); 7] = [
    ("gravity = -9.81 * y", "#[body(mass = 1)] arm: Body, #[joint(ground -> arm)] held: Weld,"),
    ("gravity = -9.81 * y", DRIVEN),
    ("gravity = -9.81 * y, equations = structure, batch, conserved", BUOY),
    ("gravity = -9.81 * y, batch", SLIDING),
    ("gravity = -9.81 * y, second_derivatives, conserved, equations = hamilton", CART_POLE),
    ("equations = kane", GOVERNED),
    (
        "inertia = none",
        "#[body] arm: Body,
        #[joint(ground -> arm, about = z)] hinge: Pin,
        #[limit(on = hinge, from = -2, max_speed = 3)] stop: Limit,",
    ),
];

#[test]
fn struct_documentation_equals_the_snapshot() {
    let mut text = String::new();
    for (attribute, fields) in DOCUMENTED {
        let item = format!("pub struct Shown {{ {fields} }}").parse().unwrap();
        let emitted = expand(attribute.parse().unwrap(), item, Path::new(""));
        assert!(!emitted.tokens.to_string().contains("compile_error"), "{}", emitted.tokens);
        let file: syn::File = syn::parse2(emitted.into_tokens().unwrap()).unwrap();
        let attributes = file.items.iter().find_map(|item| match item {
            syn::Item::Struct(item) if item.ident == "Shown" => Some(&item.attrs),
            _ => None,
        });
        text += &format!("##### {attribute}\n");
        // Always present, or `cfg_attr(doc, doc = …)` on documentation pages, or in editors.
        for attribute in attributes.unwrap() {
            let tokens = attribute.meta.to_token_stream().into_iter().flat_map(|token| match token {
                TokenTree::Group(group) => group.stream().into_iter().collect(),
                token => vec![token],
            });
            let literals = tokens.filter_map(|token| syn::parse2::<syn::LitStr>(token.into()).ok());
            // Typeset equations appear only on documentation pages.
            let lines = literals.map(|line| line.value()).filter(|line| !line.contains("<math>"));
            lines.for_each(|line| text += &format!("{line}\n"));
        }
    }
    assert_eq!(snapshot_difference("documentation", &text), None, "documentation differs");
}
