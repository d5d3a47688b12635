//! The crate dynibo behind the C interface that is documented in `src/peers/library.rs` of the benches.
//!
//! dynibo stores the velocity, acceleration and force of a free base in world axes, angular part first, and
//! has its own value of g. These conversions are outside of the measured time: they occur when a robot is
//! opened, and when a result is read.

use dynibo::{BaseState, FloatingRobot, Frame, Robot, RobotModel, Twist};
use nalgebra::{DMatrix, DVector, DVectorView, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::error::Error;
use std::ffi::{CStr, c_char};
use std::path::Path;

/// Gravitational acceleration of Linkwork and of all peers but dynibo, m/s².
const G: f64 = 9.81;
/// Gravitational acceleration that the crate dynibo uses, m/s².
const G_OF_DYNIBO: f64 = 9.80665;

/// State of a robot, with the joints in the order of the crate dynibo.
struct State {
    base: BaseState,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// Generalized forces, including those of a free base, corrected for the difference of g.
    tau: Vec<f64>,
    /// Generalized forces of the difference between the two values of g.
    lack: Vec<f64>,
}

enum AnyRobot {
    Fixed(Robot),
    Free(FloatingRobot),
}

/// Robot of a Rust peer with the states at which it is evaluated.
pub struct Peer {
    kind: AnyRobot,
    states: Vec<State>,
    /// Index of each joint of dynibo among the joints of the other peer libraries.
    order: Vec<usize>,
    out: Vec<f64>,
}

type Failure = Box<dyn Error>;

impl Peer {
    fn load_peer_from_folder(folder: &Path, numbers: &[f64], count: usize) -> Result<Peer, Failure> {
        let model = RobotModel::from_urdf(folder.join("robot.urdf"))?;
        let names = std::fs::read_to_string(folder.join("joints"))?;
        let names: Vec<&str> = names.lines().collect();
        let index_of_joint_name = |k: usize| {
            let name = model.joint_name(k)?;
            let found = names.iter().position(|other| *other == name);
            found.ok_or_else(|| Failure::from(format!("what is the joint {name}?")))
        };
        let order = (0..model.joint_count()).map(index_of_joint_name).collect::<Result<Vec<_>, Failure>>()?;
        let free = folder.join("free").exists();
        let kind = match free {
            true => AnyRobot::Free(model.floating_robot()?),
            false => AnyRobot::Fixed(model.robot()),
        };
        let nv = names.len() + if free { 6 } else { 0 };
        let mut peer = Peer { kind, states: Vec::new(), order, out: vec![0.0; nv * nv] };
        for row in numbers.chunks_exact(numbers.len() / count) {
            let state = peer.state_from_row(row, free)?;
            peer.states.push(state);
        }
        Ok(peer)
    }

    /// Converts a row of `q`, `v`, `a` and `τ` to a state.
    fn state_from_row(&mut self, row: &[f64], free: bool) -> Result<State, Failure> {
        let n = self.order.len();
        let (base_q, base_v) = if free { (7, 6) } else { (0, 0) };
        let (q, rest) = row.split_at(n + base_q);
        let [v, a, tau] = [0, 1, 2].map(|k| &rest[k * (n + base_v)..(k + 1) * (n + base_v)]);
        let reordered_joint_values = |all: &[f64]| self.order.iter().map(|&k| all[k]).collect::<Vec<f64>>();
        let base =
            if free { base_state_in_world(q, v, a)? } else { BaseState::stationary(Frame::identity())? };
        let mut state = State {
            q: reordered_joint_values(&q[base_q..]),
            v: reordered_joint_values(&v[base_v..]),
            a: reordered_joint_values(&a[base_v..]),
            tau: Vec::new(),
            lack: vec![0.0; n + base_v],
            base,
        };
        match &mut self.kind {
            AnyRobot::Fixed(robot) => robot.gravity(&state.q, &[], &mut state.lack)?,
            AnyRobot::Free(robot) => robot.gravity(&state.base, &state.q, &[], &mut state.lack)?,
        }
        state.lack.iter_mut().for_each(|x| *x *= (G - G_OF_DYNIBO) / G_OF_DYNIBO);
        if free {
            let [force, torque] =
                [0, 3].map(|k| state.base.frame().rotation * Vector3::from_column_slice(&tau[k..k + 3]));
            state.tau.extend(torque.iter().chain(force.iter()));
        }
        state.tau.extend(reordered_joint_values(&tau[base_v..]));
        state.tau.iter_mut().zip(&state.lack).for_each(|(tau, lack)| *tau -= lack);
        Ok(state)
    }

    /// Returns the matrix that converts dynibo's generalized forces to those of the other peers: a rotation
    /// of the base's force and a permutation of the rows.
    fn force_conversion_matrix(&self, state: &State) -> DMatrix<f64> {
        let nv = state.lack.len();
        let base = nv - self.order.len();
        let mut change = DMatrix::zeros(nv, nv);
        if base > 0 {
            let to_body = state.base.frame().rotation.inverse().to_rotation_matrix();
            change.view_mut((0, 3), (3, 3)).copy_from(to_body.matrix());
            change.view_mut((3, 0), (3, 3)).copy_from(to_body.matrix());
        }
        for (k, &place) in self.order.iter().enumerate() {
            change[(base + place, base + k)] = 1.0;
        }
        change
    }

    fn result_in_peer_convention(&self, function: usize, state: &State) -> DMatrix<f64> {
        let nv = state.lack.len();
        let change = self.force_conversion_matrix(state);
        let vector = DVectorView::from_slice(&self.out, nv);
        if function == 0 {
            return DMatrix::from_column_slice(
                nv,
                1,
                (change * (vector + DVector::from_column_slice(&state.lack))).as_slice(),
            );
        }
        if function == 1 {
            return &change * DMatrix::from_column_slice(nv, nv, &self.out[..nv * nv]) * change.transpose();
        }
        let mut a = change * vector;
        if nv > self.order.len() {
            // Conversion of the acceleration of the base's origin to the rate of its velocity in body axes.
            let to_body = state.base.frame().rotation.inverse();
            let Twist { linear, angular } = state.base.velocity();
            let turning = (to_body * angular).cross(&(to_body * linear));
            for k in 0..3 {
                a[k] -= turning[k];
            }
        }
        DMatrix::from_column_slice(nv, 1, a.as_slice())
    }
}

/// Returns pose, velocity and acceleration of the robot's base in world axes.
fn base_state_in_world(q: &[f64], v: &[f64], a: &[f64]) -> Result<BaseState, Failure> {
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(q[6], q[3], q[4], q[5]));
    let world: Rotation3<f64> = rotation.to_rotation_matrix();
    let [linear, angular] = [0, 3].map(|k| Vector3::from_column_slice(&v[k..k + 3]));
    let [linear_rate, angular_rate] = [0, 3].map(|k| Vector3::from_column_slice(&a[k..k + 3]));
    let velocity = Twist::new(world * angular, world * linear);
    let acceleration = Twist::new(world * angular_rate, world * (linear_rate + angular.cross(&linear)));
    let frame = Frame::from_parts(Translation3::new(q[0], q[1], q[2]), rotation);
    Ok(BaseState::new(frame, velocity, acceleration)?)
}

