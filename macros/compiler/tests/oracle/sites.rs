//! Random MJCF files with motors on sites: the power of forces and torques compared with partial velocities.

use crate::jet::{C, complex_from_real, constant_vector, cross};
use crate::kane::State;
use crate::motion::{Pose, angular_motion, complex_dot, velocity_of_position};
use crate::random::Random;
use crate::robot::{Robot, rotation_of_rpy, space_separated_text};
use crate::test_seeds;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::{Graph, Symbol};
use linkwork_compiler::mechanism::Quantity;
use linkwork_compiler::resolve::build_model;
use linkwork_compiler::{derive, parse_source_and_import};
use std::array::from_fn;
use std::path::Path;

/// Generalized forces as a function of configuration, velocities and inputs.
type GeneralizedForceFunction = dyn Fn(&[f64], &[f64], &[f64]) -> Vec<f64>;

/// Names of the coordinates and inputs of a file, and its generalized forces.
struct GeneralizedForceModel {
    coordinates: Vec<String>,
    inputs: Vec<String>,
    values: Box<GeneralizedForceFunction>,
}

fn forces_of_motors(text: &str, locked: &[String]) -> GeneralizedForceModel {
    let thread = std::thread::current().id();
    let file = std::env::temp_dir().join(format!("linkwork-sites-{}-{thread:?}.xml", std::process::id()));
    std::fs::write(&file, text).expect("a file");
    let mut cx = Diagnostics::new();
    let arguments = format!("mjcf = {:?}, lock = {locked:?}", file.to_string_lossy());
    let source = parse_source_and_import(
        arguments.parse().expect("arguments"),
        "pub struct Robot;".parse().expect("a struct"),
        Path::new("/"),
        &mut cx,
    );
    // Files that remain in the folder for temporary files do no harm.
    let _ = std::fs::remove_file(&file);
    let source =
        source.filter(|_| cx.is_empty()).unwrap_or_else(|| panic!("{:?}\n{text}", cx.full_message_texts()));
    let graph = Graph::new();
    let model = build_model(&source.mechanism.description, &graph, &mut cx);
    let output = model.as_ref().and_then(|model| derive(model, &mut cx));
    let (Some(model), Some(output)) = (&model, output) else {
        panic!("{:?}\n{text}", cx.full_message_texts())
    };
    let (coordinates, inputs) =
        (model.configuration.clone(), model.inputs.iter().map(|(name, _)| name.clone()));
    let inputs = inputs.collect();
    let function = output.functions.into_iter().find(|f| f.name == "generalized_forces");
    let evaluate_forces = move |q: &[f64], v: &[f64], u: &[f64]| {
        let value_of_symbol = |symbol: Symbol| match Quantity::from_symbol(symbol) {
            Quantity::Configuration(k) => q[k],
            Quantity::Velocity(k) => v[k],
            Quantity::Input(k) => u[k],
            other => panic!("{other:?}"),
        };
        function
            .as_ref()
            .map_or_else(Vec::new, |function| function.program.interpret_program(&value_of_symbol))
    };
    GeneralizedForceModel { coordinates, inputs, values: Box::new(evaluate_forces) }
}

/// Site of a random MJCF file: a frame on a link or on the ground.
struct Site {
    link: Option<usize>,
    xyz: [f64; 3],
    rpy: [f64; 3],
}

impl Site {
    fn random_site(link: Option<usize>, random: &mut Random) -> Site {
        Site {
            link,
            xyz: random.four_digit_numbers(),
            rpy: random.four_digit_numbers::<3>().map(|angle| 3.0 * angle),
        }
    }

    fn mjcf_site_element(&self, name: &str) -> String {
        format!(
            "<site name=\"{name}\" pos=\"{}\" euler=\"{}\"/>",
            space_separated_text(self.xyz),
            space_separated_text(self.rpy)
        )
    }

    fn site_pose_in_ground(&self, robot: &Robot, state: &State) -> Pose {
        let ground = Pose { r: rotation_of_rpy(self.rpy), p: constant_vector(self.xyz) };
        self.link.map_or(ground, |link| robot.pose_of_frame(link, self.xyz, self.rpy, state))
    }
}

/// Motor on a site, with or without a reference site that receives the reaction.
struct Motor {
    sites: [usize; 2],
    against: bool,
    gear: [f64; 6],
}

impl Motor {
    /// Returns the power of the motor for a unit input: the power of its force and torque in the motion
    /// relative to the reference site.
    fn motor_power_for_unit_input(&self, sites: &[Site], robot: &Robot, state: &State) -> C {
        let [on, against] = self.sites.map(|k| sites[k].site_pose_in_ground(robot, state));
        let axes = if self.against { &against } else { &on };
        let vector_in_ground =
            |v: [f64; 3]| -> [C; 3] { from_fn(|i| (0..3).map(|j| axes.r[i][j].0[0] * v[j]).sum()) };
        let [x, y, z, a, b, c] = self.gear;
        let (mut v, mut w) = (velocity_of_position(on.p), angular_motion(&on.r).0);
        if self.against {
            let (other, turn) = (velocity_of_position(against.p), angular_motion(&against.r).0);
            let arm = from_fn(|i| on.p[i].0[0] - against.p[i].0[0]);
            let carried = cross(turn, arm);
            v = from_fn(|i| v[i] - other[i] - carried[i]);
            w = from_fn(|i| w[i] - turn[i]);
        }
        complex_dot(vector_in_ground([x, y, z]), v) + complex_dot(vector_in_ground([a, b, c]), w)
    }
}

