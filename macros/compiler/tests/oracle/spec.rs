//! Random mechanisms as plain data, from which both the oracle's model and the source text are generated.

use crate::random::Random;

/// Joint type of random test mechanisms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
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
pub const KINDS: [Kind; 11] = [
    Kind::Pin,
    Kind::Sleeve,
    Kind::Screw,
    Kind::Collar,
    Kind::Slot,
    Kind::Universal,
    Kind::Planar,
    Kind::Stage,
    Kind::Ball,
    Kind::Free,
    Kind::Weld,
];

impl Kind {
    /// Returns the numbers of configuration coordinates and velocities.
    pub fn coordinate_and_velocity_counts(self) -> (usize, usize) {
        match self {
            Kind::Pin | Kind::Sleeve | Kind::Screw => (1, 1),
            Kind::Collar | Kind::Slot | Kind::Universal => (2, 2),
            Kind::Planar | Kind::Stage => (3, 3),
            Kind::Ball => (4, 3),
            Kind::Free => (7, 6),
            Kind::Weld => (0, 0),
        }
    }

    /// Returns the coordinates that an element can act on, in the order of the velocities.
    pub fn coordinate_names(self) -> &'static [&'static str] {
        match self {
            Kind::Pin | Kind::Sleeve | Kind::Screw => &[""],
            Kind::Collar | Kind::Slot => &[".slide", ".turn"],
            Kind::Universal => &[".first", ".second"],
            Kind::Planar => &[".x", ".y", ".angle"],
            Kind::Stage => &[".x", ".y", ".z"],
            _ => &[],
        }
    }
}

/// Pose on a body: a position, followed by rotations about successive coordinate axes.
#[derive(Clone, Debug, Default)]
pub struct Place {
    pub at: [f64; 3],
    pub turns: Vec<(usize, f64)>,
}

/// Particle that a coordinate moves along an axis of the ground, relative to a point of a body.
#[derive(Clone, Debug)]
pub struct Slider {
    pub mass: f64,
    pub offset: [f64; 3],
}

/// Body of a random test mechanism, with the joint to its parent.
#[derive(Clone, Debug)]
pub struct Body {
    pub kind: Kind,
    /// Parent body, to which the joint connects this body; `None` for the ground.
    pub parent: Option<usize>,
    pub on_parent: Place,
    pub on_child: Place,
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
    pub slider: Option<Slider>,
}

/// End of a force element: a point of a body or of the ground.
#[derive(Clone, Debug)]
pub struct End {
    pub body: Option<usize>,
    pub at: [f64; 3],
}

/// Law of an element between two points, on a coordinate, or on the length of a path.
#[derive(Clone, Copy, Debug)]
pub enum Law {
    /// Spring, with its stiffness and free length.
    Spring(f64, f64),
    /// Dashpot, with its damping coefficient.
    Dashpot(f64),
    /// Inerter, with its inertance.
    Inerter(f64),
    /// Strength of an attraction with the inverse square of the distance; only between two points.
    Attraction(f64),
    /// Dry friction, which acts only on coordinates.
    Friction(Friction),
}

/// Parameters of a dry friction law with Stribeck effect.
#[derive(Clone, Copy, Debug)]
pub struct Friction {
    pub coulomb: f64,
    pub stiction: f64,
    pub stribeck_speed: f64,
    pub viscous: f64,
    /// Velocity scale of the regularisation of dry friction.
    pub speed: f64,
}

/// Path along which a force element acts, by the path's length.
#[derive(Clone, Debug)]
pub enum Path {
    /// Rope of straight segments through three points.
    Rope([End; 3]),
    /// Cable between two points that wraps around a ball, or around a cylinder whose axis is given in the
    /// frame of its body.
    Cable { ends: [End; 2], around: End, radius: f64, axis: Option<[f64; 3]> },
}

/// Force element of a random test mechanism.
#[derive(Clone, Debug)]
pub enum Element {
    /// Force element along the straight line between two points.
    Between(Law, End, End),
    /// Force element along a rope or a cable.
    Along(Law, Path),
    /// Element on a coordinate of a body's joint: law, body, coordinate.
    On(Law, usize, usize),
    /// Force in ground axes at a point of a body.
    Push(End, [f64; 3]),
    /// Force in body axes at a point of a body.
    Follow(End, [f64; 3]),
    /// Input torque on a body, in ground axes.
    Twist(usize, [f64; 3]),
}

