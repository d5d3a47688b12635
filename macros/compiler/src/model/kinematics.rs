//! Kinematics of the links: joint transforms, motion subspaces, velocities. A joint placed by expressions of
//! coordinates and time has a subspace that depends on them, and may move by itself.

use super::{Chart, Coordinate, Inertia, LinkId, Model, Motion, Quantity};
use crate::expr::diff::Derivative;
use crate::expr::eval::needed;
use crate::expr::{Expr, Graph, Node, Rotation, Symbol, Vec3};

/// A spatial vector: linear part, angular part. A twist (velocity of the link's origin, angular velocity), or a wrench
/// (force, moment about the link's origin).
#[derive(Clone, Copy, Debug)]
pub struct Spatial<'g> {
    /// Velocity or force.
    pub linear: Vec3<'g>,
    /// Angular velocity or moment.
    pub angular: Vec3<'g>,
}

impl<'g> Spatial<'g> {
    /// Zero.
    pub fn zero(model: &Model<'g>) -> Spatial<'g> {
        Spatial { linear: Vec3::zero(model.graph), angular: Vec3::zero(model.graph) }
    }

    /// Twist dotted with wrench: a power.
    pub fn dot(&self, other: &Spatial<'g>) -> Expr<'g> {
        self.linear.dot(other.linear) + self.angular.dot(other.angular)
    }

    /// The sum.
    pub fn plus(&self, other: &Spatial<'g>) -> Spatial<'g> {
        Spatial { linear: self.linear + other.linear, angular: self.angular + other.angular }
    }

    /// All components multiplied.
    pub fn times(&self, s: Expr<'g>) -> Spatial<'g> {
        Spatial { linear: self.linear * s, angular: self.angular * s }
    }
}

/// The configuration space, for rates of expressions of the coordinates.
#[derive(Clone, Copy)]
pub struct Space<'a, 'g> {
    /// Owner of the expressions.
    pub graph: &'g Graph,
    /// Its parts.
    pub charts: &'a [Chart],
}

/// Value of a coordinate as an expression of `q`.
pub fn position<'g>(model: &Model<'g>, c: &Coordinate) -> Expr<'g> {
    position_in(model.graph, c)
}

/// Value of a coordinate as an expression of `q`.
pub fn position_in<'g>(g: &'g Graph, c: &Coordinate) -> Expr<'g> {
    Quantity::Configuration(c.q).expr(g) * g.num(c.ratio) + g.num(c.offset)
}

/// Rate of a coordinate as an expression of `v`.
pub fn rate<'g>(model: &Model<'g>, c: &Coordinate) -> Expr<'g> {
    Quantity::Velocity(c.v).expr(model.graph) * model.graph.num(c.ratio)
}

/// One degree of freedom of a joint: a column of its motion subspace, in link axes. It is constant there but for links
/// that are placed by expressions.
#[derive(Clone, Debug)]
pub struct Dof<'g> {
    /// Entry of `v`.
    pub index: usize,
    /// Joint rate per entry of `v`.
    pub ratio: f64,
    /// Twist of the link per unit of joint rate, in link axes.
    pub subspace: Spatial<'g>,
}

/// A link's joint at a configuration: where the link is in its parent, and how it can move.
#[derive(Clone, Debug)]
pub struct Joint<'g> {
    /// Parent link.
    pub parent: Option<LinkId>,
    /// Orientation of the link in the parent link.
    pub rotation: Rotation<'g>,
    /// Origin of the link in the parent link.
    pub translation: Vec3<'g>,
    /// Degrees of freedom, parent side first.
    pub dofs: Vec<Dof<'g>>,
    /// What a link placed by expressions adds.
    pub drift: Option<Drift<'g>>,
    /// How many limbs side by side hang from the parent by this joint, one in each lane of its expressions; one for a
    /// joint that stands for itself.
    pub limbs: usize,
}

/// Motion of a link that its coordinates' rates alone do not give, in link axes.
#[derive(Clone, Debug)]
pub struct Drift<'g> {
    /// Twist at zero rates: the link is driven in time.
    pub twist: Spatial<'g>,
    /// Rate of the components of the joint's twist at constant `v`.
    pub acceleration: Spatial<'g>,
    /// Rate of the components of each degree of freedom's subspace.
    pub subspace_rates: Vec<Spatial<'g>>,
}

