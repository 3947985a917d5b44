//! Where calls and warnings of a block go.

use crate::canon::{Call, Place, Sink};
use crate::problem::Problem;

/// What executing functions return.
pub(crate) type Done = Result<(), Box<Problem>>;

/// The receiver of calls, the place they come from, and the warnings of the block.
pub(crate) struct Output<'a> {
    sink: &'a mut dyn Sink,
    /// Where the calls come from.
    pub(crate) place: Place,
    warnings: &'a mut Vec<Problem>,
}

impl<'a> Output<'a> {
    pub(crate) fn new(sink: &'a mut dyn Sink, place: Place, warnings: &'a mut Vec<Problem>) -> Output<'a> {
        Output { sink, place, warnings }
    }

    /// Sends a call.
    pub(crate) fn call(&mut self, call: Call<'_>) -> Done {
        self.sink.call(self.place, call)
    }

    /// Sends a call of an earlier block.
    pub(crate) fn call_from(&mut self, place: Place, call: Call<'_>) -> Done {
        self.sink.call(place, call)
    }

    /// Notes what is legal but probably wrong.
    #[allow(clippy::boxed_local)] // problems travel boxed
    pub(crate) fn warn(&mut self, problem: Box<Problem>) {
        self.warnings.push(*problem);
    }
}
