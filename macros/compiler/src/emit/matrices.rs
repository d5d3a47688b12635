//! Results that consist of several matrices, and products and inverses that are completed at run time.

use super::pieces::OutputTexts;
use super::signature::{SignatureContext, result_matrix_names};
use crate::catalogue::{InverseForm, MatrixStructure, Shape};
use crate::derive::Function;
use crate::machine::FILLED_ZEROS;

const RUNTIME: &str = "::linkwork::__private";
/// Beginning of the expression that constructs a matrix from its columns.
const STORAGE: &str = "::linkwork::nalgebra::SMatrix::from_array_storage(::linkwork::nalgebra::ArrayStorage";

/// Source text for an empty list of columns that the inverse multiplies.
const NOTHING: &str = "&mut []";

/// Returns the end of a function with matrix arguments: the code after the outputs are stored in the
/// matrices.
pub fn matrix_function_epilogue(f: &Function, s: &SignatureContext<'_>, outputs: &OutputTexts<'_>) -> String {
    let given: Vec<String> = result_matrix_names(f).iter().map(|name| format!("*{name}")).collect();
    match (f.shape, given.as_slice()) {
        (Shape::Forward(n), [by_q, by_v, inverse]) => format!(
            "{}{}{}\n",
            inverse_completion_statement([inverse, NOTHING], f, n, 2 * n * n, s, outputs),
            acceleration_conversion_statement([by_q, by_v], inverse, n, s, &f.structure),
            outputs.output_matrix_constructor_text(f.shape.output_count(&f.structure) - n, n, 1)
        ),
        (Shape::ForwardDerivativesByCalls(n), [by_q, by_v, inverse]) => {
            let (t, lanes) = (if s.time { "t, " } else { "" }, s.lane_function_suffix());
            format!(
                "let a = self.__accelerations_and_inverse{lanes}({t}q, v, tau, &mut {inverse});
                self.inverse_dynamics_derivatives_into{lanes}({t}q, v, &a, &mut {by_q}, &mut \
                    {by_v});\n{}{}a\n",
                acceleration_conversion_statement([by_q, by_v], inverse, n, s, &f.structure),
                known_column_store_statements(f, outputs, n)
            )
        }
        (Shape::Accelerated(n), [inverse]) => match &f.structure.inverse {
            InverseForm::BlockArrow { .. } => format!(
                "let mut solved = [{}];\n{}{STORAGE}(solved))\n",
                outputs.array_of_outputs(0..n),
                inverse_completion_statement([inverse, "&mut solved"], f, n, n, s, outputs)
            ),
            _ => {
                format!(
                    "{}{}\n",
                    inverse_completion_statement([inverse, NOTHING], f, n, n, s, outputs),
                    outputs.output_matrix_constructor_text(0, n, 1)
                )
            }
        },
        _ => String::new(),
    }
}

