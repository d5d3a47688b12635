//! Mass and inertia of bodies: solids, matrices, and checks of physical consistency.

use super::scope::{Scope, Value};
use crate::diag::{Diagnostics, Place};
use crate::expr::{Expr, Sym3, Vec3};
use crate::language::{Argument, BodyOrInertiaMethod, Callable, Solid};
use crate::mechanism::Rule;
use crate::syntax::{self, BinaryOp, Callee, ExprKind, words};

/// Maximum moment, kg·m², that counts as zero, since exporters write such values for bodies without inertia.
const ZERO_MOMENT: f64 = 1e-18;

/// Squared radius of gyration, m², below which the moments of a body with mass also count as zero (a radius
/// of ten nanometres).
const MIN_GYRATION_SQUARED: f64 = 1e-16;

/// Relative tolerance of the checks of inertias, since published values are rounded.
const TOLERANCE: f64 = 1e-6;

/// Operation of an inertia expression on the inertia to its left.
enum InertiaOperation<'a> {
    Add(&'a syntax::Expr),
    Rotate(&'a [syntax::Expr]),
}

impl<'g> Scope<'_, 'g> {
    /// Returns an inertia about the centre of mass, in body axes, or reports an error.
    ///
    /// The left operands of a chain of sums and rotations are visited in a loop, as in `Scope::value`.
    pub fn resolve_inertia(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Sym3<'g>> {
        let mut operations = Vec::new();
        let mut first = e;
        loop {
            let (inner, operation) = match &first.kind {
                ExprKind::Binary(BinaryOp::Add, left, right, _) => (left, InertiaOperation::Add(right)),
                ExprKind::Method(inner, method, steps) if method.id == Some(BodyOrInertiaMethod::Rotated) => {
                    (inner, InertiaOperation::Rotate(steps))
                }
                _ => break,
            };
            operations.push(operation);
            first = inner;
        }
        let mut inertia = self.resolve_single_solid_inertia(first, cx);
        for operation in operations.into_iter().rev() {
            inertia = match operation {
                InertiaOperation::Add(right) => {
                    let right = self.resolve_inertia(right, cx);
                    inertia.zip(right).map(|(left, right)| left + right)
                }
                InertiaOperation::Rotate(steps) => {
                    let rotation = self.resolve_rotation(steps, cx);
                    inertia
                        .zip(rotation)
                        .map(|(inertia, rotation)| rotation.symmetric_tensor_in_parent_axes(inertia))
                }
            };
        }
        inertia
    }

    /// Returns the inertia of one solid or matrix, or reports an error.
    fn resolve_single_solid_inertia(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Sym3<'g>> {
        match &e.kind {
            ExprKind::Number(0.0) => Some(Sym3::zero(self.graph)),
            ExprKind::Array(_) => self.resolve_symmetric_matrix(e, cx),
            ExprKind::Method(_, method, _) => {
                cx.report_error(
                    method.place.clone(),
                    format!("unknown method `.{}(…)` of an inertia", method.text),
                )
                .suggest_name(&method.text, ["rotated"]);
                None
            }
            ExprKind::Call(solid, arguments) => self.resolve_solid(solid, arguments, cx),
            kind => {
                let found = match kind {
                    ExprKind::Tuple(_) => ", found a list",
                    ExprKind::Number(_) => ", found a number",
                    _ => "",
                };
                let error = cx.report_error(e.place.clone(), format!("expected an inertia{found}"));
                match kind {
                    ExprKind::Tuple(items) if items.len() == 3 => {
                        let items: Vec<String> = items.iter().map(syntax::Expr::short_source_text).collect();
                        error.add_help(format!("write `diagonal({})`", items.join(", ")));
                    }
                    ExprKind::Number(n) => {
                        error.add_help(format!(
                            "write `diagonal({n}, {n}, {n})` for one moment about all axes"
                        ));
                    }
                    ExprKind::Binary(..) if e.all_subexpressions().iter().any(|part| is_solid(part)) => {
                        error.add_help("solids are added with `+`; twice a solid has twice the mass");
                    }
                    ExprKind::Binary(..) | ExprKind::Name(_) | ExprKind::Neg(_) => {
                        error.add_help(
                            "write `diagonal(i, i, i)` for one moment `i` about all axes; in a plane only \
                             the one about its normal counts",
                        );
                    }
                    _ => {}
                }
                error.add_help(
                    "write a solid such as `rod(m, l, y)` or `sphere(m, r)`, `diagonal(xx, yy, zz)`, or a \
                     3×3 matrix",
                );
                None
            }
        }
    }

    fn resolve_symmetric_matrix(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Sym3<'g>> {
        let m = self.resolve_matrix_literal(e, cx)?;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            if m.0[i][j] != m.0[j][i] {
                cx.report_error(e.place.clone(), "an inertia matrix is symmetric").add_help(format!(
                    "entries ({}, {}) and ({}, {}) differ",
                    i + 1,
                    j + 1,
                    j + 1,
                    i + 1
                ));
                return None;
            }
        }
        Some(Sym3::from_upper(&m))
    }

    fn resolve_solid(
        &self,
        callee: &Callee,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Sym3<'g>> {
        let text = callee.text.as_str();
        let Some(Callable::Solid(solid)) = callee.id else {
            let known: Vec<&str> = Solid::names().collect();
            let error = cx.report_error(callee.place.clone(), format!("unknown solid `{text}`"));
            let synonyms = words::solid_synonyms();
            words::suggest_meaning_or_known_word(error, &synonyms, text, &known);
            if let Some(solid) = words::meaning_of_word(&synonyms, text, &known).and_then(Solid::find_by_name)
            {
                error.add_help(format!("it is written `{}`", solid.usage_syntax()));
            }
            if error.has_no_help() {
                error.add_help(
                    "the solids are `rod`, `ring`, `disk`, `cylinder`, `tube`, `cone`, `capsule`, `sphere`, \
                     `shell`, `cuboid`, `plate` and `ellipsoid`, or `diagonal(xx, yy, zz)`",
                );
            }
            return None;
        };
        let row = solid.row();
        if arguments.len() != row.arguments.len() {
            cx.report_error(
                callee.place.clone(),
                format!("`{text}` takes {} arguments", row.arguments.len()),
            )
            .add_help(format!("write `{}`", solid.usage_syntax()));
            return None;
        }
        if self.report_swapped_arguments(solid, arguments, cx) {
            return None;
        }
        let (mut numbers, mut axis, mut complete) = (Vec::new(), None, true);
        for (e, argument) in arguments.iter().zip(row.arguments) {
            if argument.kind.is_direction() {
                axis = Some(self.resolve_unit_vector(e, false, cx)?);
                continue;
            }
            match self.resolve_scalar(e, cx) {
                Some(s) => {
                    complete &= self.check_not_negative(s, e, cx);
                    self.record_parameter_condition(
                        Rule::NotNegative,
                        || format!("the {} of a `{text}`", argument.name),
                        &[s],
                    );
                    numbers.push(s);
                }
                None => complete = false,
            }
        }
        complete.then(|| (row.inertia)(&numbers, axis.unwrap_or_else(|| Vec3::zero(self.graph))))
    }

    /// Reports the first argument that is a vector instead of a scalar or vice versa: most likely the
    /// arguments are in the wrong order.
    fn report_swapped_arguments(
        &self,
        solid: Solid,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> bool {
        for (Argument { name, kind }, argument) in solid.row().arguments.iter().zip(arguments) {
            let mut silent = Diagnostics::silent_diagnostics();
            let found = match (self.resolve_value(argument, &mut silent), kind.is_direction()) {
                (Some(Value::Vector(_)), false) => "a vector",
                (Some(Value::Scalar(s)), true) if !s.is_zero() => "a scalar",
                _ => continue,
            };
            cx.report_error(
                argument.place.clone(),
                format!("expected the {name} of the {}, found {found}", solid.name()),
            )
            .add_help(format!("write `{}`", solid.usage_syntax()));
            return true;
        }
        false
    }

    fn check_not_negative(&self, s: Expr<'g>, argument: &syntax::Expr, cx: &mut Diagnostics) -> bool {
        match s.constant_value() {
            Some(n) if n < 0.0 => {
                cx.report_error(argument.place.clone(), format!("this cannot be negative, but it is {n}"))
                    .add_help("masses, sizes and moments are zero or more");
                false
            }
            _ => true,
        }
    }
}

