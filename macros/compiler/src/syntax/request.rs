//! Optional functions of a mechanism, requested by options of the attribute.

/// Equations printed in the documentation: `equations = word`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Printed {
    /// Lagrange's, if they are short enough to be readable.
    #[default]
    Readable,
    /// Lagrange's, even if they are long.
    Lagrange,
    /// Hamilton's.
    Hamilton,
    /// Kane's, in independent speeds.
    Kane,
    /// Routh's.
    Routh,
    /// Only their structure.
    Structure,
}

impl Printed {
    /// Options, with the equations that they select.
    pub const WORDS: [(&str, Printed); 5] = [
        ("lagrange", Printed::Lagrange),
        ("hamilton", Printed::Hamilton),
        ("kane", Printed::Kane),
        ("routh", Printed::Routh),
        ("structure", Printed::Structure),
    ];
}

/// Skipped passes: `skip_passes = [word, …]`. They affect the cost of functions, but not their results.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Whether link frames remain as described.
    pub frames: bool,
    /// Whether mass properties remain with their links.
    pub regroup: bool,
    /// Whether links that rotate about parallel axes are described in their own axes.
    pub parallel: bool,
    /// Whether SIMD lanes over identical limbs or over the joints of one path are disabled.
    pub limbs: bool,
}

/// One row for each option: the option, its variant, and its meaning.
macro_rules! words {
    ($($(#[$doc:meta])* $word:ident: $variant:ident,)+) => {
        /// An option that requests functions.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Word {
            $($(#[$doc])* $variant,)+
        }

        impl Word {
            /// All options.
            pub const ALL: [Word; [$(stringify!($word)),+].len()] = [$(Word::$variant),+];

            /// Returns the trait of the runtime that reports a missing option.
            pub const fn reason(self) -> &'static str {
                match self {
                    $(Word::$variant => concat!("AsksFor", stringify!($variant)),)+
                }
            }
        }

        /// Options as written.
        pub(super) const REQUESTS: [&str; Word::ALL.len()] = [$(stringify!($word)),+];

        /// Functions to generate in addition to those of every mechanism.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Requests {
            $($(#[$doc])* pub $word: bool,)+
            /// Whether values of a file are parameters.
            pub file_parameters: bool,
            /// Whether mass properties of links are among these parameters.
            pub file_inertials: bool,
            /// Whether only instructions of the compilation target are used.
            pub target_only: bool,
            /// Passes over the model to skip.
            pub skipped: Skipped,
            /// Equations to print.
            pub equations: Printed,
        }

        impl Requests {
            /// Whether an option is requested.
            pub fn has(&self, word: Word) -> bool {
                match word {
                    $(Word::$variant => self.$word,)+
                }
            }

            /// Returns the requests of the given options; second derivatives imply first derivatives.
            pub(super) fn from_options(given: impl Fn(&str) -> bool) -> Requests {
                let asked = Requests { $($word: given(stringify!($word)),)+ ..Requests::default() };
                let further = asked.second_derivatives || asked.momentum_derivatives;
                Requests { derivatives: asked.derivatives || further, ..asked }
            }
        }
    };
}

words! {
    /// First derivatives of the dynamics.
    derivatives: Derivatives,
    /// First and second derivatives of the dynamics.
    second_derivatives: SecondDerivatives,
    /// First derivatives, and derivatives of momenta and of their rates.
    momentum_derivatives: MomentumDerivatives,
    /// Centroidal momentum matrix and its bias.
    centroidal: Centroidal,
    /// Energy and canonical equations as functions of configuration and momentum.
    hamilton: Hamilton,
    /// Motion without cyclic coordinates, in terms of their momenta.
    routh: Routh,
    /// Conserved quantities.
    conserved: Conserved,
    /// Dynamics as linear functions of the mass properties.
    regressor: Regressor,
    /// Derivatives of the dynamics by the parameters.
    sensitivities: Sensitivities,
    /// Mass matrix without its structural zeros.
    packed: Packed,
    /// A second struct with precomputed values that depend only on the parameters.
    prepare: Prepare,
    /// Functions of several states at once, in SIMD lanes.
    batch: Batch,
    /// Drawing of the mechanism.
    drawing: Drawing,
}