impl<'g> Joint<'g> {
    /// A wrench on the link, about the parent's origin in parent axes.
    pub fn wrench_to_parent(&self, w: &Spatial<'g>) -> Spatial<'g> {
        let force = self.rotation.to_parent(w.linear);
        let moment = self.rotation.to_parent(w.angular) + self.translation.cross(force);
        Spatial { linear: force, angular: moment }
    }

    /// The wrench on the parent, given that on the link: the sum of those of limbs side by side.
    pub fn add_wrench(&self, parent: &Spatial<'g>, link: &Spatial<'g>) -> Spatial<'g> {
        let wrench = self.wrench_to_parent(link);
        parent.plus(&map_spatial(&wrench, |c| self.gathered(c)))
    }

    /// The sum over limbs side by side.
    pub fn gathered(&self, e: Expr<'g>) -> Expr<'g> {
        if self.limbs == 1 { e } else { e.lane_sum(self.limbs) }
    }

    /// Mass properties of the parent with those of the link, or of all limbs side by side.
    pub fn composite(&self, parent: &Inertia<'g>, link: &Inertia<'g>) -> Inertia<'g> {
        if self.limbs == 1 {
            return parent.plus_placed(link, &self.rotation, self.translation);
        }
        let alone = Inertia::zero(parent.mass.graph()).plus_placed(link, &self.rotation, self.translation);
        parent.plus(&Inertia {
            mass: self.gathered(alone.mass),
            moment: alone.moment.map(|c| self.gathered(c)),
            tensor: alone.tensor.map(|c| self.gathered(c)),
        })
    }

    /// The parent's twist, at the link's origin in link axes.
    pub fn twist_to_child(&self, parent: &Spatial<'g>) -> Spatial<'g> {
        Spatial {
            linear: self.rotation.to_child(parent.linear + parent.angular.cross(self.translation)),
            angular: self.rotation.to_child(parent.angular),
        }
    }

    /// The joint's own twist for given rates (by entry of `v`).
    pub fn relative(&self, model: &Model<'g>, rates: &[Expr<'g>]) -> Spatial<'g> {
        let mut sum = Spatial::zero(model);
        for dof in &self.dofs {
            sum = sum.plus(&dof.subspace.times(rates[dof.index] * model.graph.num(dof.ratio)));
        }
        sum
    }
}

impl<'g> Joint<'g> {
    /// The joint's twist for rates `v`, what drives it in time included.
    pub fn twist(&self, model: &Model<'g>, v: &[Expr<'g>]) -> Spatial<'g> {
        let relative = self.relative(model, v);
        self.drift.as_ref().map_or(relative, |drift| relative.plus(&drift.twist))
    }
}

/// The joints of all links, at the configuration `q`.
pub fn joints<'g>(model: &Model<'g>) -> Vec<Joint<'g>> {
    model.links.iter().map(|link| joint(model.space(), link)).collect()
}

/// The joint of a link.
pub fn joint<'g>(space: Space<'_, 'g>, link: &super::Link<'g>) -> Joint<'g> {
    let g = space.graph;
    let zero = Vec3::zero(g);
    let q = |k: usize| Quantity::Configuration(k).expr(g);
    let single = |c: &Coordinate, linear, angular| {
        vec![Dof { index: c.v, ratio: c.ratio, subspace: Spatial { linear, angular } }]
    };
    let (motion, shift, dofs) = match &link.motion {
        Motion::Turn { axis, coordinate } => {
            (Rotation::eigenaxis(*axis, position_in(g, coordinate)), zero, single(coordinate, zero, *axis))
        }
        Motion::Slide { axis, coordinate } => {
            (Rotation::identity(g), *axis * position_in(g, coordinate), single(coordinate, *axis, zero))
        }
        Motion::Helix { axis, pitch, coordinate } => {
            let angle = position_in(g, coordinate);
            let shift = *axis * (*pitch * angle);
            (Rotation::eigenaxis(*axis, angle), shift, single(coordinate, *axis * *pitch, *axis))
        }
        Motion::Ball { q: first, v } => {
            let rotation = Rotation::quaternion([q(*first), q(first + 1), q(first + 2), q(first + 3)]);
            let dofs = (0..3).map(|k| unit_dof(g, v + k, None, Some(k))).collect();
            (rotation, zero, dofs)
        }
        Motion::Free { q: first, v } => {
            let rotation = Rotation::quaternion([q(first + 3), q(first + 4), q(first + 5), q(first + 6)]);
            let dofs = (0..6).map(|k| match k {
                0..3 => unit_dof(g, v + k, Some(k), None),
                _ => unit_dof(g, v + k, None, Some(k - 3)),
            });
            (rotation, Vec3([q(*first), q(first + 1), q(first + 2)]), dofs.collect())
        }
        Motion::Placed => return placed_joint(space, link),
    };
    Joint {
        parent: link.parent,
        translation: link.placement.point(shift),
        rotation: link.placement.rotation.clone().then(&motion),
        dofs,
        drift: None,
        limbs: 1,
    }
}

