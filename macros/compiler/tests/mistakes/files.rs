//! Tests of errors in robot files: an error in many places is reported once, and a missing file causes no
//! further error.

use super::compiler_messages;
use std::fs;
use std::path::Path;

/// Returns the messages of a robot whose joints have these origins and axes.
fn messages_for_joint_origin_and_axis(name: &str, xyz: &str, axis: &str) -> Vec<String> {
    let inertial_element = |com: &str| {
        format!(
            "<inertial><origin xyz=\"{com}\"/><mass value=\"1\"/>
            <inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>"
        )
    };
    let joint_element = |k: u8, parent: &str, child: &str| {
        format!(
            "<joint name=\"j{k}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"{child}\"/>
            <origin xyz=\"{xyz}\"/><axis xyz=\"{axis}\"/></joint>"
        )
    };
    let text = format!(
        "<robot name=\"r\"><link name=\"base\"/><link name=\"a\">{}</link>\
         <link name=\"b\">{}</link>{}{}</robot>",
        inertial_element(xyz),
        inertial_element(xyz),
        joint_element(1, "base", "a"),
        joint_element(2, "a", "b"),
    );
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(path, text).unwrap();
    compiler_messages(&format!("urdf = \"{name}\""), "")
}

#[test]
fn comma_separated_file_values_are_one_error() {
    for (name, xyz, axis) in [("commas.urdf", "0, 0, 1", "0, 0, 1"), ("decimal.urdf", "0,5 0 1", "0 0 1")] {
        let found = messages_for_joint_origin_and_axis(name, xyz, axis);
        let good = matches!(found.as_slice(), [one] if one.contains("expected 3 numbers in `xyz`, found")
            && one.contains("spaces between the numbers instead of commas"));
        assert!(good, "{found:#?}");
    }
    assert_eq!(messages_for_joint_origin_and_axis("spaces.urdf", "0 0 1", "0 0 1"), Vec::<String>::new());
}

#[test]
fn wrong_file_path_is_one_error() {
    let found = compiler_messages(
        "urdf = \"no_such_robot.urdf\", lock = [\"a\"]",
        "#[acts(on = elbow)] motor: Torque",
    );
    let good = matches!(found.as_slice(), [one] if one.starts_with("there is no file `no_such_robot.urdf`")
        && one.contains("= help: "));
    assert!(good, "{found:#?}");
}

/// Robot on a pedestal. The second link has no mass properties, and the last joint is fixed.
const ROBOT: &str = r#"<robot name="r">
<link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="bare"/>
<link name="hand"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="turn" type="continuous"><parent link="base"/><child link="bare"/></joint>
<joint name="mount" type="fixed"><parent link="bare"/><child link="hand"/></joint>
</robot>"#;

/// Value of the option `parameters`, first line of the message and part of the help.
const PARAMETERS: &[(&str, &str, &str)] = &[
    ("inertial(\"hnad\")", "unknown link `hnad` in `parameters`", "did you mean `hand`?"),
    ("placement(\"tunr\")", "unknown joint `tunr` in `parameters`", "did you mean `turn`?"),
    ("inertial(\"bare\")", "link `bare` has no mass properties in the file", "remove it from `parameters`"),
    (
        "inertial(\"base\")",
        "link `base` is fixed to the ground: its mass properties appear in no equation",
        "remove it from `parameters`",
    ),
    ("damping(\"mount\")", "joint `mount` has no damping", "about one axis"),
    ("placement(\"root_joint\")", "joint `root_joint` has no placement", "the root of the file"),
    ("inertail", "unknown file parameters `inertail`", "did you mean `inertial`?"),
    ("mass(\"hand\")", "unknown file parameters `mass`", "`inertial`, `placement`, `damping` or `friction`"),
    ("[damping, damping]", "`damping` is given twice", "list all names in one"),
    ("inertial(\"hand\", \"hand\")", "link `hand` is given twice", "remove one of the two"),
    ("\"hand\"", "expected a group of file parameters, found a string", "write `inertial(\"hand\")`"),
    ("inertial(hand)", "expected a name in quotation marks", "names of the file are strings"),
    ("inertial()", "missing name in these parentheses", "write `inertial` alone"),
    ("3", "expected a group of file parameters", "write `parameters = inertial(\"link\")`"),
];

