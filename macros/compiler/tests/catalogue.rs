//! What is generated is what the catalogue says, and a program that does not fit its row is no code.

use linkwork_compiler::catalogue::{self, Facts};
use linkwork_compiler::derive::Output;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Model;
use linkwork_compiler::{compile, expand, read};
use proc_macro2::TokenStream;
use std::collections::BTreeSet;
use std::path::Path;

/// Attribute, name and fields of mechanisms that have, between them, every function.
const MECHANISMS: [(&str, &str, &str); 11] = [
    (
        "gravity = -9.81 * y, second_derivatives, momentum_derivatives, centroidal, hamilton, conserved, regressor, sensitivities, packed, prepare, batch, drawing",
        "Plain",
        "m: f64,
        #[joint(ground -> arm, about = z)] hinge: Pin,
        #[body(mass = m, com = x, inertia = rod(m, 2, x))] arm: Body,
        #[acts(on = hinge)] motor: Torque,
        #[output(hinge)] angle: Scalar,",
    ),
    (
        "gravity = -9.81 * y, second_derivatives, momentum_derivatives, centroidal, hamilton, conserved, regressor, sensitivities, packed, prepare, batch, drawing",
        "Closed",
        "m: f64,
        #[body(mass = m, com = x / 2, inertia = rod(m, 1, x))] crank: Body,
        #[body(mass = m, com = x, inertia = rod(m, 2, x))] coupler: Body,
        #[body(mass = m, com = x, inertia = rod(m, 2, x))] rocker: Body,
        #[joint(ground -> crank, about = z)] input: Pin,
        #[joint(crank.at(x) -> coupler, about = z)] middle: Pin,
        #[joint(ground.at(2 * x) -> rocker, about = z)] output: Pin,
        #[joint(coupler.at(2 * x) -> rocker.at(2 * x), about = z)] last: Pin,",
    ),
    (
        "gravity = -9.81 * z, second_derivatives, momentum_derivatives, batch",
        "Sliding",
        "mu: f64,
        #[body(mass = 1, inertia = sphere(1, 1))] ball: Body,
        #[joint(ground -> ball)] pose: Free,
        #[constraint(slips(ball.sphere(1), ground.plane(z)), friction = mu)] lane: Slipping,",
    ),
    (
        "gravity = -9.81 * z, prepare, batch",
        "Bouncing",
        "mu: f64,
        #[body(mass = 1, inertia = sphere(1, 1))] ball: Body,
        #[joint(ground -> ball)] pose: Free,
        #[contact(ball.sphere(1), ground.plane(z), friction = mu)] floor: Contact,",
    ),
    (
        "drawing",
        "Hilly",
        "#[body(mass = 1)] ball: Body,
        #[joint(ground -> ball, along = z)] height: Sleeve,
        #[contact(ball.sphere(1), ground.terrain(0.1 * u - 3))] hills: Contact,",
    ),
    (
        "second_derivatives, momentum_derivatives, batch",
        "Driven",
        "#[joint(ground -> bead, along = x)] slide: Sleeve,
        #[particle(mass = 1)] bead: Particle,
        #[acts(on = slide, value = sin(t) - 3 * slide)] pull: Force,",
    ),
    (
        "gravity = -9.81 * y, derivatives, momentum_derivatives, centroidal, hamilton, conserved, regressor, packed, prepare, batch",
        "InSpeeds",
        "m: f64,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(cart -> arm, about = z)] hinge: Pin,
        #[body(mass = m)] cart: Body,
        #[body(mass = m, com = x, inertia = rod(m, 2, x))] arm: Body,
        #[acts(on = hinge)] motor: Torque,
        #[speed(rate(rail) * cos(hinge))] along: Speed,
        #[speed(rate(hinge) - rate(rail) * sin(hinge))] turn: Speed,
        #[output(along)] speed: Scalar,",
    ),
    (
        "urdf = \"../../models/urdf/double_pendulum.urdf\", parameters = [inertial, placement], regressor, prepare",
        "OfAFile",
        "",
    ),
    (
        "gravity = -9.81 * y, batch",
        "Overdetermined",
        "#[body(mass = 1, com = y / 2, inertia = rod(1, 1, y))] one: Body,
        #[body(mass = 1, com = y / 2, inertia = rod(1, 1, y))] two: Body,
        #[body(mass = 1, com = y / 2, inertia = rod(1, 1, y))] three: Body,
        #[body(mass = 1, com = x, inertia = rod(1, 2, x))] plate: Body,
        #[joint(ground -> one, about = z)] a: Pin,
        #[joint(ground.at(x) -> two, about = z)] b: Pin,
        #[joint(ground.at(2 * x) -> three, about = z)] c: Pin,
        #[joint(one.at(y) -> plate, about = z)] d: Pin,
        #[joint(two.at(y) -> plate.at(x), about = z)] e: Pin,
        #[joint(three.at(y) -> plate.at(2 * x), about = z)] f: Pin,",
    ),
    (
        "routh, prepare, batch",
        "Cyclic",
        "m: f64,
        #[body(mass = m, inertia = sphere(m, 1))] cart: Body, #[particle(mass = m)] bob: Particle,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(cart -> bob, along = x)] slide: Sleeve,",
    ),
    (
        "inertia = none",
        "Kinematic",
        "#[joint(ground -> arm, about = y)] hinge: Pin,
        #[body] arm: Body,",
    ),
];

fn tokens((attribute, name, fields): (&str, &str, &str)) -> (TokenStream, TokenStream) {
    (attribute.parse().unwrap(), format!("pub struct {name} {{ {fields} }}").parse().unwrap())
}

