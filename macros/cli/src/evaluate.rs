//! Numerical evaluation of a mechanism's programs: accelerations and placements of frames, without compiling
//! Rust. Slower than generated code, with the same results.

use crate::Stop;
use crate::constrained::Metric;
use crate::grid::Looked;
use linkwork::nalgebra::{DMatrix, DVector, IsometryMatrix3, Matrix3, Rotation3, Vector3};
use linkwork_compiler::derive::{Function, Output};
use linkwork_compiler::expr::eval::eval_one;
use linkwork_compiler::expr::{Lookup, Symbol};
use linkwork_compiler::lower::Program;
use linkwork_compiler::mechanism::{Chart, InQ, InV, Model, Quantity};
use linkwork_compiler::syntax::RATE_OF_STATE;

/// Mechanism with values of its parameters.
pub struct Evaluated<'a, 'g> {
    /// Model of the mechanism.
    pub model: &'a Model<'g>,
    output: &'a Output,
    parameters: Vec<f64>,
    tables: Vec<Looked>,
    /// States of first order, each with its index among the parameters.
    pub states: Vec<(String, usize)>,
}

/// Arguments of the programs.
#[derive(Clone, Copy, Default)]
pub struct Values<'a> {
    /// Time, s.
    pub t: f64,
    /// Configuration.
    pub q: &'a [f64],
    /// Velocity.
    pub v: &'a [f64],
    /// States of first order; if empty, their values among the parameters are used.
    pub x: &'a [f64],
    /// Inputs.
    pub u: &'a [f64],
    /// Generalized forces.
    pub tau: &'a [f64],
    /// Placement of the link that a frame is fixed to, or other additional arguments.
    pub given: &'a [f64],
    /// Passive forces.
    pub passive: &'a [f64],
}

/// Relative residual above which accelerations contradict a constraint.
const CONTRADICTION: f64 = 1e-6;
/// Placement of the ground: a rotation matrix row by row, then a position.
const GROUND: [f64; 12] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];

impl<'a, 'g> Evaluated<'a, 'g> {
    /// Creates a mechanism with values of all parameters, and its tables.
    pub fn new(
        model: &'a Model<'g>,
        output: &'a Output,
        parameters: Vec<f64>,
        tables: Vec<Looked>,
        states: Vec<(String, usize)>,
    ) -> Evaluated<'a, 'g> {
        Evaluated { model, output, parameters, tables, states }
    }

    /// Checks whether the parameters are admissible, as `validate` does in Rust.
    pub fn validate(&self) -> Result<(), Stop> {
        use linkwork::__private::{Figure, Rule, validate};
        use linkwork_compiler::mechanism::Rule as Known;
        if self.model.requirements.is_empty() {
            return Ok(());
        }
        let values = self.called("__figures", Values::default()).ok_or_else(|| no_function("__figures"))?;
        // Leaking is acceptable, since the process ends soon.
        let kept = |text: &str| -> &'static str { Box::leak(text.to_string().into_boxed_str()) };
        let figures = self.model.requirements.iter().map(|requirement| Figure {
            rule: match requirement.rule {
                Known::Finite => Rule::Finite,
                Known::Mass => Rule::Mass,
                Known::Length => Rule::Length,
                Known::NotNegative => Rule::NotNegative,
                Known::Positive => Rule::Positive,
                Known::HalfAngle => Rule::HalfAngle,
                Known::Unit => Rule::Unit,
                Known::Fraction => Rule::Fraction,
                Known::Order => Rule::Order,
                Known::Inertia => Rule::Inertia,
            },
            name: kept(&requirement.figure),
            parameters: Vec::leak(
                requirement.parameters.iter().map(|k| kept(&self.model.parameters[*k])).collect(),
            ),
        });
        Ok(validate(&figures.collect::<Vec<_>>(), &values)?)
    }

