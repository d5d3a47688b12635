//! Results that consist of several matrices, and results that loops compose at run time.

use super::body::{Scope, write_program};
use super::function::{Outline, element_of_output, is_zero};
use super::support::Support;
use crate::catalogue::{InverseForm, Shape};
use crate::derive::Function;
use std::fmt::Write;

/// Writes the body of a C function whose result is assembled from the outputs of its program.
pub fn write_composed_body(
    body: &mut String,
    f: &Function,
    scope: &Scope<'_>,
    o: &Outline<'_>,
    support: &mut Support,
) {
    match f.shape {
        Shape::Inverse(n) => {
            let parts = Parts::new(f, n, 0);
            parts.declare_structure(body);
            write_program(body, &f.program, scope, &|k| parts.element_of_output(k, "result", &[]), support);
            parts.complete_inverse(body, "result", support);
        }
        Shape::Accelerated(n) => write_accelerated_body(body, f, n, scope, support),
        Shape::Forward(n) => {
            let parts = Parts::new(f, n, 2 * n * n);
            parts.declare_structure(body);
            let forces = [("by_q", n, n), ("by_v", n, n)];
            // The accelerations, which are the last outputs, are not returned.
            let mut program = f.program.clone();
            program.outputs.truncate(3 * n * n + parts.additional_output_count());
            program.remove_unused();
            write_program(body, &program, scope, &|k| parts.element_of_output(k, "by_tau", &forces), support);
            parts.complete_inverse(body, "by_tau", support);
            write_acceleration_conversion(body, f, n, support);
        }
        Shape::CalledForward(n) => called_forward(body, f, n, scope, o, support),
        Shape::Linear(n, m) => {
            let _ = writeln!(body, "    double by_q[{0}], by_v[{0}], inverse[{0}];", at_least_one(n * n));
            let parts = Parts::new(f, n, 2 * n * n);
            parts.declare_structure(body);
            let rest = 3 * n * n + parts.additional_output_count();
            let forces = [("by_q", n, n), ("by_v", n, n)];
            let places = |k: usize| match k < rest {
                true => parts.element_of_output(k, "inverse", &forces),
                false => assembled_place(n, m, k - rest),
            };
            write_program(body, &f.program, scope, &places, support);
            parts.complete_inverse(body, "inverse", support);
            write_inverse_products(body, n, "inverse", &[("by_q", n), ("by_v", n)], support);
            assemble(body, n, m, support);
        }
        Shape::CalledLinear(n, m) => called_linear(body, f, (n, m), scope, o, support),
        _ => {}
    }
}

/// Returns the size of a C array, which must be at least one.
fn at_least_one(n: usize) -> usize {
    n.max(1)
}

/// Representation of the inverse mass matrix by program outputs, beginning with output `first`.
struct Parts<'a> {
    form: &'a InverseForm,
    n: usize,
    first: usize,
}

