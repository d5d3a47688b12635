//! Contacts that open and close: surfaces of bodies, and coordinates at their bounds.

use super::force::check_turns;
use super::surface::{Form, Surface};
use super::terrain::Terrain;
use super::{Contact as Touch, Pair, farthest, perpendicular, sphere_contact};
use crate::diag::{Diagnostics, Place};
use crate::expr::{Expr, Extreme, Vec3};
use crate::kinematics::{motion_rates, velocity_gradient};
use crate::language::{Method, OtherKind};
use crate::mechanism::{Contact, LinkId, Quantity, Rule};
use crate::resolve::builder::Builder;
use crate::resolve::motion::Moving;
use crate::resolve::power::{Counts, is_asked};
use crate::resolve::scope::{Allowed, Context, Exerted, Terms};
use crate::syntax::contact::collision;
use crate::syntax::{self, ExprKind, GROUND};

/// Most points of all contacts of a mechanism: what is generated grows as their number.
const MAX_CONTACT_POINTS: usize = 128;

/// Square of the sine of an angle between lines that are parallel.
const PARALLEL: f64 = 1e-12;

/// Square of the sine of an angle that is none: where a rim lies flat on a plane, its centre touches.
const FLAT: f64 = 1e-24;

const PAIRS: &str = "known are points, spheres, circles, tori, ellipsoids, capsules, cuboids and cylinders with two ends on a plane; points and spheres also on a sphere, a capsule, a cylinder or a cone, or inside of a bowl, a tube or a funnel; capsules on each other; cuboids on each other; spheres and capsules on cuboids; spheres on cylinders with two ends; points, spheres, capsules and cuboids on a terrain";

/// What stands for a cylinder.
const STAND_IN: &str = "a capsule of the same radius, or several spheres, may stand for a cylinder";

/// Coefficients of a contact.
#[derive(Clone, Copy)]
pub(super) struct Laws<'g> {
    pub(super) friction: Expr<'g>,
    /// Coefficient of friction at rest.
    pub(super) stiction: Expr<'g>,
    /// Largest moment about the normal by the normal force.
    pub(super) torsional: Expr<'g>,
    /// Largest moment about the tangents by the normal force.
    pub(super) rolling: Expr<'g>,
    pub(super) restitution: Expr<'g>,
    /// Restitution is a ratio of impulses.
    pub(super) of_impulses: bool,
}

/// A point where two surfaces may touch.
pub(super) struct Point<'g> {
    /// Distance.
    pub(super) gap: Expr<'g>,
    /// Normal and tangents, towards the first surface, each with the rate along it.
    pub(super) rates: [(Vec3<'g>, Expr<'g>); 3],
    /// Relative angular velocity about each.
    pub(super) turns: [Expr<'g>; 3],
    /// The link in whose axes the directions are.
    pub(super) ancestor: Option<LinkId>,
    /// Where it is.
    pub(super) place: Terms<'g>,
}

/// The value of a coefficient of restitution, and whether it is a ratio of impulses.
pub(super) fn apart(restitution: Option<&syntax::Restitution>) -> (Option<&syntax::Expr>, bool) {
    restitution.map_or((None, false), |e| (Some(&e.value), e.of_impulses))
}

