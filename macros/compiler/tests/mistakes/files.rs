//! Robots in files: one habit is one mistake, and a file that is not there is the only one.

use super::messages;
use std::fs;
use std::path::Path;

/// The messages about a robot with these joints' origins and axes.
fn robot(name: &str, xyz: &str, axis: &str) -> Vec<String> {
    let inertial = |com: &str| {
        format!(
            "<inertial><origin xyz=\"{com}\"/><mass value=\"1\"/>
            <inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>"
        )
    };
    let joint = |k: u8, parent: &str, child: &str| {
        format!(
            "<joint name=\"j{k}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"{child}\"/>
            <origin xyz=\"{xyz}\"/><axis xyz=\"{axis}\"/></joint>"
        )
    };
    let text = format!(
        "<robot name=\"r\"><link name=\"base\"/><link name=\"a\">{}</link><link name=\"b\">{}</link>{}{}</robot>",
        inertial(xyz),
        inertial(xyz),
        joint(1, "base", "a"),
        joint(2, "a", "b"),
    );
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(path, text).unwrap();
    messages(&format!("urdf = \"{name}\""), "")
}

#[test]
fn commas_are_one_mistake() {
    for (name, xyz, axis) in [("commas.urdf", "0, 0, 1", "0, 0, 1"), ("decimal.urdf", "0,5 0 1", "0 0 1")] {
        let found = robot(name, xyz, axis);
        let good = matches!(found.as_slice(), [one] if one.contains("expected 3 numbers in `xyz`, found")
            && one.contains("spaces between the numbers instead of commas"));
        assert!(good, "{found:#?}");
    }
    assert_eq!(robot("spaces.urdf", "0 0 1", "0 0 1"), Vec::<String>::new());
}

#[test]
fn a_wrong_path_is_one_mistake() {
    let found =
        messages("urdf = \"no_such_robot.urdf\", lock = [\"a\"]", "#[acts(on = elbow)] motor: Torque");
    let good = matches!(found.as_slice(), [one] if one.starts_with("there is no file `no_such_robot.urdf`")
        && one.contains("= help: "));
    assert!(good, "{found:#?}");
}
