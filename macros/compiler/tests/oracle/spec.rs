//! Random mechanisms as plain data, from which both the oracle's model and the source text are generated.

use crate::random::Random;

/// Joint type of random test mechanisms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestJointKind {
    Pin,
    Sleeve,
    Screw,
    Collar,
    Slot,
    Universal,
    Planar,
    Stage,
    Ball,
    Free,
    Weld,
}

/// All joint types of random test mechanisms.
pub const KINDS: [TestJointKind; 11] = [
    TestJointKind::Pin,
    TestJointKind::Sleeve,
    TestJointKind::Screw,
    TestJointKind::Collar,
    TestJointKind::Slot,
    TestJointKind::Universal,
    TestJointKind::Planar,
    TestJointKind::Stage,
    TestJointKind::Ball,
    TestJointKind::Free,
    TestJointKind::Weld,
];

impl TestJointKind {
    /// Returns the numbers of configuration coordinates and velocities.
    pub fn coordinate_and_velocity_counts(self) -> (usize, usize) {
        match self {
            TestJointKind::Pin | TestJointKind::Sleeve | TestJointKind::Screw => (1, 1),
            TestJointKind::Collar | TestJointKind::Slot | TestJointKind::Universal => (2, 2),
            TestJointKind::Planar | TestJointKind::Stage => (3, 3),
            TestJointKind::Ball => (4, 3),
            TestJointKind::Free => (7, 6),
            TestJointKind::Weld => (0, 0),
        }
    }

    /// Returns the coordinates that an element can act on, in the order of the velocities.
    pub fn suffixes_of_actuatable_coordinates(self) -> &'static [&'static str] {
        match self {
            TestJointKind::Pin | TestJointKind::Sleeve | TestJointKind::Screw => &[""],
            TestJointKind::Collar | TestJointKind::Slot => &[".slide", ".turn"],
            TestJointKind::Universal => &[".first", ".second"],
            TestJointKind::Planar => &[".x", ".y", ".angle"],
            TestJointKind::Stage => &[".x", ".y", ".z"],
            _ => &[],
        }
    }
}

/// Pose on a body: a position, followed by rotations about successive coordinate axes.
#[derive(Clone, Debug, Default)]
pub struct Placement {
    pub at: [f64; 3],
    pub turns: Vec<(usize, f64)>,
}

/// Particle that a coordinate moves along an axis of the ground, relative to a point of a body.
#[derive(Clone, Debug)]
pub struct SlidingParticle {
    pub mass: f64,
    pub offset: [f64; 3],
}

/// Body of a random test mechanism, with the joint to its parent.
#[derive(Clone, Debug)]
pub struct Body {
    pub kind: TestJointKind,
    /// Parent body, to which the joint connects this body; `None` for the ground.
    pub parent: Option<usize>,
    pub on_parent: Placement,
    pub on_child: Placement,
    /// Unit vectors of the first and the second axis of the joint.
    pub axes: [[f64; 3]; 2],
    pub pitch: f64,
    pub mass: f64,
    pub com: [f64; 3],
    /// Principal moments of inertia, about axes that are rotated by [`Body::inertia_turns`].
    pub moments: [f64; 3],
    pub inertia_turns: Vec<(usize, f64)>,
    /// Mass and position of a particle that is fixed on the body.
    pub particle: Option<(f64, [f64; 3])>,
    pub slider: Option<SlidingParticle>,
}

/// End of a force element: a point of a body or of the ground.
#[derive(Clone, Debug)]
pub struct AttachmentPoint {
    pub body: Option<usize>,
    pub at: [f64; 3],
}

/// Law of an element between two points, on a coordinate, or on the length of a path.
#[derive(Clone, Copy, Debug)]
pub enum ForceLaw {
    /// Spring, with its stiffness and free length.
    Spring(f64, f64),
    /// Dashpot, with its damping coefficient.
    Dashpot(f64),
    /// Inerter, with its inertance.
    Inerter(f64),
    /// Strength of an attraction with the inverse square of the distance; only between two points.
    Attraction(f64),
    /// Dry friction, which acts only on coordinates.
    Friction(FrictionParameters),
}

/// Parameters of a dry friction law with Stribeck effect.
#[derive(Clone, Copy, Debug)]
pub struct FrictionParameters {
    pub coulomb: f64,
    pub stiction: f64,
    pub stribeck_speed: f64,
    pub viscous: f64,
    /// Velocity scale of the regularisation of dry friction.
    pub speed: f64,
}

