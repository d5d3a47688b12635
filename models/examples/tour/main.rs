//! Tour of Linkwork: six mechanisms, each simulated from generated equations and compared with known results
//! of mechanics.
//!
//! ```text
//! cargo run --release --example tour -p linkwork-models
//! ```
//!
//! It prints a report, writes `index.html` with animations and plots (into `target/tour`, or the folder given
//! as the only argument), and fails if any check does.

mod aircraft;
mod arm;
mod cart_pole;
mod page;
mod pendulum;
mod quadruped;
mod report;
mod scene;
mod top;

use report::Section;
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use std::{env, fs};

/// Function that runs one section of the tour.
type SectionFunction = fn() -> Result<Section, Box<dyn Error>>;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let start = Instant::now();
    let stops: [SectionFunction; 6] = [
        pendulum::run_pendulum_tour,
        cart_pole::run_cart_pole_tour,
        arm::arm_tour_section,
        quadruped::run_quadruped_tour,
        aircraft::run_aircraft_tour,
        top::run_top_tour,
    ];
    println!(
        "Linkwork: mechanisms as annotated structs, compiled to equations of motion. A tour in six stops.\n"
    );
    let mut sections = Vec::new();
    for (k, stop) in stops.iter().enumerate() {
        let section = stop()?;
        print!("{}", section.section_text(k + 1));
        sections.push(section);
    }

    let folder = output_folder()?;
    fs::create_dir_all(&folder)?;
    let index = folder.join("index.html");
    fs::write(&index, page::page_html(&sections))?;
    println!("Watch it: {}", index.display());

    let failed = sections.iter().flat_map(|s| &s.checks).filter(|check| !check.is_below_bound()).count();
    let total: usize = sections.iter().map(|s| s.checks.len()).sum();
    let seconds = start.elapsed().as_secs_f64();
    if failed == 0 {
        println!("All {total} checks hold. The tour took {seconds:.1} s.");
        Ok(ExitCode::SUCCESS)
    } else {
        eprintln!("{failed} of {total} checks FAILED; they are marked with ✗ above.");
        Ok(ExitCode::FAILURE)
    }
}

/// Returns the output folder: the argument, or `tour` in cargo's target folder, three levels above
/// `target/release/examples/tour`.
fn output_folder() -> Result<PathBuf, Box<dyn Error>> {
    if let Some(folder) = env::args_os().nth(1) {
        return Ok(folder.into());
    }
    let program = env::current_exe()?;
    let target = program.ancestors().nth(3).ok_or("the program is in no target folder")?;
    Ok(target.join("tour"))
}
