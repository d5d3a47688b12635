//! Printed form of Kane's equations of mechanisms with constraints, in independent velocities and therefore
//! without multipliers. The constraints give the dependent velocities `w_D = A s + b`. With the partial
//! derivatives `Z` of all velocities by the independent ones `s`, the equations are
//!
//! ```text
//! Zᵀ (M ẇ + h − τ) = 0,   w_D = A s + b
//! ```
//!
//! (Kane and Levinson, *Dynamics: Theory and Applications*, 1985, ch. 6; the Gibbs-Appell equations in
//! quasi-velocities).

use super::written::{
    coordinate_rate_velocity_flags, joint_velocity_name_and_dots, name_and_derivative_order,
    typeset_names_with_extra_names, wrap_at_page_width,
};
use super::{EquationSizeLimits, Simplifier, quaternion_symbols, rank_of_symbol};
use crate::algebra::normal::NormalFormCache;
use crate::algebra::polynomial::{Polynomial, Ring};
use crate::diag::{Diagnostics, join_names_with_and};
use crate::equations::print::aligned::format_aligned;
use crate::equations::print::mathml::format_equations_as_html;
use crate::equations::print::names::name_with_primes;
use crate::equations::print::{Latex, MathMl, Plain, PolynomialWriter, PrintedEquations, Style, wrap_text};
use crate::expr::eval::Tape;
use crate::expr::replace::substitute_symbols_in_all;
use crate::expr::{Expr, Symbol};
use crate::kinematics::mobility::sample_feasible_configurations;
use crate::kinematics::redundancy::OrthonormalRowBasis;
use crate::kinematics::speeds::{inverse_of_speed_matrix, shorten_expression};
use crate::kinematics::{
    CompiledConstraintRows, Joint, random_configuration, symbol_value_at_rest, time_derivative,
};
use crate::mechanics::crba::Matrix;
use crate::mechanics::speeds::SpeedTransformation;
use crate::mechanics::{acceleration_symbols, constraints, forces, rnea, velocity_symbols};
use crate::mechanism::{Model, Quantity};

/// Maximum number of columns of the printed text.
const WIDTH: usize = 100;
/// Maximum number of choices of dependent velocities that are compared.
const CHOICES: usize = 20_000;
/// Number of random configurations in which choices are compared.
const SAMPLES: u64 = 4;
/// Relative difference below which determinants count as constant.
const SAME: f64 = 1e-9;
/// Relative magnitude above which the remainder of a row, after projection off the other rows, counts as
/// linearly independent.
const INDEPENDENT: f64 = 1e-7;

/// Kane's equations as polynomials of one ring.
pub struct KaneEquations {
    /// Ring of all polynomials.
    pub ring: Ring,
    /// Indices of the independent velocities.
    pub independent: Vec<usize>,
    /// Left sides of the equations of motion, with inertial and bias terms, for each independent velocity.
    pub motion: Vec<Polynomial>,
    /// Right sides of Kane's equations of motion: generalized forces of the inputs.
    pub forces: Vec<Polynomial>,
    /// Dependent velocities in terms of the independent ones, each with the index of the velocity.
    pub dependent: Vec<(usize, Polynomial)>,
    /// Joint velocities that declared generalized speeds replace, with their indices.
    pub rates: Vec<(usize, Polynomial)>,
    /// Residuals of the holonomic constraints.
    pub residuals: Vec<Polynomial>,
}

/// Reason why Kane's equations in independent velocities are not available.
pub enum KaneFailure {
    /// No choice of dependent velocities was found by the search.
    Choice,
    /// The equations would be too long to print.
    Length,
}

