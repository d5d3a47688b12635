//! Contact points of cylinders with end faces on each other and on hulls, from features that the runtime
//! selects.
//!
//! A point of a face is a point of the other body, such as the lowest point of a rim. Other contact points
//! are those where two curves are closest: rims, axes of sides, edges or vertices. The runtime returns these
//! points for the present pose, with the tangent and the curvature vector of each curve. Two steps of
//! Newton's method, which do not move the points in this pose, make them functions of the pose whose first
//! and second derivatives are exact: contact points move along rims and sides as on smooth round surfaces.

use super::geometry::{PointContact, norm_bounded_below, tangents_of};
use super::polytopes::{LEAST_SQUARE, PlacedPair, PolytopeFrame};
use crate::expr::{Expr, Extreme, Vec3};
use crate::mechanism::{CYLINDER_PAIR_FEATURES, CYLINDER_POINT_FEATURES, CYLINDER_POINTS};

/// Point of a curve with tangent and curvature vector, in common axes.
#[derive(Clone, Copy)]
struct CurvePoint<'g> {
    point: Vec3<'g>,
    tangent: Vec3<'g>,
    curvature: Vec3<'g>,
}

impl<'g> CurvePoint<'g> {
    /// Returns a curve from its features: point, tangent and curvature vector.
    fn from_features(frame: &PolytopeFrame<'g>, values: &[Expr<'g>]) -> CurvePoint<'g> {
        let vector_from_entry = |first: usize| Vec3(std::array::from_fn(|k| values[first + k]));
        CurvePoint {
            point: frame.position_in_common_axes(vector_from_entry(0)),
            tangent: frame.direction_in_common_axes(vector_from_entry(3)),
            curvature: frame.direction_in_common_axes(vector_from_entry(6)),
        }
    }

    fn from_vertex(point: Vec3<'g>) -> CurvePoint<'g> {
        let zero = Vec3::zero(point[0].graph());
        CurvePoint { point, tangent: zero, curvature: zero }
    }

    /// Returns the point and the tangent at a distance along the curve, to second order.
    fn point_and_tangent(&self, s: Expr<'g>) -> [Vec3<'g>; 2] {
        let half = s.square() * 0.5;
        let point = self.point + self.tangent * s + self.curvature * half;
        let change = self.curvature * s - self.tangent * (self.curvature.dot(self.curvature) * half);
        [point, self.tangent + change]
    }
}

/// Features of a contact point on two curves.
struct CurvedFeatures<'g> {
    /// One if the point is on a face.
    on_face: Expr<'g>,
    /// Sign with which the cross product of both tangents points towards the first body; zero for none.
    side: Expr<'g>,
    /// One if the normal is along the shortest connection of both curves.
    is_closest: Expr<'g>,
    radii: [Expr<'g>; 2],
    curves: [CurvePoint<'g>; 2],
}

/// Face of a pair, in common axes.
struct FaceOfPair<'g> {
    /// One if the face belongs to the second body.
    is_second: Expr<'g>,
    /// Position of a point of its plane.
    origin: Vec3<'g>,
    outward: Vec3<'g>,
    /// Normal towards the first body.
    normal: Vec3<'g>,
    /// Least gap of points on the face.
    least: Expr<'g>,
}