/// Path along which a force element acts, by the path's length.
#[derive(Clone, Debug)]
pub enum ForcePath {
    /// Rope of straight segments through three points.
    Rope([AttachmentPoint; 3]),
    /// Cable between two points that wraps around a ball, or around a cylinder whose axis is given in the
    /// frame of its body.
    Cable { ends: [AttachmentPoint; 2], around: AttachmentPoint, radius: f64, axis: Option<[f64; 3]> },
}

/// Force element of a random test mechanism.
#[derive(Clone, Debug)]
pub enum ForceElement {
    /// Force element along the straight line between two points.
    Between(ForceLaw, AttachmentPoint, AttachmentPoint),
    /// Force element along a rope or a cable.
    Along(ForceLaw, ForcePath),
    /// Element on a coordinate of a body's joint: law, body, coordinate.
    On(ForceLaw, usize, usize),
    /// Force in ground axes at a point of a body.
    Push(AttachmentPoint, [f64; 3]),
    /// Force in body axes at a point of a body.
    Follow(AttachmentPoint, [f64; 3]),
    /// Input torque on a body, in ground axes.
    Twist(usize, [f64; 3]),
}

/// Random test mechanism as plain data: gravity, bodies and force elements.
#[derive(Clone, Debug)]
pub struct MechanismSpec {
    pub gravity: [f64; 3],
    pub bodies: Vec<Body>,
    pub elements: Vec<ForceElement>,
    /// Whether the masses of the bodies are parameters instead of numbers.
    pub symbolic: bool,
}

/// Settings of the generator of random mechanisms.
#[derive(Clone, Copy, Debug)]
pub struct GeneratorSettings {
    /// Maximum number of bodies of a random mechanism.
    pub bodies: usize,
    /// Number of identical limbs; zero for a random tree.
    pub limbs: usize,
    /// Decades of the random masses: each mass is within this many powers of ten of one.
    pub decades: f64,
    /// Standard magnitude of deviations of angles and axes from coordinate axes.
    pub noise: Option<f64>,
}

/// Source of random numbers and choices for a random mechanism.
struct RandomSource(Random);

impl RandomSource {
    fn index_below(&mut self, n: usize) -> usize {
        self.0.index_below(n)
    }

    fn happens_one_time_in(&mut self, one_in: usize) -> bool {
        self.index_below(one_in) == 0
    }

