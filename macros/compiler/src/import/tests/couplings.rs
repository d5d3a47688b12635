//! Tests of actuators and couplings of joints in MJCF files.

use super::mjcf::{check_import_of_mjcf_elements, mjcf_options};
use super::*;
use crate::syntax::Key;

#[test]
fn position_servos_become_inputs_with_springs() {
    check_import_of_mjcf_elements(
        "<worldbody><body name='b'><joint name='j'/></body></worldbody><actuator>
         <motor name='m' joint='j' gear='5'/> <position joint='j' kp='4' gear='2'/>
         <general name='g' joint='j' gainprm='3' biastype='affine' biasprm='1 0 -2'/></actuator>",
        "the root is the ground
         body b
         Pin j: ground -> b about [0, 0, 1]
         m: input in N·m on 5 j
         j_position: input in rad on 8 j
         j_position: spring 4 from 0 on 2 j
         g: input in any on 3 j
         g: push 1 on 1 j
         g: damper 2 on 1 j",
    );
}

#[test]
fn coupled_joints_follow_or_are_locked() {
    let model_with_equality = |equality: &str| {
        format!(
            "<worldbody><body name='b'><joint name='j' type='slide' ref='1'/><body name='c'><joint name='k' type='slide' ref='2'/>\
             </body></body></worldbody><equality>{equality}</equality>"
        )
    };
    check_import_of_mjcf_elements(
        &model_with_equality("<joint joint1='k' joint2='j' polycoef='5 -3'/>"),
        "the root is the ground
         body b
         body c
         Sleeve j: ground.at([0, 0, -1]) -> b along [0, 0, 1]
         Sleeve k: b.at([0, 0, -2]) -> c along [0, 0, 1] = -3 j + 10",
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<joint joint1='k' polycoef='5'/>"),
        "the root is the ground
         body b
         body c
         Sleeve j: ground.at([0, 0, -1]) -> b along [0, 0, 1]
         Weld k: b.at([0, 0, 5]) -> c",
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<joint joint1='k' joint2='jj'/>"),
        "r.xml:2:180: unknown joint `jj`
         = help: did you mean `j`?",
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<flex flex='b'/>"),
        "r.xml:2:154: the coupling `<flex>` is not supported
         = help: to ignore `<equality>`, write `#[mechanism(…, mimic = independent)]`",
    );
}

#[test]
fn linear_and_polynomial_couplings_become_constraints() {
    let model_with_equality = |equality: &str| {
        format!(
            "<worldbody><body name='b'><joint name='j' type='slide' ref='1'/><body name='c'><joint name='k' type='slide' ref='2'/>\
             </body></body></worldbody><tendon><fixed name='s'><joint joint='j' coef='2'/><joint joint='k' coef='4'/></fixed>\
             <fixed name='t'><joint joint='k' coef='3'/></fixed></tendon><equality>{equality}</equality>"
        )
    };
    let expected_bodies_and_joints = |follows: &str| {
        format!(
            "the root is the ground
         body b
         body c
         Sleeve j: ground.at([0, 0, -1]) -> b along [0, 0, 1]
         Sleeve k: b.at([0, 0, -2]) -> c along [0, 0, 1]{follows}"
        )
    };
    // 2 (j − 1) + 4 (k − 2) = 6
    check_import_of_mjcf_elements(
        &model_with_equality("<tendon tendon1='s' polycoef='6'/>"),
        &expected_bodies_and_joints(" = -0.5 j + 4"),
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<tendon name='w' tendon1='s' tendon2='t' polycoef='5 6 7'/>"),
        &format!(
            "{}\nw: ((-10 + (2 * j)) + (4 * k)) = (5 + ((6 + (7 * (-6 + (3 * k)))) * (-6 + (3 * k))))",
            expected_bodies_and_joints("")
        ),
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<joint joint1='j' joint2='k' polycoef='0 0 1'/>"),
        &format!(
            "{}\njoint_coupling: (-1 + (1 * j)) = (0 + ((0 + (1 * (-2 + (1 * k)))) * (-2 + (1 * k))))",
            expected_bodies_and_joints("")
        ),
    );
    // Two constraints on one joint.
    check_import_of_mjcf_elements(
        &model_with_equality("<joint joint1='k' joint2='j'/><tendon tendon1='s'/>"),
        &format!(
            "{}\ntendon_coupling: ((-10 + (2 * j)) + (4 * k)) = 0",
            expected_bodies_and_joints(" = 1 j + 1")
        ),
    );
    let help = "= help: to ignore `<equality>`, write `#[mechanism(…, mimic = independent)]`";
    for (equality, expected) in [
        (
            "<tendon tendon1='v'/>",
            "r.xml:2:409: unknown tendon `v`\n= help: expected `s`, `t` or `u`".to_string(),
        ),
        (
            "<tendon tendon1='u'/>",
            format!("r.xml:2:409: tendon `u` is spatial and cannot be coupled\n{help}"),
        ),
    ] {
        let cable = "<spatial name='u'><site site='o'/><site site='p'/></spatial></tendon>";
        let sites = "<worldbody><site name='o'/><site name='p'/>";
        let model = model_with_equality(equality)
            .replace("<worldbody>", sites)
            .replace("</tendon><eq", &format!("{cable}<eq"));
        check_import_of_mjcf_elements(&model, &expected);
    }
}

