use linkwork::mechanism;

/// Writes a chain of particles on massless rods: for each link its joint, what it hangs from, its rod, its particle,
/// mass and length. (`[…]` because an endpoint is more than one token.)
macro_rules! pendulum_chain {
    (
        $(#[$doc:meta])* $name:ident:
        $($joint:ident = [$($parent:tt)+] -> $rod:ident with $bob:ident ($m:ident, $l:ident)),+
    ) => {
        $(#[$doc])*
        ///
        /// Source: Lagrange's hanging chain of particles, *Mécanique analytique* (1788); in modern notation Greenwood,
        /// *Advanced Dynamics* (2003), ch. 2.
        ///
        /// - Coordinates: the angle of each rod relative to the one above, `θ`, rad, the first from the vertical;
        ///   counter-clockwise seen from +z; y points up.
        /// - In the absolute angles `φ = L θ` (`L` the lower triangle of ones), with `μᵢⱼ` the mass below both:
        ///   `Mᵢⱼ = μᵢⱼ lᵢ lⱼ cos(φᵢ − φⱼ)`, `hᵢ = Σⱼ μᵢⱼ lᵢ lⱼ sin(φᵢ − φⱼ) φ̇ⱼ² + μᵢᵢ g lᵢ sin φᵢ`;
        ///   in the relative ones `Lᵀ M L` and `Lᵀ h`.
        #[mechanism(gravity = -g * y)]
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name {
            /// Acceleration of free fall, m/s².
            pub g: f64,
            $(
                /// Mass of the particle with this number from the top, kg.
                pub $m: f64,
                /// Length of the rod that holds the particle with this number from the top, m.
                pub $l: f64,
            )+
            $(
                #[body]
                $rod: Body,
                #[particle(mass = $m, at = $rod.at(-$l * y))]
                $bob: Particle,
                #[joint($($parent)+ -> $rod, about = z)]
                $joint: Pin,
            )+
        }
    };
}

pendulum_chain! {
    /// Three pendulums, each hung from the particle of the one above.
    TriplePendulum:
    pin1 = [ground] -> rod1 with bob1 (m1, l1),
    pin2 = [rod1.at(-l1 * y)] -> rod2 with bob2 (m2, l2),
    pin3 = [rod2.at(-l2 * y)] -> rod3 with bob3 (m3, l3)
}

pendulum_chain! {
    /// Five pendulums, each hung from the particle of the one above.
    QuintuplePendulum:
    pin1 = [ground] -> rod1 with bob1 (m1, l1),
    pin2 = [rod1.at(-l1 * y)] -> rod2 with bob2 (m2, l2),
    pin3 = [rod2.at(-l2 * y)] -> rod3 with bob3 (m3, l3),
    pin4 = [rod3.at(-l3 * y)] -> rod4 with bob4 (m4, l4),
    pin5 = [rod4.at(-l4 * y)] -> rod5 with bob5 (m5, l5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_near;
    use linkwork::prelude::*;

    /// The closed form in relative angles: mass matrix and bias forces.
    fn closed_form<const N: usize>(
        g: f64,
        (m, l): ([f64; N], [f64; N]),
        q: &SVector<f64, N>,
        v: &SVector<f64, N>,
    ) -> (SMatrix<f64, N, N>, SVector<f64, N>) {
        let sums = SMatrix::<f64, N, N>::from_fn(|i, j| if i >= j { 1.0 } else { 0.0 });
        let (phi, rate) = (sums * q, sums * v);
        let below = |i: usize, j: usize| m[i.max(j)..].iter().sum::<f64>() * l[i] * l[j];
        let mass = SMatrix::<f64, N, N>::from_fn(|i, j| below(i, j) * (phi[i] - phi[j]).cos());
        let bias = SVector::<f64, N>::from_fn(|i, _| {
            let turning: f64 =
                (0..N).map(|j| below(i, j) * (phi[i] - phi[j]).sin() * rate[j] * rate[j]).sum();
            turning + below(i, i) / l[i] * g * phi[i].sin()
        });
        (sums.transpose() * mass * sums, sums.transpose() * bias)
    }

    #[test]
    fn three_links() {
        let p = TriplePendulum { g: 9.81, m1: 1.0, l1: 0.5, m2: 0.7, l2: 0.4, m3: 1.4, l3: 0.8 };
        let (q, v) = (SVector::from([0.4, -1.2, 2.5]), SVector::from([1.0, -2.0, 0.7]));
        let (mass, bias) = closed_form(9.81, ([1.0, 0.7, 1.4], [0.5, 0.4, 0.8]), &q, &v);
        assert_near(p.mass_matrix(&q), mass, 1e-13);
        assert_near(p.bias_forces(&q, &v), bias, 1e-13);
    }

    #[test]
    fn five_links() {
        let (m, l) = ([1.0, 0.7, 1.4, 0.3, 2.0], [0.5, 0.4, 0.8, 1.1, 0.6]);
        let [m1, m2, m3, m4, m5] = m;
        let [l1, l2, l3, l4, l5] = l;
        let p = QuintuplePendulum { g: 9.81, m1, m2, m3, m4, m5, l1, l2, l3, l4, l5 };
        let (q, v) = (SVector::from([0.4, -1.2, 2.5, 0.3, -0.9]), SVector::from([1.0, -2.0, 0.7, 1.9, -3.0]));
        let (mass, bias) = closed_form(9.81, (m, l), &q, &v);
        assert_near(p.mass_matrix(&q), mass, 1e-13);
        assert_near(p.bias_forces(&q, &v), bias, 1e-13);
    }
}
