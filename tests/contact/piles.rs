//! Tests of bodies that lie, lean and collide on each other.

use linkwork::prelude::*;
use std::thread;

/// Stack of four boxes, each in contact with the face of the one below.
#[mechanism(gravity = -9.81 * z)]
struct Stack {
    #[body(mass = 1, inertia = cuboid(1, 0.2, 0.2, 0.1))]
    block: [Body; 4],
    #[joint(ground -> block[i])]
    pose: [Free; 4],
    #[contact(block[0].cuboid(0.2, 0.2, 0.1), ground.plane(z), friction = 0.6)]
    base: Contact,
    #[contact(block[i + 1].cuboid(0.2, 0.2, 0.1), block[i].cuboid(0.2, 0.2, 0.1), friction = 0.6)]
    seat: [Contact; 3],
}

/// Checks that a stack of four boxes stays at rest, although its 47 contact points, of which 16 are closed,
/// are redundant.
fn check_stack_at_rest() {
    let m = Stack {};
    let mut q = m.neutral();
    for k in 0..4 {
        q[7 * k] = 0.02 * ((k % 3) as f64 - 1.0);
        q[7 * k + 2] = 0.05 + 0.1 * k as f64;
    }
    let run = simulate(&m).from(q, [0.0; 24]).method(TimeStepping::step(1e-2)).duration(0.5);
    let moved = (run.finish().unwrap().q - q).norm();
    assert!(moved < 1e-12, "{moved:e} m");
}

#[test]
fn stacked_boxes_remain_standing() {
    thread::Builder::new().stack_size(32 << 20).spawn(check_stack_at_rest).unwrap().join().unwrap();
}

/// House of two cards that lean on each other: the edge of the left card touches the face of the right one.
#[mechanism(gravity = -9.81 * y)]
struct TwoLeaningCards {
    floor: f64,
    faces: f64,
    #[body(mass = 0.01, inertia = rod(0.01, 0.1, y))]
    left: Body,
    #[body(mass = 0.01, inertia = rod(0.01, 0.1, y))]
    right: Body,
    #[joint(ground -> left, about = z)]
    left_pose: Planar,
    #[joint(ground -> right, about = z)]
    right_pose: Planar,
    #[contact(left.at(-0.05 * y), ground.plane(y), friction = floor)]
    left_foot: Contact,
    #[contact(right.at(-0.05 * y), ground.plane(y), friction = floor)]
    right_foot: Contact,
    #[contact(left.at(0.05 * y), right.plane(-x), friction = faces)]
    edge: Contact,
}

/// A card that leans by `φ` has the horizontal force `(m g / 2) tan φ` at its edge, by symmetry. The floor
/// carries `m g` and needs a coefficient of at least `tan φ / 2`. The face, to whose normal the force is
/// inclined by `φ`, needs at least `tan φ`.
#[test]
fn leaning_cards_have_closed_form_forces() {
    let lean = 0.35_f64;
    let q = SVector::from([
        -0.05 * lean.sin(),
        0.05 * lean.cos(),
        -lean,
        0.05 * lean.sin(),
        0.05 * lean.cos(),
        lean,
    ]);
    let needed = [lean.tan() / 2.0, lean.tan()];
    let largest_displacement = |floor: f64, faces: f64| {
        let m = TwoLeaningCards { floor: needed[0] * floor, faces: needed[1] * faces };
        assert!(m.contact_gaps(&q).amax() < 1e-16);
        let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(1e-3)).duration(0.2);
        (run.finish().unwrap().q - q).amax()
    };
    assert!(largest_displacement(1.02, 1.02) < 1e-9, "{:e}", largest_displacement(1.02, 1.02));
    assert!(largest_displacement(0.98, 1.02) > 1e-3, "{:e}", largest_displacement(0.98, 1.02));
    assert!(largest_displacement(1.02, 0.98) > 1e-3, "{:e}", largest_displacement(1.02, 0.98));
}

