//! How `summary.json` tells what went through the channels between processes.

use serde::{Deserialize, Serialize};

/// What went through one channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    /// Its name, as in `axis-command/x`.
    pub name: String,
    /// Samples sent.
    pub sent: u64,
    /// Samples received.
    pub received: u64,
    /// Samples lost.
    pub lost: u64,
    /// Bytes of payload sent.
    pub bytes: u64,
    /// Samples that were not there when they were due (drive commands in real time).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub late: u64,
    /// The most of those in a row.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub late_in_row: u64,
    /// Processes at its ends that died before they told their counts: the figures are at least so much.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_counted: Vec<String>,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // as serde asks
pub(super) fn is_zero(count: &u64) -> bool {
    *count == 0
}
