//! Tests of SDF files: results of valid files and errors of invalid ones.

use super::*;

fn sdf_options() -> FileOptions {
    FileOptions { format: FileFormat::Sdf, path: name_at_call_site("r.sdf"), ..default_file_options() }
}

/// Compares the result for the elements of a model. The elements begin on the second line.
fn check_import_of_sdf_model(inside: &str, expected: &str) {
    check_import_with_options(
        &sdf_options(),
        &format!("<sdf><model name='m'>\n{inside}\n</model></sdf>"),
        expected,
    );
}

#[test]
fn omitted_sdf_values_have_the_defaults_of_the_format() {
    check_import_of_sdf_model(
        "<link name='a'/><link name='b'><pose>0 0 2 0 0 0</pose></link><joint name='j' type='revolute'>\
         <parent>a</parent><child>b</child><axis/></joint>",
        "body a mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         body b mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         Weld root_joint: ground -> a
         Pin j: a.at([0, 0, 2]) -> b about [0, 0, 1]",
    );
}

#[test]
fn sdf_frames_place_joints_and_joints_close_loops() {
    check_import_of_sdf_model(
        "<link name='a'/><frame name='f' attached_to='a'><pose>1 0 0 0 0 0</pose></frame><link name='b'/>\
         <link name='c'/><joint name='i' type='fixed'><parent>f</parent><child>b</child></joint>\
         <joint name='j' type='ball'><parent>a</parent><child>c</child></joint>\
         <joint name='k' type='revolute'><parent>b</parent><child>c</child><axis><limit><lower>0</lower>\
         </limit></axis></joint><plugin name='p'/>",
        "body a mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         body f
         body b mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         body c mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         Weld root_joint: ground -> a
         Weld f_weld: a.at([1, 0, 0]) -> f
         Weld i: a -> b
         Ball j: a -> c
         Pin k: b -> c about [0, 0, 1]
         left out limits of k, which closes a loop
         left out plug-ins, and their effect on the motion: 1",
    );
}

#[test]
fn static_models_of_the_world_are_listed() {
    check_import_with_options(
        &sdf_options(),
        "<sdf><world name='w'><gravity>0 0 -1</gravity><model name='f'><static>1</static><link name='f'/>\
         </model><model name='m'><link name='a'/></model></world></sdf>",
        "body a mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         Weld root_joint: ground -> a
         left out static models of the world: 1",
    );
}

#[test]
fn sdf_poses_relative_to_missing_frames_are_rejected() {
    let model_with_pose = |pose: &str| {
        format!(
            "<link name='a'>{pose}</link><frame name='f' attached_to='g'/><frame name='g' attached_to='f'/>"
        )
    };
    for (pose, expected) in [
        ("<pose relative_to='b'/>", "r.sdf:2:35: unknown frame `b`\n= help: expected `a`, `f` or `g`"),
        ("<pose relative_to='f'/>", "r.sdf:2:46: the frame `a` is placed relative to itself"),
        ("<pose relative_to='a'/>", "r.sdf:2:35: the frame `a` is placed relative to itself"),
        (
            "<pose>1 2 3</pose>",
            "r.sdf:2:22: expected 6 numbers in `pose`, found `1 2 3`\n= help: write that many numbers, \
             separated by spaces",
        ),
        (
            "<pose>1 2 3 4 5 x</pose>",
            "r.sdf:2:32: `x` is not a number\n= help: write digits, as in `-0.5` or `1e-3`",
        ),
        (
            "<pose rotation_format='quat_xyzw'>0 0 0 0 0 0 0</pose>",
            "r.sdf:2:16: a quaternion of length 0 has no direction",
        ),
    ] {
        let answer = import_as_text(
            &sdf_options(),
            &format!("<sdf><model name='m'>\n{}\n</model></sdf>", model_with_pose(pose)),
        );
        let lines: Vec<&str> = answer.lines().filter(|line| !line.is_empty()).collect();
        let (found, expected) = (lines.join("\n"), expected.lines().collect::<Vec<_>>().join("\n"));
        assert!(found.starts_with(&expected), "{found}");
    }
}

