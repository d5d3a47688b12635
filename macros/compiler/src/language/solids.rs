//! Homogeneous solids with their moments of inertia about the centre of mass (any table of mechanics).

use super::{Argument, ArgumentKind};
use crate::expr::{Expr, Mat3, Sym3, Vec3};
use crate::mechanism::PieceShape;

/// Row of the table of solids.
#[derive(Debug)]
pub struct SolidRow {
    /// Name of the solid.
    pub name: &'static str,
    /// Names of the solid in other tools.
    pub synonyms: &'static str,
    /// The arguments; a direction comes last, and the masses and lengths are not negative.
    pub arguments: &'static [Argument],
    /// Shape of the drawing; `None` for individual moments of inertia.
    pub piece: Option<PieceShape>,
    /// Function that returns the inertia from the values of the arguments without the direction, and from the
    /// direction.
    pub inertia: for<'g> fn(&[Expr<'g>], Vec3<'g>) -> Sym3<'g>,
}

const MASS: Argument = Argument::MASS;
const AXIS: Argument = Argument::AXIS;
const RADIUS: Argument = Argument::length_argument("radius");
const LENGTH: Argument = Argument::length_argument("length");
const HEIGHT: Argument = Argument::length_argument("height");
const X: Argument = Argument::length_argument("x length");
const Y: Argument = Argument::length_argument("y length");
const Z: Argument = Argument::length_argument("z length");

const fn inertia_argument(name: &'static str) -> Argument {
    Argument::new(name, ArgumentKind::Inertia)
}

table! {
    /// Solid of the language: a homogeneous solid, or individual moments of inertia.
    Solid: SolidRow {
        /// Thin rod, by mass, length and axis.
        Rod = SolidRow {
            name: "rod", synonyms: "bar stick thinrod slenderrod beam line",
            arguments: &[MASS, LENGTH, AXIS], piece: Some(PieceShape::Rod),
            inertia: |n, axis| axisymmetric_inertia(n[0].zero(), n[0] * n[1].square() * (1.0 / 12.0), axis),
        };
        /// Thin ring, a homogeneous solid of inertia expressions.
        Ring = SolidRow {
            name: "ring", synonyms: "hoop",
            arguments: &[MASS, RADIUS, AXIS], piece: Some(PieceShape::Ring),
            inertia: |n, axis| axisymmetric_inertia(n[0] * n[1].square(), n[0] * n[1].square() * 0.5, axis),
        };
        /// Thin disk, a homogeneous solid of inertia expressions.
        Disk = SolidRow {
            name: "disk", synonyms: "disc",
            arguments: &[MASS, RADIUS, AXIS], piece: Some(PieceShape::Disk),
            inertia: |n, axis| axisymmetric_inertia(
                n[0] * n[1].square() * 0.5, n[0] * n[1].square() * 0.25, axis,
            ),
        };
        /// Solid cylinder, for inertia expressions.
        Cylinder = SolidRow {
            name: "cylinder", synonyms: "",
            arguments: &[MASS, RADIUS, HEIGHT, AXIS], piece: Some(PieceShape::Cylinder),
            inertia: |n, axis| {
                let axial = n[0] * n[1].square() * 0.5;
                let transverse = n[1].square() * 0.25 + n[2].square() * (1.0 / 12.0);
                axisymmetric_inertia(axial, n[0] * transverse, axis)
            },
        };
        /// Hollow cylinder: a cylinder with a coaxial hole, for inertia expressions.
        Tube = SolidRow {
            name: "tube", synonyms: "pipe hollowcylinder",
            arguments: &[
                MASS, Argument::length_argument("inner radius"), Argument::length_argument("outer radius"),
                    HEIGHT, AXIS,
            ],
            piece: Some(PieceShape::Tube),
            inertia: |n, axis| {
                let radii = n[1].square() + n[2].square();
                axisymmetric_inertia(
                    n[0] * radii * 0.5, n[0] * (radii * 0.25 + n[3].square() * (1.0 / 12.0)), axis,
                )
            },
        };
        /// Solid cone, for inertia expressions.
        Cone = SolidRow {
            name: "cone", synonyms: "",
            arguments: &[MASS, RADIUS, HEIGHT, AXIS], piece: Some(PieceShape::Cone),
            inertia: |n, axis| {
                let axial = n[0] * n[1].square() * 0.3;
                let transverse = n[1].square() * 0.15 + n[2].square() * 0.0375;
                axisymmetric_inertia(axial, n[0] * transverse, axis)
            },
        };
        /// Capsule: a cylinder of the given height between two half balls, for inertia expressions.
        Capsule = SolidRow {
            name: "capsule", synonyms: "pill",
            arguments: &[MASS, RADIUS, HEIGHT, AXIS], piece: Some(PieceShape::Capsule),
            inertia: |n, axis| {
                let (m, r, h) = (n[0], n[1], n[2]);
                // Volumes over π r²: h of the cylinder, 4 r / 3 of the two halves of the ball.
                let ball = r * (4.0 / 3.0);
                let (m_cylinder, m_ball) = (m * h / (h + ball), m * ball / (h + ball));
                let axial = m_cylinder * r.square() * 0.5 + m_ball * r.square() * 0.4;
                let transverse = m_cylinder * (r.square() * 0.25 + h.square() * (1.0 / 12.0))
                    + m_ball * (r.square() * 0.4 + h.square() * 0.25 + h * r * 0.375);
                axisymmetric_inertia(axial, transverse, axis)
            },
        };
        /// Solid ball, for inertia expressions.
        Sphere = SolidRow {
            name: "sphere", synonyms: "ball",
            arguments: &[MASS, RADIUS], piece: Some(PieceShape::Sphere),
            inertia: |n, _| Sym3::multiple_of_identity(n[0] * n[1].square() * 0.4),
        };
        /// Thin hollow ball, for inertia expressions.
        Shell = SolidRow {
            name: "shell", synonyms: "hollowsphere sphericalshell",
            arguments: &[MASS, RADIUS], piece: Some(PieceShape::Sphere),
            inertia: |n, _| Sym3::multiple_of_identity(n[0] * n[1].square() * (2.0 / 3.0)),
        };
        /// Solid cuboid, for inertia expressions.
        Cuboid = SolidRow {
            name: "cuboid", synonyms: "cube brick block cuboid3 parallelepiped rectangle",
            arguments: &[MASS, X, Y, Z], piece: Some(PieceShape::Cuboid),
            inertia: |n, _| diagonal_inertia_of_lengths(n[0] * (1.0 / 12.0), n),
        };
        /// Solid cuboid under the name `box`, for inertia expressions.
        Box = SolidRow {
            name: "box", synonyms: "",
            arguments: &[MASS, X, Y, Z], piece: Some(PieceShape::Cuboid),
            inertia: |n, _| diagonal_inertia_of_lengths(n[0] * (1.0 / 12.0), n),
        };
        /// Thin rectangular plate, for inertia expressions.
        Plate = SolidRow {
            name: "plate", synonyms: "sheet lamina",
            arguments: &[MASS, X, Y], piece: Some(PieceShape::Cuboid),
            inertia: |n, _| {
                let m = n[0] * (1.0 / 12.0);
                diagonal_inertia([m * n[2].square(), m * n[1].square(), m * (n[1].square() + n[2].square())])
            },
        };
        /// Solid ellipsoid, for inertia expressions.
        Ellipsoid = SolidRow {
            name: "ellipsoid", synonyms: "",
            arguments: &[
                MASS, Argument::length_argument("x radius"), Argument::length_argument("y radius"),
                    Argument::length_argument("z radius"),
            ],
            piece: Some(PieceShape::Ellipsoid),
            inertia: |n, _| diagonal_inertia_of_lengths(n[0] * 0.2, n),
        };
        /// Three principal moments of inertia instead of a solid.
        Diagonal = SolidRow {
            name: "diagonal", synonyms: "diag principal",
            arguments: &[inertia_argument("xx"), inertia_argument("yy"), inertia_argument("zz")], piece: None,
            inertia: |n, _| diagonal_inertia([n[0], n[1], n[2]]),
        };
    }
}

