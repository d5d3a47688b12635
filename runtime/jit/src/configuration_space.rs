//! Functions of the configuration space: motions along velocities, differences of configurations, rates of
//! displacements.

use crate::functions::{CallableFunctionBuilder, LoadedFunction, Matrix, ResultAssembly};
use crate::routine::Values;
use crate::shared::SharedMechanism;
use linkwork::__private::{
    ball_carry, ball_carry_rate, ball_difference, ball_integrate, ball_tangent_rate, free_carry,
    free_carry_rate, free_difference, free_integrate, free_tangent_rate,
};
use linkwork_compiler::catalogue::Argument;
use linkwork_compiler::mechanism::{Chart, InQ, InV, SuppliedQuantity};

/// Function of the configuration space, such as integration or difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ConfigurationSpaceOperation {
    Integrate,
    Difference,
    TangentRate,
    DisplacementRate,
}

/// Function of the configuration space, with the indices of the functions that convert between generalized
/// speeds and joint velocities, if the mechanism declares speeds.
pub(crate) struct ConfigurationSpaceFunction {
    kind: ConfigurationSpaceOperation,
    speeds: Option<[usize; 2]>,
}

/// Returns `N` entries of a list, from the index `first` on.
fn array_from_list<const N: usize>(list: &[f64], first: usize) -> [f64; N] {
    std::array::from_fn(|k| list[first + k])
}

/// Computes the configuration that is reached from `q` along the constant joint velocity `dv` in one unit of
/// time.
pub(crate) fn integrate(charts: &[Chart], q: &[f64], dv: &[f64], out: &mut [f64]) {
    for chart in charts {
        match *chart {
            Chart::Plain(InQ(q0), InV(v0)) => out[q0] = q[q0] + dv[v0],
            Chart::Ball(InQ(q0), InV(v0)) => {
                out[q0..q0 + 4]
                    .copy_from_slice(&ball_integrate(array_from_list(q, q0), array_from_list(dv, v0)));
            }
            Chart::Free(InQ(q0), InV(v0)) => {
                out[q0..q0 + 7]
                    .copy_from_slice(&free_integrate(array_from_list(q, q0), array_from_list(dv, v0)));
            }
        }
    }
}

pub(crate) fn difference(charts: &[Chart], from: &[f64], to: &[f64], out: &mut [f64]) {
    for chart in charts {
        match *chart {
            Chart::Plain(InQ(q0), InV(v0)) => out[v0] = to[q0] - from[q0],
            Chart::Ball(InQ(q0), InV(v0)) => {
                out[v0..v0 + 3]
                    .copy_from_slice(&ball_difference(array_from_list(from, q0), array_from_list(to, q0)));
            }
            Chart::Free(InQ(q0), InV(v0)) => {
                out[v0..v0 + 6]
                    .copy_from_slice(&free_difference(array_from_list(from, q0), array_from_list(to, q0)));
            }
        }
    }
}

pub(crate) fn tangent_rate(charts: &[Chart], dv: &[f64], v: &[f64], out: &mut [f64]) {
    for chart in charts {
        match *chart {
            Chart::Plain(_, InV(v0)) => out[v0] = v[v0],
            Chart::Ball(_, InV(v0)) => {
                out[v0..v0 + 3]
                    .copy_from_slice(&ball_tangent_rate(array_from_list(dv, v0), array_from_list(v, v0)));
            }
            Chart::Free(_, InV(v0)) => {
                out[v0..v0 + 6]
                    .copy_from_slice(&free_tangent_rate(array_from_list(dv, v0), array_from_list(v, v0)));
            }
        }
    }
}

/// Writes a velocity in the axes that ball and free joints have after a displacement `dv`.
pub(crate) fn transport_velocity(charts: &[Chart], dv: &[f64], v: &[f64], out: &mut [f64]) {
    for chart in charts {
        match *chart {
            Chart::Plain(_, InV(v0)) => out[v0] = v[v0],
            Chart::Ball(_, InV(v0)) => {
                out[v0..v0 + 3].copy_from_slice(&ball_carry(array_from_list(dv, v0), array_from_list(v, v0)));
            }
            Chart::Free(_, InV(v0)) => {
                out[v0..v0 + 6].copy_from_slice(&free_carry(array_from_list(dv, v0), array_from_list(v, v0)));
            }
        }
    }
}

/// Copies the linear velocities of free joints.
pub(crate) fn copy_linear_velocities(charts: &[Chart], dv: &[f64], out: &mut [f64]) {
    for chart in charts {
        if let Chart::Free(_, InV(v0)) = *chart {
            out[v0..v0 + 3].copy_from_slice(&dv[v0..v0 + 3]);
        }
    }
}

/// Writes the rate of [`transport_velocity`] for a displacement that begins at zero and grows at the rate
/// `dv`.
pub(crate) fn write_transported_velocity_rate(charts: &[Chart], dv: &[f64], v: &[f64], out: &mut [f64]) {
    for chart in charts {
        match *chart {
            Chart::Plain(_, InV(v0)) => out[v0] = 0.0,
            Chart::Ball(_, InV(v0)) => {
                out[v0..v0 + 3]
                    .copy_from_slice(&ball_carry_rate(array_from_list(dv, v0), array_from_list(v, v0)));
            }
            Chart::Free(_, InV(v0)) => {
                out[v0..v0 + 6]
                    .copy_from_slice(&free_carry_rate(array_from_list(dv, v0), array_from_list(v, v0)));
            }
        }
    }
}

