//! Assembly of the model: scope, tree, links, bodies and force elements.

use super::accelerations::check_acceleration_forces;
use super::builder::{Builder, ComputedMotionsProof};
use super::chain::report_joint_argument_errors;
use super::closed_form::find_closed_form_loops;
use super::drawing::mechanism_drawing_pieces;
use super::equilibria::resolve_equilibria;
use super::forces::resolve_coordinate_actions;
use super::limit::resolve_limits;
use super::masses::check_products_of_inertial_parameters;
use super::numbering::CoordinateNumbering;
use super::reaction::ReleasedJoints;
use super::requirements::gather_requirements;
use super::scope::{AllowedQuantities, Axes, Context, PlacedElements, ResolutionRecords, Scope, Value};
use super::terms::set_signature_dependencies;
use super::tree::{find_spanning_tree, loop_closing_flags};
use super::{drive, reaction, units};
use crate::diag::{Diagnostics, join_names_with_and};
use crate::expr::{Graph, Vec3};
use crate::kinematics::CachedDerivatives;
use crate::language::{Builtin, Callable};
use crate::mechanism::{
    Constraint, DegreeOfFreedomCounts, DerivativeCache, Inertia, Model, ReleasedMechanism, Rule, Units,
};
use crate::syntax::{Description, GROUND, InertiaOption, Name};
use std::rc::Rc;

/// Maximum number of velocities of a mechanism. The generated code would be unreasonably large beyond it.
const MAX_VELOCITIES: usize = 256;
/// Maximum number of unused parameters that are reported separately.
const MAX_SEPARATE_REPORTS: usize = 3;

/// Help text for mechanisms with too many velocities.
const DIVIDE_HELP: &str = "the generated code has no loops, and that of the mass matrix grows with the \
                           square of the degrees of freedom: divide the mechanism into several, weld parts \
                           that hardly move (`Weld`, `lock = [\"joint\"]` of a file), or compute a long \
                           chain by a loop of your own";

/// Maximum number of bodies of a mechanism.
const MAX_BODIES: usize = 1024;

/// Default speed at which dry friction is regularised, m/s.
const FRICTION_SPEED: f64 = 0.01;

/// Checks a description and builds its model. Returns `None` after an error; all errors are in `cx`.
pub fn build_model<'g>(
    description: &Description,
    graph: &'g Graph,
    cx: &mut Diagnostics,
) -> Option<Model<'g>> {
    if description.bodies.len() + description.particles.len() > MAX_BODIES {
        cx.report_error(description.name.place.clone(), format!("more than {MAX_BODIES} bodies"))
            .add_help("each body adds code: divide the mechanism, or weld bodies that do not move into one");
        return None;
    }
    if description.bodies.is_empty() && description.particles.is_empty() {
        cx.report_error(description.name.place.clone(), "a mechanism without a body").add_help(
            "add one, as in `#[body(mass = 1)] cart: Body`, or read a file: `#[mechanism(urdf = \
             \"robot.urdf\")]`",
        );
        return None;
    }
    let mut model = build_with_released_joints(description, graph, None, cx)?;
    let joints = reaction::joints_to_release(&model);
    if !joints.is_empty() {
        let released_model =
            build_with_released_joints(description, graph, Some((&joints, &model.constraints)), cx)?;
        for output in model.outputs.iter_mut().filter(|output| output.diagram.is_some()) {
            // The forces on a body are the reactions of its released joints.
            let found = released_model.outputs.iter().find(|other| other.name == output.name);
            found.into_iter().for_each(|found| output.clone_from(found));
        }
        model.released = Some(Rc::new(ReleasedMechanism { model: released_model, joints }));
    }
    Some(model)
}

