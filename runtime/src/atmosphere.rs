//! The standard atmosphere: ISO 2533:1975 of the International Organization for Standardization and the *U.S.
//! Standard Atmosphere 1976* (NASA TM-X-74335, part 1), which agree up to 47 km; the latter extends to 86 km.
//! Above 86 km, the temperature is constant here.
//!
//! Heights are geopotential, m: `H = r h / (r + h)` for the height `h` above sea level and the Earth's radius
//! `r` of 6 356 766 m. Expressions of the language take `h`.

use crate::Real;
use crate::private::constant;

/// Standard gravitational acceleration, m/s².
const G: f64 = 9.80665;
/// Specific gas constant of air, J/(kg·K).
const R: f64 = 287.05287;
/// Air temperature at sea level, K.
const T0: f64 = 288.15;
/// Air pressure at sea level, Pa.
const P0: f64 = 101_325.0;

/// Layer of the atmosphere: its base height, m, and its temperature gradient, K/m.
struct AtmosphereLayer {
    base: f64,
    lapse: f64,
}

/// Layers of the atmosphere; the last is unbounded.
static LAYERS: [AtmosphereLayer; 8] = [
    AtmosphereLayer { base: 0.0, lapse: -6.5e-3 },
    AtmosphereLayer { base: 11_000.0, lapse: 0.0 },
    AtmosphereLayer { base: 20_000.0, lapse: 1.0e-3 },
    AtmosphereLayer { base: 32_000.0, lapse: 2.8e-3 },
    AtmosphereLayer { base: 47_000.0, lapse: 0.0 },
    AtmosphereLayer { base: 51_000.0, lapse: -2.8e-3 },
    AtmosphereLayer { base: 71_000.0, lapse: -2.0e-3 },
    AtmosphereLayer { base: 84_852.0, lapse: 0.0 },
];

/// Returns the layers of the atmosphere with the heights of their upper ends; the last layer has none.
fn layers_with_top_altitudes() -> impl Iterator<Item = (&'static AtmosphereLayer, Option<f64>)> {
    let ends = LAYERS.iter().skip(1).map(|next| Some(next.base)).chain([None]);
    LAYERS.iter().zip(ends)
}

/// Returns the depth of height `h` within a layer, m: the layer's whole thickness above it, zero below it.
/// The lowest layer is unbounded below.
fn depth_in_layer<T: Real>(h: T, layer: &AtmosphereLayer, end: Option<f64>) -> T {
    let below = end.map_or(h, |end| h.min(constant(end)));
    let inside = if layer.base > 0.0 { below.max(constant(layer.base)) } else { below };
    inside - constant(layer.base)
}

/// Returns the unit step function of `x`, lane by lane: one for a nonnegative number and zero for a negative
/// one.
fn heaviside_step<T: Real>(x: T) -> T {
    (T::one() + x.signum()) * constant(0.5)
}

/// Standard atmosphere as functions of a geopotential height, m.
pub trait Atmosphere: Real {
    /// Returns the temperature of the standard atmosphere at this height, K.
    fn isa_temperature(self) -> Self {
        layers_with_top_altitudes().fold(constant(T0), |sum, (layer, end)| {
            sum + depth_in_layer(self, layer, end) * constant(layer.lapse)
        })
    }

    /// Returns the derivative of the standard temperature with respect to height, K/m. At the boundary of two
    /// layers it is that of the upper layer.
    fn isa_lapse_rate(self) -> Self {
        let mut rate: Self = constant(0.0);
        let mut before = 0.0;
        for (k, layer) in LAYERS.iter().enumerate() {
            let above = if k == 0 {
                Self::one() + self * Self::zero()
            } else {
                heaviside_step(self - constant(layer.base))
            };
            rate += above * constant(layer.lapse - before);
            before = layer.lapse;
        }
        rate
    }

    /// Returns the pressure of the standard atmosphere at this height, Pa.
    fn isa_pressure(self) -> Self {
        let (mut pressure, mut base): (Self, f64) = (constant(P0), T0);
        for (layer, end) in layers_with_top_altitudes() {
            // Layers above have no effect; lanes that differ pass through all layers.
            if layer.base > 0.0 && self < constant(layer.base) {
                break;
            }
            let depth = depth_in_layer(self, layer, end);
            pressure *= match layer.lapse == 0.0 {
                true => (depth * constant(-G / (R * base))).exp(),
                false => {
                    let ratio = Self::one() + depth * constant(layer.lapse / base);
                    (ratio.ln() * constant(-G / (R * layer.lapse))).exp()
                }
            };
            base += end.map_or(0.0, |end| (end - layer.base) * layer.lapse);
        }
        pressure
    }
}

impl<T: Real> Atmosphere for T {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Lanes, f64x4};

    /// Published values of the *U.S. Standard Atmosphere 1976*, tables I and II: geometric height, m;
    /// temperature, K; pressure, Pa.
    const TABLE: [(f64, f64, f64); 8] = [
        (0.0, 288.150, 1.01325e5),
        (1_000.0, 281.651, 8.9876e4),
        (5_000.0, 255.676, 5.4048e4),
        (10_000.0, 223.252, 2.6499e4),
        (20_000.0, 216.650, 5.5293e3),
        (30_000.0, 226.509, 1.1970e3),
        (50_000.0, 270.650, 7.9779e1),
        (80_000.0, 198.639, 1.0524),
    ];

    fn geopotential_height(h: f64) -> f64 {
        6_356_766.0 * h / (6_356_766.0 + h)
    }

    #[test]
    fn published_atmosphere_values_are_reproduced() {
        for (h, temperature, pressure) in TABLE {
            let h = geopotential_height(h);
            assert!((h.isa_temperature() - temperature).abs() < 2e-3, "{h}: {}", h.isa_temperature());
            assert!((h.isa_pressure() / pressure - 1.0).abs() < 1e-4, "{h}: {}", h.isa_pressure());
        }
    }

    #[test]
    fn lapse_rates_match_hydrostatic_equation() {
        for h in [
            -500.0,
            300.0,
            10_999.0,
            11_001.0,
            25_000.0,
            40_000.0,
            49_000.0,
            60_000.0,
            80_000.0,
            90_000.0_f64,
        ] {
            let d = 1e-1;
            let central_difference = |f: fn(f64) -> f64| (f(h + d) - f(h - d)) / (2.0 * d);
            let expected = -G * h.isa_pressure() / (R * h.isa_temperature());
            assert!((central_difference(f64::isa_pressure) / expected - 1.0).abs() < 1e-6, "{h}");
            assert!((central_difference(f64::isa_temperature) - h.isa_lapse_rate()).abs() < 1e-9, "{h}");
        }
    }

    #[test]
    fn lanes_evaluate_different_layers() {
        let heights = [-100.0, 15_000.0, 33_000.0, 90_000.0];
        let all: f64x4 = Lanes(heights).isa_pressure();
        for (lane, h) in heights.into_iter().enumerate() {
            assert!((all.0[lane] / h.isa_pressure() - 1.0).abs() < 1e-12);
            assert_eq!(Lanes(heights).isa_lapse_rate().0[lane], h.isa_lapse_rate());
        }
    }
}
