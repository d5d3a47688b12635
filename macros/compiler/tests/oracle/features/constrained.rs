//! Consistency of the functions of constraints and contacts with each other and with finite differences.

use super::agreement::{
    CompiledTestMechanism, TOLERANCE, dot, largest_magnitude, matrix_vector_product, sum_of_vectors,
};
use super::source;
use super::values::{DerivativeVariable, Values};
use linkwork_compiler::catalogue::{Record, Shape};
use linkwork_compiler::mechanism::SuppliedQuantity;

impl CompiledTestMechanism<'_, '_> {
    pub(super) fn check_constraints(&mut self) {
        let (Some(rates), Some(residuals)) = (
            self.find_function("constraint_rates").cloned(),
            self.find_function("constraint_residuals").cloned(),
        ) else {
            return;
        };
        let output = self.output;
        self.check_derivative_columns("constraint_jacobian", "constraint_rates", &[DerivativeVariable::V]);
        let along = self.function_along_motion(|x| x.run_function(output, &residuals));
        let holonomic = self.run_function_at_case_values("constraint_residuals").len();
        self.compare_with_derivative(
            "residuals",
            &self.run_function_at_case_values("constraint_rates")[..holonomic],
            &along,
        );
        let jacobian = self.run_function_at_case_values("constraint_jacobian");
        let change = sum_of_vectors(
            &matrix_vector_product(&jacobian, &self.values.a),
            &self.run_function_at_case_values("constraint_bias"),
        );
        let along = self.function_along_motion(|x| x.run_function(output, &rates));
        self.compare_with_derivative("rates of constraints", &change, &along);
        self.check_constrained_dynamics(&jacobian);
    }

    /// Checks elimination with well-conditioned pivots: its result satisfies the equations of motion and the
    /// constraints.
    fn check_constrained_dynamics(&mut self, jacobian: &[f64]) {
        let Some(function) = self.find_function("__constrained_dynamics").cloned() else { return };
        let Shape::Record(Record::Elimination(nv, nc)) = function.shape else { return };
        let found = self.values.run_function(self.output, &function);
        let (a, rest) = found.split_at(nv);
        let (multipliers, rest) = rest.split_at(nc);
        let (pivots, before) = rest.split_at(nc);
        if !pivots.iter().zip(before).all(|(pivot, before)| *pivot > 1e-3 * before) {
            return;
        }
        let there = Values { a: a.to_vec(), ..self.values.clone() };
        let balance: Vec<f64> =
            (0..nv).map(|j| dot(&jacobian[j * nc..(j + 1) * nc], multipliers) + self.values.tau[j]).collect();
        let forces = self.run_function("inverse_dynamics", &there);
        let scale = 1.0
            + largest_magnitude(&balance)
            + largest_magnitude(jacobian) * largest_magnitude(multipliers)
            + largest_magnitude(&forces);
        self.assert_close_entries("constrained dynamics", &forces, &balance, 1e-4 * TOLERANCE * scale);
        let change = sum_of_vectors(
            &matrix_vector_product(jacobian, a),
            &self.run_function_at_case_values("constraint_bias"),
        );
        let scale = 1.0
            + largest_magnitude(jacobian) * largest_magnitude(a)
            + largest_magnitude(&self.run_function_at_case_values("constraint_bias"));
        self.assert_close_entries(
            "constrained accelerations",
            &change,
            &vec![0.0; nc],
            1e-4 * TOLERANCE * scale,
        );
    }

    /// Checks the second derivatives of `−λᵀ J w + zᵀ (J a + b) + yᵀ (J v + …)`, and the derivative of `−J w`
    /// with respect to configuration, whose rows belong to the multipliers.
    pub(super) fn check_constraint_curvature(&mut self) {
        let found = self.run_function_at_case_values("__constraint_curvature");
        let names = ["constraint_jacobian", "constraint_bias", "constraint_rates"];
        let [Some(jacobian), Some(bias), Some(rates)] = names.map(|name| self.find_function(name).cloned())
        else {
            return;
        };
        if found.is_empty() {
            return;
        }
        let (output, nv, nc) = (self.output, self.values.v.len(), self.model.constraints.len());
        use SuppliedQuantity::{AccelerationFactor, Direction, Multiplier, VelocityFactor};
        let [lambda, w, z, y] =
            [(Multiplier, nc), (Direction, nv), (AccelerationFactor, nc), (VelocityFactor, nc)]
                .map(|(block, count)| self.values.supplied_values(block)[..count].to_vec());
        let jacobian_times_w = |x: &Values| matrix_vector_product(&x.run_function(output, &jacobian), &w);
        let contracted_constraint_terms = |x: &Values| {
            let change = sum_of_vectors(
                &matrix_vector_product(&x.run_function(output, &jacobian), &x.a),
                &x.run_function(output, &bias),
            );
            dot(&z, &change) + dot(&y, &x.run_function(output, &rates)) - dot(&lambda, &jacobian_times_w(x))
        };
        use DerivativeVariable::{A, Q, V};
        let (state, by_multipliers) = found.split_at(4 * nv * nv);
        let what = "curvature of constraints";
        self.compare_second_derivative_blocks(
            what,
            state,
            &[(Q, Q), (Q, V), (V, V), (Q, A)],
            &contracted_constraint_terms,
        );
        let columns: Vec<f64> =
            (0..nv).flat_map(|k| (0..nc).map(move |i| -by_multipliers[i * nv + k])).collect();
        self.compare_columns_with_differences(what, &columns, Q, &jacobian_times_w);
    }

