//! The equations in generalized speeds (Kane and Levinson, *Dynamics: Theory and Applications*, 1985, ch. 2,
//! 4 and 6): with `v = Z u` and `u = Y v` for the joint velocities `v`,
//!
//! ```text
//! v̇ = Z u̇ + Ż u,   M_u = Zᵀ M Z,   h_u = Zᵀ (h + M Ż u),   τ_u = Zᵀ τ,   u̇ = Y (v̇ − Ż u).
//! ```
//!
//! The algorithms run in joint velocities. Their arguments and results are transformed here. In the results,
//! as everywhere, the symbols of velocities and accelerations denote `u` and `u̇`.

use super::crba::Matrix;
use super::derivatives::symbolic;
use super::{acceleration_symbols, constraints, generalized_force_symbols, velocity_symbols};
use crate::expr::replace::substitute_symbols_in_all;
use crate::expr::{Expr, Mat3, Vec3};
use crate::kinematics::time_derivative;
use crate::mechanism::{Chart, DerivativeCache, InV, Model, Quantity, Speeds, SuppliedQuantity};
use std::rc::Rc;

/// Kind of a function's results, which determines their transformation to generalized speeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResultKind {
    /// Results that are invariant under the choice of velocities.
    Scalars,
    /// Results that are generalized forces or momenta, one for each velocity.
    Forces,
    /// Results that are the rate of generalized momenta, followed by the momenta.
    MomentumRate,
    /// This number of values at zero accelerations, followed by the matrix of their derivatives with respect
    /// to the accelerations, column by column.
    Bias(usize),
    /// Accelerations under the forces `tau`, then scalars, then for each of this number of multipliers the
    /// acceleration increments per unit of the multiplier.
    Accelerations(usize),
    /// Velocities or accelerations that result from forces given as arguments, then scalars, then for each of
    /// this number of multipliers the increments per unit of the multiplier.
    Answers(usize),
    /// Result that is a mass matrix, column by column.
    Metric,
    /// Result that is the inverse of a mass matrix, column by column.
    InverseMetric,
    /// A matrix with this number of rows and a column for each velocity, column by column.
    Columns(usize),
    /// Velocity increments for each of this number of impulses, then scalars.
    Responses(usize),
}

/// Transformation of a mechanism from joint velocities to generalized speeds.
pub struct SpeedTransformation<'g> {
    /// Model of the mechanism formulated in joint velocities.
    pub native: Model<'g>,
    /// The mechanism in which everything that contains velocities is expressed in generalized speeds:
    /// constraints, contacts and outputs.
    pub model: Model<'g>,
    speeds: Rc<Speeds<'g>>,
    /// Joint velocities `Z u` as expressions of the generalized speeds.
    pub rates: Vec<Expr<'g>>,
    /// Joint accelerations `Z u̇ + Ż u`, as expressions of the speeds and their rates.
    pub accelerations: Vec<Expr<'g>>,
    /// Bias `Ż u` of the joint accelerations in generalized speeds.
    change: Vec<Expr<'g>>,
    /// Generalized forces of the joints, `Yᵀ τ`, for the forces `τ` of the speeds.
    efforts: Vec<Expr<'g>>,
}

