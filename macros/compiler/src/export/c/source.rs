//! Text of the C source file of a mechanism, and selection of the functions that C has.

use super::batch::Batch;
use super::casadi::Shapes;
use super::docs;
use super::function::{
    Outline, element_of_output, function_definition, public_identifier, public_name, result_arrays,
};
use super::header::{header_text, list_state_entries};
use super::own_functions;
use super::scalar::in_single_precision;
use super::support::Support;
use super::{frames, manifold, names, steps};
use crate::catalogue::{Argument, Called, Id, InverseForm, REACTION, Shape, TOUCHED};
use crate::derive::{Function, Output};
use crate::lower::{Op, Program};
use crate::mechanism::{Model, Supplied};
use std::fmt::Write;

/// Options of the export to C.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Prefix of all names. If it is empty, the mechanism's name in lower case is used.
    pub prefix: String,
    /// Whether C code computes in single precision.
    pub single: bool,
    /// Whether results must have the same bits with every compiler and mathematical library.
    pub reproducible: bool,
    /// Parameters to fix in an additional source file with CasADi's interface; `None` for no such file.
    pub casadi: Option<Vec<(String, f64)>>,
    /// Further lines to be added to [`Files::left_out`].
    pub left_out: Vec<String>,
}

/// Texts of the exported C files, and names of functions that the files lack.
#[derive(Clone, Debug)]
pub struct Files {
    /// Prefix of the names in the files and of the file names.
    pub prefix: String,
    /// Text of the header `PREFIX.h`.
    pub header: String,
    /// Text of the source file `PREFIX.c`.
    pub source: String,
    /// Text of the source file `PREFIX_casadi.c`, if the options request it.
    pub casadi: Option<String>,
    /// Functions of the mechanism that exist in Rust but not in C, with reasons.
    pub left_out: Vec<String>,
}

/// Reason why a mechanism cannot be exported to C.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// The results of this element or option differ from those in Rust by rounding.
    Irreproducible(&'static str),
    /// The mechanism declares generalized speeds, but CasADi's functions take joint velocities.
    CasadiSpeeds,
    /// The named program contains SIMD lanes, which C code does not support.
    Lanes(String),
    /// A program reads a value that its function does not have, or has another number of results.
    Missing,
    /// The parameter that the options fix does not exist.
    NoParameter(String),
    /// CasADi is requested with single precision, which it does not support.
    SingleCasadi,
}

/// Exports a mechanism whose programs have no vector lanes; `tables` are the names of its tables.
///
/// # Errors
/// The mechanism or the options are not supported in C, for the reason in [`Unfit`].
pub fn export_c_source(
    model: &Model<'_>,
    output: &Output,
    tables: &[String],
    options: &Options,
) -> Result<Files, Unfit> {
    reject_vector_lanes(output)?;
    if model.speeds.is_some() && options.casadi.is_some() {
        return Err(Unfit::CasadiSpeeds);
    }
    if options.single && options.casadi.is_some() {
        return Err(Unfit::SingleCasadi);
    }
    if options.reproducible && (options.single || options.casadi.is_some()) {
        return Err(Unfit::Irreproducible(if options.single { "single precision" } else { "CasADi" }));
    }
    let named = Named::from_model(model, tables, &options.prefix);
    let o = &named.outline_of_mechanism(model, output);
    let mut chosen = Selection::new(output);
    chosen.left_out.extend(options.left_out.iter().cloned());
    if options.casadi.is_some() {
        let reactions = chosen.reactions.iter().filter_map(|f| f.name.strip_prefix(REACTION));
        let limits = chosen.limits.map(|_| "limits");
        let names = reactions.chain(limits).map(|name| format!("{name} in the form of CasADi"));
        chosen.left_out.extend(names.collect::<Vec<_>>());
    }
    let mut support = Support::new(options.single);
    let mut steps = steps::Steps::new(model, output);
    if options.reproducible && std::mem::take(&mut steps.has_transitions) {
        let line = "rk4_transition and semi_implicit_euler_transition: their bits would not be those of Rust";
        chosen.left_out.push(line.to_string());
    }
    let bodies = function_definitions(model, output, &chosen, &steps, o, &mut support)?;
    if let Some(what) = support.irreproducible().filter(|_| options.reproducible) {
        return Err(Unfit::Irreproducible(what));
    }
    let casadi = match &options.casadi {
        Some(given) => {
            Some(write_casadi(model, &chosen, o, [steps.has_steps, steps.has_transitions], given)?)
        }
        None => None,
    };
    let mut header = header_text(model, output, &chosen, o, options.reproducible);
    header.push_str(&steps.step_declarations(o));
    header.push_str("#ifdef __cplusplus\n}\n#endif\n\n#endif\n");
    let mut source = format!(
        "/* Generated by Linkwork from the mechanism `{}`: see {}.h. */\n\n#include \"{}.h\"\n\n",
        docs::comment_safe_text(&model.name),
        o.prefix,
        o.prefix
    );
    let includes = if options.reproducible { own_functions::HEADERS } else { support.required_headers() };
    for name in includes.iter().chain(&["math.h"]) {
        let _ = writeln!(source, "#include <{name}>");
    }
    support.is_reproducible = options.reproducible;
    let code = format!("{}\n{}\n", support.support_definitions(model.nv(), &o.prefix), bodies.trim_end());
    let code = if options.reproducible { own_functions::with_own_functions(&code) } else { code };
    let _ = write!(source, "\n{code}");
    let convert_to_precision = |text: String| if options.single { in_single_precision(&text) } else { text };
    Ok(Files {
        header: convert_to_precision(header),
        source: convert_to_precision(source),
        casadi,
        left_out: chosen.left_out,
        prefix: o.prefix.clone(),
    })
}

