//! Inerters: kinetic energy `½ b ṡ²` of a rate `ṡ = J v + …`, so `M` gains `b Jᵀ J` and the forces `b Jᵀ (J a + J̇ v)`
//! (Smith 2002).

use super::crba::Matrix;
use crate::expr::Expr;
use crate::kinematics::{time_derivative, velocity_gradient};
use crate::mechanism::Model;

/// Adds them to the mass matrix.
pub fn add_to_mass_matrix<'g>(model: &Model<'g>, m: &mut Matrix<'g>) {
    for element in &model.inertances {
        let gradient = velocity_gradient(element.rate);
        for (i, d) in &gradient {
            for (j, e) in &gradient {
                m[*i][*j] += element.inertance * (*d * *e);
            }
        }
    }
}

/// Adds them to forces: those of the accelerations `a` if given, and those of the motion.
pub fn add_to_forces<'g>(model: &Model<'g>, a: Option<&[Expr<'g>]>, tau: &mut [Expr<'g>]) {
    for element in &model.inertances {
        let gradient = velocity_gradient(element.rate);
        let mut acceleration = time_derivative(model.space(), element.rate);
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

/// Their kinetic energy.
pub fn kinetic_energy<'g>(model: &Model<'g>) -> Expr<'g> {
    model.inertances.iter().fold(model.graph.zero(), |sum, e| sum + e.inertance * 0.5 * e.rate.square())
}

/// Adds their generalized momentum.
pub fn add_to_momentum<'g>(model: &Model<'g>, p: &mut [Expr<'g>]) {
    for element in &model.inertances {
        for (k, d) in velocity_gradient(element.rate) {
            p[k] += element.inertance * element.rate * d;
        }
    }
}

/// Adds what they contribute to the rate of the momentum beside the acceleration: `b ṡ J̇ᵀ`.
pub fn add_to_momentum_rate<'g>(model: &Model<'g>, rate: &mut [Expr<'g>]) {
    for element in &model.inertances {
        for (k, d) in velocity_gradient(element.rate) {
            rate[k] += element.inertance * element.rate * time_derivative(model.space(), d);
        }
    }
}
