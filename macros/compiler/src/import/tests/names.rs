//! Names, the kinematic tree and the order of the coordinates.

use super::*;

#[test]
fn joints_are_ordered_depth_first_and_alphabetically() {
    let links: String = ["tip", "a", "b", "c", "base"].map(massless_link).concat();
    let joints = [
        joint_element("second", "revolute", "base", "b", ""),
        joint_element("zzz", "revolute", "a", "tip", ""),
        joint_element("first", "revolute", "base", "a", ""),
        joint_element("First", "revolute", "base", "c", ""),
    ];
    check_import_of_robot_elements(
        &(links + &joints.concat()),
        "body base
         body c
         body a
         body tip
         body b
         Weld root_joint: ground -> base
         Pin First: base -> c about [1, 0, 0]
         Pin first: base -> a about [1, 0, 0]
         Pin zzz: a -> tip about [1, 0, 0]
         Pin second: base -> b about [1, 0, 0]",
    );
}

#[test]
fn root_link_is_fixed_or_free() {
    let free =
        FileOptions { base: BaseAttachment::Free, inputs: FileInputSource::Joints, ..default_file_options() };
    check_import_with_options(
        &free,
        "<robot><link name='any &amp; name'/></robot>",
        "body any & name\nFree root_joint: ground -> any & name",
    );
    let text = joint_element("root_joint", "fixed", "a", "root_joint2", "");
    check_import_of_robot_elements(
        &(massless_link("a") + &massless_link("root_joint2") + &text),
        "body a
         body root_joint2
         Weld root_joint3: ground -> a
         Weld root_joint: a -> root_joint2",
    );
}

#[test]
fn elements_without_mechanics_are_ignored() {
    check_import_with_default_options(
        r#"<?xml version="1.0"?> <!-- <robot> --> <robot name="r" xmlns:drake="d" version="1.0">
           <material name="grey"><color rgba="0 0 0 1"/></material>
           <link name="a"><visual><origin xyz="x"/></visual><collision/><drake:inertial/></link>
           <drake:joint/> <gazebo reference="a"><link/><plugin file="$(find x)">${y}</plugin></gazebo>
           <transmission><joint name="nobody"/></transmission> text <![CDATA[<link/>]]>
           </robot>"#,
        "body a
         Weld root_joint: ground -> a",
    );
}

#[test]
fn duplicate_names_are_rejected() {
    let text = [massless_link("a"), massless_link("b"), massless_link("a")].join("\n");
    let joints =
        [joint_element("j", "fixed", "a", "b", ""), joint_element("j", "fixed", "b", "a", "")].join("\n");
    check_import_of_robot_elements(
        &format!("{text}\n{joints}"),
        "r.urdf:4:13: second link with the name `a`
         = help: the first is at r.urdf:2:13
         r.urdf:6:14: second joint with the name `j`
         = help: the first is at r.urdf:5:14",
    );
    let links = [massless_link("a"), massless_link("ground")].join("\n");
    check_import_of_robot_elements(
        &format!("{links}\n{}", joint_element("j", "fixed", "a", "ground", "")),
        "body a
         body ground_link
         Weld root_joint: ground -> a
         Weld j: a -> ground_link",
    );
    check_import_of_robot_elements(
        &format!("{links}\n{}", massless_link("ground")),
        "r.urdf:4:13: second link with the name `ground`
         = help: the first is at r.urdf:3:13",
    );
    let free =
        FileOptions { base: BaseAttachment::Free, inputs: FileInputSource::Joints, ..default_file_options() };
    let both = [massless_link("ground"), massless_link("ground_link")].concat();
    check_import_with_options(
        &free,
        &format!("<robot>{both}{}</robot>", joint_element("j", "fixed", "ground", "ground_link", "")),
        "body ground_link2
         body ground_link
         Free root_joint: ground -> ground_link2
         Weld j: ground_link2 -> ground_link",
    );
    // A fixed root of this name is the ground.
    check_import_of_robot_elements(
        &format!("{links}\n{}", joint_element("j", "fixed", "ground", "a", "")),
        "the root is the ground\nbody a\nWeld j: ground -> a",
    );
    check_import_of_robot_elements(
        "<link name=' '/><link/><link nmae='a'/>",
        r#"r.urdf:2:13: empty `name` of `<link>`
           = help: write a name: `name="…"`
           r.urdf:2:17: `<link>` without `name`
           = help: expected `<link name="…"/>`
           r.urdf:2:30: unknown attribute `nmae` of `<link>`
           = help: did you mean `name`?"#,
    );
}

#[test]
fn joints_to_missing_links_are_rejected() {
    let joints =
        [joint_element("j", "fixed", "base", "arms", ""), joint_element("k", "fixed", "arm", "arm", "")]
            .join("\n");
    check_import_of_robot_elements(
        &format!("{}{}\n{joints}", massless_link("base"), massless_link("arm")),
        "r.urdf:3:64: unknown link `arms`
         = help: did you mean `arm`?
         r.urdf:4:63: joint `k` connects a link to itself",
    );
    check_import_with_default_options(
        "<robot/>",
        "r.urdf:1:1: robot without a link\n= help: expected `<link name=\"…\"/>`",
    );
}