impl Solid {
    /// Returns the syntax of the solid's function, such as `rod(mass, length, axis)`.
    pub fn usage_syntax(self) -> String {
        format!("{}({})", self.name(), Argument::list_argument_names(self.row().arguments))
    }

    /// True for a solid whose last argument is an axis.
    pub fn has_axis(self) -> bool {
        self.row().arguments.last().is_some_and(|last| last.kind.is_direction())
    }
}

fn diagonal_inertia(moments: [Expr<'_>; 3]) -> Sym3<'_> {
    Sym3 { diagonal: moments, off: [moments[0].zero(); 3] }
}

/// Returns moments proportional to the sums of squares of two of three lengths.
fn diagonal_inertia_of_lengths<'g>(m: Expr<'g>, n: &[Expr<'g>]) -> Sym3<'g> {
    let squared_length = |k: usize| n[k].square();
    diagonal_inertia([
        m * (squared_length(2) + squared_length(3)),
        m * (squared_length(1) + squared_length(3)),
        m * (squared_length(1) + squared_length(2)),
    ])
}

/// Returns `t 1 + (a − t) n nᵀ`: moment `a` about the axis `n`, moment `t` about all normals of `n`.
fn axisymmetric_inertia<'g>(axial: Expr<'g>, transverse: Expr<'g>, n: Vec3<'g>) -> Sym3<'g> {
    if let Some(k) = (0..3).find(|k| n[*k].constant_value().is_some_and(|c| c.abs() == 1.0)) {
        let diagonal = std::array::from_fn(|i| if i == k { axial } else { transverse });
        return Sym3 { diagonal, off: [axial.zero(); 3] };
    }
    let extra = axial - transverse;
    Sym3::from_upper(&Mat3::from_fn(|i, j| {
        let term = extra * n[i] * n[j];
        if i == j { transverse + term } else { term }
    }))
}
