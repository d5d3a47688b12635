//! Contact forces and friction moments as functions in output expressions.

use super::geometry::CandidatePoint;
use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::kinematics::{symbols_in, velocity_gradient};
use crate::language::Key;
use crate::mechanism::{LinkId, Quantity};
use crate::resolve::call::Call;
use crate::resolve::scope::{AllowedQuantities, Axes, Scope, Value};
use crate::syntax;

/// Whether expressions use no contact forces, or use them without reactions and accelerations. Reactions and
/// accelerations are those of the motion without contact forces.
pub fn uses_contact_forces_consistently(values: &[Expr<'_>]) -> bool {
    let quantities: Vec<Quantity> = symbols_in(values).into_iter().map(Quantity::from_symbol).collect();
    let uses_quantity_where = |f: fn(&Quantity) -> bool| quantities.iter().any(f);
    !uses_quantity_where(|q| matches!(q, Quantity::ContactForce(_)))
        || !uses_quantity_where(|q| matches!(q, Quantity::Reaction(_) | Quantity::Acceleration(_)))
}

impl<'g> Scope<'_, 'g> {
    /// Resolves `contact_force(name)`: the force of the second surface on the first, summed over the contact
    /// points.
    pub fn contact_force(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let name = self.contact_name_argument(call, cx)?;
        let kinematics = &self.kinematics;
        Some(sum_forces_by_axes(&kinematics.contact_loads.get(name)?.forces))
    }

    /// Resolves `contact_moment(name)`: the moment of friction of the second surface on the first,
    /// against spin and rolling.
    pub fn contact_moment(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let name = self.contact_name_argument(call, cx)?;
        let kinematics = &self.kinematics;
        let moments = &kinematics.contact_loads.get(name)?.moments;
        if moments.is_empty() {
            cx.report_error(call.arguments[0].place.clone(), format!("`{name}` has no moments of friction"))
                .add_help("`torsional = …` and `rolling = …`, m, are moments per normal force");
            return None;
        }
        Some(sum_forces_by_axes(moments))
    }

    /// Returns the name of the contact that is the argument of a function.
    fn contact_name_argument<'e>(&self, call: &Call<'e>, cx: &mut Diagnostics) -> Option<&'e str> {
        let kinematics = &self.kinematics;
        let contact_names = || kinematics.contact_loads.keys().map(String::as_str);
        let [e] = call.take_arguments(cx)?;
        let Some(name) = e.as_name() else {
            cx.report_error(e.place.clone(), "expected a contact").suggest_name("", contact_names());
            return None;
        };
        if !self.check_allowed_quantity(AllowedQuantities::Reaction, "a force at a contact", call.place, cx) {
            return None;
        }
        if !kinematics.contact_loads.contains_key(name) {
            if self.record_first_report(name, cx) {
                let error = cx.report_error(e.place.clone(), format!("unknown contact `{name}`"));
                error.suggest_name(name, contact_names());
                if error.has_no_help() {
                    error.add_help(
                        "name a field of type `Contact`; the forces of stops are among those of \
                         `contact::acting`",
                    );
                }
            }
            return None;
        }
        Some(name)
    }
}

/// Returns the sum of forces, grouped by the links in whose axes they are expressed.
fn sum_forces_by_axes<'g>(forces: &[(Option<LinkId>, Vec3<'g>)]) -> Value<'g> {
    let mut terms: Vec<(Axes, Vec3<'g>)> = Vec::new();
    for (link, force) in forces {
        let axes = Axes::Link(*link);
        match terms.iter_mut().find(|(known, _)| *known == axes) {
            Some((_, sum)) => *sum += *force,
            None => terms.push((axes, *force)),
        }
    }
    Value::Vector(terms)
}

/// Reports coefficients of torsional or rolling friction at contacts without the corresponding rotation.
pub(super) fn report_friction_without_rotation(
    contact: &syntax::Contact,
    points: &[CandidatePoint<'_>],
    cx: &mut Diagnostics,
) {
    let has_no_rotation =
        |axis: usize| points.iter().all(|point| velocity_gradient(point.angular_rates[axis]).is_empty());
    let checks = [
        (Key::TorsionalFriction, "about the normal of this contact", has_no_rotation(0)),
        (
            Key::RollingFriction,
            "about the tangents of this contact",
            has_no_rotation(1) && has_no_rotation(2),
        ),
    ];
    for (key, about, _) in
        checks.into_iter().filter(|(.., has_no_rotation)| *has_no_rotation && contact.of_file.is_none())
    {
        let Some(e) = contact.arguments.expression_of_key(key) else { continue };
        cx.report_error(e.place.clone(), format!("no friction moment acts {about}"))
            .add_help("`torsional` resists rotation about the normal, `rolling` rotation about the tangents");
    }
}