/// Returns the expression of the result, composed of the outputs.
pub fn result_expression_text(f: &Function, s: &SignatureContext<'_>, outputs: &OutputTexts<'_>) -> String {
    let format_square_matrix = |k: usize, n: usize| outputs.output_matrix_constructor_text(k * n * n, n, n);
    match f.shape {
        Shape::Pair(n) => format!("({}, {})\n", format_square_matrix(0, n), format_square_matrix(1, n)),
        Shape::Jacobians(rows, n, m) => {
            let format_jacobian = |k: usize| outputs.output_matrix_constructor_text(k * rows * n, rows, n);
            let by_u = outputs.output_matrix_constructor_text(3 * rows * n, rows, m);
            format!(
                "::linkwork::OutputJacobians {{ by_q: {}, by_v: {}, by_a: {}, by_u: {by_u} }}\n",
                format_jacobian(0),
                format_jacobian(1),
                format_jacobian(2)
            )
        }
        Shape::Hessian(n) => {
            format!(
                "({}, {}, {}, {})\n",
                format_square_matrix(0, n),
                format_square_matrix(1, n),
                format_square_matrix(2, n),
                format_square_matrix(3, n)
            )
        }
        Shape::InputPowerHessian(n, m) => {
            let format_mixed_matrix =
                |k: usize| outputs.output_matrix_constructor_text(3 * n * n + k * n * m, n, m);
            let state = [0, 1, 2].map(|k| format_square_matrix(k, n)).join(", ");
            let inputs = outputs.output_matrix_constructor_text(3 * n * n + 2 * n * m, m, m);
            format!("({state}, {}, {}, {inputs})\n", format_mixed_matrix(0), format_mixed_matrix(1))
        }
        // The matrices are composed in the returned tuple, so that each of them is moved at most once.
        Shape::Inverse(n) => format!("{}inverse\n", inverse_binding_statements(f, n, 0, s, outputs)),
        Shape::Forward(n) => format!(
            "let mut all = ({}, {}, {});\n{}{}all\n",
            format_square_matrix(0, n),
            format_square_matrix(1, n),
            format_square_matrix(2, n),
            inverse_completion_statement(["all.2", NOTHING], f, n, 2 * n * n, s, outputs),
            acceleration_conversion_statement(["all.0", "all.1"], "all.2", n, s, &f.structure),
        ),
        // The mechanism has no velocities.
        Shape::Linear(0, m) => {
            format!(
                "({}, {})\n",
                outputs.output_matrix_constructor_text(0, 0, 0),
                outputs.output_matrix_constructor_text(0, 0, m)
            )
        }
        Shape::Linear(n, m) => {
            format!(
                "let inverse = {};\nlet (mut by_q, mut by_v) = ({}, {});\n{}{}",
                format_square_matrix(2, n),
                format_square_matrix(0, n),
                format_square_matrix(1, n),
                acceleration_conversion_statement(["by_q", "by_v"], "inverse", n, s, &f.structure),
                linear_system_expression(n, m, 3 * n * n, s, outputs)
            )
        }
        Shape::CalledLinear(n, m) => {
            let input_block_start = |k: usize| n + k * n * n;
            let depend = (n..input_block_start(2)).any(|k| !outputs.is_zero(k));
            let by_state = format!(
                "let (mut more_by_q, mut more_by_v) = ({}, {});\n{}by_q -= more_by_q;\nby_v -= more_by_v;\n",
                outputs.output_matrix_constructor_text(input_block_start(0), n, n),
                outputs.output_matrix_constructor_text(input_block_start(1), n, n),
                acceleration_conversion_statement(["more_by_q", "more_by_v"], "inverse", n, s, &f.structure)
            );
            format!(
                "let tau = &{};\n{}{}{}",
                outputs.output_matrix_constructor_text(0, n, 1),
                acceleration_derivative_call(depend, s),
                if depend { by_state.as_str() } else { "" },
                linear_system_expression(n, m, input_block_start(2), s, outputs)
            )
        }
        _ => String::new(),
    }
}

/// Returns the statements that bind `inverse` to `M⁻¹`, from the outputs from index `first` on.
fn inverse_binding_statements(
    f: &Function,
    n: usize,
    first: usize,
    s: &SignatureContext<'_>,
    outputs: &OutputTexts<'_>,
) -> String {
    let rest = inverse_completion_statement(["inverse", NOTHING], f, n, first, s, outputs);
    format!("let mut inverse = {};\n{rest}", outputs.output_matrix_constructor_text(first, n, n))
}

/// Returns the statement that completes `M⁻¹` from a factored form whose columns are in the matrix `place`
/// and start at output `first`; empty for an explicit inverse. With a block arrow form, the columns `solved`
/// are multiplied by the inverse, too.
fn inverse_completion_statement(
    [place, solved]: [&str; 2],
    f: &Function,
    n: usize,
    first: usize,
    s: &SignatureContext<'_>,
    outputs: &OutputTexts<'_>,
) -> String {
    let trailing_rows_of_width =
        |width: usize| OutputsAfterMatrix { first: first + n * n, rows: n, width, outputs };
    match &f.structure.inverse {
        InverseForm::Explicit => String::new(),
        InverseForm::LowRankUpdate(trunk) => {
            trailing_rows_of_width(trunk.len()).trunk_completion_statement(place, trunk, s)
        }
        InverseForm::BlockArrow { trunk, limbs } => {
            trailing_rows_of_width(trunk.len()).inversion_statement([place, solved], trunk, limbs, s)
        }
    }
}

/// Half-open range of rows or columns.
type IndexRange = (usize, usize);

/// Outputs that follow a matrix: a row of additional values for each velocity.
struct OutputsAfterMatrix<'a> {
    /// Index of the first output that belongs to the factored form.
    first: usize,
    /// Number of rows of the matrix.
    rows: usize,
    /// Number of program outputs in each row.
    width: usize,
    outputs: &'a OutputTexts<'a>,
}

