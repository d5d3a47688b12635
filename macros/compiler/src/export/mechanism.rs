//! Interface of a mechanism outside Rust: its names, its sizes, and the functions that exist there.

use super::handwritten::{METHODS, callable_function_signatures};
use super::names;
use super::signatures::{ExportedSignature, reaction_name};
use crate::catalogue::{Argument, CalledFunction, GeneratedId, REACTION, Shape, TOUCHED};
use crate::derive::{DerivationOutput, Function};
use crate::lower::{Op, Operand, Program};
use crate::mechanism::{Chart, Model, SuppliedQuantity};

/// Options of an export.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Prefix of all names. If it is empty, the mechanism's name in lower case is used.
    pub prefix: String,
    /// Whether the code computes in single precision.
    pub single: bool,
    /// Whether results must have the same bits with every compiler and mathematical library.
    pub reproducible: bool,
    /// Parameters to fix in an additional source file with CasADi's interface; `None` for no such file.
    pub casadi: Option<Vec<(String, f64)>>,
    /// Further functions that exist in Rust only, with reasons.
    pub left_out: Vec<String>,
}

/// Reason why a mechanism cannot be exported.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExportObstacle {
    /// The results of this element or option differ from those in Rust by rounding.
    Irreproducible(&'static str),
    /// The mechanism declares generalized speeds, but CasADi's functions take joint velocities.
    CasadiSpeeds,
    /// The named program contains SIMD lanes, which the exported code does not support.
    Lanes(String),
    /// A program reads a value that its function does not have, or has another number of results.
    Missing,
    /// The parameter that the options fix does not exist.
    NoParameter(String),
    /// CasADi is requested with single precision, which it does not support.
    SingleCasadi,
}

/// Names, sizes and functions of an exported mechanism.
pub struct ExportedMechanism<'a> {
    /// Mechanism that is exported.
    pub model: &'a Model<'a>,
    /// Functions of the mechanism in Rust.
    pub output: &'a DerivationOutput,
    /// Prefix of all names.
    pub prefix: String,
    /// Members of the parameter struct.
    pub parameters: Vec<String>,
    /// Members of the parameter struct that are tables.
    pub tables: Vec<String>,
    /// Derived functions that a program can call.
    pub public: Vec<&'a Function>,
    /// Derived functions that only other functions call, in the order of their definitions.
    pub hidden: Vec<&'a Function>,
    /// Output functions that contain reactions.
    pub reactions: Vec<&'a Function>,
    /// Function that returns the limits of the joints, if there is one.
    pub limits: Option<&'a Function>,
    /// Whether integration steps exist. Mechanisms with constraints or contacts have none.
    pub has_steps: bool,
    /// Whether the Jacobians of the integration steps exist.
    pub has_transitions: bool,
    /// Signatures of all functions that a program can call.
    pub functions: Vec<ExportedSignature>,
    /// Functions that exist in Rust only, with reasons.
    pub left_out: Vec<String>,
}

