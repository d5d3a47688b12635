//! The recursion of optimal control in blocks of `NV` by `NV`: what iterative linear-quadratic regulators (iLQR), differential
//! dynamic programming (DDP) and linear-quadratic regulators do at each instant, from the last to the first.
//!
//! With the step `x⁺ = A x + B δu` of a mechanism ([`Transition`]), the costs of an instant and those to go after it
//! ([`Value`]), [`backward`] finds the change of inputs that is best to second order, and the costs to go from there. Sources:
//! Mayne, *A second-order gradient method for determining optimal trajectories of non-linear discrete-time systems* (1966);
//! Tassa, Erez and Todorov, *Synthesis and stabilization of complex behaviors through online trajectory optimization* (2012).
//!
//! Nothing is allocated: trajectories are arrays of the caller.
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
//! // Costs of state and input, over so long a time that the gain no longer changes: the linear-quadratic regulator.
//! let mut cost = Quadratic::zeros();
//! (cost.qq[0], cost.uu[0]) = (1.0, 1.0);
//! let (mut policy, mut to_go) = backward(&step, &cost, &Value::zeros(), 0.0)?;
//! for _ in 0..2000 {
//!     (policy, to_go) = backward(&step, &cost, &to_go, 0.0)?;
//! }
//! // For a period that tends to zero they are −1 and −√(2 m) (Bryson and Ho, *Applied Optimal Control*, 1975, § 5.2).
//! let gain = [policy.by_q[0], policy.by_v[0]];
//! assert!((gain[0] + 1.0).abs() < 0.02 && (gain[1] + 2.0).abs() < 0.04, "{gain:?}");
//!
//! // What it costs to bring the cart back from a metre off, moving, is what the costs to go say.
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
    solve_rows_into, sum_into, symmetric_into, transpose_into, transposed, zeros,
};
use crate::derivatives::entry;
use crate::discrete::{Chained, Transition};
use crate::private::constant;
use crate::{InputSecondOrder, Real};
use nalgebra::{SMatrix, SVector};

/// Costs to second order about a state and inputs: `gradient · (δq, δv, δu) + ½ (δq, δv, δu) · Hessian (δq, δv, δu)`, in units of
/// the user's. Displacements of ball and free joints are in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic<T, const NV: usize, const NU: usize> {
    /// Gradient by configuration.
    pub q: SVector<T, NV>,
    /// Gradient by velocity.
    pub v: SVector<T, NV>,
    /// Gradient by inputs.
    pub u: SVector<T, NU>,
    /// By configuration twice.
    pub qq: SMatrix<T, NV, NV>,
    /// By configuration (rows) and velocity.
    pub qv: SMatrix<T, NV, NV>,
    /// By velocity twice.
    pub vv: SMatrix<T, NV, NV>,
    /// By configuration (rows) and inputs.
    pub qu: SMatrix<T, NV, NU>,
    /// By velocity (rows) and inputs.
    pub vu: SMatrix<T, NV, NU>,
    /// By inputs twice.
    pub uu: SMatrix<T, NU, NU>,
}

/// Costs to go from a state on, to second order: [`Quadratic`] without inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value<T, const NV: usize> {
    /// Gradient by configuration.
    pub q: SVector<T, NV>,
    /// Gradient by velocity.
    pub v: SVector<T, NV>,
    /// By configuration twice.
    pub qq: SMatrix<T, NV, NV>,
    /// By configuration (rows) and velocity.
    pub qv: SMatrix<T, NV, NV>,
    /// By velocity twice.
    pub vv: SMatrix<T, NV, NV>,
}

/// How the inputs change: `δu = α change + by_q δq + by_v δv`, with the length `α` of a line search, 1 for all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Policy<T, const NV: usize, const NU: usize> {
    /// The change that is best to second order.
    pub change: SVector<T, NU>,
    /// The gain on displacements of the configuration.
    pub by_q: SMatrix<T, NU, NV>,
    /// The gain on changes of velocity.
    pub by_v: SMatrix<T, NU, NV>,
    /// What `α change` adds to the costs: `α` times the first and `α²` times the second of these.
    pub expected: [T; 2],
}

/// Why there is no best change of inputs: the costs are not convex in them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Indefinite {
    /// The input where the factorisation of the Hessian by inputs meets a pivot that is not positive.
    pub input: usize,
}

