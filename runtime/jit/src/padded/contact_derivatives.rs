//! Derivatives of robots with contacts that are padded to constant dimensions.

use super::{Padded, PaddedContacts, write_block};
use crate::internal::InternalFunction;
use crate::robot::{Robot, State};
use linkwork::contact::{ContactDerivatives, FirstOrder};
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{ByMotion, Derivatives};
use std::borrow::Borrow;

type Vector<const N: usize> = SVector<f64, N>;
type Square<const N: usize> = SMatrix<f64, N, N>;

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>> Padded<NQ, NV, NU, R> {
    /// Whether the derivatives of the contacts are available.
    pub(super) fn has_contact_derivatives(&self) -> bool {
        self.has_derivatives()
            && self.robot().shared.states.is_empty()
            && self.has_function(InternalFunction::ContactDerivatives)
    }
}

impl<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    R: Borrow<Robot> + Clone,
> Derivatives<NQ, NV, NU> for PaddedContacts<NQ, NV, NU, NK, NR, R>
{
    forward! {
        integrate_derivatives(dv: &Vector<NV>) -> (Square<NV>, Square<NV>);
        tangent_rate_derivatives(dv: &Vector<NV>, v: &Vector<NV>) -> (Square<NV>, Square<NV>);
        integrate_derivatives_at(q: &Vector<NQ>, dv: &Vector<NV>) -> (Square<NV>, Square<NV>);
        displacement_rate_derivatives(q: &Vector<NQ>, dv: &Vector<NV>, v: &Vector<NV>)
            -> ByMotion<f64, NV, NV>;
        turning(q: &Vector<NQ>, v: &Vector<NV>) -> Square<NV>;
        coriolis_matrix(t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> Square<NV>;
        inverse_dynamics_derivatives(t: f64, q: &Vector<NQ>, v: &Vector<NV>, a: &Vector<NV>)
            -> (Square<NV>, Square<NV>);
        forward_dynamics_derivatives(t: f64, q: &Vector<NQ>, v: &Vector<NV>, tau: &Vector<NV>)
            -> ByMotion<f64, NV, NV>;
        generalized_forces_derivatives(t: f64, q: &Vector<NQ>, v: &Vector<NV>, u: &Vector<NU>)
            -> ByMotion<f64, NV, NU>;
        generalized_momentum_derivatives(t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> Square<NV>;
        momentum_rate_derivatives(t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> (Square<NV>, Square<NV>);
    }
}

impl<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    R: Borrow<Robot> + Clone,
> ContactDerivatives<NQ, NV, NU, NK, NR> for PaddedContacts<NQ, NV, NU, NK, NR, R>
{
    fn contact_derivatives(
        &self,
        t: f64,
        q: &Vector<NQ>,
        v: &Vector<NV>,
        a: &Vector<NV>,
        forces: &Vector<NR>,
    ) -> FirstOrder<f64, NV, NR> {
        let (n, rows) = (self.robot().nv(), self.robot().shared.contact_rates);
        let state = State {
            a: &a.as_slice()[..n],
            other: &[&forces.as_slice()[..rows]],
            ..self.plain.state_with_velocity(t, q, v)
        };
        let mut found = vec![0.0; n * (n + 3 * rows)];
        self.plain.call_function(InternalFunction::ContactDerivatives, state, &mut found);
        let (forces, accelerations) = found.split_at(n * n);
        let mut forces_by_q = Square::zeros();
        write_block(&mut forces_by_q, n, forces);
        let padded_contact_matrix = |k: usize| {
            let mut all = SMatrix::<f64, NR, NV>::zeros();
            write_block(&mut all, rows, &accelerations[k * n * rows..(k + 1) * n * rows]);
            all
        };
        let [accelerations_by_q, accelerations_by_v, rates_by_q] = [0, 1, 2].map(padded_contact_matrix);
        FirstOrder { forces_by_q, accelerations_by_q, accelerations_by_v, rates_by_q }
    }
}
