//! Dropped boxes and balls: the order in which contacts and their surfaces are declared has no effect, and
//! contacts add no energy.

use super::boxes::{BoxesInSwappedOrder, TwoBoxes, configuration_of_boxes, random_rotation};
use super::laws::Random;
use linkwork::contact::Contacts;
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork::simulate::Overlaps;

/// Declares a box and a ball on the floor, at a wall and on each other, with their contacts in the given
/// order.
macro_rules! heap {
    ($name:ident: $($contact:ident = ($($surface:expr),*);)*) => {
        #[mechanism(gravity = -9.81 * z)]
        struct $name {
            friction: f64,
            restitution: f64,
            #[body(mass = 2, com = 0.02 * x, inertia = cuboid(2, 0.3, 0.2, 0.1))]
            block: Body,
            #[joint(ground -> block)]
            pose: Free,
            #[body(mass = 1, inertia = sphere(1, 0.1))]
            ball: Body,
            #[joint(ground -> ball)]
            place: Free,
            $(#[contact($($surface),*, friction = friction, restitution = restitution)]
            $contact: Contact,)*
        }
    };
}
heap!(Heap:
    floor = (block.cuboid(0.3, 0.2, 0.1), ground.plane(z));
    wall = (block.cuboid(0.3, 0.2, 0.1), ground.at(-0.15 * x).plane(x));
    on = (ball.sphere(0.1), block.cuboid(0.3, 0.2, 0.1));
    by = (ball.sphere(0.1), ground.plane(z));
);
heap!(Backwards:
    by = (ball.sphere(0.1), ground.plane(z));
    wall = (block.cuboid(0.3, 0.2, 0.1), ground.at(-0.15 * x).plane(x));
    on = (ball.sphere(0.1), block.cuboid(0.3, 0.2, 0.1));
    floor = (block.cuboid(0.3, 0.2, 0.1), ground.plane(z));
);

/// Returns the maximum difference between the motions of two mechanisms in one step of `h` seconds, m/s and
/// rad/s, over `steps` states along the motion of the first one.
fn one_step_difference_of_mechanisms<
    A,
    B,
    const N: usize,
    const NV: usize,
    const NK: usize,
    const NR: usize,
>(
    (one, other): (&A, &B),
    (mut q, mut v): (SVector<f64, N>, SVector<f64, NV>),
    (h, steps): (f64, usize),
) -> f64
where
    A: Contacts<N, NV, 0, NK, NR, Scalar = f64>,
    B: Contacts<N, NV, 0, NK, NR, Scalar = f64>,
{
    let method = TimeStepping::step(h);
    let mut most = 0.0_f64;
    for _ in 0..steps {
        // Surfaces may overlap slightly after a step; the next step starts from there.
        let goes_on = Overlaps::Keep;
        let to = simulate(one).from(q, v).overlaps(goes_on).method(method).duration(h).finish().unwrap();
        let same = simulate(other).from(q, v).overlaps(goes_on).method(method).duration(h).finish().unwrap();
        most = most.max((to.q - same.q).amax() / h + (to.v - same.v).amax());
        (q, v) = (to.q, to.v);
    }
    most
}

/// Checks that the distribution of impulses between surfaces is independent of the order of declaration, also
/// if the motion does not determine it. The correction for slip directions that rotate within a step uses the
/// impulses that were found; where several sliding contacts do not determine them, it differs by less than
/// the error of the step.
#[test]
fn declaration_order_of_contacts_has_no_effect() {
    let (mut random, run) = (Random(5), (2e-3, 60));
    let mut most = [0.0_f64; 2];
    for k in 0..8 {
        let (friction, restitution) = ([0.0, 0.3, 0.8][k % 3], [0.0, 0.5][k % 2]);
        let m = TwoBoxes { gravity: 9.81, friction, restitution };
        let turn = if k == 0 { UnitQuaternion::identity() } else { random_rotation(&mut random) };
        let at: [f64; 3] = random.random_vector::<3>(0.1).into();
        let q = configuration_of_boxes(&m, [at[0], at[1], 0.26], turn);
        let mut v = SVector::<f64, 12>::zeros();
        v.fixed_rows_mut::<3>(6).copy_from(&(turn.inverse() * Vector3::new(0.0, 0.0, -1.0)));
        let other = BoxesInSwappedOrder { gravity: 9.81, friction, restitution };
        most[0] = most[0].max(one_step_difference_of_mechanisms((&m, &other), (q, v), run));

        let m = Heap { friction, restitution };
        let mut q = m.neutral();
        (q[0], q[2], q[7], q[8], q[9]) = (0.05, 0.2, at[0], at[1], 0.45);
        (0..4).for_each(|i| q[3 + i] = turn.coords[i]);
        let mut v = SVector::<f64, 12>::zeros();
        (v[0], v[3], v[8]) = (-1.0, random.next(), -1.0);
        most[1] = most[1].max(one_step_difference_of_mechanisms(
            (&m, &Backwards { friction, restitution }),
            (q, v),
            run,
        ));
    }
    assert!(most[0] < 1e-4 && most[1] < 1e-8, "{most:?}");
}

