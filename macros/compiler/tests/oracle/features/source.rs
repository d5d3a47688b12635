//! A random mechanism in the words of the language: joints of all types, force elements, values and outputs that are expressions of
//! anything, contacts, limits, constraints, and words that ask for functions.

use crate::random::Random;
use std::fmt::Write;

/// A joint by its type's name, its arguments, the names of its coordinates.
type Joint = (&'static str, &'static str, &'static [&'static str]);

const JOINTS: [Joint; 12] = [
    ("Pin", "about", &[""]),
    ("Sleeve", "along", &[""]),
    ("Screw", "pitch = 0.1, about", &[""]),
    ("Collar", "about", &[".slide", ".turn"]),
    ("Slot", "along = x, about = z", &[".slide", ".turn"]),
    ("Universal", "about = (x, y)", &[".first", ".second"]),
    ("Ball", "", &[]),
    ("Planar", "about = z", &[".x", ".y", ".angle"]),
    ("Stage", "along = (x, y, z)", &[".x", ".y", ".z"]),
    ("Stage", "along = (x, y)", &[".x", ".y"]),
    ("Free", "", &[]),
    ("Weld", "", &[]),
];

/// Joints of particles.
const OF_PARTICLES: [usize; 4] = [1, 7, 8, 9];

const VECTORS: [&str; 6] = ["x", "y", "-z", "0.3 * x", "[0.7, -1.2, 0.4]", "[0, 0, 0]"];
const UNITS: [&str; 5] = ["x", "y", "z", "-x", "unit([1, 2, 3])"];
const SOLIDS: [&str; 5] = [
    "sphere(M, 0.1)",
    "rod(M, 1, x)",
    "disk(M, 0.2, z)",
    "cuboid(M, 0.1, 0.2, 0.3)",
    "cylinder(M, 0.1, 0.3, y)",
];
const VALUES: [&str; 6] = ["S", "S * S", "S + 0.5 * S", "cos(S) * S", "min(S, S)", "max(S, 0.2 * S)"];
const LAWS: [(&str, &str); 4] = [
    ("stiffness = 2, free_length = 0.3", "Spring"),
    ("damping = 2", "Dashpot"),
    ("inertance = 0.3", "Inerter"),
    ("strength = 0.3", "Attraction"),
];
const WORDS: [&str; 17] = [
    "derivatives",
    "second_derivatives",
    "momentum_derivatives",
    "centroidal",
    "hamilton",
    "conserved",
    "regressor",
    "sensitivities",
    "packed",
    "prepare",
    "batch",
    "drawing",
    "equations = lagrange",
    "equations = kane",
    "equations = hamilton",
    "equations = structure",
    "target_only",
];

/// The fields so far, and what further ones may name.
struct Source {
    random: Random,
    fields: String,
    bodies: Vec<String>,
    particles: Vec<String>,
    coordinates: Vec<String>,
    has_parameters: bool,
}

/// The attribute's arguments and the struct of a seed.
pub fn source(seed: u64) -> (String, String) {
    let mut source = Source {
        random: Random::new(seed),
        fields: "look: Table<1>, command: Input, #[output(look(2) + command)] seen: Scalar,\n".to_string(),
        bodies: Vec::new(),
        particles: Vec::new(),
        coordinates: Vec::new(),
        has_parameters: false,
    };
    for k in 0..1 + source.random.below(4) {
        source.add_body(k);
    }
    for k in 0..source.random.below(6) {
        source.add_element(k);
    }
    let mut arguments = "gravity = -9.81 * y".to_string();
    for word in WORDS {
        let needs_parameters = ["sensitivities", "prepare"].contains(&word);
        if source.chance(6)
            && (source.has_parameters || !needs_parameters)
            && !arguments.contains("equations")
        {
            let _ = write!(arguments, ", {word}");
        }
    }
    (arguments, format!("pub struct Any {{\n{}}}", source.fields))
}

impl Source {
    fn chance(&mut self, one_in: usize) -> bool {
        self.random.below(one_in) == 0
    }

    fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.random.below(list.len())]
    }

    fn number(&mut self) -> String {
        format!("{:.3}", 1.1 + self.random.uniform(1.0))
    }

    fn add_body(&mut self, k: usize) {
        let mut mass = self.number();
        if self.chance(3) {
            let _ = writeln!(self.fields, "mass{k}: f64,");
            mass = format!("mass{k}");
            self.has_parameters = true;
        }
        let parent = match self.bodies.len() {
            0 => "ground".to_string(),
            _ if self.chance(3) => "ground".to_string(),
            n => self.bodies[self.random.below(n)].clone(),
        };
        let is_particle = self.chance(5);
        if is_particle {
            let _ = writeln!(self.fields, "#[particle(mass = {mass})] body{k}: Particle,");
        } else {
            let com = self.one_of(&VECTORS);
            let solid = self.one_of(&SOLIDS).replace('M', &mass);
            let _ = writeln!(
                self.fields,
                "#[body(mass = {mass}, com = {com}, inertia = {solid})] body{k}: Body,"
            );
        }
        let (kind, arguments, coordinates) =
            if is_particle { JOINTS[self.one_of(&OF_PARTICLES)] } else { self.one_of(&JOINTS) };
        let mut end = parent;
        if self.chance(2) {
            let _ = write!(end, ".at({})", self.one_of(&VECTORS));
        }
        if self.chance(4) {
            let (axis, angle) = (self.one_of(&["x", "y", "z"]), self.number());
            let _ = write!(end, ".rotated({axis}({angle}))");
        }
        let mut arguments = arguments.to_string();
        if arguments.ends_with("about") || arguments.ends_with("along") {
            let _ = write!(arguments, " = {}", self.one_of(&UNITS));
        }
        let comma = if arguments.is_empty() { "" } else { ", " };
        let _ = writeln!(self.fields, "#[joint({end} -> body{k}{comma}{arguments})] joint{k}: {kind},");
        self.coordinates.extend(coordinates.iter().map(|name| format!("joint{k}{name}")));
        let list = if is_particle { &mut self.particles } else { &mut self.bodies };
        list.push(format!("body{k}"));
    }

    fn point(&mut self) -> String {
        let particles = self.particles.len();
        let n = self.random.below(particles + self.bodies.len() + 1);
        if n < particles {
            return self.particles[n].clone();
        }
        let body = self.bodies.get(n - particles).cloned().unwrap_or("ground".to_string());
        format!("{body}.at({})", self.one_of(&VECTORS))
    }

    /// A scalar of the state, of time, of an input, or a number.
    fn scalar(&mut self) -> String {
        let coordinate = (!self.coordinates.is_empty()).then(|| {
            let n = self.random.below(self.coordinates.len());
            self.coordinates[n].clone()
        });
        match (self.random.below(9), coordinate) {
            (0, _) => "t".to_string(),
            (1, _) => self.number(),
            (2, _) => format!("look({})", self.number()),
            (3, _) => format!("norm(r({} / {}))", self.point(), self.point()),
            (4, _) => "command".to_string(),
            (5, Some(coordinate)) => format!("rate({coordinate})"),
            (6, Some(coordinate)) => format!("look({coordinate})"),
            (_, Some(coordinate)) => coordinate,
            (_, None) => format!("dot(r({} / ground), y)", self.point()),
        }
    }

    fn value(&mut self) -> String {
        let mut value = self.one_of(&VALUES).to_string();
        while value.contains('S') {
            value = value.replacen('S', &self.scalar(), 1);
        }
        value
    }

    fn add_element(&mut self, k: usize) {
        let any = |source: &mut Source, list: fn(&Source) -> &Vec<String>| {
            let n = list(source).len();
            (n > 0).then(|| source.random.below(n)).map(|n| list(source)[n].clone())
        };
        let coordinate = any(self, |source| &source.coordinates);
        let body = any(self, |source| &source.bodies);
        let (kind, law) = (self.random.below(13), self.one_of(&LAWS));
        let field = match (kind, coordinate, body) {
            (0, Some(on), _) => format!("#[acts(on = {on}, stiffness = 2)] element{k}: Spring"),
            (1, Some(on), _) => {
                format!("#[acts(on = {on}, coulomb = 0.3, viscous = 0.1)] element{k}: Friction")
            }
            (2, ..) => {
                format!(
                    "#[acts(between = ({}, {}), {})] element{k}: {}",
                    self.point(),
                    self.point(),
                    law.0,
                    law.1
                )
            }
            (3, Some(on), _) => {
                format!("#[acts(on = {on})] element{k}: {}", self.one_of(&["Force", "Torque"]))
            }
            (4, ..) => {
                format!("#[acts(on = {}, along = {})] element{k}: Force", self.point(), self.one_of(&UNITS))
            }
            (5, ..) => format!(
                "#[acts(on = {}, value = ({}) * ground.x)] element{k}: Force",
                self.point(),
                self.value()
            ),
            (6, ..) => format!("#[output(v({} / ground / ground))] output{k}: Vector", self.point()),
            (7, ..) => format!("#[output(a({} / ground / ground))] output{k}: Vector", self.point()),
            (8, _, Some(body)) => format!("#[output({body}, resolved_in = ground)] output{k}: FreeBody"),
            (9, _, Some(body)) => {
                format!(
                    "#[contact({body}.sphere(0.1), ground.plane(z), friction = 0.3, rolling = 0.01)] contact{k}: Contact"
                )
            }
            (10, Some(on), _) => format!("#[limit(on = {on}, from = -1, to = 1)] limit{k}: Limit"),
            (11, ..) => format!("#[constraint({})] constraint{k}: Holonomic", self.value()),
            _ => format!("#[output({})] output{k}: Scalar", self.value()),
        };
        let _ = writeln!(self.fields, "{field},");
    }
}
