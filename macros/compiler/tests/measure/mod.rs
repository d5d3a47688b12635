//! How long code is, and which: whoever changes what is emitted sees for which mechanisms it does.

/// How many bytes code has without its documentation, and their number.
pub fn measure(text: &str) -> String {
    let is_code = |line: &&str| !["///", "#[doc"].iter().any(|start| line.trim_start().starts_with(start));
    let bytes: Vec<u8> = text.lines().filter(is_code).flat_map(|line| line.bytes().chain([b'\n'])).collect();
    format!("{} bytes, {:016x}", bytes.len(), number(bytes))
}

/// A number in which every byte counts (FNV-1a by Fowler, Noll and Vo).
pub fn number(bytes: impl IntoIterator<Item = u8>) -> u64 {
    let start = 0xcbf2_9ce4_8422_2325_u64;
    bytes.into_iter().fold(start, |number, byte| (number ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}
