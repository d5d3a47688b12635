//! Mechanisms that the command reads from this file, and that the tests compile in Rust.

use linkwork::prelude::*;

/// Names that are reserved in C, a ball joint, functions of many kinds, and a reaction as output.
#[mechanism(
    gravity = -9.81 * z, second_derivatives, momentum_derivatives, sensitivities, centroidal, hamilton, conserved, regressor, packed
)]
#[allow(non_snake_case, reason = "a name that is a macro in C")]
pub struct MechanismWithReservedNames {
    pub int: f64,
    pub class: f64,
    pub r#type: f64,
    pub NAN: f64,
    #[body(mass = int, com = class * x, inertia = sphere(int, 0.3))]
    double: Body,
    #[body(mass = r#type, com = 0.4 * y, inertia = rod(r#type, 0.8, y))]
    restrict: Body,
    #[joint(ground -> double)]
    neck: Ball,
    #[joint(double.at(x) -> restrict, about = x)]
    void: Pin,
    #[acts(on = void, stiffness = NAN)]
    long: Spring,
    #[acts(on = void)]
    motor: Torque,
    #[acts(on = void, value = -0.3 * signum(rate(void)) * rate(void) * rate(void) + tanh(rate(void)))]
    drag: Torque,
    #[output(exp(void) + atan2(sin(void), 2) + max(void, 0.1) + abs(void) + ln(2 + cos(void)))]
    short: Scalar,
    #[output(reaction_force(void))]
    load: Vector,
}

/// Free body with prescribed forces over time, in the standard atmosphere.
#[mechanism(gravity = -9.81 * z, derivatives)]
pub struct Balloon {
    pub mass: f64,
    pub buoyancy: f64,
    #[body(mass = mass, inertia = sphere(mass, 2))]
    hull: Body,
    #[joint(ground -> hull)]
    flight: Free,
    #[body(mass = 0.2 * mass, com = -0.5 * z, inertia = sphere(0.2 * mass, 0.3))]
    basket: Body,
    #[joint(hull.at(-2 * z) -> basket, about = y)]
    swing: Pin,
    #[acts(on = hull, value = buoyancy * density(dot(r(hull / ground), ground.z)) * z)]
    lift: Force,
    #[acts(on = swing, value = 0.3 * sin(2 * t))]
    wind: Torque,
    #[acts(on = swing)]
    crew: Torque,
    #[limit(on = swing, from = -1, to = 1.5, max_speed = 4)]
    ropes: Limit,
}

/// Tables of one to three variables, evaluated within and beyond the grid, with linear and spline
/// interpolation.
#[mechanism(gravity = -9.81 * y, derivatives)]
pub struct Wing {
    pub mass: f64,
    pub lift: Table<2>,
    pub drag: Table<1>,
    pub moment: Table<3>,
    #[body(mass = mass, com = -0.5 * y, inertia = rod(mass, 1, y))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[body(mass = 0.1, com = -0.1 * y, inertia = rod(0.1, 0.2, y))]
    flap: Body,
    #[joint(arm.at(-y) -> flap, about = z)]
    pivot: Pin,
    #[acts(on = hinge, value = lift(hinge, rate(hinge)) - drag(rate(hinge)))]
    air: Torque,
    #[acts(on = pivot, value = moment(hinge, pivot, rate(pivot)))]
    eddies: Torque,
    #[acts(on = pivot)]
    motor: Torque,
}
