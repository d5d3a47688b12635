//! Backward recursion of optimal control in blocks of `NV` by `NV`. Iterative linear-quadratic regulators
//! (iLQR), differential dynamic programming (DDP) and linear-quadratic regulators apply it to each instant,
//! from the last to the first.
//!
//! [`backward`] takes the linearised step `δx⁺ = A δx + B δu` of a mechanism ([`Transition`]), the cost of an
//! instant ([`Quadratic`]) and the cost-to-go after the step ([`Value`]). It returns the change of inputs
//! that minimises the total cost to second order, and the cost-to-go before the step. Sources: Mayne, *A
//! second-order gradient method for determining optimal trajectories of non-linear discrete-time systems*
//! (1966); Tassa, Erez and Todorov, *Synthesis and stabilization of complex behaviors through online
//! trajectory optimization* (2012).
//!
//! [`backward_within`] takes limits of the inputs into account.
//!
//! The functions allocate no memory: the caller stores the trajectories.
//!
//! ```
//! use linkwork::optimal::{Quadratic, Value, backward};
//! use linkwork::discrete;
//! use linkwork::prelude::*;
//!
//! /// A mass on a rail.
//! #[mechanism(derivatives)]
//! struct Cart {
//!     #[body(mass = 2)]
//!     cart: Body,
//!     #[joint(ground -> cart, along = x)]
//!     rail: Sleeve,
//!     #[acts(on = rail)]
//!     push: Force,
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let step = discrete::transition(&Cart {}, &Rk4::step(0.01), 0.0, &[0.0].into(), &[0.0].into(), &[0.0].into())?;
//! // Costs of state and input, over a horizon long enough for the gain to converge:
//! // the linear-quadratic regulator.
//! let mut cost = Quadratic::zeros();
//! (cost.qq[0], cost.uu[0]) = (1.0, 1.0);
//! let (mut policy, mut to_go) = backward(&step, &cost, &Value::zeros(), 0.0)?;
//! for _ in 0..2000 {
//!     (policy, to_go) = backward(&step, &cost, &to_go, 0.0)?;
//! }
//! // As the period tends to zero, the gains tend to −1 and −√(2 m)
//! // (Bryson and Ho, *Applied Optimal Control*, 1975, § 5.2).
//! let gain = [policy.by_q[0], policy.by_v[0]];
//! assert!((gain[0] + 1.0).abs() < 0.02 && (gain[1] + 2.0).abs() < 0.04, "{gain:?}");
//!
//! // The cost-to-go predicts the cost of bringing the moving cart back from a displacement of one metre.
//! let (mut q, mut v, mut sum) = ([1.0].into(), [0.5].into(), 0.0);
//! let expected = to_go.at(&q, &v);
//! let x: SVector<f64, 2> = discrete::stacked(&q, &v);
//! assert!((expected - 0.5 * x.dot(&(to_go.hessian::<2>() * x))).abs() < 1e-9);
//! for _ in 0..2000 {
//!     let u = policy.inputs(1.0, &q, &v);
//!     sum += (q.norm_squared() + u.norm_squared()) / 2.0;
//!     (q, v) = discrete::step(&Cart {}, &Rk4::step(0.01), 0.0, &q, &v, &u)?;
//! }
//! assert!((sum / expected - 1.0).abs() < 1e-6, "{sum} {expected}");
//! # Ok(())
//! # }
//! ```

use crate::blocks::{
    add_multiple, add_product, add_product_of_some, add_with_transpose, factors, product, scale, solve,
    solve_rows_into, symmetric_into, transpose_into, transposed, write_scaled_sum, zeros,
};
use crate::derivatives::entry_of_two_by_two_blocks;
use crate::discrete::{ConfigurationVelocityRelation, Transition};
use crate::private::constant;
use crate::{InputSecondOrder, Real};
use nalgebra::{SMatrix, SVector};

mod limits;

pub use limits::{EmptyRange, InputLimits};

