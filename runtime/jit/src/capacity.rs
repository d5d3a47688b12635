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
const LARGEST: usize = 256;
/// Maximum number of unilateral contacts that take part in a step.
const MOST_CONTACTS: usize = 128;
/// Maximum number of unilateral contacts that take part in a step of a robot with separate contacts.
const MOST_SEPARATE_CONTACTS: usize = 384;
/// Number of coordinates, velocities, inputs and constraints beyond which matrices have [`LARGEST`] rows.
const MEDIUM: usize = 72;

/// Stack size of the thread on which robots of at most [`MEDIUM`] coordinates are simulated, bytes.
const STACK: usize = 64 << 20;
/// Stack size of the thread for larger robots, whose matrices have 0.5 MiB each, bytes.
const LARGE_STACK: usize = if cfg!(target_pointer_width = "64") { 1 << 30 } else { 256 << 20 };

/// Runs a function on a thread with a stack of this size, and waits for it.
fn run_with_stack_size<T: Send>(
    size: usize,
    run: impl FnOnce() -> Result<T, Error> + Send,
) -> Result<T, Error> {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("linkwork".to_string()).stack_size(size);
        let thread = thread.spawn_scoped(scope, run).map_err(|error| Error::Internal(error.to_string()))?;
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

impl Robot {
    /// Returns the largest of the numbers of coordinates, velocities (including first-order states), inputs,
    /// and constraints.
    fn largest_dimension(&self) -> usize {
        let velocities = self.nv() + self.shared.states.len();
        [self.nq(), velocities, self.nu(), self.shared.constraints.names.len()]
            .into_iter()
            .fold(0, usize::max)
    }

    /// Runs a simulation, on a thread of its own if its matrices need more stack than threads usually have.
    pub(crate) fn run_with_sufficient_stack(
        &self,
        run: impl FnOnce() -> Result<(), Error> + Send,
    ) -> Result<(), Error> {
        match self.largest_dimension() > 24 || self.shared.contacts.len() > 8 {
            true => run_with_stack_size(STACK, run),
            false => run(),
        }
    }

    fn capacity_error(&self, what: &str, count: usize, most: usize) -> Error {
        let name = self.name();
        Error::Value(format!(
            "`{name}` has {count} {what}, but loaded mechanisms move with at most {most}: compile it in a \
             program of Rust, or export a library"
        ))
    }

    /// Calls a visitor with the robot padded to suitable array dimensions.
    pub(crate) fn visit_padded_robot<V>(&self, visitor: V) -> Result<V::Output, Error>
    where
        V: Visitor<Output: Send> + Send,
    {
        match self.largest_dimension() {
            ..=8 => Ok(visitor.visit(&Padded::<8, 8, 8, _>::new(self)?)),
            9..=24 => Ok(visitor.visit(&Padded::<24, 24, 24, _>::new(self)?)),
            25..=MEDIUM => Ok(visitor.visit(&Padded::<MEDIUM, MEDIUM, MEDIUM, _>::new(self)?)),
            count if count <= LARGEST => run_with_stack_size(LARGE_STACK, || {
                Ok(visitor.visit(&Padded::<LARGEST, LARGEST, LARGEST, _>::new(self)?))
            }),
            count => {
                Err(self.capacity_error("coordinates, velocities, inputs or constraints", count, LARGEST))
            }
        }
    }

    /// Calls a visitor with the robot and its contacts, padded to suitable array dimensions.
    pub(crate) fn visit_padded_robot_with_contacts<V>(&self, visitor: V) -> Result<V::Output, Error>
    where
        V: ContactVisitor<Output: Send> + Send,
    {
        // Of separate contacts only those that are near each other need entries.
        let (count, rates) = match self.shared.separate.is_empty() {
            true => (self.shared.contacts.len(), self.shared.contact_rates),
            false => (MOST_CONTACTS, 3 * MOST_CONTACTS),
        };
        let is_few = count <= 8 && rates <= 24;
        match self.largest_dimension() {
            _ if count > MOST_CONTACTS => Err(self.capacity_error("contacts", count, MOST_CONTACTS)),
            ..=8 if is_few => Ok(visitor.visit(&PaddedContacts::<8, 8, 8, 8, 24, _>::new(self)?)),
            ..=24 if is_few => Ok(visitor.visit(&PaddedContacts::<24, 24, 24, 8, 24, _>::new(self)?)),
            ..=24 if count <= 32 => Ok(visitor.visit(&PaddedContacts::<24, 24, 24, 32, 96, _>::new(self)?)),
            ..=MEDIUM => {
                Ok(visitor
                    .visit(&PaddedContacts::<MEDIUM, MEDIUM, MEDIUM, MOST_CONTACTS, 384, _>::new(self)?))
            }
            count if count <= LARGEST => run_with_stack_size(LARGE_STACK, || {
                Ok(visitor.visit(&PaddedContacts::<
                    LARGEST,
                    LARGEST,
                    LARGEST,
                    MOST_SEPARATE_CONTACTS,
                    { 3 * MOST_SEPARATE_CONTACTS },
                    _,
                >::new(self)?))
            }),
            count => {
                Err(self.capacity_error("coordinates, velocities, inputs or constraints", count, LARGEST))
            }
        }
    }
}