impl<'a> ExportedMechanism<'a> {
    /// Determines the interface of a mechanism; `tables` are the names of its tables.
    ///
    /// # Errors
    /// A program contains SIMD lanes.
    pub fn new(
        model: &'a Model<'a>,
        output: &'a DerivationOutput,
        tables: &[String],
        options: &Options,
    ) -> Result<ExportedMechanism<'a>, ExportObstacle> {
        reject_vector_lanes(output)?;
        let prefix = match options.prefix.as_str() {
            "" => names::c_name_prefix(&names::to_snake_case(&model.name)),
            given => names::c_name_prefix(given),
        };
        let shared: Vec<&String> = model.parameters.iter().chain(tables).collect();
        let mut parameters = names::unique_identifiers(&shared);
        let tables = parameters.split_off(model.parameters.len());
        let mut interface = ExportedMechanism {
            model,
            output,
            prefix,
            parameters,
            tables,
            public: Vec::new(),
            hidden: Vec::new(),
            reactions: Vec::new(),
            limits: None,
            has_steps: false,
            has_transitions: false,
            functions: Vec::new(),
            left_out: Vec::new(),
        };
        output.functions.iter().for_each(|f| interface.add_function_to_group(f));
        // A static function must precede its callers, and must have one.
        interface.hidden.sort_by_key(|f| f.id == GeneratedId::AccelerationsAndInverse);
        if !output.functions.iter().any(|f| matches!(f.shape, Shape::ForwardDerivativesByCalls(_))) {
            interface.hidden.retain(|f| f.id != GeneratedId::AccelerationsAndInverse);
        }
        interface.determine_available_integration_steps(options.reproducible);
        interface.left_out.extend(options.left_out.iter().cloned());
        interface.functions = callable_function_signatures(&interface);
        Ok(interface)
    }

    /// Adds a function to the group in which it is exported, or to those that exist in Rust only.
    fn add_function_to_group(&mut self, f: &'a Function) {
        let function_name_without_prefix = |prefix: &str| f.name.strip_prefix(prefix).unwrap_or_default();
        let is_contact_force =
            |a: &Argument| matches!(a, Argument::Given(_, SuppliedQuantity::ContactForces, _));
        let (has_frames, has_derivatives) = (!self.output.frames.is_empty(), self.has_derivatives());
        match f.id {
            _ if f.reads_results_of(CalledFunction::ContactFeatures) => {
                if !f.is_hidden() {
                    self.left_out.push(format!("{}: contacts of polytopes with each other", f.name));
                }
            }
            GeneratedId::PolytopePoses => {}
            GeneratedId::RateMatrix if has_frames || has_derivatives => self.hidden.push(f),
            GeneratedId::RateAccelerations if has_frames => self.hidden.push(f),
            GeneratedId::SpeedMatrix | GeneratedId::RateChanges if has_derivatives => self.hidden.push(f),
            GeneratedId::PassiveForces
            | GeneratedId::PassiveDerivatives
            | GeneratedId::AccelerationsAndInverse => self.hidden.push(f),
            GeneratedId::Reaction if f.arguments.iter().any(is_contact_force) => {
                self.left_out.push(format!(
                    "{}: a free-body diagram under contact forces",
                    function_name_without_prefix(REACTION)
                ));
            }
            GeneratedId::Reaction if self.find_derived_function(GeneratedId::ForwardDynamics).is_some() => {
                self.reactions.push(f)
            }
            GeneratedId::Reaction => self
                .left_out
                .push(format!("{}: a reaction under constraints", function_name_without_prefix(REACTION))),
            GeneratedId::Limits => self.limits = Some(f),
            // Variants that write to matrices of the caller: all exported functions do so.
            GeneratedId::InverseDynamicsDerivativesInto
            | GeneratedId::ForwardDynamicsDerivativesInto
            | GeneratedId::MassMatrixInto => {}
            GeneratedId::ContactDerivatives | GeneratedId::ContactDerivativesByParameters => {}
            GeneratedId::Figures | GeneratedId::ConstraintCurvature | GeneratedId::ConstraintResponse => {}
            GeneratedId::SlippingResponse => {}
            GeneratedId::ConstrainedDynamics => self.left_out.push(
                "forward_dynamics, assemble and the other functions that solve for constraint forces"
                    .to_string(),
            ),
            GeneratedId::ContactGaps => {
                let line = "time steps with impacts; gap functions, contact velocities and their Jacobian \
                            are available";
                self.left_out.push(line.to_string());
                self.public.push(f);
            }
            GeneratedId::Touched => {
                self.left_out.push(format!("{}: forces at contacts", function_name_without_prefix(TOUCHED)))
            }
            GeneratedId::ContactLaws | GeneratedId::InputDerivatives | GeneratedId::MotionDerivatives => {
                self.public.push(f)
            }
            _ if f.is_hidden() || matches!(f.shape, Shape::Record(_)) => {}
            _ => self.public.push(f),
        }
    }

    /// Determines whether integration steps and their Jacobians exist.
    fn determine_available_integration_steps(&mut self, reproducible: bool) {
        let is_taken = self.output.functions.iter().any(|f| {
            let method = f.name.strip_suffix("_step").or(f.name.strip_suffix("_transition"));
            method.is_some_and(|method| METHODS.iter().any(|(known, _)| *known == method))
        });
        self.has_steps = self.find_derived_function(GeneratedId::ForwardDynamics).is_some()
            && self.model.contacts.is_empty()
            && !is_taken
            && self.nv() > 0;
        self.has_transitions = self.has_steps
            && self.has_derivatives()
            && self.find_derived_function(GeneratedId::ForwardDynamicsDerivatives).is_some();
        if reproducible && std::mem::take(&mut self.has_transitions) {
            let line =
                "rk4_transition and semi_implicit_euler_transition: their bits would not be those of Rust";
            self.left_out.push(line.to_string());
        }
    }

    /// Returns the derived function with an identifier.
    pub fn find_derived_function(&self, id: GeneratedId) -> Option<&'a Function> {
        self.output.functions.iter().find(|f| f.id == id)
    }

    /// Returns the signature of a function by its name.
    pub fn signature(&self, name: &str) -> Option<&ExportedSignature> {
        self.functions.iter().find(|f| f.name == name)
    }

    /// Returns the number of configuration coordinates, `NQ`.
    pub fn nq(&self) -> usize {
        self.model.nq()
    }

    /// Returns the number of velocities, `NV`.
    pub fn nv(&self) -> usize {
        self.model.nv()
    }

    /// Returns the number of inputs, `NU`.
    pub fn nu(&self) -> usize {
        self.model.nu()
    }

    /// Returns true if functions take the parameter struct as their first argument.
    pub fn takes_parameter_struct(&self) -> bool {
        !(self.parameters.is_empty() && self.tables.is_empty())
    }

    /// Returns true if functions for the derivatives of the dynamics are exported.
    pub fn has_derivatives(&self) -> bool {
        self.find_derived_function(GeneratedId::InputDerivatives).is_some()
    }

    /// Returns true if the velocities are declared generalized speeds.
    pub fn has_generalized_speeds(&self) -> bool {
        self.model.speeds.is_some()
    }

    /// Returns true if all joints have plain coordinates.
    pub fn has_only_plain_coordinates(&self) -> bool {
        self.output.charts.iter().all(|chart| matches!(chart, Chart::Plain(..)))
    }

    /// Returns the names of the functions for outputs.
    pub fn output_names(&self) -> Vec<String> {
        let own = self.public.iter().filter(|f| f.id == GeneratedId::Output).map(|f| f.name.as_str());
        own.chain(self.reactions.iter().map(|f| reaction_name(f)))
            .map(names::replace_invalid_characters)
            .collect()
    }

    /// Returns the names of the frames, as parts of constants and as in the mechanism.
    pub fn frame_names(&self) -> Vec<(String, String)> {
        let names: Vec<String> = self.model.frames.iter().map(|frame| frame.name.clone()).collect();
        names::unique_constant_suffixes(&names).into_iter().zip(names).collect()
    }

    /// Returns the names of the arguments of the function for the forces of inputs, except time.
    pub fn input_force_argument_names(&self) -> &'static [&'static str] {
        if self.model.velocity_inputs { &["q", "v", "u"] } else { &["q", "u"] }
    }

    /// Returns the call of a function. Parameters and time are added to the arguments.
    pub fn function_call_text(&self, name: &str, arguments: &[&str]) -> String {
        let own = self.takes_parameter_struct().then_some("self");
        let time = self.model.time.then_some("t");
        let list: Vec<&str> = own.into_iter().chain(time).chain(arguments.iter().copied()).collect();
        format!("{}_{name}({})", self.prefix, list.join(", "))
    }
}