/// Gains and biases as in MuJoCo 4.0.0 (`actuator_gainprm`, `actuator_biasprm`). A shortcut takes the
/// defaults of the same shortcut, or of `<general>` with a constant gain, in the nearest class that has them.
/// No shortcut takes the constant force of a bias.
#[test]
fn actuator_defaults_of_a_class_form_one_record() {
    for (defaults, actuator, expected) in [
        (
            "<general gainprm='400' biasprm='1 -300 -20'/>",
            "<position",
            "input 400, spring 400 from 0, damper 20",
        ),
        (
            "<general gainprm='400' biasprm='1 -300 -20'/>",
            "<position kp='2'",
            "input 2, spring 2 from 0, damper 20",
        ),
        ("<general gainprm='400' biasprm='1 -300 -20'/>", "<velocity", "input 400, damper 400"),
        ("<general gainprm='400' biasprm='1 -300 -20' biastype='affine'/>", "<motor", "input 1"),
        ("<general gainprm='400' gaintype='affine'/>", "<position", "input 1, spring 1 from 0"),
        ("<position kp='7' kv='3'/>", "<motor", "input 1"),
        ("<position kp='7' kv='3'/>", "<velocity", "input 1, damper 1"),
        ("<position kp='7' kv='3'/>", "<general", "input 7, spring 7 from 0, damper 3"),
        ("<position kp='7' kv='3'/>", "<general gainprm='2'", "input 2, spring 7 from 0, damper 3"),
        (
            "<position kp='7' kv='2'/><general biasprm='1'/>",
            "<general",
            "input 7, spring 7 from 0.14285714285714285, damper 2",
        ),
        (
            "<position kp='7' kv='2'/><general biasprm='1'/>",
            "<position",
            "input 7, spring 7 from 0, damper 2",
        ),
        ("<position kp='7' kv='2'/><motor gear='2'/>", "<position", "input 2, spring 1 from 0"),
        ("<muscle/>", "<position", "input 1, spring 1 from 0"),
        (
            "<position kp='7' kv='3'/><default class='a'><velocity kv='9'/></default>",
            "<position class='a'",
            "input 7, spring 7 from 0, damper 3",
        ),
        (
            "<position kp='7' kv='3'/><default class='a'><position kv='9'/></default>",
            "<position class='a'",
            "input 7, spring 7 from 0, damper 9",
        ),
        ("<position kp='7' kv='3'/><default class='a'><motor/></default>", "<general class='a'", "input 1"),
        ("<position kp='7' dampratio='1'/>", "<position kv='2'", "input 7, spring 7 from 0, damper 2"),
        ("<motor gear='3 4'/>", "<motor gear='5'", "input 5"),
    ] {
        let text = format!(
            "<mujoco><default>{defaults}</default><worldbody><body><joint name='j'/></body></worldbody>\
             <actuator>{actuator} joint='j'/></actuator></mujoco>"
        );
        let mut cx = Diagnostics::new();
        let imported = import_text(&text, &mjcf_options(), &mut cx)
            .unwrap_or_else(|| panic!("{:?}", cx.full_message_texts()));
        let laws = imported.drives.iter().map(|drive| match (&drive.on, &drive.law) {
            (FileForceTarget::Sum(terms), FileForceLaw::Input(_)) => format!("input {}", terms[0].1),
            (_, FileForceLaw::Spring { stiffness, free }) => format!("spring {stiffness} from {free}"),
            (_, FileForceLaw::Damper(damping)) => format!("damper {damping}"),
            other => panic!("{other:?}"),
        });
        assert_eq!(laws.collect::<Vec<_>>().join(", "), expected, "{defaults} {actuator}");
    }
}

