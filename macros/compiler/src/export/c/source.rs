//! Source file and header of a mechanism.

use super::casadi::Shapes;
use super::docs;
use super::function::{Outline, declare, define, plain, results};
use super::scalar::in_single_precision;
use super::support::Support;
use super::{frames, manifold, names, steps, tables};
use crate::catalogue::{Argument, CONTACT_FORCES, Id, REACTION, Shape, TOUCHED};
use crate::derive::{Function, Output};
use crate::lower::{Op, Program};
use crate::mechanism::Model;
use std::fmt::Write;

/// Options of the export.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Prefix of all names. If it is empty, the mechanism's name in lower case is used.
    pub prefix: String,
    /// Whether numbers have single precision.
    pub single: bool,
    /// Parameters to fix in an additional source file with CasADi's interface; `None` for no such file.
    pub casadi: Option<Vec<(String, f64)>>,
    /// Further lines of [`Files::left_out`].
    pub left_out: Vec<String>,
}

/// Texts of the files, and functions that they do not contain.
#[derive(Clone, Debug)]
pub struct Files {
    /// Prefix of names and files.
    pub prefix: String,
    /// Header `PREFIX.h`.
    pub header: String,
    /// Source file `PREFIX.c`.
    pub source: String,
    /// Source file `PREFIX_casadi.c`, if the options request it.
    pub casadi: Option<String>,
    /// Functions of the mechanism that exist in Rust but not in C, with reasons.
    pub left_out: Vec<String>,
}

/// Reason why a mechanism cannot be exported to C.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// The mechanism declares generalized speeds, but CasADi's functions take joint velocities.
    CasadiSpeeds,
    /// The named program contains vector lanes.
    Lanes(String),
    /// A program reads a value that its function does not have, or has another number of results.
    Missing,
    /// The parameter to be fixed does not exist.
    NoParameter(String),
    /// CasADi supports only double precision.
    SingleCasadi,
}

