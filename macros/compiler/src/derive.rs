//! Derivation of all generated functions of a model: each function's mechanics, lowered to a program.

use crate::catalogue::{self, Facts};
use crate::diag::Diagnostics;
use crate::equations::{self, EquationSizeLimits, PrintedEquations, kane, linear, reduced};
use crate::expr::Expr;
use crate::kinematics::{self, Joint};
use crate::lower::{Program, lower, pipeline};
use crate::mechanics::conserved::{self, ConservedQuantity};
use crate::mechanics::hamilton::{self, HamiltonEquations};
use crate::mechanics::routh::{self, RouthEquations};
use crate::mechanics::speeds::SpeedTransformation;
use crate::mechanics::{self, crba, frames};
use crate::mechanism::Model;
use crate::passes::PassSelection;
use crate::syntax::{EquationsOption, RequestedFunctions, SkippedPasses};
use std::rc::Rc;

mod block_loops;
mod constraints;
mod derivation;
mod derivatives;
mod dynamics;
pub mod limb_lanes;
mod output;
mod outputs;
mod passive;
mod prepared;
mod regressor;
mod second;
mod sensitivities;
mod singular;
mod specialisation;
mod speeds;

use derivation::Derivation;
use derivatives::DerivativeFunctions;
use regressor::IdentificationFunctions;
use specialisation::ParameterSpecialisation;

pub use output::{
    AssociatedConstant, BlockLoopDerivatives, DerivationOutput, FrameRecursionPrograms, Function,
    LinkRecursionPrograms, PLACEMENT, PreparedFunctions, TWIST,
};

/// Maximum number of products in the elimination of constraints.
const MOST_PRODUCTS: usize = 100_000;

/// Derives all functions except the optional ones. Returns `None` with the errors in `cx` if the equations
/// cannot be derived, for example because the mass matrix is singular.
pub fn derive<'g>(model: &Model<'g>, cx: &mut Diagnostics) -> Option<DerivationOutput> {
    derive_with_options(model, RequestedFunctions::default(), PassSelection::default(), cx)
}

