use linkwork::mechanism;

/// Declares a chain of particles on massless rods: for each link its joint, the point from which it hangs,
/// its rod, its particle, mass and length. (`[…]` because an endpoint is more than one token.)
macro_rules! pendulum_chain {
    (
        $(#[$doc:meta])* $name:ident:
        $($joint:ident = [$($parent:tt)+] -> $rod:ident with $bob:ident ($m:ident, $l:ident)),+
    ) => {
        $(#[$doc])*
        ///
        /// Source: Lagrange's hanging chain of particles, *Mécanique analytique* (1788); in modern notation
        /// Greenwood, *Advanced Dynamics* (2003), ch. 2.
        ///
        /// - Coordinates: the angle of each rod relative to the one above, `θ`, rad, the first from the
        ///   vertical; counter-clockwise seen from +z; y points up.
        /// - In the absolute angles `φ = L θ` (`L` the lower triangle of ones), with `μᵢⱼ` the mass below
        ///   both: `Mᵢⱼ = μᵢⱼ lᵢ lⱼ cos(φᵢ − φⱼ)`, `hᵢ = Σⱼ μᵢⱼ lᵢ lⱼ sin(φᵢ − φⱼ) φ̇ⱼ² + μᵢᵢ g lᵢ sin φᵢ`;
        ///   in the relative ones `Lᵀ M L` and `Lᵀ h`.
        #[mechanism(gravity = -g * y)]
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name {
            /// Gravitational acceleration, m/s².
            pub g: f64,
            $(
                /// Mass of the particle with this number from the top, kg.
                pub $m: f64,
                /// Length of the rod above the particle with this number from the top, m.
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
