//! Straight moves: G0 and G1. In: a block and the modal state. Out: a line to an absolute point within the travel.

use protocol::{Axis, Code, Feed, Machine, PerAxis, Position};

use crate::block::{Block, Motion};
use crate::diagnostic::{Diagnostic, Spot, short};
use crate::execute::{Interpreter, Output};
use crate::state::FeedMode;
use crate::thread::Point;

impl Interpreter {
    /// G0 or G1. Without axis words it only sets the motion in force.
    pub(crate) fn line(
        &mut self,
        block: &Block,
        motion: Motion,
        output: &mut Output,
    ) -> Result<(), Diagnostic> {
        if block.word('X').is_none() && block.word('Z').is_none() {
            return Ok(());
        }
        let feed = if motion == Motion::Rapid { Feed::Rapid } else { self.feed_of(block)? };
        let target = self.programmed_target(block)?;
        output.push(Code::Line { target: positions(target), feed });
        (self.state.point, self.state.rest, self.state.after_thread) = (target, target, false);
        Ok(())
    }

    /// The point of the X and Z words, refused if it lies outside the travel.
    pub(crate) fn programmed_target(&self, block: &Block) -> Result<Point, Diagnostic> {
        let (x, z) = (block.word('X'), block.word('Z'));
        let target = self.state.target(x.map(|word| word.value), z.map(|word| word.value));
        let spot_of = |word: Option<crate::words::Word>| word.map_or(block.spot, |word| word.spot);
        within_travel(&self.machine, Axis::X, target.x, spot_of(x))?;
        within_travel(&self.machine, Axis::Z, target.z, spot_of(z))?;
        Ok(target)
    }

    fn feed_of(&self, block: &Block) -> Result<Feed, Diagnostic> {
        let spot = block.spot_of_task();
        let Some(feed) = self.state.feed_of_move() else {
            let help = "add an F word to this block or one before; G94 and G95 each need their own";
            return Err(Diagnostic::error("no-feed", spot, "G1 has no feed", help));
        };
        if self.state.feed_mode == FeedMode::PerRevolution && self.state.turning().is_none() {
            let message = "feed per revolution (G95) with a spindle that does not turn";
            let help = "start it before, as in S600 M3, or use G94";
            return Err(Diagnostic::error("spindle-not-turning", spot, message, help));
        }
        Ok(feed)
    }
}

/// Refuses a position outside the travel of its axis.
pub(crate) fn within_travel(machine: &Machine, axis: Axis, mm: f64, spot: Spot) -> Result<(), Diagnostic> {
    let [low, high] = machine.axis.get(&axis).map_or([0.0, 0.0], |config| config.travel_mm);
    if (low..=high).contains(&mm) {
        return Ok(());
    }
    let note = if axis == Axis::X { " (radius)" } else { "" };
    let message = format!(
        "{axis} at {} mm{note} is outside axis.{}.travel_mm = [{}, {}]",
        short(mm),
        axis.name(),
        short(low),
        short(high)
    );
    let help = "keep the target within the travel; check units (G20, G21), G7 and G91";
    Err(Diagnostic::error("travel-limit", spot, message, help))
}

/// A point as the wire carries it.
pub(crate) fn positions(point: Point) -> PerAxis<Position> {
    let mut positions = PerAxis::<Position>::default();
    positions[Axis::X.index()] = Position::from_mm(point.x);
    positions[Axis::Z.index()] = Position::from_mm(point.z);
    positions
}
