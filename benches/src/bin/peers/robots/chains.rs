//! Serial chains of several lengths, with constant values and with parameters.

use super::*;
use linkwork_benches::chains;

include!(concat!(env!("OUT_DIR"), "/chains.rs"));

/// Returns a chain with constant values, with parameters, and with prepared parameters.
macro_rules! chain {
    ($name:literal, $n:literal, $type:ident, $symbolic:ident, $prepared:ident, $($functions:ident)+) => {
        robot!(
            $name,
            chains::urdf($n),
            Options::default(),
            $type,
            $(
                $functions!($type, $type {}, Linkwork),
                $functions!($symbolic, $symbolic::with_link_values(), Parameters),
                $functions!($prepared, $symbolic::with_link_values().prepare(), Prepared)
            ),+
        )
    };
}

/// Returns the constructors of all chains of the comparison.
pub fn chain_robot_constructors() -> Vec<fn() -> RobotWithContenders> {
    vec![
        || chain!("chain_6", 6, Chain6, Chain6Parameters, PreparedChain6Parameters, functions derivatives),
        || chain!("chain_16", 16, Chain16, Chain16Parameters, PreparedChain16Parameters, functions derivatives),
        || chain!("chain_32", 32, Chain32, Chain32Parameters, PreparedChain32Parameters, functions),
        || chain!("chain_64", 64, Chain64, Chain64Parameters, PreparedChain64Parameters, functions),
    ]
}
