//! MJCF contact parameters of shapes, and contacts between two shapes.

use super::defaults::ElementWithDefaults;
use crate::diag::Place;
use crate::import::context::Cx;
use crate::import::pose::{NumericPose, Vector, matrix_times_vector};
use crate::syntax::{
    Contact, Expr, ExprKind, FileContact, Key, Name, Shape, SurfaceFeatureCounts, SurfaceId, WrittenArguments,
};
use std::cmp::Ordering;

/// MuJoCo's dimension of a contact without the attribute `condim`.
const DIMENSION: f64 = 3.0;

/// MJCF contact parameters of a shape.
pub(super) struct MjcfContactParameters {
    /// Bit masks `contype` and `conaffinity`, which decide the shapes that collide.
    bits: [u32; 2],
    priority: f64,
    /// Dimension of the contact: 1 without friction, 3 with sliding friction, 4 with torsional friction, 6
    /// with rolling friction.
    dimensions: f64,
    /// Coefficients of sliding, torsional and rolling friction.
    friction: [f64; 3],
}

/// Form of an MJCF shape in contacts.
pub(super) enum ContactGeometry {
    /// Plane, with its pose relative to its link.
    Plane(NumericPose),
    /// Collision shape of its link.
    Solid {
        /// Index of the shape among the collision shapes of its link.
        number: usize,
        /// Shape with its lengths.
        shape: Shape,
        /// Centre of the shape relative to its link.
        center: Vector,
    },
}

/// Shape of an MJCF file that other shapes can touch.
pub(super) struct ContactShape {
    /// Index of the link that carries the shape.
    pub(super) link: usize,
    pub(super) form: ContactGeometry,
    pub(super) name: Option<String>,
    pub(super) law: MjcfContactParameters,
    pub(super) place: Place,
}

impl MjcfContactParameters {
    /// Reads the contact parameters of a shape with their defaults. Reports contact forces that are not
    /// supported.
    pub(super) fn read_contact_parameters(
        shape: &ElementWithDefaults<'_>,
        cx: &mut Cx<'_>,
    ) -> MjcfContactParameters {
        for which in ["adhesion", "surfacevel"] {
            let found = shape.numbers_with_defaults(which, [0.0; 6], cx);
            if let Some(found) = found.filter(|found| found.value != [0.0; 6]) {
                cx.report_error(
                    &found.place,
                    format!("`{which}` of a colliding shape is not supported"),
                    |d| d.add_help("to ignore the contacts of the file, remove `contacts = file`"),
                );
            }
        }
        let bits = Self::read_masks(shape, cx);
        let priority = shape.read_finite_attribute("priority", cx).map_or(0.0, |found| found.value);
        let dimensions = read_contact_dimension(shape, cx);
        let usual = [1.0, 0.005, 0.0001];
        let friction = shape.numbers_with_defaults("friction", usual, cx).map_or(usual, |found| found.value);
        MjcfContactParameters { bits, priority, dimensions, friction }
    }

    /// Reads the bit masks `contype` and `conaffinity` of a shape.
    pub(super) fn read_masks(shape: &ElementWithDefaults<'_>, cx: &mut Cx<'_>) -> [u32; 2] {
        ["contype", "conaffinity"]
            .map(|attribute| shape.read_finite_attribute(attribute, cx).map_or(1, |bits| bits.value as u32))
    }

    /// Returns true if the masks of two shapes permit contact.
    pub(super) fn masks_permit_contact(&self, other: &MjcfContactParameters) -> bool {
        self.bits[0] & other.bits[1] != 0 || other.bits[0] & self.bits[1] != 0
    }

