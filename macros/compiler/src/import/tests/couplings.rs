//! MJCF: actuators, and what binds joints.

use super::mjcf::check_model;

#[test]
fn servos_are_inputs_with_springs() {
    check_model(
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
fn a_joint_follows_or_is_held() {
    let model = |equality: &str| {
        format!(
            "<worldbody><body name='b'><joint name='j' type='slide' ref='1'/><body name='c'><joint name='k' type='slide' ref='2'/>\
             </body></body></worldbody><equality>{equality}</equality>"
        )
    };
    check_model(
        &model("<joint joint1='k' joint2='j' polycoef='5 -3'/>"),
        "the root is the ground
         body b
         body c
         Sleeve j: ground.at([0, 0, -1]) -> b along [0, 0, 1]
         Sleeve k: b.at([0, 0, -2]) -> c along [0, 0, 1] = -3 j + 10",
    );
    check_model(
        &model("<joint joint1='k' polycoef='5'/>"),
        "the root is the ground
         body b
         body c
         Sleeve j: ground.at([0, 0, -1]) -> b along [0, 0, 1]
         Weld k: b.at([0, 0, 5]) -> c",
    );
    check_model(
        &model("<joint joint1='k' joint2='jj'/>"),
        "r.xml:2:180: unknown joint `jj`
         = help: did you mean `j`?",
    );
    check_model(
        &model("<flex flex='b'/>"),
        "r.xml:2:154: the coupling `<flex>` is not supported
         = help: to leave `<equality>` out, write `#[mechanism(…, mimic = independent)]`",
    );
}

#[test]
fn sums_and_polynomials_are_conditions() {
    let model = |equality: &str| {
        format!(
            "<worldbody><body name='b'><joint name='j' type='slide' ref='1'/><body name='c'><joint name='k' type='slide' ref='2'/>\
             </body></body></worldbody><tendon><fixed name='s'><joint joint='j' coef='2'/><joint joint='k' coef='4'/></fixed>\
             <fixed name='t'><joint joint='k' coef='3'/></fixed><spatial name='u'/></tendon><equality>{equality}</equality>"
        )
    };
    let start = |follows: &str| {
        format!(
            "the root is the ground
         body b
         body c
         Sleeve j: ground.at([0, 0, -1]) -> b along [0, 0, 1]
         Sleeve k: b.at([0, 0, -2]) -> c along [0, 0, 1]{follows}"
        )
    };
    // 2 (j − 1) + 4 (k − 2) = 6
    check_model(&model("<tendon tendon1='s' polycoef='6'/>"), &start(" = -0.5 j + 4"));
    check_model(
        &model("<tendon name='w' tendon1='s' tendon2='t' polycoef='5 6 7'/>"),
        &format!(
            "{}\nw: ((-10 + (2 * j)) + (4 * k)) = (5 + ((6 + (7 * (-6 + (3 * k)))) * (-6 + (3 * k))))",
            start("")
        ),
    );
    check_model(
        &model("<joint joint1='j' joint2='k' polycoef='0 0 1'/>"),
        &format!(
            "{}\njoint_coupling: (-1 + (1 * j)) = (0 + ((0 + (1 * (-2 + (1 * k)))) * (-2 + (1 * k))))",
            start("")
        ),
    );
    // Two conditions on one joint.
    check_model(
        &model("<joint joint1='k' joint2='j'/><tendon tendon1='s'/>"),
        &format!("{}\ntendon_coupling: ((-10 + (2 * j)) + (4 * k)) = 0", start(" = 1 j + 1")),
    );
    let help = "= help: to leave `<equality>` out, write `#[mechanism(…, mimic = independent)]`";
    for (equality, expected) in [
        (
            "<tendon tendon1='v'/>",
            "r.xml:2:336: unknown tendon `v`\n= help: expected `s`, `t` or `u`".to_string(),
        ),
        (
            "<tendon tendon1='u'/>",
            format!("r.xml:2:336: tendon `u` goes through space, where none is coupled\n{help}"),
        ),
    ] {
        check_model(&model(equality), &expected);
    }
}

#[test]
fn defaults_of_actuators_are_one_record() {
    check_model(
        "<default><muscle range='0.5 1'/><motor/><position kp='3'/></default>
         <worldbody><body name='b'><joint name='j'/></body></worldbody>
         <actuator><position name='p' joint='j' kp='4' ctrlrange='-1 1'/><velocity name='v' joint='j'/></actuator>",
        "the root is the ground
         body b
         Pin j: ground -> b about [0, 0, 1]
         p: input in rad on 4 j
         p: spring 4 from 0.125 on 1 j
         p: damper 1 on 1 j
         v: input in rad/s on 3 j
         v: damper 3 on 1 j
         left out ranges of what servos are told: 1",
    );
}

#[test]
fn what_newer_versions_have_is_refused() {
    let model = |joint: &str, motor: &str| {
        format!(
            "<worldbody><body name='b'><joint name='j' {joint}/></body></worldbody>\
             <actuator><motor name='m' joint='j' {motor}/></actuator>"
        )
    };
    let passive =
        "= help: to leave springs, damping and friction out, write `#[mechanism(…, passive = ignore)]`";
    let inputs =
        "= help: to leave the actuators of the file out, write `#[mechanism(…, inputs = joints)]`, or `none`";
    for (joint, motor, expected) in [
        ("dampingpoly='1 2'", "", format!("r.xml:2:56: `dampingpoly` is not supported\n{passive}")),
        ("stiffnesspoly='1'", "", format!("r.xml:2:58: `stiffnesspoly` is not supported\n{passive}")),
        ("", "delay='0.1'", format!("r.xml:2:107: `delay` of an actuator is not supported\n{inputs}")),
    ] {
        check_model(&model(joint, motor), &expected);
    }
}

#[test]
fn loops_are_closed() {
    let model = |equality: &str| {
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
    check_model(
        &model("<connect body1='b' body2='d' anchor='1 2 4'/>"),
        &format!("{start}\nBall connect1: b.at([1, 2, 4]) -> d.at([2, -4, 0])"),
    );
    check_model(&model("<weld body1='d'/>"), &format!("{start}\nWeld weld1: d.at([0, 0, -2]) -> ground"));
    check_model(
        &model("<weld name='w' body1='d' relpose='1 2 3 1 0 0 0' body2='b'/>"),
        &format!("{start}\nWeld w: d.at([1, 2, 3]) -> b"),
    );
    check_model(
        &model("<connect site1='s' site2='s'/>"),
        "r.xml:2:194: body `d` closes a loop with itself
         = help: to leave `<equality>` out, write `#[mechanism(…, mimic = independent)]`",
    );
    check_model(
        &model("<weld body1='c' body2='b'/>"),
        "r.xml:2:181: `c` is a mocap body, which nothing here moves
         = help: to leave `<equality>` out, write `#[mechanism(…, mimic = independent)]`",
    );
    check_model(
        &model("<weld body1='e'/>"),
        "r.xml:2:181: unknown body `e`
         = help: expected `b`, `c` or `d`",
    );
}
