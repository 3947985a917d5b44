//! A socket of this host, carried to the other one. In: bytes that are read here, and those that come. Out:
//! messages, and bytes that are written here. Two threads wait for the socket, so nobody else does, and no
//! more than [`WINDOW`] bytes are on the way that the other host has not taken: what stands behind a reader
//! that stands is the socket here, and whoever writes into it sees that.

use std::{
    io::{Read as _, Write as _},
    net::Shutdown,
    os::unix::net::UnixStream,
    sync::{
        Arc, Condvar, Mutex, PoisonError,
        mpsc::{SyncSender, sync_channel},
    },
    thread::Builder,
};

use crate::{LinkError, message::Message, session::Voice};

/// Most bytes on the way: as many as wire and system keep for a cable that is pulled for a moment.
const WINDOW: usize = 64 << 10;
/// Most bytes that are read at once.
const BLOCK: usize = 16 << 10;
/// Most messages that wait to be written here. Whoever keeps to the window never has so many.
const MOST_WAITING: usize = 4096;

/// How many bytes may still go on their way; `None` when none ever will.
type Room = Arc<(Mutex<Option<usize>>, Condvar)>;

/// The end of it at this host. It goes with this.
pub struct Pipe {
    number: u32,
    socket: UnixStream,
    out: SyncSender<Vec<u8>>,
    room: Room,
}

/// Waits until bytes may go on their way; how many.
fn waits(room: &Room) -> Option<usize> {
    let guard = room.0.lock().unwrap_or_else(PoisonError::into_inner);
    *room.1.wait_while(guard, |room| *room == Some(0)).unwrap_or_else(PoisonError::into_inner)
}

/// There is more room, or less.
fn changes(room: &Room, change: impl FnOnce(usize) -> Option<usize>) {
    let mut guard = room.0.lock().unwrap_or_else(PoisonError::into_inner);
    *guard = guard.and_then(change);
    room.1.notify_all();
}

impl Pipe {
    /// Carries a socket under this number. `ended` is called when nothing more will be read.
    ///
    /// # Errors
    /// The system has no thread for it.
    pub fn new(
        number: u32,
        socket: UnixStream,
        voice: &Voice,
        ended: impl FnOnce() + Send + 'static,
    ) -> Result<Pipe, LinkError> {
        let wrong = |error: std::io::Error| LinkError::broken("a socket of the panel", error);
        let room: Room = Arc::new((Mutex::new(Some(WINDOW)), Condvar::new()));
        let (mut reads, mut writes) =
            (socket.try_clone().map_err(wrong)?, socket.try_clone().map_err(wrong)?);
        let (up, has) = (voice.clone(), Arc::clone(&room));
        let out = move || {
            let mut block = vec![0; BLOCK];
            while let Some(most) = waits(&has) {
                let Ok(read @ 1..) = reads.read(&mut block[..most.min(BLOCK)]) else { break };
                changes(&has, |room| room.checked_sub(read));
                if up.say(&Message::Bytes(number, block[..read].to_vec())).is_err() {
                    break;
                }
            }
            ended();
        };
        Builder::new().name("panel-out".into()).spawn(out).map_err(wrong)?;
        let (sender, waiting) = sync_channel::<Vec<u8>>(MOST_WAITING);
        let back = voice.clone();
        let inwards = move || {
            for bytes in waiting {
                let took = Message::Took(number, bytes.len() as u32);
                if writes.write_all(&bytes).is_err() || back.say(&took).is_err() {
                    break;
                }
            }
        };
        Builder::new().name("panel-in".into()).spawn(inwards).map_err(wrong)?;
        Ok(Pipe { number, socket, out: sender, room })
    }

    /// Its number.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Bytes are to be written here. False if they are more than the other host may send.
    pub fn put(&self, bytes: Vec<u8>) -> bool {
        self.out.try_send(bytes).is_ok()
    }

    /// The other host has taken so many.
    pub fn took(&self, count: u32) {
        changes(&self.room, |room| Some(room.saturating_add(count as usize).min(WINDOW)));
    }
}

impl Drop for Pipe {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = self.socket.shutdown(Shutdown::Both);
        changes(&self.room, |_| None);
    }
}
