//! Extended mechanism, whose velocity vector `[v, x]` also contains its first-order states `x`.

use super::FirstOrder;
use crate::constraint::{ConstraintError, Projected};
use crate::contact::{Assumed, Touched};
use crate::derivatives::ByMotion;
use crate::integrate::{Features, Hooks};
use crate::private::put_block;
use crate::{Mechanism, Real};
use nalgebra::{SMatrix, SVector};

/// Mechanism with its first-order states among its velocities ([`FirstOrder::extended`]): `v` is `[v, x]`.
///
/// A state is a velocity without a coordinate: it has no entry in `q`, and `q ⊕ dv` does not depend on its
/// displacement. Its diagonal entry of the mass matrix is one, and its bias force is its negative rate
/// without inputs. `M v̇ + h = τ`, the inverse of this equation and their derivatives are valid as for any
/// mechanism. Energies are those of the mechanism alone. The number of states is
/// [`FIRST_ORDER`](crate::integrate::Hooks::FIRST_ORDER).
#[derive(Clone, Copy, Debug)]
pub struct Extended<'m, M, const NV: usize, const NX: usize, const NE: usize> {
    pub(super) mechanism: &'m M,
}

/// Splits the extended velocity vector `[v, x]` into velocities `v` and first-order states `x`.
pub fn split<T: Real, const NV: usize, const NX: usize, const NE: usize>(
    all: &SVector<T, NE>,
) -> (SVector<T, NV>, SVector<T, NX>) {
    let entry_or_zero = |k: usize| all.get(k).copied().unwrap_or(T::zero());
    (SVector::from_fn(|k, _| entry_or_zero(k)), SVector::from_fn(|k, _| entry_or_zero(NV + k)))
}

/// Concatenates velocities `v` and first-order states `x` to the extended velocity vector `[v, x]`.
pub fn join<T: Real, const NV: usize, const NX: usize, const NE: usize>(
    v: &SVector<T, NV>,
    x: &SVector<T, NX>,
) -> SVector<T, NE> {
    SVector::from_fn(|k, _| v.get(k).or(x.get(k.wrapping_sub(NV))).copied().unwrap_or(T::zero()))
}

/// Returns a square matrix with a block for the velocities, and `diagonal` times the identity for the
/// first-order states.
pub fn with_diagonal<T: Real, const NV: usize, const NX: usize, const NE: usize>(
    block: &SMatrix<T, NV, NV>,
    diagonal: T,
) -> SMatrix<T, NE, NE> {
    let mut all = SMatrix::<T, NE, NE>::from_diagonal_element(diagonal);
    put_block(&mut all, 0, &block.data.0);
    all
}