#[test]
fn attributes_of_newer_mujoco_versions_are_rejected() {
    let model_with_joint_and_motor = |joint: &str, motor: &str| {
        format!(
            "<worldbody><body name='b'><joint name='j' {joint}/></body></worldbody>\
             <actuator><motor name='m' joint='j' {motor}/></actuator>"
        )
    };
    let passive =
        "= help: to ignore springs, damping and friction, write `#[mechanism(…, passive = ignore)]`";
    let inputs =
        "= help: to ignore the actuators of the file, write `#[mechanism(…, inputs = joints)]`, or `none`";
    for (joint, motor, expected) in [
        (
            "type='ball' damping='5 2 1'",
            "",
            format!(
                "r.xml:2:64: a polynomial `damping` is supported only on a `hinge` or a `slide`\n= help: \
                 expected one number: a linear coefficient\n{passive}\nr.xml:2:124: joint `j` is `ball`: a \
                 joint with several coordinates cannot drive\n= help: expected a `hinge` or a `slide`"
            ),
        ),
        (
            "stiffness='5' springyield='1'",
            "",
            format!(
                "r.xml:2:70: `springyield` is not supported: a spring that yields has a state of its own\n\
                 {passive}"
            ),
        ),
        ("", "delay='0.1'", format!("r.xml:2:107: `delay` of an actuator is not supported\n{inputs}")),
    ] {
        check_import_of_mjcf_elements(&model_with_joint_and_motor(joint, motor), &expected);
    }
}

#[test]
fn connect_and_weld_constraints_close_loops() {
    let model_with_equality = |equality: &str| {
        format!(
            "<worldbody><body name='b' pos='1 0 0' euler='90 0 0'/><body name='c' mocap='true'/><body name='d' pos='0 0 2'>\
             <site name='s' pos='0 0 3'/></body></worldbody><equality>{equality}</equality>"
        )
    };
    let start = "the root is the ground
         body b
         body c
         body d
         body s
         Weld b_weld: ground.at([1, 0, 0]).rotated(x(1.5707963267948966)) -> b
         Weld c_weld: ground -> c
         Weld d_weld: ground.at([0, 0, 2]) -> d
         Weld s_weld: d.at([0, 0, 3]) -> s";
    check_import_of_mjcf_elements(
        &model_with_equality("<connect body1='b' body2='d' anchor='1 2 4'/>"),
        &format!("{start}\nBall connect1: b.at([1, 2, 4]) -> d.at([2, -4, 0])"),
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<weld body1='d'/>"),
        &format!("{start}\nWeld weld1: d.at([0, 0, -2]) -> ground"),
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<weld name='w' body1='d' relpose='1 2 3 1 0 0 0' body2='b'/>"),
        &format!("{start}\nWeld w: d.at([1, 2, 3]) -> b"),
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<connect site1='s' site2='s'/>"),
        "r.xml:2:194: body `d` closes a loop with itself
         = help: to ignore `<equality>`, write `#[mechanism(…, mimic = independent)]`",
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<weld body1='c' body2='b'/>"),
        "r.xml:2:181: `c` is a mocap body, which does not move here
         = help: to ignore `<equality>`, write `#[mechanism(…, mimic = independent)]`",
    );
    check_import_of_mjcf_elements(
        &model_with_equality("<weld body1='e'/>"),
        "r.xml:2:181: unknown body `e`
         = help: expected `b`, `c` or `d`",
    );
}

