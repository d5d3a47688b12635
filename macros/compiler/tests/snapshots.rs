//! Generated code of small mechanisms, as a reviewer of a change of the compiler reads it. A difference is no mistake by itself:
//! look at it, and write the files anew with `LINKWORK_WRITE=1 cargo test -p linkwork-compiler --test snapshots`.

#[path = "oracle/features/chosen.rs"]
mod chosen;
mod measure;
mod mechanisms;

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

/// Joints of every chart, a limit, a contact, and outputs that follow from the motion.
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

/// A rod whose end slips on the ground.
const SLIDING: &str = "friction: f64,
    #[body(mass = 2, inertia = rod(2, 1, x))] rod: Body,
    #[joint(ground -> rod, about = z)] pose: Planar,
    #[constraint(slips(rod.at(-0.5 * x).sphere(0.01), ground.plane(y)), friction = friction, speed = 0.001)]
    floor: Slipping,";

/// Forces of time, and nothing that commands it.
const DRIVEN: &str = "#[body(mass = 2, inertia = sphere(2, 0.3))] ball: Body,
    #[joint(ground -> ball, about = z)] pose: Planar,
    #[acts(on = ball, value = sin(t) * ground.x)] wind: Force,
    #[contact(ball.sphere(0.3), ground.plane(y), friction = 0.3, rolling = 0.01)] floor: Contact,
    #[limit(on = pose.x, max_speed = 3)] stop: Limit,
    #[limit(on = pose.angle, from = -1)] bound: Limit,
    #[output(reaction_force(pose))] load: Vector,
    #[output(contact_force(floor))] push: Vector,
    #[output(ball, resolved_in = ground)] diagram: FreeBody,";

/// A sleigh whose motor's force depends on its velocity.
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

/// Declared speeds beside a ball joint.
const SPEEDS: &str = "
    #[body(mass = 2)] cart: Body,
    #[body(mass = 1, com = x, inertia = rod(1, 2, x))] arm: Body,
    #[body(mass = 1, inertia = sphere(1, 0.2))] ball: Body,
    #[joint(ground -> ball)] socket: Ball,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[joint(cart -> arm, about = z)] hinge: Pin,
    #[speed(rate(rail) * cos(hinge) + 0.3 * rate(hinge))] along: Speed,
    #[speed(1.5 * rate(hinge) - rate(rail) * sin(hinge))] turn: Speed,";

/// Name, arguments of the attribute, fields, and what is shown: functions with their bodies, or with traits (`Trait::*`), of which
/// what is a call of the function of the same name is left out.
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
            "__link2_path_placement",
            "__link2_path_motion",
            "__link2_path_columns",
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
        // What follows from the figures is no normal number any more.
        "#[particle(mass = 1e-20)] bob: Particle,
        #[joint(ground -> bob.at(-1e-10 * y), about = z)] hinge: Pin,",
        &["mass_matrix", "kinetic_energy"],
    ),
];

/// True for the function of a trait that calls the one of its name.
fn is_passed_on(function: &syn::ImplItemFn) -> bool {
    let body = function.block.to_token_stream().to_string();
    body.starts_with(&format!("{{ Self :: {} (", function.sig.ident))
}