/// The joint of a link whose placement is an expression of coordinates and time: its twist is the rate of the
/// placement, and its subspace what each velocity adds to that.
fn placed_joint<'g>(space: Space<'_, 'g>, link: &super::Link<'g>) -> Joint<'g> {
    let place = &link.placement;
    let twist = rate_of_placement(space, &place.rotation, place.translation);
    let acceleration = map_spatial(&twist, |c| time_derivative(space, c));
    let mut dofs = Vec::new();
    let mut subspace_rates = Vec::new();
    let mut drift = twist;
    for index in velocities_in(&twist) {
        let mut d = Derivative::with_respect_to(Quantity::Velocity(index).symbol(), space.graph);
        let subspace = map_spatial(&twist, |c| d.of(c));
        // The twist is linear in the velocities: what is left when all are taken away is what time does.
        drift = map_spatial(&drift, |c| without(space.graph, c, index));
        subspace_rates.push(map_spatial(&subspace, |c| time_derivative(space, c)));
        dofs.push(Dof { index, ratio: 1.0, subspace });
    }
    Joint {
        parent: link.parent,
        rotation: place.rotation.clone(),
        translation: place.translation,
        dofs,
        drift: Some(Drift { twist: drift, acceleration, subspace_rates }),
        limbs: 1,
    }
}

/// Twist of a frame from the rates of its placement, in the frame's axes: `Rᵀ ṗ`, and `[ω]× = Rᵀ Ṙ`.
pub fn rate_of_placement<'g>(
    space: Space<'_, 'g>,
    rotation: &Rotation<'g>,
    translation: Vec3<'g>,
) -> Spatial<'g> {
    let angular = rotation.angular_velocity(&mut |e| time_derivative(space, e));
    Spatial { linear: rotation.to_child(translation.map(|c| time_derivative(space, c))), angular }
}

/// Every component with a function applied.
pub fn map_spatial<'g>(s: &Spatial<'g>, mut f: impl FnMut(Expr<'g>) -> Expr<'g>) -> Spatial<'g> {
    Spatial { linear: s.linear.map(&mut f), angular: s.angular.map(&mut f) }
}

/// Rate of an expression of `q`, `v` and `t` along the motion, at constant `v`.
pub fn time_derivative<'g>(space: Space<'_, 'g>, e: Expr<'g>) -> Expr<'g> {
    let mut sum = e.zero();
    for symbol in symbols_in(&[e]) {
        let rate = match Quantity::of(symbol) {
            Quantity::Configuration(k) => configuration_rate(space, k),
            Quantity::Time => space.graph.one(),
            _ => continue,
        };
        sum += Derivative::with_respect_to(symbol, space.graph).of(e) * rate;
    }
    sum
}

