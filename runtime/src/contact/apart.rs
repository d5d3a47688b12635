//! Mechanisms without their contacts.

use crate::Mechanism;
use crate::forward::{constants, each_function};
use crate::integrate::{Features, Hooks};

/// Mechanism without its contacts, returned by [`apart`].
#[derive(Clone, Copy, Debug)]
pub struct Apart<'m, M> {
    mechanism: &'m M,
}

/// Returns the mechanism without its contacts: bodies pass through each other, and every method of integration
/// simulates it.
pub fn apart<M>(mechanism: &M) -> Apart<'_, M> {
    Apart { mechanism }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize> Mechanism<NQ, NV, NU> for Apart<'_, M>
where
    M: Mechanism<NQ, NV, NU>,
{
    type Scalar = M::Scalar;
    constants!(names, M);

    each_function!(space, plain Mechanism, self => self.mechanism);
    each_function!(dynamics, pass Mechanism, self => self.mechanism);
    each_function!(accelerations, pass Mechanism, self => self.mechanism);
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize> Hooks<M::Scalar, NQ, NV, NU> for Apart<'_, M>
where
    M: Mechanism<NQ, NV, NU>,
{
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = false;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = M::FIRST_ORDER;
    const SPEEDS: bool = M::SPEEDS;

    #[inline(always)]
    fn features(&self) -> Features {
        self.mechanism.features()
    }

    each_function!(methods, [M::Scalar] pass Hooks, self => self.mechanism);

    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<M::Scalar, NQ, NV, NU>,
    {
        None
    }
}
