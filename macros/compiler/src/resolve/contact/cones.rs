//! A cone that rolls on a plane, on a cone or inside a cone. The surfaces touch along a line. No point of
//! that line slips if and only if the apexes coincide and the relative rotation is about the line (Poinsot's
//! rolling cones).
//!
//! Let `a` and `b` be the axes, `α` and `β` the half angles, and `δ` the angle between the axes (`β − α`
//! inside, `α + β` outside). The line of contact lies in the plane of the axes at the angle `α` from `a`. The
//! vector `± (b cos α − a cos β) / sin δ` is normal to both surfaces there. A plane is a funnel with the half
//! angle `π/2`.

use super::pair::SurfacePair;
use super::surface::SurfaceForm;
use crate::diag::Diagnostics;
use crate::expr::Vec3;
use crate::kinematics::perpendicular_directions;
use crate::mechanism::{Constraint, MeasuredQuantity, Rule};
use crate::resolve::rows::{ConstraintRows, constraint_from_residual_and_rate};
use crate::resolve::scope::Scope;
use crate::syntax;

/// Returns the rows of a pair whose first surface is a cone; `None` after an error.
pub(super) fn constraint_rows_of_rolling_cone<'g>(
    scope: &Scope<'_, 'g>,
    constraint: &syntax::Constraint,
    pair: &SurfacePair<'_, 'g>,
    cx: &mut Diagnostics,
) -> Option<ConstraintRows<'g>> {
    let g = scope.graph;
    let SurfaceForm::Cone(half, axis) = pair.a.form else { return None };
    let (sine_b, cosine_b, axis_b, inside) = match pair.b.form {
        SurfaceForm::Plane(n) => (g.one(), g.zero(), n, true),
        SurfaceForm::Cone(half, n) => (half.sin(), half.cos(), n, false),
        SurfaceForm::Funnel(half, n) => (half.sin(), half.cos(), n, true),
        _ => return None,
    };
    let (sine_a, cosine_a) = (half.sin(), half.cos());
    let side = g.num(if inside { 1.0 } else { -1.0 });
    let sine = sine_b * cosine_a - side * cosine_b * sine_a;
    if sine.constant_value().is_some_and(|n| n <= 0.0) {
        cx.report_error(constraint.value.place.clone(), "this cone does not fit into the funnel")
            .add_help("give the funnel a larger half angle than the cone");
        return None;
    }
    let sine_of_surface_angle_text =
        || format!("the sine of the angle between the surfaces of `{}`", constraint.name.text);
    scope.record_parameter_condition(Rule::Positive, sine_of_surface_angle_text, &[sine]);
    let (a, b) = (pair.direction_of_first_body(axis), pair.direction_of_second_body(axis_b));
    // Rows of the apex: three positions, or one position and two velocities.
    let apex = match pair.b.form {
        SurfaceForm::Plane(n) => {
            let [first, second] = perpendicular_directions(n);
            [("normal", n, true), (first.0, first.1, false), (second.0, second.1, false)]
        }
        _ => [0, 1, 2].map(|k| (["x", "y", "z"][k], Vec3::coordinate_axis(g, k), true)),
    };
    let (away, slip) = (pair.center.value - pair.base.value, pair.slip(Vec3::zero(g)));
    let (name, place) = (&constraint.name.text, &constraint.name.place);
    let mut rows = Vec::new();
    for (word, e, is_place) in apex {
        let e = pair.direction_of_second_body(e).value;
        let gap = is_place.then(|| e.dot(away));
        rows.push(constraint_from_residual_and_rate(
            scope,
            (format!("{name}.{word}"), place),
            MeasuredQuantity::Length,
            gap,
            e.dot(slip),
        ));
    }
    // The angle by which the wide end is lifted, to first order.
    let cosine = cosine_b * cosine_a + side * sine_b * sine_a;
    let lifted = side / sine;
    let tilt = (a.value.dot(b.value) - cosine) * lifted;
    let rate = (a.rate.dot(b.value) + a.value.dot(b.rate)) * lifted;
    let tilt = constraint_from_residual_and_rate(
        scope,
        (format!("{name}.tilt"), place),
        MeasuredQuantity::Angle,
        Some(tilt),
        rate,
    );
    let normal = (b.value * cosine_a - a.value * cosine_b) * lifted;
    let [w_a, w_b] = pair.angular_velocities();
    let spin = normal.dot(w_a - w_b);
    let spin = constraint_from_residual_and_rate(
        scope,
        (format!("{name}.spin"), place),
        MeasuredQuantity::Angle,
        None,
        spin,
    );
    rows.extend([tilt, spin].map(|row| Constraint { group: 1, ..row }));
    Some(ConstraintRows { rows, surfaces: pair.written_surfaces(), ..ConstraintRows::default() })
}
