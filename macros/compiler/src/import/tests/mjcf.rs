//! Tests of MJCF files: results of valid files and errors of invalid ones.

use super::*;

pub(super) fn mjcf_options() -> FileOptions {
    FileOptions {
        format: FileFormat::Mjcf,
        path: name_at_call_site("r.xml"),
        inputs: FileInputSource::Actuators,
        ..default_file_options()
    }
}

/// Compares the result of a file with these elements. The elements begin on the second line.
pub(super) fn check_import_of_mjcf_elements(inside: &str, expected: &str) {
    check_import_with_options(&mjcf_options(), &format!("<mujoco>\n{inside}\n</mujoco>"), expected);
}

/// Compares the import of an MJCF body that contains these elements with `expected`.
fn check_import_of_mjcf_body(inside: &str, expected: &str) {
    check_import_of_mjcf_elements(
        &format!("<worldbody><body name=\"b\">{inside}</body></worldbody>"),
        expected,
    );
}

const BALL: &str = "<geom size='.1' mass='1'/>";

#[test]
fn joints_of_one_mjcf_body_are_chained() {
    check_import_of_mjcf_body(
        "<joint name='j' pos='1 0 0'/><joint name='k' type='slide' axis='2 0 0' ref='3'/><geom size='1' mass='5'/>",
        "the root is the ground
         body b_j
         body b mass=5 inertia=[[2, 0, 0], [0, 2, 0], [0, 0, 2]]
         Pin j: ground.at([1, 0, 0]) -> b_j.at([1, 0, 0]) about [0, 0, 1]
         Sleeve k: b_j.at([-3, 0, 0]) -> b along [1, 0, 0]
         left out geometry of bodies, for contact: 1 shapes",
    );
}

#[test]
fn unnamed_mjcf_elements_get_generated_names() {
    check_import_of_mjcf_body(
        "<body><joint type='slide'/></body><body name='body2'/>",
        "the root is the ground
         body b
         body body22
         body body2
         Weld b_weld: ground -> b
         Sleeve body22_slide: b -> body22 along [0, 0, 1]
         Weld body2_weld: b -> body2",
    );
}

#[test]
fn mjcf_default_classes_are_inherited() {
    let classes = "<default><joint damping='1'/><default class='a'><joint armature='2'/><default class='c'><joint type='slide'/></default></default></default>";
    let model_with_body = |inside: &str| {
        format!("{classes}<worldbody><body name='b' childclass='a'>{inside}{BALL}</body></worldbody>")
    };
    let ball = "body b mass=1 inertia=[[0.004000000000000001, 0, 0], [0, 0.004000000000000001, 0], [0, 0, 0.004000000000000001]]";
    let end = "left out geometry of bodies, for contact: 1 shapes";
    check_import_of_mjcf_elements(
        &model_with_body("<joint name='j'/>"),
        &format!(
            "the root is the ground\n{ball}\nPin j: ground -> b about [0, 0, 1] damping=1\nj: inerter 2 on 1 j\n{end}"
        ),
    );
    check_import_of_mjcf_elements(
        &model_with_body("<joint name='j' class='c' damping='7'/>"),
        &format!(
            "the root is the ground\n{ball}\nSleeve j: ground -> b along [0, 0, 1] damping=7\nj: inerter 2 on 1 j\n{end}"
        ),
    );
    check_import_of_mjcf_elements(
        &model_with_body("<joint name='j' class='d'/>"),
        "r.xml:2:204: unknown class `d`
         = help: expected `a`, `c` or `main`",
    );
}

