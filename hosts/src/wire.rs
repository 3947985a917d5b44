//! The wire: Zenoh between two hosts, at an address that is named. In: bytes to send. Out: bytes that came,
//! and lines of whoever started this process; the member that carries them is woken.
//!
//! Multicast and gossip are off, so nobody is looked for and nobody is told of us. What is sent waits for a
//! place instead of being dropped (Zenoh drops by default), goes before anything else, and is not kept back
//! to fill a packet.

use std::{
    io::BufRead as _,
    sync::{
        Arc, OnceLock,
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    time::Duration,
};

use process::ipc::Doorbell;
use zenoh::{
    Wait as _,
    qos::{CongestionControl, Priority},
};

use crate::{LinkError, message, seal::Level};

/// What may wait to be looked at. What comes beyond that is lost, and a session ends by that.
const WAITING: usize = 4096;
/// Most bytes of a message: a file with its name, and what is around it.
const MOST: usize = message::FILE + 1024;

/// What crosses the wire in one direction.
fn way(from: Level) -> &'static str {
    match from {
        Level::Upper => "pitchlock/link/1/down",
        Level::Lower => "pitchlock/link/1/up",
    }
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
}

/// Where events come from: they are queued, and who carries them is woken.
#[derive(Clone)]
struct Source {
    events: SyncSender<Event>,
    bell: Arc<OnceLock<Doorbell>>,
}

impl Source {
    fn happened(&self, event: Event) {
        // A queue that is full loses it; the count of messages tells.
        let _ = self.events.try_send(event);
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
    mouth: Mouth,
    _session: zenoh::Session,
}

/// What speaks on it.
#[derive(Clone)]
pub struct Mouth(Arc<zenoh::pubsub::Publisher<'static>>);

impl Mouth {
    /// Sends bytes.
    ///
    /// # Errors
    /// What Zenoh says.
    pub fn say(&self, bytes: Vec<u8>) -> Result<(), LinkError> {
        self.0.put(bytes).wait().map_err(|error| LinkError::broken("sending", error))
    }
}

/// Zenoh as it is wanted here.
fn config(at: Level, address: &str) -> Result<zenoh::Config, LinkError> {
    let mut config = zenoh::Config::default();
    let here = format!("[\"tcp/{address}\"]");
    let (listen, connect) = match at {
        Level::Lower => (here.as_str(), "[]"),
        Level::Upper => ("[]", here.as_str()),
    };
    let retry = "{ period_init_ms: 50, period_max_ms: 200, period_increase_factor: 2 }";
    for (key, value) in [
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
    /// Opens it: the lower level listens at an address, the upper one calls it, again and again.
    ///
    /// # Errors
    /// The address cannot be had.
    pub fn open(at: Level, address: &str) -> Result<Wire, LinkError> {
        let wrong = |error: zenoh::Error| LinkError::Input(format!("{address}: {error}"));
        let session = zenoh::open(config(at, address)?).wait().map_err(wrong)?;
        let (sender, events) = sync_channel(WAITING);
        let source = Source { events: sender, bell: Arc::default() };
        let (out, back) = match at {
            Level::Upper => (way(Level::Upper), way(Level::Lower)),
            Level::Lower => (way(Level::Lower), way(Level::Upper)),
        };
        let publisher = session.declare_publisher(out);
        let publisher =
            publisher.congestion_control(CongestionControl::Block).priority(Priority::RealTime).express(true);
        let publisher = publisher.wait().map_err(wrong)?;
        let heard = source.clone();
        let subscriber = session.declare_subscriber(back).callback(move |sample| {
            if sample.payload().len() <= MOST {
                heard.happened(Event::Frame(sample.payload().to_bytes().into_owned()));
            }
        });
        subscriber.background().wait().map_err(wrong)?;
        Ok(Wire { events, source, mouth: Mouth(Arc::new(publisher)), _session: session })
    }

    /// What speaks on it.
    pub fn mouth(&self) -> Mouth {
        self.mouth.clone()
    }

    /// Listens to whoever started this process, too: to lines on standard input.
    ///
    /// # Errors
    /// There is no thread for it.
    pub fn hear_the_parent(&self) -> Result<(), LinkError> {
        let source = self.source.clone();
        let hear = move || {
            for line in std::io::stdin().lock().lines().map_while(Result::ok) {
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
        self.events.try_recv().ok()
    }

    /// The same, and waits so long for one.
    pub fn wait(&self, most: Duration) -> Option<Event> {
        self.events.recv_timeout(most).ok()
    }
}
