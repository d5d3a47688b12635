//! Contacts that open and close, tested with thousands of states or steps.

mod cans;
mod fuzz;
mod impacts;
#[path = "../../contact/laws.rs"]
mod laws;
mod midpoint;
mod robots;
mod scenes;
mod tower;
