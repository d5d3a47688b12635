//! Contacts that open and close: closed forms, laws that always hold, and what engines get wrong.

mod bodies;
mod both;
mod boxes;
mod derivatives;
mod events;
mod files;
mod forces;
mod fuzz;
mod gains;
mod gallery;
mod laws;
mod mechanisms;
mod midpoint;
mod orders;
mod piles;
mod poisson;
mod ratchet;
mod robots;
mod soft;
mod starts;
mod terrain;
mod turning;
