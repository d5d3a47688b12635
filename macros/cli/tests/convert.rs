//! Tests of the conversion of robot files to structs with the same equations of motion.

use linkwork_compiler::derive::DerivationOutput;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::{Model, Quantity};
use linkwork_compiler::{ParsedSource, compile, parse_source_and_import};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Compiles a struct with arguments of the attribute, and passes the result to `test`.
fn compile_struct_and_test<T>(
    arguments: &str,
    item: &str,
    test: impl FnOnce(&Model<'_>, &DerivationOutput) -> T,
) -> T {
    let cx = &mut Diagnostics::new();
    let source: Option<ParsedSource> =
        parse_source_and_import(arguments.parse().unwrap(), item.parse().unwrap(), Path::new("/"), cx);
    let graph = Graph::new();
    let made = source.and_then(|source| compile(&source, &graph, cx));
    let (model, output) = made.unwrap_or_else(|| panic!("{:?}", cx.full_message_texts()));
    test(&model, &output)
}

/// Evaluates a function at a state that depends on the indices of its entries.
fn evaluate_at_sample_state(model: &Model<'_>, output: &DerivationOutput, function: &str) -> Vec<f64> {
    let sample_value = |k: usize, shift: f64| (1.7 * k as f64 + shift).sin();
    let sample_coordinate =
        |k: usize| match model.configuration.get(k).and_then(|name| name.rsplit('.').next()) {
            // Quaternions of unit length.
            Some("qx") => 0.1,
            Some("qy" | "qw") => 0.7,
            Some("qz") => -0.1,
            _ => sample_value(k, 0.3),
        };
    let find_function = |name: &str| output.functions.iter().find(|f| f.name == name);
    let evaluate_function = |name: &str, passive: &[f64]| {
        find_function(name).unwrap().program.interpret_program(
            &|symbol| match Quantity::from_symbol(symbol) {
                Quantity::Configuration(k) => sample_coordinate(k),
                Quantity::Velocity(k) => sample_value(k, 0.9),
                Quantity::Acceleration(k) => sample_value(k, 1.3),
                Quantity::Force(k) => sample_value(k, 2.1),
                Quantity::Input(k) => sample_value(k, 0.1),
                Quantity::PassiveForce(k) => passive[k],
                other => panic!("{other:?}"),
            },
        )
    };
    // Long passive forces are a separate function, whose results are arguments of the other functions.
    let passive = find_function("__passive_forces").map(|_| evaluate_function("__passive_forces", &[]));
    evaluate_function(function, &passive.unwrap_or_default())
}

fn convert_file(file: &Path, with: &str) -> (String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_linkwork"));
    let output = command.arg("convert").arg(file).args(["--with", with]).output().unwrap();
    let decode_utf8 = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let (code, stderr) = (decode_utf8(output.stdout), decode_utf8(output.stderr));
    assert!(output.status.success(), "{}: {stderr}", file.display());
    (code, stderr)
}

/// Splits a converted struct into the arguments of its attribute and the struct.
fn split_attribute_and_struct(code: &str) -> (String, String) {
    let (_, rest) = code.split_once("#[mechanism(").unwrap();
    let (arguments, item) = rest.split_once(")]\n").unwrap();
    (arguments.to_string(), item.to_string())
}

/// Returns the number of frames except the ground, which is one of the links of a file.
fn count_frames(model: &Model<'_>) -> usize {
    model.frames.iter().filter(|frame| frame.name != "ground").count()
}

fn check_conversion(format: &str, file: &Path, with: &str) {
    check_conversion_with_notes(format, file, with, &[]);
}

/// Compares a struct with its file; `notes` are expected messages in addition to the list of renamed
/// elements.
fn check_conversion_with_notes(format: &str, file: &Path, with: &str, notes: &[&str]) {
    let (code, stderr) = convert_file(file, with);
    let (arguments, item) = split_attribute_and_struct(&code);
    let is_expected_note = |line: &str| {
        line.starts_with("linkwork: names that differ from the file: ")
            || notes.iter().any(|note| line.contains(note))
    };
    assert!(stderr.lines().all(is_expected_note), "{}: {stderr}", file.display());
    let given = format!("{format} = {:?}, {with}", file.display().to_string());
    let functions =
        ["mass_matrix", "inverse_dynamics", "forward_dynamics", "generalized_forces", "potential_energy"];
    let evaluate_all_functions = |model: &Model<'_>, output: &DerivationOutput| {
        functions.map(|function| evaluate_at_sample_state(model, output, function))
    };
    let expected = compile_struct_and_test(&given, "struct Robot;", |m, o| {
        (m.nq(), m.nu(), count_frames(m), m.limits.len(), evaluate_all_functions(m, o))
    });
    let found = compile_struct_and_test(&arguments, &item, |m, o| {
        (m.nq(), m.nu(), count_frames(m), m.limits.len(), evaluate_all_functions(m, o))
    });
    assert_eq!((found.0, found.1), (expected.0, expected.1), "{}", file.display());
    assert_eq!((found.2, found.3), (expected.2, expected.3), "frames and limits of {}", file.display());
    for (k, (a, b)) in found.4.iter().zip(&expected.4).enumerate() {
        let size = b.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(a.len() == b.len() && off < 1e-9 * size, "{} of {}: {off}", functions[k], file.display());
    }
}

