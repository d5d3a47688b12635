//! Discrete steps of a tree mechanism with constant inputs, and their Jacobians, for filters, iLQR and
//! multiple shooting. Derivatives are propagated forwards through the stages of a step, as in
//! `linkwork::discrete`.
//!
//! Quantities that depend on the state at the start of a step are stored in one array: the value, followed by
//! its derivatives with respect to `q`, `v`, `u` and, unless the equations depend on time, the step size.
//! Each part has `NV` entries.

use super::batch::{Array, Batch};
use super::docs;
use super::function::Outline;
use super::manifold::curved_joint_block;
use super::support::Support;
use crate::catalogue::{Argument, Id};
use crate::derive::Output;
use crate::mechanism::{Chart, Model};
use std::fmt::Write;

/// Names of the integration methods, with descriptions for the documentation.
const METHODS: [(&str, &str); 2] = [
    (
        "semi_implicit_euler",
        "the semi-implicit Euler method, which updates the velocity with the accelerations at the start, \
         then the configuration with the new velocity",
    ),
    ("rk4", "the classical method of Runge and Kutta"),
];

const PUT_H: &str = "        by_h[k] = motion[LW_BY_H + k];\n        by_h[@N@ + k] = v[LW_BY_H + k];\n";
const PUT_INPUTS: &str = "        for (int j = 0; j < @M@; ++j) {\n            by_input[j * 2 * @N@ + k] = \
                          motion[LW_BY_U + j * @N@ + k];\n            by_input[j * 2 * @N@ + @N@ + k] = \
                          v[LW_BY_U + j * @N@ + k];\n        }\n";

const STATE: [Argument; 3] = [Argument::Q, Argument::V, Argument::U];
const NEXT: [&str; 2] = ["next_q", "next_v"];

/// C functions for integration steps of one mechanism.
pub struct Steps<'a> {
    charts: &'a [Chart],
    /// False for mechanisms with constraints or contacts, whose steps are not supported in C.
    pub has_steps: bool,
    /// Whether the Jacobians of the steps are exported.
    pub has_transitions: bool,
    /// Arguments of the C function for input forces; `None` for a mechanism without inputs.
    inputs: Option<&'static [&'static str]>,
    /// Whether the derivatives of the inputs' forces with respect to `q` and to `v` are nonzero.
    changing: [bool; 2],
}