/// Unsupported attributes that affect the motion are reported.
#[test]
fn unsupported_mjcf_attributes_are_reported() {
    for (inside, at, message, help) in [
        (
            "<joint type='ball' stiffness='1'/>",
            "1'",
            "`stiffness` of a `ball` joint is not supported",
            "to ignore springs, damping and friction, write `#[mechanism(…, passive = ignore)]`",
        ),
        ("<joint type='hing'/>", "hing'", "unknown joint type `hing`", "did you mean `hinge`?"),
        ("<geom type='mesh' mesh='m'/>", "m'/>", "unknown mesh `m`", ""),
        ("<geom type='mesh'/>", "<geom", "a shape of type `mesh` without `mesh`", ""),
        (
            "<geom type='box' mesh='m'/>",
            "<geom",
            "the mass properties of a shape that is fitted to a mesh are not computed",
            "give the body an `<inertial pos=\"…\" mass=\"…\" diaginertia=\"…\"/>`, or the shape `mass=\"0\"`; MuJoCo's `compile` writes a file that has them",
        ),
        ("<geom type='bix' size='1 1 1'/>", "bix", "unknown shape `bix`", "did you mean `box`?"),
        (
            "<geom type='box' size='1 -1 1'/>",
            "1 -1",
            "a `box` of size `1 -1 1` has no volume",
            "expected half lengths and radii above zero",
        ),
        (
            "<composite type='grid'/>",
            "<comp",
            "`<composite>` is not supported",
            "MuJoCo can write the expanded model: `mj_saveLastXML`, or its program `compile`",
        ),
        ("<joint axis='0 0 0'/>", "0 0", "axis of zero length has no direction", ""),
        (
            "<joint dampng='1'/>",
            "dampng",
            "unknown attribute `dampng` of `<joint>`",
            "did you mean `damping`?",
        ),
        ("<bdy/>", "<bdy", "unknown element `<bdy>`", "did you mean `<body>`?"),
        (
            "<joint range='2 1'/>",
            "2 1",
            "`range` from 2 to 1, which is not above it",
            "to ignore limits, write `#[mechanism(…, limits = ignore)]`",
        ),
        (
            "<freejoint/><joint/>",
            "<freejoint",
            "free joint `b_free` of a body with other joints or a parent",
            "a free body is a child of `<worldbody>` and has no other joint",
        ),
        (
            "<inertial pos='0 0 0'/>",
            "<inertial",
            "`<inertial>` without `mass`",
            "expected `<inertial pos=\"…\" mass=\"…\"/>`",
        ),
        (
            "<geom size='1' euler='0 0 1' quat='1 0 0 0'/>",
            "1 0 0 0",
            "an orientation is given once, but here are `quat` and `euler`",
            "",
        ),
        ("<geom size='1' quat='0 0 0 0'/>", "0 0 0 0", "a quaternion of length 0 has no direction", ""),
    ] {
        let column = "<worldbody><body name=\"b\">".len() + inside.find(at).expect("it stands there") + 1;
        let help = if help.is_empty() { String::new() } else { format!("\n= help: {help}") };
        check_import_of_mjcf_body(inside, &format!("r.xml:2:{column}: {message}{help}"));
    }
}

#[test]
fn unknown_sections_and_unsupported_options_are_reported() {
    for (inside, expected) in [
        (
            "<worldbdy/>",
            "r.xml:2:1: unknown element `<worldbdy>`\n= help: did you mean `<worldbody>`?\nr.xml:1:1: `<mujoco>` without `<worldbody>`",
        ),
        (
            "<worldbody/><option density='1' wind='1 0 0'/>",
            "r.xml:2:39: the `wind` of a medium that bodies move through is not supported\n= help: to ignore \
             springs, damping and friction, write `#[mechanism(…, passive = ignore)]`",
        ),
        (
            "<worldbody/><option viscosity='-1'/>",
            "r.xml:2:32: a medium of the density 0 and the viscosity -1\n= help: expected numbers that are \
             not negative\n= help: to ignore springs, damping and friction, write `#[mechanism(…, passive = \
             ignore)]`",
        ),
        (
            "<option density='1'/><worldbody><body><joint/><geom size='1' fluidshape='ellipsoid'/></body></worldbody>",
            "r.xml:2:47: `fluidshape` in a medium is not supported\n= help: to ignore springs, damping and friction, write `#[mechanism(…, passive = ignore)]`",
        ),
        (
            "<worldbody/><compiler eulerseq='xyw'/>",
            "r.xml:2:33: unknown `eulerseq` `xyw`\n= help: expected three letters of `x`, `y`, `z`, capital about fixed axes",
        ),
        (
            "<worldbody/><compiler coordinate='global'/>",
            "r.xml:2:35: unknown `coordinate` `global`\n= help: expected `local`: MuJoCo has no other since version 2.3.4; let an older one convert the file",
        ),
        (
            "<worldbody/><actuator><adhesion body='b'/></actuator>",
            "r.xml:2:23: actuator `<adhesion>` is not supported\n= help: it acts at contacts, whose forces \
             MuJoCo divides among them\n= help: to ignore the actuators of the file, \
             write `#[mechanism(…, inputs = joints)]`, or `none`",
        ),
    ] {
        check_import_of_mjcf_elements(inside, expected);
    }
}

