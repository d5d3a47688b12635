//! Physical matrices, which map vectors to vectors: projectors, rotations, cross products and inertias, with
//! their products, transposes and rates.

use super::call::Call;
use super::quantities::{vector_terms_by_link, vector_value_from_terms};
use super::resolved::ResolvedMatrix;
use super::scope::{AllowedQuantities, Axes, PlacedElement, PlacedElements, Scope, Value, VectorTerms};
use crate::diag::{Diagnostics, Place};
use crate::expr::{Expr, Mat3, Rotation, Vec3};
use crate::kinematics::express_in_link_axes;
use crate::mechanism::LinkId;
use crate::syntax::{self, BinaryOp, GROUND};

impl<'g> PlacedElements<'g> {
    /// Returns a resolved matrix in the axes of another link.
    pub fn matrix_in_link_axes(&self, m: ResolvedMatrix<'g>, link: Option<LinkId>) -> ResolvedMatrix<'g> {
        if m.link == link {
            m
        } else {
            m.rotated_to_link_axes(link, |v| express_in_link_axes(&self.joints, v, m.link, link))
        }
    }

    /// Returns the entries of a matrix in the axes of a frame on a link, column by column.
    pub fn matrix_entries(
        &self,
        m: ResolvedMatrix<'g>,
        link: Option<LinkId>,
        axes: &Rotation<'g>,
    ) -> Vec<Expr<'g>> {
        let here =
            self.matrix_in_link_axes(m, link).rotated_to_link_axes(link, |v| axes.vector_in_child_axes(v));
        (0..3).flat_map(|k| here.entries.column(k).0).collect()
    }
}

