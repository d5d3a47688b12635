use linkwork::mechanism;

/// Quadrotor whose rotors follow their commands with a lag.
///
/// Source: Mahony, Kumar and Corke, *Multirotor Aerial Vehicles*, IEEE Robotics and Automation Magazine 19
/// (2012).
///
/// - Axes: forward, left, up, from the centre of mass; the ground's z is up. Inputs: commanded speeds of the
///   rotors, rad/s; states: their actual speeds, with `τ ω̇ = u − ω`. Front and back rotate in the opposite
///   direction of left and right.
/// - Each rotor has the thrust `k ω²`, and the reaction torque `∓ d ω²` on the hull about its upward axis.
/// - It hovers at `ω₀ = √(m g / (4 k))`. Transfer functions near hovering at rest:
///   `8 k ω₀ / (m s² (τ s + 1))` from all four commands to the height, `2 l k ω₀ / (I s (τ s + 1))` from the
///   left rotor to the roll rate, `2 d ω₀ / (I s (τ s + 1))` from the front rotor to the yaw rate, and
///   `−g / s²` from the roll angle to the lateral position.
#[mechanism(gravity = -g * z, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadrotor {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the quadrotor, kg.
    pub mass: f64,
    /// Moment of inertia of the quadrotor about its forward axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia of the quadrotor about its left axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia of the quadrotor about its upward axis, kg·m².
    pub izz: f64,
    /// Distance of the rotors from the centre of mass, m.
    pub arm: f64,
    /// Thrust per squared speed of a rotor, N·s².
    pub thrust: f64,
    /// Torque per squared speed of a rotor, N·m·s².
    pub drag: f64,
    /// Time constant of the rotors, s.
    pub lag: f64,

    front: Input,
    left: Input,
    back: Input,
    right: Input,
    /// Speed of the front rotor, rad/s.
    #[state(rate = (front - front_speed) / lag)]
    pub front_speed: State,
    /// Speed of the left rotor, rad/s.
    #[state(rate = (left - left_speed) / lag)]
    pub left_speed: State,
    /// Speed of the back rotor, rad/s.
    #[state(rate = (back - back_speed) / lag)]
    pub back_speed: State,
    /// Speed of the right rotor, rad/s.
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
