//! Declarations of small mechanisms, whose equations are tested.

/// A cart with a pole.
pub const CART_POLE: &str = "
struct CartPole {
    cart_mass: f64, pole_mass: f64, pole_length: f64, rail_damping: f64,
    #[body(mass = cart_mass)] cart: Body,
    #[body(mass = pole_mass, com = pole_length / 2 * y, inertia = rod(pole_mass, pole_length, y))] pole: Body,
    #[joint(ground -> cart, along = x)] rail: Sleeve,
    #[joint(cart -> pole, about = z)] hinge: Pin,
    #[acts(on = rail, damping = rail_damping)] friction: Dashpot,
    #[acts(on = cart, along = x)] push: Force,
}";

/// A double pendulum with relative angles.
pub const DOUBLE_PENDULUM: &str = "
struct DoublePendulum {
    g: f64, m1: f64, m2: f64, l1: f64, l2: f64,
    #[body(mass = m1, com = -l1 / 2 * y, inertia = rod(m1, l1, y))] upper: Body,
    #[body(mass = m2, com = -l2 / 2 * y, inertia = rod(m2, l2, y))] lower: Body,
    #[joint(ground -> upper, about = z)] shoulder: Pin,
    #[joint(upper.at(-l1 * y) -> lower, about = z)] elbow: Pin,
    #[acts(on = elbow)] motor: Torque,
}";

/// A rotor in three gimbals.
pub const GYROSCOPE: &str = "
struct Gyroscope {
    axial: f64, transverse: f64, mass: f64, lever: f64, g: f64,
    #[body(mass = 0, inertia = 0)] outer: Body,
    #[body(mass = 0, inertia = 0)] inner: Body,
    #[body(mass = mass, com = lever * z, inertia = diagonal(transverse, transverse, axial))] rotor: Body,
    #[joint(ground -> outer, about = z)] precession: Pin,
    #[joint(outer -> inner, about = x)] nutation: Pin,
    #[joint(inner -> rotor, about = z)] spin: Pin,
}";

/// A slider with a spring on a rotating shaft.
pub const SHAFT: &str = "
struct SliderOnShaft {
    g: f64, shaft_inertia: f64, mass: f64, stiffness: f64, free_length: f64, damping: f64,
    #[body(mass = 1, inertia = diagonal(shaft_inertia, shaft_inertia, shaft_inertia))] shaft: Body,
    #[body(mass = mass)] slider: Body,
    #[joint(ground -> shaft, about = z)] turn: Pin,
    #[joint(shaft -> slider, along = x)] slide: Sleeve,
    #[acts(on = slide, stiffness = stiffness, free_length = free_length)] coil: Spring,
    #[acts(on = slide, damping = damping)] damper: Dashpot,
    #[acts(on = turn)] motor: Torque,
}";

/// A spherical pendulum.
pub const SPHERICAL: &str = "
struct Spherical {
    g: f64, m: f64, l: f64,
    #[particle(mass = m, at = bob.at(-l * z))] weight: Particle,
    #[body] bob: Body,
    #[joint(ground -> bob, about = (x, y))] pivot: Universal,
}";

/// Two masses on springs.
pub const CHAIN: &str = "
struct Chain {
    m1: f64, m2: f64, k1: f64, k2: f64, l1: f64, g: f64,
    #[body(mass = m1)] first: Body,
    #[body(mass = m2)] second: Body,
    #[joint(ground -> first, along = y)] one: Sleeve,
    #[joint(first -> second, along = y)] two: Sleeve,
    #[acts(on = one, stiffness = k1, free_length = l1)] coil: Spring,
    #[acts(on = two, stiffness = k2, free_length = 0.5)] coil2: Spring,
}";

/// A top on a ball joint, with quaternion components.
pub const BALL: &str = "
struct Top {
    g: f64, m: f64, l: f64, a: f64, c: f64,
    #[body(mass = m, com = l * z, inertia = diagonal(a, a, c))] top: Body,
    #[joint(ground -> top)] tip: Ball,
}";

