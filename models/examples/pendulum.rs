//! First example: declares a mechanism, prints its equations, and simulates it.
//!
//! ```text
//! cargo run --example pendulum -p linkwork-models
//! ```

use linkwork::prelude::*;

/// Uniform rod on a hinge, with friction and a motor.
#[mechanism(gravity = -9.81 * y)]
struct DrivenPendulum {
    // Plain fields are parameters. They remain fields of the struct.
    mass: f64,
    length: f64,
    friction: f64,

    // Elements declare the parts of the mechanism. The compiler reads them and removes them from the struct.
    #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    hinge: Pin,
    #[acts(on = hinge, damping = friction)]
    grease: Dashpot,
    #[acts(on = hinge)]
    motor: Torque,
}

fn main() -> Result<(), Error> {
    let pendulum = DrivenPendulum { mass: 2.0, length: 1.5, friction: 0.3 };
    println!("{}", DrivenPendulum::EQUATIONS);

    // Every function is generated for this mechanism. Configuration q, velocity v and forces are vectors.
    let (q, v) = (SVector::from([0.5]), SVector::from([0.0]));
    let inertia = pendulum.mass_matrix(&q)[0];
    let torque = pendulum.bias_forces(&q, &v)[0];
    let acceleration = pendulum.forward_dynamics(&q, &v, &SVector::zeros())[0];
    println!("moment of inertia about the hinge  {inertia:.3} kg·m²");
    println!("torque that holds it at 0.5 rad    {torque:.3} N·m");
    println!("acceleration if it is let go       {acceleration:.3} rad/s²\n");
    // Inertia of a rod about its end: m l² / 3. Its weight acts at half of its length.
    assert!((inertia - 2.0 * 1.5 * 1.5 / 3.0).abs() < 1e-12);
    assert!((torque - 2.0 * 9.81 * 0.75 * 0.5_f64.sin()).abs() < 1e-12);
    assert!((acceleration + torque / inertia).abs() < 1e-12);

    // Motion from rest at 0.5 rad with an oscillating motor torque, with a sample every half second.
    let run = simulate(&pendulum)
        .from([0.5], [0.0])
        .inputs(|t, _q, _v| SVector::from([0.5 * t.sin()]))
        .duration(5.0)
        .sample_every(0.5);
    println!("  t, s   {}, rad   motor, N·m   energy, J", DrivenPendulum::CONFIGURATION[0]);
    let mut samples = 0;
    for sample in run {
        let Sample { t, q, v, u, .. } = sample?;
        let energy = pendulum.kinetic_energy(&q, &v) + pendulum.potential_energy(&q);
        println!("{t:6.1}   {:10.4}   {:10.4}   {energy:9.4}", q[0], u[0]);
        assert!(q[0].abs() <= 0.5, "grease and a weak motor never let it higher than it was");
        assert!((u[0] - 0.5 * t.sin()).abs() < 1e-12, "the motor pushes to and fro");
        samples += 1;
    }
    assert_eq!(samples, 11, "one every half second, from the beginning to the end");
    Ok(())
}

#[test]
fn example_pendulum_runs() -> Result<(), Error> {
    main()
}
