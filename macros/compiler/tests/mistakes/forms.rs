//! Forms of the equations that do not exist for a mechanism.

use super::{ErrorRow, check_error_rows};

/// Inserts the text before `|` into the attribute and the text after it into the fields.
fn insert_into_mechanism_source(said: &str) -> (String, String) {
    let (words, fields) = said.split_once('|').unwrap_or((said, ""));
    let own =
        "m: f64, #[body(mass = m)] cart: Body, #[body(mass = m, com = y, inertia = sphere(m, 1))] arm: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve, #[joint(cart -> arm, about = z)] hinge: Pin,
        #[acts(on = rail, stiffness = 3)] spring: Spring,";
    (format!("gravity = -9.81 * y, {words}"), format!("{own} {fields}"))
}

#[test]
fn unavailable_forms_name_the_available_ones() {
    const ROWS: &[ErrorRow] = &[
        (
            "equations = hamilton|#[constraint(rail * rail + 1 * hinge * hinge = 1)] wire: Holonomic,",
            "Hamilton's equations are printed only for mechanisms without constraints",
            "`equations = lagrange`",
        ),
        (
            "routh|#[constraint(rail * rail + 1 * hinge * hinge = 1)] wire: Holonomic,",
            "Routh's equations require a mechanism without constraints",
            "`conserved`",
        ),
        (
            "equations = hamilton|#[speed(2 * rate(rail))] u: Speed,",
            "Hamilton's equations are printed in the momenta of coordinates, not of declared speeds",
            "Kane's equations in speeds",
        ),
        (
            "equations = routh",
            "no coordinate of this mechanism is cyclic",
            "Routh's equations eliminate plain",
        ),
        ("routh", "no coordinate of this mechanism is cyclic", "Routh's equations eliminate plain"),
        (
            "equations = routh|#[speed(2 * rate(rail))] u: Speed,",
            "Routh's equations are available in coordinates, not in declared speeds",
            "the reduction replaces the rates of cyclic",
        ),
        (
            "routh|#[speed(2 * rate(rail))] u: Speed,",
            "Routh's equations are available in coordinates, not in declared speeds",
            "the reduction replaces the rates of cyclic",
        ),
        (
            "sensitivities|#[speed(m * rate(rail))] u: Speed,",
            "derivatives with respect to parameters are not available with speeds that contain parameters",
            "the motion of the configuration would depend",
        ),
        (
            "sensitivities|#[speed(m * cos(hinge) * rate(rail))] u: Speed,",
            "derivatives with respect to parameters are not available with speeds that contain parameters",
            "the motion of the configuration would depend",
        ),
        (
            "inertia = none|#[output(reaction_force(hinge))] load: Vector,",
            "the output `load` names a reaction, which needs inertia",
            "without inertia there are no dynamics",
        ),
    ];
    check_error_rows(insert_into_mechanism_source, ROWS);
}

/// Checks that Routh's equations of four coupled cyclic coordinates are rejected as too long to print.
#[test]
fn overlong_routh_equations_are_rejected() {
    fn cyclic_coordinates_mechanism_source(words: &str) -> (String, String) {
        let mut fields = "#[body(mass = 1, inertia = sphere(1, 1))] cart0: Body, \
                          #[joint(ground -> cart0, along = x)] rail0: Sleeve,"
            .to_string();
        for k in 1..5 {
            fields += &format!(
                "#[body(mass = {k}, inertia = sphere(1, 1))] cart{k}: Body,
                #[joint(cart{} -> cart{k}, along = unit([1, {k}, 0]))] rail{k}: Sleeve,",
                k - 1
            );
        }
        (words.to_string(), fields)
    }
    const ROWS: &[ErrorRow] = &[(
        "equations = routh",
        "Routh's equations of this mechanism are too long: more than three cyclic coordinates are coupled by \
         inertia, or thousands of terms",
        "the option `routh` generates them",
    )];
    check_error_rows(cyclic_coordinates_mechanism_source, ROWS);
}

/// A sliding contact has a normal force, which independent speeds do not eliminate.
#[test]
fn kane_equations_are_rejected_for_sliding_contacts() {
    fn sliding_contact_mechanism_source(words: &str) -> (String, String) {
        let fields = "#[body(mass = 1, inertia = disk(1, 0.2, z))] disk: Body, #[joint(ground -> disk, about = z)] pose: Planar,
            #[constraint(slips(disk.circle(0.2, z), ground.plane(y)), friction = 0.3, speed = 0.01)] contact: Slipping,
            #[constraint(pose.x = 0.1 * pose.angle)] wire: Holonomic,";
        (format!("gravity = -9.81 * y, {words}"), fields.to_string())
    }
    const ROWS: &[ErrorRow] = &[(
        "equations = kane",
        "the equations of a slipping contact contain its normal force, which is a multiplier",
        "write `equations = lagrange`",
    )];
    check_error_rows(sliding_contact_mechanism_source, ROWS);
}

