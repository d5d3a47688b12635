//! Loaded mechanisms for the runtime's integrators.

use crate::error::Error;
use crate::robot::Robot;
use linkwork::integrate::Hooks;
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{Mechanism, Scleronomic};

/// A robot as a [`Mechanism`] of constant dimensions, for integrators and all other code for any mechanism.
///
/// The dimensions are at least those of the robot. Further coordinates have unit inertia, and only generalized
/// forces act on them; further inputs have no effect. With equal dimensions nothing is padded.
///
/// Two designs were weighed: dimensions as associated types of the traits, so that loaded mechanisms have dynamic
/// vectors, and this one, a capacity. Associated types change every signature of the runtime, and dynamic vectors
/// allocate in every stage of an integrator. A capacity needs no change of the runtime, so that mechanisms of the
/// attribute lose nothing; its costs are additional entries of the vectors of a stage, not of the generated code.
///
/// ```
/// use linkwork::prelude::simulate;
/// use linkwork_jit::declare;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let pendulum = declare(
///     "#[mechanism(gravity = -9.81 * y)]
///     struct Pendulum {
///         #[body(mass = 2, com = -0.5 * y, inertia = rod(2, 1, y))]
///         rod: Body,
///         #[joint(ground -> rod, about = z)]
///         hinge: Pin,
///     }",
/// )?;
/// let exact = pendulum.padded::<1, 1, 0>()?;
/// let padded = pendulum.padded::<4, 4, 2>()?;
/// let end = simulate(&exact).from([0.5], [0.0]).duration(1.0).finish()?;
/// let q = [0.5, 0.0, 0.0, 0.0];
/// let same = simulate(&padded).from(q, [0.0; 4]).duration(1.0).finish()?;
/// assert!((end.q[0] - same.q[0]).abs() < 1e-6 && same.q[1] == 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Padded<const NQ: usize, const NV: usize, const NU: usize> {
    robot: Robot,
}