#[test]
fn unsupported_sdf_elements_are_reported() {
    let model_with_joint = |inside: &str| {
        format!(
            "<link name='a'/><link name='b'/><joint name='j' {inside}<parent>a</parent><child>b</child>\
             </joint>"
        )
    };
    for (inside, expected) in [
        (
            "<link name='a'/><include/>".to_string(),
            "r.sdf:2:17: `<include>` without a `<uri>`\n= help: expected `<uri>model://…</uri>` or the path \
             of a file",
        ),
        (
            "<include merge='true'><uri>a</uri></include>".to_string(),
            "r.sdf:2:1: `merge` of an `<include>` is not supported\n= help: write the expanded file: `gz sdf \
             -p robot.sdf > whole.sdf`",
        ),
        (
            "<static>true</static><link name='a'/>".to_string(),
            "r.sdf:2:1: the model is static and cannot move\n= help: remove `<static>`",
        ),
        (
            "<link name='a'><gravity>0</gravity></link>".to_string(),
            "r.sdf:2:16: `<gravity>` of a link is not supported\n= help: remove it: gravity acts on all \
             links, and forces move them",
        ),
        (
            "<link name='a'><inertial auto='true'/></link>".to_string(),
            "r.sdf:2:16: mass properties by collision geometry are not supported\n= help: write `<mass>` and \
             `<inertia>` instead of `auto`",
        ),
        (
            "<link name='a'/><frame name='a'/>".to_string(),
            "r.sdf:2:30: second link, joint or frame with the name `a`\n= help: they are all frames: choose \
             different names",
        ),
        ("<lnk name='a'/>".to_string(), "r.sdf:2:1: unknown element `<lnk>`\n= help: did you mean `<link>`?"),
        (String::new(), "r.sdf:1:6: model without a link\n= help: expected `<link name=\"…\"/>`"),
        (
            model_with_joint("type='gearbox'>"),
            "r.sdf:2:55: joint type `gearbox` is not supported\n= help: couple two joints by `<mimic>`",
        ),
        (
            model_with_joint("type='revolut'>"),
            "r.sdf:2:55: unknown joint type `revolut`\n= help: did you mean `revolute`?",
        ),
        (
            model_with_joint("type='revolute'>"),
            "r.sdf:2:33: a `revolute` joint without an axis\n= help: expected `<axis><xyz>…</xyz></axis>`",
        ),
        (
            model_with_joint("type='screw'><axis/>"),
            "r.sdf:2:33: screw without `<screw_thread_pitch>`\n= help: it is the advance of the joint per \
             turn, m",
        ),
        (
            model_with_joint("type='revolute'><axis><xyz>0 0 0</xyz></axis>"),
            "r.sdf:2:76: axis of zero length has no direction",
        ),
        (
            model_with_joint(
                "type='universal'><axis><dynamics><damping>-1</damping></dynamics></axis><axis2/>",
            ),
            "r.sdf:2:91: negative damping `-1`\n= help: to ignore springs, damping and friction, write \
             `#[mechanism(…, passive = ignore)]`",
        ),
        (
            model_with_joint("type='revolute'><axis><limit><lower>1</lower><upper>0</upper></limit></axis>"),
            "r.sdf:2:85: `lower` is 1, above `upper`, which is 0\n= help: to ignore limits, write \
             `#[mechanism(…, limits = ignore)]`",
        ),
    ] {
        check_import_of_sdf_model(&inside, expected);
    }
}

#[test]
fn non_sdf_file_names_its_format_in_the_error() {
    for (text, expected) in [
        (
            "<robot/>",
            "r.sdf:1:1: expected `<sdf>`, found `<robot>`\n= help: this is a URDF file: write `urdf = \"…\"` \
             instead of `sdf = \"…\"`",
        ),
        (
            "<mujoco/>",
            "r.sdf:1:1: expected `<sdf>`, found `<mujoco>`\n= help: this is an MJCF file: write `mjcf = \
             \"…\"` instead of `sdf = \"…\"`",
        ),
        (
            "<sdf/>",
            "r.sdf:1:1: SDF file without a model\n= help: expected `<sdf version=\"…\"><model name=\"…\"> … \
             </model></sdf>`",
        ),
        (
            "<sdf><world><model name='a'/><model name='b'/></world></sdf>",
            "r.sdf:1:30: SDF file with several models\n= help: a mechanism is one model, or several that \
             joints of their world connect: put the others into files of their own",
        ),
    ] {
        check_import_with_options(&sdf_options(), text, expected);
    }
}

