//! Recovery from errors. A mechanism with an error declares the same names as without it, so that its users
//! cause no further errors. Functions that a mechanism lacks on purpose have a bound that names the reason.

mod generated;

use linkwork_compiler::expand;
use linkwork_compiler::language::FunctionId;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::{ImplItem, Item, ItemImpl, Type};

/// Declaration of a field with an error that affects no other field.
const MISTAKE: &str = "#[output(unknown)] mistake: Scalar,";

const WORDS: &str = "derivatives, second_derivatives, momentum_derivatives, centroidal, hamilton, conserved, \
                     regressor, sensitivities, packed, prepare, batch, drawing";

const CART_POLE: &str = "
    m: f64, l: f64,
    #[body(mass = 1)] cart: Body,
    #[body(mass = m, com = l * y)] pole: Body,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[joint(cart -> pole, about = z)] hinge: Pin,
    #[acts(on = cart, along = x)] push: Force,
    #[output(r(pole / ground))] place: Vector,
    #[output(dot(v(pole / ground / ground), y))] climb: Scalar,
    #[output(dot(a(pole / ground / ground), y))] lift: Scalar,
    #[output(reaction_force(hinge))] load: Vector,
    #[output(pole)] diagram: FreeBody,";

const DRIVEN: &str = "
    m: f64, radius: f64, spin: f64,
    theta: Coordinate,
    #[frame(ground, z(spin * t))] hoop: Frame,
    #[particle(mass = m, at = radius * (sin(theta) * hoop.x - cos(theta) * hoop.z))] bead: Particle,
    #[output(v(bead / ground / hoop), resolved_in = hoop)] sliding: Vector,";

const FOUR_BAR: &str = "
    m: f64,
    #[body(mass = m, com = x / 2)] crank: Body,
    #[body(mass = m, com = x / 2)] coupler: Body,
    #[body(mass = m, com = x / 2)] rocker: Body,
    #[joint(ground -> crank, about = z)] input: Pin,
    #[joint(crank.at(x) -> coupler, about = z)] joint: Pin,
    #[joint(ground.at(1.5 * x) -> rocker, about = z)] output: Pin,
    #[joint(coupler.at(2 * x) -> rocker.at(1.4 * x), about = z)] last: Pin,
    #[acts(on = input)] motor: Torque,
    #[output(reaction_force(last))] load: Vector,";

const SLIDING: &str = "
    m: f64, friction: f64,
    #[body(mass = m, inertia = rod(m, 1, x))] rod: Body,
    #[joint(ground -> rod, about = z)] pose: Planar,
    #[constraint(slips(rod.at(-0.5 * x).sphere(0.01), ground.plane(y)), friction = friction, speed = 0.001)]
    floor: Slipping,";

const BOUNCING: &str = "mu: f64,
    #[body(mass = 1, inertia = sphere(1, 1))] ball: Body,
    #[joint(ground -> ball)] pose: Free,
    #[contact(ball.sphere(1), ground.plane(z), friction = mu)] floor: Contact,
    #[output(contact_force(floor))] push: Vector,
    #[output(ball)] diagram: FreeBody,";

const MECHANISMS: [(&str, &str); 5] = [
    ("CartPole", CART_POLE),
    ("Driven", DRIVEN),
    ("FourBar", FOUR_BAR),
    ("Sliding", SLIDING),
    ("Bouncing", BOUNCING),
];

/// Map from the name to arguments and result; `None` for constants.
type SignaturesByName = BTreeMap<String, Option<String>>;

struct GeneratedItems {
    /// Names of the functions and constants that each generated struct has.
    present: SignaturesByName,
    /// Absent functions of a mechanism, with the bound that names the reason.
    absent: BTreeMap<String, String>,
    /// Traits that the generated structs implement.
    traits: BTreeSet<String>,
}

