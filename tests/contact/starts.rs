//! Surfaces that overlap at the start of a motion, and invalid contact coefficients.

use linkwork::contact;
use linkwork::prelude::*;
use linkwork::simulate::Overlaps;

/// Two balls of different masses in a channel of width `gap`.
#[mechanism(batch)]
struct BallsInChannel {
    gap: f64,
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    light: Body,
    #[joint(ground -> light)]
    light_pose: Free,
    #[body(mass = 3, inertia = sphere(3, 0.1))]
    heavy: Body,
    #[joint(ground -> heavy)]
    heavy_pose: Free,
    #[contact(light.sphere(0.1), heavy.sphere(0.1), friction = 0.5)]
    touch: Contact,
    #[contact(light.sphere(0.1), ground.at(-gap / 2 * z).plane(z), friction = 0.5)]
    low: Contact,
    #[contact(light.sphere(0.1), ground.at(gap / 2 * z).plane(-z), friction = 0.5)]
    high: Contact,
}

/// Balls that overlap by `d` separate by `d m₂ / (m₁ + m₂)` and `d m₁ / (m₁ + m₂)` along the line of their
/// centres: their common centre of mass does not move.
#[test]
fn overlapping_balls_separate_in_proportion_to_mass() {
    let m = BallsInChannel { gap: 1.0 };
    let mut q = m.neutral();
    (q[7], q[8]) = (0.12, 0.09);
    let refused = contact::check(&m, 0.0, &q).unwrap_err();
    let depth = 0.2 - 0.15;
    assert!(
        matches!(refused, ConstraintError::Overlap { constraint: "touch", depth: d } if (d - depth).abs() < 1e-15)
    );
    let apart = contact::project(&m, 0.0, &q).unwrap();
    let line = [0.8, 0.6];
    for (c, part) in line.iter().enumerate() {
        assert!((apart[c] + 0.75 * depth * part).abs() < 1e-10, "{apart}");
        assert!((apart[7 + c] - q[7 + c] - 0.25 * depth * part).abs() < 1e-10, "{apart}");
    }
    contact::check(&m, 0.0, &apart).unwrap();
    assert_eq!(contact::project(&m, 0.0, &apart).unwrap(), apart);
}

/// If the distance of the walls is less than the ball's diameter, no configuration is free of overlaps, and
/// the error names a wall.
#[test]
fn overlaps_without_free_space_are_rejected() {
    let m = BallsInChannel { gap: 0.18 };
    let mut q = m.neutral();
    (q[2], q[7]) = (0.003, 1.0);
    let refused = contact::project(&m, 0.0, &q).unwrap_err();
    assert!(matches!(refused, ConstraintError::Overlap { constraint: "low" | "high", .. }), "{refused}");
    let text = contact::check(&m, 0.0, &q).unwrap_err().to_string();
    assert!(text.starts_with("the surfaces of the contact `high` overlap by 0.013"), "{text}");
}

/// Checks that simulations with both contact methods, and in lanes, reject overlapping balls and report the
/// contact. With the option to project they start from the result of [`contact::project`]; with the option to
/// keep overlaps they start unchanged.
#[test]
fn simulations_reject_overlapping_starts() {
    let m = BallsInChannel { gap: 1.0 };
    let mut q = m.neutral();
    (q[7], q[8]) = (0.12, 0.09);
    let v = SVector::from([0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0]);
    let overlap = contact::check(&m, 0.0, &q).unwrap_err();
    let apart = contact::project(&m, 0.0, &q).unwrap();
    let stepping = simulate(&m).from(q, v).start_at(2.0).method(TimeStepping::step(1e-3)).duration(0.0);
    let located = simulate(&m).from(q, v).start_at(2.0).method(EventDriven::new()).duration(0.0);
    let expected = Error::Constraint { t: 2.0, reason: overlap };
    assert_eq!(stepping.clone().finish().unwrap_err(), expected);
    assert_eq!(located.clone().finish().unwrap_err(), expected);
    assert_eq!(stepping.clone().overlaps(Overlaps::Part).finish().unwrap().q, apart);
    let parted = located.overlaps(Overlaps::Part).duration(0.1).finish().unwrap();
    assert!((parted.q[2] - 0.01).abs() < 1e-9 && (parted.q[0] - apart[0]).abs() < 1e-9, "{}", parted.q);
    assert_eq!(stepping.overlaps(Overlaps::Keep).finish().unwrap().q, q);
    // One of four lanes has an overlap.
    let lanes = SVector::from_fn(|i, _| Lanes([apart[i], apart[i], q[i], apart[i]]));
    let four = m.lanes::<4>();
    let start_with_contacts =
        |parts| linkwork::integrate::Hooks::contact_start(&four, Lanes([0.0; 4]), &lanes, parts);
    assert_eq!(start_with_contacts(false).unwrap_err(), overlap);
    assert_eq!(start_with_contacts(true).unwrap(), SVector::<_, 14>::from_fn(|i, _| Lanes([apart[i]; 4])));
}

