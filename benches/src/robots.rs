//! Robots that are measured beside those of `linkwork-models`.

use linkwork::mechanism;

/// A seven-axis arm with two independent fingers.
#[mechanism(urdf = "../models/urdf/panda.urdf", mimic = independent, derivatives)]
#[derive(Clone, Copy)]
pub struct Panda;

/// A six-axis arm with joints that turn for ever.
#[mechanism(urdf = "../models/urdf/kinova.urdf", derivatives)]
#[derive(Clone, Copy)]
pub struct Kinova;