#[test]
fn invalid_parameters_of_robot_files_are_reported() {
    fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("figures.urdf"), ROBOT).unwrap();
    let mut wrong = Vec::new();
    for (said, message, help) in PARAMETERS {
        let found = compiler_messages(&format!("urdf = \"figures.urdf\", parameters = {said}"), "");
        let good = matches!(found.as_slice(), [one] if one.lines().next().is_some_and(|line| line.ends_with(message))
            && one.contains(help));
        if !good {
            wrong.push(format!("{said}: {found:#?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for good in [
        "inertial",
        "inertial(\"hand\")",
        "[inertial, placement, damping(\"turn\"), friction]",
        "[placement,]",
    ] {
        let found = compiler_messages(&format!("urdf = \"figures.urdf\", parameters = {good}, prepare"), "");
        assert_eq!(found, Vec::<String>::new(), "{good}");
    }
    let rest = [
        ("parameters = inertial", "", "`parameters` is an option of imported files"),
        ("urdf = \"figures.urdf\", parameters = inertial", "hand: f64,", "the name `hand` is used twice"),
        ("urdf = \"figures.urdf\", inertia = none, parameters = inertial", "", "`inertial` needs inertia"),
    ];
    for (attribute, field, message) in rest {
        let fields = match attribute.contains("urdf") {
            true => field.to_string(),
            false => super::ARM.to_string(),
        };
        let found = compiler_messages(attribute, &fields);
        assert!(matches!(found.as_slice(), [one] if one.starts_with(message)), "{attribute}: {found:#?}");
    }
}

#[test]
fn collision_geometry_is_read_when_referenced() {
    let robot_with_collision_geometry = |inside: &str| {
        let foot = format!("<link name=\"foot\"><collision><geometry>{inside}</geometry></collision></link>");
        let sole = r#"<joint name="sole" type="fixed"><origin xyz="0 0.5 0"/><parent link="hand"/><child link="foot"/></joint>"#;
        ROBOT.replacen("</robot>", &format!("{foot}\n{sole}\n</robot>"), 1)
    };
    let cases = [
        ("<sphere radius=\"0.1\"/>", "foot", ""),
        ("<sphere radius=\"0.1\"/>", "", ""),
        ("<mesh filename=\"foot.stl\"/>", "", "cannot read the mesh `foot.stl`: "),
        ("<sphere radius=\"0\"/>", "foot", "this length must be positive, but it is 0"),
        ("<box size=\"1 2\"/>", "foot", "expected 3 numbers in `size`, found `1 2`"),
        ("<cylinder radius=\"1\"/>", "foot", "`<cylinder>` without `length`"),
        ("<cone radius=\"1\"/>", "foot", "collision geometry without a supported shape"),
        (
            "<mesh filename=\"shapes/foot.dae\"/>",
            "foot",
            "mesh `shapes/foot.dae` has an unsupported format: expected `.stl`, ",
        ),
        (
            "<mesh filename=\"shapes/flat.obj\"/>",
            "foot",
            "mesh `shapes/flat.obj` has no convex hull: its vertices ",
        ),
        ("<mesh filename=\"shapes/flat.obj\"/>", "hand", "`hand` has no collision geometry"),
        ("<mesh filename=\"package://r/shapes/foot.obj\" scale=\"1 1 2\"/>", "foot", ""),
        ("<sphere radius=\"0.1\"/>", "hand", "`hand` has no collision geometry"),
        ("<sphere radius=\"0.1\"/>", "food", "unknown point `food`"),
    ];
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("shapes");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("foot.dae"), "<COLLADA/>").unwrap();
    fs::write(folder.join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n").unwrap();
    fs::write(folder.join("foot.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n").unwrap();
    for (k, (inside, link, message)) in cases.into_iter().enumerate() {
        let name = format!("shapes{k}.urdf");
        fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join(&name), robot_with_collision_geometry(inside))
            .unwrap();
        let contact = match link {
            "" => "#[contact(ground.plane(z), collision())] floor: Contact".to_string(),
            link => format!("#[contact({link}.collision(), ground.plane(z))] floor: Contact"),
        };
        let found = compiler_messages(&format!("urdf = \"{name}\""), &contact);
        let good = match found.as_slice() {
            [] => message.is_empty(),
            [one] => !message.is_empty() && one.contains(message),
            _ => false,
        };
        assert!(good, "{inside}: {found:#?}");
    }
}