/// Returns true if output `k` of a function is always zero.
pub fn is_zero_output(f: &Function, k: usize) -> bool {
    f.program.outputs.get(k).is_none_or(|o| *o == Operand::Const(0.0))
}

/// Returns an error if a program contains vector lanes, which exported code cannot have.
fn reject_vector_lanes(output: &DerivationOutput) -> Result<(), ExportObstacle> {
    let is_lane_operation = |op: &Op| matches!(op, Op::Sum(..) | Op::Lane(..) | Op::Join(..));
    let contains_vector_lanes = |program: &Program| {
        program.instructions.iter().any(is_lane_operation)
            || !program.gathers.is_empty()
            || !program.tuples.is_empty()
    };
    let steps = output.links.iter().flat_map(|l| [&l.placement, &l.twist, &l.acceleration, &l.columns]);
    let steps = steps.chain(output.frames.iter().flat_map(|f| [&f.placement, &f.twist, &f.acceleration]));
    let all = output.functions.iter().map(|f| (f.name.as_str(), &f.program));
    match all
        .chain(steps.map(|program| ("frames", program)))
        .find(|(_, program)| contains_vector_lanes(program))
    {
        Some((name, _)) => Err(ExportObstacle::Lanes(name.to_string())),
        None => Ok(()),
    }
}
