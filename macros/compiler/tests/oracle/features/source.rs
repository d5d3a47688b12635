//! Random mechanisms as source text: joints of all types, loops, force elements, random expressions as values
//! and outputs, states, generalized speeds, contacts, limits, constraints, and options that request
//! functions.

use crate::random::Random;
use std::fmt::Write;

/// Joint type for random mechanisms: name of the type, arguments, and names of its coordinates.
type JointType = (&'static str, &'static str, &'static [&'static str]);

const JOINTS: [JointType; 12] = [
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

/// Joints that are allowed for particles, as indices of [`JOINTS`].
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
/// Templates of scalar values. `S` is a scalar, `V` a vector, `B` the same scalar throughout.
const VALUES: [&str; 10] = [
    "S",
    "S * S",
    "S + 0.5 * S",
    "cos(S) * S",
    "min(S, S)",
    "max(S, 0.2 * S)",
    "if S > 0.3 { S } else { S }",
    "if B > 0.3 { 2 * (B - 0.3) } else { 0 }",
    "S / (1.5 + S * S)",
    "0.3 * dot(V, V)",
];
/// Templates of vectors. `P` is a point, `A` a frame with axes, `H` a body, `S` a scalar.
const VECTOR_VALUES: [&str; 8] = [
    "S * ground.y",
    "r(P / P)",
    "0.7 * A.x",
    "v(P / P / ground)",
    "omega(A / ground)",
    "cross(r(P / P), A.y)",
    "project(r(P / ground), A.z)",
    "S * A.y + 0.2 * ground.x",
];
/// Contact pair in [`SURFACES`] whose surface has rims: a cylinder on the ground.
pub const RIMS: &str = "cylinder(0.2, 0.5, x), ground";
/// Templates of contact pairs between a body `H` and the ground.
const SURFACES: [&str; 7] = [
    "H.sphere(0.1), ground.plane(y)",
    "H.sphere(0.1), ground.plane(y), rolling = 0.01, torsional = 0.02",
    "H.at([0.3, 0.1, -0.2]), ground.plane(y)",
    "H.cuboid(0.2, 0.3, 0.4), ground.plane(y)",
    "H.capsule(0.1, 0.4, z), ground.plane(x)",
    "H.at([0, 1, 0]).sphere(0.1), ground.at([0, 3, 0]).sphere(0.7)",
    "H.cylinder(0.2, 0.5, x), ground.plane(y)",
];
/// Templates of scalar expressions that are valid only as outputs.
const SCALAR_OUTPUTS: [&str; 8] = [
    "kinetic_energy(H)",
    "moment_of_inertia(H / P, ground.z)",
    "rate(dot(V, ground.x))",
    "norm(v(P / ground / A) + 0.1 * ground.x)",
    "trace(inertia(H / P) * outer(V, V))",
    "dot(a(P / P / A), V)",
    "angle(r(P / ground) + 3 * ground.x, A.x + 2 * ground.y)",
    "rate(S * S)",
];
const VECTOR_OUTPUTS: [&str; 10] = [
    "momentum(H)",
    "angular_momentum(H / P)",
    "center_of_mass(H / P)",
    "rate(momentum(H) / ground)",
    "alpha(A / ground / ground)",
    "rotation(A / ground) * V",
    "inertia(H / P) * omega(A / ground)",
    "rate(V / ground)",
    "a(P / ground / A)",
    "v(P / P / A)",
];
const MATRIX_OUTPUTS: [&str; 4] = [
    "rotation(A / ground)",
    "inertia(H / P)",
    "outer(V, V) + skew(V)",
    "rate(rotation(A / ground) / ground)",
];
const LAWS: [(&str, &str); 4] = [
    ("stiffness = 2, free_length = 0.3", "Spring"),
    ("damping = 2", "Dashpot"),
    ("inertance = 0.3", "Inerter"),
    ("strength = 0.3", "Attraction"),
];
const WORDS: [&str; 17] = [
    "formulation = speeds",
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
];

/// Fields generated so far, and names that further fields may use.
struct SourceGenerator {
    random: Random,
    fields: String,
    bodies: Vec<String>,
    particles: Vec<String>,
    coordinates: Vec<String>,
    /// Names of declared frames that are not bodies.
    frames: Vec<String>,
    /// Names of declared points; the next field has the names of states.
    points: Vec<String>,
    states: Vec<String>,
    /// Whether the mechanism has constraints, which exclude some options.
    has_constraints: bool,
    has_parameters: bool,
}

/// Returns the attribute's arguments and the struct for a seed.
pub fn random_source(seed: u64) -> (String, String) {
    let mut source = SourceGenerator {
        random: Random::new(seed),
        fields: "look: Table<1>, command: Input, #[output(look(2) + command)] seen: Scalar,\n".to_string(),
        bodies: Vec::new(),
        particles: Vec::new(),
        coordinates: Vec::new(),
        frames: Vec::new(),
        points: Vec::new(),
        states: Vec::new(),
        has_constraints: false,
        has_parameters: false,
    };
    for k in 0..1 + source.random.index_below(4) {
        source.add_body(k);
    }
    for k in 0..source.random.index_below(7) {
        source.add_random_element(k);
    }
    let mut arguments = "gravity = -9.81 * y".to_string();
    for word in WORDS {
        let needs_parameters = ["sensitivities", "prepare"].contains(&word);
        let needs_constraints = word == "formulation = speeds";
        if source.happens_one_time_in(if word == "derivatives" { 2 } else { 6 })
            && (source.has_parameters || !needs_parameters)
            && (source.has_constraints || !needs_constraints)
            && !arguments.contains("equations")
        {
            let _ = write!(arguments, ", {word}");
        }
    }
    (arguments, format!("pub struct Any {{\n{}}}", source.fields))
}

impl SourceGenerator {
    fn happens_one_time_in(&mut self, one_in: usize) -> bool {
        self.random.index_below(one_in) == 0
    }

    fn random_choice<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.random.index_below(list.len())]
    }

    fn random_number_text(&mut self) -> String {
        format!("{:.3}", 1.1 + self.random.uniform_number(1.0))
    }

    fn add_body(&mut self, k: usize) {
        let mut mass = self.random_number_text();
        if self.happens_one_time_in(3) {
            let _ = writeln!(self.fields, "mass{k}: f64,");
            mass = format!("mass{k}");
            self.has_parameters = true;
        }
        let parent = match self.bodies.len() {
            0 => "ground".to_string(),
            _ if self.happens_one_time_in(3) => "ground".to_string(),
            n => self.bodies[self.random.index_below(n)].clone(),
        };
        let is_particle = self.happens_one_time_in(5);
        if is_particle {
            let _ = writeln!(self.fields, "#[particle(mass = {mass})] body{k}: Particle,");
        } else {
            let com = self.random_choice(&VECTORS);
            let solid = self.random_choice(&SOLIDS).replace('M', &mass);
            let _ = writeln!(
                self.fields,
                "#[body(mass = {mass}, com = {com}, inertia = {solid})] body{k}: Body,"
            );
        }
        let (kind, arguments, coordinates) =
            if is_particle { JOINTS[self.random_choice(&OF_PARTICLES)] } else { self.random_choice(&JOINTS) };
        let mut end = parent;
        if self.happens_one_time_in(2) {
            let _ = write!(end, ".at({})", self.random_choice(&VECTORS));
        }
        if self.happens_one_time_in(4) {
            let (axis, angle) = (self.random_choice(&["x", "y", "z"]), self.random_number_text());
            let _ = write!(end, ".rotated({axis}({angle}))");
        }
        let mut arguments = arguments.to_string();
        if arguments.ends_with("about") || arguments.ends_with("along") {
            let _ = write!(arguments, " = {}", self.random_choice(&UNITS));
        }
        let comma = if arguments.is_empty() { "" } else { ", " };
        let _ = writeln!(self.fields, "#[joint({end} -> body{k}{comma}{arguments})] joint{k}: {kind},");
        self.coordinates.extend(coordinates.iter().map(|name| format!("joint{k}{name}")));
        let list = if is_particle { &mut self.particles } else { &mut self.bodies };
        list.push(format!("body{k}"));
    }

    fn random_point_expression(&mut self) -> String {
        let particles = self.particles.len();
        if !self.points.is_empty() && self.happens_one_time_in(5) {
            let n = self.random.index_below(self.points.len());
            return self.points[n].clone();
        }
        let n = self.random.index_below(particles + self.bodies.len() + 1);
        if n < particles {
            return self.particles[n].clone();
        }
        let body = self.bodies.get(n - particles).cloned().unwrap_or("ground".to_string());
        format!("{body}.at({})", self.random_choice(&VECTORS))
    }

    /// Returns a random scalar: a function of the state, time or an input, or a number.
    fn random_scalar(&mut self) -> String {
        let coordinate = (!self.coordinates.is_empty()).then(|| {
            let n = self.random.index_below(self.coordinates.len());
            self.coordinates[n].clone()
        });
        if !self.states.is_empty() && self.happens_one_time_in(5) {
            let n = self.random.index_below(self.states.len());
            return self.states[n].clone();
        }
        match (self.random.index_below(12), coordinate) {
            (0, _) => "t".to_string(),
            (1, _) => self.random_number_text(),
            (2, _) => format!("look({})", self.random_number_text()),
            (3, _) => {
                format!("norm(r({} / {}))", self.random_point_expression(), self.random_point_expression())
            }
            (4, _) => "command".to_string(),
            (5, Some(coordinate)) => format!("rate({coordinate})"),
            (6, Some(coordinate)) => format!("look({coordinate})"),
            (_, Some(coordinate)) => coordinate,
            (_, None) => format!("dot(r({} / ground), y)", self.random_point_expression()),
        }
    }

    /// Fills the placeholders of a template with random scalars, vectors, points and bodies. All placeholders
    /// `B` are replaced by the same scalar.
    fn fill_placeholders(&mut self, form: &str) -> String {
        let same = self.random_scalar();
        let mut text = String::new();
        for (k, c) in form.char_indices() {
            let is_boundary = |c: Option<char>| !c.is_some_and(char::is_alphanumeric);
            let is_letter =
                is_boundary(form[..k].chars().last()) && is_boundary(form[k + 1..].chars().next());
            match c {
                'S' if is_letter => text += &self.random_scalar(),
                'B' if is_letter => text += &same,
                'P' if is_letter => text += &self.random_point_expression(),
                'V' if is_letter => {
                    let form = self.random_choice(&VECTOR_VALUES);
                    text += &self.fill_placeholders(form);
                }
                'A' if is_letter => text += &self.random_frame_name(),
                'H' if is_letter => text += &self.random_body_or_ground(),
                _ => text.push(c),
            }
        }
        text
    }

    fn random_body_or_ground(&mut self) -> String {
        let n = self.random.index_below(self.bodies.len());
        self.bodies.get(n).cloned().unwrap_or_else(|| "ground".to_string())
    }

    /// Returns the name of a random body, of a frame or of the ground.
    fn random_frame_name(&mut self) -> String {
        let n = self.random.index_below(self.bodies.len() + self.frames.len() + 1);
        let named = self.bodies.iter().chain(&self.frames).nth(n);
        named.cloned().unwrap_or_else(|| "ground".to_string())
    }

    fn random_scalar_value_expression(&mut self) -> String {
        let form = self.random_choice(&VALUES);
        self.fill_placeholders(form)
    }

    fn add_random_element(&mut self, k: usize) {
        let random_list_entry = |source: &mut SourceGenerator, list: fn(&SourceGenerator) -> &Vec<String>| {
            let n = list(source).len();
            (n > 0).then(|| source.random.index_below(n)).map(|n| list(source)[n].clone())
        };
        let coordinate = random_list_entry(self, |source| &source.coordinates);
        let body = random_list_entry(self, |source| &source.bodies);
        let (kind, law) = (self.random.index_below(32), self.random_choice(&LAWS));
        let field = match (kind, coordinate, body) {
            (0, Some(on), _) => format!("#[acts(on = {on}, stiffness = 2)] element{k}: Spring"),
            (1, Some(on), _) => {
                format!("#[acts(on = {on}, coulomb = 0.3, viscous = 0.1)] element{k}: Friction")
            }
            (2, ..) => {
                format!(
                    "#[acts(between = ({}, {}), {})] element{k}: {}",
                    self.random_point_expression(),
                    self.random_point_expression(),
                    law.0,
                    law.1
                )
            }
            (3, Some(on), _) => {
                format!("#[acts(on = {on})] element{k}: {}", self.random_choice(&["Force", "Torque"]))
            }
            (4, ..) => {
                format!(
                    "#[acts(on = {}, along = {})] element{k}: Force",
                    self.random_point_expression(),
                    self.random_choice(&UNITS)
                )
            }
            (5, ..) => format!(
                "#[acts(on = {}, value = ({}) * ground.x)] element{k}: Force",
                self.random_point_expression(),
                self.random_scalar_value_expression()
            ),
            (6, ..) => format!(
                "#[output(v({} / ground / ground))] output{k}: Vector",
                self.random_point_expression()
            ),
            (7, ..) => format!(
                "#[output(a({} / ground / ground))] output{k}: Vector",
                self.random_point_expression()
            ),
            (8, _, Some(body)) => format!("#[output({body}, resolved_in = ground)] output{k}: FreeBody"),
            (9, _, Some(body)) => {
                let surfaces = self.random_choice(&SURFACES).replace('H', &body);
                format!("#[contact({surfaces}, friction = 0.3)] contact{k}: Contact")
            }
            (10, Some(on), _) => format!("#[limit(on = {on}, from = -1, to = 1)] limit{k}: Limit"),
            (11, ..) => {
                self.has_constraints = true;
                format!("#[constraint({})] constraint{k}: Holonomic", self.random_scalar_value_expression())
            }
            (30 | 31, _, Some(body)) => {
                let surfaces = self.random_choice(&SURFACES).replace('H', &body);
                format!(
                    "#[contact({surfaces}, friction = 0.4, stiction = 0.6, restitution = 0.2)] contact{k}: \
                     Contact"
                )
            }
            (12, ..) => format!("#[output({})] output{k}: Scalar", self.random_scalar_value_expression()),
            _ => self.declaration_of_rare_element(kind, k),
        };
        let _ = writeln!(self.fields, "{field},");
    }

    /// Returns the declaration of a rare element: an output, coordinate, frame or other field of the given
    /// kind.
    fn declaration_of_rare_element(&mut self, kind: usize, k: usize) -> String {
        let coordinate = self.coordinates.last().cloned().unwrap_or_else(|| "t".to_string());
        let body = self.bodies.last().cloned().unwrap_or_else(|| "ground".to_string());
        match kind {
            13 | 14 => {
                let form = self.random_choice(&SCALAR_OUTPUTS);
                format!("#[output({})] output{k}: Scalar", self.fill_placeholders(form))
            }
            15 | 16 => {
                let form = self.random_choice(&VECTOR_OUTPUTS);
                let axes = self.random_frame_name();
                format!("#[output({}, resolved_in = {axes})] output{k}: Vector", self.fill_placeholders(form))
            }
            17 => {
                let form = self.random_choice(&MATRIX_OUTPUTS);
                format!("#[output({})] output{k}: Matrix", self.fill_placeholders(form))
            }
            18 => {
                self.coordinates.push(format!("own{k}"));
                let (point, along) = (self.random_choice(&VECTORS), self.random_frame_name());
                format!(
                    "own{k}: Coordinate,\n#[particle(mass = 0.7, at = {body}.at(own{k} * {along}.x + \
                     {point}))] bead{k}: Particle"
                )
            }
            19 => {
                let (on, angle) = (self.random_frame_name(), self.random_scalar());
                self.frames.push(format!("frame{k}"));
                format!("#[frame({on}, {}({angle}))] frame{k}: Frame", self.random_choice(&["x", "y", "z"]))
            }
            20 => {
                let at = self.random_choice(&VECTORS);
                self.points.push(format!("point{k}"));
                format!("#[point(on = {body}, at = {at} + 0.3 * {coordinate} * y)] point{k}: Point")
            }
            21 => format!("#[energy({})] energy{k}: Potential", self.random_scalar_value_expression()),
            22 => format!("#[dissipation(0.2 * pow(rate({coordinate}), 2))] loss{k}: Rayleigh"),
            23 => {
                self.has_constraints = true;
                let (point, axes) = (self.random_point_expression(), self.random_frame_name());
                format!(
                    "#[constraint(dot(v({point} / ground / ground), {axes}.x) = 0)] constraint{k}: \
                     Nonholonomic"
                )
            }
            24 => {
                self.has_constraints = true;
                format!("#[constraint(rolls({body}.sphere(0.2), ground.plane(y)))] constraint{k}: Rolling")
            }
            25 => {
                let rate = self.random_scalar_value_expression();
                self.states.push(format!("state{k}"));
                format!("#[state(rate = {rate})] state{k}: State")
            }
            26 => {
                let (a, b, c) = (
                    self.random_point_expression(),
                    self.random_point_expression(),
                    self.random_point_expression(),
                );
                format!(
                    "#[acts(on = norm(r({a} / {b}) + 2 * ground.z) + norm(r({b} / {c}) - 3 * ground.x), \
                     stiffness = 2, free_length = 0.4)] element{k}: Spring"
                )
            }
            27 => {
                self.has_constraints = true;
                let other = self.bodies.first().cloned().unwrap_or_else(|| "ground".to_string());
                let kind = self.random_choice(&[
                    "about = z)] loop{k}: Pin",
                    "along = x)] loop{k}: Sleeve",
                    "about = z, pitch = 0.4)] loop{k}: Screw",
                    "about = z)] loop{k}: Collar",
                    "along = x, about = z)] loop{k}: Slot",
                    "about = (x, y))] loop{k}: Universal",
                    ")] loop{k}: Ball",
                    "about = y)] loop{k}: Planar",
                    "along = (x, z))] loop{k}: Stage",
                    ")] loop{k}: Weld",
                ]);
                let comma = if kind.starts_with('a') { ", " } else { "" };
                let (here, there) = (self.random_choice(&VECTORS), self.random_choice(&VECTORS));
                format!(
                    "#[joint({other}.at({here}) -> {body}.at({there}){comma}{}",
                    kind.replace("{k}", &k.to_string())
                )
            }
            28 => format!(
                "#[acts(on = {coordinate}, value = -0.2 * rate(rate({coordinate})) + S)] added{k}: Force"
            )
            .replace('S', &self.random_scalar()),
            _ => {
                let other = self.coordinates.first().cloned().unwrap_or_else(|| "t".to_string());
                format!(
                    "#[speed(1.5 * rate({coordinate}) + 0.4 * cos({other}) * rate({other}))] speed{k}: Speed"
                )
            }
        }
    }
}
