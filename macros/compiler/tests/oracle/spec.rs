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
    pub fn sizes(self) -> (usize, usize) {
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
    pub fn coordinates(self) -> &'static [&'static str] {
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
    /// Principal moments, about axes that are rotated by [`Body::inertia_turns`].
    pub moments: [f64; 3],
    pub inertia_turns: Vec<(usize, f64)>,
    /// Mass and position of a particle on the body.
    pub particle: Option<(f64, [f64; 3])>,
    pub slider: Option<Slider>,
}

/// Point of a body or of the ground.
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

/// Path whose length a force element acts on.
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
    /// Torque on a body, in ground axes.
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
pub struct Style {
    /// Maximum number of bodies of a random mechanism.
    pub bodies: usize,
    /// Number of identical limbs; zero for a random tree.
    pub limbs: usize,
    /// Decades of the random masses: each mass is within this many powers of ten of one.
    pub decades: f64,
    /// Standard magnitude of deviations of angles and axes from coordinate axes.
    pub noise: Option<f64>,
}

/// Source of random numbers and choices for a mechanism.
struct Source(Random);

impl Source {
    fn index_below(&mut self, n: usize) -> usize {
        self.0.index_below(n)
    }

    fn chance(&mut self, one_in: usize) -> bool {
        self.index_below(one_in) == 0
    }

    fn vector(&mut self, bound: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.0.uniform(bound))
    }

    /// Returns a coordinate axis or a random axis.
    fn axis(&mut self, style: &Style) -> [f64; 3] {
        let mut axis = [0.0; 3];
        if style.noise.is_some() || !self.chance(3) {
            axis[self.index_below(3)] = if self.chance(2) { 1.0 } else { -1.0 };
        } else {
            axis = self.vector(1.0);
            axis[self.index_below(3)] += 1.5;
        }
        if let Some(noise) = style.noise {
            axis = axis.map(|x| x + self.0.uniform(noise));
        }
        unit(axis)
    }

    fn turns(&mut self, style: &Style) -> Vec<(usize, f64)> {
        (0..self.index_below(3))
            .map(|_| {
                let angle = match style.noise {
                    Some(noise) => {
                        std::f64::consts::FRAC_PI_2 * self.index_below(4) as f64 + self.0.uniform(noise)
                    }
                    None => self.0.uniform(3.0),
                };
                (self.index_below(3), angle)
            })
            .collect()
    }

    fn place(&mut self, style: &Style) -> Place {
        match self.index_below(4) {
            0 => Place::default(),
            1 => Place { at: self.vector(0.5), turns: Vec::new() },
            _ => Place { at: self.vector(0.5), turns: self.turns(style) },
        }
    }

    fn mass(&mut self, style: &Style) -> f64 {
        10.0_f64.powf(self.0.uniform(style.decades)) * (1.3 + self.0.uniform(0.8))
    }

    fn body(&mut self, kind: Kind, parent: Option<usize>, style: &Style) -> Body {
        let mass = self.mass(style);
        // Moments of a cuboid are always physically possible.
        let sides = self.vector(0.4).map(|s| s * s + 0.05);
        let all: f64 = sides.iter().sum();
        Body {
            kind,
            parent,
            on_parent: self.place(style),
            on_child: if self.chance(2) { Place::default() } else { self.place(style) },
            axes: [self.axis(style), self.axis(style)],
            pitch: 0.2 + self.0.uniform(0.1),
            mass,
            com: if self.chance(3) { [0.0; 3] } else { self.vector(0.4) },
            moments: sides.map(|s| mass * (all - s) / 3.0),
            inertia_turns: self.turns(style),
            particle: self.chance(6).then(|| (self.mass(style), self.vector(0.5))),
            slider: self.chance(12).then(|| Slider { mass: self.mass(style), offset: self.vector(0.5) }),
        }
    }

    fn end(&mut self, body: Option<usize>) -> End {
        End { body, at: self.vector(0.8) }
    }

    fn law(&mut self) -> Law {
        let size = 1.5 + self.0.uniform(1.0);
        match self.index_below(3) {
            0 => Law::Spring(4.0 * size, self.0.uniform(0.3).abs()),
            1 => Law::Dashpot(size),
            _ => Law::Inerter(0.5 * size),
        }
    }

    fn law_between(&mut self) -> Law {
        if self.chance(4) { Law::Attraction(self.0.uniform(2.0)) } else { self.law() }
    }

    fn friction(&mut self) -> Law {
        let mut size = || 1.0 + self.0.uniform(0.7);
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
    fn path(&mut self, bodies: &[Body], one: usize) -> Option<Path> {
        let other = self.any(bodies);
        if self.chance(2) {
            return Some(Path::Rope([self.end(None), self.end(Some(one)), self.end(other)]));
        }
        // Bodies that are welded together have a constant distance.
        if other.and_then(|other| rigid(bodies, other)) == rigid(bodies, one) {
            return None;
        }
        let around = self.any(bodies);
        Some(Path::Cable {
            ends: [self.end(other), self.end(Some(one))],
            around: self.end(around),
            radius: 0.2 + self.0.uniform(0.15),
            axis: self.chance(2).then(|| {
                let mut axis = self.vector(1.0);
                axis[self.index_below(3)] += 1.5;
                unit(axis)
            }),
        })
    }

    /// Returns a random body, or `None` for the ground.
    fn any(&mut self, bodies: &[Body]) -> Option<usize> {
        self.index_below(bodies.len() + 1).checked_sub(1)
    }

    fn element(&mut self, bodies: &[Body]) -> Option<Element> {
        let one = self.index_below(bodies.len());
        // Forces cannot move a body that is welded to the ground.
        if is_fixed(bodies, one) {
            return None;
        }
        Some(match self.index_below(9) {
            0 => Element::Push(self.end(Some(one)), self.vector(3.0)),
            1 => Element::Follow(self.end(Some(one)), self.vector(3.0)),
            2 => {
                let coordinates = bodies[one].kind.coordinates();
                if coordinates.is_empty() {
                    return None;
                }
                let law = if self.chance(3) { self.friction() } else { self.law() };
                Element::On(law, one, self.index_below(coordinates.len()))
            }
            3 => Element::Between(self.law_between(), self.end(None), self.end(Some(one))),
            4 => Element::Along(self.law(), self.path(bodies, one)?),
            5 if turns(bodies, one) => Element::Twist(one, self.vector(3.0)),
            _ => {
                let other = self.index_below(bodies.len());
                // Bodies that are welded together have a constant distance.
                if rigid(bodies, other) == rigid(bodies, one) {
                    return None;
                }
                Element::Between(self.law_between(), self.end(Some(other)), self.end(Some(one)))
            }
        })
    }
}

