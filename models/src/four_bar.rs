use linkwork::mechanism;

/// The planar four-bar linkage: a crank, a coupler and a rocker, between two pivots on the ground.
///
/// Source: Freudenstein, *Approximate synthesis of four-bar linkages*, Trans. ASME 77 (1955); Norton, *Design of
/// Machinery* (2004), ch. 4 and 6.
///
/// - Coordinates: `input` `θ₂`, the crank's angle from x; `joint`, the coupler's angle from the crank, so that its own is
///   `θ₃ = input + joint`; `output` `θ₄`, the rocker's angle from x; rad. y points up. The pin `loop_` closes the loop.
///   Input: `motor`, a torque on the crank, N·m.
/// - Freudenstein's equation: `d/a cos θ₄ − d/c cos θ₂ + (a² − b² + c² + d²) / (2 a c) = cos(θ₂ − θ₄)`, with the lengths
///   `a`, `b`, `c` of crank, coupler and rocker, and `d` of the base.
/// - Rates: `θ̇₄ / θ̇₂ = a sin(θ₃ − θ₂) / (c sin(θ₃ − θ₄))`, `θ̇₃ / θ̇₂ = a sin(θ₄ − θ₂) / (b sin(θ₃ − θ₄))`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the links per length, kg/m.
    pub density: f64,
    /// Length of the crank, m.
    pub a: f64,
    /// Length of the coupler, m.
    pub b: f64,
    /// Length of the rocker, m.
    pub c: f64,
    /// Distance of the fixed pivots, m.
    pub d: f64,

    #[body(mass = density * a, com = a / 2 * x, inertia = rod(density * a, a, x))]
    crank: Body,
    #[body(mass = density * b, com = b / 2 * x, inertia = rod(density * b, b, x))]
    coupler: Body,
    #[body(mass = density * c, com = c / 2 * x, inertia = rod(density * c, c, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    input: Pin,
    #[joint(crank.at(a * x) -> coupler, about = z)]
    joint: Pin,
    #[joint(ground.at(d * x) -> rocker, about = z)]
    output: Pin,
    #[joint(coupler.at(b * x) -> rocker.at(c * x), about = z)]
    loop_: Pin,
    #[acts(on = input)]
    motor: Torque,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, drift, precisely};
    use linkwork::prelude::*;

    /// Grashof's crank and rocker.
    const L: FourBar = FourBar { g: 9.81, density: 0.8, a: 0.3, b: 0.9, c: 0.7, d: 0.8 };

    /// The open branch with a given crank angle.
    fn at(input: f64) -> SVector<f64, 3> {
        L.assemble(&[input, 0.9 - input, 1.8].into(), &[0]).expect("the crank goes all the way round")
    }

    /// Positions by Freudenstein's equation, rates by its derivative, all the way round.
    #[test]
    fn freudensteins_equation() {
        assert_eq!((FourBar::NC, FourBar::NP, FourBar::NS), (2, 1, 1));
        let FourBar { a, b, c, d, .. } = L;
        for k in 0..24 {
            let q = at(f64::from(k) * std::f64::consts::PI / 12.0);
            let (crank, coupler, rocker) = (q[0], q[0] + q[1], q[2]);
            let constant = (a * a - b * b + c * c + d * d) / (2.0 * a * c);
            let cosine = d / a * rocker.cos() - d / c * crank.cos() + constant;
            assert_close(cosine, (crank - rocker).cos(), 1e-13);

            let v = L.project_velocity(&q, &[2.0, 0.0, 0.0].into()).expect("no dead centre");
            let sine = (coupler - rocker).sin();
            assert_close(v[2] / v[0], a * (coupler - crank).sin() / (c * sine), 1e-12);
            assert_close((v[0] + v[1]) / v[0], a * (rocker - crank).sin() / (b * sine), 1e-12);
        }
    }

    /// At rest the motor carries what lifting the links takes, by virtual work.
    #[test]
    fn holding_torque() {
        let FourBar { g, density, a, b, c, .. } = L;
        let q = at(0.7);
        let v = L.project_velocity(&q, &[1.0, 0.0, 0.0].into()).expect("no dead centre");
        let rates = [q[0].cos(), (q[0] + q[1]).cos() * (v[0] + v[1]) / v[0], q[2].cos() * v[2] / v[0]];
        let lift = density * a * a / 2.0 * rates[0]
            + density * b * (a * rates[0] + b / 2.0 * rates[1])
            + density * c * c / 2.0 * rates[2];
        let tau = L.generalized_forces(&q, &[g * lift].into());
        let acceleration = L.forward_dynamics(&q, &SVector::zeros(), &tau);
        assert!(acceleration.amax() < 1e-12, "{acceleration}");
    }

    fn energy(q: &SVector<f64, 3>, v: &SVector<f64, 3>) -> f64 {
        L.kinetic_energy(q, v) + L.potential_energy(q)
    }

    fn start() -> (SVector<f64, 3>, SVector<f64, 3>) {
        let q = at(0.7);
        (q, L.project_velocity(&q, &[12.0, 0.0, 0.0].into()).expect("no dead centre"))
    }

    /// The error of a method of order four falls by 2⁴ when its step is halved, constraints included.
    #[test]
    fn order_of_the_integrator() -> Result<(), Error> {
        let (q, v) = start();
        let exact = simulate(&L).from(q, v).method(precisely()).duration(1.0).finish()?;
        assert_close(energy(&exact.q, &exact.v), energy(&q, &v), 1e-10);
        let errors = |h: f64| -> Result<[f64; 2], Error> {
            let end = simulate(&L).from(q, v).method(Rk4::step(h)).duration(1.0).finish()?;
            Ok([(end.q - exact.q).norm(), energy(&end.q, &end.v) - energy(&q, &v)])
        };
        let (coarse, fine) = (errors(4e-4)?, errors(2e-4)?);
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            let ratio = coarse / fine;
            assert!((14.0..18.0).contains(&ratio), "{coarse:e} / {fine:e} = {ratio}");
        }
        Ok(())
    }

    /// A million steps leave the loop as closed as the first one. The energy drifts in proportion to time, and less by the
    /// power of the step that the order says.
    #[test]
    fn a_million_steps() -> Result<(), Error> {
        let (q, still) = (at(0.7), SVector::zeros());
        let [tenth, all] = drift(&L, &q, &still, 1e-3, 1_000_000)?;
        assert!(all < 12.0 * tenth && all < 1e-6, "{tenth:e} J, then {all:e} J");
        let [[_, coarse], [_, fine]] =
            [drift(&L, &q, &still, 8e-3, 5_000)?, drift(&L, &q, &still, 4e-3, 10_000)?];
        assert!(coarse > 15.0 * fine, "{coarse:e} J and {fine:e} J");
        Ok(())
    }
}