/// Second-order model of the costs about a state and inputs: `gradient · (δq, δv, δu) + ½ (δq, δv, δu) ·
/// Hessian (δq, δv, δu)`. The unit of the costs is the user's choice. Displacements of ball and free joints
/// are in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic<T, const NV: usize, const NU: usize> {
    /// Gradient of the costs with respect to the configuration.
    pub q: SVector<T, NV>,
    /// Gradient of the costs with respect to the velocity.
    pub v: SVector<T, NV>,
    /// Gradient of the costs with respect to the inputs.
    pub u: SVector<T, NU>,
    /// Block of the Hessian of the costs: second derivatives with respect to the configuration.
    pub qq: SMatrix<T, NV, NV>,
    /// Block of the Hessian of the costs: mixed derivatives, configuration (rows) by velocity (columns).
    pub qv: SMatrix<T, NV, NV>,
    /// Block of the Hessian of the costs: second derivatives with respect to the velocity.
    pub vv: SMatrix<T, NV, NV>,
    /// Block of the Hessian of the costs: mixed derivatives, configuration (rows) by inputs (columns).
    pub qu: SMatrix<T, NV, NU>,
    /// Block of the Hessian of the costs: mixed derivatives, velocity (rows) by inputs (columns).
    pub vu: SMatrix<T, NV, NU>,
    /// Block of the Hessian of the costs: second derivatives with respect to the inputs.
    pub uu: SMatrix<T, NU, NU>,
}

/// Second-order model of the cost-to-go from a state: [`Quadratic`] without inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value<T, const NV: usize> {
    /// Gradient of the cost-to-go with respect to the configuration.
    pub q: SVector<T, NV>,
    /// Gradient of the cost-to-go with respect to the velocity.
    pub v: SVector<T, NV>,
    /// Block of the Hessian of the cost-to-go: second derivatives with respect to the configuration.
    pub qq: SMatrix<T, NV, NV>,
    /// Block of the Hessian of the cost-to-go: mixed derivatives, configuration (rows) by velocity (columns).
    pub qv: SMatrix<T, NV, NV>,
    /// Block of the Hessian of the cost-to-go: second derivatives with respect to the velocity.
    pub vv: SMatrix<T, NV, NV>,
}

/// Affine feedback policy for the inputs, `δu = α change + by_q δq + by_v δv`, with the step length `α` of a
/// line search (1 for the full step).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Policy<T, const NV: usize, const NU: usize> {
    /// Feedforward change of the inputs that minimises the costs to second order.
    pub change: SVector<T, NU>,
    /// Feedback gain of the policy on displacements of the configuration.
    pub by_q: SMatrix<T, NU, NV>,
    /// Feedback gain of the policy on changes of the velocity.
    pub by_v: SMatrix<T, NU, NV>,
    /// Coefficients of the expected change of the costs due to `α change`: `α expected[0] + α² expected[1]`.
    pub expected: [T; 2],
}

/// Error for costs that are not convex in the inputs, so that no change of the inputs minimises them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Indefinite {
    /// Index of the input at which the factorisation of the Hessian block `uu` meets a pivot that is not
    /// positive.
    pub input: usize,
}

crate::debug_as_display!(Indefinite);

impl core::fmt::Display for Indefinite {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "the costs are not convex in input {}: add costs of inputs, or more regularisation",
            self.input
        )
    }
}

impl core::error::Error for Indefinite {}

impl<T: Real, const NV: usize, const NU: usize> Quadratic<T, NV, NU> {
    /// Returns a cost model whose gradients and Hessian are zero.
    pub fn zeros() -> Self {
        let (state, mixed) = (SMatrix::zeros(), SMatrix::zeros());
        Self {
            q: SVector::zeros(),
            v: SVector::zeros(),
            u: SVector::zeros(),
            qq: state,
            qv: state,
            vv: state,
            qu: mixed,
            vu: mixed,
            uu: SMatrix::zeros(),
        }
    }

