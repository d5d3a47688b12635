//! Joints: types, frames, axes, damping and friction, `mimic` and locks.

use super::*;
use crate::syntax::file_parameters::FileParameters;

/// Checks the last joints imported from a chain of URDF joints.
fn check_imported_chain(options: &FileOptions, joints: &[(&str, &str)], expected: &str) {
    check_import_with_options(
        options,
        &chain_of_links(joints),
        &(expected_chain_lines(joints.len()) + expected),
    );
}

#[test]
fn every_urdf_joint_type_is_converted() {
    let axis = "<axis xyz='0 0 2'/>";
    let kinds = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"];
    check_imported_chain(
        &FileOptions { inputs: FileInputSource::Joints, ..default_file_options() },
        &kinds.map(|kind| (kind, axis)),
        "Pin j1: l0 -> l1 about [0, 0, 2] driven
         Pin j2: l1 -> l2 about [0, 0, 2] driven
         Sleeve j3: l2 -> l3 along [0, 0, 2] driven
         Weld j4: l3 -> l4
         Free j5: l4 -> l5
         Planar j6: l5 -> l6 about [0, 0, 2]
         Ball j7: l6 -> l7",
    );
}

#[test]
fn urdf_joint_axis_defaults_to_x() {
    check_imported_chain(
        &default_file_options(),
        &[
            ("revolute", ""),
            ("prismatic", "<origin rpy='0 0 0'/>"),
            ("fixed", "<axis xyz='0 0 0'/><dynamics damping='-1'/>"),
        ],
        "Pin j1: l0 -> l1 about [1, 0, 0]
         Sleeve j2: l1 -> l2 along [1, 0, 0]
         Weld j3: l2 -> l3",
    );
    check_import_with_default_options(
        &chain_of_links(&[("revolute", "<axis xyz='0 0 0.0'/>")]),
        "r.urdf:3:82: axis of zero length has no direction",
    );
}

#[test]
fn joint_origin_combines_position_and_rotated_axes() {
    check_imported_chain(
        &default_file_options(),
        &[
            ("revolute", "<origin xyz='1 2 3' rpy='0.1 0.2 0.3'/>"),
            ("fixed", "<origin rpy='0.1 0 0.3'/>"),
            ("floating", "<origin xyz='0 0 1'/>"),
            ("fixed", "<origin/>"),
        ],
        "Pin j1: l0.at([1, 2, 3]).rotated(z(0.3), y(0.2), x(0.1)) -> l1 about [1, 0, 0]
         Weld j2: l1.rotated(z(0.3), x(0.1)) -> l2
         Free j3: l2.at([0, 0, 1]) -> l3
         Weld j4: l3 -> l4",
    );
    check_import_with_default_options(
        &chain_of_links(&[("revolute", "<origin xyz='0 0 0' quat_xyzw='0 0 0 1'/>")]),
        r#"r.urdf:3:91: `quat_xyzw` is not supported
           = help: expected `rpy="roll pitch yaw"`"#,
    );
}

#[test]
fn passive_joint_forces_are_read_unless_ignored() {
    let joints =
        [("revolute", "<dynamics damping='2' friction='3'/>"), ("prismatic", "<dynamics friction='0'/>")];
    check_imported_chain(
        &default_file_options(),
        &joints,
        "Pin j1: l0 -> l1 about [1, 0, 0] damping=2 friction=3
         Sleeve j2: l1 -> l2 along [1, 0, 0]",
    );
    let ignore = FileOptions { honour_passive: false, ..default_file_options() };
    check_imported_chain(
        &ignore,
        &[("revolute", "<dynamics damping='-2' friction='x'/>")],
        "Pin j1: l0 -> l1 about [1, 0, 0]",
    );
    check_import_with_default_options(
        &chain_of_links(&[("revolute", "<dynamics damping='-2'/>"), ("planar", "<dynamics friction='1'/>")]),
        "r.urdf:3:90: negative damping `-2`
         = help: to ignore damping and friction, write `#[mechanism(…, passive = ignore)]`
         r.urdf:5:89: `friction` of a `planar` joint is not supported
         = help: to ignore damping and friction, write `#[mechanism(…, passive = ignore)]`",
    );
}

