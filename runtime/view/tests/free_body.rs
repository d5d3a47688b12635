//! Checks of free-body diagrams as SVG.

use linkwork::prelude::*;
use linkwork_view::{Side, free_body};

/// Test mechanism: horizontal rod on a pin with a motor.
#[mechanism(gravity = -9.81 * y)]
struct PinnedRod {
    #[body(mass = 2, com = 0.5 * x, inertia = rod(2, 1, x))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    hinge: Pin,
    #[acts(on = rod, about = z)]
    motor: Torque,
    #[output(rod)]
    loads: FreeBody,
}

/// Returns the displacements from start to end of the straight lines of a colour in an SVG picture, to the
/// right and upward.
fn arrow_vectors(svg: &str, colour: &str) -> Vec<[f64; 2]> {
    let number_of_attribute = |line: &str, name: &str| -> f64 {
        let rest = line.split(&format!("{name}=\"")).nth(1).expect("an attribute");
        rest.split('"').next().and_then(|text| text.parse().ok()).expect("a number")
    };
    let lines = svg.lines().filter(|line| line.starts_with("<line") && line.contains(colour));
    let arrow_from_line = |line: &str| {
        [["x2", "x1"], ["y1", "y2"]].map(|[a, b]| number_of_attribute(line, a) - number_of_attribute(line, b))
    };
    lines.map(arrow_from_line).collect()
}

#[test]
fn arrows_show_forces_and_arcs_torques() {
    let rod = PinnedRod {};
    let (q, v) = ([0.0].into(), [0.0].into());
    let svg = free_body(&rod.loads(&q, &v, &[9.81].into()), Side::Xy);
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    // The weight acts downward, the hinge force upward: the motor balances the moment, and the hinge carries
    // the weight.
    let [weight, hinge] = ["#5a5a5a", "#005aa0"].map(|colour| arrow_vectors(&svg, colour));
    assert!(weight.len() == 1 && hinge.len() == 1, "{svg}");
    assert!(weight[0][0] == 0.0 && weight[0][1] < -90.0 && hinge[0][1] > 90.0);
    // A torque towards the viewer is a counterclockwise arc, whose sweep flag is 0.
    let arc = svg.lines().find(|line| line.contains(" A ") && line.contains("#d55e00")).expect("an arc");
    assert!(arc.contains(" 0 1 0 "), "{arc}");
    let back = free_body(&rod.loads(&q, &v, &[-9.81].into()), Side::Xy);
    let arc = back.lines().find(|line| line.contains(" A ") && line.contains("#d55e00")).expect("an arc");
    assert!(arc.contains(" 0 1 1 "), "{arc}");
    for listed in
        ["gravity at (0, 0, 0) m", "force (0.00, -19.62, 0.00) N", "torque (0.000, 0.000, 9.810) N·m"]
    {
        assert!(svg.contains(listed), "{listed}: {svg}");
    }
    // Seen along y, the torque lies in the picture: an arrow with two heads, and no arc.
    let aside = free_body(&rod.loads(&q, &v, &[9.81].into()), Side::Xz);
    assert!(!aside.contains(" A ") && arrow_vectors(&aside, "#d55e00").len() == 1);
    assert_eq!(svg.matches("<line").count() - 3, aside.matches("<line").count() - 2);
}

#[test]
fn infinite_actions_are_listed_only() {
    let mut loads = PinnedRod {}.loads(&[0.0].into(), &[0.0].into(), &[1.0].into());
    loads.actions[1].force[0] = f64::NAN;
    let svg = free_body(&loads, Side::Isometric);
    assert!(svg.contains("(NaN, ") && !svg.contains("\"NaN"));
}
