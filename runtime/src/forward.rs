//! Table of the functions of the mechanism traits. All forwarding implementations are generated from it:
//! those for references, for a mechanism at an instant, for stabilised mechanisms, and for lanes.
//!
//! A function added to the traits must be added to this table. Forwarding implementations enable the lint
//! `clippy::missing_trait_methods`, so that a missing function does not silently become its default.

/// Passes groups of rows `name(argument: kind, …) -> result` to a macro that defines a function for each row.
/// `space` has no argument of time, `dynamics` has; constraints and feedback change `accelerations`;
/// `methods` are those of `Hooks`, after which the scalar type is named (`contact_methods` excludes functions
/// that depend on how constraints are enforced). `tangent` and `derivatives` belong
/// to `Derivatives`, without and with an argument of time (`given_derivatives` excludes derivatives of
/// accelerations, `acceleration_derivatives`). Names with `inputless_` exclude functions of inputs. `second`
/// belongs to `SecondDerivatives`, as `second_tangent` does, which has no time. A kind is the length of a
/// vector, `scalar`, `state`, or `square` for a matrix that receives a result.
macro_rules! each_function {
    (space, $($how:tt)+) => {
        $crate::forward::write! { [Self::Scalar] $($how)+;
            neutral() -> $crate::nalgebra::SVector<Self::Scalar, NQ>;
            integrate(q: NQ, dv: NV) -> $crate::nalgebra::SVector<Self::Scalar, NQ>;
            difference(from: NQ, to: NQ) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
            tangent_rate(dv: NV, v: NV) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
            displacement_rate(q: NQ, dv: NV, v: NV) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
        }
    };
    (dynamics, $($how:tt)+) => {
        $crate::forward::each_function!(inputless_dynamics, $($how)+);
        $crate::forward::write! { [Self::Scalar] $($how)+;
            generalized_forces(q: NQ, v: NV, u: NU) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
        }
    };
    (inputless_dynamics, $($how:tt)+) => {
        $crate::forward::write! { [Self::Scalar] $($how)+;
            mass_matrix(q: NQ) -> $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>;
            bias_forces(q: NQ, v: NV) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
            inverse_dynamics(q: NQ, v: NV, a: NV) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
            kinetic_energy(q: NQ, v: NV) -> Self::Scalar;
            potential_energy(q: NQ) -> Self::Scalar;
            generalized_momentum(q: NQ, v: NV) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
            momentum_rate(q: NQ, v: NV) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
        }
    };
    (accelerations, $($how:tt)+) => {
        $crate::forward::write! { [Self::Scalar] $($how)+;
            forward_dynamics(q: NQ, v: NV, tau: NV) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
            try_forward_dynamics(q: NQ, v: NV, tau: NV) -> Result<$crate::nalgebra::SVector<Self::Scalar, NV>, $crate::ConstraintError>;
        }
    };
    (tangent, $($how:tt)+) => {
        $crate::forward::write! { [Self::Scalar] $($how)+;
            integrate_derivatives(dv: NV) -> ($crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>);
            tangent_rate_derivatives(dv: NV, v: NV) -> ($crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>);
            integrate_derivatives_at(q: NQ, dv: NV) -> ($crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>);
            displacement_rate_derivatives(q: NQ, dv: NV, v: NV) -> $crate::ByMotion<Self::Scalar, NV, NV>;
            turning(q: NQ, v: NV) -> $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>;
        }
    };
    (derivatives, $($how:tt)+) => {
        $crate::forward::each_function!(given_derivatives, $($how)+);
        $crate::forward::each_function!(acceleration_derivatives, $($how)+);
    };
    (acceleration_derivatives, $($how:tt)+) => {
        $crate::forward::write! { [Self::Scalar] $($how)+;
            forward_dynamics_derivatives(q: NQ, v: NV, tau: NV) -> ($crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>);
            forward_dynamics_derivatives_into(q: NQ, v: NV, tau: NV, by_q: square, by_v: square, by_tau: square) -> $crate::nalgebra::SVector<Self::Scalar, NV>;
        }
    };
    (given_derivatives, $($how:tt)+) => {
        $crate::forward::each_function!(inputless_derivatives, $($how)+);
        $crate::forward::write! { [Self::Scalar] $($how)+;
            generalized_forces_derivatives(q: NQ, v: NV, u: NU) -> ($crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NU>);
        }
    };
    (inputless_derivatives, $($how:tt)+) => {
        $crate::forward::write! { [Self::Scalar] $($how)+;
            coriolis_matrix(q: NQ, v: NV) -> $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>;
            inverse_dynamics_derivatives(q: NQ, v: NV, a: NV) -> ($crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>);
            generalized_momentum_derivatives(q: NQ, v: NV) -> $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>;
            momentum_rate_derivatives(q: NQ, v: NV) -> ($crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>);
        }
    };
    (second, $($how:tt)+) => {
        $crate::forward::write! { [Self::Scalar] $($how)+;
            inverse_dynamics_second_derivatives(q: NQ, v: NV, a: NV, lambda: NV) -> $crate::SecondOrder<Self::Scalar, NV>;
            forward_dynamics_second_derivatives(q: NQ, v: NV, tau: NV, lambda: NV) -> $crate::SecondOrder<Self::Scalar, NV>;
            generalized_forces_second_derivatives(q: NQ, v: NV, u: NU, lambda: NV) -> $crate::InputSecondOrder<Self::Scalar, NV, NU>;
        }
    };
    (second_tangent, $($how:tt)+) => {
        $crate::forward::write! { [Self::Scalar] $($how)+;
            tangent_rate_second_derivatives(dv: NV, v: NV, lambda: NV) -> ($crate::nalgebra::SMatrix<Self::Scalar, NV, NV>, $crate::nalgebra::SMatrix<Self::Scalar, NV, NV>);
        }
    };
    (methods, [$scalar:ty] $($how:tt)+) => {
        $crate::forward::write! { [$scalar] $($how)+;
            project(q: NQ, v: NV) -> Result<$crate::constraint::Projected<$scalar, NQ, NV>, $crate::ConstraintError>;
            velocity_change_by_impulse(q: NQ, v: NV, h: scalar, p: NV)
                -> $crate::nalgebra::SVector<$scalar, NV>;
            acceleration_derivatives(q: NQ, v: NV, u: NU) -> Option<$crate::ByMotion<$scalar, NV, NU>>;
        }
        $crate::forward::each_function!(contact_methods, [$scalar] $($how)+);
    };
    (contact_methods, [$scalar:ty] $($how:tt)+) => {
        $crate::forward::write! { [$scalar] $($how)+;
            is_nearly_singular(q: NQ, dv: NV) -> bool;
            carry(q: NQ, dv: NV, v: NV) -> $crate::nalgebra::SVector<$scalar, NV>;
            carry_rate(dv: NV, v: NV) -> $crate::nalgebra::SVector<$scalar, NV>;
            translation(dv: NV) -> $crate::nalgebra::SVector<$scalar, NV>;
            contact_start(q: NQ, parts: truth) -> Result<$crate::nalgebra::SVector<$scalar, NQ>, $crate::ConstraintError>;
            contact_step(start: state, end: state, given: assumed, h: scalar) -> Result<$crate::contact::Touched<$scalar, NQ, NV>, $crate::ConstraintError>;
        }
    };
}

