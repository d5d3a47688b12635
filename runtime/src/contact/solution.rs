//! Impulses of closed contacts, and the velocity after them.

use super::problem::{ContactProblem, ImpulseEquations, set_entry};
use super::response::ImpulseEffects;
use super::selection::ContactSelection;
use super::total::TotalArray;
use super::velocities::ContactVelocities;
use super::{
    Assumed, Contacts, Law, Solved, checked_contact_laws, phase, touching_distance, unsolved_contact_error,
};
use crate::Real;
use crate::constraint::ConstraintError;
use crate::private::constant;
use nalgebra::{SMatrix, SVector};

/// Closed contacts of a step, with their impulses and the effects of these on velocities. Its matrices are
/// large, so it is filled in place.
pub(super) struct ContactsWithImpulses<T, const NV: usize, const CK: usize, const CR: usize> {
    pub(super) selection: ContactSelection<CK, CR>,
    pub(super) problem: ContactProblem<T, CK, CR>,
    pub(super) impulses: TotalArray<T, CR>,
    /// Velocity before the impulses, with the correction for contact forces that rotate in the step.
    pub(super) free: SVector<T, NV>,
    /// Effects of the impulses, unknown if no contact is loaded.
    effects: ImpulseEffects<T, NV, CR>,
}

impl<T: Real, const NV: usize, const CK: usize, const CR: usize> ContactsWithImpulses<T, NV, CK, CR> {
    pub(super) fn contacts_without_impulses(selection: ContactSelection<CK, CR>, is_relaxed: bool) -> Self {
        let (impulses, free) = (TotalArray::repeat_entry(T::zero()), SVector::zeros());
        Self {
            selection,
            problem: ContactProblem::without_contacts(is_relaxed),
            impulses,
            free,
            effects: ImpulseEffects::Unknown,
        }
    }

    /// Whether contacts are loaded.
    pub(super) fn is_loaded(&self) -> bool {
        !matches!(self.effects, ImpulseEffects::Unknown)
    }

    /// Returns `M⁻¹ Gᵀ`: the changes of the velocity by unit impulses at the rows of the selected contacts.
    pub(super) fn velocity_responses(&self) -> SMatrix<T, NV, CR> {
        if let ImpulseEffects::Matrix(responses) = &self.effects {
            return *responses;
        }
        let mut responses = SMatrix::<T, NV, CR>::zeros();
        let rows = self.selection.row_count();
        for (row, column) in responses.data.0.iter_mut().enumerate().take(rows) {
            let mut unit = SVector::zeros();
            set_entry(&mut unit, row, T::one());
            *column = self.velocity_change(&unit).data.0[0];
        }
        responses
    }

    /// Returns the change of the velocity by impulses.
    pub(super) fn velocity_change(&self, impulses: &SVector<T, CR>) -> SVector<T, NV> {
        self.effects.velocity_change(&self.problem.basis, impulses)
    }
}

/// Computes the impulses of the contacts that are `closed`, and fills `acted`. The contact velocities
/// `before` are evaluated only if restitution or static friction needs them. `given` is the change of
/// velocity that contact forces were assumed to cause in a step, with the impulses of the previous one, and
/// true if bodies are moving. The search begins at these impulses, and the rotation of contact forces in the
/// step of moving bodies is taken into account.
pub(super) fn compute_closed_contact_impulses<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    const CK: usize,
    const CR: usize,
