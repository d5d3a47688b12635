//! Contact surfaces of bodies: `ball.sphere(radius)`, `ground.plane(z)`, and the pairs of surfaces that are
//! supported.

use super::{Argument, ArgumentKind};
use SurfaceId::{Capsule, Circle, Cone, Cuboid, Cylinder, Drum, Ellipsoid, Hull, Sphere, Torus};

/// A row of the table of surfaces.
#[derive(Debug)]
pub struct SurfaceRow {
    /// Name of the surface. Surfaces of the same name differ in the number of their arguments.
    pub name: &'static str,
    /// Names of the surface in other tools.
    pub synonyms: &'static str,
    /// Arguments of the surface.
    pub arguments: &'static [Argument],
    /// Surfaces with which contacts are supported; `None` for a point.
    pub contacts: &'static [Option<SurfaceId>],
    /// Surfaces that may roll or slip on this one.
    pub rollers: &'static [SurfaceId],
}

const NONE: &[Option<SurfaceId>] = &[];
const ROUND: &[Option<SurfaceId>] = &[None, Some(Sphere)];
const ON_PLANE: &[Option<SurfaceId>] = &[
    None,
    Some(Sphere),
    Some(Circle),
    Some(Torus),
    Some(Ellipsoid),
    Some(Capsule),
    Some(Cuboid),
    Some(Drum),
    Some(Hull),
];
const ON_TERRAIN: &[Option<SurfaceId>] = &[None, Some(Sphere), Some(Capsule), Some(Cuboid), Some(Hull)];

const RADIUS: Argument = Argument::length_argument("radius");
const LENGTH: Argument = Argument::length_argument("length");
const AXIS: Argument = Argument::AXIS;
const HALF_ANGLE: Argument = Argument::new("half_angle", ArgumentKind::HalfAngle);
const AXES: &[Argument] =
    &[Argument::length_argument("a"), Argument::length_argument("b"), Argument::length_argument("c")];

const fn surface_row(
    name: &'static str,
    arguments: &'static [Argument],
    contacts: &'static [Option<SurfaceId>],
    rollers: &'static [SurfaceId],
) -> SurfaceRow {
    SurfaceRow { name, synonyms: "", arguments, contacts, rollers }
}

table! {
    /// Surface of a body, for rolling pairs and contacts.
    SurfaceId: SurfaceRow {
        /// Surface `circle`: the rim of a disk.
        Circle = surface_row("circle", &[RADIUS, AXIS], NONE, &[]);
        /// A tyre: radius of the centre line, radius of the section.
        Torus = surface_row("torus", &[RADIUS, Argument::length_argument("tube_radius"), AXIS], NONE, &[]);
        /// Surface `sphere`: the outside of a sphere.
        Sphere = surface_row("sphere", &[RADIUS], ROUND, &[Sphere]);
        /// Surface `ellipsoid`, given by its semi-axes.
        Ellipsoid = surface_row("ellipsoid", AXES, NONE, &[]);
        /// Surface `plane`, given by its normal towards the other surface.
        Plane = surface_row("plane", &[Argument::new("normal", ArgumentKind::Direction)], ON_PLANE,
            &[Circle, Torus, Sphere, Ellipsoid, Cone]);
        /// Surface `bowl`: the inside of a sphere.
        Bowl = surface_row("bowl", &[RADIUS], ROUND, &[Sphere]);
        /// Surface `cylinder` without length: the outside of an infinitely long cylinder.
        Cylinder = surface_row("cylinder", &[RADIUS, AXIS], &[None, Some(Sphere), Some(Capsule)], &[Sphere]);
        /// Surface `cylinder` with length: a cylinder with two end faces.
        Drum = surface_row("cylinder", &[RADIUS, LENGTH, AXIS],
            &[Some(Sphere), Some(Capsule), Some(Cylinder), Some(Drum)], &[]);
        /// Surface `tube`: the inside of a cylinder.
        Tube = surface_row("tube", &[RADIUS, AXIS], ROUND, &[Sphere]);
        /// The outside of a cone, with the axis from the apex into the cone.
        Cone = surface_row("cone", &[HALF_ANGLE, AXIS], ROUND, &[Sphere, Cone]);
        /// The inside of a cone, with the axis from the apex to the opening.
        Funnel = surface_row("funnel", &[HALF_ANGLE, AXIS], ROUND, &[Sphere, Cone]);
        /// Surface `surface`: a parametric surface, given by points that depend on two coordinates.
        ParametricSurface = surface_row("surface",
            &[Argument::new("u", ArgumentKind::Coordinate), Argument::new("w", ArgumentKind::Coordinate),
                Argument::length_argument("point")],
            NONE, &[Circle, Torus, Sphere, Ellipsoid]);
        /// A height over x and y, as an expression of the horizontal coordinates `u`, `w`.
        Terrain = surface_row("terrain", &[Argument::new("height", ArgumentKind::Height)], ON_TERRAIN, &[]);
        /// Surface `box`, given by the lengths of its edges.
        Cuboid = surface_row("cuboid", AXES,
            &[Some(Sphere), Some(Capsule), Some(Cuboid), Some(Cylinder), Some(Drum)], &[]);
        /// A cylinder between two hemispheres, by radius and distance of their centres.
        Capsule = surface_row("capsule", &[RADIUS, LENGTH, AXIS], &[None, Some(Sphere), Some(Capsule)], &[]);
        /// Surface `hull`: the convex hull of points.
        Hull = surface_row("hull", &[Argument::new("points", ArgumentKind::Points)],
            &[Some(Sphere), Some(Capsule), Some(Cuboid), Some(Cylinder), Some(Drum), Some(Hull)], &[]);
    }
}

