//! Standard atmosphere, computed as in the runtime: ISO 2533:1975 and the *U.S. Standard Atmosphere 1976*.

/// Standard gravity divided by the gas constant of air, K/m.
pub const FALL_OVER_GAS: f64 = 9.80665 / GAS;
/// Specific gas constant of air, J/(kg·K).
pub const GAS: f64 = 287.05287;
/// Ratio of the specific heat capacities of air.
pub const HEATS: f64 = 1.4;
/// Radius of the Earth in the definition of geopotential height, m.
pub const RADIUS: f64 = 6_356_766.0;

/// Base of each layer, m geopotential height, and its temperature gradient, K/m.
const LAYERS: [(f64, f64); 8] = [
    (0.0, -6.5e-3),
    (11_000.0, 0.0),
    (20_000.0, 1.0e-3),
    (32_000.0, 2.8e-3),
    (47_000.0, 0.0),
    (51_000.0, -2.8e-3),
    (71_000.0, -2.0e-3),
    (84_852.0, 0.0),
];

/// Returns temperature, K, pressure, Pa, and temperature gradient, K/m, at a geopotential height, m.
fn atmosphere_at_height(h: f64) -> [f64; 3] {
    let (mut temperature, mut pressure) = (288.15, 101_325.0);
    for (k, (base, lapse)) in LAYERS.iter().enumerate() {
        let end = LAYERS.get(k + 1).map_or(f64::INFINITY, |(end, _)| *end);
        let depth = h.min(end) - base;
        let next = temperature + depth * lapse;
        pressure *= match *lapse == 0.0 {
            true => libm::exp(-FALL_OVER_GAS * depth / temperature),
            false => libm::pow(next / temperature, -FALL_OVER_GAS / lapse),
        };
        temperature = next;
        if h < end {
            return [temperature, pressure, *lapse];
        }
    }
    [temperature, pressure, f64::NAN]
}

/// Returns the temperature of the standard atmosphere, K, at a geopotential height, m.
pub fn temperature(h: f64) -> f64 {
    atmosphere_at_height(h)[0]
}

/// Returns the pressure of the standard atmosphere, Pa, at a geopotential height, m.
pub fn pressure(h: f64) -> f64 {
    atmosphere_at_height(h)[1]
}

/// Returns the temperature gradient, K/m, at a geopotential height, m.
pub fn temperature_gradient(h: f64) -> f64 {
    atmosphere_at_height(h)[2]
}