/// Builds the model. A model with released joints has only the given constraints.
fn build_with_released_joints<'g>(
    description: &Description,
    graph: &'g Graph,
    releasing: Option<(&[usize], &[Constraint<'g>])>,
    cx: &mut Diagnostics,
) -> Option<Model<'g>> {
    let mut builder = Builder::new(description, graph, releasing, cx);
    if builder.model.nv() > MAX_VELOCITIES && releasing.is_none() {
        let n = builder.model.nv();
        cx.report_error(
            description.name.place.clone(),
            format!("{n} degrees of freedom, more than {MAX_VELOCITIES}"),
        )
        .add_help(DIVIDE_HELP);
        return None;
    }
    let order = find_spanning_tree(description, &builder.jointed, &builder.scope, cx);
    match &order {
        Some(order) => builder.place_all_elements(order, cx),
        None => description
            .joints
            .iter()
            .for_each(|joint| report_joint_argument_errors(&builder.scope, joint, cx)),
    }
    builder.add_masses(cx);
    match order.and_then(|order| Some((order, builder.compute_link_motions()?))) {
        Some((order, moving)) => builder.add_all_elements(&order.closing, moving, cx),
        None => resolve_coordinate_actions(&builder.scope, cx),
    }
    builder.report_unused_parameters(cx);
    builder.model.requirements = gather_requirements(&builder.scope, &builder.model);
    if cx.is_empty() && releasing.is_none() {
        let coordinates = &builder.scope.kinematics.coordinates;
        builder.model.units = units::infer_units(description, &builder.model, coordinates, cx);
    }
    if !description.partial {
        cx.append_errors(builder.mobility);
    }
    cx.is_empty().then_some(builder.model)
}

/// Returns a model of a mechanism without bodies.
fn empty_model<'g>(
    graph: &'g Graph,
    description: &Description,
    gravity: Vec3<'g>,
    friction_speed: crate::expr::Expr<'g>,
) -> Model<'g> {
    Model {
        graph,
        name: description.name.text.clone(),
        place: description.name.place.clone(),
        parameters: description.parameters.iter().map(|p| p.text.clone()).collect(),
        kinematic: description.inertias == InertiaOption::None,
        gravity,
        friction_speed,
        links: Vec::new(),
        still: Inertia::zero(graph),
        time: false,
        velocity_inputs: false,
        charts: Vec::new(),
        gradients: DerivativeCache::default(),
        configuration: Vec::new(),
        initial_configuration: None,
        velocities: Vec::new(),
        speeds: None,
        inputs: Vec::new(),
        limits: Vec::new(),
        equilibria: Vec::new(),
        contacts: Vec::new(),
        polytopes: Vec::new(),
        requirements: Vec::new(),
        frames: Vec::new(),
        drawing: Vec::new(),
        heights: Vec::new(),
        springs: Vec::new(),
        dashpots: Vec::new(),
        frictions: Vec::new(),
        potentials: Vec::new(),
        dissipations: Vec::new(),
        constraints: Vec::new(),
        redundant: Vec::new(),
        dependent: None,
        solved: Vec::new(),
        freedom: DegreeOfFreedomCounts::default(),
        loads: Vec::new(),
        acceleration_forces: Vec::new(),
        passive: None,
        inertances: Vec::new(),
        outputs: Vec::new(),
        released: None,
        units: Units::default(),
    }
}

