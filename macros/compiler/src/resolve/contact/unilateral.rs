//! Unilateral contacts: surfaces of bodies that separate and collide, and coordinates at their bounds.

use super::coefficients::{ContactCoefficients, read_contact_coefficients};
use super::collision::read_collisions;
use super::force::report_friction_without_rotation;
use super::geometry::CandidatePoint;
use super::pair::surfaces_in_accepted_order;
use super::read::read_surface;
use super::soft::read_compliance;
use super::surface::{Surface, SurfaceForm};
use crate::diag::{Diagnostics, Place};
use crate::expr::{Expr, Vec3};
use crate::kinematics::{time_derivatives_along_motion, velocity_gradient};
use crate::language::{BodyOrInertiaMethod, OtherKind};
use crate::mechanism::{Contact, Model, PolytopePair, Quantity};
use crate::resolve::element_forces::ElementForces;
use crate::resolve::power::{is_power_used, power_of_element};
use crate::resolve::scope::{ContactLoads, ElementPower, Scope, VectorTerms};
use crate::syntax::contact::link_in_collision_expression;
use crate::syntax::{self, ExprKind, GROUND};

const SUPPORTED_PAIRS: &str = "supported are points, spheres, circles, tori, ellipsoids, capsules, cuboids, \
                               hulls and cylinders with two ends on a plane; points and spheres also on a \
                               sphere, a capsule, a cylinder or a cone, or inside of a bowl, a tube or a \
                               funnel; capsules on each other; cuboids on each other; spheres and \
                               capsules on cuboids; spheres, capsules and cuboids on cylinders; \
                               cylinders on each other, if one has ends and their dimensions are numbers; \
                               spheres, capsules, cuboids, cylinders and hulls on hulls, if the points of \
                               hulls and the dimensions of the other surfaces are numbers; points, \
                               spheres, capsules, cuboids and hulls on a terrain";

/// Help text for surfaces that cannot be in contact because their dimensions are not numbers.
const POLYTOPE_HELP: &str = "write numbers in place of parameters, or approximate a surface by spheres";
/// Help text for unsupported contacts of cylinders.
const CYLINDER_HELP: &str = "a capsule of the same radius, or several spheres, can approximate a cylinder";

/// Contact points and forces of a declared contact, which the builder adds to the model.
#[derive(Default)]
pub struct ResolvedContact<'g> {
    /// Rigid contact points, and their friction against spin and rolling.
    pub contacts: Vec<Contact<'g>>,
    /// Positions of the rigid contact points, by the names of their contacts.
    pub points: Vec<(String, VectorTerms<'g>)>,
    /// Pairs of polytopes whose features determine contact points.
    pub polytopes: Vec<PolytopePair<'g>>,
    /// Forces of a compliant contact.
    pub forces: ElementForces<'g>,
    /// Forces and moments of the second surface on the first.
    pub loads: ContactLoads<'g>,
    /// Surfaces of both sides.
    pub surfaces: Vec<Surface<'g>>,
    /// Power of the contact, if an output uses it.
    pub power: Option<ElementPower<'g>>,
}

/// Returns the contact points and forces of a declared contact; `None` after an error. A contact of a file
/// whose surfaces do not move relative to each other has only surfaces. `model` has all contacts before it.
pub fn resolve_contact<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    contact: &syntax::Contact,
    cx: &mut Diagnostics,
) -> Option<ResolvedContact<'g>> {
    let coefficients = read_contact_coefficients(scope, contact, cx);
    let firsts = surfaces_of_contact_side(scope, &contact.first, cx);
    // Two bodies written instead of two surfaces are one error.
    let seconds = match firsts {
        None if !matches!(contact.second.kind, ExprKind::Method(..) | ExprKind::Call(..)) => None,
        _ => surfaces_of_contact_side(scope, &contact.second, cx),
    };
    let soft = contact.is_compliant().then(|| read_compliance(scope, &contact.arguments, cx));
    let (firsts, seconds, coefficients) = (firsts?, seconds?, coefficients?);
    let soft = match soft {
        Some(soft) => Some(soft?),
        None => None,
    };
    let mut polytopes = Vec::new();
    let points = contact_points_with_variable_distance(
        scope,
        model,
        contact,
        (&firsts, &seconds),
        &mut polytopes,
        cx,
    )?;
    if soft.is_some() && !polytopes.is_empty() {
        cx.report_error(contact.second.place.clone(), "contacts of these surfaces are rigid")
            .add_help("remove `stiffness` or `hertz`, or approximate a surface by others, such as spheres");
        return None;
    }
    let surfaces = [firsts, seconds].concat();
    let mut parts = ResolvedContact { surfaces, polytopes, ..ResolvedContact::default() };
    if points.is_empty() {
        return Some(parts);
    }
    report_friction_without_rotation(contact, &points, cx);
    let several = points.len() > 1;
    for (k, point) in points.iter().enumerate() {
        let name = &contact.name.text;
        let name = if several { format!("{name}.{k}") } else { name.clone() };
        match &soft {
            Some(soft) => {
                let forces = soft.forces_of_contact_point(point, coefficients, &mut parts.loads);
                parts.forces.potentials.extend(forces.potentials);
                parts.forces.loads.extend(forces.loads);
            }
            None => parts.add_rigid_contact_point(model, name, point, coefficients),
        }
    }
    if is_power_used(scope.description, &contact.name) {
        parts.power = Some(match (&soft, parts.loads.power) {
            (None, Some(power)) => Ok(power),
            _ => power_of_element(scope, model, &parts.forces, &contact.name.text),
        });
    }
    Some(parts)
}