#[test]
fn non_mjcf_file_names_its_format_in_the_error() {
    for (root, help) in [
        ("robot", "this is a URDF file: write `urdf = \"…\"` instead of `mjcf = \"…\"`"),
        ("sdf", "this is an SDF file: write `sdf = \"…\"` instead of `mjcf = \"…\"`"),
        ("mujocoinclude", "this is a part of a model: name the file that includes it"),
        ("mujco", "did you mean `mujoco`?"),
    ] {
        let expected = format!("r.xml:1:1: expected `<mujoco>`, found `<{root}>`\n= help: {help}");
        check_import_with_options(&mjcf_options(), &format!("<{root}/>"), &expected);
    }
}

#[test]
fn free_base_requires_a_body_without_joints() {
    let free = FileOptions { base: BaseAttachment::Free, ..mjcf_options() };
    check_import_with_options(
        &free,
        "<mujoco><worldbody><body name='b'/></worldbody></mujoco>",
        "the root is the ground\nbody b\nFree root_joint: ground -> b",
    );
    check_import_with_options(
        &free,
        "<mujoco><worldbody><body name='b'><joint/></body></worldbody></mujoco>",
        "`base = free` does not fit this file: its outermost body has joints
         = help: an MJCF file determines the base itself: write `<freejoint/>` into a body, and remove `base`",
    );
}

#[test]
fn mjcf_includes_replace_the_include_element() {
    let files = [
        ("parts/arm.xml", "<mujoco>\n<!-- é --><worldbody><include file='hand.xml'/></worldbody></mujoco>"),
        ("hand.xml", "<x><body name='hand'><joint name='j'/></body>\n</x>"),
        ("bad.xml", "<x>\n  <worldbody>\n<body><joint type='no'/></body></worldbody></x>"),
        ("broken.xml", "<x>\n<y></x>"),
        ("a.xml", "<x><include file='b.xml'/></x>"),
        ("b.xml", "<x>\n<include file='parts/../a.xml'/></x>"),
    ];
    let folder = Folder::new("includes", &files);
    let wrap_in_mujoco = |inside: &str| format!("<mujoco>\n{inside}</mujoco>");
    assert_eq!(
        folder.import_as_text(&mjcf_options(), &wrap_in_mujoco("<include file='parts/arm.xml'/>")),
        "the root is the ground\nbody hand\nPin j: ground -> hand about [0, 0, 1]\n2 files"
    );
    for (inside, expected) in [
        (
            "<include file='bad.xml'/>",
            "bad.xml:3:20: unknown joint type `no`\n\n= help: expected `hinge`, `slide`, `ball` or `free`",
        ),
        ("<include file='broken.xml'/>", "broken.xml:2:4: malformed XML: expected `</y>`, found `</x>`"),
        (
            "<include file='a.xml'/>",
            "b.xml:2:16: `a.xml` includes itself\n\n= help: through `b.xml` at a.xml:1:19",
        ),
        ("<include file='hand.xml'/><include file='hand.xml'/>", "r.xml:2:42: `hand.xml` is included twice"),
        ("<include file='parts'/>", "r.xml:2:16: `parts` is a directory, expected an MJCF file"),
        (
            "<include file='hend.xml'/>",
            "r.xml:2:16: there is no file `hend.xml`\n\n= help: did you mean `hand.xml`?",
        ),
        (
            "<include fil='hand.xml'/>",
            "r.xml:2:10: unknown attribute `fil` of `<include>`\n\n= help: did you mean `file`?",
        ),
    ] {
        let answer = folder.import_as_text(&mjcf_options(), &wrap_in_mujoco(inside));
        assert!(answer.starts_with(expected), "{answer}");
    }
}

