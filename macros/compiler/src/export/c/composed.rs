//! Results that consist of several matrices, and results that loops compose at run time.

use super::super::body::{CBodyScope, write_program};
use super::super::mechanism::{ExportedMechanism, is_zero_output};
use crate::catalogue::{InverseForm, Shape};
use crate::derive::Function;
use std::fmt::Write;

/// Writes the body of a C function whose result is assembled from the outputs of its program.
pub fn write_composed_body(
    body: &mut String,
    f: &Function,
    scope: &CBodyScope<'_>,
    i: &ExportedMechanism<'_>,
) {
    let write_program_to_targets =
        |body: &mut String, assembled_output_element: &dyn Fn(usize) -> Option<String>| {
            write_program(body, &f.program, scope, assembled_output_element);
        };
    match f.shape {
        Shape::Inverse(n) => {
            let inverse = InverseMassMatrixOutputs::new(body, f, "result", n, &[]);
            write_program_to_targets(body, &|k| Some(inverse.element_of_output(k)));
            inverse.write_completion_of_inverse(body);
        }
        Shape::Accelerated(n) => {
            let inverse = InverseMassMatrixOutputs::new(body, f, "inverse", n, &[("result", n)]);
            write_program_to_targets(body, &|k| Some(inverse.element_of_output(k)));
            inverse.write_completion_of_inverse(body);
            if let InverseForm::BlockArrow { trunk, .. } = inverse.form {
                let _ = writeln!(
                    body,
                    "    lw_solve({n}, {}, inverse, trunk, limb, trunk_factors, result);",
                    trunk.len()
                );
            }
        }
        Shape::Forward(n) => {
            let inverse =
                InverseMassMatrixOutputs::new(body, f, "by_tau", n, &[("by_q", n * n), ("by_v", n * n)]);
            // The accelerations, which are the last outputs, are not returned.
            let mut program = f.program.clone();
            program.outputs.truncate(inverse.output_count());
            program.remove_unused_instructions();
            write_program(body, &program, scope, &|k| Some(inverse.element_of_output(k)));
            inverse.write_completion_of_inverse(body);
            write_conversion_to_acceleration_derivatives(body, f, n);
        }
        Shape::ForwardDerivativesByCalls(n) => write_composed_forward_derivatives(body, f, n, scope, i),
        Shape::Linear(n, m) => {
            if n > 0 {
                let _ = writeln!(body, "    double by_q[{0}], by_v[{0}], inverse[{0}];", n * n);
            }
            let inverse =
                InverseMassMatrixOutputs::new(body, f, "inverse", n, &[("by_q", n * n), ("by_v", n * n)]);
            let rest = inverse.output_count();
            write_program_to_targets(body, &|k| match k < rest {
                true => Some(inverse.element_of_output(k)),
                false => Some(system_matrix_element(n, m, k - rest)),
            });
            inverse.write_completion_of_inverse(body);
            write_negative_inverse_product(body, n, "inverse", "by_q", n);
            write_negative_inverse_product(body, n, "inverse", "by_v", n);
            write_assembly_of_system_matrices(body, n, m);
        }
        Shape::CalledLinear(n, m) => write_linear_system_by_calls(body, f, (n, m), scope, i),
        _ => {}
    }
}

/// Inverse mass matrix that the outputs of a program determine, after the outputs of other arrays.
struct InverseMassMatrixOutputs<'a> {
    form: &'a InverseForm,
    name: &'static str,
    n: usize,
    /// Velocities of the trunk, whose rows are stored in an array of their own.
    trunk: &'a [usize],
    /// Arrays of the outputs before the inverse, with their lengths.
    before: Vec<(&'static str, usize)>,
}

