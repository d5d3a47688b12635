//! Contacts of cylinders with end faces, with each other and with hulls.

mod distances;
mod motions;
mod scenes;
