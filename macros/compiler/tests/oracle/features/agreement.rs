//! Consistency of the functions of one mechanism: derivatives with differences, forward with inverse
//! dynamics, momenta, energies and powers with each other, constraints with their rates, and every function
//! with its variants for other passes, prepared values or lanes.

use super::source;
use super::values::{DerivativeVariable, Values, derivative_with_error, sixth_order_difference};
use linkwork_compiler::catalogue::{self, GeneratedId};
use linkwork_compiler::derive::{DerivationOutput, Function};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::{Model, SuppliedQuantity};
use linkwork_compiler::{compile, parse_source_and_import};
use std::path::Path;

/// Maximum difference between results that differ only in passes, relative to the largest entry.
pub(super) const SAME: f64 = 1e-9;
/// Maximum difference from numeric differences, relative to the largest entry and to the differentiated
/// values.
pub(super) const TOLERANCE: f64 = 1e-7;
/// Step of the finite differences for second derivatives.
const WIDE: f64 = 8e-3;
const SKIPPED: &str = ", skip_passes = [frames, regroup, parallel, limbs]";

/// Compiles a mechanism and calls `f` with it, unless it has errors.
fn compile_and_call(arguments: &str, item: &str, f: &mut dyn FnMut(&Model<'_>, &DerivationOutput)) {
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let source = parse_source_and_import(parse_tokens(arguments), parse_tokens(item), Path::new(""), &mut cx);
    if let Some((model, output)) = source.as_ref().and_then(|source| compile(source, &graph, &mut cx)) {
        f(&model, &output);
    }
}

/// Checks all functions of the random mechanism of a seed. Returns the number of comparisons.
pub fn check_random_mechanism(seed: u64) -> usize {
    let (arguments, item) = source::random_source(seed);
    check_functions_of_mechanism(&arguments, &item, &[], seed)
}

/// Checks all functions of a mechanism, which must include `functions`, at a random state. Returns the number
/// of comparisons.
pub fn check_functions_of_mechanism(arguments: &str, item: &str, functions: &[&str], seed: u64) -> usize {
    let name = format!("seed {seed}\n#[mechanism({arguments})]\n{item}");
    let mut compared = 0;
    compile_and_call(arguments, item, &mut |model, output| {
        let lacks = functions.iter().find(|name| !output.functions.iter().any(|f| f.name == **name));
        assert_eq!(lacks, None, "{name}");
        let values = Values::random_values(model, seed);
        let mut case = CompiledTestMechanism { model, output, values, name: name.clone(), compared: 0 };
        case.check_lane_and_prepared_variants();
        case.check_dynamics();
        case.check_derivatives_of_outputs();
        case.check_constraints();
        case.check_contact_functions();
        case.check_derivatives();
        case.check_parameter_derivatives();
        case.check_optional_functions();
        compared = case.compared;
        compile_and_call(&format!("{arguments}{SKIPPED}"), item, &mut |_, plain| {
            case.check_against_unoptimised(plain)
        });
    });
    compared
}

/// Compiled test mechanism, with the state at which its functions are compared.
pub(super) struct CompiledTestMechanism<'a, 'g> {
    pub(super) model: &'a Model<'g>,
    pub(super) output: &'a DerivationOutput,
    pub(super) values: Values,
    pub(super) name: String,
    compared: usize,
}

pub(super) fn largest_magnitude(list: &[f64]) -> f64 {
    list.iter().fold(0.0, |most, x| most.max(x.abs()))
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the product of a matrix, stored by columns, and a vector.
pub(super) fn matrix_vector_product(columns: &[f64], vector: &[f64]) -> Vec<f64> {
    let rows = columns.len() / vector.len().max(1);
    (0..rows).map(|i| vector.iter().enumerate().map(|(j, x)| columns[j * rows + i] * x).sum()).collect()
}

pub(super) fn sum_of_vectors(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

impl CompiledTestMechanism<'_, '_> {
    pub(super) fn find_function(&self, name: &str) -> Option<&Function> {
        self.output.functions.iter().find(|f| f.name == name)
    }

    /// Returns the results of a function; empty for a function that the mechanism does not have.
    pub(super) fn run_function(&self, name: &str, values: &Values) -> Vec<f64> {
        self.find_function(name).map_or_else(Vec::new, |f| values.run_function(self.output, f))
    }

    pub(super) fn run_function_at_case_values(&self, name: &str) -> Vec<f64> {
        self.run_function(name, &self.values)
    }

    /// Compares two lists with the tolerance `bound`. If an entry of one list is not finite, that of the
    /// other must not be finite either.
    pub(super) fn assert_close_entries(&mut self, what: &str, found: &[f64], expected: &[f64], bound: f64) {
        assert_eq!(found.len(), expected.len(), "{what} of {}", self.name);
        self.compared += 1;
        for (k, (a, b)) in found.iter().zip(expected).enumerate() {
            let both_none = !a.is_finite() && !b.is_finite();
            assert!(
                both_none || (a - b).abs() <= bound,
                "{what}, entry {k}: {a} and {b} within {bound}, {}",
                self.name
            );
        }
    }

    /// Compares a list with the derivative of a function at zero. Skipped near a kink.
    pub(super) fn compare_with_derivative(
        &mut self,
        what: &str,
        found: &[f64],
        of: &dyn Fn(f64) -> Vec<f64>,
    ) {
        let (expected, doubt) = derivative_with_error(of);
        let scale =
            1.0 + largest_magnitude(found) + largest_magnitude(&expected) + largest_magnitude(&of(0.0));
        if doubt < 1e-4 * scale {
            self.assert_close_entries(what, found, &expected, TOLERANCE * scale + doubt);
        }
    }

    /// Compares columns of a result with the derivatives of a function by finite differences.
    pub(super) fn compare_columns_with_differences(
        &mut self,
        what: &str,
        found: &[f64],
        by: DerivativeVariable,
        of: &dyn Fn(&Values) -> Vec<f64>,
    ) {
        let n = self.values.entry_count_of_variable(by);
        let rows = of(&self.values).len();
        assert_eq!(found.len(), n * rows, "{what} by {by:?} of {}", self.name);
        for k in 0..n {
            let (values, changed) = (self.values.clone(), self.state_entry_changer());
            let column = &found[k * rows..(k + 1) * rows];
            self.compare_with_derivative(&format!("{what} by {by:?}, column {k}"), column, &|h| {
                of(&changed(&values, by, k, h))
            });
        }
    }

    /// Compares a function whose results are consecutive derivatives of another function.
    pub(super) fn check_derivative_columns(&mut self, what: &str, base: &str, by: &[DerivativeVariable]) {
        let found = self.run_function_at_case_values(what);
        if found.is_empty() || self.find_function(base).is_none() {
            return;
        }
        let (output, function) = (self.output, self.find_function(base).cloned());
        let function_outputs =
            |values: &Values| function.as_ref().map_or_else(Vec::new, |f| values.run_function(output, f));
        let rows = function_outputs(&self.values).len();
        let mut rest = &found[..];
        for by in by {
            let (columns, after) = rest.split_at(self.values.entry_count_of_variable(*by) * rows);
            self.compare_columns_with_differences(what, columns, *by, &function_outputs);
            rest = after;
        }
        assert!(rest.is_empty(), "{what} has more than derivatives, {}", self.name);
    }

    /// Returns a function that changes one entry of the state. With declared generalized speeds,
    /// configuration displacements are measured in the generalized speeds at the initial configuration.
    fn state_entry_changer(&self) -> impl Fn(&Values, DerivativeVariable, usize, f64) -> Values + use<> {
        let charts = self.model.charts.clone();
        let (columns, nv) = (self.run_function_at_case_values("__rate_matrix"), self.values.v.len());
        move |values, by, k, h| match by {
            DerivativeVariable::Q => {
                let displacement_of_entry = |j: usize| match columns.get(k * nv + j) {
                    Some(entry) => h * entry,
                    None => f64::from(u8::from(j == k)) * h,
                };
                values.displaced_values(&charts, &(0..nv).map(displacement_of_entry).collect::<Vec<_>>())
            }
            _ => values.with_changed_entry(by, k, h),
        }
    }

    /// Returns a function along the motion, as a function of time.
    pub(super) fn function_along_motion<F: Fn(&Values) -> Vec<f64>>(
        &self,
        of: F,
    ) -> impl Fn(f64) -> Vec<f64> + use<F> {
        let (values, charts) = (self.values.clone(), self.model.charts.clone());
        // With declared generalized speeds, joint velocities differ from `v`.
        let joints = match self.find_function("rates_of_speeds") {
            Some(rates) => values.run_function(self.output, rates),
            None => values.v.clone(),
        };
        move |h| of(&values.values_after_time(&charts, &joints, h))
    }

    /// Compares every function with its variants with lanes and with prepared values.
    fn check_lane_and_prepared_variants(&mut self) {
        let output = self.output;
        for function in &output.functions {
            let found = self.values.run_function(output, function);
            let bound = SAME * (1.0 + largest_magnitude(&found));
            if let Some(lanes) = self.values.run_lanes(output, function) {
                self.assert_close_entries(&format!("{} in lanes", function.name), &lanes, &found, bound);
            }
        }
        let Some(prepared) = &output.prepared else { return };
        for function in &prepared.functions {
            let plain = output.functions.iter().find(|f| f.name == function.name);
            if let Some(plain) = plain.filter(|plain| has_comparable_results(plain, function)) {
                let expected = self.values.run_function(output, plain);
                let found = self.values.run_prepared_function(prepared, function);
                let bound = SAME * (1.0 + largest_magnitude(&expected));
                self.assert_close_entries(&format!("{} prepared", function.name), &found, &expected, bound);
            }
        }
    }

    /// Compares every generated function with its variant compiled without passes.
    fn check_against_unoptimised(&mut self, plain: &DerivationOutput) {
        for function in &plain.functions {
            if let Some(own) =
                self.find_function(&function.name).filter(|own| has_comparable_results(own, function))
            {
                let found = self.values.run_function(self.output, own);
                let expected = self.values.run_function(plain, function);
                let bound = SAME * (1.0 + largest_magnitude(&expected));
                self.assert_close_entries(
                    &format!("{} without passes", function.name),
                    &found,
                    &expected,
                    bound,
                );
            }
        }
    }

    fn check_dynamics(&mut self) {
        let output = self.output;
        let find_function = |name: &str| self.find_function(name).cloned();
        let (Some(inverse), Some(kinetic), Some(potential), Some(momentum)) = (
            find_function("inverse_dynamics"),
            find_function("kinetic_energy"),
            find_function("potential_energy"),
            find_function("generalized_momentum"),
        ) else {
            return;
        };
        let forces = self.run_function_at_case_values("inverse_dynamics");
        let depends_on_accelerations = !self.model.acceleration_forces.is_empty();
        let (mass, momenta) = (
            self.run_function_at_case_values("mass_matrix"),
            self.run_function_at_case_values("generalized_momentum"),
        );
        if !depends_on_accelerations {
            self.compare_columns_with_differences("mass matrix", &mass, DerivativeVariable::A, &|x| {
                x.run_function(output, &inverse)
            });
            let rate = self.run_function_at_case_values("momentum_rate");
            let along = self.function_along_motion(|x| x.run_function(output, &momentum));
            self.compare_with_derivative("momenta", &sum_of_vectors(&rate, &forces), &along);
        }
        self.compare_columns_with_differences("momenta", &momenta, DerivativeVariable::V, &|x| {
            x.run_function(output, &kinetic)
        });
        if !self.model.time && !depends_on_accelerations {
            let power = dot(&forces, &self.values.v)
                + self.run_function_at_case_values("disturbance_power")[0]
                - self.run_function_at_case_values("dissipated_power")[0];
            let along = self.function_along_motion(|x| {
                sum_of_vectors(&x.run_function(output, &kinetic), &x.run_function(output, &potential))
            });
            self.compare_with_derivative("energy", &[power], &along);
            let effort = dot(&self.run_function_at_case_values("generalized_forces"), &self.values.v);
            let bound = SAME * (1.0 + effort.abs());
            self.assert_close_entries(
                "power of inputs",
                &self.run_function_at_case_values("control_power"),
                &[effort],
                bound,
            );
        }
        let found = self.run_function_at_case_values("forward_dynamics");
        if !found.is_empty() && found.iter().all(|a| a.is_finite()) {
            let there = Values { a: found.clone(), ..self.values.clone() };
            let forces = there.run_function(output, &inverse);
            let scale = 1.0
                + largest_magnitude(&forces)
                + largest_magnitude(&self.values.tau)
                + largest_magnitude(&mass) * largest_magnitude(&found);
            let tau = self.values.tau.clone();
            self.assert_close_entries("forward dynamics", &forces, &tau, SAME * scale);
        }
    }

    fn check_derivatives_of_outputs(&mut self) {
        let outputs: Vec<Function> =
            self.output.functions.iter().filter(|f| f.id == GeneratedId::Output).cloned().collect();
        for function in outputs {
            let depends_on_velocities = function.arguments.contains(&catalogue::Argument::V);
            let by = if depends_on_velocities { DerivativeVariable::V } else { DerivativeVariable::Q };
            let function_name_with_suffix = |suffix: &str| format!("{}{suffix}", function.name);
            self.check_derivative_columns(
                &function_name_with_suffix(catalogue::JACOBIAN),
                &function.name,
                &[by],
            );
            self.check_derivative_columns(
                &function_name_with_suffix(catalogue::DERIVATIVES),
                &function.name,
                &[DerivativeVariable::Q, DerivativeVariable::V, DerivativeVariable::A, DerivativeVariable::U],
            );
            self.check_derivative_columns(
                &function_name_with_suffix(catalogue::BY_PARAMETERS),
                &function.name,
                &[DerivativeVariable::Parameters],
            );
        }
    }

    fn check_derivatives(&mut self) {
        let output = self.output;
        self.check_derivative_columns(
            "inverse_dynamics_derivatives",
            "inverse_dynamics",
            &[DerivativeVariable::Q, DerivativeVariable::V],
        );
        self.check_derivative_columns(
            "generalized_momentum_derivatives",
            "generalized_momentum",
            &[DerivativeVariable::Q],
        );
        self.check_derivative_columns(
            "momentum_rate_derivatives",
            "momentum_rate",
            &[DerivativeVariable::Q, DerivativeVariable::V],
        );
        let inputs = self.run_function_at_case_values("__input_derivatives");
        if let Some(forces) = self.find_function("generalized_forces").cloned().filter(|_| !inputs.is_empty())
        {
            let nv = self.values.v.len();
            let joint_forces_at = |x: &Values| x.run_function(output, &forces);
            let bound = SAME * (1.0 + largest_magnitude(&inputs));
            self.assert_close_entries(
                "forces of inputs",
                &inputs[..nv],
                &joint_forces_at(&self.values),
                bound,
            );
            let mut rest = &inputs[nv..];
            for by in [DerivativeVariable::Q, DerivativeVariable::V, DerivativeVariable::U] {
                let (columns, after) = rest.split_at(self.values.entry_count_of_variable(by) * nv);
                self.compare_columns_with_differences("forces of inputs", columns, by, &joint_forces_at);
                rest = after;
            }
        }
        self.check_motion_equation_derivatives();
        self.check_forward_derivatives();
        self.check_second_derivatives();
        self.check_constraint_curvature();
    }

    /// Checks the columns of the derivatives of forward dynamics: columns that are outputs themselves, and
    /// columns of forces that are multiplied by the inverse.
    fn check_forward_derivatives(&mut self) {
        let Some(function) = self.find_function("forward_dynamics_derivatives").cloned() else { return };
        let find_function = |name: &str| self.find_function(name).cloned();
        let (Some(inverse), Some(forward)) =
            (find_function("inverse_dynamics"), find_function("forward_dynamics"))
        else {
            return;
        };
        let (output, nv) = (self.output, self.values.v.len());
        if !matches!(function.shape, catalogue::Shape::Forward(_)) {
            return;
        }
        let found = self.values.run_function(output, &function);
        let accelerations = self.values.run_function(output, &forward);
        if accelerations.iter().any(|a| !a.is_finite()) {
            return;
        }
        let there = Values { a: accelerations, ..self.values.clone() };
        let changed = self.state_entry_changer();
        for (block, by) in [DerivativeVariable::Q, DerivativeVariable::V].into_iter().enumerate() {
            for k in 0..nv {
                let column = &found[block * nv * nv + k * nv..][..nv];
                let known = function.structure.known[block].contains(&k);
                let of = if known { &forward } else { &inverse };
                self.compare_with_derivative(
                    &format!("forward dynamics by {by:?}, column {k}, known: {known}"),
                    column,
                    &|h| changed(&there, by, k, h).run_function(output, of),
                );
            }
        }
    }

    fn check_second_derivatives(&mut self) {
        use DerivativeVariable::{A, Q, U, V};
        self.check_hessian(
            "inverse_dynamics_second_derivatives",
            "inverse_dynamics",
            &[(Q, Q), (Q, V), (V, V), (Q, A)],
        );
        self.check_hessian(
            "generalized_forces_second_derivatives",
            "generalized_forces",
            &[(Q, Q), (Q, V), (V, V), (Q, U), (V, U), (U, U)],
        );
    }

    /// Checks second derivatives of a function, contracted with the factors.
    fn check_hessian(&mut self, what: &str, base: &str, blocks: &[(DerivativeVariable, DerivativeVariable)]) {
        let found = self.run_function_at_case_values(what);
        let Some(function) = self.find_function(base).cloned().filter(|_| !found.is_empty()) else { return };
        let (output, nv) = (self.output, self.values.v.len());
        let factors = self.values.supplied_values(SuppliedQuantity::Factor)[..nv].to_vec();
        self.compare_second_derivative_blocks(what, &found, blocks, &|x| {
            dot(&x.run_function(output, &function), &factors)
        });
    }

    /// Compares blocks of second derivatives of a scalar with second differences. For two derivatives with
    /// respect to configuration, the reference is the mean of both orders.
    pub(super) fn compare_second_derivative_blocks(
        &mut self,
        what: &str,
        found: &[f64],
        blocks: &[(DerivativeVariable, DerivativeVariable)],
        of: &dyn Fn(&Values) -> f64,
    ) {
        let (changed, of) = (self.state_entry_changer(), |x: &Values| vec![of(x)]);
        let mut first = 0;
        for (rows, columns) in blocks {
            let (m, n) =
                (self.values.entry_count_of_variable(*rows), self.values.entry_count_of_variable(*columns));
            for (i, j) in (0..n).flat_map(|j| (0..m).map(move |i| (i, j))) {
                let entry = found[first + j * m + i];
                let values = self.values.clone();
                // The inner displacement starts at the end of the outer one.
                let mixed_difference =
                    |outer: (DerivativeVariable, usize), inner: (DerivativeVariable, usize), h: f64| {
                        sixth_order_difference(h, &|e| {
                            let there = changed(&values, outer.0, outer.1, e);
                            sixth_order_difference(h, &|e| of(&changed(&there, inner.0, inner.1, e)))
                        })[0]
                    };
                let (row, column) = ((*rows, i), (*columns, j));
                let symmetrised_difference =
                    |h: f64| 0.5 * (mixed_difference(row, column, h) + mixed_difference(column, row, h));
                let (wide, narrow) = (symmetrised_difference(WIDE), symmetrised_difference(0.5 * WIDE));
                let scale = 1.0 + entry.abs() + narrow.abs() + 10.0 * of(&values)[0].abs();
                let doubt = (wide - narrow).abs() / 8.0;
                if doubt < 1e-4 * scale {
                    let what = format!("{what}, {row:?} and {column:?}");
                    self.assert_close_entries(&what, &[entry], &[narrow], TOLERANCE * scale + doubt);
                }
            }
            first += m * n;
        }
        assert_eq!(first, found.len(), "{what} of {}", self.name);
    }

    fn check_parameter_derivatives(&mut self) {
        for base in ["inverse_dynamics", "forward_dynamics", "generalized_forces"] {
            self.check_derivative_columns(
                &format!("{base}_by_parameters"),
                base,
                &[DerivativeVariable::Parameters],
            );
        }
    }

    /// Checks the regressor matrices with arbitrary inertial parameters and with the inertial parameters of
    /// the mechanism.
    fn check_regressors(&mut self) {
        let (regressor, base) = (
            self.run_function_at_case_values("joint_torque_regressor"),
            self.run_function_at_case_values("base_regressor"),
        );
        if regressor.is_empty() {
            return;
        }
        let nv = self.values.v.len();
        let any = self.values.supplied_values(SuppliedQuantity::Inertia)[..regressor.len() / nv].to_vec();
        let forces = matrix_vector_product(&regressor, &any);
        let bound = SAME * (1.0 + largest_magnitude(&regressor) * largest_magnitude(&any));
        self.assert_close_entries(
            "base regressor",
            &matrix_vector_product(&base, &self.run_function_at_case_values("base_parameters")),
            &forces,
            bound,
        );
        // Springs and other elements contribute to the forces in addition to the bodies.
        if ["#[acts", "#[energy", "#[dissipation"].iter().all(|element| !self.name.contains(element)) {
            let own = self.run_function_at_case_values("standard_parameters");
            let bound = SAME * (1.0 + largest_magnitude(&regressor) * largest_magnitude(&own));
            self.assert_close_entries(
                "regressor",
                &matrix_vector_product(&regressor, &own),
                &self.run_function_at_case_values("inverse_dynamics"),
                bound,
            );
        }
    }

    fn check_optional_functions(&mut self) {
        self.check_regressors();
        let output = self.output;
        let Values { v, a, .. } = self.values.clone();
        if let Some(momentum) = self.find_function("momentum").cloned() {
            let matrix = self.run_function_at_case_values("centroidal_momentum_matrix");
            if !matrix.is_empty() {
                self.compare_columns_with_differences("momentum", &matrix, DerivativeVariable::V, &|x| {
                    x.run_function(output, &momentum)
                });
                let change = sum_of_vectors(
                    &matrix_vector_product(&matrix, &a),
                    &self.run_function_at_case_values("centroidal_momentum_bias"),
                );
                let along = self.function_along_motion(|x| x.run_function(output, &momentum));
                self.compare_with_derivative("momentum", &change, &along);
            }
        }
        if self.find_function("hamiltonian").is_some() {
            let momenta = self.run_function_at_case_values("generalized_momentum");
            let canonical = Values { given: momenta.clone(), ..self.values.clone() };
            let scale = 1.0
                + largest_magnitude(&self.run_function_at_case_values("mass_matrix")) * largest_magnitude(&v);
            let found = self.run_function("canonical_velocity", &canonical);
            let again = Values { v: found.clone(), ..self.values.clone() };
            let found = self.run_function("generalized_momentum", &again);
            self.assert_close_entries("canonical velocity", &found, &momenta, SAME * scale);
            let energy = dot(&momenta, &v) - self.run_function_at_case_values("kinetic_energy")[0]
                + self.run_function_at_case_values("potential_energy")[0];
            let found = self.run_function("hamiltonian", &canonical);
            self.assert_close_entries(
                "hamiltonian",
                &found,
                &[energy],
                SAME * (scale * (1.0 + largest_magnitude(&v)) + energy.abs()),
            );
            let rate = sum_of_vectors(&self.run_function_at_case_values("momentum_rate"), &self.values.tau);
            let found = self.run_function("canonical_momentum_rate", &canonical);
            let bound = SAME * (scale * (1.0 + largest_magnitude(&v)) + largest_magnitude(&rate));
            self.assert_close_entries("canonical momentum rate", &found, &rate, bound);
        }
        let forward = self.run_function_at_case_values("forward_dynamics");
        if let Some(conserved) = self.find_function("conserved").cloned().filter(|_| !forward.is_empty()) {
            self.values.u.iter_mut().for_each(|u| *u = 0.0);
            let tau = self.run_function_at_case_values("generalized_forces");
            self.values.tau = tau;
            let a = self.run_function_at_case_values("forward_dynamics");
            let before = std::mem::replace(&mut self.values.a, a);
            let kept = self.run_function_at_case_values("conserved");
            let along = self.function_along_motion(|x| x.run_function(output, &conserved));
            self.compare_with_derivative("what is conserved", &vec![0.0; kept.len()], &along);
            self.values.a = before;
        }
    }
}

/// Returns true for functions whose results have the same meaning entry by entry.
fn has_comparable_results(a: &Function, b: &Function) -> bool {
    use catalogue::Shape;
    let divided =
        matches!(a.shape, Shape::Inverse(_) | Shape::Forward(_) | Shape::Linear(..) | Shape::Accelerated(_));
    let called = a.shape.is_assembled_from_calls()
        || b.shape.is_assembled_from_calls()
        || a.name.starts_with("__passive");
    a.shape == b.shape && a.arguments == b.arguments && !divided && !called && a.id != GeneratedId::Part
}
