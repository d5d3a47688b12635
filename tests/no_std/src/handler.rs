//! What cannot be linked with a way to panic.

use core::panic::PanicInfo;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn linkwork_panic_path_reached() -> !;
    }
    // SAFETY: the program cannot be linked with this call in it, so it is never made.
    unsafe { linkwork_panic_path_reached() }
}

// The C library starts the program.
#[link(name = "c")]
unsafe extern "C" {}
