//! Interface between mechanisms and integration methods, which programs that simulate do not need.

use crate::constraint::{ConstraintError, Projected};
use crate::contact::{Assumed, Touched};
use crate::forward::{constants, each_function};
use crate::{Mechanism, Real};
use nalgebra::SVector;

/// Properties of a mechanism as data, which integration methods read at run time. A mechanism that is loaded
/// at run time has properties that the compiler does not know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Features {
    /// Whether constraints restrict the coordinates ([`Hooks::CONSTRAINED`]).
    pub constrained: bool,
    /// Whether contacts slide with friction ([`Hooks::SLIPPING`]).
    pub slipping: bool,
    /// Whether feedback enforces the constraints, or forces depend on accelerations ([`Hooks::FEEDBACK`]).
    pub feedback: bool,
    /// Whether the mechanism declares generalized speeds ([`Hooks::SPEEDS`]).
    pub speeds: bool,
    /// Numbers of coordinates and velocities in use; further entries of vectors are padding, which is zero.
    pub dimensions: [usize; 2],
}

impl Features {
    /// Returns the properties of a mechanism that the compiler knows.
    #[must_use]
    pub const fn of_mechanism<M, T: Real, const NQ: usize, const NV: usize, const NU: usize>() -> Self
    where
        M: Hooks<T, NQ, NV, NU> + ?Sized,
    {
        Self {
            constrained: M::CONSTRAINED,
            slipping: M::SLIPPING,
            feedback: M::FEEDBACK,
            speeds: M::SPEEDS,
            dimensions: [NQ, NV],
        }
    }

    /// Whether the configuration is a vector space with the rates of the coordinates as velocities, without
    /// quaternions or generalized speeds.
    #[must_use]
    pub const fn is_plain(&self) -> bool {
        self.dimensions[0] == self.dimensions[1] && !self.speeds
    }
}

/// Properties of a mechanism that choose how it is integrated, and the functions that do it: projection onto
/// constraints, impulses, contacts. Integration methods call them; `#[mechanism]` and wrappers of mechanisms
/// implement them.
pub trait Hooks<T: Real, const NQ: usize, const NV: usize, const NU: usize> {
    /// Whether constraints restrict the coordinates, so that the mechanism is
    /// [`Constrained`](crate::Constrained).
    const CONSTRAINED: bool = false;

    /// Whether contacts slide with friction ([`Slipping`](crate::elements::Slipping)): forces then depend on
    /// multipliers.
    const SLIPPING: bool = false;

    /// Whether feedback enforces the constraints ([`Stabilized`](crate::constraint::Stabilized)), or forces
    /// depend on accelerations. `forward_dynamics` includes these forces, so that mass matrix and momentum do
    /// not determine the motion; states need not satisfy the constraints.
    const FEEDBACK: bool = false;

    /// Whether the mechanism has unilateral contacts ([`Contacts`](crate::Contacts)); integration methods
    /// that do not treat them do not compile.
    const CONTACTING: bool = false;

    /// Whether contact events can be located ([`EventDriven`](crate::integrate::EventDriven)), through
    /// [`visit_contacts`](Self::visit_contacts).
    const LOCATABLE: bool = false;

    /// Number of first-order states, which are the last velocities and have no entry in `q`
    /// ([`Extended`](crate::Extended)).
    const FIRST_ORDER: usize = 0;

    /// Whether some velocities are declared generalized speeds ([`Speed`](crate::elements::Speed)): the
    /// relation between `v` and the motion of `q` then depends on `q`.
    const SPEEDS: bool = false;

    /// Returns the properties that integration methods read from the object: the constants, unless the
    /// mechanism is loaded at run time.
    #[inline(always)]
    fn features(&self) -> Features {
        Features::of_mechanism::<Self, T, NQ, NV, NU>()
    }

