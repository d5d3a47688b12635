//! Tests of live pages: trajectories equal those of the command, and closed forms of contacts.

use super::{rows_of_log, run_linkwork, test_folder};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Function for Node that opens the simulation of a page.
const OPEN: &str = r#"
const fs = require("fs");
globalThis.document = { querySelectorAll: () => [] };
globalThis.matchMedia = () => ({ addEventListener() {} });
function open(file) {
  const html = fs.readFileSync(file, "utf8");
  const [motion] = JSON.parse(html.match(/<script type="application\/json">(.*?)<\/script>/s)[1]);
  const code = html.slice(html.lastIndexOf("<script>") + 8, html.lastIndexOf("</script>"));
  const { Simulation } = new Function(code + "; return linkwork;")();
  return Simulation.open({ ...motion.simulated, module: motion.module });
}
const fail = error => { console.error(error); process.exit(1); };
"#;

/// Program for Node that advances the simulation of a page, and prints its state.
const ADVANCE: &str = r#"
const [, file, time, tolerance] = process.argv;
open(file).then(sim => {
  sim.tolerance = +tolerance;
  sim.reluctant = Infinity;
  sim.advance(+time);
  console.log(JSON.stringify([...sim.q, ...sim.v, ...sim.x, ...sim.energies()]));
}).catch(fail);
"#;

/// Program for Node that advances the simulations of all pages of a folder, and prints the names of those
/// that have moved on to finite states.
const ADVANCE_ALL: &str = r#"
(async () => {
  for (const file of fs.readdirSync("pages").filter(file => file !== "index.html")) {
    const sim = await open("pages/" + file).catch(fail);
    try { sim.advance(0.1); } catch (error) { fail(file + ": " + error); }
    const all = [sim.t, ...sim.q, ...sim.v, ...sim.x, ...sim.energies()];
    if (all.every(Number.isFinite) && Math.abs(sim.t - 0.1) < 1e-9) console.log(file);
  }
})();
"#;

/// Returns the first of these programs that is installed.
fn first_program_on_path(names: &[&str]) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path)
        .flat_map(|folder| names.iter().map(move |name| folder.join(name)))
        .find(|p| p.is_file())
}

/// Writes the page of a mechanism, and returns its state and energies after some seconds; `None` without
/// Node.
fn simulate_page(here: &Path, given: &[&str], seconds: &str, tolerance: &str) -> Option<Vec<f64>> {
    let (status, _, stderr) =
        run_linkwork(here, &[&["view", "--live", "--out", "page.html"], given].concat());
    assert_eq!(status, 0, "{stderr}");
    let Some(node) = first_program_on_path(&["node"]) else {
        println!("skipped: no Node on the path");
        return None;
    };
    let program = format!("{OPEN}{ADVANCE}");
    let mut command = Command::new(node);
    command.args(["-e", &program, "page.html", seconds, tolerance]).current_dir(here);
    let output = command.output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(text.trim().trim_matches(['[', ']']).split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect())
}

const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");

/// Checks that pages and the command compute the same trajectories to 1e-9: of a tree with a free joint and
/// ball joints, of declared speeds, of a loop, of a rolling body, of sliding friction, of states of first
/// order, and of a robot.
#[test]
fn pages_and_the_command_compute_equal_trajectories() {
    let here = test_folder("live");
    let model_path = |file: &str| format!("{MODELS}/{file}");
    let [loop_, disk, rotor, arm] =
        ["src/four_bar.rs", "src/rolling_disk.rs", "src/quadrotor.rs", "urdf/ur5.urdf"].map(model_path);
    let cases: [(&str, &str); 6] = [
        (super::FLAIL, "handle=0.5 v.flight.wx=2 v.chain.wy=-3 q.flight.z=1 u.thrust=3"),
        (super::JUGGLER, "axial=0.25 q.theta=0.4 v.ux=0.3 v.uy=-0.2 v.wx=0.4 v.wz=2 v.bend=-0.6"),
        (&loop_, "g=9.81 density=0.8 a=0.3 b=0.9 c=0.7 d=0.8 q.input=0.7 v.input=12"),
        (&disk, "g=9.81 m=2 radius=0.4 q.lean=0.3 v.roll=6 v.heading=1"),
        (
            &rotor,
            "g=9.81 mass=0.8 ixx=6e-3 iyy=7e-3 izz=11e-3 arm=0.2 thrust=9e-6 drag=1.5e-7 lag=0.04 \
             u.front=470 u.left=460 u.back=465 u.right=475",
        ),
        (&arm, "q.shoulder_lift_joint=-1 q.elbow_joint=0.5 u.wrist_1_joint=0.1"),
    ];
    for (file, values) in cases {
        let set: Vec<&str> = values.split(' ').flat_map(|value| ["--set", value]).collect();
        compare_page_with_command(&here, &[&[file], &set[..]].concat(), 1e-9);
    }
}

