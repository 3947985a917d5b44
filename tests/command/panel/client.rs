//! A client of the panel that trusts nothing: HTTP and WebSockets by hand, so that it can break their rules.

use std::{
    fs::File,
    io::{Read as _, Write as _},
    net::TcpStream,
    process::{Child, Stdio},
    time::Duration,
};

use serde_json::{Value, json};

use crate::shop::{Answer, Place, children, until};

/// Nothing that is waited for takes so long, s.
const PATIENCE_S: u64 = 60;

/// A launcher with a panel.
pub(super) struct Panel {
    pub(super) launcher: Child,
    /// `127.0.0.1:PORT`.
    pub(super) address: String,
    pub(super) token: String,
}

impl Drop for Panel {
    fn drop(&mut self) {
        let _ = self.launcher.kill();
        let _ = self.launcher.wait();
    }
}

/// Status and text of an answer; status 0 if there was none.
pub(super) type Told = (u16, String);

impl Panel {
    /// Gives a command line and waits until it says where its panel is.
    pub(super) fn start(place: &Place, arguments: &[&str]) -> Panel {
        let said = place.at("said.txt");
        let mut command = place.pitchlock();
        command.args(arguments).stdout(Stdio::piped()).stderr(File::create(&said).expect("a file"));
        let mut launcher = command.spawn().expect("it starts");
        let mut url = String::new();
        until("the panel is there", || {
            let text = std::fs::read_to_string(&said).expect("it was just made");
            let line = text.lines().find_map(|line| line.strip_prefix("panel: http://"));
            url = line.unwrap_or_default().to_owned();
            let ended = launcher.try_wait().expect("it was started here");
            assert!(ended.is_none() || !url.is_empty(), "{ended:?}: {text}");
            url.len() > 80
        });
        let (address, token) = url.split_once("/#").expect("an address with a secret");
        Panel { launcher, address: address.into(), token: token.into() }
    }

    /// Waits for its end; what it said is in `said.txt`.
    pub(super) fn ends(mut self) -> Answer {
        let mut stdout = String::new();
        self.launcher.stdout.take().expect("it is piped").read_to_string(&mut stdout).expect("UTF-8");
        let status = self.launcher.wait().expect("it was started here").code();
        Answer { status, stdout, stderr: String::new() }
    }

    /// The number of the process that serves the panel.
    pub(super) fn server(&self) -> Option<u32> {
        let found = children(&self.launcher).into_iter().find(|(name, _)| name == "panel-server");
        found.map(|(_, pid)| pid)
    }

    pub(super) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.address).expect("somebody listens");
        stream.set_read_timeout(Some(Duration::from_secs(PATIENCE_S))).expect("a time");
        stream
    }

    /// Sends these bytes and reads to the end.
    pub(super) fn raw(&self, bytes: &[u8]) -> Told {
        let mut stream = self.connect();
        // Whoever refuses early does not read the rest.
        let _ = stream.write_all(bytes);
        answer_of(&mut stream)
    }

    /// A request with the right Host and the token, and these headers more.
    pub(super) fn request(&self, line: &str, headers: &str, body: &str) -> Told {
        let token = format!("Authorization: Bearer {}\r\n", self.token);
        self.bare(line, &(token + headers), body)
    }

    /// The same without the token.
    pub(super) fn bare(&self, line: &str, headers: &str, body: &str) -> Told {
        let head = format!("{line} HTTP/1.1\r\nHost: {}\r\n{headers}", self.address);
        self.raw(format!("{head}Content-Length: {}\r\n\r\n{body}", body.len()).as_bytes())
    }

    /// The bytes of a file that it makes.
    pub(super) fn file(&self, path: &str) -> Vec<u8> {
        let (host, token) = (&self.address, &self.token);
        let head = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {token}\r\n\r\n");
        let mut stream = self.connect();
        stream.write_all(head.as_bytes()).expect("it is taken");
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).expect("an answer");
        assert!(bytes.starts_with(b"HTTP/1.1 200 "), "{path}: {}", String::from_utf8_lossy(&bytes));
        let body = bytes.windows(4).position(|four| four == b"\r\n\r\n").expect("a head") + 4;
        bytes.split_off(body)
    }

    /// All that is seen.
    pub(super) fn state(&self) -> Value {
        let (status, text) = self.request("GET /api/state", "", "");
        assert_eq!(status, 200, "{text}");
        serde_json::from_str(&text).expect("a document")
    }

    /// Asks for something; the answer is a document.
    pub(super) fn ask(&self, document: &Value) -> Value {
        let kind = "Content-Type: application/json\r\n";
        let (status, text) = self.request("POST /api/do", kind, &document.to_string());
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{document}: {status} {text}: {error}"))
    }

    /// Presses without a value, and says in which cycle that was.
    pub(super) fn press(&self, word: &str) -> u64 {
        self.pressed(&json!({ "id": 1, "do": word, "as": "test" }))
    }

    /// The same with a value.
    pub(super) fn turn(&self, word: &str, value: impl Into<Value>) -> u64 {
        self.pressed(&json!({ "id": 1, "do": word, "as": "test", "value": value.into() }))
    }

    /// The cycle of a press, as long as the run goes on.
    pub(super) fn pressed_in_time(&self, word: &str, value: Option<Value>) -> Option<u64> {
        let document = match value {
            Some(value) => json!({ "id": 1, "do": word, "as": "test", "value": value }),
            None => json!({ "id": 1, "do": word, "as": "test" }),
        };
        // When the run is over there is no panel any more.
        let stream = TcpStream::connect(&self.address).ok()?;
        stream.set_read_timeout(Some(Duration::from_secs(PATIENCE_S))).ok()?;
        let kind = "Content-Type: application/json\r\n";
        let token = format!("Authorization: Bearer {}\r\n{kind}", self.token);
        let (host, body) = (&self.address, document.to_string());
        let head =
            format!("POST /api/do HTTP/1.1\r\nHost: {host}\r\n{token}Content-Length: {}\r\n\r\n", body.len());
        let mut stream = stream;
        stream.write_all((head + &body).as_bytes()).ok()?;
        let (_, text) = answer_of(&mut stream);
        let answer: Value = serde_json::from_str(&text).ok()?;
        let refused = answer["refused"].as_str();
        assert!(
            refused.is_none_or(|code| ["not-running", "no-answer"].contains(&code)),
            "{document}: {answer}"
        );
        answer["cycle"].as_u64()
    }

    fn pressed(&self, document: &Value) -> u64 {
        let answer = self.ask(document);
        answer["cycle"].as_u64().unwrap_or_else(|| panic!("{document}: {answer}"))
    }

    /// Whether it does what it should.
    pub(super) fn is_well(&self) {
        assert_eq!(self.bare("GET /", "", "").0, 200);
        assert_eq!(self.state()["seat"], Value::Null);
    }

    /// A WebSocket with these headers, and what was said to it.
    pub(super) fn upgrade(&self, headers: &str) -> (Socket, Told) {
        upgraded(self.connect(), "/api/live", headers)
    }

    /// A WebSocket as the page opens it.
    pub(super) fn socket(&self) -> Socket {
        let protocols = format!("Sec-WebSocket-Protocol: pitchlock.panel.1, token.{}", self.token);
        let origin = format!("Origin: http://{}", self.address);
        let (socket, (status, text)) =
            self.upgrade(&format!("Host: {}\r\n{origin}\r\n{protocols}\r\n", self.address));
        assert_eq!(status, 101, "{text}");
        assert!(text.contains("sec-websocket-protocol: pitchlock.panel.1\r\n"), "{text}");
        socket
    }
}

