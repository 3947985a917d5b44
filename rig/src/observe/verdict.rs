//! How good a part is. In: nothing. Out: one of three words, for whoever judges: the run, or a gauge.

use serde::{Deserialize, Serialize};

/// How good the part is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PartVerdict {
    /// Nothing speaks against it.
    Good,
    /// Something does.
    Bad,
    /// Nothing was cut that is judged, or the gauge that was asked for has no verdict.
    #[default]
    None,
}
