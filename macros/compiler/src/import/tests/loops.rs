//! Loops of URDF files: joints and constraints of other tools, and the option `loops`.

use super::*;

/// Returns a chain of two pins with an extension that connects its ends.
fn two_pin_chain_with_extension(extension: &str) -> String {
    let links = ["a", "b", "c"].map(massless_link).concat();
    let joints = [
        joint_element("ab", "revolute", "a", "b", "<origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/>"),
        joint_element("bc", "revolute", "b", "c", "<origin xyz='0 2 0'/>"),
    ];
    format!("<robot name='r'>{links}{}\n{extension}</robot>", joints.concat())
}

const TREE: &str = "body a\nbody b\nbody c\nWeld root_joint: ground -> a
    Pin ab: a.at([1, 0, 0]).rotated(z(1.5707963267948966)) -> b about [1, 0, 0]
    Pin bc: b.at([0, 2, 0]) -> c about [1, 0, 0]\n";

const LOOP_JOINT: &str = "<loop_joint name='l' type='spherical'>
    <link1 link='a' xyz='1 2 3'/><link2 link='c' xyz='4 5 6' rpy='0 0 0'/></loop_joint>";

const GAZEBO: &str = "<gazebo><joint name='g' type='revolute'><parent>a</parent><child>c</child>
    <pose>0 0 1 0 0 0</pose><axis><xyz>0 0 1</xyz></axis></joint></gazebo>";

const BALL: &str = "<drake:ball_constraint><drake:ball_constraint_body_A name='a'/>
    <drake:ball_constraint_body_B name='c'/><drake:ball_constraint_p_AP value='1 0 0'/>
    <drake:ball_constraint_p_BQ value='0 2 0'/></drake:ball_constraint>";

fn options_with_loops(loops: LoopOption) -> FileOptions {
    FileOptions { loops, ..default_file_options() }
}

/// Checks the frames of the joints. Gazebo places the frame on the parent by the configuration zero: `c` is
/// rotated by a quarter turn, at `(1 − 2, 0, 0)`.
#[test]
fn extensions_close_loops() {
    let close = options_with_loops(LoopOption::Close);
    let check_loop_closing_extension = |extension: &str, expected: &str| {
        check_import_with_options(
            &close,
            &two_pin_chain_with_extension(extension),
            &format!("{TREE}{expected}"),
        );
    };
    check_loop_closing_extension(LOOP_JOINT, "Ball l: a.at([1, 2, 3]) -> c.at([4, 5, 6])");
    // The documentation of Isaac Sim names both links `link1`.
    check_loop_closing_extension(
        &LOOP_JOINT.replace("link2", "link1"),
        "Ball l: a.at([1, 2, 3]) -> c.at([4, 5, 6])",
    );
    check_loop_closing_extension(
        GAZEBO,
        "Pin g: a.at([-1, 0, 1]).rotated(z(1.5707963267948966)) -> c.at([0, 0, 1]) about [0, 0, 1]",
    );
    check_loop_closing_extension(
        &GAZEBO.replace("<xyz>0 0 1", "<xyz expressed_in='__model__'>1 0 0"),
        "Pin g: a.at([-1, 0, 1]).rotated(z(1.5707963267948966)) -> c.at([0, 0, 1]) about [0, -1, 0]",
    );
    check_loop_closing_extension(BALL, "Ball ball_constraint: a.at([1, 0, 0]) -> c.at([0, 2, 0])");
}

#[test]
fn loops_of_extensions_need_the_option() {
    for (extension, name) in [(LOOP_JOINT, "l"), (GAZEBO, "g"), (BALL, "ball_constraint")] {
        let text = two_pin_chain_with_extension(extension);
        let error = import_as_text(&default_file_options(), &text);
        assert!(error.contains(&format!("`{name}` closes a loop")), "{error}");
        assert!(error.contains("loops = close") && error.contains("loops = ignore"), "{error}");
        let ignored = format!("{TREE}left out joint {name}, which closes a loop");
        check_import_with_options(&options_with_loops(LoopOption::Ignore), &text, &ignored);
    }
    let links = ["a", "b", "c"].map(massless_link).concat();
    let joints = ["ab", "ac", "bc"].map(|name| joint_element(name, "fixed", &name[..1], &name[1..], ""));
    let tree = "body a\nbody b\nbody c\nWeld root_joint: ground -> a\nWeld ab: a -> b\nWeld ac: a -> c\n";
    check_import_with_options(
        &options_with_loops(LoopOption::Ignore),
        &format!("<robot name='r'>{links}{}</robot>", joints.concat()),
        &format!("{tree}left out joint bc, which closes a loop"),
    );
}

/// Checks that elements with forces or constraints are not left out silently.
#[test]
fn unsupported_loop_elements_are_errors() {
    for (extension, message) in [
        ("<drake:linear_bushing_rpy/>", "`<drake:linear_bushing_rpy>` is not supported"),
        ("<drake:linear_spring_damper/>", "`<drake:linear_spring_damper>` is not supported"),
        ("<drake:tendon_constraint/>", "`<drake:tendon_constraint>` is not supported"),
        ("<drake:joint name='j' type='universal'/>", "`<drake:joint>` is not supported"),
        ("<mujoco><equality><connect/></equality></mujoco>", "`<equality>` is not supported"),
        ("<loop_joint name='l' type='floating'/>", "a loop joint of type `floating` is not supported"),
        (
            "<loop_joint name='l' type='fixed'><link1 link='a'/></loop_joint>",
            "`<loop_joint>` without `<link2>`",
        ),
        (&LOOP_JOINT.replace("link='c'", "link='d'"), "unknown link `d`"),
        (&GAZEBO.replace(">c<", ">d<"), "unknown link `d`"),
        (&GAZEBO.replace("revolute", "screw"), "a joint of type `screw` in `<gazebo>` is not supported"),
        (&GAZEBO.replace("<pose>", "<pose relative_to='a'>"), "a pose relative to `a` is not supported"),
        (&GAZEBO.replace("0 0 1</xyz>", "0 0 0</xyz>"), "axis of zero length has no direction"),
        (&BALL.replace("p_BQ", "p_BC"), "`<drake:ball_constraint>` without `<drake:ball_constraint_p_BQ>`"),
    ] {
        let error =
            import_as_text(&options_with_loops(LoopOption::Close), &two_pin_chain_with_extension(extension));
        assert!(error.contains(message), "{extension}: {error}");
    }
    let damped = GAZEBO.replace("</xyz>", "</xyz><dynamics><damping>2</damping></dynamics>");
    let error =
        import_as_text(&options_with_loops(LoopOption::Close), &two_pin_chain_with_extension(&damped));
    assert!(error.contains("joint `g` closes a loop, and has forces"), "{error}");
}

#[test]
fn two_roots_and_a_loop_are_reported() {
    let links = ["a", "b", "c"].map(massless_link).concat();
    let joints = joint_element("ab", "fixed", "a", "b", "") + &joint_element("cb", "fixed", "c", "b", "");
    let text = format!("<robot name='r'>{links}{joints}</robot>");
    let error = import_as_text(&options_with_loops(LoopOption::Close), &text);
    let expected = "expected one link that is not the child of a joint, found `a`, `c`";
    assert!(error.contains(expected), "{error}");
    assert!(error.contains("joints that close loops carry no link: `cb`"), "{error}");
    let error = import_as_text(&default_file_options(), &text);
    assert!(error.contains("link `b` is the child of two joints, `ab` and `cb`"), "{error}");
}