/// Returns the body that a body is rigidly connected to by welds; `None` for the ground.
fn rigid(bodies: &[Body], body: usize) -> Option<usize> {
    match (bodies[body].kind, bodies[body].parent) {
        (Kind::Weld, None) => None,
        (Kind::Weld, Some(parent)) => rigid(bodies, parent),
        _ => Some(body),
    }
}

/// Returns whether a joint between the ground and the body rotates.
fn turns(bodies: &[Body], body: usize) -> bool {
    let own = !matches!(bodies[body].kind, Kind::Sleeve | Kind::Stage | Kind::Weld);
    own || bodies[body].parent.is_some_and(|parent| turns(bodies, parent))
}

fn is_fixed(bodies: &[Body], body: usize) -> bool {
    rigid(bodies, body).is_none()
}

/// Returns the unit vector in a direction, computed like the language's `unit`.
fn unit(v: [f64; 3]) -> [f64; 3] {
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

/// Returns the random mechanism of a seed.
pub fn spec(seed: u64, style: Style) -> Spec {
    let mut source = Source(Random::new(seed));
    let mut bodies: Vec<Body> = Vec::new();
    let rigged = if style.limbs > 0 { limbs(&mut source, &style, &mut bodies) } else { 0 };
    if style.limbs == 0 {
        let count = 1 + source.index_below(style.bodies);
        for k in 0..count {
            let parent = (k > 0 && !source.chance(8)).then(|| source.index_below(k));
            // Floating bases are most frequent in applications.
            let kind = match parent {
                None if source.chance(3) => Kind::Free,
                _ => KINDS[source.index_below(KINDS.len())],
            };
            let body = source.body(kind, parent, &style);
            bodies.push(body);
        }
        if bodies.iter().all(|body| body.kind == Kind::Weld) {
            bodies[0].kind = Kind::Ball;
        }
    }
    let tries = source.index_below(4) + rigged;
    let elements = (0..tries).filter_map(|_| source.element(&bodies)).collect();
    Spec { gravity: source.vector(10.0), bodies, elements, symbolic: source.chance(2) }
}

/// Adds identical limbs to a trunk. Returns the number of further elements to generate.
fn limbs(source: &mut Source, style: &Style, bodies: &mut Vec<Body>) -> usize {
    let trunk = match source.index_below(4) {
        0 => None,
        1 => Some(Kind::Free),
        2 => Some(Kind::Pin),
        _ => Some(KINDS[source.index_below(KINDS.len())]),
    };
    if let Some(kind) = trunk {
        bodies.push(source.body(kind, None, style));
    }
    let root = bodies.len().checked_sub(1);
    let joints: Vec<Kind> =
        (0..1 + source.index_below(2)).map(|_| LIMB_KINDS[source.index_below(LIMB_KINDS.len())]).collect();
    let plain: Vec<Body> = joints.iter().map(|kind| source.body(*kind, None, style)).collect();
    let same = source.chance(2);
    for _ in 0..style.limbs {
        for (k, pattern) in plain.iter().enumerate() {
            let parent = if k == 0 { root } else { Some(bodies.len() - 1) };
            let mut body = if same { pattern.clone() } else { source.body(pattern.kind, None, style) };
            body.slider = None;
            body.parent = parent;
            body.on_parent.at = source.vector(0.5);
            bodies.push(body);
        }
    }
    1 + source.index_below(3)
}