/// Derives Kane's equations of a mechanism with constraints. The independent velocities are those of the
/// joints that the user named. Otherwise the dependent velocities are those whose determinant in the
/// constraints is constant, or varies the least.
pub fn kane_equations<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    speeds: Option<&SpeedTransformation<'g>>,
) -> Result<KaneEquations, KaneFailure> {
    let own = speeds.map_or(model, |speeds| &speeds.model);
    let rows = constraints::jacobian(own);
    let dependent = match &model.dependent {
        Some(pivots) if speeds.is_none() && pivots.len() == rows.len() => {
            pivots.iter().map(|pivot| pivot.velocity.0).collect()
        }
        _ => choose_dependent_velocities(model, own, &rows).ok_or(KaneFailure::Choice)?,
    };
    let solved = MotionInIndependentVelocities::new(own, &rows, dependent).ok_or(KaneFailure::Choice)?;
    let v = velocity_symbols(model);
    let mut needed = rnea::inverse_dynamics(model, joints, &v, Some(&acceleration_symbols(model)));
    let mut inputs = forces::generalized_forces_of_inputs(model, joints);
    let mut rates = Vec::new();
    if let Some(speeds) = speeds {
        (needed, inputs) = (speeds.transform_forces(&needed), speeds.transform_forces(&inputs));
        rates = speeds
            .replaced_velocity_indices()
            .into_iter()
            .map(|k| (k, solved.express_in_independent_velocities(&[speeds.rates[k]])[0]))
            .collect();
    }
    let [motion, forces] =
        [needed, inputs].map(|all| solved.project_forces(&solved.express_in_independent_velocities(&all)));
    let residuals: Vec<Expr<'g>> = own.constraints.iter().filter_map(|c| c.residual).collect();
    let (replaced, rates): (Vec<usize>, Vec<Expr<'g>>) = rates.into_iter().unzip();
    let lists = [motion, forces, solved.values, rates, residuals];
    let (ring, found) = simplified_polynomials(own, &lists).ok_or(KaneFailure::Length)?;
    let [motion, forces, values, rates, residuals] = found;
    Ok(KaneEquations {
        ring,
        independent: solved.independent,
        motion,
        forces,
        dependent: solved.dependent.into_iter().zip(values).collect(),
        rates: replaced.into_iter().zip(rates).collect(),
        residuals,
    })
}

/// Converts lists of expressions to simplified polynomials of one ring. Returns `None` if they are too long.
fn simplified_polynomials<'g, const N: usize>(
    model: &Model<'g>,
    lists: &[Vec<Expr<'g>>; N],
) -> Option<(Ring, [Vec<Polynomial>; N])> {
    let all: Vec<Expr<'g>> = lists.concat();
    if Tape::new(&all).node_count() > EquationSizeLimits::ASKED.operations[1] {
        return None;
    }
    let mut normal = NormalFormCache::new(model.graph, rank_of_symbol);
    normal.ring.raise_term_limits();
    let all: Vec<Polynomial> = all.iter().map(|e| normal.normal_form(*e)).collect::<Option<_>>()?;
    let mut short = Simplifier::new(normal.ring, quaternion_symbols(model), &EquationSizeLimits::ASKED);
    let mut all = all.iter().map(|p| short.shorten_polynomial(p)).collect::<Option<Vec<_>>>()?.into_iter();
    let lists = std::array::from_fn(|k| all.by_ref().take(lists[k].len()).collect());
    Some((short.ring, lists))
}

/// Chooses the dependent velocities that the constraints are solved for: those whose determinant is the same
/// in all configurations, or varies the least. The constraints must also determine them in configurations
/// that satisfy the constraints. For example, the coupler of a parallelogram does not rotate, so that its
/// angular velocity does not determine the other velocities. `None` if the constraints are linearly dependent
/// there. `rows` is the constraint Jacobian in the velocities of `own`, which may be declared generalized
/// speeds.
fn choose_dependent_velocities<'g>(
    model: &Model<'g>,
    own: &Model<'g>,
    rows: &Matrix<'g>,
) -> Option<Vec<usize>> {
    let (nc, nv) = (rows.len(), own.nv());
    let tape = Tape::new(&rows.concat());
    let constraint_rows_at_configuration = |q: &[f64], seed: u64| -> Vec<Vec<f64>> {
        tape.evaluate_at(&|s| symbol_value_at_rest(s, q, seed))
            .chunks(nv.max(1))
            .map(<[f64]>::to_vec)
            .collect()
    };
    let samples: Vec<Vec<Vec<f64>>> = (0..SAMPLES)
        .map(|seed| constraint_rows_at_configuration(&random_configuration(model, seed), seed))
        .collect();
    let closed =
        sample_feasible_configurations(model, &CompiledConstraintRows::new(model), &mut Diagnostics::new());
    let closed: Vec<Vec<Vec<f64>>> =
        closed.iter().map(|(q, seed)| constraint_rows_at_configuration(q, *seed)).collect();
    let columns_have_full_rank = |columns: &[usize]| {
        closed.iter().all(|rows| {
            let mut basis = OrthonormalRowBasis::default();
            rows.iter().for_each(|row| {
                basis
                    .add_independent_row(&columns.iter().map(|k| row[*k]).collect::<Vec<f64>>(), INDEPENDENT);
            });
            basis.rank() == nc
        })
    };
    let mut best: Option<((f64, usize), Vec<usize>)> = None;
    let mut columns: Vec<usize> = (0..nc).collect();
    for _ in 0..CHOICES {
        let sizes = samples.iter().map(|rows| determinant_of_columns(rows, &columns).abs());
        let (least, most) = sizes.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
        let even = if most > 0.0 { least / most } else { 0.0 };
        let even = if even > 1.0 - SAME { 1.0 } else { even };
        let filled = columns.iter().map(|k| rows.iter().filter(|row| !row[*k].is_zero()).count()).sum();
        let better = best.as_ref().is_none_or(|((e, f), _)| even > *e || (even == *e && filled < *f));
        if even > SAME && better && columns_have_full_rank(&columns) {
            best = Some(((even, filled), columns.clone()));
        }
        // Next choice in lexicographic order.
        let Some(k) = (0..nc).rev().find(|k| columns[*k] < nv - nc + k) else { break };
        columns[k] += 1;
        for j in k + 1..nc {
            columns[j] = columns[j - 1] + 1;
        }
    }
    best.map(|(_, columns)| columns)
}

