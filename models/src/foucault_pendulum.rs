use linkwork::mechanism;

/// Foucault's pendulum: a pendulum over the rotating earth.
///
/// Source: Foucault, *Démonstration physique du mouvement de rotation de la terre* (1851); Landau and
/// Lifshitz, *Mechanics* (1976), §39, problem 3.
///
/// - The ground frame is inertial; the laboratory rotates with the earth about z, with its own x up, y east,
///   z north. The centrifugal force on the suspension is included in the local `g`, as usual. Functions have
///   the time as their first argument.
/// - Coordinates: `suspension.first`, `a`, about the direction south, `suspension.second`, `b`, about the
///   rotated east axis, rad. The bob is at `x = −l sin b` south, `y = l sin a cos b` east, `−l cos a cos b`
///   up.
/// - Small oscillations, with `ω² = g/l` and `Ωᵥ = Ω sin λ`, the vertical component of the earth's rotation
///   at the latitude `λ`: `ẍ + ω² x = 2 Ωᵥ ẏ`, `ÿ + ω² y = −2 Ωᵥ ẋ` up to terms in `Ω²`: the plane of
///   oscillation rotates with `−Ωᵥ`, clockwise in the north.
/// - At the pole (`λ = ½π`) the motion is exactly that of the spherical pendulum in a frame at rest.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoucaultPendulum {
    /// Local gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the bob, kg.
    pub mass: f64,
    /// Length of the wire, m.
    pub length: f64,
    /// Rate of the earth's rotation, rad/s: 7.292e-5.
    pub earth_rate: f64,
    /// Latitude, rad, positive north.
    pub latitude: f64,

    #[frame(ground, z(earth_rate * t), y(-latitude))]
    here: Frame,
    #[body(frame = here)]
    laboratory: Body,
    #[body]
    wire: Body,
    #[particle(mass = mass, at = wire.at(-length * x))]
    bob: Particle,
    #[joint(laboratory -> wire, about = (-z, y))]
    suspension: Universal,
    #[energy(mass * g * dot(r(bob / ground), here.x))]
    weight: Potential,
}
