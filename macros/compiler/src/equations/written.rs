//! Formats equations of motion as plain text, LaTeX and MathML, with the user's names.

use super::{CanonicalEquations, EquationsOfMotion, determinant_symbol};
use crate::diag::join_names_with_and;
use crate::equations::print::aligned::format_aligned;
use crate::equations::print::mathml::format_equations_as_html;
use crate::equations::print::names::{TypesetNames, name_with_primes};
use crate::equations::print::{Latex, MathMl, Plain, PolynomialWriter, PrintedEquations, Style, wrap_text};
use crate::expr::Symbol;
use crate::mechanism::{Chart, Model, Quantity, SuppliedQuantity};

/// Maximum number of columns of equations in the text.
const WIDTH: usize = 100;
/// Maximum number of columns of sentences: the width of rustdoc's pages.
const PAGE: usize = 92;

/// Formats equations of motion as plain text, LaTeX and MathML.
pub fn format_equations(model: &Model<'_>, equations: &EquationsOfMotion) -> PrintedEquations {
    let rates = coordinate_rate_velocity_flags(model);
    let (latex, mathml) = typeset_equations(model, equations, &rates);
    PrintedEquations { plain: plain_text_of_equations(model, equations, &rates), latex, mathml }
}

/// Printed lines: the Lagrangian, and the left and right side of the equation of every velocity.
struct LagrangeLines {
    /// Joint velocities in terms of declared generalized speeds, with their indices.
    rates: Vec<(usize, String)>,
    lagrangian: String,
    motion: Vec<(String, String)>,
}

impl LagrangeLines {
    fn new<S: Style>(equations: &EquationsOfMotion, style: S) -> LagrangeLines {
        let writer = PolynomialWriter::new_with_style(&equations.ring, style);
        let sides = equations.motion.iter().zip(&equations.forces);
        LagrangeLines {
            rates: equations.rates.iter().map(|(k, p)| (*k, writer.format_polynomial(p))).collect(),
            lagrangian: writer.format_energy(&equations.lagrangian),
            motion: sides.map(|(a, b)| (writer.format_polynomial(a), writer.format_polynomial(b))).collect(),
        }
    }

    /// Returns the printed equations: the Lagrangian, the joint velocities in terms of generalized speeds,
    /// and the equations of motion. `lagrangian` is the symbol of the Lagrangian, and `left(k)` that of joint
    /// velocity `k`.
    fn lagrangian_and_equation_lines(&self, lagrangian: &str, left: &dyn Fn(usize) -> String) -> Vec<String> {
        let mut all = vec![format!("{lagrangian} = {}", self.lagrangian)];
        all.extend(self.rates.iter().map(|(k, rate)| format!("{} = {rate}", left(*k))));
        all.extend(self.motion.iter().map(|(motion, force)| format!("{motion} = {force}")));
        all
    }
}

/// Returns the plain text: the Lagrangian, an equation for every velocity, and a legend.
fn plain_text_of_equations(model: &Model<'_>, equations: &EquationsOfMotion, rates: &[bool]) -> String {
    let primed_name = |symbol| name_with_primes(name_and_derivative_order(model, rates, symbol));
    let lines = LagrangeLines::new(equations, Plain { name: &primed_name });
    let wrapped_line = |text: &str| wrap_text(text, WIDTH, "    ") + "\n";
    let energy = if equations.without_forces { 'T' } else { 'L' };
    let mut out = wrapped_line(&format!("{energy} = {}", lines.lagrangian));
    out.push('\n');
    for (k, rate) in &lines.rates {
        out +=
            &wrapped_line(&format!("{} = {rate}", name_with_primes(joint_velocity_name_and_dots(model, *k))));
    }
    out.push_str(if lines.rates.is_empty() { "" } else { "\n" });
    for (motion, force) in lines.motion {
        out += &wrapped_line(&format!("{motion} = {force}"));
    }
    out.push('\n');
    legend_sentences(model, equations.without_forces, rates)
        .iter()
        .fold(out, |out, sentence| out + &wrap_at_page_width(sentence) + "\n")
}

