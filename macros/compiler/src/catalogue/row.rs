//! A row of the catalogue: a function that can be generated.

use super::facts::{Facts, FunctionNeed};
use super::shape::{Argument, Shape};

/// Identifiers of all functions that are derived from equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the rows say what each is")]
pub enum GeneratedId {
    Neutral,
    InitialConfiguration,
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
    ContactDerivativesByParameters,
    PolytopePoses,
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
    /// A private helper of handwritten functions: a step from a link or frame to the next, or the constants
    /// of a prepared mechanism.
    Part,
}

/// Origin of the body of a catalogued function.
#[derive(Clone, Copy)]
pub enum FunctionBodyOrigin {
    /// Body derived from equations, which the identifier selects.
    Derived(GeneratedId),
    /// Handwritten body, which calls other functions and the runtime.
    Written,
}

/// A row of the catalogue: name, origin and signature of a function that can be generated.
#[derive(Clone, Copy)]
pub struct Row {
    /// Name of the catalogued function.
    pub name: &'static str,
    /// Origin of the catalogued function's body.
    pub made: FunctionBodyOrigin,
    /// Requirements of the function. The first requirement that is not met is reported as the reason for its
    /// absence.
    pub needs: &'static [FunctionNeed],
    /// Returns arguments, result and documentation for a mechanism with these facts.
    pub declare: fn(&Facts) -> Declaration,
    /// Arguments of the function in the runtime's mechanism trait, if the trait has the function. The
    /// inherent function takes only the arguments that it needs.
    pub in_trait: Option<&'static [Argument]>,
    /// True if the option `batch` adds a variant for several states.
    pub batched: bool,
}

/// Arguments, result and documentation of a function for one mechanism.
#[derive(Default)]
pub struct Declaration {
    /// Arguments. For mechanisms that are driven in time, time is prepended.
    pub arguments: Vec<Argument>,
    /// True if the function depends on the parameters alone, and never takes time.
    pub timeless: bool,
    /// Shape of the function's result.
    pub shape: Shape,
    /// Documentation of the function, one entry per paragraph. Empty for a hidden function.
    pub docs: Vec<&'static str>,
}

/// Function that one mechanism has, with its signature.
#[derive(Clone, Debug)]
pub struct DeclaredFunction {
    /// Identifier of the function in the catalogue.
    pub id: GeneratedId,
    /// Name of the generated function.
    pub name: String,
    /// Documentation of the function, one entry per paragraph. Empty for a hidden function.
    pub docs: Vec<String>,
    /// Arguments of the generated method, without `&self`.
    pub arguments: Vec<Argument>,
    /// Shape of the function's result.
    pub shape: Shape,
}

impl Row {
    /// Creates a row of a function that is derived from equations and has a batched variant.
    pub const fn derived_row(
        id: GeneratedId,
        name: &'static str,
        needs: &'static [FunctionNeed],
        declare: fn(&Facts) -> Declaration,
    ) -> Row {
        Row { name, made: FunctionBodyOrigin::Derived(id), needs, declare, in_trait: None, batched: true }
    }

    /// Creates the row of a handwritten function.
    pub const fn handwritten_row(name: &'static str, needs: &'static [FunctionNeed]) -> Row {
        let empty_declaration = |_: &Facts| Declaration::default();
        Row {
            name,
            made: FunctionBodyOrigin::Written,
            needs,
            declare: empty_declaration,
            in_trait: None,
            batched: false,
        }
    }

    /// Adds the function to the runtime's mechanism trait, with these arguments in the trait.
    pub const fn with_trait_arguments(self, arguments: &'static [Argument]) -> Row {
        Row { in_trait: Some(arguments), ..self }
    }

    /// Removes the batched variant: the function depends on no state, or is a helper.
    pub const fn without_batched_variant(self) -> Row {
        Row { batched: false, ..self }
    }

    /// Returns the row with a variant that evaluates several states.
    pub const fn with_batched_variant(self) -> Row {
        Row { batched: true, ..self }
    }

    /// Returns the first need that a mechanism does not meet, `None` if it has the function.
    pub fn first_unmet_need(&self, facts: &Facts) -> Option<FunctionNeed> {
        self.needs.iter().copied().find(|need| !facts.meets_need(*need))
    }

    /// Returns true for a function that only generated code calls.
    pub fn is_hidden(&self) -> bool {
        self.name.starts_with("__")
    }

    /// Returns the declaration of the function for a mechanism with these facts.
    pub fn declare_function(&self, id: GeneratedId, facts: &Facts) -> DeclaredFunction {
        let Declaration { arguments, timeless, shape, docs } = (self.declare)(facts);
        let time = (facts.time && !timeless).then_some(Argument::T);
        DeclaredFunction {
            id,
            name: self.name.to_string(),
            docs: docs.into_iter().map(ToString::to_string).collect(),
            arguments: time.into_iter().chain(arguments).collect(),
            shape,
        }
    }
}
