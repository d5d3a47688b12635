//! Units of the models and of the language reference: all mechanisms are accepted, and all are rejected after
//! a factor is added or removed.

use super::{Units, units_of_mechanism};
use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use quote::ToTokens;
use std::fs;
use std::path::Path;
use syn::{Item, ItemStruct, Meta};

/// Mechanism of a source file: the arguments of its attribute, and its struct.
struct Source {
    arguments: TokenStream,
    item: ItemStruct,
}

impl Source {
    fn unit_messages(&self) -> Vec<String> {
        self.units_of_source().err().unwrap_or_default()
    }

    /// Returns the parameters with the units at the end of their documentation, as in "Mass of the cart, kg."
    fn documented_units(&self) -> Vec<(String, String)> {
        let documented_unit = |f: &syn::Field| {
            let doc = f.attrs.iter().filter_map(|a| match &a.meta {
                Meta::NameValue(doc) if a.path().is_ident("doc") => {
                    Some(doc.value.to_token_stream().to_string())
                }
                _ => None,
            });
            let doc = doc.collect::<Vec<_>>().join(" ");
            let first = doc.trim_matches(['"', ' ']).split(['.', ':', ';']).next()?.to_string();
            let unit = first.split(", ").map(str::trim).find(|part| is_unit_text(part))?;
            Some((f.ident.as_ref()?.to_string(), unit.to_string()))
        };
        self.item.fields.iter().filter(|f| is_parameter(f)).filter_map(documented_unit).collect()
    }

    /// Returns a copy of the mechanism in which one occurrence of a parameter is replaced by another text.
    /// Returns `None` if there are fewer occurrences.
    fn with_replaced_parameter(&self, parameter: &str, occurrence: usize, by: &str) -> Option<Source> {
        let mut left = occurrence as isize;
        let by: TokenStream = by.parse().unwrap();
        let arguments = replace_occurrence(self.arguments.clone(), parameter, &by, &mut left);
        let mut item = self.item.clone();
        for attribute in item.fields.iter_mut().flat_map(|f| &mut f.attrs) {
            if let Meta::List(list) = &mut attribute.meta
                && !list.path.is_ident("unit")
            {
                list.tokens = replace_occurrence(list.tokens.clone(), parameter, &by, &mut left);
            }
        }
        (left < 0).then_some(Source { arguments, item })
    }

