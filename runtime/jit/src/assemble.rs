//! States of loaded mechanisms that satisfy the constraints.

use crate::capacity::Visitor;
use crate::error::Error;
use crate::internal::InternalFunction;
use crate::padded::Padded;
use crate::robot::Robot;
use linkwork::nalgebra::{DVector, SMatrix, SVector};
use linkwork::{Constrained, ConstraintError, integrate};

/// Computation on constraints: assembly of the mechanism, or projection of a configuration or velocity.
enum ConstraintTask<'a> {
    Assemble(Option<i8>),
    LeastViolation,
    Mode,
    Project,
    Velocity(&'a [f64]),
    ProjectVelocity(&'a [f64]),
}

/// Computation on constraints at a configuration, with the indices of the coordinates that are fixed.
struct ConstraintQuery<'a> {
    question: ConstraintTask<'a>,
    q: &'a [f64],
    held: &'a [usize],
}

/// Result of a computation on constraints: a vector and, where requested, the assembly mode.
type AssemblyOutcome = Result<(Vec<f64>, Option<i8>), ConstraintError>;

impl Visitor for ConstraintQuery<'_> {
    type Output = AssemblyOutcome;

    fn visit<const N: usize>(self, m: &Padded<N, N, N, &Robot>) -> AssemblyOutcome {
        let (robot, held) = (m.robot(), self.held);
        let t = robot.time();
        let padded_vector = |x: &[f64]| SVector::<f64, N>::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
        let result_from_configuration = |q: SVector<f64, N>| (q.as_slice()[..robot.nq()].to_vec(), None);
        let result_from_velocity = |v: SVector<f64, N>| (v.as_slice()[..robot.nv()].to_vec(), None);
        let q = padded_vector(self.q);
        match self.question {
            ConstraintTask::Assemble(mode) => {
                m.assemble_configuration(t, &q, held, mode).map(result_from_configuration)
            }
            ConstraintTask::LeastViolation => {
                linkwork::__private::least_violation(&m.assembly_constraints(t), &q, held)
                    .map(result_from_configuration)
            }
            ConstraintTask::Mode => Ok((Vec::new(), m.current_assembly_mode(t, &q, held))),
            ConstraintTask::Project => {
                Constrained::<N, N, N, N, N>::project_configuration(m, t, &q).map(result_from_configuration)
            }
            ConstraintTask::Velocity(v) => {
                Constrained::<N, N, N, N, N>::complete_velocity(m, t, &q, &padded_vector(v), held)
                    .map(result_from_velocity)
            }
            ConstraintTask::ProjectVelocity(v) => {
                Constrained::<N, N, N, N, N>::project_velocity(m, t, &q, &padded_vector(v))
                    .map(result_from_velocity)
            }
        }
    }
}

impl Robot {
    fn solve_constraint_task(
        &self,
        question: ConstraintTask<'_>,
        q: &[f64],
        held: &[usize],
    ) -> Result<(DVector<f64>, Option<i8>), Error> {
        self.check_length("q", self.nq(), q.len())?;
        if let ConstraintTask::Velocity(v) | ConstraintTask::ProjectVelocity(v) = question {
            self.check_length("v", self.nv(), v.len())?;
        }
        let motion_error_at_time =
            |reason| self.error_from_integrator(integrate::Error::Constraint { t: self.time(), reason });
        if let Some(index) = held.iter().copied().find(|index| *index >= self.nv()) {
            return Err(motion_error_at_time(ConstraintError::Held { index, velocities: self.nv() }));
        }
        if self.shared.constraints.names.is_empty() {
            return Err(Error::Value(format!("`{}` has no constraints", self.name())));
        }
        let (found, mode) =
            self.visit_padded_robot(ConstraintQuery { question, q, held })?.map_err(motion_error_at_time)?;
        Ok((DVector::from_vec(found), mode))
    }

    /// Returns a configuration near `q` (`nq` entries) that satisfies the constraints; coordinates whose
    /// joint velocities have the indices `held` do not change, see [`Constrained::assemble`].
    ///
    /// # Errors
    ///
    /// There are no constraints, a slice has the wrong length, or no configuration is found
    /// ([`Error::Motion`]).
    pub fn assemble(&self, q: &[f64], held: &[usize]) -> Result<DVector<f64>, Error> {
        Ok(self.solve_constraint_task(ConstraintTask::Assemble(None), q, held)?.0)
    }

    /// Returns a configuration near `q` that satisfies the constraints and has this assembly mode, see
    /// [`Constrained::assemble_in_mode`].
    ///
    /// # Errors
    ///
    /// As [`assemble`](Self::assemble).
    pub fn assemble_in_mode(&self, q: &[f64], held: &[usize], mode: i8) -> Result<DVector<f64>, Error> {
        Ok(self.solve_constraint_task(ConstraintTask::Assemble(Some(mode)), q, held)?.0)
    }

    /// Returns the configuration of least constraint violation near `q`, which steps of bounded length reach.
    /// The configuration need not satisfy the constraints; see [`assemble`](Self::assemble).
    ///
    /// # Errors
    ///
    /// As [`assemble`](Self::assemble).
    #[doc(hidden)]
    pub fn least_violation(&self, q: &[f64], held: &[usize]) -> Result<DVector<f64>, Error> {
        Ok(self.solve_constraint_task(ConstraintTask::LeastViolation, q, held)?.0)
    }

    /// Returns the heights of the terrains that drawings show, m, at a position along their first two axes,
    /// m.
    #[doc(hidden)]
    #[must_use]
    pub fn terrain_heights(&self, place: [f64; 2]) -> Option<Vec<f64>> {
        let index = self.shared.internal[InternalFunction::DrawingHeights as usize]?;
        let state = crate::robot::State { other: &[&place], ..crate::robot::State::default() };
        self.call_function_at_state(index, state).ok()
    }

