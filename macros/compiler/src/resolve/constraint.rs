//! Constraints: joints that close loops, expressions that stay zero, rolling pairs. Each becomes scalar rows with their
//! rates and the derivatives of those. Motions are taken relative to the nearest link that carries both sides, so
//! that what both share drops out.

use super::build::Builder;
use super::joint::{Elementary, in_plane};
use super::world::{Level, Placed, PlacedKind, View};
use super::{contact, slips};
use crate::diag::{Diagnostics, Place};
use crate::expr::eval::{eval, eval_one};
use crate::expr::replace::replace;
use crate::expr::sample::{always, sample};
use crate::expr::{Expr, Rotation, Vec3};
use crate::kinematics::{
    Rows, Spatial, change_axes, mobility, redundancy, symbols_in, time_derivative, velocity_gradient,
};
use crate::mechanism::{Constraint, LinkId, Measure, Pose, Quantity, Transmission};
use crate::syntax::{self, ConstraintKind, ExprKind, Formulation};

/// Most scalar constraints of a mechanism, twice as many as velocities: half of them may be redundant.
const MAX_CONSTRAINTS: usize = 256;

/// A scalar with its rate, and the rate of that at zero accelerations.
pub struct Jet<'g> {
    value: Expr<'g>,
    rate: Expr<'g>,
    second: Expr<'g>,
}

/// The same of a vector, in the axes of a link that counts as fixed.
#[derive(Clone, Copy)]
pub struct Moving<'g> {
    pub value: Vec3<'g>,
    pub rate: Vec3<'g>,
    pub second: Vec3<'g>,
}

impl<'g> Moving<'g> {
    fn minus(&self, b: &Moving<'g>) -> Moving<'g> {
        Moving { value: self.value - b.value, rate: self.rate - b.rate, second: self.second - b.second }
    }

    fn dot(&self, b: &Moving<'g>) -> Jet<'g> {
        let twice = self.rate.dot(b.rate) * 2.0;
        Jet {
            value: self.value.dot(b.value),
            rate: self.rate.dot(b.value) + self.value.dot(b.rate),
            second: self.second.dot(b.value) + twice + self.value.dot(b.second),
        }
    }

    fn component(&self, k: usize) -> Jet<'g> {
        Jet { value: self.value[k], rate: self.rate[k], second: self.second[k] }
    }
}

/// A link's motion relative to one of its ancestors, in link axes.
pub struct Relative<'g> {
    link: Option<LinkId>,
    ancestor: Option<LinkId>,
    /// Velocity of the origin, angular velocity.
    pub twist: Spatial<'g>,
    acceleration: Spatial<'g>,
}

