//! A process inside a name space.

use std::{os::fd::BorrowedFd, time::Duration};

use iceoryx2::prelude::{LogLevel, NodeBuilder, SignalHandlingMode, ipc};

use protocol::Payload;

use super::{
    Channel, ChannelCount, IpcError, Patience, Port, Process, Receiver, Sender, Waker,
    bell::{Bells, Doorbell},
    channel,
    count::CountPacket,
    folder::Folder,
    orphan::{self, Presence, is_orphan},
    port::Node,
    time::{Moment, sleep_until},
    wake::{AWAITED, DONE, END, Ear, GO_ON, GONE, QUIT, READY, START, WAITS},
};

/// One process of the machine: opens ports, waits, starts and ends together with the others.
#[derive(Debug)]
pub struct Member {
    process: Process,
    ear: Ear,
    roll_call: Waker,
    counts: Option<Sender<CountPacket>>,
    bells: Bells,
    pub(crate) node: Node,
    // Released last, and by ports after this: while it is held, nobody takes the name space for abandoned.
    presence: Option<Presence>,
}

impl Member {
    /// Joins the name space of the launcher that started this process. From here on the process knows when
    /// the *thread* that started it ends ([`is_orphan`]): launchers start processes from the main thread.
    ///
    /// # Errors
    /// A wrong address, a launcher that is gone, or a refusal of iceoryx2.
    pub fn join(address: &str, process: Process) -> Result<Member, IpcError> {
        let folder = Folder::enter(address)?;
        orphan::watch_for(folder.owner())?;
        let node = create_node(&folder, process)?;
        let mut member = Member::new(node, Bells::open(&folder)?, process)?;
        member.counts = Some(Sender::open(&member.node, channel::COUNT, Patience::Forever)?);
        member.presence = Some(Presence::new(folder));
        Ok(member)
    }

    pub(crate) fn new(node: Node, bells: Bells, process: Process) -> Result<Member, IpcError> {
        Ok(Member {
            process,
            ear: Ear::open(&node, &bells, process)?,
            roll_call: Waker::roll_call(&bells),
            counts: None,
            bells,
            node,
            presence: None,
        })
    }

    /// Opens the sending end of a channel.
    ///
    /// # Errors
    /// [`IpcError::Bus`], for instance if the channel has its sender already.
    pub fn sender<T: Payload>(&self, channel: Channel<T>, patience: Patience) -> Result<Sender<T>, IpcError> {
        Ok(Sender::open(&self.node, channel, patience)?.within(self.presence.clone()))
    }

    /// Opens the receiving end of a channel.
    ///
    /// # Errors
    /// [`IpcError::Bus`], for instance if all its receivers are there already.
    pub fn receiver<T: Payload>(&self, channel: Channel<T>) -> Result<Receiver<T>, IpcError> {
        Ok(Receiver::open(&self.node, channel)?.within(self.presence.clone()))
    }

    /// Opens the means to wake another process.
    ///
    /// # Errors
    /// [`IpcError::Bus`].
    pub fn waker(&self, process: Process) -> Result<Waker, IpcError> {
        Ok(Waker::open(&self.node, &self.bells, process)?.within(self.presence.clone()))
    }

    /// What wakes this member from another thread of its process. The launcher does not hear it: it waits
    /// [beside](Member::wait_beside) what it waits for.
    pub fn doorbell(&self) -> Doorbell {
        Doorbell(self.bells.of(self.process))
    }

    /// Rendezvous. Waits until every one of these ports has found its other ends, tells the launcher, and
    /// returns when it says that everybody has come so far.
    ///
    /// # Errors
    /// [`IpcError::NotConnected`] names the ports that have not found their other ends until the deadline.
    pub fn start(&mut self, ports: &[&dyn Port], deadline: Moment) -> Result<(), IpcError> {
        self.connect(ports, deadline)?;
        self.stand_by()?;
        self.begin()
    }

    /// The first step of [`Member::start`], for one that shares its process with others, or has something to
    /// do between: all of them connect their ports, then all stand by, then all begin.
    ///
    /// # Errors
    /// [`IpcError::NotConnected`], as there.
    pub fn connect(&mut self, ports: &[&dyn Port], deadline: Moment) -> Result<(), IpcError> {
        let counts = self.counts.iter().map(|counts| counts as &dyn Port);
        let ports: Vec<&dyn Port> = ports.iter().copied().chain(counts).collect();
        connect(&ports, deadline)
    }

