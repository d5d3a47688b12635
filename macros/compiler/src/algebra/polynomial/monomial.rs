//! Products of powers of atoms, packed with four bits per power, so that a product of monomials is one
//! integer addition.

/// Maximum number of atoms of a ring.
pub const ATOMS: usize = 64;
/// Number of atoms in each 128-bit half of a monomial.
const HALF: usize = 32;
/// The highest bit of every power: set after an overflow, otherwise zero.
const OVERFLOW: u128 = 0x8888_8888_8888_8888_8888_8888_8888_8888;

/// Product of powers of atoms, with powers of at most seven. The type also serves as a bit mask of such
/// powers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Monomial {
    high: u128,
    low: u128,
}

impl Monomial {
    /// Monomial one: the empty product.
    pub const ONE: Monomial = Monomial { high: 0, low: 0 };

    fn monomial_with_bits(atom: usize, bits: u128) -> Monomial {
        match atom {
            0..HALF => Monomial { high: 0, low: bits << (4 * atom) },
            HALF..ATOMS => Monomial { high: bits << (4 * (atom - HALF)), low: 0 },
            _ => Monomial::ONE,
        }
    }

    /// Returns the monomial that is the first power of an atom.
    pub fn first_power_of_atom(atom: usize) -> Monomial {
        Monomial::monomial_with_bits(atom, 1)
    }

    /// Returns a mask of all bits of the power of an atom.
    pub fn power_mask_of_atom(atom: usize) -> Monomial {
        Monomial::monomial_with_bits(atom, 15)
    }

    /// Returns a mask of the bits that are set only in powers of the atom above one.
    pub fn bits_above_first_power(atom: usize) -> Monomial {
        Monomial::monomial_with_bits(atom, 14)
    }

    /// Returns the power of an atom in the monomial.
    pub fn power_of_atom(self, atom: usize) -> u8 {
        let shifted = match atom {
            0..HALF => self.low >> (4 * atom),
            _ => self.high >> (4 * (atom - HALF)),
        };
        (shifted & 15) as u8
    }

    /// Returns the atoms of the monomial with their powers.
    pub fn atoms_with_powers(self) -> impl Iterator<Item = (usize, u8)> {
        let mut rest = self;
        std::iter::from_fn(move || {
            let atom = match (rest.low, rest.high) {
                (0, 0) => return None,
                (0, high) => HALF + high.trailing_zeros() as usize / 4,
                (low, _) => low.trailing_zeros() as usize / 4,
            };
            let power = rest.power_of_atom(atom);
            rest = rest.clear_mask(Monomial::power_mask_of_atom(atom));
            Some((atom, power))
        })
    }

    /// Multiplies two monomials. `None` if a power exceeds seven.
    pub fn checked_product(self, other: Monomial) -> Option<Monomial> {
        // No carries into the next power: both powers are below eight.
        let product =
            Monomial { high: self.high.wrapping_add(other.high), low: self.low.wrapping_add(other.low) };
        ((product.high | product.low) & OVERFLOW == 0).then_some(product)
    }

    /// Divides the monomial by one of its divisors.
    pub fn quotient(self, divisor: Monomial) -> Monomial {
        Monomial { high: self.high.wrapping_sub(divisor.high), low: self.low.wrapping_sub(divisor.low) }
    }

    /// Returns true if this monomial divides the other one.
    pub fn is_divisor_of(self, other: Monomial) -> bool {
        // Compares power by power: the overflow bit stays set unless the subtraction borrows from it.
        let has_no_larger_power = |a: u128, b: u128| (b | OVERFLOW).wrapping_sub(a) & OVERFLOW == OVERFLOW;
        has_no_larger_power(self.high, other.high) && has_no_larger_power(self.low, other.low)
    }

    /// Returns the greatest common divisor of two monomials.
    pub fn greatest_common_divisor(self, other: Monomial) -> Monomial {
        let common_power_of_atom = |(atom, power): (usize, u8)| {
            Monomial::monomial_with_bits(atom, power.min(other.power_of_atom(atom)).into())
        };
        self.atoms_with_powers().map(common_power_of_atom).fold(Monomial::ONE, Monomial::union_of_bits)
    }

    /// Returns the degree of the monomial: the sum of its powers.
    pub fn degree(self) -> u32 {
        self.atoms_with_powers().map(|(_, power)| u32::from(power)).sum()
    }

    /// Returns the union of the bits of two masks.
    pub fn union_of_bits(self, other: Monomial) -> Monomial {
        Monomial { high: self.high | other.high, low: self.low | other.low }
    }

    /// Returns the bits of the monomial that are set in a mask.
    pub fn restrict_to_mask(self, mask: Monomial) -> Monomial {
        Monomial { high: self.high & mask.high, low: self.low & mask.low }
    }

    /// Returns the bits of the monomial that are not set in a mask.
    pub fn clear_mask(self, mask: Monomial) -> Monomial {
        Monomial { high: self.high & !mask.high, low: self.low & !mask.low }
    }

    /// Returns true if the mask shares a bit with this monomial.
    pub fn intersects_mask(self, mask: Monomial) -> bool {
        self.restrict_to_mask(mask) != Monomial::ONE
    }
}