impl<'a> Steps<'a> {
    /// Determines which integration steps are available for a mechanism.
    pub fn new(model: &Model<'_>, output: &'a Output) -> Steps<'a> {
        let find_function_by_id = |id: Id| output.functions.iter().find(|f| f.id == id);
        let taken = output.functions.iter().any(|f| {
            METHODS.iter().any(|(method, _)| {
                [format!("{method}_step"), format!("{method}_transition")].contains(&f.name)
            })
        });
        let has_steps = find_function_by_id(Id::ForwardDynamics).is_some()
            && model.contacts.is_empty()
            && !taken
            && model.nv() > 0;
        let nv = model.nv();
        let derivatives = find_function_by_id(Id::InputDerivatives);
        let has_nonzero_block = |first: usize| {
            derivatives.is_some_and(|f| (first..first + nv * nv).any(|k| !super::function::is_zero(f, k)))
        };
        Steps {
            charts: &output.charts,
            has_steps,
            has_transitions: has_steps
                && derivatives.is_some()
                && find_function_by_id(Id::ForwardDynamicsDerivatives).is_some(),
            inputs: (model.nu() > 0).then_some(if model.velocity_inputs {
                &["q", "v", "u"]
            } else {
                &["q", "u"]
            }),
            changing: [has_nonzero_block(nv), has_nonzero_block(nv + nv * nv)],
        }
    }

    /// Returns the signatures of the integration steps.
    pub fn step_batches(&self, o: &Outline<'_>) -> Vec<Batch> {
        let mut all = Vec::new();
        for (method, about) in METHODS.iter().filter(|_| self.has_steps) {
            let arguments = o.with_time_argument(&STATE);
            let docs = format!("One step of {about}; `h` seconds long, under inputs `u` that are held.");
            let mut step = Batch::handwritten_signature(&format!("{method}_step"), &arguments, &[], &docs, o);
            step.arguments.push(Array::value_argument("h", "step size, s"));
            let matrix_array =
                |(name, rows, columns): (&str, usize, usize)| Array::matrix_array(name, rows, columns);
            step.results = next(o).into_iter().map(matrix_array).collect();
            let docs = format!("The step of `{method}_step` with its Jacobians along displacements.");
            let mut transition = Batch { docs: vec![docs], ..step.clone() };
            transition.name = format!("{method}_transition");
            transition.results = transition_results(o).into_iter().map(matrix_array).collect();
            all.push(step);
            all.extend(self.has_transitions.then_some(transition));
        }
        all
    }

    /// Returns the declarations of the integration steps.
    pub fn step_declarations(&self, o: &Outline<'_>) -> String {
        let mut text = String::new();
        for (method, about) in METHODS.iter().filter(|_| self.has_steps) {
            let says = format!(
                "One step of {about}, of `h` seconds, with constant inputs `u`: configuration and velocity \
                 after it. The results may be stored in `q` and `v`."
            );
            text.push_str(&docs::function_comment(&[says], &o.with_time_argument(&STATE), &next(o), o));
            let _ = writeln!(text, "{};\n", step_signature(o, &format!("{method}_step"), &NEXT));
            if !self.has_transitions {
                continue;
            }
            let by_h = if o.time { "" } else { ", and `by_h` is its derivative by the length of the step" };
            let says = format!(
                "The step of `{method}_step` with its Jacobians, exact to rounding: with `x` the \
                 displacement of the configuration (as `integrate` takes it), then the change of the \
                 velocity, `x` at the end is `by_state` times `x` at the start plus `by_input` times the \
                 change of the inputs{by_h}."
            );
            text.push_str(&docs::function_comment(
                &[says],
                &o.with_time_argument(&STATE),
                &transition_results(o),
                o,
            ));
            let _ = writeln!(
                text,
                "{};\n",
                step_signature(o, &format!("{method}_transition"), &transition_result_names(o))
            );
        }
        text
    }

    /// Writes the definitions of the integration steps.
    pub fn write_step_definitions(&self, out: &mut String, o: &Outline<'_>, support: &mut Support) {
        if !self.has_steps {
            return;
        }
        out.push_str(&self.fill_template(include_str!("templates/steps.c"), o, support));
        if self.has_transitions {
            support.sums = true;
            out.push_str(&self.fill_template(include_str!("templates/transitions.c"), o, support));
        }
    }

    /// Fills the placeholders of a template with the sizes, names and calls of the mechanism.
    fn fill_template(&self, template: &str, o: &Outline<'_>, support: &mut Support) -> String {
        let own = if o.has_own() { "self, " } else { "" };
        let own_declared = if o.has_own() { format!("const {} *self, ", o.prefix) } else { String::new() };
        let [t, t_declared] = if o.time { ["t, ", "double t, "] } else { ["", ""] };
        let time_after = |part: &str| if o.time { format!("t + {part}, ") } else { String::new() };
        let mut text = template.to_string();
        let mut put = |word: &str, by: &str| text = text.replace(word, by);
        put("@FORCES@", &self.input_force_statement(o));
        put("@LINEAR@", &self.acceleration_derivatives_code(o));
        let has_blocks = !o.speeds && self.charts.iter().any(|chart| !matches!(chart, Chart::Plain(..)));
        let ways = match o.speeds {
            true => include_str!("templates/ways_in_speeds.c"),
            false => include_str!("templates/ways.c"),
        };
        put("@WAYS@", ways);
        put("@RATE_OF_WAY@", &rate_of_way(o));
        let [start, start_declared] = match o.speeds {
            true => [format!("{own}q, "), format!("{own_declared}const double *q, ")],
            false => Default::default(),
        };
        put("@START@", &start);
        put("@START_DECLARED@", &start_declared);
        put("@MOVED_BLOCK@", if has_blocks { include_str!("templates/moved_block.c") } else { "" });
        put("@MOVED@", &self.curved_joint_statements(o, "integrate", support));
        put("@RATE@", &self.curved_joint_statements(o, "tangent_rate", support));
        for (method, _) in METHODS {
            put(&format!("@{method}_step@"), &step_signature(o, &format!("{method}_step"), &NEXT));
            put(
                &format!("@{method}_transition@"),
                &step_signature(o, &format!("{method}_transition"), &transition_result_names(o)),
            );
        }
        let [h_declared, h_passed] = if o.time { ["", ""] } else { [", double *by_h", ", by_h"] };
        put("@H_DECLARED@", h_declared);
        put("@H_PASSED@", h_passed);
        put("@PUT_H@", if o.time { "" } else { PUT_H });
        put("@PUT_INPUTS@", if o.nu == 0 { "" } else { PUT_INPUTS });
        put("@UNUSED@", if o.nu == 0 { "    (void)(by_input);\n" } else { "" });
        put("@PERIOD@", if o.time { "0" } else { "1" });
        put("@S@", if o.time { "        const double s = part * h;\n" } else { "" });
        put("@MOVED_PLAIN@", &self.identity_derivatives(o));
        put("@OWN@", own);
        put("@OWN_DECLARED@", &own_declared);
        put("@T@", t);
        put("@T_DECLARED@", t_declared);
        put("@LATER@", &time_after("s"));
        put("@PREFIX@", &o.prefix);
        put("@NQ@", &o.nq.max(1).to_string());
        put("@NV@", &o.nv.max(1).to_string());
        put("@N@", &o.nv.to_string());
        put("@M@", &o.nu.to_string());
        put("@NU@", &o.nu.max(1).to_string());
        put("@COLUMNS@", &(2 * o.nv + o.nu + usize::from(!o.time)).to_string());
        text
    }

    /// Returns the statement that computes the generalized forces of the inputs in `tau`.
    fn input_force_statement(&self, o: &Outline<'_>) -> String {
        match self.inputs {
            Some(inputs) => format!("{};", o.function_call("generalized_forces", inputs, &["tau"])),
            None => format!(
                "(void)(u);\n    for (int k = 0; k < {}; ++k) {{\n        tau[k] = 0.0;\n    }}",
                o.nv
            ),
        }
    }

    /// Returns the statements that compute the derivatives of the accelerations for given inputs.
    fn acceleration_derivatives_code(&self, o: &Outline<'_>) -> String {
        let call =
            o.function_call("forward_dynamics_derivatives", &["q", "v", "tau"], &["by_q", "by_v", "by_tau"]);
        let mut text = format!("    {call};\n");
        if o.nu == 0 {
            text.push_str("    (void)(by_u);\n");
            return text;
        }
        let of_inputs = o.function_call(
            "generalized_forces_derivatives",
            &["q", "v", "u"],
            &["force_by_q", "force_by_v", "force_by_u"],
        );
        let _ = writeln!(
            text,
            "    double force_by_q[{0}], force_by_v[{0}], force_by_u[{1}];\n    {of_inputs};",
            (o.nv * o.nv).max(1),
            (o.nv * o.nu).max(1)
        );
        for (name, _) in ["q", "v"].iter().zip(self.changing).filter(|(_, changing)| *changing) {
            let _ = writeln!(text, "    lw_add_products({}, by_tau, force_by_{name}, by_{name});", o.nv);
        }
        let _ = writeln!(
            text,
            "    for (int k = 0; k < {}; ++k) {{\n        by_u[k] = 0.0;\n    }}\n    lw_add_products({}, \
             by_tau, force_by_u, by_u);",
            o.nv * o.nu,
            o.nu
        );
        text
    }

    /// Returns the derivatives of plain coordinates after a displacement: the identity.
    fn identity_derivatives(&self, o: &Outline<'_>) -> String {
        let all = self.charts.iter().filter_map(|chart| match chart {
            Chart::Plain(_, v) => Some(format!("    motion[(1 + {v}) * {} + {v}] += 1.0;\n", o.nv)),
            _ => None,
        });
        all.collect()
    }

    /// Returns the statements for joints with a curved configuration space, which transform columns of
    /// derivatives.
    fn curved_joint_statements(&self, o: &Outline<'_>, function: &str, support: &mut Support) -> String {
        let mut text = String::new();
        for chart in self.charts {
            let Some((kind, at, n)) = curved_joint_block(*chart, support) else { continue };
            let _ = match function {
                "integrate" => writeln!(
                    text,
                    "    {{\n        double by_q[{0}], by_dv[{0}];\n        \
                     lw_{kind}_integrate_derivatives(displacement + {at}, by_q, by_dv);\n        \
                     lw_moved_block({n}, {at}, by_dv, displacement, motion);\n        for (int k = 0; k < \
                     {0}; ++k) {{\n            motion[(1 + {at} + k / {n}) * {1} + {at} + k % {n}] += \
                     by_q[k];\n        }}\n    }}",
                    n * n,
                    o.nv
                ),
                _ => writeln!(
                    text,
                    "    {{\n        double by_dv[{0}], by_v[{0}], of_v[{1}];\n        \
                     lw_{kind}_tangent_rate_derivatives(displacement + {at}, v + {at}, by_dv, \
                     by_v);\n        lw_{kind}_tangent_rate(displacement + {at}, v + {at}, rate + \
                     {at});\n        lw_moved_block({n}, {at}, by_dv, displacement, rate);\n        \
                     lw_moved_block({n}, {at}, by_v, v, of_v);\n        for (int j = 1; j <= @COLUMNS@; ++j) \
                     {{\n            for (int k = {at}; k < {at} + {n}; ++k) {{\n                rate[j * \
                     {2} + k] += of_v[j * {2} + k];\n            }}\n        }}\n    }}",
                    n * n,
                    (1 + 2 * o.nv + o.nu + 1) * o.nv,
                    o.nv
                ),
            };
        }
        text
    }
}

