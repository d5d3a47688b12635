//! Contacts of convex hulls with hulls, boxes, capsules and cylinders, and of cylinders with cylinders.

mod boxes;
mod cylinders;
mod derivatives;
mod distances;
mod files;
mod rest;
mod shapes;
