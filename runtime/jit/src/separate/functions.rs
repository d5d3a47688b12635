//! Functions of all separate contacts that callers call by their names.

use super::EvaluatedContacts;
use crate::error::Error;
use crate::functions::{LoadedFunction, Matrix, ResultAssembly};
use crate::robot::{Robot, State};
use crate::shared::Contact;
use linkwork_compiler::catalogue::Argument;

/// Function of all separate contacts, which callers call by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SeparateContactFunction {
    Gaps,
    Rates,
    Jacobian,
}

impl SeparateContactFunction {
    /// Returns the functions of the contacts of a mechanism with `nv` velocities.
    pub fn entries(contacts: &[Contact], nv: usize, time: bool) -> Vec<LoadedFunction> {
        let rates = contacts.iter().map(|contact| contact.rows[1]).sum();
        let functions = [
            (
                SeparateContactFunction::Gaps,
                "contact_gaps",
                "Gap function of each contact, in the order of the contacts: the signed distance of the \
                 surfaces, m. It is zero at contact and negative for penetration.",
                [contacts.len(), 1],
            ),
            (
                SeparateContactFunction::Rates,
                "contact_rates",
                "Contact velocities, m/s and rad/s: of each contact the rate of its gap, followed by the \
                 slip velocities of the first surface on the second one.",
                [rates, 1],
            ),
            (
                SeparateContactFunction::Jacobian,
                "contact_jacobian",
                "Jacobian of the contacts: derivatives of the contact velocities with respect to `v`.",
                [rates, nv],
            ),
        ];
        let entry = |(function, name, documentation, [rows, columns]): (_, _, &str, [usize; 2])| {
            let state: &[Argument] = match function {
                SeparateContactFunction::Rates => &[Argument::Q, Argument::V],
                _ => &[Argument::Q],
            };
            let arguments = time.then_some(Argument::T).into_iter().chain(state.iter().copied()).collect();
            let results = vec![Matrix { name: "result", rows, columns }];
            let plan = ResultAssembly::SeparateContacts(function);
            let rank = if function == SeparateContactFunction::Jacobian { 2 } else { 1 };
            LoadedFunction {
                rank,
                ..LoadedFunction::new(name, documentation.to_string(), arguments, results, plan)
            }
        };
        functions.map(entry).into_iter().collect()
    }
}

impl Robot {
    /// Evaluates a function of separate contacts with the arguments `t` (if the mechanism depends on it),
    /// `q`, and `v` for velocities.
    pub(crate) fn call_separate_contacts(
        &self,
        function: SeparateContactFunction,
        arguments: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Error> {
        let Some(separate) = EvaluatedContacts::of_robot(self)? else { return Ok(()) };
        let (time, state) = arguments.split_at(usize::from(self.shared.time).min(arguments.len()));
        let state = State {
            t: time.first().and_then(|t| t.first()).copied(),
            q: state.first().copied().unwrap_or_default(),
            v: state.get(1).copied().unwrap_or_default(),
            ..State::default()
        };
        let all = separate.all_contacts();
        out.fill(0.0);
        match function {
            SeparateContactFunction::Gaps => separate.write_gaps(self, &all, state, out),
            SeparateContactFunction::Rates => separate.write_rates(self, &all, state, out),
            SeparateContactFunction::Jacobian => {
                separate.write_jacobian(self, &all, state, (out, self.shared.contact_rates));
            }
        }
        Ok(())
    }
}