    /// Adds the costs `½ weight |r|²` of a residual `r` (Gauss–Newton: second derivatives of `r` are
    /// neglected), given the derivatives of `r` with respect to configuration, velocity and inputs. A
    /// residual is driven to zero, such as a hand's distance from a target or the violation of a friction
    /// cone.
    pub fn add_squares<const R: usize>(
        &mut self,
        weight: T,
        residual: &SVector<T, R>,
        (by_q, by_v, by_u): (&SMatrix<T, R, NV>, &SMatrix<T, R, NV>, &SMatrix<T, R, NU>),
    ) {
        self.add_squares_of_configuration(weight, residual, by_q);
        let (mut q_rows, mut v_rows, mut u_rows) = (transposed(by_q), transposed(by_v), transposed(by_u));
        scale(&mut q_rows, weight);
        scale(&mut v_rows, weight);
        scale(&mut u_rows, weight);
        add_product(&mut self.v, &v_rows, residual);
        add_product(&mut self.u, &u_rows, residual);
        add_product(&mut self.qv, &q_rows, by_v);
        add_product(&mut self.vv, &v_rows, by_v);
        add_product(&mut self.qu, &q_rows, by_u);
        add_product(&mut self.vu, &v_rows, by_u);
        add_product(&mut self.uu, &u_rows, by_u);
    }

    /// Adds the costs `gradient · δr + ½ δr · Hessian δr` of quantities `r`, given their derivatives with
    /// respect to configuration, velocity and inputs. The curvature of `r` is neglected (Gauss-Newton). One
    /// call treats many quantities, for example all contact forces outside their friction cones. Quantities
    /// with zero gradient and Hessian column are skipped and take no time.
    pub fn add_costs_of<const R: usize>(
        &mut self,
        gradient: &SVector<T, R>,
        hessian: &SMatrix<T, R, R>,
        (by_q, by_v, by_u): (&SMatrix<T, R, NV>, &SMatrix<T, R, NV>, &SMatrix<T, R, NU>),
    ) {
        let (mut places, mut count) = ([0; R], 0);
        for (k, (first, column)) in gradient.iter().zip(&hessian.data.0).enumerate() {
            if *first != T::zero() || column.iter().any(|x| *x != T::zero()) {
                places.iter_mut().skip(count).take(1).for_each(|place| *place = k);
                count += 1;
            }
        }
        let places = places.get(..count).unwrap_or(&[]);
        let (q_rows, v_rows, u_rows) = (transposed(by_q), transposed(by_v), transposed(by_u));
        add_product_of_some(&mut self.q, places, &q_rows, gradient);
        add_product_of_some(&mut self.v, places, &v_rows, gradient);
        add_product_of_some(&mut self.u, places, &u_rows, gradient);
        let (mut weighed, mut of_u) = (zeros(), zeros());
        add_product_of_some(&mut weighed, places, hessian, by_q);
        add_product_of_some(&mut self.qq, places, &q_rows, &weighed);
        weighed = zeros();
        add_product_of_some(&mut weighed, places, hessian, by_v);
        add_product_of_some(&mut self.qv, places, &q_rows, &weighed);
        add_product_of_some(&mut self.vv, places, &v_rows, &weighed);
        add_product_of_some(&mut of_u, places, hessian, by_u);
        add_product_of_some(&mut self.qu, places, &q_rows, &of_u);
        add_product_of_some(&mut self.vu, places, &v_rows, &of_u);
        add_product_of_some(&mut self.uu, places, &u_rows, &of_u);
    }

    /// Adds the costs `½ weight |r|²` of a residual `r` that depends on the configuration alone, see
    /// [`add_squares`](Self::add_squares).
    pub fn add_squares_of_configuration<const R: usize>(
        &mut self,
        weight: T,
        residual: &SVector<T, R>,
        by_q: &SMatrix<T, R, NV>,
    ) {
        let mut rows = transposed(by_q);
        scale(&mut rows, weight);
        add_product(&mut self.q, &rows, residual);
        add_product(&mut self.qq, &rows, by_q);
    }