/// Names that a mechanism has in C.
pub struct Named {
    pub prefix: String,
    pub parameters: Vec<String>,
    pub tables: Vec<String>,
}

impl Named {
    /// Converts the names of a mechanism to identifiers of C.
    pub fn from_model(model: &Model<'_>, tables: &[String], prefix: &str) -> Named {
        let prefix = match prefix {
            "" => names::prefix_identifier(&names::snake_case_prefix(&model.name)),
            given => names::prefix_identifier(given),
        };
        let shared: Vec<&String> = model.parameters.iter().chain(tables).collect();
        let mut parameters = names::unique_identifiers(&shared);
        let tables = parameters.split_off(model.parameters.len());
        Named { prefix, parameters, tables }
    }

    /// Returns the sizes and names that all exported functions share.
    pub fn outline_of_mechanism(&self, model: &Model<'_>, output: &Output) -> Outline<'_> {
        let length =
            |id: Id| output.functions.iter().find(|f| f.id == id).map_or(0, |f| f.program.outputs.len());
        Outline {
            prefix: self.prefix.clone(),
            parameters: &self.parameters,
            tables: &self.tables,
            nq: model.nq(),
            nv: model.nv(),
            nu: model.nu(),
            time: model.time,
            passive: [length(Id::PassiveForces), length(Id::PassiveDerivatives)],
            derivatives: output.functions.iter().any(|f| f.id == Id::InputDerivatives),
            speeds: model.speeds.is_some(),
        }
    }
}

/// Returns the C definitions of all functions.
pub fn function_definitions(
    model: &Model<'_>,
    output: &Output,
    chosen: &Selection<'_>,
    steps: &steps::Steps<'_>,
    o: &Outline<'_>,
    support: &mut Support,
) -> Result<String, Unfit> {
    let mut bodies = String::new();
    for f in chosen.hidden.iter().chain(&chosen.public) {
        let _ = writeln!(bodies, "{}", function_definition(f, o, support));
    }
    chosen.reactions.iter().for_each(|f| write_reaction_function(&mut bodies, f, model, o, support));
    if let Some(limits) = chosen.limits {
        bodies.push_str(&write_limits(limits, model, o, support));
    }
    manifold::write_manifold_definitions(&mut bodies, &output.charts, o, support);
    steps.write_step_definitions(&mut bodies, o, support);
    bodies.push_str(&frames::frame_definitions(output, o, support));
    if support.missing { Err(Unfit::Missing) } else { Ok(bodies) }
}

/// Returns the text of the source file with CasADi's interface.
fn write_casadi(
    model: &Model<'_>,
    chosen: &Selection<'_>,
    o: &Outline<'_>,
    steps: [bool; 2],
    given: &[(String, f64)],
) -> Result<String, Unfit> {
    let mut fixed = vec![None; model.parameters.len()];
    for (name, value) in given {
        let at = model.parameters.iter().position(|known| known == name);
        let at = at.ok_or_else(|| Unfit::NoParameter(name.clone()))?;
        fixed[at] = Some(*value);
    }
    let frames: Vec<String> = model.frames.iter().map(|frame| frame.name.clone()).collect();
    let shapes = Shapes {
        o,
        public: &chosen.public,
        frames: &names::preprocessor_names(&frames),
        fixed: &fixed,
        is_plain: model.nq() == model.nv(),
        is_accelerating: !model.acceleration_forces.is_empty(),
        steps,
    };
    Ok(shapes.file_text())
}

/// Returns an error if a program contains vector lanes, which C code cannot have.
pub fn reject_vector_lanes(output: &Output) -> Result<(), Unfit> {
    let has_operation = |program: &Program, wanted: fn(&Op) -> bool| program.instructions.iter().any(wanted);
    let steps = output.links.iter().flat_map(|l| [&l.placement, &l.twist, &l.acceleration, &l.columns]);
    let steps = steps.chain(output.frames.iter().flat_map(|f| [&f.placement, &f.twist, &f.acceleration]));
    let all = output.functions.iter().map(|f| (f.name.as_str(), &f.program));
    for (name, program) in all.chain(steps.map(|program| ("frames", program))) {
        let lanes = has_operation(program, |op| matches!(op, Op::Sum(..) | Op::Lane(..) | Op::Join(..)));
        if lanes || !program.gathers.is_empty() || !program.tuples.is_empty() {
            return Err(Unfit::Lanes(name.to_string()));
        }
    }
    Ok(())
}

/// Functions of the mechanism, grouped by their use in C.
pub struct Selection<'a> {
    /// Functions that a C program can call.
    pub public: Vec<&'a Function>,
    /// Functions that only other functions call, in the order of their C definitions.
    hidden: Vec<&'a Function>,
    /// Output functions that contain reactions.
    pub reactions: Vec<&'a Function>,
    /// Function that returns the limits of the joints, if there is one.
    pub limits: Option<&'a Function>,
    /// Functions that C does not have, with reasons.
    pub left_out: Vec<String>,
}

