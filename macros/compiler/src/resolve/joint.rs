//! Elementary motions of joints. A joint with several degrees of freedom is a chain of simple joints with
//! massless links between them.

use super::elementary::ElementaryMotion;
use super::scope::Scope;
use crate::diag::{Diagnostics, Place};
use crate::expr::eval::eval_one;
use crate::expr::sample::{always_equals_number, sample_of_symbol};
use crate::expr::{Expr, Graph, Vec3};
use crate::kinematics::directions_in_plane;
use crate::language::elements::{DrawnAxis, JointTypeCoordinates};
use crate::mechanism::{Chart, Coordinate, InQ, InV, PieceShape};
use crate::syntax::{self, Joint, JointKind};

/// Returns the coordinate charts of a joint whose entries begin at `q` and `v`: one for each plain
/// coordinate, or one for the whole of a ball or free joint.
pub fn charts_of_joint(kind: JointKind, (q, v): (InQ, InV), along: usize) -> Vec<Chart> {
    match kind.row().coordinates {
        JointTypeCoordinates::Ball => vec![Chart::Ball(q, v)],
        JointTypeCoordinates::Free => vec![Chart::Free(q, v)],
        JointTypeCoordinates::Plain(_) | JointTypeCoordinates::PerAxis(_) => {
            (0..kind.configuration_and_velocity_names(along).1.len())
                .map(|k| Chart::Plain(q + k, v + k))
                .collect()
        }
    }
}

/// Returns the symbol of a joint in the drawing, if it has one, and its axes, the first of which is drawn.
pub fn joint_drawing_symbol(joint: &Joint) -> Option<(PieceShape, Option<&[syntax::Expr]>)> {
    let (kind, axis) = joint.kind.row().piece.clone()?;
    let axes = axis.map(|axis| match axis {
        DrawnAxis::About => joint.about.as_slice(),
        DrawnAxis::Along => joint.along.as_slice(),
    });
    Some((kind, axes))
}

/// Returns the full name of a coordinate, `joint.coordinate`.
pub fn full_name(joint: &str, coordinate: &str) -> String {
    if coordinate.is_empty() { joint.to_string() } else { format!("{joint}.{coordinate}") }
}