#[test]
fn mimic_joints_follow_unless_independent() {
    let joints = [
        ("revolute", "<mimic joint='j3' multiplier='2' offset='1'/>"),
        ("fixed", "<mimic joint='nobody'/>"),
        ("prismatic", "<mimic joint='j4' multiplier='-3' offset='5'/>"),
        ("revolute", ""),
    ];
    let inputs = FileOptions { inputs: FileInputSource::Joints, ..default_file_options() };
    check_imported_chain(
        &inputs,
        &joints,
        "Pin j1: l0 -> l1 about [1, 0, 0] = -6 j4 + 11
         Weld j2: l1 -> l2
         Sleeve j3: l2 -> l3 along [1, 0, 0] = -3 j4 + 5
         Pin j4: l3 -> l4 about [1, 0, 0] driven
         left out `mimic` of j2: a fixed joint does not follow nobody",
    );
    check_imported_chain(
        &FileOptions { follow_mimic: false, ..inputs },
        &joints,
        "Pin j1: l0 -> l1 about [1, 0, 0] driven
         Weld j2: l1 -> l2
         Sleeve j3: l2 -> l3 along [1, 0, 0] driven
         Pin j4: l3 -> l4 about [1, 0, 0] driven",
    );
}

#[test]
fn mimic_joint_without_leader_is_rejected() {
    let help =
        "= help: to let joints that follow move on their own, write `#[mechanism(…, mimic = independent)]`";
    check_import_with_default_options(
        &chain_of_links(&[
            ("revolute", "<mimic joint='j22'/>"),
            ("fixed", ""),
            ("planar", "<mimic joint='j1'/>"),
            ("prismatic", "<mimic joint='j2'/>"),
            ("prismatic", "<mimic joint='j3'/>"),
        ]),
        &format!(
            "r.urdf:3:85: unknown joint `j22`
             = help: expected `j1`, `j4` or `j5`
             {help}
             r.urdf:7:83: joint `j3` is `planar` and cannot follow
             {help}
             r.urdf:9:86: joint `j2` is `fixed` and cannot be followed
             {help}
             r.urdf:11:86: joint `j3` is `planar` and cannot be followed
             {help}"
        ),
    );
    check_import_with_default_options(
        &chain_of_links(&[
            ("revolute", "<mimic joint='j1'/>"),
            ("revolute", "<mimic joint='j4'/>"),
            ("revolute", "<mimic joint='j2'/>"),
            ("revolute", "<mimic joint='j3'/>"),
            ("revolute", "<mimic joint='j4'/>"),
        ]),
        &format!(
            "r.urdf:3:85: joint `j1` follows itself
             {help}
             r.urdf:5:85: joints `j2`, `j4`, `j3` follow one another
             {help}"
        ),
    );
    check_import_with_default_options(
        &chain_of_links(&[
            ("revolute", "<mimic joint='j2' multiplier='1e200'/>"),
            ("revolute", "<mimic joint='j3' multiplier='1e200'/>"),
            ("revolute", ""),
        ]),
        "r.urdf:3:85: joint `j1` follows with an infinite multiplier or offset",
    );
}

#[test]
fn locked_joint_becomes_a_weld() {
    let options =
        FileOptions { inputs: FileInputSource::Joints, ..options_with_locked_joints(&["j1", "j3", "j4"]) };
    check_imported_chain(
        &options,
        &[
            ("revolute", "<origin xyz='1 0 0'/><dynamics damping='1'/>"),
            ("revolute", ""),
            ("planar", ""),
            ("prismatic", "<mimic joint='j2' offset='1'/>"),
        ],
        "Weld j1: l0.at([1, 0, 0]) -> l1
         Pin j2: l1 -> l2 about [1, 0, 0] driven
         Weld j3: l2 -> l3
         Weld j4: l3 -> l4
         left out the coupling of j4, which is locked",
    );
    check_import_with_options(
        &options_with_locked_joints(&["j", "elbow"]),
        &chain_of_links(&[("revolute", ""), ("revolute", "")]),
        "unknown joint `j` in `lock`
         = help: did you mean `j1`?
         unknown joint `elbow` in `lock`
         = help: expected `j1` or `j2`",
    );
}