/// Like [`derive()`], with optional functions and a choice of optimisation passes.
pub fn derive_with_options<'g>(
    model: &Model<'g>,
    requests: RequestedFunctions,
    passes: PassSelection,
    cx: &mut Diagnostics,
) -> Option<DerivationOutput> {
    let passes = enabled_passes(passes, requests.skipped);
    let speeds = SpeedTransformation::new(model).map(Rc::new);
    let model = speeds.as_ref().map_or(model, |speeds| &speeds.native);
    let joints = kinematics::joints_of_model(model);
    if let Some((what, help)) =
        speeds.as_ref().and_then(|s| self::speeds::unsupported_option_message(s, requests))
    {
        cx.report_error(model.place.clone(), what).add_help(help);
        return None;
    }
    if model.kinematic {
        return derive_kinematic((model, speeds.as_ref()), requests, passes, &joints, cx);
    }
    let mass = crba::mass_matrix(model, &joints);
    if !singular::check_mass_matrix(model, &joints, &mass, cx)
        || !singular::check_effective_mass(model, &joints, &mass, cx)
    {
        return None;
    }
    if !check_requests(model, requests, cx) {
        return None;
    }
    let cyclic = cyclic_coordinates_for_routh(model, requests, &joints, cx)?;
    let extras = OptionalFunctionData {
        identification: requests.regressor.then(|| IdentificationFunctions::new(model, &joints)),
        entries: requests.packed.then(|| match &speeds {
            Some(speeds) => nonzero_mass_entries(&speeds.transform_mass_matrix(&mass)),
            None => nonzero_mass_entries(&mass),
        }),
        hamilton: (requests.hamilton && !has_massless_coordinates(model))
            .then(|| hamilton::derive(model, &joints, &mass)),
        routh: cyclic.clone().filter(|_| requests.routh).map(|c| routh::derive(model, &joints, &mass, c)),
        conserved: requests.conserved.then(|| {
            conserved_quantities_in_speeds(conserved::conserved_quantities(model, &joints), speeds.as_deref())
        }),
    };
    let own = (model, speeds.as_ref());
    let functions_with_specialisation =
        |specialisation| derive_and_lower_functions(own, requests, passes, &joints, &extras, specialisation);
    let constrained = !model.constraints.is_empty();
    if constrained && mechanics::constraints::elimination_product_count(model, &mass) > MOST_PRODUCTS {
        cx.report_error(model.place.clone(), "too many constraints of this mechanism are coupled").add_help(
            "the generated code has no loops and would be too long: connect the bodies by shorter chains of \
             joints",
        );
        return None;
    }
    let functions = functions_with_specialisation(ParameterSpecialisation::None);
    let prepared = requests.prepare.then(|| {
        prepared::extract_prepared_values(
            model.graph,
            functions_with_specialisation(ParameterSpecialisation::ByParameters),
        )
    });
    let mut constants = extras.identification.map_or_else(Vec::new, |i| i.identification_name_constants());
    constants.extend(extras.entries.map(|entries| AssociatedConstant::packed_entries_constant(&entries)));
    if let Some(kept) = &extras.conserved {
        let names: Vec<String> = kept.iter().map(|c| c.name.clone()).collect();
        constants.push(AssociatedConstant::conserved_names_constant(&names));
    }
    constants.extend(
        extras.routh.as_ref().map(|routh| AssociatedConstant::cyclic_coordinate_constant(&routh.cyclic)),
    );
    if requests.sensitivities {
        constants.push(AssociatedConstant::parameter_names_constant(&model.parameters));
    }
    constants.extend(drawing_constants(model, requests));
    let linear = printed_linear_equations(model, &joints, &mass, cx)?;
    constants.extend(AssociatedConstant::linear_equation_constants(&linear));
    let equations =
        printed_equations((model, speeds.as_deref()), &joints, &mass, (requests.equations, cyclic), cx)?;
    let output = DerivationOutput {
        equations,
        linear_equations: linear.into_iter().map(|(_, written)| written).collect(),
        prepared,
        constants,
        ..output_with_recursion_steps(model, &joints, functions)
    };
    validated_output(model, output, cx)
}

/// Derives the functions of a mechanism without dynamics: the configuration space, frames, constraints, the
/// forces of inputs, and outputs.
fn derive_kinematic<'g>(
    (model, speeds): (&Model<'g>, Option<&Rc<SpeedTransformation<'g>>>),
    requests: RequestedFunctions,
    passes: PassSelection,
    joints: &[Joint<'g>],
    cx: &mut Diagnostics,
) -> Option<DerivationOutput> {
    if !matches!(requests.equations, EquationsOption::Readable | EquationsOption::Structure) {
        cx.report_error(model.place.clone(), "without inertia there are no equations of motion to print")
            .add_help("remove `equations` or `inertia = none`");
        return None;
    }
    let RequestedFunctions { drawing, separate_contact, .. } = requests;
    let asked = RequestedFunctions { drawing, separate_contact, ..RequestedFunctions::default() };
    let own = (model, speeds);
    let functions = derive_and_lower_functions(
        own,
        asked,
        passes,
        joints,
        &OptionalFunctionData::default(),
        ParameterSpecialisation::None,
    );
    let constants = drawing_constants(model, requests);
    validated_output(
        model,
        DerivationOutput { constants, ..output_with_recursion_steps(model, joints, functions) },
        cx,
    )
}

