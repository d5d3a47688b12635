use linkwork::mechanism;

/// A flywheel on a shaft with a brake: dry friction brings it to rest.
///
/// Source: Coulomb, *Théorie des machines simples* (1785); Bernstein, Goel and Ansari, *Geometry, Kinematics, Statics,
/// and Dynamics*, on dashpots and friction.
///
/// - Coordinate: `shaft`, the flywheel's angle, rad. Input: `motor`, a torque, N·m.
/// - Equation of motion: `J ω̇ = τ − f tanh(ω / ω₀)`: the smooth form of `τ − f sign ω`; below the small speed `ω₀` it
///   creeps.
/// - Running down from `ω(0)`: `sinh(ω / ω₀) = sinh(ω(0) / ω₀) exp(−f t / (J ω₀))`, so that `ω = ω(0) − f t / J` until
///   it is all but at rest, after `J ω(0) / f`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrakedFlywheel {
    /// Moment of inertia, kg·m².
    pub inertia: f64,
    /// Torque of the brake, N·m.
    pub brake_torque: f64,
    /// Speed below which the wheel counts as resting, rad/s.
    pub creep: f64,

    #[body(inertia = diagonal(inertia / 2, inertia / 2, inertia))]
    flywheel: Body,
    #[joint(ground -> flywheel, about = z)]
    shaft: Pin,
    #[acts(on = shaft, coulomb = brake_torque, speed = creep)]
    brake: Friction,
    #[acts(on = shaft)]
    motor: Torque,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, precisely};
    use linkwork::prelude::*;

    const W: BrakedFlywheel = BrakedFlywheel { inertia: 0.3, brake_torque: 0.9, creep: 0.5 };

    #[test]
    fn runs_down() -> Result<(), Error> {
        let start = 12.0_f64;
        for sample in simulate(&W).from([0.0], [start]).method(precisely()).duration(5.0).sample_every(0.5) {
            let Sample { t, v, .. } = sample?;
            let left = (start / W.creep).sinh() * (-W.brake_torque * t / (W.inertia * W.creep)).exp();
            assert_close(v[0], W.creep * left.asinh(), 1e-9);
        }
        Ok(())
    }

    #[test]
    fn motor_against_the_brake() {
        let tau = W.generalized_forces(&[0.0].into(), &[2.4].into());
        let a = W.forward_dynamics(&[0.0].into(), &[100.0].into(), &tau);
        assert_close(a[0], (2.4 - 0.9) / 0.3, 1e-14);
    }
}