    /// Returns the costs with the curvature of the step added
    /// ([`second_order`](crate::discrete::second_order), with the gradient of the cost-to-go as factors). The
    /// recursion with curvature is differential dynamic programming; without it, iLQR.
    pub fn with_curvature(&self, (qq, qv, vv, qu, vu, uu): &InputSecondOrder<T, NV, NU>) -> Self {
        Self {
            qq: self.qq + qq,
            qv: self.qv + qv,
            vv: self.vv + vv,
            qu: self.qu + qu,
            vu: self.vu + vu,
            uu: self.uu + uu,
            ..*self
        }
    }
}

impl<T: Real, const NV: usize> Value<T, NV> {
    /// Returns a cost-to-go whose gradient and Hessian are zero.
    pub fn zeros() -> Self {
        let zero = SMatrix::zeros();
        Self { q: SVector::zeros(), v: SVector::zeros(), qq: zero, qv: zero, vv: zero }
    }

    /// Returns the Hessian of the cost-to-go with respect to the state `x = (δq, δv)` as one matrix. `NX` is
    /// `2 NV`, inferred from the requested type; any other value is a compile error.
    pub fn hessian<const NX: usize>(&self) -> SMatrix<T, NX, NX> {
        const { assert!(NX == 2 * NV, "the matrix has twice as many rows as there are velocities") };
        let vq = transposed(&self.qv);
        SMatrix::from_fn(|i, j| entry_of_two_by_two_blocks([[&self.qq, &self.qv], [&vq, &self.vv]], i, j))
    }

    /// Returns the change of the cost-to-go for a state displaced by `dq` and `dv`, by its second-order
    /// model.
    pub fn at(&self, dq: &SVector<T, NV>, dv: &SVector<T, NV>) -> T {
        let quadratic = dq.dot(&product(&self.qq, dq)) + dv.dot(&product(&self.vv, dv));
        self.q.dot(dq) + self.v.dot(dv) + dq.dot(&product(&self.qv, dv)) + quadratic * constant(0.5)
    }
}

impl<T: Real, const NV: usize, const NU: usize> Policy<T, NV, NU> {
    /// Returns the policy that leaves the inputs unchanged.
    pub fn zeros() -> Self {
        Self { change: zeros(), by_q: zeros(), by_v: zeros(), expected: [T::zero(); 2] }
    }

    /// Returns the change `δu` of the inputs for a state displaced by `dq` and `dv`, with step length `α`
    /// (`length`) of a line search.
    pub fn inputs(&self, length: T, dq: &SVector<T, NV>, dv: &SVector<T, NV>) -> SVector<T, NU> {
        let mut change = self.change * length;
        add_product(&mut change, &self.by_q, dq);
        add_product(&mut change, &self.by_v, dv);
        change
    }
}

/// Returns the policy that minimises the costs of an instant to second order, and the cost-to-go before the
/// step, given the cost-to-go `after` it. `regularisation` is added to the diagonal of the Hessian with
/// respect to the inputs.
///
/// # Errors
///
/// [`Indefinite`] if that Hessian is not positive definite or a value is not finite.
pub fn backward<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    step: &Transition<T, NQ, NV, NU>,
    cost: &Quadratic<T, NV, NU>,
    after: &Value<T, NV>,
    regularisation: T,
) -> Result<(Policy<T, NV, NU>, Value<T, NV>), Indefinite> {
    let (mut policy, mut to_go) = (Policy::zeros(), *after);
    backward_into(step, cost, regularisation, &mut policy, &mut to_go)?;
    Ok((policy, to_go))
}

/// Computes [`backward`] in place: writes the policy, and replaces the cost-to-go after the step by that
/// before it. This avoids copies of the matrices of large mechanisms.
///
/// # Errors
///
/// The errors of [`backward`]; `policy` and `to_go` are then unchanged.
pub fn backward_into<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    step: &Transition<T, NQ, NV, NU>,
    cost: &Quadratic<T, NV, NU>,
    regularisation: T,
    policy: &mut Policy<T, NV, NU>,
    to_go: &mut Value<T, NV>,
) -> Result<(), Indefinite> {
    minimise_over_inputs(&mut step_cost_plus_cost_to_go(step, cost, to_go), regularisation, policy, to_go)
}

