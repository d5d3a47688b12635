//! Model → everything that is generated: the mechanics of each function, lowered.

use crate::diag::Diagnostics;
use crate::emit::frames::{FrameSteps, LinkSteps};
use crate::emit::{Argument, Function, Output, Shape};
use crate::expr::Expr;
use crate::expr::diff::Derivative;
use crate::expr::print::Written;
use crate::lower::{Program, lower};
use crate::mechanics::{self, Joint, crba, energy, forces, frames, power};
use crate::model::kinematics::{symbols_in, time_derivative};
use crate::model::{Chart, Model, OutputValue, Quantity};
use crate::passes::Passes;

pub mod derivatives;
mod dynamics;

/// Derives everything. `None` if the mass matrix cannot be inverted, with the reason in `cx`.
pub fn derive<'g>(model: &Model<'g>, cx: &mut Diagnostics) -> Option<Output> {
    derive_with(model, Passes::default(), cx)
}

/// The same with a choice of passes.
pub fn derive_with<'g>(model: &Model<'g>, passes: Passes, cx: &mut Diagnostics) -> Option<Output> {
    let joints = mechanics::joints(model);
    let mass = crba::mass_matrix(model, &joints);
    if let Some(k) = mechanics::regularity::singular_velocity(model, &joints, &mass) {
        let (name, place) = &model.velocities[k];
        let diagnostic =
            cx.error(place.clone(), format!("the coordinate `{name}` moves nothing that has inertia"));
        diagnostic.help("the mass matrix is singular: give mass or inertia to what the joint carries");
        if place.file.is_some() {
            diagnostic.help(format!("or freeze the joint: `lock = [\"{name}\"]`"));
        }
        return None;
    }
    let mut functions = signatures(model.nq(), model.nv(), model.time, model.velocity_inputs);
    let dynamics = dynamics::Dynamics::new(model, passes);
    for f in &mut functions {
        f.program = match f.name.as_str() {
            "neutral" => done(&neutral(model)),
            "generalized_forces" => done(&forces::generalized_forces(model, &joints)),
            "dissipated_power" => done(&[power::dissipated(model)]),
            "control_power" => done(&[power::control(model, &joints)]),
            "disturbance_power" => done(&[power::disturbance(model)]),
            "total_mass" => done(&[energy::mass_and_moment(model, &joints).0]),
            name => dynamics.program(name).unwrap_or_default(),
        };
    }
    if functions.iter().any(|f| !f.program.is_finite()) {
        cx.error(model.place.clone(), "the figures of this mechanism are too large")
            .help("a product of masses, lengths or forces in its equations is not a finite number");
        return None;
    }
    functions.extend(model.outputs.iter().flat_map(|output| output_functions(model, output)));
    Some(Output {
        functions,
        links: model.links.iter().zip(&joints).map(|(_, joint)| link_steps(model, joint)).collect(),
        frames: model.frames.iter().map(|frame| frame_steps(model, frame)).collect(),
        charts: model.charts.clone(),
        equations: written(model),
    })
}

/// The equations of motion in a line each; empty for mechanisms that are too large to be read.
pub fn equations(model: &Model<'_>) -> String {
    written(model).plain
}

/// The same as LaTeX: an `aligned` environment for math mode, with `amsmath`.
pub fn equations_latex(model: &Model<'_>) -> String {
    written(model).latex
}

fn written(model: &Model<'_>) -> Written {
    if !mechanics::equations::is_small(model) {
        return Written::default();
    }
    let joints = mechanics::joints(model);
    let mass = crba::mass_matrix(model, &joints);
    let equations = mechanics::equations::derive(model, &joints, &mass);
    equations.map_or_else(Written::default, |e| mechanics::equations::written(model, &e))
}

