//! Mechanisms with constraints, held to published and recomputed results.

mod bicycle;
mod counts;
mod formulations;
mod linkages;
mod reactions;
mod rolling;
mod skates;