#[test]
fn unreadable_mesh_files_are_reported() {
    let files = [("a.obj", "v 0 0 0\nf 1 1 1\n"), ("b.stl", "solid ascii"), ("c.dae", "<COLLADA/>")];
    let folder = Folder::new("meshes", &files);
    for (asset, expected) in [
        ("file='a.obj'", "r.xml:1:28: mesh `a.obj` has no volume"),
        ("file='b.stl'", "r.xml:1:28: mesh `b.stl` is damaged, or has the wrong extension"),
        (
            "file='c.dae'",
            "r.xml:1:28: mesh `c.dae` has an unsupported format: expected `.stl`, `.obj` or `.msh`",
        ),
        ("file='no.stl'", "r.xml:1:28: cannot read the mesh `no.stl`: "),
        ("name='no'", "r.xml:1:16: the mass of a mesh without `file` is not computed"),
    ] {
        let stem = asset.split(['\'', '.']).nth(1).unwrap_or_default();
        let answer = folder.import_as_text(
            &mjcf_options(),
            &format!(
                "<mujoco><asset><mesh {asset}/></asset><worldbody><body><geom type='mesh' mesh='{stem}'/></body></worldbody></mujoco>"
            ),
        );
        assert!(answer.starts_with(expected), "{answer}");
    }
}

#[test]
fn adversarial_mjcf_files_terminate() {
    let deep =
        format!("<mujoco><worldbody>{}{}</worldbody></mujoco>", "<body>".repeat(300), "</body>".repeat(300));
    assert!(import_as_text(&mjcf_options(), &deep).contains("more than 256 nested elements"));
    let chain = format!(
        "<mujoco><worldbody>{}{}</worldbody></mujoco>",
        "<body><joint type='slide'/>".repeat(250),
        "</body>".repeat(250)
    );
    assert!(import_as_text(&mjcf_options(), &chain).contains("Sleeve body250_slide"));
    let many = format!("<mujoco><worldbody>{}</worldbody></mujoco>", "<body/>".repeat(2000));
    assert!(import_as_text(&mjcf_options(), &many).contains("more than 1024 bodies"));
    let entity = "<!DOCTYPE x [<!ENTITY a 'b'>]><mujoco/>";
    assert!(
        import_as_text(&mjcf_options(), entity)
            .contains("an MJCF file has no document type and no entities of its own")
    );
    check_import_of_mjcf_body(
        "<geom size='1e200' mass='1'/><joint axis='1e300 1e300 0'/>",
        "r.xml:2:24: body `b` is too large, too heavy or too far away for floating-point numbers",
    );
}

const FILE: &str = r#"<mujoco model="m"><!-- c --><compiler angle="radian" settotalmass="3"/>
  <default><joint damping=".1"/><default class="a"><geom type="box" size=".1 .2 .3"/></default></default>
  <worldbody><body name="b" childclass="a" pos="1 2 3" euler="1 0 0"><joint name="j" axis="0 1 1" ref=".1"/>
    <joint name="k" type="slide" range="0 1" stiffness="2"/><geom quat="1 1 0 0"/>
    <geom name="g" type="cylinder" size="1 1"/><site name="r"/><frame pos="1 0 0"><body name="c"><joint name="l" type="ball" damping="1"/><site name="s"/>
      <inertial pos="0 0 1" mass="1" fullinertia="1 1 1 0 0 0"/></body></frame></body></worldbody>
  <tendon><spatial name="u" damping="1"><site site="s"/><geom geom="g"/><site site="r"/><pulley divisor="2"/><site site="s"/><site site="r"/></spatial>
    <fixed name="t" stiffness="1"><joint joint="j" coef="2"/><joint joint="k" coef="3"/></fixed></tendon>
  <equality><joint joint1="k" joint2="j" polycoef="1 2"/><tendon tendon1="t" polycoef="1 0 3"/>
    <joint joint1="j" joint2="k" polycoef="0 1 2 -1 .5"/></equality>
  <actuator><motor joint="j" gear="3"/><position tendon="t" kp="2"/><motor site="s" refsite="r" gear="1 2"/></actuator></mujoco>"#;

