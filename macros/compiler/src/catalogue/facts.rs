//! Facts about a mechanism on which its generated functions and their signatures depend.

use crate::mechanism::Model;
use crate::syntax::{RequestOption, RequestedFunctions};

/// Requirement that a mechanism must meet to have a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FunctionNeed {
    /// Met by mechanisms with masses and inertias.
    Inertia,
    /// The mechanism has constraints: loops, rolling or others.
    Constraints,
    /// The mechanism has no constraints.
    NoConstraints,
    /// The `#[mechanism]` attribute has this option.
    Asks(RequestOption),
    /// The mass matrix is invertible: no constraint determines a coordinate without inertia.
    RegularMass,
    /// The mechanism has constraints of sliding contacts with friction.
    Slipping,
    /// The mechanism has no constraints of sliding contacts with friction.
    NoSlipping,
    /// The mechanism has unilateral contacts.
    Contacts,
    /// Features of polytopes determine contacts.
    Polytopes,
    /// The mechanism has parameters.
    Parameters,
    /// Values of the robot file, such as inertias, are parameters of the struct.
    FileParameters,
    /// Inertial parameters of links of a file are parameters of the struct.
    FileInertials,
    /// The robot file places joints elsewhere than in the neutral configuration.
    InitialConfiguration,
    /// The mechanism declares equilibria.
    Equilibria,
    /// The mechanism has limits of coordinates.
    Limits,
    /// The ground has an expression for its height.
    Terrain,
    /// The derivatives of forward dynamics call other generated functions.
    Calls,
    /// The passive forces have a generated function that other functions call.
    PassiveCalls,
    /// The mechanism declares generalized speeds.
    Speeds,
    /// The mechanism declares no generalized speeds.
    NoSpeeds,
    /// The mechanism has no constraints, and few enough unilateral contacts for a generated function of their
    /// Delassus matrix.
    FewContacts,
}

impl FunctionNeed {
    /// Returns all needs, in the order in which they are reported as reasons.
    pub fn needs_in_reporting_order() -> impl Iterator<Item = FunctionNeed> {
        let rest = [
            FunctionNeed::NoConstraints,
            FunctionNeed::RegularMass,
            FunctionNeed::Speeds,
            FunctionNeed::NoSpeeds,
            FunctionNeed::Constraints,
            FunctionNeed::Slipping,
            FunctionNeed::NoSlipping,
            FunctionNeed::Contacts,
            FunctionNeed::Polytopes,
            FunctionNeed::Parameters,
            FunctionNeed::FileParameters,
            FunctionNeed::FileInertials,
            FunctionNeed::InitialConfiguration,
            FunctionNeed::Equilibria,
            FunctionNeed::Limits,
            FunctionNeed::Terrain,
            FunctionNeed::Calls,
            FunctionNeed::PassiveCalls,
            FunctionNeed::FewContacts,
        ];
        [FunctionNeed::Inertia].into_iter().chain(RequestOption::ALL.map(FunctionNeed::Asks)).chain(rest)
    }

    /// Returns the name of the runtime's trait that expresses the need in error messages, `None` for needs of
    /// hidden functions.
    pub fn trait_name_of_need(self) -> Option<&'static str> {
        Some(match self {
            FunctionNeed::Inertia => "HasInertia",
            FunctionNeed::Constraints => "HasConstraints",
            FunctionNeed::NoConstraints => "HasNoConstraints",
            FunctionNeed::Asks(word) => word.trait_for_missing_option(),
            FunctionNeed::RegularMass => "HasRegularMass",
            FunctionNeed::Speeds => "HasSpeeds",
            FunctionNeed::NoSpeeds => "HasNoSpeeds",
            FunctionNeed::Slipping => "HasSlipping",
            FunctionNeed::NoSlipping => "HasNoSlipping",
            FunctionNeed::Contacts => "HasContacts",
            FunctionNeed::Parameters => "HasParameters",
            FunctionNeed::FileParameters => "HasFileParameters",
            FunctionNeed::FileInertials => "HasFileInertials",
            FunctionNeed::Equilibria => "DeclaresEquilibria",
            FunctionNeed::InitialConfiguration
            | FunctionNeed::Limits
            | FunctionNeed::Terrain
            | FunctionNeed::Calls
            | FunctionNeed::PassiveCalls
            | FunctionNeed::FewContacts
            | FunctionNeed::Polytopes => return None,
        })
    }
}

/// Maximum number of contact velocities for which the Delassus matrix is generated. The length of its code is
/// proportional to the square of their number.
const FEW_CONTACT_RATES: usize = 36;

