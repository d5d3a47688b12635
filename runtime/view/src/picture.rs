//! Still pictures of a drawing as SVG, for readers without scripts.

use crate::figure::{DrawnShape, Figure};
use crate::scene::CameraView;
use linkwork::drawing::{Kind, Role};
use linkwork::nalgebra::{IsometryMatrix3, Matrix3, Point3, Vector3};
use std::f64::consts::TAU;
use std::fmt::Write;

/// Width and height of the still picture, pixels.
const SIZE: [f64; 2] = [640.0, 420.0];
/// Margin around the drawing in the still picture, pixels.
const MARGIN: f64 = 24.0;
/// Number of points by which a circle is drawn.
const ROUND: usize = 28;
/// Maximum number of corners of a mesh whose outline is drawn.
const CORNERS: usize = 2000;
/// Colours of bodies in the still picture, the same as in moving pages.
const COLOURS: [&str; 8] =
    ["#407ac9", "#de803d", "#54a173", "#a16ebd", "#cc616e", "#4da1b3", "#b59c47", "#80859e"];

/// Outline of a shape in the still picture, in picture coordinates.
struct SolidOutline {
    points: Vec<[f64; 2]>,
    /// Distance of the shape towards the viewer, by which outlines are sorted before they are drawn.
    depth: f64,
    colour: &'static str,
    /// Width of the outline if it is a line without area, m; zero for areas.
    line: f64,
}

/// Returns a still picture of the drawing as SVG, with its frames at these placements.
pub(crate) fn figure_svg(figure: &Figure, placements: &[IsometryMatrix3<f64>], scene: &CameraView) -> String {
    let [right, up, back] = scene.view_axes();
    let mut bodies: Vec<String> = Vec::new();
    let mut outlines: Vec<SolidOutline> = Vec::new();
    for shape in figure.drawn_shapes() {
        let place_in_world = |frame: Option<usize>, p: Vector3<f64>| {
            frame.map_or(p, |k| (placements[k] * Point3::from(p)).coords)
        };
        let (points, line) = shape_outline_points(shape, scene.size);
        let seen: Vec<Vector3<f64>> = points.into_iter().map(|(frame, p)| place_in_world(frame, p)).collect();
        let flat: Vec<[f64; 2]> = seen.iter().map(|p| [p.dot(&right), p.dot(&up)]).collect();
        let points = if line > 0.0 { flat } else { convex_hull(flat) };
        if points.len() < 2 {
            continue;
        }
        let depth = seen.iter().map(|p| p.dot(&back)).sum::<f64>() / seen.len() as f64;
        outlines.push(SolidOutline { points, depth, colour: colour_of_shape(shape, &mut bodies), line });
    }
    outlines.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    outlines_svg(&outlines)
}

/// Returns the colour in which a shape is drawn. All shapes of one body have the same colour.
fn colour_of_shape(shape: &DrawnShape, bodies: &mut Vec<String>) -> &'static str {
    match shape.role {
        Role::Link => "#8f99a8",
        Role::Joint => "#454d59",
        Role::Surface => "#5c8cc7",
        Role::Element => "#339e75",
        Role::Input => "#e35133",
        _ => {
            let body = match shape.role {
                Role::Visual => format!("{:?}", shape.frames[0]),
                _ => shape.name.clone(),
            };
            let known = bodies.iter().position(|known| *known == body);
            let k = known.unwrap_or_else(|| {
                bodies.push(body);
                bodies.len() - 1
            });
            COLOURS[k % COLOURS.len()]
        }
    }
}

/// Returns the outlines as an SVG picture, in which later outlines cover earlier ones.
fn outlines_svg(outlines: &[SolidOutline]) -> String {
    let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for point in outlines.iter().flat_map(|outline| &outline.points) {
        for k in 0..2 {
            low[k] = low[k].min(point[k]);
            high[k] = high[k].max(point[k]);
        }
    }
    let [width, height] = SIZE;
    let scale = (0..2).map(|k| (SIZE[k] - 2.0 * MARGIN) / (high[k] - low[k]).max(1e-9));
    let scale = scale.fold(f64::INFINITY, f64::min);
    let pixel_coordinates_text = |p: &[f64; 2]| {
        let x = width / 2.0 + scale * (p[0] - (low[0] + high[0]) / 2.0);
        let y = height / 2.0 - scale * (p[1] - (low[1] + high[1]) / 2.0);
        format!("{x:.1},{y:.1}")
    };
    let mut out = format!("<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"drawing\">");
    for SolidOutline { points, colour, line, .. } in outlines {
        let points = points.iter().map(pixel_coordinates_text).collect::<Vec<_>>().join(" ");
        let _ = match *line > 0.0 {
            true => write!(
                out,
                "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" \
                 stroke-width=\"{:.1}\" stroke-linecap=\"round\"/>",
                (scale * line).max(2.0)
            ),
            false => write!(
                out,
                "<polygon points=\"{points}\" fill=\"{colour}\" \
                 stroke=\"#00000055\" stroke-linejoin=\"round\"/>"
            ),
        };
    }
    out.push_str("</svg>");
    out
}

/// Point, with the frame in whose axes it is given; `None` for the ground.
type FramePoint = (Option<usize>, Vector3<f64>);

