//! Bells: how the processes of a machine wake each other. Every one has its own, which everybody may ring and
//! only that process hears; they lie side by side in the shared memory of the name space.
//!
//! A ring carries a number, which is noted before the listener is woken and stays until the listener takes
//! it: nothing that is told is ever lost, several rings may be taken as one, and one may come for nothing.
//!
//! ```text
//! ring:   told |= 1 << what;  rung += 1;  asleep?  wake whoever sleeps on `rung`
//! sleep:  read rung;  asleep = 1;  told = 0?  sleep while `rung` is what was read;  asleep = 0
//! ```
//! No ring falls between the steps of a sleep: either the ring sees `asleep`, and then it wakes, or changes
//! `rung` before the sleep begins; or the listener sees what was told. Every step is in one order for all
//! (`SeqCst`). It takes a system call to fall asleep and one to wake who sleeps (futex(2)), none to ring for
//! who is awake, and none to look.

use std::{
    sync::{Arc, atomic::Ordering::SeqCst},
    time::Duration,
};

use iceoryx2::prelude::{SemanticString, ZeroCopySend};
use iceoryx2_bb_concurrency::atomic::{AtomicU32, AtomicU64};
use iceoryx2_bb_posix::access_mode::AccessMode;
use iceoryx2_bb_system_types::file_name::FileName;
use iceoryx2_cal::{
    dynamic_storage::{
        DynamicStorage as _, DynamicStorageBuilder as _,
        posix_shared_memory::{Builder, Configuration, Storage},
    },
    named_concept::{NamedConceptBuilder as _, NamedConceptConfiguration as _},
};
use rustix::{
    io::Errno,
    thread::futex::{self, Flags},
    time::Timespec,
};

use super::{IpcError, Process, folder::Folder, wake::DATA};

/// Everybody's, and the roll call.
const COUNT: usize = Process::COUNT + 1;
const _: () = assert!(super::wake::NUMBERS <= u64::BITS as usize, "a bit for each number");
/// The name of all of them.
const NAME: &str = "bells";

/// One bell. It has a line of the processor's cache to itself.
#[derive(Debug, Default, ZeroCopySend)]
#[type_name("pitchlock/bell/1")]
#[repr(C)]
#[repr(align(64))]
struct Bell {
    /// What has been told since it was last taken, one bit for each number.
    told: AtomicU64,
    /// How often it was rung, modulo 2³².
    rung: AtomicU32,
    /// 1 while its listener sleeps, or is about to.
    asleep: AtomicU32,
    /// 1 when it has a listener.
    heard: AtomicU32,
}

/// All bells of a name space.
#[derive(Clone, Debug)]
pub(crate) struct Bells(Arc<Storage<[Bell; COUNT]>>);

impl Bells {
    /// The owner's part: they exist before anybody rings.
    pub(crate) fn create(folder: &Folder) -> Result<Bells, IpcError> {
        let (name, configuration) = place(folder)?;
        let storage =
            Builder::new(&name).config(&configuration).has_ownership(true).initializer(|bells, _| {
                bells.write(Default::default());
                true
            });
        Ok(Bells(Arc::new(storage.create().map_err(|error| IpcError::bus(NAME, error))?)))
    }

    /// Opens those that the owner made.
    pub(crate) fn open(folder: &Folder) -> Result<Bells, IpcError> {
        let (name, configuration) = place(folder)?;
        let storage = Builder::new(&name).config(&configuration).has_ownership(false);
        let storage = storage.open(AccessMode::ReadWrite);
        Ok(Bells(Arc::new(storage.map_err(|error| IpcError::bus(NAME, error))?)))
    }

    /// That of a process.
    pub(crate) fn of(&self, process: Process) -> BellOf {
        BellOf { bells: self.clone(), number: process.number() }
    }

    /// That on which members answer the owner.
    pub(crate) fn roll_call(&self) -> BellOf {
        BellOf { bells: self.clone(), number: Process::COUNT }
    }
}

/// Where they are, which every process of the name space knows.
fn place(folder: &Folder) -> Result<(FileName, Configuration<[Bell; COUNT]>), IpcError> {
    let name = |text: &str| {
        FileName::new(text.as_bytes()).map_err(|error| IpcError::bus(NAME, format!("{error:?}")))
    };
    Ok((name(NAME)?, Configuration::default().prefix(&name(&folder.prefix())?)))
}

/// One of the bells.
#[derive(Clone, Debug)]
pub(crate) struct BellOf {
    bells: Bells,
    number: usize,
}

