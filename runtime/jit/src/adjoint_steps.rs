//! Adjoint steps: derivatives with respect to the state before a step from derivatives with respect to the
//! state after it.

use crate::adjoint::VectorJacobian;
use crate::error::Error;
use crate::robot::Robot;
use crate::steps::{STAGES, Stepper, integrate_derivatives, tangent_rate_derivatives};
use linkwork_compiler::mechanism::{Chart, InQ, InV};
use nalgebra::{DMatrix, Quaternion, UnitQuaternion, Vector3};

/// Adjoint steps of the classical Runge–Kutta method. They propagate derivatives of a function of a motion,
/// with respect to state, inputs and parameters, from the end of the motion to its start.
#[derive(Debug)]
pub struct AdjointStepper {
    stepper: Stepper,
    dynamics: VectorJacobianWithResults,
    forces: Option<VectorJacobianWithResults>,
}

/// Vector–Jacobian product of a function, with storage for its results.
#[derive(Debug)]
struct VectorJacobianWithResults {
    product: VectorJacobian,
    /// Names and lengths of the function's arguments.
    arguments: Vec<(&'static str, usize)>,
    found: Vec<f64>,
}

impl VectorJacobianWithResults {
    fn new(robot: &Robot, name: &str) -> Result<VectorJacobianWithResults, Error> {
        let function = robot.function(name)?;
        let product = function.vector_jacobian()?;
        let found = vec![0.0; product.length()];
        Ok(VectorJacobianWithResults { product, arguments: function.arguments(), found })
    }

    /// Evaluates the derivatives; arguments are passed by name, and those without a value are empty.
    fn evaluate_adjoint_derivatives(
        &mut self,
        robot: &Robot,
        known: &[(&str, &[f64])],
        factors: &[f64],
    ) -> Result<(), Error> {
        let argument_values =
            |name: &str| known.iter().find(|(own, _)| *own == name).map_or(&[][..], |(_, list)| list);
        let arguments: Vec<&[f64]> = self.arguments.iter().map(|(name, _)| argument_values(name)).collect();
        self.product.evaluate_into(robot, &arguments, factors, &mut self.found)
    }

    /// Adds the derivatives with respect to the argument `name`, or with respect to the parameters, to a
    /// list.
    fn add(&self, name: &str, to: &mut [f64]) {
        let mut first = 0;
        for (own, length) in &self.arguments {
            if *own == name {
                add(to, &self.found[first..first + length]);
            }
            first += length;
        }
        if name == PARAMETERS {
            add(to, &self.found[first..]);
        }
    }
}

const PARAMETERS: &str = "parameters";

fn add(to: &mut [f64], terms: &[f64]) {
    to.iter_mut().zip(terms).for_each(|(to, term)| *to += term);
}

/// Derivatives of a scalar function of a motion with respect to state, inputs and parameters.
#[derive(Debug)]
pub struct Sensitivity<'a> {
    /// Derivatives with respect to the configuration, `nq` entries. An adjoint step replaces those after the
    /// step by those before it.
    pub q: &'a mut [f64],
    /// Derivatives with respect to the velocity, `nv` entries. An adjoint step replaces those after the step
    /// by those before it.
    pub v: &'a mut [f64],
    /// Derivatives with respect to the inputs during the step, `nu` entries, to which an adjoint step adds
    /// its contribution.
    pub u: &'a mut [f64],
    /// Derivatives with respect to the parameters, one entry each, to which an adjoint step adds its
    /// contribution.
    pub parameters: &'a mut [f64],
}

impl AdjointStepper {
    /// Returns a computation of adjoint steps for a robot with the present values of its parameters.
    ///
    /// # Errors
    ///
    /// As [`Stepper::new`]; the mechanism has generalized speeds, or its dynamics have no vector–Jacobian
    /// product.
    pub fn new(robot: &Robot) -> Result<AdjointStepper, Error> {
        let stepper = Stepper::new(robot)?;
        if robot.shared.has_speeds {
            let reason = "steps in generalized speeds have no adjoint steps";
            return Err(Error::Value(format!("`{}`: {reason}", robot.name())));
        }
        let forces = match robot.nu() {
            0 => None,
            _ => Some(VectorJacobianWithResults::new(robot, "generalized_forces")?),
        };
        Ok(AdjointStepper {
            stepper,
            dynamics: VectorJacobianWithResults::new(robot, "forward_dynamics")?,
            forces,
        })
    }

    /// Returns the robot of the adjoint steps, whose parameters may be changed.
    pub fn robot_mut(&mut self) -> &mut Robot {
        self.stepper.robot_mut()
    }

