//! Puts the model together: scope, tree, links, bodies, force elements.

use super::expression::{Axes, Scope, Value};
use super::figures::Range;
use super::joint::{Elementary, coordinate_names, full_name, own_coordinate};
use super::masses::MassProperties;
use super::tree::{GROUND, Held, find_tree};
use super::world::{Level, PlacedKind, View, World};
use super::{closed_form, joint, reaction, tree, units};
use crate::diag::{Diagnostics, all_of};
use crate::expr::{Graph, Rotation, Vec3};
use crate::kinematics::{accelerations, twists};
use crate::mechanism::{
    Chart, Constraint, Coordinate, CoulombFriction, Dashpot, Gradients, Inertia, Input, Link, LinkId, Model,
    Motion, NamedFrame, Opened, Pose, Quantity, Units,
};
use crate::syntax::{
    Action, ActionKind, Description, Endpoint, ExprKind, Inertias, Joint, JointKind, ScalarType, Target,
};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Most velocities of a mechanism: beyond it the generated code would be unreasonably large.
const MAX_VELOCITIES: usize = 128;
/// Parameters that nothing uses: so many are told one by one.
const FEW: usize = 3;

/// What to do with more.
const TOO_MANY: &str = "every degree of freedom is written out, and the code of the mass matrix grows as their square: divide the mechanism into several, weld what hardly moves (`Weld`, `lock = [\"joint\"]` of a file), or compute a long chain by a loop of your own";

/// Most bodies of a mechanism.
const MAX_BODIES: usize = 1024;

/// Speed at which dry friction is regularised, unless given.
const FRICTION_SPEED: f64 = 0.01;

/// What is known of a joint once its coordinates are numbered.
struct JointCoordinates {
    /// First index in `q` and in `v`.
    q: usize,
    v: usize,
    /// The coordinates that force elements can act on: name, coordinate, whether an angle.
    plain: Vec<(String, Coordinate, bool)>,
}

