//! Contacts of cylinders with end faces, with each other and with hulls.

mod distances;
mod motions;
mod scenes;
#[path = "../polytopes/shapes.rs"]
#[allow(dead_code)]
mod shapes;
