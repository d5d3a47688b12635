//! Convex polytopes in contact, as data of the model. A feature is a number that the runtime computes for a
//! pair, from which generated code computes gaps and contact velocities.

use crate::expr::Expr;

/// Number of values that describe the pose of a pair.
pub const PAIR_POSE: usize = 13;
/// Number of features of a pair that are not those of a point on a face.
pub const PAIR_FEATURES: usize = 22;
/// Number of features of a point on a face.
pub const POINT_FEATURES: usize = 13;
/// Number of features of a pair with a cylinder that are not those of a contact point.
pub const CYLINDER_PAIR_FEATURES: usize = 6;
/// Numbers of contact points of a pair with a cylinder on curves, and fixed in the body opposite to a face.
pub const CYLINDER_POINTS: [usize; 2] = [3, 5];
/// Numbers of features of one contact point of a pair with a cylinder: on curves, and fixed in the body
/// opposite to a face.
pub const CYLINDER_POINT_FEATURES: [usize; 2] = [23, 4];

/// Face of a polytope.
#[derive(Clone, Debug)]
pub struct PolytopeFace {
    /// Outward unit normal.
    pub normal: [f64; 3],
    /// Distance of the plane from the origin along the normal, m.
    pub offset: f64,
    /// Indices of the vertices, counter-clockwise about the normal.
    pub corners: Vec<u8>,
}

/// Edge of a polytope.
#[derive(Clone, Copy, Debug)]
pub struct PolytopeEdge {
    /// Indices of the vertices at both ends, in the direction of the cross product of the normals of the
    /// second and the first face.
    pub ends: [u8; 2],
    /// Indices of the adjacent faces; [`PolytopeEdge::NO_FACES`] for a line segment.
    pub faces: [u8; 2],
}

impl PolytopeEdge {
    /// Indices of faces that mark the edge of a line segment.
    pub const NO_FACES: [u8; 2] = [u8::MAX; 2];
}

/// Convex polytope whose vertices are constant in the axes of its body, a line segment, or a cylinder with
/// two end faces around a line segment.
#[derive(Clone, Debug)]
pub struct Polytope {
    /// Positions of the vertices, m.
    pub vertices: Vec<[f64; 3]>,
    /// Faces, none for a line segment.
    pub faces: Vec<PolytopeFace>,
    /// Edges.
    pub edges: Vec<PolytopeEdge>,
    /// Radius of the cylinder with two end faces around a line segment, m; zero for other shapes.
    pub radius: f64,
}

impl Polytope {
    /// Returns the lowest and the highest coordinate of the vertices along an axis, m.
    fn extent_along_axis(&self, axis: usize) -> [f64; 2] {
        let coordinates = || self.vertices.iter().map(|vertex| vertex[axis]);
        [coordinates().fold(f64::INFINITY, f64::min), coordinates().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Returns half the sum of the lengths along the axes of the body, m.
    pub fn half_sum_of_lengths(&self) -> f64 {
        let lengths = (0..3).map(|axis| self.extent_along_axis(axis)).map(|[low, high]| (high - low) / 2.0);
        lengths.sum::<f64>() + 2.0 * self.radius
    }

    /// Returns the centre of the extents along the axes of the body, m.
    pub fn center(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.extent_along_axis(axis).iter().sum::<f64>() / 2.0)
    }

    /// Returns the largest distance of a vertex from the origin, m.
    pub fn largest_distance_from_origin(&self) -> f64 {
        let norm = |vertex: &[f64; 3]| vertex.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.vertices.iter().map(norm).fold(0.0, f64::max).hypot(self.radius)
    }

    /// Returns the largest number of vertices of a face; two for a line segment.
    pub fn most_corners_per_face(&self) -> usize {
        self.faces.iter().map(|face| face.corners.len()).fold(2, usize::max)
    }
}

/// Two polytopes in contact. The runtime selects the features of the pair that determine the contact.
#[derive(Clone, Debug)]
pub struct PolytopePair<'g> {
    /// Polytope of the first surface.
    pub first: Polytope,
    /// Polytope of the second surface.
    pub second: Polytope,
    /// Maximum number of contact points of a face; without effect for cylinders.
    pub points: usize,
    /// Rotation matrix that converts axes of the second surface to axes of the first, column by column; the
    /// position of the second surface in the axes of the first; and a length that is positive if a face of
    /// the first polytope is preferred to an equal face of the second.
    pub pose: [Expr<'g>; PAIR_POSE],
}

impl PolytopePair<'_> {
    /// Returns the number of features of the pair.
    pub fn feature_count(&self) -> usize {
        if !self.has_cylinder() {
            return PAIR_FEATURES + POINT_FEATURES * self.points;
        }
        let of_points = CYLINDER_POINTS.into_iter().zip(CYLINDER_POINT_FEATURES);
        CYLINDER_PAIR_FEATURES + of_points.map(|(points, features)| points * features).sum::<usize>()
    }

    /// Whether a shape is a cylinder with two end faces.
    pub fn has_cylinder(&self) -> bool {
        self.first.radius > 0.0 || self.second.radius > 0.0
    }
}
