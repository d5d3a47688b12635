//! Steps of the classical Runge–Kutta method with their Jacobians, for mechanisms without constraints and
//! contacts.

use crate::error::Error;
use crate::robot::{Robot, State};
use linkwork::__private::{
    ball_integrate_derivatives, ball_tangent_rate_derivatives, free_integrate_derivatives,
    free_tangent_rate_derivatives,
};
use linkwork_compiler::mechanism::{Chart, InV};
use nalgebra::DMatrix;

/// Coefficients of the stages of the classical Runge–Kutta method: fraction of the step at which a stage is
/// evaluated, and weight of its derivatives.
pub(crate) const STAGES: [(f64, f64); 4] = [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)];

/// Steps of the classical Runge–Kutta method of one robot, with inputs that are constant during a step.
///
/// ```
/// use linkwork_jit::{Stepper, declare};
///
/// # fn main() -> Result<(), linkwork_jit::Error> {
/// let pendulum = declare(
///     "#[mechanism(gravity = -9.81 * y)]
///     struct Pendulum {
///         #[body(mass = 2, com = -0.5 * y, inertia = rod(2, 1, y))]
///         rod: Body,
///         #[joint(ground -> rod, about = z)]
///         hinge: Pin,
///     }",
/// )?;
/// let mut stepper = Stepper::new(&pendulum)?;
/// let (mut q, mut v) = ([0.01], [0.0]);
/// for _ in 0..1000 {
///     let (mut next_q, mut next_v) = ([0.0], [0.0]);
///     stepper.step(0.0, [&q, &v, &[]], 1e-3, [&mut next_q, &mut next_v])?;
///     (q, v) = (next_q, next_v);
/// }
/// let frequency = (1.5_f64 * 9.81).sqrt();
/// assert!((q[0] - 0.01 * frequency.cos()).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Stepper {
    pub(crate) robot: Robot,
    pub(crate) functions: Functions,
    pub(crate) stages: [RungeKuttaStage; 4],
    displacement: Vec<f64>,
}

/// Indices of the functions that a step calls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Functions {
    pub dynamics: usize,
    /// Index of the function that computes generalized forces from inputs; `None` without inputs.
    pub forces: Option<usize>,
    integrate: usize,
    rate: usize,
    linearize: Option<usize>,
}

/// State at which a stage of a Runge–Kutta step is evaluated, with its time derivatives.
#[derive(Clone, Debug, Default)]
pub(crate) struct RungeKuttaStage {
    pub displacement: Vec<f64>,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub tau: Vec<f64>,
    pub rate: Vec<f64>,
    pub acceleration: Vec<f64>,
}

/// Jacobian matrices of a Runge–Kutta step with respect to configuration displacements, velocities and inputs
/// at its start.
#[derive(Clone, Debug, PartialEq)]
pub struct Jacobians {
    /// Derivatives of the displacement of the configuration at the end of the step with respect to
    /// configuration, velocity and inputs.
    pub q: [DMatrix<f64>; 3],
    /// Derivatives of the velocity at the end of the step with respect to configuration, velocity and inputs.
    pub v: [DMatrix<f64>; 3],
}

impl Stepper {
    /// Returns a computation of steps for a robot with the present values of its parameters.
    ///
    /// # Errors
    ///
    /// The robot has constraints, contacts, states of first order or no dynamics, or a parameter has no
    /// value.
    pub fn new(robot: &Robot) -> Result<Stepper, Error> {
        if let Some(reason) = robot.shared.step_obstacle() {
            return Err(Error::Value(format!("`{}` has no steps: {reason}", robot.name())));
        }
        robot.check_no_values_missing()?;
        let function_index = |name: &str| robot.shared.index.get(name).copied();
        let required_function_index = |name: &str| {
            function_index(name)
                .ok_or_else(|| Error::unknown_name_error("function", name, robot.shared.names()))
        };
        let functions = Functions {
            dynamics: required_function_index("forward_dynamics")?,
            forces: if robot.nu() > 0 { Some(required_function_index("generalized_forces")?) } else { None },
            integrate: required_function_index("integrate")?,
            rate: function_index("tangent_rate")
                .map_or_else(|| required_function_index("displacement_rate"), Ok)?,
            linearize: function_index("linearize"),
        };
        let (nq, nv) = (robot.nq(), robot.nv());
        let zero_vector = |n: usize| vec![0.0; n];
        let stage = RungeKuttaStage {
            displacement: zero_vector(nv),
            q: zero_vector(nq),
            v: zero_vector(nv),
            tau: zero_vector(nv),
            rate: zero_vector(nv),
            acceleration: zero_vector(nv),
        };
        let stages = [stage.clone(), stage.clone(), stage.clone(), stage];
        Ok(Stepper { robot: robot.clone(), functions, stages, displacement: zero_vector(nv) })
    }

