//! Motions by steps of equal size, with inputs that are constant during each step.

use crate::error::Error;
use crate::robot::Robot;
use crate::simulate::{Inputs, Method};
use linkwork::simulate::Overlaps;

impl Robot {
    /// Writes a motion by `steps` steps of `h` seconds from the time `start`. The inputs are constant during
    /// each step: one row of `inputs` for each step, row after row, or an empty slice for zero inputs. The
    /// slices `q` and `v` have `steps + 1` rows, and the first ones are the initial state.
    ///
    /// Steps are of the classical Runge–Kutta method; states satisfy constraints after each step. Steps of
    /// mechanisms with contacts are time stepping, see [`Method::TimeStepping`]. Surfaces that overlap at
    /// the start may do so.
    ///
    /// ```
    /// # fn main() -> Result<(), linkwork_jit::Error> {
    /// let ball = linkwork_jit::declare(
    ///     "#[mechanism(gravity = -9.81 * z)]
    ///     struct Ball {
    ///         #[particle(mass = 0.1)]
    ///         ball: Particle,
    ///         #[joint(ground -> ball, along = z)]
    ///         height: Sleeve,
    ///         #[contact(ball, ground.plane(z), restitution = 0)]
    ///         floor: Contact,
    ///     }",
    /// )?;
    /// let (mut q, mut v) = ([0.1; 1001], [0.0; 1001]);
    /// ball.roll_out(0.0, 1e-3, &[], [&mut q, &mut v])?;
    /// // The ball falls for √(2 · 0.1 / 9.81) s, and rests afterwards.
    /// assert!((q[100] - 0.1 + 0.5 * 9.81 * 0.1 * 0.1).abs() < 1e-3);
    /// assert!(q[1000].abs() < 1e-9 && v[1000].abs() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// A slice has the wrong length, the mechanism has states of first order or no inertia, `h` is not
    /// positive, or the motion cannot be continued ([`Error::Motion`]). Rows after an error are NaN.
    pub fn roll_out(&self, start: f64, h: f64, inputs: &[f64], [q, v]: [&mut [f64]; 2]) -> Result<(), Error> {
        let (nq, nv, nu) = (self.nq(), self.nv(), self.nu());
        let rows = v.len().checked_div(nv).unwrap_or(1);
        let steps = rows.saturating_sub(1);
        self.check_length("v", rows.max(1) * nv, v.len())?;
        self.check_length("q", rows.max(1) * nq, q.len())?;
        if !inputs.is_empty() {
            self.check_length("inputs", steps * nu, inputs.len())?;
        }
        if !(h > 0.0 && h.is_finite() && start.is_finite()) {
            let message =
                format!("the step must be positive and finite, and the time finite: {h} and {start}");
            return Err(Error::Value(message));
        }
        if !self.shared.states.is_empty() {
            return Err(Error::Value(format!("`{}` has states of first order", self.name())));
        }
        let method = match self.shared.contacts.is_empty() {
            true => Method::Rk4(h),
            false => Method::TimeStepping(h),
        };
        let mut controller_from_given_inputs = |t: f64, _: &[f64], _: &[f64], u: &mut [f64]| {
            let step = ((t - start) / h).round().max(0.0) as usize;
            let row = inputs.chunks_exact(nu.max(1)).nth(step.min(steps.saturating_sub(1)));
            match row {
                Some(row) => u.copy_from_slice(row),
                None => u.fill(0.0),
            }
            Ok(())
        };
        let inputs = match nu > 0 && !inputs.is_empty() {
            true => Inputs::Sampled(h, &mut controller_from_given_inputs),
            false => Inputs::Zero,
        };
        let (first_q, first_v) = (q[..nq].to_vec(), v[..nv].to_vec());
        let run = self.simulate().from(&first_q, &first_v).start_at(start).method(method).inputs(inputs);
        let run = run.duration(h * steps as f64).sample_every(h).overlaps(Overlaps::Keep);
        let mut row = 0;
        let result = run.each(&mut |sample| {
            if row < rows {
                q[row * nq..(row + 1) * nq].copy_from_slice(&sample.q);
                v[row * nv..(row + 1) * nv].copy_from_slice(&sample.v);
            }
            row += 1;
        });
        let written = row.clamp(1, rows.max(1));
        q[written * nq..].fill(f64::NAN);
        v[written * nv..].fill(f64::NAN);
        result?;
        match row == rows {
            true => Ok(()),
            false => Err(Error::Internal(format!("{row} samples of {rows}"))),
        }
    }
}