    /// Replaces the derivatives with respect to the state after a step by derivatives with respect to the
    /// state before it, and adds those with respect to inputs and parameters. The arguments are those of
    /// [`Stepper::step`]. Returns the derivatives with respect to the time at the start and to the length of
    /// the step.
    ///
    /// # Errors
    ///
    /// A slice has the wrong length.
    pub fn step(
        &mut self,
        t: f64,
        start: [&[f64]; 3],
        h: f64,
        derivatives: &mut Sensitivity<'_>,
    ) -> Result<[f64; 2], Error> {
        let [q, v, u] = start;
        self.stepper.evaluate_step(t, start, h)?;
        let robot = self.stepper.robot.clone();
        robot.check_length("derivatives by q", q.len(), derivatives.q.len())?;
        robot.check_length("derivatives by v", v.len(), derivatives.v.len())?;
        robot.check_length("derivatives by u", u.len(), derivatives.u.len())?;
        robot.check_length(
            "derivatives by parameters",
            robot.parameters().len(),
            derivatives.parameters.len(),
        )?;
        let charts = &robot.shared.charts;
        let n = v.len();
        let mut by_q = vec![0.0; q.len()];
        let mut by_displacement = vec![0.0; n];
        add_integration_gradients(
            charts,
            q,
            self.stepper.last_displacement(),
            derivatives.q,
            &mut by_q,
            &mut by_displacement,
        );
        let after_v = derivatives.v.to_vec();
        let mut by_v = after_v.clone();
        let weighted =
            |list: &[f64], weight: f64| -> Vec<f64> { list.iter().map(|x| h / 6.0 * weight * x).collect() };
        let dot_product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        // Displacement and change of the velocity are the length of the step times mean rates.
        let (mut by_t, mut by_h) = (0.0, 0.0);
        for (stage, (_, weight)) in self.stepper.stages.iter().zip(STAGES) {
            let change =
                dot_product(&by_displacement, &stage.rate) + dot_product(&after_v, &stage.acceleration);
            by_h += weight / 6.0 * change;
        }
        let mut rates: Vec<Vec<f64>> = STAGES.iter().map(|(_, w)| weighted(&by_displacement, *w)).collect();
        let mut accelerations: Vec<Vec<f64>> = STAGES.iter().map(|(_, w)| weighted(&after_v, *w)).collect();
        for i in (0..STAGES.len()).rev() {
            let stage = &self.stepper.stages[i];
            let c = h * STAGES[i].0;
            let time = [t + c];
            let known = [("t", &time[..]), ("q", &stage.q), ("v", &stage.v), ("tau", &stage.tau), ("u", u)];
            let (mut stage_q, mut stage_v, mut tau) = (vec![0.0; q.len()], vec![0.0; n], vec![0.0; n]);
            let mut by_time = [0.0];
            self.dynamics.evaluate_adjoint_derivatives(&robot, &known, &accelerations[i])?;
            self.dynamics.add("q", &mut stage_q);
            self.dynamics.add("v", &mut stage_v);
            self.dynamics.add("tau", &mut tau);
            self.dynamics.add("t", &mut by_time);
            self.dynamics.add(PARAMETERS, derivatives.parameters);
            if let Some(forces) = &mut self.forces {
                forces.evaluate_adjoint_derivatives(&robot, &known, &tau)?;
                forces.add("q", &mut stage_q);
                forces.add("v", &mut stage_v);
                forces.add("u", derivatives.u);
                forces.add("t", &mut by_time);
                forces.add(PARAMETERS, derivatives.parameters);
            }
            by_t += by_time[0];
            by_h += STAGES[i].0 * by_time[0];
            if i == 0 {
                add(&mut by_q, &stage_q);
                add(&mut by_v, &stage_v);
                add(&mut by_v, &rates[0]);
                continue;
            }
            let mut displacement = vec![0.0; n];
            let [by_dv, by_own] = tangent_rate_derivatives(charts, &stage.displacement, &stage.v);
            add_transposed_product(&by_dv, &rates[i], &mut displacement);
            add_transposed_product(&by_own, &rates[i], &mut stage_v);
            add_integration_gradients(charts, q, &stage.displacement, &stage_q, &mut by_q, &mut displacement);
            add(&mut by_v, &stage_v);
            let before = &self.stepper.stages[i - 1];
            by_h += STAGES[i].0
                * (dot_product(&displacement, &before.rate) + dot_product(&stage_v, &before.acceleration));
            for k in 0..n {
                rates[i - 1][k] += c * displacement[k];
                accelerations[i - 1][k] += c * stage_v[k];
            }
        }
        derivatives.q.copy_from_slice(&by_q);
        derivatives.v.copy_from_slice(&by_v);
        Ok([by_t, by_h])
    }
}

/// Adds the product of the transposed matrix with the vector `factors` to a list.
fn add_transposed_product(matrix: &DMatrix<f64>, factors: &[f64], to: &mut [f64]) {
    for (j, to) in to.iter_mut().enumerate() {
        *to += matrix.column(j).iter().zip(factors).map(|(a, b)| a * b).sum::<f64>();
    }
}

fn quaternion_from_list(list: &[f64]) -> Quaternion<f64> {
    Quaternion::new(list[3], list[0], list[1], list[2])
}

