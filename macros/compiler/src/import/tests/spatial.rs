//! Tests of spatial tendons and of actuators on sites in MJCF files.

use super::mjcf::mjcf_options;
use super::*;

/// Returns a file with a body, sites, a sphere, a cylinder and these tendons and actuators.
fn model_with_tendon(tendon: &str, actuator: &str) -> String {
    format!(
        "<mujoco><compiler angle='radian'/><worldbody><site name='w' pos='0 0 1'/><body name='b' pos='0 0 2'>\
         <joint name='j' axis='0 1 0' springref='1'/><site name='s' pos='3 0 0'/><site name='side' pos='-1 0 9'/>\
         <geom name='ball' size='.5' mass='0'/><geom name='drum' type='cylinder' size='.5 1' zaxis='0 1 0' mass='0'/>\
         <geom name='box' type='box' size='1 1 1' mass='0'/></body></worldbody>\
         <tendon>{tendon}</tendon><actuator>{actuator}</actuator></mujoco>"
    )
}

/// Returns the lines of the result that describe forces, or the errors.
fn force_lines_of_import(tendon: &str, actuator: &str) -> Vec<String> {
    let text = import_as_text(&mjcf_options(), &model_with_tendon(tendon, actuator));
    let is_force_or_message_line =
        |line: &&str| line.contains(" on ") || line.contains("r.xml") || line.contains("help");
    text.lines().filter(is_force_or_message_line).map(|line| line.trim().to_string()).collect()
}

/// Returns the forces of a motor that pulls a cable from the wall to the site `s`.
fn imported_cable_motor_forces(around: &str) -> Vec<String> {
    let tendon = format!("<spatial name='t'><site site='w'/>{around}<site site='s'/></spatial>");
    force_lines_of_import(&tendon, "<motor tendon='t' name='m'/>")
}

#[test]
fn spatial_tendon_paths_become_cable_lengths() {
    let ends = "ground.at([0, 0, 1]) / b.at([3, 0, 0])";
    assert_eq!(imported_cable_motor_forces(""), [format!("m: input in N on norm(r(({ends})))")]);
    assert_eq!(
        imported_cable_motor_forces("<geom geom='ball'/>"),
        [format!("m: input in N on cable(({ends}), b.sphere(0.5))")]
    );
    let expected_cable_expression = |sign: &str| format!("cable(({ends}), b.cylinder(0.5, [0, {sign}1, 0]))");
    assert_eq!(
        imported_cable_motor_forces("<geom geom='drum'/>"),
        [format!(
            "m: input in N on min({}, {})",
            expected_cable_expression(""),
            expected_cable_expression("-")
        )]
    );
    // Viewed along y, the cable runs clockwise from below the drum over its upper side to the right.
    assert_eq!(
        imported_cable_motor_forces("<geom geom='drum' sidesite='side'/>"),
        [format!("m: input in N on {}", expected_cable_expression(""))]
    );
}

/// A pulley divides the length after it by its divisor; a gear ratio multiplies the whole length.
#[test]
fn pulleys_and_gears_scale_tendon_lengths() {
    let tendon = "<spatial name='t'><site site='w'/><site site='s'/><pulley divisor='4'/><site site='w'/>\
                  <site site='side'/></spatial>";
    let expected_length_expression = |end: &str| format!("norm(r((ground.at([0, 0, 1]) / b.at([{end}]))))");
    assert_eq!(
        force_lines_of_import(tendon, "<motor tendon='t' name='m' gear='3'/>"),
        [format!(
            "m: input in N on (3 * ({} + (0.25 * {})))",
            expected_length_expression("3, 0, 0"),
            expected_length_expression("-1, 0, 9")
        )]
    );
}

/// The free length is the length with all joint springs relaxed: here `s` is rotated by 1 rad about y.
#[test]
fn tendon_springs_are_relaxed_with_relaxed_joints() {
    let drives_with_spring = |more: &str| {
        force_lines_of_import(
            &format!("<spatial name='t' stiffness='5' {more}><site site='w'/><site site='s'/></spatial>"),
            "",
        )
    };
    let found = drives_with_spring("");
    let free: f64 = found[0].split(' ').nth(4).and_then(|text| text.parse().ok()).expect("a number");
    let (sine, cosine) = 1.0_f64.sin_cos();
    assert!((free - (3.0 * cosine).hypot(1.0 - 3.0 * sine)).abs() < 1e-14, "{found:?}");
    assert!(drives_with_spring("springlength='.2'")[0].starts_with("t: spring 5 from 0.2 on norm("));
    assert!(
        drives_with_spring("springlength='.2 .3'")[0]
            .starts_with("t: spring 5 outside of 0.2 to 0.3 on norm(")
    );
    let all = drives_with_spring("damping='2' frictionloss='3' armature='4' springlength='1'");
    let laws: Vec<&str> = all.iter().filter_map(|line| line.split(" on ").next()).collect();
    assert_eq!(laws, ["t: inerter 4", "t: spring 5 from 1", "t: damper 2", "t: friction 3"]);
}