/// Concatenates the names, or the units, of velocities and first-order states.
const fn join_velocity_and_state_names<const NV: usize, const NX: usize, const NE: usize>(
    velocities: [&'static str; NV],
    states: [&'static str; NX],
) -> [&'static str; NE] {
    let mut all = [""; NE];
    let mut k = 0;
    while k < NE {
        if k < NV {
            all[k] = velocities[k];
        } else if k - NV < NX {
            all[k] = states[k - NV];
        }
        k += 1;
    }
    all
}

impl<'m, M, const NV: usize, const NX: usize, const NE: usize> Extended<'m, M, NV, NX, NE> {
    pub(super) fn new(mechanism: &'m M) -> Self {
        Extended { mechanism }
    }

    /// Returns the mechanism with the first-order states contained in the extended velocity `all`, and the
    /// velocities contained in it.
    pub(super) fn mechanism_and_velocities<T: Real, const NQ: usize, const NU: usize>(
        &self,
        all: &SVector<T, NE>,
    ) -> (M, SVector<T, NV>)
    where
        M: FirstOrder<NQ, NV, NU, NX, NE, Scalar = T>,
    {
        let (v, x) = split(all);
        (self.mechanism.with_states(&x), v)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize, const NX: usize, const NE: usize>
    Mechanism<NQ, NE, NU> for Extended<'_, M, NV, NX, NE>
where
    M: FirstOrder<NQ, NV, NU, NX, NE>,
{
    type Scalar = M::Scalar;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NE] = join_velocity_and_state_names(M::VELOCITIES, M::STATES);
    const INPUTS: [&'static str; NU] = M::INPUTS;
    const VELOCITY_UNITS: [&'static str; NE] =
        join_velocity_and_state_names(M::VELOCITY_UNITS, M::STATE_UNITS);
    const INPUT_UNITS: [&'static str; NU] = M::INPUT_UNITS;

    fn neutral(&self) -> SVector<M::Scalar, NQ> {
        self.mechanism.neutral()
    }

    fn integrate(&self, q: &SVector<M::Scalar, NQ>, dv: &SVector<M::Scalar, NE>) -> SVector<M::Scalar, NQ> {
        self.mechanism.integrate(q, &split::<_, NV, NX, NE>(dv).0)
    }

    fn difference(
        &self,
        from: &SVector<M::Scalar, NQ>,
        to: &SVector<M::Scalar, NQ>,
    ) -> SVector<M::Scalar, NE> {
        join(&self.mechanism.difference(from, to), &SVector::<M::Scalar, NX>::zeros())
    }

    fn tangent_rate(
        &self,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (dv, (v, x)) = (split::<_, NV, NX, NE>(dv).0, split::<_, NV, NX, NE>(v));
        join(&self.mechanism.tangent_rate(&dv, &v), &x)
    }

    fn displacement_rate(
        &self,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (dv, (v, x)) = (split::<_, NV, NX, NE>(dv).0, split::<_, NV, NX, NE>(v));
        join(&self.mechanism.displacement_rate(q, &dv, &v), &x)
    }

    /// Returns the mass matrix. If masses depend on first-order states, the values stored in the struct are
    /// used.
    fn mass_matrix(&self, t: M::Scalar, q: &SVector<M::Scalar, NQ>) -> SMatrix<M::Scalar, NE, NE> {
        with_diagonal::<_, NV, NX, NE>(&self.mechanism.mass_matrix(t, q), nalgebra::one())
    }

    fn bias_forces(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (m, v) = self.mechanism_and_velocities(v);
        join(&m.bias_forces(t, q, &v), &-m.state_rates(t, q, &v, &SVector::zeros()))
    }

    fn inverse_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        a: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let ((m, v), (a, rates)) = (self.mechanism_and_velocities(v), split::<_, NV, NX, NE>(a));
        let own = rates - m.state_rates(t, q, &v, &SVector::zeros());
        join(&m.inverse_dynamics(t, q, &v, &a), &own)
    }

    fn forward_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        tau: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let ((m, v), (tau, given)) = (self.mechanism_and_velocities(v), split::<_, NV, NX, NE>(tau));
        let rates = given + m.state_rates(t, q, &v, &SVector::zeros());
        join(&m.forward_dynamics(t, q, &v, &tau), &rates)
    }

    fn try_forward_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        tau: &SVector<M::Scalar, NE>,
    ) -> Result<SVector<M::Scalar, NE>, ConstraintError> {
        let ((m, v), (tau, given)) = (self.mechanism_and_velocities(v), split::<_, NV, NX, NE>(tau));
        let rates = given + m.state_rates(t, q, &v, &SVector::zeros());
        Ok(join(&m.try_forward_dynamics(t, q, &v, &tau)?, &rates))
    }

    fn generalized_forces(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        u: &SVector<M::Scalar, NU>,
    ) -> SVector<M::Scalar, NE> {
        let (m, v) = self.mechanism_and_velocities(v);
        let by_inputs = m.state_rates(t, q, &v, u) - m.state_rates(t, q, &v, &SVector::zeros());
        join(&m.generalized_forces(t, q, &v, u), &by_inputs)
    }

    fn kinetic_energy(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> M::Scalar {
        let (m, v) = self.mechanism_and_velocities(v);
        m.kinetic_energy(t, q, &v)
    }

    /// Returns the potential energy. If it depends on first-order states, the values stored in the struct are
    /// used.
    fn potential_energy(&self, t: M::Scalar, q: &SVector<M::Scalar, NQ>) -> M::Scalar {
        self.mechanism.potential_energy(t, q)
    }

    fn generalized_momentum(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let x = split::<_, NV, NX, NE>(v).1;
        let (m, v) = self.mechanism_and_velocities(v);
        join(&m.generalized_momentum(t, q, &v), &x)
    }

    fn momentum_rate(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (m, v) = self.mechanism_and_velocities(v);
        join(&m.momentum_rate(t, q, &v), &m.state_rates(t, q, &v, &SVector::zeros()))
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize, const NX: usize, const NE: usize>
    Hooks<M::Scalar, NQ, NE, NU> for Extended<'_, M, NV, NX, NE>
where
    M: FirstOrder<NQ, NV, NU, NX, NE>,
{
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = M::CONTACTING;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = NX;
    const SPEEDS: bool = M::SPEEDS;

    #[inline(always)]
    fn features(&self) -> Features {
        let inner = self.mechanism.features();
        let [coordinates, velocities] = inner.dimensions;
        Features { dimensions: [coordinates, velocities + NX], ..inner }
    }

    fn project(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> Result<Projected<M::Scalar, NQ, NE>, ConstraintError> {
        let x = split::<_, NV, NX, NE>(v).1;
        let (m, v) = self.mechanism_and_velocities(v);
        let (q, v) = m.project(t, q, &v)?;
        Ok((q, join(&v, &x)))
    }

    fn velocity_change_by_impulse(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        h: M::Scalar,
        p: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let ((m, v), (p, given)) = (self.mechanism_and_velocities(v), split::<_, NV, NX, NE>(p));
        join(&m.velocity_change_by_impulse(t, q, &v, h, &p), &given)
    }

    fn is_nearly_singular(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NE>,
    ) -> bool {
        self.mechanism.is_nearly_singular(t, q, &split::<_, NV, NX, NE>(dv).0)
    }

    fn acceleration_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        u: &SVector<M::Scalar, NU>,
    ) -> Option<ByMotion<M::Scalar, NE, NU>> {
        self.mechanism.extended_derivatives(t, q, v, u)
    }

    fn carry(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (dv, (v, x)) = (split::<_, NV, NX, NE>(dv).0, split::<_, NV, NX, NE>(v));
        join(&self.mechanism.carry(t, q, &dv, &v), &x)
    }

    fn carry_rate(
        &self,
        t: M::Scalar,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (dv, v) = (split::<_, NV, NX, NE>(dv).0, split::<_, NV, NX, NE>(v).0);
        join(&self.mechanism.carry_rate(t, &dv, &v), &SVector::<_, NX>::zeros())
    }

    fn translation(&self, t: M::Scalar, dv: &SVector<M::Scalar, NE>) -> SVector<M::Scalar, NE> {
        let v = split::<_, NV, NX, NE>(dv).0;
        join(&self.mechanism.translation(t, &v), &SVector::<_, NX>::zeros())
    }

    fn contact_start(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        parts: bool,
    ) -> Result<SVector<M::Scalar, NQ>, ConstraintError> {
        self.mechanism.contact_start(t, q, parts)
    }

    fn contact_step(
        &self,
        t: M::Scalar,
        (q, v): (&SVector<M::Scalar, NQ>, &SVector<M::Scalar, NE>),
        (end, free): (&SVector<M::Scalar, NQ>, &SVector<M::Scalar, NE>),
        (given, impulses): Assumed<'_, M::Scalar, NE>,
        h: M::Scalar,
    ) -> Result<Touched<M::Scalar, NQ, NE>, ConstraintError> {
        let ((m, v), (free, x)) = (self.mechanism_and_velocities(v), split::<_, NV, NX, NE>(free));
        let (given, added) = split::<_, NV, NX, NE>(given);
        let impulses = impulses.map(|list| split::<_, NV, NX, NE>(list).0);
        let touched = m.contact_step(t, (q, &v), (end, &free), (&given, &impulses), h)?;
        let append_zeros = |list: &SVector<_, NV>| join(list, &SVector::<_, NX>::zeros());
        let (held, impulses) = (append_zeros(&touched.held), touched.impulses.map(append_zeros));
        let Touched { q, v, violation, .. } = touched;
        Ok(Touched { q, v: join(&v, &(x + added)), held, impulses, violation })
    }

    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<M::Scalar, NQ, NE, NU>,
    {
        None
    }
}