/// The model under construction.
pub struct Builder<'a, 'g> {
    /// Where names are looked up.
    pub scope: Scope<'a, 'g>,
    /// What is built.
    pub model: Model<'g>,
    /// What the user wrote.
    pub description: &'a Description,
    /// Bodies and jointed particles.
    held: Vec<Held<'a>>,
    /// Their placement, once known.
    pub places: Vec<Option<(Option<LinkId>, Pose<'g>)>>,
    /// Names of everything that has a place or axes.
    pub placeable: Vec<String>,
    /// By body: mass, centre of mass, central inertia.
    pub masses: Vec<Option<MassProperties<'g>>>,
    /// By joint.
    coordinates: Vec<JointCoordinates>,
    /// Loops that are solved in closed form.
    pub embedded: Vec<closed_form::Embedded>,
    /// Joints to be opened, and the names of the constraints that a mechanism with opened joints keeps.
    pub opening: Option<(&'a [usize], &'a [Constraint<'g>])>,
    /// Number of the group of constraints that is being added.
    pub group: usize,
    /// Mistakes that only the motion shows: they are told together with those of units.
    pub mobility: Diagnostics,
}

/// Checks a description and builds its model. `None` after a mistake; every mistake is in `cx`.
pub fn build_model<'g>(
    description: &Description,
    graph: &'g Graph,
    cx: &mut Diagnostics,
) -> Option<Model<'g>> {
    if description.bodies.len() + description.particles.len() > MAX_BODIES {
        cx.error(description.name.place.clone(), format!("more than {MAX_BODIES} bodies"))
            .help("each body becomes code of its own: divide the mechanism, or weld bodies that do not move into one");
        return None;
    }
    if description.bodies.is_empty() && description.particles.is_empty() {
        cx.error(description.name.place.clone(), "a mechanism without a body")
            .help("add one, as in `#[body(mass = 1)] cart: Body`, or read a file: `#[mechanism(urdf = \"robot.urdf\")]`");
        return None;
    }
    let mut model = build(description, graph, None, cx)?;
    let joints = reaction::to_open(&model);
    if !joints.is_empty() {
        let same = build(description, graph, Some((&joints, &model.constraints)), cx)?;
        model.opened = Some(Rc::new(Opened { model: same, joints }));
    }
    Some(model)
}

/// Builds the model; with opened joints it keeps the given constraints.
fn build<'g>(
    description: &Description,
    graph: &'g Graph,
    opening: Option<(&[usize], &[Constraint<'g>])>,
    cx: &mut Diagnostics,
) -> Option<Model<'g>> {
    let mut builder = Builder { opening, ..Builder::new(description, graph, cx) };
    builder.number_coordinates(cx);
    if builder.model.nv() > MAX_VELOCITIES && opening.is_none() {
        let n = builder.model.nv();
        cx.error(
            description.name.place.clone(),
            format!("{n} degrees of freedom, more than {MAX_VELOCITIES}"),
        )
        .help(TOO_MANY);
        return None;
    }
    builder.number_open_coordinates(opening.map_or(&[], |(joints, _)| joints));
    let order = find_tree(description, &builder.held, &builder.scope, cx);
    match &order {
        Some(order) => builder.place_all(order, cx),
        None => builder.check_joints(cx),
    }
    builder.add_masses(cx);
    if let Some(order) = order.filter(|_| builder.is_placed()) {
        builder.know_motion();
        builder.add_actions(cx);
        builder.remember_solved(cx);
        builder.add_constraints(&order.closing, cx);
        builder.add_expressions(cx);
        builder.find_dependencies();
        builder.add_frames();
        builder.check_finite(cx);
    } else {
        builder.check_actions(cx);
    }
    builder.check_unused(cx);
    if cx.is_empty() && opening.is_none() {
        let coordinates = &builder.scope.world.borrow().coordinates;
        builder.model.units = units::infer(description, &builder.model, coordinates, cx);
    }
    if !description.partial {
        cx.append(builder.mobility);
    }
    cx.is_empty().then_some(builder.model)
}

/// A model without contents.
fn empty_model<'g>(
    graph: &'g Graph,
    description: &Description,
    gravity: Vec3<'g>,
    friction_speed: crate::expr::Expr<'g>,
) -> Model<'g> {
    Model {
        graph,
        name: description.name.text.clone(),
        place: description.name.place.clone(),
        parameters: description.parameters.iter().map(|p| p.text.clone()).collect(),
        kinematic: description.inertias == Inertias::None,
        gravity,
        friction_speed,
        links: Vec::new(),
        still: Inertia::zero(graph),
        time: false,
        velocity_inputs: false,
        charts: Vec::new(),
        gradients: Gradients::default(),
        configuration: Vec::new(),
        velocities: Vec::new(),
        inputs: Vec::new(),
        frames: Vec::new(),
        springs: Vec::new(),
        dashpots: Vec::new(),
        frictions: Vec::new(),
        potentials: Vec::new(),
        dissipations: Vec::new(),
        constraints: Vec::new(),
        redundant: Vec::new(),
        dependent: None,
        solved: Vec::new(),
        freedom: [0; 2],
        loads: Vec::new(),
        passive: None,
        inertances: Vec::new(),
        outputs: Vec::new(),
        opened: None,
        units: Units::default(),
    }
}

impl<'a, 'g> Builder<'a, 'g> {
    fn new(description: &'a Description, graph: &'g Graph, cx: &mut Diagnostics) -> Builder<'a, 'g> {
        let held: Vec<Held<'a>> = description
            .bodies
            .iter()
            .map(|b| Held { name: &b.name })
            .chain(description.particles.iter().filter(|p| p.at.is_none()).map(|p| Held { name: &p.name }))
            .collect();
        let all =
            description.bodies.iter().map(|b| &b.name).chain(description.particles.iter().map(|p| &p.name));

        let scope = Scope {
            graph,
            parameters: &description.parameters,
            used: vec![false; description.parameters.len()].into(),
            bodies: all
                .clone()
                .chain(description.frames.iter().map(|f| &f.name))
                .map(|n| n.text.clone())
                .collect(),
            frames: description.frames.iter().map(|f| f.name.text.clone()).collect(),
            joints: description.joints.iter().map(|j| j.name.text.clone()).collect(),
            actions: description.actions.iter().map(|a| a.name.text.clone()).collect(),
            inputs: &description.inputs,
            driven: description.joints.iter().filter(|j| j.driven && j.mimic.is_none()).count(),
            definitions: &description.definitions,
            view: View::new(Level::Constant, None).into(),
            world: World::default().into(),
            single: description.scalar == ScalarType::F32,
            unknown: BTreeSet::new().into(),
            failed: BTreeSet::new().into(),
            constrains: false.into(),
            known: BTreeMap::new().into(),
        };
        for name in all.clone().filter(|n| n.text == GROUND) {
            cx.error(name.place.clone(), "the name `ground` is taken: it is what does not move")
                .help("choose another name, or remove the body: joints begin at `ground` as it is");
        }
        check_names(description, cx);
        let gravity = description.gravity.as_ref().and_then(|e| read_gravity(e, &scope, cx));
        let friction_speed = match &description.friction_speed {
            Some(e) => scope.scalar(e, cx).unwrap_or(graph.one()),
            None => graph.num(FRICTION_SPEED),
        };
        if let (Some(e), Some(s)) = (&description.friction_speed, friction_speed.value())
            && s <= 0.0
        {
            cx.error(e.place.clone(), format!("this speed must be positive, but it is {s}"))
                .help("around it Coulomb's law is smooth; 0.01 is usual");
        }
        let model = empty_model(graph, description, gravity.unwrap_or(Vec3::zero(graph)), friction_speed);
        let places = vec![None; held.len()];
        let mut placeable: Vec<String> = all.map(|n| n.text.clone()).collect();
        placeable.extend(description.frames.iter().map(|f| f.name.text.clone()));
        placeable.extend(description.points.iter().map(|p| p.name.text.clone()));
        Builder {
            scope,
            model,
            description,
            held,
            places,
            coordinates: Vec::new(),
            placeable,
            masses: Vec::new(),
            embedded: Vec::new(),
            opening: None,
            group: 0,
            mobility: Diagnostics::new(),
        }
    }

