//! Static equilibria under loads, compared with closed forms.

use super::assert_relatively_close;
use linkwork::prelude::*;
use linkwork_design::Error;
use linkwork_design::steady::{Verdict, constrained_equilibrium, equilibrium};
use nalgebra::{DMatrix, DVector, Isometry3, Point3, UnitQuaternion, Vector3, vector};
use std::f64::consts::PI;

/// Test mechanism: two links with springs in their hinges under a vertical load, a discrete model of Euler's
/// column.
#[mechanism(derivatives)]
struct EulerColumn {
    load: f64,
    #[body(mass = 0.1, com = 0.25 * y, inertia = rod(0.1, 0.5, y))]
    lower: Body,
    #[body(mass = 0.1, com = 0.25 * y, inertia = rod(0.1, 0.5, y))]
    upper: Body,
    #[joint(ground -> lower, about = z)]
    foot: Pin,
    #[joint(lower.at(0.5 * y) -> upper, about = z)]
    knee: Pin,
    #[acts(on = foot, stiffness = 20)]
    foot_spring: Spring,
    #[acts(on = knee, stiffness = 20)]
    knee_spring: Spring,
    #[acts(on = upper.at(0.5 * y), value = -load * ground.y)]
    weight: Force,
}

/// Compares with the critical load `(3 − √5) / 2 · k / l` of links of length `l` and springs of stiffness
/// `k`.
#[test]
fn column_buckles_at_critical_load() {
    let critical = (3.0 - 5.0_f64.sqrt()) / 2.0 * 20.0 / 0.5;
    for (part, verdict) in [(0.999, Verdict::Stable), (1.001, Verdict::Unstable)] {
        let column = EulerColumn { load: part * critical };
        let problem = equilibrium(&column);
        let upright = problem.find().unwrap();
        assert!(upright.q.amax() < 1e-15);
        assert_eq!(problem.stiffness(&upright).unwrap().verdict(), verdict);
        let stable = problem.linear_system(&upright).unwrap().poles().unwrap();
        let fastest = stable.iter().map(|pole| pole.re).fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(fastest > 1e-3, verdict == Verdict::Unstable, "{stable:?}");
    }
    // At the critical load the equations are singular, and the error lists both hinges.
    let column = EulerColumn { load: critical };
    let Err(Error::Undetermined { unknowns, .. }) = equilibrium(&column).find() else { panic!("singular") };
    assert_eq!(unknowns, ["foot", "knee"]);
    // Above the critical load the column is bent, to either side.
    let column = EulerColumn { load: 1.2 * critical };
    let mut problem = equilibrium(&column);
    let bent = problem.find_all([vector![0.5, 0.5], vector![-0.5, -0.5], vector![0.01, -0.01]]).unwrap();
    for found in &bent[..2] {
        let (first, second) = (found.q[0], found.q[0] + found.q[1]);
        let restoring_moment = |angle: f64| 1.2 * critical * 0.5 * angle.sin();
        assert_relatively_close(20.0 * (second - first), restoring_moment(second), 1e-10);
        assert_relatively_close(20.0 * first - 20.0 * (second - first), restoring_moment(first), 1e-10);
        assert!(first.abs() > 0.3);
        assert_eq!(problem.stiffness(found).unwrap().verdict(), Verdict::Stable);
    }
    assert!((bent[0].q + bent[1].q).amax() < 1e-10);
    // Which load bends the foot by 0.01 rad? It exceeds the critical load by a term of the order of the
    // angle squared.
    let found = equilibrium(&column).from(vector![0.01, 0.006]).fix(["foot"]);
    let found = found.parameters([("load", 10.0)], |p| EulerColumn { load: p[0] }).find().unwrap();
    let more = found.parameters[0] / critical - 1.0;
    assert!(more > 0.0 && more < 1e-4, "{more}");
}

/// Test mechanism: a table on three legs that carries a load.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct ThreeLeggedTable {
    px: f64,
    py: f64,
    #[body(mass = 12, inertia = cuboid(12, 1.6, 1, 0.04))]
    board: Body,
    #[particle(mass = 5, at = board.at(px * x + py * y))]
    load: Particle,
    #[joint(ground -> board)]
    pose: Free,
    #[constraint(dot(r(board.at(-0.7 * x - 0.4 * y) / ground), ground.z) == 0.7)]
    left: Holonomic,
    #[constraint(dot(r(board.at(0.7 * x - 0.4 * y) / ground), ground.z) == 0.7)]
    right: Holonomic,
    #[constraint(dot(r(board.at(0.4 * y) / ground), ground.z) == 0.7)]
    middle: Holonomic,
}

#[test]
fn table_legs_share_the_load() {
    let table = ThreeLeggedTable { px: 0.2, py: -0.1 };
    let problem = constrained_equilibrium(&table).fix(["pose.vx", "pose.vy", "pose.wz"]);
    let found = problem.find().unwrap();
    assert!((found.q[2] - 0.7).abs() < 1e-12);
    // Moments about the line through the two front legs, and about the y axis.
    let weight = 9.81 * 17.0;
    let middle = 9.81 * (12.0 * 0.4 + 5.0 * 0.3) / 0.8;
    let twist = 9.81 * 5.0 * 0.2 / 0.7;
    let expected = [(weight - middle - twist) / 2.0, (weight - middle + twist) / 2.0, middle];
    for ((name, force), expected) in found.multipliers.iter().zip(expected) {
        assert!((force.abs() - expected).abs() < 1e-10, "{name} {force} {expected}");
    }
    // The horizontal position and the heading are not determined.
    let error = constrained_equilibrium(&table).find().unwrap_err();
    let Error::Undetermined { unknowns, .. } = &error else { panic!("{error}") };
    assert_eq!(unknowns[..], ["pose.vx", "pose.vy", "pose.wz"]);
    let place = constrained_equilibrium(&table)
        .from(table.integrate(&table.neutral(), &vector![3.0, 1.0, 0.5, 0.0, 0.0, 0.3]));
    let nearest = place.nearest().find().unwrap();
    assert!((nearest.q[2] - 0.7).abs() < 1e-12 && nearest.q[0] > 2.0);
}

