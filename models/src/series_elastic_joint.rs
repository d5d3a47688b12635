use linkwork::mechanism;

/// Pendulum that a motor drives through a spring: a series-elastic joint, whose spring measures the torque.
///
/// Source: Pratt and Williamson, *Series elastic actuators*, IROS (1995); Spong, *Modeling and control of
/// elastic joint robots*, ASME J. Dynamic Systems, Measurement, and Control 109 (1987).
///
/// - Coordinates: `motor` and `joint`, the angles of the rotor behind its gear and of the link from the
///   downward vertical, rad. Input: `drive`, the motor's torque behind the gear. Output: `torque`, the
///   spring's torque on the link.
/// - `J motor'' = τ − T` and `⅓ m l² joint'' = T − ½ m g l sin(joint)`, with the torque of spring and damper
///   `T = k (motor − joint) + c (motor' − joint')`.
/// - With the link fixed, the transfer function from motor torque to spring torque is
///   `(c s + k) / (J s² + c s + k)`: the bandwidth of the joint is `√(k / J)`.
#[mechanism(gravity = -g * y, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesElasticJoint {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the link, kg.
    pub mass: f64,
    /// Length of the link, m.
    pub length: f64,
    /// Inertia of the rotor times the squared gear ratio, kg·m².
    pub rotor_inertia: f64,
    /// Stiffness of the spring, N·m/rad.
    pub stiffness: f64,
    /// Damping of the spring, N·m·s/rad.
    pub damping: f64,

    #[body(inertia = diagonal(rotor_inertia, rotor_inertia, rotor_inertia))]
    rotor: Body,
    #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
    link: Body,
    #[joint(ground -> rotor, about = z)]
    motor: Pin,
    #[joint(ground -> link, about = z)]
    joint: Pin,
    #[acts(on = motor - joint, stiffness = stiffness)]
    coil: Spring,
    #[acts(on = motor - joint, damping = damping)]
    loss: Dashpot,
    #[acts(on = motor)]
    drive: Torque,
    #[output(stiffness * (motor - joint) + damping * (rate(motor) - rate(joint)))]
    torque: Scalar,
}
