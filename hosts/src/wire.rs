//! The wire: Zenoh between two hosts, behind the gate of one of them. In: bytes to send. Out: bytes that
//! came, and lines of whoever started this process; the member that carries them is woken.
//!
//! Multicast and gossip are off, so nobody is looked for and nobody is told of us. Zenoh speaks to a socket
//! in a folder of this user alone; what is on the network is a connection that the gate has let in. What is
//! sent waits for a place instead of being dropped (Zenoh drops by default), goes before anything else, and
//! is not kept back to fill a packet. What goes up goes to one host alone: whoever calls has a name there.

use std::{
    fs::{self, DirBuilder},
    io::{BufRead as _, BufReader},
    net::{TcpListener, TcpStream},
    os::unix::{
        fs::DirBuilderExt as _,
        net::{SocketAddr, UnixListener, UnixStream},
    },
    path::{Path, PathBuf},
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed},
        mpsc::{Receiver, Sender, channel},
    },
    time::Duration,
};

use process::ipc::Doorbell;
use zenoh::{
    Wait as _,
    qos::{CongestionControl, Priority},
};

use crate::{
    LinkError,
    gate::Gate,
    joined, message,
    places::{HALLS, OPERATORS},
    seal::{self, Key, Level, Nonce},
    session::SILENCE,
    talk,
};

/// Most bytes of a message: a summary of many passes is the longest.
const MOST: usize = message::FILE;
/// Bytes that may wait to be looked at. What comes beyond that is lost, and a session ends by that; what
/// whoever started this process says is never.
const WAITING: usize = MOST + (8 << 20);
/// What a message that waits takes beside its bytes, at most.
const AROUND: usize = 128;
/// Who has not taken anything for so long is given up by the machine: whoever has a run waits for him. What
/// goes up to that one is little, and finds room while his cable is pulled.
const RUDE: Duration = Duration::from_secs(1);
/// Connections at once: all that the gate lets in, and room for those that are about to go.
const CONNECTIONS: usize = HALLS + OPERATORS + 8;
/// The name of the socket at which Zenoh listens; no file that comes has one like it.
const BEHIND: &str = ".link";

/// What goes down to the machine.
const DOWN: &str = "pitchlock/link/1/down";

/// What goes up to whoever has this name.
fn up(name: Nonce) -> String {
    format!("pitchlock/link/1/up/{name:032x}")
}

/// Something that has happened.
#[derive(Debug)]
pub enum Event {
    /// Bytes have come from the other host, or from anybody.
    Frame(Vec<u8>),
    /// A line of whoever started this process.
    Line(String),
    /// That one is gone, or wants nothing more.
    Closed,
    /// Nothing more will be read of the socket with this number.
    Shut(u32),
    /// The connection to the machine has ended.
    Gone,
}

impl Event {
    /// Bytes that it has while it waits; what is no frame does not count.
    fn bytes(&self) -> usize {
        if let Event::Frame(bytes) = self { bytes.len() + AROUND } else { 0 }
    }
}

/// Where events come from: they are queued, and who carries them is woken.
#[derive(Clone)]
struct Source {
    events: Sender<Event>,
    /// Bytes that wait.
    waiting: Arc<AtomicUsize>,
    bell: Arc<OnceLock<Doorbell>>,
}

impl Source {
    fn happened(&self, event: Event) {
        let bytes = event.bytes();
        if self.waiting.fetch_add(bytes, Relaxed) + bytes > WAITING && bytes > 0 {
            // The count of messages tells.
            self.waiting.fetch_sub(bytes, Relaxed);
            return;
        }
        // Who does not listen any more wants nothing more.
        let _ = self.events.send(event);
        if let Some(bell) = self.bell.get() {
            // Who cannot be woken looks by himself.
            let _ = bell.ring();
        }
    }
}

/// The end of the wire at this host.
pub struct Wire {
    events: Receiver<Event>,
    source: Source,
    session: Option<zenoh::Session>,
    /// The gate in front of it, at the machine.
    gate: Option<Arc<Gate>>,
    /// The connection has ended, where this host calls.
    gone: Arc<AtomicBool>,
    /// By which this host is called, where it calls.
    pub name: Nonce,
}

/// What speaks on it, to one host.
#[derive(Clone)]
pub struct Mouth {
    session: Option<zenoh::Session>,
    way: String,
    congestion: CongestionControl,
}

