//! How long code is, and which: whoever changes what is emitted sees for which mechanisms it does.

/// The bytes of code without its documentation, and a number in which every one counts (FNV-1a by Fowler, Noll and Vo).
pub fn measure(text: &str) -> String {
    let is_code = |line: &&str| !["///", "#[doc"].iter().any(|start| line.trim_start().starts_with(start));
    let (mut bytes, mut number) = (0, 0xcbf2_9ce4_8422_2325_u64);
    for byte in text.lines().filter(is_code).flat_map(|line| line.bytes().chain([b'\n'])) {
        bytes += 1;
        number = (number ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
    }
    format!("{bytes} bytes, {number:016x}")
}
