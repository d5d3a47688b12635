//! Surfaces of bodies in contacts.

use super::terrain::Terrain;
use crate::expr::{Expr, Vec3};
use crate::hull::Hull;
use crate::language::SurfaceId;
use crate::resolve::scope::PlacedElement;

/// Form of a surface; vectors and lengths in body axes.
#[derive(Clone)]
pub enum SurfaceForm<'g> {
    /// Surface that is the rim of a disk, with radius and axis.
    Circle(Expr<'g>, Vec3<'g>),
    /// Tyre: radius of its centre line, radius of its section, axis.
    Torus(Expr<'g>, Expr<'g>, Vec3<'g>),
    /// Surface of a sphere, with its radius.
    Sphere(Expr<'g>),
    /// Surface of an ellipsoid, with the semi-axes along the body's axes.
    Ellipsoid([Expr<'g>; 3]),
    /// Plane, with its normal towards the body that touches it.
    Plane(Vec3<'g>),
    /// Inside of a sphere, with its radius.
    Bowl(Expr<'g>),
    /// Outside of a cylinder of infinite length, with radius and axis.
    Cylinder(Expr<'g>, Vec3<'g>),
    /// Outside of a cylinder with two end faces, with radius, length and axis.
    Drum(Expr<'g>, Expr<'g>, Vec3<'g>),
    /// Inside of a cylinder, with radius and axis.
    Tube(Expr<'g>, Vec3<'g>),
    /// Outside of a cone: half angle, axis from the apex into the cone.
    Cone(Expr<'g>, Vec3<'g>),
    /// Inside of a cone: half angle, axis from the apex to the opening.
    Funnel(Expr<'g>, Vec3<'g>),
    /// Parametric surface, given by the position of its points.
    ParametricSurface(ParametricSurface<'g>),
    /// Terrain, given by the height as a function of x and y.
    Terrain(Box<Terrain<'g>>),
    /// Point as a degenerate surface, for unilateral contacts only.
    Point,
    /// Box, with the lengths of its edges along the body's axes.
    Cuboid([Expr<'g>; 3]),
    /// Cylinder between two hemispheres: radius, distance of their centres, axis.
    Capsule(Expr<'g>, Expr<'g>, Vec3<'g>),
    /// Convex hull of points fixed in the body.
    Hull(ConvexHull<'g>),
}

/// Surface given by its points as expressions of two coordinates, in body axes relative to its position.
#[derive(Clone)]
pub struct ParametricSurface<'g> {
    /// Position of the surface point as a function of the surface parameters.
    pub point: Vec3<'g>,
    /// Derivatives of the point by the coordinates; their cross product points towards the body that rolls.
    pub tangents: [Vec3<'g>; 2],
}

/// Convex hull of points in body axes.
#[derive(Clone)]
pub struct ConvexHull<'g> {
    /// Vertices of the hull; if they depend on parameters, all given points.
    pub vertices: Vec<Vec3<'g>>,
    /// Faces and edges; `None` if the points depend on parameters.
    pub shape: Option<Hull>,
}

/// Surface of a body with its pose.
#[derive(Clone)]
pub struct Surface<'g> {
    /// Frame at the centre, at the apex or at a point of the surface.
    pub frame: PlacedElement<'g>,
    /// Form of the surface with its dimensions.
    pub form: SurfaceForm<'g>,
}

impl SurfaceForm<'_> {
    /// Returns the row of the surface in the table of the language; `None` for a point.
    pub fn id(&self) -> Option<SurfaceId> {
        match self {
            SurfaceForm::Circle(..) => Some(SurfaceId::Circle),
            SurfaceForm::Torus(..) => Some(SurfaceId::Torus),
            SurfaceForm::Sphere(_) => Some(SurfaceId::Sphere),
            SurfaceForm::Ellipsoid(_) => Some(SurfaceId::Ellipsoid),
            SurfaceForm::Plane(_) => Some(SurfaceId::Plane),
            SurfaceForm::Bowl(_) => Some(SurfaceId::Bowl),
            SurfaceForm::Cylinder(..) => Some(SurfaceId::Cylinder),
            SurfaceForm::Drum(..) => Some(SurfaceId::Drum),
            SurfaceForm::Tube(..) => Some(SurfaceId::Tube),
            SurfaceForm::Cone(..) => Some(SurfaceId::Cone),
            SurfaceForm::Funnel(..) => Some(SurfaceId::Funnel),
            SurfaceForm::ParametricSurface(_) => Some(SurfaceId::ParametricSurface),
            SurfaceForm::Terrain(_) => Some(SurfaceId::Terrain),
            SurfaceForm::Cuboid(_) => Some(SurfaceId::Cuboid),
            SurfaceForm::Capsule(..) => Some(SurfaceId::Capsule),
            SurfaceForm::Hull(_) => Some(SurfaceId::Hull),
            SurfaceForm::Point => None,
        }
    }
}
