//! Declared force elements and inputs.

use super::{BinaryOp, Expr, Name};
use crate::diag::Place;
use crate::language::{ForceKind, Key};

/// Declared force element or input.
#[derive(Clone, Debug)]
pub struct Action {
    /// Name of the element; for an input, its entry in `INPUTS`.
    pub name: Name,
    /// Row of the element in the table of force elements.
    pub kind: ForceKind,
    /// Coordinate, body or points on which the element acts.
    pub on: Target,
    /// Arguments of the force element, as written.
    pub arguments: WrittenArguments,
}

/// Arguments of an element with their keys, as written.
#[derive(Clone, Debug, Default)]
pub struct WrittenArguments(pub Vec<(Key, Expr)>);

impl WrittenArguments {
    /// Returns the expression of the argument with a key, if it is present.
    pub fn expression_of_key(&self, key: Key) -> Option<&Expr> {
        self.keyed_expressions().find(|(known, _)| *known == key).map(|(_, e)| e)
    }

    /// Returns the keys of the arguments with their expressions.
    pub fn keyed_expressions(&self) -> impl Iterator<Item = (Key, &Expr)> {
        self.0.iter().map(|(key, e)| (*key, e))
    }
}

/// Spring, damper, rotor or motor that a robot file defines.
#[derive(Clone, Debug)]
pub struct FileForceElement {
    /// Name of the element; for an input, its entry in `INPUTS`.
    pub name: Name,
    /// Sum of coordinates, length or wrench on which the element of a file acts.
    pub on: FileForceTarget,
    /// Force law of the element.
    pub law: FileForceLaw,
}

/// Target on which a force element of a robot file acts.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there are few of them, and they are not moved")]
pub enum FileForceTarget {
    /// Weighted sum of coordinates: joints with one coordinate each, and their weights.
    Sum(Vec<(Name, f64)>),
    /// Length that depends on the coordinates, such as that of a cable.
    Length(Expr),
    /// Force at a point and a torque. Their power per unit of the drive takes the place of the rate of a
    /// length; the length itself counts as zero.
    Wrench(Wrench),
}

/// A force at a point of a body and a torque on the body, per newton of the drive.
#[derive(Clone, Debug)]
pub struct Wrench {
    /// Point of action of the wrench, `body.at(vector)`.
    pub on: Expr,
    /// Force, in axes of the body, or of the body on which the reaction acts.
    pub force: [f64; 3],
    /// Torque of the wrench, in the axes of the force.
    pub torque: [f64; 3],
    /// Point on which the reaction acts; on the ground if absent.
    pub against: Option<Expr>,
}

impl FileForceTarget {
    /// Returns the target with all weights multiplied by a factor.
    pub fn with_scaled_weights(&self, factor: f64) -> FileForceTarget {
        match self {
            FileForceTarget::Sum(terms) => FileForceTarget::Sum(
                terms.iter().map(|(joint, weight)| (joint.clone(), weight * factor)).collect(),
            ),
            FileForceTarget::Length(e) if factor == 1.0 => FileForceTarget::Length(e.clone()),
            FileForceTarget::Length(e) => FileForceTarget::Length(Expr::binary_operation(
                BinaryOp::Mul,
                Expr::number_at(factor, &e.place),
                e.clone(),
            )),
            FileForceTarget::Wrench(wrench) => FileForceTarget::Wrench(Wrench {
                force: wrench.force.map(|x| x * factor),
                torque: wrench.torque.map(|x| x * factor),
                ..wrench.clone()
            }),
        }
    }

    /// Returns the joints of a sum with their weights; empty for other targets.
    pub fn weighted_joints(&self) -> &[(Name, f64)] {
        match self {
            FileForceTarget::Sum(terms) => terms,
            FileForceTarget::Length(_) | FileForceTarget::Wrench(_) => &[],
        }
    }
}