fn repository_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

#[test]
fn converted_structs_have_the_dynamics_of_their_files() {
    let urdf = repository_folder().join("models/urdf");
    for (name, with) in [
        ("ur5", "base = fixed"),
        ("gen3", "base = fixed"),
        ("double_pendulum", "base = fixed"),
        ("solo12", "base = free"),
        ("simple_humanoid", "base = free"),
        ("anymal_b", "base = free, inertia = trust"),
        ("panda", "mimic = independent"),
    ] {
        check_conversion("urdf", &urdf.join(format!("{name}.urdf")), with);
    }
}

const CRANE: &str = r#"<mujoco model="crane">
  <compiler angle="radian"/>
  <option gravity="0 0 -3.7"/>
  <worldbody>
    <site name="wall" pos="-1 0.3 0.2"/>
    <body name="trolley">
      <joint name="trolley" type="slide" axis="1 0 0" stiffness="30" springref="0.4" damping="2" armature="0.3" frictionloss="0.2"/>
      <geom type="box" size="0.1 0.1 0.1" mass="2"/>
      <body name="t" pos="0 0 -0.1" euler="0.1 0.2 0.3">
        <joint name="swing" axis="0 2 0" pos="0 0 0.05" stiffness="2" range="-7 7"/>
        <geom type="capsule" fromto="0 0 0 0 0 -1" size="0.02" mass="0.5"/>
        <site name="hook" pos="0 0 -1"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="wire" stiffness="5" springlength="0.2 0.3" damping="0.4" frictionloss="0.1">
      <site site="wall"/>
      <site site="hook"/>
    </spatial>
  </tendon>
  <actuator>
    <motor name="winch" tendon="wire"/>
    <motor name="drive" joint="trolley" gear="12"/>
    <motor name="twist" joint="swing"/>
  </actuator>
</mujoco>"#;

/// Checks names that are reserved words, springs, rotor inertias, gears and cables.
#[test]
fn elements_of_robot_files_become_struct_fields() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("converted");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("crane.xml");
    std::fs::write(&file, CRANE).unwrap();
    let (code, _) = convert_file(&file, "");
    for part in [
        "t_link: Body",
        "trolley_joint: Sleeve",
        "gravity = -3.7 * z",
        "pub struct Crane {",
        "Spring",
        "Inerter",
    ] {
        assert!(code.contains(part), "{part}: {code}");
    }
    check_conversion("mjcf", &file, "");
}

/// Writes a file for one test, and returns its path.
fn write_test_file(name: &str, text: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("structs");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join(name);
    std::fs::write(&file, text).unwrap();
    file
}

