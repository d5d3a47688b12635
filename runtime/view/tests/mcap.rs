//! Logs as MCAP files, read by a test reader that follows the published format record by record.

use linkwork::nalgebra::{Quaternion, UnitQuaternion};
use linkwork::prelude::*;
use linkwork::simulate::Sample;
use linkwork_view::{Error, mcap};
use serde_json::Value;
use std::process::Command;

#[mechanism(gravity = -9.81 * z)]
struct FloatingBoat {
    #[body(mass = 2, inertia = cuboid(2, 1, 0.4, 0.2))]
    hull: Body,
    #[body(mass = 0.5, com = z, inertia = rod(0.5, 2, z))]
    mast: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[joint(hull -> mast, about = x)]
    tilt: Pin,
    #[acts(on = tilt)]
    winch: Torque,
}

fn sample_at_time(t: f64) -> Sample<f64, 8, 7, 1> {
    let half = 0.5 * t;
    let q = [t, 2.0, 0.1, half.sin(), 0.0, 0.0, half.cos(), 0.1 + 1.0 / 3.0];
    Sample {
        t,
        q: q.into(),
        v: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -0.7].into(),
        u: [4.5].into(),
        event: None,
        violation: 0.0,
    }
}

/// Reader of bytes that takes numbers and strings from the front.
struct ByteReader<'a>(&'a [u8]);

impl<'a> ByteReader<'a> {
    fn take_bytes(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count);
        self.0 = rest;
        taken
    }

    fn read_number(&mut self, bytes: usize) -> u64 {
        self.take_bytes(bytes).iter().rev().fold(0, |n, byte| n << 8 | u64::from(*byte))
    }

    fn read_string(&mut self) -> &'a str {
        let length = self.read_number(4) as usize;
        std::str::from_utf8(self.take_bytes(length)).unwrap()
    }
}

/// Returns the records of an MCAP file, each with its offset, its kind and its content.
fn records_of_file(file: &[u8]) -> Vec<(usize, u8, ByteReader<'_>)> {
    let magic = b"\x89MCAP0\r\n";
    assert!(file.starts_with(magic) && file.ends_with(magic));
    let mut rest = ByteReader(&file[8..file.len() - 8]);
    let mut records = Vec::new();
    while !rest.0.is_empty() {
        let at = file.len() - 8 - rest.0.len();
        let (kind, length) = (rest.read_number(1) as u8, rest.read_number(8) as usize);
        records.push((at, kind, ByteReader(rest.take_bytes(length))));
    }
    records
}

#[test]
fn mcap_records_follow_the_format() {
    let file =
        mcap(&FloatingBoat {}, &[sample_at_time(0.0), sample_at_time(0.25), sample_at_time(1.5)]).unwrap();
    let mut records = records_of_file(&file);
    let kinds: Vec<u8> = records.iter().map(|record| record.1).collect();
    let described = [3, 4, 3, 4, 3, 4];
    assert_eq!(kinds, [&[1][..], &described, &[5; 9], &[15], &described, &[11, 2]].concat());
    let (first, rest) = records.split_at_mut(7);
    let mut topics = Vec::new();
    for pair in first[1..].chunks_mut(2) {
        let [schema, channel] = pair else { panic!("a schema and its channel") };
        let (id, name) = (schema.2.read_number(2), schema.2.read_string());
        assert_eq!(schema.2.read_string(), "jsonschema");
        let schema: Value = serde_json::from_str(schema.2.read_string()).unwrap();
        assert_eq!((channel.2.read_number(2), channel.2.read_number(2)), (id, id));
        topics.push((channel.2.read_string(), name, schema["type"].clone()));
        assert_eq!((channel.2.read_string(), channel.2.read_number(4), channel.2.0.len()), ("json", 0, 0));
    }
    assert_eq!(topics[0], ("/tf", "foxglove.FrameTransforms", "object".into()));
    assert_eq!(topics[1], ("/joint_states", "foxglove.JointStates", "object".into()));
    assert_eq!(topics[2], ("/state", "linkwork.State", "object".into()));
    for (k, record) in rest[..9].iter_mut().enumerate() {
        let t = [0, 250_000_000, 1_500_000_000][k / 3];
        let head = (
            record.2.read_number(2),
            record.2.read_number(4),
            record.2.read_number(8),
            record.2.read_number(8),
        );
        assert_eq!(head, (k as u64 % 3 + 1, k as u64 / 3, t, t));
        assert!(serde_json::from_slice::<Value>(record.2.0).is_ok());
    }
    let summary = rest[10].0 as u64;
    let statistics = &mut rest[16].2;
    let counts = (statistics.read_number(8), statistics.read_number(2), statistics.read_number(4));
    assert_eq!((counts, statistics.read_number(12)), ((9, 3, 3), 0));
    assert_eq!((statistics.read_number(8), statistics.read_number(8)), (0, 1_500_000_000));
    assert_eq!(statistics.read_number(4), 30);
    for channel in 1..=3 {
        assert_eq!((statistics.read_number(2), statistics.read_number(8)), (channel, 3));
    }
    let footer = &mut rest[17].2;
    assert_eq!((footer.read_number(8), footer.read_number(8), footer.read_number(4)), (summary, 0, 0));
}