#[test]
fn near_round_numbers_are_rounded_on_request_and_reported() {
    let robot = chain_of_links(&[
        ("revolute", "<origin xyz='1e-5 0.5 0' rpy='1.5708 -3.14159 0.3'/><axis xyz='0 -2 1e-4'/>"),
        ("prismatic", "<origin xyz='0.002 0 0' rpy='1.572 0 0'/><axis xyz='1 0 0.01'/>"),
        ("fixed", "<origin rpy='0 -1.571 0'/>"),
    ]);
    check_import_with_options(
        &FileOptions { snap: Some(1e-3), ..default_file_options() },
        &robot,
        "body l0\nbody l1\nbody l2\nbody l3
         Weld root_joint: ground -> l0
         Pin j1: l0.at([0, 0.5, 0]).rotated(z(0.3), y(-3.141592653589793), x(1.5707963267948966)) -> l1 about [0, -2, 0]
         Sleeve j2: l1.at([0.002, 0, 0]).rotated(x(1.572)) -> l2 along [1, 0, 0.01]
         Weld j3: l2.rotated(y(-1.5707963267948966)) -> l3
         rounded `j1`: roll 1.5708 → 1.5707963267948966
         rounded `j1`: pitch -3.14159 → -3.141592653589793
         rounded `j1`: x 1e-5 → 0.0
         rounded `j1`: axis z 0.0001 → 0.0
         rounded `j3`: pitch -1.571 → -1.5707963267948966",
    );
}

/// Checks that an axis may have any length.
#[test]
fn joint_axes_of_any_length_are_rounded_by_direction() {
    let robot = chain_of_links(&[("revolute", "<axis xyz='1.7e308 -1.7e308 1e300'/>")]);
    let options = FileOptions { snap: Some(1e-3), ..default_file_options() };
    let imported = import_text(&robot, &options, &mut Diagnostics::new()).expect("the file is right");
    assert_eq!(imported.snapped, ["`j1`: axis z 1e300 → 0.0"]);
}

#[test]
fn mimic_of_a_locked_joint_is_fixed_at_its_offset() {
    let follow = "<mimic joint='j6' offset='0.5'/>";
    check_imported_chain(
        &options_with_locked_joints(&["j6"]),
        &[
            (
                "revolute",
                "<origin rpy='0 0 1'/><axis xyz='0 -2 0'/><mimic joint='j6' multiplier='3' offset='0.5'/>",
            ),
            ("revolute", "<axis xyz='3 0 4'/><mimic joint='j6' offset='0.5'/>"),
            ("prismatic", "<origin xyz='1 0 0'/><axis xyz='0 0 1e-200'/><mimic joint='j1' multiplier='2'/>"),
            ("revolute", "<mimic joint='j6' multiplier='3'/>"),
            ("prismatic", follow),
            ("revolute", ""),
        ],
        "Weld j1: l0.rotated(z(1), y(-0.5)) -> l1
         Weld j2: l1.rotated(eigenaxis([0.6, 0, 0.8], 0.5)) -> l2
         Weld j3: l2.at([1, 0, 1]) -> l3
         Weld j4: l3 -> l4
         Weld j5: l4.at([0.5, 0, 0]) -> l5
         Weld j6: l5 -> l6",
    );
    check_imported_chain(
        &default_file_options(),
        &[("revolute", "<mimic joint='j2' multiplier='0' offset='1'/>"), ("revolute", "")],
        "Weld j1: l0.rotated(x(1)) -> l1
         Pin j2: l1 -> l2 about [1, 0, 0]",
    );
}

#[test]
fn locked_slide_is_displaced_along_its_rotated_axis() {
    // Yaw 1, pitch 2 and roll 3 about successive axes: the third column of R_z(1) R_y(2) R_x(3).
    let inside = "<origin rpy='3 2 1'/><axis xyz='0 0 1'/><mimic joint='j2' offset='1'/>";
    let text = chain_of_links(&[("prismatic", inside), ("revolute", "")]);
    let imported = import_text(&text, &options_with_locked_joints(&["j2"]), &mut Diagnostics::new());
    let at = imported.and_then(|imported| imported.joints[1].parent.at.clone()).map(|at| at.kind);
    let Some(ExprKind::Array(items)) = at else { panic!("a moved end") };
    let ((s1, c1), (s2, c2), (s3, c3)) = (1f64.sin_cos(), 2f64.sin_cos(), 3f64.sin_cos());
    let expected = [c1 * s2 * c3 + s1 * s3, s1 * s2 * c3 - c1 * s3, c2 * c3];
    for (item, expected) in items.iter().zip(expected) {
        assert!(matches!(item.kind, ExprKind::Number(x) if (x - expected).abs() < 1e-15));
    }
}

