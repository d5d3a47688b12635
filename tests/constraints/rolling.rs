//! Rolling without slipping.

use linkwork::prelude::*;

/// A uniform disk on a table.
#[mechanism(gravity = -g * z)]
struct RollingDisk {
    g: f64,
    m: f64,
    radius: f64,
    #[body(mass = m, inertia = disk(m, radius, y))]
    disk: Body,
    #[joint(ground -> disk)]
    pose: Free,
    #[constraint(rolls(disk.circle(radius, y), ground.plane(z)))]
    contact: Rolling,
}

/// The disk at height and lean that touch the table: yaw `q1` about z, lean `q2` about the carried x.
fn leaning(radius: f64, lean: f64) -> [f64; 7] {
    let (s, c) = (lean / 2.0).sin_cos();
    [0.0, 0.0, radius * lean.cos(), s, 0.0, 0.0, c]
}

/// The closed form of the accelerations in the axes that lean with the disk but do not spin (SymPy's documentation of
/// Kane's method, rolling disc): `u̇₁ = (4 g sin q₂ + 6 r u₂ u₃ − r u₃² tan q₂) / (5 r)`, `u̇₂ = −2 u₁ u₃ / 3`,
/// `u̇₃ = (−2 u₂ + u₃ tan q₂) u₁`, with `u` the angular velocity there.
#[test]
fn rolling_disk_accelerates_as_in_closed_form() {
    let (g, m, radius) = (9.81, 2.0, 0.4);
    let disk = RollingDisk { g, m, radius };
    assert_eq!((RollingDisk::NC, RollingDisk::NH), (3, 1));
    let lean: f64 = 0.35;
    let q = SVector::from(leaning(radius, lean));
    let u = [0.7, -3.0, 1.3];
    assert!(disk.constraint_residuals(&q).amax() < 1e-15);
    // The angles about the body's axes; the centre moves so that the contact is at rest.
    // `ω × r` with the centre at `r = radius z` from the contact, in body axes.
    let v = SVector::from([radius * u[1], -radius * u[0], 0.0, u[0], u[1], u[2]]);
    assert!(disk.constraint_rates(&q, &v).amax() < 1e-14);
    let a = disk.forward_dynamics(&q, &v, &SVector::zeros());
    let tan = lean.tan();
    // The spin turns body axes against those that lean alone, with the rate `u₂ − u₃ tan q₂` about y.
    let spin = u[1] - u[2] * tan;
    let expected = [
        (4.0 * g * lean.sin() + 6.0 * radius * u[1] * u[2] - radius * u[2] * u[2] * tan) / (5.0 * radius),
        -2.0 * u[0] * u[2] / 3.0,
        (-2.0 * u[1] + u[2] * tan) * u[0],
    ];
    // Components in body axes change by the spin as well: d/dt (u in body axes) = u̇ − spin × u.
    let turned = [expected[0] - spin * u[2], expected[1], expected[2] + spin * u[0]];
    for k in 0..3 {
        assert!((a[3 + k] - turned[k]).abs() < 1e-9, "{} for {}", a[3 + k], turned[k]);
    }
}