/// Checks that a page and the command compute the same state after half a second.
fn compare_page_with_command(here: &Path, given: &[&str], tolerance: f64) {
    let Some(found) = simulate_page(here, given, "0.5", "1e-12") else { return };
    let times = ["--duration", "0.5", "--every", "0.5", "--tolerance", "1e-13"];
    let (status, log, stderr) = run_linkwork(here, &[&["simulate"], given, &times].concat());
    assert_eq!(status, 0, "{stderr}");
    let rows = rows_of_log(&log);
    // The command prints inputs behind the state; the page prints energies.
    let expected = &rows.last().unwrap()[1..];
    let states = found.len() - 3;
    assert!(states <= expected.len(), "{given:?}");
    for (a, b) in found[..states].iter().zip(expected) {
        assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{given:?}: {found:?} {expected:?}");
    }
}

/// Checks that pages of the gallery and the command compute the same trajectories: of a chain of five
/// pendulums, of a platform with six loops, of a ball on a surface, whose coordinates have no inertia, and
/// of an aircraft with tables.
#[test]
fn pages_of_the_gallery_and_the_command_compute_equal_trajectories() {
    let here = test_folder("live_gallery");
    let list = std::fs::read_to_string(format!("{MODELS}/gallery.txt")).unwrap();
    for (start, tolerance) in [
        ("src/pendulum_chain.rs --struct Quintuple", 1e-9),
        ("src/stewart_platform.rs", 1e-9),
        ("src/ball_in_dish.rs", 1e-9),
        // Steps that cross the edges of linear tables have larger errors.
        ("src/fighter.rs", 1e-7),
    ] {
        let line = list.lines().find(|line| line.starts_with(start)).expect("a line of the gallery");
        let gravity = if line.contains("--set g=") { "" } else { " --set g=9.81" };
        let line = format!("{line}{gravity}").replace("src/", &format!("{MODELS}/src/"));
        let words: Vec<&str> = line.split_whitespace().collect();
        compare_page_with_command(&here, &words, tolerance);
    }
}

