//! Machine code on the wire: an [`Item`] as the interpreter sends it, and the credit that it sends by. In:
//! items. Out: packets, and back; what no interpreter sends is refused.
//!
//! Every item goes in one way: its running number and the item itself, through serde and bincode 2 (standard
//! configuration, as in a `.mc` file), as many bytes as that takes and [`CodePacket::LONGEST`] at most.

use core::fmt::{Debug, Formatter, Result as Written};

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::code::Item;
use crate::message::{Message, Payload};
use crate::refused::Refused;

/// An [`Item`] as bytes.
#[derive(Clone, Copy, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct CodePacket {
    length: u64,
    bytes: [u8; CodePacket::LONGEST],
}

impl CodePacket {
    /// Most bytes of a packet: a pass that moves eight axes, each in its own way, with all its corners.
    pub const LONGEST: usize = 1984;

    /// Puts an item on the wire. `sequence`: its running number in the program, from 0.
    ///
    /// # Panics
    /// If there is an item that is longer than [`CodePacket::LONGEST`]: there is none.
    pub fn pack(sequence: u64, item: &Item) -> CodePacket {
        let mut bytes = [0; CodePacket::LONGEST];
        let packed = bincode::serde::encode_into_slice((sequence, item), &mut bytes, config());
        CodePacket { length: packed.expect("the longest item fits") as u64, bytes }
    }

    /// The bytes that travel.
    pub fn as_bytes(&self) -> &[u8] {
        let length = usize::try_from(self.length).unwrap_or(usize::MAX);
        self.bytes.get(..length).unwrap_or_default()
    }

    /// A packet that has travelled, unread.
    ///
    /// # Errors
    /// More bytes than any packet has.
    pub fn from_bytes(bytes: &[u8]) -> Result<CodePacket, Refused> {
        let mut packet = CodePacket { length: bytes.len() as u64, bytes: [0; CodePacket::LONGEST] };
        let room = packet.bytes.get_mut(..bytes.len());
        room.ok_or(Refused::OutOfRange("length of a packet"))?.copy_from_slice(bytes);
        Ok(packet)
    }

    /// Takes an item off the wire. Nothing is allocated.
    ///
    /// # Errors
    /// A gap in the sequence, bytes that are no item or go on behind one, or a value that no interpreter
    /// sends.
    pub fn unpack(&self, expected_sequence: u64) -> Result<Item, Refused> {
        let bytes = self.as_bytes();
        let read = bincode::serde::decode_from_slice::<(u64, Item), _>(bytes, config());
        let ((sequence, item), used) = read.map_err(|_| Refused::Unreadable("machine code"))?;
        if used != bytes.len() {
            return Err(Refused::Unreadable("machine code"));
        }
        if sequence != expected_sequence {
            return Err(Refused::OutOfOrder {
                what: "machine code",
                expected: expected_sequence,
                received: sequence,
            });
        }
        item.check()?;
        Ok(item)
    }
}

/// How items become bytes; no item claims more than a packet holds.
fn config() -> impl bincode::config::Config {
    bincode::config::standard().with_limit::<{ CodePacket::LONGEST }>()
}

impl Payload for CodePacket {
    const NAME: &str = "pitchlock/code-packet/12";
    const MOST_BYTES: usize = CodePacket::LONGEST;

    fn bytes(&self) -> &[u8] {
        self.as_bytes()
    }

    fn from_payload(bytes: &[u8]) -> Option<CodePacket> {
        CodePacket::from_bytes(bytes).ok()
    }
}

impl PartialEq for CodePacket {
    fn eq(&self, other: &CodePacket) -> bool {
        self.as_bytes() == other.as_bytes()
    }
}

impl Eq for CodePacket {}

impl Debug for CodePacket {
    fn fmt(&self, out: &mut Formatter<'_>) -> Written {
        write!(out, "CodePacket({:02x?})", self.as_bytes())
    }
}

/// What the interpolator has taken out of the queue: room for as many more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Credit {
    /// Items taken since the start of the program.
    pub taken: u64,
}

impl Message for Credit {
    const NAME: &str = "pitchlock/credit/1";
}

impl Credit {
    /// Nothing more is wanted: the program was stopped, or the machine has a fault.
    pub const ENOUGH: Credit = Credit { taken: u64::MAX };
}
