//! Contact points of convex polytopes: hulls on hulls, boxes, capsules and unbounded cylinders. Pairs with a
//! cylinder that has end faces are represented in the same form, and their contacts are in [`super::curves`].
//!
//! The runtime selects the features that determine the contact: a face of one polytope with the points of the
//! other within its sides, or two edges, or the closest points. They are inputs of the expressions for gaps,
//! normals and contact points, which treat them as constants. The axis of a capsule is a line segment; an
//! unbounded cylinder is a capsule longer than the hull.
//!
//! A point of a face is a vertex of the opposite face, or the intersection of a line of one polytope with a
//! plane of the other: an edge with a side of the face, or the normal at a vertex of the face with the
//! opposite face. Contact points are midway between both surfaces. The smallest gap is the distance of the
//! surfaces, or the negative depth of their penetration. Unused contact points have gaps above any distance
//! of the surfaces.

use super::geometry::{PointContact, closest_positions_on_segments, norm_bounded_below, tangents_of};
use super::pair::SurfacePair;
use super::polytope_shapes::{box_polytope, hull_polytope, segment_polytope};
use super::surface::SurfaceForm;
use crate::expr::{Expr, Extreme, Vec3};
use crate::language::MAX_FACE_POINTS;
use crate::mechanism::{PAIR_FEATURES, POINT_FEATURES, Polytope, PolytopePair, Quantity};

/// Error for surfaces whose shapes depend on parameters.
const NOT_CONSTANT: &str = "points, lengths and axes of surfaces on a hull must be numbers";
/// Error for cylinders whose shapes depend on parameters.
const CYLINDER_NOT_CONSTANT: &str = "radius, length and axis of a cylinder on this surface must be numbers";
/// Error for polytopes whose faces are not a closed surface.
const NOT_CLOSED: &str = "rounding errors decide which points of this surface are in one plane";

/// Generic direction that decides between equal faces. Boxes placed on purpose rarely have equal components
/// along it.
const TIE_BREAK: [f64; 3] = [0.2113, 0.3779, 0.9014];

/// Squared sine of the angle below which edges are treated as parallel.
const PARALLEL: f64 = 1e-12;

/// Squared length below which a distance does not determine a direction, m², and squared sine of the angle
/// below which tangents of curves do not.
pub(super) const LEAST_SQUARE: f64 = 1e-30;

/// Axes and origin of a body in common axes, relative to the centre of the first surface.
#[derive(Clone, Copy)]
pub(super) struct PolytopeFrame<'g> {
    axes: [Vec3<'g>; 3],
    pub(super) origin: Vec3<'g>,
}

impl<'g> PolytopeFrame<'g> {
    pub(super) fn direction_in_common_axes(&self, v: Vec3<'g>) -> Vec3<'g> {
        self.axes[0] * v[0] + self.axes[1] * v[1] + self.axes[2] * v[2]
    }

    pub(super) fn position_in_common_axes(&self, v: Vec3<'g>) -> Vec3<'g> {
        self.origin + self.direction_in_common_axes(v)
    }

    /// Returns `first` if `which` is one, `second` if it is zero.
    pub(super) fn select_frame_by_indicator(which: Expr<'g>, first: &Self, second: &Self) -> Self {
        let select_vector_by_indicator = |a: Vec3<'g>, b: Vec3<'g>| b + (a - b) * which;
        PolytopeFrame {
            axes: std::array::from_fn(|k| select_vector_by_indicator(first.axes[k], second.axes[k])),
            origin: select_vector_by_indicator(first.origin, second.origin),
        }
    }
}

/// Selected features of a pair as expressions.
pub(super) struct PairFeatures<'g> {
    pub(super) values: Vec<Expr<'g>>,
}

impl<'g> PairFeatures<'g> {
    pub(super) fn vector_from_entry(&self, first: usize) -> Vec3<'g> {
        Vec3(std::array::from_fn(|k| self.values[first + k]))
    }
}

