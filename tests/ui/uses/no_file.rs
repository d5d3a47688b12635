//! A missing file causes a single error, for any use of the robot.

use linkwork::prelude::*;

#[mechanism(urdf = "urdf/slip.urdf", derivatives, batch)]
#[derive(Clone, Copy, Debug)]
struct Robot;

#[mechanism(urdf = "urdf/slip.urdf")]
#[derive(Debug, Default)]
pub struct Carrying<T> {
    pub load: T,
    #[body(mass = load, com = x)]
    tool: Body,
    #[joint(hand -> tool, about = z)]
    wrist: Pin,
    #[acts(on = elbow)]
    motor: Torque,
    #[output(r(tool / ground))]
    place: Vector,
}

trait Named {
    const NAME: &'static str;
}

impl Named for Robot {
    const NAME: &'static str = "robot";
}

fn torques(robot: &Robot, q: &SVector<f64, { Robot::NQ }>) -> SVector<f64, { Robot::NV }> {
    robot.bias_forces(q, &SVector::zeros())
}

fn energy<M: Mechanism<6, 6, 6, Scalar = f64>>(m: &M, q: &SVector<f64, 6>) -> f64 {
    m.potential_energy(0.0, q)
}

fn main() -> Result<(), Error> {
    let robot = Robot;
    let (q, v) = (SVector::from([0.1; 6]), SVector::from([0.0; 6]));
    println!("{} {} {}", torques(&robot, &q), energy(&robot, &q), Robot::NAME);
    let a = robot.forward_dynamics(&q, &v, &robot.generalized_forces(&q, &SVector::zeros()));
    let (by_state, _) = robot.linearize(&q, &v, &SVector::zeros());
    let tool = robot.frame_placement(frame!(Robot, "tool0"), &q);
    println!("{a} {by_state} {tool:?} {:?}", Robot::INPUTS);
    for state in simulate(&robot).from(q, v).duration(1.0).sample_every(0.1) {
        println!("{}", state?.q);
    }
    let carrying = Carrying { load: 2.0_f32 };
    println!("{} {carrying:?}", carrying.place(&SVector::zeros()).norm());
    println!("{:?} {}", Carrying::<f64>::default(), Carrying::<f64>::NV);
    Ok(())
}
