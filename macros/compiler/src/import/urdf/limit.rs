//! `<limit>` of a joint → bounds of its coordinate, velocity and force.

use crate::import::context::{Cx, quote_word};
use crate::import::element::{Node, read_number_attribute, report_unexpected_contents};
use crate::import::imported::Located;
use crate::import::robot::{FileLimits, IGNORE_LIMITS};
use crate::syntax::Name;

const BOUNDS: [&str; 4] = ["lower", "upper", "velocity", "effort"];

/// URDF attributes of other tools that bound quantities other than the joint's coordinate, velocity and
/// force.
const OF_OTHERS: [&str; 10] = [
    "acceleration",
    "deceleration",
    "jerk",
    "command_effort",
    "current",
    "gear_velocity",
    "k_position",
    "k_velocity",
    "soft_lower_limit",
    "soft_upper_limit",
];

/// Reads the limits of a joint with one coordinate. `continuous` joints have no bounds of the coordinate.
pub(super) fn read_limits(
    node: Option<Node<'_>>,
    joint: Option<&Name>,
    continuous: bool,
    cx: &mut Cx<'_>,
) -> FileLimits {
    let Some(node) = node else { return FileLimits::default() };
    report_unexpected_contents(node, &[], &BOUNDS, &OF_OTHERS, cx);
    let ends = !continuous && ["lower", "upper"].iter().any(|which| node.has_attribute(*which));
    let mut read_coordinate_bound =
        |which: &str, infinite: &str| ends.then(|| read_bound(node, which, infinite, cx)).flatten();
    let (lower, upper) = (read_coordinate_bound("lower", "-inf"), read_coordinate_bound("upper", "inf"));
    let name = joint.map_or_else(String::new, |name| format!(" of joint {}", quote_word(&name.text)));
    if let (Some(low), Some(high)) = (&lower, &upper)
        && low.value > high.value
    {
        let message = format!("`lower`{name} is {}, above its `upper`, which is {}", low.value, high.value);
        cx.report_error(&low.place, message, |d| {
            d.add_help("without one of the two it is 0").add_help(IGNORE_LIMITS)
        });
    }
    let mut read_nonnegative_limit = |which: &str| {
        let found = node.has_attribute(which).then(|| read_bound(node, which, "inf", cx)).flatten()?;
        if found.value < 0.0 {
            let message = format!("negative `{which}`{name}: {}", found.value);
            cx.report_error(&found.place, message, |d| d.add_help(IGNORE_LIMITS));
        }
        Some(found)
    };
    let (velocity, effort) = (read_nonnegative_limit("velocity"), read_nonnegative_limit("effort"));
    FileLimits { lower, upper, velocity, effort }
}

/// Reads a bound. Returns `None` for infinity, and 0 if the attribute is missing.
fn read_bound(node: Node<'_>, which: &str, infinite: &str, cx: &mut Cx<'_>) -> Option<Located<f64>> {
    let Some(text) = node.attribute(which) else {
        return Some(Located { value: 0.0, place: cx.source_position(node.range().start) });
    };
    let plain = text.trim().trim_start_matches('+').to_ascii_lowercase();
    if plain == infinite || plain == format!("{infinite}inity") {
        return None;
    }
    read_number_attribute(node, which, cx)
}
