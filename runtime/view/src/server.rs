//! Server on this machine for the page of a live view, and for the web sockets that the page opens (RFC
//! 6455).
//!
//! The server sends messages and ignores those it receives. This needs only the handshake and the frames of a
//! server, for which a library would add a dozen crates.

use crate::Error;
use crate::encode::base64;
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Maximum number of simultaneous connections to the live view.
const MAX_CONNECTIONS: usize = 16;
/// Maximum length of the head of an HTTP request, bytes.
const LONGEST_HEAD: usize = 16_384;
/// Time after which an unresponsive connection is closed.
const PATIENCE: Duration = Duration::from_secs(2);
/// Interval between pings of the live view while there are no messages.
const SILENCE: Duration = Duration::from_millis(500);
/// Minimum interval between messages to a browser, about one screen refresh.
const SCREEN: Duration = Duration::from_nanos(16_000_000);

const BINARY: u8 = 0x82;
const CLOSE: u8 = 0x88;
const PING: u8 = 0x89;

/// Server with its thread, which ends when the server is dropped.
#[derive(Debug)]
pub(crate) struct PageServer {
    address: SocketAddr,
    shared: Arc<SharedState>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct SharedState {
    /// Accepted values of the HTTP field `Host`: names of this machine, with the port.
    hosts: [String; 2],
    page: String,
    newest: Mutex<NewestMessage>,
    news: Condvar,
    connections: AtomicUsize,
}

#[derive(Debug, Default)]
struct NewestMessage {
    number: u64,
    message: Vec<u8>,
    closed: bool,
}

impl PageServer {
    /// Serves a page at a port of this machine, or at any free port for port 0.
    pub(crate) fn open_server(port: u16, page: String) -> Result<PageServer, Error> {
        let port_error = |cause| Error::Port { port, cause };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(port_error)?;
        let address = listener.local_addr().map_err(port_error)?;
        let shared = Arc::new(SharedState {
            hosts: ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", address.port())),
            page,
            newest: Mutex::default(),
            news: Condvar::new(),
            connections: AtomicUsize::new(0),
        });
        let guests = shared.clone();
        let thread = thread::Builder::new().name("linkwork-view".to_string());
        let thread = thread.spawn(move || accept_connections(&listener, &guests)).map_err(port_error)?;
        Ok(PageServer { address, shared, thread: Some(thread) })
    }

    pub(crate) fn server_address(&self) -> SocketAddr {
        self.address
    }

    /// Sends a message to all browsers, unless the newest message is being read at this moment.
    pub(crate) fn publish_message(&self, message: &[u8]) {
        if let Ok(mut newest) = self.shared.newest.try_lock() {
            newest.number += 1;
            newest.message.clear();
            newest.message.extend_from_slice(message);
            drop(newest);
            self.shared.news.notify_all();
        }
    }
}

impl Drop for PageServer {
    fn drop(&mut self) {
        self.shared.lock_newest().closed = true;
        self.shared.news.notify_all();
        // Wakes the thread, which waits for a connection.
        if TcpStream::connect_timeout(&self.address, PATIENCE).is_ok()
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join();
        }
    }
}