/// Facts about a mechanism on which the signatures of its functions depend.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// Number of configuration coordinates, `NQ`.
    pub nq: usize,
    /// Number of velocities, `NV`.
    pub nv: usize,
    /// Number of inputs, `NU`.
    pub nu: usize,
    /// True if functions take time as their first argument.
    pub time: bool,
    /// True if inputs act through the velocity.
    pub velocity_inputs: bool,
    /// True if forces depend on accelerations.
    pub acceleration_forces: bool,
    /// True if the mechanism has no dynamics.
    pub kinematic: bool,
    /// True if generalized speeds are declared.
    pub speeds: bool,
    /// Options of the `#[mechanism]` attribute.
    pub requests: RequestedFunctions,
    /// Facts about the constraints, if the mechanism has any.
    pub constraints: Option<ConstraintFacts>,
    /// True if the generated derivatives of forward dynamics call other functions.
    pub calls: bool,
    /// True if the linear system is assembled from the derivatives of forward dynamics.
    pub calls_linear: bool,
    /// Number of derivatives of the passive forces; `None` if the passive forces have no separate function.
    pub passive: Option<usize>,
    /// Number of bodies with standard inertial parameters.
    pub bodies: usize,
    /// Number of base parameters.
    pub base: usize,
    /// True if the robot file places joints elsewhere than in the neutral configuration.
    pub initial_configuration: bool,
    /// Number of declared equilibria.
    pub equilibria: usize,
    /// Number of cyclic coordinates that the option `routh` eliminates.
    pub cyclic: usize,
    /// Number of conserved quantities.
    pub conserved: usize,
    /// Numbers of unilateral contacts and contact velocities.
    pub contacts: ContactCounts,
    /// Number of pairs of polytopes whose features determine contacts.
    pub polytopes: usize,
    /// Number of bounds in the declared limits.
    pub limits: usize,
    /// Number of values in the declared drawing.
    pub drawing: usize,
    /// Number of height fields in the declared drawing.
    pub heights: usize,
    /// Number of values derived from parameters that must satisfy conditions.
    pub figures: usize,
    /// Number of parameters of the struct.
    pub parameters: usize,
    /// Row and column of the structurally nonzero entries in the lower triangle of the mass matrix, column by
    /// column.
    pub entries: Vec<(usize, usize)>,
}

/// Numbers of unilateral contacts and contact velocities.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactCounts {
    /// Number of contacts, `NK`.
    pub count: usize,
    /// Number of contact velocities, `NR`.
    pub rates: usize,
}

/// Facts about the constraints of a mechanism.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConstraintFacts {
    /// Number of constraints, `NC`.
    pub all: usize,
    /// Number of holonomic constraints, `NH`.
    pub holonomic: usize,
    /// Number of constraints of sliding contacts with friction.
    pub slipping: usize,
    /// True if some constraints are redundant in every configuration.
    pub overdetermined: bool,
    /// True if some constraints determine coordinates without inertia.
    pub determining: bool,
}

impl Facts {
    /// Returns the facts that follow from a model. Counts that only follow from the equations are zero.
    pub fn from_model(model: &Model<'_>, requests: RequestedFunctions) -> Facts {
        let constraints = (!model.constraints.is_empty()).then(|| ConstraintFacts {
            all: model.constraints.len(),
            holonomic: model.holonomic_count(),
            slipping: model.constraints.iter().filter(|c| !c.friction.is_empty()).count(),
            overdetermined: model.has_unpruned_redundancy(),
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
            contacts: ContactCounts { count: model.contacts.len(), rates: model.contact_rates().len() },
            polytopes: model.polytopes.len(),
            limits: model.coordinate_limit_bounds().len(),
            initial_configuration: model.initial_configuration.is_some(),
            equilibria: model.equilibria.len(),
            drawing: model.drawing_numbers().len(),
            heights: model.heights.len(),
            figures: model.requirement_values().len(),
            parameters: model.parameters.len(),
            ..Facts::default()
        }
    }

    /// Returns true if the mechanism meets a requirement of a function.
    pub fn meets_need(&self, need: FunctionNeed) -> bool {
        match need {
            FunctionNeed::Inertia => !self.kinematic,
            FunctionNeed::Constraints => self.constraints.is_some(),
            FunctionNeed::NoConstraints => self.constraints.is_none(),
            FunctionNeed::Asks(word) => self.requests.has_option(word),
            FunctionNeed::RegularMass => self.constraints.is_none_or(|c| !c.determining),
            FunctionNeed::Slipping => self.constraints.is_some_and(|c| c.slipping > 0),
            FunctionNeed::NoSlipping => self.constraints.is_none_or(|c| c.slipping == 0),
            FunctionNeed::Contacts => self.contacts.count > 0,
            FunctionNeed::Polytopes => self.polytopes > 0,
            FunctionNeed::Parameters => self.parameters > 0,
            FunctionNeed::FileParameters => self.requests.file_parameters,
            FunctionNeed::FileInertials => self.requests.file_inertials,
            FunctionNeed::InitialConfiguration => self.initial_configuration,
            FunctionNeed::Equilibria => self.equilibria > 0,
            FunctionNeed::Limits => self.limits > 0,
            FunctionNeed::Terrain => self.heights > 0,
            FunctionNeed::Speeds => self.speeds,
            FunctionNeed::NoSpeeds => !self.speeds,
            FunctionNeed::Calls => self.calls,
            FunctionNeed::PassiveCalls => self.passive.is_some(),
            FunctionNeed::FewContacts => {
                self.constraints.is_none() && (1..=FEW_CONTACT_RATES).contains(&self.contacts.rates)
            }
        }
    }
}
