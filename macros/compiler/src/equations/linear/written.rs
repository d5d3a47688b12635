//! Formats linear equations as plain text, LaTeX and MathML, with the user's names.

use super::super::written::{
    coordinate_rate_velocity_flags, name_and_derivative_order as name_of, typeset_names_with_extra_names,
    wrap_at_page_width,
};
use super::LinearisedEquations;
use super::parts::{ROOT, multiplier_symbol};
use super::stability::{Stability, StabilityVerdict};
use crate::algebra::polynomial::{Atom, Monomial, Polynomial, Term};
use crate::diag::join_names_with_and;
use crate::equations::print::aligned::format_aligned;
use crate::equations::print::mathml::format_equations_as_html;
use crate::equations::print::names::name_with_primes;
use crate::equations::print::{Latex, MathMl, Plain, PolynomialWriter, PrintedEquations, Style, wrap_text};
use crate::expr::Symbol;
use crate::mechanism::{Chart, Equilibrium, Model, Quantity};

/// Maximum number of columns of equations in the text.
const WIDTH: usize = 100;
/// Names for the roots of the characteristic polynomial, in order of preference.
const ROOTS: [&str; 4] = ["s", "r", "sigma", "root"];
/// Names for the natural frequency, in order of preference.
const FREQUENCIES: [&str; 3] = ["omega", "omega_n", "frequency"];

/// Names of all symbols that occur in linear equations.
struct SymbolNames<'a, 'g> {
    model: &'a Model<'g>,
    at: &'a Equilibrium<'g>,
    /// Name of the deviation that belongs to each velocity.
    deviations: Vec<String>,
    root: String,
    frequency: String,
}

impl<'a, 'g> SymbolNames<'a, 'g> {
    fn new(model: &'a Model<'g>, at: &'a Equilibrium<'g>) -> SymbolNames<'a, 'g> {
        let first_unused_word = |choices: &[&str]| {
            let is_model_name = |word: &str| {
                let velocities = model.velocities.iter().map(|(name, _)| name);
                let inputs = model.inputs.iter().map(|(name, _)| name);
                let mut all =
                    model.parameters.iter().chain(&model.configuration).chain(velocities).chain(inputs);
                all.any(|name| name == word)
            };
            let found = choices.iter().find(|word| !is_model_name(word));
            found.or(choices.last()).map_or_else(String::new, ToString::to_string)
        };
        SymbolNames {
            model,
            at,
            deviations: deviation_names(model),
            root: first_unused_word(&ROOTS),
            frequency: first_unused_word(&FREQUENCIES),
        }
    }

    /// Returns the name of a symbol, and how often the quantity of this name is differentiated.
    fn name_and_derivative_order(&self, symbol: Symbol) -> (String, u8) {
        let nv = self.deviations.len();
        let state_name = |k: usize| {
            let state =
                self.at.states.get(k - nv).and_then(|state| self.model.parameters.get(state.parameter));
            state.cloned().unwrap_or_default()
        };
        let deviation_name = |k: usize| self.deviations.get(k).cloned().unwrap_or_else(|| state_name(k));
        match Quantity::from_symbol(symbol) {
            Quantity::Deviation(k) => (deviation_name(k), 0),
            Quantity::Velocity(k) => (deviation_name(k), 1),
            Quantity::Acceleration(k) => (deviation_name(k), 2),
            Quantity::Force(k) => (format!("lambda{}", k + 1), 0),
            Quantity::Laplace => (self.root.clone(), 0),
            _ => name_of(self.model, &[], symbol),
        }
    }
}

/// Returns for each velocity the name of the deviation whose rate it is: the name of the coordinate, or names
/// for a small displacement and a small rotation in body axes.
fn deviation_names(model: &Model<'_>) -> Vec<String> {
    let mut names: Vec<String> = model.velocities.iter().map(|(name, _)| name.clone()).collect();
    let joint_prefix =
        |name: &str| name.rsplit_once('.').map_or(String::new(), |(joint, _)| format!("{joint}."));
    for chart in &model.charts {
        let (first, members): (usize, &[&str]) = match chart {
            Chart::Plain(q, v) => {
                names[v.0].clone_from(&model.configuration[q.0]);
                continue;
            }
            Chart::Ball(_, v) => (v.0, &["rx", "ry", "rz"]),
            Chart::Free(_, v) => (v.0, &["dx", "dy", "dz", "rx", "ry", "rz"]),
        };
        let joint = joint_prefix(&names[first]);
        for (k, member) in members.iter().enumerate() {
            names[first + k] = format!("{joint}{member}");
        }
    }
    names
}

/// Printed linear equations in one style.
struct LinearLines {
    /// Left and right side of every linear equation.
    equations: Vec<(String, String)>,
    /// Names and values of the quantities that are not zero at the equilibrium.
    values: Vec<(String, String)>,
    polynomial: Option<String>,
    frequency: Option<String>,
    conditions: Vec<String>,
}