/// Returns the determinant of a choice of columns, by elimination with pivoting.
fn determinant_of_columns(rows: &[Vec<f64>], columns: &[usize]) -> f64 {
    let mut m: Vec<Vec<f64>> = rows.iter().map(|row| columns.iter().map(|k| row[*k]).collect()).collect();
    let (n, mut product) = (m.len(), 1.0);
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| m[*a][k].abs().total_cmp(&m[*b][k].abs())).unwrap_or(k);
        m.swap(k, pivot);
        product *= m[k][k];
        let own = m[k].clone();
        if own[k] == 0.0 {
            return 0.0;
        }
        for row in &mut m[k + 1..] {
            let factor = row[k] / own[k];
            row.iter_mut().zip(&own).for_each(|(x, own)| *x -= factor * own);
        }
    }
    product
}

/// All velocities and accelerations in terms of the independent velocities.
struct MotionInIndependentVelocities<'g> {
    independent: Vec<usize>,
    dependent: Vec<usize>,
    /// Dependent velocities in terms of the independent ones.
    values: Vec<Expr<'g>>,
    /// Time derivatives of the dependent velocities.
    changes: Vec<Expr<'g>>,
    /// Partial derivatives of the dependent velocities (rows) with respect to the independent velocities
    /// (columns).
    partial: Matrix<'g>,
}