/// Quantity of a force element of a file that the element's own law contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileForceQuantity {
    /// Weighted sum of coordinates, or length, on which the element acts.
    Length,
    /// Rate of the weighted sum or length.
    Rate,
    /// Input of the element with this name.
    Input,
}

impl FileForceQuantity {
    /// Returns the name of the quantity in expressions. It begins with a control character, which no name in
    /// a file contains.
    pub fn file_force_quantity_name(self, drive: &str) -> String {
        let word = match self {
            FileForceQuantity::Length => "length",
            FileForceQuantity::Rate => "rate",
            FileForceQuantity::Input => "input",
        };
        format!("\u{1}{word} {drive}")
    }
}

/// Force law of a force element that a robot file defines.
#[derive(Clone, Debug)]
pub enum FileForceLaw {
    /// Force proportional to the difference from a free length.
    Spring {
        /// Stiffness of the spring.
        stiffness: f64,
        /// Value at which the force of the spring is zero.
        free: f64,
    },
    /// Force opposite to a polynomial of the excess beyond a range.
    Slack {
        /// Coefficients of the excess beyond the range, of its square and of its cube.
        stiffness: [f64; 3],
        /// Lower and upper end of the range without force.
        range: [f64; 2],
    },
    /// Force proportional and opposite to the velocity, with this coefficient.
    Damper(f64),
    /// Force opposite to the rate, with these coefficients of its magnitude, the square and the cube.
    PolynomialDamper([f64; 3]),
    /// Friction force of this magnitude opposite to the rate.
    Friction(f64),
    /// Force proportional and opposite to the acceleration, with this inertance.
    Inerter(f64),
    /// Constant force, N or N·m.
    Push(f64),
    /// Force given by an input; the value is the unit of the input.
    Input(&'static str),
    /// Force given by an expression of states, and of the quantities of this element and its inputs.
    Expression {
        /// Expression of the force.
        force: Box<Expr>,
        /// Contribution of locked joints to the length, which is constant.
        offset: f64,
    },
}

impl FileForceLaw {
    /// Returns the law of a spring with a polynomial force.
    pub fn polynomial_spring_law(stiffness: [f64; 3], free: f64) -> FileForceLaw {
        match stiffness {
            [stiffness, 0.0, 0.0] => FileForceLaw::Spring { stiffness, free },
            stiffness => FileForceLaw::Slack { stiffness, range: [free; 2] },
        }
    }

    /// Returns the law of a damper with a polynomial force.
    pub fn polynomial_damper_law(damping: [f64; 3]) -> FileForceLaw {
        match damping {
            [damping, 0.0, 0.0] => FileForceLaw::Damper(damping),
            damping => FileForceLaw::PolynomialDamper(damping),
        }
    }
}

/// Target on which a force element acts, as written.
#[derive(Clone, Debug)]
pub enum Target {
    /// One target: `joint`, `joint.coordinate`, `body`, `body.at(vector)`, `point`.
    On(Expr),
    /// Two points between which the element acts.
    Between(Expr, Expr),
}

impl Target {
    /// Returns the source position of the target.
    pub fn source_position_of_target(&self) -> &Place {
        match self {
            Target::On(e) | Target::Between(_, e) => &e.place,
        }
    }
}

impl Action {
    /// Returns the expression of the argument with a key, if it is present.
    pub fn expression_of_key(&self, key: Key) -> Option<&Expr> {
        self.arguments.expression_of_key(key)
    }

    /// Returns the argument that gives the force law, with its expression.
    pub fn written_law(&self) -> Option<(Key, &Expr)> {
        let laws = self.kind.row().laws;
        self.arguments.keyed_expressions().find(|(key, _)| laws.contains(key))
    }

    /// Whether the element is a force or a torque without a value: an input.
    pub fn is_input(&self) -> bool {
        self.kind.row().arguments.contains(&Key::Value) && self.expression_of_key(Key::Value).is_none()
    }
}
