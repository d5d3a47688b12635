//! Free-body diagrams as SVG: the body, the points of application, and forces and torques as arrows, with a
//! list of their values.

use crate::figure::to_double;
use crate::text::html as escaped;
use linkwork::Real;
use linkwork::free_body::{Action, Diagram, Origin};
use linkwork::nalgebra::SVector;
use std::fmt::Write;

/// Widths of the drawing, and of the list of forces next to it, in a free-body diagram, pixels.
const DRAWING: f64 = 480.0;
const LIST: f64 = 420.0;
/// Height of the free-body diagram, pixels.
const HEIGHT: f64 = 480.0;
/// Maximum length of an arrow, and maximum distance of a point from the centre of mass, in a free-body
/// diagram, pixels.
const LONGEST: f64 = 110.0;
const REACH: f64 = 105.0;
/// Radius of the arcs that represent torques in a free-body diagram, pixels.
const ARC: f64 = 26.0;
/// Length below which an arrow is omitted from a free-body diagram, pixels.
const SHORTEST: f64 = 1.5;
/// Height of a line in the list of forces next to a free-body diagram, pixels.
const LINE: f64 = 19.0;
/// Fraction of the largest torque below which a torque counts as zero and is not drawn.
const ZERO: f64 = 1e-9;

/// Viewing direction of a free-body diagram, in the axes of the diagram.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// View along −z: x to the right, y upward.
    #[default]
    Xy,
    /// View with x to the right and z upward.
    Xz,
    /// View with y to the right and z upward.
    Yz,
    /// Isometric view: z upward, x and y towards the viewer, with equal foreshortening of all axes.
    Isometric,
}

impl Side {
    /// Returns the unit vectors of the view to the right, upward and towards the viewer, in the axes of the
    /// diagram.
    fn view_axes(self) -> [[f64; 3]; 3] {
        let third = 1.0 / 3.0_f64.sqrt();
        let (a, b, c) = (0.5_f64.sqrt(), 1.0 / 6.0_f64.sqrt(), (2.0 / 3.0_f64).sqrt());
        match self {
            Side::Xy => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Side::Xz => [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
            Side::Yz => [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
            Side::Isometric => [[-a, a, 0.0], [-b, -b, c], [third, third, third]],
        }
    }

    /// Returns the components of a vector along the view's directions to the right, upward and towards the
    /// viewer.
    fn view_components(self, v: [f64; 3]) -> [f64; 3] {
        self.view_axes().map(|axis| axis.iter().zip(v).map(|(a, b)| a * b).sum())
    }
}

/// Draws a free-body diagram as SVG.
///
/// The body is represented by lines from its centre of mass to the points at which actions are applied.
/// Forces are arrows with a common scale that begin at their points. The component of a torque perpendicular
/// to the picture is an arc with an arrow, counterclockwise if it points towards the viewer. The components
/// in the picture are an arrow with two heads. The list next to the drawing contains the values of all
/// actions in the axes of the diagram, and their sum. Values that are not finite are listed but not drawn.
///
/// ```
/// use linkwork::prelude::*;
/// use linkwork_view::{Side, free_body};
///
/// /// A rod on a pin.
/// #[mechanism(gravity = -9.81 * y)]
/// struct Pendulum {
///     #[body(mass = 2, com = -0.5 * y, inertia = rod(2, 1, y))]
///     rod: Body,
///     #[joint(ground -> rod, about = z)]
///     hinge: Pin,
///     #[output(rod)]
///     loads: FreeBody,
/// }
///
/// let svg = free_body(&Pendulum {}.loads(&[0.5].into(), &[1.0].into()), Side::Xy);
/// assert!(svg.starts_with("<svg") && svg.contains("gravity") && svg.contains("hinge"));
/// ```
#[must_use]
pub fn free_body<T: Real, const N: usize>(diagram: &Diagram<T, N>, side: Side) -> String {
    let all: Vec<ShownAction> = diagram.actions.iter().map(|action| ShownAction::new(action, side)).collect();
    let height = HEIGHT.max(LINE * (3.0 * all.len() as f64 + 5.0) + 30.0);
    let width = DRAWING + LIST;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 \
         {width} {height}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<title>Free-body diagram of {name}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n",
        name = escaped(diagram.body)
    );
    write_body_and_arrows(&mut out, &all, side);
    write_action_list(&mut out, diagram, &all);
    out.push_str("</svg>\n");
    out
}

/// Force and torque that are drawn, with their components along the axes of the picture.
struct ShownAction {
    name: &'static str,
    colour: &'static str,
    point: [f64; 3],
    force: [f64; 3],
    torque: [f64; 3],
    figures: [[f64; 3]; 3],
}

impl ShownAction {
    fn new<T: Real>(action: &Action<T>, side: Side) -> ShownAction {
        let figures = [action.point, action.force, action.torque].map(vector_as_f64_array);
        let [point, force, torque] = figures.map(|v| side.view_components(v));
        let colour = match action.origin {
            Origin::Gravity => "#5a5a5a",
            Origin::Element => "#008c64",
            Origin::Input => "#d55e00",
            Origin::Joint => "#005aa0",
            Origin::Constraint => "#aa3c82",
            Origin::Contact => "#8c6400",
        };
        ShownAction { name: action.name, colour, point, force, torque, figures }
    }

