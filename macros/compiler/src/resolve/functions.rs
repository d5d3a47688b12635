//! Values of function calls in expressions, with one match arm per function.

use super::call::Call;
use super::corrections::{DOMAIN_HELP, check_angle, degrees_to_radians};
use super::momenta::SummedQuantity;
use super::scope::{Axes, Scope, Value};
use crate::diag::{Diagnostics, Place};
use crate::expr::{Expr, Extreme, Function, Lookup, Vec3};
use crate::kinematics::normalised_or_zero;
use crate::language::{Callable, FunctionId, Solid};
use crate::syntax::{self, Callee, words};

impl<'g> Scope<'_, 'g> {
    /// Returns the value of a call of a function of the language, a table of the user, or a piecewise law.
    pub fn resolve_call(
        &self,
        callee: &Callee,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        if let Some(Callable::Elementary(f)) = callee.id {
            return self.resolve_elementary_function(f, callee, arguments, cx);
        }
        if let Some(k) = self.description.tables.iter().position(|table| table.name.text == callee.text) {
            return self.resolve_table_lookup(k, callee, arguments, cx);
        }
        match callee.id {
            Some(Callable::Function(id)) => {
                self.resolve_function_call(&Call { id, place: &callee.place, arguments }, cx)
            }
            Some(Callable::If) => self.resolve_piecewise_law(arguments, cx).map(Value::Scalar),
            other => {
                let solid = if let Some(Callable::Solid(solid)) = other { Some(solid) } else { None };
                self.report_unknown_function(callee, solid, cx);
                None
            }
        }
    }

    /// Returns the value of a function of the language.
    fn resolve_function_call(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        use FunctionId as F;
        match call.id {
            F::Degrees => {
                self.resolve_scalars(call, cx).map(|[angle]| Value::Scalar(degrees_to_radians(angle)))
            }
            F::Atan2 => self.resolve_scalars(call, cx).map(|[y, x]| Value::Scalar(y.atan2(x))),
            F::Pow => {
                let [base, exponent] = self.resolve_scalars(call, cx)?;
                check_power_defined(call.place, base, exponent, cx).then(|| Value::Scalar(base.pow(exponent)))
            }
            F::Min => self
                .resolve_scalars(call, cx)
                .map(|[a, b]| Value::Scalar(a.minimum_or_maximum(Extreme::Min, b))),
            F::Max => self
                .resolve_scalars(call, cx)
                .map(|[a, b]| Value::Scalar(a.minimum_or_maximum(Extreme::Max, b))),
            F::Dot => {
                let (_, v) = self.resolve_in_common_axes(&call.take_arguments::<2>(cx)?.each_ref(), cx)?;
                Some(Value::Scalar(v[0].dot(v[1])))
            }
            F::Cross => {
                let (axes, v) = self.resolve_in_common_axes(&call.take_arguments::<2>(cx)?.each_ref(), cx)?;
                Some(Value::Vector(vec![(axes, v[0].cross(v[1]))]))
            }
            F::Project => {
                let (axes, v) = self.resolve_in_common_axes(&call.take_arguments::<2>(cx)?.each_ref(), cx)?;
                let (a, b) = (v[0], v[1]);
                Some(Value::Vector(vec![(axes, b * (a.dot(b) / b.dot(b)))]))
            }
            F::Norm => {
                let (_, v) = self.vector_argument(call, "the magnitude of a scalar is `abs(a)`", cx)?;
                Some(Value::Scalar(v.regularised_norm()))
            }
            F::Unit => {
                let (axes, v) = self.vector_argument(call, "a scalar has no direction", cx)?;
                if v.is_zero() {
                    cx.report_error(call.arguments[0].place.clone(), "the zero vector has no direction")
                        .add_help("a direction is a nonzero vector");
                    return None;
                }
                Some(Value::Vector(vec![(axes, normalised_or_zero(v))]))
            }
            F::Angle => self.resolve_angle(call, cx),
            F::Position => self.resolve_relative_position(call, cx),
            F::Velocity => self.resolve_relative_velocity(call, cx),
            F::Acceleration => self.resolve_relative_acceleration(call, cx),
            F::Omega => self.resolve_angular_velocity(call, cx),
            F::Alpha => self.resolve_angular_acceleration(call, cx),
            F::ReactionForce => self.resolve_reaction(call, 0, cx),
            F::ReactionTorque => self.resolve_reaction(call, 3, cx),
            F::ContactForce => self.contact_force(call, cx),
            F::ContactMoment => self.contact_moment(call, cx),
            F::Momentum => self.resolve_momentum_or_energy(call, SummedQuantity::Momentum, cx),
            F::AngularMomentum => self.resolve_momentum_or_energy(call, SummedQuantity::AngularMomentum, cx),
            F::KineticEnergy => self.resolve_momentum_or_energy(call, SummedQuantity::Energy, cx),
            F::MomentOfInertia => self.resolve_moment_of_inertia(call, cx),
            F::CenterOfMass => self.resolve_center_of_mass(call, cx),
            F::CenterOfPercussion => self.center_of_percussion(call, cx),
            F::InstantCenter => self.instant_center(call, cx),
            F::AccelerationCenter => self.acceleration_center(call, cx),
            F::ScrewAxis => self.screw_axis(call, cx),
            F::ScrewPitch => self.screw_pitch(call, cx),
            F::Projector => self.resolve_projector(call, cx),
            F::Skew => self.resolve_skew(call, cx),
            F::Outer => self.resolve_outer_product(call, cx),
            F::Transpose => self.transpose(call, cx),
            F::Trace => self.resolve_trace(call, cx),
            F::Rotation => self.resolve_rotation_between_axes(call, cx),
            F::Inertia => self.resolve_inertia_matrix(call, cx),
            F::Identity => self.resolve_identity(call, cx),
            F::Curvature => self.resolve_curvature(call, cx),
            F::Torsion => self.resolve_torsion(call, cx),
            F::Cable => self.resolve_cable_length(call, cx),
            F::Gradient => self.resolve_gradient(call, cx),
            F::Power => self.resolve_power(call, cx),
            F::Rate => self.resolve_rate(call, cx),
            F::Temperature => self.resolve_standard_atmosphere(call, |air| air.temperature, cx),
            F::Pressure => self.resolve_standard_atmosphere(call, |air| air.pressure, cx),
            F::Density => self.resolve_standard_atmosphere(call, |air| air.density(), cx),
            F::SpeedOfSound => self.resolve_standard_atmosphere(call, |air| air.speed_of_sound(), cx),
            F::AngleOfAttack => {
                self.resolve_aerodynamic_angle(call, cx, |[forward, _, down]| down.atan2(forward))
            }
            F::Sideslip => {
                self.resolve_aerodynamic_angle(call, cx, |[f, right, d]| right.atan2(hypotenuse(f, d)))
            }
            F::Course => self.resolve_velocity_angle(call, cx, |[north, east, _]| east.atan2(north)),
            F::FlightPath => {
                self.resolve_velocity_angle(call, cx, |[n, e, down]| (-down).atan2(hypotenuse(n, e)))
            }
            F::Heading => self.attitude_angle(call, cx, |[north, east, _]| east.atan2(north)),
            F::Elevation => self.attitude_angle(call, cx, |[n, e, down]| (-down).atan2(hypotenuse(n, e))),
            F::Bank => self.resolve_bank_angle(call, cx),
            F::StabilityAxes => self.vector_from_flight_axes(call, false, cx),
            F::WindAxes => self.vector_from_flight_axes(call, true, cx),
        }
    }

    /// Returns the values of function arguments that must be scalars.
    pub fn resolve_scalars<const N: usize>(
        &self,
        call: &Call<'_>,
        cx: &mut Diagnostics,
    ) -> Option<[Expr<'g>; N]> {
        let values: Vec<Option<Expr<'g>>> =
            call.take_arguments::<N>(cx)?.iter().map(|argument| self.resolve_scalar(argument, cx)).collect();
        values.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
    }

    /// Returns the value of an elementary function of a number or an angle.
    fn resolve_elementary_function(
        &self,
        f: Function,
        callee: &Callee,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let [argument] = arguments else {
            let text = &callee.text;
            let help = match f {
                Function::Atan => {
                    "the function of two arguments is `atan2(y, x)`: did you mean `atan2`?".to_string()
                }
                _ => format!("write `{text}(a)`"),
            };
            cx.report_error(callee.place.clone(), format!("`{text}` takes 1 argument")).add_help(help);
            return None;
        };
        let turns = matches!(f, Function::Sin | Function::Cos | Function::Tan);
        if turns && !check_angle(argument, cx) {
            return None;
        }
        let s = self.resolve_scalar(argument, cx)?.apply_function(f);
        if let crate::expr::Node::Call(f, inner) = s.node()
            && let Some(number) = self.graph.expr(inner).constant_value()
        {
            let what = if f.evaluate_at(number).is_nan() { "not defined" } else { "infinite" };
            cx.report_error(argument.place.clone(), format!("`{}` is {what} at {number}", f.function_name()))
                .add_help(DOMAIN_HELP);
            return None;
        }
        Some(Value::Scalar(s))
    }

    /// Returns the only argument of a function, a vector, in common axes. `help` is the help for a scalar
    /// argument.
    fn vector_argument(&self, call: &Call<'_>, help: &str, cx: &mut Diagnostics) -> Option<(Axes, Vec3<'g>)> {
        let [a] = call.take_arguments(cx)?;
        let vector = self.resolve_vector_with_help(a, help, cx)?;
        let (axes, v) = self.express_in_common_axes(vec![(a, vector)], cx)?;
        Some((axes, v[0]))
    }

    /// Reports an unknown function, with the function that is most likely meant.
    fn report_unknown_function(&self, callee: &Callee, solid: Option<Solid>, cx: &mut Diagnostics) {
        let text = callee.text.as_str();
        let own = self.description.tables.iter().map(|table| table.name.text.as_str());
        let known = Function::ALL.iter().map(|(name, _)| *name).chain(FunctionId::names()).chain(own);
        let known: Vec<&str> = known.collect();
        let error = cx.report_error(callee.place.clone(), format!("unknown function `{text}`"));
        let greek = words::known_name_ignoring_case(text, &known);
        match (greek, solid) {
            (Some(name), _) => drop(error.add_help(format!("did you mean `{name}`?"))),
            (_, Some(_)) => drop(error.add_help(format!("`{text}` is a solid, for `inertia = …`"))),
            _ => words::suggest_meaning_or_known_word(error, &words::function_synonyms(), text, &known),
        }
        if error.has_no_help() {
            error.add_help(
                "available are the elementary functions and those of vectors: `sin`, `sqrt`, `pow`, `min`, \
                 `dot`, `cross`, `norm`, …",
            );
        }
    }

    /// Returns the value of an interpolation table at the arguments of a call.
    fn resolve_table_lookup(
        &self,
        k: usize,
        callee: &Callee,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let table = self.description.tables.get(k)?;
        let (found, expected) = (arguments.len(), table.variables);
        if found != expected {
            let plural = if expected == 1 { "" } else { "s" };
            cx.report_error(
                callee.place.clone(),
                format!("`{}` is a table of {expected} variable{plural}, but {found} are given", callee.text),
            )
            .add_help(format!("it is declared as `Table<{expected}>`"));
            return None;
        }
        let values: Vec<Option<Expr<'g>>> = arguments.iter().map(|a| self.resolve_scalar(a, cx)).collect();
        let values = values.into_iter().collect::<Option<Vec<_>>>()?;
        if let Some(used) = self.records.borrow_mut().used_tables.get_mut(k) {
            *used = true;
        }
        let x = std::array::from_fn(|k| values.get(k).copied().unwrap_or(self.graph.zero()));
        Some(Value::Scalar(self.graph.table_lookup(Lookup::new(k, expected), x)))
    }
}

/// Reports a power that is undefined in all states. Returns false then.
fn check_power_defined(place: &Place, base: Expr<'_>, exponent: Expr<'_>, cx: &mut Diagnostics) -> bool {
    let Some(x) = base.constant_value() else { return true };
    let what = match exponent.constant_value() {
        Some(n) if libm::pow(x, n).is_finite() => return true,
        Some(n) if libm::pow(x, n).is_nan() => format!("`pow` is not defined at {x} and {n}"),
        Some(n) => format!("`pow` is infinite at {x} and {n}"),
        None if x >= 0.0 => return true,
        None => format!("powers of {x} are defined only for integer exponents"),
    };
    let help = "the first argument of `pow` is the base, the second the exponent: a base that can be \
                negative requires an integer exponent";
    cx.report_error(place.clone(), what).add_help(help);
    false
}

/// Returns the length of a vector with two perpendicular components.
pub fn hypotenuse<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    (a.square() + b.square()).sqrt()
}
