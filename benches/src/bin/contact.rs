//! Steps of a quadruped with contacts at its feet, and of a humanoid on the corners of its soles. Prints
//! microseconds per step and accuracies as JSON for `benches/peers/contact.py`, which has the same robots for
//! MuJoCo.

use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use rustix::time::{ClockId, clock_gettime};

#[mechanism(
    urdf = "../models/urdf/solo12.urdf",
    base = free,
    limits = ignore,
    gravity = -9.81 * cos(slope) * z - 9.81 * sin(slope) * x
)]
struct Solo {
    slope: f64,
    #[contact(FL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    front_left: Contact,
    #[contact(FR_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    front_right: Contact,
    #[contact(HL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    hind_left: Contact,
    #[contact(HR_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    hind_right: Contact,
}

/// Humanoid with eight contacts, whose impulses the motion does not determine uniquely.
#[mechanism(urdf = "../models/urdf/simple_humanoid.urdf", base = free, limits = ignore, gravity = -9.81 * z)]
struct Humanoid {
    #[contact(l_ankle.at(0.16 * x + (0.12 * i - 0.06) * y - 0.1 * z), ground.plane(z), friction = 0.8)]
    left_toe: [Contact; 2],
    #[contact(l_ankle.at(-0.09 * x + (0.12 * i - 0.06) * y - 0.1 * z), ground.plane(z), friction = 0.8)]
    left_heel: [Contact; 2],
    #[contact(r_ankle.at(0.16 * x + (0.12 * i - 0.06) * y - 0.1 * z), ground.plane(z), friction = 0.8)]
    right_toe: [Contact; 2],
    #[contact(r_ankle.at(-0.09 * x + (0.12 * i - 0.06) * y - 0.1 * z), ground.plane(z), friction = 0.8)]
    right_heel: [Contact; 2],
}

type TimeSteppingMethod = TimeStepping<f64>;
type FinalSample = Sample<f64, 19, 18, 12>;

/// Target angles of the three joint drives of each leg, rad.
const POSTURE: [f64; 3] = [0.0, 0.8, -1.6];

/// Returns the torques of springs and dampers at the joints, with the given stiffness, N·m/rad. With zero
/// stiffness the robot collapses.
fn joint_spring_torques(q: &SVector<f64, 19>, v: &SVector<f64, 18>, stiffness: f64) -> SVector<f64, 12> {
    SVector::from_fn(|k, _| stiffness * (POSTURE[k % 3] - q[7 + k] - 0.025 * v[6 + k]))
}

/// Returns the state of the quadruped after `duration` seconds.
fn state_after_duration(
    m: &Solo,
    start: (SVector<f64, 19>, SVector<f64, 18>),
    stiffness: f64,
    method: TimeSteppingMethod,
    duration: f64,
) -> FinalSample {
    let run = simulate(m).from(start.0, start.1).inputs(|_, q, v| joint_spring_torques(q, v, stiffness));
    run.method(method).duration(duration).finish().expect("the robot moves")
}

/// Returns the processor time of a step of one millisecond of the quadruped, µs.
fn measure_quadruped_step(
    m: &Solo,
    start: (SVector<f64, 19>, SVector<f64, 18>),
    stiffness: f64,
    method: TimeSteppingMethod,
) -> f64 {
    minimum_step_time(500.0, || {
        state_after_duration(m, start, stiffness, method, 0.5);
    })
}

/// Returns the processor time per step of a run of `steps` steps, µs: the minimum over several runs.
fn minimum_step_time(steps: f64, run: impl Fn()) -> f64 {
    let cpu_time_in_microseconds = || {
        let time = clock_gettime(ClockId::ProcessCPUTime);
        time.tv_sec as f64 * 1e6 + time.tv_nsec as f64 * 1e-3
    };
    let times = (0..30).map(|_| {
        let begin = cpu_time_in_microseconds();
        run();
        cpu_time_in_microseconds() - begin
    });
    times.fold(f64::INFINITY, f64::min) / steps
}