impl<'g> MotionInIndependentVelocities<'g> {
    fn new(
        model: &Model<'g>,
        rows: &Matrix<'g>,
        mut dependent: Vec<usize>,
    ) -> Option<MotionInIndependentVelocities<'g>> {
        let g = model.graph;
        dependent.sort_unstable();
        let independent: Vec<usize> = (0..model.nv()).filter(|k| !dependent.contains(k)).collect();
        let own: Matrix<'g> = rows.iter().map(|row| dependent.iter().map(|k| row[*k]).collect()).collect();
        let inverse = inverse_of_speed_matrix(model, &own)?;
        let multiply_negative_inverse_by_column = |column: &dyn Fn(usize) -> Expr<'g>| -> Vec<Expr<'g>> {
            let negative_row_column_product = |row: &Vec<Expr<'g>>| {
                let terms = row.iter().enumerate().filter(|(_, e)| !e.is_zero());
                terms.fold(g.zero(), |sum, (i, e)| sum - *e * column(i))
            };
            inverse.iter().map(|row| shorten_expression(model, negative_row_column_product(row))).collect()
        };
        let with_velocities_set_to_zero = |e: Expr<'g>| {
            substitute_symbols_in_all(&[e], &|s| {
                matches!(Quantity::from_symbol(s), Quantity::Velocity(_)).then(|| g.zero())
            })[0]
        };
        // Motion that is driven in time also moves dependent velocities.
        let drift: Vec<Expr<'g>> =
            model.constraints.iter().map(|c| with_velocities_set_to_zero(c.rate)).collect();
        let mut values = multiply_negative_inverse_by_column(&|i| drift[i]);
        let mut partial: Matrix<'g> = vec![Vec::new(); dependent.len()];
        for k in &independent {
            let column = multiply_negative_inverse_by_column(&|i| rows[i][*k]);
            for ((row, value), e) in partial.iter_mut().zip(&mut values).zip(column) {
                row.push(e);
                *value += e * Quantity::Velocity(*k).expr(g);
            }
        }
        let mut found =
            MotionInIndependentVelocities { independent, dependent, values, changes: Vec::new(), partial };
        let rate_of_dependent_velocity = |(value, row): (&Expr<'g>, &Vec<Expr<'g>>)| {
            let start = time_derivative(model.configuration_space(), *value);
            let terms = found.independent.iter().zip(row);
            terms.fold(start, |sum, (k, e)| sum + *e * Quantity::Acceleration(*k).expr(g))
        };
        let changes: Vec<Expr<'g>> =
            found.values.iter().zip(&found.partial).map(rate_of_dependent_velocity).collect();
        found.changes = found.express_in_independent_velocities(&changes);
        Some(found)
    }

    /// Expresses all velocities and accelerations in terms of the independent ones.
    fn express_in_independent_velocities(&self, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let index_of_dependent_velocity = |k: usize| self.dependent.iter().position(|d| *d == k);
        substitute_symbols_in_all(e, &|s| match Quantity::from_symbol(s) {
            Quantity::Velocity(k) => Some(self.values[index_of_dependent_velocity(k)?]),
            Quantity::Acceleration(k) => Some(*self.changes.get(index_of_dependent_velocity(k)?)?),
            _ => None,
        })
    }

    /// Projects forces onto the independent velocities: `Zᵀ f`.
    fn project_forces(&self, forces: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let projected_force = |(n, k): (usize, &usize)| {
            let carried = self.dependent.iter().zip(&self.partial);
            carried.fold(forces[*k], |sum, (d, row)| sum + row[n] * forces[*d])
        };
        self.independent.iter().enumerate().map(projected_force).collect()
    }
}

