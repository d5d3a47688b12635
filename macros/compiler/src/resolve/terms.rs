//! Force elements that are more than linear springs and dashpots on a coordinate: laws, elements between two
//! points, gravity towards a point, energies, friction, forces with a value.

use super::builder::Builder;
use super::constraint::Constrained;
use super::power::Counts;
use super::scope::{Allowed, Context, Placed};
use crate::diag::{Diagnostics, Place};
use crate::expr::diff::Derivative;
use crate::expr::eval::eval;
use crate::expr::replace::replace;
use crate::expr::sample::sample;
use crate::expr::{Expr, Extreme, Function, Node, Symbol, Vec3};
use crate::kinematics::{position_in, symbols_in, time_derivative, velocity_gradient};
use crate::language::Callable;
use crate::mechanism::{Coordinate, Inertance, Load, Pose, Quantity, Rule};
use crate::syntax::{self, ExprKind, Law};
use std::collections::BTreeSet;

/// Regularisation speed of friction, unless given.
const FRICTION_SPEED: f64 = 0.01;

/// Highest power of the stretch in a spring's force that is integrated to its energy.
const HIGHEST_POWER: usize = 9;

/// A length or angle that an element works on.
pub struct Stretch<'g> {
    /// Its value.
    pub value: Expr<'g>,
    /// Its rate, linear in the velocities.
    pub rate: Expr<'g>,
    /// Its square.
    pub square: Expr<'g>,
    /// The value has the sign of a direction that stays the same, and the length is its magnitude.
    pub signed: bool,
}