extern "C" fn inverse(peer: &mut Peer, k: usize) {
    let s = &peer.states[k];
    let out = &mut peer.out[..s.lack.len()];
    let done = match &mut peer.kind {
        AnyRobot::Fixed(robot) => robot.inverse_dynamics(&s.q, &s.v, &s.a, &[], out),
        AnyRobot::Free(robot) => robot.inverse_dynamics(&s.base, &s.q, &s.v, &s.a, &[], out),
    };
    debug_assert!(done.is_ok());
}

extern "C" fn evaluate_mass_matrix(peer: &mut Peer, k: usize) {
    let s = &peer.states[k];
    let done = match &mut peer.kind {
        AnyRobot::Fixed(robot) => robot.mass_matrix(&s.q, &mut peer.out),
        AnyRobot::Free(robot) => robot.mass_matrix(&s.base, &s.q, &mut peer.out),
    };
    debug_assert!(done.is_ok());
}

extern "C" fn evaluate_forward_dynamics(peer: &mut Peer, k: usize) {
    let s = &peer.states[k];
    let out = &mut peer.out[..s.lack.len()];
    let done = match &mut peer.kind {
        AnyRobot::Fixed(robot) => robot.forward_dynamics(&s.q, &s.v, &s.tau, &[], out),
        AnyRobot::Free(robot) => robot.forward_dynamics(&s.base, &s.q, &s.v, &s.tau, &[], out),
    };
    debug_assert!(done.is_ok());
}

/// Opens a robot for the Rust peer; returns null if the crate dynibo cannot read it.
///
/// # Safety
///
/// `folder` must be a C string, `states` an array of rows for `count` states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_open(
    folder: *const c_char,
    states: *const f64,
    length: usize,
    count: usize,
) -> Option<Box<Peer>> {
    // SAFETY: the caller guarantees the string and the array.
    let (folder, numbers) = unsafe { (CStr::from_ptr(folder), std::slice::from_raw_parts(states, length)) };
    match Peer::load_peer_from_folder(Path::new(folder.to_str().ok()?), numbers, count) {
        Ok(peer) => Some(Box::new(peer)),
        Err(error) => {
            eprintln!("dynibo: {}: {error}", folder.to_string_lossy());
            None
        }
    }
}

/// Returns the function that evaluates a peer library at one state.
#[unsafe(no_mangle)]
pub extern "C" fn peer_step_fn(
    _: &Peer,
    function: usize,
    variant: usize,
) -> Option<extern "C" fn(&mut Peer, usize)> {
    match (function, variant) {
        (0, 0) => Some(inverse),
        (1, 0) => Some(evaluate_mass_matrix),
        (2, 0) => Some(evaluate_forward_dynamics),
        _ => None,
    }
}

/// Writes the result of the last evaluation of a peer library.
///
/// # Safety
///
/// `out` must have room for the result.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn peer_result(peer: &Peer, function: usize, state: usize, out: *mut f64) {
    let result = peer.result_in_peer_convention(function, &peer.states[state]);
    // SAFETY: the caller guarantees the size of `out`.
    unsafe { std::ptr::copy_nonoverlapping(result.as_ptr(), out, result.len()) };
}