    /// Returns the robot of the stepper, whose parameters may be changed.
    pub fn robot_mut(&mut self) -> &mut Robot {
        &mut self.robot
    }

    /// Writes configuration and velocity after a step of `h` seconds. The start consists of the time `t`, and
    /// of configuration, velocity and inputs.
    ///
    /// # Errors
    ///
    /// A slice has the wrong length, or the motion does not remain finite.
    pub fn step(
        &mut self,
        t: f64,
        start: [&[f64]; 3],
        h: f64,
        [q_end, v_end]: [&mut [f64]; 2],
    ) -> Result<(), Error> {
        self.evaluate_step(t, start, h)?;
        let [q, v, _] = start;
        self.robot.check_length("v", v.len(), v_end.len())?;
        for k in 0..v.len() {
            let change: f64 = self.stages.iter().zip(STAGES).map(|(s, (_, w))| w * s.acceleration[k]).sum();
            v_end[k] = v[k] + h / 6.0 * change;
        }
        let state = State { q, other: &[&self.displacement], ..State::default() };
        self.robot.call_with_state_into(self.functions.integrate, state, q_end)?;
        match q_end.iter().chain(&*v_end).all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err(Error::Value("the motion does not remain finite".to_string())),
        }
    }

    /// Evaluates the stages of a step, and the displacement of the configuration over the step.
    pub(crate) fn evaluate_step(&mut self, t: f64, [q, v, u]: [&[f64]; 3], h: f64) -> Result<(), Error> {
        let (robot, functions) = (&mut self.robot, self.functions);
        robot.check_length("q", robot.nq(), q.len())?;
        robot.check_length("v", robot.nv(), v.len())?;
        robot.check_length("u", robot.nu(), u.len())?;
        for i in 0..STAGES.len() {
            let (before, rest) = self.stages.split_at_mut(i);
            let stage = &mut rest[0];
            let c = h * STAGES[i].0;
            match before.last() {
                None => {
                    stage.displacement.fill(0.0);
                    stage.q.copy_from_slice(q);
                    stage.v.copy_from_slice(v);
                    stage.rate.copy_from_slice(v);
                }
                Some(last) => {
                    for k in 0..v.len() {
                        stage.displacement[k] = c * last.rate[k];
                        stage.v[k] = v[k] + c * last.acceleration[k];
                    }
                    let dv = &stage.displacement;
                    let state = State { q, v: &stage.v, other: &[dv], ..State::default() };
                    robot.call_with_state_into(functions.integrate, state, &mut stage.q)?;
                    robot.call_with_state_into(functions.rate, state, &mut stage.rate)?;
                }
            }
            robot.set_time(t + c);
            if let Some(forces) = functions.forces {
                let state = State { q: &stage.q, v: &stage.v, u, ..State::default() };
                robot.call_with_state_into(forces, state, &mut stage.tau)?;
            }
            let state = State { q: &stage.q, v: &stage.v, tau: &stage.tau, ..State::default() };
            robot.call_with_state_into(functions.dynamics, state, &mut stage.acceleration)?;
        }
        for k in 0..v.len() {
            let rate: f64 = self.stages.iter().zip(STAGES).map(|(s, (_, w))| w * s.rate[k]).sum();
            self.displacement[k] = h / 6.0 * rate;
        }
        Ok(())
    }

    /// Returns the displacement of the configuration in the last step.
    pub(crate) fn last_displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// Writes configuration and velocity after a step, and returns its Jacobian matrices (option
    /// `derivatives`).
    ///
    /// # Errors
    ///
    /// As [`step`](Self::step); the mechanism has generalized speeds, or lacks `linearize`.
    pub fn differentiate(
        &mut self,
        t: f64,
        start: [&[f64]; 3],
        h: f64,
        end: [&mut [f64]; 2],
    ) -> Result<Jacobians, Error> {
        let linearize = self.functions.linearize;
        let names = self.robot.shared.names();
        let linearize = linearize.ok_or_else(|| Error::unknown_name_error("function", "linearize", names))?;
        if self.robot.shared.has_speeds {
            let name = self.robot.name();
            let reason = "steps in generalized speeds have no Jacobians";
            return Err(Error::Value(format!("`{name}`: {reason}")));
        }
        self.step(t, start, h, end)?;
        let u = start[2];
        let (n, m) = (self.robot.nv(), self.robot.nu());
        let charts = self.robot.shared.charts.clone();
        let mut system = vec![0.0; 4 * n * n + 2 * n * m];
        let mut stages: Vec<[TangentVectorDerivatives; 2]> = Vec::with_capacity(STAGES.len());
        for (i, (fraction, _)) in STAGES.into_iter().enumerate() {
            let stage = &self.stages[i];
            let c = h * fraction;
            let (displacement, v) = match stages.last() {
                None => (
                    TangentVectorDerivatives::initial_displacement_derivatives(n, m),
                    TangentVectorDerivatives::initial_velocity_derivatives(n, m),
                ),
                Some([rate, acceleration]) => (
                    rate.scaled_derivatives(c),
                    TangentVectorDerivatives::initial_velocity_derivatives(n, m).plus_scaled(c, acceleration),
                ),
            };
            let rate = match i {
                0 => v.clone(),
                _ => {
                    let [by_dv, by_v] = tangent_rate_derivatives(&charts, &stage.displacement, &stage.v);
                    displacement.multiplied_by_matrix(&by_dv).plus_scaled(1.0, &v.multiplied_by_matrix(&by_v))
                }
            };
            let motion = match i {
                0 => displacement,
                _ => end_configuration_derivatives(&charts, &stage.displacement, &displacement),
            };
            self.robot.set_time(t + c);
            let state = State { q: &stage.q, v: &stage.v, u, ..State::default() };
            self.robot.call_with_state_into(linearize, state, &mut system)?;
            let acceleration_jacobian_entry = |i: usize, j: usize| system[2 * n * j + n + i];
            let by_q = DMatrix::from_fn(n, n, acceleration_jacobian_entry);
            let by_v = DMatrix::from_fn(n, n, |i, j| acceleration_jacobian_entry(i, n + j));
            let mut acceleration =
                motion.multiplied_by_matrix(&by_q).plus_scaled(1.0, &v.multiplied_by_matrix(&by_v));
            acceleration.by_u += DMatrix::from_fn(n, m, |i, j| acceleration_jacobian_entry(i, 2 * n + j));
            stages.push([rate, acceleration]);
        }
        let weighted_sum_of_stages = |which: usize| {
            let mut all = TangentVectorDerivatives::zero(n, m);
            for (stage, (_, weight)) in stages.iter().zip(STAGES) {
                all = all.plus_scaled(h / 6.0 * weight, &stage[which]);
            }
            all
        };
        let motion = end_configuration_derivatives(&charts, &self.displacement, &weighted_sum_of_stages(0));
        let v = TangentVectorDerivatives::initial_velocity_derivatives(n, m)
            .plus_scaled(1.0, &weighted_sum_of_stages(1));
        Ok(Jacobians { q: [motion.by_q, motion.by_v, motion.by_u], v: [v.by_q, v.by_v, v.by_u] })
    }
}