/// Pins about skew axes, with a nonholonomic constraint on the last link.
#[test]
fn overlong_kane_equations_are_rejected() {
    fn pin_chain_mechanism_source(words: &str) -> (String, String) {
        let link_declarations = |k: usize| {
            let parent = if k == 0 { "ground".to_string() } else { format!("link{}.at(0.4 * x)", k - 1) };
            format!(
                "#[body(mass = 1, com = [0.1, 0.2, 0.05], inertia = diagonal(0.3, 0.4, 0.5))] link{k}: Body,
                #[joint({parent} -> link{k}, about = {})] joint{k}: Pin,",
                ["z", "y", "x"][k % 3]
            )
        };
        let blade =
            "#[constraint(dot(v(link4.at(0.4 * x) / ground / ground), link4.y) = 0)] blade: Nonholonomic,";
        (format!("gravity = -9.81 * z, {words}"), (0..5).map(link_declarations).collect::<String>() + blade)
    }
    const ROWS: &[ErrorRow] = &[(
        "equations = kane",
        "Kane's equations of this mechanism have thousands of terms",
        "or declare generalized speeds in which the equations are shorter",
    )];
    check_error_rows(pin_chain_mechanism_source, ROWS);
}

/// A plate on three cranks that remain parallel. One constraint is redundant in every parallel configuration,
/// but none may be dropped where the cranks are not parallel.
#[test]
fn kane_equations_are_rejected_for_dependent_constraints() {
    fn crank_linkage_mechanism_source(words: &str) -> (String, String) {
        let cranks = (0..3).map(|k| {
            format!(
                "#[body(mass = 1, com = y / 2, inertia = rod(1, 1, y))] crank{k}: Body,
                #[joint(ground.at({k} * x) -> crank{k}, about = z)] foot{k}: Pin,"
            )
        });
        let ends =
            (0..3).map(|k| format!("#[joint(crank{k}.at(y) -> plate.at({k} * x), about = z)] end{k}: Pin,"));
        let plate = "#[body(mass = 1, com = x, inertia = rod(1, 2, x))] plate: Body,";
        (
            format!("gravity = -9.81 * y, {words}"),
            cranks.collect::<String>() + plate + &ends.collect::<String>(),
        )
    }
    const ROWS: &[ErrorRow] = &[(
        "equations = kane",
        "no velocities of this mechanism are determined by the others through its constraints in every \
         configuration",
        "write `equations = lagrange`, which keeps all constraints with multipliers",
    )];
    check_error_rows(crank_linkage_mechanism_source, ROWS);
}

/// The canonical equations are not defined for forces that depend on accelerations.
#[test]
fn acceleration_forces_exclude_hamiltons_equations() {
    fn source_with_added_force(words: &str) -> (String, String) {
        insert_into_mechanism_source(&format!(
            "{words}|#[acts(on = rail, value = -m * dot(a(arm / ground / ground), x))] added: Force,"
        ))
    }
    const HAMILTON: &str = "a force that depends on accelerations excludes Hamilton's equations";
    const ROUTH: &str = "a force that depends on accelerations excludes Routh's equations";
    const SECOND: &str = "a force that depends on accelerations excludes second derivatives";
    const MOMENTA: &str = "a force that depends on accelerations excludes derivatives of momenta";
    const HELP: &str = "remove the option that requests them, or these terms of the force";
    const ROWS: &[ErrorRow] = &[
        ("hamilton", HAMILTON, HELP),
        ("equations = hamilton", HAMILTON, HELP),
        ("routh", ROUTH, HELP),
        ("equations = routh", ROUTH, HELP),
        ("second_derivatives", SECOND, HELP),
        ("momentum_derivatives", MOMENTA, HELP),
    ];
    check_error_rows(source_with_added_force, ROWS);
}

/// Returns `count` carts on separate rails, with forces on the first `forces` of them.
fn carts_with_forces(count: usize, forces: usize) -> String {
    let cart_declarations = |k: usize| {
        format!(
            "m{k}: f64, #[body(mass = m{k})] cart{k}: Body, \
             #[joint(ground -> cart{k}, along = x)] rail{k}: Sleeve,"
        )
    };
    let force_declaration = |k: usize| format!("#[acts(on = rail{k}, value = -3 * rail{k})] push{k}: Force,");
    (0..count).map(cart_declarations).chain((0..forces).map(force_declaration)).collect()
}

#[test]
fn requests_for_overlong_functions_are_rejected() {
    const HELP: &str = "request it for a smaller mechanism";
    check_error_rows(
        |words| (words.to_string(), carts_with_forces(68, 68)),
        &[
            (
                "sensitivities",
                "the code of the derivatives with respect to this many parameters would be too long",
                HELP,
            ),
            ("derivatives", "the code of the derivatives of this many elements would be too long", HELP),
        ],
    );
}

#[test]
fn equations_of_thousands_of_terms_are_rejected() {
    let chain_with_options = |words: &str| {
        let link_declarations = |k: usize| {
            let parent = if k == 0 { "ground".to_string() } else { format!("link{}.at(x)", k - 1) };
            format!(
                "#[body(mass = 1, com = y, inertia = diagonal(1, 2, 2.5))] link{k}: Body,
                #[joint({parent} -> link{k}, about = unit([1, {k}, 2]))] pin{k}: Pin,"
            )
        };
        (words.to_string(), (0..5).map(link_declarations).collect::<String>())
    };
    check_error_rows(
        chain_with_options,
        &[(
            "equations = lagrange",
            "the equations of this mechanism have thousands of terms, or more symbols and functions than are \
             expanded",
            "`equations = structure` prints their structure",
        )],
    );
}
