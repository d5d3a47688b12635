//! Names in expressions: parameters, directions, coordinates, time, inputs and definitions.

use super::scope::{AllowedQuantities, Axes, Scope, Value};
use crate::diag::{Diagnostics, Place};
use crate::expr::Vec3;
use crate::kinematics::coordinate_as_expression;
use crate::language::{Builtin, FunctionId, axis_index_of_name, names};
use crate::mechanism::{Pose, Quantity};
use crate::syntax::{self, ExprKind, GROUND, Name, words};

impl<'g> Scope<'_, 'g> {
    /// Returns the kind of element with this name, with an article, for messages.
    pub fn kind_of_name(&self, name: &str) -> Option<&'static str> {
        let d = self.description;
        match name {
            _ if d.parameters.iter().any(|p| p.text == name) => Some("a parameter"),
            _ if d.tables.iter().any(|table| table.name.text == name) => Some("a table"),
            _ if d.frames.iter().any(|f| f.name.text == name) => Some("a frame"),
            _ if name == GROUND || self.bodies.iter().any(|body| body == name) => Some("a body"),
            _ if d.joints.iter().any(|j| j.name.text == name) => Some("a joint"),
            _ if d.inputs.iter().any(|i| i.text == name) => Some("an input"),
            _ if d.definitions.iter().any(|d| d.name.text == name) => Some("a definition"),
            _ if d.actions.iter().any(|a| a.name.text == name) => Some("a force element"),
            _ => match Builtin::find_by_name(name)? {
                Builtin::Axis(_) => Some("a direction"),
                Builtin::Pi => Some("a number"),
                Builtin::Time => None,
            },
        }
    }

    /// Whether an unknown name has not been reported yet; records it as reported.
    pub fn record_first_report(&self, name: &str, cx: &Diagnostics) -> bool {
        !cx.will_print_errors() || self.records.borrow_mut().reported_names.insert(name.to_string())
    }

    /// Returns the value of a name that occurs in an expression.
    pub fn resolve_name_in_expression(
        &self,
        name: &str,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        if let Some(value) = self.kinematics.file_element_quantities.get(name) {
            return Some(Value::Scalar(*value));
        }
        // Expressions of a file refer to its joints even if the language has another meaning for the name.
        if e.place.file.is_some()
            && let Some(value) = self.resolve_coordinate(name, e, cx)
        {
            return value;
        }
        // A parameter with the name of an axis has been reported; its meaning is ambiguous.
        let axis = axis_index_of_name(name);
        if axis.is_some() && self.description.parameters.iter().any(|p| p.text == name) {
            return None;
        }
        if let Some(k) = axis {
            return Some(self.vector_in_context_axes(Vec3::coordinate_axis(self.graph, k)));
        }
        if let Some(k) = self.description.parameters.iter().position(|p| p.text == name) {
            self.records.borrow_mut().used[k] = true;
            return Some(Value::Scalar(Quantity::Parameter(k).expr(self.graph)));
        }
        if Builtin::find_by_name(name) == Some(Builtin::Pi) {
            return Some(Value::Scalar(self.graph.num(std::f64::consts::PI)));
        }
        if let Some(value) = self.value_of_time_dependent_name(name, e, cx) {
            return value;
        }
        if self.bodies.iter().any(|b| b == name) || name == GROUND {
            cx.report_error(e.place.clone(), format!("`{name}` is a body, not a value"))
                .add_help(format!("its axes are `{name}.x`, `{name}.y` and `{name}.z`"));
        } else if let Some(table) = self.description.tables.iter().find(|table| table.name.text == name) {
            let variables = ["a", "b", "c"].get(..table.variables).unwrap_or_default().join(", ");
            cx.report_error(e.place.clone(), format!("`{name}` is a table, which needs its variables"))
                .add_help(format!("write `{name}({variables})`"));
        } else if let Some(what) = self.kind_of_name(name) {
            cx.report_error(e.place.clone(), format!("`{name}` is {what}, which has no value here"))
                .add_help("an expression consists of parameters, numbers and directions");
        } else if let Some(
            function @ (FunctionId::Momentum | FunctionId::AngularMomentum | FunctionId::KineticEnergy),
        ) = FunctionId::find_by_name(name)
        {
            let error = cx.report_error(e.place.clone(), format!("`{name}` is a function of a body"));
            error.add_help(format!("write `{name}(body)`"));
            if function == FunctionId::KineticEnergy {
                error.add_help(
                    "that of the whole mechanism needs no output: it is the method `kinetic_energy`",
                );
            }
        } else {
            let kinematics = &self.kinematics;
            let mut known: Vec<&str> = self.description.parameters.iter().map(|p| p.text.as_str()).collect();
            if self.allowed_quantities() >= AllowedQuantities::Placement {
                known.extend(kinematics.coordinates.iter().map(|(name, ..)| name.as_str()));
                known.extend(self.description.definitions.iter().map(|d| d.name.text.as_str()));
            }
            if self.allowed_quantities() >= AllowedQuantities::Motion {
                known.extend(self.description.inputs.iter().map(|i| i.text.as_str()));
            }
            if !self.record_first_report(name, cx) {
                return None;
            }
            let rates: Vec<&str> = kinematics.coordinates.iter().map(|(name, ..)| name.as_str()).collect();
            known.extend(names::AXES);
            known.push(names::PI);
            let error = cx.report_error(e.place.clone(), format!("unknown name `{name}`"));
            words::suggest_name(error, name, &known, &rates);
        }
        None
    }

    /// Returns the value of a member such as `body.x` or `joint.angle`.
    pub fn resolve_member(
        &self,
        inner: &syntax::Expr,
        member: &Name,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        if let ExprKind::Name(joint) = &inner.kind
            && let Some(value) = self.value_of_joint_coordinate(joint, member, cx)
        {
            return value;
        }
        let ExprKind::Name(body) = &inner.kind else {
            let diagnostic =
                cx.report_error(member.place.clone(), format!("`.{}` has no value here", member.text));
            let axis = names::AXES[axis_index_of_name(&member.text).unwrap_or(0)];
            diagnostic.add_help(format!("a component of a vector is `dot(vector, {axis})`"));
            return None;
        };
        if body == "self" && inner.place.file.is_none() {
            cx.report_error(inner.place.clone(), "parameters are named without `self`")
                .add_help(format!("write `{}`", member.text));
            return None;
        }
        if body != GROUND && !self.bodies.contains(body) {
            if self.report_unknown_joint_member(body, inner, member, cx) {
                return None;
            }
            if let Some(what) = self.kind_of_name(body) {
                cx.report_error(inner.place.clone(), format!("`{body}` is {what} and has no axes")).add_help(
                    "write `x`, `y`, `z` for the axes available here, or `body.x` for those of a body",
                );
                return None;
            }
            let known = self.bodies.iter().map(String::as_str).chain([GROUND]);
            let known: Vec<&str> = known.collect();
            if !self.record_first_report(body, cx) {
                return None;
            }
            let error = cx.report_error(inner.place.clone(), format!("unknown body `{body}`"));
            if words::meaning_of_word(words::OWN, body, &[]).is_some() {
                error.add_help("without a body, `x`, `y` and `z` are the axes of the current frame");
                return None;
            }
            words::suggest_meaning_or_known_word(error, words::BODIES, body, &known);
            return None;
        }
        let Some(k) = axis_index_of_name(&member.text) else {
            let meaning = words::meaning_of_word(words::MEMBERS, &member.text, &[]);
            // The ground does not rotate.
            let meaning =
                meaning.filter(|meaning| body != GROUND || !meaning.contains(FunctionId::Omega.name()));
            let meaning =
                meaning.unwrap_or("its axes are `x`, `y` and `z`, and `body.at(vector)` is a point");
            let help = meaning.replace("NAME", body);
            cx.report_error(member.place.clone(), format!("a body has no `{}`", member.text)).add_help(help);
            return None;
        };
        self.vector_in_named_axes(body, Vec3::coordinate_axis(self.graph, k), &inner.place, cx)
    }

    /// Returns a vector given in the axes `x`, `y`, `z` of the context.
    pub fn vector_in_context_axes(&self, v: Vec3<'g>) -> Value<'g> {
        Value::Vector(vec![match &self.context.borrow().axes {
            None => (Axes::Own, v),
            Some((link, pose)) => (Axes::Link(*link), pose.rotation.vector_in_parent_axes(v)),
        }])
    }

    /// Returns a vector given in the axes of a body or a frame.
    pub fn vector_in_named_axes(
        &self,
        name: &str,
        v: Vec3<'g>,
        place: &Place,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        if self.context.borrow().axes.is_none() {
            return Some(Value::Vector(vec![(Axes::Of(name.to_string()), v)]));
        }
        if name == GROUND {
            return Some(Value::Vector(vec![(Axes::Link(None), v)]));
        }
        match self.placement_of_element(name) {
            Some(p) => {
                Some(Value::Vector(vec![(Axes::Link(p.link), p.pose.rotation.vector_in_parent_axes(v))]))
            }
            None => {
                cx.report_error(place.clone(), format!("`{name}` has no placement"));
                None
            }
        }
    }

    /// Returns the value of a local name, a coordinate, time, an input or a definition. The outer `None`
    /// means that the name has another meaning, the inner one an error.
    pub fn value_of_time_dependent_name(
        &self,
        name: &str,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Option<Value<'g>>> {
        if let Some((_, value)) = self.context.borrow().locals.iter().find(|(local, _)| *local == name) {
            return Some(Some(Value::Scalar(*value)));
        }
        if Builtin::find_by_name(name) == Some(Builtin::Time) {
            let here = self.check_allowed_quantity(AllowedQuantities::Placement, "time", &e.place, cx);
            return Some(here.then(|| Value::Scalar(Quantity::Time.expr(self.graph))));
        }
        if let Some(value) = self.resolve_coordinate(name, e, cx) {
            return Some(value);
        }
        if let Some(k) = self.description.inputs.iter().position(|i| i.text == name) {
            let here = self.check_allowed_quantity(
                AllowedQuantities::Motion,
                &format!("the input `{name}`"),
                &e.place,
                cx,
            );
            return Some(here.then(|| Value::Scalar(Quantity::Input(self.driven + k).expr(self.graph))));
        }
        let definition = self.description.definitions.iter().find(|d| d.name.text == name)?;
        Some(self.resolve_definition(definition, e, cx))
    }

    /// Returns the value of a coordinate. The outer `None` means that no coordinate has the name.
    fn resolve_coordinate(
        &self,
        name: &str,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Option<Value<'g>>> {
        let found = self.kinematics.coordinates.iter().find(|(n, ..)| n == name).map(|(_, c, _)| *c);
        let c = found?;
        let here = self.check_allowed_quantity(
            AllowedQuantities::Placement,
            &format!("the coordinate `{name}`"),
            &e.place,
            cx,
        );
        Some(here.then(|| Value::Scalar(coordinate_as_expression(self.graph, &c))))
    }

    fn resolve_definition(
        &self,
        d: &syntax::Definition,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let name = &d.name.text;
        if cx.will_print_errors() && self.records.borrow().reported_definitions.contains(name) {
            return None;
        }
        let outermost = self.context.borrow().defining.is_empty();
        let key = {
            let context = self.context.borrow();
            (name.clone(), context.allowed, context.axes.is_some())
        };
        if outermost {
            self.records.borrow_mut().definition_values.clear();
        } else if let Some(known) = self.records.borrow().definition_values.get(&key) {
            return known.clone();
        }
        let before = cx.len();
        let value = self.evaluate_definition(d, e, cx);
        if value.is_none() && cx.will_print_errors() && cx.len() > before {
            self.records.borrow_mut().reported_definitions.insert(name.clone());
        }
        self.records.borrow_mut().definition_values.insert(key, value.clone());
        value
    }

    fn evaluate_definition(
        &self,
        d: &syntax::Definition,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let name = &d.name.text;
        if self.context.borrow().defining.contains(name) {
            cx.report_error(d.name.place.clone(), format!("the definition of `{name}` depends on itself"))
                .add_help("a definition is an expression of other quantities");
            return None;
        }
        if self.context.borrow().defining.len() > 64 {
            cx.report_error(d.name.place.clone(), "definitions are nested too deeply")
                .add_help("expand some of them");
            return None;
        }
        // Unqualified directions in a definition are those of the ground in all its uses.
        let mut context = self.context.borrow().clone();
        context.defining.push(name.clone());
        context.locals.clear();
        context.compared.clear();
        context.axes = context.axes.map(|_| (None, Pose::identity(self.graph)));
        let value = self.call_in_context(context, |scope| scope.resolve_value(&d.value, cx))?;
        if value.value_rank() == d.rank {
            return Some(value);
        }
        if self.description.speeds.iter().any(|speed| speed.text == *name) {
            cx.report_error(
                d.value.place.clone(),
                format!("a speed is a scalar, and this is {}", value.kind_with_article()),
            )
            .add_help(
                "take a component of it, such as `dot(omega(body / ground), body.x)`, and declare a \
                     speed for each",
            );
            return None;
        }
        let (is, meant) = (value.kind_with_article(), value.value_rank().element_type_name());
        cx.report_error(
            e.place.clone(),
            format!("`{name}` is {is}, but it is declared as a {}", d.rank.element_type_name()),
        )
        .add_help(format!("declare it as a `{meant}`"));
        None
    }

    /// Returns the value of `joint.coordinate`. The outer `None` means that the coordinate does not exist.
    pub fn value_of_joint_coordinate(
        &self,
        joint: &str,
        member: &Name,
        cx: &mut Diagnostics,
    ) -> Option<Option<Value<'g>>> {
        let full = format!("{joint}.{}", member.text);
        let c = self.kinematics.coordinates.iter().find(|(n, ..)| *n == full).map(|(_, c, _)| *c)?;
        let here = self.check_allowed_quantity(
            AllowedQuantities::Placement,
            &format!("the coordinate `{full}`"),
            &member.place,
            cx,
        );
        Some(here.then(|| Value::Scalar(coordinate_as_expression(self.graph, &c))))
    }

    /// Reports a quantity that the context does not allow. Returns false then.
    pub fn check_allowed_quantity(
        &self,
        needed: AllowedQuantities,
        what: &str,
        place: &Place,
        cx: &mut Diagnostics,
    ) -> bool {
        if self.allowed_quantities() >= needed {
            return true;
        }
        if needed == AllowedQuantities::Reaction {
            cx.report_error(place.clone(), format!("{what} is not allowed here")).add_help(
                "forces of joints and contacts are allowed in outputs: `#[output(reaction_force(joint))]`",
            );
            return false;
        }
        let motion = matches!(needed, AllowedQuantities::Motion | AllowedQuantities::Acceleration);
        if self.allowed_quantities() == AllowedQuantities::Placement
            && motion
            && self.records.borrow().in_holonomic_constraint
        {
            cx.report_error(place.clone(), format!("{what} is not allowed here"))
                .add_help("a constraint on velocities is a `Nonholonomic`");
            return false;
        }
        let only = match self.allowed_quantities() {
            AllowedQuantities::Constant => "only numbers and parameters",
            AllowedQuantities::Placement => "only numbers, parameters, coordinates and time",
            _ => "no accelerations",
        };
        cx.report_error(place.clone(), format!("{what} is not allowed here"))
            .add_help(format!("this expression allows {only}"));
        false
    }
}