fn done(outputs: &[Expr<'_>]) -> Program {
    lower(outputs).fused()
}

/// The function of an output, and its Jacobian: how it changes with the velocities, or how its rate does if it depends
/// on the configuration alone.
fn output_functions(model: &Model<'_>, output: &OutputValue<'_>) -> Vec<Function> {
    let symbols: Vec<Quantity> = symbols_in(&output.values).into_iter().map(Quantity::of).collect();
    let has = |f: fn(&Quantity) -> bool| symbols.iter().any(f);
    let by_v = has(|q| matches!(q, Quantity::Velocity(_)));
    let by_a = has(|q| matches!(q, Quantity::Acceleration(_)));
    let by_u = has(|q| matches!(q, Quantity::Input(_)));
    let mut arguments = vec![Argument::Q];
    arguments.extend((by_v || by_a).then_some(Argument::V));
    arguments.extend(by_a.then_some(Argument::A));
    arguments.extend(by_u.then_some(Argument::U));
    if model.time {
        arguments.insert(0, Argument::T);
    }
    let shape = if output.values.len() == 1 { Shape::Scalar } else { Shape::Vector(output.values.len()) };
    let mut functions = vec![Function {
        name: output.name.clone(),
        docs: vec![format!("The output `{}`.", output.name)],
        arguments: arguments.clone(),
        shape,
        program: done(&output.values),
    }];
    if by_a {
        return functions;
    }
    let rates: Vec<Expr<'_>> = match by_v {
        true => output.values.clone(),
        false => output.values.iter().map(|e| time_derivative(model.space(), *e)).collect(),
    };
    let mut entries = Vec::new();
    for k in 0..model.nv() {
        let mut d = Derivative::with_respect_to(Quantity::Velocity(k).symbol(), model.graph);
        entries.extend(rates.iter().map(|e| d.of(*e)));
    }
    let what = if by_v { "it changes with the velocities" } else { "its rate is this times `v`" };
    functions.push(Function {
        name: format!("{}_jacobian", output.name),
        docs: vec![format!("Jacobian of the output `{}`: {what}.", output.name)],
        arguments,
        shape: Shape::Matrix(output.values.len(), model.nv()),
        program: done(&entries),
    });
    functions
}

fn neutral<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    let g = model.graph;
    let mut q = vec![g.zero(); model.nq()];
    for chart in &model.charts {
        match chart {
            Chart::Plain(..) => {}
            Chart::Ball(k, _) => q[*k + 3] = g.one(),
            Chart::Free(k, _) => q[*k + 6] = g.one(),
        }
    }
    q
}

fn link_steps<'g>(model: &Model<'g>, joint: &Joint<'g>) -> LinkSteps {
    let v = mechanics::velocities(model);
    let a = mechanics::accelerations(model);
    let columns: Vec<Expr<'g>> =
        frames::jacobian_columns(model, joint).iter().flat_map(frames::flat).collect();
    LinkSteps {
        parent: joint.parent.map(|p| p.0),
        velocities: joint.dofs.iter().map(|d| d.index).collect(),
        driven: joint.drift.is_some(),
        placement: done(&frames::link_placement(model, joint).flat()),
        twist: done(&frames::flat(&frames::link_twist(model, joint, &v))),
        acceleration: done(&frames::flat(&frames::link_acceleration(model, joint, &v, &a))),
        columns: done(&columns),
    }
}

fn frame_steps<'g>(model: &Model<'g>, frame: &crate::model::NamedFrame<'g>) -> FrameSteps {
    FrameSteps {
        name: frame.name.clone(),
        link: frame.link.map(|l| l.0),
        is_link: frame.pose.rotation.is_identity() && frame.pose.translation.is_zero(),
        placement: done(&frames::frame_placement(model, frame).flat()),
        twist: done(&frames::flat(&frames::frame_twist(model, frame))),
        acceleration: done(&frames::flat(&frames::frame_acceleration(model, frame))),
    }
}