impl Mouth {
    /// Sends bytes.
    ///
    /// # Errors
    /// What Zenoh says.
    pub fn say(&self, bytes: Vec<u8>) -> Result<(), LinkError> {
        let Some(session) = &self.session else { return Ok(()) };
        let put = session.put(self.way.as_str(), bytes).congestion_control(self.congestion);
        let sent = put.priority(Priority::RealTime).express(true).wait();
        sent.map_err(|error| LinkError::broken("sending", error))
    }

    /// One that does not wait for whoever does not read: what finds no place is lost.
    #[must_use]
    pub fn that_does_not_wait(self) -> Mouth {
        Mouth { congestion: CongestionControl::Drop, ..self }
    }
}

/// What gives mouths to whoever calls.
#[derive(Clone)]
pub struct Mouths(Option<zenoh::Session>);

impl Mouths {
    /// One to whoever calls by this name.
    pub fn to(&self, name: Nonce) -> Mouth {
        Mouth { session: self.0.clone(), way: up(name), congestion: CongestionControl::Block }
    }
}

/// A socket of this host that leads to the other one.
pub struct Way {
    /// A folder of this user alone.
    folder: PathBuf,
    listener: UnixListener,
    /// Where it is.
    pub path: PathBuf,
}

impl Drop for Way {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl Way {
    /// Makes it. It goes as soon as Zenoh has come by it.
    ///
    /// # Errors
    /// There is no room for it.
    pub fn make() -> Result<Way, LinkError> {
        let folder = std::env::temp_dir().join(format!("pitchlock-way-{:016x}", seal::nonce()? as u64));
        let wrong = |error: std::io::Error| {
            LinkError::file(&folder, format!("{error}\nhelp: TMPDIR names another folder, with a short name"))
        };
        DirBuilder::new().mode(0o700).create(&folder).map_err(wrong)?;
        let path = folder.join(BEHIND);
        let listener =
            UnixListener::bind(&path).inspect_err(|_| drop(fs::remove_dir(&folder))).map_err(wrong)?;
        Ok(Way { folder, listener, path })
    }

    /// Carries whoever comes by it over this connection. `ended` is called when that has ended.
    ///
    /// # Errors
    /// There is no thread for it.
    pub fn leads(self, net: TcpStream, ended: impl FnOnce() + Send + 'static) -> Result<(), LinkError> {
        let leads = move || {
            if let Ok((here, _)) = self.listener.accept() {
                // Without it nobody answers, which is said.
                let _ = joined::join(net, here, ended);
            }
        };
        let thread = std::thread::Builder::new().name("way".into()).spawn(leads);
        thread.map(drop).map_err(|error| LinkError::broken("a thread", error))
    }
}

/// Zenoh as it is wanted here, at a socket.
fn config(at: Level, socket: &Path) -> Result<zenoh::Config, LinkError> {
    let mut config = zenoh::Config::default();
    let here = format!("[\"unixsock-stream/{}\"]", socket.display());
    let (listen, connect, patience) = match at {
        Level::Lower => (here.as_str(), "[]", RUDE),
        Level::Upper => ("[]", here.as_str(), SILENCE),
    };
    let retry = "{ period_init_ms: 50, period_max_ms: 200, period_increase_factor: 2 }";
    let (most, connections, patience) =
        ((MOST + 1024).to_string(), CONNECTIONS.to_string(), patience.as_micros().to_string());
    for (key, value) in [
        ("transport/link/rx/max_message_size", most.as_str()),
        ("transport/unicast/max_sessions", &connections),
        // Who has not taken anything for so long is given up: nobody waits for longer to say something.
        ("transport/link/tx/queue/congestion_control/block/wait_before_close", &patience),
        ("mode", "\"peer\""),
        ("listen/endpoints", listen),
        ("connect/endpoints", connect),
        ("connect/retry", retry),
        ("listen/exit_on_failure", "true"),
        ("listen/timeout_ms", "5000"),
        ("listen/retry", retry),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
    ] {
        config.insert_json5(key, value).map_err(|error| LinkError::broken(key, error))?;
    }
    Ok(config)
}

impl Wire {
    fn new() -> Result<Wire, LinkError> {
        let (sender, events) = channel();
        let source = Source { events: sender, waiting: Arc::default(), bell: Arc::default() };
        let gone = Arc::default();
        Ok(Wire { events, source, session: None, gate: None, gone, name: seal::nonce()? })
    }