impl<'a> Parts<'a> {
    fn new(f: &'a Function, n: usize, first: usize) -> Parts<'a> {
        Parts { form: &f.structure.inverse, n, first }
    }

    fn trunk_velocities(&self) -> &[usize] {
        match self.form {
            InverseForm::Explicit => &[],
            InverseForm::LowRankUpdate(trunk) | InverseForm::BlockArrow { trunk, .. } => trunk,
        }
    }

    /// Returns the number of outputs after the columns of the inverse.
    fn additional_output_count(&self) -> usize {
        self.n * self.trunk_velocities().len()
    }

    fn declare_structure(&self, body: &mut String) {
        let trunk: Vec<String> = self.trunk_velocities().iter().map(ToString::to_string).collect();
        if trunk.is_empty() {
            return;
        }
        let _ = writeln!(body, "    static const int trunk[{}] = {{{}}};", trunk.len(), trunk.join(", "));
        if let InverseForm::BlockArrow { limbs, .. } = self.form {
            let index_of_limb = |k: usize| {
                limbs
                    .iter()
                    .position(|limb| limb.contains(&k))
                    .map_or("-1".to_string(), |limb| limb.to_string())
            };
            let all: Vec<String> = (0..self.n).map(index_of_limb).collect();
            let _ = writeln!(body, "    static const int limb[{}] = {{{}}};", self.n, all.join(", "));
        }
        let _ = writeln!(body, "    double beside[{}];", self.additional_output_count());
    }

    /// Returns the array element for an output: in the results before the inverse, the inverse or its
    /// additional values.
    fn element_of_output(
        &self,
        k: usize,
        inverse: &str,
        before: &[(&'static str, usize, usize)],
    ) -> Option<String> {
        if k < self.first {
            return element_of_output(before, k);
        }
        let (k, square) = (k - self.first, self.n * self.n);
        Some(if k < square { format!("{inverse}[{k}]") } else { format!("beside[{}]", k - square) })
    }

    /// Writes the statements that complete the inverse mass matrix from its factored form.
    fn complete_inverse(&self, body: &mut String, inverse: &str, support: &mut Support) {
        let (n, width) = (self.n, self.trunk_velocities().len());
        let _ = match self.form {
            InverseForm::Explicit => Ok(()),
            InverseForm::LowRankUpdate(_) => {
                support.completed |= width > 0;
                match width {
                    0 => Ok(()),
                    _ => writeln!(body, "    lw_complete({n}, {width}, {inverse}, trunk, beside);"),
                }
            }
            InverseForm::BlockArrow { .. } => {
                support.inverted = true;
                writeln!(body, "    lw_invert({n}, {width}, {inverse}, trunk, limb, beside);")
            }
        };
    }
}

fn write_accelerated_body(
    body: &mut String,
    f: &Function,
    n: usize,
    scope: &Scope<'_>,
    support: &mut Support,
) {
    let parts = Parts::new(f, n, n);
    parts.declare_structure(body);
    let before = [("result", n, 1)];
    write_program(body, &f.program, scope, &|k| parts.element_of_output(k, "inverse", &before), support);
    parts.complete_inverse(body, "inverse", support);
    if let InverseForm::BlockArrow { trunk, .. } = &f.structure.inverse {
        support.solved = true;
        let _ = writeln!(body, "    lw_solve({n}, {}, inverse, trunk, limb, beside, result);", trunk.len());
    }
}

/// Writes the product of the negative inverse with each factor, which the product overwrites.
fn write_inverse_products(
    body: &mut String,
    n: usize,
    inverse: &str,
    factors: &[(&str, usize)],
    support: &mut Support,
) {
    for (factor, columns) in factors.iter().filter(|(_, columns)| *columns > 0) {
        support.products = true;
        let _ = writeln!(body, "    lw_minus_products({n}, {columns}, {inverse}, {factor});");
    }
}

/// Writes the conversion from force derivatives to acceleration derivatives; columns in `known` are already
/// converted.
fn write_acceleration_conversion(body: &mut String, f: &Function, n: usize, support: &mut Support) {
    for (matrix, known) in ["by_q", "by_v"].into_iter().zip(&f.structure.known) {
        let mut first = 0;
        while first < n {
            let end = (first..n).find(|column| known.contains(column)).unwrap_or(n);
            let from = if first == 0 { matrix.to_string() } else { format!("{matrix} + {}", first * n) };
            write_inverse_products(body, n, "by_tau", &[(&from, end - first)], support);
            first = end + 1;
        }
    }
}

fn called_forward(
    body: &mut String,
    f: &Function,
    n: usize,
    scope: &Scope<'_>,
    o: &Outline<'_>,
    support: &mut Support,
) {
    let _ = writeln!(
        body,
        "    double a[{}];\n    {};\n    {};",
        at_least_one(n),
        o.function_call("accelerations_and_inverse", &["q", "v", "tau"], &["a", "by_tau"]),
        o.function_call("inverse_dynamics_derivatives", &["q", "v", "a"], &["by_q", "by_v"])
    );
    write_acceleration_conversion(body, f, n, support);
    let columns = ["by_q", "by_v"].into_iter().zip(&f.structure.known);
    let columns: Vec<(&str, usize)> =
        columns.flat_map(|(matrix, known)| known.iter().map(move |column| (matrix, *column))).collect();
    let place =
        |k: usize| columns.get(k / n).map(|(matrix, column)| format!("{matrix}[{}]", column * n + k % n));
    write_program(body, &f.program, scope, &place, support);
}

/// Returns the array element for an output: derivatives with respect to inputs, then the block for
/// displacements.
fn assembled_place(n: usize, m: usize, k: usize) -> Option<String> {
    Some(match k < n * m {
        true => format!("by_input[{}]", k / n * 2 * n + n + k % n),
        false => format!("by_state[{}]", (k - n * m) / n * 2 * n + (k - n * m) % n),
    })
}

/// Writes the composition of the system matrices. Values that the program has already stored are preserved.
fn assemble(body: &mut String, n: usize, m: usize, support: &mut Support) {
    if n == 0 {
        return;
    }
    let _ = writeln!(
        body,
        "    for (int j = 0; j < {n}; ++j) {{
        for (int i = 0; i < {n}; ++i) {{
            by_state[j * {twice} + {n} + i] = by_q[j * {n} + i];
            by_state[({n} + j) * {twice} + i] = i == j ? 1.0 : 0.0;
            by_state[({n} + j) * {twice} + {n} + i] = by_v[j * {n} + i];
        }}
    }}",
        twice = 2 * n
    );
    if m > 0 {
        support.products = true;
        let _ = writeln!(
            body,
            "    double of_inputs[{}];
    for (int j = 0; j < {m}; ++j) {{
        for (int i = 0; i < {n}; ++i) {{
            of_inputs[j * {n} + i] = by_input[j * {twice} + {n} + i];
        }}
    }}
    lw_minus_products({n}, {m}, inverse, of_inputs);
    for (int j = 0; j < {m}; ++j) {{
        for (int i = 0; i < {n}; ++i) {{
            by_input[j * {twice} + i] = 0.0;
            by_input[j * {twice} + {n} + i] = -of_inputs[j * {n} + i];
        }}
    }}",
            n * m,
            twice = 2 * n
        );
    }
}

/// Writes the linear system with a call of the function for the derivatives of forward dynamics.
fn called_linear(
    body: &mut String,
    f: &Function,
    (n, m): (usize, usize),
    scope: &Scope<'_>,
    o: &Outline<'_>,
    support: &mut Support,
) {
    let _ = writeln!(
        body,
        "    double by_q[{0}], by_v[{0}], inverse[{0}], tau[{1}], more_by_q[{0}], more_by_v[{0}];",
        at_least_one(n * n),
        at_least_one(n)
    );
    let rest = n + 2 * n * n;
    let before = [("tau", n, 1), ("more_by_q", n, n), ("more_by_v", n, n)];
    let places =
        |k: usize| if k < rest { element_of_output(&before, k) } else { assembled_place(n, m, k - rest) };
    write_program(body, &f.program, scope, &places, support);
    let call =
        o.function_call("forward_dynamics_derivatives", &["q", "v", "tau"], &["by_q", "by_v", "inverse"]);
    let _ = writeln!(body, "    {call};");
    if (n..rest).any(|k| !is_zero(f, k)) {
        write_inverse_products(body, n, "inverse", &[("more_by_q", n), ("more_by_v", n)], support);
        let _ = writeln!(
            body,
            "    for (int k = 0; k < {}; ++k) {{\n        by_q[k] -= more_by_q[k];\n        by_v[k] \
             -= more_by_v[k];\n    }}",
            n * n
        );
    } else {
        body.push_str("    (void)(more_by_q);\n    (void)(more_by_v);\n");
    }
    assemble(body, n, m, support);
}
