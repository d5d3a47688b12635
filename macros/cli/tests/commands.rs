//! Tests of the output and the exit status of the command.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Creates a folder for the files of one test, and returns it.
fn test_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn run_linkwork(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_linkwork")).current_dir(folder).args(arguments).output().unwrap();
    let decode_utf8 = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), decode_utf8(stdout), decode_utf8(stderr))
}

const PENDULUM: &str = "
#[mechanism(gravity = -9.81 * y)]
pub struct Pendulum {
    pub length: f64,
    #[particle(mass = 1, at = length * (sin(theta) * x - cos(theta) * y))]
    bob: Particle,
    theta: Coordinate,
}
";

#[test]
fn check_accepts_valid_mechanisms() {
    let here = test_folder("good");
    std::fs::write(here.join("pendulum.rs"), PENDULUM).unwrap();
    assert_eq!(
        run_linkwork(&here, &["check", "pendulum.rs"]),
        (0, "pendulum.rs: `Pendulum` has no errors\n".to_string(), String::new())
    );
    let (status, shown, _) = run_linkwork(&here, &["show", "pendulum.rs"]);
    assert!(status == 0 && shown.contains("theta") && shown.contains("sin(theta)"), "{shown}");
    let (status, json, _) = run_linkwork(&here, &["show", "pendulum.rs", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(status == 0 && json.to_string().contains("\"theta\""), "{json}");
}

#[test]
fn check_lists_errors_with_source_positions() {
    let here = test_folder("mistakes");
    let text = PENDULUM.replace("cos(theta)", "cos(thta)").replace("mass = 1", "mass = -1");
    std::fs::write(here.join("bad.rs"), &text).unwrap();
    let (status, _, stderr) = run_linkwork(&here, &["check", "bad.rs"]);
    assert_eq!(status, 1);
    let line = 1 + text.lines().position(|line| line.contains("thta")).unwrap();
    let column = 1 + text.lines().find_map(|line| line.find("thta")).unwrap();
    assert!(stderr.contains(&format!("bad.rs:{line}:{column}: error:")), "{stderr}");
    assert!(stderr.contains("did you mean `theta`?") && stderr.contains("mass"), "{stderr}");
    let (status, json, _) = run_linkwork(&here, &["check", "bad.rs", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let places: Vec<_> = json["messages"].as_array().unwrap().iter().map(|m| m["line"].as_u64()).collect();
    assert_eq!((status, places), (1, vec![Some(line as u64); 2]));
    // No files are written for a mechanism with errors.
    let (status, ..) = run_linkwork(&here, &["export", "c", "bad.rs"]);
    assert!(status == 1 && !here.join("pendulum.c").exists());
}

/// Checks that a derive above the attribute is an error, as with rustc, because it would apply to the element
/// fields.
#[test]
fn a_derive_above_the_attribute_is_an_error() {
    let here = test_folder("derives");
    let derive = "#[derive(Clone, Debug)]\n";
    let above = format!("{derive}{}", PENDULUM.trim_start());
    std::fs::write(here.join("above.rs"), &above).unwrap();
    let (status, _, stderr) = run_linkwork(&here, &["check", "above.rs"]);
    assert_eq!(status, 1);
    assert!(stderr.contains("above.rs:2:1: error: `#[derive(…)]` is above `#[mechanism]`"), "{stderr}");
    assert!(stderr.contains("= help: write it below"), "{stderr}");
    std::fs::write(here.join("below.rs"), PENDULUM.replace("pub struct", &format!("{derive}pub struct")))
        .unwrap();
    assert_eq!(run_linkwork(&here, &["check", "below.rs"]).0, 0);
}

#[test]
fn unsupported_requests_are_reported() {
    let here = test_folder("failures");
    std::fs::write(here.join("mujoco.urdf"), "<mujoco><worldbody/></mujoco>").unwrap();
    std::fs::write(here.join("nothing.rs"), "pub struct Plain;").unwrap();
    std::fs::write(here.join("broken.rs"), "pub struct 3;").unwrap();
    std::fs::write(here.join("open.rs"), "#[mechanism]\n// A word.\nstruct Fan {").unwrap();
    std::fs::write(here.join("comma.rs"), "struct Fan {\n    a: f64\n    b: f64,\n}").unwrap();
    std::fs::write(here.join("bracket.rs"), "struct Fan {\n    #[body(mass = 1]\n    b: Body,\n}").unwrap();
    std::fs::write(here.join("robot.usd"), "#usda 1.0\n").unwrap();
    std::fs::write(here.join("image.png"), [0x89, b'P', b'N', b'G', 0xff]).unwrap();
    std::fs::write(here.join("pendulum.rs"), PENDULUM).unwrap();
    std::fs::write(here.join("leg.urdf"), "<robot name='leg'><link name='a'/></robot>").unwrap();
    std::fs::write(here.join("two.rs"), format!("{PENDULUM}{}", PENDULUM.replace("Pendulum", "Other")))
        .unwrap();
    let closed = "#[mechanism] pub struct Loop { #[body(mass = 1, com = x, inertia = rod(1, 1, x))] bob: Body, \
        #[joint(ground -> bob, about = z)] plane: Planar, #[constraint(plane.x = plane.y)] line: Holonomic }";
    std::fs::write(here.join("loop.rs"), closed).unwrap();
    for (arguments, status, stderr) in [
        (&["check", "robot.urdf"][..], 2, "there is no such file"),
        (&["check", "mujoco.urdf"], 1, "mujoco"),
        (&["check", "nothing.rs"], 2, "no struct with `#[mechanism]`"),
        (&["check", "broken.rs"], 1, "broken.rs:1:12: error: expected identifier"),
        (&["show", "open.rs"], 1, "open.rs:3:12: error: this is never closed"),
        (&["check", "pendulum.rs", "--struct", "Pendulm"], 2, "no mechanism `Pendulm`, but Pendulum"),
        (&["export", "c", "two.rs"], 2, "several mechanisms"),
        (&["check", "comma.rs"], 1, "comma.rs:2:11: error: expected `,`, found `b`"),
        (
            &["check", "bracket.rs"],
            1,
            "bracket.rs:2:20: error: mismatched closing delimiter: expected `)`, found `]`",
        ),
        (&["check", "bracket.rs"], 1, "note: `(` of line 2, column 11 is not closed"),
        (
            &["check", "robot.usd"],
            2,
            "robot.usd: unknown type of file: expected a Rust file (`.rs`), or a robot file (`.urdf`",
        ),
        (&["show", "image.png"], 2, "image.png: unknown type of file"),
        (&["chekc", "pendulum.rs"], 2, "check"),
        (&["check"], 2, "FILE"),
        (&["check", "pendulum.rs", "--with", "gravity = ("], 2, "--with"),
        (&["export", "c", "pendulum.rs", "--out", "pendulum.rs"], 2, "pendulum.rs"),
        // Options of which one would be lost.
        (
            &["simulate", "pendulum.rs", "--set", "length=1", "--set", "length=2"],
            2,
            "`length` is given twice",
        ),
        (&["export", "c", "pendulum.rs", "--casadi", "--set", "length=1", "--set", "length=2"], 2, "twice"),
        (
            &["simulate", "pendulum.rs", "--set", "q.theta=1", "--guess", "q.theta=2"],
            2,
            "`q.theta` is given by `--set` and by `--guess`",
        ),
        (&["view", "pendulum.rs", "--motion", "log.csv", "--every", "0.1"], 2, "cannot be used with"),
        (&["export", "cuda", "loop.rs"], 1, "kernels support only trees, and this mechanism has constraints"),
        (
            &["export", "wgsl", "loop.rs"],
            1,
            "`linkwork export library` writes all functions with constraints",
        ),
        (&["export", "wgsl", "pendulum.rs", "--scalar", "double"], 2, "WGSL has no double precision"),
        (&["export", "c", "pendulum.rs", "--prefix", "double"], 2, "use `--prefix double_`"),
        (&["export", "cuda", "pendulum.rs", "--prefix", "2x"], 2, "use `--prefix x2x`"),
        (&["export", "wgsl", "pendulum.rs", "--prefix", "class"], 2, "use `--prefix class_`"),
        (
            &["export", "cuda", "pendulum.rs", "--with", "arithmetic = reproducible"],
            1,
            "kernels have no reproducible arithmetic",
        ),
        (
            &["simulate", "pendulum.rs", "--with", "arithmetic = reproducible"],
            1,
            "loaded mechanisms have no reproducible arithmetic",
        ),
        (
            &["export", "c", "pendulum.rs", "--with", "arithmetic = reproducible", "--scalar", "float"],
            1,
            "single precision has no reproducible arithmetic in C",
        ),
        (&["convert", "leg.urdf", "--with", "derivatives"], 2, "write options that request functions"),
    ] {
        let (found, _, error) = run_linkwork(&here, arguments);
        assert!(found == status && error.contains(stderr), "{arguments:?}: {found}, {error}");
    }
}

/// Checks that advice on a robot file, which has no attribute, names an option of the command, and that the
/// file is accepted with this option.
#[test]
fn help_messages_name_options_of_the_command() {
    let here = test_folder("advice");
    let robot = "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='1'/>\
                 <inertia ixx='1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial></link>\
                 <joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>";
    std::fs::write(here.join("r.urdf"), robot).unwrap();
    let (status, _, stderr) = run_linkwork(&here, &["check", "r.urdf"]);
    assert!(
        status == 1 && stderr.contains("`--with \"inertia = trust\"`") && !stderr.contains("#[mech"),
        "{stderr}"
    );
    assert_eq!(run_linkwork(&here, &["check", "r.urdf", "--with", "inertia = trust"]).0, 0);
    std::fs::write(here.join("s.urdf"), "<sdf version='1.9'><model name='m'/></sdf>").unwrap();
    let (status, _, stderr) = run_linkwork(&here, &["check", "s.urdf"]);
    assert!(status == 1 && stderr.contains("give it a name that ends in `.sdf`"), "{stderr}");
}

/// Checks that missing meshes are listed, and that a missing folder is an error.
#[test]
fn missing_mesh_files_are_listed() {
    let here = test_folder("meshes");
    let robot = "<robot name='r'><link name='a'><visual><geometry><mesh filename='package://r/a.stl'/></geometry></visual></link>\
                 <link name='b'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>\
                 <joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>";
    std::fs::write(here.join("r.urdf"), robot).unwrap();
    for more in [&[][..], &["--meshes", "."]] {
        let (status, _, stderr) =
            run_linkwork(&here, &[&["view", "r.urdf", "--duration", "0.1"][..], more].concat());
        assert!(
            status == 0
                && stderr.contains("these meshes are not found")
                && stderr.contains("package://r/a.stl"),
            "{stderr}"
        );
    }
    let (status, _, stderr) = run_linkwork(&here, &["view", "r.urdf", "--meshes", "nowhere"]);
    assert!(status == 2 && stderr.contains("`--meshes`: nowhere: "), "{stderr}");
}

/// Checks the shaders and the functions that are listed as missing for a mechanism with a table.
#[test]
fn shaders_are_written_for_straight_line_functions() {
    let here = test_folder("shaders");
    let sled = "#[mechanism] pub struct Sled { pub m: f64, pub drag: Table<1>, #[particle(mass = m)] block: Particle, \
        #[joint(ground -> block, along = x)] rail: Sleeve, \
        #[acts(on = rail, value = -drag(rate(rail)))] air: Force }";
    std::fs::write(here.join("sled.rs"), sled).unwrap();
    let (status, stdout, stderr) = run_linkwork(&here, &["export", "wgsl", "sled.rs"]);
    assert_eq!((status, stdout.as_str()), (0, "./sled.wgsl\n./sled_wgpu.py\n"), "{stderr}");
    for line in ["inverse_dynamics: it has tables", "rk4_step: it calls other functions"] {
        assert!(stderr.contains(&format!("linkwork: not in WGSL: {line}\n")), "{line} in {stderr}");
    }
    let text = std::fs::read_to_string(here.join("sled.wgsl")).unwrap();
    assert!(text.contains("fn sled_mass_matrix(") && !text.contains("fn sled_inverse_dynamics("), "{text}");
    let mass = "results[0 * n + i] = p_m;";
    assert!(text.contains(mass) && text.contains("let p_m = parameters[0 * sizes.parameter_entry"), "{text}");
}

/// Checks that syntax errors are reported in the format of other errors.
#[test]
fn syntax_errors_have_the_format_of_other_errors() {
    let here = test_folder("syntax");
    std::fs::write(here.join("broken.rs"), "\npub struct {").unwrap();
    std::fs::write(here.join("broken.urdf"), "<robot name='r'>\n<link></robot>").unwrap();
    std::fs::write(here.join("bad.rs"), PENDULUM.replace("cos(theta)", "cos(thta)")).unwrap();
    for (file, line, column) in [("broken.rs", 2, 12), ("broken.urdf", 2, 7), ("bad.rs", 5, 62)] {
        let (status, _, stderr) = run_linkwork(&here, &["check", file]);
        let begin = format!("{file}:{line}:{column}: error: ");
        assert!(status == 1 && stderr.starts_with(&begin), "{stderr}");
        let (status, json, stderr) = run_linkwork(&here, &["check", file, "--json"]);
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        let found = &json["messages"][0];
        assert_eq!((status, stderr.as_str()), (1, ""), "{json}");
        assert_eq!(
            (&found["file"], &found["line"], &found["column"]),
            (&file.into(), &line.into(), &column.into())
        );
    }
}

/// Checks that the page has the struct's documentation, and that descriptions of libraries contain no rustdoc
/// links.
#[test]
fn documentation_page_suits_readers_without_rust() {
    let here = test_folder("documented");
    let about = "/// A *simple* pendulum, as [`Pendulum`](crate::Pendulum), with [`theta`].\n///\n/// - \
                 `theta`, rad\n/// - `length`, m\n";
    std::fs::write(here.join("pendulum.rs"), format!("{about}{}", PENDULUM.trim_start())).unwrap();
    let (status, _, stderr) =
        run_linkwork(&here, &["view", "pendulum.rs", "--set", "length=1", "--duration", "0.1"]);
    assert_eq!((status, stderr.as_str()), (0, ""));
    let page = std::fs::read_to_string(here.join("Pendulum.html")).unwrap();
    let first = "<p>A <em>simple</em> pendulum, as <code>Pendulum</code>, with <code>theta</code>.</p>";
    let more = "<ul><li><code>theta</code>, rad</li><li><code>length</code>, m</li></ul></details>";
    assert!(page.contains(first) && page.contains(more), "{}", &page[..3000]);

    let bowl = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/src/four_bar.rs");
    let sources = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let (status, _, stderr) = run_linkwork(
        &here,
        &["export", "library", bowl, "--struct", "FourBar", "--out", "bar", "--linkwork", sources],
    );
    assert_eq!((status, stderr.as_str()), (0, ""));
    let description: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(here.join("bar/description.json")).unwrap()).unwrap();
    let functions = description["functions"].as_array().unwrap();
    for f in functions {
        let text = f["documentation"].as_str().unwrap();
        assert!(!["](", "[`", "::", "# "].iter().any(|part| text.contains(part)), "{text}");
    }
    let assemble = functions.iter().find(|f| f["name"] == "assemble").unwrap();
    assert_eq!(assemble["errors"], "if no such configuration is found, for an invalid index.");
    assert!(assemble["documentation"].as_str().unwrap().ends_with("Angles are within half a turn of `q`."));
    let header = std::fs::read_to_string(here.join("bar/include/four_bar.h")).unwrap();
    assert!(
        header.contains("* Returns 1 if no such configuration is found, for an invalid index."),
        "{header}"
    );
}

/// Checks that with `--expanded` the crate contains the generated code instead of the attribute, and is
/// otherwise identical. The description contains the limits of the joints.
#[test]
fn exported_crates_contain_the_attribute_or_its_code() {
    let here = test_folder("expanded");
    let slider = "#[mechanism] pub struct Slider { #[particle(mass = 2)] block: Particle, \
        #[joint(ground -> block, along = x)] rail: Sleeve, \
        #[limit(on = rail, from = -1, to = 2.5, max_speed = 3)] ends: Limit }";
    std::fs::write(here.join("slider.rs"), slider).unwrap();
    let export_library_files = |more: &[&str]| {
        let (status, _, stderr) =
            run_linkwork(&here, &[&["export", "library", "slider.rs", "--out", "slider"], more].concat());
        assert_eq!((status, stderr.as_str()), (0, ""));
        ["src/lib.rs", "description.json", "include/slider.h", "Cargo.toml"]
            .map(|file| std::fs::read_to_string(here.join("slider").join(file)).unwrap())
    };
    let [declared, description, header, manifest] = export_library_files(&[]);
    let [expanded, same_description, same_header, same_manifest] = export_library_files(&["--expanded"]);
    assert_eq!([&description, &header, &manifest], [&same_description, &same_header, &same_manifest]);
    assert!(declared.contains("#[mechanism") && !declared.contains("fn forward_dynamics"));
    assert!(!expanded.contains("#[mechanism") && expanded.contains("fn forward_dynamics"));
    let description: serde_json::Value = serde_json::from_str(&description).unwrap();
    let limits =
        serde_json::json!([{ "index": 0, "lower": -1.0, "upper": 2.5, "velocity": 3.0, "effort": null }]);
    assert_eq!(description["limits"], limits);
}

/// Checks that outputs whose names end like other forms of a function are exported, and that functions that C
/// does not have are listed.
#[test]
fn functions_missing_in_the_target_language_are_listed() {
    let here = test_folder("forms");
    let slider = "#[mechanism] pub struct Slider { pub m: f64, #[particle(mass = m)] block: Particle, \
        #[joint(ground -> block, along = x)] rail: Sleeve, #[limit(on = rail, to = 1)] end: Limit, \
        #[output(2 * rail)] motor_lanes: Scalar, #[output(3 * rail)] heat_into: Scalar, \
        #[output(norm(reaction_force(rail)))] load: Scalar }";
    std::fs::write(here.join("slider.rs"), slider).unwrap();
    let done = run_linkwork(&here, &["export", "library", "slider.rs", "--out", "slider"]);
    assert_eq!((done.0, done.2.as_str()), (0, ""));
    let text = std::fs::read_to_string(here.join("slider/description.json")).unwrap();
    let description: serde_json::Value = serde_json::from_str(&text).unwrap();
    let functions = description["functions"].as_array().unwrap();
    for name in ["motor_lanes", "heat_into"] {
        assert!(functions.iter().any(|f| f["name"] == name), "{name} in {text}");
    }
    let all =
        ["export", "c", "slider.rs", "--no-derivatives", "--casadi", "--with", "prepare, batch, drawing"];
    let (status, _, stderr) = run_linkwork(&here, &all);
    assert_eq!(status, 0);
    for line in [
        "the functions of `prepare`",
        "functions of several states at once, of `batch`",
        "the drawing, of `drawing`",
        "load in the form of CasADi",
        "limits in the form of CasADi",
    ] {
        assert!(stderr.contains(&format!("linkwork: not in C: {line}\n")), "{line} in {stderr}");
    }
}

/// Returns the text of the first code block of a language in the README.
fn readme_code_block(language: &str) -> String {
    let guide = include_str!("../README.md");
    let (_, rest) = guide.split_once(&format!("```{language}\n")).unwrap();
    rest.split_once("```").unwrap().0.to_string()
}

/// Checks that every command of the README runs from the folder of the repository.
#[test]
#[cfg(unix)]
fn commands_of_the_readme_run() {
    let here = test_folder("documented_commands");
    let _ = std::fs::remove_dir_all(&here);
    std::fs::create_dir_all(&here).unwrap();
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");
    std::os::unix::fs::symlink(models, here.join("models")).unwrap();
    let commands = readme_code_block("sh");
    let commands = commands.lines().map(|line| line.split(['#', '>']).next().unwrap());
    let commands: Vec<Vec<&str>> = commands
        .filter_map(|line| line.strip_prefix("linkwork "))
        .map(|line| line.split_whitespace().collect())
        .collect();
    assert!(commands.len() >= 10, "{commands:?}");
    for mut command in commands {
        if command[0] == "simulate" || command[0] == "view" && !command.contains(&"--live") {
            command.retain(|word| !["--duration", "2"].contains(word));
            command.extend(["--duration", "0.05"]);
        }
        let (status, _, stderr) = run_linkwork(&here, &command);
        assert_eq!(status, 0, "{command:?}: {stderr}");
    }
}

/// Checks that the C example of the README compiles and succeeds.
#[test]
fn c_example_of_the_readme_runs() {
    let here = test_folder("guide");
    std::fs::write(here.join("pendulum.rs"), readme_code_block("rust,ignore")).unwrap();
    std::fs::write(here.join("main.c"), readme_code_block("c")).unwrap();
    let (status, _, error) = run_linkwork(&here, &["export", "c", "pendulum.rs"]);
    assert_eq!((status, error.as_str()), (0, ""));
    let flags =
        ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O1", "main.c", "pendulum.c", "-lm"];
    let Ok(built) = Command::new("cc").current_dir(&here).args(flags).args(["-o", "main"]).status() else {
        println!("skipped: there is no C compiler");
        return;
    };
    assert!(built.success());
    assert!(Command::new(here.join("main")).status().unwrap().success());
}

/// Checks that the format of a robot file follows from its extension, or otherwise from its content.
#[test]
fn robot_file_formats_are_detected() {
    let here = test_folder("formats");
    let model = "<mujoco><worldbody><body name='b'><joint name='j'/><geom size='0.1'/></body></worldbody>\
                 <actuator><motor name='m' joint='j'/></actuator></mujoco>";
    for name in ["arm.xml", "arm.mjcf", "arm.urdf"] {
        std::fs::write(here.join(name), model).unwrap();
    }
    for name in ["arm.xml", "arm.mjcf"] {
        let (status, shown, _) = run_linkwork(&here, &["show", name]);
        assert!(status == 0 && shown.contains("m  N·m"), "{shown}");
    }
    let model = "<sdf version='1.9'><model name='m'><link name='a'/><link name='b'/>\
                 <joint name='turn' type='revolute'><parent>a</parent><child>b</child><axis/></joint></model></sdf>";
    for name in ["box.xml", "box.sdf", "box.world"] {
        std::fs::write(here.join(name), model).unwrap();
        let (status, shown, _) = run_linkwork(&here, &["show", name]);
        assert!(status == 0 && shown.contains("turn  N·m"), "{shown}");
    }
    let template = "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:include filename='a'/></robot>";
    std::fs::write(here.join("arm.urdf.xacro"), template).unwrap();
    let (status, _, said) = run_linkwork(&here, &["check", "arm.urdf.xacro"]);
    assert!(status == 1 && said.contains("expand the file first: `xacro robot.urdf.xacro"), "{said}");
    let (status, _, said) = run_linkwork(&here, &["check", "arm.urdf"]);
    assert!(
        status == 1 && said.starts_with("arm.urdf:1:1: error: expected `<robot>`, found `<mujoco>`"),
        "{said}"
    );
}

/// Checks the errors for mechanisms that cannot become a library, and for a folder without sources.
#[test]
fn mechanisms_without_library_export_are_rejected() {
    let fighter = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/src/fighter.rs");
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/mechanisms/mod.rs");
    for (arguments, words) in [
        (&["export", "library", fighter, "--struct", "Fighter"][..], "tables without values: --table"),
        (
            &["export", "library", own, "--struct", "Balloon", "--linkwork", "/nowhere"][..],
            "/nowhere has no sources of Linkwork",
        ),
        (&["export", "library", own, "--struct", "Balloon", "--with", "base = loose"][..], "base"),
    ] {
        let done = Command::new(env!("CARGO_BIN_EXE_linkwork")).args(arguments).output().unwrap();
        let text = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success() && text.contains(words), "{text}");
    }
}
