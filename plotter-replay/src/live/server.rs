//! [`Server`]: the page of a session, for browsers on this computer only.

use super::view::Cursor;
use super::{Command, Session};
use core::fmt;
use core::time::Duration;
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;
use tungstenite::handshake::derive_accept_key;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

/// Time between two updates of a page: twenty a second look like motion.
const UPDATE_EVERY: Duration = Duration::from_millis(50);
/// Longest head of a request, bytes. It bounds memory, and no browser sends this much to the page.
const MOST_HEAD_BYTES: usize = 8_192;
/// Browsers at the same time.
const MOST_CONNECTIONS: usize = 32;
/// How long a browser may keep us waiting.
const PATIENCE: Duration = Duration::from_secs(5);

/// Shows a session on 127.0.0.1, at an address that only who is told it knows.
#[derive(Debug)]
pub struct Server {
    address: String,
    watching: Arc<AtomicUsize>,
}

/// Why there is no server.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ServerError {
    /// Another program has the port.
    InUse {
        /// Its number.
        port: u16,
    },
    /// The system refuses.
    System {
        /// In its words.
        message: String,
    },
}

impl fmt::Display for ServerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InUse { port } => write!(
                f,
                "port {port} of 127.0.0.1 is used by another program: give another one, or 0 for any that is free"
            ),
            Self::System { message } => f.write_str(message),
        }
    }
}

impl core::error::Error for ServerError {}

/// What every connection needs.
#[derive(Debug)]
struct Site {
    session: Session,
    page: String,
    token: String,
    port: u16,
}

impl Server {
    /// Serves `session` on `port` of 127.0.0.1, or on any that is free for 0. `page` makes the page, given
    /// the address at which it may open its socket.
    ///
    /// # Errors
    ///
    /// [`ServerError`] if the port is in use or the system refuses.
    pub fn open(session: Session, port: u16, page: impl FnOnce(&str) -> String) -> Result<Self, ServerError> {
        let system = |error: &dyn fmt::Display| ServerError::System { message: error.to_string() };
        let listener =
            TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|error| match error.kind() {
                io::ErrorKind::AddrInUse => ServerError::InUse { port },
                _ => system(&error),
            })?;
        let port = listener.local_addr().map_err(|error| system(&error))?.port();
        let mut random = [0_u8; 16];
        getrandom::fill(&mut random).map_err(|error| system(&error))?;
        let token: String = random.iter().map(|byte| format!("{byte:02x}")).collect();
        let sources = format!("ws://127.0.0.1:{port} ws://localhost:{port}");
        let site = Arc::new(Site { session, page: page(&sources), token, port });
        let watching = Arc::new(AtomicUsize::new(0));
        let server = Self {
            address: format!("http://127.0.0.1:{port}/{}/", site.token),
            watching: Arc::clone(&watching),
        };
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (site, watching) = (Arc::clone(&site), Arc::clone(&watching));
                if watching.fetch_add(1, Ordering::SeqCst) >= MOST_CONNECTIONS {
                    watching.fetch_sub(1, Ordering::SeqCst);
                    let _ = stream.shutdown(Shutdown::Both);
                    continue;
                }
                thread::spawn(move || {
                    // A browser that goes away is no fault of ours.
                    let _ = site.answer(stream);
                    watching.fetch_sub(1, Ordering::SeqCst);
                });
            }
        });
        Ok(server)
    }

    /// Where the page is, with its token.
    #[must_use]
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Browsers that are connected.
    #[must_use]
    pub fn connections(&self) -> usize {
        self.watching.load(Ordering::SeqCst)
    }
}

/// What is wanted of a request.
struct Request {
    method: String,
    path: String,
    host: Option<String>,
    origin: Option<String>,
    key: Option<String>,
    /// What came after the head.
    rest: Vec<u8>,
}