/// Checks that the requested functions exist for a mechanism and are not too long; reports an error and
/// returns false otherwise.
fn check_requests(model: &Model<'_>, requests: RequestedFunctions, cx: &mut Diagnostics) -> bool {
    if let ([force, ..], Some(what)) =
        (model.acceleration_forces.as_slice(), request_excluded_without_momentum(requests))
    {
        cx.report_error(
            force.place.clone(),
            format!("a force that depends on accelerations excludes {what}"),
        )
        .add_help("remove the option that requests them, or these terms of the force");
        return false;
    }
    if let Some(what) = request_exceeding_code_limit(model, requests) {
        cx.report_error(model.place.clone(), format!("{what} would be too long")).add_help(
            "the generated code has no loops, and a line for each of them: request it for a smaller \
             mechanism",
        );
        return false;
    }
    true
}

/// Writes the values of conserved quantities in generalized speeds, if the mechanism defines any.
fn conserved_quantities_in_speeds<'g>(
    mut kept: Vec<ConservedQuantity<'g>>,
    speeds: Option<&SpeedTransformation<'g>>,
) -> Vec<ConservedQuantity<'g>> {
    if let Some(speeds) = speeds {
        kept.iter_mut().for_each(|c| c.value = speeds.express_in_speeds(&[c.value])[0]);
    }
    kept
}

/// Returns the associated constant that the option `drawing` adds, if the option is set.
fn drawing_constants(model: &Model<'_>, requests: RequestedFunctions) -> Vec<AssociatedConstant> {
    requests
        .drawing
        .then(|| AssociatedConstant::drawing_pieces_constant(&model.drawing))
        .into_iter()
        .collect()
}

/// Builds the output from the functions, and adds the steps that compute link and frame placements.
fn output_with_recursion_steps<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    functions: Vec<Function>,
) -> DerivationOutput {
    DerivationOutput {
        functions,
        links: joints.iter().map(|joint| link_recursion_programs(model, joint)).collect(),
        frames: model.frames.iter().map(|frame| frame_recursion_programs(model, frame)).collect(),
        charts: model.charts.clone(),
        equations: PrintedEquations::default(),
        linear_equations: Vec::new(),
        prepared: None,
        constants: Vec::new(),
    }
}

/// Checks the derived output: all coefficients must be finite, no expression may be NaN, and the number of
/// values of each program must match its result. Returns `None` with the error in `cx` otherwise.
fn validated_output(
    model: &Model<'_>,
    output: DerivationOutput,
    cx: &mut Diagnostics,
) -> Option<DerivationOutput> {
    if !output.all_functions().all(|f| f.program.has_only_finite_constants()) {
        cx.report_error(model.place.clone(), "the values of this mechanism are too large")
            .add_help("a product of masses, lengths or forces in its equations is not a finite number");
        return None;
    }
    if let Some(what) = output.non_finite_constant_operation() {
        cx.report_error(
            model.place.clone(),
            format!("the equations of this mechanism contain `{what}`, which is not a number"),
        )
        .add_help(
            "an expression divides by zero, or takes the root of a negative number, in every configuration",
        );
        return None;
    }
    if let Some(name) = output.function_with_mismatched_program() {
        cx.report_error(
            model.place.clone(),
            format!("internal error: the program of `{name}` does not match its arguments or its result"),
        )
        .add_help("this is an error of the compiler: please report it with the declaration of the mechanism");
        return None;
    }
    Some(output)
}

/// Returns the passes that the user has not switched off.
fn enabled_passes(passes: PassSelection, skipped: SkippedPasses) -> PassSelection {
    PassSelection {
        frames: passes.frames && !skipped.frames,
        regroup: passes.regroup && !skipped.regroup,
        parallel: passes.parallel && !skipped.parallel,
        lanes: passes.lanes && !skipped.limbs,
        ..passes
    }
}

/// Returns the first requested quantity that exists only if forces do not depend on accelerations: canonical
/// momenta or second derivatives. Returns `None` if no such quantity is requested.
fn request_excluded_without_momentum(requests: RequestedFunctions) -> Option<&'static str> {
    let canonical = requests.hamilton || requests.equations == EquationsOption::Hamilton;
    let reduced = requests.routh || requests.equations == EquationsOption::Routh;
    let asked = [
        (canonical, "Hamilton's equations"),
        (reduced, "Routh's equations"),
        (requests.second_derivatives, "second derivatives"),
        (requests.momentum_derivatives, "derivatives of momenta"),
    ];
    asked.into_iter().find_map(|(asked, what)| asked.then_some(what))
}