    fn is_finite(&self) -> bool {
        self.figures.iter().flatten().all(|x| x.is_finite())
    }
}

fn vector_as_f64_array<T: Real>(v: SVector<T, 3>) -> [f64; 3] {
    [v[0], v[1], v[2]].map(to_double)
}

fn length_of_vector(x: f64, y: f64) -> f64 {
    x.hypot(y)
}

/// Returns the factor by which the maximum of `sizes` becomes `to`.
fn scale_factor_to_maximum(sizes: impl Iterator<Item = f64>, to: f64) -> f64 {
    let largest = sizes.fold(0.0_f64, f64::max);
    if largest > 0.0 { to / largest } else { 0.0 }
}

fn write_body_and_arrows(out: &mut String, all: &[ShownAction], side: Side) {
    let all: Vec<&ShownAction> = all.iter().filter(|shown| shown.is_finite()).collect();
    let places = scale_factor_to_maximum(all.iter().map(|s| length_of_vector(s.point[0], s.point[1])), REACH);
    let vector_norm = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let forces = scale_factor_to_maximum(all.iter().map(|s| vector_norm(s.force)), LONGEST);
    let torques = scale_factor_to_maximum(all.iter().map(|s| vector_norm(s.torque)), LONGEST / 2.0);
    let largest = all.iter().map(|s| vector_norm(s.torque)).fold(0.0, f64::max);
    let project_to_page = |v: [f64; 3]| (DRAWING / 2.0 + places * v[0], HEIGHT / 2.0 - places * v[1]);
    let center = project_to_page([0.0; 3]);
    for shown in &all {
        let (x, y) = project_to_page(shown.point);
        let _ = writeln!(
            out,
            "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{x:.2}\" y2=\"{y:.2}\" stroke=\"#ccc\" stroke-width=\"7\" \
             stroke-linecap=\"round\"/>",
            center.0, center.1
        );
    }
    let _ = writeln!(
        out,
        "<circle cx=\"{0:.2}\" cy=\"{1:.2}\" r=\"6\" fill=\"white\" stroke=\"black\"/>\n\
         <path d=\"M {0:.2} {1:.2} h 6 a 6 6 0 0 0 -6 -6 z m 0 0 h -6 a 6 6 0 0 0 6 6 z\"/>",
        center.0, center.1
    );
    write_axes(out, side);
    for shown in all {
        let (x, y) = project_to_page(shown.point);
        let [right, up, _] = shown.force.map(|c| c * forces);
        draw_arrow(out, (x, y), (right, -up), shown.colour, 1);
        let away = if up < 0.0 { 16.0 } else { -8.0 };
        let drawn = length_of_vector(right, up) > SHORTEST;
        // Outside the arc of a torque.
        let label = if drawn { (x + right, y - up + away) } else { (x + ARC, y - ARC - 8.0) };
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{}\" text-anchor=\"middle\">{}</text>",
            label.0,
            label.1,
            shown.colour,
            escaped(shown.name)
        );
        if vector_norm(shown.torque) <= ZERO * largest {
            continue;
        }
        let [right, up, across] = shown.torque;
        if across.abs() > 1e-6 * vector_norm(shown.torque) {
            draw_rotation_arrow(out, (x, y), across > 0.0, shown.colour);
        }
        draw_arrow(out, (x, y), (right * torques, -up * torques), shown.colour, 2);
    }
}

/// Draws the axes of the diagram in a corner.
fn write_axes(out: &mut String, side: Side) {
    let origin = (46.0, HEIGHT - 46.0);
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut axis = [0.0; 3];
        axis[k] = 30.0;
        let [right, up, _] = side.view_components(axis);
        if length_of_vector(right, up) < SHORTEST {
            continue;
        }
        draw_arrow(out, origin, (right, -up), "#999", 1);
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"#999\" text-anchor=\"middle\">{name}</text>",
            origin.0 + 1.4 * right,
            origin.1 - 1.4 * up + 4.0
        );
    }
}

