//! Muscles: curves of force over length and speed, and the rate of the activation (MuJoCo, *Modeling*,
//! "Muscles").

use super::activation::{OTHER_INPUTS, SymbolicActuatorLaw, TINY};
use super::defaults::ElementWithDefaults;
use super::formula::ActuatorLawExpression;
use super::record::ActuatorRecord;
use crate::import::context::Cx;

/// Parameters of the force curves of a muscle.
pub(super) struct Muscle {
    /// Shortest and longest length of the actuator.
    lengths: [f64; 2],
    /// Gain parameters: range of normalised lengths, force, scale, lmin, lmax, vmax, fpmax, fvmax.
    gain: [f64; 9],
    /// Parameters of the muscle's passive force, in the order of the gain parameters.
    bias: [f64; 9],
}

impl Muscle {
    /// Reads the parameters. Reports those that MuJoCo computes from the inertia or by a simulation.
    pub(super) fn read_muscle(
        actuator: &ElementWithDefaults<'_>,
        record: &ActuatorRecord<'_>,
        cx: &mut Cx<'_>,
    ) -> Option<Muscle> {
        let first_nine_parameters = |prm: &[f64; 10]| std::array::from_fn(|k| prm[k]);
        let (gain, bias): ([f64; 9], [f64; 9]) =
            (first_nine_parameters(&record.gain), first_nine_parameters(&record.bias));
        let kinds = [(record.gain_kind, &gain), (record.bias_kind, &bias)];
        for (_, prm) in kinds.into_iter().filter(|(kind, _)| *kind == "muscle") {
            let [low, high, force, _, lmin, lmax, vmax, _, fvmax] = *prm;
            if force < 0.0 {
                let help = "MuJoCo scales it by the inertia: write the `force` in newtons";
                return report_unsupported_muscle_attribute(
                    actuator,
                    "force",
                    "a muscle without `force` is not supported",
                    help,
                    cx,
                );
            }
            if low >= high || lmin >= 1.0 || lmax <= 1.0 || vmax <= 0.0 || fvmax <= 1.0 {
                let message = "a muscle needs an increasing `range`, lmin < 1 < lmax, vmax > 0 and fvmax > 1";
                return report_unsupported_muscle_attribute(
                    actuator,
                    "force",
                    message,
                    "correct these values",
                    cx,
                );
            }
        }
        let lengths =
            actuator.read_exactly_n_numbers::<2>("lengthrange", cx).map_or([0.0; 2], |found| found.value);
        if kinds.iter().any(|(kind, _)| *kind == "muscle") && lengths[0] >= lengths[1] {
            let help =
                "MuJoCo finds it by a simulation: write the `lengthrange` that MuJoCo saves in the file";
            return report_unsupported_muscle_attribute(
                actuator,
                "lengthrange",
                "a muscle without `lengthrange` is not supported",
                help,
                cx,
            );
        }
        Some(Muscle { lengths, gain, bias })
    }

    /// Returns the actuator length that counts as one in the muscle's curves, m.
    fn reference_length(&self, prm: &[f64; 9]) -> f64 {
        (self.lengths[1] - self.lengths[0]) / (prm[1] - prm[0])
    }

    /// Returns the muscle length in units of its reference length, as an expression.
    fn normalized_muscle_length(&self, prm: &[f64; 9], law: &SymbolicActuatorLaw) -> ActuatorLawExpression {
        let unit = self.reference_length(prm);
        law.actuator_length_formula() * (1.0 / unit) + (prm[0] - self.lengths[0] / unit)
    }