/// Returns the points where the surfaces of a contact may touch, without those whose distance is constant,
/// and adds the pairs of polytopes among the surfaces.
fn contact_points_with_variable_distance<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    contact: &syntax::Contact,
    (firsts, seconds): (&[Surface<'g>], &[Surface<'g>]),
    polytopes: &mut Vec<PolytopePair<'g>>,
    cx: &mut Diagnostics,
) -> Option<Vec<CandidatePoint<'g>>> {
    let place = contact.first.place.extend_to_end_of(&contact.second.place);
    let is_of_file = contact.of_file.is_some()
        || [&contact.first, &contact.second]
            .iter()
            .any(|e| matches!(link_in_collision_expression(e), Some(None)));
    let mut points: Vec<CandidatePoint<'g>> = Vec::new();
    for first in firsts {
        for second in seconds {
            // Contacts of a file omit surfaces of the same link.
            if is_of_file && first.frame.link == second.frame.link {
                continue;
            }
            let places = (&contact.second, &place);
            points.extend(contact_candidate_points(scope, model, [first, second], places, polytopes, cx)?);
        }
    }
    let count = points.len();
    points.retain(|point| !velocity_gradient(point.rates[0].1).is_empty());
    if contact.of_file.is_some() && points.is_empty() {
        return Some(points);
    }
    if points.is_empty() || (points.len() < count && !is_of_file) {
        cx.report_error(place, "these surfaces cannot move relative to each other")
            .add_help("a contact is between surfaces of bodies that move relative to each other");
        return None;
    }
    Some(points)
}

impl<'g> ResolvedContact<'g> {
    /// Adds a rigid contact point, and its forces on the first surface. `model` has all contacts before.
    fn add_rigid_contact_point(
        &mut self,
        model: &Model<'g>,
        name: String,
        point: &CandidatePoint<'g>,
        coefficients: ContactCoefficients<'g>,
    ) {
        let [normal, slip @ ..] = point.rates;
        let slides = slip
            .into_iter()
            .filter(|(_, rate)| !coefficients.friction.is_zero() && !velocity_gradient(*rate).is_empty());
        let rates: Vec<(Vec3<'g>, Expr<'g>)> = std::iter::once(normal).chain(slides).collect();
        let normal_contact = model.contacts.len() + self.contacts.len();
        self.add_loads_along_directions(model, &rates, |loads, force| {
            loads.forces.push((point.ancestor, force))
        });
        self.points.push((name.clone(), point.place.clone()));
        let rates = rates.into_iter().map(|(_, rate)| rate).collect();
        self.contacts.push(coefficients.contact_with_coefficients(
            name.clone(),
            (point.gap, false),
            None,
            rates,
        ));
        for (word, about, coefficient) in
            [("spin", 0..1, coefficients.torsional), ("roll", 1..3, coefficients.rolling)]
        {
            let turns = about.map(|k| (point.rates[k].0, point.angular_rates[k]));
            let turns: Vec<_> = turns.filter(|(_, rate)| !velocity_gradient(*rate).is_empty()).collect();
            if !coefficient.is_zero() && !turns.is_empty() {
                self.add_loads_along_directions(model, &turns, |loads, moment| {
                    loads.moments.push((point.ancestor, moment))
                });
                let rates = turns.into_iter().map(|(_, rate)| rate).collect();
                let coefficients = ContactCoefficients {
                    friction: coefficient,
                    stiction: coefficient,
                    restitution: coefficient.zero(),
                    of_impulses: false,
                    ..coefficients
                };
                let name = format!("{name}.{word}");
                self.contacts.push(coefficients.contact_with_coefficients(
                    name,
                    (point.gap, false),
                    Some(normal_contact),
                    rates,
                ));
            }
        }
    }