/// Compares mass matrix and bias forces for the robot files of other tests. Mimic joints have independent
/// velocities in structs.
#[test]
fn robot_files_convert_with_equal_dynamics() {
    for (format, file, with) in [
        ("urdf", "tests/data/urdf/arm_after.urdf", "mimic = independent"),
        ("urdf", "tests/data/urdf/limits.urdf", "mimic = independent"),
        ("urdf", "tests/data/urdf/impossible.urdf", "inertia = trust"),
        ("urdf", "tests/data/sdf/tree.urdf", "mimic = independent"),
        ("sdf", "tests/data/sdf/arm.sdf", "mimic = independent"),
        ("sdf", "tests/data/sdf/joints.sdf", ""),
        ("sdf", "tests/data/sdf/linkage.sdf", ""),
        ("sdf", "tests/data/sdf/tree.sdf", ""),
        ("mjcf", "tests/data/mjcf/cables.xml", ""),
        ("mjcf", "tests/data/mjcf/everything.xml", ""),
        ("mjcf", "tests/data/mjcf/free_bodies.xml", ""),
        ("mjcf", "tests/data/mjcf/loops.xml", ""),
        ("mjcf", "tests/data/mjcf/medium.xml", ""),
    ] {
        let file = repository_folder().join(file);
        let given = format!("{format} = {:?}, {with}", file.display().to_string());
        let sizes_and_dynamics_values = |model: &Model<'_>, output: &DerivationOutput| {
            (
                model.nq(),
                model.nu(),
                ["mass_matrix", "bias_forces"]
                    .map(|function| evaluate_at_sample_state(model, output, function)),
            )
        };
        let expected = compile_struct_and_test(&given, "struct Robot;", sizes_and_dynamics_values);
        let (arguments, item) = split_attribute_and_struct(&convert_file(&file, with).0);
        let found = compile_struct_and_test(&arguments, &item, sizes_and_dynamics_values);
        assert_eq!((found.0, found.1), (expected.0, expected.1), "{}", file.display());
        for (a, b) in found.2.iter().zip(&expected.2) {
            let size = b.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
            let is_nearly_equal = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9 * size;
            assert!(
                a.len() == b.len() && a.iter().zip(b).all(is_nearly_equal),
                "{}: {a:?} {b:?}",
                file.display()
            );
        }
    }
}

/// Checks a name that a body and a joint share. In expressions of the medium, of damping and of cables it
/// means the body, in couplings the joint.
#[test]
fn names_shared_by_link_and_joint_are_resolved() {
    let file = write_test_file(
        "shared.xml",
        r#"<mujoco><option density="1.2" viscosity="0.1"/><worldbody>
  <site name="o" pos="0 0.2 1"/>
  <body name="b"><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.02 0.03"/>
    <joint name="b" type="ball" damping="0.1"/><site name="p" pos="0.1 0 0.2"/>
    <body name="c" pos="0 0 1"><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.02 0.03"/><joint name="c" axis="0 1 0"/>
      <body name="d" pos="0 0 1"><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.02 0.03"/><joint name="d" axis="1 0 0"/></body>
    </body></body></worldbody>
  <tendon><spatial name="b" stiffness="5" springlength="0.1"><site site="o"/><site site="p"/></spatial></tendon>
  <equality><joint joint1="c" joint2="d" polycoef="0.1 2 0.3 0 0"/></equality></mujoco>"#,
    );
    let given = format!("mjcf = {:?}", file.display().to_string());
    let functions = ["mass_matrix", "bias_forces", "potential_energy", "constraint_residuals"];
    let evaluate_all_functions = |model: &Model<'_>, output: &DerivationOutput| {
        functions.map(|function| evaluate_at_sample_state(model, output, function))
    };
    let expected = compile_struct_and_test(&given, "struct Robot;", evaluate_all_functions);
    let (code, _) = convert_file(&file, "");
    let (arguments, item) = split_attribute_and_struct(&code);
    for (a, b) in compile_struct_and_test(&arguments, &item, evaluate_all_functions).iter().zip(&expected) {
        assert!(a.len() == b.len() && !a.is_empty(), "{a:?} {b:?}");
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9 * b.abs().max(1.0)), "{a:?} {b:?}");
    }
}

