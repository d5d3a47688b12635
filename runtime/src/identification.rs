//! Mass properties of a mechanism from identified base parameters, such that they are physically consistent.
//!
//! Motions and forces determine only the base parameters, which are fewer than the mass properties of the
//! links: infinitely many mass properties have the same base parameters. [`put_back`] selects the mass
//! properties nearest to those known before, in a distance between bodies that does not depend on units or
//! frames (Lee, Wensing and Park, *Geometric robot dynamic identification: a convex programming approach*,
//! 2020). The result is physically consistent by construction.

use crate::private::{constant, epsilon, to_f64};
use crate::{Inertial, Real};
use core::fmt;
use nalgebra::{Cholesky, Matrix3, Matrix4, SMatrix, SVector, Vector3};

/// Mechanism in which the mass properties of `N` links are parameters, with `B` base parameters. It has the
/// options `parameters = inertial` and `regressor`.
#[diagnostic::on_unimplemented(
    message = "identified values cannot be written to `{Self}`",
    label = "expected a mechanism whose links' mass properties are parameters",
    note = "write `#[mechanism(urdf = \"…\", parameters = inertial, regressor)]`"
)]
pub trait Identifiable<const N: usize, const B: usize> {
    /// Scalar type of the mechanism to be identified.
    type Scalar: Real;

    /// Returns the mass properties of the links, in the order of `LINKS`.
    fn inertials(&self) -> [Inertial<Self::Scalar>; N];

    /// Sets the mass properties of the links, in the order of `LINKS`.
    fn set_inertials(&mut self, links: &[Inertial<Self::Scalar>; N]);

    /// Returns the base parameters for the current mass properties, in the order of `BASE_PARAMETERS`.
    fn own_base_parameters(&self) -> SVector<Self::Scalar, B>;
}

/// Error for base parameters that cannot be converted to mass properties.
#[derive(Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum PutBackError {
    /// Error: the initial mass properties of a link are impossible for a body. The mass is not positive, or
    /// no body has the inertia.
    Prior {
        /// Index of the link, in the order of `LINKS`.
        link: usize,
    },
    /// Error: no physically consistent mass properties have these base parameters, or hardly any.
    NotPhysical {
        /// Largest remaining difference between a base parameter and its target, in units of the parameter.
        residual: f64,
    },
    /// Error: a base parameter is infinite or NaN.
    NotFinite,
}

crate::debug_as_display!(PutBackError);

impl fmt::Display for PutBackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Prior { link } => write!(f, "link {link} has no mass properties of a body to begin with"),
            Self::NotPhysical { residual } => {
                write!(f, "no bodies have these base parameters: the residual is {residual}")
            }
            Self::NotFinite => f.write_str("a base parameter is not a finite number"),
        }
    }
}

impl core::error::Error for PutBackError {}

/// Maximum number of Newton iterations in the search for mass properties.
const MOST_ITERATIONS: usize = 200;

/// Sets the links' mass properties to those nearest to the current ones that have the base parameters `base`.
/// The result is physically consistent for any noise in `base`. If only some of the links are parameters,
/// they may not reach `base`, which is then approximated.
///
/// With the pseudo-inertia `P = [Σ, h; hᵀ, m]` of each link (`Σ` the second moments of its mass, `h` the
/// first) the function minimises `Σ tr(P₀⁻¹ P) − log det P` subject to the base parameters, which are linear
/// in `P`. This convex problem is solved by a damped Newton method with at most 200 iterations. Robots need a
/// few dozen iterations, each with about `B² N` products and a factorisation of a `B × B` matrix. No memory
/// is allocated; matrices of `11 N B + 2 B²` numbers are on the stack.
///
/// # Errors
///
/// [`PutBackError::NotPhysical`] if no bodies have these base parameters. This occurs for motions that excite
/// some of the parameters too little: regularise the regression with the prior for those. The mechanism is
/// then unchanged.
pub fn put_back<M, const N: usize, const B: usize>(
    mechanism: &mut M,
    base: &SVector<M::Scalar, B>,
) -> Result<(), PutBackError>
where
    M: Identifiable<N, B>,
{
    write_base_parameters_back(mechanism, base, None)
}

