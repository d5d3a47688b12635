//! Contacts that are mechanisms of their own, one for each pair of surfaces of two bodies: loading.

mod evaluated;
mod functions;

pub(crate) use evaluated::{EvaluatedContacts, NearContacts, TOUCHING};
pub(crate) use functions::SeparateContactFunction;

use crate::error::Error;
use crate::frames::Frames;
use crate::load::Loader;
use crate::names::CONTACTS;
use crate::robot::Robot;
use crate::shared::Contact;
use linkwork_compiler::mechanism::ContactVelocityDependence;
use linkwork_compiler::{SeparateContact, SeparateContactParameter};
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pair of surfaces, with the mechanism in which they are alone.
struct Pair {
    /// Index of the mechanism among the kinds of pairs.
    kind: usize,
    parameters: Vec<PairParameter>,
    /// Bodies of both surfaces, as indices of frames; `None` for the ground.
    frames: [Option<usize>; 2],
    /// Radius of a sphere about the origin of each body that contains its surface, m.
    radii: [f64; 2],
    /// Index of its first contact in the mechanism.
    first_contact: usize,
}

/// Value of a parameter of a pair: a number, or the parameter of the mechanism with this index.
enum PairParameter {
    Number(f64),
    Parameter(usize),
}

/// All separate contacts of a mechanism.
#[derive(Default)]
pub(crate) struct SeparateContacts {
    kinds: Vec<Robot>,
    pairs: Vec<Pair>,
}

impl SeparateContacts {
    /// Loads the mechanisms of separate contacts. Returns them with the contacts of all pairs. Pairs of
    /// surfaces that do not move relative to each other are omitted.
    ///
    /// # Errors
    ///
    /// The surfaces of a contact have an error.
    pub fn load(
        separate: &[SeparateContact],
        frames: &Frames,
        parameters: &[String],
    ) -> Result<(SeparateContacts, Vec<Contact>), Error> {
        let (mut all, mut contacts) = (SeparateContacts::default(), Vec::new());
        let mut names: Vec<(&str, String)> = Vec::new();
        let mut known: HashMap<&str, usize> = HashMap::new();
        let mut first_contacts: Vec<&SeparateContact> = Vec::new();
        for one in separate {
            known.entry(&one.declaration).or_insert_with(|| {
                first_contacts.push(one);
                first_contacts.len() - 1
            });
        }
        all.kinds = load_kinds(&first_contacts)?;
        for one in separate {
            let frame_of_body = |body: &Option<String>| match body {
                None => Ok(None),
                Some(body) => frames.names.iter().position(|name| name == body).map(Some).ok_or_else(|| {
                    Error::Mechanism(vec![format!("`{}`: the body `{body}` has no frame", one.name)])
                }),
            };
            let own_frames = [frame_of_body(&one.bodies[0])?, frame_of_body(&one.bodies[1])?];
            let [first, second] = own_frames.map(|frame| frame.and_then(|frame| frames.link_of_frame(frame)));
            if first == second {
                continue;
            }
            let Some(kind) = known.get(one.declaration.as_str()).copied() else { continue };
            let value_of_parameter = |parameter: &SeparateContactParameter| match parameter {
                SeparateContactParameter::Number(value) => Ok(PairParameter::Number(*value)),
                SeparateContactParameter::Parameter(name) => parameters
                    .iter()
                    .position(|known| known == name)
                    .map(PairParameter::Parameter)
                    .ok_or_else(|| Error::Internal(format!("the parameter `{name}` of a contact"))),
            };
            all.pairs.push(Pair {
                kind,
                parameters: one.parameters.iter().map(value_of_parameter).collect::<Result<_, _>>()?,
                frames: own_frames,
                radii: one.radii,
                first_contact: contacts.len(),
            });
            let base = contacts.len();
            let rows: usize = contacts.iter().map(|contact: &Contact| contact.rows[1]).sum();
            for contact in &all.kinds[kind].shared.contacts {
                names.push((&one.name, contact.name.clone()));
                contacts.push(Contact {
                    name: String::new(),
                    rows: [rows + contact.rows[0], contact.rows[1]],
                    pressed_by: base + contact.pressed_by,
                    of_impulses: contact.of_impulses,
                    dependence: ContactVelocityDependence { columns: (0, 0), drifts: false },
                });
            }
        }
        if contacts.len() > CONTACTS {
            let message =
                format!("{} contacts, more than {CONTACTS}: use fewer pairs of surfaces", contacts.len());
            return Err(Error::Mechanism(vec![message]));
        }
        name_contacts(&mut contacts, &names);
        Ok((all, contacts))
    }

    /// Whether the mechanism has no separate contacts.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }
}

/// Loads the mechanisms of contacts, several at a time.
///
/// # Errors
///
/// The surfaces of a contact have an error; the first such contact is named.
fn load_kinds(contacts: &[&SeparateContact]) -> Result<Vec<Robot>, Error> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(contacts.len().max(1));
    let next = AtomicUsize::new(0);
    let load_some = || {
        let mut loaded = Vec::new();
        while let Some((index, one)) =
            Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|index| Some((index, contacts.get(index)?)))
        {
            let robot = Loader::separate_contact(&one.declaration).load();
            loaded.push((index, robot.map_err(|error| error_of_contact(one, &error))));
        }
        loaded
    };
    let mut loaded: Vec<(usize, Result<Robot, Error>)> = std::thread::scope(|scope| {
        let running: Vec<_> = (0..threads).map(|_| scope.spawn(load_some)).collect();
        running.into_iter().flat_map(|one| one.join().unwrap_or_default()).collect()
    });
    loaded.sort_by_key(|(index, _)| *index);
    if loaded.len() < contacts.len() {
        return Err(Error::Internal("a thread that loads contacts failed".to_string()));
    }
    loaded.into_iter().map(|(_, robot)| robot).collect()
}

/// Returns the error of a contact from that of its mechanism, without positions in the text of the mechanism,
/// which the user has not written.
fn error_of_contact(contact: &SeparateContact, error: &Error) -> Error {
    let messages = match error {
        Error::Mechanism(messages) => messages.clone(),
        other => vec![other.to_string()],
    };
    let messages = messages.into_iter().map(|message| {
        let message = message.split_once(": error: ").map_or(message.as_str(), |(_, message)| message);
        format!("error: the contact `{}`: {message}", contact.name)
    });
    Error::Mechanism(messages.collect())
}

/// Sets the names of contacts from the names of the declared contacts and those of their points. A contact
/// with several points has their numbers in its name.
fn name_contacts(contacts: &mut [Contact], names: &[(&str, String)]) {
    let mut first = 0;
    while let Some((declared, _)) = names.get(first) {
        let count = names[first..].iter().take_while(|(name, _)| name == declared).count();
        let group = &mut contacts[first..first + count];
        let points = (0..count).filter(|k| group[*k].pressed_by == first + k).count();
        let mut point = 0;
        for (k, contact) in group.iter_mut().enumerate() {
            let is_point = contact.pressed_by == first + k;
            point += usize::from(is_point);
            // Names of friction moments end with their kind.
            let moment = match names[first + k].1.rsplit_once('.') {
                Some((_, moment)) if !is_point => format!(".{moment}"),
                _ => String::new(),
            };
            contact.name = match points {
                1 => format!("{declared}{moment}"),
                _ => format!("{declared}.{}{moment}", point.saturating_sub(1)),
            };
        }
        first += count;
    }
}

#[cfg(test)]
mod tests;
