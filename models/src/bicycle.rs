use linkwork::mechanism;

/// Bicycle with a rigid rider whose hands are off the handlebar: four rigid bodies, two of them wheels that
/// roll on their sharp rims. In a range of speeds it balances itself.
///
/// Source: Whipple, *The stability of the motion of a bicycle*, Q. J. Pure Appl. Math. 30 (1899); Meijaard,
/// Papadopoulos, Ruina and Schwab, *Linearized dynamics equations for the balance and steer of a bicycle: a
/// benchmark and review*, Proc. R. Soc. A 463 (2007), whose parameters are [`BENCHMARK`](Self::BENCHMARK).
///
/// - Configuration: position and unit quaternion `pose` of the rear frame, then the rotation of the rear
///   wheel `hub`, the steering angle `steer` and the rotation of the front wheel `front_hub`, rad. In the
///   upright straight configuration x points forward, y to the right, z down, and the origin is where the
///   rear wheel touches the road.
/// - Riding straight at the speed `v`, lean and steer obey `M q̈ + v C₁ q̇ + (g K₀ + v² K₂) q = 0`. The
///   benchmark weaves up to 4.292 m/s, balances itself from there to 6.024 m/s, and falls over slowly
///   (capsizes) above.
#[mechanism(gravity = g * z, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bicycle {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Distance between the contact points of the wheels, m.
    pub wheelbase: f64,
    /// Distance of the front wheel's contact point behind the steering axis, m.
    pub trail: f64,
    /// Angle of the steering axis from the vertical, rad.
    pub tilt: f64,
    /// Radius of the rear wheel, m.
    pub rear_radius: f64,
    /// Mass of the rear wheel, kg.
    pub rear_mass: f64,
    /// Moment of inertia of the rear wheel across its axle, kg·m².
    pub rear_across: f64,
    /// Moment of inertia of the rear wheel about its axle, kg·m².
    pub rear_axial: f64,
    /// Forward position of the centre of mass of frame and rider, m.
    pub frame_x: f64,
    /// Downward position of the centre of mass of frame and rider, m.
    pub frame_z: f64,
    /// Mass of frame and rider, kg.
    pub frame_mass: f64,
    /// Moment of inertia of frame and rider about x, kg·m².
    pub frame_ixx: f64,
    /// Moment of inertia of frame and rider about y, kg·m².
    pub frame_iyy: f64,
    /// Moment of inertia of frame and rider about z, kg·m².
    pub frame_izz: f64,
    /// Product of inertia of frame and rider (entry of the matrix), kg·m².
    pub frame_ixz: f64,
    /// Forward position of the centre of mass of fork and handlebar, m.
    pub fork_x: f64,
    /// Downward position of the centre of mass of fork and handlebar, m.
    pub fork_z: f64,
    /// Mass of fork and handlebar, kg.
    pub fork_mass: f64,
    /// Moment of inertia of fork and handlebar about x, kg·m².
    pub fork_ixx: f64,
    /// Moment of inertia of fork and handlebar about y, kg·m².
    pub fork_iyy: f64,
    /// Moment of inertia of fork and handlebar about z, kg·m².
    pub fork_izz: f64,
    /// Product of inertia of fork and handlebar (entry of the matrix), kg·m².
    pub fork_ixz: f64,
    /// Radius of the front wheel, m.
    pub front_radius: f64,
    /// Mass of the front wheel, kg.
    pub front_mass: f64,
    /// Moment of inertia of the front wheel across its axle, kg·m².
    pub front_across: f64,
    /// Moment of inertia of the front wheel about its axle, kg·m².
    pub front_axial: f64,

    #[body(
        mass = frame_mass,
        com = frame_x * x + frame_z * z,
        inertia = [[frame_ixx, 0, frame_ixz], [0, frame_iyy, 0], [frame_ixz, 0, frame_izz]]
    )]
    frame: Body,
    #[body(mass = rear_mass, inertia = diagonal(rear_across, rear_axial, rear_across))]
    rear: Body,
    #[body(
        mass = fork_mass,
        com = (fork_x - wheelbase - trail) * x + fork_z * z,
        inertia = [[fork_ixx, 0, fork_ixz], [0, fork_iyy, 0], [fork_ixz, 0, fork_izz]]
    )]
    fork: Body,
    #[body(mass = front_mass, inertia = diagonal(front_across, front_axial, front_across))]
    front: Body,
    #[joint(ground -> frame)]
    pose: Free,
    #[joint(frame.at(-rear_radius * z) -> rear, about = y)]
    hub: Pin,
    #[joint(frame.at((wheelbase + trail) * x) -> fork, about = sin(tilt) * x + cos(tilt) * z)]
    steer: Pin,
    #[joint(fork.at(-trail * x - front_radius * z) -> front, about = y)]
    front_hub: Pin,
    #[constraint(rolls(rear.circle(rear_radius, y), ground.plane(-z)))]
    rear_contact: Rolling,
    #[constraint(rolls(front.circle(front_radius, y), ground.plane(-z)))]
    front_contact: Rolling,
}

impl Bicycle {
    /// Parameters of the published benchmark.
    pub const BENCHMARK: Bicycle = Bicycle {
        g: 9.81,
        wheelbase: 1.02,
        trail: 0.08,
        tilt: std::f64::consts::PI / 10.0,
        rear_radius: 0.3,
        rear_mass: 2.0,
        rear_across: 0.0603,
        rear_axial: 0.12,
        frame_x: 0.3,
        frame_z: -0.9,
        frame_mass: 85.0,
        frame_ixx: 9.2,
        frame_iyy: 11.0,
        frame_izz: 2.8,
        frame_ixz: 2.4,
        fork_x: 0.9,
        fork_z: -0.7,
        fork_mass: 4.0,
        fork_ixx: 0.05892,
        fork_iyy: 0.06,
        fork_izz: 0.00708,
        fork_ixz: -0.00756,
        front_radius: 0.35,
        front_mass: 3.0,
        front_across: 0.1405,
        front_axial: 0.28,
    };
}