    /// Returns whether the mechanism has constraints.
    #[doc(hidden)]
    #[must_use]
    pub fn is_constrained(&self) -> bool {
        !self.shared.constraints.names.is_empty()
    }

    /// Returns the assembly mode of a configuration, 1 or −1, see [`Constrained::assembly_mode`]; `None` in a
    /// singular configuration, or if the held coordinates do not determine the others.
    ///
    /// # Errors
    ///
    /// As [`assemble`](Self::assemble).
    pub fn assembly_mode(&self, q: &[f64], held: &[usize]) -> Result<Option<i8>, Error> {
        Ok(self.solve_constraint_task(ConstraintTask::Mode, q, held)?.1)
    }

    /// Returns the configuration nearest to `q` (`nq` entries) that satisfies the constraints, in the metric
    /// of the kinetic energy.
    ///
    /// # Errors
    ///
    /// As [`assemble`](Self::assemble).
    pub fn project_configuration(&self, q: &[f64]) -> Result<DVector<f64>, Error> {
        Ok(self.solve_constraint_task(ConstraintTask::Project, q, &[])?.0)
    }

    /// Returns the velocity nearest to `v` (`nv` entries) that satisfies the constraints at `q`, in the
    /// metric of the kinetic energy.
    ///
    /// # Errors
    ///
    /// As [`assemble`](Self::assemble).
    pub fn project_velocity(&self, q: &[f64], v: &[f64]) -> Result<DVector<f64>, Error> {
        Ok(self.solve_constraint_task(ConstraintTask::ProjectVelocity(v), q, &[])?.0)
    }

    /// Returns the velocity (`nv` entries) with the entries `held` of `v` that satisfies the constraints, see
    /// [`Constrained::complete_velocity`].
    ///
    /// # Errors
    ///
    /// As [`assemble`](Self::assemble).
    pub fn complete_velocity(&self, q: &[f64], v: &[f64], held: &[usize]) -> Result<DVector<f64>, Error> {
        Ok(self.solve_constraint_task(ConstraintTask::Velocity(v), q, held)?.0)
    }

    /// Returns the ratio of the smallest to the largest singular value of the matrix from joint velocities to
    /// generalized speeds, with rows scaled to unit length. Without declared speeds it is one.
    #[doc(hidden)]
    #[must_use]
    pub fn regularity_of_speeds(&self, q: &[f64]) -> f64 {
        let n = self.nv();
        let index = self.shared.internal[InternalFunction::SpeedMatrix as usize];
        let Some(index) = index.filter(|_| n > 0) else { return 1.0 };
        let state = crate::robot::State { q, ..crate::robot::State::default() };
        let Ok(values) = self.call_function_at_state(index, state) else { return 1.0 };
        let mut speeds = nalgebra::DMatrix::from_vec(n, n, values);
        // Speeds may have different units: rows have the length one, except rows that rounding makes nonzero.
        let largest = speeds.row_iter().map(|row| row.norm()).fold(0.0, f64::max);
        for mut row in speeds.row_iter_mut() {
            let size = row.norm();
            row /= if size > 1e-12 * largest { size } else { 1.0 };
        }
        let sizes = speeds.singular_values();
        if sizes.max() > 0.0 { sizes.min() / sizes.max() } else { 0.0 }
    }
}

impl<const N: usize> Padded<N, N, N, &Robot> {
    /// Returns the constraints for assembly, whose displacements are joint velocities: declared speeds need
    /// not determine these.
    fn assemble_configuration(
        &self,
        t: f64,
        q: &SVector<f64, N>,
        held: &[usize],
        mode: Option<i8>,
    ) -> Result<SVector<f64, N>, ConstraintError> {
        linkwork::__private::assemble(&self.assembly_constraints(t), q, held, mode)
    }

    fn current_assembly_mode(&self, t: f64, q: &SVector<f64, N>, held: &[usize]) -> Option<i8> {
        linkwork::__private::assembly_mode(&self.assembly_constraints(t), q, held)
    }

    #[allow(clippy::type_complexity, reason = "closures")]
    fn assembly_constraints(
        &self,
        t: f64,
    ) -> linkwork::__private::Loops<
        '_,
        impl Fn(&SVector<f64, N>) -> SVector<f64, N>,
        impl Fn(&SVector<f64, N>) -> SMatrix<f64, N, N>,
        impl Fn(&SVector<f64, N>, &SVector<f64, N>) -> SVector<f64, N>,
        N,
        N,
    > {
        let robot = self.robot();
        let has_speeds = robot.shared.has_speeds;
        linkwork::__private::Loops {
            names: Self::CONSTRAINTS,
            angles: self.angles(),
            // The units of declared speeds do not distinguish rotations from translations.
            turns: if has_speeds { [false; N] } else { self.rotations() },
            sizes: [self.holonomic(), robot.nv()],
            residuals: move |q: &SVector<f64, N>| self.constraint_residuals(t, q),
            jacobian: move |q: &SVector<f64, N>| {
                let jacobian = self.constraint_jacobian(t, q);
                if has_speeds {
                    jacobian * self.speed_matrix(InternalFunction::SpeedMatrix, q)
                } else {
                    jacobian
                }
            },
            integrate: move |q: &SVector<f64, N>, dv: &SVector<f64, N>| {
                let mut moved = *q;
                let charts = &robot.shared.charts;
                crate::configuration_space::integrate(
                    charts,
                    q.as_slice(),
                    dv.as_slice(),
                    moved.as_mut_slice(),
                );
                moved
            },
        }
    }
}