#[test]
fn mjcf_planes_become_contacts() {
    let options = FileOptions { contacts: ContactOption::File, collisions: true, ..mjcf_options() };
    let imported_contacts_with_world = |world: &str| {
        let text = format!(
            "<mujoco><worldbody>{world}<body name='b'><freejoint/><geom name='a' size='1'/><geom size='1' condim='1' contype='2'/>\
             <geom size='1' priority='1' friction='0.2' contype='4' conaffinity='1'/></body></worldbody></mujoco>"
        );
        let mut cx = Diagnostics::new();
        match import_text(&text, &options, &mut cx) {
            Some(imported) => imported
                .contacts
                .iter()
                .map(|contact| {
                    let coefficients: Vec<String> =
                        contact.arguments.keyed_expressions().map(|(_, e)| render_expr(e)).collect();
                    let friction = coefficients.join(" ");
                    let (first, second) = (render_expr(&contact.first), render_expr(&contact.second));
                    format!("{}: {first} {second} {friction}\n", contact.name.text)
                })
                .collect(),
            None => cx.full_message_texts().join("\n"),
        }
    };
    assert_eq!(
        imported_contacts_with_world(
            "<geom type='plane' friction='0.3' pos='1 0 0' zaxis='1 0 0' conaffinity='3'/>"
        ),
        "a_contact: b.collision(0) ground.at([1, 0, 0]).plane([1, 0, 0]) 1\n\
         b_geom1_contact: b.collision(1) ground.at([1, 0, 0]).plane([1, 0, 0]) 1\n\
         b_geom2_contact: b.collision(2) ground.at([1, 0, 0]).plane([1, 0, 0]) 0.2\n"
    );
    assert_eq!(
        imported_contacts_with_world(
            "<geom type='plane' condim='1' contype='0'/><geom name='up' type='plane'/>"
        ),
        "a_plane1_contact: b.collision(0) ground.at([0, 0, 0]).plane([0, 0, 1]) 1\n\
         a_up_contact: b.collision(0) ground.at([0, 0, 0]).plane([0, 0, 1]) 1\n\
         b_geom1_up_contact: b.collision(1) ground.at([0, 0, 0]).plane([0, 0, 1]) 1\n\
         b_geom2_up_contact: b.collision(2) ground.at([0, 0, 0]).plane([0, 0, 1]) 0.2\n"
    );
    assert_eq!(
        imported_contacts_with_world(
            "<geom type='plane' condim='4' friction='0.3 0.01' conaffinity='1' contype='0'/>"
        ),
        "a_contact: b.collision(0) ground.at([0, 0, 0]).plane([0, 0, 1]) 1 0.01\n"
    );
    assert_eq!(
        imported_contacts_with_world(
            "<geom type='plane' condim='6' priority='2' friction='0.3 0.01 0.002' conaffinity='2' contype='0'/>"
        ),
        "b_geom1_contact: b.collision(1) ground.at([0, 0, 0]).plane([0, 0, 1]) 0.3 0.01 0.002\n"
    );
    for force in ["adhesion='1'", "surfacevel='1 0 0'"] {
        let refused = imported_contacts_with_world(&format!("<geom type='plane' {force}/>"));
        assert!(refused.contains("of a colliding shape is not supported"), "{refused}");
    }
    let on_box = imported_contacts_with_world("<geom type='box' size='1 1 1' contype='0' conaffinity='5'/>");
    assert_eq!(
        on_box,
        "a_world_geom0_contact: b.collision(0) ground.collision(0) 1\n\
         b_geom2_world_geom0_contact: b.collision(2) ground.collision(0) 0.2\n"
    );
}

