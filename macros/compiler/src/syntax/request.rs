//! Optional functions of a mechanism, requested by options of the attribute.

/// Equations of motion printed in the documentation, by the option `equations = word`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EquationsOption {
    /// Prints Lagrange's equations if they are short enough to be readable.
    #[default]
    Readable,
    /// Prints Lagrange's equations even if they are long.
    Lagrange,
    /// Prints Hamilton's equations.
    Hamilton,
    /// Prints Kane's equations in independent generalized speeds.
    Kane,
    /// Prints Routh's equations.
    Routh,
    /// Prints only the structure of the equations of motion.
    Structure,
}

impl EquationsOption {
    /// Values of the option `equations`, with the equations that they select.
    pub const WORDS: [(&str, EquationsOption); 5] = [
        ("lagrange", EquationsOption::Lagrange),
        ("hamilton", EquationsOption::Hamilton),
        ("kane", EquationsOption::Kane),
        ("routh", EquationsOption::Routh),
        ("structure", EquationsOption::Structure),
    ];
}

/// Compiler passes skipped by `skip_passes = [word, …]`. Skipping affects the cost of the generated
/// functions, but not their results.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SkippedPasses {
    /// Whether the pass that moves link frames is skipped, so that the frames remain as described.
    pub frames: bool,
    /// Whether the pass that regroups mass properties is skipped, so that they remain with their links.
    pub regroup: bool,
    /// Whether links that rotate about parallel axes are described in their own axes.
    pub parallel: bool,
    /// Whether vectorisation is skipped: no SIMD lanes over identical limbs or over the joints of one path.
    pub limbs: bool,
}

/// Defines the options that request functions: each row has the option, its enum variant and its meaning.
macro_rules! words {
    ($($(#[$doc:meta])* $word:ident: $variant:ident,)+) => {
        /// Option of `#[mechanism(…)]` that requests additional functions.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum RequestOption {
            $($(#[$doc])* $variant,)+
        }

        impl RequestOption {
            /// All options of `#[mechanism]` that request functions.
            pub const ALL: [RequestOption; [$(stringify!($word)),+].len()] = [$(RequestOption::$variant),+];

            /// Returns the trait of the runtime that reports a missing option.
            pub const fn trait_for_missing_option(self) -> &'static str {
                match self {
                    $(RequestOption::$variant => concat!("AsksFor", stringify!($variant)),)+
                }
            }
        }

        /// Names of the options that request functions, as written in `#[mechanism(…)]`.
        pub(super) const REQUESTS: [&str; RequestOption::ALL.len()] = [$(stringify!($word)),+];

        /// Options of `#[mechanism]`: the functions that it requests in addition to those of every mechanism,
        /// and options of parameters, arithmetic, passes and printed equations.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct RequestedFunctions {
            $($(#[$doc])* pub $word: bool,)+
            /// Whether values of an imported robot file become parameters of the mechanism.
            pub file_parameters: bool,
            /// Whether mass properties of links are among these parameters.
            pub file_inertials: bool,
            /// Whether only the functions are derived that evaluate a separate contact.
            pub separate_contact: bool,
            /// Whether code uses only instructions of the compilation target, without dispatch.
            pub target_only: bool,
            /// Whether results have the same bits on every machine, and in C.
            pub reproducible: bool,
            /// Compiler passes over the model that are skipped.
            pub skipped: SkippedPasses,
            /// Equations of motion that are printed in the documentation.
            pub equations: EquationsOption,
        }

        impl RequestedFunctions {
            /// Returns whether the option that requests certain functions is set.
            pub fn has_option(&self, word: RequestOption) -> bool {
                match word {
                    $(RequestOption::$variant => self.$word,)+
                }
            }

            /// Returns the requests of the given options; second derivatives imply first derivatives.
            pub(super) fn from_options(given: impl Fn(&str) -> bool) -> RequestedFunctions {
                let asked = RequestedFunctions {
                    $($word: given(stringify!($word)),)+
                    ..RequestedFunctions::default()
                };
                let further = asked.second_derivatives || asked.momentum_derivatives;
                RequestedFunctions { derivatives: asked.derivatives || further, ..asked }
            }
        }
    };
}

words! {
    /// Option that requests the first derivatives of the dynamics.
    derivatives: Derivatives,
    /// Option that requests the first and second derivatives of the dynamics.
    second_derivatives: SecondDerivatives,
    /// Option that requests first derivatives of the dynamics, and derivatives of momenta and of their time
    /// derivatives.
    momentum_derivatives: MomentumDerivatives,
    /// Option that requests the centroidal momentum matrix and its bias.
    centroidal: Centroidal,
    /// Option that requests the energy and the canonical equations as functions of configuration and
    /// momentum.
    hamilton: Hamilton,
    /// Option that requests Routh's equations: motion without cyclic coordinates, in terms of the momenta of
    /// those coordinates.
    routh: Routh,
    /// Option that requests the conserved quantities of the mechanism.
    conserved: Conserved,
    /// Option that requests the dynamics as linear functions of inertial parameters.
    regressor: Regressor,
    /// Option that requests derivatives of the dynamics with respect to the parameters.
    sensitivities: Sensitivities,
    /// Option that requests the mass matrix without its structural zeros.
    packed: Packed,
    /// Option that requests a second struct with precomputed values that depend only on the parameters.
    prepare: Prepare,
    /// Option that requests functions of several states in SIMD lanes.
    batch: Batch,
    /// Option that requests a drawing of the mechanism.
    drawing: Drawing,
}