/// Computes [`backward_into`] for inputs with limits: the change of the inputs minimises the costs to second
/// order within `limits` ([`InputLimits::around`]). Inputs at a limit have no feedback gains. The search
/// begins at `policy.change`, for example that of the previous iteration, or zero. The inputs that the policy
/// returns for other states must be clamped ([`InputLimits::clamp`]). The costs-to-go do not contain this
/// clamping: if a line search fails, more regularisation reduces the gains. Source: Tassa, Mansard and
/// Todorov, *Control-limited differential dynamic programming* (2014).
///
/// # Errors
///
/// The errors of [`backward`]; `policy` and `to_go` are then unchanged.
pub fn backward_within<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    step: &Transition<T, NQ, NV, NU>,
    cost: &Quadratic<T, NV, NU>,
    regularisation: T,
    limits: &InputLimits<T, NU>,
    policy: &mut Policy<T, NV, NU>,
    to_go: &mut Value<T, NV>,
) -> Result<(), Indefinite> {
    limits::minimise_over_limited_inputs(
        &mut step_cost_plus_cost_to_go(step, cost, to_go),
        regularisation,
        limits,
        policy,
        to_go,
    )
}

/// Returns the sum of the costs of a step and the cost-to-go after it, as a function of the state before the
/// step and the inputs.
fn step_cost_plus_cost_to_go<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    step: &Transition<T, NQ, NV, NU>,
    cost: &Quadratic<T, NV, NU>,
    after: &Value<T, NV>,
) -> Quadratic<T, NV, NU> {
    let mut before = *cost;
    match &step.chained {
        Some(chain) => add_chained_cost_to_go(&mut before, step, after, chain),
        None => add_general_cost_to_go(&mut before, step, after),
    }
    before
}

/// Adds the cost-to-go after a step of any method to the costs before it.
fn add_general_cost_to_go<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    before: &mut Quadratic<T, NV, NU>,
    step: &Transition<T, NQ, NV, NU>,
    after: &Value<T, NV>,
) {
    let vq = transposed(&after.qv);
    // One block column at a time: the rows of S [A B], then their products with the rows of [A B]ᵀ.
    let (q_by_q, v_by_q) = (transposed(&step.q_by_q), transposed(&step.v_by_q));
    let (q_by_v, v_by_v) = (transposed(&step.q_by_v), transposed(&step.v_by_v));
    let (q_by_u, v_by_u) = (transposed(&step.q_by_u), transposed(&step.v_by_u));
    add_configuration_and_velocity_products(
        &mut before.qq,
        &q_by_q,
        &v_by_q,
        &cost_to_go_hessian_product(after, &vq, &step.q_by_q, &step.v_by_q),
    );
    let by_v = cost_to_go_hessian_product(after, &vq, &step.q_by_v, &step.v_by_v);
    add_configuration_and_velocity_products(&mut before.qv, &q_by_q, &v_by_q, &by_v);
    add_configuration_and_velocity_products(&mut before.vv, &q_by_v, &v_by_v, &by_v);
    let by_u = cost_to_go_hessian_product(after, &vq, &step.q_by_u, &step.v_by_u);
    add_configuration_and_velocity_products(&mut before.qu, &q_by_q, &v_by_q, &by_u);
    add_configuration_and_velocity_products(&mut before.vu, &q_by_v, &v_by_v, &by_u);
    add_configuration_and_velocity_products(&mut before.uu, &q_by_u, &v_by_u, &by_u);
    let gradient = (after.q, after.v);
    add_configuration_and_velocity_products(&mut before.q, &q_by_q, &v_by_q, &gradient);
    add_configuration_and_velocity_products(&mut before.v, &q_by_v, &v_by_v, &gradient);
    add_configuration_and_velocity_products(&mut before.u, &q_by_u, &v_by_u, &gradient);
}