#[test]
fn damaged_mjcf_never_panics() {
    super::fuzz::check_damaged_imports(&mjcf_options(), FILE, "ground");
}

#[test]
fn truncated_mjcf_never_panics() {
    for end in 0..FILE.len() {
        assert!(!import_as_text(&mjcf_options(), &FILE[..end]).contains("the root is"));
    }
    assert!(import_as_text(&mjcf_options(), FILE).contains("the root is"));
}

/// Checks that flags of `<option>` disable the effects that they name. The flag `constraint` disables
/// couplings, limits and dry friction.
#[test]
fn mjcf_option_flags_disable_their_effects() {
    let model_with_flags = |flags: &str| {
        format!(
            "<option><flag {flags}/></option><worldbody><body name='b'><joint name='j' range='-1 1' stiffness='5' damping='0.3' frictionloss='2'/>\
             <joint name='k'/></body></worldbody><tendon><fixed name='t' stiffness='7' damping='3' frictionloss='4'><joint joint='j' coef='2'/></fixed></tendon>\
             <equality><joint joint1='k' joint2='j'/></equality>"
        )
    };
    let (spring, damper) = ("j: spring 5 from 0 on 1 j\n", "damping=0.3");
    let (spring2, damper2) = ("t: spring 7 from 0 on 2 j\n", "t: damper 3 on 2 j\n");
    let (friction, friction2) = ("friction=2", "t: friction 4 on 2 j\n");
    let follows = " = 1 j + 0";
    for (flags, off) in [
        ("spring='disable'", vec![spring, spring2]),
        ("damper='disable'", vec![damper, damper2]),
        ("passive='disable'", vec![spring, spring2, damper, damper2]),
        ("spring='disable' damper='disable'", vec![spring, spring2, damper, damper2]),
        ("frictionloss='disable'", vec![friction, friction2]),
        ("equality='disable'", vec![follows]),
        ("constraint='disable'", vec![friction, friction2, follows]),
        ("contact='disable'", vec![]),
    ] {
        let found =
            import_as_text(&mjcf_options(), &format!("<mujoco>\n{}\n</mujoco>", model_with_flags(flags)));
        for part in [spring, spring2, damper, damper2, friction, friction2, follows] {
            assert_eq!(found.contains(part), !off.contains(&part), "{flags}: {part}\n{found}");
        }
    }
    for (flags, limits) in [("limit='disable'", 0), ("constraint='disable'", 0), ("equality='disable'", 1)] {
        let mut cx = Diagnostics::new();
        let imported =
            import_text(&format!("<mujoco>{}</mujoco>", model_with_flags(flags)), &mjcf_options(), &mut cx);
        assert_eq!(imported.map(|imported| imported.limits.len()), Some(limits), "{flags}");
    }
    let weightless = "<option><flag gravity='disable'/></option><option gravity='0 0 -1'/><worldbody/>";
    let imported =
        import_text(&format!("<mujoco>{weightless}</mujoco>"), &mjcf_options(), &mut Diagnostics::new());
    assert_eq!(
        imported.and_then(|imported| Some(render_expr(imported.gravity.as_ref()?))).as_deref(),
        Some("[0, 0, 0]")
    );
}

/// Joints and mass properties in a `<frame>`: positions and axes as in MuJoCo 4.0.0 (`jnt_pos`, `jnt_axis`,
/// `body_ipos`).
#[test]
fn mjcf_frames_place_their_contents() {
    check_import_of_mjcf_body(
        "<frame pos='1 2 3' euler='0 0 90'><joint name='j' pos='1 0 0' axis='1 0 0'/><inertial pos='1 0 0' mass='1' diaginertia='1 2 2.5'/></frame>",
        "the root is the ground
         body b mass=1 com=[1, 3, 3] inertia=[[2, 0, 0], [0, 1, 0], [0, 0, 2.5]]
         Pin j: ground.at([1, 3, 3]) -> b.at([1, 3, 3]) about [0, 1, 0]",
    );
}