/// Calls `f` with what a mechanism compiles to.
fn compiled<T>(mechanism: (&str, &str, &str), f: impl FnOnce(&Model<'_>, Facts, Output) -> T) -> T {
    let (attribute, item) = tokens(mechanism);
    let mut cx = Diagnostics::new();
    let source = read(attribute, item, Path::new(""), &mut cx).unwrap();
    let graph = Graph::new();
    let Some((model, output)) = compile(&source, &graph, &mut cx) else {
        panic!("{}: {:?}", mechanism.1, cx.messages());
    };
    f(&model, Facts::of(&model, source.mechanism.requests), output)
}

/// The public functions of the inherent implementations of a type, without those that only say what is missing.
fn public(text: &str, name: &str) -> BTreeSet<String> {
    let file = syn::parse_file(text).unwrap();
    let mut found = BTreeSet::new();
    for item in file.items {
        let syn::Item::Impl(item) = item else { continue };
        let own = matches!(&*item.self_ty, syn::Type::Path(path) if path.path.is_ident(name));
        let text = |tokens: &dyn quote::ToTokens| tokens.to_token_stream().to_string();
        if item.trait_.is_some() || !own || text(&item.generics.where_clause).contains("absent") {
            continue;
        }
        for member in item.items {
            if let syn::ImplItem::Fn(function) = member
                && matches!(function.vis, syn::Visibility::Public(_))
                && !function.sig.ident.to_string().starts_with("__")
            {
                assert!(
                    found.insert(function.sig.ident.to_string()),
                    "{name} has {} twice",
                    function.sig.ident
                );
            }
        }
    }
    found
}

/// What the catalogue says that such a mechanism has, its outputs included.
fn expected(facts: &Facts, outputs: &[String]) -> BTreeSet<String> {
    let rows = catalogue::rows().filter(|row| row.lacks(facts).is_none() && !row.is_hidden());
    let mut names: BTreeSet<String> = BTreeSet::new();
    for row in rows {
        names.insert(row.name.to_string());
        names.extend((facts.requests.batch && row.batched).then(|| format!("{}_lanes", row.name)));
    }
    for output in outputs {
        for (suffix, asked) in [
            ("", true),
            ("_jacobian", true),
            ("_derivatives", facts.requests.derivatives),
            ("_by_parameters", facts.requests.sensitivities),
        ] {
            names.extend(asked.then(|| format!("{output}{suffix}")));
            names.extend((asked && facts.requests.batch).then(|| format!("{output}{suffix}_lanes")));
        }
    }
    names
}

#[test]
fn every_function_is_a_row_and_every_row_a_function() {
    let mut seen = BTreeSet::new();
    for mechanism in MECHANISMS {
        let (attribute, item) = tokens(mechanism);
        let text = expand(attribute, item, Path::new("")).text;
        let (facts, outputs) = compiled(mechanism, |model, facts, _| {
            (facts, model.outputs.iter().map(|output| output.name.clone()).collect::<Vec<_>>())
        });
        let names = public(&text, mechanism.1);
        assert_eq!(names, expected(&facts, &outputs), "{}", mechanism.1);
        seen.extend(names);
    }
    let never: Vec<&str> = catalogue::rows()
        .filter(|row| !row.is_hidden() && !seen.contains(row.name))
        .map(|row| row.name)
        .collect();
    assert_eq!(never, Vec::<&str>::new(), "no mechanism here has these");
}

/// What is missing is named, each name once and with one reason.
#[test]
fn what_is_not_there_has_a_reason() {
    for mechanism in MECHANISMS {
        compiled(mechanism, |_, facts, _| {
            let present: BTreeSet<&str> =
                catalogue::rows().filter(|row| row.lacks(&facts).is_none()).map(|row| row.name).collect();
            let absent: Vec<&str> = catalogue::absent(&facts)
                .into_iter()
                .flat_map(|(_, rows)| rows)
                .map(|row| row.name)
                .collect();
            let names: BTreeSet<&str> = absent.iter().copied().collect();
            assert_eq!(names.len(), absent.len(), "{}: {absent:?}", mechanism.1);
            assert!(present.is_disjoint(&names), "{}", mechanism.1);
            let all: BTreeSet<&str> =
                catalogue::rows().filter(|row| !row.is_hidden()).map(|row| row.name).collect();
            let hidden: Vec<&&str> =
                all.iter().filter(|n| !present.contains(*n) && !names.contains(*n)).collect();
            assert_eq!(hidden, Vec::<&&str>::new(), "{}", mechanism.1);
        });
    }
}

/// A number too many or too few in the program of any function, of a link or of a frame does not go unnoticed.
#[test]
fn a_program_that_does_not_fit_is_found() {
    for mechanism in MECHANISMS {
        compiled(mechanism, |_, _, mut output| {
            assert_eq!(output.misfit(), None, "{}", mechanism.1);
            for k in 0..output.functions.len() {
                let Some(last) = output.functions[k].program.outputs.pop() else { continue };
                let name = output.functions[k].name.clone();
                assert_eq!(output.misfit(), Some(name.as_str()), "{}", mechanism.1);
                output.functions[k].program.outputs.push(last);
            }
            let last = output.links[0].columns.outputs.pop().unwrap();
            assert!(output.misfit().is_some(), "{}", mechanism.1);
            output.links[0].columns.outputs.push(last);
            output.frames[0].twist.outputs.pop();
            assert!(output.misfit().is_some(), "{}", mechanism.1);
        });
    }
}
