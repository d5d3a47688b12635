//! Checks of legged robots that stand on contacts at their feet.

use super::laws::Random;
use linkwork::contact::{self, Contacts};
use linkwork::nalgebra::DMatrix;
use linkwork::prelude::*;

#[mechanism(
    urdf = "../../models/urdf/solo12.urdf",
    base = free,
    gravity = -9.81 * cos(slope) * z - 9.81 * sin(slope) * x
)]
struct Solo {
    slope: f64,
    #[contact(FL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    front_left: Contact,
    #[contact(FR_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    front_right: Contact,
    #[contact(HL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    hind_left: Contact,
    #[contact(HR_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    hind_right: Contact,
}

/// Returns joint torques of springs and dampers, as from servo drives.
fn servo_torques(q: &SVector<f64, 19>, v: &SVector<f64, 18>) -> SVector<f64, 12> {
    SVector::from_fn(|k, _| {
        let wanted = [0.0, 0.8, -1.6][k % 3];
        6.0 * (wanted - q[7 + k]) - 0.15 * v[6 + k]
    })
}

/// A quadruped falls on its feet and stands on a slope of 10°: it neither sinks nor creeps, while other
/// engines creep by millimetres a second.
#[test]
fn quadruped_stands_on_a_slope_without_creep() {
    let m = Solo { slope: 10.0_f64.to_radians() };
    let mut q = m.neutral();
    q[2] = 0.26;
    for leg in 0..4 {
        (q[8 + 3 * leg], q[9 + 3 * leg]) = (0.8, -1.6);
    }
    let run = simulate(&m)
        .from(q, [0.0; 18])
        .inputs(|_, q, v| servo_torques(q, v))
        .method(TimeStepping::step(1e-3))
        .sample_every(0.5)
        .duration(14.0);
    let samples: Vec<_> = run.map(|sample| sample.unwrap()).collect();
    let (before, after) = (samples[samples.len() - 2], samples[samples.len() - 1]);
    let creep = (after.q - before.q).norm() / 0.5;
    assert!(creep < 1e-6, "{creep:e}");
    let gaps = m.contact_gaps(&after.q);
    assert!(gaps.amax() < 1e-8, "{gaps}");
    // The contact forces of the feet balance the weight, along and across the slope.
    let u = servo_torques(&after.q, &after.v);
    let forces = contact::forces(&m, after.t, &after.q, &after.v, &u, 1e-3).unwrap();
    let normal: f64 = (0..4).map(|k| forces[3 * k]).sum();
    let weight = m.total_mass() * 9.81;
    assert!((normal - weight * m.slope.cos()).abs() < 1e-6 * weight, "{normal} {weight}");
    let along: [f64; 2] = [1, 2].map(|c| (0..4).map(|k| forces[3 * k + c]).sum());
    assert!((along[0].hypot(along[1]) - weight * m.slope.sin()).abs() < 1e-6 * weight, "{along:?}");
}

/// Humanoid on the corners of its soles: eight contacts, whose impulses the motion does not determine
/// uniquely.
#[mechanism(
    urdf = "../../models/urdf/simple_humanoid.urdf", base = free, limits = ignore, gravity = -9.81 * z
)]
struct Humanoid {
    #[contact(l_ankle.at(0.16 * x + (0.12 * i - 0.06) * y - 0.1 * z), ground.plane(z), friction = 0.8)]
    left_toe: [Contact; 2],
    #[contact(l_ankle.at(-0.09 * x + (0.12 * i - 0.06) * y - 0.1 * z), ground.plane(z), friction = 0.8)]
    left_heel: [Contact; 2],
    #[contact(r_ankle.at(0.16 * x + (0.12 * i - 0.06) * y - 0.1 * z), ground.plane(z), friction = 0.8)]
    right_toe: [Contact; 2],
    #[contact(r_ankle.at(-0.09 * x + (0.12 * i - 0.06) * y - 0.1 * z), ground.plane(z), friction = 0.8)]
    right_heel: [Contact; 2],
}