const FILE: &str = r#"<?xml version="1.0"?><sdf version="1.9"><world name="w"><gravity>0 0 -9</gravity><model name="m">
  <pose>1 2 3 0 0 1</pose><link name="a"><pose relative_to="f">0 0 1 0 0.1 0</pose></link>
  <frame name="f" attached_to="__model__"><pose degrees="true">0 0 0 10 20 30</pose></frame>
  <model name="n"><pose relative_to="a">0 1 0 0 0 0</pose><link name="b"><inertial><mass>2</mass></inertial></link></model>
  <joint name="j" type="universal"><pose>0 0 0.1 0 0 0</pose><parent>a</parent><child>n::b</child>
    <axis><xyz expressed_in="f">1 0 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis>
    <axis2><xyz>0 1 0</xyz><dynamics><damping>1</damping><spring_stiffness>2</spring_stiffness></dynamics></axis2></joint>
</model></world></sdf>"#;

#[test]
fn damaged_sdf_never_panics() {
    super::fuzz::check_damaged_imports(&sdf_options(), FILE, "root_joint");
}

#[test]
fn truncated_sdf_never_panics() {
    for end in 0..FILE.len() {
        assert!(!import_as_text(&sdf_options(), &FILE[..end]).contains("root_joint"));
    }
    assert!(import_as_text(&sdf_options(), FILE).contains("root_joint"));
}

/// The model of an included file replaces the `<include>`, with the name and pose of the `<include>`. The
/// result equals that of a file which contains the model.
#[test]
fn included_sdf_models_replace_the_include_element() {
    let wheel = "<sdf version='1.9'>\n<model name='wheel'><pose>9 9 9 0 0 0</pose><link name='rim'>\
                 <pose>0 0 1 0 0 0</pose></link></model></sdf>";
    let files = [
        (
            "parts/model.config",
            "<model><sdf version='1.4'>old.sdf</sdf><sdf version='1.9'>new.sdf</sdf></model>",
        ),
        ("parts/new.sdf", wheel),
        ("wheel.sdf", wheel),
        ("two.sdf", "<sdf><model name='two'><include><uri>parts</uri></include></model></sdf>"),
        ("bad.sdf", "<sdf>\n<model name='b'><lnk/></model></sdf>"),
        ("none.sdf", "<sdf/>"),
        ("a.sdf", "<sdf><model name='a'><include><uri>b.sdf</uri></include></model></sdf>"),
        ("b.sdf", "<sdf><model name='b'>\n<include><uri>model://a.sdf</uri></include></model></sdf>"),
    ];
    let folder = Folder::new("sdf-includes", &files);
    let wrap_in_model = |inside: &str| format!("<sdf><model name='m'>\n{inside}</model></sdf>");
    let joints = "<link name='hull'/><joint name='i' type='revolute'><parent>hull</parent>\
                  <child>left::rim</child><axis/></joint><joint name='j' type='revolute'>\
                  <parent>hull</parent><child>wheel::rim</child><axis/></joint>";
    let inner_model = |name: &str, pose: &str| {
        format!("<model name='{name}'>{pose}<link name='rim'><pose>0 0 1 0 0 0</pose></link></model>")
    };
    let (near, far) = ("<pose>1 0 0 0 0 0</pose>", "<pose>9 9 9 0 0 0</pose>");
    let included = format!(
        "{joints}<include><name> left \
         </name>{near}<uri>model://parts</uri></include><include><uri>wheel.sdf</uri></include>"
    );
    let whole = format!("{joints}{}{}", inner_model("left", near), inner_model("wheel", far));
    let answer = folder.import_as_text(&sdf_options(), &wrap_in_model(&included));
    let expected =
        folder.import_as_text(&sdf_options(), &wrap_in_model(&whole)).replace("0 files", "2 files");
    assert_eq!(answer, expected);
    assert!(answer.contains("Pin i: hull.at([1, 0, 1]) -> left::rim"), "{answer}");
    // Nested includes, and includes in a world, which may refer to missing files.
    let world = "<sdf><world name='w'><include><uri>model://ground_plane</uri></include><include>\
                 <uri>two.sdf</uri></include></world></sdf>";
    let answer = folder.import_as_text(&sdf_options(), world);
    assert!(answer.contains("body wheel::rim") && answer.contains("not next to the file: 1"), "{answer}");
    for (inside, expected) in [
        ("<include><uri>bad.sdf</uri></include>", "bad.sdf:2:17: unknown element `<lnk>`"),
        (
            "<include><uri>none.sdf</uri></include>",
            "none.sdf:1:1: expected an SDF file with one model, found no model",
        ),
        ("<include><uri>a.sdf</uri></include>", "b.sdf:2:15: `a.sdf` includes itself"),
        ("<include><uri>model://arm</uri></include>", "r.sdf:2:15: `model://arm` is not next to the file"),
        (
            "<include><uri>wheal.sdf</uri></include>",
            "r.sdf:2:15: there is no file `wheal.sdf`\n\n= help: did you mean `wheel.sdf`?",
        ),
        ("<include><uri>wheel.sdf</uri><nam/></include>", "r.sdf:2:30: unknown element `<nam>`"),
    ] {
        let answer = folder.import_as_text(&sdf_options(), &wrap_in_model(inside));
        assert!(answer.starts_with(expected), "{answer}");
    }
}