/// Files with joints from `world` need not declare this link.
#[test]
fn link_named_world_needs_no_declaration() {
    let links = massless_link("a") + &massless_link("b");
    let joints =
        [joint_element("j", "fixed", "world", "a", ""), joint_element("k", "fixed", "world", "b", "")]
            .concat();
    check_import_of_robot_elements(
        &(links.clone() + &joints),
        "body world
         body a
         body b
         Weld root_joint: ground -> world
         Weld j: world -> a
         Weld k: world -> b",
    );
    check_import_of_robot_elements(
        &format!("{links}\n{}", joint_element("j", "fixed", "a", "world", "")),
        "r.urdf:3:61: unknown link `world`
         = help: expected `a` or `b`",
    );
}

#[test]
fn link_with_two_parent_joints_is_rejected() {
    let links = ["a", "b", "c"].map(massless_link).concat();
    let joints = [
        joint_element("ab", "fixed", "a", "b", ""),
        joint_element("ac", "fixed", "a", "c", ""),
        joint_element("bc", "fixed", "b", "c", ""),
    ];
    check_import_of_robot_elements(
        &format!("{links}\n{}", joints.join("\n")),
        "r.urdf:5:62: link `c` is the child of two joints, `ac` and `bc`
         = help: the first is at r.urdf:4:62
         = help: if one of them closes a loop, write `#[mechanism(…, loops = close)]`",
    );
}

/// Checks that the first of two joints with one child belongs to the tree, unless its parent hangs from the
/// child.
#[test]
fn second_parent_joint_closes_a_loop() {
    let options = FileOptions { loops: LoopOption::Close, ..default_file_options() };
    let robot_with_joints = |joints: &[String]| {
        format!("<robot name='r'>{}{}</robot>", ["a", "b", "c"].map(massless_link).concat(), joints.concat())
    };
    let (ab, ac) = (joint_element("ab", "fixed", "a", "b", ""), joint_element("ac", "fixed", "a", "c", ""));
    let (bc, cb) =
        (joint_element("bc", "floating", "b", "c", ""), joint_element("cb", "continuous", "c", "b", ""));
    let expected_tree =
        |joints: &str| format!("body a\nbody b\nbody c\nWeld root_joint: ground -> a\n{joints}");
    let last = expected_tree("Weld ab: a -> b\nWeld ac: a -> c\nPin cb: c -> b about [1, 0, 0]");
    check_import_with_options(&options, &robot_with_joints(&[ab.clone(), ac, cb.clone()]), &last);
    let first = expected_tree("Weld ab: a -> b\nFree bc: b -> c\nPin cb: c -> b about [1, 0, 0]");
    check_import_with_options(&options, &robot_with_joints(&[cb.clone(), ab, bc.clone()]), &first);
    let without_root = import_as_text(&options, &robot_with_joints(&[bc, cb]));
    assert!(without_root.contains("links `b`, `c` form a cycle"), "{without_root}");
}

#[test]
fn several_root_links_are_rejected() {
    let links = ["a", "b", "c", "d"].map(massless_link).join("\n");
    check_import_of_robot_elements(
        &(links.clone() + &joint_element("j", "fixed", "a", "b", "")),
        "r.urdf:4:13: expected one link that is not the child of a joint, found `a`, `c`, `d`
         = help: every link but one needs a joint that has it as its child",
    );
    let many: String = (0..20).map(|k| massless_link(&format!("l{k}"))).collect();
    check_import_of_robot_elements(
        &many,
        "r.urdf:2:30: expected one link that is not the child of a joint, found `l0`, `l1`, `l2`, `l3`, `l4`, `l5`, `l6`, `l7`, …
         = help: every link but one needs a joint that has it as its child",
    );
}

#[test]
fn circular_parent_links_are_rejected() {
    let links = ["a", "b", "c"].map(massless_link).concat();
    let joints = [
        joint_element("ba", "fixed", "b", "a", ""),
        joint_element("cb", "fixed", "c", "b", ""),
        joint_element("ac", "fixed", "a", "c", ""),
    ];
    let circle = format!("{links}\n{}", joints.join("\n"));
    let expected = "r.urdf:3:45: links `a`, `b`, `c` form a cycle
                    = help: joint `ba` closes the cycle; a tree has a root";
    check_import_of_robot_elements(&circle, expected);
    let tail =
        massless_link("root") + &massless_link("tail") + &joint_element("at", "fixed", "a", "tail", "");
    check_import_of_robot_elements(&(circle + &tail), expected);
}

#[test]
fn long_chains_of_links_fit_the_stack() {
    let joints = vec![("revolute", "<mimic joint='j1000'/>"); 999];
    let text = chain_of_links(&[joints, vec![("revolute", "")]].concat());
    let imported = import_text(&text, &default_file_options(), &mut Diagnostics::new());
    assert!(imported.is_some_and(|imported| imported.joints.len() == 1001 && imported.bodies.len() == 1001));
}

#[test]
fn too_many_links_are_rejected() {
    let crowd: String = (0..2000).map(|k| massless_link(&format!("l{k}"))).collect();
    let column = 1 + (0..1024).map(|k| massless_link(&format!("l{k}")).len()).sum::<usize>();
    check_import_of_robot_elements(&crowd, &format!("r.urdf:2:{column}: more than 1024 elements `<link>`"));
    let crowd = "<joint/>".repeat(2000);
    let messages = import_as_text(&default_file_options(), &format!("<robot>{crowd}</robot>"));
    assert_eq!(messages.matches("r.urdf:1:").count(), 32);
    assert!(messages.ends_with("`r.urdf` has more errors; these are the first 32"), "{messages}");
}
