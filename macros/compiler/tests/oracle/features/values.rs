//! Numeric evaluation of the functions of a compiled mechanism at a state, and of their derivatives.

use crate::random::Random;
use linkwork_compiler::catalogue::CalledFunction;
use linkwork_compiler::derive::{DerivationOutput, Function, PreparedFunctions};
use linkwork_compiler::lower::Program;
use linkwork_compiler::mechanism::{Chart, Model, Quantity, SuppliedQuantity};

/// Step of sixth-order finite differences.
const H: f64 = 4e-3;

/// Values of the symbols that generated functions depend on, one list for each kind of symbol.
#[derive(Clone)]
pub struct Values {
    pub t: f64,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
    pub tau: Vec<f64>,
    pub u: Vec<f64>,
    pub parameters: Vec<f64>,
    /// Values that callers supply as arguments: constraint multipliers, factors and momenta.
    pub given: Vec<f64>,
    pub contact_forces: Vec<f64>,
}

/// Variables with respect to which a function is differentiated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DerivativeVariable {
    Q,
    V,
    A,
    U,
    Parameters,
}

impl Values {
    pub fn random_values(model: &Model<'_>, seed: u64) -> Values {
        let mut random = Random::new(seed ^ 0xfee1);
        let mut list =
            |n: usize, bound: f64| -> Vec<f64> { (0..n).map(|_| random.uniform_number(bound)).collect() };
        let (nq, nv) = (model.nq(), model.nv());
        let mut values = Values {
            t: 0.4,
            q: list(nq, 0.9),
            v: list(nv, 0.8),
            a: list(nv, 1.5),
            tau: list(nv, 2.0),
            u: list(model.inputs.len(), 1.0),
            parameters: list(model.parameters.len(), 0.3).iter().map(|p| 1.2 + p).collect(),
            given: list(4 * (nv + model.constraints.len()) + 50, 0.7),
            contact_forces: list(model.contacts.iter().map(|c| c.rates.len()).sum(), 0.9),
        };
        // Also provides standard inertial parameters: ten for each body.
        values.given.extend(list(10 * model.frames.len(), 0.7));
        for chart in &model.charts {
            if let Some(quaternion) = quaternion_of_chart(*chart, &mut values.q) {
                quaternion[3] += 1.5;
                normalise_quaternion(quaternion);
            }
        }
        values
    }

    /// Returns the results of a generated function. Results of functions that it calls are computed first.
    pub fn run_function(&self, output: &DerivationOutput, function: &Function) -> Vec<f64> {
        self.run_program(output, function, false)
    }

    /// Returns the results of a function's program with SIMD lanes, if there is one.
    pub fn run_lanes(&self, output: &DerivationOutput, function: &Function) -> Option<Vec<f64>> {
        function.program.simd.is_some().then(|| self.run_program(output, function, true))
    }

    fn run_program(&self, output: &DerivationOutput, function: &Function, lanes: bool) -> Vec<f64> {
        let called = CalledFunction::ALL.map(|called| {
            let of = output.functions.iter().find(|f| f.name == called.function_name());
            of.map_or_else(Vec::new, |f| self.run_self_contained_program(&f.program))
        });
        let program = function.program.simd.as_deref().filter(|_| lanes).unwrap_or(&function.program);
        program.interpret_program(&|s| match Quantity::from_symbol(s) {
            Quantity::PassiveForce(k) => called[0][k],
            Quantity::PassiveDerivative(k) => called[1][k],
            quantity => self.value_of_quantity(quantity, &[]),
        })
    }

    /// Returns the results of a function of the prepared mechanism.
    pub fn run_prepared_function(&self, prepared: &PreparedFunctions, function: &Function) -> Vec<f64> {
        let numbers =
            prepared.numbers.interpret_program(&|s| self.value_of_quantity(Quantity::from_symbol(s), &[]));
        let outputs_of_function = |name: &str| {
            let of = prepared.functions.iter().find(|f| f.name == name);
            of.map_or_else(Vec::new, |f| {
                f.program.interpret_program(&|s| self.value_of_quantity(Quantity::from_symbol(s), &numbers))
            })
        };
        let called = CalledFunction::ALL.map(|called| outputs_of_function(called.function_name()));
        function.program.interpret_program(&|s| match Quantity::from_symbol(s) {
            Quantity::PassiveForce(k) => called[0][k],
            Quantity::PassiveDerivative(k) => called[1][k],
            quantity => self.value_of_quantity(quantity, &numbers),
        })
    }

    /// Returns the values that callers supply for one kind of argument, such as multipliers or momenta.
    pub fn supplied_values(&self, block: SuppliedQuantity) -> &[f64] {
        &self.given[3 * block as usize..]
    }

    fn value_of_quantity(&self, quantity: Quantity, numbers: &[f64]) -> f64 {
        let entry_or_nan = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(f64::NAN);
        match quantity {
            Quantity::Time => self.t,
            Quantity::Configuration(k) => entry_or_nan(&self.q, k),
            Quantity::Velocity(k) => entry_or_nan(&self.v, k),
            Quantity::Acceleration(k) => entry_or_nan(&self.a, k),
            Quantity::Force(k) => entry_or_nan(&self.tau, k),
            Quantity::Input(k) => entry_or_nan(&self.u, k),
            Quantity::Parameter(k) => entry_or_nan(&self.parameters, k),
            Quantity::Prepared(k) => entry_or_nan(numbers, k),
            Quantity::Given(block, k) => entry_or_nan(self.supplied_values(block), k),
            Quantity::Momentum(k) => entry_or_nan(&self.given, k),
            Quantity::ContactForce(k) => entry_or_nan(&self.contact_forces, k),
            Quantity::Reaction(_)
            | Quantity::PassiveForce(_)
            | Quantity::PassiveDerivative(_)
            | Quantity::ContactFeature(_)
            | Quantity::Deviation(_)
            | Quantity::Laplace
            | Quantity::Stretch
            | Quantity::Displacement(_)
            | Quantity::Deciding(_) => f64::NAN,
        }
    }