    pub(super) fn check_contact_functions(&mut self) {
        let Some(gaps) = self.find_function("contact_gaps").cloned() else { return };
        self.check_contact_derivatives();
        let output = self.output;
        self.check_derivative_columns("contact_jacobian", "contact_rates", &[DerivativeVariable::V]);
        let rates = self.run_function_at_case_values("contact_rates");
        let (mut first, mut approach, mut of) = (0, Vec::new(), Vec::new());
        for (k, contact) in self.model.contacts.iter().enumerate() {
            if contact.pressed_by.is_none() {
                approach.push(rates[first]);
                of.push(k);
            }
            first += contact.rates.len();
        }
        // For the rim of a cylinder, the contact points at the current instant are evaluated. The motion of
        // these points along the rim is not differentiated.
        if self.name.contains(source::RIMS) {
            return;
        }
        let along = self.function_along_motion(move |x| {
            let gaps = x.run_function(output, &gaps);
            of.iter().map(|k| gaps[*k]).collect()
        });
        self.compare_with_derivative("gaps", &approach, &along);
    }

    /// Checks the derivatives of `Gᵀ f`, `G a + b` and the contact velocities `G v + …`.
    fn check_contact_derivatives(&mut self) {
        let found = self.run_function_at_case_values("__contact_derivatives");
        let names = ["contact_jacobian", "contact_bias", "contact_rates"];
        let [Some(jacobian), Some(bias), Some(rates)] = names.map(|name| self.find_function(name).cloned())
        else {
            return;
        };
        if found.is_empty() {
            return;
        }
        let (output, nv, nr) = (self.output, self.values.v.len(), self.values.contact_forces.len());
        let contact_joint_forces = |x: &Values| {
            let columns = x.run_function(output, &jacobian);
            (0..nv).map(|j| dot(&columns[j * nr..(j + 1) * nr], &x.contact_forces)).collect()
        };
        let contact_acceleration = |x: &Values| {
            sum_of_vectors(
                &matrix_vector_product(&x.run_function(output, &jacobian), &x.a),
                &x.run_function(output, &bias),
            )
        };
        let (first, rest) = found.split_at(nv * nv);
        let (second, rest) = rest.split_at(nr * nv);
        let (third, rest) = rest.split_at(nr * nv);
        self.compare_columns_with_differences(
            "forces at contacts",
            first,
            DerivativeVariable::Q,
            &contact_joint_forces,
        );
        self.compare_columns_with_differences(
            "changes at contacts",
            second,
            DerivativeVariable::Q,
            &contact_acceleration,
        );
        self.compare_columns_with_differences(
            "changes at contacts",
            third,
            DerivativeVariable::V,
            &contact_acceleration,
        );
        self.compare_columns_with_differences("rates at contacts", rest, DerivativeVariable::Q, &|x| {
            x.run_function(output, &rates)
        });
    }

    /// Checks the derivatives of `M a + h − Jᵀ λ`, `J a + b` and the constraint rates.
    pub(super) fn check_motion_equation_derivatives(&mut self) {
        let found = self.run_function_at_case_values("__motion_derivatives");
        let find_function = |name: &str| self.find_function(name).cloned();
        let (Some(inverse), Some(jacobian), Some(bias), Some(rates)) = (
            find_function("inverse_dynamics"),
            find_function("constraint_jacobian"),
            find_function("constraint_bias"),
            find_function("constraint_rates"),
        ) else {
            return;
        };
        if found.is_empty() {
            return;
        }
        let (output, nv, nc) = (self.output, self.values.v.len(), self.model.constraints.len());
        let residual_forces = |x: &Values| {
            let (columns, forces) = (x.run_function(output, &jacobian), x.run_function(output, &inverse));
            (0..nv)
                .map(|j| {
                    forces[j]
                        - dot(
                            &columns[j * nc..(j + 1) * nc],
                            &x.supplied_values(SuppliedQuantity::Multiplier)[..nc],
                        )
                })
                .collect()
        };
        let constraint_acceleration = |x: &Values| {
            sum_of_vectors(
                &matrix_vector_product(&x.run_function(output, &jacobian), &x.a),
                &x.run_function(output, &bias),
            )
        };
        let mut rest = &found[..];
        let mut take_next_entries = |n: usize| {
            let (part, after) = rest.split_at(n);
            rest = after;
            part
        };
        self.compare_columns_with_differences(
            "forces with multipliers",
            take_next_entries(nv * nv),
            DerivativeVariable::Q,
            &residual_forces,
        );
        self.compare_columns_with_differences(
            "forces with multipliers",
            take_next_entries(nv * nv),
            DerivativeVariable::V,
            &residual_forces,
        );
        self.compare_columns_with_differences(
            "changes of rates",
            take_next_entries(nc * nv),
            DerivativeVariable::Q,
            &constraint_acceleration,
        );
        self.compare_columns_with_differences(
            "changes of rates",
            take_next_entries(nc * nv),
            DerivativeVariable::V,
            &constraint_acceleration,
        );
        self.compare_columns_with_differences(
            "rates",
            take_next_entries(nc * nv),
            DerivativeVariable::Q,
            &|x| x.run_function(output, &rates),
        );
    }
}