/// Returns the call that computes the rate of a displacement.
fn rate_of_way(o: &Outline<'_>) -> String {
    match o.speeds {
        true => o.timeless_call("displacement_rate", &["q", "dv", "w", "rate"]),
        false => o.timeless_call("tangent_rate", &["dv", "w", "rate"]),
    }
}

fn next(o: &Outline<'_>) -> Vec<(&'static str, usize, usize)> {
    vec![(NEXT[0], o.nq, 1), (NEXT[1], o.nv, 1)]
}

/// Returns the results of a C function for a step with its Jacobians.
fn transition_results(o: &Outline<'_>) -> Vec<(&'static str, usize, usize)> {
    let (n, m) = (o.nv, o.nu);
    let mut results = next(o);
    results.extend([("by_state", 2 * n, 2 * n), ("by_input", 2 * n, m)]);
    results.extend((!o.time).then_some(("by_h", 2 * n, 1)));
    results
}

/// Returns the names of the results of a step with its Jacobians.
fn transition_result_names(o: &Outline<'_>) -> Vec<&'static str> {
    let by_h = (!o.time).then_some("by_h");
    NEXT.into_iter().chain(["by_state", "by_input"]).chain(by_h).collect()
}

/// Returns a signature with the step size after the inputs.
fn step_signature(o: &Outline<'_>, name: &str, given: &[&str]) -> String {
    let spelled = o.signature_with_results("void", name, &o.with_time_argument(&STATE), given);
    spelled.replacen("const double *u, ", "const double *u, double h, ", 1)
}
