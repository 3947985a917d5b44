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
    ended: bool,
}

impl Default for Queue {
    fn default() -> Self {
        Queue { items: VecDeque::with_capacity(DEPTH), received: 0, ended: false }
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
        self.items.pop_front()
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

    /// Items taken out so far.
    pub fn taken(&self) -> u64 {
        self.received - self.items.len() as u64
    }
}