    /// Returns a copy of the mechanism that declares the unit of every parameter except one.
    fn with_declared_units(&self, units: &[String], except: &str) -> Source {
        let mut item = self.item.clone();
        for (field, unit) in item.fields.iter_mut().filter(|field| is_parameter(field)).zip(units) {
            let is_free =
                field.attrs.iter().all(|a| !a.path().is_ident("unit") && !a.path().is_ident("state"));
            if is_free && unit != "any" && field.ident.as_ref().is_some_and(|name| name != except) {
                let unit: TokenStream =
                    unit.replace('·', "*").replace('²', "2").replace('³', "3").parse().unwrap();
                field.attrs.push(syn::parse_quote!(#[unit(#unit)]));
            }
        }
        Source { arguments: self.arguments.clone(), item }
    }

    fn has_tables(&self) -> bool {
        self.item
            .fields
            .iter()
            .any(|f| matches!(&f.ty, syn::Type::Path(path) if path.path.segments[0].ident == "Table"))
    }

    /// Returns the parameters of the mechanism with their inferred units.
    fn parameters_with_units(&self) -> Vec<(String, String)> {
        let units =
            self.units_of_source().unwrap_or_else(|messages| panic!("{}: {messages:?}", self.item.ident));
        let fields = self.item.fields.iter().filter(|field| is_parameter(field));
        let fields = fields.map(|field| field.ident.as_ref().unwrap().to_string());
        fields.zip(units.parameters).collect()
    }

    fn units_of_source(&self) -> Result<Units, Vec<String>> {
        units_of_mechanism(&self.arguments.to_string(), &self.item.to_token_stream().to_string())
    }
}

/// Whether a field is a parameter or a first-order state.
fn is_parameter(field: &syn::Field) -> bool {
    matches!(&field.ty, syn::Type::Path(path) if path.path.is_ident("f64") || path.path.is_ident("State"))
}

fn is_unit_text(text: &str) -> bool {
    let words = text.split(['/', '·', '(', ')']).map(|w| w.trim_end_matches(['²', '³']));
    !text.is_empty()
        && words.filter(|w| !w.is_empty()).all(|w| ["m", "kg", "s", "rad", "N", "J", "1"].contains(&w))
}

/// Replaces the occurrence of a parameter with the index `left`. Keys and members with its name do not count.
fn replace_occurrence(
    tokens: TokenStream,
    parameter: &str,
    by: &TokenStream,
    left: &mut isize,
) -> TokenStream {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let is_punctuation_at =
        |k: usize, c: char| matches!(tokens.get(k), Some(TokenTree::Punct(p)) if p.as_char() == c);
    let mut new = TokenStream::new();
    for (k, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Group(group) => {
                let inner = replace_occurrence(group.stream(), parameter, by, left);
                new.extend([TokenTree::from(Group::new(group.delimiter(), inner))]);
            }
            TokenTree::Ident(i)
                if i == parameter
                    && !is_punctuation_at(k + 1, '=')
                    && !(k > 0 && is_punctuation_at(k - 1, '.')) =>
            {
                match *left {
                    0 => new.extend([TokenTree::from(Group::new(Delimiter::Parenthesis, by.clone()))]),
                    _ => new.extend([token.clone()]),
                }
                *left -= 1;
            }
            _ => new.extend([token.clone()]),
        }
    }
    new
}

/// Returns all mechanisms that a source file contains.
fn mechanisms_of_file(text: &str) -> Vec<Source> {
    let found = syn::parse_file(text).unwrap().items.into_iter().filter_map(|item| {
        let Item::Struct(mut item) = item else { return None };
        let at = item.attrs.iter().position(|a| a.path().is_ident("mechanism"))?;
        let arguments = match item.attrs.remove(at).meta {
            Meta::List(list) => list.tokens,
            _ => TokenStream::new(),
        };
        item.attrs.clear();
        Some(Source { arguments, item })
    });
    found.collect()
}

/// Returns the mechanisms in the folder of models that have parameters.
fn gallery_mechanisms() -> Vec<Source> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/src");
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let all = paths
        .iter()
        .filter(|path| path.is_file())
        .flat_map(|path| mechanisms_of_file(&fs::read_to_string(path).unwrap()));
    all.filter(|source| !source.documented_units().is_empty()).collect()
}

/// Checks that inferred units of parameters equal those in their documentation.
#[test]
fn inferred_units_equal_those_in_the_documentation() {
    let mut compared = 0;
    for source in gallery_mechanisms() {
        let found = source.parameters_with_units();
        for (parameter, written) in source.documented_units() {
            let (_, inferred) = found.iter().find(|(p, _)| *p == parameter).unwrap();
            let same = inferred == "any" || exponents_of_unit(&written) == exponents_of_unit(inferred);
            assert!(same, "{}.{parameter}: {written} and {inferred}", source.item.ident);
            compared += 1;
        }
    }
    assert!(compared > 30, "{compared} units");
}

/// Returns the exponents of m, kg and s in a unit.
fn exponents_of_unit(unit: &str) -> [i32; 3] {
    let mut sum = [0; 3];
    let (mut sign, mut inside) = (1, 1);
    let mut word = String::new();
    let mut add_exponents_of_word = |word: &mut String, sign: i32| {
        let power = if word.ends_with('²') {
            2
        } else if word.ends_with('³') {
            3
        } else {
            1
        };
        let of = match word.trim_end_matches(['²', '³']) {
            "m" => [1, 0, 0],
            "kg" => [0, 1, 0],
            "s" => [0, 0, 1],
            "N" => [1, 1, -2],
            "J" => [2, 1, -2],
            "W" => [2, 1, -3],
            _ => [0; 3],
        };
        (0..3).for_each(|k| sum[k] += sign * power * of[k]);
        word.clear();
    };
    for c in unit.chars() {
        match c {
            '/' | '·' | '(' | ')' => {
                add_exponents_of_word(&mut word, sign);
                match c {
                    '(' => inside = sign,
                    ')' => inside = 1,
                    _ => sign = if c == '/' { -1 } else { inside },
                }
            }
            _ => word.push(c),
        }
    }
    add_exponents_of_word(&mut word, sign);
    sum
}