impl<'g> Builder<'_, 'g> {
    /// Adds all contacts to the model: declared ones in their order, then the stops of limits.
    pub fn add_contacts(&mut self, _: Moving, cx: &mut Diagnostics) {
        let description = self.description;
        for contact in &description.contacts {
            self.add_contact(contact, cx);
        }
        for limit in description.limits.iter().filter(|limit| limit.restitution.is_some()) {
            self.add_stops(limit, cx);
        }
        let count = self.model.contacts.len();
        if count > MAX_CONTACT_POINTS {
            let place = description.contacts.first().map_or(&description.name.place, |c| &c.name.place);
            cx.error(place.clone(), format!("{count} points of contact, more than {MAX_CONTACT_POINTS}"))
                .help("each has code of its own: let fewer points touch, or divide the mechanism");
        }
    }

    fn add_contact(&mut self, contact: &syntax::Contact, cx: &mut Diagnostics) {
        let laws = self.laws(contact, cx);
        let firsts = self.touching(&contact.first, cx);
        // Two bodies in the place of two surfaces are one mistake.
        let seconds = match firsts {
            None if !matches!(contact.second.kind, ExprKind::Method(..) | ExprKind::Call(..)) => None,
            _ => self.touching(&contact.second, cx),
        };
        let soft = contact.soft.as_ref().map(|soft| self.softness(soft, cx));
        let (Some(firsts), Some(seconds), Some(laws)) = (firsts, seconds, laws) else { return };
        if let Some(None) = soft {
            return;
        }
        let place = contact.first.place.join(&contact.second.place);
        let whole = [&contact.first, &contact.second].iter().any(|e| matches!(collision(e), Some(None)));
        let mut points: Vec<Point<'g>> = Vec::new();
        for first in &firsts {
            for second in &seconds {
                // Of a whole file, what moves.
                if whole && first.frame.link == second.frame.link {
                    continue;
                }
                let Some(found) = self.points_of(first, second, (&contact.second, &place), cx) else {
                    return;
                };
                points.extend(found);
            }
        }
        let apart: Vec<&Point<'g>> =
            points.iter().filter(|point| !velocity_gradient(point.rates[0].1).is_empty()).collect();
        if contact.of_file && apart.is_empty() {
            return;
        }
        if apart.is_empty() || (apart.len() < points.len() && !whole && !contact.of_file) {
            cx.error(place, "nothing moves these surfaces apart, or together")
                .help("surfaces touch that belong to bodies which move relative to each other");
            return;
        }
        check_turns(contact, &apart, cx);
        let (several, mut exerted, before) = (apart.len() > 1, Exerted::default(), Counts::of(&self.model));
        for (k, point) in apart.into_iter().enumerate() {
            let name = &contact.name.text;
            let name = if several { format!("{name}.{k}") } else { name.clone() };
            match soft.as_ref().and_then(Option::as_ref) {
                Some(soft) => self.add_soft_point(point, laws, soft, &mut exerted),
                None => self.add_point(name, point, laws, &mut exerted),
            }
        }
        if is_asked(self.description, &contact.name) {
            let power = match (&soft, exerted.power) {
                (None, Some(power)) => Ok(power),
                _ => self.power_since(&before, &contact.name.text),
            };
            self.scope.kinematics.borrow_mut().powers.insert(contact.name.text.clone(), power);
        }
        self.scope.kinematics.borrow_mut().touches.insert(contact.name.text.clone(), exerted);
    }

    /// Where two surfaces touch; `None` after a mistake.
    fn points_of(
        &self,
        first: &Surface<'g>,
        second: &Surface<'g>,
        (second_place, place): (&syntax::Expr, &Place),
        cx: &mut Diagnostics,
    ) -> Option<Vec<Point<'g>>> {
        let first_link = first.frame.link;
        let mut pair = self.two(first.clone(), second.clone(), Form::touches, second_place, cx)?;
        // The same as by the velocities of links, in fewer terms to differentiate.
        let [x, y, z] = motion_rates(self.model.space(), &pair.center.value.0, false)[..] else {
            return None;
        };
        pair.center.rate = Vec3([x, y, z]);
        let touches = self.touches(&pair);
        if touches.is_empty() {
            let is_cylinder =
                |surface: &Surface<'g>| matches!(surface.form, Form::Cylinder(..) | Form::Drum(..));
            let help = match is_cylinder(first) || is_cylinder(second) {
                true => format!("{STAND_IN}; {PAIRS}"),
                false => PAIRS.to_string(),
            };
            cx.error(place.clone(), "where these surfaces touch is not known").help(help);
            return None;
        }
        let side = self.scope.graph.num(if pair.a.frame.link == first_link { 1.0 } else { -1.0 });
        let [w_a, w_b] = self.spins(&pair);
        let points = touches.into_iter().map(|touch| {
            let slip = self.slip(&pair, touch.point);
            let rates = touch.axes.map(|(_, e)| (e * side, e.dot(slip)));
            let turns = touch.axes.map(|(_, e)| e.dot(w_a - w_b));
            let place = self.place_of_touch(&pair, touch.point);
            Point { gap: touch.gap, rates, turns, ancestor: pair.on_a.ancestor, place }
        });
        Some(points.collect())
    }

    /// Adds a point of contact to the model, and its forces on the first surface.
    fn add_point(&mut self, name: String, point: &Point<'g>, laws: Laws<'g>, exerted: &mut Exerted<'g>) {
        let [normal, slip @ ..] = point.rates;
        let slides = slip
            .into_iter()
            .filter(|(_, rate)| !laws.friction.is_zero() && !velocity_gradient(*rate).is_empty());
        let rates: Vec<(Vec3<'g>, Expr<'g>)> = std::iter::once(normal).chain(slides).collect();
        let number = self.model.contact_rates().len();
        for (k, (direction, rate)) in rates.iter().enumerate() {
            let force = Quantity::ContactForce(number + k).expr(self.scope.graph);
            exerted.forces.push((point.ancestor, *direction * force));
            exerted.deliver(force * *rate);
        }
        let rates = rates.into_iter().map(|(_, rate)| rate).collect();
        let presses = self.model.contacts.len();
        self.touching.insert(name.clone(), point.place.clone());
        self.push_contact(name.clone(), (point.gap, false), None, rates, laws);
        let none = self.scope.graph.zero();
        for (word, about, most) in [("spin", 0..1, laws.torsional), ("roll", 1..3, laws.rolling)] {
            let turns = about.map(|k| (point.rates[k].0, point.turns[k]));
            let turns: Vec<_> = turns.filter(|(_, rate)| !velocity_gradient(*rate).is_empty()).collect();
            if !most.is_zero() && !turns.is_empty() {
                let number = self.model.contact_rates().len();
                for (k, (direction, rate)) in turns.iter().enumerate() {
                    let moment = Quantity::ContactForce(number + k).expr(self.scope.graph);
                    exerted.moments.push((point.ancestor, *direction * moment));
                    exerted.deliver(moment * *rate);
                }
                let rates = turns.into_iter().map(|(_, rate)| rate).collect();
                let name = format!("{name}.{word}");
                let laws =
                    Laws { friction: most, stiction: most, restitution: none, of_impulses: false, ..laws };
                self.push_contact(name, (point.gap, false), Some(presses), rates, laws);
            }
        }
    }

    pub(super) fn push_contact(
        &mut self,
        name: String,
        (gap, turns): (Expr<'g>, bool),
        pressed_by: Option<usize>,
        rates: Vec<Expr<'g>>,
        Laws { friction, stiction, restitution, of_impulses, .. }: Laws<'g>,
    ) {
        let contact =
            Contact { name, gap, turns, pressed_by, rates, friction, stiction, restitution, of_impulses };
        self.model.contacts.push(contact);
    }

    /// The coefficients of a contact; `None` after a mistake.
    fn laws(&self, contact: &syntax::Contact, cx: &mut Diagnostics) -> Option<Laws<'g>> {
        let name = &contact.name.text;
        let mut read =
            |e: &Option<syntax::Expr>, what, rule| self.coefficient(e.as_ref(), what, rule, name, cx);
        let friction = read(&contact.friction, "friction", Rule::NotNegative);
        let stiction = match &contact.stiction {
            Some(_) => read(&contact.stiction, "static friction", Rule::NotNegative),
            None => friction,
        };
        let torsional = read(&contact.torsional, "torsional friction", Rule::NotNegative);
        let rolling = read(&contact.rolling, "rolling friction", Rule::NotNegative);
        let (value, of_impulses) = apart(contact.restitution.as_ref());
        let restitution = self.coefficient(value, "restitution", Rule::Fraction, name, cx);
        let (friction, stiction) = (friction?, stiction?);
        if let Some(e) = contact.stiction.as_ref().filter(|_| contact.friction.is_some()) {
            match (friction.value(), stiction.value()) {
                (Some(kinetic), Some(most)) if most < kinetic || kinetic == 0.0 => {
                    let message = match kinetic == 0.0 {
                        true => format!("`{name}` has stiction, but no friction while it slides"),
                        false => format!("stiction, {most}, is less than friction, {kinetic}"),
                    };
                    cx.error(e.place.clone(), message)
                        .help("`friction` is the coefficient while surfaces slide, `stiction` the larger one at rest");
                    return None;
                }
                _ => {
                    let figure = || format!("the friction of `{name}` and its stiction");
                    self.scope.require(Rule::Order, figure, &[friction, stiction]);
                }
            }
        }
        Some(Laws {
            friction,
            stiction,
            torsional: torsional?,
            rolling: rolling?,
            restitution: restitution?,
            of_impulses,
        })
    }

    /// A coefficient, zero if it is not given; `None` after a mistake.
    pub(super) fn coefficient(
        &self,
        e: Option<&syntax::Expr>,
        what: &str,
        rule: Rule,
        name: &str,
        cx: &mut Diagnostics,
    ) -> Option<Expr<'g>> {
        let Some(e) = e else { return Some(self.scope.graph.zero()) };
        let value = self.scope.in_context(Context::new(Allowed::Constant, None), |s| s.scalar(e, cx))?;
        let most = if rule == Rule::Fraction { 1.0 } else { f64::INFINITY };
        if let Some(n) = value.value().filter(|n| !(0.0..=most).contains(n)) {
            let range = if most < 2.0 { "is between 0 and 1" } else { "cannot be negative" };
            cx.error(e.place.clone(), format!("a coefficient of {what} {range}, but it is {n}")).help(
                match most < 2.0 {
                    true => "the part of the speed that is left after the impact: 0 stays, 1 loses no energy",
                    false => "it opposes the motion by itself: write its size",
                },
            );
            return None;
        }
        self.scope.require(rule, || format!("the {what} of `{name}`"), &[value]);
        Some(value)
    }

    /// Surfaces of one side of a contact: one that rolls, a point, or the collision geometry of a file.
    pub(super) fn touching(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Vec<Surface<'g>>> {
        if let Some(link) = collision(e) {
            return self.collisions(e, link, cx);
        }
        let is_place = match &e.kind {
            ExprKind::Method(_, word, _) => word.id == Some(Method::At),
            ExprKind::Name(name) => name != GROUND,
            _ => false,
        };
        if is_place {
            return Some(vec![Surface { frame: self.scope.place(e, cx)?, form: Form::Point }]);
        }
        Some(vec![self.surface(e, &format!("write `{}`", OtherKind::Contact.row().example), cx)?])
    }

    /// Where a pair touches, at one point or several.
    fn touches(&self, pair: &Pair<'g>) -> Vec<Touch<'g>> {
        let g = self.scope.graph;
        let turned_a = |v| self.of_first(pair, v).value;
        let turned_b = |v| self.of_second(pair, v).value;
        let c = pair.center.value - pair.base.value;
        if let Form::Terrain(terrain) = &pair.b.form {
            return self.grounded(pair, terrain, c, &turned_b);
        }
        if let Form::Cuboid(lengths) = &pair.b.form {
            return self.on_box(pair, lengths, c);
        }
        let Form::Plane(n) = &pair.b.form else {
            return self.round(pair, c, &turned_b).into_iter().collect();
        };
        let [(first, e1), (second, e2)] = perpendicular(*n).map(|(word, e)| (word, turned_b(e)));
        let normal = turned_b(*n);
        let touch = |point: Vec3<'g>| Touch {
            gap: normal.dot(c + point),
            point,
            axes: [("normal", normal), (first, e1), (second, e2)],
            conditions: Vec::new(),
        };
        let half = g.num(0.5);
        match &pair.a.form {
            Form::Point => vec![touch(Vec3::zero(g))],
            Form::Cuboid(lengths) => corners(lengths).map(|corner| touch(turned_a(corner))).into(),
            Form::Drum(radius, length, axis) => {
                let rim = rim(*axis, normal, &turned_a);
                let ends = [-half, half].map(|side| turned_a(*axis * (*length * side)));
                let sides =
                    ends.into_iter().flat_map(|end| rim.map(|direction| touch(end + direction * *radius)));
                sides.collect()
            }
            Form::Capsule(radius, length, axis) => {
                [-half, half].map(|side| touch(turned_a(*axis * (*length * side)) - normal * *radius)).into()
            }
            Form::Cone(..) => Vec::new(),
            form => farthest(form, normal, FLAT, &turned_a).map(|far| touch(-far)).into_iter().collect(),
        }
    }

    /// Where a sphere, a point, the ends of a capsule or the corners of a box touch a terrain.
    fn grounded(
        &self,
        pair: &Pair<'g>,
        terrain: &Terrain<'g>,
        c: Vec3<'g>,
        turned_b: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
    ) -> Vec<Touch<'g>> {
        let g = self.scope.graph;
        let turned_a = |v| self.of_first(pair, v).value;
        let (radius, places) = match &pair.a.form {
            Form::Point => (g.zero(), vec![Vec3::zero(g)]),
            Form::Sphere(radius) => (*radius, vec![Vec3::zero(g)]),
            Form::Cuboid(lengths) => (g.zero(), corners(lengths).map(turned_a).into()),
            Form::Capsule(radius, length, axis) => {
                (*radius, [-0.5, 0.5].map(|side| turned_a(*axis * (*length * side))).into())
            }
            _ => return Vec::new(),
        };
        let axes: [Vec3<'g>; 3] = std::array::from_fn(|k| turned_b(Vec3::axis(g, k)));
        let touches = places.into_iter().map(|place| {
            let touch = terrain.contact(radius, Vec3(axes.map(|axis| axis.dot(c + place))), turned_b);
            Touch { point: touch.point + place, ..touch }
        });
        touches.collect()
    }

    /// Where a sphere, a point or a capsule touches what is no plane.
    fn round(
        &self,
        pair: &Pair<'g>,
        c: Vec3<'g>,
        turned_b: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
    ) -> Option<Touch<'g>> {
        let g = self.scope.graph;
        let half = g.num(0.5);
        let (radius, own) = match &pair.a.form {
            Form::Point => (g.zero(), None),
            Form::Sphere(radius) => (*radius, None),
            Form::Capsule(radius, length, axis) => {
                (*radius, Some((self.of_first(pair, *axis).value, *length * half)))
            }
            _ => return None,
        };
        match &pair.b.form {
            Form::Capsule(other, length, axis) => {
                let (axis, reach) = (turned_b(*axis), *length * half);
                let sphere = Form::Sphere(*other);
                let Some((own, own_reach)) = own else {
                    let along = within(axis.dot(c), reach);
                    return sphere_contact(radius, &sphere, c - axis * along, turned_b);
                };
                let (near, far) = nearest(c, (own, own_reach), (axis, reach));
                let touch = sphere_contact(radius, &sphere, c + own * near - axis * far, turned_b)?;
                Some(Touch { point: touch.point + own * near, ..touch })
            }
            Form::Drum(wide, length, axis) => {
                let axis = turned_b(*axis);
                let height = axis.dot(c);
                let outward = c - axis * height;
                let size = outward.norm().extreme(Extreme::Max, *wide);
                let inner = axis * within(height, *length * half) + outward * (*wide / size);
                sphere_contact(radius, &Form::Sphere(g.zero()), c - inner, turned_b)
            }
            form => sphere_contact(radius, form, c, turned_b),
        }
    }
}