/// Checks that motors on sites do the work of their forces. Random files have two to seven links and one to
/// four motors, on moving and fixed links.
#[test]
fn random_site_motors_do_the_work_of_their_forces() {
    for seed in test_seeds(60) {
        let mut random = Random::new(6_000_000 + seed);
        let robot = Robot::random_robot_for_mjcf(&mut random);
        let links = robot.links.len();
        let mut sites = vec![Site::random_site(None, &mut random)];
        sites.extend((0..links).map(|link| Site::random_site(Some(link), &mut random)));
        let motors: Vec<Motor> = (0..1 + random.index_below(4))
            .map(|_| {
                let link = random.index_below(links);
                let carriers: Vec<usize> =
                    (0..links).filter(|k| *k != link && robot.is_link_or_ancestor(*k, link)).collect();
                let other =
                    random.index_below(carriers.len() + 1).checked_sub(1).map_or(0, |k| carriers[k] + 1);
                let mut gear: [f64; 6] = random.four_digit_numbers();
                match random.index_below(3) {
                    0 => gear[..3].fill(0.0),
                    1 => gear[3..].fill(0.0),
                    _ => {}
                }
                Motor { sites: [link + 1, other], against: random.index_below(2) == 0, gear }
            })
            .collect();
        let mjcf_site_element_of_link =
            |link: usize| sites[link + 1].mjcf_site_element(&format!("s{}", link + 1));
        let mjcf_motor_element = |(k, motor): (usize, &Motor)| {
            let [on, other] = motor.sites;
            let against = if motor.against { format!(" refsite=\"s{other}\"") } else { String::new() };
            let gear = motor.gear.map(|x| format!("{x:?}")).join(" ");
            format!("<motor name=\"m{k}\" site=\"s{on}\"{against} gear=\"{gear}\"/>")
        };
        let motors_text: String = motors.iter().enumerate().map(mjcf_motor_element).collect();
        let text = robot
            .mjcf_text(&mjcf_site_element_of_link, &format!("<actuator>{motors_text}</actuator>"))
            .replace("<worldbody>", &format!("<worldbody>{}", sites[0].mjcf_site_element("s0")));
        let locked: Vec<String> = robot.locked_joint_names().map(str::to_string).collect();
        if !(0..links).any(|link| robot.can_move_link(link)) {
            continue;
        }
        let found = forces_of_motors(&text, &locked);
        assert_eq!(found.coordinates, robot.coordinate_names(), "{text}");
        assert_eq!(found.inputs.len(), motors.len(), "{text}");
        let [q, v, _] = robot.random_state(&mut random);
        let u: Vec<f64> = motors.iter().map(|_| random.four_digit_number()).collect();
        let values = (found.values)(&q, &v, &u);
        for (k, value) in values.iter().enumerate() {
            let unit: Vec<f64> = (0..v.len()).map(|j| f64::from(u8::from(j == k))).collect();
            let state = State::new(&q, &unit, &vec![0.0; v.len()]);
            let expected: C = motors
                .iter()
                .zip(&u)
                .map(|(motor, u)| {
                    motor.motor_power_for_unit_input(&sites, &robot, &state) * complex_from_real(*u)
                })
                .sum();
            let expected = expected.re;
            assert!(
                (value - expected).abs() < 1e-10 * (1.0 + expected.abs()),
                "{seed} {k}: {value} {expected}\n{text}"
            );
        }
    }
}

/// Nozzle at the end of an arm: results calculated by hand and with MuJoCo 4.0.0.
#[test]
fn site_motors_of_an_arm_agree_with_mujoco() {
    let arm_model_text = |actuator: &str| {
        format!(
            "<mujoco><worldbody><site name='base'/><body name='arm'><inertial pos='0.2 0 0' mass='1' diaginertia='0.01 0.01 0.01'/>\
             <joint name='hinge' axis='0 1 0'/><site name='tip' pos='0.5 0 0'/></body></worldbody>\
             <actuator><motor name='jet' site='tip' {actuator}/></actuator></mujoco>"
        )
    };
    let at = 0.1_f64;
    for (actuator, expected) in [
        ("gear='0 0 1'", -0.5),
        ("gear='0 0 0 0 2 0'", 2.0),
        ("refsite='base' gear='0 0 1'", -0.5 * at.cos()),
        ("refsite='base' gear='0 0 1 0 1 0'", 1.0 - 0.5 * at.cos()),
    ] {
        let found = (forces_of_motors(&arm_model_text(actuator), &[]).values)(&[at], &[0.0], &[1.0]);
        assert!((found[0] - expected).abs() < 1e-15, "{actuator}: {found:?}");
    }
    // Two rotors lift a hull with the sum of their forces, and rotate it with the difference of their
    // torques.
    let hull = "<mujoco><worldbody><body><freejoint/><inertial pos='0 0 0' mass='0.5' diaginertia='0.01 0.01 0.02'/>\
        <site name='front' pos='0.2 0 0'/><site name='back' pos='-0.2 0 0'/></body></worldbody>\
        <actuator><motor site='front' gear='0 0 1 0 0 0.1'/><motor site='back' gear='0 0 1 0 0 -0.1'/></actuator></mujoco>";
    let pose = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let found = (forces_of_motors(hull, &[]).values)(&pose, &[0.0; 6], &[3.0, 1.0]);
    let expected = [0.0, 0.0, 4.0, 0.0, -0.4, 0.2];
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
}