/// Replaces each occurrence of each parameter that has a unit, and checks that the mechanism is rejected.
/// Returns the number of rejected mechanisms.
fn check_replaced_parameters_rejected(text: impl Fn(&str) -> String, itself: bool) -> usize {
    let mut refused = 0;
    // Tables accept any unit, and so do the factors of their values.
    for source in gallery_mechanisms().into_iter().filter(|source| !source.has_tables()) {
        let parameters = source.parameters_with_units();
        let units: Vec<String> = parameters.iter().map(|(_, unit)| unit.clone()).collect();
        for (parameter, unit) in
            parameters.iter().filter(|(_, unit)| unit != "any" && exponents_of_unit(unit) != [0; 3])
        {
            let pinned = source.with_declared_units(&units, if itself { "" } else { parameter });
            assert_eq!(pinned.unit_messages(), Vec::<String>::new(), "{}", source.item.ident);
            // The only use of a parameter determines its unit.
            if !itself && source.with_replaced_parameter(parameter, 1, parameter).is_none() {
                continue;
            }
            for k in 0.. {
                let Some(changed) = pinned.with_replaced_parameter(parameter, k, &text(parameter)) else {
                    break;
                };
                let messages = changed.unit_messages();
                let what = format!("{}: `{}` at {k}", source.item.ident, text(parameter));
                assert!(is_rejected_for(&messages, parameter), "{what} ({unit}): {messages:?}");
                refused += 1;
            }
        }
    }
    refused
}

#[test]
fn additional_unit_factors_are_rejected() {
    let refused = check_replaced_parameters_rejected(|p| format!("{p} * {p}"), false);
    assert!(refused > 15, "{refused} mistakes");
}

/// The ratio of a parameter to itself removes the factor while the parameter is still used.
#[test]
fn missing_unit_factors_are_rejected() {
    let refused = check_replaced_parameters_rejected(|p| format!("{p} / {p}"), true);
    assert!(refused > 40, "{refused} mistakes");
}

/// Whether an error message names the parameter, another parameter whose unit follows from it, or the
/// definition that may contain it. Earlier checks reject an asymmetric inertia matrix, and a loop that a
/// wrong length locks.
fn is_rejected_for(messages: &[String], parameter: &str) -> bool {
    let parameter = format!("`{parameter}`");
    let others = [
        "` becomes ",
        "is declared as",
        "a factor is missing here or in `",
        "an inertia matrix is symmetric",
        "this mechanism cannot move",
    ];
    messages.iter().any(|m| m.contains(&parameter) || others.iter().any(|other| m.contains(other)))
}

/// Examples of the language reference that are compiled are accepted.
#[test]
fn examples_of_the_language_page_are_accepted() {
    for (name, arguments, fields, expected) in PAGE {
        let found = units_of_mechanism(arguments, &format!("struct {name} {{ {fields} }}"));
        let found = found.unwrap_or_else(|messages| panic!("{name}: {messages:?}"));
        assert_eq!(found.parameters.join(" "), *expected, "{name}");
    }
}