/// Writes functions of a wrapper that call the trait functions of the same names on the wrapped object.
/// `plain` has no time argument, `pass` passes the argument on, and `at` passes the fixed time of the wrapper
/// instead.
macro_rules! write_functions {
    ([$scalar:ty] plain $trait:ident, $self:ident => $object:expr;
     $($name:ident($($argument:ident: $kind:ident),*) -> $result:ty;)+) => {$(
        #[inline(always)]
        fn $name(&$self $(, $argument: $crate::forward::kind!($scalar, $kind))*) -> $result {
            $trait::$name($object $(, $argument)*)
        }
    )+};
    ([$scalar:ty] at $trait:ident, $self:ident => $object:expr;
     $($name:ident($($argument:ident: $kind:ident),*) -> $result:ty;)+) => {$(
        #[inline(always)]
        fn $name(&$self, _t: $scalar $(, $argument: $crate::forward::kind!($scalar, $kind))*) -> $result {
            $trait::$name($object, $self.t $(, $argument)*)
        }
    )+};
    ([$scalar:ty] pass $trait:ident, $self:ident => $object:expr;
     $($name:ident($($argument:ident: $kind:ident),*) -> $result:ty;)+) => {$(
        #[inline(always)]
        fn $name(&$self, t: $scalar $(, $argument: $crate::forward::kind!($scalar, $kind))*) -> $result {
            $trait::$name($object, t $(, $argument)*)
        }
    )+};
}

