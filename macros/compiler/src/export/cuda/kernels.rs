//! Kernels that CUDA has in addition to the functions in C: products of row vectors with Jacobians.

use super::super::mechanism::ExportedMechanism;
use super::super::signatures::{ArrayArgument, ExportedSignature};
use super::super::template::TemplateValues;
use crate::catalogue::{GeneratedId, InverseForm};

/// Products of row vectors with the Jacobians of inverse and forward dynamics.
pub struct VectorJacobianProducts<'a> {
    i: &'a ExportedMechanism<'a>,
    has: [bool; 2],
    /// Whether a function returns all columns of the inverse mass matrix without further steps.
    explicit_inverse: bool,
    reason: Option<&'static str>,
}

const NAMES: [&str; 2] = ["inverse_dynamics_vjp", "forward_dynamics_vjp"];

impl<'a> VectorJacobianProducts<'a> {
    /// Determines the vector–Jacobian products that a mechanism has.
    pub fn from_mechanism(i: &'a ExportedMechanism<'a>) -> VectorJacobianProducts<'a> {
        let has_function = |name: &str| i.signature(name).is_some();
        let is_plain = i.model.acceleration_forces.is_empty();
        let has_inverse = has_function("inverse_dynamics_derivatives") && has_function("mass_matrix");
        let has_forward =
            has_inverse && has_function("forward_dynamics") && has_function("mass_matrix_inverse");
        let has = [has_inverse, has_forward].map(|has| has && is_plain && i.nv() > 0);
        let inverse = i.find_derived_function(GeneratedId::MassMatrixInverse);
        VectorJacobianProducts {
            i,
            has: [0, 1].map(|k| has[k] && !has_function(NAMES[k])),
            explicit_inverse: inverse.is_some_and(|f| matches!(f.structure.inverse, InverseForm::Explicit)),
            reason: (!is_plain && has_inverse).then_some("forces depend on accelerations"),
        }
    }

    /// Returns the vector–Jacobian products that are not available, with reasons.
    pub fn unavailable_products_with_reasons(&self) -> Vec<String> {
        let reason = self.reason.into_iter();
        reason.map(|why| format!("{}: {why}", NAMES.join(" and "))).collect()
    }

    /// Returns the signatures of the vector–Jacobian products.
    pub fn product_signatures(&self) -> Vec<ExportedSignature> {
        let mut all = Vec::new();
        for (k, name) in NAMES.iter().enumerate().filter(|(k, _)| self.has[*k]) {
            let of = ["inverse_dynamics", "forward_dynamics"][k];
            let Some(function) = self.i.signature(of) else { continue };
            let mut product = ExportedSignature { name: (*name).to_string(), ..function.clone() };
            product.arguments.push(ArrayArgument::vector("w", self.i.nv()));
            let by = ["by_q", "by_v", ["by_a", "by_tau"][k]];
            product.results = by.map(|name| ArrayArgument::vector(name, self.i.nv())).to_vec();
            product.docs = vec![format!(
                "Products of a row vector `w` with the Jacobians of `{of}` by its arguments: the gradient of \
                 a loss by them, with `w` the gradient of the loss by the result. The gradient by `q` is \
                 along displacements, as `integrate` takes them."
            )];
            all.push(product);
        }
        all
    }

    /// Returns the definitions of the vector–Jacobian products.
    pub fn product_definitions(&self) -> String {
        let text_if = |holds: bool, text: &'static str| if holds { text } else { "" };
        let inverse = match self.explicit_inverse {
            true => include_str!("templates/product_with_inverse.cu"),
            false => include_str!("templates/product_with_stored_inverse.cu"),
        };
        let (takes_parameter_struct, time) = (self.i.takes_parameter_struct(), self.i.model.time);
        let mut template = TemplateValues::default();
        template.add_value("INVERSE", &inverse);
        template.add_value("OWN_DECLARED", &text_if(takes_parameter_struct, "const @PREFIX@ *self, "));
        template.add_value("OWN", &text_if(takes_parameter_struct, "self, "));
        template.add_value("T_DECLARED", &text_if(time, "double t, "));
        template.add_value("T", &text_if(time, "t, "));
        template.add_value("PREFIX", &self.i.prefix);
        template.add_value("NV", &self.i.nv());
        let texts = [
            include_str!("templates/inverse_dynamics_vjp.cu"),
            include_str!("templates/forward_dynamics_vjp.cu"),
        ];
        texts.iter().zip(self.has).filter(|(_, has)| *has).map(|(text, _)| template.fill(text)).collect()
    }
}