/// Returns the product `S X` with the Hessian `S` of the cost-to-go: first its configuration rows, then its
/// velocity rows.
fn cost_to_go_hessian_product<T: Real, const NV: usize, const C: usize>(
    after: &Value<T, NV>,
    vq: &SMatrix<T, NV, NV>,
    q: &SMatrix<T, NV, C>,
    v: &SMatrix<T, NV, C>,
) -> (SMatrix<T, NV, C>, SMatrix<T, NV, C>) {
    let (mut of_q, mut of_v) = (product(&after.qq, q), product(vq, q));
    add_product(&mut of_q, &after.qv, v);
    add_product(&mut of_v, &after.vv, v);
    (of_q, of_v)
}

/// Adds the matrix products `q of_q + v of_v` of configuration rows and velocity rows to `sum`.
fn add_configuration_and_velocity_products<T: Real, const R: usize, const NV: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    q: &SMatrix<T, R, NV>,
    v: &SMatrix<T, R, NV>,
    (of_q, of_v): &(SMatrix<T, NV, C>, SMatrix<T, NV, C>),
) {
    add_product(sum, q, of_q);
    add_product(sum, v, of_v);
}

/// Adds the cost-to-go after a step with `q⁺ = q ⊕ h v⁺` to the costs before it. With the derivatives `G` of
/// `v⁺`, and `E` and `D` of `⊕`, the step is `A = [E 0; 0 0] + H G_x` and `B = H G_u`, `H = [h D; 1]`.
/// Therefore `W = Hᵀ S H` replaces the Hessian `S`.
fn add_chained_cost_to_go<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    before: &mut Quadratic<T, NV, NU>,
    step: &Transition<T, NQ, NV, NU>,
    after: &Value<T, NV>,
    chain: &ConfigurationVelocityRelation<T, NV>,
) {
    let (by_q, by_v, by_u) = (&step.v_by_q, &step.v_by_v, &step.v_by_u);
    let (mut q_rows, mut v_rows, mut u_rows) = (zeros(), zeros(), zeros());
    transpose_into(by_q, &mut q_rows);
    transpose_into(by_v, &mut v_rows);
    transpose_into(by_u, &mut u_rows);
    let (mut z, mut w) = (zeros(), after.vv);
    let [of_q, gradient] =
        rewrite_cost_to_go_variables::<T, NQ, NV>(&mut before.qq, &mut z, &mut w, after, chain);
    // With P = G_qᵀ W + Z the rows of q are P [G_v G_u], and the block qq is Eᵀ S_qq E + ½ (P + Z) G_q plus
    // its transpose.
    let mut rows = z;
    add_product(&mut rows, &q_rows, &w);
    add_product(&mut before.qv, &rows, by_v);
    add_product(&mut before.qu, &rows, by_u);
    add_multiple(&mut rows, T::one(), &z);
    let mut twice = zeros();
    add_product(&mut twice, &rows, by_q);
    add_with_transpose(&mut before.qq, constant(0.5), &twice);
    let mut rows = zeros();
    add_product(&mut rows, &v_rows, &w);
    add_product(&mut before.vv, &rows, by_v);
    add_product(&mut before.vu, &rows, by_u);
    let mut columns = zeros();
    add_product(&mut columns, &w, by_u);
    add_product(&mut before.uu, &u_rows, &columns);
    add_multiple(&mut before.q, T::one(), &of_q);
    add_product(&mut before.q, &q_rows, &gradient);
    add_product(&mut before.v, &v_rows, &gradient);
    add_product(&mut before.u, &u_rows, &gradient);
}