impl<'a> InverseMassMatrixOutputs<'a> {
    /// Describes the inverse that a function stores in an array, and declares the arrays of its structure.
    fn new(
        body: &mut String,
        f: &'a Function,
        name: &'static str,
        n: usize,
        before: &[(&'static str, usize)],
    ) -> InverseMassMatrixOutputs<'a> {
        let form = &f.structure.inverse;
        let trunk: &[usize] = match form {
            InverseForm::Explicit => &[],
            InverseForm::LowRankUpdate(trunk) | InverseForm::BlockArrow { trunk, .. } => trunk,
        };
        let inverse = InverseMassMatrixOutputs { form, name, n, trunk, before: before.to_vec() };
        if trunk.is_empty() {
            return inverse;
        }
        let list: Vec<String> = trunk.iter().map(ToString::to_string).collect();
        let _ = writeln!(body, "    static const int trunk[{}] = {{{}}};", trunk.len(), list.join(", "));
        if let InverseForm::BlockArrow { limbs, .. } = form {
            let limb_index_of_velocity = |k: usize| limbs.iter().position(|limb| limb.contains(&k));
            let all: Vec<String> = (0..n)
                .map(|k| limb_index_of_velocity(k).map_or("-1".to_string(), |limb| limb.to_string()))
                .collect();
            let _ = writeln!(body, "    static const int limb[{n}] = {{{}}};", all.join(", "));
        }
        let _ = writeln!(body, "    double trunk_factors[{}];", n * trunk.len());
        inverse
    }

    /// Returns the number of outputs of the arrays before the inverse, the inverse and its further values.
    fn output_count(&self) -> usize {
        let before: usize = self.before.iter().map(|(_, length)| length).sum();
        before + self.n * self.n + self.n * self.trunk.len()
    }

    /// Returns the array element for an output.
    fn element_of_output(&self, mut k: usize) -> String {
        for (name, length) in self.before.iter().chain(&[(self.name, self.n * self.n)]) {
            if k < *length {
                return format!("{name}[{k}]");
            }
            k -= length;
        }
        format!("trunk_factors[{k}]")
    }

    /// Writes the statements that complete the inverse mass matrix from its factored form.
    fn write_completion_of_inverse(&self, body: &mut String) {
        let (n, width, name) = (self.n, self.trunk.len(), self.name);
        let _ = match self.form {
            InverseForm::LowRankUpdate(_) if width > 0 => {
                writeln!(body, "    lw_complete({n}, {width}, {name}, trunk, trunk_factors);")
            }
            InverseForm::BlockArrow { .. } => {
                writeln!(body, "    lw_invert({n}, {width}, {name}, trunk, limb, trunk_factors);")
            }
            _ => Ok(()),
        };
    }
}

/// Writes the product of the negative inverse with a factor, which the product overwrites.
fn write_negative_inverse_product(body: &mut String, n: usize, inverse: &str, factor: &str, columns: usize) {
    if columns > 0 {
        let _ = writeln!(body, "    lw_minus_products({n}, {columns}, {inverse}, {factor});");
    }
}

/// Writes the conversion from force derivatives to acceleration derivatives; columns in `known` are already
/// converted.
fn write_conversion_to_acceleration_derivatives(body: &mut String, f: &Function, n: usize) {
    for (matrix, known) in ["by_q", "by_v"].into_iter().zip(&f.structure.known) {
        let mut first = 0;
        while first < n {
            let end = (first..n).find(|column| known.contains(column)).unwrap_or(n);
            let from = if first == 0 { matrix.to_string() } else { format!("{matrix} + {}", first * n) };
            write_negative_inverse_product(body, n, "by_tau", &from, end - first);
            first = end + 1;
        }
    }
}

fn write_composed_forward_derivatives(
    body: &mut String,
    f: &Function,
    n: usize,
    scope: &CBodyScope<'_>,
    i: &ExportedMechanism<'_>,
) {
    let _ = writeln!(
        body,
        "    double a[{}];\n    {};\n    {};",
        n.max(1),
        i.function_call_text("accelerations_and_inverse", &["q", "v", "tau", "a", "by_tau"]),
        i.function_call_text("inverse_dynamics_derivatives", &["q", "v", "a", "by_q", "by_v"])
    );
    write_conversion_to_acceleration_derivatives(body, f, n);
    let columns = ["by_q", "by_v"].into_iter().zip(&f.structure.known);
    let columns: Vec<(&str, usize)> =
        columns.flat_map(|(matrix, known)| known.iter().map(move |column| (matrix, *column))).collect();
    let place =
        |k: usize| columns.get(k / n).map(|(matrix, column)| format!("{matrix}[{}]", column * n + k % n));
    write_program(body, &f.program, scope, &place);
}

/// Returns the element of a system matrix to which an output of the program is written. The first outputs are
/// the derivatives of the accelerations with respect to the inputs, in one array; the others are the
/// derivatives of the rates of displacements with respect to displacements, in another.
fn system_matrix_element(n: usize, m: usize, k: usize) -> String {
    match k < n * m {
        true => format!("by_input[{}]", k / n * 2 * n + n + k % n),
        false => format!("by_state[{}]", (k - n * m) / n * 2 * n + (k - n * m) % n),
    }
}

/// Writes the composition of the system matrices.
fn write_assembly_of_system_matrices(body: &mut String, n: usize, m: usize) {
    if n > 0 {
        let _ = writeln!(body, "    lw_assemble({n}, {m}, by_q, by_v, inverse, by_state, by_input);");
    }
}

/// Writes the linear system with a call of the function for the derivatives of forward dynamics.
fn write_linear_system_by_calls(
    body: &mut String,
    f: &Function,
    (n, m): (usize, usize),
    scope: &CBodyScope<'_>,
    i: &ExportedMechanism<'_>,
) {
    let _ = writeln!(
        body,
        "    double by_q[{0}], by_v[{0}], inverse[{0}], tau[{1}], more[2 * {0}];",
        (n * n).max(1),
        n.max(1)
    );
    let rest = n + 2 * n * n;
    write_program(body, &f.program, scope, &|k| match k {
        k if k < n => Some(format!("tau[{k}]")),
        k if k < rest => Some(format!("more[{}]", k - n)),
        k => Some(system_matrix_element(n, m, k - rest)),
    });
    let call =
        i.function_call_text("forward_dynamics_derivatives", &["q", "v", "tau", "by_q", "by_v", "inverse"]);
    let _ = writeln!(body, "    {call};");
    if (n..rest).any(|k| !is_zero_output(f, k)) {
        write_negative_inverse_product(body, n, "inverse", "more", 2 * n);
        let _ = writeln!(
            body,
            "    for (int k = 0; k < {0}; ++k) {{\n        by_q[k] -= more[k];\n        \
             by_v[k] -= more[{0} + k];\n    }}",
            n * n
        );
    } else {
        body.push_str("    (void)(more);\n");
    }
    write_assembly_of_system_matrices(body, n, m);
}
