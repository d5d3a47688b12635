//! Random URDF files with joints of every type against an oracle that knows nothing of the compiler: places and rotations
//! as the format defines them, differentiated twice in time by polynomials of second degree, and Kane's equations.

use jets::{Jet, Matrix, Vector};
use linkwork_compiler::derive::{Function, Output};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::{Graph, Symbol};
use linkwork_compiler::model::{Quantity, build_model};
use linkwork_compiler::syntax::{self, Base, Inertias, Name, UrdfOptions};
use linkwork_compiler::{derive, import, read};
use robot::Robot;
use std::path::Path;

#[path = "generated_files/jets.rs"]
mod jets;
#[path = "generated_files/robot.rs"]
mod robot;

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// A generator of its own: tests of this crate depend on nothing else (Vigna, *xorshift\**).
pub struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// Less than `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() >> 33) as usize % n
    }

    /// Between −1 and 1, with four digits: what is written to the file is read back.
    pub fn number(&mut self) -> f64 {
        self.below(20_001) as f64 / 1e4 - 1.0
    }

    /// An array of numbers between −1 and 1.
    pub fn numbers<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.number())
    }
}

/// The functions of the file.
fn functions(robot: &Robot) -> (Vec<String>, Output) {
    let mut cx = Diagnostics::new();
    let (arguments, item) = ("".parse().unwrap(), "struct Robot;".parse().unwrap());
    let mut source = read(arguments, item, Path::new(""), &mut cx).expect("a struct");
    let place = source.mechanism.description.name.place.clone();
    let name = |text: &str| Name { text: text.to_string(), place: place.clone() };
    let options = UrdfOptions {
        path: name("r.urdf"),
        base: if robot.free { Base::Free } else { Base::Fixed },
        honour_passive: true,
        follow_mimic: true,
        inertias: Inertias::Check,
        inputs: true,
        lock: robot.locked().map(name).collect(),
        snap: None,
    };
    let imported = import::import_urdf(&robot.text(), &options, &mut cx);
    let imported = imported.unwrap_or_else(|| panic!("{:?}\n{}", cx.messages(), robot.text()));
    let description = &mut source.mechanism.description;
    (description.bodies, description.joints) = (imported.bodies, imported.joints);
    description.gravity = Some(syntax::Expr::vector(GRAVITY, &place));
    let graph = Graph::new();
    let model = build_model(description, &graph, &mut cx);
    let output = model.as_ref().and_then(|model| derive(model, &mut cx));
    let output = output.unwrap_or_else(|| panic!("{:?}\n{}", cx.messages(), robot.text()));
    (model.map(|model| model.configuration).unwrap_or_default(), output)
}

/// The values of a function, as one state is computed and in lanes.
fn values(f: &Function, state: &State, tau: &[f64]) -> Vec<Vec<f64>> {
    let symbol = |symbol: Symbol| match Quantity::of(symbol) {
        Quantity::Configuration(k) => state.q[k],
        Quantity::Velocity(k) => state.v[k],
        Quantity::Acceleration(k) => state.a[k],
        Quantity::Force(k) => tau[k],
        other => panic!("{other:?}"),
    };
    [Some(&f.program), f.program.in_lanes.as_deref()].into_iter().flatten().map(|p| p.run(&symbol)).collect()
}

/// Configuration, velocity, acceleration.
pub struct State {
    /// `q`.
    pub q: Vec<f64>,
    /// `v`.
    pub v: Vec<f64>,
    /// `v̇`.
    pub a: Vec<f64>,
}

fn assert_near(what: &str, seed: u64, found: &[f64], expected: &[f64], robot: &Robot) {
    let size = expected.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    let off = found.iter().zip(expected).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
    assert!(
        found.len() == expected.len() && off <= 1e-10 * size,
        "{what} of {seed}: {off}\n{}",
        robot.text()
    );
}

