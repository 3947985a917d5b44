//! What a module takes otherwise than in lock step, told to the recorder. In: for each input, what was taken
//! and what is due. Out: an [`Arrival`] where that begins or ends to differ. In lock step nothing is told; a
//! recorder that stands costs what it is told, never a cycle.

use protocol::{Arrival, Differs, Input, Taken};

use crate::{
    ipc::{ChannelCount, IpcError, Member, Port, Sender, Undelivered, channel, is_orphan, time},
    shell::{ProcessArgs, ShellError},
};

/// Tells what a module takes.
pub(crate) struct Notes {
    sender: Sender<Arrival>,
    told: u64,
    /// Code of the module; 0 of the plant.
    module: u32,
    inputs: Vec<(Input, Differs)>,
}

impl Notes {
    /// Of a module with these inputs.
    pub(crate) fn open(
        member: &Member,
        args: &ProcessArgs,
        inputs: impl IntoIterator<Item = Input>,
    ) -> Result<Notes, IpcError> {
        let sender = member.sender(channel::ARRIVAL, args.recorded())?;
        let inputs = inputs.into_iter().map(|input| (input, Differs::default())).collect();
        let module = member.process().module().map_or(0, protocol::Module::code);
        Ok(Notes { sender, told: 0, module, inputs })
    }

    pub(crate) fn port(&self) -> &dyn Port {
        &self.sender
    }

    pub(crate) fn count(&self) -> ChannelCount {
        self.sender.count()
    }

    /// With the measurement of this cycle that was taken for an input, and that is due there in lock step.
    pub(crate) fn note(
        &mut self,
        cycle: u64,
        input: Input,
        taken: Option<u64>,
        due: Option<u64>,
    ) -> Result<(), ShellError> {
        let differs = self.inputs.iter_mut().find(|(other, _)| *other == input);
        match differs.and_then(|(_, differs)| differs.note(taken, due)) {
            Some(change) => self.tell(cycle, input, change),
            None => Ok(()),
        }
    }

    /// Measurements that came in a row, of which this is the newest and that is the one which was expected:
    /// those between have been lost.
    pub(crate) fn gap(&mut self, input: Input, newest: u64, expected: u64) -> Result<(), ShellError> {
        if newest <= expected {
            return Ok(());
        }
        self.tell(expected, input, Taken::Nothing)?;
        self.tell(newest, input, Taken::Due)
    }

    /// Something that happens once.
    pub(crate) fn tell(&mut self, cycle: u64, input: Input, what: Taken) -> Result<(), ShellError> {
        let arrival = Arrival::pack(self.told, cycle, input, what);
        self.told += 1;
        match self.sender.send(&arrival) {
            // What follows has another number: so the recorder knows.
            Ok(()) | Err(Undelivered::Full(_) | Undelivered::Receivers { .. }) => Ok(()),
            Err(broken) => Err(broken.into()),
        }
    }

    /// The last word: how many were told. The machine rests, so there is time for a recorder that stands.
    pub(crate) fn finish(&mut self) -> Result<(), ShellError> {
        let total = Arrival::pack(self.told, self.module.into(), Input::Total, Taken::This(self.told));
        while !is_orphan() {
            match self.sender.send(&total) {
                Ok(()) | Err(Undelivered::Receivers { .. }) => break,
                Err(Undelivered::Full(_)) => {
                    self.sender.comes_again();
                    time::sleep_until(time::Moment::now().after(super::PAUSE));
                }
                Err(broken) => return Err(broken.into()),
            }
        }
        Ok(())
    }
}