/// A humanoid drops onto its soles and stands, with springs and dampers at its joints. It does not creep, its
/// soles carry the whole weight, and the centre of pressure is below its centre of mass.
#[test]
fn humanoid_stands_without_creep() {
    let m = Humanoid {};
    let holding_torques = |q: &SVector<f64, 36>, v: &SVector<f64, 35>| {
        SVector::from_fn(|k, _| -1e4 * (q[7 + k] + 0.05 * v[6 + k]))
    };
    let mut q = m.neutral();
    q[2] -= m.contact_gaps(&q).min() - 0.01;
    let run = simulate(&m).from(q, [0.0; 35]).inputs(|_, q, v| holding_torques(q, v));
    let run = run.method(TimeStepping::step(1e-3)).sample_every(0.5).duration(6.0);
    let samples: Vec<_> = run.map(|sample| sample.unwrap()).collect();
    let (before, after) = (samples[samples.len() - 2], samples[samples.len() - 1]);
    let creep = (after.q - before.q).norm() / 0.5;
    assert!(creep < 1e-6, "{creep:e}");
    assert!(m.contact_gaps(&after.q).amax() < 1e-9);
    let forces =
        contact::forces(&m, after.t, &after.q, &after.v, &holding_torques(&after.q, &after.v), 1e-3).unwrap();
    let weight = m.total_mass() * 9.81;
    let normal: f64 = (0..8).map(|k| forces[3 * k]).sum();
    assert!((0..8).all(|k| forces[3 * k] >= 0.0) && (normal - weight).abs() < 1e-5 * weight, "{forces}");
    // Positions of the corners, in the order of declaration.
    let center = m.center_of_mass(&after.q);
    let feet = [
        m.frame_placement(frame!(Humanoid, "l_ankle"), &after.q),
        m.frame_placement(frame!(Humanoid, "r_ankle"), &after.q),
    ];
    for axis in 0..2 {
        let mut pressed = 0.0;
        for (k, x) in [0.16, 0.16, -0.09, -0.09].into_iter().cycle().take(8).enumerate() {
            let corner = [x, 0.12 * (k % 2) as f64 - 0.06, -0.1];
            let place = feet[k / 4] * linkwork::nalgebra::Point3::from(corner);
            pressed += forces[3 * k] * place[axis] / normal;
        }
        assert!((pressed - center[axis]).abs() < 1e-5, "{pressed} {center}");
    }
}

/// Trunk on four identical legs with two joints each, and with four identical arms.
#[mechanism]
struct Crab {
    #[body(mass = 3, inertia = cuboid(3, 0.3, 0.2, 0.1))]
    trunk: Body,
    #[joint(ground -> trunk)]
    pose: Free,
    #[body(mass = 0.4, com = -0.1 * z, inertia = rod(0.4, 0.2, z))]
    thigh: [Body; 4],
    #[joint(trunk.at(0.1 * (i - 1.5) * x + 0.05 * y) -> thigh[i], about = x)]
    hip: [Pin; 4],
    #[body(mass = 0.2, com = -0.1 * z, inertia = rod(0.2, 0.2, z))]
    shin: [Body; 4],
    #[joint(thigh[i].at(-0.2 * z) -> shin[i], about = y)]
    knee: [Pin; 4],
    #[body(mass = 0.1, com = 0.1 * z, inertia = rod(0.1, 0.2, z))]
    arm: [Body; 4],
    #[joint(trunk.at(0.1 * (i - 1.5) * x - 0.05 * y) -> arm[i], about = y)]
    shoulder: [Pin; 4],
    #[contact(shin[i].at(-0.2 * z), ground.plane(z), friction = 0.5)]
    foot: [Contact; 4],
    #[contact(arm[i].at(0.2 * z).sphere(0.01), ground.at(z).plane(-z), friction = 0.5)]
    hand: [Contact; 4],
}

/// Returns the errors of `M⁻¹ Gᵀ` and `G M⁻¹ Gᵀ` against a general factorisation, relative to their largest
/// entries.
fn unit_impulse_response_errors<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    m: &M,
    q: &SVector<f64, NQ>,
) -> [f64; 2]
where
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = f64>,
{
    let found = m.contact_responses(0.0, q, &[true; NK]);
    let jacobian = m.contact_jacobian(0.0, q);
    let mass = DMatrix::from_column_slice(NV, NV, m.mass_matrix(0.0, q).as_slice());
    let rows = DMatrix::from_column_slice(NR, NV, jacobian.as_slice());
    let velocities = mass.lu().solve(&rows.transpose()).unwrap();
    let rates = &rows * &velocities;
    let relative_error = |found: &[f64], expected: &DMatrix<f64>| {
        let difference = found.iter().zip(expected.iter()).map(|(a, b)| (a - b).abs());
        difference.fold(0.0, f64::max) / expected.amax()
    };
    [relative_error(found.velocities.as_slice(), &velocities), relative_error(found.rates.as_slice(), &rates)]
}

/// The contact-space inverse inertia with limbs as SIMD lanes equals that of the mass matrix. The cases have
/// legs with contacts, arms without contacts, and contacts on two groups of limbs.
#[test]
fn limb_contact_responses_agree_with_the_mass_matrix() {
    let mut random = Random(11);
    for _ in 0..20 {
        let m = Solo { slope: 0.1 };
        let q = m.integrate(&m.neutral(), &random.random_vector(1.0));
        let errors = unit_impulse_response_errors(&m, &q);
        assert!(errors[0].max(errors[1]) < 1e-12, "{errors:?}");
        let q = Crab {}.integrate(&Crab {}.neutral(), &random.random_vector(1.0));
        let errors = unit_impulse_response_errors(&Crab {}, &q);
        assert!(errors[0].max(errors[1]) < 1e-12, "{errors:?}");
    }
}
