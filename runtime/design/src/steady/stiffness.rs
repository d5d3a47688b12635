//! Stability of equilibria by the energy criterion.

use super::linear::{LinearisedMotion, linearise_about_steady_state};
use super::{SteadyState, Trim};
use crate::Error;
use crate::matrices::symmetric_part;
use linkwork::Derivatives;
use nalgebra::DMatrix;

/// Fraction of the largest curvature of the potential below which a curvature counts as zero.
const FLAT: f64 = 1e-9;

/// Fraction of the stiffness above which its skew-symmetric part is not rounding error.
const SKEW: f64 = 1e-7;

/// Stiffness about an equilibrium: the Hessian of the potential on the constraint manifold, in independent
/// coordinates.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Stiffness {
    /// Stiffness matrix `K`: N/m, N·m/rad or N, depending on the units of the two displacements.
    pub matrix: DMatrix<f64>,
    /// Names of the independent coordinates, which are the names of their velocities.
    pub coordinates: Vec<&'static str>,
    /// Stationary values of `xᵀ K x / xᵀ M x`, 1/s², in ascending order: squares of the undamped natural
    /// frequencies, with stiffness `K` and mass matrix `M`.
    pub curvatures: Vec<f64>,
    /// Ratio of the largest entry of the skew-symmetric part of the stiffness `K` to the largest entry of
    /// `K`. It is rounding error if the forces have a potential.
    pub asymmetry: f64,
}

/// Stability of an equilibrium by the theorem of Lagrange and Dirichlet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Verdict {
    /// The potential has a strict minimum, so that the equilibrium is stable, and dissipation does not change
    /// that.
    Stable,
    /// The potential decreases in some direction, so that the equilibrium is unstable without gyroscopic
    /// forces, and with complete dissipation for any gyroscopic forces (Kelvin and Chetaev).
    Unstable,
    /// The potential is constant to second order in some direction, so that terms of higher order decide on
    /// stability.
    Undecided,
    /// The forces have no potential, so that the [modes](Trim::linear_system) decide on stability.
    NotConservative,
}

impl Stiffness {
    /// Returns the stability of the equilibrium. It requires that velocity-dependent forces dissipate energy
    /// or do no work (Merkin, *Introduction to the Theory of Stability*, 1997, ch. 3 and 6).
    pub fn verdict(&self) -> Verdict {
        let most = self.curvatures.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let least = self.curvatures.first().copied().unwrap_or(f64::INFINITY);
        if self.asymmetry > SKEW {
            Verdict::NotConservative
        } else if least > FLAT * most {
            Verdict::Stable
        } else if least < -FLAT * most {
            Verdict::Unstable
        } else {
            Verdict::Undecided
        }
    }
}

impl<M, const NQ: usize, const NV: usize, const NU: usize> Trim<'_, M, NQ, NV, NU>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64>,
{
    /// Computes the stiffness about an equilibrium at constant inputs, which decides on stability by energy.
    /// For a mechanism that is driven to rotate at constant speed, it is the stiffness of the amended
    /// potential `U − T₀` (Meirovitch, *Methods of Analytical Dynamics*, 1970, § 6.7).
    ///
    /// # Errors
    ///
    /// [`Error::NoPotential`] for a moving mechanism, with nonholonomic constraints (rolling), with
    /// acceleration-dependent forces whose effective mass matrix is not symmetric, and with states of first
    /// order. In these cases, [`linear_system`](Trim::linear_system) decides on stability.
    /// [`Error::Indefinite`] if the mass matrix is not positive definite.
    pub fn stiffness(&self, found: &SteadyState<NQ, NV, NU>) -> Result<Stiffness, Error> {
        let LinearisedMotion { coordinates, shape, by_q, mass, is_holonomic, .. } =
            linearise_about_steady_state(self, found)?;
        if found.v.amax() > 0.0 {
            return Err(Error::NoPotential { why: "the mechanism moves" });
        }
        if !is_holonomic {
            return Err(Error::NoPotential { why: "velocities alone are constrained" });
        }
        if M::FIRST_ORDER > 0 {
            return Err(Error::NoPotential { why: "forces follow states of first order" });
        }
        if (&mass - mass.transpose()).amax() > SKEW * mass.amax() {
            return Err(Error::NoPotential { why: "forces by accelerations are not those of an inertia" });
        }
        // Zᵀ M P = Zᵀ for the derivative P of the accelerations by forces, which eliminates the
        // multipliers.
        let matrix = -(shape.transpose() * &mass * by_q * &shape);
        let own = symmetric_part(&(shape.transpose() * mass * &shape));
        let lower = own.cholesky().ok_or(Error::Indefinite { matrix: "M" })?.l();
        let curvatures = generalized_symmetric_eigenvalues(&lower, &matrix)?;
        let size = matrix.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let skew = (&matrix - matrix.transpose()).iter().fold(0.0, |most: f64, x| most.max(x.abs())) / 2.0;
        let asymmetry = if size > 0.0 { skew / size } else { 0.0 };
        let coordinates = coordinates.iter().map(|k| M::VELOCITIES[*k]).collect();
        Ok(Stiffness { matrix, coordinates, curvatures, asymmetry })
    }
}

/// Returns the eigenvalues of `L⁻¹ K L⁻ᵀ` in ascending order, for a lower triangular matrix `L`.
fn generalized_symmetric_eigenvalues(lower: &DMatrix<f64>, matrix: &DMatrix<f64>) -> Result<Vec<f64>, Error> {
    let singular = Error::Indefinite { matrix: "M" };
    let half = lower.solve_lower_triangular(&symmetric_part(matrix)).ok_or(singular.clone())?;
    let whole = lower.solve_lower_triangular(&half.transpose()).ok_or(singular)?;
    let mut all: Vec<f64> = symmetric_part(&whole).symmetric_eigenvalues().iter().copied().collect();
    all.sort_by(f64::total_cmp);
    Ok(all)
}