/// Formats the canonical equations as plain text, LaTeX and MathML.
pub fn format_canonical_equations(model: &Model<'_>, canonical: &CanonicalEquations) -> PrintedEquations {
    let rates = coordinate_rate_velocity_flags(model);
    let name_of_momentum = |k: usize| format!("p_{}", model.velocities[k].0);
    let momenta: Vec<String> = (0..model.nv()).map(name_of_momentum).collect();
    let determinants = determinant_names(model, canonical.determinants.len());
    let all = typeset_names_with_extra_names(model, &[momenta.clone(), determinants.clone()].concat());
    // Accelerations do not occur: their symbols represent the rates of the momenta.
    let symbol_name_and_derivative_order = |symbol| match Quantity::from_symbol(symbol) {
        Quantity::Momentum(k) => (momenta[k].clone(), 0),
        Quantity::Acceleration(k) => (momenta[k].clone(), 1),
        Quantity::Prepared(k) => (determinants[k].clone(), 0),
        _ => name_and_derivative_order(model, &rates, symbol),
    };
    let primed_name = |symbol| name_with_primes(symbol_name_and_derivative_order(symbol));
    let typeset_name_and_dots = |symbol| {
        let (name, dots) = symbol_name_and_derivative_order(symbol);
        (all.typeset_name(&name), dots)
    };
    let lines = canonical_lines(canonical, Plain { name: &primed_name });
    let wrapped_line = |text: &String| wrap_text(text, WIDTH, "    ") + "\n";
    let mut plain = wrapped_line(&format!("H = {}", lines[0])) + "\n";
    plain.extend(lines[1..].iter().map(wrapped_line));
    let mut about = "H is the Hamiltonian; p_ before the name of a velocity makes its generalized momentum, \
                     and a prime marks a rate."
        .to_string();
    about += &determinants_sentence(&determinants);
    plain = plain + "\n" + &wrap_at_page_width(&about) + "\n";
    let mut lines = canonical_lines(canonical, Latex { name: &typeset_name_and_dots });
    lines[0] = format!("\\mathcal{{H}} = {}", lines[0]);
    let latex = format_aligned(&lines);
    lines = canonical_lines(canonical, MathMl { name: &typeset_name_and_dots });
    lines[0] = format!("<mi>H</mi> = {}", lines[0]);
    PrintedEquations { plain, latex, mathml: format_equations_as_html(&lines) }
}

/// Returns a name for a generalized force that no other symbol has.
fn force_name(model: &Model<'_>, k: usize) -> String {
    format!("{}{}", unused_name_prefix(model, 'Q'), k + 1)
}

/// Returns a letter, repeated until no name of a parameter or coordinate begins with it.
fn unused_name_prefix(model: &Model<'_>, letter: char) -> String {
    let mut found = letter.to_string();
    while model.parameters.iter().chain(&model.configuration).any(|name| name.starts_with(&found)) {
        found.push(letter);
    }
    found
}

/// Returns names for determinants that no quantity of the model has.
pub(super) fn determinant_names(model: &Model<'_>, count: usize) -> Vec<String> {
    let letter = unused_name_prefix(model, 'D');
    if count == 1 { vec![letter] } else { (1..=count).map(|k| format!("{letter}{k}")).collect() }
}

/// Returns a sentence that explains the determinants, or an empty text without determinants.
pub(super) fn determinants_sentence(determinants: &[String]) -> String {
    match determinants {
        [] => String::new(),
        [one] => format!(" {one} is an inertia, of coupled coordinates its determinant."),
        all => {
            format!(" {} are inertias, of coupled coordinates their determinants.", join_names_with_and(all))
        }
    }
}

