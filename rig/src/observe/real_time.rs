//! How `summary.json` tells of a run in real time: how its processes were set up, how late they
//! were.

use serde::{Deserialize, Serialize};

/// What a process with deadlines says of itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RealTimeReport {
    /// Its name.
    #[serde(default)]
    pub process: String,
    /// What it needs of the computer, and whether that was granted.
    #[serde(default)]
    pub set_up: Vec<SetUpItem>,
    /// How long after its moment the process woke, where it has fixed ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wake_up: Option<Times>,
    /// In the process of plant and regulators, from the moment of a cycle to the last answer; of a regulator
    /// in a process of its own, from its measurement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answer: Option<Times>,
    /// From the measurement of a tick to the last frame of the interpolator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Times>,
    /// How often it was late, or found that it had missed something.
    #[serde(default)]
    pub late_in_all: u64,
    /// The first of these times, each with the cycles before it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub late: Vec<LateCycle>,
    /// What the operating system has counted from the start to the end.
    #[serde(default)]
    pub system: Counted,
}

/// How often something took how long, µs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// How many there were.
    pub count: u64,
    /// Half of them took at most so long.
    pub median_us: u64,
    /// 99 % of them.
    pub p99_us: u64,
    /// 99.9 % of them.
    pub p999_us: u64,
    /// The longest.
    pub most_us: u64,
    /// Of each bucket that is not empty its least time and how many are in it.
    pub buckets: Vec<(u64, u64)>,
}

/// A late cycle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LateCycle {
    /// The control cycle in which it was seen.
    pub cycle: u64,
    /// So many cycles (of the interpolator: ticks) were missed.
    pub missed: u64,
    /// Up to 64 cycles that end with this one: how late each woke, how long it worked.
    pub before_us: Vec<(u64, u64)>,
}

/// What the operating system counts of a process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counted {
    /// Pages that were made.
    pub minor_faults: u64,
    /// Pages that were read from a disk.
    pub major_faults: u64,
    /// How often it went to sleep by itself.
    pub voluntary_switches: u64,
    /// How often its processor was taken from it.
    pub involuntary_switches: u64,
}

/// One thing of the set-up of a process.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SetUpItem {
    /// Which.
    pub what: String,
    /// Whether it is done.
    pub done: bool,
    /// What was done; or why not, and what would help.
    pub text: String,
}