    /// Returns the neutral configuration.
    pub fn neutral(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.model.nq()];
        for chart in &self.model.charts {
            if let Some(first) = chart.quaternion() {
                q[first.0 + 3] = 1.0;
            }
        }
        q
    }

    /// Normalises quaternions; a zero quaternion is an error.
    pub fn normalise(&self, q: &mut [f64]) -> Result<(), Stop> {
        for first in self.model.charts.iter().filter_map(Chart::quaternion) {
            let quaternion = &mut q[first.and_next(4)];
            let size = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
            if size < 1e-9 || !size.is_finite() {
                let names = self.model.configuration[first.and_next(4)].join(", ");
                return Err(Stop::Failure(format!("the quaternion {names} is zero")));
            }
            quaternion.iter_mut().for_each(|x| *x /= size);
        }
        Ok(())
    }

    /// Returns the rates of `q` for the velocity `v`, which has the declared generalized speeds, if any.
    pub fn rates(&self, q: &[f64], v: &[f64]) -> Vec<f64> {
        match self.called("rates_of_speeds", Values { q, v, ..Values::default() }) {
            Some(of_joints) => self.rates_of_joints(q, &of_joints),
            None => self.rates_of_joints(q, v),
        }
    }

    /// Returns the rates of `q` for velocities of the joints: linear velocities in the axes of the positions,
    /// and rates of quaternions.
    pub fn rates_of_joints(&self, q: &[f64], v: &[f64]) -> Vec<f64> {
        let mut rates = vec![0.0; q.len()];
        for chart in &self.model.charts {
            match *chart {
                Chart::Plain(at, from) => rates[at.0] = v[from.0],
                Chart::Ball(InQ(at), InV(from)) => spin(&q[at..], &v[from..], &mut rates[at..]),
                Chart::Free(InQ(at), InV(from)) => {
                    let [x, y, z, w] = [q[at + 3], q[at + 4], q[at + 5], q[at + 6]];
                    let axis = Vector3::new(x, y, z);
                    let linear = Vector3::new(v[from], v[from + 1], v[from + 2]);
                    let turned = linear + (axis.cross(&linear) * w + axis.cross(&axis.cross(&linear))) * 2.0;
                    rates[at..at + 3].copy_from_slice(turned.as_slice());
                    spin(&q[at + 3..], &v[from + 3..], &mut rates[at + 3..]);
                }
            }
        }
        rates
    }

    /// Returns accelerations, then the rates of the states of first order; NaN if constraints do not
    /// determine them.
    pub fn accelerations(&self, state: Values<'_>) -> Vec<f64> {
        let passive = self.called("__passive_forces", state).unwrap_or_default();
        let state = Values { passive: &passive, ..state };
        let tau = self.called("generalized_forces", state).unwrap_or_default();
        let tau = if tau.is_empty() { vec![0.0; state.v.len()] } else { tau };
        let a = match self.is_constrained() {
            true => self.constrained(state, tau),
            false => self.called("forward_dynamics", Values { tau: &tau, ..state }),
        };
        let mut a = a.unwrap_or(vec![f64::NAN; state.v.len()]);
        a.extend(self.states.iter().map(|(name, _)| {
            let rate = self.called(&rate_of(name), state);
            rate.and_then(|rate| rate.first().copied()).unwrap_or(f64::NAN)
        }));
        a
    }

    /// Checks that the functions exist with which accelerations and initial states are computed.
    ///
    /// # Errors
    ///
    /// An internal error that names a missing function.
    pub fn require_dynamics(&self) -> Result<(), Stop> {
        let mut names = match self.is_constrained() {
            false => vec!["forward_dynamics"],
            true => vec![
                "mass_matrix",
                "bias_forces",
                "constraint_jacobian",
                "constraint_bias",
                "constraint_rates",
                "constraint_residuals",
            ],
        };
        names.push("generalized_forces");
        if self.model.speeds.is_some() {
            names.extend(["rates_of_speeds", "speeds_of_rates"]);
        }
        let rates: Vec<String> = self.states.iter().map(|(name, _)| rate_of(name)).collect();
        names.extend(rates.iter().map(String::as_str));
        match names.into_iter().find(|name| self.find(name).is_none()) {
            None => Ok(()),
            Some(name) => Err(no_function(name)),
        }
    }

    fn find(&self, name: &str) -> Option<&Function> {
        self.output.functions.iter().find(|f| f.name == name)
    }

    /// Evaluates the generated function with this name, if it exists.
    pub fn called(&self, name: &str, state: Values<'_>) -> Option<Vec<f64>> {
        Some(self.run(&self.find(name)?.program, state))
    }

    /// Returns whether the mechanism has constraints.
    pub fn is_constrained(&self) -> bool {
        !self.model.constraints.is_empty()
    }

    /// Returns whether the declared speeds do not determine the rates of all coordinates in this
    /// configuration: the ratio of their smallest to their largest singular value is at most `ratio`.
    pub fn has_singular_speeds(&self, q: &[f64], ratio: f64) -> bool {
        let n = self.model.nv();
        if self.model.speeds.is_none() || n == 0 {
            return false;
        }
        let mut speeds = DMatrix::zeros(n, n);
        for k in 0..n {
            let unit: Vec<f64> = (0..n).map(|j| f64::from(u8::from(j == k))).collect();
            let state = Values { q, v: &unit, ..Values::default() };
            let Some(column) = self.called("speeds_of_rates", state) else { return false };
            speeds.set_column(k, &DVector::from_vec(column));
        }
        // Speeds may have different units: rows have the length one, except rows that rounding makes nonzero.
        let largest = speeds.row_iter().map(|row| row.norm()).fold(0.0, f64::max);
        for mut row in speeds.row_iter_mut() {
            let size = row.norm();
            row /= if size > 1e-12 * largest { size } else { 1.0 };
        }
        let sizes = speeds.singular_values();
        sizes.min() <= ratio * sizes.max()
    }

    /// Returns whether the mass matrix is positive definite at time zero.
    pub fn has_inertia(&self, q: &[f64]) -> bool {
        self.metric(Values { q, v: &vec![0.0; self.model.nv()], ..Values::default() }).is_some()
    }

    fn metric(&self, state: Values<'_>) -> Option<Metric> {
        Metric::of(&self.called("mass_matrix", state)?, self.model.nv())
    }

    /// Returns the accelerations that satisfy the constraints and are nearest to the unconstrained
    /// accelerations.
    fn constrained(&self, state: Values<'_>, mut force: Vec<f64>) -> Option<Vec<f64>> {
        let bias = self.called("bias_forces", state)?;
        force.iter_mut().zip(bias).for_each(|(f, h)| *f -= h);
        let jacobian = self.called("constraint_jacobian", state)?;
        let target: Vec<f64> = self.called("constraint_bias", state)?.iter().map(|b| -b).collect();
        let (a, off) = self.metric(state)?.nearest(force, &jacobian, &target);
        let scale = target.iter().chain(&a).fold(1.0_f64, |most, x| most.max(x.abs()));
        (off <= CONTRADICTION * scale).then_some(a)
    }

    /// Returns the reason why the accelerations cannot be computed here, if any.
    pub fn obstacle(&self, without_contacts: bool) -> Option<String> {
        let m = self.model;
        let tell = |what: &str| {
            Some(format!(
                "{what}: simulate it in a program of Rust, as `linkwork new` makes one, or through `linkwork export library`"
            ))
        };
        if m.kinematic {
            return Some("it has no masses (`inertia = none`), so nothing tells how it moves".to_string());
        }
        if m.constraints.iter().any(|constraint| !constraint.friction.is_empty()) {
            return tell("it has contacts that slip, whose friction depends on the forces of constraints");
        }
        if self.is_constrained() && !m.acceleration_forces.is_empty() {
            return tell("it has constraints, and forces that depend on accelerations");
        }
        if !m.contacts.is_empty() && !without_contacts {
            let text = tell("it has contacts").unwrap_or_default();
            return Some(format!("{text}; `--without-contacts` lets bodies pass through each other"));
        }
        let known = |symbol: Symbol| {
            matches!(
                Quantity::of(symbol),
                Quantity::Parameter(_)
                    | Quantity::Configuration(_)
                    | Quantity::Velocity(_)
                    | Quantity::Force(_)
                    | Quantity::Input(_)
                    | Quantity::Time
                    | Quantity::PassiveForce(_)
            )
        };
        let names = match self.is_constrained() {
            true => {
                &["mass_matrix", "bias_forces", "constraint_jacobian", "constraint_bias", "constraint_rates"]
                    [..]
            }
            false => &["forward_dynamics"],
        };
        let whole = |name: &str| self.find(name).is_some_and(|f| f.program.symbols().into_iter().all(known));
        let speeds = m.speeds.as_ref().map(|_| "rates_of_speeds".to_string());
        let states = self.states.iter().map(|(name, _)| rate_of(name));
        let needed = names.iter().map(ToString::to_string).chain(speeds).chain(states);
        match needed.into_iter().all(|name| whole(&name)) {
            true => None,
            false => tell("its dynamics are no function of the state alone"),
        }
    }

    /// Returns the placement of every frame for a time, a configuration and states of first order.
    pub fn placements(&self, t: f64, q: &[f64], x: &[f64]) -> Vec<IsometryMatrix3<f64>> {
        let mut links: Vec<Vec<f64>> = Vec::new();
        let v = vec![0.0; self.model.nv()];
        let at = |program: &Program, given: &[f64]| {
            self.run(program, Values { t, q, v: &v, x, given, ..Values::default() })
        };
        for link in &self.output.links {
            let parent = link.parent.map_or(&GROUND[..], |k| &links[k][..]);
            let placed = at(&link.placement, parent);
            links.push(placed);
        }
        let frame = |link: Option<usize>| link.map_or(&GROUND[..], |k| &links[k][..]);
        let placed = self.output.frames.iter().map(|f| at(&f.placement, frame(f.link)));
        placed
            .map(|n| {
                let turn = Rotation3::from_matrix_unchecked(Matrix3::from_row_slice(&n[..9]));
                IsometryMatrix3::from_parts(Vector3::from_column_slice(&n[9..]).into(), turn)
            })
            .collect()
    }

    /// Evaluates an expression of the parameters.
    pub fn value(&self, e: linkwork_compiler::expr::Expr<'_>) -> f64 {
        eval_one(e, &|symbol| self.symbol(symbol, Values::default()))
    }

    fn run(&self, program: &Program, values: Values<'_>) -> Vec<f64> {
        let looked = |lookup: Lookup, x| {
            self.tables.get(lookup.table()).map_or(f64::NAN, |table| table.value(lookup, x))
        };
        program.run_with(&|symbol| self.symbol(symbol, values), &looked)
    }

    fn symbol(&self, symbol: Symbol, values: Values<'_>) -> f64 {
        let entry = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(f64::NAN);
        match Quantity::of(symbol) {
            Quantity::Parameter(k) => {
                let state = self.states.iter().position(|(_, parameter)| *parameter == k);
                let state = state.and_then(|state| values.x.get(state)).copied();
                state.unwrap_or_else(|| entry(&self.parameters, k))
            }
            Quantity::Configuration(k) => entry(values.q, k),
            Quantity::Velocity(k) => entry(values.v, k),
            Quantity::Force(k) => entry(values.tau, k),
            Quantity::Input(k) => entry(values.u, k),
            Quantity::Time => values.t,
            Quantity::Given(k) => entry(values.given, k),
            Quantity::PassiveForce(k) => entry(values.passive, k),
            _ => f64::NAN,
        }
    }
}

