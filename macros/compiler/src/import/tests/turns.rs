//! Tests of angles in degrees in file formats that use radians.

use super::*;

/// The angle 90 rad, reduced by full revolutions, rad.
const SAME_TURN: f64 = 2.0354056994857928;

#[test]
fn equivalent_angle_has_the_same_sine_and_cosine() {
    let (sin, cos) = 90.0_f64.sin_cos();
    assert!((SAME_TURN.sin() - sin).abs() < 1e-14 && (SAME_TURN.cos() - cos).abs() < 1e-14);
}

/// Compares the error message for `text` with the angle 90 in place of `…`. A rounded full revolution and one
/// and a half revolutions must not be reported.
fn check_degrees_error(options: &FileOptions, text: &str, place: &str, help: &str) {
    let degrees = text.replace('…', "90");
    let said = format!(
        "{place}: an angle of 90 rad is more than a full turn: 90° are {} rad, 90 rad is the same rotation \
         as {} rad\n= help: {help}",
        std::f64::consts::FRAC_PI_2,
        SAME_TURN,
    );
    check_import_with_options(options, &degrees, &said);
    for turn in ["6.2832", "-6.283185307179586", "6.3", "9.42477796076938"] {
        let answer = import_as_text(options, &text.replace('…', turn));
        assert!(!answer.contains("full turn"), "{answer}");
    }
}

#[test]
fn degrees_in_a_urdf_are_reported_once() {
    let robot_with_origin = |origin: &str| {
        format!(
            "<robot name='r'><link name='a'/><link name='b'><inertial><origin rpy='0 … 0'/><mass value='1'/>\
             <inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>\n\
             <joint name='j' type='revolute'>{origin}<parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>"
        )
    };
    let help = "`rpy` is in radians: write the angle that is meant, everywhere in the file";
    check_degrees_error(
        &default_file_options(),
        &robot_with_origin("<origin rpy='0 0 …'/>"),
        "r.urdf:1:71",
        help,
    );
    let joint = robot_with_origin("<origin xyz='90 0 0' rpy='0 0 …'/>").replacen('…', "1.5", 1);
    check_degrees_error(&default_file_options(), &joint, "r.urdf:2:59", help);
}

#[test]
fn degrees_in_an_sdf_are_reported() {
    let options =
        FileOptions { format: FileFormat::Sdf, path: name_at_call_site("r.sdf"), ..default_file_options() };
    let model_with_pose =
        |pose: &str| format!("<sdf><model name='m'><link name='a'>{pose}</link></model></sdf>");
    let help = "a pose is in radians: write the angle that is meant, or `<pose degrees=\"true\">`, \
                everywhere in the file";
    check_degrees_error(&options, &model_with_pose("<pose>90 0 0 … 0 0</pose>"), "r.sdf:1:43", help);
    let answer = import_as_text(&options, &model_with_pose("<pose degrees='true'>0 0 0 0 0 90</pose>"));
    assert!(answer.contains("body a mass=1"), "{answer}");
}

#[test]
fn degrees_in_an_mjcf_follow_its_compiler_option() {
    let options =
        FileOptions { format: FileFormat::Mjcf, path: name_at_call_site("r.xml"), ..default_file_options() };
    let model_with_angle_unit = |unit: &str, turn: &str| {
        format!(
            "<mujoco><compiler angle='{unit}'/><worldbody>\n<body name='b' {turn}><joint/>\
             <geom size='.1' mass='1'/></body></worldbody></mujoco>"
        )
    };
    let help = "`angle=\"radian\"` makes angles of the file radians: write the angle that is meant, or \
                `angle=\"degree\"`";
    for (turn, place) in [("euler='0 … 0'", "r.xml:2:23"), ("axisangle='0 0 20 …'", "r.xml:2:27")] {
        check_degrees_error(&options, &model_with_angle_unit("radian", turn), place, help);
        let answer = import_as_text(&options, &model_with_angle_unit("degree", &turn.replace('…', "90")));
        assert!(answer.contains("body b mass=1"), "{answer}");
    }
}
