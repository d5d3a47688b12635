//! Conversion of MJCF contact parameters of shapes to contacts with planes.

use super::defaults::Element;
use crate::diag::Place;
use crate::import::context::Cx;
use crate::import::pose::{FilePose, matrix_times_vector};
use crate::syntax::{Contact, Expr, ExprKind, GROUND, Key, Name, WrittenArguments};
use std::cmp::Ordering;

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

/// Plane of the MJCF world, with which shapes collide.
pub(super) struct Plane {
    pub(super) name: String,
    pub(super) pose: FilePose,
    pub(super) law: MjcfContactParameters,
}

/// Collision shape of an MJCF body.
pub(super) struct CollisionShape {
    pub(super) link: usize,
    /// Index of the shape among the shapes of its body.
    pub(super) number: usize,
    pub(super) name: Option<String>,
    pub(super) law: MjcfContactParameters,
    pub(super) place: Place,
}

impl MjcfContactParameters {
    /// Reads the contact parameters of a shape with their defaults. Reports contact forces that are not
    /// supported.
    pub(super) fn read_contact_law(shape: &Element<'_>, cx: &mut Cx<'_>) -> MjcfContactParameters {
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
        let mut of = |attribute: &str, usual: f64| {
            shape.read_finite_attribute(attribute, cx).map_or(usual, |found| found.value)
        };
        let (bits, priority) =
            ([of("contype", 1.0) as u32, of("conaffinity", 1.0) as u32], of("priority", 0.0));
        let dimensions = of("condim", 3.0);
        let usual = [1.0, 0.005, 0.0001];
        let friction = shape.numbers_with_defaults("friction", usual, cx).map_or(usual, |found| found.value);
        MjcfContactParameters { bits, priority, dimensions, friction }
    }

    /// Returns true if the bit masks of the shape permit no contacts.
    pub(super) fn has_no_contacts(&self) -> bool {
        self.bits == [0; 2]
    }

    /// Returns true if the masks of two shapes permit contact.
    pub(super) fn masks_permit_contact(&self, other: &MjcfContactParameters) -> bool {
        self.bits[0] & other.bits[1] != 0 || other.bits[0] & self.bits[1] != 0
    }

    /// Returns the coefficients of sliding, torsional and rolling friction between two shapes (MuJoCo,
    /// *Computation*, "Contact"). They are those of the shape with higher priority. With equal priority they
    /// are the larger coefficients, and the dimension is the larger dimension.
    fn combined_friction_coefficients(&self, other: &MjcfContactParameters) -> [f64; 3] {
        let (dimensions, friction) = match self.priority.total_cmp(&other.priority) {
            Ordering::Greater => (self.dimensions, self.friction),
            Ordering::Less => (other.dimensions, other.friction),
            Ordering::Equal => {
                let larger = std::array::from_fn(|k| self.friction[k].max(other.friction[k]));
                (self.dimensions.max(other.dimensions), larger)
            }
        };
        let least = [3.0, 4.0, 6.0];
        std::array::from_fn(|k| if dimensions < least[k] { 0.0 } else { friction[k] })
    }
}

impl CollisionShape {
    /// Returns the contact between the shape and a plane of the world.
    pub(super) fn contact_with_plane(&self, name: String, link: &str, plane: &Plane) -> Contact {
        let at = &self.place;
        let name_with_source_span = |text: &str| Name { text: text.to_string(), place: at.clone() };
        let name_expression = |text: &str| Expr { kind: ExprKind::Name(text.to_string()), place: at.clone() };
        let method_expression =
            |of: Expr, word: &str, argument: Expr| Expr::method_call(of, word, vec![argument]);
        let normal = Expr::vector_at(matrix_times_vector(&plane.pose.axes, [0.0, 0.0, 1.0]), at);
        let point = method_expression(name_expression(GROUND), "at", Expr::vector_at(plane.pose.at, at));
        let nonzero_coefficient = |number: f64| (number != 0.0).then(|| Expr::number_at(number, at));
        let keys = [Key::Friction, Key::TorsionalFriction, Key::RollingFriction];
        let values = self.law.combined_friction_coefficients(&plane.law).map(nonzero_coefficient);
        let given = keys.into_iter().zip(values).filter_map(|(key, value)| Some((key, value?)));
        Contact {
            name: name_with_source_span(&name),
            first: method_expression(
                name_expression(link),
                "collision",
                Expr::number_at(self.number as f64, at),
            ),
            second: method_expression(point, "plane", normal),
            arguments: WrittenArguments(given.collect()),
            of_file: true,
        }
    }
}