impl<'a> Selection<'a> {
    /// Sorts the functions of a mechanism by how they are exported.
    pub fn new(output: &'a Output) -> Selection<'a> {
        let mut chosen = Selection {
            public: Vec::new(),
            hidden: Vec::new(),
            reactions: Vec::new(),
            limits: None,
            left_out: Vec::new(),
        };
        let has_dynamics = output.functions.iter().any(|f| f.id == Id::ForwardDynamics);
        let has_derivatives = output.functions.iter().any(|f| f.id == Id::InputDerivatives);
        let has_frames = !output.frames.is_empty();
        for f in &output.functions {
            match f.id {
                _ if f.reads_results_of(Called::ContactFeatures) => {
                    chosen.left_out.push(format!("{}: contacts of polytopes with each other", f.name));
                }
                Id::PolytopePoses => {}
                Id::RateMatrix if has_frames || has_derivatives => chosen.hidden.push(f),
                Id::RateAccelerations if has_frames => chosen.hidden.push(f),
                Id::SpeedMatrix | Id::RateChanges if has_derivatives => chosen.hidden.push(f),
                Id::PassiveForces | Id::PassiveDerivatives | Id::AccelerationsAndInverse => {
                    chosen.hidden.push(f)
                }
                Id::Reaction
                    if f.arguments
                        .iter()
                        .any(|a| matches!(a, Argument::Given(_, Supplied::ContactForces, _))) =>
                {
                    let name = f.name.strip_prefix(REACTION).unwrap_or_default();
                    chosen.left_out.push(format!("{name}: a free-body diagram under contact forces"));
                }
                Id::Reaction if has_dynamics => chosen.reactions.push(f),
                Id::Limits => chosen.limits = Some(f),
                // Variants that write to matrices of the caller. In C all functions do so.
                Id::InverseDynamicsDerivativesInto
                | Id::ForwardDynamicsDerivativesInto
                | Id::MassMatrixInto => {}
                Id::ContactLaws => chosen.public.push(f),
                Id::ContactDerivatives | Id::Figures | Id::ConstraintCurvature | Id::ConstraintResponse => {}
                Id::SlippingResponse => {}
                Id::ConstrainedDynamics => chosen.left_out.push(
                    "forward_dynamics, assemble and the other functions that solve for constraint forces"
                        .to_string(),
                ),
                Id::Reaction => {
                    let name = f.name.strip_prefix(REACTION).unwrap_or_default();
                    chosen.left_out.push(format!("{name}: a reaction under constraints"));
                }
                Id::ContactGaps => {
                    chosen.left_out.push(
                        "time steps with impacts; gap functions, contact velocities and their Jacobian are \
                         available"
                            .to_string(),
                    );
                    chosen.public.push(f);
                }
                Id::Touched => {
                    let name = f.name.strip_prefix(TOUCHED).unwrap_or_default();
                    chosen.left_out.push(format!("{name}: forces at contacts"));
                }
                Id::InputDerivatives | Id::MotionDerivatives => chosen.public.push(f),
                _ if f.is_hidden() || matches!(f.shape, Shape::Record(_)) => {}
                _ => chosen.public.push(f),
            }
        }
        // A static function must precede its callers, and must have one.
        chosen.hidden.sort_by_key(|f| f.id == Id::AccelerationsAndInverse);
        if !output.functions.iter().any(|f| matches!(f.shape, Shape::CalledForward(_))) {
            chosen.hidden.retain(|f| f.id != Id::AccelerationsAndInverse);
        }
        chosen
    }
}

/// Returns the arguments of output functions that are computed reactions.
pub fn reaction_arguments(model: &Model<'_>) -> Vec<Argument> {
    let time = model.time.then_some(Argument::T);
    let inputs = (model.nu() > 0).then_some(Argument::U);
    time.into_iter().chain([Argument::Q, Argument::V]).chain(inputs).collect()
}

/// Writes the function for a reaction of the motion that state and inputs determine.
fn write_reaction_function(
    out: &mut String,
    f: &Function,
    model: &Model<'_>,
    o: &Outline<'_>,
    support: &mut Support,
) {
    let Some(name) = f.name.strip_prefix(REACTION) else { return };
    let name = names::replace_invalid_characters(name);
    let arguments = reaction_arguments(model);
    let n = model.nv().max(1);
    let mut body = format!("    double a[{n}], tau[{n}];\n");
    let inputs: &[&str] = if model.velocity_inputs { &["q", "v", "u"] } else { &["q", "u"] };
    match model.nu() {
        0 => {
            let _ = writeln!(body, "    for (int k = 0; k < {n}; ++k) {{\n        tau[k] = 0.0;\n    }}");
        }
        _ => {
            let _ = writeln!(body, "    {};", o.function_call("generalized_forces", inputs, &["tau"]));
        }
    }
    let _ = writeln!(body, "    {};", o.function_call("forward_dynamics", &["q", "v", "tau"], &["a"]));
    let with_inputs: &[&str] = if model.nu() > 0 { &["q", "v", "a", "u"] } else { &["q", "v", "a"] };
    let hidden = public_identifier(&f.name);
    let _ = match f.shape {
        Shape::Scalar => writeln!(body, "    return {};", o.function_call(&hidden, with_inputs, &[])),
        _ => writeln!(body, "    {};", o.function_call(&hidden, with_inputs, &["result"])),
    };
    let part = function_definition(f, o, support);
    let given: Vec<&str> = result_arrays(f.shape).iter().map(|(name, ..)| *name).collect();
    let _ = writeln!(
        out,
        "{part}\n{} {{\n{}{body}}}\n",
        o.signature_for_shape(&name, &arguments, f.shape),
        o.silence_unused_arguments(&body, &arguments, &given)
    );
}

/// Bodies in C of functions without calls of other functions and without loops.
pub struct StraightBodies {
    /// Prefix of all names of the mechanism in C.
    pub prefix: String,
    /// Lines of a comment that describe the mechanism.
    pub about: String,
    /// Signature and C body of each function.
    pub functions: Vec<(Batch, String)>,
    /// Members of the C parameter struct.
    pub parameters: Vec<String>,
    /// Names of functions that C does not have, with reasons.
    pub left_out: Vec<String>,
}

/// Returns the bodies of all functions that are straight-line programs.
///
/// # Errors
/// The mechanism is not supported, for the reason in [`Unfit`].
pub fn bodies_without_calls(
    model: &Model<'_>,
    output: &Output,
    tables: &[String],
    options: &Options,
) -> Result<StraightBodies, Unfit> {
    reject_vector_lanes(output)?;
    let named = Named::from_model(model, tables, &options.prefix);
    let o = &named.outline_of_mechanism(model, output);
    let chosen = Selection::new(output);
    let mut left_out = chosen.left_out.clone();
    left_out.extend(options.left_out.iter().cloned());
    let mut functions = Vec::new();
    let mut support = Support::of_kernels();
    for f in &chosen.public {
        match body_without_calls(f, o, &mut support) {
            Some(body) => functions.push((Batch::from_function(f, o), body)),
            None => left_out.push(format!("{}: it calls other functions", public_name(f))),
        }
    }
    for f in &chosen.reactions {
        let name = f.name.strip_prefix(REACTION).unwrap_or_default();
        left_out.push(format!("{name}: it calls other functions"));
    }
    left_out.extend(chosen.limits.map(|_| "limits: the same for all states".to_string()));
    if support.missing {
        return Err(Unfit::Missing);
    }
    let manifold = manifold::bodies_of_plain_charts(&output.charts, o);
    if manifold.is_empty() {
        left_out.push(
            "integrate and the other functions of the configuration space: it has ball or free joints"
                .to_string(),
        );
    }
    functions.extend(manifold);
    if !output.frames.is_empty() {
        left_out.push("the functions of frames by index".to_string());
    }
    let steps = steps::Steps::new(model, output);
    left_out.extend(steps.step_batches(o).iter().map(|f| format!("{}: it calls other functions", f.name)));
    Ok(StraightBodies {
        prefix: o.prefix.clone(),
        about: list_state_entries(model),
        functions,
        parameters: named.parameters.clone(),
        left_out,
    })
}

/// Returns the body of a function; `None` if it calls other functions or has loops.
fn body_without_calls(f: &Function, o: &Outline<'_>, support: &mut Support) -> Option<String> {
    let is_composed = match f.shape {
        Shape::Inverse(_) => !matches!(f.structure.inverse, InverseForm::Explicit),
        Shape::Forward(_) | Shape::Linear(..) | Shape::Accelerated(_) => true,
        shape => shape.is_assembled_from_calls(),
    };
    let calls = Called::ALL.into_iter().any(|called| f.reads_results_of(called));
    if is_composed || calls {
        return None;
    }
    let scope = super::body::Scope { arguments: &f.arguments, parameters: o.parameters, tables: o.tables };
    let results = result_arrays(f.shape);
    let mut body = String::new();
    // The forces, which come first, are the results of another function.
    let skipped = if f.id == Id::InputDerivatives { o.nv } else { 0 };
    let places = |k: usize| k.checked_sub(skipped).and_then(|k| element_of_output(&results, k));
    let first = super::body::write_program(&mut body, &f.program, &scope, &places, support);
    if results.is_empty() {
        let _ = writeln!(body, "    result[0] = {first};");
    }
    Some(body)
}

/// Names of the results of the function that returns the limits.
pub const LIMITS: [&str; 4] = ["lower", "upper", "speed", "effort"];

/// Writes the function for the bounds of coordinates, velocities and forces.
fn write_limits(f: &Function, model: &Model<'_>, o: &Outline<'_>, support: &mut Support) -> String {
    let mut places = Vec::new();
    for limit in &model.limits {
        let at = limit.v;
        for (bound, name) in limit.bounds().iter().zip(LIMITS) {
            if bound.is_some() {
                places.push(format!("{name}[{at}]"));
            }
        }
    }
    let mut body = String::new();
    let _ = writeln!(body, "    for (int k = 0; k < {}; ++k) {{", o.nv);
    for (name, sign) in LIMITS.into_iter().zip(["-", "", "", ""]) {
        let _ = writeln!(body, "        {name}[k] = {sign}HUGE_VAL;");
    }
    body.push_str("    }\n");
    let scope = super::body::Scope { arguments: &[], parameters: o.parameters, tables: o.tables };
    super::body::write_program(&mut body, &f.program, &scope, &|k| places.get(k).cloned(), support);
    format!(
        "{} {{\n{}{body}}}\n\n",
        o.signature_with_results("void", "limits", &[], &LIMITS),
        o.silence_unused_arguments(&body, &[], &[])
    )
}