/// The public functions without their programs: names, arguments, results, documentation.
pub fn signatures(nq: usize, nv: usize, time: bool, velocity_inputs: bool) -> Vec<Function> {
    use Argument::{A, Q, Tau, U, V};
    let function = |name: &str, arguments: &[Argument], shape, docs: &[&str]| Function {
        name: name.to_string(),
        docs: docs.iter().map(ToString::to_string).collect(),
        arguments: match name {
            "neutral" | "total_mass" => Vec::new(),
            _ => time.then_some(Argument::T).into_iter().chain(arguments.iter().copied()).collect(),
        },
        shape,
        program: Program::default(),
    };
    vec![
        function(
            "neutral",
            &[],
            Shape::Vector(nq),
            &["The configuration with all coordinates zero and unit quaternions."],
        ),
        function(
            "mass_matrix",
            &[Q],
            Shape::Square(nv),
            &[
                "Mass matrix `M(q)`, symmetric positive definite, both triangles.",
                "",
                "Composite-rigid-body algorithm (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 6). kg between translations, kg·m² between rotations, kg·m mixed.",
            ],
        ),
        function(
            "bias_forces",
            &[Q, V],
            Shape::Vector(nv),
            &[
                "Bias forces `h(q, v)`: Coriolis and centrifugal forces, gravity, springs, dashpots, friction. N for translations, N·m for rotations.",
                "",
                "Recursive Newton–Euler algorithm without accelerations.",
            ],
        ),
        function(
            "inverse_dynamics",
            &[Q, V, A],
            Shape::Vector(nv),
            &[
                "`τ = M(q) a + h(q, v)`: the forces (N) and torques (N·m) that give the acceleration `a`.",
                "",
                "Recursive Newton–Euler algorithm (Featherstone 2008, ch. 5).",
            ],
        ),
        function(
            "forward_dynamics",
            &[Q, V, Tau],
            Shape::Vector(nv),
            &[
                "`v̇ = M(q)⁻¹ (τ − h(q, v))`: the acceleration that the forces `tau` give. Not finite where `M(q)` is singular.",
                "",
                "Articulated-body algorithm, or sparse factorisation of `M`, whichever costs less (Featherstone 2008, ch. 6, 7).",
            ],
        ),
        function(
            "generalized_forces",
            if velocity_inputs { &[Q, V, U] } else { &[Q, U] },
            Shape::Vector(nv),
            &["What the inputs `u` contribute to `τ`, by virtual work."],
        ),
        function("kinetic_energy", &[Q, V], Shape::Scalar, &["Kinetic energy `T = ½ vᵀ M(q) v`, J."]),
        function(
            "potential_energy",
            &[Q],
            Shape::Scalar,
            &["Potential energy `U(q)` of gravity (zero at the ground's origin) and springs, J."],
        ),
        function("generalized_momentum", &[Q, V], Shape::Vector(nv), &["Generalized momentum `p = M(q) v`."]),
        function(
            "momentum_rate",
            &[Q, V],
            Shape::Vector(nv),
            &[
                "Rate of the generalized momentum without inputs: `ṗ = momentum_rate(q, v) + τ`.",
                "",
                "Hamilton's second equation; for ball and free joints in body components (Euler–Poincaré).",
            ],
        ),
        function(
            "dissipated_power",
            &[Q, V],
            Shape::Scalar,
            &[
                "Power that dashpots, friction and dissipation functions take out, W.",
                "",
                "Unless the mechanism is driven in time, `d(T + U)/dt = control_power + disturbance_power − dissipated_power`.",
            ],
        ),
        function("control_power", &[Q, V, U], Shape::Scalar, &["Power of the inputs `u`, W."]),
        function(
            "disturbance_power",
            &[Q, V],
            Shape::Scalar,
            &["Power of applied forces that are neither conservative nor dissipative nor inputs, W."],
        ),
        function("total_mass", &[], Shape::Scalar, &["Mass of everything that moves, kg."]),
        function(
            "center_of_mass",
            &[Q],
            Shape::Vector(3),
            &["Centre of mass of everything that moves, m, from the ground's origin in ground axes."],
        ),
        function(
            "momentum",
            &[Q, V],
            Shape::Vector(6),
            &["Momentum in ground axes: linear (kg·m/s), then angular about the centre of mass (kg·m²/s)."],
        ),
    ]
}
