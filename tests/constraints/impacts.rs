//! Impacts of constrained mechanisms: the constraints cause impulses, too.

use linkwork::prelude::*;

/// Pendulum in Cartesian coordinates of a plane, with the length of the rod as a constraint.
#[mechanism(gravity = -9.81 * y)]
struct Bob {
    #[particle(mass = 1)]
    bob: Particle,
    #[joint(ground -> bob, along = (x, y))]
    place: Stage,
    #[constraint(norm(r(bob / ground)) = 1)]
    rod: Holonomic,
}

/// A bob collides with a wall. The user's reset reverses the horizontal velocity and ignores the rod, which
/// would violate the rod's constraint by 0.39 m/s and more. The projection preserves the tangential
/// component.
#[test]
fn impacts_preserve_the_constraints() {
    let pendulum = Bob {};
    let (x, y) = (0.6_f64.sin(), -0.6_f64.cos());
    let run = || {
        let run = simulate(&pendulum).from([x, y], [0.0, 0.0]).duration(3.0);
        run.impact(Crossing::Falling, |_, q, _| q[0] + 0.3, |_, _, v| [-v[0], v[1]].into())
    };
    let assert_energy_at_impacts =
        |samples: &mut dyn Iterator<Item = Result<Sample<f64, 2, 2, 0>, Error>>| {
            let mut hits = 0;
            let mut energy = 9.81 * y;
            for sample in samples {
                let Sample { q, v, event, .. } = sample.expect("it swings");
                assert!((q.norm() - 1.0).abs() < 1e-12 && q.dot(&v).abs() < 1e-12, "{q} {v}");
                let now = v.norm_squared() / 2.0 + 9.81 * q[1];
                if event.is_some() {
                    // The component of (−vx, vy) along the tangent (c, s) at the angle is −vx c + vy s = v (s² −
                    // c²).
                    let (s, c) = (q[0], -q[1]);
                    let before = -(2.0 * (energy - 9.81 * q[1])).sqrt();
                    let expected = before * (s * s - c * c);
                    assert!((v[0] * c + v[1] * s - expected).abs() < 1e-5, "{v} for {expected}");
                    hits += 1;
                } else {
                    assert!((now - energy).abs() < 1e-4, "{now} for {energy}");
                }
                energy = now;
            }
            assert!(hits >= 2, "{hits}");
        };
    assert_energy_at_impacts(&mut run());
    assert_energy_at_impacts(&mut run().method(Rk4::step(1e-3)));
    assert_energy_at_impacts(&mut run().method(ImplicitMidpoint::step(1e-4)).sample_every(1e-2));
}

/// A bob that the wall stops completely would next move through the wall.
#[test]
fn plastic_impact_through_a_wall_is_an_error() {
    let pendulum = Bob {};
    let run = simulate(&pendulum).from([0.6, -0.8], [0.0, 0.0]).duration(3.0);
    let end = run.impact(Crossing::Falling, |_, q, _| q[0] - 0.1, |_, _, v| v * 0.0).finish();
    assert!(matches!(end, Err(Error::Impacts { event: 0, .. })), "{end:?}");
}