#[test]
fn infinite_joint_offsets_are_rejected() {
    let inside = "<origin xyz='1.7e308 0 0'/><mimic joint='j2' offset='1.7e308'/>";
    check_import_with_options(
        &options_with_locked_joints(&["j2"]),
        &chain_of_links(&[("prismatic", inside), ("revolute", "")]),
        "r.urdf:3:14: joint `j1` has an infinite position",
    );
}

#[test]
fn joint_without_parent_child_or_type_is_rejected() {
    check_import_of_robot_elements(
        "<link name='a'/>\n<joint/>\n<joint name='j' type='revolut'><parent/><child link=''/></joint>",
        r#"r.urdf:3:1: `<joint>` without `name`, `type`
           = help: expected `<joint name="…" type="…"/>`
           r.urdf:3:1: `<joint>` without `<parent>`
           = help: expected `<parent link="…"/>`
           r.urdf:3:1: `<joint>` without `<child>`
           = help: expected `<child link="…"/>`
           r.urdf:4:23: unknown joint type `revolut`
           = help: did you mean `revolute`?
           r.urdf:4:32: `<parent>` without `link`
           = help: expected `<parent link="…"/>`
           r.urdf:4:54: empty `link` of `<child>`
           = help: write a name: `link="…"`"#,
    );
    check_import_with_default_options(
        &chain_of_links(&[
            ("ball", "<axes xyz='0 0 1'/>"),
            ("revolute", "<mimic joint='j1' multipler='2'/>"),
        ]),
        "r.urdf:3:24: unknown joint type `ball`
         = help: expected `revolute`, `continuous`, `prismatic`, `fixed`, `floating`, `planar` or `spherical`
         r.urdf:3:67: unknown element `<axes>`
         = help: did you mean `<axis>`?
         r.urdf:5:89: unknown attribute `multipler` of `<mimic>`
         = help: did you mean `multiplier`?",
    );
}

/// An axis or origin in wrong notation is an error and not replaced by the default.
#[test]
fn joint_child_elements_written_as_attributes_are_rejected() {
    let elements = "= help: a joint has elements: `<parent link=\"…\"/>`, `<child link=\"…\"/>`, `<origin \
                    xyz=\"…\" rpy=\"…\"/>`, `<axis xyz=\"…\"/>`";
    let axis = "= help: expected `<axis xyz=\"…\"/>`";
    let origin = "= help: expected `<origin xyz=\"…\" rpy=\"…\"/>`";
    for (inside, expected) in [
        ("<axis/>", format!("r.urdf:3:71: `<axis>` without `xyz`\n{axis}")),
        ("<axis> 0 0 1</axis>", format!("r.urdf:3:78: unexpected text `0 0 1` in `<axis>`\n{axis}")),
        ("<axis><xyz>0 0 1</xyz></axis>", format!("r.urdf:3:77: unexpected `<xyz>` in `<axis>`\n{axis}")),
        ("<axis value='0 0 1'/>", format!("r.urdf:3:77: unknown attribute `value` of `<axis>`\n{axis}")),
        (
            "<axis xyz='0 0 1' rpy='0 0 1'/>",
            format!("r.urdf:3:89: unknown attribute `rpy` of `<axis>`\n{axis}"),
        ),
        ("<origin>0 0 1</origin>", format!("r.urdf:3:79: unexpected text `0 0 1` in `<origin>`\n{origin}")),
        ("<origin pos='0 0 1'/>", format!("r.urdf:3:79: unknown attribute `pos` of `<origin>`\n{origin}")),
        (
            "<origin xyz='0 0 1'><rpy>0 0 1</rpy></origin>",
            format!("r.urdf:3:91: unexpected `<rpy>` in `<origin>`\n{origin}"),
        ),
        (
            "<dynamics><damping>3</damping></dynamics>",
            "r.urdf:3:81: unexpected `<damping>` in `<dynamics>`\n= help: expected `<dynamics damping=\"…\" \
             friction=\"…\"/>`"
                .to_string(),
        ),
        (
            "<dynamics stiffness='3'/>",
            "r.urdf:3:81: unknown attribute `stiffness` of `<dynamics>`\n= help: expected `<dynamics \
             damping=\"…\" friction=\"…\"/>`"
                .to_string(),
        ),
        (
            "<limit min='3' effort='1'/>",
            "r.urdf:3:78: unknown attribute `min` of `<limit>`\n= help: expected `<limit lower=\"…\" \
             upper=\"…\" velocity=\"…\" effort=\"…\"/>`"
                .to_string(),
        ),
        ("<pose>0 0 1 0 0 0</pose>", format!("r.urdf:3:71: unexpected `<pose>` in `<joint>`\n{elements}")),
        ("0 0 1", format!("r.urdf:3:71: unexpected text `0 0 1` in `<joint>`\n{elements}")),
    ] {
        check_import_with_default_options(&chain_of_links(&[("revolute", inside)]), &expected);
    }
    check_import_with_default_options(
        &chain_of_links(&[("revolute", "")]).replace("<joint ", "<joint axis='0 0 1' "),
        &format!("r.urdf:3:8: unknown attribute `axis` of `<joint>`\n{elements}"),
    );
    // Elements and attributes of other tools, and an identity orientation, do not affect the joint.
    check_imported_chain(
        &default_file_options(),
        &[(
            "revolute",
            "<axis xyz='0 0 1' rpy='0 0 0'/><limit effort='1' velocity='1' acceleration='2'/><dynamics damping='1' K='3'/>\
             <safety_controller k_velocity='1'/><calibration rising='0'/><hardware/><physics><axis>1</axis></physics>",
        )],
        "Pin j1: l0 -> l1 about [0, 0, 1] damping=1",
    );
}

