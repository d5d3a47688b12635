//! Checks pages in a browser, if one is installed: they have controls and a picture, and no console errors.

use linkwork::prelude::*;
use linkwork::simulate::Sample;
use linkwork_view::{Live, Motion, Page};
use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

#[mechanism(gravity = -9.81 * y, drawing)]
struct PlanarArm {
    #[body(mass = 1, com = x / 2, inertia = rod(1, 1, x))]
    upper: Body,
    #[body(mass = 1, com = x / 2, inertia = tube(1, 0.04, 0.05, 1, x))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(x) -> lower, about = z)]
    elbow: Pin,
    #[acts(between = (ground.at(2 * y), lower.at(x)), stiffness = 5)]
    spring: Spring,
    #[acts(on = elbow, damping = 1)]
    bearing: Dashpot,
    #[acts(on = shoulder)]
    motor: Torque,
    #[contact(lower.at(x), ground.plane(y))]
    floor: Contact,
}

/// Returns the first Chromium browser on the path.
fn find_browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name))).find(|p| p.is_file())
}

fn sample_of_arm(start: f64, k: u32) -> Sample<f64, 2, 2, 1> {
    let t = f64::from(k) / 60.0;
    Sample {
        t: start + t,
        q: [t, -t].into(),
        v: [1.0, -1.0].into(),
        u: [t.sin()].into(),
        event: None,
        violation: 0.0,
    }
}

/// Returns the document of a page after `duration` milliseconds of a browser's clock, which runs faster than
/// time, and asserts that the console has no messages. `meanwhile` is called repeatedly until then. Returns
/// `None` if no browser starts.
fn document_in_browser(
    (name, duration): (&str, u32),
    address: &str,
    mut meanwhile: impl FnMut(),
) -> Option<String> {
    let Some(browser) = find_browser() else {
        println!("skipped: no Chromium on the path");
        return None;
    };
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let mut command = Command::new(browser);
    command.args(["--headless=new", "--no-sandbox", "--disable-gpu", "--use-gl=angle"]);
    command.args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--enable-logging=stderr"]);
    command.arg(format!("--virtual-time-budget={duration}")).arg("--dump-dom");
    command.arg(format!("--user-data-dir={}", folder.join(name).display())).arg(address);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // The browser exits when both of its outputs have been read.
    let [mut out, mut err] = [Vec::new(), Vec::new()];
    let (mut stdout, mut stderr) = (child.stdout.take().unwrap(), child.stderr.take().unwrap());
    std::thread::scope(|scope| {
        let out = scope.spawn(|| stdout.read_to_end(&mut out));
        let err = scope.spawn(|| stderr.read_to_end(&mut err));
        while !(out.is_finished() && err.is_finished()) {
            meanwhile();
            std::thread::sleep(Duration::from_millis(10));
        }
    });
    let (dom, log) = (String::from_utf8_lossy(&out), String::from_utf8_lossy(&err));
    if !child.wait().unwrap().success() || dom.is_empty() {
        println!("skipped: this browser does not start without a screen");
        return None;
    }
    // With software rendering, the browser reports that drawing is slow.
    let is_console_message = |line: &&str| line.contains("CONSOLE") && !line.contains("GL Driver Message");
    let console: Vec<&str> = log.lines().filter(is_console_message).collect();
    assert!(console.is_empty(), "{console:?}");
    assert!(dom.contains("class=\"play\"") && dom.contains("<output>"), "the controls are there");
    assert!(!dom.contains("class=\"failure\""), "the picture could be made");
    Some(dom.into_owned())
}

#[test]
fn browser_plays_the_page() {
    let samples: Vec<_> = (0..120).map(|k| sample_of_arm(0.0, k)).collect();
    let motion_of_arm = || Motion::of("<i>arm</i>", &PlanarArm {}, &samples).unwrap();
    let pull = samples.iter().map(|s| [0.0, s.t, 0.0]).collect::<Vec<_>>();
    let first = motion_of_arm().trail("lower", [1.0, 0.0, 0.0], 0.5).unwrap().force(
        Some("lower"),
        [1.0, 0.0, 0.0],
        pull,
    );
    let point_on_hill = |u: f64, w: f64| [u, -1.0 + 0.1 * u.sin(), w];
    let second =
        motion_of_arm().drawn().surface("hill", None, [-1.0, 1.0], [-1.0, 1.0], point_on_hill).unwrap();
    let page = Page::new("Two arms").motion(first.unwrap()).motion(motion_of_arm().figure(second).unwrap());
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("browser.html");
    page.write(&file).unwrap();
    let Some(dom) = document_in_browser(("browser", 1500), &format!("file://{}", file.display()), || ())
    else {
        return;
    };
    assert_eq!(
        dom.matches("&lt;i&gt;arm&lt;/i&gt;").count(),
        6,
        "two labels, captions and names of two plots"
    );
}

/// Checks a live view in a browser for a loop whose time begins at 1000 s.
#[test]
fn browser_shows_live_view() {
    let mut live = Live::open(&PlanarArm {}, 0).unwrap();
    let (url, mut k) = (live.url(), 0);
    let mut show_next_sample = || {
        live.show(&sample_of_arm(1000.0, k)).unwrap();
        k += 1;
    };
    let mut time = 0.0;
    // On a busy machine, the clock of the browser may have run down before the first sample arrives.
    for duration in [1500, 6000, 24_000] {
        let Some(dom) = document_in_browser(("live", duration), &url, &mut show_next_sample) else { return };
        let (_, clock) = dom.split_once("<output>").unwrap();
        time = clock.split_once(" s<").unwrap().0.parse().unwrap();
        if time > 0.0 {
            break;
        }
    }
    assert!((1000.0..=sample_of_arm(1000.0, k).t).contains(&time), "{time}");
}