/// Slider-crank whose slide is limited by a stop.
#[mechanism]
struct SliderCrankWithStop {
    #[body(mass = 1, com = 0.05 * x, inertia = rod(1, 0.1, x))]
    crank: Body,
    #[joint(ground -> crank, about = z)]
    shaft: Pin,
    #[body(mass = 1, com = 0.15 * x, inertia = rod(1, 0.3, x))]
    rod: Body,
    #[joint(crank.at(0.1 * x) -> rod, about = z)]
    wrist: Pin,
    #[body(mass = 2, inertia = cuboid(2, 0.1, 0.1, 0.1))]
    slide: Body,
    #[joint(ground -> slide, along = x)]
    way: Sleeve,
    #[joint(rod.at(0.3 * x) -> slide, about = z)]
    bolt: Pin,
    #[contact(slide.at(0.05 * x), ground.at(0.42 * x).plane(-x))]
    stop: Contact,
}

/// The projection moves the slide to the stop, and the loop stays closed: `cos θ` of the crank's angle
/// follows from the law of cosines.
#[test]
fn overlap_removal_keeps_loops_closed() {
    let m = SliderCrankWithStop {};
    let crank_configuration = |angle: f64| {
        let rod = -(angle.sin() / 3.0).asin();
        SVector::from([angle, rod - angle, 0.1 * angle.cos() + 0.3 * rod.cos()])
    };
    let q = contact::project(&m, 0.0, &crank_configuration(0.3)).unwrap();
    assert!(contact::check(&m, 0.0, &crank_configuration(0.3)).is_err());
    assert!(m.constraint_residuals(&q).amax() < 1e-12, "{}", m.constraint_residuals(&q));
    assert!((q[2] - 0.37).abs() < 1e-10, "{q}");
    let cosine: f64 = (0.37 * 0.37 + 0.01 - 0.09) / (2.0 * 0.37 * 0.1);
    assert!((q[0] - cosine.acos()).abs() < 1e-8, "{q}");
}

/// Rotated box that penetrates a corner of three planes. It comes to rest on them without overlaps, and a
/// motion from there begins without a jump.
#[mechanism(gravity = -9.81 * z)]
struct BoxInCorner {
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = 0.5)]
    floor: Contact,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(x), friction = 0.5)]
    wall: Contact,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(y), friction = 0.5)]
    side: Contact,
}

#[test]
fn overlapping_box_is_moved_out_of_a_corner() {
    let m = BoxInCorner {};
    let mut q = m.neutral();
    (q[0], q[1], q[2]) = (0.13, 0.08, 0.03);
    let turn = SVector::from([0.0, 0.0, 0.0, 0.1, -0.2, 0.3]);
    let q = m.integrate(&q, &turn);
    assert!(m.contact_gaps(&q).min() < -0.03);
    let apart = contact::project(&m, 0.0, &q).unwrap();
    let gaps = m.contact_gaps(&apart);
    assert!(gaps.min() > -1.1e-10, "{}", gaps.min());
    // The box touches each plane.
    for plane in 0..3 {
        assert!(gaps.fixed_rows::<8>(8 * plane).min() < 1e-3, "{gaps}");
    }
    let end = simulate(&m).from(apart, [0.0; 6]).method(TimeStepping::step(1e-3)).duration(2e-3);
    assert!(end.finish().unwrap().v.amax() < 0.2);
}

/// Ball on a floor whose coefficients are parameters.
#[mechanism(gravity = -9.81 * z)]
struct Ball {
    friction: f64,
    restitution: f64,
    #[body(mass = 0.5, inertia = sphere(0.5, 0.1))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.1), ground.plane(z), friction = friction, restitution = restitution)]
    floor: Contact,
}

/// Negative or infinite friction, and restitution outside its range, are reported by all functions of
/// contacts.
#[test]
fn invalid_contact_coefficients_are_reported() {
    let wrong = [(-0.1, 0.0, -0.1), (f64::INFINITY, 0.0, f64::INFINITY), (0.5, -0.2, -0.2), (0.5, 1.1, 1.1)];
    for (friction, restitution, value) in wrong {
        let m = Ball { friction, restitution };
        let mut q = m.neutral();
        q[2] = 0.1;
        let (v, tau) = ([1.0, 0.0, -1.0, 0.0, 0.0, 0.0].into(), SVector::zeros());
        let expected = ConstraintError::Coefficient { constraint: "floor", value };
        assert_eq!(contact::impact(&m, 0.0, &q, &v).unwrap_err(), expected);
        assert_eq!(contact::acting(&m, 0.0, &q, &v, &[].into()).unwrap_err(), expected);
        let touches = [contact::Touch::Sticks];
        assert_eq!(contact::forward_dynamics(&m, 0.0, &q, &v, &tau, &touches).unwrap_err(), expected);
        assert_eq!(contact::land(&m, 0.0, &q, &v, &touches).unwrap_err(), expected);
        let run = simulate(&m).from(q, v).method(TimeStepping::step(1e-3)).duration(0.1).finish();
        assert!(matches!(run.unwrap_err(), Error::Constraint { reason, .. } if reason == expected));
        for v in [v, SVector::zeros()] {
            let run = simulate(&m).from(q, v).method(EventDriven::new()).duration(0.1).finish();
            assert!(matches!(run.unwrap_err(), Error::Constraint { reason, .. } if reason == expected));
        }
    }
    let m = Ball { friction: f64::NAN, restitution: 0.0 };
    let mut q = m.neutral();
    q[2] = 0.1;
    let found = contact::impact(&m, 0.0, &q, &[0.0, 0.0, -1.0, 0.0, 0.0, 0.0].into()).unwrap_err();
    assert!(matches!(found, ConstraintError::Coefficient { constraint: "floor", value } if value.is_nan()));
}
