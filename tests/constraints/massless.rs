//! Checks that a linkage without inertia can be assembled.

use linkwork::prelude::*;

/// Crank, rod and piston; the axis of the cylinder moves up and down as a function of time.
#[mechanism(inertia = none)]
struct SliderCrank {
    r: f64,
    l: f64,
    lift: f64,
    #[body]
    crank: Body,
    #[body]
    rod: Body,
    #[body]
    piston: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(r * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(ground -> piston, along = x)]
    cylinder: Sleeve,
    #[constraint(r(rod.at(l * x) / piston) = lift * sin(t) * y)]
    small_end: Holonomic,
    #[output(r(rod.at(l * x) / ground))]
    end: Vector,
}

#[test]
fn massless_links_close_loops() {
    let engine = SliderCrank { r: 0.04, l: 0.13, lift: 0.01 };
    let t = 0.9_f64;
    let q = engine.assemble(t, &[0.8, -1.0, 0.1].into(), &[0]).expect("it closes");
    assert_eq!(q[0], 0.8);
    assert!(engine.constraint_residuals(t, &q).amax() < 1e-14);
    // The end of the rod is at the height of the cylinder's axis.
    let height = 0.01 * t.sin() - 0.04 * 0.8_f64.sin();
    let reach = 0.04 * 0.8_f64.cos() + (0.13_f64.powi(2) - height * height).sqrt();
    assert!((q[2] - reach).abs() < 1e-12, "{q}");
    assert!((engine.end(t, &q)[1] - 0.01 * t.sin()).abs() < 1e-12);
    let long = SliderCrank { r: 0.2, l: 0.13, lift: 0.0 };
    let far = long.assemble(0.0, &[1.5, -1.0, 0.1].into(), &[0]);
    assert!(matches!(far, Err(ConstraintError::Configuration { .. })), "{far:?}");
    assert_eq!(long.assemble(0.0, &q, &[7]), Err(ConstraintError::Held { index: 7, velocities: 3 }));
}
