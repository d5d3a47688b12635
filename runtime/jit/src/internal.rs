//! Functions of a loaded mechanism that the runtime calls.

macro_rules! internal {
    ($($function:ident = $name:literal,)*) => {
        /// Functions of the mechanism that the runtime calls by index.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum InternalFunction {
            $($function,)*
        }

        /// Names of the functions that the runtime calls, in the order of [`InternalFunction`].
        pub(crate) const INTERNAL: &[&str] = &[$($name,)*];
    };
}

internal! {
    Neutral = "neutral",
    Integrate = "integrate",
    Difference = "difference",
    DisplacementRate = "displacement_rate",
    RatesOfSpeeds = "rates_of_speeds",
    SpeedsOfRates = "speeds_of_rates",
    RateMatrix = "__rate_matrix",
    SpeedMatrix = "__speed_matrix",
    RateChanges = "__rate_changes",
    Turning = "__turning",
    MassMatrix = "mass_matrix",
    BiasForces = "bias_forces",
    ForwardDynamics = "forward_dynamics",
    InverseDynamics = "inverse_dynamics",
    GeneralizedForces = "generalized_forces",
    KineticEnergy = "kinetic_energy",
    PotentialEnergy = "potential_energy",
    GeneralizedMomentum = "generalized_momentum",
    MomentumRate = "momentum_rate",
    CoriolisMatrix = "coriolis_matrix",
    InverseDynamicsDerivatives = "inverse_dynamics_derivatives",
    ForwardDynamicsDerivatives = "forward_dynamics_derivatives",
    GeneralizedForcesDerivatives = "generalized_forces_derivatives",
    GeneralizedMomentumDerivatives = "generalized_momentum_derivatives",
    MomentumRateDerivatives = "momentum_rate_derivatives",
    ConstraintResiduals = "constraint_residuals",
    ConstraintRates = "constraint_rates",
    ConstraintJacobian = "constraint_jacobian",
    ConstraintBias = "constraint_bias",
    ConstrainedDynamics = "__constrained_dynamics",
    ConstraintCorrection = "__constraint_correction",
    SlippingResponse = "__slipping_response",
    MotionDerivatives = "__motion_derivatives",
    ContactGaps = "contact_gaps",
    ContactRates = "contact_rates",
    ContactJacobian = "contact_jacobian",
    ContactBias = "contact_bias",
    ContactLaws = "__contact_laws",
    ContactResponses = "__contact_responses",
    ContactDerivatives = "__contact_derivatives",
    InverseDynamicsSecondDerivatives = "inverse_dynamics_second_derivatives",
    GeneralizedForcesSecondDerivatives = "generalized_forces_second_derivatives",
    ConstraintCurvature = "__constraint_curvature",
    DrawingHeights = "__drawing_heights",
}
