//! Linear systems of mechanisms with constraints, in independent coordinates and velocities.

use crate::capacity::Visitor;
use crate::error::Error;
use crate::internal::InternalFunction;
use crate::padded::Padded;
use crate::robot::Robot;
use linkwork::__private::Motion;
use linkwork::integrate::{self, Hooks};
use linkwork::nalgebra::{ArrayStorage, DMatrix, SMatrix, SVector};
use linkwork::{Constrained, ConstraintError, Mechanism};

/// Linear system `ẋ = A x + B δu` of a constrained motion about a state, in independent coordinates and
/// velocities. The state `x` contains the displacements of the coordinates (in body axes for ball and free
/// joints), followed by the changes of the velocities.
#[derive(Clone, Debug, PartialEq)]
pub struct IndependentMotion {
    /// System matrix `A` of the linearised motion.
    pub a: DMatrix<f64>,
    /// Input matrix `B` of the linearised motion.
    pub b: DMatrix<f64>,
    /// Independent coordinates, as indices of their rates in `v`.
    pub coordinates: Vec<usize>,
    /// Independent velocities, as indices in `v`.
    pub velocities: Vec<usize>,
}

impl Robot {
    /// Linearises the motion of a mechanism with constraints about `q`, `v` and the inputs `u`, in
    /// independent coordinates and velocities (option `derivatives`). If the constraints permit a choice,
    /// the velocities with the indices `preferred` are independent.
    ///
    /// ```
    /// # fn main() -> Result<(), linkwork_jit::Error> {
    /// // Two pendulums of 1 m, whose angles are equal.
    /// let pair = linkwork_jit::Loader::text(
    ///     "#[mechanism(gravity = -9.81 * y)]
    ///     struct Pair {
    ///         #[particle(mass = 1)]
    ///         first: Particle,
    ///         #[particle(mass = 1)]
    ///         second: Particle,
    ///         #[joint(ground -> first.at(y), about = z)]
    ///         left: Pin,
    ///         #[joint(ground -> second.at(y), about = z)]
    ///         right: Pin,
    ///         #[constraint(left = right)]
    ///         gears: Holonomic,
    ///     }",
    /// )
    /// .options("derivatives")
    /// .load()?;
    /// let motion = pair.linearize_independent(&[0.0, 0.0], &[0.0, 0.0], &[], &[0])?;
    /// assert_eq!((motion.coordinates, motion.velocities), (vec![0], vec![0]));
    /// assert!((motion.a[(1, 0)] + 9.81).abs() < 1e-12 && motion.a[(0, 1)] == 1.0);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// The mechanism has no constraints, no derivatives, or states of first order; a slice has the wrong
    /// length; or the constraints lose rank ([`Error::Motion`]).
    pub fn linearize_independent(
        &self,
        q: &[f64],
        v: &[f64],
        u: &[f64],
        preferred: &[usize],
    ) -> Result<IndependentMotion, Error> {
        self.check_no_values_missing()?;
        let lists = [("q", self.nq(), q.len()), ("v", self.nv(), v.len()), ("u", self.nu(), u.len())];
        lists.into_iter().try_for_each(|(name, expected, found)| self.check_length(name, expected, found))?;
        if self.shared.constraints.names.is_empty() {
            return Err(Error::Value(format!("`{}` has no constraints: call `linearize`", self.name())));
        }
        if self.shared.internal[InternalFunction::MotionDerivatives as usize].is_none()
            || !self.shared.states.is_empty()
        {
            let message =
                format!("`{}` was loaded without `derivatives`, or has states of first order", self.name());
            return Err(Error::Value(message));
        }
        let found = self.visit_padded_robot(LinearisationPoint { q, v, u, preferred })?;
        found.map_err(|reason| {
            self.error_from_integrator(integrate::Error::Constraint { t: self.time(), reason })
        })
    }
}

/// State and inputs about which the motion is linearised.
struct LinearisationPoint<'a> {
    q: &'a [f64],
    v: &'a [f64],
    u: &'a [f64],
    preferred: &'a [usize],
}

impl Visitor for LinearisationPoint<'_> {
    type Output = Result<IndependentMotion, ConstraintError>;

    fn visit<const N: usize>(self, m: &Padded<N, N, N, &Robot>) -> Self::Output {
        let (robot, t) = (m.robot(), m.robot().time());
        let padded_vector = |x: &[f64]| SVector::<f64, N>::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
        let [q, v, u] = [self.q, self.v, self.u].map(padded_vector);
        let tau = m.generalized_forces(t, &q, &v, &u);
        m.try_forward_dynamics(t, &q, &v, &tau)?;
        let (a, lambda) = Constrained::<N, N, N, N, N>::constrained_dynamics(m, t, &q, &v, &tau);
        let parts = m.motion_derivatives(t, &q, &v, &a, &lambda);
        let by_motion = m.acceleration_derivatives(t, &q, &v, &u);
        let (by_q, by_v, by_u) = by_motion.ok_or(ConstraintError::NotFinite)?;
        let matrix_from_columns = |columns| SMatrix::from_array_storage(ArrayStorage(columns));
        let motion = Motion {
            by_q,
            by_v,
            by_u,
            jacobian: m.constraint_jacobian(t, &q),
            rates_by_q: matrix_from_columns(parts.rates_by_q),
            turning: matrix_from_columns(parts.turning),
            holonomic: m.holonomic(),
            preferred: self.preferred,
        };
        let blocks = motion.independent_blocks();
        // Further velocities are padding.
        let indices_without_padding =
            |list: &[usize]| list.iter().copied().filter(|k| *k < robot.nv()).collect::<Vec<_>>();
        let (coordinates, velocities) =
            (indices_without_padding(&blocks.coordinates), indices_without_padding(&blocks.speeds));
        if [coordinates.len(), velocities.len()] != robot.shared.constraints.freedom {
            return Err(ConstraintError::Singular);
        }
        let (np, size) = (coordinates.len(), coordinates.len() + velocities.len());
        let rows: Vec<usize> = coordinates.iter().chain(&velocities).copied().collect();
        let a = DMatrix::from_fn(size, size, |i, j| match (i < np, j < np) {
            (true, true) => blocks.drift[(rows[i], j)],
            (true, false) => blocks.gamma[(rows[i], j - np)],
            (false, true) => blocks.by_position[(rows[i], j)],
            (false, false) => blocks.by_speed[(rows[i], j - np)],
        });
        let b = DMatrix::from_fn(size, robot.nu(), |i, j| if i < np { 0.0 } else { by_u[(rows[i], j)] });
        Ok(IndependentMotion { a, b, coordinates, velocities })
    }
}
