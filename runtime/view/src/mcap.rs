//! Logs of motions as MCAP files with Foxglove schemas (<https://mcap.dev/spec>).
//!
//! A file is a sequence of records: a byte for the kind, eight bytes for the length of the content, then the
//! content. Numbers are little-endian; strings are preceded by their length in four bytes. Messages are JSON
//! and are written one after the other, without chunks and without compression.

use crate::figure::to_double;
use crate::motion::placement_in_double;
use crate::{Error, text};
use linkwork::nalgebra::{IsometryMatrix3, UnitQuaternion};
use linkwork::simulate::Sample;
use linkwork::{Frames, Mechanism};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
const HEADER: u8 = 0x01;
const FOOTER: u8 = 0x02;
const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const STATISTICS: u8 = 0x0b;
const DATA_END: u8 = 0x0f;

/// Topics of an MCAP log, with the names and contents of their schemas. Foxglove recognises the first two by
/// name.
const TOPICS: [(&str, &str, &str); 3] = [
    (
        "/tf",
        "foxglove.FrameTransforms",
        r#"{"type":"object","properties":{"transforms":{"type":"array","items":{"type":"object","properties":{"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},"parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},"translation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}},"rotation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}}}}}}}}"#,
    ),
    (
        "/joint_states",
        "foxglove.JointStates",
        r#"{"type":"object","properties":{"timestamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},"joints":{"type":"array","items":{"type":"object","properties":{"name":{"type":"string"},"position":{"type":"number"},"velocity":{"type":"number"}}}}}}"#,
    ),
    (
        "/state",
        "linkwork.State",
        r#"{"type":"object","properties":{"t":{"type":"number"},"q":{"type":"object","additionalProperties":{"type":"number"}},"v":{"type":"object","additionalProperties":{"type":"number"}},"u":{"type":"object","additionalProperties":{"type":"number"}}}}"#,
    ),
];

/// Returns a motion as the content of an MCAP file, with one message per topic and sample:
///
/// - `/tf`, `foxglove.FrameTransforms`: the frames of the mechanism in the frame `ground`, m, quaternions;
/// - `/joint_states`, `foxglove.JointStates`: position and velocity of every coordinate that is a single
///   number with a velocity of the same name, m and m/s, rad and rad/s;
/// - `/state`, `linkwork.State`: time, configuration `q`, velocity `v` and inputs `u` by name in full
///   precision, for plots.
///
/// ```
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * y)]
/// struct Pendulum {
///     #[particle(mass = 1)]
///     bob: Particle,
///     #[joint(ground -> bob.at(y), about = z)]
///     hinge: Pin,
/// }
///
/// let fall: Vec<_> = simulate(&Pendulum {}).from([0.5], [0.0]).duration(0.1).sample_every(0.05).collect::<Result<_, _>>()?;
/// let log = linkwork_view::mcap(&Pendulum {}, &fall)?;
/// assert!(log.starts_with(b"\x89MCAP0\r\n"));
/// # let folder = std::env::temp_dir();
/// std::fs::write(folder.join("fall.mcap"), log)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`Error::Time`] if a time is negative, not finite, or before the previous one; [`Error::NotFinite`] if a
/// value is not finite.
pub fn mcap<M, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    samples: &[Sample<<M as Mechanism<NQ, NV, NU>>::Scalar, NQ, NV, NU>],
) -> Result<Vec<u8>, Error>
where
    M: Mechanism<NQ, NV, NU> + Frames<NQ, NV, Scalar = <M as Mechanism<NQ, NV, NU>>::Scalar>,
{
    let list_as_f64 = |list: &[_]| list.iter().map(|x| to_double(*x)).collect();
    let names = Names {
        frames: M::FRAMES,
        configuration: &M::CONFIGURATION,
        velocities: &M::VELOCITIES,
        inputs: &M::INPUTS,
    };
    let instant_of_sample = |sample: &Sample<<M as Mechanism<NQ, NV, NU>>::Scalar, NQ, NV, NU>| {
        let frames = 0..M::FRAMES.len();
        Instant {
            t: to_double(sample.t),
            q: list_as_f64(sample.q.as_slice()),
            v: list_as_f64(sample.v.as_slice()),
            u: list_as_f64(sample.u.as_slice()),
            placements: frames
                .filter_map(|k| Some(placement_in_double(&mechanism.placement_of(k, sample.t, &sample.q)?)))
                .collect(),
        }
    };
    mcap_of(&names, samples.iter().map(instant_of_sample))
}