/// Approximates base parameters that no bodies have, for example because of noise, as well as physically
/// consistent mass properties allow; see [`put_back`]. `softness`, greater than zero, is the squared error of
/// a base parameter relative to the squared change of the links' mass properties: with 1e-6, changing all
/// mass properties by their own magnitude costs as much as a relative error of a thousandth.
///
/// # Errors
///
/// The errors of [`put_back`]; [`PutBackError::NotPhysical`] only for a softness that is not positive, or so
/// small that 200 iterations do not suffice.
pub fn approach<M, const N: usize, const B: usize>(
    mechanism: &mut M,
    base: &SVector<M::Scalar, B>,
    softness: M::Scalar,
) -> Result<(), PutBackError>
where
    M: Identifiable<N, B>,
{
    write_base_parameters_back(mechanism, base, Some(softness))
}

fn write_base_parameters_back<M, const N: usize, const B: usize>(
    mechanism: &mut M,
    base: &SVector<M::Scalar, B>,
    softness: Option<M::Scalar>,
) -> Result<(), PutBackError>
where
    M: Identifiable<N, B>,
{
    if base.iter().any(|x| *x * nalgebra::zero() != nalgebra::zero()) {
        return Err(PutBackError::NotFinite);
    }
    let before = mechanism.inertials();
    let mut prior = [Matrix4::zeros(); N];
    for (k, (link, prior)) in before.iter().zip(&mut prior).enumerate() {
        *prior = pseudo_inertia(link).ok_or(PutBackError::Prior { link: k })?;
    }
    let map = base_parameter_map(mechanism);
    mechanism.set_inertials(&before);
    let found = least_changed_pseudo_inertias(&map, &prior, base, softness)?;
    mechanism.set_inertials(&found.map(|p| inertial_from_pseudo_inertia(&p)));
    Ok(())
}

/// Matrices for each base parameter and link.
type BaseParameterFactors<T, const N: usize, const B: usize> = [[Matrix4<T>; N]; B];

/// Base parameters as an affine function of the links' pseudo-inertias: a matrix for each base parameter and
/// link, and the constant term.
struct AffineParameterMap<T, const N: usize, const B: usize> {
    factors: BaseParameterFactors<T, N, B>,
    rest: SVector<T, B>,
}

/// Returns the base parameters as an affine function of the pseudo-inertias, computed from their values for
/// pseudo-inertias with a single nonzero entry.
fn base_parameter_map<M, const N: usize, const B: usize>(
    mechanism: &mut M,
) -> AffineParameterMap<M::Scalar, N, B>
where
    M: Identifiable<N, B>,
{
    let (o, one): (M::Scalar, M::Scalar) = (nalgebra::zero(), nalgebra::one());
    let nothing = [Inertial::point(o, [o; 3]); N];
    mechanism.set_inertials(&nothing);
    let rest = mechanism.own_base_parameters();
    let noise = rest.abs() * (epsilon::<M::Scalar>() * constant(64.0));
    let mut factors = [[Matrix4::zeros(); N]; B];
    for k in 0..N {
        for i in 0..4 {
            for j in i..4 {
                let mut p = Matrix4::zeros();
                (p[(i, j)], p[(j, i)]) = (one, one);
                // First moments require a mass; the contribution of the mass alone is subtracted.
                let (massive, alone) = if i < 3 && j == 3 { (one, true) } else { (o, false) };
                if alone {
                    p[(3, 3)] = massive;
                }
                let mut links = nothing;
                links[k] = inertial_from_pseudo_inertia(&p);
                mechanism.set_inertials(&links);
                let mut value = mechanism.own_base_parameters() - rest;
                if alone {
                    links[k] = Inertial::point(one, [o; 3]);
                    mechanism.set_inertials(&links);
                    value -= mechanism.own_base_parameters() - rest;
                }
                let share = if i == j { one } else { constant(0.5) };
                let size = value.abs();
                for (r, row) in factors.iter_mut().enumerate() {
                    // Rounding residue of the subtraction counts as zero.
                    let value = if size[r] > noise[r] { value[r] * share } else { o };
                    (row[k][(i, j)], row[k][(j, i)]) = (value, value);
                }
            }
        }
    }
    AffineParameterMap { factors, rest }
}