/// A cart with a pole and no parameters.
pub const NUMBERS: &str = "
struct NumericCart {
    #[body(mass = 1.0, inertia = diagonal(0.004, 0.003, 0.005))] cart: Body,
    #[body(mass = 0.1, com = [0.01, 0, 0.5], inertia = [[0.0085, 0, 0.0001], [0, 0.0084, 0], [0.0001, 0, 0.0002]])] pole: Body,
    #[joint(ground.at(0.2 * z) -> cart, along = x)] slide: Sleeve,
    #[joint(cart.at(0.05 * z) -> pole, about = y)] swing: Pin,
    #[acts(on = slide)] drive: Force,
}";

/// A triple pendulum.
pub const TRIPLE: &str = "
struct Triple {
    g: f64, m1: f64, m2: f64, m3: f64, l1: f64, l2: f64, l3: f64,
    #[body(mass = m1, com = -l1 / 2 * y, inertia = rod(m1, l1, y))] upper: Body,
    #[body(mass = m2, com = -l2 / 2 * y, inertia = rod(m2, l2, y))] middle: Body,
    #[body(mass = m3, com = -l3 / 2 * y, inertia = rod(m3, l3, y))] lower: Body,
    #[joint(ground -> upper, about = z)] a: Pin,
    #[joint(upper.at(-l1 * y) -> middle, about = z)] b: Pin,
    #[joint(middle.at(-l2 * y) -> lower, about = z)] c: Pin,
}";

/// An arm that also rotates about the vertical.
pub const ARM: &str = "
struct Arm {
    g: f64, m1: f64, m2: f64, l1: f64, l2: f64,
    #[body] yaw: Body,
    #[body(mass = m1, com = l1 / 2 * x, inertia = rod(m1, l1, x))] upper: Body,
    #[body(mass = m2, com = l2 / 2 * x, inertia = rod(m2, l2, x))] lower: Body,
    #[joint(ground -> yaw, about = z)] base: Pin,
    #[joint(yaw -> upper, about = y)] shoulder: Pin,
    #[joint(upper.at(l1 * x) -> lower, about = y)] elbow: Pin,
}";

/// A chain with skewed axes and full inertia matrices: the worst case of four velocities.
pub const SKEW: &str = "
struct Skew {
    #[body(mass = 1.3, com = [0.1, -0.2, 0.05], inertia = [[0.03, 0.002, -0.001], [0.002, 0.04, 0.003], [-0.001, 0.003, 0.05]])] a: Body,
    #[body(mass = 1.3, com = [0.1, -0.2, 0.05], inertia = [[0.03, 0.002, -0.001], [0.002, 0.04, 0.003], [-0.001, 0.003, 0.05]])] b: Body,
    #[body(mass = 1.3, com = [0.1, -0.2, 0.05], inertia = [[0.03, 0.002, -0.001], [0.002, 0.04, 0.003], [-0.001, 0.003, 0.05]])] c: Body,
    #[body(mass = 1.3, com = [0.1, -0.2, 0.05], inertia = [[0.03, 0.002, -0.001], [0.002, 0.04, 0.003], [-0.001, 0.003, 0.05]])] d: Body,
    #[joint(ground.at(0.2 * x + 0.1 * z).rotated(x(0.2)) -> a.at(0.3 * y), about = y)] p: Pin,
    #[joint(a.at([0.1, 0.2, 0.3]).rotated(z(0.4), x(-0.3)) -> b, about = [0.6, 0, -0.8])] q: Pin,
    #[joint(b.at([0.1, 0.2, 0.3]).rotated(z(0.4), x(-0.3)) -> c, about = x)] r: Pin,
    #[joint(c.at([0.1, 0.2, 0.3]).rotated(z(0.4), x(-0.3)) -> d, about = y)] s: Pin,
}";

