//! Expressions of a description, each with the expected dimension of its argument or field.

use super::infer::{DimensionEqualityReason, EquationOrigin, Inference, UnitMeaningOfName};
use super::value::InferredUnit;
use crate::language::dimension::{
    ACCELERATION, Dimension, ENERGY, INERTIA, LENGTH, MASS, PLAIN, POWER, TIME,
};
use crate::language::ratio::Ratio;
use crate::language::{
    Argument, ArgumentKind, ArgumentQuantity, BodyOrInertiaMethod, Callable, ForceLawVariables, Key,
};
use crate::resolve::contact::TERRAIN_COORDINATES;
use crate::syntax::contact::link_in_collision_expression;
use crate::syntax::{
    Action, Body, Callee, Constraint, Definition, Description, Endpoint, Expr, ExprKind, Joint, Limit,
    Member, Target, WrittenArguments, restitution_value_and_kind,
};

/// Expression whose dimension is known from its context.
pub struct ExpressionWithDimension<'a> {
    /// Expression whose subexpressions are to be inferred.
    pub e: &'a Expr,
    /// Dimension that the context requires.
    pub dimension: Dimension,
    /// Notation of the unit in this context; empty for the default.
    pub unit: &'static str,
    /// Local names of the expression, with their dimensions.
    pub locals: Vec<(&'static str, Dimension)>,
}

/// All expressions of a description, with their expected dimensions.
pub struct DimensionedExpressions<'a> {
    /// Definitions, each after the definitions that it uses.
    pub definitions: Vec<ExpressionWithDimension<'a>>,
    /// All other expressions with expected dimensions.
    pub tasks: Vec<ExpressionWithDimension<'a>>,
    /// Ends of force elements, which may be given by vectors.
    pub points: Vec<&'a Expr>,
    /// Dimension of both sides of each declared constraint, by index; unused for pairs of surfaces.
    pub sides: Vec<Dimension>,
}

/// Coordinate on which an element does work, and its force.
struct WorkDimensions {
    /// Dimension of the coordinate or distance on which the element acts.
    coordinate: Dimension,
    /// Dimension of the element's force or torque.
    force: Dimension,
    /// Notation of the units of force, stiffness, damping, inertance, coordinate and speed.
    units: [&'static str; 6],
}

const LINEAR_UNITS: [&str; 6] = ["N", "N/m", "N·s/m", "kg", "m", "m/s"];
const ANGULAR_UNITS: [&str; 6] = ["N·m", "N·m/rad", "N·m·s/rad", "kg·m²", "rad", "rad/s"];

impl WorkDimensions {
    /// Returns the work of a force on a coordinate of this dimension; `None` for an unknown one.
    fn new(coordinate: Dimension) -> Option<WorkDimensions> {
        let units = match (coordinate.is_plain(), coordinate.is_known()) {
            (true, _) => ANGULAR_UNITS,
            (_, true) => LINEAR_UNITS,
            _ => [""; 6],
        };
        Some(WorkDimensions { force: ENERGY.dimension_of_quotient(&coordinate)?, coordinate, units })
    }
}

/// Collects the expressions of a description, with its sorted `definitions`. Elements of a file are skipped,
/// because all their values are numbers.
pub fn collect_dimensioned_expressions<'a>(
    d: &'a Description,
    definitions: &[&'a Definition],
    inference: &mut Inference<'a>,
) -> DimensionedExpressions<'a> {
    let mut places = DimensionedExpressions {
        definitions: Vec::new(),
        tasks: Vec::new(),
        points: Vec::new(),
        sides: Vec::new(),
    };
    // Definitions have unknowns of their own, assigned to their names.
    for definition in definitions {
        if let Some(UnitMeaningOfName::Named(v, _)) = inference.names.get(&definition.name.text) {
            places.add_with_dimension(&definition.value, &Dimension::unknown_dimension(*v), "");
        }
    }
    places.definitions = std::mem::take(&mut places.tasks);
    places.add_all_with_dimension(&d.gravity, &ACCELERATION, "m/s²");
    places.add_all_with_dimension(
        &d.friction_speed,
        &Dimension::unknown_dimension(inference.system.add_unknown_dimension()),
        "",
    );
    d.bodies.iter().filter(|b| b.name.place.file.is_none()).for_each(|b| places.add_expressions_of_body(b));
    for particle in &d.particles {
        places.add_with_dimension(&particle.mass, &MASS, "kg");
        particle.at.iter().for_each(|at| places.add_expressions_of_position(at));
    }
    d.joints.iter().filter(|j| j.name.place.file.is_none()).for_each(|j| places.add_expressions_of_joint(j));
    for frame in &d.frames {
        places.add_expressions_of_rotations(&frame.rotations);
    }
    for point in &d.points {
        places.points.extend(&point.on);
        places.add_all_with_dimension(&point.at, &LENGTH, "m");
    }
    for action in &d.actions {
        places.add_expressions_of_action(action, inference);
    }
    d.limits
        .iter()
        .filter(|l| l.on.place.file.is_none())
        .for_each(|l| places.add_expressions_of_limit(l, inference));
    for (place, value) in d.equilibria.iter().flat_map(|e| &e.values) {
        places.add_value_at_rest(place, value, inference);
    }
    for constraint in &d.constraints {
        places.add_constraint_sides(constraint, inference);
    }
    for contact in &d.contacts {
        places.add_expressions_of_surface(&contact.first);
        places.add_expressions_of_surface(&contact.second);
        if let Some(work) = WorkDimensions::new(LENGTH) {
            places.add_written_arguments(&contact.arguments, &work, ForceLawVariables::None);
        }
    }
    for (_, e) in &d.energies {
        places.add_with_dimension(e, &ENERGY, "J");
    }
    for (_, e) in &d.dissipations {
        places.add_with_dimension(e, &POWER, "W");
    }
    places
}

