//! Checks of the dynamics of the PUMA 560 arm against reference values.

use linkwork::mechanism;
use linkwork::nalgebra::{Matrix6, SVector, Vector6};
use std::f64::consts::FRAC_PI_2;
use support::compare::assert_close;
use support::table::Record;

/// Arm with standard Denavit–Hartenberg parameters: each joint rotates about z of the previous link, and its
/// pose on the next link is the inverse of `Tz(d) Tx(a) Rx(α)`. Inertias are parameters, since two of them
/// are physically inconsistent.
#[mechanism(gravity = -9.81 * z)]
struct Puma560 {
    i1: f64,
    i3x: f64,
    i3y: f64,
    i3z: f64,
    right: f64,
    #[body(inertia = diagonal(0, i1, 0))]
    link1: Body,
    #[body(mass = 17.4, com = [-0.3638, 0.006, 0.2275], inertia = diagonal(0.13, 0.524, 0.539))]
    link2: Body,
    #[body(mass = 4.8, com = [-0.0203, -0.0141, 0.070], inertia = diagonal(i3x, i3y, i3z))]
    link3: Body,
    #[body(mass = 0.82, com = 0.019 * y, inertia = diagonal(1.8e-3, 1.3e-3, 1.8e-3))]
    link4: Body,
    #[body(mass = 0.34, inertia = diagonal(0.3e-3, 0.4e-3, 0.3e-3))]
    link5: Body,
    #[body(mass = 0.09, com = 0.032 * z, inertia = diagonal(0.15e-3, 0.15e-3, 0.04e-3))]
    link6: Body,
    #[joint(ground -> link1.at(-0.672 * y).rotated(x(-right)), about = z)]
    waist: Pin,
    #[joint(link1 -> link2.at(-0.4318 * x), about = z)]
    shoulder: Pin,
    #[joint(link2 -> link3.at(-0.0203 * x + 0.15005 * y).rotated(x(right)), about = z)]
    elbow: Pin,
    #[joint(link3 -> link4.at(-0.4318 * y).rotated(x(-right)), about = z)]
    wrist1: Pin,
    #[joint(link4 -> link5.rotated(x(right)), about = z)]
    wrist2: Pin,
    #[joint(link5 -> link6, about = z)]
    wrist3: Pin,
}

#[test]
fn puma560_agrees_with_the_published_dynamics() {
    let robot = Puma560 { i1: 0.35, i3x: 0.066, i3y: 0.086, i3z: 0.0125, right: FRAC_PI_2 };
    let table = Record::load("problems/puma560.json");
    let q = SVector::from(table.rows_with_key::<6>("configuration")[0]);
    let links = Matrix6::from_fn(|i, j| table.rows_with_key::<6>("mass_matrix")[i][j]);
    let gravity = SVector::from(table.rows_with_key::<6>("gravity")[0]);
    let coriolis = SVector::from(table.rows_with_key::<6>("coriolis")[0]);

    let mass_matrix = robot.mass_matrix(&q);
    assert_close("mass matrix", mass_matrix.as_slice(), links.as_slice(), 1e-12);
    let load = robot.bias_forces(&q, &SVector::zeros());
    assert_close("gravity", load.as_slice(), gravity.as_slice(), 1e-12);
    let v = Vector6::new(1.0, 2.0, 3.0, 1.0, 2.0, 3.0);
    let turning = robot.bias_forces(&q, &v) - load;
    assert_close("Coriolis forces", turning.as_slice(), coriolis.as_slice(), 1e-12);

    // Published to four decimals, with the reflected motor inertias Jm G² on the diagonal.
    let motor = Vector6::new(200e-6, 200e-6, 200e-6, 33e-6, 33e-6, 33e-6);
    let gear = Vector6::new(-62.6111, 107.815, -53.7063, 76.0364, 71.923, 76.686);
    let with_motors = mass_matrix + Matrix6::from_diagonal(&motor.component_mul(&gear).component_mul(&gear));
    #[rustfmt::skip]
    let published = Matrix6::new(
        3.6594, -0.4044, 0.1006, -0.0025, 0.0, 0.0,
        -0.4044, 4.4137, 0.3509, 0.0, 0.0024, 0.0,
        0.1006, 0.3509, 0.9378, 0.0, 0.0015, 0.0,
        -0.0025, 0.0, 0.0, 0.1925, 0.0, 0.0,
        0.0, 0.0024, 0.0015, 0.0, 0.1713, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.1941,
    );
    assert_close("published mass matrix", with_motors.as_slice(), published.as_slice(), 5e-5);
    let published = [0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0];
    assert_close("published gravity", load.as_slice(), &published, 5e-5);
    let published = [3.1500, 9.4805, 3.6189, 0.1901, 0.3519, 0.5823];
    assert_close("published M v", (with_motors * v).as_slice(), &published, 5e-5);
    let published = [3.35311, 36.0025, 7.42596, 0.190043, 0.203441, 0.194133];
    let forces = with_motors * Vector6::repeat(1.0) + load;
    assert_close("published M a + g", forces.as_slice(), &published, 5e-6);
}
