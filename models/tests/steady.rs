//! Steady motions of mechanisms of the gallery against published values.

use linkwork::nalgebra::DMatrix;
use linkwork::prelude::*;
use linkwork_design::steady::constrained_equilibrium;
use linkwork_models::{Bicycle, RollingDisk};

/// Checks a disk that rolls in a circle: lean and turning rate determine its rolling rate (Neimark and
/// Fufaev, ch. II).
#[test]
fn disk_rolls_in_a_circle() {
    let disk = RollingDisk { g: 9.81, m: 0.5, radius: 0.2 };
    let (lean, turning) = (0.3_f64, 2.5);
    let found = constrained_equilibrium(&disk)
        .from([0.0, 0.0, 0.2, 0.0, lean, 0.0].into())
        .coordinates(["place.z"])
        .moving([0.0, 0.0, 0.0, turning, 0.0, -2.0].into())
        .speeds(["place.x", "place.y", "place.z", "roll"])
        .accelerating(["place.x", "place.y"])
        .find()
        .unwrap();
    let across = turning * lean.cos();
    let spin = (across * across * lean.tan() - 4.0 * disk.g / disk.radius * lean.sin()) / (6.0 * across);
    assert!((found.v[5] + turning * lean.sin() - spin).abs() < 1e-10, "{found:?}");
    assert!((found.q[2] - 0.2 * lean.cos()).abs() < 1e-14);
    // The centre moves along its circle.
    let (v, a) =
        (found.v.fixed_rows::<2>(0).into_owned(), found.acceleration.fixed_rows::<2>(0).into_owned());
    assert!(v.dot(&a).abs() < 1e-10 && (a.norm() - turning * v.norm()).abs() < 1e-10);
}

/// Checks that the bicycle moves in wide circles at 4.6 m/s: lean and steering torque satisfy
/// `(g K₀ + v² K₂) (φ, δ) = (0, T)`. Without torque it moves in a circle only at the published capsize speed
/// (Meijaard and others, 2007).
#[test]
fn bicycle_moves_in_wide_circles() {
    let bicycle = Bicycle::BENCHMARK;
    let straight_rolling_velocity = |speed: f64| {
        let mut v = SVector::<f64, 9>::zeros();
        (v[0], v[6], v[8]) = (speed, -speed / bicycle.rear_radius, -speed / bicycle.front_radius);
        v
    };
    let steered_configuration = |steer: f64| {
        let mut q = bicycle.neutral();
        q[8] = steer;
        q
    };
    let steer = 1e-4;
    assert_eq!((Bicycle::CONFIGURATION[8], Bicycle::VELOCITIES[6]), ("steer", "hub"));
    let speeds = ["vx", "vy", "vz", "wx", "wy", "wz"].map(|axis| format!("pose.{axis}"));
    let places = ["pose.vz", "pose.wx", "pose.wy"];
    let (k0, k2) = (
        [-80.95, -2.599_516_852_498_716, -0.803_294_884_586_176_9],
        [76.597_345_895_732_22, 2.654_315_237_946_04],
    );
    for speed in [2.0, 4.6, 9.0] {
        let problem = constrained_equilibrium(&bicycle)
            .from(steered_configuration(steer))
            .moving(straight_rolling_velocity(speed))
            .coordinates(places)
            .hold(["steer"])
            .speeds(speeds.clone())
            .speeds(["front_hub"]);
        let found = problem.find().unwrap();
        let lean = -(9.81 * k0[1] + speed * speed * k2[0]) * steer / (9.81 * k0[0]);
        let torque = 9.81 * k0[1] * lean + (9.81 * k0[2] + speed * speed * k2[1]) * steer;
        let quaternion = [found.q[3], found.q[4], found.q[5], found.q[6]];
        let rolled = 2.0 * quaternion[0];
        assert!((rolled - lean).abs() < 1e-6 * lean.abs(), "{rolled} {lean}");
        assert!((found.holding[0].1 - torque).abs() < 1e-6 * torque.abs(), "{:?} {torque}", found.holding);
    }
    let circle = constrained_equilibrium(&bicycle)
        .from(steered_configuration(steer))
        .moving(straight_rolling_velocity(5.5))
        .coordinates(places)
        .speeds(speeds)
        .speeds(["hub", "front_hub"]);
    let found = circle.find().unwrap();
    let speed = -found.v[6] * bicycle.rear_radius;
    assert!((speed - 6.024_262_015_388_37).abs() < 1e-6, "{speed}");
}

