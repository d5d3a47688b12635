//! Mechanisms with combinations of features that are rare in random mechanisms.

/// Test mechanisms: arguments of the attribute, fields, and functions that must be among the compared
/// functions.
pub const MECHANISMS: [(&str, &str, &[&str]); 7] = [
    (
        "gravity = -9.81 * y, derivatives, second_derivatives, momentum_derivatives, sensitivities, \
         regressor, hamilton",
        "m: f64, l: f64,
        #[body(mass = 2)] cart: Body,
        #[body(mass = m, com = 0.4 * l * x, inertia = rod(m, 1.2, x))] arm: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(cart -> arm, about = z)] hinge: Pin,
        #[acts(on = arm.at(l * x), along = arm.y)] jet: Force,
        #[acts(on = rail, damping = c * l)] rubbing: Dashpot, #[define(0.3)] c: Scalar,
        #[speed(rate(rail) * cos(hinge) + 0.3 * rate(hinge))] along: Speed,
        #[speed(1.5 * rate(hinge) - rate(rail) * sin(hinge))] turn: Speed,
        #[output(along * hinge)] product: Scalar,
        #[output(reaction_force(hinge))] load: Vector,",
        &[
            "inverse_dynamics_by_parameters",
            "forward_dynamics_by_parameters",
            "generalized_forces_by_parameters",
            "inverse_dynamics_second_derivatives",
            "generalized_forces_second_derivatives",
        ],
    ),
    (
        "gravity = -9.81 * y, derivatives, second_derivatives, sensitivities",
        "m: f64,
        #[body(mass = m, inertia = diagonal(0.3, 0.4, 0.5))] sleigh: Body,
        #[joint(ground -> sleigh, about = z)] pose: Planar,
        #[acts(on = sleigh.at(0.3 * x), along = sleigh.y)] jet: Force,
        #[constraint(dot(v(sleigh.at(0.7 * x) / ground / ground), sleigh.y) = 0)] blade: Nonholonomic,
        #[speed(rate(pose.x) * cos(pose.angle) + rate(pose.y) * sin(pose.angle))] ahead: Speed,
        #[speed(rate(pose.y) * cos(pose.angle) - rate(pose.x) * sin(pose.angle))] aside: Speed,
        #[speed(0.7 * rate(pose.angle))] turn: Speed,",
        &[
            "__motion_derivatives",
            "__constraint_curvature",
            "inverse_dynamics_second_derivatives",
            "generalized_forces_second_derivatives",
        ],
    ),
    (
        "gravity = -9.81 * y, derivatives, batch",
        "#[body(mass = 2, inertia = diagonal(0.3, 0.4, 0.5))] block: Body,
        #[joint(ground -> block, about = z)] pose: Planar,
        #[contact(block.sphere(0.3), ground.plane(y), friction = 0.3)] floor: Contact,
        #[speed(rate(pose.x) * cos(pose.angle) + rate(pose.y) * sin(pose.angle))] ahead: Speed,
        #[speed(rate(pose.y) * cos(pose.angle) - rate(pose.x) * sin(pose.angle))] aside: Speed,
        #[speed(0.7 * rate(pose.angle))] turn: Speed,
        #[output(atan2(sin(pose.x), 2 + cos(pose.angle)))] angle: Scalar,",
        &["contact_rates", "contact_jacobian", "angle_derivatives"],
    ),
    (
        "gravity = -9.81 * z, derivatives",
        "m: f64, p: f64,
        #[body(mass = m, com = 0.1 * x, inertia = diagonal(0.3, 0.4, 0.5))] nut: Body,
        #[body(mass = 2, com = 0.1 * y, inertia = diagonal(0.6, 0.4, 0.5))] ram: Body,
        #[joint(ground -> nut, about = z)] bearing: Pin,
        #[joint(ground.at(0.3 * x).rotated(y(0.1)) -> ram)] guide: Free,
        #[joint(nut.at(0.2 * x).rotated(x(0.3)) -> ram.at(0.1 * y), about = z, pitch = p)] thread: Screw,",
        &["constraint_residuals", "constraint_jacobian", "constraint_bias"],
    ),
    // Inputs that equal entries of the generalized forces, next to and after joints of every chart.
    (
        "gravity = -9.81 * y, derivatives",
        "#[body(mass = 1)] cart: Body,
        #[body(mass = 2, inertia = sphere(2, 0.3))] hull: Body,
        #[body(mass = 1, inertia = sphere(1, 0.2))] eye: Body,
        #[body(mass = 1, com = 0.1 * y, inertia = sphere(1, 0.2))] flag: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(ground -> hull)] flight: Free,
        #[joint(hull -> eye)] socket: Ball,
        #[joint(eye -> flag, about = z)] pole: Pin,
        #[acts(on = pole)] motor: Torque,
        #[acts(on = rail)] push: Force,",
        &["__input_derivatives"],
    ),
    // An input that acts on two entries of the generalized forces.
    (
        "gravity = -9.81 * y, derivatives",
        "push: Input,
        #[body(mass = 2, com = 0.2 * x, inertia = diagonal(0.3, 0.4, 0.5))] block: Body,
        #[joint(ground -> block, about = z)] pose: Planar,
        #[acts(on = block, value = push * (ground.x + ground.y))] oblique: Force,",
        &["__input_derivatives"],
    ),
    (
        "gravity = -9.81 * y, second_derivatives",
        "command: Input,
        #[body(mass = 2)] cart: Body,
        #[body(mass = 1, com = 0.4 * x, inertia = rod(1, 1.2, x))] arm: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(cart -> arm, about = z)] hinge: Pin,
        #[acts(on = hinge, value = command * command * rate(rail) * sin(hinge) + command * rate(hinge))] motor: Torque,",
        &["generalized_forces_second_derivatives"],
    ),
];

