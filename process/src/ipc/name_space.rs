//! The owner's side: a machine's own corner of shared memory, invisible to other machines on the same
//! computer.

use std::any::Any;

use protocol::Axis;

use super::{
    ChannelCount, IpcError, Member, Port, Process, Receiver, Waker,
    bell::Bells,
    channel, computer,
    count::CountPacket,
    folder::Folder,
    member::create_node,
    wake::{AWAITED, DONE, END, Ear, GO_ON, GONE, QUIT, READY, START, WAITS, create_event},
};

/// The channels of one machine. The launcher creates it before it starts processes, and drops it after they
/// ended.
///
/// Whatever died whenever: the next `create` of this user wipes what was left, and touches nothing that
/// lives.
pub struct NameSpace {
    // In the order in which they have to go.
    member: Member,
    ear: Ear,
    wakers: Vec<(Process, Waker)>,
    counts: Receiver<CountPacket>,
    _services: Vec<Box<dyn Any>>,
    folder: OnDrop,
}

/// Wipes when all ports are closed.
struct OnDrop(Folder);

impl Drop for OnDrop {
    fn drop(&mut self) {
        // What cannot be wiped now is wiped by the next `create`.
        if let Err(error) = self.0.wipe() {
            tracing::warn!(%error, "the name space was not wiped");
        }
    }
}

impl NameSpace {
    /// Makes a name space with every channel and event of a machine with these axes.
    ///
    /// # Errors
    /// No room for temporary files or shared memory, or a refusal of iceoryx2.
    pub fn create(axes: &[Axis]) -> Result<NameSpace, IpcError> {
        let folder = OnDrop(Folder::create()?);
        computer::check_shared_memory(axes)?;
        computer::allow_files(computer::files(axes))?;
        let node = create_node(&folder.0, Process::Launcher)?;
        let mut services: Vec<Box<dyn Any>> = Vec::new();
        for channel in channel::all(axes) {
            services.push((channel.create)(&node)?);
        }
        services.push(Box::new(create_event(&node)?));
        let bells = Bells::create(&folder.0)?;
        folder.0.take_memory()?;
        let ear = Ear::roll_call(&bells)?;
        let member = Member::new(node, bells, Process::Launcher)?;
        let waker = |process: Process| Ok((process, member.waker(process)?));
        Ok(NameSpace {
            wakers: Process::members(axes).into_iter().map(waker).collect::<Result<_, IpcError>>()?,
            ear,
            counts: member.receiver(channel::COUNT)?,
            member,
            _services: services,
            folder,
        })
    }

    /// The argument of [`Member::join`] for the processes of this machine.
    pub fn address(&self) -> String {
        self.folder.0.address()
    }

    /// The launcher as a member: its ports to record and to operate.
    pub fn launcher(&mut self) -> &mut Member {
        &mut self.member
    }

    /// Processes that have not yet connected all their ports. Asking connects the launcher's own ports, too.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if one of them cannot be connected.
    pub fn missing(&mut self, own_ports: &[&dyn Port]) -> Result<Vec<Process>, IpcError> {
        self.ear.look()?;
        let mut missing = self.silent(READY);
        // Whoever answered has its end of this channel open; it is only to be mapped.
        self.counts.connected()?;
        let mut own = true;
        for port in own_ports {
            own &= port.connected()?;
        }
        if !own {
            missing.push(Process::Launcher);
        }
        Ok(missing)
    }

    /// Lets everybody begin. Nobody may be missing. From here on nobody needs shared memory that is not
    /// there.
    ///
    /// # Errors
    /// [`IpcError::NoRoom`] if others took it meanwhile; [`IpcError::Bus`] if the event is broken.
    pub fn start(&self) -> Result<(), IpcError> {
        self.folder.0.take_memory()?;
        self.tell(START)
    }

    /// Processes that have not yet finished, the dead among them.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn unfinished(&mut self) -> Result<Vec<Process>, IpcError> {
        self.ear.look()?;
        Ok(self.silent(DONE))
    }

    /// Tells everybody that a process has died, after its ports were taken away: senders that wait for it
    /// return.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn bury(&self, process: Process) -> Result<(), IpcError> {
        self.member.node.try_cleanup_dead_nodes();
        self.tell(GONE + process.number())
    }

    /// Those whom others have been waiting for since the last look, and who do not wait for anybody.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn awaited(&mut self) -> Result<Vec<Process>, IpcError> {
        self.ear.look()?;
        let heard = self.ear.heard;
        let holds_up =
            |process: &Process| heard.is(AWAITED + process.number()) && !heard.is(WAITS + process.number());
        let awaited = self.wakers.iter().map(|(process, _)| *process).filter(holds_up).collect();
        for number in 0..Process::COUNT {
            self.ear.heard.forget(WAITS + number);
            self.ear.heard.forget(AWAITED + number);
        }
        Ok(awaited)
    }

    /// Has the plant make its next measurement the last one: everybody answers it and ends.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn quit(&self) -> Result<(), IpcError> {
        self.tell_plant(QUIT)
    }

    /// Lets the plant go on, which stands because somebody was to be killed or stopped.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the event is broken.
    pub fn go_on(&self) -> Result<(), IpcError> {
        self.tell_plant(GO_ON)
    }

    /// Lets everybody go, and gives the counts they handed over. Nobody alive may be unfinished.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if a channel is broken.
    pub fn end(&mut self) -> Result<Vec<ChannelCount>, IpcError> {
        let mut counts = Vec::new();
        while let Some(packet) = self.counts.receive()? {
            counts.push(packet.unpack());
        }
        self.tell(END)?;
        Ok(counts)
    }

    fn silent(&self, answer: usize) -> Vec<Process> {
        let silent = |process: &Process| !self.ear.heard.is(answer + process.number());
        self.wakers.iter().map(|(process, _)| *process).filter(silent).collect()
    }

    /// Everybody is told, though one of them could not be.
    fn tell(&self, what: usize) -> Result<(), IpcError> {
        let told: Vec<_> = self.wakers.iter().map(|(_, waker)| waker.tell(what)).collect();
        told.into_iter().collect()
    }

    fn tell_plant(&self, what: usize) -> Result<(), IpcError> {
        let mut plant = self.wakers.iter().filter(|(process, _)| *process == Process::Plant);
        plant.try_for_each(|(_, waker)| waker.tell(what))
    }
}