/// Maximum number of parameter derivatives, and of second derivatives of the energies and dissipation
/// functions of elements. Each has one term per velocity.
const MOST_DERIVATIVES: usize = 300_000;

/// Returns the requested derivatives whose code would be too long for rustc, if there are any.
fn request_exceeding_code_limit(model: &Model<'_>, requests: RequestedFunctions) -> Option<&'static str> {
    let squared = model.nv() * model.nv();
    let elements = model.potentials.len()
        + model.loads.len()
        + model.acceleration_forces.len()
        + model.inertances.len()
        + model.dissipations.len();
    if requests.sensitivities && squared * model.parameters.len() > MOST_DERIVATIVES {
        return Some("the code of the derivatives with respect to this many parameters");
    }
    (requests.derivatives && squared * elements > MOST_DERIVATIVES)
        .then_some("the code of the derivatives of this many elements")
}

/// Data that optional functions need in addition to the model.
#[derive(Default)]
struct OptionalFunctionData<'a, 'g> {
    /// Base parameters; present if the option `regressor` is set.
    identification: Option<IdentificationFunctions<'a, 'g>>,
    /// Row and column of each nonzero entry; present if the option `packed` is set.
    entries: Option<Vec<(usize, usize)>>,
    /// Hamilton's equations; present if the option `hamilton` is set.
    hamilton: Option<HamiltonEquations<'g>>,
    /// Routh's equations; present if the option `routh` is set.
    routh: Option<RouthEquations<'g>>,
    /// Conserved quantities; present if the option `conserved` is set.
    conserved: Option<Vec<ConservedQuantity<'g>>>,
}

/// Returns the cyclic coordinates if Routh's equations are requested. The outer `None` means that there are
/// none, or that the mechanism has constraints, with the error in `cx`.
fn cyclic_coordinates_for_routh<'g>(
    model: &Model<'g>,
    requests: RequestedFunctions,
    joints: &[Joint<'g>],
    cx: &mut Diagnostics,
) -> Option<Option<Vec<usize>>> {
    if !requests.routh && requests.equations != EquationsOption::Routh {
        return Some(None);
    }
    let (what, help) = match routh::cyclic_coordinates(model, joints) {
        _ if !model.constraints.is_empty() => (
            "Routh's equations require a mechanism without constraints",
            "remove the option; `conserved` finds the momenta that the constraints conserve",
        ),
        found if found.is_empty() => (
            "no coordinate of this mechanism is cyclic",
            "Routh's equations eliminate plain coordinates on which the Lagrangian does not depend and on \
             which no damping acts: remove the option",
        ),
        found => return Some(Some(found)),
    };
    cx.report_error(model.place.clone(), what).add_help(help);
    None
}

/// Returns whether constraints determine coordinates without inertia, so that momenta do not determine the
/// velocities.
fn has_massless_coordinates(model: &Model<'_>) -> bool {
    model.constraints.iter().any(|c| c.determines)
}

impl<'g> OptionalFunctionData<'_, 'g> {
    fn facts_of_model(&self, model: &Model<'g>, requests: RequestedFunctions) -> Facts {
        let [bodies, base] = self
            .identification
            .as_ref()
            .map(IdentificationFunctions::body_and_base_parameter_counts)
            .unwrap_or_default();
        let entries = self.entries.clone().unwrap_or_default();
        let passive = model.passive.as_ref().map(|passive| passive.derivatives.len());
        let conserved = self.conserved.as_ref().map(Vec::len).unwrap_or_default();
        let cyclic = self.routh.as_ref().map(|routh| routh.cyclic.len()).unwrap_or_default();
        Facts { bodies, base, entries, passive, conserved, cyclic, ..Facts::from_model(model, requests) }
    }
}

