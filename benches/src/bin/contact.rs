//! Steps of a quadruped with contacts at its feet: microseconds, and how exact they are, as JSON for `benches/peers/contact.py`,
//! which has the same robot for MuJoCo.

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

type End = Sample<f64, 19, 18, 12>;

/// What the joints are driven to.
const POSTURE: [f64; 3] = [0.0, 0.8, -1.6];

/// Springs and dampers at the joints, N·m/rad and N·m·s/rad; none where the robot collapses.
fn drives(q: &SVector<f64, 19>, v: &SVector<f64, 18>, stiffness: f64) -> SVector<f64, 12> {
    SVector::from_fn(|k, _| stiffness * (POSTURE[k % 3] - q[7 + k] - 0.025 * v[6 + k]))
}

/// Where `duration` seconds lead.
fn end(m: &Solo, start: (SVector<f64, 19>, SVector<f64, 18>), stiffness: f64, h: f64, duration: f64) -> End {
    let run = simulate(m).from(start.0, start.1).inputs(|_, q, v| drives(q, v, stiffness));
    run.method(TimeStepping::step(h)).duration(duration).finish().expect("the robot moves")
}

/// Microseconds of the process in a step: the least of several runs.
fn time(m: &Solo, start: (SVector<f64, 19>, SVector<f64, 18>), stiffness: f64, h: f64, duration: f64) -> f64 {
    let now = || {
        let time = clock_gettime(ClockId::ProcessCPUTime);
        time.tv_sec as f64 * 1e6 + time.tv_nsec as f64 * 1e-3
    };
    let times = (0..30).map(|_| {
        let begin = now();
        end(m, start, stiffness, h, duration);
        now() - begin
    });
    times.fold(f64::INFINITY, f64::min) / (duration / h)
}

fn main() {
    let posed = |m: &Solo, height: f64| {
        let mut q = m.neutral();
        q[2] = height;
        (0..12).for_each(|k| q[7 + k] = POSTURE[k % 3]);
        (q, SVector::zeros())
    };
    let (level, inclined) = (Solo { slope: 0.0 }, Solo { slope: 10.0_f64.to_radians() });
    let drop = posed(&level, 0.26);
    let settled = |m: &Solo| {
        let end = end(m, drop, 6.0, 1e-3, 8.0);
        (end.q, end.v)
    };
    // Metres a second over the second that follows.
    let creep = |m: &Solo| {
        let from = settled(m);
        (end(m, from, 6.0, 1e-3, 1.0).q.fixed_rows::<3>(0) - from.0.fixed_rows::<3>(0)).norm()
    };
    let stands = settled(&level);
    let depth = -level.contact_gaps(&stands.0).min();
    let difference = |h: f64| {
        let [coarse, fine] = [h, h / 10.0].map(|h| end(&level, drop, 6.0, h, 0.2).q);
        (coarse - fine).fixed_rows::<3>(0).norm()
    };
    println!(
        "{{\"standing\": {}, \"collapsing\": {}, \"free\": {}, \"depth\": {}, \"creep\": {}, \"inclined\": {}, \"one\": {}, \"two\": {}}}",
        time(&level, stands, 6.0, 1e-3, 0.5),
        time(&level, drop, 0.0, 1e-3, 0.5),
        time(&level, posed(&level, 100.0), 6.0, 1e-3, 0.5),
        depth,
        creep(&level),
        creep(&inclined),
        difference(1e-3),
        difference(2e-3)
    );
}
