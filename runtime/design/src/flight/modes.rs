//! Classification of the modes of an aircraft by name.

use super::{LATERAL, LONGITUDINAL};
use crate::{Error, Mode, StateSpace};

/// Modes of an aircraft by their names (Etkin and Reid, *Dynamics of Flight*, 1996, ch. 6). A mode that does
/// not exist is `None`. For an aircraft that is unstable in pitch, the short period splits into two real
/// modes, which are in `others`.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FlightModes {
    /// Short period: oscillation of angle of attack and pitch rate.
    pub short_period: Option<Mode>,
    /// Phugoid: slow oscillation that exchanges airspeed and height.
    pub phugoid: Option<Mode>,
    /// Dutch roll: oscillation of sideslip, yaw and roll.
    pub dutch_roll: Option<Mode>,
    /// Roll mode: fast real mode of the roll rate.
    pub roll: Option<Mode>,
    /// Spiral mode: slow real mode of bank angle and heading.
    pub spiral: Option<Mode>,
    /// Modes of the aircraft other than the named ones, such as those of engines, of actuators and of the
    /// change of air density with height.
    pub others: Vec<Mode>,
}

fn participation_of_states(mode: &Mode, states: &[&str]) -> f64 {
    states.iter().filter_map(|state| mode.participation_of(state)).sum()
}

/// Removes the mode of maximum `key` among the modes for which `fits` is true from the list, and returns it.
fn take_largest_matching_mode(
    modes: &mut Vec<Mode>,
    fits: impl Fn(&Mode) -> bool,
    key: impl Fn(&Mode) -> f64,
) -> Option<Mode> {
    let candidates = modes.iter().enumerate().filter(|(_, mode)| fits(mode));
    let (k, _) = candidates.max_by(|(_, a), (_, b)| key(a).total_cmp(&key(b)))?;
    Some(modes.remove(k))
}

impl FlightModes {
    /// Classifies the modes of a system with the states `u`, `w`, `q`, `theta` or `v`, `p`, `r`, `phi` or all
    /// of them, as [`linear_system`](super::linear_system) returns. The classification uses the participation
    /// of the states in each mode.
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`], [`Error::Unknown`] for a system without states of these names.
    pub fn from_system(system: &StateSpace) -> Result<Self, Error> {
        let is_state_name = |name: &&str| system.states().iter().any(|state| state.name == *name);
        if !LONGITUDINAL.iter().chain(&LATERAL).any(is_state_name) {
            let known = system.states().iter().map(|state| state.name.clone()).collect();
            return Err(Error::Unknown { kind: "state", name: LONGITUDINAL.join(", "), known });
        }
        let mut modes = system.modes()?;
        let longitudinal_share = |mode: &Mode| participation_of_states(mode, &LONGITUDINAL);
        let lateral_share = |mode: &Mode| participation_of_states(mode, &LATERAL);
        let is_longitudinal_mode = |mode: &Mode| longitudinal_share(mode) > 0.5;
        let is_lateral_mode = |mode: &Mode| lateral_share(mode) > 0.5;
        let is_oscillating_mode = |mode: &Mode| mode.exponent.im > 0.0;
        let short_period_share = |mode: &Mode| participation_of_states(mode, &["w", "q"]);
        let phugoid_share = |mode: &Mode| participation_of_states(mode, &["u", "theta", "h"]);
        let is_short_period = |mode: &Mode| {
            is_longitudinal_mode(mode)
                && is_oscillating_mode(mode)
                && short_period_share(mode) > phugoid_share(mode)
        };
        let is_phugoid = |mode: &Mode| {
            is_longitudinal_mode(mode)
                && is_oscillating_mode(mode)
                && short_period_share(mode) <= phugoid_share(mode)
        };
        let dutch_roll_share = |mode: &Mode| participation_of_states(mode, &["v", "r"]);
        let is_aperiodic_lateral = |mode: &Mode| is_lateral_mode(mode) && !is_oscillating_mode(mode);
        Ok(Self {
            short_period: take_largest_matching_mode(&mut modes, is_short_period, Mode::frequency),
            phugoid: take_largest_matching_mode(&mut modes, is_phugoid, phugoid_share),
            dutch_roll: take_largest_matching_mode(
                &mut modes,
                |mode| is_lateral_mode(mode) && is_oscillating_mode(mode) && dutch_roll_share(mode) > 0.3,
                dutch_roll_share,
            ),
            roll: take_largest_matching_mode(
                &mut modes,
                |mode| is_aperiodic_lateral(mode) && participation_of_states(mode, &["p"]) > 0.3,
                Mode::frequency,
            ),
            spiral: take_largest_matching_mode(
                &mut modes,
                |mode| is_aperiodic_lateral(mode) && participation_of_states(mode, &["phi"]) > 0.3,
                |mode| -mode.frequency(),
            ),
            others: modes,
        })
    }

    /// Returns the named modes of the aircraft that exist, with their names.
    pub fn named_modes(&self) -> Vec<(&'static str, &Mode)> {
        let all = [
            ("short period", &self.short_period),
            ("phugoid", &self.phugoid),
            ("Dutch roll", &self.dutch_roll),
            ("roll", &self.roll),
            ("spiral", &self.spiral),
        ];
        all.into_iter().filter_map(|(name, mode)| Some((name, mode.as_ref()?))).collect()
    }
}