/// The two ends of a joint that closes a loop.
struct Closing<'g> {
    j: usize,
    parent: Placed<'g>,
    child: Placed<'g>,
    on_parent: Relative<'g>,
    on_child: Relative<'g>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl<'g> Builder<'_, 'g> {
    /// All constraints: those of the joints that close loops, then those declared.
    pub fn add_constraints(&mut self, closing: &[usize], cx: &mut Diagnostics) {
        if !cx.is_empty() {
            for j in closing {
                self.check_joint(&self.description.joints[*j], cx);
                self.transmit(*j, None, &Rotation::identity(self.scope.graph));
            }
            for constraint in &self.description.constraints {
                self.check_constraint(constraint, cx);
            }
            return;
        }
        let solved: Vec<usize> = self.embedded.iter().map(|e| e.closing).collect();
        for j in closing.iter().filter(|j| !solved.contains(j)) {
            self.group += 1;
            self.close_loop(*j, cx);
        }
        for (index, constraint) in self.description.constraints.iter().enumerate() {
            self.group += 1;
            let measure = Measure::Declared(index);
            match constraint.kind {
                ConstraintKind::Holonomic => self.add_holonomic(constraint, measure, cx),
                ConstraintKind::Nonholonomic => self.add_nonholonomic(constraint, measure, cx),
                ConstraintKind::Rolling => self.add_rolling(constraint, cx),
                ConstraintKind::Slipping => self.add_slipping(constraint, cx),
            }
        }
        self.model.constraints.sort_by_key(|c| c.residual.is_none());
        self.model.freedom = [self.model.nv(); 2];
        if let (Formulation::Speeds(_, place), true) =
            (&self.description.formulation, self.model.constraints.is_empty())
        {
            cx.error(place.clone(), "all speeds are independent: this mechanism has no constraint")
                .help("remove this argument");
        }
        let count = self.model.constraints.len();
        if count > MAX_CONSTRAINTS {
            let place = self.description.name.place.clone();
            cx.error(place, format!("{count} scalar constraints, more than {MAX_CONSTRAINTS}"))
                .help("each loop costs up to five of them: hold bodies by the tree where you can, or divide the mechanism");
            return;
        }
        for j in &solved {
            self.transmit(*j, None, &Rotation::identity(self.scope.graph));
        }
        if let Some((_, kept)) = self.opening {
            self.model.constraints.retain(|c| kept.iter().any(|k| k.name == c.name));
            for j in &solved {
                self.close_in_plane(*j, cx);
            }
            return;
        }
        if cx.is_empty() && !self.model.constraints.is_empty() {
            let mut found = Diagnostics::new();
            self.check_mobility(&mut found);
            self.mobility = found;
        }
    }

    /// Drops rows that follow from others and counts the degrees of freedom.
    fn check_mobility(&mut self, cx: &mut Diagnostics) {
        let mut rows = Rows::of(&self.model);
        let constant = redundancy::constant(&self.model, &rows);
        redundancy::check_constant(&self.model, &constant, cx);
        if !cx.is_empty() {
            return;
        }
        let witnesses = mobility::witnesses(&self.model, &rows, cx);
        let before = self.model.constraints.clone();
        if redundancy::prune(&mut self.model, &rows, &constant, &witnesses) {
            contact::check_pressed(&before, &self.model.redundant, cx);
            rows = Rows::of(&self.model);
        }
        self.model.freedom = mobility::degrees_of_freedom(&self.model, &rows, &witnesses, cx);
        self.choose_speeds(&rows, &witnesses, cx);
    }

    /// Finds the velocities that follow from independent speeds, if those are asked for.
    fn choose_speeds(&mut self, rows: &Rows<'_>, witnesses: &[mobility::Witness], cx: &mut Diagnostics) {
        let Formulation::Speeds(names, place) = &self.description.formulation else { return };
        if self.model.constraints.iter().any(|c| !c.friction.is_empty()) {
            cx.error(place.clone(), "independent speeds leave no normal force for friction to follow")
                .help("a mechanism with slipping contacts is solved by multipliers: remove this argument");
            return;
        }
        let mut independent = Vec::new();
        for e in names {
            let name = match &e.kind {
                ExprKind::Field(joint, member) => {
                    joint.name().map(|joint| format!("{joint}.{}", member.text))
                }
                _ => e.name().map(str::to_string),
            };
            let known = || self.model.velocities.iter().map(|(name, _)| name.as_str());
            match known().position(|v| Some(v) == name.as_deref()) {
                Some(k) => independent.push(k),
                None => {
                    cx.error(e.place.clone(), "expected a velocity")
                        .suggest(name.as_deref().unwrap_or(""), known());
                    return;
                }
            }
        }
        let free = self.model.freedom[1];
        if !independent.is_empty() && independent.len() != free {
            cx.error(
                place.clone(),
                format!("{} independent speeds for {free} degrees of freedom", independent.len()),
            )
            .help(format!("name {free}, or leave `independent` out: then they are chosen"));
            return;
        }
        if !cx.is_empty() {
            return;
        }
        self.model.dependent = mobility::dependent(&self.model, rows, witnesses, &independent);
        if self.model.dependent.is_none() {
            let diagnostic =
                cx.error(place.clone(), "the other velocities do not follow from independent speeds");
            diagnostic.help("constraints are redundant, or these speeds depend on each other: use `formulation = multipliers`, or others");
        }
    }

    /// What the joint of a loop allows, and its two ends.
    fn closing(&self, j: usize, cx: &mut Diagnostics) -> Option<(Vec<Elementary<'g>>, Closing<'g>)> {
        let joint = &self.description.joints[j];
        let motions = self.scope.motions(joint, cx);
        let [parent, child] = [&joint.parent, &joint.child].map(|end| {
            let on_body = self.endpoint(end, cx)?;
            let (link, pose) = self.joint_parent(&end.body, cx)?;
            Some(Placed { link, pose: pose.then(&on_body), kind: PlacedKind::Body })
        });
        let (parent, child) = (parent?, child?);
        let on_parent = self.relative(parent.link, child.link);
        let on_child = self.relative(child.link, parent.link);
        Some((motions?, Closing { j, parent, child, on_parent, on_child }))
    }

    /// The rows of a loop that is solved in closed form: its Pin keeps both ends together in the loop's plane.
    fn close_in_plane(&mut self, j: usize, cx: &mut Diagnostics) {
        self.group += 1;
        if let Some((motions, ends)) = self.closing(j, cx)
            && let [Elementary::Turn(axis)] = motions.as_slice()
        {
            self.translation_rows(&ends, &[Elementary::Slide(*axis)]);
        }
    }

    fn close_loop(&mut self, j: usize, cx: &mut Diagnostics) {
        let joint = &self.description.joints[j];
        let Some((motions, ends)) = self.closing(j, cx) else { return };
        let place = &joint.name.place;
        if matches!(motions.as_slice(), [Elementary::Free]) {
            cx.error(place.clone(), format!("`{}` closes a loop, but it restricts nothing", joint.name.text))
                .help("remove it: a Free joint allows all motions");
            return;
        }
        if ends.parent.link == ends.child.link {
            cx.error(place.clone(), "these two ends do not move relative to each other")
                .help("let the joint act between bodies that move relative to each other");
            return;
        }
        self.transmit(j, None, &Rotation::identity(self.scope.graph));
        self.translation_rows(&ends, &motions);
        self.group += 1;
        self.rotation_rows(&ends, &motions);
    }

    /// The child's joint frame has its origin where the slides of the joint let it be.
    fn translation_rows(&mut self, ends: &Closing<'g>, motions: &[Elementary<'g>]) {
        let g = self.scope.graph;
        let slides: Vec<Vec3<'g>> = motions.iter().filter_map(slide_of).collect();
        let Closing { parent, child, on_parent, on_child, .. } = ends;
        let origin = self.point(on_parent, parent.pose.translation);
        let gap = self.point(on_child, child.pose.translation).minus(&origin);
        if slides.is_empty() {
            for (k, word) in AXES.iter().enumerate() {
                self.push(ends, word, gap.component(k), (Measure::Length, Vec3::axis(g, k)));
            }
            return;
        }
        let across: Vec<(&str, Vec3<'g>)> = match slides.as_slice() {
            [one] => perpendicular(*one).to_vec(),
            [first, second] => vec![("normal", super::expression::unit(first.cross(*second)))],
            _ => Vec::new(),
        };
        for (word, direction) in across {
            let e = self.direction(on_parent, parent.pose.rotation.to_parent(direction));
            self.push(ends, word, gap.dot(&e), (Measure::Length, e.value));
        }
        if let [Elementary::Helix(axis, pitch)] = motions {
            let n = self.direction(on_parent, parent.pose.rotation.to_parent(*axis)).value;
            let [(_, first), (_, second)] = perpendicular(*axis);
            let on = |v| self.direction(on_parent, parent.pose.rotation.to_parent(v)).value;
            let turned = self.direction(on_child, child.pose.rotation.to_parent(first)).value;
            let (sine, cosine) = (on(second).dot(turned), on(first).dot(turned));
            let advance = gap.value.dot(n) / *pitch;
            let value = *pitch * (sine * advance.cos() - cosine * advance.sin());
            let rate = time_derivative(self.model.space(), value);
            let second = time_derivative(self.model.space(), rate);
            // It pushes the child back along the axis and turns it by the pitch.
            self.push(ends, "advance", Jet { value, rate, second }, (Measure::Length, -n));
            let turned = self.transmission(ends, true, n * *pitch);
            self.model.constraints.last_mut().iter_mut().for_each(|c| c.transmits.push(turned));
        }
    }

    /// The child's joint axes are turned as the turns of the joint let them be.
    fn rotation_rows(&mut self, ends: &Closing<'g>, motions: &[Elementary<'g>]) {
        if matches!(motions, [Elementary::Ball]) {
            return;
        }
        let turns: Vec<Vec3<'g>> = motions.iter().filter_map(turn_of).collect();
        let Closing { parent, child, on_parent, on_child, .. } = ends;
        let of_parent = |v| self.direction(on_parent, parent.pose.rotation.to_parent(v));
        let of_child = |v| self.direction(on_child, child.pose.rotation.to_parent(v));
        let axis = |k| Vec3::axis(self.scope.graph, k);
        // Directions of the parent and of the child that stay orthogonal, or at a constant angle.
        let rows: Vec<(String, Moving<'g>, Moving<'g>, Expr<'g>)> = match turns.as_slice() {
            // The sines of the angles about three axes.
            [] => (0..3)
                .map(|k| {
                    let (l, m) = ((k + 1) % 3, (k + 2) % 3);
                    (format!("w{}", AXES[k]), of_parent(axis(m)), of_child(axis(l)), self.scope.graph.zero())
                })
                .collect(),
            [axis] => perpendicular(*axis)
                .into_iter()
                .map(|(word, e)| {
                    (format!("tilt_{word}"), of_parent(e), of_child(*axis), self.scope.graph.zero())
                })
                .collect(),
            [first, second, ..] => {
                vec![("axes".to_string(), of_parent(*first), of_child(*second), first.dot(*second))]
            }
        };
        for (word, e, carried, angle) in rows {
            let mut jet = e.dot(&carried);
            jet.value -= angle;
            self.push(ends, &word, jet, (Measure::Angle, carried.value.cross(e.value)));
        }
    }

    /// A row of a joint, with the force of a length or the torque of an angle on the child that its multiplier is, in the
    /// axes of the link that carries both ends.
    fn push(
        &mut self,
        ends: &Closing<'g>,
        word: &str,
        jet: Jet<'g>,
        (measure, direction): (Measure, Vec3<'g>),
    ) {
        let joint = &self.description.joints[ends.j].name;
        let Jet { value, rate, second } = jet;
        let transmits = self.transmission(ends, measure == Measure::Angle, direction);
        self.model.constraints.push(Constraint {
            name: format!("{}.{word}", joint.text),
            place: joint.place.clone(),
            residual: Some(value),
            rate,
            bias: second,
            measure,
            transmits: vec![transmits],
            group: self.group,
            determines: false,
            friction: Vec::new(),
        });
    }

    fn transmission(&self, ends: &Closing<'g>, torque: bool, direction: Vec3<'g>) -> Transmission<'g> {
        let joints = &self.scope.world.borrow().joints;
        let direction = change_axes(joints, direction, ends.on_child.ancestor, None);
        Transmission { joint: ends.j, torque, direction }
    }

    /// A row of a constraint that was declared, whose rate is known.
    pub fn push_rate(
        &mut self,
        (name, place): (String, &Place),
        measure: Measure,
        residual: Option<Expr<'g>>,
        rate: Expr<'g>,
    ) {
        let bias = time_derivative(self.model.space(), rate);
        self.model.constraints.push(Constraint {
            name,
            place: place.clone(),
            residual,
            rate,
            bias,
            measure,
            transmits: Vec::new(),
            group: self.group,
            determines: false,
            friction: Vec::new(),
        });
    }

    /// Motion of a link relative to the nearest link that carries it and another.
    pub fn relative(&self, link: Option<LinkId>, other: Option<LinkId>) -> Relative<'g> {
        let world = self.scope.world.borrow();
        let parent = |l: LinkId| world.joints[l.0].parent;
        let (mut a, mut b) = (link, other);
        let mut path = Vec::new();
        // Parents have smaller indices, so the deeper of two links is the one with the larger index.
        while a != b {
            if a > b {
                path.extend(a);
                a = a.and_then(parent);
            } else {
                b = b.and_then(parent);
            }
        }
        let g = self.scope.graph;
        let v: Vec<Expr<'g>> = (0..self.model.nv()).map(|k| Quantity::Velocity(k).expr(g)).collect();
        let still = vec![g.zero(); self.model.nv()];
        let zero = Spatial::zero(&self.model);
        let mut motion: Option<(Spatial<'g>, Spatial<'g>)> = None;
        for l in path.iter().rev() {
            let joint = &world.joints[l.0];
            let own = joint.twist(&self.model, &v);
            let twist = motion.as_ref().map_or(own, |(twist, _)| joint.twist_to_child(twist).plus(&own));
            let before = motion.as_ref().map(|(twist, acceleration)| (twist, acceleration));
            let acceleration = joint.acceleration(&self.model, before, &v, &still);
            motion = Some((twist, acceleration));
        }
        let (twist, acceleration) = motion.unwrap_or((zero, zero));
        Relative { link, ancestor: a, twist, acceleration }
    }

    /// A point of a link.
    pub fn point(&self, on: &Relative<'g>, p: Vec3<'g>) -> Moving<'g> {
        let world = self.scope.world.borrow();
        let mut value = p;
        let mut at = on.link;
        while at != on.ancestor {
            let Some(l) = at else { break };
            let joint = &world.joints[l.0];
            value = joint.translation + joint.rotation.to_parent(value);
            at = joint.parent;
        }
        let (w, a) = (on.twist.angular, &on.acceleration);
        let rate = on.twist.linear + w.cross(p);
        let second = a.linear + a.angular.cross(p) + w.cross(w.cross(p));
        let out = |v| change_axes(&world.joints, v, on.link, on.ancestor);
        Moving { value, rate: out(rate), second: out(second) }
    }

    /// A direction fixed in a link.
    pub fn direction(&self, on: &Relative<'g>, e: Vec3<'g>) -> Moving<'g> {
        let w = on.twist.angular;
        let second = on.acceleration.angular.cross(e) + w.cross(w.cross(e));
        let out = |v| self.direction_out(on, v);
        Moving { value: out(e), rate: out(w.cross(e)), second: out(second) }
    }

    /// A vector of a link, in the axes of the ancestor.
    pub fn direction_out(&self, on: &Relative<'g>, v: Vec3<'g>) -> Vec3<'g> {
        change_axes(&self.scope.world.borrow().joints, v, on.link, on.ancestor)
    }

    fn add_holonomic(&mut self, constraint: &syntax::Constraint, measure: Measure, cx: &mut Diagnostics) {
        self.scope.constrains.set(true);
        let rows = self.difference(constraint, Level::Placement, cx);
        self.scope.constrains.set(false);
        for (name, residual) in self.without_idle(rows) {
            if symbols_in(&[residual]).iter().all(|s| matches!(Quantity::of(*s), Quantity::Parameter(_))) {
                cx.error(constraint.value.place.clone(), "this restricts no coordinate")
                    .help("an expression of coordinates stays zero, or equal to another one");
                return;
            }
            let rate = time_derivative(self.model.space(), residual);
            self.push_rate((name, &constraint.name.place), measure, Some(residual), rate);
        }
    }

    /// The components of a vector without those that are zero wherever the mechanism is, as they are across its plane; all
    /// of them if they all are.
    fn without_idle(&mut self, rows: Vec<(String, Expr<'g>)>) -> Vec<(String, Expr<'g>)> {
        let is_idle = |e: &Expr<'g>| {
            let constant = |q: Quantity| matches!(q, Quantity::Parameter(_));
            symbols_in(&[*e]).into_iter().all(|s| constant(Quantity::of(s))) && always(*e, 0.0)
        };
        let (idle, rest): (Vec<_>, Vec<_>) = rows.into_iter().partition(|(_, e)| is_idle(e));
        if rest.is_empty() {
            return idle;
        }
        self.model.redundant.extend(idle.into_iter().map(|(name, _)| name));
        rest
    }

    /// Reads what a constraint says, for its mistakes alone.
    fn check_constraint(&self, constraint: &syntax::Constraint, cx: &mut Diagnostics) {
        let holonomic = constraint.kind == ConstraintKind::Holonomic;
        match constraint.kind {
            ConstraintKind::Holonomic | ConstraintKind::Nonholonomic => {
                self.scope.constrains.set(holonomic);
                let level = if holonomic { Level::Placement } else { Level::Motion };
                let _ = self.difference(constraint, level, cx);
                self.scope.constrains.set(false);
            }
            ConstraintKind::Rolling | ConstraintKind::Slipping => self.check_pair(constraint, cx),
        }
    }

    fn add_nonholonomic(&mut self, constraint: &syntax::Constraint, measure: Measure, cx: &mut Diagnostics) {
        let rows = self.difference(constraint, Level::Motion, cx);
        for (name, rate) in self.without_idle(rows) {
            let place = &constraint.value.place;
            let gradient = velocity_gradient(rate);
            let coefficients: Vec<Expr<'g>> = gradient.iter().map(|(_, c)| *c).collect();
            let is = |e: &[Expr<'g>], f: fn(Quantity) -> bool| {
                symbols_in(e).into_iter().any(|s| f(Quantity::of(s)))
            };
            if gradient.is_empty() {
                cx.error(place.clone(), "this restricts no velocity")
                    .help("a constraint on coordinates is a `Holonomic` one");
                return;
            }
            if is(&[rate], |q| matches!(q, Quantity::Input(_))) {
                cx.error(place.clone(), "a constraint contains no input")
                    .help("a motion that is given is an expression of time `t`");
                return;
            }
            let linear = match is(&coefficients, |q| matches!(q, Quantity::Velocity(_))) {
                true => linear_form(rate, &gradient),
                false => Some(rate),
            };
            let Some(linear) = linear else {
                cx.error(place.clone(), "this constraint is not linear in the velocities").help(
                    "each term holds one velocity at most, as in `dot(v(skate / ground / ground), sled.y)`",
                );
                return;
            };
            self.push_rate((name, &constraint.name.place), measure, None, linear);
        }
    }

    /// Left side minus right side: one component, or three.
    fn difference(
        &self,
        constraint: &syntax::Constraint,
        level: Level,
        cx: &mut Diagnostics,
    ) -> Vec<(String, Expr<'g>)> {
        use super::expression::Value;
        let name = &constraint.name.text;
        let view = || View::new(level, Some((None, Pose::identity(self.scope.graph))));
        let turns = |e: &syntax::Expr| match &e.kind {
            ExprKind::Call(word, _) => word.text == "angle",
            _ => self.is_angle(e),
        };
        let pair = [Some(&constraint.value), constraint.other.as_ref()];
        for (side, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
            if let (Some(side), Some(other)) = (side, other)
                && level == Level::Placement
                && turns(side)
                && !slips::check_angle(other, cx)
            {
                return Vec::new();
            }
        }
        let left = self.scope.with_view(view(), |scope| scope.value(&constraint.value, cx));
        if left.is_none() {
            // What the other side says is told as well.
            if let Some(other) = &constraint.other {
                let _ = self.scope.with_view(view(), |scope| scope.value(other, cx));
            }
            return Vec::new();
        }
        let vector = matches!(left, Some(Value::Vector(_)));
        let mut sides = vec![&constraint.value];
        sides.extend(&constraint.other);
        if !vector {
            let values: Vec<Option<Expr<'g>>> =
                sides.iter().map(|e| self.scope.with_view(view(), |scope| scope.scalar(e, cx))).collect();
            return match values.as_slice() {
                [Some(left), Some(right)] => vec![(name.clone(), *left - *right)],
                [Some(left)] => vec![(name.clone(), *left)],
                _ => Vec::new(),
            };
        }
        let terms: Vec<_> =
            sides.iter().map(|e| self.scope.with_view(view(), |scope| scope.terms(e, cx))).collect();
        let Some(terms) = terms.into_iter().collect::<Option<Vec<_>>>() else { return Vec::new() };
        let world = self.scope.world.borrow();
        let zero = Vec3::zero(self.scope.graph);
        let sides: Vec<Vec3<'g>> = terms.iter().map(|t| world.resolve(t, None, zero)).collect();
        let gap = sides.get(1).map_or(sides[0], |right| sides[0] - *right);
        (0..3).map(|k| (format!("{name}.{}", AXES[k]), gap[k])).collect()
    }
}

