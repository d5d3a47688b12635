//! Functions: their signatures, and the assignment of program outputs to results.

use super::body::{Scope, write_program};
use super::composed;
use super::docs;
use super::names::replace_invalid_characters;
use super::support::Support;
use crate::catalogue::{Argument, Called, Id, Shape};
use crate::derive::Function;
use crate::lower::Operand;
use std::fmt::Write;

/// Sizes and names that all exported C functions share.
pub struct Outline<'a> {
    /// Prefix of all names of the mechanism in C.
    pub prefix: String,
    /// Members of the C parameter struct; empty if the mechanism has no parameters.
    pub parameters: &'a [String],
    /// Members of the parameter struct that are tables.
    pub tables: &'a [String],
    /// Number of configuration coordinates, `NQ`.
    pub nq: usize,
    /// Number of velocities, `NV`.
    pub nv: usize,
    /// Number of inputs, `NU`.
    pub nu: usize,
    /// Whether functions take time as their first argument.
    pub time: bool,
    /// Number of passive forces that other functions call, and number of their derivatives.
    pub passive: [usize; 2],
    /// Whether functions for the derivatives of the dynamics are exported.
    pub derivatives: bool,
    /// Whether the velocities are declared generalized speeds.
    pub speeds: bool,
}

/// Result array of a C function: name, rows and columns.
pub type Given = (&'static str, usize, usize);

/// Returns the arrays that receive the results of a function; empty for a function that returns a number.
pub fn result_arrays(shape: Shape) -> Vec<Given> {
    shape.result_arrays()
}

impl Outline<'_> {
    /// Returns true if functions take the parameter struct as their first argument.
    pub fn has_own(&self) -> bool {
        !(self.parameters.is_empty() && self.tables.is_empty())
    }

    /// Returns the arguments of a function, preceded by time if functions take time.
    pub fn with_time_argument(&self, arguments: &[Argument]) -> Vec<Argument> {
        self.time.then_some(Argument::T).into_iter().chain(arguments.iter().copied()).collect()
    }

    /// Returns the number of array entries of a function argument.
    pub fn length(&self, argument: Argument) -> usize {
        argument.length([self.nq, self.nv, self.nu])
    }

    /// Returns the signature of a function with the results of a shape.
    pub fn signature_for_shape(&self, name: &str, arguments: &[Argument], shape: Shape) -> String {
        let kind = if shape == Shape::Scalar { "double" } else { "void" };
        let given: Vec<&str> = result_arrays(shape).iter().map(|(name, ..)| *name).collect();
        self.signature_with_results(kind, name, arguments, &given)
    }

    /// Returns the C signature of a function with any list of results.
    pub fn signature_with_results(
        &self,
        kind: &str,
        name: &str,
        arguments: &[Argument],
        given: &[&str],
    ) -> String {
        let mut list: Vec<String> = Vec::new();
        if self.has_own() {
            list.push(format!("const {} *self", self.prefix));
        }
        list.extend(arguments.iter().filter(|a| is_passed(a)).map(|a| match a {
            Argument::T => "double t".to_string(),
            a => format!("const double *{}", a.argument_name()),
        }));
        list.extend(given.iter().map(|name| format!("double *{name}")));
        let list = if list.is_empty() { "void".to_string() } else { list.join(", ") };
        format!("{kind} {}_{name}({list})", self.prefix)
    }

    /// Returns a call of a function. Parameters and time are added to the arguments; `given` are the result
    /// arrays.
    pub fn function_call(&self, name: &str, arguments: &[&str], given: &[&str]) -> String {
        let own = self.has_own().then_some("self");
        let time = self.time.then_some("t");
        let list: Vec<&str> = own
            .into_iter()
            .chain(time)
            .chain(arguments.iter().copied())
            .chain(given.iter().copied())
            .collect();
        format!("{}_{name}({})", self.prefix, list.join(", "))
    }

    /// Returns the source text of a call of a function without its time argument.
    pub fn timeless_call(&self, name: &str, arguments: &[&str]) -> String {
        let own = self.has_own().then_some("self");
        let list: Vec<&str> = own.into_iter().chain(arguments.iter().copied()).collect();
        format!("{}_{name}({})", self.prefix, list.join(", "))
    }

    /// Returns statements that suppress compiler warnings on unused arguments and result arrays.
    pub fn silence_unused_arguments(&self, body: &str, arguments: &[Argument], given: &[&str]) -> String {
        let own = self.has_own().then_some("self");
        let passed = arguments.iter().filter(|a| is_passed(a)).map(|a| a.argument_name());
        let names = own.into_iter().chain(passed).chain(given.iter().copied());
        names.filter(|name| !contains_word(body, name)).map(|name| format!("    (void)({name});\n")).collect()
    }
}

/// Returns false for arguments that do not occur in signatures.
pub fn is_passed(argument: &Argument) -> bool {
    !matches!(argument, Argument::Into(..) | Argument::Called(_))
}

/// Returns true if a text contains a word as a whole, and not as a member of a struct.
pub fn contains_word(text: &str, word: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.match_indices(word).any(|(at, _)| {
        let before = text.get(..at).and_then(|t| t.chars().next_back());
        let after = text.get(at + word.len()..).and_then(|t| t.chars().next());
        let is_member = text.get(..at).is_some_and(|before| before.ends_with("->"));
        !is_member && !before.is_some_and(is_letter) && !after.is_some_and(is_letter)
    })
}

/// Returns the identifier of a function without the underscore that marks internal functions.
pub fn public_identifier(name: &str) -> String {
    replace_invalid_characters(name.trim_start_matches('_'))
}

