//! A jet transport, for tests.

use linkwork_design::StateSpace;
use nalgebra::{DMatrix, dmatrix};

/// Returns a jet transport at Mach 0.8 and 40 000 ft in lateral motion, from "Yaw Damper Design for a 747"
/// (Control System Toolbox).
pub fn jet_transport() -> StateSpace {
    let a = dmatrix![
        -0.0558, -0.9968, 0.0802, 0.0415;
        0.598, -0.115, -0.0318, 0.0;
        -3.05, 0.388, -0.4650, 0.0;
        0.0, 0.0805, 1.0, 0.0
    ];
    let b = dmatrix![0.00729, 0.0; -0.475, 0.00775; 0.153, 0.143; 0.0, 0.0];
    let c = dmatrix![0.0, 1.0, 0.0, 0.0; 0.0, 0.0, 0.0, 1.0];
    let system = StateSpace::new(a, b, c, DMatrix::zeros(2, 2)).unwrap();
    let system = system.with_states([
        ("sideslip", "rad"),
        ("yaw rate", "rad/s"),
        ("roll rate", "rad/s"),
        ("bank", "rad"),
    ]);
    let system = system.unwrap().with_inputs([("rudder", "rad"), ("aileron", "rad")]).unwrap();
    system.with_outputs([("yaw rate", "rad/s"), ("bank", "rad")]).unwrap()
}
