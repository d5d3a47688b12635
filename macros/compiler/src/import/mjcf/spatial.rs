//! `<spatial>`: the path of a cable between sites, around spheres and cylinders → an expression of its
//! length.
//!
//! The path is MuJoCo's (*Modeling*, "spatial"): that of a taut cable. Around a cylinder with a `sidesite`,
//! the cable has the direction of rotation of the path through that site in the configuration of the file, as
//! in MuJoCo 4.0.

use super::defaults::ElementWithDefaults;
use super::geometry::shape_pose_and_dimensions;
use super::reader::MjcfReader;
use crate::diag::Place;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, child_elements, element_source_position, quoted_tag, read_name_attribute, read_number_attribute,
    report_missing_or_misspelt_attributes,
};
use crate::import::pose::{
    NumericPose, Vector, cross, dot, matrix_times_vector, vector_norm, vector_sum, vector_times_scalar,
};
use crate::syntax::{BinaryOp, Expr, ExprKind, Name};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Position and axes fixed in a body of an MJCF file.
#[derive(Clone)]
pub(super) struct BodyFrame {
    pub(super) body: String,
    pub(super) pose: NumericPose,
}

/// Path of a tendon around a surface.
#[derive(Clone, Copy, PartialEq)]
enum WrappingKind {
    /// Shortest path of a tendon around a sphere.
    Ball,
    /// Shortest path of a tendon around a cylinder.
    Shorter,
    /// Path around a cylinder with given direction of rotation about its axis: positive or negative from the
    /// first end to the second.
    Turning(f64),
}

/// Surface around which a segment of a tendon path is wrapped.
struct WrappedSurface {
    frame: BodyFrame,
    radius: f64,
    way: WrappingKind,
}

/// Segment of a tendon path between two sites.
struct PathSegment {
    ends: [BodyFrame; 2],
    around: Option<WrappedSurface>,
    /// Factor of the segment's length: the inverse of the divisor of a preceding pulley, or one.
    share: f64,
}

/// Error for an unsupported tendon path, reported only if something acts on the tendon.
#[derive(Clone)]
pub(super) struct ErrorTextWithHelp {
    pub(super) place: Place,
    pub(super) message: String,
}

/// Path of a spatial tendon: its segments.
pub(super) struct TendonPath {
    pieces: Vec<PathSegment>,
    place: Place,
}

/// Poses of bodies relative to the world, by name of the body.
pub(super) type BodyPoses = BTreeMap<String, NumericPose>;

