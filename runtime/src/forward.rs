//! Table of the functions of the mechanism traits. All forwarding implementations are generated from it:
//! those for references, for a mechanism at an instant, for a mechanism without time as a rheonomic one, for
//! stabilised mechanisms, and for lanes.
//!
//! A function added to the traits must be added to this table. Forwarding implementations enable the lint
//! `clippy::missing_trait_methods`, so that a missing function does not silently become its default.

/// Passes groups of rows `name(argument: kind, …) -> result` to a macro that defines a function for each row.
/// `space` does not depend on time, `dynamics` does; constraints and feedback change `accelerations`;
/// integrators call `methods`. `tangent` and `derivatives` belong to the derivative traits, without and with
/// time (`given_derivatives` excludes derivatives of accelerations). `second` belongs to the
/// second-derivative traits, of which `second_tangent` has no time. A kind is the length of a vector,
/// `scalar`, `state`, or `square` for a matrix that receives a result.
macro_rules! each_function {
    (space, $($how:tt)+) => {
        $crate::forward::write! { $($how)+;
            neutral() -> SVector<Self::Scalar, NQ>;
            integrate(q: NQ, dv: NV) -> SVector<Self::Scalar, NQ>;
            difference(from: NQ, to: NQ) -> SVector<Self::Scalar, NV>;
            tangent_rate(dv: NV, v: NV) -> SVector<Self::Scalar, NV>;
            displacement_rate(q: NQ, dv: NV, v: NV) -> SVector<Self::Scalar, NV>;
        }
    };
    (dynamics, $($how:tt)+) => {
        $crate::forward::write! { $($how)+;
            mass_matrix(q: NQ) -> SMatrix<Self::Scalar, NV, NV>;
            bias_forces(q: NQ, v: NV) -> SVector<Self::Scalar, NV>;
            inverse_dynamics(q: NQ, v: NV, a: NV) -> SVector<Self::Scalar, NV>;
            generalized_forces(q: NQ, v: NV, u: NU) -> SVector<Self::Scalar, NV>;
            kinetic_energy(q: NQ, v: NV) -> Self::Scalar;
            potential_energy(q: NQ) -> Self::Scalar;
            generalized_momentum(q: NQ, v: NV) -> SVector<Self::Scalar, NV>;
            momentum_rate(q: NQ, v: NV) -> SVector<Self::Scalar, NV>;
        }
    };
    (accelerations, $($how:tt)+) => {
        $crate::forward::write! { $($how)+;
            forward_dynamics(q: NQ, v: NV, tau: NV) -> SVector<Self::Scalar, NV>;
            try_forward_dynamics(q: NQ, v: NV, tau: NV) -> Result<SVector<Self::Scalar, NV>, $crate::ConstraintError>;
        }
    };
    (tangent, $($how:tt)+) => {
        $crate::forward::write! { $($how)+;
            integrate_derivatives(dv: NV) -> (SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NV>);
            tangent_rate_derivatives(dv: NV, v: NV) -> (SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NV>);
            integrate_derivatives_at(q: NQ, dv: NV) -> (SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NV>);
            displacement_rate_derivatives(q: NQ, dv: NV, v: NV) -> $crate::ByMotion<Self::Scalar, NV, NV>;
            turning(q: NQ, v: NV) -> SMatrix<Self::Scalar, NV, NV>;
        }
    };
    (derivatives, $($how:tt)+) => {
        $crate::forward::each_function!(given_derivatives, $($how)+);
        $crate::forward::write! { $($how)+;
            forward_dynamics_derivatives(q: NQ, v: NV, tau: NV) -> (SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NV>);
            forward_dynamics_derivatives_into(q: NQ, v: NV, tau: NV, by_q: square, by_v: square, by_tau: square) -> SVector<Self::Scalar, NV>;
        }
    };
    (given_derivatives, $($how:tt)+) => {
        $crate::forward::write! { $($how)+;
            coriolis_matrix(q: NQ, v: NV) -> SMatrix<Self::Scalar, NV, NV>;
            inverse_dynamics_derivatives(q: NQ, v: NV, a: NV) -> (SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NV>);
            generalized_forces_derivatives(q: NQ, v: NV, u: NU) -> (SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NU>);
            generalized_momentum_derivatives(q: NQ, v: NV) -> SMatrix<Self::Scalar, NV, NV>;
            momentum_rate_derivatives(q: NQ, v: NV) -> (SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NV>);
        }
    };
    (second, $($how:tt)+) => {
        $crate::forward::write! { $($how)+;
            inverse_dynamics_second_derivatives(q: NQ, v: NV, a: NV, lambda: NV) -> $crate::SecondOrder<Self::Scalar, NV>;
            forward_dynamics_second_derivatives(q: NQ, v: NV, tau: NV, lambda: NV) -> $crate::SecondOrder<Self::Scalar, NV>;
            generalized_forces_second_derivatives(q: NQ, v: NV, u: NU, lambda: NV) -> $crate::InputSecondOrder<Self::Scalar, NV, NU>;
        }
    };
    (second_tangent, $($how:tt)+) => {
        $crate::forward::write! { $($how)+;
            tangent_rate_second_derivatives(dv: NV, v: NV, lambda: NV) -> (SMatrix<Self::Scalar, NV, NV>, SMatrix<Self::Scalar, NV, NV>);
        }
    };
    (methods, $($how:tt)+) => {
        $crate::forward::write! { $($how)+;
            project(q: NQ, v: NV) -> Result<$crate::constraint::Projected<Self::Scalar, NQ, NV>, $crate::ConstraintError>;
            impulse(q: NQ, v: NV, h: scalar, p: NV) -> SVector<Self::Scalar, NV>;
            is_nearly_singular(q: NQ, dv: NV) -> bool;
            acceleration_derivatives(q: NQ, v: NV, u: NU) -> Option<$crate::ByMotion<Self::Scalar, NV, NU>>;
            carry(q: NQ, dv: NV, v: NV) -> SVector<Self::Scalar, NV>;
            contact_start(q: NQ, parts: truth) -> Result<SVector<Self::Scalar, NQ>, $crate::ConstraintError>;
            contact_step(start: state, end: state, given: NV, h: scalar) -> Result<$crate::contact::Touched<Self::Scalar, NQ, NV>, $crate::ConstraintError>;
        }
    };
}