    /// Projects a state onto the constraints, if there are any: returns the nearest state that satisfies
    /// them.
    ///
    /// # Errors
    ///
    /// The errors of [`Constrained::project_state`](crate::Constrained::project_state).
    fn project(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> Result<Projected<T, NQ, NV>, ConstraintError> {
        Ok((*q, *v))
    }

    /// Returns the change `x` of the velocity `v` due to the generalized impulse `p`, N·s and N·m·s: the
    /// solution of `M x = p`. With constraints it solves `M x = p + Jᵀ λ` with constraint impulses `λ` such
    /// that the constraints are satisfied, to first order in `x`, after the new velocity has lasted for `h`
    /// seconds; for `h = 0`, such that their rates are zero. Implicit methods solve their equations with this
    /// function.
    fn velocity_change_by_impulse(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        _h: T,
        p: &SVector<T, NV>,
    ) -> SVector<T, NV>
    where
        Self: Mechanism<NQ, NV, NU, Scalar = T>,
    {
        self.forward_dynamics(t, q, v, &(self.bias_forces(t, q, v) + p))
    }

    /// Whether the constraints are singular or nearly so at `q`: a displacement by `dv` changes them as much
    /// as they differ from dependent constraints. Integration methods then use accelerations, which are
    /// continuous there.
    fn is_nearly_singular(&self, _t: T, _q: &SVector<T, NQ>, _dv: &SVector<T, NV>) -> bool {
        false
    }

    /// Returns `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂u)` under the inputs `u`, constraints included, as in
    /// [`LinearMotion`](crate::LinearMotion). Implicit methods use these derivatives. `None` without
    /// `#[mechanism(…, derivatives)]`; methods then use finite differences.
    fn acceleration_derivatives(
        &self,
        _t: T,
        _q: &SVector<T, NQ>,
        _v: &SVector<T, NV>,
        _u: &SVector<T, NU>,
    ) -> Option<crate::ByMotion<T, NV, NU>> {
        None
    }

    /// Returns the velocity `v` at the configuration `q` expressed in the axes of ball and free joints after
    /// the displacement `dv`, and in the generalized speeds there if some are declared: the components
    /// change, the motion of the bodies does not. Mechanisms without contacts return `v` unchanged.
    fn carry(&self, _t: T, _q: &SVector<T, NQ>, _dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        *v
    }

    /// Returns the rate of [`carry`](Self::carry) for a displacement that begins at zero and grows at the
    /// rate `dv`: the rate of the components of a velocity `v` that is constant in space, during a motion
    /// with velocity `dv`. Zero for mechanisms without contacts and with declared generalized speeds.
    fn carry_rate(&self, _t: T, _dv: &SVector<T, NV>, _v: &SVector<T, NV>) -> SVector<T, NV> {
        SVector::zeros()
    }

    /// Returns the part of the displacement `dv` that is linear velocities of free joints. A displacement by
    /// this part, followed by one by the remainder, moves the origins of their bodies along straight lines.
    /// Zero for mechanisms without contacts and with declared generalized speeds.
    fn translation(&self, _t: T, _dv: &SVector<T, NV>) -> SVector<T, NV> {
        SVector::zeros()
    }

    /// Checks or corrects the configuration `q` at the start of a motion. Penetrating contact surfaces are an
    /// error ([`contact::check`](crate::contact::check)), or are separated if `parts` is true
    /// ([`contact::project`](crate::contact::project)). Mechanisms without contacts return `q` unchanged.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Overlap`] with the contact of the deepest penetration.
    fn contact_start(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        _parts: bool,
    ) -> Result<SVector<T, NQ>, ConstraintError> {
        Ok(*q)
    }

    /// Applies the contact impulses of a step of `h` seconds ([`contact::solve`](crate::contact::solve)). The
    /// step starts at the configuration and velocity `start`; without contacts it ends at the configuration
    /// `q` with the velocity `free`, and during it contacts were assumed to add the first
    /// entry of `given` to the velocity.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Contact`] for mechanisms with contacts.
    fn contact_step(
        &self,
        _t: T,
        _start: (&SVector<T, NQ>, &SVector<T, NV>),
        (q, free): (&SVector<T, NQ>, &SVector<T, NV>),
        (given, _): Assumed<'_, T, NV>,
        _h: T,
    ) -> Result<Touched<T, NQ, NV>, ConstraintError> {
        Ok(Touched::state_without_contacts(*q, free + given))
    }

    /// Passes the mechanism to `visitor`, with the numbers of its contacts as const parameters. `None` for
    /// mechanisms without contacts and for wrappers of several states.
    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<T, NQ, NV, NU>,
    {
        None
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize> Hooks<M::Scalar, NQ, NV, NU> for &M
where
    M: Mechanism<NQ, NV, NU> + ?Sized,
{
    constants!(hooks, M);

    #[inline(always)]
    fn features(&self) -> Features {
        M::features(self)
    }

    each_function!(methods, [M::Scalar] pass Hooks, self => *self);

    fn visit_contacts<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<M::Scalar, NQ, NV, NU>,
    {
        M::visit_contacts(self, visitor)
    }
}