impl<'g> Scope<'_, 'g> {
    /// Returns the motions of a joint in order from parent to child.
    pub fn motions_of_joint(&self, joint: &Joint, cx: &mut Diagnostics) -> Option<Vec<ElementaryMotion<'g>>> {
        use ElementaryMotion::{Slide, Turn};
        let about = self.resolve_joint_axes(joint, &joint.about, cx);
        let along = self.resolve_joint_axes(joint, &joint.along, cx);
        let (about, along) = (about?, along?);
        let place = &joint.name.place;
        match joint.kind {
            JointKind::Pin => Some(vec![Turn(single_axis(&about, "about", "a Pin", place, cx)?)]),
            JointKind::Sleeve => Some(vec![Slide(single_axis(&along, "along", "a Sleeve", place, cx)?)]),
            JointKind::Screw => self.screw_motions(joint, &about, &along, cx),
            JointKind::Collar => {
                let axis = axis_of_rotation_and_translation(&about, &along, "a Collar", place, cx)?;
                Some(vec![Slide(axis), Turn(axis)])
            }
            JointKind::Slot => {
                let slide = single_axis(&along, "along", "a Slot", place, cx);
                let turn = single_axis(&about, "about", "a Slot", place, cx);
                Some(vec![Slide(slide?), Turn(turn?)])
            }
            JointKind::Universal => {
                let axes = check_axis_count(&about, 2..=2, "about", "a Universal", place, cx)?;
                check_independent_axes(axes, "a Universal", joint.about.get(1), cx)?;
                Some(axes.iter().map(|a| Turn(*a)).collect())
            }
            JointKind::Planar => self.planar_motions(&about, &along, place, cx),
            JointKind::Stage => {
                let axes = check_axis_count(&along, 2..=3, "along", "a Stage", place, cx)?;
                check_independent_axes(axes, "a Stage", joint.along.last(), cx)?;
                Some(axes.iter().map(|a| Slide(*a)).collect())
            }
            JointKind::Ball => Some(vec![ElementaryMotion::Ball]),
            JointKind::Free => Some(vec![ElementaryMotion::Free]),
            JointKind::Weld => Some(Vec::new()),
        }
    }

    fn resolve_joint_axes(
        &self,
        joint: &Joint,
        axes: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Vec<Vec3<'g>>> {
        let found: Vec<_> =
            axes.iter().map(|a| self.resolve_unit_vector(a, joint.normalise_axis, cx)).collect();
        found.into_iter().collect()
    }

    fn screw_motions(
        &self,
        joint: &Joint,
        about: &[Vec3<'g>],
        along: &[Vec3<'g>],
        cx: &mut Diagnostics,
    ) -> Option<Vec<ElementaryMotion<'g>>> {
        let axis = axis_of_rotation_and_translation(about, along, "a Screw", &joint.name.place, cx);
        let pitch = match (&joint.pitch, &joint.lead) {
            (Some(pitch), None) => self.resolve_scalar(pitch, cx),
            (None, Some(lead)) => self.resolve_scalar(lead, cx).map(|l| l * (0.5 / std::f64::consts::PI)),
            _ => {
                let and = if joint.pitch.is_some() { ", not both" } else { "" };
                cx.report_error(joint.name.place.clone(), format!("a Screw has a `pitch` or a `lead`{and}"))
                    .add_help("`pitch` is the advance per radian, `lead` the advance per turn");
                None
            }
        };
        Some(vec![ElementaryMotion::Helix(axis?, pitch?)])
    }

    /// Returns the motions of a planar joint: two translations in the plane, followed by a rotation about its
    /// normal.
    fn planar_motions(
        &self,
        about: &[Vec3<'g>],
        along: &[Vec3<'g>],
        place: &Place,
        cx: &mut Diagnostics,
    ) -> Option<Vec<ElementaryMotion<'g>>> {
        let (first, second) = match (about, along) {
            (_, [first, second]) => (*first, *second),
            ([normal], []) => match directions_in_plane(*normal) {
                Some(directions) => directions,
                None => {
                    cx.report_error(
                        place.clone(),
                        "a normal that depends on parameters does not determine the directions in the plane",
                    )
                    .add_help("write `along = (first, second)` instead of `about`");
                    return None;
                }
            },
            _ => {
                cx.report_error(place.clone(), "a Planar joint has a normal or two directions")
                    .add_help("write `about = z`, or `along = (x, y)`");
                return None;
            }
        };
        let normal = first.cross(second);
        if !is_always_zero(first.dot(second)) {
            cx.report_error(place.clone(), "the two directions of a Planar joint are not orthogonal");
            return None;
        }
        if let [given] = about
            && !(*given - normal).0.iter().all(|c| is_always_zero(*c))
        {
            cx.report_error(place.clone(), "`about` is not the normal of the two directions in `along`")
                .add_help("remove one of them");
            return None;
        }
        // The written normal is exact, the product is rounded.
        let normal = about.first().copied().unwrap_or(normal);
        Some(vec![
            ElementaryMotion::Slide(first),
            ElementaryMotion::Slide(second),
            ElementaryMotion::Turn(normal),
        ])
    }
}

/// Returns motions that replace those of a joint with an error.
pub fn placeholder_joint_motions<'g>(graph: &'g Graph, joint: &Joint) -> Vec<ElementaryMotion<'g>> {
    use ElementaryMotion::{Slide, Turn};
    let generic_placeholder_axis = |k: usize| {
        let mut n = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0];
        n.rotate_left(k);
        Vec3::vector_from_constants(graph, n)
    };
    match joint.kind {
        JointKind::Pin | JointKind::Screw => vec![Turn(generic_placeholder_axis(0))],
        JointKind::Sleeve => vec![Slide(generic_placeholder_axis(0))],
        JointKind::Collar | JointKind::Slot => {
            vec![Slide(generic_placeholder_axis(0)), Turn(generic_placeholder_axis(1))]
        }
        JointKind::Universal => vec![Turn(generic_placeholder_axis(0)), Turn(generic_placeholder_axis(1))],
        JointKind::Planar => vec![
            Slide(generic_placeholder_axis(0)),
            Slide(generic_placeholder_axis(1)),
            Turn(generic_placeholder_axis(2)),
        ],
        JointKind::Stage => {
            (0..joint.along.len().clamp(2, 3)).map(|k| Slide(generic_placeholder_axis(k))).collect()
        }
        JointKind::Ball => vec![ElementaryMotion::Ball],
        JointKind::Free => vec![ElementaryMotion::Free],
        JointKind::Weld => Vec::new(),
    }
}