>(
    mechanism: &M,
    (t, velocities): (T, &ContactVelocities<'_, M, T, NQ, NV, NR>),
    (q, free): (&SVector<T, NQ>, &SVector<T, NV>),
    closed: &[bool; NK],
    (before, given): (impl Fn() -> SVector<T, CR>, Option<(Assumed<'_, T, NV>, bool)>),
    acted: &mut ContactsWithImpulses<T, NV, CK, CR>,
) -> Result<Solved<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let mut solved = Solved { v: *free, impulses: SVector::zeros() };
    let laws = checked_contact_laws(mechanism)?;
    let ContactsWithImpulses { selection, problem, effects, .. } = acted;
    let (layout, laws) = (selection.contact_layout(), selection.selected_laws(&laws));
    let after = velocities.selected_rates(selection, free);
    problem.add_closed_contacts(layout, &laws, &selection.selected_contact_mask(), &after);
    if laws.iter().any(|law| law.stiction > law.friction) {
        let rates = before();
        problem.set_static_friction(&laws, |k| {
            phase::norm_of_range(&rates, layout.tangent_rows(k)) <= touching_distance()
        });
    }
    let is_loaded = problem.do_surfaces_approach();
    let before = match is_loaded && laws.iter().all(|law| law.restitution == T::zero()) {
        true => SVector::zeros(),
        false => before(),
    };
    if !is_loaded && !problem.were_surfaces_approaching(&before) {
        return Ok(solved);
    }
    selection.compute_impulse_effects(mechanism, (t, q, velocities), closed, effects, problem);
    problem.set_velocity_count(NV);
    let unsolved_error = |contact| {
        unsolved_contact_error::<M, T, NQ, NV, NU, NK, NR>(selection.mechanism_index_of_contact(contact))
    };
    let mut equations = ImpulseEquations::new();
    let (given, recorded, is_moving) = match given {
        Some(((given, recorded), is_moving)) => (Some(given), recorded.recall_impulses(selection), is_moving),
        None => (None, None, false),
    };
    // Contact forces on bodies at rest do not rotate.
    let still = SVector::<T, NV>::zeros();
    let recorded = recorded.map(|all| problem.gather_closed_rows(&all));
    let transported = given.filter(|given| is_moving && **given != still).map(|given| {
        let rates = velocities.selected_rate_changes(selection, given);
        problem.correct_velocity_for_rotation(given, (&rates, recorded.as_ref()), effects, &mut equations)
    });
    let start = transported.and_then(|(start, correction)| {
        solved.v += correction;
        start
    });
    let start = recorded.or(start);
    acted.free = solved.v;
    problem.compute_compression_impulses(&laws, &before).map_err(unsolved_error)?;
    problem.set_restitution_demands(&laws, &before, T::one());
    // Only prescribed motions and restitution can add energy.
    let may_gain = problem.demands_restitution() && !velocities.has_prescribed_contact_velocities();
    let mut found = problem.solve_impulses_from_start(start.as_ref(), &mut equations);
    while found.as_ref().is_ok_and(|impulses| problem.switch_to_kinetic_friction(impulses)) {
        found = problem.solve_impulses();
    }
    let impulses = match found {
        Ok(impulses) if !(may_gain && problem.adds_energy(&impulses)) => impulses,
        Err(contact) if !problem.demands_restitution() => {
            problem.accept_best_if_relaxed(Err(contact)).map_err(unsolved_error)?
        }
        _ => {
            let found =
                impulses_with_restitution(problem, (&laws, &before), (start, &mut equations), may_gain);
            problem.accept_best_if_relaxed(found).map_err(unsolved_error)?
        }
    };
    let all = problem.impulses_at_mechanism_rows(&impulses);
    solved.impulses = selection.impulses_at_mechanism_rows(&all);
    solved.v += effects.velocity_change(&problem.basis, &all);
    acted.impulses = impulses;
    Ok(solved)
}

/// Returns impulses with the largest fraction of the restitution, common to all contacts, for which a
/// solution exists. If no motion is prescribed, this fraction also adds no energy. The search starts at the
/// impulses `start`.
fn impulses_with_restitution<T: Real, const NK: usize, const NR: usize>(
    problem: &mut ContactProblem<T, NK, NR>,
    (laws, before): (&[Law<T>; NK], &SVector<T, NR>),
    (mut start, equations): (Option<TotalArray<T, NR>>, &mut ImpulseEquations<T, NR>),
    may_gain: bool,
) -> Result<TotalArray<T, NR>, usize> {
    // Each bisection determines one bit of the fraction.
    let (mut least, mut step, mut found) = (T::zero(), T::one(), None);
    for _ in 0..problem.max_restitution_bisections() {
        if !problem.may_refine_restitution() {
            break;
        }
        step *= constant(0.5);
        problem.set_restitution_demands(laws, before, least + step);
        if let Ok(impulses) = problem.solve_impulses_from_start(start.as_ref(), equations)
            && !(may_gain && problem.adds_energy(&impulses))
        {
            least += step;
            start = Some(problem.impulses_plus_base(&impulses));
            found = Some((impulses, problem.largest_violation()));
        }
    }
    problem.set_restitution_demands(laws, before, least);
    match found {
        Some((impulses, violation)) => {
            problem.set_violation(violation);
            Ok(impulses)
        }
        None => problem.solve_impulses_from_start(start.as_ref(), equations),
    }
}