    /// Adds the forces or moments along directions, each with its rate, and their power.
    fn add_loads_along_directions(
        &mut self,
        model: &Model<'g>,
        rates: &[(Vec3<'g>, Expr<'g>)],
        add: impl Fn(&mut ContactLoads<'g>, Vec3<'g>),
    ) {
        let own = self.contacts.iter().map(|contact| contact.rates.len());
        let first = model.contact_rates().len() + own.sum::<usize>();
        for (k, (direction, rate)) in rates.iter().enumerate() {
            let magnitude = Quantity::ContactForce(first + k).expr(model.graph);
            add(&mut self.loads, *direction * magnitude);
            self.loads.add_contact_power(magnitude * *rate);
        }
    }
}

/// Returns the points where two surfaces may touch, and adds the surfaces to the pairs of polytopes if their
/// features determine these points; `None` after an error.
fn contact_candidate_points<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    [first, second]: [&Surface<'g>; 2],
    (second_place, place): (&syntax::Expr, &Place),
    polytopes: &mut Vec<PolytopePair<'g>>,
    cx: &mut Diagnostics,
) -> Option<Vec<CandidatePoint<'g>>> {
    let first_link = first.frame.link;
    let mut pair = surfaces_in_accepted_order(
        scope,
        model,
        first.clone(),
        second.clone(),
        SurfaceForm::supports_contact_with,
        second_place,
        cx,
    )?;
    // Equals the velocity from the twists of links, with fewer terms to differentiate.
    let [x, y, z] =
        time_derivatives_along_motion(scope.configuration_space(), &pair.center.value.0, false)[..]
    else {
        return None;
    };
    pair.center.rate = Vec3([x, y, z]);
    let is_listed = pair.a.form.supports_contact_with(&pair.b.form);
    let candidate_contacts = match &pair.b.form {
        _ if !is_listed => Vec::new(),
        SurfaceForm::Hull(_) | SurfaceForm::Drum(..) if pair.features_are_selected_at_runtime() => {
            let known = polytopes.iter().map(PolytopePair::feature_count).sum::<usize>();
            match pair.polytope_contacts(model.polytope_feature_count() + known) {
                Ok((polytope_pair, contacts)) => {
                    polytopes.push(polytope_pair);
                    contacts
                }
                Err(message) => {
                    cx.report_error(place.clone(), message).add_help(POLYTOPE_HELP);
                    return None;
                }
            }
        }
        _ => pair.candidate_contacts(),
    };
    if candidate_contacts.is_empty() {
        let is_cylinder =
            |surface: &Surface<'g>| matches!(surface.form, SurfaceForm::Cylinder(..) | SurfaceForm::Drum(..));
        let help = match is_cylinder(first) || is_cylinder(second) {
            true => format!("{CYLINDER_HELP}; {SUPPORTED_PAIRS}"),
            false => SUPPORTED_PAIRS.to_string(),
        };
        cx.report_error(place.clone(), "the contact point of these surfaces is not supported").add_help(help);
        return None;
    }
    let side = scope.graph.num(if pair.a.frame.link == first_link { 1.0 } else { -1.0 });
    let [w_a, w_b] = pair.angular_velocities();
    let points = candidate_contacts.into_iter().map(|touch| {
        let slip = pair.slip(touch.point);
        let rates = touch.axes.map(|(_, e)| (e * side, e.dot(slip)));
        let angular_rates = touch.axes.map(|(_, e)| e.dot(w_a - w_b));
        let place = pair.contact_position(touch.point);
        CandidatePoint { gap: touch.gap, rates, angular_rates, ancestor: pair.on_a.ancestor, place }
    });
    Some(points.collect())
}

/// Returns the surfaces of one side of a contact: a surface, a point, or the collision geometry of a
/// file.
fn surfaces_of_contact_side<'g>(
    scope: &Scope<'_, 'g>,
    e: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<Vec<Surface<'g>>> {
    if let Some(link) = link_in_collision_expression(e) {
        return read_collisions(scope, e, link, cx);
    }
    let is_place = match &e.kind {
        ExprKind::Method(_, word, _) => word.id == Some(BodyOrInertiaMethod::At),
        ExprKind::Name(name) => name != GROUND,
        _ => false,
    };
    if is_place {
        return Some(vec![Surface { frame: scope.resolve_placement(e, cx)?, form: SurfaceForm::Point }]);
    }
    Some(vec![read_surface(scope, e, &format!("write `{}`", OtherKind::Contact.row().example), cx)?])
}

impl<'g> SurfaceForm<'g> {
    /// Whether the contact of this surface with another one is supported.
    fn supports_contact_with(&self, b: &SurfaceForm<'g>) -> bool {
        b.id().is_some_and(|id| id.row().contacts.contains(&self.id()))
    }
}