impl BellOf {
    fn bell(&self) -> &Bell {
        &self.bells.0.get()[self.number]
    }

    /// From here on it has a listener. False if it has one already: two would take from each other.
    pub(crate) fn is_listened_to(&self) -> bool {
        self.bell().heard.swap(1, SeqCst) == 0
    }

    /// Its listener leaves. One that was killed does not.
    pub(crate) fn is_left(&self) {
        self.bell().heard.store(0, SeqCst);
    }

    pub(crate) fn has_listener(&self) -> bool {
        self.bell().heard.load(SeqCst) == 1
    }

    /// Tells its listener a number below 64, and wakes it. If it has died, nobody is woken.
    pub(crate) fn ring(&self, what: usize) -> Result<(), Errno> {
        let bell = self.bell();
        bell.told.fetch_or(1 << what, SeqCst);
        bell.rung.fetch_add(1, SeqCst);
        if bell.asleep.load(SeqCst) != 0 {
            futex::wake(&bell.rung, Flags::empty(), 1)?;
        }
        Ok(())
    }

    /// Takes what has been told: one bit for each number.
    pub(crate) fn take(&self) -> u64 {
        self.bell().told.swap(0, SeqCst)
    }

    /// Sleeps until something is told, a signal comes, or the limit is over; not at all if something has been
    /// told since it was last taken.
    pub(crate) fn sleep(&self, limit: Duration) -> Result<(), Errno> {
        let bell = self.bell();
        let rung = bell.rung.load(SeqCst);
        bell.asleep.store(1, SeqCst);
        let slept = match bell.told.load(SeqCst) {
            0 => futex::wait(&bell.rung, Flags::empty(), rung, Timespec::try_from(limit).ok().as_ref()),
            _ => Ok(()),
        };
        bell.asleep.store(0, SeqCst);
        match slept {
            Err(Errno::AGAIN | Errno::INTR | Errno::TIMEDOUT) | Ok(()) => Ok(()),
            Err(error) => Err(error),
        }
    }
}

/// Wakes a member from other threads of its own process, for what does not come by a channel.
#[derive(Clone, Debug)]
pub struct Doorbell(pub(super) BellOf);

impl Doorbell {
    /// Wakes it: it may have something to look at.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the system refuses.
    pub fn ring(&self) -> Result<(), IpcError> {
        self.0.ring(DATA).map_err(|error| IpcError::bus(NAME, error))
    }
}

#[cfg(test)]
mod tests {
    use std::{thread, time::Duration};

    use super::{Bells, Folder, Process};

    const RINGS: usize = 100_000;
    /// No sleep comes to it while rings are heard.
    const FOR_EVER: Duration = Duration::from_secs(300);

    /// Two that ring for each other in turn, each asleep or about to be when it is rung for.
    #[test]
    fn no_ring_is_lost_between_the_steps_of_a_sleep() {
        let folder = Folder::create().unwrap();
        let _kept = Bells::create(&folder).unwrap();
        let turns = |own: Process, other: Process, first: bool| {
            let bells = Bells::open(&folder).unwrap();
            let (own, other) = (bells.of(own), bells.of(other));
            for ring in 0..RINGS {
                if first || ring > 0 {
                    other.ring(ring % 60).unwrap();
                }
                while own.take() == 0 {
                    own.sleep(FOR_EVER).unwrap();
                }
            }
            other.ring(0).unwrap();
        };
        thread::scope(|scope| {
            scope.spawn(|| turns(Process::Plant, Process::Interpolator, true));
            scope.spawn(|| turns(Process::Interpolator, Process::Plant, false));
        });
        folder.wipe().unwrap();
    }

    /// Many ring for one, which sleeps whenever it has heard nothing.
    #[test]
    fn every_number_is_heard_however_many_ring() {
        let folder = Folder::create().unwrap();
        let bells = Bells::create(&folder).unwrap();
        let own = bells.of(Process::Plant);
        thread::scope(|scope| {
            for who in 0..4 {
                let folder = &folder;
                scope.spawn(move || {
                    let plant = Bells::open(folder).unwrap().of(Process::Plant);
                    (0..16).for_each(|what| plant.ring(16 * who + what).unwrap());
                });
            }
            let mut heard = 0;
            while heard != u64::MAX {
                own.sleep(FOR_EVER).unwrap();
                let news = own.take();
                assert_eq!(heard & news, 0, "nothing is heard twice");
                heard |= news;
            }
        });
        assert_eq!(own.take(), 0);
        folder.wipe().unwrap();
    }
}
