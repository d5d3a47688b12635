//! Impulses of closed contacts, and the velocity after them.

use super::problem::{Equations, Problem};
use super::response::Effects;
use super::selection::Selection;
use super::total::Total;
use super::velocities::ContactVelocities;
use super::{Assumed, Contacts, Law, Solved, lawful, phase, touching_distance, unsolved_contact_error};
use crate::Real;
use crate::constraint::ConstraintError;
use crate::private::constant;
use nalgebra::SVector;

/// Closed contacts of a step, with their impulses and the effects of these on velocities. Its matrices are
/// large, so it is filled in place.
pub(super) struct Acted<T, const NV: usize, const CK: usize, const CR: usize> {
    selection: Selection<CK, CR>,
    pub(super) problem: Problem<T, CK, CR>,
    pub(super) impulses: Total<T, CR>,
    /// Velocity before the impulses, with the correction for contact forces that rotate in the step.
    pub(super) free: SVector<T, NV>,
    /// Effects of the impulses, unknown if no contact is loaded.
    effects: Effects<T, NV, CR>,
}

impl<T: Real, const NV: usize, const CK: usize, const CR: usize> Acted<T, NV, CK, CR> {
    pub(super) fn nothing(selection: Selection<CK, CR>, is_relaxed: bool) -> Self {
        let (impulses, free) = (Total::repeat(T::zero()), SVector::zeros());
        Self { selection, problem: Problem::empty(is_relaxed), impulses, free, effects: Effects::Unknown }
    }

    /// Whether contacts are loaded.
    pub(super) fn is_loaded(&self) -> bool {
        !matches!(self.effects, Effects::Unknown)
    }

    /// Returns the change of the velocity by impulses.
    pub(super) fn velocity(&self, impulses: &SVector<T, CR>) -> SVector<T, NV> {
        self.effects.velocity(&self.problem.basis, impulses)
    }
}

/// Computes the impulses of the contacts that are `closed`, and fills `acted`. The contact velocities
/// `before` are evaluated only if restitution or static friction needs them. `given` is the change of
/// velocity that contact forces were assumed to cause in a step, with the impulses of the previous one, and
/// true if bodies are moving. The search begins at these impulses, and the rotation of contact forces in the
/// step of moving bodies is taken into account.
pub(super) fn act<
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
    acted: &mut Acted<T, NV, CK, CR>,
) -> Result<Solved<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let mut solved = Solved { v: *free, impulses: SVector::zeros() };
    let laws = lawful(mechanism)?;
    let Acted { selection, problem, effects, .. } = acted;
    let (layout, laws) = (selection.layout(), selection.laws(&laws));
    let after = ContactVelocities::<M, T, NQ, NV, NR>::select(selection, velocities.of(free));
    problem.select(layout, &laws, &selection.closed(), &after);
    if laws.iter().any(|law| law.stiction > law.friction) {
        let rates = before();
        problem.stick(&laws, |k| phase::length(&rates, layout.tangents(k)) <= touching_distance());
    }
    let is_loaded = problem.is_loaded();
    let before = match is_loaded && laws.iter().all(|law| law.restitution == T::zero()) {
        true => SVector::zeros(),
        false => before(),
    };
    if !is_loaded && !problem.was_loaded(&before) {
        return Ok(solved);
    }
    selection.fill_effects(mechanism, (t, q, velocities), closed, effects, problem);
    problem.depends_on(NV);
    let failed = |contact| unsolved_contact_error::<M, T, NQ, NV, NU, NK, NR>(selection.contact(contact));
    let mut equations = Equations::new();
    let (given, recorded, is_moving) = match given {
        Some(((given, recorded), is_moving)) => (Some(given), recorded.recall(selection), is_moving),
        None => (None, None, false),
    };
    // Contact forces on bodies at rest do not rotate.
    let still = SVector::<T, NV>::zeros();
    let recorded = recorded.map(|all| problem.gather(&all));
    let transported = given.filter(|given| is_moving && **given != still).map(|given| {
        let rates = ContactVelocities::<M, T, NQ, NV, NR>::select(selection, velocities.changes(given));
        problem.transport(given, (&rates, recorded.as_ref()), effects, &mut equations)
    });
    let start = transported.and_then(|(start, correction)| {
        solved.v += correction;
        start
    });
    let start = recorded.or(start);
    acted.free = solved.v;
    problem.compress(&laws, &before).map_err(failed)?;
    problem.aim(&laws, &before, T::one());
    // Only prescribed motions and restitution can add energy.
    let may_gain = problem.rebounds() && !velocities.is_driven();
    let mut found = problem.solve_from(start.as_ref(), &mut equations);
    while found.as_ref().is_ok_and(|impulses| problem.slide(impulses)) {
        found = problem.solve();
    }
    let impulses = match found {
        Ok(impulses) if !(may_gain && problem.gains(&impulses)) => impulses,
        Err(contact) if !problem.rebounds() => problem.relaxed(Err(contact)).map_err(failed)?,
        _ => {
            let found = tempered(problem, (&laws, &before), (start, &mut equations), may_gain);
            problem.relaxed(found).map_err(failed)?
        }
    };
    let all = problem.spread(&impulses);
    solved.impulses = selection.spread(&all);
    solved.v += effects.velocity(&problem.basis, &all);
    acted.impulses = impulses;
    Ok(solved)
}

/// Returns impulses with the largest common fraction of all restitutions for which they exist. If no motion
/// is prescribed, this fraction adds no energy either. The search begins at the impulses of `start`.
fn tempered<T: Real, const NK: usize, const NR: usize>(
    problem: &mut Problem<T, NK, NR>,
    (laws, before): (&[Law<T>; NK], &SVector<T, NR>),
    (mut start, equations): (Option<Total<T, NR>>, &mut Equations<T, NR>),
    may_gain: bool,
) -> Result<Total<T, NR>, usize> {
    // Each bisection determines one bit of the fraction.
    let (mut least, mut step, mut found) = (T::zero(), T::one(), None);
    for _ in 0..problem.halvings() {
        if !problem.may_refine() {
            break;
        }
        step *= constant(0.5);
        problem.aim(laws, before, least + step);
        if let Ok(impulses) = problem.solve_from(start.as_ref(), equations)
            && !(may_gain && problem.gains(&impulses))
        {
            least += step;
            start = Some(problem.total(&impulses));
            found = Some((impulses, problem.violation()));
        }
    }
    problem.aim(laws, before, least);
    match found {
        Some((impulses, violation)) => {
            problem.set_violation(violation);
            Ok(impulses)
        }
        None => problem.solve_from(start.as_ref(), equations),
    }
}