/// Axes of a site between two points: z points from the second to the first point, as in MuJoCo 4.0.0
/// (`site_xmat`).
#[test]
fn sites_between_two_points_have_the_axes_of_mujoco() {
    check_import_of_mjcf_body(
        "<joint name='j'/><site name='s' type='capsule' size='.1' fromto='0 0 0 2 0 0'/>",
        "the root is the ground
         body b
         body s
         Pin j: ground -> b about [0, 0, 1]
         Weld s_weld: b.at([1, 0, 0]).rotated(y(-1.5707963267948966)) -> s",
    );
    for (inside, at, message) in [
        ("<site fromto='0 0 0 2 0 0'/>", "0 0 0", "`fromto` of a `sphere`, which has no length"),
        (
            "<geom size='1' type='box' pos='1 0 0' fromto='0 0 0 2 0 0'/>",
            "1 0 0",
            "`fromto` and `pos` of one `<geom>`",
        ),
    ] {
        let column = "<worldbody><body name=\"b\">".len() + inside.find(at).expect("it stands there") + 1;
        let answer = import_as_text(
            &mjcf_options(),
            &format!("<mujoco>\n<worldbody><body name=\"b\">{inside}</body></worldbody></mujoco>"),
        );
        assert!(answer.starts_with(&format!("r.xml:2:{column}: {message}")), "{answer}");
    }
}

/// Missing entries of an attribute are taken from the defaults: sizes as in MuJoCo 4.0.0 (`geom_size`).
#[test]
fn short_attribute_lists_are_completed_by_defaults() {
    check_import_of_mjcf_elements(
        "<default><geom type='box' size='1 2 3'/></default><worldbody><body name='b'><geom size='.5' mass='3'/></body></worldbody>",
        "the root is the ground
         body b mass=3 inertia=[[13, 0, 0], [0, 9.25, 0], [0, 0, 4.25]]
         Weld b_weld: ground -> b
         left out geometry of bodies, for contact: 1 shapes",
    );
}

/// Checks that files that MuJoCo rejects are rejected, with one error for each fault.
#[test]
fn files_that_mujoco_rejects_are_rejected() {
    let body_with_joint =
        |joint: &str| format!("<worldbody><body name='b'><joint name='j' {joint}/></body></worldbody>");
    let model_with_motor =
        |said: &str| format!("{}<actuator><motor {said}/></actuator>", body_with_joint(""));
    let model_with_fixed_tendon =
        |inside: &str| format!("{}<tendon><fixed {inside}</fixed></tendon>", body_with_joint(""));
    for (text, message) in [
        (
            format!("<compiler autolimits='false'/>{}", body_with_joint("range='0 1'")),
            "`range` without `limited` has no effect",
        ),
        (
            format!("<compiler autolimits='false'/>{}", model_with_motor("joint='j' ctrlrange='0 1'")),
            "`ctrlrange` without `ctrllimited` has no effect",
        ),
        (body_with_joint("range='0 x' limited='true'"), "`x` is not a number"),
        (body_with_joint("limited='true'"), "`limited=\"true\"` without `range`"),
        (model_with_motor(""), "an actuator without a target"),
        (
            model_with_motor("joint='j' site='s'"),
            "an actuator has one target, but here are `joint` and `site`",
        ),
        (
            model_with_fixed_tendon("><joint joint='j' coef='1'/><joint joint='j' coef='2'/>"),
            "joint `j` occurs twice in one tendon",
        ),
        (model_with_fixed_tendon(">"), "`<fixed>` without a joint"),
        (model_with_fixed_tendon("armature='-1'><joint joint='j' coef='1'/>"), "negative armature `-1`"),
        (
            model_with_fixed_tendon("stiffness='1' springlength='1 0'><joint joint='j' coef='1'/>"),
            "`springlength` from 1 to 0, which is below it",
        ),
        (
            "<worldbody><body><joint/><body name='m' mocap='true'/></body></worldbody>".to_string(),
            "mocap body `m` is not fixed to the world",
        ),
        (
            "<worldbody><body><freejoint align='true'/><geom size='1'/></body></worldbody>".to_string(),
            "a free body in principal axes is not supported",
        ),
        (
            "<compiler alignfree='true'/><worldbody><body><freejoint/><geom size='1'/></body></worldbody>"
                .to_string(),
            "a free body in principal axes is not supported",
        ),
    ] {
        let answer = import_as_text(&mjcf_options(), &format!("<mujoco>\n{text}\n</mujoco>"));
        assert!(answer.contains(message), "{text}\n{answer}");
        assert_eq!(answer.matches("r.xml:").count(), 1, "{answer}");
    }
    for text in [
        body_with_joint("range='0 0' limited='auto'"),
        format!("<compiler autolimits='false'/>{}", body_with_joint("range='0 1' limited='false'")),
        "<compiler alignfree='true'/><worldbody><body><freejoint align='false'/><geom size='1'/></body>\
         </worldbody>"
            .to_string(),
        "<worldbody><body><freejoint align='true'/><geom size='1'/><body/></body></worldbody>".to_string(),
    ] {
        assert!(
            import_as_text(&mjcf_options(), &format!("<mujoco>\n{text}\n</mujoco>")).contains("the root is"),
            "{text}"
        );
    }
}