/// Polytope of a surface, with the radius of a capsule.
struct RoundedPolytope<'g> {
    polytope: Polytope,
    radius: Expr<'g>,
}

/// Placement of a pair, with its selected features.
pub(super) struct PlacedPair<'g> {
    pub(super) features: PairFeatures<'g>,
    pub(super) first: PolytopeFrame<'g>,
    pub(super) second: PolytopeFrame<'g>,
    /// Radii of both surfaces, zero for hulls and boxes.
    radii: [Expr<'g>; 2],
    /// Gap of unused contact points, above any distance of the surfaces.
    pub(super) unused: Expr<'g>,
}

impl<'g> SurfacePair<'_, 'g> {
    /// Whether the runtime selects features that determine the contact points.
    pub(super) fn features_are_selected_at_runtime(&self) -> bool {
        match (&self.a.form, &self.b.form) {
            (SurfaceForm::Sphere(_), _) => false,
            (_, SurfaceForm::Hull(_)) => true,
            (SurfaceForm::Cylinder(..) | SurfaceForm::Drum(..), SurfaceForm::Drum(..)) => true,
            _ => false,
        }
    }

    /// Returns a pair with a hull or a cylinder as polytopes, and its contact points. `first_feature` is the
    /// index of the first feature of the pair.
    ///
    /// # Errors
    ///
    /// A surface is no polytope of numbers, for the reason that is returned.
    pub(super) fn polytope_contacts(
        &self,
        first_feature: usize,
    ) -> Result<(PolytopePair<'g>, Vec<PointContact<'g>>), &'static str> {
        let g = self.expression_graph();
        let rotated_coordinate_axes = |rotate: &dyn Fn(Vec3<'g>) -> Vec3<'g>| {
            std::array::from_fn(|k| rotate(Vec3::coordinate_axis(g, k)))
        };
        let own_axes: [Vec3<'g>; 3] = rotated_coordinate_axes(&|v| self.direction_of_first_body(v).value);
        let other_axes: [Vec3<'g>; 3] = rotated_coordinate_axes(&|v| self.direction_of_second_body(v).value);
        let second = self.rounded_polytope(&self.b.form, 0.0)?;
        let mut first =
            self.rounded_polytope(&self.a.form, second.polytope.largest_distance_from_origin())?;
        if let (SurfaceForm::Cylinder(radius, _), true) = (&self.a.form, second.polytope.radius > 0.0) {
            first.polytope.radius = positive_constant_value(*radius)?;
        }
        let c = self.center.value - self.base.value;
        // Only the part of an unbounded cylinder next to the other body touches it.
        let shift = match &self.a.form {
            SurfaceForm::Cylinder(_, axis) => {
                let axis = self.direction_of_first_body(*axis).value;
                axis * -axis.dot(c)
            }
            _ => Vec3::zero(g),
        };
        let own = PolytopeFrame { axes: own_axes, origin: shift };
        let other = PolytopeFrame { axes: other_axes, origin: -c };
        let points = first.polytope.most_corners_per_face() + second.polytope.most_corners_per_face();
        let points = match first.polytope.faces.is_empty() {
            true => 2,
            false => points.min(MAX_FACE_POINTS),
        };
        let pose = relative_pose((&own, &first.polytope), (&other, &second.polytope));
        let reach = g.num(
            first.polytope.largest_distance_from_origin() + second.polytope.largest_distance_from_origin(),
        );
        let pair = PolytopePair { first: first.polytope, second: second.polytope, points, pose };
        let features = (0..pair.feature_count()).map(|k| Quantity::ContactFeature(first_feature + k).expr(g));
        let placed = PlacedPair {
            features: PairFeatures { values: features.collect() },
            first: own,
            second: other,
            radii: [first.radius, second.radius],
            unused: (c + shift).norm() + reach,
        };
        let contacts = if pair.has_cylinder() {
            placed.cylinder_pair_contacts()
        } else {
            placed.face_and_edge_contacts(points)
        };
        Ok((pair, contacts))
    }

    /// Returns the polytope of a surface. An unbounded cylinder extends beyond `reach` on both sides.
    ///
    /// # Errors
    ///
    /// [`NOT_CONSTANT`], [`CYLINDER_NOT_CONSTANT`] or [`NOT_CLOSED`].
    fn rounded_polytope(
        &self,
        form: &SurfaceForm<'g>,
        reach: f64,
    ) -> Result<RoundedPolytope<'g>, &'static str> {
        let zero = self.expression_graph().zero();
        let (polytope, radius) = match form {
            SurfaceForm::Hull(hull) => {
                let shape = hull.shape.as_ref().ok_or(NOT_CONSTANT)?;
                (hull_polytope(shape).ok_or(NOT_CLOSED)?, zero)
            }
            SurfaceForm::Cuboid(lengths) => {
                let [Some(a), Some(b), Some(c)] = lengths.map(|length| length.constant_value()) else {
                    return Err(NOT_CONSTANT);
                };
                (box_polytope([a, b, c]).ok_or(NOT_CLOSED)?, zero)
            }
            SurfaceForm::Capsule(radius, length, axis) => {
                let length = length.constant_value().ok_or(NOT_CONSTANT)?;
                (segment_polytope(axis.constant_components().ok_or(NOT_CONSTANT)?, length), *radius)
            }
            SurfaceForm::Cylinder(radius, axis) => {
                (segment_polytope(axis.constant_components().ok_or(NOT_CONSTANT)?, 4.0 * reach), *radius)
            }
            SurfaceForm::Drum(radius, length, axis) => {
                let axis = axis.constant_components().ok_or(CYLINDER_NOT_CONSTANT)?;
                let mut polytope = segment_polytope(axis, positive_constant_value(*length)?);
                polytope.radius = positive_constant_value(*radius)?;
                (polytope, zero)
            }
            _ => return Err(NOT_CONSTANT),
        };
        Ok(RoundedPolytope { polytope, radius })
    }
}

/// Returns a dimension of a cylinder, m.
///
/// # Errors
///
/// [`CYLINDER_NOT_CONSTANT`] if the dimension is not a positive number.
fn positive_constant_value(x: Expr<'_>) -> Result<f64, &'static str> {
    x.constant_value().filter(|x| *x > 0.0).ok_or(CYLINDER_NOT_CONSTANT)
}

/// Returns the pose of a pair, as in [`PolytopePair::pose`].
fn relative_pose<'g>(
    (own, first): (&PolytopeFrame<'g>, &Polytope),
    (other, second): (&PolytopeFrame<'g>, &Polytope),
) -> [Expr<'g>; 13] {
    let g = own.origin[0].graph();
    let offset = other.origin - own.origin;
    let centers = [(own, first), (other, second)]
        .map(|(frame, shape)| frame.position_in_common_axes(Vec3::vector_from_constants(g, shape.center())));
    let height = (centers[1] - centers[0]).dot(Vec3::vector_from_constants(g, TIE_BREAK));
    let rotation = other.axes.iter().flat_map(|axis| own.axes.map(|own| own.dot(*axis)));
    let position = own.axes.map(|axis| axis.dot(offset));
    let values: Vec<Expr<'g>> = rotation.chain(position).chain([height]).collect();
    std::array::from_fn(|k| values[k])
}

impl<'g> PlacedPair<'g> {
    /// Returns the contacts of the points on a face, followed by the contact of edges and closest points.
    fn face_and_edge_contacts(&self, points: usize) -> Vec<PointContact<'g>> {
        let (is_second, zero) = (self.features.values[0], self.unused.zero());
        let own = PolytopeFrame::select_frame_by_indicator(is_second, &self.second, &self.first);
        let other = PolytopeFrame::select_frame_by_indicator(is_second, &self.first, &self.second);
        let outward = own.direction_in_common_axes(self.features.vector_from_entry(2));
        // Normals point towards the first surface.
        let normal = outward * (is_second * 2.0 - zero.num(1.0));
        let (first, second) = tangents_of(normal);
        let axes = [("normal", normal), ("first", first), ("second", second)];
        let mut contacts: Vec<PointContact<'g>> = (0..points)
            .map(|k| {
                let values = &self.features.values[PAIR_FEATURES + POINT_FEATURES * k..];
                let place = point_of_face(values, &own, &other);
                let height = outward.dot(place - own.origin) - self.features.values[5];
                let [own_radius, other_radius] = self.radii;
                let gap = height - own_radius - other_radius;
                let gap = gap.minimum_or_maximum(Extreme::Max, self.features.values[1]);
                PointContact {
                    gap: self.unused + (gap - self.unused) * values[0],
                    point: place - outward * (height * 0.5) + normal * ((other_radius - own_radius) * 0.5),
                    axes,
                    conditions: Vec::new(),
                }
            })
            .collect();
        contacts.push(self.edge_contact(normal));
        contacts
    }

    /// Returns the contact of two edges that cross, or of the closest points. If a face determines the
    /// contact, `face_normal` is the normal.
    fn edge_contact(&self, face_normal: Vec3<'g>) -> PointContact<'g> {
        let (values, one) = (&self.features.values, self.unused.num(1.0));
        let (side, is_closest) = (values[6], values[7]);
        let is_crossing = side.square();
        let (start, own) = (
            self.first.position_in_common_axes(self.features.vector_from_entry(8)),
            self.first.direction_in_common_axes(self.features.vector_from_entry(11)),
        );
        let (end, along) = (
            self.second.position_in_common_axes(self.features.vector_from_entry(15)),
            self.second.direction_in_common_axes(self.features.vector_from_entry(18)),
        );
        let (near, far) = closest_positions_on_segments(start - end, (own, values[14]), (along, values[21]));
        let (start, end) = (start + own * near, end + along * far);
        let (separation, across) = (start - end, own.cross(along));
        let distance = norm_bounded_below(separation, LEAST_SQUARE);
        let crossing = across * (side / norm_bounded_below(across, PARALLEL));
        let normal =
            crossing + separation * (is_closest / distance) + face_normal * (one - is_crossing - is_closest);
        let [own_radius, other_radius] = self.radii;
        let depth = crossing.dot(separation) + distance * is_closest - own_radius - other_radius;
        let (first, second) = tangents_of(normal);
        PointContact {
            gap: self.unused + (depth - self.unused) * (is_crossing + is_closest),
            point: (start + end) * (one * 0.5) + normal * ((other_radius - own_radius) * 0.5),
            axes: [("normal", normal), ("first", first), ("second", second)],
            conditions: Vec::new(),
        }
    }
}

/// Returns the position of a point on a face from its features: `own` is the frame of the polytope with the
/// face, `other` that of the other polytope.
fn point_of_face<'g>(values: &[Expr<'g>], own: &PolytopeFrame<'g>, other: &PolytopeFrame<'g>) -> Vec3<'g> {
    let vector_from_entry = |first: usize| Vec3(std::array::from_fn(|k| values[first + k]));
    let (is_cut, is_own) = (values[1], values[2]);
    let line = PolytopeFrame::select_frame_by_indicator(is_own, own, other);
    let plane = PolytopeFrame::select_frame_by_indicator(is_own, other, own);
    let (start, along) = (
        line.position_in_common_axes(vector_from_entry(3)),
        line.direction_in_common_axes(vector_from_entry(6)),
    );
    let normal = plane.direction_in_common_axes(vector_from_entry(9));
    let height = normal.dot(start - plane.origin) - values[12];
    let slope = normal.dot(along) + (is_cut.num(1.0) - is_cut);
    start - along * (height * is_cut / slope)
}
