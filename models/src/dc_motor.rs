use linkwork::mechanism;

/// Direct-current motor with the inductance and the back-EMF of its winding.
///
/// Source: Franklin, Powell and Emami-Naeini, *Feedback Control of Dynamic Systems* (2015), §2.3.
///
/// - Coordinate: `shaft`, rad; state: `current`, A. Input: `voltage`, V. The language has no electrical
///   units: the unit of the current is unknown to it, and those of the other electrical quantities follow.
/// - `L i̇ = u − k ω − R i` and `J ω̇ = k i − c ω`: the constant of the torque, N·m/A, is also that of the
///   back-EMF, V·s/rad.
/// - Steady speed `k u / (k² + R c)`; with the shaft at rest the current rises as `(1 − e^(−R t / L)) u / R`.
/// - The eigenvalues are the roots of `(L s + R)(J s + c) + k² = 0`.
#[mechanism(derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DcMotor {
    /// Resistance of the winding, Ω.
    pub resistance: f64,
    /// Inductance of the winding, H.
    pub inductance: f64,
    /// Torque per current, N·m/A, and back-EMF per speed, V·s/rad.
    pub constant: f64,
    /// Moment of inertia of the rotor, kg·m².
    pub inertia: f64,
    /// Coefficient of the bearings' friction, N·m·s/rad.
    pub friction: f64,

    voltage: Input,
    /// Current of the winding, A.
    #[state(rate = (voltage - constant * rate(shaft) - resistance * current) / inductance)]
    pub current: State,

    #[body(inertia = diagonal(inertia, inertia, inertia))]
    rotor: Body,
    #[joint(ground -> rotor, about = z)]
    shaft: Pin,
    #[acts(on = shaft, value = constant * current)]
    winding: Torque,
    #[acts(on = shaft, damping = friction)]
    bearing: Dashpot,
}