    /// Returns the muscle force at full activation, which is negative.
    pub(super) fn active_force(&self, law: &SymbolicActuatorLaw) -> ActuatorLawExpression {
        let [_, _, force, _, lmin, lmax, vmax, _, fvmax] = self.gain;
        let length = self.normalized_muscle_length(&self.gain, law);
        let speed = law.actuator_length_rate_formula() * (1.0 / (self.reference_length(&self.gain) * vmax));
        let (low, high) = (0.5 * (lmin + 1.0), 0.5 * (1.0 + lmax));
        let half_squared_distance =
            |from: f64, width: f64| ((length.clone() + -from) * (1.0 / width)).square() * 0.5;
        let length_force_parabola = |from: f64, width: f64| -half_squared_distance(from, width) + 1.0;
        let zero_formula = || law.constant_formula(0.0);
        let beyond =
            length.clone().piecewise_choice(lmax, half_squared_distance(lmax, lmax - high), zero_formula());
        let falling = length.clone().piecewise_choice(high, length_force_parabola(1.0, high - 1.0), beyond);
        let rising = length.clone().piecewise_choice(1.0, length_force_parabola(1.0, 1.0 - low), falling);
        let inside = length.clone().piecewise_choice(low, half_squared_distance(lmin, low - lmin), rising);
        let by_length = length.piecewise_choice(lmin, zero_formula(), inside);
        let eccentric = fvmax - 1.0;
        let lengthening = -(speed.clone() + -eccentric).square() * (1.0 / eccentric) + fvmax;
        let slow = speed.clone().piecewise_choice(eccentric, lengthening, law.constant_formula(fvmax));
        let shortening = speed.clone().piecewise_choice(0.0, (speed.clone() + 1.0).square(), slow);
        let by_speed = speed.piecewise_choice(-1.0, zero_formula(), shortening);
        by_length * by_speed * -force
    }

    /// Returns the passive muscle force, which is negative.
    pub(super) fn passive_force(&self, law: &SymbolicActuatorLaw) -> ActuatorLawExpression {
        let [_, _, force, _, _, lmax, _, fpmax, _] = self.bias;
        let length = self.normalized_muscle_length(&self.bias, law);
        let border = 0.5 * (1.0 + lmax);
        let scale = 1.0 / (border - 1.0);
        let linear = (length.clone() + -border) * scale + 0.5;
        let curved = ((length.clone() + -1.0) * scale).square() * 0.5;
        let stretched = length.clone().piecewise_choice(border, curved, linear);
        length.piecewise_choice(1.0, law.constant_formula(0.0), stretched) * (-force * fpmax)
    }
}

/// Reports an attribute of a muscle that is not supported.
fn report_unsupported_muscle_attribute<T>(
    actuator: &ElementWithDefaults<'_>,
    attribute: &str,
    message: &str,
    help: &'static str,
    cx: &mut Cx<'_>,
) -> Option<T> {
    cx.report_error(&actuator.place_of_attribute_value(attribute, cx), message, |d| {
        d.add_help(help).add_help(OTHER_INPUTS)
    });
    None
}

/// Returns the rate of the activation. Time constants depend on the activation and on the direction of its
/// change; `dynprm` contains both, and the width over which they are blended.
pub(super) fn activation_rate(
    law: &SymbolicActuatorLaw,
    input: ActuatorLawExpression,
    state: ActuatorLawExpression,
    record: &ActuatorRecord<'_>,
) -> ActuatorLawExpression {
    let [rise, fall, width, ..] = record.dynprm;
    let factor = state.clone().clamp_between(0.0, 1.0) * 1.5 + 0.5;
    let excess = input.clamp_between(0.0, 1.0) - state;
    let rise = factor.clone() * rise.max(TINY);
    let fall = law.constant_formula(fall.max(TINY)) / factor;
    if width < TINY {
        return excess.clone().piecewise_choice(0.0, excess.clone() / fall, excess / rise);
    }
    let x = (excess.clone() * (1.0 / width) + 0.5).clamp_between(0.0, 1.0);
    let blend = x.clone().square() * x.clone() * (x.clone() * 3.0 * (x * 2.0 + -5.0) + 10.0);
    excess / (fall.clone() + (rise - fall) * blend)
}
