//! Time derivatives of expressions along the motion, and derivatives with respect to the velocities.

use crate::expr::diff::DirectionalDerivative;
use crate::expr::replace::symbols_in;
use crate::expr::{Expr, Graph, Rotation, Symbol, Vec3};
use crate::mechanism::{Chart, ConfigurationSpace, Coordinate, InQ, InV, Model, Quantity, VelocityGradient};
use std::collections::BTreeMap;

/// Returns the value of a coordinate as an expression of `q`, in the graph of the model.
pub fn coordinate_in_terms_of_q<'g>(model: &Model<'g>, c: &Coordinate) -> Expr<'g> {
    coordinate_as_expression(model.graph, c)
}

/// Returns the value of a coordinate as an expression of `q`, in the given graph.
pub fn coordinate_as_expression<'g>(g: &'g Graph, c: &Coordinate) -> Expr<'g> {
    c.q.expr(g) * g.num(c.ratio) + g.num(c.offset)
}

/// Returns the velocity of a coordinate as an expression of `v`.
pub fn coordinate_velocity<'g>(model: &Model<'g>, c: &Coordinate) -> Expr<'g> {
    c.v.expr(model.graph) * model.graph.num(c.ratio)
}

/// Returns the time derivative of an expression of `q`, `v` and `t` along the motion, at constant `v`.
pub fn time_derivative<'g>(space: ConfigurationSpace<'_, 'g>, e: Expr<'g>) -> Expr<'g> {
    time_derivative_from_partials(space, e, |symbol| {
        DirectionalDerivative::with_respect_to(symbol, space.graph).differentiate(e)
    })
}

/// Returns the time derivatives of expressions of `q`, `v` and `t` along the motion, with accelerations or at
/// constant velocities. All symbols vary at once, so common subexpressions are differentiated once instead of
/// once per symbol.
pub fn time_derivatives_along_motion<'g>(
    space: ConfigurationSpace<'_, 'g>,
    e: &[Expr<'g>],
    accelerated: bool,
) -> Vec<Expr<'g>> {
    let g = space.graph;
    let rate_of_symbol = |symbol: Symbol| match Quantity::from_symbol(symbol) {
        Quantity::Configuration(k) => Some(configuration_rate(space, k)),
        Quantity::Velocity(k) if accelerated => Some(Quantity::Acceleration(k).expr(g)),
        Quantity::Time => Some(g.one()),
        _ => None,
    };
    let seeds =
        symbols_in(e).into_iter().filter_map(|symbol| rate_of_symbol(symbol).map(|rate| (symbol, rate)));
    let mut along = DirectionalDerivative::differentiation_with_rates(seeds.collect(), g)
        .with_preset_derivatives(rotation_entries_with_rates(space));
    e.iter().map(|e| along.differentiate(*e)).collect()
}

/// Returns the entries of the rotation matrices of ball and free joints, each with its time derivative by
/// `Ṙ = R [ω]×`. The derivative consists of other entries times angular velocities, whereas the derivatives
/// of the quaternion's components would have to be multiplied out.
pub fn rotation_entries_with_rates<'g>(space: ConfigurationSpace<'_, 'g>) -> Vec<(Expr<'g>, Expr<'g>)> {
    let g = space.graph;
    let mut all = Vec::new();
    for chart in space.charts {
        let (first, v) = match *chart {
            Chart::Plain(..) => continue,
            Chart::Ball(a, b) => (a, b),
            Chart::Free(a, b) => (a + 3, b + 3),
        };
        let quaternion = [0, 1, 2, 3].map(|k| (first + k).expr(g));
        let axes = [0, 1, 2].map(|k| {
            let unit = [0, 1, 2].map(|i| if i == k { g.one() } else { g.zero() });
            Rotation::from_quaternion(quaternion).vector_in_parent_axes(Vec3(unit))
        });
        let w = [0, 1, 2].map(|k| joint_velocity(space, v + k));
        for k in 0..3 {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            let component_of_rotation_rate = |i: usize| axes[next][i] * w[last] - axes[last][i] * w[next];
            all.extend((0..3).map(|i| (axes[k][i], component_of_rotation_rate(i))));
        }
    }
    all
}

/// Returns a joint velocity, expressed in generalized speeds if these are declared.
fn joint_velocity<'g>(space: ConfigurationSpace<'_, 'g>, index: InV) -> Expr<'g> {
    match space.speeds {
        None => index.expr(space.graph),
        Some(speeds) => speeds.joint_velocity(space.graph, index),
    }
}

/// Derivatives with respect to single symbols, cached across expressions. The positions of a chain contain
/// the positions of their predecessors, and to differentiate each of them by each coordinate without a cache
/// would take a number of operations that is cubic in the length of the chain.
#[derive(Default)]
pub struct CachedDerivatives<'g>(BTreeMap<Symbol, DirectionalDerivative<'g>>);