/// Checks that pages look up tables as the library does: linear and smooth ones, within the grid and beyond
/// it, with one, two and three variables, and the slopes of a potential.
#[test]
fn pages_look_up_tables() {
    let here = test_folder("live_tables");
    let text = "#[mechanism]
        struct Boat {
            mass: f64,
            drag: Table<1>,
            wind: Table<2>,
            well: Table<3>,
            #[body(mass = mass)] hull: Body,
            #[joint(ground -> hull, along = x)] way: Sleeve,
            #[body(mass = mass)] crate_: Body,
            #[joint(hull -> crate_, along = y)] slide: Sleeve,
            #[acts(on = way, value = -drag(rate(way)) + wind(way, slide))] force: Force,
            #[energy(well(way, slide, way + slide))] bay: Potential,
        }";
    std::fs::write(here.join("boat.rs"), text).unwrap();
    std::fs::write(here.join("drag.csv"), "-3,-7\n-1,-1.5\n0,0\n1,1\n3,8\n").unwrap();
    let (mut wind, mut well) = (String::new(), String::new());
    for x in [-1.0_f64, 0.5, 2.0, 3.0] {
        for y in [-2.0_f64, 0.0, 0.7, 2.0] {
            wind += &format!("{x},{y},{}\n", (x + 0.3 * y).cos());
            for z in [-3.0_f64, 0.1, 1.0, 4.0] {
                well += &format!("{x},{y},{z},{}\n", x * x + 2.0 * y * y + 0.1 * z * x + (y * z).sin());
            }
        }
    }
    std::fs::write(here.join("wind.csv"), wind).unwrap();
    std::fs::write(here.join("well.csv"), well).unwrap();
    for options in [[",smooth", "", ",smooth"], [",smooth,extrapolated", ",smooth", ",smooth,extrapolated"]] {
        let tables = ["drag", "wind", "well"].iter().zip(options);
        let tables: Vec<String> = tables.map(|(name, option)| format!("{name}={name}.csv{option}")).collect();
        let set = "mass=0.8 q.way=1.9 v.way=4 q.slide=0.5 v.slide=-2";
        let set: Vec<&str> = set.split(' ').flat_map(|value| ["--set", value]).collect();
        let tables: Vec<&str> = tables.iter().flat_map(|table| ["--table", table]).collect();
        let given = [&["boat.rs"], &set[..], &tables[..]].concat();
        let Some(found) = simulate_page(&here, &given, "0.5", "1e-11") else { return };
        let times = ["--duration", "0.5", "--every", "0.5", "--tolerance", "1e-11"];
        let (status, log, stderr) = run_linkwork(&here, &[&["simulate"], &given[..], &times].concat());
        assert_eq!(status, 0, "{stderr}");
        let expected = rows_of_log(&log).pop().unwrap();
        for (a, b) in found.iter().zip(&expected[1..]) {
            // Steps that cross the edges of linear tables have larger errors.
            assert!((a - b).abs() <= 1e-7 * b.abs().max(1.0), "{found:?} {expected:?}");
        }
    }
    let (status, _, stderr) = run_linkwork(&here, &["view", "--live", "boat.rs", "--set", "mass=1"]);
    assert!(status == 2 && stderr.contains("tables without values: --table drag=FILE"), "{stderr}");
}

/// Checks contacts with closed forms. A ball dropped from 0.9 m with restitution ½ rebounds to a quarter of
/// the height. A block slides `v²/(2μg)`. A ball that slides at first rolls with 5/7 of its speed, so that
/// its kinetic energy is `m (5/7 v)² (1 + 2/5) / 2`. All of them come to rest on the floor, not in it.
#[test]
fn contacts_simulated_by_pages_have_closed_forms() {
    let here = test_folder("live_contacts");
    let text = "#[mechanism(gravity = -9.81 * z)]
        struct Bouncing {
            #[body(mass = 1, inertia = sphere(1, 0.1))] ball: Body,
            #[joint(ground -> ball, along = z)] height: Sleeve,
            #[contact(ball.sphere(0.1), ground.plane(z), restitution = 0.5)] floor: Contact,
        }
        #[mechanism(gravity = -9.81 * z)]
        struct Sliding {
            #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))] block: Body,
            #[joint(ground -> block)] pose: Free,
            #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = 0.3)] floor: Contact,
        }
        #[mechanism(gravity = -9.81 * z)]
        struct Rolling {
            #[body(mass = 2, inertia = sphere(2, 0.1))] ball: Body,
            #[joint(ground -> ball)] pose: Free,
            #[contact(ball.sphere(0.1), ground.plane(z), friction = 0.3)] floor: Contact,
        }";
    std::fs::write(here.join("contacts.rs"), text).unwrap();
    let simulate_page_with_values = |name: &str, values: &[&str], seconds: f64| {
        let set: Vec<&str> = values.iter().flat_map(|value| ["--set", value]).collect();
        simulate_page(
            &here,
            &[&["contacts.rs", "--struct", name], &set[..]].concat(),
            &seconds.to_string(),
            "1e-9",
        )
    };
    // The highest point after the first impact: as long again as half of the fall.
    let fall = (2.0 * 0.9 / 9.81_f64).sqrt();
    let Some(top) = simulate_page_with_values("Bouncing", &["q.height=1"], 1.5 * fall) else { return };
    assert!((top[0] - 0.1 - 0.9 / 4.0).abs() < 1e-3 && top[1].abs() < 5e-3, "{top:?}");
    let at_rest = simulate_page_with_values("Bouncing", &["q.height=1"], 3.0).unwrap();
    assert!((at_rest[0] - 0.1).abs() < 1e-5 && at_rest[1].abs() < 1e-5, "{at_rest:?}");
    let block = simulate_page_with_values("Sliding", &["q.pose.z=0.05", "v.pose.vx=2"], 1.0).unwrap();
    assert!(
        (block[0] - 4.0 / (2.0 * 0.3 * 9.81)).abs() < 1e-5 && (block[2] - 0.05).abs() < 1e-9,
        "{block:?}"
    );
    let ball = simulate_page_with_values("Rolling", &["q.pose.z=0.1", "v.pose.vx=2"], 1.0).unwrap();
    let energy = (5.0 / 7.0 * 2.0_f64).powi(2) * 1.4;
    assert!((ball[ball.len() - 3] - energy).abs() < 1e-5 && (ball[2] - 0.1).abs() < 1e-9, "{ball:?}");
}