/// Random test mechanism as plain data: gravity, bodies and force elements.
#[derive(Clone, Debug)]
pub struct Spec {
    pub gravity: [f64; 3],
    pub bodies: Vec<Body>,
    pub elements: Vec<Element>,
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
struct Source(Random);

impl Source {
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
        unit_vector(axis)
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

    fn random_joint_placement(&mut self, style: &GeneratorSettings) -> Place {
        match self.index_below(4) {
            0 => Place::default(),
            1 => Place { at: self.random_vector(0.5), turns: Vec::new() },
            _ => Place { at: self.random_vector(0.5), turns: self.random_rotations(style) },
        }
    }

    fn random_mass(&mut self, style: &GeneratorSettings) -> f64 {
        10.0_f64.powf(self.0.uniform_number(style.decades)) * (1.3 + self.0.uniform_number(0.8))
    }

    fn random_body(&mut self, kind: Kind, parent: Option<usize>, style: &GeneratorSettings) -> Body {
        let mass = self.random_mass(style);
        // Moments of a cuboid are always physically possible.
        let sides = self.random_vector(0.4).map(|s| s * s + 0.05);
        let all: f64 = sides.iter().sum();
        Body {
            kind,
            parent,
            on_parent: self.random_joint_placement(style),
            on_child: if self.happens_one_time_in(2) {
                Place::default()
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
                .then(|| Slider { mass: self.random_mass(style), offset: self.random_vector(0.5) }),
        }
    }

    fn random_attachment_point(&mut self, body: Option<usize>) -> End {
        End { body, at: self.random_vector(0.8) }
    }

    fn random_force_law(&mut self) -> Law {
        let size = 1.5 + self.0.uniform_number(1.0);
        match self.index_below(3) {
            0 => Law::Spring(4.0 * size, self.0.uniform_number(0.3).abs()),
            1 => Law::Dashpot(size),
            _ => Law::Inerter(0.5 * size),
        }
    }

    fn random_law_between_points(&mut self) -> Law {
        if self.happens_one_time_in(4) {
            Law::Attraction(self.0.uniform_number(2.0))
        } else {
            self.random_force_law()
        }
    }

    fn random_friction_law(&mut self) -> Law {
        let mut size = || 1.0 + self.0.uniform_number(0.7);
        let (coulomb, stribeck_speed) = (size(), 0.4 * size());
        Law::Friction(Friction {
            coulomb,
            stiction: coulomb * (1.0 + 0.5 * size()),
            stribeck_speed,
            viscous: 0.3 * size(),
            speed: 0.3 * size(),
        })
    }

    /// Returns a rope over a peg, or a cable around a round obstacle on any body.
    fn random_cable_path(&mut self, bodies: &[Body], one: usize) -> Option<Path> {
        let other = self.random_body_or_ground(bodies);
        if self.happens_one_time_in(2) {
            return Some(Path::Rope([
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
        Some(Path::Cable {
            ends: [self.random_attachment_point(other), self.random_attachment_point(Some(one))],
            around: self.random_attachment_point(around),
            radius: 0.2 + self.0.uniform_number(0.15),
            axis: self.happens_one_time_in(2).then(|| {
                let mut axis = self.random_vector(1.0);
                axis[self.index_below(3)] += 1.5;
                unit_vector(axis)
            }),
        })
    }

    /// Returns a random body, or `None` for the ground.
    fn random_body_or_ground(&mut self, bodies: &[Body]) -> Option<usize> {
        self.index_below(bodies.len() + 1).checked_sub(1)
    }

    fn random_element(&mut self, bodies: &[Body]) -> Option<Element> {
        let one = self.index_below(bodies.len());
        // Forces cannot move a body that is welded to the ground.
        if is_welded_to_ground(bodies, one) {
            return None;
        }
        Some(match self.index_below(9) {
            0 => Element::Push(self.random_attachment_point(Some(one)), self.random_vector(3.0)),
            1 => Element::Follow(self.random_attachment_point(Some(one)), self.random_vector(3.0)),
            2 => {
                let coordinates = bodies[one].kind.coordinate_names();
                if coordinates.is_empty() {
                    return None;
                }
                let law = if self.happens_one_time_in(3) {
                    self.random_friction_law()
                } else {
                    self.random_force_law()
                };
                Element::On(law, one, self.index_below(coordinates.len()))
            }
            3 => Element::Between(
                self.random_law_between_points(),
                self.random_attachment_point(None),
                self.random_attachment_point(Some(one)),
            ),
            4 => Element::Along(self.random_force_law(), self.random_cable_path(bodies, one)?),
            5 if has_rotating_joint(bodies, one) => Element::Twist(one, self.random_vector(3.0)),
            _ => {
                let other = self.index_below(bodies.len());
                // Bodies that are welded together have a constant distance.
                if rigidly_connected_root(bodies, other) == rigidly_connected_root(bodies, one) {
                    return None;
                }
                Element::Between(
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
        (Kind::Weld, None) => None,
        (Kind::Weld, Some(parent)) => rigidly_connected_root(bodies, parent),
        _ => Some(body),
    }
}

/// Returns whether a joint between the ground and the body rotates.
fn has_rotating_joint(bodies: &[Body], body: usize) -> bool {
    let own = !matches!(bodies[body].kind, Kind::Sleeve | Kind::Stage | Kind::Weld);
    own || bodies[body].parent.is_some_and(|parent| has_rotating_joint(bodies, parent))
}

fn is_welded_to_ground(bodies: &[Body], body: usize) -> bool {
    rigidly_connected_root(bodies, body).is_none()
}

/// Returns the unit vector in a direction, computed like the language's `unit`.
fn unit_vector(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| x / length)
}

/// Joint types of limbs; common types occur more often.
const LIMB_KINDS: [Kind; 12] = [
    Kind::Pin,
    Kind::Pin,
    Kind::Pin,
    Kind::Sleeve,
    Kind::Screw,
    Kind::Ball,
    Kind::Universal,
    Kind::Collar,
    Kind::Slot,
    Kind::Planar,
    Kind::Stage,
    Kind::Free,
];

/// Returns the random mechanism that a seed determines.
pub fn random_mechanism_spec(seed: u64, style: GeneratorSettings) -> Spec {
    let mut source = Source(Random::new(seed));
    let mut bodies: Vec<Body> = Vec::new();
    let rigged = if style.limbs > 0 { add_identical_limbs(&mut source, &style, &mut bodies) } else { 0 };
    if style.limbs == 0 {
        let count = 1 + source.index_below(style.bodies);
        for k in 0..count {
            let parent = (k > 0 && !source.happens_one_time_in(8)).then(|| source.index_below(k));
            // Floating bases are most frequent in applications.
            let kind = match parent {
                None if source.happens_one_time_in(3) => Kind::Free,
                _ => KINDS[source.index_below(KINDS.len())],
            };
            let body = source.random_body(kind, parent, &style);
            bodies.push(body);
        }
        if bodies.iter().all(|body| body.kind == Kind::Weld) {
            bodies[0].kind = Kind::Ball;
        }
    }
    let tries = source.index_below(4) + rigged;
    let elements = (0..tries).filter_map(|_| source.random_element(&bodies)).collect();
    Spec { gravity: source.random_vector(10.0), bodies, elements, symbolic: source.happens_one_time_in(2) }
}

/// Adds identical limbs to a trunk. Returns the number of further elements to generate.
fn add_identical_limbs(source: &mut Source, style: &GeneratorSettings, bodies: &mut Vec<Body>) -> usize {
    let trunk = match source.index_below(4) {
        0 => None,
        1 => Some(Kind::Free),
        2 => Some(Kind::Pin),
        _ => Some(KINDS[source.index_below(KINDS.len())]),
    };
    if let Some(kind) = trunk {
        bodies.push(source.random_body(kind, None, style));
    }
    let root = bodies.len().checked_sub(1);
    let joints: Vec<Kind> =
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