    fn random_vector(&mut self, bound: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.0.uniform_number(bound))
    }

    /// Returns a coordinate axis or a random unit vector.
    fn random_axis(&mut self, style: &GeneratorSettings) -> [f64; 3] {
        let mut axis = [0.0; 3];
        if style.noise.is_some() || !self.happens_one_time_in(3) {
            axis[self.index_below(3)] = if self.happens_one_time_in(2) { 1.0 } else { -1.0 };
        } else {
            axis = self.random_vector(1.0);
            axis[self.index_below(3)] += 1.5;
        }
        if let Some(noise) = style.noise {
            axis = axis.map(|x| x + self.0.uniform_number(noise));
        }
        unit_vector_along(axis)
    }

    fn random_rotations(&mut self, style: &GeneratorSettings) -> Vec<(usize, f64)> {
        (0..self.index_below(3))
            .map(|_| {
                let angle = match style.noise {
                    Some(noise) => {
                        std::f64::consts::FRAC_PI_2 * self.index_below(4) as f64
                            + self.0.uniform_number(noise)
                    }
                    None => self.0.uniform_number(3.0),
                };
                (self.index_below(3), angle)
            })
            .collect()
    }

    fn random_joint_placement(&mut self, style: &GeneratorSettings) -> Placement {
        match self.index_below(4) {
            0 => Placement::default(),
            1 => Placement { at: self.random_vector(0.5), turns: Vec::new() },
            _ => Placement { at: self.random_vector(0.5), turns: self.random_rotations(style) },
        }
    }

    fn random_mass(&mut self, style: &GeneratorSettings) -> f64 {
        10.0_f64.powf(self.0.uniform_number(style.decades)) * (1.3 + self.0.uniform_number(0.8))
    }

    fn random_body(&mut self, kind: TestJointKind, parent: Option<usize>, style: &GeneratorSettings) -> Body {
        let mass = self.random_mass(style);
        // Moments of a cuboid are always physically possible.
        let sides = self.random_vector(0.4).map(|s| s * s + 0.05);
        let all: f64 = sides.iter().sum();
        Body {
            kind,
            parent,
            on_parent: self.random_joint_placement(style),
            on_child: if self.happens_one_time_in(2) {
                Placement::default()
            } else {
                self.random_joint_placement(style)
            },
            axes: [self.random_axis(style), self.random_axis(style)],
            pitch: 0.2 + self.0.uniform_number(0.1),
            mass,
            com: if self.happens_one_time_in(3) { [0.0; 3] } else { self.random_vector(0.4) },
            moments: sides.map(|s| mass * (all - s) / 3.0),
            inertia_turns: self.random_rotations(style),
            particle: self.happens_one_time_in(6).then(|| (self.random_mass(style), self.random_vector(0.5))),
            slider: self
                .happens_one_time_in(12)
                .then(|| SlidingParticle { mass: self.random_mass(style), offset: self.random_vector(0.5) }),
        }
    }

    fn random_attachment_point(&mut self, body: Option<usize>) -> AttachmentPoint {
        AttachmentPoint { body, at: self.random_vector(0.8) }
    }

    fn random_force_law(&mut self) -> ForceLaw {
        let size = 1.5 + self.0.uniform_number(1.0);
        match self.index_below(3) {
            0 => ForceLaw::Spring(4.0 * size, self.0.uniform_number(0.3).abs()),
            1 => ForceLaw::Dashpot(size),
            _ => ForceLaw::Inerter(0.5 * size),
        }
    }

    fn random_law_between_points(&mut self) -> ForceLaw {
        if self.happens_one_time_in(4) {
            ForceLaw::Attraction(self.0.uniform_number(2.0))
        } else {
            self.random_force_law()
        }
    }

    fn random_friction_law(&mut self) -> ForceLaw {
        let mut random_number_near_one = || 1.0 + self.0.uniform_number(0.7);
        let (coulomb, stribeck_speed) = (random_number_near_one(), 0.4 * random_number_near_one());
        ForceLaw::Friction(FrictionParameters {
            coulomb,
            stiction: coulomb * (1.0 + 0.5 * random_number_near_one()),
            stribeck_speed,
            viscous: 0.3 * random_number_near_one(),
            speed: 0.3 * random_number_near_one(),
        })
    }

    /// Returns a rope over a peg, or a cable around a round obstacle on any body.
    fn random_cable_path(&mut self, bodies: &[Body], one: usize) -> Option<ForcePath> {
        let other = self.random_body_or_ground(bodies);
        if self.happens_one_time_in(2) {
            return Some(ForcePath::Rope([
                self.random_attachment_point(None),
                self.random_attachment_point(Some(one)),
                self.random_attachment_point(other),
            ]));
        }
        // Bodies that are welded together have a constant distance.
        if other.and_then(|other| rigidly_connected_root(bodies, other))
            == rigidly_connected_root(bodies, one)
        {
            return None;
        }
        let around = self.random_body_or_ground(bodies);
        Some(ForcePath::Cable {
            ends: [self.random_attachment_point(other), self.random_attachment_point(Some(one))],
            around: self.random_attachment_point(around),
            radius: 0.2 + self.0.uniform_number(0.15),
            axis: self.happens_one_time_in(2).then(|| {
                let mut axis = self.random_vector(1.0);
                axis[self.index_below(3)] += 1.5;
                unit_vector_along(axis)
            }),
        })
    }

    /// Returns a random body, or `None` for the ground.
    fn random_body_or_ground(&mut self, bodies: &[Body]) -> Option<usize> {
        self.index_below(bodies.len() + 1).checked_sub(1)
    }

    fn random_element(&mut self, bodies: &[Body]) -> Option<ForceElement> {
        let one = self.index_below(bodies.len());
        // Forces cannot move a body that is welded to the ground.
        if is_welded_to_ground(bodies, one) {
            return None;
        }
        Some(match self.index_below(9) {
            0 => ForceElement::Push(self.random_attachment_point(Some(one)), self.random_vector(3.0)),
            1 => ForceElement::Follow(self.random_attachment_point(Some(one)), self.random_vector(3.0)),
            2 => {
                let coordinates = bodies[one].kind.suffixes_of_actuatable_coordinates();
                if coordinates.is_empty() {
                    return None;
                }
                let law = if self.happens_one_time_in(3) {
                    self.random_friction_law()
                } else {
                    self.random_force_law()
                };
                ForceElement::On(law, one, self.index_below(coordinates.len()))
            }
            3 => ForceElement::Between(
                self.random_law_between_points(),
                self.random_attachment_point(None),
                self.random_attachment_point(Some(one)),
            ),
            4 => ForceElement::Along(self.random_force_law(), self.random_cable_path(bodies, one)?),
            5 if can_rotate_relative_to_ground(bodies, one) => {
                ForceElement::Twist(one, self.random_vector(3.0))
            }
            _ => {
                let other = self.index_below(bodies.len());
                // Bodies that are welded together have a constant distance.
                if rigidly_connected_root(bodies, other) == rigidly_connected_root(bodies, one) {
                    return None;
                }
                ForceElement::Between(
                    self.random_law_between_points(),
                    self.random_attachment_point(Some(other)),
                    self.random_attachment_point(Some(one)),
                )
            }
        })
    }
}