/// House of seven cards: two pairs that lean on each other support a roof, on which a third pair stands.
#[mechanism(gravity = -9.81 * y)]
struct HouseOfSevenCards {
    friction: f64,
    #[body(mass = 0.01, inertia = rod(0.01, 0.1, y))]
    left: [Body; 3],
    #[body(mass = 0.01, inertia = rod(0.01, 0.1, y))]
    right: [Body; 3],
    #[body(mass = 0.02, inertia = rod(0.02, 0.2, x))]
    roof: Body,
    #[joint(ground -> left[i], about = z)]
    left_pose: [Planar; 3],
    #[joint(ground -> right[i], about = z)]
    right_pose: [Planar; 3],
    #[joint(ground -> roof, about = z)]
    roof_pose: Planar,
    #[contact(left[i].at(-0.05 * y), ground.plane(y), friction = friction)]
    left_foot: [Contact; 2],
    #[contact(right[i].at(-0.05 * y), ground.plane(y), friction = friction)]
    right_foot: [Contact; 2],
    #[contact(left[i].at(0.05 * y), right[i].plane(-x), friction = friction)]
    edge: [Contact; 3],
    #[contact(right[i].at(0.05 * y), roof.plane(-y), friction = friction)]
    ridge: [Contact; 2],
    #[contact(left[2].at(-0.05 * y), roof.plane(y), friction = friction)]
    left_sill: Contact,
    #[contact(right[2].at(-0.05 * y), roof.plane(y), friction = friction)]
    right_sill: Contact,
}

/// Eleven contacts have 22 forces for 21 velocities. With strong friction no card moves by a nanometre under
/// the ten millinewtons of the upper pair and the roof; with weak friction the house falls.
#[test]
fn house_of_cards_remains_standing() {
    let lean = 0.35_f64;
    let (sine, cosine) = lean.sin_cos();
    let mut q = SVector::<f64, 21>::zeros();
    for (k, (x, y)) in [(-0.05, 0.0), (0.05, 0.0), (0.0, 0.1 * cosine)].into_iter().enumerate() {
        q.fixed_rows_mut::<3>(3 * k).copy_from_slice(&[x - 0.05 * sine, y + 0.05 * cosine, -lean]);
        q.fixed_rows_mut::<3>(9 + 3 * k).copy_from_slice(&[x + 0.05 * sine, y + 0.05 * cosine, lean]);
    }
    q[19] = 0.1 * cosine;
    let largest_displacement = |friction: f64| {
        let m = HouseOfSevenCards { friction };
        assert!(m.contact_gaps(&q).amax() < 1e-15, "{}", m.contact_gaps(&q));
        let run = simulate(&m).from(q, [0.0; 21]).method(TimeStepping::step(1e-3)).duration(1.0);
        (run.finish().unwrap().q - q).amax()
    };
    assert!(largest_displacement(1.0) < 1e-9, "{:e}", largest_displacement(1.0));
    assert!(largest_displacement(0.1) > 1e-2, "{:e}", largest_displacement(0.1));
}

/// Newton's cradle: balls on threads of equal length.
#[mechanism(gravity = -9.81 * y)]
struct Cradle {
    /// Gap between neighbouring balls of the cradle at rest, m.
    gap: f64,
    #[particle(mass = 0.1)]
    ball: [Particle; 5],
    #[joint(ground.at((0.05 + gap) * i * x) -> ball[i].at(0.2 * y), about = z)]
    thread: [Pin; 5],
    #[contact(ball[i].sphere(0.025), ball[i + 1].sphere(0.025), restitution = 1)]
    touch: [Contact; 4],
}

