//! Unilateral contacts: surfaces of bodies that separate and collide, and coordinates at their bounds.

use super::cylinders::{Drum, capsule_on_pipe};
use super::force::check_relative_rotation;
use super::geometry::{FLAT_RIM, clamp, nearest, rim};
use super::hull::sphere_on_hull;
use super::surface::{Surface, SurfaceForm};
use super::terrain::Terrain;
use super::{PointContact, SurfacePair, perpendicular_directions, sphere_contact, support_point};
use crate::diag::{Diagnostics, Place};
use crate::expr::{Expr, Vec3};
use crate::kinematics::{motion_rates, velocity_gradient};
use crate::language::{Key, Method, OtherKind};
use crate::mechanism::{Contact, LinkId, Quantity, Rule};
use crate::resolve::builder::Builder;
use crate::resolve::element_forces::Forces;
use crate::resolve::motion::Moving;
use crate::resolve::power::is_power_used;
use crate::resolve::scope::{Allowed, ContactLoads, Context, Terms};
use crate::syntax::contact::{MAX_CONTACT_POINTS, collision_link};
use crate::syntax::{self, ExprKind, GROUND, WrittenArguments};

const SUPPORTED_PAIRS: &str = "supported are points, spheres, circles, tori, ellipsoids, capsules, cuboids, \
                               hulls and cylinders with two ends on a plane; points and spheres also on a \
                               sphere, a capsule, a cylinder or a cone, or inside of a bowl, a tube or a \
                               funnel; capsules on each other; cuboids on each other; spheres and \
                               capsules on cuboids; spheres, capsules and cuboids on cylinders; spheres on \
                               hulls whose points are numbers; points, spheres, capsules, cuboids and \
                               hulls on a terrain";

/// Help text for unsupported contacts of cylinders.
const CYLINDER_HELP: &str = "a capsule of the same radius, or several spheres, can approximate a cylinder";

/// Coefficients of friction and restitution of a contact.
#[derive(Clone, Copy)]
pub(super) struct ContactCoefficients<'g> {
    pub(super) friction: Expr<'g>,
    /// Coefficient of static friction of the contact.
    pub(super) stiction: Expr<'g>,
    /// Maximum friction moment about the normal per unit normal force, m.
    pub(super) torsional: Expr<'g>,
    /// Maximum friction moment about the tangents per unit normal force, m.
    pub(super) rolling: Expr<'g>,
    pub(super) restitution: Expr<'g>,
    /// Whether restitution is a ratio of impulses (Poisson) instead of velocities (Newton).
    pub(super) of_impulses: bool,
}

/// Point at which two surfaces may touch, with its gap and directions.
pub(super) struct CandidatePoint<'g> {
    /// Signed distance of the surfaces at the point, m.
    pub(super) gap: Expr<'g>,
    /// Normal and two tangents, towards the first surface, each with the velocity along it.
    pub(super) rates: [(Vec3<'g>, Expr<'g>); 3],
    /// Relative angular velocity about the normal and each tangent.
    pub(super) angular_rates: [Expr<'g>; 3],
    /// Link in whose axes the directions are expressed.
    pub(super) ancestor: Option<LinkId>,
    /// Position of the contact point.
    pub(super) place: Terms<'g>,
}

