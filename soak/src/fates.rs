//! Wires with events on them. In: messages, as bytes, and the cycles in which something becomes of them. Out:
//! what arrives. Behind the last cycle of an event its wire is straight again; what was under way then is
//! lost.

use std::collections::VecDeque;

use protocol::Cycle;
use rig::wires::{Disturbance, Message, Wire};

use crate::event::{Event, Fate, What};

/// From one damaged message to the next; a prime, so that each has another bit.
const STRIDE: u32 = 1009;

/// One event on a wire.
struct Fated {
    wire: Wire,
    from: u64,
    to: u64,
    fate: Fate,
    under_way: VecDeque<Option<Vec<u8>>>,
    count: u32,
}

/// What becomes of the messages of a case.
pub(crate) struct Fates(Vec<Fated>);

impl Fates {
    /// Those of the events that concern wires.
    pub(crate) fn of(events: &[Event]) -> Fates {
        let fated = |event: &Event| match event.what {
            What::Wire { wire, fate, cycles } => Some(Fated {
                wire,
                from: event.at,
                to: event.at + cycles,
                fate,
                under_way: VecDeque::new(),
                count: 0,
            }),
            _ => None,
        };
        Fates(events.iter().filter_map(fated).collect())
    }

    /// Whether nothing becomes of any message.
    pub(crate) fn is_none(&self) -> bool {
        self.0.is_empty()
    }
}

impl Disturbance for Fates {
    fn carry<M: Message>(&mut self, wire: Wire, now: Cycle, sent: Option<M>) -> Option<M> {
        let concerned = |fated: &&mut Fated| fated.wire == wire && (fated.from..fated.to).contains(&now.0);
        self.0.iter_mut().filter(concerned).fold(sent, |sent, fated| fated.carry(sent))
    }
}

impl Fated {
    fn carry<M: Message>(&mut self, sent: Option<M>) -> Option<M> {
        let bytes = |message: M| message.as_bytes().to_vec();
        let read = |bytes: Vec<u8>| M::read_from_bytes(&bytes).ok();
        self.count += 1;
        match self.fate {
            Fate::Drop => None,
            Fate::Delay(by) => {
                self.under_way.push_back(sent.map(bytes));
                let due = self.under_way.len() > by as usize;
                let oldest = if due { self.under_way.pop_front() } else { None };
                read(oldest??)
            }
            Fate::Duplicate => {
                if let Some(message) = sent {
                    self.under_way.extend([Some(bytes(message)), Some(bytes(message))]);
                }
                read(self.under_way.pop_front()??)
            }
            // 1, 0, 3, 2 …
            Fate::Reorder if self.count % 2 == 1 => {
                let held = self.under_way.pop_front();
                self.under_way.push_back(sent.map(bytes));
                read(held??)
            }
            Fate::Reorder => sent,
            Fate::Corrupt(bit) => {
                let mut bytes = bytes(sent?);
                let bit = bit.wrapping_add(STRIDE.wrapping_mul(self.count - 1)) as usize % (8 * bytes.len());
                if let Some(byte) = bytes.get_mut(bit / 8) {
                    *byte ^= 1 << (bit % 8);
                }
                read(bytes)
            }
        }
    }
}
