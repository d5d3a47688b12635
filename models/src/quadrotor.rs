use linkwork::mechanism;

/// A quadrotor whose rotors follow their commands late.
///
/// Source: Mahony, Kumar and Corke, *Multirotor Aerial Vehicles*, IEEE Robotics and Automation Magazine 19
/// (2012).
///
/// - Axes: forward, left, up, from the centre of mass; the ground's z is up. Inputs: speeds that the rotors
///   shall have, rad/s; states: those they have, with `τ ω̇ = u − ω`. Front and back turn against left and
///   right.
/// - Each rotor gives the thrust `k ω²`, and turns the hull about its upward axis by `∓ d ω²`.
/// - It hovers at `ω₀ = √(m g / (4 k))`. There, near rest: the height follows all four commands by
///   `8 k ω₀ / (m s² (τ s + 1))`, the roll rate that of the left rotor by `2 l k ω₀ / (I s (τ s + 1))`, the
///   yaw rate that of the front by `2 d ω₀ / (I s (τ s + 1))`; sideways it goes by `−g / s²` of the roll.
#[mechanism(gravity = -g * z, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadrotor {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Moment of inertia about the forward axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia about the left axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia about the upward axis, kg·m².
    pub izz: f64,
    /// Distance of the rotors from the centre of mass, m.
    pub arm: f64,
    /// Thrust by the squared speed of a rotor, N·s².
    pub thrust: f64,
    /// Torque by the squared speed of a rotor, N·m·s².
    pub drag: f64,
    /// How late the rotors are, s.
    pub lag: f64,

    front: Input,
    left: Input,
    back: Input,
    right: Input,
    /// Speed of the rotor, rad/s.
    #[state(rate = (front - front_speed) / lag)]
    pub front_speed: State,
    /// Speed of the rotor, rad/s.
    #[state(rate = (left - left_speed) / lag)]
    pub left_speed: State,
    /// Speed of the rotor, rad/s.
    #[state(rate = (back - back_speed) / lag)]
    pub back_speed: State,
    /// Speed of the rotor, rad/s.
    #[state(rate = (right - right_speed) / lag)]
    pub right_speed: State,

    #[body(mass = mass, inertia = diagonal(ixx, iyy, izz))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,

    #[define(front_speed * front_speed)]
    of_front: Scalar,
    #[define(left_speed * left_speed)]
    of_left: Scalar,
    #[define(back_speed * back_speed)]
    of_back: Scalar,
    #[define(right_speed * right_speed)]
    of_right: Scalar,
    #[acts(on = hull, value = thrust * (of_front + of_left + of_back + of_right) * hull.z)]
    lift: Force,
    #[acts(
        on = hull,
        value = arm * thrust * (of_left - of_right) * hull.x + arm * thrust * (of_back - of_front) * hull.y
            + drag * (of_front - of_left + of_back - of_right) * hull.z
    )]
    turn: Torque,

    #[output(r(hull / ground))]
    position: Vector,
    #[output(omega(hull / ground), resolved_in = hull)]
    turning: Vector,
}