impl<'g> PlacedPair<'g> {
    /// Returns the contacts of a pair with a cylinder.
    pub(super) fn cylinder_pair_contacts(&self) -> Vec<PointContact<'g>> {
        let (values, zero) = (&self.features.values, self.unused.zero());
        let [curved, fixed] = CYLINDER_POINT_FEATURES;
        let [curved_count, fixed_count] = CYLINDER_POINTS;
        let is_second = values[0];
        let own = PolytopeFrame::select_frame_by_indicator(is_second, &self.second, &self.first);
        let other = PolytopeFrame::select_frame_by_indicator(is_second, &self.first, &self.second);
        let outward = own.direction_in_common_axes(self.features.vector_from_entry(2));
        let face = FaceOfPair {
            is_second,
            origin: own.origin + outward * values[5],
            outward,
            normal: outward * (is_second * 2.0 - zero.num(1.0)),
            least: values[1],
        };
        let on_curves = (0..curved_count).map(|k| {
            let values = &values[CYLINDER_PAIR_FEATURES + curved * k..];
            let curves = [(&self.first, 5), (&self.second, 14)];
            self.curved_contact(
                &CurvedFeatures {
                    on_face: values[0],
                    side: values[1],
                    is_closest: values[2],
                    radii: [values[3], values[4]],
                    curves: curves.map(|(frame, first)| CurvePoint::from_features(frame, &values[first..])),
                },
                &face,
            )
        });
        let on_face = (0..fixed_count).map(|k| {
            let values = &values[CYLINDER_PAIR_FEATURES + curved * curved_count + fixed * k..];
            let point = other.position_in_common_axes(Vec3([values[1], values[2], values[3]]));
            let features = CurvedFeatures {
                on_face: values[0],
                side: zero,
                is_closest: zero,
                radii: [zero; 2],
                curves: [CurvePoint::from_vertex(point); 2],
            };
            self.curved_contact(&features, &face)
        });
        on_curves.chain(on_face).collect()
    }

    /// Returns the contact at a point of a face, or at the closest points of two curves.
    fn curved_contact(&self, features: &CurvedFeatures<'g>, face: &FaceOfPair<'g>) -> PointContact<'g> {
        let CurvedFeatures { on_face, side, is_closest, radii: [own_radius, other_radius], .. } = *features;
        let one = self.unused.num(1.0);
        let [[first, own], [second, other]] = features.closest_points(face);
        let between = first - second;
        let across = own.cross(other);
        let is_on_curves = side.square() + is_closest;
        let normal = face.normal * (one - is_on_curves)
            + across * (side / norm_bounded_below(across, LEAST_SQUARE))
            + between * (is_closest / norm_bounded_below(between, LEAST_SQUARE));
        let place = second + (first - second) * face.is_second;
        let height = face.outward.dot(place - face.origin);
        let gap_of_curves = normal.dot(between) - own_radius - other_radius;
        let gap_on_face = height.minimum_or_maximum(Extreme::Max, face.least);
        let middle_on_face = place - face.outward * (height * 0.5);
        let middle = (first + second) * (one * 0.5) + normal * ((other_radius - own_radius) * 0.5);
        let (first_tangent, second_tangent) = tangents_of(normal);
        PointContact {
            gap: self.unused
                + (gap_of_curves - self.unused) * is_on_curves
                + (gap_on_face - self.unused) * on_face,
            point: middle_on_face + (middle - middle_on_face) * is_on_curves,
            axes: [("normal", normal), ("first", first_tangent), ("second", second_tangent)],
            conditions: Vec::new(),
        }
    }
}

impl<'g> CurvedFeatures<'g> {
    /// Returns the closest points of both curves with their tangents. Points on a face have a tangent that is
    /// perpendicular to its normal instead.
    fn closest_points(&self, face: &FaceOfPair<'g>) -> [[Vec3<'g>; 2]; 2] {
        let [a, b] = &self.curves;
        let one = self.on_face.num(1.0);
        // The gradient of half the squared distance, or of the height above the face.
        let gradient_of_separation = |between: Vec3<'g>| between + (face.normal - between) * self.on_face;
        let present = gradient_of_separation(a.point - b.point);
        let x = one - a.tangent.dot(a.tangent) * self.on_face + a.curvature.dot(present);
        let y = one - b.tangent.dot(b.tangent) * self.on_face - b.curvature.dot(present);
        let z = a.tangent.dot(b.tangent) * (self.on_face - one);
        let determinant = x * y - z.square();
        let (mut s, mut t) = (one.zero(), one.zero());
        for _ in 0..2 {
            let ([first, own], [second, other]) = (a.point_and_tangent(s), b.point_and_tangent(t));
            let along = gradient_of_separation(first - second);
            let (own, other) = (own.dot(along), -other.dot(along));
            s += (z * other - y * own) / determinant;
            t += (z * own - x * other) / determinant;
        }
        [a.point_and_tangent(s), b.point_and_tangent(t)]
    }
}