    /// Returns the results of a program that calls no other function.
    fn run_self_contained_program(&self, program: &Program) -> Vec<f64> {
        program.interpret_program(&|s| self.value_of_quantity(Quantity::from_symbol(s), &[]))
    }

    /// Returns the values with one entry changed by `h`. Configuration coordinates are not changed.
    pub fn with_changed_entry(&self, by: DerivativeVariable, k: usize, h: f64) -> Values {
        let mut values = self.clone();
        match by {
            DerivativeVariable::V => values.v[k] += h,
            DerivativeVariable::A => values.a[k] += h,
            DerivativeVariable::U => values.u[k] += h,
            DerivativeVariable::Parameters => values.parameters[k] += h,
            DerivativeVariable::Q => {}
        }
        values
    }

    /// Returns the values after a small displacement of the configuration.
    pub fn displaced_values(&self, charts: &[Chart], step: &[f64]) -> Values {
        let mut values = self.clone();
        move_along_manifold(charts, &mut values.q, step);
        values
    }

    /// Returns the values after a short time `h`: moved with the joint velocities, with constant
    /// accelerations.
    pub fn values_after_time(&self, charts: &[Chart], joints: &[f64], h: f64) -> Values {
        let step: Vec<f64> = joints.iter().map(|v| h * v).collect();
        let mut values = self.displaced_values(charts, &step);
        values.t += h;
        values.v.iter_mut().zip(&self.a).for_each(|(v, a)| *v += h * a);
        values
    }

    pub fn entry_count_of_variable(&self, by: DerivativeVariable) -> usize {
        match by {
            DerivativeVariable::Q | DerivativeVariable::V => self.v.len(),
            DerivativeVariable::A => self.a.len(),
            DerivativeVariable::U => self.u.len(),
            DerivativeVariable::Parameters => self.parameters.len(),
        }
    }
}

fn quaternion_of_chart(chart: Chart, q: &mut [f64]) -> Option<&mut [f64]> {
    chart.first_quaternion_index().map(|first| &mut q[first.range_of_entries(4)])
}

fn normalise_quaternion(q: &mut [f64]) {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.iter_mut().for_each(|x| *x /= length);
}

/// Returns the cross product `a × b`.
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Applies a small displacement, in the body axes for ball and free joints.
fn move_along_manifold(charts: &[Chart], q: &mut [f64], step: &[f64]) {
    for chart in charts {
        match *chart {
            Chart::Plain(first, velocity) => q[first.0] += step[velocity.0],
            Chart::Ball(first, velocity) => {
                rotate_quaternion(&mut q[first.range_of_entries(4)], &step[velocity.range_of_entries(3)])
            }
            Chart::Free(first, velocity) => {
                let (position, quaternion) = q[first.range_of_entries(7)].split_at_mut(3);
                let (along, axis) =
                    ([0, 1, 2].map(|k| step[velocity.0 + k]), [0, 1, 2].map(|k| quaternion[k]));
                let once = cross(axis, along);
                let twice = cross(axis, once);
                (0..3).for_each(|k| position[k] += along[k] + 2.0 * (quaternion[3] * once[k] + twice[k]));
                rotate_quaternion(quaternion, &step[(velocity + 3).range_of_entries(3)]);
            }
        }
    }
}

/// Rotates a quaternion (scalar part last) by a small rotation vector in body axes.
fn rotate_quaternion(quaternion: &mut [f64], step: &[f64]) {
    let (axis, scalar) = ([0, 1, 2].map(|k| quaternion[k]), quaternion[3]);
    let half = [0, 1, 2].map(|k| 0.5 * step[k]);
    let across = cross(axis, half);
    (0..3).for_each(|k| quaternion[k] += scalar * half[k] + across[k]);
    quaternion[3] -= axis.iter().zip(&half).map(|(a, h)| a * h).sum::<f64>();
    normalise_quaternion(quaternion);
}

/// Returns the derivative at zero of a function, by sixth-order differences with steps of `h`.
pub fn sixth_order_difference(h: f64, of: &dyn Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let [one, two, three] = [h, 2.0 * h, 3.0 * h].map(|h| (of(h), of(-h)));
    let central_difference = |(plus, minus): &(Vec<f64>, Vec<f64>), k: usize| plus[k] - minus[k];
    let derivative_of_result_entry = |k: usize| {
        (45.0 * central_difference(&one, k) - 9.0 * central_difference(&two, k)
            + central_difference(&three, k))
            / (60.0 * h)
    };
    (0..one.0.len()).map(derivative_of_result_entry).collect()
}

/// Returns the derivative at zero of a function, with an error estimate. Halving the step changes the result
/// by 63 times the remaining error.
pub fn derivative_with_error(of: &dyn Fn(f64) -> Vec<f64>) -> (Vec<f64>, f64) {
    let (wide, narrow) = (sixth_order_difference(H, of), sixth_order_difference(0.5 * H, of));
    let doubt = wide.iter().zip(&narrow).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    (narrow, doubt / 8.0)
}
