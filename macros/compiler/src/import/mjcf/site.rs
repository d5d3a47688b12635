//! Actuators on sites: a force and a torque in the axes of the site, or in the axes of a reference site,
//! which receives the reaction.

use super::activation::OTHER_INPUTS;
use super::defaults::ElementWithDefaults;
use super::reader::MjcfReader;
use super::spatial::BodyFrame;
use crate::import::context::{Cx, quote_word};
use crate::import::pose::{Vector, matrix_times_vector};
use crate::syntax::{BinaryOp, Expr, ExprKind, FileForceTarget, GROUND, Name, Wrench};

impl<'a> MjcfReader<'a> {
    /// Returns what an actuator on a site acts on, and whether its force is a torque. Without a reference
    /// site, the length of the actuator is zero (MuJoCo, *Modeling*, "general/refsite").
    pub(super) fn site_transmission(
        &self,
        site: &Name,
        element: &ElementWithDefaults<'a>,
        servo: bool,
        cx: &mut Cx<'_>,
    ) -> Option<(FileForceTarget, bool)> {
        let spot = self.find_site(site, cx)?;
        let usual = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let [x, y, z, a, b, c] =
            element.numbers_with_defaults("gear", usual, cx).map_or(usual, |gear| gear.value);
        let (force, torque) = ([x, y, z], [a, b, c]);
        let turns = force == [0.0; 3];
        let at = &site.place;
        let Some(other) = element.attribute_text_with_span("refsite", cx) else {
            let vector_in_body = |vector| matrix_times_vector(&spot.pose.axes, vector);
            let (force, torque) = (vector_in_body(force), vector_in_body(torque));
            let wrench = Wrench { on: spot.position_expression_of_spot(at), force, torque, against: None };
            return Some((FileForceTarget::Wrench(wrench), turns));
        };
        let against = self.find_site(&other, cx)?;
        if !self.is_ancestor_or_same(&against.body, &spot.body) {
            let message = format!(
                "a `refsite` that does not carry the site {} is not supported",
                quote_word(&site.text)
            );
            cx.report_error(&other.place, message, |d| d.add_help(OTHER_INPUTS));
            return None;
        }
        if servo && torque != [0.0; 3] {
            let message = "a servo on the orientation of a site is not supported";
            cx.report_error(&element.place_of_attribute_value("gear", cx), message, |d| {
                d.add_help(OTHER_INPUTS)
            });
            return None;
        }
        let vector_in_body = |vector| matrix_times_vector(&against.pose.axes, vector);
        let (force, torque) = (vector_in_body(force), vector_in_body(torque));
        if torque == [0.0; 3] {
            let path = Expr::binary_operation(
                BinaryOp::Div,
                spot.position_expression_of_spot(at),
                against.position_expression_of_spot(at),
            );
            let path = Expr::function_call_expression("r", vec![path], at);
            return Some((
                FileForceTarget::Length(Expr::function_call_expression(
                    "dot",
                    vec![path, against.body_axes_vector_expression(force, at)],
                    at,
                )),
                turns,
            ));
        }
        let against = Some(against.position_expression_of_spot(at));
        Some((
            FileForceTarget::Wrench(Wrench {
                on: spot.position_expression_of_spot(at),
                force,
                torque,
                against,
            }),
            turns,
        ))
    }

    /// Returns true if the bodies are equal or `carrier` is an ancestor of `carried`.
    fn is_ancestor_or_same(&self, carrier: &str, carried: &str) -> bool {
        let mut at = carried;
        while at != carrier {
            let Some(joint) = self.robot.joints.iter().find(|joint| joint.child.text == at) else {
                return carrier == GROUND;
            };
            at = &joint.parent.text;
        }
        true
    }
}

impl BodyFrame {
    /// Returns the expression of a vector whose components are given in the axes of the body.
    pub(super) fn body_axes_vector_expression(&self, vector: Vector, at: &crate::diag::Place) -> Expr {
        let axis_of_body_expression = |k: usize| {
            let body = Expr { kind: ExprKind::Name(self.body.clone()), place: at.clone() };
            let name = Name { text: ["x", "y", "z"][k].to_string(), place: at.clone() };
            Expr { kind: ExprKind::Field(Box::new(body), name), place: at.clone() }
        };
        let terms = (0..3).filter(|k| vector[*k] != 0.0);
        let terms = terms.map(|k| {
            Expr::binary_operation(BinaryOp::Mul, Expr::number_at(vector[k], at), axis_of_body_expression(k))
        });
        terms
            .reduce(|a, b| Expr::binary_operation(BinaryOp::Add, a, b))
            .unwrap_or_else(|| Expr::vector_at([0.0; 3], at))
    }
}
