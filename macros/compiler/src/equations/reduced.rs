//! Printed form of Routh's equations: the Routhian, the equations of the noncyclic coordinates, and the
//! velocities of the cyclic coordinates in terms of their momenta.

use super::canonical::{determinant_symbol, velocities_of_momenta};
use super::written::{
    coordinate_rate_velocity_flags, determinant_names, determinants_sentence, name_and_derivative_order,
    typeset_names_with_extra_names, wrap_at_page_width,
};
use super::{EquationSizeLimits, Simplifier, quaternion_symbols, rank_of_symbol};
use crate::algebra::normal::NormalFormCache;
use crate::algebra::polynomial::{Polynomial, Ring};
use crate::diag::join_names_with_and;
use crate::equations::print::aligned::format_aligned;
use crate::equations::print::mathml::format_equations_as_html;
use crate::equations::print::names::name_with_primes;
use crate::equations::print::{Latex, MathMl, Plain, PolynomialWriter, PrintedEquations, Style, wrap_text};
use crate::expr::{Expr, Symbol};
use crate::kinematics::Joint;
use crate::mechanics::crba::Matrix;
use crate::mechanics::routh::{
    RouthianAtMomenta, matrix_block, replace_velocities, solve_cyclic_velocities,
    velocities_with_cyclic_replaced,
};
use crate::mechanics::{acceleration_symbols, forces, rnea, velocity_symbols};
use crate::mechanism::{Model, Quantity};

/// Maximum number of columns of the printed text.
const WIDTH: usize = 100;

/// Routh's equations as polynomials of one ring, with the momenta as arguments.
pub struct ReducedRouthEquations {
    /// Ring of all polynomials.
    pub ring: Ring,
    /// Indices of the velocities of the cyclic coordinates.
    pub cyclic: Vec<usize>,
    /// Routhian `R` as a polynomial.
    pub routhian: Polynomial,
    /// Left sides of the equations of the noncyclic coordinates, with inertial and bias terms.
    pub motion: Vec<Polynomial>,
    /// Right sides of the equations of the noncyclic coordinates: forces of inputs.
    pub forces: Vec<Polynomial>,
    /// Velocities of the cyclic coordinates.
    pub velocity: Vec<Polynomial>,
    /// Rates of the momenta of the cyclic coordinates: forces of inputs.
    pub momentum_rate: Vec<Polynomial>,
    /// Inertias of cyclic coordinates that have symbols of their own; determinants for coupled coordinates.
    pub determinants: Vec<Polynomial>,
}