/// Returns the right side of the Hamiltonian, then equations for the rates of coordinates and of momenta,
/// then for determinants.
fn canonical_lines<S: Style + Copy>(canonical: &CanonicalEquations, style: S) -> Vec<String> {
    let writer = PolynomialWriter::new_with_style(&canonical.ring, style);
    let mut lines = vec![writer.format_energy(&canonical.hamiltonian)];
    let velocities = (0..).map(Quantity::Velocity).zip(&canonical.velocity);
    let momenta = (0..).map(Quantity::Acceleration).zip(&canonical.momentum_rate);
    let determinants = (0..).map(determinant_symbol).zip(&canonical.determinants);
    for (left, right) in velocities.chain(momenta).chain(determinants) {
        lines.push(format!(
            "{} = {}",
            style.format_symbol_power(left.symbol(), 1),
            writer.format_polynomial(right)
        ));
    }
    lines
}

/// Wraps sentences at the width of a page.
pub(super) fn wrap_at_page_width(text: &str) -> String {
    let (mut out, mut room) = (String::new(), 0);
    for word in text.split(' ') {
        let length = word.chars().count();
        if out.is_empty() || length < room {
            room = if out.is_empty() { PAGE } else { room - 1 };
            out.push_str(if out.is_empty() { "" } else { " " });
        } else {
            room = PAGE;
            out.push('\n');
        }
        out.push_str(word);
        room = room.saturating_sub(length);
    }
    out
}

/// Returns the Lagrangian and an equation for every velocity, as LaTeX and as HTML.
fn typeset_equations(model: &Model<'_>, equations: &EquationsOfMotion, rates: &[bool]) -> (String, String) {
    let names = typeset_names(model);
    let typeset_name_and_dots = |symbol| {
        let (name, dots) = name_and_derivative_order(model, rates, symbol);
        (names.typeset_name(&name), dots)
    };
    let typeset_joint_velocity_and_dots = |k: usize| {
        let (name, dots) = joint_velocity_name_and_dots(model, k);
        (names.typeset_name(&name), dots)
    };
    let (energy, of_mathml) = match equations.without_forces {
        true => ("T", "<mi>T</mi>"),
        false => ("\\mathcal{L}", "<mi>L</mi>"),
    };
    let latex = LagrangeLines::new(equations, Latex { name: &typeset_name_and_dots })
        .lagrangian_and_equation_lines(energy, &|k| {
            Latex { name: &|_| typeset_joint_velocity_and_dots(k) }
                .format_symbol_power(Quantity::Velocity(k).symbol(), 1)
        });
    let mathml = LagrangeLines::new(equations, MathMl { name: &typeset_name_and_dots })
        .lagrangian_and_equation_lines(of_mathml, &|k| {
            MathMl { name: &|_| typeset_joint_velocity_and_dots(k) }
                .format_symbol_power(Quantity::Velocity(k).symbol(), 1)
        });
    (format_aligned(&latex), format_equations_as_html(&mathml))
}

/// Returns the typeset names of all symbols of a mechanism, which are unambiguous.
fn typeset_names(model: &Model<'_>) -> TypesetNames {
    typeset_names_with_extra_names(model, &[])
}

/// Returns the typeset names of all symbols of a mechanism and of other names, which are unambiguous.
pub(super) fn typeset_names_with_extra_names(model: &Model<'_>, others: &[String]) -> TypesetNames {
    let velocities =
        model.velocities.iter().chain(model.speeds.iter().flat_map(|s| &s.velocities)).map(|(name, _)| name);
    let inputs = model.inputs.iter().map(|(name, _)| name);
    let multipliers: Vec<String> = (1..=model.constraints.len()).map(|k| format!("lambda{k}")).collect();
    let names = model.parameters.iter().chain(&model.configuration).chain(velocities).chain(inputs);
    TypesetNames::new(names.chain(&multipliers).chain(others).map(String::as_str))
}

/// Returns for each velocity whether it is the rate of a coordinate of the same name.
pub(super) fn coordinate_rate_velocity_flags(model: &Model<'_>) -> Vec<bool> {
    let mut rates = vec![false; model.nv()];
    for chart in &model.charts {
        if let Chart::Plain(q, v) = chart {
            rates[v.0] = model.configuration[q.0] == model.velocities[v.0].0;
        }
    }
    rates
}

