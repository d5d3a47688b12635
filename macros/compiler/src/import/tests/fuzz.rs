//! Random damage to a small file causes a result or errors, but never a panic.

use super::*;

const FILE: &str = r#"<?xml version="1.0"?>
<robot name="r"> <!-- c -->
  <link name="a"><inertial><origin xyz="1 2 3" rpy="0 0.1 0"/><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="b"/><link name="c"/>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
    <origin xyz="0 0 1" rpy="1 2 3"/><dynamics damping="1" friction="0"/></joint>
  <joint name="k" type="prismatic"><parent link="b"/><child link="c"/>
    <mimic joint="j" multiplier="2" offset="1"/></joint>
</robot>"#;

/// Advances the pseudorandom generator (xorshift64) and returns a number.
fn next_random_number(state: &mut u64) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 16) as usize
}

/// Changes, removes, copies or inserts random bytes of a file.
fn damage_bytes(bytes: &mut Vec<u8>, state: &mut u64) {
    const SPICE: &[u8] = b"<>/=\"' &;!-[]?:.0e9-abcjk\x00\xc3\xa4\n";
    let at = next_random_number(state) % bytes.len();
    let length = (next_random_number(state) % 40).min(bytes.len() - at);
    match next_random_number(state) % 5 {
        0 => bytes[at] = SPICE[next_random_number(state) % SPICE.len()],
        1 => bytes.insert(at, SPICE[next_random_number(state) % SPICE.len()]),
        2 if bytes.len() > 100 => drop(bytes.drain(at..at + length)),
        3 => {
            let piece = bytes[at..at + length].to_vec();
            let to = next_random_number(state) % bytes.len();
            bytes.splice(to..to, piece);
        }
        _ => {
            let other = next_random_number(state) % bytes.len();
            bytes.swap(at, other);
        }
    }
}

#[test]
fn damaged_urdf_never_panics() {
    let options = FileOptions { inputs: FileInputSource::Joints, ..options_with_locked_joints(&["j"]) };
    check_damaged_imports(&options, FILE, "root_joint");
}

/// Imports randomly damaged versions of a file. `sign` is a text that occurs in results but not in errors.
pub(super) fn check_damaged_imports(options: &FileOptions, file: &str, sign: &str) {
    let mut state = 0x9E37_79B9_7F4A_7C15;
    let mut good = 0;
    for round in 0..4000 {
        let mut bytes = file.as_bytes().to_vec();
        for _ in 0..=round % 4 {
            damage_bytes(&mut bytes, &mut state);
        }
        let answer = import_as_text(options, &String::from_utf8_lossy(&bytes));
        good += usize::from(answer.contains(sign));
    }
    assert!((50..3900).contains(&good), "damage should spare some files and not others: {good}");
}

#[test]
fn truncated_urdf_never_panics() {
    for end in 0..FILE.len() {
        assert!(!import_as_text(&default_file_options(), &FILE[..end]).contains("root_joint"));
    }
    assert!(import_as_text(&default_file_options(), FILE).contains("root_joint"));
}