impl OutputsAfterMatrix<'_> {
    /// Returns the indices of the outputs in a row of the matrix.
    fn output_indices_of_row(&self, row: usize) -> std::ops::Range<usize> {
        self.first + row * self.width..self.first + (row + 1) * self.width
    }

    /// Returns the range of the values of a row outside which all are constant zeros; `None` if all are.
    fn nonzero_range(&self, row: usize) -> Option<IndexRange> {
        let first = self.output_indices_of_row(row).start;
        let is_nonzero_entry = |t: &usize| !self.outputs.is_zero(first + t);
        Some(((0..self.width).find(is_nonzero_entry)?, (0..self.width).rfind(is_nonzero_entry)? + 1))
    }

    /// Returns the statement that adds the product of the trunk's columns and these factors to the matrix
    /// `place`; empty if all factors are zero.
    fn trunk_completion_statement(&self, place: &str, trunk: &[usize], s: &SignatureContext<'_>) -> String {
        let used: Vec<(usize, IndexRange)> =
            (0..self.rows).filter_map(|k| Some((k, self.nonzero_range(k)?))).collect();
        let runs = group_factor_columns(used.iter().enumerate().map(|(place, (k, used))| (*k, *used, place)));
        if runs.is_empty() {
            return String::new();
        }
        let factors: Vec<String> =
            used.iter().map(|(k, _)| self.outputs.array_of_outputs(self.output_indices_of_row(*k))).collect();
        format!(
            "{RUNTIME}::complete::<Ops, {}, {}, _, _, _>(&mut {place}, {trunk:?}, &[{}], &{runs:?});\n",
            s.scalar.scalar_name(),
            tiling_types(|_| self.rows.to_string()),
            factors.join(", "),
        )
    }

    /// Returns the statement that inverts the matrix `place`, using these entries of the mass matrix, and
    /// multiplies the columns `solved` by the inverse.
    fn inversion_statement(
        &self,
        [place, solved]: [&str; 2],
        trunk: &[usize],
        limbs: &[Vec<usize>],
        s: &SignatureContext<'_>,
    ) -> String {
        let length = self.width.next_multiple_of(4);
        let padding = vec![constant_conversion_call("0.0", s); length - self.width];
        let format_border_row = |k: usize| {
            let entries =
                self.outputs.pieces.get(self.output_indices_of_row(k)).unwrap_or(&[]).iter().map(|p| &p.text);
            let all: Vec<&str> = entries.chain(&padding).map(String::as_str).collect();
            format!("[{}]", all.join(", "))
        };
        let mut used = vec![None; self.rows];
        for limb in limbs {
            let ends = limb.iter().filter_map(|k| self.nonzero_range(*k));
            let all = ends.reduce(|(a, b), (from, to)| (a.min(from), b.max(to)));
            limb.iter().for_each(|k| used[*k] = all);
        }
        let runs =
            group_factor_columns(used.iter().enumerate().filter_map(|(k, used)| Some((k, (*used)?, k))));
        let format_column_runs_of_limb = |limb: &Vec<usize>| {
            let runs = group_factor_columns(limb.iter().map(|k| (*k, IndexRange::default(), *k)));
            format!("&{:?}", runs.iter().map(|run| run.0).collect::<Vec<IndexRange>>())
        };
        let limbs: Vec<String> = limbs.iter().map(format_column_runs_of_limb).collect();
        format!(
            "{RUNTIME}::invert::<Ops, {}, {}, {}, {}, {}, {length}, _>(
                &mut {place}, {trunk:?}, &[{}], &[{}], &{runs:?}, {solved},
            );\n",
            s.scalar.scalar_name(),
            tiling_types(|_| self.rows.to_string()),
            tiling_types(|_| length.to_string()),
            self.rows,
            self.width,
            (0..self.rows).map(format_border_row).collect::<Vec<_>>().join(", "),
            limbs.join(", "),
        )
    }
}

/// Groups neighbouring columns whose factors have the same range of trunk rows and consecutive indices.
/// `columns` holds, in ascending order, the index of each column, the range and the index of the factors.
fn group_factor_columns(
    columns: impl Iterator<Item = (usize, IndexRange, usize)>,
) -> Vec<(IndexRange, IndexRange, usize)> {
    let mut runs: Vec<(IndexRange, IndexRange, usize)> = Vec::new();
    for (k, used, place) in columns {
        match runs.last_mut() {
            Some(((first, end), known, from))
                if *end == k && *known == used && *from + k - *first == place =>
            {
                *end = k + 1;
            }
            _ => runs.push(((k, k + 1), used, place)),
        }
    }
    runs
}

