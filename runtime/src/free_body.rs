//! Free-body diagrams: all that acts on a body at once, as data. An output of the type [`FreeBody`](crate::elements::FreeBody) gives
//! one; the crate `linkwork-view` draws it.

use crate::Real;
use nalgebra::SVector;

/// What an action of a free-body diagram comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Uniform gravity, at the centre of mass.
    Gravity,
    /// A force element: a spring, a dashpot, a force or torque with a value, an energy.
    Element,
    /// An input.
    Input,
    /// A joint: its constraint forces, with the forces of what acts on its own coordinates.
    Joint,
    /// A constraint, such as rolling, with the friction of a slipping one.
    Constraint,
    /// A contact that opens and closes: nothing where it is open. A stop on a joint's own coordinate is with its joint.
    Contact,
}

/// A force and a torque on a body. Vectors are in the axes of the diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Action<T> {
    /// Name of the element, joint or constraint.
    pub name: &'static str,
    /// What that is.
    pub origin: Origin,
    /// Where it acts, from the body's centre of mass, m.
    pub point: SVector<T, 3>,
    /// The force, N.
    pub force: SVector<T, 3>,
    /// The torque about the point, N·m.
    pub torque: SVector<T, 3>,
}

impl<T: Real> Action<T> {
    /// The torque about a point that is given from the centre of mass, m: `T + (p − r) × F`, N·m.
    #[must_use]
    pub fn torque_about(&self, r: &SVector<T, 3>) -> SVector<T, 3> {
        self.torque + (self.point - r).cross(&self.force)
    }
}

/// All that acts on a body, in the motion of the mechanism: gravity, force elements, inputs, joints, constraints and contacts, `N`
/// actions.
/// By the equations of Newton and Euler their sum is `m a_C`, and about the centre of mass the rate of the angular momentum
/// `Ḣ_C`, of the body with all that is fixed on it.
///
/// Beside [contacts](crate::contact) that open and close the function of an output `loads` gives a `Result`: the diagram under the
/// forces that contacts exert in this state ([`contact::acting`](crate::contact::acting)). A second function,
/// `loads_under(q, v, u, forces)`, takes these forces, in the order of `CONTACT_ROWS`: those of a step
/// ([`contact::forces`](crate::contact::forces)), or of contacts that are taken to hold
/// ([`contact::forward_dynamics`](crate::contact::forward_dynamics)).
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
/// // The stay carries half of the weight, the hinge the other half.
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
    /// Name of the body.
    pub body: &'static str,
    /// What acts on it.
    pub actions: [Action<T>; N],
}

impl<T: Real, const N: usize> Diagram<T, N> {
    /// The diagram from the names of the actions and nine numbers for each: point, force, torque. Numbers that are not given are
    /// zero.
    #[must_use]
    pub fn new(body: &'static str, names: [(&'static str, Origin); N], numbers: &[T]) -> Self {
        let mut parts = numbers.chunks(3);
        let mut vector = || {
            let part = parts.next().unwrap_or(&[]);
            SVector::<T, 3>::from_fn(|k, _| part.get(k).copied().unwrap_or(T::zero()))
        };
        let actions = names.map(|(name, origin)| {
            let (point, force, torque) = (vector(), vector(), vector());
            Action { name, origin, point, force, torque }
        });
        Self { body, actions }
    }

    /// The sum of all forces, N: `m a_C`.
    #[must_use]
    pub fn force(&self) -> SVector<T, 3> {
        self.actions.iter().fold(SVector::zeros(), |sum, action| sum + action.force)
    }

    /// The sum of all torques about the centre of mass, N·m: the rate of the angular momentum about it.
    #[must_use]
    pub fn torque(&self) -> SVector<T, 3> {
        self.torque_about(&SVector::zeros())
    }

    /// The sum of all torques about a point that is given from the centre of mass, N·m.
    #[must_use]
    pub fn torque_about(&self, r: &SVector<T, 3>) -> SVector<T, 3> {
        self.actions.iter().fold(SVector::zeros(), |sum, action| sum + action.torque_about(r))
    }

    /// The action of this name, if there is one.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Action<T>> {
        self.actions.iter().find(|action| action.name == name)
    }
}