/// Test mechanism: platform on six legs, whose lengths are controlled by forces.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct HexapodPlatform {
    #[body(mass = 30, com = 0.05 * x + 0.1 * z, inertia = diagonal(1.5, 1.5, 2.5))]
    platform: Body,
    #[joint(ground -> platform)]
    pose: Free,
    #[body(mass = 2, com = 0.3 * z, inertia = rod(2, 0.6, z))]
    lower: [Body; 6],
    #[body(mass = 2, com = -0.3 * z, inertia = rod(2, 0.6, z))]
    upper: [Body; 6],
    #[joint(ground.at(0.8 * (cos(pi / 3 * i) * x + sin(pi / 3 * i) * y)) -> lower[i], about = (x, y))]
    foot: [Universal; 6],
    #[joint(lower[i] -> upper[i], along = z)]
    slide: [Sleeve; 6],
    #[joint(upper[i] -> platform.at(0.5 * (cos(pi / 3 * i + 0.35 * cos(pi * i)) * x + sin(pi / 3 * i + 0.35 * cos(pi * i)) * y)))]
    head: [Ball; 6],
    #[acts(on = slide[i])]
    drive: [Force; 6],
}

/// Compares with the statics of the legs: each leg transmits part of its weight to the platform perpendicular
/// to its axis, and each drive balances the axial force at the head and the axial weight of the upper half.
#[test]
fn six_legs_support_a_platform() {
    let pose = Isometry3::from_parts(
        Vector3::new(0.1, -0.05, 0.9).into(),
        UnitQuaternion::from_euler_angles(0.15, -0.2, 0.3),
    );
    let weight_of_mass = |mass: f64| Vector3::new(0.0, 0.0, -9.81 * mass);
    let platform = HexapodPlatform {};
    let mut q = platform.neutral();
    q.fixed_rows_mut::<3>(0).copy_from(&pose.translation.vector);
    q.fixed_rows_mut::<4>(3).copy_from(&pose.rotation.coords);
    let mut axial = DMatrix::zeros(6, 6);
    let com = pose.rotation * Vector3::new(0.05, 0.0, 0.1);
    let mut load = DVector::zeros(6);
    load.rows_mut(0, 3).copy_from(&weight_of_mass(30.0));
    load.rows_mut(3, 3).copy_from(&com.cross(&weight_of_mass(30.0)));
    let mut legs = Vec::new();
    for k in 0..6 {
        let angle = PI / 3.0 * k as f64;
        let turned = angle + 0.35 * (PI * k as f64).cos();
        let foot = Vector3::new(angle.cos(), angle.sin(), 0.0) * 0.8;
        let head = pose * Point3::new(0.5 * turned.cos(), 0.5 * turned.sin(), 0.0);
        let leg = head.coords - foot;
        let (n, length) = (leg.normalize(), leg.norm());
        legs.push((n, length, head.coords - pose.translation.vector));
        let arm = legs[k].2;
        axial.view_mut((0, k), (3, 1)).copy_from(&n);
        axial.view_mut((3, k), (3, 1)).copy_from(&arm.cross(&n));
        // Perpendicular to the leg: the share of the leg's weights that acts at the head, from moments
        // about the foot.
        let component_perpendicular_to_leg = |w: Vector3<f64>| w - n * n.dot(&w);
        let carried = component_perpendicular_to_leg(weight_of_mass(2.0)) * ((0.3 + length - 0.3) / length);
        let mut view = load.rows_mut(0, 3);
        view += carried;
        let mut view = load.rows_mut(3, 3);
        view += arm.cross(&carried);
    }
    let along = axial.lu().solve(&-load).unwrap();
    // The guess differs slightly from the solution.
    let coordinate_index =
        |name: &str| HexapodPlatform::CONFIGURATION.iter().position(|n| *n == name).unwrap();
    for (k, (n, length, _)) in legs.iter().enumerate() {
        q[coordinate_index(&format!("foot_{k}.first"))] = (-n.y).atan2(n.z) + 0.02;
        q[coordinate_index(&format!("foot_{k}.second"))] = n.x.asin() - 0.03;
        q[coordinate_index(&format!("slide_{k}"))] = length + 0.01;
    }
    let drives: Vec<String> = (0..6).map(|k| format!("drive_{k}")).collect();
    let fixed = ["vx", "vy", "vz", "wx", "wy", "wz"].map(|axis| format!("pose.{axis}"));
    let found = constrained_equilibrium(&platform).from(q).fix(fixed).inputs(drives).find().unwrap();
    for (k, (n, length, _)) in legs.iter().enumerate() {
        assert_relatively_close(found.q[coordinate_index(&format!("slide_{k}"))], *length, 1e-12);
        assert_relatively_close(found.u[k], along[k] - n.dot(&weight_of_mass(2.0)), 1e-9);
    }
}
