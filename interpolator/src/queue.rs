//! Machine-code items waiting to be executed. While there is room, the sender has credit.

use std::collections::VecDeque;

use protocol::{Code, CodePacket, Item, Refused};

/// How many items wait at most.
pub const DEPTH: usize = 64;

/// The queue. It allocates once, in `new`.
#[derive(Clone, Debug)]
pub struct Queue {
    items: VecDeque<Item>,
    received: u64,
    taken: u64,
    ended: bool,
}

impl Default for Queue {
    fn default() -> Self {
        Queue { items: VecDeque::with_capacity(DEPTH), received: 0, taken: 0, ended: false }
    }
}

impl Queue {
    /// Takes an item off the wire.
    ///
    /// # Errors
    /// The item is damaged, out of order, beyond the credit, or behind the end of the program; nothing changes.
    pub fn push(&mut self, packet: &CodePacket) -> Result<(), Refused> {
        if self.ended || self.items.len() == DEPTH {
            return Err(Refused::OutOfRange("machine code without credit"));
        }
        let item = packet.unpack(self.received)?;
        self.received += 1;
        self.ended = matches!(item.code, Code::End);
        self.items.push_back(item);
        Ok(())
    }

    /// The next item.
    pub fn pop(&mut self) -> Option<Item> {
        let item = self.items.pop_front()?;
        self.taken += item.steps();
        Some(item)
    }

    /// Whether there is room and more may come.
    pub fn wants(&self) -> bool {
        !self.ended && self.items.len() < DEPTH
    }

    /// Items taken off the wire so far.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// Whether the end of the program has come in.
    pub fn ended(&self) -> bool {
        self.ended
    }

    /// Whether nothing waits.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Taken out so far, in steps of progress ([`Item::steps`]).
    pub fn taken(&self) -> u64 {
        self.taken
    }
}
