use linkwork::mechanism;

/// Satellite that rotates by means of reaction wheels, one about each axis.
///
/// Source: Hughes, *Spacecraft Attitude Dynamics* (1986), ch. 6 and 7, on gyrostats.
///
/// - `attitude` is that of the hull in inertial axes, a ball joint in the common centre of mass; `x_spin`,
///   `y_spin`, `z_spin` are the wheels' rotations in the hull, rad. Inputs: torques of the motors, N·m.
/// - The motors do not change the total angular momentum. From rest about one axis the hull rotates by
///   `−C / (I + C)` times the rotation of the wheel, with the wheel's moment of inertia `C` and that of all
///   other bodies, `I`.
/// - With the angular momentum `h` in the wheel about y, the hull near rest nutates at `h / √(I₁ I₃)`, where
///   the moments of inertia about x and z exclude the wheels that rotate freely about these axes.
/// - Rotating at `ν` about x, with the momentum `h` in that axis's wheel, it nutates at
///   `√((h + (I₁ − I₂) ν) (h + (I₁ − I₃) ν) / (I₂ I₃))`, and tumbles if the product is negative.
#[mechanism(derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheeledSatellite {
    /// Mass of the hull, kg.
    pub mass: f64,
    /// Moment of inertia of the hull about x, kg·m², with the wheels' masses as points.
    pub ixx: f64,
    /// Moment of inertia of the hull about y, kg·m².
    pub iyy: f64,
    /// Moment of inertia of the hull about z, kg·m².
    pub izz: f64,
    /// Mass of a wheel, kg.
    pub wheel_mass: f64,
    /// Moment of inertia of a wheel about its axis, kg·m²; across it is half.
    pub wheel: f64,

    #[body(mass = mass, inertia = diagonal(ixx, iyy, izz))]
    hull: Body,
    #[body(mass = wheel_mass, inertia = diagonal(wheel, wheel / 2, wheel / 2))]
    x_wheel: Body,
    #[body(mass = wheel_mass, inertia = diagonal(wheel / 2, wheel, wheel / 2))]
    y_wheel: Body,
    #[body(mass = wheel_mass, inertia = diagonal(wheel / 2, wheel / 2, wheel))]
    z_wheel: Body,
    #[joint(ground -> hull)]
    attitude: Ball,
    #[joint(hull -> x_wheel, about = x)]
    x_spin: Pin,
    #[joint(hull -> y_wheel, about = y)]
    y_spin: Pin,
    #[joint(hull -> z_wheel, about = z)]
    z_spin: Pin,
    #[acts(on = x_spin)]
    x_motor: Torque,
    #[acts(on = y_spin)]
    y_motor: Torque,
    #[acts(on = z_spin)]
    z_motor: Torque,

    #[output(angular_momentum(hull / ground) + angular_momentum(x_wheel / ground) + angular_momentum(y_wheel / ground)
        + angular_momentum(z_wheel / ground))]
    total: Vector,
}