const ONE: &str = "mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]";

/// The child is rotated by a right angle about z: x of the model is −y of the child and of the joint.
#[test]
fn old_sdf_joint_axes_are_in_the_model_frame() {
    let model_with_axis = |version: &str, axis: &str| {
        format!(
            "<sdf version='{version}'><model name='m'><link name='a'/><link name='b'>\
             <pose>0 0 0 0 0 1.5707963267948966</pose></link><joint name='j' type='prismatic'>\
             <parent>a</parent><child>b</child><axis>{axis}</axis></joint></model></sdf>"
        )
    };
    let plain = "<xyz>1 0 0</xyz>";
    let of_model = format!("{plain}<use_parent_model_frame>1</use_parent_model_frame>");
    let of_joint = format!("{plain}<use_parent_model_frame>0</use_parent_model_frame>");
    for (version, axis, along) in [
        ("1.2", plain, "[0, -1, 0]"),
        ("1.3", plain, "[0, -1, 0]"),
        ("1.4", plain, "[0, -1, 0]"),
        ("1.4", &of_joint, "[1, 0, 0]"),
        ("1.4", "", "[0, 0, 1]"),
        ("1.5", plain, "[1, 0, 0]"),
        ("1.5", &of_model, "[0, -1, 0]"),
        ("1.6", &of_model, "[0, -1, 0]"),
        ("1.6", &of_joint, "[1, 0, 0]"),
        ("1.7", &of_joint, "[1, 0, 0]"),
        ("1.10", plain, "[1, 0, 0]"),
        ("1.12", "<xyz expressed_in='__model__'>1 0 0</xyz>", "[0, -1, 0]"),
    ] {
        let expected = format!(
            "body a {ONE}\nbody b {ONE}\nWeld root_joint: ground -> a\nSleeve j: \
             a.rotated(z(1.5707963267948966)) -> b along {along}"
        );
        check_import_with_options(&sdf_options(), &model_with_axis(version, axis), &expected);
    }
    check_import_with_options(
        &sdf_options(),
        &model_with_axis("1.7", &of_model),
        "r.sdf:1:204: `<use_parent_model_frame>` has another name since version 1.7 of SDF\n= help: write \
         `<xyz expressed_in=\"__model__\">`",
    );
}

/// Included files are interpreted in their own version.
#[test]
fn included_sdf_files_keep_their_own_version() {
    let arm_of_version = |version: &str| {
        format!(
            "<sdf version='{version}'><model name='arm'><link name='a'/><link name='b'>\
             <pose>0 0 0 0 0 1.5707963267948966</pose></link><joint name='j' type='prismatic'>\
             <parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz></axis></joint></model></sdf>"
        )
    };
    let folder = Folder::new(
        "sdf-versions",
        &[("old.sdf", &arm_of_version("1.4")), ("new.sdf", &arm_of_version("1.9"))],
    );
    for (outer, file, along) in
        [("1.9", "old", "[0, -1, 0]"), ("1.4", "old", "[0, -1, 0]"), ("1.4", "new", "[1, 0, 0]")]
    {
        let text = format!(
            "<sdf version='{outer}'><model name='m'><include><uri>{file}.sdf</uri></include></model></sdf>"
        );
        let answer = folder.import_as_text(&sdf_options(), &text);
        assert!(answer.contains(&format!("arm::b along {along}")), "{answer}");
    }
}

