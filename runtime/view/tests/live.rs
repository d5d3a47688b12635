//! Live views, seen by a test client: page, handshake, messages and rejected requests.

use linkwork::prelude::*;
use linkwork::simulate::Sample;
use linkwork_view::{Error, Live};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

#[mechanism(gravity = -9.81 * y, drawing)]
struct Arm {
    #[body(mass = 1, com = x / 2, inertia = rod(1, 1, x))]
    upper: Body,
    #[body(mass = 1, com = x / 2, inertia = rod(1, 1, x))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(x) -> lower, about = z)]
    elbow: Pin,
    #[acts(on = shoulder)]
    motor: Torque,
}

fn sample_at_time(t: f64) -> Sample<f64, 2, 2, 1> {
    Sample {
        t,
        q: [0.5 + t, -1.0].into(),
        v: [1.0, 0.0].into(),
        u: [3.5].into(),
        event: None,
        violation: 0.0,
    }
}

/// Opens a connection to the live view and sends an HTTP request. `fields` has further header lines.
fn send_request(url: &str, path: &str, fields: &str) -> TcpStream {
    let host = url.trim_start_matches("http://").trim_end_matches('/');
    let mut stream = TcpStream::connect(host).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    let host = if fields.contains("Host:") { String::new() } else { format!("Host: {host}\r\n") };
    write!(stream, "GET {path} HTTP/1.1\r\n{host}{fields}\r\n").unwrap();
    stream
}

const UPGRADE: &str = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
                       Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";

fn response_text(mut stream: TcpStream) -> String {
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    text
}

fn read_bytes<const N: usize>(stream: &mut TcpStream) -> [u8; N] {
    let mut bytes = [0; N];
    stream.read_exact(&mut bytes).unwrap();
    bytes
}

/// Opens a web socket to the server of a live view and checks the answer to the handshake.
fn open_web_socket(url: &str) -> TcpStream {
    let mut stream = send_request(url, "/socket", UPGRADE);
    let mut head = Vec::new();
    while !head.ends_with(b"\r\n\r\n") {
        head.extend(read_bytes::<1>(&mut stream));
    }
    let head = String::from_utf8(head).unwrap();
    assert!(
        head.starts_with("HTTP/1.1 101 ") && head.contains("Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"),
        "{head}"
    );
    stream
}

/// Returns the kind and content of the next web-socket frame that is not a ping.
fn read_frame(stream: &mut TcpStream) -> (u8, Vec<u8>) {
    loop {
        let [kind, length] = read_bytes(stream);
        let length = match length {
            126 => usize::from(u16::from_be_bytes(read_bytes(stream))),
            length => usize::from(length),
        };
        let mut content = vec![0; length];
        stream.read_exact(&mut content).unwrap();
        if kind != 0x89 {
            return (kind, content);
        }
    }
}

#[test]
fn browser_receives_page_and_samples() {
    let mut live = Live::open(&Arm {}, 0).unwrap();
    let page = response_text(send_request(&live.url(), "/", ""));
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n") && page.contains("<title>Arm</title>"));
    let (_, data) = page.split_once("<script type=\"application/json\">").unwrap();
    let motions: serde_json::Value = serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap();
    let motion = &motions[0];
    assert_eq!(motion["live"], true);
    // A client that connects before the first sample, and a later one, receive the same message.
    let mut early = open_web_socket(&live.url());
    let sample = sample_at_time(0.25);
    live.show(&sample).unwrap();
    let (kind, message) = read_frame(&mut early);
    assert_eq!((kind, read_frame(&mut open_web_socket(&live.url()))), (0x82, (0x82, message.clone())));

    assert_eq!(message[..8], 0.25_f64.to_le_bytes());
    let numbers: Vec<f64> =
        message[8..].chunks(4).map(|x| f64::from(f32::from_le_bytes(x.try_into().unwrap()))).collect();
    let frames = motion["frames"].as_array().unwrap();
    assert_eq!(numbers.len(), 7 * frames.len() + 2 + 1);
    for (name, n) in frames.iter().zip(numbers.chunks(7)) {
        let k = Arm::FRAMES.iter().position(|known| name == known).unwrap();
        let placement = Arm {}.frame_placements(&sample.q)[k];
        assert!((0..3).all(|k| (n[k] - placement.translation.vector[k]).abs() < 1e-6));
        // Rotated about z by the sum of the angles.
        let angle = if name == "upper" { 0.75 } else { -0.25_f64 };
        let known = [0.0, 0.0, (angle / 2.0).sin(), (angle / 2.0).cos()];
        assert!(n[3..].iter().zip(known).all(|(x, y)| (x - y).abs() < 1e-6), "{name} {n:?}");
    }
    assert_eq!(numbers[7 * frames.len()..], [0.75, -1.0, 3.5]);
    // The end of the program closes the socket.
    drop(live);
    let (kind, reason) = read_frame(&mut early);
    assert_eq!((kind, reason), (0x88, 1001_u16.to_be_bytes().to_vec()));
}

