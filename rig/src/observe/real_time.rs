//! How `summary.json` tells of a run in real time: how its processes were set up.

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
