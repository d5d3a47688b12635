//! Quantities that depend on accelerations: time derivatives of velocity-dependent expressions, and forces
//! that are linear in the accelerations.

use super::quantities::{vector_terms_by_link, vector_value_from_terms};
use super::resolved::ResolvedMatrix;
use super::scope::{AllowedQuantities, Scope, Value};
use crate::diag::{Diagnostics, Place};
use crate::expr::{Expr, Mat3, Vec3};
use crate::kinematics::{symbols_in, time_derivative, velocity_gradients};
use crate::mechanism::{ConfigurationSpace, Model, Quantity};
use crate::syntax::{self, ExprKind};

impl<'g> Scope<'_, 'g> {
    /// Returns the time derivative of a scalar expression along the motion.
    pub fn resolve_time_derivative(
        &self,
        function: &Place,
        argument: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Expr<'g>> {
        match self.resolve_value(argument, cx)? {
            Value::Scalar(value) => Some(self.time_derivatives(function, &argument.place, &[value], cx)?[0]),
            Value::Matrix(_) => {
                cx.report_error(argument.place.clone(), "the rate of a matrix is relative to a frame")
                    .add_help("write `rate(matrix / frame)`");
                None
            }
            Value::Vector(_) => {
                cx.report_error(argument.place.clone(), "the rate of a vector is relative to a frame")
                    .add_help("write `rate(vector / frame)`; the rate of its length is `rate(norm(vector))`");
                None
            }
        }
    }

    /// Resolves `rate(vector / frame)`: the time derivative of a vector or a matrix in a frame, that is, of
    /// its components in that frame.
    pub fn resolve_rate_in_frame(
        &self,
        function: &Place,
        argument: &syntax::Expr,
        frame: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let terms = match self.resolve_value(argument, cx)? {
            Value::Vector(terms) => terms,
            Value::Matrix(m) => {
                let link = self.resolve_frame_link(frame, cx)?;
                let entries = self.kinematics.matrix_in_link_axes(m, link).entries;
                let all: Vec<Expr<'g>> = entries.0.iter().flatten().copied().collect();
                let rates = self.time_derivatives(function, &argument.place, &all, cx)?;
                return Some(Value::Matrix(ResolvedMatrix {
                    link,
                    entries: Mat3::from_fn(|i, j| rates[3 * i + j]),
                }));
            }
            Value::Scalar(_) => {
                cx.report_error(argument.place.clone(), "expected a vector, found a scalar")
                    .add_help("the rate of a scalar needs no frame: `rate(scalar)`");
                return None;
            }
        };
        let link = self.resolve_frame_link(frame, cx)?;
        let components = self.kinematics.components_in_link_axes(
            &vector_terms_by_link(terms),
            link,
            Vec3::zero(self.graph),
        );
        let rates = self.time_derivatives(function, &argument.place, &components.0, cx)?;
        Some(vector_value_from_terms(vec![(link, Vec3([rates[0], rates[1], rates[2]]))]))
    }

    /// Returns the time derivatives of several expressions along the motion.
    fn time_derivatives(
        &self,
        function: &Place,
        place: &Place,
        values: &[Expr<'g>],
        cx: &mut Diagnostics,
    ) -> Option<Vec<Expr<'g>>> {
        let quantities: Vec<Quantity> = symbols_in(values).into_iter().map(Quantity::from_symbol).collect();
        let uses_quantity_where = |what: fn(&Quantity) -> bool| quantities.iter().any(what);
        let state_with_index = |k: &usize| {
            self.description
                .states
                .iter()
                .any(|(_, state)| state == k)
                .then(|| self.description.parameters.get(*k))
                .flatten()
        };
        let state = quantities
            .iter()
            .find_map(|q| if let Quantity::Parameter(k) = q { state_with_index(k) } else { None });
        if let Some(state) = state {
            cx.report_error(place.clone(), format!("this depends on the state `{}`", state.text)).add_help(
                "`rate` applies to expressions of coordinates, velocities and time: write the rate of the \
                 state itself",
            );
            return None;
        }
        if uses_quantity_where(|q| matches!(q, Quantity::Input(_))) {
            cx.report_error(place.clone(), "this depends on inputs, whose rates are not known")
                .add_help("a `State` that follows an input with a lag has a rate");
            return None;
        }
        if uses_quantity_where(|q| {
            matches!(q, Quantity::Acceleration(_) | Quantity::Reaction(_) | Quantity::ContactForce(_))
        }) {
            cx.report_error(
                place.clone(),
                "this depends on accelerations or forces, whose rates are not known",
            )
            .add_help("`rate` applies to expressions of coordinates, velocities and time");
            return None;
        }
        let gradients = velocity_gradients(values);
        let needed = if gradients.iter().all(Vec::is_empty) {
            AllowedQuantities::Motion
        } else {
            AllowedQuantities::Acceleration
        };
        let what = match needed {
            AllowedQuantities::Motion => "a rate",
            _ => "the rate of an expression of velocities",
        };
        if !self.check_allowed_quantity(needed, what, function, cx) {
            return None;
        }
        let kinematics = &self.kinematics;
        let space = ConfigurationSpace { graph: self.graph, charts: &kinematics.charts, speeds: None };
        let time_derivative_of_value = |(value, gradient): (&Expr<'g>, Vec<(usize, Expr<'g>)>)| {
            let terms = gradient.into_iter().map(|(k, d)| d * Quantity::Acceleration(k).expr(self.graph));
            terms.fold(time_derivative(space, *value), |sum, term| sum + term)
        };
        Some(values.iter().zip(gradients).map(time_derivative_of_value).collect())
    }

    /// Whether the argument of `rate` is an expression of moving quantities, or the name of a definition,
    /// instead of a coordinate.
    pub fn is_moving_expression(&self, argument: &syntax::Expr) -> bool {
        match &argument.kind {
            ExprKind::Name(name) => {
                self.description.definitions.iter().any(|definition| definition.name.text == *name)
            }
            ExprKind::Call(..) | ExprKind::Binary(..) | ExprKind::Neg(..) => true,
            _ => false,
        }
    }
}

/// Reports forces that are linear in accelerations in mechanisms with constraints or contacts. The constraint
/// and contact forces are computed with a symmetric mass matrix.
pub fn check_acceleration_forces(model: &Model<'_>, cx: &mut Diagnostics) {
    let Some(force) = model.acceleration_forces.first() else { return };
    let found = match (model.constraints.is_empty(), model.contacts.is_empty()) {
        (true, true) => return,
        (false, _) => "constraints, such as joints that close loops",
        (true, false) => "contacts that open and close",
    };
    cx.report_error(
        force.place.clone(),
        format!("a force cannot depend on accelerations in a mechanism with {found}"),
    )
    .add_help("connect the bodies by joints that form a tree, or remove these terms");
}