impl<'a> DimensionedExpressions<'a> {
    fn add_with_dimension(&mut self, e: &'a Expr, dimension: &Dimension, unit: &'static str) {
        self.tasks.push(ExpressionWithDimension {
            e,
            dimension: dimension.clone(),
            unit,
            locals: Vec::new(),
        });
    }

    fn add_all_with_dimension(
        &mut self,
        e: impl IntoIterator<Item = &'a Expr>,
        dimension: &Dimension,
        unit: &'static str,
    ) {
        e.into_iter().for_each(|e| self.add_with_dimension(e, dimension, unit));
    }

    /// Adds the arguments of a solid, a surface or a rotation.
    fn add_expected_argument_dimensions(&mut self, written: &'a [Expr], arguments: &[Argument]) {
        for (e, argument) in written.iter().zip(arguments) {
            if let Some((dimension, unit)) = argument.kind.dimension_and_unit() {
                self.add_with_dimension(e, &dimension, unit);
            }
        }
    }

    fn add_expressions_of_body(&mut self, body: &'a Body) {
        self.add_all_with_dimension(&body.mass, &MASS, "kg");
        self.add_all_with_dimension(body.com.iter().chain(&body.about), &LENGTH, "m");
        body.inertia.iter().for_each(|e| self.add_inertia_expressions(e));
        body.at.iter().for_each(|e| self.add_expressions_of_position(e));
    }

    /// Adds the expressions of an inertia, such as `rod(m, l, y).rotated(…) + [[…], …]`.
    fn add_inertia_expressions(&mut self, e: &'a Expr) {
        match &e.kind {
            ExprKind::Array(rows) => {
                for row in rows {
                    if let ExprKind::Array(entries) = &row.kind {
                        self.add_all_with_dimension(entries, &INERTIA, "kg·m²");
                    }
                }
            }
            ExprKind::Binary(_, a, b, _) => {
                self.add_inertia_expressions(a);
                self.add_inertia_expressions(b);
            }
            ExprKind::Method(inner, _, steps) => {
                self.add_inertia_expressions(inner);
                self.add_expressions_of_rotations(steps);
            }
            ExprKind::Call(Callee { id: Some(Callable::Solid(solid)), .. }, arguments) => {
                self.add_expected_argument_dimensions(arguments, solid.row().arguments);
            }
            _ => {}
        }
    }

    /// Adds the arguments of rotations `z(angle)`, `eigenaxis(n, angle)`, or a matrix, with their dimensions.
    fn add_expressions_of_rotations(&mut self, steps: &'a [Expr]) {
        for step in steps {
            match &step.kind {
                ExprKind::Call(Callee { id: Some(Callable::Rotation(rotation)), .. }, arguments) => {
                    self.add_expected_argument_dimensions(arguments, rotation.row().arguments);
                }
                ExprKind::Array(rows) => {
                    for row in rows {
                        if let ExprKind::Array(entries) = &row.kind {
                            self.add_all_with_dimension(entries, &PLAIN, "1");
                        }
                    }
                }
                _ => {}
            }
        }
    }

    /// Adds the expressions of a position: the name of an element, `place.at(vector)`, or a vector from the
    /// ground's origin.
    fn add_expressions_of_position(&mut self, e: &'a Expr) {
        match &e.kind {
            ExprKind::Method(..) => self.points.push(e),
            // The name of an element has no dimension.
            _ => self.add_with_dimension(e, &LENGTH, "m"),
        }
    }

    fn add_endpoint_expressions(&mut self, end: &'a Endpoint) {
        self.add_all_with_dimension(&end.at, &LENGTH, "m");
        self.add_expressions_of_rotations(&end.rotated);
    }

