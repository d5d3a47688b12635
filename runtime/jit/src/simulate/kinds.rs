//! Integration methods without contacts, in one type for adaptive methods and one for methods with fixed
//! steps. rustc compiles the loop of a simulation once for each type, instead of once for each method.

use super::method;
use linkwork::integrate::{
    DormandPrince, DormandPrince8, Dynamics, Error, ImplicitMidpoint, Jump, Method, Rk4, Rodas, Rosenbrock,
    SemiImplicitEuler, State, Step,
};

/// Defines an enum of integration methods, and an enum of the methods with their memories.
macro_rules! method_kind {
    ($(#[$about:meta])* $kind:ident, $memory:ident, $fixed:literal, [$($method:ident),*]) => {
        $(#[$about])*
        #[derive(Clone, Copy)]
        pub(super) enum $kind {
            $($method($method<f64>),)*
        }

        /// Method with its memory.
        #[derive(Clone, Debug)]
        pub(super) enum $memory<const NV: usize> {
            $($method($method<f64>, <$method<f64> as Method<f64>>::Memory<NV>),)*
        }

        const _: () = assert!($(<$method<f64> as Method<f64>>::FIXED == $fixed)&&*);

        impl Method<f64> for $kind {
            type Memory<const NV: usize> = $memory<NV>;

            const FIXED: bool = $fixed;

            fn check(&self) -> Result<(), Error> {
                match self {
                    $($kind::$method(method) => method.check(),)*
                }
            }

            fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV> {
                match self {
                    $($kind::$method(method) => $memory::$method(*method, method.initial_memory::<NV>()),)*
                }
            }

            fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump) {
                match memory {
                    $($memory::$method(method, memory) => {
                        method.discard_memory_after_jump::<NV>(memory, jump)
                    })*
                }
            }

            fn advance<D: Dynamics<f64, NQ, NV>, const NQ: usize, const NV: usize>(
                &self,
                memory: &mut Self::Memory<NV>,
                system: &mut D,
                start: &State<f64, NQ, NV>,
                until: Option<f64>,
                dense: bool,
            ) -> Result<Step<f64, NQ, NV>, Error> {
                match memory {
                    $($memory::$method(method, memory) => {
                        method.advance(memory, system, start, until, dense)
                    })*
                }
            }
        }
    };
}

method_kind!(
    /// Method that adapts its steps to a tolerance.
    AdaptiveMethod, AdaptiveMemory, false, [DormandPrince, DormandPrince8, Rodas]
);
method_kind!(
    /// Method with steps of a fixed size.
    FixedStepMethod, FixedStepMemory, true, [Rk4, ImplicitMidpoint, Rosenbrock, SemiImplicitEuler]
);

/// Method of a simulation without contacts.
pub(super) enum MethodWithoutContacts {
    Adaptive(AdaptiveMethod),
    FixedStep(FixedStepMethod),
}

impl MethodWithoutContacts {
    /// Returns the method with its settings. Methods for contacts are replaced by those that they use between
    /// contacts, and the automatic choice by [`DormandPrince`].
    pub(super) fn new(method: method::Method) -> Self {
        use method::Method;
        match method {
            Method::Automatic(e) | Method::DormandPrince(e) => {
                Self::Adaptive(AdaptiveMethod::DormandPrince(DormandPrince::new().tolerance(e, e)))
            }
            Method::DormandPrince8(e) | Method::EventDriven(e) => {
                Self::Adaptive(AdaptiveMethod::DormandPrince8(DormandPrince8::new().tolerance(e, e)))
            }
            Method::Rodas(e) => Self::Adaptive(AdaptiveMethod::Rodas(Rodas::new().tolerance(e, e))),
            Method::Rk4(h)
            | Method::TimeStepping(h)
            | Method::TimeSteppingMidpoint(h)
            | Method::TimeSteppingLeapfrog(h) => Self::FixedStep(FixedStepMethod::Rk4(Rk4::step(h))),
            Method::ImplicitMidpoint(h) => {
                Self::FixedStep(FixedStepMethod::ImplicitMidpoint(ImplicitMidpoint::step(h)))
            }
            Method::Rosenbrock(h) => Self::FixedStep(FixedStepMethod::Rosenbrock(Rosenbrock::step(h))),
            Method::SemiImplicitEuler(h) => {
                Self::FixedStep(FixedStepMethod::SemiImplicitEuler(SemiImplicitEuler::step(h)))
            }
        }
    }
}
