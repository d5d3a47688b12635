//! Data that all robots of one loaded mechanism share, such as functions and names.

use crate::about::MechanismDocumentation;
use crate::frames::Frames;
use crate::functions::LoadedFunction;
use crate::layout::InputLayout;
use crate::polytopes::Polytopes;
use crate::routine::Values;
use crate::separate::SeparateContacts;
use linkwork_compiler::catalogue::Argument;
use linkwork_compiler::mechanism::{Chart, ContactVelocityDependence};
use std::collections::HashMap;

/// Numbers of configuration coordinates, velocities and inputs of a mechanism.
#[derive(Clone, Copy)]
pub(crate) struct Sizes {
    pub nq: usize,
    pub nv: usize,
    pub nu: usize,
}

impl Sizes {
    /// Returns the number of entries that an argument has for a mechanism of these sizes.
    pub fn length(&self, argument: Argument) -> usize {
        argument.argument_length([self.nq, self.nv, self.nu])
    }
}

/// Name and unit of a coordinate, velocity, input or parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Name of the coordinate, velocity, input or parameter.
    pub name: String,
    /// Unit of the coordinate, velocity, input or parameter, for example `rad/s`; empty for a pure number.
    pub unit: String,
}

/// Condition that the parameters of a mechanism must satisfy.
pub(crate) struct ParameterRequirement {
    pub rule: linkwork::__private::Rule,
    pub figure: String,
    pub parameters: Vec<String>,
    pub count: usize,
}

/// Names, numbers and groups of the scalar constraints of a loaded mechanism.
#[derive(Default)]
pub(crate) struct Constraints {
    pub names: Vec<String>,
    /// Number of holonomic constraints, which restrict configurations and come first.
    pub holonomic: usize,
    /// Group of each constraint. Constraints in one group are components of one vector equation.
    pub groups: Vec<usize>,
    /// Indices of the constraints of sliding contacts, whose multipliers are normal forces on which friction
    /// depends.
    pub slipping: Vec<usize>,
    /// Indices of the constraints that determine coordinates without inertia.
    pub determining: Vec<usize>,
    /// Number of independent constraints in nonsingular configurations.
    pub rank: usize,
    /// Numbers of independent coordinates and velocities.
    pub freedom: [usize; 2],
    /// Whether some constraints are redundant in every configuration.
    pub overdetermined: bool,
    /// Whether the elimination for the accelerations has pivots that are chosen in advance.
    pub independent: bool,
    /// Indices of the configuration coordinates that are angles.
    pub angles: Vec<usize>,
}

/// Unilateral contact of a loaded mechanism.
pub(crate) struct Contact {
    pub name: String,
    /// First row, and number of rows, in the contact velocities.
    pub rows: [usize; 2],
    /// Index of the contact whose normal force bounds the friction of this contact: its own, except for
    /// friction moments.
    pub pressed_by: usize,
    /// Whether the restitution coefficient is a ratio of impulses instead of velocities.
    pub of_impulses: bool,
    /// Velocities on which its contact velocities depend.
    pub dependence: ContactVelocityDependence,
}

/// First-order state of a loaded mechanism.
pub(crate) struct FirstOrderState {
    /// Index of the state among the parameters.
    pub parameter: usize,
    /// Index of the function that returns the rate of the state; `None` if it has none.
    pub rate: Option<usize>,
}

/// Loaded mechanism: the data that all its robots share.
pub(crate) struct SharedMechanism {
    pub name: String,
    pub sizes: Sizes,
    pub configuration: Vec<Quantity>,
    pub velocities: Vec<Quantity>,
    pub inputs: Vec<Quantity>,
    pub parameters: Vec<Quantity>,
    /// Default values of the parameters from a robot file, NaN for parameters that have none.
    pub defaults: Vec<f64>,
    /// Names of the interpolation tables, and their numbers of variables.
    pub tables: Vec<(String, usize)>,
    /// For each limit, the index of its velocity in `v`, and which of the four bounds are present.
    pub limits: Vec<(usize, [bool; 4])>,
    pub requirements: Vec<ParameterRequirement>,
    pub equations: String,
    pub time: bool,
    /// Whether the mechanism has no inertia, only kinematics.
    pub kinematic: bool,
    /// Whether the mechanism declares generalized speeds.
    pub has_speeds: bool,
    /// Whether forces of the mechanism depend on accelerations.
    pub has_feedback: bool,
    pub constraints: Constraints,
    pub contacts: Vec<Contact>,
    /// Contacts that are mechanisms of their own. If there are any, these are all contacts.
    pub separate: SeparateContacts,
    /// Number of contact velocities of all contacts.
    pub contact_rates: usize,
    pub polytopes: Polytopes,
    pub states: Vec<FirstOrderState>,
    pub charts: Vec<Chart>,
    pub frames: Frames,
    pub entries: Vec<LoadedFunction>,
    pub index: HashMap<String, usize>,
    /// Indices of the functions that have methods of `Robot`; `None` for absent functions.
    pub methods: Vec<Option<usize>>,
    /// Indices of the functions that the runtime calls.
    pub internal: Vec<Option<usize>>,
    pub about: MechanismDocumentation,
}

impl SharedMechanism {
    /// Returns the names of the public functions, except functions of frames.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let public = self.entries.iter().filter(|entry| !entry.hidden && !entry.name.contains('('));
        public.map(|entry| entry.name.as_str())
    }

    /// Evaluates a function that another function calls. It receives the arguments of the caller, some of
    /// them replaced.
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
        let mut lists: [&[f64]; InputLayout::MOST] = [&[]; InputLayout::MOST];
        for (list, argument) in lists.iter_mut().zip(&entry.arguments) {
            let index_of_argument = || arguments.iter().position(|known| known == argument);
            *list = match replaced.iter().find(|(known, _)| known == argument) {
                Some((_, list)) => list,
                None => index_of_argument().and_then(|at| values.arguments.get(at)).copied().unwrap_or(&[]),
            };
        }
        let arguments = &lists[..entry.arguments.len()];
        entry.run(self, Values { arguments, ..values }, out, work);
    }

    /// Compiles a function and the functions that it calls to machine code. Returns false if one of them is
    /// interpreted.
    pub fn compile_with_called_functions(&self, function: usize) -> bool {
        let plan = &self.entries[function].plan;
        // All are prepared, whether one before is interpreted or not.
        let interpreted = plan
            .called_function_indices()
            .into_iter()
            .filter(|k| !self.compile_with_called_functions(*k))
            .count();
        if let crate::functions::ResultAssembly::Frame(access, frame, routine) = plan {
            routine.build_program_once(|| self.frames.program(*access, *frame));
        }
        interpreted + plan.routines().into_iter().filter(|routine| !routine.compile_once()).count() == 0
    }
}