    /// The end at the machine: whoever calls at this address and has the key is let in. Zenoh's socket lies
    /// in a folder of this user alone.
    ///
    /// # Errors
    /// The address is not one, or Zenoh cannot be had.
    pub fn behind_a_gate(listener: TcpListener, key: &Key, folder: &Path) -> Result<Wire, LinkError> {
        let mut wire = Wire::new()?;
        let behind = folder.join(BEHIND);
        // Zenoh would try for some seconds, and not say why.
        SocketAddr::from_pathname(&behind).map_err(|_| {
            LinkError::file(
                folder,
                "the name of the folder for temporary files is too long: set TMPDIR to a folder such as /tmp",
            )
        })?;
        wire.speaks(Level::Lower, &behind)?;
        wire.gate = Some(Gate::open(listener, key.gate(), &behind)?);
        Ok(wire)
    }

    /// The end of whoever calls, who has not called yet.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn that_calls() -> Result<Wire, LinkError> {
        Wire::new()
    }

    /// Speaks over this connection from here on.
    ///
    /// # Errors
    /// There is no socket for it, or Zenoh cannot be had.
    pub fn over(&mut self, net: TcpStream) -> Result<(), LinkError> {
        let (way, source, gone) = (Way::make()?, self.source.clone(), Arc::new(AtomicBool::new(false)));
        let path = way.path.clone();
        self.gone = Arc::clone(&gone);
        way.leads(net, move || {
            gone.store(true, Relaxed);
            source.happened(Event::Gone);
        })?;
        self.speaks(Level::Upper, &path)
    }

    /// Whether there is a connection. What is left of one that has ended is given up.
    pub fn is_there(&mut self) -> bool {
        if self.gone.load(Relaxed) {
            self.session = None;
        }
        self.session.is_some()
    }

    fn speaks(&mut self, at: Level, socket: &Path) -> Result<(), LinkError> {
        let wrong = |error: zenoh::Error| LinkError::file(socket, error);
        let session = zenoh::open(config(at, socket)?).wait().map_err(wrong)?;
        let here = if at == Level::Upper { up(self.name) } else { DOWN.to_owned() };
        let heard = self.source.clone();
        let subscriber = session.declare_subscriber(here).callback(move |sample| {
            if sample.payload().len() <= MOST {
                heard.happened(Event::Frame(sample.payload().to_bytes().into_owned()));
            }
        });
        subscriber.background().wait().map_err(wrong)?;
        self.session = Some(session);
        Ok(())
    }

    /// How many have come to the gate without the key.
    pub fn refused(&self) -> u64 {
        self.gate.as_ref().map_or(0, |gate| gate.refused())
    }

    /// What speaks to the machine.
    pub fn mouth(&self) -> Mouth {
        Mouth { session: self.session.clone(), way: DOWN.to_owned(), congestion: CongestionControl::Block }
    }

    /// What speaks to whoever calls.
    pub fn mouths(&self) -> Mouths {
        Mouths(self.session.clone())
    }

    /// Tells that nothing more will be read of the socket with this number.
    pub fn shuts(&self, number: u32) -> impl FnOnce() + Send + 'static {
        let source = self.source.clone();
        move || source.happened(Event::Shut(number))
    }

    /// Listens to whoever started this process, too.
    ///
    /// # Errors
    /// There is nobody, or no thread for it.
    pub fn hear_the_parent(&self) -> Result<(), LinkError> {
        self.hear(talk::hear()?)
    }

    /// The same, and what it has said first was read.
    ///
    /// # Errors
    /// There is no thread for it.
    pub fn hear(&self, parent: BufReader<&'static UnixStream>) -> Result<(), LinkError> {
        let source = self.source.clone();
        let hear = move || {
            for line in parent.lines().map_while(Result::ok) {
                source.happened(Event::Line(line));
            }
            source.happened(Event::Closed);
        };
        let thread = std::thread::Builder::new().name("parent".into()).spawn(hear);
        thread.map(drop).map_err(|error| LinkError::broken("a thread", error))
    }

    /// From here on, events wake this member.
    pub fn wakes(&self, bell: Doorbell) {
        // A wire is carried by one member.
        let _ = self.source.bell.set(bell);
    }

    /// The oldest event that waits, if any.
    pub fn look(&self) -> Option<Event> {
        self.events.try_recv().ok().inspect(|event| self.taken(event))
    }

    /// The same, and waits so long for one.
    pub fn wait(&self, most: Duration) -> Option<Event> {
        self.events.recv_timeout(most).ok().inspect(|event| self.taken(event))
    }

    fn taken(&self, event: &Event) {
        self.source.waiting.fetch_sub(event.bytes(), Relaxed);
    }
}