impl<'g> Builder<'_, 'g> {
    /// The stretch of a coordinate.
    pub fn coordinate_stretch(&self, c: &Coordinate) -> Stretch<'g> {
        let g = self.scope.graph;
        let value = position_in(g, c);
        Stretch { value, square: value.square(), rate: c.v.expr(g) * g.num(c.ratio), signed: false }
    }

    /// A length or an angle given by an expression of the coordinates, such as that of a cable.
    pub fn expression_stretch(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Stretch<'g>> {
        let stretch = self.stretch_of(e, cx)?;
        if velocity_gradient(stretch.rate).is_empty() {
            cx.error(e.place.clone(), "this contains no coordinate: nothing that acts on it has an effect")
                .help("an element acts on a length or an angle that changes with the motion, such as `norm(r(a / b))`");
            return None;
        }
        Some(stretch)
    }

    /// The value and the rate of an expression of places, which may be one that nothing changes.
    pub fn stretch_of(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Stretch<'g>> {
        let context = Context::new(Allowed::Placement, Some((None, Pose::identity(self.scope.graph))));
        let value = self.scope.in_context(context, |scope| scope.scalar(e, cx))?;
        let rate = time_derivative(self.model.space(), value);
        Some(Stretch { value, rate, square: value.square(), signed: false })
    }

    /// The distance between two points. Where they move along one line, it is the coordinate along that line,
    /// so that nothing happens when they meet; elsewhere the direction of a zero distance is the zero vector.
    pub fn distance(&self, a: &syntax::Expr, b: &syntax::Expr, cx: &mut Diagnostics) -> Option<Stretch<'g>> {
        let (first, second) = (self.scope.place(a, cx), self.scope.place(b, cx));
        let (first, second) = (first?, second?);
        if first.link == second.link {
            cx.error(b.place.clone(), "these two points do not move relative to each other")
                .help("let the element act between points of different bodies");
            return None;
        }
        let kinematics = self.scope.kinematics.borrow();
        let zero = Vec3::zero(self.scope.graph);
        let terms = kinematics.between(&second, &first);
        let axes = terms.first().and_then(|(link, _)| *link);
        let r = kinematics.resolve(&terms, axes, zero);
        // What moves along a line does so whichever joints are released.
        let held = Vec3(self.with_released_at_rest(&r.0).try_into().unwrap_or(r.0));
        if always_zero(held) {
            cx.error(b.place.clone(), "these two points are always at the same place")
                .help("let the element act between points that move apart");
            return None;
        }
        let mut v = kinematics.velocity(&second);
        v.extend(kinematics.velocity(&first).into_iter().map(|(link, v)| (link, -v)));
        if let Some(line) = constant_direction(held) {
            let e = Vec3::numbers(self.scope.graph, line);
            let rate = e.dot(kinematics.resolve(&v, axes, zero));
            let value = r.dot(e);
            return Some(Stretch { value, square: value.square(), rate, signed: true });
        }
        let length = r.length();
        let n = r.map(|c| c / length);
        let rate = n.dot(kinematics.resolve(&v, axes, zero));
        Some(Stretch { value: length, square: r.dot(r), rate, signed: false })
    }

    /// A force along the line of two points, by a value or as an input. It pushes them apart where it is
    /// positive.
    pub fn add_force_between(
        &mut self,
        action: &syntax::Action,
        [a, b]: [&syntax::Expr; 2],
        along: Option<&syntax::Expr>,
        value: Option<&syntax::Expr>,
        cx: &mut Diagnostics,
    ) {
        if let Some(along) = along {
            cx.error(along.place.clone(), "a force between two points acts along their line")
                .help("remove this argument, or let a force act on each of two bodies");
        }
        let Some(stretch) = self.distance(a, b, cx) else { return };
        let rate = match stretch.signed {
            true => stretch.value.call(Function::Signum) * stretch.rate,
            false => stretch.rate,
        };
        let g = self.scope.graph;
        let Some(value) = value else {
            self.add_input_load(&action.name.text, rate);
            return;
        };
        let context = Context::new(Allowed::Acceleration, Some((None, Pose::identity(g))));
        if let Some(force) = self.scope.in_context(context, |scope| scope.scalar(value, cx)) {
            self.add_value_load(rate, force, &value.place, cx);
        }
    }

    /// A spring with any law.
    pub fn add_spring(&mut self, stretch: Stretch<'g>, law: &Law, free: Expr<'g>, cx: &mut Diagnostics) {
        let g = self.scope.graph;
        let length =
            if stretch.signed && !free.is_zero() { stretch.value.call(Function::Abs) } else { stretch.value };
        let value = length - free;
        let symbol = Quantity::Given(0).symbol();
        let locals = vec![("stretch", g.symbol(symbol)), ("length", g.symbol(symbol) + free)];
        let context = Context::new(Allowed::Placement, Some((None, Pose::identity(g)))).with_locals(locals);
        let energy = match law {
            // Smooth where the points meet.
            Law::Linear(k) if free.is_zero() => self.scope.scalar(k, cx).map(|k| k * 0.5 * stretch.square),
            Law::Linear(k) => self.scope.scalar(k, cx).map(|k| k * 0.5 * g.symbol(symbol).square()),
            Law::Energy(e) => self.scope.in_context(context, |scope| scope.scalar(e, cx)),
            Law::Force(e) => self.energy_of(e, &context, cx),
        };
        if let Some(energy) = energy {
            self.model.potentials.push(replace(energy, &|s| (s == symbol).then_some(value)));
        }
    }

    /// The energy of a force: that of its pieces, if they are told apart by the stretch or the length.
    fn energy_of(&self, e: &syntax::Expr, context: &Context<'g>, cx: &mut Diagnostics) -> Option<Expr<'g>> {
        let read = |e: &syntax::Expr, cx: &mut Diagnostics| {
            self.scope.in_context(context.clone(), |scope| scope.scalar(e, cx))
        };
        let force = read(e, cx)?;
        let local = |e: &syntax::Expr| {
            context.locals.iter().find(|(name, _)| e.name() == Some(name)).map(|(_, value)| *value)
        };
        if let ExprKind::Call(name, arguments) = &e.kind
            && let [left, right, below, above] = arguments.as_slice()
            && name.id == Some(Callable::If)
        {
            let found = match (local(left), local(right)) {
                (Some(x), None) => Some((x, right, [below, above])),
                (None, Some(x)) => Some((x, left, [above, below])),
                _ => None,
            };
            if let Some((own, border, pieces)) = found {
                let symbol = Quantity::Given(0).symbol();
                let x = self.scope.graph.symbol(symbol);
                let border = read(border, cx)? - (own - x);
                let [below, above] = pieces.map(|piece| self.energy_of(piece, context, cx));
                let with = |energy: Expr<'g>, x| replace(energy, &|s| (s == symbol).then_some(x));
                let (below, above) = (below?, above?);
                let (low, high) = (x.extreme(Extreme::Min, border), x.extreme(Extreme::Max, border));
                return Some(with(below, low) + with(above, high) - with(above, border));
            }
        }
        self.integral(force, e, cx)
    }

    /// The energy of a force that is a polynomial in the stretch: its Taylor series, integrated.
    fn integral(&self, force: Expr<'g>, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Expr<'g>> {
        let g = self.scope.graph;
        let symbol = Quantity::Given(0).symbol();
        let x = g.symbol(symbol);
        let mut d = Derivative::with_respect_to(symbol, g);
        let (mut energy, mut derivative, mut power, mut factorial) = (g.zero(), force, x, 1.0);
        for n in 1..=HIGHEST_POWER + 1 {
            factorial *= n as f64;
            let at_zero = replace(derivative, &|s| (s == symbol).then_some(g.zero()));
            energy += at_zero * (1.0 / factorial) * power;
            power = power * x;
            derivative = d.of(derivative);
            // A law with corners is like a polynomial between them.
            if derivative.is_zero() && !has_corners(force, symbol) {
                return Some(energy);
            }
        }
        cx.error(e.place.clone(), "the energy of this law is not known: it is no polynomial in `stretch`")
            .help("give the spring by its energy instead: `energy = …`, and the force follows, as in `energy = k / 2 * pow(min(stretch, 0), 2)`");
        None
    }

    /// A dashpot with any law.
    pub fn add_dashpot(&mut self, stretch: &Stretch<'g>, law: &Law, cx: &mut Diagnostics) {
        let g = self.scope.graph;
        let force = match law {
            Law::Linear(c) => self.scope.scalar(c, cx).map(|c| c * stretch.rate),
            Law::Force(e) | Law::Energy(e) => {
                let context = Context::new(Allowed::Motion, Some((None, Pose::identity(g))))
                    .with_locals(vec![("speed", stretch.rate)]);
                self.scope.in_context(context, |scope| scope.scalar(e, cx))
            }
        };
        if let Some(force) = force {
            self.model.loads.push(Load { rate: stretch.rate, force: -force, dissipative: true });
        }
    }

    /// An inerter.
    pub fn add_inerter(&mut self, stretch: &Stretch<'g>, inertance: &syntax::Expr, cx: &mut Diagnostics) {
        if let Some(b) = self.scope.scalar(inertance, cx) {
            if let Some(n) = b.value().filter(|n| *n < 0.0) {
                cx.error(inertance.place.clone(), format!("an inertance cannot be negative, but it is {n}"))
                    .help("it resists accelerations as a mass does: write its size");
            }
            self.scope.require(Rule::NotNegative, || "an inertance".to_string(), &[b]);
            self.model.inertances.push(Inertance { rate: stretch.rate, inertance: b });
        }
    }

    /// Dry friction with breakaway (Stribeck), regularised with a hyperbolic tangent, and viscous friction:
    /// `(fc + (fs − fc) exp(−(v / vs)²)) tanh(v / v0) + c v`.
    pub fn add_friction(
        &mut self,
        stretch: &Stretch<'g>,
        [coulomb, stiction, stribeck, viscous, speed]: [Option<&syntax::Expr>; 5],
        place: &Place,
        cx: &mut Diagnostics,
    ) {
        let g = self.scope.graph;
        let mut value = |e: Option<&syntax::Expr>, default: f64| match e {
            Some(e) => self.scope.scalar(e, cx),
            None => Some(g.num(default)),
        };
        let (fc, c, v0) = (value(coulomb, 0.0), value(viscous, 0.0), value(speed, FRICTION_SPEED));
        let (fs, vs) = (stiction.map(|e| value(Some(e), 0.0)), stribeck.map(|e| value(Some(e), 0.0)));
        let mut check =
            |written: Option<&syntax::Expr>, found: Option<Expr<'g>>, positive: bool, what: &str| {
                if let Some(found) = found {
                    let rule = if positive { Rule::Positive } else { Rule::NotNegative };
                    self.scope.require(rule, || format!("a {what} of dry friction"), &[found]);
                }
                let (Some(written), Some(n)) = (written, found.and_then(|e| e.value())) else { return };
                if n < 0.0 || positive && n == 0.0 {
                    let must = if positive { "must be positive" } else { "cannot be negative" };
                    cx.error(written.place.clone(), format!("this {what} {must}, but it is {n}"));
                }
            };
        for (written, found) in [(coulomb, fc), (stiction, fs.flatten()), (viscous, c)] {
            check(written, found, false, "friction");
        }
        for (written, found) in [(stribeck, vs.flatten()), (speed, v0)] {
            check(written, found, true, "speed");
        }
        let (Some(fc), Some(c), Some(v0)) = (fc, c, v0) else { return };
        let v = stretch.rate;
        let dry = match (fs, vs) {
            (None, None) => fc,
            (Some(Some(fs)), Some(Some(vs))) => fc + (fs - fc) * (-(v / vs).square()).call(Function::Exp),
            (Some(None), _) | (_, Some(None)) => return,
            _ => {
                cx.error(place.clone(), "`stiction` and `stribeck_speed` go together")
                    .help("the force falls from `stiction` to `coulomb` at about `stribeck_speed`");
                return;
            }
        };
        let force = dry * (v / v0).call(Function::Tanh) + c * v;
        self.model.loads.push(Load { rate: v, force: -force, dissipative: true });
    }

    /// Attraction `strength / distance²`: potential energy `−strength / distance`. Not finite where the
    /// points meet, as it has no limit there.
    pub fn add_attraction(&mut self, stretch: &Stretch<'g>, strength: Expr<'g>) {
        let distance = stretch.square.sqrt();
        self.model.potentials.push(-(strength / distance));
    }

    /// Gravity towards a point on a body with inertia, to second order in its size over its distance
    /// (MacCullagh): `U = −μ m / r − μ (tr I − 3 n · I n) / (2 r³)`.
    pub fn add_gravity_gradient(
        &mut self,
        body: &Placed<'g>,
        center: &Placed<'g>,
        mu: Expr<'g>,
        index: usize,
    ) {
        let Some((_, _, central)) = self.masses.get(index).cloned().flatten() else { return };
        let tensor = body.pose.rotation.sym_to_parent(central);
        let zero = Vec3::zero(self.scope.graph);
        let kinematics = self.scope.kinematics.borrow();
        let terms = kinematics.between(body, center);
        let r = kinematics.resolve(&terms, body.link, zero);
        drop(kinematics);
        let length = r.norm();
        let n = r.map(|c| c / length);
        let trace = tensor.diagonal[0] + tensor.diagonal[1] + tensor.diagonal[2];
        let shape = trace - n.dot(tensor * n) * 3.0;
        if !shape.is_zero() {
            self.model.potentials.push(-(mu * shape * 0.5 / (length * length * length)));
        }
    }

    /// Potential energies and dissipation functions given as expressions; then the outputs.
    pub fn add_expressions(&mut self, _: Constrained, cx: &mut Diagnostics) {
        let d = self.description;
        let ground = || Some((None, Pose::identity(self.scope.graph)));
        for (name, e) in &d.energies {
            let context = Context::new(Allowed::Placement, ground());
            let energy = self.scope.in_context(context, |scope| scope.scalar(e, cx));
            let before = Counts::of(&self.model);
            self.model.potentials.extend(energy);
            self.know_applied(&before, &name.text);
        }
        for (name, e) in &d.dissipations {
            let context = Context::new(Allowed::Motion, ground());
            let function = self.scope.in_context(context, |scope| scope.scalar(e, cx));
            // Between bodies that are welded together it is zero, which is no mistake.
            if function.is_some_and(|f| !f.is_zero() && velocity_gradient(f).is_empty()) {
                cx.error(e.place.clone(), "this contains no velocity, and has no effect")
                    .help("dissipation is a function of rates, half the power that is lost: `c / 2 * rate(hinge) * rate(hinge)`");
            }
            let before = Counts::of(&self.model);
            self.model.dissipations.extend(function);
            self.know_applied(&before, &name.text);
        }
        self.add_outputs(cx);
        // Definitions that nothing uses are checked all the same.
        for definition in &d.definitions {
            let context = Context::new(Allowed::Reaction, ground());
            let name = ExprKind::Name(definition.name.text.clone());
            let e = syntax::Expr { kind: name, place: definition.name.place.clone() };
            let _ = self.scope.in_context(context, |scope| scope.value(&e, cx));
        }
    }

    /// Sets what the signatures of the generated functions depend on.
    pub fn find_dependencies(&mut self, _: Constrained) {
        let m = &self.model;
        let mut all: Vec<Expr<'g>> = m.potentials.iter().chain(&m.dissipations).copied().collect();
        all.extend(m.loads.iter().flat_map(|l| [l.rate, l.force]));
        all.extend(m.inertances.iter().flat_map(|i| [i.rate, i.inertance]));
        for force in &m.acceleration_forces {
            all.push(force.rate);
            all.extend(force.factors.iter().map(|(_, factor)| *factor));
        }
        all.extend(m.constraints.iter().flat_map(|c| c.residual.into_iter().chain([c.rate])));
        all.extend(m.constraints.iter().flat_map(|c| c.friction.iter().map(|d| d.share)));
        all.extend(m.outputs.iter().flat_map(|o| o.values.iter().copied()));
        all.extend(m.links.iter().flat_map(|link| link.placement.entries()));
        let time = symbols_in(&all).into_iter().any(|s| Quantity::of(s) == Quantity::Time);
        let by_velocity = m.loads.iter().any(|load| {
            let symbols: Vec<Quantity> = symbols_in(&[load.force]).into_iter().map(Quantity::of).collect();
            symbols.iter().any(|q| matches!(q, Quantity::Input(_)))
                && symbols.iter().any(|q| matches!(q, Quantity::Velocity(_)))
        });
        self.model.time = time;
        self.model.velocity_inputs = by_velocity;
    }
}