/// Checks that the logged placements are those of the mechanism, up to rounding of quaternions, and that all
/// other values have full precision.
#[test]
fn mcap_messages_contain_the_samples() {
    let sample = sample_at_time(0.25);
    let file = mcap(&FloatingBoat {}, &[sample]).unwrap();
    let messages = records_of_file(&file).into_iter().filter(|record| record.1 == 5);
    let messages: Vec<Value> =
        messages.map(|record| serde_json::from_slice(&record.2.0[22..]).unwrap()).collect();
    let [frames, joints, state] = &messages[..] else { panic!("three topics") };
    let transforms = frames["transforms"].as_array().unwrap();
    assert_eq!(transforms.len(), FloatingBoat::FRAMES.len());
    for (k, (transform, placement)) in
        transforms.iter().zip(FloatingBoat {}.frame_placements(&sample.q)).enumerate()
    {
        assert_eq!(
            (&transform["parent_frame_id"], &transform["child_frame_id"]),
            (&"ground".into(), &FloatingBoat::FRAMES[k].into())
        );
        assert_eq!(transform["timestamp"]["nsec"], 250_000_000);
        let transform_number = |of: &str, axis: &str| transform[of][axis].as_f64().unwrap();
        let at = ["x", "y", "z"].map(|axis| transform_number("translation", axis));
        assert_eq!(at, <[f64; 3]>::from(placement.translation.vector));
        let [x, y, z, w] = ["x", "y", "z", "w"].map(|axis| transform_number("rotation", axis));
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        assert!((turn.to_rotation_matrix().matrix() - placement.rotation.matrix()).norm() < 1e-12);
    }
    // Of all joints, only the pin has a single coordinate.
    let tilt = serde_json::json!([{"name": "tilt", "position": 0.1 + 1.0 / 3.0, "velocity": -0.7}]);
    assert_eq!(joints["joints"], tilt);
    assert_eq!((&state["t"], &state["u"]["winch"]), (&0.25.into(), &4.5.into()));
    let q = state["q"].as_object().unwrap();
    assert_eq!(q.len(), 8);
    assert_eq!(q[FloatingBoat::CONFIGURATION[7]], 0.1 + 1.0 / 3.0);
}

#[test]
fn unloggable_motions_are_errors() {
    let late = mcap(&FloatingBoat {}, &[sample_at_time(1.0), sample_at_time(0.5)]);
    assert!(matches!(late, Err(Error::Time { sample: 1, .. })));
    assert!(matches!(mcap(&FloatingBoat {}, &[sample_at_time(-0.1)]), Err(Error::Time { sample: 0, .. })));
    assert!(matches!(mcap(&FloatingBoat {}, &[sample_at_time(f64::NAN)]), Err(Error::Time { .. })));
    let mut broken = sample_at_time(0.0);
    broken.u[0] = f64::INFINITY;
    assert!(matches!(
        mcap(&FloatingBoat {}, &[sample_at_time(0.0), broken]),
        Err(Error::NotFinite { sample: 1, .. })
    ));
    assert!(records_of_file(&mcap(&FloatingBoat {}, &[]).unwrap()).len() == 16);
}

/// Compares the log with the content read by the Python package of the format's authors, if it is installed.
#[test]
fn mcap_log_is_read_by_reference_reader() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("boat.mcap");
    let samples: Vec<_> = (0..5).map(|k| sample_at_time(0.1 * f64::from(k))).collect();
    std::fs::write(&path, mcap(&FloatingBoat {}, &samples).unwrap()).unwrap();
    let script = "
import json, sys
try:
    from mcap.reader import make_reader
except ImportError:
    print('none'); sys.exit()
with open(sys.argv[1], 'rb') as file:
    reader = make_reader(file)
    counts = reader.get_summary().statistics.channel_message_counts
    times = [(c.topic, m.log_time, json.loads(m.data).get('t')) for _, c, m in reader.iter_messages(topics=['/state'])]
print(sorted(counts.items()), times[-1], len(times))
";
    let Ok(output) = Command::new("python3").args(["-c", script]).arg(&path).output() else {
        println!("skipped: no Python");
        return;
    };
    let found = String::from_utf8_lossy(&output.stdout);
    match found.trim() {
        "none" => println!("skipped: Python has no package `mcap`"),
        found => assert_eq!(
            found,
            "[(1, 5), (2, 5), (3, 5)] ('/state', 400000000, 0.4) 5",
            "{}",
            String::from_utf8_lossy(&output.stderr)
        ),
    }
}
