//! What signatures depend on.

use crate::mechanism::Model;
use crate::syntax::{Requests, Word};

/// What a function needs of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Masses and inertias.
    Inertia,
    /// Loops, rolling or other constraints.
    Constraints,
    /// None of those.
    NoConstraints,
    /// A word of the attribute.
    Asks(Word),
    /// A mass matrix that can be inverted: constraints determine no coordinates without inertia.
    RegularMass,
    /// Contacts that slip.
    Slipping,
    /// None of those.
    NoSlipping,
    /// Contacts that open and close.
    Contacts,
    /// Parameters.
    Parameters,
    /// Figures of a file that are parameters.
    FileParameters,
    /// Mass properties of links among them.
    FileInertials,
    /// Declared equilibria.
    Equilibria,
    /// Limits of coordinates.
    Limits,
    /// Ground whose height is an expression.
    Terrain,
    /// Derivatives of forward dynamics by calls of other functions.
    Calls,
    /// Passive forces that the other functions call.
    PassiveCalls,
    /// Declared speeds.
    Speeds,
    /// None of those.
    NoSpeeds,
    /// Contacts of a tree, few enough for a function of how the mechanism answers to them.
    FewContacts,
}

impl Need {
    /// All of them, those first that come before others as a reason.
    pub fn all() -> impl Iterator<Item = Need> {
        let rest = [
            Need::NoConstraints,
            Need::RegularMass,
            Need::Speeds,
            Need::NoSpeeds,
            Need::Constraints,
            Need::Slipping,
            Need::NoSlipping,
            Need::Contacts,
            Need::Parameters,
            Need::FileParameters,
            Need::FileInertials,
            Need::Equilibria,
            Need::Limits,
            Need::Terrain,
            Need::Calls,
            Need::PassiveCalls,
            Need::FewContacts,
        ];
        [Need::Inertia].into_iter().chain(Word::ALL.map(Need::Asks)).chain(rest)
    }

    /// The trait of the runtime that says so. None for what only others call.
    pub fn reason(self) -> Option<&'static str> {
        Some(match self {
            Need::Inertia => "HasInertia",
            Need::Constraints => "HasConstraints",
            Need::NoConstraints => "HasNoConstraints",
            Need::Asks(word) => word.reason(),
            Need::RegularMass => "HasRegularMass",
            Need::Speeds => "HasSpeeds",
            Need::NoSpeeds => "HasNoSpeeds",
            Need::Slipping => "HasSlipping",
            Need::NoSlipping => "HasNoSlipping",
            Need::Contacts => "HasContacts",
            Need::Parameters => "HasParameters",
            Need::FileParameters => "HasFileParameters",
            Need::FileInertials => "HasFileInertials",
            Need::Equilibria => "DeclaresEquilibria",
            Need::Limits | Need::Terrain | Need::Calls | Need::PassiveCalls | Need::FewContacts => {
                return None;
            }
        })
    }
}

/// The most rates of contacts for which all that impulses do is written out: what is written grows with their square.
const FEW_CONTACT_RATES: usize = 36;