impl<'g> Scope<'_, 'g> {
    /// Returns the value of a matrix expression.
    pub fn resolve_matrix_expression(
        &self,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<ResolvedMatrix<'g>> {
        match self.resolve_value(e, cx)? {
            Value::Matrix(m) => Some(m),
            other => {
                cx.report_error(
                    e.place.clone(),
                    format!("expected a matrix, found {}", other.kind_with_article()),
                )
                .add_help(
                    "a matrix is `projector(n)`, `skew(v)`, `outer(a, b)`, `rotation(B / A)`, `inertia(body \
                     / point)` or an expression of these",
                );
                None
            }
        }
    }

    /// Returns a matrix written by its rows, in the axes of the context.
    pub fn resolve_matrix_from_rows(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let entries = self.resolve_matrix_literal(e, cx)?;
        let Some((link, pose)) = self.context.borrow().axes.clone() else {
            return self.report_disallowed_matrix(&e.place, cx);
        };
        let own = ResolvedMatrix { link, entries };
        Some(Value::Matrix(own.rotated_to_link_axes(link, |v| pose.rotation.vector_in_parent_axes(v))))
    }

    /// Reports a matrix in a context that does not allow matrices.
    fn report_disallowed_matrix<T>(&self, place: &Place, cx: &mut Diagnostics) -> Option<T> {
        cx.report_error(place.clone(), "a matrix is not allowed here")
            .add_help("matrices are allowed in definitions, outputs and forces: `#[define(projector(n))]`");
        None
    }

    /// Returns the arguments of a function of matrices, or reports that matrices are not allowed here.
    fn arguments_of_matrix_function<'e, const N: usize>(
        &self,
        call: &Call<'e>,
        cx: &mut Diagnostics,
    ) -> Option<&'e [syntax::Expr; N]> {
        if self.context.borrow().axes.is_none() {
            self.report_disallowed_matrix(call.place, cx)
        } else {
            call.take_arguments(cx)
        }
    }

    /// Resolves a call of `identity()`.
    pub fn resolve_identity(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [] = self.arguments_of_matrix_function(call, cx)?;
        Some(Value::Matrix(ResolvedMatrix { link: None, entries: Mat3::identity(self.graph) }))
    }

    /// Resolves `projector(n)`: `n nᵀ / n·n`, the projection onto a line.
    pub fn resolve_projector(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [a] = self.arguments_of_matrix_function(call, cx)?;
        let (link, [a]) = self.resolve_vectors_in_common_axes([a], cx)?;
        let square = a.dot(a);
        Some(Value::Matrix(ResolvedMatrix { link, entries: Mat3::from_fn(|i, j| a[i] * a[j] / square) }))
    }

    /// Resolves `skew(a)`, with `skew(a) * b = cross(a, b)`.
    pub fn resolve_skew(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [a] = self.arguments_of_matrix_function(call, cx)?;
        let (link, [a]) = self.resolve_vectors_in_common_axes([a], cx)?;
        Some(Value::Matrix(ResolvedMatrix { link, entries: Mat3::skew(a) }))
    }

    /// Resolves a call of `outer(a, b)`: the matrix `a bᵀ`.
    pub fn resolve_outer_product(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [a, b] = self.arguments_of_matrix_function(call, cx)?;
        let (link, [a, b]) = self.resolve_vectors_in_common_axes([a, b], cx)?;
        Some(Value::Matrix(ResolvedMatrix { link, entries: Mat3::from_fn(|i, j| a[i] * b[j]) }))
    }

    /// Resolves a call of `transpose(M)`.
    pub fn transpose(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [m] = self.arguments_of_matrix_function(call, cx)?;
        let m = self.resolve_matrix_expression(m, cx)?;
        Some(Value::Matrix(ResolvedMatrix { entries: m.entries.transpose(), ..m }))
    }

    /// Resolves a call of `trace(M)`.
    pub fn resolve_trace(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [m] = self.arguments_of_matrix_function(call, cx)?;
        let m = self.resolve_matrix_expression(m, cx)?.entries.0;
        Some(Value::Scalar(m[0][0] + m[1][1] + m[2][2]))
    }

    /// Returns the values of several vectors in the axes of one link, with the link.
    fn resolve_vectors_in_common_axes<const N: usize>(
        &self,
        vectors: [&syntax::Expr; N],
        cx: &mut Diagnostics,
    ) -> Option<(Option<LinkId>, [Vec3<'g>; N])> {
        let (axes, v) = self.resolve_in_common_axes(&vectors, cx)?;
        let link = if let Axes::Link(link) = axes { link } else { None };
        Some((link, v.try_into().ok()?))
    }

    /// Resolves `rotation(B / A)`: `Σ bₖ aₖᵀ`, which rotates the axes of A into those of B.
    pub fn resolve_rotation_between_axes(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [operands] = self.arguments_of_matrix_function(call, cx)?;
        let [b, a] = call.take_operands(operands, cx)?;
        if !self.check_allowed_quantity(AllowedQuantities::Placement, "`rotation(…)`", call.place, cx) {
            return None;
        }
        let (link, _) = (self.resolve_frame_link(a, cx), self.resolve_frame_link(b, cx));
        let link = link?;
        let (a, b) = (self.axes_of_named_frame(a)?, self.axes_of_named_frame(b)?);
        let kinematics = &self.kinematics;
        let zero = Vec3::zero(self.graph);
        let [a, b] =
            [a, b].map(|axes| axes.map(|axis| kinematics.components_in_link_axes(&axis, link, zero)));
        let entry_of_relative_rotation =
            |i: usize, j: usize| (0..3).fold(self.graph.zero(), |sum, k| sum + b[k][i] * a[k][j]);
        Some(Value::Matrix(ResolvedMatrix { link, entries: Mat3::from_fn(entry_of_relative_rotation) }))
    }

    /// Returns the axes of the body or frame that an expression names.
    fn axes_of_named_frame(&self, e: &syntax::Expr) -> Option<[VectorTerms<'g>; 3]> {
        let coordinate_axis = |k: usize| Vec3::coordinate_axis(self.graph, k);
        match e.as_name()? {
            GROUND => Some([0, 1, 2].map(|k| vec![(None, coordinate_axis(k))])),
            name => {
                let PlacedElement { link, pose, .. } = self.placement_of_element(name)?;
                Some([0, 1, 2].map(|k| vec![(link, pose.rotation.vector_in_parent_axes(coordinate_axis(k)))]))
            }
        }
    }

    /// Resolves `inertia(body / point)`: the physical inertia matrix of bodies about a point.
    pub fn resolve_inertia_matrix(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [operands] = self.arguments_of_matrix_function(call, cx)?;
        let [bodies_written, about] = call.take_operands(operands, cx)?;
        if !self.check_allowed_quantity(AllowedQuantities::Placement, "`inertia(…)`", call.place, cx) {
            return None;
        }
        let bodies = self.resolve_bodies_with_mass(bodies_written, cx)?;
        let about = self.placement_of_moving_point(about, cx)?;
        let link = bodies.first().and_then(|(placed, _)| placed.link);
        let terms_of_coordinate_axis =
            |k: usize| -> VectorTerms<'g> { vec![(link, Vec3::coordinate_axis(self.graph, k))] };
        let entries = Mat3::from_fn(|i, j| {
            let (i, j) = (i.min(j), i.max(j));
            bodies.iter().fold(self.graph.zero(), |sum, body| {
                sum + self.moment_of_inertia_about_point(
                    body,
                    &about,
                    [&terms_of_coordinate_axis(i), &terms_of_coordinate_axis(j)],
                )
            })
        });
        Some(Value::Matrix(ResolvedMatrix { link, entries }))
    }

    /// Returns the value of a sum, difference or product that contains a matrix.
    pub fn resolve_matrix_operation(
        &self,
        op: BinaryOp,
        left: Value<'g>,
        right: Value<'g>,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let kinematics = &self.kinematics;
        Some(match (op, left, right) {
            (BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul, Value::Matrix(a), Value::Matrix(b)) => {
                let b = kinematics.matrix_in_link_axes(b, a.link).entries;
                let entries = match op {
                    BinaryOp::Add => a.entries + b,
                    BinaryOp::Sub => a.entries - b,
                    _ => a.entries * b,
                };
                Value::Matrix(ResolvedMatrix { entries, ..a })
            }
            (BinaryOp::Mul, Value::Matrix(m), Value::Vector(v)) => {
                let v = kinematics.components_in_link_axes(
                    &vector_terms_by_link(v),
                    m.link,
                    Vec3::zero(self.graph),
                );
                vector_value_from_terms(vec![(m.link, m.entries * v)])
            }
            (BinaryOp::Mul, Value::Scalar(s), Value::Matrix(m))
            | (BinaryOp::Mul, Value::Matrix(m), Value::Scalar(s)) => Value::Matrix(m.map(|entry| entry * s)),
            (BinaryOp::Div, Value::Matrix(m), Value::Scalar(s)) => Value::Matrix(m.map(|entry| entry / s)),
            (op, left, right) => {
                let (what, help) = match op {
                    BinaryOp::Mul => (
                        "multiplied by",
                        "a matrix is the left factor, `M * v`; for a row vector, write `transpose(M) * v`",
                    ),
                    BinaryOp::Div => {
                        ("divided by", "divide by a scalar, or multiply by `transpose(M)` of a rotation")
                    }
                    BinaryOp::Add => ("added to", "a scalar times `identity()` is a matrix"),
                    BinaryOp::Sub => ("subtracted from", "a scalar times `identity()` is a matrix"),
                };
                let (first, second) = match op {
                    BinaryOp::Sub => (&right, &left),
                    _ => (&left, &right),
                };
                cx.report_error(
                    e.place.clone(),
                    format!("{} cannot be {what} {}", first.kind_with_article(), second.kind_with_article()),
                )
                .add_help(help);
                return None;
            }
        })
    }
}