    /// Numbers `q` and `v` in the order of declaration; joints that close loops have no coordinates. Joints that follow
    /// another one come after, since their masters may be declared later.
    fn number_coordinates(&mut self, cx: &mut Diagnostics) {
        let closing = tree::closing(self.description);
        self.embedded = closed_form::find(self.description, &closing, cx);
        for (j, joint) in self.description.joints.iter().enumerate() {
            self.number_free_coordinates(j);
            let (q, v) = (self.model.nq(), self.model.nv());
            let mut plain = Vec::new();
            if joint.mimic.is_none() && !closing[j] && self.embedding(j).is_none() {
                self.model.charts.extend(charts(joint.kind, q, v, joint.along.len()));
                let (names_q, names_v) = coordinate_names(joint.kind, joint.along.len());
                for name in names_q {
                    self.model.configuration.push(full_name(&joint.name.text, name));
                }
                for (k, name) in names_v.iter().enumerate() {
                    let full = full_name(&joint.name.text, name);
                    if names_q == names_v {
                        plain.push((full.clone(), own_coordinate(q + k, v + k), is_angle(joint.kind, name)));
                    }
                    self.model.velocities.push((full, joint.name.place.clone()));
                }
            }
            self.scope.world.borrow_mut().coordinates.extend(plain.iter().cloned());
            self.coordinates.push(JointCoordinates { q, v, plain });
        }
        self.number_free_coordinates(self.description.joints.len());
        for (k, joint) in self.description.joints.iter().enumerate() {
            let Some(mimic) = &joint.mimic else { continue };
            let master = self.description.joints.iter().position(|j| j.name.text == mimic.joint.text);
            match master.map(|m| self.coordinates[m].plain.as_slice()) {
                Some([(_, c, _)]) => {
                    let coordinate = Coordinate {
                        ratio: mimic.multiplier * c.ratio,
                        offset: mimic.multiplier * c.offset + mimic.offset,
                        ..*c
                    };
                    let angle = is_angle(joint.kind, "");
                    self.scope.world.borrow_mut().coordinates.push((
                        joint.name.text.clone(),
                        coordinate,
                        angle,
                    ));
                    self.coordinates[k].plain.push((joint.name.text.clone(), coordinate, angle));
                }
                _ => {
                    cx.error(mimic.joint.place.clone(), format!("`{}` cannot be followed", mimic.joint.text))
                        .help("a joint that is followed has one coordinate of its own");
                }
            }
        }
    }

    /// Free coordinates that are declared after the given number of joints.
    fn number_free_coordinates(&mut self, joints: usize) {
        for free in self.description.coordinates.iter().filter(|c| c.joints_before == joints) {
            let (q, v) = (self.model.nq(), self.model.nv());
            self.model.configuration.push(free.name.text.clone());
            self.model.velocities.push((free.name.text.clone(), free.name.place.clone()));
            self.model.charts.push(Chart::Plain(q, v));
            let mut world = self.scope.world.borrow_mut();
            world.coordinates.push((free.name.text.clone(), own_coordinate(q, v), false));
        }
    }

    /// Resolves what the joints say although the tree is broken, so that all mistakes are reported at once.
    fn check_joints(&self, cx: &mut Diagnostics) {
        for joint in &self.description.joints {
            self.check_joint(joint, cx);
        }
    }

