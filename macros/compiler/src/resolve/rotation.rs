//! Resolution of rotations and matrices that are written in expressions.

use super::corrections::{
    MATRIX_SYNTAX, check_angle, may_be_rotation, report_expected_rotation, report_invalid_matrix,
};
use super::scope::Scope;
use crate::diag::{Diagnostics, Place};
use crate::expr::sample::always_equals_number;
use crate::expr::{Expr, Mat3, Rotation};
use crate::language::{self, Callable};
use crate::mechanism::Rule;
use crate::syntax::{self, Callee, ExprKind};

impl<'g> Scope<'_, 'g> {
    /// Returns the product of successive rotations about rotated axes.
    pub fn resolve_rotation(&self, steps: &[syntax::Expr], cx: &mut Diagnostics) -> Option<Rotation<'g>> {
        let mut whole = Some(Rotation::identity(self.graph));
        for step in steps {
            if !may_be_rotation(step) {
                report_expected_rotation(step, cx);
                return None;
            }
            let next = self.resolve_rotation_step(step, cx);
            whole = whole.zip(next).map(|(whole, next)| whole.compose_with(&next));
        }
        whole
    }

    fn resolve_rotation_step(&self, step: &syntax::Expr, cx: &mut Diagnostics) -> Option<Rotation<'g>> {
        match &step.kind {
            ExprKind::Call(Callee { id: Some(Callable::Rotation(id)), .. }, arguments) => {
                match (id, id.index_of_axis(), arguments.as_slice()) {
                    (_, Some(k), [angle]) => {
                        return Some(Rotation::rotation_about_coordinate_axis(
                            k,
                            self.resolve_angle_in_radians(angle, cx)?,
                        ));
                    }
                    (language::Rotation::Eigenaxis, _, [n, angle]) => {
                        let n = self.resolve_unit_vector(n, false, cx);
                        let angle = self.resolve_angle_in_radians(angle, cx);
                        return Some(Rotation::rotation_about_axis(n?, angle?));
                    }
                    (language::Rotation::Quaternion, _, [x, y, z, w]) => {
                        let parts: Vec<_> = [x, y, z, w].iter().map(|e| self.resolve_scalar(e, cx)).collect();
                        let q = [parts[0]?, parts[1]?, parts[2]?, parts[3]?];
                        let square = q.iter().fold(self.graph.zero(), |sum, c| sum + c.square());
                        if square.constant_value().is_some_and(|n| (n - 1.0).abs() > 1e-9) {
                            cx.report_error(step.place.clone(), "this quaternion is not of unit length")
                                .add_help("its four numbers are x, y, z, w, and their squares add up to one");
                            return None;
                        }
                        self.record_parameter_condition(Rule::Unit, || "a quaternion".to_string(), &[square]);
                        return Some(Rotation::from_quaternion(q));
                    }
                    _ if id.row().natural => {
                        let word = id.name();
                        cx.report_error(
                            step.place.clone(),
                            format!("`{word}` must be the first rotation of a `Frame`"),
                        )
                        .add_help(format!(
                            "write `#[frame(ground, {word}(…))]`, followed by further rotations"
                        ));
                        return None;
                    }
                    _ => {}
                }
            }
            ExprKind::Array(_) => {
                let matrix = self.resolve_matrix_literal(step, cx)?;
                return check_rotation_matrix(&matrix, &step.place, cx)
                    .then(|| Rotation::from_matrix(matrix));
            }
            _ => {}
        }
        report_expected_rotation(step, cx);
        None
    }

    /// Returns an angle, rad. A plain number beyond a full revolution is most likely in degrees and is
    /// reported.
    pub fn resolve_angle_in_radians(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Expr<'g>> {
        if check_angle(e, cx) { self.resolve_scalar(e, cx) } else { None }
    }

    /// Returns a 3×3 matrix written as an array of rows.
    pub fn resolve_matrix_literal(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Mat3<'g>> {
        let mut m = Mat3::zero(self.graph);
        let rows = match &e.kind {
            ExprKind::Array(rows) if rows.len() == 3 => rows,
            _ => {
                report_invalid_matrix(e, cx);
                return None;
            }
        };
        if rows.iter().all(|row| !matches!(row.kind, ExprKind::Array(_) | ExprKind::Tuple(_))) {
            report_invalid_matrix(e, cx);
            return None;
        }
        for (i, row) in rows.iter().enumerate() {
            match &row.kind {
                ExprKind::Array(entries) if entries.len() == 3 => {
                    for (j, entry) in entries.iter().enumerate() {
                        m.0[i][j] = self.resolve_scalar(entry, cx)?;
                    }
                }
                _ => {
                    cx.report_error(row.place.clone(), "expected a row of three numbers")
                        .add_help(MATRIX_SYNTAX);
                    return None;
                }
            }
        }
        Some(m)
    }
}

/// Whether a matrix is a rotation matrix; reports it otherwise. Matrices of parameters are sampled.
fn check_rotation_matrix(m: &Mat3<'_>, place: &Place, cx: &mut Diagnostics) -> bool {
    let product = m.transpose() * *m;
    let determinant = m.column(0).cross(m.column(1)).dot(m.column(2));
    let orthogonal =
        (0..3).all(|i| (0..3).all(|j| always_equals_number(product.0[i][j], if i == j { 1.0 } else { 0.0 })));
    if orthogonal && always_equals_number(determinant, 1.0) {
        return true;
    }
    cx.report_error(place.clone(), "this matrix is not a rotation")
        .add_help("its columns are three orthogonal unit vectors that form a right-handed frame");
    false
}
