//! Wake-ups: every process has an ear that everybody may reach and only it hears.
//!
//! A wake-up carries a number. [`DATA`] only says "look"; the others are what the owner tells: start, end,
//! who has died, and some that are for the plant alone. They are counted in shared memory and never lost, but
//! several may arrive as one, and one may arrive for nothing: whoever waits looks at its receivers again.
//!
//! Members hear [bells](super::bell). The launcher, which also waits for what comes by a socket, hears an
//! event of iceoryx2, which is one, and only ever that there may be data.
//!
//! No sleep is without limit. A signal may come just before it, and iceoryx2 0.10.0 notifies in three steps:
//! note the number, send a datagram, mark the event as notified. A listener that swallows the datagram of a
//! sender who is interrupted before the third step, and sleeps again, lies beside an event that is marked:
//! nobody sends a datagram to it any more. Who wakes by itself finds what was noted. The limit costs nothing,
//! and decides nothing but how long such a rare case takes.

use std::{
    os::fd::{AsRawFd as _, BorrowedFd},
    time::Duration,
};

use iceoryx2::{
    port::{
        listener::{Listener, ListenerWaitError},
        notifier::Notifier,
    },
    prelude::{CallbackProgression, EventActivation, EventId, SignalHandlingMode, WaitSetBuilder, ipc},
    service::port_factory::{PortFactory as _, event::PortFactory},
};
use iceoryx2_bb_posix::{
    file_descriptor::{FileDescriptor, FileDescriptorBased},
    file_descriptor_set::SynchronousMultiplexing,
};

use super::{
    IpcError, Port, Process,
    bell::{BellOf, Bells},
    orphan::Presence,
    port::{Node, service_name},
};

/// The longest sleep.
const LIMIT: Duration = Duration::from_millis(50);

/// There may be data.
pub(crate) const DATA: usize = 0;
/// Everybody is connected: begin.
pub(crate) const START: usize = 1;
/// Everybody has finished: go.
pub(crate) const END: usize = 2;
/// `GONE + number`: that process has died.
pub(crate) const GONE: usize = 3;
/// To the plant: the next measurement is the last one.
pub(crate) const QUIT: usize = GONE + Process::COUNT;
/// To the plant, which stands because somebody is to be killed or stopped in this cycle: it is done.
pub(crate) const GO_ON: usize = QUIT + 1;
/// Where members answer the owner.
const ROLL_CALL: &str = "roll-call";
/// On the roll call: `READY + number`, connected.
pub(crate) const READY: usize = 0;
/// On the roll call: `DONE + number`, finished.
pub(crate) const DONE: usize = Process::COUNT;
/// On the roll call: `WAITS + number`, lives, and has been waiting for somebody for a while.
pub(crate) const WAITS: usize = 2 * Process::COUNT;
/// On the roll call: `AWAITED + number`, somebody has been waiting for that one for a while.
pub(crate) const AWAITED: usize = 3 * Process::COUNT;
/// All of them are below this.
pub(crate) const NUMBERS: usize = 4 * Process::COUNT;

type Service = PortFactory<ipc::Service>;

/// Name of the ear of a process.
pub(crate) fn wake_name(process: Process) -> String {
    format!("wake/{}", process.name())
}

/// The owner's part: the launcher's event exists before anybody opens it.
pub(crate) fn create_event(node: &Node) -> Result<Service, IpcError> {
    let name = wake_name(Process::Launcher);
    node.service_builder(&service_name(&name)?)
        .event()
        .max_listeners(1)
        .max_notifiers(2 * Process::COUNT)
        .max_nodes(Process::COUNT + 1)
        .event_id_max_value(DATA)
        .create()
        .map_err(|error| IpcError::bus(&name, error))
}

fn open_event(node: &Node, name: &str) -> Result<Service, IpcError> {
    node.service_builder(&service_name(name)?).event().open().map_err(|error| IpcError::bus(name, error))
}

/// Wakes one process.
#[derive(Debug)]
pub struct Waker {
    name: String,
    way: Way,
    _presence: Option<Presence>,
}

/// How it is reached.
#[derive(Debug)]
enum Way {
    Bell(BellOf),
    Event(Box<(Service, Notifier<ipc::Service>)>),
}

impl Waker {
    pub(crate) fn open(node: &Node, bells: &Bells, process: Process) -> Result<Waker, IpcError> {
        let name = wake_name(process);
        let way = if process == Process::Launcher {
            let service = open_event(node, &name)?;
            let notifier =
                service.notifier_builder().create().map_err(|error| IpcError::bus(&name, error))?;
            Way::Event(Box::new((service, notifier)))
        } else {
            Way::Bell(bells.of(process))
        };
        Ok(Waker { name, way, _presence: None })
    }

    /// Answers the owner, which only looks.
    pub(crate) fn roll_call(bells: &Bells) -> Waker {
        Waker { name: ROLL_CALL.into(), way: Way::Bell(bells.roll_call()), _presence: None }
    }

    /// As long as this end is open, its process lives in the name space.
    pub(crate) fn within(self, presence: Option<Presence>) -> Waker {
        Waker { _presence: presence, ..self }
    }

    /// Tells the process that there may be data. If it has died, nobody is woken, and that is no error:
    /// whoever waits for its answer will notice.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the way to it is broken.
    pub fn wake(&self) -> Result<(), IpcError> {
        self.tell(DATA)
    }

