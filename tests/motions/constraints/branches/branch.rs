//! Assembly modes of a linkage with singular configurations, as functions of its lengths, and motions on
//! them.

use linkwork::prelude::*;

/// Number with its first and second derivative along a curve, for automatic differentiation.
#[derive(Clone, Copy)]
pub struct Jet(pub [f64; 3]);

impl Jet {
    /// Returns the composition with a function that has this value and these derivatives.
    fn compose_with_function(self, f: [f64; 3]) -> Jet {
        let [_, d, dd] = self.0;
        Jet([f[0], f[1] * d, f[2] * d * d + f[1] * dd])
    }

    fn sin(self) -> Jet {
        let (s, c) = self.0[0].sin_cos();
        self.compose_with_function([s, c, -s])
    }

    fn cos(self) -> Jet {
        let (s, c) = self.0[0].sin_cos();
        self.compose_with_function([c, -s, -c])
    }

    fn times_jet(self, o: Jet) -> Jet {
        let ([a, b, c], [d, e, f]) = (self.0, o.0);
        Jet([a * d, b * d + a * e, c * d + 2.0 * b * e + a * f])
    }

    fn plus_jet(self, o: Jet) -> Jet {
        Jet(core::array::from_fn(|k| self.0[k] + o.0[k]))
    }

    fn scaled_jet(self, by: f64) -> Jet {
        Jet(self.0.map(|x| x * by))
    }

    fn plus_number(self, x: f64) -> Jet {
        self.plus_jet(Jet([x, 0.0, 0.0]))
    }

    fn square_root(self) -> Jet {
        let x = self.0[0].sqrt();
        self.compose_with_function([x, 0.5 / x, -0.25 / (x * x * x)])
    }

    fn reciprocal(self) -> Jet {
        let x = 1.0 / self.0[0];
        self.compose_with_function([x, -x * x, 2.0 * x * x * x])
    }

    fn atan2(y: Jet, x: Jet) -> Jet {
        // The derivative is (x y' − y x') / (x² + y²), in jets of one order less.
        let ([y0, y1, y2], [x0, x1, x2]) = (y.0, x.0);
        let square = x0 * x0 + y0 * y0;
        let first = (x0 * y1 - y0 * x1) / square;
        let second = (x0 * y2 - y0 * x2) / square - first * 2.0 * (x0 * x1 + y0 * y1) / square;
        Jet([y0.atan2(x0), first, second])
    }
}

/// Returns the angles of crank, coupler (relative to the crank) and rocker of a four-bar linkage as functions
/// of the crank's angle. The linkage is singular at the crank angle `π` (`l1 + base = l2 + l3`) or zero
/// (`±(l1 − base) = l2 − l3`).
///
/// With the distance `D` between the crank's tip and the rocker's foot, the height of the triangle of coupler
/// and rocker over this line is a root of `((l2 + l3)² − D²)(D² − (l2 − l3)²)`. One of the factors is a
/// square: `4 base l1 cos²(θ/2)` or `4 base l1 sin²(θ/2)`. The assembly mode continues smoothly where the
/// root of this square changes sign.
pub fn branch_angles_of_singular_linkage(
    [base, l1, l2, l3]: [f64; 4],
    at_pi: bool,
    theta: f64,
    side: f64,
) -> [Jet; 3] {
    let theta = Jet([theta, 1.0, 0.0]);
    let half = theta.scaled_jet(0.5);
    // Nearly equal lengths are subtracted first: the difference of their squares would lose digits.
    let (apart, versine) = (base - l1, half.sin().times_jet(half.sin()).scaled_jet(2.0));
    let difference = if at_pi { l2 - l3 } else { apart.abs() };
    // Vector from the crank's tip to the rocker's foot.
    let (dx, dy) = (versine.scaled_jet(l1).plus_number(apart), theta.sin().scaled_jet(-l1));
    let square = versine.scaled_jet(2.0 * base * l1).plus_number(apart * apart);
    let width = 2.0 * (base * l1).sqrt();
    let height = match at_pi {
        true => {
            half.cos().scaled_jet(width).times_jet(square.plus_number(-difference * difference).square_root())
        }
        false => half
            .sin()
            .scaled_jet(width)
            .times_jet(square.scaled_jet(-1.0).plus_number((l2 + l3) * (l2 + l3)).square_root()),
    };
    // Twice D times the foot point and the height of the triangle.
    let (along, across) = (square.plus_number(difference * (l2 + l3)), height.scaled_jet(side));
    let over = square.scaled_jet(2.0).reciprocal();
    let tip_coordinate =
        |a: Jet, b: Jet, c: Jet, d: Jet| a.times_jet(b).plus_jet(c.times_jet(d)).times_jet(over);
    let (px, py) =
        (tip_coordinate(along, dx, across.scaled_jet(-1.0), dy), tip_coordinate(along, dy, across, dx));
    let coupler = Jet::atan2(py, px);
    let rocker = Jet::atan2(py.plus_jet(dy.scaled_jet(-1.0)), px.plus_jet(dx.scaled_jet(-1.0)));
    [theta, coupler.plus_jet(theta.scaled_jet(-1.0)), rocker]
}

/// Branch of a linkage's motion: a configuration, the derivatives of all coordinates with respect to the `N`
/// independent ones, and second derivatives along the motion.
pub struct Branch<const NV: usize, const N: usize> {
    pub q: SVector<f64, NV>,
    pub by: SMatrix<f64, NV, N>,
    pub bend: SVector<f64, NV>,
    pub rate: SVector<f64, N>,
}

impl<const NV: usize, const N: usize> Branch<NV, N> {
    pub fn branch_velocity(&self) -> SVector<f64, NV> {
        self.by * self.rate
    }

    /// Returns the acceleration on the assembly mode by Lagrange's equations for the independent coordinates,
    /// and a bound for the rounding error.
    pub fn branch_acceleration<M>(&self, m: &M) -> (SVector<f64, NV>, f64)
    where
        M: Mechanism<NV, NV, 0, Scalar = f64>,
    {
        let (v, mass) = (self.branch_velocity(), m.mass_matrix(0.0, &self.q));
        let bias = m.bias_forces(0.0, &self.q, &v);
        let own = self.by.transpose() * mass * self.by;
        let force = bias + mass * self.bend;
        let solve_reduced_system = |f: SVector<f64, N>| {
            // The system has one or two unknowns.
            let mut x = SVector::<f64, N>::zeros();
            if N == 1 {
                x[0] = f[0] / own[(0, 0)];
            } else {
                let det = own[(0, 0)] * own[(1, 1)] - own[(0, 1)] * own[(1, 0)];
                x[0] = (f[0] * own[(1, 1)] - f[1] * own[(0, 1)]) / det;
                x[1] = (f[1] * own[(0, 0)] - f[0] * own[(1, 0)]) / det;
            }
            x
        };
        let a = self.by * solve_reduced_system(-(self.by.transpose() * force)) + self.bend;
        // Accelerations that each force alone would cause, through the motion of its body, which is known
        // only to 1e-11 m or rad.
        let acceleration_from_single_force = |k: usize| {
            let by = self.by.row(k).map(|by| by.signum() * by.abs().max(1e-2)).transpose();
            (self.by * solve_reduced_system(by * bias[k])).amax()
        };
        let most = (0..NV).map(acceleration_from_single_force).fold(0.0, f64::max);
        // Light bodies with stiff springs would have large accelerations without constraints. The constraint
        // forces have the rounding errors of these accelerations.
        let free = mass.cholesky().map_or(0.0, |mass| mass.solve(&bias).amax());
        (a, most + free * 1e-3)
    }
}
