//! Machine-code items waiting to be executed, and the one in hand. While there is room, the sender has
//! credit.

use std::collections::VecDeque;

use protocol::{ByHand, Code, CodePacket, Item, Refused};

/// How many items wait at most, besides the one in hand.
pub const DEPTH: usize = 64;

/// The queue. It allocates once, when it is made.
#[derive(Clone, Debug)]
pub struct Queue {
    items: VecDeque<Item>,
    /// Taken out of the queue and not done yet.
    hand: Option<Item>,
    received: u64,
    taken: u64,
    source: Source,
}

/// What is known of the sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    /// More will come.
    Sends,
    /// The end of the program has come in.
    Ended,
    /// The end of a block that was given by hand has come in: the next one is not asked for yet.
    Waits,
    /// An item was damaged or out of order: what would follow it is not known.
    Refused,
    /// The sender is gone before the end of the program.
    Lost,
}

impl Default for Queue {
    fn default() -> Self {
        let items = VecDeque::with_capacity(DEPTH);
        Queue { items, hand: None, received: 0, taken: 0, source: Source::Sends }
    }
}

impl Queue {
    /// Takes an item off the wire.
    ///
    /// # Errors
    /// The item is damaged, out of order, beyond the credit, or behind the end of the program. It is not
    /// taken, and nothing after it: [`Queue::failed`] says so from then on.
    pub fn push(&mut self, packet: &CodePacket) -> Result<(), Refused> {
        let taken = self.take(packet);
        if taken.is_err() && self.source == Source::Sends {
            self.source = Source::Refused;
        }
        taken
    }

    fn take(&mut self, packet: &CodePacket) -> Result<(), Refused> {
        if !self.wants() {
            return Err(Refused::OutOfRange("machine code without credit"));
        }
        let item = packet.unpack(self.received)?;
        self.received += 1;
        match item.code {
            Code::End => self.source = Source::Ended,
            Code::ByHand(ByHand::Waits) => self.source = Source::Waits,
            _ => {}
        }
        self.items.push_back(item);
        Ok(())
    }

    /// The next block by hand is asked for.
    pub fn ask(&mut self) {
        if self.source == Source::Waits {
            self.source = Source::Sends;
        }
    }

    /// No more will come although the program has not ended.
    pub fn lost(&mut self) {
        if matches!(self.source, Source::Sends | Source::Waits) {
            self.source = Source::Lost;
        }
    }

    /// The item in hand; if there is none, the next one is taken in hand.
    pub fn head(&mut self) -> Option<&Item> {
        if self.hand.is_none() {
            self.hand = self.items.pop_front();
            self.taken += self.hand.as_ref().map_or(0, Item::steps);
        }
        self.hand.as_ref()
    }

    /// The item in hand, without taking another.
    pub fn in_hand(&self) -> Option<&Item> {
        self.hand.as_ref()
    }

    /// The item in hand has been executed, or will not be.
    pub fn done(&mut self) {
        self.hand = None;
    }

    /// Whether there is room and more may come.
    pub fn wants(&self) -> bool {
        self.source == Source::Sends && self.items.len() < DEPTH
    }

    /// Items taken off the wire so far.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// Whether the end of the program has come in, or of what is given by hand.
    pub fn ended(&self) -> bool {
        matches!(self.source, Source::Ended | Source::Waits)
    }

    /// Whether an item was refused, or the sender was lost: the program cannot go on behind what is here.
    pub fn failed(&self) -> bool {
        matches!(self.source, Source::Refused | Source::Lost)
    }

    /// Whether nothing waits and nothing is in hand.
    pub fn is_dry(&self) -> bool {
        self.hand.is_none() && self.items.is_empty()
    }

    /// Taken in hand so far, in steps of progress ([`Item::steps`]).
    pub fn taken(&self) -> u64 {
        self.taken
    }
}