/// The code without documentation, without what only says what is missing, and without frames.
fn shown(text: &str, functions: &[&str]) -> String {
    let mut file = syn::parse_file(text).unwrap();
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
                    if inherent && !functions.contains(&name.as_str()) || asked && is_passed_on(f) {
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

/// Compares a text with a file of this folder, or writes it there. What differs first.
fn difference(name: &str, text: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots").join(format!("{name}.txt"));
    if std::env::var_os("LINKWORK_WRITE").is_some() {
        fs::write(&path, text).unwrap();
    }
    let expected = fs::read_to_string(&path).unwrap_or_default();
    let lines = text.lines().count().max(expected.lines().count());
    let padded = |text: &'static str| std::iter::repeat(text);
    let both = text.lines().chain(padded("(no more)")).zip(expected.lines().chain(padded("(no more)")));
    let (k, (now, before)) = both.take(lines).enumerate().find(|(_, (now, before))| now != before)?;
    Some(format!("{name}.txt, line {}:\n  before: {before}\n  now:    {now}", k + 1))
}

/// A test for each mechanism, of its name.
macro_rules! snapshots {
    ($($name:ident)+) => {
        const TESTS: &[&str] = &[$(stringify!($name)),+];

        $(#[test]
        fn $name() {
            is_as_written(stringify!($name));
        })+
    };
}

snapshots!(pendulum closed independent limbs prepare batch derivatives charts slipping driven governed measured speeds file f32);

fn is_as_written(name: &str) {
    let of = MECHANISMS.iter().find(|(known, ..)| *known == name);
    let (_, attribute, fields, functions) = of.expect("a mechanism of this name");
    let item = format!("pub struct Shown {{ {fields} }}").parse().unwrap();
    let emitted = expand(attribute.parse().unwrap(), item, Path::new(""));
    assert!(!emitted.tokens.to_string().contains("compile_error"), "{name}: {}", emitted.tokens);
    assert_eq!(
        difference(name, &shown(&emitted.text, functions)),
        None,
        "generated code differs; with `LINKWORK_WRITE=1` it is written anew"
    );
}

#[test]
fn every_mechanism_has_a_test() {
    assert!(MECHANISMS.iter().map(|(name, ..)| *name).eq(TESTS.iter().copied()));
}

/// Mechanisms whose structs' documentation has, between them, every part.
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
fn documentation_of_structs() {
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
        // Everywhere, or `cfg_attr(doc, doc = …)`: on pages, in editors.
        for attribute in attributes.unwrap() {
            let tokens = attribute.meta.to_token_stream().into_iter().flat_map(|token| match token {
                TokenTree::Group(group) => group.stream().into_iter().collect(),
                token => vec![token],
            });
            let literals = tokens.filter_map(|token| syn::parse2::<syn::LitStr>(token.into()).ok());
            // Typeset equations are seen on pages.
            let lines = literals.map(|line| line.value()).filter(|line| !line.contains("<math>"));
            lines.for_each(|line| text += &format!("{line}\n"));
        }
    }
    assert_eq!(difference("documentation", &text), None, "documentation differs");
}

const ROPE: &str = "#[acts(between = (trunk.at(0.3 * x), ground.at(2 * z)))] rope: Force,";
const MOTOR: &str = "#[acts(on = joint0_0)] motor: Torque,";

/// Alike limbs that touch the ground.
const FEET: &str = "
    #[body(mass = 2, inertia = sphere(2, 0.3))] trunk: Body,
    #[body(mass = 0.5, com = -0.2 * y, inertia = rod(0.5, 0.4, y))] left: Body,
    #[body(mass = 0.5, com = -0.2 * y, inertia = rod(0.5, 0.4, y))] right: Body,
    #[joint(ground -> trunk, about = z)] pose: Planar,
    #[joint(trunk.at(-0.3 * x) -> left, about = z)] one: Pin,
    #[joint(trunk.at(0.3 * x) -> right, about = z)] other: Pin,
    #[contact(left.at(-0.4 * y), ground.plane(y), friction = 0.7)] first: Contact,
    #[contact(right.at(-0.4 * y), ground.plane(y), friction = 0.7)] second: Contact,";

/// Speeds of these.
const FEET_SPEEDS: &str = "
    #[speed(rate(pose.x) * cos(pose.angle) + rate(pose.y) * sin(pose.angle))] ahead: Speed,
    #[speed(rate(pose.y) * cos(pose.angle) - rate(pose.x) * sin(pose.angle))] aside: Speed,
    #[speed(rate(pose.angle))] turn: Speed,
    #[speed(rate(one))] swing: Speed,
    #[speed(rate(other))] back: Speed,";

/// Rolling without slipping.
const BALL: &str = "
    #[body(mass = 1, inertia = sphere(1, 1))] ball: Body,
    #[joint(ground -> ball)] pose: Free,
    #[constraint(rolls(ball.sphere(1), ground.plane(z)))] contact: Rolling,";

/// Of the linkage that has every function: its rocker strikes the ground, and its crank loads its bearing.
const BOUNDED: &str = "
    #[contact(rocker.at(x), ground.plane(y))] stop: Contact,
    #[output(norm(reaction_force(input)))] load: Scalar,
    #[output(contact_force(stop))] push: Vector,";

/// Three pins about parallel axes.
const PARALLEL: &str = "
    m: f64,
    #[body(mass = m, com = x / 2, inertia = rod(m, 1, x))] one: Body,
    #[body(mass = 2, com = x / 2 + y / 3, inertia = rod(m, 1, x))] two: Body,
    #[body(mass = m, com = x / 2, inertia = rod(m, 1, x))] three: Body,
    #[joint(ground -> one, about = z)] a: Pin,
    #[joint(one.at(x) -> two, about = z)] b: Pin,
    #[joint(two.at(x + y) -> three, about = z)] c: Pin,";

/// Where a ball touches a surface are coordinates without inertia, which follow from the others.
const ROLLING: &str = "
    u: Coordinate,
    w: Coordinate,
    #[body(mass = 1, inertia = sphere(1, 1))] ball: Body,
    #[joint(ground -> ball)] pose: Free,
    #[constraint(rolls(ball.sphere(1), ground.surface(u, w, u * x + w * y + 0.1 * u * u * z)))] contact: Rolling,";

/// All that is emitted for the mechanisms that are shown here in part, for those that have every function or what is seldom together, and
/// for lanes: too long to be read, it is measured, code alone and with its documentation, and a difference is looked at with the command
/// `expand` of the examples.
#[test]
fn whole_code() {
    let shown = MECHANISMS.map(|(name, attribute, fields, _)| (name, attribute, fields.to_string()));
    let documented = DOCUMENTED.map(|(attribute, fields)| ("documented", attribute, fields.to_string()));
    let chosen = chosen::MECHANISMS.map(|(attribute, fields, _)| ("chosen", attribute, fields.to_string()));
    let all = "gravity = -g * y, derivatives, second_derivatives, packed, batch, sensitivities, centroidal, regressor, prepare";
    let arm = |k: usize| chosen::limb(k, format!("link12.at({} * x)", [-0.2, 0.2][k]), 6);
    let (.., closed) = mechanisms::MECHANISMS.into_iter().find(|(_, name, _)| *name == "Closed").unwrap();
    let on_rails = chosen::limbs(4, 5)
        .replace("base: Free", "base: Stage")
        .replace("ground -> trunk", "ground -> trunk, along = (x, y, z)");
    let toe = |limb: usize, k: usize| {
        let (parent, axis) = (format!("part{limb}_1.at(0.4 * z + {k} * x)"), ["x", "y"][k]);
        format!(
            "#[body(mass = 0.3, com = 0.1 * z, inertia = diagonal(0.03, 0.04, 0.02))] toe{limb}_{k}: Body,
            #[joint({parent} -> toe{limb}_{k}, about = {axis})] ball{limb}_{k}: Pin,"
        )
    };
    let toes: String =
        (0..4).flat_map(|limb| (0..2).map(move |k| (limb, k))).map(|(limb, k)| toe(limb, k)).collect();
    let lanes = [
        ("chain", all, format!("g: f64, {}", chosen::chain(6))),
        ("limbs", all, format!("g: f64, {}", chosen::limbs(4, 2))),
        ("legs", "gravity = -9.81 * y, derivatives, packed, batch", chosen::limbs(4, 3) + MOTOR),
        // Of ten velocities and eleven coordinates, up to which number things are compared.
        ("ten", "gravity = -9.81 * y, derivatives, batch", chosen::limbs(2, 2) + MOTOR),
        ("feet", "gravity = -9.81 * y, derivatives, batch", FEET.to_string()),
        ("feet in speeds", "gravity = -9.81 * y, derivatives, batch", FEET.to_string() + FEET_SPEEDS),
        ("feet without inertia", "inertia = none", FEET.to_string()),
        ("packed feet in speeds", "gravity = -9.81 * y, packed", FEET.to_string() + FEET_SPEEDS),
        ("speeds in lanes", "gravity = -9.81 * y, batch", SPEEDS.to_string()),
        ("ball", "gravity = -9.81 * z, second_derivatives", BALL.to_string()),
        ("bounded linkage", "gravity = -9.81 * y, prepare", closed.to_string() + BOUNDED),
        // What passes do for chains of axes that are parallel or skew, with numbers or parameters, is left out.
        ("skipped", "gravity = -9.81 * y, skip_passes = [frames, regroup, parallel]", chosen::chain(4)),
        ("skipped", "gravity = -9.81 * y, skip_passes = [frames, regroup, parallel]", PARALLEL.to_string()),
        (
            "placements",
            "urdf = \"../../models/urdf/double_pendulum.urdf\", parameters = placement",
            String::new(),
        ),
        ("numbers", "urdf = \"../../models/urdf/double_pendulum.urdf\", parameters = damping", String::new()),
        ("many legs", "gravity = -9.81 * y, derivatives", chosen::limbs(4, 5)),
        // What an input does depends on some coordinates alone.
        ("towed legs", "gravity = -9.81 * y, derivatives", chosen::limbs(4, 5) + ROPE),
        ("rolling", "gravity = -9.81 * z, derivatives, batch", ROLLING.to_string()),
        // Whose inverse is found in loops: of a tree, of one with lanes and a long trunk, and of a chain.
        ("tree", "gravity = -9.81 * y, derivatives, skip_passes = [limbs]", chosen::limbs(4, 5)),
        // A trunk whose first velocity the first joint of each limb does not feel.
        ("tree on rails", "gravity = -9.81 * y, derivatives, skip_passes = [limbs]", on_rails),
        // Limbs that branch.
        ("toes", "gravity = -9.81 * y, derivatives", chosen::limbs(4, 2) + &toes),
        ("torso", "gravity = -9.81 * y, derivatives, batch", chosen::chain(13) + &arm(0) + &arm(1)),
        // Whose passive forces have functions of their own.
        ("springs", "gravity = -9.81 * y, derivatives, batch", chosen::springs(120)),
        ("long chain", "gravity = -9.81 * y, derivatives, batch", chosen::chain(14)),
    ];
    let every = mechanisms::MECHANISMS.map(|(attribute, name, fields)| (name, attribute, fields.to_string()));
    let writes = std::env::var_os("LINKWORK_WRITE").is_some();
    let expected = fs::read_to_string("tests/snapshots/whole_code.txt").unwrap_or_default();
    let mut text = String::new();
    for (name, attribute, fields) in
        shown.into_iter().chain(documented).chain(every).chain(chosen).chain(lanes)
    {
        let item = format!("pub struct Shown {{ {fields} }}").parse().unwrap();
        let emitted = expand(attribute.parse().unwrap(), item, Path::new(""));
        assert!(!emitted.tokens.to_string().contains("compile_error"), "{name}: {}", emitted.tokens);
        // Fields and documentation as well, but for the space between tokens.
        let all = emitted.text.clone() + &emitted.tokens.to_string();
        let whole = measure::number(all.bytes().filter(|byte| !byte.is_ascii_whitespace()));
        text += &format!("{name}, {attribute}: {}, {whole:016x}\n", measure::measure(&emitted.text));
        // Large ones come last.
        assert!(writes || expected.starts_with(&text), "other code of {name}, {attribute}");
    }
    assert_eq!(difference("whole_code", &text), None, "generated code differs");
}