/// The rotor inertia and viscous damping of an actuator are multiplied by the square of the gear ratio. They
/// act even if actuators are not imported.
#[test]
fn rotor_inertia_is_scaled_by_the_squared_gear_ratio() {
    let model = "<worldbody><body name='b'><joint name='j'/></body></worldbody>
         <actuator><motor name='m' joint='j' gear='3' armature='0.5' damping='0.2'/></actuator>";
    check_import_of_mjcf_elements(
        model,
        "the root is the ground
         body b
         Pin j: ground -> b about [0, 0, 1]
         j: damper 0.2 on 3 j
         j: inerter 0.5 on 3 j
         m: input in N·m on 3 j",
    );
    check_import_with_options(
        &FileOptions { inputs: FileInputSource::Joints, ..mjcf_options() },
        &format!("<mujoco>\n{model}\n</mujoco>"),
        "the root is the ground
         body b
         Pin j: ground -> b about [0, 0, 1] driven
         j: damper 0.2 on 3 j
         j: inerter 0.5 on 3 j
         left out 1 actuators",
    );
}

/// Checks that the maximum effort of a joint is the sum over its actuators, or unlimited if one of them has
/// no limit, and at most the joint's own limit.
#[test]
fn joint_effort_is_the_sum_over_actuators() {
    let site = "<motor site='s' gear='0 0 1' ctrlrange='-1 1'/>";
    for (joint, actuators, expected) in [
        (
            "",
            "<motor joint='j' ctrlrange='-10 10'/><motor joint='j' gear='2' forcerange='-15 15'/>",
            Some(40.0),
        ),
        ("", "<motor joint='j' ctrlrange='-10 10'/><motor joint='j'/>", None),
        ("", "<motor joint='j'/><motor joint='j' ctrlrange='-10 10'/>", None),
        (
            "",
            "<motor joint='j' ctrlrange='-10 10' forcerange='-4 8'/><position joint='j' forcerange='-3 3'/>",
            Some(11.0),
        ),
        ("", "<motor joint='j' ctrlrange='-10 10'/><motor tendon='t' ctrlrange='-1 1'/>", Some(12.0)),
        ("", "<motor joint='j' ctrlrange='-10 10'/><position joint='j' ctrlrange='-1 1'/>", None),
        ("", &format!("<motor joint='j' ctrlrange='-10 10'/>{site}"), None),
        (
            "actuatorfrcrange='-25 25'",
            "<motor joint='j' ctrlrange='-10 10'/><motor joint='j' gear='2' forcerange='-15 15'/>",
            Some(25.0),
        ),
        ("actuatorfrcrange='-25 25'", "<motor joint='j'/>", Some(25.0)),
        ("actuatorfrcrange='0 0'", "<motor joint='j' ctrlrange='-3 1'/>", Some(3.0)),
    ] {
        let text = format!(
            "<mujoco><worldbody><body><joint name='j' {joint}/><site name='s'/></body></worldbody>\
             <tendon><fixed name='t'><joint joint='j' coef='-2'/></fixed></tendon><actuator>{actuators}</actuator></mujoco>"
        );
        let mut cx = Diagnostics::new();
        let imported = import_text(&text, &mjcf_options(), &mut cx)
            .unwrap_or_else(|| panic!("{:?}", cx.full_message_texts()));
        let effort = imported
            .limits
            .iter()
            .find_map(|limit| limit.arguments.expression_of_key(Key::MaxEffort)?.literal_number());
        assert_eq!(effort, expected, "{joint} {actuators}");
    }
}

#[test]
fn disabled_actuators_create_no_inputs() {
    let model_with_option = |option: &str| {
        format!(
            "<option {option}/><worldbody><body name='b'><joint name='j'/></body></worldbody>
             <actuator><motor name='m' joint='j' group='3' armature='0.5'/><motor name='n' joint='j'/></actuator>"
        )
    };
    check_import_of_mjcf_elements(
        &model_with_option("actuatorgroupdisable='1 3'"),
        "the root is the ground
         body b
         Pin j: ground -> b about [0, 0, 1]
         j: inerter 0.5 on 1 j
         n: input in N·m on 1 j
         left out actuators of disabled groups: 1",
    );
    check_import_of_mjcf_elements(
        &model_with_option("actuatorgroupdisable='1 31'"),
        "r.xml:2:31: `actuatorgroupdisable` is `1 31`
         = help: expected numbers of groups from 0 to 30",
    );
}

