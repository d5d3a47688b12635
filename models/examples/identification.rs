//! Identifies the inertial parameters of a seven-axis arm. The arm moves along periodic trajectories. Its
//! torques are regressed on base parameters, friction and rotor inertias. The results are then converted to
//! physically consistent inertial parameters of the robot's bodies.
//!
//! Sources: Swevers, Ganseman, Tükel, De Schutter and Van Brussel, *Optimal robot excitation and
//! identification*, IEEE Transactions on Robotics and Automation 13 (1997), for the trajectories; Gautier and
//! Khalil (1990) for the base parameters.
//!
//! ```text
//! cargo run --release --example identification -p linkwork-models
//! ```

use linkwork::identification::approach;
use linkwork::nalgebra::{Cholesky, SMatrix, SVector};
use linkwork::prelude::*;
use linkwork::{Inertial, ParameterError};

/// Robot arm whose values from its file are parameters. The inertias of the motors' rotors, which the file
/// does not contain, are parameters, too.
#[mechanism(
    urdf = "urdf/panda.urdf",
    lock = ["panda_finger_joint1", "panda_finger_joint2"],
    parameters = [inertial, damping, friction],
    regressor
)]
#[derive(Clone, Copy, Debug)]
struct IdentifiedArm {
    rotor1: f64,
    rotor2: f64,
    rotor3: f64,
    rotor4: f64,
    rotor5: f64,
    rotor6: f64,
    rotor7: f64,
    #[acts(on = panda_joint1, inertance = rotor1)]
    motor1: Inerter,
    #[acts(on = panda_joint2, inertance = rotor2)]
    motor2: Inerter,
    #[acts(on = panda_joint3, inertance = rotor3)]
    motor3: Inerter,
    #[acts(on = panda_joint4, inertance = rotor4)]
    motor4: Inerter,
    #[acts(on = panda_joint5, inertance = rotor5)]
    motor5: Inerter,
    #[acts(on = panda_joint6, inertance = rotor6)]
    motor6: Inerter,
    #[acts(on = panda_joint7, inertance = rotor7)]
    motor7: Inerter,
}

type JointVector = SVector<f64, 7>;
const BASE: usize = IdentifiedArm::BASE_PARAMETERS.len();
/// Number of regressed parameters: the base parameters, then damping and dry friction of every joint, and the
/// rotor inertias of all joints except the first two. The rotors of the first two joints cannot be
/// distinguished from the inertias of their links about the same axes.
const COLUMNS: usize = BASE + 7 + 7 + 5;
/// Velocity below which dry friction is smooth, rad/s: the default `friction_speed` of the mechanism.
const SMOOTH: f64 = 0.01;

impl IdentifiedArm {
    /// Returns the coefficients of damping and friction, and the rotor inertias, of all joints.
    fn friction_and_rotor_parameters(&self) -> [JointVector; 3] {
        let damping = [
            self.panda_joint1_damping,
            self.panda_joint2_damping,
            self.panda_joint3_damping,
            self.panda_joint4_damping,
            self.panda_joint5_damping,
            self.panda_joint6_damping,
            self.panda_joint7_damping,
        ];
        let friction = [
            self.panda_joint1_friction,
            self.panda_joint2_friction,
            self.panda_joint3_friction,
            self.panda_joint4_friction,
            self.panda_joint5_friction,
            self.panda_joint6_friction,
            self.panda_joint7_friction,
        ];
        let rotors =
            [self.rotor1, self.rotor2, self.rotor3, self.rotor4, self.rotor5, self.rotor6, self.rotor7];
        [damping, friction, rotors].map(JointVector::from)
    }

    fn with_friction_and_rotor_parameters(
        self,
        [damping, friction, rotors]: [JointVector; 3],
    ) -> IdentifiedArm {
        IdentifiedArm {
            panda_joint1_damping: damping[0],
            panda_joint2_damping: damping[1],
            panda_joint3_damping: damping[2],
            panda_joint4_damping: damping[3],
            panda_joint5_damping: damping[4],
            panda_joint6_damping: damping[5],
            panda_joint7_damping: damping[6],
            panda_joint1_friction: friction[0],
            panda_joint2_friction: friction[1],
            panda_joint3_friction: friction[2],
            panda_joint4_friction: friction[3],
            panda_joint5_friction: friction[4],
            panda_joint6_friction: friction[5],
            panda_joint7_friction: friction[6],
            rotor1: rotors[0],
            rotor2: rotors[1],
            rotor3: rotors[2],
            rotor4: rotors[3],
            rotor5: rotors[4],
            rotor6: rotors[5],
            rotor7: rotors[6],
            ..self
        }
    }
}