impl<'g> Builder<'_, 'g> {
    /// Adds all contacts to the model: declared contacts in their order, then the stops of limits.
    pub fn add_contacts(&mut self, _: Moving, cx: &mut Diagnostics) {
        let description = self.description;
        for contact in &description.contacts {
            self.add_contact(contact, cx);
        }
        for limit in description.limits.iter().filter(|limit| limit.arguments.get(Key::Restitution).is_some())
        {
            self.add_stops(limit, cx);
        }
        let count = self.model.contacts.len();
        if count > MAX_CONTACT_POINTS {
            let place = description.contacts.first().map_or(&description.name.place, |c| &c.name.place);
            cx.report_error(
                place.clone(),
                format!("{count} points of contact, more than {MAX_CONTACT_POINTS}"),
            )
            .add_help("each adds code: use fewer contact points, or divide the mechanism");
        }
    }

    fn add_contact(&mut self, contact: &syntax::Contact, cx: &mut Diagnostics) {
        let coefficients = self.read_coefficients(contact, cx);
        let firsts = self.contact_surfaces(&contact.first, cx);
        // Two bodies written instead of two surfaces are one error.
        let seconds = match firsts {
            None if !matches!(contact.second.kind, ExprKind::Method(..) | ExprKind::Call(..)) => None,
            _ => self.contact_surfaces(&contact.second, cx),
        };
        let soft = contact.is_compliant().then(|| self.read_compliance(&contact.arguments, cx));
        let (Some(firsts), Some(seconds), Some(coefficients)) = (firsts, seconds, coefficients) else {
            return;
        };
        if let Some(None) = soft {
            return;
        }
        let place = contact.first.place.extend_to(&contact.second.place);
        let whole = [&contact.first, &contact.second].iter().any(|e| matches!(collision_link(e), Some(None)));
        let mut points: Vec<CandidatePoint<'g>> = Vec::new();
        for first in &firsts {
            for second in &seconds {
                // A contact of all links of a file omits surfaces of the same link.
                if whole && first.frame.link == second.frame.link {
                    continue;
                }
                let Some(found) = self.candidate_points(first, second, (&contact.second, &place), cx) else {
                    return;
                };
                points.extend(found);
            }
        }
        let separable: Vec<&CandidatePoint<'g>> =
            points.iter().filter(|point| !velocity_gradient(point.rates[0].1).is_empty()).collect();
        if contact.of_file && separable.is_empty() {
            return;
        }
        if separable.is_empty() || (separable.len() < points.len() && !whole && !contact.of_file) {
            cx.report_error(place, "these surfaces cannot move relative to each other")
                .add_help("a contact is between surfaces of bodies that move relative to each other");
            return;
        }
        check_relative_rotation(contact, &separable, cx);
        let (several, mut exerted) = (separable.len() > 1, ContactLoads::default());
        let mut all = Forces::default();
        for (k, point) in separable.into_iter().enumerate() {
            let name = &contact.name.text;
            let name = if several { format!("{name}.{k}") } else { name.clone() };
            match soft.as_ref().and_then(Option::as_ref) {
                Some(soft) => {
                    let forces = self.soft_point(point, coefficients, soft, &mut exerted);
                    all.potentials.extend(forces.potentials);
                    all.loads.extend(forces.loads);
                }
                None => self.add_point(name, point, coefficients, &mut exerted),
            }
        }
        if is_power_used(self.description, &contact.name) {
            let power = match (&soft, exerted.power) {
                (None, Some(power)) => Ok(power),
                _ => self.power_of(&all, &contact.name.text),
            };
            self.scope.kinematics.powers.insert(contact.name.text.clone(), power);
        }
        all.add_to(&mut self.model);
        self.scope.kinematics.contact_loads.insert(contact.name.text.clone(), exerted);
    }

    /// Returns the points where two surfaces may touch; `None` after an error.
    fn candidate_points(
        &self,
        first: &Surface<'g>,
        second: &Surface<'g>,
        (second_place, place): (&syntax::Expr, &Place),
        cx: &mut Diagnostics,
    ) -> Option<Vec<CandidatePoint<'g>>> {
        let first_link = first.frame.link;
        let mut pair = self.ordered_pair(
            first.clone(),
            second.clone(),
            SurfaceForm::has_contact_with,
            second_place,
            cx,
        )?;
        // Equals the velocity from the twists of links, with fewer terms to differentiate.
        let [x, y, z] = motion_rates(self.model.configuration_space(), &pair.center.value.0, false)[..]
        else {
            return None;
        };
        pair.center.rate = Vec3([x, y, z]);
        let is_listed = pair.a.form.has_contact_with(&pair.b.form);
        let candidate_contacts = if is_listed { self.candidate_contacts(&pair) } else { Vec::new() };
        if candidate_contacts.is_empty() {
            let is_cylinder = |surface: &Surface<'g>| {
                matches!(surface.form, SurfaceForm::Cylinder(..) | SurfaceForm::Drum(..))
            };
            let help = match is_cylinder(first) || is_cylinder(second) {
                true => format!("{CYLINDER_HELP}; {SUPPORTED_PAIRS}"),
                false => SUPPORTED_PAIRS.to_string(),
            };
            cx.report_error(place.clone(), "the contact point of these surfaces is not supported")
                .add_help(help);
            return None;
        }
        let side = self.scope.graph.num(if pair.a.frame.link == first_link { 1.0 } else { -1.0 });
        let [w_a, w_b] = self.angular_velocities(&pair);
        let points = candidate_contacts.into_iter().map(|touch| {
            let slip = self.slip(&pair, touch.point);
            let rates = touch.axes.map(|(_, e)| (e * side, e.dot(slip)));
            let angular_rates = touch.axes.map(|(_, e)| e.dot(w_a - w_b));
            let place = self.contact_position(&pair, touch.point);
            CandidatePoint { gap: touch.gap, rates, angular_rates, ancestor: pair.on_a.ancestor, place }
        });
        Some(points.collect())
    }

    /// Adds a contact point to the model, and its forces on the first surface to `exerted`.
    fn add_point(
        &mut self,
        name: String,
        point: &CandidatePoint<'g>,
        coefficients: ContactCoefficients<'g>,
        exerted: &mut ContactLoads<'g>,
    ) {
        let [normal, slip @ ..] = point.rates;
        let slides = slip
            .into_iter()
            .filter(|(_, rate)| !coefficients.friction.is_zero() && !velocity_gradient(*rate).is_empty());
        let rates: Vec<(Vec3<'g>, Expr<'g>)> = std::iter::once(normal).chain(slides).collect();
        let number = self.model.contact_rates().len();
        for (k, (direction, rate)) in rates.iter().enumerate() {
            let force = Quantity::ContactForce(number + k).expr(self.scope.graph);
            exerted.forces.push((point.ancestor, *direction * force));
            exerted.add_power(force * *rate);
        }
        let rates = rates.into_iter().map(|(_, rate)| rate).collect();
        let presses = self.model.contacts.len();
        self.contact_points.insert(name.clone(), point.place.clone());
        self.push_contact(name.clone(), (point.gap, false), None, rates, coefficients);
        let none = self.scope.graph.zero();
        for (word, about, coefficient) in
            [("spin", 0..1, coefficients.torsional), ("roll", 1..3, coefficients.rolling)]
        {
            let turns = about.map(|k| (point.rates[k].0, point.angular_rates[k]));
            let turns: Vec<_> = turns.filter(|(_, rate)| !velocity_gradient(*rate).is_empty()).collect();
            if !coefficient.is_zero() && !turns.is_empty() {
                let number = self.model.contact_rates().len();
                for (k, (direction, rate)) in turns.iter().enumerate() {
                    let moment = Quantity::ContactForce(number + k).expr(self.scope.graph);
                    exerted.moments.push((point.ancestor, *direction * moment));
                    exerted.add_power(moment * *rate);
                }
                let rates = turns.into_iter().map(|(_, rate)| rate).collect();
                let name = format!("{name}.{word}");
                let coefficients = ContactCoefficients {
                    friction: coefficient,
                    stiction: coefficient,
                    restitution: none,
                    of_impulses: false,
                    ..coefficients
                };
                self.push_contact(name, (point.gap, false), Some(presses), rates, coefficients);
            }
        }
    }

    pub(super) fn push_contact(
        &mut self,
        name: String,
        (gap, turns): (Expr<'g>, bool),
        pressed_by: Option<usize>,
        rates: Vec<Expr<'g>>,
        ContactCoefficients { friction, stiction, restitution, of_impulses, .. }: ContactCoefficients<'g>,
    ) {
        let contact =
            Contact { name, gap, turns, pressed_by, rates, friction, stiction, restitution, of_impulses };
        self.model.contacts.push(contact);
    }

    /// Reads the coefficients of a contact; `None` after an error.
    fn read_coefficients(
        &self,
        contact: &syntax::Contact,
        cx: &mut Diagnostics,
    ) -> Option<ContactCoefficients<'g>> {
        let (name, given) = (&contact.name.text, &contact.arguments);
        let mut read = |key, what| self.coefficient(given.get(key), what, Rule::NotNegative, name, cx);
        let friction = read(Key::Friction, "friction");
        let stiction = match given.get(Key::StaticFriction) {
            Some(_) => read(Key::StaticFriction, "static friction"),
            None => friction,
        };
        let torsional = read(Key::TorsionalFriction, "torsional friction");
        let rolling = read(Key::RollingFriction, "rolling friction");
        let restitution = self.restitution(given, name, cx);
        let (friction, stiction) = (friction?, stiction?);
        if let Some(e) = given.get(Key::StaticFriction).filter(|_| given.get(Key::Friction).is_some()) {
            match (friction.constant_value(), stiction.constant_value()) {
                (Some(kinetic), Some(static_value)) if static_value < kinetic || kinetic == 0.0 => {
                    let message = match kinetic == 0.0 {
                        true => format!("`{name}` has stiction, but no sliding friction"),
                        false => format!("stiction, {static_value}, is less than friction, {kinetic}"),
                    };
                    cx.report_error(e.place.clone(), message).add_help(
                        "`friction` is the coefficient while surfaces slide, `stiction` the larger one at \
                         rest",
                    );
                    return None;
                }
                _ => {
                    let quantity = || format!("the friction of `{name}` and its stiction");
                    self.scope.record_requirement(Rule::Order, quantity, &[friction, stiction]);
                }
            }
        }
        Some(ContactCoefficients {
            friction,
            stiction,
            torsional: torsional?,
            rolling: rolling?,
            restitution: restitution.0?,
            of_impulses: restitution.1,
        })
    }

    /// Reads a coefficient of restitution, `None` after an error, and whether it is a ratio of impulses.
    pub(super) fn restitution(
        &self,
        given: &WrittenArguments,
        name: &str,
        cx: &mut Diagnostics,
    ) -> (Option<Expr<'g>>, bool) {
        let (e, of_impulses) = given.get(Key::Restitution).map(syntax::restitution_coefficient).unzip();
        let value = self.coefficient(e, "restitution", Rule::Fraction, name, cx);
        (value, of_impulses == Some(true))
    }

    /// Reads a coefficient, zero if it is absent; `None` after an error.
    pub(super) fn coefficient(
        &self,
        e: Option<&syntax::Expr>,
        what: &str,
        rule: Rule,
        name: &str,
        cx: &mut Diagnostics,
    ) -> Option<Expr<'g>> {
        let Some(e) = e else { return Some(self.scope.graph.zero()) };
        let value =
            self.scope.in_context(Context::new(Allowed::Constant, None), |s| s.resolve_scalar(e, cx))?;
        let maximum = if rule == Rule::Fraction { 1.0 } else { f64::INFINITY };
        if let Some(n) = value.constant_value().filter(|n| !(0.0..=maximum).contains(n)) {
            let range = if maximum < 2.0 { "must be between 0 and 1" } else { "cannot be negative" };
            cx.report_error(e.place.clone(), format!("a coefficient of {what} {range}, but it is {n}"))
                .add_help(match maximum < 2.0 {
                    true => {
                        "the ratio of the speeds after and before the impact: 0 without rebound, 1 without \
                         loss of energy"
                    }
                    false => "it opposes the motion by definition: give its magnitude",
                });
            return None;
        }
        self.scope.record_requirement(rule, || format!("the {what} of `{name}`"), &[value]);
        Some(value)
    }

    /// Returns the surfaces of one side of a contact: a surface, a point, or the collision geometry of a
    /// file.
    pub(super) fn contact_surfaces(
        &self,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Vec<Surface<'g>>> {
        if let Some(link) = collision_link(e) {
            return self.collisions(e, link, cx);
        }
        let is_place = match &e.kind {
            ExprKind::Method(_, word, _) => word.id == Some(Method::At),
            ExprKind::Name(name) => name != GROUND,
            _ => false,
        };
        if is_place {
            return Some(vec![Surface {
                frame: self.scope.resolve_placement(e, cx)?,
                form: SurfaceForm::Point,
            }]);
        }
        Some(vec![self.surface(e, &format!("write `{}`", OtherKind::Contact.row().example), cx)?])
    }

    /// Returns the points at which a pair of surfaces may touch.
    fn candidate_contacts(&self, pair: &SurfacePair<'g>) -> Vec<PointContact<'g>> {
        let g = self.scope.graph;
        let rotate_a = |v| self.first_direction(pair, v).value;
        let rotate_b = |v| self.second_direction(pair, v).value;
        let c = pair.center.value - pair.base.value;
        if let SurfaceForm::Terrain(terrain) = &pair.b.form {
            return self.terrain_contacts(pair, terrain, c, &rotate_b);
        }
        if let SurfaceForm::Cuboid(lengths) = &pair.b.form {
            return self.box_contacts(pair, lengths, c);
        }
        if let (SurfaceForm::Sphere(radius), SurfaceForm::Hull(hull)) = (&pair.a.form, &pair.b.form) {
            let axes = std::array::from_fn(|k| rotate_b(Vec3::coordinate_axis(g, k)));
            let contact = hull.shape.as_ref().and_then(|hull| sphere_on_hull(*radius, hull, c, &axes));
            return contact.into_iter().collect();
        }
        let SurfaceForm::Plane(n) = &pair.b.form else {
            return self.curved_contacts(pair, c, &rotate_b);
        };
        let [(first, e1), (second, e2)] = perpendicular_directions(*n).map(|(word, e)| (word, rotate_b(e)));
        let normal = rotate_b(*n);
        let touch = |point: Vec3<'g>| PointContact {
            gap: normal.dot(c + point),
            point,
            axes: [("normal", normal), (first, e1), (second, e2)],
            conditions: Vec::new(),
        };
        let half = g.num(0.5);
        match &pair.a.form {
            SurfaceForm::Point => vec![touch(Vec3::zero(g))],
            SurfaceForm::Cuboid(lengths) => corners(lengths).map(|corner| touch(rotate_a(corner))).into(),
            SurfaceForm::Hull(hull) => hull.vertices.iter().map(|p| touch(rotate_a(*p))).collect(),
            SurfaceForm::Drum(radius, length, axis) => {
                let rim = rim(*axis, normal, &rotate_a);
                let ends = [-half, half].map(|side| rotate_a(*axis * (*length * side)));
                let sides =
                    ends.into_iter().flat_map(|end| rim.map(|direction| touch(end + direction * *radius)));
                sides.collect()
            }
            SurfaceForm::Capsule(radius, length, axis) => {
                [-half, half].map(|side| touch(rotate_a(*axis * (*length * side)) - normal * *radius)).into()
            }
            SurfaceForm::Cone(..) => Vec::new(),
            form => {
                support_point(form, normal, FLAT_RIM, &rotate_a).map(|far| touch(-far)).into_iter().collect()
            }
        }
    }

    /// Returns the contacts of a sphere, a point, the ends of a capsule, or the corners of a box or a hull
    /// with a terrain.
    fn terrain_contacts(
        &self,
        pair: &SurfacePair<'g>,
        terrain: &Terrain<'g>,
        c: Vec3<'g>,
        rotate_b: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
    ) -> Vec<PointContact<'g>> {
        let g = self.scope.graph;
        let rotate_a = |v| self.first_direction(pair, v).value;
        let (radius, places) = match &pair.a.form {
            SurfaceForm::Point => (g.zero(), vec![Vec3::zero(g)]),
            SurfaceForm::Sphere(radius) => (*radius, vec![Vec3::zero(g)]),
            SurfaceForm::Cuboid(lengths) => (g.zero(), corners(lengths).map(rotate_a).into()),
            SurfaceForm::Hull(hull) => (g.zero(), hull.vertices.iter().map(|p| rotate_a(*p)).collect()),
            SurfaceForm::Capsule(radius, length, axis) => {
                (*radius, [-0.5, 0.5].map(|side| rotate_a(*axis * (*length * side))).into())
            }
            _ => return Vec::new(),
        };
        let axes: [Vec3<'g>; 3] = std::array::from_fn(|k| rotate_b(Vec3::coordinate_axis(g, k)));
        let touches = places.into_iter().map(|place| {
            let touch = terrain.contact(radius, Vec3(axes.map(|axis| axis.dot(c + place))), rotate_b);
            PointContact { point: touch.point + place, ..touch }
        });
        touches.collect()
    }

    /// Returns the contacts of a sphere, a point or a capsule with a curved surface. Two capsules touch where
    /// their axes are closest, and at the spheres at their ends, which carry parallel capsules.
    fn curved_contacts(
        &self,
        pair: &SurfacePair<'g>,
        c: Vec3<'g>,
        rotate_b: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
    ) -> Vec<PointContact<'g>> {
        let g = self.scope.graph;
        let half = g.num(0.5);
        let (radius, own) = match &pair.a.form {
            SurfaceForm::Point => (g.zero(), None),
            SurfaceForm::Sphere(radius) => (*radius, None),
            SurfaceForm::Capsule(radius, length, axis) => {
                (*radius, Some((self.first_direction(pair, *axis).value, *length * half)))
            }
            _ => return Vec::new(),
        };
        let contact = match &pair.b.form {
            SurfaceForm::Capsule(other, length, axis) => {
                let (axis, reach) = (rotate_b(*axis), *length * half);
                let sphere = SurfaceForm::Sphere(*other);
                let Some((own, own_reach)) = own else {
                    let along = clamp(axis.dot(c), reach);
                    return sphere_contact(radius, &sphere, c - axis * along, rotate_b).into_iter().collect();
                };
                let own_ends =
                    [-own_reach, own_reach].map(|near| (near, clamp(axis.dot(c + own * near), reach)));
                let other_ends = [-reach, reach].map(|far| (clamp(own.dot(axis * far - c), own_reach), far));
                let places = [nearest(c, (own, own_reach), (axis, reach))].into_iter();
                let touches = places.chain(own_ends).chain(other_ends).filter_map(|(near, far)| {
                    let touch = sphere_contact(radius, &sphere, c + own * near - axis * far, rotate_b)?;
                    Some(PointContact { point: touch.point + own * near, ..touch })
                });
                return touches.collect();
            }
            SurfaceForm::Drum(wide, length, axis) => {
                let drum = Drum { radius: *wide, half: *length * half, axis: rotate_b(*axis) };
                return match own {
                    Some(own) => drum.capsule_contacts(radius, own, c),
                    None => vec![drum.sphere_contact(radius, c)],
                };
            }
            SurfaceForm::Cylinder(_, axis) if own.is_some() => {
                let axis = rotate_b(*axis);
                let contacts = own.map(|own| capsule_on_pipe(radius, own, &pair.b.form, axis, c, rotate_b));
                return contacts.unwrap_or_default();
            }
            form => sphere_contact(radius, form, c, rotate_b),
        };
        contact.into_iter().collect()
    }
}

/// Returns the corners of a box with these edge lengths, relative to its centre.
fn corners<'g>(lengths: &[Expr<'g>; 3]) -> [Vec3<'g>; 8] {
    std::array::from_fn(|k| {
        let side = |axis: usize| if k >> axis & 1 == 0 { -0.5 } else { 0.5 };
        Vec3(std::array::from_fn(|axis| lengths[axis] * side(axis)))
    })
}

impl<'g> SurfaceForm<'g> {
    /// Whether the contact of this surface with another one is supported.
    fn has_contact_with(&self, b: &SurfaceForm<'g>) -> bool {
        b.id().is_some_and(|id| id.row().contacts.contains(&self.id()))
    }
}