impl<'a> MjcfReader<'a> {
    /// Reads the path of a tendon. The outer `None` means an error in the file, the inner `Err` an
    /// unsupported path.
    pub(super) fn read_tendon_path(
        &self,
        node: Node<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<Result<TendonPath, ErrorTextWithHelp>> {
        let (mut pieces, mut last, mut pending, mut share) = (Vec::new(), None::<BodyFrame>, None, 1.0);
        let mut refused = None;
        report_elements_without_length(node, cx)?;
        for child in child_elements(node) {
            match child.tag_name().name() {
                "site" => {
                    report_missing_or_misspelt_attributes(child, &["site"], &[], cx);
                    let next = self.find_site(&read_name_attribute(child, "site", cx)?, cx)?;
                    if let Some(first) = last.replace(next.clone()) {
                        pieces.push(PathSegment { ends: [first, next], around: pending.take(), share });
                    }
                }
                "geom" => {
                    report_missing_or_misspelt_attributes(child, &["geom"], &["sidesite"], cx);
                    if last.is_none() || pending.is_some() {
                        return report_surface_without_end_site(child, cx);
                    }
                    match self.surface_wrapped_by_path(child, cx)? {
                        Ok(around) => pending = Some(around),
                        Err(refusal) => refused = refused.or(Some(refusal)),
                    }
                }
                "pulley" => {
                    report_missing_or_misspelt_attributes(child, &["divisor"], &[], cx);
                    if pending.is_some() {
                        return report_surface_without_end_site(child, cx);
                    }
                    let divisor = read_number_attribute(child, "divisor", cx)?;
                    if divisor.value <= 0.0 {
                        let message = format!("a pulley with the divisor {}", divisor.value);
                        cx.report_error(&divisor.place, message, |d| {
                            d.add_help("expected a number above zero")
                        });
                        return None;
                    }
                    (share, last) = (1.0 / divisor.value, None);
                }
                _ => {
                    let message = format!("unknown element {}", quoted_tag(child));
                    let known = ["site", "geom", "pulley"];
                    cx.report_error(&element_source_position(child, cx), message, |d| {
                        d.suggest_name(child.tag_name().name(), known)
                    });
                    return None;
                }
            }
        }
        if pending.is_some() {
            return report_surface_without_end_site(node, cx);
        }
        let mut path = TendonPath { pieces, place: element_source_position(node, cx) };
        for piece in &mut path.pieces {
            refused = refused.or(self.choose_wrapping_side(piece, &path.place));
        }
        Some(refused.map_or(Ok(path), Err))
    }

    /// Finds a site of the MJCF file by its name, or reports that the name is unknown.
    pub(super) fn find_site(&self, site: &Name, cx: &mut Cx<'_>) -> Option<BodyFrame> {
        let found = self.poses_of_sites.get(&site.text);
        if found.is_none() {
            let known = self.poses_of_sites.keys().map(String::as_str);
            let message = format!("unknown site {}", quote_word(&site.text));
            cx.report_error(&site.place, message, |d| d.suggest_name(&site.text, known));
        }
        found.map(|(body, pose)| BodyFrame { body: body.clone(), pose: *pose })
    }

    /// Returns the surface that a segment of a path wraps around. For a cylinder with a `sidesite`,
    /// `Way::Turning` temporarily contains the polar angle of that site; `choose_side` replaces it by the
    /// direction.
    fn surface_wrapped_by_path(
        &self,
        node: Node<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<Result<WrappedSurface, ErrorTextWithHelp>> {
        let said = read_name_attribute(node, "geom", cx)?;
        let Some((body, shape, outer)) = self.named_shapes.get(&said.text) else {
            let known = self.named_shapes.keys().map(String::as_str);
            let message = format!("unknown geom {}", quote_word(&said.text));
            cx.report_error(&said.place, message, |d| d.suggest_name(&said.text, known));
            return None;
        };
        let kind = shape.trimmed_attribute_text("type").unwrap_or("sphere");
        if !["sphere", "cylinder"].contains(&kind) {
            let message = format!(
                "a tendon wraps around spheres and cylinders, but {} is neither",
                quote_word(&said.text)
            );
            cx.report_error(&said.place, message, |d| d);
            return None;
        }
        let (pose, [radius, ..]) = shape_pose_and_dimensions(kind, shape, &self.settings, cx)?;
        let frame = BodyFrame { body: body.clone(), pose: outer.compose_with(&pose) };
        let Some(side) =
            node.has_attribute("sidesite").then(|| read_name_attribute(node, "sidesite", cx)).flatten()
        else {
            let way = if kind == "sphere" { WrappingKind::Ball } else { WrappingKind::Shorter };
            return Some(Ok(WrappedSurface { frame, radius, way }));
        };
        let spot = self.find_site(&side, cx)?;
        let refusal_at_side_site =
            |message: String| Some(Err(ErrorTextWithHelp { place: side.place.clone(), message }));
        if kind == "sphere" {
            return refusal_at_side_site(format!(
                "the side on which a tendon passes the sphere {}",
                quote_word(&said.text)
            ));
        }
        let [x, y, z] = self.position_relative_to(&frame, &spot);
        if vector_norm([x, y, z]) < radius {
            return refusal_at_side_site(format!(
                "a tendon that runs inside of the cylinder {}",
                quote_word(&said.text)
            ));
        }
        // Polar angle of the side, until the ends of the segment are known.
        Some(Ok(WrappedSurface { frame, radius, way: WrappingKind::Turning(libm::atan2(y, x)) }))
    }

    /// Returns the position of a spot relative to a frame, in the configuration of the file.
    fn position_relative_to(&self, frame: &BodyFrame, spot: &BodyFrame) -> Vector {
        position_in_frame(&self.poses, frame, spot)
    }

    /// Determines the direction in which a segment passes a cylinder with a `sidesite`: the direction of
    /// rotation of the path through that site.
    fn choose_wrapping_side(&self, piece: &mut PathSegment, place: &Place) -> Option<ErrorTextWithHelp> {
        let Some(WrappedSurface { frame, radius, way: WrappingKind::Turning(side) }) = &mut piece.around
        else {
            return None;
        };
        let [a, b] = [&piece.ends[0], &piece.ends[1]].map(|end| self.position_relative_to(frame, end));
        let [far_a, far_b] = [a, b].map(|[x, y, _]| libm::hypot(x, y));
        if far_a < *radius || far_b < *radius {
            let message = "a tendon that begins inside of a cylinder in the pose of the file".to_string();
            return Some(ErrorTextWithHelp { place: place.clone(), message });
        }
        let polar_angle = |[x, y, _]: Vector| libm::atan2(y, x);
        let angle_within_half_turn = |angle: f64| libm::atan2(libm::sin(angle), libm::cos(angle));
        let winding =
            angle_within_half_turn(*side - polar_angle(a)) + angle_within_half_turn(polar_angle(b) - *side);
        *side = if winding >= 0.0 { 1.0 } else { -1.0 };
        None
    }

    /// Records the named shapes of a body, and shapes with an individual fluid model.
    pub(super) fn record_named_shapes(
        &mut self,
        body: &str,
        shapes: &[(ElementWithDefaults<'a>, NumericPose)],
        cx: &Cx<'_>,
    ) {
        for (shape, outer) in shapes {
            self.record_unsupported_fluid_shape(shape, cx);
            if let Some(name) = shape.node.attribute("name") {
                self.named_shapes.insert(name.to_string(), (body.to_string(), shape.clone(), *outer));
            }
        }
    }
}

/// Returns the position of a spot relative to a frame for given poses of the bodies.
fn position_in_frame(poses: &BodyPoses, frame: &BodyFrame, spot: &BodyFrame) -> Vector {
    let world_pose =
        |spot: &BodyFrame| poses.get(&spot.body).map_or(spot.pose, |body| body.compose_with(&spot.pose));
    world_pose(frame).inverse_pose().compose_with(&world_pose(spot)).at
}

/// Reports elements that add no length to a tendon path, as MuJoCo does: sites without a neighbour, pulleys
/// without a following site, and paths without elements.
fn report_elements_without_length(node: Node<'_>, cx: &mut Cx<'_>) -> Option<()> {
    let parts: Vec<Node<'_>> = child_elements(node).collect();
    let is_end_of_path = |part: Option<&Node<'_>>| part.is_none_or(|part| part.tag_name().name() == "pulley");
    let has_no_segment = |k: &usize| match parts[*k].tag_name().name() {
        "site" => {
            is_end_of_path(k.checked_sub(1).and_then(|k| parts.get(k))) && is_end_of_path(parts.get(k + 1))
        }
        "pulley" => is_end_of_path(parts.get(k + 1)),
        _ => false,
    };
    let found = (0..parts.len()).find(has_no_segment).map(|k| parts[k]);
    let Some(found) = found.or(parts.is_empty().then_some(node)) else { return Some(()) };
    let message = format!("{} adds nothing to the length of the tendon", quoted_tag(found));
    cx.report_error(&element_source_position(found, cx), message, |d| {
        d.add_help("a tendon and each part behind a pulley has two sites")
    });
    None
}

/// Reports a surface in a path that is not between two sites.
fn report_surface_without_end_site<T>(node: Node<'_>, cx: &mut Cx<'_>) -> Option<T> {
    cx.report_error(
        &element_source_position(node, cx),
        "a tendon runs around a shape between two sites",
        |d| d.add_help("write `<site/>`, `<geom/>`, `<site/>`"),
    );
    None
}

impl TendonPath {
    /// Returns the length of the tendon path for these poses of the bodies.
    pub(super) fn path_length(&self, poses: &BodyPoses) -> f64 {
        self.pieces.iter().map(|piece| piece.share * piece.segment_length(poses)).sum()
    }

    /// Returns the expression of the length of a tendon path.
    pub(super) fn path_length_expression(&self) -> Expr {
        let at = &self.place;
        let sum = self.pieces.iter().map(|piece| {
            let whole = piece.segment_length_expression(at);
            let share_factor_expression = || Expr::number_at(piece.share, at);
            if piece.share == 1.0 {
                whole
            } else {
                Expr::binary_operation(BinaryOp::Mul, share_factor_expression(), whole)
            }
        });
        sum.reduce(|a, b| Expr::binary_operation(BinaryOp::Add, a, b))
            .unwrap_or_else(|| Expr::number_at(0.0, at))
    }
}

impl PathSegment {
    fn segment_length(&self, poses: &BodyPoses) -> f64 {
        let [a, b] = [&self.ends[0], &self.ends[1]];
        match &self.around {
            None => vector_norm(position_in_frame(poses, a, b)),
            Some(around) => {
                around.taut_cable_length([a, b].map(|end| position_in_frame(poses, &around.frame, end)))
            }
        }
    }

    fn segment_length_expression(&self, at: &Place) -> Expr {
        let [a, b] = [&self.ends[0], &self.ends[1]].map(|end| end.position_expression_of_spot(at));
        let vector_between_ends = || Expr::binary_operation(BinaryOp::Div, a.clone(), b.clone());
        let Some(around) = &self.around else {
            return Expr::function_call_expression(
                "norm",
                vec![Expr::function_call_expression("r", vec![vector_between_ends()], at)],
                at,
            );
        };
        let cable_call = |word: &str, mut arguments: Vec<Expr>| {
            arguments.insert(0, Expr::number_at(around.radius, at));
            let surface = Expr::method_call(around.frame.position_expression_of_spot(at), word, arguments);
            Expr::function_call_expression("cable", vec![vector_between_ends(), surface], at)
        };
        let axis_vector =
            |sign: f64| Expr::vector_at(matrix_times_vector(&around.frame.pose.axes, [0.0, 0.0, sign]), at);
        match around.way {
            WrappingKind::Ball => cable_call("sphere", Vec::new()),
            WrappingKind::Turning(sign) => cable_call("cylinder", vec![axis_vector(sign)]),
            WrappingKind::Shorter => Expr::function_call_expression(
                "min",
                [1.0, -1.0].map(|sign| cable_call("cylinder", vec![axis_vector(sign)])).into(),
                at,
            ),
        }
    }
}

impl WrappedSurface {
    /// Returns the length of a taut cable between two points in the axes of this frame. The numeric
    /// counterpart of `Scope::cable`.
    fn taut_cable_length(&self, [a, b]: [Vector; 2]) -> f64 {
        let planar_components = |[x, y, _]: Vector| [x, y, 0.0];
        let wrapped_path_length = |a: Vector, b: Vector, angle: f64| {
            let tangents = [a, b].map(|p| (dot(p, p) - self.radius * self.radius).max(0.0).sqrt());
            let touched = tangents.iter().fold(angle, |angle, t| angle - libm::atan2(*t, self.radius));
            let straight = vector_norm(vector_sum(a, vector_times_scalar(b, -1.0)));
            if touched > 0.0 { tangents[0] + tangents[1] + self.radius * touched } else { straight }
        };
        let length_by_turning_direction = |sign: f64| {
            let angle =
                libm::atan2(-sign * cross(a, b)[2], -dot(planar_components(a), planar_components(b))) + PI;
            libm::hypot(wrapped_path_length(planar_components(a), planar_components(b), angle), a[2] - b[2])
        };
        match self.way {
            WrappingKind::Ball => wrapped_path_length(a, b, libm::atan2(vector_norm(cross(a, b)), dot(a, b))),
            WrappingKind::Turning(sign) => length_by_turning_direction(sign),
            WrappingKind::Shorter => length_by_turning_direction(1.0).min(length_by_turning_direction(-1.0)),
        }
    }
}

impl BodyFrame {
    /// Returns the expression `body.at(vector)`.
    pub(super) fn position_expression_of_spot(&self, at: &Place) -> Expr {
        let body = Expr { kind: ExprKind::Name(self.body.clone()), place: at.clone() };
        if self.pose.at == [0.0; 3] {
            return body;
        }
        Expr::method_call(body, "at", vec![Expr::vector_at(self.pose.at, at)])
    }
}