impl ConfigurationSpaceFunction {
    /// Adds the functions of the configuration space to those of a mechanism.
    pub fn add(maker: &mut CallableFunctionBuilder<'_, '_>) {
        let (nq, nv) = (maker.model.nq(), maker.model.nv());
        let speeds = match [maker.index("rates_of_speeds"), maker.index("speeds_of_rates")] {
            [Some(rates), Some(speeds)] => Some([rates, speeds]),
            _ => None,
        };
        let velocity_argument = |name| Argument::Given(name, SuppliedQuantity::State, nv);
        let configuration_argument = |name| Argument::Given(name, SuppliedQuantity::State, nq);
        let mut add_function_entry = |kind, name, documentation: &str, arguments: Vec<Argument>, rows| {
            let results = vec![Matrix { name: "result", rows, columns: 1 }];
            let plan =
                ResultAssembly::ConfigurationSpaceFunction(ConfigurationSpaceFunction { kind, speeds });
            let calls = speeds.map_or(0, |all| all.map(|k| maker.entries[k].work).into_iter().sum());
            let entry = LoadedFunction::new(name, documentation.to_string(), arguments, results, plan);
            let work = 4 * nv + nq + calls;
            maker.entries.push(LoadedFunction { work, ..entry });
        };
        let dv = velocity_argument("dv");
        add_function_entry(
            ConfigurationSpaceOperation::Integrate,
            "integrate",
            "Configuration that is reached from `q` in one unit of time with the constant velocity `dv`; \
             quaternions are normalised.",
            vec![Argument::Q, dv],
            nq,
        );
        add_function_entry(
            ConfigurationSpaceOperation::Difference,
            "difference",
            "Velocity that leads from one configuration to another in one unit of time.",
            vec![configuration_argument("from"), configuration_argument("to")],
            nv,
        );
        match speeds {
            None => add_function_entry(
                ConfigurationSpaceOperation::TangentRate,
                "tangent_rate",
                "Rate of `dv` for which `integrate(q, dv)` moves with velocity `v`.",
                vec![dv, Argument::V],
                nv,
            ),
            Some(_) => add_function_entry(
                ConfigurationSpaceOperation::DisplacementRate,
                "displacement_rate",
                "Rate of `dv` for which `integrate(q, dv)` moves with the speeds `v`.",
                vec![Argument::Q, dv, Argument::V],
                nv,
            ),
        }
    }

    /// Returns the indices of the functions that this function calls.
    pub fn called_function_indices(&self) -> Vec<usize> {
        self.speeds.into_iter().flatten().collect()
    }

    /// Evaluates the function of the configuration space.
    pub fn evaluate(
        &self,
        shared: &SharedMechanism,
        values: Values<'_>,
        _: &[Argument],
        out: &mut [f64],
        work: &mut [f64],
    ) {
        let charts = &shared.charts;
        let inputs = values.arguments;
        let Some([rates, speeds]) = self.speeds else {
            return match self.kind {
                ConfigurationSpaceOperation::Integrate => integrate(charts, inputs[0], inputs[1], out),
                ConfigurationSpaceOperation::Difference => difference(charts, inputs[0], inputs[1], out),
                ConfigurationSpaceOperation::TangentRate | ConfigurationSpaceOperation::DisplacementRate => {
                    tangent_rate(charts, inputs[0], inputs[1], out)
                }
            };
        };
        let (nq, nv) = (shared.sizes.nq, shared.sizes.nv);
        let (way, rest) = work.split_at_mut(nv);
        let (rate, rest) = rest.split_at_mut(nv);
        let (change, rest) = rest.split_at_mut(nv);
        let (there, rest) = rest.split_at_mut(nq);
        let mut call_velocity_conversion = |function: usize, q: &[f64], v: &[f64], out: &mut [f64]| {
            let given = [(Argument::Q, q), (Argument::V, v)];
            shared.call(function, values, &[], &given, out, rest);
        };
        match self.kind {
            ConfigurationSpaceOperation::Integrate => {
                call_velocity_conversion(rates, inputs[0], inputs[1], way);
                integrate(charts, inputs[0], way, out);
            }
            ConfigurationSpaceOperation::Difference => {
                difference(charts, inputs[0], inputs[1], way);
                call_velocity_conversion(speeds, inputs[0], way, out);
            }
            ConfigurationSpaceOperation::TangentRate | ConfigurationSpaceOperation::DisplacementRate => {
                call_velocity_conversion(rates, inputs[0], inputs[1], way);
                integrate(charts, inputs[0], way, there);
                call_velocity_conversion(rates, there, inputs[2], rate);
                tangent_rate(charts, way, rate, change);
                call_velocity_conversion(speeds, inputs[0], change, out);
            }
        }
    }
}