/// Returns the statements that store the columns that are already computed in the matrix arguments.
fn known_column_store_statements(f: &Function, outputs: &OutputTexts<'_>, n: usize) -> String {
    let columns = result_matrix_names(f).into_iter().zip(&f.structure.known);
    let columns = columns.flat_map(|(matrix, known)| known.iter().map(move |column| (matrix, column)));
    let texts = columns.enumerate().map(|(k, (matrix, column))| {
        format!("{matrix}.data.0[{column}] = {};\n", outputs.array_of_outputs(k * n..(k + 1) * n))
    });
    texts.collect()
}

/// Returns the statement that replaces derivatives of forces by derivatives of accelerations, `−M⁻¹ ∂τ/∂x`.
fn acceleration_conversion_statement(
    forces: [&str; 2],
    inverse: &str,
    n: usize,
    s: &SignatureContext<'_>,
    structure: &MatrixStructure,
) -> String {
    let is_known_factor_entry = |k: usize| structure.known[k / (n * n)].contains(&(k / n % n));
    let is_known_or_zero =
        |k: usize| is_known_factor_entry(k) || structure.zeros.get(k).is_some_and(|zero| *zero);
    let format_factor_groups = |k: usize| {
        format!("(&mut {}, {})", forces[k], column_groups_source(n, n, k * n * n, &is_known_or_zero))
    };
    inverse_product_statement(inverse, n, n, &[format_factor_groups(0), format_factor_groups(1)], s)
}

/// Returns the statement that replaces the factors, each with the given number of columns, by minus their
/// products with the inverse; empty without velocities.
fn inverse_product_statement(
    inverse: &str,
    n: usize,
    columns: usize,
    factors: &[String],
    s: &SignatureContext<'_>,
) -> String {
    if n == 0 {
        return String::new();
    }
    format!(
        "::linkwork::__private::replace_by_negative_products::<Ops, {}, {}, {n}, {columns}, {}>(&{inverse}, \
         [{}]);\n",
        s.scalar.scalar_name(),
        tiling_types(|wide| format!("::linkwork::__private::rows({n}, {wide})")),
        factors.len(),
        factors.join(", ")
    )
}

/// Returns the types of the tilings of a matrix: for processors with registers of eight numbers, and for
/// processors with registers of four numbers. `rows` returns for each the number of rows that are computed
/// together.
fn tiling_types(rows: impl Fn(bool) -> String) -> String {
    let format_tile_type = |wide: bool| {
        let n = rows(wide);
        format!(
            "{RUNTIME}::Tile<{{ {n} }}, {{ {RUNTIME}::registers_of_eight({n}, {wide}) }}, \
             {{ {RUNTIME}::registers_of_four({n}, {wide}) }}>"
        )
    };
    format!("({}, {})", format_tile_type(true), format_tile_type(false))
}

/// Run of neighbouring columns with the same nonzero rows.
struct ColumnRun {
    /// Half-open range of the columns.
    columns: (usize, usize),
    /// Indices of rows that are nonzero in at least one of the columns.
    rows: Vec<usize>,
}

/// Groups neighbouring columns with zeros in nearly the same rows, for the matrix that starts at entry
/// `first`. The first list holds column and row of each zero entry in a row where another column of its group
/// is nonzero.
fn group_columns_by_zero_rows(
    n: usize,
    columns: usize,
    first: usize,
    is_zero: &dyn Fn(usize) -> bool,
) -> (Vec<(usize, usize)>, Vec<ColumnRun>) {
    let is_zero_entry = |j: usize, i: usize| is_zero(first + j * n + i);
    let mut runs: Vec<ColumnRun> = Vec::new();
    for j in 0..columns {
        let rows: Vec<usize> = (0..n).filter(|i| !is_zero_entry(j, *i)).collect();
        if rows.is_empty() {
            continue;
        }
        let columns = (j, j + 1);
        if let Some(run) = runs.last_mut().filter(|run| run.columns.1 == j) {
            let all: Vec<usize> =
                (0..n).filter(|i| rows.binary_search(i).is_ok() || run.rows.contains(i)).collect();
            let count_zeros_in_column = |j: usize| all.iter().filter(|i| is_zero_entry(j, **i)).count();
            if (run.columns.0..=j).all(|j| count_zeros_in_column(j) <= FILLED_ZEROS) {
                *run = ColumnRun { columns: (run.columns.0, j + 1), rows: all };
                continue;
            }
        }
        runs.push(ColumnRun { columns, rows });
    }
    let zeros_filled_by_run = |run: &ColumnRun| {
        let (from, to) = run.columns;
        let entries = (from..to).flat_map(|j| run.rows.iter().map(move |i| (j, *i)));
        entries.filter(|(j, i)| is_zero_entry(*j, *i)).collect::<Vec<_>>()
    };
    (runs.iter().flat_map(zeros_filled_by_run).collect(), runs)
}