impl<'g> SpeedTransformation<'g> {
    /// Returns the transformation for a mechanism with generalized speeds; `None` for a mechanism without.
    pub fn new(model: &Model<'g>) -> Option<SpeedTransformation<'g>> {
        let speeds = model.speeds.clone()?;
        let g = model.graph;
        let native = Model { speeds: None, velocities: speeds.velocities.clone(), ..model.clone() };
        let n = model.nv();
        let rates: Vec<Expr<'g>> = (0..n).map(|k| speeds.joint_velocity(g, InV(k))).collect();
        let change: Vec<Expr<'g>> =
            rates.iter().map(|rate| time_derivative(model.configuration_space(), *rate)).collect();
        let a = acceleration_symbols(model);
        let accelerations =
            matrix_times_vector(&speeds.rates, &a).iter().zip(&change).map(|(a, c)| *a + *c).collect();
        let efforts =
            multiply_transposed(&speeds.velocity_to_speed_matrix, &generalized_force_symbols(model));
        let model = Model { gradients: DerivativeCache::default(), passive: None, ..model.clone() };
        let mut found = SpeedTransformation { native, model, speeds, rates, accelerations, change, efforts };
        found.convert_constraints_to_speeds();
        found.convert_contacts();
        for k in 0..found.model.outputs.len() {
            found.model.outputs[k].values = found.express_in_speeds(&found.native.outputs[k].values);
        }
        Some(found)
    }

    fn convert_constraints_to_speeds(&mut self) {
        let rows = constraints::jacobian(&self.native);
        let native = &self.native.constraints;
        let rates: Vec<Expr<'g>> = native.iter().map(|c| c.rate).collect();
        let biases: Vec<Expr<'g>> = native.iter().map(|c| c.bias).collect();
        let (rates, biases) = (self.express_in_speeds(&rates), self.express_in_speeds(&biases));
        let turned = matrix_times_vector(&rows, &self.change);
        for (k, constraint) in self.model.constraints.iter_mut().enumerate() {
            constraint.rate = rates[k];
            constraint.bias = biases[k] + turned[k];
        }
    }

    fn convert_contacts(&mut self) {
        for k in 0..self.model.contacts.len() {
            self.model.contacts[k].rates = self.express_in_speeds(&self.native.contacts[k].rates);
        }
    }

    /// Expresses joint velocities, accelerations and forces in generalized speeds: replaces the symbols in
    /// `e` by their values in terms of `u`, `u̇` and the forces of the speeds.
    pub fn express_in_speeds(&self, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
        substitute_symbols_in_all(e, &|s| match Quantity::from_symbol(s) {
            Quantity::Velocity(k) => self.rates.get(k).copied(),
            Quantity::Acceleration(k) => self.accelerations.get(k).copied(),
            Quantity::Force(k) => self.efforts.get(k).copied(),
            _ => None,
        })
    }

    /// Transforms generalized forces or momenta of the joints to those of the speeds: multiplies by `Zᵀ`.
    pub fn transform_forces(&self, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
        multiply_transposed(&self.speeds.rates, &self.express_in_speeds(e))
    }

    /// Transforms joint velocities, already expressed in speeds, to the speeds: `Y v`.
    pub fn speeds_of_velocities(&self, v: &[Expr<'g>]) -> Vec<Expr<'g>> {
        matrix_times_vector(&self.speeds.velocity_to_speed_matrix, v)
    }

    /// Transforms joint accelerations to the rates of the speeds: `Y (v̇ − Ż u)`.
    pub fn speed_rates_from_accelerations(&self, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let relative: Vec<Expr<'g>> =
            self.express_in_speeds(e).iter().zip(&self.change).map(|(a, change)| *a - *change).collect();
        self.speeds_of_velocities(&relative)
    }

    /// Expresses `e` in generalized speeds. The given forces in `e` are generalized forces of the joints; the
    /// given forces of the result are generalized forces of the speeds.
    pub fn express_in_speeds_and_forces(&self, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
        self.replace_covector_symbols(e, |k| Quantity::Given(SuppliedQuantity::Force, k))
    }

    /// Expresses `e` in generalized speeds. The given momenta in `e` are momenta of the joints; the given
    /// momenta of the result are momenta of the speeds.
    pub fn express_in_speeds_and_momenta(&self, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
        self.replace_covector_symbols(e, Quantity::Momentum)
    }

    fn replace_covector_symbols(&self, e: &[Expr<'g>], argument: fn(usize) -> Quantity) -> Vec<Expr<'g>> {
        let g = self.model.graph;
        let symbols: Vec<_> = (0..self.model.nv()).map(|k| argument(k).symbol()).collect();
        let own: Vec<Expr<'g>> = symbols.iter().map(|s| g.symbol(*s)).collect();
        let native = multiply_transposed(&self.speeds.velocity_to_speed_matrix, &own);
        substitute_symbols_in_all(&self.express_in_speeds(e), &|s| {
            symbols.iter().position(|known| *known == s).and_then(|k| native.get(k)).copied()
        })
    }

    /// Sets the rates of the speeds in the expressions to zero.
    pub fn without_accelerations(&self, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let zero = self.model.graph.zero();
        substitute_symbols_in_all(e, &|s| {
            matches!(Quantity::from_symbol(s), Quantity::Acceleration(_)).then_some(zero)
        })
    }

    /// Transforms the results of a function in joint velocities to generalized speeds.
    pub fn results_in_generalized_speeds(&self, role: ResultKind, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let n = self.model.nv();
        match role {
            ResultKind::Scalars => self.express_in_speeds(e),
            ResultKind::Forces => self.transform_forces(e),
            ResultKind::MomentumRate => {
                let (rate, momentum) = e.split_at(n.min(e.len()));
                self.transform_momentum_rate(rate, momentum)
            }
            ResultKind::Bias(rows) => {
                let (bias, matrix) = e.split_at(rows.min(e.len()));
                self.bias_in_speeds(bias, matrix)
            }
            ResultKind::Accelerations(answers) | ResultKind::Answers(answers) => {
                let (solution, added) = e.split_at(e.len().saturating_sub(n * answers));
                let (first, rest) = solution.split_at(n.min(solution.len()));
                let mut out = match role {
                    ResultKind::Answers(_) => {
                        self.speeds_of_velocities(&self.express_in_speeds_and_forces(first))
                    }
                    _ => self.speed_rates_from_accelerations(first),
                };
                out.extend(match role {
                    ResultKind::Answers(_) => self.express_in_speeds_and_forces(rest),
                    _ => self.express_in_speeds(rest),
                });
                self.express_in_speeds(added)
                    .chunks(n.max(1))
                    .for_each(|part| out.extend(self.speeds_of_velocities(part)));
                out
            }
            ResultKind::Metric => entries_by_column(&self.transform_mass_matrix(&square_from_columns(e, n))),
            ResultKind::InverseMetric => {
                entries_by_column(&self.transform_inverse_mass_matrix(&square_from_columns(e, n)))
            }
            ResultKind::Columns(rows) => self.multiply_by_velocity_transformation(e, rows),
            ResultKind::Responses(impulses) => {
                let (added, rest) = e.split_at((n * impulses).min(e.len()));
                let added = self.express_in_speeds(added);
                let mut out: Vec<Expr<'g>> =
                    added.chunks(n.max(1)).flat_map(|part| self.speeds_of_velocities(part)).collect();
                out.extend(self.express_in_speeds(rest));
                out
            }
        }
    }

    /// Returns the mass matrix of the speeds, `Zᵀ M Z`.
    pub fn transform_mass_matrix(&self, mass: &Matrix<'g>) -> Matrix<'g> {
        let rows: Matrix<'g> = mass.iter().map(|row| multiply_transposed(&self.speeds.rates, row)).collect();
        let by_column = transposed_matrix(&rows);
        transposed_matrix(&by_column.iter().map(|c| multiply_transposed(&self.speeds.rates, c)).collect())
    }

    /// Returns `Zᵀ X` for a matrix `X` whose rows correspond to displacements.
    pub fn project_rows_onto_speeds(&self, m: &Matrix<'g>) -> Matrix<'g> {
        transposed_matrix(
            &transposed_matrix(m)
                .iter()
                .map(|column| multiply_transposed(&self.speeds.rates, column))
                .collect(),
        )
    }

    /// Returns the inverse mass matrix of the speeds, `Y M⁻¹ Yᵀ`.
    pub fn transform_inverse_mass_matrix(&self, inverse: &Matrix<'g>) -> Matrix<'g> {
        let rows: Matrix<'g> = inverse
            .iter()
            .map(|row| matrix_times_vector(&self.speeds.velocity_to_speed_matrix, row))
            .collect();
        transposed_matrix(
            &transposed_matrix(&rows)
                .iter()
                .map(|c| matrix_times_vector(&self.speeds.velocity_to_speed_matrix, c))
                .collect(),
        )
    }

    /// Multiplies a matrix, given column by column with a column for each joint velocity, by `Z` from the
    /// right; returns it column by column.
    fn multiply_by_velocity_transformation(&self, e: &[Expr<'g>], rows: usize) -> Vec<Expr<'g>> {
        let written = self.express_in_speeds(e);
        let columns: Vec<&[Expr<'g>]> = written.chunks(rows.max(1)).collect();
        let by_row: Matrix<'g> = (0..rows)
            .map(|i| {
                let row: Vec<Expr<'g>> = columns.iter().map(|c| c[i]).collect();
                multiply_transposed(&self.speeds.rates, &row)
            })
            .collect();
        self::entries_by_column(&by_row)
    }

    /// Returns the time derivative `Ż` of the velocity transformation.
    fn transformation_rates(&self) -> Matrix<'g> {
        let space = self.model.configuration_space();
        let time_derivatives_of_row =
            |row: &Vec<Expr<'g>>| row.iter().map(|e| time_derivative(space, *e)).collect();
        self.speeds.rates.iter().map(time_derivatives_of_row).collect()
    }

    /// Returns `Zᵀ (C Z + M Ż)`, a Coriolis matrix in generalized speeds. `Ṁ_u − 2 C_u` is skew-symmetric if
    /// `Ṁ − 2 C` is.
    pub fn transform_coriolis_matrix(&self, coriolis: &Matrix<'g>, mass: &Matrix<'g>) -> Matrix<'g> {
        let (z, rates) = (&self.speeds.rates, self.transformation_rates());
        let coriolis_row_in_speeds = |(c, m): (&Vec<Expr<'g>>, &Vec<Expr<'g>>)| -> Vec<Expr<'g>> {
            let own = multiply_transposed(z, &self.express_in_speeds(c));
            own.into_iter().zip(multiply_transposed(&rates, m)).map(|(own, carried)| own + carried).collect()
        };
        let sum: Matrix<'g> = coriolis.iter().zip(mass).map(coriolis_row_in_speeds).collect();
        transposed_matrix(&transposed_matrix(&sum).iter().map(|c| multiply_transposed(z, c)).collect())
    }

    /// Returns the rate of generalized momenta from the rate and the momenta in joint velocities:
    /// `ṗ_u = Zᵀ ṗ + Żᵀ p`.
    pub fn transform_momentum_rate(&self, rate: &[Expr<'g>], momentum: &[Expr<'g>]) -> Vec<Expr<'g>> {
        self.transform_expressed_momentum_rate(
            &self.express_in_speeds(rate),
            &self.express_in_speeds(momentum),
        )
    }

    /// Returns the rate of generalized momenta from the rate and the momenta of the joints that are already
    /// expressed in speeds.
    pub fn transform_expressed_momentum_rate(
        &self,
        rate: &[Expr<'g>],
        momentum: &[Expr<'g>],
    ) -> Vec<Expr<'g>> {
        let turned = multiply_transposed(&self.transformation_rates(), momentum);
        let own = multiply_transposed(&self.speeds.rates, rate);
        own.into_iter().zip(turned).map(|(own, turned)| own + turned).collect()
    }

    /// Returns `b + A Ż u`, the bias of a quantity `A v̇ + b` in generalized speeds, for the matrix `A`
    /// column by column.
    pub fn bias_in_speeds(&self, bias: &[Expr<'g>], matrix: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let (rows, mut sum) = (bias.len(), self.express_in_speeds(bias));
        for (column, change) in matrix.chunks(rows.max(1)).zip(&self.change) {
            sum.iter_mut().zip(column).for_each(|(sum, entry)| *sum += *entry * *change);
        }
        sum
    }

    /// Returns the indices of the joint velocities that speeds replace.
    pub fn replaced_velocity_indices(&self) -> Vec<usize> {
        self.speeds.replaced.iter().map(|v| v.0).collect()
    }

    /// Returns `Y`, which gives the speeds as functions of the joint velocities.
    pub fn velocity_to_speed_matrix(&self) -> &Matrix<'g> {
        &self.speeds.velocity_to_speed_matrix
    }

    /// Returns `Z`, which gives the joint velocities as functions of the speeds.
    pub fn speed_to_velocity_matrix(&self) -> &Matrix<'g> {
        &self.speeds.rates
    }

    /// Returns the derivatives of the joint velocities with respect to the configuration at constant speeds:
    /// a column for the tangent direction of each speed.
    pub fn velocity_configuration_derivatives(&self) -> Matrix<'g> {
        symbolic::configuration_derivatives(&self.model, &self.rates)
    }

    /// Returns the matrix `T` of the variational equation `ξ̇ = δu + T ξ` for the displacement `ξ` between
    /// two neighbouring motions. With `δ = Z ξ` and `δ̇ = δv + K δ` in joint velocities,
    /// `T = Y (K Z + ∂(Z u)/∂q − Ż)`.
    pub fn variational_matrix(&self) -> Matrix<'g> {
        let (changes, rates) = (self.velocity_configuration_derivatives(), self.transformation_rates());
        let native: Matrix<'g> = displacement_commutators(&self.native)
            .iter()
            .map(|row| multiply_transposed(&self.speeds.rates, &self.express_in_speeds(row)))
            .collect();
        let variational_entry = |i: usize, j: usize| native[i][j] + changes[i][j] - rates[i][j];
        let n = self.model.nv();
        let by_column: Matrix<'g> =
            (0..n).map(|j| (0..n).map(|i| variational_entry(i, j)).collect()).collect();
        transposed_matrix(&by_column.iter().map(|column| self.speeds_of_velocities(column)).collect())
    }
}

/// Returns the matrix of `φ ↦ φ × v`. It gives the rate of the displacement `φ` between two neighbouring
/// motions, `φ̇ = δv + φ × v`, which is measured in rotating axes (ball and free joints).
pub fn displacement_commutators<'g>(model: &Model<'g>) -> Matrix<'g> {
    let mut m = vec![vec![model.graph.zero(); model.nv()]; model.nv()];
    let v = velocity_symbols(model);
    let mut write_cross_product_block = |row: usize, column: usize, first: usize| {
        let minus = Mat3::skew(-Vec3([v[first], v[first + 1], v[first + 2]]));
        for i in 0..3 {
            m[row + i][column..column + 3].copy_from_slice(&minus.0[i]);
        }
    };
    for chart in &model.charts {
        match *chart {
            Chart::Plain(..) => {}
            Chart::Ball(_, InV(b)) => write_cross_product_block(b, b, b),
            Chart::Free(_, InV(b)) => {
                write_cross_product_block(b, b, b + 3);
                write_cross_product_block(b + 3, b + 3, b + 3);
                write_cross_product_block(b, b + 3, b);
            }
        }
    }
    m
}

fn dot<'g>(row: &[Expr<'g>], v: &[Expr<'g>]) -> Option<Expr<'g>> {
    let terms = row.iter().zip(v).filter(|(a, b)| !a.is_zero() && !b.is_zero());
    terms.map(|(a, b)| *a * *b).reduce(|a, b| a + b)
}

fn matrix_times_vector<'g>(m: &Matrix<'g>, v: &[Expr<'g>]) -> Vec<Expr<'g>> {
    m.iter().map(|row| dot(row, v).unwrap_or_else(|| row[0].zero())).collect()
}

fn multiply_transposed<'g>(m: &Matrix<'g>, v: &[Expr<'g>]) -> Vec<Expr<'g>> {
    matrix_times_vector(&transposed_matrix(m), v)
}

fn transposed_matrix<'g>(m: &Matrix<'g>) -> Matrix<'g> {
    let width = m.first().map_or(0, Vec::len);
    (0..width).map(|j| m.iter().map(|row| row[j]).collect()).collect()
}

/// Returns the entries of a matrix column by column.
fn entries_by_column<'g>(m: &Matrix<'g>) -> Vec<Expr<'g>> {
    transposed_matrix(m).concat()
}

/// Returns a square matrix from its entries column by column.
fn square_from_columns<'g>(e: &[Expr<'g>], n: usize) -> Matrix<'g> {
    transposed_matrix(&e.chunks(n.max(1)).map(<[Expr<'g>]>::to_vec).collect())
}