/// Checks that pages are self-contained, and the messages for mechanisms that a page cannot simulate.
#[test]
fn simulating_pages_are_self_contained() {
    let here = test_folder("live_page");
    let disk = format!("{MODELS}/src/double_pendulum.rs");
    let (status, _, stderr) = run_linkwork(&here, &["view", "--live", &disk, "--out", "page.html"]);
    assert_eq!(
        (status, stderr.as_str()),
        (0, "linkwork: parameters without a value begin at g = 9.81, m1 = 1, m2 = 1, l1 = 1, l2 = 1\n")
    );
    let html = std::fs::read_to_string(here.join("page.html")).unwrap();
    assert!(html.len() < 1_500_000 && !html.contains("http"), "{}", html.len());
    assert!(
        html.contains("<noscript><p>This page needs scripts")
            && html.contains("<svg")
            && html.contains("<math>")
    );
    let fragment = ["view", "--live", "--fragment", &disk, "--out", "part.html"];
    assert_eq!(run_linkwork(&here, &fragment).0, 0);
    let part = std::fs::read_to_string(here.join("part.html")).unwrap();
    // Markdown ends a block of HTML at an empty line, except in styles and scripts.
    let (_, element) = part.split_once("</style>\n").unwrap();
    assert!(part.starts_with("<style>") && !element.split_once("<script>\n").unwrap().0.contains("\n\n"));
    std::fs::write(
        here.join("still.rs"),
        "#[mechanism(inertia = none)] struct Still { #[body] rod: Body, \
         #[joint(ground -> rod, about = z)] pin: Pin }",
    )
    .unwrap();
    let (status, _, stderr) = run_linkwork(&here, &["view", "--live", "still.rs"]);
    assert!(status == 2 && stderr.contains("no masses"), "{stderr}");
    let (status, _, stderr) = run_linkwork(&here, &["view", "--live", &disk, "--duration", "2"]);
    assert!(status == 2 && stderr.contains("--duration"), "{stderr}");
}

/// Checks the page in a browser, if one is installed: it simulates, draws, and reports no error.
#[test]
fn page_simulates_in_a_browser() {
    let here = test_folder("live_browser");
    let disk = format!("{MODELS}/src/double_pendulum.rs");
    let (status, _, stderr) =
        run_linkwork(&here, &["view", "--live", &disk, "--set", "q.shoulder=1", "--out", "page.html"]);
    assert_eq!(status, 0, "{stderr}");
    let Some(browser) = first_program_on_path(&["chromium", "chromium-browser", "google-chrome", "chrome"])
    else {
        println!("skipped: no Chromium on the path");
        return;
    };
    let mut command = Command::new(browser);
    command.args(["--headless=new", "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--disable-quic"]);
    command.args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--enable-logging=stderr"]);
    command.args(["--disable-background-networking", "--virtual-time-budget=1500", "--dump-dom"]);
    command.arg(format!("--user-data-dir={}", here.join("browser").display()));
    let output = command.arg(format!("file://{}", here.join("page.html").display())).output().unwrap();
    let (dom, log) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if !output.status.success() || dom.is_empty() {
        println!("skipped: this browser does not start without a screen");
        return;
    }
    let is_console_message = |line: &&str| line.contains("CONSOLE") && !line.contains("GL Driver Message");
    let console: Vec<&str> = log.lines().filter(is_console_message).collect();
    assert!(console.is_empty(), "{console:?}");
    assert!(dom.contains("data-ready=\"true\"") && !dom.contains("class=\"failure\""), "{dom}");
    assert_eq!(dom.matches("class=\"row\"").count(), 5 + 4, "sliders of parameters and of the initial state");
    let (_, clock) = dom.split_once("<output>").unwrap();
    let time: f64 = clock.split_once(" s<").unwrap().0.parse().unwrap();
    assert!(time > 0.0, "{time}");
}

