use linkwork::mechanism;

/// Rotor whose PID controller has a torque limit, an anti-windup and a delayed measurement.
///
/// Source: Åström and Hägglund, *Advanced PID Control* (2006), §3.5 (windup), §2.7 (dead time).
///
/// - Coordinate: `shaft`, rad. Input: `target`, the desired angle. States: `integral`, the integral part of
///   the controller, N·m; `smoothed`, the low-pass filtered error of its differential part; `filtered` and
///   `drift`, those of the delay.
/// - The delay of `T` seconds is Padé's of second order, `1 − T s / D` with `D = 1 + T s / 2 + T² s² / 12`:
///   it has the gain 1 at all frequencies, and the phase `−2 atan((ω T / 2) / (1 − ω² T² / 12))`, which
///   differs from `−ω T` by less than `(ω T)⁵ / 720`.
/// - `demand = kp e + integral + kd N (e − smoothed)`; the torque is the demand within `±limit`. The excess
///   is fed back to the integral: at a constant error the demand exceeds the limit by `ki e / tracking`.
/// - Within the limit, the eigenvalues are the roots of
///   `D s (J s² + c s)(s + N) + (D − T s)(kp s (s + N) + ki (s + N) + kd N s²) = 0`.
#[mechanism(derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayedServo {
    /// Moment of inertia of the rotor, kg·m².
    pub inertia: f64,
    /// Coefficient of the bearings' friction, N·m·s/rad.
    pub friction: f64,
    /// Delay of the measured angle, s.
    pub delay: f64,
    /// Proportional gain of the controller, N·m/rad.
    pub kp: f64,
    /// Integral gain of the controller, N·m/(rad·s).
    pub ki: f64,
    /// Derivative gain of the controller, N·m·s/rad.
    pub kd: f64,
    /// Bandwidth of the derivative part of the controller, 1/s.
    pub bandwidth: f64,
    /// Maximum torque of the controller, N·m.
    pub limit: f64,
    /// Rate at which the integral part follows the limited torque (anti-windup), 1/s.
    pub tracking: f64,

    target: Input,
    /// Low-pass filtered angle, rad.
    #[state(rate = drift)]
    pub filtered: State,
    /// Rate of the low-pass filtered angle, rad/s.
    #[state(rate = 12 / (delay * delay) * (shaft - filtered) - 6 / delay * drift)]
    pub drift: State,
    #[define(shaft - delay * drift)]
    measured: Scalar,

    #[define(target - measured)]
    error: Scalar,
    /// Low-pass filtered error, rad.
    #[state(rate = bandwidth * (error - smoothed))]
    pub smoothed: State,
    /// Integral part of the torque, N·m.
    #[state(rate = ki * error + tracking * (applied - demand))]
    pub integral: State,
    #[define(kp * error + integral + kd * bandwidth * (error - smoothed))]
    demand: Scalar,
    #[define(min(max(demand, -limit), limit))]
    applied: Scalar,

    #[body(inertia = diagonal(inertia, inertia, inertia))]
    rotor: Body,
    #[joint(ground -> rotor, about = z)]
    shaft: Pin,
    #[acts(on = shaft, damping = friction)]
    bearing: Dashpot,
    #[acts(on = shaft, value = applied)]
    motor: Torque,
    #[output(measured)]
    seen: Scalar,
}