#[test]
fn site_actuators_apply_forces_and_torques() {
    let drives_with_site_motor =
        |words: &str| force_lines_of_import("", &format!("<motor name='m' site='s' {words}/>"));
    assert_eq!(
        drives_with_site_motor("gear='1 2 0 0 0 3'"),
        ["m: input in N on b.at([3, 0, 0]) by 1 2 0, 0 0 3"]
    );
    assert_eq!(
        drives_with_site_motor("refsite='w' gear='1 0 -2'"),
        ["m: input in N on dot(r((b.at([3, 0, 0]) / ground.at([0, 0, 1]))), ((1 * ground.x) + (-2 * \
          ground.z)))"]
    );
    assert_eq!(
        drives_with_site_motor("refsite='w' gear='0 0 0 0 1 0'"),
        ["m: input in N·m on b.at([3, 0, 0]) by 0 0 0, 0 1 0 against ground.at([0, 0, 1])"]
    );
    // The length of an actuator on a single site is zero: a servo's spring reduces to its constant force.
    assert_eq!(
        force_lines_of_import("", "<general name='m' site='s' biastype='affine' biasprm='4 -5 -6'/>"),
        [
            "m: input in any on b.at([3, 0, 0]) by 1 0 0, 0 0 0",
            "m: push 4 on b.at([3, 0, 0]) by 1 0 0, 0 0 0",
            "m: damper 6 on b.at([3, 0, 0]) by 1 0 0, 0 0 0"
        ]
    );
}

/// Unsupported paths are accepted if nothing acts on the tendon.
#[test]
fn unsupported_tendon_paths_are_reported_only_if_used() {
    let side =
        "<spatial name='t'><site site='w'/><geom geom='ball' sidesite='side'/><site site='s'/></spatial>";
    assert_eq!(force_lines_of_import(side, ""), Vec::<String>::new());
    let assert_message_found = |found: Vec<String>, message: &str| {
        let found = found.join("\n");
        assert!(found.contains(message), "{found}");
    };
    let inputs = "= help: to ignore the actuators of the file, write";
    assert_message_found(
        force_lines_of_import(side, "<motor tendon='t'/>"),
        "the side on which a tendon passes the sphere `ball` is not supported",
    );
    assert_message_found(force_lines_of_import(side, "<motor tendon='t'/>"), inputs);
    assert_message_found(
        imported_cable_motor_forces("<geom geom='box'/>"),
        "a tendon wraps around spheres and cylinders, but `box` is neither",
    );
    assert_message_found(imported_cable_motor_forces("<geom geom='bal'/>"), "unknown geom `bal`");
    assert_message_found(
        imported_cable_motor_forces("<geom geom='ball'/><geom geom='drum'/>"),
        "a tendon runs around a shape between two sites",
    );
    assert_message_found(imported_cable_motor_forces("<site site='x'/>"), "unknown site `x`");
    assert_message_found(
        imported_cable_motor_forces("<site site='s'/><pulley divisor='0'/><site site='w'/>"),
        "a pulley with the divisor 0",
    );
    assert_message_found(imported_cable_motor_forces("<wheel/>"), "unknown element `<wheel>`");
    assert_message_found(
        force_lines_of_import("", "<motor site='w' refsite='s'/>"),
        "a `refsite` that does not carry the site `w` is not supported",
    );
    assert_message_found(
        force_lines_of_import("", "<position site='s' refsite='w' kp='1' gear='0 0 0 1 0 0'/>"),
        "a servo on the orientation of a site is not supported",
    );
    assert_message_found(
        force_lines_of_import("", "<motor body='b'/>"),
        "an actuator on no joint, tendon or site is not supported",
    );
    assert_message_found(
        force_lines_of_import("", "<muscle joint='j'/>"),
        "a muscle without `force` is not supported",
    );
    assert_message_found(
        force_lines_of_import("", "<muscle joint='j' force='1'/>"),
        "a muscle without `lengthrange` is not supported",
    );
    assert_message_found(
        force_lines_of_import("", "<muscle joint='j' force='1' lengthrange='0 1' lmin='2'/>"),
        "a muscle needs an increasing `range`, lmin < 1 < lmax, vmax > 0 and fvmax > 1",
    );
    assert_message_found(
        force_lines_of_import("", "<pid joint='j' ki='1' imax='2'/>"),
        "`imax` is not supported: the rate of its state is not continuous",
    );
    assert_message_found(
        force_lines_of_import("", "<pid joint='j' input='vel pos'/>"),
        "`input` `vel pos` is not a list of inputs",
    );
    assert_message_found(
        force_lines_of_import("", "<pid joint='j' ki='1' input='vel'/>"),
        "`ki` without the input `pos`",
    );
    assert_message_found(
        force_lines_of_import("", "<dcmotor joint='j' motorconst='1'/>"),
        "a motor needs a positive `resistance`, or `nominal` values from which it follows",
    );
    assert_message_found(
        force_lines_of_import("", "<dcmotor joint='j' resistance='1' motorconst='1' controller='1'/>"),
        "the gains of `controller` have no effect without an input that it controls",
    );
    assert_message_found(
        force_lines_of_import("", "<general joint='j' dyntype='pid'/>"),
        "`pid` with other types",
    );
}