/// The symbols of expressions, in order.
pub fn symbols_in(e: &[Expr<'_>]) -> Vec<Symbol> {
    let Some(first) = e.first() else { return Vec::new() };
    let graph = first.graph();
    let symbol = |id| match graph.node(id) {
        Node::Symbol(s) => Some(s),
        _ => None,
    };
    let mut symbols: Vec<Symbol> = needed(graph, e).into_iter().filter_map(symbol).collect();
    symbols.sort_unstable();
    symbols
}

fn velocities_in(twist: &Spatial<'_>) -> Vec<usize> {
    let all: Vec<Expr<'_>> = twist.linear.0.iter().chain(&twist.angular.0).copied().collect();
    let index = |s: Symbol| match Quantity::of(s) {
        Quantity::Velocity(k) => Some(k),
        _ => None,
    };
    symbols_in(&all).into_iter().filter_map(index).collect()
}

/// An expression with one velocity set to zero.
fn without<'g>(graph: &'g Graph, e: Expr<'g>, velocity: usize) -> Expr<'g> {
    crate::expr::replace::replace(e, &|s| (s == Quantity::Velocity(velocity).symbol()).then(|| graph.zero()))
}

/// Rate of an entry of `q` as an expression of `q` and `v`: `q̇ = v` for plain coordinates, half of the product of
/// quaternion and angular velocity for a quaternion x y z w, `R v` for the position of a free joint.
pub fn configuration_rate<'g>(space: Space<'_, 'g>, k: usize) -> Expr<'g> {
    let g = space.graph;
    let q = |k: usize| Quantity::Configuration(k).expr(g);
    let v = |k: usize| Quantity::Velocity(k).expr(g);
    for chart in space.charts {
        match *chart {
            Chart::Plain(a, b) if a == k => return v(b),
            Chart::Ball(a, b) if (a..a + 4).contains(&k) => {
                return quaternion_rate(
                    [q(a), q(a + 1), q(a + 2), q(a + 3)],
                    [v(b), v(b + 1), v(b + 2)],
                    k - a,
                );
            }
            Chart::Free(a, b) if (a..a + 7).contains(&k) => {
                let quaternion = [q(a + 3), q(a + 4), q(a + 5), q(a + 6)];
                if k < a + 3 {
                    let linear = Vec3([v(b), v(b + 1), v(b + 2)]);
                    return Rotation::quaternion(quaternion).to_parent(linear)[k - a];
                }
                return quaternion_rate(quaternion, [v(b + 3), v(b + 4), v(b + 5)], k - a - 3);
            }
            _ => {}
        }
    }
    g.zero()
}

fn quaternion_rate<'g>(quaternion: [Expr<'g>; 4], w: [Expr<'g>; 3], entry: usize) -> Expr<'g> {
    let [x, y, z, s] = quaternion;
    let [a, b, c] = w.map(|w| w * 0.5);
    match entry {
        0 => s * a + y * c - z * b,
        1 => s * b + z * a - x * c,
        2 => s * c + x * b - y * a,
        _ => -(x * a + y * b + z * c),
    }
}

fn unit_dof<'g>(g: &'g Graph, index: usize, linear: Option<usize>, angular: Option<usize>) -> Dof<'g> {
    let axis = |k: Option<usize>| k.map_or(Vec3::zero(g), |k| Vec3::axis(g, k));
    Dof { index, ratio: 1.0, subspace: Spatial { linear: axis(linear), angular: axis(angular) } }
}

/// Twists of all links (velocity of the origin, angular velocity; link axes) for rates `v`.
pub fn twists<'g>(model: &Model<'g>, joints: &[Joint<'g>], v: &[Expr<'g>]) -> Vec<Spatial<'g>> {
    let mut twists: Vec<Spatial<'g>> = Vec::with_capacity(joints.len());
    for joint in joints {
        let own = joint.twist(model, v);
        twists.push(match joint.parent {
            None => own,
            Some(p) => joint.twist_to_child(&twists[p.0]).plus(&own),
        });
    }
    twists
}

/// Sum of the generalized forces of springs, dashpots and the like, with the sign of `h`: what resists motion is
/// positive. Without velocity, those of potential energies alone. Where another function computes them, they are given.
pub fn passive_forces<'g>(model: &Model<'g>, with_velocity: bool) -> Vec<Expr<'g>> {
    if let Some(passive) = model.passive.as_ref().filter(|_| with_velocity) {
        return passive.given_forces();
    }
    let g = model.graph;
    let mut h = vec![g.zero(); model.nv()];
    for spring in &model.springs {
        let stretch = position(model, &spring.on) - spring.free;
        h[spring.on.v] += spring.stiffness * stretch * g.num(spring.on.ratio);
    }
    for energy in &model.potentials {
        // ∂U/∂q along the velocities, at a given time: time itself does no work on the coordinates.
        for (k, d) in model.gradients.of_energy(model.space(), *energy) {
            h[k] += d;
        }
    }
    if with_velocity {
        for dashpot in &model.dashpots {
            h[dashpot.on.v] += dashpot.damping * rate(model, &dashpot.on) * g.num(dashpot.on.ratio);
        }
        for dry in &model.frictions {
            let slip = (rate(model, &dry.on) / model.friction_speed).call(crate::expr::Function::Tanh);
            h[dry.on.v] += dry.friction * slip * g.num(dry.on.ratio);
        }
        for function in &model.dissipations {
            for (k, d) in model.gradients.by_velocity(*function) {
                h[k] += d;
            }
        }
        for load in &model.loads {
            let no_input = |s| matches!(Quantity::of(s), Quantity::Input(_)).then(|| g.zero());
            let force = crate::expr::replace::replace(load.force, &no_input);
            for (k, d) in model.gradients.by_velocity(load.rate) {
                h[k] -= force * d;
            }
        }
    }
    h
}

