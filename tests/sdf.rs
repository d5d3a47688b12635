//! SDF files of `data/sdf` against the same mechanisms as URDF files and as structs.

use linkwork::prelude::*;
use linkwork::{Limits, frame};
use support::compare::{assert_close, assert_same_dynamics};
use support::random::Random;

const TOLERANCE: f64 = 1e-12;

#[test]
fn sdf_arm_equals_urdf_arm() {
    #[mechanism(sdf = "data/sdf/arm.sdf")]
    struct Sdf;
    #[mechanism(urdf = "data/sdf/arm.urdf")]
    struct Urdf;
    #[mechanism(sdf = "data/sdf/arm.sdf", base = free, mimic = independent, passive = ignore)]
    struct FreeSdf;
    #[mechanism(urdf = "data/sdf/arm.urdf", base = free, mimic = independent, passive = ignore)]
    struct FreeUrdf;

    assert_eq!(Sdf::VELOCITIES, Urdf::VELOCITIES);
    assert_eq!(FreeSdf::INPUTS, ["b_turn", "c_follow", "z_slide"]);
    assert_same_dynamics(&Sdf, &Urdf, 20, TOLERANCE);
    assert_same_dynamics(&FreeSdf, &FreeUrdf, 20, TOLERANCE);
    let q = Sdf.neutral();
    let ring = Sdf.frame_placement(frame!(Sdf, "hand::ring"), &q).to_homogeneous();
    let twin = Urdf.frame_placement(frame!(Urdf, "ring"), &q).to_homogeneous();
    assert_close("ring", ring.as_slice(), twin.as_slice(), TOLERANCE);
    assert_eq!(Sdf.upper_limits(), Urdf.upper_limits());
    assert_eq!(Sdf.velocity_limits()[4], f64::INFINITY, "less than zero stands for none");
}

/// Fixed joints between links with mass, frames relative to frames, joints relative to frames, links relative
/// to joints, and nested models give the tree of the reference.
#[test]
fn sdf_tree_of_nested_frames_equals_the_urdf_tree() {
    #[mechanism(sdf = "data/sdf/tree.sdf")]
    struct Sdf;
    #[mechanism(urdf = "data/sdf/tree.urdf")]
    struct Urdf;

    assert_eq!((Sdf::NQ, Sdf::NV), (7, 6));
    assert_eq!(Sdf::VELOCITIES, Urdf::VELOCITIES);
    assert_eq!(Sdf::INPUTS, Urdf::INPUTS);
    assert_same_dynamics(&Sdf, &Urdf, 20, TOLERANCE);
    let mut random = Random::new(2);
    for _ in 0..20 {
        let q = random.random_configuration(&Sdf);
        let (all, twins) = (Sdf.frame_placements(&q), Urdf.frame_placements(&q));
        for link in
            ["base", "upper", "plate", "carriage", "wheel", "hand::palm", "hand::tip::pad", "deck", "socket"]
        {
            let twin = link.rsplit("::").next().unwrap_or(link);
            let index_of_name =
                |names: &[&str], name: &str| names.iter().position(|known| *known == name).unwrap();
            let (a, b) = (all[index_of_name(&Sdf::FRAMES, link)], twins[index_of_name(&Urdf::FRAMES, twin)]);
            assert_close(link, a.to_homogeneous().as_slice(), b.to_homogeneous().as_slice(), TOLERANCE);
        }
    }
}

/// A joint with two axes is two joints with a massless link between them; a screw joint rotates and advances.
#[test]
fn two_axis_and_screw_joints_of_sdf_are_converted() {
    #[mechanism(sdf = "data/sdf/joints.sdf", inputs = none)]
    struct File;
    #[mechanism(gravity = 0.1 * y - 9.8 * z)]
    struct HandWrittenMechanism {
        #[body]
        cross_1: Body,
        #[body(mass = 2, com = -0.3 * z, inertia = diagonal(0.1, 0.2, 0.15))]
        shaft: Body,
        #[body(mass = 0.5, inertia = diagonal(0.01, 0.01, 0.02))]
        nut: Body,
        #[joint(
            ground.at([0.5 + 0.1 * cos(0.3) * sin(0.2), 0.1 * sin(0.3) * sin(0.2), 1 + 0.1 * cos(0.2)])
                .rotated(z(0.3), y(0.2)) -> cross_1.at(0.1 * z),
            about = x
        )]
        cross: Pin,
        #[joint(cross_1.at(0.1 * z) -> shaft.at(0.1 * z), about = y)]
        cross_2: Pin,
        #[joint(shaft.at([0, 0.1, -0.4]) -> nut, about = z, lead = 0.04)]
        thread: Screw,
        #[acts(on = cross, stiffness = 5, free_angle = 0.2)]
        spring: Spring,
        #[acts(on = cross_2, damping = 0.4)]
        grease: Dashpot,
    }

    assert_eq!(File::VELOCITIES, HandWrittenMechanism::VELOCITIES);
    assert_same_dynamics(&File, &HandWrittenMechanism {}, 20, TOLERANCE);
}

