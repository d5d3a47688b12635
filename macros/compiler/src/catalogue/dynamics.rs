//! Rows of the catalogue for the functions that every mechanism has.

use super::facts::FunctionNeed;
use super::row::{Declaration, GeneratedId, Row};
use super::shape::Argument::{A, Q, Tau, U, V};
use super::shape::{Argument, CalledFunction, Shape};
use crate::mechanism::SuppliedQuantity;
use crate::syntax::RequestOption;

const INERTIA: &[FunctionNeed] = &[FunctionNeed::Inertia];

/// Need of the configuration in which a robot file places its bodies.
const PLACED: &[FunctionNeed] = &[FunctionNeed::InitialConfiguration];

/// Need of functions that a drawing reads.
const DRAWING: FunctionNeed = FunctionNeed::Asks(RequestOption::Drawing);

/// Needs of functions that invert the mass matrix without constraints.
const UNCONSTRAINED: &[FunctionNeed] = &[FunctionNeed::Inertia, FunctionNeed::NoConstraints];

/// Rows of the equations of motion, energies and powers, and of total mass, centre of mass and momentum.
pub const ROWS: &[Row] = &[
    Row::derived_row(GeneratedId::Neutral, "neutral", &[], |f| Declaration {
        timeless: true,
        shape: Shape::Vector(f.nq),
        docs: vec!["The configuration with zero coordinates and identity quaternions."],
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::InitialConfiguration, "initial_configuration", PLACED, |f| Declaration {
        timeless: true,
        shape: Shape::Vector(f.nq),
        docs: vec![
            "The configuration in the pose of the robot file: free bodies are where the file places them, \
             and a joint with a `ref` has this coordinate. The other coordinates are zero. m and rad.",
        ],
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::Limits, "__limits", &[FunctionNeed::Limits], |f| Declaration {
        timeless: true,
        shape: Shape::Array(f.limits),
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::Drawing, "drawing_numbers", &[DRAWING], |f| Declaration {
        timeless: true,
        shape: Shape::Array(f.drawing),
        docs: vec!["The numbers of [`DRAWING`](Self::DRAWING), m and rad, for the current parameters."],
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::Heights, "__drawing_heights", &[DRAWING, FunctionNeed::Terrain], |f| {
        Declaration {
            timeless: true,
            arguments: vec![Argument::Given("place", SuppliedQuantity::Position, 2)],
            shape: Shape::Array(f.heights),
            ..Declaration::default()
        }
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::MassMatrix, "mass_matrix", INERTIA, |f| Declaration {
        arguments: vec![Q],
        shape: Shape::Square(f.nv),
        docs: vec![
            match f.constraints.is_some_and(|c| c.determining) {
                true => {
                    "Mass matrix `M(q)`, symmetric positive semidefinite, both triangles: singular if \
                     coordinates without inertia are determined by constraints."
                }
                false => "Mass matrix `M(q)`, symmetric positive definite, both triangles.",
            },
            "Composite-rigid-body algorithm (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 6). \
             kg between translations, kg·m² between rotations, kg·m mixed.",
        ]
        .into_iter()
        .chain(f.acceleration_forces.then_some(
            "It contains only the bodies: forces that depend on \
                                                accelerations are part of \
                                                [`inverse_dynamics`](Self::inverse_dynamics).",
        ))
        .collect(),
        ..Declaration::default()
    })
    .with_trait_arguments(&[Q]),
    Row::derived_row(GeneratedId::BiasForces, "bias_forces", INERTIA, |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Vector(f.nv),
        docs: vec![
            "Bias forces `h(q, v)`: Coriolis and centrifugal forces, gravity, springs, dashpots, friction. N \
             for translations, N·m for rotations.",
            "Recursive Newton–Euler algorithm without accelerations.",
        ],
        ..Declaration::default()
    })
    .with_trait_arguments(&[Q, V]),
    Row::derived_row(GeneratedId::InverseDynamics, "inverse_dynamics", INERTIA, |f| Declaration {
        arguments: vec![Q, V, A],
        shape: Shape::Vector(f.nv),
        docs: vec![
            match f.acceleration_forces {
                true => {
                    "`τ = M(q) a + h(q, v) − C(q, v) a`: the forces (N) and torques (N·m) that cause the \
                         acceleration `a`, with the forces `C a` that depend on accelerations."
                }
                false => {
                    "`τ = M(q) a + h(q, v)`: the forces (N) and torques (N·m) that cause the \
                          acceleration `a`."
                }
            },
            "Recursive Newton–Euler algorithm (Featherstone 2008, ch. 5).",
        ],
        ..Declaration::default()
    })
    .with_trait_arguments(&[Q, V, A]),
    Row::derived_row(GeneratedId::ForwardDynamics, "forward_dynamics", UNCONSTRAINED, |f| Declaration {
        arguments: vec![Q, V, Tau],
        shape: Shape::Vector(f.nv),
        docs: match f.acceleration_forces {
            true => vec![
                "`v̇ = (M(q) − C(q, v))⁻¹ (τ − h(q, v))`: the acceleration under the forces `tau`, with the \
                 forces `C v̇` that depend on accelerations.",
                "Sparse triangular factorisation of `M − C`, which need not be symmetric. Not finite if one \
                 of its leading blocks, from the leaves to the root, is singular, which happens if forces \
                 that depend on accelerations outweigh the masses.",
            ],
            false => vec![
                "`v̇ = M(q)⁻¹ (τ − h(q, v))`: the acceleration under the forces `tau`. Not finite if `M(q)` \
                 is singular.",
                "Articulated-body algorithm, or sparse factorisation of `M`, whichever costs less \
                 (Featherstone 2008, ch. 6, 7).",
            ],
        },
        ..Declaration::default()
    })
    .with_trait_arguments(&[Q, V, Tau]),
    Row::derived_row(GeneratedId::GeneralizedForces, "generalized_forces", &[], |f| Declaration {
        arguments: if f.velocity_inputs { vec![Q, V, U] } else { vec![Q, U] },
        shape: Shape::Vector(f.nv),
        docs: vec![
            "Generalized forces `τ` of the inputs `u`, by virtual work: N for translations, N·m for \
             rotations.",
        ],
        ..Declaration::default()
    })
    .with_trait_arguments(&[Q, V, U]),
    Row::derived_row(GeneratedId::KineticEnergy, "kinetic_energy", INERTIA, |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Scalar,
        docs: vec![match f.time {
            true => {
                "Kinetic energy `T`, J. It is `½ vᵀ M v` only without prescribed motion, which adds terms of \
                 degree one and zero in `v`."
            }
            false => "Kinetic energy `T = ½ vᵀ M(q) v`, J.",
        }],
        ..Declaration::default()
    })
    .with_trait_arguments(&[Q, V]),
    Row::derived_row(GeneratedId::PotentialEnergy, "potential_energy", INERTIA, |_| Declaration {
        arguments: vec![Q],
        shape: Shape::Scalar,
        docs: vec!["Potential energy `U(q)` of gravity (zero at the ground's origin) and springs, J."],
        ..Declaration::default()
    })
    .with_trait_arguments(&[Q]),
    Row::derived_row(GeneratedId::GeneralizedMomentum, "generalized_momentum", INERTIA, |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Vector(f.nv),
        docs: vec![match f.time {
            true => {
                "Generalized momentum `p = ∂T/∂v`, kg·m/s for translations, kg·m²/s for rotations. It is `M \
                 v` only without prescribed motion."
            }
            false => "Generalized momentum `p = M(q) v`, kg·m/s for translations, kg·m²/s for rotations.",
        }],
        ..Declaration::default()
    })
    .with_trait_arguments(&[Q, V]),
    Row::derived_row(GeneratedId::MomentumRate, "momentum_rate", INERTIA, |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Vector(f.nv),
        docs: vec![
            "Rate of the generalized momentum without inputs, N for translations, N·m for rotations: `ṗ = \
             momentum_rate(q, v) + τ`.",
            "Hamilton's second equation; for ball and free joints in body components (Euler–Poincaré).",
        ]
        .into_iter()
        .chain(f.acceleration_forces.then_some(
            "Forces that depend on accelerations are not included and \
                                                must be added.",
        ))
        .collect(),
        ..Declaration::default()
    })
    .with_trait_arguments(&[Q, V]),
    Row::derived_row(GeneratedId::DissipatedPower, "dissipated_power", INERTIA, |_| {
        power_declaration(
            vec![Q, V],
            vec![
                "Power dissipated by dashpots, friction and dissipation functions, W.",
                "Unless the mechanism is driven in time, `d(T + U)/dt = control_power + disturbance_power − \
             dissipated_power`.",
            ],
        )
    }),
    Row::derived_row(GeneratedId::ControlPower, "control_power", INERTIA, |_| {
        power_declaration(vec![Q, V, U], vec!["Power of the inputs `u`, W."])
    }),
    Row::derived_row(GeneratedId::DisturbancePower, "disturbance_power", INERTIA, |f| {
        power_declaration(
            vec![Q, V],
            vec![match f.acceleration_forces {
                true => {
                    "Power of applied forces that are neither conservative nor dissipative nor inputs, W, \
                     without the power of forces that depend on accelerations."
                }
                false => {
                    "Power of applied forces that are neither conservative nor dissipative nor inputs, W."
                }
            }],
        )
    }),
    Row::derived_row(GeneratedId::TotalMass, "total_mass", INERTIA, |_| Declaration {
        timeless: true,
        shape: Shape::Scalar,
        docs: vec!["Mass of everything that moves, kg."],
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::CenterOfMass, "center_of_mass", INERTIA, |_| Declaration {
        arguments: vec![Q],
        shape: Shape::Vector(3),
        docs: vec!["Centre of mass of everything that moves, m, from the ground's origin in ground axes."],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::Momentum, "momentum", INERTIA, |_| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Vector(6),
        docs: vec![
            "Momentum in ground axes: linear (kg·m/s), then angular about the centre of mass (kg·m²/s).",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(
        GeneratedId::PassiveForces,
        CalledFunction::PassiveForces.function_name(),
        &[FunctionNeed::Inertia, FunctionNeed::PassiveCalls],
        |f| Declaration { arguments: vec![Q, V], shape: Shape::Vector(f.nv), ..Declaration::default() },
    ),
];

fn power_declaration(arguments: Vec<super::Argument>, docs: Vec<&'static str>) -> Declaration {
    Declaration { arguments, shape: Shape::Scalar, docs, ..Declaration::default() }
}
