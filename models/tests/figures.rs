//! Checks that functions of mechanisms return values or errors for any input, also in builds with debug
//! assertions and overflow checks: NaN, infinite, very large and very small numbers.

use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork_models::{FourBar, RollingDisk, Solo12};

/// Pathological numbers that are passed to functions: NaN, infinities, very large and very small numbers.
const HOSTILE: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    5e-324,
    -0.0,
    1e300,
    -1e-300,
    9_007_199_254_740_993.0,
    6_381_956_970_095_103.0 * 1e240,
];

/// Mechanism with functions of many kinds, and a screw that closes a loop.
#[mechanism(gravity = -g * y, batch, derivatives)]
#[derive(Clone, Copy)]
struct TestMachine {
    g: f64,
    k: f64,
    l: f64,
    #[body(mass = 2, com = 0.3 * x, inertia = cuboid(2, 1, 2, 3))]
    hull: Body,
    #[body(mass = 1, com = 0.1 * y, inertia = cylinder(1, 0.3, 1, x))]
    ball: Body,
    #[body(mass = 0.3, com = 0.05 * x, inertia = sphere(1, 0.2))]
    weight: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[joint(hull.at(x) -> ball)]
    socket: Ball,
    #[joint(ball.at(-y) -> weight, about = (x, y))]
    cross: Universal,
    #[acts(
        between = (ground, weight.at(0.1 * x)),
        energy = k * (exp(stretch / l) + sqrt(stretch * stretch / (l * l) + 1))
    )]
    rope: Spring,
    #[acts(on = cross.first, coulomb = 0.3)]
    rubbing: Friction,
    #[acts(on = cross.second, energy = k * (ln(2 + cos(stretch)) + atan(stretch)))]
    cam: Spring,
    #[acts(on = hull, along = x)]
    push: Force,
}

/// Returns vectors in which every entry, or only the middle one, is a pathological number.
fn pathological_vectors<const N: usize>() -> impl Iterator<Item = SVector<f64, N>> {
    HOSTILE.into_iter().flat_map(|x| {
        [SVector::repeat(x), SVector::from_fn(|i, _| if i == N / 2 { x } else { 0.3 * i as f64 })]
    })
}

#[test]
fn functions_accept_pathological_numbers() {
    let list = [TestMachine { g: 9.81, k: 1.0, l: 0.5 }, TestMachine { g: f64::NAN, k: f64::MAX, l: 0.0 }];
    for (machine, (q, v)) in list
        .iter()
        .flat_map(|m| pathological_vectors().zip(pathological_vectors()).map(move |state| (m, state)))
    {
        let tau = machine.inverse_dynamics(&q, &v, &v);
        let a = machine.forward_dynamics(&q, &v, &tau);
        let _ = (machine.mass_matrix(&q), machine.kinetic_energy(&q, &v), machine.potential_energy(&q));
        let _ = (machine.integrate(&q, &v), machine.difference(&q, &q), machine.tangent_rate(&v, &a));
        let _ = machine.forward_dynamics_derivatives(&q, &v, &a);
        let _ = machine.linearize(&q, &v, &SVector::repeat(f64::MAX));
        let _ = machine.frame_placements(&q);
        let splat_lanes = |x: f64| Lanes::<f64, 4>::splat(x);
        let _ = machine.forward_dynamics_lanes(&q.map(splat_lanes), &v.map(splat_lanes), &a.map(splat_lanes));
        let _ = machine.forward_dynamics_derivatives_lanes(
            &q.map(splat_lanes),
            &v.map(splat_lanes),
            &a.map(splat_lanes),
        );
    }
    for (q, v) in pathological_vectors().zip(pathological_vectors()) {
        let a = Solo12.forward_dynamics(&q, &v, &v);
        let _ = (Solo12.inverse_dynamics(&q, &v, &a), Solo12.forward_dynamics_derivatives(&q, &v, &a));
    }
}

#[test]
fn constraint_functions_accept_pathological_numbers() {
    let disk = RollingDisk { g: 9.81, m: 1.0, radius: 0.1 };
    for (q, v) in pathological_vectors().zip(pathological_vectors()) {
        let a = disk.forward_dynamics(&q, &v, &v);
        let _ = (disk.constrained_dynamics(&q, &v, &a), disk.project_configuration(&q));
        let _ = (disk.project_velocity(&q, &v), disk.assemble(&q, &[0, 7, usize::MAX]));
        let _ = disk.complete_velocity(&q, &v, &[1, usize::MAX]);
    }
    for m in HOSTILE {
        let linkage = FourBar { g: m, density: 1.0, a: 1.0, b: 2.0, c: 1.5, d: 2.2 };
        for (q, v) in pathological_vectors().zip(pathological_vectors()) {
            let a = linkage.forward_dynamics(&q, &v, &v);
            let _ = (linkage.constrained_dynamics(&q, &v, &a), linkage.assemble(&q, &[0]));
        }
    }
}

#[test]
fn simulations_accept_pathological_times() {
    let machine = TestMachine { g: 9.81, k: 1.0, l: 0.5 };
    let (q, v) = (machine.neutral(), SVector::repeat(0.1));
    for (x, y) in HOSTILE.into_iter().flat_map(|x| HOSTILE.map(|y| (x, y))) {
        // Only a few steps each, since some of these runs never end.
        let simulate_machine = || simulate(&machine).from(q, v);
        let _ = simulate_machine().start_at(x).duration(y).take(3).count();
        let _ = simulate_machine().duration(1e-3).sample_every(x).take(3).count();
        let _ = simulate_machine().method(Rk4::step(x)).duration(y).take(3).count();
        let _ = simulate_machine().method(ImplicitMidpoint::step(x)).duration(y).take(3).count();
        let _ =
            simulate_machine().method(DormandPrince::new().tolerance(x, y)).duration(1e-6).take(3).count();
    }
}