fn upgraded(mut stream: TcpStream, path: &str, headers: &str) -> (Socket, Told) {
    let head = format!(
        "GET {path} HTTP/1.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{headers}\r\n"
    );
    stream.write_all(head.as_bytes()).expect("it is taken");
    let mut head = Vec::new();
    while !head.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        if stream.read(&mut byte).expect("an answer") == 0 {
            break;
        }
        head.push(byte[0]);
    }
    let text = String::from_utf8_lossy(&head).into_owned();
    let status = text.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
    (Socket(stream), (status, text))
}

fn answer_of(stream: &mut TcpStream) -> Told {
    let mut bytes = Vec::new();
    // One that is cut off after its answer has been read as far as it came.
    let _ = stream.read_to_end(&mut bytes);
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let status = text.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
    let body = text.split_once("\r\n\r\n").map_or("", |(_, body)| body);
    (status, body.to_owned())
}

/// One WebSocket.
pub(super) struct Socket(pub(super) TcpStream);

impl Socket {
    /// One of somebody else than a panel.
    pub(super) fn open(address: &str, path: &str) -> Socket {
        let stream = TcpStream::connect(address).expect("somebody listens");
        stream.set_read_timeout(Some(Duration::from_secs(PATIENCE_S))).expect("a time");
        let (socket, (status, text)) = upgraded(stream, path, &format!("Host: {address}\r\n"));
        assert_eq!(status, 101, "{text}");
        socket
    }

    /// A frame with this first byte, masked by 0 0 0 0.
    pub(super) fn frame(&mut self, first: u8, payload: &[u8]) {
        let mut frame = vec![first];
        match payload.len() {
            short @ 0..126 => frame.push(0x80 | short as u8),
            long => {
                frame.push(0x80 | 127);
                frame.extend((long as u64).to_be_bytes());
            }
        }
        frame.extend([0; 4]);
        frame.extend(payload);
        // One that is closed takes nothing any more, which is seen when it is read.
        let _ = self.0.write_all(&frame);
    }

    pub(super) fn say(&mut self, document: &Value) {
        self.frame(0x81, document.to_string().as_bytes());
    }

    /// The next text; nothing if the socket was closed.
    pub(super) fn next(&mut self) -> Option<Value> {
        match self.message()? {
            (1, payload) => Some(serde_json::from_slice(&payload).expect("a document")),
            (8, _) => None,
            _ => self.next(),
        }
    }

    /// The document of the next picture of the scope, if that is what comes next.
    pub(super) fn picture(&mut self) -> Option<Value> {
        let (kind, payload) = self.message()?;
        let (length, rest) = payload.split_first_chunk().filter(|_| kind == 2)?;
        let head = &rest[..u32::from_le_bytes(*length) as usize];
        Some(serde_json::from_slice(head).expect("a document"))
    }

    /// Kind and content of the next message.
    fn message(&mut self) -> Option<(u8, Vec<u8>)> {
        let mut head = [0; 2];
        self.0.read_exact(&mut head).ok()?;
        let length = match head[1] & 127 {
            126 => self.number::<2>()?,
            127 => self.number::<8>()?,
            short => u64::from(short),
        };
        let mut payload = vec![0; length as usize];
        self.0.read_exact(&mut payload).ok()?;
        Some((head[0] & 15, payload))
    }

    fn number<const N: usize>(&mut self) -> Option<u64> {
        let mut bytes = [0; N];
        self.0.read_exact(&mut bytes).ok()?;
        Some(bytes.iter().fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }

    /// The answer with this number, whatever comes before it.
    pub(super) fn answer(&mut self, id: &Value) -> Option<Value> {
        loop {
            let news = self.next()?;
            if news.get("id") == Some(id) {
                return Some(news);
            }
        }
    }

    /// Reads until it is closed.
    pub(super) fn is_closed(&mut self) -> bool {
        while self.next().is_some() {}
        true
    }
}