/// Returns the times of the humanoid while it stands, collapses and is in the air, µs, and its creep, m/s.
/// Each link has at least 1 kg·m² about its own joint, so that the drives can be stiff.
fn measure_humanoid(method: TimeSteppingMethod) -> [f64; 4] {
    let m = Humanoid {};
    let high = m.neutral();
    let mut low = high;
    low[2] -= m.contact_gaps(&high).min() - 0.01;
    let simulate_final_state = |(q, v): (SVector<f64, 36>, SVector<f64, 35>),
                                stiffness: f64,
                                duration: f64| {
        let posture_control_torques = |q: &SVector<f64, 36>, v: &SVector<f64, 35>| {
            SVector::from_fn(|k, _| -stiffness * (q[7 + k] + 0.05 * v[6 + k]))
        };
        let run = simulate(&m).from(q, v).inputs(move |_, q, v| posture_control_torques(q, v)).method(method);
        let end = run.duration(duration).finish().expect("the robot moves");
        (end.q, end.v)
    };
    let still = SVector::zeros();
    let stands = simulate_final_state((low, still), 1e4, 8.0);
    let creep = (simulate_final_state(stands, 1e4, 1.0).0 - stands.0).fixed_rows::<3>(0).norm();
    let mut up = low;
    up[2] += 100.0;
    let minimum_step_time_of_simulation = |start, stiffness| {
        minimum_step_time(500.0, || {
            simulate_final_state(start, stiffness, 0.5);
        })
    };
    [
        minimum_step_time_of_simulation(stands, 1e4),
        minimum_step_time_of_simulation((low, still), 0.0),
        minimum_step_time_of_simulation((up, still), 1e4),
        creep,
    ]
}

/// Returns the table values for one kind of step as JSON.
fn measured_values_as_json(stepping: impl Fn(f64) -> TimeSteppingMethod) -> String {
    let standing_state_at_height = |m: &Solo, height: f64| {
        let mut q = m.neutral();
        q[2] = height;
        (0..12).for_each(|k| q[7 + k] = POSTURE[k % 3]);
        (q, SVector::zeros())
    };
    let method = stepping(1e-3);
    let (level, inclined) = (Solo { slope: 0.0 }, Solo { slope: 10.0_f64.to_radians() });
    let drop = standing_state_at_height(&level, 0.26);
    let resting_state_after_drop = |m: &Solo| {
        let end = state_after_duration(m, drop, 6.0, method, 8.0);
        (end.q, end.v)
    };
    // Velocity over the following second, m/s.
    let creep_distance = |m: &Solo| {
        let from = resting_state_after_drop(m);
        (state_after_duration(m, from, 6.0, method, 1.0).q.fixed_rows::<3>(0) - from.0.fixed_rows::<3>(0))
            .norm()
    };
    let stands = resting_state_after_drop(&level);
    let depth = -level.contact_gaps(&stands.0).min();
    let error_of_step_size = |h: f64| {
        let [coarse, fine] =
            [h, h / 10.0].map(|h| state_after_duration(&level, drop, 6.0, stepping(h), 0.2).q);
        (coarse - fine).fixed_rows::<3>(0).norm()
    };
    let [humanoid_standing, humanoid_collapsing, humanoid_free, humanoid_creep] = measure_humanoid(method);
    let all = [
        ("humanoid_standing", humanoid_standing),
        ("humanoid_collapsing", humanoid_collapsing),
        ("humanoid_free", humanoid_free),
        ("humanoid_creep", humanoid_creep),
        ("standing", measure_quadruped_step(&level, stands, 6.0, method)),
        ("collapsing", measure_quadruped_step(&level, drop, 0.0, method)),
        ("free", measure_quadruped_step(&level, standing_state_at_height(&level, 100.0), 6.0, method)),
        ("depth", depth),
        ("creep", creep_distance(&level)),
        ("inclined", creep_distance(&inclined)),
        ("one", error_of_step_size(1e-3)),
        ("two", error_of_step_size(2e-3)),
    ];
    let all = all.map(|(name, value)| format!("\"{name}\": {value}"));
    format!("{{{}}}", all.join(", "))
}

fn main() {
    let midpoint = measured_values_as_json(|h| TimeStepping::step(h).midpoint());
    println!("{{\"midpoint\": {midpoint}, \"classical\": {}}}", measured_values_as_json(TimeStepping::step));
}
