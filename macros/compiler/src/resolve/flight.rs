//! Functions of flight: the standard atmosphere, and the angles of bodies and velocities whose axes are
//! forward, right and down, the ground's north, east and down.

use super::expression::sum;
use super::scope::{Scope, Value};
use super::slips::wrong_count;
use crate::diag::Diagnostics;
use crate::expr::{Expr, Function, air};
use crate::syntax::{self, ExprKind, GROUND, Name};

/// Functions of a height above the sea.
pub const OF_HEIGHT: [&str; 4] = ["density", "pressure", "temperature", "speed_of_sound"];

/// Functions of a body, of a velocity, or of both.
pub const ANGLES: [&str; 7] =
    ["angle_of_attack", "sideslip", "heading", "elevation", "bank", "course", "flight_path"];

impl<'g> Scope<'_, 'g> {
    /// The standard atmosphere at a height above the sea.
    pub fn air(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let [height] = arguments else { return wrong_count(function, 1, cx) };
        let height = self.scalar(height, cx)?;
        let number = |n: f64| height.num(n);
        let geopotential = number(air::RADIUS) * height / (number(air::RADIUS) + height);
        let temperature = geopotential.call(Function::IsaTemperature);
        let pressure = geopotential.call(Function::IsaPressure);
        Some(Value::Scalar(match function.text.as_str() {
            "temperature" => temperature,
            "pressure" => pressure,
            "density" => pressure / (temperature * air::GAS),
            _ => (temperature * (air::HEATS * air::GAS)).sqrt(),
        }))
    }

    /// An angle of a body, of a velocity, or of one against the other.
    pub fn flight_angle(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let text = function.text.as_str();
        let place = &function.place;
        let ground = named(GROUND, place);
        Some(Value::Scalar(match (text, arguments) {
            ("angle_of_attack" | "sideslip", [body, velocity]) => {
                let [forward, right, down] = self.components(velocity, body, cx)?;
                match text {
                    "sideslip" => right.atan2(length(forward, down)),
                    _ => down.atan2(forward),
                }
            }
            ("angle_of_attack" | "sideslip", _) => return wrong_count(function, 2, cx),
            ("course" | "flight_path", [velocity]) => {
                let [north, east, down] = self.components(velocity, &ground, cx)?;
                match text {
                    "course" => east.atan2(north),
                    _ => (-down).atan2(length(north, east)),
                }
            }
            ("bank", [body]) => {
                let down = axis(&ground, 2);
                let [_, right, below] = self.components(&down, body, cx)?;
                right.atan2(below)
            }
            (_, [body]) => {
                let [north, east, down] = self.components(&axis(body, 0), &ground, cx)?;
                match text {
                    "heading" => east.atan2(north),
                    _ => (-down).atan2(length(north, east)),
                }
            }
            _ => return wrong_count(function, 1, cx),
        }))
    }

    /// A vector by its components in the axes of stability, which turn with the angle of attack, or of wind,
    /// which turn with the sideslip, too: forward along the velocity, right, down (Etkin and Reid, *Dynamics
    /// of Flight*, 1996, § 1.6 and appendix A.7).
    pub fn in_flight_axes(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let [body, velocity, list] = arguments else { return wrong_count(function, 3, cx) };
        let ExprKind::Array(items) = &list.kind else {
            cx.error(list.place.clone(), "expected the three components in a list")
                .help(format!("as in `{}(airframe, velocity, [-drag, side, -lift])`", function.text));
            return None;
        };
        let [ahead, aside, below] = items.as_slice() else { return self.value(list, cx) };
        let [forward, right, down] = self.components(velocity, body, cx)?;
        let parts = [self.scalar(ahead, cx), self.scalar(aside, cx), self.scalar(below, cx)];
        let [ahead, aside, below] = [parts[0]?, parts[1]?, parts[2]?];
        let plane = length(forward, down);
        let (cosine, sine) = (forward / plane, down / plane);
        // In the plane of symmetry along the velocity, then to the right.
        let (along, across) = match function.text.as_str() {
            "wind_axes" => {
                let speed = length(plane, right);
                let (straight, slip) = (plane / speed, right / speed);
                (ahead * straight - aside * slip, ahead * slip + aside * straight)
            }
            _ => (ahead, aside),
        };
        let in_body = [along * cosine - below * sine, across, along * sine + below * cosine];
        let mut total = Vec::new();
        for (k, part) in in_body.into_iter().enumerate() {
            let along = self.vector(&axis(body, k), cx)?;
            total = sum(total, along.into_iter().map(|(axes, v)| (axes, v * part)).collect());
        }
        Some(Value::Vector(total))
    }

    /// The components of a vector along the axes of a body.
    fn components(
        &self,
        vector: &syntax::Expr,
        body: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<[Expr<'g>; 3]> {
        if !matches!(body.kind, ExprKind::Name(_)) {
            cx.error(body.place.clone(), "expected the name of a body")
                .help("as in `angle_of_attack(body, velocity)`");
            return None;
        }
        let mut along = |k: usize| {
            let (_, both) = self.common_axes(&[vector, &axis(body, k)], cx)?;
            Some(both[0].dot(both[1]))
        };
        Some([along(0)?, along(1)?, along(2)?])
    }
}

/// The length of two perpendicular components.
fn length<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    (a.square() + b.square()).sqrt()
}

fn named(name: &str, place: &crate::diag::Place) -> syntax::Expr {
    syntax::Expr { kind: ExprKind::Name(name.to_string()), place: place.clone() }
}

/// An axis of a body.
fn axis(body: &syntax::Expr, k: usize) -> syntax::Expr {
    let text = ["x", "y", "z"].get(k).unwrap_or(&"x").to_string();
    let member = Name { text, place: body.place.clone() };
    syntax::Expr { kind: ExprKind::Field(Box::new(body.clone()), member), place: body.place.clone() }
}