impl<T: Real, const N: usize, const B: usize> AffineParameterMap<T, N, B> {
    fn linear_part_value(&self, of: &[Matrix4<T>; N]) -> SVector<T, B> {
        SVector::from_fn(|i, _| inner_product(&self.factors[i], of))
    }
}

/// Returns the inner product of two lists of matrices: the sum of the products of all entries.
fn inner_product<T: Real, const N: usize>(a: &[Matrix4<T>; N], b: &[Matrix4<T>; N]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + a.dot(b))
}

/// Returns the pseudo-inertias that have the base parameters and change least, by Newton's method. A step
/// shorter than one in the norm of the Hessian keeps pseudo-inertias positive definite (Boyd and
/// Vandenberghe, *Convex Optimization*, 2004, ch. 9.6).
fn least_changed_pseudo_inertias<T: Real, const N: usize, const B: usize>(
    map: &AffineParameterMap<T, N, B>,
    prior: &[Matrix4<T>; N],
    base: &SVector<T, B>,
    softness: Option<T>,
) -> Result<[Matrix4<T>; N], PutBackError> {
    let prior_inverse = prior.map(|p| inverse_by_cholesky(&p));
    let mut p = *prior;
    let not_physical_error = |p: &[Matrix4<T>; N]| {
        let residual = (map.linear_part_value(p) + map.rest - base).amax();
        Err(PutBackError::NotPhysical { residual: to_f64(residual) })
    };
    let enough = epsilon::<T>().cbrt() * constant(4.0);
    let mut diagonal: Option<SVector<T, B>> = None;
    let mut multipliers = SVector::zeros();
    // Continuation from a large softness, which converges easily, to the requested one.
    let least = softness.unwrap_or(T::one());
    let mut share = T::one().max(least);
    if least * T::zero() != T::zero() || least <= T::zero() {
        return not_physical_error(&p);
    }
    for _ in 0..MOST_ITERATIONS {
        // Newton step: P − P P₀⁻¹ P − Σ νᵢ P Aᵢ P.
        let free: [Matrix4<T>; N] = core::array::from_fn(|k| p[k] - p[k] * prior_inverse[k] * p[k]);
        let mut moved = [[Matrix4::zeros(); N]; B];
        for (moved, factors) in moved.iter_mut().zip(&map.factors) {
            for ((moved, a), p) in moved.iter_mut().zip(factors).zip(&p) {
                *moved = p * a * p;
            }
        }
        let mut s = SMatrix::<T, B, B>::from_fn(|i, j| {
            if j <= i { inner_product(&map.factors[i], &moved[j]) } else { T::zero() }
        });
        // Base parameters, or combinations of them, that these links do not reach are satisfied
        // approximately.
        let unit = *diagonal.get_or_insert_with(|| regularisation_diagonal(&s, softness.map(|_| T::one())));
        let soft = unit * share;
        for (i, soft) in soft.iter().enumerate() {
            s[(i, i)] += *soft;
        }
        let Some(factor) = Cholesky::new(s) else { return not_physical_error(&p) };
        let ahead: [Matrix4<T>; N] = core::array::from_fn(|k| p[k] + free[k]);
        let mut nu = map.linear_part_value(&ahead) + map.rest - base;
        if softness.is_none() {
            // Augmented Lagrangian: over the iterations, all base parameters that can be satisfied are
            // satisfied.
            nu += soft.component_mul(&multipliers);
        }
        factor.solve_mut(&mut nu);
        multipliers = nu;
        let mut step = free;
        for (moved, nu) in moved.iter().zip(&nu) {
            for (step, moved) in step.iter_mut().zip(moved) {
                *step -= moved * *nu;
            }
        }
        let mut length = T::zero();
        for (p, step) in p.iter().zip(&step) {
            let relative = inverse_by_cholesky(p) * step;
            length += (relative * relative).trace();
        }
        let length = length.max(T::zero()).sqrt();
        if length * T::zero() != T::zero() {
            return not_physical_error(&p);
        }
        let part = if length < constant(0.25) { T::one() } else { (T::one() + length).recip() };
        for (p, step) in p.iter_mut().zip(&step) {
            *p += step * part;
            *p = (*p + p.transpose()) * constant::<T>(0.5);
        }
        if share > least {
            if length < T::one() {
                share = least.max(share * constant(0.25));
            }
        } else if length < enough {
            let holds = (map.linear_part_value(&p) + map.rest - base).amax() <= base.amax() * enough;
            let exact = soft.iter().all(|x| *x == T::zero());
            return if holds || !exact { Ok(p) } else { not_physical_error(&p) };
        }
    }
    not_physical_error(&p)
}

