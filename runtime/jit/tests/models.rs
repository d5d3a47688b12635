//! Checks that mechanisms of `linkwork-models` with constraints, when loaded at run time, equal those
//! compiled by the attribute.

use linkwork::integrate::Hooks;
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork_jit::{Loader, Robot};
use linkwork_models as models;

type Failure = Box<dyn std::error::Error>;

/// Loads the mechanism in a file and sets values of its parameters.
fn load_mechanism(file: &str, values: &[(&str, f64)]) -> Result<Robot, Failure> {
    let path = format!("{}/../../models/src/{file}.rs", env!("CARGO_MANIFEST_DIR"));
    Ok(Loader::file(path).load()?.with_parameters(values)?)
}

fn assert_close_entries(found: &[f64], expected: &[f64], what: &str) {
    let scale = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= 1e-8 * scale, "{what}: entry {k} is {a} instead of {b}");
    }
}

/// Constant dimension to which the mechanisms are padded.
const N: usize = 16;

/// Compares projections and accelerations in states near a given configuration.
fn compare_loaded_and_padded_robot<M, const NQ: usize, const NV: usize, const NU: usize>(
    own: &M,
    near: [f64; NQ],
    robot: &Robot,
) -> Result<(), Failure>
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let (name, m) = (robot.name(), robot.padded::<N, N, N>());
    for seed in 0..4 {
        let sample_value = |k: usize| (7.0 * k as f64 + 3.0 * f64::from(seed) + 1.0).sin();
        let step = SVector::from_fn(|k, _| 1e-3 * sample_value(k));
        let q = own.integrate(&near.into(), &step);
        let v = SVector::from_fn(|k, _| sample_value(k + 3));
        let (q, v) = own.project(0.0, &q, &v)?;
        let tau = SVector::from_fn(|k, _| sample_value(k + 5));
        let a = own.try_forward_dynamics(0.0, &q, &v, &tau)?;
        let found = robot.forward_dynamics(q.as_slice(), v.as_slice(), tau.as_slice())?;
        assert_close_entries(found.as_slice(), a.as_slice(), name);
        let Ok(m) = &m else { continue };
        let padded_vector = |x: &[f64]| SVector::<f64, N>::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
        let off = own.integrate(&q, &(step * 0.1));
        let expected = own.project(0.0, &off, &v)?;
        let found = m.project(0.0, &padded_vector(off.as_slice()), &padded_vector(v.as_slice()))?;
        assert_close_entries(found.0.as_slice(), expected.0.as_slice(), name);
        assert_close_entries(found.1.as_slice(), expected.1.as_slice(), name);
        let p = own.velocity_change_by_impulse(0.0, &q, &v, 1e-2, &tau);
        let found = m.velocity_change_by_impulse(
            0.0,
            &padded_vector(q.as_slice()),
            &padded_vector(v.as_slice()),
            1e-2,
            &padded_vector(tau.as_slice()),
        );
        assert_close_entries(found.as_slice(), p.as_slice(), name);
    }
    Ok(())
}

macro_rules! agree {
    ($($type:ident $file:literal [$($near:expr),*] { $($name:ident: $value:expr),* })*) => {
        $(compare_loaded_and_padded_robot(&models::$type { $($name: $value),* }, [$($near),*],
            &load_mechanism($file, &[$((stringify!($name), $value)),*])?)?;)*
    };
}

#[test]
fn loaded_constrained_models_agree_with_structs() -> Result<(), Failure> {
    agree! {
        FourBar "four_bar" [1.0, -0.2072, 2.0069]
            { g: 9.81, density: 1.0, a: 1.0, b: 2.0, c: 2.5, d: 3.0 }
        SliderCrank "slider_crank" [0.5, -0.693, 1.3325]
            { g: 9.81, r: 0.4, l: 1.0, m_crank: 1.0, m_rod: 0.7, m_piston: 2.0 }
        FiveBar "five_bar" [1.8, -0.7177, 1.3, 0.7436]
            { g: 9.81, crank_mass: 0.5, forearm_mass: 0.7, tool_mass: 0.2, base: 0.4, crank: 0.5, forearm: 0.7 }
        BricardLinkage "bricard_linkage" [0.0, 0.0, 0.0, 0.0, 0.0]
            { g: 9.81, mass: 1.0, length: 1.0 }
        GearPair "gear_pair" [0.2, -0.0666667]
            { small_inertia: 0.1, large_inertia: 0.5, small_radius: 0.1, large_radius: 0.3 }
        ChaplyginSleigh "chaplygin_sleigh" [0.1, 0.2, 0.3] { m: 2.0, j: 0.3, a: 0.4 }
        RollingDisk "rolling_disk" [0.0, 0.0, 0.4777, 0.2, 0.3, 0.1] { g: 9.81, m: 1.0, radius: 0.5 }
        Rattleback "rattleback" [0.0, 0.0, 0.02, 0.0, 0.0, 0.0, 1.0] {
            g: 9.81, mass: 1.0, a: 0.2, b: 0.03, c: 0.02, depth: 0.01,
            ixx: 2e-4, iyy: 1.6e-3, izz: 1.7e-3, ixy: -2e-5
        }
        BowlingBall "bowling_ball" [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0]
            { g: 9.81, mass: 7.0, radius: 0.1, friction: 0.2, regular_speed: 1e-3 }
    }
    Ok(())
}