/// True for a vector that is zero for all coordinates and parameters.
fn always_zero(r: Vec3<'_>) -> bool {
    r.is_zero()
        || (0..4).all(|seed| eval(&r.0, &|s| 2.0 * sample(s, seed) - 1.7).iter().all(|c| c.abs() < 1e-14))
}

/// True if a sign, a magnitude or an extreme of what depends on the symbol is in an expression.
fn has_corners(e: Expr<'_>, symbol: Symbol) -> bool {
    let g = e.graph();
    let mut seen = BTreeSet::from([e.id()]);
    let mut todo = vec![e.id()];
    while let Some(id) = todo.pop() {
        let node = g.node(id);
        let corner = matches!(node, Node::Call(Function::Abs | Function::Signum, _) | Node::Extreme(..));
        if corner && symbols_in(&[g.expr(id)]).contains(&symbol) {
            return true;
        }
        node.operands(|a| {
            if seen.insert(a) {
                todo.push(a);
            }
        });
    }
    false
}

/// The direction of a vector, if it is the same for all coordinates and parameters.
fn constant_direction(r: Vec3<'_>) -> Option<[f64; 3]> {
    let at = |seed| eval(&r.0, &|s| 2.0 * sample(s, seed) - 1.7);
    let first = at(0);
    let norm = first.iter().map(|c| c * c).sum::<f64>().sqrt();
    let e = [first[0] / norm, first[1] / norm, first[2] / norm];
    let parallel = (1..5).all(|seed| {
        let v = at(seed);
        let along: f64 = (0..3).map(|k| v[k] * e[k]).sum();
        let size = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        (0..3).all(|k| (v[k] - along * e[k]).abs() <= 1e-12 * size)
    });
    // The sign of a coordinate direction is positive.
    let flip = e.iter().find(|c| c.abs() > 1e-9).is_some_and(|c| *c < 0.0);
    let snap = |c: f64| {
        if c.abs() < 1e-12 {
            0.0
        } else if (c.abs() - 1.0).abs() < 1e-12 {
            c.signum()
        } else {
            c
        }
    };
    (parallel && norm.is_finite() && norm > 0.0).then(|| e.map(|c| snap(if flip { -c } else { c })))
}