    /// The next step: tells the launcher that all ports are connected.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn stand_by(&mut self) -> Result<(), IpcError> {
        self.roll_call.tell(READY + self.process.number())
    }

    /// The last step: returns when everybody stands by.
    ///
    /// # Errors
    /// [`IpcError::LauncherGone`].
    pub fn begin(&mut self) -> Result<(), IpcError> {
        while !self.ear.heard.is(START) {
            self.ear.wait()?;
            if is_orphan() {
                return Err(IpcError::LauncherGone);
            }
        }
        Ok(())
    }

    /// Sleeps until another process wakes this one; returns at once if one did since the last time. It may
    /// return without a reason, and one return may stand for many wake-ups: look at the receivers.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn wait(&mut self) -> Result<(), IpcError> {
        self.ear.wait()
    }

    /// The same with a limit. For watching over processes, not for timing: the operating system may add ten
    /// milliseconds and more.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn wait_at_most(&mut self, limit: Duration) -> Result<(), IpcError> {
        self.ear.wait_at_most(limit)
    }

    /// The same, and no longer than until something can be read here. For the launcher: others have a
    /// [doorbell](Member::doorbell), and wait as ever.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn wait_beside(&mut self, beside: BorrowedFd, limit: Duration) -> Result<(), IpcError> {
        self.ear.wait_beside(beside, limit)
    }

    /// Hears what there is to hear, without sleeping.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn look(&mut self) -> Result<(), IpcError> {
        self.ear.look()
    }

    /// Which process this is.
    pub fn process(&self) -> Process {
        self.process
    }

    /// Whether a process has died: the launcher has said so, as of the last wait, or it was given up.
    pub fn is_gone(&self, process: Process) -> bool {
        self.ear.heard.is(GONE + process.number())
    }

    /// Takes a process for dead from here on. For members that have no launcher any more.
    pub fn give_up(&mut self, process: Process) {
        self.ear.heard.note(GONE + process.number());
    }

    /// Whether the launcher wants the next measurement to be the last.
    pub fn is_to_quit(&self) -> bool {
        self.ear.heard.is(QUIT)
    }

    /// Sleeps until the launcher has done what it wants to do in this cycle, or is gone.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn stand(&mut self) -> Result<(), IpcError> {
        while !self.ear.heard.is(GO_ON) && !is_orphan() {
            self.ear.wait()?;
        }
        self.ear.heard.forget(GO_ON);
        Ok(())
    }

    /// Tells the launcher that this process lives, and has been waiting for another one for a while.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn waits_for(&self, whom: Process) -> Result<(), IpcError> {
        self.roll_call.tell(WAITS + self.process.number())?;
        self.roll_call.tell(AWAITED + whom.number())
    }

    /// Hands over the counts of all ports and waits until everybody has finished. Ports stay open until then,
    /// so that nobody's last message finds its receiver gone.
    ///
    /// # Errors
    /// A refusal of iceoryx2.
    pub fn finish(self, counts: &[ChannelCount]) -> Result<(), IpcError> {
        self.finish_and(counts, || Ok(()))
    }

    /// Hands over the counts and waits for nobody: another member of the same process does, and keeps the
    /// ports of this one open until then.
    ///
    /// # Errors
    /// A refusal of iceoryx2.
    pub fn has_finished(&mut self, counts: &[ChannelCount]) -> Result<(), IpcError> {
        if let Some(sender) = &mut self.counts {
            counts.iter().try_for_each(|count| sender.send(&CountPacket::pack(count)))?;
        }
        self.roll_call.tell(DONE + self.process.number())
    }

    /// As [`Member::finish`]; does something now and then meanwhile, so that nobody waits for a place in a
    /// queue of this process.
    ///
    /// # Errors
    /// A refusal of iceoryx2, and what is done.
    pub fn finish_and(
        mut self,
        counts: &[ChannelCount],
        mut meanwhile: impl FnMut() -> Result<(), IpcError>,
    ) -> Result<(), IpcError> {
        self.has_finished(counts)?;
        while !self.ear.heard.is(END) && !is_orphan() {
            meanwhile()?;
            self.ear.wait()?;
        }
        Ok(())
    }
}

/// Waits until all ports have found their other ends.
fn connect(ports: &[&dyn Port], deadline: Moment) -> Result<(), IpcError> {
    loop {
        let mut missing = Vec::new();
        for port in ports {
            if !port.connected()? {
                missing.push(port.name().to_owned());
            }
        }
        if missing.is_empty() {
            return Ok(());
        }
        if is_orphan() {
            return Err(IpcError::LauncherGone);
        }
        if deadline.passed() {
            return Err(IpcError::NotConnected(missing));
        }
        sleep_until(Moment::now().after(Duration::from_micros(200)));
    }
}

/// Makes this process known to iceoryx2. Everything that iceoryx2 would do on its own is off: it cleans up
/// nothing, catches no signals, reads no configuration file.
pub(crate) fn create_node(folder: &Folder, process: Process) -> Result<Node, IpcError> {
    iceoryx2::prelude::set_log_level(LogLevel::Error);
    let name = process.name();
    let node_name = name.as_str().try_into().map_err(|error| IpcError::bus(&name, error))?;
    NodeBuilder::new()
        .name(&node_name)
        .config(&folder.config()?)
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<ipc::Service>()
        .map_err(|error| IpcError::bus(&name, error))
}
