//! Comparison of generated programs with an oracle that shares no code with the compiler: numeric Kane's
//! equations of random mechanisms, by Taylor series in time and imaginary steps.
//!
//! The mechanisms are trees with every joint and every base; springs, dashpots, inerters, attraction and dry
//! friction between bodies and the ground, on coordinates, and along ropes and cables; identical limbs;
//! masses over many powers of ten; and angles with rounding errors. Random URDF files with joints of every
//! type are compared with the same equations. Further tests use random mechanisms with as many prescribed
//! motions as velocities, and random mechanisms with all features of the language.

mod combinations;
mod combined;
mod driven;
mod emitted;
mod features;
mod files;
mod jet;
mod kane;
mod motion;
mod programs;
mod random;
mod robot;
mod sdf;
mod sites;
mod spec;
mod words;

use spec::{GeneratorSettings, random_mechanism_spec};

/// Returns the seeds of a test. The variable `LINKWORK_ORACLE` replaces their number by `20000`, or their
/// range by `400..405`.
fn test_seeds(usual: u64) -> std::ops::Range<u64> {
    let asked = std::env::var("LINKWORK_ORACLE").unwrap_or_default();
    let (from, to) = asked.split_once("..").unwrap_or(("0", &asked));
    from.parse().unwrap_or(0)..to.parse().unwrap_or(usual)
}

const PLAIN: GeneratorSettings = GeneratorSettings { bodies: 6, limbs: 0, decades: 0.3, noise: None };

#[test]
fn random_trees_satisfy_kanes_equations() {
    for seed in test_seeds(14) {
        programs::check_mechanism(&random_mechanism_spec(seed, PLAIN), seed);
    }
}

#[test]
fn random_limbs_satisfy_kanes_equations() {
    for seed in test_seeds(8) {
        let limbs = 2 + seed as usize % 4;
        programs::check_mechanism(
            &random_mechanism_spec(1_000_000 + seed, GeneratorSettings { limbs, ..PLAIN }),
            seed,
        );
    }
}

#[test]
fn mass_ratios_of_twelve_decades_satisfy_kanes_equations() {
    for seed in test_seeds(10) {
        programs::check_mechanism(
            &random_mechanism_spec(2_000_000 + seed, GeneratorSettings { decades: 6.0, ..PLAIN }),
            seed,
        );
    }
}

/// Identical limbs with small deviations of masses and angles.
#[test]
fn nearly_identical_limbs_satisfy_kanes_equations() {
    for seed in test_seeds(8) {
        let noise = (seed % 2 == 0).then(|| 10.0_f64.powi(-16 + (seed % 14) as i32));
        let limbs = 2 + seed as usize % 4;
        // Heavy limbs on a light trunk differ more in their moments of inertia about the trunk's joint than
        // in their masses. Masses that are smaller than the others by thirteen powers of ten are treated as
        // zero.
        let style = GeneratorSettings { limbs, decades: 5.5, noise, ..PLAIN };
        programs::check_mechanism(&random_mechanism_spec(4_000_000 + seed, style), seed);
    }
}

#[test]
fn driven_mechanisms_satisfy_kanes_equations() {
    let all = test_seeds(15);
    let checked = all.clone().filter(|seed| driven::check_driven_mechanism(*seed)).count();
    assert!(checked > 0 || all.count() < 15);
}

#[test]
fn noisy_right_angles_satisfy_kanes_equations() {
    for seed in test_seeds(14) {
        let noise = 10.0_f64.powi(-16 + (seed % 14) as i32);
        let style = GeneratorSettings { bodies: 8, noise: Some(noise), ..PLAIN };
        programs::check_mechanism(&random_mechanism_spec(3_000_000 + seed, style), seed);
    }
}