/// Derivatives by all velocities that an expression depends on.
pub fn velocity_gradient(e: Expr<'_>) -> Vec<(usize, Expr<'_>)> {
    velocity_gradients(&[e]).pop().unwrap_or_default()
}

/// The same of several expressions, which share what they have in common.
pub fn velocity_gradients<'g>(all: &[Expr<'g>]) -> Vec<Vec<(usize, Expr<'g>)>> {
    let mut gradients = vec![Vec::new(); all.len()];
    let Some(graph) = all.first().map(|e| e.graph()) else { return gradients };
    let mut wanted: Vec<(Symbol, usize)> = Vec::new();
    for (row, e) in all.iter().enumerate() {
        wanted.extend(symbols_in(&[*e]).into_iter().map(|s| (s, row)));
    }
    wanted.sort_unstable();
    for rows in wanted.chunk_by(|a, b| a.0 == b.0) {
        let Quantity::Velocity(k) = Quantity::of(rows[0].0) else { continue };
        let mut derivative = Derivative::with_respect_to(rows[0].0, graph);
        for (_, row) in rows {
            gradients[*row].push((k, derivative.of(all[*row])));
        }
    }
    gradients
}

/// Components in the axes of `to` of a vector given in the axes of `from`.
pub fn change_axes<'g>(
    joints: &[Joint<'g>],
    mut v: Vec3<'g>,
    mut from: Option<LinkId>,
    to: Option<LinkId>,
) -> Vec3<'g> {
    // Parents have smaller indices, so the deeper of two links is the one with the larger index.
    let mut down: Vec<LinkId> = Vec::new();
    let mut at = to;
    while from != at {
        match (from, at) {
            (Some(f), a) if a.is_none_or(|a| f > a) => {
                v = joints[f.0].rotation.to_parent(v);
                from = joints[f.0].parent;
            }
            (_, Some(a)) => {
                down.push(a);
                at = joints[a.0].parent;
            }
            _ => break,
        }
    }
    down.iter().rev().fold(v, |v, link| joints[link.0].rotation.to_child(v))
}

/// Accelerations of all links (of the origin, angular; relative to the ground; link axes) for rates `v` and their
/// derivatives `a`.
pub fn accelerations<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    twists: &[Spatial<'g>],
    v: &[Expr<'g>],
    a: &[Expr<'g>],
) -> Vec<Spatial<'g>> {
    let mut all: Vec<Spatial<'g>> = Vec::with_capacity(joints.len());
    for joint in joints {
        let parent = joint.parent.map(|p| (twists[p.0], all[p.0]));
        all.push(joint.acceleration(model, parent.as_ref().map(|(t, a)| (t, a)), v, a));
    }
    all
}

impl<'g> Joint<'g> {
    /// The link's acceleration from its parent's twist and acceleration (none for the ground).
    pub fn acceleration(
        &self,
        model: &Model<'g>,
        parent: Option<(&Spatial<'g>, &Spatial<'g>)>,
        v: &[Expr<'g>],
        a: &[Expr<'g>],
    ) -> Spatial<'g> {
        let (rate, mut own) = (self.twist(model, v), self.relative(model, a));
        if let Some(drift) = &self.drift {
            own = own.plus(&drift.acceleration);
        }
        let turning = rate.angular.cross(rate.linear);
        let Some((twist, parent)) = parent else {
            return Spatial { linear: own.linear + turning, angular: own.angular };
        };
        let w = self.rotation.to_child(twist.angular);
        let p = self.translation;
        let carried = parent.linear + parent.angular.cross(p) + twist.angular.cross(twist.angular.cross(p));
        Spatial {
            linear: self.rotation.to_child(carried) + (w + w).cross(rate.linear) + turning + own.linear,
            angular: self.rotation.to_child(parent.angular) + w.cross(rate.angular) + own.angular,
        }
    }
}