/// Checks damping that adds energy, gears, elements on several joints, and lengths that do not change.
#[test]
fn negative_damping_and_multi_joint_elements_are_converted() {
    let file = write_test_file(
        "signs.xml",
        r#"<mujoco><worldbody><site name="o" pos="0 0 1"/><site name="o2" pos="0 1 1"/>
  <body name="b"><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/><joint name="j" axis="0 1 0"/>
    <site name="p" pos="0.1 0 0.2"/><site name="on_axis" pos="0 1 0"/>
    <body name="c"><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/><joint name="k" type="slide" axis="0 1 0" stiffness="0"/></body>
  </body>
  <body name="base"><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
    <body name="bracket"><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/><site name="fixed"/></body>
  </body></worldbody>
  <tendon>
    <spatial name="still" stiffness="5" springlength="0.1"><site site="o"/><site site="o2"/></spatial>
    <spatial name="round" stiffness="5" damping="1"><site site="o"/><site site="on_axis"/></spatial>
    <spatial name="gains" damping="-1" stiffness="-3" springlength="0.1 0.2"><site site="o"/><site site="p"/></spatial>
    <fixed name="none" stiffness="3"><joint joint="j" coef="0"/></fixed>
    <fixed name="one" damping="-2" frictionloss="0.3"><joint joint="j" coef="3"/></fixed>
    <fixed name="slack" stiffness="4" springlength="0 0.1" damping="0.2" frictionloss="0.1"><joint joint="j" coef="2"/><joint joint="k" coef="-1"/></fixed>
  </tendon>
  <actuator>
    <motor name="m" tendon="still"/><motor name="gear" joint="j" gear="12"/><motor name="both" tendon="slack"/>
    <general name="g" joint="j" biastype="affine" biasprm="1 -2 0.5"/><general name="h" tendon="slack" biastype="affine" biasprm="1 -2 0.5" gear="-3"/>
    <position name="lazy" joint="j" kp="0"/><motor name="thruster" site="fixed" gear="0 0 1 0 1 0"/>
  </actuator></mujoco>"#,
    );
    let notes = ["acts on a constant length", "acts on a body that is fixed to the ground"];
    check_conversion_with_notes("mjcf", &file, "", &notes);
    let inertial_element = |xx: &str, xy: &str| {
        format!(
            "<inertial><mass value='2'/><inertia ixx='{xx}' iyy='1' izz='1' ixy='{xy}' ixz='0' iyz='0'/>\
             </inertial>"
        )
    };
    for (name, inertia) in
        [("diagonal.urdf", inertial_element("-0.1", "0")), ("full.urdf", inertial_element("-0.1", "-0.2"))]
    {
        let file = write_test_file(
            name,
            &format!(
                "<robot name='r'><link name='a'/><link name='b'>{inertia}</link>\
                 <joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 1 1'/>\
                 </joint></robot>"
            ),
        );
        check_conversion("urdf", &file, "inertia = trust");
    }
}

/// Checks names that are not valid field names, and names of motors.
#[test]
fn changed_names_of_converted_elements_are_reported() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("renamed");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("arm.urdf");
    let inertial =
        "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let joint_element = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/>\
             <axis xyz='0 0 1'/></joint>"
        )
    };
    let arm = format!(
        "<robot name='arm'><link name='world'/><link name='Upper-arm'>{inertial}</link>\
         <link name='hand'>{inertial}</link>{}{}</robot>",
        joint_element("shoulder", "world", "Upper-arm"),
        joint_element("hand", "Upper-arm", "hand")
    );
    std::fs::write(&file, arm).unwrap();
    let (code, stderr) = convert_file(&file, "");
    let all = [
        ("link `world`", "world_link"),
        ("link `Upper-arm`", "upper_arm"),
        ("joint `hand`", "hand_joint"),
        ("input `shoulder`", "shoulder_motor"),
        ("input `hand`", "hand_joint_motor"),
    ];
    for (what, field) in all {
        assert!(code.contains(&format!("/// - {what} is `{field}`\n")), "{code}");
        assert!(code.contains(&format!("    {field}: ")), "{code}");
    }
    let shown: Vec<String> = all[..4].iter().map(|(what, field)| format!("{what} is `{field}`")).collect();
    let expected = format!(
        "linkwork: names that differ from the file: {}, and 1 more that the struct's documentation lists\n",
        shown.join(", ")
    );
    assert_eq!(stderr, expected);
    // Elements that retain their names are not mentioned.
    let (code, stderr) = convert_file(&file, "inputs = none, lock = [\"hand\", \"shoulder\"], base = free");
    assert!(!stderr.contains("shoulder") && !code.contains("shoulder` is"), "{stderr}{code}");
}