    /// Resolves what one joint says, for its mistakes alone.
    pub fn check_joint(&self, joint: &Joint, cx: &mut Diagnostics) {
        let _ = self.scope.motions(joint, cx);
        let _ = self.endpoint(&joint.parent, cx);
        let _ = self.endpoint(&joint.child, cx);
    }

    /// Resolves force elements on coordinates, which need no places.
    fn check_actions(&mut self, cx: &mut Diagnostics) {
        for action in &self.description.actions {
            let on_joint = match &action.on {
                Target::On(e) => match &e.kind {
                    ExprKind::Name(name) => self.joint_coordinates(name).is_some(),
                    ExprKind::Field(..) => true,
                    _ => false,
                },
                Target::Between(..) => false,
            };
            if on_joint && !needs_motion(action) {
                self.add_action(action, cx);
            }
        }
    }

    /// The joint's frame on the body of one of its ends.
    pub fn endpoint(&self, end: &Endpoint, cx: &mut Diagnostics) -> Option<Pose<'g>> {
        let translation = match &end.at {
            Some(at) => self.scope.own_vector(at, cx).filter(|v| {
                let range = Range::of(&self.description.scalar);
                v.0.iter().all(|c| range.check_length(*c, &at.place, cx))
            }),
            None => Some(Vec3::zero(self.scope.graph)),
        };
        let rotation = self.scope.rotation(&end.rotated, cx);
        Some(Pose { rotation: rotation?, translation: translation? })
    }

    /// Places the child of a joint.
    pub fn place_joint(&mut self, j: usize, child: usize, cx: &mut Diagnostics) {
        let joint = &self.description.joints[j];
        let motions = self.scope.motions(joint, cx);
        let (on_parent, on_child) = (self.endpoint(&joint.parent, cx), self.endpoint(&joint.child, cx));
        let start = self.joint_parent(&joint.parent.body, cx);
        // What has a mistake is placed somehow, so that what depends on it is read as well.
        let motions = motions.unwrap_or_else(|| joint::somehow(self.scope.graph, joint));
        let on_parent = on_parent.unwrap_or_else(|| self.somewhere(false));
        let on_child = on_child.unwrap_or_else(|| self.somewhere(false));
        if let Some((link, pose)) = start {
            let frame = pose.then(&on_parent);
            self.transmit(j, link, &frame.rotation);
            let (joints, _) = self.opening.unwrap_or_default();
            let (link, frame) = match joints.iter().position(|open| *open == j) {
                Some(at) => self.open(at, joints.len(), link, frame),
                None => (link, frame),
            };
            let (link, pose) = match self.embedding(j) {
                Some(_) => {
                    let solved = self.embedded_pose(j, cx).unwrap_or_else(|| self.somewhere(true));
                    self.settle(link, frame.then(&solved))
                }
                None => self.add_chain(j, &motions, link, frame),
            };
            let pose = pose.then(&on_child.inverse());
            let kind =
                if child < self.description.bodies.len() { PlacedKind::Body } else { PlacedKind::Point };
            self.remember(&self.held[child].name.text, link, pose.clone(), kind);
            self.places[child] = Some((link, pose));
        }
        self.add_passive(j, joint, cx);
    }

    /// A place for what has a mistake, with figures that nothing else has: where it should have been does not matter.
    pub fn somewhere(&self, moves: bool) -> Pose<'g> {
        let g = self.scope.graph;
        let mut translation = Vec3::numbers(g, [0.731, 0.417, 0.593]);
        if moves {
            translation += Vec3::axis(g, 0) * Quantity::Time.expr(g);
        }
        Pose { rotation: Rotation::identity(g), translation }
    }

    /// True if every body has its place.
    fn is_placed(&self) -> bool {
        self.places.iter().all(Option::is_some)
    }

    /// Twists and accelerations of the links, for the expressions that name velocities.
    fn know_motion(&mut self) {
        let g = self.scope.graph;
        let v: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Velocity(k).expr(g)).collect();
        let a: Vec<_> = (0..self.model.nv()).map(|k| Quantity::Acceleration(k).expr(g)).collect();
        // Robots are large, and few of them name a velocity.
        let d = self.description;
        let plain = d.actions.iter().all(|a| !needs_motion(a))
            && d.outputs.is_empty()
            && d.constraints.is_empty()
            && d.dissipations.is_empty()
            && d.definitions.is_empty();
        if plain {
            return;
        }
        let mut world = self.scope.world.borrow_mut();
        world.twists = twists(&self.model, &world.joints, &v);
        world.accelerations = accelerations(&self.model, &world.joints, &world.twists, &v, &a);
    }

    /// Adds one link for each motion; returns the last link and the joint's child frame on it.
    fn add_chain(
        &mut self,
        j: usize,
        motions: &[Elementary<'g>],
        mut link: Option<LinkId>,
        mut pose: Pose<'g>,
    ) -> (Option<LinkId>, Pose<'g>) {
        let graph = self.scope.graph;
        for (k, motion) in motions.iter().enumerate() {
            let own = &self.coordinates[j];
            let coordinate = own.plain.get(k).map_or(own_coordinate(own.q, own.v), |(_, c, _)| *c);
            let mut aligned = Rotation::identity(graph);
            let mut align = |axis| {
                let (axis, rotation) = super::axis::align(graph, axis);
                aligned = rotation;
                axis
            };
            let motion = match motion {
                Elementary::Turn(axis) => Motion::Turn { axis: align(*axis), coordinate },
                Elementary::Helix(axis, pitch) => {
                    Motion::Helix { axis: align(*axis), pitch: *pitch, coordinate }
                }
                Elementary::Slide(axis) => Motion::Slide { axis: *axis, coordinate },
                Elementary::Ball => Motion::Ball { q: own.q, v: own.v },
                Elementary::Free => Motion::Free { q: own.q, v: own.v },
            };
            let placement = Pose { rotation: pose.rotation.then(&aligned), translation: pose.translation };
            link =
                Some(self.add_link(Link { parent: link, placement, motion, inertia: Inertia::zero(graph) }));
            pose = Pose { rotation: aligned.inverse(), translation: Vec3::zero(graph) };
        }
        (link, pose)
    }

    /// Damping, friction and motor of a joint itself.
    fn add_passive(&mut self, j: usize, joint: &Joint, cx: &mut Diagnostics) {
        let [(name, on, _)] = self.coordinates[j].plain.as_slice() else {
            return;
        };
        let (name, on) = (name.clone(), *on);
        let damping = joint.damping.as_ref().and_then(|e| self.scope.scalar(e, cx));
        let friction = joint.friction.as_ref().and_then(|e| self.scope.scalar(e, cx));
        self.model.dashpots.extend(damping.map(|damping| Dashpot { on, damping }));
        self.model.frictions.extend(friction.map(|friction| CoulombFriction { on, friction }));
        if joint.driven && joint.mimic.is_none() {
            self.model.inputs.push((name, Input::Coordinate(on)));
        }
    }

    fn add_actions(&mut self, cx: &mut Diagnostics) {
        // Inputs without an element of their own appear in expressions; the others are filled in by their elements.
        for input in &self.description.inputs {
            self.model.inputs.push((input.text.clone(), Input::Named));
        }
        for action in &self.description.actions {
            self.add_action(action, cx);
        }
    }

    fn add_frames(&mut self) {
        let d = self.description;
        let massive = d.bodies.iter().map(|b| &b.name).chain(d.particles.iter().map(|p| &p.name));
        let massive = massive.map(|name| (name, true));
        if d.ground_frame {
            let (name, pose) = (GROUND.to_string(), Pose::identity(self.scope.graph));
            self.model.frames.push(NamedFrame { name, massive: false, link: None, pose });
        }
        let world = self.scope.world.borrow();
        for (name, massive) in massive.chain(d.points.iter().map(|p| (&p.name, false))) {
            if let Some(p) = world.places.get(&name.text) {
                let (name, link, pose) = (name.text.clone(), p.link, p.pose.clone());
                self.model.frames.push(NamedFrame { name, massive, link, pose });
            }
        }
    }

    /// A parameter that nothing uses is most likely a slip; a leading underscore says that it is meant.
    fn check_unused(&self, cx: &mut Diagnostics) {
        if !cx.is_empty() {
            return;
        }
        let used = self.scope.used.borrow();
        let unused = self.description.parameters.iter().zip(used.iter());
        let unused: Vec<_> =
            unused.filter(|(p, used)| !**used && !p.text.starts_with('_')).map(|(p, _)| p).collect();
        // A whole attribute that says nothing of what was meant is one mistake.
        if let [first, rest @ ..] = unused.as_slice()
            && rest.len() >= FEW
        {
            let list: Vec<String> = unused.iter().map(|p| format!("`{}`", p.text)).collect();
            cx.error(first.place.clone(), format!("nothing uses the parameters {}", all_of(&list)))
                .help("remove them, or let their names begin with `_` to keep them for your own use");
            return;
        }
        for parameter in unused {
            cx.error(parameter.place.clone(), format!("nothing uses the parameter `{}`", parameter.text))
                .help(format!("remove it, or name it `_{}` to keep it for your own use", parameter.text));
        }
    }

    /// Index of a body or jointed particle.
    pub fn held_index(&self, name: &str) -> Option<usize> {
        self.held.iter().position(|h| h.name.text == name)
    }

    /// The coordinates of a joint that force elements can act on; `None` if there is no such joint.
    pub fn joint_coordinates(&self, name: &str) -> Option<Vec<(String, Coordinate, bool)>> {
        let j = self.description.joints.iter().position(|j| j.name.text == name)?;
        Some(self.coordinates[j].plain.clone())
    }

    /// True for the name of a coordinate that is an angle.
    pub fn is_angle(&self, e: &crate::syntax::Expr) -> bool {
        let name = match &e.kind {
            ExprKind::Name(name) => name.clone(),
            ExprKind::Field(joint, member) => full_name(joint.name().unwrap_or_default(), &member.text),
            _ => return false,
        };
        let world = self.scope.world.borrow();
        world.coordinates.iter().any(|(known, _, angle)| *known == name && *angle)
    }

    /// Names of all joints.
    pub fn joint_names(&self) -> Vec<String> {
        self.description.joints.iter().map(|j| j.name.text.clone()).collect()
    }
}