/// Names of the quantities in an MCAP log, in the order of their values.
#[derive(Clone, Copy, Debug)]
pub struct Names<'a> {
    /// Names of the frames whose placements are logged.
    pub frames: &'a [&'a str],
    /// Names of the entries of the configuration in the log.
    pub configuration: &'a [&'a str],
    /// Names of the entries of the velocity in the log.
    pub velocities: &'a [&'a str],
    /// Names of the inputs in the log.
    pub inputs: &'a [&'a str],
}

/// State, inputs and frame placements at one instant of a logged motion.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Time of the instant, s.
    pub t: f64,
    /// Configuration, one entry per name in [`Names::configuration`], m or rad.
    pub q: Vec<f64>,
    /// Velocity, one entry per name in [`Names::velocities`], m/s or rad/s.
    pub v: Vec<f64>,
    /// Inputs, one entry per name in [`Names::inputs`], in the units of their actuators.
    pub u: Vec<f64>,
    /// Placements of [`Names::frames`] in the axes of the ground, m.
    pub placements: Vec<IsometryMatrix3<f64>>,
}

/// Returns an MCAP log of a motion that is not computed by generated code: placements of frames (m, in the
/// axes of the ground), configurations, velocities and inputs in SI units, at the instants of `samples`.
/// [`mcap`] writes the log of a mechanism.
///
/// # Errors
///
/// As for [`mcap`], and [`Error::Count`] if an instant has a different number of entries than there are
/// names.
pub fn mcap_of(names: &Names<'_>, samples: impl IntoIterator<Item = Instant>) -> Result<Vec<u8>, Error> {
    let mut file = McapFile::new();
    let mut last = 0.0;
    for (k, sample) in samples.into_iter().enumerate() {
        check_representable(names, k, &sample, last)?;
        last = sample.t;
        let nanoseconds = (sample.t * 1e9).round() as u64;
        let stamp =
            format!("{{\"sec\":{},\"nsec\":{}}}", nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
        let frame_transform_json = |(name, placement): (&&str, &IsometryMatrix3<f64>)| {
            let at = placement.translation.vector;
            let q = UnitQuaternion::from_rotation_matrix(&placement.rotation);
            format!(
                "{{\"timestamp\":{stamp},\"parent_frame_id\":\"ground\",\"child_frame_id\":{},\"translation\":{{\"x\":{},\"y\":{},\"z\":{}}},\"rotation\":{{\"x\":{},\"y\":{},\"z\":{},\"w\":{}}}}}",
                text::json(name),
                at.x,
                at.y,
                at.z,
                q.i,
                q.j,
                q.k,
                q.w
            )
        };
        let transforms = names.frames.iter().zip(&sample.placements).map(frame_transform_json);
        let joint_state_json = |(name, x): (&&str, &f64)| {
            let rate = names.velocities.iter().position(|rate| rate == name)?;
            Some(format!(
                "{{\"name\":{},\"position\":{x},\"velocity\":{}}}",
                text::json(name),
                sample.v[rate]
            ))
        };
        let joints = names.configuration.iter().zip(&sample.q).filter_map(joint_state_json);
        let json_by_name = |names: &[&str], numbers: &[f64]| {
            let entries = names.iter().zip(numbers);
            let entries: Vec<String> = entries.map(|(name, x)| format!("{}:{x}", text::json(name))).collect();
            format!("{{{}}}", entries.join(","))
        };
        let messages = [
            format!("{{\"transforms\":{}}}", text::list(transforms)),
            format!("{{\"timestamp\":{stamp},\"joints\":{}}}", text::list(joints)),
            format!(
                "{{\"t\":{},\"q\":{},\"v\":{},\"u\":{}}}",
                sample.t,
                json_by_name(names.configuration, &sample.q),
                json_by_name(names.velocities, &sample.v),
                json_by_name(names.inputs, &sample.u)
            ),
        ];
        for (channel, message) in (1..).zip(&messages) {
            file.write_message(channel, nanoseconds, message);
        }
    }
    Ok(file.finish_file())
}

/// Returns an error for values that an MCAP file cannot represent: times outside 64 bits of nanoseconds, and
/// values that are not finite.
fn check_representable(names: &Names<'_>, k: usize, sample: &Instant, last: f64) -> Result<(), Error> {
    let motion_title = || "mcap".to_string();
    let not_finite =
        |frame: &str| Err(Error::NotFinite { motion: motion_title(), sample: k, frame: frame.to_string() });
    for (what, list, found) in [
        ("frames", names.frames, sample.placements.len()),
        ("configuration", names.configuration, sample.q.len()),
        ("velocity", names.velocities, sample.v.len()),
        ("inputs", names.inputs, sample.u.len()),
    ] {
        if list.len() != found {
            let what = format!("the {what} of sample {k} of `mcap`");
            return Err(Error::Count { what, expected: list.len(), found });
        }
    }
    if !(sample.t >= last && sample.t < 1e10) {
        return Err(Error::Time { motion: motion_title(), sample: k });
    }
    if sample.q.iter().chain(&sample.v).chain(&sample.u).any(|x| !x.is_finite()) {
        return not_finite("state");
    }
    for (name, placement) in names.frames.iter().zip(&sample.placements) {
        if placement.translation.vector.iter().chain(placement.rotation.matrix()).any(|x| !x.is_finite()) {
            return not_finite(name);
        }
    }
    Ok(())
}

/// MCAP file to which messages are appended.
struct McapFile {
    bytes: Vec<u8>,
    /// Number of messages in the file. The other fields are the first and last time of all messages, ns.
    count: u32,
    first: u64,
    last: u64,
}

/// Content of an MCAP record under construction, in bytes.
#[derive(Default)]
struct RecordContent(Vec<u8>);

impl RecordContent {
    fn append_bytes(mut self, bytes: &[u8]) -> RecordContent {
        self.0.extend_from_slice(bytes);
        self
    }

    fn append_string(self, text: &str) -> RecordContent {
        self.append_bytes(&(text.len() as u32).to_le_bytes()).append_bytes(text.as_bytes())
    }
}

impl McapFile {
    fn new() -> McapFile {
        let mut file = McapFile { bytes: MAGIC.to_vec(), count: 0, first: 0, last: 0 };
        file.write_record(
            HEADER,
            RecordContent::default()
                .append_string("")
                .append_string(concat!("linkwork ", env!("CARGO_PKG_VERSION"))),
        );
        file.write_schemas_and_channels();
        file
    }

    fn write_record(&mut self, kind: u8, content: RecordContent) {
        self.bytes.push(kind);
        self.bytes.extend((content.0.len() as u64).to_le_bytes());
        self.bytes.extend(content.0);
    }

    /// Writes the MCAP records for the schema and the channel of each topic.
    fn write_schemas_and_channels(&mut self) {
        for (id, (topic, name, schema)) in (1_u16..).zip(TOPICS) {
            let id = id.to_le_bytes();
            let content = RecordContent::default()
                .append_bytes(&id)
                .append_string(name)
                .append_string("jsonschema")
                .append_string(schema);
            self.write_record(SCHEMA, content);
            let content = RecordContent::default()
                .append_bytes(&id)
                .append_bytes(&id)
                .append_string(topic)
                .append_string("json");
            // No metadata.
            self.write_record(CHANNEL, content.append_bytes(&0_u32.to_le_bytes()));
        }
    }

    fn write_message(&mut self, channel: u16, nanoseconds: u64, message: &str) {
        if self.count == 0 {
            self.first = nanoseconds;
        }
        self.last = nanoseconds;
        let time = nanoseconds.to_le_bytes();
        let sequence = (self.count / TOPICS.len() as u32).to_le_bytes();
        self.count += 1;
        let head = RecordContent::default().append_bytes(&channel.to_le_bytes()).append_bytes(&sequence);
        self.write_record(
            MESSAGE,
            head.append_bytes(&time).append_bytes(&time).append_bytes(message.as_bytes()),
        );
    }

    /// Completes the file with a summary: schemas, channels and the number of messages.
    fn finish_file(mut self) -> Vec<u8> {
        // A checksum of zero means that none is provided.
        let none = 0_u32.to_le_bytes();
        self.write_record(DATA_END, RecordContent::default().append_bytes(&none));
        let summary = self.bytes.len() as u64;
        self.write_schemas_and_channels();
        let channels = TOPICS.len() as u16;
        let statistics = RecordContent::default()
            .append_bytes(&u64::from(self.count).to_le_bytes())
            .append_bytes(&channels.to_le_bytes())
            .append_bytes(&u32::from(channels).to_le_bytes())
            // Number of attachments, metadata records and chunks.
            .append_bytes(&[0; 12])
            .append_bytes(&self.first.to_le_bytes())
            .append_bytes(&self.last.to_le_bytes())
            .append_bytes(&(10 * u32::from(channels)).to_le_bytes());
        let each = u64::from(self.count / u32::from(channels)).to_le_bytes();
        let statistics = (1..=channels)
            .fold(statistics, |all, channel| all.append_bytes(&channel.to_le_bytes()).append_bytes(&each));
        self.write_record(STATISTICS, statistics);
        let footer =
            RecordContent::default().append_bytes(&summary.to_le_bytes()).append_bytes(&0_u64.to_le_bytes());
        self.write_record(FOOTER, footer.append_bytes(&none));
        self.bytes.extend_from_slice(MAGIC);
        self.bytes
    }
}