/// Returns row and column of the entries of the lower triangle that are not always zero, column by column.
fn nonzero_mass_entries(mass: &crba::Matrix<'_>) -> Vec<(usize, usize)> {
    let n = mass.len();
    let all = (0..n).flat_map(|j| (j..n).map(move |i| (i, j)));
    all.filter(|(i, j)| !mass[*i][*j].is_zero()).collect()
}

/// Derives all functions of a mechanism and lowers them to programs.
fn derive_and_lower_functions<'g>(
    (model, speeds): (&Model<'g>, Option<&Rc<SpeedTransformation<'g>>>),
    requests: RequestedFunctions,
    passes: PassSelection,
    joints: &[Joint<'g>],
    extras: &OptionalFunctionData<'_, 'g>,
    specialisation: ParameterSpecialisation,
) -> Vec<Function> {
    let given = match speeds {
        Some(_) => None,
        None => passive::model_with_passive_force_symbols(model, requests.derivatives),
    };
    let model = speeds.map_or(given.as_ref().unwrap_or(model), |speeds| &speeds.model);
    let facts = extras.facts_of_model(model, requests);
    let passes =
        PassSelection { free_parameters: specialisation == ParameterSpecialisation::ByParameters, ..passes };
    let derivation = Derivation::new(model, joints, speeds, passes, specialisation, &facts);
    let functions =
        derivation.derive_declared_functions(catalogue::functions_derived_before_outputs(&facts), Vec::new());
    let functions =
        derivation.derive_declared_functions(outputs::declared_output_functions(model, &facts), functions);
    let by_variants = facts.requests.derivatives && speeds.is_none();
    let variants = if by_variants { derivatives::model_variants(model, passes) } else { Vec::new() };
    let derivatives = DerivativeFunctions::new(model, &variants, passes, specialisation);
    // The structure of the derivatives of a large mechanism is known only at this point.
    let calls =
        derivatives.as_ref().is_some_and(DerivativeFunctions::forward_dynamics_derivatives_call_functions);
    let calls_linear = derivatives.as_ref().is_some_and(DerivativeFunctions::linearization_calls_functions);
    let facts = Facts { calls, calls_linear, ..facts.clone() };
    let derivation = derivation.with_option_data(&facts, extras, derivatives.as_ref());
    let mut functions =
        derivation.derive_declared_functions(catalogue::functions_derived_after_outputs(&facts), functions);
    run_final_lowering_passes(&mut functions, requests.reproducible);
    functions
}

/// Applies the last passes of lowering, which consider whole programs. In reproducible arithmetic, a program
/// computes the same bits as its variant with lanes.
fn run_final_lowering_passes(functions: &mut [Function], reproducible: bool) {
    for f in functions {
        pipeline::set_observed_function_name(&f.name);
        f.program = std::mem::take(&mut f.program).run_passes(pipeline::FINISH);
        if let Some(simd) = f.program.simd.take_if(|_| reproducible) {
            let program = simd.expand_lanes().run_passes(&[pipeline::SCHEDULE]);
            f.program = Program { simd: Some(simd), ..program };
        }
        f.loops = f.loops.take().filter(|_| !reproducible);
        if let Some(loops) = &mut f.loops {
            loops.program = std::mem::take(&mut loops.program).run_passes(pipeline::FINISH);
        }
    }
}

/// Returns the equations of motion as plain text, one line per equation. The text is empty if the equations
/// are too long to be readable.
pub fn equations_as_text(model: &Model<'_>) -> String {
    equations_in_joint_velocities(model).plain
}

/// Returns the equations of motion as LaTeX: an `aligned` environment for math mode, with `amsmath`.
pub fn equations_latex(model: &Model<'_>) -> String {
    equations_in_joint_velocities(model).latex
}