/// Gravity, a vector in ground axes.
fn read_gravity<'g>(
    e: &crate::syntax::Expr,
    scope: &Scope<'_, 'g>,
    cx: &mut Diagnostics,
) -> Option<Vec3<'g>> {
    if let Some(Value::Scalar(s)) = scope.value(e, &mut Diagnostics::unread())
        && !s.is_zero()
    {
        let (sign, size) = match e.literal() {
            Some(n) => ("-", n.abs().to_string()),
            None => ("-", e.spelt()),
        };
        cx.error(e.place.clone(), "expected a vector, found a scalar")
            .help(format!("gravity has a direction: write `gravity = {sign}{size} * y`"));
        return None;
    }
    // Its own axes are the ground's.
    let mut terms = scope.vector(e, cx)?;
    for (axes, _) in &mut terms {
        if *axes == Axes::Of(GROUND.to_string()) {
            *axes = Axes::Own;
        }
    }
    scope.own_sum(terms, e, cx)
}

fn charts(kind: JointKind, q: usize, v: usize, along: usize) -> Vec<Chart> {
    match kind {
        JointKind::Ball => vec![Chart::Ball(q, v)],
        JointKind::Free => vec![Chart::Free(q, v)],
        _ => (0..coordinate_names(kind, along).1.len()).map(|k| Chart::Plain(q + k, v + k)).collect(),
    }
}