/// Returns the body that a body is rigidly connected to by welds; `None` for the ground.
fn rigidly_connected_root(bodies: &[Body], body: usize) -> Option<usize> {
    match (bodies[body].kind, bodies[body].parent) {
        (TestJointKind::Weld, None) => None,
        (TestJointKind::Weld, Some(parent)) => rigidly_connected_root(bodies, parent),
        _ => Some(body),
    }
}

/// Returns whether a joint between the ground and the body rotates.
fn can_rotate_relative_to_ground(bodies: &[Body], body: usize) -> bool {
    let own =
        !matches!(bodies[body].kind, TestJointKind::Sleeve | TestJointKind::Stage | TestJointKind::Weld);
    own || bodies[body].parent.is_some_and(|parent| can_rotate_relative_to_ground(bodies, parent))
}

fn is_welded_to_ground(bodies: &[Body], body: usize) -> bool {
    rigidly_connected_root(bodies, body).is_none()
}

/// Returns the unit vector in a direction, computed like the language's `unit`.
fn unit_vector_along(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| x / length)
}

/// Joint types of limbs; common types occur more often.
const LIMB_KINDS: [TestJointKind; 12] = [
    TestJointKind::Pin,
    TestJointKind::Pin,
    TestJointKind::Pin,
    TestJointKind::Sleeve,
    TestJointKind::Screw,
    TestJointKind::Ball,
    TestJointKind::Universal,
    TestJointKind::Collar,
    TestJointKind::Slot,
    TestJointKind::Planar,
    TestJointKind::Stage,
    TestJointKind::Free,
];

/// Returns the random mechanism that a seed determines.
pub fn random_mechanism_spec(seed: u64, style: GeneratorSettings) -> MechanismSpec {
    let mut source = RandomSource(Random::new(seed));
    let mut bodies: Vec<Body> = Vec::new();
    let rigged = if style.limbs > 0 { add_identical_limbs(&mut source, &style, &mut bodies) } else { 0 };
    if style.limbs == 0 {
        let count = 1 + source.index_below(style.bodies);
        for k in 0..count {
            let parent = (k > 0 && !source.happens_one_time_in(8)).then(|| source.index_below(k));
            // Floating bases are most frequent in applications.
            let kind = match parent {
                None if source.happens_one_time_in(3) => TestJointKind::Free,
                _ => KINDS[source.index_below(KINDS.len())],
            };
            let body = source.random_body(kind, parent, &style);
            bodies.push(body);
        }
        if bodies.iter().all(|body| body.kind == TestJointKind::Weld) {
            bodies[0].kind = TestJointKind::Ball;
        }
    }
    let tries = source.index_below(4) + rigged;
    let elements = (0..tries).filter_map(|_| source.random_element(&bodies)).collect();
    MechanismSpec {
        gravity: source.random_vector(10.0),
        bodies,
        elements,
        symbolic: source.happens_one_time_in(2),
    }
}

/// Adds identical limbs to a trunk. Returns the number of further elements to generate.
fn add_identical_limbs(
    source: &mut RandomSource,
    style: &GeneratorSettings,
    bodies: &mut Vec<Body>,
) -> usize {
    let trunk = match source.index_below(4) {
        0 => None,
        1 => Some(TestJointKind::Free),
        2 => Some(TestJointKind::Pin),
        _ => Some(KINDS[source.index_below(KINDS.len())]),
    };
    if let Some(kind) = trunk {
        bodies.push(source.random_body(kind, None, style));
    }
    let root = bodies.len().checked_sub(1);
    let joints: Vec<TestJointKind> =
        (0..1 + source.index_below(2)).map(|_| LIMB_KINDS[source.index_below(LIMB_KINDS.len())]).collect();
    let plain: Vec<Body> = joints.iter().map(|kind| source.random_body(*kind, None, style)).collect();
    let same = source.happens_one_time_in(2);
    for _ in 0..style.limbs {
        for (k, pattern) in plain.iter().enumerate() {
            let parent = if k == 0 { root } else { Some(bodies.len() - 1) };
            let mut body = if same { pattern.clone() } else { source.random_body(pattern.kind, None, style) };
            body.slider = None;
            body.parent = parent;
            body.on_parent.at = source.random_vector(0.5);
            bodies.push(body);
        }
    }
    1 + source.index_below(3)
}
