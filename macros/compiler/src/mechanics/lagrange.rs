//! Lagrange's equations from the energies by differentiation. The derivation is independent of the recursive
//! algorithms and verifies them; it is also the source of the printed equations of small mechanisms.
//! Positions and orientations of all bodies are expanded in the ground frame, and velocities are their time
//! derivatives. The method is unsuitable for large mechanisms, since it shares no subexpressions between
//! bodies.
//!
//! For ball and free joints the velocities are quasi-velocities, and Lagrange's equations take the form of
//! Boltzmann and Hamel (Whittaker, *Analytical Dynamics*, § 30): the momenta of a free joint `(P, L)` gain
//! `w × P` and `w × L + v × P`.

use super::crba::Matrix;
use super::velocity_symbols;
use crate::expr::diff::DirectionalDerivative;
use crate::expr::{Expr, Mat3, Vec3};
use crate::kinematics::{Joint, configuration_rate, coordinate_in_terms_of_q};
use crate::mechanics::passive::passive_forces;
use crate::mechanism::{Chart, InV, Model, Quantity};

/// The energies and the equations of motion derived from them.
pub struct LagrangeEquations<'g> {
    /// Kinetic energy of the mechanism.
    pub kinetic: Expr<'g>,
    /// Potential energy of the mechanism.
    pub potential: Expr<'g>,
    /// Mass matrix `∂²T/∂v²`.
    pub mass_matrix: Matrix<'g>,
    /// Bias forces `h(q, v)` of `M v̇ + h = τ`.
    pub bias: Vec<Expr<'g>>,
}

/// Returns the time derivative of every entry of `q`, as an expression of `q` and `v`.
pub fn configuration_rates<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    (0..model.nq()).map(|k| configuration_rate(model.configuration_space(), k)).collect()
}

/// Derives Lagrange's equations in closed form by differentiating the energies.
pub fn derive<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> LagrangeEquations<'g> {
    let g = model.graph;
    let v = velocity_symbols(model);
    let rates = configuration_rates(model);
    let mut by_q: Vec<DirectionalDerivative<'g>> = (0..model.nq())
        .map(|k| DirectionalDerivative::with_respect_to(Quantity::Configuration(k).symbol(), g))
        .collect();
    let mut by_v: Vec<DirectionalDerivative<'g>> = (0..model.nv())
        .map(|k| DirectionalDerivative::with_respect_to(Quantity::Velocity(k).symbol(), g))
        .collect();
    let (kinetic, potential) = kinetic_and_potential_energy(model, joints, &rates, &mut by_q);
    let momenta: Vec<Expr<'g>> = by_v.iter_mut().map(|d| d.differentiate(kinetic)).collect();
    let mass_matrix: Matrix<'g> =
        momenta.iter().map(|p| by_v.iter_mut().map(|d| d.differentiate(*p)).collect()).collect();
    let lagrangian = kinetic - potential;
    let dl_dq: Vec<Expr<'g>> = by_q.iter_mut().map(|d| d.differentiate(lagrangian)).collect();
    // d/dt ∂T/∂v at constant v: the derivative along the motion.
    let mut bias: Vec<Expr<'g>> = momenta.iter().map(|p| time_derivative(&rates, &mut by_q, *p)).collect();
    subtract_tangent_gradient(&rates, &dl_dq, &mut by_v, &mut bias);
    add_commutators(model, &momenta, &v, &mut bias);
    for (bias, passive) in bias.iter_mut().zip(dissipative_forces(model)) {
        *bias += passive;
    }
    LagrangeEquations { kinetic, potential, mass_matrix, bias }
}

/// Returns the time derivative `Σ ∂e/∂q q̇ + ∂e/∂t` of an expression.
fn time_derivative<'g>(rates: &[Expr<'g>], by_q: &mut [DirectionalDerivative<'g>], e: Expr<'g>) -> Expr<'g> {
    let mut sum = DirectionalDerivative::with_respect_to(Quantity::Time.symbol(), e.graph()).differentiate(e);
    for (rate, d) in rates.iter().zip(by_q) {
        sum += d.differentiate(e) * *rate;
    }
    sum
}