/// The text of `Display`, which `main` prints of an error that it returns.
impl core::fmt::Debug for Indefinite {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        core::fmt::Display::fmt(self, f)
    }
}

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
    /// No costs.
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

    /// Adds the costs `½ weight |r|²` of a residual `r` with its derivatives by configuration, velocity and inputs, without its curvature
    /// (Gauss and Newton): of what is to be met, such as a place for a hand, or forces of contacts in their cone.
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

    /// Adds the costs `gradient · δr + ½ δr · Hessian δr` of numbers with derivatives by configuration, velocity and inputs, without the
    /// curvature of these (Gauss and Newton): of forces of contacts that are outside of their cones, say, many at once. Numbers without
    /// costs, whose entries are zero, take no time.
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

    /// [`add_squares`](Self::add_squares) of a residual of the configuration alone.
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

    /// With the curvature of the step besides ([`second_order`](crate::discrete::second_order), with the gradient of the costs to
    /// go as factors): differential dynamic programming; without it, iLQR.
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
    /// No costs.
    pub fn zeros() -> Self {
        let zero = SMatrix::zeros();
        Self { q: SVector::zeros(), v: SVector::zeros(), qq: zero, qv: zero, vv: zero }
    }

    /// The Hessian by `x = (δq, δv)` in one matrix; `NX` is `2 NV`, which the type that is asked for says; any other does not
    /// compile.
    pub fn hessian<const NX: usize>(&self) -> SMatrix<T, NX, NX> {
        const { assert!(NX == 2 * NV, "the matrix has twice as many rows as there are velocities") };
        let vq = transposed(&self.qv);
        SMatrix::from_fn(|i, j| entry([[&self.qq, &self.qv], [&vq, &self.vv]], i, j))
    }

    /// What a state that is off by `dq` and `dv` costs more.
    pub fn at(&self, dq: &SVector<T, NV>, dv: &SVector<T, NV>) -> T {
        let quadratic = dq.dot(&product(&self.qq, dq)) + dv.dot(&product(&self.vv, dv));
        self.q.dot(dq) + self.v.dot(dv) + dq.dot(&product(&self.qv, dv)) + quadratic * constant(0.5)
    }
}

impl<T: Real, const NV: usize, const NU: usize> Policy<T, NV, NU> {
    /// Inputs that stay as they are.
    pub fn zeros() -> Self {
        Self { change: zeros(), by_q: zeros(), by_v: zeros(), expected: [T::zero(); 2] }
    }

    /// The change `δu` of the inputs for a state that is off by `dq` and `dv`, with the length `α` of a line search.
    pub fn inputs(&self, length: T, dq: &SVector<T, NV>, dv: &SVector<T, NV>) -> SVector<T, NU> {
        let mut change = self.change * length;
        add_product(&mut change, &self.by_q, dq);
        add_product(&mut change, &self.by_v, dv);
        change
    }
}

/// The change of inputs at an instant that is best to second order, and the costs to go from there, by those after the step;
/// `regularisation` is added to the diagonal of the Hessian by inputs.
///
/// # Errors
///
/// [`Indefinite`] where that Hessian is not positive definite, also where something is not finite.
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

/// [`backward`] into a policy, with costs to go after the step that become those before it: the matrices of large mechanisms are long
/// to copy.
///
/// # Errors
///
/// Those of [`backward`]; policy and costs stay as they are then.
pub fn backward_into<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    step: &Transition<T, NQ, NV, NU>,
    cost: &Quadratic<T, NV, NU>,
    regularisation: T,
    policy: &mut Policy<T, NV, NU>,
    to_go: &mut Value<T, NV>,
) -> Result<(), Indefinite> {
    // Costs before the step by state and inputs, those after it included.
    let mut before = *cost;
    match &step.chained {
        Some(chain) => chained(&mut before, step, to_go, chain),
        None => general(&mut before, step, to_go),
    }
    minimised(&mut before, regularisation, policy, to_go)
}

/// For any step.
fn general<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    before: &mut Quadratic<T, NV, NU>,
    step: &Transition<T, NQ, NV, NU>,
    after: &Value<T, NV>,
) {
    let vq = transposed(&after.qv);
    // Column by column of blocks: the rows of S [A B], then what the rows of [A B]ᵀ make of them.
    let (q_by_q, v_by_q) = (transposed(&step.q_by_q), transposed(&step.v_by_q));
    let (q_by_v, v_by_v) = (transposed(&step.q_by_v), transposed(&step.v_by_v));
    let (q_by_u, v_by_u) = (transposed(&step.q_by_u), transposed(&step.v_by_u));
    add_both(&mut before.qq, &q_by_q, &v_by_q, &rows(after, &vq, &step.q_by_q, &step.v_by_q));
    let by_v = rows(after, &vq, &step.q_by_v, &step.v_by_v);
    add_both(&mut before.qv, &q_by_q, &v_by_q, &by_v);
    add_both(&mut before.vv, &q_by_v, &v_by_v, &by_v);
    let by_u = rows(after, &vq, &step.q_by_u, &step.v_by_u);
    add_both(&mut before.qu, &q_by_q, &v_by_q, &by_u);
    add_both(&mut before.vu, &q_by_v, &v_by_v, &by_u);
    add_both(&mut before.uu, &q_by_u, &v_by_u, &by_u);
    let gradient = (after.q, after.v);
    add_both(&mut before.q, &q_by_q, &v_by_q, &gradient);
    add_both(&mut before.v, &q_by_v, &v_by_v, &gradient);
    add_both(&mut before.u, &q_by_u, &v_by_u, &gradient);
}