/// Derivatives of a tangent vector with respect to configuration, velocity and inputs at the start of a step.
#[derive(Clone)]
struct TangentVectorDerivatives {
    by_q: DMatrix<f64>,
    by_v: DMatrix<f64>,
    by_u: DMatrix<f64>,
}

impl TangentVectorDerivatives {
    fn zero(n: usize, m: usize) -> TangentVectorDerivatives {
        TangentVectorDerivatives {
            by_q: DMatrix::zeros(n, n),
            by_v: DMatrix::zeros(n, n),
            by_u: DMatrix::zeros(n, m),
        }
    }

    /// Returns the derivatives of the velocity at the start of the step: the identity with respect to itself,
    /// otherwise zero.
    fn initial_velocity_derivatives(n: usize, m: usize) -> TangentVectorDerivatives {
        TangentVectorDerivatives { by_v: DMatrix::identity(n, n), ..TangentVectorDerivatives::zero(n, m) }
    }

    /// Returns the derivatives of a zero displacement, which moves with the configuration at the start.
    fn initial_displacement_derivatives(n: usize, m: usize) -> TangentVectorDerivatives {
        TangentVectorDerivatives { by_q: DMatrix::identity(n, n), ..TangentVectorDerivatives::zero(n, m) }
    }

    fn plus_scaled(&self, s: f64, other: &TangentVectorDerivatives) -> TangentVectorDerivatives {
        TangentVectorDerivatives {
            by_q: &self.by_q + &other.by_q * s,
            by_v: &self.by_v + &other.by_v * s,
            by_u: &self.by_u + &other.by_u * s,
        }
    }

    fn scaled_derivatives(&self, s: f64) -> TangentVectorDerivatives {
        TangentVectorDerivatives { by_q: &self.by_q * s, by_v: &self.by_v * s, by_u: &self.by_u * s }
    }

    /// Returns the products of the matrix `by` with the derivatives.
    fn multiplied_by_matrix(&self, by: &DMatrix<f64>) -> TangentVectorDerivatives {
        TangentVectorDerivatives { by_q: by * &self.by_q, by_v: by * &self.by_v, by_u: by * &self.by_u }
    }
}

