//! The axis is referenced. In: the offset that the interpolator wants, and the one that the measurement has.
//! Out: where the axis is led goes with where it is measured, so that it stands still.
//!
//! The drive adds the offset to its positions in a cycle that the regulator sees in the measurement. There
//! what was commanded and the servo error stay what they are at the slide.

use motion::Sample;
use protocol::{Cycle, Measurement, Position};

use super::Regulator;
use crate::state::State;

impl Regulator {
    /// The interpolator wants an offset; whether the axis rests, and the drive is told.
    pub(super) fn is_referenced(&mut self, home_offset: Position) -> bool {
        let rests = matches!(self.state, State::Streaming) && self.last.v == 0.0 && self.last.a == 0.0;
        if rests {
            self.home_offset = Some(home_offset);
        }
        rests
    }

    /// The measurement of a cycle has the offset that was asked for, be it 0: from now on the place of the
    /// axis is known.
    pub(super) fn take_offset(&mut self, measurement: &Measurement) {
        let shown = measurement.references[self.axis].home_offset;
        // One that it has not asked for is no offset: positions jump then, which is seen as such.
        if self.taken_offset == Some(shown) || self.home_offset != Some(shown) {
            return;
        }
        let moved_mm = shown.mm_from(self.taken_offset.replace(shown).unwrap_or_default());
        let now_mm = self.measured_mm(measurement);
        // A compensation of the screw is another one there.
        let way_mm = match (&self.compensation, self.scales[self.axis]) {
            (Some(compensation), false) => {
                let before_mm = measurement.axes[self.axis].position.mm() - moved_mm;
                now_mm - compensation.axis_mm(before_mm, self.input_s)
            }
            _ => moved_mm,
        };
        self.watch.forget();
        self.loops.forget();
        if let Some(compensation) = &mut self.compensation {
            compensation.rest();
        }
        self.last = Sample { s: self.last.s + way_mm, ..self.last };
        self.rests_at(self.last.s, measurement.cycle);
    }

    fn rests_at(&mut self, mm: f64, cycle: Cycle) {
        if self.stream.begun() {
            self.stream.rest_at(Position::from_mm(mm), cycle);
        }
    }
}
