//! A mechanism whose contacts are left out.

use crate::Rheonomic;
use crate::forward::{each_function, inherent_functions};
use nalgebra::{SMatrix, SVector};

/// A mechanism whose contacts do nothing; made by [`apart`].
#[derive(Clone, Copy, Debug)]
pub struct Apart<'m, M> {
    mechanism: &'m M,
}

/// The mechanism without its contacts: bodies pass through each other, and every method of integration
/// simulates it.
pub fn apart<M>(mechanism: &M) -> Apart<'_, M> {
    Apart { mechanism }
}

inherent_functions!(impl<'m, M> Apart<'m, M>);

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize> Rheonomic<NQ, NV, NU> for Apart<'_, M>
where
    M: Rheonomic<NQ, NV, NU>,
{
    type Scalar = M::Scalar;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NV] = M::VELOCITIES;
    const INPUTS: [&'static str; NU] = M::INPUTS;
    const VELOCITY_UNITS: [&'static str; NV] = M::VELOCITY_UNITS;
    const INPUT_UNITS: [&'static str; NU] = M::INPUT_UNITS;
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = false;
    const LOCATABLE: bool = false;

    each_function!(space, plain Rheonomic, self => self.mechanism);
    each_function!(dynamics, pass Rheonomic, self => self.mechanism);
    each_function!(accelerations, pass Rheonomic, self => self.mechanism);
    each_function!(methods, pass Rheonomic, self => self.mechanism);

    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }
}