    /// Returns the coefficients of sliding, torsional and rolling friction between two shapes (MuJoCo,
    /// *Computation*, "Contact"). They are those of the shape with higher priority. With equal priority they
    /// are the larger coefficients, and the dimension is the larger dimension.
    pub(super) fn combined_friction_coefficients(&self, other: &MjcfContactParameters) -> [f64; 3] {
        let (dimensions, friction) = match self.priority.total_cmp(&other.priority) {
            Ordering::Greater => (self.dimensions, self.friction),
            Ordering::Less => (other.dimensions, other.friction),
            Ordering::Equal => {
                let larger = std::array::from_fn(|k| self.friction[k].max(other.friction[k]));
                (self.dimensions.max(other.dimensions), larger)
            }
        };
        friction_of_condim(dimensions, friction)
    }
}

/// Reads `condim`, the dimension of a contact.
pub(super) fn read_contact_dimension(element: &ElementWithDefaults<'_>, cx: &mut Cx<'_>) -> f64 {
    let Some(found) = element.read_finite_attribute("condim", cx) else { return DIMENSION };
    if ![1.0, 3.0, 4.0, 6.0].contains(&found.value) {
        cx.report_error(&found.place, format!("`condim` is {}", found.value), |d| {
            d.add_help("expected 1, 3, 4 or 6: the dimension of the contact")
        });
    }
    found.value
}

/// Returns the coefficients of sliding, torsional and rolling friction that a contact of this dimension has.
pub(super) fn friction_of_condim(dimension: f64, friction: [f64; 3]) -> [f64; 3] {
    let least = [3.0, 4.0, 6.0];
    std::array::from_fn(|k| if dimension < least[k] { 0.0 } else { friction[k] })
}

impl ContactGeometry {
    /// Returns the surface of the form, without the size of a mesh.
    fn surface_vertex_and_corner_counts(&self) -> SurfaceFeatureCounts {
        let id = match self {
            ContactGeometry::Plane(_) => SurfaceId::Plane,
            ContactGeometry::Solid { shape, .. } => shape.surface_id(),
        };
        SurfaceFeatureCounts { id: Some(id), vertices: 0, corners: 0 }
    }

    /// Whether Linkwork supports the contact of two forms.
    pub(super) fn supports_contact_with(&self, other: &ContactGeometry) -> bool {
        self.surface_vertex_and_corner_counts()
            .contact_point_count(&other.surface_vertex_and_corner_counts())
            .is_some()
    }

    /// Whether the form is a plane.
    pub(super) fn is_plane(&self) -> bool {
        matches!(self, ContactGeometry::Plane(_))
    }
}

impl ContactShape {
    /// Returns the expression of the surface of the shape, on the link with this name.
    fn surface_expression(&self, link: &str) -> Expr {
        let at = &self.place;
        let link = Expr { kind: ExprKind::Name(link.to_string()), place: at.clone() };
        match &self.form {
            ContactGeometry::Plane(pose) => {
                let normal = Expr::vector_at(matrix_times_vector(&pose.axes, [0.0, 0.0, 1.0]), at);
                let point = Expr::method_call(link, "at", vec![Expr::vector_at(pose.at, at)]);
                Expr::method_call(point, "plane", vec![normal])
            }
            ContactGeometry::Solid { number, .. } => {
                Expr::method_call(link, "collision", vec![Expr::number_at(*number as f64, at)])
            }
        }
    }

    /// Returns the contact of the shape with another shape, each on the link with this name.
    pub(super) fn contact_with(
        &self,
        other: &ContactShape,
        (name, place): (String, &Place),
        [link, other_link]: [&str; 2],
        friction: [f64; 3],
        of_file: FileContact,
    ) -> Contact {
        let nonzero_coefficient = |number: f64| (number != 0.0).then(|| Expr::number_at(number, place));
        let keys = [Key::Friction, Key::TorsionalFriction, Key::RollingFriction];
        let values = friction.map(nonzero_coefficient);
        let given = keys.into_iter().zip(values).filter_map(|(key, value)| Some((key, value?)));
        Contact {
            name: Name { text: name, place: place.clone() },
            first: self.surface_expression(link),
            second: other.surface_expression(other_link),
            arguments: WrittenArguments(given.collect()),
            of_file: Some(of_file),
        }
    }
}