impl Robot {
    /// Returns the robot as a mechanism of constant dimensions; changes of parameters are made before.
    ///
    /// # Errors
    ///
    /// A dimension is smaller than that of the robot, a parameter has no value, or the robot has constraints,
    /// contacts or generalized speeds, or depends on time.
    pub fn padded<const NQ: usize, const NV: usize, const NU: usize>(
        &self,
    ) -> Result<Padded<NQ, NV, NU>, Error> {
        for (name, own, capacity) in [("NQ", self.nq(), NQ), ("NV", self.nv(), NV), ("NU", self.nu(), NU)] {
            self.check_length(name, own, own.min(capacity))?;
        }
        let further = (NQ - self.nq(), NV - self.nv());
        if further.0 != further.1 {
            let (name, expected) = ("NQ - NV", self.nq() - self.nv());
            self.check_length(name, expected, NQ.saturating_sub(NV))?;
        }
        self.validate()?;
        match self.shared.obstacle {
            Some(reason) => Err(Error::Value(format!("`{}` cannot be integrated: {reason}", self.name()))),
            None => Ok(Padded { robot: self.clone() }),
        }
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize> Padded<NQ, NV, NU> {
    /// Returns the robot.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    fn q<'a>(&self, q: &'a SVector<f64, NQ>) -> &'a [f64] {
        &q.as_slice()[..self.robot.nq()]
    }

    fn v<'a>(&self, v: &'a SVector<f64, NV>) -> &'a [f64] {
        &v.as_slice()[..self.robot.nv()]
    }

    /// Fills the entries of the robot, and NaN after an error, which lengths cannot cause here.
    fn fill<const N: usize>(
        mut all: SVector<f64, N>,
        n: usize,
        fill: impl FnOnce(&mut [f64]) -> Result<(), Error>,
    ) -> SVector<f64, N> {
        let own = &mut all.as_mut_slice()[..n];
        if fill(own).is_err() {
            own.fill(f64::NAN);
        }
        all
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize> Scleronomic for Padded<NQ, NV, NU> {}

impl<const NQ: usize, const NV: usize, const NU: usize> Hooks<f64, NQ, NV, NU> for Padded<NQ, NV, NU> {}

impl<const NQ: usize, const NV: usize, const NU: usize> Mechanism<NQ, NV, NU> for Padded<NQ, NV, NU> {
    type Scalar = f64;

    const CONFIGURATION: [&'static str; NQ] = [""; NQ];
    const VELOCITIES: [&'static str; NV] = [""; NV];
    const INPUTS: [&'static str; NU] = [""; NU];

    fn neutral(&self) -> SVector<f64, NQ> {
        Self::fill(SVector::zeros(), self.robot.nq(), |to| self.robot.neutral_into(to))
    }

    fn integrate(&self, q: &SVector<f64, NQ>, dv: &SVector<f64, NV>) -> SVector<f64, NQ> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        let mut all = *q;
        for (to, by) in all.iter_mut().skip(nq).zip(dv.iter().skip(nv)) {
            *to += by;
        }
        Self::fill(all, nq, |to| self.robot.integrate_into(self.q(q), self.v(dv), to))
    }

    fn difference(&self, from: &SVector<f64, NQ>, to: &SVector<f64, NQ>) -> SVector<f64, NV> {
        let (nq, nv) = (self.robot.nq(), self.robot.nv());
        let mut all = SVector::<f64, NV>::zeros();
        for (k, entry) in all.iter_mut().enumerate().skip(nv) {
            *entry = to[k - nv + nq] - from[k - nv + nq];
        }
        Self::fill(all, nv, |out| self.robot.difference_into(self.q(from), self.q(to), out))
    }

    fn tangent_rate(&self, dv: &SVector<f64, NV>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        Self::fill(*v, self.robot.nv(), |to| self.robot.tangent_rate_into(self.v(dv), self.v(v), to))
    }

    fn mass_matrix(&self, _t: f64, q: &SVector<f64, NQ>) -> SMatrix<f64, NV, NV> {
        let n = self.robot.nv();
        let mut all = SMatrix::<f64, NV, NV>::identity();
        if n == NV {
            if self.robot.mass_matrix_into(self.q(q), all.as_mut_slice()).is_err() {
                all.fill(f64::NAN);
            }
        } else if let Ok(own) = self.robot.mass_matrix(self.q(q)) {
            all.view_mut((0, 0), (n, n)).copy_from(&own);
        }
        all
    }

    fn bias_forces(&self, _t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        Self::fill(SVector::zeros(), self.robot.nv(), |to| {
            self.robot.bias_forces_into(self.q(q), self.v(v), to)
        })
    }

    fn inverse_dynamics(
        &self,
        _t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        a: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        Self::fill(*a, self.robot.nv(), |to| {
            self.robot.inverse_dynamics_into(self.q(q), self.v(v), self.v(a), to)
        })
    }

    fn forward_dynamics(
        &self,
        _t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        tau: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        Self::fill(*tau, self.robot.nv(), |to| {
            self.robot.forward_dynamics_into(self.q(q), self.v(v), self.v(tau), to)
        })
    }

    fn generalized_forces(
        &self,
        _t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        u: &SVector<f64, NU>,
    ) -> SVector<f64, NV> {
        let u = &u.as_slice()[..self.robot.nu()];
        Self::fill(SVector::zeros(), self.robot.nv(), |to| {
            self.robot.generalized_forces_into(self.q(q), self.v(v), u, to)
        })
    }

    fn kinetic_energy(&self, _t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> f64 {
        let further: f64 = v.iter().skip(self.robot.nv()).map(|v| 0.5 * v * v).sum();
        self.robot.kinetic_energy(self.q(q), self.v(v)).unwrap_or(f64::NAN) + further
    }

    fn potential_energy(&self, _t: f64, q: &SVector<f64, NQ>) -> f64 {
        self.robot.potential_energy(self.q(q)).unwrap_or(f64::NAN)
    }

    fn generalized_momentum(&self, _t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        Self::fill(*v, self.robot.nv(), |to| self.robot.generalized_momentum_into(self.q(q), self.v(v), to))
    }

    fn momentum_rate(&self, _t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        Self::fill(SVector::zeros(), self.robot.nv(), |to| {
            self.robot.momentum_rate_into(self.q(q), self.v(v), to)
        })
    }
}
