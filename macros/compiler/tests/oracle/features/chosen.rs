//! Mechanisms with what random ones seldom have together.

/// Arguments of the attribute, fields, and functions that must be among those that are compared.
pub const MECHANISMS: [(&str, &str, &[&str]); 4] = [
    (
        "gravity = -9.81 * y, derivatives, second_derivatives, momentum_derivatives, sensitivities, regressor, hamilton",
        "m: f64, l: f64,
        #[body(mass = 2)] cart: Body,
        #[body(mass = m, com = 0.4 * l * x, inertia = rod(m, 1.2, x))] arm: Body,
        #[joint(ground -> cart, along = x)] rail: Sleeve,
        #[joint(cart -> arm, about = z)] hinge: Pin,
        #[acts(on = arm.at(l * x), along = arm.y)] jet: Force,
        #[acts(on = rail, damping = 0.3 * l)] rubbing: Dashpot,
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
    // Limbs as lanes, whose results go into matrices in pairs.
    (
        "gravity = -9.81 * y, derivatives, packed",
        LIMBS,
        &["inverse_dynamics_derivatives_into", "mass_matrix_into"],
    ),
];

const LIMBS: &str = "
    #[body(mass = 5, inertia = sphere(5, 0.2))] trunk: Body,
    #[joint(ground -> trunk)] base: Free,
    #[body(mass = 2, com = 0.2 * y, inertia = diagonal(0.03, 0.04, 0.02))] left0: Body,
    #[body(mass = 1, com = 0.3 * z, inertia = diagonal(0.02, 0.03, 0.04))] left1: Body,
    #[body(mass = 0.7, com = 0.1 * x, inertia = diagonal(0.02, 0.01, 0.02))] left2: Body,
    #[body(mass = 2, com = 0.2 * y, inertia = diagonal(0.03, 0.04, 0.02))] right0: Body,
    #[body(mass = 1, com = 0.3 * z, inertia = diagonal(0.02, 0.03, 0.04))] right1: Body,
    #[body(mass = 0.7, com = 0.1 * x, inertia = diagonal(0.02, 0.01, 0.02))] right2: Body,
    #[joint(trunk.at(0.2 * x) -> left0, about = x)] left_joint0: Pin,
    #[joint(left0.at(0.4 * z) -> left1, about = y)] left_joint1: Pin,
    #[joint(left1.at(0.4 * z) -> left2, about = z)] left_joint2: Pin,
    #[joint(trunk.at(-0.2 * x) -> right0, about = x)] right_joint0: Pin,
    #[joint(right0.at(0.4 * z) -> right1, about = y)] right_joint1: Pin,
    #[joint(right1.at(0.4 * z) -> right2, about = z)] right_joint2: Pin,";
