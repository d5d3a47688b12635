//! Gap functions of contacts, and their normal and slip velocities.

use super::facts::{Facts, FunctionNeed};
use super::row::{Declaration, GeneratedId, Row};
use super::shape::Argument::{self, A, Q, V};
use super::shape::{Record, Shape};
use crate::mechanism::{PAIR_POSE, SuppliedQuantity};
use crate::syntax::RequestOption;

/// Number of values of a contact that have derivatives with respect to the parameters, in addition to its
/// contact velocities: the gap, and the coefficients of friction and restitution.
const GAP_AND_COEFFICIENTS: usize = 3;

const TOUCHING: &[FunctionNeed] = &[FunctionNeed::Contacts];

/// Functions that evaluate a separate contact.
pub(super) const SEPARATE: [GeneratedId; 5] = [
    GeneratedId::Figures,
    GeneratedId::ContactGaps,
    GeneratedId::ContactJacobian,
    GeneratedId::ContactLaws,
    GeneratedId::PolytopePoses,
];

/// Rows of the functions of mechanisms with contacts.
pub const ROWS: &[Row] = &[
    Row::derived_row(GeneratedId::ContactGaps, "contact_gaps", TOUCHING, |f| Declaration {
        arguments: vec![Q],
        shape: Shape::Vector(f.contacts.count),
        docs: vec![
            "Gap function of each contact, in the order of `CONTACTS`: the signed distance of the surfaces, \
             m, or the angle from a rotational stop, rad. It is zero at contact and negative for \
             penetration.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::ContactRates, "contact_rates", TOUCHING, |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Vector(f.contacts.rates),
        docs: vec![
            "Contact velocities, m/s and rad/s. A contact has the rate of its gap, followed by the slip \
             velocities of the first surface on the second one along one or two tangents, if it has \
             friction. A friction moment has only the relative angular velocity about the normal (`.spin`) \
             or the tangents (`.roll`). `CONTACT_ROWS` holds the rows of each contact.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::ContactJacobian, "contact_jacobian", TOUCHING, |f| Declaration {
        arguments: vec![Q],
        shape: Shape::Matrix(f.contacts.rates, f.nv),
        docs: vec![
            "Jacobian of the contacts: derivatives of the contact velocities with respect to `v`. A contact \
             force `f`, N, contributes `Gᵀ f` to the generalized forces, where `G` are the rows of the \
             contact.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::ContactBias, "contact_bias", TOUCHING, |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Vector(f.contacts.rates),
        docs: vec![
            "Bias `b(q, v)` of the contacts, m/s² and rad/s²: for surfaces in contact, the time derivative \
             of the contact velocities is `G v̇ + b`.",
        ],
        ..Declaration::default()
    }),
    Row::derived_row(GeneratedId::ContactLaws, "__contact_laws", TOUCHING, |f| Declaration {
        timeless: true,
        shape: Shape::Array(3 * f.contacts.count),
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::PolytopePoses, "__polytope_poses", &[FunctionNeed::Polytopes], |f| {
        Declaration {
            arguments: vec![Q],
            shape: Shape::Vector(PAIR_POSE * f.polytopes),
            ..Declaration::default()
        }
    })
    .without_batched_variant(),
    Row::derived_row(
        GeneratedId::ContactResponses,
        "__contact_responses",
        &[FunctionNeed::Contacts, FunctionNeed::Inertia, FunctionNeed::FewContacts],
        |f| Declaration {
            arguments: vec![Q],
            shape: Shape::Array(f.contacts.rates * (f.nv + f.contacts.rates)),
            ..Declaration::default()
        },
    )
    .without_batched_variant(),
    Row::derived_row(
        GeneratedId::ContactDerivatives,
        "__contact_derivatives",
        &[FunctionNeed::Contacts, FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives)],
        |f| Declaration {
            arguments: vec![Q, V, A, contact_force_argument(f)],
            shape: Shape::Record(Record::ContactDerivatives(f.nv, f.contacts.rates)),
            ..Declaration::default()
        },
    )
    .without_batched_variant(),
    Row::derived_row(
        GeneratedId::ContactDerivativesByParameters,
        "__contact_derivatives_by_parameters",
        &[
            FunctionNeed::Contacts,
            FunctionNeed::Inertia,
            FunctionNeed::NoConstraints,
            FunctionNeed::NoSpeeds,
            FunctionNeed::Parameters,
            FunctionNeed::Asks(RequestOption::Derivatives),
            FunctionNeed::Asks(RequestOption::Sensitivities),
        ],
        |f| Declaration {
            arguments: vec![Q, V, contact_force_argument(f)],
            shape: Shape::Array(
                f.parameters * (f.nv + f.contacts.rates + GAP_AND_COEFFICIENTS * f.contacts.count),
            ),
            ..Declaration::default()
        },
    )
    .without_batched_variant(),
];

/// Returns the argument that contains the forces of all contacts.
pub(super) fn contact_force_argument(f: &Facts) -> Argument {
    Argument::Given("forces", SuppliedQuantity::ContactForces, f.contacts.rates)
}
