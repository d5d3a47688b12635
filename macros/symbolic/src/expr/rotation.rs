//! Rotations as sequences of elementary steps. A constant rotation followed by a joint's rotation about a
//! coordinate axis costs fewer operations when applied step by step than as one matrix.

use super::matrix::{Mat3, Sym3, Vec3};
use super::node::{Function, Node};
use super::{Expr, Graph};

/// One step of a rotation, which is applied to the axes after the previous step.
#[derive(Clone, Copy, Debug)]
enum RotationStep<'g> {
    /// Elementary step that is a general rotation matrix.
    Matrix(Mat3<'g>),
    /// A rotation about coordinate axis `axis` by the angle with this sine and cosine.
    Axis { axis: usize, sin: Expr<'g>, cos: Expr<'g> },
}

/// The orientation of a child frame in a parent frame: `v_parent = R v_child`, where `R` is a product of
/// steps.
#[derive(Clone, Debug)]
pub struct Rotation<'g> {
    steps: Vec<RotationStep<'g>>,
    graph: &'g Graph,
}

impl<'g> Rotation<'g> {
    /// Returns the identity rotation.
    pub fn identity(graph: &'g Graph) -> Rotation<'g> {
        Rotation { steps: Vec::new(), graph }
    }

    /// Returns the rotation about coordinate axis `axis` by `angle`, rad.
    pub fn rotation_about_coordinate_axis(axis: usize, angle: Expr<'g>) -> Rotation<'g> {
        let graph = angle.graph();
        let step =
            RotationStep::Axis { axis, sin: round_to_zero(angle.sin()), cos: round_to_zero(angle.cos()) };
        let mut rotation = Rotation::identity(graph);
        rotation.append_step(step);
        rotation
    }

    /// Returns the rotation with matrix `m`, whose columns are the child's axes in the parent frame.
    pub fn from_matrix(m: Mat3<'g>) -> Rotation<'g> {
        let mut rotation = Rotation::identity(m.0[0][0].graph());
        rotation.append_step(RotationStep::Matrix(m));
        rotation
    }

    /// Returns the rotation by `angle`, rad, about the unit vector `n` (Rodrigues's formula).
    pub fn rotation_about_axis(n: Vec3<'g>, angle: Expr<'g>) -> Rotation<'g> {
        for k in 0..3 {
            let others_zero = n[(k + 1) % 3].is_zero() && n[(k + 2) % 3].is_zero();
            match n[k].constant_value() {
                Some(1.0) if others_zero => return Rotation::rotation_about_coordinate_axis(k, angle),
                Some(-1.0) if others_zero => return Rotation::rotation_about_coordinate_axis(k, -angle),
                _ => {}
            }
        }
        let (sin, cos) = (angle.sin(), angle.cos());
        let versine = angle.num(1.0) - cos;
        let skew = Mat3::skew(n);
        Rotation::from_matrix(Mat3::from_fn(|i, j| {
            let diagonal = if i == j { cos } else { cos.zero() };
            diagonal + versine * n[i] * n[j] + sin * skew.0[i][j]
        }))
    }

    /// Returns the rotation of a unit quaternion with components x, y, z, w.
    pub fn from_quaternion(q: [Expr<'g>; 4]) -> Rotation<'g> {
        let [x, y, z, w] = q;
        let (x2, y2, z2) = (x + x, y + y, z + z);
        let (xx, yy, zz) = (x * x2, y * y2, z * z2);
        let (xy, xz, yz) = (x2 * y, x2 * z, y2 * z);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        let one = x.num(1.0);
        Rotation::from_matrix(Mat3([
            [one - (yy + zz), xy - wz, xz + wy],
            [xy + wz, one - (xx + zz), yz - wx],
            [xz - wy, yz + wx, one - (xx + yy)],
        ]))
    }

    /// Returns the composition of this rotation and `next`, which is relative to the rotated frame.
    pub fn compose_with(mut self, next: &Rotation<'g>) -> Rotation<'g> {
        for step in &next.steps {
            self.append_step(*step);
        }
        self
    }

    /// Returns the inverse rotation.
    pub fn inverse(&self) -> Rotation<'g> {
        let steps = self.steps.iter().rev().map(|s| s.inverse()).collect();
        Rotation { steps, graph: self.graph }
    }

    /// Appends a step to the rotation. Adjacent constant steps are multiplied. If the product has a zero
    /// entry, it is stored as rotations by right angles and about coordinate axes; otherwise as one matrix.
    fn append_step(&mut self, step: RotationStep<'g>) {
        let Some(mut product) = step.matrix_if_constant() else {
            self.steps.push(step);
            return;
        };
        while let Some(last) = self.steps.last().and_then(RotationStep::matrix_if_constant) {
            product = last * product;
            self.steps.pop();
        }
        match factor_constant_rotation(&product) {
            Some(steps) => self.steps.extend(steps),
            None => self.steps.push(RotationStep::Matrix(product)),
        }
    }

    /// Returns true if the rotation is structurally the identity.
    pub fn is_identity(&self) -> bool {
        self.steps.is_empty()
    }

    /// Transforms a vector from the child to the parent frame.
    pub fn vector_in_parent_axes(&self, v: Vec3<'g>) -> Vec3<'g> {
        self.steps.iter().rev().fold(v, |v, step| step.rotate_vector(v))
    }

    /// Transforms a vector from the parent to the child frame.
    pub fn vector_in_child_axes(&self, v: Vec3<'g>) -> Vec3<'g> {
        self.steps.iter().fold(v, |v, step| step.inverse().rotate_vector(v))
    }

    /// Transforms a symmetric tensor from the child to the parent frame: `R X Rᵀ`.
    pub fn symmetric_tensor_in_parent_axes(&self, x: Sym3<'g>) -> Sym3<'g> {
        self.steps.iter().rev().fold(x, |x, step| step.rotate_symmetric_tensor(x))
    }

    /// Transforms a tensor from the child to the parent frame: `R X Rᵀ`.
    pub fn tensor_in_parent_axes(&self, x: Mat3<'g>) -> Mat3<'g> {
        self.steps.iter().rev().fold(x, |x, step| step.rotate_tensor(x))
    }

    /// Applies a function to all expressions that the rotation contains.
    pub fn map(&self, f: &dyn Fn(Expr<'g>) -> Expr<'g>) -> Rotation<'g> {
        let map_step = |step: &RotationStep<'g>| match *step {
            RotationStep::Matrix(m) => RotationStep::Matrix(Mat3::from_fn(|i, j| f(m.0[i][j]))),
            RotationStep::Axis { axis, sin, cos } => RotationStep::Axis { axis, sin: f(sin), cos: f(cos) },
        };
        Rotation { steps: self.steps.iter().map(map_step).collect(), graph: self.graph }
    }

    /// Combines the rotations of several lanes into one rotation with lanes. `merge` combines one expression
    /// per lane; the result is `None` if `merge` fails.
    pub fn merge_into_lanes(
        lanes: &[&Rotation<'g>],
        merge: &mut dyn FnMut(&[Expr<'g>]) -> Option<Expr<'g>>,
    ) -> Option<Rotation<'g>> {
        let first = lanes.first()?;
        let mut rotation = Rotation::identity(first.graph);
        // The trailing steps that are of the same kind in all lanes are combined one by one. The steps before
        // them become one matrix.
        let rotation_step_from_end = |r: &Rotation<'g>, k: usize| r.steps.iter().rev().nth(k).copied();
        let is_common_step = |k: &usize| {
            let all = lanes.iter().map(|r| rotation_step_from_end(r, *k).map(|step| step.step_kind()));
            let mut kinds = all.collect::<Vec<_>>();
            kinds.dedup();
            kinds.len() == 1 && kinds[0].is_some()
        };
        let common = (0..first.steps.len()).take_while(is_common_step).count();
        let rotation_without_common_steps = |r: &Rotation<'g>| {
            let steps = r.steps[..r.steps.len() - common].to_vec();
            Rotation { steps, graph: r.graph }
        };
        if lanes.iter().any(|r| r.steps.len() > common) {
            let matrices: Vec<Mat3<'g>> =
                lanes.iter().map(|r| rotation_without_common_steps(r).rotation_matrix()).collect();
            rotation.steps.push(RotationStep::Matrix(merge_matrix_lanes(&matrices, merge)?));
        }
        for k in (0..common).rev() {
            let steps: Vec<RotationStep<'g>> =
                lanes.iter().filter_map(|r| rotation_step_from_end(r, k)).collect();
            rotation.steps.push(RotationStep::merge_into_lanes(&steps, merge)?);
        }
        Some(rotation)
    }

    /// Returns the rotation matrix, whose columns are the child's axes in the parent frame.
    pub fn rotation_matrix(&self) -> Mat3<'g> {
        let columns: [Vec3<'g>; 3] =
            std::array::from_fn(|k| self.vector_in_parent_axes(Vec3::coordinate_axis(self.graph, k)));
        Mat3::from_fn(|i, j| columns[j][i])
    }
}

/// Replaces a constant of the magnitude of rounding error by zero: in floating point, the sine of π and the
/// cosine of π/2 are not exactly zero.
fn round_to_zero(e: Expr<'_>) -> Expr<'_> {
    match e.constant_value() {
        Some(x) if x.abs() <= 4.0 * f64::EPSILON => e.zero(),
        _ => e,
    }
}

fn merge_matrix_lanes<'g>(
    lanes: &[Mat3<'g>],
    merge: &mut dyn FnMut(&[Expr<'g>]) -> Option<Expr<'g>>,
) -> Option<Mat3<'g>> {
    let mut matrix = *lanes.first()?;
    for i in 0..3 {
        for j in 0..3 {
            matrix.0[i][j] = merge(&lanes.iter().map(|m| m.0[i][j]).collect::<Vec<_>>())?;
        }
    }
    Some(matrix)
}

/// Factors a constant rotation matrix with a zero entry into a rotation by right angles and at most two
/// rotations about coordinate axes. `None` if no entry is zero.
fn factor_constant_rotation<'g>(m: &Mat3<'g>) -> Option<Vec<RotationStep<'g>>> {
    let g = m.0[0][0].graph();
    let steps = factor_rotation_about_axis(m).or_else(|| {
        let (r, c) = (0..9).map(|k| (k / 3, k % 3)).find(|(r, c)| m.0[*r][*c].is_zero())?;
        // Column c is normal to axis r. After a rotation about r, column c of the remainder is a coordinate
        // axis.
        let (s, t) = ((r + 1) % 3, (r + 2) % 3);
        let first = RotationStep::Axis { axis: r, sin: m.0[t][c], cos: m.0[s][c] };
        let mut rest = first.inverse().step_matrix() * *m;
        (rest.0[r][c], rest.0[s][c], rest.0[t][c]) = (g.zero(), g.one(), g.zero());
        rest.0[s][(c + 1) % 3] = g.zero();
        rest.0[s][(c + 2) % 3] = g.zero();
        Some([vec![first], factor_rotation_about_axis(&rest)?].concat())
    })?;
    // A matrix that is not a rotation within rounding error is not factored.
    let product = steps.iter().fold(Mat3::identity(g), |p, step| p * step.step_matrix());
    let error =
        (product - *m).entries_if_all_constant()?.as_flattened().iter().fold(0.0_f64, |e, x| e.max(x.abs()));
    (error <= 8.0 * f64::EPSILON).then_some(steps)
}

/// Factors a constant rotation matrix that has a coordinate axis as a column: a rotation by right angles,
/// followed by a rotation about that axis. Returns `None` for other matrices.
fn factor_rotation_about_axis<'g>(m: &Mat3<'g>) -> Option<Vec<RotationStep<'g>>> {
    let g = m.0[0][0].graph();
    let values = m.entries_if_all_constant()?;
    if *m == Mat3::identity(g) {
        return Some(Vec::new());
    }
    let column_of_values = |j: usize| [values[0][j], values[1][j], values[2][j]];
    let is_coordinate_axis = |v: [f64; 3]| v.iter().filter(|c| **c == 0.0).count() == 2;
    let b = (0..3).find(|j| is_coordinate_axis(column_of_values(*j)))?;
    let i = (b + 1) % 3;
    let x = column_of_values(i);
    let r = (0..3).max_by(|p, q| x[*p].abs().total_cmp(&x[*q].abs()))?;
    // Nearest rotation by right angles.
    let along = m.column(b);
    let mut near = Vec3::zero(g);
    near.0[r] = g.num(x[r].signum());
    let last = along.cross(near);
    let mut right = Mat3::zero(g);
    for k in 0..3 {
        (right.0[k][b], right.0[k][i], right.0[k][(b + 2) % 3]) = (along[k], near[k], last[k]);
    }
    let (cos, sin) = (near.dot(m.column(i)), last.dot(m.column(i)));
    let mut steps = Vec::new();
    if right != Mat3::identity(g) {
        steps.push(RotationStep::Matrix(right));
    }
    if !sin.is_zero() {
        steps.push(RotationStep::Axis { axis: b, sin, cos });
    }
    Some(steps)
}

impl<'g> Rotation<'g> {
    /// Returns the angular velocity in the child's axes, `[ω]× = Rᵀ Ṙ`, given the rate of every expression.
    /// Computed step by step, so that a rotation about an axis gives the rate of its angle without a factor
    /// `sin² + cos²`.
    pub fn angular_velocity(&self, rate: &mut dyn FnMut(Expr<'g>) -> Expr<'g>) -> Vec3<'g> {
        self.steps.iter().fold(Vec3::zero(self.graph), |carried, step| {
            step.inverse().rotate_vector(carried) + step.angular_velocity(rate)
        })
    }
}

impl<'g> RotationStep<'g> {
    /// Returns the coordinate axis of the rotation, or 3 for a matrix.
    fn step_kind(&self) -> usize {
        match self {
            RotationStep::Axis { axis, .. } => *axis,
            RotationStep::Matrix(_) => 3,
        }
    }

    /// Combines elementary rotations of one kind, one for each SIMD lane, into a rotation with lanes.
    fn merge_into_lanes(
        lanes: &[RotationStep<'g>],
        merge: &mut dyn FnMut(&[Expr<'g>]) -> Option<Expr<'g>>,
    ) -> Option<RotationStep<'g>> {
        let RotationStep::Axis { axis, .. } = *lanes.first()? else {
            let matrices: Vec<Mat3<'g>> = lanes.iter().map(RotationStep::step_matrix).collect();
            return Some(RotationStep::Matrix(merge_matrix_lanes(&matrices, merge)?));
        };
        let lane_sines_or_cosines = |sine: bool| {
            let sine_or_cosine_of_step = |step: &RotationStep<'g>| match *step {
                RotationStep::Axis { sin, cos, .. } => Some(if sine { sin } else { cos }),
                RotationStep::Matrix(_) => None,
            };
            lanes.iter().map(sine_or_cosine_of_step).collect::<Option<Vec<_>>>()
        };
        Some(RotationStep::Axis {
            axis,
            sin: merge(&lane_sines_or_cosines(true)?)?,
            cos: merge(&lane_sines_or_cosines(false)?)?,
        })
    }

    fn angular_velocity(&self, rate: &mut dyn FnMut(Expr<'g>) -> Expr<'g>) -> Vec3<'g> {
        match *self {
            RotationStep::Axis { axis, sin, cos } => {
                let speed = match angle_if_sine(sin) {
                    Some(angle) => rate(angle),
                    None => cos * rate(sin) - sin * rate(cos),
                };
                Vec3::coordinate_axis(sin.graph(), axis) * speed
            }
            RotationStep::Matrix(m) => {
                let d = Mat3::from_fn(|i, j| rate(m.0[i][j]));
                Vec3([
                    m.column(2).dot(d.column(1)),
                    m.column(0).dot(d.column(2)),
                    m.column(1).dot(d.column(0)),
                ])
            }
        }
    }

    /// Returns the matrix of an elementary rotation if every entry is constant.
    fn matrix_if_constant(&self) -> Option<Mat3<'g>> {
        let matrix = self.step_matrix();
        matrix.entries_if_all_constant().map(|_| matrix)
    }

    fn step_matrix(&self) -> Mat3<'g> {
        match *self {
            RotationStep::Matrix(m) => m,
            RotationStep::Axis { axis, sin, cos } => {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut m = Mat3::zero(sin.graph()).0;
                m[axis][axis] = sin.num(1.0);
                (m[i][i], m[i][j], m[j][i], m[j][j]) = (cos, -sin, sin, cos);
                Mat3(m)
            }
        }
    }

    fn inverse(&self) -> RotationStep<'g> {
        match *self {
            RotationStep::Matrix(m) => RotationStep::Matrix(m.transpose()),
            RotationStep::Axis { axis, sin, cos } => RotationStep::Axis { axis, sin: -sin, cos },
        }
    }

    fn rotate_vector(&self, v: Vec3<'g>) -> Vec3<'g> {
        match *self {
            RotationStep::Matrix(m) => m * v,
            RotationStep::Axis { axis, sin, cos } => {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut out = v.0;
                out[i] = cos * v[i] - sin * v[j];
                out[j] = sin * v[i] + cos * v[j];
                Vec3(out)
            }
        }
    }

    fn rotate_tensor(&self, x: Mat3<'g>) -> Mat3<'g> {
        match *self {
            RotationStep::Matrix(m) => m * x * m.transpose(),
            RotationStep::Axis { axis: k, sin, cos } => {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let x = &x.0;
                let mut out = *x;
                // The 2×2 block with four products: u = c d − s e, d = xx − yy, e = xy + yx.
                let u = cos * (x[i][i] - x[j][j]) - sin * (x[i][j] + x[j][i]);
                let (cu, su) = (cos * u, sin * u);
                (out[i][i], out[j][j]) = (x[j][j] + cu, x[i][i] - cu);
                (out[i][j], out[j][i]) = (x[i][j] + su, x[j][i] + su);
                (out[k][i], out[k][j]) = (cos * x[k][i] - sin * x[k][j], sin * x[k][i] + cos * x[k][j]);
                (out[i][k], out[j][k]) = (cos * x[i][k] - sin * x[j][k], sin * x[i][k] + cos * x[j][k]);
                Mat3(out)
            }
        }
    }

    fn rotate_symmetric_tensor(&self, x: Sym3<'g>) -> Sym3<'g> {
        match self {
            RotationStep::Matrix(m) => {
                let half = *m * x.full_matrix();
                let upper =
                    Mat3::from_fn(|i, j| if i <= j { half.row(i).dot(m.row(j)) } else { m.0[0][0].zero() });
                Sym3::from_upper(&upper)
            }
            RotationStep::Axis { axis: k, sin, cos } => {
                let (i, j, k) = ((k + 1) % 3, (k + 2) % 3, *k);
                // Same formula as in `rotate_tensor`. Twice the sine can be shared between several tensors,
                // but if `xy` is a multiple, doubling its coefficient costs nothing.
                let xy = x.entry(i, j);
                let twice = if xy.has_constant_factor() { *sin * (xy * 2.0) } else { (*sin * 2.0) * xy };
                let u = *cos * (x.entry(i, i) - x.entry(j, j)) - twice;
                let (cu, su) = (*cos * u, *sin * u);
                let mut out = x.full_matrix();
                (out.0[i][i], out.0[j][j]) = (x.entry(j, j) + cu, x.entry(i, i) - cu);
                let (ij, ki, kj) = (
                    x.entry(i, j) + su,
                    *cos * x.entry(k, i) - *sin * x.entry(k, j),
                    *sin * x.entry(k, i) + *cos * x.entry(k, j),
                );
                for (a, b, e) in [(i, j, ij), (k, i, ki), (k, j, kj)] {
                    (out.0[a][b], out.0[b][a]) = (e, e);
                }
                Sym3::from_upper(&out)
            }
        }
    }
}

/// Returns the angle of an expression that is a sine, or the negative of a sine.
fn angle_if_sine(sin: Expr<'_>) -> Option<Expr<'_>> {
    let graph = sin.graph();
    match sin.node() {
        Node::Call(Function::Sin, angle) => Some(graph.expr(angle)),
        Node::Neg(inner) => angle_if_sine(graph.expr(inner)).map(|angle| -angle),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numeric_matrix(rotation: &Rotation<'_>) -> [[f64; 3]; 3] {
        rotation.rotation_matrix().entries_if_all_constant().unwrap()
    }

    #[test]
    fn constant_rotations_use_the_fewest_elementary_steps() {
        let g = Graph::new();
        let axis_rotation = |k, angle: f64| Rotation::rotation_about_coordinate_axis(k, g.num(angle));
        let right = Mat3([[0, 1, 0], [0, 0, -1], [-1, 0, 0]].map(|r| r.map(|c| g.num(f64::from(c)))));
        for (rotation, steps) in [
            (axis_rotation(1, 0.3).compose_with(&axis_rotation(1, -0.3)), 0),
            (Rotation::from_matrix(right), 1),
            (axis_rotation(1, 0.3).compose_with(&axis_rotation(1, 0.4)), 1),
            (axis_rotation(0, 2.0), 2),
            (Rotation::from_matrix(right).compose_with(&axis_rotation(2, 0.1)), 2),
            (axis_rotation(0, 0.3).compose_with(&axis_rotation(1, 0.4)), 2),
            (
                axis_rotation(0, 0.3)
                    .compose_with(&axis_rotation(1, 0.4))
                    .compose_with(&axis_rotation(2, 0.5)),
                1,
            ),
        ] {
            assert_eq!(rotation.steps.len(), steps, "{rotation:?}");
        }
    }

    #[test]
    fn elementary_rotations_equal_the_rotation_matrix() {
        let g = Graph::new();
        let axis_rotation = |k, angle: f64| Rotation::rotation_about_coordinate_axis(k, g.num(angle));
        let v = Vec3::vector_from_constants(&g, [0.7, -1.1, 0.4]);
        let tensor =
            Sym3 { diagonal: [1.0, 2.0, 3.5].map(|c| g.num(c)), off: [0.2, -0.3, 0.6].map(|c| g.num(c)) };
        for rotation in [
            axis_rotation(0, 0.3).compose_with(&axis_rotation(1, 2.4)),
            axis_rotation(2, -3.0).compose_with(&axis_rotation(0, 1.0)),
        ] {
            let m = Mat3(numeric_matrix(&rotation).map(|r| r.map(|c| g.num(c))));
            let full = m * tensor.full_matrix() * m.transpose();
            let pairs =
                (0..3).map(|i| ((m * v)[i], rotation.vector_in_parent_axes(v)[i])).chain((0..9).map(|k| {
                    (
                        full.0[k / 3][k % 3],
                        rotation.symmetric_tensor_in_parent_axes(tensor).entry(k / 3, k % 3),
                    )
                }));
            for (a, b) in pairs {
                assert!((a.constant_value().unwrap() - b.constant_value().unwrap()).abs() < 1e-14);
            }
        }
    }
}