/// Exports a mechanism whose programs have no vector lanes; `tables` are the names of its tables.
///
/// # Errors
/// The mechanism or the options are not supported in C, for the reason in [`Unfit`].
pub fn write(
    model: &Model<'_>,
    output: &Output,
    tables: &[String],
    options: &Options,
) -> Result<Files, Unfit> {
    check(output)?;
    if model.speeds.is_some() && options.casadi.is_some() {
        return Err(Unfit::CasadiSpeeds);
    }
    if options.single && options.casadi.is_some() {
        return Err(Unfit::SingleCasadi);
    }
    let prefix = match options.prefix.as_str() {
        "" => names::prefix_identifier(&names::prefix(&model.name)),
        given => names::prefix_identifier(given),
    };
    let shared: Vec<&String> = model.parameters.iter().chain(tables).collect();
    let mut parameters = names::identifiers(&shared);
    let tables = parameters.split_off(model.parameters.len());
    let length = |id: Id| output.functions.iter().find(|f| f.id == id).map_or(0, |f| f.program.outputs.len());
    let o = Outline {
        prefix,
        parameters: &parameters,
        tables: &tables,
        nq: model.nq(),
        nv: model.nv(),
        nu: model.nu(),
        time: model.time,
        passive: [length(Id::PassiveForces), length(Id::PassiveDerivatives)],
        derivatives: output.functions.iter().any(|f| f.id == Id::InputDerivatives),
        speeds: model.speeds.is_some(),
    };
    let mut chosen = Selection::new(output);
    chosen.left_out.extend(options.left_out.iter().cloned());
    if options.casadi.is_some() {
        let reactions = chosen.reactions.iter().filter_map(|f| f.name.strip_prefix(REACTION));
        let limits = chosen.limits.map(|_| "limits");
        let names = reactions.chain(limits).map(|name| format!("{name} in the form of CasADi"));
        chosen.left_out.extend(names.collect::<Vec<_>>());
    }
    let mut support = Support::new(options.single);
    let mut bodies = String::new();
    for f in &chosen.hidden {
        let _ = writeln!(bodies, "{}", define(f, &o, &mut support));
    }
    for f in &chosen.public {
        let _ = writeln!(bodies, "{}", define(f, &o, &mut support));
    }
    chosen.reactions.iter().for_each(|f| reaction(&mut bodies, f, model, &o, &mut support));
    if let Some(limits) = chosen.limits {
        bodies.push_str(&write_limits(limits, model, &o, &mut support));
    }
    manifold::define(&mut bodies, &output.charts, &o, &mut support);
    let steps = steps::Steps::new(model, output);
    steps.define(&mut bodies, &o, &mut support);
    bodies.push_str(&frames::define(output, &o, &mut support));
    let casadi = match &options.casadi {
        Some(given) => {
            Some(write_casadi(model, &chosen, &o, [steps.has_steps, steps.has_transitions], given)?)
        }
        None => None,
    };
    if support.missing {
        return Err(Unfit::Missing);
    }
    let mut header = header(model, output, &chosen, &o);
    header.push_str(&steps.declare(&o));
    header.push_str("#ifdef __cplusplus\n}\n#endif\n\n#endif\n");
    let mut source = format!(
        "/* Generated by Linkwork from the mechanism `{}`: see {}.h. */\n\n#include \"{}.h\"\n\n",
        docs::safe(&model.name),
        o.prefix,
        o.prefix
    );
    let mut includes: Vec<&str> = support.includes().to_vec();
    includes.push("math.h");
    if !output.frames.is_empty() && !includes.contains(&"string.h") {
        includes.push("string.h");
    }
    for name in includes {
        let _ = writeln!(source, "#include <{name}>");
    }
    let texts = support.text(model.nv(), &o.prefix);
    let _ = writeln!(source, "\n{texts}\n{}", bodies.trim_end());
    let single = |text: String| if options.single { in_single_precision(&text) } else { text };
    Ok(Files {
        header: single(header),
        source: single(source),
        casadi,
        left_out: chosen.left_out,
        prefix: o.prefix.clone(),
    })
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
        frames: &names::capitals(&frames),
        fixed: &fixed,
        is_plain: model.nq() == model.nv(),
        is_accelerating: !model.acceleration_forces.is_empty(),
        steps,
    };
    Ok(shapes.text())
}

/// Rejects programs with vector lanes.
fn check(output: &Output) -> Result<(), Unfit> {
    let has = |program: &Program, wanted: fn(&Op) -> bool| program.instructions.iter().any(wanted);
    let steps = output.links.iter().flat_map(|l| [&l.placement, &l.twist, &l.acceleration, &l.columns]);
    let steps = steps.chain(output.frames.iter().flat_map(|f| [&f.placement, &f.twist, &f.acceleration]));
    let all = output.functions.iter().map(|f| (f.name.as_str(), &f.program));
    for (name, program) in all.chain(steps.map(|program| ("frames", program))) {
        let lanes = has(program, |op| matches!(op, Op::Sum(..) | Op::Lane(..) | Op::Join(..)));
        if lanes || !program.gathers.is_empty() || !program.tuples.is_empty() {
            return Err(Unfit::Lanes(name.to_string()));
        }
    }
    Ok(())
}

/// Functions of the mechanism by their use in C.
struct Selection<'a> {
    public: Vec<&'a Function>,
    /// Functions that others call, in the order of their definitions.
    hidden: Vec<&'a Function>,
    reactions: Vec<&'a Function>,
    limits: Option<&'a Function>,
    left_out: Vec<String>,
}

