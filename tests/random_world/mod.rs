//! Random mechanisms with every element of the language that is not a joint. They contain free coordinates,
//! frames and points that move as functions of coordinates and time, bodies and particles placed by them
//! (some of them identical), springs and inerters between points, potentials, dissipation functions, forces
//! with a value, and outputs.

use proptest::collection::vec;
use proptest::prelude::*;
use std::fmt::Write;

/// Random mechanism with all elements other than joints.
#[derive(Clone, Debug)]
pub struct RandomElementMechanism {
    root: usize,
    numbers: Vec<f64>,
    /// Whether the mechanism contains each element of `ACTIONS`.
    chosen: Vec<bool>,
    /// Whether the equations of the mechanism depend on time.
    time: bool,
}

/// Declarations of the joint of the first body: type and axes.
const ROOTS: [&str; 8] = [
    "Pin, about = unit([0.3, -0.2, 1])",
    "Sleeve, along = x",
    "Slot, along = x, about = z",
    "Universal, about = (x, y)",
    "Ball",
    "Screw, about = y, pitch = 0.3",
    "Free",
    "Planar, about = z",
];

/// Returns a strategy that generates random mechanisms.
pub fn random_element_mechanisms() -> impl Strategy<Value = RandomElementMechanism> {
    (0..ROOTS.len(), vec(-1.0..1.0_f64, 24), vec(any::<bool>(), ACTIONS.len()), any::<bool>())
        .prop_map(|(root, numbers, chosen, time)| RandomElementMechanism { root, numbers, chosen, time })
}

/// Bodies, frames and points of the mechanism. `#` is a random number, `@` an expression of time, or a number
/// if the mechanism does not depend on time.
const PLACES: &str = "
    throttle: Input,
    first: Coordinate,
    #[body(mass = 1.3, com = [#, #, #], inertia = cuboid(1.3, 0.5, 0.7, 0.9).rotated(z(#), x(#)))] base: Body,
    #[joint(ground.at([#, #, #]).rotated(y(#)) -> base.at([#, 0, 0])&)] root: %,
    second: Coordinate,
    #[frame(ground, z(first), x(0.4 * second + @))] turning: Frame,
    #[frame(base, eigenaxis(unit([0.3, #, 1.1]), first * second + @), z(#))] carried: Frame,
    #[point(on = base, at = second * x + # * sin(first + @) * turning.y)] hook: Point,
    #[point(at = [#, #, #])] still: Point,
    #[particle(mass = 0.7, at = (1.2 + 0.3 * second) * (sin(first) * turning.x - cos(first) * turning.z))]
    bead: Particle,
    #[particle(mass = 0.4, at = bead.at(0.5 * second * x + [#, #, #]))] pendant: Particle,
    #[particle(mass = 0.3, at = [first, second, 0.2 * @])] plain: Particle,
    #[body(
        mass = 0.8, inertia = diagonal(0.3, 0.5, 0.6).rotated(y(#)), at = hook.at([#, #, #]), frame = carried
    )]
    placed: Body,
    #[particle(mass = 0.6, at = plain.at([#, #, #]))] beside: Particle,
    #[particle(mass = 0.2, at = [first + sin(second), second, cos(second)])] further: Particle,
    #[body(
        mass = 0.4, com = [#, #, #], inertia = diagonal(0.2, 0.3, 0.25), at = [sin(first), @, 0],
        frame = turning
    )]
    twin: Body,
    #[body(
        mass = 0.7, com = [#, #, #], inertia = diagonal(0.3, 0.3, 0.2), at = [sin(first), @, #],
        frame = turning
    )]
    other: Body,
    #[body(mass = 0.5, com = [#, #, #], inertia = diagonal(0.2, 0.3, 0.25))] hung: Body,
    #[joint(hook.rotated(x(#)) -> hung.at([#, #, 0]), about = z)] pin: Pin,
    #[define(v(bead / base.at([#, #, 0]) / carried))] drift: Vector,
    #[define(dot(drift, drift) + # * first)] measure: Scalar,
";

