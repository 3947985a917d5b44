//! The gate at the machine: who calls has to prove that he has the key before Zenoh, which listens on a
//! socket of this host alone, gets a byte of him. In: connections. Out: those with a proof, carried to Zenoh;
//! the others are told why not.
//!
//! Those without a proof have [`STRANGERS`] places, each for [`PROVES`] and [`PROOF`](crate::proof::PROOF)
//! bytes. Somebody new pushes one of them out, so none of them holds up who has the key.

use std::{
    io::{Read as _, Write as _},
    net::{IpAddr, Shutdown, TcpListener, TcpStream},
    os::unix::net::UnixStream,
    path::{Path, PathBuf},
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering::Relaxed},
    },
    thread::Builder,
    time::Duration,
};

use process::ipc::time::{Moment, sleep_until};

use crate::{
    LinkError, joined,
    places::{Places, STRANGERS, goes},
    proof::{Known, Role, Secret, Stranger, VERDICT, Verdict, full},
    seal,
};

/// So long somebody may take for his proof.
const PROVES: Duration = Duration::from_secs(2);
/// So long nobody new is taken when the system has no files or no memory for him.
const NO_ROOM: Duration = Duration::from_millis(50);
/// The shortest time for which anything is waited for.
const SHORT_NAP: Duration = Duration::from_millis(1);

/// Somebody who has proved nothing.
struct Waiting {
    number: u64,
    from: IpAddr,
    stream: TcpStream,
}

/// All of them.
#[derive(Default)]
struct Strangers {
    waiting: Vec<Waiting>,
    /// Threads that hear them; of somebody who was pushed out it is about to end.
    threads: usize,
    /// How many there were.
    number: u64,
}

/// The gate.
pub struct Gate {
    secret: Secret,
    /// Where Zenoh listens.
    behind: PathBuf,
    places: Places,
    strangers: Mutex<Strangers>,
    fewer: Condvar,
    refused: AtomicU64,
}

impl Gate {
    /// Opens it: whoever has the key is carried to the socket `behind` it.
    ///
    /// # Errors
    /// The listener is not one, or there is no thread.
    pub fn open(listener: TcpListener, secret: Secret, behind: &Path) -> Result<Arc<Gate>, LinkError> {
        listener.local_addr().map_err(|error| LinkError::broken("the address", error))?;
        let gate = Arc::new(Gate {
            secret,
            behind: behind.to_owned(),
            places: Places::default(),
            strangers: Mutex::default(),
            fewer: Condvar::new(),
            refused: AtomicU64::new(0),
        });
        let this = Arc::clone(&gate);
        let accepts = move || {
            loop {
                match listener.accept() {
                    Ok((stream, from)) => this.comes(stream, from.ip()),
                    Err(_) => sleep_until(Moment::now().after(NO_ROOM)),
                }
            }
        };
        Builder::new()
            .name("gate".into())
            .spawn(accepts)
            .map_err(|error| LinkError::broken("a thread", error))?;
        Ok(gate)
    }

    /// How many have come without the key so far.
    pub fn refused(&self) -> u64 {
        self.refused.load(Relaxed)
    }

    fn strangers(&self) -> MutexGuard<'_, Strangers> {
        self.strangers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Somebody calls.
    fn comes(self: &Arc<Gate>, stream: TcpStream, from: IpAddr) {
        let Ok(number) = seal::nonce() else { return };
        let stranger = Stranger::new(number.to_le_bytes());
        // What is said to him finds room in his socket: nothing waits here.
        let said = stream.set_write_timeout(Some(NO_ROOM)).and_then(|()| {
            (&stream).write_all(&stranger.greeting())?;
            stream.try_clone()
        });
        let Ok(own) = said else { return };
        let mut strangers = self.strangers();
        if strangers.waiting.len() >= STRANGERS
            && let Some(goes) = goes(strangers.waiting.iter().map(|waiting| waiting.from))
        {
            let gone = strangers.waiting.remove(goes).stream;
            let _ = (&gone).write_all(&full());
            let _ = gone.shutdown(Shutdown::Both);
            self.refused.fetch_add(1, Relaxed);
        }
        // The thread of whoever was pushed out ends at once; if not, nobody else gets one.
        let many = |strangers: &mut Strangers| strangers.threads >= STRANGERS;
        let ended = self.fewer.wait_timeout_while(strangers, NO_ROOM, many);
        let (mut strangers, waited) = ended.unwrap_or_else(PoisonError::into_inner);
        if waited.timed_out() {
            return;
        }
        strangers.number += 1;
        let number = strangers.number;
        let this = Arc::clone(self);
        let hears = move || this.hears(number, stranger, stream);
        if Builder::new().name("stranger".into()).spawn(hears).is_ok() {
            strangers.threads += 1;
            strangers.waiting.push(Waiting { number, from, stream: own });
        }
    }

    /// Hears one of them, and lets him in or not.
    fn hears(&self, number: u64, mut stranger: Stranger, stream: TcpStream) {
        let known = self.proves(&mut stranger, &stream).unwrap_or(Known::NotYet);
        let at = {
            let mut strangers = self.strangers();
            let at = strangers.waiting.iter().position(|waiting| waiting.number == number);
            at.map(|at| strangers.waiting.remove(at))
        };
        // Who was pushed out has been told.
        match known {
            _ if at.is_none() => {}
            Known::Caller(role) => self.lets_in(role, &stranger, stream),
            Known::Stranger | Known::NotYet => {
                self.refused.fetch_add(1, Relaxed);
                self.tells(Verdict::OtherKey, &stranger, &stream);
            }
        }
        self.strangers().threads -= 1;
        self.fewer.notify_all();
    }

    /// Hears his proof; not all of it if he takes too long, or ends.
    fn proves(&self, stranger: &mut Stranger, mut stream: &TcpStream) -> std::io::Result<Known> {
        let deadline = Moment::now().after(PROVES);
        while !deadline.passed() {
            stream.set_read_timeout(Some(deadline.since(Moment::now()).max(SHORT_NAP)))?;
            let count = stream.read(stranger.room())?;
            if count == 0 {
                break;
            }
            match stranger.came(count, &self.secret) {
                Known::NotYet => {}
                known => return Ok(known),
            }
        }
        Ok(Known::NotYet)
    }

    fn tells(&self, verdict: Verdict, stranger: &Stranger, mut stream: &TcpStream) {
        let bytes: [u8; VERDICT] = stranger.verdict(verdict, &self.secret);
        // Who does not hear it is gone.
        let _ = stream.write_all(&bytes);
    }

    /// He has the key: he gets a place, if there is one of his kind.
    fn lets_in(&self, role: Role, stranger: &Stranger, stream: TcpStream) {
        let Some(place) = self.places.take(role) else {
            return self.tells(Verdict::Full, stranger, &stream);
        };
        // Without a way to Zenoh he calls again.
        let Ok(here) = UnixStream::connect(&self.behind) else { return };
        self.tells(Verdict::Welcome, stranger, &stream);
        let _ = joined::join(stream, here, move || drop(place));
    }
}