/// The axis of a slide.
fn slide_of<'g>(motion: &Elementary<'g>) -> Option<Vec3<'g>> {
    match motion {
        Elementary::Slide(axis) | Elementary::Helix(axis, _) => Some(*axis),
        _ => None,
    }
}

/// The axis of a turn.
fn turn_of<'g>(motion: &Elementary<'g>) -> Option<Vec3<'g>> {
    match motion {
        Elementary::Turn(axis) | Elementary::Helix(axis, _) => Some(*axis),
        _ => None,
    }
}

/// Two directions orthogonal to an axis and to each other, with their names.
pub fn perpendicular(axis: Vec3<'_>) -> [(&'static str, Vec3<'_>); 2] {
    let g = axis[0].graph();
    let words: [(&'static str, Vec3<'_>); 3] = [0, 1, 2].map(|k| (AXES[k], Vec3::axis(g, k)));
    let along = |k: usize| axis.values().is_some_and(|n| n[k].abs() == 1.0);
    if let Some(k) = (0..3).find(|k| along(*k)) {
        return [words[(k + 1) % 3], words[(k + 2) % 3]];
    }
    let [first, second] = match in_plane(axis) {
        Some((first, second)) => [first, second],
        None => {
            // The coordinate axis that the direction is farthest from for a sample of the parameters.
            let at = eval(&axis.0, &|s| sample(s, 0));
            let far = (0..3).min_by(|a, b| at[*a].abs().total_cmp(&at[*b].abs())).unwrap_or(0);
            let first = super::expression::unit(axis.cross(Vec3::axis(g, far)));
            [first, axis.cross(first)]
        }
    };
    [("first", first), ("second", second)]
}

