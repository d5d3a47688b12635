//! Contacts that open and close, where thousands of states or steps are looked at.

mod fuzz;
mod impacts;
#[path = "../../contact/laws.rs"]
mod laws;
mod midpoint;
mod robots;
mod tower;
