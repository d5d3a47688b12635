use linkwork::mechanism;

/// Two gears in mesh, on axles that stand still: a constraint ties their angles.
///
/// Source: Norton, *Design of Machinery* (2004), ch. 9; Shabana, *Dynamics of Multibody Systems* (2013), ch. 3.
///
/// - Coordinates: `pinion` and `wheel`, the angles of the two gears about z, rad. Input: `motor`, a torque on the pinion,
///   N·m. They turn against each other: `r₁ θ₁ + r₂ θ₂ = 0`, a length of arc.
/// - With the motor's torque `M`: `(J₁ + (r₁/r₂)² J₂) θ̈₁ = M`, and the multiplier of `teeth` is the force between the
///   teeth, `−(r₁ J₂ / r₂²) θ̈₁`, N: negative where it holds the pinion back.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearPair {
    /// Moment of inertia of the small gear about its axis, kg·m².
    pub small_inertia: f64,
    /// Moment of inertia of the large gear about its axis, kg·m².
    pub large_inertia: f64,
    /// Pitch radius of the small gear, m.
    pub small_radius: f64,
    /// Pitch radius of the large gear, m.
    pub large_radius: f64,

    #[body(inertia = diagonal(small_inertia / 2, small_inertia / 2, small_inertia))]
    small: Body,
    #[body(inertia = diagonal(large_inertia / 2, large_inertia / 2, large_inertia))]
    large: Body,
    #[joint(ground -> small, about = z)]
    pinion: Pin,
    #[joint(ground.at((small_radius + large_radius) * x) -> large, about = z)]
    wheel: Pin,
    #[constraint(small_radius * pinion = -large_radius * wheel)]
    teeth: Holonomic,
    #[acts(on = pinion)]
    motor: Torque,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_near;
    use linkwork::prelude::*;

    const G: GearPair =
        GearPair { small_inertia: 2e-4, large_inertia: 3e-3, small_radius: 0.02, large_radius: 0.05 };

    #[test]
    fn reduced_inertia_and_tooth_force() {
        assert_eq!((GearPair::NC, GearPair::NP), (1, 1));
        let ratio: f64 = 0.4;
        let torque = 0.3;
        let expected = torque / (2e-4 + ratio * ratio * 3e-3);
        let (q, v) = (SVector::from([0.5, -0.2]), SVector::from([10.0, -4.0]));
        assert!(G.constraint_residuals(&q).amax() < 1e-17);
        let (a, force) = G.constrained_dynamics(&q, &v, &G.generalized_forces(&q, &[torque].into()));
        assert_near(a, [expected, -ratio * expected].into(), 1e-13);
        // The teeth push the pinion back.
        assert_near(force, [-ratio / 0.05 * 3e-3 * expected].into(), 1e-13);
    }

    /// From any angles to the nearest at which the teeth mesh.
    #[test]
    fn meshes() {
        let q = G.assemble(&[1.0, 0.3].into(), &[0]).expect("the wheel can follow");
        assert_near(q, [1.0, -0.4].into(), 1e-15);
    }
}
