//! Contact conditions that hold in every impact, and mechanisms that several tests use.

use linkwork::contact::{self, Contacts};
use linkwork::prelude::*;

/// Generator of reproducible pseudorandom numbers between −1 and 1.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn random_vector<const N: usize>(&mut self, size: f64) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.next() * size)
    }

    pub fn random_choice<const N: usize>(&mut self, list: [f64; N]) -> f64 {
        list[((self.next() + 1.0) / 2.0 * N as f64) as usize % N]
    }
}

/// Checks that an impact satisfies the contact conditions. Returns whether restitution was reduced so that
/// the energy does not grow.
pub fn check_impact_conditions<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
) -> bool
where
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = f64>,
{
    let found = contact::impact(m, 0.0, q, v).unwrap();
    let (before, after) = (m.contact_rates(0.0, q, v), m.contact_rates(0.0, q, &found.v));
    let gaps = m.contact_gaps(0.0, q);
    let laws = m.contact_laws();
    let energy = m.kinetic_energy(0.0, q, v);
    let taken = energy - m.kinetic_energy(0.0, q, &found.v);
    assert!(taken > -1e-12 * energy, "energy grows by {} of {energy}", -taken);
    let most = found.impulses.amax();
    let speed = before.amax().max(after.amax());
    let push =
        m.mass_matrix(0.0, q) * (found.v - v) - m.contact_jacobian(0.0, q).transpose() * found.impulses;
    assert!(push.amax() <= 1e-11 * (most + 1e-3), "{push} of {most}");
    let mut lowered = false;
    for k in 0..NK {
        let contact::Rows { first, count } = M::CONTACT_ROWS[k];
        let (impulse, rate) = (found.impulses[first], after[first]);
        let slip = after.rows(first + 1, count - 1).norm();
        let friction = found.impulses.rows(first + 1, count - 1).norm();
        if gaps[k] > 1e-8 {
            assert!(impulse == 0.0 && friction == 0.0);
            continue;
        }
        let least = (-laws[k].restitution * before[first]).max(0.0);
        // Restitution is reduced if the full coefficient would increase the energy.
        assert!(impulse >= 0.0 && rate >= -5e-8 * speed, "{k}: {rate} {least} at {speed}");
        if impulse > 1e-9 * most {
            assert!(rate <= least + 5e-8 * speed, "{k}: {rate} {least} at {speed}");
        }
        lowered |= impulse > 1e-9 * most && rate < least * 0.999;
        let cone = laws[k].friction * impulse;
        assert!(friction <= cone * (1.0 + 1e-9) + 1e-11 * most, "{k}: {friction} {cone} {most}");
        if slip > 1e-7 * speed && count > 1 {
            let work = found.impulses.rows(first + 1, count - 1).dot(&after.rows(first + 1, count - 1));
            let full = -cone * slip;
            assert!((work - full).abs() <= 1e-7 * most * speed, "{k}: {work} {full}, {most} {speed}");
        }
    }
    lowered
}

/// Three balls on a floor, a heavy one on a light one and another.
#[mechanism(gravity = -9.81 * z)]
pub struct Pile {
    pub friction: f64,
    pub restitution: f64,
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    first: Body,
    #[body(mass = 0.02, inertia = sphere(0.02, 0.1))]
    second: Body,
    #[body(mass = 30, inertia = sphere(30, 0.1))]
    third: Body,
    #[joint(ground -> first)]
    first_pose: Free,
    #[joint(ground -> second)]
    second_pose: Free,
    #[joint(ground -> third)]
    third_pose: Free,
    #[contact(first.sphere(0.1), ground.plane(z), friction = friction, restitution = restitution)]
    a: Contact,
    #[contact(second.sphere(0.1), ground.plane(z), friction = friction, restitution = restitution)]
    b: Contact,
    #[contact(first.sphere(0.1), second.sphere(0.1), friction = friction, restitution = restitution)]
    c: Contact,
    #[contact(third.sphere(0.1), first.sphere(0.1), friction = friction, restitution = restitution)]
    d: Contact,
    #[contact(third.sphere(0.1), second.sphere(0.1), friction = friction, restitution = restitution)]
    e: Contact,
}

/// Double pendulum whose tip collides with the floor.
#[mechanism(gravity = -9.81 * y)]
pub struct DoublePendulumAboveFloor {
    pub friction: f64,
    pub restitution: f64,
    #[body(mass = 1, com = 0.25 * x, inertia = rod(1, 0.5, x))]
    first: Body,
    #[body(mass = 1, com = 0.25 * x, inertia = rod(1, 0.5, x))]
    second: Body,
    #[joint(ground.at(height * y) -> first, about = z)]
    upper: Pin,
    #[joint(first.at(0.5 * x) -> second, about = z)]
    lower: Pin,
    pub height: f64,
    #[contact(second.at(0.5 * x), ground.plane(y), friction = friction, restitution = restitution)]
    tip: Contact,
}