impl<'a> Selection<'a> {
    fn new(output: &'a Output) -> Selection<'a> {
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
                Id::RateMatrix if has_frames || has_derivatives => chosen.hidden.push(f),
                Id::RateAccelerations if has_frames => chosen.hidden.push(f),
                Id::SpeedMatrix | Id::RateChanges if has_derivatives => chosen.hidden.push(f),
                Id::PassiveForces | Id::PassiveDerivatives | Id::AccelerationsAndInverse => {
                    chosen.hidden.push(f)
                }
                Id::Reaction
                    if f.arguments.iter().any(|a| matches!(a, Argument::Given(CONTACT_FORCES, ..))) =>
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
                Id::ContactLaws
                | Id::ContactDerivatives
                | Id::Figures
                | Id::MotionDerivatives
                | Id::ConstraintCurvature
                | Id::ConstraintResponse => {}
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
                        "time steps with impacts; gap functions, contact velocities and their Jacobian are available".to_string(),
                    );
                    chosen.public.push(f);
                }
                Id::Touched => {
                    let name = f.name.strip_prefix(TOUCHED).unwrap_or_default();
                    chosen.left_out.push(format!("{name}: forces at contacts"));
                }
                Id::InputDerivatives => chosen.public.push(f),
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

/// Returns the arguments of the outputs that reactions provide.
fn reaction_arguments(model: &Model<'_>) -> Vec<Argument> {
    let time = model.time.then_some(Argument::T);
    let inputs = (model.nu() > 0).then_some(Argument::U);
    time.into_iter().chain([Argument::Q, Argument::V]).chain(inputs).collect()
}

/// Writes the function for a reaction of the motion that state and inputs determine.
fn reaction(out: &mut String, f: &Function, model: &Model<'_>, o: &Outline<'_>, support: &mut Support) {
    let Some(name) = f.name.strip_prefix(REACTION) else { return };
    let name = names::letters(name);
    let arguments = reaction_arguments(model);
    let n = model.nv().max(1);
    let mut body = format!("    double a[{n}], tau[{n}];\n");
    let inputs: &[&str] = if model.velocity_inputs { &["q", "v", "u"] } else { &["q", "u"] };
    match model.nu() {
        0 => {
            let _ = writeln!(body, "    for (int k = 0; k < {n}; ++k) {{\n        tau[k] = 0.0;\n    }}");
        }
        _ => {
            let _ = writeln!(body, "    {};", o.call("generalized_forces", inputs, &["tau"]));
        }
    }
    let _ = writeln!(body, "    {};", o.call("forward_dynamics", &["q", "v", "tau"], &["a"]));
    let with_inputs: &[&str] = if model.nu() > 0 { &["q", "v", "a", "u"] } else { &["q", "v", "a"] };
    let hidden = plain(&f.name);
    let _ = match f.shape {
        Shape::Scalar => writeln!(body, "    return {};", o.call(&hidden, with_inputs, &[])),
        _ => writeln!(body, "    {};", o.call(&hidden, with_inputs, &["result"])),
    };
    let part = define(f, o, support);
    let given: Vec<&str> = results(f.shape).iter().map(|(name, ..)| *name).collect();
    let _ = writeln!(
        out,
        "{part}\n{} {{\n{}{body}}}\n",
        o.signature(&name, &arguments, f.shape),
        o.unused(&body, &arguments, &given)
    );
}

const LIMITS: [&str; 4] = ["lower", "upper", "speed", "effort"];

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
    format!("{} {{\n{}{body}}}\n\n", o.spelled("void", "limits", &[], &LIMITS), o.unused(&body, &[], &[]))
}

/// Writes one line per entry of a list: index, name and unit.
fn entries(text: &mut String, title: &str, names: &[String], units: &[String]) {
    if names.is_empty() {
        return;
    }
    let _ = writeln!(text, " *\n * {title}:");
    for (k, name) in names.iter().enumerate() {
        let unit = units.get(k).map_or("", String::as_str);
        let _ = writeln!(text, " *   {k:3}  {:30} {}", docs::safe(name), docs::safe(unit));
    }
}