/// Checks that a program which shows samples does not block while one client reads nothing, and that another
/// client receives the newest sample.
#[test]
fn slow_client_does_not_block_the_loop() {
    let mut live = Live::open(&Arm {}, 0).unwrap();
    let (_idle, mut busy) = (open_web_socket(&live.url()), open_web_socket(&live.url()));
    for k in 0..20_000 {
        live.show(&sample_at_time(f64::from(k) * 1e-3)).unwrap();
    }
    let last = sample_at_time(100.0);
    let mut seen = 0.0;
    while seen < 100.0 {
        // A sample published while a client reads is dropped; the next one is not.
        live.show(&last).unwrap();
        let (_, message) = read_frame(&mut busy);
        let t = f64::from_le_bytes(message[..8].try_into().unwrap());
        assert!(t >= seen);
        seen = t;
    }
}

#[test]
fn foreign_requests_are_rejected() {
    let live = Live::open(&Arm {}, 0).unwrap();
    let url = live.url();
    let port = url.trim_end_matches('/').rsplit(':').next().unwrap();
    let response_status =
        |path: &str, fields: &str| response_text(send_request(&url, path, fields))[9..12].to_string();
    assert_eq!(response_status("/else", ""), "404");
    assert_eq!(response_status("/socket", ""), "404");
    assert_eq!(response_status("/socket", &format!("{UPGRADE}Origin: http://elsewhere.example\r\n")), "403");
    assert_eq!(response_status("/", &format!("Host: rebound.example:{port}\r\n")), "403");
    assert_eq!(response_status("/", &format!("Host: localhost:{port}\r\n")), "200");
    // Invalid data ends its own connection only.
    let mut noise = send_request(&url, "/", "");
    noise.write_all(&[0xff; 20_000]).ok();
    assert_eq!(response_status("/", ""), "200");
}

#[test]
fn used_ports_and_nan_placements_are_rejected() {
    let mut live = Live::open(&Arm {}, 0).unwrap();
    let port = live.url().trim_end_matches('/').rsplit(':').next().unwrap().parse().unwrap();
    let second = Live::open(&Arm {}, port);
    let error = second.err().unwrap();
    assert!(
        matches!(&error, Error::Port { port: known, cause } if *known == port && cause.kind() == std::io::ErrorKind::AddrInUse)
    );
    assert!(error.to_string().starts_with(&format!("port {port} on this machine: ")));
    assert!(matches!(live.show(&sample_at_time(f64::NAN)), Err(Error::NotFinite { sample: 0, .. })));
    let mut broken = sample_at_time(0.0);
    broken.q[1] = f64::INFINITY;
    assert!(matches!(live.show(&broken), Err(Error::NotFinite { frame, .. }) if frame == "lower"));
    // The port is free again after the view is dropped.
    drop(live);
    assert!(Live::open(&Arm {}, port).is_ok());
}
