//! Consistency of the functions of constraints and contacts with each other and with finite differences.

use super::agreement::{Case, TOLERANCE, dot, product, size, sum};
use super::source;
use super::values::{By, Values};
use linkwork_compiler::catalogue::{Record, Shape};
use linkwork_compiler::mechanism::Supplied;

impl Case<'_, '_> {
    pub(super) fn check_constraints(&mut self) {
        let (Some(rates), Some(residuals)) =
            (self.function("constraint_rates").cloned(), self.function("constraint_residuals").cloned())
        else {
            return;
        };
        let output = self.output;
        self.check_columns("constraint_jacobian", "constraint_rates", &[By::V]);
        let along = self.along_motion(|x| x.run(output, &residuals));
        let holonomic = self.here("constraint_residuals").len();
        self.compare("residuals", &self.here("constraint_rates")[..holonomic], &along);
        let jacobian = self.here("constraint_jacobian");
        let change = sum(&product(&jacobian, &self.values.a), &self.here("constraint_bias"));
        let along = self.along_motion(|x| x.run(output, &rates));
        self.compare("rates of constraints", &change, &along);
        self.check_constrained_dynamics(&jacobian);
    }

    /// Checks elimination with well-conditioned pivots: its result satisfies the equations of motion and the
    /// constraints.
    fn check_constrained_dynamics(&mut self, jacobian: &[f64]) {
        let Some(function) = self.function("__constrained_dynamics").cloned() else { return };
        let Shape::Record(Record::Elimination(nv, nc)) = function.shape else { return };
        let found = self.values.run(self.output, &function);
        let (a, rest) = found.split_at(nv);
        let (multipliers, rest) = rest.split_at(nc);
        let (pivots, before) = rest.split_at(nc);
        if !pivots.iter().zip(before).all(|(pivot, before)| *pivot > 1e-3 * before) {
            return;
        }
        let there = Values { a: a.to_vec(), ..self.values.clone() };
        let balance: Vec<f64> =
            (0..nv).map(|j| dot(&jacobian[j * nc..(j + 1) * nc], multipliers) + self.values.tau[j]).collect();
        let forces = self.run("inverse_dynamics", &there);
        let scale = 1.0 + size(&balance) + size(jacobian) * size(multipliers) + size(&forces);
        self.close("constrained dynamics", &forces, &balance, 1e-4 * TOLERANCE * scale);
        let change = sum(&product(jacobian, a), &self.here("constraint_bias"));
        let scale = 1.0 + size(jacobian) * size(a) + size(&self.here("constraint_bias"));
        self.close("constrained accelerations", &change, &vec![0.0; nc], 1e-4 * TOLERANCE * scale);
    }

    /// Checks the second derivatives of `−λᵀ J w + zᵀ (J a + b) + yᵀ (J v + …)`, and the derivative of `−J w`
    /// with respect to configuration, whose rows belong to the multipliers.
    pub(super) fn check_constraint_curvature(&mut self) {
        let found = self.here("__constraint_curvature");
        let find_function = |name: &str| self.function(name).cloned();
        let (Some(jacobian), Some(bias), Some(rates)) = (
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
        use Supplied::{AccelerationFactor, Direction, Multiplier, VelocityFactor};
        let [lambda, w, z, y] =
            [(Multiplier, nc), (Direction, nv), (AccelerationFactor, nc), (VelocityFactor, nc)]
                .map(|(block, count)| self.values.supplied(block)[..count].to_vec());
        let product_with_w = |x: &Values| product(&x.run(output, &jacobian), &w);
        let sum_of_all = |x: &Values| {
            let change = sum(&product(&x.run(output, &jacobian), &x.a), &x.run(output, &bias));
            dot(&z, &change) + dot(&y, &x.run(output, &rates)) - dot(&lambda, &product_with_w(x))
        };
        use By::{A, Q, V};
        let (state, by_multipliers) = found.split_at(4 * nv * nv);
        let what = "curvature of constraints";
        self.compare_blocks(what, state, &[(Q, Q), (Q, V), (V, V), (Q, A)], &sum_of_all);
        let columns: Vec<f64> =
            (0..nv).flat_map(|k| (0..nc).map(move |i| -by_multipliers[i * nv + k])).collect();
        self.compare_columns(what, &columns, Q, &product_with_w);
    }

    pub(super) fn check_contacts(&mut self) {
        let Some(gaps) = self.function("contact_gaps").cloned() else { return };
        self.check_contact_derivatives();
        let output = self.output;
        self.check_columns("contact_jacobian", "contact_rates", &[By::V]);
        let rates = self.here("contact_rates");
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
        let along = self.along_motion(move |x| {
            let gaps = x.run(output, &gaps);
            of.iter().map(|k| gaps[*k]).collect()
        });
        self.compare("gaps", &approach, &along);
    }

    /// Checks the derivatives of `Gᵀ f`, `G a + b` and the contact velocities `G v + …`.
    fn check_contact_derivatives(&mut self) {
        let found = self.here("__contact_derivatives");
        let find_function = |name: &str| self.function(name).cloned();
        let (Some(jacobian), Some(bias), Some(rates)) = (
            find_function("contact_jacobian"),
            find_function("contact_bias"),
            find_function("contact_rates"),
        ) else {
            return;
        };
        if found.is_empty() {
            return;
        }
        let (output, nv, nr) = (self.output, self.values.v.len(), self.values.contact_forces.len());
        let contact_joint_forces = |x: &Values| {
            let columns = x.run(output, &jacobian);
            (0..nv).map(|j| dot(&columns[j * nr..(j + 1) * nr], &x.contact_forces)).collect()
        };
        let contact_acceleration =
            |x: &Values| sum(&product(&x.run(output, &jacobian), &x.a), &x.run(output, &bias));
        let (first, rest) = found.split_at(nv * nv);
        let (second, rest) = rest.split_at(nr * nv);
        let (third, rest) = rest.split_at(nr * nv);
        self.compare_columns("forces at contacts", first, By::Q, &contact_joint_forces);
        self.compare_columns("changes at contacts", second, By::Q, &contact_acceleration);
        self.compare_columns("changes at contacts", third, By::V, &contact_acceleration);
        self.compare_columns("rates at contacts", rest, By::Q, &|x| x.run(output, &rates));
    }

    /// Checks the derivatives of `M a + h − Jᵀ λ`, `J a + b` and the constraint rates.
    pub(super) fn check_motion_derivatives(&mut self) {
        let found = self.here("__motion_derivatives");
        let find_function = |name: &str| self.function(name).cloned();
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
            let (columns, forces) = (x.run(output, &jacobian), x.run(output, &inverse));
            (0..nv)
                .map(|j| {
                    forces[j] - dot(&columns[j * nc..(j + 1) * nc], &x.supplied(Supplied::Multiplier)[..nc])
                })
                .collect()
        };
        let constraint_acceleration =
            |x: &Values| sum(&product(&x.run(output, &jacobian), &x.a), &x.run(output, &bias));
        let mut rest = &found[..];
        let mut part = |n: usize| {
            let (part, after) = rest.split_at(n);
            rest = after;
            part
        };
        self.compare_columns("forces with multipliers", part(nv * nv), By::Q, &residual_forces);
        self.compare_columns("forces with multipliers", part(nv * nv), By::V, &residual_forces);
        self.compare_columns("changes of rates", part(nc * nv), By::Q, &constraint_acceleration);
        self.compare_columns("changes of rates", part(nc * nv), By::V, &constraint_acceleration);
        self.compare_columns("rates", part(nc * nv), By::Q, &|x| x.run(output, &rates));
    }
}