/// Returns whether an expression is a solid with its arguments.
fn is_solid(e: &syntax::Expr) -> bool {
    matches!(&e.kind, ExprKind::Call(Callee { id: Some(Callable::Solid(_)), .. }, _))
}

/// Reports a constant inertia that is physically impossible for a body of this mass. `hint` is the help on
/// how to accept the inertia anyway.
pub fn check_inertia(
    body: &str,
    mass: Option<f64>,
    inertia: &Sym3<'_>,
    place: &Place,
    hint: &str,
    cx: &mut Diagnostics,
) {
    let Some(m) = inertia.full_matrix().entries_if_all_constant() else { return };
    let moments = principal_moments(m);
    let scale = moments[2].abs().max(moments[0].abs());
    let list = moments.map(rounded_text).join(", ");
    if scale <= ZERO_MOMENT.max(MIN_GYRATION_SQUARED * mass.unwrap_or(0.0)) {
        return;
    }
    if moments[0] < -TOLERANCE * scale {
        cx.report_error(place.clone(), format!("the inertia of `{body}` is not positive definite"))
            .add_help(format!("its principal moments are {list}"))
            .add_help(hint);
    } else if moments[2] > (moments[0] + moments[1]) * (1.0 + TOLERANCE) {
        cx.report_error(place.clone(), format!("the inertia of `{body}` is not physically consistent"))
            .add_help(format!("its principal moments are {list}: the largest exceeds the sum of the others"))
            .add_help(hint);
    } else if mass == Some(0.0) && place.file.is_some() {
        cx.report_error(place.clone(), format!("`{body}` has an inertia and no mass"))
            .add_help("no real body has an inertia without mass: give it a mass, or an inertia of zero")
            .add_help(hint);
    }
}

/// Formats a number with about five digits.
fn rounded_text(x: f64) -> String {
    let rounded: f64 = format!("{x:.4e}").parse().unwrap_or(x);
    match rounded.abs() {
        size if size == 0.0 || (1e-3..1e6).contains(&size) => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

/// Returns the eigenvalues of a symmetric matrix in ascending order (Jacobi rotations).
fn principal_moments(mut a: [[f64; 3]; 3]) -> [f64; 3] {
    for _ in 0..32 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + libm::hypot(theta, 1.0));
            let c = 1.0 / libm::hypot(t, 1.0);
            let s = t * c;
            for k in 0..3 {
                let (x, y) = (a[k][p], a[k][q]);
                (a[k][p], a[k][q]) = (c * x - s * y, s * x + c * y);
            }
            for k in 0..3 {
                let (x, y) = (a[p][k], a[q][k]);
                (a[p][k], a[q][k]) = (c * x - s * y, s * x + c * y);
            }
        }
    }
    let mut moments = [a[0][0], a[1][1], a[2][2]];
    moments.sort_by(f64::total_cmp);
    moments
}
