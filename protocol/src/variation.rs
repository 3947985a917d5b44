//! How the speed of the spindle is varied within the passes of a thread: shape, how far, how fast. What comes
//! of it, and whether a machine can do it, is `machine/src/variation/`.

use serde::{Deserialize, Serialize};

use crate::refused::Refused;

/// A variation of the spindle's speed: in a pass it turns at S (1 + share · f) times the override, with f
/// from −1 to 1 and back once in `revolutions` commanded turns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variation {
    /// How it changes.
    pub shape: VariationShape,
    /// How far to either side, a share of the speed, 0 < share ≤ [`Variation::MOST_SHARE`].
    pub share: f64,
    /// Period, turns of the commanded spindle, [`Variation::REVOLUTIONS`].
    pub revolutions: f64,
}

/// The shape of a variation over the angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VariationShape {
    /// A sine.
    Sine,
    /// Straight, with rounded corners.
    Triangle,
    /// Every half period to another speed within the band, as a sine goes from one peak to the other.
    Random,
}

impl VariationShape {
    /// All of them.
    pub const ALL: [VariationShape; 3] =
        [VariationShape::Sine, VariationShape::Triangle, VariationShape::Random];

    /// As programs and machine files write it.
    pub const fn name(self) -> &'static str {
        match self {
            VariationShape::Sine => "sine",
            VariationShape::Triangle => "triangle",
            VariationShape::Random => "random",
        }
    }
}

impl Variation {
    /// The largest share.
    pub const MOST_SHARE: f64 = 0.5;
    /// Shortest and longest period, turns.
    pub const REVOLUTIONS: [f64; 2] = [0.25, 1000.0];

    /// Refuses what no interpreter sends.
    ///
    /// # Errors
    /// Names the field.
    pub fn check(&self) -> Result<(), Refused> {
        let [shortest, longest] = Variation::REVOLUTIONS;
        if !(self.share > 0.0 && self.share <= Variation::MOST_SHARE) {
            return Err(Refused::OutOfRange("share of a speed variation"));
        }
        if !(shortest..=longest).contains(&self.revolutions) {
            return Err(Refused::OutOfRange("period of a speed variation"));
        }
        Ok(())
    }
}
