//! Program that may panic, so that linking it without a panic handler fails.

#![no_std]
#![no_main]

mod handler;

#[unsafe(no_mangle)]
extern "C" fn main(arguments: i32, _: *const *const u8) -> i32 {
    [0, 1][arguments as usize]
}
