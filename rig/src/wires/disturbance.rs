//! What can become of a message on a wire: it comes late, never, twice, damaged, or an old one comes in its
//! place.
//!
//! A disturbance knows a message as bytes, so that it is the same for all of them. A function of the wire and
//! the cycle says which messages it concerns.

use std::collections::{BTreeMap, VecDeque};

use protocol::Cycle;
use zerocopy::{FromBytes, Immutable, IntoBytes};

use super::Wire;

/// What goes over a wire.
pub trait Message: Copy + IntoBytes + FromBytes + Immutable {}

impl<M: Copy + IntoBytes + FromBytes + Immutable> Message for M {}

/// Decides which messages are concerned: on which wire, in which cycle.
pub type Which = Box<dyn FnMut(Wire, Cycle) -> bool>;

/// What becomes of the messages on their way.
pub trait Disturbance {
    /// Takes what was sent, if anything, and gives what arrives.
    fn carry<M: Message>(&mut self, wire: Wire, now: Cycle, sent: Option<M>) -> Option<M>;

    /// Whether every message arrives as it was sent until something is changed; asked before each, so that
    /// what does nothing costs nothing.
    fn is_idle(&self) -> bool {
        false
    }
}

/// A message with one of its bits turned over, counted round.
pub(super) fn damaged<M: Message>(message: M, bit: usize) -> Option<M> {
    let mut bytes = message.as_bytes().to_vec();
    let bit = bit % (8 * bytes.len());
    bytes[bit / 8] ^= 1 << (bit % 8);
    M::read_from_bytes(&bytes).ok()
}

/// What is still on its way over each wire, as bytes; `None` where nothing was sent.
#[derive(Default)]
struct UnderWay(BTreeMap<Wire, VecDeque<Option<Vec<u8>>>>);

impl UnderWay {
    fn push<M: Message>(&mut self, wire: Wire, sent: Option<M>) {
        self.0.entry(wire).or_default().push_back(sent.map(|message| message.as_bytes().to_vec()));
    }

    /// The oldest, if more than `kept` are under way.
    fn pop<M: Message>(&mut self, wire: Wire, kept: usize) -> Option<M> {
        let queue = self.0.get_mut(&wire).filter(|queue| queue.len() > kept)?;
        M::read_from_bytes(&queue.pop_front()??).ok()
    }

    fn is_empty(&self, wire: Wire) -> bool {
        self.0.get(&wire).is_none_or(VecDeque::is_empty)
    }
}

/// Messages come later, in order, by so many of the moments at which their wire carries one: ticks for a
/// frame, control cycles for a drive command. Once late, a wire stays late.
pub struct Late {
    by: usize,
    which: Which,
    under_way: UnderWay,
}

impl Late {
    /// Wires that are late by so many moments.
    pub fn new(by: usize, which: impl FnMut(Wire, Cycle) -> bool + 'static) -> Late {
        Late { by, which: Box::new(which), under_way: UnderWay::default() }
    }

    /// From now on others are late, or by more; what is under way comes in its turn.
    pub fn change(&mut self, by: usize, which: impl FnMut(Wire, Cycle) -> bool + 'static) {
        (self.by, self.which) = (by, Box::new(which));
    }
}

impl Disturbance for Late {
    fn carry<M: Message>(&mut self, wire: Wire, now: Cycle, sent: Option<M>) -> Option<M> {
        let kept = if (self.which)(wire, now) { self.by } else { 0 };
        if kept == 0 && self.under_way.is_empty(wire) {
            return sent;
        }
        self.under_way.push(wire, sent);
        self.under_way.pop(wire, kept)
    }
}

/// Messages never arrive.
pub struct Losing(Which);

impl Losing {
    /// Wires that lose these messages.
    pub fn new(which: impl FnMut(Wire, Cycle) -> bool + 'static) -> Losing {
        Losing(Box::new(which))
    }

    /// From now on others are lost.
    pub fn change(&mut self, which: impl FnMut(Wire, Cycle) -> bool + 'static) {
        self.0 = Box::new(which);
    }
}

impl Disturbance for Losing {
    fn carry<M: Message>(&mut self, wire: Wire, now: Cycle, sent: Option<M>) -> Option<M> {
        sent.filter(|_| !(self.0)(wire, now))
    }
}

/// Messages arrive twice, one after the other; those behind them wait until the wire is idle for once.
pub struct Doubling {
    which: Which,
    under_way: UnderWay,
}

impl Doubling {
    /// Wires that double these messages.
    pub fn new(which: impl FnMut(Wire, Cycle) -> bool + 'static) -> Doubling {
        Doubling { which: Box::new(which), under_way: UnderWay::default() }
    }
}

impl Disturbance for Doubling {
    fn carry<M: Message>(&mut self, wire: Wire, now: Cycle, sent: Option<M>) -> Option<M> {
        if let Some(message) = sent {
            let times = if (self.which)(wire, now) { 2 } else { 1 };
            (0..times).for_each(|_| self.under_way.push(wire, Some(message)));
        }
        self.under_way.pop(wire, 0)
    }
}

/// Messages arrive with one bit turned over, another one each time.
pub struct Damaging {
    which: Which,
    bit: usize,
}

impl Damaging {
    /// From one damaged message to the next; a prime, so that in time every bit has its turn.
    const STRIDE: usize = 1009;

    /// Wires that damage these messages, at first in this bit of their bytes.
    pub fn new(bit: usize, which: impl FnMut(Wire, Cycle) -> bool + 'static) -> Damaging {
        Damaging { which: Box::new(which), bit }
    }
}

impl Disturbance for Damaging {
    fn carry<M: Message>(&mut self, wire: Wire, now: Cycle, sent: Option<M>) -> Option<M> {
        let message = sent?;
        if !(self.which)(wire, now) {
            return Some(message);
        }
        let bit = self.bit;
        self.bit = self.bit.wrapping_add(Damaging::STRIDE);
        damaged(message, bit)
    }
}

/// The last message that was carried whole arrives again in the place of these.
pub struct Freezing {
    which: Which,
    last: BTreeMap<Wire, Vec<u8>>,
}

impl Freezing {
    /// Wires that freeze while these messages are sent.
    pub fn new(which: impl FnMut(Wire, Cycle) -> bool + 'static) -> Freezing {
        Freezing { which: Box::new(which), last: BTreeMap::new() }
    }
}

impl Disturbance for Freezing {
    fn carry<M: Message>(&mut self, wire: Wire, now: Cycle, sent: Option<M>) -> Option<M> {
        let message = sent?;
        if (self.which)(wire, now) {
            return M::read_from_bytes(self.last.get(&wire)?).ok();
        }
        self.last.insert(wire, message.as_bytes().to_vec());
        sent
    }
}