/// The rows of configuration and velocity of `S X`.
fn rows<T: Real, const NV: usize, const C: usize>(
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

/// Adds the products with the rows of configuration and velocity.
fn add_both<T: Real, const R: usize, const NV: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    q: &SMatrix<T, R, NV>,
    v: &SMatrix<T, R, NV>,
    (of_q, of_v): &(SMatrix<T, NV, C>, SMatrix<T, NV, C>),
) {
    add_product(sum, q, of_q);
    add_product(sum, v, of_v);
}

/// For a step with `q⁺ = q ⊕ h v⁺`: with `G` the derivatives of `v⁺`, and those `E` and `D` of `⊕`, `A = [E 0; 0 0] + H G_x` and
/// `B = H G_u`, `H = [h D; 1]`, so that `W = Hᵀ S H` takes the place of `S`.
fn chained<T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    before: &mut Quadratic<T, NV, NU>,
    step: &Transition<T, NQ, NV, NU>,
    after: &Value<T, NV>,
    chain: &Chained<T, NV>,
) {
    let (by_q, by_v, by_u) = (&step.v_by_q, &step.v_by_v, &step.v_by_u);
    let (mut q_rows, mut v_rows, mut u_rows) = (zeros(), zeros(), zeros());
    transpose_into(by_q, &mut q_rows);
    transpose_into(by_v, &mut v_rows);
    transpose_into(by_u, &mut u_rows);
    let (mut z, mut w) = (zeros(), after.vv);
    let [of_q, gradient] = link::<T, NQ, NV>(&mut before.qq, &mut z, &mut w, after, chain);
    // With P = G_qᵀ W + Z the rows of q are P [G_v G_u], and by q twice Eᵀ S_qq E + ½ (P + Z) G_q with its transpose.
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

/// The costs to go by the configuration before a step and by the velocity after it, which the configuration after it follows: makes
/// `z` of nothing `Eᵀ (h S_qq D + S_qv)` and `w` of `S_vv` `Hᵀ S H`, adds `Eᵀ S_qq E` to the costs by configuration, and returns `Eᵀ s_q`
/// and `Hᵀ s`.
fn link<T: Real, const NQ: usize, const NV: usize>(
    qq: &mut SMatrix<T, NV, NV>,
    z: &mut SMatrix<T, NV, NV>,
    w: &mut SMatrix<T, NV, NV>,
    after: &Value<T, NV>,
    chain: &Chained<T, NV>,
) -> [SVector<T, NV>; 2] {
    let h = chain.period();
    // With X = Dᵀ (S_qv + ½ h S_qq D), W is S_vv + h (X + Xᵀ).
    let mut half = zeros();
    if NQ == NV {
        add_multiple(qq, T::one(), &after.qq);
        sum_into(&after.qv, h, &after.qq, z);
        sum_into(&after.qv, h * constant(0.5), &after.qq, &mut half);
        add_with_transpose(w, h, &half);
        return [after.q, after.v + after.q * h];
    }
    let [e, d] = chain.nearly();
    let mut moved = after.qq;
    d.follow(&mut moved);
    sum_into(&after.qv, h, &moved, z);
    sum_into(&after.qv, h * constant(0.5), &moved, &mut half);
    let (mut of_d, mut of_e) = (zeros(), zeros());
    let (back_by_d, back_by_e) = (d.transposed(&mut of_d), e.transposed(&mut of_e));
    back_by_d.lead(&mut half);
    add_with_transpose(w, h, &half);
    back_by_e.lead(z);
    moved = after.qq;
    e.follow(&mut moved);
    back_by_e.lead(&mut moved);
    add_multiple(qq, T::one(), &moved);
    let (mut of_q, mut of_dv) = (after.q, after.q);
    back_by_e.lead(&mut of_q);
    back_by_d.lead(&mut of_dv);
    [of_q, after.v + of_dv * h]
}

/// The best change of the inputs, and what the costs then are.
fn minimised<T: Real, const NV: usize, const NU: usize>(
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
    // (Q_uu + r) change = −Q_u.
    *expected = [linear, (linear + regularisation * change.dot(change)) * constant(-0.5)];
    // With K = −Q_uu⁻¹ Q_ux the costs to go are Q_xx + Q_xu K; with regularisation r, less by r Kᵀ K.
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