/// Poses of versions 1.5 and 1.6 name their reference frame in the attribute `frame`, in inertial frames too,
/// and links may declare frames.
#[test]
fn old_sdf_poses_name_their_frame_in_an_attribute() {
    let model_with_poses = |version: &str, pose: &str, inertial: &str| {
        format!(
            "<sdf version='{version}'><model name='m'><link name='a'><pose>0 0 1 0 0 0</pose></link>\
             <link name='b'><frame name='f'><pose>0 3 0 0 0 0</pose>\
             </frame>{pose}<inertial>{inertial}<mass>2</mass></inertial></link><joint name='j' type='fixed'>\
             <parent>a</parent><child>b</child></joint></model></sdf>"
        )
    };
    let expected_model = |at: &str, com: &str| {
        format!(
            "body a {ONE}\nbody b mass=2 com={com} inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n\
             Weld root_joint: ground.at([0, 0, 1]) -> a\nWeld j: a.at({at}) -> b"
        )
    };
    let placed = "<pose frame='a'>0 0 1 0 0 0</pose>";
    for version in ["1.5", "1.6"] {
        let model_with_inertial_pose = |inertial: &str| model_with_poses(version, placed, inertial);
        let expected_model_with_com = |com: &str| expected_model("[0, 0, 1]", com);
        check_import_with_options(
            &sdf_options(),
            &model_with_inertial_pose("<pose>1 0 0 0 0 0</pose>"),
            &expected_model_with_com("[1, 0, 0]"),
        );
        check_import_with_options(
            &sdf_options(),
            &model_with_inertial_pose("<pose frame='a'>1 0 0 0 0 0</pose>"),
            &expected_model_with_com("[1, 0, -1]"),
        );
        check_import_with_options(
            &sdf_options(),
            &model_with_inertial_pose("<pose frame='f'>1 0 0 0 0 0</pose>"),
            &expected_model_with_com("[1, 3, 0]"),
        );
        check_import_with_options(
            &sdf_options(),
            &model_with_inertial_pose("<pose frame=''>1 0 0 0 0 0</pose>"),
            &expected_model_with_com("[1, 0, 0]"),
        );
    }
    let answer = import_as_text(&sdf_options(), &model_with_poses("1.7", placed, ""));
    assert!(
        answer.starts_with("r.sdf:1:151: `frame` of a pose has another name since version 1.7 of SDF"),
        "{answer}"
    );
    let answer = import_as_text(
        &sdf_options(),
        &model_with_poses("1.7", "", "<pose relative_to='a'>1 0 0 0 0 0</pose>"),
    );
    assert!(answer.contains("the pose of an `<inertial>` is relative to its link"), "{answer}");
}

