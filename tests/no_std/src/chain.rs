//! Chain of links whose derivatives are computed in loops over blocks of links.

use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * z, derivatives)]
struct Chain {
    #[body(mass = 1, com = 0.1 * x, inertia = cuboid(1, 0.2, 0.1, 0.1))]
    link: [Body; 16],
    #[joint(ground -> link[0], about = z)]
    root: Pin,
    #[joint(link[i].at(0.2 * x).rotated(x(0.5)) -> link[i + 1], about = [0.6, 0, 0.8])]
    joint: [Pin; 15],
}

type Joints = SVector<f64, { Chain::NV }>;

/// Whether the derivatives of inverse and forward dynamics agree with central differences along a direction.
pub fn derivatives_agree_with_differences(angle: f64) -> bool {
    let alternating = |factor: f64| {
        Joints::from_fn(|k, _| if k & 1 == 0 { angle * factor } else { -angle / (factor + k as f64) })
    };
    let (q, v, a, along) = (alternating(1.0), alternating(-1.3), alternating(0.7), alternating(0.4));
    let (by_q, by_v) = Chain {}.inverse_dynamics_derivatives(&q, &v, &a);
    let h = 1e-5;
    let force_at = |part: f64| Chain {}.inverse_dynamics(&(q + along * part), &(v + along * part), &a);
    let difference = (force_at(h) - force_at(-h)) / (2.0 * h);
    let error = (by_q * along + by_v * along - difference).norm();
    let forces = Chain {}.inverse_dynamics(&q, &v, &a);
    let (rate_by_q, rate_by_v, inverse) = Chain {}.forward_dynamics_derivatives(&q, &v, &forces);
    let residual = (rate_by_q + inverse * by_q).norm() + (rate_by_v + inverse * by_v).norm();
    error < 1e-6 * (1.0 + difference.norm()) && residual < 1e-8 * (1.0 + rate_by_q.norm())
}