/// Documentation of the C function for [`Id::InputDerivatives`].
const INPUT_DERIVATIVES: &str = "`(∂τ/∂q, ∂τ/∂v, ∂τ/∂u)` of the inputs' `generalized_forces`. Column `i` of a derivative by `q` is along `q ⊕ ε eᵢ` (see `integrate`).";

/// Documentation of the C function for [`Id::ContactLaws`].
const CONTACT_LAWS: &str =
    "Coefficients of friction, restitution and static friction of each contact, in the order of the gaps.";

/// Documentation of the function of [`Id::MotionDerivatives`].
const MOTION_DERIVATIVES: [&str; 2] = [
    "Derivatives of `M a + h − Jᵀ λ` and of the constraint accelerations `J a + b` by `q` and `v`, at given \
     accelerations `a` and multipliers `lambda`; derivatives of the constraint rates by `q`; and the \
     rotation of displacements in rotating axes, the derivative of their rates. Column `i` of a derivative \
     by `q` is along `q ⊕ ε eᵢ` (see `integrate`).",
    "The derivatives `dv̇` and `dλ` of a motion solve `M dv̇ − Jᵀ dλ = dτ − forces_by_x`, \
     `J dv̇ = −bias_by_x`.",
];

/// Returns the documentation of a generated function in C.
pub fn function_documentation(f: &Function) -> Vec<String> {
    match f.id {
        Id::InputDerivatives => vec![INPUT_DERIVATIVES.to_string()],
        Id::ContactLaws => vec![CONTACT_LAWS.to_string()],
        Id::MotionDerivatives => MOTION_DERIVATIVES.map(ToString::to_string).to_vec(),
        _ => f.docs.clone(),
    }
}

/// Returns the public name of a function in C.
pub fn public_name(f: &Function) -> String {
    if f.id == Id::InputDerivatives {
        "generalized_forces_derivatives".to_string()
    } else {
        public_identifier(&f.name)
    }
}

/// Returns a definition, with its documentation if the function is public.
pub fn function_definition(f: &Function, o: &Outline<'_>, support: &mut Support) -> String {
    let mut body = String::new();
    let scope_arguments: Vec<Argument> =
        f.arguments.iter().copied().chain(Called::ALL.map(Argument::Called)).collect();
    let scope = Scope { arguments: &scope_arguments, parameters: o.parameters, tables: o.tables };
    for called in Called::ALL {
        write_call(&mut body, f, called, o);
    }
    match f.shape {
        Shape::Scalar => {
            let result = write_program(&mut body, &f.program, &scope, &|_| None, support);
            let _ = writeln!(body, "    return {result};");
        }
        Shape::Inverse(_)
        | Shape::Forward(_)
        | Shape::Linear(..)
        | Shape::Accelerated(_)
        | Shape::CalledForward(_)
        | Shape::CalledLinear(..) => composed::write_composed_body(&mut body, f, &scope, o, support),
        _ => {
            let mut results = result_arrays(f.shape);
            // Another function computes the forces themselves.
            if f.id == Id::InputDerivatives {
                results.insert(0, ("forces", o.nv, 1));
                let _ = writeln!(body, "    double forces[{}];", o.nv.max(1));
            }
            let count: usize = results.iter().map(|(_, rows, columns)| rows * columns).sum();
            support.missing |= count != f.program.outputs.len();
            write_program(&mut body, &f.program, &scope, &|k| element_of_output(&results, k), support);
            if f.id == Id::InputDerivatives {
                body.push_str("    (void)(forces);\n");
            }
        }
    }
    let given: Vec<&str> = result_arrays(f.shape).iter().map(|(name, ..)| *name).collect();
    let unused = o.silence_unused_arguments(&body, &f.arguments, &given);
    let is_public = matches!(f.id, Id::InputDerivatives | Id::ContactLaws | Id::MotionDerivatives);
    let hidden = if f.is_hidden() && !is_public { "static " } else { "" };
    let signature = o.signature_for_shape(&public_name(f), &f.arguments, f.shape);
    format!("{hidden}{signature} {{\n{unused}{body}}}\n")
}

/// Returns the declaration of a function, preceded by its documentation.
pub fn function_declaration(f: &Function, o: &Outline<'_>) -> String {
    let results = result_arrays(f.shape);
    let docs = docs::function_comment(&function_documentation(f), &f.arguments, &results, o);
    format!("{docs}{};\n", o.signature_for_shape(&public_name(f), &f.arguments, f.shape))
}

/// Returns the array element to which output `k` is written; the arrays of `results` follow one another.
pub fn element_of_output(results: &[Given], mut k: usize) -> Option<String> {
    for (name, rows, columns) in results {
        if k < rows * columns {
            return Some(format!("{name}[{k}]"));
        }
        k -= rows * columns;
    }
    None
}

/// Writes the call of a function whose results are inputs of the program, if the program uses them.
fn write_call(body: &mut String, f: &Function, called: Called, o: &Outline<'_>) {
    let argument = Argument::Called(called);
    if !f.reads_results_of(called) {
        return;
    }
    let (name, [forces, derivatives]) = (argument.argument_name(), o.passive);
    let length = if called == Called::PassiveForces { forces } else { derivatives };
    let _ = writeln!(
        body,
        "    double {name}[{length}];\n    {};",
        o.function_call(&public_identifier(called.function_name()), &["q", "v"], &[name])
    );
}

/// Returns true if output `k` of a function is always zero.
pub fn is_zero(f: &Function, k: usize) -> bool {
    f.program.outputs.get(k).is_none_or(|o| *o == Operand::Const(0.0))
}