/// Returns the derivatives of the configuration that a displacement from the start leads to.
fn end_configuration_derivatives(
    charts: &[Chart],
    displacement: &[f64],
    derivatives: &TangentVectorDerivatives,
) -> TangentVectorDerivatives {
    let [by_q, by_dv] = integrate_derivatives(charts, displacement);
    let mut motion = derivatives.multiplied_by_matrix(&by_dv);
    motion.by_q += by_q;
    motion
}

fn array_from_list<const N: usize>(list: &[f64], first: usize) -> [f64; N] {
    std::array::from_fn(|k| list[first + k])
}

/// Writes a square block, given as a list of columns, to the diagonal of a matrix, from row `first` on.
fn place_diagonal_block<const N: usize>(matrix: &mut DMatrix<f64>, first: usize, block: [[f64; N]; N]) {
    for (j, column) in block.into_iter().enumerate() {
        for (i, entry) in column.into_iter().enumerate() {
            matrix[(first + i, first + j)] = entry;
        }
    }
}

/// Returns the derivatives of `integrate(q, dv)` with respect to displacements of `q` and to `dv`, for
/// velocities that are joint velocities.
pub(crate) fn integrate_derivatives(charts: &[Chart], dv: &[f64]) -> [DMatrix<f64>; 2] {
    let n = dv.len();
    let (mut by_q, mut by_dv) = (DMatrix::identity(n, n), DMatrix::identity(n, n));
    for chart in charts {
        match *chart {
            Chart::Plain(..) => {}
            Chart::Ball(_, InV(v)) => {
                let (q, d) = ball_integrate_derivatives::<f64>(array_from_list(dv, v));
                place_diagonal_block(&mut by_q, v, q);
                place_diagonal_block(&mut by_dv, v, d);
            }
            Chart::Free(_, InV(v)) => {
                let (q, d) = free_integrate_derivatives::<f64>(array_from_list(dv, v));
                place_diagonal_block(&mut by_q, v, q);
                place_diagonal_block(&mut by_dv, v, d);
            }
        }
    }
    [by_q, by_dv]
}

/// Returns the derivatives of `tangent_rate(dv, v)` with respect to `dv` and to `v`.
pub(crate) fn tangent_rate_derivatives(charts: &[Chart], dv: &[f64], v: &[f64]) -> [DMatrix<f64>; 2] {
    let n = dv.len();
    let (mut by_dv, mut by_v) = (DMatrix::zeros(n, n), DMatrix::identity(n, n));
    for chart in charts {
        match *chart {
            Chart::Plain(..) => {}
            Chart::Ball(_, InV(at)) => {
                let (d, w) =
                    ball_tangent_rate_derivatives::<f64>(array_from_list(dv, at), array_from_list(v, at));
                place_diagonal_block(&mut by_dv, at, d);
                place_diagonal_block(&mut by_v, at, w);
            }
            Chart::Free(_, InV(at)) => {
                let (d, w) =
                    free_tangent_rate_derivatives::<f64>(array_from_list(dv, at), array_from_list(v, at));
                place_diagonal_block(&mut by_dv, at, d);
                place_diagonal_block(&mut by_v, at, w);
            }
        }
    }
    [by_dv, by_v]
}

impl Robot {
    /// Returns the derivatives of [`integrate`](Self::integrate) with respect to displacements of `q` and to
    /// `dv`.
    ///
    /// # Errors
    ///
    /// The slice has the wrong length, or the mechanism has generalized speeds.
    pub fn integrate_derivatives(&self, dv: &[f64]) -> Result<[DMatrix<f64>; 2], Error> {
        self.check_joint_velocity_argument(dv)?;
        Ok(integrate_derivatives(&self.shared.charts, dv))
    }

    /// Returns the derivatives of [`tangent_rate`](Self::tangent_rate) with respect to `dv` and to `v`.
    ///
    /// # Errors
    ///
    /// A slice has the wrong length, or the mechanism has generalized speeds.
    pub fn tangent_rate_derivatives(&self, dv: &[f64], v: &[f64]) -> Result<[DMatrix<f64>; 2], Error> {
        self.check_joint_velocity_argument(dv)?;
        self.check_joint_velocity_argument(v)?;
        Ok(tangent_rate_derivatives(&self.shared.charts, dv, v))
    }

    fn check_joint_velocity_argument(&self, dv: &[f64]) -> Result<(), Error> {
        if self.shared.has_speeds {
            return Err(Error::Value(format!("the velocities of `{}` are generalized speeds", self.name())));
        }
        self.check_length("dv", self.nv(), dv.len())
    }
}