    fn add_expressions_of_joint(&mut self, joint: &'a Joint) {
        self.add_endpoint_expressions(&joint.parent);
        self.add_endpoint_expressions(&joint.child);
        self.add_all_with_dimension(joint.about.iter().chain(&joint.along), &PLAIN, "1");
        self.add_all_with_dimension(&joint.pitch, &LENGTH, "m/rad");
        self.add_all_with_dimension(&joint.lead, &LENGTH, "m");
    }

    fn add_expressions_of_action(&mut self, action: &'a Action, inference: &mut Inference<'a>) {
        let on = match &action.on {
            Target::Between(a, b) => {
                self.points.extend([a, b]);
                None
            }
            Target::On(e) => {
                let coordinate = coordinate_dimension(e, inference);
                match &e.kind {
                    _ if coordinate.is_some() => coordinate,
                    ExprKind::Call(..) | ExprKind::Binary(..) | ExprKind::Neg(..) => {
                        let unknown = Dimension::unknown_dimension(inference.system.add_unknown_dimension());
                        self.add_with_dimension(e, &unknown, "");
                        Some(unknown)
                    }
                    _ => {
                        self.points.push(e);
                        None
                    }
                }
            }
        };
        let on_point = on.is_none();
        let Some(mut work) = WorkDimensions::new(on.unwrap_or(LENGTH)) else { return };
        let row = action.kind.row();
        // A force at a point does work on a length, a torque on an angle.
        if on_point && row.torque {
            work = WorkDimensions { force: ENERGY, units: ANGULAR_UNITS, ..work };
        }
        self.add_written_arguments(&action.arguments, &work, row.locals);
        if action.is_input() {
            let is_direction = |key: &Key| matches!(key.row().quantity, ArgumentQuantity::Direction);
            let direction =
                action.arguments.keyed_expressions().find(|(key, _)| is_direction(key)).map(|(_, e)| e);
            set_input_unit(action, direction, &work.force, inference);
        }
    }

    fn add_expressions_of_limit(&mut self, limit: &'a Limit, inference: &mut Inference<'a>) {
        let q = coordinate_dimension(&limit.on, inference).unwrap_or_else(|| {
            let unknown = Dimension::unknown_dimension(inference.system.add_unknown_dimension());
            self.add_with_dimension(&limit.on, &unknown, "");
            unknown
        });
        if let Some(work) = WorkDimensions::new(q) {
            self.add_written_arguments(&limit.arguments, &work, ForceLawVariables::None);
        }
    }

    /// Adds the value at rest of a coordinate, an input or a state.
    fn add_value_at_rest(&mut self, place: &'a Expr, value: &'a Expr, inference: &mut Inference<'a>) {
        if let Some(known) = coordinate_dimension(place, inference) {
            self.add_with_dimension(value, &known, if known.is_plain() { "rad" } else { "" });
        } else if place.as_name().is_some() {
            let unknown = Dimension::unknown_dimension(inference.system.add_unknown_dimension());
            self.add_with_dimension(place, &unknown, "");
            self.add_with_dimension(value, &unknown, "");
        }
    }

    /// Adds the written arguments of an element with their dimensions.
    fn add_written_arguments(
        &mut self,
        written: &'a WrittenArguments,
        work: &WorkDimensions,
        locals: ForceLawVariables,
    ) {
        let [force, stiffness, damping, inertance, coordinate, speed] = work.units;
        let q = &work.coordinate;
        let dimension_of_force_coefficient = |times: i64| {
            work.force
                .dimension_of_quotient(q)?
                .dimension_of_product(&TIME.dimension_of_power(Ratio::from_integer(times))?)
        };
        for (key, e) in written.keyed_expressions() {
            let (dimension, unit) = match &key.row().quantity {
                ArgumentQuantity::Stiffness => (dimension_of_force_coefficient(0), stiffness),
                ArgumentQuantity::HertzStiffness => {
                    let power = Ratio::new(3, 2).and_then(|power| q.dimension_of_power(power));
                    (power.and_then(|power| work.force.dimension_of_quotient(&power)), "")
                }
                ArgumentQuantity::Damping => (dimension_of_force_coefficient(1), damping),
                ArgumentQuantity::Inertance => (dimension_of_force_coefficient(2), inertance),
                ArgumentQuantity::Force | ArgumentQuantity::Load => (Some(work.force.clone()), force),
                ArgumentQuantity::Energy => (Some(ENERGY), "J"),
                ArgumentQuantity::Coordinate => (Some(q.clone()), coordinate),
                ArgumentQuantity::Speed => (q.dimension_of_quotient(&TIME), speed),
                ArgumentQuantity::Fixed(dimension, unit) => (Some(dimension.clone()), *unit),
                // The direction belongs to an input, whose unit is set separately.
                ArgumentQuantity::Direction => continue,
            };
            let Some(dimension) = dimension else { continue };
            // Coefficients are not expressions of the stretch or the speed.
            let locals = match (locals, key) {
                (ForceLawVariables::Stretch, Key::Force | Key::Energy) => {
                    vec![("stretch", q.clone()), ("length", q.clone())]
                }
                (ForceLawVariables::Speed, Key::Force | Key::Energy) => {
                    q.dimension_of_quotient(&TIME).map(|speed| ("speed", speed)).into_iter().collect()
                }
                _ => Vec::new(),
            };
            let e = if key == Key::Restitution { restitution_value_and_kind(e).0 } else { e };
            self.tasks.push(ExpressionWithDimension { e, dimension, unit, locals });
        }
    }