/// Joints and frames of the world: names in them begin with the name of a model.
#[test]
fn world_joints_fix_sdf_models() {
    let world_with_joint = |inside: &str| {
        format!(
            "<sdf version='1.10'><world name='w'><gravity>0 0 -1</gravity>{inside}<model name='m'>\
             <pose>0 0 1 0 0 0</pose><link name='a'><pose>1 0 0 0 0 0</pose></link></model></world></sdf>"
        )
    };
    let prismatic_joint = |parent: &str, more: &str| {
        format!(
            "<joint name='a' type='prismatic'>{more}<parent>{parent}</parent><child>m::a</child><axis>\
             <xyz>1 0 0</xyz></axis></joint>"
        )
    };
    for (inside, expected) in [
        (
            prismatic_joint("world", ""),
            format!(
                "body world\nbody a {ONE}\nWeld root_joint: ground -> world\nSleeve world::a: world.at([1, \
                 0, 1]) -> a along [1, 0, 0]"
            ),
        ),
        // A frame of the world is fixed, and a static model belongs to the world.
        (
            format!(
                "<frame name='f'><pose>0 2 0 0 0 0</pose></frame>{}",
                prismatic_joint("f", "<pose relative_to='f'/>")
            ),
            format!(
                "body world\nbody a {ONE}\nbody f\nWeld root_joint: ground -> world\nWeld f_weld: world.at([0, 2, 0]) -> f\n\
                 Sleeve world::a: world.at([0, 2, 0]) -> a.at([-1, 2, -1]) along [1, 0, 0]"
            ),
        ),
        (
            format!(
                "<model name='wall'><static>true</static><pose>0 5 0 0 0 0</pose><link name='k'/></model>{}",
                prismatic_joint("wall::k", "<pose relative_to='wall'/>")
            ),
            format!(
                "body world\nbody a {ONE}\nWeld root_joint: ground -> world\n\
                 Sleeve world::a: world.at([0, 5, 0]) -> a.at([-1, 5, -1]) along [1, 0, 0]\nleft out static models of the world: 1"
            ),
        ),
        // A frame that no joint refers to does not become a link.
        (
            "<frame name='a'/>".to_string(),
            format!("body a {ONE}\nWeld root_joint: ground.at([1, 0, 1]) -> a"),
        ),
        // Joints of the world connect several models to one mechanism.
        (
            format!(
                "<model name='n'><link name='a'/></model>{}",
                prismatic_joint("n::a", "").replace("name='a'", "name='i'")
            ),
            format!(
                "body n::a {ONE}\nbody m::a {ONE}\nWeld root_joint: ground -> n::a\nSleeve i: n::a.at([1, 0, \
                 1]) -> m::a along [1, 0, 0]"
            ),
        ),
    ] {
        let trimmed_lines =
            |text: &str| -> Vec<String> { text.lines().map(|line| line.trim().to_string()).collect() };
        let (mut found, mut expected) = (
            trimmed_lines(&import_as_text(&sdf_options(), &world_with_joint(&inside))),
            trimmed_lines(&expected),
        );
        // The order of bodies depends on the names of the joints.
        found.sort();
        expected.sort();
        assert_eq!(found, expected);
    }
    let answer = import_as_text(&sdf_options(), &world_with_joint(&prismatic_joint("m::b", "")));
    assert!(answer.contains("unknown frame `b`"), "{answer}");
    let answer = import_as_text(&sdf_options(), &world_with_joint("<jont name='x'/>"));
    assert!(
        answer.contains("unknown element `<jont>`") && answer.contains("did you mean `<joint>`?"),
        "{answer}"
    );
}

/// A positive `<thread_pitch>`, in rad/m, describes a left-handed thread.
#[test]
fn old_sdf_thread_pitch_is_left_handed() {
    let model_with_thread_pitch = |pitch: &str| {
        format!(
            "<sdf version='1.5'><model name='m'><link name='a'/><link name='b'/><joint name='j' type='screw'>\
             <parent>a</parent><child>b</child><axis/><thread_pitch>{pitch}</thread_pitch></joint></model>\
             </sdf>"
        )
    };
    let imported = import_text(&model_with_thread_pitch("-4"), &sdf_options(), &mut Diagnostics::new())
        .expect("a robot");
    let lead = imported.joints.iter().find_map(|joint| joint.lead.as_ref()).and_then(Expr::literal_number);
    assert_eq!(lead, Some(std::f64::consts::FRAC_PI_2));
    assert!(
        import_as_text(&sdf_options(), &model_with_thread_pitch("0"))
            .contains("advances infinitely far in a turn")
    );
}

#[test]
fn sdf_version_must_be_a_number() {
    let model = "<model name='m'><link name='a'/></model>";
    for (version, expected) in [
        (
            "1.x",
            "r.sdf:1:15: `1.x` is not a version of SDF\n= help: expected a number, as in `version=\"1.9\"`",
        ),
        (
            "1.0",
            "r.sdf:1:1: version 1.0 of SDF is not supported\n= help: convert the file: `gz sdf -p robot.sdf \
             > converted.sdf`",
        ),
    ] {
        check_import_with_options(
            &sdf_options(),
            &format!("<sdf version='{version}'>{model}</sdf>"),
            expected,
        );
    }
    let answer = import_as_text(&sdf_options(), &format!("<gazebo version='1.2'>{model}</gazebo>"));
    assert!(answer.contains("files of versions 1.0 and 1.2 begin so"), "{answer}");
    // Values that are written as attributes, as in version 1.0 or in URDF, are not replaced by defaults.
    for (inside, expected) in [
        ("<link name='a'><pose xyz='0 0 1'/></link>", "unknown attribute `xyz` of `<pose>`"),
        ("<link name='a'><inertial mass='2'/></link>", "unknown attribute `mass` of `<inertial>`"),
        (
            "<link name='a'><inertial><inertia ixx='2'/></inertial></link>",
            "unknown attribute `ixx` of `<inertia>`",
        ),
        (
            "<link name='a'/><link name='b'/><joint name='j' type='revolute'><parent>a</parent>\
             <child>b</child><axis xyz='1 0 0'/></joint>",
            "unknown attribute `xyz` of `<axis>`",
        ),
    ] {
        let answer = import_as_text(
            &sdf_options(),
            &format!("<sdf version='1.9'><model name='m'>{inside}</model></sdf>"),
        );
        assert!(answer.contains(expected), "{answer}");
    }
}