/// Adds to two lists the gradients, with respect to the entries of `q` and to `dv`, of a weighted sum of the
/// entries of `integrate(q, dv)`.
pub(crate) fn add_integration_gradients(
    charts: &[Chart],
    q: &[f64],
    dv: &[f64],
    factors: &[f64],
    by_q: &mut [f64],
    by_dv: &mut [f64],
) {
    let mut end = vec![0.0; q.len()];
    crate::configuration_space::integrate(charts, q, dv, &mut end);
    // Factors of displacements of the result.
    let mut tangent = vec![0.0; dv.len()];
    for chart in charts {
        match *chart {
            Chart::Plain(InQ(q0), InV(v0)) => tangent[v0] = factors[q0],
            Chart::Ball(InQ(q0), InV(v0)) => {
                write_rotation_gradient(&end[q0..], &factors[q0..], &mut tangent[v0..])
            }
            Chart::Free(InQ(q0), InV(v0)) => {
                let rotation = UnitQuaternion::from_quaternion(quaternion_from_list(&end[q0 + 3..]));
                let force = rotation.inverse() * Vector3::from_column_slice(&factors[q0..q0 + 3]);
                tangent[v0..v0 + 3].copy_from_slice(force.as_slice());
                write_rotation_gradient(&end[q0 + 3..], &factors[q0 + 3..], &mut tangent[v0 + 3..]);
            }
        }
    }
    let [at_q, at_dv] = integrate_derivatives(charts, dv);
    add_transposed_product(&at_dv, &tangent, by_dv);
    let mut displacement = vec![0.0; dv.len()];
    add_transposed_product(&at_q, &tangent, &mut displacement);
    add_configuration_gradient(charts, q, &displacement, by_q);
}

/// Converts a gradient with respect to displacements of a configuration to one with respect to its entries,
/// and adds that to `by_q`.
fn add_configuration_gradient(charts: &[Chart], q: &[f64], displacement: &[f64], by_q: &mut [f64]) {
    for chart in charts {
        match *chart {
            Chart::Plain(InQ(q0), InV(v0)) => by_q[q0] += displacement[v0],
            Chart::Ball(InQ(q0), InV(v0)) => {
                add_quaternion_gradient(&q[q0..], &displacement[v0..], &mut by_q[q0..]);
            }
            Chart::Free(InQ(q0), InV(v0)) => {
                let rotation = UnitQuaternion::from_quaternion(quaternion_from_list(&q[q0 + 3..]));
                let force = rotation * Vector3::from_column_slice(&displacement[v0..v0 + 3]);
                add(&mut by_q[q0..q0 + 3], force.as_slice());
                add_quaternion_gradient(&q[q0 + 3..], &displacement[v0 + 3..], &mut by_q[q0 + 3..]);
            }
        }
    }
}

/// Adds to two lists the gradients, with respect to `from` and `to`, of a weighted sum of the entries of
/// `difference(from, to)`.
pub(crate) fn add_difference_gradients(
    charts: &[Chart],
    [from, to]: [&[f64]; 2],
    factors: &[f64],
    [by_from, by_to]: [&mut [f64]; 2],
) {
    let n = factors.len();
    let mut dv = vec![0.0; n];
    crate::configuration_space::difference(charts, from, to, &mut dv);
    // The rate of `dv` is the inverse of the derivative of `integrate` by `dv`, times the velocity.
    let [_, inverse] = tangent_rate_derivatives(charts, &dv, &vec![0.0; n]);
    let [by_q, _] = integrate_derivatives(charts, &dv);
    let mut at_end = vec![0.0; n];
    add_transposed_product(&inverse, factors, &mut at_end);
    add_configuration_gradient(charts, to, &at_end, by_to);
    let mut at_start = vec![0.0; n];
    add_transposed_product(&by_q, &at_end, &mut at_start);
    at_start.iter_mut().for_each(|x| *x = -*x);
    add_configuration_gradient(charts, from, &at_start, by_from);
}

/// Adds to two lists the gradients, with respect to `dv` and `v`, of a weighted sum of the entries of
/// `tangent_rate(dv, v)`.
pub(crate) fn add_tangent_rate_gradients(
    charts: &[Chart],
    [dv, v]: [&[f64]; 2],
    factors: &[f64],
    [by_dv, by_v]: [&mut [f64]; 2],
) {
    let [at_dv, at_v] = tangent_rate_derivatives(charts, dv, v);
    add_transposed_product(&at_dv, factors, by_dv);
    add_transposed_product(&at_v, factors, by_v);
}

/// Writes the gradient with respect to a rotation in body axes, given the gradient with respect to the
/// entries of a unit quaternion, whose rate is half the product of the quaternion with the angular velocity.
fn write_rotation_gradient(q: &[f64], factors: &[f64], to: &mut [f64]) {
    let product = quaternion_from_list(q).conjugate() * quaternion_from_list(factors);
    to[..3].copy_from_slice(&[0.5 * product.i, 0.5 * product.j, 0.5 * product.k]);
}

/// Converts a gradient with respect to a rotation vector to one with respect to the entries of a quaternion
/// of any norm, and adds that to a list.
fn add_quaternion_gradient(q: &[f64], factors: &[f64], to: &mut [f64]) {
    let q = quaternion_from_list(q);
    let product = q * Quaternion::new(0.0, factors[0], factors[1], factors[2]) * (2.0 / q.norm_squared());
    add(&mut to[..4], &[product.i, product.j, product.k, product.w]);
}
