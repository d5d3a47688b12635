//! Pages in a browser, where there is one: no error on the console, the controls are there, and the picture could be made.

use linkwork::prelude::*;
use linkwork_view::{Motion, Page};
use std::path::PathBuf;
use std::process::Command;

#[mechanism(gravity = -9.81 * y, drawing)]
struct Arm {
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

/// The first browser of this kind on the path.
fn browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name))).find(|p| p.is_file())
}

#[test]
fn a_browser_plays_the_page() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium on the path");
        return;
    };
    let sample = |k: u32| {
        let t = f64::from(k) / 60.0;
        linkwork::simulate::Sample {
            t,
            q: [t, -t].into(),
            v: [1.0, -1.0].into(),
            u: [t.sin()].into(),
            event: None,
        }
    };
    let samples: Vec<_> = (0..120).map(sample).collect();
    let motion = || Motion::of("<i>arm</i>", &Arm {}, &samples).unwrap();
    let page =
        Page::new("Two arms").motion(motion().trail("lower", [1.0, 0.0, 0.0], 0.5).unwrap()).motion(motion());
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join("browser.html");
    page.write(&file).unwrap();
    let mut command = Command::new(browser);
    command.args([
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--use-gl=angle",
        "--use-angle=swiftshader",
    ]);
    command.args([
        "--enable-unsafe-swiftshader",
        "--enable-logging=stderr",
        "--virtual-time-budget=1500",
        "--dump-dom",
    ]);
    command.arg(format!("--user-data-dir={}", folder.join("browser").display()));
    let output = command.arg(format!("file://{}", file.display())).output().unwrap();
    let (dom, log) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if !output.status.success() || dom.is_empty() {
        println!("skipped: this browser does not start without a screen");
        return;
    }
    // Of drawing by software it says that it is slow.
    let is_said = |line: &&str| line.contains("CONSOLE") && !line.contains("GL Driver Message");
    let console: Vec<&str> = log.lines().filter(is_said).collect();
    assert!(console.is_empty(), "{console:?}");
    assert!(dom.contains("class=\"play\"") && dom.contains("<output>"), "the controls are there");
    assert_eq!(
        dom.matches("&lt;i&gt;arm&lt;/i&gt;").count(),
        6,
        "two labels, captions and names of two plots"
    );
    assert!(!dom.contains("class=\"failure\""), "the picture could be made");
}
