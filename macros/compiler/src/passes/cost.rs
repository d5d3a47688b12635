//! What placements and mass properties cost, roughly: operations of inverse dynamics, mass matrix and forward dynamics
//! together, for a link in the middle of an arm.

use super::candidates::Site;
use super::motions::Freedom;
use super::number::{
    Frame, Matrix, Vector, axis, clean, clean_rotation, column, cross, dot, norm, times, transposed_times,
};
use std::f64::consts::FRAC_PI_2;

/// A rotation about a coordinate axis.
const TURN: f64 = 150.0;
/// A component of a translation.
pub const LENGTH: f64 = 80.0;
/// An addition to an angle.
const OFFSET: f64 = 3.0;
/// A component of the first moment normal to the axis.
const MOMENT: f64 = 20.0;
/// A product of inertia.
pub const PRODUCT: f64 = 12.0;
/// The part of these costs that a joint on the ground has: forces on the ground do not matter.
const GROUND: f64 = 0.02;

/// The cheapest way to place a link's new frame `frame` in its parent's `parent`: cost, placement, and the angle that
/// is left to the joint. `None` if the placement is not made of numbers.
pub fn joint(site: &Site, parent: &Frame, frame: &Frame) -> Option<(f64, Frame, f64)> {
    let plain = site.place.as_ref()?.between(parent, frame);
    let mut best = (placement(site, &plain, frame), plain, 0.0);
    if let Freedom::Turn { k, offset: true } = site.freedom {
        for (rotation, angle) in alignments(&plain.rotation, k) {
            let place = Frame { rotation, ..plain };
            let angle = clean(angle, 1.0);
            let cost = placement(site, &place, frame) + if angle == 0.0 { 0.0 } else { OFFSET };
            if cost < best.0 - 1e-9 {
                best = (cost, place, -angle);
            }
        }
    }
    Some(best)
}

fn placement(site: &Site, place: &Frame, frame: &Frame) -> f64 {
    let mut lengths = place.translation;
    if let Freedom::Slide { along } = site.freedom {
        // The way goes through all components of the sliding axis.
        let turned = transposed_times(&frame.rotation, along);
        let way = times(&place.rotation, turned);
        lengths = std::array::from_fn(|k| lengths[k].abs() + way[k].abs());
    }
    let cost = TURN * turns(&place.rotation) + LENGTH * nonzero(lengths);
    if site.parent.is_none() { GROUND * cost } else { cost }
}

fn nonzero(v: Vector) -> f64 {
    v.iter().filter(|c| **c != 0.0).count() as f64
}

/// How many rotations about coordinate axes a rotation takes, beside those by right angles.
fn turns(m: &Matrix) -> f64 {
    match m.iter().flatten().filter(|e| **e == 0.0).count() {
        6 => 0.0,
        4 => 1.0,
        0 => 3.0,
        _ => 2.0,
    }
}

/// Rotations `m R` that are sparse, with `R` a rotation by the angle about coordinate axis `k`.
fn alignments(m: &Matrix, k: usize) -> Vec<(Matrix, f64)> {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let u = column(m, k);
    let mut found = Vec::new();
    for r in 0..3 {
        let across = if u[r] == 0.0 { axis(r) } else { cross(axis(r), u) };
        let length = norm(across);
        if length == 0.0 {
            continue;
        }
        let n = across.map(|c| c / length);
        let mut angle = dot(n, column(m, j)).atan2(dot(n, column(m, i)));
        let mut x = n;
        // By right angles back to within 45°: that costs nothing.
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

/// Cost of the mass properties seen from a frame.
pub fn masses(site: &Site, frame: &Frame) -> f64 {
    let Some(mass) = &site.mass else { return 0.0 };
    let seen = mass.seen_from(frame);
    let along = match site.freedom {
        Freedom::Turn { k, .. } => k,
        _ => 3,
    };
    let moments = (0..3).filter(|k| *k != along && seen.moment[*k] != 0.0).count() as f64;
    let products = [(0, 1), (0, 2), (1, 2)].iter().filter(|(i, j)| seen.tensor[*i][*j] != 0.0).count() as f64;
    let cost = MOMENT * moments + PRODUCT * products;
    if site.parent.is_none() { GROUND * cost } else { cost }
}
