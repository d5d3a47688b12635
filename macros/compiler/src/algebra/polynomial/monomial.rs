//! Products of powers of atoms, packed into four bits a power, so that a product of monomials is one addition.

/// Most atoms.
pub const ATOMS: usize = 64;
/// Atoms in each half.
const HALF: usize = 32;
/// The highest bit of every power: set when a power has grown too large, and free before that.
const OVERFLOW: u128 = 0x8888_8888_8888_8888_8888_8888_8888_8888;

/// A product of powers of atoms, none above the seventh. Also a set of bits of powers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Monomial {
    high: u128,
    low: u128,
}

impl Monomial {
    /// No atoms.
    pub const ONE: Monomial = Monomial { high: 0, low: 0 };

    fn bits(atom: usize, bits: u128) -> Monomial {
        match atom {
            0..HALF => Monomial { high: 0, low: bits << (4 * atom) },
            HALF..ATOMS => Monomial { high: bits << (4 * (atom - HALF)), low: 0 },
            _ => Monomial::ONE,
        }
    }

    /// An atom.
    pub fn atom(atom: usize) -> Monomial {
        Monomial::bits(atom, 1)
    }

    /// All bits of the power of an atom.
    pub fn all_of(atom: usize) -> Monomial {
        Monomial::bits(atom, 15)
    }

    /// The bits of an atom's powers above one.
    pub fn above_one(atom: usize) -> Monomial {
        Monomial::bits(atom, 14)
    }

    /// The power of an atom.
    pub fn power(self, atom: usize) -> u8 {
        let shifted = match atom {
            0..HALF => self.low >> (4 * atom),
            _ => self.high >> (4 * (atom - HALF)),
        };
        (shifted & 15) as u8
    }

    /// The atoms with their powers.
    pub fn factors(self) -> impl Iterator<Item = (usize, u8)> {
        let mut rest = self;
        std::iter::from_fn(move || {
            let atom = match (rest.low, rest.high) {
                (0, 0) => return None,
                (0, high) => HALF + high.trailing_zeros() as usize / 4,
                (low, _) => low.trailing_zeros() as usize / 4,
            };
            let power = rest.power(atom);
            rest = rest.without(Monomial::all_of(atom));
            Some((atom, power))
        })
    }

    /// The product; `None` if a power grows too large.
    pub fn times(self, other: Monomial) -> Option<Monomial> {
        // No carries: both powers are below eight.
        let product =
            Monomial { high: self.high.wrapping_add(other.high), low: self.low.wrapping_add(other.low) };
        ((product.high | product.low) & OVERFLOW == 0).then_some(product)
    }

    /// The quotient by a divisor.
    pub fn over(self, divisor: Monomial) -> Monomial {
        Monomial { high: self.high.wrapping_sub(divisor.high), low: self.low.wrapping_sub(divisor.low) }
    }

    /// True if it divides the other.
    pub fn divides(self, other: Monomial) -> bool {
        // Power by power: the free bit survives where nothing is borrowed.
        let fits = |a: u128, b: u128| (b | OVERFLOW).wrapping_sub(a) & OVERFLOW == OVERFLOW;
        fits(self.high, other.high) && fits(self.low, other.low)
    }

    /// The greatest common divisor.
    pub fn common(self, other: Monomial) -> Monomial {
        let shared = |(atom, power): (usize, u8)| Monomial::bits(atom, power.min(other.power(atom)).into());
        self.factors().map(shared).fold(Monomial::ONE, Monomial::or)
    }

    /// Sum of the powers.
    pub fn degree(self) -> u32 {
        self.factors().map(|(_, power)| u32::from(power)).sum()
    }

    /// The bits of both.
    pub fn or(self, other: Monomial) -> Monomial {
        Monomial { high: self.high | other.high, low: self.low | other.low }
    }

    /// The bits that are in a mask.
    pub fn only(self, mask: Monomial) -> Monomial {
        Monomial { high: self.high & mask.high, low: self.low & mask.low }
    }

    /// The bits that are not in a mask.
    pub fn without(self, mask: Monomial) -> Monomial {
        Monomial { high: self.high & !mask.high, low: self.low & !mask.low }
    }

    /// True if any bit is in both.
    pub fn meets(self, mask: Monomial) -> bool {
        self.only(mask) != Monomial::ONE
    }
}