/// Gravity is an element of `<physics>` up to version 1.5.
#[test]
fn old_sdf_gravity_is_read_from_physics() {
    let world_of_version = |version: &str| {
        format!(
            "<sdf version='{version}'><world name='w'><physics type='ode'><gravity>0 0 -3</gravity></physics>\
             <model name='m'><link name='a'/></model></world></sdf>"
        )
    };
    let imported =
        import_text(&world_of_version("1.4"), &sdf_options(), &mut Diagnostics::new()).expect("a robot");
    assert_eq!(imported.gravity.map(|gravity| render_expr(&gravity)), Some("[0, 0, -3]".to_string()));
    assert!(
        import_as_text(&sdf_options(), &world_of_version("1.6"))
            .contains("`<gravity>` is an element of the world since version 1.6 of SDF")
    );
}

/// Numbers and words next to comments are read, or an error where a comment divides them.
#[test]
fn xml_comments_do_not_hide_values() {
    check_import_of_sdf_model(
        "<link name='a'><pose><!-- m, rad -->0 0 3 0 0 0</pose><inertial><mass><!-- kg -->2</mass></inertial>\
         </link><link name='b'/><joint name='j' type='ball'><parent><!-- link --> a</parent><child>b</child>\
         </joint>",
        "body a mass=2 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         body b mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         Weld root_joint: ground.at([0, 0, 3]) -> a
         Ball j: a.at([0, 0, -3]) -> b",
    );
    let help = "= help: expected numbers, and comments before or after them";
    for (inside, found) in [
        ("<pose>0 0 3 0 0 0<!-- --> 1</pose>", "r.sdf:2:42: unexpected text `1` in `<pose>`"),
        ("<pose>0 0 3 0 0 0<offset/></pose>", "r.sdf:2:33: unexpected `<offset>` in `<pose>`"),
        ("<inertial><mass>1<!-- -->0</mass></inertial>", "r.sdf:2:41: unexpected text `0` in `<mass>`"),
    ] {
        check_import_of_sdf_model(&format!("<link name='a'>{inside}</link>"), &format!("{found}\n{help}"));
    }
}

/// An element or attribute in the wrong parent element is an error, and does not become the default.
#[test]
fn misplaced_sdf_elements_are_rejected() {
    let model = "= help: a model holds `<link>`, `<joint>`, `<frame>` and `<model>`";
    let link = "= help: mass properties belong to `<inertial>`, and connections of links to `<joint>`";
    let inertial = "= help: expected `<pose>`, `<mass>` and `<inertia>` with `<ixx>` and so on";
    for (inside, found, help) in [
        ("<mass>5</mass>", "r.sdf:2:1: unexpected `<mass>` in `<model>`", model),
        ("<link name='a'><mass>5</mass></link>", "r.sdf:2:16: unexpected `<mass>` in `<link>`", link),
        ("<link name='a' mass='5'/>", "r.sdf:2:16: unknown attribute `mass` of `<link>`", link),
        ("<link name='a'>5 kg</link>", "r.sdf:2:16: unexpected text `5 kg` in `<link>`", link),
        ("<link name='a'><link name='b'/></link>", "r.sdf:2:16: unexpected `<link>` in `<link>`", link),
        (
            "<link name='a'><inertial><ixx>5</ixx></inertial></link>",
            "r.sdf:2:26: unexpected `<ixx>` in `<inertial>`",
            inertial,
        ),
        (
            "<link name='a'><pose>0 0 1 0 0 0</pose><pose>0 0 2 0 0 0</pose></link>",
            "r.sdf:2:40: second `<pose>` of one element",
            "= help: the first is at r.sdf:2:16",
        ),
    ] {
        check_import_of_sdf_model(inside, &format!("{found}\n{help}"));
    }
    let model_with_joint = |inside: &str| {
        format!(
            "<link name='a'/><link name='b'/>\n<joint name='j' type='revolute'><parent>a</parent>\
             <child>b</child>{inside}</joint>"
        )
    };
    for (inside, found) in [
        ("<xyz>0 1 0</xyz><axis/>", "r.sdf:3:67: unexpected `<xyz>` in `<joint>`"),
        ("<axis><damping>2</damping></axis>", "r.sdf:3:73: unexpected `<damping>` in `<axis>`"),
        ("<axis><lower>2</lower></axis>", "r.sdf:3:73: unexpected `<lower>` in `<axis>`"),
        (
            "<axis><limit><damping>2</damping></limit></axis>",
            "r.sdf:3:80: unexpected `<damping>` in `<limit>`",
        ),
    ] {
        let actual = import_as_text(
            &sdf_options(),
            &format!("<sdf><model name='m'>\n{}\n</model></sdf>", model_with_joint(inside)),
        );
        assert!(actual.starts_with(&format!("{found}\n")) && !actual.contains("\nr.sdf"), "{actual}");
    }
}

