//! Compares all forms of the equations of random mechanisms, with and without prescribed motion and
//! constraints, as polynomials and as texts.

use super::kane::check_printed_equations;
use super::routh::compare_routh_with_lagrange;
use super::*;
use crate::mechanics::routh;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Returns a chain of pins and sleeves with a spring, a dashpot and an input. Optionally its base is a table
/// that rotates at a prescribed speed, its first two joints are constrained, or it can rotate freely about
/// the vertical.
fn random_chain(r: &mut Random, driven: bool, constrained: bool, free: bool) -> String {
    let mut random_index_below = |n: u64| r.random_number_below(n) as usize;
    let length = 2 + random_index_below(2);
    let mut item = "struct Chain { g: f64, l: f64, k: f64, c: f64,".to_string();
    let base = if driven { "table" } else { "ground" };
    if driven {
        item += "w: f64, #[frame(ground, z(w * t))] turned: Frame, #[body(frame = turned)] table: Body,";
    }
    let pins: Vec<bool> = (0..length).map(|k| (free && k == 0) || random_index_below(3) > 0).collect();
    for (k, pin) in pins.iter().enumerate() {
        let (axis, offset, center) =
            (AXES[random_index_below(3)], AXES[random_index_below(3)], AXES[random_index_below(3)]);
        let axis = if free && k == 0 { "z" } else { axis };
        let parent = match k {
            0 => base.to_string(),
            k => format!("b{}.at(l * {offset})", k - 1),
        };
        let kind = if *pin {
            format!("about = {axis})] j{k}: Pin")
        } else {
            format!("along = {axis})] j{k}: Sleeve")
        };
        item += &format!(
            "m{k}: f64, #[body(mass = m{k}, com = l * {center}, inertia = sphere(m{k}, l))] b{k}: Body,
            #[joint({parent} -> b{k}, {kind},"
        );
    }
    let last = length - 1;
    item += &format!(
        "#[acts(on = j{}, stiffness = k)] spring: Spring, #[acts(on = j{last}, damping = c)] damper: Dashpot,
        #[acts(on = j{last})] push: {},",
        usize::from(free),
        if pins[last] { "Torque" } else { "Force" }
    );
    if constrained {
        let factor = match (pins[1], pins[0]) {
            (false, true) => "l * ",
            (true, false) => "1 / l * ",
            _ => "",
        };
        item += &match (pins[0], random_index_below(2)) {
            (true, 0) => format!("#[constraint(rate(j1) = {factor}rate(j0) * cos(j0))] hold: Nonholonomic,"),
            (_, 0) => format!("#[constraint(rate(j1) = 2 * {factor}rate(j0))] hold: Nonholonomic,"),
            _ => format!("#[constraint(j1 = 2 * {factor}j0)] hold: Holonomic,"),
        };
    }
    item + "}"
}

#[test]
fn all_printed_forms_agree_for_random_mechanisms() {
    let mut random = Random(4321);
    (0..20).for_each(|_| _ = random.random_number_below(2));
    // Number of comparisons: Lagrange's and recursive equations, Hamilton's, Kane's, Routh's.
    let mut compared = [0; 4];
    for k in 0..48 {
        let (driven, constrained) = (k % 4 == 1 || k % 4 == 3, k % 4 > 1);
        let item = random_chain(&mut random, driven, constrained, k % 8 == 0);
        call_with_parsed_model("-g * z", &item, |model| {
            let joints = crate::kinematics::joints_of_model(&model);
            let mass = crba::mass_matrix(&model, &joints);
            if derive(&model, &joints, &mass, None, &EquationSizeLimits::READABLE).is_some() {
                check_against_recursive_algorithms(&model);
                compared[0] += 1;
            }
            if constrained && super::super::kane::kane_equations(&model, &joints, None).is_ok() {
                check_printed_equations(&model);
                compared[2] += 1;
            }
            if !constrained && canonical_equations(&model, &joints, &mass).is_some() {
                check_hamiltons_equations(&model);
                compared[1] += 1;
            }
            if !constrained && !driven && !routh::cyclic_coordinates(&model, &joints).is_empty() {
                compare_routh_with_lagrange(&model);
                compared[3] += 1;
            }
        });
    }
    assert!(compared.iter().zip([40, 12, 20, 5]).all(|(n, least)| *n >= least), "{compared:?}");
}
