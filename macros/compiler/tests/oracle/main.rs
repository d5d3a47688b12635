//! An oracle that shares nothing with the compiler: Kane's equations of random mechanisms in numbers, by
//! Taylor series in time and imaginary steps, against what the generated programs compute. Trees of every
//! joint, with every base, with springs, dashpots, inerters, attraction and dry friction between bodies and
//! the ground, on coordinates, along ropes and cables; alike limbs; masses over many powers of ten; angles
//! that miss those of a plain machine by rounding. Random URDF files with joints of every type, by the same
//! motions. Random mechanisms without a degree of freedom, with as many drives as velocities. Random
//! mechanisms of everything that the language has, which compile.

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

use spec::{Style, spec};

/// Each test looks at so many mechanisms, or at as many as the variable `LINKWORK_ORACLE` says: `20000`, or
/// `400..405`.
fn seeds(usual: u64) -> std::ops::Range<u64> {
    let asked = std::env::var("LINKWORK_ORACLE").unwrap_or_default();
    let (from, to) = asked.split_once("..").unwrap_or(("0", &asked));
    from.parse().unwrap_or(0)..to.parse().unwrap_or(usual)
}

const PLAIN: Style = Style { bodies: 6, limbs: 0, decades: 0.3, noise: None };

#[test]
fn random_trees_obey_kanes_equations() {
    for seed in seeds(40) {
        programs::check(&spec(seed, PLAIN), seed);
    }
}

#[test]
fn random_limbs_obey_kanes_equations() {
    for seed in seeds(20) {
        let limbs = 2 + seed as usize % 4;
        programs::check(&spec(1_000_000 + seed, Style { limbs, ..PLAIN }), seed);
    }
}

#[test]
fn masses_over_twelve_powers_of_ten_obey_kanes_equations() {
    for seed in seeds(30) {
        programs::check(&spec(2_000_000 + seed, Style { decades: 6.0, ..PLAIN }), seed);
    }
}

/// Alike limbs whose masses and angles are not quite alike.
#[test]
fn limbs_of_all_masses_and_angles_with_noise_obey_kanes_equations() {
    for seed in seeds(20) {
        let noise = (seed % 2 == 0).then(|| 10.0_f64.powi(-16 + (seed % 14) as i32));
        let limbs = 2 + seed as usize % 4;
        // Heavy limbs on a light trunk lie farther apart by their moments of inertia about its joint than by
        // their masses; what is lighter than the rest by thirteen powers of ten counts as nothing.
        let style = Style { limbs, decades: 5.5, noise, ..PLAIN };
        programs::check(&spec(4_000_000 + seed, style), seed);
    }
}

#[test]
fn driven_mechanisms_obey_kanes_equations() {
    let all = seeds(40);
    let checked = all.clone().filter(|seed| driven::check(*seed)).count();
    assert!(checked > 0 || all.count() < 40);
}

#[test]
fn angles_with_noise_obey_kanes_equations() {
    for seed in seeds(30) {
        let noise = 10.0_f64.powi(-16 + (seed % 14) as i32);
        let style = Style { bodies: 8, noise: Some(noise), ..PLAIN };
        programs::check(&spec(3_000_000 + seed, style), seed);
    }
}
