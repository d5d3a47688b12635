//! Wrapper that counts evaluations of a mechanism.

use linkwork::integrate::Hooks;
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{ByMotion, ConstraintError, Mechanism};
use std::cell::Cell;

/// Mechanism that counts how often its accelerations and their derivatives are evaluated. It hides the
/// derivatives unless `KNOWN`.
pub struct CountingMechanism<'m, M, const KNOWN: bool> {
    mechanism: &'m M,
    /// Number of evaluations of forward dynamics.
    pub evaluations: Cell<usize>,
    /// Number of evaluations of the derivatives of the accelerations.
    pub derivatives: Cell<usize>,
}

impl<'m, M, const KNOWN: bool> CountingMechanism<'m, M, KNOWN> {
    /// Wraps a mechanism.
    pub fn new(mechanism: &'m M) -> Self {
        Self { mechanism, evaluations: Cell::new(0), derivatives: Cell::new(0) }
    }
}

fn increment_counter(cell: &Cell<usize>) {
    cell.set(cell.get() + 1);
}

macro_rules! pass {
    ($($name:ident($($argument:ident: $n:ident),*) -> $result:ty;)*) => {$(
        fn $name(&self, t: f64, $($argument: &SVector<f64, $n>),*) -> $result {
            self.mechanism.$name(t, $($argument),*)
        }
    )*};
}

impl<M, const NQ: usize, const NV: usize, const NU: usize, const KNOWN: bool> Mechanism<NQ, NV, NU>
    for CountingMechanism<'_, M, KNOWN>
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    type Scalar = f64;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NV] = M::VELOCITIES;
    const INPUTS: [&'static str; NU] = M::INPUTS;

    fn neutral(&self) -> SVector<f64, NQ> {
        self.mechanism.neutral()
    }
    fn integrate(&self, q: &SVector<f64, NQ>, dv: &SVector<f64, NV>) -> SVector<f64, NQ> {
        self.mechanism.integrate(q, dv)
    }
    fn difference(&self, from: &SVector<f64, NQ>, to: &SVector<f64, NQ>) -> SVector<f64, NV> {
        self.mechanism.difference(from, to)
    }
    fn tangent_rate(&self, dv: &SVector<f64, NV>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        self.mechanism.tangent_rate(dv, v)
    }
    fn forward_dynamics(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        tau: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        increment_counter(&self.evaluations);
        self.mechanism.forward_dynamics(t, q, v, tau)
    }
    pass! {
        mass_matrix(q: NQ) -> SMatrix<f64, NV, NV>;
        bias_forces(q: NQ, v: NV) -> SVector<f64, NV>;
        inverse_dynamics(q: NQ, v: NV, a: NV) -> SVector<f64, NV>;
        generalized_forces(q: NQ, v: NV, u: NU) -> SVector<f64, NV>;
        kinetic_energy(q: NQ, v: NV) -> f64;
        potential_energy(q: NQ) -> f64;
        generalized_momentum(q: NQ, v: NV) -> SVector<f64, NV>;
        momentum_rate(q: NQ, v: NV) -> SVector<f64, NV>;
    }
}

impl<M, const NQ: usize, const NV: usize, const NU: usize, const KNOWN: bool> Hooks<f64, NQ, NV, NU>
    for CountingMechanism<'_, M, KNOWN>
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    const CONSTRAINED: bool = M::CONSTRAINED;
    const FEEDBACK: bool = M::FEEDBACK;
    const FIRST_ORDER: usize = M::FIRST_ORDER;

    fn velocity_change_by_impulse(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        h: f64,
        p: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        self.mechanism.velocity_change_by_impulse(t, q, v, h, p)
    }
    fn acceleration_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        u: &SVector<f64, NU>,
    ) -> Option<ByMotion<f64, NV, NU>> {
        increment_counter(&self.derivatives);
        if KNOWN { self.mechanism.acceleration_derivatives(t, q, v, u) } else { None }
    }
    pass! {
        project(q: NQ, v: NV) -> Result<(SVector<f64, NQ>, SVector<f64, NV>), ConstraintError>;
        is_nearly_singular(q: NQ, dv: NV) -> bool;
    }
}
