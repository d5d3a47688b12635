//! Momentum, kinetic energy, inertia and centre of mass of bodies and particles: `momentum(body)`,
//! `angular_momentum((first, second) / point)`, `kinetic_energy(body)`,
//! `moment_of_inertia(body / point, direction)`, `center_of_mass((first, second) / point)`.

use super::call::{Call, flatten_slashes};
use super::quantities::vector_value_from_terms;
use super::scope::{AllowedQuantities, MassProperties, PlacedElement, Scope, Value, VectorTerms};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::mechanism::Pose;
use crate::syntax::{self, ExprKind, words};

/// Quantity that a function of the language sums over bodies.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum SummedQuantity {
    /// Sum of the momenta.
    Momentum,
    /// Sum of the angular momenta about a point.
    AngularMomentum,
    /// Sum of the kinetic energies.
    Energy,
}

impl<'g> Scope<'_, 'g> {
    /// Returns the momentum, the angular momentum or the kinetic energy of bodies, for their motion relative
    /// to the ground. With the velocity `v` of the centre of mass, its position `r` relative to the point,
    /// and the central inertia `I`: `m v`, `I ω + r × m v`, `(m v·v + ω·I ω) / 2`.
    pub fn resolve_momentum_or_energy(
        &self,
        call: &Call<'_>,
        sum: SummedQuantity,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let (text, parts) = (call.function_name(), call.slash_operands());
        let (count, point) = if sum == SummedQuantity::AngularMomentum { (2, " / point") } else { (1, "") };
        if parts.len() != count {
            let row = call.id.row();
            let error = cx.report_error(call.place.clone(), format!("`{text}` takes {}", row.takes));
            match call.arguments.len() {
                0 | 1 => error.add_help(row.usage),
                _ => error.add_help(format!(
                    "several bodies are written in parentheses: `{text}((first, second){point})`"
                )),
            };
            return None;
        }
        if !self.check_allowed_quantity(AllowedQuantities::Motion, &format!("`{text}(…)`"), call.place, cx)
        {
            return None;
        }
        let bodies = self.resolve_bodies_with_mass(parts[0], cx)?;
        let about = match parts.get(1) {
            Some(e) => Some(self.placement_of_moving_point(e, cx)?),
            None => None,
        };
        let kinematics = &self.kinematics;
        let zero = Vec3::zero(self.graph);
        let (mut energy, mut momenta) = (self.graph.zero(), Vec::new());
        for (placed, (mass, com, central)) in bodies {
            let link = placed.link;
            let twist = link.map(|link| &kinematics.twists[link.0]);
            let (linear, w) = twist.map_or((zero, zero), |twist| (twist.linear, twist.angular));
            let center = placed.pose.transform_point(com);
            let v = linear + w.cross(center);
            let spin = placed.pose.rotation.symmetric_tensor_in_parent_axes(central) * w;
            energy += (v.dot(v) * mass + w.dot(spin)) * 0.5;
            let Some(about) = &about else {
                momenta.push((link, v * mass));
                continue;
            };
            let pose = Pose { translation: center, rotation: placed.pose.rotation.clone() };
            let offset = kinematics.position_between(&PlacedElement { pose, ..placed.clone() }, about);
            let r = kinematics.components_in_link_axes(&offset, link, zero);
            momenta.push((link, spin + r.cross(v * mass)));
        }
        Some(if sum == SummedQuantity::Energy {
            Value::Scalar(energy)
        } else {
            vector_value_from_terms(momenta)
        })
    }

    /// Resolves `center_of_mass((first, second) / point)`: the vector from a point to the centre of mass of
    /// bodies.
    pub fn resolve_center_of_mass(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let Ok([bodies_written, from]) = <[_; 2]>::try_from(call.slash_operands()) else {
            return call.report_wrong_arguments(cx);
        };
        if !self.check_allowed_quantity(AllowedQuantities::Placement, "`center_of_mass(…)`", call.place, cx)
        {
            return None;
        }
        let bodies = self.resolve_bodies_with_mass(bodies_written, cx)?;
        let from = self.placement_of_moving_point(from, cx)?;
        let total = bodies.iter().fold(self.graph.zero(), |sum, (_, (mass, ..))| sum + *mass);
        if total.is_zero() {
            cx.report_error(bodies_written.place.clone(), "a body without mass has no centre of mass")
                .add_help("name bodies with a `mass`");
            return None;
        }
        let kinematics = &self.kinematics;
        let mut sum = Vec::new();
        for (placed, (mass, com, _)) in bodies {
            let pose = Pose {
                translation: placed.pose.transform_point(com),
                rotation: placed.pose.rotation.clone(),
            };
            let offset = kinematics.position_between(&PlacedElement { pose, ..placed }, &from);
            let share = mass / total;
            sum.extend(offset.into_iter().map(|(link, r)| (link, r * share)));
        }
        Some(vector_value_from_terms(sum))
    }

    /// Returns the moment `a·J a` (for one direction) or the product `a·J b` of inertia of bodies about a
    /// point. `J = I + m (r·r 1 − r rᵀ)` is the physical inertia matrix, with the position `r` of the centre
    /// of mass relative to the point (the parallel-axis theorem). Several bodies are summed.
    pub fn resolve_moment_of_inertia(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let text = call.function_name();
        let (parts, directions) = match call.arguments {
            [of, directions @ ..] => (flatten_slashes(of), directions),
            [] => (Vec::new(), call.arguments),
        };
        let ([of, about], [a, others @ ..]) = (parts.as_slice(), directions) else {
            return call.report_wrong_arguments(cx);
        };
        if others.len() > 1 {
            cx.report_error(others[1].place.clone(), format!("`{text}` takes one direction or two"))
                .add_help("with two it is a product of inertia");
            return None;
        }
        if !self.check_allowed_quantity(AllowedQuantities::Placement, &format!("`{text}(…)`"), call.place, cx)
        {
            return None;
        }
        let bodies = self.resolve_bodies_with_mass(of, cx)?;
        let about = self.placement_of_moving_point(about, cx)?;
        let a = self.resolve_vector_terms(a, cx)?;
        let b = others.first().map_or_else(|| Some(a.clone()), |b| self.resolve_vector_terms(b, cx))?;
        let sum = bodies.iter().fold(self.graph.zero(), |sum, body| {
            sum + self.moment_of_inertia_about_point(body, &about, [&a, &b])
        });
        Some(Value::Scalar(sum))
    }

    /// Returns the moment of inertia `a·J b` of a body about a point.
    pub fn moment_of_inertia_about_point(
        &self,
        (placed, (mass, com, central)): &(PlacedElement<'g>, MassProperties<'g>),
        about: &PlacedElement<'g>,
        [a, b]: [&VectorTerms<'g>; 2],
    ) -> Expr<'g> {
        let kinematics = &self.kinematics;
        let (link, zero) = (placed.link, Vec3::zero(self.graph));
        let pose =
            Pose { translation: placed.pose.transform_point(*com), rotation: placed.pose.rotation.clone() };
        let offset = kinematics.position_between(&PlacedElement { pose, ..placed.clone() }, about);
        let [a, b, r] = [a, b, &offset].map(|parts| kinematics.components_in_link_axes(parts, link, zero));
        let central = placed.pose.rotation.symmetric_tensor_in_parent_axes(*central);
        let shift = (r.dot(r) * a.dot(b) - a.dot(r) * r.dot(b)) * *mass;
        a.dot(central * b) + shift
    }

    /// Returns the bodies and particles that an expression names: one name, or several names in parentheses.
    pub fn resolve_bodies_with_mass(
        &self,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Vec<(PlacedElement<'g>, MassProperties<'g>)>> {
        let (ExprKind::Tuple(items) | ExprKind::Array(items)) = &e.kind else {
            return Some(vec![self.resolve_body_with_mass(e, cx)?]);
        };
        if items.is_empty() {
            cx.report_error(e.place.clone(), "expected bodies, found none")
                .add_help("write `(first, second)`");
            return None;
        }
        let is_repeated_name = |k: usize| {
            items[..k].iter().any(|before| before.as_name().is_some_and(|n| items[k].as_name() == Some(n)))
        };
        if let Some(k) = (0..items.len()).find(|k| is_repeated_name(*k)) {
            cx.report_error(
                items[k].place.clone(),
                format!("`{}` is given twice", items[k].short_source_text()),
            )
            .add_help("name each body once");
            return None;
        }
        let all: Vec<_> = items.iter().map(|item| self.resolve_body_with_mass(item, cx)).collect();
        all.into_iter().collect()
    }

    /// Returns a body or particle with its mass, centre of mass and central inertia.
    pub fn resolve_body_with_mass(
        &self,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<(PlacedElement<'g>, MassProperties<'g>)> {
        let ExprKind::Name(name) = &e.kind else {
            cx.report_error(e.place.clone(), "expected a body").add_help("name a body or a particle");
            return None;
        };
        let kinematics = &self.kinematics;
        match (self.placement_of_element(name), kinematics.masses.get(name)) {
            (Some(placed), Some(masses)) => Some((placed, *masses)),
            // Its inertial parameters could not be read; the error has been reported.
            (Some(_), None) if !cx.is_empty() && self.bodies.contains(name) => None,
            (Some(_), None) => {
                cx.report_error(e.place.clone(), format!("`{name}` has no mass"))
                    .add_help("name a body or a particle");
                None
            }
            (None, _) => {
                if self.record_first_report(name, cx) {
                    let known: Vec<&str> = kinematics.masses.keys().map(String::as_str).collect();
                    let error = cx.report_error(e.place.clone(), format!("unknown body `{name}`"));
                    words::suggest_meaning_or_known_word(error, words::BODIES, name, &known);
                    if error.has_no_help() {
                        error.add_help("name a body or a particle");
                    }
                }
                None
            }
        }
    }
}
