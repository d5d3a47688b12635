//! Data that all robots of one loaded mechanism share: functions and names.

use crate::about::About;
use crate::frames::Frames;
use crate::functions::Entry;
use crate::layout::Layout;
use crate::routine::Values;
use linkwork_compiler::catalogue::Argument;
use linkwork_compiler::mechanism::Chart;
use std::collections::HashMap;

/// Numbers of coordinates, velocities and inputs.
#[derive(Clone, Copy)]
pub(crate) struct Sizes {
    pub nq: usize,
    pub nv: usize,
    pub nu: usize,
}

impl Sizes {
    /// Returns the number of entries of an argument.
    pub fn length(&self, argument: Argument) -> usize {
        argument.length([self.nq, self.nv, self.nu])
    }
}

/// Name and unit of a coordinate, velocity, input or parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Name.
    pub name: String,
    /// Unit, for example `rad/s`; empty for a pure number.
    pub unit: String,
}

/// A condition on the parameters.
pub(crate) struct Requirement {
    pub rule: linkwork::__private::Rule,
    pub figure: String,
    pub parameters: Vec<String>,
    pub count: usize,
}

/// The scalar constraints of a mechanism.
#[derive(Default)]
pub(crate) struct Constraints {
    pub names: Vec<String>,
    /// Number of constraints on configurations, which come first.
    pub holonomic: usize,
    /// Group of each constraint; those of one group are components of one vector.
    pub groups: Vec<usize>,
    /// Indices of the constraints whose multipliers are normal forces of friction.
    pub slipping: Vec<usize>,
    /// Indices of the constraints that determine coordinates without inertia.
    pub determining: Vec<usize>,
    /// Number of independent constraints in regular configurations.
    pub rank: usize,
    /// Whether some constraints follow from others everywhere.
    pub overdetermined: bool,
    /// Whether accelerations are eliminated by pivots that are chosen in advance.
    pub independent: bool,
    /// Indices of the coordinates that are angles.
    pub angles: Vec<usize>,
}

/// A contact that opens and closes.
pub(crate) struct Contact {
    pub name: String,
    /// First row, and number of rows, in the contact velocities.
    pub rows: [usize; 2],
    /// Index of the contact whose normal force causes the friction: its own, except of friction moments.
    pub pressed_by: usize,
    /// Whether restitution is a ratio of impulses.
    pub of_impulses: bool,
}

/// A state of first order.
pub(crate) struct FirstOrder {
    /// Index among the parameters.
    pub parameter: usize,
    /// Index of the function that returns the rate of the state; `None` if it has none.
    pub rate: Option<usize>,
}

/// A loaded mechanism.
pub(crate) struct Shared {
    pub name: String,
    pub sizes: Sizes,
    pub configuration: Vec<Quantity>,
    pub velocities: Vec<Quantity>,
    pub inputs: Vec<Quantity>,
    pub parameters: Vec<Quantity>,
    /// Values of a file, NaN for parameters that have none.
    pub defaults: Vec<f64>,
    /// Names and numbers of variables of the tables.
    pub tables: Vec<(String, usize)>,
    /// Index in `v`, and which of the bounds are present, of each limit.
    pub limits: Vec<(usize, [bool; 4])>,
    pub requirements: Vec<Requirement>,
    pub equations: String,
    pub time: bool,
    /// Whether it has no inertia.
    pub kinematic: bool,
    /// Whether generalized speeds are declared.
    pub has_speeds: bool,
    /// Whether forces depend on accelerations.
    pub has_feedback: bool,
    pub constraints: Constraints,
    pub contacts: Vec<Contact>,
    /// Number of contact velocities.
    pub contact_rates: usize,
    pub states: Vec<FirstOrder>,
    pub charts: Vec<Chart>,
    pub frames: Frames,
    pub entries: Vec<Entry>,
    pub index: HashMap<String, usize>,
    /// Indices of the functions with methods.
    pub methods: Vec<Option<usize>>,
    /// Indices of the functions that the runtime calls.
    pub internal: Vec<Option<usize>>,
    pub about: About,
}

impl Shared {
    /// Returns the names of the functions, without those of frames.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let public = self.entries.iter().filter(|entry| !entry.hidden && !entry.name.contains('('));
        public.map(|entry| entry.name.as_str())
    }

    /// Evaluates a function with the arguments of another one, some of them replaced.
    pub fn call(
        &self,
        function: usize,
        values: Values<'_>,
        arguments: &[Argument],
        replaced: &[(Argument, &[f64])],
        out: &mut [f64],
        work: &mut [f64],
    ) {
        let entry = &self.entries[function];
        let mut inputs: [&[f64]; Layout::MOST] = [&[]; Layout::MOST];
        inputs[0] = values.inputs[0];
        for (input, argument) in inputs[1..].iter_mut().zip(&entry.arguments) {
            let position = || arguments.iter().position(|known| known == argument);
            *input = match replaced.iter().find(|(known, _)| known == argument) {
                Some((_, list)) => list,
                None => position().and_then(|at| values.inputs.get(1 + at)).copied().unwrap_or(&[]),
            };
        }
        let inputs = &inputs[..=entry.arguments.len()];
        entry.run(self, Values { inputs, ..values }, out, work);
    }

    /// Generates the machine code of a function and of those that it calls. Returns false if one of them is
    /// interpreted.
    pub fn prepare(&self, function: usize) -> bool {
        let plan = &self.entries[function].plan;
        // All are prepared, whether one before is interpreted or not.
        let interpreted = plan.calls().into_iter().filter(|k| !self.prepare(*k)).count();
        if let crate::functions::Plan::Frame(access, frame, routine) = plan {
            routine.ensure(|| self.frames.program(*access, *frame));
        }
        interpreted + plan.routines().into_iter().filter(|routine| !routine.prepare()).count() == 0
    }
}
