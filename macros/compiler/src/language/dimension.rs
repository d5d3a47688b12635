//! Dimensions: exponents of length, mass and time, and of unknown dimensions.

use super::ratio::Ratio;

/// Index of an unknown dimension in unit inference.
pub type UnknownDimensionIndex = usize;

/// A dimension: powers of metre, kilogram and second, times powers of unknown dimensions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dimension {
    /// Exponents of length, mass and time in the dimension.
    pub base: [Ratio; 3],
    /// Nonzero exponents of the unknown dimensions, in ascending order of their numbers.
    pub unknown: Vec<(UnknownDimensionIndex, Ratio)>,
}

impl Dimension {
    /// Returns a dimension from its powers of metre, kilogram and second.
    pub const fn new(length: i64, mass: i64, time: i64) -> Dimension {
        let base = [Ratio::from_integer(length), Ratio::from_integer(mass), Ratio::from_integer(time)];
        Dimension { base, unknown: Vec::new() }
    }

    /// Returns the dimension that consists of a single unknown.
    pub fn unknown_dimension(v: UnknownDimensionIndex) -> Dimension {
        Dimension { unknown: vec![(v, Ratio::ONE)], ..Dimension::new(0, 0, 0) }
    }

    /// Returns true if the dimension contains no unknown.
    pub fn is_known(&self) -> bool {
        self.unknown.is_empty()
    }

    /// Returns whether the dimension is that of plain numbers and angles (all exponents zero).
    pub fn is_plain(&self) -> bool {
        self.is_known() && self.base.iter().all(|e| e.is_zero())
    }

    /// Returns the exponent of an unknown dimension.
    pub fn exponent_of_unknown(&self, v: UnknownDimensionIndex) -> Ratio {
        self.unknown.iter().find(|(u, _)| *u == v).map_or(Ratio::ZERO, |(_, e)| *e)
    }

    /// Returns the dimension of a product of two quantities.
    pub fn dimension_of_product(&self, other: &Dimension) -> Option<Dimension> {
        self.times_power(other, Ratio::ONE)
    }

    /// Returns the dimension of a quotient of two quantities.
    pub fn dimension_of_quotient(&self, other: &Dimension) -> Option<Dimension> {
        self.times_power(other, Ratio::from_integer(-1))
    }

    /// Returns the dimension of a power of a quantity.
    pub fn dimension_of_power(&self, exponent: Ratio) -> Option<Dimension> {
        Dimension::new(0, 0, 0).times_power(self, exponent)
    }

    /// Returns the dimension `self × other^exponent`, or `None` if the exponents become too large.
    pub fn times_power(&self, other: &Dimension, exponent: Ratio) -> Option<Dimension> {
        let mut base = self.base;
        for (sum, e) in base.iter_mut().zip(other.base) {
            *sum = sum.checked_sum(e.checked_product(exponent)?)?;
        }
        let mut unknown = Vec::with_capacity(self.unknown.len() + other.unknown.len());
        let (mut left, mut right) = (self.unknown.iter().peekable(), other.unknown.iter().peekable());
        loop {
            let (a, b) = (left.peek().map(|(v, _)| *v), right.peek().map(|(v, _)| *v));
            let Some(v) = a.into_iter().chain(b).min() else { break };
            let mut sum = left.next_if(|_| a == Some(v)).map_or(Ratio::ZERO, |(_, e)| *e);
            if let Some((_, e)) = right.next_if(|_| b == Some(v)) {
                sum = sum.checked_sum(e.checked_product(exponent)?)?;
            }
            if !sum.is_zero() {
                unknown.push((v, sum));
            }
        }
        Some(Dimension { base, unknown })
    }
}

/// Dimension of plain numbers and angles: all exponents are zero.
pub const PLAIN: Dimension = Dimension::new(0, 0, 0);
/// Dimension of a length, m.
pub const LENGTH: Dimension = Dimension::new(1, 0, 0);
/// Dimension of a mass, kg.
pub const MASS: Dimension = Dimension::new(0, 1, 0);
/// Dimension of a time, s.
pub const TIME: Dimension = Dimension::new(0, 0, 1);
/// Dimension of a speed, m/s.
pub const SPEED: Dimension = Dimension::new(1, 0, -1);
/// Dimension of the reciprocal of a speed, s/m.
pub const SLOWNESS: Dimension = Dimension::new(-1, 0, 1);
/// Dimension of an acceleration, m/s².
pub const ACCELERATION: Dimension = Dimension::new(1, 0, -2);
/// Dimension of the rate of an angle, 1/s.
pub const RATE: Dimension = Dimension::new(0, 0, -1);
/// Dimension of an angular acceleration, 1/s².
pub const RATE_OF_RATE: Dimension = Dimension::new(0, 0, -2);
/// Dimension of a moment of inertia, kg·m².
pub const INERTIA: Dimension = Dimension::new(2, 1, 0);
/// Dimension of a force, N.
pub const FORCE: Dimension = Dimension::new(1, 1, -2);
/// Dimension of a density, kg/m³.
pub const DENSITY: Dimension = Dimension::new(-3, 1, 0);
/// Dimension of a pressure, Pa.
pub const PRESSURE: Dimension = Dimension::new(-1, 1, -2);
/// Dimension of an energy, J, or a torque, N·m.
pub const ENERGY: Dimension = Dimension::new(2, 1, -2);
/// Dimension of a momentum, kg·m/s.
pub const MOMENTUM: Dimension = Dimension::new(1, 1, -1);
/// Dimension of an angular momentum, kg·m²/s.
pub const ANGULAR_MOMENTUM: Dimension = Dimension::new(2, 1, -1);
/// Dimension of a power, W.
pub const POWER: Dimension = Dimension::new(2, 1, -3);
/// Strength of an attraction by the square of the distance, N·m².
pub const STRENGTH: Dimension = Dimension::new(3, 1, -2);
/// Dimension of the constant of gravity, m³/(kg·s²).
pub const GRAVITATION: Dimension = Dimension::new(3, -1, -2);
/// Dimension of a gravitational parameter, m³/s².
pub const ATTRACTION: Dimension = Dimension::new(3, 0, -2);