/// Whether an expression is zero for all values of the parameters, within rounding.
fn is_always_zero(e: Expr<'_>) -> bool {
    (0..3).all(|seed| eval_one(e, &|s| sample_of_symbol(s, seed)).abs() <= 1e-9)
}

fn single_axis<'g>(
    axes: &[Vec3<'g>],
    key: &str,
    what: &str,
    place: &Place,
    cx: &mut Diagnostics,
) -> Option<Vec3<'g>> {
    check_axis_count(axes, 1..=1, key, what, place, cx).map(|axes| axes[0])
}

fn check_axis_count<'a, 'g>(
    axes: &'a [Vec3<'g>],
    count: std::ops::RangeInclusive<usize>,
    key: &str,
    what: &str,
    place: &Place,
    cx: &mut Diagnostics,
) -> Option<&'a [Vec3<'g>]> {
    if count.contains(&axes.len()) {
        return Some(axes);
    }
    let (number, example) = match (count.start(), count.end()) {
        (1, 1) => ("one axis", "z"),
        (2, 2) => ("two axes", "(x, y)"),
        _ => ("two or three axes", "(x, y)"),
    };
    let message = match axes.len() {
        0 => format!("missing `{key}`: {what} has {number}"),
        n => format!("{what} has {number} in `{key}`, found {n}"),
    };
    cx.report_error(place.clone(), message).add_help(format!("write `{key} = {example}`"));
    None
}

/// Reports two parallel axes or three coplanar ones, for which one of the coordinates would be redundant.
fn check_independent_axes(
    axes: &[Vec3<'_>],
    what: &str,
    last: Option<&syntax::Expr>,
    cx: &mut Diagnostics,
) -> Option<()> {
    let dependent = match axes {
        [a, b] => a.cross(*b).0.iter().all(|c| always_equals_number(*c, 0.0)),
        [a, b, c] => always_equals_number(a.cross(*b).dot(*c), 0.0),
        _ => false,
    };
    if let Some(last) = last.filter(|_| dependent) {
        cx.report_error(last.place.clone(), format!("the axes of {what} are not independent"))
            .add_help("the last one depends on the others; choose another direction");
        return None;
    }
    Some(())
}

fn axis_of_rotation_and_translation<'g>(
    about: &[Vec3<'g>],
    along: &[Vec3<'g>],
    what: &str,
    place: &Place,
    cx: &mut Diagnostics,
) -> Option<Vec3<'g>> {
    match (about, along) {
        ([axis], []) | ([], [axis]) => Some(*axis),
        ([a], [b]) if a == b => Some(*a),
        _ => {
            cx.report_error(place.clone(), format!("{what} has one axis")).add_help("write `about = z`");
            None
        }
    }
}

/// Returns the coordinate whose value is entry `q` of the configuration and whose rate is entry `v` of the
/// velocity, with ratio one and offset zero.
pub fn unscaled_coordinate(q: InQ, v: InV) -> Coordinate {
    Coordinate { q, v, ratio: 1.0, offset: 0.0 }
}