/// Returns the result of [`group_columns_by_zero_rows`] as source text.
fn column_groups_source(n: usize, columns: usize, first: usize, is_zero: &dyn Fn(usize) -> bool) -> String {
    let (filled, runs) = group_columns_by_zero_rows(n, columns, first, is_zero);
    let texts: Vec<String> = runs.iter().map(|run| format!("({:?}, &{:?})", run.columns, run.rows)).collect();
    format!("&{filled:?}, &[{}]", texts.join(", "))
}

/// Returns the body of a function that calls its variant with `count` matrix arguments, so that no large
/// value is moved.
pub fn body_calling_matrix_argument_variant(f: &Function, count: usize, s: &SignatureContext<'_>) -> String {
    let arguments: Vec<&str> = f.arguments.iter().map(|a| a.argument_name()).collect();
    let zeros = vec![format!("<{}>::zeros()", s.shape_type(Shape::Square(s.nv))); count];
    let given: Vec<String> = (0..count).map(|k| format!("&mut all.{k}")).collect();
    format!(
        "let mut all = ({});
        self.{}_into{}({}, {});
        all\n",
        zeros.join(", "),
        f.name,
        s.lane_function_suffix(),
        arguments.join(", "),
        given.join(", ")
    )
}

/// Returns the statement that calls the derivatives of forward dynamics under the forces `tau`.
fn acceleration_derivative_call(mutable: bool, s: &SignatureContext<'_>) -> String {
    let t = if s.time { "t, " } else { "" };
    let lanes = s.lane_function_suffix();
    let mutable = if mutable { "mut " } else { "" };
    format!(
        "let ({mutable}by_q, {mutable}by_v, inverse) = self.forward_dynamics_derivatives{lanes}({t}q, v, \
         tau);\n"
    )
}

fn constant_conversion_call(x: &str, s: &SignatureContext<'_>) -> String {
    format!("::linkwork::__private::constant::<{}>({x})", s.scalar.scalar_name())
}

/// Returns the expression of the two matrices of a linear system. Starting at output `first`, the outputs are
/// the derivatives by the inputs and the matrix `T` in the rate `ξ̇ = δv + T ξ` of displacements `ξ`.
fn linear_system_expression(
    n: usize,
    m: usize,
    first: usize,
    s: &SignatureContext<'_>,
    outputs: &OutputTexts<'_>,
) -> String {
    let factor = format!("(&mut by_u, {})", column_groups_source(n, m, first, &|k| outputs.is_zero(k)));
    format!(
        "let mut by_u = {by_u};
        {product}        let turning = {turning};
        let mut a = [[{zero}; {twice}]; {twice}];
        let mut b = [[{zero}; {twice}]; {m}];
        for j in 0..{n} {{
            for i in 0..{n} {{
                a[j][i] = turning.data.0[j][i];
                a[j][{n} + i] = by_q.data.0[j][i];
                a[{n} + j][{n} + i] = by_v.data.0[j][i];
            }}
            a[{n} + j][j] = {one};
        }}
        for j in 0..{m} {{
            for i in 0..{n} {{ b[j][{n} + i] = -by_u.data.0[j][i]; }}
        }}
        ({storage}(a)), {storage}(b)))\n",
        by_u = outputs.output_matrix_constructor_text(first, n, m),
        product = inverse_product_statement("inverse", n, m, &[factor], s),
        turning = outputs.output_matrix_constructor_text(first + n * m, n, n),
        zero = constant_conversion_call("0.0", s),
        one = constant_conversion_call("1.0", s),
        twice = 2 * n,
        storage = STORAGE,
    )
}
