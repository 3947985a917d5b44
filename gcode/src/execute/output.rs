//! Where calls and warnings of a block go.

use super::compensation::Waiting;
use crate::canon::{Call, Place, Position, Sink};
use crate::problem::Problem;

/// What executing functions return.
pub(crate) type Done = Result<(), Box<Problem>>;

/// The receiver of calls, the place they come from, the warnings of the block, and the calls that wait for the next
/// corner of a compensated contour.
pub(crate) struct Output<'a> {
    sink: &'a mut dyn Sink,
    /// Where the calls come from.
    pub(crate) place: Place,
    warnings: &'a mut Vec<Problem>,
    pub(super) waiting: &'a mut Waiting,
}

impl<'a> Output<'a> {
    pub(crate) fn new(
        sink: &'a mut dyn Sink,
        place: Place,
        warnings: &'a mut Vec<Problem>,
        waiting: &'a mut Waiting,
    ) -> Output<'a> {
        Output { sink, place, warnings, waiting }
    }

    /// Sends a call, or lets it wait behind others.
    pub(crate) fn call(&mut self, call: Call<'_>) -> Done {
        if self.waiting.delays(&call) {
            self.waiting.push(self.place, call);
            return Ok(());
        }
        self.sink.call(self.place, call)
    }

    /// Where the last job left the tool, see [`Sink::after_job`].
    pub(crate) fn after_job(&self) -> Option<Position> {
        self.sink.after_job()
    }

    /// Sends all calls that wait. They keep the place of their blocks, but for N: that is what is read now.
    pub(crate) fn release(&mut self) -> Done {
        let Place { n, n_digits, .. } = self.place;
        for (place, call) in self.waiting.take().calls() {
            self.sink.call(Place { n, n_digits, ..place }, call)?;
        }
        Ok(())
    }

    /// Notes what is legal but probably wrong.
    #[allow(clippy::boxed_local)] // problems travel boxed
    pub(crate) fn warn(&mut self, problem: Box<Problem>) {
        self.warnings.push(*problem);
    }
}