/// Checks that the upright straight bicycle, built from its bodies and wheels, has the published eigenvalues
/// (Meijaard and others, 2007, table 2).
#[test]
fn bicycle_has_published_eigenvalues() {
    let bicycle = Bicycle::BENCHMARK;
    let published = [
        (
            1.0,
            [
                (-7.110_080_146_374_42, 0.0),
                (-3.134_231_250_665_78, 0.0),
                (3.526_961_709_900_7, 0.807_740_275_199_3),
            ],
        ),
        (
            5.0,
            [
                (-14.078_389_692_798_22, 0.0),
                (-0.322_866_429_004_09, 0.0),
                (-0.775_341_882_195_85, 4.464_867_713_788_23),
            ],
        ),
        (
            10.0,
            [
                (-24.624_596_350_174_04, 0.0),
                (0.161_053_386_531_72, 0.0),
                (-3.720_168_404_372_87, 10.906_811_394_762_87),
            ],
        ),
    ];
    for (speed, expected) in published {
        let mut v = SVector::<f64, 9>::zeros();
        (v[0], v[6], v[8]) = (speed, -speed / bicycle.rear_radius, -speed / bicycle.front_radius);
        let trim = constrained_equilibrium(&bicycle).moving(v).coordinates(["pose.vz", "pose.wx", "pose.wy"]);
        let found = trim.find().unwrap();
        let poles = trim.linear_system(&found).unwrap().poles().unwrap();
        for (re, im) in expected {
            let nearest =
                poles.iter().map(|pole| (pole.re - re).hypot(pole.im - im)).fold(f64::MAX, f64::min);
            assert!(nearest < 1e-8 * re.hypot(im), "{speed} m/s: {re} {im:+}i is {nearest:e} off {poles:?}");
        }
    }
}

fn matrix_from_rows(rows: [[f64; 2]; 2]) -> DMatrix<f64> {
    DMatrix::from_fn(2, 2, |i, j| rows[i][j])
}

#[track_caller]
fn assert_same_matrix(found: &DMatrix<f64>, expected: &DMatrix<f64>, tolerance: f64) {
    assert!(
        (found - expected).amax() <= tolerance * expected.amax().max(1.0),
        "expected {expected}, found {found}"
    );
}

/// Checks that the bodies and wheels of the bicycle give the published matrices of
/// `M q̈ + v C₁ q̇ + (g K₀ + v² K₂) q` in lean and steer (Meijaard, Papadopoulos, Ruina and Schwab,
/// *Linearized dynamics equations for the balance and steer of a bicycle*, Proc. R. Soc. A 463, 2007, § 4).
#[test]
fn bicycle_has_published_matrices() {
    let bicycle = Bicycle::BENCHMARK;
    let mass =
        matrix_from_rows([[80.817_22, 2.319_413_322_087_09], [2.319_413_322_087_09, 0.297_841_881_996_86]]);
    let c1 = matrix_from_rows([[0.0, 33.866_413_914_924_94], [-0.850_356_414_569_78, 1.685_403_973_975_60]]);
    let k0 =
        matrix_from_rows([[-80.95, -2.599_516_852_498_72], [-2.599_516_852_498_72, -0.803_294_884_586_18]]);
    let k2 = matrix_from_rows([[0.0, 76.597_345_895_732_22], [0.0, 2.654_315_237_946_04]]);
    for speed in [0.5, 4.6, 9.0] {
        let mut v = SVector::<f64, 9>::zeros();
        (v[0], v[6], v[8]) = (speed, -speed / bicycle.rear_radius, -speed / bicycle.front_radius);
        let problem =
            constrained_equilibrium(&bicycle).moving(v).coordinates(["pose.vz", "pose.wx", "pose.wy"]);
        let form = problem.second_order_form(&problem.find().unwrap()).unwrap();
        let system = form.state_space().unwrap();
        let names: Vec<&str> = system.states().iter().map(|state| state.name.as_str()).collect();
        let lateral = ["pose.wx", "steer"].map(|name| names.iter().position(|n| *n == name).expect(name));
        let lateral_block = |m: &DMatrix<f64>| m.select_rows(&lateral).select_columns(&lateral);
        assert_same_matrix(&lateral_block(&form.mass), &mass, 1e-12);
        assert_same_matrix(&lateral_block(&(&form.damping + &form.gyroscopic)), &(&c1 * speed), 1e-11);
        assert_same_matrix(
            &lateral_block(&(&form.stiffness + &form.circulatory)),
            &(&k0 * 9.81 + &k2 * (speed * speed)),
            1e-11,
        );
    }
}