/// Defines functions that call those of a trait on an object: `plain` without time, `at` at a fixed time,
/// `drop` with an ignored time argument, `pass` with a forwarded time argument.
macro_rules! write_functions {
    (plain $trait:ident, $self:ident => $object:expr;
     $($name:ident($($argument:ident: $kind:ident),*) -> $result:ty;)+) => {$(
        #[inline(always)]
        fn $name(&$self $(, $argument: $crate::forward::kind!($kind))*) -> $result {
            $trait::$name($object $(, $argument)*)
        }
    )+};
    (at $trait:ident, $self:ident => $object:expr, $t:expr;
     $($name:ident($($argument:ident: $kind:ident),*) -> $result:ty;)+) => {$(
        #[inline(always)]
        fn $name(&$self $(, $argument: $crate::forward::kind!($kind))*) -> $result {
            $trait::$name($object, $t $(, $argument)*)
        }
    )+};
    (drop $trait:ident, $self:ident => $object:expr;
     $($name:ident($($argument:ident: $kind:ident),*) -> $result:ty;)+) => {$(
        #[inline(always)]
        fn $name(&$self, _t: Self::Scalar $(, $argument: $crate::forward::kind!($kind))*) -> $result {
            $trait::$name($object $(, $argument)*)
        }
    )+};
    (pass $trait:ident, $self:ident => $object:expr;
     $($name:ident($($argument:ident: $kind:ident),*) -> $result:ty;)+) => {$(
        #[inline(always)]
        fn $name(&$self, t: Self::Scalar $(, $argument: $crate::forward::kind!($kind))*) -> $result {
            $trait::$name($object, t $(, $argument)*)
        }
    )+};
}

/// Expands to the type of an argument.
macro_rules! kind {
    (scalar) => { Self::Scalar };
    (truth) => { bool };
    (square) => { &mut SMatrix<Self::Scalar, NV, NV> };
    (state) => { (&SVector<Self::Scalar, NQ>, &SVector<Self::Scalar, NV>) };
    ($n:ident) => { &SVector<Self::Scalar, $n> };
}