/// Formats Kane's equations as plain text, LaTeX and MathML.
pub fn format_kane_equations(model: &Model<'_>, kane: &KaneEquations) -> PrintedEquations {
    let rates = coordinate_rate_velocity_flags(model);
    let names = typeset_names_with_extra_names(model, &[]);
    let symbol_name_and_derivative_order = |symbol: Symbol| name_and_derivative_order(model, &rates, symbol);
    let primed_name = |symbol| name_with_primes(symbol_name_and_derivative_order(symbol));
    let typeset_name_and_dots = |symbol| {
        let (name, dots) = symbol_name_and_derivative_order(symbol);
        (names.typeset_name(&name), dots)
    };
    let primed_joint_velocity_name = |k: usize| name_with_primes(joint_velocity_name_and_dots(model, k));
    let lines = KaneLines::new(kane, Plain { name: &primed_name }, &primed_joint_velocity_name);
    let wrapped_line = |text: &String| wrap_text(text, WIDTH, "    ") + "\n";
    let mut plain: String = lines.velocities.iter().map(wrapped_line).collect();
    plain += "\n";
    plain.extend(lines.motion.iter().map(wrapped_line));
    plain = plain + "\n" + &wrap_at_page_width(&legend_sentences(model, kane, &primed_name)) + "\n";
    let typeset_joint_velocity_and_dots = |k: usize| {
        let (name, dots) = joint_velocity_name_and_dots(model, k);
        (names.typeset_name(&name), dots)
    };
    let latex_joint_velocity = |k: usize| {
        Latex { name: &|_| typeset_joint_velocity_and_dots(k) }
            .format_symbol_power(Quantity::Velocity(k).symbol(), 1)
    };
    let latex = KaneLines::new(kane, Latex { name: &typeset_name_and_dots }, &latex_joint_velocity);
    let mathml_joint_velocity = |k: usize| {
        MathMl { name: &|_| typeset_joint_velocity_and_dots(k) }
            .format_symbol_power(Quantity::Velocity(k).symbol(), 1)
    };
    let mathml = KaneLines::new(kane, MathMl { name: &typeset_name_and_dots }, &mathml_joint_velocity);
    PrintedEquations {
        plain,
        latex: format_aligned(&[latex.velocities, latex.motion].concat()),
        mathml: format_equations_as_html(&[mathml.velocities, mathml.motion].concat()),
    }
}

/// Printed equations, one per string.
struct KaneLines {
    /// Equations for the dependent velocities and for joint velocities that speeds replace.
    velocities: Vec<String>,
    /// Equations of motion, followed by the holonomic constraints.
    motion: Vec<String>,
}

impl KaneLines {
    fn new<S: Style + Copy>(kane: &KaneEquations, style: S, left: &dyn Fn(usize) -> String) -> KaneLines {
        let writer = PolynomialWriter::new_with_style(&kane.ring, style);
        let of_speeds =
            kane.rates.iter().map(|(k, p)| format!("{} = {}", left(*k), writer.format_polynomial(p)));
        let dependent = kane.dependent.iter().map(|(k, p)| {
            format!(
                "{} = {}",
                style.format_symbol_power(Quantity::Velocity(*k).symbol(), 1),
                writer.format_polynomial(p)
            )
        });
        let sides = kane.motion.iter().zip(&kane.forces);
        let motion =
            sides.map(|(a, b)| format!("{} = {}", writer.format_polynomial(a), writer.format_polynomial(b)));
        let held = kane.residuals.iter().map(|p| format!("{} = 0", writer.format_polynomial(p)));
        KaneLines { velocities: of_speeds.chain(dependent).collect(), motion: motion.chain(held).collect() }
    }
}

/// Returns the sentences of the legend that explain the printed equations.
fn legend_sentences(model: &Model<'_>, kane: &KaneEquations, marked: &dyn Fn(Symbol) -> String) -> String {
    let independent: Vec<String> =
        kane.independent.iter().map(|k| marked(Quantity::Velocity(*k).symbol())).collect();
    let names: Vec<&str> = model.constraints.iter().map(|c| c.name.split('.').next().unwrap_or("")).collect();
    let mut held: Vec<String> = names.iter().map(ToString::to_string).collect();
    held.dedup();
    let (are, equations) = match independent.len() {
        1 => ("is the independent velocity", "The equation of motion is Kane's for it"),
        _ => ("are the independent velocities", "The equations of motion are Kane's for them"),
    };
    format!(
        "{} {are}; from them the others follow by {}. {equations}, without multipliers. A prime marks a \
         rate.",
        join_names_with_and(&independent),
        join_names_with_and(&held)
    )
}
