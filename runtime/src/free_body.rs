//! Free-body diagrams as data: all forces and torques on a body. An output of the type
//! [`FreeBody`](crate::elements::FreeBody) returns a diagram; the crate `linkwork-view` draws it.

use crate::Real;
use nalgebra::SVector;

/// Kind of an action in a free-body diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The action is the weight of the body in uniform gravity, at the centre of mass.
    Gravity,
    /// The action is the force of a force element: a spring, a dashpot, a force or torque with a given value,
    /// an energy.
    Element,
    /// The action is the force or torque of an input.
    Input,
    /// The action is the force and torque of a joint: its constraint forces, plus the forces on its own
    /// coordinates.
    Joint,
    /// The action is the force of a constraint, such as rolling, including the friction of a sliding contact
    /// constraint.
    Constraint,
    /// The action is the force of a unilateral contact, zero if the surfaces are separated. A stop on a
    /// joint's own coordinate is included in the action of the joint.
    Contact,
}

/// A force and a torque on a body. Vectors are in the axes of the diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Action<T> {
    /// Name of the force element, input, joint, constraint or contact that acts on the body.
    pub name: &'static str,
    /// Kind of the action: gravity, force element, input, joint, constraint or contact.
    pub origin: Origin,
    /// Point of application, relative to the body's centre of mass, m.
    pub point: SVector<T, 3>,
    /// Force of the action on the body, N.
    pub force: SVector<T, 3>,
    /// Torque of the action about its point of application, N·m.
    pub torque: SVector<T, 3>,
}

impl<T: Real> Action<T> {
    /// Returns the torque about a point `r` relative to the centre of mass, m: `T + (p − r) × F`, N·m.
    #[must_use]
    pub fn torque_about(&self, r: &SVector<T, 3>) -> SVector<T, 3> {
        self.torque + (self.point - r).cross(&self.force)
    }
}

/// Free-body diagram of a body during the motion of the mechanism: the `N` actions of gravity, force
/// elements, inputs, joints, constraints and contacts. By the Newton–Euler equations, the sum of the forces
/// is `m a_C`, and the sum of the torques about the centre of mass is the rate `Ḣ_C` of the angular momentum,
/// for the body together with all bodies fixed to it.
///
/// For mechanisms with unilateral [contacts](crate::contact), the function of an output `loads` returns a
/// `Result`: the diagram with the contact forces of this state ([`contact::acting`](crate::contact::acting)).
/// A second function, `loads_under(q, v, u, forces)`, takes the contact forces as an argument, in the order
/// of `CONTACT_ROWS`: those of a step ([`contact::forces`](crate::contact::forces)), or of contacts enforced
/// as bilateral constraints ([`contact::forward_dynamics`](crate::contact::forward_dynamics)).
///
/// ```
/// use linkwork::free_body::Origin;
/// use linkwork::prelude::*;
///
/// /// A rod on a pin, held level by a spring at its end.
/// #[mechanism(gravity = -9.81 * y)]
/// struct Flap {
///     pub stiffness: f64,
///     #[body(mass = 2, com = 0.5 * x, inertia = rod(2, 1, x))]
///     flap: Body,
///     #[joint(ground -> flap, about = z)]
///     hinge: Pin,
///     #[acts(between = (ground.at(x + 0.5 * y), flap.at(x)), stiffness = stiffness)]
///     stay: Spring,
///     #[output(flap)]
///     loads: FreeBody,
/// }
///
/// // The stay supports half of the weight, the hinge the other half.
/// let flap = Flap { stiffness: 9.81 / 0.5 };
/// let loads = flap.loads(&[0.0].into(), &[0.0].into());
/// let names: Vec<&str> = loads.actions.iter().map(|action| action.name).collect();
/// assert_eq!(names, ["gravity", "stay", "hinge"]);
/// let [gravity, stay, hinge] = loads.actions;
/// assert_eq!((gravity.origin, stay.origin, hinge.origin), (Origin::Gravity, Origin::Element, Origin::Joint));
/// assert!((gravity.force[1] + 2.0 * 9.81).abs() < 1e-12);
/// assert!((stay.force[1] - 9.81).abs() < 1e-12 && (hinge.force[1] - 9.81).abs() < 1e-12);
/// assert!((stay.point[0] - 0.5).abs() < 1e-15 && (hinge.point[0] + 0.5).abs() < 1e-15);
/// assert!(loads.force().norm() < 1e-12 && loads.torque().norm() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diagram<T, const N: usize> {
    /// Name of the body that the diagram shows.
    pub body: &'static str,
    /// Forces and torques that act on the body.
    pub actions: [Action<T>; N],
}

impl<T: Real, const N: usize> Diagram<T, N> {
    /// Returns the diagram from the names of the actions and nine numbers for each: point, force, torque.
    /// Missing numbers are zero.
    #[must_use]
    pub fn new(body: &'static str, names: [(&'static str, Origin); N], numbers: &[T]) -> Self {
        let mut parts = numbers.chunks(3);
        let mut next_vector = || {
            let part = parts.next().unwrap_or(&[]);
            SVector::<T, 3>::from_fn(|k, _| part.get(k).copied().unwrap_or(T::zero()))
        };
        let actions = names.map(|(name, origin)| {
            let (point, force, torque) = (next_vector(), next_vector(), next_vector());
            Action { name, origin, point, force, torque }
        });
        Self { body, actions }
    }

    /// Returns the sum of all forces, N: `m a_C`.
    #[must_use]
    pub fn force(&self) -> SVector<T, 3> {
        self.actions.iter().fold(SVector::zeros(), |sum, action| sum + action.force)
    }

    /// Returns the sum of all torques about the centre of mass, N·m: the rate of the angular momentum about
    /// it.
    #[must_use]
    pub fn torque(&self) -> SVector<T, 3> {
        self.torque_about(&SVector::zeros())
    }

    /// Returns the sum of all torques about a point `r` relative to the centre of mass, N·m.
    #[must_use]
    pub fn torque_about(&self, r: &SVector<T, 3>) -> SVector<T, 3> {
        self.actions.iter().fold(SVector::zeros(), |sum, action| sum + action.torque_about(r))
    }

    /// Returns the action with this name, if any.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Action<T>> {
        self.actions.iter().find(|action| action.name == name)
    }
}
