//! Rotations as sequences of elementary steps. A joint's rotation about a coordinate axis after a constant one costs
//! less applied step by step than as one matrix.

use super::graph::{Expr, Graph};
use super::matrix::{Mat3, Sym3, Vec3};

/// One step of a rotation.
#[derive(Clone, Copy, Debug)]
enum Step<'g> {
    /// A rotation matrix.
    Matrix(Mat3<'g>),
    /// A rotation about coordinate axis `axis` by the angle with this sine and cosine.
    Axis { axis: usize, sin: Expr<'g>, cos: Expr<'g> },
}

/// The orientation of a child frame in a parent frame: `v_parent = R v_child`, `R` a product of steps.
#[derive(Clone, Debug)]
pub struct Rotation<'g> {
    steps: Vec<Step<'g>>,
    graph: &'g Graph,
}

impl<'g> Rotation<'g> {
    /// No rotation.
    pub fn identity(graph: &'g Graph) -> Rotation<'g> {
        Rotation { steps: Vec::new(), graph }
    }

    /// A rotation about coordinate axis `axis` by `angle`.
    pub fn about_axis(axis: usize, angle: Expr<'g>) -> Rotation<'g> {
        let graph = angle.graph();
        let step = Step::Axis { axis, sin: angle.sin(), cos: angle.cos() };
        let mut rotation = Rotation::identity(graph);
        rotation.push(step);
        rotation
    }

    /// A rotation given by its matrix, whose columns are the child's axes in the parent's frame.
    pub fn from_matrix(m: Mat3<'g>) -> Rotation<'g> {
        let mut rotation = Rotation::identity(m.0[0][0].graph());
        rotation.push(Step::Matrix(m));
        rotation
    }

    /// A rotation by `angle` about the unit vector `n` (Rodrigues's formula).
    pub fn eigenaxis(n: Vec3<'g>, angle: Expr<'g>) -> Rotation<'g> {
        for k in 0..3 {
            let others_zero = n[(k + 1) % 3].is_zero() && n[(k + 2) % 3].is_zero();
            match n[k].value() {
                Some(1.0) if others_zero => return Rotation::about_axis(k, angle),
                Some(-1.0) if others_zero => return Rotation::about_axis(k, -angle),
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

    /// The rotation of a unit quaternion x y z w.
    pub fn quaternion(q: [Expr<'g>; 4]) -> Rotation<'g> {
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

    /// This rotation, then `next` in the rotated frame.
    pub fn then(mut self, next: &Rotation<'g>) -> Rotation<'g> {
        for step in &next.steps {
            self.push(*step);
        }
        self
    }

    /// The inverse rotation.
    pub fn inverse(&self) -> Rotation<'g> {
        let steps = self.steps.iter().rev().map(|s| s.inverse()).collect();
        Rotation { steps, graph: self.graph }
    }

    /// Appends a step; constant neighbours become one matrix, and the unit matrix none.
    fn push(&mut self, step: Step<'g>) {
        let Some(constant) = step.constant() else {
            self.steps.push(step);
            return;
        };
        let mut product = constant;
        if let Some(last) = self.steps.last().and_then(Step::constant) {
            product = last * product;
            self.steps.pop();
        }
        if product != Mat3::identity(self.graph) {
            self.steps.push(Step::Matrix(product));
        }
    }

    /// True if it is known not to rotate.
    pub fn is_identity(&self) -> bool {
        self.steps.is_empty()
    }

    /// Components in the parent's frame of a vector given in the child's.
    pub fn to_parent(&self, v: Vec3<'g>) -> Vec3<'g> {
        self.steps.iter().rev().fold(v, |v, step| step.apply(v))
    }

    /// Components in the child's frame of a vector given in the parent's.
    pub fn to_child(&self, v: Vec3<'g>) -> Vec3<'g> {
        self.steps.iter().fold(v, |v, step| step.inverse().apply(v))
    }

    /// `R X Rᵀ`: a symmetric tensor of the child's frame in the parent's.
    pub fn sym_to_parent(&self, x: Sym3<'g>) -> Sym3<'g> {
        self.steps.iter().rev().fold(x, |x, step| step.apply_sym(x))
    }

    /// `R X Rᵀ`: a tensor of the child's frame in the parent's.
    pub fn mat_to_parent(&self, x: Mat3<'g>) -> Mat3<'g> {
        self.steps.iter().rev().fold(x, |x, step| step.apply_mat(x))
    }

    /// The whole matrix: columns are the child's axes in the parent's frame.
    pub fn matrix(&self) -> Mat3<'g> {
        let columns: [Vec3<'g>; 3] = std::array::from_fn(|k| self.to_parent(Vec3::axis(self.graph, k)));
        Mat3::from_fn(|i, j| columns[j][i])
    }
}

impl<'g> Step<'g> {
    /// The matrix, if every entry is a number.
    fn constant(&self) -> Option<Mat3<'g>> {
        let matrix = self.matrix();
        matrix.values().map(|_| matrix)
    }

    fn matrix(&self) -> Mat3<'g> {
        match *self {
            Step::Matrix(m) => m,
            Step::Axis { axis, sin, cos } => {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut m = Mat3::zero(sin.graph()).0;
                m[axis][axis] = sin.num(1.0);
                (m[i][i], m[i][j], m[j][i], m[j][j]) = (cos, -sin, sin, cos);
                Mat3(m)
            }
        }
    }

    fn inverse(&self) -> Step<'g> {
        match *self {
            Step::Matrix(m) => Step::Matrix(m.transpose()),
            Step::Axis { axis, sin, cos } => Step::Axis { axis, sin: -sin, cos },
        }
    }

    fn apply(&self, v: Vec3<'g>) -> Vec3<'g> {
        match *self {
            Step::Matrix(m) => m * v,
            Step::Axis { axis, sin, cos } => {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut out = v.0;
                out[i] = cos * v[i] - sin * v[j];
                out[j] = sin * v[i] + cos * v[j];
                Vec3(out)
            }
        }
    }

    fn apply_mat(&self, x: Mat3<'g>) -> Mat3<'g> {
        match *self {
            Step::Matrix(m) => m * x * m.transpose(),
            Step::Axis { axis: k, sin, cos } => {
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

    fn apply_sym(&self, x: Sym3<'g>) -> Sym3<'g> {
        match self {
            Step::Matrix(m) => {
                let half = *m * x.full();
                let upper =
                    Mat3::from_fn(|i, j| if i <= j { half.row(i).dot(m.row(j)) } else { m.0[0][0].zero() });
                Sym3::from_upper(&upper)
            }
            Step::Axis { .. } => Sym3::from_upper(&self.apply_mat(x.full())),
        }
    }
}
