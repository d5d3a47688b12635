//! Dynamics of a mechanism with its alike limbs as lanes: the algorithms as they are, between gathering the state and
//! scattering the results.

use crate::expr::Expr;
use crate::mechanics::derivatives::{ForceDerivatives, analytic, symbolic};
use crate::mechanics::{aba, crba, rnea};
use crate::model::{Model, Quantity};
use crate::passes::limbs::Limbs;

/// The mass matrix, by rows.
pub fn mass_matrix<'g>(limbs: &Limbs<'g>) -> Vec<Expr<'g>> {
    limbs.scattered_matrix(&crba::mass_matrix(&limbs.model, &limbs.joints))
}

/// Inverse dynamics, or the bias alone.
pub fn inverse_dynamics<'g>(limbs: &Limbs<'g>, accelerations: bool) -> Vec<Expr<'g>> {
    let v = limbs.symbols(Quantity::Velocity);
    let a = accelerations.then(|| limbs.symbols(Quantity::Acceleration));
    let tau = rnea::inverse_dynamics(&limbs.model, &limbs.joints, &v, a.as_deref());
    let whole: Vec<Expr<'g>> = tau.iter().zip(limbs.resistance()).map(|(t, h)| *t + *h).collect();
    limbs.scattered(&whole)
}

/// Forward dynamics by articulated bodies, with the forces that the motion needs from another form. `None` for a
/// mechanism with coupled coordinates.
pub fn forward_dynamics<'g>(limbs: &Limbs<'g>, bias: &Limbs<'g>) -> Option<Vec<Expr<'g>>> {
    let v = limbs.symbols(Quantity::Velocity);
    let wrenches = rnea::wrenches(&bias.model, &bias.joints, &v, None);
    let tau = limbs.symbols(Quantity::Force);
    let r: Vec<Expr<'g>> = tau.iter().zip(limbs.resistance()).map(|(t, h)| *t - *h).collect();
    let a = aba::forward_dynamics(&limbs.model, &limbs.joints, wrenches, &r)?;
    Some(limbs.scattered(&a))
}

/// Derivatives of inverse dynamics by the recursion, those of springs and the like taken from the whole mechanism.
pub fn inverse_dynamics_derivatives<'g>(limbs: &Limbs<'g>, whole: &Model<'g>) -> ForceDerivatives<'g> {
    let v = limbs.symbols(Quantity::Velocity);
    let a = limbs.symbols(Quantity::Acceleration);
    let found = analytic::inverse_dynamics(&limbs.model, &limbs.joints, &v, &a);
    let [by_q, by_v] = [found.by_q, found.by_v].map(|m| limbs.scattered_matrix(&m));
    let rows = |m: Vec<Expr<'g>>| m.chunks(whole.nv().max(1)).map(<[Expr<'g>]>::to_vec).collect();
    let mut scattered = ForceDerivatives { by_q: rows(by_q), by_v: rows(by_v) };
    symbolic::add_resistance(whole, &mut scattered);
    scattered
}
