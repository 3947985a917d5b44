//! What a scenario does to messages: it drops, delays, doubles, reorders or damages so many of them on a
//! channel. In: a [`Packet`] of the scenario, then what is sent. Out: what arrives.
//!
//! A wire carries one message at a time, so what comes late takes the place of the one that is due then; with
//! the last of the messages concerned the wire is as it was, and what is still under way is lost behind what
//! is newer. Machine code is not lost: a packet of it that is held up arrives in the same tick or in a later
//! one.

use std::collections::VecDeque;

use protocol::{Axis, Cycle};
use sim_plant::{Channel, Packet, Tampering};

use super::Wire;
use super::disturbance::{Disturbance, Message, damaged};

/// From one damaged message to the next; a prime, so that in time every bit has its turn.
const STRIDE: u32 = 1009;

/// What is done to the messages on one wire.
#[derive(Clone)]
struct Task {
    wire: Wire,
    tampering: Tampering,
    left: u32,
    /// What is under way, as bytes, and when it is due.
    held: VecDeque<(u64, Vec<u8>)>,
}

/// What a scenario does to the messages on all wires.
#[derive(Clone, Default)]
pub(crate) struct Tamperer(Vec<Task>);

impl Tamperer {
    /// The scenario wants messages tampered with on a machine with these axes.
    pub(crate) fn take(&mut self, packet: &Packet, axes: impl Iterator<Item = Axis>) {
        let Packet { tampering, count: left, .. } = *packet;
        let mut begin = |wire| self.0.push(Task { wire, tampering, left, held: VecDeque::new() });
        match packet.channel {
            Channel::MachineCode => begin(Wire::Code),
            Channel::TickMeasurement => begin(Wire::TickMeasurement),
            Channel::Measurement(Some(axis)) => begin(Wire::Measurement(axis)),
            Channel::Measurement(None) => axes.map(Wire::Measurement).for_each(begin),
            Channel::AxisCommand(axis) => begin(Wire::Frame(axis)),
            Channel::AxisStatus(axis) => begin(Wire::Status(axis)),
            Channel::SpindleCommand => begin(Wire::Spindle),
            Channel::DriveCommand(axis) => begin(Wire::Drive(axis)),
        }
    }
}

impl Disturbance for Tamperer {
    fn carry<M: Message>(&mut self, wire: Wire, now: Cycle, sent: Option<M>) -> Option<M> {
        let mut carried = sent;
        for task in self.0.iter_mut().filter(|task| task.wire == wire) {
            carried = task.carry(now.0, carried);
        }
        self.0.retain(|task| task.left > 0 || !task.held.is_empty());
        carried
    }

    fn is_idle(&self) -> bool {
        self.0.is_empty()
    }
}

impl Task {
    fn carry<M: Message>(&mut self, now: u64, sent: Option<M>) -> Option<M> {
        // A message that waits for its turn is not another one to be tampered with.
        let busy = match self.tampering {
            _ if self.wire == Wire::Code => self.swaps(),
            Tampering::Delay { .. } => false,
            _ => !self.held.is_empty(),
        };
        let concerned = self.left > 0 && sent.is_some() && !busy;
        self.left -= u32::from(concerned);
        match self.tampering {
            Tampering::Drop => sent.filter(|_| !concerned),
            Tampering::Corrupt { bit } if concerned => {
                self.tampering = Tampering::Corrupt { bit: bit.wrapping_add(STRIDE) };
                sent.and_then(|message| damaged(message, bit as usize))
            }
            Tampering::Corrupt { .. } => sent,
            _ if self.wire == Wire::Code => self.in_line(now, sent, concerned),
            Tampering::Delay { cycles } => self.late(now, sent, concerned, u64::from(cycles)),
            Tampering::Duplicate => {
                let again = self.release(now);
                sent.filter(|_| concerned).iter().for_each(|message| self.keep(now + 1, message));
                again.or(sent)
            }
            Tampering::Reorder => self.swapped(now, sent, concerned),
        }
    }

    /// Messages of which the newest counts, late by so many cycles.
    fn late<M: Message>(&mut self, now: u64, sent: Option<M>, concerned: bool, cycles: u64) -> Option<M> {
        if concerned {
            sent.iter().for_each(|message| self.keep(now + cycles, message));
        } else if sent.is_some() {
            self.held.clear();
            return sent;
        }
        let mut newest = None;
        while let Some(message) = self.release(now) {
            newest = Some(message);
        }
        newest
    }

    /// A message waits until the next has passed, and then takes the place of the one after that.
    fn swapped<M: Message>(&mut self, now: u64, sent: Option<M>, concerned: bool) -> Option<M> {
        if concerned {
            sent.iter().for_each(|message| self.keep(u64::MAX, message));
            return None;
        }
        if let (Some((due @ u64::MAX, _)), true) = (self.held.front_mut(), sent.is_some()) {
            *due = now + 1;
            return sent;
        }
        self.release(now).or(sent)
    }

    /// Whether the last message waits for the one that follows it.
    fn swaps(&self) -> bool {
        matches!(self.held.back(), Some((u64::MAX, _)))
    }

    /// Machine code: what arrives later makes the others wait, and nothing is lost.
    fn in_line<M: Message>(&mut self, now: u64, sent: Option<M>, concerned: bool) -> Option<M> {
        let (due, times) = match self.tampering {
            Tampering::Delay { cycles } if concerned => (now + u64::from(cycles), 1),
            Tampering::Reorder if concerned => (u64::MAX, 1),
            Tampering::Duplicate if concerned => (now, 2),
            _ => (now, 1),
        };
        // It follows the one that comes now, or nobody comes any more.
        let first = if self.swaps() { self.held.pop_back() } else { None };
        (0..times).for_each(|_| sent.iter().for_each(|message| self.keep(due, message)));
        self.held.extend(first.map(|(_, bytes)| (now, bytes)));
        self.release(now)
    }

    fn keep<M: Message>(&mut self, due: u64, message: &M) {
        self.held.push_back((due, message.as_bytes().to_vec()));
    }

    /// The oldest message, if it is due.
    fn release<M: Message>(&mut self, now: u64) -> Option<M> {
        let (_, bytes) = self.held.pop_front_if(|(due, _)| *due <= now)?;
        M::read_from_bytes(&bytes).ok()
    }
}
