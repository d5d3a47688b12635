//! Measures the stack that functions of robots need, including all functions that they call.
//!
//! `cargo run -p linkwork-benches --bin stack` for debug builds, with `--release` for release builds. Each
//! call is made on a thread's stack that is filled with a pattern; the overwritten part is measured in KiB,
//! rounded up, for one state and for eight.

use linkwork::Mechanism;
use linkwork::nalgebra::SVector;
use linkwork::prelude::{Batch, Lanes, mechanism};
use linkwork_benches::random::Random;
use std::hint::black_box;
use std::thread;

/// Size of the part of the stack that is filled with the pattern, bytes.
const PAINTED: usize = 6 << 20;
/// Reserve for the filling function itself, bytes: smaller values cannot be measured.
const MARGIN: usize = 512;
/// Size of the stack of the thread that is measured, bytes.
const STACK: usize = PAINTED + (2 << 20);
/// Byte pattern that fills the unused stack, so that the deepest use can be found.
const PAINT: u8 = 0xA5;

#[mechanism(urdf = "../models/urdf/ur5.urdf", batch, derivatives)]
struct Ur5;

#[mechanism(
    urdf = "../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"], batch,
    derivatives
)]
struct Panda;

#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, batch, derivatives)]
struct Solo12;

#[mechanism(urdf = "../models/urdf/simple_humanoid.urdf", base = free, batch, derivatives)]
struct Humanoid;

fn main() {
    let thread = thread::Builder::new().stack_size(STACK).spawn(print_stack_table).expect("a thread");
    thread.join().expect("the table is written");
}

fn print_stack_table() {
    println!("| robot | function | one state, KiB | eight states, KiB |");
    println!("| --- | --- | ---: | ---: |");
    macro_rules! robot {
        ($name:literal, $m:expr) => {
            print_dynamics_stack($name, &$m);
            let (q, v) = random_state(&$m);
            print_stack_of_call($name, "derivatives of inverse dynamics", || {
                black_box($m.inverse_dynamics_derivatives(&q, &v, &v));
            });
            print_stack_of_call($name, "derivatives of forward dynamics", || {
                black_box($m.forward_dynamics_derivatives(&q, &v, &v));
            });
        };
    }
    robot!("UR5", Ur5);
    robot!("Panda", Panda);
    robot!("Solo 12", Solo12);
    robot!("humanoid", Humanoid);
}

/// Returns a random configuration, velocity and acceleration of a mechanism.
fn random_state<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
) -> (SVector<f64, NQ>, SVector<f64, NV>)
where
    M: Batch<NQ, NV, NU, Scalar = f64>,
{
    let mut random = Random::new(1);
    let mut random_vector = || SVector::<f64, NV>::from_fn(|_, _| random.uniform_within(2.0));
    (m.integrate(&m.neutral(), &random_vector()), random_vector())
}

fn print_dynamics_stack<M, const NQ: usize, const NV: usize, const NU: usize>(name: &str, m: &M)
where
    M: Batch<NQ, NV, NU, Scalar = f64>,
{
    let (q, v) = random_state(m);
    let (q8, v8): (SVector<Lanes<f64, 8>, NQ>, SVector<Lanes<f64, 8>, NV>) =
        (q.map(Lanes::splat), v.map(Lanes::splat));
    let t8 = Lanes([0.0; 8]);
    macro_rules! row {
        ($text:literal, $one:ident, $eight:ident, $($x:ident $x8:ident),*) => {
            let one = stack_usage_of_call(&mut || { black_box(Mechanism::$one(m, 0.0, $(&$x),*)); });
            let eight = stack_usage_of_call(&mut || { black_box(m.$eight(t8, $(&$x8),*)); });
            println!("| {name} | {} | {} | {} |", $text, bytes_to_kib(one), bytes_to_kib(eight));
        };
    }
    row!("mass matrix", mass_matrix, mass_matrix_lanes, q q8);
    row!("bias forces", bias_forces, bias_forces_lanes, q q8, v v8);
    row!("inverse dynamics", inverse_dynamics, inverse_dynamics_lanes, q q8, v v8, v v8);
    row!("forward dynamics", forward_dynamics, forward_dynamics_lanes, q q8, v v8, v v8);
}

fn print_stack_of_call(name: &str, text: &str, mut call: impl FnMut()) {
    println!("| {name} | {text} | {} | |", bytes_to_kib(stack_usage_of_call(&mut call)));
}

/// Converts bytes to KiB, rounded up.
fn bytes_to_kib(bytes: usize) -> usize {
    bytes.div_ceil(1 << 10)
}

/// Returns the stack that a call needs below this function, bytes.
#[inline(never)]
fn stack_usage_of_call(call: &mut dyn FnMut()) -> usize {
    // The first call is not measured, since it can load or detect something.
    call();
    let here = black_box(0_u8);
    let top = std::ptr::from_ref(&here) as usize - MARGIN;
    paint_stack(top);
    call();
    top - lowest_overwritten_address(top)
}

/// Fills the stack below an address with the byte pattern.
#[inline(never)]
#[expect(unsafe_code, reason = "the stack below this function belongs to the thread, and nobody uses it")]
fn paint_stack(top: usize) {
    let own = black_box(0_u8);
    // The function's own frame is not overwritten.
    let top = top.min(std::ptr::from_ref(&own) as usize - MARGIN);
    for address in top - PAINTED..top {
        // SAFETY: the thread has `STACK` bytes, of which few are in use.
        unsafe { std::ptr::with_exposed_provenance_mut::<u8>(address).write_volatile(PAINT) };
    }
}

/// Returns the lowest address below `top` that no longer has the pattern.
#[inline(never)]
#[expect(unsafe_code, reason = "the stack below this function belongs to the thread")]
fn lowest_overwritten_address(top: usize) -> usize {
    // SAFETY: as in `paint`.
    let is_painted = |address: &usize| unsafe {
        std::ptr::with_exposed_provenance::<u8>(*address).read_volatile() == PAINT
    };
    (top - PAINTED..top).find(|address| !is_painted(address)).unwrap_or(top)
}
