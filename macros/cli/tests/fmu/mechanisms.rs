//! Mechanisms whose exported FMUs are tested.

use linkwork::prelude::*;

/// Boat whose thrust follows the throttle with a lag, and whose drag is a table.
#[mechanism]
pub struct Boat {
    pub mass: f64,
    pub lag: f64,
    pub drag: Table<1>,
    throttle: Input,
    #[state(rate = (throttle - thrust) / lag)]
    pub thrust: State,
    #[body(mass = mass)]
    hull: Body,
    #[joint(ground -> hull, along = x)]
    way: Sleeve,
    #[acts(on = way, value = thrust - drag(rate(way)))]
    propeller: Force,
    #[output(thrust * rate(way))]
    useful_power: Scalar,
}

/// Ball that bounces on a floor.
#[mechanism(gravity = -9.81 * z)]
pub struct BouncingBall {
    pub bounce: f64,
    #[body(mass = 0.5, inertia = sphere(0.5, 0.1))]
    ball: Body,
    #[joint(ground -> ball, along = z)]
    height: Sleeve,
    #[contact(ball.sphere(0.1), ground.plane(z), restitution = bounce)]
    floor: Contact,
}

/// Box that slides on a rough floor.
#[mechanism(gravity = -9.81 * z)]
pub struct Crate {
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = 0.4)]
    floor: Contact,
}

/// Two balls on top of each other with Poisson's restitution, which FMUs do not support.
#[mechanism(gravity = -9.81 * z)]
pub struct Stack {
    pub bounce: f64,
    #[body(mass = 0.5, inertia = sphere(0.5, 0.1))]
    ball: Body,
    #[joint(ground -> ball, along = z)]
    height: Sleeve,
    #[contact(ball.sphere(0.1), ground.plane(z), restitution = poisson(bounce))]
    floor: Contact,
}

/// Links without masses, whose accelerations are not determined.
#[mechanism(inertia = none)]
pub struct Skeleton {
    #[body]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    elbow: Pin,
}

/// Door that a force over time presses against its stop and opens later, and two balls that collide.
#[mechanism]
pub struct Door {
    pub strength: f64,
    #[body(mass = 1)]
    door: Body,
    #[joint(ground -> door, along = z)]
    way: Sleeve,
    #[limit(on = way, from = 0, to = 10, restitution = 0)]
    stops: Limit,
    #[acts(on = way, value = -strength * cos(2 * t))]
    wind: Force,
    #[body(mass = 2, inertia = sphere(2, 0.1))]
    left: Body,
    #[joint(ground -> left, along = x)]
    rail: Sleeve,
    #[body(mass = 2, inertia = sphere(2, 0.1))]
    right: Body,
    #[joint(ground -> right, along = x)]
    other_rail: Sleeve,
    #[contact(left.sphere(0.1), right.sphere(0.1), restitution = 1)]
    collision: Contact,
}

/// Pendulum whose names are keywords of C, no identifiers of C, or names of arguments of functions.
#[mechanism(gravity = -9.81 * y)]
pub struct Kernel {
    pub double: f64,
    pub int: f64,
    pub θ: f64,
    pub r#struct: f64,
    pub q: f64,
    pub m: f64,
    #[body(mass = double + int, com = θ * y, inertia = rod(double + r#struct + m, θ + q, y))]
    array: Body,
    #[joint(ground -> array, about = z)]
    register: Pin,
    #[acts(on = register)]
    switch: Torque,
    #[output(sin(register))]
    main: Scalar,
}
