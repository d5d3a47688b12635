//! Adapter that makes a mechanism evaluate several states in SIMD lanes as its scalar type.

use super::{Batch, LaneColumn};
use crate::blocks::zeros;
use crate::contact::{Assumed, Impulses, Touched};
use crate::forward::constants;
use crate::integrate::{Features, Hooks};
use crate::lanes::{lane, lane_by_lane, set_lane};
use crate::{ByMotion, ConstraintError, Lanes, Mechanism};
use nalgebra::{SMatrix, SVector};
use num_traits::Zero;

/// Mechanism whose scalar type is `L` SIMD lanes, created by [`Batch::lanes`]. It evaluates several states in
/// one call, and is itself a [`Mechanism`].
#[derive(Debug)]
pub struct Lanewise<'m, M, const L: usize> {
    pub(super) mechanism: &'m M,
}

impl<M, const L: usize> Clone for Lanewise<'_, M, L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M, const L: usize> Copy for Lanewise<'_, M, L> {}

impl<'m, M, const L: usize> Lanewise<'m, M, L> {
    /// Wraps a mechanism for evaluation in lanes, as `mechanism.lanes::<L>()` does.
    pub fn new(mechanism: &'m M) -> Self {
        Self { mechanism }
    }
}

/// Defines functions of `t` and vectors that call the function of the wrapped mechanism for several lanes.
macro_rules! lanewise {
    ($($name:ident = $twin:ident[$($time:ident)?]($($argument:ident: $of:ident),*) -> $result:ty;)+) => {$(
        #[inline(always)]
        fn $name(&self, $($time: Self::Scalar,)? $($argument: &SVector<Self::Scalar, $of>),*) -> $result {
            self.mechanism.$twin($($time,)? $($argument),*)
        }
    )+};
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const L: usize, const NQ: usize, const NV: usize, const NU: usize> Mechanism<NQ, NV, NU>
    for Lanewise<'_, M, L>
where
    M: Batch<NQ, NV, NU>,
{
    type Scalar = Lanes<M::Scalar, L>;
    constants!(names, M);

    #[inline(always)]
    fn neutral(&self) -> SVector<Self::Scalar, NQ> {
        self.mechanism.neutral().map(Lanes::splat)
    }

    /// Returns NaN in lanes in which the forces determine no acceleration, as `forward_dynamics` does.
    fn try_forward_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        Ok(self.forward_dynamics(t, q, v, tau))
    }

    lanewise! {
        integrate = integrate_lanes[](q: NQ, dv: NV) -> SVector<Self::Scalar, NQ>;
        difference = difference_lanes[](from: NQ, to: NQ) -> SVector<Self::Scalar, NV>;
        tangent_rate = tangent_rate_lanes[](dv: NV, v: NV) -> SVector<Self::Scalar, NV>;
        displacement_rate = displacement_rate_lanes[](q: NQ, dv: NV, v: NV) -> SVector<Self::Scalar, NV>;
        mass_matrix = mass_matrix_lanes[t](q: NQ) -> SMatrix<Self::Scalar, NV, NV>;
        bias_forces = bias_forces_lanes[t](q: NQ, v: NV) -> SVector<Self::Scalar, NV>;
        inverse_dynamics = inverse_dynamics_lanes[t](q: NQ, v: NV, a: NV) -> SVector<Self::Scalar, NV>;
        forward_dynamics = forward_dynamics_lanes[t](q: NQ, v: NV, tau: NV) -> SVector<Self::Scalar, NV>;
        generalized_forces = generalized_forces_lanes[t](q: NQ, v: NV, u: NU) -> SVector<Self::Scalar, NV>;
        kinetic_energy = kinetic_energy_lanes[t](q: NQ, v: NV) -> Self::Scalar;
        potential_energy = potential_energy_lanes[t](q: NQ) -> Self::Scalar;
        generalized_momentum = generalized_momentum_lanes[t](q: NQ, v: NV) -> SVector<Self::Scalar, NV>;
        momentum_rate = momentum_rate_lanes[t](q: NQ, v: NV) -> SVector<Self::Scalar, NV>;
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const L: usize, const NQ: usize, const NV: usize, const NU: usize>
    Hooks<Lanes<M::Scalar, L>, NQ, NV, NU> for Lanewise<'_, M, L>
where
    M: Batch<NQ, NV, NU>,
{
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = M::CONTACTING;
    const LOCATABLE: bool = false;
    const SPEEDS: bool = M::SPEEDS;

    #[inline(always)]
    fn features(&self) -> Features {
        Features::of_mechanism::<Self, Lanes<M::Scalar, L>, NQ, NV, NU>()
    }

    /// Projects the state of each lane onto the constraints. A lane whose projection fails becomes NaN; it is
    /// an error if all lanes fail.
    fn project(
        &self,
        t: Lanes<M::Scalar, L>,
        q: &LaneColumn<M::Scalar, L, NQ>,
        v: &LaneColumn<M::Scalar, L, NV>,
    ) -> Result<(LaneColumn<M::Scalar, L, NQ>, LaneColumn<M::Scalar, L, NV>), ConstraintError> {
        let results: [_; L] =
            core::array::from_fn(|k| self.mechanism.project(t.0[k], &lane(q, k), &lane(v, k)));
        if let Some(Err(error)) = results.first()
            && results.iter().all(Result::is_err)
        {
            return Err(*error);
        }
        let nothing = M::Scalar::zero() / M::Scalar::zero();
        let state_of_lane = |k: usize| match &results[k] {
            Ok(state) => *state,
            Err(_) => (SVector::repeat(nothing), SVector::repeat(nothing)),
        };
        Ok((lane_by_lane(|k| state_of_lane(k).0), lane_by_lane(|k| state_of_lane(k).1)))
    }

    /// Whether the state of any lane is nearly singular; all lanes then use accelerations.
    fn is_nearly_singular(
        &self,
        t: Lanes<M::Scalar, L>,
        q: &LaneColumn<M::Scalar, L, NQ>,
        dv: &LaneColumn<M::Scalar, L, NV>,
    ) -> bool {
        M::CONSTRAINED && (0..L).any(|k| self.mechanism.is_nearly_singular(t.0[k], &lane(q, k), &lane(dv, k)))
    }

    /// Computes the derivatives of the accelerations for each lane separately.
    fn acceleration_derivatives(
        &self,
        t: Lanes<M::Scalar, L>,
        q: &LaneColumn<M::Scalar, L, NQ>,
        v: &LaneColumn<M::Scalar, L, NV>,
        u: &LaneColumn<M::Scalar, L, NU>,
    ) -> Option<ByMotion<Lanes<M::Scalar, L>, NV, NU>> {
        let mut all: ByMotion<Lanes<M::Scalar, L>, NV, NU> = (zeros(), zeros(), zeros());
        for k in 0..L {
            let (by_q, by_v, by_u) =
                self.mechanism.acceleration_derivatives(t.0[k], &lane(q, k), &lane(v, k), &lane(u, k))?;
            set_lane(&mut all.0, k, &by_q);
            set_lane(&mut all.1, k, &by_v);
            set_lane(&mut all.2, k, &by_u);
        }
        Some(all)
    }

    /// Computes the transported velocity for each lane separately.
    fn carry(
        &self,
        t: Lanes<M::Scalar, L>,
        q: &LaneColumn<M::Scalar, L, NQ>,
        dv: &LaneColumn<M::Scalar, L, NV>,
        v: &LaneColumn<M::Scalar, L, NV>,
    ) -> LaneColumn<M::Scalar, L, NV> {
        lane_by_lane(|k| self.mechanism.carry(t.0[k], &lane(q, k), &lane(dv, k), &lane(v, k)))
    }

    /// Computes the rate of the transported velocity for each lane separately.
    fn carry_rate(
        &self,
        t: Lanes<M::Scalar, L>,
        dv: &LaneColumn<M::Scalar, L, NV>,
        v: &LaneColumn<M::Scalar, L, NV>,
    ) -> LaneColumn<M::Scalar, L, NV> {
        lane_by_lane(|k| self.mechanism.carry_rate(t.0[k], &lane(dv, k), &lane(v, k)))
    }

    fn translation(
        &self,
        t: Lanes<M::Scalar, L>,
        dv: &LaneColumn<M::Scalar, L, NV>,
    ) -> LaneColumn<M::Scalar, L, NV> {
        lane_by_lane(|k| self.mechanism.translation(t.0[k], &lane(dv, k)))
    }

    /// Computes the initial configuration of motion with contacts for each lane separately. An error in one
    /// lane, such as overlapping surfaces, is an error of all lanes.
    fn contact_start(
        &self,
        t: Lanes<M::Scalar, L>,
        q: &LaneColumn<M::Scalar, L, NQ>,
        parts: bool,
    ) -> Result<LaneColumn<M::Scalar, L, NQ>, ConstraintError> {
        let results: [_; L] =
            core::array::from_fn(|k| self.mechanism.contact_start(t.0[k], &lane(q, k), parts));
        if let Some(Err(error)) = results.iter().find(|result| result.is_err()) {
            return Err(*error);
        }
        Ok(lane_by_lane(|k| results[k].unwrap_or_else(|_| lane(q, k))))
    }

    /// Solves the contacts of each lane separately. A lane whose contacts have no solution becomes NaN; it is
    /// an error if all lanes fail.
    fn contact_step(
        &self,
        t: Lanes<M::Scalar, L>,
        start: (&LaneColumn<M::Scalar, L, NQ>, &LaneColumn<M::Scalar, L, NV>),
        end: (&LaneColumn<M::Scalar, L, NQ>, &LaneColumn<M::Scalar, L, NV>),
        (given, impulses): Assumed<'_, Lanes<M::Scalar, L>, NV>,
        h: Lanes<M::Scalar, L>,
    ) -> Result<Touched<Lanes<M::Scalar, L>, NQ, NV>, ConstraintError> {
        let results: [_; L] = core::array::from_fn(|k| {
            let [(start, v), (q, free)] = [start, end].map(|(q, v)| (lane(q, k), lane(v, k)));
            let impulses = impulses.map(|list| lane(list, k));
            self.mechanism.contact_step(
                t.0[k],
                (&start, &v),
                (&q, &free),
                (&lane(given, k), &impulses),
                h.0[k],
            )
        });
        if let Some(Err(error)) = results.first()
            && results.iter().all(Result::is_err)
        {
            return Err(*error);
        }
        let nothing = M::Scalar::zero() / M::Scalar::zero();
        let lost = Touched::state_without_contacts(SVector::repeat(nothing), SVector::repeat(nothing));
        let result_of_lane = |k: usize| results[k].unwrap_or(lost);
        let [v, held] = [lane_by_lane(|k| result_of_lane(k).v), lane_by_lane(|k| result_of_lane(k).held)];
        let violation = Lanes(core::array::from_fn(|k| result_of_lane(k).violation));
        let impulses = Impulses::from_lists(|i| lane_by_lane(|k| result_of_lane(k).impulses.list(i)));
        Ok(Touched { q: lane_by_lane(|k| result_of_lane(k).q), v, held, impulses, violation })
    }

    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<Lanes<M::Scalar, L>, NQ, NV, NU>,
    {
        None
    }

    /// Computes the velocity change by an impulse for each lane separately if there are constraints.
    fn velocity_change_by_impulse(
        &self,
        t: Lanes<M::Scalar, L>,
        q: &LaneColumn<M::Scalar, L, NQ>,
        v: &LaneColumn<M::Scalar, L, NV>,
        h: Lanes<M::Scalar, L>,
        p: &LaneColumn<M::Scalar, L, NV>,
    ) -> LaneColumn<M::Scalar, L, NV> {
        if M::CONSTRAINED {
            let one = |k: usize| {
                self.mechanism.velocity_change_by_impulse(
                    t.0[k],
                    &lane(q, k),
                    &lane(v, k),
                    h.0[k],
                    &lane(p, k),
                )
            };
            return lane_by_lane(one);
        }
        self.forward_dynamics(t, q, v, &(self.bias_forces(t, q, v) + p))
    }
}
