//! Names in error messages. The runtime takes names as constants, so that loaded mechanisms pass numbers,
//! which are later replaced by their names.

use crate::shared::SharedMechanism;

/// List of names in a mechanism to which a name in a message belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NameListKind {
    Configuration,
    Velocities,
    Inputs,
    Constraints,
    Contacts,
}

/// Number of placeholder names in each list, except that of contacts.
const COUNT: usize = 1000;
/// Number of lists before that of contacts.
const LISTS: usize = NameListKind::Contacts as usize;
/// Maximum number of contacts of a loaded mechanism.
pub(crate) const CONTACTS: usize = 16_384;
/// Number of digits of each placeholder number, except those of contacts.
const DIGITS: usize = 4;
/// Number of digits of each placeholder number of a contact.
const CONTACT_DIGITS: usize = 5;
static TABLE: [[u8; DIGITS]; LISTS * COUNT] = placeholder_digits();
static CONTACT_TABLE: [[u8; CONTACT_DIGITS]; CONTACTS] = placeholder_digits();

const fn placeholder_digits<const D: usize, const N: usize>() -> [[u8; D]; N] {
    let mut all = [[0; D]; N];
    let mut k = 0;
    while k < N {
        let (mut rest, mut i) = (k, D);
        while i > 0 {
            i -= 1;
            all[k][i] = b'0' + (rest % 10) as u8;
            rest /= 10;
        }
        k += 1;
    }
    all
}

/// Returns the placeholder numbers for the first names of a list.
pub(crate) const fn placeholder_numbers<const N: usize>(list: NameListKind) -> [&'static str; N] {
    let mut all = [""; N];
    let mut k = 0;
    while k < N && k < COUNT {
        all[k] = match list {
            NameListKind::Contacts => contact_placeholder(k),
            _ => digits_as_text(&TABLE[list as usize * COUNT + k]),
        };
        k += 1;
    }
    all
}

/// Returns the placeholder number of a contact; of the last one for those beyond.
pub(crate) const fn contact_placeholder(k: usize) -> &'static str {
    digits_as_text(&CONTACT_TABLE[if k < CONTACTS { k } else { CONTACTS - 1 }])
}

const fn digits_as_text(digits: &'static [u8]) -> &'static str {
    match core::str::from_utf8(digits) {
        Ok(text) => text,
        Err(_) => "",
    }
}

impl SharedMechanism {
    /// Returns the name that a placeholder number of [`placeholder_numbers`] represents.
    fn name_of_placeholder(&self, number: usize) -> Option<&str> {
        let k = number % COUNT;
        match number / COUNT {
            0 => self.configuration.get(k).map(|one| one.name.as_str()),
            1 => self.velocities.get(k).map(|one| one.name.as_str()),
            2 => self.inputs.get(k).map(|one| one.name.as_str()),
            _ => self.constraints.names.get(k).map(String::as_str),
        }
    }

    /// Replaces the placeholder numbers in backquotes of a message by names of the mechanism.
    pub(crate) fn replace_placeholders_by_names(&self, message: &str) -> String {
        let mut parts = message.split('`');
        let mut text = parts.next().unwrap_or_default().to_string();
        for part in parts {
            let number = part.parse().ok().filter(|_| part.bytes().all(|digit| digit.is_ascii_digit()));
            let name = match part.len() {
                DIGITS => number.and_then(|number| self.name_of_placeholder(number)),
                CONTACT_DIGITS => {
                    number.and_then(|k| self.contacts.get(k)).map(|contact| contact.name.as_str())
                }
                _ => None,
            };
            text.push('`');
            text.push_str(name.unwrap_or(part));
        }
        text
    }
}
