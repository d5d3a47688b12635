//! Functions of flight mechanics: the standard atmosphere, and the angles of bodies and velocities. Body axes
//! are forward, right and down; ground axes are north, east and down.

use super::call::Call;
use super::expression::add_vectors_by_axes;
use super::functions::hypotenuse;
use super::scope::{Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Function, air};
use crate::language::names::AXES;
use crate::syntax::{self, ExprKind, GROUND, Name};

/// State of the standard atmosphere at a height.
pub struct Air<'g> {
    /// Temperature of the air, K.
    pub temperature: Expr<'g>,
    /// Pressure of the air, Pa.
    pub pressure: Expr<'g>,
}

impl<'g> Air<'g> {
    /// Returns the density of the air, kg/m³.
    pub fn density(&self) -> Expr<'g> {
        self.pressure / (self.temperature * air::GAS)
    }

    /// Returns the speed of sound in the air, m/s.
    pub fn speed_of_sound(&self) -> Expr<'g> {
        (self.temperature * (air::HEATS * air::GAS)).sqrt()
    }
}

impl<'g> Scope<'_, 'g> {
    /// Returns a value of the standard atmosphere at a height above sea level.
    pub fn resolve_standard_atmosphere(
        &self,
        call: &Call<'_>,
        value: fn(Air<'g>) -> Expr<'g>,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let [height] = self.resolve_scalars(call, cx)?;
        let number_expression = |n: f64| height.num(n);
        let geopotential =
            number_expression(air::RADIUS) * height / (number_expression(air::RADIUS) + height);
        let temperature = geopotential.apply_function(Function::IsaTemperature);
        let pressure = geopotential.apply_function(Function::IsaPressure);
        Some(Value::Scalar(value(Air { temperature, pressure })))
    }

    /// Returns an angle of a velocity relative to a body, computed from its components in the body's axes.
    pub fn resolve_aerodynamic_angle(
        &self,
        call: &Call<'_>,
        cx: &mut Diagnostics,
        angle: fn([Expr<'g>; 3]) -> Expr<'g>,
    ) -> Option<Value<'g>> {
        let [body, velocity] = call.take_arguments(cx)?;
        self.vector_components(velocity, body, cx).map(|parts| Value::Scalar(angle(parts)))
    }

    /// Returns an angle of a velocity, computed from its components in ground axes.
    pub fn resolve_velocity_angle(
        &self,
        call: &Call<'_>,
        cx: &mut Diagnostics,
        angle: fn([Expr<'g>; 3]) -> Expr<'g>,
    ) -> Option<Value<'g>> {
        let [velocity] = call.take_arguments(cx)?;
        self.vector_components(velocity, &ground_name_expression(call.place), cx)
            .map(|parts| Value::Scalar(angle(parts)))
    }

    /// Returns an angle of a body, computed from the components of its forward axis in ground axes.
    pub fn attitude_angle(
        &self,
        call: &Call<'_>,
        cx: &mut Diagnostics,
        angle: fn([Expr<'g>; 3]) -> Expr<'g>,
    ) -> Option<Value<'g>> {
        let [body] = call.take_arguments(cx)?;
        self.vector_components(&body_axis_expression(body, 0), &ground_name_expression(call.place), cx)
            .map(|parts| Value::Scalar(angle(parts)))
    }

    /// Returns the bank angle of a body, rad, from a call of `bank(body)`.
    pub fn resolve_bank_angle(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [body] = call.take_arguments(cx)?;
        let [_, right, below] =
            self.vector_components(&body_axis_expression(&ground_name_expression(call.place), 2), body, cx)?;
        Some(Value::Scalar(right.atan2(below)))
    }

    /// Returns a vector given by its components in stability axes, which are body axes rotated by the angle
    /// of attack, or in wind axes, which are also rotated by the sideslip angle: forward along the velocity,
    /// right, down (Etkin and Reid, *Dynamics of Flight*, 1996, § 1.6 and appendix A.7).
    pub fn vector_from_flight_axes(
        &self,
        call: &Call<'_>,
        of_wind: bool,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let [body, velocity, list] = call.take_arguments(cx)?;
        let ExprKind::Array(items) = &list.kind else {
            cx.report_error(list.place.clone(), "expected the three components in a list").add_help(format!(
                "as in `{}(airframe, velocity, [-drag, side, -lift])`",
                call.function_name()
            ));
            return None;
        };
        let [ahead, aside, below] = items.as_slice() else { return self.resolve_value(list, cx) };
        let [forward, right, down] = self.vector_components(velocity, body, cx)?;
        let parts =
            [self.resolve_scalar(ahead, cx), self.resolve_scalar(aside, cx), self.resolve_scalar(below, cx)];
        let [ahead, aside, below] = [parts[0]?, parts[1]?, parts[2]?];
        let plane = hypotenuse(forward, down);
        let (cosine, sine) = (forward / plane, down / plane);
        // Components along the velocity's projection onto the plane of symmetry, and to the right.
        let (along, across) = match of_wind {
            true => {
                let speed = hypotenuse(plane, right);
                let (straight, slip) = (plane / speed, right / speed);
                (ahead * straight - aside * slip, ahead * slip + aside * straight)
            }
            false => (ahead, aside),
        };
        let in_body = [along * cosine - below * sine, across, along * sine + below * cosine];
        let mut total = Vec::new();
        for (k, part) in in_body.into_iter().enumerate() {
            let along = self.resolve_vector(&body_axis_expression(body, k), cx)?;
            total = add_vectors_by_axes(total, along.into_iter().map(|(axes, v)| (axes, v * part)).collect());
        }
        Some(Value::Vector(total))
    }

    /// Returns the components of a vector along the axes of a body.
    fn vector_components(
        &self,
        vector: &syntax::Expr,
        body: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<[Expr<'g>; 3]> {
        if !matches!(body.kind, ExprKind::Name(_)) {
            cx.report_error(body.place.clone(), "expected the name of a body")
                .add_help("as in `angle_of_attack(body, velocity)`");
            return None;
        }
        let mut component_along_body_axis = |k: usize| {
            let (_, both) = self.resolve_in_common_axes(&[vector, &body_axis_expression(body, k)], cx)?;
            Some(both[0].dot(both[1]))
        };
        Some([component_along_body_axis(0)?, component_along_body_axis(1)?, component_along_body_axis(2)?])
    }
}

fn ground_name_expression(place: &crate::diag::Place) -> syntax::Expr {
    syntax::Expr { kind: ExprKind::Name(GROUND.to_string()), place: place.clone() }
}

/// Returns the expression `body.x`, `body.y` or `body.z` of an axis.
fn body_axis_expression(body: &syntax::Expr, k: usize) -> syntax::Expr {
    let text = AXES.get(k).unwrap_or(&AXES[0]).to_string();
    let member = Name { text, place: body.place.clone() };
    syntax::Expr { kind: ExprKind::Field(Box::new(body.clone()), member), place: body.place.clone() }
}
