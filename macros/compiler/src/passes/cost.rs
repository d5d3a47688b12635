//! Estimated costs of placements and mass properties: operations of inverse dynamics, mass matrix and forward
//! dynamics together, for a link in the middle of an arm.

use super::candidates::FrameChoiceData;
use super::motions::FrameFreedom;
use super::number::{
    Matrix, NumericFrame, Vector, clean_rotation, column, cross, dot, matrix_times_vector,
    multiply_transposed, norm, round_noise_to_zero, unit_axis,
};
use std::f64::consts::FRAC_PI_2;

/// Cost of a rotation about a coordinate axis, in units of the cost model.
const TURN: f64 = 150.0;
/// Cost of a component of a translation, relative to other costs of a frame.
pub const LENGTH: f64 = 80.0;
/// Cost of adding a constant to an angle, in units of the cost model.
const OFFSET: f64 = 3.0;
/// Cost of a component of the first moment normal to the axis.
const MOMENT: f64 = 20.0;
/// Cost of a nonzero off-diagonal entry (product of inertia) of an inertia tensor.
pub const PRODUCT: f64 = 12.0;
/// Factor of the costs of offsets, moments and products of inertia for a joint on the ground, where forces
/// are not needed.
const GROUND: f64 = 0.02;

/// Returns the cheapest placement of a link's new frame `frame` in its parent's frame `parent`: cost,
/// placement, and the angle to be added to the joint. Returns `None` if the placement is not numeric.
pub fn cheapest_joint_placement(
    site: &FrameChoiceData,
    parent: &NumericFrame,
    frame: &NumericFrame,
) -> Option<(f64, NumericFrame, f64)> {
    let plain = site.place.as_ref()?.placement_in_changed_frames(parent, frame);
    let mut best = (placement_cost(site, &plain, frame), plain, 0.0);
    if let FrameFreedom::Turn { k, offset: true } = site.freedom {
        for (rotation, angle) in sparse_rotations_with_angles(&plain.rotation, k) {
            let place = NumericFrame { rotation, ..plain };
            let angle = round_noise_to_zero(angle, 1.0);
            let cost = placement_cost(site, &place, frame) + if angle == 0.0 { 0.0 } else { OFFSET };
            if cost < best.0 - 1e-9 {
                best = (cost, place, -angle);
            }
        }
    }
    Some(best)
}

fn placement_cost(site: &FrameChoiceData, place: &NumericFrame, frame: &NumericFrame) -> f64 {
    let mut lengths = place.translation;
    if let FrameFreedom::Slide { along } = site.freedom {
        // The displacement has all components of the sliding axis.
        let turned = multiply_transposed(&frame.rotation, along);
        let way = matrix_times_vector(&place.rotation, turned);
        lengths = std::array::from_fn(|k| lengths[k].abs() + way[k].abs());
    }
    let cost = TURN * coordinate_rotation_count(&place.rotation) + LENGTH * nonzero_component_count(lengths);
    if site.parent.is_none() { GROUND * cost } else { cost }
}

fn nonzero_component_count(v: Vector) -> f64 {
    v.iter().filter(|c| **c != 0.0).count() as f64
}

/// Returns the number of rotations about coordinate axes in a rotation; right angles do not count.
fn coordinate_rotation_count(m: &Matrix) -> f64 {
    match m.iter().flatten().filter(|e| **e == 0.0).count() {
        6 => 0.0,
        4 => 1.0,
        0 => 3.0,
        _ => 2.0,
    }
}

/// Returns sparse rotations `m R` with their angles, where `R` rotates by the angle about coordinate axis
/// `k`.
fn sparse_rotations_with_angles(m: &Matrix, k: usize) -> Vec<(Matrix, f64)> {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let u = column(m, k);
    let mut found = Vec::new();
    for r in 0..3 {
        let across = if u[r] == 0.0 { unit_axis(r) } else { cross(unit_axis(r), u) };
        let length = norm(across);
        if length == 0.0 {
            continue;
        }
        let n = across.map(|c| c / length);
        let mut angle = libm::atan2(dot(n, column(m, j)), dot(n, column(m, i)));
        let mut x = n;
        // Right angles cost nothing: the angle is reduced to within 45°.
        while angle.abs() > 0.5 * FRAC_PI_2 + 1e-6 {
            x = if angle > 0.0 { cross(x, u) } else { cross(u, x) };
            angle -= FRAC_PI_2.copysign(angle);
        }
        let y = cross(u, x);
        let mut rotation = *m;
        for row in 0..3 {
            (rotation[row][i], rotation[row][j]) = (x[row], y[row]);
        }
        found.push((clean_rotation(&rotation), angle));
    }
    found
}

/// Returns the cost of the mass properties resolved in a frame.
pub fn cost_of_mass_properties(site: &FrameChoiceData, frame: &NumericFrame) -> f64 {
    let Some(mass) = &site.mass else { return 0.0 };
    let seen = mass.mass_properties_in_frame(frame);
    let along = match site.freedom {
        FrameFreedom::Turn { k, .. } => k,
        _ => 3,
    };
    let moments = (0..3).filter(|k| *k != along && seen.moment[*k] != 0.0).count() as f64;
    let products = [(0, 1), (0, 2), (1, 2)].iter().filter(|(i, j)| seen.tensor[*i][*j] != 0.0).count() as f64;
    let cost = MOMENT * moments + PRODUCT * products;
    if site.parent.is_none() { GROUND * cost } else { cost }
}
