//! A row of the catalogue: a function that can be generated.

use super::facts::{Facts, Need};
use super::shape::{Argument, Shape};

/// Names every function whose body follows from equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the rows say what each is")]
pub enum Id {
    Neutral,
    Limits,
    Drawing,
    Heights,
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
    ContactGaps,
    ContactRates,
    ContactJacobian,
    ContactBias,
    ContactLaws,
    ContactResponses,
    ContactDerivatives,
    CentroidalMomentumMatrix,
    CentroidalMomentumBias,
    Hamiltonian,
    CanonicalVelocity,
    CanonicalMomentumRate,
    Routhian,
    CyclicVelocities,
    ReducedAccelerations,
    Conserved,
    Output,
    OutputJacobian,
    OutputDerivatives,
    OutputByParameters,
    Reaction,
    Touched,
    MassMatrixInverse,
    CoriolisMatrix,
    InverseDynamicsDerivatives,
    GeneralizedMomentumDerivatives,
    MomentumRateDerivatives,
    ForwardDynamicsDerivatives,
    Linearize,
    AccelerationsAndInverse,
    InverseDynamicsDerivativesInto,
    ForwardDynamicsDerivativesInto,
    MotionDerivatives,
    InputDerivatives,
    InverseDynamicsSecondDerivatives,
    GeneralizedForcesSecondDerivatives,
    ConstraintCurvature,
    JointTorqueRegressor,
    StandardParameters,
    BaseRegressor,
    BaseParameters,
    InverseDynamicsByParameters,
    ForwardDynamicsByParameters,
    GeneralizedForcesByParameters,
    MassMatrixPacked,
    MassMatrixInto,
    Figures,
    RatesOfSpeeds,
    SpeedsOfRates,
    RateMatrix,
    SpeedMatrix,
    RateChanges,
    RateAccelerations,
    Turning,
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
    pub const fn derived(
        id: Id,
        name: &'static str,
        needs: &'static [Need],
        declare: fn(&Facts) -> Declaration,
    ) -> Row {
        Row { name, made: Made::Derived(id), needs, declare, in_trait: None, batched: true }
    }

    /// A function that is written as it is.
    pub const fn written(name: &'static str, needs: &'static [Need]) -> Row {
        let declare = |_: &Facts| Declaration::default();
        Row { name, made: Made::Written, needs, declare, in_trait: None, batched: false }
    }

    /// One of the runtime's trait of mechanisms, with these arguments there.
    pub const fn of_trait(self, arguments: &'static [Argument]) -> Row {
        Row { in_trait: Some(arguments), ..self }
    }

    /// One that depends on no state, or only serves others.
    pub const fn alone(self) -> Row {
        Row { batched: false, ..self }
    }

    /// One for several states, too.
    pub const fn and_batched(self) -> Row {
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
    pub fn declared(&self, id: Id, facts: &Facts) -> Declared {
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