/// Writes the functions of [`Rheonomic`](crate::Rheonomic) that programs call as functions of a type itself,
/// which has them without that trait in scope: the prelude has the trait of mechanisms without time alone.
macro_rules! inherent_functions {
    (impl<$($lifetime:lifetime,)? $($parameter:ident),* $(; const $($size:ident),+)?> $type:ty) => {
        impl<$($lifetime,)? $($parameter,)* $($(const $size: usize,)+)?> $type {
            $crate::forward::inherent_functions! { @
                /// Returns the acceleration under the forces `tau`
                /// ([`Rheonomic::forward_dynamics`](crate::Rheonomic::forward_dynamics)).
                forward_dynamics(t: T, q: Q, v: V, tau: V) -> nalgebra::SVector<T, N>;
                /// Returns the forces that give the acceleration `a`
                /// ([`Rheonomic::inverse_dynamics`](crate::Rheonomic::inverse_dynamics)).
                inverse_dynamics(t: T, q: Q, v: V, a: V) -> nalgebra::SVector<T, N>;
                /// Returns the mass matrix ([`Rheonomic::mass_matrix`](crate::Rheonomic::mass_matrix)).
                mass_matrix(t: T, q: Q) -> nalgebra::SMatrix<T, N, N>;
                /// Returns the bias forces ([`Rheonomic::bias_forces`](crate::Rheonomic::bias_forces)).
                bias_forces(t: T, q: Q, v: V) -> nalgebra::SVector<T, N>;
                /// Returns the generalized forces of inputs
                /// ([`Rheonomic::generalized_forces`](crate::Rheonomic::generalized_forces)).
                generalized_forces(t: T, q: Q, v: V, u: U) -> nalgebra::SVector<T, N>;
                /// Returns the kinetic energy
                /// ([`Rheonomic::kinetic_energy`](crate::Rheonomic::kinetic_energy)).
                kinetic_energy(t: T, q: Q, v: V) -> T;
                /// Returns the potential energy
                /// ([`Rheonomic::potential_energy`](crate::Rheonomic::potential_energy)).
                potential_energy(t: T, q: Q) -> T;
                /// Returns the generalized momentum
                /// ([`Rheonomic::generalized_momentum`](crate::Rheonomic::generalized_momentum)).
                generalized_momentum(t: T, q: Q, v: V) -> nalgebra::SVector<T, N>;
                /// Returns the configuration after a displacement
                /// ([`Rheonomic::integrate`](crate::Rheonomic::integrate)).
                integrate(q: Q, dv: V) -> nalgebra::SVector<T, NQ>;
                /// Returns the displacement between configurations
                /// ([`Rheonomic::difference`](crate::Rheonomic::difference)).
                difference(from: Q, to: Q) -> nalgebra::SVector<T, N>;
            }

            /// Returns the acceleration under the forces `tau`, or why they determine none
            /// ([`Rheonomic::try_forward_dynamics`](crate::Rheonomic::try_forward_dynamics)).
            ///
            /// # Errors
            ///
            /// Those of [`Rheonomic::try_forward_dynamics`](crate::Rheonomic::try_forward_dynamics).
            pub fn try_forward_dynamics<T: $crate::Real, const NQ: usize, const N: usize, const NU: usize>(
                &self,
                t: T,
                q: &nalgebra::SVector<T, NQ>,
                v: &nalgebra::SVector<T, N>,
                tau: &nalgebra::SVector<T, N>,
            ) -> Result<nalgebra::SVector<T, N>, $crate::ConstraintError>
            where
                Self: $crate::Rheonomic<NQ, N, NU, Scalar = T>,
            {
                <Self as $crate::Rheonomic<NQ, N, NU>>::try_forward_dynamics(self, t, q, v, tau)
            }
        }
    };
    (@ $($(#[$docs:meta])* $name:ident($($argument:ident: $kind:ident),*) -> $result:ty;)+) => {$(
        $(#[$docs])*
        #[must_use]
        pub fn $name<T: $crate::Real, const NQ: usize, const N: usize, const NU: usize>(
            &self $(, $argument: $crate::forward::inherent_functions!(# $kind))*
        ) -> $result
        where
            Self: $crate::Rheonomic<NQ, N, NU, Scalar = T>,
        {
            <Self as $crate::Rheonomic<NQ, N, NU>>::$name(self $(, $argument)*)
        }
    )+};
    (# T) => { T };
    (# Q) => { &nalgebra::SVector<T, NQ> };
    (# V) => { &nalgebra::SVector<T, N> };
    (# U) => { &nalgebra::SVector<T, NU> };
}

pub(crate) use {each_function, inherent_functions, kind, write_functions as write};
