//! Writes the robots of the comparison to files that the peer libraries read.

use crate::robots::{RobotWithContenders, robot_constructors};
use linkwork_benches::peers::contender::MeasuredFunction;
use roxmltree::Document;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// Writes a folder for every robot: `robot.urdf`; `joints`, the names of the moving joints in order; `free`
/// if the base is free; `derivatives` if they are measured. Prints the folders.
pub fn write_robot_folders(folder: &Path) -> io::Result<()> {
    for make in robot_constructors() {
        let robot = make();
        let folder = folder.join(robot.name);
        fs::create_dir_all(&folder)?;
        fs::write(folder.join("robot.urdf"), urdf_with_options(&robot)?)?;
        fs::write(folder.join("joints"), robot.joints.join("\n"))?;
        let derivatives =
            robot.functions.iter().any(|(function, _)| *function == MeasuredFunction::InverseDerivatives);
        for (name, is) in [("free", robot.free), ("derivatives", derivatives)] {
            if is {
                fs::write(folder.join(name), "")?;
            }
        }
        writeln!(io::stdout(), "{}", folder.display())?;
    }
    Ok(())
}

/// Returns the file with the robot's options applied: locked joints become fixed, and no joint follows
/// another.
fn urdf_with_options(robot: &RobotWithContenders) -> io::Result<String> {
    let document = Document::parse(&robot.urdf).map_err(|error| io::Error::other(error.to_string()))?;
    let joints = document.root_element().children().filter(|node| node.has_tag_name("joint"));
    let mut changes = Vec::new();
    for joint in joints {
        let locked = joint.attribute("name").is_some_and(|name| robot.lock.contains(&name));
        let kind = joint.attribute_node("type").filter(|_| locked);
        changes.extend(kind.map(|kind| (kind.range_value(), "fixed")));
        let mimic = joint.children().find(|node| node.has_tag_name("mimic"));
        changes.extend(mimic.map(|mimic| (mimic.range(), "")));
    }
    let mut text = robot.urdf.clone();
    changes.sort_by_key(|(place, _)| std::cmp::Reverse(place.start));
    for (place, by) in changes {
        text.replace_range(place, by);
    }
    Ok(text)
}