/// Expands a short name of an argument kind, such as `scalar`, to the type of the argument.
macro_rules! kind {
    ($scalar:ty, scalar) => { $scalar };
    ($scalar:ty, truth) => { bool };
    ($scalar:ty, assumed) => { $crate::contact::Assumed<'_, $scalar, NV> };
    ($scalar:ty, square) => { &mut $crate::nalgebra::SMatrix<$scalar, NV, NV> };
    ($scalar:ty, state) => { (&$crate::nalgebra::SVector<$scalar, NQ>, &$crate::nalgebra::SVector<$scalar, NV>) };
    ($scalar:ty, $n:ident) => { &$crate::nalgebra::SVector<$scalar, $n> };
}

/// Defines `linear_motion` of a wrapper by the default implementation, because only wrappers without time
/// have it.
macro_rules! linear_motion {
    ($nq:ident, $nv:ident, $nu:ident) => {
        fn linear_motion(
            &self,
            q: &$crate::nalgebra::SVector<Self::Scalar, $nq>,
            v: &$crate::nalgebra::SVector<Self::Scalar, $nv>,
            u: &$crate::nalgebra::SVector<Self::Scalar, $nu>,
        ) -> $crate::LinearMotion<Self::Scalar, $nv, $nu>
        where
            Self: $crate::Scleronomic,
        {
            $crate::derivatives::linear_motion(self, q, v, u)
        }
    };
}

/// Defines the associated constants of a wrapper as those of the wrapped mechanism type: `names` of
/// `Mechanism`, `hooks` of `Hooks`, `derivatives` of `Derivatives`.
macro_rules! constants {
    (names, $m:ident) => {
        const CONFIGURATION: [&'static str; NQ] = $m::CONFIGURATION;
        const VELOCITIES: [&'static str; NV] = $m::VELOCITIES;
        const INPUTS: [&'static str; NU] = $m::INPUTS;
        const VELOCITY_UNITS: [&'static str; NV] = $m::VELOCITY_UNITS;
        const INPUT_UNITS: [&'static str; NU] = $m::INPUT_UNITS;
    };
    (hooks, $m:ident) => {
        const CONSTRAINED: bool = $m::CONSTRAINED;
        const SLIPPING: bool = $m::SLIPPING;
        const FEEDBACK: bool = $m::FEEDBACK;
        const CONTACTING: bool = $m::CONTACTING;
        const LOCATABLE: bool = $m::LOCATABLE;
        const FIRST_ORDER: usize = $m::FIRST_ORDER;
        const SPEEDS: bool = $m::SPEEDS;
    };
    (derivatives, $m:ident) => {
        const MOMENTUM_DERIVATIVES: bool = $m::MOMENTUM_DERIVATIVES;
        const DIRECT_INPUTS: Option<[usize; NU]> = $m::DIRECT_INPUTS;
        const TURNED: Option<(usize, usize)> = $m::TURNED;
    };
}

pub(crate) use {constants, each_function, kind, linear_motion, write_functions as write};