impl Site {
    fn answer(&self, mut stream: TcpStream) -> io::Result<()> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.set_nodelay(true)?;
        let Some(request) = read_request(&mut stream)? else {
            return respond(&mut stream, "400 Bad Request", "text/plain", "this is no request");
        };
        if !self.is_ours(&request) {
            return respond(&mut stream, "403 Forbidden", "text/plain", FORBIDDEN);
        }
        let path = request.path.strip_prefix('/').and_then(|path| path.strip_prefix(self.token.as_str()));
        match (path, &request.key) {
            (Some("/socket"), Some(key)) => {
                let accept = derive_accept_key(key.as_bytes());
                let answer = format!(
                    "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
                     Sec-WebSocket-Accept: {accept}\r\n\r\n"
                );
                stream.write_all(answer.as_bytes())?;
                self.talk(stream, request.rest)
            }
            (Some("" | "/"), _) if request.method == "GET" => {
                respond(&mut stream, "200 OK", "text/html; charset=utf-8", &self.page)
            }
            (Some("" | "/"), _) if request.method == "HEAD" => {
                respond_head(&mut stream, "200 OK", "text/html; charset=utf-8", self.page.len())?;
                stream.flush()
            }
            _ => respond(&mut stream, "404 Not Found", "text/plain", "there is no such page"),
        }
    }

    /// The token, a host name that only this computer has (against names that others bind to it), and no
    /// other origin.
    fn is_ours(&self, request: &Request) -> bool {
        let Self { port, .. } = self;
        let names = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
        let host = request.host.as_ref().is_some_and(|host| names.contains(host));
        let origin = match &request.origin {
            Some(origin) => {
                origin.strip_prefix("http://").is_some_and(|name| names.iter().any(|own| own == name))
            }
            None => request.key.is_none(), // browsers always say it when they open a socket
        };
        let given = request.path.trim_start_matches('/').split('/').next().unwrap_or_default();
        // As long for a wrong one as for the right one.
        let differs = given.bytes().zip(self.token.bytes()).fold(0, |sum, (a, b)| sum | (a ^ b));
        host && origin && given.len() == self.token.len() && differs == 0
    }

    fn talk(&self, stream: TcpStream, rest: Vec<u8>) -> io::Result<()> {
        stream.set_read_timeout(Some(UPDATE_EVERY))?;
        let limits = WebSocketConfig::default().max_message_size(Some(1_024)).max_frame_size(Some(1_024));
        let mut socket = WebSocket::from_partially_read(stream, rest, Role::Server, Some(limits));
        let (mut cursor, mut next) = (Cursor::default(), Instant::now());
        loop {
            let now = Instant::now();
            if now >= next {
                // (one that was late does not make all that follow it later)
                next = (next + UPDATE_EVERY).max(now);
                let is_over = self.session.state().is_final();
                let update = self.session.update(&mut cursor).to_string();
                if socket.send(Message::text(update)).is_err() {
                    return Ok(());
                }
                if is_over {
                    let _ = socket.close(None);
                    let _ = socket.flush();
                    return Ok(());
                }
            }
            let wait = next.saturating_duration_since(now).max(Duration::from_millis(1));
            socket.get_ref().set_read_timeout(Some(wait))?;
            match socket.read() {
                Ok(Message::Text(name)) => {
                    if let Some(command) = Command::from_name(&name) {
                        self.session.command(command);
                    }
                }
                Ok(Message::Close(_)) => {
                    let _ = socket.flush();
                    return Ok(());
                }
                Ok(_) => {}
                Err(Error::Io(error))
                    if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {}
                Err(_) => return Ok(()),
            }
        }
    }
}

const FORBIDDEN: &str = "This page needs the whole address that plotter-replay printed, with its token.\n";

fn respond(stream: &mut TcpStream, status: &str, kind: &str, body: &str) -> io::Result<()> {
    respond_head(stream, status, kind, body.len())?;
    stream.write_all(body.as_bytes())?;
    stream.flush()
}

fn respond_head(stream: &mut TcpStream, status: &str, kind: &str, bytes: usize) -> io::Result<()> {
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {bytes}\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nX-Frame-Options: DENY\r\n\
         Connection: close\r\n\r\n"
    );
    stream.write_all(head.as_bytes())
}

/// The head of a request; `None` if it is none, or too long.
fn read_request(stream: &mut TcpStream) -> io::Result<Option<Request>> {
    let (mut bytes, mut part) = (Vec::new(), [0; 1_024]);
    let until = Instant::now() + PATIENCE;
    loop {
        let count = stream.read(&mut part)?;
        bytes.extend_from_slice(part.get(..count).unwrap_or_default());
        let mut headers = [httparse::EMPTY_HEADER; 64];
        let mut head = httparse::Request::new(&mut headers);
        match head.parse(&bytes) {
            Ok(httparse::Status::Complete(length)) => {
                let rest = bytes.get(length..).unwrap_or_default().to_vec();
                let value = |name: &str| {
                    let header = head.headers.iter().find(|header| header.name.eq_ignore_ascii_case(name))?;
                    String::from_utf8(header.value.to_vec()).ok()
                };
                let method = head.method.unwrap_or_default().to_owned();
                let path = head.path.unwrap_or_default().to_owned();
                let (host, origin) = (value("host"), value("origin"));
                let key = value("sec-websocket-key");
                return Ok(Some(Request { method, path, host, origin, key, rest }));
            }
            Ok(httparse::Status::Partial)
                if count > 0 && bytes.len() < MOST_HEAD_BYTES && Instant::now() < until => {}
            _ => return Ok(None),
        }
    }
}
