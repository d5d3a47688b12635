//! Choice of the array dimensions with which the runtime computes the motion of a robot.

use crate::error::Error;
use crate::padded::{Padded, PaddedContacts};
use crate::robot::Robot;
use linkwork::Mechanism;

/// Visitor whose generic function is instantiated for the dimensions of a robot.
pub(crate) trait Visitor {
    /// Type of the visitor's result.
    type Output;

    /// Returns the result of the visitor for a robot, whose contacts are ignored.
    fn visit<const N: usize>(self, robot: &Padded<N, N, N, &Robot>) -> Self::Output;
}

/// Visitor whose generic function is instantiated for the dimensions of a robot with unilateral contacts.
pub(crate) trait ContactVisitor {
    /// Type of the visitor's result.
    type Output;

    /// Returns the result of the visitor for a robot with contacts.
    fn visit<M: Mechanism<N, N, N, Scalar = f64>, const N: usize>(self, robot: &M) -> Self::Output;
}

/// Maximum number of coordinates, velocities, inputs and constraints of a robot.
pub(crate) const LARGEST: usize = 64;
/// Maximum number of unilateral contacts of a robot.
pub(crate) const MOST_CONTACTS: usize = 64;

impl Robot {
    /// Returns the largest of the numbers of coordinates, velocities (including first-order states), inputs,
    /// and constraints.
    fn largest_dimension(&self) -> usize {
        let velocities = self.nv() + self.shared.states.len();
        [self.nq(), velocities, self.nu(), self.shared.constraints.names.len()]
            .into_iter()
            .fold(0, usize::max)
    }

    /// Whether the matrices of the runtime need more stack than threads usually have.
    pub(crate) fn needs_stack(&self) -> bool {
        self.largest_dimension() > 24 || self.shared.contacts.len() > 8
    }

    fn too_large(&self, what: &str, count: usize, most: usize) -> Error {
        let name = self.name();
        Error::Value(format!(
            "`{name}` has {count} {what}, but loaded mechanisms move with at most {most}: compile it in a \
             program of Rust, or export a library"
        ))
    }

    /// Calls a visitor with the robot padded to suitable array dimensions.
    pub(crate) fn visit_padded_robot<V: Visitor>(&self, visitor: V) -> Result<V::Output, Error> {
        match self.largest_dimension() {
            ..=8 => Ok(visitor.visit(&Padded::<8, 8, 8, _>::new(self)?)),
            9..=24 => Ok(visitor.visit(&Padded::<24, 24, 24, _>::new(self)?)),
            25..=LARGEST => Ok(visitor.visit(&Padded::<LARGEST, LARGEST, LARGEST, _>::new(self)?)),
            count => Err(self.too_large("coordinates, velocities, inputs or constraints", count, LARGEST)),
        }
    }

    /// Calls a visitor with the robot and its contacts, padded to suitable array dimensions.
    pub(crate) fn visit_contacts<V: ContactVisitor>(&self, visitor: V) -> Result<V::Output, Error> {
        let (count, rates) = (self.shared.contacts.len(), self.shared.contact_rates);
        let is_few = count <= 8 && rates <= 24;
        match self.largest_dimension() {
            ..=8 if is_few => Ok(visitor.visit(&PaddedContacts::<8, 8, 8, 8, 24, _>::new(self)?)),
            ..=24 if is_few => Ok(visitor.visit(&PaddedContacts::<24, 24, 24, 8, 24, _>::new(self)?)),
            ..=24 if count <= 32 => Ok(visitor.visit(&PaddedContacts::<24, 24, 24, 32, 96, _>::new(self)?)),
            ..=LARGEST if count <= 16 => {
                Ok(visitor.visit(&PaddedContacts::<LARGEST, LARGEST, LARGEST, 16, 48, _>::new(self)?))
            }
            ..=LARGEST if count <= MOST_CONTACTS => {
                Ok(visitor
                    .visit(&PaddedContacts::<LARGEST, LARGEST, LARGEST, MOST_CONTACTS, 192, _>::new(self)?))
            }
            ..=LARGEST => Err(self.too_large("contacts", count, MOST_CONTACTS)),
            count => Err(self.too_large("coordinates, velocities, inputs or constraints", count, LARGEST)),
        }
    }
}
