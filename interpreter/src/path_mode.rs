//! What the path may do between moves: G61, G61.1, G64. In: calls. Out: a path mode, and whether Q was given.

use gcode::Problem;
use gcode::canon::{self, Units};
use gcode::problem::Blame;
use protocol::PathMode;

use crate::reach::Done;

/// What the program asks of the path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathAsked {
    /// G61, G61.1, G64.
    pub(crate) mode: PathMode,
    /// Q of G64 says by how much the path may leave lines that nearly go on in one line.
    with_q: bool,
}

impl PathAsked {
    /// Blends within the tolerance of the machine, mm.
    pub(crate) fn within(tolerance_mm: f64) -> PathAsked {
        PathAsked { mode: PathMode::within(tolerance_mm), with_q: false }
    }

    /// G61, G61.1, G64 P. Without P, or with P0, the tolerance is that of the machine, mm; `units`: those
    /// of the program.
    pub(crate) fn asked(
        mode: canon::PathMode,
        units: Units,
        tolerance_mm: f64,
    ) -> Result<PathAsked, Box<Problem>> {
        let exact = |mode| PathAsked { mode, with_q: false };
        Ok(match mode {
            canon::PathMode::ExactPath => exact(PathMode::ExactPath),
            canon::PathMode::ExactStop => exact(PathMode::ExactStop),
            canon::PathMode::Continuous(0.0) => PathAsked::within(tolerance_mm),
            canon::PathMode::Continuous(tolerance) => {
                PathAsked::within(in_range('P', tolerance * units.mm(), units)?)
            }
        })
    }

    /// Q of G64, mm: all of P is for every corner then.
    pub(crate) fn merge_within(&mut self, mm: f64, units: Units) -> Done {
        let mm = in_range('Q', mm, units)?;
        if let PathMode::Blend { tolerance_mm, merge_mm } = &mut self.mode {
            if !self.with_q {
                *tolerance_mm += *merge_mm;
            }
            (*merge_mm, self.with_q) = (mm, true);
        }
        Ok(())
    }
}

/// A tolerance in mm, of a word.
fn in_range(letter: char, mm: f64, units: Units) -> Result<f64, Box<Problem>> {
    if (0.0..=PathMode::MOST_MM).contains(&mm) {
        return Ok(mm);
    }
    let message = format!("{} is not a tolerance of a path", units.length(mm));
    let help = format!("give at most {}", units.length(PathMode::MOST_MM));
    Err(Problem::error("bad-value", Blame::Word(letter), message, help))
}
