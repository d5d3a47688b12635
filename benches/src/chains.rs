//! Chains of pins of any length, as the text of a `#[mechanism]` struct.

use std::fmt::Write;

/// A mechanism as the attribute receives it.
pub struct Source {
    /// What stands in the attribute's parentheses.
    pub arguments: String,
    /// The struct.
    pub item: String,
}

/// A chain of `n` links on pins about changing axes. `symbolic`: mass, length, centre of mass and inertia of each link
/// are parameters; else they are numbers.
pub fn chain(n: usize, symbolic: bool) -> Source {
    let mut item = "pub struct Chain {\n".to_string();
    let mut parent = "ground".to_string();
    for k in 1..=n {
        let number = |what: &str, value: f64| match symbolic {
            true => format!("{what}{k}"),
            false => format!("{:.4}", value * (1.0 + 0.1 / k as f64)),
        };
        let (mass, length, center) = (number("m", 2.0), number("l", 0.4), number("c", 0.2));
        let inertia = [number("a", 0.03), number("b", 0.04), number("e", 0.02)];
        if symbolic {
            // The last link carries nothing, so its length is not used.
            for what in ["m", "c", "a", "b", "e", "l"].into_iter().take(if k < n { 6 } else { 5 }) {
                let _ = writeln!(item, "pub {what}{k}: f64,");
            }
        }
        let axis = ["z", "y", "x"][k % 3];
        let _ = writeln!(
            item,
            "#[body(mass = {mass}, com = {center} * z, inertia = diagonal({}))] link{k}: Body,",
            inertia.join(", ")
        );
        let _ = writeln!(item, "#[joint({parent} -> link{k}, about = {axis})] joint{k}: Pin,");
        parent = format!("link{k}.at({length} * z)");
    }
    item.push('}');
    Source { arguments: "gravity = -9.81 * z".to_string(), item }
}