/// What the oracle says of a motion: forces, energies, centre of mass.
struct Truth {
    forces: Vec<f64>,
    kinetic: f64,
    potential: f64,
    center: [f64; 3],
}

/// Kane's equations: what accelerates masses does work along the partial velocities of every link.
fn truth(robot: &Robot, state: &State) -> Truth {
    let links = robot.motion(state);
    let still = |k: usize| {
        let v = (0..state.v.len()).map(|j| f64::from(u8::from(j == k))).collect();
        State { q: state.q.clone(), v, a: vec![0.0; state.v.len()] }
    };
    let partial: Vec<Vec<(Matrix, Vector)>> = (0..state.v.len()).map(|k| robot.motion(&still(k))).collect();
    let mut truth =
        Truth { forces: vec![0.0; state.v.len()], kinetic: 0.0, potential: 0.0, center: [0.0; 3] };
    let mut mass = 0.0;
    for (k, link) in robot.links.iter().enumerate().filter(|(k, _)| robot.moves(*k)) {
        let place = |(rotation, origin): &(Matrix, Vector)| {
            jets::plus(origin, &jets::times(rotation, &link.com.map(Jet::constant)))
        };
        let (rotation, center) = (&links[k].0, place(&links[k]));
        let (omega, alpha) = jets::turning(rotation);
        let about = |w: [f64; 3]| jets::inertia(rotation, &link.inertia, w);
        let (momentum, rate) = (about(omega), about(alpha));
        let torque = jets::sum(rate, jets::cross(omega, momentum));
        let force: [f64; 3] = std::array::from_fn(|i| link.mass * (center[i].second() - GRAVITY[i]));
        for (f, links) in truth.forces.iter_mut().zip(&partial) {
            let velocity = place(&links[k]).map(|jet| jet.first());
            *f += jets::dot(force, velocity) + jets::dot(torque, jets::turning(&links[k].0).0);
        }
        let velocity = center.map(|jet| jet.first());
        truth.kinetic += 0.5 * link.mass * jets::dot(velocity, velocity) + 0.5 * jets::dot(omega, momentum);
        truth.potential -= link.mass * jets::dot(GRAVITY, center.map(|jet| jet.value()));
        truth.center = jets::sum(truth.center, center.map(|jet| link.mass * jet.value()));
        mass += link.mass;
    }
    truth.center = truth.center.map(|c| c / mass);
    truth
}

/// Files of two to seven links, of which some are locked, follow others or are written in another order.
#[test]
fn random_files_move_as_the_format_says() {
    let mut kinds = [0; 7];
    for seed in 1..21 {
        let mut random = Random(0x9E37_79B9_7F4A_7C15_u64.wrapping_mul(seed));
        let robot = Robot::random(&mut random);
        let (names, output) = functions(&robot);
        assert_eq!(names, robot.coordinates(), "{}", robot.text());
        robot.count(&mut kinds);
        let of = |name: &str| output.functions.iter().find(|f| f.name == name).expect("a function");
        for _ in 0..2 {
            let state = robot.state(&mut random);
            let expected = truth(&robot, &state);
            let check = |name: &str, expected: &[f64]| {
                for found in values(of(name), &state, &[]) {
                    assert_near(name, seed, &found, expected, &robot);
                }
            };
            check("inverse_dynamics", &expected.forces);
            check("kinetic_energy", &[expected.kinetic]);
            if robot.links.iter().enumerate().any(|(k, _)| robot.moves(k)) {
                check("potential_energy", &[expected.potential]);
                check("center_of_mass", &expected.center);
            }
            for found in values(of("forward_dynamics"), &state, &expected.forces) {
                let size = state.a.iter().fold(1.0_f64, |size, a| size.max(a.abs()));
                let off = found.iter().zip(&state.a).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
                assert!(off <= 1e-6 * size, "forward dynamics of {seed}: {off}\n{}", robot.text());
            }
        }
    }
    assert!(kinds.iter().all(|count| *count >= 3), "{kinds:?}");
}
