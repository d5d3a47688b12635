use linkwork::mechanism;

/// Bricard's linkage: six rods in a ring, joined by six pins, along the edges of a cube. Grübler's count gives no freedom
/// at all, and yet it moves: one of its conditions follows from the others.
///
/// Source: Bricard, *Leçons de cinématique* II (1927); IFToMM library of computational benchmark problems, A04: rods of one
/// metre and one kilogram, released from the cube for ten seconds; González, Dopico, Lugrís and Cuadrado, *A benchmarking
/// system for MBS simulation software*, Multibody Syst. Dyn. 16 (2006).
///
/// - Coordinates: `p1` to `p5`, the angles of five pins, rad. The sixth rod is the ground, and the pin `p6` closes the
///   ring. y points up. With all angles zero the ring goes along `x`, `−y`, `z`, `−x`, `y`, `−z`.
/// - The pins turn in turn by `θ` (`p1`, `p3`, `p5`) and `φ` (`p2`, `p4`), with `sin θ + sin φ + sin θ sin φ = 0`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BricardLinkage {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of each rod, kg.
    pub mass: f64,
    /// Length of each rod, m.
    pub length: f64,

    #[body(mass = mass, com = length / 2 * x, inertia = rod(mass, length, x))]
    rod1: Body,
    #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
    rod2: Body,
    #[body(mass = mass, com = length / 2 * z, inertia = rod(mass, length, z))]
    rod3: Body,
    #[body(mass = mass, com = -length / 2 * x, inertia = rod(mass, length, x))]
    rod4: Body,
    #[body(mass = mass, com = length / 2 * y, inertia = rod(mass, length, y))]
    rod5: Body,
    #[joint(ground -> rod1, about = y)]
    p1: Pin,
    #[joint(rod1.at(length * x) -> rod2, about = z)]
    p2: Pin,
    #[joint(rod2.at(-length * y) -> rod3, about = x)]
    p3: Pin,
    #[joint(rod3.at(length * z) -> rod4, about = y)]
    p4: Pin,
    #[joint(rod4.at(-length * x) -> rod5, about = z)]
    p5: Pin,
    #[joint(rod5.at(length * y) -> ground.at(length * z), about = x)]
    p6: Pin,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, precisely};
    use linkwork::{frame, prelude::*};

    const B: BricardLinkage = BricardLinkage { g: 9.81, mass: 1.0, length: 1.0 };

    /// The rods begin in corners of a cube of one metre, as in the benchmark.
    #[test]
    fn starts_along_the_edges_of_a_cube() {
        let q = B.neutral();
        let placed = [
            (B.frame_placement(frame!(BricardLinkage, "rod1"), &q), [0.0, 0.0, 0.0]),
            (B.frame_placement(frame!(BricardLinkage, "rod2"), &q), [1.0, 0.0, 0.0]),
            (B.frame_placement(frame!(BricardLinkage, "rod3"), &q), [1.0, -1.0, 0.0]),
            (B.frame_placement(frame!(BricardLinkage, "rod4"), &q), [1.0, -1.0, 1.0]),
            (B.frame_placement(frame!(BricardLinkage, "rod5"), &q), [0.0, -1.0, 1.0]),
        ];
        for (rod, corner) in placed {
            assert_eq!(rod.translation.vector, SVector::from(corner));
        }
    }

    #[test]
    fn one_condition_follows_from_the_others() {
        assert_eq!((BricardLinkage::NV, BricardLinkage::NP, BricardLinkage::NS), (5, 1, 1));
        let q = B.neutral();
        assert!(B.constraint_residuals(&q).amax() < 1e-15);
        let rows = B.constraint_jacobian(&q);
        let rank = (rows.transpose() * rows).symmetric_eigenvalues().iter().filter(|e| **e > 1e-9).count();
        assert_eq!(rank, 4);
    }

    /// Released from the cube it swings for ten seconds, through positions where all rods lie in one plane.
    #[test]
    fn swings() -> Result<(), Error> {
        let start = B.potential_energy(&B.neutral());
        let run = simulate(&B).method(precisely()).duration(10.0).sample_every(0.25);
        let mut farthest = 0.0_f64;
        for sample in run {
            let Sample { q, v, .. } = sample?;
            assert_close(B.kinetic_energy(&q, &v) + B.potential_energy(&q), start, 1e-10);
            let (odd, even) = (q[0].sin(), q[1].sin());
            assert_close(odd + even + odd * even, 0.0, 1e-12);
            assert!((q[2] - q[0]).abs().max((q[4] - q[0]).abs()).max((q[3] - q[1]).abs()) < 1e-11, "{q}");
            farthest = farthest.max(q[0]);
        }
        assert!(farthest > 3.0, "{farthest}");
        Ok(())
    }
}
