//! Sticking contacts of mechanisms with bodies that are much lighter than others.

use super::layout::ContactLayout;
use super::{Contacts, Law, Touch};
use crate::Real;
use crate::constraint::velocity_change_and_impulses;
use crate::private::constant;
use nalgebra::SVector;

/// Ratio of the largest to the smallest diagonal entry of the mass matrix from which on bodies count as
/// light.
const GRADED: f64 = 1e4;

/// Returns the change of the velocity that changes the velocities of sticking contacts by `changes`, and the
/// impulses that cause it. Returns `None` for mechanisms without light bodies, with constraints, or with
/// sliding or redundant contacts.
///
/// Rows of contacts with light bodies have an inverse inertia `G M⁻¹ Gᵀ` in which the heavy ones are lost to
/// rounding. They are factorised in the metric of the kinetic energy instead, as rows of constraints are.
#[cold]
#[allow(clippy::type_complexity, reason = "sizes of arrays")]
pub(super) fn velocity_change_for_sticking<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
    (touches, laws): (&[Touch; NK], &[Law<T>; NK]),
    changes: &SVector<T, NR>,
) -> Option<(SVector<T, NV>, SVector<T, NR>)>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let features = mechanism.features();
    if features.constrained || features.feedback || touches.contains(&Touch::Slips) {
        return None;
    }
    let mass = mechanism.mass_matrix(t, q);
    let (mut least, mut largest) = (mass.get(0).copied()?, T::zero());
    for (i, column) in mass.data.0.iter().enumerate() {
        let entry = column.get(i).copied()?;
        (least, largest) = (least.min(entry), largest.max(entry));
    }
    let is_graded = largest > least * constant(GRADED);
    if !is_graded {
        return None;
    }
    let layout = ContactLayout::of_mechanism(mechanism);
    let (mut held, mut groups) = ([false; NR], [NK; NR]);
    for (k, (touch, law)) in touches.iter().zip(laws).enumerate() {
        let tangents = layout.tangent_rows(k);
        let rows = layout.rows(k);
        for i in rows.first..rows.first + rows.count {
            *groups.get_mut(i)? = k;
            *held.get_mut(i)? = *touch != Touch::Open && (!tangents.contains(&i) || law.friction > T::zero());
        }
    }
    velocity_change_and_impulses(&mass, &mechanism.contact_jacobian(t, q), (&held, &groups), changes)
}
