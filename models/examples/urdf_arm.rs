//! Robot from a file: position and velocity of its tool, and torques of its motors.
//!
//! ```text
//! cargo run --example urdf_arm -p linkwork-models
//! ```

use linkwork::nalgebra::Vector6;
use linkwork::prelude::*;

/// UR5 robot arm. The path of the file is relative to the package; all values of the file become constants of
/// the program.
#[mechanism(urdf = "urdf/ur5.urdf")]
struct Ur5FromUrdf;

fn main() {
    println!("joints {:?}", Ur5FromUrdf::VELOCITIES);
    println!("frames {:?}\n", Ur5FromUrdf::FRAMES);

    let q = SVector::from([0.0, -1.2, 1.5, -0.3, 1.57, 0.0]);
    let v = SVector::from([0.2, 0.1, -0.3, 0.0, 0.5, 0.0]);

    // Frame names are resolved at compile time: a misspelt name does not compile.
    let tool = frame!(Ur5FromUrdf, "tool0");
    let placement = Ur5FromUrdf.frame_placement(tool, &q);
    println!("tool at           {:.4?}", placement.translation.vector.as_slice());

    // The Jacobian maps joint velocities to the velocity of the tool: linear, then angular, in ground axes.
    let jacobian = Ur5FromUrdf.frame_jacobian(tool, &q);
    println!("moves with        {:.4?}", (jacobian * v).as_slice());
    let step = 1e-6;
    let [before, after] =
        [-step, step].map(|t| Ur5FromUrdf.frame_placement(tool, &(q + v * t)).translation.vector);
    let moved = (after - before) / (2.0 * step);
    assert!((moved - (jacobian * v).fixed_rows::<3>(0)).amax() < 1e-9, "the tool moves as the Jacobian says");

    // Joint velocities that move the tool vertically up at 0.1 m/s without rotation.
    let up = Vector6::new(0.0, 0.0, 0.1, 0.0, 0.0, 0.0);
    if let Some(inverse) = jacobian.try_inverse() {
        println!("straight up by    {:.4?}", (inverse * up).as_slice());
        let there = Ur5FromUrdf.frame_placement(tool, &(q + inverse * up * step));
        let climbed = (there.translation.vector - placement.translation.vector) / step;
        assert!((climbed - up.fixed_rows::<3>(0)).amax() < 1e-5, "it rises by 0.1 m/s");
        assert!(there.rotation.angle_to(&placement.rotation) < 1e-9, "and does not turn");
    }

    // Torques that hold the arm at rest, and torques that also accelerate its elbow by 2 rad/s².
    let rest = SVector::zeros();
    let mut a = SVector::zeros();
    a[2] = 2.0;
    let held = Ur5FromUrdf.inverse_dynamics(&q, &rest, &rest);
    println!("held by           {:.3?}", held.as_slice());
    assert!(Ur5FromUrdf.forward_dynamics(&q, &rest, &held).amax() < 1e-10, "the arm stands still");
    let tau = Ur5FromUrdf.inverse_dynamics(&q, &rest, &a);
    println!("accelerated by    {:.3?}", tau.as_slice());

    // Forward dynamics of these torques returns that acceleration.
    let found = Ur5FromUrdf.forward_dynamics(&q, &rest, &tau);
    println!("check             {:.3?}", found.as_slice());
    assert!((found - a).amax() < 1e-10, "the elbow is accelerated, and nothing else");
}

#[test]
fn example_arm_runs() {
    main();
}