/// Reproducible random numbers between −1 and 1 (SplitMix64).
struct RandomNumbers(u64);

impl RandomNumbers {
    fn next_number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Periodic trajectory: a sum of sines for each joint and harmonic, with exact position, velocity and
/// acceleration.
struct FourierTrajectory([[[f64; 2]; 5]; 7]);

impl FourierTrajectory {
    /// Returns a random trajectory of moderate amplitude about a posture with a bent elbow.
    fn new(random: &mut RandomNumbers) -> FourierTrajectory {
        FourierTrajectory(
            [[(); 5]; 7]
                .map(|joint| joint.map(|()| [0.8 * random.next_number(), 0.8 * random.next_number()])),
        )
    }

    fn evaluate_trajectory(&self, t: f64) -> [JointVector; 3] {
        const RATE: f64 = 0.6;
        let mut q = JointVector::from([0.0, 0.3, 0.0, -1.6, 0.0, 1.8, 0.0]);
        let (mut v, mut a) = (JointVector::zeros(), JointVector::zeros());
        for (j, harmonics) in self.0.iter().enumerate() {
            for (k, [sine, cosine]) in harmonics.iter().enumerate() {
                let rate = RATE * (k + 1) as f64;
                let (s, c) = (rate * t).sin_cos();
                q[j] += (sine * s - cosine * c) / rate;
                v[j] += sine * c + cosine * s;
                a[j] += rate * (cosine * c - sine * s);
            }
        }
        [q, v, a]
    }
}

/// Returns the robot that is identified: its links differ from those of the file, and it has a load in the
/// hand, friction and rotors.
fn perturbed_robot() -> IdentifiedArm {
    let mut random = RandomNumbers(7);
    let mut arm = IdentifiedArm::from_file(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let perturbed_inertial = |link: Inertial<f64>| {
        let off = [(); 3].map(|()| 0.04 * random.next_number());
        let at = [0, 1, 2].map(|k| link.com[k] + off[k]);
        link.scaled(0.9).plus(&Inertial::point(0.15 * link.mass, at))
    };
    arm.set_inertials(&arm.inertials().map(perturbed_inertial));
    arm.panda_hand = arm.panda_hand.plus(&Inertial::point(1.2, [0.01, 0.02, 0.12]));
    arm.with_friction_and_rotor_parameters([
        [0.8, 0.7, 0.6, 0.5, 0.3, 0.25, 0.2].into(),
        [0.9, 0.8, 0.5, 0.6, 0.3, 0.3, 0.2].into(),
        [0.6, 0.5, 0.4, 0.4, 0.15, 0.12, 0.1].into(),
    ])
}

/// Returns the regressor matrix of the arm: its product with the vector of parameters is the vector of
/// torques.
fn torque_regressor(arm: &IdentifiedArm, [q, v, a]: &[JointVector; 3]) -> SMatrix<f64, 7, COLUMNS> {
    let mut all = SMatrix::<f64, 7, COLUMNS>::zeros();
    all.fixed_view_mut::<7, BASE>(0, 0).copy_from(&arm.base_regressor(q, v, a));
    for j in 0..7 {
        all[(j, BASE + j)] = v[j];
        all[(j, BASE + 7 + j)] = (v[j] / SMOOTH).tanh();
        if j > 1 {
            all[(j, BASE + 14 + j - 2)] = a[j];
        }
    }
    all
}

/// Returns the root mean square of the difference between two robots' torques on a trajectory, N·m.
fn rms_torque_difference(one: &IdentifiedArm, other: &IdentifiedArm, trajectory: &FourierTrajectory) -> f64 {
    let squared_torque_difference = |k: usize| {
        let [q, v, a] = trajectory.evaluate_trajectory(0.02 * k as f64);
        (one.inverse_dynamics(&q, &v, &a) - other.inverse_dynamics(&q, &v, &a)).norm_squared()
    };
    ((0..500).map(squared_torque_difference).sum::<f64>() / (500.0 * 7.0)).sqrt()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (truth, mut random) = (perturbed_robot(), RandomNumbers(42));
    truth.validate()?;
    let mut arm = IdentifiedArm::from_file(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);

    // Excitation: torques are measured with noise and accumulated in the normal equations of the regression.
    let (mut normal, mut right) =
        (SMatrix::<f64, COLUMNS, COLUMNS>::zeros(), SVector::<f64, COLUMNS>::zeros());
    for _ in 0..6 {
        let trajectory = FourierTrajectory::new(&mut random);
        for k in 0..400 {
            let state = trajectory.evaluate_trajectory(0.025 * k as f64);
            let [q, v, a] = &state;
            let torque =
                truth.inverse_dynamics(q, v, a) + JointVector::from_fn(|_, _| 0.05 * random.next_number());
            let y = torque_regressor(&arm, &state);
            normal += y.transpose() * y;
            right += y.transpose() * torque;
        }
    }
    let found = Cholesky::new(normal).ok_or("some parameters were not excited")?.solve(&right);

    // Conversion: the parameters of the joints, then the bodies nearest to the file's that reproduce the
    // measurements. Because of the noise, no consistent bodies may reproduce them exactly.
    let joint_parameters_starting_at = |first: usize| JointVector::from_fn(|j, _| found[first + j]);
    let rotors = JointVector::from_fn(|j, _| if j > 1 { found[BASE + 14 + j - 2] } else { 0.0 });
    arm = arm.with_friction_and_rotor_parameters([
        joint_parameters_starting_at(BASE),
        joint_parameters_starting_at(BASE + 7),
        rotors,
    ]);
    let base = found.fixed_rows::<BASE>(0).into_owned();
    approach(&mut arm, &base, 1e-6)?;
    arm.validate()?;

    println!("joint   damping       friction      rotor");
    let ([d, f, r], [td, tf, tr]) =
        (arm.friction_and_rotor_parameters(), truth.friction_and_rotor_parameters());
    for j in 0..7 {
        println!(
            "{}  {:6.3} {:6.3} {:6.3} {:6.3} {:6.3} {:6.3}",
            j + 1,
            d[j],
            td[j],
            f[j],
            tf[j],
            r[j],
            tr[j]
        );
    }
    assert!((d - td).amax() < 0.03 && (f - tf).amax() < 0.03, "friction of all joints");
    assert!((r - tr).rows(2, 5).amax() < 0.03, "rotors of all but the first two");

    // The base parameters equal those of the robot, which include the first two rotors.
    let expected = truth.base_parameters(&truth.standard_parameters());
    let mut got = arm.base_parameters(&arm.standard_parameters());
    got[index!(IdentifiedArm::BASE_PARAMETERS, "panda_link1.zz")] -= truth.rotor1;
    got[index!(IdentifiedArm::BASE_PARAMETERS, "panda_link2.zz")] -= truth.rotor2;
    println!("base parameters: {:.3} off at most, of {:.1}", (got - expected).amax(), expected.amax());
    assert!((got - expected).amax() < 0.05);

    // On a new trajectory the identified model predicts the robot's torques, and the file's model does not.
    let fresh = FourierTrajectory::new(&mut random);
    let file = IdentifiedArm::from_file(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let (before, after) =
        (rms_torque_difference(&file, &truth, &fresh), rms_torque_difference(&arm, &truth, &fresh));
    println!("torques off by {before:.3} N·m by the file, {after:.4} N·m as identified");
    assert!(before > 1.0 && after < 0.02);

    // Physically inconsistent parameters are rejected.
    let wrong: Result<(), ParameterError> =
        IdentifiedArm { panda_link5: Inertial { mass: -1.0, ..arm.panda_link5 }, ..arm }.validate();
    println!("{}", wrong.err().map_or(String::new(), |error| error.to_string()));
    Ok(())
}

#[test]
fn identified_arm_predicts_torques() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
