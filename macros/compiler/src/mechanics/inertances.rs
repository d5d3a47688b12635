//! Inerters: the kinetic energy `½ b ṡ²` of a velocity `ṡ = J v + …` adds `b Jᵀ J` to `M` and
//! `b Jᵀ (J a + J̇ v)` to the forces (Smith 2002).

use super::crba::Matrix;
use crate::expr::Expr;
use crate::kinematics::{time_derivative, velocity_gradient};
use crate::mechanism::Model;

/// Adds the contributions of inerters to the mass matrix.
pub fn add_inertances_to_mass_matrix<'g>(model: &Model<'g>, m: &mut Matrix<'g>) {
    for element in &model.inertances {
        let gradient = velocity_gradient(element.rate);
        for (i, d) in &gradient {
            for (j, e) in &gradient {
                m[*i][*j] += element.inertance * (*d * *e);
            }
        }
    }
}

/// Adds the forces of the inertances to `tau`: the velocity terms, and the acceleration terms if `a` is
/// given.
pub fn add_inerter_forces<'g>(model: &Model<'g>, a: Option<&[Expr<'g>]>, tau: &mut [Expr<'g>]) {
    for element in &model.inertances {
        let gradient = velocity_gradient(element.rate);
        let mut acceleration = time_derivative(model.configuration_space(), element.rate);
        for (k, d) in &gradient {
            if let Some(a) = a {
                acceleration += *d * a[*k];
            }
        }
        let force = element.inertance * acceleration;
        for (k, d) in gradient {
            tau[k] += force * d;
        }
    }
}

/// Returns the kinetic energy of the inerters, `½ b (J v)²` for each.
pub fn kinetic_energy<'g>(model: &Model<'g>) -> Expr<'g> {
    model.inertances.iter().fold(model.graph.zero(), |sum, e| sum + e.inertance * 0.5 * e.rate.square())
}

/// Adds the generalized momentum of the inerters to a momentum.
pub fn add_inerter_momentum<'g>(model: &Model<'g>, p: &mut [Expr<'g>]) {
    for element in &model.inertances {
        for (k, d) in velocity_gradient(element.rate) {
            p[k] += element.inertance * element.rate * d;
        }
    }
}

/// Adds the velocity term of the inerters to the rate of the momentum: `b ṡ J̇ᵀ`.
pub fn add_inerter_momentum_rate<'g>(model: &Model<'g>, rate: &mut [Expr<'g>]) {
    for element in &model.inertances {
        for (k, d) in velocity_gradient(element.rate) {
            rate[k] += element.inertance * element.rate * time_derivative(model.configuration_space(), d);
        }
    }
}
