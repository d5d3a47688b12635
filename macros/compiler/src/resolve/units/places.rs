//! The places of a description where expressions stand, each with the dimension that it gives to what stands
//! there.

use super::infer::{Inference, Meaning, Origin, Reason};
use super::value::Value;
use crate::language::dimension::{
    ACCELERATION, Dimension, ENERGY, FORCE, INERTIA, LENGTH, MASS, PLAIN, POWER, SPEED, TIME,
};
use crate::language::ratio::Ratio;
use crate::language::{Argument, ArgumentKind, Callable, ForceQuantity, Key, Locals, Method};
use crate::resolve::contact::PLACE;
use crate::syntax::contact::collision;
use crate::syntax::{
    Action, Body, Callee, Constraint, Definition, Description, Endpoint, Expr, ExprKind, Joint, Limit,
    Member, Target,
};

/// An expression with the dimension of its place.
pub struct Task<'a> {
    /// The expression.
    pub e: &'a Expr,
    /// Its dimension.
    pub dimension: Dimension,
    /// How the unit is written at this place; empty if as everywhere.
    pub unit: &'static str,
    /// Names that the place has of its own.
    pub locals: Vec<(&'static str, Dimension)>,
}

/// All places, as they are collected.
pub struct Places<'a> {
    /// The definitions, each after those that it mentions.
    pub definitions: Vec<Task<'a>>,
    /// The other expressions.
    pub tasks: Vec<Task<'a>>,
    /// Ends of force elements, which may be placed by vectors.
    pub points: Vec<&'a Expr>,
    /// By declared constraint: what its sides are. Nothing of rolling pairs.
    pub sides: Vec<Dimension>,
}

/// What a force element works on.
struct Work {
    /// Dimension of the coordinate or the distance.
    coordinate: Dimension,
    /// Units of force, stiffness, damping and inertance there.
    units: [&'static str; 4],
}

const ALONG: [&str; 4] = ["N", "N/m", "N·s/m", "kg"];
const ABOUT: [&str; 4] = ["N·m", "N·m/rad", "N·m·s/rad", "kg·m²"];

/// Collects the places of a description, with its `definitions` in order. What comes from a file is all
/// numbers.
pub fn collect<'a>(
    d: &'a Description,
    definitions: &[&'a Definition],
    inference: &mut Inference<'a>,
) -> Places<'a> {
    let mut places =
        Places { definitions: Vec::new(), tasks: Vec::new(), points: Vec::new(), sides: Vec::new() };
    // Definitions have unknowns of their own, which come with their names.
    for definition in definitions {
        if let Some(Meaning::Named(v, _)) = inference.names.get(&definition.name.text) {
            places.add(&definition.value, &Dimension::variable(*v), "");
        }
    }
    places.definitions = std::mem::take(&mut places.tasks);
    places.all(&d.gravity, &ACCELERATION, "m/s²");
    places.all(&d.friction_speed, &Dimension::variable(inference.system.variable()), "");
    d.bodies.iter().filter(|b| b.name.place.file.is_none()).for_each(|b| places.body(b));
    for particle in &d.particles {
        places.add(&particle.mass, &MASS, "kg");
        particle.at.iter().for_each(|at| places.position(at));
    }
    d.joints.iter().filter(|j| j.name.place.file.is_none()).for_each(|j| places.joint(j));
    for frame in &d.frames {
        places.rotations(&frame.rotations);
    }
    for point in &d.points {
        places.points.extend(&point.on);
        places.all(&point.at, &LENGTH, "m");
    }
    for action in &d.actions {
        places.action(action, inference);
    }
    d.limits.iter().filter(|l| l.on.place.file.is_none()).for_each(|l| places.limit(l, inference));
    for (place, value) in d.equilibria.iter().flat_map(|e| &e.values) {
        places.value(place, value, inference);
    }
    for constraint in &d.constraints {
        places.constraint(constraint, inference);
    }
    for contact in &d.contacts {
        places.surface(&contact.first);
        places.surface(&contact.second);
        places.all(
            contact
                .friction
                .iter()
                .chain(&contact.stiction)
                .chain(contact.restitution.iter().map(|e| &e.value)),
            &PLAIN,
            "1",
        );
        places.all(contact.torsional.iter().chain(&contact.rolling), &LENGTH, "m");
        if let Some(soft) = &contact.soft {
            let power = if soft.hertz { Ratio::new(3, 2) } else { Some(Ratio::integer(1)) };
            let dimension = power.and_then(|power| FORCE.quotient(&LENGTH.power(power)?));
            places.maybe([&soft.stiffness], dimension, if soft.hertz { "" } else { "N/m" });
            places.maybe(&soft.dissipation, TIME.quotient(&LENGTH), "s/m");
            places.all(&soft.speed, &SPEED, "m/s");
        }
    }
    for (_, e) in &d.energies {
        places.add(e, &ENERGY, "J");
    }
    for (_, e) in &d.dissipations {
        places.add(e, &POWER, "W");
    }
    places
}