/// Subtracts the generalized forces `∂L/∂q`, taken along the directions `∂q̇/∂v` of the velocities, from the
/// bias.
fn subtract_tangent_gradient<'g>(
    rates: &[Expr<'g>],
    dl_dq: &[Expr<'g>],
    by_v: &mut [DirectionalDerivative<'g>],
    bias: &mut [Expr<'g>],
) {
    for (k, d) in by_v.iter_mut().enumerate() {
        for (rate, dl) in rates.iter().zip(dl_dq) {
            bias[k] -= d.differentiate(*rate) * *dl;
        }
    }
}

fn add_commutators<'g>(model: &Model<'g>, p: &[Expr<'g>], v: &[Expr<'g>], bias: &mut [Expr<'g>]) {
    let three_components = |e: &[Expr<'g>], k: usize| Vec3([e[k], e[k + 1], e[k + 2]]);
    let mut add_to_bias = |k: usize, term: Vec3<'g>| {
        for i in 0..3 {
            bias[k + i] += term[i];
        }
    };
    for chart in &model.charts {
        match *chart {
            Chart::Plain(..) => {}
            Chart::Ball(_, InV(k)) => add_to_bias(k, three_components(v, k).cross(three_components(p, k))),
            Chart::Free(_, InV(k)) => {
                let (linear, w) = (three_components(v, k), three_components(v, k + 3));
                add_to_bias(k, w.cross(three_components(p, k)));
                add_to_bias(
                    k + 3,
                    w.cross(three_components(p, k + 3)) + linear.cross(three_components(p, k)),
                );
            }
        }
    }
}

/// Returns the forces of dashpots and friction. Springs are included in the potential energy.
fn dissipative_forces<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    let all = passive_forces(model, true);
    let springs = passive_forces(model, false);
    all.into_iter().zip(springs).map(|(all, springs)| all - springs).collect()
}

/// Returns the kinetic and potential energy from positions and orientations in the ground frame.
fn kinetic_and_potential_energy<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    rates: &[Expr<'g>],
    by_q: &mut [DirectionalDerivative<'g>],
) -> (Expr<'g>, Expr<'g>) {
    let g = model.graph;
    let mut frames: Vec<(Mat3<'g>, Vec3<'g>)> = Vec::new();
    let (mut kinetic, mut potential) = (g.zero(), g.zero());
    for (joint, link) in joints.iter().zip(&model.links) {
        let (r_parent, p_parent) = joint.parent.map_or((Mat3::identity(g), Vec3::zero(g)), |p| frames[p.0]);
        let r = r_parent * joint.rotation.rotation_matrix();
        let p = p_parent + r_parent * joint.translation;
        frames.push((r, p));
        let inertia = &link.inertia;
        // Columns of the rotation's rate give the angular velocity in link axes: [w]× = Rᵀ Ṙ.
        let r_rate = Mat3::from_fn(|i, j| time_derivative(rates, by_q, r.0[i][j]));
        let p_rate = p.map(|c| time_derivative(rates, by_q, c));
        let w = Vec3([
            r.column(2).dot(r_rate.column(1)),
            r.column(0).dot(r_rate.column(2)),
            r.column(1).dot(r_rate.column(0)),
        ]);
        let moment_rate = r_rate * inertia.moment;
        kinetic += inertia.mass * 0.5 * p_rate.dot(p_rate)
            + p_rate.dot(moment_rate)
            + w.dot(inertia.tensor * w) * 0.5;
        potential -= model.gravity.dot(p * inertia.mass + r * inertia.moment);
    }
    for spring in &model.springs {
        let stretch = coordinate_in_terms_of_q(model, &spring.on) - spring.free;
        potential += spring.stiffness * 0.5 * stretch.square();
    }
    for energy in &model.potentials {
        potential += *energy;
    }
    kinetic += super::inertances::kinetic_energy(model);
    (kinetic, potential)
}
