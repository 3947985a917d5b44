//! How many messages went through each channel, as every process counts its own ends and the launcher adds
//! them up.

use protocol::{Axis, Message};
use serde::{Deserialize, Serialize};
use zerocopy::{FromBytes, Immutable, IntoBytes};

use super::{Process, channel};

/// What went through one channel, as `summary.json` shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChannelCount {
    /// Name of the channel.
    pub name: String,
    /// Messages put into queues: one for two receivers counts twice.
    pub sent: u64,
    /// Messages taken out of queues.
    pub received: u64,
    /// Messages a receiver missed, by their running numbers.
    pub lost: u64,
    /// Bytes put into queues.
    pub bytes: u64,
    /// Messages that were not there when they were due (real time).
    pub late: u64,
    /// The most of those in a row.
    pub late_in_row: u64,
    /// Processes at its ends that died before they told what they had counted: the figures are the least.
    pub not_counted: Vec<String>,
}

/// Adds up what both ends of each channel counted, by name, in the order of the names.
pub fn total(counts: impl IntoIterator<Item = ChannelCount>) -> Vec<ChannelCount> {
    let mut total = std::collections::BTreeMap::<String, ChannelCount>::new();
    for count in counts {
        let sum = total.entry(count.name.clone()).or_default();
        sum.name = count.name;
        sum.sent += count.sent;
        sum.received += count.received;
        sum.lost += count.lost;
        sum.bytes += count.bytes;
        sum.late += count.late;
        sum.late_in_row = sum.late_in_row.max(count.late_in_row);
    }
    total.into_values().collect()
}

/// What is known of every channel of a machine of which some processes died and never told their counts: they
/// are named at all their channels. What came out of a queue has been put into it, so what the receivers have
/// taken and missed is the least that a dead sender sent.
pub fn of_the_living(counts: Vec<ChannelCount>, axes: &[Axis], dead: &[Process]) -> Vec<ChannelCount> {
    let mut counts =
        std::collections::BTreeMap::from_iter(counts.into_iter().map(|count| (count.name.clone(), count)));
    let counted = |row: &channel::Row| row.name != channel::COUNT.name();
    for row in channel::all(axes).into_iter().filter(counted) {
        let dead_here = |process: &&Process| dead.contains(process);
        let ends = || row.senders.iter().chain(&row.receivers);
        if ends().any(|process| dead_here(&process)) {
            let name = row.name.clone();
            let count = counts
                .entry(name.clone())
                .or_insert_with(|| ChannelCount { name, ..ChannelCount::default() });
            count.not_counted = ends().filter(dead_here).map(|process| process.name()).collect();
            if row.senders.iter().any(|process| dead_here(&process)) {
                count.sent = count.sent.max(count.received + count.lost);
            }
        }
    }
    counts.into_values().collect()
}

const NAME_BYTES: usize = 32;

/// A count on its way to the launcher.
#[derive(Clone, Copy, Debug, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub(crate) struct CountPacket {
    name: [u8; NAME_BYTES],
    sent: u64,
    received: u64,
    lost: u64,
    bytes: u64,
    late: u64,
    late_in_row: u64,
}

impl Message for CountPacket {
    const NAME: &str = "pitchlock/count/2";
}

impl CountPacket {
    pub(crate) fn pack(count: &ChannelCount) -> CountPacket {
        let mut name = [0; NAME_BYTES];
        let text = count.name.as_bytes();
        name[..text.len()].copy_from_slice(text);
        let ChannelCount { sent, received, lost, bytes, late, late_in_row, .. } = *count;
        CountPacket { name, sent, received, lost, bytes, late, late_in_row }
    }

    pub(crate) fn unpack(&self) -> ChannelCount {
        let length = self.name.iter().position(|byte| *byte == 0).unwrap_or(NAME_BYTES);
        ChannelCount {
            name: String::from_utf8_lossy(&self.name[..length]).into_owned(),
            sent: self.sent,
            received: self.received,
            lost: self.lost,
            bytes: self.bytes,
            late: self.late,
            late_in_row: self.late_in_row,
            not_counted: Vec::new(),
        }
    }
}