/// A joint that closes a loop is not lost because an end has no name.
#[test]
fn loop_joints_with_unnamed_links_are_rejected() {
    check_import_of_sdf_model(
        "<link name='a'/><link name='b'/><joint name='i' type='ball'><parent>a</parent><child>b</child>\
         </joint><joint name='j' type='ball'><parent/><child>b</child></joint>",
        "r.sdf:2:131: `<parent>` without a name
         = help: expected the name of a link or a frame",
    );
}

#[test]
fn unsupported_sdf_joint_elements_are_listed() {
    check_import_of_sdf_model(
        "<link name='a'/><link name='b'/><link name='c'/><joint name='i' type='screw'><parent>a</parent>\
         <child>b</child><screw_thread_pitch>1</screw_thread_pitch><axis><limit><lower>-1</lower>\
         <upper>2</upper></limit></axis></joint><joint name='j' type='ball'><parent>b</parent>\
         <child>c</child><axis/><axis2/></joint><link name='d'/><joint name='k' type='prismatic'>\
         <parent>c</parent><child>d</child><axis/></joint><link name='e'/><joint name='l' type='prismatic'>\
         <parent>d</parent><child>e</child><axis><mimic joint='k'><multiplier>2</multiplier></mimic></axis>\
         </joint>",
        "body a mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         body b mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         body c mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         body d mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         body e mass=1 inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 1]]
         Weld root_joint: ground -> a
         Screw i: a -> b about [0, 0, 1]
         Ball j: b -> c
         Sleeve k: c -> d along [0, 0, 1]
         Sleeve l: d -> e along [0, 0, 1] = 2 k + 0
         left out limits of i, which is `screw`
         left out the axis of j, which is `ball`
         left out the second axis of j, which is `ball`",
    );
}

/// Gravity is that of the world which has the model.
#[test]
fn gravity_of_the_world_of_the_model_is_used() {
    let text = "<sdf><world name='a'><gravity>0 0 -1</gravity></world><world name='b'>\
                <gravity>0 0 -5</gravity><model name='m'><link name='a'/></model></world></sdf>";
    let imported = import_text(text, &sdf_options(), &mut Diagnostics::new()).expect("a robot");
    assert_eq!(imported.gravity.map(|e| render_expr(&e)).as_deref(), Some("[0, 0, -5]"));
}

/// Checks that plug-ins of an `<include>` are listed like those of its model.
#[test]
fn plugins_of_included_models_are_listed() {
    let arm = "<sdf><model name='arm'><link name='a'/></model></sdf>";
    let folder = Folder::new("plugins", &[("arm.sdf", arm)]);
    let text = "<sdf><model name='m'><include><uri>arm.sdf</uri><plugin name='p'/></include></model></sdf>";
    let answer = folder.import_as_text(&sdf_options(), text);
    assert!(answer.contains("left out plug-ins, and their effect on the motion: 1\n"), "{answer}");
    let twice = text.replace("<plugin name='p'/>", "<uri>leg.sdf</uri>");
    let answer = folder.import_as_text(&sdf_options(), &twice);
    assert!(answer.starts_with("r.sdf:1:49: second `<uri>` of one element\n"), "{answer}");
}