/// Returns the internal error for a function that does not exist.
fn no_function(name: &str) -> Stop {
    Stop::Failure(format!("internal error of Linkwork: no function `{name}`"))
}

/// Returns the name of the function for the rate of a state of first order.
fn rate_of(state: &str) -> String {
    format!("{state}{RATE_OF_STATE}")
}

/// Computes the rate of a quaternion, x y z w, for an angular velocity in the rotated axes: half their
/// product.
fn spin(q: &[f64], w: &[f64], rate: &mut [f64]) {
    let (x, y, z, s) = (q[0], q[1], q[2], q[3]);
    rate[0] = 0.5 * (s * w[0] + y * w[2] - z * w[1]);
    rate[1] = 0.5 * (s * w[1] + z * w[0] - x * w[2]);
    rate[2] = 0.5 * (s * w[2] + x * w[1] - y * w[0]);
    rate[3] = -0.5 * (x * w[0] + y * w[1] + z * w[2]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use linkwork_compiler::diag::Diagnostics;
    use linkwork_compiler::expr::Graph;
    use linkwork_compiler::{compile, read};
    use std::path::Path;

    /// Checks that a missing function is reported and not treated as zero.
    #[test]
    fn missing_functions_are_internal_errors() {
        let cart = "#[body(mass = 2)] cart: Body, #[joint(ground -> cart, along = (x, y))] plane: Stage,
            #[acts(on = plane.x)] push: Force,";
        let held = format!("{cart} #[constraint(plane.y = 3 * t)] drive: Holonomic,");
        let free = ["generalized_forces", "forward_dynamics"];
        let constrained = [
            "generalized_forces",
            "mass_matrix",
            "constraint_bias",
            "constraint_rates",
            "constraint_residuals",
        ];
        for (fields, names) in [(cart, &free[..]), (&held, &constrained)] {
            let (graph, cx) = (Graph::new(), &mut Diagnostics::new());
            let item = format!("struct Machine {{ {fields} }}").parse().unwrap();
            let source = read("".parse().unwrap(), item, Path::new(""), cx).unwrap();
            let (model, mut output) = compile(&source, &graph, cx).unwrap();
            let all = Evaluated::new(&model, &output, Vec::new(), Vec::new(), Vec::new());
            assert!(all.require_dynamics().is_ok());
            let state = Values { q: &[0.0; 2], v: &[0.0, 3.0], u: &[5.0], ..Values::default() };
            let a = all.accelerations(state);
            assert!((a[0] - 2.5).abs() < 1e-15 && a[1].abs() < 1e-15, "{a:?}");
            for name in names {
                let at = output.functions.iter().position(|f| f.name == *name).unwrap();
                let removed = output.functions.remove(at);
                let left = Evaluated::new(&model, &output, Vec::new(), Vec::new(), Vec::new());
                let Err(Stop::Failure(message)) = left.require_dynamics() else {
                    panic!("{name} is not missed")
                };
                assert_eq!(message, format!("internal error of Linkwork: no function `{name}`"));
                output.functions.insert(at, removed);
            }
        }
    }
}