/// Checks that the gallery has a page of every mechanism of the models, and that each page simulates.
#[test]
fn gallery_has_pages_of_all_models() {
    let here = test_folder("live_models");
    let list = format!("{MODELS}/gallery.txt");
    let (status, _, stderr) = run_linkwork(&here, &["gallery", &list, "--out", "pages"]);
    assert_eq!(status, 0, "{stderr}");
    let models = std::fs::read_to_string(format!("{MODELS}/src/lib.rs")).unwrap();
    let exports = models.lines().filter_map(|line| line.strip_prefix("pub use ")?.split_once("::"));
    let names: Vec<&str> = exports.flat_map(|(_, names)| names.split(['{', '}', ',', ';', ' '])).collect();
    // Two further variants of the arm `Panda`.
    let needs_gallery_page = |name: &&&str| !name.is_empty() && !["LoadedPanda", "PandaArm"].contains(*name);
    assert!(names.contains(&"Pendulum"));
    for name in names.iter().filter(needs_gallery_page) {
        assert!(here.join(format!("pages/{name}.html")).is_file(), "there is no page of {name}");
    }
    let Some(node) = first_program_on_path(&["node"]) else {
        println!("skipped: no Node on the path");
        return;
    };
    let program = format!("{OPEN}{ADVANCE_ALL}");
    let output = Command::new(node).args(["-e", &program]).current_dir(&here).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let moved = String::from_utf8(output.stdout).unwrap();
    for file in std::fs::read_dir(here.join("pages")).unwrap() {
        let file = file.unwrap().file_name().into_string().unwrap();
        assert!(file == "index.html" || moved.lines().any(|line| line == file), "{file} does not move");
    }
}

/// Checks that each line of a list has a page and an entry of the index, and the message for a wrong line.
#[test]
fn gallery_index_lists_every_page() {
    let here = test_folder("gallery");
    let list = "# two pages\n\ndouble.rs --set q.shoulder=1\n\
                double.rs --set q.elbow=1 --with \"derivatives\"\n";
    std::fs::write(here.join("list.txt"), list).unwrap();
    std::fs::copy(format!("{MODELS}/src/double_pendulum.rs"), here.join("double.rs")).unwrap();
    let (status, out, stderr) = run_linkwork(&here, &["gallery", "list.txt", "--out", "pages"]);
    assert_eq!((status, out.as_str()), (0, "pages/index.html\n"), "{stderr}");
    let index = std::fs::read_to_string(here.join("pages/index.html")).unwrap();
    for page in ["DoublePendulum.html", "DoublePendulum-4.html"] {
        assert!(index.contains(&format!("<a href=\"{page}\">")) && here.join("pages").join(page).is_file());
    }
    // Files of tables are relative to the list, too.
    std::fs::create_dir_all(here.join("week")).unwrap();
    let spring = "#[mechanism] struct Spring { law: Table<1>, #[body(mass = 1)] block: Body, \
                  #[joint(ground -> block, along = x)] rail: Sleeve, \
                  #[acts(on = rail, value = -law(rail))] force: Force }";
    std::fs::write(here.join("week/spring.rs"), spring).unwrap();
    std::fs::write(here.join("week/law.csv"), "-1,-2\n1,2\n").unwrap();
    std::fs::write(here.join("week/list.txt"), "spring.rs --table law=law.csv\n").unwrap();
    let (status, _, stderr) = run_linkwork(&here, &["gallery", "week/list.txt", "--out", "pages"]);
    assert_eq!(status, 0, "{stderr}");
    std::fs::write(here.join("bad.txt"), "double.rs --set q.elbw=1\n").unwrap();
    let (status, _, stderr) = run_linkwork(&here, &["gallery", "bad.txt"]);
    assert!(status == 2 && stderr.contains("bad.txt:1: `--set`: there is no `q.elbw`"), "{stderr}");
}