/// The corners of a box.
fn corners<'g>(lengths: &[Expr<'g>; 3]) -> [Vec3<'g>; 8] {
    std::array::from_fn(|k| {
        let side = |axis: usize| if k >> axis & 1 == 0 { -0.5 } else { 0.5 };
        Vec3(std::array::from_fn(|axis| lengths[axis] * side(axis)))
    })
}

/// Directions from the middle of a rim to its lowest point over a plane, and to the three a quarter turn
/// further each. Where the rim lies flat, every one is lowest: one of the body's own is chosen.
fn rim<'g>(axis: Vec3<'g>, normal: Vec3<'g>, turned: &dyn Fn(Vec3<'g>) -> Vec3<'g>) -> [Vec3<'g>; 4] {
    let [(_, own), _] = perpendicular(axis);
    let (a, own) = (turned(axis), turned(own));
    let cosine = a.dot(normal);
    let down = a * cosine - normal + own * cosine.num(FLAT.sqrt());
    let size = down.norm();
    let lowest = down.map(|x| x / size);
    let beside = a.cross(lowest);
    [lowest, beside, -lowest, -beside]
}

/// What is nearest to a number between `-most` and `most`.
pub(super) fn within<'g>(x: Expr<'g>, most: Expr<'g>) -> Expr<'g> {
    x.extreme(Extreme::Max, -most).extreme(Extreme::Min, most)
}

/// Where two straight lines of given half lengths are nearest to each other, from their middles along their
/// axes; `c` leads from the second middle to the first (Ericson, *Real-Time Collision Detection*, 2005, §
/// 5.1.9). Where they are parallel it is one place of many.
pub(super) fn nearest<'g>(
    c: Vec3<'g>,
    (own, own_reach): (Vec3<'g>, Expr<'g>),
    (axis, reach): (Vec3<'g>, Expr<'g>),
) -> (Expr<'g>, Expr<'g>) {
    let (cosine, first, second) = (own.dot(axis), own.dot(c), axis.dot(c));
    let one = cosine.num(1.0);
    let across = (one - cosine * cosine).extreme(Extreme::Max, cosine.num(PARALLEL));
    let guess = within((cosine * second - first) / across, own_reach);
    let far = within(second + cosine * guess, reach);
    (within(cosine * far - first, own_reach), far)
}

impl<'g> Form<'g> {
    /// True for a surface whose contact with another is known.
    fn touches(&self, b: &Form<'g>) -> bool {
        b.id().is_some_and(|id| id.row().contacts.contains(&self.id()))
    }
}
