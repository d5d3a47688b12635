//! The regulator of the example `lqr_double_pendulum` as a static library that C programs call:
//! `controller.h` declares what is here. Neither the standard library nor an allocator is needed.
//!
//! ```text
//! cargo build --release
//! cc -O2 main.c target/release/libcontroller.a -o balance && ./balance
//! ```

#![no_std]

#[path = "../../lqr_double_pendulum/controller.rs"]
mod controller;
#[path = "../../regulator/mod.rs"]
mod regulator;

use controller::{Cart, Regulator, control, costs};
use linkwork::discrete;
use linkwork::prelude::{Rk4, SVector};

/// Gains of the push on place, lean and bend, and on their rates.
#[repr(C)]
pub struct Gains {
    q: [f64; 3],
    v: [f64; 3],
}

/// Gains for a controller that is called every `period` seconds; false if there are none, as for a period
/// that is not positive.
#[unsafe(no_mangle)]
pub extern "C" fn cart_design(period: f64, gains: &mut Gains) -> bool {
    let (upright, still) = (SVector::zeros(), SVector::zeros());
    let Some((found, _)) = regulator::regulator(&Cart {}, &Rk4::step(period), &upright, &still, &costs())
    else {
        return false;
    };
    *gains = Gains { q: found.by_q.transpose().into(), v: found.by_v.transpose().into() };
    true
}

/// The push for the state of an instant, N.
#[unsafe(no_mangle)]
pub extern "C" fn cart_push(gains: &Gains, q: &[f64; 3], v: &[f64; 3]) -> f64 {
    let [by_q, by_v] = [gains.q, gains.v].map(|gain| SVector::from(gain).transpose());
    let regulator = Regulator { change: SVector::zeros(), by_q, by_v, expected: [0.0; 2] };
    control(&regulator, &(*q).into(), &(*v).into())
}

/// What the cart does in a period, for a simulation; false if the state afterwards is not finite, and it
/// stays as it was.
#[unsafe(no_mangle)]
pub extern "C" fn cart_step(period: f64, push: f64, q: &mut [f64; 3], v: &mut [f64; 3]) -> bool {
    let (from, method) = ((SVector::from(*q), SVector::from(*v)), Rk4::step(period));
    let Ok(next) = discrete::step(&Cart {}, &method, 0.0, &from.0, &from.1, &[push].into()) else {
        return false;
    };
    (*q, *v) = (next.0.into(), next.1.into());
    true
}

/// Nothing here panics.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