/// Checks that the coordinates at which a file places its bodies are listed: structs have none, and their
/// simulations begin in the neutral configuration.
#[test]
fn initial_coordinates_of_converted_files_are_listed() {
    let file = write_test_file(
        "placed.xml",
        r#"<mujoco><worldbody><body pos="1 2 3"><freejoint name="float"/>
        <geom type="sphere" size="0.1"/></body><body><joint name="hinge" type="hinge" ref="30"/>
        <geom type="box" size="0.1 0.1 0.1" pos="0.5 0 0"/></body></worldbody></mujoco>"#,
    );
    let (code, stderr) = convert_file(&file, "contacts = ignore");
    let angle = 30_f64.to_radians();
    let expected = format!(
        "initial coordinates of 2 joints, which programs pass to `from` of a simulation: \
         `float` 1 2 3 0 0 0 1, `hinge` {angle}\n"
    );
    assert!(code.contains(&format!("/// - {expected}")), "{code}");
    assert!(stderr.contains(&format!("linkwork: {expected}")), "{stderr}");
}

#[test]
fn inconvertible_elements_are_reported() {
    let run_command_line = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_linkwork")).args(arguments).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (status, stderr) = run_command_line(&["convert", file!(), "--struct", "None"]);
    assert!(status == Some(2), "{stderr}");
    let panda = repository_folder().join("models/urdf/panda.urdf");
    let (status, stderr) = run_command_line(&["convert", panda.to_str().unwrap()]);
    assert!(
        status == Some(0) && stderr.contains("follows `panda_finger_joint1` by a constraint"),
        "{stderr}"
    );
    let (status, stderr) = run_command_line(&["convert", panda.to_str().unwrap(), "--out", "panda.sdf"]);
    assert!(status == Some(2) && stderr.contains("a file that ends in .rs, not panda.sdf"), "{stderr}");
}

/// Checks that `convert` rejects what `check` rejects, with the same messages: errors that only the whole
/// mechanism shows, such as limits of a mimic joint and its leader that exclude every value, and a massless
/// end link.
#[test]
fn convert_rejects_mechanisms_that_check_rejects() {
    let inertial = "<inertial><mass value='1'/>\
        <inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let alone = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
    let two_joint_file = |name: &str, tip: &str, limits: &str| {
        let revolute_joint_element = |name: &str, parent: &str, child: &str, limits: &str| {
            format!(
                "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/>\
                 {limits}</joint>"
            )
        };
        let joints =
            revolute_joint_element("j", "base", "a", alone) + &revolute_joint_element("k", "a", "b", limits);
        let links = format!("<link name='base'/><link name='a'>{inertial}</link><link name='b'>{tip}</link>");
        write_test_file(name, &format!("<robot name='two'>{links}{joints}</robot>"))
    };
    let far = format!("<mimic joint='j' multiplier='2' offset='5'/>{alone}");
    let near = format!("<mimic joint='j' multiplier='2' offset='2'/>{alone}");
    for (name, tip, limits, expected) in [
        ("far.urdf", inertial, far.as_str(), Some("the limits of `j` exclude every value")),
        ("near.urdf", inertial, &near, None),
        ("massless.urdf", "", alone, Some("singular")),
    ] {
        let file = two_joint_file(name, tip, limits);
        let run_command = |command: &str| {
            let mut of = Command::new(env!("CARGO_BIN_EXE_linkwork"));
            let output = of.arg(command).arg(&file).output().unwrap();
            (output.status.success(), String::from_utf8(output.stderr).unwrap())
        };
        let (check, convert) = (run_command("check"), run_command("convert"));
        assert_eq!(check.0, expected.is_none(), "{check:?}");
        assert_eq!(convert.0, check.0, "{convert:?}");
        if let Some(expected) = expected {
            assert!(check.1.contains(expected) && convert.1.contains(expected), "{check:?} {convert:?}");
        }
    }
}