impl SharedState {
    /// Locks the newest message for the browsers. A lock that a thread poisoned by a panic is still usable,
    /// because the message is unchanged.
    fn lock_newest(&self) -> MutexGuard<'_, NewestMessage> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Open connection, which is counted until it is dropped.
struct OpenConnection(Arc<SharedState>);

impl Drop for OpenConnection {
    fn drop(&mut self) {
        self.0.connections.fetch_sub(1, Ordering::Relaxed);
    }
}

fn accept_connections(listener: &TcpListener, shared: &Arc<SharedState>) {
    for stream in listener.incoming() {
        if shared.lock_newest().closed {
            return;
        }
        let Ok(stream) = stream else {
            // For example, the file descriptors are exhausted: the next attempt would also fail.
            thread::sleep(Duration::from_millis(10));
            continue;
        };
        let before = shared.connections.fetch_add(1, Ordering::Relaxed);
        let guest = OpenConnection(shared.clone());
        if before < MAX_CONNECTIONS {
            // A browser that disconnects is not an error.
            let _ = thread::Builder::new().spawn(move || {
                let _ = serve_request(stream, &guest.0);
            });
        }
    }
}

/// Answers one HTTP request: sends the page, or opens a web socket and sends the messages of the live view.
fn serve_request(mut stream: TcpStream, shared: &SharedState) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.set_nodelay(true)?;
    let head = read_request_head(&mut stream)?;
    let mut words = head.split(' ');
    let (method, path) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let header_field = |name: &str| {
        let mut fields = head.lines().skip(1).filter_map(|line| line.split_once(':'));
        fields.find(|(known, _)| known.trim().eq_ignore_ascii_case(name)).map(|(_, value)| value.trim())
    };
    // Rejects pages of other origins, including those that reach this machine by a host name of their own.
    let host = header_field("host").filter(|host| shared.hosts.iter().any(|known| known == host));
    let Some(host) = host else { return write_response(&mut stream, "403 Forbidden", "") };
    if header_field("origin").is_some_and(|origin| origin.strip_prefix("http://") != Some(host)) {
        return write_response(&mut stream, "403 Forbidden", "");
    }
    match (method, path, header_field("sec-websocket-key")) {
        ("GET", "/socket", Some(key)) => {
            let accept = base64(&sha1(format!("{key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11").as_bytes()));
            write!(
                stream,
                "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
                 Sec-WebSocket-Accept: {accept}\r\n\r\n"
            )?;
            send_newest_messages(stream, shared)
        }
        ("GET", "/", _) => write_response(&mut stream, "200 OK", &shared.page),
        _ => write_response(&mut stream, "404 Not Found", ""),
    }
}

/// Reads the head of a request, up to its first empty line.
fn read_request_head(stream: &mut TcpStream) -> io::Result<String> {
    let (mut head, mut part) = (Vec::new(), [0; 1024]);
    let start = Instant::now();
    while !head.windows(4).any(|end| end == b"\r\n\r\n") {
        let count = stream.read(&mut part)?;
        if count == 0 || head.len() > LONGEST_HEAD || start.elapsed() > PATIENCE {
            return Err(io::ErrorKind::InvalidData.into());
        }
        head.extend_from_slice(&part[..count]);
    }
    String::from_utf8(head).map_err(|_| io::ErrorKind::InvalidData.into())
}

fn write_response(stream: &mut TcpStream, status: &str, page: &str) -> io::Result<()> {
    let length = page.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {length}\r\n\
         Connection: close\r\n\r\n{page}"
    )
}

/// Sends the newest message whenever it changes, at most once per screen refresh.
fn send_newest_messages(mut stream: TcpStream, shared: &SharedState) -> io::Result<()> {
    let (mut seen, mut message) = (0, Vec::new());
    loop {
        let newest = shared.lock_newest();
        let is_waiting_for_news = |newest: &mut NewestMessage| newest.number == seen && !newest.closed;
        let waited = shared.news.wait_timeout_while(newest, SILENCE, is_waiting_for_news);
        let (newest, silence) = waited.unwrap_or_else(PoisonError::into_inner);
        if newest.closed {
            drop(newest);
            return send_frame(&mut stream, CLOSE, &1001_u16.to_be_bytes());
        }
        seen = newest.number;
        message.clone_from(&newest.message);
        drop(newest);
        match silence.timed_out() {
            true => send_frame(&mut stream, PING, &[])?,
            false => send_frame(&mut stream, BINARY, &message)?,
        }
        discard_browser_data(&mut stream)?;
        thread::sleep(SCREEN);
    }
}

