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

/// Number of placeholder names in each list.
const COUNT: usize = 1000;
/// Number of digits of each placeholder number.
const DIGITS: usize = 4;
const TABLE: &[[u8; DIGITS]; 5 * COUNT] = &placeholder_digits();

const fn placeholder_digits() -> [[u8; DIGITS]; 5 * COUNT] {
    let mut all = [[0; DIGITS]; 5 * COUNT];
    let mut k = 0;
    while k < all.len() {
        let (mut rest, mut i) = (k, DIGITS);
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
        if let Ok(text) = core::str::from_utf8(&TABLE[list as usize * COUNT + k]) {
            all[k] = text;
        }
        k += 1;
    }
    all
}

impl SharedMechanism {
    /// Returns the name that a placeholder number of [`placeholder_numbers`] represents.
    fn name_of_placeholder(&self, number: usize) -> Option<&str> {
        let k = number % COUNT;
        match number / COUNT {
            0 => self.configuration.get(k).map(|one| one.name.as_str()),
            1 => self.velocities.get(k).map(|one| one.name.as_str()),
            2 => self.inputs.get(k).map(|one| one.name.as_str()),
            3 => self.constraints.names.get(k).map(String::as_str),
            _ => self.contacts.get(k).map(|one| one.name.as_str()),
        }
    }

    /// Replaces the placeholder numbers in backquotes of a message by names of the mechanism.
    pub(crate) fn replace_placeholders_by_names(&self, message: &str) -> String {
        let mut parts = message.split('`');
        let mut text = parts.next().unwrap_or_default().to_string();
        for part in parts {
            let is_number = part.len() == DIGITS && part.bytes().all(|digit| digit.is_ascii_digit());
            let name =
                part.parse().ok().filter(|_| is_number).and_then(|number| self.name_of_placeholder(number));
            text.push('`');
            text.push_str(name.unwrap_or(part));
        }
        text
    }
}