/// Declarations of force elements, each of which a random mechanism may contain.
const ACTIONS: [&str; 21] = [
    "#[acts(between = (bead, base.at([#, #, 0.3])), stiffness = 3, free_length = 0.4)] e0: Spring,",
    "#[acts(between = (hook, pendant), force = 3 * stretch + 2 * pow(stretch, 3) + 0.4, free_length = 0.2)] \
     e1: Spring,",
    "#[acts(between = (still, placed), energy = 0.9 * cosh(0.3 * stretch) + 1.1 * sin(length), free_length = \
     0.1)] e2: Spring,",
    "#[acts(on = first, stiffness = 2, free_angle = #)] e3: Spring,",
    "#[acts(on = second, damping = 0.7)] e4: Dashpot,",
    "#[acts(between = (bead, hung), damping = 0.6)] e5: Dashpot,",
    "#[acts(between = (plain, hung), force = 2 * speed + 0.1 * pow(speed, 3))] e6: Dashpot,",
    "#[acts(between = (bead, hung.at([#, #, #])), inertance = 0.6)] e7: Inerter,",
    "#[acts(on = pin, inertance = 0.2 + 0.1)] e8: Inerter,",
    "#[acts(on = pin, coulomb = 0.3, stiction = 0.5, stribeck_speed = 2, viscous = 0.2, speed = 1)] e9: \
     Friction,",
    "#[acts(between = (bead, plain), constant = 0.7)] e10: Gravity,",
    "#[acts(between = (still, placed), mu = 2)] e11: Gravity,",
    "#[acts(between = (still, hung.at([#, #, #])), strength = 0.6)] e12: Attraction,",
    "#[energy(0.3 * dot(r(bead / hook), r(bead / hook)) + 0.8 * sin(first) * cos(@) + 1.1 * dot(r(hung / \
     ground), x + base.y))] e13: Potential,",
    "#[dissipation(0.2 * dot(v(bead / base / ground), v(bead / base / ground)) + 0.9 * pow(rate(first), 4))] \
     e14: Rayleigh,",
    "#[acts(on = hung.at([#, #, #]), value = throttle * base.x + 0.7 * sin(@) * ground.y - 0.3 * v(hung / \
     ground / ground))] e15: Force,",
    "#[acts(on = placed, value = (throttle * rate(pin) + # * measure) * carried.x + # * omega(hung / \
     placed))] e16: Torque,",
    "#[acts(on = second, value = cos(@) * throttle + # * rate(first))] e17: Force,",
    "#[acts(on = bead, value = cross(v(bead / ground / ground), 0.4 * turning.z) + throttle * x)] e18: \
     Force,",
    "#[acts(on = hook, value = [#, #, #] * first)] e19: Force,",
    "#[acts(on = pendant, along = turning.x + y)] e20: Force,",
];

/// Outputs of the mechanism: name, expression, and frame in whose axes the output is resolved.
pub const OUTPUTS: [(&str, &str, &str); 18] = [
    ("r1", "r(pendant / hook)", "carried"),
    ("v1", "v(pendant / hook / carried)", "carried"),
    ("a1", "a(pendant / hook / carried)", "carried"),
    ("r2", "r(hung.at([0.1, -0.2, 0.3]) / still)", "turning"),
    ("v2", "v(hung.at([0.1, -0.2, 0.3]) / still / turning)", "turning"),
    ("a2", "a(hung.at([0.1, -0.2, 0.3]) / still / turning)", "turning"),
    ("r3", "r(bead / placed)", "ground"),
    ("v3", "v(bead / placed / ground)", "ground"),
    ("a3", "a(bead / placed / ground)", "ground"),
    ("x4", "hung.x", "carried"),
    ("y4", "hung.y", "carried"),
    ("z4", "hung.z", "carried"),
    ("w4", "omega(hung / carried)", "carried"),
    ("d4", "alpha(hung / carried / carried)", "carried"),
    ("w5", "omega(turning / base)", "placed"),
    ("d5", "alpha(turning / base / placed)", "placed"),
    ("w6", "omega(placed / ground)", "ground"),
    ("d6", "alpha(placed / ground / ground)", "ground"),
];

impl RandomElementMechanism {
    /// Returns the generated source: the arguments of the attribute and the struct.
    pub fn element_mechanism_source(&self) -> (String, String) {
        let mut template = PLACES.to_string();
        for (action, _) in ACTIONS.iter().zip(&self.chosen).filter(|(_, chosen)| **chosen) {
            let _ = writeln!(template, "    {action}");
        }
        for (name, value, axes) in OUTPUTS {
            let _ = writeln!(template, "    #[output({value}, resolved_in = {axes})] {name}: Vector,");
        }
        let _ = writeln!(
            template,
            "    #[output(measure + dot(v(bead / still / ground), v(hook / still / ground)))] size: Scalar,"
        );
        let (joint, axes) = ROOTS[self.root].split_once(", ").unwrap_or((ROOTS[self.root], ""));
        let axes = if axes.is_empty() { String::new() } else { format!(", {axes}") };
        let template = template.replace('%', joint).replace('&', &axes);
        let template = template.replace('@', if self.time { "(0.7 * t)" } else { "0.35" });
        let mut fields = String::new();
        for (k, part) in template.split("#").enumerate() {
            // `#[` starts an attribute.
            match (k, part.starts_with('[')) {
                (0, _) => {}
                (_, true) => fields.push('#'),
                (_, false) => {
                    let _ = write!(fields, "({:?})", self.numbers[k % self.numbers.len()]);
                }
            }
            fields.push_str(part);
        }
        ("gravity = [0.5, -9.81, 0.3]".to_string(), format!("pub struct Random {{{fields}}}"))
    }
}