impl<'a> Places<'a> {
    fn add(&mut self, e: &'a Expr, dimension: &Dimension, unit: &'static str) {
        self.tasks.push(Task { e, dimension: dimension.clone(), unit, locals: Vec::new() });
    }

    fn all(&mut self, e: impl IntoIterator<Item = &'a Expr>, dimension: &Dimension, unit: &'static str) {
        e.into_iter().for_each(|e| self.add(e, dimension, unit));
    }

    /// Adds the arguments of a solid, a surface or a rotation.
    fn arguments(&mut self, written: &'a [Expr], arguments: &[Argument]) {
        for (e, argument) in written.iter().zip(arguments) {
            if let Some((dimension, unit)) = argument.kind.dimension() {
                self.add(e, &dimension, unit);
            }
        }
    }

    fn body(&mut self, body: &'a Body) {
        self.all(&body.mass, &MASS, "kg");
        self.all(body.com.iter().chain(&body.about), &LENGTH, "m");
        body.inertia.iter().for_each(|e| self.inertia(e));
        body.at.iter().for_each(|e| self.position(e));
    }

    /// `rod(m, l, y).rotated(…) + [[…], …]`
    fn inertia(&mut self, e: &'a Expr) {
        match &e.kind {
            ExprKind::Array(rows) => {
                for row in rows {
                    if let ExprKind::Array(entries) = &row.kind {
                        self.all(entries, &INERTIA, "kg·m²");
                    }
                }
            }
            ExprKind::Binary(_, a, b, _) => {
                self.inertia(a);
                self.inertia(b);
            }
            ExprKind::Method(inner, _, steps) => {
                self.inertia(inner);
                self.rotations(steps);
            }
            ExprKind::Call(Callee { id: Some(Callable::Solid(solid)), .. }, arguments) => {
                self.arguments(arguments, solid.row().arguments);
            }
            _ => {}
        }
    }

    /// `z(angle)`, `eigenaxis(n, angle)`, a matrix.
    fn rotations(&mut self, steps: &'a [Expr]) {
        for step in steps {
            match &step.kind {
                ExprKind::Call(Callee { id: Some(Callable::Rotation(rotation)), .. }, arguments) => {
                    self.arguments(arguments, rotation.row().arguments);
                }
                ExprKind::Array(rows) => {
                    for row in rows {
                        if let ExprKind::Array(entries) = &row.kind {
                            self.all(entries, &PLAIN, "1");
                        }
                    }
                }
                _ => {}
            }
        }
    }

    /// A position: a place by name, `place.at(vector)`, or a vector from the ground's origin.
    fn position(&mut self, e: &'a Expr) {
        match &e.kind {
            ExprKind::Method(..) => self.points.push(e),
            // The name of a place has no dimension of its own.
            _ => self.add(e, &LENGTH, "m"),
        }
    }

    fn endpoint(&mut self, end: &'a Endpoint) {
        self.all(&end.at, &LENGTH, "m");
        self.rotations(&end.rotated);
    }

    fn joint(&mut self, joint: &'a Joint) {
        self.endpoint(&joint.parent);
        self.endpoint(&joint.child);
        self.all(joint.about.iter().chain(&joint.along), &PLAIN, "1");
        self.all(&joint.pitch, &LENGTH, "m/rad");
        self.all(&joint.lead, &LENGTH, "m");
    }

