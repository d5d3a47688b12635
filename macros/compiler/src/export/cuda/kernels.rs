//! Kernels that CUDA has in addition to the functions in C: products of row vectors with Jacobians.

use super::{Array, Batch, CodeParts};
use crate::catalogue::{Id, InverseForm};
use crate::derive::Output;
use crate::mechanism::Model;

/// Products of row vectors with the Jacobians of inverse and forward dynamics.
pub struct Products<'a> {
    parts: &'a CodeParts,
    nv: usize,
    time: bool,
    has: [bool; 2],
    /// Whether a function returns all columns of the inverse mass matrix without further steps.
    explicit_inverse: bool,
    reason: Option<&'static str>,
}

const NAMES: [&str; 2] = ["inverse_dynamics_vjp", "forward_dynamics_vjp"];

impl<'a> Products<'a> {
    /// Determines the vector–Jacobian products that a mechanism has.
    pub fn from_model(model: &Model<'_>, output: &Output, parts: &'a CodeParts) -> Products<'a> {
        let has_function = |name: &str| parts.functions.iter().any(|f| f.name == name);
        let is_plain = model.acceleration_forces.is_empty();
        let has_inverse = has_function("inverse_dynamics_derivatives") && has_function("mass_matrix");
        let has_forward =
            has_inverse && has_function("forward_dynamics") && has_function("mass_matrix_inverse");
        let has = [has_inverse, has_forward].map(|has| has && is_plain && model.nv() > 0);
        let inverse = output.functions.iter().find(|f| f.id == Id::MassMatrixInverse);
        Products {
            parts,
            nv: model.nv(),
            time: model.time,
            has: [0, 1].map(|k| has[k] && !has_function(NAMES[k])),
            explicit_inverse: inverse.is_some_and(|f| matches!(f.structure.inverse, InverseForm::Explicit)),
            reason: (!is_plain && has_inverse).then_some("forces depend on accelerations"),
        }
    }

    /// Returns the vector–Jacobian products that are not available, with reasons.
    pub fn left_out(&self) -> Vec<String> {
        let reason = self.reason.into_iter();
        reason.map(|why| format!("{}: {why}", NAMES.join(" and "))).collect()
    }

    /// Returns the signatures of the vector–Jacobian products.
    pub fn product_batches(&self) -> Vec<Batch> {
        let mut all = Vec::new();
        for (k, name) in NAMES.iter().enumerate().filter(|(k, _)| self.has[*k]) {
            let of = ["inverse_dynamics", "forward_dynamics"][k];
            let Some(function) = self.parts.functions.iter().find(|f| f.name == of) else { continue };
            let mut batch = Batch { name: (*name).to_string(), ..function.clone() };
            batch.arguments.push(Array::new("w", self.nv));
            let by = ["by_q", "by_v", ["by_a", "by_tau"][k]];
            batch.results = by.map(|name| Array::new(name, self.nv)).to_vec();
            batch.docs = vec![format!(
                "Products of a row vector `w` with the Jacobians of `{of}` by its arguments: the gradient of \
                 a loss by them, with `w` the gradient of the loss by the result. The gradient by `q` is \
                 along displacements, as `integrate` takes them."
            )];
            all.push(batch);
        }
        all
    }

    /// Writes the definitions of the vector–Jacobian products.
    pub fn write_product_definitions(&self, out: &mut String) {
        let p = &self.parts.prefix;
        let has_own = !(self.parts.parameters.is_empty() && self.parts.tables.is_empty());
        let own_declared = if has_own { format!("const {p} *self, ") } else { String::new() };
        let texts = [
            include_str!("templates/inverse_dynamics_vjp.cu"),
            include_str!("templates/forward_dynamics_vjp.cu"),
        ];
        out.push('\n');
        for (text, _) in texts.iter().zip(self.has).filter(|(_, has)| *has) {
            let inverse = match self.explicit_inverse {
                true => include_str!("templates/product_with_inverse.cu"),
                false => include_str!("templates/product_with_stored_inverse.cu"),
            };
            let text = text
                .replace("@INVERSE@", inverse)
                .replace("@OWN_DECLARED@", &own_declared)
                .replace("@OWN@", if has_own { "self, " } else { "" })
                .replace("@T_DECLARED@", if self.time { "double t, " } else { "" })
                .replace("@T@", if self.time { "t, " } else { "" })
                .replace("@PREFIX@", p)
                .replace("@NV@", &self.nv.to_string());
            out.push_str(&text);
        }
    }
}
