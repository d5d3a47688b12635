use linkwork::mechanism;

/// Jeffcott's (or Laval's) rotor: an unbalanced disk in the middle of an elastic shaft that turns at a constant rate.
///
/// Source: Jeffcott, *The lateral vibration of loaded shafts…*, Phil. Mag. 37 (1919); Den Hartog, *Mechanical
/// Vibrations* (1956), ch. 6.
///
/// - Coordinates: `bow.x` and `bow.y`, the deflection of the shaft across its axis z, m. The disk turns at the
///   prescribed rate `Ω`, so the functions take the time first.
/// - Equations of motion, with the eccentricity `e`: `m ẍ + c ẋ + k x = m e Ω² cos Ωt`,
///   `m ÿ + c ẏ + k y = m e Ω² sin Ωt`.
/// - Steady whirl on a circle with the radius `e r² / √((1 − r²)² + (2 ζ r)²)`, `r = Ω √(m/k)`, `ζ = ½ c / √(k m)`,
///   behind the unbalance by the angle `atan2(2 ζ r, 1 − r²)`. Far above the critical speed the disk turns about its
///   centre of mass.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JeffcottRotor {
    /// Rate at which the shaft turns, rad/s.
    pub spin: f64,
    /// Mass of the disk, kg.
    pub mass: f64,
    /// Distance of its centre of mass from the shaft, m.
    pub eccentricity: f64,
    /// Stiffness of the shaft, N/m.
    pub stiffness: f64,
    /// External damping, N·s/m.
    pub damping: f64,

    #[body]
    hub: Body,
    #[joint(ground -> hub, along = (x, y))]
    bow: Stage,
    #[frame(hub, z(spin * t))]
    disk: Frame,
    #[particle(mass = mass, at = hub.at(eccentricity * disk.x))]
    unbalance: Particle,
    #[acts(on = bow.x, stiffness = stiffness)]
    shaft_x: Spring,
    #[acts(on = bow.y, stiffness = stiffness)]
    shaft_y: Spring,
    #[acts(on = bow.x, damping = damping)]
    damper_x: Dashpot,
    #[acts(on = bow.y, damping = damping)]
    damper_y: Dashpot,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_near, precisely};
    use linkwork::prelude::*;

    const R: JeffcottRotor =
        JeffcottRotor { spin: 90.0, mass: 2.0, eccentricity: 1e-3, stiffness: 8000.0, damping: 20.0 };

    #[test]
    fn equations_of_motion() {
        let (t, q, v) = (0.4, SVector::from([0.002, -0.001]), SVector::from([0.1, 0.3]));
        assert_near(R.mass_matrix(t, &q), SMatrix::<f64, 2, 2>::identity() * 2.0, 1e-15);
        let turned = R.spin * t;
        let pull = R.mass * R.eccentricity * R.spin * R.spin;
        let bias = 20.0 * v + 8000.0 * q - pull * SVector::from([turned.cos(), turned.sin()]);
        assert_near(R.bias_forces(t, &q, &v), bias, 1e-13);
    }

    #[test]
    fn steady_whirl_below_and_above_the_critical_speed() -> Result<(), Error> {
        for spin in [30.0, 63.0, 200.0, 2000.0] {
            let rotor = JeffcottRotor { spin, ..R };
            let ratio = spin * (R.mass / R.stiffness).sqrt();
            let zeta = R.damping / (2.0 * (R.stiffness * R.mass).sqrt());
            let (real, imaginary) = (1.0 - ratio * ratio, 2.0 * zeta * ratio);
            let radius = R.eccentricity * ratio * ratio / real.hypot(imaginary);
            let lag = imaginary.atan2(real);
            let at = |t: f64| {
                let angle = spin * t - lag;
                radius * SVector::from([angle.cos(), angle.sin()])
            };
            let rate = spin * radius * SVector::from([lag.sin(), lag.cos()]);
            let run = simulate(&rotor).from(at(0.0), rate).method(precisely());
            for sample in run.duration(0.3).sample_every(0.05) {
                let Sample { t, q, .. } = sample?;
                assert_near(q / radius, at(t) / radius, 1e-7);
                // Far above the critical speed the centre of mass stays where it is.
                let unbalance = R.eccentricity * SVector::from([(spin * t).cos(), (spin * t).sin()]);
                let moves = (q + unbalance).norm() > 0.01 * R.eccentricity;
                assert_eq!(moves, spin < 1000.0, "at {spin} rad/s");
            }
        }
        Ok(())
    }
}