fn header(model: &Model<'_>, output: &Output, chosen: &Selection<'_>, o: &Outline<'_>) -> String {
    let upper = o.prefix.to_ascii_uppercase();
    let mut text = format!(
        "/* The mechanism `{}`, generated by Linkwork.\n *\n * SI units, angles in radians. Vectors are plain arrays, matrices are stored column by column. Functions have no\n * state, allocate no memory and call only the mathematical library: any number of\n * threads may call them. Quaternions are stored x y z w.\n",
        docs::safe(&model.name)
    );
    entries(&mut text, "Configuration q", &model.configuration, &model.units.configuration);
    let velocities: Vec<String> = model.velocities.iter().map(|(name, _)| name.clone()).collect();
    entries(
        &mut text,
        "Velocity v; accelerations a and generalized forces tau in the same order",
        &velocities,
        &model.units.velocities,
    );
    let inputs: Vec<String> = model.inputs.iter().map(|(name, _)| name.clone()).collect();
    entries(&mut text, "Inputs u", &inputs, &model.units.inputs);
    if !chosen.left_out.is_empty() {
        text.push_str(" *\n * Not in C:\n");
        chosen.left_out.iter().for_each(|line| text.push_str(&docs::wrapped(line, " *   ", " *   ")));
    }
    text.push_str(" *\n * Compile with -O2 or -O3, and for the local processor (-march=native): products and sums are then fused to\n * one instruction. -fno-math-errno saves checks after square roots; do not use -ffast-math.\n */\n");
    let guard = format!("{upper}_H");
    let _ = writeln!(text, "#ifndef {guard}\n#define {guard}\n");
    let _ = writeln!(text, "/* Numbers of a configuration, of a velocity, and of the inputs. */");
    for (name, n) in [("NQ", model.nq()), ("NV", model.nv()), ("NU", model.nu())] {
        let _ = writeln!(text, "#define {upper}_{name} {n}");
    }
    if !output.frames.is_empty() {
        let _ = writeln!(
            text,
            "#define {upper}_FRAMES {}\n#define {upper}_LINKS {}",
            output.frames.len(),
            output.links.len()
        );
    }
    text.push_str("\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n");
    text.push_str(&tables::kind(o));
    if o.has_own() {
        text.push_str("/* The parameters, which every function takes first. */\n");
        let _ = writeln!(text, "typedef struct {} {{", o.prefix);
        for (k, member) in o.parameters.iter().enumerate() {
            let unit = model.units.parameters.get(k).map_or("", String::as_str);
            let _ = writeln!(text, "    double {member}; /* {} */", docs::safe(unit));
        }
        text.push_str(&tables::members(o, &model.units.tables));
        let _ = writeln!(text, "}} {};\n", o.prefix);
    }
    for f in &chosen.public {
        let _ = writeln!(text, "{}", declare(f, o));
    }
    for f in &chosen.reactions {
        let name = names::letters(f.name.strip_prefix(REACTION).unwrap_or_default());
        let arguments = reaction_arguments(model);
        let about = [format!(
            "The output `{name}` in the motion that state and inputs determine. A reaction is the force or torque that the parent of a joint exerts on its child, at the origin of the joint's frame."
        )];
        text.push_str(&docs::function(&about, &arguments, &results(f.shape), o));
        let _ = writeln!(text, "{};\n", o.signature(&name, &arguments, f.shape));
    }
    if chosen.limits.is_some() {
        text.push_str("/* Limits of the coordinates, and maximum magnitudes of velocities and forces, NV numbers each in the order of v;\n * infinite for a missing limit. */\n");
        let _ = writeln!(text, "{};\n", o.spelled("void", "limits", &[], &LIMITS));
    }
    text.push_str(&manifold::declare(o));
    let spoken: Vec<String> = model.frames.iter().map(|frame| frame.name.clone()).collect();
    let frames: Vec<(String, String)> = names::capitals(&spoken).into_iter().zip(spoken).collect();
    text.push_str(&frames::declare(o, &frames));
    text
}