fn equations_in_joint_velocities(model: &Model<'_>) -> PrintedEquations {
    let speeds = SpeedTransformation::new(model);
    let model = speeds.as_ref().map_or(model, |speeds| &speeds.native);
    let joints = kinematics::joints_of_model(model);
    format_readable_equations((model, speeds.as_ref()), &joints, &crba::mass_matrix(model, &joints))
}

/// Returns the requested form of the equations of motion. Readable equations are empty if they would be too
/// long; other forms return `None` with the error in `cx`.
fn printed_equations<'g>(
    (model, speeds): (&Model<'g>, Option<&SpeedTransformation<'g>>),
    joints: &[Joint<'g>],
    mass: &crba::Matrix<'g>,
    (printed, cyclic): (EquationsOption, Option<Vec<usize>>),
    cx: &mut Diagnostics,
) -> Option<PrintedEquations> {
    let mut report_unavailable_equations = |what: &str, help: &str| {
        cx.report_error(model.place.clone(), what.to_string()).add_help(help);
        None
    };
    match printed {
        EquationsOption::Readable => Some(format_readable_equations((model, speeds), joints, mass)),
        EquationsOption::Structure => Some(PrintedEquations::default()),
        EquationsOption::Kane if model.constraints.iter().any(|c| !c.friction.is_empty()) => {
            report_unavailable_equations(
                "the equations of a slipping contact contain its normal force, which is a multiplier",
                "write `equations = lagrange`",
            )
        }
        EquationsOption::Kane if !model.constraints.is_empty() => {
            let named = speeds.map_or(model, |speeds| &speeds.model);
            match kane::kane_equations(model, joints, speeds) {
                Ok(found) => Some(kane::format_kane_equations(named, &found)),
                Err(kane::KaneFailure::Choice) => report_unavailable_equations(
                    "no velocities of this mechanism are determined by the others through its constraints in \
                     every configuration",
                    "write `equations = lagrange`, which keeps all constraints with multipliers",
                ),
                Err(kane::KaneFailure::Length) => report_unavailable_equations(
                    "Kane's equations of this mechanism have thousands of terms",
                    "write `equations = lagrange`, which keeps the constraints with multipliers, or declare \
                     generalized speeds in which the equations are shorter",
                ),
            }
        }
        // Without constraints all velocities are independent, and Kane's equations equal Lagrange's.
        EquationsOption::Lagrange | EquationsOption::Kane => {
            let equations = equations::derive(model, joints, mass, speeds, &EquationSizeLimits::ASKED);
            let named = speeds.map_or(model, |speeds| &speeds.model);
            equations.map(|e| equations::format_equations(named, &e)).or_else(|| {
                report_unavailable_equations(
                    "the equations of this mechanism have thousands of terms, or more symbols and functions \
                     than are expanded",
                    "`equations = structure` prints their structure; the generated functions do not expand \
                     them",
                )
            })
        }
        EquationsOption::Routh => {
            let reduced = cyclic.and_then(|cyclic| reduced::routh_equations(model, joints, mass, cyclic));
            reduced.map(|r| reduced::format_routh_equations(model, &r)).or_else(|| {
                report_unavailable_equations(
                    "Routh's equations of this mechanism are too long: more than three cyclic coordinates \
                     are coupled by inertia, or thousands of terms",
                    "the option `routh` generates them as functions; `equations = lagrange` prints \
                     Lagrange's equations",
                )
            })
        }
        EquationsOption::Hamilton if !model.constraints.is_empty() => report_unavailable_equations(
            "Hamilton's equations are printed only for mechanisms without constraints",
            "write `equations = lagrange`; the option `hamilton` generates the functions with constraints as \
             well",
        ),
        EquationsOption::Hamilton if speeds.is_some() => report_unavailable_equations(
            "Hamilton's equations are printed in the momenta of coordinates, not of declared speeds",
            "write `equations = lagrange`, which prints Kane's equations in speeds; the option `hamilton` \
             generates the functions in speeds as well",
        ),
        EquationsOption::Hamilton => {
            let canonical = equations::canonical_equations(model, joints, mass);
            canonical.map(|c| equations::format_canonical_equations(model, &c)).or_else(|| {
                report_unavailable_equations(
                    "Hamilton's equations of this mechanism are too long: more than three velocities are \
                     coupled by inertia, or thousands of terms",
                    "the option `hamilton` generates them as functions; `equations = lagrange` prints \
                     Lagrange's equations",
                )
            })
        }
    }
}