impl<'a, 'g> Builder<'a, 'g> {
    fn new(
        description: &'a Description,
        graph: &'g Graph,
        releasing: Option<(&'a [usize], &'a [Constraint<'g>])>,
        cx: &mut Diagnostics,
    ) -> Builder<'a, 'g> {
        let unplaced = description.particles.iter().filter(|p| p.at.is_none()).map(|p| &p.name);
        let jointed: Vec<&Name> = description.bodies.iter().map(|b| &b.name).chain(unplaced).collect();
        let all =
            description.bodies.iter().map(|b| &b.name).chain(description.particles.iter().map(|p| &p.name));

        let scope = Scope {
            graph,
            description,
            bodies: all
                .clone()
                .chain(description.frames.iter().map(|f| &f.name))
                .map(|n| n.text.clone())
                .collect(),
            driven: description.joints.iter().filter(|j| j.driven && j.mimic.is_none()).count()
                + drive::drives_that_are_inputs(description).count(),
            context: Context::new(AllowedQuantities::Constant, None).into(),
            kinematics: PlacedElements::default(),
            records: ResolutionRecords {
                used: vec![false; description.parameters.len()],
                used_tables: vec![false; description.tables.len()],
                ..ResolutionRecords::default()
            }
            .into(),
        };
        graph.set_table_names(description.tables.iter().map(|table| table.name.text.clone()).collect());
        for name in all.filter(|n| n.text == GROUND) {
            let message = "the name `ground` is reserved for the fixed reference";
            cx.report_error(name.place.clone(), message).add_help(
                "choose another name, or remove the body: joints can start at `ground` without a declaration",
            );
        }
        report_reserved_names(description, cx);
        let gravity = description.gravity.as_ref().and_then(|e| resolve_gravity_vector(e, &scope, cx));
        let friction_speed = match &description.friction_speed {
            Some(e) => scope.resolve_scalar(e, cx).unwrap_or(graph.one()),
            None => graph.num(FRICTION_SPEED),
        };
        if let (Some(e), Some(s)) = (&description.friction_speed, friction_speed.constant_value())
            && s <= 0.0
        {
            cx.report_error(e.place.clone(), format!("this speed must be positive, but it is {s}"))
                .add_help("Coulomb's law is smoothed below this speed; 0.01 is usual");
        }
        scope.record_parameter_condition(
            Rule::Positive,
            || "the speed of friction".to_string(),
            &[friction_speed],
        );
        let model = empty_model(graph, description, gravity.unwrap_or(Vec3::zero(graph)), friction_speed);
        let mut builder = Builder {
            scope,
            model,
            jointed,
            solved_loops: Vec::new(),
            release: releasing.map(|(joints, retained)| ReleasedJoints::of_joints(joints, retained)),
            moving_placements: Vec::new(),
            frame_links: Vec::new(),
            surfaces: Vec::new(),
            partials: CachedDerivatives::default(),
            group: 0,
            mobility: Diagnostics::new(),
        };
        builder.assign_coordinate_indices(cx);
        builder
    }

    /// Numbers the entries of `q` and `v`, those of released joints last.
    fn assign_coordinate_indices(&mut self, cx: &mut Diagnostics) {
        let d = self.scope.description;
        let closing = loop_closing_flags(d);
        self.solved_loops = find_closed_form_loops(d, &closing, cx);
        let mut numbering =
            CoordinateNumbering::number_description_coordinates(d, (&closing, &self.solved_loops), cx);
        if let Some(release) = &self.release {
            self.scope.kinematics.first_released = Some(numbering.next_coordinate_indices());
            numbering.add_released_coordinates(d, release.joints);
        }
        self.model.configuration = numbering.configuration;
        self.model.velocities = numbering.velocities;
        self.model.charts = numbering.charts;
        if !numbering.initial.is_empty() {
            let mut initial = self.model.neutral_configuration();
            for (first, values) in &numbering.initial {
                initial[first.range_of_entries(values.len())].copy_from_slice(values);
            }
            self.model.initial_configuration = Some(initial);
        }
        self.scope.kinematics.coordinates = numbering.coordinates;
        self.scope.kinematics.joint_coordinates = numbering.joints;
    }

    /// Adds all elements to the placed links.
    fn add_all_elements(&mut self, closing: &[usize], moving: ComputedMotionsProof, cx: &mut Diagnostics) {
        self.add_file_force_elements(moving, cx);
        self.add_actions(moving, cx);
        self.model.limits = resolve_limits(&self.scope, &self.model, cx);
        let solved = self.record_loops_with_closed_form(cx);
        let constrained = self.add_constraints(closing, (moving, solved), cx);
        self.record_slipping_power();
        self.add_contacts(moving, cx);
        if self.release.is_none() {
            check_acceleration_forces(&self.model, cx);
        }
        self.add_energies_and_outputs(constrained, cx);
        if self.release.is_none() {
            self.model.equilibria = resolve_equilibria(&self.scope, &self.model, cx);
        }
        set_signature_dependencies(&mut self.model);
        self.add_speeds(constrained, cx);
        self.add_frames();
        check_products_of_inertial_parameters(&self.scope, &self.model, cx);
        if cx.is_empty() && self.scope.description.drawing {
            (self.model.drawing, self.model.heights) =
                mechanism_drawing_pieces(&self.scope, &self.model, &self.surfaces);
        }
    }

    /// Reports unused parameters, which are most likely typing errors. A leading underscore marks a parameter
    /// that is unused intentionally.
    fn report_unused_parameters(&self, cx: &mut Diagnostics) {
        if !cx.is_empty() {
            return;
        }
        let records = self.scope.records.borrow();
        let unused = self.scope.description.parameters.iter().zip(&records.used);
        let names = self.scope.description.tables.iter().map(|table| &table.name);
        let unused = unused.chain(names.zip(&records.used_tables));
        // A state counts as used: its value is visible to the caller that integrates it.
        let is_state = |p: &Name| self.scope.description.states.iter().any(|(state, _)| state.text == p.text);
        let separate = &self.scope.description.separate_contact_parameters;
        let unused = unused.filter(|(p, _)| !is_state(p) && !separate.contains(&p.text));
        let unused: Vec<_> =
            unused.filter(|(p, used)| !**used && !p.text.starts_with('_')).map(|(p, _)| p).collect();
        // Many unused parameters are reported as one error.
        if let [first, rest @ ..] = unused.as_slice()
            && rest.len() >= MAX_SEPARATE_REPORTS
        {
            let list: Vec<String> = unused.iter().map(|p| format!("`{}`", p.text)).collect();
            cx.report_error(first.place.clone(), format!("unused parameters {}", join_names_with_and(&list)))
                .add_help("remove them, or begin their names with `_` to keep them for your own use");
            return;
        }
        for parameter in unused {
            cx.report_error(parameter.place.clone(), format!("unused parameter `{}`", parameter.text))
                .add_help(format!("remove it, or name it `_{}` to keep it for your own use", parameter.text));
        }
    }
}

/// Reads gravity, which is a vector in ground axes.
fn resolve_gravity_vector<'g>(
    e: &crate::syntax::Expr,
    scope: &Scope<'_, 'g>,
    cx: &mut Diagnostics,
) -> Option<Vec3<'g>> {
    if let Some(Value::Scalar(s)) = scope.resolve_value(e, &mut Diagnostics::silent_diagnostics())
        && !s.is_zero()
    {
        let (sign, size) = match e.literal_number() {
            Some(n) => ("-", n.abs().to_string()),
            None => ("-", e.short_source_text()),
        };
        cx.report_error(e.place.clone(), "expected a vector, found a scalar")
            .add_help(format!("gravity has a direction: write `gravity = {sign}{size} * y`"));
        return None;
    }
    // The expression is in ground axes.
    let mut terms = scope.resolve_vector(e, cx)?;
    for (axes, _) in &mut terms {
        if *axes == Axes::Of(GROUND.to_string()) {
            *axes = Axes::Own;
        }
    }
    scope.own_axes_sum(terms, e, cx)
}

/// Reports names that have another meaning in expressions.
fn report_reserved_names(description: &Description, cx: &mut Diagnostics) {
    let written = description.parameters.iter().chain(&description.inputs);
    let written = written.chain(description.coordinates.iter().map(|c| &c.name));
    let written = written.chain(description.definitions.iter().map(|d| &d.name));
    let joints = description.joints.iter().map(|joint| &joint.name);
    for table in description.tables.iter().filter(|table| Callable::is_function_name(&table.name.text)) {
        cx.report_error(
            table.name.place.clone(),
            format!("the name `{}` is taken by a function", table.name.text),
        )
        .add_help(format!("rename the table, for example `{}_table`", table.name.text));
    }
    for name in written.chain(joints) {
        if Builtin::find_by_name(&name.text).is_some() && name.place.file.is_none() {
            cx.report_error(name.place.clone(), format!("the name `{}` is taken", name.text))
                .add_help("`x`, `y` and `z` are axes, `t` is time and `pi` is a number");
        }
    }
}