/// Draws an arrow with this number of heads, unless it is too short.
fn draw_arrow(out: &mut String, (x, y): (f64, f64), (dx, dy): (f64, f64), colour: &str, heads: usize) {
    let long = length_of_vector(dx, dy);
    if long <= SHORTEST {
        return;
    }
    let (ux, uy) = (dx / long, dy / long);
    let head = 9.0_f64.min(0.6 * long);
    let _ = writeln!(
        out,
        "<line x1=\"{x:.2}\" y1=\"{y:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" stroke=\"{colour}\" \
         stroke-width=\"2\"/>",
        x + dx - ux * head,
        y + dy - uy * head
    );
    for k in 0..heads {
        let back = 0.8 * head * k as f64;
        let (tip_x, tip_y) = (x + dx - ux * back, y + dy - uy * back);
        let base = (tip_x - ux * head, tip_y - uy * head);
        let side = 0.4 * head;
        let _ = writeln!(
            out,
            "<path d=\"M {tip_x:.2} {tip_y:.2} L {:.2} {:.2} L {:.2} {:.2} z\" fill=\"{colour}\"/>",
            base.0 - uy * side,
            base.1 + ux * side,
            base.0 + uy * side,
            base.1 - ux * side
        );
    }
}

/// Draws three quarters of a circle about a point, with an arrow.
fn draw_rotation_arrow(out: &mut String, (x, y): (f64, f64), counterclockwise: bool, colour: &str) {
    // Counterclockwise from the right through the top; otherwise the mirror image.
    let sign = if counterclockwise { 1.0 } else { -1.0 };
    let sweep = u8::from(!counterclockwise);
    let _ = writeln!(
        out,
        "<path d=\"M {:.2} {y:.2} A {ARC} {ARC} 0 1 {sweep} {x:.2} {:.2}\" fill=\"none\" stroke=\"{colour}\" \
         stroke-width=\"2\"/>",
        x + sign * ARC,
        y + ARC
    );
    let tip = (x + sign * 8.0, y + ARC);
    let _ = writeln!(
        out,
        "<path d=\"M {:.2} {:.2} l {:.2} -5 v 10 z\" fill=\"{colour}\"/>",
        tip.0,
        tip.1,
        -sign * 9.0
    );
}

/// Writes the values of all actions and their sum as a list next to the diagram.
fn write_action_list<T: Real, const N: usize>(
    out: &mut String,
    diagram: &Diagram<T, N>,
    all: &[ShownAction],
) {
    let x = DRAWING + 10.0;
    let mut y = 26.0;
    let mut write_text_line = |out: &mut String, colour: &str, weight: &str, words: &str| {
        let words = escaped(words);
        let _ = writeln!(
            out,
            "<text x=\"{x}\" y=\"{y}\" fill=\"{colour}\" font-weight=\"{weight}\">{words}</text>"
        );
        y += LINE;
    };
    write_text_line(out, "#000", "bold", &format!("{}: points from the centre of mass", diagram.body));
    for shown in all {
        let [point, force, torque] = shown.figures;
        write_text_line(
            out,
            shown.colour,
            "bold",
            &format!("{} at {} m", shown.name, format_components(point)),
        );
        write_text_line(out, shown.colour, "normal", &format!("force {} N", format_components(force)));
        write_text_line(out, shown.colour, "normal", &format!("torque {} N·m", format_components(torque)));
    }
    let (force, torque) = (vector_as_f64_array(diagram.force()), vector_as_f64_array(diagram.torque()));
    write_text_line(out, "#000", "bold", "sum, m a and the rate of the angular momentum");
    write_text_line(out, "#000", "normal", &format!("force {} N", format_components(force)));
    write_text_line(out, "#000", "normal", &format!("torque {} N·m", format_components(torque)));
}

/// Formats the three components of a vector, with the number of decimals that gives the largest component
/// four significant digits.
fn format_components(v: [f64; 3]) -> String {
    let largest = v.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    let decimals = if largest > 0.0 && largest.is_finite() {
        (3.0 - largest.log10().floor()).clamp(0.0, 9.0) as usize
    } else {
        0
    };
    // Values that are rounded to zero are printed without their sign.
    let half = 0.5 * 10.0_f64.powi(-(decimals as i32));
    let parts = v.map(|x| format!("{:.decimals$}", if x.abs() < half { 0.0 } else { x }));
    format!("({})", parts.join(", "))
}