    /// Adds both sides of a constraint, which have the same dimension. Surfaces have arguments of their own.
    fn add_constraint_sides(&mut self, constraint: &'a Constraint, inference: &mut Inference<'a>) {
        let side = Dimension::unknown_dimension(inference.system.add_unknown_dimension());
        self.sides.push(side.clone());
        if constraint.kind.surface_pair_function().is_none() {
            self.add_with_dimension(&constraint.value, &side, "");
            self.add_all_with_dimension(&constraint.other, &side, "");
            return;
        }
        if let Some(work) = WorkDimensions::new(LENGTH) {
            self.add_written_arguments(&constraint.arguments, &work, ForceLawVariables::None);
        }
        let ExprKind::Call(_, pair) = &constraint.value.kind else { return };
        pair.iter().for_each(|surface| self.add_expressions_of_surface(surface));
    }

    /// Adds the arguments of a surface of a body, or of a point, with their dimensions.
    fn add_expressions_of_surface(&mut self, surface: &'a Expr) {
        if let Some(link) = link_in_collision_expression(surface) {
            self.points.extend(link);
            return;
        }
        let ExprKind::Method(frame, Member { id: Some(BodyOrInertiaMethod::Surface(id)), .. }, arguments) =
            &surface.kind
        else {
            self.points.push(surface);
            return;
        };
        self.points.push(frame);
        for (e, argument) in arguments.iter().zip(id.row().arguments) {
            if let (ArgumentKind::Points, ExprKind::Array(points) | ExprKind::Tuple(points)) =
                (argument.kind, &e.kind)
            {
                self.add_all_with_dimension(points, &LENGTH, "m");
            }
            let Some((dimension, unit)) = argument.kind.dimension_and_unit() else { continue };
            let locals = match argument.kind {
                ArgumentKind::Height => TERRAIN_COORDINATES.map(|name| (name, LENGTH.clone())).into(),
                _ => Vec::new(),
            };
            self.tasks.push(ExpressionWithDimension { e, dimension, unit, locals });
        }
    }
}

/// Sets the unit of an input: its product with the direction is a force or a torque. A direction without a
/// length has no unit.
fn set_input_unit<'a>(
    action: &'a Action,
    direction: Option<&'a Expr>,
    force: &Dimension,
    inference: &mut Inference<'a>,
) {
    let Some(UnitMeaningOfName::Moving(input, _)) = inference.names.get(&action.name.text).cloned() else {
        return;
    };
    let (Target::On(on) | Target::Between(on, _)) = &action.on;
    let (at, product) = match direction.map(|e| (e, inference.inferred_unit_of_expression(e))) {
        Some((at, InferredUnit::Quantity { dimension, .. })) => {
            inference.default_to_plain(dimension.clone());
            (at, input.dimension_of_product(&dimension))
        }
        _ => (direction.unwrap_or(on), Some(input)),
    };
    if let Some(product) = product {
        inference.equate_dimensions(
            &product,
            force,
            EquationOrigin { reason: DimensionEqualityReason::Place, expression: at, compared_with: None },
        );
    }
}

/// Returns the dimension of the coordinate on which an element acts; `None` if it acts on a body or a point.
fn coordinate_dimension(e: &Expr, inference: &Inference<'_>) -> Option<Dimension> {
    let meaning = match &e.kind {
        ExprKind::Name(name) => inference.names.get(name),
        ExprKind::Field(joint, member) => match &joint.kind {
            ExprKind::Name(joint) => inference.names.get(&format!("{joint}.{}", member.text)),
            _ => None,
        },
        _ => None,
    };
    match meaning {
        Some(UnitMeaningOfName::Moving(dimension, _)) => Some(dimension.clone()),
        Some(UnitMeaningOfName::Named(v, _)) => Some(Dimension::unknown_dimension(*v)),
        None => None,
    }
}
