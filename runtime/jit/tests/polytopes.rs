//! Checks that contacts of hulls and cylinders of loaded mechanisms equal those of generated Rust code.

use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork_jit::{Error, Loader, Method};

macro_rules! both {
    ($name:ident, $($tokens:tt)*) => {
        $($tokens)*

        /// Source text of the declaration above, from which the mechanism is loaded.
        const $name: &str = stringify!($($tokens)*);
    };
}

both! {
    STONES,
    #[mechanism(gravity = -9.81 * z)]
    struct Stones {
        #[body(mass = 1, inertia = sphere(1, 0.1))]
        stone: Body,
        #[joint(ground -> stone)]
        pose: Free,
        #[contact(
            stone.hull([
                [0.11, 0.02, -0.03], [-0.07, 0.09, 0.01], [-0.08, -0.06, -0.05], [0.03, -0.1, 0.02],
                [0.01, 0.03, 0.12], [0.02, 0.07, -0.09], [0.06, -0.03, 0.08]
            ]),
            ground.cuboid(0.4, 0.3, 0.2),
            friction = 0.5
        )]
        rock: Contact,
    }
}

both! {
    CANS,
    #[mechanism(gravity = -9.81 * z)]
    struct Cans {
        #[body(mass = 1, inertia = cylinder(1, 0.1, 0.2, z))]
        can: Body,
        #[joint(ground -> can)]
        pose: Free,
        #[contact(can.cylinder(0.1, 0.2, z), ground.cylinder(0.15, 0.3, x), friction = 0.5)]
        drum: Contact,
        #[contact(
            can.cylinder(0.1, 0.2, z),
            ground.hull([[0.5, 0, 0], [-0.5, 0.4, 0], [-0.5, -0.4, 0], [0, 0, -0.2]]),
            friction = 0.5
        )]
        slab: Contact,
    }
}

/// Compares gaps and a motion of a loaded mechanism with those of the mechanism in Rust. The value is the
/// change of the configuration and the velocity at the end.
macro_rules! agreeing_motion {
    ($text:expr, $mechanism:expr, $q:expr, $duration:expr) => {{
        let (m, robot, q) = ($mechanism, Loader::text($text).load()?, SVector::from($q));
        let mut gaps = vec![0.0; m.contact_gaps(&q).len()];
        robot.evaluate_into(&robot.function("contact_gaps")?, &[q.as_slice()], &mut gaps)?;
        let expected = m.contact_gaps(&q);
        assert!(gaps.iter().zip(expected.iter()).all(|(a, b)| (a - b).abs() < 1e-14), "{gaps:?} {expected}");
        let v = [0.1, 0.0, 0.0, 0.0, 0.5, 0.0];
        let own = simulate(&m).from(q, v).method(TimeStepping::step(1e-3)).duration($duration);
        let own = own.finish().expect("a motion");
        let run = robot.simulate().from(q.as_slice(), &v).duration($duration);
        let found = run.method(Method::TimeStepping(1e-3)).finish()?;
        assert!(found.q.iter().zip(own.q.iter()).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {own:?}");
        (own.q - q, own.v)
    }};
}

#[test]
fn contacts_of_cylinders_agree_with_generated_rust() -> Result<(), Error> {
    let q = [0.05, -0.02, 0.32, 0.1, -0.3, 0.2, 0.927_361_849_549_570_4];
    let (_, v) = agreeing_motion!(CANS, Cans {}, q, 0.15);
    // It has not fallen freely.
    assert!(v.fixed_rows::<3>(0).norm() < 9.81 * 0.15 - 0.1, "{v}");
    Ok(())
}

#[test]
fn contacts_of_hulls_agree_with_generated_rust() -> Result<(), Error> {
    let q = [0.05, -0.02, 0.3, 0.1, -0.3, 0.2, 0.927_361_849_549_570_4];
    let (motion, v) = agreeing_motion!(STONES, Stones {}, q, 0.3);
    // It has fallen on the box.
    assert!(motion.amax() > 0.02 && v.norm() < 1.5, "{motion} {v}");
    Ok(())
}
