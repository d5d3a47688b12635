//! Selection of instructions at run time: the program in `tests/dispatch` compares it with compile-time
//! selection. `benches/bits/run` compares them in reproducible arithmetic.
#![cfg(unix)]

use linkwork_programs::run_cargo;

#[test]
fn both_dispatch_selections_agree() {
    let output = run_cargo(&["run"], "dispatch", env!("CARGO_TARGET_TMPDIR"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