impl LinearLines {
    fn new<S: Style + Copy>(linear: &LinearisedEquations, style: S) -> LinearLines {
        let writer = PolynomialWriter::new_with_style(&linear.ring, style);
        let sides = linear.motion.iter().zip(&linear.forces);
        let values = linear.values.iter();
        let stability = linear.stability.as_ref();
        let characteristic_polynomial_text = |stability: &Stability| {
            Some(
                PolynomialWriter::new_with_style(&stability.ring, style)
                    .format_linear_form(&characteristic_polynomial_in_root(stability)?),
            )
        };
        let format_stability_conditions = |stability: &Stability| match &stability.verdict {
            StabilityVerdict::Asymptotic(all) | StabilityVerdict::Oscillation(all) => {
                let writer = PolynomialWriter::new_with_style(&stability.ring, style);
                all.iter().map(|condition| writer.format_polynomial(condition)).collect()
            }
            _ => Vec::new(),
        };
        let frequency = stability.and_then(|stability| {
            let frequency = stability.frequency.as_ref()?;
            Some(PolynomialWriter::new_with_style(&stability.ring, style).format_polynomial(frequency))
        });
        LinearLines {
            equations: sides
                .map(|(a, b)| (writer.format_linear_form(a), writer.format_linear_form(b)))
                .collect(),
            values: values
                .map(|(what, p)| (style.format_symbol_power(what.symbol(), 1), writer.format_polynomial(p)))
                .collect(),
            polynomial: stability.and_then(characteristic_polynomial_text),
            frequency,
            conditions: stability.map(format_stability_conditions).unwrap_or_default(),
        }
    }
}

/// Returns the characteristic polynomial as one polynomial in its root; `None` if a power of it is too high.
fn characteristic_polynomial_in_root(stability: &Stability) -> Option<Polynomial> {
    let root = stability.ring.atoms.iter().position(|atom| *atom == Atom::Symbol(ROOT.symbol()));
    let root = root.map_or(Monomial::ONE, Monomial::first_power_of_atom);
    let mut terms: Vec<Term> = Vec::new();
    let mut power = Monomial::ONE;
    for (k, coefficient) in stability.coefficients.iter().enumerate() {
        if k > 0 {
            power = power.checked_product(root)?;
        }
        for t in &coefficient.terms {
            terms.push(Term { monomial: t.monomial.checked_product(power)?, ..*t });
        }
    }
    Some(Polynomial::sum_of_terms(terms))
}

/// Formats linear equations as plain text, LaTeX and MathML.
pub fn format_linear_equations(
    model: &Model<'_>,
    at: &Equilibrium<'_>,
    linear: &LinearisedEquations,
) -> PrintedEquations {
    let words = SymbolNames::new(model, at);
    let primed_name = |symbol| name_with_primes(words.name_and_derivative_order(symbol));
    let plain =
        plain_text_of_equations(&words, linear, &LinearLines::new(linear, Plain { name: &primed_name }));
    let mut others = words.deviations.clone();
    others.extend([words.root.clone(), words.frequency.clone()]);
    let names = typeset_names_with_extra_names(model, &others);
    let typeset_name_and_dots = |symbol| {
        let (name, dots) = words.name_and_derivative_order(symbol);
        (names.typeset_name(&name), dots)
    };
    let lines = LinearLines::new(linear, Latex { name: &typeset_name_and_dots });
    let spell_in_latex =
        |word: &str| crate::equations::print::latex::format_name(&names.typeset_name(word), 0);
    let latex = format_aligned(&printed_equations(&lines, &spell_in_latex(&words.frequency)));
    let frequency = crate::equations::print::mathml::format_name(&names.typeset_name(&words.frequency), 0, 1);
    let mathml = format_equations_as_html(&printed_equations(
        &LinearLines::new(linear, MathMl { name: &typeset_name_and_dots }),
        &frequency,
    ));
    PrintedEquations { plain, latex, mathml }
}

fn plain_text_of_equations(
    words: &SymbolNames<'_, '_>,
    linear: &LinearisedEquations,
    lines: &LinearLines,
) -> String {
    let wrapped_line = |text: &str| wrap_text(text, WIDTH, "    ") + "\n";
    let values: Vec<String> = lines.values.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let header = match values.as_slice() {
        [] => format!("{}: all coordinates and inputs at zero.", words.at.name),
        all => format!("{}: {}; other values are zero.", words.at.name, all.join(", ")),
    };
    let mut out = wrap_at_page_width(&header) + "\n\n";
    out.extend(lines.equations.iter().map(|(motion, force)| wrapped_line(&format!("{motion} = {force}"))));
    out.push('\n');
    if let (Some(stability), Some(polynomial)) = (&linear.stability, &lines.polynomial) {
        out += &(wrap_at_page_width(&characteristic_equation_sentence(words, stability)) + "\n");
        out += &wrapped_line(&format!("    {polynomial} = 0"));
        if let Some(frequency) = &lines.frequency {
            out += &format!("Natural frequency, rad/s:\n    {} = {frequency}\n", words.frequency);
        }
        out += &(wrap_at_page_width(verdict_sentence(stability)) + "\n");
        out.extend(lines.conditions.iter().map(|condition| wrapped_line(&format!("    {condition} > 0"))));
        if stability.zeros > 0 {
            out += &(wrap_at_page_width(&zero_roots_sentence(words, stability)) + "\n");
        }
        out.push('\n');
    }
    out + &legend_sentences(words) + "\n"
}

