use crate::testing::precise_integrator;
use linkwork::prelude::*;
use linkwork_models::TwoWindows;

#[test]
fn windows_pass_singular_configurations() -> Result<(), Error> {
    let windows = TwoWindows { g: 9.81, mass: 1.0, length: 1.0 };
    assert_eq!((TwoWindows::NV, TwoWindows::NC), (5, 4));
    // Angles are counter-clockwise; the couplers keep their direction.
    let run = simulate(&windows)
        .from([0.0; 5], [-1.0, 1.0, -1.0, 1.0, -1.0])
        .method(precise_integrator())
        .duration(10.0)
        .finish()?;
    let top = (-run.q[0].sin(), run.q[0].cos());
    assert!((top.0 - 0.328_458_111_540_815).abs() < 1e-6, "{top:?}");
    assert!((top.1 - 0.944_518_538_078_601).abs() < 1e-6, "{top:?}");
    assert!(windows.constraint_residuals(&run.q).amax() < 1e-10);
    Ok(())
}