/// A rate whose derivatives by the velocities name velocities, but do not depend on them: the same without those. `None` if
/// they do.
fn linear_form<'g>(rate: Expr<'g>, gradient: &[(usize, Expr<'g>)]) -> Option<Expr<'g>> {
    // Signs and corners show where velocities change their signs, together or not.
    let at = |e: Expr<'g>, pattern: u64| {
        eval_one(e, &|s| match Quantity::of(s) {
            Quantity::Velocity(k) if pattern >> (k % 64) & 1 == 1 => -sample(s, pattern),
            Quantity::Velocity(_) => sample(s, pattern),
            _ => sample(s, 0),
        })
    };
    let is_constant = |e: Expr<'g>| {
        let first = at(e, 0);
        let near = |x: f64| (x - first).abs() <= 1e-9 * (1.0 + first.abs());
        first.is_finite() && [1, 2, 0x5555_5555, 0xAAAA_AAAA, u64::MAX].iter().all(|p| near(at(e, *p)))
    };
    let with = |e: Expr<'g>, value: f64| {
        replace(e, &|s| matches!(Quantity::of(s), Quantity::Velocity(_)).then(|| e.num(value)))
    };
    let rest = with(rate, 0.0);
    if !gradient.iter().all(|(_, c)| is_constant(*c)) || !at(rest, 0).is_finite() {
        return None;
    }
    let g = rate.graph();
    Some(gradient.iter().fold(rest, |sum, (k, c)| sum + with(*c, 1.0) * Quantity::Velocity(*k).expr(g)))
}