/// Checks that the free lengths of fixed tendons are those of MuJoCo 4.0.0 (`tendon_lengthspring`). The
/// spring of the joint is relaxed at 17°.
#[test]
fn tendon_springs_have_the_rest_lengths_of_mujoco() {
    let rest = 2.0 * 17.0_f64.to_radians();
    for (length, expected) in [
        ("-0.3", "spring 10 from -0.3".to_string()),
        ("-1", format!("spring 10 from {rest}")),
        ("-1 -1", format!("spring 10 from {rest}")),
        ("-1 2", "spring 10 outside of -1 to 2".to_string()),
        ("-0.3 0.3", "spring 10 outside of -0.3 to 0.3".to_string()),
        ("-0.5 -0.2", "spring 10 outside of -0.5 to -0.2".to_string()),
        ("0", "spring 10 from 0".to_string()),
        ("-1.5", "spring 10 from -1.5".to_string()),
    ] {
        check_import_of_mjcf_elements(
            &format!(
                "<default><tendon springlength='0.1 0.5'/></default>
                 <worldbody><body name='b'><joint name='j' springref='17'/></body></worldbody>\
                 <tendon><fixed name='t' stiffness='10' springlength='{length}'><joint joint='j' coef='2'/></fixed></tendon>"
            ),
            &format!("the root is the ground\nbody b\nPin j: ground -> b about [0, 0, 1]\nt: {expected} on 2 \
                      j"),
        );
    }
}

/// `relpose` is the pose of the second body's anchor relative to the first body.
#[test]
fn weld_with_anchor_has_the_relative_pose_of_the_file() {
    let model_with_weld = |said: &str| {
        format!(
            "<worldbody><body name='a'><joint name='j' type='slide'/></body><body name='b' pos='1 0 0'><joint name='k' type='slide'/>\
             </body></worldbody><equality><weld body1='a' body2='b' {said}/></equality>"
        )
    };
    for (said, ends) in [
        ("anchor='0.2 0 0' relpose='0.5 0 0 1 0 0 0'", "a.at([0.5, 0, 0]) -> b.at([0.2, 0, 0])"),
        ("relpose='0.5 0 0 0 1 0 0'", "a.at([0.5, 0, 0]).rotated(x(3.141592653589793)) -> b"),
        ("anchor='0.2 0 0'", "a.at([1, 0, 0]) -> b"),
        ("anchor='0.2 0 0' relpose='0.5 0 0 0 0 0 0'", "a.at([1, 0, 0]) -> b"),
    ] {
        check_import_of_mjcf_elements(
            &model_with_weld(said),
            &format!(
                "the root is the ground\nbody a\nbody b\nSleeve j: ground -> a along [0, 0, 1]
                 Sleeve k: ground.at([1, 0, 0]) -> b along [0, 0, 1]\nWeld weld1: {ends}"
            ),
        );
    }
}

/// Checks that a coupling that contradicts earlier ones is reported, and that a coupling of fixed joints that
/// is satisfied is dropped.
#[test]
fn contradictory_couplings_of_fixed_joints_are_reported() {
    let model_with_last_coupling = |last: &str| {
        format!(
            "<worldbody><body name='b'><joint name='j' type='slide'/><body name='c'><joint name='k' type='slide'/></body></body></worldbody>
             <equality><joint name='e' joint1='j' polycoef='1'/><joint name='f' joint1='k' joint2='j'/>{last}</equality>"
        )
    };
    check_import_of_mjcf_elements(
        &model_with_last_coupling("<joint name='g' joint1='k' polycoef='3'/>"),
        "r.xml:3:117: the coupling `g` contradicts others: the joints that it couples cannot move, and it is violated by -2
         = help: remove it, or the constraints that fix these joints",
    );
    check_import_of_mjcf_elements(
        &model_with_last_coupling("<joint name='g' joint1='k' polycoef='1'/>"),
        "the root is the ground
         body b
         body c
         Weld j: ground.at([0, 0, 1]) -> b
         Weld k: b.at([0, 0, 1]) -> c",
    );
}