/// Returns the equations linearised about each declared equilibrium, with its name. Returns `None` with the
/// errors in `cx` if one of them has no linear equations.
fn printed_linear_equations<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mass: &crba::Matrix<'g>,
    cx: &mut Diagnostics,
) -> Option<Vec<(String, PrintedEquations)>> {
    let mut all = Vec::new();
    for at in &model.equilibria {
        let found = linear::derive_linear_equations(model, joints, mass, at, cx);
        all.extend(found.map(|found| (at.name.clone(), linear::format_linear_equations(model, at, &found))));
    }
    (all.len() == model.equilibria.len()).then_some(all)
}

fn format_readable_equations<'g>(
    (model, speeds): (&Model<'g>, Option<&SpeedTransformation<'g>>),
    joints: &[Joint<'g>],
    mass: &crba::Matrix<'g>,
) -> PrintedEquations {
    let limits =
        if speeds.is_some() { EquationSizeLimits::READABLE_IN_SPEEDS } else { EquationSizeLimits::READABLE };
    let equations = equations::derive(model, joints, mass, speeds, &limits);
    let named = speeds.map_or(model, |speeds| &speeds.model);
    let inertia_equations =
        || equations::derive_inertial_terms(model, joints, mass, &limits).filter(|_| speeds.is_none());
    equations
        .or_else(inertia_equations)
        .map_or_else(PrintedEquations::default, |e| equations::format_equations(named, &e))
}

/// Lowers the outputs of one step of the kinematic recursion from link to link.
fn lower_recursion_step(outputs: &[Expr<'_>]) -> Program {
    lower(outputs).run_passes(pipeline::PART)
}

fn link_recursion_programs<'g>(model: &Model<'g>, joint: &Joint<'g>) -> LinkRecursionPrograms {
    let v = mechanics::velocity_symbols(model);
    let a = mechanics::acceleration_symbols(model);
    let columns: Vec<Expr<'g>> =
        frames::frame_jacobian_columns(model, joint).iter().flat_map(frames::spatial_components).collect();
    LinkRecursionPrograms {
        parent: joint.parent.map(|p| p.0),
        velocities: joint.dofs.iter().map(|d| d.index).collect(),
        driven: joint.drift.is_some(),
        placement: lower_recursion_step(&frames::link_placement(model, joint).rotation_and_position()),
        twist: lower_recursion_step(&frames::spatial_components(&frames::link_twist(model, joint, &v))),
        acceleration: lower_recursion_step(&frames::spatial_components(&frames::link_acceleration(
            model, joint, &v, &a,
        ))),
        columns: lower_recursion_step(&columns),
    }
}

fn frame_recursion_programs<'g>(
    model: &Model<'g>,
    frame: &crate::mechanism::NamedFrame<'g>,
) -> FrameRecursionPrograms {
    FrameRecursionPrograms {
        name: frame.name.clone(),
        link: frame.link.map(|l| l.0),
        is_link: frame.pose.rotation.is_identity() && frame.pose.translation.is_zero(),
        placement: lower_recursion_step(&frames::frame_placement(model, frame).rotation_and_position()),
        twist: lower_recursion_step(&frames::spatial_components(&frames::frame_twist(model, frame))),
        acceleration: lower_recursion_step(&frames::spatial_components(&frames::frame_acceleration(
            model, frame,
        ))),
    }
}
