//! Everything that can be generated for a mechanism, a row for each function: its name, arguments, result and documentation,
//! what it needs, and whether it belongs to the trait. What is generated, what is missing and why, which names are taken
//! and what stands in for the functions of a mechanism with a mistake all follow from these rows. `derive` has the equations
//! of each by its [`Id`], without an arm for the rest: a row without equations does not compile.

mod constants;
mod constraints;
mod derivatives;
mod dynamics;
mod facts;
mod outputs;
mod requested;
mod shape;
mod written;

pub use constants::{absent_constants, is_constant};
pub use facts::{ConstraintFacts, Facts, Need};
pub use outputs::{JACOBIAN, REACTION, output, reaction};
pub use shape::{Argument, Called, InverseForm, Record, RecordField, Shape, Structure};

/// Names every function whose body follows from equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the rows say what each is")]
pub enum Id {
    Neutral,
    MassMatrix,
    BiasForces,
    InverseDynamics,
    ForwardDynamics,
    GeneralizedForces,
    KineticEnergy,
    PotentialEnergy,
    GeneralizedMomentum,
    MomentumRate,
    DissipatedPower,
    ControlPower,
    DisturbancePower,
    TotalMass,
    CenterOfMass,
    Momentum,
    ConstraintResiduals,
    ConstraintRates,
    ConstraintJacobian,
    ConstraintBias,
    ConstraintResponse,
    ConstrainedDynamics,
    SlippingResponse,
    CentroidalMomentumMatrix,
    CentroidalMomentumBias,
    Output,
    OutputJacobian,
    Reaction,
    MassMatrixInverse,
    CoriolisMatrix,
    InverseDynamicsDerivatives,
    ForwardDynamicsDerivatives,
    Linearize,
    AccelerationsAndInverse,
    InverseDynamicsDerivativesInto,
    ForwardDynamicsDerivativesInto,
    MotionDerivatives,
    InputDerivatives,
    JointTorqueRegressor,
    StandardParameters,
    BaseRegressor,
    BaseParameters,
    InverseDynamicsByParameters,
    ForwardDynamicsByParameters,
    MassMatrixPacked,
    MassMatrixInto,
    PassiveForces,
    PassiveDerivatives,
    /// A step from a link or frame to the next, or the numbers of a prepared mechanism: private parts of what is written.
    Part,
}

/// How a function comes about.
#[derive(Clone, Copy)]
pub enum Made {
    /// From equations.
    Derived(Id),
    /// By a body that calls others and the runtime, written as it is.
    Written,
}

/// A function that can be generated.
#[derive(Clone, Copy)]
pub struct Row {
    /// Its name.
    pub name: &'static str,
    /// How it comes about.
    pub made: Made,
    /// What it needs; the first of these that is missing is the reason why it is.
    pub needs: &'static [Need],
    /// What it is for a mechanism with these facts.
    pub declare: fn(&Facts) -> Declaration,
    /// Its arguments in the runtime's trait of mechanisms, if it belongs to it: the inherent function takes what it needs.
    pub in_trait: Option<&'static [Argument]>,
    /// The word `batch` has it for several states.
    pub batched: bool,
}

/// Arguments, result and documentation of a function.
#[derive(Default)]
pub struct Declaration {
    /// Arguments after time, which functions of a mechanism that is driven in time take first.
    pub arguments: Vec<Argument>,
    /// It depends on the parameters alone: there is no time among its arguments.
    pub timeless: bool,
    /// Result.
    pub shape: Shape,
    /// Documentation, a paragraph each; none for a hidden function.
    pub docs: Vec<&'static str>,
}

/// A function with its signature.
#[derive(Clone, Debug)]
pub struct Declared {
    /// Which it is.
    pub id: Id,
    /// Its name.
    pub name: String,
    /// Documentation, a paragraph each; none for a hidden function.
    pub docs: Vec<String>,
    /// Arguments after `&self`.
    pub arguments: Vec<Argument>,
    /// Result.
    pub shape: Shape,
}

impl Row {
    /// A function of equations that several states have as well.
    const fn derived(
        id: Id,
        name: &'static str,
        needs: &'static [Need],
        declare: fn(&Facts) -> Declaration,
    ) -> Row {
        Row { name, made: Made::Derived(id), needs, declare, in_trait: None, batched: true }
    }

    /// A function that is written as it is.
    const fn written(name: &'static str, needs: &'static [Need]) -> Row {
        let declare = |_: &Facts| Declaration::default();
        Row { name, made: Made::Written, needs, declare, in_trait: None, batched: false }
    }