const PAGE: &[(&str, &str, &str, &str)] = &[
    (
        "DoublePendulum",
        "gravity = -g * y",
        "g: f64, m1: f64, m2: f64, l1: f64, l2: f64,
        #[body(mass = m1, com = -l1 / 2 * y, inertia = rod(m1, l1, y))] upper: Body,
        #[body(mass = m2, com = -l2 / 2 * y, inertia = rod(m2, l2, y))] lower: Body,
        #[joint(ground -> upper, about = z)] shoulder: Pin,
        #[joint(upper.at(-l1 * y) -> lower, about = z)] elbow: Pin,",
        "m/s² kg kg m m",
    ),
    (
        "BeadOnSpinningHoop",
        "gravity = -g * z",
        "g: f64, m: f64, radius: f64, spin: f64, theta: Coordinate,
        #[frame(ground, z(spin * t))] hoop: Frame,
        #[particle(mass = m, at = radius * (sin(theta) * hoop.x - cos(theta) * hoop.z))] bead: Particle,",
        "m/s² kg m 1/s",
    ),
    (
        "TunedSuspension",
        "",
        "m1: f64, m2: f64, k1: f64, k2: f64, c: f64, b: f64,
        #[body(mass = m1)] first: Body, #[body(mass = m2)] second: Body,
        #[joint(ground -> first, along = x)] rail: Sleeve,
        #[joint(ground -> second, along = x)] rail2: Sleeve,
        #[acts(between = (ground, first), stiffness = k1, free_length = 0)] anchor: Spring,
        #[acts(between = (first, second), stiffness = k2, free_length = 0)] coil: Spring,
        #[acts(between = (first, second), damping = c)] damper: Dashpot,
        #[acts(between = (first, second), inertance = b)] inerter: Inerter,",
        "kg kg N/m N/m N·s/m kg",
    ),
    (
        "SliderCrank",
        "gravity = -9.81 * y",
        "r: f64, l: f64, m_crank: f64, m_rod: f64, m_piston: f64,
        #[body(mass = m_crank, com = r / 2 * x, inertia = rod(m_crank, r, x))] crank: Body,
        #[body(mass = m_rod, com = l / 2 * x, inertia = rod(m_rod, l, x))] rod: Body,
        #[body(mass = m_piston)] piston: Body,
        #[joint(ground -> crank, about = z)] main: Pin,
        #[joint(crank.at(r * x) -> rod, about = z)] big_end: Pin,
        #[joint(ground -> piston, along = x)] cylinder: Sleeve,
        #[joint(rod.at(l * x) -> piston, about = z)] small_end: Pin,
        #[acts(on = main)] motor: Torque,",
        "m m kg kg kg",
    ),
    (
        "RollingDisk",
        "gravity = -g * z",
        "g: f64, m: f64, radius: f64,
        #[body(mass = m, inertia = disk(m, radius, y))] disk: Body,
        #[joint(ground -> disk)] pose: Free,
        #[constraint(rolls(disk.circle(radius, y), ground.plane(z)))] contact: Rolling,",
        "m/s² kg m",
    ),
    (
        "Aircraft",
        "gravity = 9.81 * z",
        "m: f64, ixx: f64, iyy: f64, izz: f64, ixz: f64,
        rho: f64, #[unit(m2)] area: f64, #[unit(m)] chord: f64,
        #[unit(1)] cl0: f64, cl_alpha: f64, cm_elevator: f64,
        elevator: Input,
        #[body(mass = m, inertia = [[ixx, 0, ixz], [0, iyy, 0], [ixz, 0, izz]])] airframe: Body,
        #[joint(ground -> airframe)] flight: Free,
        #[define(v(airframe / ground / ground))] velocity: Vector,
        #[define(atan2(dot(velocity, airframe.z), dot(velocity, airframe.x)))] alpha: Scalar,
        #[define(rho / 2 * dot(velocity, velocity))] pressure: Scalar,
        #[acts(on = airframe, value = pressure * area * (cl0 + cl_alpha * alpha) * (sin(alpha) * airframe.x \
            - cos(alpha) * airframe.z))]
        lift: Force,
        #[acts(on = airframe, value = pressure * area * chord * cm_elevator * elevator * airframe.y)] pitch: \
            Torque,
        #[output(alpha)] angle_of_attack: Scalar,",
        "kg kg·m² kg·m² kg·m² kg·m² kg/m³ m² m 1 1 any",
    ),
];