/// Checks that a box which lands flat on another one stays level, whichever box is named first. Contradictory
/// gaps of corners and of an edge do not tilt it.
#[test]
fn flat_landing_boxes_stay_level() {
    let mut random = Random(5);
    for k in 0..30 {
        let friction = [0.0, 0.3][k % 2];
        let m = TwoBoxes { gravity: 9.81, friction, restitution: 0.0 };
        let other = BoxesInSwappedOrder { gravity: 9.81, friction, restitution: 0.0 };
        let at: [f64; 2] = random.random_vector::<2>(0.1).into();
        let q = configuration_of_boxes(&m, [at[0], at[1], 0.1261], UnitQuaternion::identity());
        let mut v = SVector::<f64, 12>::zeros();
        v[8] = -1.9;
        let most = one_step_difference_of_mechanisms((&m, &other), (q, v), (2e-3, 2));
        assert!(most < 1e-8, "{most} at {at:?}");
        let step = TimeStepping::step(2e-3);
        let end = simulate(&m).from(q, v).method(step).duration(2e-3).finish().unwrap();
        assert!(end.q.rows(10, 3).amax() < 1e-9 && (end.q[9] - 0.125).abs() < 1e-9, "{}", end.q);
    }
}

/// Checks that the order of contacts with strong friction has no effect. (The order of the two surfaces of a
/// contact may have one if slipping contacts share impulses: `TwoBoxes` and `BoxesInSwappedOrder` differ by
/// more than `1e-8` in about 1 of 3000 steps.)
#[test]
fn contact_order_has_no_effect_with_strong_friction() {
    let mut random = Random(2);
    let mut most = 0.0_f64;
    for k in 0..100 {
        let (friction, restitution) = ([2.0, 0.3, 2.0, 0.8][k % 4], [0.0, 0.5][k / 4 % 2]);
        let turn = random_rotation(&mut random);
        let at: [f64; 3] = random.random_vector::<3>(0.1).into();
        let m = Heap { friction, restitution };
        let mut q = m.neutral();
        (q[0], q[2], q[7], q[8], q[9]) = (0.05, 0.2, at[0], at[1], 0.45);
        (0..4).for_each(|i| q[3 + i] = turn.coords[i]);
        let mut v = SVector::<f64, 12>::zeros();
        (v[0], v[3], v[8]) = (-1.0, random.next(), -1.0);
        most = most.max(one_step_difference_of_mechanisms(
            (&m, &Backwards { friction, restitution }),
            (q, v),
            (2e-3, 60),
        ));
    }
    assert!(most < 1e-8, "{most}");
}

/// Simulates a drop with steps of `h` seconds. Returns the maximum growth of the energy in a step, J, and the
/// deepest overlap, m.
fn drop_energy_growth_and_overlap(restitution: f64, seed: u64, h: f64) -> (f64, f64) {
    let mut random = Random(seed);
    let m = TwoBoxes { gravity: 9.81, friction: 0.5, restitution };
    let turn = random_rotation(&mut random);
    let at: [f64; 3] = random.random_vector::<3>(0.1).into();
    let q = configuration_of_boxes(&m, [at[0], at[1], 0.3], turn);
    let total_energy = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
    let mut before = total_energy(&q, &SVector::zeros());
    let (mut gain, mut least) = (0.0_f64, 0.0_f64);
    for sample in simulate(&m).from(q, [0.0; 12]).method(TimeStepping::step(h)).sample_every(h).duration(0.3)
    {
        let sample = sample.unwrap();
        let now = total_energy(&sample.q, &sample.v);
        gain = gain.max(now - before);
        before = now;
        least = least.min(m.contact_gaps(&sample.q).min());
    }
    (gain, least)
}

/// Checks that impulses and the removal of overlaps add no energy to dropped bodies. The remaining gain is
/// the error of a second-order step for rotation about edges, `½ m g r ω² h²` with about 3 kg, 0.15 m and 3
/// rad/s. Corners that collide at 4 m/s overlap by at most their approach in one step.
#[test]
fn dropped_bodies_gain_no_energy() {
    let h = 2e-3;
    for (k, restitution) in [0.0, 0.5, 1.0, 0.0, 1.0].into_iter().enumerate() {
        let (gain, least) = drop_energy_growth_and_overlap(restitution, 20 + k as u64, h);
        assert!(gain < 25.0 * h * h, "{k}: {gain}");
        assert!(least > -4.0 * h, "{k}: {least}");
    }
}