/// Rewrites the cost-to-go as a function of the configuration before the step and the velocity after it,
/// which together determine the configuration after the step. Sets `z` (zero on entry) to `Eᵀ (h S_qq D +
/// S_qv)` and `w` (`S_vv` on entry) to `Hᵀ S H`, adds `Eᵀ S_qq E` to `qq`, and returns `Eᵀ s_q` and `Hᵀ s`.
fn rewrite_cost_to_go_variables<T: Real, const NQ: usize, const NV: usize>(
    qq: &mut SMatrix<T, NV, NV>,
    z: &mut SMatrix<T, NV, NV>,
    w: &mut SMatrix<T, NV, NV>,
    after: &Value<T, NV>,
    chain: &ConfigurationVelocityRelation<T, NV>,
) -> [SVector<T, NV>; 2] {
    let h = chain.period();
    // With X = Dᵀ (S_qv + ½ h S_qq D), W is S_vv + h (X + Xᵀ).
    let mut half = zeros();
    if NQ == NV {
        add_multiple(qq, T::one(), &after.qq);
        write_scaled_sum(&after.qv, h, &after.qq, z);
        write_scaled_sum(&after.qv, h * constant(0.5), &after.qq, &mut half);
        add_with_transpose(w, h, &half);
        return [after.q, after.v + after.q * h];
    }
    let [e, d] = chain.nearly_identity_matrices();
    let mut moved = after.qq;
    d.right_multiply(&mut moved);
    write_scaled_sum(&after.qv, h, &moved, z);
    write_scaled_sum(&after.qv, h * constant(0.5), &moved, &mut half);
    let (mut of_d, mut of_e) = (zeros(), zeros());
    let (back_by_d, back_by_e) = (d.transposed(&mut of_d), e.transposed(&mut of_e));
    back_by_d.left_multiply(&mut half);
    add_with_transpose(w, h, &half);
    back_by_e.left_multiply(z);
    moved = after.qq;
    e.right_multiply(&mut moved);
    back_by_e.left_multiply(&mut moved);
    add_multiple(qq, T::one(), &moved);
    let (mut of_q, mut of_dv) = (after.q, after.q);
    back_by_e.left_multiply(&mut of_q);
    back_by_d.left_multiply(&mut of_dv);
    [of_q, after.v + of_dv * h]
}

/// Writes the change of the inputs that minimises the costs, with its feedback gains, and the resulting
/// cost-to-go.
fn minimise_over_inputs<T: Real, const NV: usize, const NU: usize>(
    before: &mut Quadratic<T, NV, NU>,
    regularisation: T,
    policy: &mut Policy<T, NV, NU>,
    to_go: &mut Value<T, NV>,
) -> Result<(), Indefinite> {
    let Quadratic { q, v, u, qq, qv, vv, qu, vu, uu } = before;
    let (factor, pivots) = factors(uu, regularisation).map_err(|input| Indefinite { input })?;
    let Policy { change, by_q, by_v, expected } = policy;
    *change = *u;
    solve(&factor, &pivots, change);
    let (mut of_q, mut of_v) = (zeros(), zeros());
    solve_rows_into(&factor, &pivots, qu, &mut of_q);
    solve_rows_into(&factor, &pivots, vu, &mut of_v);
    transpose_into(&of_q, by_q);
    transpose_into(&of_v, by_v);
    let linear = u.dot(change);
    // The change satisfies (Q_uu + r) change = −Q_u.
    *expected = [linear, (linear + regularisation * change.dot(change)) * constant(-0.5)];
    // With K = −Q_uu⁻¹ Q_ux the cost-to-go is Q_xx + Q_xu K; with regularisation r, r Kᵀ K is subtracted.
    if regularisation != T::zero() {
        add_multiple(qu, -regularisation, &of_q);
        add_multiple(vu, -regularisation, &of_v);
    }
    add_product(q, qu, change);
    add_product(v, vu, change);
    add_product(qq, qu, by_q);
    add_product(qv, qu, by_v);
    add_product(vv, vu, by_v);
    (to_go.q, to_go.v, to_go.qv) = (*q, *v, *qv);
    symmetric_into(qq, &mut to_go.qq);
    symmetric_into(vv, &mut to_go.vv);
    Ok(())
}