fn is_angle(kind: JointKind, coordinate: &str) -> bool {
    match kind {
        JointKind::Pin | JointKind::Screw | JointKind::Universal => true,
        JointKind::Collar | JointKind::Slot | JointKind::Planar => matches!(coordinate, "turn" | "angle"),
        _ => false,
    }
}

/// Reports names that mean something else in expressions.
fn check_names(description: &Description, cx: &mut Diagnostics) {
    let written = description.parameters.iter().chain(&description.inputs);
    let written = written.chain(description.coordinates.iter().map(|c| &c.name));
    let written = written.chain(description.definitions.iter().map(|d| &d.name));
    let joints = description.joints.iter().map(|joint| &joint.name);
    for name in written.chain(joints) {
        if ["x", "y", "z", "t", "pi"].contains(&name.text.as_str()) && name.place.file.is_none() {
            cx.error(name.place.clone(), format!("the name `{}` is taken", name.text))
                .help("`x`, `y` and `z` are axes, `t` is time and `pi` is a number");
        }
    }
}

/// True for force elements that are not on a coordinate, or have a law or a value.
fn needs_motion(action: &Action) -> bool {
    let own = match &action.kind {
        ActionKind::Force { value, .. } | ActionKind::Torque { value, .. } => value.is_some(),
        ActionKind::Gravity { .. } | ActionKind::Attraction { .. } => true,
        ActionKind::Dashpot { law } => !matches!(law, crate::syntax::Law::Linear(_)),
        _ => false,
    };
    own || matches!(action.on, Target::Between(..))
}
