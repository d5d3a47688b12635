//! Panic handler that cannot be linked: it makes every reachable panic a link error.

use core::panic::PanicInfo;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn linkwork_panic_path_reached() -> !;
    }
    // SAFETY: the program cannot be linked with this call in it, so it is never executed.
    unsafe { linkwork_panic_path_reached() }
}

// The C library provides the program's entry point.
#[link(name = "c")]
unsafe extern "C" {}