/// Derives Routh's equations of a mechanism without constraints. `None` if they would be too long.
pub fn routh_equations<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &Matrix<'g>,
    cyclic: Vec<usize>,
) -> Option<ReducedRouthEquations> {
    let g = model.graph;
    let mut normal = NormalFormCache::new(g, rank_of_symbol);
    normal.ring.raise_term_limits();
    let own = matrix_block(mass, &cyclic, &cyclic);
    let mut divisors = Vec::new();
    let RouthianAtMomenta { routhian, velocity } =
        solve_cyclic_velocities(model, joints, &cyclic, &mut |p| {
            let (velocity, found) = velocities_of_momenta(&own, &p, &mut normal)?;
            divisors = found;
            Some(velocity)
        })?;
    let all = velocities_with_cyclic_replaced(model, &cyclic, &velocity);
    let others: Vec<usize> = (0..model.nv()).filter(|k| !cyclic.contains(k)).collect();
    let bias =
        replace_velocities(&rnea::inverse_dynamics(model, joints, &velocity_symbols(model), None), &all);
    let inputs = replace_velocities(&forces::generalized_forces_of_inputs(model, joints), &all);
    let a = acceleration_symbols(model);
    let dot_product =
        |m: &[Expr<'g>], a: &[Expr<'g>]| m.iter().zip(a).fold(g.zero(), |sum, (m, a)| sum + *m * *a);
    let select_entries =
        |list: &[usize], e: &[Expr<'g>]| -> Vec<Expr<'g>> { list.iter().map(|k| e[*k]).collect() };
    let a = select_entries(&others, &a);
    // Accelerations of the cyclic coordinates without inputs, and due to inputs.
    let across = matrix_block(mass, &cyclic, &others);
    let carried =
        across.iter().zip(select_entries(&cyclic, &bias)).map(|(row, bias)| -(dot_product(row, &a) + bias));
    let carried: Vec<Expr<'g>> = carried.collect();
    let (carried, _) = velocities_of_momenta(&own, &carried, &mut normal)?;
    let (driven, _) = velocities_of_momenta(&own, &select_entries(&cyclic, &inputs), &mut normal)?;
    let (mut motion, mut forces) = (Vec::new(), Vec::new());
    for k in &others {
        let row = select_entries(&cyclic, &mass[*k]);
        motion.push(
            dot_product(&select_entries(&others, &mass[*k]), &a) + dot_product(&row, &carried) + bias[*k],
        );
        forces.push(inputs[*k] - dot_product(&row, &driven));
    }
    let momentum_rate = select_entries(&cyclic, &inputs);
    let lists = [vec![routhian], motion, forces, velocity, momentum_rate, divisors];
    let mut found: Vec<Vec<Polynomial>> = Vec::new();
    for list in &lists {
        found.push(list.iter().map(|e| normal.normal_form(*e)).collect::<Option<_>>()?);
    }
    let mut short = Simplifier::new(normal.ring, quaternion_symbols(model), &EquationSizeLimits::ASKED);
    let mut found = found
        .iter()
        .map(|list| list.iter().map(|p| short.shorten_polynomial(p)).collect::<Option<Vec<_>>>())
        .collect::<Option<Vec<_>>>()?
        .into_iter();
    let mut next_polynomials = || found.next().unwrap_or_default();
    Some(ReducedRouthEquations {
        routhian: next_polynomials().pop()?,
        motion: next_polynomials(),
        forces: next_polynomials(),
        velocity: next_polynomials(),
        momentum_rate: next_polynomials(),
        determinants: next_polynomials(),
        ring: short.ring,
        cyclic,
    })
}

/// Formats Routh's equations as plain text, LaTeX and MathML.
pub fn format_routh_equations(model: &Model<'_>, reduced: &ReducedRouthEquations) -> PrintedEquations {
    let rates = coordinate_rate_velocity_flags(model);
    let momenta: Vec<String> =
        reduced.cyclic.iter().map(|k| format!("p_{}", model.velocities[*k].0)).collect();
    let inertias = determinant_names(model, reduced.determinants.len());
    let all = typeset_names_with_extra_names(model, &[momenta.clone(), inertias.clone()].concat());
    let index_among_cyclic = |k: usize| reduced.cyclic.iter().position(|c| *c == k);
    // Accelerations of cyclic coordinates do not occur: their symbols represent the rates of the momenta.
    let symbol_name_and_derivative_order = |symbol: Symbol| match Quantity::from_symbol(symbol) {
        Quantity::Momentum(c) => (momenta[c].clone(), 0),
        Quantity::Acceleration(k) if index_among_cyclic(k).is_some() => {
            (index_among_cyclic(k).map_or(String::new(), |c| momenta[c].clone()), 1)
        }
        Quantity::Prepared(k) => (inertias[k].clone(), 0),
        _ => name_and_derivative_order(model, &rates, symbol),
    };
    let primed_name = |symbol| name_with_primes(symbol_name_and_derivative_order(symbol));
    let typeset_name_and_dots = |symbol| {
        let (name, dots) = symbol_name_and_derivative_order(symbol);
        (all.typeset_name(&name), dots)
    };
    let lines = routh_equation_lines(reduced, Plain { name: &primed_name });
    let wrapped_line = |text: &String| wrap_text(text, WIDTH, "    ") + "\n";
    let mut plain = wrapped_line(&format!("R = {}", lines[0])) + "\n";
    plain.extend(lines[1..].iter().map(wrapped_line));
    let still = reduced.momentum_rate.iter().all(|p| p.terms.is_empty());
    let (is, of) = if momenta.len() == 1 {
        ("is the momentum", "coordinate")
    } else {
        ("are the momenta", "coordinates")
    };
    let names: Vec<String> = reduced.cyclic.iter().map(|k| model.velocities[*k].0.clone()).collect();
    let mut about = format!(
        "R is the Routhian; {} {is} of the cyclic {of} {}{}; a prime marks a rate.",
        join_names_with_and(&momenta),
        join_names_with_and(&names),
        if still { ", and constant" } else { "" }
    );
    about += &determinants_sentence(&inertias);
    plain = plain + "\n" + &wrap_at_page_width(&about) + "\n";
    let mut lines = self::routh_equation_lines(reduced, Latex { name: &typeset_name_and_dots });
    lines[0] = format!("\\mathcal{{R}} = {}", lines[0]);
    let latex = format_aligned(&lines);
    lines = self::routh_equation_lines(reduced, MathMl { name: &typeset_name_and_dots });
    lines[0] = format!("<mi>R</mi> = {}", lines[0]);
    PrintedEquations { plain, latex, mathml: format_equations_as_html(&lines) }
}

/// Returns the right side of the Routhian, then the equations of motion, the velocities of cyclic
/// coordinates, their momenta and inertias.
fn routh_equation_lines<S: Style + Copy>(reduced: &ReducedRouthEquations, style: S) -> Vec<String> {
    let writer = PolynomialWriter::new_with_style(&reduced.ring, style);
    let mut lines = vec![writer.format_energy(&reduced.routhian)];
    let sides = reduced.motion.iter().zip(&reduced.forces);
    lines.extend(
        sides.map(|(a, b)| format!("{} = {}", writer.format_polynomial(a), writer.format_polynomial(b))),
    );
    let cyclic_coordinates = || reduced.cyclic.iter().copied();
    let velocities = cyclic_coordinates().map(Quantity::Velocity).zip(&reduced.velocity);
    let moved = reduced.momentum_rate.iter().filter(|p| !p.terms.is_empty()).count() > 0;
    let momenta =
        cyclic_coordinates().map(Quantity::Acceleration).zip(&reduced.momentum_rate).filter(|_| moved);
    let determinants = (0..).map(determinant_symbol).zip(&reduced.determinants);
    for (left, right) in velocities.chain(momenta).chain(determinants) {
        lines.push(format!(
            "{} = {}",
            style.format_symbol_power(left.symbol(), 1),
            writer.format_polynomial(right)
        ));
    }
    lines
}
