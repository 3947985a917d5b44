//! `[threading.variation]` of the machine file: what is varied where a program says nothing, and what a
//! thread may be off by it. Out: checked values, or the path of the key and the reason.

use protocol::{Variation, VariationShape};
use serde::{Deserialize, Serialize};

use crate::{MachineError, range, refuse};

/// `[threading.variation]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VariationConfig {
    /// Shape; without it the speed is varied only where a program says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<VariationShape>,
    /// How far to either side, per cent of the speed.
    pub percent: f64,
    /// Period, commanded turns.
    pub revolutions: f64,
    /// What the bound on the error of the thread by the variation may be (M232), µm.
    pub error_um: f64,
}

impl Default for VariationConfig {
    fn default() -> Self {
        VariationConfig { shape: None, percent: 10.0, revolutions: 4.0, error_um: 3.0 }
    }
}

impl VariationConfig {
    /// Whether it is what it is without the table.
    pub(crate) fn is_default(&self) -> bool {
        *self == VariationConfig::default()
    }

    /// The variation where a program says nothing.
    pub fn variation(&self) -> Option<Variation> {
        let (share, revolutions) = (self.percent / 100.0, self.revolutions);
        self.shape.map(|shape| Variation { shape, share, revolutions })
    }

    pub(crate) fn check(&self) -> Result<(), MachineError> {
        let [shortest, longest] = Variation::REVOLUTIONS;
        let most = 100.0 * Variation::MOST_SHARE;
        if !(self.percent > 0.0 && self.percent <= most) {
            let reason = format!("must lie between 0 and {most}, and above 0; leave shape out for none");
            return Err(refuse("threading.variation.percent", self.percent, &reason));
        }
        range("threading.variation.revolutions", self.revolutions, shortest, longest)?;
        range("threading.variation.error_um", self.error_um, 0.1, 1000.0)
    }
}
