//! Mechanisms at a fixed time, for functions that require equations of motion without time.

use crate::forward::{constants, each_function};
use crate::integrate::{Features, Hooks};
use crate::{Mechanism, Real, Scleronomic};

/// Mechanism at a fixed time. The argument `t` of its functions is ignored.
#[derive(Clone, Copy, Debug)]
pub struct At<'m, M, T> {
    pub(crate) mechanism: &'m M,
    pub(crate) t: T,
}

/// Returns the mechanism at time `t`, for functions of mechanisms without time ([`Scleronomic`]).
pub fn at<M, T>(mechanism: &M, t: T) -> At<'_, M, T> {
    At { mechanism, t }
}

impl<M, T> Scleronomic for At<'_, M, T> {}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize> Mechanism<NQ, NV, NU> for At<'_, M, T>
where
    T: Real,
    M: Mechanism<NQ, NV, NU, Scalar = T>,
{
    type Scalar = T;
    constants!(names, M);

    each_function!(space, plain Mechanism, self => self.mechanism);
    each_function!(dynamics, at Mechanism, self => self.mechanism);
    each_function!(accelerations, at Mechanism, self => self.mechanism);
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize> Hooks<T, NQ, NV, NU> for At<'_, M, T>
where
    T: Real,
    M: Mechanism<NQ, NV, NU, Scalar = T>,
{
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = M::CONTACTING;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = M::FIRST_ORDER;
    const SPEEDS: bool = M::SPEEDS;

    #[inline(always)]
    fn features(&self) -> Features {
        self.mechanism.features()
    }

    each_function!(methods, [T] at Hooks, self => self.mechanism);

    // Contacts take the time as an argument of their own.
    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<T, NQ, NV, NU>,
    {
        None
    }
}
