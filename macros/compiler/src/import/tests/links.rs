//! Tests of the import of links: mass, centre of mass, inertia.

use super::*;

const INERTIA: &str = r#"<inertia ixx="1" ixy="2" ixz="3" iyy="4" iyz="5" izz="6"/>"#;

fn check_inertial_message(inside: &str, expected: &str) {
    check_import_of_robot_elements(
        &format!("<link name=\"a\"><inertial>{inside}</inertial></link>"),
        expected,
    );
}

#[test]
fn link_inertial_has_mass_centre_and_inertia() {
    check_inertial_message(
        &format!(r#"<origin xyz="0 -0 .5"/><mass value=" 2.5e0 "/>{INERTIA}"#),
        "body a mass=2.5 com=[0, 0, 0.5] inertia=[[1, 2, 3], [2, 4, 5], [3, 5, 6]]
         Weld root_joint: ground -> a",
    );
    check_inertial_message(
        &format!(r#"<mass value="1"/>{INERTIA}"#),
        "body a mass=1 inertia=[[1, 2, 3], [2, 4, 5], [3, 5, 6]]
         Weld root_joint: ground -> a",
    );
}

#[test]
fn inertial_frame_rotates_the_inertia() {
    check_inertial_message(
        &format!(r#"<origin rpy="1 2 3"/><mass value="1"/>{INERTIA}"#),
        "body a mass=1 inertia=[[1, 2, 3], [2, 4, 5], [3, 5, 6]].rotated(z(3), y(2), x(1))
         Weld root_joint: ground -> a",
    );
    check_inertial_message(
        &format!(r#"<origin rpy="0 2 0"/><mass value="1"/>{INERTIA}"#),
        "body a mass=1 inertia=[[1, 2, 3], [2, 4, 5], [3, 5, 6]].rotated(y(2))
         Weld root_joint: ground -> a",
    );
}

#[test]
fn zero_inertial_is_no_inertia() {
    let zeros = r#"<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>"#;
    let inside = format!(r#"<origin xyz="1 0 0" rpy="1 0 0"/><mass value="0"/>{zeros}"#);
    check_inertial_message(&inside, "body a\nWeld root_joint: ground -> a");
    let inside = format!(r#"<origin xyz="1 0 0" rpy="1 0 0"/><mass value="1"/>{zeros}"#);
    check_inertial_message(&inside, "body a mass=1 com=[1, 0, 0]\nWeld root_joint: ground -> a");
}

#[test]
fn invalid_mass_is_reported_at_its_source_position() {
    let text =
        format!("<robot><link name='a'>\n <inertial><mass value='-1'/>{INERTIA}</inertial></link></robot>");
    let imported = import_text(&text, &default_file_options(), &mut Diagnostics::new());
    let at = imported.and_then(|i| i.bodies[0].mass.clone()).and_then(|mass| mass.place.file);
    assert_eq!(at.map(|at| (at.file.to_string(), at.line, at.column)), Some(("r.urdf".to_string(), 2, 25)));
}

/// If mass properties are not needed, errors in them are ignored.
#[test]
fn inertia_errors_are_ignored_for_kinematics() {
    let options = FileOptions { inertias: InertiaOption::None, ..default_file_options() };
    let text = "<robot><link name='a'><inertial><mass value='x'/></inertial></link></robot>";
    check_import_with_options(&options, text, "body a\nWeld root_joint: ground -> a");
}

#[test]
fn missing_attributes_are_named_in_the_error() {
    check_import_with_options(
        &FileOptions { base: BaseAttachment::Free, ..default_file_options() },
        "<robot>\n<link name='a'><inertial></inertial></link></robot>",
        r#"r.urdf:2:16: `<inertial>` without `<mass>`
           = help: expected `<mass value="…"/>`
           r.urdf:2:16: `<inertial>` without `<inertia>`
           = help: expected `<inertia ixx="…" ixy="…" ixz="…" iyy="…" iyz="…" izz="…"/>`"#,
    );
    check_inertial_message(
        "<mass/>\n<inertia ixx='1' ixy='0' iyy='1' izz='1'/>",
        r#"r.urdf:2:26: `<mass>` without `value`
           = help: expected `<mass value="…"/>`
           r.urdf:3:1: `<inertia>` without `ixz`, `iyz`
           = help: expected `<inertia ixx="…" ixy="…" ixz="…" iyy="…" iyz="…" izz="…"/>`"#,
    );
}

#[test]
fn misspelt_elements_are_rejected() {
    check_import_of_robot_elements(
        "<link name='a'><inertal/><visual/><anything/></link>",
        "r.urdf:2:16: unknown element `<inertal>`
         = help: did you mean `<inertial>`?",
    );
    check_inertial_message(
        &format!("<orgin xyz='1 0 0'/><mass vlaue='1'/>{INERTIA}"),
        "r.urdf:2:26: unknown element `<orgin>`
         = help: did you mean `<origin>`?
         r.urdf:2:52: unknown attribute `vlaue` of `<mass>`
         = help: did you mean `value`?",
    );
    check_inertial_message(
        &format!("<origin xzy='1 0 0' rpy='0 0 0' further='1'/><mass value='1'/>{INERTIA}"),
        "r.urdf:2:34: unknown attribute `xzy` of `<origin>`
         = help: did you mean `xyz`?",
    );
    check_import_of_robot_elements(
        "<Link name='a'/>",
        "r.urdf:2:1: unknown element `<Link>`
         = help: did you mean `<link>`?",
    );
}

#[test]
fn duplicate_elements_are_rejected() {
    check_inertial_message(
        &format!("<mass value='1'/>{INERTIA}\n<mass value='2'/>"),
        "r.urdf:3:1: second `<mass>` of one element
         = help: the first is at r.urdf:2:26",
    );
    check_import_of_robot_elements(
        "<link name='a'><inertial/>\n<inertial/></link>",
        r#"r.urdf:3:1: second `<inertial>` of one element
           = help: the first is at r.urdf:2:16"#,
    );
}

#[test]
fn numbers_must_be_finite() {
    for (word, why) in [
        ("NaN", "is not a finite number"),
        ("-inf", "is not a finite number"),
        ("1e999", "is not a finite number"),
        ("0x10", "is not a number"),
        ("1.0f", "is not a number"),
        ("−1", "is not a number"),
    ] {
        let expected = format!("r.urdf:2:39: `{word}` {why}\n= help: write digits, as in `-0.5` or `1e-3`");
        check_inertial_message(&format!("<mass value='{word}'/>{INERTIA}"), &expected);
    }
    check_inertial_message(
        &format!("<mass value='1 2'/>{INERTIA}"),
        "r.urdf:2:39: expected a number in `value`, found `1 2`
         = help: write one number, with a decimal point",
    );
    check_inertial_message(
        &format!("<origin xyz='0 0'/><mass value=''/>{INERTIA}"),
        "r.urdf:2:39: expected 3 numbers in `xyz`, found `0 0`
         = help: write that many numbers, separated by spaces
         r.urdf:2:58: expected a number in `value`, found ``
         = help: write one number, with a decimal point",
    );
}

#[test]
fn every_invalid_number_is_reported_at_its_position() {
    check_inertial_message(
        &format!("<origin xyz='0\n  a  nan'/><mass value='1,5'/>{INERTIA}"),
        "r.urdf:2:39: `a` is not a number
         = help: write digits, as in `-0.5` or `1e-3`
         r.urdf:2:39: `nan` is not a finite number
         = help: write digits, as in `-0.5` or `1e-3`
         r.urdf:3:25: expected a number in `value`, found `1,5`
         = help: write one number, with a decimal point",
    );
    check_inertial_message(
        &format!("<origin xyz='ä  b nan'/><mass value='1'/><!-- ä -->{INERTIA}"),
        "r.urdf:2:39: `ä` is not a number
         = help: write digits, as in `-0.5` or `1e-3`
         r.urdf:2:42: `b` is not a number
         = help: write digits, as in `-0.5` or `1e-3`
         r.urdf:2:44: `nan` is not a finite number
         = help: write digits, as in `-0.5` or `1e-3`",
    );
    check_inertial_message(
        &format!("<origin xyz='1,2,3'/><mass value='1'/>{INERTIA}"),
        "r.urdf:2:39: expected 3 numbers in `xyz`, found `1,2,3`
         = help: write spaces between the numbers instead of commas, and a decimal point, everywhere in the file",
    );
}

#[test]
fn long_invalid_values_are_shortened_in_messages() {
    let expected = format!(
        "r.urdf:2:39: `{}`… is not a number\n= help: write digits, as in `-0.5` or `1e-3`",
        "x".repeat(60)
    );
    check_inertial_message(
        &format!("<mass value='{}'/>{INERTIA}", "x".repeat(5000)),
        &expected.replace("`…", "…`"),
    );
}

/// Links that are fixed to the ground need no valid mass properties, because these appear in no equation.
#[test]
fn links_fixed_to_the_ground_need_no_inertia() {
    let link_without_inertia =
        |name: &str| format!("<link name='{name}'><inertial><mass value='1'/></inertial></link>");
    let links =
        [link_without_inertia("base"), link_without_inertia("arms"), link_without_inertia("hand")].join("\n");
    let joints =
        [joint_element("a", "fixed", "base", "arms", ""), joint_element("b", "revolute", "arms", "hand", "")];
    let text = format!("<robot>\n{links}\n{}</robot>", joints.concat());
    let missing_inertia_message = |line: u32| {
        format!(
            "r.urdf:{line}:19: `<inertial>` without `<inertia>`
                 = help: expected `<inertia ixx=\"…\" ixy=\"…\" ixz=\"…\" iyy=\"…\" iyz=\"…\" izz=\"…\"/>`\n"
        )
    };
    check_import_with_default_options(&text, &missing_inertia_message(4));
    let free = FileOptions { base: BaseAttachment::Free, ..default_file_options() };
    check_import_with_options(&free, &text, &[2, 3, 4].map(missing_inertia_message).concat());
    check_import_with_options(
        &options_with_locked_joints(&["b"]),
        &text,
        "body base mass=1\nbody arms mass=1\nbody hand mass=1
         Weld root_joint: ground -> base\nWeld a: base -> arms\nWeld b: arms -> hand",
    );
}

/// Mass properties and poses in wrong notation are errors instead of being ignored silently.
#[test]
fn link_child_elements_written_as_attributes_are_rejected() {
    let parts = "= help: expected `<origin>`, `<mass>` and `<inertia>`";
    let good = format!("<mass value='1'/>{INERTIA}");
    for (inside, expected) in [
        (
            "<mass>2</mass>",
            "r.urdf:2:32: unexpected text `2` in `<mass>`\n= help: expected `<mass value=\"…\"/>`"
                .to_string(),
        ),
        (
            "<mass kg='2'/>",
            "r.urdf:2:32: unknown attribute `kg` of `<mass>`\n= help: expected `<mass value=\"…\"/>`"
                .to_string(),
        ),
        (
            &*format!("{good}<com>0 0 1</com>"),
            format!("r.urdf:2:101: unexpected `<com>` in `<inertial>`\n{parts}"),
        ),
        (&*format!("{good} 2 kg"), format!("r.urdf:2:102: unexpected text `2 kg` in `<inertial>`\n{parts}")),
    ] {
        let inside =
            if inside.starts_with(&good) { inside.to_string() } else { format!("{inside}{INERTIA}") };
        check_inertial_message(&inside, &expected);
    }
    let asymmetric = INERTIA.replace("/>", " iyx='-2'/>");
    check_inertial_message(
        &format!("<mass value='1'/>{asymmetric}"),
        "r.urdf:2:105: `iyx` differs from `ixy`: an inertia matrix is symmetric\n= help: remove `iyx`",
    );
    let help = "= help: a link has mass properties by `<inertial>`, and its position by a joint";
    for (inside, expected) in [
        ("<origin xyz='0 0 1'/>", "r.urdf:2:16: unexpected `<origin>` in `<link>`"),
        ("<pose>0 0 1 0 0 0</pose>", "r.urdf:2:16: unexpected `<pose>` in `<link>`"),
        ("<mass value='1'/>", "r.urdf:2:16: unexpected `<mass>` in `<link>`"),
        ("<joint name='j' type='fixed'/>", "r.urdf:2:16: unexpected `<joint>` in `<link>`"),
    ] {
        check_import_of_robot_elements(
            &format!("<link name='a'>{inside}</link>"),
            &format!("{expected}\n{help}"),
        );
    }
    check_import_of_robot_elements(
        "<link name='a' mass='1'/>",
        &format!("r.urdf:2:16: unknown attribute `mass` of `<link>`\n{help}"),
    );
    check_import_of_robot_elements(
        "<link name='a'/><inertial><mass value='1'/></inertial>",
        "r.urdf:2:17: unexpected `<inertial>` in `<robot>`\n= help: expected `<link>` and `<joint>`, which \
         describe all moving parts",
    );
    // Elements of other tools, and an identity pose, are accepted.
    check_import_of_robot_elements(
        "<gazebo reference='a'><inertial/></gazebo><transmission name='t'><joint name='j'/></transmission>\
         <ros2_control name='c'><joint name='j'/></ros2_control><link name='a' type='laser'><origin xyz='0 0 0'/>\
         <contact><inertia_scaling value='1'/></contact><sensor><origin xyz='1 1 1'/></sensor></link>",
        "body a\nWeld root_joint: ground -> a",
    );
}

/// Checks that Unicode whitespace from keyboards and spreadsheets is accepted, and that columns in messages
/// remain those of the file.
#[test]
fn unicode_whitespace_is_accepted() {
    let robot_text_with_whitespace = |blank: &str| {
        format!(
            "<robot{blank}name='r'>{blank}<link name='a'><inertial><origin{blank}xyz='0{blank}0 1{blank}'/>{blank}<mass value='{blank}2'/>\
             {INERTIA}</inertial></link>{blank}</robot>"
        )
    };
    let expected = import_as_text(&default_file_options(), &robot_text_with_whitespace(" "));
    assert!(expected.contains("com=[0, 0, 1]"), "{expected}");
    for blank in ["\u{a0}", " \u{feff}", "\u{2003}", "\u{200b}", "\u{3000}"] {
        assert_eq!(
            import_as_text(&default_file_options(), &robot_text_with_whitespace(blank)),
            expected,
            "{blank:?}"
        );
        assert_eq!(
            import_as_text(
                &default_file_options(),
                &format!("\u{feff}{}", robot_text_with_whitespace(blank))
            ),
            expected,
            "{blank:?}"
        );
    }
    check_import_with_default_options(
        "<robot>\n<link\u{a0}name='a'\u{a0}/>\u{feff}<lnk/></robot>",
        "r.urdf:2:19: unknown element `<lnk>`\n= help: did you mean `<link>`?",
    );
}

/// Checks that a geometry with two shapes is an error, since one of them would be lost.
#[test]
fn second_shape_of_a_geometry_is_rejected() {
    let help = "= help: write a `<collision>` for each shape";
    for (format, shapes, column) in [
        (FileFormat::Urdf, "<sphere radius='1'/><box size='1 1 1'/>", 57),
        (FileFormat::Sdf, "<sphere><radius>1</radius></sphere><empty/><box><size>1 1 1</size></box>", 80),
    ] {
        let options = FileOptions { format, collisions: true, ..default_file_options() };
        let link = format!("<link name='a'><collision><geometry>{shapes}</geometry></collision></link>");
        let text = match format {
            FileFormat::Urdf => format!("<robot name='r'>\n{link}\n</robot>"),
            _ => format!("<sdf><model name='m'>\n{link}\n</model></sdf>"),
        };
        check_import_with_options(
            &options,
            &text,
            &format!("r.urdf:2:{column}: second shape of one geometry\n{help}"),
        );
    }
}
