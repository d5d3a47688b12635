//! Compliant contacts: forces that depend on penetration and its rate (Hunt and Crossley, *Coefficient of
//! restitution interpreted as damping in vibroimpact*, J. Appl. Mech. 42, 1975), with friction that is smooth
//! in the slip velocity.

use super::coefficients::ContactCoefficients;
use super::geometry::CandidatePoint;
use crate::diag::Diagnostics;
use crate::expr::{Expr, Extreme, Vec3};
use crate::kinematics::velocity_gradient;
use crate::language::Key;
use crate::mechanism::{Load, Rule};
use crate::resolve::element_forces::ElementForces;
use crate::resolve::scope::{AllowedQuantities, ContactLoads, Context, Scope};
use crate::syntax::{self, WrittenArguments};

/// Default slip speed below which friction of compliant contacts is regularised, m/s.
const DEFAULT_SLIP_SPEED: f64 = 1e-3;

/// Offset under the square root of the penetration, m, which keeps its derivative finite at zero.
const ROOT_OFFSET: f64 = 1e-30;

/// Stiffness and dissipation of a compliant contact, as expressions.
pub(super) struct ContactCompliance<'g> {
    stiffness: Expr<'g>,
    hertz: bool,
    dissipation: Expr<'g>,
    speed: Expr<'g>,
}

impl<'g> ContactCompliance<'g> {
    /// Returns the effects of a contact point: potential energy of the penetration, dissipation and friction.
    pub(super) fn forces_of_contact_point(
        &self,
        point: &CandidatePoint<'g>,
        coefficients: ContactCoefficients<'g>,
        exerted: &mut ContactLoads<'g>,
    ) -> ElementForces<'g> {
        let g = point.gap.graph();
        let overlap = (-point.gap).minimum_or_maximum(Extreme::Max, g.zero());
        let root = if self.hertz { (overlap + g.num(ROOT_OFFSET)).sqrt() } else { g.num(1.0) };
        let elastic = self.stiffness * overlap * root;
        let energy = elastic * overlap * g.num(if self.hertz { 0.4 } else { 0.5 });
        let mut forces = ElementForces::forces_of_potentials([energy]);
        let [(normal, rate), tangents @ ..] = point.rates;
        // Surfaces do not pull at each other.
        let damping = (-(elastic * self.dissipation * rate)).minimum_or_maximum(Extreme::Max, -elastic);
        let pressure = elastic + damping;
        if !self.dissipation.is_zero() {
            forces.loads.push(Load { rate, force: damping, dissipative: true });
        }
        exerted.forces.push((point.ancestor, normal * pressure));
        for (about, most) in [(0..1, coefficients.torsional), (1..3, coefficients.rolling)] {
            let turns: Vec<_> = about.map(|k| (point.rates[k].0, point.angular_rates[k])).collect();
            let moments = add_friction_moments(&turns, most, pressure, self.speed, &mut forces);
            exerted.moments.extend(moments.into_iter().map(|moment| (point.ancestor, moment)));
        }
        let friction = coefficients.friction;
        if friction.is_zero() {
            return forces;
        }
        let slip = tangents.iter().fold(self.speed.square(), |sum, (_, rate)| sum + rate.square()).sqrt();
        for (direction, rate) in tangents {
            if velocity_gradient(rate).is_empty() {
                continue;
            }
            let force = -(friction * pressure * rate / slip);
            forces.loads.push(Load { rate, force, dissipative: true });
            exerted.forces.push((point.ancestor, direction * force));
        }
        forces
    }
}

/// Reads stiffness and dissipation; `None` after an error.
pub(super) fn read_compliance<'g>(
    scope: &Scope<'_, 'g>,
    given: &WrittenArguments,
    cx: &mut Diagnostics,
) -> Option<ContactCompliance<'g>> {
    let g = scope.graph;
    let mut read_checked_constant = |e: &syntax::Expr, what: &str, rule: Rule| {
        let value = scope
            .call_in_context(Context::new(AllowedQuantities::Constant, None), |s| s.resolve_scalar(e, cx))?;
        let positive = rule == Rule::Positive;
        if let Some(n) = value.constant_value().filter(|n| *n < 0.0 || positive && *n == 0.0) {
            let must = if positive { "must be positive" } else { "cannot be negative" };
            cx.report_error(e.place.clone(), format!("the {what} of a contact {must}, but it is {n}"));
            return None;
        }
        scope.record_parameter_condition(rule, || format!("the {what} of a contact"), &[value]);
        Some(value)
    };
    let (linear, hertz) = (given.expression_of_key(Key::Stiffness), given.expression_of_key(Key::Hertz));
    let stiffness = linear.or(hertz).and_then(|e| read_checked_constant(e, "stiffness", Rule::Positive));
    let dissipation = match given.expression_of_key(Key::Dissipation) {
        Some(e) => read_checked_constant(e, "dissipation", Rule::NotNegative),
        None => Some(g.zero()),
    };
    let speed = match given.expression_of_key(Key::Speed) {
        Some(e) => read_checked_constant(e, "speed", Rule::Positive),
        None => Some(g.num(DEFAULT_SLIP_SPEED)),
    };
    Some(ContactCompliance {
        stiffness: stiffness?,
        hertz: linear.is_none(),
        dissipation: dissipation?,
        speed: speed?,
    })
}

/// Adds and returns friction moments about directions, each with its angular velocity. The maximum moment
/// is `coefficient` times the normal force. The moment is smaller if `coefficient` times the angular
/// velocity is below the regularisation speed.
fn add_friction_moments<'g>(
    rotations: &[(Vec3<'g>, Expr<'g>)],
    coefficient: Expr<'g>,
    pressure: Expr<'g>,
    speed: Expr<'g>,
    forces: &mut ElementForces<'g>,
) -> Vec<Vec3<'g>> {
    if coefficient.is_zero() {
        return Vec::new();
    }
    let square = rotations.iter().fold(speed.square(), |sum, (_, rate)| sum + (coefficient * *rate).square());
    let magnitude = square.sqrt();
    let mut moments = Vec::new();
    for (direction, rate) in rotations.iter().filter(|(_, rate)| !velocity_gradient(*rate).is_empty()) {
        let force = -(coefficient * pressure * (coefficient * *rate) / magnitude);
        forces.loads.push(Load { rate: *rate, force, dissipative: true });
        moments.push(*direction * force);
    }
    moments
}