/// A table that carries a pendulum and a nut on a screw, with a force whose direction involves two frames.
pub const WAGON: &str = "
struct Wagon {
    g: f64, m: f64, m1: f64, l1: f64, k: f64, c: f64, lead: f64,
    #[body(mass = m)] wagon: Body,
    #[body(mass = m1, com = -l1 * y)] bob: Body,
    #[body(mass = m1, inertia = diagonal(k, k, k))] nut: Body,
    #[joint(ground -> wagon, along = (x, y))] table: Stage,
    #[joint(wagon -> bob, about = z)] pin: Pin,
    #[joint(wagon -> nut, about = y, pitch = lead)] screw: Screw,
    #[acts(on = table.x, damping = c)] damper: Dashpot,
    #[acts(on = bob.at(-l1 * y), along = ground.x + bob.y)] jet: Force,
}";

/// A bead with one coordinate, whose position tests replace by expressions.
pub const HOOP: &str = "
struct Hoop {
    g: f64, m: f64, _radius: f64, _speed: f64,
    #[body(mass = m)] bead: Body,
    #[joint(ground -> bead, about = z)] theta: Pin,
}";

/// A free body.
pub const FREE: &str = "
struct FreeBody {
    g: f64, m: f64, a: f64, b: f64, c: f64,
    #[body(mass = m, inertia = diagonal(a, b, c))] body: Body,
    #[joint(ground -> body)] pose: Free,
}";

/// A rolling ball.
pub const SPHERE: &str = "
struct RollingSphere {
    g: f64, m: f64, radius: f64,
    #[body(mass = m, inertia = sphere(m, radius))] ball: Body,
    #[joint(ground -> ball)] pose: Free,
    #[constraint(rolls(ball.sphere(radius), ground.plane(z)))] contact: Rolling,
}";

/// A wheel on an axle that moves in a horizontal plane.
pub const CASTOR: &str = "
struct Castor {
    #[body(mass = 1, inertia = diagonal(1, 1, 1))] axle: Body,
    #[body(mass = 1, inertia = disk(1, 0.3, y))] wheel: Body,
    #[joint(ground -> axle, about = z)] plane: Planar,
    #[joint(axle.at(0.3 * z) -> wheel, about = y)] roll: Pin,
    #[constraint(rolls(wheel.circle(0.3, y), ground.plane(z)))] contact: Rolling,
}";

/// Constants with π: a right angle, the lead of a screw, and a moment of inertia that is a fraction.
pub const TURNS: &str = "
struct Turns {
    coil: f64, m: f64, i: f64, lead: f64,
    #[body(mass = 1, inertia = diagonal(1.5, 1.5, 1.5))] arm: Body,
    #[body(mass = m, inertia = diagonal(i, i, i))] nut: Body,
    #[joint(ground -> arm, about = z)] q: Pin,
    #[joint(ground -> nut, about = x, lead = lead)] s: Screw,
    #[acts(on = q, stiffness = coil, free_angle = pi / 2)] spring: Spring,
}";

/// Returns a row of masses with springs between neighbours.
pub fn masses_with_springs(n: usize) -> String {
    let mut items = String::new();
    for k in 0..n {
        let energy = match k {
            0 => "k / 2 * x0 * x0".to_string(),
            _ => format!("k / 2 * (x{k} - x{0}) * (x{k} - x{0})", k - 1),
        };
        items += &format!("#[body(mass = m)] b{k}: Body, #[joint(ground -> b{k}, along = x)] x{k}: Sleeve,");
        items += &format!("#[energy({energy})] s{k}: Potential,");
    }
    format!("struct Masses {{ g: f64, m: f64, k: f64, {items} }}")
}

/// A rolling disk.
pub const DISK: &str = "
struct RollingDisk {
    g: f64, m: f64, radius: f64,
    #[body(mass = m, inertia = disk(m, radius, y))] disk: Body,
    #[joint(ground -> disk)] pose: Free,
    #[constraint(rolls(disk.circle(radius, y), ground.plane(z)))] contact: Rolling,
}";
