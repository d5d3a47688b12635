// Mechanisms of this program and of its translation to C. `build.rs` adds the arithmetic to their attributes.

/// Panda arm with seven axes, without fingers.
#[mechanism(
    urdf = "../../models/urdf/panda.urdf", derivatives,
    lock = ["panda_finger_joint1", "panda_finger_joint2"]
)]
pub struct Arm;

/// Quadruped robot on a free base.
#[mechanism(urdf = "../../models/urdf/solo12.urdf", base = free, derivatives)]
pub struct Quadruped;

/// Rotating rod whose outputs are all elementary functions.
#[mechanism(gravity = -9.81 * y)]
pub struct ElementaryFunctionOutputs {
    #[body(mass = 1, com = 0.3 * x, inertia = rod(1, 0.6, x))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    hinge: Pin,
    #[output(sin(hinge) + tan(hinge) + atan(3 * hinge) + atan2(hinge, cos(hinge)))]
    pub angles: Scalar,
    #[output(asin(sin(hinge) / 2) + acos(cos(hinge) / 2))]
    pub inverse_functions: Scalar,
    #[output(sinh(hinge) + cosh(hinge) + tanh(hinge) + exp(hinge))]
    pub exponentials: Scalar,
    #[output(ln(2 + sin(hinge)) + pow(2 + cos(hinge), hinge) + sqrt(abs(hinge)))]
    pub powers: Scalar,
    #[output(min(hinge, 1) + max(hinge, 0) + signum(hinge))]
    pub pieces: Scalar,
}

/// Engine: crank, rod and piston, which form a closed loop.
#[mechanism(gravity = -9.81 * y)]
pub struct Engine {
    pub length: f64,
    #[body(mass = 2, com = 0.02 * x, inertia = rod(2, 0.04, x))]
    crank: Body,
    #[body(mass = 0.5, com = length / 2 * x, inertia = rod(0.5, length, x))]
    rod: Body,
    #[body(mass = 0.4)]
    piston: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(0.04 * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(ground -> piston, along = x)]
    cylinder: Sleeve,
    #[joint(rod.at(length * x) -> piston, about = z)]
    small_end: Pin,
    #[acts(on = main)]
    motor: Torque,
}

/// Box on the ground, which is pushed.
#[mechanism(gravity = -9.81 * z)]
pub struct Crate {
    pub friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.4, 0.3, 0.2))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[contact(hull.cuboid(0.4, 0.3, 0.2), ground.plane(z), friction = friction, restitution = 0.2)]
    base: Contact,
    #[acts(on = hull.at(0.1 * z), along = x)]
    push: Force,
}
