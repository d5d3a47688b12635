//! Drag of a fluid with density and viscosity → Rayleigh dissipation functions.
//!
//! The model is MuJoCo's inertia box model (*Computation*, "Passive forces", "Inertia model"): each body is
//! replaced by the box with its mass and principal moments, and the drag acts on each side of the box
//! separately. With the edges `a`, `b`, `c`, their mean `d`, the density `ρ` and the viscosity `β`, the force
//! along the edge `a` is `−½ ρ b c |v| v − 3π d β v` and the torque about it is `−ρ a (b⁴ + c⁴) |ω| ω / 64 −
//! π d³ β ω`.

use super::geometry::BodyMassProperties;
use super::joint::IGNORE_PASSIVE;
use super::reader::MjcfReader;
use super::spatial::BodyFrame;
use crate::diag::Place;
use crate::import::context::Cx;
use crate::import::element::element_source_position;
use crate::import::pose::{NumericPose, eigen_decomposition, transpose};
use crate::syntax::{BinaryOp, Expr, ExprKind, GROUND, Name};
use std::f64::consts::PI;

impl MjcfReader<'_> {
    /// Adds the drag of the fluid to all bodies, if the file has a fluid.
    pub(super) fn add_fluid_drag(&mut self, cx: &mut Cx<'_>) {
        if !self.passive || self.settings.medium.is_empty() {
            return;
        }
        let (mut density, mut viscosity, mut at) = (0.0, 0.0, None);
        for (which, found) in &self.settings.medium {
            match *which {
                "density" => density = found.value[0],
                "viscosity" => viscosity = found.value[0],
                _ => {
                    let message =
                        format!("the `{which}` of a medium that bodies move through is not supported");
                    cx.report_error(&found.place, message, |d| d.add_help(IGNORE_PASSIVE));
                }
            }
            at = Some(found.place.clone());
        }
        if density < 0.0 || viscosity < 0.0 {
            let message = format!("a medium of the density {density} and the viscosity {viscosity}");
            cx.report_error(&at.clone().unwrap_or(self.options.path.place.clone()), message, |d| {
                d.add_help("expected numbers that are not negative").add_help(IGNORE_PASSIVE)
            });
            return;
        }
        let shaped = self.shaped.take();
        if let Some(shaped) = shaped {
            cx.report_error(&shaped, "`fluidshape` in a medium is not supported", |d| {
                d.add_help(IGNORE_PASSIVE)
            });
        }
        let Some(at) = at else { return };
        let masses = self.robot.links.iter().zip(&self.masses);
        let functions: Vec<(Name, Expr)> = masses
            .filter_map(|(link, mass)| {
                let mass = mass.as_ref().filter(|mass| mass.mass > 0.0)?;
                let text = format!("{}_medium", link.name.text);
                let function = fluid_dissipation_function(&link.name.text, mass, [density, viscosity], &at);
                Some((Name { text, place: at.clone() }, function))
            })
            .collect();
        self.robot.dissipations.extend(functions);
    }

    /// Records a shape with an individual fluid model, which is not supported.
    pub(super) fn record_unsupported_fluid_shape(
        &mut self,
        shape: &super::defaults::ElementWithDefaults<'_>,
        cx: &Cx<'_>,
    ) {
        if shape.trimmed_attribute_text("fluidshape").is_some_and(|word| word != "none") {
            self.shaped.get_or_insert(element_source_position(shape.node, cx));
        }
    }
}

/// Returns the Rayleigh dissipation function of the drag on a body: half of the dissipated power of linear
/// terms plus a third of that of quadratic terms.
fn fluid_dissipation_function(
    link: &str,
    mass: &BodyMassProperties,
    [density, viscosity]: [f64; 2],
    at: &Place,
) -> Expr {
    let (moments, axes) = eigen_decomposition(&mass.inertia);
    let sum: f64 = moments.iter().sum();
    let edges = moments.map(|moment| ((sum - 2.0 * moment).max(0.0) / mass.mass * 6.0).sqrt());
    let mean = edges.iter().sum::<f64>() / 3.0;
    let name_expression = |text: &str| Expr { kind: ExprKind::Name(text.to_string()), place: at.clone() };
    let spot = BodyFrame { body: link.to_string(), pose: NumericPose { at: mass.com, ..NumericPose::ZERO } };
    let quotient = |a, b| Expr::binary_operation(BinaryOp::Div, a, b);
    let path = quotient(
        quotient(spot.position_expression_of_spot(at), name_expression(GROUND)),
        name_expression(GROUND),
    );
    let v = Expr::function_call_expression("v", vec![path], at);
    let omega = Expr::function_call_expression(
        "omega",
        vec![quotient(name_expression(link), name_expression(GROUND))],
        at,
    );
    let scaled_expression =
        |factor: f64, e: Expr| Expr::binary_operation(BinaryOp::Mul, Expr::number_at(factor, at), e);
    let mut terms = Vec::new();
    if viscosity > 0.0 {
        for (factor, of) in [(1.5 * PI * mean, &v), (0.5 * PI * mean * mean * mean, &omega)] {
            terms.push(scaled_expression(
                factor * viscosity,
                Expr::function_call_expression("dot", vec![of.clone(), of.clone()], at),
            ));
        }
    }
    if density > 0.0 {
        for (k, axis) in transpose(&axes).into_iter().enumerate() {
            let [a, b, c] = [edges[k], edges[(k + 1) % 3], edges[(k + 2) % 3]];
            for (factor, of) in [(b * c / 6.0, &v), (a * (b * b * b * b + c * c * c * c) / 192.0, &omega)] {
                let x = Expr::function_call_expression(
                    "dot",
                    vec![of.clone(), spot.body_axes_vector_expression(axis, at)],
                    at,
                );
                let square = Expr::binary_operation(BinaryOp::Mul, x.clone(), x.clone());
                let cube = Expr::binary_operation(
                    BinaryOp::Mul,
                    Expr::function_call_expression("abs", vec![x], at),
                    square,
                );
                terms.push(scaled_expression(factor * density, cube));
            }
        }
    }
    let sum = terms.into_iter().reduce(|a, b| Expr::binary_operation(BinaryOp::Add, a, b));
    sum.unwrap_or_else(|| Expr::number_at(0.0, at))
}