    fn action(&mut self, action: &'a Action, inference: &mut Inference<'a>) {
        let on = match &action.on {
            Target::Between(a, b) => {
                self.points.extend([a, b]);
                None
            }
            Target::On(e) => {
                let coordinate = coordinate(e, inference);
                match &e.kind {
                    _ if coordinate.is_some() => coordinate,
                    ExprKind::Call(..) | ExprKind::Binary(..) | ExprKind::Neg(..) => {
                        let unknown = Dimension::variable(inference.system.variable());
                        self.add(e, &unknown, "");
                        Some(unknown)
                    }
                    _ => {
                        self.points.push(e);
                        None
                    }
                }
            }
        };
        let on_point = on.is_none();
        let units = match &on {
            Some(d) if d.is_plain() => ABOUT,
            Some(d) if !d.is_known() => [""; 4],
            _ => ALONG,
        };
        let work = Work { coordinate: on.unwrap_or(LENGTH), units };
        // A force at a point works on a length, a torque on an angle.
        let force = match on_point && action.kind.row().torque {
            true => Some(ENERGY),
            false => ENERGY.quotient(&work.coordinate),
        };
        if let Some(force) = force {
            self.element(action, &work, &force, inference);
        }
    }

    fn limit(&mut self, limit: &'a Limit, inference: &mut Inference<'a>) {
        let q = coordinate(&limit.on, inference).unwrap_or_else(|| {
            let unknown = Dimension::variable(inference.system.variable());
            self.add(&limit.on, &unknown, "");
            unknown
        });
        let [length, speed, effort] = match (q.is_plain(), q.is_known()) {
            (true, _) => ["rad", "rad/s", "N·m"],
            (_, true) => ["m", "m/s", "N"],
            _ => [""; 3],
        };
        self.all(limit.from.iter().chain(&limit.to), &q, length);
        self.maybe(&limit.max_speed, q.quotient(&TIME), speed);
        self.maybe(&limit.max_effort, ENERGY.quotient(&q), effort);
        self.all(limit.restitution.iter().map(|e| &e.value), &PLAIN, "1");
    }

    /// The value of a coordinate, an input or a state at rest.
    fn value(&mut self, place: &'a Expr, value: &'a Expr, inference: &mut Inference<'a>) {
        if let Some(known) = coordinate(place, inference) {
            self.add(value, &known, if known.is_plain() { "rad" } else { "" });
        } else if place.name().is_some() {
            let unknown = Dimension::variable(inference.system.variable());
            self.add(place, &unknown, "");
            self.add(value, &unknown, "");
        }
    }

    fn element(&mut self, action: &'a Action, work: &Work, force: &Dimension, inference: &mut Inference<'a>) {
        let [n, stiffness, damping, inertance] = work.units;
        let q = &work.coordinate;
        let per = |times: i64| force.quotient(q).and_then(|d| d.times(&TIME.power(Ratio::integer(times))?));
        let row = action.kind.row();
        for (key, e) in &action.arguments {
            let (dimension, unit) = match &key.row().quantity {
                ForceQuantity::Stiffness => (per(0), stiffness),
                ForceQuantity::Damping => (per(1), damping),
                ForceQuantity::Inertance => (per(2), inertance),
                ForceQuantity::Force => (Some(force.clone()), n),
                ForceQuantity::Energy => (Some(ENERGY), "J"),
                ForceQuantity::Coordinate => (Some(q.clone()), if q.is_plain() { "rad" } else { "" }),
                ForceQuantity::Speed => (q.quotient(&TIME), ""),
                ForceQuantity::Fixed(dimension) => (Some(dimension.clone()), ""),
                ForceQuantity::Load => (Some(force.clone()), if row.torque { "N·m" } else { "N" }),
                // It belongs to an input, which gets its unit below.
                ForceQuantity::Direction => continue,
            };
            let Some(dimension) = dimension else { continue };
            // Coefficients are no expressions of the stretch or the speed.
            let locals = match (row.locals, key) {
                (Locals::Stretch, Key::Force | Key::Energy) => {
                    vec![("stretch", q.clone()), ("length", q.clone())]
                }
                (Locals::Speed, Key::Force | Key::Energy) => {
                    q.quotient(&TIME).map(|speed| ("speed", speed)).into_iter().collect()
                }
                _ => Vec::new(),
            };
            self.tasks.push(Task { e, dimension, unit, locals });
        }
        if action.is_input() {
            let is_direction = |key: &Key| matches!(key.row().quantity, ForceQuantity::Direction);
            let direction = action.arguments.iter().find(|(key, _)| is_direction(key)).map(|(_, e)| e);
            input(action, direction, force, inference);
        }
    }