/// Returns a chain of pins whose columns are propagated to the root in lanes.
pub fn chain_source(joints: usize) -> String {
    (0..joints)
        .map(|k| {
            let (axis, place) = (["z", "y", "y"][k % 3], ["x", "z"][k % 2]);
            let parent = if k == 0 { "ground".to_string() } else { format!("link{}.at(0.3 * {place})", k - 1) };
            format!(
                "#[body(mass = {}, com = [0.01, 0.02, 0.1], inertia = diagonal(0.03, 0.04, 0.02))] link{k}: Body,
                #[joint({parent} -> link{k}, about = {axis})] joint{k}: Pin,\n",
                2.0 - 0.1 * k as f64
            )
        })
        .collect()
}

/// Returns a body with identical limbs, which are evaluated in lanes.
pub fn body_with_limbs_source(count: usize, joints: usize) -> String {
    let mut fields =
        "#[body(mass = 5, inertia = sphere(5, 0.2))] trunk: Body, #[joint(ground -> trunk)] base: Free,\n"
            .to_string();
    for limb in 0..count {
        let sign_of_side = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let parent = format!("trunk.at([{}, {}, 0])", 0.2 * sign_of_side(limb), 0.1 * sign_of_side(limb / 2));
        fields += &self::limb_element_declarations(limb, parent, joints);
    }
    fields
}

/// Returns a limb of pins with springs at a point; limbs with different numbers are identical.
pub fn limb_element_declarations(number: usize, mut parent: String, joints: usize) -> String {
    let mut fields = String::new();
    for k in 0..joints {
        fields += &format!(
            "#[body(mass = {}, com = 0.2 * y, inertia = diagonal(0.03, 0.04, 0.02))] part{number}_{k}: Body,
            #[joint({parent} -> part{number}_{k}, about = {})] joint{number}_{k}: Pin,
            #[acts(on = joint{number}_{k}, stiffness = 7, free_angle = 0.1)] spring{number}_{k}: Spring,\n",
            2.0 - 0.3 * k as f64,
            ["x", "y", "z"][k % 3]
        );
        parent = format!("part{number}_{k}.at(0.4 * z)");
    }
    fields
}

/// Returns a body with `count` springs to the ground.
pub fn body_with_springs_source(count: usize) -> String {
    let mut fields = "#[body(mass = 2, inertia = diagonal(0.3, 0.4, 0.5))] block: Body,
        #[joint(ground -> block, about = z)] pose: Planar,"
        .to_string();
    for k in 0..count {
        fields += &format!(
            "#[acts(between = (block.at([0.{k}1, {}, 0]), ground.at([{k}, 2, 1])), stiffness = {}, \
             free_length = 0.3)] spring{k}: Spring,",
            k % 3,
            k + 2
        );
    }
    fields
}
