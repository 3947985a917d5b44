//! What the program tells its operator. In: its messages, each with how much of the program goes before
//! it, in steps of progress; the record of every control cycle. Out: a [`MessageReport`] of each that was
//! told. A message is due when what follows it begins.

use std::collections::VecDeque;

use protocol::MachineStatus;
use serde::{Deserialize, Serialize};

/// A message of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Line of the part program.
    pub line: u32,
    /// Steps of progress before it.
    pub after: u64,
    /// What it says.
    pub text: String,
}

/// A message that was told.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MessageReport {
    /// Line of the part program.
    pub line: u32,
    /// Control cycle in which what follows it began.
    pub cycle: u64,
    /// What it says.
    pub text: String,
}

/// Watches for the moments of messages.
#[derive(Clone, Default)]
pub(super) struct Messages {
    waiting: VecDeque<Message>,
    pub(super) told: Vec<MessageReport>,
}

impl Messages {
    pub(super) fn of(messages: impl IntoIterator<Item = Message>) -> Messages {
        Messages { waiting: messages.into_iter().collect(), told: Vec::new() }
    }

    /// More of them, behind all that were there.
    pub(super) fn gives(&mut self, messages: Vec<Message>) {
        self.waiting.extend(messages);
    }

    pub(super) fn cycle(&mut self, cycle: u64, machine: &MachineStatus) {
        while let Some(message) = self.waiting.pop_front_if(|message| message.after < machine.taken) {
            self.told.push(MessageReport { line: message.line, cycle, text: message.text });
        }
    }
}