/// What signatures of a mechanism depend on.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// `NQ`.
    pub nq: usize,
    /// `NV`.
    pub nv: usize,
    /// `NU`.
    pub nu: usize,
    /// Functions take time first.
    pub time: bool,
    /// Inputs act by way of the velocity.
    pub velocity_inputs: bool,
    /// Forces depend on accelerations.
    pub acceleration_forces: bool,
    /// There are no dynamics.
    pub kinematic: bool,
    /// Speeds were declared.
    pub speeds: bool,
    /// The words of the attribute.
    pub requests: Requests,
    /// Its constraints, if there are any.
    pub constraints: Option<ConstraintFacts>,
    /// The derivatives of forward dynamics call other functions.
    pub calls: bool,
    /// The linear system is made of them.
    pub calls_linear: bool,
    /// Where the passive forces are long enough for a function of their own: how many derivatives of theirs there are.
    pub passive: Option<usize>,
    /// How many bodies have standard parameters.
    pub bodies: usize,
    /// How many base parameters there are.
    pub base: usize,
    /// How many equilibria are declared.
    pub equilibria: usize,
    /// How many coordinates are cyclic, of those that the word `routh` eliminates.
    pub cyclic: usize,
    /// How many quantities are conserved.
    pub conserved: usize,
    /// The contacts that open and close.
    pub contacts: ContactSizes,
    /// How many bounds limits have.
    pub limits: usize,
    /// How many numbers the drawing has.
    pub drawing: usize,
    /// How many terrains the drawing has.
    pub heights: usize,
    /// How many figures follow from parameters and fulfil conditions.
    pub figures: usize,
    /// How many parameters the struct has.
    pub parameters: usize,
    /// Row and column of the entries of the mass matrix in its lower triangle that are not always zero, column by column.
    pub entries: Vec<(usize, usize)>,
}

/// The contacts that open and close.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactSizes {
    /// `NK`.
    pub count: usize,
    /// `NR`.
    pub rates: usize,
}

/// What they depend on where there are constraints.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConstraintFacts {
    /// `NC`.
    pub all: usize,
    /// `NH`: how many are on configurations.
    pub holonomic: usize,
    /// How many belong to contacts that slip.
    pub slipping: usize,
    /// Some follow from others everywhere.
    pub overdetermined: bool,
    /// Some determine coordinates without inertia.
    pub determining: bool,
}

impl Facts {
    /// What a model says; counts that only the equations tell are left at zero.
    pub fn of(model: &Model<'_>, requests: Requests) -> Facts {
        let constraints = (!model.constraints.is_empty()).then(|| ConstraintFacts {
            all: model.constraints.len(),
            holonomic: model.holonomic(),
            slipping: model.constraints.iter().filter(|c| !c.friction.is_empty()).count(),
            overdetermined: model.is_overdetermined(),
            determining: model.constraints.iter().any(|c| c.determines),
        });
        Facts {
            nq: model.nq(),
            nv: model.nv(),
            nu: model.nu(),
            time: model.time,
            velocity_inputs: model.velocity_inputs,
            acceleration_forces: !model.acceleration_forces.is_empty(),
            kinematic: model.kinematic,
            speeds: model.speeds.is_some(),
            requests,
            constraints,
            contacts: ContactSizes { count: model.contacts.len(), rates: model.contact_rates().len() },
            limits: model.limit_values().len(),
            equilibria: model.equilibria.len(),
            drawing: model.drawing_numbers().len(),
            heights: model.heights.len(),
            figures: model.figures().len(),
            parameters: model.parameters.len(),
            ..Facts::default()
        }
    }

    /// True if the mechanism has what is needed.
    pub fn meet(&self, need: Need) -> bool {
        match need {
            Need::Inertia => !self.kinematic,
            Need::Constraints => self.constraints.is_some(),
            Need::NoConstraints => self.constraints.is_none(),
            Need::Asks(word) => self.requests.has(word),
            Need::RegularMass => self.constraints.is_none_or(|c| !c.determining),
            Need::Slipping => self.constraints.is_some_and(|c| c.slipping > 0),
            Need::NoSlipping => self.constraints.is_none_or(|c| c.slipping == 0),
            Need::Contacts => self.contacts.count > 0,
            Need::Parameters => self.parameters > 0,
            Need::FileParameters => self.requests.file_parameters,
            Need::FileInertials => self.requests.file_inertials,
            Need::Equilibria => self.equilibria > 0,
            Need::Limits => self.limits > 0,
            Need::Terrain => self.heights > 0,
            Need::Speeds => self.speeds,
            Need::NoSpeeds => !self.speeds,
            Need::Calls => self.calls,
            Need::PassiveCalls => self.passive.is_some(),
            Need::FewContacts => {
                self.constraints.is_none() && (1..=FEW_CONTACT_RATES).contains(&self.contacts.rates)
            }
        }
    }
}