    /// Both sides are alike, whatever they are; surfaces have arguments of their own.
    fn constraint(&mut self, constraint: &'a Constraint, inference: &mut Inference<'a>) {
        let side = Dimension::variable(inference.system.variable());
        self.sides.push(side.clone());
        if constraint.kind.pair().is_none() {
            self.add(&constraint.value, &side, "");
            self.all(&constraint.other, &side, "");
            return;
        }
        if let Some(friction) = &constraint.friction {
            self.add(&friction.coefficient, &PLAIN, "1");
            self.all(&friction.speed, &SPEED, "m/s");
        }
        let ExprKind::Call(_, pair) = &constraint.value.kind else { return };
        pair.iter().for_each(|surface| self.surface(surface));
    }

    /// A surface of a body, or a point.
    fn surface(&mut self, surface: &'a Expr) {
        if let Some(link) = collision(surface) {
            self.points.extend(link);
            return;
        }
        let ExprKind::Method(frame, Member { id: Some(Method::Surface(id)), .. }, arguments) = &surface.kind
        else {
            self.points.push(surface);
            return;
        };
        self.points.push(frame);
        for (e, argument) in arguments.iter().zip(id.row().arguments) {
            let Some((dimension, unit)) = argument.kind.dimension() else { continue };
            let locals = match argument.kind {
                ArgumentKind::Height => PLACE.map(|name| (name, LENGTH.clone())).into(),
                _ => Vec::new(),
            };
            self.tasks.push(Task { e, dimension, unit, locals });
        }
    }

    fn maybe(
        &mut self,
        e: impl IntoIterator<Item = &'a Expr>,
        dimension: Option<Dimension>,
        unit: &'static str,
    ) {
        if let Some(dimension) = dimension {
            self.all(e, &dimension, unit);
        }
    }
}

/// Gives an input its unit: times its direction it is a force or a torque. A bare direction has no unit.
fn input<'a>(
    action: &'a Action,
    direction: Option<&'a Expr>,
    force: &Dimension,
    inference: &mut Inference<'a>,
) {
    let Some(Meaning::Moving(input, _)) = inference.names.get(&action.name.text).cloned() else { return };
    let (Target::On(on) | Target::Between(on, _)) = &action.on;
    let (at, product) = match direction.map(|e| (e, inference.value(e))) {
        Some((at, Value::Quantity { dimension, .. })) => {
            inference.wish(dimension.clone());
            (at, input.times(&dimension))
        }
        _ => (direction.unwrap_or(on), Some(input)),
    };
    if let Some(product) = product {
        inference.equate(&product, force, Origin { reason: Reason::Place, at, like: None });
    }
}

/// The dimension of the coordinate that an element acts on; none if it acts on a body or a point.
fn coordinate(e: &Expr, inference: &Inference<'_>) -> Option<Dimension> {
    let meaning = match &e.kind {
        ExprKind::Name(name) => inference.names.get(name),
        ExprKind::Field(joint, member) => match &joint.kind {
            ExprKind::Name(joint) => inference.names.get(&format!("{joint}.{}", member.text)),
            _ => None,
        },
        _ => None,
    };
    match meaning {
        Some(Meaning::Moving(dimension, _)) => Some(dimension.clone()),
        Some(Meaning::Named(v, _)) => Some(Dimension::variable(*v)),
        None => None,
    }
}