/// Sends a web-socket frame: a byte for its kind, its length, and its content.
fn send_frame(stream: &mut TcpStream, kind: u8, content: &[u8]) -> io::Result<()> {
    let mut frame = vec![kind];
    match content.len() {
        length @ 0..126 => frame.push(length as u8),
        length @ 126..65_536 => {
            frame.push(126);
            frame.extend((length as u16).to_be_bytes());
        }
        length => {
            frame.push(127);
            frame.extend((length as u64).to_be_bytes());
        }
    }
    frame.extend_from_slice(content);
    stream.write_all(&frame)
}

/// Discards data from the browser, and returns an error if it has disconnected.
fn discard_browser_data(stream: &mut TcpStream) -> io::Result<()> {
    stream.set_nonblocking(true)?;
    let found = loop {
        match stream.read(&mut [0; 256]) {
            Ok(0) => break Err(io::ErrorKind::ConnectionAborted.into()),
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => break Ok(()),
            Err(error) => break Err(error),
        }
    };
    stream.set_nonblocking(false)?;
    found
}

/// Computes the SHA-1 digest of the handshake of a web socket (FIPS 180-4). It serves no secrecy: the
/// protocol uses it to confirm that the server supports web sockets.
fn sha1(text: &[u8]) -> [u8; 20] {
    let mut bytes = text.to_vec();
    bytes.push(0x80);
    bytes.resize(bytes.len().next_multiple_of(64), 0);
    if bytes.len() - text.len() < 9 {
        bytes.resize(bytes.len() + 64, 0);
    }
    let end = bytes.len();
    bytes[end - 8..].copy_from_slice(&(8 * text.len() as u64).to_be_bytes());
    let mut h = [0x6745_2301_u32, 0xefcd_ab89, 0x98ba_dcfe, 0x1032_5476, 0xc3d2_e1f0];
    for block in bytes.chunks_exact(64) {
        let mut w = [0_u32; 80];
        for (word, four) in w.iter_mut().zip(block.chunks_exact(4)) {
            *word = four.iter().fold(0, |word, byte| word << 8 | u32::from(*byte));
        }
        for k in 16..80 {
            w[k] = (w[k - 3] ^ w[k - 8] ^ w[k - 14] ^ w[k - 16]).rotate_left(1);
        }
        let [mut a, mut b, mut c, mut d, mut e] = h;
        for (k, word) in w.into_iter().enumerate() {
            let (f, constant) = match k / 20 {
                0 => ((b & c) | (!b & d), 0x5a82_7999),
                1 => (b ^ c ^ d, 0x6ed9_eba1),
                2 => ((b & c) | (b & d) | (c & d), 0x8f1b_bcdc),
                _ => (b ^ c ^ d, 0xca62_c1d6_u32),
            };
            let sum = a.rotate_left(5).wrapping_add(f).wrapping_add(e).wrapping_add(constant);
            (e, d, c, b, a) = (d, c, b.rotate_left(30), a, sum.wrapping_add(word));
        }
        for (sum, x) in h.iter_mut().zip([a, b, c, d, e]) {
            *sum = sum.wrapping_add(x);
        }
    }
    let mut digest = [0; 20];
    for (bytes, word) in digest.chunks_exact_mut(4).zip(h) {
        bytes.copy_from_slice(&word.to_be_bytes());
    }
    digest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks SHA-1 digests: the examples of the validation of FIPS 180-4, texts at block boundaries, and the
    /// handshake of RFC 6455, section 1.3.
    #[test]
    fn sha1_digests_match_the_standard() {
        let hex =
            |text: &str| sha1(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        assert_eq!(hex(""), "da39a3ee5e6b4b0d3255bfef95601890afd80709");
        assert_eq!(hex("abc"), "a9993e364706816aba3e25717850c26c9cd0d89d");
        assert_eq!(
            hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "84983e441c3bd26ebaae4aa1f95129e5e54670f1"
        );
        assert_eq!(hex(&"a".repeat(1_000_000)), "34aa973cd4c4daa4f61eeb2bdbad27316534016f");
        let handshake = "dGhlIHNhbXBsZSBub25jZQ==258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
        assert_eq!(base64(&sha1(handshake.as_bytes())), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
    }
}