    /// One of the runtime's trait of mechanisms, with these arguments there.
    const fn of_trait(self, arguments: &'static [Argument]) -> Row {
        Row { in_trait: Some(arguments), ..self }
    }

    /// One that depends on no state, or only serves others.
    const fn alone(self) -> Row {
        Row { batched: false, ..self }
    }

    /// One for several states, too.
    const fn and_batched(self) -> Row {
        Row { batched: true, ..self }
    }

    /// What is missing for it first; `None` if it is there.
    pub fn lacks(&self, facts: &Facts) -> Option<Need> {
        self.needs.iter().copied().find(|need| !facts.meet(*need))
    }

    /// True for a function that only others call.
    pub fn is_hidden(&self) -> bool {
        self.name.starts_with("__")
    }

    /// The function for a mechanism with these facts.
    fn declared(&self, id: Id, facts: &Facts) -> Declared {
        let Declaration { arguments, timeless, shape, docs } = (self.declare)(facts);
        let time = (facts.time && !timeless).then_some(Argument::T);
        Declared {
            id,
            name: self.name.to_string(),
            docs: docs.into_iter().map(ToString::to_string).collect(),
            arguments: time.into_iter().chain(arguments).collect(),
            shape,
        }
    }
}

/// The rows in the order in which functions are generated: outputs come between both lists.
const TABLES: [&[Row]; 7] = [
    dynamics::ROWS,
    constraints::ROWS,
    requested::CENTROIDAL,
    derivatives::ROWS,
    requested::ROWS,
    written::CONSTRAINED,
    written::ROWS,
];

/// How many of the tables stand before the outputs.
const BEFORE_OUTPUTS: usize = 3;

/// All rows.
pub fn rows() -> impl Iterator<Item = &'static Row> {
    TABLES.into_iter().flatten()
}

fn declared(tables: &[&'static [Row]], facts: &Facts) -> Vec<Declared> {
    let present = tables.iter().copied().flatten().filter(|row| row.lacks(facts).is_none());
    let derived = present.filter_map(|row| match row.made {
        Made::Derived(id) => Some(row.declared(id, facts)),
        Made::Written => None,
    });
    derived.collect()
}

/// The functions of a mechanism whose bodies follow from equations: those that stand before its outputs.
pub fn before_outputs(facts: &Facts) -> Vec<Declared> {
    declared(&TABLES[..BEFORE_OUTPUTS], facts)
}

/// The functions of a mechanism whose bodies follow from equations: those that stand after its outputs.
pub fn after_outputs(facts: &Facts) -> Vec<Declared> {
    declared(&TABLES[BEFORE_OUTPUTS..], facts)
}

/// The functions of the runtime's trait of mechanisms that depend on the state, with their arguments there and their results.
pub fn of_trait() -> impl Iterator<Item = (&'static Row, &'static [Argument])> {
    dynamics::ROWS.iter().filter_map(|row| Some((row, row.in_trait?)))
}

/// What a mechanism with these facts lacks, by what it would need for it, in the order of the needs.
pub fn absent(facts: &Facts) -> Vec<(Need, Vec<&'static Row>)> {
    let of = |need: Need| {
        // Another row may have the function after all.
        let is_there = |row: &Row| rows().any(|r| r.name == row.name && r.lacks(facts).is_none());
        let all = rows().filter(|row| !row.is_hidden() && row.lacks(facts) == Some(need) && !is_there(row));
        let mut found: Vec<&'static Row> = Vec::new();
        for row in all {
            if found.iter().all(|known| known.name != row.name) {
                found.push(row);
            }
        }
        (need, found)
    };
    Need::ALL.into_iter().map(of).collect()
}

/// The functions that are written for several states, too.
pub fn written_in_lanes(facts: &Facts) -> impl Iterator<Item = &'static str> {
    let written = rows().filter(|row| row.batched && matches!(row.made, Made::Written));
    written.filter(|row| row.lacks(facts).is_none()).map(|row| row.name)
}

/// True if a mechanism with these facts has a function of this name beside its outputs.
pub fn has(name: &str, facts: &Facts) -> bool {
    let mut present = rows().filter(|row| row.lacks(facts).is_none());
    let one = name.strip_suffix("_lanes").filter(|_| facts.requests.batch);
    present.any(|row| row.name == name || (row.batched && Some(row.name) == one))
}