impl<'g> CachedDerivatives<'g> {
    /// Returns the derivative of an expression with respect to a symbol.
    pub fn derivative(&mut self, symbol: Symbol, e: Expr<'g>) -> Expr<'g> {
        let new_partial_derivative = || DirectionalDerivative::with_respect_to(symbol, e.graph());
        self.0.entry(symbol).or_insert_with(new_partial_derivative).differentiate(e)
    }

    /// Returns the time derivative of an expression along the motion, at constant `v`.
    pub fn time_derivative(&mut self, space: ConfigurationSpace<'_, 'g>, e: Expr<'g>) -> Expr<'g> {
        time_derivative_from_partials(space, e, |symbol| self.derivative(symbol, e))
    }
}

fn time_derivative_from_partials<'g>(
    space: ConfigurationSpace<'_, 'g>,
    e: Expr<'g>,
    mut partial: impl FnMut(Symbol) -> Expr<'g>,
) -> Expr<'g> {
    let mut sum = e.zero();
    for symbol in symbols_in(&[e]) {
        let rate = match Quantity::from_symbol(symbol) {
            Quantity::Configuration(k) => configuration_rate(space, k),
            Quantity::Time => space.graph.one(),
            _ => continue,
        };
        sum += partial(symbol) * rate;
    }
    sum
}

/// Returns the time derivative of an entry of `q` as an expression of `q` and `v`: `q̇ = v` for plain
/// coordinates, half of the product of quaternion and angular velocity for a quaternion x y z w, `R v` for
/// the position of a free joint. With declared generalized speeds, the joint velocities are `Z(q)` times the
/// entries of `v`.
pub fn configuration_rate<'g>(space: ConfigurationSpace<'_, 'g>, k: usize) -> Expr<'g> {
    let g = space.graph;
    let velocity_component = |index: InV| joint_velocity(space, index);
    let quaternion_components = |first: InQ| [0, 1, 2, 3].map(|k| (first + k).expr(g));
    let three_velocity_components = |first: InV| [0, 1, 2].map(|k| velocity_component(first + k));
    for chart in space.charts {
        match *chart {
            Chart::Plain(a, b) if a.0 == k => return velocity_component(b),
            Chart::Ball(a, b) if a.range_of_entries(4).contains(&k) => {
                return quaternion_rate_entry(
                    quaternion_components(a),
                    three_velocity_components(b),
                    k - a.0,
                );
            }
            Chart::Free(a, b) if a.range_of_entries(7).contains(&k) => {
                let quaternion = quaternion_components(a + 3);
                return match k - a.0 {
                    position @ 0..3 => Rotation::from_quaternion(quaternion)
                        .vector_in_parent_axes(Vec3(three_velocity_components(b)))[position],
                    component => {
                        quaternion_rate_entry(quaternion, three_velocity_components(b + 3), component - 3)
                    }
                };
            }
            _ => {}
        }
    }
    g.zero()
}

fn quaternion_rate_entry<'g>(quaternion: [Expr<'g>; 4], w: [Expr<'g>; 3], entry: usize) -> Expr<'g> {
    let [x, y, z, s] = quaternion;
    let [a, b, c] = w.map(|w| w * 0.5);
    match entry {
        0 => s * a + y * c - z * b,
        1 => s * b + z * a - x * c,
        2 => s * c + x * b - y * a,
        _ => -(x * a + y * b + z * c),
    }
}

/// Returns the derivatives with respect to all velocities that an expression depends on, with the velocities'
/// indices.
pub fn velocity_gradient(e: Expr<'_>) -> Vec<(usize, Expr<'_>)> {
    velocity_gradients(&[e]).pop().unwrap_or_default()
}

/// Returns the derivatives of several expressions with respect to the velocities, with the velocities'
/// indices. Common subexpressions are differentiated once.
pub fn velocity_gradients<'g>(all: &[Expr<'g>]) -> Vec<Vec<(usize, Expr<'g>)>> {
    let mut gradients = vec![Vec::new(); all.len()];
    let Some(graph) = all.first().map(|e| e.graph()) else { return gradients };
    let mut wanted: Vec<(Symbol, usize)> = Vec::new();
    for (row, e) in all.iter().enumerate() {
        wanted.extend(symbols_in(&[*e]).into_iter().map(|s| (s, row)));
    }
    wanted.sort_unstable();
    for rows in wanted.chunk_by(|a, b| a.0 == b.0) {
        let Quantity::Velocity(k) = Quantity::from_symbol(rows[0].0) else { continue };
        let mut derivative = DirectionalDerivative::with_respect_to(rows[0].0, graph);
        for (_, row) in rows {
            gradients[*row].push((k, derivative.differentiate(all[*row])));
        }
    }
    gradients
}

/// Returns the generalized forces that oppose an energy: the derivatives of its time derivative with respect
/// to the velocities, at constant time.
pub fn generalized_force_opposing_energy<'g>(model: &Model<'g>, energy: Expr<'g>) -> VelocityGradient<'g> {
    let velocity_gradient_of_energy_rate =
        || velocity_gradient(time_derivative(model.configuration_space(), energy));
    model.gradients.cached_energy_gradient(&model.charts, energy, velocity_gradient_of_energy_rate)
}

/// Returns the derivatives of an expression with respect to all velocities from the model's cache.
pub fn cached_velocity_gradient<'g>(model: &Model<'g>, e: Expr<'g>) -> VelocityGradient<'g> {
    model.gradients.cached_velocity_derivatives(e, || velocity_gradient(e))
}
