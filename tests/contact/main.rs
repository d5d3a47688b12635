//! Contacts that open and close: closed-form solutions, general contact conditions, and cases that engines
//! simulate incorrectly. A tower, robots and random states are in `motions/contact`.

mod bodies;
mod both;
mod boxes;
mod control;
mod cylinders;
mod derivatives;
mod events;
mod files;
mod forces;
mod gains;
mod gallery;
mod hulls;
mod lasting;
mod laws;
mod light;
mod mechanisms;
mod orders;
mod parameters;
mod piles;
mod poisson;
mod ratchet;
mod scenes;
mod soft;
mod starts;
mod steps;
mod stiction;
mod stopping;
mod terrain;
mod turning;