impl SurfaceId {
    /// Returns the surface with a name and a number of arguments; if none has this number, another surface
    /// of this name.
    pub fn find_closest_by_argument_count(name: &str, count: usize) -> Option<SurfaceId> {
        let surfaces_with_name = || SurfaceId::ALL.iter().copied().filter(|id| id.name() == name);
        surfaces_with_name()
            .find(|id| id.row().arguments.len() == count)
            .or_else(|| surfaces_with_name().next())
    }
}

/// Maximum number of contact points of a face of a hull with a face of another polytope.
pub const MAX_FACE_POINTS: usize = 12;

/// Surface of a contact: its form, `None` for a point, and its numbers of vertices and of corners of the
/// largest face, which are zero if it is not a polytope.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceFeatureCounts {
    /// Form of the surface; `None` for a point.
    pub id: Option<SurfaceId>,
    /// Number of vertices of a hull.
    pub vertices: usize,
    /// Number of corners of the largest face of a box or a hull.
    pub corners: usize,
}

impl SurfaceFeatureCounts {
    /// Returns the number of contact points of two surfaces; `None` if their contact is not supported.
    pub fn contact_point_count(&self, other: &SurfaceFeatureCounts) -> Option<usize> {
        self.listed_contact_point_count(other).or_else(|| other.listed_contact_point_count(self))
    }

    /// Returns the number of contact points if the table lists this surface on the other one.
    fn listed_contact_point_count(&self, other: &SurfaceFeatureCounts) -> Option<usize> {
        let below = other.id.filter(|below| below.row().contacts.contains(&self.id))?;
        let Some(above) = self.id else { return Some(1) };
        Some(match (above, below) {
            (Cuboid | Drum, SurfaceId::Plane | SurfaceId::Terrain) => 8,
            (Capsule, SurfaceId::Plane | SurfaceId::Terrain) => 2,
            (Hull, SurfaceId::Plane | SurfaceId::Terrain) => self.vertices,
            (Cuboid | Hull, Hull) => (self.corners + other.corners).min(MAX_FACE_POINTS) + 1,
            (Capsule, Capsule | Cuboid | Drum) => 5,
            (Capsule, Cylinder | Hull) | (Cylinder, Hull | Cuboid) => 3,
            (Cuboid, Cuboid) => 13,
            (Drum, Cuboid) => 16,
            (Drum, Drum | Cylinder | Hull) | (Cylinder, Drum) => 8,
            _ => 1,
        })
    }
}
