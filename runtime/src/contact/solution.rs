//! Impulses of closed contacts, and the velocity after them.

use super::problem::{Equations, Problem};
use super::selection::Selection;
use super::total::Total;
use super::{
    Assumed, Contacts, Law, Responses, Solved, lawful, phase, touching_distance, unsolved_contact_error,
};
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
    /// Effects of the impulses; `None` if no contact is loaded.
    pub(super) responses: Option<Responses<T, NV, CR>>,
}

impl<T: Real, const NV: usize, const CK: usize, const CR: usize> Acted<T, NV, CK, CR> {
    pub(super) fn nothing(selection: Selection<CK, CR>, is_relaxed: bool) -> Self {
        let (impulses, free) = (Total::repeat(T::zero()), SVector::zeros());
        Self { selection, problem: Problem::empty(is_relaxed), impulses, free, responses: None }
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
    t: T,
    (q, free): (&SVector<T, NQ>, &SVector<T, NV>),
    closed: &[bool; NK],
    (before, given): (impl Fn() -> SVector<T, NR>, Option<(Assumed<'_, T, NV>, bool)>),
    acted: &mut Acted<T, NV, CK, CR>,
) -> Result<Solved<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let mut solved = Solved { v: *free, impulses: SVector::zeros() };
    let after = mechanism.contact_rates(t, q, free);
    let laws = lawful(mechanism)?;
    let Acted { selection, problem, .. } = acted;
    let (layout, laws) = (selection.layout(), selection.laws(&laws));
    problem.select(layout, &laws, &selection.closed(), &selection.rates(&after));
    if laws.iter().any(|law| law.stiction > law.friction) {
        let rates = selection.rates(&before());
        problem.stick(&laws, |k| phase::length(&rates, layout.tangents(k)) <= touching_distance());
    }
    let is_loaded = problem.is_loaded();
    let before = match is_loaded && laws.iter().all(|law| law.restitution == T::zero()) {
        true => SVector::zeros(),
        false => selection.rates(&before()),
    };
    if !is_loaded && !problem.was_loaded(&before) {
        return Ok(solved);
    }
    let responses = acted.responses.insert(Responses::zero_effects());
    selection.fill_responses(mechanism, (t, q), closed, responses, &mut problem.basis);
    problem.weigh(&responses.rates);
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
        let rates = selection.rates(&(mechanism.contact_rates(t, q, &(free + given)) - after));
        problem.transport(given, (&rates, recorded.as_ref()), responses, &mut equations)
    });
    let start = transported.map(|(start, correction)| {
        solved.v += correction;
        start
    });
    let start = recorded.or(start);
    acted.free = solved.v;
    problem.compress(&laws, &before).map_err(failed)?;
    problem.aim(&laws, &before, T::one());
    // Only prescribed motions and restitution can add energy.
    let may_gain = problem.rebounds() && {
        let driven = mechanism.contact_rates(t, q, &SVector::zeros());
        driven.iter().all(|rate| *rate == T::zero())
    };
    let mut found = problem.solve_from(start.as_ref(), &mut equations);
    while found.as_ref().is_ok_and(|impulses| problem.slide(impulses)) {
        found = problem.solve();
    }
    let impulses = match found {
        Ok(impulses) if !(may_gain && problem.gains(&impulses)) => impulses,
        Err(contact) if !problem.rebounds() => problem.relaxed(Err(contact)).map_err(failed)?,
        _ => {
            let found = tempered(problem, &laws, &before, may_gain);
            problem.relaxed(found).map_err(failed)?
        }
    };
    let all = problem.spread(&impulses);
    solved.impulses = selection.spread(&all);
    solved.v += responses.velocities * all;
    acted.impulses = impulses;
    Ok(solved)
}

/// Returns impulses with the largest common fraction of all restitutions for which they exist. If no motion
/// is prescribed, this fraction adds no energy either.
fn tempered<T: Real, const NK: usize, const NR: usize>(
    problem: &mut Problem<T, NK, NR>,
    laws: &[Law<T>; NK],
    before: &SVector<T, NR>,
    may_gain: bool,
) -> Result<Total<T, NR>, usize> {
    // Each bisection determines one bit of the fraction.
    let (mut least, mut step) = (T::zero(), T::one());
    for _ in 0..problem.halvings() {
        step *= constant(0.5);
        problem.aim(laws, before, least + step);
        if problem.solve().is_ok_and(|impulses| !(may_gain && problem.gains(&impulses))) {
            least += step;
        }
    }
    problem.aim(laws, before, least);
    problem.solve()
}
