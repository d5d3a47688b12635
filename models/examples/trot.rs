//! Quadruped that trots and walks: a gait generator moves the desired feet, joint springs and dampers follow
//! it, and contact forces result from the ground.
//!
//! During stance a foot moves backwards under its hip, and during swing it returns above the ground. The
//! joints are compliant, so that the robot moves at half to three quarters of the commanded speed. In a trot,
//! each diagonal pair of feet stands half of the time; in a walk, one foot after the other is lifted.
//! Source: Hildebrand, *Symmetrical gaits of horses*, Science 150 (1965). The controller does not know the
//! contacts; the ground forces are read from the simulation, as with force plates.
//!
//! ```text
//! cargo run --release --example trot -p linkwork-models
//! ```

use linkwork::contact;
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;

/// Quadruped Solo 12 on the ground, with a sphere as each foot.
#[mechanism(urdf = "urdf/solo12.urdf", base = free, gravity = -9.81 * z, limits = ignore)]
struct WalkingSolo {
    #[contact(FL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    front_left: Contact,
    #[contact(FR_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    front_right: Contact,
    #[contact(HL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    hind_left: Contact,
    #[contact(HR_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    hind_right: Contact,
}

type Configuration = SVector<f64, 19>;
type Velocity = SVector<f64, 18>;

/// Length of the thigh, and of the shank, of each leg, m.
const SEGMENT: f64 = 0.16;
/// Height of the hips above the feet, m. The constant below is the height of a lifted foot, m.
const HEIGHT: f64 = 0.23;
const LIFT: f64 = 0.04;
/// Stiffness of the joint springs, N·m/rad. The constant below is their damping, N·m·s/rad.
const STIFFNESS: f64 = 30.0;
const DAMPING: f64 = 0.5;
/// Time in which the gait grows from standing to its full amplitude, s.
const BEGINS: f64 = 1.0;

/// Gait: timing and speed of the feet.
struct GaitTiming {
    name: &'static str,
    /// Period of a gait cycle, s.
    period: f64,
    /// Fraction of a gait cycle in which a foot stands.
    duty: f64,
    /// Phase of each foot as a fraction of a cycle: front left and right, hind left and right.
    phases: [f64; 4],
    /// Backward speed of the feet in stance, m/s.
    speed: f64,
}

const TROT: GaitTiming =
    GaitTiming { name: "trot", period: 0.4, duty: 0.5, phases: [0.0, 0.5, 0.5, 0.0], speed: 0.3 };
const WALK: GaitTiming =
    GaitTiming { name: "walk", period: 0.6, duty: 0.8, phases: [0.25, 0.75, 0.0, 0.5], speed: 0.1 };

impl GaitTiming {
    /// Returns the desired position of a foot relative to its hip, forwards and up, m.
    fn desired_foot_position(&self, foot: usize, t: f64) -> [f64; 2] {
        let grown = (t / BEGINS).clamp(0.0, 1.0);
        let reach = grown * self.speed * self.duty * self.period / 2.0;
        let cycle = (t / self.period + self.phases[foot]).rem_euclid(1.0);
        if cycle < self.duty {
            return [reach * (1.0 - 2.0 * cycle / self.duty), -HEIGHT];
        }
        let swing = (cycle - self.duty) / (1.0 - self.duty);
        let angle = core::f64::consts::PI * swing;
        [-reach * angle.cos(), -HEIGHT + grown * LIFT * angle.sin().powi(2)]
    }

    /// Returns the angles of hip, thigh and shank for the desired foot position at a time, rad.
    fn desired_leg_angles(&self, foot: usize, t: f64) -> [f64; 3] {
        let [x, z] = self.desired_foot_position(foot, t);
        let knee = -2.0 * (x.hypot(z) / (2.0 * SEGMENT)).acos();
        [0.0, (-x).atan2(-z) - knee / 2.0, knee]
    }

    /// Returns the torques of the joints, N·m.
    fn joint_torques(&self, t: f64, q: &Configuration, v: &Velocity) -> SVector<f64, 12> {
        let h = 1e-4;
        SVector::from_fn(|k, _| {
            let [wanted, soon] = [t, t + h].map(|t| self.desired_leg_angles(k / 3, t)[k % 3]);
            STIFFNESS * (wanted - q[7 + k]) + DAMPING * ((soon - wanted) / h - v[6 + k])
        })
    }
}

/// Returns the tilt of the trunk, rad.
fn trunk_tilt(q: &Configuration) -> f64 {
    // Cosine of the angle between the vertical axes of trunk and ground.
    (1.0 - 2.0 * (q[3] * q[3] + q[4] * q[4])).clamp(-1.0, 1.0).acos()
}

/// Simulates a gait for some seconds, and checks its speed and the posture of the trunk.
fn simulate_gait(gait: &GaitTiming, duration: f64) -> Result<(), Box<dyn std::error::Error>> {
    let robot = WalkingSolo {};
    let mut start = robot.neutral();
    for foot in 0..4 {
        start.fixed_rows_mut::<3>(7 + 3 * foot).copy_from_slice(&gait.desired_leg_angles(foot, 0.0));
    }
    start[2] -= robot.contact_gaps(&start).min();
    let (h, weight) = (1e-3, robot.total_mass() * 9.81);
    let run = simulate(&robot)
        .from(start, Velocity::zeros())
        .control_every(h, |t, q, v| gait.joint_torques(t, q, v))
        .method(TimeStepping::step(h))
        .duration(duration);
    println!("{}\n  t, s   way, m   height, m   lean, mrad   feet that stand", gait.name);
    // Mean ground force over whole cycles, and the slip of the feet.
    let cycles = (duration - BEGINS) / gait.period;
    let since = duration - cycles.floor() * gait.period;
    let (mut pressed, mut steps, mut begin, mut feet) = (0.0, 0.0, start, 0);
    let mut end = (0.0, start, Velocity::zeros());
    for (k, sample) in run.enumerate() {
        let sample = sample?;
        if sample.t < since {
            begin = sample.q;
        } else {
            let (t, q, v) = &end;
            let forces = contact::forces(&robot, *t, q, v, &gait.joint_torques(*t, q, v), h)?;
            pressed += (0..4).map(|foot| forces[3 * foot]).sum::<f64>();
            steps += 1.0;
        }
        end = (sample.t, sample.q, sample.v);
        let stand = robot.contact_gaps(&sample.q).iter().filter(|gap| **gap < 1e-6).count();
        feet = feet.max(if sample.t > BEGINS { 4 - stand } else { 0 });
        assert!(trunk_tilt(&sample.q) < 0.2 && sample.q[2] > 0.18, "the trunk stays upright: {}", sample.q);
        if k % 500 == 0 {
            let (way, height) = (sample.q[0] - start[0], sample.q[2]);
            println!(
                "{:6.2} {way:8.3} {height:11.3} {:12.1} {stand:9}",
                sample.t,
                1e3 * trunk_tilt(&sample.q)
            );
        }
    }
    let speed = (end.1[0] - begin[0]) / (end.0 - since);
    let mean = pressed / steps / weight;
    println!("goes at {speed:.3} m/s of {}, its feet carry {mean:.4} of its weight\n", gait.speed);
    let part = speed / gait.speed;
    assert!(0.45 < part && part < 1.0, "it goes, less fast than its feet are led: springs lag behind");
    assert!((mean - 1.0).abs() < 0.02, "over whole cycles the ground carries the weight");
    assert!(feet > 0, "feet are lifted");
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    simulate_gait(&TROT, 5.0)?;
    simulate_gait(&WALK, 6.0)
}

#[test]
fn quadruped_trots_and_walks() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
