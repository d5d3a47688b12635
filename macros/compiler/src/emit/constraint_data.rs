//! Constraints of a mechanism, as data for code generation.

use crate::mechanism::{DegreeOfFreedomCounts, Model};

/// Scalar constraints of a mechanism, as data for code generation.
#[derive(Clone, Debug, Default)]
pub struct Constraints {
    /// Names of the constraints; holonomic constraints come first.
    pub names: Vec<String>,
    /// Number of holonomic constraints.
    pub holonomic: usize,
    /// Group of each constraint; constraints of one group are components of one vector.
    pub groups: Vec<usize>,
    /// Names of rows of joints and constraints that are omitted because they depend on the others.
    pub redundant: Vec<String>,
    /// Numbers of independent coordinates and velocities of the constrained mechanism.
    pub freedom: DegreeOfFreedomCounts,
    /// Indices of the constraints whose multipliers are normal forces of sliding contacts with friction.
    pub slipping: Vec<usize>,
    /// Indices of the constraints that determine coordinates that may have no inertia.
    pub determining: Vec<usize>,
    /// True if some constraints depend on others in every admissible configuration, so that multipliers
    /// require least squares.
    pub overdetermined: bool,
    /// True if accelerations are eliminated to those of independent velocities, with pivots chosen at compile
    /// time.
    pub independent: bool,
    /// Indices of the entries of `q` that are angles.
    pub angles: Vec<usize>,
    /// Whether each velocity is an angular velocity.
    pub turns: Vec<bool>,
}

impl Constraints {
    /// Returns one unnamed constraint for a mechanism whose constraints are unknown because of an error; with
    /// `slips`, a constraint of a sliding contact.
    pub fn placeholder_constraints(slips: bool) -> Constraints {
        Constraints {
            names: vec![String::new()],
            holonomic: 1,
            groups: vec![0],
            redundant: Vec::new(),
            freedom: DegreeOfFreedomCounts::default(),
            slipping: slips.then_some(0).into_iter().collect(),
            determining: Vec::new(),
            overdetermined: false,
            independent: false,
            angles: Vec::new(),
            turns: Vec::new(),
        }
    }

    /// Returns the constraints of a model.
    pub fn from_model(model: &Model<'_>) -> Constraints {
        let indices_of_constraints = |is: fn(&crate::mechanism::Constraint<'_>) -> bool| {
            let all = model.constraints.iter().enumerate();
            all.filter(|(_, c)| is(c)).map(|(k, _)| k).collect()
        };
        Constraints {
            names: model.constraints.iter().map(|c| c.name.clone()).collect(),
            holonomic: model.holonomic_count(),
            redundant: model.redundant.clone(),
            freedom: model.freedom,
            groups: model.constraints.iter().map(|c| c.group).collect(),
            slipping: indices_of_constraints(|c| !c.friction.is_empty()),
            determining: indices_of_constraints(|c| c.determines),
            overdetermined: model.has_unpruned_redundancy(),
            independent: model.dependent.is_some(),
            angles: (0..model.nq()).filter(|k| model.units.configuration[*k] == "rad").collect(),
            turns: model.units.velocities.iter().map(|unit| unit == "rad/s").collect(),
        }
    }
}