/// Returns the diagonal regularisation of the multipliers' matrix: `asked` (relative to the diagonal), if
/// given. Otherwise it is zero for full rank, so that base parameters are met exactly, and `√ε` for a
/// singular matrix.
fn regularisation_diagonal<T: Real, const B: usize>(s: &SMatrix<T, B, B>, asked: Option<T>) -> SVector<T, B> {
    let regular = asked.is_none()
        && Cholesky::new(*s).is_some_and(|factor| {
            let l = factor.l_dirty();
            (0..B).all(|i| l[(i, i)] * l[(i, i)] > s[(i, i)] * epsilon::<T>() * constant(1e2))
        });
    if regular {
        return SVector::zeros();
    }
    let share = asked.unwrap_or(epsilon::<T>().sqrt());
    s.diagonal().map(|own| if own == T::zero() { T::one() } else { own * share })
}

/// Returns the inverse of a positive definite matrix, from its Cholesky factorisation.
fn inverse_by_cholesky<T: Real>(p: &Matrix4<T>) -> Matrix4<T> {
    Cholesky::new(*p).map_or(Matrix4::repeat(constant(f64::NAN)), |factor| factor.inverse())
}

/// Returns the pseudo-inertia of a link about its origin (Wensing, Kim and Slotine 2018). A link at the bound
/// of physical consistency (a rod, a plate, a point) is replaced by a nearly equal body. `None` if the mass
/// is not positive or the inertia is that of no body.
fn pseudo_inertia<T: Real>(link: &Inertial<T>) -> Option<Matrix4<T>> {
    let Inertial { mass: m, com: [x, y, z], ixx, ixy, ixz, iyy, iyz, izz } = *link;
    let half = (ixx + iyy + izz) * constant(0.5);
    // A hundredth of the second moments, plus the second moments of a radius of one millimetre.
    let least = half.max(T::zero()) * constant(0.01) + m * constant(1e-6);
    let mut central = Matrix3::new(half - ixx, -ixy, -ixz, -ixy, half - iyy, -iyz, -ixz, -iyz, half - izz);
    // Also rejects a mass that is NaN.
    if m.partial_cmp(&T::zero()) != Some(core::cmp::Ordering::Greater) {
        return None;
    }
    if Cholesky::new(central - Matrix3::identity() * (least * constant(0.01))).is_none() {
        central += Matrix3::identity() * least;
    }
    Cholesky::new(central)?;
    let c = Vector3::new(x, y, z);
    let second = central + c * c.transpose() * m;
    let mut p = Matrix4::zeros();
    p.fixed_view_mut::<3, 3>(0, 0).copy_from(&second);
    for k in 0..3 {
        (p[(k, 3)], p[(3, k)]) = (m * c[k], m * c[k]);
    }
    p[(3, 3)] = m;
    Some(p)
}

/// Returns the mass properties of a link from its pseudo-inertia, a 4 × 4 matrix.
fn inertial_from_pseudo_inertia<T: Real>(p: &Matrix4<T>) -> Inertial<T> {
    let (xx, yy, zz) = (p[(0, 0)], p[(1, 1)], p[(2, 2)]);
    Inertial::from_standard([
        p[(3, 3)],
        p[(0, 3)],
        p[(1, 3)],
        p[(2, 3)],
        yy + zz,
        -p[(0, 1)],
        xx + zz,
        -p[(0, 2)],
        -p[(1, 2)],
        xx + yy,
    ])
}
