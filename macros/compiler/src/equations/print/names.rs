//! Splitting of names for typesetting: `theta2` becomes θ with an index, `k_spring` becomes k with a word as
//! subscript.

/// Name of a symbol, split into base and subscripts.
#[derive(Clone, Debug, PartialEq)]
pub struct SymbolName {
    /// Part of the name that is typeset on the line.
    pub base: NameFragment,
    /// Subscripts of the name.
    pub indices: Vec<NameFragment>,
}

/// Indivisible part of a printed name.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names say it all")]
pub enum NameFragment {
    Letter(char),
    /// Greek letter: its English name and its character.
    Greek(&'static str, char),
    Digits(String),
    Word(String),
}

/// Greek letters that differ from Latin letters, except π, which is reserved for the number.
const GREEK: [(&str, char); 34] = [
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ϵ'),
    ("varepsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("iota", 'ι'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("upsilon", 'υ'),
    ("phi", 'ϕ'),
    ("varphi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
    ("Gamma", 'Γ'),
    ("Delta", 'Δ'),
    ("Theta", 'Θ'),
    ("Lambda", 'Λ'),
    ("Xi", 'Ξ'),
    ("Sigma", 'Σ'),
    ("Upsilon", 'Υ'),
    ("Phi", 'Φ'),
    ("Psi", 'Ψ'),
    ("Omega", 'Ω'),
];

impl NameFragment {
    fn from_word(word: &str) -> NameFragment {
        let mut letters = word.chars();
        let single = letters.next().filter(|_| letters.next().is_none());
        let greek = GREEK.iter().find(|(name, letter)| *name == word || Some(*letter) == single);
        match (greek, single) {
            (Some((name, letter)), _) => NameFragment::Greek(name, *letter),
            _ if word.bytes().all(|b| b.is_ascii_digit()) => NameFragment::Digits(word.to_string()),
            (None, Some(letter)) if letter.is_alphabetic() => NameFragment::Letter(letter),
            _ => NameFragment::Word(word.to_string()),
        }
    }
}

impl SymbolName {
    /// Returns a name that is typeset as one word, without subscripts.
    pub fn single_word_name(text: &str) -> SymbolName {
        SymbolName { base: NameFragment::Word(text.to_string()), indices: Vec::new() }
    }

    /// Splits a name into base and subscripts.
    pub fn parse(text: &str) -> SymbolName {
        if let Some((joint, member)) = text.split_once('.') {
            return SymbolName::name_of_joint_coordinate(joint, member);
        }
        if text.split('_').any(str::is_empty) {
            return SymbolName::single_word_name(text);
        }
        let (head, tail) = text.split_once('_').map_or((text, None), |(head, tail)| (head, Some(tail)));
        let (stem, digits) = split_trailing_digits(head);
        let base = NameFragment::from_word(stem);
        let digits_of_index =
            |digits: &str| (!digits.is_empty()).then(|| NameFragment::Digits(digits.to_string()));
        if let NameFragment::Letter(_) | NameFragment::Greek(..) = base {
            let indices =
                digits_of_index(digits).into_iter().chain(tail.map(NameFragment::from_word)).collect();
            return SymbolName { base, indices };
        }
        let (stem, digits) = split_trailing_digits(text);
        let stem = stem.trim_end_matches('_');
        SymbolName {
            base: NameFragment::Word(stem.to_string()),
            indices: digits_of_index(digits).into_iter().collect(),
        }
    }

    /// Splits the name of a coordinate of a joint with several coordinates. Angular velocities, velocities
    /// and quaternions have an axis as second subscript.
    fn name_of_joint_coordinate(joint: &str, member: &str) -> SymbolName {
        let joint = NameFragment::from_word(joint);
        let mut letters = member.chars();
        if let (Some(kind @ ('w' | 'v' | 'q' | 'r' | 'd')), Some(axis @ 'w'..='z'), None) =
            (letters.next(), letters.next(), letters.next())
        {
            let base =
                if kind == 'w' { NameFragment::Greek("omega", 'ω') } else { NameFragment::Letter(kind) };
            return SymbolName { base, indices: vec![joint, NameFragment::Letter(axis)] };
        }
        SymbolName { base: NameFragment::from_word(member), indices: vec![joint] }
    }
}

/// Splits a word before its trailing digits.
fn split_trailing_digits(text: &str) -> (&str, &str) {
    text.split_at(text.trim_end_matches(|c: char| c.is_ascii_digit()).len())
}

/// Returns a name in plain text, with a prime for each differentiation.
pub fn name_with_primes((name, dots): (String, u8)) -> String {
    name + &"'".repeat(usize::from(dots))
}

/// Typeset names of all symbols. Names that would be indistinguishable after splitting into subscripts are
/// not split.
pub struct TypesetNames(Vec<(String, SymbolName)>);

impl TypesetNames {
    /// Creates the table of typeset names for all names that occur.
    pub fn new<'a>(texts: impl Iterator<Item = &'a str>) -> TypesetNames {
        let mut names: Vec<(String, SymbolName)> = Vec::new();
        for text in texts {
            if names.iter().all(|(known, _)| known != text) {
                names.push((text.to_string(), SymbolName::parse(text)));
            }
        }
        let is_ambiguous = |name: &SymbolName| names.iter().filter(|(_, other)| other == name).count() > 1;
        let ambiguous: Vec<bool> = names.iter().map(|(_, name)| is_ambiguous(name)).collect();
        for ((text, name), _) in names.iter_mut().zip(ambiguous).filter(|(_, ambiguous)| *ambiguous) {
            *name = SymbolName::single_word_name(text);
        }
        TypesetNames(names)
    }

    /// Returns the typeset form of a name in the table.
    pub fn typeset_name(&self, text: &str) -> SymbolName {
        self.0
            .iter()
            .find(|(known, _)| known == text)
            .map_or_else(|| SymbolName::parse(text), |(_, name)| name.clone())
    }
}
