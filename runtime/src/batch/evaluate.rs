//! Functions of a mechanism for many states, from arrays to arrays.

use super::columns::{AlignedLanes, InputColumns, OutputColumns, count_states_in_first_argument};
use super::{Batch, Error, Lanewise};
use crate::{Lanes, Mechanism};
use nalgebra::SMatrix;

/// Defines the batch method of each listed function, from the names and lengths of its arguments and result.
macro_rules! evaluations {
    ($(
        $(#[$doc:meta])*
        $name:ident = $function:ident[$($time:ident)?]($first:ident: $first_of:ident $(, $argument:ident: $of:ident)*)
            -> $result:ident: $rows:tt x $columns:tt, $turn:expr;
    )+) => {$(
        $(#[$doc])*
        pub fn $name<const NQ: usize, const NV: usize, const NU: usize>(
            &self,
            $($time: M::Scalar,)?
            $first: &[M::Scalar],
            $($argument: &[M::Scalar],)*
            $result: &mut [M::Scalar],
        ) -> Result<(), Error>
        where
            M: Batch<NQ, NV, NU>,
        {
            let count = count_states_in_first_argument($first.len(), $first_of);
            let $first = InputColumns::<_, $first_of>::new(stringify!($first), $first, count)?;
            $(let $argument = InputColumns::<_, $of>::new(stringify!($argument), $argument, count)?;)*
            let mut to =
                OutputColumns::<_, { $rows }, { $columns }>::new(stringify!($result), $result, count)?;
            for state in (0..count).step_by(L.max(1)) {
                let $first = $first.load_states::<L>(state);
                $(let $argument = $argument.load_states::<L>(state);)*
                let values = AlignedLanes($turn(Mechanism::$function(
                    self, $(Lanes::splat($time),)? &$first.0 $(, &$argument.0)*
                )));
                to.store_lanes(state, &values.0);
            }
            Ok(())
        }
    )+};
}

/// Evaluation of many states, `L` at a time, from and to slices of the caller. Entry `i` of state `k` of
/// `count` is at index `i * count + k` (structure of arrays; matrices column by column). The length of the
/// first argument determines the number of states. Shapes, units and frames are as in [`Mechanism`]; `t` is
/// the same for all states. Results do not depend on `L` or on the number of states; the functions allocate
/// no memory.
///
/// # Errors
///
/// [`Error::Length`] for a slice of the wrong length; nothing is written then.
impl<M, const L: usize> Lanewise<'_, M, L> {
    evaluations! {
        /// Computes configurations `q ⊕ dv` for many states ([`Mechanism::integrate`]).
        integrate_all = integrate[](q: NQ, dv: NV) -> result: NQ x 1, unchanged_matrix;
        /// Computes mass matrices ([`Mechanism::mass_matrix`]), `NV²` entries: (i, j) is entry `j NV + i`.
        mass_matrix_all = mass_matrix[t](q: NQ) -> mass: NV x NV, unchanged_matrix;
        /// Computes bias forces for many states ([`Mechanism::bias_forces`]).
        bias_forces_all = bias_forces[t](q: NQ, v: NV) -> h: NV x 1, unchanged_matrix;
        /// Computes inverse dynamics for many states ([`Mechanism::inverse_dynamics`]).
        inverse_dynamics_all = inverse_dynamics[t](q: NQ, v: NV, a: NV) -> tau: NV x 1, unchanged_matrix;
        /// Computes forward dynamics for many states ([`Mechanism::forward_dynamics`]).
        forward_dynamics_all = forward_dynamics[t](q: NQ, v: NV, tau: NV) -> a: NV x 1, unchanged_matrix;
        /// Computes generalized forces of inputs for many states ([`Mechanism::generalized_forces`]).
        generalized_forces_all = generalized_forces[t](q: NQ, v: NV, u: NU) -> tau: NV x 1, unchanged_matrix;
        /// Computes kinetic energies for many states ([`Mechanism::kinetic_energy`]), one number per state.
        kinetic_energy_all = kinetic_energy[t](q: NQ, v: NV) -> energy: 1 x 1, scalar_as_matrix;
        /// Computes potential energies for many states ([`Mechanism::potential_energy`]), one number per
        /// state.
        potential_energy_all = potential_energy[t](q: NQ) -> energy: 1 x 1, scalar_as_matrix;
    }
}

#[inline(always)]
fn unchanged_matrix<T>(values: T) -> T {
    values
}

#[inline(always)]
fn scalar_as_matrix<T: crate::Real, const L: usize>(value: Lanes<T, L>) -> SMatrix<Lanes<T, L>, 1, 1> {
    SMatrix::from_element(value)
}
