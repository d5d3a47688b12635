//! Checks motions of loaded mechanisms with more than 64 coordinates, and the error beyond the largest size.

use linkwork_jit::{Error, Inputs, Loader, Method, Robot};
use std::fmt::Write;

/// Returns a chain of equal pendulums that hang in series.
fn load_pendulum_chain(count: usize, options: &str) -> Result<Robot, Error> {
    let mut text = String::from("#[mechanism(gravity = -9.81 * y)] struct Chain {");
    let mut before = "ground".to_string();
    for k in 0..count {
        let _ = write!(
            text,
            "#[body(mass = 0.1, com = -0.05 * y, inertia = rod(0.1, 0.1, y))] link{k}: Body,
            #[joint({before} -> link{k}, about = z)] hinge{k}: Pin,"
        );
        before = format!("link{k}.at(-0.1 * y)");
    }
    Loader::text(&(text + "}")).options(options).load()
}

/// The energy of a swinging chain of 80 links is constant, with explicit and implicit methods.
#[test]
fn energy_of_a_long_chain_is_constant() -> Result<(), Error> {
    const N: usize = 80;
    let chain = load_pendulum_chain(N, "")?;
    let (mut q, v) = ([0.0; N], [0.0; N]);
    q[0] = 0.3;
    let energy = |q: &[f64], v: &[f64]| -> Result<f64, Error> {
        Ok(chain.kinetic_energy(q, v)? + chain.potential_energy(q)?)
    };
    let before = energy(&q, &v)?;
    for method in [Method::Rk4(1e-4), Method::DormandPrince8(1e-8), Method::ImplicitMidpoint(1e-3)] {
        let end = chain.simulate().from(&q, &v).duration(0.003).method(method).finish()?;
        assert_eq!((end.q.len(), end.v.len()), (N, N));
        assert!(chain.kinetic_energy(&end.q, &end.v)? > 1e-6, "the chain moves");
        let change = energy(&end.q, &end.v)? - before;
        assert!(change.abs() < 1e-8 * before.abs(), "{method:?}: the energy changes by {change}");
    }
    Ok(())
}

/// A block that lies on the ground while 80 pendulums hang at rest below other supports.
#[test]
fn contacts_of_a_large_mechanism_carry_the_weight() -> Result<(), Error> {
    const N: usize = 80;
    let mut text = String::from(
        "#[mechanism(gravity = -9.81 * z)] struct Scene {
            #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))] block: Body,
            #[joint(ground -> block)] pose: Free,
            #[contact(block, ground.plane(z), friction = 0.5, restitution = 0)] foot: Contact,",
    );
    for k in 0..N {
        let _ = write!(
            text,
            "#[particle(mass = 1)] bob{k}: Particle,
            #[joint(ground -> bob{k}.at(0.5 * z), about = x)] hinge{k}: Pin,"
        );
    }
    let scene = Loader::text(&(text + "}")).load()?;
    let (mut q, v) = (vec![0.0; N + 7], vec![0.0; N + 6]);
    q.copy_from_slice(scene.neutral()?.as_slice());
    let end = scene.simulate().from(&q, &v).duration(0.02).method(Method::TimeStepping(5e-3)).finish()?;
    let moved = end.q.iter().zip(&q).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(moved < 1e-9, "a coordinate moved by {moved}");
    Ok(())
}

/// A mechanism with 257 inputs has functions but no simulation.
#[test]
fn mechanisms_beyond_the_largest_size_are_errors() -> Result<(), Error> {
    const N: usize = 257;
    let mut text = String::from(
        "#[mechanism] struct Block {
            #[body(mass = 1)] block: Body,
            #[joint(ground -> block, along = x)] slide: Sleeve,",
    );
    for k in 0..N {
        let _ = write!(text, "#[acts(on = slide)] force{k}: Force,");
    }
    let robot = Loader::text(&(text + "}")).load()?;
    let u = [0.01; N];
    assert!((robot.generalized_forces(&[0.0], &[0.0], &u)?[0] - 0.01 * N as f64).abs() < 1e-12);
    let run = robot.simulate().from(&[0.0], &[0.0]).inputs(Inputs::Constant(&u)).duration(0.1).finish();
    let error = run.expect_err("too many inputs").to_string();
    assert!(error.contains("257") && error.contains("at most 256"), "{error}");
    Ok(())
}