/// Limits of a joint with several coordinates, and the leader of a joint that the user locks, are listed.
#[test]
fn unsupported_joint_properties_are_listed() {
    let ignored_elements = |options: &FileOptions, text: &str| {
        let imported = import_text(text, options, &mut Diagnostics::new()).expect("a robot");
        imported.left_out
    };
    let limits =
        chain_of_links(&[("planar", "<limit lower='-1' upper='1'/>"), ("floating", "<limit velocity='1'/>")]);
    assert_eq!(
        ignored_elements(&default_file_options(), &limits),
        ["limits of j1, which is `planar`", "limits of j2, which is `floating`"]
    );
    let follower = chain_of_links(&[("revolute", ""), ("revolute", "<mimic joint='j1' multiplier='2'/>")]);
    assert_eq!(
        ignored_elements(&options_with_locked_joints(&["j2"]), &follower),
        ["the coupling of j2, which is locked"]
    );
    assert_eq!(ignored_elements(&options_with_locked_joints(&["j1"]), &follower), [""; 0]);
}

/// Checks that a joint which follows a locked joint is locked at its offset, with its placement rotated by
/// 0.5 rad about the axis.
#[test]
fn fixed_mimic_joints_include_their_rotation() {
    let figures =
        FileParameters { word: name_at_call_site("placement"), of: Some(vec![name_at_call_site("j2")]) };
    for (axis, rpy, expected) in [
        ("1 0 0", "0.1 0 0", [0.6, 0.0, 0.0]),
        ("0 0 1", "0 0 0.25", [0.0, 0.0, 0.75]),
        // About y after x: R_x(π/2) R_y(0.5) = R_z(0.5) R_x(π/2).
        ("0 1 0", "1.5707963267948966 0 0", [std::f64::consts::FRAC_PI_2, 0.0, 0.5]),
        // About the diagonal of y and z by half a turn: y and z exchange, x changes its sign.
        ("0 1 1", "0 0 0", [std::f64::consts::FRAC_PI_2, 0.0, std::f64::consts::PI]),
    ] {
        let offset = if axis == "0 1 1" { std::f64::consts::PI } else { 0.5 };
        let inside = format!(
            "<origin xyz='1 2 3' rpy='{rpy}'/><axis xyz='{axis}'/><mimic joint='j1' offset='{offset}'/>"
        );
        let text = chain_of_links(&[("revolute", ""), ("revolute", &inside)]);
        let options =
            FileOptions { parameters: vec![figures.clone()], ..options_with_locked_joints(&["j1"]) };
        let imported = import_text(&text, &options, &mut Diagnostics::new()).expect("a robot");
        let [field] = imported.fields.as_slice() else { panic!("one field") };
        let rotation_from_rpy = |[roll, pitch, yaw]: [f64; 3]| {
            let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(f64::sin_cos);
            [
                [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr],
            ]
        };
        let [x, y, z, angles @ ..] = field.values.as_slice() else { panic!("six values") };
        assert_eq!([*x, *y, *z], [1.0, 2.0, 3.0]);
        let found = rotation_from_rpy(angles.try_into().expect("three angles"));
        for (a, b) in found.as_flattened().iter().zip(rotation_from_rpy(expected).as_flattened()) {
            assert!((a - b).abs() < 1e-14, "{axis}: {found:?}");
        }
    }
}
