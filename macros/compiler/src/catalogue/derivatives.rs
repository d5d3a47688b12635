//! Rows of the catalogue for the functions of the option `derivatives`.

use super::facts::{Facts, FunctionNeed};
use super::row::{Declaration, GeneratedId, Row};
use super::shape::Argument::{A, Q, Tau, U, V};
use super::shape::{Argument, CalledFunction, Record, Shape};
use crate::mechanism::SuppliedQuantity;
use crate::syntax::RequestOption;

const TANGENT: &str = "Column `i` of a derivative by `q` is along `q ⊕ ε eᵢ` (see `integrate`); for ball and \
                       free joints this is a motion in body axes.";
const KEPT: &str = "Entries that are always zero are not written: initialise the matrices with zeros once \
                    and pass them again in each call. No large value is moved.";

const ASKED: &[FunctionNeed] = &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives)];
const UNCONSTRAINED: &[FunctionNeed] =
    &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives), FunctionNeed::NoConstraints];
const CONSTRAINED: &[FunctionNeed] =
    &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives), FunctionNeed::Constraints];

/// Rows of the catalogue for the first derivatives of the dynamics.
pub const ROWS: &[Row] = &[
    Row::derived_row(
        GeneratedId::MassMatrixInverse,
        "mass_matrix_inverse",
        &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives), FunctionNeed::RegularMass],
        |f| Declaration {
            arguments: vec![Q],
            shape: Shape::Inverse(f.nv),
            docs: vec![
                "Inverse of the mass matrix, `∂v̇/∂τ`. Not finite if `M(q)` is singular.",
                "By the sparse factorisation `M = Lᵀ D L` (Featherstone 2008, ch. 6).",
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(GeneratedId::CoriolisMatrix, "coriolis_matrix", ASKED, |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Square(f.nv),
        docs: vec![
            "A matrix `C(q, v)` with `C v` the Coriolis and centrifugal forces and `Ṁ − 2 C` skew.",
            "Echeandia and Wensing, *Numerical methods to compute the Coriolis matrix and Christoffel \
             symbols* (2021).",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::InverseDynamicsDerivatives, "inverse_dynamics_derivatives", ASKED, |f| {
        Declaration {
            arguments: vec![Q, V, A],
            shape: Shape::Pair(f.nv),
            docs: vec![
                "`(∂τ/∂q, ∂τ/∂v)` of [`inverse_dynamics`](Self::inverse_dynamics); `∂τ/∂a` is the mass matrix.",
                TANGENT,
                "Singh, Russell and Wensing, *Efficient analytical derivatives of rigid-body dynamics using \
             spatial vector algebra* (2022).",
            ],
            ..Declaration::default()
        }
    }),
    Row::derived_row(
        GeneratedId::ForwardDynamicsDerivatives,
        "forward_dynamics_derivatives",
        UNCONSTRAINED,
        |f| Declaration {
            arguments: vec![Q, V, Tau],
            shape: forward_dynamics_derivatives_shape(f),
            docs: vec![
                "`(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂τ)` of [`forward_dynamics`](Self::forward_dynamics); the last is \
                 `M⁻¹`.",
                TANGENT,
                "`∂v̇/∂x = −M⁻¹ ∂τ/∂x` at `a = v̇` (Carpentier and Mansard, *Analytical derivatives of rigid \
                 body dynamics algorithms*, 2018). For a large mechanism it calls other functions; the \
                 operation counts then exclude the calls and the products of their results.",
                "The motion of a mechanism with a free base, in the axes of the base, does not depend on the \
                 linear velocity of the base, and depends on its orientation only through the components of \
                 uniform gravity. If the ground exerts no other force, these six columns are exact.",
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(GeneratedId::Linearize, "linearize", UNCONSTRAINED, |f| Declaration {
        arguments: vec![Q, V, U],
        shape: if f.calls_linear { Shape::CalledLinear(f.nv, f.nu) } else { Shape::Linear(f.nv, f.nu) },
        docs: vec![
            "Returns `(A, B)` of `ẋ = A x + B δu`, the motion linearised about `q`, `v` and the inputs `u`, \
             at the instant; `x` holds the displacement `δq` with `q ⊕ δq`, then `δv`.",
            TANGENT,
            "`δq̇` is `δv`, and for ball and free joints `δv + δq × v`.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(
        GeneratedId::AccelerationsAndInverse,
        "__accelerations_and_inverse",
        &[
            FunctionNeed::Inertia,
            FunctionNeed::Asks(RequestOption::Derivatives),
            FunctionNeed::NoConstraints,
            FunctionNeed::Calls,
        ],
        |f| Declaration {
            arguments: vec![Q, V, Tau, Argument::Into("inverse", f.nv)],
            shape: Shape::Accelerated(f.nv),
            ..Declaration::default()
        },
    ),
    Row::derived_row(
        GeneratedId::InverseDynamicsDerivativesInto,
        "inverse_dynamics_derivatives_into",
        ASKED,
        |f| Declaration {
            arguments: vec![Q, V, A, Argument::Into("by_q", f.nv), Argument::Into("by_v", f.nv)],
            shape: Shape::Pair(f.nv),
            docs: vec![
                "Writes [`inverse_dynamics_derivatives`](Self::inverse_dynamics_derivatives) to `by_q` and \
                 `by_v`, `NV` by `NV` each.",
                KEPT,
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(
        GeneratedId::ForwardDynamicsDerivativesInto,
        "forward_dynamics_derivatives_into",
        &[FunctionNeed::Inertia, FunctionNeed::NoConstraints, FunctionNeed::Asks(RequestOption::Derivatives)],
        |f| Declaration {
            arguments: [
                vec![Q, V, Tau],
                ["by_q", "by_v", "inverse"].map(|name| Argument::Into(name, f.nv)).to_vec(),
            ]
            .concat(),
            shape: forward_dynamics_derivatives_shape(f),
            docs: vec![
                "Writes [`forward_dynamics_derivatives`](Self::forward_dynamics_derivatives) to `by_q`, \
                 `by_v` and `inverse`, `NV` by `NV` each. Returns the accelerations, which equal \
                 [`forward_dynamics`](Self::forward_dynamics) up to rounding.",
                KEPT,
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(GeneratedId::MotionDerivatives, "__motion_derivatives", CONSTRAINED, |f| {
        let nc = constraint_row_count(f);
        Declaration {
            arguments: vec![Q, V, A, Argument::Given("lambda", SuppliedQuantity::Multiplier, nc)],
            shape: Shape::Record(Record::MotionDerivatives(f.nv, nc)),
            ..Declaration::default()
        }
    })
    .without_batched_variant(),
    Row::derived_row(
        GeneratedId::PassiveDerivatives,
        CalledFunction::PassiveDerivatives.function_name(),
        &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives), FunctionNeed::PassiveCalls],
        |f| Declaration {
            arguments: vec![Q, V],
            shape: Shape::Vector(f.passive.unwrap_or(0)),
            ..Declaration::default()
        },
    ),
    Row::derived_row(GeneratedId::InputDerivatives, "__input_derivatives", ASKED, |f| Declaration {
        arguments: vec![Q, V, U],
        shape: Shape::Record(Record::InputDerivatives(f.nv, f.nu)),
        ..Declaration::default()
    })
    .without_batched_variant(),
];

const MOMENTA: &[FunctionNeed] =
    &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::MomentumDerivatives)];

/// Rows of the catalogue for the derivatives of momenta.
pub const MOMENTUM_ROWS: &[Row] = &[
    Row::derived_row(
        GeneratedId::GeneralizedMomentumDerivatives,
        "generalized_momentum_derivatives",
        MOMENTA,
        |f| Declaration {
            arguments: vec![Q, V],
            shape: Shape::Square(f.nv),
            docs: vec![
                "`∂p/∂q` of [`generalized_momentum`](Self::generalized_momentum); `∂p/∂v` is the mass \
                 matrix.",
                TANGENT,
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(GeneratedId::MomentumRateDerivatives, "momentum_rate_derivatives", MOMENTA, |f| {
        Declaration {
            arguments: vec![Q, V],
            shape: Shape::Pair(f.nv),
            docs: vec![
                "`(∂ṗ/∂q, ∂ṗ/∂v)` of [`momentum_rate`](Self::momentum_rate).",
                TANGENT,
                "Derivatives of Hamilton's second equation, which occur in the Jacobians of discrete steps that \
             are implicit in momenta.",
            ],
            ..Declaration::default()
        }
    }),
];

const SECOND: &[FunctionNeed] =
    &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::SecondDerivatives)];
const SYMMETRIC: &str = "Along `q ⊕ ε dq` the function changes by `½ ε² dqᵀ H dq` beyond the first order, \
                         with `H` the first matrix; for ball and free joints `dq` is a motion in body axes.";

/// Rows of the catalogue for the second derivatives of the dynamics.
pub const SECOND_ROWS: &[Row] = &[
    Row::derived_row(
        GeneratedId::InverseDynamicsSecondDerivatives,
        "inverse_dynamics_second_derivatives",
        SECOND,
        |f| Declaration {
            arguments: vec![Q, V, A, Argument::Factors(f.nv)],
            shape: Shape::Hessian(f.nv),
            docs: vec![
                "`(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂a)` of `λᵀ τ`, with `τ` by \
                 [`inverse_dynamics`](Self::inverse_dynamics): the Hessians of its entries, contracted with \
                 the factors `lambda`. Rows of mixed derivatives belong to `q`. All others are zero.",
                SYMMETRIC,
                "Computed by recursion, like the first derivatives, if motion subspaces are constant in link \
                 axes (Singh, Russell and Wensing, *Second-order derivatives of rigid-body dynamics*, 2023).",
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(
        GeneratedId::GeneralizedForcesSecondDerivatives,
        "generalized_forces_second_derivatives",
        SECOND,
        |f| Declaration {
            arguments: vec![Q, V, U, Argument::Factors(f.nv)],
            shape: Shape::InputPowerHessian(f.nv, f.nu),
            docs: vec![
                "`(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂u, ∂²/∂v∂u, ∂²/∂u∂u)` of `λᵀ τ`, with `τ` the \
                 [`generalized_forces`](Self::generalized_forces) of the inputs: the Hessians of its \
                 entries, contracted with the factors `lambda`.",
                SYMMETRIC,
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(
        GeneratedId::ConstraintCurvature,
        "__constraint_curvature",
        &[
            FunctionNeed::Inertia,
            FunctionNeed::Asks(RequestOption::SecondDerivatives),
            FunctionNeed::Constraints,
            FunctionNeed::NoSlipping,
        ],
        |f| {
            let nc = constraint_row_count(f);
            Declaration {
                arguments: vec![
                    Q,
                    V,
                    A,
                    Argument::Given("lambda", SuppliedQuantity::Multiplier, nc),
                    Argument::Given("w", SuppliedQuantity::Direction, f.nv),
                    Argument::Given("z", SuppliedQuantity::AccelerationFactor, nc),
                    Argument::Given("y", SuppliedQuantity::VelocityFactor, nc),
                ],
                shape: Shape::Record(Record::ConstraintCurvature(f.nv, nc)),
                ..Declaration::default()
            }
        },
    )
    .without_batched_variant(),
];

fn constraint_row_count(f: &Facts) -> usize {
    f.constraints.map(|c| c.all).unwrap_or_default()
}

fn forward_dynamics_derivatives_shape(f: &Facts) -> Shape {
    if f.calls { Shape::ForwardDerivativesByCalls(f.nv) } else { Shape::Forward(f.nv) }
}