    pub(crate) fn tell(&self, what: usize) -> Result<(), IpcError> {
        match &self.way {
            Way::Bell(bell) => bell.ring(what).map_err(|error| IpcError::bus(&self.name, error)),
            Way::Event(event) => event
                .1
                .notify_with_custom_event_id(EventId::new(what))
                .map(|_| ())
                .map_err(|error| IpcError::bus(&self.name, error)),
        }
    }
}

impl Port for Waker {
    fn name(&self) -> &str {
        &self.name
    }

    fn connected(&self) -> Result<bool, IpcError> {
        Ok(match &self.way {
            Way::Bell(bell) => bell.has_listener(),
            Way::Event(event) => event.0.dynamic_config().number_of_listeners() == 1,
        })
    }
}

/// What has been heard, by number.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Heard(u64);

impl Heard {
    pub(crate) fn is(self, what: usize) -> bool {
        self.0 & (1 << what) != 0
    }

    pub(crate) fn note(&mut self, what: usize) {
        self.0 |= 1 << what;
    }

    pub(crate) fn forget(&mut self, what: usize) {
        self.0 &= !(1 << what);
    }
}

/// Something beside its event that a process waits for.
#[derive(Debug)]
struct Beside(FileDescriptor);

impl FileDescriptorBased for Beside {
    fn file_descriptor(&self) -> &FileDescriptor {
        &self.0
    }
}

impl SynchronousMultiplexing for Beside {}

/// The ear of a process.
#[derive(Debug)]
pub(crate) struct Ear {
    name: String,
    hears: Hears,
    pub(crate) heard: Heard,
}

/// What it hears.
#[derive(Debug)]
enum Hears {
    Bell(BellOf),
    Event(Box<Listener<ipc::Service>>),
}

impl Ear {
    pub(crate) fn open(node: &Node, bells: &Bells, process: Process) -> Result<Ear, IpcError> {
        let name = wake_name(process);
        if process != Process::Launcher {
            return Ear::on(bells.of(process), name);
        }
        let service = open_event(node, &name)?;
        let listener = service.listener_builder().create().map_err(|error| IpcError::bus(&name, error))?;
        Ok(Ear { name, hears: Hears::Event(Box::new(listener)), heard: Heard::default() })
    }

    /// The owner's, for what members answer.
    pub(crate) fn roll_call(bells: &Bells) -> Result<Ear, IpcError> {
        Ear::on(bells.roll_call(), ROLL_CALL.into())
    }

    fn on(bell: BellOf, name: String) -> Result<Ear, IpcError> {
        if !bell.is_listened_to() {
            return Err(IpcError::bus(&name, "it has a listener already"));
        }
        Ok(Ear { name, hears: Hears::Bell(bell), heard: Heard::default() })
    }

    /// Sleeps until woken, or not at all if that has happened since the last time.
    pub(crate) fn wait(&mut self) -> Result<(), IpcError> {
        self.wait_at_most(LIMIT)
    }

    /// The same with a limit, which the operating system may stretch by ten milliseconds and more.
    pub(crate) fn wait_at_most(&mut self, limit: Duration) -> Result<(), IpcError> {
        match &self.hears {
            Hears::Bell(bell) => {
                bell.sleep(limit).map_err(|error| IpcError::bus(&self.name, error))?;
                self.look()
            }
            Hears::Event(listener) => {
                listen(&self.name, &mut self.heard, |note| listener.timed_wait(note, limit))
            }
        }
    }

    /// The same, and no longer than until something can be read here, or its other end is closed. Where that
    /// cannot be waited for, it is the plain wait.
    pub(crate) fn wait_beside(&mut self, beside: BorrowedFd, limit: Duration) -> Result<(), IpcError> {
        if self.waits_for_both(beside, limit) { self.look() } else { self.wait_at_most(limit) }
    }

    /// Waits, and says whether it could.
    fn waits_for_both(&self, beside: BorrowedFd, limit: Duration) -> bool {
        let Hears::Event(listener) = &self.hears else { return false };
        let set = WaitSetBuilder::new().signal_handling_mode(SignalHandlingMode::Disabled);
        let Ok(set) = set.create::<ipc::Service>() else { return false };
        let Some(beside) = FileDescriptor::non_owning_new(beside.as_raw_fd()).map(Beside) else {
            return false;
        };
        let (own, other) = (set.attach_notification(&**listener), set.attach_notification(&beside));
        let waits = own.is_ok() && other.is_ok();
        waits && set.wait_and_process_once_with_timeout(|_| CallbackProgression::Continue, limit).is_ok()
    }

    /// Takes what has been heard, without sleeping.
    pub(crate) fn look(&mut self) -> Result<(), IpcError> {
        match &self.hears {
            Hears::Bell(bell) => {
                self.heard.0 |= bell.take();
                Ok(())
            }
            Hears::Event(listener) => listen(&self.name, &mut self.heard, |note| listener.try_wait(note)),
        }
    }
}

/// Notes what an event has been told.
fn listen(
    name: &str,
    heard: &mut Heard,
    how: impl FnOnce(&mut dyn FnMut(EventActivation)) -> Result<u64, ListenerWaitError>,
) -> Result<(), IpcError> {
    match how(&mut |event| heard.note(event.id.as_value())) {
        Ok(_) | Err(ListenerWaitError::InterruptSignal) => Ok(()),
        Err(error) => Err(IpcError::bus(name, error)),
    }
}

impl Drop for Ear {
    fn drop(&mut self) {
        if let Hears::Bell(bell) = &self.hears {
            bell.is_left();
        }
    }
}