/// Returns the sentence that introduces the characteristic equation.
fn characteristic_equation_sentence(words: &SymbolNames<'_, '_>, stability: &Stability) -> String {
    let root = &words.root;
    let divided: Vec<String> =
        stability.divided.iter().map(|s| words.name_and_derivative_order(*s).0).collect();
    match divided.is_empty() {
        true => format!("Motions like exp({root} t), with the roots {root} of"),
        false => {
            let all = join_names_with_and(&divided);
            format!(
                "Motions like exp({root} t), with the roots {root} of (divided by {all}, taken to be \
                 positive)"
            )
        }
    }
}

/// Returns the sentence that introduces the stability conditions, or states the result.
fn verdict_sentence(stability: &Stability) -> &'static str {
    match &stability.verdict {
        StabilityVerdict::Asymptotic(all) if all.is_empty() => {
            "Asymptotically stable: all deviations die away."
        }
        StabilityVerdict::Asymptotic(_) => "Asymptotically stable where",
        StabilityVerdict::Oscillation(all) if all.is_empty() => "Stable: all deviations oscillate.",
        StabilityVerdict::Oscillation(_) => "Stable, all deviations oscillate, where",
        StabilityVerdict::NotAsymptotic => "Not asymptotically stable: some deviations do not die away.",
        StabilityVerdict::Unstable => "Unstable: some deviations grow.",
        StabilityVerdict::Nothing => "All roots are zero: deviations are not restored.",
        StabilityVerdict::Long => "The conditions of stability are too long to be read.",
    }
}

/// Returns the sentence that explains zero roots of the characteristic equation.
fn zero_roots_sentence(words: &SymbolNames<'_, '_>, stability: &Stability) -> String {
    let root = &words.root;
    match stability.zeros {
        1 => format!("One root is {root} = 0: that is said of the others; there is a deviation that stays."),
        n => format!(
            "{n} roots are {root} = 0: that is said of the others; there are deviations that stay or grow in \
             proportion to time."
        ),
    }
}

/// Returns the sentences of the legend that explain the notation of linear equations.
fn legend_sentences(words: &SymbolNames<'_, '_>) -> String {
    let model = words.model;
    let primes = coordinate_rate_velocity_flags(model).iter().any(|plain| *plain);
    let mut sentences = Vec::new();
    if primes || !words.at.states.is_empty() {
        sentences.push(
            "In the equations names denote deviations from the values at rest, primes their rates."
                .to_string(),
        );
    } else {
        sentences.push("Primes mark rates.".to_string());
    }
    for chart in &model.charts {
        let (v, count) = match chart {
            Chart::Plain(..) => continue,
            Chart::Ball(_, v) => (v.0, 3),
            Chart::Free(_, v) => (v.0, 6),
        };
        let all = join_names_with_and(&words.deviations[v + count - 3..v + count]);
        sentences.push(format!("{all} are a small rotation about body axes."));
        if count == 6 {
            let all = join_names_with_and(&words.deviations[v..v + 3]);
            sentences.push(format!("{all} are a small displacement along body axes."));
        }
    }
    let multipliers: Vec<String> = (0..model.constraints.len())
        .map(|k| words.name_and_derivative_order(multiplier_symbol(k).symbol()).0)
        .collect();
    if !multipliers.is_empty() {
        let constraints: Vec<String> = model.constraints.iter().map(|c| c.name.clone()).collect();
        let (is, of) = if multipliers.len() == 1 {
            ("is the multiplier", "constraint")
        } else {
            ("are the multipliers", "constraints")
        };
        sentences.push(format!(
            "{} {is} of the {of} {}.",
            join_names_with_and(&multipliers),
            join_names_with_and(&constraints)
        ));
    }
    if !model.contacts.is_empty() {
        sentences.push("Contacts are open.".to_string());
    }
    wrap_at_page_width(&sentences.join(" "))
}

/// Returns all printed linear equations and stability conditions, one per string.
fn printed_equations(lines: &LinearLines, frequency: &str) -> Vec<String> {
    let mut all: Vec<String> =
        lines.equations.iter().map(|(motion, force)| format!("{motion} = {force}")).collect();
    all.extend(lines.polynomial.iter().map(|p| format!("{p} = 0")));
    all.extend(lines.frequency.iter().map(|value| format!("{frequency} = {value}")));
    all.extend(lines.conditions.iter().map(|condition| format!("{condition} > 0")));
    all
}