/// Returns points whose convex hull is the outline of the shape, each with its frame, or the ends of a line
/// and its width. `size` is the size of the mechanism.
fn shape_outline_points(shape: &DrawnShape, size: f64) -> (Vec<FramePoint>, f64) {
    let n = &shape.numbers;
    let vector_from_entry = |k: usize| Vector3::new(n[k], n[k + 1], n[k + 2]);
    let [a, b] = shape.frames;
    let attach_frame_to_points =
        |points: Vec<Vector3<f64>>| points.into_iter().map(|p| (a, p)).collect::<Vec<_>>();
    let points_of_round_solid = |half: f64, radius: f64| {
        let (axis, at) = (vector_from_entry(3), vector_from_entry(0));
        attach_frame_to_points(
            [-half, half].iter().flat_map(|h| points_on_circle(at + axis * *h, axis, radius)).collect(),
        )
    };
    let points_of_scaled_corners = |corners: &[[f64; 3]]| {
        let axes = Matrix3::from_row_slice(&n[3..12]);
        attach_frame_to_points(
            corners
                .iter()
                .map(|c| {
                    vector_from_entry(0) + axes * Vector3::from(*c).component_mul(&vector_from_entry(12))
                })
                .collect(),
        )
    };
    let points_of_ball = |radius: f64| {
        attach_frame_to_points(
            points_on_sphere().iter().map(|c| vector_from_entry(0) + Vector3::from(*c) * radius).collect(),
        )
    };
    let areas = match shape.kind {
        Kind::Bar => return (vec![(a, vector_from_entry(0)), (b, vector_from_entry(3))], 0.018 * size),
        Kind::Coil | Kind::Damper => {
            return (vec![(a, vector_from_entry(0)), (b, vector_from_entry(3))], 0.03 * size);
        }
        Kind::Rod => points_of_round_solid(n[6] / 2.0, (0.018 * n[6]).max(0.006 * size)),
        Kind::Ring | Kind::Disk => points_of_round_solid(0.04 * n[6], n[6]),
        Kind::Torus => points_of_round_solid(n[7], n[6] + n[7]),
        Kind::Cylinder => points_of_round_solid(n[7] / 2.0, n[6]),
        Kind::Capsule => points_of_round_solid(n[7] / 2.0 + n[6] / 2.0, n[6]),
        Kind::Tube => points_of_round_solid(n[8] / 2.0, n[7]),
        Kind::Cone => {
            let mut points = attach_frame_to_points(points_on_circle(
                vector_from_entry(0) - vector_from_entry(3) * (n[7] / 4.0),
                vector_from_entry(3),
                n[6],
            ));
            points.push((a, vector_from_entry(0) + vector_from_entry(3) * (0.75 * n[7])));
            points
        }
        Kind::Sphere => points_of_ball(n[3]),
        Kind::Cuboid => points_of_scaled_corners(&corners_of_cube()),
        Kind::Ellipsoid => points_of_scaled_corners(&points_on_sphere()),
        Kind::Mesh(_) => {
            let corners = shape.mesh.as_ref().map(|mesh| mesh.sampled_corners(CORNERS)).unwrap_or_default();
            points_of_scaled_corners(&corners)
        }
        Kind::Point => points_of_ball(0.028 * size),
        Kind::Ball => points_of_ball(0.03 * size),
        Kind::Hinge | Kind::Slide => points_of_round_solid(0.0425 * size, 0.02 * size),
        _ => Vec::new(),
    };
    (areas, 0.0)
}

/// Returns equally spaced points on a circle about an axis.
fn points_on_circle(at: Vector3<f64>, axis: Vector3<f64>, radius: f64) -> Vec<Vector3<f64>> {
    let helper = if axis.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let x = helper.cross(&axis).normalize();
    let y = axis.cross(&x);
    let point_on_circle = |k: usize| {
        let (sine, cosine) = (TAU * k as f64 / ROUND as f64).sin_cos();
        at + (x * cosine + y * sine) * radius
    };
    (0..ROUND).map(point_on_circle).collect()
}

/// Returns points on the unit sphere, from which its outline is computed.
fn points_on_sphere() -> Vec<[f64; 3]> {
    let latitude_circle_points = |j: usize| {
        let (height, radius) = (std::f64::consts::PI * (j as f64 / 8.0 - 0.5)).sin_cos();
        points_on_circle(Vector3::z() * height, Vector3::z(), radius)
    };
    (0..=8).flat_map(latitude_circle_points).map(Into::into).collect()
}

/// Returns the corners of the cube with edges of length one about the origin.
fn corners_of_cube() -> Vec<[f64; 3]> {
    (0..8).map(|k| [0, 1, 2].map(|i| if k >> i & 1 == 0 { -0.5 } else { 0.5 })).collect()
}

/// Returns the convex hull of points in the plane, counter-clockwise (Andrew's monotone chain).
fn convex_hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut out: Vec<[f64; 2]> = Vec::new();
    let rising: Vec<[f64; 2]> = points.clone();
    for pass in [rising, points.into_iter().rev().collect()] {
        let start = out.len();
        for p in pass {
            while out.len() >= start + 2 {
                let [a, b] = [out[out.len() - 2], out[out.len() - 1]];
                if (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0.0 {
                    break;
                }
                out.pop();
            }
            out.push(p);
        }
        out.pop();
    }
    out
}

#[cfg(test)]
mod tests {
    use super::convex_hull;

    #[test]
    fn hull_of_square_has_its_corners() {
        let mut square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let inner = [[0.5, 0.5], [0.5, 0.0], [0.2, 0.9]];
        assert_eq!(convex_hull([&square[..], &inner].concat()), square);
        square.truncate(2);
        assert_eq!(convex_hull(square.clone()), square);
    }
}