/// Returns the name under which joint velocity `k` is printed, with the number of dots: its own name and
/// zero, or the name of the coordinate whose rate it is and one.
pub(super) fn joint_velocity_name_and_dots(model: &Model<'_>, k: usize) -> (String, u8) {
    let name = model.speeds.as_ref().map_or("", |speeds| &speeds.velocities[k].0);
    let is_rate = model.charts.iter().any(|chart| match chart {
        Chart::Plain(q, v) => v.0 == k && model.configuration[q.0] == name,
        _ => false,
    });
    (name.to_string(), u8::from(is_rate))
}

/// Returns the name of a symbol, and how often the quantity of this name is differentiated.
pub(super) fn name_and_derivative_order(model: &Model<'_>, rates: &[bool], symbol: Symbol) -> (String, u8) {
    match Quantity::from_symbol(symbol) {
        Quantity::Parameter(k) => (model.parameters[k].clone(), 0),
        Quantity::Configuration(k) => (model.configuration[k].clone(), 0),
        Quantity::Velocity(k) => (model.velocities[k].0.clone(), u8::from(rates.get(k) == Some(&true))),
        Quantity::Acceleration(k) => {
            (model.velocities[k].0.clone(), 1 + u8::from(rates.get(k) == Some(&true)))
        }
        Quantity::Input(k) => (model.inputs[k].0.clone(), 0),
        Quantity::Time => ("t".to_string(), 0),
        Quantity::Force(k) => (force_name(model, k), 0),
        Quantity::Given(SuppliedQuantity::Multiplier, k) => (format!("lambda{}", k + 1), 0),
        _ => (format!("s{}", symbol.0), 0),
    }
}

/// Returns the sentences of the legend that explain the notation of the equations.
fn legend_sentences(model: &Model<'_>, without_forces: bool, rates: &[bool]) -> Vec<String> {
    let energy = if without_forces { "T is kinetic energy" } else { "L is kinetic less potential energy" };
    let rates = match rates.iter().position(|is_rate| *is_rate) {
        Some(k) => {
            let x = &model.velocities[k].0;
            format!("{energy}; {x}' and {x}'' are the first and second rates of {x}.")
        }
        None => {
            let w = &model.velocities[0].0;
            format!("{energy}; {w}' is the rate of {w}.")
        }
    };
    let speeds = model.speeds.as_ref().map(|speeds| {
        let names: Vec<String> = speeds.replaced.iter().map(|k| model.velocities[k.0].0.clone()).collect();
        match names.as_slice() {
            [one] => {
                format!("{one} is a generalized speed, from which a rate follows; its equation is Kane's.")
            }
            all => format!(
                "{} are generalized speeds, from which rates follow; their equations are Kane's.",
                join_names_with_and(all)
            ),
        }
    });
    let constraints: Vec<String> = model.constraints.iter().map(|c| c.name.clone()).collect();
    let multipliers: Vec<String> = (1..=constraints.len()).map(|k| format!("lambda{k}")).collect();
    let multipliers = match constraints.as_slice() {
        [] => None,
        [one] => Some(format!("lambda1 is the multiplier of the constraint {one}.")),
        all => {
            let (multipliers, all) = (join_names_with_and(&multipliers), join_names_with_and(all));
            Some(format!("{multipliers} are the multipliers of the constraints {all}, in this order."))
        }
    };
    let forces = without_forces.then(|| {
        let names: Vec<String> = (0..model.nv()).map(|k| force_name(model, k)).collect();
        let (are, terms) = match names.as_slice() {
            [_] => ("is the generalized force", "its terms"),
            _ => ("are the generalized forces", "their terms"),
        };
        format!(
            "{} {are} of gravity, force elements and inputs; {terms} are too many to be readable. The option \
             `equations = lagrange` of `#[mechanism]` prints up to some thousand.",
            join_names_with_and(&names)
        )
    });
    std::iter::once(rates).chain(speeds).chain(multipliers).chain(forces).collect()
}
