//! What a mechanism asks for by words among the attribute's arguments, beside the functions that every
//! mechanism has.

/// Which equations are printed: `equations = word`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Printed {
    /// Lagrange's, if they are short enough to be read.
    #[default]
    Readable,
    /// Lagrange's, also where they are long.
    Lagrange,
    /// Hamilton's.
    Hamilton,
    /// Kane's, in independent speeds.
    Kane,
    /// Routh's.
    Routh,
    /// Their structure alone.
    Structure,
}

impl Printed {
    /// The words that ask for others than the readable ones.
    pub const WORDS: [(&str, Printed); 5] = [
        ("lagrange", Printed::Lagrange),
        ("hamilton", Printed::Hamilton),
        ("kane", Printed::Kane),
        ("routh", Printed::Routh),
        ("structure", Printed::Structure),
    ];
}

/// The passes that are left out: `skip_passes = [word, …]`. No function depends on them, only what it costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Link frames stay where they are described.
    pub frames: bool,
    /// Mass properties stay with their links.
    pub regroup: bool,
    /// Links that turn about parallel axes are described in their own axes.
    pub parallel: bool,
    /// Neither alike limbs nor joints of one path are lanes.
    pub limbs: bool,
}

/// One row for each word: the word, its variant, and what it asks for.
macro_rules! words {
    ($($(#[$doc:meta])* $word:ident: $variant:ident,)+) => {
        /// A word that asks for functions.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Word {
            $($(#[$doc])* $variant,)+
        }

        impl Word {
            /// All words.
            pub const ALL: [Word; [$(stringify!($word)),+].len()] = [$(Word::$variant),+];

            /// The trait of the runtime that says that a mechanism lacks it.
            pub const fn reason(self) -> &'static str {
                match self {
                    $(Word::$variant => concat!("AsksFor", stringify!($variant)),)+
                }
            }
        }

        /// The words as they are written.
        pub(super) const REQUESTS: [&str; Word::ALL.len()] = [$(stringify!($word)),+];

        /// What is generated beside the functions of every mechanism.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Requests {
            $($(#[$doc])* pub $word: bool,)+
            /// Figures of a file are parameters.
            pub file_parameters: bool,
            /// Mass properties of links are among them.
            pub file_inertials: bool,
            /// No instructions beside those of the compilation's target.
            pub target_only: bool,
            /// Passes over the model that are left out.
            pub skipped: Skipped,
            /// Which equations are printed.
            pub equations: Printed,
        }

        impl Requests {
            /// Whether a word is among them.
            pub fn has(&self, word: Word) -> bool {
                match word {
                    $(Word::$variant => self.$word,)+
                }
            }

            /// Those of words that are given; the second derivatives of something need the first.
            pub(super) fn of_words(given: impl Fn(&str) -> bool) -> Requests {
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
    /// Second derivatives, too.
    second_derivatives: SecondDerivatives,
    /// Derivatives of momenta and of their rates, too.
    momentum_derivatives: MomentumDerivatives,
    /// The matrix of the momentum, and its bias.
    centroidal: Centroidal,
    /// Energy and canonical equations as functions of configuration and momentum.
    hamilton: Hamilton,
    /// Motion without cyclic coordinates, by their momenta.
    routh: Routh,
    /// Quantities that keep their values.
    conserved: Conserved,
    /// The dynamics as linear functions of the mass properties.
    regressor: Regressor,
    /// Derivatives of the dynamics by the parameters.
    sensitivities: Sensitivities,
    /// The mass matrix without its zeros.
    packed: Packed,
    /// A second struct that holds what depends on the parameters alone.
    prepare: Prepare,
    /// Functions of several states at once, in lanes.
    batch: Batch,
    /// What it looks like.
    drawing: Drawing,
}
