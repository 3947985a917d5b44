//! Shaping by feed ratios: followers move in a ratio to their master (M36–M45).

use serde::{Deserialize, Serialize};

/// How the ratio of a follower is found from the place where a step begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Correction {
    /// The slope (M36, M37).
    None,
    /// As published, misprints included.
    Published,
    /// The published correction with right signs (M38–M41).
    PublishedSigns,
    /// The same with the mixed term (M42).
    Mixed,
    /// Divided differences (M40, M43): no error at the end of a step.
    #[default]
    Exact,
}