fn generate_items(arguments: &str, name: &str, fields: &str) -> GeneratedItems {
    let item = format!("pub struct {name} {{ {fields} }}");
    let emitted = expand(arguments.parse().unwrap(), item.parse().unwrap(), Path::new(""));
    let file: syn::File = syn::parse2(emitted.into_tokens().unwrap()).unwrap();
    let mut all =
        GeneratedItems { present: SignaturesByName::new(), absent: BTreeMap::new(), traits: BTreeSet::new() };
    for item in generated::items_of_generated_code(file) {
        if let Item::Impl(block) = item {
            all.read_implementation(&block);
        }
    }
    all
}

/// Prefixes of names whose sizes an error may hide: only the equations determine the numbers of constraints,
/// contacts and conserved quantities.
const UNSIZED: [&str; 12] = [
    "base_",
    "conserved",
    "constrained_",
    "constraint_",
    "contact_",
    "diagram",
    "drawing_",
    "joint_torque_",
    "linearize",
    "mass_matrix_packed",
    "multiplier_",
    "standard_",
];

fn signature_text(f: &syn::ImplItemFn) -> String {
    let (name, inputs, output) = (f.sig.ident.to_string(), &f.sig.inputs, &f.sig.output);
    // After an error the set of frames is unknown.
    let mut text = quote::quote!((#inputs) #output).to_string();
    if let Some(start) = text.find("impl :: linkwork :: FrameName <") {
        let end = text[start..].find('>').map_or(text.len(), |end| start + end + 1);
        text.replace_range(start..end, "F");
    }
    if !UNSIZED.iter().any(|start| name.starts_with(start)) {
        return text;
    }
    let is_size_argument = |word: &str| word.trim_end_matches([']', ')']).parse::<usize>().is_ok();
    let words = text.split(' ').map(|word| if is_size_argument(word) { "_" } else { word });
    words.collect::<Vec<_>>().join(" ")
}

/// Output expressions with one function of the language each, for a mechanism with elements of every kind.
const MEASURES: [(&str, &str, &str); 57] = [
    ("atan2", "atan2(sin(hinge), 2)", "Scalar"),
    ("degrees", "hinge + degrees(30)", "Scalar"),
    ("pow", "pow(hinge, 3)", "Scalar"),
    ("min", "min(hinge, 1)", "Scalar"),
    ("max", "max(hinge, 1)", "Scalar"),
    ("dot", "dot(arm.x, x)", "Scalar"),
    ("cross", "cross(arm.x, x)", "Vector"),
    ("norm", "norm(r(wing / arm))", "Scalar"),
    ("unit", "unit(r(wing / arm))", "Vector"),
    ("r", "r(wing / arm)", "Vector"),
    ("v", "v(wing / ground / ground)", "Vector"),
    ("a", "a(wing / ground / ground)", "Vector"),
    ("omega", "omega(wing / ground)", "Vector"),
    ("alpha", "alpha(wing / ground / ground)", "Vector"),
    ("rate", "rate(hinge)", "Scalar"),
    ("angle", "angle(arm.x, x, z)", "Scalar"),
    ("project", "project(arm.x, x)", "Vector"),
    ("momentum", "momentum(arm)", "Vector"),
    ("angular_momentum", "angular_momentum(arm / ground)", "Vector"),
    ("kinetic_energy", "kinetic_energy(arm)", "Scalar"),
    ("moment_of_inertia", "moment_of_inertia(wing / arm, z)", "Scalar"),
    ("center_of_mass", "center_of_mass((arm, wing) / ground)", "Vector"),
    ("center_of_percussion", "center_of_percussion(arm / ground, z)", "Vector"),
    ("instant_center", "instant_center(plate / ground)", "Vector"),
    ("acceleration_center", "acceleration_center(plate / ground)", "Vector"),
    ("screw_axis", "screw_axis(wing / ground)", "Vector"),
    ("screw_pitch", "screw_pitch(wing / ground)", "Scalar"),
    ("projector", "projector(arm.x) * x", "Vector"),
    ("skew", "skew(arm.x) * x", "Vector"),
    ("outer", "outer(arm.x, arm.y) * x", "Vector"),
    ("rotation", "rotation(arm / ground) * x", "Vector"),
    ("inertia", "inertia(arm / ground) * x", "Vector"),
    ("identity", "identity() * arm.x", "Vector"),
    ("transpose", "transpose(rotation(arm / ground)) * x", "Vector"),
    ("trace", "trace(rotation(arm / ground))", "Scalar"),
    ("curvature", "curvature(hinge * x + hinge * hinge * y, hinge)", "Scalar"),
    ("torsion", "torsion(hinge * x + hinge * hinge * y + hinge * hinge * hinge * z, hinge)", "Scalar"),
    ("cable", "cable(ground.at(3 * y) / arm, wing.sphere(0.1))", "Scalar"),
    ("gradient", "gradient(dot(r(wing / ground), x) / wing)", "Vector"),
    ("power", "power(coil)", "Scalar"),
    ("reaction_force", "reaction_force(hinge)", "Vector"),
    ("reaction_torque", "reaction_torque(hinge)", "Vector"),
    ("contact_force", "contact_force(floor)", "Vector"),
    ("contact_moment", "contact_moment(floor)", "Vector"),
    ("density", "density(hinge)", "Scalar"),
    ("pressure", "pressure(hinge)", "Scalar"),
    ("temperature", "temperature(hinge)", "Scalar"),
    ("speed_of_sound", "speed_of_sound(hinge)", "Scalar"),
    ("angle_of_attack", "angle_of_attack(wing, wind)", "Scalar"),
    ("sideslip", "sideslip(wing, wind)", "Scalar"),
    ("heading", "heading(wing)", "Scalar"),
    ("elevation", "elevation(wing)", "Scalar"),
    ("bank", "bank(wing)", "Scalar"),
    ("course", "course(wind)", "Scalar"),
    ("flight_path", "flight_path(wind)", "Scalar"),
    ("stability_axes", "stability_axes(wing, wind, [1, 2, 3])", "Vector"),
    ("wind_axes", "wind_axes(wing, wind, [1, 2, 3])", "Vector"),
];

const MEASURED: &str = "command: Input,
    #[body(mass = 1, com = x / 2, inertia = sphere(1, 1))] arm: Body,
    #[body(mass = 1, inertia = sphere(1, 1))] wing: Body,
    #[joint(ground -> arm, about = z)] hinge: Pin,
    #[body(mass = 1, inertia = sphere(1, 1))] plate: Body,
    #[joint(ground -> wing)] flight: Free,
    #[joint(ground -> plate, about = z)] table: Planar,
    #[acts(on = hinge, stiffness = 1)] coil: Spring,
    #[acts(on = hinge, value = command)] motor: Torque,
    #[contact(wing.sphere(1), ground.plane(z), friction = 0.3, torsional = 0.1)] floor: Contact,
    #[define(v(wing / ground / ground))] wind: Vector,";

/// An error elsewhere does not change the arguments of outputs, for every function of the language.
#[test]
fn errors_elsewhere_preserve_output_arguments() {
    let listed: Vec<&str> = FunctionId::names().collect();
    assert_eq!(listed, MEASURES.map(|(name, ..)| name));
    for (function, value, kind) in MEASURES {
        let fields = format!("{MEASURED} #[output({value})] measure: {kind},");
        let item = format!("pub struct Measured {{ {fields} }}");
        let messages = expand("".parse().unwrap(), item.parse().unwrap(), Path::new("")).tokens.to_string();
        let error = messages.find("compile_error").map(|at| &messages[at..]);
        assert_eq!(error, None, "{function}");
        let whole = generate_items("", "Measured", &fields);
        let failed = generate_items("", "Measured", &format!("{fields} {MISTAKE}"));
        let signature_of_measure = |all: &GeneratedItems| all.present.get("Measured::measure").cloned();
        assert!(signature_of_measure(&whole).is_some(), "{function}");
        assert_eq!(signature_of_measure(&failed), signature_of_measure(&whole), "{function}");
    }
}

/// Returns the bound of an absent function, which is the only bound over a lifetime.
fn marker_trait_of_absent_function(block: &ItemImpl) -> Option<String> {
    let bounds = block.generics.where_clause.as_ref()?.predicates.iter();
    let reasons = bounds.filter_map(|predicate| match predicate {
        syn::WherePredicate::Type(bound) if bound.lifetimes.is_some() => match bound.bounds.first()? {
            syn::TypeParamBound::Trait(bound) => Some(bound.path.segments.last()?.ident.to_string()),
            _ => None,
        },
        _ => None,
    });
    reasons.last()
}

impl GeneratedItems {
    fn read_implementation(&mut self, block: &ItemImpl) {
        let Type::Path(of) = &*block.self_ty else { return };
        let of = of.path.segments.last().unwrap().ident.to_string();
        if let Some((path, _)) = &block.trait_ {
            self.traits.insert(format!("{of}: {}", path.segments.last().unwrap().ident));
            return;
        }
        let reason = marker_trait_of_absent_function(block);
        for item in &block.items {
            let (name, arguments) = match item {
                ImplItem::Fn(f) => (f.sig.ident.to_string(), Some(signature_text(f))),
                ImplItem::Const(c) => (c.ident.to_string(), None),
                _ => continue,
            };
            if name.starts_with("__") {
                continue;
            }
            let name = format!("{of}::{name}");
            let first = match &reason {
                Some(reason) => self.absent.insert(name.clone(), reason.clone()).is_none(),
                None => self.present.insert(name.clone(), arguments).is_none(),
            };
            assert!(first, "`{name}` stands there twice");
        }
    }
}

/// Functions that only generated code calls are hidden from the documentation, also from that of binaries.
#[test]
fn internal_functions_are_hidden_from_documentation() {
    for (name, fields) in MECHANISMS {
        for words in ["", WORDS] {
            let item = format!("pub struct {name} {{ {fields} }}");
            let emitted = expand(words.parse().unwrap(), item.parse().unwrap(), Path::new(""));
            let file: syn::File = syn::parse2(emitted.into_tokens().unwrap()).unwrap();
            for item in generated::items_of_generated_code(file) {
                let Item::Impl(ItemImpl { trait_: None, items, .. }) = item else { continue };
                for item in items {
                    let (ident, attributes) = match item {
                        ImplItem::Fn(f) => (f.sig.ident.to_string(), f.attrs),
                        ImplItem::Const(c) => (c.ident.to_string(), c.attrs),
                        _ => continue,
                    };
                    let is_hidden =
                        attributes.iter().any(|a| quote::quote!(#a).to_string() == "# [doc (hidden)]");
                    assert!(is_hidden || !ident.starts_with("__"), "{name}, {words}: `{ident}` is shown");
                }
            }
        }
    }
}

#[test]
fn all_names_remain_defined_after_an_error() {
    for (name, fields) in MECHANISMS {
        for words in ["", "derivatives", "batch", WORDS] {
            let whole = generate_items(words, name, fields);
            let failed = generate_items(words, name, &format!("{fields} {MISTAKE}"));
            for (function, arguments) in &whole.present {
                assert_eq!(failed.present.get(function), Some(arguments), "{name}, {words}: `{function}`");
            }
            let hidden =
                ["NamedFrame", "Evaluate", "Body", "__Steps"].map(|hidden| format!("{name}: {hidden}"));
            let hidden =
                hidden.into_iter().chain(["Evaluate", "Body"].map(|h| format!("Prepared{name}: {h}")));
            let wanted: BTreeSet<String> = whole.traits.iter().cloned().collect();
            let hidden: BTreeSet<String> = hidden.collect();
            let missing: Vec<&String> =
                wanted.iter().filter(|t| !hidden.contains(*t) && !failed.traits.contains(*t)).collect();
            assert!(missing.is_empty(), "{name}, {words}: {missing:?}");
        }
    }
}

#[test]
fn missing_option_is_named_by_every_dependent_function() {
    let function_name = |name: &str| name.split_once("::").unwrap().1.to_string();
    for (name, fields) in MECHANISMS {
        let (bare, all) = (generate_items("", name, fields), generate_items(WORDS, name, fields));
        // A function that all options together add is present without them, or reports why it is absent.
        for function in all.present.keys().filter(|function| function.starts_with(name)) {
            let known = bare.present.contains_key(function) || bare.absent.contains_key(function);
            // A `_lanes` function may require two options: that of its scalar function, and `batch`.
            let of_two = function.ends_with("_lanes")
                && !bare.present.contains_key(function.trim_end_matches("_lanes"));
            assert!(known || of_two, "{function}");
        }
        // Without one of the options, its functions report that they require it.
        let one_less = WORDS.split(", ").filter(|_| ["CartPole", "FourBar"].contains(&name));
        for word in one_less {
            let others: Vec<&str> = WORDS.split(", ").filter(|other| *other != word).collect();
            let without = generate_items(&others.join(", "), name, fields);
            let lost = all.present.keys().filter(|function| !without.present.contains_key(*function));
            for function in lost.filter(|function| !function.starts_with("Prepared") || word != "prepare") {
                let reason = without.absent.get(function).map(|reason| reason.to_lowercase());
                assert_eq!(reason, Some(format!("asksfor{}", word.replace('_', ""))), "{function}");
            }
        }
        for function in all.absent.keys() {
            let constrained = ["FourBar", "Sliding"].contains(&name);
            let reason = &all.absent[function];
            let expected: &[&str] = match constrained {
                true => &["HasNoConstraints", "HasSlipping", "HasNoSlipping"],
                false => &["HasConstraints"],
            };
            let of_all = [
                "HasJacobian",
                "HasFrames",
                "HoldsParameters",
                "HasFileParameters",
                "HasFileInertials",
                "DeclaresEquilibria",
                "AsksForRouth",
                "HasContacts",
                "HasSpeeds",
            ];
            let known = expected.contains(&reason.as_str()) || of_all.contains(&reason.as_str());
            assert!(known, "{}: {reason}", function_name(function));
        }
    }
}

#[test]
fn kinematic_mechanisms_explain_missing_functions() {
    let kinematic = generate_items(
        "inertia = none",
        "CartPole",
        "#[body] cart: Body, #[joint(ground -> cart, along = x)] rail: Sleeve,",
    );
    for name in ["mass_matrix", "simulate_nothing", "linearize", "center_of_mass", "prepare", "BODIES"] {
        let reason = kinematic.absent.get(&format!("CartPole::{name}")).map(String::as_str);
        assert_eq!(reason, (name != "simulate_nothing").then_some("HasInertia"), "{name}");
    }
    let twice = kinematic.absent.keys().find(|name| kinematic.present.contains_key(*name));
    assert_eq!(twice, None);
}

const STOPPED: &str = "
    #[body(mass = 1)] cart: Body,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[limit(on = rail, from = -1, to = 1)] stops: Limit,
    #[acts(on = rail)] push: Force,
    #[equilibrium(rail = 0)] rest: Equilibrium,";

const SPED: &str = "
    #[body(mass = 1, inertia = sphere(1, 1))] ball: Body,
    #[joint(ground -> ball, along = (x, y))] plane: Stage,
    #[speed(rate(plane.x) + rate(plane.y))] both: Speed,
    #[speed(rate(plane.x) - rate(plane.y))] apart: Speed,";

/// Test mechanism with a frictionless contact: one contact velocity.
const SMOOTH: &str = "
    #[particle(mass = 1)] bead: Particle,
    #[joint(ground -> bead, along = z)] rod: Sleeve,
    #[contact(bead, ground.plane(z))] floor: Contact,";

/// Test mechanism with a contact and a holonomic constraint.
const HELD: &str = "
    #[particle(mass = 1)] bead: Particle,
    #[joint(ground -> bead, along = (x, z))] plane: Stage,
    #[constraint(plane.x * plane.x + plane.y * plane.y = 1)] ring: Holonomic,
    #[contact(bead, ground.plane(z))] floor: Contact,";

/// Test mechanism with a rolling contact whose normal force depends on another contact, and with a one-sided
/// limit.
const PRESSED: &str = "
    #[body(mass = 1, inertia = sphere(1, 1))] ball: Body,
    #[joint(ground -> ball, about = z)] pose: Planar,
    #[contact(ball.sphere(1), ground.plane(y), friction = 0.3, rolling = 0.01)] floor: Contact,
    #[limit(on = pose.angle, from = -1)] stop: Limit,";

/// Test mechanism with a first-order state and a constraint.
const LAGGED: &str = "command: Input, lag: f64,
    #[particle(mass = 1)] bead: Particle,
    #[joint(ground -> bead, along = (x, z))] plane: Stage,
    #[constraint(plane.x * plane.x + plane.y * plane.y = 1)] ring: Holonomic,
    #[state(rate = (command - lagging) / lag)] lagging: State,
    #[acts(on = plane.x, value = lagging)] push: Force,
    #[output(lagging * plane.x)] felt: Scalar,";

const WELDED: &str = "#[body(mass = 1)] stone: Body, #[joint(ground -> stone)] base: Weld,";

/// Returns the names of all generated functions and constants, as text: available names, and absent names
/// grouped by reason. Also lists the implemented traits, except those of frames and function bodies.
fn names_by_availability(arguments: &str, name: &str, fields: &str) -> String {
    let item = format!("pub struct {name} {{ {fields} }}");
    let emitted = expand(arguments.parse().unwrap(), item.parse().unwrap(), Path::new(""));
    assert!(!emitted.tokens.to_string().contains("compile_error"), "{name}: {}", emitted.tokens);
    let file: syn::File = syn::parse2(emitted.into_tokens().unwrap()).unwrap();
    let mut by: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for item in generated::items_of_generated_code(file) {
        let Item::Impl(block) = item else { continue };
        if let Some((path, _)) = &block.trait_ {
            let of = path.segments.last().unwrap().ident.to_string();
            if !["NamedFrame", "Evaluate", "Body", "__Steps"].contains(&of.as_str()) {
                by.entry("traits".to_string()).or_default().insert(of);
            }
            continue;
        }
        for item in &block.items {
            let name = match item {
                ImplItem::Fn(f) => f.sig.ident.to_string(),
                ImplItem::Const(c) => c.ident.to_string(),
                _ => continue,
            };
            let list = marker_trait_of_absent_function(&block)
                .map_or("there".to_string(), |reason| format!("not there, {reason}"));
            by.entry(list).or_default().insert(name);
        }
    }
    let lists = by.into_iter().map(|(list, names)| {
        let names: Vec<String> = names.into_iter().collect();
        format!("{list}: {}\n", names.join(" "))
    });
    format!("== {name}, {arguments}\n{}\n", lists.collect::<String>())
}

/// `LINKWORK_WRITE=1 cargo test -p linkwork-compiler --test recovery` regenerates the file; review the
/// difference.
#[test]
fn generated_names_equal_the_recorded_list() {
    let others = [
        ("Stopped", STOPPED),
        ("Sped", SPED),
        ("Smooth", SMOOTH),
        ("Held", HELD),
        ("Pressed", PRESSED),
        ("Lagged", LAGGED),
        ("Welded", WELDED),
    ];
    let stopped = &STOPPED[..STOPPED.find("#[acts").unwrap()];
    let led = format!("{stopped} #[state(rate = rate(rail))] way: State, #[output(way)] late: Scalar,");
    let kinematic = ("inertia = none", "Led", &led[..]);
    let all = MECHANISMS.into_iter().chain(others);
    let all = all.flat_map(|(name, fields)| [("", name, fields), ("derivatives", name, fields)]);
    let text: String = all
        .chain([kinematic])
        .map(|(arguments, name, fields)| names_by_availability(arguments, name, fields))
        .collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recovery/names.txt");
    if std::env::var_os("LINKWORK_WRITE").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    let differs = text.lines().zip(expected.lines()).find(|(now, before)| now != before);
    assert_eq!(
        (differs, text.len()),
        (None, expected.len()),
        "names.txt is not what mechanisms have now; with `LINKWORK_WRITE=1` it is written anew"
    );
}