/// Joints and masses of the MJCF world have no effect on the mechanism.
#[test]
fn joints_and_mass_of_the_world_have_no_effect() {
    let help = "= help: move it into a `<body>`";
    for (inside, found) in [
        ("<joint/>", "r.xml:2:12: `<joint>` of the world, which does not move"),
        ("<frame><freejoint/></frame>", "r.xml:2:19: `<freejoint>` of the world, which does not move"),
        ("<inertial pos='0 0 0' mass='1'/>", "r.xml:2:12: `<inertial>` of the world, which does not move"),
    ] {
        check_import_of_mjcf_elements(
            &format!("<worldbody>{inside}</worldbody>"),
            &format!("{found}\n{help}"),
        );
    }
}

/// Sites without a neighbour and pulleys that no site follows are errors, as in MuJoCo 4.0.0.
#[test]
fn tendon_paths_without_length_are_rejected() {
    let help = "= help: a tendon and each part behind a pulley has two sites";
    let (a, b, pulley) = ("<site site='a'/>", "<site site='b'/>", "<pulley divisor='2'/>");
    for (path, element, column) in [
        (String::new(), "<spatial>", 9),
        (a.to_string(), "<site>", 34),
        (format!("{a}{b}{pulley}"), "<pulley>", 66),
        (format!("{a}{b}{pulley}{a}"), "<site>", 87),
        (format!("{a}{b}{pulley}{pulley}{a}{b}"), "<pulley>", 66),
    ] {
        check_import_of_mjcf_elements(
            &format!(
                "<tendon><spatial stiffness='100'>{path}</spatial></tendon>\n\
                 <worldbody><site name='a'/><body><joint/>{BALL}<site name='b' pos='1 0 0'/></body></worldbody>"
            ),
            &format!("r.xml:2:{column}: `{element}` adds nothing to the length of the tendon\n{help}"),
        );
    }
}

/// Requested contacts that the file does not contain are reported.
#[test]
fn requested_contacts_that_the_file_lacks_are_reported() {
    let options = FileOptions { contacts: ContactOption::File, collisions: true, ..mjcf_options() };
    let import_with_contact_bits = |bits: &str| {
        let text = format!(
            "<mujoco><worldbody><geom type='plane' size='1 1 1' {bits}/>\
             <body name='b'><freejoint/>{BALL}</body></worldbody></mujoco>"
        );
        import_as_text(&options, &text)
    };
    assert!(import_with_contact_bits("").starts_with("the root is the ground\n"));
    let found = import_with_contact_bits("contype='2' conaffinity='2'");
    assert!(found.starts_with("no shapes of the file can touch each other\n"), "{found}");
}
