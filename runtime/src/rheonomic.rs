//! Mechanisms whose equations contain time: driven cranks, rotating hoops, moving pivots. Integrators are written against
//! this trait, which every [`Mechanism`] has too.

use crate::{Mechanism, Real};
use nalgebra::{SMatrix, SVector};

/// A mechanism whose functions may depend on time `t`, s. Shapes, units and conventions are those of [`Mechanism`]; with
/// driven motion the kinetic energy is no longer `½ vᵀ M v`, nor the momentum `M v`.
#[allow(missing_docs, reason = "each function is that of `Mechanism` at time `t`")]
pub trait Rheonomic<const NQ: usize, const NV: usize, const NU: usize> {
    /// The scalar type.
    type Scalar: Real;

    /// Name of every entry of `q`.
    const CONFIGURATION: [&'static str; NQ];
    /// Name of every entry of `v`.
    const VELOCITIES: [&'static str; NV];
    /// Name of every entry of `u`.
    const INPUTS: [&'static str; NU];

    fn neutral(&self) -> SVector<Self::Scalar, NQ>;

    fn integrate(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NQ>;

    fn difference(
        &self,
        from: &SVector<Self::Scalar, NQ>,
        to: &SVector<Self::Scalar, NQ>,
    ) -> SVector<Self::Scalar, NV>;

    fn tangent_rate(
        &self,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    fn mass_matrix(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> SMatrix<Self::Scalar, NV, NV>;

    fn bias_forces(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    fn inverse_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    fn forward_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    fn generalized_forces(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SVector<Self::Scalar, NV>;

    fn kinetic_energy(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Self::Scalar;

    fn potential_energy(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> Self::Scalar;

    fn generalized_momentum(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    fn momentum_rate(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;
}

/// A mechanism at an instant.
#[derive(Clone, Copy, Debug)]
pub struct At<'m, M, T> {
    mechanism: &'m M,
    t: T,
}

/// The mechanism at time `t`, for code that is written against [`Mechanism`].
pub fn at<M, T>(mechanism: &M, t: T) -> At<'_, M, T> {
    At { mechanism, t }
}

/// Writes one of the two traits in terms of the other: names, arguments, results.
macro_rules! functions {
    ($($name:ident($($argument:ident: $of:ident),*) -> $result:ty;)+; $how:ident) => {
        $(functions! { @$how $name($($argument: $of),*) -> $result })+
    };
    (@drop $name:ident($($argument:ident: $of:ident),*) -> $result:ty) => {
        #[inline(always)]
        fn $name(&self, _t: Self::Scalar $(, $argument: &SVector<Self::Scalar, $of>)*) -> $result {
            Mechanism::$name(self $(, $argument)*)
        }
    };
    (@bind $name:ident($($argument:ident: $of:ident),*) -> $result:ty) => {
        #[inline(always)]
        fn $name(&self $(, $argument: &SVector<Self::Scalar, $of>)*) -> $result {
            self.mechanism.$name(self.t $(, $argument)*)
        }
    };
    (@pass $name:ident($($argument:ident: $of:ident),*) -> $result:ty) => {
        #[inline(always)]
        fn $name(&self $(, $argument: &SVector<Self::Scalar, $of>)*) -> $result {
            Mechanism::$name(self $(, $argument)*)
        }
    };
    (@inner $name:ident($($argument:ident: $of:ident),*) -> $result:ty) => {
        #[inline(always)]
        fn $name(&self $(, $argument: &SVector<Self::Scalar, $of>)*) -> $result {
            self.mechanism.$name($($argument),*)
        }
    };
}

macro_rules! timeless {
    ($how:ident) => {
        functions! {
            neutral() -> SVector<Self::Scalar, NQ>;
            integrate(q: NQ, dv: NV) -> SVector<Self::Scalar, NQ>;
            difference(from: NQ, to: NQ) -> SVector<Self::Scalar, NV>;
            tangent_rate(dv: NV, v: NV) -> SVector<Self::Scalar, NV>;; $how
        }
    };
}

macro_rules! timed {
    ($how:ident) => {
        functions! {
            mass_matrix(q: NQ) -> SMatrix<Self::Scalar, NV, NV>;
            bias_forces(q: NQ, v: NV) -> SVector<Self::Scalar, NV>;
            inverse_dynamics(q: NQ, v: NV, a: NV) -> SVector<Self::Scalar, NV>;
            forward_dynamics(q: NQ, v: NV, tau: NV) -> SVector<Self::Scalar, NV>;
            generalized_forces(q: NQ, v: NV, u: NU) -> SVector<Self::Scalar, NV>;
            kinetic_energy(q: NQ, v: NV) -> Self::Scalar;
            potential_energy(q: NQ) -> Self::Scalar;
            generalized_momentum(q: NQ, v: NV) -> SVector<Self::Scalar, NV>;
            momentum_rate(q: NQ, v: NV) -> SVector<Self::Scalar, NV>;; $how
        }
    };
}

impl<M, const NQ: usize, const NV: usize, const NU: usize> Rheonomic<NQ, NV, NU> for M
where
    M: Mechanism<NQ, NV, NU>,
{
    type Scalar = M::Scalar;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NV] = M::VELOCITIES;
    const INPUTS: [&'static str; NU] = M::INPUTS;
    timeless!(pass);
    timed!(drop);
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize> Mechanism<NQ, NV, NU> for At<'_, M, T>
where
    T: Real,
    M: Rheonomic<NQ, NV, NU, Scalar = T>,
{
    type Scalar = T;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NV] = M::VELOCITIES;
    const INPUTS: [&'static str; NU] = M::INPUTS;
    timeless!(inner);
    timed!(bind);
}
