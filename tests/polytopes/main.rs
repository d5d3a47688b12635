//! Contacts of convex hulls with hulls, boxes, capsules and cylinders.

mod boxes;
mod derivatives;
mod distances;
mod files;
mod rest;
mod shapes;
