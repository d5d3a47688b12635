//! Rows of the functions of the options `centroidal`, `hamilton`, `routh`, `conserved`, `regressor`,
//! `sensitivities` and `packed`.

use super::facts::FunctionNeed;
use super::row::{Declaration, GeneratedId, Row};
use super::shape::Argument::{A, Q, Tau, V};
use super::shape::{Argument, Shape};
use crate::syntax::RequestOption;

/// Number of standard inertial parameters of a body.
const STANDARD: usize = 10;

const CENTROIDAL_ASKED: &[FunctionNeed] =
    &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Centroidal)];
const HAMILTON: &[FunctionNeed] =
    &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Hamilton), FunctionNeed::RegularMass];
const ROUTH: &[FunctionNeed] =
    &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Routh), FunctionNeed::NoConstraints];
const CONSERVED: &[FunctionNeed] = &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Conserved)];
const REGRESSOR: &[FunctionNeed] = &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Regressor)];
const PACKED: &[FunctionNeed] = &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Packed)];

/// Rows of the functions of the option `centroidal`.
pub const CENTROIDAL: &[Row] = &[
    Row::derived_row(
        GeneratedId::CentroidalMomentumMatrix,
        "centroidal_momentum_matrix",
        CENTROIDAL_ASKED,
        |f| Declaration {
            arguments: vec![Q],
            shape: Shape::Matrix(6, f.nv),
            docs: vec![
                "Centroidal momentum matrix `A(q)`: [`momentum`](Self::momentum) is `A v`, linear part \
                 first, then angular about the centre of mass, in ground axes. For a mechanism with \
                 prescribed motion, `A v` is the contribution of the velocities.",
                "kg and kg·m for translations, kg·m and kg·m² for rotations (Orin, Goswami and Lee, \
                 *Centroidal dynamics of a humanoid robot*, 2013).",
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(
        GeneratedId::CentroidalMomentumBias,
        "centroidal_momentum_bias",
        CENTROIDAL_ASKED,
        |_| Declaration {
            arguments: vec![Q, V],
            shape: Shape::Vector(6),
            docs: vec![
                "`Ȧ v`: the rate of [`momentum`](Self::momentum) (N, then N·m about the centre of mass) at zero \
             accelerations. In every motion the rate of the momentum is `A v̇ + Ȧ v`.",
            ],
            ..Declaration::default()
        },
    ),
];

/// Rows of the functions of the options `hamilton`, `routh` and `conserved`.
pub const CANONICAL: &[Row] = &[
    Row::derived_row(GeneratedId::Hamiltonian, "hamiltonian", HAMILTON, |f| Declaration {
        arguments: vec![Q, Argument::Momenta(f.nv)],
        shape: Shape::Scalar,
        docs: vec![match f.time {
            true => {
                "Hamiltonian `H(q, p) = p·v − T + U`, J, of the \
                 [`generalized_momentum`](Self::generalized_momentum) `p`. With prescribed motion it differs \
                 from the energy."
            }
            false => {
                "Hamiltonian `H(q, p) = T + U`, J, of the \
                 [`generalized_momentum`](Self::generalized_momentum) `p`."
            }
        }],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::CanonicalVelocity, "canonical_velocity", HAMILTON, |f| Declaration {
        arguments: vec![Q, Argument::Momenta(f.nv)],
        shape: Shape::Vector(f.nv),
        docs: vec![
            "Hamilton's first equation: the velocity `v = ∂H/∂p` of a generalized momentum `p`, m/s and \
             rad/s. The inverse of [`generalized_momentum`](Self::generalized_momentum).",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::CanonicalMomentumRate, "canonical_momentum_rate", HAMILTON, |f| {
        Declaration {
            arguments: vec![Q, Argument::Momenta(f.nv), Tau],
            shape: Shape::Vector(f.nv),
            docs: vec![
                "Hamilton's second equation: `ṗ = −∂H/∂q + τ` plus passive forces without a potential, N and \
             N·m; for ball and free joints in body components (Lie and Poisson). Include constraint forces \
             in `tau`.",
            ],
            ..Declaration::default()
        }
    }),
    Row::derived_row(GeneratedId::Routhian, "routhian", ROUTH, |f| Declaration {
        arguments: vec![Q, V, Argument::Momenta(f.cyclic)],
        shape: Shape::Scalar,
        docs: vec![
            "Routhian `R = L − p·w`, J, as a function of the velocities of the noncyclic coordinates and of \
             the momenta `p` of the cyclic ones, in the order of `CYCLIC`. The velocities `w` of the cyclic \
             coordinates follow from `p`; their entries of `v` are not read.",
            "Lagrange's equations hold for it: Goldstein, Poole and Safko, *Classical Mechanics* (2002), § \
             8.3.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::CyclicVelocities, "cyclic_velocities", ROUTH, |f| Declaration {
        arguments: vec![Q, V, Argument::Momenta(f.cyclic)],
        shape: Shape::Vector(f.cyclic),
        docs: vec![
            "Velocities of the cyclic coordinates, m/s and rad/s, in the order of `CYCLIC`, as functions of \
             their momenta `p`: `w = −∂R/∂p`. Their entries of `v` are not read.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::ReducedAccelerations, "reduced_accelerations", ROUTH, |f| Declaration {
        arguments: vec![Q, V, Argument::Momenta(f.cyclic), Tau],
        shape: Shape::Vector(f.nv.saturating_sub(f.cyclic)),
        docs: vec![
            "Accelerations of the noncyclic coordinates, m/s² and rad/s², in their order in `v`: Routh's \
             equations with the forces `tau` and the momenta `p` of the cyclic coordinates, in the order of \
             `CYCLIC`. The rates of these momenta are their entries of `tau`. Entries of `v` of cyclic \
             coordinates are not read.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::Conserved, "conserved", CONSERVED, |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Vector(f.conserved),
        docs: vec![
            "The quantities listed in `CONSERVED`, which are constant in every motion without inputs: J for \
             energies, kg·m/s and kg·m²/s for momenta.",
        ],
        ..Declaration::default()
    }),
];

/// Rows of the functions of the options `regressor`, `sensitivities` and `packed`, and of the checks of
/// parameters.
pub const ROWS: &[Row] = &[
    Row::derived_row(GeneratedId::JointTorqueRegressor, "joint_torque_regressor", REGRESSOR, |f| {
        Declaration {
            arguments: vec![Q, V, A],
            shape: Shape::Matrix(f.nv, STANDARD * f.bodies),
            docs: vec![
                "Regressor `Y(q, v, a)`: without springs, friction and other elements, \
             [`inverse_dynamics`](Self::inverse_dynamics) is `Y π`, with the \
             [`standard_parameters`](Self::standard_parameters) `π`.",
                "Atkeson, An and Hollerbach, *Estimation of inertial parameters of manipulator loads and links* \
             (1986); columns as in Pinocchio.",
            ],
            ..Declaration::default()
        }
    }),
    Row::derived_row(GeneratedId::StandardParameters, "standard_parameters", REGRESSOR, |f| Declaration {
        timeless: true,
        shape: Shape::Vector(STANDARD * f.bodies),
        docs: vec![
            "The inertial parameters `π`: for each body of `BODIES`, including everything fixed to it, its \
             mass `m` (kg), first moment `m c` (x, y, z; kg·m) and inertia (xx, xy, yy, xz, yz, zz; kg·m²) \
             about the body's origin in its axes.",
        ],
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::BaseRegressor, "base_regressor", REGRESSOR, |f| Declaration {
        arguments: vec![Q, V, A],
        shape: Shape::Matrix(f.nv, f.base),
        docs: vec![
            "The regressor of the base parameters, whose columns are linearly independent: \
             `base_regressor(q, v, a) · base_parameters(π)` is `joint_torque_regressor(q, v, a) · π` for \
             every `π`.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::BaseParameters, "base_parameters", REGRESSOR, |f| Declaration {
        timeless: true,
        arguments: vec![Argument::Standard(STANDARD * f.bodies)],
        shape: Shape::Vector(f.base),
        docs: vec![
            "The base parameters for the standard parameters `π`: the minimum set of linear combinations \
             that determine the motion, which is all that can be identified from it.",
            "Inertial parameters that a joint's motion does not affect are transferred to the parent \
             (Gautier and Khalil, *Direct calculation of minimum set of inertial parameters of serial \
             robots*, 1990). Remaining linear dependencies are found numerically. If the geometry has \
             parameters, dependencies beyond those rules whose factors depend on the parameters are not \
             used.",
        ],
    }),
    Row::derived_row(
        GeneratedId::InverseDynamicsByParameters,
        "inverse_dynamics_by_parameters",
        &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Sensitivities)],
        |f| Declaration {
            arguments: vec![Q, V, A],
            shape: Shape::Matrix(f.nv, f.parameters),
            docs: vec![
                "`∂τ/∂p` of [`inverse_dynamics`](Self::inverse_dynamics): column `k` is the derivative by \
                 the parameter `PARAMETERS[k]`.",
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(
        GeneratedId::ForwardDynamicsByParameters,
        "forward_dynamics_by_parameters",
        &[
            FunctionNeed::Inertia,
            FunctionNeed::Asks(RequestOption::Sensitivities),
            FunctionNeed::NoConstraints,
        ],
        |f| Declaration {
            arguments: vec![Q, V, Tau],
            shape: Shape::Matrix(f.nv, f.parameters),
            docs: vec![
                "`∂v̇/∂p` of [`forward_dynamics`](Self::forward_dynamics): column `k` is the derivative by \
                 the parameter `PARAMETERS[k]`.",
                "`∂v̇/∂p = −M⁻¹ ∂τ/∂p` at `a = v̇`.",
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(
        GeneratedId::GeneralizedForcesByParameters,
        "generalized_forces_by_parameters",
        &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Sensitivities)],
        |f| Declaration {
            arguments: vec![Q, V, Argument::U],
            shape: Shape::Matrix(f.nv, f.parameters),
            docs: vec![
                "`∂τ/∂p` of the inputs' [`generalized_forces`](Self::generalized_forces): column `k` is the \
                 derivative by the parameter `PARAMETERS[k]`.",
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(GeneratedId::MassMatrixPacked, "mass_matrix_packed", PACKED, |f| Declaration {
        arguments: vec![Q],
        shape: Shape::Vector(f.entries.len()),
        docs: vec![
            "The entries of the [`mass_matrix`](Self::mass_matrix) in its lower triangle, column by column, \
             without those that are always zero: `MASS_MATRIX_ENTRIES[k]` holds row and column of entry `k`.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::MassMatrixInto, "mass_matrix_into", PACKED, |f| Declaration {
        arguments: vec![Q, Argument::Into("m", f.nv)],
        shape: Shape::Symmetric(f.nv),
        docs: vec![
            "Writes the [`mass_matrix`](Self::mass_matrix) to `m`, `NV` by `NV`. Entries that are always \
             zero are not written: initialise `m` with zeros once and pass it again in each call. \
             `MASS_MATRIX_ENTRIES` lists the entries that are written, on both sides of the diagonal.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::Figures, "__figures", &[FunctionNeed::Parameters], |f| Declaration {
        timeless: true,
        shape: Shape::Array(f.figures),
        ..Declaration::default()
    })
    .without_batched_variant(),
];