/// Checks that successive impacts transfer the velocity from ball to ball in Newton's cradle. The last ball
/// rises to the initial height of the first one; the others stay at rest.
#[test]
fn newtons_cradle_transfers_the_velocity() {
    let m = Cradle { gap: 1e-6 };
    let start = [-0.3, 0.0, 0.0, 0.0, 0.0];
    let total_energy = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
    let before = total_energy(&start.into(), &SVector::zeros());
    let run = simulate(&m)
        .from(start, [0.0; 5])
        .method(EventDriven::new().tolerance(1e-11, 1e-11))
        .sample_every(0.01)
        .duration(0.8);
    let (mut highest, mut moved) = (0.0_f64, 0.0_f64);
    for sample in run {
        let sample = sample.unwrap();
        let now = total_energy(&sample.q, &sample.v);
        assert!((now - before).abs() < 1e-9, "{now} {before}");
        highest = highest.max(sample.q[4]);
        moved = moved.max(sample.q.fixed_rows::<3>(1).amax());
    }
    // The remaining motion of the other balls results from the gaps.
    assert!((highest - 0.3).abs() < 1e-3, "{highest}");
    assert!(moved < 1e-3, "{moved}");
}

/// Declares a box that tumbles down a slope over its edge, with its contacts in the given order.
macro_rules! tumbling {
    ($name:ident, $first:ident = $point:expr, $second:ident = $other:expr) => {
        #[mechanism(gravity = -9.81 * y)]
        struct $name {
            #[body(mass = 2, com = 0.02 * x, inertia = cuboid(2, 0.3, 0.2, 0.1))]
            tile: Body,
            #[joint(ground -> tile, about = z)]
            pose: Planar,
            #[contact(tile.at($point), ground.plane(y), friction = 0.4, restitution = 0.2)]
            $first: Contact,
            #[contact(tile.at($other), ground.plane(y), friction = 0.4, restitution = 0.2)]
            $second: Contact,
        }
    };
}
tumbling!(LeftFirst, left = -0.15 * x - 0.1 * y, right = 0.15 * x - 0.1 * y);
tumbling!(RightFirst, right = 0.15 * x - 0.1 * y, left = -0.15 * x - 0.1 * y);

#[test]
fn declaration_order_of_stacked_bodies_has_no_effect() {
    let (q, v) = ([0.0, 0.12, 0.05], [1.0, 0.0, 0.5]);
    let step = TimeStepping::step(1e-3);
    let one = simulate(&LeftFirst {}).from(q, v).method(step).duration(0.5).finish().unwrap();
    let other = simulate(&RightFirst {}).from(q, v).method(step).duration(0.5).finish().unwrap();
    assert!((one.q - other.q).amax() < 1e-10, "{}", (one.q - other.q).amax());
    // The box has come to rest on both corners.
    assert!(one.v.amax() < 1e-10 && (one.q[1] - 0.1).abs() < 1e-9, "{} {}", one.q, one.v);
}

/// Box on a slope with friction, in single precision.
#[mechanism(gravity = -9.81 * z, scalar = f32)]
struct BoxInSinglePrecision {
    tilt: f32,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(sin(tilt) * x + cos(tilt) * z), friction = 0.5)]
    slope: Contact,
}

#[test]
fn stacked_bodies_stick_in_single_precision() {
    let m = BoxInSinglePrecision { tilt: 0.35 };
    let (sine, cosine) = (m.tilt / 2.0).sin_cos();
    let q = [0.05 * m.tilt.sin(), 0.0, 0.05 * m.tilt.cos(), 0.0, sine, 0.0, cosine];
    let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(0.01_f32)).duration(60.0);
    let moved = (run.finish().unwrap().q - SVector::from(q)).norm();
    assert!(moved < 1e-5, "{moved:e}");
    // At a slope of 0.5 rad the box slides with g (sin 0.5 − 0.5 cos 0.5).
    let m = BoxInSinglePrecision { tilt: 0.5 };
    let (sine, cosine) = (m.tilt / 2.0).sin_cos();
    let q = [0.05 * m.tilt.sin(), 0.0, 0.05 * m.tilt.cos(), 0.0, sine, 0.0, cosine];
    let end =
        simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(0.01_f32)).duration(1.0).finish().unwrap();
    let speed = 9.81 * (m.tilt.sin() - 0.5 * m.tilt.cos());
    assert!(
        (end.v.fixed_rows::<3>(3).norm().max(end.v.fixed_rows::<3>(0).norm()) - speed).abs() < 1e-3,
        "{}",
        end.v
    );
}
