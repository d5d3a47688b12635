//! The regulator of the example `lqr_double_pendulum` as a static library for C programs; `controller.h`
//! declares its functions. It needs neither the standard library nor an allocator.
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

use controller::{Cart, Regulator, force_on_cart, quadratic_costs};
use linkwork::discrete;
use linkwork::prelude::{Rk4, SVector};

/// Gains of the force on the cart: for the position of the cart and the angles of the poles, and for their
/// rates.
#[repr(C)]
pub struct Gains {
    q: [f64; 3],
    v: [f64; 3],
}

/// Computes the gains of a controller that runs every `period` seconds. Returns `false` if no stabilising
/// gains exist, as for a period that is not positive.
#[unsafe(no_mangle)]
pub extern "C" fn cart_design(period: f64, gains: &mut Gains) -> bool {
    let (upright, still) = (SVector::zeros(), SVector::zeros());
    let Some((found, _)) = regulator::linear_quadratic_regulator(
        &Cart {},
        &Rk4::step(period),
        &upright,
        &still,
        &quadratic_costs(),
    ) else {
        return false;
    };
    *gains = Gains { q: found.by_q.transpose().into(), v: found.by_v.transpose().into() };
    true
}

/// Returns the force on the cart for the current state, N.
#[unsafe(no_mangle)]
pub extern "C" fn cart_push(gains: &Gains, q: &[f64; 3], v: &[f64; 3]) -> f64 {
    let [by_q, by_v] = [gains.q, gains.v].map(|gain| SVector::from(gain).transpose());
    let regulator = Regulator { change: SVector::zeros(), by_q, by_v, expected: [0.0; 2] };
    force_on_cart(&regulator, &(*q).into(), &(*v).into())
}

/// Simulates the cart for one period. If the state after it is not finite, it returns `false` and leaves the
/// state unchanged.
#[unsafe(no_mangle)]
pub extern "C" fn cart_step(period: f64, push: f64, q: &mut [f64; 3], v: &mut [f64; 3]) -> bool {
    let (from, method) = ((SVector::from(*q), SVector::from(*v)), Rk4::step(period));
    let Ok(next) = discrete::step(&Cart {}, &method, 0.0, &from.0, &from.1, &[push].into()) else {
        return false;
    };
    (*q, *v) = (next.0.into(), next.1.into());
    true
}

/// Handler of panics that a program without the standard library must define; no code here panics.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