/// A joint to a link that already has a parent closes a loop. Joints connect frames on links, and frames have
/// placements.
#[test]
fn sdf_joint_to_a_second_parent_closes_a_loop() {
    #[mechanism(sdf = "data/sdf/linkage.sdf")]
    struct File;
    #[mechanism(gravity = -9.81 * z)]
    struct HandWrittenMechanism {
        #[body(mass = 0.3, com = 0.15 * z, inertia = diagonal(0.002, 0.002, 0.0001))]
        crank: Body,
        #[body(mass = 0.8, com = 0.4 * z, inertia = diagonal(0.02, 0.02, 0.0004))]
        bar: Body,
        #[body(mass = 0.1, inertia = diagonal(0.001, 0.001, 0.001))]
        pin: Body,
        #[body(mass = 0.5, com = 0.25 * z, inertia = diagonal(0.01, 0.01, 0.0002))]
        rocker: Body,
        #[joint(ground.rotated(y(0.2)) -> crank, about = y)]
        a_drive: Pin,
        #[joint(crank.at(0.3 * z).rotated(y(1.1)) -> bar, about = y)]
        b_elbow: Pin,
        #[joint(bar -> pin)]
        hold: Weld,
        #[joint(ground.at(0.8 * x).rotated(y(0.3)) -> rocker, about = y)]
        c_swing: Pin,
        // In the file's pose all joints are at zero: the bar is rotated by 0.2 + 1.1, the rocker by 0.3.
        #[joint(
            rocker.at(0.5 * z).rotated(y(1.0)) -> bar.at(
                (cos(1.3) * (0.8 + 0.5 * sin(0.3) - 0.3 * sin(0.2)) - sin(1.3) * (0.5 * cos(0.3) - 0.3 * cos(0.2))) * x
                    + (sin(1.3) * (0.8 + 0.5 * sin(0.3) - 0.3 * sin(0.2)) + cos(1.3) * (0.5 * cos(0.3) - 0.3 * cos(0.2))) * z
            ),
            about = y
        )]
        d_close: Pin,
    }

    assert_eq!(
        (File::NV, File::NC, File::NS),
        (HandWrittenMechanism::NV, HandWrittenMechanism::NC, HandWrittenMechanism::NS)
    );
    assert_eq!(File::VELOCITIES, HandWrittenMechanism::VELOCITIES);
    assert_eq!(File::INPUTS, ["a_drive", "b_elbow", "c_swing"]);
    let (file, written) = (File, HandWrittenMechanism {});
    let q = file.assemble(&[0.1, 0.4, -0.2].into(), &[0]).unwrap();
    assert!(written.constraint_residuals(&q).amax() < 1e-10);
    let (v, tau) = ([0.4, -0.3, 0.2].into(), [0.1, 0.2, 0.3].into());
    let (a, forces) = file.constrained_dynamics(&q, &v, &tau);
    let (b, twins) = written.constrained_dynamics(&q, &v, &tau);
    assert_close("accelerations", a.as_slice(), b.as_slice(), TOLERANCE);
    assert_close("multipliers", forces.as_slice(), twins.as_slice(), TOLERANCE);
    let end = file.frame_placement(frame!(File, "coupler::end"), &q).translation;
    let bar = written.frame_placement(frame!(HandWrittenMechanism, "bar"), &q);
    let tip = bar.rotation * SVector::from([0.0, 0.0, 0.8]) + bar.translation.vector;
    assert_close("frame", end.vector.as_slice(), tip.as_slice(), TOLERANCE);
}

/// A contact can refer to shapes of the file: a rod and a ball, in the pose of the file.
#[test]
fn contacts_refer_to_sdf_shapes() {
    #[mechanism(sdf = "data/sdf/linkage.sdf")]
    struct Standing {
        #[contact(collision(), ground.plane(z), friction = 0.5)]
        floor: Contact,
    }

    let gaps = Standing {}.contact_gaps(&Standing {}.neutral());
    let (low, high) = (0.02 * 0.2_f64.cos() - 0.02, 0.28 * 0.2_f64.cos() - 0.02);
    let ball = 0.3 * 0.2_f64.cos() + 0.8 * 1.3_f64.cos() - 0.05;
    let mut found: Vec<f64> = gaps.iter().copied().collect();
    found[..2].sort_by(f64::total_cmp);
    assert_close("gaps", &found, &[low, high, ball], TOLERANCE);
}
